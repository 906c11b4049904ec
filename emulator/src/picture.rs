//! Pictures in host memory, and the files they come from and go to.
//!
//! PNG: 1, 2, 4, 8 or 16 bits, grey, RGB or palette. EXR: RGB or one channel, half or float, of the first layer that has
//! them. Alpha is ignored, not composited: data maps keep other things in it, and a texture has no background here.
//! Ancillary colour data (gAMA, iCCP, chromaticities) is ignored too: the caller states the [`Encoding`]. Sizes are
//! checked from the header, before memory is taken. sRGB uses the exact piecewise curve by correctly rounded
//! operations only, so the pixels are the same bits on every machine. Files are written beside their name and renamed
//! when complete.

mod compare;

pub use compare::{DIFFERENCE_GAIN, difference, ssim};

use crate::output::OutputFile;
use std::fs::File;
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use exr::block::lines::LineRef;
use exr::block::reader::ChunksReader;
use exr::compression::Compression;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::f16;

/// Longest edge of a picture that is read, in pixels.
pub const MAX_EDGE: u32 = 16384;

/// Most pixels of a picture that is read.
pub const MAX_PIXELS: u64 = 1 << 26;

/// Longest block (a tile, or some rows) of an EXR file, uncompressed, in bytes.
const MAX_BLOCK_BYTES: usize = 1 << 30;

/// A picture in linear light, or the raw values of a data map.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Red, green, blue; `width · height` of them, rows from top to bottom.
    pub pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// A picture of one colour.
    pub fn filled(width: u32, height: u32, colour: [f32; 3]) -> Self {
        Self { width, height, pixels: vec![colour; width as usize * height as usize] }
    }

    /// The pixel in column `x` and row `y` from the top.
    ///
    /// # Panics
    /// If the pixel lies outside of the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [f32; 3] {
        self.pixels[y as usize * self.width as usize + x as usize]
    }
}

/// What the numbers in a file mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Encoding {
    /// Colours by the sRGB curve, decoded to linear light.
    Srgb,
    /// Linear colours or data (heights, normals), code / (2^bits − 1).
    Linear,
}

/// Why a picture could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The file cannot be opened.
    #[error("cannot open picture `{}`: {source}; check the path and its permissions", path.display())]
    Open {
        /// File.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is damaged, cut off or of another format.
    #[error("`{}` is not a readable {format} file: {reason}; export it again as {format}", path.display())]
    Damaged {
        /// File.
        path: PathBuf,
        /// The format it was read as.
        format: &'static str,
        /// What the decoder met.
        reason: String,
    },
    /// The picture is larger than the limits.
    #[error(
        "picture `{}` has {width}×{height} pixels; at most {MAX_EDGE} an edge and {MAX_PIXELS} in all are read: scale it down",
        path.display()
    )]
    TooLarge {
        /// File.
        path: PathBuf,
        /// Width from the header, in pixels.
        width: u64,
        /// Height from the header, in pixels.
        height: u64,
    },
    /// A valid file of a kind that is not supported.
    #[error("`{}` {reason}; export it as {remedy}", path.display())]
    Unsupported {
        /// File.
        path: PathBuf,
        /// What is not supported.
        reason: String,
        /// What would be.
        remedy: &'static str,
    },
    /// A pixel that is no finite number.
    #[error(
        "`{}` has the value {value} at pixel ({x}, {y}), counted from the top left; clamp it to finite values",
        path.display()
    )]
    NotFinite {
        /// File.
        path: PathBuf,
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// NaN or an infinity.
        value: f32,
    },
    /// The file cannot be written.
    #[error(
        "cannot write picture `{}`: {source}; check that its directory exists and may be written",
        path.display()
    )]
    Write {
        /// File.
        path: PathBuf,
        /// What went wrong.
        source: std::io::Error,
    },
}

impl PictureError {
    fn damaged(path: &Path, format: &'static str, reason: impl ToString) -> Self {
        Self::Damaged { path: path.to_path_buf(), format, reason: reason.to_string() }
    }
}

