//! One source, several readings: a checked, counting reading of the datapath gives the bits of the scalar one, and
//! no operation leaves its wire, for any bit pattern at any port.
//!
//! This is the throw-away second reading that proves `Word` fit for lanes and for a recorded graph: nothing in a
//! stage knows what a word is. What it checks is in [`roughxel_host_tests::checked`].

use fixed::types::{I2F30, I4F28, U0F32};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use rayon::prelude::*;
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::block::Block;
use roughxel_core::bundle::Value;
use roughxel_core::datapath;
use roughxel_core::elementary;
use roughxel_core::fx::{Fx, Int};
use roughxel_core::plan::{FootprintKind, ReflectionPlan};
use roughxel_core::ports::{
    BlockPair, BlockVector, Port, PortBlock, ReflectionIn, ReflectionInput, SurfaceIn, TextureIn,
};
use roughxel_core::precision::{AxisDirection, Newton, Precision, ProbeRule, ProbeWeights, RoughnessKind};
use roughxel_core::signals::{MapScale, Probes, TexturePosition};
use roughxel_core::soft_core::{self, environment_scale, texture_scale};
use roughxel_core::stage::filter::{LEVEL_WEIGHT, Patch};
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::stage::{blend, filter, moments, probes};
use roughxel_core::width::{IntegerWord, narrowed, of_ports};
use roughxel_host_tests::checked::{Checked, Integers, OperationCounts, Scalar, counted, first_difference, reread};
use roughxel_host_tests::space::{plans, profiles, whole_or};
use roughxel_utilities::random::SplitMix64;

/// Runs both readings on words of the profile's width, probes included, and compares every integer of every stage.
fn compare(fragment: &ReflectionIn, plan: &ReflectionPlan, p: &Precision) -> OperationCounts {
    let wires = fragment.wires();
    match p.word_bits() {
        16 => compare_on::<i16>(&wires, fragment, plan, p),
        _ => compare_on::<i32>(&wires, fragment, plan, p),
    }
}

fn compare_on<T: Scalar + IntegerWord>(
    input: &ReflectionInput<i32>,
    fragment: &ReflectionIn,
    plan: &ReflectionPlan,
    p: &Precision,
) -> OperationCounts {
    let edge = fragment.edge_texels.clamp(1, 16384);
    let map = probes::face_scale::<T>(Fx::lit(edge.into()), p);
    let checked_map = probes::face_scale::<T::Checked>(Fx::lit(edge.into()), p);
    assert_eq!(Integers::of::<T, _>(&map), Integers::of::<T::Checked, _>(&checked_map));
    let whole_map = environment_scale(edge, p);
    assert_eq!((map.log2_texels, map.last_level), (whole_map.log2_texels, whole_map.last_level));

    let scalar: datapath::Reflection<T> = of_ports(&soft_core::reflection(input, &whole_map, plan, p));
    let input = reread(&of_ports::<T, _>(input));
    let (checked, counts) = counted(|| datapath::reflection(&input, &checked_map, plan, p));
    let (expected, got) = (Integers::of::<T, _>(&scalar), Integers::of::<T::Checked, _>(&checked));
    assert_eq!(expected, got, "{:?} in {fragment:?}", first_difference(&expected, &got));
    for index in 0..i64::from(scalar.probes.count.raw()) {
        let expected = datapath::environment_probe(&scalar.point, &scalar.probes, Fx::lit(index), p);
        let got = datapath::environment_probe(&checked.point, &checked.probes, Fx::lit(index), p);
        assert_eq!(
            Integers::of::<T, _>(&expected),
            Integers::of::<T::Checked, _>(&got),
            "probe {index} of {fragment:?}"
        );
    }
    for index in 0..i64::from(scalar.sweep.count.raw()) {
        let last = map.last_level.raw();
        let expected = datapath::sphere_probe(&scalar.sweep, Fx::lit(index), Fx::from_raw(last), p);
        let got = datapath::sphere_probe(&checked.sweep, Fx::lit(index), Fx::lit(last.into()), p);
        assert_eq!(
            Integers::of::<T, _>(&expected),
            Integers::of::<T::Checked, _>(&got),
            "probe {index} on the sphere of {fragment:?}"
        );
    }
    counts
}

