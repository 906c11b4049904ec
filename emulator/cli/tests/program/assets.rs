//! `roughxel import` and `roughxel inspect`: assets as people bring them.

use std::fs;
use std::path::Path;

use roughxel_assets::picture::{Picture, Purpose, Samples, Wishes, encode_png, read};
use serde_json::{Value, json};

use super::fixture::{Folder, roughxel};

/// An 8-bit PNG of one colour, 2×2 pixels.
fn png(colour: [u8; 3]) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_png(&mut bytes, [2, 2], Samples::Rgb8(&colour.repeat(4))).unwrap();
    bytes
}

fn floats(all: impl IntoIterator<Item = f32>) -> Vec<u8> {
    all.into_iter().flat_map(f32::to_le_bytes).collect()
}

/// A GLB (glTF 2.0 §4) of a square of 2 units that faces +z, with its three textures: base colour, roughness and metallic, normals.
fn model(material: Value) -> Vec<u8> {
    model_at(json!({ "mesh": 0, "name": "Left wing" }), material)
}

/// A GLB of the square of [`model`] in a node of one's own, or in several.
fn model_at(node: Value, material: Value) -> Vec<u8> {
    let nodes = if let Value::Array(nodes) = node { nodes } else { vec![node] };
    let mut chunk = floats([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]].concat());
    chunk.extend(floats([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].concat()));
    chunk.extend([0u16, 1, 2, 0, 2, 3].into_iter().flat_map(u16::to_le_bytes));
    let mut views = vec![
        json!({ "buffer": 0, "byteOffset": 0, "byteLength": 48 }),
        json!({ "buffer": 0, "byteOffset": 48, "byteLength": 32 }),
        json!({ "buffer": 0, "byteOffset": 80, "byteLength": 12 }),
    ];
    let mut images = Vec::new();
    for colour in [[255, 128, 0], [0, 128, 255], [128, 128, 255]] {
        let bytes = png(colour);
        views.push(json!({ "buffer": 0, "byteOffset": chunk.len(), "byteLength": bytes.len() }));
        images.push(json!({ "bufferView": views.len() - 1, "mimeType": "image/png" }));
        chunk.extend(bytes);
        chunk.resize(chunk.len().next_multiple_of(4), 0);
    }
    let accessor = |view: usize, kind: &str, component: u32, count: usize| json!({ "bufferView": view, "type": kind, "componentType": component, "count": count });
    let mut positions = accessor(0, "VEC3", 5126, 4);
    positions["min"] = json!([-1, -1, 0]);
    positions["max"] = json!([1, 1, 0]);
    let json = json!({
        "asset": { "version": "2.0" }, "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes, "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": 0 }] }],
        "materials": [material],
        "textures": [{ "source": 0 }, { "source": 1 }, { "source": 2 }],
        "images": images, "buffers": [{ "byteLength": chunk.len() }], "bufferViews": views,
        "accessors": [positions, accessor(1, "VEC2", 5126, 4), accessor(2, "SCALAR", 5123, 6)],
        "animations": [],
    });
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + text.len() as u32 + chunk.len() as u32).to_le_bytes());
    for (kind, content) in [(b"JSON", text), (b"BIN\0", chunk)] {
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(content);
    }
    bytes
}

fn material() -> Value {
    json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 1 },
            "metallicFactor": 0.5, "roughnessFactor": 0.6,
        },
        "normalTexture": { "index": 2 },
    })
}

fn picture(path: &Path, purpose: Purpose) -> Picture {
    read(path, purpose, &Wishes::default()).unwrap().picture
}

