//! # roughxel-cases
//!
//! Test inputs of the datapath: seeded random fragments, every hard case as a named set, and stimulus for the ports of a design.
//!
//! Sets are made of port values, quantised to the profile, so the reference gets exactly what the datapath sees.

pub mod corners;
mod cube;
mod draws;
mod footprint;
mod fragment;
mod frame;
pub mod highlight;
pub mod limits;
pub mod lit_peak;
pub mod peak_and_horizon;
mod set;
pub mod stimulus;

use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::{Precision, RoughnessKind};

use cube::{cube_corners, cube_edges};
use footprint::{
    footprint_aspect, footprint_cancel, footprint_circle, footprint_level, footprint_rank, footprint_size,
    footprint_swap, roughness_isotropic, roughness_rank,
};
use frame::{frame_horizon, frame_natural, frame_pole, frame_zero};

pub use draws::direction;
pub use fragment::{RealFragment, random_fragment, random_fragments};
pub use set::CaseSet;

/// Name of the set of levels of detail.
pub const FOOTPRINT_LEVEL: &str = "footprint_level";
/// Name of the set of circles whose λ₂ exceeds λ₁.
pub const FOOTPRINT_SWAP: &str = "footprint_swap";

/// Every hard case of the reflection datapath, by stage.
pub fn hard_case_sets(p: &Precision) -> Vec<CaseSet<ReflectionIn, ReflectionPlan>> {
    let full = ReflectionPlan::FULL;
    let set = |name, description, cases: Vec<ReflectionIn>| CaseSet { name, description, cases, plan: full };
    vec![
        set("frame_pole", "h approaches n from 1 degree to the last bit, and lies on it", frame_pole(p)),
        set("frame_zero", "n = 0, h = 0, v = 0, tiny and huge n", frame_zero(p)),
        set("frame_horizon", "offsets to the end of their range, v below the perturbed surface", frame_horizon(p)),
        CaseSet {
            name: "frame_natural",
            description: "p_u, p_v skewed towards parallel, of very different length, equal, zero",
            cases: frame_natural(p),
            plan: ReflectionPlan { frame: FrameSystem::Natural, ..full },
        },
        CaseSet {
            name: "frame_natural_normalised",
            description: "the same tangents with their lengths dropped",
            cases: frame_natural(p),
            plan: ReflectionPlan { frame: FrameSystem::NaturalNormalised, ..full },
        },
        set("cube_edges", "r on the 12 edges and one bit to either side", cube_edges(p)),
        set("cube_corners", "r on the 8 corners and one bit around them, axes, most negative words", cube_corners(p)),
        set("footprint_rank", "both derivatives zero, one zero, parallel, skewed, equal", footprint_rank(p)),
        set("footprint_circle", "near circles: a = c and c - a changing sign by one bit", footprint_circle(p)),
        set("footprint_aspect", "aspect just below and above every probe count, to 1000", footprint_aspect(p)),
        set("footprint_size", "from far below a texel to far beyond a face", footprint_size(p)),
        set(FOOTPRINT_LEVEL, "levels of detail that the last place of an entry of log2 decides", footprint_level(p)),
        set(FOOTPRINT_SWAP, "circles in which λ2 comes out above λ1 and across a power of two", footprint_swap(p)),
        set("footprint_cancel", "concave mirror around its focus, cylinder", footprint_cancel(p)),
        set(
            "roughness_rank",
            "K of rank one in every direction, c = 0, c = one bit, d2 < 0, saturated",
            roughness_rank(p),
        ),
        CaseSet {
            name: "roughness_isotropic",
            description: "isotropic roughness from one bit to the end of its range",
            cases: roughness_isotropic(p),
            plan: ReflectionPlan { roughness: RoughnessKind::Isotropic, ..full },
        },
    ]
}
