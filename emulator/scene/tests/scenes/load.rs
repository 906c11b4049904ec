//! Scenes that load, and scenes that are refused.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use roughxel_scene::*;

const CAMERA: &str = "camera = { eye = [0, 1, 5], target = [0, 0, 0] }\n";
const STUDIO: &str = "environment = { generate = \"studio\", face_edge = 8 }\n";

fn read(rest: &str) -> Result<Scene, SceneError> {
    Scene::from_toml("test.toml", &format!("{CAMERA}{rest}"), Path::new("no such folder"))
}

fn plane(material: &str) -> Result<Scene, SceneError> {
    read(&format!("{STUDIO}[[object]]\nshape = \"plane\"\n[object.material]\n{material}\n"))
}

#[test]
fn defaults_are_those_of_the_readme() {
    let scene = plane("").unwrap();
    let camera = scene.camera;
    assert_eq!((camera.up, camera.fov_y_degrees, camera.width, camera.height), (DVec3::Y, 40.0, 640, 480));
    assert_eq!(scene.background, Background::Environment);
    let object = &scene.objects[0];
    assert_eq!((object.name.as_str(), object.mesh.triangles.len()), ("object 1", 2));
    let material = &object.material;
    assert_eq!((material.colour, material.reflectance), ([1.0; 3], [0.0; 3]));
    assert_eq!((material.frame, material.main_direction), (FrameSystem::MainDirection, DVec3::NEG_Z));
    assert!(material.bump.is_none() && material.colour_map.is_none());
    assert_eq!(read("").unwrap().background, Background::Colour([0.0; 3]));
}

#[test]
fn exposure_scales_an_environment_and_what_it_cuts_is_told() {
    let sky = |keys: &str| {
        let text = format!("environment = {{ generate = \"sky\", face_edge = 16, radius_degrees = 20{keys} }}\n");
        let scene = read(&text).unwrap();
        (scene.environment.unwrap().faces, scene.warnings)
    };
    let (plain, _) = sky("");
    for (exposure, factor) in [("-10", 0.5_f32.powi(10)), ("0.0", 1.0), ("2", 4.0), ("10.0", 1024.0)] {
        let (exposed, warnings) = sky(&format!(", exposure = {exposure}"));
        let pixels = plain.iter().zip(&exposed).flat_map(|(a, b)| a.pixels.iter().zip(&b.pixels));
        assert!(pixels.into_iter().all(|(a, b)| a.map(|channel| channel * factor) == *b), "{exposure}");
        assert!(warnings.is_empty(), "{warnings:?}");
    }
    // The brightest generated sun.
    assert!(sky(", sun = [1000, 1000, 1000], exposure = 10").1.is_empty());
    // A moon in a bright sky: light is added around the moon.
    let keys = "glow = [1000, 1000, 1000], zenith = [1000, 1000, 1000], horizon = [1000, 1000, 1000], exposure = 10";
    let text = format!("environment = {{ generate = \"moon\", face_edge = 16, glow_degrees = 90, {keys} }}\n");
    let [warning] = read(&text).unwrap().warnings.try_into().unwrap();
    assert!(warning.starts_with("environment: ") && warning.contains("of the light is above 1048320"), "{warning}");
}

#[test]
fn equal_maps_are_made_once_wherever_they_stand() {
    let object = "[[object]]\nshape = \"plane\"\n[object.material]\n\
                  colour_map = { generate = \"noise\", size = 16 }\nheight_map = { generate = \"bumps\", size = 16 }\n";
    let scene = read(&object.repeat(2)).unwrap();
    let [first, second] = [0, 1].map(|index| &scene.objects[index].material);
    assert!(first.colour_map.is_some() && first.bump.is_some());
    assert!(Arc::ptr_eq(first.colour_map.as_ref().unwrap(), second.colour_map.as_ref().unwrap()));
    assert!(Arc::ptr_eq(first.bump.as_ref().unwrap(), second.bump.as_ref().unwrap()));
}

/// Message, line and column of the error of a whole scene text.
fn fault(text: &str) -> (String, usize, usize) {
    match Scene::from_toml("test.toml", text, Path::new("no such folder")) {
        Ok(_) => panic!("no error in {text}"),
        Err(error) => {
            let fault = error.fault().unwrap();
            (error.to_string(), fault.line, fault.column)
        }
    }
}

