//! Instruction sets: chosen at run time, compiled for at compile time.
//!
//! `fearless_simd` holds the proof that the machine has an instruction set, and the one call into functions compiled for it, so nothing here is
//! unsafe. All code that is inlined into that call is compiled for the instruction set.

use std::fmt;

#[cfg(target_arch = "x86_64")]
use fearless_simd::Level;

use super::vectors::Vectors;

/// An instruction set to compile lanes for.
pub trait Target: Vectors {
    /// Runs `body`, which is inlined, compiled for the instruction set.
    ///
    /// Panics if the machine does not have it; [`InstructionSet::is_available`] tells.
    fn run<R>(body: impl FnOnce() -> R) -> R;
}

/// An instruction set to run lanes with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// x86-64-v3, with 256-bit vectors.
    Avx2,
    /// AVX-512 as of Ice Lake.
    Avx512,
}

impl InstructionSet {
    /// Every instruction set, narrowest first.
    pub const ALL: [Self; 2] = [Self::Avx2, Self::Avx512];

    /// Returns true if this machine has it.
    pub fn is_available(self) -> bool {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Level::new().as_avx2().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Level::new().as_avx512().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// Instruction sets of this machine, narrowest first.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|set| set.is_available())
    }

    /// Widest instruction set of this machine.
    pub fn best() -> Option<Self> {
        Self::available().last()
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        })
    }
}
