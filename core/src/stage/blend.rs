//! Blend: (1 − ρ)·surface + ρ·reflection per channel, ρ the reflectance of the material.
//!
//! Exact up to one rounding: ρ = 0 gives the surface, ρ = 1 the reflection, to the bit.

use crate::fx::{Control, WideControl};
use crate::ports::{LIGHT, REFLECTANCE};
use crate::word::Word;

/// Blends one channel. Range: colours below 64 (I8F24), reflectance in [0, 1].
#[inline(always)]
pub fn blend<W: Word>(
    surface: Control<W, LIGHT>,
    reflection: Control<W, LIGHT>,
    reflectance: Control<W, REFLECTANCE>,
) -> Control<W, LIGHT> {
    let sum: WideControl<W, { LIGHT + REFLECTANCE }> = surface.mul(Control::<W, REFLECTANCE>::int(1) - reflectance);
    (sum + reflection.mul(reflectance)).round_to(24)
}
