//! Peaks from the command line: scenes without peaks, maps of odd sizes, and the cache.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use roughxel_assets::picture::write_png_codes;
use roughxel_peaks::{Horizon, PeakLevel, PeakPyramid};
use roughxel_scene::Scene;

use super::fixture::{Run, program};

const CAMERA: &str = "camera = { eye = [0, 1, 2], target = [0, 0, 0] }\n";
const LIGHT: &str = "[[light]]\ndirection = [0, 1, 0]\n";
/// A map that needs fits.
const DENIM: &str = "height_map = { generate = \"denim\", size = 16, threads = 4 }\npeaks = { shadowing = true }";

/// Runs `roughxel` with its own home directory.
fn roughxel(home: &Path, arguments: &[&str]) -> Run {
    let mut command = program(arguments);
    Run::output(command.env("HOME", home).env_remove("XDG_CACHE_HOME").env_remove("LOCALAPPDATA"))
}

/// Writes a scene with one plane of a material.
fn scene(directory: &Path, lights: &str, material: &str) -> PathBuf {
    let path = directory.join("scene.toml");
    let text = format!("{CAMERA}{lights}[[object]]\nshape = \"plane\"\n[object.material]\n{material}\n");
    fs::write(&path, text).unwrap();
    path
}

/// Draws a scene as a small picture.
fn render(directory: &Path, scene: &Path, more: &[&str]) -> Run {
    let picture = directory.join("picture.png");
    let [scene, picture] = [scene, &picture].map(|path| path.to_str().unwrap());
    let arguments = [&["render", scene, "-o", picture, "--size", "16x12", "--json"], more].concat();
    roughxel(directory, &arguments)
}

/// Draws a scene and returns the figures and the warnings.
fn drawn(directory: &Path, scene: &Path, more: &[&str]) -> (serde_json::Value, String) {
    let Run { out, err, .. } = render(directory, scene, more).ends(0);
    (serde_json::from_str(&out).unwrap(), err)
}

/// Writes an 8-bit grey PNG.
fn grey(path: &Path, width: u32, height: u32, value: impl Fn(u32) -> u8) {
    let mut encoder = png::Encoder::new(fs::File::create(path).unwrap(), width, height);
    encoder.set_color(png::ColorType::Grayscale);
    let pixels: Vec<u8> = (0..width * height).map(value).collect();
    encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
}

#[test]
fn scenes_that_cannot_shine_name_line_and_remedy() {
    let directory = tempfile::tempdir().unwrap();
    let home = directory.path();
    grey(&home.join("large.png"), 1025, 1024, |_| 7);
    for (name, [width, height]) in [("normals.png", [1025, 1024]), ("few_normals.png", [8, 8])] {
        let codes = [128, 128, 255].repeat((width * height) as usize);
        write_png_codes(&home.join(name), [width, height], &codes).unwrap();
    }
    grey(&home.join("small.png"), 4, 4, |index| index as u8);
    exr::prelude::write_rgb_file(home.join("high.exr"), 2, 2, |x, _| (1e9 * x as f32, 0.0, 0.0)).unwrap();
    let given = |peak: &str| format!("peaks = {{ given = [{{ {peak} }}] }}");
    let map = |rest: &str| format!("height_map = {{ path = \"small.png\" }}\n{rest}");
    for (lights, material, line, message, remedy) in [
        ("", "highlight = {}".into(), 5, "no light for `highlight`", "add [[light]]"),
        ("", map("peaks = {}"), 6, "no light for `peaks`", "add [[light]]"),
        ("[[light]]\ndirection = [0, 0, 0]\n", String::new(), 3, "`direction` has no length", "any length but zero"),
        ("[[light]]\n", String::new(), 2, "the light stands nowhere", "give `direction`"),
        (LIGHT, given("amplitude = 1, normal = [0, 0, 0], exponent = 9"), 7, "`normal` has no length", "[0, 0, 1]"),
        (LIGHT, given("amplitude = 1, normal = [0, 0, 1], exponent = 0.9"), 7, "out of range", "from 1 to 8192"),
        (LIGHT, given("amplitude = 16, normal = [0, 0, 1], exponent = 9"), 7, "out of range", "from 0 to 15"),
        (LIGHT, given("amplitude = 1, normal = [nan, 0, 1], exponent = 9"), 7, "out of range", "choose a number"),
        (LIGHT, map("peaks = { exponent = 8193 }"), 8, "out of range", "from 1 to 8192"),
        (LIGHT, map("peaks = { exponent = nan }"), 8, "out of range", "from 1 to 8192"),
        (LIGHT, "highlight = { exponent = 0 }".into(), 7, "out of range", "from 1 to 8192"),
        (LIGHT, "peaks = {}".into(), 7, "no bumps", "add `height_map`"),
        (LIGHT, "height_map = { path = \"large.png\" }\npeaks = {}".into(), 7, "1025×1024", "make the map smaller"),
        (LIGHT, "normal_map = { path = \"normals.png\" }\npeaks = {}".into(), 7, "1025×1024", "make the map smaller"),
        (
            LIGHT,
            "normal_map = { path = \"few_normals.png\" }\npeaks = { shadowing = true }".into(),
            8,
            "no heights to cast shadows",
            "use `height_map`",
        ),
        (
            LIGHT,
            "height_map = { path = \"high.exr\", scale = 1 }\npeaks = { shadowing = true }".into(),
            7,
            "heights of more than 10^9",
            "choose a smaller `scale`",
        ),
    ] {
        let run = render(home, &scene(home, lights, &material), &[]).ends(1);
        assert!(run.complains(&[&format!("scene.toml:{line}:"), message, remedy]).out.is_empty());
    }
    assert!(!home.join(".cache").exists() && !home.join("picture.png").exists());
}

