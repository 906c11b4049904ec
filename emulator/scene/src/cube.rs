//! The axes of a cube map's faces.

/// One axis of a face's coordinates: index into (x, y, z) and sign.
pub type SignedAxis = (usize, i32);

/// Vulkan's table per face: the axes of s_c, t_c and of the major component m.
pub const FACE_AXES: [[SignedAxis; 3]; 6] = [
    [(2, -1), (1, -1), (0, 1)],
    [(2, 1), (1, -1), (0, -1)],
    [(0, 1), (2, 1), (1, 1)],
    [(0, 1), (2, -1), (1, -1)],
    [(0, 1), (1, -1), (2, 1)],
    [(0, -1), (1, -1), (2, -1)],
];

/// Directions of +s, of +t and of the centre of each face.
const DIRECTIONS: [[[f64; 3]; 3]; 6] = {
    let mut directions = [[[0.0; 3]; 3]; 6];
    let mut place = 0;
    while place < 18 {
        let (axis, sign) = FACE_AXES[place / 3][place % 3];
        directions[place / 3][place % 3][axis] = sign as f64;
        place += 1;
    }
    directions
};

/// The direction of (s, t), each −1 … 1, on a face of the cube of half edge 1.
#[inline(always)]
pub fn direction(face: usize, s: f64, t: f64) -> [f64; 3] {
    let [right, down, centre] = &DIRECTIONS[face];
    // Exact, as only one term is not 0. It is a sum so that loops over s and t vectorise.
    [0, 1, 2].map(|axis| right[axis] * s + down[axis] * t + centre[axis])
}

/// Column and row on a face of `edge` texels of what stands in that column and row of its picture from inside, and back.
///
/// In a right-handed world the table of Vulkan shows a face as it looks from outside the cube. From inside, the faces at the
/// sides are mirror images. A picture of +y has +z on top, one of −y has −z on top: a viewer who faces −z looks up and down.
pub fn from_inside(face: usize, edge: usize, [column, row]: [usize; 2]) -> [usize; 2] {
    if face / 2 == 1 { [column, edge - 1 - row] } else { [edge - 1 - column, row] }
}

/// The face that holds a direction, and s and t there, each −1 … 1.
pub(crate) fn place(direction: [f64; 3]) -> (usize, [f64; 2]) {
    let [x, y, z] = direction.map(f64::abs);
    let axis = if x >= y && x >= z { 0 } else { 1 + usize::from(z > y) };
    let face = 2 * axis + usize::from(direction[axis] < 0.0);
    let along = |place: usize| {
        let (axis, sign) = FACE_AXES[face][place];
        direction[axis] * f64::from(sign)
    };
    (face, [0, 1].map(|place| along(place) / along(2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_of_a_direction_is_where_it_comes_from() {
        for face in 0..6 {
            for (s, t) in [(0.25, -0.5), (-0.75, 0.125), (0.0, 0.0)] {
                assert_eq!(place(direction(face, s, t).map(|coordinate| 3.0 * coordinate)), (face, [s, t]));
            }
        }
    }

    /// The picture of a camera, by its direction and the direction up in the picture: right is direction × up.
    #[test]
    fn a_picture_from_inside_has_its_right_to_the_right() {
        let cameras: [[[f64; 3]; 2]; 6] = [
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
            [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]],
            [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        ];
        for (face, [ahead, up]) in cameras.into_iter().enumerate() {
            let right = [0, 1, 2].map(|a| ahead[(a + 1) % 3] * up[(a + 2) % 3] - ahead[(a + 2) % 3] * up[(a + 1) % 3]);
            for [column, row] in [[0, 0], [3, 1], [2, 2], [1, 3]] {
                let at = |index: usize| (2 * index + 1) as f64 / 4.0 - 1.0;
                let seen = [0, 1, 2].map(|axis| ahead[axis] + right[axis] * at(column) - up[axis] * at(row));
                let [s, t] = from_inside(face, 4, [column, row]).map(at);
                assert_eq!(direction(face, s, t), seen, "face {face}");
                assert_eq!(from_inside(face, 4, from_inside(face, 4, [column, row])), [column, row]);
            }
        }
    }

    #[test]
    fn directions_follow_the_table_of_vulkan() {
        // (s_c, t_c) of the face that holds the direction, as Vulkan prints them.
        let table: [fn([f64; 3]) -> [f64; 2]; 6] = [
            |[_, y, z]| [-z, -y],
            |[_, y, z]| [z, -y],
            |[x, _, z]| [x, z],
            |[x, _, z]| [x, -z],
            |[x, y, _]| [x, -y],
            |[x, y, _]| [-x, -y],
        ];
        for (face, coordinates) in table.into_iter().enumerate() {
            for (s, t) in [(0.25, -0.5), (-0.75, 0.125)] {
                let direction = direction(face, s, t);
                assert_eq!(coordinates(direction), [s, t]);
                assert_eq!(direction[face / 2], if face % 2 == 0 { 1.0 } else { -1.0 });
            }
        }
    }
}
