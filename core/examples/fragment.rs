//! One fragment: a bumpy mirror seen from straight above, and where it looks. Plan and accuracy are a type; no code of other effects is linked.

use fixed::types::{I2F30, I4F28};
use roughxel_core::firmware::{Firmware, Narrow};
use roughxel_core::plan::{Effects, FootprintKind};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};

/// Bumps and a footprint, on 16-bit words.
struct Mirror;

impl Firmware for Mirror {
    type Accuracy = Narrow;
    const EFFECTS: Effects = Effects { bump: true, footprint: FootprintKind::Face, ..Effects::NONE };
}

fn main() {
    // Three mantissas and one exponent: (x, y, z)·2^exponent, the largest in [½, 1].
    let vector = |x: f32, y: f32, z: f32, exponent| BlockVector { mantissa: [x, y, z].map(I2F30::from_num), exponent };
    let fragment = ReflectionIn {
        surface: SurfaceIn {
            normal: vector(0.0, 0.0, 0.5, 1),
            view: vector(0.0, 0.0, 0.75, 2),
            frame_vectors: [vector(0.0, 0.5, 0.0, 1), BlockVector::default()],
            offset: [I4F28::from_num(0.125), I4F28::ZERO],
            ..Default::default()
        },
        // One pixel to the right or down turns the view by 1/256.
        dview: [vector(-0.75, 0.0, 0.0, -6), vector(0.0, 0.75, 0.0, -6)],
        ..Default::default()
    };
    let environment = Mirror::environment(256);
    let footprint = Mirror::reflect(&fragment, &environment);
    println!("face {}, s and t {:?}, level {}", footprint.face(), footprint.st(), footprint.lod());
    for probe in footprint.probes() {
        println!("read face {} at {:?}, it counts {}", probe.face, probe.st, probe.weight);
    }
}