fn open(path: &Path) -> Result<BufReader<File>, PictureError> {
    File::open(path).map(BufReader::new).map_err(|source| PictureError::Open { path: path.to_path_buf(), source })
}

/// Checks a size from a header against the limits.
fn check_size(path: &Path, width: u64, height: u64) -> Result<(u32, u32), PictureError> {
    let edge = |size: u64| u32::try_from(size).ok().filter(|size| *size <= MAX_EDGE);
    match (edge(width), edge(height)) {
        (Some(w), Some(h)) if width * height <= MAX_PIXELS => Ok((w, h)),
        _ => Err(PictureError::TooLarge { path: path.to_path_buf(), width, height }),
    }
}

/// Reads a PNG; grey becomes three equal channels, alpha is ignored.
///
/// Range of the pixels: 0…1; code / (2^bits − 1), by the sRGB curve if `encoding` says so, rounded to float32 once.
/// Of an animation, the default image.
///
/// # Errors
/// A file that cannot be opened, is no PNG, is cut off or damaged, or is larger than [`MAX_EDGE`] or [`MAX_PIXELS`].
pub fn read_png(path: &Path, encoding: Encoding) -> Result<Picture, PictureError> {
    let damaged = |reason: png::DecodingError| PictureError::damaged(path, "PNG", reason);
    let mut decoder = png::Decoder::new(open(path)?);
    let header = decoder.read_header_info().map_err(damaged)?;
    let (width, height) = check_size(path, header.width.into(), header.height.into())?;
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let size = reader.output_buffer_size().ok_or_else(|| damaged(png::DecodingError::LimitsExceeded))?;
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes).map_err(damaged)?;
    if (frame.width, frame.height) != (width, height) {
        let reason = "its first frame is smaller than the picture";
        return Err(PictureError::damaged(path, "PNG", reason));
    }

    let channels = frame.color_type.samples();
    let pixels = if frame.bit_depth == png::BitDepth::Sixteen {
        let table = decode_table(65535, encoding);
        let samples = |pixel: &[u8], index: usize| {
            table[usize::from(u16::from_be_bytes([pixel[2 * index], pixel[2 * index + 1]]))]
        };
        collect_pixels(&bytes, 2 * channels, channels, samples)
    } else {
        let table = decode_table(255, encoding);
        collect_pixels(&bytes, channels, channels, |pixel, index| table[usize::from(pixel[index])])
    };
    Ok(Picture { width, height, pixels })
}

/// Pixels from packed samples: channels 0, 1, 2, or channel 0 three times where there are fewer than three.
fn collect_pixels(
    bytes: &[u8],
    bytes_per_pixel: usize,
    channels: usize,
    sample: impl Fn(&[u8], usize) -> f32,
) -> Vec<[f32; 3]> {
    bytes
        .chunks_exact(bytes_per_pixel)
        .map(
            |pixel| {
                if channels >= 3 {
                    [sample(pixel, 0), sample(pixel, 1), sample(pixel, 2)]
                } else {
                    [sample(pixel, 0); 3]
                }
            },
        )
        .collect()
}

/// Value of every code 0…`largest`.
fn decode_table(largest: u32, encoding: Encoding) -> Vec<f32> {
    (0..=largest)
        .map(|code| {
            let value = f64::from(code) / f64::from(largest);
            match encoding {
                Encoding::Srgb => srgb_to_linear(value) as f32,
                Encoding::Linear => value as f32,
            }
        })
        .collect()
}

