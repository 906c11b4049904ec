//! Picture bars at reduced sizes, and properties of every frame: same bits for any number of threads, effects that are planned away leave no trace,
//! no bit changes unnoticed. `picture-bars` prints the bars at full size.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use png::{BitDepth, ColorType, Decoder};
use roughxel_assets::picture::{linear_to_srgb8, write_png_srgb};
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::ReflectionOut;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_host_tests::bars::{self, MODES, two_shapes};
use roughxel_host_tests::reference::ground_plane::{GroundReference, GroundTexture};
use roughxel_host_tests::space::{profiles, whole_or};
use roughxel_reference_renderer::RealPicture;
use roughxel_scene::Scene;
use roughxel_shader::Effect;
use roughxel_simd::{Backend, InstructionSet};

fn scene(name: &str, width: u32, height: u32) -> Scene {
    Scene::builtin(name).unwrap().unwrap().with_size(width, height).unwrap()
}

fn draw(scene: &Scene, mode: Mode, profile: &Precision) -> Frame {
    Prepared::new(scene, mode, profile).unwrap().render(&|| ()).unwrap()
}

#[test]
fn frames_are_the_float64_filter_up_to_the_bar_of_their_profile() {
    for name in bars::SCENES {
        let scene = scene(name, 160, 120);
        for (profile, precision) in profiles() {
            let Some(bar) = bars::arithmetic_bar(profile) else { continue };
            let psnr = bars::psnr_against_float(&scene, Mode::Footprint, &precision).unwrap();
            assert!(psnr >= bar, "{name}, {profile}: {psnr:.1} dB");
        }
    }
}

#[test]
fn every_mode_is_its_float64_picture() {
    for name in bars::SCENES {
        let scene = scene(name, 96, 72);
        for mode in MODES {
            let psnr = bars::psnr_against_float(&scene, mode, &Precision::STANDARD).unwrap();
            assert!(psnr >= 55.0, "{name}, {mode}: {psnr:.1} dB");
        }
    }
}

/// Any footprint: a core narrow enough for a face, a whole lobe on the sphere.
#[test]
fn two_lobes_are_their_float64_picture_in_every_backend() {
    are_their_float64_picture_in_every_backend(&bars::two_lobes());
}

#[test]
fn lobes_of_a_law_are_their_float64_picture_in_every_backend() {
    are_their_float64_picture_in_every_backend(&bars::lobes_of_a_law());
}

fn are_their_float64_picture_in_every_backend(scene: &Scene) {
    for (profile, precision) in profiles() {
        for mode in [Mode::Isotropic, Mode::Footprint] {
            let prepared = Prepared::new(scene, mode, &precision).unwrap();
            assert!(prepared.plans().all(|plan| plan.has(Effect::TwoLobes)));
            let scalar = prepared.with_backend(Backend::Scalar).render(&|| ()).unwrap();
            for set in InstructionSet::available() {
                let lanes = Prepared::new(scene, mode, &precision).unwrap().with_backend(Backend::Simd(set));
                assert_eq!(lanes.render(&|| ()).unwrap().digest(), scalar.digest(), "{profile}, {mode}, {set}");
            }
            if profile == "standard" {
                let psnr = bars::psnr_against_float(scene, mode, &precision).unwrap();
                assert!(psnr >= 55.0, "{mode}: {psnr:.1} dB");
            }
        }
    }
}

#[test]
fn filtering_is_10_db_better_than_none_and_better_than_16_samples() {
    for name in bars::FILTERED_SCENES {
        let figures = bars::scene_figures(&scene(name, 160, 120), &Precision::STANDARD, 16, &|| ()).unwrap();
        assert!(figures.holds(), "{name}: {figures:?}");
    }
}

#[test]
fn footprints_on_the_ground_plane_reach_35_db_at_40_texels_a_pixel() {
    for texture in [GroundTexture::Checker, GroundTexture::Noise { seed: 1 }] {
        let reference = GroundReference::new(texture, 1024);
        let figures = bars::ground_plane(texture, &reference, &Precision::STANDARD);
        assert!(figures.psnr >= bars::GROUND_BAR && figures.texels <= bars::GROUND_TEXELS, "{texture:?}: {figures:?}");
    }
}

#[test]
fn a_smooth_environment_has_no_step_across_the_edges_of_the_cube() {
    for (profile, p) in profiles() {
        let step = bars::cube_edge_step(&p);
        let held = [step.probe, step.lobe, step.lobe_on_sphere];
        assert!(held.iter().all(|step| *step <= bars::CUBE_EDGE_BAR), "{profile}: {step:?}");
    }
}

#[test]
fn frames_are_the_same_bits_for_any_number_of_threads() {
    let (width, height) = whole_or((200, 150), (100, 75));
    for name in bars::SCENES {
        let digest = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| draw(&scene(name, width, height), Mode::Footprint, &Precision::STANDARD).digest())
        };
        let one = digest(1);
        for threads in [2, 7] {
            assert_eq!(digest(threads), one, "{name}, {threads} threads");
        }
    }
}

