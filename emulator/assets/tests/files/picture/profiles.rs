//! ICC profiles by their numbers.

use super::words::{iccp_of, png};
use super::*;

/// The sRGB profile of LittleCMS, written by Pillow 13.0.0: `ImageCms.createProfile("sRGB")`.
const SRGB: &[u8] = include_bytes!("data/srgb.icc");

fn fixed(number: f64) -> [u8; 4] {
    ((number * 65536.0).round() as i32).to_be_bytes()
}

/// A tag of a power with 8 fraction bits.
fn power(gamma: f64) -> Vec<u8> {
    [b"curv\0\0\0\0\0\0\0\x01", &((gamma * 256.0).round() as u16).to_be_bytes()[..]].concat()
}

/// A tag of a table.
fn table(count: u32, decode: fn(f64) -> f64) -> Vec<u8> {
    let code = |index: u32| (decode(f64::from(index) / f64::from(count - 1)) * 65535.0).round() as u16;
    let codes: Vec<u8> = (0..count).flat_map(|index| code(index).to_be_bytes()).collect();
    [&b"curv\0\0\0\0"[..], &count.to_be_bytes(), &codes].concat()
}

/// A tag of parameters.
fn parameters(form: u8, numbers: &[f64]) -> Vec<u8> {
    let numbers: Vec<u8> = numbers.iter().flat_map(|number| fixed(*number)).collect();
    [&b"para\0\0\0\0\0"[..], &[form, 0, 0], &numbers].concat()
}

