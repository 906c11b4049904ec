//! Bump pyramid: offsets (b₁, b₂), and the roughness that replaces the bumps that a level no longer shows (S97 §7–8).
//!
//! The offsets of a level are the means over the covered area of level 0, a standard mip map. Roughness is the covariance
//! over that area ([`roughness`](crate::roughness)) plus the mean of the scene's roughness map: variances add. Both come
//! from the *quantised* texels of level 0, so a level and its roughness describe the texels that the hardware fetches.
//! Codes carry one power-of-two scale per map, the smallest that the map allows. Decoding to the datapath's I4F28 ports
//! is a shift.

#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::law::{Histogram, Law, laws};
use crate::mip::{for_each_level, round_ratio};
use crate::roughness::{AddedRoughness, Covariance, Moments, RoughnessStorage, concentration, moments};
use rayon::prelude::*;
use roughxel_core::datapath::texel::{BumpCodes, BumpScale};
use roughxel_core::fx::Fx;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_scene::levels::covers;
use roughxel_scene::{BumpField, Deviation, FrameSystem, Material, RoughnessField};
use roughxel_utilities::exp2::power_of_two;

/// Fraction bits of the ports for offsets and roughness (I4F28).
pub const PORT_FRACTION_BITS: i32 = 28;

/// Storage options of [`BumpPyramid::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpOptions {
    /// True if offsets are stored as −b: for the natural systems of S97 §7, whose s_u = n × p_v runs along −u.
    pub negate: bool,
    /// Kind and word length of the roughness.
    pub roughness: RoughnessStorage,
    /// Law for the roughness of lost bumps.
    pub deviation: Deviation,
}

/// Scales of the codes of one map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BumpFormat {
    /// Offset = code · 2^(offset_exponent − 15), −13…3.
    pub offset_exponent: i32,
    /// Roughness component = code · 2^(roughness_exponent − bits), bits − 28…3.
    pub roughness_exponent: i32,
    /// Kind and word length of the roughness.
    pub roughness: RoughnessStorage,
}

impl BumpFormat {
    /// The scales as the datapath takes them.
    pub fn scale(&self) -> BumpScale<i32> {
        let exponent = self.offset_exponent.max(self.roughness_exponent);
        BumpScale {
            offset_down: Fx::from_raw(exponent - self.offset_exponent),
            roughness_down: Fx::from_raw(exponent - self.roughness_exponent),
            exponent: Fx::from_raw(exponent),
        }
    }
}

/// One level of a bump map, texels in rows, row 0 at v = 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BumpLevel {
    /// Texels in a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Codes of b₁, b₂, within ±32767.
    pub offsets: Vec<[i16; 2]>,
    /// Codes of d₁, d₂, d₃ (isotropic: I₁, 0, 0); **empty** if all are 0, so that smooth levels cost no memory.
    pub roughness: Vec<[i32; 3]>,
}

impl BumpLevel {
    /// The codes of every texel as the datapath takes them, row by row.
    pub fn codes(&self, format: &BumpFormat) -> impl Iterator<Item = BumpCodes<i32>> {
        let up = 16 - format.roughness.bits();
        (0..self.offsets.len()).map(move |index| BumpCodes {
            offset: self.offsets[index].map(|code| Fx::from_raw(code.into())),
            roughness: self.roughness.get(index).copied().unwrap_or_default().map(|code| Fx::from_raw(code << up)),
        })
    }

    /// The texel in column `x` and row `y`.
    ///
    /// # Panics
    /// If the texel lies outside the level.
    pub fn texel(&self, x: u32, y: u32) -> BumpTexel {
        let index = y as usize * self.width as usize + x as usize;
        BumpTexel { offset: self.offsets[index], roughness: self.roughness.get(index).copied().unwrap_or_default() }
    }
}

/// Codes of one texel of a bump map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BumpTexel {
    /// b₁, b₂.
    pub offset: [i16; 2],
    /// d₁, d₂, d₃, or I₁, 0, 0.
    pub roughness: [i32; 3],
}

