//! JPEG: 8-bit grey or colours, baseline or progressive.

use std::io::{BufRead, Read as _, Seek};
use std::path::Path;

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::codes::Codes8;
use super::decoded::Decoded;
use super::jpeg_words::{JPEG_LS, JpegColours, JpegWords};
use super::orientation::Orientation;
use super::statement::{Purpose, Wishes};
use super::{MAX_EDGE, PictureError, check_size};

/// Largest file in bytes: those of the largest picture without any compression, and as many again.
const MAX_BYTES: u64 = 1 << 29;

/// Reads a JPEG: sRGB, or as its ICC profile says; turned upright by its EXIF orientation.
///
/// # Errors
/// A file that is truncated or damaged; colours for print (CMYK, YCCK); samples of more than 8 bits; lossless or arithmetic coding; a picture
/// larger than [`MAX_EDGE`] or [`MAX_PIXELS`](super::MAX_PIXELS).
pub(super) fn read(
    path: &Path,
    file: impl BufRead + Seek,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<Decoded, PictureError> {
    let damaged = |reason: zune_jpeg::errors::DecodeErrors| PictureError::damaged(path, "JPEG", reason);
    let missing = || PictureError::damaged(path, "JPEG", "it has no size");
    let unsupported = |what: &str, remedy: &str| {
        PictureError::unsupported(path, format!("is a JPEG {what}, which is not read"), remedy)
    };
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|source| PictureError::open(path, source))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(PictureError::new(
            format!("`{}` is longer than {MAX_BYTES} bytes", path.display()),
            "scale it down",
        ));
    }
    let words = JpegWords::read(&bytes).ok_or_else(missing)?;
    let baseline = "a baseline or progressive JPEG of 8 bits, or as PNG";
    match words.frame {
        0xc0..=0xc2 if words.bits == 8 => {}
        0xc0..=0xc2 => return Err(unsupported(&format!("of {} bits", words.bits), baseline)),
        JPEG_LS => return Err(unsupported("of the standard JPEG-LS", baseline)),
        0xc3 => return Err(unsupported("with lossless coding", baseline)),
        0xc9..=0xcb => return Err(unsupported("with arithmetic coding", baseline)),
        _ => return Err(unsupported("with hierarchical coding", baseline)),
    }
    // The decoder fills the end of a truncated file with the last colour.
    if !words.is_complete {
        return Err(PictureError::damaged(path, "JPEG", "it is cut off"));
    }
    let colours = words.colours();
    if colours == JpegColours::Print {
        return Err(unsupported("in colours for print (CMYK or YCCK)", "a JPEG in RGB"));
    }
    // The decoder takes any other transform for one of colours for print.
    if let Some((_, place)) = words.adobe {
        bytes[place] = 1;
    }
    // Sizes are checked below with a message of our own.
    let options = DecoderOptions::default().set_strict_mode(true);
    let options = options.set_max_width(usize::from(u16::MAX)).set_max_height(usize::from(u16::MAX));
    debug_assert!(MAX_EDGE <= u32::from(u16::MAX));
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes.as_slice()), options);
    decoder.decode_headers().map_err(damaged)?;
    let (width, height) = decoder.dimensions().ok_or_else(missing)?;
    let (width, height) = check_size(path, width as u64, height as u64)?;
    let (channels, output) = match (colours, decoder.input_colorspace()) {
        (JpegColours::Grey, _) => (1, ColorSpace::Luma),
        // Components stay as they are if the output is called as the input.
        (JpegColours::Rgb, Some(stored)) => (3, stored),
        _ => (3, ColorSpace::RGB),
    };
    decoder.set_options(options.jpeg_set_out_colorspace(output));
    let codes = decoder.decode().map_err(damaged)?;
    if codes.len() as u64 != u64::from(width) * u64::from(height) * channels as u64 {
        return Err(missing());
    }

    let codes = Codes8 { size: [width, height], channels, codes, profile: decoder.icc_profile() };
    let read = codes.decode(purpose, wishes);
    Ok(Orientation::upright(decoder.exif().map(Vec::as_slice), read))
}
