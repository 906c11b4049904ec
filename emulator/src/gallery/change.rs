//! What a column changes in a scene, so that one effect can be seen by its absence.

use std::sync::Arc;

use roughxel_core::precision::{Precision, RoughnessKind};

use crate::plan::Effect;
use crate::scene::{FrameSystem, OFFSET_LIMIT, Scene, Vertex};

/// A change before drawing.
#[derive(Clone, Copy, Debug)]
pub enum Change {
    /// None.
    Nothing,
    /// Of the scene.
    Scene(fn(&mut Scene)),
    /// Of the profile.
    Profile(fn(&mut Precision)),
    /// The plan of every object loses an effect.
    Without(Effect),
}

impl Change {
    /// Makes the change of scene or profile; plans are made after it.
    pub fn apply(self, scene: &mut Scene, precision: &mut Precision) {
        match self {
            Self::Nothing | Self::Without(_) => {}
            Self::Scene(change) => change(scene),
            Self::Profile(change) => change(precision),
        }
    }
}

/// S97's frame system 1: p_u and p_v with their lengths, which shrink towards a pole. Offsets become slopes per unit of u and v,
/// heights the same as before where p_u and p_v are longest.
pub fn natural_frame(scene: &mut Scene) {
    for object in &mut scene.objects {
        let longest = |length: fn(&Vertex) -> f64| object.mesh.vertices.iter().map(length).fold(0.0, f64::max) as f32;
        let scale = [longest(|vertex| vertex.tangents[0].length()), longest(|vertex| vertex.tangents[1].length())];
        object.material.frame = FrameSystem::Natural;
        if let Some(bump) = &mut object.material.bump {
            for offset in &mut Arc::make_mut(bump).offsets {
                *offset = [0, 1].map(|i| (offset[i] * scale[i]).clamp(-OFFSET_LIMIT, OFFSET_LIMIT));
            }
        }
    }
}

/// S97's frame system 2: p_u and p_v without their lengths.
pub fn natural_normalised_frame(scene: &mut Scene) {
    scene.objects.iter_mut().for_each(|object| object.material.frame = FrameSystem::NaturalNormalised);
}

/// Roughness by its widest direction only.
pub fn isotropic_roughness(precision: &mut Precision) {
    if precision.roughness == RoughnessKind::Anisotropic {
        precision.roughness = RoughnessKind::Isotropic;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn material(keys: &str) -> Scene {
        let text = format!(
            "camera = {{ eye = [0, 1, 5], target = [0, 0, 0] }}\n\
             [[object]]\nshape = \"sphere\"\n[object.material]\n{keys}\n"
        );
        Scene::from_toml("test.toml", &text, Path::new("")).unwrap()
    }

    #[test]
    fn frames_change_to_what_the_scene_file_would_give() {
        let earth = |scale: f64| format!("height_map = {{ generate = \"earth\", size = 32, scale = {scale} }}\n");
        // A radius of 1: a repeat along u is 2π world units long on the equator.
        let expected = material(&format!("{}frame = \"natural\"", earth(0.01 * std::f64::consts::TAU)));
        let mut scene = material(&earth(0.01));
        natural_frame(&mut scene);
        let [found, expected] = [&scene, &expected].map(|scene| &scene.objects[0].material);
        assert_eq!(found.frame, expected.frame);
        let offsets = [found, expected].map(|m| m.bump.as_ref().unwrap().offsets.iter().flatten().copied());
        let [found, expected] = offsets.map(Iterator::collect::<Vec<f32>>);
        assert!(expected.iter().any(|offset| offset.abs() > 0.1));
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() <= 1e-5 * b.abs(), "{a}, {b}");
        }

        let mut scene = material(&earth(0.01));
        let bump = scene.objects[0].material.bump.clone();
        natural_normalised_frame(&mut scene);
        let found = &scene.objects[0].material;
        assert_eq!((found.frame, &found.bump), (FrameSystem::NaturalNormalised, &bump));
    }

    #[test]
    fn roughness_becomes_isotropic_where_there_is_any() {
        for (before, after) in [
            (RoughnessKind::Anisotropic, RoughnessKind::Isotropic),
            (RoughnessKind::Isotropic, RoughnessKind::Isotropic),
            (RoughnessKind::None, RoughnessKind::None),
        ] {
            let mut precision = Precision { roughness: before, ..Precision::STANDARD };
            Change::Profile(isotropic_roughness).apply(&mut material(""), &mut precision);
            assert_eq!(precision, Precision { roughness: after, ..Precision::STANDARD });
        }
    }
}