#[test]
fn a_gltf_model_becomes_a_scene_with_the_values_of_its_material() {
    let folder = Folder::new();
    let (glb, scene, picture_path) = (folder.join("wing.glb"), folder.join("wing.toml"), folder.join("wing.png"));
    fs::write(&glb, model(material())).unwrap();
    let [glb, scene, drawn] = [&glb, &scene, &picture_path].map(|path| path.to_str().unwrap());
    let run = roughxel(&["import", glb, "-o", scene]).ends(0);
    run.prints(&["1 object, 2 triangles", "roughxel render"]);
    let text = fs::read_to_string(scene).unwrap();
    let toml = text.parse::<toml::Table>().unwrap();
    let object = &toml["object"][0];
    assert_eq!(object["name"].as_str(), Some("Left wing"));
    // Base colour: red 1, green 0.2159 (sRGB 128), blue 0. Half of it is metal.
    let reflectance: Vec<f64> =
        object["material"]["reflectance"].as_array().unwrap().iter().map(|value| value.as_float().unwrap()).collect();
    let base = [1.0, 0.215_861, 0.0];
    for (got, base) in reflectance.iter().zip(base) {
        assert!((got - (0.02 + 0.5 * base)).abs() < 1e-5, "{text}");
    }
    let maps = folder.join("wing");
    let colour = picture(&maps.join("colour_0.png"), Purpose::Colours).pixel(1, 1);
    for ((got, base), reflectance) in colour.iter().zip(base).zip(&reflectance) {
        // An 8-bit code is within 1 % of the light there.
        let right = (0.5 * base / (1.0 - reflectance)).min(1.0);
        assert!((f64::from(*got) - right).abs() < 0.01, "{colour:?}");
    }
    // α is roughness 0.6 · 128/255, squared; its share is 0.8 and a part that vanishes beyond 0.07.
    let deviation = object["material"]["roughness_map"]["deviation"].as_float().unwrap();
    let share = picture(&maps.join("roughness_0.png"), Purpose::Data).pixel(0, 0)[0];
    let alpha = (0.6f64 * 128.0 / 255.0).powi(2);
    let right = 0.8 * alpha + 0.2 * alpha / (1.0 + (alpha / 0.07).powi(4));
    assert!((deviation * f64::from(share) - right).abs() < 1e-4, "{deviation} {share}");
    roughxel(&["render", scene, "-o", drawn, "--size", "32x32"]).ends(0);
    // The square fills the middle and nothing else; seen from the front its reflection is no background.
    let frame = picture(&picture_path, Purpose::Colours);
    assert_ne!(frame.pixel(16, 16), frame.pixel(0, 16));
}

/// An import that fails writes nothing: neither a part of a scene nor over an earlier one.
#[test]
fn a_broken_image_leaves_an_earlier_import_as_it_was() {
    let folder = Folder::new();
    let (glb, scene) = (folder.join("a.glb"), folder.join("a.toml"));
    let [glb_text, scene_text] = [&glb, &scene].map(|path| path.to_str().unwrap());
    let whole = model(material());
    // The second image is not read before the first one and its maps are there.
    let at = whole.windows(8).rposition(|bytes| bytes == b"\x89PNG\r\n\x1a\n").unwrap();
    let mut broken = whole.clone();
    broken[at + 12..at + 16].fill(0);
    fs::write(&glb, &broken).unwrap();
    roughxel(&["import", glb_text, "-o", scene_text]).ends(1).complains(&["a.glb: image ", "is not a readable PNG"]);
    assert!(!scene.exists() && !folder.join("a").exists());
    fs::write(&glb, whole).unwrap();
    roughxel(&["import", glb_text, "-o", scene_text]).ends(0);
    let files = || {
        let entries = fs::read_dir(folder.join("a")).unwrap().map(|entry| entry.unwrap().path());
        let mut files: Vec<_> = entries.map(|path| (path.clone(), fs::read(path).unwrap())).collect();
        files.sort();
        files
    };
    let before = files();
    fs::write(&glb, broken).unwrap();
    roughxel(&["import", glb_text, "-o", scene_text, "--replace"]).ends(1);
    assert!(files() == before);
}

/// A scene holds coordinates within a million units. A model in coordinates of a map is refused by the import, not by the first frame.
#[test]
fn a_model_far_from_its_origin_is_not_imported() {
    let folder = Folder::new();
    let (glb, scene) = (folder.join("a.glb"), folder.join("a.toml"));
    let [glb_text, scene_text] = [&glb, &scene].map(|path| path.to_str().unwrap());
    let node = |translation: [f64; 3], scale: f64| json!({ "mesh": 0, "translation": translation, "scale": [scale, scale, scale] });
    // A camera looks along -z of its node.
    let camera = |z: f64| json!({ "mesh": 0, "camera": 0, "translation": [0, 0, z] });
    for (node, ends) in [
        (node([5.4e6, 0.0, 0.0], 1.0), 1),
        (node([0.0; 3], 8e5), 1),
        (camera(-2e6), 1),
        (camera(-9e5), 0),
        (node([5.4e5, 0.0, 0.0], 1.0), 0),
    ] {
        fs::write(&glb, model_at(node, material())).unwrap();
        let run = roughxel(&["import", glb_text, "-o", scene_text, "--replace"]).ends(ends);
        if ends == 1 {
            run.complains(&["a.glb has ", "beyond ±1e6 units; move the model to the origin, or scale it down"]);
            assert!(!scene.exists());
        }
    }
    roughxel(&["render", scene_text, "-o", folder.join("a.png").to_str().unwrap(), "--size", "16x16"]).ends(0);
}

