//! Where a stage of the datapath begins and ends.

use crate::bundle::Bundle;
use crate::word::Word;

/// A word whose reading runs the datapath stage by stage.
pub trait Staged: Word {
    /// Runs one stage of the datapath, which a reading may compile, name or record on its own.
    #[inline(always)]
    fn stage<B: Bundle<Self>>(_name: &'static str, body: impl Fn() -> B + Copy) -> B {
        body()
    }
}

/// `stage!("name", expression)`: one stage as a function of its own in the reading of `W`, whatever the optimiser thinks of its size.
#[macro_export]
macro_rules! stage {
    ($name:literal, $stage:expr) => {
        W::stage(
            $name,
            #[inline(always)]
            || $stage,
        )
    };
}
pub use crate::stage;

/// The same for a stage whose outcome is one number that controls.
#[macro_export]
macro_rules! control_stage {
    ($name:literal, $stage:expr) => {
        $crate::stage!($name, $crate::bundle::Value($stage)).0
    };
}
pub use crate::control_stage;
