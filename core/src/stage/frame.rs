//! Frame: the tangent basis, two tangents in which bump offsets and roughness are given.
//!
//! S97 §7.3 (W97 App. A): E₁ = h×n/|h×n|·|n|, E₂ = n×E₁/…; both scaled by |n| so that offsets keep their meaning for an unnormalised n (errata 9, 16,
//! 17). S97 §7.1 and §7.2: s_u = n̂×p_v, s_v = p_u×n̂, here relative to |p_u×p_v|, so that n + f_u·s_u + f_v·s_v has the direction of the print for a
//! normal of any length. Cross products of p-bit mantissas are exact, then brought to a common exponent: the basis stays orthogonal down to one last
//! bit between n and h. Error: 2^−(p−3) relative to |n|.

use crate::block::{Block, Mantissa, PRODUCT, Product, cross, normalise};
use crate::each::each;
use crate::elementary::{inverse_root, root_and_inverse};
use crate::fx::Fx;
use crate::precision::Precision;
use crate::signals::TangentFrame;
use crate::word::Word;

/// System 3: the main direction h.
///
/// Pole (n ∥ h, or either zero): the unit axis on which |n| is smallest stands in for h; ties take x before y before z. n = 0 gives a zero basis.
#[inline(always)]
pub fn main_direction<W: Word>(n: &Block<W, 3>, h: &Block<W, 3>, p: &Precision) -> TangentFrame<W> {
    let fraction_bits = p.fraction_bits;
    let h_cross_n = cross(&h.m, &n.m);
    let [x, y, z] = each!(c in h_cross_n => c.is_zero());
    let pole = x & y & z;
    let stand_in = W::unless(
        !pole,
        [Fx::zero(); 3],
        #[inline(always)]
        || axis_cross_n(&n.m),
    );
    let tangent = each!(i in [0, 1, 2] => Fx::select(pole, stand_in[i], h_cross_n[i]));
    let c = normalise(tangent, Fx::int(0), fraction_bits);
    let d = normalise(cross(&n.m, &c.m), c.e, fraction_bits);
    let inverse_length = inverse_root(c.square_length(fraction_bits), p);
    let normal_length = root_and_inverse(n.square_length(fraction_bits), p).0.scaled(-n.e);
    let ratio = inverse_length.times(&normal_length, fraction_bits);
    TangentFrame { e1: c.times(&ratio, fraction_bits), e2: d.times(&inverse_length, fraction_bits), pole }
}

/// System 1: E₁ = (n×p_v)/|p_u×p_v|, E₂ = (p_u×n)/|p_u×p_v|. Pole (p_u ∥ p_v): zero basis.
#[inline(always)]
pub fn natural<W: Word>(n: &Block<W, 3>, tangents: &[Block<W, 3>; 2], p: &Precision) -> TangentFrame<W> {
    let fraction_bits = p.fraction_bits;
    let [u, v] = tangents;
    let c = normalise(cross(&u.m, &v.m), u.e + v.e, fraction_bits);
    let pole = c.is_zero();
    let inverse_length = inverse_root(c.square_length(fraction_bits), p);
    let [e1, e2] = each!((a, b, e) in [(n, v, v.e), (u, n, u.e)] => {
        let block = normalise(cross(&a.m, &b.m), e, fraction_bits).times(&inverse_length, fraction_bits);
        Block::select(pole, Block::zero(), block)
    });
    TangentFrame { e1, e2, pole }
}

/// System 2: the directions of system 1, both of length |n|. Pole (n ∥ p_u or n ∥ p_v): zero basis.
#[inline(always)]
pub fn natural_normalised<W: Word>(n: &Block<W, 3>, tangents: &[Block<W, 3>; 2], p: &Precision) -> TangentFrame<W> {
    let fraction_bits = p.fraction_bits;
    let [u, v] = tangents;
    let s_u = normalise(cross(&n.m, &v.m), Fx::int(0), fraction_bits);
    let s_v = normalise(cross(&u.m, &n.m), Fx::int(0), fraction_bits);
    let pole = s_u.is_zero() | s_v.is_zero();
    let normal_length = root_and_inverse(n.square_length(fraction_bits), p).0.scaled(-n.e);
    let [e1, e2] = each!(s in [s_u, s_v] => {
        let ratio = inverse_root(s.square_length(fraction_bits), p).times(&normal_length, fraction_bits);
        Block::select(pole, Block::zero(), s.times(&ratio, fraction_bits))
    });
    TangentFrame { e1, e2, pole }
}

/// Cross product of the unit axis on which |n| is smallest with n, exact.
#[inline(always)]
fn axis_cross_n<W: Word>(n: &[Mantissa<W>; 3]) -> [Product<W>; 3] {
    let [x, y, z] = each!(x in *n => x.abs());
    let x_smallest = !y.lt(x) & !z.lt(x);
    let y_smallest = !x_smallest & !z.lt(y);
    let [nx, ny, nz] = each!(x in *n => x.widen::<PRODUCT>());
    let zero = Fx::zero();
    let of_axis = [[zero, -nz, ny], [nz, zero, -nx], [-ny, nx, zero]];
    each!(i in [0, 1, 2] => {
        Fx::select(x_smallest, of_axis[0][i], Fx::select(y_smallest, of_axis[1][i], of_axis[2][i]))
    })
}
