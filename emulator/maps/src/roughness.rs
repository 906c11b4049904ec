//! Roughness of a bump map: the covariance K = (a, b; b, c) of the offsets that a level no longer shows (S97 §8).
//!
//! S97's recursion K_l = ¼(Σ K_{l−1,n} + Σ (f_n − f̄)(f_n − f̄)ᵀ), with the plus that its print lacks (erratum 14), is the
//! covariance over the whole area of a texel. It is computed as such, `E[f fᵀ] − E[f] E[f]ᵀ`, from exact integer moments of
//! level 0. Nothing cancels and sizes need not be even. Maps store not K but D with K = D Dᵀ, D = (d₁, d₂; 0, d₃). A
//! quantised K of a corrugated map has ac < b² in half of its texels (erratum 13), while any D is the root of a covariance.
//! c = 0 means d₂ = 0, d₁ = √a. Isotropic maps store I₁, the root of the larger eigenvalue, rounded up: never smoother than
//! the surface.

use crate::mip::for_each_level;
pub use roughxel_core::precision::RoughnessKind;
use roughxel_scene::RoughnessField;
use roughxel_scene::levels::Cover;
use roughxel_simd::{Backend, LANES};
use roughxel_utilities::exp2::power_of_two;

/// Kind and word length of stored roughness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RoughnessStorage {
    kind: RoughnessKind,
    bits: u32,
}

impl RoughnessStorage {
    /// Roughness stored in `bits` bits a component, clamped to 2…16.
    ///
    /// d₁, d₃ and I₁ are unsigned codes of `bits` bits; d₂ has the same step and an additional sign bit.
    pub fn new(kind: RoughnessKind, bits: u32) -> Self {
        Self { kind, bits: bits.clamp(2, 16) }
    }

    /// Kind of the stored roughness.
    pub fn kind(&self) -> RoughnessKind {
        self.kind
    }

    /// Bits of a component without sign, 2…16.
    pub fn bits(&self) -> u32 {
        self.bits
    }

    /// Largest code.
    fn largest_code(&self) -> f64 {
        power_of_two(self.bits as i32) - 1.0
    }

    /// The kept components of a covariance before quantisation; slots that the kind does not use are 0.
    pub(crate) fn components(&self, covariance: Covariance) -> [f64; 3] {
        match self.kind {
            RoughnessKind::None => [0.0; 3],
            RoughnessKind::Isotropic => [covariance.largest_deviation(), 0.0, 0.0],
            RoughnessKind::Anisotropic => covariance.factor(),
        }
    }

    /// Codes of [`RoughnessStorage::components`] for value = code · 2^(exponent − bits), saturated.
    ///
    /// Rounding: d₁, d₂, d₃ to nearest, ties up; I₁ up. Range: d₁, d₃, I₁ 0…2^bits − 1, d₂ ±(2^bits − 1).
    pub(crate) fn quantise(&self, components: [f64; 3], exponent: i32) -> [i32; 3] {
        let scale = power_of_two(self.bits as i32 - exponent);
        let limit = self.largest_code();
        components.map(|component| self.round(component * scale).clamp(-limit, limit) as i32)
    }

    /// The smallest exponent whose codes hold `largest`, from bits − 28 (one code = 2⁻²⁸) to 3 (values below 8).
    pub(crate) fn smallest_exponent(&self, largest: f64) -> i32 {
        let lowest = self.bits as i32 - 28;
        (lowest..3)
            .find(|exponent| self.round(largest * power_of_two(self.bits as i32 - exponent)) <= self.largest_code())
            .unwrap_or(3)
    }

    fn round(&self, scaled: f64) -> f64 {
        match self.kind {
            RoughnessKind::Isotropic => scaled.ceil(),
            RoughnessKind::None | RoughnessKind::Anisotropic => (scaled + 0.5).floor(),
        }
    }
}

/// Sums of b₁, b₂, b₁², b₁b₂, b₂² over an area, in units of one offset code.
pub(crate) type Moments = [i64; 5];

/// Moments of one texel of level 0. Range: |code| ≤ 2^15.
pub(crate) fn moments([b1, b2]: [i16; 2]) -> Moments {
    let (b1, b2) = (i64::from(b1), i64::from(b2));
    [b1, b2, b1 * b1, b1 * b2, b2 * b2]
}

