//! Thumbnails of assets.

use std::path::Path;

use glam::DVec3;
use roughxel_assets::{Mesh, Picture};
use roughxel_core::precision::Profile;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_scene::Scene;
use roughxel_study::profile_file::NamedPrecision;

use super::super::failure::{Failure, scene_failure};

/// Longest edge of a thumbnail in pixels.
const EDGE: u32 = 512;

/// Picture of at most [`EDGE`] pixels an edge: means over whole texels. Values above 1 are white, values below 0 black.
pub(super) fn of_picture(picture: &Picture) -> Picture {
    let step = picture.width.max(picture.height).div_ceil(EDGE);
    let [width, height] = [picture.width, picture.height].map(|edge| edge.div_ceil(step));
    let mean = |x: u32, y: u32| {
        let (mut sum, mut count) = ([0.0f64; 3], 0.0);
        for row in y * step..((y + 1) * step).min(picture.height) {
            for column in x * step..((x + 1) * step).min(picture.width) {
                let pixel = picture.pixel(column, row);
                sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += f64::from(value));
                count += 1.0;
            }
        }
        sum.map(|sum| (sum / count) as f32)
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
    Picture { width, height, pixels }
}

/// A mesh as a mirror under the generated sky, from the front and a little above.
pub(super) fn of_mesh(mesh: Mesh) -> Result<Picture, Failure> {
    let positions = || mesh.vertices.iter().map(|vertex| vertex.position);
    let low = positions().fold(DVec3::INFINITY, DVec3::min);
    let high = positions().fold(DVec3::NEG_INFINITY, DVec3::max);
    let (centre, radius) = ((low + high) / 2.0, ((high - low).length() / 2.0).max(1e-3));
    let eye = centre + DVec3::new(0.3, 0.25, 1.0).normalize() * 3.1 * radius;
    let text = format!(
        "[camera]\neye = {:?}\ntarget = {:?}\nwidth = {EDGE}\nheight = {EDGE}\n[background]\ncolour = [0.2, 0.2, 0.2]\n\
         [environment]\ngenerate = \"sky\"\n[[object]]\nshape = \"plane\"\nmaterial = {{ reflectance = 0.9 }}\n",
        eye.to_array(),
        centre.to_array(),
    );
    let mut scene = Scene::from_toml("thumbnail", &text, Path::new("")).map_err(scene_failure)?;
    // The mesh takes the place of another shape: its file is read once.
    scene.objects.iter_mut().for_each(|object| object.mesh = mesh.clone());
    draw(&scene)
}

/// A scene, its longest edge [`EDGE`] pixels.
pub(super) fn of_scene(scene: Scene) -> Result<Picture, Failure> {
    let [width, height] = [scene.camera.width, scene.camera.height];
    let longest = width.max(height);
    let edge = |edge: u32| (u64::from(edge) * u64::from(EDGE)).div_ceil(u64::from(longest)) as u32;
    draw(&scene.with_size(edge(width), edge(height))?)
}

fn draw(scene: &Scene) -> Result<Picture, Failure> {
    let prepared = Prepared::new(scene, Mode::Footprint, &NamedPrecision::from(Profile::Standard).precision)?;
    let frame = prepared.render(&|| ())?;
    Ok(frame.picture())
}
