//! Lights, highlights and peaks of scenes.

use std::path::Path;

use glam::DVec3;
use roughxel_scene::*;

const HEAD: &str = "camera = { eye = [0, 1, 5], target = [0, 0, 0] }\n";
const SUN: &str = "[[light]]\ndirection = [0, 0, 2]\n";

fn read(rest: &str) -> Result<Scene, SceneError> {
    Scene::from_toml("test.toml", &format!("{HEAD}{rest}"), Path::new("no such folder"))
}

fn material(lights: &str, keys: &str) -> Result<Scene, SceneError> {
    read(&format!("{lights}[[object]]\nshape = \"plane\"\n[object.material]\n{keys}\n"))
}

fn message(scene: Result<Scene, SceneError>) -> String {
    match scene {
        Ok(_) => panic!("no error"),
        Err(error) => {
            assert!(error.fault().is_some(), "{error} has no place");
            error.to_string()
        }
    }
}

#[test]
fn lights_are_directions_or_points_with_colours() {
    let scene = read(&format!("{SUN}[[light]]\nposition = [1, 2, 3]\ncolour = [4, 0.5, 0]\n")).unwrap();
    let sun = Light { place: LightPlace::Direction(DVec3::Z), colour: [1.0; 3] };
    let lamp = Light { place: LightPlace::Point(DVec3::new(1.0, 2.0, 3.0)), colour: [4.0, 0.5, 0.0] };
    assert_eq!(scene.lights, [sun, lamp]);
    assert!(message(read("[[light]]\n")).contains("nowhere"));
    assert!(message(read("[[light]]\ndirection = [0, 0, 0]\n")).contains("no length"));
    assert!(message(read("[[light]]\nposition = [0, 0, 0]\ncolour = [17, 0, 0]\n")).contains("out of range"));
    assert!(message(read(&SUN.repeat(MAX_LIGHTS + 1))).contains("too many"));
}

#[test]
fn highlights_and_peaks_have_their_defaults_and_ranges() {
    let highlight = |keys| material(SUN, keys).map(|scene| scene.objects[0].material.highlight);
    let found = highlight("highlight = {}").unwrap().unwrap();
    assert_eq!((found.exponent, found.colour, found.form), (64.0, [1.0; 3], HighlightForm::Corrected));
    assert_eq!(highlight("highlight = { form = \"printed\" }").unwrap().unwrap().form, HighlightForm::Printed);
    assert_eq!(highlight("").unwrap(), None);
    for keys in ["exponent = 0.5", "exponent = 9000", "colour = [2, 0, 0]"] {
        assert!(message(material(SUN, &format!("highlight = {{ {keys} }}"))).contains("out of range"), "{keys}");
    }

    let peaks = "peaks = { given = [{ amplitude = 0.4, normal = [0.3, 0, 0.4], exponent = 100 }] }";
    let found = material(SUN, peaks).unwrap().objects[0].material.peaks.clone().unwrap();
    let given = GivenPeak { amplitude: 0.4, normal: DVec3::new(0.6, 0.0, 0.8), exponent: 100.0 };
    assert_eq!(found.source, PeakSource::Given(vec![given]));
    assert_eq!(found.shadowing, None);
    let bumps = "height_map = { generate = \"bumps\", size = 16 }\npeaks = { shadowing = true }";
    let found = material(SUN, bumps).unwrap().objects[0].material.peaks.clone().unwrap();
    assert_eq!(found.source, PeakSource::Bump { exponent: 40.0, amplitude: 1.0 });
    assert_eq!(found.shadowing, Some(Shadowing::Correlated));
}

#[test]
fn what_cannot_shine_says_why() {
    assert!(message(material("", "highlight = {}")).contains("no light for `highlight`"));
    assert!(message(material("", "peaks = {}")).contains("no light for `peaks`"));
    assert!(message(material(SUN, "peaks = {}")).contains("no bumps"));
    assert!(message(material(SUN, "peaks = { given = [] }")).contains("number of peaks"));
    let zero = "peaks = { given = [{ amplitude = 1, normal = [0, 0, 0], exponent = 5 }] }";
    assert!(message(material(SUN, zero)).contains("no length"));
    let exponent = "peaks = { given = [{ amplitude = 1, normal = [0, 0, 1], exponent = 0 }] }";
    assert!(message(material(SUN, exponent)).contains("out of range"));
    let both = "peaks = { exponent = 3, given = [{ amplitude = 1, normal = [0, 0, 1], exponent = 5 }] }";
    assert!(message(material(SUN, both)).contains("their own"));
    let shadow = "peaks = { shadowing = true, given = [{ amplitude = 1, normal = [0, 0, 1], exponent = 5 }] }";
    assert!(message(material(SUN, shadow)).contains("no heights"));
    let two = "highlight = {}\npeaks = { given = [{ amplitude = 1, normal = [0, 0, 1], exponent = 5 }] }";
    assert!(message(material(SUN, two)).contains("one of"));
}
