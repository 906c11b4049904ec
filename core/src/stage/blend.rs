//! Blend: (1 − ρ)·surface + ρ·reflection per channel, ρ the reflectance of the material.
//!
//! Exact up to one rounding: ρ = 0 gives the surface, ρ = 1 the reflection, to the bit. The reflection of a bright environment keeps its range until
//! it is blended: a few per cent of a sun are more than a few per cent of 64 × white.

use crate::fx::{Control, Fx, Int, WideControl};
use crate::ports::{LIGHT, REFLECTANCE};
use crate::word::{Wire, Word};

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

/// Blends one channel with a mean of bright texels in units of 2^(`exponent` − 31). The result is clamped to the largest number below 64. Range: mean
/// in [0, 2^31), exponent 7…20.
#[inline(always)]
pub fn bright<W: Word>(
    surface: Control<W, LIGHT>,
    mean: Int<W>,
    exponent: Int<W>,
    reflectance: Control<W, REFLECTANCE>,
) -> Control<W, LIGHT> {
    let own: WideControl<W, { LIGHT + REFLECTANCE }> = surface.mul(Control::<W, REFLECTANCE>::int(1) - reflectance);
    // A product of unit 2^(exponent − 47) as one of 2^−40, below 2^60.
    let reflected = mean.raw().mul(reflectance.raw()).shl_by((exponent - Fx::int(7)).raw());
    let sum = own + Fx::from_raw(reflected);
    sum.min(Fx::below(64)).round_to::<LIGHT>(24).min(Fx::below(64))
}
