//! Golden vectors that are linked in.

use roughxel_core::plan::{Datapath, Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::precision::{Profile, RoughnessKind};

/// A set of vectors.
#[derive(Debug)]
pub struct Set {
    /// Name of the set.
    pub name: &'static str,
    /// Datapath of the vectors.
    pub datapath: Datapath,
    /// Accuracy of the vectors.
    pub profile: Profile,
    /// Effects that are on.
    pub effects: Effects,
    /// Places of the inputs among the numbers of the datapath's input, in the order of a walk.
    pub inputs: &'static [u16],
    /// Places of the outcomes among the numbers of the output.
    pub outputs: &'static [u16],
    /// Paths of the numbers of the output.
    pub names: &'static [&'static str],
    /// Inputs and outcomes row by row as integers of the ports, 32 bits, least significant byte first.
    pub integers: &'static [u8],
}

impl Set {
    /// Vectors: for each the integers of its inputs, then those of its outcomes.
    pub fn vectors(&self) -> impl Iterator<Item = impl Iterator<Item = i32> + use<>> + use<> {
        let row = 4 * (self.inputs.len() + self.outputs.len());
        self.integers.chunks_exact(row).map(|row| {
            row.chunks_exact(4).map(|bytes| bytes.iter().rfold(0, |integer, byte| integer << 8 | i32::from(*byte)))
        })
    }
}

/// All sets.
pub static SETS: &[Set] = include!(concat!(env!("OUT_DIR"), "/sets.rs"));