impl BumpTexel {
    /// The texel in units of 2⁻²⁸, as the ports take it: exact, one shift to the left per component.
    ///
    /// Range: offsets below 8 − 2⁻¹² in magnitude, roughness below 8; a 32-bit word never overflows.
    pub fn decode(&self, format: &BumpFormat) -> DecodedBump {
        let offset_shift = PORT_FRACTION_BITS + format.offset_exponent - 15;
        let roughness_shift = PORT_FRACTION_BITS + format.roughness_exponent - format.roughness.bits() as i32;
        DecodedBump {
            offset: self.offset.map(|code| i32::from(code) << offset_shift),
            roughness: self.roughness.map(|code| code << roughness_shift),
        }
    }
}

/// A texel of a bump map in units of 2⁻²⁸ (raw I4F28).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DecodedBump {
    /// b₁, b₂, relative to |n|.
    pub offset: [i32; 2],
    /// d₁, d₂, d₃ with K = (d₁, d₂; 0, d₃)(d₁, d₂; 0, d₃)ᵀ, or I₁, 0, 0; relative to |n|.
    pub roughness: [i32; 3],
}

/// A bump map with its mip levels and the roughness of each.
#[derive(Clone, Debug, PartialEq)]
pub struct BumpPyramid {
    /// Level 0 (full size) first, down to 1×1.
    pub levels: Vec<BumpLevel>,
    /// Scales of the codes.
    pub format: BumpFormat,
    /// Texels of level 0 whose offset is 8 or more in magnitude, or no number. They are stored as the nearest offset
    /// that fits, or 0. A caller may warn if this is not 0.
    pub saturated: usize,
    /// Nearness of most bumps of a sixteenth of the map to their mean, ½ to 1; 1 for the normal law. It is 1 as well if roughness is the root
    /// mean square, and for maps of fewer than 64 texels.
    pub concentration: f64,
    /// Law of the bumps that a footprint on a level does not show, the finest level first; empty if one lobe is enough on all levels, if no law was
    /// asked for, or with a roughness map.
    pub laws: Vec<Law>,
}

/// Parts of a material on which its pyramid depends; valid while the maps of the material live.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct BumpKey {
    /// Addresses of the bump map and of the roughness map.
    maps: [Option<usize>; 2],
    negate: bool,
    deviation: Deviation,
    /// True if a highlight shows the roughness map without filters.
    shows_map: bool,
}

/// Returns true if a roughness map is shown without filters. It is part of the surface, and a highlight needs no footprint to show it.
fn shows_map(material: &Material) -> bool {
    material.highlight.is_some() && material.roughness.is_some()
}

impl BumpPyramid {
    /// Key of a material. [`Self::of_material`] returns the same pyramid for materials with equal keys, with filters or without.
    pub fn key(material: &Material, filters: bool) -> BumpKey {
        let bump = material.bump.as_ref().map(|bump| Arc::as_ptr(bump).addr());
        BumpKey {
            maps: [bump, material.roughness.as_ref().map(|roughness| Arc::as_ptr(roughness).addr())],
            negate: material.frame != FrameSystem::MainDirection,
            deviation: material.deviation,
            shows_map: !filters && shows_map(material),
        }
    }

    /// The pyramid of a material for a profile. Without filters it is the base alone, rough only if a highlight shows a
    /// roughness map.
    ///
    /// `None` without a bump map and without a roughness map that is kept.
    pub fn of_material(material: &Material, filters: bool, p: &Precision) -> Option<Self> {
        // Without filters no detail is lost.
        let kind = if filters || shows_map(material) { p.roughness } else { RoughnessKind::None };
        let roughness = material.roughness.as_deref().filter(|_| kind != RoughnessKind::None);
        let flat;
        let field = match (material.bump.as_deref(), roughness) {
            (Some(bump), _) => bump,
            (None, Some(roughness)) => {
                let (width, height) = (roughness.width, roughness.height);
                let offsets = vec![[0.0; 2]; roughness.factors.len()];
                flat = BumpField { width, height, offsets, heights: None };
                &flat
            }
            (None, None) => return None,
        };
        let options = BumpOptions {
            negate: material.frame != FrameSystem::MainDirection,
            roughness: RoughnessStorage::new(kind, p.roughness_bits),
            deviation: material.deviation,
        };
        let mut pyramid = Self::new(field, roughness, &options);
        if !filters {
            pyramid.levels.truncate(1);
        }
        Some(pyramid)
    }

