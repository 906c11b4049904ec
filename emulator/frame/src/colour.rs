//! Colours of a frame as integers.

/// Linear colour with 24 fraction bits per channel, I8F24.
pub type Colour = [i32; 3];

/// The largest exponent of a map: colours stay below 64, the range of the blend. A brighter sun is cut to it.
pub const MAX_MAP_EXPONENT: i32 = 6;

/// A linear colour as I8F24, cut to the range of the blend.
pub(super) fn colour_word(colour: [f32; 3]) -> Colour {
    colour.map(|channel| (f64::from(channel).clamp(0.0, 63.0) * f64::from(1 << 24)).round() as i32)
}

/// Product of two colours with 24 fraction bits, rounded to nearest.
pub(super) fn multiply(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b) + (1 << 23)) >> 24) as i32
}