/// Linear light of an sRGB value in 0…1: x/12.92 up to 0.04045, ((x + 0.055)/1.055)^2.4 above (IEC 61966-2-1).
///
/// x^2.4 = x² · (x^⅕)², with the fifth root by Newton's method: the same bits on every machine, unlike the platform's
/// pow. Error: below 2⁻⁵⁰, relative. Values outside 0…1 count as 0 or 1.
pub fn srgb_to_linear(encoded: f64) -> f64 {
    let encoded = encoded.clamp(0.0, 1.0);
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    let x = (encoded + 0.055) / 1.055;
    // From above, 1 ≥ x^⅕ ≥ 0.61: quadratic after two steps; eight reach the last bit, measured over all 16-bit codes.
    let mut root = 1.0;
    for _ in 0..8 {
        let fourth = (root * root) * (root * root);
        root = (4.0 * root + x / fourth) / 5.0;
    }
    (x * x) * (root * root)
}

/// Linear values half-way (in sRGB) between one 8-bit code and the next.
static SRGB_THRESHOLDS: LazyLock<[f64; 255]> =
    LazyLock::new(|| std::array::from_fn(|code| srgb_to_linear((code as f64 + 0.5) / 255.0)));

/// 8-bit sRGB code of linear light, clamped to 0…1; NaN gives 0.
///
/// Rounding: to the nearest code on the sRGB scale, ties up; exact, by search among the 255 half-way points.
pub fn linear_to_srgb8(linear: f32) -> u8 {
    let linear = f64::from(linear);
    SRGB_THRESHOLDS.partition_point(|threshold| *threshold <= linear) as u8
}

/// Reads an OpenEXR picture; one channel becomes three equal ones, alpha is ignored, negative values become 0.
///
/// Takes the first layer with channels R, G and B, a Y, or a single channel, at full resolution; the picture is that
/// layer's data window. Values are linear light in any units; negative ones (ringing of resampling filters) are no light.
///
/// # Errors
/// A file that cannot be opened, is no EXR, is cut off or damaged; deep, subsampled, integer or B44-compressed data; a
/// picture larger than [`MAX_EDGE`] or [`MAX_PIXELS`]; a pixel that is NaN, infinite or missing (reported as NaN).
pub fn read_exr(path: &Path) -> Result<Picture, PictureError> {
    let damaged = |reason: exr::error::Error| PictureError::damaged(path, "EXR", reason);
    let reader = exr::block::read(open(path)?, false).map_err(damaged)?;
    for header in reader.headers() {
        check_exr_header(path, header)?;
    }
    let (layer, channels) = reader
        .headers()
        .iter()
        .enumerate()
        .find_map(|(layer, header)| Some((layer, colour_channels(header)?)))
        .ok_or_else(|| PictureError::Unsupported {
            path: path.to_path_buf(),
            reason: "has neither R, G and B channels nor a single one".to_owned(),
            remedy: "an RGB picture",
        })?;
    let header = &reader.headers()[layer];
    check_exr_channels(path, header, channels)?;
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let list = header.channels.clone();

    let chunks = reader
        .filter_chunks(false, |_, _, block| block.layer == layer && block.level == exr::math::Vec2(0, 0))
        .map_err(damaged)?;
    let mut pixels = vec![[f32::NAN; 3]; width * height];
    chunks
        .decompress_sequential(false, |_, block| {
            // A block that lies about its place is skipped; its pixels stay missing.
            if block.index.layer != layer || block.index.level != exr::math::Vec2(0, 0) {
                return Ok(());
            }
            for line in block.lines(&list) {
                let start = line.location.position.y() * width + line.location.position.x();
                let Some(row) = pixels.get_mut(start..start + line.location.sample_count) else {
                    return Err(exr::error::Error::Invalid("block outside of the layer".into()));
                };
                for (slot, channel) in channels.iter().enumerate() {
                    if *channel == line.location.channel {
                        read_line(&line, list.list[*channel].sample_type, row, slot)?;
                    }
                }
            }
            Ok(())
        })
        .map_err(damaged)?;

    for (index, pixel) in pixels.iter_mut().enumerate() {
        for value in pixel {
            if !value.is_finite() {
                return Err(PictureError::NotFinite {
                    path: path.to_path_buf(),
                    x: index % width,
                    y: index / width,
                    value: *value,
                });
            }
            *value = value.max(0.0);
        }
    }
    Ok(Picture { width: width as u32, height: height as u32, pixels })
}