    /// Quantises a field to 16-bit offsets and builds all levels with their roughness.
    ///
    /// Rounding: offsets to nearest, ties up before the sign is applied (so negated maps mirror each other). They are
    /// rounded once for level 0 and once from its exact sums for every other level. Roughness is rounded as its storage
    /// says. Level 0 has roughness only if `roughness` has.
    ///
    /// # Panics
    /// If `field` has no texels, or not `width · height` of them; if `roughness` has neither one texel nor the size of
    /// `field`.
    pub fn new(field: &BumpField, roughness: Option<&RoughnessField>, options: &BumpOptions) -> Self {
        let (width, height) = (field.width, field.height);
        assert!(width > 0 && field.offsets.len() == width as usize * height as usize);
        let offset_exponent = smallest_offset_exponent(&field.offsets);
        let scale = power_of_two(15 - offset_exponent);
        let offsets: Vec<[i16; 2]> =
            field.offsets.par_iter().map(|offset| offset.map(|o| quantise_offset(o, scale, options.negate))).collect();
        let saturated = field.offsets.iter().filter(|offset| offset.iter().any(|o| !fits(*o))).count();

        let storage = options.roughness;
        let lsb = power_of_two(offset_exponent - 15);
        let added = roughness.map(|roughness| {
            let fits = roughness.factors.len() == 1 || (roughness.width, roughness.height) == (width, height);
            assert!(fits, "a roughness map has one texel or the size of the bump map");
            AddedRoughness::new(roughness, lsb)
        });
        // Components in offset units.
        let components = |level: usize, index: usize, lost: Covariance| {
            let covariance = added.as_ref().map_or(lost, |added| lost.plus(added.texel(level, index)));
            storage.components(covariance).map(|component| component * lsb)
        };
        let mut levels = vec![BumpLevel { width, height, offsets: Vec::new(), roughness: Vec::new() }];
        let smooth = Covariance { a: 0.0, b: 0.0, c: 0.0 };
        let base_texels = if added.is_some() { offsets.len() } else { 0 };
        // Concentration of the last level with at least 16 texels. Land and sea are two kinds over a whole map, but rarely seen
        // together.
        let mut of_sixteenths = 1.0;
        let has_laws = options.deviation == Deviation::Law && roughness.is_none();
        let mut histograms = Vec::new();
        let mut lost: Vec<Vec<[f64; 3]>> =
            vec![(0..base_texels).into_par_iter().map(|index| components(0, index, smooth)).collect()];
        for_each_level(
            width,
            height,
            |index| moments(offsets[index]),
            |sums| {
                let mean = |sum: i64| round_ratio(sum, sums.area) as i16;
                let level = levels.len();
                levels.push(BumpLevel {
                    width: sums.width,
                    height: sums.height,
                    offsets: sums.sums.par_iter().map(|sums| [mean(sums[0]), mean(sums[1])]).collect(),
                    roughness: Vec::new(),
                });
                let texels = sums.sums.par_iter().enumerate();
                let (columns, rows) = (covers(width, sums.width), covers(height, sums.height));
                let row = |y: usize| &offsets[y * width as usize..][..width as usize];
                let covered = |(index, moments): (usize, &Moments)| {
                    let covariance = Covariance::from_moments(*moments, sums.area);
                    let cover = [&columns[index % columns.len()], &rows[index / columns.len()]];
                    ([moments[0], moments[1]].map(|sum| sum as f64 / sums.area as f64), covariance, cover)
                };
                if has_laws {
                    let counted = texels.clone().map(covered).fold(Histogram::new, |mut histogram, texel| {
                        histogram.add_texel(texel.0, texel.1, texel.2, row);
                        histogram
                    });
                    histograms.push(counted.reduce(Histogram::new, |sum, other| sum.plus(&other)));
                }
                let covariance = |(index, moments): (usize, &Moments)| {
                    let (mean, covariance, cover) = covered((index, moments));
                    let factor = match options.deviation {
                        Deviation::RootMeanSquare | Deviation::Law => 1.0,
                        Deviation::Mean => concentration(mean, covariance, cover, row),
                    };
                    ((factor, covariance.a + covariance.c), components(level, index, covariance.scaled(factor)))
                };
                let (factors, texels): (Vec<(f64, f64)>, Vec<[f64; 3]>) = texels.map(covariance).unzip();
                if factors.len() >= 16 {
                    // Weighted by variance: flat texels have no lobe.
                    let sum = factors.iter().fold([0.0; 2], |[of, all], (factor, by)| [of + factor * by, all + by]);
                    of_sixteenths = if sum[1] > 0.0 { sum[0] / sum[1] } else { 1.0 };
                }
                lost.push(texels);
            },
        );
        levels[0].offsets = offsets;

        let largest = lost.iter().flatten().flatten().fold(0.0, |largest: f64, d| largest.max(d.abs()));
        let roughness_exponent = storage.smallest_exponent(largest);
        for (level, lost) in levels.iter_mut().zip(&lost) {
            let codes: Vec<_> =
                lost.par_iter().map(|components| storage.quantise(*components, roughness_exponent)).collect();
            if codes.iter().any(|codes| *codes != [0; 3]) {
                level.roughness = codes;
            }
        }
        let format = BumpFormat { offset_exponent, roughness_exponent, roughness: storage };
        Self { levels, format, saturated, concentration: of_sixteenths, laws: laws(&histograms) }
    }

