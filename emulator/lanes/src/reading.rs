//! Which reading computes surfaces, footprints and peaks: the bits are the same, the time is not.

use std::fmt;
use std::str::FromStr;

use roughxel_core::bundle::{Value, bundle};
use roughxel_core::datapath::{self, Reflection, Surface};
use roughxel_core::design::Form;
use roughxel_core::fx::{Control, Fx, Int};
use roughxel_core::plan::{ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{LIGHT, PortBlock, ReflectionInput, SurfaceInput};
use roughxel_core::precision::Precision;
use roughxel_core::signals::{CubePoint, LocalDirection, MapScale, Probes, SphereProbe, Sweep};
use roughxel_core::soft_core;
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::width::on_words;
use roughxel_core::word::Word;

use super::batch::{map, spread};
use super::narrow::KEPT;
use super::peak_list::{self, PeakList};
use super::target::InstructionSet;
#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512, Lanes, NarrowLanes};

/// Peaks that are worth a group of lanes, at least. With four of them in lanes unfiltered frames take 0.92 (`denim-plane`) and 0.99
/// (`cylinders-plane`) of the time with AVX-512, but 1.05 and 1.17 with AVX2.
const FEW: usize = 5;

bundle! {
    /// What fetching needs of a reflection: where it looks, and over which footprint.
    pub struct Footprint<W> {
        /// Face, s, t.
        point: CubePoint<W>,
        /// N, step, level of detail.
        probes: Probes<W>,
    }
}

impl<W: Word> Footprint<W> {
    /// That part of a reflection.
    #[inline(always)]
    pub fn of(stages: &Reflection<W>) -> Self {
        Self { point: stages.point, probes: stages.probes }
    }
}

bundle! {
    /// A fragment whose surface is made.
    pub struct Reflecting<W> {
        /// Its surface.
        surface: Surface<W>,
        /// ∂v/∂x and ∂v/∂y.
        dview: [PortBlock<W, 3>; 2],
        /// ∂n/∂x and ∂n/∂y.
        dnormal: [PortBlock<W, 3>; 2],
    }
}

bundle! {
    /// A probe of a footprint on the sphere that is to be made.
    pub struct Step<W> {
        /// What it steps along.
        sweep: Sweep<W>,
        /// 0 … N − 1.
        index: Int<W>,
    }
}

impl<W: Word> Reflecting<W> {
    /// ∂v and ∂n.
    #[inline(always)]
    fn derivatives(&self) -> [&[PortBlock<W, 3>; 2]; 2] {
        [&self.dview, &self.dnormal]
    }
}

/// A way to compute parts of the datapath for many fragments, or the light of many peaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// One fragment after the other.
    Scalar,
    /// Lanes, with an instruction set of this machine.
    Lanes(InstructionSet),
}

/// Words that lanes have.
enum Width {
    /// Of 16 bits, all kept.
    Narrow,
    /// Of 32 bits.
    Full,
}

/// The lanes of a profile; `None` of 12 and 13 kept bits, which no named one has and the scalar reading runs.
fn lanes_of(p: &Precision) -> Option<Width> {
    match p.word_bits() {
        16 => (p.fraction_bits == KEPT).then_some(Width::Narrow),
        _ => Some(Width::Full),
    }
}

/// What a part of the datapath makes of every input: `$body` in lanes of the profile's width, with what is the same for all fragments spread
/// over them, or `$scalar`.
macro_rules! each_fragment {
    (
        $reading:expr, $p:expr, $inputs:expr, $results:expr,
        |$input:ident: $in:ty $(, $same:ident)* => $out:ty| $body:expr, else $scalar:expr
    ) => {
        match ($reading, lanes_of($p)) {
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes(InstructionSet::Avx2), Some(Width::Narrow)) => {
                each_fragment!(@lanes NarrowLanes<Avx2>, $inputs, $results, |$input: $in $(, $same)* => $out| $body);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes(InstructionSet::Avx2), Some(Width::Full)) => {
                each_fragment!(@lanes Lanes<Avx2>, $inputs, $results, |$input: $in $(, $same)* => $out| $body);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes(InstructionSet::Avx512), Some(Width::Narrow)) => {
                each_fragment!(@lanes NarrowLanes<Avx512>, $inputs, $results, |$input: $in $(, $same)* => $out| $body);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes(InstructionSet::Avx512), Some(Width::Full)) => {
                each_fragment!(@lanes Lanes<Avx512>, $inputs, $results, |$input: $in $(, $same)* => $out| $body);
            }
            _ => $results.extend($inputs.iter().map(|$input| $scalar)),
        }
    };
    (@lanes $lanes:ty, $inputs:expr, $results:expr, |$input:ident: $in:ty $(, $same:ident)* => $out:ty| $body:expr) => {
        map::<$lanes, _, _, _, { words::<$in>() }, { words::<$out>() }>(
            $inputs,
            $results,
            #[inline(always)]
            |$input| {
                $(let $same = &spread::<$lanes, _, _>($same);)*
                $body
            },
        )
    };
}

/// Words of a bundle.
#[cfg(target_arch = "x86_64")]
const fn words<F: Form>() -> usize {
    F::WORDS
}

impl Reading {
    /// The fastest on this machine.
    pub fn best() -> Self {
        InstructionSet::best().map_or(Self::Scalar, Self::Lanes)
    }

    /// What fetching needs of every fragment, in their order.
    pub fn footprints(
        self,
        inputs: &[ReflectionInput<i32>],
        scale: &MapScale<i32>,
        plan: &ReflectionPlan,
        p: &Precision,
    ) -> Vec<Footprint<i32>> {
        let mut results = Vec::new();
        each_fragment!(
            self, p, inputs, &mut results,
            |input: ReflectionInput<i32>, scale => Footprint<i32>| {
                Footprint::of(&datapath::reflection(input, scale, &plan.on_face(), p))
            },
            else Footprint::of(&soft_core::reflection(input, scale, &plan.on_face(), p))
        );
        results
    }

