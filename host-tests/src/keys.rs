//! Keys of effects in a scene.

use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_scene::Scene;
use roughxel_shader::Effect;

/// Returns true if keys of a scene, or a profile, ask for an effect. The mode and the mesh decide about the other effects.
pub fn has_keys(effect: Effect) -> bool {
    ![Effect::Footprint, Effect::Edges, Effect::Curvature].contains(&effect)
}

/// The scene without the keys of an effect, and the remaining profile if the effect has no keys.
pub fn without_keys(scene: &Scene, effect: Effect, p: &Precision) -> (Scene, Precision) {
    let (mut scene, mut p) = (scene.clone(), *p);
    for material in scene.objects.iter_mut().map(|object| &mut object.material) {
        match effect {
            Effect::ColourTexture => material.colour_map = None,
            Effect::Bump => (material.bump, material.roughness, material.peaks) = (None, None, None),
            // Lost detail has no key; a profile may leave it out.
            Effect::Roughness => p.roughness = RoughnessKind::None,
            Effect::Environment => material.reflectance = [0.0; 3],
            Effect::TwoLobes => material.two_lobes = Some(false),
            // The mode and the mesh decide.
            Effect::Footprint | Effect::Edges | Effect::Curvature => {}
            Effect::Highlight => material.highlight = None,
            Effect::Peaks => material.peaks = None,
            Effect::Horizon => {
                if let Some(peaks) = &mut material.peaks {
                    peaks.shadowing = None;
                }
            }
        }
    }
    (scene, p)
}
