//! Sweep: probes are normals. A normal moves along the major axis of the lobe, and each of its places is reflected exactly. Footprint assembly
//! instead steps over the plane of a cube face, which cannot hold a lobe of tens of degrees.
//!
//! With columns q_j of dr_j and dn_j, unit deviations all, and e₁ the direction of λ₁: w_j = ⟨q_j·e₁⟩/λ₁ is the mean movement of column j per
//! deviation along e₁, Σw² = 1. At x deviations n has moved by x·a, a = Σ w_j·dn_j, and r by x·Σ w_j·dr_j + x²·(2a⟨v·a⟩ − v|a|²), for r is a
//! polynomial of degree two in n.
//!
//! Probes of deviation λ₂ stand for λ₁ if their centres have the deviation √(λ₁² − λ₂²). It is zero for a round lobe, so the direction of an axis
//! that does not exist decides nothing. If λ₂ was raised to λ₁/N, the raised value is used. A new probe begins at the places of those before it: in
//! the middle, with no weight or as half of the probe that stood there. No count therefore makes a jump.
//!
//! The extent of the probes moves the mean of their reflections, too: it is r + 2Cv − v·tr C. Parts of equal weight are wider far out. Probes there
//! have coarser levels; otherwise the tails of a lobe would be spots with gaps between them. A texel at (s, t) has the size of a texel in the middle
//! of its face, divided by ρ³, ρ² = 1 + s² + t²: LOD = LOD₀ + log₂(|r₀|/|r|) + 1.5·log₂ρ.
//!
//! Errors of the mean of the probes and of their level, for each profile: `host-tests/tests/datapath/sphere.rs`.

use crate::block::{Block, MANTISSA, Mantissa, PRODUCT, Product, align, dot, normalise, number, places_below};
use crate::each::each;
use crate::elementary::{LOGARITHM, half_reciprocal, log2, one_plus, over_length, root_and_inverse};
use crate::fx::{Control, Fx, Int, Wide, WideControl};
use crate::ports::{LOD, OFFSET, SHARE};
use crate::precision::Precision;
use crate::rom::{self, SweepTable};
use crate::signals::{Axes, CountAndLevel, Sweep};
use crate::word::Word;

/// Standard deviations that each column moves per unit of the sweep, |·| ≤ 1; the first two are those of a pixel's box.
#[inline(always)]
pub fn shares<W: Word, const COLUMNS: usize>(
    columns: [Block<W, 2>; COLUMNS],
    axes: &Axes<W>,
    (spread, count): (Mantissa<W>, Int<W>),
    p: &Precision,
) -> [Mantissa<W>; COLUMNS] {
    let fraction_bits = p.fraction_bits;
    let (q, _) = align(columns, fraction_bits);
    let along = normalise(each!(q in q => dot(&q, &axes.direction)), Fx::int(0), fraction_bits);
    // Spread with which so many probes reach λ₁ if λ₂ is raised; a single probe does not spread.
    let spread = spread.min(Fx::lookup(count, &rom::SPREAD_LIMIT).quantise(fraction_bits));
    let mut shares = each!(w in over_length(&along, p) => w.mul::<MANTISSA, PRODUCT>(spread).round_to(fraction_bits));
    let sigma = Fx::entry(rom::BOX_SIGMA).quantise(fraction_bits);
    for share in &mut shares[..2] {
        *share = share.mul::<MANTISSA, PRODUCT>(sigma).round_to(fraction_bits);
    }
    shares
}

/// √(1 − λ₂²/λ₁²).
#[inline(always)]
pub fn spread<W: Word>(axes: &Axes<W>, p: &Precision) -> Mantissa<W> {
    let fraction_bits = p.fraction_bits;
    let major = axes.major.m[0];
    let places = places_below(axes.minor.e, axes.major.e, W::BITS - 1);
    let minor: Mantissa<W> = axes.minor.m[0].round_shr_by(places, fraction_bits);
    let difference: Product<W> = major.mul(major) - minor.mul(minor);
    let (root, _) = root_and_inverse(number(difference.max(Fx::zero()), Fx::int(0), fraction_bits), p);
    let quotient: Wide<W, { PRODUCT + 2 }> =
        root.m[0].mul::<MANTISSA, PRODUCT>(half_reciprocal(major, p)).at_exponent(root.e + Fx::int(1));
    quotient.max(Fx::zero()).min(Fx::int(1)).round_to(fraction_bits)
}

