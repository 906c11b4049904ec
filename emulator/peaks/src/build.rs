//! From maps to peaks: every texel of every level, by itself.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use super::clusters::{Member, clusters, lobe};
use super::fit::{self, FittedPeak};
use super::law::{Tally, knot};
use super::levels::{FitCounts, Horizon, Peak, PeakLevel, PeakPyramid, Steps};
use super::shadows::{self, DARK, Light};
use super::source::{BuildOptions, EXPONENTS, FacetWeight, MAX_PEAKS, MAX_SURFACE_WEIGHT, PeakError, PeakSource, unit};
use super::spread::{Facet, density, sharpened, spread_exponent};
use crate::horizon::{HorizonSlopes, horizon_slopes};
use roughxel_scene::levels::{Cover, covers};

/// Consecutive texels of a level, in rows; what is kept of a build that is interrupted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) level: usize,
    pub(super) first: usize,
    pub(super) texels: usize,
}

/// Most texels of a part: some half a second of fits.
const PART: usize = 256;

/// Texels of level 0 whose light is summed by one thread.
const TEXELS_AT_ONCE: usize = 4096;

/// The texels of a part.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Texels {
    pub(super) peaks: Vec<Vec<Peak>>,
    pub(super) fits: FitCounts,
}

/// Where finished parts go, and come from when their build was interrupted.
pub(super) trait Parts {
    /// The part, if an earlier build has finished it.
    fn find(&mut self, part: Part) -> Option<Texels>;
    /// Keeps it for a later build.
    fn keep(&mut self, part: Part, texels: &Texels);
}

/// Nothing is kept.
struct NoParts;

impl Parts for NoParts {
    fn find(&mut self, _: Part) -> Option<Texels> {
        None
    }

    fn keep(&mut self, _: Part, _: &Texels) {}
}

/// Texels of a level by the facets they are of.
type Known = HashMap<Key, Arc<Fitted>>;

/// Peaks of a texel with more facets than peaks.
#[derive(Default)]
struct Fitted {
    /// How the fit of its density went; with shadows there is none.
    fit: Option<fit::Fit>,
    peaks: Vec<Peak>,
}

/// Hash of facets.
type Key = [u8; 32];

impl PeakPyramid {
    /// Builds all levels; `progress` is called with steps that are done, [`PeakSource::steps`] in all, from any thread.
    ///
    /// Errors: sizes, normals, heights and options out of range, before anything is built.
    pub fn build(
        source: &PeakSource,
        options: &BuildOptions,
        progress: &(dyn Fn(Steps) + Sync),
    ) -> Result<Self, PeakError> {
        Self::build_in_parts(source, options, progress, &mut NoParts)
    }

    /// As [`PeakPyramid::build`], but takes the parts that are there, and keeps the others as soon as they are.
    ///
    /// The parts of a level come one after the other, each from all threads; levels that take no time have none.
    pub(super) fn build_in_parts(
        source: &PeakSource,
        options: &BuildOptions,
        progress: &(dyn Fn(Steps) + Sync),
        parts: &mut dyn Parts,
    ) -> Result<Self, PeakError> {
        let base = Base::new(source, options)?.with_light();
        let mut levels = vec![base.level()];
        let mut fits = FitCounts::default();
        for (to_width, to_height) in source.upper_levels() {
            let covers = (covers(source.width, to_width), covers(source.height, to_height));
            let count = covers.0.len() * covers.1.len();
            let mut known = Known::new();
            let mut peaks = Vec::with_capacity(count);
            if source.takes_time((to_width, to_height)) {
                for first in (0..count).step_by(PART) {
                    let part = Part { level: levels.len(), first, texels: PART.min(count - first) };
                    let texels = if let Some(texels) = parts.find(part) {
                        progress(Steps::Found(part.texels as u64));
                        texels
                    } else {
                        let texels = base.texels(&covers, part, &mut known, &|done| progress(Steps::Fitted(done)));
                        parts.keep(part, &texels);
                        texels
                    };
                    peaks.extend(texels.peaks);
                    fits = fits.and(texels.fits);
                }
            } else {
                let all = Part { level: levels.len(), first: 0, texels: count };
                let texels = base.texels(&covers, all, &mut known, &|_| ());
                peaks = texels.peaks;
                fits = fits.and(texels.fits);
            }
            levels.push(PeakLevel::new(to_width, to_height, peaks.into_iter()));
        }
        Ok(Self { levels, fits })
    }

