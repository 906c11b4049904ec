//! Addresses, interpolation, the cube's corner, blending and the moments of bumps against integers and the float64
//! reference.

use fixed::types::{I2F30, U0F32};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rayon::prelude::*;
use roughxel_core::bundle::{Bundle, End, Value};
use roughxel_core::datapath::texel::{self, Quad};
use roughxel_core::datapath::{TextureFootprint, probe_reach};
use roughxel_core::fx::Fx;
use roughxel_core::ports::{BlockPair, TextureIn};
use roughxel_core::precision::{Precision, ProbeRule, ProbeWeights};
use roughxel_core::signals::{Probes, TexturePosition};
use roughxel_core::soft_core::texture_scale;
use roughxel_core::stage::blend::{blend, bright};
use roughxel_core::stage::filter::{
    self, LEVEL_WEIGHT, Patch, ProbeSum, bright_corner, bright_texel, corner, face_address, levels, repeat_address,
};
use roughxel_core::stage::moments::{
    Moments, covariance, decompose, of_isotropic_texel, of_probe, of_texel, ramp, with_ramp,
};
use roughxel_core::stage::probes::weight;
use roughxel_core::width::on_words;
use roughxel_host_tests::reference;
use roughxel_host_tests::reference::filter::{Map, trilinear as reference_trilinear};
use roughxel_host_tests::reference::linear::normalise_exponent;
use roughxel_host_tests::reference::roughness::{self, compose, isotropic};
use roughxel_host_tests::space::{profiles, whole_or};
use roughxel_utilities::random::SplitMix64;

fn config() -> ProptestConfig {
    ProptestConfig { cases: 20_000, failure_persistence: None, rng_seed: RngSeed::Fixed(8), ..Default::default() }
}

/// A trilinear sample of scalar words: weights of the fine and the coarse level in 2^−10, of the level in 2^−12.
fn trilinear(texels: [[i32; 4]; 2], weights: [[i32; 2]; 2], level: i32, extra: u32) -> i32 {
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
            // So is the mean of one probe.
            prop_assert_eq!(ProbeSum::<i32>::zero().add(sample, Fx::int(1)).mean(), sample);
        }
    }

    /// The weights of a sample are worked out once for its channels: each channel has its own texels, each level its own weights.
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
        // Each level is rounded to a word, then their mean: half a last place and another half.
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
        // A profile keeps at most 12 bits; those beyond do not exist.
        assert_eq!(pair.weight.raw(), (bits & 0xffff) >> 4);
    }
}

