//! OpenEXR files of many programs: layers, windows, signs, colour spaces, and kinds that are not read.

use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, Chromaticities, EnvironmentMap, IntegerBounds, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, Layer, LayerAttributes, WritableImage,
};

use super::*;

/// One part: its name, and channels with one value each.
type Part<'a> = (&'a str, &'a [(&'a str, f32)]);

fn layer(name: &str, size: [usize; 2], channels: &[(&str, Vec<f32>)]) -> Layer<AnyChannels<FlatSamples>> {
    let channel = |(name, samples): &(&str, Vec<f32>)| AnyChannel::new(*name, FlatSamples::F32(samples.clone()));
    let list = channels.iter().map(channel).collect();
    Layer::new((size[0], size[1]), LayerAttributes::named(name), Encoding::default(), AnyChannels::sort(list))
}

fn bytes_of(attributes: ImageAttributes, layers: Vec<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
    let mut bytes = io::Cursor::new(Vec::new());
    Image::from_layers(attributes, layers).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// A file of 2×2 pixels of one colour.
pub(super) fn parts(parts: &[Part<'_>]) -> Vec<u8> {
    let flat = |(name, channels): &Part<'_>| {
        let channels: Vec<_> = channels.iter().map(|(name, value)| (*name, vec![*value; 4])).collect();
        layer(name, [2, 2], &channels)
    };
    bytes_of(ImageAttributes::with_size((2, 2)), parts.iter().map(flat).collect())
}

pub(super) fn read_bytes(bytes: &[u8], purpose: Purpose, wishes: &Wishes) -> Result<PictureFile, PictureError> {
    let directory = Directory::new().unwrap();
    read(&directory.file("a.exr", bytes).unwrap(), purpose, wishes)
}

const RGB: [(&str, f32); 3] = [("R", 0.5), ("G", 0.25), ("B", 0.125)];
const COLOUR: Result<[f32; 3], &str> = Ok([0.5, 0.25, 0.125]);

/// Kind, file, use, key `layer`, and the first pixel or a part of the message.
type Case<'a> = (&'a str, &'a [Part<'a>], Purpose, Option<&'a str>, Result<[f32; 3], &'a str>);

