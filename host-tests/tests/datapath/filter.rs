//! Addresses, interpolation, the cube's corner and blending against integers and the float64 reference.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rayon::prelude::*;
use roughxel_core::bundle::{Bundle, End};
use roughxel_core::datapath::texel::{self, Quad};
use roughxel_core::fx::Fx;
use roughxel_core::precision::{Precision, ProbeWeights};
use roughxel_core::signals::{Probes, TexturePosition};
use roughxel_core::stage::blend::{blend, bright};
use roughxel_core::stage::filter::{
    self, Patch, ProbeSum, bright_corner, bright_texel, corner, face_address, levels, repeat_address,
};
use roughxel_core::stage::probes::weight;
use roughxel_host_tests::reference::filter::{Map, trilinear as reference_trilinear};
use roughxel_host_tests::space::profiles;
use roughxel_utilities::random::SplitMix64;

fn config() -> ProptestConfig {
    ProptestConfig { cases: 20_000, failure_persistence: None, rng_seed: RngSeed::Fixed(8), ..Default::default() }
}

/// A trilinear sample of scalar words: weights of the fine and the coarse level in 2^−10, of the level in 2^−12.
pub(super) fn trilinear(texels: [[i32; 4]; 2], weights: [[i32; 2]; 2], level: i32, extra: u32) -> i32 {
    let [fine, coarse] =
        [0, 1].map(|i| Patch { texels: texels[i].map(Fx::from_raw), weight: weights[i].map(Fx::from_raw) });
    filter::trilinear::<i32>(&fine, &coarse, Fx::from_raw(level), extra).raw()
}