#[test]
fn bad_scenes_name_line_column_and_remedy() {
    let object = |line: &str| format!("{CAMERA}{STUDIO}[[object]]\nshape = \"plane\"\n{line}\n");
    let material = |line: &str| object(&format!("[object.material]\n{line}"));
    for (text, place, expected) in [
        ("camera = {".to_owned(), (1, 11), ""),
        ("x = 1\n".to_owned(), (1, 1), "unknown field `x`, expected one of `camera`"),
        (format!("{CAMERA}\ncolor = 1\n"), (3, 1), "unknown field `color`"),
        ("[camera]\neye = [0, 0, 0]\n".to_owned(), (1, 1), "missing field `target`"),
        ("[camera]\neye = [0, 0]\ntarget = [0, 0, 1]\n".to_owned(), (2, 7), "invalid length 2"),
        ("[camera]\neye = [0, 0, 0, 0]\ntarget = [0, 0, 1]\n".to_owned(), (2, 7), "invalid length 4"),
        (material("colour = [1, 1, 1, 1]"), (6, 10), "invalid length 4, expected an array of 3 numbers"),
        (material("reflectance = [1, 1, 1, 1]"), (6, 15), "invalid length 4"),
        (object("size = [1, 1, 1]"), (5, 8), "invalid length 3, expected an array of 2 numbers"),
        (object("segments = [1, 1, 1]"), (5, 12), "invalid length 3"),
        (
            format!("{CAMERA}[[light]]\nposition = [0, 0, 1]\ndirection = [0, 1, 0]\n"),
            (3, 12),
            "both `direction` and `position`",
        ),
        ("[camera]\neye = \"here\"\n".to_owned(), (2, 7), "invalid type: string"),
        ("[camera]\neye = [nan, 0, 0]\ntarget = [0, 0, 1]\n".to_owned(), (2, 7), "`eye` is NaN"),
        ("[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 1]\n".to_owned(), (3, 10), "move them apart"),
        ("[camera]\neye = [0, 1, 0]\ntarget = [0, 0, 0]\n".to_owned(), (3, 10), "not parallel"),
        ("[camera]\neye = [0, 1, 0]\ntarget = [1, 0, 0]\nfov_y = 180\n".to_owned(), (4, 9), "from 0.1 to 170"),
        ("[camera]\neye = [0, 1, 0]\ntarget = [1, 0, 0]\nwidth = 0\n".to_owned(), (4, 9), "from 1 to 16384"),
        (
            "[camera]\neye = [0, 1, 0]\ntarget = [1, 0, 0]\nwidth = 16384\nheight = 16384\n".to_owned(),
            (5, 10),
            "too many",
        ),
        (format!("{CAMERA}background = {{ top = [0, 0, 0] }}\n"), (2, 14), "exactly one of"),
        (format!("{CAMERA}background = {{ environment = true }}\n"), (2, 30), "no environment to show"),
        (format!("{CAMERA}environment = {{ generate = \"mars\" }}\n"), (2, 28), "moon, zebra"),
        (format!("{CAMERA}environment = {{ generate = \"moon\", stripes = 3 }}\n"), (2, 36), "known here: `generate`"),
        (format!("{CAMERA}environment = {{ faces = [\"a\", \"b\"] }}\n"), (2, 25), "name six"),
        (format!("{CAMERA}environment = {{ equirectangular = \"a.png\" }}\n"), (2, 35), "a.png"),
        (
            format!("{CAMERA}environment = {{ generate = \"moon\", exposure = 11 }}\n"),
            (2, 47),
            "`exposure` is 11, which is out of range (choose a number from -10 to 10)",
        ),
        (format!("{CAMERA}environment = {{ generate = \"moon\", exposure = -10.5 }}\n"), (2, 47), "from -10 to 10"),
        (format!("{CAMERA}environment = {{ generate = \"moon\", exposure = nan }}\n"), (2, 47), "out of range"),
        (format!("{CAMERA}environment = {{ generate = \"moon\", exposure = \"2\" }}\n"), (2, 47), "wrong type"),
        (object("radius = 2"), (5, 10), "this shape takes: size, segments"),
        (object("arc_degrees = 90"), (5, 15), "this shape takes: size, segments"),
        (object("size = [1, -1]"), (5, 8), "out of range"),
        (format!("{CAMERA}[[object]]\nshape = \"cylinder\"\narc_degrees = 361\n"), (4, 15), "from 1 to 360"),
        (format!("{CAMERA}[[object]]\nshape = \"drapery\"\nfolds = 0\n"), (4, 9), "from 0.25 to 64"),
        (format!("{CAMERA}[[object]]\nshape = \"drapery\"\nradius = 1\n"), (4, 10), "size, depth, folds, segments"),
        (object("segments = [0, 4]"), (5, 12), "from 1 to 1024"),
        (object("scale = [1, 0, 1]"), (5, 9), "out of range"),
        (object("scale = [1, 1]"), (5, 9), "three numbers"),
        (object("scale = \"big\""), (5, 9), "a number or an array of three numbers"),
        (object("rotate_degrees = [inf, 0, 0]"), (5, 18), "out of range"),
        (object("scale = 10000\ntranslate = [1e6, 1e6, 1e6]\nsize = [1e6, 1]"), (4, 9), "too far out"),
        (material("reflectance = 1.5"), (6, 15), "out of range"),
        (material("frame = \"frenet\""), (6, 9), "unknown variant `frenet`, expected one of"),
        (material("main_direction = [0, 0, 0]"), (6, 18), "no length"),
        (material("colour_map = {}"), (6, 14), "exactly one of `path` and `generate`"),
        (material("colour_map = { generate = \"noise\", sise = 3 }"), (6, 36), "did you mean `size`?"),
        (material("colour_map = { generate = \"noise\", size = 3.5 }"), (6, 43), "a whole number"),
        (material("colour_map = { generate = \"writing\", text = \"ä\" }"), (6, 45), "no letter `Ä`"),
        (material("colour_map = { path = \"missing.png\" }"), (6, 23), "missing.png"),
        (material("height_map = { generate = \"waves\", scale = 1, rms_slope = 1 }"), (6, 14), "keep one"),
        (material("height_map = { generate = \"wafes\" }"), (6, 27), "did you mean `waves`?"),
        (material("normal_map = { generate = \"waves\" }"), (6, 27), "no generated normal map `waves`"),
        (material("roughness_map = {}"), (6, 17), "exactly one of `path` and `generate`"),
        (material("roughness_map = { generate = \"uniform\", along = 5 }"), (6, 49), "from 0 to 4"),
        (material("roughness_map = { generate = \"uniform\", deviation = 1 }"), (6, 41), "unknown key `deviation`"),
        (material("roughness_map = { generate = \"waves\", channels = \"d\" }"), (6, 50), "`channels` is \"d\""),
        (
            material("frame = \"natural\"\nroughness_map = { generate = \"uniform\" }"),
            (7, 17),
            "takes no roughness map",
        ),
        (
            material(
                "height_map = { generate = \"bumps\", size = 16 }\n\
                 roughness_map = { generate = \"bumps\", size = 8 }",
            ),
            (7, 17),
            "the roughness map has 8×8 texels and the bump map 16×16 (make both the same size)",
        ),
        (material("height_map = { generate = \"grooves\", periods_u = 0 }"), (6, 14), "no period"),
        (material("frame = \"natural\"\nnormal_map = { path = \"n.png\" }"), (7, 14), "needs heights"),
        (material("height_map = { generate = \"waves\", wrap = \"no\" }"), (6, 43), "give true or false"),
        (material("normal_map = { generate = \"hammered\", wrap = false }"), (6, 46), "belongs to a height map"),
        (material("normal_map = { generate = \"hammered\", green = \"dwon\" }"), (6, 47), "did you mean `down`?"),
        (material("height_map = { generate = \"waves\", green = \"down\" }"), (6, 36), "unknown key `green`"),
        (material("height_map = { generate = \"waves\" }\nnormal_map = { path = \"n.png\" }"), (7, 14), "one bump map"),
        (format!("{CAMERA}[[object]]\nshape = \"cube\"\n"), (3, 9), "unknown variant `cube`"),
        (format!("{CAMERA}[[object]]\nshape = \"mesh\"\n"), (2, 1), "a mesh needs a file"),
        (format!("{CAMERA}[[object]]\nshape = \"mesh\"\npath = \"no.obj\"\n"), (4, 8), "no.obj"),
        (format!("{CAMERA}[[object]]\nshape = \"mesh\"\ngenerate = \"cow\"\n"), (4, 12), "no generated mesh `cow`"),
        (
            format!("{CAMERA}[[object]]\nshape = \"plane\"\nmaterial = {{ reflectance = 1 }}\n"),
            (4, 28),
            "no environment to reflect",
        ),
    ] {
        let (message, line, column) = fault(&text);
        assert!(message.contains(expected), "{text}\n{message}");
        assert_eq!((line, column), place, "{text}\n{message}");
        assert!(message.starts_with(&format!("test.toml:{line}:{column}: ")), "{message}");
    }
}

