//! Cost of a precision, and accuracy of the frames of some scenes with it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;
use std::time::{Duration, Instant};

use roughxel_core::design::Design;
use roughxel_core::knob::Knob;
use roughxel_core::plan::Effects;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_frame::raster::RasterError;
use roughxel_reference_renderer::RealPicture;
use roughxel_shader::ObjectPlan;

use crate::Subject;
use crate::choose::{Clock, Meter};
use crate::hardware;
use crate::plan::{census, fetches, time_ratio};
use crate::soft_core::Machine;

/// Least time that each side of a comparison of frames takes.
const FRAME_TIME: Duration = Duration::from_millis(50);

/// Reference of a comparison of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// Frames of the same filter in float64, with the probes of `standard`: shows the effect of integers.
    Filter,
    /// 1024 samples a pixel in float64: shows the effect of filter and integers.
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

/// A scene with the reference of its frames.
struct Measured<'a> {
    subject: &'a Subject,
    truth: RealPicture,
    standard: Prepared<'a>,
}

impl<'a> Measured<'a> {
    fn prepare(&self, p: &Precision) -> Result<Prepared<'a>, RasterError> {
        self.subject.prepare(Mode::Footprint, p)
    }
}

/// Figures of the frames in a precision, each of the worst scene.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seen {
    /// Texels of a pixel.
    texels: f64,
    /// PSNR against the truth, dB.
    psnr: f64,
}

/// Measures precisions by the frames of some scenes. The worst scene counts, in accuracy and on every clock.
///
/// - host: t(frame)/t(frame in `standard`), median of pairs drawn in turn; without unit.
/// - hardware: [`hardware::full_adders`] of every design that an object's fragments and fetches use, each once.
/// - softcore: clocks or instructions of a pixel on the [`Machine`]: a reflection with all effects, and its texels with their filter.
/// - memory: texels of a pixel.
pub struct FrameMeter<'a> {
    scenes: Vec<Measured<'a>>,
    /// Plans of the objects of all scenes, each once; true if the object reflects a bright environment.
    plans: Vec<(ObjectPlan, bool)>,
    /// Machine of the clock softcore.
    machine: Machine,
    /// Figures of every precision whose frames were drawn, by its knobs: the same frames give texels and PSNR.
    seen: RefCell<HashMap<[u32; Knob::ALL.len()], Seen>>,
    start: Instant,
}

impl<'a> FrameMeter<'a> {
    /// Draws the references of the frames; `progress` is called [`FrameMeter::work`] times.
    ///
    /// Errors: those of the cameras and the meshes.
    pub fn new(
        subjects: &'a [Subject],
        against: Against,
        machine: Machine,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Self, RasterError> {
        let (mut scenes, mut plans) = (Vec::new(), Vec::new());
        for subject in subjects {
            let truth =
                roughxel_reference_renderer::render(&subject.scene, against.mode(), &Precision::STANDARD, progress)?;
            let standard = subject.prepare(Mode::Footprint, &Precision::STANDARD)?;
            for plan in standard.plans() {
                let planned = (*plan, standard.has_bright_environment());
                if !plans.contains(&planned) {
                    plans.push(planned);
                }
            }
            scenes.push(Measured { subject, truth, standard });
        }
        Ok(Self { scenes, plans, machine, seen: RefCell::default(), start: Instant::now() })
    }

    /// Number of progress steps of [`FrameMeter::new`].
    pub fn work(subjects: &[Subject]) -> u64 {
        subjects.iter().map(|subject| roughxel_reference_renderer::work(&subject.scene)).sum()
    }

    fn seen(&self, p: &Precision) -> Result<Seen, RasterError> {
        let knobs = Knob::ALL.map(|knob| knob.value_in(p));
        if let Some(seen) = self.seen.borrow().get(&knobs) {
            return Ok(*seen);
        }
        let mut worst = Seen { texels: 0.0, psnr: f64::INFINITY };
        for scene in &self.scenes {
            let (frame, counted) = scene.prepare(p)?.render_counted(&|| ())?;
            worst.texels = worst.texels.max(counted.texels as f64 / frame.pixels.len() as f64);
            worst.psnr = worst.psnr.min(RealPicture::from(&frame).psnr(&scene.truth));
        }
        self.seen.borrow_mut().insert(knobs, worst);
        Ok(worst)
    }

    fn time(&self, p: &Precision) -> Result<f64, RasterError> {
        let ratio = |scene: &Measured<'_>| {
            time_ratio(&scene.prepare(p)?, &scene.standard, FRAME_TIME, &|| self.start.elapsed())
        };
        let mut all = self.scenes.iter().map(ratio);
        all.try_fold(0.0, |worst: f64, ratio| ratio.map(|ratio| worst.max(ratio)))
    }
}

