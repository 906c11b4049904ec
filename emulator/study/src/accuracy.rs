//! Accuracy of the integer datapath against the independent float64 reference, fed with the same port values.
//!
//! Reports and tests share one table of bars. For ill-conditioned inputs a bar has these meanings. *Face coordinates* count if
//! the reference is further than [`tie_margin`] from a tie of two faces; nearer to the tie either face is right. *Footprint*
//! figures are relative to λ₁, but to at least 1/[`CANCELLATION`] of the size of the terms before they cancel. dr is a difference
//! of products rounded to p bits, so its error is proportional to the terms, not to the rest that they leave.

use glam::DVec3;
use rayon::prelude::*;
use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::ports::{BlockVector, ReflectionIn, ReflectionOut, SurfaceIn};
use roughxel_core::precision::{Precision, ProbeRule, Profile, RoughnessKind};
use roughxel_core::setup::{real_number, real_offset, real_vector, scale_by_power_of_two};
use roughxel_core::status::StatusBit;
use roughxel_f32_baseline::formulas::Formulas;
use roughxel_f32_baseline::math::Math;
use roughxel_f32_baseline::{Environment, FloatFootprint, Fragment};
use roughxel_reference as reference;
use roughxel_reference::linear::{axis_angle, norm};

use roughxel_cases::{hard_case_sets, random_fragment};

use crate::distribution::Distribution;

/// Relative difference of the two largest components of r below which rounding decides the face: the bar of s and t, which are ±1
/// there, and at least 2^−12.
pub fn tie_margin(p: &Precision) -> f64 {
    2.0_f64.powi(4 - p.fraction_bits as i32).max(1.0 / 4096.0)
}

/// Ratio of a footprint's terms to their rest beyond which errors are judged against the terms.
pub const CANCELLATION: f64 = 16.0;

/// A figure of merit with a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// max(|Δs|, |Δt|).
    Coordinates,
    /// Largest of |E₁·E₂|/|n|², |E·n|/|n|² and | |E| − |n| |/|n| (systems 2 and 3).
    Frame,
    /// |Δλ₁|/λ₁.
    MajorAxis,
    /// |ΔLOD| after clamping to the map's levels.
    LevelOfDetail,
    /// Angle of the major axis, degrees, where λ₁/λ₂ ≥ 1.1.
    Direction,
    /// Angle between the reflected vectors, radians (it has no bar of its own; it is part of the coordinates).
    Reflected,
}

/// Every figure in pipeline order with its name.
pub const FIGURES: [(Figure, &str); 6] = [
    (Figure::Frame, "frame"),
    (Figure::Reflected, "reflected"),
    (Figure::Coordinates, "s, t"),
    (Figure::MajorAxis, "lambda1"),
    (Figure::Direction, "direction"),
    (Figure::LevelOfDetail, "lod"),
];

impl Figure {
    /// The bar of a named profile; `None` if a figure is reported only.
    pub fn bar(self, profile: &str) -> Option<f64> {
        let column = Profile::NAMES.iter().position(|name| *name == profile)?;
        let two = |power: i32| 2.0_f64.powi(power);
        let row = match self {
            Self::Coordinates => [two(-10), two(-12), two(-12), two(-15), two(-20)],
            Self::Frame => [two(-10), two(-12), two(-12), two(-16), two(-21)],
            Self::MajorAxis => [two(-6), two(-6), two(-6), two(-9), two(-12)],
            Self::LevelOfDetail => [two(-5), two(-4), two(-5), two(-8), two(-10)],
            Self::Direction => [1.0, 4.6, 1.0, 0.1, 0.02],
            Self::Reflected => return None,
        };
        row.get(column).copied()
    }

    const fn index(self) -> usize {
        self as usize
    }
}

/// Largest errors of a light on a peak in each profile. The first is log₂ of the error of its local half vector from the ports on
/// (tangent basis, half vector and local direction together), times the sine between n and h and times |l̂ + v̂|/2: factors that
/// measure how well the local direction and the half vector are defined. The second is log₂ of the error of its light at the
/// datapath's direction and visibility, as a share of the amplitude. In `narrow` a stored N loses its last place, 55·√3·2^−15.
/// Measured −12.3, −14.2, −18.1, −24.3 and −8.9, −15.8, −20.1, −21.0.
pub const LIT_PEAK_BARS: [[f64; 2]; 5] =
    [[-12.0, -8.5], [-14.0, -15.5], [-14.0, -15.5], [-18.0, -19.8], [-24.0, -20.6]];

