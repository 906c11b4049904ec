//! Footprint ellipse K = (1/12)(q₁q₁ᵀ + q₂q₂ᵀ) + q₃q₃ᵀ + q₄q₄ᵀ = [[a, b], [b, c]], all covariances.
//!
//! q₁, q₂ span a pixel box of unit edges, variance 1/12 along each (errata 4 and 5); q₃, q₄ are roughness and
//! already standard deviations. K = Q Qᵀ (erratum 1), and det K is the sum of the squared 2×2 minors of Q
//! (Cauchy–Binet, erratum 12): six squares, nothing cancels between them.

use super::linear::{Vector2, difference_of_products};

/// Weights of the four columns in K: pixel box, pixel box, roughness, roughness.
pub const WEIGHTS: [f64; 4] = [1.0 / 12.0, 1.0 / 12.0, 1.0, 1.0];

/// A covariance matrix K = [[a, b], [b, c]] of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// Variance along the first axis.
    pub a: f64,
    /// Covariance.
    pub b: f64,
    /// Variance along the second axis.
    pub c: f64,
    /// Determinant ac − b², free of cancellation if it comes from columns.
    pub det: f64,
}

impl Ellipse {
    /// The ellipse of a matrix known only by its entries; det = ac − b² within 1.5 units in the last place of the entries.
    pub fn from_matrix([a, b, c]: [f64; 3]) -> Self {
        Self { a, b, c, det: difference_of_products(a, c, b, b).max(0.0) }
    }

    /// xᵀK⁻¹x; 1 on the ellipse of one standard deviation. K must have rank 2.
    pub fn quadratic_form(&self, x: Vector2) -> f64 {
        (self.c * x[0] * x[0] - 2.0 * self.b * x[0] * x[1] + self.a * x[1] * x[1]) / self.det
    }
}

/// K and its determinant from the four columns.
///
/// The determinant takes fourth powers: the caller brings columns outside 2^±200 to a common exponent.
pub fn ellipse(q: &[Vector2; 4]) -> Ellipse {
    let [mut a, mut b, mut c, mut det] = [0.0; 4];
    for i in 0..4 {
        let [s, t] = q[i];
        a += WEIGHTS[i] * s * s;
        b += WEIGHTS[i] * s * t;
        c += WEIGHTS[i] * t * t;
        for j in i + 1..4 {
            let minor = difference_of_products(s, q[j][1], t, q[j][0]);
            det += WEIGHTS[i] * WEIGHTS[j] * minor * minor;
        }
    }
    Ellipse { a, b, c, det }
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn minors_sum_to_the_determinant() {
        let mut random = SplitMix64::new(8);
        for _ in 0..1000 {
            let columns = [0; 4].map(|_| [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)]);
            let k = ellipse(&columns);
            let direct = k.a * k.c - k.b * k.b;
            // Random columns are well conditioned: both forms are good to a few ulp of ac.
            assert!((k.det - direct).abs() < 1e-15 * (k.a * k.c + k.b * k.b) * 4.0);
        }
    }

    #[test]
    fn pixel_box_has_variance_a_twelfth() {
        let k = ellipse(&[[2.0, 0.0], [0.0, 3.0], [0.0; 2], [0.0; 2]]);
        assert!((k.a - 4.0 / 12.0).abs() < 1e-16 && (k.c - 9.0 / 12.0).abs() < 1e-16);
        assert!((k.det - 0.25).abs() < 1e-16);
        let rough = ellipse(&[[0.0; 2], [0.0; 2], [2.0, 1.0], [0.0, 3.0]]);
        assert_eq!((rough.a, rough.b, rough.c, rough.det), (4.0, 2.0, 10.0, 36.0));
    }

    #[test]
    fn determinant_of_nearly_parallel_columns_is_right() {
        // The columns differ by one part in 2³⁰: ac − b² loses all digits, the minor none.
        let small = 2_f64.powi(-30);
        let k = ellipse(&[[0.0; 2], [0.0; 2], [1.0, 1.0], [1.0, 1.0 + small]]);
        assert_eq!(k.det, small * small);
        assert_eq!(ellipse(&[[0.0; 2]; 4]).det, 0.0);
    }

    #[test]
    fn quadratic_form_is_one_on_the_image_of_the_unit_circle() {
        let k = ellipse(&[[0.0; 2], [0.0; 2], [4.0, 0.0], [3.0, 0.5]]);
        for i in 0..360 {
            let (sin, cos) = f64::from(i).to_radians().sin_cos();
            let x = [4.0 * cos + 3.0 * sin, 0.5 * sin];
            assert!((k.quadratic_form(x) - 1.0).abs() < 1e-12);
        }
    }
}
