//! The measurement: every knob alone, the named profiles, word widths and modes, each with its accuracy and its time on four clocks.
//!
//! A study is a list of units. Exact units (accuracy, gates, texels) run in parallel. Units that measure the time of the host run
//! one after the other, on one thread, with no other work of the study. Each finished unit is kept at once ([`Parts`]), so an
//! interrupted study continues from there.

mod parts;
mod results;

use std::collections::BTreeMap;
use std::time::Instant;

use rayon::prelude::*;
use roughxel_core::knob::Knob;
use roughxel_core::precision::{Precision, Profile};
use roughxel_f32_baseline::formulas::{Careful, Plain};
use roughxel_f32_baseline::math::{Micromath, Std};
use roughxel_frame::plan::Mode;
use roughxel_simd::Backend;
use serde::{Deserialize, Serialize};

use crate::accuracy::{self, Accuracy, FIGURES};
use crate::frames::{FrameFigures, Judge};
use crate::hardware::HardwareFigures;
use crate::host::{self, Machine, Pass, Rounds, TimedFragments, Timing};
use crate::stability::Float;
use crate::{StudyError, Subject, stability};

pub use parts::Parts;
pub use results::*;

/// Contents of a study, and its length.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// `quick` or `full`.
    pub name: String,
    /// Built-in scenes.
    pub scenes: Vec<String>,
    /// Pixels of a frame.
    pub size: [u32; 2],
    /// Samples along each edge of a pixel of the truth.
    pub samples_edge: u32,
    /// Random fragments of each point, and of a named profile.
    pub fragments: [u64; 2],
    /// Members of a family at each distance of a stability curve.
    pub members: u32,
    /// Rounds of the time of fragments.
    pub rounds: Rounds,
    /// Number of scenes whose frames are timed at every setting, the first of the list.
    pub timed_scenes: usize,
    /// Rounds of the time of frames.
    pub frame_rounds: Rounds,
}

impl Settings {
    /// A study within three minutes on two cores.
    pub fn quick() -> Self {
        Self {
            name: "quick".into(),
            scenes: ["lake", "zebra", "globe", "puzzle"].map(String::from).into(),
            size: [160, 120],
            samples_edge: 32,
            fragments: [20_000, 100_000],
            members: 16,
            rounds: Rounds { count: 9, least_ms: 3 },
            timed_scenes: 2,
            frame_rounds: Rounds { count: 5, least_ms: 1 },
        }
    }

    /// The study of `docs/performance.md`.
    pub fn full() -> Self {
        Self {
            name: "full".into(),
            size: [320, 240],
            fragments: [100_000, 1_000_000],
            members: 64,
            rounds: Rounds { count: 31, least_ms: 8 },
            frame_rounds: Rounds { count: 7, least_ms: 1 },
            ..Self::quick()
        }
    }
}

/// A setting of the knobs that is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// `standard`, or `fraction_bits=18`.
    pub name: String,
    /// The knob that differs from its [`base_of`], with its value.
    pub knob: Option<(Knob, u32)>,
    /// All knobs.
    pub precision: Precision,
}

/// The base of the measurement.
const BASE: Precision = Precision::STANDARD;

/// The base of a knob: `standard`. For seeds it is without the Newton step that doubles their good bits; with the step they
/// change frames by less than 0.3 dB.
pub fn base_of(knob: Knob) -> Precision {
    match knob {
        Knob::ReciprocalSeedBits => Knob::ReciprocalSteps.with(0, BASE),
        Knob::InverseRootSeedBits => Knob::InverseRootSteps.with(0, BASE),
        _ => BASE,
    }
}

/// The named profiles, narrowest first, then each knob alone from its [`base_of`], without settings that are in the list already.
pub fn settings() -> Vec<Setting> {
    let named =
        Profile::ALL.map(|profile| Setting { name: profile.name().into(), knob: None, precision: profile.precision() });
    let alone = Knob::ALL.into_iter().flat_map(|knob| {
        knob.values().iter().map(move |&value| Setting {
            name: format!("{knob}={}", knob.text(value)),
            knob: Some((knob, value)),
            precision: knob.with(value, base_of(knob)),
        })
    });
    let mut all = named.to_vec();
    for setting in alone {
        if all.iter().all(|known| known.precision != setting.precision) {
            all.push(setting);
        }
    }
    all
}