/// Runs the texture footprint and the places of its probes in both readings.
fn compare_texture(fragment: &TextureIn, size: [u16; 2], p: &Precision) {
    let (texture, map) = texture_scale(size);
    let ports = fragment.duv.wires();
    match p.word_bits() {
        16 => compare_texture_on::<i16>(&narrowed(&ports), (&narrowed(&texture), &narrowed(&map)), fragment, p),
        _ => compare_texture_on::<i32>(&ports, (&texture, &map), fragment, p),
    }
}

fn compare_texture_on<T: Scalar>(
    ports: &[PortBlock<T, 2>; 2],
    (texture, map): (&TextureScale<T>, &MapScale<T>),
    fragment: &TextureIn,
    p: &Precision,
) {
    let (checked_texture, checked_map) = (reread(texture), reread(map));
    let scalar = datapath::texture_footprint(ports, texture, map, p);
    let checked = datapath::texture_footprint(&reread(ports), &checked_texture, &checked_map, p);
    let (expected, got) = (Integers::of::<T, _>(&scalar), Integers::of::<T::Checked, _>(&checked));
    assert_eq!(expected, got, "{:?} in {fragment:?}", first_difference(&expected, &got));

    let expected = datapath::probe_reach([&scalar.axes.major, &scalar.axes.minor], &scalar.probes, texture, p);
    let got = datapath::probe_reach([&checked.axes.major, &checked.axes.minor], &checked.probes, &checked_texture, p);
    assert_eq!(Integers::of::<T, _>(&Value(expected)), Integers::of::<T::Checked, _>(&Value(got)), "{fragment:?}");

    let centre = TexturePosition::<T> { uv: fragment.uv.map(|u| Fx::from_raw(i64::from(u.to_bits()))) };
    for index in 0..i64::from(scalar.probes.count.raw()) {
        let expected = datapath::texture_probe(&centre, &scalar.probes, Fx::lit(index), texture, p);
        let got = datapath::texture_probe(&reread(&centre), &checked.probes, Fx::lit(index), &checked_texture, p);
        assert_eq!(
            Integers::of::<T, _>(&expected),
            Integers::of::<T::Checked, _>(&got),
            "probe {index} of {fragment:?}"
        );
        let inside = expected.place.uv.iter().all(|u| (0..1 << 32).contains(&u.raw()));
        assert!(inside, "a position is a fraction: {expected:?}");

        // Levels of that shape, and the addresses of the probe on each.
        for level in 0..=map.last_level.raw() as u32 {
            let extent = texture.size.map(|edge| (edge.raw() >> level).max(1));
            let scalar = filter::repeat_address::<T>(&expected.place, extent.map(Fx::from_raw), p);
            let checked =
                filter::repeat_address::<T::Checked>(&got.place, extent.map(|e| Fx::from_raw(Checked::new(e))), p);
            assert_eq!(Integers::of::<T, _>(&scalar), Integers::of::<T::Checked, _>(&checked));
        }
    }
}

/// A word with weight on the corners: the ends of its range, single bits, runs of ones, values at binary edges.
fn corner_word(random: &mut SplitMix64) -> i32 {
    let power = 1_i64 << random.below(32);
    let word = match random.below(12) {
        0 => 0,
        1 => i64::from(i32::MIN) + random.below(3) as i64,
        2 => i64::from(i32::MAX) - random.below(3) as i64,
        3 => power,
        4 => -power,
        5 => power - 1,
        6 => 1 - power,
        7 => (1 << 30) - power,
        8 => power - (1 << 30),
        _ => i64::from(random.next_u64() as i32) >> random.below(31),
    };
    word.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}

