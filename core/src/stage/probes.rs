//! Probes: footprint assembly along the major axis (Schilling, Knittel, Straßer 1996; W97, end of "Solution").
//!
//! The diameter of the assembled footprint is 2√3·λ, which gives a pixel box back its full width (errata 4, 5).
//! N = rule(λ₁/λ₂), at most `max_probes`; when capped, λ₂ is raised to λ₁/N: blurred, never aliased. Probe i lies
//! at (i − (N − 1)/2)·step, N·step the major diameter; LOD = log₂ of the minor diameter in texels of level 0.
//! Error: LOD 2^−(lod_bits + 1) from its own rounding; step 2^−(p−4), relative.

use crate::block::{Block, MANTISSA, Mantissa, Number, PRODUCT, normalise, number, of_control};
use crate::bundle::never;
use crate::each::each;
use crate::elementary::{LOGARITHM, half_reciprocal, log2};
use crate::fx::{Control, Fx, Int, Wide, WideControl};
use crate::ports::{LOD, OFFSET, POSITION, SHARE};
use crate::precision::{Precision, ProbeRule, ProbeWeights};
use crate::rom::{self, MAX_PROBES};
use crate::signals::{Axes, CountAndLevel, MapOffset, MapScale, Probes};
use crate::word::{Wire, Word};

/// Clamps λ₁ to 2 map units, a major diameter of 6.9: probes further out would all look along the same edge of the plane. Probe count and level of
/// detail keep the unclamped λ.
#[inline(always)]
fn cut<W: Word>(sigma: &Number<W>) -> (Number<W>, W::Flag) {
    let above = Fx::int(1).lt(sigma.e);
    let limit = Block { m: [Fx::int(1)], e: Fx::int(1) };
    (Block::select(above, limit, *sigma), above)
}

/// Scale of a cube face of `edge` texels, read as 1…16384: 2 map units across.
#[inline(always)]
pub fn face_scale<W: Word>(edge: Int<W>, p: &Precision) -> MapScale<W> {
    let edge = edge.saturate(Fx::int(1), Fx::int(16384));
    let block: Number<W> = of_control(number(edge.widen::<64>(), Fx::int(0), p.fraction_bits));
    let fraction = log2(block.m[0], p).to_control::<LOD>();
    let whole = (block.e - Fx::int(1)).to_control::<LOD>();
    MapScale { log2_texels: whole + fraction, last_level: Fx::int(31) - Fx::from_raw(edge.raw().leading_zeros()) }
}

/// Bits before the point of multiples of λ₂, up to 16 times a mantissa.
const MULTIPLE: u32 = PRODUCT + 2;

/// Probe count, step and level of detail.
#[inline(always)]
pub fn probes<W: Word>(axes: &Axes<W>, map: &MapScale<W>, p: &Precision) -> Probes<W> {
    let Axes { major, direction, .. } = axes;
    let Rule { count, capped, .. } = rule::<W>(axes, None, p);
    let (drawn, saturated) = cut(major);
    let lod = level_of_detail(axes, capped, Fx::entry(rom::LOG2_DIAMETER), map, p);
    Probes {
        count,
        step: step(&drawn, direction, count, p),
        lod: lod.saturate(Fx::zero(), map.last_level.to_control()).quantise(p.lod_bits),
        empty: major.is_zero(),
        saturated,
        capped,
    }
}

/// Probe count, and the level of detail before it is saturated. Each probe has a standard deviation of λ₂, and the probe centres have one of
/// `spread`·λ₁: N ≥ 1 + spread·λ₁/λ₂ − 1/16.
#[inline(always)]
pub fn count_and_level<W: Word>(
    axes: &Axes<W>,
    spread: Mantissa<W>,
    map: &MapScale<W>,
    p: &Precision,
) -> CountAndLevel<W> {
    let Rule { count, capped, beyond } = rule::<W>(axes, Some(spread), p);
    let level = level_of_detail(axes, capped, Fx::entry(rom::LOG2_TEXEL_ON_SPHERE), map, p);
    // Twice the part beyond the last count, over λ₂.
    let beyond = number(beyond, axes.major.e, p.fraction_bits);
    let quotient = beyond.m[0].mul::<MANTISSA, PRODUCT>(half_reciprocal(axes.minor.m[0], p));
    let e = (beyond.e - axes.minor.e).saturate(Fx::int(-64), Fx::int(0)) + Fx::int(2);
    let share: Wide<W, { PRODUCT + 2 }> = quotient.at_exponent(e);
    let share = share.max(Fx::zero()).min(Fx::int(1)).round_to_control(16);
    let whole = match p.probe_rule {
        ProbeRule::Ceiling => capped,
        ProbeRule::PowerOfTwo => !never::<W>(),
    };
    let share = Fx::select(whole, Fx::int(1), share);
    CountAndLevel { count, share, level, capped, empty: axes.major.is_zero() }
}