/// Four texels on each of two levels.
const TEXELS_OF_A_PROBE: f64 = 8.0;

impl Meter for FrameMeter<'_> {
    fn cost(&self, clock: Clock, p: &Precision) -> Option<f64> {
        match clock {
            Clock::Host => self.time(p).ok(),
            Clock::Hardware => self.plans.iter().map(|planned| full_adders(planned, p)).max().map(|bits| bits as f64),
            Clock::SoftCore => {
                // Settings with fewer probes were not priced; they take at most 2 % less (`max_probes` in knobs.json).
                let priced = Precision { max_probes: Precision::STANDARD.max_probes, ..*p };
                let (fragment, probe) = (self.machine.fragment(&priced)?, self.machine.probe(p)?);
                Some(fragment + self.seen(p).ok()?.texels / TEXELS_OF_A_PROBE * probe)
            }
            Clock::Memory => self.seen(p).ok().map(|seen| seen.texels),
        }
    }

    fn psnr(&self, p: &Precision) -> f64 {
        // Errors of camera and meshes do not depend on the precision: `new` has passed, so none is left.
        self.seen(p).map_or(f64::NAN, |seen| seen.psnr)
    }
}

/// Full adders of every design that an object uses.
fn full_adders((plan, is_bright): &(ObjectPlan, bool), p: &Precision) -> u64 {
    let datapath = |(datapath, effects): (_, Effects)| {
        let roughness = if effects.roughness == RoughnessKind::None { RoughnessKind::None } else { p.roughness };
        (Design::for_datapath(datapath), Effects { roughness, ..effects })
    };
    let fetches = fetches(plan, *is_bright).into_iter().map(|design| (design, Effects::NONE));
    let designs = plan.datapaths().map(datapath).chain(fetches);
    designs.map(|(design, effects)| hardware::full_adders(&census(design, &effects, p).1.total)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_told_texels_tell_their_psnr_too() {
        let subjects = [Subject::open("lake", [24, 18]).expect("the built-in scene is valid")];
        let meter = FrameMeter::new(&subjects, Against::Filter, Machine::default(), &|| ())
            .expect("the built-in scene is valid");
        let (drawn, narrow) = (|| meter.seen.borrow().len(), Precision::NARROW);
        let texels = meter.cost(Clock::Memory, &narrow).expect("frames give texels");
        let frame = meter.scenes[0].prepare(&narrow).and_then(|prepared| prepared.render_counted(&|| ()));
        let (frame, counted) = frame.expect("the frame can be drawn");
        assert_eq!(texels, counted.texels as f64 / frame.pixels.len() as f64);
        assert_eq!(meter.psnr(&narrow), RealPicture::from(&frame).psnr(&meter.scenes[0].truth));
        assert!(meter.cost(Clock::SoftCore, &narrow) > Some(texels));
        assert_eq!(drawn(), 1);
        meter.psnr(&Precision { max_probes: 2, ..narrow });
        assert_eq!(drawn(), 2, "every knob counts");
    }
}
