//! The tables of the results.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::modules::{Arguments, Clock, Module, Outcome};

/// All modules, in one table per profile.
pub(super) fn text(
    jobs: &[(String, Module)],
    outcomes: &BTreeMap<(String, String), Outcome>,
    arguments: &Arguments,
    versions: &[String],
) -> String {
    let mut text = format!(
        "# Synthesis results\n\nMade by `cargo run --release -p roughxel-host-tests --bin synthesis`; tools: {}.\n\n\
         Area is the module alone, combinational, multipliers in DSP blocks (`synth_ice40 -dsp`, `synth_ecp5`). A clock is that of the module \
         between registers of inputs and outputs, without registers inside: one block in one cycle, {} seeds, median (lowest to highest). Differences \
         below 2 % are noise. iCE40: UP5K (8 multipliers, slow) where it fits, else HX8K (none), else `too large`; modules above {} logic cells \
         are not placed here (`--place`). \
         ECP5: LFE5U-85F, speed grade 6. `roughxel_fragment` is the whole pipelined top of a mirror without bumps or footprint \
         (`--effects none`), without and with `--depth 24`. The full plan needs more multipliers than the largest ECP5 has \
         (`roughxel cost`). A module that several designs share to the letter stands with the first of them; the same block in other \
         surroundings may need other bits.\n",
        versions.join("; "),
        arguments.seeds,
        arguments.place
    );
    for profile in &arguments.profiles {
        let _ = write!(
            text,
            "\n## {profile}\n\n| design | module | iCE40 LUTs | carries | MAC16 | clock, MHz | ECP5 LUTs | CCU2C | MULT18 | clock, MHz |\n\
             |---|---|---|---|---|---|---|---|---|---|\n"
        );
        let mut seen = Vec::new();
        for (_, module) in jobs.iter().filter(|(of, _)| of == profile) {
            let key = (module.name.clone(), module.hash.clone());
            let Some(outcome) = outcomes.get(&key) else { continue };
            if seen.contains(&key) {
                continue;
            }
            seen.push(key);
            let note =
                if module.clocked && module.sources.to_string_lossy().ends_with("_24") { ", depth 24" } else { "" };
            let Outcome { ice40, ecp5, ice40_clock, ecp5_clock } = outcome;
            let _ = writeln!(
                text,
                "| {} | `{}`{note} | {} | {} | {} | {} | {} | {} | {} | {} |",
                module.design,
                module.name,
                ice40.luts,
                ice40.carries,
                ice40.multipliers,
                clock_text(ice40_clock),
                ecp5.luts,
                ecp5.carries,
                ecp5.multipliers,
                clock_text(ecp5_clock)
            );
        }
    }
    text
}

fn clock_text(clock: &Clock) -> String {
    match clock {
        Clock::TooLarge => "too large".to_owned(),
        Clock::NotPlaced => "not placed".to_owned(),
        Clock::Failed(why) => format!("no: {}", why.replace('|', "/")),
        Clock::Reached { device, megahertz } => match megahertz.as_slice() {
            [] => "no path".to_owned(),
            [only] => format!("{only:.1} ({device})"),
            all => format!("{:.1} ({:.1}–{:.1}, {device})", all[all.len() / 2], all[0], all[all.len() - 1]),
        },
    }
}
