//! Bump pyramids against sums in floating point.

use super::*;

fn field(width: u32, height: u32, offset: impl Fn(u32, u32) -> [f32; 2]) -> BumpField {
    BumpField {
        width,
        height,
        offsets: (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| offset(x, y)).collect(),
        heights: None,
    }
}

fn options(kind: RoughnessKind, bits: u32) -> BumpOptions {
    let deviation = Deviation::RootMeanSquare;
    BumpOptions { negate: false, roughness: RoughnessStorage::new(kind, bits), deviation }
}

/// Offsets without structure, within ±1.
fn noise(x: u32, y: u32) -> [f32; 2] {
    let hash = |seed: u32| {
        let mut h = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca6b) ^ seed).wrapping_mul(0xc2b2_ae35);
        h ^= h >> 15;
        h = h.wrapping_mul(0x27d4_eb2f);
        (h >> 8) as f32 / (1 << 23) as f32 - 1.0
    };
    [hash(1), hash(2)]
}

fn real(raw: i32) -> f64 {
    f64::from(raw) / f64::from(1 << 28)
}

/// K = D Dᵀ of a decoded texel.
fn covariance(texel: &DecodedBump) -> [f64; 3] {
    let [d1, d2, d3] = texel.roughness.map(real);
    [d1 * d1 + d2 * d2, d2 * d3, d3 * d3]
}

/// Covariance of the decoded level 0 over the area of texel (x, y) of a level, in plain float64.
fn covariance_over_area(pyramid: &BumpPyramid, level: usize, x: u32, y: u32) -> [f64; 3] {
    let base = &pyramid.levels[0];
    let (w, h) = (pyramid.levels[level].width, pyramid.levels[level].height);
    let overlap = |k: u32, small: u32, index: u32, large: u32| {
        f64::from(((k + 1) * small).min((index + 1) * large).saturating_sub((k * small).max(index * large)))
    };
    let mut weights = Vec::new();
    for j in 0..base.height {
        for i in 0..base.width {
            let weight = overlap(i, w, x, base.width) * overlap(j, h, y, base.height);
            if weight > 0.0 {
                weights.push((weight, base.texel(i, j).decode(&pyramid.format).offset.map(real)));
            }
        }
    }
    let area: f64 = weights.iter().map(|(weight, _)| weight).sum();
    let mean = [0, 1].map(|axis| weights.iter().map(|(weight, b)| weight * b[axis]).sum::<f64>() / area);
    [(0, 0), (0, 1), (1, 1)].map(|(p, q)| {
        weights.iter().map(|(weight, b)| weight * (b[p] - mean[p]) * (b[q] - mean[q])).sum::<f64>() / area
    })
}

