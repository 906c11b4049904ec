//! Shadows: laws of horizons that make a texel's peaks as bright as its facets, as light and eye see them.
//!
//! Horizons of a peak's facets do not determine its light: bright facets are those in sight, and light and eye see them together. The laws
//! therefore begin as those of the horizons ([`law`](super::law)). They are then moved until Σ a cosⁿα · share is the light of the facets, by least
//! squares over 240 pairs of light and eye, mostly low ones. Share and light are those of the datapath (`core/src/stage/horizon.rs`, correlated)
//! and of level 0.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use fearless_simd::prelude::*;
use fearless_simd::{dispatch, f64x8, mask64x8};
use glam::DVec3;
use nalgebra::{SMatrix, SVector};

use super::blocks::{Block, Directions, LANES, LEVEL, cosines, joined, powers};
use super::fit::FittedPeak;
use super::levels::Horizon;
use crate::horizon::HorizonSlopes;

/// Elevations of eyes, degrees.
const EYES: [f64; 5] = [1.5, 3.0, 6.0, 12.0, 35.0];
/// Elevations of lights, degrees.
const LIGHTS: [f64; 4] = [12.0, 25.0, 45.0, 75.0];
/// Azimuths for each pair of an eye's and a light's elevation.
const AROUND: usize = 12;
/// Pairs of light and eye.
const PAIRS: usize = EYES.len() * LIGHTS.len() * AROUND;
const BLOCKS: usize = PAIRS / LANES;
/// Steepest slope of a direction, as in the datapath.
const STEEPEST: f64 = 8.0;
/// Passes over the peaks of a texel; twelve passes gain next to nothing.
const PASSES: u32 = 3;
/// Root of the weight, in the minimised sum, of the distance from the laws of the horizons.
const TETHER: f64 = 0.03;
/// Share of the mean light added to the light of a pair; errors are relative to the sum.
const FLOOR: f64 = 0.1;
/// Narrowest initial width of a law, and the narrowest and widest fitted widths as logarithms.
const NARROW: f64 = 0.02;
const WIDTHS: std::ops::RangeInclusive<f64> = -5.0..=3.0;
/// Range of the slopes at which a law begins.
const LOWS: std::ops::RangeInclusive<f64> = -4.0..=7.9;

const _: () = assert!(BLOCKS * LANES == PAIRS);

/// Eight pairs of light and eye.
struct Pairs {
    /// Directions half way between light and eye.
    half: Directions,
    /// Slope of the lower of light and eye towards each side, infinite if neither goes there. A facet is lit and in sight if its horizons are
    /// below these slopes.
    clear: [Block; 4],
    /// Slopes of the light over x and y, then of the eye.
    slopes: [Block; 4],
    /// 1 for a slope towards the positive side, −1 otherwise.
    sides: [Block; 4],
}

/// Light and eye of every pair.
fn directions() -> Vec<[DVec3; 2]> {
    // Turns that never repeat: by the golden ratio, and its square.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let direction = |elevation: f64, turn: f64| {
        let (sin, cos) = libm::sincos(elevation.to_radians());
        let (y, x) = libm::sincos(TAU * turn);
        DVec3::new(cos * x, cos * y, sin)
    };
    let elevations = EYES.into_iter().flat_map(|eye| LIGHTS.map(|light| [light, eye]));
    elevations
        .flat_map(|elevations| (0..AROUND).map(move |around| (elevations, around)))
        .enumerate()
        .map(|(index, ([light, eye], around))| {
            let turn = (around as f64 + (index as f64 * GOLDEN).fract()) / AROUND as f64;
            let between = 3.1 * GOLDEN * GOLDEN * (index + 1) as f64;
            [direction(light, (turn + between).fract()), direction(eye, turn)]
        })
        .collect()
}

/// The pairs, made once.
static ALL: LazyLock<Vec<Pairs>> = LazyLock::new(|| {
    let block = |pairs: &[[DVec3; 2]]| {
        let lanes = |value: &dyn Fn([DVec3; 2]) -> f64| Block(std::array::from_fn(|lane| value(pairs[lane])));
        let slope = |direction: DVec3, axis: usize| (direction.z / direction[axis].abs()).min(STEEPEST);
        let clear = |side: usize, pair: [DVec3; 2]| {
            let there = pair.into_iter().filter(|direction| (direction[side / 2] < 0.0) == side.is_multiple_of(2));
            there.map(|direction| slope(direction, side / 2)).fold(f64::INFINITY, f64::min)
        };
        Pairs {
            half: [0, 1, 2].map(|axis| lanes(&|[light, eye]| (light + eye).normalize()[axis])),
            clear: [0, 1, 2, 3].map(|side| lanes(&|pair| clear(side, pair))),
            slopes: [0, 1, 2, 3].map(|ramp| lanes(&|pair| slope(pair[ramp / 2], ramp % 2))),
            sides: [0, 1, 2, 3].map(|ramp| lanes(&|pair| 1.0_f64.copysign(pair[ramp / 2][ramp % 2]))),
        }
    };
    directions().chunks_exact(LANES).map(block).collect()
});

