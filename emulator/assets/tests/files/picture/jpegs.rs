//! JPEGs of all storages and marks.
//!
//! Written by Pillow 13.0.0 (libjpeg-turbo) at quality 95: `restart.jpg` (4:2:0, a restart mark behind every block), `wide_chroma.jpg` (4:2:2),
//! `progressive_420.jpg`, `grey_restart.jpg` (a restart mark behind every row of blocks), `rgb_stored.jpg` (`keep_rgb`), `profile.jpg` (the sRGB
//! profile of LittleCMS). Written by imagecodecs 2026.3.6: `ycck.jpg`, `twelve_bits.jpg`, `lossless.jpg`. They are 37×21 pixels, four rectangles
//! that meet at (16, 16). Other files are these with segments of their own.

use super::formats::{RGB_JPEG, codes, read_as};
use super::words::profile;
use super::*;

const RESTART: &[u8] = include_bytes!("data/restart.jpg");
const WIDE_CHROMA: &[u8] = include_bytes!("data/wide_chroma.jpg");
const PROGRESSIVE: &[u8] = include_bytes!("data/progressive_420.jpg");
const GREY: &[u8] = include_bytes!("data/grey_restart.jpg");
const RGB_STORED: &[u8] = include_bytes!("data/rgb_stored.jpg");
const PROFILE: &[u8] = include_bytes!("data/profile.jpg");
const YCCK: &[u8] = include_bytes!("data/ycck.jpg");
const CMYK: &[u8] = include_bytes!("data/cmyk.jpg");
const TWELVE_BITS: &[u8] = include_bytes!("data/twelve_bits.jpg");
const LOSSLESS: &[u8] = include_bytes!("data/lossless.jpg");

/// Colours of the rectangles, top left, top right, bottom left, bottom right, as they were encoded.
const COLOURS: [[i32; 3]; 4] = [[200, 100, 50], [20, 60, 240], [90, 210, 30], [240, 230, 220]];
const PLACES: [[u32; 2]; 4] = [[6, 7], [29, 5], [8, 19], [36, 20]];

/// A segment with its mark and length.
fn segment(mark: u8, content: &[u8]) -> Vec<u8> {
    [&[0xff, mark][..], &(content.len() as u16 + 2).to_be_bytes(), content].concat()
}

/// The file with a segment behind its start.
fn with(file: &[u8], segment: &[u8]) -> Vec<u8> {
    [&file[..2], segment, &file[2..]].concat()
}

/// The file without its segments of a mark.
fn without(file: &[u8], mark: u8) -> Vec<u8> {
    let mut left = file.to_vec();
    while let Some(at) = left.windows(2).position(|pair| pair == [0xff, mark]) {
        let length = usize::from(u16::from_be_bytes([left[at + 2], left[at + 3]]));
        left.drain(at..at + 2 + length);
    }
    left
}

/// The file with another mark of its frame.
fn framed(file: &[u8], mark: u8) -> Vec<u8> {
    let mut bytes = file.to_vec();
    let at = bytes.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    bytes[at + 1] = mark;
    bytes
}

/// Adobe's segment with a colour transform.
fn adobe(transform: u8) -> Vec<u8> {
    segment(0xee, &[b"Adobe\0\x64\0\0\0\0", &[transform][..]].concat())
}

