//! The datapaths that vectors are of, as functions from integers of ports to integers of outputs, in the scalar reading.

use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::{self, HighlightIn, PeakIn, ReflectionIn};
use roughxel_core::precision::Precision;

use crate::net::record::{filled, integers};

/// The integers of all ports of a datapath's design, in the order of its bundle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inputs(pub(super) Vec<i64>);

impl From<&ReflectionIn> for Inputs {
    fn from(fragment: &ReflectionIn) -> Self {
        Self(integers(&fragment.fragment()))
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
            let input = filled(&ReflectionIn::default().fragment(), inputs);
            integers(&ports::fragment(&input, &effects.reflection(), p))
        }
        Datapath::Highlight => {
            let input = filled(&HighlightIn::default().wires(), inputs);
            integers(&ports::highlight(&input, &effects.highlight(), p))
        }
        Datapath::Peak => {
            let input = filled(&PeakIn::default().wires(), inputs);
            integers(&ports::lit_peak(&input, &effects.peak(), p))
        }
    }
}
