//! Words as wide as the accuracy needs: a profile of at most 14 kept bits runs on words of 16 bits, any other on words of 32.
//!
//! Ports, maps and frames hold mantissas on words of 32 bits whatever the profile. [`on_words!`](crate::on_words!) calls a function of
//! the composer on words of the profile's width with those as its input, and gives back what it makes of them as words of 32
//! bits; who calls does not know which. What controls is the same on both.

use crate::bundle::{Bundle, Rewire};
use crate::rom::upper;
use crate::word::Word;

/// The upper half of every word, rounded to nearest, ties up; what would round up beyond the largest word stays that. Numbers that words
/// of 16 bits have made, and [`widened`], are exact.
#[inline(always)]
pub fn narrowed<B: Bundle<i32>>(bundle: &B) -> B::In<i16> {
    const LARGEST: i32 = i32::MAX - (1 << 15);
    bundle.rewire(&mut Words(
        #[inline(always)]
        |wire: i32| upper(wire.min(LARGEST), 16) as i16,
    ))
}

/// The same numbers on words of 32 bits: 16 zeros behind each.
#[inline(always)]
pub fn widened<B: Bundle<i16>>(bundle: &B) -> B::In<i32> {
    bundle.rewire(&mut Words(
        #[inline(always)]
        |wire: i16| i32::from(wire) << 16,
    ))
}

/// `on_words!(p, |input, …| body)`: the bundle that `body`, a function of the composer, makes of bundles of the scalar reading, on words of
/// the profile's width.
#[macro_export]
macro_rules! on_words {
    ($p:expr, |$($input:ident),*| $body:expr) => {
        if $p.word_bits() == 16 {
            $(let $input = &$crate::width::narrowed($input);)*
            $crate::width::widened(&$body)
        } else {
            $body
        }
    };
}
pub use crate::on_words;

/// Puts what a function makes of each word in its place; what controls stays.
struct Words<F>(F);

impl<W, V, F> Rewire<W, V> for Words<F>
where
    W: Word<Count = i32, Flag = bool>,
    V: Word<Count = i32, Flag = bool>,
    F: Fn(W) -> V,
{
    #[inline(always)]
    fn word(&mut self, wire: W, _: u32) -> V {
        self.0(wire)
    }
    #[inline(always)]
    fn control(&mut self, wire: i32, _: u32) -> i32 {
        wire
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        wire
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> bool {
        wire
    }
}