    /// What the probes on the sphere step along, of every fragment whose surface is made, in their order.
    pub fn sweeps(
        self,
        inputs: &[Reflecting<i32>],
        scale: &MapScale<i32>,
        plan: &ReflectionPlan,
        p: &Precision,
    ) -> Vec<Sweep<i32>> {
        let mut results = Vec::new();
        each_fragment!(
            self, p, inputs, &mut results,
            |input: Reflecting<i32>, scale => Sweep<i32>| {
                datapath::reflection_of(&input.surface, input.derivatives(), scale, &plan.on_sphere(), p).sweep
            },
            else soft_core::reflection_of(&input.surface, input.derivatives(), scale, &plan.on_sphere(), p).sweep
        );
        results
    }

    /// Adds all probes of every sweep to `probes`, in their order, on an environment with levels up to `last_level`.
    pub fn sphere_probes(
        self,
        sweeps: &[Sweep<i32>],
        last_level: Int<i32>,
        p: &Precision,
        probes: &mut Vec<SphereProbe<i32>>,
    ) {
        let steps = sweeps
            .iter()
            .flat_map(|&sweep| (0..sweep.count.raw()).map(move |index| Step { sweep, index: Fx::from_raw(index) }));
        let (steps, last_level) = (steps.collect::<Vec<_>>(), &Value(last_level));
        each_fragment!(
            self, p, &steps, probes,
            |step: Step<i32>, last_level => SphereProbe<i32>| {
                datapath::sphere_probe(&step.sweep, step.index, last_level.0, p)
            },
            else soft_core::sphere_probe(&step.sweep, step.index, last_level.0, p)
        );
    }

    /// The surface of every fragment, in their order.
    pub fn surfaces(self, inputs: &[SurfaceInput<i32>], plan: &SurfacePlan, p: &Precision) -> Vec<Surface<i32>> {
        let mut results = Vec::new();
        each_fragment!(
            self, p, inputs, &mut results,
            |input: SurfaceInput<i32> => Surface<i32>| datapath::surface(input, plan, p),
            else soft_core::surface(input, plan, p)
        );
        results
    }

    /// What fetching needs of every fragment whose surface is made, in their order.
    pub fn footprints_of(
        self,
        inputs: &[Reflecting<i32>],
        scale: &MapScale<i32>,
        plan: &ReflectionPlan,
        p: &Precision,
    ) -> Vec<Footprint<i32>> {
        let mut results = Vec::new();
        each_fragment!(
            self, p, inputs, &mut results,
            |input: Reflecting<i32>, scale => Footprint<i32>| {
                Footprint::of(&datapath::reflection_of(&input.surface, input.derivatives(), scale, &plan.on_face(), p))
            },
            else Footprint::of(&soft_core::reflection_of(&input.surface, input.derivatives(), scale, &plan.on_face(), p))
        );
        results
    }

    /// Adds the probes that every fragment reads of maps of one scale to `probes`, in their order.
    pub fn texture_footprints(
        self,
        derivatives: &[[PortBlock<i32, 2>; 2]],
        (texture, scale): &(TextureScale<i32>, MapScale<i32>),
        p: &Precision,
        probes: &mut Vec<Probes<i32>>,
    ) {
        each_fragment!(
            self, p, derivatives, probes,
            |duv: [PortBlock<i32, 2>; 2], texture, scale => Probes<i32>| {
                datapath::texture_footprint(duv, texture, scale, p).probes
            },
            else soft_core::texture_footprint(duv, texture, scale, p).probes
        );
    }

    /// Adds the light that every peak returns for one half vector to `lights`, in their order.
    pub fn peaks(
        self,
        half: &LocalDirection<i32>,
        peaks: &PeakList,
        p: &Precision,
        lights: &mut Vec<Control<i32, LIGHT>>,
    ) {
        match (self, lanes_of(p)) {
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes(InstructionSet::Avx2), Some(Width::Narrow)) if peaks.len() >= FEW => {
                peak_list::lights::<NarrowLanes<Avx2>, _>(half, peaks, p, lights);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes(InstructionSet::Avx2), Some(Width::Full)) if peaks.len() >= FEW => {
                peak_list::lights::<Lanes<Avx2>, _>(half, peaks, p, lights);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes(InstructionSet::Avx512), Some(Width::Narrow)) if peaks.len() >= FEW => {
                peak_list::lights::<NarrowLanes<Avx512>, _>(half, peaks, p, lights);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes(InstructionSet::Avx512), Some(Width::Full)) if peaks.len() >= FEW => {
                peak_list::lights::<Lanes<Avx512>, _>(half, peaks, p, lights);
            }
            _ => lights.extend(
                peaks
                    .iter()
                    .map(|(words, weight)| on_words!(p, |half| Value(datapath::packed_peak(half, words, weight, p))).0),
            ),
        }
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scalar => f.write_str("scalar"),
            Self::Lanes(set) => write!(f, "{set}"),
        }
    }
}

impl FromStr for Reading {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lanes = InstructionSet::available().map(Self::Lanes);
        let readings: Vec<Self> = std::iter::once(Self::Scalar).chain(lanes).collect();
        readings.iter().copied().find(|reading| reading.to_string() == text).ok_or_else(|| {
            let names: Vec<String> = readings.iter().map(Self::to_string).collect();
            format!("'{text}' is no reading of this machine: use {}", names.join(", "))
        })
    }
}
