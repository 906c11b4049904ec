//! Bounds on accumulated rounding, from the text of the elementary functions: half a place for each rounding, a place for each floor, and the error
//! of a seed, squared with every Newton step.

use std::f64::consts::LOG2_E;

use roughxel_core::block::{MANTISSA, PRODUCT};
use roughxel_core::elementary::LOGARITHM;
use roughxel_core::precision::{Newton, Precision};
use roughxel_core::rom::LOG_BITS;

/// Bounds of a precision on words whose mantissas have `fraction` fraction bits.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    p: Precision,
    fraction: u32,
}

impl Bounds {
    pub(crate) fn new(p: Precision, fraction: u32) -> Self {
        Self { p, fraction }
    }

    /// Half a place of the p kept bits.
    pub(crate) fn half_place(&self) -> f64 {
        (-f64::from(self.p.fraction_bits) - 1.0).exp2()
    }

    /// One place of a product of two mantissas.
    pub(crate) fn product_place(&self) -> f64 {
        (-2.0 * f64::from(self.fraction)).exp2()
    }

    /// The roundings of a seed of `bits` index bits: that of the table, which has two more bits, and that of a word with fewer bits.
    fn seed_rounding(&self, bits: u32) -> f64 {
        let table = (-f64::from(bits) - 3.0).exp2();
        if self.fraction < bits + 2 { table + (-f64::from(self.fraction) - 1.0).exp2() } else { table }
    }

    /// Scales of the residual, one for each Newton step.
    fn scales(&self, newton: Newton) -> impl Iterator<Item = f64> + use<> {
        let most = self.fraction - 2;
        let scales = std::iter::successors(Some(newton.seed_bits - 3), move |scale| Some((2 * scale).min(most)));
        scales.take(newton.steps as usize).map(|scale| f64::from(scale).exp2())
    }

    /// Absolute error of 1/(2x) at x in [½, 1].
    ///
    /// Seed: half an interval, 2^−(k+2), times the steepest slope on the way to its middle, 1/(2x²). A step leaves 2x·e² and rounds the residual,
    /// the correction (a floor) and the result.
    pub(crate) fn half_reciprocal(&self, x: f64) -> f64 {
        let newton = self.p.reciprocal;
        let half_interval = (-f64::from(newton.seed_bits) - 2.0).exp2();
        let steepest = (x - half_interval).max(0.5);
        let mut error = half_interval / (2.0 * steepest * steepest) + self.seed_rounding(newton.seed_bits);
        for scale in self.scales(newton) {
            let residual = self.half_place() / scale * (0.5 / x + error);
            error = 2.0 * x * error * error + residual + self.product_place() + self.half_place();
        }
        error
    }

    /// Absolute error of 1/(2√x) at x in [¼, 1].
    ///
    /// As above with half an interval of 2^−(k+1) and the slope 1/(4x√x). A step leaves y·(1.5δ² + ½δ³) of a relative error δ, and half of y times
    /// the error of 1 − 4x·y², whose y² is also rounded.
    pub(crate) fn half_inverse_root(&self, x: f64) -> f64 {
        let newton = self.p.inverse_root;
        let y = 0.5 / x.sqrt();
        let half_interval = (-f64::from(newton.seed_bits) - 1.0).exp2();
        let steepest = (x - half_interval).max(0.25);
        let mut error = half_interval / (4.0 * steepest * steepest.sqrt()) + self.seed_rounding(newton.seed_bits);
        for scale in self.scales(newton) {
            let delta = error / y;
            let residual = self.half_place() * (4.0 * x + 1.0 / scale) * (y + error) / 2.0;
            let newton = y * delta * delta * (1.5 + 0.5 * delta);
            error = newton + residual + self.product_place() + self.half_place();
        }
        error
    }

    /// Relative error of 1/√ of a number with mantissa m in [½, 1]. If its exponent is odd, half of m is rounded first.
    pub(crate) fn inverse_root(&self, m: f64, odd: bool) -> f64 {
        let (x, rounding) = if odd { (m / 2.0, self.half_place()) } else { (m, 0.0) };
        let from = (x - rounding).max(0.25);
        // x is off by a share of rounding/x, so its root by half of that, a little more downwards.
        let moved = (1.0 - rounding / x).powf(-0.5) - 1.0;
        (1.0 + moved) * (1.0 + self.half_inverse_root(from) * 2.0 * from.sqrt()) - 1.0
    }

