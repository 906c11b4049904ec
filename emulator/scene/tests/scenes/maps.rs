//! Picture files in scenes: what a file says becomes a map, a statement, or a warning with the key that decides otherwise.

use roughxel_assets::picture::Window;
use roughxel_scene::Scene;

const HEAD: &str = "camera = { eye = [0, 0, 2], target = [0, 0, 0] }\n";

/// An uncompressed OpenEXR file of float channels, each with its numbers in rows from the top.
fn exr(width: usize, windows: Option<[[i32; 4]; 2]>, channels: &[(&str, Vec<f32>)]) -> Vec<u8> {
    let height = channels[0].1.len() / width;
    let whole = [0, 0, width as i32 - 1, height as i32 - 1];
    let [data, display] = windows.unwrap_or([whole, whole]);
    let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        bytes.extend(
            [name.as_bytes(), b"\0", kind.as_bytes(), b"\0", &(value.len() as u32).to_le_bytes(), value].concat(),
        );
    };
    let window = |corners: [i32; 4]| corners.map(i32::to_le_bytes).concat();
    let list: Vec<u8> = channels
        .iter()
        .flat_map(|(name, _)| {
            let numbers = [2_u32, 0, 1, 1].map(u32::to_le_bytes).concat();
            [name.as_bytes(), b"\0", &numbers].concat()
        })
        .chain([0])
        .collect();
    attribute("channels", "chlist", &list);
    attribute("compression", "compression", &[0]);
    attribute("dataWindow", "box2i", &window(data));
    attribute("displayWindow", "box2i", &window(display));
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1.0_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1.0_f32.to_le_bytes());
    bytes.push(0);
    let line = 8 + 4 * width * channels.len();
    let first = bytes.len() + 8 * height;
    bytes.extend((0..height).flat_map(|row| ((first + row * line) as u64).to_le_bytes()));
    for row in 0..height {
        bytes.extend((data[1] + row as i32).to_le_bytes());
        bytes.extend(((line - 8) as u32).to_le_bytes());
        for (_, numbers) in channels {
            bytes.extend(numbers[row * width..(row + 1) * width].iter().flat_map(|number| number.to_le_bytes()));
        }
    }
    bytes
}

/// A scene with one plane whose material has these keys, and files next to it.
fn scene(keys: &str, files: &[(&str, Vec<u8>)]) -> Result<Scene, String> {
    let text = format!("{HEAD}[[object]]\nname = \"it\"\nshape = \"plane\"\nmaterial = {{ {keys} }}\n");
    scene_of(&text, files)
}

fn scene_of(text: &str, files: &[(&str, Vec<u8>)]) -> Result<Scene, String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    Scene::from_toml("test.toml", text, folder.path()).map_err(|error| error.to_string())
}

fn offsets(scene: &Scene) -> &[[f32; 2]] {
    &scene.objects[0].material.bump.as_ref().unwrap().offsets
}

