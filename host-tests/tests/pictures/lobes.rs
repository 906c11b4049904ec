//! Wide lobes: smooth surfaces of uniform roughness under an environment of strong colours, against the mean over the reflections of their normals.
//!
//! Run with `--nocapture` to see the measured figures.

use glam::DVec3;
use rayon::prelude::*;
use roughxel_assets::Picture;
use roughxel_core::ports::BlockVector;
use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_frame::raster::{Projection, SUBPIXELS, Sampling, TileRect, TileSamples, TriangleList, tiles};
use roughxel_host_tests::space::whole_or;
use roughxel_reference::cube::{direction_of, select};
use roughxel_reference::filter::{CubeMap, Map};
use roughxel_reference::linear::{add_scaled, norm, scaled};
use roughxel_reference::random::SplitMix64;
use roughxel_reference::{frame, reflect, sphere};
use roughxel_reference_renderer::RealPicture;
use roughxel_scene::Scene;
use roughxel_shader::Needs;

/// Texels along an edge of a face.
const EDGE: usize = 64;
/// Samples of a texel along each axis.
const FINE: usize = 4;

/// A sunset: blue above, brown below, a bright horizon, a sun of 4 × white, and patches half and one and a half times as bright.
fn sunset(d: DVec3, patches: &[f64]) -> [f64; 3] {
    let up = d.y;
    let ground = if up > 0.0 { [0.3, 0.45, 0.9].map(|c| c * (0.4 + 0.6 * up)) } else { [0.25, 0.18, 0.1] };
    let horizon = (-(up / 0.12).powi(2)).exp();
    let sun = 3.0 * ((d.dot(DVec3::new(0.6, 0.15, -0.78).normalize()) - 1.0) / 0.01).exp();
    let row = ((up.clamp(-1.0, 1.0).acos() / std::f64::consts::PI * 16.0) as usize).min(15);
    let column = (((d.x.atan2(-d.z) / std::f64::consts::TAU + 0.5) * 32.0) as usize).min(31);
    let patch = 0.5 + patches[32 * row + column];
    let (glow, light) = ([1.2, 0.5, 0.15], [1.0, 0.8, 0.5]);
    core::array::from_fn(|i| ((ground[i] + horizon * glow[i] + sun * light[i]) * patch).min(4.0))
}

/// Faces of the environment.
fn environment() -> [Picture; 6] {
    let mut random = SplitMix64::new(5);
    let patches: Vec<f64> = (0..512).map(|_| random.uniform(0.0, 1.0)).collect();
    let texel = |face: usize, index: usize| {
        let mut sum = [0.0; 3];
        for sample in 0..FINE * FINE {
            let place =
                |texel: usize, sample: usize| (2 * (texel * FINE + sample) + 1) as f64 / (EDGE * FINE) as f64 - 1.0;
            let (s, t) = (place(index % EDGE, sample % FINE), place(index / EDGE, sample / FINE));
            let direction = DVec3::from_array(direction_of(face, s, t)).normalize();
            sum = add_scaled(sum, 1.0 / (FINE * FINE) as f64, sunset(direction, &patches));
        }
        sum.map(|channel| channel as f32)
    };
    [0, 1, 2, 3, 4, 5].map(|face| Picture {
        width: EDGE as u32,
        height: EDGE as u32,
        pixels: (0..EDGE * EDGE).map(|index| texel(face, index)).collect(),
    })
}

