//! JPEG, TIFF and WebP, files of other kinds, and names that promise another kind.
//!
//! The files in `data` are 16×8 pixels, the left half (200, 100, 50), the right half (20, 60, 240), written by Pillow 13.0.

use std::path::Path;

use image_webp::{ColorType as WebpColour, WebPEncoder};
use tiff::encoder::colortype;
use tiff::encoder::{Compression as TiffCompression, TiffEncoder, TiffValue};
use tiff::tags::Tag;

use super::*;

pub(super) const RGB_JPEG: &[u8] = include_bytes!("data/rgb.jpg");
const PROGRESSIVE_JPEG: &[u8] = include_bytes!("data/progressive.jpg");
const GREY_JPEG: &[u8] = include_bytes!("data/grey.jpg");
const CMYK_JPEG: &[u8] = include_bytes!("data/cmyk.jpg");
const TURNED_JPEG: &[u8] = include_bytes!("data/turned.jpg");
const RESTART_JPEG: &[u8] = include_bytes!("data/restart.jpg");
const RGB_STORED_JPEG: &[u8] = include_bytes!("data/rgb_stored.jpg");
const LOSSY_ALPHA_WEBP: &[u8] = include_bytes!("data/lossy_alpha.webp");
const PLANAR_TILES_TIFF: &[u8] = include_bytes!("data/planar_tiles.tif");
const SUBSAMPLED_JPEG: &[u8] = include_bytes!("data/subsampled.jpg");
const LOSSY_WEBP: &[u8] = include_bytes!("data/lossy.webp");
const ANIMATED_WEBP: &[u8] = include_bytes!("data/animated.webp");
const PALETTE_TIFF: &[u8] = include_bytes!("data/palette.tif");

pub(super) fn read_as(name: &str, bytes: &[u8], purpose: Purpose) -> Result<PictureFile, PictureError> {
    let directory = Directory::new().unwrap();
    read(&directory.file(name, bytes).unwrap(), purpose, &Wishes::default())
}

/// 8-bit codes of a pixel.
pub(super) fn codes(read: &PictureFile, x: u32, y: u32) -> [i32; 3] {
    read.picture.pixel(x, y).map(|value| (value * 255.0).round() as i32)
}

#[test]
fn lossy_files_are_within_two_codes_and_decoded_from_srgb() {
    let (left, right) = ([200, 100, 50], [20, 60, 240]);
    // Grey: 0.299 R + 0.587 G + 0.114 B.
    let (dark, light) = ([124; 3], [69; 3]);
    for (kind, bytes, colours) in [
        ("JPEG", RGB_JPEG, [left, right]),
        ("JPEG", PROGRESSIVE_JPEG, [left, right]),
        ("JPEG", SUBSAMPLED_JPEG, [left, right]),
        ("JPEG", GREY_JPEG, [dark, light]),
        ("WebP", LOSSY_WEBP, [left, right]),
    ] {
        let data = read_as("a", bytes, Purpose::Data).unwrap();
        assert_eq!((data.statement.kind.as_str(), data.statement.size), (kind, [16, 8]));
        for (place, expected) in [(3, 3), (12, 4)].into_iter().zip(colours) {
            let found = codes(&data, place.0, place.1);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 2), "{kind}: {found:?} {expected:?}");
            let light = read_as("a", bytes, Purpose::Colours).unwrap().picture.pixel(place.0, place.1);
            assert_eq!(light, found.map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32), "{kind}");
        }
    }
}

#[test]
fn a_camera_that_was_turned_is_turned_back() {
    // Orientation 6: column 0 of the stored picture is the top row, so its left half is above.
    let read = read_as("a.jpg", TURNED_JPEG, Purpose::Data).unwrap();
    assert_eq!(read.statement.size, [8, 16]);
    assert!(read.statement.notes[0].contains("orientation 6"), "{:?}", read.statement.notes);
    let (top, bottom) = (codes(&read, 4, 3), codes(&read, 4, 12));
    assert!(top[0] > 190 && bottom[2] > 230, "{top:?} {bottom:?}");
}

