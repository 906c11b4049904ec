//! The datapaths that vectors are of, as functions from the wires of ports to integers of outputs: of one vector in the scalar reading,
//! which `verify` and `explain` recompute with, of many side by side, which an export is made with.

use roughxel_core::bundle::{Bundle, End};
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::{
    HighlightIn, HighlightInput, HighlightOutput, PeakIn, PeakInput, PeakOutput, Port, ReflectionIn, ReflectionInput,
    ReflectionOutput,
};
use roughxel_core::precision::Precision;
use roughxel_core::soft_core;

use crate::lanes::{Columns, Reading};
use crate::net::record::{filled, integers, integers_at};

/// The wires of all ports of a datapath's design.
#[derive(Clone, Copy, Debug)]
pub enum Inputs {
    /// Of a fragment that reflects.
    Reflection(ReflectionInput<i32>),
    /// Of a light on a surface.
    Highlight(HighlightInput<i32>),
    /// Of a light on a peak.
    Peak(PeakInput<i32>),
}

impl Inputs {
    /// Those with these integers on their wires.
    pub(super) fn of(datapath: Datapath, integers: &[i64]) -> Self {
        match datapath {
            Datapath::Reflection => Self::Reflection(wires(integers)),
            Datapath::Highlight => Self::Highlight(wires(integers)),
            Datapath::Peak => Self::Peak(wires(integers)),
        }
    }

    /// The integers on the ports of the recorded design, on words of the profile's width.
    pub(super) fn recorded(&self, p: &Precision) -> Vec<i64> {
        match self {
            Self::Reflection(wires) => integers_at(wires, p),
            Self::Highlight(wires) => integers_at(wires, p),
            Self::Peak(wires) => integers_at(wires, p),
        }
    }

    /// The integers on them.
    pub(super) fn integers(&self) -> Vec<i64> {
        match self {
            Self::Reflection(wires) => integers(wires),
            Self::Highlight(wires) => integers(wires),
            Self::Peak(wires) => integers(wires),
        }
    }
}

impl From<&ReflectionIn> for Inputs {
    fn from(fragment: &ReflectionIn) -> Self {
        Self::Reflection(fragment.wires())
    }
}

impl From<&HighlightIn> for Inputs {
    fn from(light: &HighlightIn) -> Self {
        Self::Highlight(light.wires())
    }
}

impl From<&PeakIn> for Inputs {
    fn from(peak: &PeakIn) -> Self {
        Self::Peak(peak.wires())
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

/// Vectors of one datapath, a row a wire. No wire of the three is wide, so the word of a row is the place of its port or output.
pub(super) enum Batch {
    Reflection(Columns<ReflectionInput<i32>>, Columns<ReflectionOutput<i32>>),
    Highlight(Columns<HighlightInput<i32>>, Columns<HighlightOutput<i32>>),
    Peak(Columns<PeakInput<i32>>, Columns<PeakOutput<i32>>),
}

impl Batch {
    /// Those inputs through their datapath, by the fastest reading of this machine.
    ///
    /// # Panics
    /// If an input is of another datapath.
    pub(super) fn of(
        datapath: Datapath,
        inputs: impl Iterator<Item = Inputs>,
        effects: &Effects,
        p: &Precision,
    ) -> Self {
        let reading = Reading::best();
        let of_another = |inputs| -> ! { panic!("{inputs:?} in a set of the datapath `{}`", datapath.name()) };
        match datapath {
            Datapath::Reflection => {
                let wires = inputs.map(|inputs| match inputs {
                    Inputs::Reflection(wires) => wires,
                    _ => of_another(inputs),
                });
                let (fragments, mut outputs) = (wires.collect(), Columns::default());
                reading.fragments(&fragments, &effects.reflection(), p, &mut outputs);
                Self::Reflection(fragments, outputs)
            }
            Datapath::Highlight => {
                let wires = inputs.map(|inputs| match inputs {
                    Inputs::Highlight(wires) => wires,
                    _ => of_another(inputs),
                });
                let (lights, mut outputs) = (wires.collect(), Columns::default());
                reading.lit_surfaces(&lights, &effects.highlight(), p, &mut outputs);
                Self::Highlight(lights, outputs)
            }
            Datapath::Peak => {
                let wires = inputs.map(|inputs| match inputs {
                    Inputs::Peak(wires) => wires,
                    _ => of_another(inputs),
                });
                let (lights, mut outputs) = (wires.collect(), Columns::default());
                reading.lit_peaks(&lights, &effects.peak(), p, &mut outputs);
                Self::Peak(lights, outputs)
            }
        }
    }

    /// A port of every vector.
    pub(super) fn port(&self, place: usize) -> &[i32] {
        match self {
            Self::Reflection(inputs, _) => inputs.row(place),
            Self::Highlight(inputs, _) => inputs.row(place),
            Self::Peak(inputs, _) => inputs.row(place),
        }
    }

    /// An output of every vector.
    pub(super) fn output(&self, place: usize) -> &[i32] {
        match self {
            Self::Reflection(_, outputs) => outputs.row(place),
            Self::Highlight(_, outputs) => outputs.row(place),
            Self::Peak(_, outputs) => outputs.row(place),
        }
    }
}
