//! Elementary functions and compound steps: every mantissa of 8-bit and 16-bit words, every code, and every pair if there are few.

use std::f64::consts::LOG2_E;

use roughxel_core::block::{Block, MANTISSA, Mantissa, Number, PRODUCT, ZERO_EXPONENT, align, normalise};
use roughxel_core::elementary::{
    LOGARITHM, cosine_power, exp2, half_inverse_root, half_reciprocal, log2, log2_one_plus, minus_log2_one_minus,
    one_plus, over_length, root_and_inverse, short_number,
};
use roughxel_core::fx::{Fx, Wide};
use roughxel_core::precision::{Newton, Precision};
use roughxel_core::word::{Wire, Word};
use roughxel_host_tests::checked::{CheckedWire, Visible};
use roughxel_reference::linear::norm;

use super::bounds::Bounds;
use super::{Checked8, FRACTION, ONE, Tried, mantissas, real, tiny, tiny_precisions, try_all};

type Checked16 = CheckedWire<i16>;

/// Fraction bits of a mantissa.
fn fraction<W: Word>() -> u32 {
    W::BITS - MANTISSA
}

fn integer<W: Visible>(m: Mantissa<W>) -> i64 {
    m.raw().integer()
}

/// Mantissa and exponent.
fn pair<W: Visible>(x: Number<W>) -> (i64, i64) {
    (integer(x.m[0]), W::count_integer(x.e.raw()))
}

fn number_of<W: Word>((m, e): (i64, i64)) -> Number<W> {
    Block { m: [Fx::lit(m)], e: Fx::int(e) }
}

/// m·2^e for a mantissa with `fraction` fraction bits.
fn value((m, e): (i64, i64), fraction: u32) -> f64 {
    m as f64 * (e as f64 - f64::from(fraction)).exp2()
}

/// Every mantissa from 2^`low` to 1 that a word keeps with p bits.
fn kept<W: Word>(low: i32, p: &Precision) -> impl Iterator<Item = i64> + Clone + use<W> {
    let one = 1_i64 << fraction::<W>();
    (one >> -low..=one).step_by(1 << (fraction::<W>() - p.fraction_bits))
}

/// Result of a function in the checked backend `C`, which equals the result in the scalar backend.
macro_rules! in_both {
    ($c:ident, $s:ident, $f:ident $(of $count:ident)? ( $($argument:expr),* )) => {{
        let got = $f::<$c $(, $count)?>($($argument),*);
        assert_eq!(got, $f::<$s $(, $count)?>($($argument),*), "{:?}", ($($argument),*));
        got
    }};
}

fn reciprocal<W: Visible>(m: i64, p: &Precision) -> i64 {
    integer(half_reciprocal::<W>(Fx::lit(m), p))
}

fn inverse_root<W: Visible>(m: i64, p: &Precision) -> i64 {
    integer(half_inverse_root::<W>(Fx::lit(m), p))
}

fn roots<W: Visible>(x: (i64, i64), p: &Precision) -> [(i64, i64); 2] {
    let (root, inverse) = root_and_inverse(number_of::<W>(x), p);
    [pair(root), pair(inverse)]
}

fn logarithm<W: Visible>(m: i64, p: &Precision) -> i64 {
    W::count_integer(log2::<W>(Fx::lit(m), p).raw())
}

fn exponential<W: Visible>(x: i64, p: &Precision) -> (i64, i64) {
    pair(exp2::<W>(Fx::lit(x << (32 - LOGARITHM - POWER_PLACES)), p))
}

fn logarithm_of_one_plus<W: Visible>(x: (i64, i64), p: &Precision) -> (i64, i64) {
    pair(log2_one_plus(number_of::<W>(x), p))
}

fn short<W: Visible>(code: i64) -> (i64, i64) {
    pair(short_number::<W>(Fx::int(code)))
}

/// Fraction bits of the tested powers of two: every |x| < 64 with at most this many.
const POWER_PLACES: u32 = 14;

const FIGURES: [&str; 8] =
    ["1/2x", "1/2√x", "1/√x", "√x", "log2", "exp2", "log2(1 + x), x below 1", "log2(1 + x), x from 1 on"];

