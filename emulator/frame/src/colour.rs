//! Colours of a frame as integers.

use roughxel_shader::Channel;

/// Linear colour with 24 fraction bits per channel, I8F24.
pub type Colour = [i32; 3];

/// The largest exponent of a colour map. Colours stay below 64, the range of the blend; brighter colours are clamped to it.
pub const MAX_MAP_EXPONENT: i32 = 6;

/// A linear colour as I8F24, clamped to the range of the blend.
pub(super) fn colour_word(colour: [f32; 3]) -> [Channel; 3] {
    let word = |channel: f32| (f64::from(channel).clamp(0.0, 63.0) * f64::from(1 << 24)).round() as i32;
    colour.map(|channel| Channel::from_raw(word(channel)))
}