/// Copies one channel of one row of a block.
fn read_line(line: &LineRef<'_>, sample_type: SampleType, row: &mut [[f32; 3]], slot: usize) -> exr::error::UnitResult {
    match sample_type {
        SampleType::F16 => {
            for (pixel, value) in row.iter_mut().zip(line.read_samples::<f16>()) {
                pixel[slot] = value?.to_f32();
            }
        }
        // Integer channels are refused before any block is read.
        SampleType::F32 | SampleType::U32 => {
            for (pixel, value) in row.iter_mut().zip(line.read_samples::<f32>()) {
                pixel[slot] = value?;
            }
        }
    }
    Ok(())
}

/// Limits of size and kind that hold for every layer, as all their block tables are read.
fn check_exr_header(path: &Path, header: &Header) -> Result<(), PictureError> {
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    check_size(path, width as u64, height as u64)?;
    if width == 0 || height == 0 {
        return Err(PictureError::damaged(path, "EXR", "a layer has no pixels"));
    }
    let unsupported = |reason: &str| PictureError::Unsupported {
        path: path.to_path_buf(),
        reason: reason.to_owned(),
        remedy: "a flat half-float RGB picture in scan lines",
    };
    if header.deep {
        return Err(unsupported("holds deep data"));
    }
    // The decoder's B44 overflows on damaged blocks; every other compression returned errors for all of
    // 10⁵ damaged files of each kind.
    if matches!(header.compression, Compression::B44 | Compression::B44A) {
        return Err(unsupported("is compressed by B44"));
    }
    let block = header.max_block_pixel_size();
    let block_bytes = block
        .width()
        .checked_mul(block.height())
        .and_then(|pixels| pixels.checked_mul(header.channels.bytes_per_pixel));
    if block_bytes.is_none_or(|bytes| bytes > MAX_BLOCK_BYTES) {
        return Err(unsupported("has blocks of more than 2^30 bytes"));
    }
    Ok(())
}

/// Indices of the channels for red, green and blue.
fn colour_channels(header: &Header) -> Option<[usize; 3]> {
    let list = &header.channels.list;
    let find = |name: &str| list.iter().position(|channel| channel.name.eq(name));
    if let (Some(r), Some(g), Some(b)) = (find("R"), find("G"), find("B")) {
        return Some([r, g, b]);
    }
    let single = find("Y").or_else(|| (list.len() == 1).then_some(0))?;
    Some([single; 3])
}

/// Only full-resolution floats can be a colour.
fn check_exr_channels(path: &Path, header: &Header, channels: [usize; 3]) -> Result<(), PictureError> {
    let list = &header.channels.list;
    let subsampled = list.iter().any(|channel| channel.sampling != exr::math::Vec2(1, 1));
    let integer = channels.iter().any(|channel| list[*channel].sample_type == SampleType::U32);
    let reason = match (subsampled, integer) {
        (true, _) => "has subsampled channels",
        (_, true) => "has integer channels",
        _ => return Ok(()),
    };
    Err(PictureError::Unsupported {
        path: path.to_path_buf(),
        reason: reason.to_owned(),
        remedy: "half-float R, G, B at full resolution",
    })
}

/// Writes an 8-bit sRGB PNG of linear light, each value by [`linear_to_srgb8`].
///
/// The file appears complete or not at all: it is written beside `path` and renamed.
///
/// # Errors
/// A directory that is missing or read-only, a full disk, a picture without pixels or not `width · height` of them.
pub fn write_png_srgb(path: &Path, picture: &Picture) -> Result<(), PictureError> {
    let written = OutputFile::create(path).and_then(|mut file| {
        encode_png(&mut file, picture)?;
        file.commit()
    });
    written.map_err(|source| PictureError::Write { path: path.to_path_buf(), source })
}

