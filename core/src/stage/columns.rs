//! Footprint columns: how the point on the face moves with the pixel, and with the surface normal.
//!
//! dr = [2nnᵀ − |n|²I]dv + 2[⟨n·v⟩I + nvᵀ − vnᵀ]dn (W97 (8), (9) with n = n_mod, erratum 10), in the order 2n(n·dv + v·dn) − |n|²dv + 2⟨n·v⟩dn −
//! 2v(n·dn): aperture and curvature meet before anything is rounded away. q = (ds_c − s·dm, dt_c − t·dm)/m (W97 (6)). Error: 2^−(p−5) relative to the
//! size of the terms. A footprint whose terms cancel (the parabolic mirror seen from its focus) keeps that absolute error. A footprint on the sphere
//! takes the same dr to the tangent plane at r instead of the plane of the face.

use crate::block::{Block, MANTISSA, Mantissa, PRODUCT, Product, align, dot, normalise};
use crate::bundle::bundle;
use crate::each::each;
use crate::elementary::{half_inverse_root, half_reciprocal};
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::signals::{CubePoint, Reflected};
use crate::word::Word;

/// Quantities that all columns of a fragment share.
#[derive(Clone, Copy, Debug)]
pub struct Mirror<'a, W: Word> {
    /// n_mod.
    pub normal: &'a Block<W, 3>,
    /// v.
    pub view: &'a Block<W, 3>,
    /// Reflected vector and scalars.
    pub reflected: &'a Reflected<W>,
    /// Point of the cube.
    pub point: &'a CubePoint<W>,
}

/// Column of one pair (dv, dn): d(s, t) on the face plane per unit of the pair.
#[inline(always)]
pub fn column<W: Word>(mirror: &Mirror<'_, W>, dv: &Block<W, 3>, dn: &Block<W, 3>, p: &Precision) -> Block<W, 2> {
    let numerator = across(mirror.point, &derivative(mirror, dv, dn, p), p);
    let q = each!(m in numerator.m => m.mul::<MANTISSA, PRODUCT>(mirror.point.half_reciprocal));
    over(mirror.reflected, normalise(q, numerator.e + Fx::int(1) - mirror.reflected.r.e, p.fraction_bits))
}

/// dr of one pair (dv, dn).
#[inline(always)]
pub fn derivative<W: Word>(mirror: &Mirror<'_, W>, dv: &Block<W, 3>, dn: &Block<W, 3>, p: &Precision) -> Block<W, 3> {
    let fraction_bits = p.fraction_bits;
    let Mirror { normal, view, reflected, .. } = mirror;
    let ([u, w], e_pair) = align([dv.scaled(normal.e), dn.scaled(view.e)], fraction_bits);

    // ⟨v·n⟩ and |n|² come back to the scale of the exact products; all four have 6 bits before the point and are below 8.
    let products = [dot(&normal.m, &u) + dot(&view.m, &w), dot(&normal.m, &w)];
    let products = each!(x in products => x.floor_shr(2).reread::<6>());
    let up = (reflected.scalars.e + Fx::int(2)).saturate(Fx::int(0), Fx::int(4));
    let down = Fx::int(4) - up;
    let scalars: [Wide<W, 6>; 2] = each!(m in reflected.scalars.m => m.widen::<PRODUCT>().reread().floor_shr_by(down));
    let four = normalise([products[0], products[1], scalars[0], scalars[1]], Fx::int(0), fraction_bits);
    let [n_dv_v_dn, n_dn, n_v, n_n] = four.m;

    let dr = each!(i in [0, 1, 2] => {
        // At most 7 when doubled: inside the 4 bits before the point.
        let half: Product<W> = normal.m[i].mul(n_dv_v_dn) - view.m[i].mul(n_dn) + w[i].mul(n_v);
        half.shl(1) - u[i].mul(n_n)
    });
    // The alignment has already applied one exponent, of n or of v, to each member of the pair.
    normalise(dr, e_pair + four.e + normal.e, fraction_bits)
}

