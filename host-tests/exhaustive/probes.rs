//! Probe rule: every pair of λ₁ and λ₂ of 8-bit words, with every rule and every largest count; every level of detail and every step.

use roughxel_core::block::{Block, ZERO_EXPONENT};
use roughxel_core::fx::Fx;
use roughxel_core::precision::{Precision, ProbeRule};
use roughxel_core::signals::Axes;
use roughxel_core::stage::probes::{face_scale, probes};
use roughxel_host_tests::checked::Visible;
use roughxel_reference::linear::norm;

use super::bounds::Bounds;
use super::{Checked8, FRACTION, ONE, mantissas, normalised, real, tiny, try_all};

/// Mantissa and exponent of a number.
type Number = (i64, i64);

/// Results of the stage for one footprint.
#[derive(Debug, PartialEq)]
struct Found {
    count: i64,
    step: [f64; 2],
    lod: f64,
    empty: bool,
    saturated: bool,
    capped: bool,
}

/// A footprint on a cube face of `edge` texels.
fn probes_of<W: Visible>(sigmas: [Number; 2], direction: [i64; 2], edge: i64, p: &Precision) -> Found
where
    bool: From<W::Flag>,
{
    let [major, minor] = sigmas.map(|(m, e)| Block::<W, 1> { m: [Fx::lit(m)], e: Fx::int(e) });
    let map = face_scale::<W>(Fx::int(edge), p);
    let found = probes(&Axes { major, minor, direction: direction.map(Fx::lit) }, &map, p);
    Found {
        count: W::count_integer(found.count.raw()),
        step: found.step.map(|step| W::count_integer(step.raw()) as f64 / f64::from(1 << 28)),
        lod: W::count_integer(found.lod.raw()) as f64 / f64::from(1 << 16),
        empty: found.empty.into(),
        saturated: found.saturated.into(),
        capped: found.capped.into(),
    }
}

fn checked(sigmas: [Number; 2], direction: [i64; 2], edge: i64, p: &Precision) -> Found {
    let found = probes_of::<Checked8>(sigmas, direction, edge, p);
    assert_eq!(found, probes_of::<i8>(sigmas, direction, edge, p), "{sigmas:?} {direction:?}");
    found
}

fn value((m, e): Number) -> f64 {
    if m == 0 { 0.0 } else { real(m) * (e as f64).exp2() }
}

const NOTHING: Number = (0, ZERO_EXPONENT);
const UPRIGHT: [i64; 2] = [0, ONE];

/// The least count of a rule for which that many λ₂ reach the threshold, and whether there is none.
fn rule(threshold: f64, minor: f64, p: &Precision) -> (i64, bool) {
    let most = i64::from(p.max_probes);
    let mut counts = (1..=most).filter(|n| p.probe_rule == ProbeRule::Ceiling || n & (n - 1) == 0);
    let last = counts.clone().next_back().expect("a probe");
    counts.find(|&n| n as f64 * minor >= threshold).map_or((last, true), |n| (n, false))
}

/// Tested kept bits. With 4 bits the slack, 2^−(p−4) of λ₁, is all of it: nothing asks for a second probe.
const KEPT: [u32; 2] = [5, 6];

#[test]
fn probe_count_of_every_ratio_is_that_of_its_rule() {
    let mut inputs = 0;
    for p in KEPT.map(|fraction_bits| tiny(fraction_bits, 0)) {
        let slack = (4.0 - f64::from(p.fraction_bits)).exp2();
        let rules = [ProbeRule::Ceiling, ProbeRule::PowerOfTwo].into_iter();
        let rules =
            rules.flat_map(|probe_rule| (1..=16).map(move |max_probes| Precision { probe_rule, max_probes, ..p }));
        let tried = try_all(rules, |tried, p| {
            for major in normalised(&p) {
                // A word and its wide wire have 14 places to shift; larger shifts count as 14.
                let minors = (0..=16).flat_map(|below| normalised(&p).map(move |m| (m, -below)));
                for minor in minors.filter(|&(m, e)| e < 0 || m <= major).chain([NOTHING]) {
                    tried.inputs += 1;
                    let sigmas = [(major, 0), minor];
                    let found = checked(sigmas, UPRIGHT, 256, &p);
                    let threshold = real(major) * (1.0 - slack);
                    let want = rule(threshold, value(minor), &p);
                    // λ₂ is floored to 2^−10 of λ₁'s exponent if it is far below: then the next count is allowed, too.
                    let floored = rule(threshold, (value(minor) * 1024.0).floor() / 1024.0, &p);
                    let got = (found.count, found.capped);
                    assert!(got == want || got == floored, "{sigmas:?}: {got:?}, not {want:?} with {p:?}");
                    assert!(minor.1 < -4 || want == floored, "{sigmas:?}");
                    assert!(!found.empty && !found.saturated, "{sigmas:?}");
                }
            }
            for minor in [NOTHING, (ONE / 2, -20)] {
                let found = checked([NOTHING, minor], UPRIGHT, 256, &p);
                assert!(found.empty && !found.saturated && found.step == [0.0; 2] && found.lod == 0.0, "{found:?}");
            }
        });
        let m = (1 << p.fraction_bits) / 2 + 1;
        tried.report(&format!("probe count, p {}", p.fraction_bits), [], 32 * (16 * m * m + m * (m + 1) / 2 + m));
        inputs += tried.inputs;
    }
    eprintln!("probe count: {inputs} inputs");
}