/// One number for each pair.
pub(super) type Light = [Block; BLOCKS];

/// Light of no facets.
pub(super) const DARK: Light = [Block::ZERO; BLOCKS];

/// Adds the light of a facet a cosⁿα to a sum.
#[inline(always)]
fn add<S: Simd>(simd: S, sum: &mut Light, normal: DVec3, slopes: &HorizonSlopes, amplitude: f64, exponent: f64) {
    let exponent = f64x8::splat(simd, exponent);
    for (sum, pairs) in sum.iter_mut().zip(ALL.iter()) {
        let [left, right, down, up] = &pairs.clear;
        let along_x = left.load(simd).simd_ge(slopes[0]) & right.load(simd).simd_ge(slopes[1]);
        let along_y = down.load(simd).simd_ge(slopes[2]) & up.load(simd).simd_ge(slopes[3]);
        let seen: mask64x8<S> = along_x & along_y;
        if seen.all_false() {
            continue;
        }
        if let Some(powers) = powers(cosines(simd, normal, &pairs.half), exponent) {
            let light = seen.select(powers * amplitude, f64x8::splat(simd, 0.0));
            *sum = Block::store(sum.load(simd) + light);
        }
    }
}

/// Light of facets with their horizons and amplitudes: Σ a cosⁿα over facets that are lit and in sight.
pub(super) fn light(facets: impl Iterator<Item = (DVec3, HorizonSlopes, f64)>, exponent: f64) -> Light {
    let mut sum = DARK;
    // A closure would be compiled for one instruction set.
    let mut facets = facets;
    dispatch!(*LEVEL, simd => add_all(simd, &mut sum, &mut facets, exponent));
    sum
}

#[inline(always)]
fn add_all<S: Simd>(
    simd: S,
    sum: &mut Light,
    facets: &mut impl Iterator<Item = (DVec3, HorizonSlopes, f64)>,
    exponent: f64,
) {
    for (normal, slopes, amplitude) in facets {
        add(simd, sum, normal, &slopes, amplitude, exponent);
    }
}

/// Weights of errors, pair by pair: the reciprocal of the whole map's light there plus a share of its mean.
pub(super) fn weights(whole: &Light) -> Light {
    let lanes = || whole.iter().flat_map(|block| block.0);
    let floor = FLOOR * lanes().sum::<f64>() / PAIRS as f64;
    let weight = |light: f64| if light + floor > 0.0 { 1.0 / (light + floor) } else { 0.0 };
    whole.map(|block| Block(block.0.map(weight)))
}

/// Laws of the four sides of a peak in the variables of the fit: low ends, logarithms of widths, and which laws are
/// steps.
#[derive(Clone, Copy, Debug)]
struct Law {
    low: [f64; 4],
    log_width: [f64; 4],
    width: [f64; 4],
}

impl Law {
    fn new(sides: &[Horizon; 4]) -> Self {
        // A step stays a step: all its horizons are equal.
        let width = sides.map(|side| if side.width > 0.0 { side.width.max(NARROW) } else { 0.0 });
        Self { low: sides.map(|side| side.low), log_width: width.map(|width| libm::log(width.max(NARROW))), width }
    }

    fn moved(&self, by: &[f64; 8]) -> Self {
        let mut law = *self;
        for side in 0..4 {
            let half = |step: f64| step.clamp(-0.5, 0.5);
            law.low[side] = (self.low[side] + half(by[side])).clamp(*LOWS.start(), *LOWS.end());
            if self.width[side] > 0.0 {
                law.log_width[side] = (self.log_width[side] + half(by[4 + side])).clamp(*WIDTHS.start(), *WIDTHS.end());
                law.width[side] = libm::exp(law.log_width[side]);
            } else {
                law.low[side] = self.low[side];
            }
        }
        law
    }

    /// Distance from another law, variable by variable.
    fn from(&self, other: &Self) -> [f64; 8] {
        std::array::from_fn(|variable| {
            let side = variable % 4;
            if variable < 4 { self.low[side] - other.low[side] } else { self.log_width[side] - other.log_width[side] }
        })
    }
}

/// Four ramps of light and eye: the position of each on its law.
///
/// Functions are used instead of closures, here and below: a closure is compiled without the vectors of the machine and is not inlined.
#[inline(always)]
fn ramps<S: Simd>(simd: S, pairs: &Pairs, law: &Law) -> [Ramp<S>; 4] {
    [ramp(simd, pairs, law, 0), ramp(simd, pairs, law, 1), ramp(simd, pairs, law, 2), ramp(simd, pairs, law, 3)]
}