/// A mirror of some shape with uniform roughness.
fn scene(shape: &str, along: f64, across: f64) -> Scene {
    let shape = match shape {
        "sphere" => "shape = \"sphere\"\nradius = 1.2\nsegments = [96, 48]\n",
        _ => "shape = \"plane\"\nsize = [60, 60]\nsegments = [4, 4]\n",
    };
    let text = format!(
        "[camera]\neye = [0, 1.5, 4]\ntarget = [0, 0, 0]\nfov_y = 40\nwidth = 64\nheight = 48\n\
         [background]\ntop = [0.5, 0.5, 0.5]\nbottom = [0.5, 0.5, 0.5]\n\
         [environment]\ngenerate = \"sky\"\nface_edge = {EDGE}\n\
         [[object]]\n{shape}\
         [object.material]\nframe = \"main-direction\"\nmain_direction = [0.3, 0.2, 1]\nreflectance = 1\n\
         roughness_map = {{ generate = \"uniform\", along = {along}, across = {across} }}\n"
    );
    let mut scene = Scene::from_toml("lobes", &text, std::path::Path::new("")).expect("the scene is valid");
    scene.environment.as_mut().expect("the scene has an environment").faces = environment();
    scene
}

fn real(v: BlockVector) -> [f64; 3] {
    v.mantissa.map(|m| f64::from(m.to_bits()) * 2_f64.powi(i32::from(v.exponent) - 30))
}

/// Samples of a pixel along each axis.
const SAMPLES: i32 = 4;
/// Normals of each sample.
const NORMALS: u32 = 256;

/// Mean over every pixel of the mean over normals n + ξ₁·d₁E₁ + ξ₂·d₃E₂, ξ normally distributed, of the base level bilinearly.
///
/// Each normal is a pair of the normal distribution's equally likely parts (a lattice of rank one, a different shift for every sample).
fn truth(scene: &Scene, [along, across]: [f64; 2]) -> RealPicture {
    let faces = &scene.environment.as_ref().expect("the scene has an environment").faces;
    let map = |face: &Picture| Map {
        width: EDGE,
        height: EDGE,
        texels: face.pixels.iter().map(|texel| texel.map(f64::from)).collect(),
    };
    let cube = CubeMap { faces: faces.each_ref().map(map) };
    let law = sphere::places(NORMALS);
    let projection = Projection::new(&scene.camera).expect("the camera is valid");
    let triangles = TriangleList::new(&projection, &scene.objects).expect("the triangles are valid");
    let main = scene.objects[0].material.main_direction.to_array();
    let needs = Needs { tangents: false, uv: false, duv: false };
    let shade = |x: i32, y: i32, triangle: u32, shift: usize| {
        let attributes = triangles.triangle(triangle, needs).expect("the triangle is visible").fragment(x, y);
        let (normal, view) = (real(attributes.normal), real(attributes.view));
        let [normal, view] = [normal, view].map(|v| scaled(1.0 / norm(&v), v));
        let axes = frame::frame(frame::FrameSystem::MainDirection, normal, [main, [0.0; 3]]);
        let mut mean = [0.0; 3];
        for index in 0..NORMALS as usize {
            // 157 is the Fibonacci-like generator for 256 points.
            let other = (index * 157 + shift) % NORMALS as usize;
            let facet = add_scaled(normal, along * law[index], axes.e1);
            let facet = add_scaled(facet, across * law[other], axes.e2);
            let light = cube.bilinear(&select(reflect::reflect(view, facet)));
            mean = add_scaled(mean, 1.0 / f64::from(NORMALS), light);
        }
        mean
    };
    let (width, height) = (projection.width(), projection.height());
    let mut pixels = vec![[0.0; 3]; (width * height) as usize];
    for tile in tiles(width, height) {
        let TileRect { x: left, y: top, width: columns, .. } = tile;
        let mut samples = TileSamples::default();
        let mut shaded: Vec<(usize, [f64; 3])> = Vec::new();
        for pass in (Sampling::Grid { edge: SAMPLES as u32 }).passes() {
            triangles.samples(tile, &pass, &mut samples);
            for (triangle, shown) in samples.by_triangle() {
                let colours = shown.par_iter().map(|&sample| {
                    let [x, y] = samples.position(sample);
                    let place = [x, y].map(|p| (p % SUBPIXELS * SAMPLES / SUBPIXELS) as usize);
                    let shift = 16 * (place[0] + SAMPLES as usize * place[1]) + 5 * place[1];
                    (samples.pixel(sample) as usize, triangle.map_or([0.5; 3], |triangle| shade(x, y, triangle, shift)))
                });
                shaded.par_extend(colours);
            }
        }
        for (pixel, colour) in shaded {
            let (x, y) = (left as usize + pixel % columns as usize, top as usize + pixel / columns as usize);
            let place = &mut pixels[y * width as usize + x];
            *place = add_scaled(*place, 1.0 / f64::from(SAMPLES * SAMPLES), colour);
        }
    }
    RealPicture { width, height, pixels }
}