/// An exponent: mostly near zero, often at the ends of the port.
fn corner_exponent(random: &mut SplitMix64) -> i16 {
    match random.below(8) {
        0 => i16::MIN,
        1 => i16::MAX,
        2 => random.next_u64() as i16,
        3 => random.below(130) as i16 - 65,
        _ => random.below(9) as i16 - 4,
    }
}

fn corner_vector(random: &mut SplitMix64) -> BlockVector {
    // Some vectors repeat a component, so that ties, parallels and equal sums occur.
    let mut mantissa = [0; 3].map(|_| corner_word(random));
    if random.below(3) == 0 {
        mantissa[1] = mantissa[0];
    }
    if random.below(4) == 0 {
        mantissa[2] = mantissa[0].wrapping_neg();
    }
    BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent: corner_exponent(random) }
}

fn corner_fragment(random: &mut SplitMix64) -> ReflectionIn {
    let mut vectors = [(); 8].map(|()| corner_vector(random));
    // Every other fragment has parallel or equal vectors somewhere.
    if random.below(2) == 0 {
        let [from, to] = [0; 2].map(|_| random.below(8) as usize);
        let exponent = vectors[to].exponent;
        vectors[to] = vectors[from];
        if random.below(2) == 0 {
            vectors[to].exponent = exponent;
        }
    }
    let [normal, view, t0, t1, vx, vy, nx, ny] = vectors;
    let mut offset = || I4F28::from_bits(corner_word(random));
    ReflectionIn {
        surface: SurfaceIn {
            normal,
            view,
            frame_vectors: [t0, t1],
            offset: [offset(), offset()],
            roughness: [offset(), offset(), offset()],
        },
        dview: [vx, vy],
        dnormal: [nx, ny],
        edge_texels: random.next_u64() as u16 >> random.below(16),
    }
}

/// A precision anywhere within the limits of [`Precision::checked`], with weight on their ends.
fn corner_precision(random: &mut SplitMix64) -> Precision {
    let mut within = |low: u64, high: u64| -> u32 {
        let value = match random.below(4) {
            0 => low,
            1 => high,
            _ => low + random.below(high - low + 1),
        };
        value as u32
    };
    let mut newton = || Newton { seed_bits: within(6, 10), steps: within(0, 2) };
    let (reciprocal, inverse_root) = (newton(), newton());
    let precision = Precision {
        fraction_bits: within(12, 28),
        reciprocal,
        inverse_root,
        direction: match within(0, 1) {
            0 => AxisDirection::Exact,
            _ => AxisDirection::Table { steps: 2 * within(1, 32) },
        },
        max_probes: within(1, 16),
        probe_rule: if within(0, 1) == 0 { ProbeRule::PowerOfTwo } else { ProbeRule::Ceiling },
        probe_weights: if within(0, 1) == 0 { ProbeWeights::Box } else { ProbeWeights::Gaussian },
        lod_bits: within(2, 12),
        weight_bits: within(2, 10),
        roughness: RoughnessKind::Anisotropic,
        roughness_bits: within(4, 16),
    };
    precision.checked().expect("the generator stays inside the limits")
}

#[test]
fn readings_agree_on_every_hard_case_under_every_plan() {
    let plans = plans();
    // A dozen plans each, three without a sweep; the sets hold enough fragments for every plan to meet every kind of case.
    let each = whole_or(12, 3);
    for (_, p) in profiles() {
        for set in hard_case_sets(&p) {
            set.cases.par_iter().enumerate().for_each(|(index, fragment)| {
                compare(fragment, &set.plan, &p);
                for plan in plans.iter().cycle().skip(index).step_by(6).take(each) {
                    compare(fragment, plan, &p);
                }
            });
        }
    }
}

