//! Changes that a column makes to a scene, so that an effect shows by its absence.

use std::sync::Arc;

use glam::DVec3;
use roughxel_assets::Vertex;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_scene::{
    FootprintPlace, FrameSystem, GivenPeak, Highlight, HighlightForm, OFFSET_LIMIT, PeakSource, Scene, Shadowing,
};
use roughxel_shader::Effect;

/// A change before drawing.
#[derive(Clone, Copy, Debug)]
pub enum Change {
    /// No change.
    Nothing,
    /// Change of the scene.
    Scene(fn(&mut Scene)),
    /// Change of the profile.
    Profile(fn(&mut Precision)),
    /// Removal of an effect from the plan of every object.
    Without(Effect),
}

impl Change {
    /// Applies the change to scene or profile. Plans are made afterwards.
    pub fn apply(self, scene: &mut Scene, precision: &mut Precision) {
        match self {
            Self::Nothing | Self::Without(_) => {}
            Self::Scene(change) => change(scene),
            Self::Profile(change) => change(precision),
        }
    }
}

/// Removes colour maps and bumps, which leaves the smooth surface. Peaks of a bump map become one peak along the normal.
pub fn no_texture(scene: &mut Scene) {
    for object in &mut scene.objects {
        let material = &mut object.material;
        (material.colour_map, material.bump) = (None, None);
        if let Some(peaks) = &mut material.peaks {
            peaks.shadowing = None;
            if let PeakSource::Bump { exponent, amplitude } = peaks.source {
                peaks.source = PeakSource::Given(vec![GivenPeak { amplitude, normal: DVec3::Z, exponent }]);
            }
        }
    }
}

/// Replaces given peaks with one along the normal, with amplitude and exponent of the first.
pub fn single_normal(scene: &mut Scene) {
    for peaks in scene.objects.iter_mut().filter_map(|object| object.material.peaks.as_mut()) {
        if let PeakSource::Given(given) = &mut peaks.source {
            given.truncate(1);
            given.iter_mut().for_each(|peak| peak.normal = DVec3::Z);
        }
    }
}

/// Removes shadowing: bumps hide each other neither from the light nor from the eye.
pub fn no_shadowing(scene: &mut Scene) {
    scene.objects.iter_mut().filter_map(|object| object.material.peaks.as_mut()).for_each(|p| p.shadowing = None);
}

/// Puts footprints of reflections on the plane of a cube face for any roughness (W97).
pub fn footprints_on_a_face(scene: &mut Scene) {
    for object in &mut scene.objects {
        object.material.footprint = Some(FootprintPlace::Face);
    }
}

/// Multiplies the shares of light and eye, if there is shadowing.
pub fn product_of_shares(scene: &mut Scene) {
    let peaks = scene.objects.iter_mut().filter_map(|object| object.material.peaks.as_mut());
    for shadowing in peaks.filter_map(|peaks| peaks.shadowing.as_mut()) {
        *shadowing = Shadowing::Product;
    }
}

/// Uses Blinn-Phong highlights, which ignore roughness.
pub fn plain_highlight(scene: &mut Scene) {
    highlight_form(scene, HighlightForm::Plain);
}

/// Uses the highlight formula as printed in S97, Appendix A.
pub fn printed_highlight(scene: &mut Scene) {
    highlight_form(scene, HighlightForm::Printed);
}

fn highlight_form(scene: &mut Scene, form: HighlightForm) {
    let set = |highlight: &mut Highlight| highlight.form = form;
    scene.objects.iter_mut().filter_map(|object| object.material.highlight.as_mut()).for_each(set);
}

/// Uses frame system 1 of S97: p_u and p_v with their lengths, which shrink towards a pole.
///
/// Offsets become slopes per unit of u and v. Heights do not change at the place where p_u and p_v are longest.
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

/// Uses frame system 2 of S97: p_u and p_v without their lengths.
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
            "camera = {{ eye = [0, 1, 5], target = [0, 0, 0] }}\n[[light]]\ndirection = [0, 0, 1]\n\
             [[object]]\nshape = \"sphere\"\n[object.material]\n{keys}\n"
        );
        Scene::from_toml("test.toml", &text, Path::new("")).unwrap()
    }

    #[test]
    fn a_surface_without_texture_keeps_one_peak_along_its_normal() {
        let mut scene = material(
            "colour_map = { generate = \"earth\", size = 16 }\nheight_map = { generate = \"bumps\", size = 16 }\n\
             peaks = { exponent = 30, amplitude = 2, shadowing = true }",
        );
        no_texture(&mut scene);
        let material = &scene.objects[0].material;
        assert!(material.colour_map.is_none() && material.bump.is_none());
        let peaks = material.peaks.as_ref().unwrap();
        let one = GivenPeak { amplitude: 2.0, normal: DVec3::Z, exponent: 30.0 };
        assert_eq!((&peaks.source, peaks.shadowing), (&PeakSource::Given(vec![one]), None));
    }

    #[test]
    fn several_normals_become_one() {
        let mut scene = material(
            "peaks = { given = [{ amplitude = 0.4, normal = [0.6, 0, 0.8], exponent = 100 }, \
             { amplitude = 1, normal = [0, 0, 1], exponent = 5 }] }",
        );
        single_normal(&mut scene);
        let one = GivenPeak { amplitude: 0.4, normal: DVec3::Z, exponent: 100.0 };
        assert_eq!(scene.objects[0].material.peaks.as_ref().unwrap().source, PeakSource::Given(vec![one]));
    }

    #[test]
    fn shadowing_and_formulas_change_and_nothing_else() {
        let mut scene = material("height_map = { generate = \"bumps\", size = 16 }\npeaks = { shadowing = true }");
        let before = scene.objects[0].material.peaks.clone().unwrap();
        no_shadowing(&mut scene);
        let after = scene.objects[0].material.peaks.clone().unwrap();
        assert!(before.shadowing.is_some() && after.shadowing.is_none() && before.source == after.source);

        let mut scene = material("highlight = { exponent = 20 }");
        for (change, form) in
            [(plain_highlight as fn(&mut Scene), HighlightForm::Plain), (printed_highlight, HighlightForm::Printed)]
        {
            change(&mut scene);
            let expected = Highlight { exponent: 20.0, colour: [1.0; 3], form };
            assert_eq!(scene.objects[0].material.highlight, Some(expected));
        }
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
