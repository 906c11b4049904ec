//! Reflect: r = 2 n⟨v·n⟩ − v|n|² with n = n_mod (W97 (4)); v points from the surface to the eye.
//!
//! Neither vector needs unit length. ⟨v·n⟩ and |n|² are exact, then share one exponent, for r depends on their
//! ratio only: |⟨v·n⟩|/|n|² ≤ |v|/|n| ≤ 2√3 in mantissas, so neither loses more than two bits to the other.
//! Error of the direction: 2^−(p−2.9).

use crate::block::{Block, Product, dot, normalise};
use crate::each::each;
use crate::fx::Fx;
use crate::precision::Precision;
use crate::signals::Reflected;
use crate::word::Word;

/// Reflects v in the plane of n.
#[inline(always)]
pub fn reflect<W: Word>(n: &Block<W, 3>, v: &Block<W, 3>, p: &Precision) -> Reflected<W> {
    let view_dot_normal = dot(&v.m, &n.m);
    let scalars = normalise([view_dot_normal, dot(&n.m, &n.m)], Fx::int(0), p.fraction_bits);
    let [along, square] = scalars.m;
    let r = each!(i in [0, 1, 2] => {
        let twice: Product<W> = n.m[i].mul(along).shl(1);
        twice - v.m[i].mul(square)
    });
    Reflected {
        r: normalise(r, scalars.e + v.e + n.e + n.e, p.fraction_bits),
        scalars,
        below: !Fx::zero().lt(view_dot_normal),
    }
}