/// Columns, each weighted by its share.
#[inline(always)]
pub fn mixed<W: Word, const COLUMNS: usize>(
    shares: &[Mantissa<W>; COLUMNS],
    columns: &[Block<W, 3>; COLUMNS],
    p: &Precision,
) -> Block<W, 3> {
    let (columns, e) = align(*columns, p.fraction_bits);
    let sum = each!(i in [0, 1, 2] => {
        let mut sum: Product<W> = Fx::zero();
        for (share, column) in shares.iter().zip(&columns) {
            sum = sum + share.mul(column[i]);
        }
        sum
    });
    normalise(sum, e, p.fraction_bits)
}

/// Distance of the mean of the reflections from r: 2Cv − v·tr C with the covariance C = Σ dn_j dn_jᵀ, exact, for r is a polynomial of degree two. The
/// turns are standard deviations.
#[inline(always)]
pub fn mean_shift<W: Word, const COLUMNS: usize>(
    turns: [Block<W, 3>; COLUMNS],
    view: &Block<W, 3>,
    p: &Precision,
) -> Block<W, 3> {
    let fraction_bits = p.fraction_bits;
    let (turns, e) = align(turns, fraction_bits);
    let sums = each!((i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] => {
        let mut sum: Product<W> = Fx::zero();
        for turn in &turns {
            sum = sum + turn[i].mul(turn[j]);
        }
        sum
    });
    let covariance = normalise(sums, e + e, fraction_bits);
    let [xx, xy, xz, yy, yz, zz] = covariance.m;
    let half_trace: Mantissa<W> =
        (xx.widen::<PRODUCT>() + yy.widen() + zz.widen()).floor_shr(1).round_to(fraction_bits);
    // Half of it: at most 3 + 1½.
    let half = each!((i, row) in [(0, [xx, xy, xz]), (1, [xy, yy, yz]), (2, [xz, yz, zz])] => {
        let turned: Product<W> = dot(&row, &view.m);
        turned - view.m[i].mul(half_trace)
    });
    normalise(half, covariance.e + view.e + Fx::int(1), fraction_bits)
}

/// r, moved by the part of the mean that the probes, which are points of the major axis, leave out: the whole mean less the mean of their own bend.
/// It is over 1 + λ₂², for directions have length 1 and the reflections of a wide lobe do not.
#[inline(always)]
pub fn centre<W: Word>(
    r: &Block<W, 3>,
    [shift, second]: [&Block<W, 3>; 2],
    axes: &Axes<W>,
    p: &Precision,
) -> Block<W, 3> {
    let fraction_bits = p.fraction_bits;
    let minor = axes.minor.square_length(fraction_bits);
    let divisor = one_plus(minor, fraction_bits);
    let damping = Block { m: [half_reciprocal(divisor.m[0], p)], e: Fx::int(1) - divisor.e };
    let rest = difference(shift, second, p).times(&damping, fraction_bits);
    let ([r, rest], e) = align([*r, rest], fraction_bits);
    normalise(
        each!((r, rest) in [(r[0], rest[0]), (r[1], rest[1]), (r[2], rest[2])] => r.widen::<PRODUCT>() + rest.widen()),
        e,
        fraction_bits,
    )
}

#[inline(always)]
fn difference<W: Word>(a: &Block<W, 3>, b: &Block<W, 3>, p: &Precision) -> Block<W, 3> {
    let ([a, b], e) = align([*a, *b], p.fraction_bits);
    let difference = each!((a, b) in [(a[0], b[0]), (a[1], b[1]), (a[2], b[2])] => a.widen::<PRODUCT>() - b.widen());
    normalise(difference, e, p.fraction_bits)
}

/// r, the moved r, its first derivative and its bend as one sweep.
#[inline(always)]
pub fn sweep<W: Word>(
    r: &Block<W, 3>,
    [centre, first, second]: [&Block<W, 3>; 3],
    probes: &CountAndLevel<W>,
    p: &Precision,
) -> Sweep<W> {
    let length = half_log2(&number(dot(&r.m, &r.m), Fx::int(0), p.fraction_bits), p);
    let (aligned, top) = align([*centre, *first, *second], p.fraction_bits);
    // ±2^13 as in the level itself; beyond it r has left the sweep.
    let places = (top - r.e).saturate(Fx::int(-(1 << 13)), Fx::int(1 << 13)).to_control::<LOD>();
    Sweep {
        centre: aligned[0],
        first: aligned[1],
        second: aligned[2],
        count: probes.count,
        share: probes.share,
        level: probes.level + length - places,
    }
}

/// ½·log₂ of a number.
#[inline(always)]
fn half_log2<W: Word>(x: &Block<W, 1>, p: &Precision) -> Control<W, LOD> {
    // From products of mantissas: |e| ≤ 64; that of zero counts as −64.
    let whole = x.e.saturate(Fx::int(-64), Fx::int(64)).to_control::<LOD>();
    let fraction: Control<W, LOGARITHM> = log2(x.m[0], p);
    (whole + fraction.to_control()).floor_shr(1)
}