#[test]
fn the_right_layer_is_taken_or_all_are_listed() {
    use Purpose::{Colours, Data, Environment, Heights, Normals};
    let depth: Part<'_> = ("depth", &[("Z", 0.9)]);
    let blender: &[Part<'_>] = &[
        ("ViewLayer.Depth", &[("ViewLayer.Depth.Z", 1e10)]),
        ("ViewLayer.Normal", &[("ViewLayer.Normal.X", 0.0), ("ViewLayer.Normal.Y", -0.6), ("ViewLayer.Normal.Z", 0.8)]),
        (
            "ViewLayer.Combined",
            &[
                ("ViewLayer.Combined.R", 0.5),
                ("ViewLayer.Combined.G", 0.25),
                ("ViewLayer.Combined.B", 0.125),
                ("ViewLayer.Combined.A", 1.0),
            ],
        ),
    ];
    let single: Vec<(&str, f32)> = blender.iter().flat_map(|(_, channels)| channels.iter().copied()).collect();
    let single: &[Part<'_>] = &[("", &single)];
    let aovs: &[Part<'_>] = &[(
        "",
        &[("albedo.R", 1.0), ("albedo.G", 1.0), ("albedo.B", 1.0), ("R", 0.5), ("G", 0.25), ("B", 0.125), ("Z", 9.0)],
    )];
    let twins: &[Part<'_>] =
        &[("left", &[("R", 0.0), ("G", 0.0), ("B", 0.0)]), ("right", &[("R", 0.5), ("G", 0.25), ("B", 0.125)])];
    let beauty: &[Part<'_>] = &[("albedo", &[("R", 1.0), ("G", 1.0), ("B", 1.0)]), ("beauty", &RGB)];
    let nuke: &[Part<'_>] = &[("", &[("diffuse.red", 0.5), ("diffuse.green", 0.25), ("diffuse.blue", 0.125)])];
    let vector: &[Part<'_>] = &[("", &[("X", 0.0), ("Y", -0.6), ("Z", 0.8)])];
    let normal = Ok([0.0, -0.6, 0.8]);
    let cases: &[Case<'_>] = &[
        ("a part of depth before the colours", &[depth, ("rgba", &RGB)], Colours, None, COLOUR),
        ("colours before a part of depth", &[("rgba", &RGB), depth], Environment, None, COLOUR),
        ("Blender, a part for each pass", blender, Colours, None, COLOUR),
        ("Blender, one part", single, Environment, None, COLOUR),
        ("Blender, its normals", blender, Normals, None, normal),
        ("Blender, its normals in one part", single, Normals, None, normal),
        ("Blender, depth by name", blender, Colours, Some("ViewLayer.Depth.Z"), Ok([1e10; 3])),
        ("Blender, depth by the name of its pass", single, Colours, Some("Depth"), Ok([1e10; 3])),
        ("Blender, a pass that is not there", single, Colours, Some("Mist"), Err("ViewLayer.Normal")),
        ("other outputs beside the colours", aovs, Colours, None, COLOUR),
        ("another output by name", aovs, Colours, Some("albedo"), Ok([1.0; 3])),
        ("one channel by name", aovs, Colours, Some("albedo.G"), Ok([1.0; 3])),
        ("the main part by its name", beauty, Colours, None, COLOUR),
        ("two equal parts", twins, Colours, None, Err("B, G, R (layer `left`); ")),
        ("two equal parts, one by name", twins, Colours, Some("right"), COLOUR),
        ("Nuke's names of channels", nuke, Colours, None, COLOUR),
        ("depth alone is no colour", &[depth], Colours, None, Err("Z (no layer)")),
        ("depth alone is heights", &[depth], Heights, None, Ok([0.9; 3])),
        ("a vector is no colour", vector, Colours, None, Err("X, Y, Z (no layer)")),
        ("a vector is a normal", vector, Normals, None, normal),
        ("luminance", &[("", &[("Y", 0.75), ("A", 1.0)])], Environment, None, Ok([0.75; 3])),
        ("a single channel of any name", &[("", &[("v", 0.75)])], Colours, None, Ok([0.75; 3])),
        ("a single channel with alpha", &[("", &[("v", 0.75), ("A", 0.0)])], Data, None, Ok([0.75; 3])),
        (
            "heights among others",
            &[("", &[("R", 0.5), ("G", 0.5), ("B", 0.5), ("height", -2.0)])],
            Heights,
            None,
            Ok([-2.0; 3]),
        ),
        ("displacement of a part", &[("rgba", &RGB), ("displacement", &[("Y", -2.0)])], Heights, None, Ok([-2.0; 3])),
        ("neither colour nor luminance", &[("", &[("U", 0.0), ("V", 0.0)])], Colours, None, Err("U, V (no layer)")),
        (
            "luminance of a vector is none",
            &[("", &[("motion.X", 0.0), ("motion.Y", 1.0)])],
            Colours,
            None,
            Err("motion"),
        ),
    ];
    for (kind, file, purpose, layer, expected) in cases {
        let wishes = Wishes { layer: layer.map(str::to_owned), ..Wishes::default() };
        match (read_bytes(&parts(file), *purpose, &wishes), expected) {
            (Ok(read), Ok(expected)) => assert_eq!(read.picture.pixel(1, 1), *expected, "{kind}"),
            (Err(error), Err(part)) => {
                let message = error.to_string();
                assert!(message.contains(part) && message.contains("the key `layer`"), "{kind}: {message}");
            }
            (found, _) => panic!("{kind}: {:?}", found.map(|read| read.picture.pixels[0])),
        }
    }
}

#[test]
fn a_statement_names_the_channels_that_were_taken_and_left() {
    let file = parts(&[("depth", &[("Z", 0.9)]), ("rgba", &[("R", 0.5), ("G", 0.25), ("B", 0.125), ("A", 1.0)])]);
    let statement = read_bytes(&file, Purpose::Colours, &Wishes::default()).unwrap().statement;
    assert_eq!((statement.kind.as_str(), statement.size), ("OpenEXR", [2, 2]));
    assert_eq!((statement.layer.as_deref(), statement.channels.join("")), (Some("rgba"), "RGB".to_owned()));
    assert_eq!(statement.left, ["depth.Z", "rgba.A"]);
    assert_eq!(statement.to_string(), "OpenEXR, 2×2, layer `rgba`, channels R G B, Rec. 709, linear");
}

/// A grey file whose pixel in column x and row y of the plane is x + 100 y.
fn windowed(data: [i32; 4], display: [i32; 4]) -> Vec<u8> {
    let size = |[_, _, width, height]: [i32; 4]| (width as usize, height as usize);
    let (width, height) = size(data);
    let values =
        (0..height).flat_map(|y| (0..width).map(move |x| (x as i32 + data[0] + 100 * (y as i32 + data[1])) as f32));
    let mut one = layer("", [width, height], &[("Y", values.collect())]);
    one.attributes = one.attributes.with_position(Vec2(data[0], data[1]));
    one.attributes.layer_name = None;
    let bounds = IntegerBounds::new((display[0], display[1]), size(display));
    bytes_of(ImageAttributes::new(bounds), vec![one])
}

#[test]
fn a_picture_is_its_display_window() {
    // Left, top, width, height of the data and the display window.
    let table: [(&str, [i32; 4], [i32; 4]); 12] = [
        ("equal windows", [0, 0, 4, 3], [0, 0, 4, 3]),
        ("equal windows off the origin", [-7, 5, 4, 3], [-7, 5, 4, 3]),
        ("overscan on all sides", [-2, -2, 8, 7], [0, 0, 4, 3]),
        ("overscan on one side", [0, 0, 9, 3], [0, 0, 4, 3]),
        ("upper half", [0, 0, 4, 2], [0, 0, 4, 4]),
        ("lower half", [0, 2, 4, 2], [0, 0, 4, 4]),
        ("left half", [0, 0, 2, 4], [0, 0, 4, 4]),
        ("an island", [1, 1, 2, 2], [0, 0, 4, 4]),
        ("a corner beyond the border", [-1, -1, 3, 3], [0, 0, 4, 4]),
        ("wide but low", [-3, 1, 12, 1], [0, 0, 4, 4]),
        ("nothing in common", [10, 10, 2, 2], [0, 0, 4, 4]),
        ("display off the origin", [0, 0, 4, 4], [2, 1, 4, 4]),
    ];
    let inside = |[left, top, width, height]: [i32; 4], [x, y]: [i32; 2]| {
        (left..left + width).contains(&x) && (top..top + height).contains(&y)
    };
    for (kind, data, display) in table {
        for (window, used) in [(None, display), (Some(Window::Data), data), (Some(Window::Display), display)] {
            let wishes = Wishes { window, ..Wishes::default() };
            let read = read_bytes(&windowed(data, display), Purpose::Environment, &wishes).unwrap();
            assert_eq!(read.statement.size, [used[2] as u32, used[3] as u32], "{kind}");
            for (index, pixel) in read.picture.pixels.iter().enumerate() {
                let place = [used[0] + index as i32 % used[2], used[1] + index as i32 / used[2]];
                let expected = if inside(data, place) { (place[0] + 100 * place[1]) as f32 } else { 0.0 };
                assert_eq!(*pixel, [expected; 3], "{kind} {window:?} {place:?}");
            }
            let corners = [[0, 0], [display[2] - 1, display[3] - 1]];
            let covered = corners.iter().all(|[x, y]| inside(data, [display[0] + x, display[1] + y]));
            assert_eq!(read.statement.warnings.is_empty(), covered || window.is_some(), "{kind}");
        }
    }
    // Numbers of a data map have no black.
    let half = windowed([0, 0, 4, 2], [0, 0, 4, 4]);
    let read = read_bytes(&half, Purpose::Heights, &Wishes::default()).unwrap();
    assert_eq!(read.statement.size, [4, 2]);
    assert!(read.statement.warnings[0].contains("covers 50.0 % of its display window"));
    let huge = windowed([0, 0, 2, 2], [0, 0, 1 << 20, 1 << 20]);
    assert!(fails(read_bytes(&huge, Purpose::Colours, &Wishes::default()), "at most 16384 an edge"));
    let wishes = Wishes { window: Some(Window::Data), ..Wishes::default() };
    assert!(read_bytes(&huge, Purpose::Colours, &wishes).is_ok());
}

/// Kind, components, key `signed`, and the decision with the normal that comes out.
#[test]
fn normals_are_signed_if_the_file_says_so_or_their_length_does() {
    type Normal<'a> = (&'a str, [f32; 3], Option<bool>, bool, [f32; 3]);
    let table: [Normal<'_>; 11] = [
        ("flat and signed", [0.0, 0.0, 1.0], None, true, [0.0, 0.0, 1.0]),
        ("tilted and signed", [-0.5, -0.25, 0.829], None, true, [-0.5, -0.25, 0.829]),
        ("tilted the other way and signed", [0.6, 0.0, 0.8], None, true, [0.6, 0.0, 0.8]),
        ("signed, a little too short", [0.58, 0.01, 0.78], None, true, [0.58, 0.01, 0.78]),
        ("inwards and signed", [0.0, 0.6, -0.8], None, true, [0.0, 0.6, -0.8]),
        ("flat and coded", [0.5, 0.5, 1.0], None, false, [0.5, 0.5, 1.0]),
        (
            "flat and coded in 8 bits",
            [128.0 / 255.0, 128.0 / 255.0, 1.0],
            None,
            false,
            [128.0 / 255.0, 128.0 / 255.0, 1.0],
        ),
        ("tilted and coded", [0.25, 0.375, 0.9145], None, false, [0.25, 0.375, 0.9145]),
        ("steep and coded", [1.0, 0.5, 0.5], None, false, [1.0, 0.5, 0.5]),
        ("coded by the key", [0.6, 0.5, 0.99], Some(false), false, [0.6, 0.5, 0.99]),
        ("signed by the key", [0.5, 0.5, 0.707], Some(true), true, [0.5, 0.5, 0.707]),
    ];
    for (kind, [x, y, z], signed, is_signed, expected) in table {
        for names in [["R", "G", "B"], ["X", "Y", "Z"]] {
            let file = parts(&[("", &[(names[0], x), (names[1], y), (names[2], z)])]);
            let wishes = Wishes { signed, ..Wishes::default() };
            let read = read_bytes(&file, Purpose::Normals, &wishes).unwrap();
            assert_eq!((read.statement.signed, read.picture.pixels[3]), (Some(is_signed), expected), "{kind}");
        }
    }
    // Two channels, or a blue that is no part of a unit normal: z is made of x and y.
    let (x, y) = (-0.5, 0.25_f32);
    let z = (1.0 - x * x - y * y).sqrt();
    for channels in [&[("R", x), ("G", y)][..], &[("X", x), ("Y", y)], &[("R", x), ("G", y), ("B", 0.0)]] {
        let read = read_bytes(&parts(&[("", channels)]), Purpose::Normals, &Wishes::default()).unwrap();
        assert_eq!((read.statement.signed, read.picture.pixels[0]), (Some(true), [x, y, z]));
        assert!(read.statement.notes.iter().any(|note| note.contains("z is √(1 − x² − y²)")));
    }
    let grey = read_bytes(&parts(&[("", &[("Y", 0.5)])]), Purpose::Normals, &Wishes::default());
    assert!(fails(grey, "is grey: a normal map has a red, a green and a blue channel; use it as `height_map`"));
}

/// A colour in another space: name, its chromaticities, and rows of the matrix to Rec. 709 as published.
#[test]
fn colours_become_rec_709() {
    type Space<'a> = (&'a str, [f32; 8], [[f64; 3]; 3]);
    // ACES: the matrices of the Academy's transforms, adapted by Bradford. Rec. 2020, P3, Adobe RGB: products of the
    // published matrices to and from XYZ.
    let table: [Space<'_>; 6] = [
        (
            "Rec. 709",
            [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ),
        (
            "Rec. 2020, converted to Rec. 709",
            [0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329],
            [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]],
        ),
        (
            "Display P3, converted to Rec. 709",
            [0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329],
            [[1.2249, -0.2249, 0.0], [-0.0420, 1.0420, 0.0], [-0.0197, -0.0786, 1.0983]],
        ),
        (
            "Adobe RGB, converted to Rec. 709",
            [0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.329],
            [[1.3984, -0.3984, 0.0], [0.0, 1.0, 0.0], [0.0, -0.0429, 1.0429]],
        ),
        (
            "ACEScg, converted to Rec. 709",
            [0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767],
            [[1.7051, -0.6218, -0.0833], [-0.1303, 1.1408, -0.0105], [-0.0240, -0.1290, 1.1530]],
        ),
        (
            "ACES 2065-1, converted to Rec. 709",
            [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767],
            [[2.5217, -1.1341, -0.3876], [-0.2765, 1.3727, -0.0962], [-0.0154, -0.1530, 1.1684]],
        ),
    ];
    let colour = [0.75, 0.25, 0.5_f32];
    let file = |chromaticities: Option<[f32; 8]>, own: &[(&str, AttributeValue)]| {
        let channels: Vec<_> = ["R", "G", "B"].into_iter().zip(colour.map(|value| vec![value])).collect();
        let mut attributes = ImageAttributes::with_size((1, 1));
        attributes.chromaticities = chromaticities.map(|[a, b, c, d, e, f, x, y]| Chromaticities {
            red: Vec2(a, b),
            green: Vec2(c, d),
            blue: Vec2(e, f),
            white: Vec2(x, y),
        });
        let mut layer = layer("", [1, 1], &channels);
        for (name, value) in own {
            layer.attributes.other.insert(Text::from(*name), value.clone());
        }
        bytes_of(attributes, vec![layer])
    };
    let close = |read: &PictureFile, matrix: &[[f64; 3]; 3], kind: &str| {
        for (found, row) in read.picture.pixels[0].iter().zip(matrix) {
            let expected: f64 = row.iter().zip(colour).map(|(factor, channel)| factor * f64::from(channel)).sum();
            assert!((f64::from(*found) - expected).abs() < 2e-4, "{kind}: {found} {expected}");
        }
    };
    for (name, chromaticities, matrix) in &table {
        let bytes = file(Some(*chromaticities), &[]);
        let read = read_bytes(&bytes, Purpose::Environment, &Wishes::default()).unwrap();
        close(&read, matrix, name);
        assert_eq!(read.statement.colour_space.as_ref().unwrap().used, *name);
        let as_is = Wishes { colour_space: Some(ColourSpace::AsIs), ..Wishes::default() };
        assert_eq!(read_bytes(&bytes, Purpose::Colours, &as_is).unwrap().picture.pixels, [colour], "{name}");
        assert_eq!(read_bytes(&bytes, Purpose::Data, &Wishes::default()).unwrap().picture.pixels, [colour], "{name}");
    }
    let text = |name: &str| AttributeValue::Text(Text::from(name));
    let aces = ("acesImageContainerFlag", AttributeValue::I32(1));
    let named: [(&[(&str, AttributeValue)], usize); 5] = [
        (&[("colorInteropID", text("lin_ap1_scene"))], 4),
        (&[("colorInteropID", text("lin_rec2020_scene"))], 1),
        (&[("oiio:ColorSpace", text("ACEScg"))], 4),
        (&[("oiio:ColorSpace", text("unheard-of"))], 0),
        (&[aces], 5),
    ];
    for (attributes, row) in named {
        let read = read_bytes(&file(None, attributes), Purpose::Colours, &Wishes::default()).unwrap();
        close(&read, &table[row].2, attributes[0].0);
    }
    let wished = Wishes { colour_space: Some(ColourSpace::Acescg), ..Wishes::default() };
    close(&read_bytes(&file(None, &[]), Purpose::Colours, &wished).unwrap(), &table[4].2, "by the key");
    let flat = file(Some([0.3; 8]), &[]);
    let read = read_bytes(&flat, Purpose::Colours, &Wishes::default()).unwrap();
    assert_eq!((read.picture.pixels[0], read.statement.warnings.len()), (colour, 1));
    assert!(read.statement.warnings[0].contains("span no colour space"));
}

#[test]
fn the_projection_of_a_panorama_is_told() {
    for (map, expected) in [(EnvironmentMap::LatitudeLongitude, Envmap::Latlong), (EnvironmentMap::Cube, Envmap::Cube)]
    {
        let mut one = layer("", [1, 1], &[("Y", vec![1.0])]);
        one.attributes.environment_map = Some(map);
        let bytes = bytes_of(ImageAttributes::with_size((1, 1)), vec![one]);
        let read = read_bytes(&bytes, Purpose::Environment, &Wishes::default()).unwrap();
        assert_eq!(read.statement.envmap, Some(expected));
    }
}
