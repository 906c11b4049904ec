//! # roughxel-peaks
//!
//! Peak pyramid: distributions of normals as a few peaks Σ a cosⁿα (F92 §2, §5), with the horizons that each peak sees.
//!
//! Level 0 has one peak a texel. A texel of any other level stands for all texels of level 0 below it, each by its covered area. At most seven
//! distinct normals are kept as they are. More normals are spread on a hemisphere grid (`spread`) and fitted (`fit`), from clusters of normals if
//! many peaks are needed. With heights they are gathered by normals and horizons instead (`clusters`), one peak a cluster. Laws of horizons (`law`)
//! are then fitted so that the peaks are as bright as their facets (`shadows`).
//!
//! Amplitudes are means over the area: Σ a cosⁿα is a mean radiance, and its integral 2πa/(n + 1) is equal on every level. Directions are those of
//! the local tangent basis: x along the rows of the map, y with their index, z outwards. Every texel is computed alone in one order, with software
//! logarithms: the same bits for any number of threads.

mod blocks;
mod build;
mod cache;
mod clusters;
mod fit;
pub mod horizon;
mod law;
mod levels;
mod scene_peaks;
mod shadows;
mod source;
mod spread;

pub use build::multiple_surface;
pub use cache::Cached;
pub use levels::{FitCounts, Horizon, Peak, PeakLevel, PeakPyramid, Steps};
pub use scene_peaks::{ObjectPeakError, ScenePeaks};
pub use source::{
    BuildOptions, EXPONENTS, FacetWeight, MAX_AMPLITUDE, MAX_PEAKS, MAX_SURFACE_WEIGHT, PeakError, PeakSource,
};
