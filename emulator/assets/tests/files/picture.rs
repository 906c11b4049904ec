//! Pictures in all kinds of files, intact and damaged.

use std::io;
use std::path::{Path, PathBuf};

use exr::compression::Compression;
use exr::prelude::{Encoding as ExrEncoding, WritableImage, f16};
use png::{BitDepth, ColorType};

use roughxel_assets::Picture;
use roughxel_assets::picture::*;
use roughxel_utilities::random::SplitMix64;

mod colours;
pub(super) mod containers;
mod formats;
mod jpegs;
mod layers;
mod normals;
mod profiles;
mod refused;
mod textures;
mod tiffs;
mod transfers;
mod webps;
mod words;

type TestResult = Result<(), Box<dyn std::error::Error>>;

/// The picture of a file of colours.
fn read_colours(path: &Path) -> Result<Picture, PictureError> {
    read(path, Purpose::Colours, &Wishes::default()).map(|read| read.picture)
}

/// The numbers of a data map.
fn read_data(path: &Path) -> Result<Picture, PictureError> {
    read(path, Purpose::Data, &Wishes::default()).map(|read| read.picture)
}

/// True if the result is an error whose message has this part.
fn fails<T>(result: Result<T, PictureError>, part: &str) -> bool {
    result.is_err_and(|error| error.to_string().contains(part))
}

/// Writes packed samples as a PNG and returns its bytes.
fn png_bytes(
    (width, height): (u32, u32),
    color: ColorType,
    depth: BitDepth,
    palette: Option<&[u8]>,
    samples: &[u8],
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if let Some(palette) = palette {
        encoder.set_palette(palette);
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(samples)?;
    writer.finish()?;
    Ok(bytes)
}

struct Directory(tempfile::TempDir);

impl Directory {
    fn new() -> io::Result<Self> {
        tempfile::tempdir().map(Self)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, bytes: &[u8]) -> io::Result<PathBuf> {
        let path = self.path(name);
        std::fs::write(&path, bytes)?;
        Ok(path)
    }
}

/// EXR bytes of channels with float samples.
fn exr_bytes(width: usize, channels: &[(&str, Vec<f32>)], encoding: ExrEncoding) -> Result<Vec<u8>, exr::error::Error> {
    use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, Layer, LayerAttributes};
    let height = channels[0].1.len() / width;
    let list = channels
        .iter()
        .map(|(name, samples)| {
            let half = samples.iter().map(|value| f16::from_f32(*value)).collect();
            AnyChannel::new(*name, FlatSamples::F16(half))
        })
        .collect();
    let layer = Layer::new((width, height), LayerAttributes::named("layer"), encoding, AnyChannels::sort(list));
    let mut bytes = io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

#[test]
fn pngs_of_all_depths_and_kinds_give_their_values() -> TestResult {
    use BitDepth::{Eight, Four, One, Sixteen, Two};
    use ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
    let directory = Directory::new()?;
    let palette: &[u8] = &[0, 0, 0, 255, 51, 0];
    type Case<'a> = (ColorType, BitDepth, Option<&'a [u8]>, &'a [u8], [[f32; 3]; 2]);
    let cases: [Case<'_>; 9] = [
        (Grayscale, One, None, &[0b0100_0000], [[0.0; 3], [1.0; 3]]),
        (Grayscale, Two, None, &[0b0110_0000], [[1.0 / 3.0; 3], [2.0 / 3.0; 3]]),
        (Grayscale, Four, None, &[0x3f], [[0.2; 3], [1.0; 3]]),
        (Grayscale, Eight, None, &[51, 255], [[0.2; 3], [1.0; 3]]),
        (Grayscale, Sixteen, None, &[0x33, 0x33, 0, 1], [[0.2; 3], [1.0 / 65535.0; 3]]),
        (Rgb, Eight, None, &[255, 0, 51, 1, 2, 3], [[1.0, 0.0, 0.2], [1.0 / 255.0, 2.0 / 255.0, 3.0 / 255.0]]),
        (Rgba, Eight, None, &[255, 0, 51, 0, 0, 0, 0, 9], [[1.0, 0.0, 0.2], [0.0; 3]]),
        (GrayscaleAlpha, Eight, None, &[51, 0, 255, 7], [[0.2; 3], [1.0; 3]]),
        (Indexed, One, Some(palette), &[0b1000_0000], [[1.0, 0.2, 0.0], [0.0; 3]]),
    ];
    for (color, depth, palette, samples, expected) in cases {
        let bytes = png_bytes((2, 1), color, depth, palette, samples)?;
        let picture = read_data(&directory.file("a.png", &bytes)?)?;
        assert_eq!((picture.width, picture.height), (2, 1));
        assert_eq!(picture.pixels, expected, "{color:?} {depth:?}");
    }
    Ok(())
}

#[test]
fn the_srgb_curve_agrees_with_its_definition_at_every_16_bit_code() {
    for code in 0..=65535 {
        let x = f64::from(code) / 65535.0;
        let expected = if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) };
        let error = (srgb_to_linear(x) - expected).abs();
        // A last bit of each pow.
        assert!(error <= expected * 5.0 * f64::EPSILON, "{code}: {error}");
    }
    assert_eq!(srgb_to_linear(1.0), 1.0);
    assert_eq!(srgb_to_linear(-1.0), 0.0);
}

