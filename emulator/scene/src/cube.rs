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

#[cfg(test)]
mod tests {
    use super::*;

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
