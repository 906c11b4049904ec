//! The space in which a test claims something: every named profile, every plan.

use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::precision::{PROFILE_NAMES, Precision, RoughnessKind};

/// Every named profile.
pub fn profiles() -> [(&'static str, Precision); 4] {
    PROFILE_NAMES.map(|name| (name, Precision::by_name(name).expect("a listed profile exists")))
}

/// Every combination of blocks: 72 plans.
pub fn plans() -> Vec<ReflectionPlan> {
    let mut plans = Vec::new();
    for frame in [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised] {
        for roughness in [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic] {
            for switches in 0..8 {
                let [bump, curvature, footprint] = [0, 1, 2].map(|bit| switches >> bit & 1 == 1);
                plans.push(ReflectionPlan { bump, frame, roughness, curvature, footprint });
            }
        }
    }
    plans
}
