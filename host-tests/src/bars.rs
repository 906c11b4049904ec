//! Picture bars: measured figures, the method, and the required values.
//!
//! PSNR is against a range of 1, linear light, all channels, colours clamped to [0, 1] as a display clamps them. The truth of a scene is its
//! float64 picture with `edge`² samples a pixel of the unfiltered maps ([`reference_renderer`]). The judged pictures are frames of the integer
//! datapath. Tests check the bars at reduced sizes; `picture-bars` prints them at full size.

mod environment;
mod golden;
mod ground;
mod real_scenes;
mod reflections;
mod world;

pub use environment::{CubeEdgeStep, cube_edge_step};
pub use golden::{GOLDEN_FRAMES, golden_frames};
pub use ground::{GroundFigures, ground_plane};
pub use real_scenes::{BEHIND_16_SAMPLES, RealScene, real_scenes};
pub use reflections::{
    LAW, ONE_LOBE, Pictures, ROUGH_PHOTOGRAPHS, ReflectionFigures, SUN, Shape, Sun, reflection_figures, suns,
};
pub use world::{Case, KEYS, Outcome, World};

use roughxel_core::precision::{Precision, Profile};
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_frame::raster::RasterError;
use roughxel_scene::Scene;
pub use roughxel_study::accuracy::{LIT_PEAK_BARS, ShadingBars, shading_bars};

use roughxel_reference_renderer::{self as reference_renderer, RealPicture};

/// Scenes whose frames are compared with float64.
pub const SCENES: [&str; 4] = ["lake", "zebra", "globe", "puzzle"];

/// Scenes that the filter has to draw better than 16 samples a pixel do.
pub const FILTERED_SCENES: [&str; 2] = ["lake", "zebra"];

/// Least PSNR of a frame against the same filter in float64, dB; `None` for the profile that has no bar.
pub fn arithmetic_bar(profile: &str) -> Option<f64> {
    match profile {
        "narrow" => Some(40.0),
        "compact" => Some(45.0),
        "standard" => Some(55.0),
        "precise" => Some(60.0),
        _ => None,
    }
}

/// Largest |error of f| of a highlight with exponent m over max(1, √m), if l and v are not nearly opposite. The error is in the angle between n_mod
/// and h, and the steepest slope of cos^m is 0.61·√m.
pub fn highlight_bar(profile: &str) -> Option<f64> {
    let column = Profile::NAMES.iter().position(|name| *name == profile)?;
    [-11, -13, -13, -17, -19].get(column).map(|&power| 2.0_f64.powi(power))
}

/// Least PSNR in dB of a highlight in one pixel by its ellipse, and the PSNR of averaged bumps (scenes, picture bars).
pub const ONE_PIXEL_BARS: [(&str, f64, f64); 4] =
    [("noise", 28.0, 7.0), ("corrugated", 21.0, 11.0), ("V-groove", 16.0, 10.0), ("hemispheres", 19.0, 13.0)];

/// Least gain of the footprint mode over the unfiltered one on [`FILTERED_SCENES`], dB.
pub const GAIN_BAR: f64 = 10.0;
/// Least PSNR of the ground plane, dB.
pub const GROUND_BAR: f64 = 35.0;
/// Most texels per pixel of the ground plane, two bilinear samples per probe.
pub const GROUND_TEXELS: f64 = 40.0;
/// Largest step across an edge of the cube as a share of the variation inside a face.
pub const CUBE_EDGE_BAR: f64 = 0.02;

/// One mode of every kind.
pub const MODES: [Mode; 4] = [Mode::Unfiltered, Mode::Isotropic, Mode::Footprint, Mode::Supersampled { edge: 2 }];