#[test]
fn readings_agree_on_random_fragments() {
    for (_, p) in profiles() {
        (0..whole_or(20_000_u64, 4000)).into_par_iter().for_each(|index| {
            compare(&random_fragment("readings", index, &p), &ReflectionPlan::FULL, &p);
        });
        let plans = plans();
        (0..50 * plans.len() as u64).into_par_iter().for_each(|index| {
            let plan = &plans[index as usize % plans.len()];
            compare(&random_fragment("readings under every plan", index, &p), plan, &p);
        });
    }
}

#[test]
fn no_wire_overflows_at_the_corners_of_the_ports() {
    let plans = plans();
    for (name, p) in profiles() {
        (0..whole_or(60_000_u64, 10_000)).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(name, index);
            let plan = plans[random.below(plans.len() as u64) as usize];
            compare(&corner_fragment(&mut random), &plan, &p);
        });
    }
}

#[test]
fn no_wire_overflows_at_any_precision_that_can_be_built() {
    let plans = plans();
    (0..whole_or(60_000_u64, 20_000)).into_par_iter().for_each(|index| {
        let mut random = SplitMix64::for_element("any precision", index);
        let p = corner_precision(&mut random);
        let plan = plans[random.below(plans.len() as u64) as usize];
        compare(&corner_fragment(&mut random), &plan, &p);
        compare(&random_fragment("any precision", index, &p), &plan, &p);
    });
}

#[test]
fn texture_footprints_agree_for_every_map_size_and_port() {
    let sizes = [1, 2, 3, 5, 64, 1000, 1023, 4096, 16383, 16384, 0, u16::MAX];
    for (name, p) in profiles() {
        (0..whole_or(12_000_u64, 2000)).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(name, index);
            let mut pair = || BlockPair {
                mantissa: [0; 2].map(|_| I2F30::from_bits(corner_word(&mut random))),
                exponent: corner_exponent(&mut random),
            };
            let duv = [pair(), pair()];
            let uv = [0; 2].map(|_| U0F32::from_bits(corner_word(&mut random) as u32));
            let size = [0; 2].map(|_| sizes[random.below(sizes.len() as u64) as usize]);
            compare_texture(&TextureIn { uv, duv }, size, &p);
        });
    }
}

#[test]
fn elementary_functions_stay_on_their_wires_at_and_beyond_the_ends_of_their_domains() {
    (0..400_u64).into_par_iter().for_each(|index| {
        let mut random = SplitMix64::for_element("elementary", index);
        let p = corner_precision(&mut random);
        let one = 1 << 30;
        let near = [0, one >> 2, one >> 1, one].into_iter().flat_map(|end| [-16, -1, 0, 1, 16].map(|step| end + step));
        let inside = (0..400).map(|_| random.below(1 << 30) as i32);
        for x in near.chain(inside.collect::<Vec<_>>()) {
            let (scalar, checked) = (Fx::<i32, 2>::from_raw(x), Fx::from_raw(Checked::new(x)));
            let pairs = [
                (elementary::half_reciprocal(scalar, &p).raw(), elementary::half_reciprocal(checked, &p).raw()),
                (elementary::half_inverse_root(scalar, &p).raw(), elementary::half_inverse_root(checked, &p).raw()),
                (elementary::log2(scalar, &p).raw(), elementary::log2(checked, &p).raw()),
            ];
            for (expected, got) in pairs {
                assert_eq!(expected, got.value(), "at {x} with {p:?}");
            }
            // ±64 with 24 fraction bits.
            let exponent = x.clamp(-one, one);
            let expected = elementary::exp2::<i32>(Fx::from_raw(exponent), &p);
            let got = elementary::exp2::<Checked>(Fx::from_raw(Checked::new(exponent)), &p);
            assert_eq!(Integers::of(&expected), Integers::of(&got));
        }
    });
}

/// Texels of a channel in both readings.
fn both<const N: usize>(texels: [i32; N]) -> ([Int<i32>; N], [Int<Checked>; N]) {
    (texels.map(Fx::from_raw), texels.map(|texel| Fx::from_raw(Checked::new(texel))))
}

