//! Start and end of a stage of the datapath.

use crate::bundle::Bundle;
use crate::word::Word;

/// A word whose backend runs the datapath stage by stage.
pub trait Staged: Word {
    /// Runs one stage of the datapath. A backend may compile, name or record the stage on its own.
    #[inline(always)]
    fn stage<B: Bundle<Self>>(_name: &'static str, body: impl Fn() -> B + Copy) -> B {
        body()
    }
}

/// `stage!("name", expression)`: one stage as a separate function on the backend of `W`, whatever the optimiser makes of its size.
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

/// `control_stage!("name", expression)`: a stage whose outcome is one control number.
#[macro_export]
macro_rules! control_stage {
    ($name:literal, $stage:expr) => {
        $crate::stage!($name, $crate::bundle::Value($stage)).0
    };
}
pub use crate::control_stage;
