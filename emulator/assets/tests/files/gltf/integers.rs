//! Attributes of integers (KHR_mesh_quantization).

use super::*;

/// Component types of glTF 2.0 §3.6.2.2: name, code, bytes, least and largest value.
const TYPES: [(&str, u32, usize, i32, i32); 4] = [
    ("signed byte", 5120, 1, -128, 127),
    ("byte", 5121, 1, 0, 255),
    ("signed short", 5122, 2, -32768, 32767),
    ("short", 5123, 2, 0, 65535),
];

/// Vectors of integers, each padded to a multiple of four bytes.
fn packed(vectors: &[[i32; 3]], components: usize, bytes: usize) -> (Vec<u8>, usize) {
    let stride = (components * bytes).next_multiple_of(4);
    let mut packed = Vec::new();
    for vector in vectors {
        let start = packed.len();
        packed.extend(vector[..components].iter().flat_map(|number| number.to_le_bytes()[..bytes].to_vec()));
        packed.resize(start + stride, 0);
    }
    (packed, stride)
}

/// The square with one attribute replaced by integers, in a node.
fn model(
    attribute: &str,
    vectors: &[[i32; 3]],
    (code, bytes): (u32, usize),
    is_normalised: bool,
    node: &Value,
) -> Model {
    let components = if attribute == "TEXCOORD_0" { 2 } else { 3 };
    let (integers, stride) = packed(vectors, components, bytes);
    let mut json = square();
    let mut chunk = chunk();
    json["bufferViews"].as_array_mut().unwrap().push(json!({
        "buffer": 0, "byteOffset": chunk.len(), "byteLength": integers.len(), "byteStride": stride,
    }));
    chunk.extend(integers);
    json["buffers"][0]["byteLength"] = json!(chunk.len());
    let ends = |pick: fn(i32, i32) -> i32| {
        let end = |axis: usize| vectors.iter().map(|vector| vector[axis]).reduce(pick).unwrap();
        json!((0..components).map(end).collect::<Vec<_>>())
    };
    json["accessors"].as_array_mut().unwrap().push(json!({
        "bufferView": 4, "componentType": code, "type": format!("VEC{components}"), "count": vectors.len(),
        "normalized": is_normalised, "min": ends(i32::min), "max": ends(i32::max),
    }));
    json["meshes"][0]["primitives"][0]["attributes"][attribute] = json!(4);
    json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    json["nodes"][0] = node.clone();
    json["nodes"][0]["mesh"] = json!(0);
    let files = Files::new();
    read_model(&files.write("quantised.glb", &glb(&json, &chunk))).unwrap()
}

#[test]
fn integers_are_the_numbers_that_they_stand_for() {
    for (kind, code, bytes, least, largest) in TYPES {
        for is_normalised in [false, true] {
            // c / largest, and not below −1 (glTF 2.0 §3.11).
            let meant = |number: i32| {
                let number = f64::from(number);
                if is_normalised { (number / f64::from(largest)).max(-1.0) } else { number }
            };
            let corners = [[least, least, 0], [largest, least, 7], [largest, largest, 100], [least, largest, 1]];
            let node = json!({ "scale": [0.5, 0.25, 2.0], "translation": [1, 2, 3] });
            let read = model("POSITION", &corners, (code, bytes), is_normalised, &node);
            for (found, corner) in read.parts[0].positions.iter().zip(corners) {
                let [x, y, z] = corner.map(meant);
                assert!(close(*found, [0.5 * x + 1.0, 0.25 * y + 2.0, 2.0 * z + 3.0]), "{kind}: {found}");
            }
            let read = model("TEXCOORD_0", &corners, (code, bytes), is_normalised, &json!({}));
            for (found, corner) in read.parts[0].texcoords.iter().zip(corners) {
                let [u, v, _] = corner.map(meant);
                assert!((*found - DVec2::new(u, 1.0 - v)).length() < 1e-9, "{kind}: {found}");
            }
            if least < 0 {
                let normals = [[0, 0, largest], [largest, 0, 0], [0, least, 0], [3, 0, 4]];
                let read = model("NORMAL", &normals, (code, bytes), is_normalised, &json!({}));
                let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8]];
                for (found, expected) in read.parts[0].normals.iter().zip(expected) {
                    assert!(close(*found, expected), "{kind}: {found}");
                }
            }
        }
    }
}

#[test]
fn attributes_of_other_types_are_named() {
    for (key, value) in [("type", json!("VEC2")), ("componentType", json!(5125)), ("type", json!("SCALAR"))] {
        let mut json = square();
        json["accessors"][0][key] = value;
        let error = error(&json);
        assert!(error.contains("the positions of `square` are not in the file"), "{error}");
    }
    // Texture coordinates of three numbers are none.
    let mut json = square();
    json["accessors"][2]["type"] = json!("VEC3");
    json["accessors"][2]["count"] = json!(2);
    assert!(Files::new().model(&json).unwrap().parts[0].texcoords.is_empty());
}