#[test]
fn a_scene_cut_anywhere_is_an_error_or_a_scene_but_never_a_panic() {
    let text = builtin_text("shapes").unwrap();
    for end in (0..text.len()).filter(|&end| text.is_char_boundary(end)).step_by(7) {
        let _ = Scene::from_toml("cut", &text[..end], Path::new(""));
    }
}

#[test]
fn files_are_found_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\nf 1/1 1/1 2/2\n");
    write("bad.obj", "v 0 0 nan\n");
    write("square.toml", &format!("{CAMERA}[[object]]\nname = \"it\"\nshape = \"mesh\"\npath = \"square.obj\"\n"));
    write("bad.toml", &format!("{CAMERA}[[object]]\nshape = \"mesh\"\npath = \"bad.obj\"\n"));
    let scene = Scene::from_file(&folder.path().join("square.toml")).unwrap();
    assert_eq!((scene.name.as_str(), scene.objects[0].mesh.triangles.len()), ("square", 1));
    assert_eq!(scene.objects[0].material.frame, FrameSystem::NaturalNormalised);
    assert_eq!(scene.warnings, ["it: 1 triangles without an area were dropped"]);
    let error = Scene::from_file(&folder.path().join("bad.toml")).unwrap_err().to_string();
    assert!(error.contains("bad.toml:4:8: ") && error.contains("bad.obj:1: coordinate `nan`"), "{error}");
    std::fs::write(folder.path().join("binary.toml"), [0xff, 0xfe]).unwrap();
    for (name, expected) in [("binary.toml", "is not UTF-8 text"), ("missing.toml", "cannot read the scene file")] {
        let error = Scene::from_file(&folder.path().join(name)).unwrap_err().to_string();
        assert!(error.contains(&format!("{name}: {expected}")), "{error}");
    }
}

