//! Elementary functions of mantissas: reciprocal, inverse root, root, log₂, exp₂, log₂(1 + x), powers of a cosine.
//!
//! Reciprocal and inverse root: a seed from a table, then Newton steps whose residual is taken exactly. log₂ and
//! exp₂: linear interpolation between 257 knots. Bounds, proven by exhausting the mantissa in
//! `host-tests/tests/datapath/elementary.rs` (p = kept fraction bits, k = seed bits, n = Newton steps):
//! 1/2x errs by at most 2^−(p+0.8) + 2^−(2^n·(k+0.7)), 1/2√x by 2^−p + ⅔·2^−(2^n·(k−0.76)), log₂ by 2^−18.4,
//! exp₂ by 2^−p + 2^−20 and log₂(1 + x) by 2^−(p−0.9) + 2^−18.4 (relative).

use crate::block::{Block, Exponent, MANTISSA, Mantissa, places_below};
use crate::fx::{Fx, Wide};
use crate::precision::{Newton, Precision};
use crate::rom;
use crate::word::Word;

/// One with 60 fraction bits.
#[inline(always)]
fn one<W: Word>() -> Wide<W, 60> {
    Fx::lit(1 << 60)
}

/// One Newton correction `y + y·residual·2^−extra`; the residual is below 2^−(k − 3), so it is scaled up by
/// `2^scale` before it is rounded to a multiplier operand.
#[inline(always)]
fn correct<W: Word>(y: Mantissa<W>, residual: Wide<W, 60>, scale: u32, extra: u32, keep: u32) -> Mantissa<W> {
    let operand: Mantissa<W> = residual.shl(scale).round_to(keep);
    let correction: Wide<W, 60> = y.mul(operand);
    (y.widen() + correction.floor_shr(scale + extra)).round_to(keep)
}

/// Index of `x` in a seed table whose first interval starts at `low`; each interval is 2^−`bits` wide.
#[inline(always)]
fn seed_index<W: Word>(x: Mantissa<W>, low: i64, bits: u32, last: i64) -> Fx<W, 0> {
    let index: Fx<W, 0> = (x - Fx::lit(low)).floor_shr(MANTISSA - bits).reread();
    index.saturate(Fx::lit(0), Fx::lit(last))
}

/// `1/(2x)` for x in [½, 1], in [½, 1]. x = 0 gives 1 (a caller multiplies it by zero).
#[inline(always)]
pub fn half_reciprocal<W: Word>(x: Mantissa<W>, p: &Precision) -> Mantissa<W> {
    let Newton { seed_bits, steps } = p.reciprocal;
    // [½, 1) holds 2^seed_bits intervals of width 2^−(seed_bits + 1).
    let index = seed_index(x, 1 << 29, seed_bits + 1, (1 << seed_bits) - 1);
    let mut y = Fx::from_raw(index.raw().lookup(rom::reciprocal(seed_bits)));
    let mut scale = seed_bits - 3;
    for _ in 0..steps {
        let product: Wide<W, 60> = x.mul(y);
        // Outside [½, 1] (x = 0) the residual would leave its range: saturation keeps the block total.
        let limit = one::<W>().floor_shr(scale);
        let residual = (one::<W>() - product.shl(1)).saturate(-limit, limit);
        y = correct(y, residual, scale, 0, p.fraction_bits);
        scale = (2 * scale).min(28);
    }
    y.min(Fx::lit(1 << 30))
}

/// `1/√x` of a number `x.m · 2^x.e` ≥ 0, as a block. x = 0 gives some number (a caller multiplies it by zero).
#[inline(always)]
pub fn inverse_root<W: Word>(x: Block<W, 1>, p: &Precision) -> Block<W, 1> {
    let (even, half_exponent) = even_exponent(x, p.fraction_bits);
    let y = half_inverse_root(even, p);
    // 1/√(m·2^(2h)) = 2·y·2^−h.
    Block { m: [y], e: Fx::lit(1) - half_exponent }
}

