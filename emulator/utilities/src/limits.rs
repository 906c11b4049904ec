//! Bounds on the sizes of input and pictures.

/// Largest edge of a frame in pixels.
pub const MAX_FRAME_EDGE_PX: u32 = 16_384;
/// Largest number of pixels of a frame.
pub const MAX_FRAME_PIXELS: u64 = 1 << 26;
/// Largest size of a scene file in bytes.
pub const MAX_SCENE_BYTES: u64 = 1 << 20;

/// Brightest texel of an environment, × white: the largest number of 12 significant bits below 2^20.
pub const BRIGHTEST_ENVIRONMENT: f64 = 1_048_320.0;
/// Brightest texel of a colour map, × white.
pub const BRIGHTEST_COLOUR: f64 = 64.0;

/// Largest coordinate of a scene, world units.
pub const MAX_COORDINATE: f64 = 1e6;
/// Range of lengths, world units.
pub const LENGTHS: std::ops::RangeInclusive<f64> = 1e-4..=1e6;
/// Range of the exposure of an environment, stops.
pub const EXPOSURES: std::ops::RangeInclusive<f64> = -10.0..=10.0;
/// Largest edge of an environment's face: six such faces stay below 2²⁶ pixels.
pub const MAX_FACE_EDGE: u32 = 2048;

/// Returns true if a frame of that size may be drawn.
pub fn frame_size_is_allowed(width: u32, height: u32) -> bool {
    let edge = 1..=MAX_FRAME_EDGE_PX;
    edge.contains(&width) && edge.contains(&height) && u64::from(width) * u64::from(height) <= MAX_FRAME_PIXELS
}