#[test]
fn faces_without_texture_coordinates_take_no_map() {
    let folder = tempfile::tempdir().unwrap();
    let object = "[[object]]\nshape = \"mesh\"\npath = \"x.obj\"\n";
    let plain = format!("{CAMERA}{object}");
    let text = format!("{plain}material = {{ height_map = {{ generate = \"bumps\", size = 8 }} }}\n");
    let read = |obj: &str, text: &str| {
        std::fs::write(folder.path().join("x.obj"), obj).unwrap();
        Scene::from_toml("test.toml", text, folder.path())
    };
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let coordinates = "vt 0 0\nvt 1 0\nvt 1 1\n";
    for (obj, line) in [
        (format!("{square}f 1 2 3\n"), 5),
        // The coordinates of another face do not count for this face.
        (format!("{square}{coordinates}f 1/1 2/2 3/3\nf 1 3 4\n"), 9),
    ] {
        let error = read(&obj, &text).unwrap_err().to_string();
        assert!(error.starts_with("test.toml:5:27: "), "{error}");
        assert!(error.contains(&format!("x.obj:{line}: the face has no texture coordinates")), "{error}");
        assert!(read(&obj, &plain).is_ok());
    }
    assert!(read(&format!("{square}{coordinates}f 1/1 2/2 3/3\n"), &text).is_ok());
}

