//! Maps that objects share are made once, and no pixel shows it.

use std::path::Path;
use std::sync::Arc;

use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_reference_renderer::render;
use roughxel_scene::Scene;

/// Spheres in a row with one colour map and one height map, and with these further keys.
fn scene(keys: &[&str]) -> Scene {
    let mut text = "camera = { eye = [0, 2, 9], target = [0, 0, 0], width = 48, height = 16 }\n\
                    [environment]\ngenerate = \"sky\"\nface_edge = 16\n"
        .to_owned();
    for (index, keys) in keys.iter().enumerate() {
        text += &format!(
            "[[object]]\nshape = \"sphere\"\nradius = 0.8\ntranslate = [{}, 0, 0]\n[object.material]\n\
             colour_map = {{ generate = \"noise\", size = 32 }}\n\
             height_map = {{ generate = \"bumps\", size = 32, cells = 4 }}\n{keys}\n",
            2.0 * index as f64 - 4.0
        );
    }
    Scene::from_toml("shared.toml", &text, Path::new("")).unwrap()
}

#[test]
fn objects_with_one_map_show_what_objects_with_maps_of_their_own_show() {
    let keys = [
        "reflectance = 0.5",
        "reflectance = 0",
        "reflectance = 0.9\nframe = \"natural\"",
        "reflectance = 0.5\nbump_deviation = \"law\"",
    ];
    let mut shared = scene(&keys);
    let (bump, colour) = {
        let first = &shared.objects[0].material;
        (first.bump.clone(), first.colour_map.clone())
    };
    assert!(bump.is_some() && colour.is_some());
    for object in &mut shared.objects {
        object.material.bump.clone_from(&bump);
        object.material.colour_map.clone_from(&colour);
    }
    let mut separate = shared.clone();
    for object in &mut separate.objects {
        let material = &mut object.material;
        material.bump = material.bump.as_deref().map(|bump| Arc::new(bump.clone()));
        material.colour_map = material.colour_map.as_deref().map(|map| Arc::new(map.clone()));
    }
    for mode in [Mode::Footprint, Mode::Unfiltered] {
        let [one, own] = [&shared, &separate].map(|scene| render(scene, mode, &Precision::STANDARD, &|| ()).unwrap());
        assert_eq!(one.pixels, own.pixels, "{mode:?}");
    }
}
