//! Peaks (F92 §2): light of a half vector by a sum of Phong-like peaks in the tangent basis of the surface.

use super::linear::{Vector3, dot, largest, norm, normalise_exponent, scale_exponent, scaled};

/// Local direction (d·E₁, d·E₂, d·n) at unit length; `None` if a vector of the basis is zero, or all three components are.
///
/// E₁, E₂ and n are in one unit, which does not matter. The length of d does not matter either.
pub fn local_direction(direction: Vector3, tangents: [Vector3; 2], normal: Vector3) -> Option<Vector3> {
    let (direction, _) = normalise_exponent(direction);
    let axes = [tangents[0], tangents[1], normal];
    let (_, exponent) = normalise_exponent(axes.map(|axis| largest(&axis)));
    let along = axes.map(|axis| dot(&scale_exponent(axis, -exponent), &direction));
    let frame = tangents.iter().all(|tangent| *tangent != [0.0; 3]);
    unit(along).filter(|_| frame)
}

/// A vector at unit length; `None` for zero.
pub fn unit(vector: Vector3) -> Option<Vector3> {
    let (vector, _) = normalise_exponent(vector);
    let length = norm(&vector);
    (length > 0.0).then(|| scaled(1.0 / length, vector))
}

/// a·max(0, N·H)ⁿ with N and H brought to unit length; 0 if either has none.
pub fn peak(h: Vector3, normal: Vector3, amplitude: f64, exponent: f64) -> f64 {
    let (Some(h), Some(normal)) = (unit(h), unit(normal)) else { return 0.0 };
    let cosine = dot(&h, &normal).min(1.0);
    if cosine > 0.0 { amplitude * cosine.powf(exponent) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_as_worked_by_hand() {
        // F92's three normals: cos between (.6, 0, .8) and (0, 0, 1) is .8.
        let value = peak([0.0, 0.0, 2.0], [0.6, 0.0, 0.8], 0.4, 3.0);
        assert!((value - 0.4 * 0.512).abs() < 1e-15);
        assert_eq!(peak([0.0, 0.0, -1.0], [0.6, 0.0, 0.8], 0.4, 3.0), 0.0);
        assert_eq!(peak([0.0; 3], [0.6, 0.0, 0.8], 0.4, 3.0), 0.0);
        assert_eq!(peak([0.0, 3.0, 0.0], [0.0, 1.0, 0.0], 0.4, 8192.0), 0.4);
    }

    #[test]
    fn a_local_direction_is_as_worked_by_hand() {
        let [x, y, z] = [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
        for (axes, want) in [([x, y, z], [0.0, 0.6, 0.8]), ([z, x, y], [0.8, 0.0, 0.6])] {
            let got = local_direction([0.0, 3.0, 4.0], [axes[0], axes[1]], axes[2]).expect("a direction in a frame");
            assert!((0..3).all(|i| (got[i] - want[i]).abs() < 1e-15), "{got:?}");
        }
        assert_eq!(local_direction([0.0; 3], [x, y], z), None);
        assert_eq!(local_direction(x, [[0.0; 3], y], z), None);
    }
}
