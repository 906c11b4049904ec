//! TIFFs as other programs write them.
//!
//! Written by tifffile 2026.3.3, and `grey_alpha.tif` by Pillow 13.0.0: 5×4 pixels, code k = (37 x + 11 y + 91 c) mod 256 in channel c. Samples of
//! 16 bits are 257 k + 1, floats k/64 − 1.

use std::io::Cursor;

use tiff::encoder::colortype::RGB8;
use tiff::encoder::{Rational, TiffEncoder};
use tiff::tags::Tag;

use super::formats::read_as;
use super::*;

/// A TIFF of one pixel, code 200, 100, 50, with tags of whole numbers and of fractions.
fn one_pixel(numbers: &[(u16, u16)], fractions: &[(u16, &[f64])]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<RGB8>(1, 1).unwrap();
    for &(tag, number) in numbers {
        image.encoder().write_tag(Tag::from_u16_exhaustive(tag), number).unwrap();
    }
    for &(tag, values) in fractions {
        let values: Vec<Rational> =
            values.iter().map(|value| Rational { n: (value * 1e4).round() as u32, d: 10_000 }).collect();
        image.encoder().write_tag(Tag::from_u16_exhaustive(tag), &values[..]).unwrap();
    }
    image.write_data(&[200, 100, 50]).unwrap();
    bytes.into_inner()
}

/// TIFF 6.0, section 8: FillOrder 2. A decoder that takes the bits as they are reads 0x13 for 0xc8.
#[test]
fn a_tiff_with_bits_in_reverse_is_refused_by_name() {
    assert!(read_as("a.tif", &one_pixel(&[(266, 1)], &[]), Purpose::Heights).is_ok());
    let error = read_as("a.tif", &one_pixel(&[(266, 2)], &[]), Purpose::Heights).unwrap_err().to_string();
    assert!(error.contains("in reverse (FillOrder 2)") && error.contains("; export it"), "{error}");
}

/// TIFF 6.0, section 20: primaries of red, green and blue in tag 319, white in tag 318, a transfer function in tag 301.
#[test]
fn a_tiff_is_read_in_the_primaries_of_its_tags() {
    let wide = [0.64, 0.33, 0.21, 0.71, 0.15, 0.06];
    let with = |fractions: &[(u16, &[f64])]| read_as("a.tif", &one_pixel(&[], fractions), Purpose::Colours).unwrap();
    let plain = with(&[]).picture.pixel(0, 0);
    for fractions in [&[(319, &wide[..]), (318, &[0.3127, 0.329])][..], &[(319, &wide[..])]] {
        let read = with(fractions);
        let space = read.statement.colour_space.unwrap();
        assert_eq!(space.said.unwrap(), "PrimaryChromaticities of Adobe RGB");
        assert!(space.used.contains("converted to Rec. 709"), "{}", space.used);
        // From Adobe RGB to Rec. 709, red is 1.3984 of its red and -0.3984 of its green.
        let red = 1.3984 * plain[0] - 0.3984 * plain[1];
        assert!((read.picture.pixel(0, 0)[0] - red).abs() < 1e-3, "{:?} {red}", read.picture.pixel(0, 0));
    }
    let odd = with(&[(319, &wide[..5])]);
    assert_eq!(odd.statement.colour_space.unwrap().said, None);
    let curve = with(&[(301, &[0.0, 0.5])]);
    assert!(curve.statement.ignored.iter().any(|what| what.starts_with("TransferFunction")), "{:?}", curve.statement);
}

#[test]
fn tiffs_of_other_programs_give_their_values() {
    let code = |x: u32, y: u32, c: u32| f64::from((37 * x + 11 * y + 91 * c) % 256);
    let eight = |x, y, c| code(x, y, c) / 255.0;
    let sixteen = |x, y, c| ((257.0 * code(x, y, c) + 1.0) % 65536.0) / 65535.0;
    let float = |x, y, c| code(x, y, c) / 64.0 - 1.0;
    let inverted = |x, y, _| 1.0 - code(x, y, 0) / 255.0;
    let grey = |x, y, _| eight(x, y, 0);
    type Right<'a> = &'a dyn Fn(u32, u32, u32) -> f64;
    let table: [(&str, &[u8], Right<'_>, &[&str]); 11] = [
        ("planes", include_bytes!("data/planar.tif"), &eight, &[]),
        ("planes of floats, Deflate with predictor", include_bytes!("data/planar_float.tif"), &float, &[]),
        ("big-endian, 16 bits", include_bytes!("data/big_endian.tif"), &sixteen, &[]),
        ("BigTIFF", include_bytes!("data/big.tif"), &eight, &[]),
        ("tiles, LZW with predictor", include_bytes!("data/tiles.tif"), &eight, &[]),
        ("half floats", include_bytes!("data/half.tif"), &float, &[]),
        ("doubles", include_bytes!("data/double.tif"), &float, &[]),
        ("white is zero", include_bytes!("data/white_is_zero.tif"), &inverted, &[]),
        ("a strip for each row, PackBits", include_bytes!("data/rows.tif"), &eight, &[]),
        ("alpha that is multiplied in", include_bytes!("data/premultiplied.tif"), &eight, &["A"]),
        ("grey with alpha", include_bytes!("data/grey_alpha.tif"), &grey, &["A"]),
    ];
    for (kind, bytes, right, left) in table {
        let read = read_as("a.tif", bytes, Purpose::Heights).unwrap_or_else(|error| panic!("{kind}: {error}"));
        assert_eq!((read.statement.kind.as_str(), read.statement.size), ("TIFF", [5, 4]), "{kind}");
        assert_eq!(read.statement.left, left, "{kind}");
        assert_eq!(
            read.statement.notes.iter().any(|note| note.contains("multiplied in")),
            kind.contains("multiplied"),
            "{kind}"
        );
        for (x, y, c) in (0..4).flat_map(|y| (0..5).flat_map(move |x| [0, 1, 2].map(|c| (x, y, c)))) {
            let (found, expected) = (read.picture.pixel(x, y)[c as usize], right(x, y, c));
            assert!((f64::from(found) - expected).abs() < 1e-6, "{kind} ({x}, {y}, {c}): {found} {expected}");
        }
    }
}