/// `1/(2√x)` for x in [¼, 1], in [½, 1].
#[inline(always)]
pub fn half_inverse_root<W: Word>(x: Mantissa<W>, p: &Precision) -> Mantissa<W> {
    let Newton { seed_bits, steps } = p.inverse_root;
    let index = seed_index(x, 1 << 28, seed_bits, (3 << (seed_bits - 2)) - 1);
    let mut y: Mantissa<W> = Fx::from_raw(index.raw().lookup(rom::inverse_root(seed_bits)));
    let mut scale = seed_bits - 3;
    for _ in 0..steps {
        let square: Mantissa<W> = y.mul::<MANTISSA, 60>(y).round_to(p.fraction_bits);
        let product: Wide<W, 60> = x.mul(square);
        let limit = one::<W>().floor_shr(scale);
        let residual = (one::<W>() - product.shl(2)).saturate(-limit, limit);
        y = correct(y, residual, scale, 1, p.fraction_bits);
        scale = (2 * scale).min(28);
    }
    y.min(Fx::lit(1 << 30))
}

/// A number ≥ 0 as x in [¼, 1] and h with value x · 4^h.
#[inline(always)]
fn even_exponent<W: Word>(x: Block<W, 1>, keep: u32) -> (Mantissa<W>, Exponent<W>) {
    let odd = x.e - x.e.floor_shr(1).shl(1);
    (x.m[0].round_shr_by(odd, keep), (x.e + odd).floor_shr(1))
}

/// `√x` of a number ≥ 0, and `1/√x` beside it, from one inverse root.
#[inline(always)]
pub fn root_and_inverse<W: Word>(x: Block<W, 1>, p: &Precision) -> (Block<W, 1>, Block<W, 1>) {
    let inverse = inverse_root(x, p);
    let root = Block::of(x.m[0].mul::<MANTISSA, 60>(inverse.m[0]), x.e + inverse.e, p.fraction_bits);
    (root, inverse)
}

/// `log₂ m` for a mantissa m in [½, 1], in [−1, 0], 24 fraction bits. m below ½ reads as ½.
#[inline(always)]
pub fn log2<W: Word>(m: Mantissa<W>, p: &Precision) -> Fx<W, 24> {
    // m = (1 + (i + f)/256)/2.
    let above = (m - Fx::lit(1 << 29)).saturate(Fx::lit(0), Fx::lit((1 << 29) - 1));
    let index: Fx<W, 0> = above.floor_shr(29 - rom::LOG_BITS).reread();
    let within = above - index.reread::<MANTISSA>().shl(29 - rom::LOG_BITS);
    let fraction: Mantissa<W> = within.shl(rom::LOG_BITS + 1).keep(p.fraction_bits);
    let knot: Fx<W, 24> = Fx::from_raw(index.raw().lookup(&rom::LOG2));
    let next: Fx<W, 24> = Fx::from_raw((index + Fx::lit(1)).raw().lookup(&rom::LOG2));
    let rise: Fx<W, 24> = (next - knot).claim(0..=(1 << 17) - 1, "knots_of_log2_rise_by_less_than_2_to_the_minus_7");
    let rise: Wide<W, 54> = rise.mul(fraction);
    let value: Fx<W, 24> = (knot.widen::<54>() + rise).round_to(24);
    // 1 itself lies beyond the last interval by one bit of the kept fraction: log₂ 1 = 0 exactly.
    let whole = !m.lt(Fx::lit(1 << 30));
    Fx::select(whole, Fx::zero(), value - Fx::lit(1 << 24))
}

