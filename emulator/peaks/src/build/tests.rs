//! Pyramids: contents of each level, and the circumstances that do not change them.

use super::*;
use roughxel_scene::Edges;

pub(crate) const OPTIONS: BuildOptions =
    BuildOptions { exponent: 40.0, amplitude: 1.0, weight: FacetWeight::Surface, negate: false };

/// Rounded hills of many slopes, with their heights.
pub(crate) fn hills(width: u32, height: u32) -> PeakSource {
    let heights: Vec<f64> = (0..width * height)
        .map(|index| {
            let [x, y] = [index % width, index / width].map(f64::from);
            1.3 * libm::sin(1.7 * x + 0.4 * y) + 0.8 * libm::cos(0.9 * y - 0.3 * x)
        })
        .collect();
    let at = |x: u32, y: u32| heights[(y % height * width + x % width) as usize];
    let normals = (0..width * height)
        .map(|index| {
            let (x, y) = (index % width, index / width);
            let slope = [at(x + 1, y) - at(x + width - 1, y), at(x, y + 1) - at(x, y + height - 1)];
            DVec3::new(-0.5 * slope[0], -0.5 * slope[1], 1.0)
        })
        .collect();
    PeakSource { width, height, normals, heights: Some(heights), rows_apart: 1.0, edges: Edges::Wrapped }
}

fn build(source: &PeakSource, options: &BuildOptions) -> PeakPyramid {
    PeakPyramid::build(source, options, &|_| ()).expect("the source is good")
}

#[test]
fn level_0_has_each_texels_own_normal_and_horizon() {
    let source = hills(5, 3);
    let pyramid = build(&source, &BuildOptions { amplitude: 0.5, ..OPTIONS });
    let slopes = horizon_slopes(5, 3, source.heights.as_deref().expect("heights are given"), Edges::Wrapped);
    for (index, (normal, slopes)) in source.normals.iter().zip(slopes).enumerate() {
        let &[peak] = pyramid.levels[0].texel(index as u32 % 5, index as u32 / 5) else { panic!("one peak") };
        let normal = normal.normalize();
        assert!((peak.normal - normal).length() < 1e-15 && peak.exponent == 40.0);
        assert!((peak.amplitude - 0.5 / normal.z).abs() < 1e-15);
        for (horizon, slope) in peak.horizon.expect("heights are given").iter().zip(slopes) {
            assert!((horizon.mean - slope).abs() <= 1e-15 * slope && horizon.deviation == 0.0);
        }
    }
}

#[test]
fn at_most_seven_normals_are_kept_as_they_are() {
    // Seven directions in a map whose sizes do not divide.
    let direction = |index: usize| DVec3::new(index as f64 * 0.1, 0.2, 1.0);
    let normals: Vec<DVec3> = (0..15).map(|index| direction(index % 7) * f64::from(1 << (index % 4))).collect();
    let source = PeakSource {
        width: 5,
        height: 3,
        normals,
        heights: Some(vec![0.0; 15]),
        rows_apart: 1.0,
        edges: Edges::Wrapped,
    };
    let pyramid = build(&source, &BuildOptions { weight: FacetWeight::Texel, ..OPTIONS });
    assert_eq!(pyramid.fits, FitCounts::default());
    let top = pyramid.levels[2].texel(0, 0);
    assert_eq!(top.len(), 7);
    for peak in top {
        let index = (0..7).find(|index| (direction(*index).normalize() - peak.normal).length() < 1e-14);
        let texels = if index == Some(0) { 3.0 } else { 2.0 };
        assert!((peak.amplitude - texels / 15.0).abs() < 1e-15 && peak.exponent == 40.0, "{peak:?}");
        assert_eq!(peak.horizon, Some([Horizon::default(); 4]));
    }
    // Half of the middle column belongs to each side.
    let left: f64 = pyramid.levels[1].texel(0, 0).iter().map(|peak| peak.amplitude).sum();
    assert_eq!((pyramid.levels[1].width, pyramid.levels[1].height), (2, 1));
    assert!((left - 1.0).abs() < 1e-15);
}

#[test]
fn horizons_of_shared_normals_have_their_mean_and_deviation() {
    let heights = vec![0.0, 1.0, 0.0, 3.0];
    let normals = vec![DVec3::Z; 4];
    let source =
        PeakSource { width: 4, height: 1, normals, heights: Some(heights), rows_apart: 1.0, edges: Edges::Wrapped };
    let pyramid = build(&source, &OPTIONS);
    let &[peak] = pyramid.levels[2].texel(0, 0) else { panic!("one normal") };
    let slopes = [3.0, 1.0, 1.0, 0.0];
    let mean = slopes.iter().sum::<f64>() / 4.0;
    let variance = slopes.iter().map(|slope| (slope - mean) * (slope - mean)).sum::<f64>() / 4.0;
    let horizon = peak.horizon.expect("heights are given")[0];
    assert!((horizon.mean - mean).abs() < 1e-14, "{horizon:?}");
    assert!((horizon.deviation - variance.sqrt()).abs() < 1e-14, "{horizon:?}");
}