#[test]
fn equal_texels_give_exactly_that_value_at_every_weight_and_level() {
    let mut random = SplitMix64::new(1);
    let weights: Vec<([[i32; 2]; 2], i32)> = (0..64)
        .map(|_| {
            let mut weight = || random.below(1024) as i32;
            let pairs = [[weight(), weight()], [weight(), weight()]];
            (pairs, random.below(4096) as i32)
        })
        .chain([([[0; 2]; 2], 0), ([[1023; 2]; 2], 4095), ([[0, 1023], [1023, 0]], 2048)])
        .collect();
    // Every 16-bit value at 67 weights; every level weight at a few values.
    (0..=65535).into_par_iter().for_each(|value| {
        for &(pairs, level) in &weights {
            assert_eq!(trilinear([[value; 4]; 2], pairs, level, 8), value << 8);
        }
    });
    for value in [0, 1, 32768, 65535] {
        for level in 0..4096 {
            assert_eq!(trilinear([[value; 4]; 2], [[511, 1], [77, 1023]], level, 8), value << 8);
        }
    }
    for value in [-1 << 30, -1, 0, 1, (1 << 30) - 1, 1 << 30, 3 << 29] {
        for &(pairs, level) in &weights {
            assert_eq!(trilinear([[value; 4]; 2], pairs, level, 0), value);
        }
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_sample_of_one_level_is_that_between_it_and_itself_at_every_weight(
        colours: [u16; 4],
        words in prop::array::uniform4(-(1_i32 << 30)..=1 << 30),
        weight in prop::array::uniform2(0_i32..1024),
        level in 0_i32..4096,
    ) {
        for (texels, extra) in [(colours.map(i32::from), 8), (words, 0)] {
            let patch = Patch { texels: texels.map(Fx::from_raw), weight: weight.map(Fx::from_raw) };
            let sample = filter::of_level::<i32>(&patch, extra);
            prop_assert_eq!(sample.raw(), trilinear([texels; 2], [weight; 2], level, extra));
            // The mean of one probe is exact, too.
            prop_assert_eq!(ProbeSum::<i32>::zero().add(sample, Fx::int(1)).mean(), sample);
        }
    }

    /// Weights of a sample are computed once for its channels: each channel has its own texels, each level its own weights.
    #[test]
    fn samples_of_all_channels_are_those_of_each(
        texels in prop::array::uniform2(prop::array::uniform4(prop::array::uniform5(-(1_i32 << 30)..=1 << 30))),
        weights in prop::array::uniform2(prop::array::uniform2(0_i32..1024)),
        level in 0_i32..4096,
    ) {
        for (extra, drop) in [(0, 0), (8, 15)] {
            let texels = texels.map(|quad| quad.map(|texel| texel.map(|channel| Fx::from_raw(channel >> drop))));
            let [fine, coarse] = [0, 1].map(|i| Quad::<i32, 5> {
                texels: texels[i],
                weight: weights[i].map(Fx::from_raw),
            });
            let level = Fx::from_raw(level);
            let samples = if extra == 8 { texel::colour_samples } else { texel::word_samples };
            let (both, one) = (samples(&fine, Some(&coarse), level), samples(&fine, None, level));
            for channel in 0..5 {
                let [fine, coarse] = [&fine, &coarse].map(|quad| Patch::<i32> {
                    texels: quad.texels.map(|texel| texel[channel]),
                    weight: quad.weight,
                });
                prop_assert_eq!(both[channel], filter::trilinear(&fine, &coarse, level, extra));
                prop_assert_eq!(one[channel], filter::of_level(&fine, extra));
            }
        }
    }

    #[test]
    fn a_trilinear_sample_is_right_within_a_last_place(
        texels: [[u16; 4]; 2],
        weights in prop::array::uniform2(prop::array::uniform2(0_i32..1024)),
        level in 0_i32..4096,
        words in prop::array::uniform2(prop::array::uniform4(-(1_i32 << 30)..=3 << 29)),
    ) {
        let exact = |texels: [u16; 4], [x, y]: [i32; 2]| {
            let [a, b, c, d] = texels.map(i64::from);
            let (x, y) = (i64::from(x), i64::from(y));
            (a * (1024 - x) + b * x) * (1024 - y) + (c * (1024 - x) + d * x) * y
        };
        // In units of 2^−32 of a texel.
        let (fine, coarse) = (exact(texels[0], weights[0]), exact(texels[1], weights[1]));
        let expected = fine * (4096 - i64::from(level)) + coarse * i64::from(level);
        let got = trilinear(texels.map(|level| level.map(i32::from)), weights, level, 8);
        // Each level is rounded to a word, then their mean: half a last place and again half a last place.
        prop_assert!(((i64::from(got) << 24) - expected).abs() <= 1 << 24);
        let colours = texels.map(|level| level.map(|texel| i32::from(texel) << 8));
        for (got, texels) in [(got, colours), (trilinear(words, weights, level, 0), words)] {
            let texels = texels.as_flattened();
            prop_assert!(texels.iter().min() <= Some(&got) && Some(&got) <= texels.iter().max(), "no over- or undershoot");
        }
    }

    #[test]
    fn bright_light_is_blended_exactly_and_cut_once(
        surface in 0_i32..1 << 30,
        mean in prop_oneof![0_i32..=i32::MAX, 0_i32..1 << 16, Just(i32::MAX)],
        exponent in 7_i32..=20,
        reflectance in prop_oneof![0_i32..=1 << 16, 0_i32..=64, Just(1_i32 << 16)],
    ) {
        let (surface_wire, reflectance_wire) = (Fx::from_raw(surface), Fx::from_raw(reflectance));
        let got = bright::<i32>(surface_wire, Fx::from_raw(mean), Fx::from_raw(exponent), reflectance_wire);
        let share = i128::from(reflectance);
        let exact = i128::from(surface) * ((1 << 16) - share) + ((i128::from(mean) * share) << (exponent - 7));
        let expected = ((exact + (1 << 15)) >> 16).min((64 << 24) - 1);
        prop_assert_eq!(i128::from(got.raw()), expected);
    }

    #[test]
    fn the_bright_texel_at_a_corner_is_the_mean_of_three(three in prop::array::uniform3(0_u16..=u16::MAX)) {
        let texels = three.map(|code| bright_texel(Fx::<i32, 32>::from_raw(code.into())));
        let mean = texels.map(|texel| f64::from(texel.raw())).iter().sum::<f64>() / 3.0;
        let got = f64::from(bright_corner(&texels).raw());
        // Half a last place, and a hundredth for float64.
        prop_assert!((got - mean).abs() <= 0.51 + mean * 2_f64.powi(-19), "{} of {}", got, mean);
    }

    #[test]
    fn blending_is_exact_at_both_ends_and_rounds_once_between(
        surface in 0_i32..1 << 30,
        reflection in 0_i32..1 << 30,
        reflectance in 0_i32..=1 << 16,
    ) {
        let by = |reflectance: i32| {
            blend::<i32>(Fx::from_raw(surface), Fx::from_raw(reflection), Fx::from_raw(reflectance)).raw()
        };
        prop_assert_eq!(by(0), surface);
        prop_assert_eq!(by(1 << 16), reflection);
        let share = i64::from(reflectance);
        let exact = i64::from(surface) * ((1 << 16) - share) + i64::from(reflection) * share;
        prop_assert_eq!(i64::from(by(reflectance)), (exact + (1 << 15)) >> 16);
    }
}

#[test]
fn samples_of_a_map_follow_the_reference() {
    let sizes = [(16, 16), (5, 3), (1, 7), (64, 2)];
    for (name, p) in profiles() {
        let mut worst = 0.0_f64;
        for index in 0..20_000_u64 {
            let mut random = SplitMix64::for_element(name, index);
            let (width, height) = sizes[index as usize % sizes.len()];
            let extents = [(width, height), ((width / 2).max(1), (height / 2).max(1))];
            let texels = extents.map(|(w, h)| (0..w * h).map(|_| random.below(65536) as i32).collect::<Vec<_>>());
            let maps: Vec<Map<1>> = extents
                .iter()
                .zip(&texels)
                .map(|(&(width, height), texels)| Map {
                    width,
                    height,
                    texels: texels.iter().map(|&texel| [f64::from(texel)]).collect(),
                })
                .collect();
            let uv = [0; 2].map(|_| i64::from(random.next_u64() as u32));
            let level = random.below(4096) as i32;
            let fetch = |which: usize| {
                let (w, h) = extents[which];
                let address = repeat_address::<i32>(
                    &TexturePosition { uv: uv.map(Fx::from_raw) },
                    [w, h].map(|edge| Fx::from_raw(edge as i32)),
                    &p,
                );
                let [x, y] = address.index.map(Fx::raw);
                let read = |dx: i32, dy: i32| {
                    let column = (x + dx).rem_euclid(w as i32) as usize;
                    let row = (y + dy).rem_euclid(h as i32) as usize;
                    texels[which][row * w + column]
                };
                ([read(0, 0), read(1, 0), read(0, 1), read(1, 1)], address.weight.map(Fx::raw))
            };
            let ((fine, fine_weight), (coarse, coarse_weight)) = (fetch(0), fetch(1));
            let got = trilinear([fine, coarse], [fine_weight, coarse_weight], level, 8);
            let real = uv.map(|u| u as f64 / 2_f64.powi(32));
            let [want] = reference_trilinear(&maps, real, f64::from(level) / 4096.0);
            worst = worst.max((f64::from(got) / 256.0 - want).abs());
        }
        // Weights are rounded to `weight_bits`: half a last place of 65 535 in both directions; and the sample itself.
        let bound = 65535.0 * (-f64::from(p.weight_bits)).exp2() + 1.0 / 256.0;
        println!("{name}: {worst:.2} of 65535, bound {bound:.2}");
        assert!(worst <= bound, "{name}: {worst} of 65535");
    }
}

#[test]
fn repeated_addresses_are_the_rounded_texel_coordinate_for_every_size() {
    let corners = |width: i64| {
        let texel = (1 << 32) / width;
        let near = (0..=width.min(9)).flat_map(move |i| [i * texel, i * texel + texel / 2]);
        let ends = [0, 1, (1 << 31) - 1, 1 << 31, (1 << 31) + 1, (1 << 32) - 2, (1 << 32) - 1];
        near.flat_map(|u| [u - 1, u, u + 1]).chain(ends).filter(|u| (0..1 << 32).contains(u))
    };
    for (name, p) in profiles() {
        for width in [1, 2, 3, 5, 1000, 16383, 16384] {
            let mut random = SplitMix64::for_element(name, width as u64);
            let drawn: Vec<i64> = (0..5000).map(|_| i64::from(random.next_u64() as u32)).collect();
            for u in corners(width).chain(drawn) {
                let size = [Fx::from_raw(width as i32), Fx::from_raw(1)];
                let address = repeat_address::<i32>(&TexturePosition { uv: [Fx::from_raw(u), Fx::zero()] }, size, &p);
                let (index, weight) = (address.index[0].raw(), address.weight[0].raw());
                // u·width − ½ in 2^−32, rounded at `weight_bits`.
                let drop = 32 - p.weight_bits;
                let coordinate = (u * width - (1 << 31) + (1 << (drop - 1))) >> drop;
                assert_eq!(i64::from(index), coordinate >> p.weight_bits, "{name} {width} {u}");
                let kept = coordinate & ((1 << p.weight_bits) - 1);
                assert_eq!(i64::from(weight), kept << (10 - p.weight_bits), "{name} {width} {u}");
                assert!((-1..width).contains(&i64::from(index)) && (0..1024).contains(&weight));
            }
        }
    }
}

#[test]
fn face_addresses_stay_within_one_texel_of_the_face() {
    let one = 1_i32 << 28;
    for (name, p) in profiles() {
        for edge in [1, 2, 3, 5, 1000, 16383, 16384_i64] {
            let mut random = SplitMix64::for_element(name, edge as u64);
            let drawn: Vec<i32> = (0..5000).map(|_| random.below(2 * one as u64 + 1) as i32 - one).collect();
            for s in [-one, 1 - one, -1, 0, 1, one - 1, one].into_iter().chain(drawn) {
                let address = face_address::<i32>(&[Fx::from_raw(s), Fx::from_raw(-s)], Fx::from_raw(edge as i32), &p);
                for (s, index, weight) in
                    [(s, address.index[0], address.weight[0]), (-s, address.index[1], address.weight[1])]
                {
                    let (index, weight) = (index.raw(), weight.raw());
                    assert!((-1..edge).contains(&i64::from(index)) && (0..1024).contains(&weight));
                    // ((s + 1)·edge − 1)/2, rounded at `weight_bits`.
                    let exact = (f64::from(s) / f64::from(one) + 1.0) / 2.0 * edge as f64 - 0.5;
                    let got = f64::from(index) + f64::from(weight) / 1024.0;
                    let half = 0.5 * (-f64::from(p.weight_bits)).exp2();
                    assert!((got - exact).abs() <= half, "{name} {edge} {s}: {got} for {exact}");
                }
            }
        }
    }
}

#[test]
fn levels_split_every_lod_of_every_profile() {
    for bits in 0..15 << 16 {
        let pair = levels::<i32>(Fx::from_raw(bits));
        assert_eq!(pair.level.raw(), bits >> 16);
        // A profile keeps at most 12 bits; lower bits do not exist.
        assert_eq!(pair.weight.raw(), (bits & 0xffff) >> 4);
    }
}

#[test]
fn corner_texel_is_the_nearest_to_the_mean_of_the_three() {
    // The mean depends only on the sum: all sums are tested.
    for sum in 0..=3 * 65535_i32 {
        let three = [sum / 3, (sum + 1) / 3, (sum + 2) / 3];
        let got = corner(&three.map(Fx::<i32, 32>::from_raw)).raw();
        assert_eq!(got, (sum + 1).div_euclid(3), "{three:?}: a third rounds down, two thirds up");
    }
    for value in 0..=65535 {
        assert_eq!(corner(&[Fx::<i32, 32>::from_raw(value); 3]).raw(), value);
    }
    assert_eq!(corner(&[0, 0, 65535].map(Fx::<i32, 32>::from_raw)).raw(), 21845);
}

#[test]
fn probe_sums_are_the_rounded_weighted_mean() {
    let mut random = SplitMix64::new(5);
    for _ in 0..2000 {
        let mut sum = ProbeSum::<i32>::zero();
        let (mut exact, mut left) = (0_i64, 1_i64 << 16);
        for probe in 0..16 {
            let weight = if probe == 15 { left } else { random.below(left as u64 / 4 + 1) as i64 };
            left -= weight;
            let sample = random.next_u64() as i32;
            sum = sum.add(Fx::from_raw(sample), Fx::from_raw(weight as i32));
            exact += weight * i64::from(sample);
        }
        assert_eq!(i64::from(sum.mean().raw()), (exact + (1 << 15)) >> 16);
    }
}

#[test]
fn equal_probes_give_their_value_for_every_count_and_both_weight_laws() {
    for probe_weights in [ProbeWeights::Box, ProbeWeights::Gaussian] {
        let p = Precision { probe_weights, ..Precision::STANDARD };
        for count in 1..=16 {
            let probes = Probes { count: Fx::from_raw(count), ..Probes::<i32>::limit::<i32>(End::Low) };
            let weights: Vec<_> = (0..count).map(|index| weight(&probes, Fx::from_raw(index), &p)).collect();
            for sample in [0, 1, i32::MAX, i32::MIN, -1, 0x1234_5678].map(Fx::from_raw) {
                let sum = weights.iter().fold(ProbeSum::<i32>::zero(), |sum, &weight| sum.add(sample, weight));
                assert_eq!(sum.mean(), sample, "{count} probes, {probe_weights:?}");
            }
        }
    }
}

#[test]
fn a_biased_level_stays_at_or_above_the_finest() {
    let exact = -0.5 * 3_f64.log2() * 65536.0;
    assert!((f64::from(filter::ROUGHNESS_LOD_BIAS) - exact).abs() <= 0.5);
    for (name, p) in profiles() {
        for lod in (0..15 << 16).step_by(1 << (16 - p.lod_bits)) {
            let biased = filter::biased::<i32>(Fx::from_raw(lod), &p).raw();
            assert!(biased >= 0 && biased <= lod && biased & ((1 << (16 - p.lod_bits)) - 1) == 0, "{name}");
            let want = (f64::from(lod) + exact).max(0.0);
            assert!((f64::from(biased) - want).abs() <= f64::from(1 << (15 - p.lod_bits)) + 0.5, "{name}");
        }
    }
}
