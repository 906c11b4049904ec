//! Frames of scenes against float64: distance of the datapath from the same filter, from the filter of the default profile, and
//! from the truth, and the memory it reads.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use roughxel_assets::picture::{Picture, ssim};
use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;
use roughxel_frame::Frame;
use roughxel_frame::plan::Mode;
use roughxel_reference_renderer::{self as reference_renderer, RealPicture};
use roughxel_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::stability::Float;
use crate::{StudyError, Subject};

/// The filter that frames of every profile are compared with: that of the default profile.
pub const FILTER: Precision = Precision::STANDARD;

/// Knobs that change a frame in float64: probe counts, probe weights, and the roughness that maps store.
const FILTER_KNOBS: [Knob; 5] =
    [Knob::MaxProbes, Knob::ProbeRule, Knob::ProbeWeights, Knob::Roughness, Knob::RoughnessBits];

/// A scene with the float64 pictures that its frames are judged by.
pub struct Judge {
    subject: Subject,
    truth: RealPicture,
    truth_shown: Picture,
    filtered: Mutex<HashMap<[u32; FILTER_KNOBS.len()], Arc<RealPicture>>>,
}

/// Figures of one frame. PSNR in dB of linear light, all channels, colours clamped to [0, 1]; `None` for equal pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameFigures {
    /// Name of the scene.
    pub scene: String,
    /// PSNR against the same filter in float64: the cost of rounding; also `None` for modes without footprints.
    pub psnr_same: Option<f64>,
    /// PSNR against the filter of `standard` in float64: the cost of rounding and a coarser filter.
    pub psnr_filter: Option<f64>,
    /// PSNR against 1024 samples a pixel of the unfiltered maps: includes the cost of filtering.
    pub psnr_truth: Option<f64>,
    /// SSIM against the 1024 samples.
    pub ssim_truth: Option<f64>,
    /// Mean FLIP against the 1024 samples, 0 for equal pictures, at 67 pixels a degree; `None` in programs without the feature
    /// `flip`.
    pub flip_truth: Option<f64>,
    /// Texels read a pixel; each map and level counts separately.
    pub texels: f64,
    /// Bytes of the maps that the frame reads.
    pub map_bytes: u64,
    /// SHA-256 of the frame.
    pub digest: String,
}

impl Judge {
    /// Draws the truth of a built-in scene at a size, `edge`² samples a pixel.
    ///
    /// Errors: a scene that cannot be read or drawn.
    pub fn new(name: &str, size: [u32; 2], edge: u32, progress: &(dyn Fn() + Sync)) -> Result<Self, StudyError> {
        let subject = Subject::open(name, size)?;
        let truth = reference_renderer::render(&subject.scene, Mode::Supersampled { edge }, &FILTER, progress)?;
        let truth_shown = truth.picture();
        Ok(Self { subject, truth, truth_shown, filtered: Mutex::default() })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.subject.scene
    }

    /// The frame of the footprint mode in float64, with the filter of a profile.
    pub fn filtered(&self, p: &Precision) -> Result<Arc<RealPicture>, StudyError> {
        let key = FILTER_KNOBS.map(|knob| knob.value_in(p));
        // Two threads may draw the same picture, so neither waits for the other.
        let known = self.filtered.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        if let Some(picture) = known {
            return Ok(picture);
        }
        let picture = Arc::new(reference_renderer::render(self.scene(), Mode::Footprint, p, &|| ())?);
        self.filtered.lock().unwrap_or_else(PoisonError::into_inner).insert(key, Arc::clone(&picture));
        Ok(picture)
    }

    /// PSNR of a frame with f32 footprints and all else in float64, against the filter of [`FILTER`], dB.
    pub fn float(&self, float: &Float) -> Result<Option<f64>, StudyError> {
        let drawn = reference_renderer::render_with(self.scene(), Mode::Footprint, &FILTER, float, &|| ())?;
        let psnr = drawn.psnr(self.filtered(&FILTER)?.as_ref());
        Ok(psnr.is_finite().then_some(psnr))
    }

    /// Draws a frame and judges it. A mode without footprints has no same filter for comparison.
    pub fn frame(&self, mode: Mode, p: &Precision) -> Result<(Frame, FrameFigures), StudyError> {
        let prepared = self.subject.prepare(mode, p)?;
        let (frame, counted) = prepared.render_counted(&|| ())?;
        let drawn = RealPicture::from(&frame);
        let finite = |psnr: f64| psnr.is_finite().then_some(psnr);
        let footprint = mode == Mode::Footprint;
        let against = |p: &Precision| Ok::<_, StudyError>(finite(drawn.psnr(self.filtered(p)?.as_ref())));
        let figures = FrameFigures {
            scene: self.scene().name.clone(),
            psnr_same: if footprint { against(p)? } else { None },
            psnr_filter: against(&FILTER)?,
            psnr_truth: finite(drawn.psnr(&self.truth)),
            ssim_truth: ssim(&frame.picture(), &self.truth_shown),
            flip_truth: flip(&frame.picture(), &self.truth_shown),
            texels: counted.texels as f64 / frame.pixels.len() as f64,
            map_bytes: prepared.all_map_bytes(),
            digest: frame.digest(),
        };
        Ok((frame, figures))
    }
}

/// Mean FLIP of two pictures of one size (Andersson et al. 2020).
#[cfg(feature = "flip")]
fn flip(picture: &Picture, truth: &Picture) -> Option<f64> {
    use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};
    use roughxel_assets::picture::linear_to_srgb8;

    let image = |picture: &Picture| {
        let codes: Vec<u8> = picture.pixels.iter().flatten().map(|&channel| linear_to_srgb8(channel)).collect();
        FlipImageRgb8::with_data(picture.width, picture.height, &codes)
    };
    let errors = nv_flip::flip(image(truth), image(picture), DEFAULT_PIXELS_PER_DEGREE);
    Some(FlipPool::from_image(&errors).mean().into())
}

/// `None`: FLIP needs a C++ compiler, so it is a feature.
#[cfg(not(feature = "flip"))]
fn flip(_: &Picture, _: &Picture) -> Option<f64> {
    None
}