/// Modes that replace the footprints of a frame: name and mode.
const MODES: [(&str, Mode); 5] = [
    ("unfiltered", Mode::Unfiltered),
    ("trilinear", Mode::Isotropic),
    ("4 samples", Mode::Supersampled { edge: 2 }),
    ("16 samples", Mode::Supersampled { edge: 4 }),
    ("64 samples", Mode::Supersampled { edge: 8 }),
];

/// Steps of a progress bar: about a tenth of a second of the quick study each.
mod cost {
    pub(super) const TRUTH: u64 = 60;
    pub(super) const EXACT: u64 = 8;
    pub(super) const MODE: u64 = 8;
    pub(super) const FLOAT: u64 = 4;
    pub(super) const STABILITY: u64 = 100;
    pub(super) const HOST: u64 = 8;
    pub(super) const HOST_MODE: u64 = 20;
}

/// Steps of [`run`].
pub fn work(settings: &Settings, points: &[Setting]) -> u64 {
    let points = points.len() as u64;
    settings.scenes.len() as u64 * cost::TRUTH
        + points * (cost::EXACT + cost::HOST)
        + MODES.len() as u64 * (cost::MODE + cost::HOST_MODE)
        + FLOATS.len() as u64 * cost::FLOAT
        + cost::STABILITY
        + 3 * cost::HOST
}

/// Measures the parts of some [`settings`] that `parts` does not hold yet. `progress` is called with the name of the next unit
/// and the finished steps.
///
/// Errors: a scene that cannot be drawn, or parts that cannot be kept.
pub fn run(
    settings: &Settings,
    points: &[Setting],
    parts: &Parts,
    progress: &(dyn Fn(&str, u64) + Sync),
) -> Result<Study, StudyError> {
    let measurement = Measurement { settings, parts, progress };
    let judges = measurement.judges(points)?;
    let exact = points.par_iter().map(|setting| measurement.exact(setting, &judges)).collect::<Result<Vec<_>, _>>()?;
    let modes = MODES.par_iter().map(|mode| measurement.mode(*mode, &judges)).collect::<Result<Vec<_>, _>>()?;
    let floats = FLOATS.par_iter().map(|float| measurement.float(*float, &judges)).collect::<Result<Vec<_>, _>>()?;
    drop(judges);
    let stability =
        measurement.unit("stability", cost::STABILITY, || Ok(stability::measure(settings.members, &|| ())))?;
    let (points, modes, floats) = measurement.clocks(points, exact, modes, floats)?;
    Ok(Study {
        schema: SCHEMA.into(),
        machine: Machine::here(),
        settings: settings.clone(),
        seeds: "random fragments: SplitMix64 of the set's name `random` and the index; stability: of the case's name"
            .into(),
        points,
        modes,
        floats,
        stability,
    })
}

