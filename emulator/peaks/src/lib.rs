//! # roughxel-peaks
//!
//! Peak pyramid: distributions of normals as a few peaks Σ a cosⁿα (F92 §2, §5), with the horizons that each peak sees.
//!
//! Level 0 has one peak a texel. A texel of any other level stands for all texels of level 0 below it, each by the area it
//! covers: at most seven distinct normals are kept as they are, more are spread on a hemisphere grid (`spread`) and fitted
//! (`fit`), from clusters of normals where that takes many peaks. With heights they are gathered by normals and horizons instead (`clusters`), a peak for each, and laws of horizons (`law`) go to
//! where the peaks are as bright as what they stand for (`shadows`). Amplitudes are means over the area, so Σ a cosⁿα is a mean radiance and its integral 2πa/(n + 1) is the
//! same on every level. Directions are those of the local frame: x along the rows of the map, y with their index, z outwards.
//! Every texel is computed by itself in one order, with software logarithms: the same bits for any number of threads.

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
