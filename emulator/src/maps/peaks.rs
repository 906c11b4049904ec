//! Peak pyramid: distributions of normals as a few peaks Σ a cosⁿα (F92 §2, §5), with the horizons that each peak sees.
//!
//! Level 0 has one peak a texel. A texel of any other level stands for all texels of level 0 below it, each by the area it
//! covers: at most seven distinct normals are kept as they are, more are spread on a hemisphere grid (`spread`) and fitted
//! (`fit`). Amplitudes are means over the area, so Σ a cosⁿα is a mean radiance and its integral 2πa/(n + 1) is the
//! same on every level. Directions are those of the local frame: x along the rows of the map, y with their index, z outwards.
//! Every texel is computed by itself in one order, with software logarithms: the same bits for any number of threads.

mod cache;
mod fit;
mod scene;
mod spread;

use std::ops::RangeInclusive;
use std::path::Path;

use glam::DVec3;
use rayon::prelude::*;
use roughxel_core::setup::AMPLITUDE_LIMIT;
use thiserror::Error;

use self::spread::{Facet, HEMISPHERE, Spread, power, sharpened, spread_exponent};
use crate::maps::horizon::{HorizonSlopes, horizon_slopes};
use crate::maps::level_sizes;
use crate::maps::mip::{Cover, covers};
use crate::scene::{self as scenes, BumpField, FrameSystem, HeightField, Material};

pub use cache::Cached;
pub use scene::{ObjectPeakError, ScenePeaks};

/// Most peaks of a texel.
pub const MAX_PEAKS: usize = fit::MAX_PEAKS;
/// Most texels of level 0.
pub const MAX_TEXELS: u64 = 1 << 20;
/// Exponents of a facet or a peak.
pub const EXPONENTS: RangeInclusive<f64> = 1.0..=8192.0;
/// Heights of a map, in distances between columns.
pub const HEIGHTS: RangeInclusive<f32> = -1e9..=1e9;
/// Largest amplitude of a facet.
pub const MAX_AMPLITUDE: f64 = 1024.0;
/// Largest weight 1/n_z of a facet: steeper ones (86.4°) are taken as this steep.
pub const MAX_SURFACE_WEIGHT: f64 = 16.0;

