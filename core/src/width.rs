//! Words as wide as the accuracy needs: a profile of at most 14 kept bits runs on words of 16 bits, any other on words of 32.
//!
//! Ports, maps and frames hold mantissas on words of 32 bits whatever the profile. [`on_words!`](crate::on_words!) calls a function of
//! the composer on words of the profile's width with those as its input, and gives back what it makes of them as words of 32
//! bits; who calls does not know which. What controls is the same on both. On a small processor they are the words of [`mod@crate::small`].

use crate::bundle::{Bundle, Rewire};
use crate::rom::upper;
use crate::scalar::Scalar;
use crate::small::{Full, Half, WideFull};
use crate::staged::Staged;
use crate::word::Word;

/// What controls in a reading that is integers of the processor which runs it: it finds texels by them.
pub trait IntegerCount: Word<Flag = bool> {
    /// That integer.
    fn of_integer(integer: i32) -> Self;
    /// The integer.
    fn integer(self) -> i32;
    /// That integer of 64 bits.
    fn wide_of_integer(integer: i64) -> Self::Wide;
    /// The integer.
    fn wide_integer(wide: Self::Wide) -> i64;
}

/// A word of such a reading.
pub trait IntegerWord: Staged<Flag = bool, Count: IntegerCount> {
    /// A word of 32 bits on this one: its upper bits, rounded to nearest, ties up; what would round up beyond the largest word stays that.
    fn of_port(word: Scalar) -> Self;
    /// The same number on a word of 32 bits, zeros behind it.
    fn to_port(self) -> Scalar;
}

macro_rules! integer_counts {
    ($($count:ty, |$integer:ident| $of:expr, $wide_of:expr, |$own:ident| $to:expr;)*) => {
        $(impl IntegerCount for $count {
            #[inline(always)]
            fn of_integer($integer: i32) -> Self {
                $of
            }
            #[inline(always)]
            fn integer(self) -> i32 {
                let $own = self;
                $to
            }
            #[inline(always)]
            fn wide_of_integer($integer: i64) -> Self::Wide {
                $wide_of
            }
            #[inline(always)]
            fn wide_integer($own: Self::Wide) -> i64 {
                $to
            }
        })*
    };
}

integer_counts! {
    i32, |integer| integer, integer, |own| own;
    Full, |integer| Full(integer), WideFull(integer), |own| own.0;
}

macro_rules! integer_words {
    ($($word:ty, |$port:ident| $of:expr, |$own:ident| $to:expr;)*) => {
        $(impl IntegerWord for $word {
            #[inline(always)]
            fn of_port($port: Scalar) -> Self {
                $of
            }
            #[inline(always)]
            fn to_port(self) -> Scalar {
                let $own = self;
                $to
            }
        })*
    };
}

/// The largest word of 32 bits whose rounded upper half is a word.
const LARGEST: i32 = i32::MAX - (1 << 15);

integer_words! {
    i32, |port| port, |own| own;
    i16, |port| upper(port.min(LARGEST), 16) as i16, |own| i32::from(own) << 16;
    Full, |port| Full(port), |own| own.0;
    Half, |port| Half(upper(port.min(LARGEST), 16)), |own| own.0 << 16;
}

/// A bundle on words of 32 bits in another reading of integers. Numbers that words of 16 bits have made, and [`to_ports`], are exact.
#[inline(always)]
pub fn of_ports<W: IntegerWord, B: Bundle<Scalar>>(bundle: &B) -> B::In<W> {
    bundle.rewire(&mut OfPorts)
}

/// The same numbers on words of 32 bits: of narrower ones with zeros behind each.
#[inline(always)]
pub fn to_ports<W: IntegerWord, B: Bundle<W>>(bundle: &B) -> B::In<Scalar> {
    bundle.rewire(&mut ToPorts)
}

/// The upper half of every word: [`of_ports`] on words of 16 bits.
#[inline(always)]
pub fn narrowed<B: Bundle<Scalar>>(bundle: &B) -> B::In<i16> {
    of_ports::<i16, B>(bundle)
}

/// The same numbers on words of 32 bits: [`to_ports`] of words of 16 bits.
#[inline(always)]
pub fn widened<B: Bundle<i16>>(bundle: &B) -> B::In<Scalar> {
    to_ports::<i16, B>(bundle)
}

/// The words of 16 and of 32 bits that suit the processor.
#[cfg(not(any(target_arch = "riscv32", target_arch = "arm")))]
mod suitable {
    pub use core::primitive::{i16 as Narrow, i32 as Whole};

    /// The same bundles, untouched: a copy of a reflection is a few percent of making one.
    #[macro_export]
    macro_rules! on_whole_words {
        (|$($input:ident),*| $body:expr) => {
            $body
        };
    }
}
#[cfg(any(target_arch = "riscv32", target_arch = "arm"))]
mod suitable {
    pub use crate::small::{Full as Whole, Half as Narrow};

    /// In the reading of the processor.
    #[macro_export]
    macro_rules! on_whole_words {
        (|$($input:ident),*| $body:expr) => {{
            $(let $input = &$crate::width::of_ports::<$crate::width::Whole, _>($input);)*
            $crate::width::to_ports::<$crate::width::Whole, _>(&$body)
        }};
    }
}
pub use suitable::{Narrow, Whole};

/// `on_words!(p, |input, …| body)`: the bundle that `body`, a function of the composer, makes of bundles of the scalar reading, on words of
/// the profile's width and in the reading that suits the processor.
#[macro_export]
macro_rules! on_words {
    ($p:expr, |$($input:ident),*| $body:expr) => {
        if $p.word_bits() == 16 {
            $(let $input = &$crate::width::of_ports::<$crate::width::Narrow, _>($input);)*
            $crate::width::to_ports::<$crate::width::Narrow, _>(&$body)
        } else {
            $crate::on_whole_words!(|$($input),*| $body)
        }
    };
}
pub use crate::on_words;

/// From words of 32 bits.
struct OfPorts;

impl<W: IntegerWord> Rewire<Scalar, W> for OfPorts {
    #[inline(always)]
    fn word(&mut self, wire: Scalar, _: u32) -> W {
        W::of_port(wire)
    }
    #[inline(always)]
    fn control(&mut self, wire: i32, _: u32) -> W::Count {
        W::Count::of_integer(wire)
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> <W::Count as Word>::Wide {
        W::Count::wide_of_integer(wire)
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> bool {
        wire
    }
}

/// To words of 32 bits.
struct ToPorts;

impl<W: IntegerWord> Rewire<W, Scalar> for ToPorts {
    #[inline(always)]
    fn word(&mut self, wire: W, _: u32) -> Scalar {
        wire.to_port()
    }
    #[inline(always)]
    fn control(&mut self, wire: W::Count, _: u32) -> i32 {
        wire.integer()
    }
    #[inline(always)]
    fn wide(&mut self, wire: <W::Count as Word>::Wide, _: u32) -> i64 {
        W::Count::wide_integer(wire)
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> bool {
        wire
    }
}