#[test]
fn a_white_colour_map_is_one_code_from_no_map() {
    let bare = two_shapes("checker", "", "colour = [0.5, 0.25, 1]");
    let white = "colour_map = { generate = \"checker\", size = 16, squares = 2, light = [1, 1, 1], dark = [1, 1, 1] }";
    let mapped = two_shapes("checker", "", &format!("colour = [0.5, 0.25, 1], {white}"));
    for mode in MODES {
        let [bare, mapped] = [&bare, &mapped].map(|scene| draw(scene, mode, &Precision::STANDARD));
        for (a, b) in bare.pixels.iter().flatten().zip(mapped.pixels.iter().flatten()) {
            // 1 is stored as 65535/65536: 2^8 last places of 2^24, for a colour of 1.
            assert!((0..=1 << 8).contains(&(a - b)), "{mode}: {a} {b}");
        }
    }
}

#[test]
fn zero_roughness_and_zero_curvature_change_no_bit_of_any_fragment() {
    for (name, profile) in [("zebra", Precision::STANDARD), ("lake", Precision::COMPACT), ("globe", Precision::PRECISE)]
    {
        let scene = scene(name, 64, 48);
        let fragments = Prepared::new(&scene, Mode::Footprint, &profile).unwrap().capture(400).unwrap();
        assert!(fragments.len() > 100);
        for (fragment, plan) in fragments {
            let mut smooth = fragment;
            smooth.surface.roughness = Default::default();
            smooth.dnormal = Default::default();
            let run = |roughness, curvature| -> ReflectionOut {
                smooth.reflect(&ReflectionPlan { roughness, curvature, ..plan }, &profile)
            };
            let bare = run(RoughnessKind::None, false);
            for roughness in [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic] {
                assert_eq!(run(roughness, true), bare, "{name}: {smooth:?}");
            }
        }
    }
}

#[test]
fn golden_frames_are_the_same_bits() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(bars::GOLDEN_FRAMES);
    let golden = std::fs::read_to_string(&path).unwrap();
    let drawn = bars::golden_frames().unwrap();
    let first = golden.lines().zip(drawn.lines()).find(|(golden, drawn)| golden != drawn);
    assert_eq!(first, None, "if the change is meant: picture-bars --bless, and say why in the changelog");
    assert_eq!(golden.lines().count(), drawn.lines().count());
}

#[test]
fn written_pictures_are_read_back_pixel_by_pixel() {
    let picture = draw(&scene("globe", 160, 120), Mode::Footprint, &Precision::STANDARD).picture();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("globe.png");
    write_png_srgb(&path, &picture).unwrap();
    let mut file = Decoder::new(BufReader::new(File::open(&path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; file.output_buffer_size().unwrap()];
    let read = file.next_frame(&mut bytes).unwrap();
    assert_eq!((read.color_type, read.bit_depth), (ColorType::Rgb, BitDepth::Eight));
    assert_eq!((read.width, read.height), (picture.width, picture.height));
    assert_eq!(bytes.len(), 3 * picture.pixels.len());
    for (index, pixel) in (0..).zip(bytes.chunks_exact(3)) {
        let (x, y) = (index % read.width, index / read.width);
        assert_eq!(pixel, picture.pixel(x, y).map(linear_to_srgb8), "({x}, {y})");
    }
}

#[test]
fn psnr_counts_every_channel_against_a_range_of_1() {
    let grey = |value| RealPicture { width: 2, height: 1, pixels: vec![[value; 3]; 2] };
    let mut one_channel = grey(0.5);
    one_channel.pixels[0][1] = 0.6;
    // One of six channels off by 0.1: 10·log₁₀(6/0.01); 1e-9 for the float64 logarithm.
    assert!((one_channel.psnr(&grey(0.5)) - 10.0 * 600_f64.log10()).abs() < 1e-9);
    assert_eq!(grey(7.0).psnr(&grey(1.0)), f64::INFINITY);
}

/// A filter looks along one surface; if two meet in a pixel, each counts by its coverage.
#[test]
fn silhouettes_have_as_many_shades_as_samples() {
    let scene = two_shapes("checker", "", "colour = [1, 1, 1]");
    let p = Precision::STANDARD;
    let dark = |frame: &Frame| {
        let mut shades: Vec<i32> = frame.pixels.iter().map(|pixel| pixel[0]).collect();
        shades.sort_unstable();
        shades.dedup();
        shades.len()
    };
    let scene = Scene { background: roughxel_scene::Background::Colour([0.0; 3]), ..scene };
    let truth = draw(&scene, Mode::Supersampled { edge: 16 }, &p);
    let [none, filtered] = [Mode::Unfiltered, Mode::Footprint].map(|mode| draw(&scene, mode, &p));
    assert_eq!((dark(&none), dark(&filtered)), (2, 9));
    let [none, filtered] = [none, filtered].map(|frame| frame.psnr(&truth));
    println!("silhouettes: {none:.1} dB without, {filtered:.1} dB with coverage");
    assert!(filtered > none + 9.0, "{none:.1} {filtered:.1}");
}
