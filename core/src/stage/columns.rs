//! Footprint columns: how the point on the face moves with the pixel, and with the surface normal.
//!
//! dr = [2nnᵀ − |n|²I]dv + 2[⟨n·v⟩I + nvᵀ − vnᵀ]dn (W97 (8), (9) with n = n_mod, erratum 10), in the order
//! 2n(n·dv + v·dn) − |n|²dv + 2⟨n·v⟩dn − 2v(n·dn): aperture and curvature meet before anything is rounded away.
//! q = (ds_c − s·dm, dt_c − t·dm)/m (W97 (6)). Error: 2^−(p−5) relative to the size of the terms; a footprint in
//! which they cancel (the parabolic mirror seen from its focus) keeps that absolute error.

use crate::block::{Block, MANTISSA, PRODUCT, Product, align, dot, normalise};
use crate::each::each;
use crate::fx::{Fx, Wide};
use crate::precision::Precision;
use crate::signals::{CubePoint, Reflected};
use crate::word::Word;

/// What all columns of a fragment share.
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

/// The column of one pair (dv, dn): d(s, t) on the face plane per unit of the pair.
#[inline(always)]
pub fn column<W: Word>(mirror: &Mirror<'_, W>, dv: &Block<W, 3>, dn: &Block<W, 3>, p: &Precision) -> Block<W, 2> {
    let keep = p.fraction_bits;
    let Mirror { normal, view, reflected, point } = mirror;
    let ([u, w], e_pair) = align([dv.scaled(normal.e), dn.scaled(view.e)], keep);

    // ⟨v·n⟩ and |n|² come back to the scale of the exact products; all four with 6 bits before the point, below 8.
    let products = [dot(&normal.m, &u) + dot(&view.m, &w), dot(&normal.m, &w)];
    let products = each!(x in products => x.floor_shr(2).reread::<6>());
    let up = (reflected.scalars.e + Fx::int(2)).saturate(Fx::int(0), Fx::int(4));
    let down = Fx::int(4) - up;
    let scalars: [Wide<W, 6>; 2] = each!(m in reflected.scalars.m => m.widen::<PRODUCT>().reread().floor_shr_by(down));
    let four = normalise([products[0], products[1], scalars[0], scalars[1]], Fx::int(0), keep);
    let [n_dv_v_dn, n_dn, n_v, n_n] = four.m;

    let dr = each!(i in [0, 1, 2] => {
        // At most 7 with its doubling: inside the 4 bits before the point.
        let half: Product<W> = normal.m[i].mul(n_dv_v_dn) - view.m[i].mul(n_dn) + w[i].mul(n_v);
        half.shl(1) - u[i].mul(n_n)
    });
    let dr = normalise(dr, e_pair + four.e, keep);

    let [ds, dt, dm] = point.select.to_face(dr.m);
    let across: [Product<W>; 2] =
        each!((d, coordinate) in [(ds, point.st[0]), (dt, point.st[1])] => d.widen() - coordinate.mul(dm));
    let numerator = normalise(across, dr.e, keep);
    let q = each!(m in numerator.m => m.mul::<MANTISSA, PRODUCT>(point.half_reciprocal));
    // Both dr and r carry the exponents of n and v; what is left of them here is the pair's own.
    let e = numerator.e + Fx::int(1) + normal.e - reflected.r.e;
    // Without a reflected direction there is no footprint.
    Block::select(reflected.r.is_zero(), Block::zero(), normalise(q, e, keep))
}