#[inline(always)]
fn ramp<S: Simd>(simd: S, pairs: &Pairs, law: &Law, index: usize) -> Ramp<S> {
    let (zero, one) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 1.0));
    let positive = pairs.sides[index].load(simd).simd_gt(zero);
    let low = of_side(simd, positive, &law.low, index);
    let width = of_side(simd, positive, &law.width, index);
    let above = pairs.slopes[index].load(simd) - low;
    let t = above / width;
    let sloped = width.simd_gt(zero);
    let climbing = sloped & t.simd_gt(zero) & t.simd_lt(one);
    // A law of width 0 is a step.
    let over = sloped.select(t, above + one).simd_ge(one);
    let t = climbing.select(t, over.select(one, zero));
    let rest = one - t;
    Ramp { positive, t, width, share: one - rest * rest, slope: climbing.select(rest + rest, zero) }
}

/// Value of the side to which a ramp goes.
#[inline(always)]
fn of_side<S: Simd>(simd: S, positive: mask64x8<S>, sides: &[f64; 4], ramp: usize) -> f64x8<S> {
    let axis = 2 * (ramp % 2);
    positive.select(f64x8::splat(simd, sides[axis + 1]), f64x8::splat(simd, sides[axis]))
}

struct Ramp<S: Simd> {
    positive: mask64x8<S>,
    t: f64x8<S>,
    width: f64x8<S>,
    /// 1 − (1 − t)².
    share: f64x8<S>,
    /// Derivative of the share by t; 0 if t is clamped.
    slope: f64x8<S>,
}

/// The two smallest shares, and the indices of their ramps.
#[inline(always)]
fn smallest<S: Simd>(simd: S, ramps: &[Ramp<S>; 4]) -> ([f64x8<S>; 2], [f64x8<S>; 2]) {
    let (mut least, mut next) = (ramps[0].share, f64x8::splat(simd, 2.0));
    let (mut least_of, mut next_of) = (f64x8::splat(simd, 0.0), f64x8::splat(simd, 4.0));
    for (index, ramp) in ramps.iter().enumerate().skip(1) {
        let of = f64x8::splat(simd, index as f64);
        let (below, between) = (ramp.share.simd_lt(least), ramp.share.simd_lt(next));
        next = below.select(least, between.select(ramp.share, next));
        next_of = below.select(least_of, between.select(of, next_of));
        least = below.select(ramp.share, least);
        least_of = below.select(of, least_of);
    }
    ([least, next], [least_of, next_of])
}

/// Shares of a peak at all pairs.
#[inline(always)]
fn shares<S: Simd>(simd: S, law: &Law) -> Light {
    let mut shares = DARK;
    for (share, pairs) in shares.iter_mut().zip(ALL.iter()) {
        let ([least, next], _) = smallest(simd, &ramps(simd, pairs, law));
        *share = Block::store(least * (next + 3.0) * 0.25);
    }
    shares
}

/// Derivatives of a share by low ends and logarithms of widths of the four sides.
#[inline(always)]
fn slopes<S: Simd>(simd: S, pairs: &Pairs, law: &Law) -> [f64x8<S>; 8] {
    let ramps = ramps(simd, pairs, law);
    let ([least, next], [least_of, next_of]) = smallest(simd, &ramps);
    let zero = f64x8::splat(simd, 0.0);
    let mut slopes = [zero; 8];
    for (index, ramp) in ramps.iter().enumerate() {
        let of = f64x8::splat(simd, index as f64);
        let by_share = least_of.simd_eq(of).select((next + 3.0) * 0.25, next_of.simd_eq(of).select(least * 0.25, zero));
        let by_t = by_share * ramp.slope;
        let by_low = ramp.width.simd_gt(zero).select(-by_t / ramp.width, zero);
        let by_width = -by_t * ramp.t;
        let axis = 2 * (index % 2);
        slopes[axis] += ramp.positive.select(zero, by_low);
        slopes[axis + 1] += ramp.positive.select(by_low, zero);
        slopes[4 + axis] += ramp.positive.select(zero, by_width);
        slopes[5 + axis] += ramp.positive.select(by_width, zero);
    }
    slopes
}

/// Light of a peak without horizons, weighted.
#[inline(always)]
fn open<S: Simd>(simd: S, peak: &FittedPeak, weights: &Light) -> Light {
    let mut light = DARK;
    let exponent = f64x8::splat(simd, peak.exponent);
    for ((light, pairs), weight) in light.iter_mut().zip(ALL.iter()).zip(weights) {
        if let Some(powers) = powers(cosines(simd, peak.direction, &pairs.half), exponent) {
            *light = Block::store(powers * peak.amplitude * weight.load(simd));
        }
    }
    light
}