/// A plane and a ball of one material in front of the environment that they reflect, and the rest of the scene.
///
/// # Panics
/// If the material or the rest cannot be read.
pub fn two_shapes(environment: &str, rest: &str, material: &str) -> Scene {
    let text = format!(
        "[camera]\neye = [0, 1.5, 5]\ntarget = [0, 0.4, 0]\nfov_y = 35\nwidth = 96\nheight = 72\n\
         [environment]\ngenerate = \"{environment}\"\nface_edge = 64\n{rest}\
         [[object]]\nshape = \"plane\"\nsize = [6, 6]\nuv_repeat = [3, 3]\nmaterial = {{ {material} }}\n\
         [[object]]\nshape = \"sphere\"\nradius = 0.7\ntranslate = [0, 0.7, 0]\nmaterial = {{ {material} }}\n"
    );
    Scene::from_toml("two shapes", &text, std::path::Path::new("")).expect("the scene is valid")
}

/// A plane and a ball of rough mirror with two lobes each, which no built-in scene has.
pub fn two_lobes() -> Scene {
    let bumps = "height_map = { generate = \"waves\", size = 64, highest = 8, rms_slope = 0.2 }";
    two_shapes("zebra", "", &format!("reflectance = 0.7, two_lobes = true, {bumps}"))
}

/// Plane and ball of rough mirror with two lobes of the law of their map.
pub fn lobes_of_a_law() -> Scene {
    let bumps = "height_map = { generate = \"ripples\", size = 64, drops = 3, rms_slope = 0.2 }";
    two_shapes("zebra", "", &format!("reflectance = 0.7, bump_deviation = \"law\", {bumps}"))
}

/// Checks the logarithm of a found error against a bound, and the bound against the error: a bound that nothing approaches is not a measured one.
///
/// # Panics
/// If the logarithm is above the bound, or below it by `slack`.
#[track_caller]
pub fn holds(what: &str, found: f64, bound: f64, slack: f64) {
    let found = found.log2();
    println!("{what:24} 2^{found:.3}, bound 2^{bound:.3}");
    assert!(found <= bound && found > bound - slack, "{what}: 2^{found:.4}, bound 2^{bound:.3}");
}

/// PSNR in dB of a frame in a mode against the same filter in float64.
pub fn psnr_against_float(scene: &Scene, mode: Mode, profile: &Precision) -> Result<f64, RasterError> {
    let frame = Prepared::new(scene, mode, profile)?.render(&|| ())?;
    Ok(RealPicture::from(&frame).psnr(&reference_renderer::render(scene, mode, profile, &|| ())?))
}

/// PSNR in dB of the four ways to draw a scene, against its truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFigures {
    /// One sample a pixel.
    pub unfiltered: f64,
    /// One trilinear probe.
    pub isotropic: f64,
    /// Footprint assembly.
    pub footprint: f64,
    /// 16 samples a pixel on a regular grid.
    pub supersampled_16: f64,
}

impl SceneFigures {
    /// Footprint mode against the unfiltered one, dB.
    pub fn gain(&self) -> f64 {
        self.footprint - self.unfiltered
    }

    /// Returns true if the footprint mode is [`GAIN_BAR`] better than the unfiltered mode, and better than 16 samples.
    pub fn holds(&self) -> bool {
        self.gain() >= GAIN_BAR && self.footprint > self.supersampled_16
    }
}

/// Draws a scene in its modes and against `edge`² samples a pixel, 1…64 along an edge. `progress` is that of [`reference_renderer::render`], which
/// takes nearly all of the time.
pub fn scene_figures(
    scene: &Scene,
    profile: &Precision,
    edge: u32,
    progress: &(dyn Fn() + Sync),
) -> Result<SceneFigures, RasterError> {
    let truth = reference_renderer::render(scene, Mode::Supersampled { edge }, profile, progress)?;
    let psnr = |mode| -> Result<f64, RasterError> {
        Ok(RealPicture::from(&Prepared::new(scene, mode, profile)?.render(&|| ())?).psnr(&truth))
    };
    Ok(SceneFigures {
        unfiltered: psnr(Mode::Unfiltered)?,
        isotropic: psnr(Mode::Isotropic)?,
        footprint: psnr(Mode::Footprint)?,
        supersampled_16: psnr(Mode::Supersampled { edge: 4 })?,
    })
}
