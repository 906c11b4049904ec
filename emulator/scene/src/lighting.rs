//! Lights, and what shines in them: the keys `[[light]]`, `highlight`, `peaks`.
//!
//! A highlight is S97's modified Blinn-Phong model (Appendix A); peaks are F92's multiple surfaces: several normals at
//! one point, given in the scene (§4) or fitted to a bump map (§2), with horizons where shadowing is asked for (§5).

use glam::DVec3;

/// Exponents of highlights and peaks, the range of the datapath's ports.
pub const EXPONENTS: std::ops::RangeInclusive<f64> = 1.0..=8192.0;
/// Most lights of a scene.
pub const MAX_LIGHTS: usize = 64;
/// Most peaks a material gives: as many as a fragment adds up, four texels of two levels with seven each (F92 §2.4).
pub const MAX_GIVEN_PEAKS: usize = 56;
/// Most texels of a map that peaks are fitted to.
pub const MAX_PEAK_TEXELS: u64 = 1 << 20;
/// Heights of a map that peaks are fitted to, in distances between columns.
pub const PEAK_HEIGHTS: std::ops::RangeInclusive<f32> = -1e9..=1e9;

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Where it stands.
    pub place: LightPlace,
    /// Linear colour, 0 to 16; what a peak or highlight of 1 shows. It does not fade with distance.
    pub colour: [f32; 3],
}

/// Where a light stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightPlace {
    /// Infinitely far away: unit direction from the surface to the light.
    Direction(DVec3),
    /// At a point, world units.
    Point(DVec3),
}

/// A highlight of one lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Highlight {
    /// Exponent m of the smooth surface: a facet's share is cosᵐ of its angle to the half vector.
    pub exponent: f64,
    /// Linear colour, 0 to 1.
    pub colour: [f32; 3],
    /// Which formula.
    pub form: HighlightForm,
}

/// Formulas of a highlight in a surface with roughness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HighlightForm {
    /// The datapath's: S97 Appendix A with errata 6 to 8.
    #[default]
    Corrected,
    /// As printed in S97 Appendix A; for comparison, in floating point.
    Printed,
    /// Blinn-Phong, which knows no roughness; for comparison.
    Plain,
}

/// A surface with several normals at each point.
#[derive(Clone, Debug, PartialEq)]
pub struct Peaks {
    /// Where the peaks come from.
    pub source: PeakSource,
    /// Linear colour, 0 to 1.
    pub colour: [f32; 3],
    /// Whether and how bumps hide each other from light and eye; only with a height map.
    pub shadowing: Option<Shadowing>,
}

/// How much of a point is seen and lit, where it stands for many bumps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadowing {
    /// Who lies in a hole lies in it for light and eye, over both axes.
    Correlated,
    /// The product of four shares, as if they were independent (F92 §5); for comparison.
    Product,
}

/// Where peaks come from.
#[derive(Clone, Debug, PartialEq)]
pub enum PeakSource {
    /// The same everywhere, in the frame (e₁, e₂, n).
    Given(Vec<GivenPeak>),
    /// Fitted to the distribution of the bump map's normals, each a peak of this exponent and amplitude.
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
    /// 0 to 15.
    pub amplitude: f64,
    /// Unit vector in (e₁, e₂, n).
    pub normal: DVec3,
    /// 1 to 8192.
    pub exponent: f64,
}