#[test]
fn a_map_of_one_texel_or_one_column_is_drawn_and_has_a_level_horizon() {
    let directory = tempfile::tempdir().unwrap();
    let home = directory.path();
    let material = "height_map = { path = \"map.png\", scale = 1 }\npeaks = { shadowing = true }";
    for (width, height) in [(1, 1), (1, 5), (7, 1)] {
        grey(&home.join("map.png"), width, height, |index| 100 + 50 * (index % 2) as u8);
        for frame in ["main-direction", "natural", "natural-normalised"] {
            let path = scene(home, LIGHT, &format!("{material}\nframe = \"{frame}\""));
            assert_eq!(drawn(home, &path, &["--no-cache"]).0["peaks"]["built"], 1);
            let material = Scene::from_file(&path).unwrap().objects.remove(0).material;
            let peaks = PeakPyramid::of_material(&material, true, None, &|_| ()).unwrap().unwrap();
            let mut steep = [false; 2];
            for peak in peaks.pyramid.levels.iter().flat_map(PeakLevel::peaks) {
                let sides = peak.horizon.unwrap();
                for (axis, size) in [width, height].into_iter().enumerate() {
                    let sides = &sides[2 * axis..2 * axis + 2];
                    if size == 1 {
                        assert!(peak.normal[axis] == 0.0 && *sides == [Horizon::default(); 2], "{frame}: {peak:?}");
                    }
                    steep[axis] |= sides.iter().any(|side| side.mean > 0.0);
                }
            }
            assert_eq!(steep, [width > 1, height > 1]);
        }
    }
}

/// Lists the files below a directory.
fn kept(directory: &Path) -> Vec<PathBuf> {
    fs::read_dir(directory).unwrap().map(|file| file.unwrap().path()).collect()
}

#[test]
fn peaks_are_built_once_and_a_torn_or_foreign_file_is_replaced() {
    let directory = tempfile::tempdir().unwrap();
    let home = directory.path();
    let (path, cache) = (scene(home, LIGHT, DENIM), home.join("a/cache"));
    let run = || {
        let (figures, warnings) = drawn(home, &path, &["--cache", cache.to_str().unwrap()]);
        let count = |what: &str| figures["peaks"][what].as_u64().unwrap();
        (figures["digest"].clone(), [count("built"), count("read")], warnings)
    };
    let (digest, counts, warnings) = run();
    assert_eq!((counts, warnings.as_str()), ([1, 0], ""));
    assert_eq!(run(), (digest.clone(), [0, 1], String::new()));
    let [file] = &kept(&cache)[..] else { panic!("one file") };
    let good = fs::read(file).unwrap();
    let mut changed = good.clone();
    changed[good.len() / 2] ^= 1;
    for bad in [&good[..good.len() / 2], &[], &changed, b"something else"] {
        fs::write(file, bad).unwrap();
        assert_eq!(run(), (digest.clone(), [1, 0], String::new()));
        assert!(fs::read(file).unwrap() == good, "{} bytes were not replaced", bad.len());
    }
    assert_eq!(run().1, [0, 1]);
    // A cache file that cannot be replaced is a warning only.
    fs::remove_file(file).unwrap();
    fs::create_dir(file).unwrap();
    let (again, counts, warnings) = run();
    assert_eq!((again, counts), (digest, [1, 0]));
    assert!(warnings.starts_with("warning: peaks are not kept in ") && warnings.contains("cache: "), "{warnings}");
    assert_eq!(warnings.lines().count(), 1);
}

