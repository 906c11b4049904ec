//! Filtered pictures of third-party maps, against 16 samples a pixel.
//!
//! Run with `--nocapture` to see the measured figures; `picture-bars` prints the gain in speed.

use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_host_tests::bars::{BEHIND_16_SAMPLES, real_scenes, scene_figures};
use roughxel_host_tests::space::whole_or;
use roughxel_scene::{Scene, builtin_names};
use roughxel_shader::Effect;

#[test]
fn filtered_pictures_of_real_scenes_are_near_to_what_16_samples_reach() {
    let Some(scenes) = real_scenes() else { return };
    for real in scenes {
        let edge = whole_or(16, 8);
        let figures = scene_figures(&real.scene, &Precision::STANDARD, edge, &|| ()).expect("the scene can be drawn");
        println!("{}: {figures:.1?}", real.name);
        assert!(figures.footprint >= figures.supersampled_16 - BEHIND_16_SAMPLES, "{}: {figures:?}", real.name);
    }
}

/// `globe` is land and sea, which are of two kinds only over the whole map: two lobes are 2 to 4 dB worse for it.
#[test]
fn bricks_alone_have_two_lobes() {
    let has_two = |scene: &Scene| {
        let prepared = Prepared::new(scene, Mode::Footprint, &Precision::STANDARD).expect("the scene can be drawn");
        prepared.plans().any(|plan| plan.has(Effect::TwoLobes))
    };
    let reflects = |scene: &Scene| scene.objects.iter().any(|object| object.material.reflectance != [0.0; 3]);
    for name in builtin_names() {
        let scene = Scene::builtin(name).expect("the scene is built in").expect("the scene is valid");
        assert!(!reflects(&scene) || !has_two(&scene), "{name}");
    }
    let Some(scenes) = real_scenes() else { return };
    for real in scenes.into_iter().filter(|real| reflects(&real.scene)) {
        assert_eq!(has_two(&real.scene), real.name == "plane of bricks", "{}", real.name);
    }
}