/// EXIF with an orientation.
fn exif(orientation: u8) -> Vec<u8> {
    let tag = [b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0", &[orientation][..], b"\0\0\0\0\0\0"].concat();
    segment(0xe1, &[b"Exif\0\0", &tag[..]].concat())
}

/// Parts of an ICC profile.
fn icc(profile: &[u8], parts: usize) -> Vec<u8> {
    let length = profile.len().div_ceil(parts);
    let part = |(index, bytes): (usize, &[u8])| {
        segment(0xe2, &[b"ICC_PROFILE\0", &[index as u8 + 1, parts as u8][..], bytes].concat())
    };
    profile.chunks(length).enumerate().flat_map(part).collect()
}

#[test]
fn jpegs_of_all_storages_have_the_colours_that_were_encoded() {
    let thumbnail = segment(0xe1, &[b"Exif\0\0MM\0*\0\0\0\x08\0\0\0\0\0\0", RGB_JPEG].concat());
    let table: [(&str, Vec<u8>); 19] = [
        ("4:2:0 with restarts", RESTART.to_vec()),
        ("4:2:2", WIDE_CHROMA.to_vec()),
        ("4:2:0, progressive", PROGRESSIVE.to_vec()),
        ("a profile of sRGB", PROFILE.to_vec()),
        ("RGB by Adobe's segment", RGB_STORED.to_vec()),
        ("RGB by the names of its components", without(RGB_STORED, 0xee)),
        ("luminance and chroma without any segment", without(WIDE_CHROMA, 0xe0)),
        ("Adobe's segment for luminance and chroma", with(&without(WIDE_CHROMA, 0xe0), &adobe(1))),
        (
            "JFIF and Adobe's segment for RGB",
            with(&with(RESTART, &adobe(0)), &segment(0xe0, b"JFIF\0\x01\x01\0\0\x01\0\x01\0\0")),
        ),
        ("Adobe's segment with an unknown transform", with(&without(RESTART, 0xe0), &adobe(7))),
        ("three components with the transform of four", with(&without(RESTART, 0xe0), &adobe(2))),
        ("a comment", with(RESTART, &segment(0xfe, b"made by hand"))),
        ("a comment with the marks of a scan and an end", with(RESTART, &segment(0xfe, b"\xff\xda\0\x02\xff\xd9"))),
        ("a thumbnail in its EXIF", with(RESTART, &thumbnail)),
        ("fill bytes before a mark", with(RESTART, b"\xff\xff\xff")),
        ("bytes behind its end", [RESTART, b"\0\0trailer \xff\xda \xff\xc0"].concat()),
        ("a second picture behind its end", [PROGRESSIVE, RGB_JPEG].concat()),
        ("EXIF that says upright", with(RESTART, &exif(1))),
        ("EXIF with an orientation of no meaning", with(RESTART, &exif(9))),
    ];
    for (kind, bytes) in table {
        let read = read_as("a.jpg", &bytes, Purpose::Data).unwrap_or_else(|error| panic!("{kind}: {error}"));
        assert_eq!((read.statement.kind.as_str(), read.statement.size), ("JPEG", [37, 21]), "{kind}");
        for ([x, y], expected) in PLACES.into_iter().zip(COLOURS) {
            let found = codes(&read, x, y);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 2), "{kind}: {found:?} {expected:?}");
        }
        let light = read_as("a.jpg", &bytes, Purpose::Colours).unwrap();
        assert_eq!(light.statement.warnings, [""; 0], "{kind}");
        let [x, y] = PLACES[1];
        assert_eq!(
            light.picture.pixel(x, y),
            codes(&read, x, y).map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32)
        );
    }
    // Grey: 0.299 R + 0.587 G + 0.114 B.
    let grey = read_as("a.jpg", GREY, Purpose::Data).unwrap();
    for ([x, y], colour) in PLACES.into_iter().zip(COLOURS) {
        let expected =
            (0.299 * f64::from(colour[0]) + 0.587 * f64::from(colour[1]) + 0.114 * f64::from(colour[2])).round();
        assert!(codes(&grey, x, y).iter().all(|code| (code - expected as i32).abs() <= 1), "{:?}", codes(&grey, x, y));
    }
    assert_eq!(grey.statement.channels, ["Y"]);
}

#[test]
fn orientations_of_exif_turn_the_picture_upright() {
    // Rectangles of the stored picture that stand top left, top right, bottom left, bottom right (TIFF 6.0, tag 274).
    let table: [(u8, [usize; 4]); 8] = [
        (1, [0, 1, 2, 3]),
        (2, [1, 0, 3, 2]),
        (3, [3, 2, 1, 0]),
        (4, [2, 3, 0, 1]),
        (5, [0, 2, 1, 3]),
        (6, [2, 0, 3, 1]),
        (7, [3, 1, 2, 0]),
        (8, [1, 3, 0, 2]),
    ];
    for (orientation, rectangles) in table {
        let read = read_as("a.jpg", &with(RESTART, &exif(orientation)), Purpose::Data).unwrap();
        let [width, height] = read.statement.size;
        assert_eq!([width, height], if orientation < 5 { [37, 21] } else { [21, 37] });
        for (place, rectangle) in
            [[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]].into_iter().zip(rectangles)
        {
            let found = codes(&read, place[0], place[1]);
            let close = found.iter().zip(COLOURS[rectangle]).all(|(a, b)| (a - b).abs() <= 3);
            assert!(close, "{orientation}, {place:?}: {found:?}");
        }
        assert_eq!(read.statement.notes.is_empty(), orientation == 1);
    }
}

