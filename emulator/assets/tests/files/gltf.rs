//! Small models made by hand; every right value follows from the specification.

use std::path::{Path, PathBuf};

use roughxel_utilities::random::SplitMix64;
use serde_json::{Value, json};

use glam::{DVec2, DVec3};
use roughxel_assets::gltf::*;
use roughxel_assets::{MeshError, ReadMesh, ReadOptions, read_mesh};

mod integers;

/// A square in the plane z = 0 with corners ±1, normals +z and texture coordinates 0 to 1 (v downwards).
const POSITIONS: [[f32; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
const TEXCOORDS: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
const INDICES: [u16; 6] = [0, 1, 2, 0, 2, 3];

fn floats(all: impl IntoIterator<Item = f32>) -> Vec<u8> {
    all.into_iter().flat_map(f32::to_le_bytes).collect()
}

/// The binary chunk: positions at 0, normals at 48, texture coordinates at 96, indices at 128.
fn chunk() -> Vec<u8> {
    let mut bytes = floats(POSITIONS.into_iter().flatten());
    bytes.extend(floats([0.0, 0.0, 1.0].repeat(4)));
    bytes.extend(floats(TEXCOORDS.into_iter().flatten()));
    bytes.extend(INDICES.into_iter().flat_map(u16::to_le_bytes));
    bytes
}

/// The JSON of the square.
fn square() -> Value {
    let view = |offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let accessor = |view: usize, kind: &str, component: u32, count: usize| json!({ "bufferView": view, "type": kind, "componentType": component, "count": count });
    let mut positions = accessor(0, "VEC3", 5126, 4);
    positions["min"] = json!([-1, -1, 0]);
    positions["max"] = json!([1, 1, 0]);
    json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "square" }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0,
        }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 1, 1] } }],
        "buffers": [{ "byteLength": 140 }],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 32), view(128, 12)],
        "accessors": [
            positions, accessor(1, "VEC3", 5126, 4), accessor(2, "VEC2", 5126, 4), accessor(3, "SCALAR", 5123, 6),
        ],
    })
}

/// A GLB container (glTF 2.0 §4).
fn glb(json: &Value, chunk: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + text.len() as u32 + chunk.len() as u32).to_le_bytes());
    for (kind, content) in [(b"JSON", text.as_slice()), (b"BIN\0", chunk)] {
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(content);
    }
    bytes
}

struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn model(&self, json: &Value) -> Result<Model, MeshError> {
        read_model(&self.write("model.glb", &glb(json, &chunk())))
    }
}

fn error(json: &Value) -> String {
    Files::new().model(json).unwrap_err().to_string()
}

fn close(a: DVec3, b: [f64; 3]) -> bool {
    (a - DVec3::from_array(b)).length() < 1e-6
}