/// Entry for probe `index` between two tables, of one probe less and of all probes, by the share of the way it has gone.
#[inline(always)]
fn on_its_way<W: Word, const F: u32, const WIDE: u32>(
    [from, to]: [&'static SweepTable; 2],
    sweep: &Sweep<W>,
    index: Int<W>,
    fraction_bits: u32,
) -> Control<W, F> {
    let row = (sweep.count - Fx::int(1)).shl(4) + index;
    let [from, to] = each!(table in [from, to] => {
        let entry: Control<W, F> = Fx::lookup(row, table);
        entry.quantise(fraction_bits)
    });
    let way: WideControl<W, WIDE> = (to - from).mul(sweep.share);
    from + way.round_to::<F>(fraction_bits)
}

/// Direction of probe `index`; its exponent is that of the sweep's mantissas.
#[inline(always)]
pub fn direction<W: Word>(sweep: &Sweep<W>, index: Int<W>, p: &Precision) -> Block<W, 3> {
    let tables = [&rom::NORMAL_PLACES_OF_ONE_LESS, &rom::NORMAL_PLACES];
    let place = on_its_way::<W, OFFSET, { OFFSET + SHARE }>(tables, sweep, index, p.offset_bits());
    // Places of the tables, and differences between them, are below 2.
    let x: Fx<W, OFFSET> = Fx::of_control(place.saturate(Fx::int(-2), Fx::int(2)));
    let square: Fx<W, OFFSET> = x.mul::<OFFSET, { 2 * OFFSET }>(x).round_to(p.offset_bits());
    let r = each!(i in [0, 1, 2] => {
        // At most 1 + 2 + 4.
        let moved: Wide<W, { OFFSET + MANTISSA }> = x.mul(sweep.first[i]) + square.mul(sweep.second[i]);
        sweep.centre[i].widen() + moved
    });
    normalise(r, Fx::int(0), p.fraction_bits)
}

/// Level of detail of probe `index`, which looks along `r`, saturated to the levels of the map and rounded to `lod_bits`.
#[inline(always)]
pub fn level<W: Word>(
    sweep: &Sweep<W>,
    index: Int<W>,
    r: &Block<W, 3>,
    last_level: Int<W>,
    p: &Precision,
) -> Control<W, LOD> {
    let tables = [&rom::NORMAL_WIDENINGS_OF_ONE_LESS, &rom::NORMAL_WIDENINGS];
    let widening = on_its_way::<W, LOD, { LOD + SHARE }>(tables, sweep, index, LOD);
    let [x, y, z] = each!(m in r.m => m.abs());
    // With m = |r|/ρ: −log₂|r| + 1.5·log₂ρ = ½·log₂|r| − 1.5·log₂m.
    let half_square = half_log2(&number(dot(&r.m, &r.m), Fx::int(0), p.fraction_bits), p);
    let largest: Control<W, LOGARITHM> = log2(x.max(y).max(z), p);
    let largest: Control<W, LOD> = largest.to_control();
    let lengths = half_square.floor_shr(1) - largest - largest.floor_shr(1);
    let e = r.e.saturate(Fx::int(-64), Fx::int(64)).to_control::<LOD>();
    (sweep.level + widening + lengths - e).saturate(Fx::zero(), last_level.to_control()).quantise(p.lod_bits)
}

/// Weight of probe `index`, in 2^−16 units; the weights of one footprint sum to exactly 2^16.
///
/// The weights of one or two middle probes start from those of one probe less, none or one; all other weights are equal.
#[inline(always)]
pub fn weight<W: Word>(sweep: &Sweep<W>, index: Int<W>) -> Control<W, SHARE> {
    let count = sweep.count;
    let [own, of_one_less]: [Control<W, SHARE>; 2] =
        each!(count in [count, (count - Fx::int(1)).max(Fx::int(1))] => Fx::lookup(count, &rom::ONE_OVER_COUNT));
    let way: WideControl<W, { 2 * SHARE }> = (own - of_one_less).mul(sweep.share);
    let outer = of_one_less + way.round_to::<SHARE>(16);
    let even = count.floor_shr(1).shl(1) - count + Fx::int(1);
    let others: WideControl<W, { 32 + SHARE }> = (count - Fx::int(1) - even).mul(outer);
    let rest = Fx::<W::Count, SHARE>::int(1) - Fx::from_raw(W::Count::narrow(others.raw()));
    let middle = Fx::select(even.is_zero(), rest, rest.floor_shr(1));
    let from_middle = (index.shl(1) + Fx::int(1) - count).abs();
    Fx::select(Fx::int(1).lt(from_middle), outer, middle).saturate(Fx::zero(), Fx::int(1))
}
