//! Bundles: structures of wires that can be walked, so that a reading names, converts or compares every wire of one.
//!
//! A walk visits the wires of a bundle in the order of its fields and may put other wires, of another reading, in
//! their place. Names are paths of fields and indices; nothing is allocated.

use crate::each::{each, places};
use crate::fx::Fx;
use crate::word::Word;

/// One step on the way to a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A field of a structure.
    Field(&'static str),
    /// A place in an array.
    Index(usize),
}

/// A walk over the wires of a bundle that puts a wire of the reading `V` in the place of each of `W`.
pub trait Rewire<W: Word, V: Word> {
    /// The wires up to the matching [`Self::leave`] are below `step`.
    #[inline(always)]
    fn enter(&mut self, step: Step) {
        let _ = step;
    }
    /// Ends the last step.
    #[inline(always)]
    fn leave(&mut self) {}
    /// A word.
    fn word(&mut self, wire: W, fraction_bits: u32) -> V;
    /// A wide wire.
    fn wide(&mut self, wire: W::Wide, fraction_bits: u32) -> V::Wide;
    /// A flag.
    fn flag(&mut self, wire: W::Flag) -> V::Flag;

    /// Walks a part of a bundle below `step`.
    #[inline(always)]
    fn part<B: Bundle<W>>(&mut self, step: Step, part: &B) -> B::In<V>
    where
        Self: Sized,
    {
        self.enter(step);
        let other = part.rewire(self);
        self.leave();
        other
    }
}

/// A structure of wires.
pub trait Bundle<W: Word> {
    /// The same structure in another reading.
    type In<V: Word>: Copy;
    /// Walks all wires in the order of the fields.
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> Self::In<V>;
}

impl<W: Word, const FRAC: u32> Bundle<W> for Fx<W, FRAC> {
    type In<V: Word> = Fx<V, FRAC>;
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> Fx<V, FRAC> {
        Fx::from_raw(with.word(self.raw(), FRAC))
    }
}

impl<W: Word, B: Bundle<W>, const N: usize> Bundle<W> for [B; N] {
    type In<V: Word> = [B::In<V>; N];
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> [B::In<V>; N] {
        each!(index in places() => with.part(Step::Index(index), &self[index]))
    }
}

/// Implements [`Bundle`] for a structure of bundles, `wide` wires and `flag`s: `bundle!(Name { a, b; wide c; flag d })`.
#[macro_export]
macro_rules! bundle {
    ($name:ident $(<$size:ident>)? { $($field:ident),* $(; wide $($wide:ident),+)? $(; flag $($flag:ident),+)? }) => {
        impl<W: $crate::word::Word $(, const $size: usize)?> $crate::bundle::Bundle<W> for $name<W $(, $size)?> {
            type In<V: $crate::word::Word> = $name<V $(, $size)?>;
            #[inline(always)]
            fn rewire<V: $crate::word::Word, R: $crate::bundle::Rewire<W, V>>(&self, with: &mut R) -> Self::In<V> {
                $name {
                    $($field: with.part($crate::bundle::Step::Field(stringify!($field)), &self.$field),)*
                    $($($wide: {
                        with.enter($crate::bundle::Step::Field(stringify!($wide)));
                        let mut index = 0;
                        let wires = $crate::each!(wire in self.$wide => {
                            with.enter($crate::bundle::Step::Index(index));
                            let other = $crate::bundle::wide_wire(wire, with);
                            with.leave();
                            index += 1;
                            other
                        });
                        with.leave();
                        wires
                    },)+)?
                    $($($flag: {
                        with.enter($crate::bundle::Step::Field(stringify!($flag)));
                        let flag = with.flag(self.$flag);
                        with.leave();
                        flag
                    },)+)?
                }
            }
        }
    };
}
pub use crate::bundle;

/// One wide wire of a walk; [`bundle!`](crate::bundle!) uses it.
#[inline(always)]
pub fn wide_wire<W: Word, V: Word, R: Rewire<W, V>, const FRAC: u32>(
    wire: Fx<W::Wide, FRAC>,
    with: &mut R,
) -> Fx<V::Wide, FRAC> {
    Fx::from_raw(with.wide(wire.raw(), FRAC))
}
