//! Sources of a peak pyramid: maps and options, checked.

use std::ops::RangeInclusive;

use glam::DVec3;
use roughxel_scene::{
    BumpField, Edges, FrameSystem, HeightField, MAX_PEAK_TEXELS, Material, PEAK_HEIGHTS, PeakSource as ScenePeakSource,
};
use thiserror::Error;

use super::fit;
use roughxel_scene::levels::level_sizes;

/// Most peaks of a texel.
pub const MAX_PEAKS: usize = fit::MAX_PEAKS;
/// Exponents of a facet or a peak.
pub const EXPONENTS: RangeInclusive<f64> = 1.0..=8192.0;
/// Largest amplitude of a facet.
pub const MAX_AMPLITUDE: f64 = 1024.0;
/// Largest weight 1/n_z of a facet: steeper ones (86.4°) are taken as this steep.
pub const MAX_SURFACE_WEIGHT: f64 = 16.0;

/// Reason why there is no peak pyramid: a size, a normal, a height or an option out of range.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{0}")]
pub struct PeakError(String);

/// Maps of a pyramid; row 0 at v = 0, repeat addressing.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakSource {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Normals in the local tangent basis, any length above 0, in rows. Those with z ≤ 0 are never seen: amplitude 0.
    pub normals: Vec<DVec3>,
    /// Heights in column distances, in rows, within [`PEAK_HEIGHTS`]; `None` for a surface without shadowing and masking.
    pub heights: Option<Vec<f64>>,
    /// Distance between rows over the distance between columns, above 0: 1 for square texels.
    pub rows_apart: f64,
    /// Reach of horizons: around the edges of the map, or up to them.
    pub edges: Edges,
}

impl PeakSource {
    /// Normals (o_u, o_v, 1) of a bump field, and its kept heights.
    pub fn from_field(field: &BumpField) -> Self {
        let normal = |[u, v]: &[f32; 2]| DVec3::new(f64::from(*u), f64::from(*v), 1.0);
        let heights = |kept: &HeightField| kept.heights.iter().copied().map(f64::from).collect();
        Self {
            width: field.width,
            height: field.height,
            normals: field.offsets.iter().map(normal).collect(),
            heights: field.heights.as_ref().map(heights),
            rows_apart: field.heights.as_ref().map_or(1.0, |kept| kept.rows_apart),
            edges: field.heights.as_ref().map_or(Edges::Wrapped, |kept| kept.edges),
        }
    }

    /// Source of a material's fitted peaks: the normals of its bump map, with shadowing its heights.
    ///
    /// A map has the slope 0, and a level horizon, along an axis of one texel. `None` if no peaks come from a map.
    pub fn of_material(material: &Material) -> Option<Self> {
        let (peaks, field) = material.peaks.as_ref().zip(material.bump.as_deref())?;
        let ScenePeakSource::Bump { .. } = peaks.source else { return None };
        let source = Self::from_field(field);
        Some(if peaks.shadowing.is_some() { source } else { Self { heights: None, ..source } })
    }

    /// Number of steps that [`PeakPyramid::build`](super::PeakPyramid::build) reports. Each texel is a step on levels whose texels cover
    /// more than seven texels of level 0; the other levels take no time.
    pub fn steps(&self) -> u64 {
        self.upper_levels().filter(|size| self.takes_time(*size)).map(texels).sum()
    }

    pub(super) fn upper_levels(&self) -> impl Iterator<Item = (u32, u32)> {
        level_sizes(self.width, self.height).skip(1)
    }

    /// True if a texel of a level of this size may need a fit.
    pub(super) fn takes_time(&self, level: (u32, u32)) -> bool {
        texels((self.width, self.height)) > MAX_PEAKS as u64 * texels(level)
    }

    pub(super) fn check(&self) -> Result<(), PeakError> {
        let texels = texels((self.width, self.height));
        if !(1..=MAX_PEAK_TEXELS).contains(&texels) {
            let (width, height) = (self.width, self.height);
            return Err(PeakError(format!(
                "a map of {width}x{height} texels has no peak pyramid: 1 to {MAX_PEAK_TEXELS} texels"
            )));
        }
        // NaN is in no range.
        if !(f64::MIN_POSITIVE..=f64::MAX).contains(&self.rows_apart) {
            return Err(PeakError(format!("rows that are {} columns apart have no slopes", self.rows_apart)));
        }
        let wanted = texels as usize;
        let count = |what, found| {
            let error = || PeakError(format!("{found} {what} for {wanted} texels"));
            (found == wanted).then_some(()).ok_or_else(error)
        };
        let place = |index: usize| (index as u32 % self.width, index as u32 / self.width);
        count("normals", self.normals.len())?;
        if let Some((x, y)) = self.normals.iter().position(|normal| unit(*normal).is_none()).map(place) {
            return Err(PeakError(format!("the normal of texel ({x}, {y}) has no direction")));
        }
        if let Some(heights) = &self.heights {
            count("heights", heights.len())?;
            let is_out_of_range = |height: &f64| !PEAK_HEIGHTS.contains(&(*height as f32));
            if let Some((x, y)) = heights.iter().position(is_out_of_range).map(place) {
                return Err(PeakError(format!("the height of texel ({x}, {y}) is no number within 10^9")));
            }
        }
        Ok(())
    }
}

/// Weighting of facets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacetWeight {
    /// Weight by the area on the surface, 1/n_z times that of the texel, up to [`MAX_SURFACE_WEIGHT`] (F92 §3).
    Surface,
    /// Weight by the area of the texel.
    Texel,
}

/// Reflection of a facet of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildOptions {
    /// Exponent n of a facet's cosⁿα, within [`EXPONENTS`].
    pub exponent: f64,
    /// Amplitude of a facet of weight 1, from 0 to [`MAX_AMPLITUDE`].
    pub amplitude: f64,
    /// Weighting of facets.
    pub weight: FacetWeight,
    /// True if the tangent basis runs along −u and −v (natural systems of S97 §7): normals and horizons are stored
    /// turned by 180°.
    pub negate: bool,
}

impl BuildOptions {
    /// Options for a material's bump map; `None` if no peaks come from a map.
    pub fn of_material(material: &Material) -> Option<Self> {
        let ScenePeakSource::Bump { exponent, amplitude } = material.peaks.as_ref()?.source else { return None };
        let negate = material.frame != FrameSystem::MainDirection;
        Some(Self { exponent, amplitude, weight: FacetWeight::Surface, negate })
    }

    pub(super) fn check(&self) -> Result<(), PeakError> {
        if !EXPONENTS.contains(&self.exponent) {
            return Err(PeakError(format!("an exponent of {} is not within 1 to 8192", self.exponent)));
        }
        if !(0.0..=MAX_AMPLITUDE).contains(&self.amplitude) {
            let message = format!("an amplitude of {} is not within 0 to {MAX_AMPLITUDE}", self.amplitude);
            return Err(PeakError(message));
        }
        Ok(())
    }
}

/// Number of texels of a level of this width and height.
pub(super) fn texels((width, height): (u32, u32)) -> u64 {
    u64::from(width) * u64::from(height)
}

/// Unit vector of a normal of any length; `None` if it has no direction.
pub(super) fn unit(normal: DVec3) -> Option<DVec3> {
    // The largest coordinate becomes 1 first, so that no square over- or underflows.
    let scaled = normal / normal.abs().max_element();
    scaled.is_finite().then(|| scaled.normalize())
}
