//! Results of a study, as in its JSON.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;
use roughxel_utilities::input::open_file;
use serde::{Deserialize, Serialize};

use super::{Setting, Settings};
use crate::StudyError;
use crate::frames::FrameFigures;
use crate::hardware::HardwareFigures;
use crate::host::{Machine, Timing};
use crate::soft_core;
use crate::stability::HardCase;

/// Value of `schema`.
pub const SCHEMA: &str = "roughxel-study-1";

/// A whole study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// [`SCHEMA`].
    pub schema: String,
    /// The host of the times.
    pub machine: Machine,
    /// Settings of the study.
    pub settings: Settings,
    /// Source of the random numbers.
    pub seeds: String,
    /// Each setting of the knobs.
    pub points: Vec<Point>,
    /// Frames without footprints, and with several samples.
    pub modes: Vec<ModeFigures>,
    /// Floats on the same fragments.
    pub floats: Vec<FloatFigures>,
    /// Errors near each degeneracy.
    pub stability: Vec<HardCase>,
}

/// Largest study that is read, bytes.
const MOST_BYTES: u64 = 1 << 26;

impl Study {
    /// Reads a study.
    ///
    /// Errors: a file that cannot be read, is not a regular file, has more than 64 MiB, or holds no study of this version.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let file = |source| StudyError::File { action: "read", path: path.to_path_buf(), source };
        let broken = |problem| StudyError::NoStudy { path: path.to_path_buf(), problem };
        let opened = open_file(path).map_err(file)?;
        let bytes = opened.metadata().map_err(file)?.len();
        if bytes > MOST_BYTES {
            return Err(broken(format!("it is {bytes} bytes long, more than {MOST_BYTES}")));
        }
        let mut text = String::new();
        opened.take(MOST_BYTES).read_to_string(&mut text).map_err(file)?;
        let study: Self = serde_json::from_str(&text).map_err(|error| broken(error.to_string()))?;
        if study.schema == SCHEMA {
            Ok(study)
        } else {
            Err(broken(format!("its schema is `{}`, this program reads `{SCHEMA}`", study.schema)))
        }
    }

    /// Number of times measured while other programs ran.
    pub fn loaded(&self) -> usize {
        let of_points = self.points.iter().flat_map(|point| {
            let HostFigures { scalar, lanes, frames, scalar_frames } = &point.host;
            [scalar, lanes].into_iter().chain(frames.values()).chain(scalar_frames.values())
        });
        let of_modes = self.modes.iter().flat_map(|mode| mode.times.values());
        let of_floats = self.floats.iter().filter_map(|float| float.host.as_ref());
        of_points.chain(of_modes).chain(of_floats).filter(|timing| timing.loaded).count()
    }
}

/// A setting of the knobs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Name of the profile, or `knob=value`.
    pub name: String,
    /// The knob that differs from its [`base_of`](super::base_of).
    pub knob: Option<String>,
    /// Its value.
    pub value: Option<u32>,
    /// Every knob as profile files have them.
    pub knobs: BTreeMap<String, String>,
    /// Errors of stages.
    pub stages: Vec<StageFigures>,
    /// Fragments on a wrong face, and with a wrong probe count, away from ties.
    pub wrong: [u64; 2],
    /// Frames of the scenes.
    pub frames: Vec<FrameFigures>,
    /// The reflection datapath in hardware; `None` if its ranges are not proven.
    pub hardware: Option<HardwareFigures>,
    /// Time on the host.
    pub host: HostFigures,
}

impl Point {
    /// A setting with its figures.
    pub(super) fn new(
        setting: &Setting,
        stages: Vec<StageFigures>,
        wrong: [u64; 2],
        frames: Vec<FrameFigures>,
        hardware: Option<HardwareFigures>,
        host: HostFigures,
    ) -> Self {
        let p = &setting.precision;
        let knob = |knob: Knob| (knob.name().into(), knob.text(knob.value_in(p)).to_string());
        Self {
            name: setting.name.clone(),
            knob: setting.knob.map(|(knob, _)| knob.name().into()),
            value: setting.knob.map(|(_, value)| value),
            knobs: Knob::ALL.into_iter().map(knob).collect(),
            stages,
            wrong,
            frames,
            hardware,
            host,
        }
    }

    /// Setting of the knobs; `None` if this program has not these knobs and values.
    pub fn precision(&self) -> Option<Precision> {
        Knob::ALL
            .into_iter()
            .try_fold(Precision::STANDARD, |p, knob| Some(knob.with(knob.read(self.knobs.get(knob.name())?)?, p)))
    }

    /// Cost of a fragment on a small processor, as this program knows it: a study does not measure it.
    pub fn cost_on(&self, machine: soft_core::Machine) -> Option<f64> {
        machine.fragment(&self.precision()?)
    }

    /// Errors of a stage.
    pub fn stage(&self, figure: &str) -> Option<&StageFigures> {
        self.stages.iter().find(|stage| stage.figure == figure)
    }

    /// A scene's frame.
    pub fn frame(&self, scene: &str) -> Option<&FrameFigures> {
        self.frames.iter().find(|frame| frame.scene == scene)
    }
}

/// Errors of one figure against float64 fed with the same port values; units are those of [`crate::accuracy::Figure`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageFigures {
    /// Name of the figure.
    pub figure: String,
    /// Worst error of random fragments and hard cases; `None` if it is not a number.
    pub worst: Option<f64>,
    /// The fragment with the worst error.
    pub worst_fragment: String,
    /// Mean error of the random fragments.
    pub mean: Option<f64>,
    /// Bound of 99.9 % of the random fragments.
    pub nearly_all: Option<f64>,
}

/// Time on the host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HostFigures {
    /// A fragment's reflection without fetches, scalar backend.
    pub scalar: Timing,
    /// A fragment's reflection without fetches, in lanes.
    pub lanes: Timing,
    /// A pixel of each scene's frame, in lanes.
    pub frames: BTreeMap<String, Timing>,
    /// A pixel of each scene's frame on the scalar backend, for named profiles.
    pub scalar_frames: BTreeMap<String, Timing>,
}

/// Frames of a mode without footprints, in `standard`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeFigures {
    /// Its name.
    pub name: String,
    /// Frames of the scenes.
    pub frames: Vec<FrameFigures>,
    /// A pixel of each scene's frame, in lanes, against one filtered with footprints.
    pub times: BTreeMap<String, Timing>,
}

/// The reflection datapath in floats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FloatFigures {
    /// `f32`, `f32, plain formulas`, `f32, micromath`, `f32, batched`, or `float64`.
    pub name: String,
    /// Errors of its stages, as far as it outputs them; empty for float64, which is the reference.
    pub stages: Vec<StageFigures>,
    /// Fragments on a wrong face, and with a wrong probe count, away from ties.
    pub wrong: [u64; 2],
    /// PSNR of frames with its own footprints and all else in float64, against the filter of `standard` in float64, dB.
    pub psnr: BTreeMap<String, Option<f64>>,
    /// Time of a fragment, against `standard` in lanes.
    pub host: Option<Timing>,
}
