//! Frames of maps and environments in files, against what the files mean.

use std::path::Path;

use roughxel_assets::picture::{Picture, srgb_codes, write_png_codes};
use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_host_tests::bars::MODES;
use roughxel_scene::Scene;

fn draw(folder: &Path, text: &str, mode: Mode) -> Frame {
    let scene = Scene::from_toml("as files mean", text, folder).unwrap();
    Prepared::new(&scene, mode, &Precision::STANDARD).unwrap().render(&|| ()).unwrap()
}

/// Direction and top of a view from inside, and the name of its photograph.
const VIEWS: [(&str, [i32; 3], [i32; 3]); 6] = [
    ("px", [1, 0, 0], [0, 1, 0]),
    ("nx", [-1, 0, 0], [0, 1, 0]),
    ("py", [0, 1, 0], [0, 0, 1]),
    ("ny", [0, -1, 0], [0, 0, -1]),
    ("pz", [0, 0, 1], [0, 1, 0]),
    ("nz", [0, 0, -1], [0, 1, 0]),
];

const VIEW_EDGE: u32 = 32;

fn view(folder: &Path, (_, ahead, up): (&str, [i32; 3], [i32; 3]), environment: &str) -> Vec<u8> {
    let text = format!(
        "camera = {{ eye = [0, 0, 0], target = {ahead:?}, up = {up:?}, fov_y = 90, width = {VIEW_EDGE}, height = {VIEW_EDGE} }}\n\
         background = {{ environment = true }}\nenvironment = {{ {environment} }}\n"
    );
    draw(folder, &text, Mode::Unfiltered).srgb_codes()
}

#[test]
fn six_photographs_come_out_as_they_were_taken() {
    let folder = tempfile::tempdir().unwrap();
    let world = "generate = \"checker\", face_edge = 64, squares = 5";
    let photographs = VIEWS.map(|shown| view(folder.path(), shown, world));
    for ((name, ..), codes) in VIEWS.iter().zip(&photographs) {
        write_png_codes(&folder.path().join(format!("{name}.png")), [VIEW_EDGE; 2], codes).unwrap();
    }
    let files = |names: [&str; 6]| format!("faces = {:?}", names.map(|name| format!("{name}.png")));
    let inside = files(VIEWS.map(|(name, ..)| name));
    // A set for a left-handed world calls +z what lies ahead.
    let left_handed = files(["px", "nx", "py", "ny", "nz", "pz"]);
    for (files, orientation) in [(inside, "inside"), (left_handed, "left-handed")] {
        let back = format!("{files}, orientation = \"{orientation}\"");
        for (shown, photograph) in VIEWS.iter().zip(&photographs) {
            assert!(view(folder.path(), *shown, &back) == *photograph, "{orientation}, {}", shown.0);
        }
    }
}

#[test]
fn a_ramp_that_does_not_repeat_has_one_slope_in_every_mode() {
    let folder = tempfile::tempdir().unwrap();
    // Heights k/255 and light that grows with x: every pixel shows the slope of its texel.
    let grey = |codes: Vec<u8>, size: [u32; 2], name: &str| {
        let codes: Vec<u8> = codes.into_iter().flat_map(|code| [code; 3]).collect();
        write_png_codes(&folder.path().join(name), size, &codes).unwrap();
    };
    grey((0..4 * 32).map(|index| 8 * (index % 32) as u8).collect(), [32, 4], "ramp.png");
    // Degrees of longitude count from −z; the sky above shows a gradient along x.
    let pixels = (0..128 * 256).map(|index| {
        let (u, v) = ((index % 256) as f64 / 256.0 + 1.0 / 512.0, (index / 256) as f64 / 128.0 + 1.0 / 256.0);
        let x = ((u - 0.5) * std::f64::consts::TAU).sin() * (v * std::f64::consts::PI).sin();
        [(0.5 + 0.5 * x) as f32; 3]
    });
    let sky = Picture { width: 256, height: 128, pixels: pixels.collect() };
    write_png_codes(&folder.path().join("sky.png"), [256, 128], &srgb_codes(&sky.pixels, |pixel| *pixel)).unwrap();
    // 31 steps of 8/255 over 31/32 of a repeat, times 0.3: the normal (−s, 0, 1) reflects the view to (−2s, ., 1 − s²).
    let slope: f64 = 0.3 * 32.0 * 8.0 / 255.0;
    let x = -2.0 * slope / (1.0 + slope * slope);
    let wanted = 0.5 + 0.5 * x;
    let scene = |wrap: bool| {
        format!(
            "camera = {{ eye = [0, 100, 0], target = [0, 0, 0], up = [0, 0, -1], fov_y = 0.572953021, width = 32, height = 32 }}\n\
             background = {{ colour = [0, 0, 0] }}\nenvironment = {{ equirectangular = \"sky.png\", face_edge = 128 }}\n\
             [[object]]\nshape = \"plane\"\n[object.material]\ncolour = [0, 0, 0]\nreflectance = 1\n\
             height_map = {{ path = \"ramp.png\", scale = 0.3, wrap = {wrap} }}\n"
        )
    };
    let error = |frame: &Frame, column: usize| {
        let pixels = frame.picture().pixels;
        (0..32).map(|row| (f64::from(pixels[row * 32 + column][0]) - wanted).abs()).fold(0.0, f64::max)
    };
    for mode in MODES {
        let open = draw(folder.path(), &scene(false), mode);
        // Two 8-bit codes.
        assert!((0..32).all(|column| error(&open, column) < 0.01), "{mode}");
    }
    // The wall of a repeated ramp.
    let wrapped = draw(folder.path(), &scene(true), Mode::Unfiltered);
    assert!([0, 31].into_iter().all(|column| error(&wrapped, column) > 0.2));
}
