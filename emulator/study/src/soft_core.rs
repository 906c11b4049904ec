//! Cost of accuracy on small processors, from `cargo firmware price --knobs` (`emulator/firmware/knobs.json`; its plan is the
//! reflection with all effects): instructions, bytes and stack on processors in QEMU, and predicted clocks of soft cores.
//!
//! Settings that were not priced have no price: nothing is interpolated. Prices exist for the named profiles, for every knob
//! alone at each of [`Knob::values`] with all else as in [`Precision::STANDARD`], and for [`Precision::grid`].

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;
use std::sync::LazyLock;

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;
use serde::Deserialize;

/// The processors, all without an operating system.
pub const TARGETS: [&str; 3] = ["riscv32imac", "riscv32i", "thumbv7m"];

/// Soft core that stands for all if only one is shown: the usual one of LiteX.
pub const CORE: &str = "vexriscv-standard";

/// Soft cores that stand for their kinds in tables: with a cache, with a multiplier and no cache, with neither.
pub const SHOWN_CORES: [&str; 3] = [CORE, "ibex-small", "picorv32"];

/// Cost of a fragment, from its surface to the probes on an environment.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
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

/// Cost of the same fragment in f32, by the library of its square roots, sines and similar functions.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Float {
    /// Instructions or clocks with `libm`.
    pub libm: f64,
    /// Instructions or clocks with `micromath`.
    pub micromath: f64,
}

/// Soft core.
#[derive(Debug, Deserialize)]
pub struct Core {
    /// Name in tables and on the command line.
    pub name: String,
    /// Configuration in words.
    pub about: String,
}

/// Prices of a setting by the name of the processor, and clocks by the name of the soft core.
#[derive(Deserialize)]
struct Point<T, C> {
    knobs: BTreeMap<String, u32>,
    price: BTreeMap<String, T>,
    clocks: BTreeMap<String, C>,
}

impl<T, C> Point<T, C> {
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
    cores: Vec<Core>,
    float: BTreeMap<String, Float>,
    float_clocks: BTreeMap<String, Float>,
    probes: Vec<Point<Probe, f64>>,
    /// Clocks of a fragment alone, and in a batch.
    points: Vec<Point<Price, [f64; 2]>>,
}

impl Table {
    fn point(&self, p: &Precision) -> Option<&Point<Price, [f64; 2]>> {
        self.points.iter().find(|point| point.agrees(p, Knob::ALL.into_iter().filter(|knob| has_effect(*knob))))
    }

    fn probe(&self, p: &Precision) -> Option<&Point<Probe, f64>> {
        self.probes.iter().find(|point| point.agrees(p, [Knob::FractionBits].into_iter()))
    }
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../firmware/knobs.json")).expect("knobs.json has the fields of this table")
});

/// Cost of a fragment at a setting on one of [`TARGETS`]. Knobs that do not affect the plan ([`has_effect`]) may have any value.
/// `None` if the setting was not priced, or no processor has that name.
pub fn price(target: &str, p: &Precision) -> Option<Price> {
    TABLE.point(p)?.price.get(target).copied()
}

/// Returns true if a knob changes the price of a fragment.
pub fn has_effect(knob: Knob) -> bool {
    !TABLE.no_effect.iter().any(|name| name == knob.name())
}

/// Cost of a probe at the width of a setting on one of [`TARGETS`]; the other knobs are those of [`Precision::of_width`]. `None`
/// if that width is not one of [`Knob::values`], or no processor has that name.
pub fn probe(target: &str, p: &Precision) -> Option<Probe> {
    TABLE.probe(p)?.price.get(target).copied()
}

/// Soft cores, in the order of `emulator/firmware/PRICE.md`.
pub fn cores() -> &'static [Core] {
    &TABLE.cores
}

/// Predicted clocks of a fragment at a setting on a soft core: the smaller number of a fragment alone and one in a batch. `None` as
/// for [`price`].
pub fn clocks(core: &str, p: &Precision) -> Option<f64> {
    let [alone, in_a_batch] = *TABLE.point(p)?.clocks.get(core)?;
    Some(alone.min(in_a_batch))
}

/// Predicted clocks of a probe with its texels and their filter on a soft core. `None` as for [`probe`].
pub fn probe_clocks(core: &str, p: &Precision) -> Option<f64> {
    TABLE.probe(p)?.clocks.get(core).copied()
}

