//! A pixel from start to end: a footprint, its probes, eight filtered texels for each, from a memory that the program supplies.

use fixed::types::I2F30;
use roughxel_core::firmware::{Firmware, Standard};
use roughxel_core::plan::{Effects, FootprintKind};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::sampler::{Cube, CubeMemory};

/// A smooth mirror.
struct Mirror;

impl Firmware for Mirror {
    type Accuracy = Standard;
    const EFFECTS: Effects = Effects { footprint: FootprintKind::Face, ..Effects::NONE };
}

/// Six faces, each of its own grey. Anything that holds texels can be the memory.
struct Greys([u16; 6]);

impl CubeMemory for Greys {
    fn texel(&self, _level: u32, face: u32, _column: u32, _row: u32) -> [u16; 3] {
        [self.0[face as usize]; 3]
    }
}

fn main() {
    let vector = |x: f32, y: f32, z: f32| BlockVector { mantissa: [x, y, z].map(I2F30::from_num), exponent: 0 };
    // v leans by 45°, so r is on the edge between two faces.
    let surface = SurfaceIn { normal: vector(0.0, 0.0, 0.5), view: vector(0.5, 0.0, 0.5), ..Default::default() };
    let dview = [vector(0.01, 0.0, 0.0), vector(0.0, 0.01, 0.0)];
    let fragment = ReflectionIn { surface, dview, ..Default::default() };
    let greys = Greys([0x1000, 0x3000, 0x5000, 0x7000, 0x9000, 0xb000]);
    let cube = Cube { memory: &greys, edge: 64, last_level: 6, exponent: 0 };
    let colour = Mirror::reflect(&fragment, &Mirror::environment(64)).colour(&cube);
    println!("linear light {colour:?}");
}
