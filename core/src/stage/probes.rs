//! Probes: footprint assembly along the major axis (Schilling, Knittel, Straßer 1996; W97, end of "Solution").
//!
//! The diameter of the assembled footprint is 2√3·λ, which gives a pixel box back its full width (errata 4, 5).
//! N = rule(λ₁/λ₂), at most `max_probes`; when capped, λ₂ is raised to λ₁/N: blurred, never aliased. Probe i lies
//! at (i − (N − 1)/2)·step, N·step the major diameter; LOD = log₂ of the minor diameter in texels of level 0.
//! Error: LOD 2^−(lod_bits + 1) from its own rounding; step 2^−(p−4), relative.

use crate::block::{Block, MANTISSA, Mantissa, normalise, places_below};
use crate::each::each;
use crate::elementary::log2;
use crate::fx::{Fx, Wide};
use crate::precision::{Precision, ProbeRule, ProbeWeights};
use crate::rom::{self, MAX_PROBES};
use crate::signals::{Axes, LOD, MapScale, POSITION, Probes};
use crate::word::Word;

/// Cuts λ₁ to 2 map units, a major diameter of 6.9: probes further out would all look along the same edge of the
/// plane. Count and level of detail keep the uncut λ.
#[inline(always)]
fn cut<W: Word>(sigma: &Block<W, 1>) -> (Block<W, 1>, W::Flag) {
    let above = Fx::lit(1).lt(sigma.e);
    let limit = Block { m: [Fx::lit(1 << MANTISSA)], e: Fx::lit(1) };
    (Block::select(above, limit, *sigma), above)
}

/// The scale of a cube face of `edge` texels, read as 1…16384: 2 map units across.
#[inline(always)]
pub fn face_scale<W: Word>(edge: Fx<W, 0>, p: &Precision) -> MapScale<W> {
    let edge = edge.saturate(Fx::lit(1), Fx::lit(16384));
    let block = Block::of(edge.widen::<0>(), Fx::zero(), p.fraction_bits);
    let fraction: Fx<W, LOD> = log2(block.m[0], p).floor_shr(24 - LOD).reread();
    let whole: Fx<W, LOD> = (block.e - Fx::lit(1)).reread().shl(LOD);
    MapScale { log2_texels: whole + fraction, last_level: Fx::lit(31) - Fx::from_raw(edge.raw().leading_zeros()) }
}

/// Probe count, step and level of detail.
#[inline(always)]
pub fn probes<W: Word>(axes: &Axes<W>, map: &MapScale<W>, p: &Precision) -> Probes<W> {
    let Axes { major, minor, direction } = axes;
    // N ≥ λ₁/λ₂ by comparison with multiples of λ₂. The slack is the noise of the two λ: without it every circle
    // would take two probes.
    let places = places_below(minor.e, major.e, 62);
    let minor_at_major: Wide<W, 58> = minor.m[0].widen::<60>().reread::<58>().floor_shr(2).floor_shr_by(places);
    let major_wide: Wide<W, 58> = major.m[0].widen::<60>().reread::<58>().floor_shr(2);
    let threshold = major_wide - major_wide.floor_shr(p.fraction_bits - 4);
    // Multiples of λ₂ up to 16, by seven adders; below 16·2^58 = 2^62.
    let mut multiples = [minor_at_major; MAX_PROBES + 1];
    for n in 2..=MAX_PROBES {
        multiples[n] = if n & 1 == 0 { multiples[n >> 1].shl(1) } else { multiples[n - 1] + minor_at_major };
    }
    let mut count = Fx::lit(1);
    let capped = match p.probe_rule {
        ProbeRule::Ceiling => {
            for n in 1..p.max_probes {
                count = Fx::select(exceeds::<W>(&multiples, n, threshold), Fx::lit(i64::from(n) + 1), count);
            }
            exceeds::<W>(&multiples, p.max_probes, threshold)
        }
        ProbeRule::PowerOfTwo => {
            let doublings = p.max_probes.max(1).ilog2();
            for doubling in 0..doublings {
                count = Fx::select(exceeds::<W>(&multiples, 1 << doubling, threshold), Fx::lit(2 << doubling), count);
            }
            exceeds::<W>(&multiples, 1 << doublings, threshold)
        }
    };

    let (drawn, saturated) = cut(major);
    Probes {
        count,
        step: step(&drawn, direction, count, p),
        lod: level_of_detail(&Block::select(capped, *major, *minor), capped, count, map, p),
        empty: major.is_zero(),
        saturated,
        capped,
    }
}

