//! Elementary functions of mantissas: reciprocal, inverse root, root, log₂, exp₂, log₂(1 + x), powers of a cosine.
//!
//! Reciprocal and inverse root: a seed from a table, then Newton steps with an exact residual. log₂ and exp₂: linear interpolation between 257 knots.
//!
//! Bounds, proven by exhausting the mantissa in `host-tests/tests/datapath/elementary.rs` (p = kept fraction bits, k = seed bits, n = Newton steps):
//! - 1/2x errs by at most 2^−(p+0.8) + 2^−(2^n·(k+0.7)).
//! - 1/2√x errs by at most 2^−p + ⅔·2^−(2^n·(k−0.76)).
//! - log₂ errs by at most 2^−18.4.
//! - exp₂ errs by at most 2^−p + 2^−20.
//! - log₂(1 + x) errs by at most 2^−(p−0.9) + 2^−18.4, relative.
//!
//! On 16-bit words tables and logarithms are counts. 1/2x and 1/2√x keep their bounds. log₂ errs by 2^−18 and exp₂ by 2^−p + 2^−18. log₂(1 + x) errs
//! by 2^−(p−1.5) below x = 1 and by 2^−(p−2) from there on, relative. `host-tests/exhaustive/elementary.rs` proves these the same way, and those of
//! 8-bit words.

use crate::block::{Block, MANTISSA, Mantissa, Number, PRODUCT, Product, dot, number, of_control, places_below};
use crate::each::each;
use crate::fx::{Control, Fx, Int, Wide};
use crate::precision::{Newton, Precision};
use crate::rom;
use crate::word::{Wire, Word};

/// Bits before the point of a logarithm: I8, ±64 and one spare bit for the sign.
pub const LOGARITHM: u32 = 8;

/// One Newton correction `y + y·residual·2^−extra`. The residual is below 2^−(k − 3), so it is scaled up by `2^scale` before it is rounded to a
/// multiplier operand.
#[inline(always)]
fn correct<W: Word>(y: Mantissa<W>, residual: Product<W>, scale: u32, extra: u32, fraction_bits: u32) -> Mantissa<W> {
    let operand: Mantissa<W> = residual.shl(scale).round_to(fraction_bits);
    let correction: Product<W> = y.mul(operand);
    (y.widen() + correction.floor_shr(scale + extra)).round_to(fraction_bits)
}

/// Scale of the residual after one more step: no finer than a mantissa.
#[inline(always)]
fn next_scale<W: Word>(scale: u32) -> u32 {
    (2 * scale).min(Mantissa::<W>::FRACTION - 2)
}

/// Index of `x` in a seed table whose first interval starts at 2^`low`; each interval is 2^−`bits` wide.
#[inline(always)]
fn seed_index<W: Word>(x: Mantissa<W>, low: i32, bits: u32, last: i64) -> Int<W> {
    (x - Fx::number(1, low)).index(bits).saturate(Fx::int(0), Fx::int(last))
}

/// `1/(2x)` for x in [½, 1], in [½, 1]. x = 0 gives 1, or the first seed if there is no Newton step; a caller multiplies it by zero.
#[inline(always)]
pub fn half_reciprocal<W: Word>(x: Mantissa<W>, p: &Precision) -> Mantissa<W> {
    let Newton { seed_bits, steps } = p.reciprocal;
    // [½, 1) holds 2^seed_bits intervals of width 2^−(seed_bits + 1).
    let index = seed_index(x, -1, seed_bits + 1, (1 << seed_bits) - 1);
    let mut y = Fx::lookup(index, rom::reciprocal(seed_bits));
    let mut scale = seed_bits - 3;
    for _ in 0..steps {
        let product: Product<W> = x.mul(y);
        // Outside [½, 1] (x = 0) the residual would leave its range; saturation keeps the block total.
        let limit = Product::<W>::int(1).floor_shr(scale);
        let residual = (Product::<W>::int(1) - product.shl(1)).saturate(-limit, limit);
        y = correct(y, residual, scale, 0, p.fraction_bits);
        scale = next_scale::<W>(scale);
    }
    y.min(Fx::int(1))
}

/// `1/√x` of a number `x.m · 2^x.e` ≥ 0, as a block. x = 0 gives some number (a caller multiplies it by zero).
#[inline(always)]
pub fn inverse_root<W: Word>(x: Number<W>, p: &Precision) -> Number<W> {
    let (even, half_exponent) = even_exponent(x, p.fraction_bits);
    let y = half_inverse_root(even, p);
    // 1/√(m·2^(2h)) = 2·y·2^−h.
    Block { m: [y], e: Fx::int(1) - half_exponent }
}