    /// Level 0 alone, which nothing is fitted for. Errors: as [`PeakPyramid::build`].
    pub fn base(source: &PeakSource, options: &BuildOptions) -> Result<Self, PeakError> {
        Ok(Self { levels: vec![Base::new(source, options)?.level()], fits: FitCounts::default() })
    }
}

/// The whole map as one multiple surface (F92 §4): the texel at the top of its pyramid, without the levels below.
///
/// Errors: as [`PeakPyramid::build`].
pub fn multiple_surface(source: &PeakSource, options: &BuildOptions) -> Result<Vec<Peak>, PeakError> {
    let base = Base::new(source, options)?.with_light();
    let cover = |size| covers(size, 1).into_iter().next();
    let texel = cover(source.width).zip(cover(source.height)).map(|(column, row)| {
        let below = base.facets(&column, &row);
        if below.takes_fit() { base.fitted(&below).peaks } else { base.peaks(&below.facets, &below.texels) }
    });
    Ok(texel.unwrap_or_default())
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
    /// The knots of a tally that clear them.
    knots: Vec<[u8; 4]>,
    exponent: f64,
    /// What errors of shadowed light count.
    weights: Light,
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
            knots: slopes.iter().map(|sides| sides.map(knot)).collect(),
            slopes,
            exponent: options.exponent,
            weights: DARK,
        })
    }

    /// With what is needed for levels above: the light of all facets.
    fn with_light(mut self) -> Self {
        let texels = |first: usize| {
            let all = first..self.normals.len().min(first + TEXELS_AT_ONCE);
            self.light(all.map(|index| Texel { index, amplitude: self.amplitudes[index] }))
        };
        if !self.slopes.is_empty() {
            let firsts = (0..self.normals.len()).into_par_iter().step_by(TEXELS_AT_ONCE);
            // In order: the same bits for any number of threads.
            let lights: Vec<Light> = firsts.map(texels).collect();
            let area = self.normals.len() as f64;
            let add = |mut sum: Light, light: &Light| {
                for (sum, light) in
                    sum.iter_mut().flat_map(|block| &mut block.0).zip(light.iter().flat_map(|block| block.0))
                {
                    *sum += light / area;
                }
                sum
            };
            self.weights = shadows::weights(&lights.iter().fold(DARK, add));
        }
        self
    }

    /// Light of texels of level 0 in the shadows of each other, spread as densities are.
    fn light(&self, texels: impl Iterator<Item = Texel>) -> Light {
        let gain = self.spread_gain();
        let facet = |Texel { index, amplitude }| (self.normals[index], self.slopes[index], gain * amplitude);
        shadows::light(texels.map(facet), spread_exponent(self.exponent))
    }

    fn level(&self) -> PeakLevel {
        let single = |index| {
            let texel = Texel { index, amplitude: self.amplitudes[index] };
            let facet = Facet { normal: self.normals[index], amplitude: texel.amplitude, texels: 1 };
            self.peaks(&[facet], &[texel])
        };
        PeakLevel::new(self.width as u32, self.height as u32, (0..self.normals.len()).map(single))
    }

    /// Texels of level 0 below a texel in the order of their normals' bits, none of amplitude 0, and the facets of those that share one.
    fn facets(&self, column: &Cover, row: &Cover) -> Below {
        let area = (column.total() * row.total()) as f64;
        let mut texels: Vec<Texel> = (row.first..=row.last)
            .flat_map(|y| (column.first..=column.last).map(move |x| (x, y)))
            .map(|(x, y)| {
                let index = y * self.width + x;
                Texel { index, amplitude: (column.weight(x) * row.weight(y)) as f64 / area * self.amplitudes[index] }
            })
            .filter(|texel| texel.amplitude > 0.0)
            .collect();
        // Stable: what is equal is summed in the order of rows.
        let bits = |texel: &Texel| {
            let slopes = self.slopes.get(texel.index).map(|slopes| slopes.map(f64::to_bits));
            (self.normals[texel.index].to_array().map(f64::to_bits), slopes)
        };
        texels.sort_by_key(bits);
        let same = |a: &Texel, b: &Texel| self.normals[a.index] == self.normals[b.index];
        let facet = |texels: &[Texel]| Facet {
            normal: self.normals[texels[0].index],
            amplitude: texels.iter().fold(0.0, |sum, texel| sum + texel.amplitude),
            texels: texels.len(),
        };
        Below { facets: texels.chunk_by(same).map(facet).collect(), texels }
    }

    /// Texels of one part of a level.
    ///
    /// Texels whose facets are the same, to the bit, have the same fit, which is made once in a level: `known` has those of the parts before.
    fn texels(
        &self,
        covers: &(Vec<Cover>, Vec<Cover>),
        part: Part,
        known: &mut Known,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Texels {
        let (columns, rows) = covers;
        let gather = |index: usize| {
            let below = self.facets(&columns[index % columns.len()], &rows[index / columns.len()]);
            let key = below.takes_fit().then(|| below.key(&self.slopes));
            (below, key)
        };
        let gathered: Vec<(Below, Option<Key>)> =
            (part.first..part.first + part.texels).into_par_iter().map(gather).collect();
        let mut new: Vec<(Key, &Below)> = Vec::new();
        for (below, key) in &gathered {
            if let Some(key) = key.filter(|key| !known.contains_key(key)) {
                known.insert(key, Arc::default());
                new.push((key, below));
            }
        }
        let fitted = |(key, below): &(Key, &Below)| {
            let fitted = Arc::new(self.fitted(below));
            progress(1);
            (*key, fitted)
        };
        let fitted: Vec<(Key, Arc<Fitted>)> = new.par_iter().map(fitted).collect();
        known.extend(fitted);
        progress((part.texels - new.len()) as u64);
        let of = |key: &Option<Key>| key.as_ref().and_then(|key| known.get(key));
        let peaks = |(below, key): &(Below, Option<Key>)| match of(key) {
            Some(fitted) => fitted.peaks.clone(),
            None => self.peaks(&below.facets, &below.texels),
        };
        let fits = gathered.iter().filter_map(|(_, key)| of(key)?.fit.as_ref());
        let fits = fits.fold(FitCounts::default(), FitCounts::add);
        Texels { peaks: gathered.par_iter().map(peaks).collect(), fits }
    }

    /// Peaks of what lies below a texel: as few as fit the density of its normals, with shadows one for each cluster of facets.
    fn fitted(&self, below: &Below) -> Fitted {
        let spread = spread_exponent(self.exponent);
        if self.slopes.is_empty() {
            let fit = fit::fit(&density(&below.facets, self.exponent), spread, |most| self.lobes(&below.facets, most));
            let peaks = fit.peaks.iter().map(|peak| self.peak(peak, None)).collect();
            return Fitted { fit: Some(fit), peaks };
        }
        let member = |texel: &Texel| Member::new(self.normals[texel.index], self.slopes[texel.index], texel.amplitude);
        let of = clusters(&below.texels.iter().map(member).collect::<Vec<_>>(), MAX_PEAKS);
        let mut gathered = vec![Vec::new(); MAX_PEAKS];
        for (texel, cluster) in below.texels.iter().zip(of) {
            gathered[usize::from(cluster)].push(*texel);
        }
        gathered.retain(|texels| !texels.is_empty());
        let gain = self.spread_gain();
        let own: Vec<(FittedPeak, [Horizon; 4])> = gathered
            .iter()
            .map(|texels| {
                let (amplitude, normals) = texels.iter().fold((0.0, DVec3::ZERO), |(amplitude, normals), texel| {
                    (amplitude + texel.amplitude, normals + texel.amplitude * self.normals[texel.index])
                });
                (lobe(gain * amplitude, gain * normals, spread), self.horizon(texels))
            })
            .collect();
        let laws = shadows::laws(&self.light(below.texels.iter().copied()), &self.weights, &own);
        let peaks = own.iter().zip(laws).map(|((peak, _), law)| self.peak(peak, Some(law))).collect();
        Fitted { fit: None, peaks }
    }

    /// Lobes of facets in clusters of about one normal, at most so many: what a fit may start from.
    fn lobes(&self, facets: &[Facet], most: usize) -> Vec<FittedPeak> {
        let member = |facet: &Facet| Member::new(facet.normal, HorizonSlopes::default(), facet.amplitude);
        let mut sums = [(0.0, DVec3::ZERO); MAX_PEAKS];
        for (facet, of) in facets.iter().zip(clusters(&facets.iter().map(member).collect::<Vec<_>>(), most)) {
            let (amplitude, normals) = &mut sums[usize::from(of)];
            *amplitude += facet.amplitude;
            *normals += facet.amplitude * facet.normal;
        }
        let (gain, spread) = (self.spread_gain(), spread_exponent(self.exponent));
        let some = sums.into_iter().filter(|(amplitude, _)| *amplitude > 0.0);
        some.map(|(amplitude, normals)| lobe(gain * amplitude, gain * normals, spread)).collect()
    }

    /// What a facet of another width has for its energy 2π/(n + 1).
    fn spread_gain(&self) -> f64 {
        (spread_exponent(self.exponent) + 1.0) / (self.exponent + 1.0)
    }

    /// A fitted peak of facets as narrow as they are.
    fn peak(&self, peak: &FittedPeak, horizon: Option<[Horizon; 4]>) -> Peak {
        let exponent = sharpened(peak.exponent, self.exponent).clamp(*EXPONENTS.start(), *EXPONENTS.end());
        Peak {
            amplitude: peak.amplitude * (exponent + 1.0) / (peak.exponent + 1.0),
            normal: peak.direction,
            exponent,
            horizon,
        }
    }

    /// Facets as peaks of their own.
    fn peaks(&self, facets: &[Facet], texels: &[Texel]) -> Vec<Peak> {
        let mut rest = texels;
        let peak = |facet: &Facet| {
            let (own, others) = rest.split_at(facet.texels);
            rest = others;
            Peak {
                amplitude: facet.amplitude,
                normal: facet.normal,
                exponent: self.exponent,
                horizon: (!self.slopes.is_empty()).then(|| self.horizon(own)),
            }
        };
        facets.iter().map(peak).collect()
    }

    /// The horizons of texels of level 0, by their amplitude.
    fn horizon(&self, texels: &[Texel]) -> [Horizon; 4] {
        let mut sides = [Tally::EMPTY; 4];
        for texel in texels {
            let (slopes, knots) = (self.slopes[texel.index], self.knots[texel.index]);
            for ((tally, slope), knot) in sides.iter_mut().zip(slopes).zip(knots) {
                tally.add(texel.amplitude, slope, knot);
            }
        }
        sides.map(|tally| tally.law())
    }
}