/// One trilinear sample in both readings.
fn trilinear(fine: [i32; 4], coarse: [i32; 4], weights: [i32; 5], extra: u32) -> i32 {
    let [x0, y0, x1, y1, level] = weights;
    let patch = |texels: [i32; 4], weight: [i32; 2]| Patch::<i32> {
        texels: texels.map(Fx::from_raw),
        weight: weight.map(Fx::from_raw),
    };
    let (a, b) = (patch(fine, [x0, y0]), patch(coarse, [x1, y1]));
    let expected = filter::trilinear(&a, &b, Fx::from_raw(level), extra).raw();
    let (a, b) = (reread(&a), reread(&b));
    let got = filter::trilinear(&a, &b, Fx::from_raw(Checked::new(level)), extra).raw();
    assert_eq!(expected, got.value(), "{fine:?} {coarse:?} {weights:?}");
    expected
}

#[test]
fn filter_and_blend_agree_over_their_whole_ranges() {
    (0..60_000_u64).into_par_iter().for_each(|index| {
        let mut random = SplitMix64::for_element("filter", index);
        let mut weights = [1024, 1024, 1024, 1024, 4096].map(|end| match random.below(4) {
            0 => 0,
            1 => end - 1,
            _ => random.below(end as u64) as i32,
        });
        let mut texel = |low: i64, high: i64| match random.below(4) {
            0 => low as i32,
            1 => high as i32,
            _ => (low + random.below((high - low + 1) as u64) as i64) as i32,
        };
        let mut texels = |low, high| [[0; 4]; 2].map(|level| level.map(|_| texel(low, high)));
        let colours = texels(0, 65535);
        let sample = trilinear(colours[0], colours[1], weights, 8);
        assert!((0..=65535 << 8).contains(&sample));
        // Offsets: I2F30 in [−1, 1]. K and second moments, 29 fraction bits: [−2, 2] beside and [0, 3] on the diagonal.
        for (low, high) in [(-1 << 30, 1 << 30), (0, 3 << 29)] {
            let moments = texels(low, high);
            let sample = trilinear(moments[0], moments[1], weights, 0);
            assert!((low..=high).contains(&i64::from(sample)));
        }
        weights[4] = 0;
        let moments = texels(-1 << 30, 1 << 30);
        assert_eq!(trilinear(moments[0], moments[1], weights, 0), trilinear(moments[0], moments[0], weights, 0));

        let three: [i32; 3] = core::array::from_fn(|_| texel(0, 65535));
        let (three, checked) = both(three);
        assert_eq!(filter::corner(&three).raw(), filter::corner(&checked).raw().value());

        let colour = [0; 2].map(|_| texel(0, (1 << 30) - 1));
        let reflectance = texel(0, 1 << 16);
        let expected = blend::blend::<i32>(Fx::from_raw(colour[0]), Fx::from_raw(colour[1]), Fx::from_raw(reflectance));
        let [surface, reflection, share] = [colour[0], colour[1], reflectance].map(Checked::new);
        let got = blend::blend::<Checked>(Fx::from_raw(surface), Fx::from_raw(reflection), Fx::from_raw(share));
        assert_eq!(expected.raw(), got.raw().value());
    });
}

#[test]
fn probe_sums_agree_for_every_count_and_both_weight_laws() {
    let mut random = SplitMix64::new(3);
    for weights in [ProbeWeights::Box, ProbeWeights::Gaussian] {
        let p = Precision { probe_weights: weights, ..Precision::STANDARD };
        for count in 1..=16 {
            for sample in [0, 1, i32::MAX, i32::MIN, -1, random.next_u64() as i32] {
                let (mut scalar, mut checked) = (filter::ProbeSum::<i32>::zero(), filter::ProbeSum::<Checked>::zero());
                for index in 0..count {
                    let probes = probes_of(count);
                    let weight = probes::weight(&probes, Fx::lit(i64::from(index)), &p);
                    scalar = scalar.add(Fx::from_raw(sample), weight);
                    let weight = Fx::from_raw(Checked::new(weight.raw()));
                    checked = checked.add(Fx::from_raw(Checked::new(sample)), weight);
                }
                assert_eq!(scalar.mean().raw(), sample, "equal probes give that value");
                assert_eq!(checked.mean().raw().value(), sample);
            }
        }
    }
}