    /// Relative error of √ of a number: times the number, rounded to a mantissa of at least ½.
    pub(crate) fn root(&self, m: f64, odd: bool) -> f64 {
        (1.0 + self.inverse_root(m, odd)) * (1.0 + 2.0 * self.half_place()) - 1.0
    }

    /// Largest relative errors of [`Self::inverse_root`] and [`Self::root`] over all numbers: both decrease with the mantissa.
    pub(crate) fn worst_roots(&self) -> [f64; 2] {
        let all = |bound: fn(&Self, f64, bool) -> f64| {
            let steps = (512..=1024).flat_map(|m| [(m, false), (m, true)]);
            steps.map(|(m, odd)| bound(self, f64::from(m) / 1024.0, odd)).fold(0.0, f64::max)
        };
        [all(Self::inverse_root), all(Self::root)]
    }

    /// Half a place of a word with `int` bits before its point.
    fn half_place_of(&self, int: u32) -> f64 {
        let bits = self.fraction + MANTISSA;
        (f64::from(int) - f64::from(bits) - 1.0).exp2()
    }

    /// A last place of a wide wire with `int` bits before its point.
    fn wide_place_of(&self, int: u32) -> f64 {
        let bits = 2 * (self.fraction + MANTISSA);
        (f64::from(int) - f64::from(bits)).exp2()
    }

    /// Absolute error of log₂ of a mantissa: a knot, a rise and their product floored to a wide wire, the rounding of the result, and, if there are
    /// bits between knots, the line between them.
    pub(crate) fn log2(&self) -> f64 {
        let line = if self.fraction > LOG_BITS { (-18.4_f64).exp2() } else { 0.0 };
        3.0 * self.wide_place_of(LOGARITHM + MANTISSA) + line + (-25.0_f64).exp2()
    }

    /// Error of 2^x relative to mantissas of at least ½: the rounding of the result, plus the line between knots that rise by less than 2^−8, the
    /// rounded share of x, and the rise on a word, floored.
    pub(crate) fn exp2(&self) -> f64 {
        let share = (-8.0_f64).exp2() * (self.half_place() + self.half_place_of(MANTISSA));
        2.0 * (self.half_place() + (-20.0_f64).exp2() + share + 2.0 * self.wide_place_of(PRODUCT))
    }

    /// Relative error of a tabulated ratio of at least `least`, at the steepest `slope` of the ratio. The terms are:
    ///
    /// - a knot, a rise and their product floored to a wire with 8 bits before the point,
    /// - the line between knots,
    /// - the rounded share of the argument in its interval, which rises by less than 2^−9,
    /// - the argument itself floored to a word,
    /// - the rounding of the result.
    fn ratio(&self, least: f64, slope: f64) -> f64 {
        let floored = slope * 2.0 * self.half_place_of(MANTISSA);
        let line = (-19.8_f64).exp2() + (-9.0_f64).exp2() * self.half_place();
        (3.0 * self.wide_place_of(6 + MANTISSA) + line + floored + self.half_place()) / least
    }

    /// Relative error of log₂(1 + x): below 1 the ratio times x; from 1 up, where the logarithm is at least 1, a rounded sum and its logarithm.
    pub(crate) fn log2_one_plus(&self, below_one: bool) -> f64 {
        let rounding = 1.0 + 2.0 * self.half_place();
        let before = if below_one {
            self.ratio(0.5, 0.361)
        } else {
            LOG2_E * (4.0 * self.half_place_of(MANTISSA)) + self.log2()
        };
        (1.0 + before) * rounding - 1.0
    }

    /// Relative error of −log₂(1 − y): y times the ratio, or, if it is at least 1, the logarithm of 1 − y rounded.
    pub(crate) fn minus_log2_one_minus(&self, below_half: bool) -> f64 {
        let rounding = 1.0 + 2.0 * self.half_place();
        if below_half {
            (1.0 + self.ratio(0.7213, 0.886)) * rounding * rounding - 1.0
        } else {
            // A logarithm is steeper for downward errors.
            let rest = -(1.0 - 2.0 * self.half_place()).log2();
            // The value is 12 bits above the point of a product, floored.
            let floored = self.wide_place_of(PRODUCT + 12);
            (1.0 + rest + self.log2() + floored) * rounding - 1.0
        }
    }
}