/// Symmetric matrix (a, b; b, c), positive semidefinite up to the rounding of float64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Covariance {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
}

impl Covariance {
    /// Covariance over an area of weight `area`, in squared offset codes.
    ///
    /// area · Σbb − Σb Σb is exact in 128 bits (sums up to 2^56, area up to 2^26). The only roundings are those of its
    /// conversion, of area² and of the quotient.
    pub(crate) fn from_moments([s1, s2, s11, s12, s22]: Moments, area: i64) -> Self {
        let area_squared = area as f64 * area as f64;
        let entry = |square: i64, first: i64, second: i64| {
            let exact = i128::from(area) * i128::from(square) - i128::from(first) * i128::from(second);
            exact as f64 / area_squared
        };
        Self { a: entry(s11, s1, s1), b: entry(s12, s1, s2), c: entry(s22, s2, s2) }
    }

    /// The covariance of the sum of two independent deviations: variances add.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }

    /// The covariance of `factor` times the deviations.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        let square = factor * factor;
        Self { a: square * self.a, b: square * self.b, c: square * self.c }
    }

    /// Factor of a covariance: d₁ = √(a − b²/c), d₂ = b/√c, d₃ = √c. For c = 0, d₁ = √a, d₂ = d₃ = 0 (erratum 13).
    ///
    /// a − b²/c may round to a last bit below 0 if K is singular; it counts as 0.
    pub(crate) fn factor(self) -> [f64; 3] {
        if self.c == 0.0 {
            return [self.a.sqrt(), 0.0, 0.0];
        }
        let d3 = self.c.sqrt();
        let rest = self.a - self.b * self.b / self.c;
        [rest.max(0.0).sqrt(), self.b / d3, d3]
    }

    /// I₁: root of the larger eigenvalue (a + c + √((a − c)² + 4b²))/2, a sum that cannot cancel.
    pub(crate) fn largest_deviation(self) -> f64 {
        let difference = self.a - self.c;
        let root = (difference * difference + 4.0 * self.b * self.b).sqrt();
        ((self.a + self.c + root) / 2.0).sqrt()
    }
}

/// Nearness of most bumps of an area to their mean: (E|z|)² in units of the normal law's, z = K^(−½)(f − f̄); from ½ to 1.
///
/// Bumps of the normal law have 1. Photographs of bricks and of gravel are mostly flat and seldom steep. A lobe of their standard deviation fits
/// neither kind of bump. With this factor the deviation is that of most facets; the few steep ones are left out. A factor below one half would lose
/// more by the missing steep facets than it gains with the others (`real_scenes` of the host tests). Texels at the edge of an area count as whole
/// texels.
pub(crate) fn concentration<'a>(
    mean: [f64; 2],
    covariance: Covariance,
    [columns, rows]: [&Cover; 2],
    row: impl Fn(usize) -> &'a [[i16; 2]],
) -> f64 {
    let Some(metric) = Metric::new(covariance) else { return 1.0 };
    // The mean of |z| is √(2/π) along one axis, √(π/2) along two.
    let expected = match metric {
        Metric::Line { .. } => std::f64::consts::FRAC_2_PI.sqrt(),
        Metric::Plane { .. } => std::f64::consts::FRAC_PI_2.sqrt(),
    };
    let mut sum = 0.0;
    Backend::best().run(
        #[inline(always)]
        || {
            for y in rows.first..=rows.last {
                let (groups, rest) = row(y)[columns.first..=columns.last].as_chunks::<LANES>();
                for offsets in groups {
                    metric.lengths(offsets, mean).iter().for_each(|length| sum += length);
                }
                if !rest.is_empty() {
                    let mut last = [[0; 2]; LANES];
                    last[..rest.len()].copy_from_slice(rest);
                    metric.lengths(&last, mean)[..rest.len()].iter().for_each(|length| sum += length);
                }
            }
        },
    );
    let count = (columns.last - columns.first + 1) * (rows.last - rows.first + 1);
    let mean = sum / (count as f64 * expected);
    (mean * mean).clamp(0.5, 1.0)
}

/// Measure of the length of z.
#[derive(Clone, Copy)]
pub(crate) enum Metric {
    /// Measure for bumps along one axis.
    Line { trace: f64 },
    /// Measure by the inverse of K.
    Plane { covariance: Covariance, determinant: f64 },
}