/// Why there is no peak pyramid.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PeakError {
    /// No texels, or more than [`MAX_TEXELS`].
    #[error("a map of {width}x{height} texels has no peak pyramid: 1 to {MAX_TEXELS} texels")]
    Size {
        /// Texels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Normals or heights are not as many as texels.
    #[error("{found} {what} for {wanted} texels")]
    Count {
        /// "normals" or "heights".
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        wanted: usize,
    },
    /// A normal has no direction: it is zero, infinite or no number.
    #[error("the normal of texel ({x}, {y}) has no direction")]
    Normal {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// A height is outside of [`HEIGHTS`] or no number.
    #[error("the height of texel ({x}, {y}) is no number within 10^9")]
    Height {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// Rows of heights are no distance apart.
    #[error("rows that are {0} columns apart have no slopes")]
    RowDistance(f64),
    /// The exponent is outside of [`EXPONENTS`] or no number.
    #[error("an exponent of {0} is not within 1 to 8192")]
    Exponent(f64),
    /// The amplitude is outside of 0 to [`MAX_AMPLITUDE`] or no number.
    #[error("an amplitude of {0} is not within 0 to {MAX_AMPLITUDE}")]
    Amplitude(f64),
}

/// Maps that a pyramid is built from; row 0 at v = 0, repeat addressing.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakSource {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Normals in the local frame, any length above 0, in rows. Those with z ≤ 0 are never seen: amplitude 0.
    pub normals: Vec<DVec3>,
    /// Heights in distances between columns, in rows, within [`HEIGHTS`]; `None` for a surface without shadowing and masking.
    pub heights: Option<Vec<f64>>,
    /// Distance between rows over that between columns, above 0: 1 for square texels.
    pub rows_apart: f64,
}

impl PeakSource {
    /// Normals (o_u, o_v, 1) of a bump field, and the heights that it has kept.
    pub fn from_field(field: &BumpField) -> Self {
        let normal = |[u, v]: &[f32; 2]| DVec3::new(f64::from(*u), f64::from(*v), 1.0);
        let heights = |kept: &HeightField| kept.heights.iter().copied().map(f64::from).collect();
        Self {
            width: field.width,
            height: field.height,
            normals: field.offsets.iter().map(normal).collect(),
            heights: field.heights.as_ref().map(heights),
            rows_apart: field.heights.as_ref().map_or(1.0, |kept| kept.rows_apart),
        }
    }

    /// What a material's peaks are fitted to: the normals of its bump map, with shadowing its heights.
    ///
    /// A map has the slope 0, and a level horizon, along an axis of one texel. `None` where no peaks come from a map.
    pub fn of_material(material: &Material) -> Option<Self> {
        let (peaks, field) = material.peaks.as_ref().zip(material.bump.as_deref())?;
        let scenes::PeakSource::Bump { .. } = peaks.source else { return None };
        let source = Self::from_field(field);
        Some(if peaks.shadowing { source } else { Self { heights: None, ..source } })
    }

    /// How often [`PeakPyramid::build`] reports progress: once a texel of each level that takes more than seven of
    /// level 0 together, for the others take no time.
    pub fn steps(&self) -> u64 {
        self.upper_levels().filter(|size| self.takes_time(*size)).map(texels).sum()
    }

    fn upper_levels(&self) -> impl Iterator<Item = (u32, u32)> {
        level_sizes(self.width, self.height).skip(1)
    }

    /// Whether a texel of a level of this size may need a fit.
    fn takes_time(&self, level: (u32, u32)) -> bool {
        texels((self.width, self.height)) > MAX_PEAKS as u64 * texels(level)
    }

    fn check(&self) -> Result<(), PeakError> {
        let texels = texels((self.width, self.height));
        if !(1..=MAX_TEXELS).contains(&texels) {
            return Err(PeakError::Size { width: self.width, height: self.height });
        }
        // NaN is within nothing.
        if !(f64::MIN_POSITIVE..=f64::MAX).contains(&self.rows_apart) {
            return Err(PeakError::RowDistance(self.rows_apart));
        }
        let wanted = texels as usize;
        let count = |what, found| if found == wanted { Ok(()) } else { Err(PeakError::Count { what, found, wanted }) };
        count("normals", self.normals.len())?;
        let place = |index: usize| (index as u32 % self.width, index as u32 / self.width);
        if let Some(index) = self.normals.iter().position(|normal| unit(*normal).is_none()) {
            let (x, y) = place(index);
            return Err(PeakError::Normal { x, y });
        }
        if let Some(heights) = &self.heights {
            count("heights", heights.len())?;
            if let Some(index) = heights.iter().position(|height| !HEIGHTS.contains(&(*height as f32))) {
                let (x, y) = place(index);
                return Err(PeakError::Height { x, y });
            }
        }
        Ok(())
    }
}

/// How a facet counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacetWeight {
    /// By its area on the surface, 1/n_z times that of its texel, up to [`MAX_SURFACE_WEIGHT`] (F92 §3).
    Surface,
    /// By the area of its texel.
    Texel,
}

/// What a facet of the map reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildOptions {
    /// Exponent n of a facet's cosⁿα, within [`EXPONENTS`].
    pub exponent: f64,
    /// Amplitude of a facet of weight 1, from 0 to [`MAX_AMPLITUDE`].
    pub amplitude: f64,
    /// How a facet counts.
    pub weight: FacetWeight,
    /// The frame runs along −u and −v (natural systems of S97 §7): normals and horizons are stored turned by 180°.
    pub negate: bool,
}

impl BuildOptions {
    /// What the facets of a material's bump map reflect; `None` where no peaks come from a map.
    pub fn of_material(material: &Material) -> Option<Self> {
        let scenes::PeakSource::Bump { exponent, amplitude } = material.peaks.as_ref()?.source else { return None };
        let negate = material.frame != FrameSystem::MainDirection;
        Some(Self { exponent, amplitude, weight: FacetWeight::Surface, negate })
    }