#[test]
fn corner_texel_is_the_nearest_to_the_mean_of_the_three() {
    // The mean depends on the sum only: all of them.
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

/// A number in units of 2^−30.
fn unit(x: f64) -> Fx<i32, 2> {
    Fx::from_raw((x * f64::from(1 << 30)).round() as i32)
}

fn real(x: Fx<i32, 2>) -> f64 {
    f64::from(x.raw()) / f64::from(1 << 30)
}

fn real_offset(x: Fx<i32, 4>) -> f64 {
    f64::from(x.raw()) / f64::from(1 << 28)
}

/// A texel of the bump and roughness pyramids as it is interpolated: b₁, b₂ and K = D Dᵀ.
fn texel(b: [f64; 2], d: [f64; 3]) -> [i32; 5] {
    let [b1, b2] = b.map(unit);
    let [k11, k12, k22] = of_texel(&d.map(unit));
    [b1.raw(), b2.raw(), k11.raw(), k12.raw(), k22.raw()]
}

/// Every channel of a trilinear probe halfway between two texels.
fn halfway(a: [i32; 5], b: [i32; 5]) -> [i32; 5] {
    std::array::from_fn(|i| trilinear([[a[i], b[i], a[i], b[i]]; 2], [[512, 0]; 2], 0, 0))
}

/// Moments of one probe.
fn moments_of([b1, b2, k11, k12, k22]: [i32; 5]) -> Moments<i32> {
    let b = [b1, b2].map(Fx::from_raw);
    (b, of_probe(&b, &[k11, k12, k22].map(Fx::from_raw)))
}

/// Moments averaged over two probes of equal weight.
fn averaged(probes: [[i32; 5]; 2]) -> Moments<i32> {
    let channels = probes.map(|probe| {
        let ([b1, b2], [m11, m12, m22]) = moments_of(probe);
        [b1.raw(), b2.raw(), m11.raw(), m12.raw(), m22.raw()]
    });
    let [b1, b2, m11, m12, m22]: [i32; 5] = std::array::from_fn(|i| {
        let half = Fx::number(1, -1);
        let add = |sum: ProbeSum<i32>, probe: &[i32; 5]| sum.add(Fx::from_raw(probe[i]), half);
        channels.iter().fold(ProbeSum::<i32>::zero(), add).mean().raw()
    });
    ([b1, b2].map(Fx::from_raw), [m11, m12, m22].map(Fx::from_raw))
}

/// D of moments.
fn stored(moments: &Moments<i32>, p: &Precision) -> [f64; 3] {
    decompose(&covariance(moments, p), p).map(real_offset)
}

/// Largest difference of two covariances.
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.into_iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn equal_texels_give_back_their_own_covariance() {
    for (name, p) in profiles() {
        let worst = (0..100_000_u64)
            .into_par_iter()
            .map(|index| {
                let mut random = SplitMix64::for_element(name, index);
                let size = random.uniform(-10.0, 0.0).exp2();
                let mut within = |size: f64| random.uniform(-size, size);
                let (b, d) = ([within(1.0), within(1.0)], [within(size).abs(), within(size), within(size).abs()]);
                let texel = texel(b, d);
                assert_eq!(halfway(texel, texel), texel, "filtering equal texels changes nothing");
                let same = averaged([texel; 2]);
                let [a, b, c] = covariance(&same, &p).m.map(|m| f64::from(m.raw()) / f64::from(1 << 30));
                let scale = f64::from(covariance(&same, &p).e.raw()).exp2();
                let want = compose(d);
                let error = distance([a * scale, b * scale, c * scale], want);
                // What is stated: 2^−28 absolute, and the rounding of K to p bits.
                error / ((-28_f64).exp2() + (-f64::from(p.fraction_bits)).exp2() * want[0].max(want[2]))
            })
            .reduce(|| 0.0, f64::max);
        println!("{name}: {worst:.3} of the stated error");
        assert!(worst <= 1.0, "{name}: {worst} times the stated error");
    }
}

#[test]
fn a_probe_gives_back_its_covariance_to_the_bit_whatever_its_offset() {
    for (name, p) in profiles() {
        (0..100_000_u64).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(name, index);
            let mut word = || random.next_u64() as i64 % ((1 << 30) + 1);
            let [b1, b2, k11, k12, k22] = [0; 5].map(|_| word() as i32);
            // K of bumps that are not lost is 0.
            for [k11, k12, k22] in [[k11.abs(), k12, k22.abs()], [0; 3]] {
                let probe = [b1, b2, k11, k12, k22];
                let alone = covariance(&moments_of([0, 0, k11, k12, k22]), &p);
                for moments in [moments_of(probe), averaged([probe; 2])] {
                    assert_eq!(covariance(&moments, &p), alone, "{name}: {probe:?}");
                }
            }
        });
    }
}

#[test]
fn decomposition_follows_the_reference() {
    for (name, p) in profiles() {
        let worst = (0..100_000_u64)
            .into_par_iter()
            .map(|index| {
                let mut random = SplitMix64::for_element(name, index);
                let mut within = |low: f64, high: f64| random.uniform(low, high);
                // c from a thousandth to a thousand times a: the rounding of K to p bits grows with their ratio.
                let spread = within(-5.0, 5.0).exp2();
                let size = within(-8.0, -5.0).exp2();
                let d = [within(0.0, size), within(-size, size), within(0.1, 1.0) * size * spread];
                let k = covariance(&moments_of(texel([0.0; 2], d)), &p);
                let scale = f64::from(k.e.raw()).exp2();
                let exact = k.m.map(|m| f64::from(m.raw()) / f64::from(1 << 30) * scale);
                let want = roughness::decompose(exact);
                let got = decompose(&k, &p).map(real_offset);
                // Against K as the stage sees it, so that only its own arithmetic is judged: a root, an inverse
                // root and their product, relative, and the last place of D.
                let longest = exact[0].max(exact[2]).sqrt();
                let bound = (3.0 - f64::from(p.fraction_bits)).exp2() * longest + (-27_f64).exp2();
                distance(got, want) / bound
            })
            .reduce(|| 0.0, f64::max);
        println!("{name}: {worst:.3} of the bound");
        assert!(worst <= 1.0, "{name}: {worst} times the bound");
    }
}

#[test]
fn roughness_of_rank_one_keeps_its_variance_in_every_direction() {
    for (name, p) in profiles() {
        for step in 0..=256 {
            let (sin, cos) = (f64::from(step) * std::f64::consts::PI / 256.0).sin_cos();
            for size in [1.0, 0.1, 0.004] {
                // Two slopes along one line: K = size²·(cos, sin)(cos, sin)ᵀ, no D at all in the probes.
                let slopes = [size, -size].map(|b| texel([b * cos, b * sin], [0.0; 3]));
                let want = [cos * cos, cos * sin, sin * sin].map(|k| k * size * size);
                let [d1, d2, d3] = stored(&averaged(slopes), &p);
                let got = compose([d1, d2, d3]);
                // c keeps p bits beside a: below 2^−p·a it is lost (d₂ with it), just above it b²/c is noise.
                let last = (-f64::from(p.fraction_bits)).exp2() * want[0].max(want[2]) + (-28_f64).exp2();
                let noise = 8.0 * last * (1.0 + want[0] / want[2].max(last));
                assert!(distance(got, want) <= noise, "{name} {step} {size}: {got:?} for {want:?}");
                assert!(d1 >= 0.0 && d3 >= 0.0 && [d1, d2, d3].iter().all(|d| d.abs() <= 4.0));
            }
        }
    }
}

