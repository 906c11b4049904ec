//! Names, ranges and plans.

use std::collections::BTreeSet;

use roughxel_core::bundle::{Bundle, End, Rewire, Step, is_constant};
use roughxel_core::design::{Design, ScaledReflectionInput};
use roughxel_core::knob::Knob;
use roughxel_core::plan::{
    Datapath, Effects, FootprintKind, FrameSystem, HorizonKind, PeakPlan, ReflectionPlan, SurfacePlan,
};
use roughxel_core::precision::{AxisDirection, Newton, Precision, ProbeRule, ProbeWeights, Profile, RoughnessKind};
use roughxel_core::status::StatusBit;

use crate::scalar_api::{FOOTPRINTS, ROUGHNESS};

/// Checks names: none is empty, none occurs twice, and parsing a name finds its value.
fn are_names<T: PartialEq + std::fmt::Debug>(all: &[T], name: impl Fn(&T) -> &str, find: impl Fn(&str) -> Option<T>) {
    let names: BTreeSet<&str> = all.iter().map(&name).collect();
    assert_eq!(names.len(), all.len());
    assert!(names.iter().all(|name| name.len() > 3));
    for item in all {
        assert_eq!(find(name(item)).as_ref(), Some(item));
    }
    assert_eq!(find("xyzzy"), None);
}

pub(crate) fn everything_with_a_name_is_found_by_it() {
    are_names(&Profile::ALL, |profile| profile.name(), Profile::by_name);
    are_names(&Knob::ALL, |knob| knob.name(), Knob::by_name);
    are_names(Design::ALL, |design| design.name(), Design::by_name);
    are_names(
        &Datapath::ALL,
        |datapath| datapath.name(),
        |name| Datapath::ALL.into_iter().find(|datapath| datapath.name() == name),
    );
    are_names(StatusBit::ALL, |bit| bit.name(), |name| StatusBit::ALL.iter().copied().find(|bit| bit.name() == name));
    assert_eq!(Profile::ALL.map(Profile::name), Profile::NAMES);
    assert_eq!(["Standard", ""].map(Profile::by_name), [None; 2]);
    assert_eq!(Knob::by_name("seed_bits"), None);
    assert_eq!(format!("{:>0}", Knob::ReciprocalSteps), Knob::ReciprocalSteps.name());
    for design in Design::ALL {
        assert!(design.description().len() > 8 && design.description() == design.description().trim());
    }
}

/// Counts the wires of a bundle that are constants of an object.
#[derive(Default)]
struct Constants {
    path: Vec<Step>,
    count: usize,
}

impl Rewire<i32, i32> for Constants {
    fn enter(&mut self, step: Step) {
        self.path.push(step);
    }
    fn leave(&mut self) {
        self.path.pop();
    }
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.count += usize::from(is_constant(&self.path));
        wire
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        wire
    }
    fn flag(&mut self, flag: bool) -> bool {
        flag
    }
}

pub(crate) fn what_is_declared_per_object_is_a_constant_with_all_its_parts() {
    let mut constants = Constants::default();
    ScaledReflectionInput::<i32>::limit::<i32>(End::Low).rewire(&mut constants);
    // The edge of the fragment, and both numbers of the map.
    assert_eq!(constants.count, 3);
    assert!(!is_constant(&[]) && !is_constant(&[Step::Index(0)]));
}

pub(crate) fn a_datapath_is_a_design_with_the_status_bits_that_its_stages_raise() {
    for (datapath, design, bits) in [
        (Datapath::Reflection, Design::Fragment, 0x0ff),
        (Datapath::Highlight, Design::Highlight, 0xf07),
        (Datapath::Peak, Design::LitPeak, 0x3707),
    ] {
        assert_eq!(Design::for_datapath(datapath), design);
        assert_eq!(design.datapath(), Some(datapath));
        let masks: Vec<u32> = StatusBit::raised_by(datapath).map(StatusBit::mask).collect();
        assert!(masks.is_sorted());
        assert_eq!(masks.iter().sum::<u32>(), bits, "{datapath:?}");
    }
    let whole = Design::ALL.iter().filter(|design| design.datapath().is_some());
    assert_eq!(whole.count(), 4);
}