/// Part of a texel of level 0 that a probe spans across: 2λ₂ if it is below 1, on a map of 2^`log2_unit` texels in a map unit. Error: 2^−17, and
/// 2^−(p−4) of the λ₁ on a square map of the longer edge, for both derivatives of a column share their last place.
#[inline(always)]
pub fn reach<W: Word>(
    [major, minor]: [&Number<W>; 2],
    probes: &Probes<W>,
    log2_unit: Int<W>,
    p: &Precision,
) -> Control<W, SHARE> {
    let sigma = Block::select(probes.capped, *major, *minor);
    // 2√3/N of what N probes share, over √3.
    let count = Fx::select(probes.capped, probes.count, Fx::int(1));
    let per_sigma: Fx<W, OFFSET> = Fx::lookup(count, &rom::STEP_PER_SIGMA);
    let diameter: Wide<W, { OFFSET + MANTISSA }> = per_sigma.quantise(p.offset_bits()).mul(sigma.m[0]);
    let diameter = number(diameter, sigma.e + log2_unit, p.fraction_bits);
    let width = diameter.m[0].mul::<MANTISSA, PRODUCT>(Fx::entry(rom::INVERSE_ROOT_THREE).quantise(p.fraction_bits));
    // With an exponent above 2 it is above 1.
    let reach: Wide<W, { PRODUCT + 2 }> = width.at_exponent(diameter.e.min(Fx::int(2)));
    reach.max(Fx::zero()).min(Fx::int(1)).round_to_control(16)
}

/// Outcome of the rule for the probe count.
struct Rule<W: Word> {
    count: Int<W>,
    /// The rule asks for more probes than the profile has.
    capped: W::Flag,
    /// Excess of the threshold over the value for which one probe less suffices, at the exponent of λ₁.
    beyond: Wide<W, MULTIPLE>,
}

/// N ≥ λ₁/λ₂ or, if centres spread, N ≥ 1 + spread·λ₁/λ₂ − 1/16.
#[inline(always)]
fn rule<W: Word>(axes: &Axes<W>, spread: Option<Mantissa<W>>, p: &Precision) -> Rule<W> {
    let Axes { major, minor, .. } = axes;
    // N ≥ λ₁/λ₂ by comparison with multiples of λ₂. The slack is the noise of the two λ: without it every circle
    // would take two probes.
    let places = (major.e - minor.e).saturate(Fx::int(0), Fx::int((<W::Wide as Wire>::BITS - 2).into()));
    let [major_wide, minor_wide] =
        each!(sigma in [major, minor] => sigma.m[0].widen::<PRODUCT>().reread::<MULTIPLE>().floor_shr(2));
    let minor_at_major = minor_wide.floor_shr_by(places);
    // Number of probes besides those that the multiples count.
    let (threshold, more) = match spread {
        None => (major_wide - major_wide.floor_shr(p.fraction_bits - 4), 0),
        Some(spread) => {
            let reach = major.m[0].mul::<MANTISSA, PRODUCT>(spread).reread::<MULTIPLE>().floor_shr(2);
            (reach - minor_at_major.floor_shr(4), 1)
        }
    };
    let round = if more == 0 { !minor_at_major.lt(threshold) } else { !Fx::zero().lt(threshold) };
    let (count, capped, beyond) = W::unless(
        round,
        (Fx::int(1), never::<W>(), Fx::zero()),
        #[inline(always)]
        || count::<W>(minor_at_major, threshold, more, p),
    );
    Rule { count, capped, beyond }
}

/// Least N for which N − `more` times λ₂ reaches the threshold; whether it is more than the profile has; and how far the threshold is above the multiple
/// before it. A backend that does not branch comes here with any threshold.
#[inline(always)]
fn count<W: Word>(
    minor: Wide<W, MULTIPLE>,
    threshold: Wide<W, MULTIPLE>,
    more: u32,
    p: &Precision,
) -> (Int<W>, W::Flag, Wide<W, MULTIPLE>) {
    match p.probe_rule {
        ProbeRule::Ceiling => {
            // Fewest probes of a threshold above 0, and how many more there may be. A threshold that is not above 0 has one.
            let fewest = (1 + more).min(p.max_probes);
            let first = if more == 0 {
                Fx::int(1)
            } else {
                Fx::select(Fx::zero().lt(threshold), Fx::int(fewest.into()), Fx::int(1))
            };
            let (mut count, mut beyond) = (first, threshold);
            let mut left = p.max_probes - fewest;
            // Half of what is left at a time: largest multiple of λ₂ below the rest.
            for _ in 0..=MAX_PROBES.ilog2() {
                let taken = (left + 1) >> 1;
                let multiple = multiple::<W>(minor, taken);
                let wider = if taken == 0 { never::<W>() } else { multiple.lt(beyond) };
                count = Fx::select(wider, count + Fx::int(taken.into()), count);
                beyond = Fx::select(wider, beyond - multiple, beyond);
                left -= taken;
            }
            (count, multiple::<W>(minor, p.max_probes - more).lt(threshold), beyond)
        }
        ProbeRule::PowerOfTwo => {
            let mut count = Fx::int(1);
            let doublings = most_probes(p).ilog2();
            for doubling in 0..doublings {
                let wider = multiple::<W>(minor, (1 << doubling) - more).lt(threshold);
                count = Fx::select(wider, Fx::int(2 << doubling), count);
            }
            (count, multiple::<W>(minor, (1 << doublings) - more).lt(threshold), threshold)
        }
    }
}

