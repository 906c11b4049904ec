//! The datapaths of vectors, as functions from the wires of ports to integers of outputs: for one vector in the scalar backend,
//! with which `verify` and `explain` recompute, and for many in lanes, with which an export is made.

use std::ops::Range;

use roughxel_core::bundle::{Bundle, End};
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::{
    HighlightIn, HighlightInput, HighlightOutput, PeakIn, PeakInput, PeakOutput, Port, ReflectionIn, ReflectionInput,
    ReflectionOutput,
};
use roughxel_core::precision::Precision;
use roughxel_core::scalar_api;
use roughxel_netlist::integers::{filled, integers, integers_at};
use roughxel_shader::{Batch, LitPeaks, LitSurfaces, Reflections, Shader};
use roughxel_simd::Backend;

/// The wires of all ports of a datapath's design.
#[derive(Clone, Copy, Debug)]
pub enum Inputs {
    /// Ports of a fragment that reflects.
    Reflection(ReflectionInput<i32>),
    /// Ports of a light on a surface.
    Highlight(HighlightInput<i32>),
    /// Ports of a light on a peak.
    Peak(PeakInput<i32>),
}

impl Inputs {
    /// The ports with these integers on their wires.
    pub(super) fn from_integers(datapath: Datapath, integers: &[i64]) -> Self {
        match datapath {
            Datapath::Reflection => Self::Reflection(wires(integers)),
            Datapath::Highlight => Self::Highlight(wires(integers)),
            Datapath::Peak => Self::Peak(wires(integers)),
        }
    }

    /// The integers on the ports of the netlist, in words of the profile's width.
    pub fn recorded(&self, p: &Precision) -> Vec<i64> {
        match self {
            Self::Reflection(wires) => integers_at(wires, p),
            Self::Highlight(wires) => integers_at(wires, p),
            Self::Peak(wires) => integers_at(wires, p),
        }
    }

    /// The integers on the wires.
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

/// Outputs of a datapath for its ports: the integers of all outputs of its design.
pub(super) fn outcome(datapath: Datapath, inputs: &[i64], effects: &Effects, p: &Precision) -> Vec<i64> {
    match datapath {
        Datapath::Reflection => {
            integers(&scalar_api::fragment(&wires::<ReflectionInput<i32>>(inputs), &effects.reflection(), p))
        }
        Datapath::Highlight => {
            integers(&scalar_api::highlight(&wires::<HighlightInput<i32>>(inputs), &effects.highlight(), p))
        }
        Datapath::Peak => integers(&scalar_api::lit_peak(&wires::<PeakInput<i32>>(inputs), &effects.peak(), p)),
    }
}

/// The bundle with these integers on its wires.
pub(super) fn wires<B: Bundle<i32, In<i32> = B>>(inputs: &[i64]) -> B {
    filled(&B::limit::<i32>(End::Low), inputs)
}

/// The ports of vectors of one datapath, a row per wire.
#[derive(Debug)]
pub enum Ports {
    /// Ports of fragments that reflect.
    Reflection(Batch<ReflectionInput<i32>>),
    /// Ports of lights on surfaces.
    Highlight(Batch<HighlightInput<i32>>),
    /// Ports of lights on peaks.
    Peak(Batch<PeakInput<i32>>),
}

impl Ports {
    /// Ports of zero vectors.
    pub fn new(datapath: Datapath) -> Self {
        match datapath {
            Datapath::Reflection => Self::Reflection(Batch::default()),
            Datapath::Highlight => Self::Highlight(Batch::default()),
            Datapath::Peak => Self::Peak(Batch::default()),
        }
    }

    fn clear(&mut self) {
        match self {
            Self::Reflection(columns) => columns.clear(),
            Self::Highlight(columns) => columns.clear(),
            Self::Peak(columns) => columns.clear(),
        }
    }

    /// Adds the ports of a vector.
    ///
    /// # Panics
    /// If it is of a different datapath.
    fn push(&mut self, inputs: &Inputs) {
        match (self, inputs) {
            (Self::Reflection(columns), Inputs::Reflection(wires)) => columns.push(wires),
            (Self::Highlight(columns), Inputs::Highlight(wires)) => columns.push(wires),
            (Self::Peak(columns), Inputs::Peak(wires)) => columns.push(wires),
            _ => panic!("{inputs:?} in a set of a different datapath"),
        }
    }

    /// The row of one port.
    fn row(&self, place: usize) -> &[i32] {
        match self {
            Self::Reflection(columns) => columns.row(place),
            Self::Highlight(columns) => columns.row(place),
            Self::Peak(columns) => columns.row(place),
        }
    }
}

/// Source of the inputs of vectors, by index. A function of an index gives them one by one.
pub trait InputSource: Sync {
    /// The inputs of a vector.
    fn input(&self, index: u64) -> Inputs;

    /// Replaces `ports` by those of some vectors.
    ///
    /// # Panics
    /// If they are of a different datapath.
    fn fill(&self, indices: Range<u64>, ports: &mut Ports) {
        ports.clear();
        indices.for_each(|index| ports.push(&self.input(index)));
    }
}

impl<F: Fn(u64) -> Inputs + Sync> InputSource for F {
    fn input(&self, index: u64) -> Inputs {
        self(index)
    }
}

/// Outputs of a datapath for vectors, a row per wire.
enum Outputs {
    Reflection(Batch<ReflectionOutput<i32>>),
    Highlight(Batch<HighlightOutput<i32>>),
    Peak(Batch<PeakOutput<i32>>),
}

/// Vectors of one datapath. No wire of the three datapaths is wide, so the index of a row is that of its port or output.
pub(super) struct Computed {
    ports: Ports,
    outputs: Outputs,
}

impl Computed {
    /// Results of zero vectors.
    pub(super) fn new(datapath: Datapath) -> Self {
        let outputs = match datapath {
            Datapath::Reflection => Outputs::Reflection(Batch::default()),
            Datapath::Highlight => Outputs::Highlight(Batch::default()),
            Datapath::Peak => Outputs::Peak(Batch::default()),
        };
        Self { ports: Ports::new(datapath), outputs }
    }

    /// Replaces the vectors by some of `input`, computed by their datapath on the fastest backend of this machine.
    ///
    /// # Panics
    /// If they are of a different datapath.
    pub(super) fn fill(&mut self, input: &dyn InputSource, indices: Range<u64>, effects: &Effects, p: &Precision) {
        let shader = Shader::new(Backend::best(), p);
        input.fill(indices, &mut self.ports);
        match (&self.ports, &mut self.outputs) {
            (Ports::Reflection(inputs), Outputs::Reflection(outputs)) => {
                Reflections { inputs, plan: &effects.reflection() }.run(shader, outputs);
            }
            (Ports::Highlight(inputs), Outputs::Highlight(outputs)) => {
                LitSurfaces { inputs, plan: &effects.highlight() }.run(shader, outputs);
            }
            (Ports::Peak(inputs), Outputs::Peak(outputs)) => {
                LitPeaks { inputs, plan: &effects.peak() }.run(shader, outputs);
            }
            _ => unreachable!("ports and outputs are of one datapath"),
        }
    }

    /// A port of every vector.
    pub(super) fn port(&self, place: usize) -> &[i32] {
        self.ports.row(place)
    }

    /// An output of every vector.
    pub(super) fn output(&self, place: usize) -> &[i32] {
        match &self.outputs {
            Outputs::Reflection(outputs) => outputs.row(place),
            Outputs::Highlight(outputs) => outputs.row(place),
            Outputs::Peak(outputs) => outputs.row(place),
        }
    }
}