/// TIFF bytes of a picture.
fn tiff_of<C: colortype::ColorType>(
    width: u32,
    samples: &[C::Inner],
    compression: TiffCompression,
    tags: &[(Tag, &[u16])],
) -> Vec<u8>
where
    [C::Inner]: TiffValue,
{
    let mut bytes = io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap().with_compression(compression);
    let height = samples.len() / (width as usize * C::BITS_PER_SAMPLE.len());
    let mut image = encoder.new_image::<C>(width, height as u32).unwrap();
    for (tag, values) in tags {
        image.encoder().write_tag(*tag, *values).unwrap();
    }
    image.write_data(samples).unwrap();
    bytes.into_inner()
}

#[test]
fn tiffs_of_all_samples_and_compressions_give_their_values() {
    use TiffCompression::{Lzw, Uncompressed};
    let deflate = TiffCompression::Deflate(Default::default());
    let (a, b) = ([0.25, -0.5, 7.0_f32], [0.5, 0.0, 1e-3]);
    let floats = [a, b].concat();
    let eighths = |codes: [u8; 3]| codes.map(|code| (f64::from(code) / 255.0) as f32);
    let sixteenths = |codes: [u16; 3]| codes.map(|code| (f64::from(code) / 65535.0) as f32);
    for compression in [Uncompressed, Lzw, deflate, TiffCompression::Packbits] {
        let table = [
            ("grey", tiff_of::<colortype::Gray8>(2, &[51, 255], compression, &[]), [[0.2; 3], [1.0; 3]]),
            (
                "grey of 16 bits",
                tiff_of::<colortype::Gray16>(2, &[13107, 65535], compression, &[]),
                [[0.2; 3], [1.0; 3]],
            ),
            (
                "RGB",
                tiff_of::<colortype::RGB8>(2, &[1, 2, 3, 253, 254, 255], compression, &[]),
                [eighths([1, 2, 3]), eighths([253, 254, 255])],
            ),
            (
                "RGB of 16 bits",
                tiff_of::<colortype::RGB16>(2, &[1, 2, 3, 1000, 2000, 65535], compression, &[]),
                [sixteenths([1, 2, 3]), sixteenths([1000, 2000, 65535])],
            ),
            (
                "RGB with alpha",
                tiff_of::<colortype::RGBA8>(2, &[1, 2, 3, 0, 253, 254, 255, 9], compression, &[]),
                [eighths([1, 2, 3]), eighths([253, 254, 255])],
            ),
            ("floats", tiff_of::<colortype::RGB32Float>(2, &floats, compression, &[]), [a, b]),
            (
                "grey floats",
                tiff_of::<colortype::Gray32Float>(2, &[-3.5, 0.125], compression, &[]),
                [[-3.5; 3], [0.125; 3]],
            ),
        ];
        for (kind, bytes, expected) in table {
            let data = read_as("a.tif", &bytes, Purpose::Heights).unwrap();
            assert_eq!(data.picture.pixels, expected, "{kind}");
            let light = read_as("a.tif", &bytes, Purpose::Colours).unwrap();
            let linear = |value: f32| if kind.contains("float") { value } else { srgb_to_linear(value.into()) as f32 };
            for (found, expected) in light.picture.pixels.iter().flatten().zip(expected.as_flattened()) {
                assert!((found - linear(*expected)).abs() <= 1e-6, "{kind}: {found}");
            }
        }
    }
    let turned = tiff_of::<colortype::Gray8>(2, &[51, 255], Uncompressed, &[(Tag::Orientation, &[3])]);
    assert_eq!(read_as("a", &turned, Purpose::Data).unwrap().picture.pixels, [[1.0; 3], [0.2; 3]]);
}