/// Pictures of 32×32 pixels of imported nodes.
fn drawn(nodes: Value) -> Picture {
    let folder = Folder::new();
    let (glb, scene, picture_path) = (folder.join("a.glb"), folder.join("a.toml"), folder.join("a.png"));
    let [glb_text, scene_text, picture_text] = [&glb, &scene, &picture_path].map(|path| path.to_str().unwrap());
    fs::write(&glb, model_at(nodes, material())).unwrap();
    roughxel(&["import", glb_text, "-o", scene_text]).ends(0);
    roughxel(&["render", scene_text, "-o", picture_text, "--size", "32x32"]).ends(0);
    picture(&picture_path, Purpose::Colours)
}

/// Pixels that two pictures have in common, up to a few 8-bit codes.
fn common(one: &Picture, other: &Picture) -> usize {
    let near = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).all(|channel| (a[channel] - b[channel]).abs() < 0.02);
    one.pixels.iter().zip(&other.pixels).filter(|&pair| near(pair)).count()
}

/// A camera with six decimals would look past a model of a few micrometres, whose unit is the metre. One whose near plane follows from the distance of
/// the origin would see nothing of a model in map coordinates.
#[test]
fn the_camera_of_a_model_sees_it_whatever_its_size_and_place() {
    let whole = drawn(json!({ "mesh": 0 }));
    for (scale, x) in [(1e-2, 0.0), (1e-6, 0.0), (1e-9, 0.0), (1e4, 0.0), (1.0, 2e4), (1e-3, 20.0)] {
        let node = json!({ "mesh": 0, "scale": [scale, scale, scale], "translation": [x, 0.0, 0.0] });
        let same = common(&whole, &drawn(node));
        assert!(same > 1000, "{scale} at {x}: {same} of 1024 pixels");
    }
}

#[test]
fn a_camera_of_a_model_keeps_what_is_near_before_a_far_backdrop() {
    let square = |distance: f64, turned: f64, scale: f64| {
        let turn = [(turned / 2.0).to_radians().sin(), 0.0, 0.0, (turned / 2.0).to_radians().cos()];
        json!({ "mesh": 0, "rotation": turn, "scale": [scale, scale, scale], "translation": [0.0, 0.0, -distance] })
    };
    let camera = || json!({ "camera": 0 });
    let (near, far) = (|| square(2.0, 30.0, 2.0), || square(1e4, 0.0, 1e4));
    let alone = drawn(json!([near(), camera()]));
    assert_eq!(common(&alone, &drawn(json!([near(), far(), camera()]))), 1024);
    assert_ne!(alone.pixel(16, 16), drawn(json!([far(), camera()])).pixel(16, 16));
    // A model that reaches to the ends of the coordinates, in front of a camera in the middle.
    drawn(json!([square(5e5, 0.0, 9e5), camera()]));
}

/// A scene refuses a mesh without a face that has an area. A part that is a point or a line is left out, and a model of such parts alone is refused.
#[test]
fn parts_without_an_area_are_left_out_of_an_import() {
    let folder = Folder::new();
    let (glb, scene) = (folder.join("a.glb"), folder.join("a.toml"));
    let [glb_text, scene_text] = [&glb, &scene].map(|path| path.to_str().unwrap());
    let line = || json!({ "mesh": 0, "name": "a line", "scale": [1, 0, 1] });
    fs::write(&glb, model_at(json!([line()]), material())).unwrap();
    let refused = roughxel(&["import", glb_text, "-o", scene_text]).ends(1);
    refused.complains(&["a.glb has no face with an area; export the model with triangles"]);
    assert!(!scene.exists());
    fs::write(&glb, model_at(json!([line(), { "mesh": 0 }]), material())).unwrap();
    let run = roughxel(&["import", glb_text, "-o", scene_text]).ends(0);
    run.prints(&["1 object, 2 triangles"]).complains(&["\"a line\" is left out: it has no face with an area"]);
    roughxel(&["render", scene_text, "-o", folder.join("a.png").to_str().unwrap(), "--size", "16x16"]).ends(0);
}

