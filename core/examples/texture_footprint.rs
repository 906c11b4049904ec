//! One footprint in a wrapped map: a pixel covers twice as many texels along v as along u.

use fixed::types::{I2F30, U0F32};
use roughxel_core::firmware::{Compact, Firmware};
use roughxel_core::plan::Effects;
use roughxel_core::ports::{BlockPair, TextureIn};

/// An empty plan: a footprint in a map needs no effect.
struct Ground;

impl Firmware for Ground {
    type Accuracy = Compact;
    const EFFECTS: Effects = Effects::NONE;
}

fn main() {
    // Once for a map of 512 × 256 texels: the only division.
    let map = Ground::texture([512, 256]);
    // In repeats of the map: one pixel to the right moves u by 1/128, one pixel down moves v by 1/32.
    let pair = |u: f32, v: f32, exponent| BlockPair { mantissa: [u, v].map(I2F30::from_num), exponent };
    let pixel = TextureIn { uv: [0.25, 0.75].map(U0F32::from_num), duv: [pair(0.5, 0.0, -6), pair(0.0, 0.5, -4)] };
    let footprint = Ground::texture_footprint(&pixel, &map);
    println!("{} probes at level {}", footprint.probes().len(), footprint.lod());
    for probe in footprint.probes() {
        println!("read u, v = {:?}, it counts {}", probe.uv, probe.weight);
    }
}