#[test]
fn writing_and_reading_returns_every_8_bit_code() -> TestResult {
    let directory = Directory::new()?;
    let path = directory.path("codes.png");
    let value = |code| srgb_to_linear(f64::from(code) / 255.0) as f32;
    let picture = Picture { width: 16, height: 16, pixels: (0..256).map(|code| [value(code); 3]).collect() };
    write_png_srgb(&path, &picture)?;
    assert_eq!(read_colours(&path)?, picture);
    // An existing file is replaced, and nothing else is left in the directory.
    write_png_srgb(&path, &picture)?;
    assert_eq!(std::fs::read_dir(directory.0.path())?.count(), 1);
    Ok(())
}

#[test]
fn codes_round_to_nearest_on_the_srgb_scale_and_clamp() {
    for code in 0..255_u8 {
        let middle = srgb_to_linear((f64::from(code) + 0.5) / 255.0) as f32;
        assert_eq!(linear_to_srgb8(middle * (1.0 - 1e-6)), code);
        assert_eq!(linear_to_srgb8(middle * (1.0 + 1e-6)), code + 1);
    }
    // Values next to every half-way point, and next to every part of the look-up.
    let half_way: Vec<f64> = (0..255).map(|code| srgb_to_linear((f64::from(code) + 0.5) / 255.0)).collect();
    let parts = (0..=4096).map(|part| part as f32 / 4096.0);
    for value in half_way.iter().map(|&middle| middle as f32).chain(parts) {
        for value in [value.next_down(), value, value.next_up()] {
            let code = half_way.iter().filter(|&&middle| middle <= f64::from(value)).count();
            assert_eq!(usize::from(linear_to_srgb8(value)), code, "{value}");
        }
    }
    assert_eq!(linear_to_srgb8(-1.0), 0);
    assert_eq!(linear_to_srgb8(f32::NAN), 0);
    assert_eq!(linear_to_srgb8(f32::INFINITY), 255);
}

