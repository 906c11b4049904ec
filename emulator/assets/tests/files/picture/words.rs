//! PNGs that say how they are meant.

use super::*;

/// Check sum of a chunk: CRC-32 of its name and data.
fn crc(bytes: impl Iterator<Item = u8>) -> u32 {
    !bytes.fold(!0_u32, |sum, byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 })
    })
}

pub(super) fn chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let sum = crc(name.iter().chain(data).copied());
    [&(data.len() as u32).to_be_bytes()[..], name, data, &sum.to_be_bytes()].concat()
}

/// Bytes in the format of zlib, not compressed.
fn stored(data: &[u8]) -> Vec<u8> {
    let (a, b) = data.iter().fold((1_u32, 0_u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    let length = data.len() as u16;
    [&[0x78, 1, 1][..], &length.to_le_bytes(), &(!length).to_le_bytes(), data, &(b << 16 | a).to_be_bytes()].concat()
}

/// An ICC profile that has a name alone, as version 2 or 4 writes it.
pub(super) fn profile(name: &str, version: u8) -> Vec<u8> {
    let text: Vec<u8> = if version == 2 {
        [b"desc\0\0\0\0", &(name.len() as u32 + 1).to_be_bytes()[..], name.as_bytes(), b"\0"].concat()
    } else {
        let units: Vec<u8> = name.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let numbers = [1_u32, 12, 0x656e_5553, units.len() as u32, 28].map(u32::to_be_bytes).concat();
        [&b"mluc\0\0\0\0"[..], &numbers, &units].concat()
    };
    let mut bytes = vec![0; 128];
    bytes.extend([1_u32, u32::from_be_bytes(*b"desc"), 144, text.len() as u32].map(u32::to_be_bytes).concat());
    bytes.extend(text);
    let length = (bytes.len() as u32).to_be_bytes();
    bytes[..4].copy_from_slice(&length);
    bytes[8] = version;
    bytes[12..20].copy_from_slice(b"mntrRGB ");
    bytes[36..40].copy_from_slice(b"acsp");
    bytes
}

/// A PNG of one 16-bit colour with chunks in front of its pixels.
pub(super) fn png(colour: [u16; 3], chunks: &[Vec<u8>]) -> Vec<u8> {
    let samples = colour.map(u16::to_be_bytes).concat();
    let plain = png_bytes((1, 1), ColorType::Rgb, BitDepth::Sixteen, None, &samples).unwrap();
    // The signature has 8 bytes, the header chunk 25.
    [&plain[..33], &chunks.concat(), &plain[33..]].concat()
}

pub(super) fn gama(gamma: f64) -> Vec<u8> {
    chunk(b"gAMA", &((gamma * 1e5).round() as u32).to_be_bytes())
}

fn chrm(numbers: [f64; 8]) -> Vec<u8> {
    let [xr, yr, xg, yg, xb, yb, xw, yw] = numbers.map(|number| ((number * 1e5).round() as u32).to_be_bytes());
    chunk(b"cHRM", &[xw, yw, xr, yr, xg, yg, xb, yb].concat())
}

pub(super) fn cicp(primaries: u8, transfer: u8) -> Vec<u8> {
    chunk(b"cICP", &[primaries, transfer, 0, 1])
}

pub(super) fn iccp_of(profile: &[u8]) -> Vec<u8> {
    chunk(b"iCCP", &[b"icc\0\0", &stored(profile)[..]].concat())
}

fn iccp(name: &str, version: u8) -> Vec<u8> {
    iccp_of(&profile(name, version))
}

fn srgb() -> Vec<u8> {
    chunk(b"sRGB", &[0])
}

const ADOBE: [f64; 8] = [0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.329];
const REC_709: [f64; 8] = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];

#[test]
fn the_chunk_of_highest_precedence_decides() {
    // A grey of code 0.5 stays grey in all spaces, so the curve alone counts.
    let srgb_half = ((0.5_f64 + 0.055) / 1.055).powf(2.4);
    let power = |gamma: f64| 0.5_f64.powf(gamma);
    let camera = ((0.5_f64 + 0.099) / 1.099).powf(1.0 / 0.45);
    // Perceptual quantiser of 0.5: 92.2457 cd/m², a published value. Hybrid log-gamma: x²/3 against its value at 0.75.
    let pq = 92.2457 / 203.0;
    let hlg = (0.25 / 3.0) / ((((0.75_f64 - 0.559_910_73) / 0.178_832_77).exp() + 0.284_668_92) / 12.0);
    let table: [(&str, Vec<Vec<u8>>, f64, usize); 28] = [
        ("nothing", vec![], srgb_half, 0),
        ("sRGB", vec![srgb()], srgb_half, 0),
        ("sRGB before gAMA", vec![gama(1.0), srgb()], srgb_half, 0),
        ("gAMA 1", vec![gama(1.0)], 0.5, 0),
        ("gAMA of sRGB", vec![gama(0.45455)], srgb_half, 0),
        ("gAMA of sRGB, rounded otherwise", vec![gama(0.45454)], srgb_half, 0),
        ("gAMA of an old Macintosh", vec![gama(0.55556)], power(1.0 / 0.55556), 0),
        ("gAMA of a camera", vec![gama(0.45)], power(1.0 / 0.45), 0),
        ("gAMA of a projector", vec![gama(0.38462)], power(2.6), 0),
        ("gAMA of a square", vec![gama(0.5)], 0.25, 0),
        ("gAMA above 1", vec![gama(2.0)], power(0.5), 0),
        ("gAMA with cHRM", vec![gama(1.0), chrm(REC_709)], 0.5, 0),
        ("gAMA with another cHRM", vec![gama(1.0), chrm(ADOBE)], 0.5, 0),
        ("cHRM alone", vec![chrm(ADOBE)], srgb_half, 0),
        ("cICP linear", vec![cicp(1, 8)], 0.5, 0),
        ("cICP sRGB", vec![cicp(1, 13)], srgb_half, 0),
        ("cICP before gAMA", vec![cicp(1, 8), gama(0.45455)], 0.5, 0),
        ("cICP before sRGB", vec![cicp(12, 8), srgb()], 0.5, 0),
        ("cICP before iCCP", vec![cicp(1, 8), iccp("sRGB", 2)], 0.5, 0),
        ("cICP gamma 2.2", vec![cicp(1, 4)], power(2.2), 0),
        ("cICP Rec. 709", vec![cicp(1, 1)], camera, 1),
        ("cICP PQ", vec![cicp(9, 16)], pq, 1),
        ("cICP HLG", vec![cicp(9, 18)], hlg, 1),
        ("cICP of no known curve", vec![cicp(1, 99)], srgb_half, 1),
        ("iCCP sRGB", vec![iccp("sRGB IEC61966-2.1", 2)], srgb_half, 0),
        ("iCCP Adobe RGB before gAMA", vec![iccp("Adobe RGB (1998)", 2), gama(1.0)], power(563.0 / 256.0), 0),
        ("iCCP Display P3", vec![iccp("Display P3", 4)], srgb_half, 0),
        ("iCCP of another kind", vec![iccp("Dot Gain 20%", 4)], srgb_half, 1),
    ];
    let directory = Directory::new().unwrap();
    for (kind, chunks, expected, warnings) in table {
        let path = directory.file("a.png", &png([32768; 3], &chunks)).unwrap();
        let read = |purpose, wishes: &Wishes| read(&path, purpose, wishes).unwrap();
        let colours = read(Purpose::Colours, &Wishes::default());
        for channel in colours.picture.pixels[0] {
            // Half a code, and the gamma of one, are within 4e-5.
            assert!((f64::from(channel) - expected).abs() < 1e-4, "{kind}: {channel} {expected}");
        }
        let found = &colours.statement.warnings;
        assert_eq!(found.len(), warnings, "{kind}: {found:?}");
        assert!(found.iter().all(|warning| warning.contains("`transfer`")), "{found:?}");
        let data = read(Purpose::Data, &Wishes::default());
        assert_eq!(data.picture.pixels[0], [(32768.0 / 65535.0) as f32; 3], "{kind}");
        let wished = read(Purpose::Environment, &Wishes { transfer: Some(Transfer::Linear), ..Wishes::default() });
        assert!((wished.picture.pixels[0][1] - 0.5).abs() < 1e-4, "{kind}");
    }
}

#[test]
fn primaries_are_converted_and_a_statement_says_so() {
    let directory = Directory::new().unwrap();
    let read = |chunks: &[Vec<u8>], purpose| {
        let path = directory.file("a.png", &png([65535, 0, 0], chunks)).unwrap();
        read(&path, purpose, &Wishes::default()).unwrap()
    };
    // The red of each space in linear Rec. 709: the first column of the published matrices.
    for (kind, chunks, red) in [
        ("cHRM of Adobe RGB", vec![gama(1.0), chrm(ADOBE)], [1.3984, 0.0, 0.0]),
        ("cICP Rec. 2020", vec![cicp(9, 8)], [1.6605, -0.1246, -0.0182]),
        ("cICP Display P3", vec![cicp(12, 13)], [1.2249, -0.0420, -0.0197]),
        ("iCCP Display P3", vec![iccp("Display P3", 2)], [1.2249, -0.0420, -0.0197]),
        ("cHRM of Rec. 709", vec![chrm(REC_709)], [1.0, 0.0, 0.0]),
        ("sRGB before cHRM", vec![srgb(), chrm(ADOBE)], [1.0, 0.0, 0.0]),
    ] {
        let found = read(&chunks, Purpose::Colours);
        for (channel, expected) in found.picture.pixels[0].iter().zip(red) {
            assert!((channel - expected).abs() < 2e-4, "{kind}: {:?}", found.picture.pixels[0]);
        }
        assert_eq!(read(&chunks, Purpose::Heights).picture.pixels[0], [1.0, 0.0, 0.0], "{kind}");
    }
    let statement = read(&[gama(1.0), chrm(ADOBE)], Purpose::Environment).statement;
    let said = |said: &str, used: &str| Some(Said { said: Some(said.into()), used: used.into() });
    assert_eq!(statement.colour_space, said("cHRM of Adobe RGB", "Adobe RGB, converted to Rec. 709"));
    assert_eq!(statement.transfer, said("gAMA 1.00000", "linear"));
    let statement = read(&[gama(0.45455)], Purpose::Heights).statement;
    assert!(statement.ignored[0].starts_with("gAMA 0.45455: a transfer function has no meaning"), "{statement:?}");
    assert_eq!(statement.transfer, None);
}

#[test]
fn damaged_words_never_panic() {
    let directory = Directory::new().unwrap();
    let whole = profile("A name of a profile", 4);
    for end in 0..whole.len() {
        let data = [b"icc\0\0", &stored(&whole[..end])[..]].concat();
        let path = directory.file("a.png", &png([1, 2, 3], &[chunk(b"iCCP", &data)])).unwrap();
        // The decoder leaves out a profile that is damaged.
        assert!(read(&path, Purpose::Colours, &Wishes::default()).is_ok(), "{end}");
    }
    let mut random = SplitMix64::new(7);
    for _ in 0..300 {
        let mut bytes = png([1, 2, 3], &[gama(0.5), chrm(ADOBE), iccp("Display P3", 2), cicp(9, 16)]);
        for _ in 0..4 {
            let at = random.below(bytes.len() as u64) as usize;
            bytes[at] = random.below(256) as u8;
        }
        let _ = read(&directory.file("a.png", &bytes).unwrap(), Purpose::Colours, &Wishes::default());
    }
}

#[test]
fn two_channels_and_grey_as_normals() {
    let directory = Directory::new().unwrap();
    let read = |samples: &[u8], purpose| {
        let bytes = png_bytes((2, 1), ColorType::Rgb, BitDepth::Eight, None, samples).unwrap();
        read(&directory.file("a.png", &bytes).unwrap(), purpose, &Wishes::default())
    };
    // Codes 128 ± 127 mean ±1.
    for blue in [0, 128, 255] {
        let found = read(&[128, 128, blue, 204, 52, blue], Purpose::Normals).unwrap();
        let (x, y) = (76.0 / 127.0, -76.0 / 127.0);
        let z = f64::sqrt(1.0 - x * x - y * y);
        assert_eq!((found.statement.signed, found.statement.left.len()), (Some(true), 1), "{blue}");
        assert_eq!(found.picture.pixels, [[0.0, 0.0, 1.0], [x, y, z].map(|v| v as f32)], "{blue}");
    }
    // A blue that belongs to unit normals stays.
    let tilted = read(&[204, 128, 230, 52, 128, 230], Purpose::Normals).unwrap();
    assert_eq!((tilted.statement.signed, tilted.picture.pixels[0][2]), (Some(false), (230.0 / 255.0_f64) as f32));
    let grey = read(&[10, 10, 10, 200, 200, 200], Purpose::Normals);
    assert!(fails(grey, "use it as `height_map`"));
}
