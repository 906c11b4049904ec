//! Reflections of photographs as heights against 256 samples a pixel.
//!
//! `reflection-bars` prints the figures.

use std::path::Path;

use roughxel_core::precision::Precision;
use roughxel_host_tests::bars::reflection_figures;
use roughxel_host_tests::photographs::photograph;
use roughxel_maps::bump::BumpPyramid;
use roughxel_scene::Scene;

/// Lines of a material with two lobes of the law of its map.
const LAW: &str = "bump_deviation = \"law\"";
/// Lines of a material with one lobe of the same variance.
const ONE_LOBE: &str = "bump_deviation = \"root-mean-square\"\ntwo_lobes = false";

/// Largest ratio of the brightest band and channel to its truth; with one lobe it is up to 1.35.
const BRIGHTEST: f64 = 1.22;

#[test]
fn lobes_of_the_maps_own_law_bring_the_far_bands_nearer_to_the_truth() {
    let far = |name: &str, slope: f64, keys: &str| {
        let figures = reflection_figures(name, slope, keys)?;
        // Near bands show single bumps, so their lobe is not that of the map.
        let ratios = figures.bands[..2].as_flattened();
        let most = ratios.iter().fold(0.0, |most: f64, ratio| most.max(*ratio));
        let error = ratios.iter().map(|ratio| ratio.log2().powi(2)).sum::<f64>() / ratios.len() as f64;
        Some((most, error.sqrt(), figures.psnr))
    };
    let cases =
        [("gravel.png", 0.25), ("gravel.png", 0.5), ("grass.png", 0.25), ("grass.png", 0.5), ("brick.png", 0.5)];
    for (name, slope) in cases {
        let Some((most, law, psnr)) = far(name, slope, LAW) else { return };
        let (before, one_lobe, psnr_before) = far(name, slope, ONE_LOBE).expect("the photograph exists");
        println!("{name}, {slope}: {before:.2} to {most:.2}, rms {one_lobe:.3} to {law:.3} octaves");
        assert!(most <= BRIGHTEST && law < one_lobe && psnr > psnr_before - 0.1, "{name}, {slope}");
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