/// Checks every function of one mantissa, with all exponents that matter.
fn functions_of_a_mantissa<C: Visible, S: Visible>(p: &Precision) -> Tried<8> {
    let fraction = fraction::<C>();
    let bounds = Bounds::new(*p, fraction);
    let one = 1_i64 << fraction;
    let mut tried = try_all(kept::<C>(-2, p), |tried: &mut Tried<8>, m| {
        let x = value((m, 0), fraction);
        tried.inputs += 1;
        let got = in_both!(C, S, inverse_root(m, p));
        assert!((one / 2..=one).contains(&got), "1/2√x of {m}: {got}");
        tried.hold(1, (value((got, 0), fraction) - 0.5 / x.sqrt()).abs(), bounds.half_inverse_root(x), m);
        if m < one / 2 {
            return;
        }
        tried.inputs += 2;
        let got = in_both!(C, S, reciprocal(m, p));
        assert!((one / 2..=one).contains(&got), "1/2x of {m}: {got}");
        tried.hold(0, (value((got, 0), fraction) - 0.5 / x).abs(), bounds.half_reciprocal(x), m);
        let got = in_both!(C, S, logarithm(m, p));
        assert!((-1 << (32 - LOGARITHM)..=0).contains(&got) && (m < one || got == 0), "log₂ of {m}: {got}");
        tried.hold(4, (value((got, 0), 32 - LOGARITHM) - x.log2()).abs(), bounds.log2(), m);
        for e in (-20..=20_i64).chain([-16384, -16383, 16383, 16384]) {
            tried.inputs += 1;
            let odd = e.rem_euclid(2);
            let want = (x * (odd as f64).exp2()).sqrt();
            let half = (e - odd) / 2;
            let [root, inverse] = in_both!(C, S, roots((m, e), p));
            let relative = |(m, e): (i64, i64), want: f64| (value((m, e), fraction) / want - 1.0).abs();
            tried.hold(
                2,
                relative((inverse.0, inverse.1 + half), 1.0 / want),
                bounds.inverse_root(x, odd == 1),
                (m, e),
            );
            tried.hold(3, relative((root.0, root.1 - half), want), bounds.root(x, odd == 1), (m, e));
        }
        for e in (-40..=40_i64).chain([-16384, 16384]) {
            tried.inputs += 1;
            let (got, got_e) = in_both!(C, S, logarithm_of_one_plus((m, e), p));
            // If 2^e is negligible next to 1, log₂(1 + x) is x/ln 2; if it is much larger, slightly more than e.
            let (want, unit) = match e {
                ..-1000 => (x * LOG2_E, e),
                1001.. => (e as f64, 0),
                _ => ((x * (e as f64).exp2()).ln_1p() * LOG2_E, 0),
            };
            let bar = bounds.log2_one_plus(e < 1) + if e > 1000 { 1.0 / e as f64 } else { 0.0 };
            let figure = if e < 1 { 6 } else { 7 };
            tried.hold(figure, (value((got, got_e - unit), fraction) / want - 1.0).abs(), bar, (m, e));
        }
    });
    let end = 64_i64 << POWER_PLACES;
    for x in -end + 1..end {
        tried.inputs += 1;
        let (got, e) = in_both!(C, S, exponential(x, p));
        assert!((one / 2..=one).contains(&got), "2^x of {x}: {got}");
        let exact = x as f64 / f64::from(POWER_PLACES).exp2();
        tried.hold(5, (value((got, e), fraction) / exact.exp2() - 1.0).abs(), bounds.exp2(), x);
    }
    let zero = (0, ZERO_EXPONENT);
    assert_eq!(roots::<C>(zero, p)[0], zero);
    assert_eq!(logarithm_of_one_plus::<C>(zero, p), zero);
    // 0 is the mantissa of a block of zeros only. The result is that of the least x, and meets a factor 0.
    let at = |x: i64| (in_both!(C, S, reciprocal(x, p)), in_both!(C, S, inverse_root(x, p)));
    assert!((one / 2..=one).contains(&at(0).0) && (one / 2..=one).contains(&at(0).1));
    assert!(p.reciprocal.steps == 0 || at(0).0 == one);
    tried
}

/// Number of inputs for p bits of a word.
fn of_a_mantissa(p: &Precision) -> u64 {
    let unit = 1 << p.fraction_bits;
    (unit - unit / 4 + 1) + (unit / 2 + 1) * (2 + 45 + 83) + (128_u64 << POWER_PLACES) - 1
}

#[test]
fn functions_of_every_mantissa_of_8_bits_hold_their_bounds() {
    for p in tiny_precisions() {
        let tried = functions_of_a_mantissa::<Checked8, i8>(&p);
        let name = format!("functions on 8 bits, p {}, {:?}", p.fraction_bits, p.reciprocal);
        tried.report(&name, FIGURES, of_a_mantissa(&p));
    }
}