/// Estimate of a study's time on this machine, in words, from a small sample of its slowest parts.
///
/// Errors: those of a scene.
pub fn forecast(settings: &Settings) -> Result<String, StudyError> {
    const SIZES: [[u32; 2]; 2] = [[48, 36], [192, 144]];
    const EDGES: [u32; 2] = [2, 8];
    const FRAGMENTS: u64 = 16384;
    const TURNS: u32 = 3;
    // The fastest of several runs: the estimate uses differences, and the first run includes setup that all share.
    let seconds = |work: &dyn Fn() -> Result<(), StudyError>| -> Result<f64, StudyError> {
        (0..TURNS).try_fold(f64::INFINITY, |fastest, _| {
            let start = Instant::now();
            work()?;
            Ok(fastest.min(start.elapsed().as_secs_f64()))
        })
    };
    // Maps take the same time at every size: two sizes give the time of a pixel and of a sample.
    let count = |[width, height]: [u32; 2]| f64::from(width * height);
    let truth = |edge| seconds(&|| Judge::new("globe", SIZES[0], edge, &|| ()).map(|_| ()));
    let sample =
        (truth(EDGES[1])? - truth(EDGES[0])?) / (count(SIZES[0]) * f64::from(EDGES[1].pow(2) - EDGES[0].pow(2)));
    let frame = |size: [u32; 2]| {
        let judge = Judge::new("globe", size, 1, &|| ())?;
        seconds(&|| judge.frame(Mode::Footprint, &BASE).map(|_| ()))
    };
    let [small, large] = [frame(SIZES[0])?, frame(SIZES[1])?];
    let pixel = ((large - small) / (count(SIZES[1]) - count(SIZES[0]))).max(0.0);
    let maps = (small - pixel * count(SIZES[0])).max(0.0);
    let fragment = seconds(&|| {
        accuracy::measure(&BASE, FRAGMENTS, &|_| ());
        Ok(())
    })? / FRAGMENTS as f64;

    let (points, scenes) = (self::settings(), settings.scenes.len() as f64);
    let pixels = f64::from(settings.size[0] * settings.size[1]);
    let truth = scenes * pixels * f64::from(settings.samples_edge.pow(2)) * sample;
    let frames = scenes * (points.len() + MODES.len()) as f64 * (maps + pixels * pixel);
    let named = Profile::ALL.len() as u64;
    let fragments = named * settings.fragments[1] + (points.len() as u64 - named) * settings.fragments[0];
    // Each round has two sides; a frame of one thread in lanes takes about as long as one in float64 of all threads.
    let of_fragments = settings.rounds.count as f64 * 4e-3 * settings.rounds.least_ms as f64;
    let of_frames = settings.frame_rounds.count as f64 * 2.0 * settings.timed_scenes as f64 * pixels * pixel;
    let times = points.len() as f64 * (of_fragments + of_frames);
    let minutes = (truth + frames + fragments as f64 * fragment + times) / 60.0;
    Ok(format!(
        "{} settings of the knobs, {scenes} scenes of {}x{} pixels with {} samples a pixel as truth: about {:.0} minutes here. It may be \
         interrupted; the same command goes on.",
        points.len(),
        settings.size[0],
        settings.size[1],
        settings.samples_edge.pow(2),
        minutes.ceil()
    ))
}

/// Figures that do not depend on the machine.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Exact {
    stages: Vec<StageFigures>,
    wrong: [u64; 2],
    frames: Vec<FrameFigures>,
    hardware: Option<HardwareFigures>,
}

/// Figures of floats on fragments and frames.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct FloatExact {
    stages: Vec<StageFigures>,
    wrong: [u64; 2],
    /// PSNR against the filter of `standard` in float64, scene by scene.
    psnr: BTreeMap<String, Option<f64>>,
}

/// f32 by its formulas and libraries; `libm` gives the bits of the standard library.
const FLOATS: [(&str, Float); 3] =
    [("f32", Float::Careful), ("f32, plain formulas", Float::Plain), ("f32, micromath", Float::Micromath)];

/// Everything with its times.
type Found = (Vec<Point>, Vec<ModeFigures>, Vec<FloatFigures>);

struct Measurement<'a> {
    settings: &'a Settings,
    parts: &'a Parts,
    progress: &'a (dyn Fn(&str, u64) + Sync),
}