    fn check(&self) -> Result<(), PeakError> {
        if !EXPONENTS.contains(&self.exponent) {
            return Err(PeakError::Exponent(self.exponent));
        }
        if !(0.0..=MAX_AMPLITUDE).contains(&self.amplitude) {
            return Err(PeakError::Amplitude(self.amplitude));
        }
        Ok(())
    }
}

/// Distribution of the horizon's slope towards one side, in the units of the normals: height over distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Horizon {
    /// Mean, at least 0.
    pub mean: f64,
    /// Standard deviation; 0 on level 0.
    pub deviation: f64,
}

/// One term a · max(0, N·H)ⁿ of a texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// a, at least 0.
    pub amplitude: f64,
    /// N, unit length, in the local frame.
    pub normal: DVec3,
    /// n, within [`EXPONENTS`].
    pub exponent: f64,
    /// Towards −x, +x, −y, +y; `None` where the source has no heights.
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
    /// Where the peaks of each texel end.
    ends: Vec<u32>,
}

impl PeakLevel {
    fn new(width: u32, height: u32, texels: impl Iterator<Item = Vec<Peak>>) -> Self {
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
    /// If the texel lies outside of the level.
    pub fn texel(&self, x: u32, y: u32) -> &[Peak] {
        let index = y as usize * self.width as usize + x as usize;
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.peaks[start as usize..self.ends[index] as usize]
    }

    /// Peaks of all texels in rows.
    pub fn peaks(&self) -> &[Peak] {
        &self.peaks
    }
}

/// How the fits went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitCounts {
    /// Texels with more than seven distinct normals.
    pub fitted: usize,
    /// Of these, texels that took all seven peaks.
    pub seven: usize,
    /// Of these, texels whose residual stayed above 5 %.
    pub missed: usize,
    /// Largest root mean square of a residual over that of its density.
    pub worst_rms: f64,
    /// Largest residual over the maximum of its density.
    pub worst_maximum: f64,
}

impl FitCounts {
    fn add(mut self, fit: &fit::Fit) -> Self {
        self.fitted += 1;
        self.seven += usize::from(fit.peaks.len() == MAX_PEAKS);
        self.missed += usize::from(!fit.is_good());
        self.worst_rms = self.worst_rms.max(fit.rms);
        self.worst_maximum = self.worst_maximum.max(fit.maximum);
        self
    }
}

/// A map of normals with all its levels as peaks.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakPyramid {
    /// Level 0 (full size) first, down to 1×1.
    pub levels: Vec<PeakLevel>,
    /// How the fits went.
    pub fits: FitCounts,
}

impl PeakPyramid {
    /// Builds all levels; `progress` is called [`PeakSource::steps`] times, from any thread.
    ///
    /// Errors: sizes, normals, heights and options out of range, before anything is built.
    pub fn build(source: &PeakSource, options: &BuildOptions, progress: &(dyn Fn() + Sync)) -> Result<Self, PeakError> {
        let base = Base::new(source, options)?;
        let mut levels = vec![base.level()];
        let mut fits = FitCounts::default();
        for (to_width, to_height) in source.upper_levels() {
            let (columns, rows) = (covers(source.width, to_width), covers(source.height, to_height));
            let takes_time = source.takes_time((to_width, to_height));
            let texels: Vec<(Vec<Peak>, Option<fit::Fit>)> = (0..columns.len() * rows.len())
                .into_par_iter()
                .map(|index| {
                    let texel = base.texel(&columns[index % columns.len()], &rows[index / columns.len()]);
                    if takes_time {
                        progress();
                    }
                    texel
                })
                .collect();
            fits = texels.iter().filter_map(|(_, fit)| fit.as_ref()).fold(fits, FitCounts::add);
            levels.push(PeakLevel::new(to_width, to_height, texels.into_iter().map(|(peaks, _)| peaks)));
        }
        Ok(Self { levels, fits })
    }

    /// Level 0 alone, which nothing is fitted for. Errors: as [`PeakPyramid::build`].
    pub fn base(source: &PeakSource, options: &BuildOptions) -> Result<Self, PeakError> {
        Ok(Self { levels: vec![Base::new(source, options)?.level()], fits: FitCounts::default() })
    }

