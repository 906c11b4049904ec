//! Elements of random sets drawn in groups equal those drawn alone.

use std::ops::Range;

use roughxel_cases::highlight::{random_light, random_lights};
use roughxel_cases::lit_peak::{random_lit_peak, random_lit_peaks};
use roughxel_cases::{random_fragment, random_fragments};
use roughxel_core::bundle::Bundle;
use roughxel_core::design::Form;
use roughxel_core::ports::Port;
use roughxel_core::precision::Precision;
use roughxel_netlist::integers::integers;
use roughxel_shader::Batch;

/// Compares elements of a set drawn alone with the same elements drawn in groups.
fn hold<P>(
    p: &Precision,
    one: impl Fn(&str, u64, &Precision) -> P,
    many: impl Fn(&str, Range<u64>, &Precision, &mut Batch<P::Wires>),
) where
    P: Port<Wires: Form + Bundle<i32, In<i32> = P::Wires>>,
{
    let mut batch = Batch::default();
    // Whole groups of lanes, parts of them, none; the batch keeps nothing of earlier ones.
    for indices in [0..3000, 5..6, 70..70, 100..117, (1 << 40) + 3..(1 << 40) + 500] {
        many("draws", indices.clone(), p, &mut batch);
        assert_eq!(batch.len() as u64, indices.end - indices.start);
        for (place, index) in indices.enumerate() {
            let [many, one] = [batch.get(place), one("draws", index, p).wires()].map(|ports| integers(&ports));
            assert_eq!(many, one, "element {index}");
        }
    }
}

#[test]
fn elements_side_by_side_are_those_one_by_one() {
    for p in [Precision::NARROW, Precision::STANDARD, Precision::PRECISE] {
        hold(&p, random_fragment, random_fragments);
        hold(&p, random_light, random_lights);
        hold(&p, random_lit_peak, random_lit_peaks);
    }
}