/// A peak during the fit.
struct Moving {
    start: Law,
    law: Law,
    /// Its light without horizons, weighted.
    open: Light,
    share: Light,
    /// Weight of the distance from the start.
    tether: f64,
    /// Damping of Levenberg and Marquardt.
    damping: f64,
}

/// Laws of peaks that have the light `wanted`, starting from the laws of their horizons.
///
/// Each peak in turn takes a Gauss–Newton step on its own eight numbers with the common residual of all peaks: lobes overlap in few
/// pairs.
pub(super) fn laws(wanted: &Light, weights: &Light, peaks: &[(FittedPeak, [Horizon; 4])]) -> Vec<[Horizon; 4]> {
    dispatch!(*LEVEL, simd => fitted(simd, wanted, weights, peaks))
}

#[inline(always)]
fn fitted<S: Simd>(
    simd: S,
    wanted: &Light,
    weights: &Light,
    peaks: &[(FittedPeak, [Horizon; 4])],
) -> Vec<[Horizon; 4]> {
    let mut moving = Vec::with_capacity(peaks.len());
    for (peak, horizon) in peaks {
        let (start, open) = (Law::new(horizon), open(simd, peak, weights));
        let tether = TETHER * TETHER * dot(simd, &open, &open);
        moving.push(Moving { start, law: start, open, share: shares(simd, &start), tether, damping: 1e-2 });
    }
    let mut rest = DARK;
    for (block, rest) in rest.iter_mut().enumerate() {
        let mut sum = -(wanted[block].load(simd) * weights[block].load(simd));
        for peak in &moving {
            sum += peak.open[block].load(simd) * peak.share[block].load(simd);
        }
        *rest = Block::store(sum);
    }
    for _ in 0..PASSES {
        for peak in &mut moving {
            if peak.tether > 0.0 {
                step(simd, peak, &mut rest);
            }
        }
    }
    moving
        .iter()
        .zip(peaks)
        .map(|(peak, (_, horizon))| {
            std::array::from_fn(|side| Horizon {
                low: peak.law.low[side],
                width: peak.law.width[side],
                ..horizon[side]
            })
        })
        .collect()
}

/// Takes one step of a peak, if it reduces the residual.
#[inline(always)]
fn step<S: Simd>(simd: S, peak: &mut Moving, rest: &mut Light) {
    let zero = f64x8::splat(simd, 0.0);
    let (mut products, mut towards) = ([[zero; 8]; 8], [zero; 8]);
    for (block, pairs) in ALL.iter().enumerate() {
        let (open, left) = (peak.open[block].load(simd), rest[block].load(simd));
        let mut slopes = slopes(simd, pairs, &peak.law);
        for row in 0..8 {
            slopes[row] *= open;
            towards[row] += slopes[row] * left;
            for column in 0..=row {
                products[row][column] += slopes[row] * slopes[column];
            }
        }
    }
    let away = peak.law.from(&peak.start);
    // The lower half of the matrix is enough.
    let mut matrix = SMatrix::<f64, 8, 8>::zeros();
    let mut side = SVector::<f64, 8>::zeros();
    for row in 0..8 {
        side[row] = -(joined(towards[row].into()) + peak.tether * away[row]);
        for column in 0..=row {
            matrix[(row, column)] = joined(products[row][column].into());
        }
        matrix[(row, row)] += peak.tether + peak.damping * matrix[(row, row)];
    }
    let by = matrix.cholesky().map_or_else(SVector::zeros, |factors| factors.solve(&side));
    let law = peak.law.moved(&by.into());
    let share = shares(simd, &law);
    let mut moved = *rest;
    for (block, moved) in moved.iter_mut().enumerate() {
        let more = share[block].load(simd) - peak.share[block].load(simd);
        *moved = Block::store(moved.load(simd) + more * peak.open[block].load(simd));
    }
    let square = |values: [f64; 8]| values.iter().map(|value| value * value).sum::<f64>();
    let before = dot(simd, rest, rest) + peak.tether * square(away);
    let after = dot(simd, &moved, &moved) + peak.tether * square(law.from(&peak.start));
    if after < before {
        (peak.law, peak.share, *rest) = (law, share, moved);
        peak.damping = (0.2 * peak.damping).max(1e-6);
    } else {
        peak.damping *= 8.0;
    }
}

#[inline(always)]
fn dot<S: Simd>(simd: S, left: &Light, right: &Light) -> f64 {
    let mut sum = f64x8::splat(simd, 0.0);
    for (left, right) in left.iter().zip(right) {
        sum += left.load(simd) * right.load(simd);
    }
    joined(sum.into())
}

#[cfg(test)]
mod tests;
