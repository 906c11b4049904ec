//! Priced fragments: some of the tile, with a light and a peak.

use fixed::types::{I1F15, I2F30, I4F12, I4F28, I8F24, I16F16, U0F32};
use roughxel_core::ports::{
    BlockPort, BlockVector, HighlightIn, PeakIn, ReflectionIn, Shininess, StoredHorizon, StoredPeak, SurfaceIn,
    TextureIn,
};

include!(concat!(env!("OUT_DIR"), "/samples.rs"));

/// Light above, to the left, in front.
const LIGHT: BlockVector = BlockPort {
    mantissa: [I2F30::from_bits(-0x2000_0000), I2F30::from_bits(0x3000_0000), I2F30::from_bits(0x3800_0000)],
    exponent: 1,
};

/// A light on the surface of a fragment, m = 64.
pub const fn highlight(surface: SurfaceIn) -> HighlightIn {
    let shininess = Shininess { exponent: I16F16::from_bits(64 << 16), root: I8F24::from_bits(8 << 24) };
    HighlightIn { surface, light: LIGHT, shininess }
}

/// Light on a peak that leans to the right, with a horizon on all sides.
pub fn peak(surface: SurfaceIn) -> PeakIn {
    PeakIn {
        surface,
        light: LIGHT,
        weight: I16F16::ONE,
        peak: StoredPeak {
            normal: [I1F15::from_bits(0x1000), I1F15::from_bits(-0x0800), I1F15::from_bits(0x7ef0)],
            amplitude: 0x9000,
            exponent: 0x8800,
        },
        horizon: StoredHorizon { low: [I4F12::from_bits(0x0200); 4], inverse_width: [0x7000; 4] },
    }
}
