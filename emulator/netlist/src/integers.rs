//! Bundles of the scalar backend as integers, in the order of ports and outputs of a net.

use roughxel_core::bundle::{Bundle, Rewire};
use roughxel_core::design::Form;
use roughxel_core::precision::Precision;
use roughxel_core::width::narrowed;
use roughxel_core::word::Word;

/// Integers on the wires of a scalar bundle, in the order of its walk.
#[derive(Default)]
struct Values(Vec<i64>);

impl<S: Word<Count = i32, Flag = bool> + Into<i64>> Rewire<S, S> for Values {
    fn word(&mut self, wire: S, _: u32) -> S {
        self.0.push(wire.into());
        wire
    }
    fn control(&mut self, wire: i32, _: u32) -> i32 {
        self.0.push(wire.into());
        wire
    }
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        self.0.push(wire);
        wire
    }
    fn flag(&mut self, wire: bool) -> bool {
        self.0.push(wire.into());
        wire
    }
}

/// Integers on the wires of a scalar bundle, in the order of ports and outputs of a net.
pub fn integers<B: Bundle<i32>>(bundle: &B) -> Vec<i64> {
    integers_on::<i32, B>(bundle)
}

/// Integers on the wires, on words of the profile's width, as on the ports of that profile's nets.
pub fn integers_at<B: Form>(bundle: &B, p: &Precision) -> Vec<i64> {
    if p.word_bits() == 16 { integers_on::<i16, _>(&narrowed(bundle)) } else { integers(bundle) }
}

/// Integers on the wires, on words of any width.
pub fn integers_on<S: Word<Count = i32, Flag = bool> + Into<i64>, B: Bundle<S>>(bundle: &B) -> Vec<i64> {
    let mut values = Values::default();
    bundle.rewire::<S, _>(&mut values);
    values.0
}

/// Puts given integers on the wires of a scalar bundle.
struct Given<'a>(std::slice::Iter<'a, i64>);

impl Given<'_> {
    fn next(&mut self, instead: i64) -> i64 {
        self.0.next().copied().unwrap_or(instead)
    }
}

impl Rewire<i32, i32> for Given<'_> {
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.next(wire.into()) as i32
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        self.next(wire)
    }
    fn flag(&mut self, wire: bool) -> bool {
        self.next(wire.into()) != 0
    }
}

/// A scalar bundle of the same form with other integers on its wires: the inverse of [`integers`]. Wires beyond the integers keep their values; an
/// integer wraps to the bits of its wire.
pub fn filled<B: Bundle<i32>>(form: &B, integers: &[i64]) -> B::In<i32> {
    form.rewire(&mut Given(integers.iter()))
}