#[test]
fn roughness_is_the_covariance_over_the_whole_area_at_any_size() {
    for (width, height) in [(1, 1), (2, 2), (16, 16), (7, 7), (13, 4), (1, 9), (37, 5), (20, 12)] {
        for bits in [8, 12, 16] {
            let pyramid =
                BumpPyramid::new(&field(width, height, noise), None, &options(RoughnessKind::Anisotropic, bits));
            let lsb = power_of_two(pyramid.format.roughness_exponent - bits as i32);
            for (l, level) in pyramid.levels.iter().enumerate() {
                for y in 0..level.height {
                    for x in 0..level.width {
                        let decoded = level.texel(x, y).decode(&pyramid.format);
                        let [d1, d2, d3] = decoded.roughness.map(|d| real(d).abs());
                        let expected = covariance_over_area(&pyramid, l, x, y);
                        // Each d is off by half a step; 1e-15 for the float64 sums of this test.
                        let bounds = [
                            (d1 + d2) * lsb + 0.5 * lsb * lsb,
                            (d2 + d3) * 0.5 * lsb + 0.25 * lsb * lsb,
                            d3 * lsb + 0.25 * lsb * lsb,
                        ];
                        for ((got, expected), bound) in covariance(&decoded).iter().zip(expected).zip(bounds) {
                            assert!(
                                (got - expected).abs() <= bound + 1e-15,
                                "{width}x{height}, {bits} bits, level {l}, ({x}, {y}): {got} for {expected}"
                            );
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_recursion_of_s97_needs_its_plus_and_equals_the_covariance() {
    // One step by S97 §8 from the K of level 1 and the exact means; 8×8 → level 2, with and without the plus.
    let pyramid = BumpPyramid::new(&field(8, 8, noise), None, &options(RoughnessKind::Anisotropic, 16));
    let k1: Vec<[f64; 3]> = (0..16).map(|index| covariance_over_area(&pyramid, 1, index % 4, index / 4)).collect();
    let mean = |level: usize, x: u32, y: u32| {
        let size = 8 >> pyramid.levels[level].width.ilog2();
        let mut sum = [0.0; 2];
        for j in 0..size {
            for i in 0..size {
                let texel = pyramid.levels[0].texel(x * size + i, y * size + j);
                for (sum, b) in sum.iter_mut().zip(texel.decode(&pyramid.format).offset) {
                    *sum += real(b) / f64::from(size * size);
                }
            }
        }
        sum
    };
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let mean_above = mean(2, x, y);
        let (mut with_plus, mut first_sum_only) = ([0.0; 3], [0.0; 3]);
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (u, v) = (2 * x + i, 2 * y + j);
            let k = k1[(4 * v + u) as usize];
            let f = mean(1, u, v);
            let d = [f[0] - mean_above[0], f[1] - mean_above[1]];
            let spread = [d[0] * d[0], d[0] * d[1], d[1] * d[1]];
            for slot in 0..3 {
                with_plus[slot] += (k[slot] + spread[slot]) / 4.0;
                first_sum_only[slot] += k[slot] / 4.0;
            }
        }
        let expected = covariance_over_area(&pyramid, 2, x, y);
        for slot in 0..3 {
            // Two float64 sums over 16 values below 1.
            assert!((with_plus[slot] - expected[slot]).abs() < 1e-14);
        }
        assert!((first_sum_only[0] - expected[0]).abs() > 1e-3);
    }
}

#[test]
fn corrugated_maps_in_every_direction_have_a_factor_along_it() {
    for degree in (0..360).step_by(5) {
        let (sin, cos) = (degree as f32).to_radians().sin_cos();
        let corrugated = field(8, 8, |x, _| {
            let wave = if x % 2 == 0 { 0.45 } else { -0.45 };
            [wave * cos, wave * sin]
        });
        for bits in [2, 4, 8, 16] {
            let pyramid = BumpPyramid::new(&corrugated, None, &options(RoughnessKind::Anisotropic, bits));
            let lsb = power_of_two(pyramid.format.roughness_exponent - bits as i32);
            let decoded = pyramid.levels[1].texel(0, 0).decode(&pyramid.format);
            let [a, b, c] = covariance(&decoded);
            // d₁²·d₃² of the decoded factor; the subtraction rounds in the last bit of a·c.
            assert!(a >= 0.0 && c >= 0.0 && a * c - b * b >= -1e-15);
            // The variance across the waves is 0; quantisation adds about a step squared.
            let (s, t) = (f64::from(sin), f64::from(cos));
            let across = a * s * s - 2.0 * b * s * t + c * t * t;
            assert!(across <= 2.0 * lsb * lsb, "{degree}° at {bits} bits: {across}");
        }
    }
}

#[test]
fn waves_along_u_alone_leave_d2_and_d3_zero() {
    let waves = field(4, 4, |x, _| [if x % 2 == 0 { 0.5 } else { -0.5 }, 0.25]);
    let pyramid = BumpPyramid::new(&waves, None, &options(RoughnessKind::Anisotropic, 8));
    let decoded = pyramid.levels[1].texel(1, 1).decode(&pyramid.format);
    assert_eq!(decoded.roughness, [1 << 27, 0, 0]);
    assert_eq!(decoded.offset, [0, 1 << 26]);
}

#[test]
fn anticorrelated_offsets_have_a_negative_d2_at_both_signs() {
    let waves = field(2, 2, |x, _| if x == 0 { [0.5, -0.25] } else { [-0.5, 0.25] });
    for negate in [false, true] {
        let options = BumpOptions { negate, ..options(RoughnessKind::Anisotropic, 8) };
        let pyramid = BumpPyramid::new(&waves, None, &options);
        let decoded = pyramid.levels[1].texel(0, 0).decode(&pyramid.format);
        assert_eq!(decoded.roughness, [0, -(1 << 27), 1 << 26]);
    }
}

#[test]
fn negated_maps_mirror_each_other_bit_by_bit() {
    let options = |negate| BumpOptions { negate, ..options(RoughnessKind::Anisotropic, 8) };
    let plus = BumpPyramid::new(&field(9, 5, noise), None, &options(false));
    let minus = BumpPyramid::new(&field(9, 5, noise), None, &options(true));
    assert_eq!(plus.format, minus.format);
    for (plus, minus) in plus.levels[0].offsets.iter().zip(&minus.levels[0].offsets) {
        assert_eq!(plus.map(|b| -b), *minus);
    }
    for (plus, minus) in plus.levels.iter().zip(&minus.levels) {
        assert_eq!(plus.roughness, minus.roughness);
    }
}

#[test]
fn flat_maps_have_no_roughness_at_any_level() {
    for (width, height) in [(1, 1), (8, 8), (7, 3)] {
        let flat = field(width, height, |_, _| [0.3, -0.7]);
        let pyramid = BumpPyramid::new(&flat, None, &options(RoughnessKind::Anisotropic, 16));
        assert!(pyramid.is_smooth());
        let last = pyramid.levels.len() - 1;
        assert!(!pyramid.lost_detail(last));
        assert_eq!(pyramid.levels[last].offsets[0], pyramid.levels[0].offsets[0]);
    }
}

#[test]
fn detail_is_lost_from_the_first_level_that_averages_it() {
    // Two texels a period along u only: level 0 shows all, level 1 nothing.
    let pyramid = BumpPyramid::new(
        &field(8, 8, |x, _| [if x < 4 { 0.5 } else { -0.5 }, 0.0]),
        None,
        &options(RoughnessKind::Isotropic, 8),
    );
    let lost: Vec<_> = (0..5).map(|level| pyramid.lost_detail(level)).collect();
    assert_eq!(lost, [false, false, false, true, false]);
    let averaged = BumpPyramid::new(&field(8, 8, noise), None, &options(RoughnessKind::None, 8));
    assert!(averaged.is_smooth());
}

#[test]
fn a_roughness_map_reaches_every_level_and_variances_add() {
    let waves = field(2, 2, |x, _| [if x == 0 { 0.4 } else { -0.4 }, 0.0]);
    let uniform = RoughnessField { width: 1, height: 1, factors: vec![[0.3, 0.0, 0.3]] };
    let varied = RoughnessField { factors: vec![[0.3, 0.0, 0.1], [0.0; 3], [0.0; 3], [0.3, 0.0, 0.5]], ..map(2, 2) };
    for (roughness, level_0, d3) in [(uniform, [0.3, 0.3], 0.3_f64), (varied, [0.3, 0.1], 0.065_f64.sqrt())] {
        let pyramid = BumpPyramid::new(&waves, Some(&roughness), &options(RoughnessKind::Anisotropic, 16));
        let factor = |level: usize| pyramid.levels[level].texel(0, 0).decode(&pyramid.format).roughness.map(real);
        // Half a step of 2⁻¹⁶ from D, twice that from the 16-bit offsets and factors of the map.
        let near = |a: f64, b: f64| (a - b).abs() <= 1.5 * power_of_two(-16);
        assert!(near(factor(0)[0], level_0[0]) && near(factor(0)[2], level_0[1]), "{:?}", factor(0));
        // Mean of the map's variances along u: 0.3² or half of it.
        let d1 = if roughness.factors.len() == 1 { 0.5 } else { (0.16 + 0.045_f64).sqrt() };
        assert!(near(factor(1)[0], d1) && factor(1)[1] == 0.0 && near(factor(1)[2], d3), "{:?}", factor(1));
    }
}

/// A roughness map without roughness.
fn map(width: u32, height: u32) -> RoughnessField {
    RoughnessField { width, height, factors: vec![[0.0; 3]; (width * height) as usize] }
}

#[test]
fn a_roughness_map_of_zeros_changes_no_bit() {
    for kind in [RoughnessKind::Anisotropic, RoughnessKind::Isotropic, RoughnessKind::None] {
        let (bumps, options) = (field(13, 5, noise), options(kind, 8));
        let bare = BumpPyramid::new(&bumps, None, &options);
        assert_eq!(BumpPyramid::new(&bumps, Some(&map(13, 5)), &options), bare);
        assert_eq!(BumpPyramid::new(&bumps, Some(&map(1, 1)), &options), bare);
    }
}

#[test]
fn bumps_as_bumps_and_as_a_roughness_map_are_the_same_roughness_above_them() {
    // The covariance of each 2×2 block as a map of half the size, under the means of the blocks.
    let fine = BumpPyramid::new(&field(16, 16, noise), None, &options(RoughnessKind::Anisotropic, 16));
    let means = field(8, 8, |x, y| fine.levels[1].texel(x, y).decode(&fine.format).offset.map(|b| real(b) as f32));
    let factors = (0..64)
        .map(|index| fine.levels[1].texel(index % 8, index / 8).decode(&fine.format).roughness.map(|d| real(d) as f32));
    let roughness = RoughnessField { width: 8, height: 8, factors: factors.collect() };
    let coarse = BumpPyramid::new(&means, Some(&roughness), &options(RoughnessKind::Anisotropic, 16));
    for level in 1..5 {
        let (size, lsb) = (fine.levels[level].width, power_of_two(-15));
        for index in 0..size * size {
            let (x, y) = (index % size, index / size);
            let wanted = covariance(&fine.levels[level].texel(x, y).decode(&fine.format));
            let found = covariance(&coarse.levels[level - 1].texel(x, y).decode(&coarse.format));
            // Means and factors of |·| ≤ 1 were each rounded twice to 16 bits.
            assert!((0..3).all(|k| (wanted[k] - found[k]).abs() < 4.0 * lsb), "{wanted:?} {found:?}");
        }
    }
}

#[test]
fn offsets_beyond_8_saturate_and_are_counted() {
    let steep = field(2, 1, |x, _| if x == 0 { [1e9, f32::NAN] } else { [-8.0, 2.0] });
    let pyramid = BumpPyramid::new(&steep, None, &options(RoughnessKind::Anisotropic, 16));
    assert_eq!(pyramid.saturated, 2);
    assert_eq!(pyramid.format.offset_exponent, 3);
    let texel = |x| pyramid.levels[0].texel(x, 0).decode(&pyramid.format).offset;
    assert_eq!(texel(0), [32767 << 16, 0]);
    assert_eq!(texel(1), [-32767 << 16, 2 << 28]);
    let [d1, ..] = pyramid.levels[1].texel(0, 0).decode(&pyramid.format).roughness;
    assert!(d1 >= 0);
}

#[test]
fn the_scale_is_the_smallest_that_holds_the_map() {
    let exponent = |b: f32| {
        BumpPyramid::new(&field(1, 1, |_, _| [b, 0.0]), None, &options(RoughnessKind::None, 8)).format.offset_exponent
    };
    assert_eq!(exponent(0.0), -13);
    assert_eq!(exponent(0.9), 0);
    assert_eq!(exponent(-1.0), 1);
    assert_eq!(exponent(7.9), 3);
    assert_eq!(exponent(1e-9), -13);
}

#[test]
fn decoded_words_never_overflow_at_the_ends_of_all_formats() {
    for bits in 2..=16 {
        for roughness_exponent in [bits as i32 - 28, 3] {
            for offset_exponent in [-13, 3] {
                let format = BumpFormat {
                    offset_exponent,
                    roughness_exponent,
                    roughness: RoughnessStorage::new(RoughnessKind::Anisotropic, bits),
                };
                let largest = (1 << bits) - 1;
                let texel = BumpTexel { offset: [32767, -32767], roughness: [largest, -largest, largest] };
                let decoded = texel.decode(&format);
                let ratio = decoded.roughness[0] / largest;
                assert_eq!(decoded.roughness[1], -decoded.roughness[0]);
                assert_eq!(i64::from(ratio) * i64::from(largest), i64::from(decoded.roughness[0]));
                assert_eq!(decoded.offset[0], -decoded.offset[1]);
                assert!(decoded.offset[0] > 0 && decoded.roughness[0] > 0);
            }
        }
    }
}

#[test]
fn isotropic_roughness_is_at_least_the_largest_deviation() {
    let pyramid = BumpPyramid::new(&field(16, 9, noise), None, &options(RoughnessKind::Isotropic, 8));
    let lsb = power_of_two(pyramid.format.roughness_exponent - 8);
    for (l, level) in pyramid.levels.iter().enumerate().skip(1) {
        for y in 0..level.height {
            for x in 0..level.width {
                let [a, b, c] = covariance_over_area(&pyramid, l, x, y);
                let deviation = ((a + c + ((a - c) * (a - c) + 4.0 * b * b).sqrt()) / 2.0).sqrt();
                let [stored, rest @ ..] = level.texel(x, y).decode(&pyramid.format).roughness;
                // 1e-14 for the float64 sums of this test.
                assert!(real(stored) >= deviation - 1e-14);
                assert!(real(stored) <= deviation + lsb + 1e-14);
                assert_eq!(rest, [0, 0]);
            }
        }
    }
}

#[test]
fn texels_do_not_depend_on_the_number_of_threads() {
    let build = |threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map(|pool| {
            pool.install(|| BumpPyramid::new(&field(100, 63, noise), None, &options(RoughnessKind::Anisotropic, 8)))
        })
    };
    assert_eq!(build(1).ok(), build(3).ok());
}

/// Roughness of the coarsest level by most facets over that by all facets.
fn shrinkage(field: &BumpField) -> f64 {
    let [most, all] = [Deviation::Mean, Deviation::RootMeanSquare].map(|deviation| {
        let options = BumpOptions { deviation, ..options(RoughnessKind::Isotropic, 16) };
        let pyramid = BumpPyramid::new(field, None, &options);
        let [deviation, ..] = pyramid.levels.last().unwrap().texel(0, 0).decode(&pyramid.format).roughness;
        f64::from(deviation)
    });
    most / all
}

#[test]
fn bumps_of_the_normal_law_have_their_standard_deviation() {
    // Sums of twelve numbers.
    let normal = |x: u32, y: u32| {
        let sum = (0..12).fold([0.0; 2], |sum, k| {
            let one = noise(x + 1009 * k, y + 2003 * k);
            [sum[0] + one[0], sum[1] + one[1]]
        });
        sum.map(|component| 0.1 * component)
    };
    assert!((shrinkage(&field(64, 64, normal)) - 1.0).abs() < 0.03, "{}", shrinkage(&field(64, 64, normal)));
    // Twice as steep along one axis: deviations are in units of each direction's deviation.
    let long = |x, y| [2.0 * normal(x, y)[0], 0.5 * normal(x, y)[1]];
    assert!((shrinkage(&field(64, 64, long)) - 1.0).abs() < 0.03);
    // Grooves have one axis, and all are equally steep.
    let grooves = |x: u32, _| [if x.is_multiple_of(2) { 0.4 } else { -0.4 }, 0.0];
    assert_eq!(shrinkage(&field(64, 64, grooves)), 1.0);
}

#[test]
fn mostly_flat_bumps_are_less_rough_than_their_standard_deviation() {
    let seldom = |share: u32| {
        shrinkage(&field(
            64,
            64,
            |x: u32, y: u32| if (x + 5 * y).is_multiple_of(share) { noise(x, y) } else { [0.0; 2] },
        ))
    };
    assert!((0.55..0.8).contains(&seldom(2)), "{}", seldom(2));
    assert!((seldom(16) - 0.5).abs() < 1e-4, "{}", seldom(16));
}

#[test]
fn a_material_chooses_its_deviation() {
    let pyramid = |key: &str| {
        let text = format!(
            "[camera]\neye = [0, 2, 6]\ntarget = [0, 0, 0]\nfov_y = 40\nwidth = 4\nheight = 4\n\
             [[object]]\nshape = \"plane\"\n[object.material]\n{key}\n\
             normal_map = {{ generate = \"hammered\", size = 64, dents = 8, slope = 0.2 }}\n"
        );
        let scene = roughxel_scene::Scene::from_toml("dents", &text, std::path::Path::new("")).unwrap();
        BumpPyramid::of_material(&scene.objects[0].material, true, &Precision::STANDARD).unwrap()
    };
    assert_eq!(pyramid(""), pyramid("bump_deviation = \"mean\""));
    assert_ne!(pyramid(""), pyramid("bump_deviation = \"root-mean-square\""));
}
