//! Fragments of a triangle in integers: set-up, one row, the reflection datapath. Run: `cargo run -p roughxel-core --example scanline`

use fixed::types::{I2F30, I4F28};
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::scanline::{Attributes, Fragments, ScreenVertex, Triangle};

/// A vector in units of 1/16384; any unit serves.
fn vector(components: [i16; 3]) -> BlockVector {
    BlockVector { mantissa: components.map(|c| I2F30::from_bits(i32::from(c) << 16)), exponent: 0 }
}

fn main() {
    // Corners in 1/256 pixel, clockwise on the screen (y down). 1/w is in any unit: the second corner is twice as far away as the first.
    let corner = |x, y, inverse_w| ScreenVertex { x: x << 8, y: y << 8, inverse_w };
    let vertices = [corner(2, 1, 1 << 30), corner(26, 4, 1 << 29), corner(6, 20, 3 << 28)];
    let triangle = Triangle::new(&vertices).expect("seen from the front, within 4096 pixels");

    // A bent surface that faces the eye, and the vectors from its corners to the eye.
    let corners = Attributes {
        normal: [vector([-3000, -2000, 16000]), vector([4000, 0, 15900]), vector([0, 5000, 15600])],
        view: [vector([400, 300, 8000]), vector([-6000, 0, 16000]), vector([0, -3000, 10700])],
        main_direction: [vector([16000, 0, 0]); 3],
        uv: None,
    };
    // Inputs that all fragments share: an environment with 256 texels along a face edge, and a bump. A bump map would change the offset of each
    // fragment.
    let surface = SurfaceIn { offset: [I4F28::from_bits(1 << 24), I4F28::ZERO], ..Default::default() };
    let template = ReflectionIn { surface, edge_texels: 256, ..Default::default() };
    let fragments = Fragments::new(&triangle, &corners, &template);

    for fragment in fragments.row(8, 0..320) {
        let out = fragment.reflection.reflect(&ReflectionPlan::FULL, &Precision::STANDARD);
        println!("x {:2}: face {} at {:+.4?}, level {:.3}", fragment.x, out.face, out.st, out.lod);
    }
}
