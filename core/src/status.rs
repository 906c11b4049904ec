//! Sticky status bits: a degenerate input raises a bit in addition to the documented result of its fragment.

use crate::fx::{Fx, Int};
use crate::plan::Datapath;
use crate::word::{Wire, Word};

macro_rules! status_bits {
    ($($(#[$doc:meta])* $name:ident = $bit:literal, $label:literal, $datapaths:expr;)*) => {
        /// One condition of a fragment.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum StatusBit {
            $($(#[$doc])* $name,)*
        }

        impl StatusBit {
            /// Every bit, lowest first.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Mask of the bit in the word.
            pub const fn mask(self) -> u32 {
                match self {
                    $(Self::$name => 1 << $bit,)*
                }
            }

            /// Name in vectors and reports.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $label,)*
                }
            }

            /// Datapaths that raise it.
            pub const fn datapaths(self) -> &'static [Datapath] {
                match self {
                    $(Self::$name => $datapaths,)*
                }
            }
        }
    };
}

const REFLECTION: &[Datapath] = &[Datapath::Reflection];
const HIGHLIGHT: &[Datapath] = &[Datapath::Highlight];
const PEAK: &[Datapath] = &[Datapath::Peak];
const LIGHTS: &[Datapath] = &[Datapath::Highlight, Datapath::Peak];

status_bits! {
    /// n = 0: no tangent basis and no reflection; r = 0, face +z, s = t = 0, empty footprint.
    NormalZero = 0, "normal_zero", &Datapath::ALL;
    /// v = 0: r = 0, face +z, s = t = 0.
    ViewZero = 1, "view_zero", &Datapath::ALL;
    /// n ∥ h (system 3: the axis on which |n| is smallest stands in for h), or p_u, p_v span nothing (systems 1 and 2: the tangent basis is zero, the
    /// surface is unperturbed).
    FramePole = 2, "frame_pole", &Datapath::ALL;
    /// v·n_mod ≤ 0: the perturbed surface is seen from the back.
    ViewBelowSurface = 3, "view_below_surface", REFLECTION;
    /// Two or three components of r tie for the largest: z wins over y, y over x.
    FaceTie = 4, "face_tie", REFLECTION;
    /// The footprint is empty: one probe at the finest level.
    FootprintZero = 5, "footprint_zero", REFLECTION;
    /// λ₁ was clamped to 2 map units for the step.
    FootprintSaturated = 6, "footprint_saturated", REFLECTION;
    /// The aspect asks for more probes than the profile has: λ₂ is raised to λ₁/N.
    ProbesCapped = 7, "probes_capped", REFLECTION;
    /// l = 0: no half vector, f = 0.
    LightZero = 8, "light_zero", LIGHTS;
    /// h = 0: v = −l, or either is zero; f = 0.
    HalfZero = 9, "half_zero", LIGHTS;
    /// n·l ≤ 0: the light is below the geometric surface or on its horizon, f = 0.
    LightBelowSurface = 10, "light_below_surface", LIGHTS;
    /// n_mod·h ≤ 0: the perturbed surface faces away from the half vector, f = 0.
    HalfBelowSurface = 11, "half_below_surface", HIGHLIGHT;
    /// The half vector or the tangent basis is zero: no peak is lit.
    LocalZero = 12, "local_zero", PEAK;
    /// The light of the peaks was clamped to the largest number below 64.
    PeaksSaturated = 13, "peaks_saturated", PEAK;
}

impl StatusBit {
    /// Bits that a datapath raises, lowest first.
    pub fn raised_by(datapath: Datapath) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |bit| bit.datapaths().contains(&datapath))
    }
}

/// Sticky bits of one fragment, under construction.
#[derive(Clone, Copy, Debug)]
pub struct Status<W: Word>(Int<W>);

impl<W: Word> Status<W> {
    /// Word without a raised bit.
    #[inline(always)]
    pub fn clear() -> Self {
        Self(Fx::int(0))
    }

    /// Raises `bit` if the flag is set.
    #[inline(always)]
    #[track_caller]
    pub fn raise(self, bit: StatusBit, flag: W::Flag) -> Self {
        let raised = self.0.raw().or(Wire::lit(bit.mask().into()));
        Self(Fx::from_raw(Wire::select(flag, raised, self.0.raw())))
    }

    /// Word of bits.
    #[inline(always)]
    pub fn word(self) -> Int<W> {
        self.0
    }
}
