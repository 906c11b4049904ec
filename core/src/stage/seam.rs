//! Edge: the texel that lies one step outside of a face of the cube, on the face across its edge.
//!
//! With the cube's centre at the origin and units of half a texel, the centre of a texel is (s, t, m) = (2i + 1 − edge, 2j + 1 − edge, edge). A texel
//! outside is folded over the edge. Its outside component becomes the new major one, ±edge. The old major one becomes edge − 1, the centre of the
//! first row of texels after the edge. This is an involution on every edge. Diagonally outside there is no texel, but three meet; the filter takes
//! their mean ([`corner`](super::filter::corner)). Exact.

use crate::bundle::bundle;
use crate::each::each;
use crate::fx::{Fx, Int};
use crate::signals::FaceSelect;
use crate::word::Word;

bundle! {
    /// A texel of a level of a cube map.
    pub struct FaceTexel<W> {
        /// Face in Vulkan's order, 0…5.
        #[range(0..=5)]
        face: Int<W>,
        /// Column from s = −1, row from t = −1.
        #[range(0..=16383)]
        index: [Int<W>; 2],
    }

    /// Texels at an address of a face that may be one step outside of it.
    pub struct CubeTexel<W> {
        /// Texel of this face or of the one across an edge; at a corner the texel of this face.
        texel: FaceTexel<W>,
        /// Texels across the s and the t edge, at a corner.
        across: [FaceTexel<W>; 2],
        /// True diagonally outside of the face.
        corner: W::Flag,
    }

    /// Columns and rows of the texels of a bilinear sample.
    pub struct Neighbours<W> {
        /// Column and row of (0,0), (1,0), (0,1), (1,1).
        #[range(-1..=16384)]
        index: [[Int<W>; 2]; 4],
    }
}

/// Texels of a bilinear sample whose first one is given.
#[inline(always)]
pub fn neighbours<W: Word>([i, j]: [Int<W>; 2]) -> Neighbours<W> {
    let (right, down) = (i + Fx::int(1), j + Fx::int(1));
    Neighbours { index: [[i, j], [right, j], [i, down], [right, down]] }
}

/// Texel at a column and a row in −1…edge of a face of `edge` × `edge` texels. Range: edge 1…16384, face 0…5.
#[inline(always)]
pub fn texel<W: Word>(face: Int<W>, index: [Int<W>; 2], edge: Int<W>) -> CubeTexel<W> {
    let select = FaceSelect::of_index(face);
    let last = edge - Fx::int(1);
    let inside = each!(i in index => i.saturate(Fx::int(0), last));
    let [outside_s, outside_t] = each!(axis in [0, 1] => index[axis].lt(inside[axis]) | inside[axis].lt(index[axis]));
    let corner = outside_s & outside_t;
    let own = each!(axis in [0, 1] => Fx::select(corner, inside[axis], index[axis]));
    CubeTexel {
        texel: folded(&select, own, edge),
        across: [folded(&select, [index[0], inside[1]], edge), folded(&select, [inside[0], index[1]], edge)],
        corner,
    }
}

/// Texel after the edge that one of the two indices is beyond, or the texel at the place.
#[inline(always)]
fn folded<W: Word>(select: &FaceSelect<W>, index: [Int<W>; 2], edge: Int<W>) -> FaceTexel<W> {
    let last = edge - Fx::int(1);
    let centre = each!(i in index => i.shl(1) - last);
    let outside = last.lt(centre[0].abs()) | last.lt(centre[1].abs());
    let [s, t] = each!(place in centre => place.saturate(-edge, edge));
    let [x, y, z] = select.from_face([s, t, Fx::select(outside, last, edge)]);
    // Only one component is as large as the edge.
    let is_z = z.abs().ge(edge);
    let is_y = !is_z & y.abs().ge(edge);
    let major = Fx::select(is_z, z, Fx::select(is_y, y, x));
    let across: FaceSelect<W> = FaceSelect { is_z, is_y, negative: major.lt(Fx::int(0)) };
    let [column, row, _] = across.to_face([x, y, z]);
    FaceTexel { face: across.index(), index: each!(place in [column, row] => (place + last).floor_shr(1)) }
}