/// `2^x` for any x with 24 fraction bits and |x| < 64, as a block.
#[inline(always)]
pub fn exp2<W: Word>(x: Fx<W, 24>, p: &Precision) -> Block<W, 1> {
    let whole = x.floor_shr(24);
    let within = x - whole.shl(24);
    let index = within.floor_shr(24 - rom::LOG_BITS);
    let step = within - index.shl(24 - rom::LOG_BITS);
    let fraction: Mantissa<W> = step.reread::<MANTISSA>().shl(MANTISSA - 24 + rom::LOG_BITS).keep(p.fraction_bits);
    let knot: Mantissa<W> = Fx::from_raw(index.raw().lookup(&rom::EXP2));
    let next: Mantissa<W> = Fx::from_raw(index.raw().add(W::lit(1)).lookup(&rom::EXP2));
    let rise: Mantissa<W> = (next - knot).claim(0..=(1 << 22) - 1, "knots_of_exp2_rise_by_less_than_2_to_the_minus_8");
    // 24 fraction bits of a rise fit an operand of 18 bits; the rest would be 2^−25.
    let rise: Wide<W, 60> = rise.keep(24).mul(fraction);
    let mantissa = (knot.widen::<60>() + rise).round_to(p.fraction_bits);
    Block { m: [mantissa], e: whole.reread::<0>() + Fx::lit(1) }
}

/// Fraction bits of y = 1 − cos, so that a square of mantissas is twice it.
pub const VERSINE: u32 = 61;

/// `−log₂(1 − y)` for y in [0, 1], relative error 2^−(p−1.4) + 2^−19.4; −log₂ of 2^−63 or less, y above 1 among it, is 64.
///
/// Below ½ it is y times a tabulated ratio, so that a tiny y keeps its accuracy; above, the logarithm of 1 − y.
#[inline(always)]
pub fn minus_log2_one_minus<W: Word>(y: Wide<W, VERSINE>, p: &Precision) -> Block<W, 1> {
    let keep = p.fraction_bits;
    let (one, half): (Wide<W, VERSINE>, Wide<W, VERSINE>) = (Fx::lit(1 << VERSINE), Fx::lit(1 << (VERSINE - 1)));
    let scaled = Block::of(y, Fx::zero(), keep);
    let below_half = y.saturate(Fx::zero(), half - Fx::lit(1)).floor_shr(VERSINE - MANTISSA);
    let below_half: Mantissa<W> = Fx::from_raw(W::narrow(below_half.raw()));
    let index = below_half.floor_shr(29 - rom::LOG_BITS);
    let within = below_half - index.shl(29 - rom::LOG_BITS);
    let fraction = within.shl(rom::LOG_BITS + 1).keep(keep);
    let knot: Fx<W, 26> = Fx::from_raw(index.raw().lookup(&rom::HALF_LOG2_ONE_MINUS_RATIO));
    let next: Fx<W, 26> = Fx::from_raw(index.raw().add(W::lit(1)).lookup(&rom::HALF_LOG2_ONE_MINUS_RATIO));
    let rise = (next - knot).claim(0..=(1 << 17) - 1, "knots_of_log2_one_minus_rise_by_less_than_2_to_the_minus_9");
    let rise: Wide<W, 56> = rise.mul(fraction);
    let half_ratio: Mantissa<W> = (knot.widen::<56>() + rise).round_to(keep);
    let near: Wide<W, 60> = scaled.m[0].mul(half_ratio);

    let rest: Block<W, 1> = Block::of((one - y).max(Fx::zero()), Fx::zero(), keep);
    let log = log2(rest.m[0], p) + rest.e.saturate(Fx::lit(-63), Fx::zero()).reread::<24>().shl(24);
    // At most 64 with 24 fraction bits: 2^12 above the binary point of a product leaves it in [−1, 1].
    let far: Wide<W, 60> = (-log).widen::<48>().reread();

    let is_far = y.ge(half);
    Block::of(Fx::select(is_far, far, near), Fx::select(is_far, Fx::lit(12), scaled.e + Fx::lit(1)), keep)
}

