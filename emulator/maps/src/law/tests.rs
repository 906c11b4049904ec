use super::*;
use crate::bump::BumpPyramid;
use roughxel_core::precision::Precision;

/// Histogram of z² of a mixture: equally likely z² of each normal law.
fn mixture(parts: &[(f64, f64)]) -> Histogram {
    let mut histogram = Histogram::new();
    for &(weight, width) in parts {
        let count = (weight * 200_000.0) as u32;
        for index in 0..count {
            // In the plane, z² is exponentially distributed.
            let place = (f64::from(index) + 0.5) / f64::from(count);
            histogram.add(-2.0 * width * width * libm::log(place));
        }
    }
    histogram
}

#[test]
fn a_mixture_of_two_normal_laws_is_found() {
    for (weight, narrow) in [(0.48, 0.42), (0.44, 0.47), (0.63, 0.09)] {
        let wide = ((1.0 - weight * narrow * narrow) / (1.0_f64 - weight)).sqrt();
        let found = mixture(&[(weight, narrow), (1.0 - weight, wide)]).fit().unwrap();
        assert!(
            (found[0] - weight).abs() < 0.01 && (found[1] - narrow).abs() < 0.01,
            "{found:?} of {weight}, {narrow}"
        );
    }
}

#[test]
fn bumps_of_the_normal_law_have_one_lobe() {
    assert_eq!(mixture(&[(1.0, 1.0)]).fit(), None);
    assert_eq!(Histogram::new().fit(), None);
    assert_eq!(laws(&[mixture(&[(1.0, 1.0)]), mixture(&[(1.0, 1.0)])]), []);
    assert_eq!(laws(&[]), []);
}

#[test]
fn every_law_has_the_variance_one_to_the_last_place() {
    for weight in 0..=64 {
        for narrow in 0..=64 {
            let law = Law::new(f64::from(weight) / 64.0, f64::from(narrow) / 64.0);
            let [first, second] = law.widths.map(i64::from);
            let rest = (1 << 16) - i64::from(law.weight);
            let variance = |second: i64| i64::from(law.weight) * first * first + rest * second * second - (1 << 40);
            assert!(second <= 4 << WIDTH_BITS, "{law:?}");
            for other in [second - 1, second + 1] {
                assert!(variance(second).abs() <= variance(other).abs(), "{law:?}");
            }
        }
    }
    assert_eq!(Law::one_lobe(30_000).ports().widths, [Fx::int(1); 2]);
}

#[test]
fn levels_of_one_lobe_have_the_weight_of_their_neighbour() {
    let (normal, mixed) = (mixture(&[(1.0, 1.0)]), mixture(&[(0.5, 0.4), (0.5, 1.357)]));
    let laws = laws(&[normal.clone(), normal.clone(), mixed, normal]);
    assert_eq!(laws.len(), 5);
    assert!(laws.iter().all(|law| law.weight == laws[0].weight), "{laws:?}");
    assert_eq!(laws.iter().map(Law::is_one_lobe).collect::<Vec<_>>(), [true, false, true, true, true]);
}

/// The pyramid of a material with these keys.
fn pyramid(keys: &str) -> BumpPyramid {
    let text = format!(
        "[camera]\neye = [0, 2, 6]\ntarget = [0, 0, 0]\nfov_y = 40\nwidth = 4\nheight = 4\n\
         [[object]]\nshape = \"plane\"\n[object.material]\n{keys}\n"
    );
    let scene = roughxel_scene::Scene::from_toml("law", &text, std::path::Path::new("")).unwrap();
    BumpPyramid::of_material(&scene.objects[0].material, true, &Precision::STANDARD).unwrap()
}

#[test]
fn a_gaussian_map_has_the_bits_of_its_root_mean_square() {
    let waves = "height_map = { generate = \"waves\", size = 64, highest = 8, rms_slope = 0.2 }\nbump_deviation = ";
    let law = pyramid(&format!("{waves}\"law\""));
    assert_eq!(law.laws, []);
    assert_eq!(law, pyramid(&format!("{waves}\"root-mean-square\"")));
}

#[test]
fn rings_on_flat_water_have_a_law_and_the_roughness_of_their_root_mean_square() {
    let rings = "height_map = { generate = \"ripples\", size = 64, drops = 3, rms_slope = 0.2 }\nbump_deviation = ";
    let law = pyramid(&format!("{rings}\"law\""));
    println!("{:?}", law.laws);
    assert_eq!(law.laws.len(), law.levels.len());
    assert!(law.laws.iter().any(|law| !law.is_one_lobe()));
    let square = pyramid(&format!("{rings}\"root-mean-square\""));
    assert_eq!((law.levels, law.format), (square.levels, square.format));
    // The law of a map does not hold for the roughness of another one in addition.
    let more = "\nroughness_map = { generate = \"uniform\", along = 0.1, across = 0.1 }";
    assert_eq!(pyramid(&format!("{rings}\"law\"{more}")).laws, []);
}