pub(crate) fn a_knob_has_the_values_of_its_range_and_no_others() {
    let p = Precision::STANDARD;
    let accepted = |knob: Knob, value: u32| knob.with(value, p).checked();
    for (knob, low, high) in [
        (Knob::FractionBits, 12, 28),
        (Knob::ReciprocalSeedBits, 6, 10),
        (Knob::InverseRootSeedBits, 6, 10),
        (Knob::ReciprocalSteps, 0, 2),
        (Knob::InverseRootSteps, 0, 2),
        (Knob::MaxProbes, 1, 16),
        (Knob::LodBits, 2, 12),
        (Knob::WeightBits, 2, 10),
        (Knob::RoughnessBits, 4, 16),
    ] {
        for value in (0..40).chain([u32::MAX]) {
            let expected = if (low..=high).contains(&value) { Ok(knob.with(value, p)) } else { Err(knob) };
            assert_eq!(accepted(knob, value), expected, "{knob} {value}");
        }
        assert_eq!(knob.range(), format!("{low} to {high}"));
        assert!(knob.choices().is_empty());
    }
    for value in 0..80 {
        let expected = value == 0 || (value % 2 == 0 && value <= 64);
        assert_eq!(accepted(Knob::Direction, value).is_ok(), expected, "{value}");
    }
    let none = Precision { direction: AxisDirection::Table { steps: 0 }, ..p };
    assert_eq!(none.checked(), Err(Knob::Direction));
    assert_eq!(Knob::Direction.range(), "exact, or a table of 2 to 64 steps, an even number");
    for (knob, count) in [(Knob::ProbeRule, 2), (Knob::ProbeWeights, 2), (Knob::Roughness, 3)] {
        assert_eq!(knob.choices().len(), count);
        assert!(knob.choices().iter().all(|choice| knob.range().contains(choice)), "{knob}");
        assert!((0..count as u32).all(|value| accepted(knob, value).is_ok()));
    }
}

pub(crate) fn a_knob_that_is_set_has_that_value_and_is_read_as_it_is_written() {
    for knob in Knob::ALL {
        assert!(knob.values().len() > 1);
        for profile in Profile::ALL {
            let p = profile.precision();
            assert_eq!(knob.with(knob.value_in(&p), p), p);
            for &value in knob.values() {
                let set = knob.with(value, p);
                assert_eq!(knob.value_in(&set), value);
                assert_eq!(set.checked(), Ok(set), "{knob} {value}");
                // No other knob moves.
                assert!(Knob::ALL.into_iter().all(|other| other == knob || other.value_in(&set) == other.value_in(&p)));
                assert_eq!(knob.read(&knob.text(value).to_string()), Some(value), "{knob} {value}");
            }
        }
        let choices = (0..).take(knob.choices().len()).map(|value| knob.text(value).to_string());
        assert!(choices.eq(knob.choices().iter().copied()), "{knob}");
        assert_eq!(knob.read("xyzzy"), None);
        assert_eq!(knob.read("exact"), (knob == Knob::Direction).then_some(0));
        // A choice has a name, not a number.
        assert_eq!(knob.read("1"), knob.choices().is_empty().then_some(1));
        assert_eq!(
            knob.with(1, Precision::STANDARD).probe_weights == ProbeWeights::Gaussian,
            knob == Knob::ProbeWeights
        );
    }
    assert_eq!(Knob::Direction.text(0).to_string(), "exact");
    assert_eq!(Knob::Direction.text(10).to_string(), "10");
    assert_eq!(Knob::ReciprocalSteps.text(0).to_string(), "0");
    assert_eq!(Knob::Roughness.text(2).to_string(), "anisotropic");
}

pub(crate) fn precisions_of_a_width_are_profiles_with_that_width() {
    for bits in 12..=28 {
        let wider = match bits {
            12..=14 => Precision::NARROW,
            15..=16 => Precision::COMPACT,
            17..=20 => Precision::STANDARD,
            _ => Precision::PRECISE,
        };
        let p = Precision::of_width(bits);
        assert_eq!(p, Precision { fraction_bits: bits, ..wider });
        assert_eq!(p.word_bits(), if bits <= 14 { 16 } else { 32 });
        assert_eq!(p.offset_bits() + 2, bits);
    }
    let grid: Vec<Precision> = Precision::grid().collect();
    assert_eq!(grid.len(), 54);
    assert!(grid.is_sorted_by_key(|p| p.fraction_bits));
    for (i, p) in grid.iter().enumerate() {
        assert!(p.checked().is_ok() && !grid[..i].contains(p));
    }
}

