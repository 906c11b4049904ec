//! Arithmetic of the generators: only +, −, ×, ÷, √ and rounding. IEEE 754 fixes them to the last bit, so a generated
//! map is equal on every machine. (The sine and cosine of a platform's library are not.)

use roughxel_utilities::random::SplitMix64;
use std::f64::consts::TAU;

/// Sine of `turns` full turns; absolute error below 1e-13 for |turns| < 1000, exact at whole quarter turns.
///
/// Taylor polynomials on [−π/4, π/4] have the remainders (π/4)¹⁷/17! = 4.6e-17 and (π/4)¹⁸/18! = 2e-18. The rest of the
/// error is the rounding of `turns`.
#[inline(always)]
pub(crate) fn sin_turns(turns: f64) -> f64 {
    let wrapped = turns - (turns + 0.5).floor();
    let folded = if wrapped.abs() > 0.25 { 0.5_f64.copysign(wrapped) - wrapped } else { wrapped };
    // Near whole turns the sine is evaluated, elsewhere the cosine of the rest of a quarter. Values are selected without branches, so that
    // loops vectorise.
    let is_near = folded.abs() <= 0.125;
    let x = TAU * if is_near { folded } else { 0.25 - folded.abs() };
    let square = x * x;
    let series = (0..8).rev().fold(1.0, |sum, term| {
        let [sine, cosine] = [SINE, COSINE].map(|series| series[term]);
        1.0 - square * if is_near { sine } else { cosine } * sum
    });
    if is_near { x * series } else { series.copysign(folded) }
}

/// Factors of sin(x)/x = 1 − s/(2·3)·(1 − s/(4·5)·(1 − …)), s = x².
const SINE: [f64; 8] = factors(2);

/// Factors of cos(x) = 1 − s/(1·2)·(1 − s/(3·4)·(1 − …)), s = x².
const COSINE: [f64; 8] = factors(1);

/// 1/(f(f + 1)), 1/((f + 2)(f + 3)) and so on.
const fn factors(first: u32) -> [f64; 8] {
    let mut factors = [0.0; 8];
    let mut term = 0;
    while term < factors.len() {
        let factor = first + 2 * term as u32;
        factors[term] = 1.0 / (factor * (factor + 1)) as f64;
        term += 1;
    }
    factors
}

/// Cosine of `turns` full turns; error as [`sin_turns`].
#[inline(always)]
pub(crate) fn cos_turns(turns: f64) -> f64 {
    sin_turns(turns + 0.25)
}

