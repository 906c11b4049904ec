//! Scenes made of third-party photographs as heights and as normal maps, steeper and busier than the built-in scenes.

use std::path::Path;

use roughxel_scene::Scene;

use crate::photographs::{Photograph, normal_map, photograph};

/// A scene made of a photograph.
#[derive(Debug)]
pub struct RealScene {
    /// Name of the scene.
    pub name: &'static str,
    /// 64 × 48 pixels.
    pub scene: Scene,
}

/// Largest PSNR, in dB, by which 16 samples a pixel may be nearer to the truth than the filtered picture of a real scene.
pub const BEHIND_16_SAMPLES: f64 = 0.5;

/// Edge of the pieces of photographs, texels.
const EDGE: u32 = 128;

/// All real scenes; `None` without the photographs.
///
/// # Panics
/// As [`photograph`].
pub fn real_scenes() -> Option<Vec<RealScene>> {
    let maps = [
        normal_map("grass.png", EDGE, 2.0)?,
        photograph("brick.png", EDGE)?,
        photograph("gravel.png", EDGE)?,
        photograph("grass.png", EDGE)?,
    ];
    let [normals, bricks, gravel, grass] = maps.each_ref().map(|map: &Photograph| map.path().display().to_string());
    let mirror = "frame = \"main-direction\"\nmain_direction = [0, 0, -1]\nreflectance = 0.9\ncolour = [0, 0, 0]";
    let peaks = "colour = [0, 0, 0]\npeaks = { colour = [0.3, 0.3, 0.3], shadowing = true, exponent = 8 }";
    let heights = |path: &str, slope: f64| format!("height_map = {{ path = {path:?}, rms_slope = {slope} }}");
    let scene = |name: &'static str, shape: &str, material: &str| {
        let text = format!(
            "[camera]\neye = [0, 2.2, 6]\ntarget = [0, 0, -0.5]\nfov_y = 40\nwidth = 64\nheight = 48\n\
             [background]\ntop = [0.3, 0.35, 0.4]\nbottom = [0.1, 0.1, 0.1]\n\
             [[light]]\ndirection = [0.6, 0.5, -0.6]\n\
             [environment]\ngenerate = \"sky\"\nface_edge = 128\nsun = [4, 3.6, 3]\nradius_degrees = 4\n\
             [[object]]\n{shape}[object.material]\n{material}\n"
        );
        let scene = Scene::from_toml(name, &text, Path::new("")).expect("the scene is valid");
        RealScene { name, scene }
    };
    let plane = |repeat: u32| {
        format!("shape = \"plane\"\nsize = [60, 60]\nsegments = [30, 30]\nuv_repeat = [{repeat}, {repeat}]\n")
    };
    let knot = "shape = \"mesh\"\ngenerate = \"knot\"\nuv_repeat = [20, 2]\n";
    Some(vec![
        scene(
            "knot with a normal map of grass",
            knot,
            &format!("colour = [0, 0, 0]\nreflectance = 0.9\nnormal_map = {{ path = {normals:?} }}"),
        ),
        scene("plane of bricks", &plane(20), &format!("{mirror}\n{}", heights(&bricks, 0.2))),
        scene("plane of gravel", &plane(12), &format!("{mirror}\n{}", heights(&gravel, 0.8))),
        scene("peaks and shadows of gravel", &plane(12), &format!("{}\n{peaks}", heights(&gravel, 0.8))),
        scene("peaks and shadows of grass", &plane(20), &format!("{}\n{peaks}", heights(&grass, 0.4))),
    ])
}
