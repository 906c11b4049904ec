//! The formulas that decide how many of 24 bits remain: those that do not cancel, and the printed ones.

use glam::{Mat3, Vec2, Vec3};

use crate::math::Math;

/// Tangent basis E₁ and E₂, in the units of n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// E₁.
    pub e1: Vec3,
    /// E₂.
    pub e2: Vec3,
    /// True if an axis stands in for h.
    pub pole: bool,
}

/// A mirror and its view vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// n_mod.
    pub normal: Vec3,
    /// v.
    pub view: Vec3,
    /// v·n_mod.
    pub along: f32,
    /// |n_mod|².
    pub square: f32,
}

/// Main axes of a footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// λ₁, in the units of the columns.
    pub major: f32,
    /// λ₂.
    pub minor: f32,
    /// Unit direction of λ₁.
    pub direction: Vec2,
    /// True if the footprint is found to be empty.
    pub empty: bool,
}

/// Formulas that two users with the same library write differently. The rest of the datapath is the same line for both.
pub trait Formulas {
    /// Factor of λ₁/λ₂ before it is rounded up to a probe count.
    const ASPECT_SLACK: f32;

    /// Tangent basis E₁ = |n|·(h×n)/|h×n|, E₂ = n×(h×n)/|h×n|.
    fn frame<M: Math>(normal: Vec3, main_direction: Vec3) -> Frame;

    /// Change of r for a change of n_mod alone.
    fn curved(mirror: &Mirror, dnormal: Vec3) -> Vec3;

    /// Change of r for a change of v and of n_mod: dr = [2 n nᵀ − |n|²I]dv + 2[⟨n·v⟩I + n vᵀ − v nᵀ]dn (W97 (8), (9)).
    fn moved(mirror: &Mirror, dview: Vec3, dnormal: Vec3) -> Vec3;

    /// Axes of K = Σ q qᵀ.
    fn axes<M: Math>(q: &[Vec2; 4]) -> Axes;

    /// Logarithm of a level of detail.
    fn log2<M: Math>(x: f32) -> f32;

    /// max(0, N·H)ⁿ of two unit vectors.
    fn cosine_power<M: Math>(peak: Vec3, half: Vec3, exponent: f32) -> f32;
}

/// Formulas that do not cancel, with the degenerate cases, and a logarithm that is as good as a level of detail needs.
#[derive(Clone, Copy, Debug)]
pub struct Careful;

/// The printed formulas alone: if one has no result, the fragment has none.
#[derive(Clone, Copy, Debug)]
pub struct Plain;

/// a, b and c of K.
#[inline(always)]
fn covariance(q: &[Vec2; 4]) -> [f32; 3] {
    [
        q[0].x * q[0].x + q[1].x * q[1].x + q[2].x * q[2].x + q[3].x * q[3].x,
        q[0].x * q[0].y + q[1].x * q[1].y + q[2].x * q[2].y + q[3].x * q[3].y,
        q[0].y * q[0].y + q[1].y * q[1].y + q[2].y * q[2].y + q[3].y * q[3].y,
    ]
}

impl Formulas for Careful {
    /// A few roundings of λ₁/λ₂, so that a circle has one probe.
    const ASPECT_SLACK: f32 = 1.0 - 8.0 * f32::EPSILON;

    /// Tangent basis. At the pole the axis on which |n| is smallest stands in for h.
    #[inline(always)]
    fn frame<M: Math>(n: Vec3, main_direction: Vec3) -> Frame {
        let square = n.dot(n);
        let across = main_direction.cross(n);
        let pole = across.dot(across) == 0.0;
        let size = n.abs();
        let (least_x, least_y) = ((size.x <= size.y) & (size.x <= size.z), size.y <= size.z);
        let axis = if least_x {
            Vec3::X
        } else if least_y {
            Vec3::Y
        } else {
            Vec3::Z
        };
        let across = if pole { axis.cross(n) } else { across };
        let across_square = across.dot(across);
        let inverse = if across_square > 0.0 { M::inverse_sqrt(across_square) } else { 0.0 };
        Frame { e1: across * (M::sqrt(square) * inverse), e2: n.cross(across) * inverse, pole }
    }

    #[inline(always)]
    fn curved(mirror: &Mirror, dnormal: Vec3) -> Vec3 {
        let &Mirror { normal: n, view: v, along, .. } = mirror;
        (dnormal * along + n * v.dot(dnormal) - v * n.dot(dnormal)) * 2.0
    }

    #[inline(always)]
    fn moved(mirror: &Mirror, dview: Vec3, dnormal: Vec3) -> Vec3 {
        let &Mirror { normal: n, square, .. } = mirror;
        n * (2.0 * n.dot(dview)) - dview * square + Self::curved(mirror, dnormal)
    }

