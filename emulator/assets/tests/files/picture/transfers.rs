//! Transfer functions against another program.

use super::words::{cicp, png};
use super::*;

/// 16-bit codes and their light by PQ and HLG, computed by colour-science 0.4.7: `eotf_ST2084(x) / 203`, and
/// `oetf_inverse_BT2100_HLG(x) / oetf_inverse_BT2100_HLG(0.75)`; then by the camera curve of Rec. 709, `oetf_inverse_BT709(x)`.
const LIGHT: [(u16, [f64; 3]); 14] = [
    (0, [0.0, 0.0, 0.0]),
    (655, [1.136_877_9e-5, 1.256_696e-4, 2.221_035_4e-3]),
    (4096, [4.956_853e-4, 4.914_366_3e-3, 1.388_910_1e-2]),
    (8191, [2.924_695e-3, 1.965_266_6e-2, 2.917_045_5e-2]),
    (16384, [2.539_139_3e-2, 7.862_986e-2, 7.815_577_4e-2]),
    (24576, [0.121_028_34, 0.176_917_19, 0.154_316_76]),
    (32768, [0.454_447_1, 0.314_519_44, 0.259_596_75]),
    (38000, [0.991_936_66, 0.441_123_39, 0.342_805_57]),
    (45000, [2.703_788, 0.728_433_49, 0.474_326_27]),
    (49151, [4.844_056_4, 0.999_980_58, 0.563_516_67]),
    (52000, [7.215_833_5, 1.250_524_3, 0.629_652_81]),
    (58000, [16.747_256, 2.026_704_2, 0.782_258_68]),
    (62000, [29.565_194, 2.814_705_2, 0.894_189_32]),
    (65535, [49.261_084, 3.774_118_2, 1.0]),
];

#[test]
fn pq_hlg_and_camera_codes_have_the_light_of_their_definitions() {
    let directory = Directory::new().unwrap();
    for (code, expected) in LIGHT {
        let curves = [("PQ", 16, Transfer::Pq), ("HLG", 18, Transfer::Hlg), ("Rec. 709", 1, Transfer::Bt709)];
        for ((name, number, transfer), expected) in curves.into_iter().zip(expected) {
            let close = |bytes: &[u8], wishes: &Wishes| {
                let path = directory.file("a.png", bytes).unwrap();
                let read = read(&path, Purpose::Environment, wishes).unwrap();
                for channel in read.picture.pixels[0].map(f64::from) {
                    assert!(
                        (channel - expected).abs() <= 2e-6 * expected + 1e-9,
                        "{name} {code}: {channel} {expected}"
                    );
                }
                assert_eq!(read.statement.transfer.unwrap().used, name);
            };
            close(&png([code; 3], &[cicp(1, number)]), &Wishes::default());
            close(&png([code; 3], &[]), &Wishes { transfer: Some(transfer), ..Wishes::default() });
        }
    }
}

#[test]
fn floats_beyond_the_codes_are_decoded_and_mirrored_below_zero() {
    // An OpenEXR file may hold codes, too; sRGB goes on above 1 (IEC 61966-2-1, amendment 1: the extended curve).
    let directory = Directory::new().unwrap();
    for (transfer, x, expected) in [
        (Transfer::Srgb, -0.5, -0.214_041_14),
        (Transfer::Srgb, 1.5, 2.537_155_3),
        (Transfer::Srgb, 0.04, 0.04 / 12.92),
        (Transfer::Pq, -0.5, -92.245_709 / 203.0),
        (Transfer::Pq, 2.0, 10_000.0 / 203.0),
        (Transfer::Hlg, -0.5, -0.314_509_84),
        (Transfer::Bt709, -0.08, -0.08 / 4.5),
        (Transfer::Gamma(2.2), -0.5, -0.217_637_64),
        (Transfer::Gamma(1.8), 2.0, 3.482_202_25),
        (Transfer::Linear, -7.5, -7.5),
    ] {
        let bytes = exr_bytes(1, &[("Y", vec![x])], ExrEncoding::default()).unwrap();
        let path = directory.file("a.exr", &bytes).unwrap();
        let wishes = Wishes { transfer: Some(transfer), ..Wishes::default() };
        let found = f64::from(read(&path, Purpose::Environment, &wishes).unwrap().picture.pixels[0][0]);
        // A half float has 11 bits, and a power of up to 13 multiplies its error.
        assert!((found - expected).abs() <= 3e-3 * expected.abs(), "{transfer:?} {x}: {found} {expected}");
    }
}
