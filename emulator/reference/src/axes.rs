//! Main axes of the ellipse: standard deviations λ₁ ≥ λ₂ and the direction of λ₁.
//!
//! λ₁² = ½(a + c + √((c−a)² + 4b²)) (W97 (16)); λ₂² = det/λ₁² (erratum 12, (17) cancels); the direction has the angle
//! ½·atan2(2b, a−c), which needs no case distinction (W97's is reversed, erratum 2).

use super::ellipse::Ellipse;
use super::linear::Vector2;

/// Main axes of an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// λ₁, the larger standard deviation.
    pub major: f64,
    /// λ₂, the smaller one; 0 if the columns are parallel.
    pub minor: f64,
    /// Unit direction of λ₁; its larger component is positive, the first one among equals. A circle gives (1, 0).
    pub direction: Vector2,
}

impl Axes {
    /// λ₁/λ₂ before any rounding to a probe count; ∞ for a line, 1 for a point.
    pub fn ratio(&self) -> f64 {
        if self.major == 0.0 { 1.0 } else { self.major / self.minor }
    }
}

/// Eigenvalues (as standard deviations) and first eigenvector of K.
pub fn axes(ellipse: &Ellipse) -> Axes {
    let &Ellipse { a, b, c, det } = ellipse;
    let major_variance = 0.5 * (a + c + (c - a).hypot(2.0 * b));
    let major = major_variance.sqrt();
    let minor = if major == 0.0 { 0.0 } else { (det.sqrt() / major).min(major) };
    let (sin, cos) = (0.5 * (2.0 * b).atan2(a - c)).sin_cos();
    let direction = if a == c && b == 0.0 {
        [1.0, 0.0]
    } else if a == c {
        // Exactly ±45°; sin_cos would break the tie of the components by its last bit.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        [half, half.copysign(b)]
    } else if sin.abs() > cos.abs() && sin < 0.0 {
        [-cos, -sin]
    } else {
        [cos, sin]
    };
    Axes { major, minor, direction }
}

#[cfg(test)]
mod tests {
    use super::super::ellipse::ellipse;
    use super::super::linear::{axis_angle, norm};
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn axes_diagonalise_the_matrix() {
        let mut random = SplitMix64::new(10);
        for _ in 0..2000 {
            let columns = [0; 4].map(|_| [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)]);
            let k = ellipse(&columns);
            let Axes { major, minor, direction: [x, y] } = axes(&k);
            assert!(major >= minor && minor >= 0.0);
            assert!((norm(&[x, y]) - 1.0).abs() < 1e-15);
            assert!(if x.abs() >= y.abs() { x > 0.0 } else { y > 0.0 });
            let image = [k.a * x + k.b * y, k.b * x + k.c * y];
            let error = [image[0] - major * major * x, image[1] - major * major * y];
            assert!(norm(&error) < 1e-14 * k.a.max(k.c) * 4.0);
            assert!((major * major + minor * minor - k.a - k.c).abs() < 1e-14 * (k.a + k.c));
        }
    }

    #[test]
    fn given_axes_come_back_at_every_angle_and_aspect() {
        for degrees in 0..180 {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            for aspect in [1.1, 2.0, 16.0, 1000.0, 1e6] {
                // Skewed columns with the same K: a rotation on the right of Q changes nothing.
                let (major, minor) = ([3.0 * cos, 3.0 * sin], [-3.0 / aspect * sin, 3.0 / aspect * cos]);
                let (turn_sin, turn_cos) = 0.7_f64.sin_cos();
                let mix = |p: f64, q: f64| [p * major[0] + q * minor[0], p * major[1] + q * minor[1]];
                let k = ellipse(&[[0.0; 2], [0.0; 2], mix(turn_cos, -turn_sin), mix(turn_sin, turn_cos)]);
                let got = axes(&k);
                assert!((got.major / 3.0 - 1.0).abs() < 1e-14);
                // The columns are rounded to 2⁻⁵³ of the major axis, which is aspect times the minor one.
                assert!((got.minor * aspect / 3.0 - 1.0).abs() < 4e-16 * aspect + 1e-14);
                assert!(axis_angle(got.direction, [cos, sin]) < 1e-13);
            }
        }
    }

    #[test]
    fn degenerate_ellipses_give_the_documented_axes() {
        let of = |matrix| axes(&Ellipse::from_matrix(matrix));
        assert_eq!(of([4.0, 0.0, 4.0]), Axes { major: 2.0, minor: 2.0, direction: [1.0, 0.0] });
        assert_eq!(of([0.0, 0.0, 0.0]).major, 0.0);
        assert_eq!(of([0.0, 0.0, 0.0]).ratio(), 1.0);
        assert_eq!(of([9.0, 0.0, 0.0]), Axes { major: 3.0, minor: 0.0, direction: [1.0, 0.0] });
        let upright = of([0.0, 0.0, 9.0]).direction;
        assert!(upright[0].abs() < 1e-16 && upright[1] == 1.0);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert_eq!(of([2.0, 1.0, 2.0]).direction, [half, half]);
        assert_eq!(of([2.0, -1.0, 2.0]).direction, [half, -half]);
        assert_eq!(of([1.0, 1.0, 1.0]).ratio(), f64::INFINITY);
    }
}
