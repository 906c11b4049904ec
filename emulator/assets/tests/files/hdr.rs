//! Radiance pictures of all orders and storages, intact and damaged.

use roughxel_assets::Picture;
use roughxel_assets::picture::*;

fn read_file(bytes: &[u8]) -> Result<Picture, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.hdr");
    std::fs::write(&path, bytes).unwrap();
    read(&path, Purpose::Colours, &Wishes::default()).map(|read| read.picture).map_err(|error| error.to_string())
}

fn file(size: &str, pixels: &[u8]) -> Vec<u8> {
    let header = format!("#?RADIANCE\n# made by hand\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n{size}\n");
    [header.as_bytes(), pixels].concat()
}

#[test]
fn plain_pixels_are_mantissas_times_a_power_of_two() {
    let pixels = [128, 64, 0, 129, 255, 1, 2, 0, 255, 255, 255, 255, 1, 2, 1, 1];
    let picture = read_file(&file("-Y 2 +X 2", &pixels)).unwrap();
    assert_eq!((picture.width, picture.height), (2, 2));
    let last = [1.0, 2.0, 1.0].map(|mantissa: f32| mantissa * 2f32.powi(-135));
    assert_eq!(picture.pixels, [[1.0, 0.5, 0.0], [0.0; 3], [255.0 * 2f32.powi(119); 3], last]);
    assert!(read_file(&[b"#?RGBE\n\n-Y 1 +X 1\n", &pixels[..4]].concat()).is_ok());
}

#[test]
fn runs_of_both_kinds_are_the_same_picture() {
    let (a, b) = ([10, 20, 30, 128], [40, 50, 60, 130]);
    let plain = [[a; 9].concat(), b.to_vec()].concat();
    // 9 times the first pixel, then the other.
    let old = [&a[..], &[1, 1, 1, 8], &b].concat();
    let mut new = vec![2, 2, 0, 10];
    for channel in 0..4 {
        // A run of 8, and a stretch of 2.
        new.extend([128 + 8, a[channel], 2, a[channel], b[channel]]);
    }
    let read = |pixels: &[u8]| read_file(&file("-Y 1 +X 10", pixels)).unwrap();
    assert_eq!(read(&plain), read(&old));
    assert_eq!(read(&plain), read(&new));

    // A second mark counts 256s; wider than the new kind allows.
    let long = [&a[..], &[1, 1, 1, 255], &[1, 1, 1, 128]].concat();
    let width = 1 + 255 + 128 * 256;
    let picture = read_file(&file(&format!("-Y 1 +X {width}"), &long));
    assert!(picture.unwrap_err().contains("at most 16384 an edge"));
    let shorter = [&a[..], &[1, 1, 1, 255], &[1, 1, 1, 3]].concat();
    let picture = read_file(&file(&format!("-Y 1 +X {}", 256 + 3 * 256), &shorter)).unwrap();
    assert!(picture.pixels.iter().all(|pixel| *pixel == [10.0, 20.0, 30.0].map(|mantissa: f32| mantissa / 256.0)));
}