/// Largest difference of a channel between neighbours that show only the object.
fn largest_jump(picture: &RealPicture, inside: &[bool]) -> f64 {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let mut largest = 0.0_f64;
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            let here = y * width + x;
            for there in [here + 1, here + width] {
                if inside[here] && inside[there] {
                    for i in 0..3 {
                        largest = largest.max((picture.pixels[here][i] - picture.pixels[there][i]).abs());
                    }
                }
            }
        }
    }
    largest
}

/// Pixels that show only the object.
fn inside(scene: &Scene) -> Vec<bool> {
    let projection = Projection::new(&scene.camera).expect("the camera is valid");
    let triangles = TriangleList::new(&projection, &scene.objects).expect("the triangles are valid");
    let (width, height) = (projection.width() as usize, projection.height() as usize);
    let mut hits = vec![0; width * height];
    for tile in tiles(width as u32, height as u32) {
        let mut samples = TileSamples::default();
        for pass in (Sampling::Grid { edge: 4 }).passes() {
            triangles.samples(tile, &pass, &mut samples);
            for &sample in samples.by_triangle().filter(|(triangle, _)| triangle.is_some()).flat_map(|shown| shown.1) {
                let (pixel, columns) = (samples.pixel(sample) as usize, tile.width as usize);
                hits[(tile.y as usize + pixel / columns) * width + tile.x as usize + pixel % columns] += 1;
            }
        }
    }
    hits.into_iter().map(|hits| hits == 16).collect()
}

/// Standard deviations of slopes, and the least PSNR on a plane and on a sphere.
const BARS: [(f64, [f64; 2]); 5] =
    [(0.05, [33.9, 36.5]), (0.1, [35.0, 38.5]), (0.25, [32.2, 35.7]), (0.5, [31.8, 33.9]), (1.0, [30.3, 30.3])];

/// Largest excess of the difference of neighbours over the truth's. It occurs at the last pixel before the silhouette of the sphere, and near the
/// horizon of the plane, where places of probes change from row to row. More than 16 probes change neither.
const JUMP: f64 = 0.08;

#[test]
fn wide_lobes_are_as_close_as_narrow_ones() {
    for (index, shape) in ["plane", "sphere"].into_iter().enumerate() {
        for (slope, bars) in whole_or(BARS.to_vec(), BARS[2..4].to_vec()) {
            for aspect in [1.0, 3.0] {
                let roughness = [slope, slope / aspect];
                let scene = scene(shape, roughness[0], roughness[1]);
                let (truth, inside) = (truth(&scene, roughness), inside(&scene));
                let prepared = Prepared::new(&scene, Mode::Footprint, &Precision::STANDARD);
                let frame = prepared.expect("the scene is valid").render(&|| ()).expect("the scene can be drawn");
                let drawn = RealPicture::from(&frame);
                let psnr = drawn.psnr(&truth);
                let [jump, of_truth] = [&drawn, &truth].map(|picture| largest_jump(picture, &inside));
                let name = format!("{shape}, slope {slope}, aspect {aspect}");
                println!("{name}: {psnr:.1} dB, jump {jump:.3} of {of_truth:.3}");
                assert!(psnr >= bars[index], "{name}: {psnr:.2} dB");
                assert!(jump <= of_truth + JUMP, "{name}: {jump:.3}, {of_truth:.3}");
            }
        }
    }
}
