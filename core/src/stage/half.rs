//! Half: h = l/|l| + v/|v|, the direction in which a mirror facet would have to look (Blinn 1977).
//!
//! Directions have no length, so each is scaled by the inverse root of its square; the sum is exact and rounded once.
//! Error of the direction: 2^−(p−1.1)·(1 + tan θ) for an angle 2θ between l and v; opposite each other they give h = 0.

use crate::block::{Block, MANTISSA, PRODUCT, Product, dot, normalise, number, places_below};
use crate::each::each;
use crate::elementary::inverse_root;
use crate::fx::Fx;
use crate::precision::Precision;
use crate::word::{Wire, Word};

/// Half vector of l and v, both of any length. It is zero if either is zero, or if l = −v.
#[inline(always)]
pub fn half<W: Word>(light: &Block<W, 3>, view: &Block<W, 3>, p: &Precision) -> Block<W, 3> {
    let fraction_bits = p.fraction_bits;
    let directions = [light, view];
    let inverse = each!(d in directions => inverse_root(number(dot(&d.m, &d.m), Fx::int(0), fraction_bits), p));
    let top = inverse[0].e.max(inverse[1].e);
    let most = <W::Wide as Wire>::BITS - 1;
    let sum = each!(axis in [0, 1, 2] => {
        let [l, v]: [Product<W>; 2] = each!(i in [0, 1] => {
            directions[i].m[axis].mul::<MANTISSA, PRODUCT>(inverse[i].m[0]).floor_shr_by(places_below(inverse[i].e, top, most))
        });
        l + v
    });
    let none = light.is_zero() | view.is_zero();
    Block::select(none, Block::zero(), normalise(sum, top, fraction_bits))
}