    /// True if any texel of the level has roughness: bumps that it does not show, or base roughness.
    ///
    /// False beyond the last level.
    pub fn lost_detail(&self, level: usize) -> bool {
        self.levels.get(level).is_some_and(|level| !level.roughness.is_empty())
    }

    /// The largest standard deviation along an axis of the map, of any texel of any level.
    pub fn largest_deviation(&self) -> f64 {
        let unit = power_of_two(self.format.roughness_exponent - self.format.roughness.bits() as i32);
        let codes = self.levels.iter().flat_map(|level| &level.roughness);
        let factors = codes.map(|codes| codes.map(|code| f64::from(code) * unit));
        factors.fold(0.0, |largest, [d1, d2, d3]| largest.max(libm::hypot(d1, d2)).max(d3))
    }

    /// True if no level has roughness: the roughness columns of the datapath are not called for.
    pub fn is_smooth(&self) -> bool {
        self.levels.iter().all(|level| level.roughness.is_empty())
    }
}

/// Largest code of an offset. −32768 is not used, so that negation is total.
const LARGEST_OFFSET_CODE: f64 = 32767.0;

/// True if an offset can be stored with the largest scale.
fn fits(offset: f32) -> bool {
    round_offset(offset.abs(), power_of_two(15 - 3)) <= LARGEST_OFFSET_CODE
}

/// Rounds to nearest, ties up; exact up to the floor, as 24 bits times a power of two plus one half fit a float64.
fn round_offset(offset: f32, scale: f64) -> f64 {
    (f64::from(offset) * scale + 0.5).floor()
}

fn quantise_offset(offset: f32, scale: f64, negate: bool) -> i16 {
    let code = round_offset(offset, scale).clamp(-LARGEST_OFFSET_CODE, LARGEST_OFFSET_CODE) as i16;
    if negate { -code } else { code }
}

/// Smallest exponent in −13…3 whose codes hold every offset that those of 3 hold; −13 has the step 2⁻²⁸ of the ports.
fn smallest_offset_exponent(offsets: &[[f32; 2]]) -> i32 {
    let largest =
        offsets.iter().flatten().map(|offset| offset.abs()).filter(|offset| !offset.is_nan()).fold(0.0, f32::max);
    (-13..3).find(|exponent| round_offset(largest, power_of_two(15 - exponent)) <= LARGEST_OFFSET_CODE).unwrap_or(3)
}