impl Metric {
    /// Measure for bumps of a covariance; `None` if there are no bumps.
    pub(crate) fn new(covariance: Covariance) -> Option<Self> {
        let Covariance { a, b, c } = covariance;
        let (trace, determinant) = (a + c, a * c - b * b);
        let is_line = determinant <= 1e-9 * trace * trace;
        let metric = if is_line { Self::Line { trace } } else { Self::Plane { covariance, determinant } };
        (trace > 0.0).then_some(metric)
    }

    /// |z| of a group of bumps.
    #[inline(always)]
    fn lengths(self, offsets: &[[i16; 2]; LANES], mean: [f64; 2]) -> [f64; LANES] {
        let mut lengths = self.squares(offsets, mean);
        for length in &mut lengths {
            *length = length.sqrt();
        }
        lengths
    }

    /// Squares z² of a group of bumps.
    #[inline(always)]
    pub(crate) fn squares(self, offsets: &[[i16; 2]; LANES], mean: [f64; 2]) -> [f64; LANES] {
        let mut squares = [0.0; LANES];
        for lane in 0..LANES {
            let [u, v] = [f64::from(offsets[lane][0]) - mean[0], f64::from(offsets[lane][1]) - mean[1]];
            let square = match self {
                Self::Line { trace } => (u * u + v * v) / trace,
                Self::Plane { covariance: Covariance { a, b, c }, determinant } => {
                    (c * u * u - 2.0 * b * u * v + a * v * v) / determinant
                }
            };
            squares[lane] = square.max(0.0);
        }
        squares
    }
}

/// Fraction bits of the factors of a roughness map before they are averaged.
const MAP_BITS: u32 = 16;

/// The covariance a roughness map adds on every level: the mean of its K = D Dᵀ over the area of a texel (erratum 15).
pub(crate) struct AddedRoughness {
    levels: Vec<Vec<Covariance>>,
}

impl AddedRoughness {
    /// Makes the means of a map, in squared units of `lsb`, a power of two.
    ///
    /// Factors are rounded to 16 bits first (one code is at most 2⁻¹³); their squares, below 2^33, are summed exactly.
    pub(crate) fn new(field: &RoughnessField, lsb: f64) -> Self {
        let storage = RoughnessStorage::new(RoughnessKind::Anisotropic, MAP_BITS);
        let largest = field.factors.iter().flatten().fold(0.0, |largest: f64, d| largest.max(f64::from(d.abs())));
        let exponent = storage.smallest_exponent(largest);
        let codes: Vec<[i32; 3]> =
            field.factors.iter().map(|factor| storage.quantise(factor.map(f64::from), exponent)).collect();
        let unit = power_of_two(exponent - MAP_BITS as i32) / lsb;
        let squares = |index: usize| {
            let [d1, d2, d3] = codes[index].map(i64::from);
            [d1 * d1 + d2 * d2, d2 * d3, d3 * d3]
        };
        let covariance = |sums: [i64; 3], area: i64| {
            let [a, b, c] = sums.map(|sum| sum as f64 / area as f64 * (unit * unit));
            Covariance { a, b, c }
        };
        let mut levels = vec![(0..codes.len()).map(|index| covariance(squares(index), 1)).collect()];
        for_each_level(field.width, field.height, squares, |sums| {
            levels.push(sums.sums.iter().map(|&texel| covariance(texel, sums.area)).collect());
        });
        Self { levels }
    }