#[test]
fn hdr_pictures_are_panoramas_and_faces() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, size: &str, pixel: [u8; 4]| {
        let header = format!("#?RADIANCE\n\n{size}\n");
        std::fs::write(folder.path().join(name), [header.as_bytes(), &pixel.repeat(2)].concat()).unwrap();
    };
    write("sky.HDR", "-Y 1 +X 2", [128, 64, 32, 132]);
    write("face.hdr", "-Y 1 +X 1", [128, 64, 32, 132]);
    let face = "\"face.hdr\", ".repeat(6);
    for environment in ["equirectangular = \"sky.HDR\", face_edge = 1", &format!("faces = [{face}]")] {
        let text = format!("{CAMERA}environment = {{ {environment} }}\n");
        let scene = Scene::from_toml("test.toml", &text, folder.path()).unwrap();
        let faces = scene.environment.unwrap().faces;
        assert!(faces.iter().all(|face| face.pixels == [[8.0, 4.0, 2.0]]), "{environment}");
    }
}

#[test]
fn every_step_of_a_map_is_told() {
    #[derive(Default)]
    struct Told(std::sync::Mutex<Vec<(String, u64, u64)>>);
    impl MapProgress for Told {
        fn begin(&self, map: &str, steps: u64) {
            self.0.lock().unwrap().push((map.to_owned(), steps, 0));
        }
        fn step(&self) {
            self.0.lock().unwrap().last_mut().unwrap().2 += 1;
        }
    }
    let told = Told::default();
    let text = format!(
        "{CAMERA}{STUDIO}[[object]]\nshape = \"plane\"\n[object.material]\n\
         colour_map = {{ generate = \"earth\", size = 16 }}\nheight_map = {{ generate = \"brushed\", scratches = 9 }}\n"
    );
    let file = tempfile::NamedTempFile::with_suffix(".toml").unwrap();
    std::fs::write(&file, text).unwrap();
    Scene::open_with(file.path().to_str().unwrap(), &told).unwrap();
    let maps = told.0.into_inner().unwrap();
    assert!(maps.iter().all(|(_, steps, done)| steps == done), "{maps:?}");
    let first: Vec<_> = maps.iter().map(|(map, steps, _)| (map.as_str(), *steps)).collect();
    assert_eq!(first[..6], [("studio", 8); 6]);
    assert_eq!(first[6..], [("earth", 16), ("brushed", 9)]);
}

#[test]
fn a_byte_order_mark_is_skipped_and_counts_as_no_column() {
    assert_eq!(fault("\u{feff}x = 1\n"), fault("x = 1\n"));
    assert!(Scene::from_toml("test.toml", &format!("\u{feff}{CAMERA}"), Path::new("")).is_ok());
}

/// Visible part of a white surface under each reflectance: the share that is not reflected, times the colour.
#[test]
fn white_under_coloured_metal_is_not_tinted() {
    let shown = |keys: &str| {
        let material = plane(keys).unwrap().objects[0].material.clone();
        let shown = |channel: usize| (1.0 - material.reflectance[channel]) * material.colour[channel];
        ([0, 1, 2].map(shown), material.colour)
    };
    let (gold, _) = shown("reflectance = [0.9, 0.8, 0.6]");
    assert!(gold.iter().all(|channel| (channel - 0.1).abs() < 1e-6), "{gold:?}");
    assert_eq!(shown("reflectance = [1, 0.5, 0]").0, [0.0; 3]);
    // A reflectance without a tint leaves white.
    for keys in ["reflectance = 0.3", "reflectance = 1", "reflectance = [0.5, 0.5, 0.5]", ""] {
        assert_eq!(shown(keys).1, [1.0; 3], "{keys}");
    }
    let own = shown("reflectance = [0.9, 0.8, 0.6]\ncolour = [1, 1, 1]");
    let map = shown("reflectance = [0.9, 0.8, 0.6]\ncolour_map = { generate = \"noise\", size = 8 }");
    assert_eq!((own.1, map.1), ([1.0; 3], [1.0; 3]), "a colour that is given stays");
}

#[test]
fn a_scene_that_is_nowhere_is_guessed_at() {
    let message = |name: &str| Scene::open(name).unwrap_err().to_string();
    let slip = message("denim-plan");
    assert!(slip.contains("did you mean `denim-plane`?") && slip.contains("`roughxel scenes`"), "{slip}");
    assert!(!message("no/such/file").contains("did you mean"));
}