/// Whether the threshold is above the n-th multiple, n ≤ 16.
#[inline(always)]
fn exceeds<W: Word>(multiples: &[Wide<W, 58>; MAX_PROBES + 1], n: u32, threshold: Wide<W, 58>) -> W::Flag {
    // The cut is never taken; it leaves no panic path.
    multiples[(n as usize).min(MAX_PROBES)].lt(threshold)
}

/// 2√3·λ₁/N along the direction.
#[inline(always)]
fn step<W: Word>(
    major: &Block<W, 1>,
    direction: &[Mantissa<W>; 2],
    count: Fx<W, 0>,
    p: &Precision,
) -> [Fx<W, POSITION>; 2] {
    let keep = p.fraction_bits;
    let per_sigma: Fx<W, POSITION> = Fx::from_raw(count.raw().lookup(&rom::STEP_PER_SIGMA));
    let length: Wide<W, 58> = per_sigma.keep(p.offset_bits()).mul(major.m[0]);
    let length = Block::of(length, major.e, keep);
    // λ₁ ≤ 2 and 2√3/N < 4: the exponent of the step is at most 3, and 4 fits I4F28.
    let product = normalise(each!(d in *direction => d.mul::<30, 60>(length.m[0])), length.e, keep);
    let places = places_below(product.e, Fx::lit(3), 62);
    each!(m in product.m => {
        let at_eight: Wide<W, 57> = m.widen::<60>().reread();
        at_eight.floor_shr_by(places).claim(-(7 << 57)..=7 << 57, "a_step_is_below_seven_map_units").round_to(POSITION)
    })
}

/// log₂(2√3·λ₂·texels), saturated to the levels of the map and rounded to `lod_bits`.
#[inline(always)]
fn level_of_detail<W: Word>(
    sigma: &Block<W, 1>,
    raised: W::Flag,
    count: Fx<W, 0>,
    map: &MapScale<W>,
    p: &Precision,
) -> Fx<W, LOD> {
    // ±2^13 levels are beyond every map; the saturated exponent fits beside 16 fraction bits.
    let whole: Fx<W, LOD> = sigma.e.saturate(Fx::lit(-(1 << 13)), Fx::lit(1 << 13)).reread().shl(LOD);
    let fraction: Fx<W, LOD> = log2(sigma.m[0], p).floor_shr(24 - LOD).reread();
    let divided: Fx<W, LOD> = Fx::from_raw(count.raw().lookup(&rom::LOG2_OF_COUNT));
    let diameter = whole + fraction + Fx::lit(i64::from(rom::LOG2_DIAMETER)) + map.log2_texels;
    let raised = diameter - Fx::select(raised, divided, Fx::zero());
    let last: Fx<W, LOD> = map.last_level.reread().shl(LOD);
    raised.saturate(Fx::zero(), last).keep(p.lod_bits)
}

/// Place of probe `index` relative to the centre of the footprint: (2·index − N + 1)·step/2. |·| ≤ 3.5 units.
#[inline(always)]
pub fn position<W: Word>(probes: &Probes<W>, index: Fx<W, 0>) -> [Fx<W, POSITION>; 2] {
    let odd = index.shl(1) - probes.count + Fx::lit(1);
    each!(step in probes.step => {
        let twice: Wide<W, 29> = step.mul::<0, 28>(odd).reread();
        twice.claim(-(7 << 28)..=7 << 28, "probes_stay_on_the_major_axis").round_to(POSITION)
    })
}

/// Weight of probe `index` in 2^−16 units; the weights of one footprint sum to exactly 2^16.
#[inline(always)]
pub fn weight<W: Word>(probes: &Probes<W>, index: Fx<W, 0>, p: &Precision) -> Fx<W, 16> {
    let table = match p.probe_weights {
        ProbeWeights::Box => &rom::BOX_WEIGHTS,
        ProbeWeights::Gaussian => &rom::GAUSSIAN_WEIGHTS,
    };
    let row = (probes.count - Fx::lit(1)).shl(4);
    Fx::from_raw((row + index).raw().lookup(table))
}
