//! Cost of accuracy on small processors: instructions, bytes and stack, as counted by `cargo firmware price --knobs`
//! (`emulator/firmware/knobs.json`; its plan is the reflection with all effects).
//!
//! Settings that were not priced have no price: nothing is interpolated. Prices exist for the named profiles, for every knob
//! alone at each of [`Knob::values`] with all else as in [`Precision::STANDARD`], and for [`Precision::grid`].

use std::collections::BTreeMap;
use std::sync::LazyLock;

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;
use serde::{Deserialize, Serialize};

/// The processors, all without an operating system.
pub const TARGETS: [&str; 3] = ["riscv32imac", "riscv32i", "thumbv7m"];

/// The one of [`TARGETS`] that stands for all if only one is shown: the smallest with a multiplier.
pub const TARGET: &str = "riscv32imac";

/// Cost of a fragment, from its surface to the probes on an environment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Price {
    /// Instructions, a mean over the fragments of one tile; they are not cycles.
    pub instructions: f64,
    /// Bytes of code, constants and tables.
    pub bytes: u32,
    /// Bytes of stack.
    pub stack: u32,
}

/// Cost of a probe of an environment, in instructions: a mean over the probes of those fragments.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Probe {
    /// Instructions for its position and weight.
    pub place_and_weight: f64,
    /// Instructions for position, weight, eight texels and their filter.
    pub with_texels: f64,
}

/// Cost of the same fragment in f32, in instructions, by the library of its square roots, sines and similar functions.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Float {
    /// Instructions with `libm`.
    pub libm: f64,
    /// Instructions with `micromath`.
    pub micromath: f64,
}

/// Prices of a setting by the name of the processor.
#[derive(Deserialize)]
struct Point<T> {
    knobs: BTreeMap<String, u32>,
    price: BTreeMap<String, T>,
}

impl<T> Point<T> {
    /// Returns true if these knobs are as in a precision.
    fn agrees(&self, p: &Precision, mut knobs: impl Iterator<Item = Knob>) -> bool {
        knobs.all(|knob| self.knobs.get(knob.name()) == Some(&knob.value_in(p)))
    }
}

/// The file.
#[derive(Deserialize)]
struct Table {
    rustc: String,
    no_effect: Vec<String>,
    float: BTreeMap<String, Float>,
    probes: Vec<Point<Probe>>,
    points: Vec<Point<Price>>,
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../firmware/knobs.json")).expect("knobs.json has the fields of this table")
});

/// Cost of a fragment at a setting on one of [`TARGETS`]. Knobs that do not affect the plan ([`has_effect`]) may have any value.
/// `None` if the setting was not priced, or no processor has that name.
pub fn price(target: &str, p: &Precision) -> Option<Price> {
    let point =
        TABLE.points.iter().find(|point| point.agrees(p, Knob::ALL.into_iter().filter(|knob| has_effect(*knob))))?;
    point.price.get(target).copied()
}

/// Returns true if a knob changes the price of a fragment.
pub fn has_effect(knob: Knob) -> bool {
    !TABLE.no_effect.iter().any(|name| name == knob.name())
}

/// Cost of a probe at the width of a setting on one of [`TARGETS`]; the other knobs are those of [`Precision::of_width`]. `None`
/// if that width is not one of [`Knob::values`], or no processor has that name.
pub fn probe(target: &str, p: &Precision) -> Option<Probe> {
    let point = TABLE.probes.iter().find(|point| point.agrees(p, [Knob::FractionBits].into_iter()))?;
    point.price.get(target).copied()
}

/// Cost of the fragment in f32 on one of [`TARGETS`]. `None` if no processor has that name.
pub fn float(target: &str) -> Option<Float> {
    TABLE.float.get(target).copied()
}

/// The compiler of the priced programs, as `rustc --version` prints it.
pub fn rustc() -> &'static str {
    &TABLE.rustc
}

#[cfg(test)]
mod tests {
    use roughxel_core::precision::Profile;

    use super::*;

    /// The cells of a row of `emulator/firmware/PRICE.md` by their profiles, in the section of a target.
    fn cells<'a>(target: &str, row: &str) -> Vec<(Profile, &'a str)> {
        let table = include_str!("../../firmware/PRICE.md");
        let (_, part) = table.split_once(&format!("\n## {target}\n")).expect("the target has a section");
        let line = |start: &str| {
            let line =
                part.lines().find(|line| line.starts_with(&format!("| {start}"))).expect("the section has that row");
            line.trim_matches('|').split('|').skip(1).map(str::trim)
        };
        line("plan:").map(|name| Profile::by_name(name).expect("a column is a profile")).zip(line(row)).collect()
    }

    #[test]
    fn named_profiles_cost_what_the_table_of_plans_says() {
        for target in TARGETS {
            let price = |profile: Profile| price(target, &profile.precision()).expect("named profiles are priced");
            Profile::ALL.into_iter().for_each(|profile| _ = price(profile));
            for (profile, cell) in cells(target, "reflection, all effects |") {
                let Price { instructions, bytes, stack } = price(profile);
                assert_eq!(format!("{instructions} ({bytes}, {stack})"), cell, "{target} {}", profile.name());
            }
            let float = float(target).expect("f32 is priced");
            let in_standard = |row| cells(target, row).into_iter().find(|(profile, _)| *profile == Profile::Standard);
            assert_eq!(
                float.libm.to_string(),
                in_standard("reflection, all effects, in f32 with libm").unwrap().1,
                "{target}"
            );
            assert_eq!(
                probe(target, &Precision::STANDARD).unwrap().with_texels.to_string(),
                in_standard("a probe with its eight texels").unwrap().1
            );
            assert!(float.micromath < float.libm && price(Profile::Narrow).instructions < float.micromath);
        }
        assert!(rustc().starts_with("rustc "));
    }

    #[test]
    fn every_setting_to_choose_from_is_priced_and_other_knobs_do_not_matter() {
        for target in TARGETS {
            for p in Precision::grid() {
                assert!(price(target, &p).is_some() && probe(target, &p).is_some(), "{target} {p:?}");
            }
            for knob in Knob::ALL {
                for &value in knob.values() {
                    let (p, standard) = (knob.with(value, Precision::STANDARD), price(target, &Precision::STANDARD));
                    let priced = price(target, &p);
                    assert!(priced.is_some() && (has_effect(knob) || priced == standard), "{target} {knob} {value}");
                }
            }
        }
        assert!(!has_effect(Knob::WeightBits) && has_effect(Knob::LodBits));
    }

    #[test]
    fn what_was_not_priced_has_no_price() {
        let p = Precision { fraction_bits: 21, max_probes: 5, ..Precision::STANDARD };
        assert_eq!((price("riscv32imac", &p), probe("riscv32imac", &p)), (None, None));
        assert_eq!((price("6502", &Precision::STANDARD), float("6502")), (None, None));
    }
}
