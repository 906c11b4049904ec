//! Textures in KTX2 and DDS files: pictures and cubes of all formats of texels.

use super::containers::{CUBE, dds_header, ktx2_file};
use super::formats::read_as;
use super::*;
use roughxel_assets::picture::read_cube;

/// Bytes, `count` times over.
fn times(bytes: &[u8], count: usize) -> Vec<u8> {
    bytes.repeat(count)
}

/// Half floats and floats of 16 texels.
fn halves(numbers: &[f32]) -> Vec<u8> {
    times(&numbers.iter().flat_map(|number| f16::from_f32(*number).to_le_bytes()).collect::<Vec<_>>(), 16)
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    times(&numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<_>>(), 16)
}

/// A block of one colour: red 16/31, green 32/63, blue 8/31. Its 8-bit codes repeat the upper bits: 132, 130, 66.
const BC1: [u8; 8] = [0x08, 0x84, 0x08, 0x84, 0, 0, 0, 0];
/// A block whose first end point is 201, in all texels.
const BC4: [u8; 8] = [201, 7, 0, 0, 0, 0, 0, 0];

/// BC6H in mode 11: 10-bit end points, both alike.
fn bc6h(numbers: [u128; 3]) -> Vec<u8> {
    let place = |channel: usize| (numbers[channel] << (5 + 10 * channel)) | (numbers[channel] << (35 + 10 * channel));
    (3 | place(0) | place(1) | place(2)).to_le_bytes().to_vec()
}

/// BC7 in mode 5: 7-bit end points, both alike.
fn bc7(codes: [u8; 3]) -> Vec<u8> {
    let bits = codes.iter().enumerate().fold(1_u128 << 5, |bits, (channel, code)| {
        bits | (u128::from(code >> 1) * ((1 << (8 + 14 * channel)) | (1 << (15 + 14 * channel))))
    });
    bits.to_le_bytes().to_vec()
}

