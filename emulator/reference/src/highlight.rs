//! Modified Blinn-Phong highlight (S97 App. A with errata 6, 7, 8), and the models for comparison.
//!
//! Facets lie at n_mod + δ in the plane perpendicular to n_mod, δ of covariance K + |n_mod|²·I/m. The half vector meets that plane at the distance y;
//! f = √(det I/m / det M)·(1 + yᵀM⁻¹y/m)^(−m/2) with M = K + I/m relative to |n_mod|. M is an explicit 2×2 matrix in an orthonormal basis of the
//! plane; the integer datapath has cross products only.

use super::linear::{
    Vector2, Vector3, add_scaled, cross, difference_of_products, dot, norm, normalise_exponent, scaled,
};
use super::roughness::Triangular;

/// Fragment and light of a highlight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Geometric normal n, any length.
    pub normal: Vector3,
    /// Perturbed normal n_mod, any length.
    pub normal_mod: Vector3,
    /// Tangents of the roughness, d₁E₁ and d₂E₁ + d₃E₂, in the units of `normal_mod`.
    pub tangents: [Vector3; 2],
    /// Vector from the surface to the eye, any length.
    pub view: Vector3,
    /// Vector from the surface to the light, any length.
    pub light: Vector3,
    /// Exponent m ≥ 1.
    pub exponent: f64,
}

/// Results of one light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highlight {
    /// Half vector l/|l| + v/|v|; zero if l or v is.
    pub half: Vector3,
    /// Share of the light that the highlight returns, [0, 1].
    pub f: f64,
    /// n·l/(|n||l|), which decides if the surface is lit; 0 for zero vectors.
    pub facing: f64,
}

fn unit(a: Vector3) -> Vector3 {
    let (a, _) = normalise_exponent(a);
    let length = norm(&a);
    if length == 0.0 { a } else { scaled(1.0 / length, a) }
}

/// Half vector of two directions of any length; zero if either is zero.
pub fn half(light: Vector3, view: Vector3) -> Vector3 {
    let (light, view) = (unit(light), unit(view));
    if light == [0.0; 3] || view == [0.0; 3] { [0.0; 3] } else { add_scaled(light, 1.0, view) }
}

/// Highlight of one light. f is 0 if the light is on the horizon of n or below it, if n_mod faces away from h, or if any of n, n_mod, v, l, h is
/// zero.
pub fn highlight(scene: &Scene) -> Highlight {
    let Scene { normal, normal_mod, tangents, view, light, exponent } = *scene;
    let half = half(light, view);
    let facing = dot(&unit(normal), &unit(light));
    let axis = unit(normal_mod);
    let along = dot(&axis, &half);
    if facing <= 0.0 || along <= 0.0 {
        return Highlight { half, f: 0.0, facing };
    }
    let [t1, t2] = basis(axis);
    let y = [dot(&t1, &half) / along, dot(&t2, &half) / along];
    let length = norm(&normal_mod);
    let [p, q] = tangents.map(|c| [dot(&t1, &c) / length, dot(&t2, &c) / length]);
    let base = 1.0 / exponent;
    let k = [base + p[0] * p[0] + q[0] * q[0], p[0] * p[1] + q[0] * q[1], base + p[1] * p[1] + q[1] * q[1]];
    Highlight { half, f: lobe(k, y, exponent), facing }
}

/// Two unit vectors perpendicular to each other and to a unit vector.
fn basis(axis: Vector3) -> [Vector3; 2] {
    let smallest = (0..3).fold(0, |best, i| if axis[i].abs() < axis[best].abs() { i } else { best });
    let mut other = [0.0; 3];
    other[smallest] = 1.0;
    let first = unit(cross(axis, other));
    [first, cross(axis, first)]
}

/// √(det I/m / det M)·(1 + yᵀM⁻¹y/m)^(−m/2) of M = [[a, b], [b, c]], which contains I/m.
pub fn lobe([a, b, c]: [f64; 3], y: Vector2, m: f64) -> f64 {
    let det = difference_of_products(a, c, b, b);
    let form = (c * y[0] * y[0] - 2.0 * b * y[0] * y[1] + a * y[1] * y[1]) / det;
    (-0.5 * m * (form / m).ln_1p()).exp() / (m * det.sqrt())
}

/// Plain Blinn-Phong, max(0, n·h)^m of any lengths.
pub fn blinn_phong(normal: Vector3, half: Vector3, m: f64) -> f64 {
    dot(&unit(normal), &unit(half)).max(0.0).powf(m)
}

/// cos²a′ of S97 App. A as printed, with |Dd|² of the upper triangular D and d the projection of n − h into the plane of E₁ and E₂. It is 0/0 at n =
/// h and for D = 0 (erratum 7).
pub fn printed_cos2(d: Triangular, n_minus_h: Vector2) -> f64 {
    let length2 = dot(&n_minus_h, &n_minus_h);
    let [d1, d2, d3] = d;
    let spread2 = (d1 * n_minus_h[0] + d2 * n_minus_h[1]).powi(2) + (d3 * n_minus_h[1]).powi(2);
    let cos2 = 1.0 - length2;
    cos2 / (length2 * length2 / spread2 + cos2)
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn a_smooth_surface_has_the_plain_highlight() {
        let mut random = SplitMix64::new(5);
        for _ in 0..1000 {
            let mut vector = || [0, 1, 2].map(|_| random.uniform(-1.0, 1.0));
            let (normal, view, light) = (vector(), vector(), vector());
            let exponent = random.uniform(1.0, 100.0);
            let scene = Scene { normal, normal_mod: normal, tangents: [[0.0; 3]; 2], view, light, exponent };
            let got = highlight(&scene);
            let want = if got.facing > 0.0 { blinn_phong(normal, got.half, exponent) } else { 0.0 };
            assert!((got.f - want).abs() < 1e-12, "{scene:?}: {} for {want}", got.f);
        }
    }

    #[test]
    fn the_basis_is_orthonormal() {
        let mut random = SplitMix64::new(6);
        for _ in 0..1000 {
            let axis = unit([0, 1, 2].map(|_| random.uniform(-1.0, 1.0)));
            let [a, b] = basis(axis);
            for (x, y, want) in [(a, a, 1.0), (b, b, 1.0), (a, b, 0.0), (a, axis, 0.0), (b, axis, 0.0)] {
                assert!((dot(&x, &y) - want).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn zero_vectors_give_no_highlight() {
        let plain = Scene {
            normal: [0.0, 0.0, 1.0],
            normal_mod: [0.0, 0.0, 1.0],
            tangents: [[0.0; 3]; 2],
            view: [0.0, 0.0, 1.0],
            light: [0.0, 0.0, 3.0],
            exponent: 8.0,
        };
        assert_eq!(highlight(&plain).f, 1.0);
        let zero = [0.0; 3];
        for scene in [
            Scene { normal: zero, ..plain },
            Scene { normal_mod: zero, ..plain },
            Scene { view: zero, ..plain },
            Scene { light: zero, ..plain },
            Scene { view: [0.0, 0.0, -1.0], ..plain },
            Scene { light: [1.0, 0.0, 0.0], ..plain },
        ] {
            assert_eq!(highlight(&scene).f, 0.0, "{scene:?}");
        }
    }
}
