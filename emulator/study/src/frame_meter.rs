//! What a precision costs, and how accurate the frames of some scenes are with it.

use std::fmt;
use std::str::FromStr;
use std::time::{Duration, Instant};

use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_frame::Prepared;
use roughxel_frame::plan::{Mode, ObjectPlan};
use roughxel_frame::raster::RasterError;
use roughxel_maps::peak_pyramid::ScenePeaks;
use roughxel_real_frame::RealPicture;
use roughxel_scene::Scene;

use crate::choose::{Clock, Meter};
use crate::hardware;
use crate::plan::{census, fetches, time_ratio};
use crate::soft_core;

/// Least time that each side of a comparison of frames takes.
const FRAME_TIME: Duration = Duration::from_millis(50);

/// What frames are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// The same filter in float64, with the probes of `standard`: what integers change.
    Filter,
    /// 1024 samples a pixel in float64: what filter and integers change.
    Samples,
}

impl Against {
    const fn mode(self) -> Mode {
        match self {
            Self::Filter => Mode::Footprint,
            Self::Samples => Mode::Supersampled { edge: 32 },
        }
    }
}

impl fmt::Display for Against {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Filter { "filter" } else { "samples" })
    }
}

impl FromStr for Against {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = [Self::Filter, Self::Samples].into_iter().find(|against| against.to_string() == text);
        named.ok_or_else(|| "frames are compared with filter or samples".into())
    }
}

/// A scene with the peaks of its maps.
#[derive(Debug)]
pub struct Subject {
    /// The scene.
    pub scene: Scene,
    /// Its peaks, with filters.
    pub peaks: ScenePeaks,
}

impl Subject {
    fn prepare(&self, p: &Precision) -> Result<Prepared<'_>, RasterError> {
        Prepared::with_peaks(&self.scene, Mode::Footprint, p, &self.peaks)
    }
}

/// A scene with what its frames are compared with.
struct Measured<'a> {
    subject: &'a Subject,
    truth: RealPicture,
    standard: Prepared<'a>,
}

/// Measures precisions by the frames of some scenes; of several the worst counts, in accuracy and on every clock.
///
/// - host: t(frame)/t(frame in `standard`), median of pairs drawn in turn; without unit.
/// - hardware: [`hardware::full_adders`] of all that an object's fragments and fetches go through, each design once.
/// - softcore: instructions of a pixel on riscv32imac: a reflection with all effects, and its texels with their filter.
/// - memory: texels of a pixel.
pub struct FrameMeter<'a> {
    scenes: Vec<Measured<'a>>,
    /// Of the objects of all scenes, each once.
    plans: Vec<ObjectPlan>,
    start: Instant,
}

impl<'a> FrameMeter<'a> {
    /// Draws what frames are compared with; `progress` is called [`FrameMeter::work`] times.
    ///
    /// Errors: those of the cameras and the meshes.
    pub fn new(subjects: &'a [Subject], against: Against, progress: &(dyn Fn() + Sync)) -> Result<Self, RasterError> {
        let (mut scenes, mut plans) = (Vec::new(), Vec::new());
        for subject in subjects {
            let truth = roughxel_real_frame::render(&subject.scene, against.mode(), &Precision::STANDARD, progress)?;
            let standard = subject.prepare(&Precision::STANDARD)?;
            for plan in standard.plans() {
                if !plans.contains(plan) {
                    plans.push(*plan);
                }
            }
            scenes.push(Measured { subject, truth, standard });
        }
        Ok(Self { scenes, plans, start: Instant::now() })
    }

    /// Number of progress steps of [`FrameMeter::new`].
    pub fn work(subjects: &[Subject]) -> u64 {
        subjects.iter().map(|subject| roughxel_real_frame::work(&subject.scene)).sum()
    }

    /// Texels of a pixel, of the scene that reads most.
    fn texels(&self, p: &Precision) -> Option<f64> {
        let read = |scene: &Measured<'_>| {
            let (frame, texels) = scene.subject.prepare(p)?.render_counted(&|| ())?;
            Ok::<_, RasterError>(texels as f64 / frame.pixels.len() as f64)
        };
        let mut all = self.scenes.iter().map(read);
        all.try_fold(0.0, |most: f64, texels| texels.map(|texels| most.max(texels))).ok()
    }

    fn time(&self, p: &Precision) -> Result<f64, RasterError> {
        let ratio = |scene: &Measured<'_>| {
            time_ratio(&scene.subject.prepare(p)?, &scene.standard, FRAME_TIME, &|| self.start.elapsed())
        };
        let mut all = self.scenes.iter().map(ratio);
        all.try_fold(0.0, |worst: f64, ratio| ratio.map(|ratio| worst.max(ratio)))
    }
}

/// The processor of the clock: the smallest with a multiplier.
const SOFT_CORE: &str = "riscv32imac";
/// Four of each of two levels.
const TEXELS_OF_A_PROBE: f64 = 8.0;

impl Meter for FrameMeter<'_> {
    fn cost(&self, clock: Clock, p: &Precision) -> Option<f64> {
        match clock {
            Clock::Host => self.time(p).ok(),
            Clock::Hardware => self.plans.iter().map(|plan| full_adders(plan, p)).max().map(|bits| bits as f64),
            Clock::SoftCore => {
                // What a setting takes with fewer probes was not priced: at most 2 % less (`max_probes` in knobs.json).
                let priced = Precision { max_probes: Precision::STANDARD.max_probes, ..*p };
                let price = soft_core::price(SOFT_CORE, &priced)?;
                let probe = soft_core::probe(SOFT_CORE, &Precision { fraction_bits: p.fraction_bits, ..priced })?;
                Some(price.instructions + self.texels(p)? / TEXELS_OF_A_PROBE * probe.with_texels)
            }
            Clock::Memory => self.texels(p),
        }
    }

    fn psnr(&self, p: &Precision) -> f64 {
        let psnr = |scene: &Measured<'_>| -> Result<f64, RasterError> {
            let frame = scene.subject.prepare(p)?.render(&|| ())?;
            Ok(RealPicture::from(&frame).psnr(&scene.truth))
        };
        let mut all = self.scenes.iter().map(psnr);
        let worst = all.try_fold(f64::INFINITY, |worst, psnr| psnr.map(|psnr| worst.min(psnr)));
        // What could be wrong with camera and meshes does not depend on a precision: `new` has been through it.
        worst.unwrap_or(f64::NAN)
    }
}

/// Full adders of all that an object goes through.
fn full_adders(plan: &ObjectPlan, p: &Precision) -> u64 {
    let datapath = |(datapath, effects): (_, Effects)| {
        let roughness = if effects.roughness == RoughnessKind::None { RoughnessKind::None } else { p.roughness };
        (Design::of(datapath), Effects { roughness, ..effects })
    };
    let fetches = fetches(plan).into_iter().map(|design| (design, Effects::NONE));
    let designs = plan.datapaths().map(datapath).chain(fetches);
    designs.map(|(design, effects)| hardware::full_adders(&census(design, &effects, p).1.total)).sum()
}