fn probes_of(count: i32) -> Probes<i32> {
    Probes {
        count: Fx::from_raw(count),
        step: [Fx::zero(); 2],
        lod: Fx::zero(),
        empty: false,
        saturated: false,
        capped: false,
    }
}

#[test]
fn moments_agree_over_their_whole_ranges() {
    let end = 1 << 30;
    (0..60_000_u64).into_par_iter().for_each(|index| {
        let mut random = SplitMix64::for_element("moments", index);
        let p = corner_precision(&mut random);
        let mut unit = || corner_word(&mut random).clamp(-end, end);
        let (offset, d) = ([unit(), unit()], [unit().abs(), unit(), unit().abs()]);
        let k = moments::of_texel::<i32>(&d.map(Fx::from_raw));
        let checked_k = moments::of_texel(&d.map(|d| Fx::from_raw(Checked::new(d))));
        assert_eq!(Integers::of(&k), Integers::of(&checked_k));
        let b = offset.map(Fx::<i32, 2>::from_raw);
        let texels = [(); 2].map(|()| [(); 4].map(|()| [unit(), unit()].map(Fx::<i32, 2>::from_raw)));
        let (level_weight, reach) = (unit() & 0xfff, unit() & 0xffff);
        let weights = filter::ramp_weights(Fx::<i32, LEVEL_WEIGHT>::from_raw(level_weight), Fx::from_raw(reach));
        let ramp = moments::with_ramp(&k, &moments::ramp(&texels, &weights));
        let checked_ramp = moments::with_ramp(
            &checked_k,
            &moments::ramp(
                &texels.map(|level| level.map(|texel| reread(&texel))),
                &filter::ramp_weights(
                    reread(&Fx::<i32, LEVEL_WEIGHT>::from_raw(level_weight)),
                    reread(&Fx::from_raw(reach)),
                ),
            ),
        );
        assert_eq!(Integers::of(&ramp), Integers::of(&checked_ramp));
        let second = moments::of_probe(&b, &k);
        let checked = moments::of_probe(&reread(&b), &checked_k);
        assert_eq!(Integers::of(&second), Integers::of(&checked));
        let decomposed = |moments: moments::Moments<i32>| {
            let checked = (reread(&moments.0), reread(&moments.1));
            let (k, checked_k) = (moments::covariance(&moments, &p), moments::covariance(&checked, &p));
            assert_eq!(Integers::of(&k), Integers::of(&checked_k));
            let (d, checked_d) = (moments::decompose(&k, &p), moments::decompose(&checked_k, &p));
            assert_eq!(Integers::of(&d), Integers::of(&checked_d), "of {k:?}");
        };
        decomposed((b, second));
        // Moments that belong to no set of offsets: what filtering noise can make of them, and worse.
        decomposed((b, [unit().abs(), unit(), unit().abs()].map(Fx::from_raw)));

        let lod = random.below(15 << 16) as i64;
        let level = filter::biased::<i32>(Fx::lit(lod), &p);
        assert_eq!(level.raw(), filter::biased::<Checked>(Fx::lit(lod), &p).raw().value());

        // Blocks of any exponent into I4F28.
        let exponent = i64::from(corner_exponent(&mut random));
        let mantissa = corner_word(&mut random).clamp(-end, end);
        let block = Block::<i32, 1> { m: [Fx::from_raw(mantissa)], e: Fx::lit(exponent) };
        let checked = reread(&block);
        let (expected, got) = (moments::to_roughness(block), moments::to_roughness(checked));
        assert_eq!(expected.raw(), got.raw().value());
    });
}