#[test]
fn every_level_of_detail_is_right_and_none_falls_with_the_footprint() {
    for p in KEPT.map(|fraction_bits| tiny(fraction_bits, 0)) {
        // log₂ has no fraction bit on 8-bit words, so its knots are rounded by ½. In addition there are the rounding of the level and constants
        // with 16 bits.
        let bar = 0.5 + (-f64::from(p.lod_bits) - 1.0).exp2() + 3.0 * 2.0_f64.powi(-17);
        let edges: Vec<i64> = (0..=14).map(|level| 1 << level).collect();
        let cases = edges.iter().flat_map(|&edge| (1..=17).map(move |most| (edge, most)));
        let tried = try_all(cases, |tried, (edge, most)| {
            // 17: a circle; otherwise a line with that many probes.
            let p = Precision { max_probes: if most == 17 { 16 } else { most }, ..p };
            let mut last = 0.0;
            for (e, m) in (-24..=24).flat_map(|e| normalised(&p).filter(|&m| m < ONE).map(move |m| (e, m))) {
                tried.inputs += 1;
                let sigmas = [(m, e), if most == 17 { (m, e) } else { NOTHING }];
                let found = checked(sigmas, UPRIGHT, edge, &p);
                let raised = if most == 17 { value((m, e)) } else { value((m, e)) / f64::from(most) };
                let want = (2.0 * 3.0_f64.sqrt() * raised * edge as f64 / 2.0).log2();
                let want = want.clamp(0.0, (edge as f64).log2());
                tried.hold(0, (found.lod - want).abs(), bar, (sigmas, edge));
                assert!(found.lod >= last && found.capped == (most != 17), "{sigmas:?}");
                assert_eq!(found.saturated, e > 1, "{sigmas:?}");
                last = found.lod;
            }
        });
        let mantissas = (1 << p.fraction_bits) / 2;
        tried.report(&format!("level of detail, p {}", p.fraction_bits), ["level"], 15 * 17 * 49 * mantissas);
    }
}

#[test]
fn every_step_is_a_share_of_the_major_diameter() {
    for p in KEPT.map(|fraction_bits| tiny(fraction_bits, 0)) {
        let half = Bounds::new(p, FRACTION).half_place();
        // A direction of the axes has unit length except for 4 places.
        let unit = |d: &[i64; 2]| (norm(&d.map(real)) - 1.0).abs() <= 8.0 * half && d[0].max(d[1]) >= -d[0].min(d[1]);
        let pairs = mantissas(&p).flat_map(|x| mantissas(&p).map(move |y| [x, y]));
        let directions: Vec<[i64; 2]> = pairs.filter(unit).collect();
        // 2√3/N is rounded to a word with 4 fraction bits and, if that is fewer, to two bits fewer than a mantissa keeps. The length is at a
        // mantissa of at least ½.
        let kept = if p.offset_bits() < 4 { 4.0 * half } else { 0.0 };
        let (per_sigma, length) = (2.0_f64.powi(-5) + kept, 1.0 + 2.0 * half);
        // A step has 4 fraction bits, and 9 before its rounding.
        let last = 2.0_f64.powi(-5) + 2.0_f64.powi(-9);
        let tried = try_all((1..=16).flat_map(|n| (-6..=2).map(move |e| (n, e))), |tried, (count, e)| {
            let p = Precision { max_probes: count, ..p };
            for (m, &direction) in normalised(&p).flat_map(|m| directions.iter().map(move |d| (m, d))) {
                tried.inputs += 1;
                let sigmas = [(m, e), NOTHING];
                let found = checked(sigmas, direction, 256, &p);
                let input = (sigmas, direction, count);
                assert_eq!((found.count, found.saturated), (i64::from(count), e > 1), "{input:?}");
                // λ₁ is clamped to 2.
                let major = if e > 1 { 2.0 } else { value((m, e)) };
                let share = 2.0 * 3.0_f64.sqrt() / f64::from(count);
                let want = direction.map(|d| share * major * real(d));
                let longest = want[0].abs().max(want[1].abs()) * (1.0 + per_sigma / share) * length;
                for (got, want) in found.step.into_iter().zip(want) {
                    let bar = want.abs() * ((1.0 + per_sigma / share) * length - 1.0) + 2.0 * half * longest + last;
                    tried.hold(0, (got - want).abs(), bar, input);
                }
            }
        });
        let mantissas = (1 << p.fraction_bits) / 2 + 1;
        let name = format!("step, p {}, {} directions", p.fraction_bits, directions.len());
        tried.report(&name, ["step"], 16 * 9 * mantissas * directions.len() as u64);
    }
}
