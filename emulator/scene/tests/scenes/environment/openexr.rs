//! Cubes and panoramas of OpenEXR.

use super::*;

/// Writes an OpenEXR picture of floats without compression, with an `envmap` if there is one.
fn write_exr(folder: &Path, name: &str, picture: &Picture, envmap: Option<u8>) {
    let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        bytes.extend(
            [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &(value.len() as u32).to_le_bytes(), value].concat(),
        );
    };
    let channel =
        |name: u8| [&[name, 0][..], &2_u32.to_le_bytes(), &[0; 4], &1_u32.to_le_bytes(), &1_u32.to_le_bytes()].concat();
    let window = [0, 0, picture.width as i32 - 1, picture.height as i32 - 1].map(i32::to_le_bytes).concat();
    attribute("channels", "chlist", &[channel(b'B'), channel(b'G'), channel(b'R'), vec![0]].concat());
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    if let Some(envmap) = envmap {
        attribute("envmap", "envmap", &[envmap]);
    }
    bytes.push(0);
    let (rows, line) = (picture.height as usize, 12 * picture.width as usize);
    let first = bytes.len() + 8 * rows;
    bytes.extend((0..rows).flat_map(|row| ((first + row * (line + 8)) as u64).to_le_bytes()));
    for (row, pixels) in picture.pixels.chunks_exact(picture.width as usize).enumerate() {
        bytes.extend([(row as u32).to_le_bytes(), (line as u32).to_le_bytes()].concat());
        bytes.extend(
            [2, 1, 0].into_iter().flat_map(|channel| pixels.iter().flat_map(move |p| p[channel].to_le_bytes())),
        );
    }
    std::fs::write(folder.join(name), bytes).unwrap();
}

#[test]
fn a_cube_of_openexr_is_read_as_it_says_and_not_as_a_panorama() {
    let folder = tempfile::tempdir().unwrap();
    let edges = |camera: &Camera| picture(EDGE, EDGE, |x, y| light(camera.sees(on_edges(x), on_edges(y))));
    write_exr(folder.path(), "cube.exr", &column(CAMERAS.each_ref().map(edges)), Some(1));
    let scene = read(folder.path(), "cube = \"cube.exr\"").unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    for (face, picture) in scene.environment.unwrap().faces.iter().enumerate() {
        for (index, pixel) in picture.pixels.iter().enumerate() {
            let wanted = light(direction(face, centre(index % EDGE), centre(index / EDGE)));
            // Interpolation of a linear function, in floats.
            assert!(pixel.iter().zip(wanted).all(|(got, wanted)| (got - wanted).abs() < 1e-6), "face {face}, {index}");
        }
    }
    let refused = |keys: &str| read(folder.path(), keys).unwrap_err().to_string();
    let message = refused("equirectangular = \"cube.exr\"");
    assert!(
        message.contains("says that it holds the six faces of a cube (`envmap`) (name it with `cube`)"),
        "{message}"
    );
    // The word of the file counts even if its shape is that of a panorama.
    write_exr(folder.path(), "wide.exr", &Picture::filled(64, 32, [0.5; 3]), Some(1));
    assert!(refused("equirectangular = \"wide.exr\"").contains("six faces of a cube"));
    assert!(refused("cube = \"wide.exr\"").contains("its shape is 1:6"));
}

#[test]
fn a_panorama_of_openexr_is_named_for_its_middle() {
    let folder = tempfile::tempdir().unwrap();
    let ignored = |envmap, keys: &str| {
        write_exr(folder.path(), "sky.exr", &Picture::filled(64, 32, [0.5; 3]), envmap);
        let scene = read(folder.path(), &format!("equirectangular = \"sky.exr\", face_edge = 4{keys}")).unwrap();
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        scene.pictures[0].statement.ignored.join("; ")
    };
    assert!(ignored(Some(0), "").contains("`longitudes = [0, 360]` turns the map"));
    assert_eq!(ignored(Some(0), ", longitudes = [0, 360]"), "");
    assert_eq!(ignored(None, ""), "");
}

/// Normal map of floats: kind, texels, and the offsets (n_x, n_y) / n_z that they mean.
type NormalMap = (&'static str, Vec<[f32; 3]>, Vec<[f32; 2]>);

#[test]
fn normals_in_floats_are_signed_or_coded_as_their_lengths_tell() {
    let folder = tempfile::tempdir().unwrap();
    let coded = |normal: [f32; 3]| normal.map(|component| 0.5 * component + 0.5);
    let (up, tilted, steep) = ([0.0, 0.0, 1.0], [-0.5, -0.25, 0.829_156_2], [0.6, 0.0, 0.8]);
    let table: [NormalMap; 10] = [
        ("signed and level", vec![up; 4], vec![[0.0; 2]; 4]),
        ("coded and level", vec![coded(up); 4], vec![[0.0; 2]; 4]),
        ("signed and tilted", vec![tilted; 2], vec![[-0.603_022_7, -0.301_511_3]; 2]),
        ("coded and tilted", vec![coded(tilted); 2], vec![[-0.603_022_7, -0.301_511_3]; 2]),
        ("signed, all components above 0", vec![steep, [0.0, 0.6, 0.8]], vec![[0.75, 0.0], [0.0, 0.75]]),
        ("coded, all components above 0", vec![coded(steep), coded(up)], vec![[0.75, 0.0], [0.0; 2]]),
        ("signed, shortened by a filter", vec![[0.0, 0.0, 0.9], [0.3, 0.0, 0.8]], vec![[0.0; 2], [0.375, 0.0]]),
        (
            "coded, shortened by a filter",
            vec![coded([0.0, 0.0, 0.9]), coded([0.3, 0.0, 0.8])],
            vec![[0.0; 2], [0.375, 0.0]],
        ),
        ("signed, in half turns", vec![[-0.6, 0.0, 0.8], [0.0, -0.6, 0.8]], vec![[-0.75, 0.0], [0.0, -0.75]]),
        (
            "coded, a filter rings below 0",
            vec![coded(up), coded(steep), coded([-1.002, 0.0, 0.0])],
            vec![[0.0; 2], [0.75, 0.0], [-OFFSET_LIMIT, 0.0]],
        ),
    ];
    for (kind, texels, wanted) in table {
        write_exr(folder.path(), "n.exr", &Picture { width: texels.len() as u32, height: 1, pixels: texels }, None);
        let text = "camera = { eye = [0, 1, 5], target = [0, 0, 0] }\n[[object]]\nshape = \"plane\"\n\
                    material.normal_map = { path = \"n.exr\" }\n";
        let scene = Scene::from_toml("test.toml", text, folder.path()).unwrap();
        let bump = scene.objects[0].material.bump.clone().unwrap();
        for (offset, wanted) in bump.offsets.iter().zip(wanted) {
            let close = offset.iter().zip(wanted).all(|(offset, wanted)| (offset - wanted).abs() < 1e-5);
            assert!(close, "{kind}: {offset:?} {wanted:?}");
        }
    }
}
