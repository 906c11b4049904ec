//! Frames from formulas that fail.

use std::path::Path;

use roughxel_assets::Picture;
use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_reference_renderer::{render, render_with};
use roughxel_scene::Scene;

use super::float::Float;
use crate::StudyError;

/// A frame whose footprints come from formulas that fail.
#[derive(Clone, Debug, PartialEq)]
pub struct NaivePicture {
    /// Name of the hard case.
    pub case: String,
    /// Name of the scene.
    pub scene: String,
    /// Method of the footprints.
    pub method: String,
    /// A frame of the same filter on the footprints of float64, linear colours.
    pub truth: Picture,
    /// The frame, linear colours.
    pub picture: Picture,
    /// PSNR of the frame against the truth, dB.
    pub psnr: f64,
}

/// Hard case, name and text of the scenes where the plain formulas show.
const SCENES: [(&str, &str, &str); 2] = [
    ("rank_one_roughness", "facing", include_str!("scenes/facing.toml")),
    ("frame_pole", "pole", include_str!("scenes/pole.toml")),
];

/// The frames of `size` pixels in which the plain formulas of `f32` show, in `standard`.
///
/// Their scenes are made for this: the built-in scenes meet no degeneracy within 24 bits, and none is below 100 dB (80×60).
///
/// Errors: a size that no frame has.
pub fn pictures([width, height]: [u32; 2]) -> Result<Vec<NaivePicture>, StudyError> {
    let naive = |&(case, name, text): &(&str, &str, &str)| {
        let scene = Scene::from_toml(name, text, Path::new(""))?.with_size(width, height)?;
        let (mode, profile, float) = (Mode::Footprint, &Precision::STANDARD, Float::Plain);
        let truth = render(&scene, mode, profile, &|| ())?;
        let real = render_with(&scene, mode, profile, &float, &|| ())?;
        Ok(NaivePicture {
            case: case.to_owned(),
            scene: name.to_owned(),
            method: float.name().to_owned(),
            truth: truth.picture(),
            picture: real.picture(),
            psnr: real.psnr(&truth),
        })
    };
    SCENES.iter().map(naive).collect()
}

#[cfg(test)]
mod tests {
    use super::super::family::FAMILIES;
    use super::*;

    #[test]
    fn plain_formulas_show_and_careful_ones_do_not() {
        for naive in pictures([64, 48]).expect("the scenes are valid") {
            assert!(FAMILIES.iter().any(|family| family.name == naive.case), "{}", naive.case);
            assert!(naive.psnr < 20.0, "{}: {} dB", naive.scene, naive.psnr);
            let (_, name, text) = SCENES.iter().find(|(_, name, _)| *name == naive.scene).expect("a known scene");
            let scene = Scene::from_toml(name, text, Path::new("")).and_then(|scene| scene.with_size(64, 48));
            let scene = scene.expect("the scene is valid");
            let psnr = |float: Float| {
                let real = render_with(&scene, Mode::Footprint, &Precision::STANDARD, &float, &|| ());
                real.expect("the frame can be drawn")
                    .psnr(&render(&scene, Mode::Footprint, &Precision::STANDARD, &|| ()).expect("drawn"))
            };
            let [careful, micromath] = [Float::Careful, Float::Micromath].map(psnr);
            println!("{name}: plain {:.1} dB, careful {careful:.1}, micromath {micromath:.1}", naive.psnr);
            assert!(careful > 80.0 && micromath < careful, "{name}: {careful} dB, {micromath} dB");
        }
    }
}