pub(crate) fn profiles_have_the_knobs_that_the_manifests_of_sets_name() {
    let newton = |seed_bits, steps| Newton { seed_bits, steps };
    let paper = Precision {
        fraction_bits: 16,
        reciprocal: newton(8, 1),
        inverse_root: newton(8, 1),
        direction: AxisDirection::Table { steps: 10 },
        max_probes: 16,
        probe_rule: ProbeRule::PowerOfTwo,
        probe_weights: ProbeWeights::Box,
        lod_bits: 4,
        weight_bits: 6,
        roughness: RoughnessKind::Anisotropic,
        roughness_bits: 8,
    };
    let compact = Precision {
        direction: AxisDirection::Exact,
        probe_rule: ProbeRule::Ceiling,
        lod_bits: 6,
        weight_bits: 8,
        ..paper
    };
    let (ten, twice) = (newton(10, 1), newton(8, 2));
    let standard =
        Precision { fraction_bits: 20, reciprocal: ten, inverse_root: ten, lod_bits: 8, roughness_bits: 12, ..compact };
    let precise = Precision {
        fraction_bits: 26,
        reciprocal: twice,
        inverse_root: twice,
        lod_bits: 12,
        weight_bits: 10,
        roughness_bits: 16,
        ..standard
    };
    let narrow = Precision { fraction_bits: 14, ..compact };
    let all = [narrow, paper, compact, standard, precise];
    assert_eq!(Profile::ALL.map(Profile::precision), all);
    assert!(all.iter().all(|p| p.checked() == Ok(*p)));
    let grid: Vec<Precision> = Precision::grid().collect();
    assert!([narrow, compact, standard, precise].iter().all(|p| grid.contains(p)));
}

pub(crate) fn a_frame_is_needed_for_bumps_roughness_and_what_is_local() {
    for bump in [false, true] {
        for local in [false, true] {
            for roughness in ROUGHNESS {
                let plan = SurfacePlan { bump, frame: FrameSystem::Natural, roughness, local };
                let needed = bump || local || roughness != RoughnessKind::None;
                assert_eq!(plan.needs_frame(), needed, "{plan:?}");
            }
        }
    }
}

pub(crate) fn plans_have_of_the_effects_what_their_datapath_knows() {
    let all = Effects {
        bump: true,
        frame: FrameSystem::NaturalNormalised,
        roughness: RoughnessKind::Isotropic,
        curvature: true,
        footprint: FootprintKind::Sphere,
        horizon: HorizonKind::Product,
    };
    let none = HorizonKind::None;
    assert_eq!(all.restricted_to(Datapath::Reflection), Effects { horizon: none, ..all });
    let Effects { bump, frame, roughness, horizon, .. } = all;
    assert_eq!(all.restricted_to(Datapath::Highlight), Effects { bump, frame, roughness, ..Effects::NONE });
    assert_eq!(all.restricted_to(Datapath::Peak), Effects { frame, horizon, ..Effects::NONE });
    let surface = SurfacePlan { bump: false, frame, roughness: RoughnessKind::None, local: true };
    assert_eq!(PeakPlan { frame, horizon }.surface(), surface);
    assert!(!all.highlight().local);

    let plan = all.reflection();
    assert_eq!(plan.surface(), SurfacePlan { bump: true, frame, roughness, local: false });
    // Without a footprint, the roughness is not asked for.
    let smooth = ReflectionPlan { bump: false, footprint: FootprintKind::None, ..plan };
    assert_eq!(smooth.surface().roughness, RoughnessKind::None);
    assert!(plan.needs_frame() && !smooth.needs_frame());
    assert_eq!(plan.on_face(), ReflectionPlan { footprint: FootprintKind::Face, ..plan });
    assert_eq!(smooth.on_face(), smooth);
    assert_eq!(plan.on_face().on_sphere(), plan);
    assert_eq!(smooth.on_sphere().footprint, FootprintKind::Sphere);
    let has = FOOTPRINTS.map(FootprintKind::is_some);
    assert_eq!(has, [false, true, true]);
}
