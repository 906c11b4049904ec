//! Maps that objects share are prepared once, and no bit of a frame shows it.

use std::path::Path;
use std::sync::Arc;

use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_scene::Scene;
use roughxel_shader::Effect;

/// Spheres in a row with one colour map and one height map, and with these further keys.
fn scene(keys: &[&str]) -> Scene {
    let mut text = "camera = { eye = [0, 2, 9], target = [0, 0, 0], width = 96, height = 32 }\n\
                    [environment]\ngenerate = \"sky\"\nface_edge = 32\n\
                    [[light]]\ndirection = [1, 1, 1]\n"
        .to_owned();
    for (index, keys) in keys.iter().enumerate() {
        text += &format!(
            "[[object]]\nshape = \"sphere\"\nradius = 0.8\ntranslate = [{}, 0, 0]\n[object.material]\n\
             colour_map = {{ generate = \"noise\", size = 64 }}\nheight_map = {{ generate = \"bumps\", size = 64, cells = 4 }}\n{keys}\n",
            2.0 * index as f64 - 4.0
        );
    }
    Scene::from_toml("shared.toml", &text, Path::new("")).expect("the scene is good")
}

/// Copy of a scene in which each object has maps of its own.
fn separate(mut scene: Scene) -> Scene {
    for object in &mut scene.objects {
        let material = &mut object.material;
        material.colour_map = material.colour_map.as_deref().map(|map| Arc::new(map.clone()));
        material.bump = material.bump.as_deref().map(|bump| Arc::new(bump.clone()));
    }
    scene
}

fn prepared(scene: &Scene, mode: Mode) -> Prepared<'_> {
    Prepared::new(scene, mode, &Precision::STANDARD).expect("the scene can be drawn")
}

#[test]
fn objects_with_one_map_draw_the_bits_of_objects_with_maps_of_their_own() {
    let keys = [
        "reflectance = [0.5, 0.5, 0.5]",
        // The roughness is not read: a form of its own.
        "highlight = { form = \"plain\" }",
        // Offsets of the other sign, and a different law.
        "reflectance = [0.9, 0.9, 0.9]\nframe = \"natural\"",
        "reflectance = [0.5, 0.5, 0.5]\nbump_deviation = \"root-mean-square\"",
        "peaks = { exponent = 64, shadowing = \"product\" }",
        "peaks = { exponent = 64 }",
    ];
    let mut shared = scene(&keys);
    // A scene makes a map of its own for a frame, and for shadows; here one serves all.
    let bump = shared.objects[4].material.bump.clone();
    shared.objects.iter_mut().for_each(|object| object.material.bump.clone_from(&bump));
    let separate = separate(shared.clone());
    for mode in [Mode::Footprint, Mode::Unfiltered] {
        let [one, own] = [&shared, &separate].map(|scene| prepared(scene, mode));
        assert!(one.plans().eq(own.plans()) && one.decisions().eq(own.decisions()), "{mode}");
        assert!((0..keys.len()).all(|object| one.map_bytes(object) == own.map_bytes(object)), "{mode}");
        let [drawn, expected] = [&one, &own].map(|prepared| prepared.render(&|| ()).expect("the scene can be drawn"));
        assert_eq!(drawn.digest(), expected.digest(), "{mode}");
    }
}

#[test]
fn a_map_that_objects_share_counts_once() {
    let keys = ["reflectance = [0.5, 0.5, 0.5]"; 5];
    let bytes = |scene: &Scene| prepared(scene, Mode::Footprint).all_map_bytes();
    let (one, five) = (scene(&keys[..1]), scene(&keys));
    let of_one = prepared(&one, Mode::Footprint).map_bytes(0);
    let environment = of_one.iter().find(|(effect, _)| *effect == Effect::Environment).expect("it is reflected").1;
    let maps = bytes(&one) - environment;
    assert_eq!(bytes(&five), environment + maps);
    assert_eq!(bytes(&separate(five)), environment + 5 * maps);
}