/// Largest error of the light of a peak from the ports on, as a share of its amplitude, if h is perpendicular to n and l and v
/// are within 25° of the half vector. It adds the two errors of [`LIT_PEAK_BARS`], an angle multiplied by √(n/e), because a power
/// falls that steeply. It adds the length error of the stored normal, 2^−15 at most, which scales 1 − cos and so is multiplied by
/// n(1 − cos)·cosⁿ ≤ 1/e.
pub fn lit_peak_bar(profile: &str) -> Option<f64> {
    let column = Profile::NAMES.iter().position(|name| *name == profile)?;
    let steepest = (8192.0 / std::f64::consts::E).sqrt() / 25_f64.to_radians().cos();
    let stored_length = 2.0_f64.powi(-15) / std::f64::consts::E;
    LIT_PEAK_BARS.get(column).map(|[direction, light]| steepest * direction.exp2() + light.exp2() + stored_length)
}

/// Largest errors of peaks and horizons in one profile, against the reference fed with the same ports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingBars {
    /// Length of the error of a unit direction.
    pub direction: f64,
    /// Light of a peak with an exponent from 1 to 8192, as a share of its amplitude times its weight.
    pub peak: f64,
    /// Slope, as a share of max(1, |slope|).
    pub slope: f64,
    /// Visibility at the slopes that the datapath has.
    pub visibility: f64,
}

/// The bars of a profile; `None` for an unknown name.
///
/// The error of a peak is √(8192/e) = 55 times the angular error of its half vector, because a power falls that steeply (measured
/// 2^−9.6, 2^−13.6), plus the length error of its stored normal, 2^−15 at most, which is all that is left in `precise`. A
/// visibility is a product of four factors with 16 fraction bits.
pub fn shading_bars(profile: &str) -> Option<ShadingBars> {
    let bars = |[direction, peak, slope, visibility]: [f64; 4]| ShadingBars {
        direction: direction.exp2(),
        peak: peak.exp2(),
        slope: slope.exp2(),
        visibility: visibility.exp2(),
    };
    match profile {
        "narrow" => Some(bars([-11.5, -7.0, -10.5, -15.0])),
        "paper" | "compact" => Some(bars([-13.5, -9.0, -12.5, -15.0])),
        "standard" => Some(bars([-17.5, -13.0, -16.5, -15.0])),
        "precise" => Some(bars([-24.0, -14.5, -22.5, -15.0])),
        _ => None,
    }
}

/// The worst fragment of one figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// Error in the unit of the figure.
    pub error: f64,
    /// Set of the fragment.
    pub set: String,
    /// Index in the set.
    pub index: u64,
    /// The fragment.
    pub fragment: ReflectionIn,
}

/// Outputs of a datapath for one fragment, in real numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observed {
    /// E₁, E₂ in the unit of n, if the datapath outputs them.
    pub frame: Option<[DVec3; 2]>,
    /// r at any length, if the datapath outputs it.
    pub reflected: Option<[f64; 3]>,
    /// Face 0…5.
    pub face: usize,
    /// s, t.
    pub st: [f64; 2],
    /// λ₁ in half faces; `None` if the outputs do not determine it.
    pub major: Option<f64>,
    /// Along λ₁, at any length.
    pub direction: [f64; 2],
    /// N.
    pub probes: u32,
    /// Level of detail.
    pub lod: f64,
    /// True if the step was clamped.
    pub saturated: bool,
}

impl Observed {
    /// Reads the ports.
    fn from_ports(fragment: &ReflectionIn, got: &ReflectionOut) -> Self {
        let relative = |e: BlockVector| {
            real_vector(&BlockVector { exponent: e.exponent.saturating_sub(fragment.surface.normal.exponent), ..e })
        };
        Self {
            frame: Some(got.frame.map(relative)),
            reflected: Some(real_vector(&BlockVector { exponent: 0, ..got.reflected }).to_array()),
            face: got.face.into(),
            st: got.st.map(|x| f64::from(x.to_bits()) / f64::from(1 << 30)),
            major: Some(real_number(&got.major)),
            direction: got.direction.map(|x| f64::from(x.to_bits())),
            probes: got.probes.into(),
            lod: f64::from(got.lod.to_bits()) / 65536.0,
            saturated: got.status & StatusBit::FootprintSaturated.mask() != 0,
        }
    }