    /// Covariance added to a texel of a level of the bump map; constant for a map of one texel.
    pub(crate) fn texel(&self, level: usize, index: usize) -> Covariance {
        if self.levels.len() == 1 { self.levels[0][0] } else { self.levels[level][index] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covariance_of(offsets: &[[i16; 2]]) -> Covariance {
        let mut sums = [0; 5];
        for offset in offsets {
            for (sum, moment) in sums.iter_mut().zip(moments(*offset)) {
                *sum += moment;
            }
        }
        Covariance::from_moments(sums, offsets.len() as i64)
    }

    #[test]
    fn c_zero_gives_all_variance_to_d1() {
        let k = covariance_of(&[[300, 7], [-300, 7]]);
        assert_eq!(k.factor(), [300.0, 0.0, 0.0]);
        assert_eq!(k.largest_deviation(), 300.0);
    }

    #[test]
    fn c_of_one_bit_keeps_a_finite_factor() {
        // b₂ differs by one code, fully correlated with b₁: K has rank 1 and the smallest possible c.
        let k = covariance_of(&[[32767, 1], [-32767, 0]]);
        assert_eq!(k.c, 0.25);
        let [d1, d2, d3] = k.factor();
        assert_eq!((d2, d3), (32767.0, 0.5));
        assert_eq!(d1, 0.0);
        // b₁ in only one of many texels, uncorrelated: the opposite limit.
        let k = Covariance { a: 1e6, b: 0.0, c: f64::MIN_POSITIVE };
        assert!(k.factor().iter().all(|d| d.is_finite()));
    }

    #[test]
    fn d2_takes_the_sign_of_the_correlation() {
        let k = covariance_of(&[[100, -50], [-100, 50]]);
        assert_eq!(k.factor(), [0.0, -100.0, 50.0]);
    }

    #[test]
    fn d_of_singular_covariances_reproduces_them_in_every_direction() {
        for degree in 0..360 {
            let (sin, cos) = f64::from(degree).to_radians().sin_cos();
            let b = [(30000.0 * cos) as i16, (30000.0 * sin) as i16];
            let k = covariance_of(&[b, [-b[0], -b[1]], [0, 0]]);
            let [d1, d2, d3] = k.factor();
            let scale = k.a + k.c;
            // √ of a cancelled a − b²/c: its error is √(2⁻⁵²) of the scale in d₁, 2⁻⁵² in d₁².
            for error in [d1 * d1 + d2 * d2 - k.a, d2 * d3 - k.b, d3 * d3 - k.c] {
                assert!(error.abs() <= 8.0 * f64::EPSILON * scale, "{degree}°: {error}");
            }
            assert!((k.largest_deviation() - scale.sqrt()).abs() <= 4.0 * f64::EPSILON * scale.sqrt());
        }
    }

    #[test]
    fn covariance_is_exact_where_float_moments_would_cancel() {
        // 2^26 texels near the top of the range, one of them a code higher: variance (1/n)(1 − 1/n).
        let n = 1_i64 << 26;
        let top = 32766_i64;
        let sums = [top * n + 1, 0, top * top * n + 2 * top + 1, 0, 0];
        let expected = (1.0 / n as f64) * (1.0 - 1.0 / n as f64);
        assert_eq!(Covariance::from_moments(sums, n).a, expected);
    }

    #[test]
    fn exponent_is_the_smallest_that_holds_the_largest_component() {
        let storage = RoughnessStorage::new(RoughnessKind::Anisotropic, 8);
        assert_eq!(storage.smallest_exponent(0.0), -20);
        assert_eq!(storage.smallest_exponent(0.9), 0);
        // 255.4/256 still rounds to code 255, 255.5/256 does not.
        assert_eq!(storage.smallest_exponent(255.4 / 256.0), 0);
        assert_eq!(storage.smallest_exponent(255.5 / 256.0), 1);
        assert_eq!(storage.smallest_exponent(100.0), 3);
        let isotropic = RoughnessStorage::new(RoughnessKind::Isotropic, 8);
        assert_eq!(isotropic.smallest_exponent(255.1 / 256.0), 1);
    }

    #[test]
    fn components_saturate_at_both_ends() {
        let storage = RoughnessStorage::new(RoughnessKind::Anisotropic, 16);
        assert_eq!(storage.quantise([9.0, -9.0, 8.0], 3), [65535, -65535, 65535]);
        assert_eq!(RoughnessStorage::new(RoughnessKind::None, 99).bits(), 16);
        assert_eq!(RoughnessStorage::new(RoughnessKind::None, 0).bits(), 2);
    }

    #[test]
    fn isotropic_codes_are_never_below_the_deviation() {
        let storage = RoughnessStorage::new(RoughnessKind::Isotropic, 4);
        for step in 0..=15 * 64 {
            let deviation = f64::from(step) / 64.0;
            let [code, ..] = storage.quantise([deviation, 0.0, 0.0], 4);
            assert!(f64::from(code) >= deviation && f64::from(code) < deviation + 1.0);
        }
    }
}
