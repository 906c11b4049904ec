//! Loops over numbers side by side, as vectors of the machine they run on.
//!
//! The compiler makes vectors of loops over arrays whose elements all go the same way. Of +, −, ×, ÷, √, rounding and comparisons the bits are those of
//! one number after the other, with every instruction set.

use fearless_simd::{Level, Simd, dispatch};

/// Numbers side by side: two of the widest vectors.
pub const WIDTH: usize = 16;

/// Runs `body`, and all that is inlined into it, compiled for the widest instruction set of the machine.
#[inline(always)]
pub fn widest<R>(body: impl FnOnce() -> R) -> R {
    dispatch!(Level::new(), simd => simd.vectorize(body))
}

#[cfg(test)]
mod tests {
    use super::*;
    use roughxel_utilities::random::SplitMix64;

    /// Every operation that loops here are made of.
    #[inline(always)]
    fn mixture(x: f64) -> f64 {
        let folded = if x.abs() > 2.0 { 0.5_f64.copysign(x) - x } else { x };
        let quotient = (1.7 * folded + 0.3) / (folded * folded + 0.1);
        (quotient.abs().sqrt() + x.floor()).max(-3.5).min(quotient) * f64::from(x as f32)
    }

    #[test]
    fn the_bits_are_those_of_one_number_after_the_other() {
        let mut random = SplitMix64::new(1);
        for _ in 0..1000 {
            let numbers: [f64; WIDTH] = std::array::from_fn(|_| random.uniform(-4.0, 4.0));
            let together = widest(
                #[inline(always)]
                || {
                    let mut of = [0.0; WIDTH];
                    for lane in 0..WIDTH {
                        of[lane] = mixture(numbers[lane]);
                    }
                    of
                },
            );
            let alone = numbers.map(|number| mixture(std::hint::black_box(number)));
            assert_eq!(together.map(f64::to_bits), alone.map(f64::to_bits), "{numbers:?}");
        }
    }
}
