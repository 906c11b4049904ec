//! WebP: 8 bits, lossy or lossless.

use std::io::{BufRead, Seek};
use std::path::Path;

use image_webp::{DecodingError, WebPDecoder};

use super::codes::{collect_pixels, decode_table, name_channels};
use super::colour::Transfer;
use super::colour_words::ColourWords;
use super::decoded::Decoded;
use super::icc::profile_words;
use super::statement::{Purpose, Statement, Wishes};
use super::{MAX_PIXELS, Picture, PictureError, check_size};

/// Reads a WebP: sRGB, or as its ICC profile says.
///
/// # Errors
/// A file that is truncated or damaged; an animation; a picture larger than [`MAX_EDGE`](super::MAX_EDGE) or [`MAX_PIXELS`].
pub(super) fn read(
    path: &Path,
    file: impl BufRead + Seek,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<Decoded, PictureError> {
    let damaged = |reason: DecodingError| PictureError::damaged(path, "WebP", reason);
    let mut decoder = WebPDecoder::new(file).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = check_size(path, width.into(), height.into())?;
    if decoder.is_animated() {
        return Err(PictureError::unsupported(path, "is an animation, which is not read", "a WebP of one picture"));
    }
    decoder.set_memory_limit(4 * MAX_PIXELS as usize);
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let mut codes = vec![0; width as usize * height as usize * channels];
    decoder.read_image(&mut codes).map_err(damaged)?;

    let mut statement = Statement::default();
    name_channels(channels, &mut statement);
    let mut words = ColourWords { space: None, transfer: None, default: Transfer::Srgb };
    if let Some(profile) = decoder.icc_profile().map_err(damaged)? {
        profile_words(&profile, "ICC profile", &mut words, &mut statement);
    }
    let colours = words.decide(purpose, wishes, &mut statement);
    let table = decode_table(255, colours.transfer);
    let mut pixels = collect_pixels(&codes, channels, channels, |pixel, index| table[usize::from(pixel[index])]);
    colours.convert(&mut pixels);
    let picture = Picture { width, height, pixels };
    Ok(Decoded { picture, statement, largest_code: Some(255), channels: 3 })
}
