//! WebP: 8 bits, lossy or lossless.

use std::io::{BufRead, Seek};
use std::path::Path;

use image_webp::{DecodingError, WebPDecoder};

use super::codes::Codes8;
use super::decoded::Decoded;
use super::orientation::Orientation;
use super::statement::{Purpose, Wishes};
use super::{MAX_PIXELS, PictureError, check_size};

/// Reads a WebP: sRGB, or as its ICC profile says; turned upright by its EXIF orientation.
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

    let profile = decoder.icc_profile().map_err(damaged)?;
    let exif = decoder.exif_metadata().map_err(damaged)?;
    let read = Codes8 { size: [width, height], channels, codes, profile }.decode(purpose, wishes);
    Ok(Orientation::upright(exif.as_deref(), read))
}
