//! `--effects`: which blocks are on.

use roughxel_core::plan::ReflectionPlan;
use roughxel_core::precision::RoughnessKind;

/// Help of every `--effects`.
pub(super) const HELP: &str = "Blocks that are on: a comma list of bump, roughness (or roughness-iso, which reads d1 \
    as I1), curvature, footprint; or all, or none. Without footprint there is one probe at level 0";

/// The plan of a comma list.
pub(super) fn parse(list: &str) -> Result<ReflectionPlan, String> {
    let none = ReflectionPlan {
        bump: false,
        roughness: RoughnessKind::None,
        curvature: false,
        footprint: false,
        ..ReflectionPlan::FULL
    };
    match list.trim() {
        "all" => return Ok(ReflectionPlan::FULL),
        "none" => return Ok(none),
        _ => {}
    }
    list.split(',').try_fold(none, |plan, effect| match effect.trim() {
        "bump" => Ok(ReflectionPlan { bump: true, ..plan }),
        "roughness" => Ok(ReflectionPlan { roughness: RoughnessKind::Anisotropic, ..plan }),
        "roughness-iso" => Ok(ReflectionPlan { roughness: RoughnessKind::Isotropic, ..plan }),
        "curvature" => Ok(ReflectionPlan { curvature: true, ..plan }),
        "footprint" => Ok(ReflectionPlan { footprint: true, ..plan }),
        alone @ ("all" | "none") => Err(format!("`{alone}` stands alone")),
        unknown => Err(format!(
            "effect `{unknown}` is unknown; there are bump, roughness, roughness-iso, curvature, footprint, all, none"
        )),
    })
}
