//! PNG files: 1, 2, 4, 8 or 16 bits are read, 8 bits written.

use std::io::{BufRead, Seek, Write};
use std::path::Path;

use rayon::prelude::*;

use super::codes::{collect_pixels, colours_of, decode_table, name_channels};
use super::decoded::Decoded;
use super::orientation::Orientation;
use super::png_words::colour_words;
use super::statement::{Purpose, Statement, Wishes};
use super::{Picture, PictureError, check_size, linear_to_srgb8};
use roughxel_utilities::output::OutputFile;

/// Reads a PNG; grey becomes three equal channels, alpha is ignored.
///
/// Range of the pixels: 0…1; code / (2^bits − 1), for light by the curve of the file, rounded to float32 once. An animation gives its default
/// image.
///
/// # Errors
/// A file that is truncated or damaged, or that is larger than [`MAX_EDGE`](super::MAX_EDGE) or [`MAX_PIXELS`](super::MAX_PIXELS).
pub(super) fn read(
    path: &Path,
    file: impl BufRead + Seek,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<Decoded, PictureError> {
    let damaged = |reason: png::DecodingError| PictureError::damaged(path, "PNG", reason);
    let mut decoder = png::Decoder::new(file);
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

    let mut statement = Statement::default();
    let colours = colour_words(reader.info()).decide(purpose, wishes, &mut statement);
    let channels = frame.color_type.samples();
    name_channels(channels, &mut statement);
    let orientation = reader.info().exif_metadata.as_ref().and_then(|exif| Orientation::from_exif(exif));
    if let Some(turned) = orientation.filter(|orientation| *orientation != Orientation::UPRIGHT) {
        statement.ignored.push(format!("eXIf {turned}: pixels stand as they are stored"));
    }
    let largest_code = if frame.bit_depth == png::BitDepth::Sixteen { 65535 } else { 255 };
    let table = decode_table(largest_code, colours.transfer);
    let mut pixels = if largest_code == 65535 {
        let sample = |pixel: &[u8], index: usize| {
            table[usize::from(u16::from_be_bytes([pixel[2 * index], pixel[2 * index + 1]]))]
        };
        collect_pixels(&bytes, 2 * channels, channels, sample)
    } else {
        collect_pixels(&bytes, channels, channels, |pixel, index| table[usize::from(pixel[index])])
    };
    colours.convert(&mut pixels);
    let channels = colours_of(channels);
    Ok(Decoded { picture: Picture { width, height, pixels }, statement, largest_code: Some(largest_code), channels })
}

/// Writes an 8-bit sRGB PNG of linear light, each value by [`linear_to_srgb8`].
///
/// The file appears complete or not at all: it is written next to `path` and renamed.
///
/// # Errors
/// A directory that is missing or read-only, a full disk, a picture without pixels or not `width · height` of them.
pub fn write_png_srgb(path: &Path, picture: &Picture) -> Result<(), PictureError> {
    write_png_codes(path, [picture.width, picture.height], &srgb_codes(&picture.pixels, |pixel| *pixel))
}

/// sRGB codes of each channel of `pixels`, by [`linear_to_srgb8`] of the result of `linear`. Each code goes to its own place: nothing is
/// held in addition to the codes.
pub fn srgb_codes<T: Sync>(pixels: &[T], linear: impl Fn(&T) -> [f32; 3] + Sync) -> Vec<u8> {
    let mut codes = vec![0; 3 * pixels.len()];
    codes.par_chunks_exact_mut(3).zip(pixels).for_each(|(codes, pixel)| {
        codes.iter_mut().zip(linear(pixel)).for_each(|(code, value)| *code = linear_to_srgb8(value));
    });
    codes
}

/// Writes a PNG of codes, three per pixel in rows from the top, as [`write_png_srgb`] does. A picture in linear light would be four
/// times as large.
///
/// # Errors
/// As [`write_png_srgb`].
pub fn write_png_codes(path: &Path, size: [u32; 2], codes: &[u8]) -> Result<(), PictureError> {
    let written = OutputFile::create(path).and_then(|mut file| {
        encode_png(&mut file, size, Samples::Srgb8(codes))?;
        file.commit()
    });
    written.map_err(|source| PictureError::write(path, source))
}

/// Samples of a PNG in rows from the top.
#[derive(Clone, Copy, Debug)]
pub enum Samples<'a> {
    /// sRGB codes, three a pixel.
    Srgb8(&'a [u8]),
    /// Data, one big-endian value of two bytes a pixel.
    Grey16(&'a [u8]),
    /// Data, three values a pixel.
    Rgb8(&'a [u8]),
}

/// Writes the picture in compressed form. It is held as a whole, for it is one chunk of the file: at most the size of the
/// samples and a thousandth.
///
/// # Errors
/// A writer that fails, or another number of samples than `size` has.
pub fn encode_png(writer: &mut dyn Write, [width, height]: [u32; 2], samples: Samples<'_>) -> std::io::Result<()> {
    let (colour, depth, bytes) = match samples {
        Samples::Srgb8(codes) | Samples::Rgb8(codes) => (png::ColorType::Rgb, png::BitDepth::Eight, codes),
        Samples::Grey16(bytes) => (png::ColorType::Grayscale, png::BitDepth::Sixteen, bytes),
    };
    let mut encoder = png::Encoder::new(writer, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    // A frame is drawn in 30 to 300 ms. Thorough compression takes 50 to 80 ms of it, this one 2 ms, and files are a
    // third larger.
    encoder.set_compression(png::Compression::Fast);
    if matches!(samples, Samples::Srgb8(_)) {
        encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()?;
    Ok(())
}
