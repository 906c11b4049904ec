//! Normal maps of two channels and of one, in all kinds of files.

use image_webp::{ColorType as WebpColour, WebPEncoder};
use tiff::encoder::{TiffEncoder, colortype};

use super::formats::read_as;
use super::*;

/// A PNG row.
fn png(color: ColorType, depth: BitDepth, width: u32, samples: &[u8]) -> Vec<u8> {
    png_bytes((width, 1), color, depth, None, samples).unwrap()
}

/// A TIFF row.
fn tiff<C: colortype::ColorType>(width: u32, samples: &[C::Inner]) -> Vec<u8>
where
    [C::Inner]: tiff::encoder::TiffValue,
{
    let mut bytes = io::Cursor::new(Vec::new());
    TiffEncoder::new(&mut bytes).unwrap().write_image::<C>(width, 1, samples).unwrap();
    bytes.into_inner()
}

fn webp(width: u32, samples: &[u8], colour: WebpColour) -> Vec<u8> {
    let mut bytes = Vec::new();
    WebPEncoder::new(&mut bytes).encode(samples, width, 1, colour).unwrap();
    bytes
}

/// Kind, file, right normals, and whether blue is left out.
type TwoChannels = (&'static str, Vec<u8>, Vec<[f64; 3]>, bool);

#[test]
fn maps_of_two_channels_get_the_third_that_makes_them_unit_normals() {
    use BitDepth::{Eight, Sixteen};
    use ColorType::{Rgb, Rgba};
    let made = |x: f64, y: f64| [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()];
    // 8-bit codes c mean (c − 128)/127, 16-bit codes 2c/65535 − 1.
    let eight = |red: u8, green: u8| made((f64::from(red) - 128.0) / 127.0, (f64::from(green) - 128.0) / 127.0);
    let sixteen = |red: u16, green: u16| made(f64::from(red) / 32767.5 - 1.0, f64::from(green) / 32767.5 - 1.0);
    let two = |blue: u8| [200, 100, blue, 60, 150, blue];
    let codes = vec![eight(200, 100), eight(60, 150)];
    let deep: Vec<u8> = [51400_u16, 25700, 0, 12000, 40000, 0].iter().flat_map(|code| code.to_be_bytes()).collect();
    let float = |blue: f32| {
        let channels = [("B", vec![blue; 2]), ("G", vec![0.25, -0.5]), ("R", vec![-0.5, 0.125])];
        exr_bytes(2, &channels, ExrEncoding::default()).unwrap()
    };
    let floats = vec![made(-0.5, 0.25), made(0.125, -0.5)];
    let table: [TwoChannels; 12] = [
        ("PNG, blue 0", png(Rgb, Eight, 2, &two(0)), codes.clone(), true),
        ("PNG, blue 127", png(Rgb, Eight, 2, &two(127)), codes.clone(), true),
        ("PNG, blue 128", png(Rgb, Eight, 2, &two(128)), codes.clone(), true),
        ("PNG, blue 255", png(Rgb, Eight, 2, &two(255)), codes.clone(), true),
        ("PNG with alpha", png(Rgba, Eight, 2, &[200, 100, 255, 9, 60, 150, 255, 9]), codes.clone(), true),
        ("PNG of 16 bits", png(Rgb, Sixteen, 2, &deep), vec![sixteen(51400, 25700), sixteen(12000, 40000)], true),
        ("TIFF", tiff::<colortype::RGB8>(2, &two(255)), codes.clone(), true),
        (
            "TIFF of floats",
            tiff::<colortype::RGB32Float>(2, &[-0.5, 0.25, 0.0, 0.125, -0.5, 0.0]),
            floats.clone(),
            true,
        ),
        ("WebP", webp(2, &two(0), WebpColour::Rgb8), codes.clone(), true),
        ("OpenEXR, blue 0", float(0.0), floats.clone(), true),
        (
            "OpenEXR, red and green alone",
            exr_bytes(2, &[("G", vec![0.25, -0.5]), ("R", vec![-0.5, 0.125])], ExrEncoding::default()).unwrap(),
            floats,
            false,
        ),
        (
            "longer than 1 in the plane",
            png(Rgb, Eight, 2, &[255, 128, 0, 128, 1, 0]),
            vec![[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
            true,
        ),
    ];
    for (kind, bytes, expected, is_left) in table {
        let read = read_as("a", &bytes, Purpose::Normals).unwrap_or_else(|error| panic!("{kind}: {error}"));
        for (found, expected) in read.picture.pixels.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((f64::from(*found) - expected).abs() < 1e-3, "{kind}: {:?} {expected}", read.picture.pixels);
        }
        assert_eq!(read.statement.signed, Some(true), "{kind}");
        assert_eq!(read.statement.left.iter().any(|name| name == "B"), is_left, "{kind}: {:?}", read.statement.left);
    }
}

#[test]
fn maps_whose_blue_is_part_of_the_normals_keep_it() {
    let code = |n: [f64; 3]| n.map(|part| (128.0 + 127.0 * part).round() as u8);
    for normals in [
        [[0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]],
        [[0.0, 0.6, 0.8], [0.6, 0.0, 0.8]],
        [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[0.28, 0.0, 0.96], [0.0, 0.28, 0.96]],
        [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]],
        [[0.8, 0.0, 0.6], [0.0, -0.8, 0.6]],
        [[0.36, 0.48, 0.8], [-0.48, 0.36, 0.8]],
        [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
        [[0.48, 0.6, 0.64], [0.6, -0.48, 0.64]],
    ] {
        let codes = normals.map(code).concat();
        let read = read_as("a.png", &png(ColorType::Rgb, BitDepth::Eight, 2, &codes), Purpose::Normals).unwrap();
        let expected: Vec<f32> = codes.iter().map(|code| f32::from(*code) / 255.0).collect();
        assert_eq!(
            (read.picture.pixels.as_flattened(), read.statement.signed),
            (expected.as_slice(), Some(false)),
            "{normals:?}"
        );
    }
}

#[test]
fn grey_pictures_are_no_normal_maps_in_any_kind_of_file() {
    use BitDepth::{Eight, One, Sixteen};
    use ColorType::{Grayscale, GrayscaleAlpha, Rgb};
    let grey = [9, 9, 9, 200, 200, 200];
    let flat = |name: &str| exr_bytes(2, &[(name, vec![0.25, 0.5])], ExrEncoding::default()).unwrap();
    let equal = exr_bytes(2, &["B", "G", "R"].map(|name| (name, vec![0.25, 0.5])), ExrEncoding::default()).unwrap();
    let hdr = [&b"#?RADIANCE\n\n-Y 1 +X 2\n"[..], &[9, 9, 9, 128, 200, 200, 200, 129]].concat();
    for (kind, bytes) in [
        ("PNG", png(Grayscale, Eight, 2, &[9, 200])),
        ("PNG of 1 bit", png(Grayscale, One, 2, &[0x40])),
        ("PNG of 16 bits", png(Grayscale, Sixteen, 2, &[9, 0, 200, 0])),
        ("PNG with alpha", png(GrayscaleAlpha, Eight, 2, &[9, 0, 200, 255])),
        ("PNG of colours", png(Rgb, Eight, 2, &grey)),
        ("TIFF", tiff::<colortype::Gray8>(2, &[9, 200])),
        ("TIFF of floats", tiff::<colortype::Gray32Float>(2, &[0.25, 0.5])),
        ("WebP", webp(2, &grey, WebpColour::Rgb8)),
        ("JPEG", include_bytes!("data/grey.jpg").to_vec()),
        ("OpenEXR, luminance", flat("Y")),
        ("OpenEXR, a channel of any name", flat("v")),
        ("OpenEXR, colours", equal),
        ("Radiance", hdr),
    ] {
        let error = read_as("a", &bytes, Purpose::Normals).unwrap_err().to_string();
        assert!(error.contains("is grey: a normal map has a red, a green and a blue channel"), "{kind}: {error}");
        assert!(error.contains("use it as `height_map`"), "{kind}: {error}");
    }
}
