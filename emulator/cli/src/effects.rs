//! `--effects` and `--frame`: effects that are on. `--scene`: effects that the objects of a scene need.

use roughxel_core::plan::{Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_peaks::ScenePeaks;
use roughxel_shader::ObjectPlan;

use super::{Failure, open_scene};

/// Help of every `--effects`.
pub(super) const HELP: &str = "Effects that are on: all, none, or a comma list of bump, roughness (or roughness-iso, which reads d1 \
    as I1), curvature, footprint (or footprint-sphere, for wide lobes), horizon (or horizon-product, F92's product of shares). \
    A reflection uses all but horizon (without footprint it has one probe at level 0), a highlight bump and roughness, a peak horizon";

/// Parses the effects of a comma list.
pub(super) fn parse(list: &str) -> Result<Effects, String> {
    match list.trim() {
        "all" => return Ok(Effects::ALL),
        "none" => return Ok(Effects::NONE),
        _ => {}
    }
    list.split(',').try_fold(Effects::NONE, |effects, effect| match effect.trim() {
        "bump" => Ok(Effects { bump: true, ..effects }),
        "roughness" => Ok(Effects { roughness: RoughnessKind::Anisotropic, ..effects }),
        "roughness-iso" => Ok(Effects { roughness: RoughnessKind::Isotropic, ..effects }),
        "curvature" => Ok(Effects { curvature: true, ..effects }),
        "footprint" => Ok(Effects { footprint: FootprintKind::Face, ..effects }),
        "footprint-sphere" => Ok(Effects { footprint: FootprintKind::Sphere, ..effects }),
        "horizon" => Ok(Effects { horizon: HorizonKind::Correlated, ..effects }),
        "horizon-product" => Ok(Effects { horizon: HorizonKind::Product, ..effects }),
        alone @ ("all" | "none") => Err(format!("`{alone}` stands alone")),
        unknown => Err(format!(
            "effect `{unknown}` is unknown; there are bump, roughness, roughness-iso, curvature, footprint, \
             footprint-sphere, horizon, horizon-product, all, none"
        )),
    })
}

/// Parses the name of a frame system.
pub(super) fn parse_frame(name: &str) -> Result<FrameSystem, String> {
    match name {
        "main" => Ok(FrameSystem::MainDirection),
        "natural" => Ok(FrameSystem::Natural),
        "natural-normalised" => Ok(FrameSystem::NaturalNormalised),
        _ => Err("frames are main, natural, natural-normalised".into()),
    }
}

/// Objects of a scene that share a plan.
pub(super) struct PlannedObject {
    /// Name as part of a path: lower-case letters, digits and underscores, unique among the objects.
    pub(super) directory: String,
    /// Names of the objects.
    pub(super) names: Vec<String>,
    /// Plan of the objects in the mode `footprint`.
    pub(super) plan: ObjectPlan,
    /// True if the environment is brighter than 64 × white.
    pub(super) is_bright: bool,
}

/// Plans the objects of a scene and groups them by plan.
pub(super) fn planned_objects(scene: &str, p: &Precision) -> Result<Vec<PlannedObject>, Failure> {
    let scene = open_scene(scene, None)?;
    // Plans do not depend on the peaks of a map.
    let prepared = Prepared::with_peaks(&scene, Mode::Footprint, p, &ScenePeaks::default())?;
    let mut planned: Vec<PlannedObject> = Vec::new();
    for (object, plan) in scene.objects.iter().zip(prepared.plans()) {
        if let Some(same) = planned.iter_mut().find(|known| known.plan == *plan) {
            same.names.push(object.name.clone());
            continue;
        }
        let stem = super::file_stem(&object.name);
        let taken = |name: &str| planned.iter().any(|known| known.directory == name);
        let numbered = (2..).map(|number| format!("{stem}_{number}"));
        let directory = std::iter::once(stem.clone()).chain(numbered).find(|name| !taken(name)).unwrap_or_default();
        let is_bright = prepared.has_bright_environment();
        planned.push(PlannedObject { directory, names: vec![object.name.clone()], plan: *plan, is_bright });
    }
    Ok(planned)
}
