//! Local: a direction in the frame of its surface, (d·E₁, d·E₂, d·n) with E₁, E₂ in units of |n|.
//!
//! The dot products of p-bit mantissas are exact, then brought to a common exponent and rounded once; unit length by one
//! inverse root. A zero direction and a zero frame (n = 0, or the pole of systems 1 and 2) have no local direction: all
//! components are zero. Error of the unit vector: 2^−(p−1.1) rad in direction, 2^−(p−2.1) in all.

use crate::block::{Block, MANTISSA, ZERO_EXPONENT, dot, normalise, places_below};
use crate::each::each;
use crate::elementary::inverse_root;
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::signals::{Frame, LightSide, LocalDirection};
use crate::word::Word;

/// d·E₁, d·E₂ and d·n, of any length. Range: any blocks; the frame is in units of the mantissas of n.
#[inline(always)]
pub fn components<W: Word>(d: &Block<W, 3>, frame: &Frame<W>, n: &Block<W, 3>, p: &Precision) -> Block<W, 3> {
    let zero = Fx::lit(ZERO_EXPONENT);
    let axes = [(&frame.e1.m, frame.e1.e), (&frame.e2.m, frame.e2.e), (&n.m, Fx::zero())];
    let along: [(Wide<W, 60>, _); 3] = each!((axis, e) in axes => {
        let along = dot(&d.m, axis);
        (along, Fx::select(along.is_zero(), zero, e))
    });
    let top = along[0].1.max(along[1].1).max(along[2].1);
    let aligned = each!((along, e) in along => along.floor_shr_by(places_below(e, top, 63)));
    let local = normalise(aligned, d.e + top, p.fraction_bits);
    Block::select(frame.e1.is_zero() | frame.e2.is_zero(), Block::zero(), local)
}

/// A local direction at unit length. `local` comes from [`components`].
#[inline(always)]
pub fn unit<W: Word>(local: &Block<W, 3>, p: &Precision) -> LocalDirection<W> {
    let one = Fx::lit(1 << MANTISSA);
    let inverse = inverse_root(Block::of(dot(&local.m, &local.m), Fx::zero(), p.fraction_bits), p);
    // The length is in [½, √3], so its inverse has an exponent of at most 2.
    let places = places_below(inverse.e, Fx::lit(2), 62);
    let unit = each!(m in local.m => {
        let product: Wide<W, 60> = m.mul::<MANTISSA, 60>(inverse.m[0]);
        let unit: Wide<W, 58> = product.reread::<58>().floor_shr_by(places);
        let unit = unit.claim(-(17 << 54)..=17 << 54, "a_component_over_its_length_is_near_one_at_most");
        unit.round_to(p.fraction_bits).saturate(-one, one)
    });
    LocalDirection { unit, none: local.is_zero() }
}

/// On which side of the surface a light stands. `local` is what [`components`] makes of it.
#[inline(always)]
pub fn side<W: Word>(light: &Block<W, 3>, local: &Block<W, 3>) -> LightSide<W> {
    LightSide { below: !Fx::zero().lt(local.m[2]), none: light.is_zero() }
}