#[test]
fn files_of_an_import_are_named_and_mistakes_end_with_their_codes() {
    let folder = Folder::new();
    let (glb, scene) = (folder.join("a.glb"), folder.join("a.toml"));
    let [glb_text, scene_text] = [&glb, &scene].map(|path| path.to_str().unwrap());
    roughxel(&["import", glb_text, "-o", scene_text]).ends(1).complains(&["a.glb", "check the path"]);
    fs::write(&glb, b"glTF\x02\0\0\0").unwrap();
    roughxel(&["import", glb_text, "-o", scene_text]).ends(1).complains(&["a.glb", "export it again as glTF 2.0"]);
    fs::write(&glb, model(material())).unwrap();
    roughxel(&["import", glb_text, "-o", "x.png"]).ends(2).complains(&["end the name in .toml"]);
    assert!(!scene.exists() && !folder.join("a").exists());
    let mut transparent = material();
    transparent["alphaMode"] = json!("BLEND");
    transparent["normalTexture"]["scale"] = json!(2);
    fs::write(&glb, model(transparent)).unwrap();
    roughxel(&["import", glb_text, "-o", scene_text])
        .ends(0)
        .complains(&["transparency is not drawn", "one reflectance"]);
    // An edited scene is not lost.
    fs::write(&scene, "edited").unwrap();
    roughxel(&["import", glb_text, "-o", scene_text]).ends(1).complains(&["a.toml exists already", "--replace"]);
    assert_eq!(fs::read_to_string(&scene).unwrap(), "edited");
    roughxel(&["import", glb_text, "-o", scene_text, "--replace"]).ends(0);
    assert!(fs::read_to_string(&scene).unwrap().contains("coding = \"gltf\""));
    let obj = folder.join("a.obj");
    fs::write(&obj, "v 0 0 0\n").unwrap();
    let obj = obj.to_str().unwrap();
    roughxel(&["import", obj, "-o", scene_text, "--replace"])
        .ends(1)
        .complains(&["is no glTF model", "name it as a mesh"]);
    roughxel(&["render", glb_text, "-o", "x.png"]).ends(1).complains(&["is a glTF model", "roughxel import"]);
    // The flat normal stays flat under a scale.
    let normals = picture(&folder.join("a").join("normal_0.png"), Purpose::Data);
    assert_eq!(normals.pixel(0, 0).map(|value| (value * 255.0).round() as u8), [128, 128, 255]);
}

