//! Pixel: from samples of maps to the colour of a pixel.
//!
//! Stored channels come in units of their map's power of two. A colour map is multiplied by the colour of its object, and returned light by that of
//! its light; all light of a pixel is summed. Error: half a last place (2^−25) for each product.

use crate::fx::{Control, Fx, Int, WideControl};
use crate::ports::{LIGHT, OFFSET, SHARE};
use crate::word::{Wire, Word};

/// Sample of 16-bit texels with 8 more fraction bits, in units of 2^`exponent`, as a colour. Range: exponent 0…6.
#[inline(always)]
pub fn colour<W: Word>(sample: Int<W>, exponent: Int<W>) -> Control<W, LIGHT> {
    Fx::from_raw(sample.raw().shl_by(exponent.raw()))
}

/// Product of two colours, clamped to the largest number below 64.
#[inline(always)]
pub fn modulated<W: Word>(a: Control<W, LIGHT>, b: Control<W, LIGHT>) -> Control<W, LIGHT> {
    let product: WideControl<W, { 2 * LIGHT }> = a.mul(b);
    product.min(Fx::below(64)).round_to::<LIGHT>(24).min(Fx::below(64))
}

/// Number in units of 2^`exponent` as a port of the datapath with `fraction_bits` fraction bits takes it, ±8: rounded to nearest, saturated. Range: exponent
/// −15…3.
#[inline(always)]
pub fn bump<C: Word<Count = C>, const INT: u32>(
    number: Fx<C, INT>,
    exponent: Fx<C, 32>,
    fraction_bits: u32,
) -> Fx<C, OFFSET> {
    // Four places above, so that one count of places down serves both ways.
    let wide = number.raw().widen().shl(4).sar_by((Fx::int(3) - exponent).raw());
    let rounded = wide.add(Wire::lit(1)).sar(1);
    // The largest number that does not round up to 8.
    let high = i32::MAX - ((1 << (Fx::<C, OFFSET>::FRACTION - fraction_bits)) >> 1);
    let [low, high] = [i32::MIN, high].map(|end| C::Wide::lit(end.into()));
    let rounded = Fx::<C::Wide, INT>::from_raw(rounded).saturate(Fx::from_raw(low), Fx::from_raw(high));
    Fx::<C, OFFSET>::from_raw(C::narrow(rounded.raw())).quantise(fraction_bits)
}

/// Colour of a surface with two lobes, floored. `weight` in [0, 1] is that of the first. Equal lobes give their own colour.
#[inline(always)]
pub fn lobes<W: Word>([first, second]: [Control<W, LIGHT>; 2], weight: Control<W, SHARE>) -> Control<W, LIGHT> {
    let sum: WideControl<W, { LIGHT + SHARE }> = second.mul(Control::<W, SHARE>::int(1) - weight);
    // A product has the fraction bits of a share in addition.
    let sum = (sum + first.mul(weight)).floor_shr(Control::<W, SHARE>::FRACTION);
    Fx::from_raw(W::Count::narrow(sum.raw()))
}

/// Light of a pixel so far, and one more colour.
#[inline(always)]
pub fn sum<W: Word>(sum: WideControl<W, 40>, colour: Control<W, LIGHT>) -> WideControl<W, 40> {
    sum + colour.widen()
}

/// Brightest channel of a picture.
pub const BRIGHTEST: i64 = 63;

/// Channel of a pixel: all its light, clamped to [`BRIGHTEST`].
#[inline(always)]
pub fn pixel<W: Word>(sum: WideControl<W, 40>) -> Control<W, LIGHT> {
    Fx::from_raw(W::Count::narrow(sum.min(Fx::int(BRIGHTEST)).raw()))
}