/// Machine whose cost of a fragment is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// One of [`cores`]; its cost is in clocks.
    Core(&'static str),
    /// One of [`TARGETS`]; its cost is in instructions.
    Processor(&'static str),
}

impl Default for Machine {
    fn default() -> Self {
        Self::Core(CORE)
    }
}

impl Machine {
    /// Lists the cores, then the processors.
    pub fn all() -> impl Iterator<Item = Self> {
        let cores = cores().iter().map(|core| Self::Core(&core.name));
        cores.chain(TARGETS.into_iter().map(Self::Processor))
    }

    /// Name on the command line.
    pub const fn name(self) -> &'static str {
        let (Self::Core(name) | Self::Processor(name)) = self;
        name
    }

    /// Unit of its costs.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Core(_) => "clocks",
            Self::Processor(_) => "instructions",
        }
    }

    /// Cost of a fragment at a setting.
    pub fn fragment(self, p: &Precision) -> Option<f64> {
        match self {
            Self::Core(core) => clocks(core, p),
            Self::Processor(target) => price(target, p).map(|price| price.instructions),
        }
    }

    /// Cost of a probe with its texels at the width of a setting.
    pub fn probe(self, p: &Precision) -> Option<f64> {
        match self {
            Self::Core(core) => probe_clocks(core, p),
            Self::Processor(target) => probe(target, p).map(|probe| probe.with_texels),
        }
    }

    /// Cost of a fragment in f32.
    pub fn float(self) -> Option<Float> {
        match self {
            Self::Core(core) => TABLE.float_clocks.get(core).copied(),
            Self::Processor(target) => float(target),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} on {}", self.unit(), self.name())
    }
}

impl FromStr for Machine {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = || Self::all().map(Self::name).collect::<Vec<_>>().join(", ");
        Self::all()
            .find(|machine| machine.name() == text)
            .ok_or_else(|| format!("cores and processors are {}", names()))
    }
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
                for machine in Machine::all() {
                    let costs = [machine.fragment(&p), machine.probe(&p)];
                    assert!(costs.iter().all(|cost| cost.is_some_and(|cost| cost > 0.0)), "{machine} {p:?}");
                }
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
        assert_eq!((clocks(CORE, &p), probe_clocks(CORE, &p)), (None, None));
        assert_eq!((clocks("6502", &Precision::STANDARD), probe_clocks("6502", &Precision::STANDARD)), (None, None));
    }

    #[test]
    fn clocks_of_named_profiles_are_the_kept_predictions() {
        let kept: serde_json::Value =
            serde_json::from_str(include_str!("../../firmware/clocks.json")).expect("clocks.json is JSON");
        let (predicted, standard) = (&kept["predicted"], Precision::STANDARD);
        assert_eq!(predicted.as_object().map(serde_json::Map::len), Some(cores().len()));
        for Core { name, .. } in cores() {
            let of = |column: &str| predicted[name][column].as_f64();
            for (alone, batch, p) in [
                ("narrow", Some("narrow in a batch"), Precision::NARROW),
                ("standard", Some("standard in a batch"), standard),
                ("precise", None, Precision::PRECISE),
            ] {
                let [by_itself, in_a_batch] = TABLE.point(&p).expect("named profiles are priced").clocks[name];
                assert_eq!(Some(by_itself), of(alone), "{name}, {alone}");
                assert!(batch.is_none_or(|batch| Some(in_a_batch) == of(batch)), "{name}, {alone} in a batch");
                assert_eq!(clocks(name, &p), Some(by_itself.min(in_a_batch)), "{name}, {alone}");
            }
            assert_eq!(probe_clocks(name, &standard), of("a probe in standard"), "{name}");
            assert_eq!(TABLE.float_clocks.get(name).map(|float| float.libm), of("f32"), "{name}");
        }
    }

    #[test]
    fn machines_have_names_and_units() {
        for machine in Machine::all() {
            assert_eq!(machine.name().parse(), Ok(machine));
        }
        assert_eq!(Machine::all().count(), cores().len() + TARGETS.len());
        assert_eq!(Machine::default().to_string(), "clocks on vexriscv-standard");
        assert_eq!(Machine::Processor("riscv32i").to_string(), "instructions on riscv32i");
        assert!(SHOWN_CORES.into_iter().all(|core| cores().iter().any(|known| known.name == core)));
        let error = "6502".parse::<Machine>().unwrap_err();
        assert!(Machine::all().all(|machine| error.contains(machine.name())));
    }

    #[test]
    fn clocks_rank_settings_differently_than_instructions() {
        let instructions = Machine::Processor("riscv32imac");
        let swaps = |machine: Machine| {
            let settings: Vec<Precision> = Precision::grid().collect();
            let pairs = settings.iter().flat_map(|a| settings.iter().map(move |b| (a, b)));
            let is_cheaper = |on: Machine, a: &Precision, b: &Precision| on.fragment(a) < on.fragment(b);
            pairs.filter(|(a, b)| is_cheaper(machine, a, b) && is_cheaper(instructions, b, a)).count()
        };
        for core in SHOWN_CORES {
            assert!(swaps(Machine::Core(core)) > 0, "{core}");
        }
    }
}
