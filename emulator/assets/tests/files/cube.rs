//! Cube maps whose bytes are laid out by hand.

use std::path::PathBuf;

use roughxel_utilities::random::SplitMix64;

use exr::prelude::f16;

use roughxel_assets::picture::*;

use super::picture::containers::{CUBE, dds_header, ktx2_file};

/// A file of a test.
struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join("cube");
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn read(&self, bytes: &[u8]) -> Result<CubeFile, PictureError> {
        read_cube(&self.write(bytes), &Wishes::default())
    }
}

/// Half floats of a face: red is the face, green the row, blue the column.
fn half_faces(edge: u32, levels: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    for face in 0..6u32 {
        for level in 0..levels {
            for (y, x) in (0..edge >> level).flat_map(|y| (0..edge >> level).map(move |x| (y, x))) {
                let texel = if level == 0 { [face, y, x, 1] } else { [99; 4] };
                bytes.extend(texel.into_iter().flat_map(|value| f16::from_f32(value as f32).to_le_bytes()));
            }
        }
    }
    bytes
}

fn check_ramp(cube: &CubeFile, edge: u32) {
    for (face, picture) in cube.faces.iter().enumerate() {
        assert_eq!((picture.width, picture.height), (edge, edge));
        for (y, x) in (0..edge).flat_map(|y| (0..edge).map(move |x| (y, x))) {
            assert_eq!(picture.pixel(x, y), [face as f32, y as f32, x as f32], "face {face}");
        }
    }
}

#[test]
fn faces_are_in_order_with_rows_from_the_top_and_lower_levels_left_out() {
    let files = Files::new();
    // DXGI R16G16B16A16_FLOAT is 10; Direct3D 9's A16B16G16R16F is 113.
    for (four_cc, dxgi) in [(*b"DX10", Some(10)), ([113, 0, 0, 0], None)] {
        for levels in [1, 2, 3] {
            let bytes = [dds_header([4; 2], levels, CUBE, &four_cc, dxgi), half_faces(4, levels)].concat();
            check_ramp(&files.read(&bytes).unwrap(), 4);
        }
    }
    // VK_FORMAT_R16G16B16A16_SFLOAT is 97.
    let cube = files.read(&ktx2_file(97, 2, [4; 2], 6, 1, &half_faces(4, 1))).unwrap();
    check_ramp(&cube, 4);
    assert_eq!(cube.statement.transfer.unwrap().used, "linear");
}

/// Light of an 8-bit code.
type Decode = fn(f32) -> f32;

#[test]
fn codes_follow_the_transfer_function_that_the_file_names() {
    let files = Files::new();
    let level: Vec<u8> = (0..6).flat_map(|face| [10 * face, 128, 255, 7]).collect();
    let linear: Decode = |code| code / 255.0;
    let srgb: Decode = |code| srgb_to_linear(f64::from(code) / 255.0) as f32;
    // (bytes of the file, decoding of a code, says so); VK R8G8B8A8 UNORM is 37, SRGB 43; DXGI UNORM 28, SRGB 29.
    let unorm = |dxgi| [dds_header([1; 2], 1, CUBE, b"DX10", Some(dxgi)), level.clone()].concat();
    let cases: [(Vec<u8>, Decode); 5] = [
        (ktx2_file(37, 1, [1; 2], 6, 1, &level), linear),
        (ktx2_file(37, 1, [1; 2], 6, 2, &level), srgb),
        (ktx2_file(43, 1, [1; 2], 6, 2, &level), srgb),
        (unorm(28), linear),
        (unorm(29), srgb),
    ];
    for (index, (bytes, decode)) in cases.into_iter().enumerate() {
        let cube = files.read(&bytes).unwrap();
        assert!(cube.statement.transfer.unwrap().said.is_some(), "case {index}");
        assert_eq!(cube.faces[3].pixels[0], [decode(30.0), decode(128.0), decode(255.0)], "case {index}");
    }
    let wished =
        read_cube(&files.write(&unorm(28)), &Wishes { transfer: Some(Transfer::Srgb), ..Default::default() }).unwrap();
    assert_eq!(wished.faces[0].pixels[0][1], srgb(128.0));
}