prop_compose! {
    fn any_vector()(mantissa: [i32; 3], exponent: i16) -> BlockVector {
        BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent }
    }
}

prop_compose! {
    fn any_fragment()(
        [normal, view, t0, t1, vx, vy, nx, ny] in prop::array::uniform8(any_vector()),
        offset: [i32; 2],
        roughness: [i32; 3],
        edge_texels: u16,
    ) -> ReflectionIn {
        ReflectionIn { surface: SurfaceIn { normal, view, frame_vectors: [t0, t1], offset: offset.map(I4F28::from_bits), roughness: roughness.map(I4F28::from_bits) }, dview: [vx, vy], dnormal: [nx, ny], edge_texels }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 4000,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2),
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_bit_pattern_gives_the_same_bits_in_both_readings(
        fragment in any_fragment(),
        profile in 0_usize..4,
        plan in 0_usize..72,
    ) {
        compare(&fragment, &plans()[plan], &profiles()[profile].1);
    }

    #[test]
    fn any_texture_derivative_gives_the_same_bits_in_both_readings(
        mantissas: [[i32; 2]; 2],
        exponents: [i16; 2],
        uv: [u32; 2],
        size: [u16; 2],
        profile in 0_usize..4,
    ) {
        let pair = |i: usize| BlockPair { mantissa: mantissas[i].map(I2F30::from_bits), exponent: exponents[i] };
        let fragment = TextureIn { uv: uv.map(U0F32::from_bits), duv: [pair(0), pair(1)] };
        compare_texture(&fragment, size, &profiles()[profile].1);
    }
}

#[test]
fn a_block_that_is_off_costs_nothing() {
    let full = ReflectionPlan::FULL;
    let fragment = random_fragment("operation counts", 1, &Precision::STANDARD);
    let cost = |plan: &ReflectionPlan, p: &Precision| compare(&fragment, plan, p);
    for (name, p) in profiles() {
        let all = cost(&full, &p);
        println!("{name:8} {all}");
        let less = [
            ("bump", ReflectionPlan { bump: false, ..full }),
            ("isotropic", ReflectionPlan { roughness: RoughnessKind::Isotropic, ..full }),
            ("roughness", ReflectionPlan { roughness: RoughnessKind::None, ..full }),
            ("curvature", ReflectionPlan { curvature: false, ..full }),
            ("footprint", ReflectionPlan { footprint: FootprintKind::None, ..full }),
        ];
        for (effect, plan) in less {
            let without = cost(&plan, &p);
            println!("  without {effect:9} {:5} of {}", without.hardware(), all.hardware());
            assert!(without.hardware() < all.hardware(), "{effect} is still there: {without}");
            assert!(without.of("mul") <= all.of("mul"));
        }
        let bare = ReflectionPlan {
            bump: false,
            roughness: RoughnessKind::None,
            curvature: false,
            footprint: FootprintKind::None,
            ..full
        };
        // A mirror without any effect needs no frame: 12 products for r, 2 for s and t, 2 in a Newton step.
        let mirror = cost(&bare, &p);
        println!("  plain mirror      {:5} of {}", mirror.hardware(), all.hardware());
        assert_eq!(mirror.of("mul"), 14 + 2 * u64::from(p.reciprocal.steps));
        assert!(mirror.hardware() * 5 < all.hardware());
    }
}

#[test]
fn the_cost_of_a_plan_does_not_depend_on_the_fragment() {
    for (name, p) in profiles() {
        for plan in plans() {
            let cost = compare(&random_fragment(name, 0, &p), &plan, &p);
            for index in 1..20 {
                assert_eq!(cost, compare(&random_fragment(name, index, &p), &plan, &p), "no branch on data");
            }
        }
    }
}