#[test]
fn tiffs_of_other_kinds_are_named_for_what_they_are() {
    let plain = TiffCompression::Uncompressed;
    let nan = tiff_of::<colortype::Gray32Float>(2, &[0.0, f32::NAN], plain, &[]);
    for (bytes, expected) in [
        (PALETTE_TIFF.to_vec(), "is a TIFF of a kind that is not read: Photometric interpretation RGBPalette"),
        (tiff_of::<colortype::CMYK8>(1, &[1, 2, 3, 4], plain, &[]), "a TIFF in colours for print"),
        (tiff_of::<colortype::GrayI16>(2, &[-1, 5], plain, &[]), "a TIFF with integers of 16 bits"),
        (tiff_of::<colortype::Gray32>(2, &[1, 5], plain, &[]), "a TIFF with integers of 32 bits"),
        (PLANAR_TILES_TIFF.to_vec(), "is a TIFF with tiles for each channel, which is not read; export it as a TIFF"),
        (nan, "has the value NaN at pixel (1, 0)"),
    ] {
        let error = read_as("a.tif", &bytes, Purpose::Colours).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
    let mut bytes = io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for grey in [51, 255] {
        encoder.write_image::<colortype::Gray8>(1, 1, &[grey]).unwrap();
    }
    let pages = read_as("a.tif", &bytes.into_inner(), Purpose::Data).unwrap();
    assert_eq!((pages.picture.pixels[0], pages.statement.ignored.len()), ([0.2; 3], 1));
}

#[test]
fn webps_give_their_codes() {
    let (rgb, alpha) = ([1, 2, 3, 253, 254, 255], [1, 2, 3, 255, 253, 254, 255, 128]);
    for (samples, colour) in [(&rgb[..], WebpColour::Rgb8), (&alpha, WebpColour::Rgba8)] {
        let mut bytes = Vec::new();
        WebPEncoder::new(&mut bytes).encode(samples, 2, 1, colour).unwrap();
        let read = read_as("a.png", &bytes, Purpose::Data).unwrap();
        assert_eq!([codes(&read, 0, 0), codes(&read, 1, 0)], [[1, 2, 3], [253, 254, 255]]);
        assert_eq!(read.statement.left.is_empty(), colour == WebpColour::Rgb8);
    }
}

/// Files under a name that promises another kind, and what their error says.
#[test]
fn files_are_known_by_their_bytes_and_others_are_named() {
    let png = png_bytes((1, 1), ColorType::Rgb, BitDepth::Eight, None, &[1, 2, 3]).unwrap();
    for name in ["a.exr", "a.hdr", "a.jpg", "a", "a.PNG"] {
        assert_eq!(read_as(name, &png, Purpose::Data).unwrap().statement.kind, "PNG", "{name}");
    }
    let table: [(&str, &[u8], &str); 14] = [
        ("a.png", b"DDS \x7c\0\0\0", "is not a readable DDS file"),
        ("a.png", b"\xabKTX 20\xbb\r\n\x1a\n", "is not a readable KTX2 file"),
        ("a.exr", b"GIF89a\x01\0\x01\0", "kind GIF"),
        ("a.hdr", b"BM\x36\0\0\0\0\0\0\0\x36\0\0\0", "kind BMP"),
        ("a.png", b"8BPS\0\x01", "kind Photoshop (PSD)"),
        ("a.png", b"%PDF-1.7\n", "kind PDF"),
        ("a.png", b"\0\0\0\x0cjP  \r\n\x87\n", "kind JPEG 2000"),
        ("a.png", b"\0\0\0\x1cftypavif\0\0\0\0", "kind AVIF"),
        ("a.png", b"<svg xmlns=\"http://www.w3.org/2000/svg\"/>", "kind SVG"),
        ("a.png", b"<!DOCTYPE html><title>404</title>", "kind HTML"),
        ("a.png", b"v 0 0 0\n", "kind text"),
        ("a.png", b"version https://git-lfs.github.com/spec/v1\n", "pointer of Git LFS"),
        ("a.png", b"", "is empty"),
        ("a.png", b"\x01\x02\x03", "no picture of a known kind"),
    ];
    for (name, bytes, expected) in table {
        let error = read_as(name, bytes, Purpose::Colours).unwrap_err();
        assert!(error.to_string().contains(expected) && !error.is_missing(), "{expected}: {error}");
    }
    let print = read_as("a.jpg", CMYK_JPEG, Purpose::Colours).unwrap_err().to_string();
    assert!(print.contains("in colours for print") && print.contains("a JPEG in RGB"), "{print}");
    assert!(fails(read_as("a.webp", ANIMATED_WEBP, Purpose::Colours), "is an animation"));
    let missing = read(Path::new("/no such directory/a.png"), Purpose::Colours, &Wishes::default());
    assert!(missing.unwrap_err().is_missing());
}

#[test]
fn wishes_that_a_file_cannot_meet_are_errors() {
    let directory = Directory::new().unwrap();
    let path = directory.file("a.jpg", RGB_JPEG).unwrap();
    let layer = Wishes { layer: Some("Combined".into()), ..Wishes::default() };
    assert!(fails(read(&path, Purpose::Colours, &layer), "kind JPEG, which has no layer; leave `layer` out"));
    let window = Wishes { window: Some(Window::Data), ..Wishes::default() };
    assert!(fails(read(&path, Purpose::Colours, &window), "kind JPEG, which has no window"));
    let signed = Wishes { signed: Some(true), ..Wishes::default() };
    assert!(fails(read(&path, Purpose::Normals, &signed), "integer codes from 0, which are not signed"));
}

#[test]
fn truncated_and_damaged_files_of_all_formats_never_panic() {
    let mut webp = Vec::new();
    WebPEncoder::new(&mut webp).encode(&[7; 81], 9, 3, WebpColour::Rgb8).unwrap();
    let ramp: Vec<u8> = (0..81_u32).map(|i| (i * 37 % 83) as u8).collect();
    let floats: Vec<f32> = ramp.iter().map(|value| f32::from(*value)).collect();
    let files = [
        RGB_JPEG.to_vec(),
        PROGRESSIVE_JPEG.to_vec(),
        SUBSAMPLED_JPEG.to_vec(),
        TURNED_JPEG.to_vec(),
        RESTART_JPEG.to_vec(),
        RGB_STORED_JPEG.to_vec(),
        LOSSY_ALPHA_WEBP.to_vec(),
        PLANAR_TILES_TIFF.to_vec(),
        include_bytes!("data/planar.tif").to_vec(),
        include_bytes!("data/planar_float.tif").to_vec(),
        include_bytes!("data/tiles.tif").to_vec(),
        GREY_JPEG.to_vec(),
        LOSSY_WEBP.to_vec(),
        ANIMATED_WEBP.to_vec(),
        webp,
        PALETTE_TIFF.to_vec(),
        tiff_of::<colortype::RGB8>(9, &ramp, TiffCompression::Lzw, &[]),
        tiff_of::<colortype::Gray32Float>(9, &floats, TiffCompression::Deflate(Default::default()), &[]),
        tiff_of::<colortype::Gray8>(9, &ramp, TiffCompression::Packbits, &[]),
    ];
    let directory = Directory::new().unwrap();
    let read = |bytes: &[u8]| read(&directory.file("a", bytes).unwrap(), Purpose::Colours, &Wishes::default());
    let mut random = SplitMix64::new(3);
    for bytes in &files {
        let whole = read(bytes).ok();
        for length in 0..bytes.len() {
            // A file without its last bytes is an error, or complete all the same.
            if let Ok(cut) = read(&bytes[..length]) {
                assert!(
                    whole.as_ref().is_some_and(|whole| whole.picture == cut.picture),
                    "{length} of {}",
                    bytes.len()
                );
            }
        }
        for _ in 0..400 {
            let mut damaged = bytes.clone();
            for _ in 0..=random.below(4) {
                let at = random.below(damaged.len() as u64) as usize;
                damaged[at] = if random.below(3) == 0 { 0xff } else { random.below(256) as u8 };
            }
            let _ = read(&damaged);
        }
    }
}
