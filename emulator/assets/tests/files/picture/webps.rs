//! WebPs of all storages.
//!
//! Written by Pillow 13.0.0 (libwebp): `lossless.webp` and `lossless_alpha.webp` (19×13, code (37 x + 11 y + 91 c) mod 256 in channel c),
//! `four_colours.webp` (19×13, the four colours in turn along diagonals), `quadrants.webp` and `lossy_alpha.webp` (37×21 at quality 95, four
//! rectangles that meet at (16, 16)). Other files are these in a container with chunks of their own.

use super::formats::{codes, read_as};
use super::words::profile;
use super::*;

const LOSSLESS: &[u8] = include_bytes!("data/lossless.webp");
const LOSSLESS_ALPHA: &[u8] = include_bytes!("data/lossless_alpha.webp");
const FOUR_COLOURS: &[u8] = include_bytes!("data/four_colours.webp");
const QUADRANTS: &[u8] = include_bytes!("data/quadrants.webp");
const LOSSY_ALPHA: &[u8] = include_bytes!("data/lossy_alpha.webp");

const COLOURS: [[i32; 3]; 4] = [[200, 100, 50], [20, 60, 240], [90, 210, 30], [240, 230, 220]];

/// A chunk, of an even number of bytes.
fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let padding = &[0][..content.len() % 2];
    [&name[..], &(content.len() as u32).to_le_bytes(), content, padding].concat()
}

/// The picture of a simple file in a container with a profile before it and EXIF behind it.
fn contained(file: &[u8], size: [u32; 2], profile: Option<&[u8]>, exif: Option<&[u8]>) -> Vec<u8> {
    let flags = if profile.is_some() { 0x20 } else { 0 } | if exif.is_some() { 0x08 } else { 0 };
    let edges = size.map(|edge| (edge - 1).to_le_bytes()).map(|bytes| [bytes[0], bytes[1], bytes[2]]).concat();
    let mut chunks = chunk(b"VP8X", &[&[flags, 0, 0, 0][..], &edges].concat());
    chunks.extend(profile.map(|profile| chunk(b"ICCP", profile)).unwrap_or_default());
    chunks.extend(&file[12..]);
    chunks.extend(exif.map(|exif| chunk(b"EXIF", exif)).unwrap_or_default());
    [b"RIFF", &(chunks.len() as u32 + 4).to_le_bytes()[..], b"WEBP", &chunks].concat()
}

/// EXIF with an orientation.
fn exif(orientation: u8) -> Vec<u8> {
    [b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0", &[orientation][..], b"\0\0\0\0\0\0\0"].concat()
}

#[test]
fn webps_of_all_storages_have_the_colours_that_were_encoded() {
    let pattern = |x: u32, y: u32| [0, 1, 2].map(|c| ((37 * x + 11 * y + 91 * c) % 256) as i32);
    let diagonals = |x: u32, y: u32| COLOURS[((x + y) % 4) as usize];
    let rectangles = |x: u32, y: u32| COLOURS[usize::from(x >= 16) + 2 * usize::from(y >= 16)];
    /// Kind, file, size, right codes, and their allowed error.
    type Webp<'a> = (&'a str, Vec<u8>, [u32; 2], &'a dyn Fn(u32, u32) -> [i32; 3], i32);
    let (small, wide) = ([19, 13], [37, 21]);
    let named = [b"Exif\0\0", &exif(1)[..]].concat();
    let table: [Webp<'_>; 12] = [
        ("lossless", LOSSLESS.to_vec(), small, &pattern, 0),
        ("lossless with alpha", LOSSLESS_ALPHA.to_vec(), small, &pattern, 0),
        ("lossless with a palette", FOUR_COLOURS.to_vec(), small, &diagonals, 0),
        ("lossy", QUADRANTS.to_vec(), wide, &rectangles, 3),
        ("lossy with alpha", LOSSY_ALPHA.to_vec(), wide, &rectangles, 3),
        ("lossless in a container", contained(LOSSLESS, small, None, None), small, &pattern, 0),
        ("lossy in a container", contained(QUADRANTS, wide, None, None), wide, &rectangles, 3),
        ("upright by EXIF", contained(QUADRANTS, wide, None, Some(&exif(1))), wide, &rectangles, 3),
        ("EXIF with the name of its segment", contained(LOSSLESS, small, None, Some(&named)), small, &pattern, 0),
        ("EXIF of no meaning", contained(LOSSLESS, small, None, Some(b"no EXIF")), small, &pattern, 0),
        ("a profile of sRGB", contained(LOSSLESS, small, Some(&profile("sRGB", 4)), None), small, &pattern, 0),
        ("bytes behind its end", [LOSSLESS, b"trailer"].concat(), small, &pattern, 0),
    ];
    for (kind, bytes, [width, height], right, allowed) in table {
        let read = read_as("a.webp", &bytes, Purpose::Data).unwrap_or_else(|error| panic!("{kind}: {error}"));
        assert_eq!((read.statement.kind.as_str(), read.statement.size), ("WebP", [width, height]), "{kind}");
        assert_eq!(read.statement.left.is_empty(), !kind.contains("alpha"), "{kind}");
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            // Chroma of lossy files is of half resolution.
            if allowed > 0 && ((14..18).contains(&x) || (14..18).contains(&y)) {
                continue;
            }
            let (found, expected) = (codes(&read, x, y), right(x, y));
            let close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= allowed);
            assert!(close, "{kind}, ({x}, {y}): {found:?} {expected:?}");
        }
        let light = read_as("a.webp", &bytes, Purpose::Colours).unwrap();
        let expected = codes(&read, 3, 2).map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32);
        assert_eq!((light.picture.pixel(3, 2), light.statement.warnings.len()), (expected, 0), "{kind}");
    }
}

#[test]
fn orientations_and_profiles_of_webps_count() {
    // Corner of the stored picture that stands top left, for each orientation (TIFF 6.0, tag 274).
    let (right, bottom) = (18, 12);
    let corners = [(0, 0), (right, 0), (right, bottom), (0, bottom), (0, 0), (0, bottom), (right, bottom), (right, 0)];
    let stored = read_as("a.webp", LOSSLESS, Purpose::Data).unwrap();
    for (orientation, (x, y)) in (1..).zip(corners) {
        let bytes = contained(LOSSLESS, [19, 13], None, Some(&exif(orientation)));
        let read = read_as("a.webp", &bytes, Purpose::Data).unwrap();
        assert_eq!(read.statement.size, if orientation < 5 { [19, 13] } else { [13, 19] });
        assert_eq!(codes(&read, 0, 0), codes(&stored, x, y), "{orientation}");
        assert_eq!(read.statement.notes.is_empty(), orientation == 1);
    }
    // Green of the first pixel, (0, 91, 182).
    let srgb = srgb_to_linear(91.0 / 255.0);
    for (name, expected, warnings) in [
        ("Display P3", 1.0420 * srgb, 0),
        ("Adobe RGB (1998)", (91.0_f64 / 255.0).powf(563.0 / 256.0), 0),
        ("Dot Gain 20%", srgb, 1),
    ] {
        let bytes = contained(LOSSLESS, [19, 13], Some(&profile(name, 4)), None);
        let read = read_as("a.webp", &bytes, Purpose::Colours).unwrap();
        let found = f64::from(read.picture.pixel(0, 0)[1]);
        assert!((found - expected).abs() < 1e-4, "{name}: {found} {expected}");
        assert_eq!(read.statement.warnings.len(), warnings, "{name}");
    }
}