#[test]
fn blocks_lie_in_rows_and_those_beyond_the_edge_are_clipped() {
    // A BC7 block in mode 5 with two equal end points: one colour. Bits: mode (6 of them), rotation 2, then 7-bit red, green, blue twice.
    let block = |code: u8| {
        let seven = u128::from(code >> 1);
        let mut bits = 1u128 << 5;
        for channel in 0..6 {
            bits |= seven << (8 + 7 * channel);
        }
        bits.to_le_bytes().to_vec()
    };
    // 6×6 texels are 2×2 blocks a face.
    let faces: Vec<u8> = (0..6).flat_map(|_| [0, 84, 168, 254].into_iter().flat_map(block)).collect();
    let bytes = [dds_header([6; 2], 1, CUBE, b"DX10", Some(98)), faces].concat();
    let cube = Files::new().read(&bytes).unwrap();
    let code = |x: u32, y: u32| (cube.faces[5].pixel(x, y)[1] * 255.0).round() as i32;
    // Seven bits become eight by repeating the top one.
    assert_eq!([code(0, 0), code(5, 0), code(0, 5), code(5, 5)], [0, 84, 169, 255]);
    assert_eq!([code(3, 3), code(4, 3), code(3, 4), code(4, 4)], [0, 84, 169, 255]);
}

#[test]
fn files_of_other_kinds_are_named() {
    let files = Files::new();
    let error = |bytes: &[u8]| files.read(bytes).unwrap_err().to_string();
    assert!(error(b"\x89PNG").contains("neither a KTX2 nor a DDS"));
    let mut flat = dds_header([4; 2], 1, CUBE, b"DX10", Some(10));
    flat[112] = 0;
    flat[113] = 0;
    flat[136] = 0;
    assert!(error(&flat).contains("no single cube map"), "{}", error(&flat));
    assert!(error(&[dds_header([4; 2], 1, CUBE, b"UYVY", None), vec![0; 192]].concat()).contains("UYVY"));
    assert!(error(&ktx2_file(97, 2, [4; 2], 6, 1, &half_faces(4, 1)[..700])).contains("it ends within face 5"));
    assert!(error(&dds_header([4097; 2], 1, CUBE, b"DX10", Some(10))).contains("4097×4097"));
    assert!(error(&ktx2_file(140, 1, [4; 2], 6, 2, &[0; 48])).contains("BC4_SNORM"));
    let infinite = [f16::INFINITY.to_le_bytes(); 24].concat();
    assert!(error(&ktx2_file(97, 2, [1; 2], 6, 1, &infinite)).contains("not finite at face 0, pixel (0, 0)"));
}

#[test]
fn damaged_cube_maps_are_errors_and_no_panics() {
    let files = Files::new();
    let whole = [
        [dds_header([4; 2], 3, CUBE, b"DX10", Some(10)), half_faces(4, 3)].concat(),
        [dds_header([4; 2], 1, CUBE, b"DX10", Some(95)), vec![0xa5; 96]].concat(),
        ktx2_file(97, 2, [4; 2], 6, 1, &half_faces(4, 1)),
        ktx2_file(145, 1, [4; 2], 6, 2, &[0x5a; 96]),
    ];
    let mut random = SplitMix64::new(11);
    for bytes in whole {
        assert!(files.read(&bytes).is_ok());
        for length in (0..bytes.len().min(200)).chain([bytes.len() - 200]) {
            // A file that is only shorter by lower levels or padding may be read.
            let _ = files.read(&bytes[..length]);
        }
        for _ in 0..300 {
            let mut altered = bytes.clone();
            for _ in 0..=random.next_u64() % 3 {
                let place = (random.next_u64() % altered.len().min(200) as u64) as usize;
                altered[place] = (random.next_u64() >> 32) as u8;
            }
            let _ = files.read(&altered);
        }
    }
}
