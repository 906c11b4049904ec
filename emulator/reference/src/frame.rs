//! Tangent basis E₁, E₂ of a surface point in the three systems of S97 §7.
//!
//! Every basis vector carries the length that makes an offset mean the same for any |n|. Systems 2 and 3 scale unit vectors by |n| (erratum 17),
//! system 1 by the factor that turns n = p_u × p_v into Blinn's s_u, s_v.

use super::linear::{Vector3, cross, dot, norm, normalise_exponent, scale_exponent, scaled};

/// Tangent bases of S97 §7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameSystem {
    /// System 1: s_u = n̂ × p_v, s_v = p_u × n̂, the natural lengths.
    Natural,
    /// System 2: the directions of system 1, unit lengths.
    NaturalNormalised,
    /// System 3: e₁ = h×n/|h×n|, e₂ = n×e₁, with a main direction h.
    MainDirection,
}

/// Two vectors of a tangent basis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// E₁, in the units of n.
    pub e1: Vector3,
    /// E₂, in the units of n.
    pub e2: Vector3,
    /// True at a pole: the defining cross product vanished although n ≠ 0, and the fallback axis took the place of h.
    pub pole: bool,
}

const ZERO: Frame = Frame { e1: [0.0; 3], e2: [0.0; 3], pole: false };

/// Tangent basis of `system`; `tangents` holds h in slot 0 (system 3) or p_u and p_v (systems 1 and 2).
pub fn frame(system: FrameSystem, normal: Vector3, tangents: [Vector3; 2]) -> Frame {
    match system {
        FrameSystem::Natural => frame_natural(normal, tangents[0], tangents[1]),
        FrameSystem::NaturalNormalised => frame_natural_normalised(normal, tangents[0], tangents[1]),
        FrameSystem::MainDirection => frame_main_direction(normal, tangents[0]),
    }
}

/// System 3: E₁ = |n|·(h×n)/|h×n|, E₂ = n×(h×n)/|h×n|.
///
/// If h×n = 0 and n ≠ 0 (the pole, or h = 0), h becomes the axis on which |nᵢ| is smallest, x before y before z among equals. n = 0 gives zero
/// vectors and no pole.
pub fn frame_main_direction(normal: Vector3, main_direction: Vector3) -> Frame {
    if normal == [0.0; 3] {
        return ZERO;
    }
    let (n, exponent) = normalise_exponent(normal);
    let (h, _) = normalise_exponent(main_direction);
    let (west_east, pole) = match cross(h, n) {
        [0.0, 0.0, 0.0] => (cross(fallback_axis(n), n), true),
        across => (across, false),
    };
    // Near the pole all components are tiny but right to the last place; only their ratio counts.
    let (west_east, _) = normalise_exponent(west_east);
    let unit = scaled(1.0 / norm(&west_east), west_east);
    Frame { e1: scale_exponent(scaled(norm(&n), unit), exponent), e2: scale_exponent(cross(n, unit), exponent), pole }
}

/// System 1: E₁ = n×p_v/|p_u×p_v|, E₂ = p_u×n/|p_u×p_v|, which are s_u and s_v for n = p_u×p_v.
///
/// If p_u×p_v = 0 the basis is zero: there is no parametrisation to bump along, and the surface stays as it is.
pub fn frame_natural(normal: Vector3, p_u: Vector3, p_v: Vector3) -> Frame {
    let (u, u_exponent) = normalise_exponent(p_u);
    let (v, v_exponent) = normalise_exponent(p_v);
    let area = norm(&cross(u, v));
    if area == 0.0 {
        return Frame { pole: true, ..ZERO };
    }
    let (n, exponent) = normalise_exponent(normal);
    let divided = |vector, power| scale_exponent(scaled(1.0 / area, vector), exponent - power);
    Frame { e1: divided(cross(n, v), u_exponent), e2: divided(cross(u, n), v_exponent), pole: false }
}

/// System 2: E₁ = |n|·(n×p_v)/|n×p_v|, E₂ = |n|·(p_u×n)/|p_u×n|.
///
/// If one of the two cross products is 0 the basis is zero.
pub fn frame_natural_normalised(normal: Vector3, p_u: Vector3, p_v: Vector3) -> Frame {
    let (n, exponent) = normalise_exponent(normal);
    let (u, _) = normalise_exponent(p_u);
    let (v, _) = normalise_exponent(p_v);
    let (across_u, across_v) = (cross(n, v), cross(u, n));
    if across_u == [0.0; 3] || across_v == [0.0; 3] {
        return Frame { pole: true, ..ZERO };
    }
    let length = norm(&n);
    let of_length = |vector: Vector3| {
        let (vector, _) = normalise_exponent(vector);
        scale_exponent(scaled(length / norm(&vector), vector), exponent)
    };
    Frame { e1: of_length(across_u), e2: of_length(across_v), pole: false }
}

/// Unit axis on which |nᵢ| is smallest; x before y before z among equals.
pub fn fallback_axis(normal: Vector3) -> Vector3 {
    let [x, y, z] = normal.map(f64::abs);
    if x <= y && x <= z {
        [1.0, 0.0, 0.0]
    } else if y <= z {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    }
}

