//! Blend: (1 − ρ)·surface + ρ·reflection per channel, ρ the reflectance of the material.
//!
//! Exact up to one rounding: ρ = 0 gives the surface, ρ = 1 the reflection, to the bit.

use crate::fx::{Fx, Wide};
use crate::word::Word;

/// Fraction bits of a reflectance; 1 is 2^16.
pub const REFLECTANCE: u32 = 16;
/// Fraction bits of a filtered colour.
pub const COLOUR: u32 = 24;

/// Blends one channel. Range: colours below 64 (I8F24), reflectance in [0, 1].
#[inline(always)]
pub fn blend<W: Word>(
    surface: Fx<W, COLOUR>,
    reflection: Fx<W, COLOUR>,
    reflectance: Fx<W, REFLECTANCE>,
) -> Fx<W, COLOUR> {
    let sum: Wide<W, 40> = surface.mul(Fx::<W, 16>::lit(1 << REFLECTANCE) - reflectance);
    (sum + reflection.mul(reflectance)).round_to(COLOUR)
}