#[test]
fn exrs_of_all_kinds_give_their_values() -> TestResult {
    use exr::prelude::{Blocks, LineOrder, Vec2};
    let directory = Directory::new()?;
    let ramp = |offset: usize| (0..35).map(|i| (i + offset) as f32 / 4.0).collect::<Vec<_>>();
    let rgba = [("A", ramp(9)), ("B", ramp(2)), ("G", ramp(1)), ("R", ramp(0))];
    let grey = [("Y", ramp(3))];
    let depth = [("height", ramp(3))];
    for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(4, 3))] {
        for compression in [Compression::Uncompressed, Compression::RLE, Compression::ZIP16, Compression::PIZ] {
            let encoding = ExrEncoding { compression, blocks, line_order: LineOrder::Increasing };
            let path = directory.file("a.exr", &exr_bytes(7, &rgba, encoding)?)?;
            let picture = read_colours(&path)?;
            assert_eq!((picture.width, picture.height), (7, 5));
            for (i, pixel) in picture.pixels.iter().enumerate() {
                assert_eq!(*pixel, [0, 1, 2].map(|c| (i + c) as f32 / 4.0));
            }
            for single in [&grey, &depth] {
                let path = directory.file("a.exr", &exr_bytes(7, single, encoding)?)?;
                assert_eq!(read_colours(&path)?.pixel(6, 4), [37.0 / 4.0; 3]);
            }
        }
    }
    Ok(())
}

#[test]
fn negative_exr_pixels_keep_their_sign_and_infinite_ones_are_refused() -> TestResult {
    let directory = Directory::new()?;
    let write = |value| {
        let bytes = exr_bytes(2, &[("Y", vec![1.0, value])], ExrEncoding::default())?;
        Ok::<_, Box<dyn std::error::Error>>(directory.file("a.exr", &bytes)?)
    };
    assert_eq!(read_colours(&write(-0.5)?)?.pixel(1, 0), [-0.5; 3]);
    assert_eq!(read_data(&write(-0.5)?)?.pixel(1, 0), [-0.5; 3]);
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert!(fails(read_colours(&write(value)?), &format!("has the value {value} at pixel (1, 0)")));
    }
    Ok(())
}

