//! Results of every recorded design, in a backend whose integers are visible.
//!
//! They are the expected values of nets, their evaluator and generated hardware: the same functions of the composer.

use roughxel_cases::stimulus::{port_values, within};
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::bundle::{Bundle, End};
use roughxel_core::design::{Design, Recorded, Visitor};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_netlist::graph::Net;
use roughxel_utilities::random::SplitMix64;

use crate::checked::{Checked, CheckedWire, Integers, OperationCounts, Visible, counted, filled, first_difference};

/// Computes a design in the scalar backend, on words of the profile's width.
pub fn scalar(design: Design, ports: &[i64], effects: &Effects, p: &Precision) -> Integers {
    match p.word_bits() {
        16 => outcome::<i16>(design, ports, effects, p),
        _ => outcome::<i32>(design, ports, effects, p),
    }
}

/// Computes a design in the checked backend.
pub fn checked(design: Design, ports: &[i64], effects: &Effects, p: &Precision) -> Integers {
    match p.word_bits() {
        16 => outcome::<CheckedWire<i16>>(design, ports, effects, p),
        _ => outcome::<Checked>(design, ports, effects, p),
    }
}

/// Checks the checked backend of a design against the scalar one. Returns the results, and the operations that they take.
///
/// # Panics
/// If two wires differ (with the first ones that do), or if an operation leaves its wire.
pub fn same_when_checked(
    design: Design,
    ports: &[i64],
    effects: &Effects,
    p: &Precision,
) -> (Integers, OperationCounts) {
    let scalar = scalar(design, ports, effects, p);
    let (checked, counts) = counted(|| checked(design, ports, effects, p));
    let difference = first_difference(&scalar, &checked);
    assert_eq!(scalar, checked, "{} of {ports:?}: {difference:?}", design.name());
    (scalar, counts)
}

/// Computes a design in a backend whose integers are visible.
///
/// `ports` are the integers of the design's ports in the order of their bundle. Panics if there are fewer or more.
fn outcome<W: Visible>(design: Design, ports: &[i64], effects: &Effects, p: &Precision) -> Integers {
    struct Run<'a, W> {
        ports: &'a [i64],
        effects: &'a Effects,
        p: &'a Precision,
        backend: core::marker::PhantomData<W>,
    }
    impl<W: Visible> Visitor for Run<'_, W> {
        type Outcome = Integers;
        fn visit<D: Recorded>(self) -> Integers {
            let input = filled::<W, D::Input>(&D::Input::limit::<i32>(End::Low), self.ports);
            Integers::from_bundle(&D::run::<W>(&input, self.effects, self.p))
        }
    }
    design.visit(Run::<W> { ports, effects, p, backend: core::marker::PhantomData })
}

/// Ports of a design: at least `count` vectors, from random fragments, every hard case of the plan, and integers anywhere
/// in the declared ranges.
pub fn inputs(design: Design, net: &Net, count: usize, effects: &Effects, p: &Precision) -> Vec<Vec<i64>> {
    let name = design.name();
    let whole = matches!(design, Design::Fragment | Design::Reflection);
    let plan = effects.reflection();
    let cases = hard_case_sets(p).into_iter().filter(|set| set.plan == plan || plan != Effects::ALL.reflection());
    // Only designs that take a whole fragment see each hard case.
    let hard = cases.flat_map(|set| set.cases).step_by(if whole { 1 } else { 10 });
    let random = (0..count as u64 * 3 / 4).map(|index| random_fragment("rtl", index, p));
    let mut vectors = Vec::new();
    for (index, fragment) in (0..).zip(hard.chain(random)) {
        if whole || vectors.len() < count {
            let mut random = SplitMix64::for_element(name, index);
            vectors.extend(port_values(design, net, &fragment, effects, p, &mut random));
        }
    }
    // Ports of a probe are consistent.
    if !name.ends_with("_probe") {
        let mut random = SplitMix64::for_element(name, u64::MAX);
        let mut anywhere = || net.ports.iter().map(|port| within(port.low, port.high, &mut random)).collect();
        vectors.extend((0..count / 4).map(|_| anywhere()));
    }
    vectors
}

/// Integers of the outputs, by the scalar backend.
pub fn expected(design: Design, ports: &[i64], effects: &Effects, p: &Precision) -> Vec<i64> {
    scalar(design, ports, effects, p).values().to_vec()
}
