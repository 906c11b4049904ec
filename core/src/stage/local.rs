//! Local: a direction in the tangent basis of its surface, (d·E₁, d·E₂, d·n) with E₁, E₂ in units of |n|.
//!
//! The dot products of p-bit mantissas are exact, then brought to a common exponent and rounded once; one inverse root gives unit length. A zero
//! direction and a zero basis (n = 0, or the pole of systems 1 and 2) have no local direction: all components are zero. Error of the unit vector:
//! 2^−(p−1.1) rad in direction, 2^−(p−2.1) in all.

use crate::block::{Block, Product, ZERO_EXPONENT, dot, normalise, places_below};
use crate::each::each;
use crate::elementary::over_length;
use crate::fx::Fx;
use crate::precision::Precision;
use crate::signals::{LightSide, LocalDirection, TangentFrame};
use crate::word::{Wire, Word};

/// d·E₁, d·E₂ and d·n, of any length. Range: any blocks; the tangent basis is in units of the mantissas of n.
#[inline(always)]
pub fn components<W: Word>(d: &Block<W, 3>, frame: &TangentFrame<W>, n: &Block<W, 3>, p: &Precision) -> Block<W, 3> {
    let zero = Fx::int(ZERO_EXPONENT);
    let most = <W::Wide as Wire>::BITS - 1;
    let axes = [(&frame.e1.m, frame.e1.e), (&frame.e2.m, frame.e2.e), (&n.m, Fx::int(0))];
    let along: [(Product<W>, _); 3] = each!((axis, e) in axes => {
        let along = dot(&d.m, axis);
        (along, Fx::select(along.is_zero(), zero, e))
    });
    let top = along[0].1.max(along[1].1).max(along[2].1);
    let aligned = each!((along, e) in along => along.floor_shr_by(places_below(e, top, most)));
    let local = normalise(aligned, d.e + top, p.fraction_bits);
    Block::select(frame.e1.is_zero() | frame.e2.is_zero(), Block::zero(), local)
}

/// Local direction at unit length. `local` comes from [`components`].
#[inline(always)]
pub fn unit<W: Word>(local: &Block<W, 3>, p: &Precision) -> LocalDirection<W> {
    let one = Fx::int(1);
    let unit = each!(m in over_length(local, p) => m.saturate(-one, one));
    LocalDirection { unit, none: local.is_zero() }
}

/// Side of the surface on which a light stands. `local` comes from [`components`].
#[inline(always)]
pub fn side<W: Word>(light: &Block<W, 3>, local: &Block<W, 3>) -> LightSide<W> {
    LightSide { below: !Fx::zero().lt(local.m[2]), none: light.is_zero() }
}