/// Format: its name, its numbers in Vulkan, in DXGI and as a code of Direct3D 9, the bytes of 4×4 texels, and their right value.
type Format = (&'static str, Option<u32>, Option<u32>, Option<[u8; 4]>, Vec<u8>, [f32; 3]);

fn formats() -> Vec<Format> {
    let code = |code: u8| f32::from(code) / 255.0;
    let grey = |value: f32| [value; 3];
    let d3d = |number: u8| Some([number, 0, 0, 0]);
    let bc1 = [code(132), code(130), code(66)];
    vec![
        ("R8", Some(9), Some(61), None, times(&[200], 16), grey(code(200))),
        ("R8G8", Some(16), Some(49), None, times(&[200, 30], 16), [code(200), code(30), 0.0]),
        ("R8G8B8", Some(23), None, None, times(&[1, 2, 3], 16), [code(1), code(2), code(3)]),
        ("B8G8R8", Some(30), None, None, times(&[1, 2, 3], 16), [code(3), code(2), code(1)]),
        ("R8G8B8A8", Some(37), Some(28), None, times(&[1, 2, 3, 4], 16), [code(1), code(2), code(3)]),
        ("B8G8R8A8", Some(44), Some(87), None, times(&[1, 2, 3, 4], 16), [code(3), code(2), code(1)]),
        ("B8G8R8X8", None, Some(88), None, times(&[1, 2, 3, 4], 16), [code(3), code(2), code(1)]),
        ("R16 half", Some(76), Some(54), d3d(111), halves(&[-0.75]), grey(-0.75)),
        ("R16G16 half", Some(83), Some(34), d3d(112), halves(&[0.5, -2.0]), [0.5, -2.0, 0.0]),
        ("R16G16B16 half", Some(90), None, None, halves(&[0.5, 7.0, 0.25]), [0.5, 7.0, 0.25]),
        ("R16G16B16A16 half", Some(97), Some(10), d3d(113), halves(&[0.5, 7.0, 0.25, 9.0]), [0.5, 7.0, 0.25]),
        ("R32 float", Some(100), Some(41), d3d(114), floats(&[1e9]), grey(1e9)),
        ("R32G32 float", Some(103), Some(16), d3d(115), floats(&[0.1, 0.2]), [0.1, 0.2, 0.0]),
        ("R32G32B32 float", Some(106), Some(6), None, floats(&[0.1, 0.2, 0.3]), [0.1, 0.2, 0.3]),
        ("R32G32B32A32 float", Some(109), Some(2), d3d(116), floats(&[0.1, 0.2, 0.3, 0.4]), [0.1, 0.2, 0.3]),
        // Exponent 15 of three packed floats with fraction 0 is 1; mantissa 256 with exponent 16 is 1.
        (
            "B10G11R11",
            Some(122),
            Some(26),
            None,
            times(&((15_u32 << 6) | (15 << 17)).to_le_bytes(), 16),
            [1.0, 1.0, 0.0],
        ),
        (
            "E5B9G9R9",
            Some(123),
            Some(67),
            None,
            times(&((16_u32 << 27) | (128 << 9) | 256).to_le_bytes(), 16),
            [1.0, 0.5, 0.0],
        ),
        ("BC1", Some(131), Some(71), Some(*b"DXT1"), BC1.to_vec(), bc1),
        ("BC1 with alpha", Some(133), None, None, BC1.to_vec(), bc1),
        ("BC2", Some(135), Some(74), Some(*b"DXT3"), [[0x5a; 8], BC1].concat(), bc1),
        ("BC3", Some(137), Some(77), Some(*b"DXT5"), [BC4, BC1].concat(), bc1),
        ("BC4", Some(139), Some(80), Some(*b"ATI1"), BC4.to_vec(), grey(code(201))),
        // Formats without a type, as Pillow writes them.
        ("BC4 without a type", None, Some(79), None, BC4.to_vec(), grey(code(201))),
        ("BC1 without a type", None, Some(70), None, BC1.to_vec(), bc1),
        ("R8G8B8A8 without a type", None, Some(27), None, times(&[1, 2, 3, 4], 16), [code(1), code(2), code(3)]),
        (
            "BC5",
            Some(141),
            Some(83),
            Some(*b"ATI2"),
            [BC4, [50, 50, 0, 0, 0, 0, 0, 0]].concat(),
            [code(201), code(50), 0.0],
        ),
        // 495 becomes the half 0x3c00, and 1023 the largest. With a sign, 247 becomes 0x3bf1.
        ("BC6H", Some(143), Some(95), None, bc6h([495, 1023, 0]), [1.0, 65504.0, 0.0]),
        ("BC6H with a sign", Some(144), Some(96), None, bc6h([247, 0, 247]), [0.992_675_8, 0.0, 0.992_675_8]),
        // Seven bits become eight by repeating the top one.
        ("BC7", Some(145), Some(98), None, bc7([168, 84, 254]), [code(169), code(84), code(255)]),
    ]
}

/// Files of a format with 4×4 texels: all containers, as one picture or as a cube.
fn files((_, vulkan, dxgi, four_cc, bytes, _): &Format, faces: usize) -> Vec<Vec<u8>> {
    let (level, caps) = (times(bytes, faces), if faces == 6 { CUBE } else { 0 });
    let ktx2 = vulkan.map(|format| ktx2_file(format, 1, [4; 2], faces as u32, 1, &level));
    let dxgi = dxgi.map(|format| [dds_header([4; 2], 1, caps, b"DX10", Some(format)), level.clone()].concat());
    let d3d = four_cc.map(|four_cc| [dds_header([4; 2], 1, caps, &four_cc, None), level.clone()].concat());
    [ktx2, dxgi, d3d].into_iter().flatten().collect()
}

#[test]
fn textures_of_all_formats_have_their_values() {
    let directory = Directory::new().unwrap();
    for format in formats() {
        let (kind, .., expected) = &format;
        for bytes in files(&format, 1) {
            let read = read_as("a.png", &bytes, Purpose::Heights).unwrap_or_else(|error| panic!("{kind}: {error}"));
            assert_eq!((read.statement.size, read.picture.pixels), ([4, 4], vec![*expected; 16]), "{kind}");
            assert!(["KTX2, ", "DDS, "].iter().any(|start| read.statement.kind.starts_with(start)), "{kind}");
            let has_alpha = ["A8", "A16", "A32", "BC2", "BC3", "BC7"].iter().any(|alpha| kind.contains(alpha));
            assert_eq!(read.statement.left.contains(&"A".to_owned()), has_alpha, "{kind}: {:?}", read.statement.left);
        }
        for bytes in files(&format, 6) {
            let wishes = Wishes { transfer: Some(Transfer::Linear), ..Wishes::default() };
            let cube = read_cube(&directory.file("a.dds", &bytes).unwrap(), &wishes).unwrap();
            assert!(cube.faces.iter().all(|face| face.pixels == [*expected; 16]), "{kind}");
            let has_alpha = ["A8", "A16", "A32", "BC2", "BC3", "BC7"].iter().any(|alpha| kind.contains(alpha));
            assert_eq!(cube.statement.left.contains(&"A".to_owned()), has_alpha, "{kind}: {:?}", cube.statement.left);
        }
    }
}

#[test]
fn block_textures_of_two_channels_are_normals() {
    // Codes 128 + 127 n of (0.6, 0, 0.8), of (0, −0.6, 0.8) and of the level normal.
    for (codes, expected) in [
        ([204, 128], [0.6, 0.0, 0.8]),
        ([128, 52], [0.0, -0.6, 0.8]),
        ([128, 128], [0.0, 0.0, 1.0]),
        ([255, 128], [1.0, 0.0, 0.0]),
        ([1, 128], [-1.0, 0.0, 0.0]),
    ] {
        let block: Vec<u8> = codes.iter().flat_map(|code| [*code, *code, 0, 0, 0, 0, 0, 0]).collect();
        for bytes in files(&("BC5", Some(141), Some(83), Some(*b"ATI2"), block.clone(), [0.0; 3]), 1) {
            let read = read_as("a.dds", &bytes, Purpose::Normals).unwrap();
            for (component, expected) in read.picture.pixels[7].iter().zip(expected) {
                assert!((component - expected).abs() < 0.004, "{codes:?}: {:?}", read.picture.pixels[7]);
            }
            assert_eq!((read.statement.signed, read.statement.channels.len()), (Some(true), 2));
        }
    }
    // x in alpha, y in green, as DXT5nm has them, is told.
    let block = [[204, 204, 0, 0, 0, 0, 0, 0], [0, 0x04, 0, 0x04, 0, 0, 0, 0]].concat();
    let [_, dxgi, _] =
        <[Vec<u8>; 3]>::try_from(files(&("BC3", Some(137), Some(77), Some(*b"DXT5"), block, [0.0; 3]), 1)).unwrap();
    let read = read_as("a.dds", &dxgi, Purpose::Normals).unwrap();
    assert!(read.statement.warnings[0].contains("DXT5nm"), "{:?}", read.statement.warnings);
    let grey = files(&("BC4", Some(139), None, None, BC4.to_vec(), [0.0; 3]), 1);
    assert!(fails(read_as("a.ktx2", &grey[0], Purpose::Normals), "is grey"));
}

#[test]
fn words_of_a_texture_decide_its_colours_and_rows() {
    let srgb = |code: f64| srgb_to_linear(code / 255.0) as f32;
    let level: Vec<u8> = [[200, 100, 50, 255], [20, 60, 240, 255]].concat();
    let ktx2 = |format, transfer| ktx2_file(format, 1, [1, 2], 1, transfer, &level);
    // The primaries stand before the transfer function in the description of the format.
    let place = 104 + 4 + 8 + 1;
    assert_eq!(ktx2(37, 1)[place..place + 2], [1, 1]);
    let primaries = |number: u8| {
        let mut bytes = ktx2(37, 1);
        bytes[place] = number;
        bytes
    };
    let row = |row: [f32; 3]| (row[0] * 200.0 + row[1] * 100.0 + row[2] * 50.0) / 255.0;
    // A key and its value behind everything else: rows from the bottom.
    let mut turned = ktx2(37, 1);
    let key = b"\x12\0\0\0KTXorientation\0ru\0\0\0";
    let [start, length] = [turned.len() as u32, key.len() as u32].map(u32::to_le_bytes);
    turned[56..64].copy_from_slice(&[start, length].concat());
    // The reader wants another byte behind it.
    turned.extend([&key[..], &[0]].concat());
    let dds = |format| [dds_header([1, 2], 1, 0, b"DX10", Some(format)), level.clone()].concat();
    let mut of_no_array = dds(28);
    of_no_array[140] = 0;
    let red = 200.0_f32 / 255.0;
    for (kind, bytes, expected) in [
        ("KTX2, linear", ktx2(37, 1), red),
        ("KTX2, sRGB", ktx2(43, 2), srgb(200.0)),
        ("KTX2, codes that are called sRGB", ktx2(37, 2), srgb(200.0)),
        ("KTX2 that says nothing", ktx2(37, 0), srgb(200.0)),
        ("KTX2, Rec. 2020", primaries(4), row([1.6605, -0.5876, -0.0728])),
        ("KTX2, Display P3", primaries(10), row([1.2249, -0.2249, 0.0])),
        ("KTX2, Adobe RGB", primaries(11), row([1.3984, -0.3984, 0.0])),
        ("KTX2, ACEScg", primaries(7), row([1.7051, -0.6218, -0.0833])),
        ("KTX2, rows from the bottom", turned, 20.0 / 255.0),
        ("DDS, linear", dds(28), red),
        ("DDS, an array of 0, as Pillow writes it", of_no_array, red),
        ("DDS, sRGB", dds(29), srgb(200.0)),
        ("DDS that says nothing", dds(27), srgb(200.0)),
    ] {
        let read = read_as("a", &bytes, Purpose::Colours).unwrap();
        let found = read.picture.pixels[0][0];
        assert!((found - expected).abs() < 2e-4, "{kind}: {found} {expected}");
        let stored = if kind.contains("bottom") { expected } else { red };
        assert_eq!(read_as("a", &bytes, Purpose::Data).unwrap().picture.pixels[0][0], stored, "{kind}");
    }
}

#[test]
fn textures_that_are_no_picture_are_named() {
    let directory = Directory::new().unwrap();
    let half = |faces: usize| times(&halves(&[0.5; 4]), faces);
    let cube = ktx2_file(97, 2, [4; 2], 6, 1, &half(6));
    let mut array = [dds_header([4; 2], 1, 0, b"DX10", Some(10)), half(1)].concat();
    array[140] = 2;
    let volume = [dds_header([4; 2], 1, 0x0020_0000, &[113, 0, 0, 0], None), half(1)].concat();
    let mut basis = ktx2_file(0, 1, [4; 2], 1, 1, &[0; 64]);
    basis[12..16].fill(0);
    let mut packed = ktx2_file(97, 2, [4; 2], 1, 1, &half(1));
    packed[44] = 2;
    for (kind, bytes, expected) in [
        ("a cube", cube.clone(), "holds a cube map; name it with `cube`"),
        ("an array", array, "is no single picture"),
        ("a volume", volume, "is no single picture"),
        ("Basis Universal", basis, "holds Basis Universal texels"),
        ("supercompressed", packed, "is supercompressed"),
        ("another format", ktx2_file(140, 1, [4; 2], 1, 1, &[0; 8]), "holds texels of the format BC4_SNORM"),
        ("another format of DDS", [dds_header([4; 2], 1, 0, b"DX10", Some(84)), vec![0; 16]].concat(), "BC5_SNorm"),
        ("an older format", [dds_header([4; 2], 1, 0, b"UYVY", None), vec![0; 64]].concat(), "UYVY"),
        ("cut off", dds_header([4; 2], 1, 0, b"DX10", Some(10)), "it ends within its first level"),
        ("too large", dds_header([20000, 4], 1, 0, b"DX10", Some(10)), "at most 16384 an edge"),
        ("infinite", ktx2_file(97, 2, [4; 2], 1, 1, &halves(&[f32::INFINITY; 4])), "has the value inf at pixel (0, 0)"),
    ] {
        let error = read_as("a", &bytes, Purpose::Data).unwrap_err().to_string();
        assert!(error.contains(expected), "{kind}: {error}");
    }
    let flat = ktx2_file(97, 2, [4; 2], 1, 1, &half(1));
    for (bytes, is_cube) in [(cube, true), (flat, false)] {
        assert_eq!(is_cube_file(&directory.file("a.ktx2", &bytes).unwrap()), is_cube);
    }
}

#[test]
fn damaged_textures_never_panic() {
    let directory = Directory::new().unwrap();
    let mut random = SplitMix64::new(5);
    for format in formats() {
        for bytes in files(&format, 1) {
            for _ in 0..60 {
                let mut altered = bytes.clone();
                for _ in 0..=random.below(3) {
                    let place = random.below(altered.len() as u64) as usize;
                    altered[place] = random.below(256) as u8;
                }
                altered.truncate(altered.len() - random.below(9) as usize);
                let path = directory.file("a", &altered).unwrap();
                let _ = read(&path, Purpose::Normals, &Wishes::default());
            }
        }
    }
}

/// Microsoft's D3DFMT_L8 and D3DFMT_A8L8: the flag of luminance, bits of a texel, a mask for red and one for alpha.
#[test]
fn grey_textures_of_the_older_header_are_read() {
    let grey = |bits: u32, alpha: bool, texels: &[u8]| {
        let mut bytes = dds_header([2, 1], 1, 0, &[0; 4], None);
        let flags = 0x2_0000 | u32::from(alpha);
        for (place, word) in [(80, flags), (88, bits), (92, 0xff), (104, if alpha { 0xff00 } else { 0 })] {
            bytes[place..place + 4].copy_from_slice(&word.to_le_bytes());
        }
        [bytes, texels.to_vec()].concat()
    };
    for (kind, bytes) in [("L8", grey(8, false, &[50, 200])), ("A8L8", grey(16, true, &[50, 7, 200, 9]))] {
        let read = read_as("a.dds", &bytes, Purpose::Heights).unwrap_or_else(|error| panic!("{kind}: {error}"));
        for (x, code) in [(0, 50.0), (1, 200.0)] {
            for channel in read.picture.pixel(x, 0) {
                assert!((channel - code / 255.0).abs() < 1e-6, "{kind}: {:?}", read.picture);
            }
        }
        let left = if kind == "A8L8" { vec!["A".to_owned()] } else { Vec::new() };
        assert_eq!((read.statement.channels, read.statement.left), (vec!["Y".to_owned()], left), "{kind}");
    }
    let error = read_as("a.dds", &grey(16, false, &[0; 4]), Purpose::Heights).unwrap_err().to_string();
    assert!(error.contains("; export it as"), "{error}");
}

/// DXT2 and DXT4 and mode 2 of the newer header have alpha multiplied in, mode 3 has none.
#[test]
fn the_kind_of_alpha_of_a_texture_is_named() {
    let newer = |mode: u32| {
        let mut bytes = dds_header([4; 2], 1, 0, b"DX10", Some(28));
        let place = bytes.len() - 4;
        bytes[place..].copy_from_slice(&mode.to_le_bytes());
        [bytes, times(&[1, 2, 3, 4], 16)].concat()
    };
    let older = |name: &[u8; 4]| [dds_header([4; 2], 1, 0, name, None), [BC4, BC1].concat()].concat();
    let mut ktx2 = ktx2_file(37, 1, [4; 2], 1, 1, &times(&[1, 2, 3, 4], 16));
    let straight = ktx2.clone();
    // Flags stand behind the transfer function.
    ktx2[104 + 4 + 8 + 3] = 1;
    for (kind, bytes, named, multiplied) in [
        ("unknown", newer(0), true, false),
        ("straight", newer(1), true, false),
        ("multiplied", newer(2), true, true),
        ("opaque", newer(3), false, false),
        ("DXT2", older(b"DXT2"), true, true),
        ("DXT3", older(b"DXT3"), true, false),
        ("DXT4", older(b"DXT4"), true, true),
        ("KTX2", straight, true, false),
        ("KTX2, multiplied", ktx2, true, true),
    ] {
        let read = read_as("a.dds", &bytes, Purpose::Heights).unwrap_or_else(|error| panic!("{kind}: {error}"));
        let said = read.statement.notes.iter().any(|note| note.contains("multiplied in"));
        assert_eq!((read.statement.left.contains(&"A".to_owned()), said), (named, multiplied), "{kind}");
    }
}