/// Worst violation of an orthogonal basis of length |n|, relative to |n|: |⟨Eᵢ,n⟩|/|n|², |⟨E₁,E₂⟩|/|n|², ||Eᵢ|−|n||/|n|.
///
/// It measures the accuracy requirement "orthogonality, unit length" for system 3.
pub fn orthonormality_error(normal: Vector3, e1: Vector3, e2: Vector3) -> f64 {
    let length = norm(&normal);
    let [n, e1, e2] = [normal, e1, e2].map(|vector| scaled(1.0 / length, vector));
    [dot(&e1, &n), dot(&e2, &n), dot(&e1, &e2), norm(&e1) - 1.0, norm(&e2) - 1.0]
        .iter()
        .fold(0.0, |worst: f64, error| worst.max(error.abs()))
}

#[cfg(test)]
mod tests {
    use super::super::linear::add_scaled;
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn frame_stays_orthonormal_down_to_one_bit() {
        let mut random = SplitMix64::new(1);
        for _ in 0..10_000 {
            // 31-bit integers one unit apart: the products need 62 bits, the cross product is a few units.
            let h = [0, 1, 2].map(|_| (random.uniform(-1.0, 1.0) * 2_f64.powi(30)).round());
            let mut n = h;
            n[(random.next_u64() % 3) as usize] += 1.0;
            let frame = frame_main_direction(n, h);
            assert!(!frame.pole);
            // A dozen roundings of 2⁻⁵³.
            assert!(orthonormality_error(n, frame.e1, frame.e2) < 1e-15);
            let exact = exact_cross(h, n);
            let length = norm(&exact);
            let error = add_scaled(scaled(1.0 / length, exact), -1.0 / norm(&n), frame.e1);
            assert!(norm(&error) < 1e-15, "{h:?} {n:?}");
        }
    }

    fn exact_cross(a: Vector3, b: Vector3) -> Vector3 {
        let [a, b] = [a, b].map(|vector| vector.map(|x| x as i128));
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]].map(|x| x as f64)
    }

    #[test]
    fn poles_take_the_documented_axis() {
        for (n, axis) in [
            ([0.0, 3.0, 0.0], [1.0, 0.0, 0.0]),
            ([3.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ([3.0, 1.0, 0.5], [0.0, 0.0, 1.0]),
            ([1.0, 1.0, 1.0], [1.0, 0.0, 0.0]),
            ([2.0, -1.0, 1.0], [0.0, 1.0, 0.0]),
        ] {
            for h in [n, scaled(-7.0, n), [0.0; 3]] {
                let at_pole = frame_main_direction(n, h);
                let beside = frame_main_direction(n, axis);
                assert!(at_pole.pole && !beside.pole);
                assert_eq!((at_pole.e1, at_pole.e2), (beside.e1, beside.e2));
            }
        }
        assert_eq!(frame_main_direction([0.0; 3], [0.0, 1.0, 0.0]), ZERO);
    }

    #[test]
    fn natural_frame_is_blinns_when_n_is_the_product_of_the_tangents() {
        let mut random = SplitMix64::new(2);
        for _ in 0..1000 {
            let [p_u, p_v] = [0, 1].map(|_| [0, 1, 2].map(|_| random.uniform(-2.0, 2.0)));
            let n = cross(p_u, p_v);
            let unit = scaled(1.0 / norm(&n), n);
            let frame = frame_natural(n, p_u, p_v);
            for (got, expected) in [(frame.e1, cross(unit, p_v)), (frame.e2, cross(p_u, unit))] {
                assert!(norm(&add_scaled(got, -1.0, expected)) < 1e-14);
            }
            // S97: n = s_u × s_v.
            assert!(norm(&add_scaled(cross(frame.e1, frame.e2), -1.0, n)) < 1e-13);
            // Lengths are relative to |n|: twice the normal, twice the basis.
            assert_eq!(frame_natural(scaled(2.0, n), p_u, p_v).e1, scaled(2.0, frame.e1));
        }
    }

    #[test]
    fn normalised_frame_does_not_see_the_lengths_of_the_tangents() {
        let (n, p_u, p_v) = ([0.0, 0.0, 3.0], [5.0, 0.0, 0.0], [1.0, 0.25, 0.0]);
        let frame = frame_natural_normalised(n, p_u, p_v);
        assert_eq!(frame, frame_natural_normalised(n, scaled(8.0, p_u), scaled(0.5, p_v)));
        assert!((norm(&frame.e1) - 3.0).abs() < 1e-15 && (norm(&frame.e2) - 3.0).abs() < 1e-15);
        assert_eq!(dot(&frame.e1, &p_v), 0.0);
        assert_eq!(frame.e2, [0.0, -3.0, 0.0]);
        // An orthogonal map in the plane z = 0: s_u runs along −p_u, s_v along −p_v.
        let orthogonal = frame_natural_normalised(n, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        assert_eq!((orthogonal.e1, orthogonal.e2), ([-3.0, 0.0, 0.0], [0.0, -3.0, 0.0]));
        assert!(frame_natural_normalised(n, p_u, n).pole);
        assert!(frame_natural(n, p_u, p_u).pole);
    }
}
