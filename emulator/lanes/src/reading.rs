//! Which reading computes the reflection datapath, texture footprints and peaks: the bits are the same, the time is not.

use std::fmt;
use std::str::FromStr;

use roughxel_core::datapath::{self, ReflectionInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::precision::Precision;
use roughxel_core::signals::{LIGHT, LocalDirection, MapScale, PortBlock, Probes};
use roughxel_core::stage::texture::TextureScale;

use super::batch::{Batch, Footprint};
use super::peaks::{self, PeakList};
use super::target::InstructionSet;
use super::texture;
#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512};

/// Peaks that are worth a group of lanes, at least. With four of them in lanes unfiltered frames take 0.92 (`denim-plane`) and 0.99
/// (`cylinders-plane`) of the time with AVX-512, but 1.05 and 1.17 with AVX2.
const FEW: usize = 5;

/// A way to compute the reflection datapath or the texture footprints of many fragments, or the light of many peaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// One fragment after the other.
    Scalar,
    /// Lanes, with an instruction set of this machine.
    Lanes(InstructionSet),
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
        plan: &ReflectionPlan,
        p: &Precision,
    ) -> Vec<Footprint<i32>> {
        match self {
            Self::Scalar => inputs.iter().map(|input| Footprint::of(&datapath::reflection(input, plan, p))).collect(),
            Self::Lanes(set) => Batch::new(inputs).footprints(set, plan, p),
        }
    }

    /// Adds the probes that every fragment reads of maps of one scale to `probes`, in their order.
    pub fn texture_footprints(
        self,
        derivatives: &[[PortBlock<i32, 2>; 2]],
        scale: &(TextureScale<i32>, MapScale<i32>),
        p: &Precision,
        probes: &mut Vec<Probes<i32>>,
    ) {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Lanes(InstructionSet::Avx2) => texture::footprints::<Avx2>(derivatives, scale, p, probes),
            #[cfg(target_arch = "x86_64")]
            Self::Lanes(InstructionSet::Avx512) => texture::footprints::<Avx512>(derivatives, scale, p, probes),
            _ => probes
                .extend(derivatives.iter().map(|duv| datapath::texture_footprint(duv, &scale.0, &scale.1, p).probes)),
        }
    }

    /// Adds the light that every peak returns for one half vector to `lights`, in their order.
    pub fn peaks(self, half: &LocalDirection<i32>, peaks: &PeakList, p: &Precision, lights: &mut Vec<Fx<i32, LIGHT>>) {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Lanes(InstructionSet::Avx2) if peaks.len() >= FEW => peaks::lights::<Avx2>(half, peaks, p, lights),
            #[cfg(target_arch = "x86_64")]
            Self::Lanes(InstructionSet::Avx512) if peaks.len() >= FEW => {
                peaks::lights::<Avx512>(half, peaks, p, lights);
            }
            _ => lights.extend(peaks.iter().map(|(peak, weight)| datapath::peak(half, &peak, weight, p))),
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