#[test]
fn a_square_has_its_corners_normals_and_v_upwards() {
    let model = Files::new().model(&square()).unwrap();
    let part = &model.parts[0];
    assert_eq!((part.name.as_str(), part.material), ("square", Some(0)));
    assert_eq!(part.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(
        close(part.positions[2], [1.0, 1.0, 0.0]) && part.normals.iter().all(|normal| close(*normal, [0.0, 0.0, 1.0]))
    );
    assert_eq!(part.texcoords[0], DVec2::new(0.0, 0.0));
    assert_eq!(part.texcoords[2], DVec2::new(1.0, 1.0));
    // Factors that a file leaves out are 1.
    let material = &model.materials[0];
    assert_eq!((material.colour, material.metallic, material.roughness), ([0.5, 0.25, 1.0], 1.0, 1.0));
    assert!(model.ignored.is_empty());
}

#[test]
fn nodes_place_positions_and_normals_through_all_their_parents() {
    // (key of the child node, right place of (1, 1, 0), right normal)
    let half = 0.5f64.sqrt();
    let cases = [
        (json!({ "translation": [1, 2, 3] }), [12.0, 3.0, 3.0], [0.0, 0.0, 1.0]),
        (json!({ "scale": [2, 3, 4] }), [12.0, 3.0, 0.0], [0.0, 0.0, 1.0]),
        // A quarter turn about y takes +z to +x and +x to −z.
        (json!({ "rotation": [0, half, 0, half] }), [10.0, 1.0, -1.0], [1.0, 0.0, 0.0]),
        (json!({ "rotation": [half, 0, 0, half] }), [11.0, 0.0, 1.0], [0.0, -1.0, 0.0]),
        // A mirrored surface faces the other way only if the mirror turns it.
        (json!({ "scale": [-1, 1, 1] }), [9.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        (json!({ "scale": [1, 1, -1] }), [11.0, 1.0, 0.0], [0.0, 0.0, -1.0]),
        (json!({ "scale": [-2, -2, -2] }), [8.0, -2.0, 0.0], [0.0, 0.0, -1.0]),
        // A shear of z by x leans the surface: x' = x, z' = z + x.
        (json!({ "matrix": [1, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }), [11.0, 1.0, 1.0], [-half, 0.0, half]),
        (json!({ "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1] }), [14.0, 7.0, 7.0], [0.0, 0.0, 1.0]),
        (json!({}), [11.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
    ];
    for (keys, place, normal) in cases {
        let mut json = square();
        let mut child = keys.clone();
        child["mesh"] = json!(0);
        json["nodes"] = json!([{ "children": [1], "translation": [10, 0, 0] }, child]);
        let model = Files::new().model(&json).unwrap();
        assert!(close(model.parts[0].positions[2], place), "{keys}: {}", model.parts[0].positions[2]);
        assert!(close(model.parts[0].normals[0], normal), "{keys}: {}", model.parts[0].normals[0]);
    }
}

#[test]
fn texture_transforms_turn_scale_and_move_in_the_order_of_the_extension() {
    // KHR_texture_transform: uv' = translation · rotation · scale · uv, v downwards.
    let cases = [
        (json!({ "offset": [0.25, 0.5] }), [1.25, 0.5]),
        (json!({ "scale": [2, 4] }), [2.0, 0.0]),
        (json!({ "offset": [0.5, 0.0], "scale": [2, 2] }), [2.5, 0.0]),
        // (1, 0) turned by 90°: u' = 0, v' = −1.
        (json!({ "rotation": std::f64::consts::FRAC_PI_2 }), [0.0, -1.0]),
        (json!({ "rotation": std::f64::consts::PI }), [-1.0, 0.0]),
        (json!({ "rotation": -std::f64::consts::FRAC_PI_2 }), [0.0, 1.0]),
        (json!({ "scale": [-1, 1] }), [-1.0, 0.0]),
        (json!({ "rotation": 0.5, "scale": [2, 3] }), [2.0 * f64::cos(0.5), -2.0 * f64::sin(0.5)]),
        (
            json!({ "rotation": 0.5, "scale": [2, 3], "offset": [0.1, 0.2] }),
            [2.0 * f64::cos(0.5) + 0.1, -2.0 * f64::sin(0.5) + 0.2],
        ),
        (json!({ "texCoord": 0 }), [1.0, 0.0]),
    ];
    for (transform, [u, v]) in cases {
        let mut json = square();
        json["extensionsUsed"] = json!(["KHR_texture_transform"]);
        json["images"] = json!([{ "uri": "data:image/png;base64,AAAA" }]);
        json["textures"] = json!([{ "source": 0 }]);
        let texture = json!({ "index": 0, "extensions": { "KHR_texture_transform": transform } });
        json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = texture;
        let model = Files::new().model(&json).unwrap();
        // Corner 2 is (1, 0) with v downwards.
        let got = model.parts[0].texcoords[2];
        assert!((got - DVec2::new(u, 1.0 - v)).length() < 1e-6, "{transform}: {got}");
    }
}

#[test]
fn sparse_accessors_replace_single_positions() {
    let mut json = square();
    let mut bytes = chunk();
    bytes.extend(2u16.to_le_bytes());
    bytes.extend([0; 2]);
    bytes.extend(floats([5.0, 6.0, 7.0]));
    json["buffers"][0]["byteLength"] = json!(bytes.len());
    let views = json["bufferViews"].as_array_mut().unwrap();
    views.push(json!({ "buffer": 0, "byteOffset": 140, "byteLength": 2 }));
    views.push(json!({ "buffer": 0, "byteOffset": 144, "byteLength": 12 }));
    json["accessors"][0]["sparse"] = json!({
        "count": 1, "indices": { "bufferView": 4, "componentType": 5123 }, "values": { "bufferView": 5 },
    });
    let files = Files::new();
    let model = read_model(&files.write("sparse.glb", &glb(&json, &bytes))).unwrap();
    assert!(
        close(model.parts[0].positions[2], [5.0, 6.0, 7.0]) && close(model.parts[0].positions[1], [1.0, -1.0, 0.0])
    );
}

#[test]
fn buffers_are_read_from_files_and_from_texts() {
    use base64::Engine as _;
    let files = Files::new();
    files.write("the buffer.bin", &chunk());
    let data = base64::engine::general_purpose::STANDARD.encode(chunk());
    for uri in ["the%20buffer.bin".to_owned(), format!("data:application/octet-stream;base64,{data}")] {
        let mut json = square();
        json["buffers"][0]["uri"] = json!(uri);
        let model = read_model(&files.write("model.gltf", json.to_string().as_bytes())).unwrap();
        assert_eq!(model.parts[0].triangles.len(), 2);
    }
}

#[test]
fn the_camera_of_the_scene_is_where_its_node_is() {
    let mut json = square();
    json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }]);
    let half = 0.5f64.sqrt();
    json["nodes"] = json!([{ "mesh": 0 }, { "camera": 0, "translation": [3, 2, 1], "rotation": [0, half, 0, half] }]);
    json["scenes"][0]["nodes"] = json!([0, 1]);
    let camera = Files::new().model(&json).unwrap().camera.unwrap();
    assert!(
        close(camera.eye, [3.0, 2.0, 1.0])
            && close(camera.forward, [-1.0, 0.0, 0.0])
            && close(camera.up, [0.0, 1.0, 0.0])
    );
    assert!((camera.fov_y_degrees - 0.5f64.to_degrees()).abs() < 1e-6);
}

#[test]
fn a_model_is_a_mesh_too_whatever_its_file_is_called() {
    let files = Files::new();
    let mut json = square();
    json["nodes"] = json!([{ "mesh": 0, "translation": [5, 0, 0] }, { "mesh": 0 }]);
    json["scenes"][0]["nodes"] = json!([0, 1]);
    files.write("buffer.bin", &chunk());
    let glb = glb(&json, &chunk());
    json["buffers"][0]["uri"] = json!("buffer.bin");
    let text = [b"\xef\xbb\xbf \n", json.to_string().as_bytes()].concat();
    let options = ReadOptions { offset: DVec3::new(1.0, 0.0, 0.0), ..Default::default() };
    for bytes in [glb, text] {
        let ReadMesh { mesh, without_uv, warnings } = read_mesh(&files.write("mesh.obj", &bytes), &options).unwrap();
        assert_eq!((mesh.vertices.len(), mesh.triangles.len(), without_uv), (8, 4, None));
        assert!(mesh.vertices.iter().any(|vertex| close(vertex.position, [5.0, 1.0, 0.0])));
        // u runs along +x, v along +y; a repeat is 2 long.
        assert!(
            mesh.vertices
                .iter()
                .all(|vertex| close(vertex.tangents[0], [2.0, 0.0, 0.0]) && close(vertex.tangents[1], [0.0, 2.0, 0.0]))
        );
        assert!(warnings[0].contains("roughxel import"), "{warnings:?}");
    }
    json["nodes"][1]["translation"] = json!([2e6, 0, 0]);
    let far = read_mesh(&files.write("far.gltf", json.to_string().as_bytes()), &options).unwrap_err();
    assert!(far.to_string().contains("`offset`"), "{far}");
}

#[test]
fn what_is_not_drawn_is_named() {
    let mut json = square();
    json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "KHR_lights_punctual"]);
    json["materials"][0]["alphaMode"] = json!("BLEND");
    json["meshes"][0]["primitives"].as_array_mut().unwrap().push(json!({ "attributes": { "POSITION": 0 }, "mode": 1 }));
    let ignored = Files::new().model(&json).unwrap().ignored.join("\n");
    for word in ["KHR_materials_clearcoat", "lights", "transparency", "points and lines"] {
        assert!(ignored.contains(word), "{word}: {ignored}");
    }
}

#[test]
fn errors_name_the_mistake_and_the_remedy() {
    let change = |pointer: &str, value: Value| {
        let mut json = square();
        *json.pointer_mut(pointer).unwrap() = value;
        json
    };
    let cases = [
        (change("/buffers/0/byteLength", json!(141)), "buffer 0 has 140 bytes and should have 141"),
        (change("/accessors/0/count", json!(5)), "accessor 0 reaches beyond its buffer"),
        (change("/bufferViews/3/byteOffset", json!(200)), "accessor 3 reaches beyond its buffer"),
        (
            change("/buffers/0", json!({ "byteLength": 140, "uri": "none.bin" })),
            "names `none.bin`, which cannot be read",
        ),
        (
            change("/buffers/0", json!({ "byteLength": 140, "uri": "https://a.b/c" })),
            "only files next to the model are read",
        ),
        (change("/buffers/0", json!({ "byteLength": 140, "uri": "data:;base64,?" })), "damaged base64"),
        (change("/nodes/0", json!({})), "has no triangles"),
    ];
    for (json, message) in cases {
        let error = error(&json);
        assert!(error.contains(message) && error.contains("model.glb"), "{error}");
    }
    // A model of glTF 1.0 has objects for arrays, and its binary form another header.
    let old = json!({ "asset": { "version": "1.0" }, "scene": "s", "scenes": { "s": { "nodes": [] } }, "meshes": {} });
    let binary = [b"glTF\x01\0\0\0\x40\0\0\0", old.to_string().as_bytes()].concat();
    for bytes in [old.to_string().into_bytes(), binary] {
        let error = read_model(&Files::new().write("old.glb", &bytes)).unwrap_err().to_string();
        assert!(error.contains("is a model of glTF 1.0, which is not read; convert it to glTF 2.0"), "{error}");
    }
    for name in [
        "KHR_texture_transform",
        "KHR_materials_emissive_strength",
        "KHR_materials_unlit",
        "KHR_lights_punctual",
        "KHR_mesh_quantization",
    ] {
        let mut known = square();
        (known["extensionsUsed"], known["extensionsRequired"]) = (json!([name]), json!([name]));
        assert!(Files::new().model(&known).is_ok(), "{name}");
    }
    let mut required = square();
    required["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    required["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(error(&required).contains("KHR_draco_mesh_compression"), "{}", error(&required));
}

#[test]
fn damaged_models_are_errors_and_no_panics() {
    let (files, whole) = (Files::new(), glb(&square(), &chunk()));
    let read = |bytes: &[u8]| read_model(&files.write("damaged.glb", bytes));
    for length in 0..whole.len() - 1 {
        assert!(read(&whole[..length]).is_err(), "{length} bytes");
    }
    let mut random = SplitMix64::new(57);
    for _ in 0..2000 {
        let mut bytes = whole.clone();
        for _ in 0..=random.next_u64() % 4 {
            let place = (random.next_u64() % bytes.len() as u64) as usize;
            bytes[place] = (random.next_u64() >> 32) as u8;
        }
        // Some changes are valid models, too.
        let _ = read(&bytes);
    }
    // A node that is a child of itself, and one with more descendants than anybody could draw.
    let mut cycle = square();
    cycle["nodes"] = json!([{ "children": [0] }]);
    assert!(error(&cycle).contains("deep"), "{}", error(&cycle));
    let mut nodes: Vec<Value> = (1..40).map(|child| json!({ "children": [child, child] })).collect();
    nodes.push(json!({ "mesh": 0 }));
    let mut doubled = square();
    doubled["nodes"] = json!(nodes);
    assert!(error(&doubled).contains("nodes"), "{}", error(&doubled));
    assert!(read_model(Path::new("no such file.glb")).unwrap_err().to_string().contains("check the path"));
}
