//! TIFFs as other programs write them.
//!
//! Written by tifffile 2026.3.3, and `grey_alpha.tif` by Pillow 13.0.0: 5×4 pixels, code k = (37 x + 11 y + 91 c) mod 256 in channel c. Samples of
//! 16 bits are 257 k + 1, floats k/64 − 1.

use super::formats::read_as;
use super::*;

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
        for (x, y, c) in (0..4).flat_map(|y| (0..5).flat_map(move |x| [0, 1, 2].map(|c| (x, y, c)))) {
            let (found, expected) = (read.picture.pixel(x, y)[c as usize], right(x, y, c));
            assert!((f64::from(found) - expected).abs() < 1e-6, "{kind} ({x}, {y}, {c}): {found} {expected}");
        }
    }
}
