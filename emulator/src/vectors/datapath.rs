//! The datapaths that vectors are of, as functions from integers of ports to integers of outputs, in the scalar reading.

use roughxel_core::bundle::{Bundle, End};
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::{HighlightIn, HighlightInput, PeakIn, PeakInput, Port, ReflectionIn, ReflectionInput};
use roughxel_core::precision::Precision;
use roughxel_core::soft_core;

use crate::net::record::{filled, integers};

/// The integers of all ports of a datapath's design, in the order of its bundle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inputs(pub(super) Vec<i64>);

impl From<&ReflectionIn> for Inputs {
    fn from(fragment: &ReflectionIn) -> Self {
        Self(integers(&fragment.wires()))
    }
}

impl From<&HighlightIn> for Inputs {
    fn from(light: &HighlightIn) -> Self {
        Self(integers(&light.wires()))
    }
}

impl From<&PeakIn> for Inputs {
    fn from(peak: &PeakIn) -> Self {
        Self(integers(&peak.wires()))
    }
}

/// What a datapath makes of its ports: the integers of all outputs of its design.
pub(super) fn outcome(datapath: Datapath, inputs: &[i64], effects: &Effects, p: &Precision) -> Vec<i64> {
    match datapath {
        Datapath::Reflection => {
            integers(&soft_core::fragment(&wires::<ReflectionInput<i32>>(inputs), &effects.reflection(), p))
        }
        Datapath::Highlight => {
            integers(&soft_core::highlight(&wires::<HighlightInput<i32>>(inputs), &effects.highlight(), p))
        }
        Datapath::Peak => integers(&soft_core::lit_peak(&wires::<PeakInput<i32>>(inputs), &effects.peak(), p)),
    }
}

/// The bundle with these integers on its wires.
pub(super) fn wires<B: Bundle<i32, In<i32> = B>>(inputs: &[i64]) -> B {
    filled(&B::limit::<i32>(End::Low), inputs)
}
