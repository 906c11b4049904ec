//! Parts that do not depend on the design: tables, leading zero counters, delay lines.

use roughxel_core::rom;
use serde::Serialize;

use super::context::Context;
use super::format::{Format, vector};
use super::text::{END, filled, header};
use super::value::literal;
use crate::graph::Table;
use crate::interval::Range;

/// A table of the datapath under its name.
#[derive(Clone, Copy, Debug)]
pub struct Rom {
    name: &'static str,
    /// Index bits of a table that exists in several sizes.
    size: Option<u32>,
    table: Table,
}

impl Rom {
    /// The ROM of a table; `None` for a table the datapath does not have.
    pub fn new(table: Table) -> Option<Self> {
        let named: [(&'static str, &'static [i32]); 13] = [
            ("log2", &rom::LOG2),
            ("exp2", &rom::EXP2),
            ("half_log2_one_minus_ratio", &rom::HALF_LOG2_ONE_MINUS_RATIO),
            ("half_log2_one_plus_ratio", &rom::HALF_LOG2_ONE_PLUS_RATIO),
            ("step_per_sigma", &rom::STEP_PER_SIGMA),
            ("box_weights", &rom::BOX_WEIGHTS),
            ("gaussian_weights", &rom::GAUSSIAN_WEIGHTS),
            ("spread_limit", &rom::SPREAD_LIMIT),
            ("normal_places", &rom::NORMAL_PLACES),
            ("normal_places_of_one_less", &rom::NORMAL_PLACES_OF_ONE_LESS),
            ("normal_widenings", &rom::NORMAL_WIDENINGS),
            ("normal_widenings_of_one_less", &rom::NORMAL_WIDENINGS_OF_ONE_LESS),
            ("one_over_count", &rom::ONE_OVER_COUNT),
        ];
        let sized = (6..=10).flat_map(|bits| {
            [("reciprocal", bits, rom::reciprocal(bits)), ("inverse_root", bits, rom::inverse_root(bits))]
        });
        let named = named.into_iter().map(|(name, entries)| (name, None, entries));
        let all = named.chain(sized.map(|(name, bits, entries)| (name, Some(bits), entries)));
        let found = all.into_iter().find(|(.., entries)| std::ptr::eq(*entries, table.entries));
        found.map(|(name, size, _)| Self { name, size, table })
    }

    /// Name of its module without a prefix: `rom_reciprocal_8`, or `rom_reciprocal_8_w16` for words of other than 32 bits.
    pub fn name(&self) -> String {
        let size = self.size.map_or_else(String::new, |bits| format!("_{bits}"));
        let width = if self.table.bits == 32 { String::new() } else { format!("_w{}", self.table.bits) };
        format!("rom_{}{size}{width}", self.name)
    }

    /// Bits of the index.
    pub fn index_bits(&self) -> u32 {
        count_bits(self.table.entries.len() as u32 - 1)
    }

    /// Format in which an entry is stored.
    pub fn format(table: Table) -> Format {
        let low = table.on_words().min().unwrap_or(0).into();
        let high = table.on_words().max().unwrap_or(0).into();
        let zeros = table.on_words().filter(|entry| *entry != 0).map(i32::trailing_zeros).min();
        Format::new(Range { low, high, zeros: zeros.unwrap_or(0) }, 0, false)
    }

    fn entries(&self) -> impl Iterator<Item = u64> {
        let format = Self::format(self.table);
        // The format is that of these entries.
        self.table.on_words().map(move |entry| format.pack(entry.into()).unwrap_or(0))
    }

    /// Text of its module, given the name.
    pub(super) fn module(&self, name: &str) -> String {
        let format = Self::format(self.table);
        let (width, index) = (format.width(), self.index_bits());
        let about = [
            format!(
                "Table of the datapath, {} entries; entry = integer of the table >> {}.",
                self.table.entries.len(),
                format.zeros
            ),
            format!("The same entries for $readmemh: rom/{name}.hex."),
        ];
        let mut text = header(name, &about);
        text += &format!(
            "module {name} (\n  input  wire {}index,\n  output reg  {}entry\n);\n\n  always @(*)\n    case (index)\n",
            vector(index, false),
            vector(width, format.signed()),
        );
        let entries: Vec<u64> = self.entries().collect();
        // A table that fills its index needs no default; its last entry is written as the default.
        let full = entries.len() == 1 << index;
        for (place, &entry) in entries.iter().enumerate() {
            let last = full && place + 1 == entries.len();
            let place = if last { "default".to_owned() } else { format!("{index}'d{place}") };
            text += &format!("      {place}: entry = {};\n", literal(entry.into(), width));
        }
        if !full {
            text += &format!("      default: entry = {};\n", literal(0, width));
        }
        text + &format!("    endcase\n{END}")
    }