/// `1/(2√x)` for x in [¼, 1], in [½, 1].
#[inline(always)]
pub fn half_inverse_root<W: Word>(x: Mantissa<W>, p: &Precision) -> Mantissa<W> {
    let Newton { seed_bits, steps } = p.inverse_root;
    let index = seed_index(x, -2, seed_bits, (3 << (seed_bits - 2)) - 1);
    let mut y: Mantissa<W> = Fx::lookup(index, rom::inverse_root(seed_bits));
    let mut scale = seed_bits - 3;
    for _ in 0..steps {
        let square: Mantissa<W> = y.mul::<MANTISSA, PRODUCT>(y).round_to(p.fraction_bits);
        let product: Product<W> = x.mul(square);
        let limit = Product::<W>::int(1).floor_shr(scale);
        let residual = (Product::<W>::int(1) - product.shl(2)).saturate(-limit, limit);
        y = correct(y, residual, scale, 1, p.fraction_bits);
        scale = next_scale::<W>(scale);
    }
    y.min(Fx::int(1))
}

/// A number ≥ 0 as x in [¼, 1] and h with value x · 4^h.
#[inline(always)]
fn even_exponent<W: Word>(x: Number<W>, fraction_bits: u32) -> (Mantissa<W>, Int<W>) {
    let odd = x.e - x.e.floor_shr(1).shl(1);
    (x.m[0].round_shr_by(odd, fraction_bits), (x.e + odd).floor_shr(1))
}

/// `√x` and `1/√x` of a number ≥ 0, from one inverse root.
#[inline(always)]
pub fn root_and_inverse<W: Word>(x: Number<W>, p: &Precision) -> (Number<W>, Number<W>) {
    let inverse = inverse_root(x, p);
    (x.times(&inverse, p.fraction_bits), inverse)
}

/// Bits before the point of a component over its length: |w| ≥ ½ for the largest of its mantissas, so 1/|w| is at most 2².
const UNIT: u32 = PRODUCT + 2;

/// Components of a vector over its length. Only the length of the mantissas counts. A component exceeds 1 by the error of the inverse root at most,
/// so a caller saturates. A zero vector stays zero.
#[inline(always)]
pub fn over_length<W: Word, const N: usize>(a: &Block<W, N>, p: &Precision) -> [Mantissa<W>; N] {
    let inverse = inverse_root(number(dot(&a.m, &a.m), Fx::int(0), p.fraction_bits), p);
    each!(m in a.m => {
        let unit: Wide<W, UNIT> = m.mul::<MANTISSA, PRODUCT>(inverse.m[0]).at_exponent(inverse.e);
        unit.claim(-17, 17, -4, "a_component_over_its_length_is_near_one_at_most").round_to(p.fraction_bits)
    })
}

/// `difference · fraction` between neighbouring knots of a table, which are counts. Range: difference in [0, 2^`e`], fraction in [0, 1].
///
/// A narrow word holds the difference alone: its leading zeros are shifted out before the product and in again after it.
#[inline(always)]
fn between<W: Word, const INT: u32, const OUT: u32>(
    difference: Control<W, INT>,
    e: i32,
    fraction: Mantissa<W>,
) -> Wide<W, OUT> {
    let places = if W::BITS < W::Count::BITS { INT - 2 + e.unsigned_abs() } else { 0 };
    let operand: Fx<W, INT> = Fx::of_control(difference.shl(places));
    operand.mul::<MANTISSA, OUT>(fraction).floor_shr(places)
}

/// Share of the interval after its knot that a number covers, in [0, 1), for 2^`places` intervals a unit. It is 0 on words without a bit below these
/// places.
#[inline(always)]
fn share_of_interval<W: Word, const INT: u32>(within: Fx<W, INT>, places: u32, fraction_bits: u32) -> Mantissa<W> {
    if Fx::<W, INT>::FRACTION < places {
        return Fx::zero();
    }
    within.reread::<MANTISSA>().shl(INT - MANTISSA + places).quantise(fraction_bits)
}

/// `log₂ m` for a mantissa m in [½, 1], in [−1, 0], 24 fraction bits. m below ½ reads as ½.
#[inline(always)]
pub fn log2<W: Word>(m: Mantissa<W>, p: &Precision) -> Control<W, LOGARITHM> {
    // m = (1 + (i + f)/256)/2.
    let above = (m - Fx::number(1, -1)).saturate(Fx::int(0), Fx::number(1, -1) - Fx::lit(1));
    let index = above.index(rom::LOG_BITS + 1);
    let within = above - Fx::of_index(index, rom::LOG_BITS + 1);
    let fraction = share_of_interval(within, rom::LOG_BITS + 1, p.fraction_bits);
    let knot: Control<W, LOGARITHM> = Fx::lookup(index, &rom::LOG2);
    let next: Control<W, LOGARITHM> = Fx::lookup(index + Fx::int(1), &rom::LOG2);
    let rise = (next - knot).claim_below(-7, "knots_of_log2_rise_by_less_than_2_to_the_minus_7");
    let rise: Wide<W, { LOGARITHM + MANTISSA }> = between(rise, -7, fraction);
    let value: Control<W, LOGARITHM> = (Fx::wide_of_control(knot) + rise).round_to_control(24);
    // 1 itself lies one bit of the kept fraction beyond the last interval: log₂ 1 = 0 exactly.
    let whole = !m.lt(Fx::int(1));
    Fx::select(whole, Fx::zero(), value - Fx::int(1))
}

