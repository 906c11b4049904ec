//! Cube face and face coordinates of a direction: Vulkan's face order and (s_c, t_c) table.
//!
//! Faces +x, −x, +y, −y, +z, −z are 0…5; s = s_c/|m| and t = t_c/|m| lie in [−1, 1], s = −1 is the left column,
//! t = −1 the top row of the face picture. Ties go to z, then y, then x; ±0 is positive; the zero vector gives
//! face +z with s = t = 0.

use super::linear::{Vector3, largest};

/// Major axis and its sign, then axis and sign of s_c and of t_c, for each face.
const FACES: [[(usize, f64); 3]; 6] = [
    [(0, 1.0), (2, -1.0), (1, -1.0)],
    [(0, -1.0), (2, 1.0), (1, -1.0)],
    [(1, 1.0), (0, 1.0), (2, 1.0)],
    [(1, -1.0), (0, 1.0), (2, -1.0)],
    [(2, 1.0), (0, 1.0), (1, -1.0)],
    [(2, -1.0), (0, -1.0), (1, -1.0)],
];

/// A point on the cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// Face 0…5.
    pub face: usize,
    /// Horizontal face coordinate, −1…1.
    pub s: f64,
    /// Vertical face coordinate, −1…1, downwards.
    pub t: f64,
    /// |m|, the size of the major component; 0 only for the zero vector.
    pub m: f64,
}

/// Face and coordinates of the direction `r`, which must be finite.
pub fn select(r: Vector3) -> Selection {
    let size = largest(&r);
    if size == 0.0 {
        return Selection { face: 4, s: 0.0, t: 0.0, m: 0.0 };
    }
    let axis = if r[2].abs() == size {
        2
    } else if r[1].abs() == size {
        1
    } else {
        0
    };
    project(2 * axis + usize::from(r[axis] < 0.0), r)
}

/// Coordinates of the direction `r` on the plane of a given face, also beyond [−1, 1].
///
/// `r` must have a nonzero component along the face's axis.
pub fn project(face: usize, r: Vector3) -> Selection {
    let [(major, _), (s_axis, s_sign), (t_axis, t_sign)] = FACES[face];
    let m = r[major].abs();
    Selection { face, s: s_sign * r[s_axis] / m, t: t_sign * r[t_axis] / m, m }
}

/// (s_c, t_c, signed m) of a vector on `face`: the linear part of the projection, used for derivatives.
pub fn face_components(face: usize, vector: Vector3) -> Vector3 {
    let [(major, sign), (s_axis, s_sign), (t_axis, t_sign)] = FACES[face];
    [s_sign * vector[s_axis], t_sign * vector[t_axis], sign * vector[major]]
}

/// The direction (s, t, 1) of the plane of `face` in world axes; its major component is ±1.
pub fn direction_of(face: usize, s: f64, t: f64) -> Vector3 {
    let [(major, sign), (s_axis, s_sign), (t_axis, t_sign)] = FACES[face];
    let mut direction = [0.0; 3];
    direction[major] = sign;
    direction[s_axis] = s_sign * s;
    direction[t_axis] = t_sign * t;
    direction
}

/// Selection of a probe that may have left `face`: outside [−1, 1] the point of the plane is read as a direction and selected again.
pub fn continue_across(face: usize, s: f64, t: f64) -> Selection {
    if s.abs() <= 1.0 && t.abs() <= 1.0 {
        return Selection { face, s, t, m: 1.0 };
    }
    select(direction_of(face, s, t))
}

/// (largest − second largest)/largest of |r|'s components: 0 at a tie of two faces, 1 on an axis, 0 for the zero vector.
///
/// A computed direction with a smaller relative error than this has the same face.
pub fn tie_margin(r: Vector3) -> f64 {
    let mut sizes = r.map(f64::abs);
    sizes.sort_by(f64::total_cmp);
    if sizes[2] == 0.0 { 0.0 } else { (sizes[2] - sizes[1]) / sizes[2] }
}

#[cfg(test)]
mod tests {
    use super::super::linear::{norm, scaled};
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn table_is_vulkans() {
        // (direction, face, s_c, t_c) written out from the specification's table.
        let (x, y, z) = (0.25, 0.5, 0.125);
        for (direction, face, s, t) in [
            ([1.0, y, z], 0, -z, -y),
            ([-1.0, y, z], 1, z, -y),
            ([x, 1.0, z], 2, x, z),
            ([x, -1.0, z], 3, x, -z),
            ([x, y, 1.0], 4, x, -y),
            ([x, y, -1.0], 5, -x, -y),
        ] {
            assert_eq!(select(direction), Selection { face, s, t, m: 1.0 });
            assert_eq!(direction_of(face, s, t), direction);
        }
    }

    #[test]
    fn ties_go_to_z_then_y_then_x() {
        assert_eq!(select([1.0, 1.0, 1.0]).face, 4);
        assert_eq!(select([1.0, -1.0, -1.0]).face, 5);
        assert_eq!(select([-1.0, -1.0, 0.5]).face, 3);
        assert_eq!(select([-1.0, 0.0, 1.0]).face, 4);
        assert_eq!(select([0.0, 0.0, -0.0]).face, 4);
        assert_eq!(select([1.0, 1.0 - f64::EPSILON, 0.0]).face, 0);
        assert_eq!(tie_margin([1.0, -1.0, 0.0]), 0.0);
        assert_eq!(tie_margin([-4.0, 1.0, 2.0]), 0.5);
    }

    #[test]
    fn direction_of_inverts_select_and_probes_go_on_across_edges() {
        let mut random = SplitMix64::new(9);
        for _ in 0..1000 {
            let r = [0, 1, 2].map(|_| random.uniform(-1.0, 1.0));
            let at = select(r);
            assert!(at.s.abs() <= 1.0 && at.t.abs() <= 1.0);
            let back = scaled(at.m, direction_of(at.face, at.s, at.t));
            assert!((0..3).all(|i| (back[i] - r[i]).abs() < 1e-15));
            // The plane of the face, extended, names the same direction on the neighbour.
            let (s, t) = (at.s * 3.0, at.t * 3.0);
            let across = continue_across(at.face, s, t);
            let unit = |v: Vector3| scaled(1.0 / norm(&v), v);
            let wanted = unit(direction_of(at.face, s, t));
            let got = unit(direction_of(across.face, across.s, across.t));
            assert!((0..3).all(|i| (wanted[i] - got[i]).abs() < 1e-15));
        }
        assert_eq!(continue_across(2, 1.0, -1.0).face, 2);
        assert_eq!(continue_across(4, 1.5, 0.0).face, 0);
    }
}
