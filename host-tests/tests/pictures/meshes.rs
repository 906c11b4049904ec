//! Pictures of small meshes: every pixel follows from the file by hand.

use std::fs;
use std::path::Path;

use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_scene::Scene;

/// sRGB codes of the scene, three a pixel, as a scene file in a folder of its own with the mesh next to it.
fn codes(mesh: &str, camera: &str, rest: &str, object: &str) -> Vec<[u8; 3]> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mesh.obj"), mesh).unwrap();
    write_normal_map(&folder.path().join("normals.png"));
    let text = format!("[camera]\n{camera}\n{rest}\n[[object]]\nshape = \"mesh\"\npath = \"mesh.obj\"\n{object}\n");
    let scene = Scene::from_toml("test.toml", &text, folder.path()).unwrap();
    let frame = Prepared::new(&scene, Mode::Unfiltered, &Precision::STANDARD).unwrap().render(&|| ()).unwrap();
    frame.srgb_codes().as_chunks::<3>().0.to_vec()
}

/// A map of one normal, (0.5, 0.2, 0.84), four texels wide.
fn write_normal_map(path: &Path) {
    let code = |value: f64| ((value / 2.0 + 0.5) * 255.0).round() as u8;
    let pixel = [0.503, 0.197, 0.841].map(code);
    let file = fs::File::create(path).unwrap();
    let mut encoder = png::Encoder::new(file, 4, 4);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&pixel.repeat(16)).unwrap();
}

fn white(codes: &[[u8; 3]]) -> Vec<bool> {
    assert!(codes.iter().all(|code| [[0; 3], [255; 3]].contains(code)));
    codes.iter().map(|code| code[0] == 255).collect()
}

const FAR: &str = "eye = [0, 0, 500]\ntarget = [0, 0, 0]\nfov_y = 0.458363792\nwidth = 16\nheight = 16";
const WHITE: &str = "material = { colour = [1, 1, 1] }";

#[test]
fn a_concave_polygon_is_drawn_where_it_is_whichever_corner_comes_first() {
    let corners = "v -1.5 -1.5 0\nv 1.5 -1.5 0\nv 1.5 -0.5 0\nv -0.5 -0.5 0\nv -0.5 1.5 0\nv -1.5 1.5 0\n";
    let expected: Vec<bool> = (0..256)
        .map(|k| [-2.0 + (f64::from(k % 16) + 0.5) / 4.0, 2.0 - (f64::from(k / 16) + 0.5) / 4.0])
        .map(|[x, y]| x.abs() < 1.5 && y.abs() < 1.5 && (x < -0.5 || y < -0.5))
        .collect();
    assert_eq!(expected.iter().filter(|inside| **inside).count(), 80);
    for first in 0..6 {
        let face: Vec<String> = (0..6).map(|k| ((k + first) % 6 + 1).to_string()).collect();
        let mesh = format!("{corners}f {}\n", face.join(" "));
        assert_eq!(white(&codes(&mesh, FAR, "", WHITE)), expected, "from {first}");
    }
}

#[test]
fn posts_of_a_centimetre_are_the_same_picture_far_from_the_origin_and_with_an_offset() {
    let row: Vec<bool> = (0..64).map(|column| column % 8 < 4).collect();
    let expected = row.repeat(32);
    for ([x, y], offset) in [
        ([0, 0], ""),
        ([456_789, 54_321], ""),
        ([456_789, 54_321], "offset = [456789, 54321, 0]\n"),
        ([457_123, 5_412_345], "offset = [457123, 5412345, 0]\n"),
    ] {
        let mut mesh = String::new();
        for post in 0..8 {
            let [left, right] = [2 * post, 2 * post + 1].map(|place| format!("{x}.{place:02}"));
            mesh += &format!(
                "v {left} {y}.00 0\nv {right} {y}.00 0\nv {right} {y}.16 0\nv {left} {y}.16 0\nf -4 -3 -2 -1\n"
            );
        }
        let [x, y] = if offset.is_empty() { [x, y] } else { [0, 0] };
        let camera = format!(
            "eye = [{x}.08, {y}.08, 10]\ntarget = [{x}.08, {y}.08, 0]\nfov_y = 0.458363792\nwidth = 64\nheight = 32"
        );
        assert_eq!(white(&codes(&mesh, &camera, "", &format!("{offset}{WHITE}"))), expected, "{x}, {y}, {offset}");
    }
}

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";
const CLOSE: &str = "eye = [0, 0, 500]\ntarget = [0, 0, 0]\nfov_y = 0.18\nwidth = 16\nheight = 16";
const SKY: &str = "[environment]\ngenerate = \"sky\"\nface_edge = 64\nradius_degrees = 40\nsun = [1, 0.5, 0.2]";

