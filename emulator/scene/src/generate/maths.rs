//! Arithmetic of the generators: only +, −, ×, ÷, √ and rounding, which IEEE 754 fixes to the last bit, so a generated
//! map is the same on every machine. (The sine and cosine of a platform's library are not.)

use crate::random::SplitMix64;
use std::f64::consts::TAU;

/// Sine of `turns` full turns; absolute error below 1e-13 for |turns| < 1000, exact at whole quarter turns.
///
/// Taylor polynomials on [−π/4, π/4]: the remainders are (π/4)¹⁷/17! = 4.6e-17 and (π/4)¹⁸/18! = 2e-18; what is left
/// is the rounding of `turns`.
pub(crate) fn sin_turns(turns: f64) -> f64 {
    let wrapped = turns - (turns + 0.5).floor();
    let folded = if wrapped.abs() > 0.25 { 0.5_f64.copysign(wrapped) - wrapped } else { wrapped };
    if folded.abs() <= 0.125 {
        let x = TAU * folded;
        x * alternating_series(x * x, 2)
    } else {
        let x = TAU * (0.25 - folded.abs());
        alternating_series(x * x, 1).copysign(folded)
    }
}

/// 1 − s/(f(f+1)) + s²/(f(f+1)(f+2)(f+3)) − … with eight terms: sin(x)/x for f = 2, cos(x) for f = 1, s = x².
fn alternating_series(square: f64, first: u32) -> f64 {
    (0..8).rev().fold(1.0, |sum, term| {
        let factor = f64::from(first + 2 * term);
        1.0 - square / (factor * (factor + 1.0)) * sum
    })
}

/// Cosine of `turns` full turns; error as [`sin_turns`].
pub(crate) fn cos_turns(turns: f64) -> f64 {
    sin_turns(turns + 0.25)
}

/// 0 below `from`, 1 above `to`, with a smooth cubic between.
pub(crate) fn smoothstep(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// `a` at 0, `b` at 1.
pub(crate) fn mix(a: [f32; 3], b: [f32; 3], t: f64) -> [f32; 3] {
    let t = t as f32;
    std::array::from_fn(|channel| a[channel] + (b[channel] - a[channel]) * t)
}

/// Unit vector along `v`; +z for the zero vector.
pub(crate) fn normalised(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    if length > 0.0 { v.map(|x| x / length) } else { [0.0, 0.0, 1.0] }
}

/// Inner product.
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A 64-bit mix of three lattice coordinates and a seed: one step of SplitMix64 for each.
pub(crate) fn hash(seed: u64, x: i64, y: i64, z: i64) -> u64 {
    [x, y, z].into_iter().fold(seed ^ 0x9E37_79B9_7F4A_7C15, |state, coordinate| {
        SplitMix64::new(state.wrapping_add(coordinate as u64)).next_u64()
    })
}

/// The top 53 bits as a number in [0, 1).
pub(crate) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// Random numbers in the shapes that maps need.
#[derive(Clone, Debug)]
pub(crate) struct Random(SplitMix64);

impl Random {
    /// The sequence of `seed`.
    pub(crate) fn new(seed: u32) -> Self {
        Self(SplitMix64::new(u64::from(seed)))
    }

    /// Uniform in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        unit(self.0.next_u64())
    }

    /// Bell-shaped in (−1, 1): the mean of three uniform numbers, standard deviation 1/3.
    pub(crate) fn bell(&mut self) -> f64 {
        (self.unit() + self.unit() + self.unit()) * (2.0 / 3.0) - 1.0
    }
}

/// Smooth noise in [−1, 1] on the integer lattice: trilinear with a quintic ease; repeats after `period` cells in each
/// coordinate (0: never).
pub(crate) fn lattice_noise(seed: u64, at: [f64; 3], period: [i64; 3]) -> f64 {
    let cell = at.map(|x| x.floor() as i64);
    let ease: [f64; 3] = std::array::from_fn(|axis| {
        let t = at[axis] - at[axis].floor();
        t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
    });
    let wrap = |axis: usize, step: i64| match period[axis] {
        0 => cell[axis] + step,
        period => (cell[axis] + step).rem_euclid(period),
    };
    let mut sum = 0.0;
    for corner in 0..8i64 {
        let step = [corner & 1, (corner >> 1) & 1, corner >> 2];
        let weight: f64 = (0..3).map(|axis| if step[axis] == 1 { ease[axis] } else { 1.0 - ease[axis] }).product();
        sum += weight * unit(hash(seed, wrap(0, step[0]), wrap(1, step[1]), wrap(2, step[2])));
    }
    2.0 * sum - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_agree_with_the_library() {
        for step in -4000..4000 {
            let turns = f64::from(step) / 977.0;
            // Bound of the polynomial; the library's own error is a thousandth of it.
            assert!((sin_turns(turns) - (TAU * turns).sin()).abs() < 1e-13, "{turns}");
            assert!((cos_turns(turns) - (TAU * turns).cos()).abs() < 1e-13, "{turns}");
        }
    }

    #[test]
    fn whole_quarter_turns_are_exact() {
        for whole in [-3.0, 0.0, 7.0] {
            let quarters = [0.0, 0.25, 0.5, 0.75].map(|quarter| sin_turns(whole + quarter));
            assert_eq!(quarters, [0.0, 1.0, 0.0, -1.0]);
            assert_eq!(cos_turns(whole), 1.0);
        }
    }

    #[test]
    fn lattice_noise_repeats_after_its_period() {
        let at = [0.3, 1.7, 2.2];
        let here = lattice_noise(5, at, [4, 3, 0]);
        // The only difference is the rounding of the shifted coordinate.
        assert!((here - lattice_noise(5, [4.3, 1.7, 2.2], [4, 3, 0])).abs() < 1e-12);
        assert!((here - lattice_noise(5, [0.3, -1.3, 2.2], [4, 3, 0])).abs() < 1e-12);
        assert!(here.abs() <= 1.0);
    }
}