    /// Peaks that storage cuts: of an amplitude of [`AMPLITUDE_LIMIT`] or more.
    pub fn cut(&self) -> usize {
        let peaks = self.levels.iter().flat_map(PeakLevel::peaks);
        peaks.filter(|peak| peak.amplitude >= AMPLITUDE_LIMIT).count()
    }

    /// The pyramid that a material calls for, without filters its base alone; `None` where no peaks come from a map.
    ///
    /// With filters it is read from the directory `cache` if it was built before, and kept there if not; the directory is
    /// made if it is missing. `progress` is called with steps that are done, from any thread: [`PeakSource::steps`] in
    /// all, none without filters. Errors: as [`PeakPyramid::build`].
    pub fn of_material(
        material: &Material,
        filters: bool,
        cache: Option<&Path>,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Option<Cached>, PeakError> {
        let Some((source, options)) = PeakSource::of_material(material).zip(BuildOptions::of_material(material)) else {
            return Ok(None);
        };
        let new = |pyramid| Cached { pyramid, read: false, not_kept: None };
        let cached = match cache {
            _ if !filters => new(Self::base(&source, &options)?),
            Some(directory) => Self::cached(directory, &source, &options, &|| progress(1))?,
            None => new(Self::build(&source, &options, &|| progress(1))?),
        };
        if cached.read {
            progress(source.steps());
        }
        Ok(Some(cached))
    }
}

/// The whole map as one multiple surface (F92 §4): the texel at the top of its pyramid, without the levels below.
///
/// Errors: as [`PeakPyramid::build`].
pub fn multiple_surface(source: &PeakSource, options: &BuildOptions) -> Result<Vec<Peak>, PeakError> {
    let base = Base::new(source, options)?;
    let cover = |size| covers(size, 1).into_iter().next();
    let texel = cover(source.width).zip(cover(source.height)).map(|(column, row)| base.texel(&column, &row));
    Ok(texel.map_or_else(Vec::new, |(peaks, _)| peaks))
}

/// Level 0, checked.
struct Base {
    width: usize,
    height: usize,
    /// Unit vectors.
    normals: Vec<DVec3>,
    amplitudes: Vec<f64>,
    /// Towards −x, +x, −y, +y; empty without heights.
    slopes: Vec<HorizonSlopes>,
    exponent: f64,
}

impl Base {
    fn new(source: &PeakSource, options: &BuildOptions) -> Result<Self, PeakError> {
        source.check()?;
        options.check()?;
        let turn = |normal: DVec3| {
            if options.negate { DVec3::new(-normal.x, -normal.y, normal.z) } else { normal }
        };
        // −0 becomes 0: equal normals have equal bits.
        let normals: Vec<DVec3> =
            source.normals.iter().filter_map(|normal| unit(*normal)).map(|normal| turn(normal) + DVec3::ZERO).collect();
        let weight = |normal: &DVec3| match options.weight {
            _ if normal.z <= 0.0 => 0.0,
            FacetWeight::Surface => (1.0 / normal.z).min(MAX_SURFACE_WEIGHT),
            FacetWeight::Texel => 1.0,
        };
        let mut slopes = source
            .heights
            .as_ref()
            .map_or_else(Vec::new, |heights| horizon_slopes(source.width, source.height, heights));
        if options.negate {
            slopes.iter_mut().for_each(|[left, right, down, up]| {
                std::mem::swap(left, right);
                std::mem::swap(down, up);
            });
        }
        for slope in slopes.iter_mut().flat_map(|sides| &mut sides[2..]) {
            *slope /= source.rows_apart;
        }
        Ok(Self {
            width: source.width as usize,
            height: source.height as usize,
            amplitudes: normals.iter().map(|normal| options.amplitude * weight(normal)).collect(),
            normals,
            slopes,
            exponent: options.exponent,
        })
    }

    fn level(&self) -> PeakLevel {
        let single = |index| self.peaks(&[self.facet(index, 1.0)]);
        PeakLevel::new(self.width as u32, self.height as u32, (0..self.normals.len()).map(single))
    }

