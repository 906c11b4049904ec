//! Cube face: the largest component of r selects the face; the other two, divided by it, are (s, t) (W97 (6)).
//!
//! Face order and (s_c, t_c) are Vulkan's table. Ties: z wins over y, y over x; ±0 is positive; the zero vector gives face +z with s = t = 0. Error
//! of s, t: 2^−p from the quotient, plus that of r.

use crate::block::{Block, MANTISSA, Mantissa, PRODUCT, normalise, of_control};
use crate::each::each;
use crate::elementary::half_reciprocal;
use crate::fx::{Control, Fx, Wide};
use crate::ports::POSITION;
use crate::precision::Precision;
use crate::signals::{CubePoint, FacePosition, FaceSelect, MapOffset};
use crate::word::Word;

/// Selects the face and divides.
#[inline(always)]
pub fn cube_face<W: Word>(r: &Block<W, 3>, p: &Precision) -> CubePoint<W> {
    let [x, y, z] = each!(m in r.m => m.abs());
    let is_z = z.ge(x) & z.ge(y);
    let is_y = !is_z & y.ge(x);
    let second = Fx::select(is_z, x.max(y), Fx::select(is_y, x.max(z), y.max(z)));
    let major = Fx::select(is_z, r.m[2], Fx::select(is_y, r.m[1], r.m[0]));
    let select = FaceSelect { is_z, is_y, negative: major.lt(Fx::zero()) };
    let [s_c, t_c, m] = select.to_face(r.m);
    let half_reciprocal = half_reciprocal(m, p);
    let one = Fx::int(1);
    let st = each!(numerator in [s_c, t_c] => {
        // numerator/m = 2·numerator·(1/2m): one binary place less in the product.
        let quotient: Wide<W, { PRODUCT + 1 }> = numerator.mul::<MANTISSA, PRODUCT>(half_reciprocal).reread();
        let quotient =
            quotient.claim(-17, 17, -4, "a_quotient_by_the_largest_component_is_near_one_at_most");
        let quotient: Mantissa<W> = quotient.round_to(p.fraction_bits);
        quotient.saturate(-one, one)
    });
    CubePoint { select, st, half_reciprocal, tie: second.ge(m) }
}

/// Place of a point of the cube.
#[inline(always)]
pub fn position<W: Word>(point: &CubePoint<W>) -> FacePosition<W> {
    FacePosition { face: point.select.index(), st: each!(s in point.st => s.to_control::<POSITION>()) }
}

/// Point at `offset` from `point` on the plane of its face. Beyond the edge it is on the face that the ray to it meets: a footprint is a piece of the
/// plane. Errors as for [`cube_face`].
#[inline(always)]
pub fn continuation<W: Word>(point: &CubePoint<W>, offset: &MapOffset<W>, p: &Precision) -> FacePosition<W> {
    // |s + offset| ≤ 1 + 3.5: inside I4F28.
    let moved = each!(i in [0, 1] => point.st[i].to_control::<POSITION>() + offset.offset[i]);
    let one: Control<W, POSITION> = Fx::int(1);
    let inside = !one.lt(moved[0].abs()) & !one.lt(moved[1].abs());
    let here = FacePosition::<W> { face: point.select.index(), st: moved };
    let across = W::unless(
        inside,
        here,
        #[inline(always)]
        || {
            let direction = point.select.from_face([moved[0], moved[1], one]);
            let direction = normalise(each!(x in direction => x.widen::<6>()), Fx::int(0), p.fraction_bits);
            let across = cube_face::<W>(&of_control(direction), p);
            position(&across)
        },
    );
    FacePosition {
        face: Fx::select(inside, here.face, across.face),
        st: each!(i in [0, 1] => Fx::select(inside, here.st[i], across.st[i])),
    }
}
