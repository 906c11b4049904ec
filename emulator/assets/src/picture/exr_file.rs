//! EXR: RGB or one channel, half or float.

use std::io::{BufRead, Seek};
use std::path::Path;

use exr::block::lines::LineRef;
use exr::block::reader::ChunksReader;
use exr::compression::Compression;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::f16;

use super::colour::{ColourWords, Transfer};
use super::statement::{PictureFile, Purpose, Statement, Wishes};
use super::{Picture, PictureError, check_size};

/// Longest block (a tile, or some rows) of an EXR file, uncompressed, in bytes.
const MAX_BLOCK_BYTES: usize = 1 << 30;

/// Reads an OpenEXR picture; one channel becomes three equal ones, alpha is ignored, negative values become 0.
///
/// Takes the first layer with channels R, G and B, a Y, or a single channel, at full resolution. The picture is the data window of that layer.
/// Values are linear light in any units; negative values (ringing of resampling filters) are no light.
///
/// # Errors
/// A file that cannot be opened, is no EXR, is truncated or damaged; deep, subsampled, integer or B44-compressed data; a picture larger than
/// [`MAX_EDGE`](super::MAX_EDGE) or [`MAX_PIXELS`](super::MAX_PIXELS); a pixel that is NaN, infinite or missing (reported as NaN).
pub(super) fn read(
    path: &Path,
    file: impl BufRead + Seek,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<PictureFile, PictureError> {
    let damaged = |reason: exr::error::Error| PictureError::damaged(path, "EXR", reason);
    let reader = exr::block::read(file, false).map_err(damaged)?;
    for header in reader.headers() {
        check_exr_header(path, header)?;
    }
    let (layer, channels) = reader
        .headers()
        .iter()
        .enumerate()
        .find_map(|(layer, header)| Some((layer, colour_channels(header)?)))
        .ok_or_else(|| {
            PictureError::unsupported(path, "has neither R, G and B channels nor a single one", "an RGB picture")
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
            // A block with a false position is skipped; its pixels stay missing.
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
                let (path, x, y) = (path.display(), index % width, index / width);
                let message = format!("`{path}` has the value {value} at pixel ({x}, {y}), counted from the top left");
                return Err(PictureError::new(message, "clamp it to finite values"));
            }
            *value = value.max(0.0);
        }
    }
    let mut statement = Statement::default();
    let words = ColourWords { space: None, transfer: None, default: Transfer::Linear };
    words.decide(purpose, wishes, &mut statement).convert(&mut pixels);
    Ok(PictureFile { picture: Picture { width: width as u32, height: height as u32, pixels }, statement })
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

/// Limits of size and kind for every layer, as all block tables are read.
fn check_exr_header(path: &Path, header: &Header) -> Result<(), PictureError> {
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    check_size(path, width as u64, height as u64)?;
    if width == 0 || height == 0 {
        return Err(PictureError::damaged(path, "EXR", "a layer has no pixels"));
    }
    let remedy = "a flat half-float RGB picture in scan lines";
    let unsupported = |reason| PictureError::unsupported(path, reason, remedy);
    if header.deep {
        return Err(unsupported("holds deep data"));
    }
    // The decoder's B44 overflows on damaged blocks. Every other compression returns errors for all of 10⁵ damaged
    // files of each kind.
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

/// Checks that the channels are full-resolution floats, as colours must be.
fn check_exr_channels(path: &Path, header: &Header, channels: [usize; 3]) -> Result<(), PictureError> {
    let list = &header.channels.list;
    let subsampled = list.iter().any(|channel| channel.sampling != exr::math::Vec2(1, 1));
    let integer = channels.iter().any(|channel| list[*channel].sample_type == SampleType::U32);
    let reason = match (subsampled, integer) {
        (true, _) => "has subsampled channels",
        (_, true) => "has integer channels",
        _ => return Ok(()),
    };
    Err(PictureError::unsupported(path, reason, "half-float R, G, B at full resolution"))
}