    /// Entries for `$readmemh`, given the name of its module.
    pub(super) fn hex(&self, name: &str) -> String {
        let format = Self::format(self.table);
        let digits = format.width().div_ceil(4) as usize;
        let mut text = format!(
            "// {name}: {} entries of {} bits; entry = integer of the table >> {}\n",
            self.table.entries.len(),
            format.width(),
            format.zeros
        );
        for entry in self.entries() {
            text += &format!("{entry:0digits$x}\n");
        }
        text
    }

    /// Description for tools, given the name of its module.
    pub(super) fn description(&self, name: &str) -> RomDescription {
        let format = Self::format(self.table);
        RomDescription {
            name: name.to_owned(),
            entries: self.table.entries.len(),
            index_bits: self.index_bits(),
            width: format.width(),
            signed: format.signed(),
            dropped_zeros: format.zeros,
        }
    }
}

/// A ROM in the manifest.
#[derive(Clone, Debug, Serialize)]
pub(super) struct RomDescription {
    name: String,
    entries: usize,
    index_bits: u32,
    width: u32,
    signed: bool,
    dropped_zeros: u32,
}

/// Bits of an unsigned number up to `most`.
pub(super) fn count_bits(most: u32) -> u32 {
    (32 - most.leading_zeros()).max(1)
}

/// Module that counts leading zeros, `leading_zeros_40`: a tree over groups of four bits. A level of it is one lookup table of four inputs.
pub(super) fn leading_zeros(name: &str, width: u32) -> String {
    // A value that fills the tree may be zero. Any other has a place more in the tree, so that there always is a one.
    let fills = width >= 4 && width.is_power_of_two();
    let bits = if fills { width.ilog2() } else { count_bits(width).max(2) };
    let places = 1_u32 << bits;
    let about = [
        format!("Zeros above the highest one of {width} bits; {width} where there is none."),
        "zN_G: group G of 2^N bits, counted from the top, is zero; cN_G: zeros above its highest one.".into(),
    ];
    let mut text = header(name, &about);
    text += &format!(
        "module {name} (\n  input  wire {}value,\n  output wire {}count\n);\n\n",
        vector(width, false),
        vector(count_bits(width), false)
    );
    text += &if fills {
        format!("  wire [{}:0] w = value;\n", places - 1)
    } else {
        // The last place is below every bit that is read.
        let ones = places - width - 1;
        let padded = if ones == 0 { "value".to_owned() } else { format!("{{value, {{{ones}{{1'b1}}}}}}") };
        format!("  wire [{}:1] w = {padded};\n", places - 1)
    };
    for group in 0..places >> 2 {
        let low = places - 4 - 4 * group;
        let [d, c, b] = [low + 3, low + 2, low + 1];
        // Nobody asks whether a last group is zero that has a one.
        if low > 0 || fills {
            text += &format!("  wire z2_{group} = w[{d}:{low}] == 4'd0;\n");
        }
        text += &format!("  wire [1:0] c2_{group} = {{w[{d}:{c}] == 2'd0, ~w[{d}] & (w[{c}] | ~w[{b}])}};\n");
    }
    for step in 2..bits {
        let next = step + 1;
        for group in 0..places >> next {
            let [first, second] = [2 * group, 2 * group + 1];
            if group + 1 < places >> next || fills {
                text += &format!("  wire z{next}_{group} = z{step}_{first} & z{step}_{second};\n");
            }
            let rest = format!("z{step}_{first} ? c{step}_{second} : c{step}_{first}");
            text += &format!("  wire [{step}:0] c{next}_{group} = {{z{step}_{first}, {rest}}};\n");
        }
    }
    let count = match (fills, width) {
        (true, _) => format!("{{z{bits}_0, z{bits}_0 ? {} : c{bits}_0}}", literal(0, bits)),
        (false, 1) => format!("c{bits}_0[0]"),
        (false, _) => format!("c{bits}_0"),
    };
    text + &format!("  assign count = {count};\n{END}")
}

/// Name of the delay line without a prefix.
pub(super) const DELAY: &str = "roughxel_delay";

/// File of the delay line, name and text.
pub(super) fn delay(context: Context) -> (String, String) {
    let name = context.named(DELAY);
    (format!("{name}.v"), filled(include_str!("templates/delay.v"), &[("NAME", name)]))
}
