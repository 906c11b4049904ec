//! The ground plane of [`reference::ground_plane`](crate::reference::ground_plane) through the integer texture path.

use fixed::types::{I2F30, U0F32};
use roughxel_assets::Picture;
use roughxel_core::fx::Fx;
use roughxel_core::ports::{BlockPair, Port, TextureIn};
use roughxel_core::precision::Precision;
use roughxel_core::scalar_api::texture_scale;
use roughxel_core::signals::TexturePosition;
use roughxel_frame::colour_map;
use roughxel_shader::{Batch, Colours, MapFootprints, Places, Shader};
use roughxel_simd::Backend;

use crate::reference::ground_plane::{GroundPixel, GroundReference, GroundTexture, HEIGHT, TEXTURE_EDGE, WIDTH};
use crate::reference::linear::normalise_exponent;

/// Figures of the ground plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundFigures {
    /// PSNR against the reference, dB.
    pub psnr: f64,
    /// Mean texels fetched for a pixel: 8 for each probe.
    pub texels: f64,
}

/// Draws the ground plane as the renderer samples a colour map: the footprint's block, then the filter on the integer pyramid.
pub fn ground_plane(texture: GroundTexture, reference: &GroundReference, profile: &Precision) -> GroundFigures {
    let map = colour_map(&picture(texture), true);
    let (shader, own) = (Shader::new(Backend::Scalar, profile), &[Fx::int(1); 3]);
    let scale = texture_scale([TEXTURE_EDGE as u16; 2]);
    let (mut probes, mut colours) = (0, Batch::default());
    let mut footprints = MapFootprints::new([&map.texels.map].into_iter(), None);
    let psnr = reference.psnr(|pixel| {
        let ports = ports(pixel);
        probes += ports.footprint(&scale, profile).probes.count.raw();
        footprints.make(shader, &Batch::from_iter([ports.duv.wires()]));
        let centres = &Batch::from_iter([TexturePosition { uv: ports.uv.wires() }]);
        let places = Places { centres, footprints: footprints.for_map(&map.texels.map) };
        Colours { places, map: &map, own }.run(shader, &mut colours);
        f64::from(colours.get(0).channels[0].raw()) / f64::from(1 << 24)
    });
    GroundFigures { psnr, texels: 8.0 * f64::from(probes) / f64::from(WIDTH * HEIGHT) }
}

/// The texture as a picture, whose rows start at the top.
fn picture(texture: GroundTexture) -> Picture {
    let map = texture.map();
    let rows = map.texels.chunks(map.width).rev().flatten();
    Picture { width: TEXTURE_EDGE, height: TEXTURE_EDGE, pixels: rows.map(|[grey]| [*grey as f32; 3]).collect() }
}

/// Coordinates and derivatives of a pixel, rounded to nearest on the ports.
fn ports(pixel: &GroundPixel) -> TextureIn {
    let turns = |u: f64| U0F32::from_bits(((u - u.floor()) * 2_f64.powi(32)) as u32);
    let pair = |derivative: [f64; 2]| {
        let (mantissa, exponent) = normalise_exponent(derivative);
        BlockPair { mantissa: mantissa.map(I2F30::from_num), exponent: exponent as i16 }
    };
    TextureIn { uv: pixel.uv.map(turns), duv: pixel.derivatives.map(pair) }
}