#[test]
fn bad_files_say_what_is_wrong_and_cut_ones_do_not_panic() {
    let row = |pixels: &[u8]| file("-Y 1 +X 8", pixels);
    for (bytes, expected) in [
        (b"\x89PNG\r\n\x1a\n".to_vec(), "not a readable PNG file"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n".to_vec(), "header has no end"),
        (b"#?RADIANCE\nFORMAT=48-bit_rgb\n\n-Y 1 +X 1\n".to_vec(), "format `48-bit_rgb`; export it as"),
        (file("+Y 1 +Z 1", &[0; 4]), "`+Y 1 +Z 1` is no size"),
        (file("-Y 1 +Y 1", &[0; 4]), "`-Y 1 +Y 1` is no size"),
        (file("-Y 1", &[0; 4]), "`-Y 1` is no size"),
        (file("-Y one +X 1", &[0; 4]), "`-Y one +X 1` is no size"),
        (file("-Y 0 +X 1", &[]), "is no size"),
        (file("-Y 16384 +X 16384", &[]), "scale it down"),
        (file("-Y 99999999999 +X 1", &[]), "scale it down"),
        (file("-Y 2 +X 1", &[0; 4]), "row 1 is cut off"),
        (row(&[2, 2, 0, 9]), "row 0 has another length"),
        (row(&[2, 2, 0, 8, 0]), "a run that does not fit"),
        (row(&[2, 2, 0, 8, 128 + 9, 1]), "a run that does not fit"),
        (row(&[1, 1, 1, 3]), "a run that does not fit"),
        (row(&[9, 9, 9, 9, 1, 1, 1, 8]), "a run that does not fit"),
    ] {
        let message = read_file(&bytes).unwrap_err();
        assert!(message.contains(expected), "{expected}: {message}");
    }
    let mut endless = b"#?RADIANCE\n".to_vec();
    endless.resize(1 << 17, b'x');
    assert!(read_file(&endless).unwrap_err().contains("header has no end"));
    let whole = row(&[&[2, 2, 0, 8][..], &[128 + 8, 7].repeat(4)].concat());
    assert!(read_file(&whole).is_ok());
    for end in 0..whole.len() {
        assert!(read_file(&whole[..end]).is_err());
    }
}

#[test]
fn pixels_stand_where_the_order_says() {
    // Six pixels of one row or column after the other, told apart by their red.
    let pixels: Vec<u8> = (0..6).flat_map(|index| [128 + index, 0, 0, 136]).collect();
    let table: [(&str, [u32; 6]); 8] = [
        ("-Y 2 +X 3", [0, 1, 2, 3, 4, 5]),
        ("-Y 2 -X 3", [2, 1, 0, 5, 4, 3]),
        ("+Y 2 +X 3", [3, 4, 5, 0, 1, 2]),
        ("+Y 2 -X 3", [5, 4, 3, 2, 1, 0]),
        ("+X 3 -Y 2", [0, 2, 4, 1, 3, 5]),
        ("+X 3 +Y 2", [1, 3, 5, 0, 2, 4]),
        ("-X 3 -Y 2", [4, 2, 0, 5, 3, 1]),
        ("-X 3 +Y 2", [5, 3, 1, 4, 2, 0]),
    ];
    for (order, expected) in table {
        let picture = read_file(&file(order, &pixels)).unwrap();
        assert_eq!((picture.width, picture.height), (3, 2), "{order}");
        let found: Vec<u32> = picture.pixels.iter().map(|pixel| pixel[0] as u32 - 128).collect();
        assert_eq!(found, expected, "{order}");
    }
}

/// Lines of a header, a use, and what becomes of (1, 0.5, 0.25): the pixel, and parts of its statement.
#[test]
fn variables_of_a_header_are_read_or_named() {
    type Case<'a> = (&'a str, Purpose, [f32; 3], &'a str);
    let plain = [1.0, 0.5, 0.25];
    let colours = Purpose::Colours;
    let table: [Case<'_>; 12] = [
        ("", colours, plain, ""),
        ("EXPOSURE=1.0", Purpose::Environment, plain, ""),
        ("EXPOSURE=2.0", Purpose::Environment, plain, "(`exposure = -1.0000` does)"),
        ("EXPOSURE=0.5\nEXPOSURE=0.5", Purpose::Environment, plain, "EXPOSURE 0.25: the pixels were multiplied by it"),
        ("EXPOSURE=2.0", colours, plain, "EXPOSURE 2: the pixels were multiplied by it"),
        ("COLORCORR=1 1 1", colours, plain, ""),
        ("COLORCORR=1 0.9 1", colours, plain, "COLORCORR `1 0.9 1`"),
        ("GAMMA=1", colours, plain, ""),
        ("GAMMA=2.2", colours, plain, "`transfer` decides otherwise"),
        ("PRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329", colours, plain, ""),
        ("PRIMARIES=0.64 0.33", colours, plain, "not eight numbers"),
        // The published matrix of Rec. 2020: 1.6605 − 0.5876/2 − 0.0728/4 and so on.
        ("PRIMARIES=0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329", colours, [1.3485, 0.4398, 0.2112], ""),
    ];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.hdr");
    for (lines, purpose, expected, part) in table {
        let header =
            format!("#?RADIANCE\n{lines}\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n").replace("\n\nFORMAT", "\nFORMAT");
        std::fs::write(&path, [header.as_bytes(), &[128, 64, 32, 129]].concat()).unwrap();
        let read = read(&path, purpose, &Wishes::default()).unwrap();
        for (channel, expected) in read.picture.pixels[0].iter().zip(expected) {
            assert!((channel - expected).abs() < 2e-4, "{lines}: {:?}", read.picture.pixels);
        }
        let told: Vec<_> = read.statement.warnings.iter().chain(&read.statement.ignored).collect();
        assert_eq!(told.is_empty(), part.is_empty(), "{lines}: {told:?}");
        assert!(told.iter().all(|sentence| sentence.contains(part)), "{lines}: {told:?}");
    }
}

#[test]
fn xyz_colours_become_rec_709_and_white_stays_white() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.hdr");
    let read = |pixel: [u8; 4], purpose| {
        let header = b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n";
        std::fs::write(&path, [&header[..], &pixel].concat()).unwrap();
        read(&path, purpose, &Wishes::default()).unwrap()
    };
    let white = read([128, 128, 128, 129], Purpose::Environment);
    assert!(white.picture.pixels[0].iter().all(|channel| (channel - 1.0).abs() < 1e-5), "{:?}", white.picture.pixels);
    assert_eq!(white.statement.colour_space.unwrap().used, "CIE XYZ, converted to Rec. 709");
    assert_eq!(read([128, 64, 32, 129], Purpose::Data).picture.pixels[0], [1.0, 0.5, 0.25]);
}