fn encode_png(writer: &mut dyn Write, picture: &Picture) -> std::io::Result<()> {
    let mut encoder = png::Encoder::new(writer, picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    let bytes: Vec<u8> = picture.pixels.iter().flatten().map(|value| linear_to_srgb8(*value)).collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(())
}

/// Pixels between two pictures of [`beside`].
const GUTTER_PX: u32 = 8;

/// The pictures in a row from left to right, tops aligned, on black, 8 pixels apart.
///
/// No picture gives one of 0×0 pixels, which cannot be written.
pub fn beside(pictures: &[&Picture]) -> Picture {
    let gutters = GUTTER_PX * pictures.len().saturating_sub(1) as u32;
    let width = pictures.iter().map(|picture| picture.width).sum::<u32>() + gutters;
    let height = pictures.iter().map(|picture| picture.height).max().unwrap_or(0);
    let mut row = Picture::filled(width, height, [0.0; 3]);
    let mut left = 0;
    for picture in pictures {
        let columns = picture.width as usize;
        for (line, pixels) in row.pixels.chunks_exact_mut(width as usize).zip(picture.pixels.chunks_exact(columns)) {
            line[left..left + columns].copy_from_slice(pixels);
        }
        left += columns + GUTTER_PX as usize;
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{Encoding as ExrEncoding, WritableImage, f16};
    use png::{BitDepth, ColorType};

    type TestResult = Result<(), Box<dyn std::error::Error>>;

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
        fn new() -> std::io::Result<Self> {
            tempfile::tempdir().map(Self)
        }

        fn path(&self, name: &str) -> PathBuf {
            self.0.path().join(name)
        }

        fn file(&self, name: &str, bytes: &[u8]) -> std::io::Result<PathBuf> {
            let path = self.path(name);
            std::fs::write(&path, bytes)?;
            Ok(path)
        }
    }

    /// EXR bytes of channels with float samples.
    fn exr_bytes(
        width: usize,
        channels: &[(&str, Vec<f32>)],
        encoding: ExrEncoding,
    ) -> Result<Vec<u8>, exr::error::Error> {
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
        let mut bytes = std::io::Cursor::new(Vec::new());
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
            let picture = read_png(&directory.file("a.png", &bytes)?, Encoding::Linear)?;
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
            // The stated 2⁻⁵⁰ and a last bit of the platform's pow.
            assert!(error <= expected * 5.0 * f64::EPSILON, "{code}: {error}");
        }
        assert_eq!(srgb_to_linear(1.0), 1.0);
        assert_eq!(srgb_to_linear(-1.0), 0.0);
    }

    #[test]
    fn writing_and_reading_returns_every_8_bit_code() -> TestResult {
        let directory = Directory::new()?;
        let path = directory.path("codes.png");
        let table = decode_table(255, Encoding::Srgb);
        let picture = Picture { width: 16, height: 16, pixels: table.iter().map(|value| [*value; 3]).collect() };
        write_png_srgb(&path, &picture)?;
        assert_eq!(read_png(&path, Encoding::Srgb)?, picture);
        // Over an existing file, too, and nothing else is left in the directory.
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
                let picture = read_exr(&path)?;
                assert_eq!((picture.width, picture.height), (7, 5));
                for (i, pixel) in picture.pixels.iter().enumerate() {
                    assert_eq!(*pixel, [0, 1, 2].map(|c| (i + c) as f32 / 4.0));
                }
                for single in [&grey, &depth] {
                    let path = directory.file("a.exr", &exr_bytes(7, single, encoding)?)?;
                    assert_eq!(read_exr(&path)?.pixel(6, 4), [37.0 / 4.0; 3]);
                }
            }
        }
        Ok(())
    }

    #[test]
    fn negative_exr_pixels_become_0_and_infinite_ones_are_refused() -> TestResult {
        let directory = Directory::new()?;
        let write = |value| {
            let bytes = exr_bytes(2, &[("Y", vec![1.0, value])], ExrEncoding::default())?;
            Ok::<_, Box<dyn std::error::Error>>(directory.file("a.exr", &bytes)?)
        };
        assert_eq!(read_exr(&write(-0.5)?)?.pixel(1, 0), [0.0; 3]);
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let error = read_exr(&write(value)?);
            assert!(matches!(error, Err(PictureError::NotFinite { x: 1, y: 0, .. })));
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
        let error = read_exr(&directory.file("a.exr", &grey)?);
        assert!(matches!(error, Err(PictureError::Unsupported { .. })));
        let channels = [("U", vec![0.0; 4]), ("V", vec![0.0; 4])];
        let path = directory.file("a.exr", &exr_bytes(2, &channels, ExrEncoding::default())?)?;
        assert!(matches!(read_exr(&path), Err(PictureError::Unsupported { .. })));
        Ok(())
    }

    #[test]
    fn missing_files_and_directories_are_named() {
        let path = Path::new("/no such directory/a.png");
        let picture = Picture::filled(1, 1, [0.0; 3]);
        for result in
            [read_png(path, Encoding::Srgb).map(|_| ()), read_exr(path).map(|_| ()), write_png_srgb(path, &picture)]
        {
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
            assert!(matches!(write_png_srgb(&path, &picture), Err(PictureError::Write { .. })));
        }
        assert_eq!(std::fs::read_dir(directory.0.path())?.count(), 0);
        Ok(())
    }

    #[test]
    fn sizes_beyond_the_limits_are_refused_from_the_header() -> TestResult {
        let directory = Directory::new()?;
        let small = png_bytes((1, 1), ColorType::Grayscale, BitDepth::Eight, None, &[7])?;
        for (width, height) in [(16385_u32, 1_u32), (1, 20000), (16384, 4097), (u32::MAX >> 1, 3)] {
            // The header chunk is not verified here: length, "IHDR", width, height, 5 bytes, CRC-32.
            let mut bytes = small.clone();
            bytes[16..20].copy_from_slice(&width.to_be_bytes());
            bytes[20..24].copy_from_slice(&height.to_be_bytes());
            let crc = crc32(&bytes[12..29]);
            bytes[29..33].copy_from_slice(&crc.to_be_bytes());
            let error = read_png(&directory.file("a.png", &bytes)?, Encoding::Linear);
            assert!(matches!(error, Err(PictureError::TooLarge { .. })), "{error:?}");
        }
        let line = vec![0.5; 16385];
        let bytes = exr_bytes(16385, &[("Y", line)], ExrEncoding::default())?;
        let error = read_exr(&directory.file("a.exr", &bytes)?);
        assert!(matches!(error, Err(PictureError::TooLarge { .. })), "{error:?}");
        Ok(())
    }

    /// CRC-32 as PNG chunks have it (reflected, 0xEDB88320).
    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1)))
        })
    }

    #[test]
    fn truncated_files_are_errors_at_every_length() -> TestResult {
        let directory = Directory::new()?;
        let samples: Vec<u8> = (0..27 * 9).map(|i| (i * 31 % 251) as u8).collect();
        let png = png_bytes((9, 9), ColorType::Rgb, BitDepth::Eight, None, &samples)?;
        // The last 12 bytes are the IEND chunk, the 4 before the CRC of the pixels: all pixels are there without them.
        for length in 0..png.len() - 16 {
            let path = directory.file("a.png", &png[..length])?;
            assert!(read_png(&path, Encoding::Srgb).is_err(), "{length}");
        }
        let ramp = (0..81).map(|i| (i * 37 % 83) as f32).collect();
        let exr = exr_bytes(9, &[("Y", ramp)], ExrEncoding::SMALL_LOSSLESS)?;
        for length in 0..exr.len() {
            let path = directory.file("a.exr", &exr[..length])?;
            assert!(read_exr(&path).is_err(), "{length}");
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
        let mut state = 1_u64;
        let mut random = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize % below
        };
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
                // Either result is fine; a panic fails the test.
                let _ = (read_png(&path, Encoding::Srgb), read_exr(&path));
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
}
