//! TIFF: grey or RGB, 8 or 16 bits, half or float.

use std::io::{BufRead, Seek};
use std::path::Path;

use tiff::decoder::ifd::Value;
use tiff::decoder::{ChunkType, Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError};

use super::codes::{collect_pixels, colours_of, decode_table, name_channels, name_multiplied_alpha};
use super::colour::{Primaries, REC_709, Transfer};
use super::colour_words::ColourWords;
use super::decoded::Decoded;
use super::icc::profile_words;
use super::orientation::Orientation;
use super::statement::{Purpose, Statement, Wishes};
use super::{MAX_PIXELS, Picture, PictureError, check_finite, check_size};

/// Most bytes of the decoded samples: four floats a pixel.
const MAX_BYTES: usize = 16 * MAX_PIXELS as usize;
/// Tag of the transfer function, which the decoder does not name (TIFF 6.0, section 20).
const TRANSFER_FUNCTION: Tag = Tag::Unknown(301);
/// Tag of the chromaticities of white.
const WHITE_POINT: Tag = Tag::Unknown(318);
/// Tag of the chromaticities of red, green and blue.
const PRIMARIES: Tag = Tag::Unknown(319);
/// Formats that this module reads, for remedies.
const REMEDY: &str = "a TIFF in RGB or grey, of 8 or 16 bits or floats, uncompressed or by LZW or Deflate";

