//! Frames of scenes against float64: how far the datapath is from the same filter, from the filter of the default profile, and from
//! the truth, and what it reads of memory for that.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;
use roughxel_frame::Frame;
use roughxel_frame::plan::Mode;
use roughxel_reference_renderer::{self as reference_renderer, RealPicture};
use roughxel_scene::Scene;
use roughxel_scene::picture::{Picture, ssim};
use serde::{Deserialize, Serialize};

use crate::stability::Float;
use crate::{StudyError, Subject};

/// The filter that frames of every profile are compared with: that of the default one.
pub const FILTER: Precision = Precision::STANDARD;

/// What decides a frame in float64: numbers of probes, their weights, and the roughness that maps hold.
const FILTER_KNOBS: [Knob; 5] =
    [Knob::MaxProbes, Knob::ProbeRule, Knob::ProbeWeights, Knob::Roughness, Knob::RoughnessBits];

/// A scene with the pictures in float64 that its frames are judged by.
pub struct Judge {
    subject: Subject,
    truth: RealPicture,
    truth_shown: Picture,
    filtered: Mutex<HashMap<[u32; FILTER_KNOBS.len()], Arc<RealPicture>>>,
}

/// Figures of one frame. PSNR in dB of linear light, all channels, colours cut to [0, 1]; `None` for equal pictures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrameFigures {
    /// Name of the scene.
    pub scene: String,
    /// PSNR against the same filter in float64: what rounding costs; `None` of modes without footprints, too.
    pub psnr_same: Option<f64>,
    /// PSNR against the filter of `standard` in float64: what rounding and a coarser filter cost.
    pub psnr_filter: Option<f64>,
    /// PSNR against 1024 samples a pixel of the unfiltered maps: what filtering costs, too.
    pub psnr_truth: Option<f64>,
    /// SSIM against them.
    pub ssim_truth: Option<f64>,
    /// Mean FLIP against them, 0 for equal pictures, at 67 pixels a degree; `None` in programs without the feature `flip`.
    pub flip_truth: Option<f64>,
    /// Texels read a pixel, those of each map and level by themselves.
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
        let key = FILTER_KNOBS.map(|knob| knob.of(p));
        // Two threads may draw the same: nobody waits for a picture that another draws.
        let known = self.filtered.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        if let Some(picture) = known {
            return Ok(picture);
        }
        let picture = Arc::new(reference_renderer::render(self.scene(), Mode::Footprint, p, &|| ())?);
        self.filtered.lock().unwrap_or_else(PoisonError::into_inner).insert(key, Arc::clone(&picture));
        Ok(picture)
    }

    /// PSNR of a frame with the footprints of f32, everything else in float64, against the filter of [`FILTER`], dB.
    pub fn float(&self, float: &Float) -> Result<Option<f64>, StudyError> {
        let drawn = reference_renderer::render_with(self.scene(), Mode::Footprint, &FILTER, float, &|| ())?;
        let psnr = drawn.psnr(self.filtered(&FILTER)?.as_ref());
        Ok(psnr.is_finite().then_some(psnr))
    }

    /// Draws a frame and judges it; a mode that does not filter with footprints has no same filter to be compared with.
    pub fn frame(&self, mode: Mode, p: &Precision) -> Result<(Frame, FrameFigures), StudyError> {
        let prepared = self.subject.prepare(mode, p)?;
        let (frame, counted) = prepared.render_counted(&|| ())?;
        let mut maps: Vec<_> = (0..self.scene().objects.len()).flat_map(|object| prepared.map_bytes(object)).collect();
        // Objects reflect one environment.
        maps.sort_unstable_by_key(|&(effect, bytes)| (effect.name(), bytes));
        maps.dedup_by_key(|(effect, bytes)| (effect.name(), *bytes));
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
            map_bytes: maps.iter().map(|(_, bytes)| bytes).sum(),
            digest: frame.digest(),
        };
        Ok((frame, figures))
    }
}

/// Mean FLIP of two pictures of one size (Andersson et al. 2020).
#[cfg(feature = "flip")]
fn flip(picture: &Picture, truth: &Picture) -> Option<f64> {
    use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};
    use roughxel_scene::picture::linear_to_srgb8;

    let image = |picture: &Picture| {
        let codes: Vec<u8> = picture.pixels.iter().flatten().map(|&channel| linear_to_srgb8(channel)).collect();
        FlipImageRgb8::with_data(picture.width, picture.height, &codes)
    };
    let errors = nv_flip::flip(image(truth), image(picture), DEFAULT_PIXELS_PER_DEGREE);
    Some(FlipPool::from_image(&errors).mean().into())
}

/// It wants a C++ compiler, so it is a feature.
#[cfg(not(feature = "flip"))]
fn flip(_: &Picture, _: &Picture) -> Option<f64> {
    None
}
