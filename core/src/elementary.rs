//! Elementary functions of mantissas: reciprocal, inverse root, root, log₂, exp₂.
//!
//! Reciprocal and inverse root: a seed from a table, then Newton steps whose residual is taken exactly. log₂ and
//! exp₂: linear interpolation between 257 knots. Bounds, proven by exhausting the mantissa in
//! `host-tests/tests/elementary.rs` (p = kept fraction bits, k = seed bits, n = Newton steps):
//! 1/2x errs by at most 2^−(p+0.8) + 2^−(2^n·(k+0.7)), 1/2√x by 2^−p + ⅔·2^−(2^n·(k−0.76)), log₂ by 2^−18.4,
//! exp₂ by 2^−p + 2^−20 (relative).

use crate::block::{Block, Exponent, MANTISSA, Mantissa};
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
    let rise: Wide<W, 60> = rise.mul(fraction);
    let mantissa = (knot.widen::<60>() + rise).round_to(p.fraction_bits);
    Block { m: [mantissa], e: whole.reread::<0>() + Fx::lit(1) }
}