/// A profile of tags.
fn profile(space: &[u8; 4], tags: &[([u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut bytes = vec![0; 128];
    bytes[8] = 4;
    bytes[12..16].copy_from_slice(b"mntr");
    bytes[16..20].copy_from_slice(space);
    bytes[36..40].copy_from_slice(b"acsp");
    bytes.extend((tags.len() as u32).to_be_bytes());
    let mut offset = 132 + 12 * tags.len();
    for (name, content) in tags {
        bytes.extend([&name[..], &(offset as u32).to_be_bytes(), &(content.len() as u32).to_be_bytes()].concat());
        offset += content.len();
    }
    bytes.extend(tags.iter().flat_map(|(_, content)| content.clone()));
    let length = (bytes.len() as u32).to_be_bytes();
    bytes[..4].copy_from_slice(&length);
    bytes
}

/// A profile of a display: red, green and blue under D50, and one curve.
fn display(colours: [[f64; 3]; 3], curve: &[u8]) -> Vec<u8> {
    let xyz = |colour: [f64; 3]| [&b"XYZ \0\0\0\0"[..], &colour.map(fixed).concat()].concat();
    let names = [*b"rXYZ", *b"gXYZ", *b"bXYZ"].into_iter().zip(colours.map(xyz));
    let curves = [*b"rTRC", *b"gTRC", *b"bTRC"].map(|name| (name, curve.to_vec()));
    profile(b"RGB ", &names.chain(curves).collect::<Vec<_>>())
}

const REC_709: [[f64; 3]; 3] = [[0.43604, 0.22248, 0.01392], [0.38511, 0.71691, 0.09707], [0.14305, 0.06061, 0.71391]];
const P3: [[f64; 3]; 3] = [[0.51512, 0.24119, -0.00105], [0.29198, 0.69224, 0.04188], [0.1571, 0.06657, 0.78407]];
const ADOBE: [[f64; 3]; 3] = [[0.60974, 0.31111, 0.01947], [0.20527, 0.62568, 0.06087], [0.14919, 0.06321, 0.74456]];
const REC_2020: [[f64; 3]; 3] =
    [[0.67348, 0.27904, -0.00193], [0.16567, 0.67534, 0.02998], [0.12505, 0.04561, 0.79685]];
const PROPHOTO: [[f64; 3]; 3] = [[0.79772, 0.28805, 0.0], [0.13516, 0.71187, 1e-5], [0.03132, 8e-5, 0.82489]];
const ACESCG: [[f64; 3]; 3] = [[0.68988, 0.28451, -0.00605], [0.14976, 0.67169, 0.01001], [0.12456, 0.0438, 0.82094]];
const WIDE: [[f64; 3]; 3] = [[0.71646, 0.25871, 0.0], [0.101, 0.72471, 0.05121], [0.14674, 0.01658, 0.77369]];
const COLORMATCH: [[f64; 3]; 3] =
    [[0.50944, 0.27494, 0.02425], [0.32084, 0.65809, 0.10876], [0.13392, 0.06697, 0.69189]];
const APPLE: [[f64; 3]; 3] = [[0.47554, 0.25516, 0.01845], [0.33971, 0.67259, 0.11333], [0.14895, 0.07225, 0.69312]];
const CINEMA: [[f64; 3]; 3] = [[0.48616, 0.22668, -0.0008], [0.32385, 0.71033, 0.04324], [0.15419, 0.06298, 0.78247]];
const BEST: [[f64; 3]; 3] = [[0.63186, 0.22758, 0.0], [0.20536, 0.73842, 0.01003], [0.12698, 0.03399, 0.81487]];

fn srgb(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Primaries, curves, and the light of the code (0.75, 0.25, 0.5) in Rec. 709, computed by colour-science 0.4.7 with Bradford's adaptation.
#[test]
fn profiles_of_displays_are_read_by_their_numbers() {
    // IEC 61966-2-1 as parameters of form 3.
    let of_srgb = parameters(3, &[2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045]);
    let of_camera = parameters(3, &[1.0 / 0.45, 1.0 / 1.099, 0.099 / 1.099, 1.0 / 4.5, 0.081]);
    let right_srgb = [0.522_522, 0.050_876, 0.214_041];
    type Case<'a> = (&'a str, Vec<u8>, [f64; 3], &'a str, &'a str);
    let cases: [Case<'_>; 19] = [
        ("LittleCMS", SRGB.to_vec(), right_srgb, "Rec. 709", "sRGB"),
        ("sRGB, parameters", display(REC_709, &of_srgb), right_srgb, "Rec. 709", "sRGB"),
        ("sRGB, a table of 1024", display(REC_709, &table(1024, srgb)), right_srgb, "Rec. 709", "sRGB"),
        ("sRGB, a table of 26", display(REC_709, &table(26, srgb)), right_srgb, "Rec. 709", "sRGB"),
        ("Rec. 709's camera", display(REC_709, &of_camera), [0.563_522, 0.078_154, 0.259_589], "Rec. 709", "Rec. 709"),
        (
            "linear by an empty table",
            display(REC_709, b"curv\0\0\0\0\0\0\0\0"),
            [0.75, 0.25, 0.5],
            "Rec. 709",
            "linear",
        ),
        ("linear by a power", display(REC_709, &power(1.0)), [0.75, 0.25, 0.5], "Rec. 709", "linear"),
        ("linear by a table", display(REC_709, &table(2, |x| x)), [0.75, 0.25, 0.5], "Rec. 709", "linear"),
        (
            "Display P3",
            display(P3, &of_srgb),
            [0.628_614, 0.031_04, 0.220_814],
            "Display P3, converted to Rec. 709",
            "sRGB",
        ),
        (
            "Adobe RGB",
            display(ADOBE, &power(563.0 / 256.0)),
            [0.723_874, 0.047_417, 0.225_068],
            "Adobe RGB, converted to Rec. 709",
            "gamma 2.20",
        ),
        (
            "Rec. 2020",
            display(REC_2020, &parameters(0, &[2.2])),
            [0.838_113, -0.014_298, 0.229_075],
            "Rec. 2020, converted to Rec. 709",
            "gamma 2.20",
        ),
        (
            "ACEScg",
            display(ACESCG, &power(1.0)),
            [1.081_711, 0.182_235, 0.526_241],
            "ACEScg, converted to Rec. 709",
            "linear",
        ),
        ("ProPhoto", display(PROPHOTO, &power(1.8)), [1.064_01, -0.035_597, 0.315_908], "red (0.7347", "gamma 1.80"),
        ("wide gamut", display(WIDE, &power(2.2)), [0.940_229, -0.066_682, 0.229_99], "red (0.73", "gamma 2.20"),
        ("ColorMatch", display(COLORMATCH, &power(1.8)), [0.662_002, 0.101_539, 0.284_407], "red (0.6", "gamma 1.80"),
        ("an old Macintosh", display(APPLE, &power(1.8)), [0.633_114, 0.098_083, 0.281_622], "red (0.6", "gamma 1.80"),
        ("a cinema", display(CINEMA, &power(2.6)), [0.543_244, 0.008_13, 0.170_195], "red (0.6", "gamma 2.60"),
        (
            "Best RGB, a table",
            display(BEST, &table(4096, |x| x.powf(2.2))),
            [0.817_539, -0.046_267, 0.239_429],
            "red (0.7",
            "gamma 2.20",
        ),
        (
            "a power of the second form",
            display(BEST, &parameters(1, &[2.2, 1.0, 0.0])),
            [0.817_539, -0.046_267, 0.239_429],
            "red (0.7",
            "gamma 2.20",
        ),
    ];
    let directory = Directory::new().unwrap();
    for (kind, profile, expected, space, transfer) in cases {
        let path = directory.file("a.png", &png([49151, 16384, 32768], &[iccp_of(&profile)])).unwrap();
        let read = read(&path, Purpose::Environment, &Wishes::default()).unwrap();
        for (channel, expected) in read.picture.pixels[0].iter().zip(expected) {
            // Numbers of a profile have 16 bits, powers 8, and codes are within half of one.
            assert!((f64::from(*channel) - expected).abs() < 5e-4, "{kind}: {:?} {expected:?}", read.picture.pixels[0]);
        }
        let statement = read.statement;
        assert!(
            statement.colour_space.as_ref().unwrap().used.starts_with(space),
            "{kind}: {:?}",
            statement.colour_space
        );
        assert_eq!((statement.transfer.unwrap().used.as_str(), statement.warnings.len()), (transfer, 0), "{kind}");
    }
}

#[test]
fn profiles_that_cannot_be_followed_are_named_with_the_keys_that_decide() {
    let half = srgb(32768.0 / 65535.0);
    let steps = table(16, |x| (5.0 * x).floor() / 5.0);
    let mut two_curves = display(REC_709, &power(2.2));
    let last = two_curves.len() - 1;
    two_curves[last] += 90;
    let lab = profile(b"Lab ", &[(*b"A2B0", vec![0; 64])]);
    let grey = |curve: Vec<u8>| profile(b"GRAY", &[(*b"kTRC", curve)]);
    let cases: [(&str, Vec<u8>, f64, &[&str]); 11] = [
        ("steps", display(REC_709, &steps), half, &["`transfer` decides"]),
        ("another curve for blue", two_curves, half, &["`transfer` decides"]),
        ("tables of a printer", lab, half, &["`colour_space` and `transfer` decide"]),
        ("no tags", profile(b"RGB ", &[]), half, &["`colour_space` and `transfer` decide"]),
        (
            "a curve alone",
            display([[0.0; 3]; 3], &power(2.2))[..].to_vec(),
            0.5_f64.powf(2.2),
            &["`colour_space` decides"],
        ),
        ("a curve of another type", display(REC_709, b"sf32\0\0\0\0\0\0\0\0"), half, &["`transfer` decides"]),
        ("a curve of an unknown form", display(REC_709, &parameters(9, &[2.2])), half, &["`transfer` decides"]),
        ("a grey linear scanner", grey(power(1.0)), 0.5, &[]),
        ("a grey square", grey(power(2.0)), 0.25, &[]),
        ("grey steps", grey(steps), half, &["`transfer` decides"]),
        ("grey without a curve", profile(b"GRAY", &[]), half, &["`transfer` decides"]),
    ];
    let directory = Directory::new().unwrap();
    for (kind, profile, expected, parts) in cases {
        let path = directory.file("a.png", &png([32768; 3], &[iccp_of(&profile)])).unwrap();
        let found = read(&path, Purpose::Colours, &Wishes::default()).unwrap();
        let channel = f64::from(found.picture.pixels[0][0]);
        assert!((channel - expected).abs() < 2e-4, "{kind}: {channel} {expected}");
        assert_eq!(found.statement.warnings.len(), parts.len(), "{kind}: {:?}", found.statement.warnings);
        for (warning, part) in found.statement.warnings.iter().zip(parts) {
            assert!(warning.contains(part), "{kind}: {warning}");
        }
        // Numbers of a data map have no doubts.
        let data = read(&path, Purpose::Data, &Wishes::default()).unwrap();
        assert_eq!(
            (data.picture.pixels[0], data.statement.warnings.len()),
            ([(32768.0 / 65535.0) as f32; 3], 0),
            "{kind}"
        );
    }
}

#[test]
fn damaged_profiles_never_panic() {
    let directory = Directory::new().unwrap();
    let files = [
        display(P3, &table(26, srgb)),
        display(P3, &parameters(4, &[2.4, 1.0, 0.0, 1.0, 0.1, 0.0, 0.0])),
        SRGB.to_vec(),
    ];
    let read = |profile: &[u8]| {
        let path = directory.file("a.png", &png([9000; 3], &[iccp_of(profile)])).unwrap();
        read(&path, Purpose::Colours, &Wishes::default()).unwrap()
    };
    let mut random = SplitMix64::new(57);
    for whole in files {
        for end in 0..whole.len() {
            let _ = read(&whole[..end]);
        }
        for _ in 0..400 {
            let mut bytes = whole.clone();
            for _ in 0..=random.below(4) {
                let at = 128 + random.below(bytes.len() as u64 - 128) as usize;
                bytes[at] = if random.below(3) == 0 { 0xff } else { random.below(256) as u8 };
            }
            let found = read(&bytes);
            assert!(found.picture.pixels[0].iter().all(|channel| channel.is_finite()), "{found:?}");
        }
    }
}