/// Multiple n of λ₂, n ≤ 16, from the digits 1, 0 and −1 of n.
#[inline(always)]
fn multiple<W: Word>(minor: Wide<W, MULTIPLE>, n: u32) -> Wide<W, MULTIPLE> {
    let mut sum = Fx::zero();
    let mut rest = n;
    for place in 0..=MAX_PROBES.ilog2() {
        if rest & 3 == 3 {
            sum = sum - minor.shl(place);
            rest += 1;
        } else if rest & 1 == 1 {
            sum = sum + minor.shl(place);
        }
        rest >>= 1;
    }
    sum
}

/// Probe count of every capped footprint.
#[inline(always)]
fn most_probes(p: &Precision) -> u32 {
    match p.probe_rule {
        ProbeRule::Ceiling => p.max_probes,
        ProbeRule::PowerOfTwo => 1 << p.max_probes.max(1).ilog2(),
    }
}

/// 2√3·λ₁/N along the direction.
#[inline(always)]
fn step<W: Word>(
    major: &Number<W>,
    direction: &[Mantissa<W>; 2],
    count: Int<W>,
    p: &Precision,
) -> [Control<W, POSITION>; 2] {
    let fraction_bits = p.fraction_bits;
    let per_sigma: Fx<W, OFFSET> = Fx::lookup(count, &rom::STEP_PER_SIGMA);
    let length: Wide<W, { OFFSET + MANTISSA }> = per_sigma.quantise(p.offset_bits()).mul(major.m[0]);
    let length = number(length, major.e, fraction_bits);
    // λ₁ ≤ 2 and 2√3/N < 4: the exponent of the step is at most 3, and 4 fits a position.
    let product = normalise(each!(d in *direction => d.mul::<MANTISSA, PRODUCT>(length.m[0])), length.e, fraction_bits);
    each!(m in product.m => {
        let at_eight: Wide<W, { PRODUCT + 3 }> = m.widen::<PRODUCT>().at_exponent(product.e);
        at_eight.claim(-7, 7, 0, "a_step_is_below_seven_map_units").round_to_control(28)
    })
}

/// log₂ of λ₂ in texels or, if it is raised, of λ₁ over the most probes.
#[inline(always)]
fn level_of_detail<W: Word>(
    axes: &Axes<W>,
    raised: W::Flag,
    log2_diameter: Control<W, LOD>,
    map: &MapScale<W>,
    p: &Precision,
) -> Control<W, LOD> {
    let sigma = Block::select(raised, axes.major, axes.minor);
    // ±2^13 levels are beyond every map; the saturated exponent fits next to 16 fraction bits.
    let whole = sigma.e.saturate(Fx::int(-(1 << 13)), Fx::int(1 << 13)).to_control::<LOD>();
    let fraction: Control<W, LOGARITHM> = log2(sigma.m[0], p);
    let diameter = whole + fraction.to_control() + log2_diameter + map.log2_texels;
    let divided = rom::LOG2_OF_COUNT.get(most_probes(p) as usize).copied().unwrap_or(0);
    diameter - Fx::select(raised, Fx::entry(divided), Fx::zero())
}

/// Place of probe `index` relative to the centre of the footprint: (2·index − N + 1)·step/2. |·| ≤ 3.5 units.
#[inline(always)]
pub fn position<W: Word>(probes: &Probes<W>, index: Int<W>) -> MapOffset<W> {
    let odd = index.shl(1) - probes.count + Fx::int(1);
    let offset = each!(step in probes.step => {
        let twice: WideControl<W, { POSITION + 31 }> = step.mul::<32, { POSITION + 32 }>(odd).reread();
        twice.claim(-7, 7, -1, "probes_stay_on_the_major_axis").round_to(28)
    });
    MapOffset { offset }
}

/// Weight of probe `index` in 2^−16 units; the weights of one footprint sum to exactly 2^16.
#[inline(always)]
pub fn weight<W: Word>(probes: &Probes<W>, index: Int<W>, p: &Precision) -> Control<W, SHARE> {
    let table = match p.probe_weights {
        ProbeWeights::Box => &rom::BOX_WEIGHTS,
        ProbeWeights::Gaussian => &rom::GAUSSIAN_WEIGHTS,
    };
    let row = (probes.count - Fx::int(1)).shl(4);
    Fx::lookup(row + index, table)
}