/// `cosⁿ` = 2^(n·log₂(1 − y)) of y = 1 − cos ≥ 0 and n = n.m·2^n.e, n.e in 0…14; 0 where y ≥ 1, 1 where y = 0.
///
/// n.m need not be normalised where n.e = 0. Error, absolute: 2^−(p−0.3) + 2^−20 for every n up to 2^13, beside that
/// of y (n times it, relative). A power below 2^−63 is 2^−63.
#[inline(always)]
pub fn cosine_power<W: Word>(y: Wide<W, VERSINE>, n: Block<W, 1>, p: &Precision) -> Block<W, 1> {
    let log = minus_log2_one_minus(y, p);
    let product: Wide<W, 60> = log.m[0].mul(n.m[0]);
    let e = log.e + n.e;
    // n.m ≥ ½ where n.e > 0 and log.m ≥ ½: with an exponent above 6 the product is 32 at least.
    let at_64: Wide<W, 54> = product.reread::<54>().floor_shr_by(places_below(e, Fx::lit(6), 62));
    let last: Fx<W, 24> = Fx::lit(63 << 24);
    let x = Fx::select(Fx::lit(6).lt(e), last, at_64.round_to::<24>(24).min(last));
    Block::select(y.ge(Fx::lit(1 << VERSINE)), Block::zero(), exp2(-x, p))
}

/// A stored number of 16 bits, exponent c in the upper 4, fraction f in the lower 12: m·2^e with m = f/8192 and e = 0
/// where c = 0, else m = (4096 + f)/8192 and e = c − 1.
///
/// Range: any code; the number is 0 or from 2^−13 to 16 382, in the unit of whoever stores it.
#[inline(always)]
pub fn short_number<W: Word>(code: Fx<W, 0>) -> Block<W, 1> {
    let c = code.floor_shr(12);
    let f = code - c.shl(12);
    let m = f + Fx::select(c.is_zero(), Fx::zero(), Fx::lit(1 << 12));
    Block { m: [m.reread::<MANTISSA>().shl(MANTISSA - 13)], e: (c - Fx::lit(1)).max(Fx::zero()) }
}

/// `1 + x` of a number ≥ 0, rounded to `keep` fraction bits of its mantissa.
#[inline(always)]
pub fn one_plus<W: Word>(x: Block<W, 1>, keep: u32) -> Block<W, 1> {
    let top = x.e.max(Fx::zero());
    let unit = one::<W>().floor_shr_by(places_below(Fx::zero(), top, 63));
    let number: Wide<W, 60> = x.m[0].widen().floor_shr_by(places_below(x.e, top, 63));
    Block::of(unit + number, top, keep)
}

/// `log₂(1 + x)` of a number ≥ 0, as accurate for tiny x as for large ones: below 1 a table of the ratio to x.
///
/// Relative error: 2^−(p−0.9) + 2^−18.4 at every exponent. x = 0 gives 0.
#[inline(always)]
pub fn log2_one_plus<W: Word>(x: Block<W, 1>, p: &Precision) -> Block<W, 1> {
    let keep = p.fraction_bits;
    let place = x.m[0].floor_shr_by(places_below(x.e, Fx::zero(), 31));
    let place = place.saturate(Fx::zero(), Fx::lit((1 << MANTISSA) - 1));
    let index: Fx<W, 0> = place.floor_shr(MANTISSA - rom::LOG_BITS).reread();
    let within = place - index.reread::<MANTISSA>().shl(MANTISSA - rom::LOG_BITS);
    let fraction = within.shl(rom::LOG_BITS).keep(keep);
    let table = &rom::HALF_LOG2_ONE_PLUS_RATIO;
    let knot: Fx<W, 26> = Fx::from_raw(index.raw().lookup(table));
    let next: Fx<W, 26> = Fx::from_raw((index + Fx::lit(1)).raw().lookup(table));
    let fall = (knot - next).claim(0..=(1 << 17) - 1, "knots_of_log2_one_plus_fall_by_less_than_2_to_the_minus_9");
    let half_ratio: Mantissa<W> = (knot.widen::<56>() - fall.mul::<MANTISSA, 56>(fraction)).round_to(keep);
    let below_one = Block::of(x.m[0].mul::<MANTISSA, 60>(half_ratio), x.e + Fx::lit(1), keep);

    // Every bit of the sum addresses the table; log₂ keeps p of what is left.
    let sum = one_plus(x, MANTISSA);
    let from_one: Wide<W, 24> = sum.e.widen::<24>() + log2(sum.m[0], p).widen();
    Block::select(x.e.lt(Fx::lit(1)), below_one, Block::of(from_one, Fx::zero(), keep))
}
