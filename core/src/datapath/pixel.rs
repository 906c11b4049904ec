//! Pixels: from samples to colour, one channel at a time.

use crate::bundle::{Value, bundle};
use crate::each::each;
use crate::fx::{Control, Int};
use crate::ports::{LIGHT, REFLECTANCE, SHARE};
use crate::stage::{blend, pixel};
use crate::staged::{Staged, control_stage, stage};

/// Mean of 16-bit texels, with 8 more fraction bits, in units of 2^`exponent`, as a colour.
#[inline(always)]
pub fn colour<W: Staged>(sample: Int<W>, exponent: Int<W>) -> Control<W, LIGHT> {
    control_stage!("pixel.colour", pixel::colour::<W>(sample, exponent))
}

/// Product of two colours: of a colour map and its object, or of returned light and the light's own colour.
#[inline(always)]
pub fn modulated<W: Staged>(a: Control<W, LIGHT>, b: Control<W, LIGHT>) -> Control<W, LIGHT> {
    control_stage!("pixel.modulated", pixel::modulated::<W>(a, b))
}

/// Blend of surface and reflection by the reflectance of the material.
#[inline(always)]
pub fn blend<W: Staged>(
    surface: Control<W, LIGHT>,
    reflection: Control<W, LIGHT>,
    reflectance: Control<W, REFLECTANCE>,
) -> Control<W, LIGHT> {
    control_stage!("blend", blend::blend::<W>(surface, reflection, reflectance))
}

/// [`blend`](fn@blend) with a mean of bright texels, in units of 2^(`exponent` − 31); with reflectance 1, that mean as a colour.
#[inline(always)]
pub fn bright_blend<W: Staged>(
    surface: Control<W, LIGHT>,
    mean: Int<W>,
    exponent: Int<W>,
    reflectance: Control<W, REFLECTANCE>,
) -> Control<W, LIGHT> {
    control_stage!("blend.bright", blend::bright::<W>(surface, mean, exponent, reflectance))
}

/// [`colour`] and [`blend`](fn@blend) of every channel, as one stage.
#[inline(always)]
pub fn reflected<W: Staged>(
    surface: &[Control<W, LIGHT>; 3],
    mean: &[Int<W>; 3],
    exponent: Int<W>,
    reflectance: &[Control<W, REFLECTANCE>; 3],
) -> [Value<W, LIGHT>; 3] {
    stage!(
        "blend",
        each!(i in [0, 1, 2] => {
            Value(blend::blend::<W>(surface[i], pixel::colour::<W>(mean[i], exponent), reflectance[i]))
        })
    )
}

/// [`bright_blend`] of every channel, as one stage.
#[inline(always)]
pub fn bright_reflected<W: Staged>(
    surface: &[Control<W, LIGHT>; 3],
    mean: &[Int<W>; 3],
    exponent: Int<W>,
    reflectance: &[Control<W, REFLECTANCE>; 3],
) -> [Value<W, LIGHT>; 3] {
    stage!(
        "blend.bright",
        each!(i in [0, 1, 2] => {
            Value(blend::bright::<W>(surface[i], mean[i], exponent, reflectance[i]))
        })
    )
}

/// Weighted mean of the colours of two lobes of a surface; `weight` is that of the first.
#[inline(always)]
pub fn lobes<W: Staged>(colours: [Control<W, LIGHT>; 2], weight: Control<W, SHARE>) -> Control<W, LIGHT> {
    control_stage!("pixel.lobes", pixel::lobes::<W>(colours, weight))
}

bundle! {
    /// Light of a pixel so far.
    pub struct PixelSum<W> {
        /// Sum of colours below 64, with room for the lights of a scene and the samples of a pixel.
        #[range(0..=1073741824)]
        sum: WideControl<W, 40>,
    }
}

/// Light of a pixel with one more colour.
#[inline(always)]
pub fn sum<W: Staged>(sum: &PixelSum<W>, colour: Control<W, LIGHT>) -> PixelSum<W> {
    stage!("pixel.sum", PixelSum { sum: pixel::sum::<W>(sum.sum, colour) })
}

/// Channel of a pixel: all its light, clamped to the brightest.
#[inline(always)]
pub fn pixel<W: Staged>(sum: &PixelSum<W>) -> Control<W, LIGHT> {
    control_stage!("pixel", pixel::pixel::<W>(sum.sum))
}