    /// One texel of level 0, by its share of the area it is gathered for.
    fn facet(&self, index: usize, share: f64) -> Facet {
        let amplitude = share * self.amplitudes[index];
        let weighted = |slope: f64| [amplitude * slope, amplitude * slope * slope];
        let slopes = self.slopes.get(index).map_or([[0.0; 2]; 4], |slopes| slopes.map(weighted));
        Facet { normal: self.normals[index], amplitude, slopes }
    }

    /// Distinct normals below a texel, in the order of their coordinates' bits; none of amplitude 0.
    fn facets(&self, column: &Cover, row: &Cover) -> Vec<Facet> {
        let area = (column.total() * row.total()) as f64;
        let mut facets: Vec<Facet> = (row.first..=row.last)
            .flat_map(|y| (column.first..=column.last).map(move |x| (x, y)))
            .map(|(x, y)| self.facet(y * self.width + x, (column.weight(x) * row.weight(y)) as f64 / area))
            .filter(|facet| facet.amplitude > 0.0)
            .collect();
        // Stable: equal normals are summed in the order of rows.
        facets.sort_by_key(|facet| facet.normal.to_array().map(f64::to_bits));
        facets.dedup_by(|next, kept| {
            let same = next.normal == kept.normal;
            if same {
                kept.amplitude += next.amplitude;
                for (sum, slope) in kept.slopes.iter_mut().flatten().zip(next.slopes.iter().flatten()) {
                    *sum += slope;
                }
            }
            same
        });
        facets
    }

    /// Peaks of one texel above level 0, and the fit if it took one.
    fn texel(&self, column: &Cover, row: &Cover) -> (Vec<Peak>, Option<fit::Fit>) {
        let facets = self.facets(column, row);
        if facets.len() <= MAX_PEAKS {
            return (self.peaks(&facets), None);
        }
        let spread = Spread::new(&facets, self.exponent, !self.slopes.is_empty());
        let fit = fit::fit(&spread.density, spread_exponent(self.exponent));
        let peaks = fit
            .peaks
            .iter()
            .map(|peak| {
                let exponent = sharpened(peak.exponent, self.exponent).clamp(*EXPONENTS.start(), *EXPONENTS.end());
                let share = |direction: &DVec3| power(peak.direction.dot(*direction), peak.exponent);
                Peak {
                    amplitude: peak.amplitude * (exponent + 1.0) / (peak.exponent + 1.0),
                    normal: peak.direction,
                    exponent,
                    horizon: (!self.slopes.is_empty()).then(|| collect(&spread, share)),
                }
            })
            .collect();
        (peaks, Some(fit))
    }