/// `2^x` for any |x| < 64, as a block.
#[inline(always)]
pub fn exp2<W: Word>(x: Control<W, LOGARITHM>, p: &Precision) -> Number<W> {
    let whole = x.index(0);
    let within = x - Fx::of_index(whole, 0);
    let index = within.index(rom::LOG_BITS);
    let step = within - Fx::of_index(index, rom::LOG_BITS);
    let fraction = step.reread::<MANTISSA>().shl(LOGARITHM - MANTISSA + rom::LOG_BITS).quantise(p.fraction_bits);
    let knot: Control<W, MANTISSA> = Fx::lookup(index, &rom::EXP2);
    let next: Control<W, MANTISSA> = Fx::lookup(index + Fx::int(1), &rom::EXP2);
    let rise = (next - knot).claim_below(-8, "knots_of_exp2_rise_by_less_than_2_to_the_minus_8");
    // 24 fraction bits of a rise fit an 18-bit operand; the rest would be 2^−25.
    let rise: Product<W> = between(rise.quantise(24), -8, Mantissa::<W>::of_control(fraction));
    let mantissa = (Product::<W>::wide_of_control(knot) + rise).round_to(p.fraction_bits);
    Block { m: [mantissa], e: whole + Fx::int(1) }
}

/// Bits before the point of y = 1 − cos. A square of mantissas is twice y.
pub const VERSINE: u32 = PRODUCT - 1;

/// Bits before the point of the tabulated ratios of log₂(1 ± x) to x.
const RATIO: u32 = 6;

/// `−log₂(1 − y)` for y in [0, 1], relative error 2^−(p−1.4) + 2^−19.4. The value is 64 for 1 − y of 2^−63 or less, y above 1 included.
///
/// Below ½ it is y times a tabulated ratio, so a tiny y keeps its accuracy; above, it is the logarithm of 1 − y.
#[inline(always)]
pub fn minus_log2_one_minus<W: Word>(y: Wide<W, VERSINE>, p: &Precision) -> Number<W> {
    let fraction_bits = p.fraction_bits;
    let (one, half): (Wide<W, VERSINE>, Wide<W, VERSINE>) = (Fx::int(1), Fx::number(1, -1));
    let scaled = number(y, Fx::int(0), fraction_bits);
    let below_half = y.saturate(Fx::zero(), half - Fx::lit(1)).floor_shr(W::BITS - (VERSINE - MANTISSA));
    let below_half: Mantissa<W> = Fx::from_raw(W::narrow(below_half.raw()));
    let index = below_half.index(rom::LOG_BITS + 1);
    let within = below_half - Fx::of_index(index, rom::LOG_BITS + 1);
    let fraction = share_of_interval(within, rom::LOG_BITS + 1, fraction_bits);
    let knot: Control<W, RATIO> = Fx::lookup(index, &rom::HALF_LOG2_ONE_MINUS_RATIO);
    let next: Control<W, RATIO> = Fx::lookup(index + Fx::int(1), &rom::HALF_LOG2_ONE_MINUS_RATIO);
    let rise = (next - knot).claim_below(-9, "knots_of_log2_one_minus_rise_by_less_than_2_to_the_minus_9");
    let rise: Wide<W, { RATIO + MANTISSA }> = between(rise, -9, fraction);
    let half_ratio: Mantissa<W> = (Fx::wide_of_control(knot) + rise).round_to(fraction_bits);
    let near: Product<W> = scaled.m[0].mul(half_ratio);

    let rest = number((one - y).max(Fx::zero()), Fx::int(0), fraction_bits);
    let log = log2(rest.m[0], p) + Fx::of_index(rest.e.saturate(Fx::int(-63), Fx::int(0)), 0);
    // At most 64: 2^12 above the binary point of a product leaves it in [−1, 1].
    let far: Product<W> = Wide::<W, { PRODUCT + 12 }>::wide_of_control(-log).reread();

    let is_far = y.ge(half);
    number(Fx::select(is_far, far, near), Fx::select(is_far, Fx::int(12), scaled.e + Fx::int(1)), fraction_bits)
}

