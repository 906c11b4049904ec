//! The space in which a test claims something: every named profile, every plan.

use roughxel_core::plan::{Datapath, Effects, FrameSystem, PeakPlan, ReflectionPlan, SurfacePlan};
use roughxel_core::precision::{PROFILE_NAMES, Precision, RoughnessKind};

const FRAMES: [FrameSystem; 3] = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];
const ROUGHNESS: [RoughnessKind; 3] = [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic];

/// Every named profile.
pub fn profiles() -> [(&'static str, Precision); 4] {
    PROFILE_NAMES.map(|name| (name, Precision::by_name(name).expect("a listed profile exists")))
}

/// Every combination of the blocks of a reflection: 72 plans.
pub fn plans() -> Vec<ReflectionPlan> {
    let mut plans = Vec::new();
    for frame in FRAMES {
        for roughness in ROUGHNESS {
            for switches in 0..8 {
                let [bump, curvature, footprint] = [0, 1, 2].map(|bit| switches >> bit & 1 == 1);
                plans.push(ReflectionPlan { bump, frame, roughness, curvature, footprint });
            }
        }
    }
    plans
}

/// Every combination of the blocks of a datapath; of a design that is part of none, its only one.
pub fn effects(datapath: Option<Datapath>) -> Vec<Effects> {
    let switch = [false, true];
    match datapath {
        None => vec![Effects::NONE],
        Some(Datapath::Reflection) => plans().into_iter().map(Effects::from).collect(),
        Some(Datapath::Highlight) => {
            let surfaces = FRAMES.iter().flat_map(|&frame| {
                ROUGHNESS.iter().flat_map(move |&roughness| {
                    switch.map(|bump| SurfacePlan { bump, frame, roughness, local: false }.into())
                })
            });
            surfaces.collect()
        }
        Some(Datapath::Peak) => {
            FRAMES.iter().flat_map(|&frame| switch.map(|horizon| PeakPlan { frame, horizon }.into())).collect()
        }
    }
}