#[test]
fn a_negated_frame_turns_normals_and_horizons_by_half_a_turn() {
    let source = hills(4, 4);
    let (plain, turned) = (build(&source, &OPTIONS), build(&source, &BuildOptions { negate: true, ..OPTIONS }));
    for (plain, turned) in plain.levels[0].peaks().iter().zip(turned.levels[0].peaks()) {
        assert_eq!(turned.normal, plain.normal * DVec3::new(-1.0, -1.0, 1.0));
        let [left, right, down, up] = plain.horizon.expect("heights are given");
        assert_eq!(turned.horizon, Some([right, left, up, down]));
    }
}

#[test]
fn rows_further_apart_have_a_lower_horizon() {
    let source = hills(4, 5);
    let (near, far) = (build(&source, &OPTIONS), build(&PeakSource { rows_apart: 4.0, ..source }, &OPTIONS));
    for (near, far) in near.levels[0].peaks().iter().zip(far.levels[0].peaks()) {
        let [left, right, down, up] = near.horizon.expect("heights are given").map(|side| side.mean);
        let wanted = [left, right, down / 4.0, up / 4.0];
        let got = far.horizon.expect("heights are given").map(|side| side.mean);
        for (got, wanted) in got.into_iter().zip(wanted) {
            assert!((got - wanted).abs() <= 1e-15 * wanted);
        }
    }
}

#[test]
fn progress_is_told_of_texels_that_may_take_a_fit() {
    let count = |source: &PeakSource| {
        let steps = std::sync::atomic::AtomicU64::new(0);
        let step = |done: Steps| {
            let (Steps::Fitted(done) | Steps::Found(done)) = done;
            steps.fetch_add(done, std::sync::atomic::Ordering::Relaxed);
        };
        PeakPyramid::build(source, &OPTIONS, &step).expect("the source is good");
        assert_eq!(steps.into_inner(), source.steps());
        source.steps()
    };
    // Two by two texels each, then four by four and all texels.
    assert_eq!(count(&hills(8, 8)), 4 + 1);
    assert_eq!(count(&hills(13, 3)), 3 + 1);
    assert_eq!(count(&hills(7, 1)), 0);
}

#[test]
fn the_base_is_level_0_of_the_pyramid() {
    let source = hills(5, 4);
    let base = PeakPyramid::base(&source, &OPTIONS).expect("the source is good");
    assert_eq!(base.levels, build(&source, &OPTIONS).levels[..1]);
}

#[test]
fn texels_do_not_depend_on_the_number_of_threads() {
    // Large enough that more than one thread sums the light.
    let large = hills(128, 40);
    for source in [PeakSource { heights: None, ..hills(6, 5) }, hills(6, 5), large] {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            pool.install(|| build(&source, &OPTIONS))
        };
        let alone = with(1);
        assert_eq!(alone.fits.fitted > 0, source.heights.is_none());
        assert_eq!(with(3), alone);
    }
}

#[test]
fn equal_neighbourhoods_share_the_fit_that_each_would_have() {
    let tile = PeakSource { heights: None, ..hills(4, 4) };
    let tiled = |columns: u32, rows: u32| {
        let place = |index: u32| (index / (4 * columns) % 4 * 4 + index % 4) as usize;
        let normals = (0..16 * columns * rows).map(|index| tile.normals[place(index)]).collect();
        PeakSource {
            width: 4 * columns,
            height: 4 * rows,
            normals,
            heights: None,
            rows_apart: 1.0,
            edges: Edges::Wrapped,
        }
    };
    let alone = multiple_surface(&tile, &OPTIONS).expect("the source is good");
    let base = Base::new(&tiled(4, 2), &OPTIONS).expect("the source is good");
    let covers = (covers(16, 4), covers(8, 2));
    let mut known = Known::new();
    let steps = std::sync::atomic::AtomicU64::new(0);
    let texels = base.texels(&covers, Part { level: 2, first: 0, texels: 8 }, &mut known, &|done| {
        steps.fetch_add(done, std::sync::atomic::Ordering::Relaxed);
    });
    assert_eq!((known.len(), steps.into_inner(), texels.fits.fitted), (1, 8, 8));
    assert!(alone.len() > 1 && texels.peaks.iter().all(|peaks| *peaks == alone));
    // The last bit of one normal makes a different neighbourhood.
    let mut source = tiled(4, 2);
    source.normals[5].x += 1e-15;
    let base = Base::new(&source, &OPTIONS).expect("the source is good");
    let mut known = Known::new();
    base.texels(&covers, Part { level: 2, first: 0, texels: 8 }, &mut known, &|_| ());
    assert_eq!(known.len(), 2);
}