/// `cosⁿ` = 2^(n·log₂(1 − y)) of y = 1 − cos ≥ 0 and n = n.m·2^n.e, n.e in 0…14. It is 0 if y ≥ 1 and 1 if y = 0.
///
/// n.m need not be normalised if n.e = 0. Error, absolute: 2^−(p−0.3) + 2^−20 for every n up to 2^13, plus that of y (n times it, relative). A power
/// below 2^−63 is 2^−63.
#[inline(always)]
pub fn cosine_power<W: Word>(y: Wide<W, VERSINE>, n: Number<W>, p: &Precision) -> Number<W> {
    let log = minus_log2_one_minus(y, p);
    let product: Product<W> = log.m[0].mul(n.m[0]);
    let e = log.e + n.e;
    // n.m ≥ ½ if n.e > 0, and log.m ≥ ½: with an exponent above 6 the product is at least 32.
    let at_64: Wide<W, { PRODUCT + 6 }> = product.at_exponent(e);
    let last: Control<W, LOGARITHM> = Fx::int(63);
    let x = Fx::select(Fx::int(6).lt(e), last, at_64.round_to_control::<LOGARITHM>(24).min(last));
    Block::select(y.ge(Fx::int(1)), Block::zero(), exp2(-x, p))
}

/// Stored 16-bit number, exponent c in the upper 4 bits, fraction f in the lower 12: m·2^e with m = f/8192 and e = 0 if c = 0, else m = (4096 +
/// f)/8192 and e = c − 1.
///
/// Range: any code; the number is 0 or from 2^−13 to 16 382, in the unit of the field that stores it.
#[inline(always)]
pub fn short_number<W: Word>(code: Int<W>) -> Number<W> {
    let c = code.floor_shr(12);
    let f = code - c.shl(12);
    let m = f + Fx::select(c.is_zero(), Fx::zero(), Fx::int(1 << 12));
    Block { m: [Fx::of_index(m, 13)], e: (c - Fx::int(1)).max(Fx::int(0)) }
}

/// `1 + x` of a number ≥ 0, rounded to `fraction_bits` fraction bits of its mantissa.
#[inline(always)]
pub fn one_plus<W: Word>(x: Number<W>, fraction_bits: u32) -> Number<W> {
    let top = x.e.max(Fx::int(0));
    let most = <W::Wide as Wire>::BITS - 1;
    let unit = Product::<W>::int(1).floor_shr_by(places_below(Fx::int(0), top, most));
    let sum = unit + x.m[0].widen().floor_shr_by(places_below(x.e, top, most));
    number(sum, top, fraction_bits)
}

/// `log₂(1 + x)` of a number ≥ 0, as accurate for tiny x as for large ones: below 1 it comes from a table of its ratio to x.
///
/// Relative error: 2^−(p−0.9) + 2^−18.4 at every exponent. x = 0 gives 0.
#[inline(always)]
pub fn log2_one_plus<W: Word>(x: Number<W>, p: &Precision) -> Number<W> {
    let fraction_bits = p.fraction_bits;
    let place = x.m[0].floor_shr_by(places_below(x.e, Fx::int(0), W::BITS - 1));
    let place = place.saturate(Fx::zero(), Fx::below(1));
    let index = place.index(rom::LOG_BITS);
    let within = place - Fx::of_index(index, rom::LOG_BITS);
    let fraction = share_of_interval(within, rom::LOG_BITS, fraction_bits);
    let table = &rom::HALF_LOG2_ONE_PLUS_RATIO;
    let knot: Control<W, RATIO> = Fx::lookup(index, table);
    let next: Control<W, RATIO> = Fx::lookup(index + Fx::int(1), table);
    let fall = (knot - next).claim_below(-9, "knots_of_log2_one_plus_fall_by_less_than_2_to_the_minus_9");
    let fall: Wide<W, { RATIO + MANTISSA }> = between(fall, -9, fraction);
    let half_ratio: Mantissa<W> = (Fx::wide_of_control(knot) - fall).round_to(fraction_bits);
    let below_one = number(x.m[0].mul::<MANTISSA, PRODUCT>(half_ratio), x.e + Fx::int(1), fraction_bits);

    // Every bit of the sum addresses the table; log₂ keeps p bits of the rest.
    let sum = one_plus(x, Mantissa::<W>::FRACTION);
    // Any exponent with 24 fraction bits needs a wide wire.
    let from_one = sum.e.widen::<40>() + log2(sum.m[0], p).widen();
    let from_one = of_control(number(from_one, Fx::int(0), fraction_bits));
    Block::select(x.e.lt(Fx::int(1)), below_one, from_one)
}