#[test]
fn heights_below_0_count_as_those_above() {
    let wave: Vec<f32> = (0..32).map(|x| 0.5 * (std::f32::consts::TAU * x as f32 / 32.0).sin()).collect();
    let raised: Vec<f32> = wave.iter().map(|height| height + 0.5).collect();
    let map = |heights: Vec<f32>| {
        scene("height_map = { path = \"h.exr\", scale = 0.2 }", &[("h.exr", exr(32, None, &[("Y", heights)]))]).unwrap()
    };
    let (signed, raised) = (map(wave), map(raised));
    for (a, b) in offsets(&signed).iter().flatten().zip(offsets(&raised).iter().flatten()) {
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
    assert!(signed.warnings.is_empty());
}

#[test]
fn signed_normals_are_the_offsets_of_coded_ones() {
    let normal = [-0.5, -0.25, 0.829];
    let map = |normal: [f32; 3], keys: &str| {
        let channels: Vec<_> = ["B", "G", "R"].into_iter().zip([2, 1, 0].map(|c| vec![normal[c]])).collect();
        let keys = format!("normal_map = {{ path = \"n.exr\"{keys} }}");
        scene(&keys, &[("n.exr", exr(1, None, &channels))]).unwrap()
    };
    let signed = map(normal, "");
    let coded = map(normal.map(|component| 0.5 + 0.5 * component), "");
    let expected = [-0.5 / 0.829, -0.25 / 0.829];
    for scene in [&signed, &coded] {
        for (offset, expected) in offsets(scene)[0].iter().zip(expected) {
            assert!((offset - expected).abs() < 1e-4, "{offset} {expected}");
        }
    }
    assert_eq!(signed.pictures[0].statement.signed, Some(true));
    assert_eq!(coded.pictures[0].statement.signed, Some(false));
    assert_eq!(offsets(&map([0.0, 0.0, 1.0], "")), [[0.0, 0.0]]);
    // (0, 0, 1) as a code is (−1, −1, 1).
    let coded = map([0.0, 0.0, 1.0], ", signed = false");
    assert!(offsets(&coded)[0].iter().all(|offset| (offset + 1.0).abs() < 0.01), "{:?}", offsets(&coded));
    assert_eq!(offsets(&map([0.0, 0.6, 0.8], ", green = \"down\""))[0][1], -0.75);
    // The signs of a file do not pass to a generated map.
    let text = format!(
        "{HEAD}[[object]]\nshape = \"plane\"\nmaterial = {{ normal_map = {{ path = \"n.exr\" }} }}\n\
         [[object]]\nshape = \"plane\"\nmaterial = {{ normal_map = {{ generate = \"hammered\", size = 16 }} }}\n"
    );
    let files = [("n.exr", exr(1, None, &[("X", vec![0.6]), ("Y", vec![0.0]), ("Z", vec![0.8])]))];
    let both = scene_of(&text, &files).unwrap();
    let alone = scene("normal_map = { generate = \"hammered\", size = 16 }", &[]).unwrap();
    assert_eq!(both.objects[1].material.bump, alone.objects[0].material.bump);
}

#[test]
fn light_below_0_is_counted_before_it_is_cut() {
    let channels = [("B", vec![1.0; 2]), ("G", vec![1.0; 2]), ("R", vec![1.0, -0.5])];
    let text = format!("{HEAD}environment = {{ equirectangular = \"sky.exr\", face_edge = 4 }}\n");
    let sky = scene_of(&text, &[("sky.exr", exr(2, None, &channels))]).unwrap();
    assert_eq!(sky.warnings.len(), 1, "{:?}", sky.warnings);
    assert!(sky.warnings[0].contains("of the light is below 0 and was cut"), "{:?}", sky.warnings);
    let map = scene("colour_map = { path = \"c.exr\" }", &[("c.exr", exr(2, None, &channels))]).unwrap();
    assert_eq!(map.warnings, ["it: colour map: 9.09 % of the light is below 0 and was cut"]);
}

#[test]
fn heights_of_any_sign_have_the_slopes_of_their_differences() {
    for (kind, heights, scale) in [
        ("above 0", [0.0, 0.25, 0.5, 0.25], 0.1),
        ("below 0", [-0.5, -0.25, 0.0, -0.25], 0.1),
        ("around 0", [-0.5, 0.0, 0.5, 0.0], 0.1),
        ("all below 0", [-3.0, -2.5, -4.0, -2.0], 0.1),
        ("metres below the sea", [-4000.0, -3999.0, -4000.5, -3998.0], 0.1),
        ("a scale below 0", [-0.5, 0.0, 0.5, 0.0], -0.1),
        ("one pit", [0.0, 0.0, -1.0, 0.0], 0.2),
        ("one peak", [0.0, 0.0, 1.0, 0.0], 0.2),
        ("tiny", [-1e-6, 0.0, 1e-6, 0.0], 1000.0),
        ("level below 0", [-2.0; 4], 0.5),
        ("minus zero", [-0.0, 0.0, -0.0, 0.0], 1.0),
    ] {
        let keys = format!("height_map = {{ path = \"h.exr\", scale = {scale} }}");
        let scene = scene(&keys, &[("h.exr", exr(4, None, &[("Y", heights.to_vec())]))]).unwrap();
        for (index, offset) in offsets(&scene).iter().enumerate() {
            let [left, right] = [(index + 3) % 4, (index + 1) % 4].map(|index| f64::from(heights[index]));
            // Four texels in a repeat; two between the neighbours.
            let expected = (-scale * (right - left) * 4.0 / 2.0).clamp(-8.0, 8.0);
            assert!(
                (f64::from(offset[0]) - expected).abs() < 1e-3 && offset[1] == 0.0,
                "{kind}: {offset:?} {expected}"
            );
        }
        assert!(scene.warnings.iter().all(|warning| warning.contains("steeper than")), "{kind}: {:?}", scene.warnings);
    }
}

#[test]
fn light_below_0_is_told_by_its_share_in_every_use() {
    for (kind, [red, green, blue], share) in [
        ("none", [1.0, 0.5, 0.25], None),
        ("black", [0.0; 3], None),
        ("red", [-0.5, 1.0, 1.0], Some("20.00 %")),
        ("green", [3.0, -1.0, 0.0], Some("25.00 %")),
        ("blue", [1.0, 1.0, -2.0], Some("50.00 %")),
        ("two channels", [-1.0, -1.0, 8.0], Some("20.00 %")),
        ("all", [-1.0, -2.0, -3.0], Some("100.00 %")),
        ("a trace", [1.0, 1.0, -1e-5], Some("less than 0.01 %")),
        ("next to bright light", [60.0, 39.0, -1.0], Some("1.00 %")),
        ("minus zero", [-0.0, 1.0, 1.0], None),
    ] {
        let channels = [("B", vec![blue; 8]), ("G", vec![green; 8]), ("R", vec![red; 8])];
        let files = [("c.exr", exr(4, None, &channels))];
        let map = scene("colour_map = { path = \"c.exr\" }", &files).unwrap();
        let text = format!("{HEAD}environment = {{ equirectangular = \"c.exr\", face_edge = 4 }}\n");
        let sky = scene_of(&text, &files).unwrap();
        for (scene, name) in [(&map, "it: colour map"), (&sky, "environment")] {
            let expected: Vec<String> =
                share.iter().map(|share| format!("{name}: {share} of the light is below 0 and was cut")).collect();
            assert_eq!(scene.warnings, expected, "{kind}");
        }
    }
}

#[test]
fn a_crop_of_a_panorama_is_black_outside_and_says_so() {
    let upper = exr(4, Some([[0, 0, 3, 0], [0, 0, 3, 1]]), &[("Y", vec![1.0; 4])]);
    let text = |keys: &str| {
        let keys = format!("equirectangular = \"sky.exr\", face_edge = 2{keys}");
        format!("{HEAD}environment = {{ {keys} }}\n")
    };
    let sky = scene_of(&text(""), &[("sky.exr", upper.clone())]).unwrap();
    let down = &sky.environment.as_ref().unwrap().faces[3];
    // The two rows are interpolated near the horizon.
    assert!(down.pixels.iter().flatten().all(|channel| *channel < 0.01), "{:?}", down.pixels);
    let warning = "environment: its data window covers 50.0 % of its display window; the rest is black";
    assert!(sky.warnings[0].starts_with(warning), "{:?}", sky.warnings);
    assert_eq!(sky.pictures[0].statement.windows.unwrap().used, Window::Display);
    let data = scene_of(&text(", window = \"data\", latitudes = [-90, 90]"), &[("sky.exr", upper)]).unwrap();
    assert!(data.warnings.is_empty() && data.environment.unwrap().faces[3].pixels[0] == [1.0; 3]);
}

#[test]
fn keys_decide_against_a_file_and_belong_to_files_of_their_use() {
    let colours = |prefix: &str, value: f32| ["B", "G", "R"].map(|c| (format!("{prefix}{c}"), vec![value]));
    let own = [colours("a.", 0.25), colours("b.", 0.75)].concat();
    let channels: Vec<_> = own.iter().map(|(name, numbers)| (name.as_str(), numbers.clone())).collect();
    let files = [("c.exr", exr(1, None, &channels))];
    let pixel = |keys: &str| {
        let scene = scene(&format!("colour_map = {{ path = \"c.exr\"{keys} }}"), &files);
        scene.map(|scene| scene.objects[0].material.colour_map.as_ref().unwrap().pixels[0])
    };
    let unclear = pixel("").unwrap_err();
    assert!(unclear.starts_with("test.toml:5:36: ") && unclear.contains("B, G, R (layer `b`)"), "{unclear}");
    assert!(unclear.contains("(name the layer or channel to read by the key `layer`)"), "{unclear}");
    assert_eq!(pixel(", layer = \"b\"").unwrap(), [0.75; 3]);
    assert_eq!(pixel(", layer = \"a.G\"").unwrap(), [0.25; 3]);
    let srgb = pixel(", layer = \"b\", transfer = \"srgb\"").unwrap()[0];
    assert!((srgb - 0.5225).abs() < 1e-4, "{srgb}");
    // White stays white in all spaces, and so does grey.
    let grey = pixel(", layer = \"b\", colour_space = \"acescg\"").unwrap();
    assert!(grey.iter().all(|channel| (channel - 0.75).abs() < 1e-5), "{grey:?}");
    assert!(pixel(", transfer = \"srbg\"").unwrap_err().contains("did you mean `srgb`?"));
    assert!(pixel(", colour_space = \"acesgc\"").unwrap_err().contains("did you mean `acescg`?"));
    assert!(pixel(", layer = \"a\", signed = true").unwrap_err().contains("unknown key `signed`"));
    let heights = scene("height_map = { path = \"c.exr\", layer = \"a\", transfer = \"srgb\" }", &files);
    assert!(heights.unwrap_err().contains("unknown key `transfer`"));
    let generated = scene("colour_map = { generate = \"noise\", layer = \"a\" }", &files);
    assert!(generated.unwrap_err().contains("unknown key `layer`"));
}

#[test]
fn errors_name_the_kind_and_the_remedy_and_paths_alone_are_relative() {
    let error = |bytes: &[u8]| scene("colour_map = { path = \"c.png\" }", &[("c.png", bytes.to_vec())]).unwrap_err();
    let gif = error(b"GIF89a\x01\0\x01\0");
    assert!(gif.contains("c.png` is a file of the kind GIF, which is not read (export it as PNG, EXR"), "{gif}");
    let damaged = error(b"\x89PNG\r\n\x1a\n");
    assert!(
        damaged.contains("is not a readable PNG file") && damaged.contains("(export it again as PNG)"),
        "{damaged}"
    );
    let missing = scene("colour_map = { path = \"c.png\" }", &[]).unwrap_err();
    assert!(missing.contains("cannot open picture") && missing.contains("(paths are relative to the scene file)"));
    for other in [gif, damaged] {
        assert!(!other.contains("relative"), "{other}");
    }
}

#[test]
fn a_scene_lists_its_files_with_their_uses() {
    let file = exr(1, None, &[("Y", vec![0.5])]);
    let keys = "colour_map = { path = \"a.exr\" }, height_map = { path = \"b.exr\" }";
    let scene = scene(keys, &[("a.exr", file.clone()), ("b.exr", file)]).unwrap();
    let uses: Vec<_> = scene.pictures.iter().map(|read| (read.used_as.as_str(), read.path.as_str())).collect();
    assert_eq!(uses, [("it: colour map", "a.exr"), ("it: height map", "b.exr")]);
    let [colours, heights] = [0, 1].map(|index| &scene.pictures[index].statement);
    assert_eq!(colours.to_string(), "OpenEXR, 1×1, channels Y, Rec. 709, linear");
    assert_eq!(heights.to_string(), "OpenEXR, 1×1, channels Y");
    assert!(scene.warnings.is_empty());
}