/// Bounds on 16-bit words as the docstring of `elementary` states them, in the order of [`FIGURES`]; roots have no stated bound.
fn stated_on_16_bits(p: &Precision) -> [f64; 8] {
    let kept = f64::from(p.fraction_bits);
    let [reciprocal, root] = stated_newton(p.fraction_bits, p.reciprocal);
    [
        reciprocal,
        root,
        1.0,
        1.0,
        2.0_f64.powi(-18),
        (-kept).exp2() + 2.0_f64.powi(-18),
        (1.5 - kept).exp2(),
        (2.0 - kept).exp2(),
    ]
}

/// Bounds of 1/2x and 1/2√x as the docstring of `elementary` states them for words of any width.
fn stated_newton(kept: u32, newton: Newton) -> [f64; 2] {
    let (p, k, power) = (f64::from(kept), f64::from(newton.seed_bits), f64::from(1 << newton.steps));
    [(-p - 0.8).exp2() + (-power * (k + 0.7)).exp2(), (-p).exp2() + (-power * (k - 0.76)).exp2() / 1.5]
}

/// The knobs that suit a 16-bit word.
#[test]
fn functions_of_every_mantissa_of_16_bits_hold_their_bounds() {
    for fraction_bits in 12..=14 {
        let newton = Newton { seed_bits: 8, steps: 1 };
        let p = Precision { fraction_bits, reciprocal: newton, inverse_root: newton, ..Precision::COMPACT };
        let tried = functions_of_a_mantissa::<Checked16, i16>(&p);
        tried.report(&format!("functions on 16 bits, p {fraction_bits}"), FIGURES, of_a_mantissa(&p));
        for ((worst, stated), figure) in tried.errors.into_iter().zip(stated_on_16_bits(&p)).zip(FIGURES) {
            assert!(worst <= stated, "{figure}, p {fraction_bits}: 2^{:.3}", worst.log2());
        }
    }
}

/// 1/2x and 1/2√x with every seed table and up to two steps.
#[test]
fn every_seed_and_step_count_holds_its_bound_on_16_bits() {
    let newtons = (6..=10).flat_map(|seed_bits| (0..=2).map(move |steps| Newton { seed_bits, steps }));
    for newton in newtons {
        let mut inputs = 0;
        let mut worst = Tried::<2>::none();
        for fraction_bits in 12..=14 {
            let p = Precision { fraction_bits, reciprocal: newton, inverse_root: newton, ..Precision::COMPACT };
            let bounds = Bounds::new(p, fraction::<i16>());
            let tried = try_all(kept::<i16>(-2, &p), |tried, m| {
                let x = value((m, 0), fraction::<i16>());
                let got = |m| value((m, 0), fraction::<i16>());
                tried.inputs += 1;
                let root = got(in_both!(Checked16, i16, inverse_root(m, &p)));
                tried.hold(1, (root - 0.5 / x.sqrt()).abs(), bounds.half_inverse_root(x), (m, p));
                if x >= 0.5 {
                    tried.inputs += 1;
                    let reciprocal = got(in_both!(Checked16, i16, reciprocal(m, &p)));
                    tried.hold(0, (reciprocal - 0.5 / x).abs(), bounds.half_reciprocal(x), (m, p));
                }
            });
            inputs += (5 << fraction_bits) / 4 + 2;
            let stated = stated_newton(fraction_bits, newton);
            assert!(tried.errors.iter().zip(stated).all(|(&error, stated)| error <= stated), "{newton:?}");
            worst += tried;
        }
        worst.report(&format!("{newton:?} on 16 bits"), ["1/2x", "1/2√x"], inputs);
    }
}

#[test]
fn every_short_number_is_exact_on_16_bits_and_floored_on_8() {
    let mut inputs = 0;
    for code in 0..1 << 16 {
        let (c, f) = (code >> 12, code & 0xfff);
        let (m, e) = if c == 0 { (f, 0) } else { (f + 4096, c - 1) };
        assert_eq!(in_both!(Checked16, i16, short(code)), (m << 1, e));
        assert_eq!(in_both!(Checked8, i8, short(code)), (m >> 7, e));
        inputs += 1;
    }
    eprintln!("short numbers: {inputs} inputs");
    assert_eq!(inputs, 65_536);
}

fn unit_of<W: Visible, const N: usize>(m: [i64; N], p: &Precision) -> [i64; N] {
    over_length(&Block::<W, N> { m: m.map(Fx::lit), e: Fx::int(0) }, p).map(integer)
}