    /// Reads a footprint of f32.
    fn of_float(got: &FloatFootprint) -> Self {
        let step = got.step.to_array().map(f64::from);
        let saturated = got.status & StatusBit::FootprintSaturated.mask() != 0;
        Self {
            frame: None,
            reflected: None,
            face: got.face as usize,
            st: got.st.to_array().map(f64::from),
            // The step is 2√3 λ₁/N unless it was clamped.
            major: (!saturated).then(|| step[0].hypot(step[1]) * f64::from(got.probes) / 12_f64.sqrt()),
            direction: step,
            probes: got.probes,
            lod: f64::from(got.lod),
            saturated,
        }
    }
}

/// Errors of one profile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// The worst fragment of each figure, indexed like the enum; `None` before any fragment counted.
    worst: [Option<Worst>; FIGURES.len()],
    /// Number of fragments that counted for each figure.
    counted: [u64; FIGURES.len()],
    /// Errors of the random fragments alone: the number of hard cases in the sets is arbitrary.
    typical: [Distribution; FIGURES.len()],
    /// Fragments measured.
    pub fragments: u64,
    /// Fragments whose face differs from the reference's away from a tie.
    pub wrong_faces: u64,
    /// Fragments with a different probe count although λ₁/λ₂ is not within the error of a boundary.
    pub wrong_counts: u64,
}

impl Accuracy {
    /// The worst fragment of a figure.
    pub fn worst(&self, figure: Figure) -> Option<&Worst> {
        self.worst[figure.index()].as_ref()
    }

    /// Number of fragments that counted for a figure.
    pub fn counted(&self, figure: Figure) -> u64 {
        self.counted[figure.index()]
    }

    /// Mean error of the random fragments.
    pub fn mean(&self, figure: Figure) -> Option<f64> {
        self.typical[figure.index()].mean()
    }

    /// Bound of 99.9 % of the random fragments, to the next 32nd of an octave.
    pub fn nearly_all(&self, figure: Figure) -> Option<f64> {
        self.typical[figure.index()].quantile(0.999)
    }

    /// True if every bar of the named profile holds, with no wrong face and no wrong count.
    pub fn holds(&self, profile: &str) -> bool {
        let within = |(figure, _): &(Figure, &str)| match (figure.bar(profile), self.worst(*figure)) {
            (Some(bar), Some(worst)) => worst.error <= bar,
            _ => true,
        };
        FIGURES.iter().all(within) && self.wrong_faces == 0 && self.wrong_counts == 0
    }

    fn add(&mut self, set: &str, index: u64, fragment: &ReflectionIn, sample: &Sample) {
        self.fragments += 1;
        self.wrong_faces += u64::from(sample.wrong_face);
        self.wrong_counts += u64::from(sample.wrong_count);
        for (i, error) in sample.errors.into_iter().enumerate() {
            let Some(error) = error else { continue };
            let worst = &mut self.worst[i];
            self.counted[i] += 1;
            if set == RANDOM {
                self.typical[i].add(error);
            }
            // NaN counts as the worst error.
            if worst.as_ref().is_none_or(|worst| error.is_nan() || error > worst.error) {
                *worst = Some(Worst { error, set: set.to_owned(), index, fragment: *fragment });
            }
        }
    }

    /// Joins two measurements; equal errors keep the first.
    fn merge(mut self, other: Self) -> Self {
        for (mine, theirs) in self.worst.iter_mut().zip(other.worst) {
            let larger = match (&*mine, &theirs) {
                (Some(mine), Some(theirs)) => theirs.error.is_nan() || theirs.error > mine.error,
                (mine, _) => mine.is_none(),
            };
            if larger {
                *mine = theirs;
            }
        }
        for (mine, theirs) in self.counted.iter_mut().zip(other.counted) {
            *mine += theirs;
        }
        for (mine, theirs) in self.typical.iter_mut().zip(&other.typical) {
            mine.merge(theirs);
        }
        self.fragments += other.fragments;
        self.wrong_faces += other.wrong_faces;
        self.wrong_counts += other.wrong_counts;
        self
    }
}

