//! Wires of ports as numbers of fields, without the low bits that a profile drops.

use core::slice::Iter;

use roughxel_core::bundle::{Bundle, End, Keeps, Rewire, Step};
use roughxel_core::precision::Precision;

/// One number for each wire of a bundle, in the order of its walk.
pub(crate) type Numbers<const COUNT: usize> = [i32; COUNT];

/// Fraction bits of a mantissa's port. A word with more bits before its point keeps that many fewer after it.
const MANTISSA_FRACTION: u32 = 30;

/// Wires of a bundle with these numbers, or the place of the first number that is out of range.
pub(crate) fn wires_of<B: Bundle<i32, In<i32> = B>, const COUNT: usize>(
    numbers: &Numbers<COUNT>,
    p: &Precision,
) -> Result<B, usize> {
    let (low, high) = range::<B, COUNT>(p);
    let mut limits = low.iter().zip(&high);
    let is_out = |number: &i32| limits.next().is_none_or(|(low, high)| number < low || number > high);
    match numbers.iter().position(is_out) {
        Some(place) => Err(place),
        None => Ok(B::limit::<i32>(End::Low).rewire(&mut ToWires { drop: Drop::new(p), numbers: numbers.iter() })),
    }
}

/// Numbers of a bundle's wires. The dropped low bits are zeros.
pub(crate) fn numbers_of<B: Bundle<i32>, const COUNT: usize>(bundle: &B, p: &Precision) -> Numbers<COUNT> {
    let mut numbers = [0; COUNT];
    bundle.rewire(&mut ToNumbers { drop: Drop::new(p), numbers: numbers.iter_mut() });
    numbers
}

/// Lowest and highest numbers of a bundle's wires.
pub(crate) fn range<B: Bundle<i32>, const COUNT: usize>(p: &Precision) -> (Numbers<COUNT>, Numbers<COUNT>) {
    let limits = |end| numbers_of(&B::limit::<i32>(end), p);
    (limits(End::Low), limits(End::High))
}

/// Low bits of a wire that a profile drops.
struct Drop<'a> {
    p: &'a Precision,
    /// Bits kept of the innermost field with a unit.
    keeps: Keeps,
}

impl<'a> Drop<'a> {
    fn new(p: &'a Precision) -> Self {
        Self { p, keeps: Keeps::Fraction }
    }

    fn enter(&mut self, step: Step) {
        if let Step::Field(field) = step
            && !field.unit.is_empty()
        {
            self.keeps = field.keeps;
        }
    }

    fn of_word(&self) -> u32 {
        MANTISSA_FRACTION.saturating_sub(self.p.fraction_bits)
    }

    fn of_control(&self, fraction_bits: u32) -> u32 {
        match self.keeps {
            Keeps::Lod => fraction_bits.saturating_sub(self.p.lod_bits),
            Keeps::Fraction => 0,
        }
    }
}

struct ToWires<'a> {
    drop: Drop<'a>,
    numbers: Iter<'a, i32>,
}

impl ToWires<'_> {
    fn next(&mut self, drop: u32) -> i32 {
        self.numbers.next().map_or(0, |number| number.wrapping_shl(drop))
    }
}

impl Rewire<i32, i32> for ToWires<'_> {
    fn enter(&mut self, step: Step) {
        self.drop.enter(step);
    }
    fn word(&mut self, _: i32, _: u32) -> i32 {
        self.next(self.drop.of_word())
    }
    fn control(&mut self, _: i32, fraction_bits: u32) -> i32 {
        self.next(self.drop.of_control(fraction_bits))
    }
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        wire
    }
    fn flag(&mut self, wire: bool) -> bool {
        wire
    }
}

struct ToNumbers<'a> {
    drop: Drop<'a>,
    numbers: core::slice::IterMut<'a, i32>,
}

impl ToNumbers<'_> {
    fn put(&mut self, wire: i32, drop: u32) -> i32 {
        if let Some(number) = self.numbers.next() {
            *number = wire.wrapping_shr(drop);
        }
        wire
    }
}

impl Rewire<i32, i32> for ToNumbers<'_> {
    fn enter(&mut self, step: Step) {
        self.drop.enter(step);
    }
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.put(wire, self.drop.of_word())
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.put(wire, self.drop.of_control(fraction_bits))
    }
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        wire
    }
    fn flag(&mut self, wire: bool) -> bool {
        wire
    }
}