#[test]
fn what_is_killed_goes_on_where_it_was_to_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    let home = directory.path();
    // Without shadowing, because clusters would be written too early to be seen.
    let map = "height_map = { generate = \"bumps\", size = 96, cells = 12 }\npeaks = {}";
    let path = scene(home, LIGHT, map);
    let [whole, cache] = ["whole", "killed"].map(|name| home.join(name));
    let place = |cache: &Path| cache.to_str().unwrap().to_owned();
    let (wanted, _) = drawn(home, &path, &["--cache", &place(&whole)]);
    // The run is killed once the first part exists. The other parts take longer, with one thread on any machine.
    let [scene, picture] = [&path, &home.join("never.png")].map(|path| place(path));
    let size = ["--size", "16x12", "--threads", "1", "--cache", &place(&cache)];
    let mut command = program(&[&["render", &scene, "-o", &picture], &size[..]].concat());
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    let parts = || {
        let kept = fs::read_dir(&cache).into_iter().flatten().map(|entry| entry.unwrap().path());
        let parts = kept.filter(|path| path.is_dir()).flat_map(|path| fs::read_dir(path).into_iter().flatten());
        parts.map(|entry| entry.unwrap().path()).filter(|path| path.extension().is_some_and(|end| end == "part"))
    };
    while parts().next().is_none() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before a part was seen");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!home.join("never.png").exists());
    let count = parts().count();
    assert!(count > 0 && kept(&cache).iter().all(|path| path.is_dir()), "the pyramid itself is not kept yet");
    // A damaged part is named. The other parts are found.
    let torn = parts().next().unwrap();
    fs::write(&torn, "torn").unwrap();
    let (figures, warnings) = drawn(home, &path, &["--cache", &place(&cache)]);
    assert!(warnings.starts_with(&format!("warning: {}: damaged", torn.display())), "{warnings}");
    assert_eq!(warnings.lines().count(), 1);
    assert_eq!((&figures["digest"], &figures["peaks"]["built"]), (&wanted["digest"], &1.into()));
    let ([one], [other]) = (&kept(&whole)[..], &kept(&cache)[..]) else { panic!("one file each, and no parts") };
    assert!(one.file_name() == other.file_name() && fs::read(one).unwrap() == fs::read(other).unwrap());
}

#[test]
fn a_cache_that_cannot_be_written_is_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    let home = directory.path();
    let path = scene(home, LIGHT, DENIM);
    let file = home.join("file");
    fs::write(&file, "").unwrap();
    for place in [file.clone(), file.join("below")] {
        let (figures, warnings) = drawn(home, &path, &["--cache", place.to_str().unwrap()]);
        assert_eq!(figures["peaks"]["built"], 1);
        assert!(warnings.starts_with(&format!("warning: peaks are not kept in {}: ", place.display())), "{warnings}");
    }
    assert_eq!(fs::read(&file).unwrap(), b"");
}

#[test]
fn peaks_too_bright_for_their_storage_are_one_warning() {
    let directory = tempfile::tempdir().unwrap();
    let home = directory.path();
    let bumps = |slope: f64, amplitude: f64| {
        let map = format!("height_map = {{ generate = \"bumps\", size = 8, cells = 2, rms_slope = {slope} }}");
        let path = scene(home, LIGHT, &format!("{map}\npeaks = {{ amplitude = {amplitude} }}"));
        drawn(home, &path, &["--no-cache"]).1
    };
    assert_eq!((bumps(0.2, 15.0), bumps(3.0, 1.0)), (String::new(), String::new()));
    let warnings = bumps(3.0, 15.0);
    assert!(warnings.contains("peaks have an amplitude of 64 or more and were clamped"), "{warnings}");
    assert_eq!(warnings.lines().count(), 1);
}

#[test]
fn the_users_cache_is_taken_where_none_is_given_and_none_where_none_is_wanted() {
    let directory = tempfile::tempdir().unwrap();
    let home = directory.path();
    let path = scene(home, LIGHT, DENIM);
    drawn(home, &path, &["--no-cache"]);
    // Unfiltered frames need no fits.
    drawn(home, &path, &["--mode", "unfiltered"]);
    drawn(home, &scene(home, LIGHT, "highlight = {}"), &[]);
    assert!(!home.join(".cache").exists());
    let path = scene(home, LIGHT, DENIM);
    assert_eq!(drawn(home, &path, &[]).0["peaks"]["built"], 1);
    assert_eq!(kept(&home.join(".cache/roughxel")).len(), 1);
    assert_eq!(drawn(home, &path, &[]).0["peaks"]["read"], 1);

    for arguments in [&["--cache"][..], &["--cache", "x", "--no-cache"], &["--no-cache=yes"]] {
        for command in [&["render", "lake"][..], &["demo"]] {
            roughxel(home, &[command, arguments].concat()).ends(2);
        }
    }
}