#[test]
fn inspect_says_what_a_file_is_and_shows_it() {
    let folder = Folder::new();
    let thumbnail = folder.join("thumbnail.png");
    let shown = thumbnail.to_str().unwrap();
    let files = [
        ("a.png", png([10, 20, 30]), "PNG, 2×2", "PNG"),
        ("b.glb", model(material()), "glTF model, mesh of 2 triangles", "glTF"),
        ("c.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec(), "no texture coordinates", "mesh"),
    ];
    for (name, bytes, line, kind) in files {
        let path = folder.join(name);
        fs::write(&path, bytes).unwrap();
        let path = path.to_str().unwrap();
        roughxel(&["inspect", path, "-o", shown]).ends(0).prints(&[name, line]);
        let size = picture(&thumbnail, Purpose::Colours);
        assert!(size.width.max(size.height) <= 512, "{name}");
        assert_eq!(roughxel(&["inspect", path, "--json"]).json()["kind"], kind);
    }
    let path = folder.join("d.png");
    fs::write(&path, b"ply\nformat ascii 1.0\n").unwrap();
    roughxel(&["inspect", path.to_str().unwrap()]).ends(1).complains(&["PLY"]);
    let model = folder.join("b.glb");
    roughxel(&["inspect", model.to_str().unwrap()]).ends(0).prints(&["1 part, 1 material, 3 images;"]);
}

#[test]
fn inspect_takes_the_keys_of_a_scene_and_says_what_render_would_say() {
    let folder = Folder::new();
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    fs::write(folder.join("a.png"), png([10, 20, 30])).unwrap();
    // A lamp of 2^40 in a sky of 1: Radiance's mantissas and exponents.
    let sky: Vec<u8> = (0..32).flat_map(|pixel| [128, 128, 128, if pixel == 9 { 169 } else { 129 }]).collect();
    fs::write(folder.join("sky.hdr"), [b"#?RADIANCE\n\n-Y 4 +X 8\n", &sky[..]].concat()).unwrap();
    fs::write(folder.join("cross.hdr"), [b"#?RADIANCE\n\n-Y 3 +X 4\n", &[128; 48][..]].concat()).unwrap();
    fs::write(folder.join("far.obj"), "v 3e6 0 0\nv 3000001 0 0\nv 3e6 1 0\nf 1 2 3\n").unwrap();
    let (picture, sky, cross, far) = (path("a.png"), path("sky.hdr"), path("cross.hdr"), path("far.obj"));
    let table: [(&[&str], &str); 10] = [
        (&[&picture, "--set", "transfer=linear"], "the file says nothing; used: linear"),
        (&[&picture, "--as", "normals"], "PNG, 2×2"),
        (&[&picture, "--as", "normals", "--set", "green=down"], "PNG, 2×2"),
        (&[&picture, "--as", "heights", "--set", "wrap=false", "--set", "scale=0.1"], "PNG, 2×2"),
        (&[&picture, "--as", "roughness", "--set", "deviation=0.5"], "PNG, 2×2"),
        (&[&sky, "--as", "environment"], "warning: environment: 100.00 % of the light is above 1048320 × white"),
        (&[&sky, "--as", "environment", "--set", "exposure=-10"], "choose a lower `exposure`"),
        (&[&sky, "--as", "environment", "--set", "latitudes=[0, 90]"], "Radiance HDR, 8×4"),
        (&[&cross, "--as", "cube"], "Radiance HDR, 4×3"),
        (&[&far, "--set", "offset=[3000000, 0, 0]"], "mesh of 1 triangle, 3 vertices"),
    ];
    for (arguments, expected) in table {
        roughxel(&[&["inspect"], arguments].concat()).ends(0).prints(&[expected]);
    }
    let warned = roughxel(&["inspect", &sky, "--as", "environment", "--json"]).json();
    assert!(warned["warnings"][0].as_str().unwrap().contains("above 1048320 × white"), "{warned}");
    let (missing, scene) = (path("none.glb"), path("a.toml"));
    fs::write(&scene, "camera = { eye = [0, 0, 5], target = [0, 0, 0] }\n").unwrap();
    let table: [(&[&str], i32, &str); 10] = [
        (&[&cross, "--as", "environment"], 1, "name it with `cube`"),
        (&[&sky, "--as", "cube"], 1, "name a panorama of longitude and latitude with `equirectangular`"),
        (&[&picture, "--set", "layer=Combined"], 1, "which has no layer; leave `layer` out"),
        (&[&picture, "--set", "layr=Combined"], 1, "did you mean `layer`?"),
        (&[&picture, "--set", "layer"], 2, "a key is KEY=VALUE"),
        (&[&far], 1, "offset = [3000000, 0, 0]"),
        (&[&far, "--as", "colours"], 2, "leave --as out"),
        (&[&scene, "--set", "a=b"], 2, "leave --set out"),
        (&[&missing], 1, "cannot open the model `"),
        (&[folder.path().to_str().unwrap()], 1, "` is a directory; name a file in it"),
    ];
    for (arguments, code, expected) in table {
        roughxel(&[&["inspect"], arguments].concat()).ends(code).complains(&[expected]);
    }
}

#[test]
fn inspect_lists_the_pictures_of_a_scene_and_draws_it() {
    let folder = Folder::new();
    let [scene, thumbnail] = ["a.toml", "a.png"].map(|name| folder.join(name));
    fs::write(folder.join("map.png"), png([200, 100, 50])).unwrap();
    let text = "camera = { eye = [0, 5, 0.1], target = [0, 0, 0], width = 300, height = 100 }\n[[light]]\ndirection = [0, 1, 0]\n\
                [[object]]\nname = \"floor\"\nshape = \"plane\"\nmaterial.colour_map = { path = \"map.png\" }\n";
    fs::write(&scene, text).unwrap();
    let [scene, shown] = [&scene, &thumbnail].map(|path| path.to_str().unwrap());
    roughxel(&["inspect", scene, "-o", shown]).ends(0).prints(&[
        "scene of 1 object, 1 light, no environment",
        "`roughxel plan` says which effects",
        "floor: colour map: map.png: PNG, 2×2",
    ]);
    let drawn = picture(&thumbnail, Purpose::Colours);
    assert_eq!([drawn.width, drawn.height], [512, 171]);
    let json = roughxel(&["inspect", scene, "--json"]).json();
    assert_eq!((&json["kind"], &json["objects"][0]), (&json!("scene"), &json!("floor")));
    assert_eq!(json["pictures"][0]["path"], "map.png");
    fs::write(scene, "nothing = 1\n").unwrap();
    roughxel(&["inspect", scene]).ends(1).complains(&["a.toml:1:1"]);
    roughxel(&["inspect", "none.toml"]).ends(1).complains(&["there is no such scene file"]);
}
