//! OpenEXR files that are valid and not read.

use exr::compression::Compression;
use exr::prelude::Encoding;

use super::layers::{parts, read_bytes};
use super::*;

/// Puts a byte behind the text of an attribute's name, type and length.
fn patch(bytes: &[u8], attribute: &[u8], offset: usize, value: &[u8]) -> Vec<u8> {
    let mut patched = bytes.to_vec();
    let at = bytes.windows(attribute.len()).position(|window| window == attribute).unwrap() + attribute.len() + offset;
    patched[at..at + value.len()].copy_from_slice(value);
    patched
}

#[test]
fn valid_files_of_other_kinds_are_named_for_what_they_are() {
    let file = parts(&[("", &[("Y", 0.5)])]);
    let compression = |method: u8| patch(&file, b"compression\0compression\0", 4, &[method]);
    let flagged = |flags: u8| {
        let mut bytes = file.clone();
        bytes[5] |= flags;
        bytes
    };
    let sampled = |x: u8, y: u8| patch(&file, b"chlist\0", 4 + 2 + 8, &[x, 0, 0, 0, y, 0, 0, 0]);
    for (bytes, expected) in [
        (compression(6), "is compressed by B44"),
        (compression(7), "is compressed by B44"),
        (compression(10), "is compressed by HTJ2K (JPEG 2000)"),
        (compression(11), "is compressed by HTJ2K (JPEG 2000)"),
        (compression(12), "is compressed by a newer method than is read (such as ZSTD)"),
        (compression(13), "is compressed by a newer method than is read (such as ZSTD)"),
        (compression(200), "is compressed by a newer method than is read (such as ZSTD)"),
        // The version has a flag for deep data, and others for tiles and for several parts.
        (flagged(0x08), "holds deep data"),
        (flagged(0x0a), "holds deep data"),
        (flagged(0x18), "holds deep data"),
        (sampled(2, 2), "has channels of lower resolution (luminance and chroma)"),
        (sampled(2, 1), "has channels of lower resolution (luminance and chroma)"),
        (sampled(1, 2), "has channels of lower resolution (luminance and chroma)"),
    ] {
        let error = read_bytes(&bytes, Purpose::Colours, &Wishes::default()).unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
        assert!(error.contains("; export it as"), "{error}");
    }
    let supported = Encoding { compression: Compression::DWAA(None), ..Encoding::default() };
    let bytes = exr_bytes(8, &[("Y", vec![0.5; 64])], supported).unwrap();
    assert!(read_bytes(&bytes, Purpose::Colours, &Wishes::default()).is_ok());
}
