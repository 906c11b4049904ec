//! Moments of bumps against the float64 reference.

use fixed::types::{I2F30, U0F32};
use rayon::prelude::*;
use roughxel_core::bundle::Value;
use roughxel_core::datapath::{TextureFootprint, probe_reach};
use roughxel_core::fx::Fx;
use roughxel_core::ports::{BlockPair, TextureIn};
use roughxel_core::precision::{Precision, ProbeRule};
use roughxel_core::scalar_api::texture_scale;
use roughxel_core::stage::filter::{self, LEVEL_WEIGHT, ProbeSum};
use roughxel_core::stage::moments::{
    Moments, covariance, decompose, of_isotropic_texel, of_probe, of_texel, ramp, with_ramp,
};
use roughxel_core::width::on_words;
use roughxel_host_tests::reference;
use roughxel_host_tests::reference::linear::normalise_exponent;
use roughxel_host_tests::reference::roughness::{self, compose, isotropic};
use roughxel_host_tests::space::{profiles, whole_or};
use roughxel_utilities::random::SplitMix64;

use super::filter::trilinear;

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

/// Checks the errors of random cases of every profile, each as a ratio to its stated bound.
fn hold(count: u64, error: impl Fn(&mut SplitMix64, &Precision) -> f64 + Sync) {
    for (name, p) in profiles() {
        let errors = (0..count).into_par_iter().map(|index| error(&mut SplitMix64::for_element(name, index), &p));
        let worst = errors.reduce(|| 0.0, f64::max);
        println!("{name}: {worst:.3} of the stated error");
        assert!(worst <= 1.0, "{name}: {worst} times the stated error");
    }
}

#[test]
fn equal_texels_give_back_their_own_covariance() {
    hold(100_000, |random, p| {
        let size = random.uniform(-10.0, 0.0).exp2();
        let mut within = |size: f64| random.uniform(-size, size);
        let (b, d) = ([within(1.0), within(1.0)], [within(size).abs(), within(size), within(size).abs()]);
        let texel = texel(b, d);
        assert_eq!(halfway(texel, texel), texel, "filtering equal texels changes nothing");
        let same = averaged([texel; 2]);
        let [a, b, c] = covariance(&same, p).m.map(|m| f64::from(m.raw()) / f64::from(1 << 30));
        let scale = f64::from(covariance(&same, p).e.raw()).exp2();
        let want = compose(d);
        let error = distance([a * scale, b * scale, c * scale], want);
        // Stated bound: 2^−28 absolute, and the rounding of K to p bits.
        error / ((-28_f64).exp2() + (-f64::from(p.fraction_bits)).exp2() * want[0].max(want[2]))
    });
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
    hold(100_000, |random, p| {
        let mut within = |low: f64, high: f64| random.uniform(low, high);
        // c from a thousandth to a thousand times a: the rounding of K to p bits grows with their ratio.
        let spread = within(-5.0, 5.0).exp2();
        let size = within(-8.0, -5.0).exp2();
        let d = [within(0.0, size), within(-size, size), within(0.1, 1.0) * size * spread];
        let k = covariance(&moments_of(texel([0.0; 2], d)), p);
        let scale = f64::from(k.e.raw()).exp2();
        let exact = k.m.map(|m| f64::from(m.raw()) / f64::from(1 << 30) * scale);
        let want = roughness::decompose(exact);
        let got = decompose(&k, p).map(real_offset);
        // Against K as the stage sees it, so that only its own arithmetic is tested: a root, an inverse root and their product, relative, and the
        // last place of D.
        let longest = exact[0].max(exact[2]).sqrt();
        let bound = (3.0 - f64::from(p.fraction_bits)).exp2() * longest + (-27_f64).exp2();
        distance(got, want) / bound
    });
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
                // c keeps p bits next to a: below 2^−p·a it is lost (d₂ with it), just above that b²/c is noise.
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
    hold(whole_or(100_000, 20_000), |random, p| {
        let rule = match p.probe_rule {
            ProbeRule::Ceiling => reference::probes::ProbeRule::Ceiling,
            ProbeRule::PowerOfTwo => reference::probes::ProbeRule::PowerOfTwo,
        };
        let size = [(); 2].map(|()| {
            let log2 = random.below(15);
            1 + random.below(1 << log2) as u16
        });
        // From a thousandth of a texel to a few texels, round or long.
        let scale = random.uniform(-10.0, 3.0).exp2() / f64::from(size[0].max(size[1]));
        let long = random.uniform(-8.0, 0.0).exp2();
        let mut column = |scale: f64| [(); 2].map(|()| random.uniform(-scale, scale));
        let exact = [column(scale), column(scale * long)];
        let duv = exact.map(|column| {
            let (mantissa, exponent) = normalise_exponent(column);
            BlockPair { mantissa: mantissa.map(I2F30::from_num), exponent: exponent as i16 }
        });
        let scale = texture_scale(size);
        let TextureFootprint { axes, probes, .. } = TextureIn { uv: [U0F32::ZERO; 2], duv }.footprint(&scale, p);
        let (axes, probes, texture) = (&axes, &probes, &scale.0);
        let got =
            on_words!(p, |axes, probes, texture| Value(probe_reach([&axes.major, &axes.minor], probes, texture, p))).0;
        let size = size.map(u32::from);
        let columns = reference::columns_in_texels(exact, size);
        let want = reference::texture(columns, 1.0, size, rule, p.max_probes);
        let reach = (2.0 * want.probes.minor).min(1.0);
        let error = (f64::from(got.raw()) / 65536.0 - reach).abs();
        let square = [size[0].max(size[1]); 2];
        let on_square = reference::columns_in_texels(exact, square);
        let major = reference::texture(on_square, 1.0, square, rule, p.max_probes).axes.major;
        error / ((-17_f64).exp2() + (4.0 - f64::from(p.fraction_bits)).exp2() * major)
    });
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