#[cfg(unix)]
#[test]
fn what_is_no_regular_file_is_refused_before_it_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    // Each read would wait forever for a writer.
    let scene = |rest: &str| {
        let text = format!("{CAMERA}{rest}");
        Scene::from_toml("test.toml", &text, folder.path()).unwrap_err().to_string()
    };
    let map = |path: &str| format!("[[object]]\nshape = \"plane\"\nmaterial.colour_map = {{ path = \"{path}\" }}\n");
    for ending in ["png", "exr", "hdr"] {
        std::os::unix::fs::symlink(&pipe, folder.path().join(format!("pipe.{ending}"))).unwrap();
    }
    for error in [
        Scene::from_file(&pipe).unwrap_err().to_string(),
        scene("[[object]]\nshape = \"mesh\"\npath = \"pipe\"\n"),
        scene("environment = { equirectangular = \"pipe\" }\n"),
        scene(&map("pipe.png")),
        scene(&map("pipe.exr")),
        scene(&map("pipe.hdr")),
    ] {
        assert!(error.contains("no regular file but a pipe"), "{error}");
    }
}

#[test]
fn frame_sizes_from_outside_are_checked() {
    let scene = read("").unwrap();
    assert_eq!(scene.clone().with_size(1280, 720).unwrap().camera.width, 1280);
    for (width, height) in [(0, 10), (10, 0), (16_385, 1), (16_384, 16_384)] {
        let error = scene.clone().with_size(width, height).unwrap_err().to_string();
        assert!(error.starts_with(&format!("a frame of {width}×{height} pixels is out of range")), "{error}");
    }
}

#[test]
fn keys_of_a_mesh_are_checked_and_errors_of_its_file_say_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = "v 5000000 0 0\nv 5000001 0 0\nv 5000000 1 0\nvt 0 0\nvt 1 0\nvt 0.5 1\nf 1/1 2/2 3/3\n";
    std::fs::write(folder.path().join("far.obj"), mesh).unwrap();
    std::fs::write(folder.path().join("x.obj"), "ply\nformat ascii 1.0\n").unwrap();
    let read = |keys: &str| {
        let text = format!("{CAMERA}[[object]]\nshape = \"mesh\"\n{keys}\n");
        Scene::from_toml("test.toml", &text, folder.path()).map_err(|error| {
            let SceneError::Fault(fault) = error else { panic!("{error}") };
            (fault.message, fault.help)
        })
    };
    let scene = read("path = \"far.obj\"\noffset = [5e6, 0, 0]").unwrap();
    assert_eq!(scene.objects[0].mesh.vertices[1].position, DVec3::X);
    let hammered = "material = { normal_map = { generate = \"hammered\", size = 16 } }";
    for (keys, message, help) in [
        ("path = \"no.obj\"", "cannot read the mesh", "paths are relative to the scene file"),
        ("path = \"x.obj\"", "the file is a PLY mesh", "OBJ and glTF are read: export the mesh as one of them"),
        ("path = \"far.obj\"", "far.obj:1: coordinate `5000000` is not within", "`offset = [5000000, 0, 0]`"),
        ("path = \"far.obj\"\noffset = [2e9, 0, 0]", "`offset` is 2000000000, which is out of range", "choose"),
        (
            "path = \"far.obj\"\noffset = [5e6, 0, 0]\nmaterial = { frame = \"main-direction\" }\ntangents = \"texture\"",
            "only the frame",
            "leave",
        ),
    ] {
        let (found, remedy) = read(keys).unwrap_err();
        assert!(found.contains(message) && remedy.contains(help), "{keys}: {found}; {remedy}");
    }
    // A generated map was not baked, so it follows the texture; p_v leans with the chart.
    let leaning = |keys: &str| {
        let scene = read(&format!("path = \"far.obj\"\noffset = [5e6, 0, 0]\n{keys}\n{hammered}")).unwrap();
        let vertex = scene.objects[0].mesh.vertices[0];
        vertex.tangents[0].dot(vertex.tangents[1]).abs() > 0.1
    };
    assert!(leaning("") && leaning("tangents = \"texture\"") && !leaning("tangents = \"mikktspace\""));
    assert!(!leaning("scale = [3, 0.5, 1]\ntangents = \"mikktspace\""));
}