/// Errors of one fragment; `None` if a figure does not apply.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    errors: [Option<f64>; FIGURES.len()],
    wrong_face: bool,
    wrong_count: bool,
}

/// Port values in the form that the reference takes. Units give n and v exponent 0: no result depends on the lengths of (n, dn)
/// and (v, dv), and squares must not overflow f64.
pub fn reference_inputs(fragment: &ReflectionIn) -> reference::Inputs {
    let relative = |vector: &BlockVector, to: &BlockVector| {
        let mantissa = real_vector(&BlockVector { exponent: 0, ..*vector });
        let exponent = i32::from(vector.exponent) - i32::from(to.exponent);
        mantissa.to_array().map(|x| scale_by_power_of_two(x, exponent))
    };
    let SurfaceIn { normal, view, .. } = &fragment.surface;
    reference::Inputs {
        normal: relative(normal, normal),
        view: relative(view, view),
        tangents: fragment.surface.frame_vectors.map(|t| real_vector(&t).to_array()),
        offset: fragment.surface.offset.map(real_offset),
        roughness: fragment.surface.roughness.map(real_offset),
        dview: fragment.dview.map(|d| relative(&d, view)),
        dnormal: fragment.dnormal.map(|d| relative(&d, normal)),
        edge_texels: u32::from(fragment.edge_texels.clamp(1, 16384)),
    }
}

/// The reference's options for a plan and a profile.
pub fn reference_options(plan: &ReflectionPlan, p: &Precision) -> reference::Options {
    reference::Options {
        frame: match plan.frame {
            FrameSystem::MainDirection => reference::frame::FrameSystem::MainDirection,
            FrameSystem::Natural => reference::frame::FrameSystem::Natural,
            FrameSystem::NaturalNormalised => reference::frame::FrameSystem::NaturalNormalised,
        },
        roughness: match plan.roughness {
            RoughnessKind::None => reference::Roughness::None,
            RoughnessKind::Isotropic => reference::Roughness::Isotropic,
            RoughnessKind::Anisotropic => reference::Roughness::Anisotropic,
        },
        probe_rule: match p.probe_rule {
            ProbeRule::Ceiling => reference::probes::ProbeRule::Ceiling,
            ProbeRule::PowerOfTwo => reference::probes::ProbeRule::PowerOfTwo,
        },
        max_probes: p.max_probes,
    }
}

/// Compares the outputs of one fragment with the reference.
fn compare(fragment: &ReflectionIn, got: &Observed, plan: &ReflectionPlan, p: &Precision) -> Sample {
    let want = reference::reflection(&reference_inputs(fragment), &reference_options(plan, p));
    let mut sample = Sample::default();
    let mut record = |figure: Figure, error: f64| sample.errors[figure.index()] = Some(error);

    let normal = real_vector(&BlockVector { exponent: 0, ..fragment.surface.normal });
    let length = normal.length();
    if let Some([e1, e2]) = got.frame
        && plan.frame != FrameSystem::Natural
        && length > 0.0
        && e1.length() > 0.0
    {
        let (unit, e1, e2) = (normal / length, e1 / length, e2 / length);
        let lengths = [e1, e2].map(|e| (e.length() - 1.0).abs());
        // Systems 1 and 2 need not be orthogonal.
        let skew = if plan.frame == FrameSystem::MainDirection { e1.dot(e2).abs() } else { 0.0 };
        let lean = e1.dot(unit).abs().max(e2.dot(unit).abs());
        record(Figure::Frame, skew.max(lean).max(lengths[0]).max(lengths[1]));
    }

    if want.selection.m == 0.0 {
        sample.wrong_face = got.face != 4;
        return sample;
    }
    if let Some(reflected) = got.reflected {
        let cross = reference::linear::cross(want.reflected, reflected);
        record(Figure::Reflected, norm(&cross) / (norm(&want.reflected) * norm(&reflected)));
    }

    let same_face = got.face == want.selection.face;
    if !same_face {
        sample.wrong_face = want.tie_margin > tie_margin(p);
        return sample;
    }
    let [s, t] = got.st;
    record(Figure::Coordinates, (s - want.selection.s).abs().max((t - want.selection.t).abs()));

    if want.axes.major > 0.0 {
        let conditioned = want.axes.major.max(want.footprint_scale() / CANCELLATION);
        if let Some(major) = got.major {
            record(Figure::MajorAxis, (major - want.axes.major).abs() / conditioned);
        }
        // If most of the footprint cancelled, its shape is noise; its size is still judged above.
        if want.axes.major * CANCELLATION > want.footprint_scale() {
            record(Figure::LevelOfDetail, (got.lod - want.probes.lod).abs());
            if want.axes.ratio() >= 1.1 {
                record(Figure::Direction, axis_angle(got.direction, want.axes.direction).to_degrees());
            }
            // A count may differ only if the ratio is within its own error of an integer.
            let ratio = want.axes.ratio();
            let noise = 2.0_f64.powi(6 - p.fraction_bits as i32) * ratio * ratio;
            let near_boundary = (ratio - ratio.round()).abs() <= noise;
            sample.wrong_count = got.probes != want.probes.count && !near_boundary && !got.saturated;
        }
    }
    sample
}