/// Checks a vector over its length: a square length and an inverse root are relative, then every component is floored and rounded.
fn hold_unit<const N: usize>(tried: &mut Tried<1>, m: [i64; N], inverse: f64, p: &Precision) {
    if m.iter().all(|m| m.abs() < ONE / 2) {
        return;
    }
    tried.inputs += 1;
    let half = Bounds::new(*p, FRACTION).half_place();
    let relative = (1.0 + inverse) * (1.0 - 2.0 * half).powf(-0.5) - 1.0;
    let got = in_both!(Checked8, i8, unit_of of N (m, p));
    let length = norm(&m.map(real));
    for (got, m) in got.into_iter().zip(m) {
        let want = real(m) / length;
        // The products have 6 bits before the point.
        let bar = want.abs() * relative + 4.0 * Bounds::new(*p, FRACTION).product_place() + half;
        tried.hold(0, (real(got) - want).abs(), bar, m);
    }
}

#[test]
fn every_vector_of_8_bits_over_its_length_is_a_unit_vector() {
    // With 4 bits, a component is 35/32 at most, beyond its claim of 17/16.
    for p in [5, 6].map(|fraction_bits| tiny(fraction_bits, 1)) {
        let [inverse, _] = Bounds::new(p, FRACTION).worst_roots();
        let all = mantissas(&p);
        let tried = try_all(all.clone(), |tried, x| {
            for y in all.clone() {
                hold_unit(tried, [x, y], inverse, &p);
                for z in all.clone() {
                    hold_unit(tried, [x, y, z], inverse, &p);
                }
            }
        });
        let (whole, inner) = ((2_u64 << p.fraction_bits) + 1, (1_u64 << p.fraction_bits) - 1);
        let count = whole.pow(2) - inner.pow(2) + whole.pow(3) - inner.pow(3);
        tried.report(&format!("over length, p {}", p.fraction_bits), ["component"], count);
    }
}

fn versine<W: Visible>(y: i64, p: &Precision) -> (i64, i64) {
    pair(minus_log2_one_minus::<W>(Fx::from_raw(Wire::lit(y)), p))
}

fn power<W: Visible>(y: i64, n: (i64, i64), p: &Precision) -> (i64, i64) {
    pair(cosine_power(Fx::from_raw(Wire::lit(y)), number_of::<W>(n), p))
}

#[test]
fn every_power_of_a_cosine_of_8_bits_is_within_its_roundings() {
    // y has 13 fraction bits on a wide wire; beyond 1 it counts as 1.
    const PLACES: u32 = 13;
    for p in [4, 5, 6].map(|fraction_bits| tiny(fraction_bits, 1)) {
        let bounds = Bounds::new(p, FRACTION);
        let exponents: Vec<(i64, i64)> = (0..=14)
            .flat_map(|e| mantissas(&p).filter(move |&m| m >= if e == 0 { 0 } else { ONE / 2 }).map(move |m| (m, e)))
            .collect();
        let last = 1 << PLACES;
        let tried = try_all((0..=last).chain([last + 1, 2 * last, i64::from(i16::MAX)]), |tried, y| {
            let cos = 1.0 - y as f64 / f64::from(1 << PLACES);
            let got = in_both!(Checked8, i8, versine(y, &p));
            let relative = bounds.minus_log2_one_minus(2 * y < last);
            let log = if cos > 0.0 { -cos.log2() } else { 64.0 };
            tried.inputs += 1;
            if y == 0 {
                assert_eq!(got, (0, ZERO_EXPONENT));
            } else {
                tried.hold(0, (value(got, FRACTION) / log - 1.0).abs(), relative, y);
            }
            for &n in &exponents {
                tried.inputs += 1;
                let got = value(in_both!(Checked8, i8, power(y, n, &p)), FRACTION);
                if cos <= 0.0 {
                    assert_eq!(got, 0.0, "{y} {n:?}");
                    continue;
                }
                // An exponent of two comes from 6 fraction bits.
                let exact = log * value(n, FRACTION);
                let moved = exact * relative + 2.0_f64.powi(-6);
                let want = (-exact).exp2();
                let above = (moved - exact).exp2().min(1.0) - want;
                let bar = above.max(want - (-exact - moved).exp2()) + bounds.exp2() + 2.0_f64.powi(-63);
                tried.hold(1, (got - want).abs(), bar, (y, n));
                assert!(got <= 1.0 && (y > 0 || got == 1.0), "{y} {n:?}: {got}");
            }
        });
        let unit = 1 << p.fraction_bits;
        let count = (u64::try_from(last).expect("positive") + 4) * (1 + (unit + 1) + 14 * (unit / 2 + 1));
        tried.report(&format!("power of a cosine, p {}", p.fraction_bits), ["−log2(1 − y)", "power"], count);
    }
}