    /// Facets as peaks of their own.
    fn peaks(&self, facets: &[Facet]) -> Vec<Peak> {
        let peak = |facet: &Facet| Peak {
            amplitude: facet.amplitude,
            normal: facet.normal,
            exponent: self.exponent,
            horizon: (!self.slopes.is_empty()).then(|| facet.slopes.map(|sums| distribution(facet.amplitude, sums))),
        };
        facets.iter().map(peak).collect()
    }
}

/// Horizons that a peak sees: those of the samples, by their density and the peak's share in each.
fn collect(spread: &Spread, share: impl Fn(&DVec3) -> f64) -> [Horizon; 4] {
    let (mut density, mut slopes) = (0.0, [[0.0; 2]; 4]);
    for (sample, direction) in HEMISPHERE.directions.iter().enumerate() {
        let weight = HEMISPHERE.solid_angles[sample] * share(direction);
        density += weight * spread.density[sample];
        for (sum, slope) in slopes.iter_mut().flatten().zip(spread.slopes[sample].iter().flatten()) {
            *sum += weight * slope;
        }
    }
    slopes.map(|sums| distribution(density, sums))
}

/// Mean and deviation of slopes from their weighted sums; both 0 where the weight is.
fn distribution(weight: f64, [sum, squares]: [f64; 2]) -> Horizon {
    if weight <= 0.0 {
        return Horizon::default();
    }
    let mean = sum / weight;
    // Rounding leaves up to some ulps of the mean square where all slopes are the same.
    let variance = squares / weight - mean * mean;
    let noise = 1e-12 * mean * mean;
    Horizon { mean, deviation: if variance > noise { variance.sqrt() } else { 0.0 } }
}

/// Texels of a level of this width and height.
fn texels((width, height): (u32, u32)) -> u64 {
    u64::from(width) * u64::from(height)
}

/// Unit vector of a normal of any length; `None` where it has no direction.
fn unit(normal: DVec3) -> Option<DVec3> {
    // The largest coordinate becomes 1 first, so that no square over- or underflows.
    let scaled = normal / normal.abs().max_element();
    scaled.is_finite().then(|| scaled.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) const OPTIONS: BuildOptions =
        BuildOptions { exponent: 40.0, amplitude: 1.0, weight: FacetWeight::Surface, negate: false };

    /// Rounded hills of many slopes, with their heights.
    pub(super) fn hills(width: u32, height: u32) -> PeakSource {
        let heights: Vec<f64> = (0..width * height)
            .map(|index| {
                let [x, y] = [index % width, index / width].map(f64::from);
                1.3 * libm::sin(1.7 * x + 0.4 * y) + 0.8 * libm::cos(0.9 * y - 0.3 * x)
            })
            .collect();
        let at = |x: u32, y: u32| heights[(y % height * width + x % width) as usize];
        let normals = (0..width * height)
            .map(|index| {
                let (x, y) = (index % width, index / width);
                let slope = [at(x + 1, y) - at(x + width - 1, y), at(x, y + 1) - at(x, y + height - 1)];
                DVec3::new(-0.5 * slope[0], -0.5 * slope[1], 1.0)
            })
            .collect();
        PeakSource { width, height, normals, heights: Some(heights), rows_apart: 1.0 }
    }

    fn build(source: &PeakSource, options: &BuildOptions) -> PeakPyramid {
        PeakPyramid::build(source, options, &|| ()).expect("the source is good")
    }

    #[test]
    fn level_0_has_each_texels_own_normal_and_horizon() {
        let source = hills(5, 3);
        let pyramid = build(&source, &BuildOptions { amplitude: 0.5, ..OPTIONS });
        let slopes = horizon_slopes(5, 3, source.heights.as_deref().expect("it has heights"));
        for (index, (normal, slopes)) in source.normals.iter().zip(slopes).enumerate() {
            let &[peak] = pyramid.levels[0].texel(index as u32 % 5, index as u32 / 5) else { panic!("one peak") };
            let normal = normal.normalize();
            assert!((peak.normal - normal).length() < 1e-15 && peak.exponent == 40.0);
            assert!((peak.amplitude - 0.5 / normal.z).abs() < 1e-15);
            for (horizon, slope) in peak.horizon.expect("it has heights").iter().zip(slopes) {
                assert!((horizon.mean - slope).abs() <= 1e-15 * slope && horizon.deviation == 0.0);
            }
        }
    }

    #[test]
    fn at_most_seven_normals_are_kept_as_they_are() {
        // Seven directions in a map whose sizes do not divide.
        let direction = |index: usize| DVec3::new(index as f64 * 0.1, 0.2, 1.0);
        let normals: Vec<DVec3> = (0..15).map(|index| direction(index % 7) * f64::from(1 << (index % 4))).collect();
        let source = PeakSource { width: 5, height: 3, normals, heights: Some(vec![0.0; 15]), rows_apart: 1.0 };
        let pyramid = build(&source, &BuildOptions { weight: FacetWeight::Texel, ..OPTIONS });
        assert_eq!(pyramid.fits, FitCounts::default());
        let top = pyramid.levels[2].texel(0, 0);
        assert_eq!(top.len(), 7);
        for peak in top {
            let index = (0..7).find(|index| (direction(*index).normalize() - peak.normal).length() < 1e-14);
            let texels = if index == Some(0) { 3.0 } else { 2.0 };
            assert!((peak.amplitude - texels / 15.0).abs() < 1e-15 && peak.exponent == 40.0, "{peak:?}");
            assert_eq!(peak.horizon, Some([Horizon::default(); 4]));
        }
        // Half of the middle column belongs to each side.
        let left: f64 = pyramid.levels[1].texel(0, 0).iter().map(|peak| peak.amplitude).sum();
        assert_eq!((pyramid.levels[1].width, pyramid.levels[1].height), (2, 1));
        assert!((left - 1.0).abs() < 1e-15);
    }

    #[test]
    fn horizons_of_shared_normals_have_their_mean_and_deviation() {
        let heights = vec![0.0, 1.0, 0.0, 3.0];
        let normals = vec![DVec3::Z; 4];
        let source = PeakSource { width: 4, height: 1, normals, heights: Some(heights), rows_apart: 1.0 };
        let pyramid = build(&source, &OPTIONS);
        let &[peak] = pyramid.levels[2].texel(0, 0) else { panic!("one normal") };
        let slopes = [3.0, 1.0, 1.0, 0.0];
        let mean = slopes.iter().sum::<f64>() / 4.0;
        let variance = slopes.iter().map(|slope| (slope - mean) * (slope - mean)).sum::<f64>() / 4.0;
        let horizon = peak.horizon.expect("it has heights")[0];
        assert!((horizon.mean - mean).abs() < 1e-14, "{horizon:?}");
        assert!((horizon.deviation - variance.sqrt()).abs() < 1e-14, "{horizon:?}");
    }

    #[test]
    fn a_negated_frame_turns_normals_and_horizons_by_half_a_turn() {
        let source = hills(4, 4);
        let (plain, turned) = (build(&source, &OPTIONS), build(&source, &BuildOptions { negate: true, ..OPTIONS }));
        for (plain, turned) in plain.levels[0].peaks().iter().zip(turned.levels[0].peaks()) {
            assert_eq!(turned.normal, plain.normal * DVec3::new(-1.0, -1.0, 1.0));
            let [left, right, down, up] = plain.horizon.expect("it has heights");
            assert_eq!(turned.horizon, Some([right, left, up, down]));
        }
    }

    #[test]
    fn rows_further_apart_have_a_lower_horizon() {
        let source = hills(4, 5);
        let (near, far) = (build(&source, &OPTIONS), build(&PeakSource { rows_apart: 4.0, ..source }, &OPTIONS));
        for (near, far) in near.levels[0].peaks().iter().zip(far.levels[0].peaks()) {
            let [left, right, down, up] = near.horizon.expect("it has heights").map(|side| side.mean);
            let wanted = [left, right, down / 4.0, up / 4.0];
            let got = far.horizon.expect("it has heights").map(|side| side.mean);
            for (got, wanted) in got.into_iter().zip(wanted) {
                assert!((got - wanted).abs() <= 1e-15 * wanted);
            }
        }
    }

    #[test]
    fn progress_is_told_of_texels_that_may_take_a_fit() {
        let count = |source: &PeakSource| {
            let steps = std::sync::atomic::AtomicU64::new(0);
            let step = || {
                steps.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            };
            PeakPyramid::build(source, &OPTIONS, &step).expect("the source is good");
            assert_eq!(steps.into_inner(), source.steps());
            source.steps()
        };
        // Two by two texels each, then four by four and all of them.
        assert_eq!(count(&hills(8, 8)), 4 + 1);
        assert_eq!(count(&hills(13, 3)), 3 + 1);
        assert_eq!(count(&hills(7, 1)), 0);
    }

    #[test]
    fn the_base_is_level_0_of_the_pyramid() {
        let source = hills(5, 4);
        let base = PeakPyramid::base(&source, &OPTIONS).expect("the source is good");
        assert_eq!(base.levels, build(&source, &OPTIONS).levels[..1]);
    }

    #[test]
    fn texels_do_not_depend_on_the_number_of_threads() {
        let source = hills(6, 5);
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            pool.install(|| build(&source, &OPTIONS))
        };
        let alone = with(1);
        assert!(alone.fits.fitted > 0);
        assert_eq!(with(3), alone);
    }