#[test]
fn degenerate_covariances_decompose_as_documented() {
    for (_, p) in profiles() {
        let of = |b: [f64; 2], d: [f64; 3]| stored(&moments_of(texel(b, d)), &p);
        assert_eq!(of([0.0; 2], [0.0; 3]), [0.0; 3]);
        // c = 0: d₂ = 0, d₁ = √a (erratum 13).
        let [d1, d2, d3] = of([0.0; 2], [0.5, 0.0, 0.0]);
        assert!((d1 - 0.5).abs() < 0.001 && (d2, d3) == (0.0, 0.0));
        // a = 0.
        let [d1, d2, d3] = of([0.0; 2], [0.0, 0.0, 0.5]);
        assert!((d1, d2) == (0.0, 0.0) && (d3 - 0.5).abs() < 0.001);
        // Offsets alone, at the ends of their range, leave no roughness.
        for b in [[1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [0.3, -0.7]] {
            assert_eq!(of(b, [0.0; 3]), [0.0; 3], "{b:?}");
        }
        assert_eq!(of_isotropic_texel::<i32>(unit(0.25)), of_texel(&[0.25, 0.0, 0.25].map(unit)));
    }
}

#[test]
fn variance_of_the_means_is_kept_between_probes_and_not_invented_within_one() {
    for (name, p) in profiles() {
        let slopes = [0.5, -0.5].map(|b| texel([b, 0.0], [0.0; 3]));
        let k = compose(stored(&averaged(slopes), &p));
        assert!((k[0] - 0.25).abs() < 0.001 && k[2] == 0.0, "{name}: {k:?}");
        // Halfway between the two the surface is a ramp, not a distribution.
        assert_eq!(stored(&moments_of(halfway(slopes[0], slopes[1])), &p), [0.0; 3], "{name}");
    }
}

/// b of four texels on two levels.
type Offsets = [[[Fx<i32, 2>; 2]; 4]; 2];

/// The ramp of a probe with this weight between levels and this reach, both in last places.
fn ramp_of(offsets: &Offsets, level_weight: i32, reach: i32) -> [Fx<i32, 3>; 3] {
    ramp(offsets, &filter::ramp_weights(Fx::<i32, LEVEL_WEIGHT>::from_raw(level_weight), Fx::from_raw(reach)))
}

#[test]
fn a_ramp_between_texels_is_half_its_variance_within_the_probe() {
    let mut random = SplitMix64::new(9);
    let mut worst: f64 = 0.0;
    for _ in 0..200_000 {
        let ends = random.below(8) == 0;
        let mut word = || if ends { [-1, 1][random.below(2) as usize] << 30 } else { random.next_u64() as i32 >> 1 };
        let offsets: Offsets = [[(); 4]; 2].map(|level| level.map(|()| [word(), word()].map(Fx::from_raw)));
        let (level_weight, reach) = (random.below(4096) as i32, random.below((1 << 16) + 1) as i32);
        let b = |level: usize, texel: usize, channel: usize| real(offsets[level][texel][channel]);
        // Mean differences along u and v, then their blend.
        let [du, dv] = [[(0, 1), (2, 3)], [(0, 2), (1, 3)]].map(|pairs| {
            [0, 1].map(|channel| {
                let [fine, coarse] = [0, 1].map(|level| {
                    pairs.map(|(from, to)| b(level, to, channel) - b(level, from, channel)).iter().sum::<f64>() / 2.0
                });
                let coarser = f64::from(level_weight) / 4096.0;
                (fine + (coarse - fine) * coarser) * f64::from(reach) / 65536.0
            })
        });
        let want = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| (du[i] * du[j] + dv[i] * dv[j]) / 8.0);
        let got = ramp_of(&offsets, level_weight, reach).map(|k| f64::from(k.raw()) * (-29_f64).exp2());
        assert!(got[0] >= 0.0 && got[2] >= 0.0 && got.iter().all(|k| k.abs() <= 1.0));
        // The coarser weight has 16 bits: its half place moves a difference of at most 4 between levels by 2^−15.
        worst = worst.max(distance(got, want) / ((-15_f64).exp2() * (want[0] + want[2]).sqrt() + (-28_f64).exp2()));
    }
    println!("{worst:.3} of the stated error");
    assert!(worst <= 1.0, "{worst} times the stated error");
}

