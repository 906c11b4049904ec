//! Backends: the words that a pass runs on. The bits are the same for all; the time differs.

use std::fmt;
use std::str::FromStr;

use roughxel_core::precision::Precision;

use super::group::BatchWord;
#[cfg(target_arch = "x86_64")]
use super::narrow::{KEPT, NarrowLanes};
use super::target::InstructionSet;
#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512, Lanes, Target};

/// A way to compute a pass for many fragments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// One fragment after the other.
    Scalar,
    /// A group of fragments at a time, with an instruction set of this machine.
    Simd(InstructionSet),
}

/// A computation on words of any backend.
pub trait Kernel {
    /// Result of the computation.
    type Outcome;
    /// Computes it on words `W`.
    fn run<W: BatchWord>(self) -> Self::Outcome;
}

impl Backend {
    /// Fastest backend on this machine.
    pub fn best() -> Self {
        InstructionSet::best().map_or(Self::Scalar, Self::Simd)
    }

    /// Runs a kernel on words of the profile's width. Profiles of 12 and 13 kept bits, of which none is named, have no vectors; the scalar backend
    /// runs them.
    pub fn dispatch<K: Kernel>(self, p: &Precision, kernel: K) -> K::Outcome {
        if p.word_bits() != 16 {
            return self.dispatch_words(kernel);
        }
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Simd(InstructionSet::Avx2) if p.fraction_bits == KEPT => kernel.run::<NarrowLanes<Avx2>>(),
            #[cfg(target_arch = "x86_64")]
            Self::Simd(InstructionSet::Avx512) if p.fraction_bits == KEPT => kernel.run::<NarrowLanes<Avx512>>(),
            _ => kernel.run::<i16>(),
        }
    }

    /// Runs a kernel on 32-bit words.
    pub fn dispatch_words<K: Kernel>(self, kernel: K) -> K::Outcome {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Simd(InstructionSet::Avx2) => kernel.run::<Lanes<Avx2>>(),
            #[cfg(target_arch = "x86_64")]
            Self::Simd(InstructionSet::Avx512) => kernel.run::<Lanes<Avx512>>(),
            _ => kernel.run::<i32>(),
        }
    }

    /// Number of fragments in a group.
    pub fn group(self, p: &Precision) -> usize {
        /// Counts the fragments of a group.
        struct Fragments;
        impl Kernel for Fragments {
            type Outcome = usize;
            fn run<W: BatchWord>(self) -> usize {
                W::FRAGMENTS
            }
        }
        self.dispatch(p, Fragments)
    }

    /// Runs `body`, compiled for the instruction set if it is inlined. The compiler makes vectors of its loops over arrays whose elements all take
    /// the same path. The bits of +, −, ×, ÷, √, rounding and comparisons are those of one number after the other.
    #[inline(always)]
    pub fn run<R>(self, body: impl FnOnce() -> R) -> R {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Simd(InstructionSet::Avx2) => Avx2::run(body),
            #[cfg(target_arch = "x86_64")]
            Self::Simd(InstructionSet::Avx512) => Avx512::run(body),
            _ => body(),
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scalar => f.write_str("scalar"),
            Self::Simd(set) => write!(f, "{set}"),
        }
    }
}

impl FromStr for Backend {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let simd = InstructionSet::available().map(Self::Simd);
        let backends: Vec<Self> = std::iter::once(Self::Scalar).chain(simd).collect();
        backends.iter().copied().find(|backend| backend.to_string() == text).ok_or_else(|| {
            let names: Vec<String> = backends.iter().map(Self::to_string).collect();
            format!("'{text}' is no backend of this machine: use {}", names.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LANES;

    /// Mixture of all operations that such loops use here.
    #[inline(always)]
    fn mixture(x: f64) -> f64 {
        let folded = if x.abs() > 2.0 { 0.5_f64.copysign(x) - x } else { x };
        let quotient = (1.7 * folded + 0.3) / (folded * folded + 0.1);
        (quotient.abs().sqrt() + x.floor()).max(-3.5).min(quotient) * f64::from(x as f32)
    }

    #[test]
    fn the_bits_are_those_of_one_number_after_the_other() {
        let mut state = 1_u64;
        // In [−4, 4).
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 50) as f64 - 4.0
        };
        for _ in 0..1000 {
            let numbers: [f64; LANES] = std::array::from_fn(|_| random());
            let together = Backend::best().run(
                #[inline(always)]
                || {
                    let mut of = [0.0; LANES];
                    for lane in 0..LANES {
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