#[test]
fn a_baked_normal_map_turns_the_normal_along_the_charts_tangent() {
    let mapped = "material = { reflectance = 1, normal_map = { path = \"normals.png\" } }";
    let plain = "material = { reflectance = 1 }";
    let largest = |a: &[[u8; 3]], b: &[[u8; 3]]| {
        a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
    };
    let mut pictures = Vec::new();
    for (uv, normal) in [
        // Plain, turned by 90°, sheared either way, mirrored, mirrored and sheared, upside down, turned and mirrored.
        ([[0., 0.], [1., 0.], [1., 1.], [0., 1.]], [0.503, 0.197]),
        ([[0., 1.], [0., 0.], [1., 0.], [1., 1.]], [-0.197, 0.503]),
        ([[0., 0.], [1., 0.], [1.5, 1.], [0.5, 1.]], [0.503, 0.197]),
        ([[0., 0.], [1., 0.], [0.2, 1.], [-0.8, 1.]], [0.503, 0.197]),
        ([[1., 0.], [0., 0.], [0., 1.], [1., 1.]], [-0.503, 0.197]),
        ([[1., 0.], [0., 0.], [-0.5, 1.], [0.5, 1.]], [-0.503, 0.197]),
        ([[1., 1.], [0., 1.], [0., 0.], [1., 0.]], [-0.503, -0.197]),
        ([[0., 0.], [0., 1.], [1., 1.], [1., 0.]], [0.197, 0.503]),
    ] {
        let texcoords: String = uv.map(|[u, v]| format!("vt {u} {v}\n")).concat();
        let mesh = format!("{SQUARE}{texcoords}vn 0 0 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\n");
        let right = format!("{SQUARE}vn {} {} 0.841\nf 1//1 2//1 3//1 4//1\n", normal[0], normal[1]);
        let expected = codes(&right, CLOSE, SKY, plain);
        let off = largest(&codes(&mesh, CLOSE, SKY, mapped), &expected);
        assert!(off <= 4, "{uv:?}: {off}");
        pictures.push((uv, mesh, expected));
    }
    // The directions of the texture turn by the shear.
    let texture = format!("tangents = \"texture\"\n{mapped}");
    let (_, sheared, expected) = &pictures[2];
    assert!(largest(&codes(sheared, CLOSE, SKY, &texture), expected) > 4);
    let (_, plain, expected) = &pictures[0];
    assert!(largest(&codes(plain, CLOSE, SKY, &texture), expected) <= 4);
    assert!(pictures.iter().skip(1).any(|(.., other)| largest(other, expected) > 20), "the sky tells directions apart");
}

#[test]
fn a_face_without_normals_shows_its_own_and_not_that_of_a_neighbour() {
    let [own, unused, flat] = [
        "v -1 -1 0\nv 0 -1 0\nv 0 1 0\nv -1 1 0\nvn 0 0.6 0.8\nf 1//1 2//1 3//1 4//1\nv 1 -1 0\nv 1 1 0\nf 2 5 6 3\n"
            .to_owned(),
        format!("{SQUARE}vn 1 0 1\nf 1 2 3 4\n"),
        format!("{SQUARE}vn 0 0 1\nf 1//1 2//1 3//1 4//1\n"),
    ]
    .map(|mesh| codes(&mesh, CLOSE, SKY, "material = { reflectance = 1 }"));
    assert_eq!(unused, flat);
    assert_eq!(own[8 * 16 + 12], flat[8 * 16 + 12]);
    assert_ne!(own[8 * 16 + 3], flat[8 * 16 + 3]);
}
