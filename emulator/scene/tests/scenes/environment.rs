//! Environments as files bring them, against the light that each direction has.

use std::path::Path;

use roughxel_assets::Picture;
use roughxel_scene::cube::direction;
use roughxel_scene::*;

type Vector = [f64; 3];

/// Right is ahead × up, as in every right-handed world.
struct Camera {
    ahead: Vector,
    up: Vector,
}

impl Camera {
    /// The point on the cube that a camera of 90° sees at (s, t), −1 … 1, t downwards.
    fn sees(&self, s: f64, t: f64) -> Vector {
        let ([ax, ay, az], [ux, uy, uz]) = (self.ahead, self.up);
        let right = [ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux];
        [0, 1, 2].map(|axis| self.ahead[axis] + right[axis] * s - self.up[axis] * t)
    }
}

const fn camera(ahead: Vector, up: Vector) -> Camera {
    Camera { ahead, up }
}

const UP: Vector = [0.0, 1.0, 0.0];
/// Six photographs by the axes of the world: a viewer who faces −z looks up and down.
const CAMERAS: [Camera; 6] = [
    camera([1.0, 0.0, 0.0], UP),
    camera([-1.0, 0.0, 0.0], UP),
    camera([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
    camera([0.0, -1.0, 0.0], [0.0, 0.0, -1.0]),
    camera([0.0, 0.0, 1.0], UP),
    camera([0.0, 0.0, -1.0], UP),
];
/// The camera below the lower face of a cross: it goes on tilting.
const BELOW: Camera = camera([0.0, 0.0, 1.0], [0.0, -1.0, 0.0]);

const EDGE: usize = 16;

/// Light of a point on the cube, different everywhere.
fn light([x, y, z]: Vector) -> [f32; 3] {
    [0.5 + 0.2 * x + 0.1 * y + 0.05 * z, 0.4 - 0.1 * x + 0.15 * y, 0.5 + 0.1 * y - 0.2 * z]
        .map(|channel| channel as f32)
}

/// Light of the world mirrored at z, for directions of any length.
fn mirrored([x, y, z]: Vector) -> [f32; 3] {
    light([x, y, -z])
}

fn of_direction(direction: Vector) -> [f32; 3] {
    let length = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
    light(direction.map(|c| c / length))
}

/// A picture of a function of its pixels.
fn picture(width: usize, height: usize, colour: impl Fn(usize, usize) -> [f32; 3]) -> Picture {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| colour(x, y)).collect();
    Picture { width: width as u32, height: height as u32, pixels }
}

/// s or t of the centre of a texel.
fn centre(index: usize) -> f64 {
    (2 * index + 1) as f64 / EDGE as f64 - 1.0
}

/// s or t of a texel of OpenEXR: the outermost lie on the edges.
fn on_edges(index: usize) -> f64 {
    (2 * index) as f64 / (EDGE - 1) as f64 - 1.0
}

fn photograph(camera: &Camera, light: fn(Vector) -> [f32; 3]) -> Picture {
    picture(EDGE, EDGE, |x, y| light(camera.sees(centre(x), centre(y))))
}

/// A face as the table of Vulkan has it.
fn vulkan(face: usize, light: fn(Vector) -> [f32; 3]) -> Picture {
    picture(EDGE, EDGE, |x, y| light(direction(face, centre(x), centre(y))))
}

/// Photographs joined by columns and rows of faces, black between them.
fn joined(columns: usize, rows: usize, faces: &[(usize, usize, Picture)]) -> Picture {
    let mut whole = Picture::filled((columns * EDGE) as u32, (rows * EDGE) as u32, [0.0; 3]);
    for (column, row, face) in faces {
        for (index, pixel) in face.pixels.iter().enumerate() {
            let (x, y) = (column * EDGE + index % EDGE, row * EDGE + index / EDGE);
            whole.pixels[y * columns * EDGE + x] = *pixel;
        }
    }
    whole
}

/// A cross of photographs; `last` is the place and the camera of the face behind the viewer.
fn cross(
    columns: usize,
    rows: usize,
    (x, y, behind): (usize, usize, &Camera),
    light: fn(Vector) -> [f32; 3],
) -> Picture {
    let [right, left, above, below, _, front] = &CAMERAS;
    let places = [(2, 1, right), (0, 1, left), (1, 0, above), (1, 2, below), (1, 1, front), (x, y, behind)];
    joined(columns, rows, &places.map(|(x, y, camera)| (x, y, photograph(camera, light))))
}

fn row(faces: [Picture; 6]) -> Picture {
    let mut place = 0..;
    joined(6, 1, &faces.map(|face| (place.next().unwrap(), 0, face)))
}

fn column(faces: [Picture; 6]) -> Picture {
    let mut place = 0..;
    joined(1, 6, &faces.map(|face| (0, place.next().unwrap(), face)))
}

/// Pixel centres of a panorama between azimuths and elevations in degrees.
fn panorama(width: usize, height: usize, [left, right]: [f64; 2], [low, high]: [f64; 2]) -> Picture {
    picture(width, height, |x, y| {
        let azimuth = (left + (right - left) * (x as f64 + 0.5) / width as f64).to_radians();
        let elevation = (high - (high - low) * (y as f64 + 0.5) / height as f64).to_radians();
        of_direction([azimuth.sin() * elevation.cos(), elevation.sin(), -azimuth.cos() * elevation.cos()])
    })
}

/// Writes a Radiance picture without compression.
fn write(folder: &Path, name: &str, picture: &Picture) {
    let mut bytes =
        format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", picture.height, picture.width).into_bytes();
    for pixel in &picture.pixels {
        let most = pixel.iter().copied().fold(1e-9_f32, f32::max);
        let exponent = most.log2().floor() as i32 + 1;
        let code = |channel: f32| (channel * 256.0 / 2_f32.powi(exponent)).round().min(255.0) as u8;
        bytes.extend([code(pixel[0]), code(pixel[1]), code(pixel[2]), (exponent + 128) as u8]);
    }
    std::fs::write(folder.join(name), bytes).unwrap();
}

fn read(folder: &Path, keys: &str) -> Result<Scene, SceneError> {
    let text = format!("camera = {{ eye = [0, 1, 5], target = [0, 0, 0] }}\nenvironment = {{ {keys} }}\n");
    Scene::from_toml("test.toml", &text, folder)
}

/// The faces and the warnings of an environment in files `0.hdr`, `1.hdr` and so on.
fn environment(pictures: &[Picture], keys: &str) -> ([Picture; 6], Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    for (index, picture) in pictures.iter().enumerate() {
        write(folder.path(), &format!("{index}.hdr"), picture);
    }
    let scene = read(folder.path(), keys).unwrap();
    (scene.environment.unwrap().faces, scene.warnings)
}

const SIX: &str = "faces = [\"0.hdr\", \"1.hdr\", \"2.hdr\", \"3.hdr\", \"4.hdr\", \"5.hdr\"]";
const ONE: &str = "cube = \"0.hdr\"";

/// A cube in files: kind, pictures and keys.
type Cube = (&'static str, Vec<Picture>, String);

fn cubes() -> Vec<Cube> {
    let inside = |light| CAMERAS.each_ref().map(|camera| photograph(camera, light));
    // A left-handed set names what lies ahead +z: the pictures of −z and +z change places.
    let mut left_handed = inside(light);
    left_handed.swap(4, 5);
    let outside = [0, 1, 2, 3, 4, 5].map(|face| vulkan(face, light));
    let edges = |camera: &Camera| picture(EDGE, EDGE, |x, y| light(camera.sees(on_edges(x), on_edges(y))));
    let behind = &CAMERAS[4];
    let with = |keys: &str, more: &str| format!("{keys}, {more}");
    vec![
        ("six faces of Vulkan", outside.to_vec(), SIX.into()),
        ("six faces of Vulkan, said", outside.to_vec(), with(SIX, "orientation = \"outside\"")),
        ("six photographs", inside(light).to_vec(), with(SIX, "orientation = \"inside\"")),
        ("a skybox", left_handed.to_vec(), with(SIX, "orientation = \"left-handed\"")),
        ("a row of Vulkan", vec![row(outside.clone())], ONE.into()),
        ("a column of Vulkan", vec![column(outside)], ONE.into()),
        ("a row of photographs", vec![row(inside(light))], with(ONE, "orientation = \"inside\"")),
        ("a column of a skybox", vec![column(left_handed)], with(ONE, "orientation = \"left-handed\"")),
        ("a wide cross", vec![cross(4, 3, (3, 1, behind), light)], ONE.into()),
        ("a high cross", vec![cross(3, 4, (1, 3, &BELOW), light)], ONE.into()),
        ("a wide cross, said", vec![cross(4, 3, (3, 1, behind), light)], with(ONE, "layout = \"cross\"")),
        (
            "a wide cross in mirror writing",
            vec![cross(4, 3, (3, 1, behind), mirrored)],
            with(ONE, "orientation = \"outside\""),
        ),
        ("a high cross, inside", vec![cross(3, 4, (1, 3, &BELOW), light)], with(ONE, "orientation = \"inside\"")),
        ("a column of OpenEXR", vec![column(CAMERAS.each_ref().map(edges))], with(ONE, "layout = \"openexr\"")),
    ]
}

#[test]
fn cubes_show_in_each_direction_what_was_there() {
    for (kind, pictures, keys) in cubes() {
        let (faces, warnings) = environment(&pictures, &keys);
        assert!(warnings.is_empty(), "{kind}: {warnings:?}");
        for (face, picture) in faces.iter().enumerate() {
            assert_eq!((picture.width, picture.height), (EDGE as u32, EDGE as u32));
            for (index, pixel) in picture.pixels.iter().enumerate() {
                let wanted = light(direction(face, centre(index % EDGE), centre(index / EDGE)));
                for (got, wanted) in pixel.iter().zip(wanted) {
                    // Eight bits of a Radiance file.
                    assert!((got - wanted).abs() < 0.004, "{kind}, face {face}, {index}: {pixel:?} {wanted:?}");
                }
            }
        }
    }
}

/// Panoramas: kind, size, borders in degrees, and keys.
type Panorama = (&'static str, [usize; 2], [f64; 2], [f64; 2], &'static str);

const PANORAMAS: [Panorama; 13] = [
    ("the sphere", [128, 64], [-180.0, 180.0], [-90.0, 90.0], ""),
    ("a row less", [128, 63], [-180.0, 180.0], [-90.0, 90.0], ""),
    ("a column more", [129, 64], [-180.0, 180.0], [-90.0, 90.0], ""),
    ("the sphere of OpenEXR", [128, 64], [0.0, 360.0], [-90.0, 90.0], ", longitudes = [0, 360]"),
    ("turned to the left", [128, 64], [-270.0, 90.0], [-90.0, 90.0], ", longitudes = [-270, 90]"),
    ("the sky", [128, 32], [-180.0, 180.0], [0.0, 90.0], ", latitudes = [0, 90]"),
    ("the ground", [128, 32], [-180.0, 180.0], [-90.0, 0.0], ", latitudes = [-90, 0]"),
    ("a band", [128, 16], [-180.0, 180.0], [-22.5, 22.5], ", latitudes = [-22.5, 22.5]"),
    ("stretched to a square", [128, 128], [-180.0, 180.0], [-90.0, 90.0], ", latitudes = [-90, 90]"),
    ("half around", [64, 64], [-90.0, 90.0], [-90.0, 90.0], ", longitudes = [-90, 90]"),
    ("half around, across the border", [64, 64], [90.0, 270.0], [-90.0, 90.0], ", longitudes = [90, 270]"),
    ("a view", [32, 16], [-45.0, 45.0], [0.0, 45.0], ", longitudes = [-45, 45], latitudes = [0, 45]"),
    ("a shape of a cross", [128, 96], [-180.0, 180.0], [-90.0, 90.0], ", latitudes = [-90, 90]"),
];

#[test]
fn panoramas_show_in_each_direction_what_was_there_and_black_outside() {
    for (kind, [width, height], longitudes, latitudes, keys) in PANORAMAS {
        let keys = format!("equirectangular = \"0.hdr\", face_edge = {EDGE}{keys}");
        let (faces, _) = environment(&[panorama(width, height, longitudes, latitudes)], &keys);
        let mut inside = 0;
        for (face, picture) in faces.iter().enumerate() {
            for (index, pixel) in picture.pixels.iter().enumerate() {
                let d = direction(face, centre(index % EDGE), centre(index / EDGE));
                let azimuth = d[0].atan2(-d[2]).to_degrees();
                let elevation = d[1].atan2(d[0].hypot(d[2])).to_degrees();
                let azimuth = longitudes[0] + (azimuth - longitudes[0]).rem_euclid(360.0);
                // Degrees to the nearest border, below 0 outside; the sphere has none.
                let within = |at: f64, [from, to]: [f64; 2], all: f64| match () {
                    () if to - from == all => all,
                    () if at > to => -(at - to).min(from + 360.0 - at),
                    () => (at - from).min(to - at),
                };
                let within = within(azimuth, longitudes, 360.0).min(within(elevation, latitudes, 180.0));
                let wanted = if within > 0.0 { of_direction(d) } else { [0.0; 3] };
                // A texel is up to 7.2 degrees wide; the poles have all azimuths.
                if within.abs() < 8.0 || (longitudes[1] - longitudes[0] < 360.0 && elevation.abs() > 60.0) {
                    continue;
                }
                inside += usize::from(within > 0.0);
                for (got, wanted) in pixel.iter().zip(wanted) {
                    assert!((got - wanted).abs() < 0.01, "{kind}, face {face}, {index}: {pixel:?} {wanted:?}");
                }
            }
        }
        assert!(inside > 20, "{kind}");
    }
}

#[test]
fn pictures_of_another_shape_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let panorama = |keys: &str| format!("equirectangular = \"0.hdr\"{keys}");
    for ([width, height], keys, expected) in [
        (
            [128, 96],
            panorama(""),
            "128×96 pixels, the shape of a cross of six faces; its width : height should be 2.00 (name it with `cube`",
        ),
        ([96, 128], panorama(""), "a cross of six faces"),
        ([96, 16], panorama(""), "a strip of six faces"),
        ([16, 96], panorama(""), "a strip of six faces"),
        ([64, 64], panorama(""), "a light probe or of one face"),
        ([128, 32], panorama(""), "half a sphere; its width : height should be 2.00 (give its `latitudes`"),
        ([96, 64], panorama(""), "not the shape of a panorama"),
        ([160, 90], panorama(""), "not the shape of a panorama"),
        ([100, 53], panorama(""), "not the shape of a panorama"),
        ([100, 47], panorama(""), "not the shape of a panorama"),
        ([128, 64], panorama(", longitudes = [-90, 90]"), "its width : height should be 1.00"),
        (
            [64, 32],
            panorama(", latitudes = [10, 10.5]"),
            "`latitudes` is [10, 10.5] (choose two numbers, the second 1 to 180",
        ),
        ([64, 32], panorama(", longitudes = [180, -180]"), "`longitudes` is [180, -180]"),
        ([64, 32], panorama(", longitudes = [-200, 200]"), "1 to 360 above the first"),
        ([64, 32], panorama(", latitudes = [-100, 90]"), "out of range"),
        ([64, 32], panorama(", orientation = \"inside\""), "unknown key `orientation`"),
        ([4096, 64], panorama(", latitudes = [10, 11], longitudes = [0, 1]"), "the whole sphere has 1474560×11520"),
        ([64, 32], ONE.into(), "which is no known layout of six squares (name a panorama"),
        ([50, 20], ONE.into(), "no known layout of six squares (arrange its squares as 4:3 or 3:4 (\"cross\"), 6:1"),
        ([4, 4], ONE.into(), "no known layout"),
        ([3, 2], ONE.into(), "no known layout"),
        ([64, 48], format!("{ONE}, layout = \"strip\""), "which this `layout` does not have (its shape is 6:1 or 1:6)"),
        ([96, 16], format!("{ONE}, layout = \"openexr\""), "its shape is 1:6"),
        ([96, 16], format!("{ONE}, layout = \"dice\""), "choose \"cross\" or \"strip\" or \"openexr\""),
        ([96, 16], format!("{ONE}, orientation = \"insid\""), "did you mean `inside`?"),
        ([96, 16], format!("{ONE}, face_edge = 4"), "unknown key `face_edge`"),
        ([12294, 2049], ONE.into(), "2049×2049 in a face (make it smaller"),
        ([96, 16], format!("{ONE}, generate = \"sky\""), "exactly one of"),
    ] {
        write(folder.path(), "0.hdr", &Picture::filled(width, height, [0.5; 3]));
        let error = read(folder.path(), &keys).unwrap_err().to_string();
        assert!(error.contains(expected), "{keys}\n{error}");
        assert!(error.starts_with("test.toml:2:"), "{error}");
    }
}

#[test]
fn one_pixel_is_an_environment_of_one_colour() {
    for (width, height) in [(1, 1), (2, 1), (3, 1)] {
        let (faces, _) =
            environment(&[Picture::filled(width, height, [0.5; 3])], "equirectangular = \"0.hdr\", face_edge = 4");
        assert!(faces.iter().flat_map(|face| &face.pixels).all(|pixel| *pixel == [0.5; 3]));
    }
}

#[test]
fn faces_whose_edges_meet_in_another_orientation_are_told() {
    let inside = CAMERAS.each_ref().map(|camera| photograph(camera, of_direction));
    let mut left_handed = inside.clone();
    left_handed.swap(4, 5);
    let outside = [0, 1, 2, 3, 4, 5].map(|face| vulkan(face, of_direction));
    let noise = |face: usize| {
        picture(EDGE, EDGE, |x, y| [((x * 7919 + y * 104_729 + face * 1_299_709) % 101) as f32 / 101.0; 3])
    };
    let noise = [0, 1, 2, 3, 4, 5].map(noise);
    let plain = [(); 6].map(|()| Picture::filled(EDGE as u32, EDGE as u32, [0.7; 3]));
    let a_lamp = |face: usize| Picture::filled(EDGE as u32, EDGE as u32, [if face == 2 { 9.0 } else { 0.1 }; 3]);
    let a_lamp = [0, 1, 2, 3, 4, 5].map(a_lamp);
    for (kind, faces, given, better) in [
        ("photographs", &inside, "outside", Some("inside")),
        ("photographs", &inside, "inside", None),
        ("photographs", &inside, "left-handed", Some("inside")),
        ("a skybox", &left_handed, "inside", Some("left-handed")),
        ("a skybox", &left_handed, "left-handed", None),
        ("a skybox", &left_handed, "outside", None),
        ("Vulkan's faces", &outside, "outside", None),
        ("Vulkan's faces", &outside, "inside", Some("left-handed")),
        ("noise", &noise, "outside", None),
        ("noise", &noise, "inside", None),
        ("one colour", &plain, "outside", None),
        ("a bright face", &a_lamp, "inside", None),
    ] {
        let (_, warnings) = environment(faces, &format!("{SIX}, orientation = \"{given}\""));
        let wanted = better.map(|better| {
            format!("environment: the edges of the faces do not meet; with `orientation = \"{better}\"` they would")
        });
        assert_eq!(warnings, wanted.into_iter().collect::<Vec<_>>(), "{kind} given as {given}");
    }
}

mod openexr;