    /// Axes by det K = Σ of the squared minors of Q: λ₁² = ½(a + c + √((a − c)² + 4b²)), λ₂² = det/λ₁². The direction is that of (h + |a − c|, |2b|).
    #[inline(always)]
    fn axes<M: Math>(q: &[Vec2; 4]) -> Axes {
        let [a, b, c] = covariance(q);
        let minor_square = |i: usize, j: usize| {
            let minor = q[i].x * q[j].y - q[i].y * q[j].x;
            minor * minor
        };
        let det = minor_square(0, 1)
            + minor_square(0, 2)
            + minor_square(0, 3)
            + minor_square(1, 2)
            + minor_square(1, 3)
            + minor_square(2, 3);

        let (difference, twice_b) = (a - c, 2.0 * b);
        let h = M::sqrt(difference * difference + twice_b * twice_b);
        let major_square = 0.5 * (a + c + h);
        let major = M::sqrt(major_square);
        let empty = major_square == 0.0;
        let minor = if empty { 0.0 } else { M::sqrt(M::quotient(det, major_square)) };
        let larger = h + difference.abs();
        let circle = larger == 0.0;
        let unit = M::inverse_sqrt(larger * larger + twice_b * twice_b);
        let (cos, sin) = if circle { (1.0, 0.0) } else { (larger * unit, twice_b * unit) };
        let direction = if difference >= 0.0 { Vec2::new(cos, sin) } else { Vec2::new(sin, cos) };
        Axes { major, minor, direction, empty }
    }

    #[inline(always)]
    fn log2<M: Math>(x: f32) -> f32 {
        M::log2(x)
    }

    /// Power of a cosine as a power of 1 − N·H = |N − H|²/2.
    #[inline(always)]
    fn cosine_power<M: Math>(peak: Vec3, half: Vec3, exponent: f32) -> f32 {
        let difference = peak - half;
        let versine = 0.5 * difference.dot(difference);
        if versine < 1.0 { M::power_of_one_minus(versine, exponent) } else { 0.0 }
    }
}

impl Formulas for Plain {
    const ASPECT_SLACK: f32 = 1.0;

    /// Tangent basis of S97 §7.3.
    #[inline(always)]
    fn frame<M: Math>(n: Vec3, main_direction: Vec3) -> Frame {
        let across = main_direction.cross(n);
        let inverse = M::inverse_sqrt(across.dot(across));
        Frame { e1: across * (M::sqrt(n.dot(n)) * inverse), e2: n.cross(across) * inverse, pole: false }
    }

    #[inline(always)]
    fn curved(mirror: &Mirror, dnormal: Vec3) -> Vec3 {
        let &Mirror { normal: n, view: v, along, .. } = mirror;
        (Mat3::from_diagonal(Vec3::splat(along)) + outer(n, v) - outer(v, n)) * (dnormal * 2.0)
    }

    /// Matrices of W97 (8) and (9); each element is rounded.
    #[inline(always)]
    fn moved(mirror: &Mirror, dview: Vec3, dnormal: Vec3) -> Vec3 {
        let &Mirror { normal: n, square, .. } = mirror;
        (outer(n * 2.0, n) - Mat3::from_diagonal(Vec3::splat(square))) * dview + Self::curved(mirror, dnormal)
    }

    /// Axes by W97 (16) and (17), which cancels (erratum 12), and the eigenvector (b, λ₁² − a).
    #[inline(always)]
    fn axes<M: Math>(q: &[Vec2; 4]) -> Axes {
        let [a, b, c] = covariance(q);
        let h = M::sqrt((c - a) * (c - a) + 4.0 * b * b);
        let (major_square, minor_square) = (0.5 * (a + c + h), 0.5 * (a + c - h));
        let direction = Vec2::new(b, major_square - a);
        Axes {
            major: M::sqrt(major_square),
            minor: M::sqrt(minor_square),
            direction: direction * M::inverse_sqrt(direction.dot(direction)),
            empty: false,
        }
    }

    #[inline(always)]
    fn log2<M: Math>(x: f32) -> f32 {
        M::library_log2(x)
    }

    #[inline(always)]
    fn cosine_power<M: Math>(peak: Vec3, half: Vec3, exponent: f32) -> f32 {
        let cosine = peak.dot(half);
        if cosine > 0.0 { M::power(cosine, exponent) } else { 0.0 }
    }
}

/// Outer product a bᵀ.
#[inline(always)]
fn outer(a: Vec3, b: Vec3) -> Mat3 {
    Mat3::from_cols(a * b.x, a * b.y, a * b.z)
}
