//! Levels of a peak pyramid: peaks of each texel, and their horizons.

use glam::DVec3;
use roughxel_core::setup::AMPLITUDE_LIMIT;

use super::fit;
use super::source::MAX_PEAKS;

/// Distribution of the horizon's slope towards one side, in the units of the normals: height over distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Horizon {
    /// Mean, at least 0.
    pub mean: f64,
    /// Standard deviation; 0 on level 0.
    pub deviation: f64,
    /// Low end of the falling law nearest to the slopes: a direction of slope `low + t·width` clears 1 − (1 − t)² of them.
    pub low: f64,
    /// Width of the law; 0 is a step.
    pub width: f64,
}

/// One term a · max(0, N·H)ⁿ of a texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// a, at least 0.
    pub amplitude: f64,
    /// N, unit length, in the local frame.
    pub normal: DVec3,
    /// n, within [`EXPONENTS`](super::EXPONENTS).
    pub exponent: f64,
    /// Horizons towards −x, +x, −y, +y; `None` if the source has no heights.
    pub horizon: Option<[Horizon; 4]>,
}

/// One level of a pyramid, texels in rows, row 0 at v = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakLevel {
    /// Texels in a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Peaks of all texels, one texel after the other.
    peaks: Vec<Peak>,
    /// Ends of the peaks of each texel.
    ends: Vec<u32>,
}

impl PeakLevel {
    pub(super) fn new(width: u32, height: u32, texels: impl Iterator<Item = Vec<Peak>>) -> Self {
        let (mut peaks, mut ends) = (Vec::new(), Vec::new());
        for texel in texels {
            peaks.extend(texel);
            ends.push(peaks.len() as u32);
        }
        Self { width, height, peaks, ends }
    }

    /// The 0 to 7 peaks of the texel in column `x` and row `y`; exactly one on level 0.
    ///
    /// # Panics
    /// If the texel lies outside the level.
    pub fn texel(&self, x: u32, y: u32) -> &[Peak] {
        let index = y as usize * self.width as usize + x as usize;
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.peaks[start as usize..self.ends[index] as usize]
    }

    /// The peaks of each texel, in rows.
    pub fn texels(&self) -> impl Iterator<Item = &[Peak]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(start, end)| &self.peaks[*start as usize..*end as usize])
    }

    /// Peaks of all texels in rows.
    pub fn peaks(&self) -> &[Peak] {
        &self.peaks
    }
}

/// Progress: newly available texels that may take a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// Texels built now.
    Fitted(u64),
    /// Texels read, which takes no time, from a file that an earlier build has kept.
    Found(u64),
}

/// Results of the fits of densities. With heights there are none, for peaks are clusters of facets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitCounts {
    /// Texels with more than seven distinct normals.
    pub fitted: usize,
    /// Texels among these that took all seven peaks.
    pub seven: usize,
    /// Texels among these whose residual stayed above 5 %.
    pub missed: usize,
    /// Largest root mean square of a residual over that of its density.
    pub worst_rms: f64,
    /// Largest residual over the maximum of its density.
    pub worst_maximum: f64,
}

impl FitCounts {
    /// Counts of two parts together.
    pub(super) fn and(self, other: Self) -> Self {
        Self {
            fitted: self.fitted + other.fitted,
            seven: self.seven + other.seven,
            missed: self.missed + other.missed,
            worst_rms: self.worst_rms.max(other.worst_rms),
            worst_maximum: self.worst_maximum.max(other.worst_maximum),
        }
    }

    pub(super) fn add(mut self, fit: &fit::Fit) -> Self {
        self.fitted += 1;
        self.seven += usize::from(fit.peaks.len() == MAX_PEAKS);
        self.missed += usize::from(!fit.rest.is_good());
        self.worst_rms = self.worst_rms.max(fit.rest.rms);
        self.worst_maximum = self.worst_maximum.max(fit.rest.maximum);
        self
    }
}

/// A map of normals with all its levels as peaks.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakPyramid {
    /// Level 0 (full size) first, down to 1×1.
    pub levels: Vec<PeakLevel>,
    /// Results of the fits.
    pub fits: FitCounts,
}

impl PeakPyramid {
    /// Peaks that storage clamps: those of an amplitude of [`AMPLITUDE_LIMIT`] or more.
    pub fn cut(&self) -> usize {
        let peaks = self.levels.iter().flat_map(PeakLevel::peaks);
        peaks.filter(|peak| peak.amplitude >= AMPLITUDE_LIMIT).count()
    }
}
