//! JPEG: 8-bit grey or colours, baseline or progressive.

use std::io::{self, BufRead, Seek};
use std::path::Path;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::codes::Codes8;
use super::decoded::Decoded;
use super::orientation::Orientation;
use super::statement::{Purpose, Wishes};
use super::{MAX_EDGE, PictureError, check_size};

/// Reads a JPEG: sRGB, or as its ICC profile says; turned upright by its EXIF orientation.
///
/// # Errors
/// A file that is truncated or damaged; colours for print (CMYK, YCCK); a picture larger than [`MAX_EDGE`] or
/// [`MAX_PIXELS`](super::MAX_PIXELS).
pub(super) fn read(
    path: &Path,
    mut file: impl BufRead + Seek,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<Decoded, PictureError> {
    let damaged = |reason: zune_jpeg::errors::DecodeErrors| PictureError::damaged(path, "JPEG", reason);
    let missing = || PictureError::damaged(path, "JPEG", "it has no size");
    // The decoder fills the end of a truncated file with the last colour.
    let unreadable = |source| PictureError::open(path, source);
    if !is_complete(&mut file).map_err(unreadable)? {
        return Err(PictureError::damaged(path, "JPEG", "it is cut off"));
    }
    file.rewind().map_err(unreadable)?;
    // Sizes are checked below with a message of our own.
    let options = DecoderOptions::default().set_strict_mode(true);
    let options = options.set_max_width(usize::from(u16::MAX)).set_max_height(usize::from(u16::MAX));
    debug_assert!(MAX_EDGE <= u32::from(u16::MAX));
    let mut decoder = JpegDecoder::new_with_options(file, options);
    decoder.decode_headers().map_err(damaged)?;
    let (width, height) = decoder.dimensions().ok_or_else(missing)?;
    let (width, height) = check_size(path, width as u64, height as u64)?;
    let stored = decoder.input_colorspace();
    let channels = match stored {
        Some(ColorSpace::Luma) => 1,
        Some(ColorSpace::YCbCr | ColorSpace::RGB) => 3,
        _ => {
            let reason = "is a JPEG in colours for print (CMYK or YCCK), which are not read";
            return Err(PictureError::unsupported(path, reason, "a JPEG in RGB"));
        }
    };
    decoder.set_options(options.jpeg_set_out_colorspace(if channels == 1 {
        ColorSpace::Luma
    } else {
        ColorSpace::RGB
    }));
    let codes = decoder.decode().map_err(damaged)?;
    if codes.len() as u64 != u64::from(width) * u64::from(height) * channels as u64 {
        return Err(missing());
    }

    let codes = Codes8 { size: [width, height], channels, codes, profile: decoder.icc_profile() };
    let mut read = codes.decode(purpose, wishes);
    let orientation = decoder.exif().and_then(|exif| Orientation::from_exif(exif)).unwrap_or(Orientation::UPRIGHT);
    if orientation != Orientation::UPRIGHT {
        read.statement.notes.push(format!("EXIF {orientation}: the picture is turned upright"));
    }
    read.picture = orientation.apply(read.picture);
    Ok(read)
}

/// True if the mark for the end of the picture follows the last mark for the start of a scan. Scans hold neither.
fn is_complete(file: &mut impl BufRead) -> io::Result<bool> {
    let (mut last, mut is_complete) = (0, false);
    loop {
        let bytes = file.fill_buf()?;
        if bytes.is_empty() {
            return Ok(is_complete);
        }
        for &byte in bytes {
            match [last, byte] {
                [0xff, 0xda] => is_complete = false,
                [0xff, 0xd9] => is_complete = true,
                _ => {}
            }
            last = byte;
        }
        let count = bytes.len();
        file.consume(count);
    }
}