    #[test]
    fn a_multiple_surface_is_the_top_of_the_pyramid() {
        let source = hills(3, 7);
        let pyramid = build(&source, &OPTIONS);
        let top = pyramid.levels.last().map(|level| level.texel(0, 0));
        assert_eq!(multiple_surface(&source, &OPTIONS).ok().as_deref(), top);
    }

    #[test]
    fn facets_that_face_inwards_have_no_amplitude() {
        let normals = vec![DVec3::new(0.3, 0.0, -1.0), DVec3::X];
        let source = PeakSource { width: 2, height: 1, normals, heights: None, rows_apart: 1.0 };
        let pyramid = build(&source, &OPTIONS);
        assert!(pyramid.levels[0].peaks().iter().all(|peak| peak.amplitude == 0.0));
        assert!(pyramid.levels[1].texel(0, 0).is_empty());
    }

    #[test]
    fn one_texel_is_one_level() {
        let normals = vec![DVec3::new(0.0, 3.0, 4.0)];
        let source = PeakSource { width: 1, height: 1, normals, heights: Some(vec![9.0]), rows_apart: 1.0 };
        let pyramid = build(&source, &BuildOptions { weight: FacetWeight::Texel, ..OPTIONS });
        assert_eq!((pyramid.levels.len(), source.steps()), (1, 0));
        let &[peak] = pyramid.levels[0].texel(0, 0) else { panic!("one peak") };
        assert!((peak.normal - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
        assert_eq!(peak.horizon, Some([Horizon::default(); 4]));
    }

    #[test]
    fn bad_sources_and_options_are_named() {
        let error = |source: &PeakSource, options: &BuildOptions| {
            let error = PeakPyramid::build(source, options, &|| ()).expect_err("it is bad");
            assert_eq!(multiple_surface(source, options), Err(error.clone()));
            error
        };
        let with = |change: fn(&mut PeakSource)| {
            let mut source = hills(4, 4);
            change(&mut source);
            error(&source, &OPTIONS)
        };
        assert_eq!(with(|source| source.width = 0), PeakError::Size { width: 0, height: 4 });
        let large = with(|source| (source.width, source.height) = (u32::MAX, u32::MAX));
        assert!(matches!(large, PeakError::Size { .. }));
        let count = |what, found| PeakError::Count { what, found, wanted: 16 };
        assert_eq!(with(|source| source.normals.truncate(15)), count("normals", 15));
        assert_eq!(with(|source| source.heights = Some(Vec::new())), count("heights", 0));
        for bad in [DVec3::ZERO, DVec3::new(0.0, f64::NAN, 1.0), DVec3::new(f64::INFINITY, 0.0, 0.0)] {
            let mut source = hills(4, 4);
            source.normals[6] = bad;
            assert_eq!(error(&source, &OPTIONS), PeakError::Normal { x: 2, y: 1 });
        }
        for bad in [f64::NAN, f64::INFINITY, -2e9] {
            let mut source = hills(4, 4);
            source.heights.as_mut().expect("it has heights")[9] = bad;
            assert_eq!(error(&source, &OPTIONS), PeakError::Height { x: 1, y: 2 });
        }
        for rows_apart in [0.0, -1.0, f64::INFINITY] {
            let source = PeakSource { rows_apart, ..hills(4, 4) };
            assert_eq!(error(&source, &OPTIONS), PeakError::RowDistance(rows_apart));
        }
        for exponent in [0.0, 0.99, 8192.1, f64::INFINITY] {
            assert_eq!(error(&hills(4, 4), &BuildOptions { exponent, ..OPTIONS }), PeakError::Exponent(exponent));
        }
        assert!(matches!(BuildOptions { exponent: f64::NAN, ..OPTIONS }.check(), Err(PeakError::Exponent(_))));
        for amplitude in [-0.1, 1024.5] {
            assert_eq!(error(&hills(4, 4), &BuildOptions { amplitude, ..OPTIONS }), PeakError::Amplitude(amplitude));
        }
    }

    #[test]
    fn exponents_at_both_ends_give_finite_peaks_in_range() {
        for exponent in [1.0, 8192.0] {
            for peak in
                build(&hills(5, 4), &BuildOptions { exponent, ..OPTIONS }).levels.iter().flat_map(PeakLevel::peaks)
            {
                assert!(
                    EXPONENTS.contains(&peak.exponent) && peak.amplitude.is_finite() && peak.normal.is_normalized()
                );
            }
        }
    }
}
