//! Words as wide as the accuracy needs: a profile of at most 14 kept bits runs on 16-bit words, any other on 32-bit words.
//!
//! Ports, maps and frames hold mantissas on 32-bit words in every profile. [`on_words!`](crate::on_words!) takes them as input and calls a function
//! of the composer on words of the profile's width. It returns the result on 32-bit words, so a caller does not know the width. Control words are the
//! same in both. On a small processor the words are those of [`mod@crate::small`].

use crate::bundle::{Bundle, Rewire};
use crate::rom::upper;
use crate::scalar::Scalar;
use crate::small::{Full, Half, WideFull};
use crate::staged::Staged;
use crate::word::Word;

/// Control word of a backend whose words are integers of the processor that runs it; the processor finds texels with it.
pub trait IntegerCount: Word<Flag = bool> {
    /// Word from an integer.
    fn of_integer(integer: i32) -> Self;
    /// Integer of a word.
    fn integer(self) -> i32;
    /// Wide word from a 64-bit integer.
    fn wide_of_integer(integer: i64) -> Self::Wide;
    /// Integer of a wide word.
    fn wide_integer(wide: Self::Wide) -> i64;
}

/// A word of such a backend.
pub trait IntegerWord: Staged<Flag = bool, Count: IntegerCount> {
    /// Word from a 32-bit word: its upper bits, rounded to nearest, ties up. A value that would round up beyond the largest word stays the largest
    /// word.
    fn of_port(word: Scalar) -> Self;
    /// Converts to a 32-bit word: the same number, zeros in its low bits.
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

/// Largest 32-bit word whose rounded upper half is a word.
const LARGEST: i32 = i32::MAX - (1 << 15);

integer_words! {
    i32, |port| port, |own| own;
    i16, |port| upper(port.min(LARGEST), 16) as i16, |own| i32::from(own) << 16;
    Full, |port| Full(port), |own| own.0;
    Half, |port| Half(upper(port.min(LARGEST), 16)), |own| own.0 << 16;
}

/// Converts a bundle on 32-bit words to another integer backend. Numbers that 16-bit words have made, and [`to_ports`], are exact.
#[inline(always)]
pub fn of_ports<W: IntegerWord, B: Bundle<Scalar>>(bundle: &B) -> B::In<W> {
    bundle.rewire(&mut OfPorts)
}

/// Converts a bundle to 32-bit words, the same numbers. Narrower words get zeros in their low bits.
#[inline(always)]
pub fn to_ports<W: IntegerWord, B: Bundle<W>>(bundle: &B) -> B::In<Scalar> {
    bundle.rewire(&mut ToPorts)
}

/// Upper half of every word: [`of_ports`] on 16-bit words.
#[inline(always)]
pub fn narrowed<B: Bundle<Scalar>>(bundle: &B) -> B::In<i16> {
    of_ports::<i16, B>(bundle)
}

/// Converts to 32-bit words, the same numbers: [`to_ports`] of 16-bit words.
#[inline(always)]
pub fn widened<B: Bundle<i16>>(bundle: &B) -> B::In<Scalar> {
    to_ports::<i16, B>(bundle)
}

/// The 16-bit and 32-bit words that suit the processor.
#[cfg(not(any(target_arch = "riscv32", target_arch = "arm")))]
mod suitable {
    pub use core::primitive::{i16 as Narrow, i32 as Whole};

    /// Passes the same bundles, untouched: a copy of a reflection costs a few per cent of making one.
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

    /// Converts bundles to the backend of the processor and back.
    #[macro_export]
    macro_rules! on_whole_words {
        (|$($input:ident),*| $body:expr) => {{
            $(let $input = &$crate::width::of_ports::<$crate::width::Whole, _>($input);)*
            $crate::width::to_ports::<$crate::width::Whole, _>(&$body)
        }};
    }
}
pub use suitable::{Narrow, Whole};

/// `on_words!(p, |input, …| body)`: runs `body`, a function of the composer, on bundles of the scalar backend and returns the bundle that it makes.
/// The words have the profile's width and are those of the backend that suits the processor.
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

/// Conversion from 32-bit words.
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

/// Conversion to 32-bit words.
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