fn sum<W: Visible>(x: (i64, i64), fraction_bits: u32) -> (i64, i64) {
    pair(one_plus(number_of::<W>(x), fraction_bits))
}

fn aligned<W: Visible>(a: (i64, i64), b: (i64, i64), fraction_bits: u32) -> ([i64; 2], i64) {
    let ([[a], [b]], e) = align([number_of::<W>(a), number_of::<W>(b)], fraction_bits);
    ([integer(a), integer(b)], W::count_integer(e.raw()))
}

/// ⌊m/2^(k − 6 + fraction_bits) + ½⌋·2^(6 − fraction_bits) of an integer mantissa.
fn rounded(m: i64, k: i64, fraction_bits: u32) -> i64 {
    let drop = k.clamp(0, 30) + i64::from(FRACTION - fraction_bits);
    ((((m << 1) >> drop) + 1) >> 1) << (FRACTION - fraction_bits)
}

#[test]
fn sums_and_alignments_of_every_two_numbers_of_8_bits_are_rounded_once() {
    for p in tiny_precisions().filter(|p| p.reciprocal.steps == 0) {
        let fraction_bits = p.fraction_bits;
        let bounds = Bounds::new(p, FRACTION);
        let numbers = mantissas(&p).filter(|m| m.abs() >= ONE / 2);
        let tried = try_all(-20..=20, |tried: &mut Tried<1>, e| {
            for a in numbers.clone() {
                if a > 0 {
                    tried.inputs += 1;
                    let want = 1.0 + value((a, e), FRACTION);
                    let got = value(in_both!(Checked8, i8, sum((a, e), fraction_bits)), FRACTION);
                    // A place of the product is floored at the larger exponent.
                    let bar = 2.0 * bounds.half_place() + 4.0 * bounds.product_place();
                    tried.hold(0, (got / want - 1.0).abs(), bar, (a, e));
                }
                for b in numbers.clone() {
                    tried.inputs += 1;
                    let got = in_both!(Checked8, i8, aligned((a, e), (b, 0), fraction_bits));
                    let places = [-e, e].map(|k| k.clamp(0, 7));
                    let want = [rounded(a, places[0], fraction_bits), rounded(b, places[1], fraction_bits)];
                    assert_eq!(got, (want, e.max(0)), "{a}·2^{e}, {b}");
                }
                let nothing = (0, ZERO_EXPONENT);
                assert_eq!(in_both!(Checked8, i8, aligned((a, e), nothing, fraction_bits)), ([a, 0], e));
            }
        });
        let half = (1 << fraction_bits) / 2 + 1;
        tried.report(&format!("sums and alignments, p {fraction_bits}"), ["1 + x"], 41 * (half + 4 * half * half));
    }
}

fn block_of<W: Visible, const N: usize>(wide: [i64; N], fraction_bits: u32) -> ([i64; N], i64) {
    let wide: [Wide<W, PRODUCT>; N] = wide.map(|x| Fx::from_raw(Wire::lit(x)));
    let block = normalise(wide, Fx::int(0), fraction_bits);
    (block.m.map(integer), W::count_integer(block.e.raw()))
}

fn hold_block<const N: usize>(tried: &mut Tried<1>, wide: [i64; N], fraction_bits: u32) {
    tried.inputs += 1;
    let (m, e) = in_both!(Checked8, i8, block_of of N (wide, fraction_bits));
    let largest = m.iter().fold(0, |largest, m| largest.max(m.abs()));
    if wide == [0; N] {
        assert_eq!((m, e), ([0; N], ZERO_EXPONENT));
        return;
    }
    assert!((ONE / 2..=ONE).contains(&largest), "{wide:?}: {m:?}");
    let half = (-f64::from(fraction_bits) - 1.0).exp2();
    for (m, wide) in m.into_iter().zip(wide) {
        tried.hold(0, (real(m) - value((wide, -e), 12)).abs(), half, wide);
    }
}

#[test]
fn every_wide_wire_of_16_bits_becomes_a_block() {
    let words = i64::from(i8::MIN)..=i64::from(i8::MAX);
    let tried = try_all(i64::from(i16::MIN)..=i64::from(i16::MAX), |tried, wide| {
        for fraction_bits in 4..=6 {
            hold_block(tried, [wide], fraction_bits);
        }
        for word in words.clone() {
            hold_block(tried, [word, wide], 6);
        }
    });
    tried.report("blocks", ["mantissa"], (3 << 16) + (1 << 24));
}