/// Reads the first page of a TIFF. Integers are sRGB, or as the ICC profile says; floats are linear. It is turned upright by its tag.
///
/// # Errors
/// A file that is truncated or damaged; signed integers, palettes and colours for print; compression by CCITT or JPEG; a picture larger than
/// [`MAX_EDGE`](super::MAX_EDGE) or [`MAX_PIXELS`]; a float that is not finite.
pub(super) fn read(
    path: &Path,
    file: impl BufRead + Seek,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<Decoded, PictureError> {
    let unsupported = |reason: String| PictureError::unsupported(path, format!("{reason}, which is not read"), REMEDY);
    let failed = |error: TiffError| match error {
        TiffError::UnsupportedError(reason) => {
            PictureError::unsupported(path, format!("is a TIFF of a kind that is not read: {reason}"), REMEDY)
        }
        error => PictureError::damaged(path, "TIFF", error),
    };
    let mut limits = Limits::default();
    (limits.decoding_buffer_size, limits.intermediate_buffer_size) = (MAX_BYTES, MAX_BYTES);
    let mut decoder = Decoder::new(file).map_err(failed)?.with_limits(limits);
    let (width, height) = decoder.dimensions().map_err(failed)?;
    let (width, height) = check_size(path, width.into(), height.into())?;
    let kind = decoder.colortype().map_err(failed)?;
    let (channels, bits) = match kind {
        ColorType::Gray(bits) => (1, bits),
        // The decoder calls grey with another channel so.
        ColorType::GrayA(bits) | ColorType::Multiband { bit_depth: bits, num_samples: 2 } => (2, bits),
        ColorType::RGB(bits) => (3, bits),
        ColorType::RGBA(bits) => (4, bits),
        ColorType::CMYK(_) | ColorType::CMYKA(_) => return Err(unsupported("is a TIFF in colours for print".into())),
        other => return Err(unsupported(format!("is a TIFF with channels {other:?}"))),
    };
    let tag = |decoder: &mut Decoder<_>, tag| decoder.find_tag_unsigned::<u16>(tag).map_err(failed);
    // The decoder looks for tiles of further planes below the picture.
    if decoder.get_chunk_type() == ChunkType::Tile
        && channels > 1
        && tag(&mut decoder, Tag::PlanarConfiguration)? == Some(2)
    {
        return Err(unsupported("is a TIFF with tiles for each channel".into()));
    }
    // The decoder takes the bits as they are.
    if tag(&mut decoder, Tag::FillOrder)? == Some(2) {
        return Err(unsupported("is a TIFF with the bits of each byte in reverse (FillOrder 2)".into()));
    }
    let orientation = tag(&mut decoder, Tag::Orientation)?.and_then(Orientation::from_tag);
    let orientation = orientation.unwrap_or(Orientation::UPRIGHT);
    let mut statement = Statement::default();
    name_channels(channels, &mut statement);
    let others = decoder.find_tag_unsigned_vec::<u16>(Tag::ExtraSamples).map_err(failed)?;
    if channels.is_multiple_of(2) && others.is_some_and(|others| others.first() == Some(&1)) {
        name_multiplied_alpha(&mut statement);
    }
    let mut words = ColourWords::new(Transfer::Srgb);
    if let Some(primaries) = chromaticities(&mut decoder).map_err(failed)? {
        words.space = Some((format!("PrimaryChromaticities of {}", primaries.name()), primaries));
    }
    if decoder.find_tag(TRANSFER_FUNCTION).map_err(failed)?.is_some() {
        statement.ignored.push("TransferFunction: `transfer` of the scene can give one".to_owned());
    }
    if let Some(profile) = decoder.find_tag(Tag::IccProfile).map_err(failed)? {
        let profile = profile.into_u8_vec().map_err(failed)?;
        profile_words(&profile, "ICC profile", &mut words);
    }
    let mut samples = DecodingResult::U8(Vec::new());
    let layout = decoder.read_image_to_buffer(&mut samples).map_err(failed)?;
    if layout.planes > 1 {
        samples = interleaved(samples, channels);
    }
    if decoder.more_images() {
        statement.ignored.push("further pages: the first is taken".to_owned());
    }
    let count = width as usize * height as usize * channels;
    let (floats, largest_code) = match &samples {
        DecodingResult::U8(codes) if bits == 8 && codes.len() == count => (None, Some(255)),
        DecodingResult::U16(codes) if bits == 16 && codes.len() == count => (None, Some(65535)),
        DecodingResult::F16(values) => (Some(values.iter().map(|value| value.to_f32()).collect()), None),
        DecodingResult::F32(values) => (Some(values.clone()), None),
        DecodingResult::F64(values) => (Some(values.iter().map(|value| *value as f32).collect()), None),
        _ => return Err(unsupported(format!("is a TIFF with integers of {bits} bits"))),
    };
    words.default = if floats.is_some() { Transfer::Linear } else { Transfer::Srgb };
    let colours = words.decide(purpose, wishes, &mut statement);
    let pixels = if let Some(floats) = floats {
        let floats: Vec<f32> = floats;
        if floats.len() != count {
            return Err(PictureError::damaged(path, "TIFF", "it has samples for another size"));
        }
        let mut pixels = collect_pixels(&floats, channels, channels, |pixel, index| pixel[index]);
        check_finite(path, &pixels, width)?;
        colours.decode_floats(&mut pixels);
        pixels
    } else {
        let table = decode_table(largest_code.unwrap_or(0), colours.transfer);
        let mut pixels = match &samples {
            DecodingResult::U8(codes) => collect_pixels(codes, channels, channels, |p, i| table[usize::from(p[i])]),
            DecodingResult::U16(codes) => collect_pixels(codes, channels, channels, |p, i| table[usize::from(p[i])]),
            _ => Vec::new(),
        };
        colours.convert(&mut pixels);
        pixels
    };
    if orientation != Orientation::UPRIGHT {
        statement.notes.push(format!("{orientation}: the picture is turned upright"));
    }
    let picture = orientation.apply(Picture { width, height, pixels });
    Ok(Decoded { picture, statement, largest_code, channels: colours_of(channels) })
}

/// Primaries of the tags, under D65 if the file has no white; `None` if it has no six numbers for them.
fn chromaticities(decoder: &mut Decoder<impl BufRead + Seek>) -> Result<Option<Primaries>, TiffError> {
    let mut numbers = |tag| -> Result<Vec<f64>, TiffError> {
        let Some(Value::List(list)) = decoder.find_tag(tag)? else { return Ok(Vec::new()) };
        let number = |value: &Value| match value {
            Value::Rational(above, below) if *below > 0 => Some(f64::from(*above) / f64::from(*below)),
            Value::Float(number) => Some(f64::from(*number)).filter(|number| number.is_finite()),
            _ => None,
        };
        Ok(list.iter().map(number).collect::<Option<_>>().unwrap_or_default())
    };
    let (colours, white) = (numbers(PRIMARIES)?, numbers(WHITE_POINT)?);
    let white = white.try_into().unwrap_or(REC_709.white);
    Ok(colours.as_chunks::<2>().0.try_into().ok().map(|colours| Primaries { colours, white }))
}

/// Samples of planes, one behind the other, in the order of pixels. Types that are refused stay as they are.
fn interleaved(samples: DecodingResult, channels: usize) -> DecodingResult {
    fn of<T: Copy>(planes: &[T], channels: usize) -> Vec<T> {
        let size = planes.len() / channels;
        (0..size).flat_map(|pixel| (0..channels).map(move |channel| planes[channel * size + pixel])).collect()
    }
    match samples {
        DecodingResult::U8(planes) => DecodingResult::U8(of(&planes, channels)),
        DecodingResult::U16(planes) => DecodingResult::U16(of(&planes, channels)),
        DecodingResult::F16(planes) => DecodingResult::F16(of(&planes, channels)),
        DecodingResult::F32(planes) => DecodingResult::F32(of(&planes, channels)),
        DecodingResult::F64(planes) => DecodingResult::F64(of(&planes, channels)),
        others => others,
    }
}