/// (ds_c − s·dm, dt_c − t·dm).
#[inline(always)]
fn across<W: Word>(point: &CubePoint<W>, dr: &Block<W, 3>, p: &Precision) -> Block<W, 2> {
    let [ds, dt, dm] = point.select.to_face(dr.m);
    let across: [Product<W>; 2] =
        each!((d, coordinate) in [(ds, point.st[0]), (dt, point.st[1])] => d.widen() - coordinate.mul(dm));
    normalise(across, dr.e, p.fraction_bits)
}

/// A column, or zero without a reflected direction.
#[inline(always)]
fn over<W: Word>(reflected: &Reflected<W>, column: Block<W, 2>) -> Block<W, 2> {
    Block::select(reflected.r.is_zero(), Block::zero(), column)
}

bundle! {
    /// Map from the plane of a face to the tangent plane of the sphere, at one point. With ρ² = 1 + s² + t² a change q of (s, t) turns the direction
    /// by (q − (s, t)·⟨(s, t)·q⟩/(ρ(ρ + 1)))/ρ radians. The axes are those of the face, carried from its centre without turning.
    pub struct TangentPlane<W> {
        /// 1/(2mρ) for the major mantissa m.
        #[range(0..=1)]
        scale: Mantissa<W>,
        /// (s, t)/(ρ(ρ + 1)).
        #[range(-1..=1)]
        pull: [Mantissa<W>; 2],
    }
}

/// Tangent plane at a point of the cube.
#[inline(always)]
pub fn tangent_plane<W: Word>(point: &CubePoint<W>, p: &Precision) -> TangentPlane<W> {
    let fraction_bits = p.fraction_bits;
    // ρ²/4 in [¼, ¾].
    let quarter: Mantissa<W> = (dot(&point.st, &point.st) + Fx::int(1)).floor_shr(2).round_to(fraction_bits);
    let inverse = half_inverse_root(quarter, p);
    // (1 + ρ)/4 in [½, 0.69], for ρ = ρ²/ρ.
    let sum: Mantissa<W> = (quarter.mul::<MANTISSA, PRODUCT>(inverse) + Fx::number(1, -2)).round_to(fraction_bits);
    let twice: Mantissa<W> = inverse.mul::<MANTISSA, PRODUCT>(half_reciprocal(sum, p)).round_to(fraction_bits);
    TangentPlane {
        scale: point.half_reciprocal.mul::<MANTISSA, PRODUCT>(inverse).round_to(fraction_bits),
        pull: each!(s in point.st => s.mul::<MANTISSA, PRODUCT>(twice).floor_shr(1).round_to(fraction_bits)),
    }
}

/// Column of one dr in radians on the tangent plane.
#[inline(always)]
pub fn on_sphere<W: Word>(
    mirror: &Mirror<'_, W>,
    plane: &TangentPlane<W>,
    dr: &Block<W, 3>,
    p: &Precision,
) -> Block<W, 2> {
    let fraction_bits = p.fraction_bits;
    let numerator = across(mirror.point, dr, p);
    // At most 2; half of it fits.
    let half_outwards: Mantissa<W> = dot(&mirror.point.st, &numerator.m).floor_shr(1).round_to(fraction_bits);
    let turned = each!((m, pull) in [(numerator.m[0], plane.pull[0]), (numerator.m[1], plane.pull[1])] => {
        let half_pulled: Product<W> = pull.mul(half_outwards);
        m.widen() - half_pulled.shl(1)
    });
    let turned = normalise(turned, numerator.e, fraction_bits);
    let q = each!(m in turned.m => m.mul::<MANTISSA, PRODUCT>(plane.scale));
    over(mirror.reflected, normalise(q, turned.e + Fx::int(1) - mirror.reflected.r.e, fraction_bits))
}
