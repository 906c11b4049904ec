//! Construction of peaks from maps: every texel of every level is computed alone.

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

/// Consecutive texels of a level, in rows: the unit kept of an interrupted build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) level: usize,
    pub(super) first: usize,
    pub(super) texels: usize,
}

/// Most texels of a part: about half a second of fits.
const PART: usize = 256;

/// Texels of level 0 whose light one thread sums.
const TEXELS_AT_ONCE: usize = 4096;

/// Texels of a part.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Texels {
    pub(super) peaks: Vec<Vec<Peak>>,
    pub(super) fits: FitCounts,
}

/// Store of finished parts, for builds after an interruption.
pub(super) trait Parts {
    /// The part, if an earlier build has finished it.
    fn find(&mut self, _: Part) -> Option<Texels> {
        None
    }

    /// Keeps the part for a later build.
    fn keep(&mut self, _: Part, _: &Texels) {}
}

/// A store that keeps nothing.
struct NoParts;

impl Parts for NoParts {}

/// Fitted texels of a level by the hash of their facets.
type Known = HashMap<Key, Arc<Fitted>>;

/// Peaks of a texel with more facets than peaks.
#[derive(Default)]
struct Fitted {
    /// Fit of the density; with shadows there is none.
    fit: Option<fit::Fit>,
    peaks: Vec<Peak>,
}

/// Hash of facets.
type Key = [u8; 32];

impl PeakPyramid {
    /// Builds all levels. `progress` is called with the number of new steps, [`PeakSource::steps`] in all, from any
    /// thread.
    ///
    /// Errors: sizes, normals, heights and options out of range, before anything is built.
    pub fn build(
        source: &PeakSource,
        options: &BuildOptions,
        progress: &(dyn Fn(Steps) + Sync),
    ) -> Result<Self, PeakError> {
        Self::build_in_parts(source, options, progress, &mut NoParts)
    }

    /// Builds as [`PeakPyramid::build`] does, but takes the kept parts, and keeps the others as soon as they are
    /// finished.
    ///
    /// The parts of a level are built in sequence, each by all threads. Levels that take no time have no parts.
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

    /// Level 0 alone, which needs no fits. Errors: as [`PeakPyramid::build`].
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
    /// Slopes towards −x, +x, −y, +y; empty without heights.
    slopes: Vec<HorizonSlopes>,
    /// Knots of a tally that clear the slopes.
    knots: Vec<[u8; 4]>,
    exponent: f64,
    /// Weights of the errors of shadowed light.
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
            .map_or_else(Vec::new, |heights| horizon_slopes(source.width, source.height, heights, source.edges));
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

    /// Adds the light of all facets, which levels above need.
    fn with_light(mut self) -> Self {
        let texels = |first: usize| {
            let all = first..self.normals.len().min(first + TEXELS_AT_ONCE);
            self.light(all.map(|index| Texel { index, amplitude: self.amplitudes[index] }))
        };
        if !self.slopes.is_empty() {
            let firsts = (0..self.normals.len()).into_par_iter().step_by(TEXELS_AT_ONCE);
            // Sums are taken in order: the same bits for any number of threads.
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

    /// Texels of level 0 below a texel, in the order of their normals' bits, without those of amplitude 0. Texels that share a normal
    /// form a facet.
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
        // The sort is stable: texels with equal normals are summed in the order of rows.
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
    /// Texels with equal facets, to the bit, share a fit, which is made once in a level. `known` has the fits of the earlier parts.
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

    /// Peaks of the facets below a texel: the fewest that fit the density of their normals; with shadows, one for each cluster
    /// of facets.
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

    /// Lobes of facets in at most `most` clusters of similar normals: starting points of a fit.
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

    /// Gain of the spread exponent: a facet of a different width keeps its energy 2π/(n + 1).
    fn spread_gain(&self) -> f64 {
        (spread_exponent(self.exponent) + 1.0) / (self.exponent + 1.0)
    }

    /// A fitted peak, sharpened to the facets' own width.
    fn peak(&self, peak: &FittedPeak, horizon: Option<[Horizon; 4]>) -> Peak {
        let exponent = sharpened(peak.exponent, self.exponent).clamp(*EXPONENTS.start(), *EXPONENTS.end());
        Peak {
            amplitude: peak.amplitude * (exponent + 1.0) / (peak.exponent + 1.0),
            normal: peak.direction,
            exponent,
            horizon,
        }
    }

    /// Facets as individual peaks.
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

    /// Mean horizons of texels of level 0, weighted by amplitude.
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

/// Facets and texels below a texel.
struct Below {
    facets: Vec<Facet>,
    texels: Vec<Texel>,
}

impl Below {
    /// True if there are more facets than peaks.
    fn takes_fit(&self) -> bool {
        self.facets.len() > MAX_PEAKS
    }

    /// Hash of all inputs of a fit except the options.
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

/// A texel of level 0 below a texel of a higher level.
#[derive(Clone, Copy)]
struct Texel {
    /// Index in rows.
    index: usize,
    /// Amplitude times its share of the area.
    amplitude: f64,
}

#[cfg(test)]
pub(super) mod tests;
