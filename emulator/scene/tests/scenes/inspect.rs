//! Pictures taken alone, as `roughxel inspect` takes them.

use glam::DVec3;
use roughxel_assets::picture::{Samples, encode_png};
use roughxel_scene::*;

fn keys(all: &[(&str, &str)]) -> Vec<(String, String)> {
    all.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
}

#[test]
fn a_picture_alone_is_read_and_refused_as_in_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let mut bytes = Vec::new();
    let codes: Vec<u8> = (0..8).flat_map(|index| [30 * index, 128, 255]).collect();
    encode_png(&mut bytes, [4, 2], Samples::Rgb8(&codes)).unwrap();
    std::fs::write(&path, bytes).unwrap();
    let take = |used_as, all: &[(&str, &str)]| take_picture(&path, used_as, &keys(all));
    let linear = take(PictureKey::ColourMap, &[("transfer", "linear")]).unwrap();
    assert_eq!(linear.shown.pixels[1], [30.0 / 255.0, 128.0 / 255.0, 1.0]);
    assert_eq!(linear.statement.transfer.unwrap().used, "linear");
    let faces = take(PictureKey::Panorama, &[("face_edge", "4"), ("exposure", "-1")]).unwrap();
    assert_eq!((faces.shown.height, faces.shown.pixels[0][2]), (4, 0.5));
    let bumps = take(PictureKey::NormalMap, &[("green", "\"down\"")]).unwrap();
    assert_eq!((bumps.shown.width, bumps.shown.height), (4, 2));
    for (used_as, all, expected) in [
        (PictureKey::Cube, &[][..], "name a panorama of longitude and latitude with `equirectangular`"),
        (PictureKey::ColourMap, &[("layr", "x")], "did you mean `layer`?"),
        (PictureKey::ColourMap, &[("layer", "x")], "which has no layer (leave `layer` out"),
        (PictureKey::ColourMap, &[("transfer", "warm")], "choose \"linear\""),
        (PictureKey::HeightMap, &[("wrap", "never")], "give true or false"),
        (PictureKey::NormalMap, &[("wrap", "false")], "`wrap` belongs to a height map"),
        (PictureKey::Panorama, &[("latitudes", "[0, 90]"), ("longitudes", "[9, 9]")], "1 to 360 above the first"),
        (PictureKey::RoughnessMap, &[("deviation", "9")], "choose a number from 0 to 4"),
        (PictureKey::ColourMap, &[("a b", "1")], "as KEY=VALUE"),
        (PictureKey::ColourMap, &[("path", "b.png")], "give each key once"),
    ] {
        let error = take(used_as, all).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn a_mesh_alone_takes_the_offset_of_its_reader() {
    let options = mesh_options(&keys(&[("offset", "[1, 2, 3]")])).unwrap();
    assert_eq!(options.offset, DVec3::new(1.0, 2.0, 3.0));
    let error = mesh_options(&keys(&[("scale", "2")])).unwrap_err().to_string();
    assert!(error.contains("unknown key `scale`") && error.contains("`offset`"), "{error}");
}