#[test]
fn exrs_without_a_colour_or_by_b44_are_refused() -> TestResult {
    let directory = Directory::new()?;
    use exr::prelude::{Blocks, LineOrder};
    let b44 =
        ExrEncoding { compression: Compression::B44, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let grey = exr_bytes(2, &[("Y", vec![0.0; 4])], b44)?;
    assert!(fails(
        read_colours(&directory.file("a.exr", &grey)?),
        "is compressed by B44, which is not read; export it as"
    ));
    let channels = [("U", vec![0.0; 4]), ("V", vec![0.0; 4])];
    let path = directory.file("a.exr", &exr_bytes(2, &channels, ExrEncoding::default())?)?;
    assert!(fails(read_colours(&path), "has no channels R, G, B or Y; its channels are: U, V (no layer)"));
    Ok(())
}

#[test]
fn missing_files_and_directories_are_named() {
    let path = Path::new("/no such directory/a.png");
    let picture = Picture::filled(1, 1, [0.0; 3]);
    for result in [read_colours(path).map(|_| ()), write_png_srgb(path, &picture)] {
        let message = result.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(message.contains("/no such directory/a.png") && message.contains("check"));
    }
}

#[test]
fn pictures_that_cannot_be_encoded_leave_no_file() -> TestResult {
    let directory = Directory::new()?;
    let path = directory.path("a.png");
    let mut short = Picture::filled(4, 4, [0.5; 3]);
    short.pixels.pop();
    for picture in [beside(&[]), short] {
        assert!(fails(write_png_srgb(&path, &picture), "cannot write picture"));
    }
    assert_eq!(std::fs::read_dir(directory.0.path())?.count(), 0);
    Ok(())
}

#[test]
fn sizes_beyond_the_limits_are_refused_from_the_header() -> TestResult {
    let directory = Directory::new()?;
    for (width, height) in [(16385_u32, 1_u32), (1, 20000), (16384, 4097), (u32::MAX >> 1, 3)] {
        let mut bytes = Vec::new();
        // A header alone.
        png::Encoder::new(&mut bytes, width, height).write_header()?;
        let error = read_data(&directory.file("a.png", &bytes)?);
        assert!(fails(error, &format!("has {width}×{height} pixels; at most 16384 an edge")));
    }
    let line = vec![0.5; 16385];
    let bytes = exr_bytes(16385, &[("Y", line)], ExrEncoding::default())?;
    assert!(fails(read_colours(&directory.file("a.exr", &bytes)?), "has 16385×1 pixels; at most 16384 an edge"));
    Ok(())
}

#[test]
fn truncated_files_are_errors_at_every_length() -> TestResult {
    let directory = Directory::new()?;
    let samples: Vec<u8> = (0..27 * 9).map(|i| (i * 31 % 251) as u8).collect();
    let png = png_bytes((9, 9), ColorType::Rgb, BitDepth::Eight, None, &samples)?;
    // The last 12 bytes are the IEND chunk, the previous 4 the CRC of the pixels: all pixels are there without them.
    for length in 0..png.len() - 16 {
        let path = directory.file("a.png", &png[..length])?;
        assert!(read_colours(&path).is_err(), "{length}");
    }
    let ramp = (0..81).map(|i| (i * 37 % 83) as f32).collect();
    let exr = exr_bytes(9, &[("Y", ramp)], ExrEncoding::SMALL_LOSSLESS)?;
    for length in 0..exr.len() {
        let path = directory.file("a.exr", &exr[..length])?;
        assert!(read_colours(&path).is_err(), "{length}");
    }
    Ok(())
}

#[test]
fn damaged_files_never_panic() -> TestResult {
    use exr::prelude::{Blocks, LineOrder, Vec2};
    let directory = Directory::new()?;
    let samples: Vec<u8> = (0..27 * 9).map(|i| (i * 31 % 251) as u8).collect();
    let ramp: Vec<f32> = (0..81).map(|i| (i * 37 % 83) as f32).collect();
    let mut files = vec![png_bytes((9, 9), ColorType::Rgb, BitDepth::Eight, None, &samples)?];
    for (compression, blocks) in [
        (Compression::Uncompressed, Blocks::ScanLines),
        (Compression::RLE, Blocks::Tiles(Vec2(4, 4))),
        (Compression::ZIP16, Blocks::ScanLines),
        (Compression::PIZ, Blocks::Tiles(Vec2(8, 8))),
        (Compression::PXR24, Blocks::ScanLines),
        (Compression::DWAA(Some(45.0)), Blocks::ScanLines),
    ] {
        let encoding = ExrEncoding { compression, blocks, line_order: LineOrder::Increasing };
        let channels = [("B", ramp.clone()), ("G", ramp.clone()), ("R", ramp.clone())];
        files.push(exr_bytes(9, &channels, encoding)?);
    }
    let mut random = SplitMix64::new(1);
    let mut random = |below: usize| random.below(below as u64) as usize;
    for bytes in &files {
        for _ in 0..400 {
            let mut damaged = bytes.clone();
            for _ in 0..=random(4) {
                let index = random(damaged.len());
                damaged[index] = match random(3) {
                    0 => damaged[index] ^ (1 << random(8)),
                    1 => 0xff,
                    _ => random(256) as u8,
                };
            }
            let path = directory.file("a", &damaged)?;
            // Either result is correct; a panic fails the test.
            let _ = read_colours(&path);
        }
    }
    Ok(())
}

#[test]
fn pictures_stand_beside_each_other_with_their_tops_aligned() {
    let (red, white) = ([1.0, 0.0, 0.0], [1.0; 3]);
    let row = beside(&[&Picture::filled(2, 1, red), &Picture::filled(3, 2, white)]);
    assert_eq!((row.width, row.height), (13, 2));
    assert_eq!((row.pixel(1, 0), row.pixel(10, 0), row.pixel(12, 1)), (red, white, white));
    assert_eq!((row.pixel(0, 1), row.pixel(5, 0)), ([0.0; 3], [0.0; 3]));
}
