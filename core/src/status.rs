//! Sticky status bits: a degenerate input raises a bit beside the documented result of its fragment.

use crate::bundle::{Bundle, Rewire};
use crate::fx::Fx;
use crate::word::Word;

macro_rules! status_bits {
    ($($(#[$list_doc:meta])* $list:ident { $($(#[$doc:meta])* $name:ident = $bit:literal, $label:literal;)* })*) => {
        /// One condition of a fragment.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u32)]
        pub enum StatusBit {
            $($($(#[$doc])* $name = 1 << $bit,)*)*
        }

        $($(#[$list_doc])* pub const $list: &[(StatusBit, &str)] = &[$((StatusBit::$name, $label)),*];)*
    };
}

status_bits! {
    /// Every bit of the reflection datapath with its name in vectors and reports, lowest first.
    STATUS_BITS {
        /// n = 0: no frame and no reflection; r = 0, face +z, s = t = 0, empty footprint.
        NormalZero = 0, "normal_zero";
        /// v = 0: r = 0, face +z, s = t = 0.
        ViewZero = 1, "view_zero";
        /// n ∥ h (system 3: the axis on which |n| is smallest stands in for h), or p_u, p_v span nothing (systems 1
        /// and 2: the frame is zero, the surface is unperturbed).
        FramePole = 2, "frame_pole";
        /// v·n_mod ≤ 0: the perturbed surface is seen from behind.
        ViewBelowSurface = 3, "view_below_surface";
        /// Two or three components of r tie for the largest: z wins over y, y over x.
        FaceTie = 4, "face_tie";
        /// The footprint is empty: one probe at the finest level.
        FootprintZero = 5, "footprint_zero";
        /// λ₁ was cut to 2 map units for the step.
        FootprintSaturated = 6, "footprint_saturated";
        /// The aspect asks for more probes than the profile has: λ₂ is raised to λ₁/N.
        ProbesCapped = 7, "probes_capped";
    }

    /// The bits that a light adds, lowest first.
    LIGHT_STATUS_BITS {
        /// l = 0: no half vector, f = 0.
        LightZero = 8, "light_zero";
        /// h = 0: v = −l, or either is zero; f = 0.
        HalfZero = 9, "half_zero";
        /// n·l ≤ 0: the light is below the geometric surface or on its horizon, f = 0.
        LightBelowSurface = 10, "light_below_surface";
        /// n_mod·h ≤ 0: the perturbed surface faces away from the half vector, f = 0.
        HalfBelowSurface = 11, "half_below_surface";
        /// The half vector or the frame is zero: no peak is lit.
        LocalZero = 12, "local_zero";
        /// The light of the peaks was cut to the largest number below 64.
        PeaksSaturated = 13, "peaks_saturated";
    }
}

/// The sticky bits of one fragment on a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status<W>(Fx<W, 0>);

impl<W: Word> Bundle<W> for Status<W> {
    type In<V: Word> = Status<V>;
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> Status<V> {
        Status(self.0.rewire(with))
    }
}

impl<W: Word> Status<W> {
    /// No bit raised.
    #[inline(always)]
    pub fn clear() -> Self {
        Self(Fx::zero())
    }

    /// Raises `bit` where the flag is set.
    #[inline(always)]
    pub fn raise(self, bit: StatusBit, flag: W::Flag) -> Self {
        let raised = self.0.raw().or(W::lit(bit as i64));
        Self(Fx::from_raw(W::select(flag, raised, self.0.raw())))
    }

    /// The word of bits.
    #[inline(always)]
    pub fn word(self) -> Fx<W, 0> {
        self.0
    }
}
