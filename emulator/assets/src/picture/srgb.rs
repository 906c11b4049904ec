//! The sRGB curve.

use std::sync::LazyLock;

/// Linear light of an sRGB value in 0…1: x/12.92 up to 0.04045, ((x + 0.055)/1.055)^2.4 above (IEC 61966-2-1).
///
/// x^2.4 = x² · (x^⅕)², with the fifth root by Newton's method: the same bits on every machine, unlike the platform's
/// pow. Error: below 2⁻⁵⁰, relative. Values outside 0…1 count as 0 or 1.
pub fn srgb_to_linear(encoded: f64) -> f64 {
    let encoded = encoded.clamp(0.0, 1.0);
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    let x = (encoded + 0.055) / 1.055;
    // Iteration from above, 1 ≥ x^⅕ ≥ 0.61: quadratic after two steps. Eight steps reach the last bit, measured over
    // all 16-bit codes.
    let mut root = 1.0;
    for _ in 0..8 {
        let fourth = (root * root) * (root * root);
        root = (4.0 * root + x / fourth) / 5.0;
    }
    (x * x) * (root * root)
}

/// Linear values half-way (in sRGB) between consecutive 8-bit codes.
static SRGB_THRESHOLDS: LazyLock<[f64; 255]> =
    LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear((code as f64 + 0.5) / 255.0)));

/// Parts of 0…1 for the look-up of a value. At most one threshold lies in each: at the steepest, below 0.0031, a part is 0.81 codes.
const PARTS: usize = 4096;

/// Number of thresholds up to the beginning of each part, and all of them after the last part.
static SRGB_PARTS: LazyLock<[u8; PARTS + 1]> = LazyLock::new(|| {
    std::array::from_fn(|part| {
        let begin = part as f64 / PARTS as f64;
        SRGB_THRESHOLDS.partition_point(|threshold| *threshold <= begin) as u8
    })
});

/// 8-bit sRGB code of linear light, clamped to 0…1; NaN gives 0.
///
/// Rounding: to the nearest code on the sRGB scale, ties up; exact, by comparison with the half-way points.
pub fn linear_to_srgb8(linear: f32) -> u8 {
    let linear = f64::from(linear);
    // A cast saturates, and NaN becomes 0.
    let code = SRGB_PARTS[((linear * PARTS as f64) as usize).min(PARTS)];
    let is_above = SRGB_THRESHOLDS.get(usize::from(code)).is_some_and(|threshold| *threshold <= linear);
    code + u8::from(is_above)
}
