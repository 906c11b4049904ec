//! Instruction sets: chosen at run time, compiled for at compile time.
//!
//! `fearless_simd` holds the proof that the machine has an instruction set and the one call into functions compiled
//! for it, so that nothing here is unsafe. Whatever is inlined into that call is compiled for the instruction set.

use std::fmt::{self, Debug};

#[cfg(target_arch = "x86_64")]
use fearless_simd::{Level, Simd};

/// An instruction set to compile lanes for.
pub trait Target: Copy + Debug + Send + Sync + 'static {
    /// Its vectors count leading zeros.
    const COUNTS_LEADING_ZEROS: bool;

    /// Runs `body`, which is inlined, compiled for the instruction set.
    ///
    /// Panics where the machine does not have it; [`InstructionSet::available`] says what it has.
    fn run<R>(body: impl FnOnce() -> R) -> R;
}

/// What the whole program is compiled for.
#[derive(Clone, Copy, Debug)]
pub struct Baseline;

impl Target for Baseline {
    const COUNTS_LEADING_ZEROS: bool = false;

    #[inline(always)]
    fn run<R>(body: impl FnOnce() -> R) -> R {
        body()
    }
}

#[cfg(target_arch = "x86_64")]
macro_rules! x86_64 {
    ($(#[$doc:meta])* $name:ident, $proof:ident, $counts_leading_zeros:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name;

        impl Target for $name {
            const COUNTS_LEADING_ZEROS: bool = $counts_leading_zeros;

            #[inline(always)]
            fn run<R>(body: impl FnOnce() -> R) -> R {
                // Not a second call of the body for a machine without: it would be compiled twice.
                let Some(proof) = Level::new().$proof() else { unreachable!("the machine has the instruction set") };
                proof.vectorize(#[inline(always)] || body())
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
x86_64!(
    /// x86-64-v3: vectors of 256 bits.
    Avx2, as_avx2, false
);
#[cfg(target_arch = "x86_64")]
x86_64!(
    /// AVX-512 of Ice Lake and later: vectors of 512 bits, masks, leading zeros.
    Avx512, as_avx512, true
);

/// An instruction set to run lanes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// What the program is compiled for.
    Baseline,
    /// x86-64-v3, with vectors of 256 bits.
    Avx2,
    /// AVX-512 as of Ice Lake.
    Avx512,
}

impl InstructionSet {
    /// Every instruction set, narrowest first.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// Whether this machine has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Level::new().as_avx2().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Level::new().as_avx512().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// Those this machine has, narrowest first.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|set| set.is_available())
    }

    /// The widest this machine has.
    pub fn best() -> Self {
        Self::available().last().unwrap_or(Self::Baseline)
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        })
    }
}