/// What lies below a texel.
struct Below {
    facets: Vec<Facet>,
    texels: Vec<Texel>,
}

impl Below {
    /// Whether there are more facets than peaks.
    fn takes_fit(&self) -> bool {
        self.facets.len() > MAX_PEAKS
    }

    /// Hash of all that a fit depends on but the options.
    fn key(&self, slopes: &[HorizonSlopes]) -> Key {
        let mut hash = Sha256::new();
        let mut add = |numbers: &[f64]| numbers.iter().for_each(|number| hash.update(number.to_le_bytes()));
        for facet in &self.facets {
            add(&facet.normal.to_array());
            add(&[facet.amplitude]);
        }
        if !slopes.is_empty() {
            for texel in &self.texels {
                add(&[texel.amplitude]);
                add(&slopes[texel.index]);
            }
        }
        hash.finalize().into()
    }
}

/// A texel of level 0 in one above it.
#[derive(Clone, Copy)]
struct Texel {
    /// In rows.
    index: usize,
    /// Its amplitude times its share of the area.
    amplitude: f64,
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) const OPTIONS: BuildOptions =
        BuildOptions { exponent: 40.0, amplitude: 1.0, weight: FacetWeight::Surface, negate: false };

    /// Rounded hills of many slopes, with their heights.
    pub(crate) fn hills(width: u32, height: u32) -> PeakSource {
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
        PeakPyramid::build(source, options, &|_| ()).expect("the source is good")
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
            let step = |done: Steps| {
                let (Steps::Fitted(done) | Steps::Found(done)) = done;
                steps.fetch_add(done, std::sync::atomic::Ordering::Relaxed);
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
        // More than one thread sums the light of.
        let large = hills(128, 40);
        for source in [PeakSource { heights: None, ..hills(6, 5) }, hills(6, 5), large] {
            let with = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
                pool.install(|| build(&source, &OPTIONS))
            };
            let alone = with(1);
            assert_eq!(alone.fits.fitted > 0, source.heights.is_none());
            assert_eq!(with(3), alone);
        }
    }

    #[test]
    fn equal_neighbourhoods_share_the_fit_that_each_would_have() {
        let tile = PeakSource { heights: None, ..hills(4, 4) };
        let tiled = |columns: u32, rows: u32| {
            let place = |index: u32| (index / (4 * columns) % 4 * 4 + index % 4) as usize;
            let normals = (0..16 * columns * rows).map(|index| tile.normals[place(index)]).collect();
            PeakSource { width: 4 * columns, height: 4 * rows, normals, heights: None, rows_apart: 1.0 }
        };
        let alone = multiple_surface(&tile, &OPTIONS).expect("the source is good");
        let base = Base::new(&tiled(4, 2), &OPTIONS).expect("the source is good");
        let covers = (covers(16, 4), covers(8, 2));
        let mut known = Known::new();
        let steps = std::sync::atomic::AtomicU64::new(0);
        let texels = base.texels(&covers, Part { level: 2, first: 0, texels: 8 }, &mut known, &|done| {
            steps.fetch_add(done, std::sync::atomic::Ordering::Relaxed);
        });
        assert_eq!((known.len(), steps.into_inner(), texels.fits.fitted), (1, 8, 8));
        assert!(alone.len() > 1 && texels.peaks.iter().all(|peaks| *peaks == alone));
        // The last bit of one normal makes another neighbourhood.
        let mut source = tiled(4, 2);
        source.normals[5].x += 1e-15;
        let base = Base::new(&source, &OPTIONS).expect("the source is good");
        let mut known = Known::new();
        base.texels(&covers, Part { level: 2, first: 0, texels: 8 }, &mut known, &|_| ());
        assert_eq!(known.len(), 2);
    }

    /// What looks the same and lies in other shadows is another neighbourhood.
    #[test]
    fn equal_normals_with_other_horizons_share_nothing() {
        let flat = PeakSource { heights: Some(vec![0.0; 128]), ..hills(16, 8) };
        let mut source = flat.clone();
        source.normals =
            (0..128).map(|index| flat.normals[index / 64 * 64 + index % 4 + index / 16 % 4 * 16]).collect();
        let known = |source: &PeakSource| {
            let base = Base::new(source, &OPTIONS).expect("the source is good").with_light();
            let mut known = Known::new();
            let part = Part { level: 2, first: 0, texels: 8 };
            base.texels(&(covers(16, 4), covers(8, 2)), part, &mut known, &|_| ());
            known.len()
        };
        let same = known(&source);
        source.heights.iter_mut().flatten().step_by(37).for_each(|height| *height = 0.5);
        assert!(same <= 2 && known(&source) > same);
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
            let error = PeakPyramid::build(source, options, &|_| ()).expect_err("it is bad");
            assert_eq!(multiple_surface(source, options), Err(error.clone()));
            error.to_string()
        };
        let with = |change: fn(&mut PeakSource)| {
            let mut source = hills(4, 4);
            change(&mut source);
            error(&source, &OPTIONS)
        };
        let size = "texels has no peak pyramid: 1 to 1048576 texels";
        assert_eq!(with(|source| source.width = 0), format!("a map of 0x4 {size}"));
        let large = with(|source| (source.width, source.height) = (u32::MAX, u32::MAX));
        assert!(large.ends_with(size), "{large}");
        assert_eq!(with(|source| source.normals.truncate(15)), "15 normals for 16 texels");
        assert_eq!(with(|source| source.heights = Some(Vec::new())), "0 heights for 16 texels");
        for bad in [DVec3::ZERO, DVec3::new(0.0, f64::NAN, 1.0), DVec3::new(f64::INFINITY, 0.0, 0.0)] {
            let mut source = hills(4, 4);
            source.normals[6] = bad;
            assert_eq!(error(&source, &OPTIONS), "the normal of texel (2, 1) has no direction");
        }
        for bad in [f64::NAN, f64::INFINITY, -2e9] {
            let mut source = hills(4, 4);
            source.heights.as_mut().expect("it has heights")[9] = bad;
            assert_eq!(error(&source, &OPTIONS), "the height of texel (1, 2) is no number within 10^9");
        }
        for rows_apart in [0.0, -1.0, f64::INFINITY] {
            let message = error(&PeakSource { rows_apart, ..hills(4, 4) }, &OPTIONS);
            assert_eq!(message, format!("rows that are {rows_apart} columns apart have no slopes"));
        }
        for exponent in [0.0, 0.99, 8192.1, f64::INFINITY, f64::NAN] {
            let message = error(&hills(4, 4), &BuildOptions { exponent, ..OPTIONS });
            assert_eq!(message, format!("an exponent of {exponent} is not within 1 to 8192"));
        }
        for amplitude in [-0.1, 1024.5] {
            let message = error(&hills(4, 4), &BuildOptions { amplitude, ..OPTIONS });
            assert_eq!(message, format!("an amplitude of {amplitude} is not within 0 to 1024"));
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
