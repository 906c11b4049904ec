//! Lights and the surfaces that answer them: the keys `[[light]]`, `highlight`, `peaks`.
//!
//! A highlight is S97's modified Blinn-Phong model (Appendix A). Peaks are F92's multiple surfaces: several normals at
//! one point. They are given in the scene (§4) or fitted to a bump map (§2), with horizons if shadowing is asked for
//! (§5).

use glam::DVec3;

/// Exponents of highlights and peaks, the range of the datapath's ports.
pub const EXPONENTS: std::ops::RangeInclusive<f64> = 1.0..=8192.0;
/// Most lights of a scene.
pub const MAX_LIGHTS: usize = 64;
/// Most peaks that a material gives: the sum of a fragment, four texels of two levels with seven peaks each (F92 §2.4).
pub const MAX_GIVEN_PEAKS: usize = 56;
/// Most texels of a map for fitted peaks.
pub const MAX_PEAK_TEXELS: u64 = 1 << 20;
/// Heights of a map for fitted peaks, in column distances.
pub const PEAK_HEIGHTS: std::ops::RangeInclusive<f32> = -1e9..=1e9;

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Position or direction.
    pub place: LightPlace,
    /// Linear colour, 0 to 16, shown by a peak or highlight of 1. It does not fade with distance.
    pub colour: [f32; 3],
}

/// Position or direction of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightPlace {
    /// Infinitely far away: unit direction from the surface to the light.
    Direction(DVec3),
    /// A point, world units.
    Point(DVec3),
}

/// A highlight of one lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highlight {
    /// Exponent m of the smooth surface: a facet's share is cosᵐ of its angle to the half vector.
    pub exponent: f64,
    /// Linear colour, 0 to 1.
    pub colour: [f32; 3],
    /// Formula of the highlight.
    pub form: HighlightForm,
}

/// Formulas of a highlight on a rough surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HighlightForm {
    /// The formula of the datapath: S97 Appendix A with errata 6 to 8.
    #[default]
    Corrected,
    /// The formula as printed in S97 Appendix A; for comparison, in floating point.
    Printed,
    /// Blinn-Phong, without roughness; for comparison.
    Plain,
}

/// A surface with several normals at each point.
#[derive(Clone, Debug, PartialEq)]
pub struct Peaks {
    /// Origin of the peaks.
    pub source: PeakSource,
    /// Linear colour, 0 to 1.
    pub colour: [f32; 3],
    /// Mutual hiding of bumps from light and eye; only with a height map.
    pub shadowing: Option<Shadowing>,
}

/// Share of a point that is seen and lit, if the point stands for many bumps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadowing {
    /// Correlated shares: a facet in a hole is in it for both light and eye, along both axes.
    Correlated,
    /// Product of four shares, as if they were independent (F92 §5); for comparison.
    Product,
}

/// Origin of peaks.
#[derive(Clone, Debug, PartialEq)]
pub enum PeakSource {
    /// Constant peaks in the tangent basis (e₁, e₂, n).
    Given(Vec<GivenPeak>),
    /// Peaks fitted to the distribution of the bump map's normals, each normal with this exponent and amplitude.
    Bump {
        /// Exponent of one normal.
        exponent: f64,
        /// Amplitude of one normal.
        amplitude: f64,
    },
}

/// One peak of a given surface: `amplitude · max(0, normal · h)^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenPeak {
    /// Amplitude, 0 to 15.
    pub amplitude: f64,
    /// Unit vector in (e₁, e₂, n).
    pub normal: DVec3,
    /// Exponent, 1 to 8192.
    pub exponent: f64,
}