/// Equal normals in other shadows form a different neighbourhood.
#[test]
fn equal_normals_with_other_horizons_share_nothing() {
    let flat = PeakSource { heights: Some(vec![0.0; 128]), ..hills(16, 8) };
    let mut source = flat.clone();
    source.normals = (0..128).map(|index| flat.normals[index / 64 * 64 + index % 4 + index / 16 % 4 * 16]).collect();
    let known = |source: &PeakSource| {
        let base = Base::new(source, &OPTIONS).expect("the source is good").with_light();
        let mut known = Known::new();
        let part = Part { level: 2, first: 0, texels: 8 };
        base.texels(&(covers(16, 4), covers(8, 2)), part, &mut known, &|_| ());
        known.len()
    };
    let same = known(&source);
    source.heights.iter_mut().flatten().step_by(37).for_each(|height| *height = 0.5);
    assert!(same <= 2 && known(&source) > same);
}

#[test]
fn a_multiple_surface_is_the_top_of_the_pyramid() {
    let source = hills(3, 7);
    let pyramid = build(&source, &OPTIONS);
    let top = pyramid.levels.last().map(|level| level.texel(0, 0));
    assert_eq!(multiple_surface(&source, &OPTIONS).ok().as_deref(), top);
}

#[test]
fn facets_that_face_inwards_have_no_amplitude() {
    let normals = vec![DVec3::new(0.3, 0.0, -1.0), DVec3::X];
    let source = PeakSource { width: 2, height: 1, normals, heights: None, rows_apart: 1.0, edges: Edges::Wrapped };
    let pyramid = build(&source, &OPTIONS);
    assert!(pyramid.levels[0].peaks().iter().all(|peak| peak.amplitude == 0.0));
    assert!(pyramid.levels[1].texel(0, 0).is_empty());
}

#[test]
fn one_texel_is_one_level() {
    let normals = vec![DVec3::new(0.0, 3.0, 4.0)];
    let source =
        PeakSource { width: 1, height: 1, normals, heights: Some(vec![9.0]), rows_apart: 1.0, edges: Edges::Wrapped };
    let pyramid = build(&source, &BuildOptions { weight: FacetWeight::Texel, ..OPTIONS });
    assert_eq!((pyramid.levels.len(), source.steps()), (1, 0));
    let &[peak] = pyramid.levels[0].texel(0, 0) else { panic!("one peak") };
    assert!((peak.normal - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-15);
    assert_eq!(peak.horizon, Some([Horizon::default(); 4]));
}

#[test]
fn bad_sources_and_options_are_named() {
    let error = |source: &PeakSource, options: &BuildOptions| {
        let error = PeakPyramid::build(source, options, &|_| ()).expect_err("it is bad");
        assert_eq!(multiple_surface(source, options), Err(error.clone()));
        error.to_string()
    };
    let with = |change: fn(&mut PeakSource)| {
        let mut source = hills(4, 4);
        change(&mut source);
        error(&source, &OPTIONS)
    };
    let size = "texels has no peak pyramid: 1 to 1048576 texels";
    assert_eq!(with(|source| source.width = 0), format!("a map of 0x4 {size}"));
    let large = with(|source| (source.width, source.height) = (u32::MAX, u32::MAX));
    assert!(large.ends_with(size), "{large}");
    assert_eq!(with(|source| source.normals.truncate(15)), "15 normals for 16 texels");
    assert_eq!(with(|source| source.heights = Some(Vec::new())), "0 heights for 16 texels");
    for bad in [DVec3::ZERO, DVec3::new(0.0, f64::NAN, 1.0), DVec3::new(f64::INFINITY, 0.0, 0.0)] {
        let mut source = hills(4, 4);
        source.normals[6] = bad;
        assert_eq!(error(&source, &OPTIONS), "the normal of texel (2, 1) has no direction");
    }
    for bad in [f64::NAN, f64::INFINITY, -2e9] {
        let mut source = hills(4, 4);
        source.heights.as_mut().expect("heights are given")[9] = bad;
        assert_eq!(error(&source, &OPTIONS), "the height of texel (1, 2) is no number within 10^9");
    }
    for rows_apart in [0.0, -1.0, f64::INFINITY] {
        let message = error(&PeakSource { rows_apart, ..hills(4, 4) }, &OPTIONS);
        assert_eq!(message, format!("rows that are {rows_apart} columns apart have no slopes"));
    }
    for exponent in [0.0, 0.99, 8192.1, f64::INFINITY, f64::NAN] {
        let message = error(&hills(4, 4), &BuildOptions { exponent, ..OPTIONS });
        assert_eq!(message, format!("an exponent of {exponent} is not within 1 to 8192"));
    }
    for amplitude in [-0.1, 1024.5] {
        let message = error(&hills(4, 4), &BuildOptions { amplitude, ..OPTIONS });
        assert_eq!(message, format!("an amplitude of {amplitude} is not within 0 to 1024"));
    }
}

#[test]
fn exponents_at_both_ends_give_finite_peaks_in_range() {
    for exponent in [1.0, 8192.0] {
        for peak in build(&hills(5, 4), &BuildOptions { exponent, ..OPTIONS }).levels.iter().flat_map(PeakLevel::peaks)
        {
            assert!(EXPONENTS.contains(&peak.exponent) && peak.amplitude.is_finite() && peak.normal.is_normalized());
        }
    }
}
