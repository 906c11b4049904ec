//! The tables of the arithmetic as files for `$readmemh`, as described in `vectors/SPEC.md`.

use std::fmt::Write;

use roughxel_core::rom;

/// Every file with its text: a 32-bit word per line, eight hex digits, entry 0 first.
pub fn rom_files() -> Vec<(String, String)> {
    let seeds = [8, 10].into_iter().flat_map(|bits| {
        // The last quarter of the inverse roots is never addressed.
        let roots = &rom::inverse_root(bits)[..3 << (bits - 2)];
        [(format!("reciprocal_{bits}"), rom::reciprocal(bits)), (format!("inverse_root_{bits}"), roots)]
    });
    let tables: [(&str, &[i32]); 7] = [
        ("log2", &rom::LOG2),
        ("exp2", &rom::EXP2),
        ("half_log2_one_minus_ratio", &rom::HALF_LOG2_ONE_MINUS_RATIO),
        ("half_log2_one_plus_ratio", &rom::HALF_LOG2_ONE_PLUS_RATIO),
        ("step_per_sigma", &rom::STEP_PER_SIGMA),
        ("spread_limit", &rom::SPREAD_LIMIT),
        ("log2_of_count", &rom::LOG2_OF_COUNT),
    ];
    let tables = tables.map(|(name, table)| (name.to_owned(), table));
    seeds.chain(tables).map(|(name, table)| (format!("{name}.hex"), lines(table))).collect()
}

fn lines(table: &[i32]) -> String {
    table.iter().fold(String::new(), |mut text, entry| {
        let _ = writeln!(text, "{entry:08x}");
        text
    })
}
