//! A tile of a picture: 64 × 64 pixels of a bumpy, curved triangle under a sky, all effects on. Its hash is the same on every machine.
//!
//! Corners come from `glam` and `micromath`, once per triangle; everything else is integers. The host draws the same tile with the backends of the
//! emulator (`host-tests/tests/datapath/tile.rs`).

use fixed::types::{I4F28, I8F24};
use glam::{Mat3, Vec3};
use micromath::F32Ext;
use roughxel_core::firmware::{Accuracy, Firmware};
use roughxel_core::plan::Effects;
use roughxel_core::ports::{BlockPair, BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::{Precision, Profile};
use roughxel_core::sampler::{Cube, CubeMemory};
pub use roughxel_core::scanline::Attributes;
use roughxel_core::scanline::{Fragment, Fragments, ScreenVertex, Triangle};
use roughxel_core::setup::block_vector;

/// Edge of the tile in pixels.
pub const EDGE: i32 = 64;
/// Edge of a face of the sky in texels.
pub const SKY_EDGE: u16 = 64;
/// Hashes of the tile in each profile.
pub const HASHES: [(Profile, u32); 5] = [
    (Profile::Narrow, 0x6a0e_8552),
    (Profile::Paper, 0xd861_9064),
    (Profile::Compact, 0xfca8_5995),
    (Profile::Standard, 0x8517_fbc0),
    (Profile::Precise, 0xdfd6_ee3b),
];

/// The sky: a checkerboard of eight cells along the edge of each face, darker downwards; grey if a cell is smaller than a texel.
#[derive(Clone, Copy, Debug)]
pub struct Sky;

impl CubeMemory for Sky {
    fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3] {
        // Levels from the third up have 16 texels along an edge.
        let [column, row] = [column, row].map(|index| index << level.min(2));
        let shade = 0x4000 + (row << 8);
        let checker = match level {
            0..=3 => (((column >> 3) + (row >> 3)) & 1) * 0x8000,
            _ => 0x4000,
        };
        let code = |tint: u32| (shade.wrapping_sub((shade * tint) >> 4) + checker).min(0xffff) as u16;
        [code(face), code(5 - face), code(face & 1)]
    }
}

/// The triangle of the tile: corners in the space of the camera, which looks along −z, and the values that all of its fragments share.
pub fn corners() -> ([ScreenVertex; 3], Attributes, ReflectionIn) {
    const FOCUS: f32 = 80.0;
    // Tilted away from the camera, so that its far corner is three times as far away as the near ones.
    let (sin, cos) = F32Ext::sin_cos(-0.9_f32);
    let tilt = Mat3::from_cols(Vec3::X, Vec3::new(0.0, cos, sin), Vec3::new(0.0, -sin, cos));
    let plane = [Vec3::new(-1.6, -0.9, 0.0), Vec3::new(0.2, 2.2, 0.0), Vec3::new(1.5, -0.9, 0.0)];
    let place = plane.map(|corner| tilt * corner + Vec3::new(0.0, 0.1, -2.4));
    let precision = Precision::PRECISE;
    let port = |v: Vec3| block_vector(v.as_dvec3(), &precision);
    let vertices = place.map(|p| {
        let scale = FOCUS / -p.z;
        let pixel = |x: f32| ((x * scale + EDGE as f32 * 0.5) * 256.0) as i32;
        ScreenVertex { x: pixel(p.x), y: pixel(-p.y), inverse_w: (1.0e9 / -p.z) as u32 }
    });
    // Curved: normals lean outwards by a fifth of the corner's distance from the middle.
    let normal = plane.map(|corner| port(tilt * (Vec3::Z + corner * 0.2)));
    let uv = plane.map(|corner| {
        let BlockVector { mantissa: [u, v, _], exponent } = port(corner * 0.5);
        BlockPair { mantissa: [u, v], exponent }
    });
    let attributes =
        Attributes { normal, view: place.map(|p| port(-p)), main_direction: [port(tilt * Vec3::Y); 3], uv: Some(uv) };
    let template = ReflectionIn {
        surface: SurfaceIn { roughness: [0.05, 0.02, 0.03].map(I4F28::from_num), ..Default::default() },
        edge_texels: SKY_EDGE,
        ..Default::default()
    };
    (vertices, attributes, template)
}

/// Calls `pixel` with every fragment of the tile and its row, row by row.
pub fn fragments(mut pixel: impl FnMut(i32, &Fragment)) {
    let (vertices, attributes, template) = corners();
    let Some(triangle) = Triangle::new(&vertices) else { return };
    let fragments = Fragments::new(&triangle, &attributes, &template);
    for y in 0..EDGE {
        for mut fragment in fragments.row(y, 0..EDGE) {
            fragment.reflection.surface.offset = bump(fragment.x, y);
            pixel(y, &fragment);
        }
    }
}

/// Dents of eight pixels: offsets rise and fall along both axes, at most 1/4.
fn bump(x: i32, y: i32) -> [I4F28; 2] {
    [x, y].map(|place| I4F28::from_bits((((place & 7) << 1) - 7) << 23))
}

/// The surface of the tile.
struct Bumpy<A>(A);

impl<A: Accuracy> Firmware for Bumpy<A> {
    type Accuracy = A;
    const EFFECTS: Effects = Effects::ALL;
}

/// The hash of the tile: place and colour of each of its pixels.
pub fn shade<A: Accuracy>() -> Hash {
    let mut hash = Hash::default();
    let environment = Bumpy::<A>::environment(SKY_EDGE);
    let cube = Cube { memory: &Sky, edge: SKY_EDGE.into(), last_level: SKY_EDGE.ilog2(), exponent: 0 };
    fragments(|y, fragment| {
        let colour = Bumpy::<A>::reflect(&fragment.reflection, &environment).colour(&cube);
        [fragment.x, y].into_iter().chain(colour.map(I8F24::to_bits)).for_each(|part| hash.add(part));
    });
    hash
}

/// A hash of colours in the order in which they are added (FNV-1a, 32 bits).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hash(pub u32);

impl Default for Hash {
    fn default() -> Self {
        Self(0x811c_9dc5)
    }
}

impl Hash {
    /// Adds one integer, its bytes from the lowest up.
    pub fn add(&mut self, integer: i32) {
        for byte in integer.to_le_bytes() {
            self.0 = (self.0 ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    }
}
