//! Results of every recorded design, in a backend whose integers are visible.
//!
//! They are the expected values of nets, their evaluator and generated hardware: the same functions of the composer.

use roughxel_core::bundle::{Bundle, End};
use roughxel_core::design::{Design, Recorded, Visitor};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;

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