#[test]
fn profiles_of_jpegs_decide_their_colours() {
    let srgb = |code: i32| srgb_to_linear(f64::from(code) / 255.0);
    let power = |gamma: f64| move |code: i32| (f64::from(code) / 255.0).powf(gamma);
    let adobe = power(563.0 / 256.0);
    // The right green of the first rectangle, (200, 100, 50); matrices from Display P3 and Adobe RGB as published.
    let table: [(&str, Vec<u8>, f64, usize); 6] = [
        ("sRGB in one part", icc(&profile("sRGB IEC61966-2.1", 2), 1), srgb(100), 0),
        ("sRGB in three parts", icc(&profile("sRGB built-in", 4), 3), srgb(100), 0),
        ("Display P3", icc(&profile("Display P3", 4), 1), -0.0420 * srgb(200) + 1.0420 * srgb(100), 0),
        ("Adobe RGB", icc(&profile("Adobe RGB (1998)", 2), 2), adobe(100), 0),
        ("a printer", icc(&profile("Dot Gain 20%", 2), 1), srgb(100), 1),
        ("a part that is missing", segment(0xe2, b"ICC_PROFILE\0\x01\x02half of a profile"), srgb(100), 0),
    ];
    for (kind, segments, expected, warnings) in table {
        let read = read_as("a.jpg", &with(RESTART, &segments), Purpose::Colours).unwrap();
        let found = f64::from(read.picture.pixel(6, 7)[1]);
        // Two codes.
        assert!((found - expected).abs() < 0.012, "{kind}: {found} {expected}");
        assert_eq!(read.statement.warnings.len(), warnings, "{kind}: {:?}", read.statement.warnings);
        let data = read_as("a.jpg", &with(RESTART, &segments), Purpose::Data).unwrap();
        assert!((codes(&data, 6, 7)[1] - 100).abs() <= 2, "{kind}");
        assert!(data.statement.warnings.is_empty(), "{kind}: {:?}", data.statement.warnings);
    }
}

#[test]
fn jpegs_of_other_kinds_are_named_for_what_they_are() {
    let table: [(&str, Vec<u8>, &str); 13] = [
        ("CMYK by Adobe", CMYK.to_vec(), "is a JPEG in colours for print (CMYK or YCCK), which is not read"),
        ("YCCK by Adobe", YCCK.to_vec(), "in colours for print (CMYK or YCCK)"),
        ("CMYK without a segment", without(CMYK, 0xee), "in colours for print (CMYK or YCCK)"),
        ("12 bits", TWELVE_BITS.to_vec(), "is a JPEG of 12 bits, which is not read"),
        ("lossless", LOSSLESS.to_vec(), "is a JPEG with lossless coding"),
        ("JPEG-LS", framed(RESTART, 0xf7), "is a JPEG of the standard JPEG-LS"),
        ("arithmetic coding", framed(RESTART, 0xc9), "is a JPEG with arithmetic coding"),
        ("arithmetic coding, progressive", framed(RESTART, 0xca), "is a JPEG with arithmetic coding"),
        ("lossless arithmetic coding", framed(RESTART, 0xcb), "is a JPEG with arithmetic coding"),
        ("hierarchical", framed(RESTART, 0xc5), "is a JPEG with hierarchical coding"),
        ("cut off", RESTART[..RESTART.len() - 2].to_vec(), "is not a readable JPEG file: it is cut off"),
        ("cut off before its frame", RESTART[..40].to_vec(), "is not a readable JPEG file: it has no size"),
        ("no frame", b"\xff\xd8\xff\xe0\0\x04ab\xff\xd9".to_vec(), "is not a readable JPEG file: it has no size"),
    ];
    for (kind, bytes, expected) in table {
        let error = read_as("a.jpg", &bytes, Purpose::Colours).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("; export it"), "{kind}: {error}");
    }
}
