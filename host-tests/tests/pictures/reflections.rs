//! Reflections of photographs as heights against 1024 samples a pixel.
//!
//! `reflection-bars` prints the figures.

use std::path::Path;

use roughxel_core::precision::Precision;
use roughxel_host_tests::bars::{Case, LAW, ONE_LOBE, ReflectionFigures, SUN, Shape, World, reflection_figures, suns};
use roughxel_host_tests::photographs::photograph;
use roughxel_maps::bump::BumpPyramid;
use roughxel_scene::Scene;

/// Largest ratio of the brightest far band and channel to its truth under [`SUN`]; with one lobe it is up to 1.32.
const BRIGHTEST: f64 = 1.22;
/// Root mean square of log₂ of the brightness of far bands over their truth: two lobes over one.
const REST: f64 = 0.7;

/// One sun shows the density of slopes at one point, so a lobe is judged by many suns.
#[test]
fn lobes_of_the_maps_own_law_bring_the_far_bands_nearer_to_the_truth() {
    // The largest error of the mean over all suns, of any band and channel.
    let cases = [
        ("gravel.png", 0.25, 0.04),
        ("gravel.png", 0.5, 0.04),
        ("grass.png", 0.25, 0.04),
        ("grass.png", 0.5, 0.06),
        ("brick.png", 0.5, 0.1),
    ];
    for (name, slope, bar) in cases {
        let figures: Option<Vec<[ReflectionFigures; 2]>> =
            suns().into_iter().map(|sun| reflection_figures(name, slope, [LAW, ONE_LOBE], sun)).collect();
        let Some(figures) = figures else { return };
        let at_sun = suns().iter().position(|sun| *sun == SUN).expect("it is one of the suns");
        let brightest =
            figures[at_sun][0].bands[..2].as_flattened().iter().fold(0.0, |most: f64, ratio| most.max(*ratio));
        let [law, one_lobe] = [0, 1].map(|i| figures.iter().map(|pair| pair[i]).collect::<Vec<_>>());
        let error = |figures: &[ReflectionFigures]| {
            // Near bands show single bumps, so their lobe is not that of the map.
            let ratios: Vec<f64> =
                figures.iter().flat_map(|figures| figures.bands[..2].as_flattened()).copied().collect();
            (ratios.iter().map(|ratio| ratio.log2().powi(2)).sum::<f64>() / ratios.len() as f64).sqrt()
        };
        let (rest, before) = (error(&law), error(&one_lobe));
        let [law, one_lobe] = [law, one_lobe].map(|figures| ReflectionFigures::mean(&figures));
        let [least, most] = law.range();
        println!("{name}, {slope}: mean {least:.3} to {most:.3}, rms {before:.3} to {rest:.3} octaves");
        assert!(least > 1.0 - bar && most < 1.0 + bar && rest < REST * before, "{name}, {slope}");
        assert!(brightest <= BRIGHTEST && law.psnr > one_lobe.psnr - 0.1, "{name}, {slope}: {brightest}");
    }
}

/// Checks four mirrors of the suite of the world: range of brightness over the truth, and gain over one lobe, dB.
#[test]
fn bumps_of_others_under_panoramas_of_others_are_nearly_as_bright_as_their_facets() {
    let world = match World::open() {
        Ok(world) => world,
        Err(error) => {
            assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "{error}");
            eprintln!("SKIPPED: {error}");
            return;
        }
    };
    let bars = [
        ("gravel.png", Some(0.1), Shape::Plane, "night", 0.04, 4.0),
        ("brick.png", Some(0.25), Shape::Plane, "city", 0.05, 0.4),
        ("grass.png", Some(0.25), Shape::Mesh, "forest", 0.05, 1.2),
        ("0021", None, Shape::Plane, "park", 0.09, 2.2),
    ];
    for (bumps, slope, shape, sky, bar, gain) in bars {
        let is_it = |case: &Case| (case.bumps, case.rms_slope, case.shape, case.sky) == (bumps, slope, shape, sky);
        let case = World::cases().into_iter().find(is_it).expect("a case of the suite");
        let [as_is, one_lobe, law] = world.outcome(case).figures;
        let [least, most] = law.range();
        println!("{bumps}, {sky}: {least:.3} to {most:.3}, {:.2} dB", law.psnr - one_lobe.psnr);
        assert!(least > 1.0 - bar && most < 1.0 + bar, "{bumps}, {sky}: {least} to {most}");
        assert!(law.psnr > one_lobe.psnr + gain && law.psnr > as_is.psnr, "{bumps}, {sky}");
    }
}

/// Weight of the narrower lobe and both widths, fitted to every slope of a photograph by a different program (numpy, float64).
#[test]
fn the_laws_of_photographs_are_those_of_their_slopes() {
    let fits =
        [("gravel.png", [0.48, 0.42, 1.32]), ("grass.png", [0.44, 0.47, 1.27]), ("brick.png", [0.63, 0.09, 1.64])];
    for (name, fit) in fits {
        let Some(piece) = photograph(name, 512) else { return };
        let text = format!(
            "[camera]\neye = [0, 2, 6]\ntarget = [0, 0, 0]\nfov_y = 40\nwidth = 4\nheight = 4\n\
             [[object]]\nshape = \"plane\"\n[object.material]\n{LAW}\n\
             height_map = {{ path = {:?}, rms_slope = 0.5 }}\n",
            piece.path().display().to_string()
        );
        let scene = Scene::from_toml("law", &text, Path::new("")).expect("the scene is valid");
        let pyramid = BumpPyramid::of_material(&scene.objects[0].material, true, &Precision::STANDARD).unwrap();
        let law = pyramid.laws.last().expect("the slopes are not normally distributed");
        let [weight, narrow, wide] = [(law.weight, 16), (law.widths[0], 12), (law.widths[1], 12)]
            .map(|(code, bits)| f64::from(code) / f64::from(1 << bits));
        println!("{name}: {weight:.3} of {narrow:.3}, the rest of {wide:.3}");
        for (found, fitted) in [weight, narrow, wide].into_iter().zip(fit) {
            assert!((found - fitted).abs() < 0.03, "{name}: {law:?}");
        }
        // Single texels hold the scale of their bumps.
        assert!(pyramid.laws[0].is_one_lobe(), "{name}");
    }
}
