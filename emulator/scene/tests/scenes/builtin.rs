//! Built-in scenes.

use roughxel_scene::{Scene, builtin_names};

#[test]
fn every_built_in_scene_is_read_without_a_warning() {
    for name in builtin_names() {
        let scene = Scene::builtin(name).unwrap().unwrap();
        assert_eq!((scene.name.as_str(), scene.warnings.as_slice()), (name, [].as_slice()));
        assert_eq!((scene.camera.width, scene.camera.height), (640, 480));
        assert!(!scene.objects.is_empty());
        for object in &scene.objects {
            assert!(object.mesh.triangles.len() > 1);
            let bump_is_rough =
                object.material.bump.as_ref().is_none_or(|bump| bump.offsets.iter().any(|offset| *offset != [0.0; 2]));
            assert!(bump_is_rough, "{name}: {}", object.name);
        }
    }
    assert!(Scene::builtin("no such scene").is_none());
}