#[test]
fn a_ramp_of_equal_texels_or_without_reach_is_none_to_the_bit() {
    let mut random = SplitMix64::new(10);
    for _ in 0..20_000 {
        let mut word = || (random.next_u64() as i32 >> 1) + 1;
        let (even, any) = ([word(), word()], [[(); 4]; 2].map(|level| level.map(|()| [word(), word()])));
        let [even, any] = [[[even; 4]; 2], any].map(|levels| levels.map(|texels| texels.map(|b| b.map(Fx::from_raw))));
        let (level_weight, reach) = (random.below(4096) as i32, random.below((1 << 16) + 1) as i32);
        assert_eq!(ramp_of(&even, level_weight, reach), [Fx::zero(); 3]);
        assert_eq!(ramp_of(&any, level_weight, 0), [Fx::zero(); 3]);
    }
    let whole = [Fx::int(1), Fx::int(-1), Fx::int(1)];
    let k = [Fx::int(2), Fx::int(-2), Fx::number(3, -2)];
    assert_eq!(
        with_ramp::<i32>(&k, &whole),
        [Fx::int(2), Fx::int(-2), Fx::number(7, -2)],
        "within the range of a texel"
    );
}

#[test]
fn a_probe_spans_what_the_reference_says_of_a_texel() {
    for (name, p) in profiles() {
        let rule = match p.probe_rule {
            ProbeRule::Ceiling => reference::probes::ProbeRule::Ceiling,
            ProbeRule::PowerOfTwo => reference::probes::ProbeRule::PowerOfTwo,
        };
        let worst = (0..whole_or(100_000_u64, 20_000))
            .into_par_iter()
            .map(|index| {
                let mut random = SplitMix64::for_element(name, index);
                let size = [(); 2].map(|()| {
                    let log2 = random.below(15);
                    1 + random.below(1 << log2) as u16
                });
                // From a thousandth of a texel to a few of them, round or long.
                let scale = random.uniform(-10.0, 3.0).exp2() / f64::from(size[0].max(size[1]));
                let long = random.uniform(-8.0, 0.0).exp2();
                let mut column = |scale: f64| [(); 2].map(|()| random.uniform(-scale, scale));
                let exact = [column(scale), column(scale * long)];
                let duv = exact.map(|column| {
                    let (mantissa, exponent) = normalise_exponent(column);
                    BlockPair { mantissa: mantissa.map(I2F30::from_num), exponent: exponent as i16 }
                });
                let scale = texture_scale(size);
                let TextureFootprint { axes, probes, .. } =
                    TextureIn { uv: [U0F32::ZERO; 2], duv }.footprint(&scale, &p);
                let (axes, probes, texture) = (&axes, &probes, &scale.0);
                let got = on_words!(&p, |axes, probes, texture| Value(probe_reach(
                    [&axes.major, &axes.minor],
                    probes,
                    texture,
                    &p
                )))
                .0;
                let size = size.map(u32::from);
                let columns = reference::columns_in_texels(exact, size);
                let want = reference::texture(columns, 1.0, size, rule, p.max_probes);
                let reach = (2.0 * want.probes.minor).min(1.0);
                let error = (f64::from(got.raw()) / 65536.0 - reach).abs();
                let square = [size[0].max(size[1]); 2];
                let on_square = reference::columns_in_texels(exact, square);
                let major = reference::texture(on_square, 1.0, square, rule, p.max_probes).axes.major;
                error / ((-17_f64).exp2() + (4.0 - f64::from(p.fraction_bits)).exp2() * major)
            })
            .reduce(|| 0.0, f64::max);
        println!("{name}: {worst:.3} of the stated error");
        assert!(worst <= 1.0, "{name}: {worst} times the stated error");
    }
}

#[test]
fn interpolated_covariance_keeps_the_variance_that_interpolated_d_loses() {
    // Erratum 15: K = [[1, ±.9], [±.9, 1]] on two neighbouring texels.
    let d = [0.9, -0.9].map(|b| roughness::decompose([1.0, b, 1.0]));
    let mean_d = compose(std::array::from_fn(|i| (d[0][i] + d[1][i]) / 2.0));
    assert!((mean_d[0] - 0.19).abs() < 1e-12, "the mean D has lost the variance");
    for (name, p) in profiles() {
        let [plus, minus] = d.map(|d| texel([0.0; 2], d));
        for moments in [moments_of(halfway(plus, minus)), averaged([plus, minus])] {
            let k = compose(stored(&moments, &p));
            let error = (5.0 - f64::from(p.fraction_bits)).exp2();
            assert!(distance(k, [1.0, 0.0, 1.0]) <= error, "{name}: {k:?}");
            assert!((isotropic(k) - 1.0).abs() <= error);
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