/// 0 below `from`, 1 above `to`, with a smooth cubic between.
#[inline(always)]
pub(crate) fn smoothstep(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// `a` at 0, `b` at 1.
#[inline(always)]
pub(crate) fn mix(a: [f32; 3], b: [f32; 3], t: f64) -> [f32; 3] {
    let t = t as f32;
    std::array::from_fn(|channel| a[channel] + (b[channel] - a[channel]) * t)
}

/// Unit vector along `v`; +z for the zero vector.
#[inline(always)]
pub(crate) fn normalised(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    if length > 0.0 { v.map(|x| x / length) } else { [0.0, 0.0, 1.0] }
}

/// Inner product.
#[inline(always)]
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Multiplier of the seed of a [`hash`].
const SEED: u64 = 0x9E37_79B9_7F4A_7C15;

/// A 64-bit mix of three lattice coordinates and a seed: one step of SplitMix64 for each.
#[inline(always)]
pub(crate) fn hash(seed: u64, x: i64, y: i64, z: i64) -> u64 {
    [x, y, z].into_iter().fold(seed ^ SEED, mixed)
}

/// Mixes one more coordinate into a [`hash`].
#[inline(always)]
fn mixed(state: u64, coordinate: i64) -> u64 {
    SplitMix64::new(state.wrapping_add(coordinate as u64)).next_u64()
}

/// The top 53 bits as a number in [0, 1).
#[inline(always)]
pub(crate) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// Random numbers in the shapes that maps use.
#[derive(Clone, Debug)]
pub(crate) struct Random(SplitMix64);

impl Random {
    /// The sequence of `seed`.
    pub(crate) fn new(seed: u32) -> Self {
        Self(SplitMix64::new(u64::from(seed)))
    }

    /// Uniform in [0, 1).
    #[inline(always)]
    pub(crate) fn unit(&mut self) -> f64 {
        unit(self.0.next_u64())
    }

    /// Bell-shaped in (−1, 1): the mean of three uniform numbers, standard deviation 1/3.
    pub(crate) fn bell(&mut self) -> f64 {
        (self.unit() + self.unit() + self.unit()) * (2.0 / 3.0) - 1.0
    }
}

/// Smooth noise in [−1, 1] on the integer lattice: trilinear with a quintic ease. It repeats after `period` cells in
/// each coordinate (0: never).
#[inline(always)]
pub(crate) fn lattice_noise(seed: u64, at: [f64; 3], period: [i64; 3]) -> f64 {
    let floor = at.map(f64::floor);
    let cell = floor.map(|x| x as i64);
    let ease: [f64; 3] = std::array::from_fn(|axis| {
        let t = at[axis] - floor[axis];
        t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
    });
    let wrap = |axis: usize, step: i64| match period[axis] {
        0 => cell[axis] + step,
        period => (cell[axis] + step).rem_euclid(period),
    };
    let ends: [[i64; 2]; 3] = std::array::from_fn(|axis| [wrap(axis, 0), wrap(axis, 1)]);
    // Corners share the beginning of their hashes: 14 steps, not 24. The bits of a corner's number are its ends in x, y and z.
    let (mut of_x, mut of_y, mut of_z) = ([0; 2], [0; 4], [0; 8]);
    for (corner, hash) in of_x.iter_mut().enumerate() {
        *hash = mixed(seed ^ SEED, ends[0][corner]);
    }
    for (corner, hash) in of_y.iter_mut().enumerate() {
        *hash = mixed(of_x[corner & 1], ends[1][corner >> 1]);
    }
    for (corner, hash) in of_z.iter_mut().enumerate() {
        *hash = mixed(of_y[corner & 3], ends[2][corner >> 2]);
    }
    let mut sum = 0.0;
    for (corner, hash) in of_z.into_iter().enumerate() {
        let side = |axis: usize| if corner >> axis & 1 == 1 { ease[axis] } else { 1.0 - ease[axis] };
        sum += side(0) * side(1) * side(2) * unit(hash);
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
            // Bound of the polynomial; the library's error is a thousandth of it.
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
    fn corners_of_lattice_noise_have_the_hashes_of_their_coordinates() {
        let mut random = SplitMix64::new(2);
        for _ in 0..1000 {
            let at = [(); 3].map(|()| random.uniform(-9.0, 9.0));
            let cell = at.map(|x| x.floor() as i64);
            let ease = [0, 1, 2].map(|axis| {
                let t: f64 = at[axis] - at[axis].floor();
                t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
            });
            let mut sum = 0.0;
            for (z, y, x) in (0..2).flat_map(|z| (0..2).flat_map(move |y| (0..2).map(move |x| (z, y, x)))) {
                let side = |axis: usize, end: i64| if end == 1 { ease[axis] } else { 1.0 - ease[axis] };
                sum += side(0, x) * side(1, y) * side(2, z) * unit(hash(5, cell[0] + x, cell[1] + y, cell[2] + z));
            }
            assert_eq!(lattice_noise(5, at, [0; 3]), 2.0 * sum - 1.0, "{at:?}");
        }
    }

    #[test]
    fn lattice_noise_repeats_after_its_period() {
        let at = [0.3, 1.7, 2.2];
        let here = lattice_noise(5, at, [4, 3, 0]);
        // Only the rounding of the shifted coordinate differs.
        assert!((here - lattice_noise(5, [4.3, 1.7, 2.2], [4, 3, 0])).abs() < 1e-12);
        assert!((here - lattice_noise(5, [0.3, -1.3, 2.2], [4, 3, 0])).abs() < 1e-12);
        assert!(here.abs() <= 1.0);
    }
}