/// Name of the set of random fragments.
const RANDOM: &str = "random";

/// A datapath from ports to observed outputs; `None` for a fragment beyond its range.
type Datapath<'a> = &'a (dyn Fn(&ReflectionIn, &ReflectionPlan) -> Option<Observed> + Sync);

/// Measures `fragments` random fragments and every hard-case set of the profile `p`.
///
/// `progress` is called with the number of fragments done since the last call, from any thread.
pub fn measure(p: &Precision, fragments: u64, progress: &(dyn Fn(u64) + Sync)) -> Accuracy {
    measure_datapath(
        p,
        fragments,
        &|fragment, plan| Some(Observed::from_ports(fragment, &fragment.reflect(plan, p))),
        progress,
    )
}

/// Same as [`measure`] for `f32`, on a library's mathematics and with careful or plain formulas. Fragments are quantised as in
/// `precise`. It takes only fragments within the range of `f32` and the plan that it has.
pub fn measure_float<M: Math, F: Formulas>(fragments: u64, progress: &(dyn Fn(u64) + Sync)) -> Accuracy {
    let datapath = |fragment: &ReflectionIn, plan: &ReflectionPlan| {
        let has = *plan == ReflectionPlan::FULL && Fragment::in_range(fragment);
        has.then(|| {
            let environment = Environment::new(u32::from(fragment.edge_texels.clamp(1, 16384)));
            Observed::of_float(&environment.reflect::<M, F>(&Fragment::from(fragment)))
        })
    };
    measure_datapath(&Precision::PRECISE, fragments, &datapath, progress)
}

fn measure_datapath(
    p: &Precision,
    fragments: u64,
    datapath: Datapath<'_>,
    progress: &(dyn Fn(u64) + Sync),
) -> Accuracy {
    const CHUNK: u64 = 4096;
    let plan = ReflectionPlan::FULL;
    let add = |accuracy: &mut Accuracy, set: &str, index, fragment: &ReflectionIn, plan: &ReflectionPlan| {
        if let Some(observed) = datapath(fragment, plan) {
            accuracy.add(set, index, fragment, &compare(fragment, &observed, plan, p));
        }
    };
    let random = (0..fragments.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut accuracy = Accuracy::default();
            let range = chunk * CHUNK..fragments.min((chunk + 1) * CHUNK);
            progress(range.end - range.start);
            for index in range {
                add(&mut accuracy, RANDOM, index, &random_fragment(RANDOM, index, p), &plan);
            }
            accuracy
        })
        .collect::<Vec<_>>();
    let hard = hard_case_sets(p).into_iter().map(|set| {
        let mut accuracy = Accuracy::default();
        for (index, fragment) in (0..).zip(&set.cases) {
            add(&mut accuracy, set.name, index, fragment, &set.plan);
        }
        accuracy
    });
    random.into_iter().chain(hard).fold(Accuracy::default(), Accuracy::merge)
}