impl Measurement<'_> {
    /// A unit, taken from the parts, or measured and kept.
    fn unit<T: Serialize + for<'de> Deserialize<'de>>(
        &self,
        key: &str,
        steps: u64,
        measure: impl FnOnce() -> Result<T, StudyError>,
    ) -> Result<T, StudyError> {
        let value = match self.parts.get(key) {
            Some(value) => value,
            None => {
                (self.progress)(key, 0);
                let value = measure()?;
                self.parts.keep(key, &value)?;
                value
            }
        };
        (self.progress)(key, steps);
        Ok(value)
    }

    /// The scenes with their truth; none if every frame is already judged.
    fn judges(&self, points: &[Setting]) -> Result<Vec<Judge>, StudyError> {
        let mut keys = points
            .iter()
            .map(exact_key)
            .chain(MODES.map(|(name, _)| mode_key(name)))
            .chain(FLOATS.map(|(name, _)| float_key(name)));
        if keys.all(|key| self.parts.has(&key)) {
            (self.progress)("frames", cost::TRUTH * self.settings.scenes.len() as u64);
            return Ok(Vec::new());
        }
        let draw = |name: &String| {
            let what = format!("{name}: {} samples a pixel", self.settings.samples_edge.pow(2));
            (self.progress)(&what, 0);
            let judge = Judge::new(name, self.settings.size, self.settings.samples_edge, &|| ())?;
            (self.progress)(&what, cost::TRUTH);
            Ok(judge)
        };
        self.settings.scenes.iter().map(draw).collect()
    }

    fn exact(&self, setting: &Setting, judges: &[Judge]) -> Result<Exact, StudyError> {
        self.unit(&exact_key(setting), cost::EXACT, || {
            let p = &setting.precision;
            let [alone, named] = self.settings.fragments;
            let fragments = if setting.knob.is_some() { alone } else { named };
            let accuracy = accuracy::measure(p, fragments, &|_| ());
            let frames = judges.iter().map(|judge| Ok(judge.frame(Mode::Footprint, p)?.1));
            Ok(Exact {
                stages: stage_figures(&accuracy),
                wrong: [accuracy.wrong_faces, accuracy.wrong_counts],
                frames: frames.collect::<Result<_, StudyError>>()?,
                hardware: HardwareFigures::estimate(p),
            })
        })
    }

    fn mode(&self, (name, mode): (&str, Mode), judges: &[Judge]) -> Result<Vec<FrameFigures>, StudyError> {
        self.unit(&mode_key(name), cost::MODE, || judges.iter().map(|judge| Ok(judge.frame(mode, &BASE)?.1)).collect())
    }

    fn float(&self, (name, float): (&str, Float), judges: &[Judge]) -> Result<FloatExact, StudyError> {
        self.unit(&float_key(name), cost::FLOAT, || {
            let [_, fragments] = self.settings.fragments;
            let accuracy = match float {
                Float::Careful => accuracy::measure_float::<Std, Careful>(fragments, &|_| ()),
                Float::Plain => accuracy::measure_float::<Std, Plain>(fragments, &|_| ()),
                Float::Micromath => accuracy::measure_float::<Micromath, Careful>(fragments, &|_| ()),
            };
            let psnr = judges.iter().map(|judge| Ok((judge.scene().name.clone(), judge.float(&float)?)));
            Ok(FloatExact {
                stages: stage_figures(&accuracy),
                wrong: [accuracy.wrong_faces, accuracy.wrong_counts],
                psnr: psnr.collect::<Result<_, StudyError>>()?,
            })
        })
    }

    /// The clocks of the host, one after the other on one thread, and everything with its clocks.
    fn clocks(
        &self,
        settings: &[Setting],
        exact: Vec<Exact>,
        modes: Vec<Vec<FrameFigures>>,
        floats: Vec<FloatExact>,
    ) -> Result<Found, StudyError> {
        let timed = TimedFragments::new()?;
        let [width, height] = self.settings.size;
        let open = |name: &String| Subject::open(name, self.settings.size);
        let scenes = self.settings.scenes.iter().map(open).collect::<Result<Vec<_>, _>>()?;
        let pixels = width as usize * height as usize;
        let (lanes, rounds) = (Backend::best(), self.settings.rounds);
        let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;

        let frames = |count: usize,
                      mode,
                      p: &Precision,
                      backend: Backend|
         -> Result<BTreeMap<String, Timing>, StudyError> {
            let time = |(name, scene): (&String, &Subject)| {
                let drawn = scene.prepare(mode, p)?.with_backend(backend);
                let base = scene.prepare(Mode::Footprint, &BASE)?.with_backend(backend);
                let timing = one_thread.install(|| {
                    host::time(&mut host::frame(&drawn), &mut host::frame(&base), pixels, self.settings.frame_rounds)
                });
                Ok((name.clone(), timing))
            };
            self.settings.scenes.iter().zip(&scenes).take(count).map(time).collect()
        };
        let fragments = |pass: &mut Pass<'_>, base: &mut Pass<'_>| host::time(pass, base, timed.fragments(), rounds);

        let mut points = Vec::new();
        for (setting, exact) in settings.iter().zip(exact) {
            let p = &setting.precision;
            let host = self.unit(&format!("time of {}", setting.name), cost::HOST, || {
                let time = |backend| fragments(&mut timed.integers(backend, p), &mut timed.integers(backend, &BASE));
                Ok(HostFigures {
                    scalar: time(Backend::Scalar),
                    lanes: time(lanes),
                    frames: frames(self.settings.timed_scenes, Mode::Footprint, p, lanes)?,
                    // A knob changes the scalar backend of a frame in the same way as that of its fragments.
                    scalar_frames: if setting.knob.is_none() {
                        frames(self.settings.timed_scenes, Mode::Footprint, p, Backend::Scalar)?
                    } else {
                        BTreeMap::new()
                    },
                })
            })?;
            points.push(Point::new(setting, exact.stages, exact.wrong, exact.frames, exact.hardware, host));
        }
        let mut drawn = Vec::new();
        for ((name, mode), judged) in MODES.iter().zip(modes) {
            let times =
                self.unit(&format!("time of {name}"), cost::HOST_MODE, || frames(scenes.len(), *mode, &BASE, lanes))?;
            drawn.push(ModeFigures { name: (*name).into(), frames: judged, times });
        }
        let mut rows = Vec::new();
        for ((name, _), FloatExact { stages, wrong, psnr }) in FLOATS.into_iter().zip(floats) {
            rows.push(FloatFigures { name: name.into(), stages, wrong, psnr, host: None });
        }
        let contenders: [(&str, Pass<'_>); 3] =
            [("f32", timed.float32()), ("f32, batched", timed.float32_batched()), ("float64", timed.float64())];
        for (name, mut pass) in contenders {
            let timing = self.unit(&format!("time of {name}"), cost::HOST, || {
                Ok(fragments(&mut pass, &mut timed.integers(lanes, &BASE)))
            })?;
            if let Some(row) = rows.iter_mut().find(|row| row.name == name) {
                row.host = Some(timing);
                continue;
            }
            // Batches give the same numbers; float64 is the reference of all others.
            let same = rows.iter().find(|row| row.name == "f32").filter(|_| name != "float64");
            let of = |row: &FloatFigures| FloatFigures { name: name.into(), ..row.clone() };
            let nothing = || FloatFigures {
                name: name.into(),
                stages: Vec::new(),
                wrong: [0; 2],
                psnr: BTreeMap::new(),
                host: None,
            };
            rows.push(FloatFigures { host: Some(timing), ..same.map_or_else(nothing, of) });
        }
        Ok((points, drawn, rows))
    }
}

fn exact_key(setting: &Setting) -> String {
    format!("accuracy of {}", setting.name)
}

fn float_key(name: &str) -> String {
    format!("accuracy of {name}")
}

fn mode_key(name: &str) -> String {
    format!("frames of {name}")
}

fn stage_figures(accuracy: &Accuracy) -> Vec<StageFigures> {
    let finite = |error: f64| error.is_finite().then_some(error);
    let figure = |(figure, name): (accuracy::Figure, &str)| {
        let worst = accuracy.worst(figure)?;
        Some(StageFigures {
            figure: name.into(),
            worst: finite(worst.error),
            worst_fragment: format!("{} #{}", worst.set, worst.index),
            mean: accuracy.mean(figure).and_then(finite),
            // A bin ends above the errors in it.
            nearly_all: accuracy.nearly_all(figure).map(|error| error.min(worst.error)).and_then(finite),
        })
    };
    FIGURES.into_iter().filter_map(figure).collect()
}
