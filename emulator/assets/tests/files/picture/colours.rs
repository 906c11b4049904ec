//! Colour spaces of OpenEXR files by their chromaticities and names.

use exr::meta::attribute::{AttributeValue, Chromaticities, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, Layer, LayerAttributes, Vec2, WritableImage,
};

use super::*;

/// The colour of all files.
const COLOUR: [f32; 3] = [0.75, 0.25, 0.5];

/// A file of one pixel.
fn file(chromaticities: Option<[f32; 8]>, words: &[(&str, &str)]) -> Vec<u8> {
    let channels = ["B", "G", "R"].into_iter().zip([COLOUR[2], COLOUR[1], COLOUR[0]]);
    let channels = channels.map(|(name, value)| AnyChannel::new(name, FlatSamples::F32(vec![value]))).collect();
    let mut layer = Layer::new((1, 1), LayerAttributes::named(""), Encoding::default(), AnyChannels::sort(channels));
    for (name, value) in words {
        layer.attributes.other.insert(Text::from(*name), AttributeValue::Text(Text::from(*value)));
    }
    let mut attributes = ImageAttributes::with_size((1, 1));
    attributes.chromaticities = chromaticities.map(|[a, b, c, d, e, f, x, y]| Chromaticities {
        red: Vec2(a, b),
        green: Vec2(c, d),
        blue: Vec2(e, f),
        white: Vec2(x, y),
    });
    let mut bytes = io::Cursor::new(Vec::new());
    Image::from_layers(attributes, vec![layer]).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn read_file(bytes: &[u8], purpose: Purpose) -> PictureFile {
    let directory = Directory::new().unwrap();
    read(&directory.file("a.exr", bytes).unwrap(), purpose, &Wishes::default()).unwrap()
}

fn check(kind: &str, read: &PictureFile, expected: [f64; 3], tolerance: f64) {
    for (found, expected) in read.picture.pixels[0].iter().zip(expected) {
        assert!((f64::from(*found) - expected).abs() < tolerance, "{kind}: {:?} {expected}", read.picture.pixels[0]);
    }
}

/// Spaces without a name here, and their matrices to Rec. 709 with Bradford's adaptation, computed by colour-science 0.4.7.
#[test]
fn chromaticities_without_a_name_are_converted_as_they_are() {
    type Space<'a> = (&'a str, [f32; 8], [[f64; 3]; 3]);
    let table: [Space<'_>; 6] = [
        (
            "PAL",
            [0.64, 0.33, 0.29, 0.6, 0.15, 0.06, 0.3127, 0.329],
            [[1.044, -0.044, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0118, 0.9882]],
        ),
        (
            "SMPTE C",
            [0.63, 0.34, 0.31, 0.595, 0.155, 0.07, 0.3127, 0.329],
            [[0.9395, 0.0502, 0.0103], [0.0178, 0.9658, 0.0164], [-0.0016, -0.0044, 1.006]],
        ),
        (
            "ProPhoto",
            [0.7347, 0.2653, 0.1596, 0.8404, 0.0366, 0.0001, 0.3457, 0.3585],
            [[2.0344, -0.7276, -0.3067], [-0.2288, 1.2318, -0.0029], [-0.0086, -0.1533, 1.1618]],
        ),
        (
            "a cinema",
            [0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.314, 0.351],
            [[1.1575, -0.155, -0.0026], [-0.0415, 1.0456, -0.0041], [-0.0181, -0.0786, 1.0966]],
        ),
        (
            "CIE RGB",
            [0.734_743, 0.265_257, 0.273_779, 0.717_478, 0.166_556, 0.008_911, 0.333_333, 0.333_333],
            [[1.2471, -0.3831, 0.1361], [-0.1418, 1.2806, -0.1388], [-0.0068, -0.1432, 1.15]],
        ),
        (
            "wide gamut",
            [0.7347, 0.2653, 0.1152, 0.8264, 0.1566, 0.0177, 0.3457, 0.3585],
            [[1.8271, -0.8806, 0.0535], [-0.2055, 1.2915, -0.086], [-0.0077, -0.0867, 1.0944]],
        ),
    ];
    for (kind, chromaticities, matrix) in table {
        let read = read_file(&file(Some(chromaticities), &[]), Purpose::Environment);
        let colour = COLOUR.map(f64::from);
        check(kind, &read, matrix.map(|row| row.iter().zip(colour).map(|(a, b)| a * b).sum()), 2e-4);
        let used = read.statement.colour_space.unwrap().used;
        assert!(used.starts_with("red (") && used.ends_with("converted to Rec. 709"), "{kind}: {used}");
        assert_eq!(read_file(&file(Some(chromaticities), &[]), Purpose::Heights).picture.pixels, [COLOUR], "{kind}");
    }
}

/// Names of the Color Interop Forum, and the light in Rec. 709 computed by colour-science 0.4.7.
#[test]
fn names_of_colour_spaces_decide_primaries_and_curve() {
    for (name, expected) in [
        ("lin_rec709_scene", [0.75, 0.25, 0.5]),
        ("lin_ap1_scene", [1.081_711, 0.182_235, 0.526_241]),
        ("lin_ap0_scene", [1.413_954, 0.087_7, 0.534_399]),
        ("lin_rec2020_scene", [1.062_033, 0.185_637, 0.520_607]),
        ("lin_p3d65_scene", [0.862_47, 0.228_972, 0.514_75]),
        ("lin_adobergb_scene", [0.949_178, 0.25, 0.510_732]),
        ("srgb_rec709_scene", [0.522_522, 0.050_876, 0.214_041]),
        ("srgb_p3d65_display", [0.628_614, 0.031_04, 0.220_814]),
        ("srgb_ap1_scene", [0.841_471, -0.012_28, 0.227_68]),
        ("g22_rec709_scene", [0.531_049, 0.047_366, 0.217_638]),
        ("g18_rec709_scene", [0.595_813, 0.082_469, 0.287_175]),
        ("g22_ap1_scene", [0.857_894, -0.017_433, 0.232_074]),
        ("pq_rec2020_display", [7.995_769, -0.578_38, 0.417_884]),
        ("hlg_rec2020_display", [1.591_374, -0.038_099, 0.325_792]),
        ("data", [0.75, 0.25, 0.5]),
    ] {
        for attribute in ["colorInteropID", "oiio:ColorSpace"] {
            let read = read_file(&file(None, &[(attribute, name)]), Purpose::Environment);
            check(name, &read, expected, 5e-4);
            assert!(read.statement.ignored.is_empty() && read.statement.warnings.is_empty(), "{name}");
        }
        let data = read_file(&file(None, &[("colorInteropID", name)]), Purpose::Data);
        assert_eq!(data.picture.pixels, [COLOUR], "{name}");
    }
    // The name of the forum has precedence over an older one, and chromaticities over both.
    let words = [("colorInteropID", "lin_rec2020_scene"), ("oiio:ColorSpace", "srgb_ap1_scene")];
    check("both", &read_file(&file(None, &words), Purpose::Colours), [1.062_033, 0.185_637, 0.520_607], 5e-4);
    let rec_709 = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
    let both = read_file(&file(Some(rec_709), &words[..1]), Purpose::Colours);
    check("chromaticities", &both, [0.75, 0.25, 0.5], 1e-6);
}
