//! Fit of a density by a few peaks Σ a cosⁿα (F92 §2.3): non-linear least squares, one more peak at a time.
//!
//! A peak is guessed at the maximum of what is left, with an exponent from the fall-off to the neighbours; Levenberg and
//! Marquardt then fit all peaks together, with an analytic Jacobian and every sample weighted by its solid angle. Where lobes of a few
//! clusters of facets (`clusters`) are far from the density, a fit of as many peaks would be, too: it starts from as many as are not. Four
//! variables a peak, none of them bounded for the solver: √a; the stereographic coordinates of the direction (one length
//! means one angle anywhere on the hemisphere, the pole is no special place); and ν, which runs through ln n = low … high
//! as ν/√(1 + ν²) runs from −1 to 1. After every fit the amplitudes are scaled to the energy of the density (erratum 24).

use std::cell::RefCell;

use fearless_simd::prelude::*;
use fearless_simd::{dispatch, f64x8};
use glam::DVec3;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned};

use super::blocks::{self, Block, LANES, LEVEL, cosines, joined, log_powers, powers};
use super::spread::{BLOCKS, HEMISPHERE, SAMPLES, neighbours, power};

/// Most peaks of a fit.
pub(super) const MAX_PEAKS: usize = 7;
/// A fit is good when its residual is below this share of the density, root mean square and maximum.
pub(super) const GOOD: f64 = 0.05;
/// Relative reduction of the sum of squares at which a fit has converged.
///
/// Of a photograph of 128² with slopes of 1 and facets of exponent 20, 306 of 1365 fits miss [`GOOD`] and all peaks are 40 274; with 1e-4 299 and
/// 40 263 in 1.4 times the time. With 1e-2 the largest residual of a weave (`host-tests/tests/pictures/peak_pyramid.rs`) is 0.115 of its maximum, not 0.095.
const TOLERANCE: f64 = 5e-3;
/// In multiples of [`GOOD`], the residual of lobes of clusters that a fit is tried from. From those of 2 that photograph has 0.4 % more peaks, from
/// those of 3 0.2 % less, in 1.1 times the time.
const NEAR: f64 = 2.5;
/// Evaluations a fit may take, in multiples of its variables + 1.
const PATIENCE: usize = 4;
/// Share of a derivative's square that is rounding where it depends on those before it.
const DEPENDENT: f64 = 1e-13;
/// A peak that nowhere on the hemisphere reaches this share of the density's maximum is left out.
const INVISIBLE: f64 = 1e-6;

/// One peak of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FittedPeak {
    pub(super) amplitude: f64,
    /// Unit vector.
    pub(super) direction: DVec3,
    pub(super) exponent: f64,
}

impl FittedPeak {
    /// Its largest value on the hemisphere: at its direction, or at the horizon below which it points.
    fn highest(&self) -> f64 {
        let cos = if self.direction.z > 0.0 { 1.0 } else { self.direction.truncate().length() };
        self.amplitude * power(cos, self.exponent)
    }
}

/// Peaks and what they leave of a density.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Fit {
    pub(super) peaks: Vec<FittedPeak>,
    pub(super) rest: Rest,
}

/// A residual as a share of its density.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rest {
    /// Root mean square of the residual over that of the density.
    pub(super) rms: f64,
    /// Largest absolute residual over the largest density.
    pub(super) maximum: f64,
}

impl Rest {
    fn is_below(self, share: f64) -> bool {
        self.rms < share && self.maximum < share
    }

    /// Whether it is small enough.
    pub(super) fn is_good(self) -> bool {
        self.is_below(GOOD)
    }
}

/// Fits a density spread with `spread_exponent`; no peaks where the density is 0 everywhere.
///
/// `lobes` are at most as many as asked for that together have the density's energy, where it may start from.
pub(super) fn fit(density: &[f64], spread_exponent: f64, lobes: impl Fn(usize) -> Vec<FittedPeak>) -> Fit {
    let largest = density.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Fit::default();
    }
    // Exactly one facet has the exponent it was spread with: that must not be the end of the range.
    let range = ExponentRange { low: 0.0, high: libm::log(2.0 * spread_exponent) };
    let relative: Vec<f64> = density.iter().map(|value| value / largest).collect();
    let blocks = Block::list(relative.iter().copied());
    let mut peaks = start(&relative, |most| {
        let inside = |lobe: FittedPeak| FittedPeak {
            amplitude: lobe.amplitude / largest,
            exponent: range.inside(lobe.exponent),
            ..lobe
        };
        lobes(most).into_iter().map(inside).collect()
    });
    if peaks.is_empty() {
        peaks.push(guess(&relative, range));
    }
    let mut space = Space::default();
    loop {
        let problem = Problem::new(&blocks, range, &peaks, space);
        let solver = LevenbergMarquardt::new().with_ftol(TOLERANCE).with_patience(PATIENCE);
        let (problem, _) = solver.minimize(problem);
        peaks = problem.peaks();
        space = problem.space;
        let (residual, rest) = settle(&relative, &mut peaks);
        if rest.is_good() || peaks.len() == MAX_PEAKS {
            let absolute = |peak: FittedPeak| FittedPeak { amplitude: peak.amplitude * largest, ..peak };
            let visible = |peak: &FittedPeak| peak.highest() > INVISIBLE * largest;
            return Fit { peaks: peaks.into_iter().map(absolute).filter(visible).collect(), rest };
        }
        peaks.push(guess(&residual, range));
    }
}

/// Peaks that a fit starts from: lobes of the fewest clusters that are near a density of the maximum 1, of all where none are.
///
/// None where two are near it: one or two peaks may do then, and take no time.
fn start(density: &[f64], lobes: impl Fn(usize) -> Vec<FittedPeak>) -> Vec<FittedPeak> {
    let mut peaks = Vec::new();
    for most in 2..=MAX_PEAKS {
        peaks = lobes(most);
        if settle(density, &mut peaks).1.is_below(NEAR * GOOD) {
            return if most > 2 { peaks } else { Vec::new() };
        }
    }
    peaks
}

/// Scales peaks to the energy of a density of the maximum 1. What they leave of it, sample by sample and in all.
fn settle(density: &[f64], peaks: &mut [FittedPeak]) -> (Vec<f64>, Rest) {
    let model = evaluate(peaks);
    let scale = HEMISPHERE.integral(density.iter().copied()) / HEMISPHERE.integral(model.iter().copied());
    let scale = if scale.is_finite() { scale } else { 1.0 };
    for peak in peaks {
        peak.amplitude *= scale;
    }
    let residual: Vec<f64> = density.iter().zip(&model).map(|(wanted, got)| wanted - scale * got).collect();
    let rest = Rest {
        rms: (square(&residual) / square(density)).sqrt(),
        maximum: residual.iter().fold(0.0, |most: f64, value| most.max(value.abs())),
    };
    (residual, rest)
}

/// ∫ f² dω over the hemisphere.
fn square(values: &[f64]) -> f64 {
    HEMISPHERE.integral(values.iter().map(|value| value * value))
}

/// Σ a cosⁿα at every sample.
fn evaluate(peaks: &[FittedPeak]) -> Vec<f64> {
    let mut values: Vec<f64> =
        dispatch!(*LEVEL, simd => evaluate_blocks(simd, peaks)).into_iter().flat_map(|Block(lanes)| lanes).collect();
    values.truncate(SAMPLES);
    values
}

#[inline(always)]
fn evaluate_blocks<S: Simd>(simd: S, peaks: &[FittedPeak]) -> Vec<Block> {
    let mut blocks = vec![Block::ZERO; BLOCKS];
    for peak in peaks {
        let exponent = f64x8::splat(simd, peak.exponent);
        for (sum, (directions, _)) in blocks.iter_mut().zip(&HEMISPHERE.blocks) {
            if let Some(share) = powers(cosines(simd, peak.direction, directions), exponent) {
                *sum = Block::store(sum.load(simd) + share * peak.amplitude);
            }
        }
    }
    blocks
}

/// A peak at the maximum of a residual, as narrow as its neighbours tell.
fn guess(residual: &[f64], range: ExponentRange) -> FittedPeak {
    let sample = (0..SAMPLES).fold(0, |best, sample| if residual[sample] > residual[best] { sample } else { best });
    let direction = HEMISPHERE.directions[sample];
    let amplitude = residual[sample].max(INVISIBLE);
    // ln of the fall-off over ln of the cosine; both sums are over the same neighbours, so far ones count more.
    let (mut fall, mut cosine) = (0.0, 0.0);
    for neighbour in neighbours(sample) {
        fall += libm::log((residual[neighbour] / amplitude).clamp(0.01, 1.0));
        cosine += libm::log(direction.dot(HEMISPHERE.directions[neighbour]));
    }
    FittedPeak { amplitude, direction, exponent: range.inside(fall / cosine) }
}

/// Range of ln n.
#[derive(Clone, Copy, Debug)]
struct ExponentRange {
    low: f64,
    high: f64,
}

impl ExponentRange {
    /// The exponent, pulled away from the ends, where ν is infinite.
    fn inside(self, exponent: f64) -> f64 {
        let margin = 0.02 * (self.high - self.low);
        libm::exp(libm::log(exponent.max(1.0)).clamp(self.low + margin, self.high - margin))
    }

    fn to_variable(self, exponent: f64) -> f64 {
        let share = (2.0 * (libm::log(exponent) - self.low) / (self.high - self.low) - 1.0).clamp(-0.999, 0.999);
        share / (1.0 - share * share).sqrt()
    }

    /// ln n and its derivative by ν.
    fn log_exponent(self, variable: f64) -> (f64, f64) {
        let square = 1.0 + variable * variable;
        let half = 0.5 * (self.high - self.low);
        (self.low + half * (1.0 + variable / square.sqrt()), half / (square * square.sqrt()))
    }
}

/// One peak as the solver sees it, with what does not depend on the sample.
#[derive(Clone, Copy, Debug)]
struct State {
    root: f64,
    direction: DVec3,
    /// Derivatives of the direction by its two coordinates.
    tangents: [DVec3; 2],
    exponent: f64,
    /// ∂ ln n/∂ν.
    log_slope: f64,
}

impl State {
    fn new([root, p, q, variable]: [f64; 4], range: ExponentRange) -> Self {
        let scale = 1.0 / (1.0 + p * p + q * q);
        let (log_exponent, log_slope) = range.log_exponent(variable);
        let exponent = libm::exp(log_exponent);
        let tangent = |along: DVec3, coordinate: f64, direction: DVec3| {
            2.0 * scale * (along - coordinate * (direction + DVec3::Z))
        };
        let direction = DVec3::new(2.0 * p * scale, 2.0 * q * scale, 2.0 * scale - 1.0);
        Self {
            root,
            direction,
            tangents: [tangent(DVec3::X, p, direction), tangent(DVec3::Y, q, direction)],
            exponent,
            log_slope,
        }
    }
}

/// Residuals √ω (Σ a cosⁿα − N) over the samples, handed to the solver as a problem of few rows.
///
/// The solver sees residuals r through |r|, Jᵀr and JᵀJ alone, so r' = (|r|, 0, …) and J' = (rᵀJ/|r|; R) with
/// RᵀR = JᵀJ − (rᵀJ)ᵀ(rᵀJ)/|r|² lead it the same way: its factorisation of J, two thirds of a build, has 4k + 1 rows
/// instead of 1297.
///
/// Samples go in blocks, and a peak is nowhere but in blocks where it is not negligible. What is left out adds zeros.
struct Problem<'a> {
    density: &'a [Block],
    range: ExponentRange,
    variables: DVector<f64>,
    states: Vec<State>,
    space: Space,
}

/// What a problem works out for every block; taken from one problem to the next.
#[derive(Default)]
struct Space {
    /// Of every peak.
    shares: Vec<Shares>,
    residuals: Vec<Block>,
    /// Derivatives of the residuals by the four variables of every peak: peak · BLOCKS + block, in its blocks.
    slopes: RefCell<Vec<[Block; 4]>>,
}

/// A peak at every sample.
struct Shares {
    blocks: BlockSet,
    /// cosⁿα and, unless it is 0, ln cosⁿα, in these blocks.
    powers: Vec<[Block; 2]>,
}

/// Some of the blocks, bit by bit.
#[derive(Clone, Copy, Debug, Default)]
struct BlockSet([u64; BLOCKS.div_ceil(64)]);

impl BlockSet {
    /// Blocks of eight samples.
    const WHOLE: Self = {
        let mut blocks = [u64::MAX; BLOCKS.div_ceil(64)];
        blocks[(BLOCKS - 1) / 64] = (1 << ((BLOCKS - 1) % 64)) - 1;
        Self(blocks)
    };
    /// The last one, of one sample.
    const LAST: Self = {
        let mut blocks = [0; BLOCKS.div_ceil(64)];
        blocks[(BLOCKS - 1) / 64] = 1 << ((BLOCKS - 1) % 64);
        Self(blocks)
    };
    const ALL: Self = Self([u64::MAX; BLOCKS.div_ceil(64)]);

    #[inline(always)]
    fn add(&mut self, block: usize) {
        self.0[block / 64] |= 1 << (block % 64);
    }

    #[inline(always)]
    fn common(self, other: Self) -> Self {
        Self(std::array::from_fn(|word| self.0[word] & other.0[word]))
    }

    /// Runs over the blocks in order.
    #[inline(always)]
    fn each(self, mut visit: impl FnMut(usize)) {
        for (word, mut bits) in self.0.into_iter().enumerate() {
            while bits != 0 {
                visit(64 * word + bits.trailing_zeros() as usize);
                bits &= bits - 1;
            }
        }
    }
}

impl<'a> Problem<'a> {
    fn new(density: &'a [Block], range: ExponentRange, peaks: &[FittedPeak], mut space: Space) -> Self {
        let variables = peaks.iter().flat_map(|peak| {
            // A peak straight down has no stereographic coordinates; its neighbour has.
            let scale = 1.0 / (1.0 + peak.direction.z).max(1e-6);
            let [x, y] = [peak.direction.x, peak.direction.y];
            [peak.amplitude.sqrt(), x * scale, y * scale, range.to_variable(peak.exponent)]
        });
        let variables = DVector::from_iterator(4 * peaks.len(), variables);
        let shares = || Shares { blocks: BlockSet::default(), powers: vec![[Block::ZERO; 2]; BLOCKS] };
        space.shares.resize_with(peaks.len(), shares);
        space.residuals.resize(BLOCKS, Block::ZERO);
        space.slopes.get_mut().resize(peaks.len() * BLOCKS, [Block::ZERO; 4]);
        let mut problem = Self { density, range, variables: DVector::zeros(0), states: Vec::new(), space };
        problem.set_params(&variables);
        problem
    }

    fn peaks(&self) -> Vec<FittedPeak> {
        let peak = |state: &State| FittedPeak {
            amplitude: state.root * state.root,
            direction: state.direction.normalize(),
            exponent: state.exponent,
        };
        self.states.iter().map(peak).collect()
    }

    /// Shares of all peaks, and residuals.
    #[inline(always)]
    fn evaluate<S: Simd>(&mut self, simd: S) {
        let Space { shares, residuals, .. } = &mut self.space;
        for (residual, density) in residuals.iter_mut().zip(self.density) {
            *residual = Block::store(-density.load(simd));
        }
        for (state, shares) in self.states.iter().zip(shares) {
            let amplitude = state.root * state.root;
            let exponent = f64x8::splat(simd, state.exponent);
            shares.blocks = BlockSet::default();
            // Logarithms first, then exponentials: two short runs of dependent operations overlap from block to block, one long one does not.
            for (block, (directions, _)) in HEMISPHERE.blocks.iter().enumerate() {
                if let Some(logs) = log_powers(cosines(simd, state.direction, directions), exponent) {
                    shares.blocks.add(block);
                    shares.powers[block][1] = Block::store(logs);
                }
            }
            shares.blocks.each(|block| {
                let [share, logs] = &mut shares.powers[block];
                let powers = blocks::shares(logs.load(simd));
                *share = Block::store(powers);
                residuals[block] = Block::store(residuals[block].load(simd) + powers * amplitude);
            });
        }
        for (residual, (_, weights)) in residuals.iter_mut().zip(&HEMISPHERE.blocks) {
            *residual = Block::store(residual.load(simd) * weights.load(simd));
        }
    }

    /// |r|.
    fn norm(&self) -> f64 {
        let residuals = &self.space.residuals;
        let [[square]] = dispatch!(*LEVEL, simd => {
            products(simd, BlockSet::ALL, |block| [&residuals[block]], |block| [&residuals[block]])
        });
        square.sqrt()
    }

    /// Derivatives of the residuals by the variables.
    #[inline(always)]
    fn slopes<S: Simd>(&self, simd: S) {
        let mut slopes = self.space.slopes.borrow_mut();
        let zero = f64x8::splat(simd, 0.0);
        for ((state, shares), slopes) in self.states.iter().zip(&self.space.shares).zip(slopes.chunks_exact_mut(BLOCKS))
        {
            let amplitude = state.root * state.root;
            shares.blocks.each(|block| {
                let (directions, weights) = &HEMISPHERE.blocks[block];
                let [share, log] = shares.powers[block].map(|values| values.load(simd));
                let weighted = weights.load(simd) * share;
                let by_cosine = weighted * amplitude * state.exponent / cosines(simd, state.direction, directions);
                // Where the cosine is 0 or below there is no share.
                let by_cosine = share.simd_gt(zero).select(by_cosine, zero);
                slopes[block] = [
                    weighted * (2.0 * state.root),
                    by_cosine * cosines(simd, state.tangents[0], directions),
                    by_cosine * cosines(simd, state.tangents[1], directions),
                    weighted * amplitude * log * state.log_slope,
                ]
                .map(Block::store);
            });
        }
    }

    /// rᵀJ/|r| in the first row, JᵀJ below, on and right of the diagonal.
    #[inline(always)]
    fn normal_equations<S: Simd>(&self, simd: S) -> DMatrix<f64> {
        self.slopes(simd);
        let slopes = self.space.slopes.borrow();
        let Space { shares, residuals, .. } = &self.space;
        let norm = self.norm();
        let along = |residual: &Block| {
            let along = residual.load(simd) / norm;
            // Where nothing is left there is no direction of it either.
            Block::store(if norm > 0.0 { along } else { f64x8::splat(simd, 0.0) })
        };
        let along: Vec<Block> = residuals.iter().map(along).collect();
        let count = 4 * self.states.len();
        let mut equations = DMatrix::zeros(count + 1, count);
        for (column, (own, of)) in slopes.chunks_exact(BLOCKS).zip(shares).enumerate() {
            let [towards] = products(simd, of.blocks, |block| [&along[block]], |block| own[block].each_ref());
            equations.view_mut((0, 4 * column), (1, 4)).copy_from_slice(&towards);
            for (row, (other, with)) in slopes.chunks_exact(BLOCKS).zip(shares).enumerate().take(column + 1) {
                let common = of.blocks.common(with.blocks);
                // Two rows of four: eight sums, as many as there are registers for everywhere.
                for half in [0, 2] {
                    let rows = products(
                        simd,
                        common,
                        |block| [&other[block][half], &other[block][half + 1]],
                        |block| own[block].each_ref(),
                    );
                    for (index, row_of_four) in rows.iter().enumerate() {
                        let place = (1 + 4 * row + half + index, 4 * column);
                        equations.view_mut(place, (1, 4)).copy_from_slice(row_of_four);
                    }
                }
            }
        }
        equations
    }
}

/// Products of lists that are 0 outside of some blocks: every one of `left` with every one of `right`.
///
/// Summed in the order of [`dot`], in which whole blocks are eight sums and what is left is added one by one.
#[inline(always)]
fn products<'a, S: Simd, const M: usize, const N: usize>(
    simd: S,
    blocks: BlockSet,
    left: impl Fn(usize) -> [&'a Block; M],
    right: impl Fn(usize) -> [&'a Block; N],
) -> [[f64; N]; M] {
    let mut sums = [[f64x8::splat(simd, 0.0); N]; M];
    blocks.common(BlockSet::WHOLE).each(|block| {
        let right = right(block).map(|right| right.load(simd));
        for (sums, left) in sums.iter_mut().zip(left(block)) {
            let left = left.load(simd);
            for (sum, right) in sums.iter_mut().zip(right) {
                *sum += left * right;
            }
        }
    });
    let mut products = sums.map(|sums| sums.map(|sum| joined(sum.into())));
    blocks.common(BlockSet::LAST).each(|block| {
        for (sums, left) in products.iter_mut().zip(left(block)) {
            for (sum, right) in sums.iter_mut().zip(right(block)) {
                *sum += left.0[0] * right.0[0];
            }
        }
    });
    products
}

/// The product of two short lists.
#[inline(always)]
fn dot(left: &[f64], right: &[f64]) -> f64 {
    let (wholes, rest) = left.as_chunks::<LANES>();
    let (other_wholes, other_rest) = right.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (left, right) in wholes.iter().zip(other_wholes) {
        for ((sum, left), right) in sums.iter_mut().zip(left).zip(right) {
            *sum += left * right;
        }
    }
    rest.iter().zip(other_rest).fold(joined(sums), |sum, (left, right)| sum + left * right)
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, variables: &DVector<f64>) {
        self.variables = variables.clone();
        self.states = variables.as_slice().as_chunks().0.iter().map(|four| State::new(*four, self.range)).collect();
        dispatch!(*LEVEL, simd => self.evaluate(simd));
    }

    fn params(&self) -> DVector<f64> {
        self.variables.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let mut residuals = DVector::zeros(self.variables.len() + 1);
        residuals[0] = self.norm();
        Some(residuals)
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let mut jacobian = dispatch!(*LEVEL, simd => self.normal_equations(simd));
        let rows = jacobian.nrows();
        // From column to column JᵀJ gives way to R: what is left of the diagonal is not looked at before.
        for column in 0..jacobian.ncols() {
            let (before, from_here) = jacobian.as_mut_slice().split_at_mut(column * rows);
            let own = &mut from_here[..rows];
            for row in 0..=column {
                // Of the product RᵀR without the rows of J' above, this one is the first where R has the column.
                let place = row + 1;
                if row < column {
                    let other = &before[row * rows..][..=place];
                    let above = dot(&other[..place], &own[..place]);
                    let rest = own[place] - above;
                    own[place] = if other[place] > 0.0 { rest / other[place] } else { 0.0 };
                } else {
                    let above = dot(&own[..place], &own[..place]);
                    let rest = own[place] - above;
                    own[place] = if rest > DEPENDENT * (rest + above) { rest.sqrt() } else { 0.0 };
                }
            }
            own[column + 2..].fill(0.0);
        }
        Some(jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::super::spread::spread_exponent;
    use super::*;

    fn peak(amplitude: f64, direction: [f64; 3], exponent: f64) -> FittedPeak {
        FittedPeak { amplitude, direction: DVec3::from(direction).normalize(), exponent }
    }

    impl<'a> Problem<'a> {
        fn of(density: &'a [Block], range: ExponentRange, peaks: &[FittedPeak]) -> Self {
            Self::new(density, range, peaks, Space::default())
        }

        /// The residuals, sample by sample.
        fn rest(&self) -> DVector<f64> {
            DVector::from_iterator(SAMPLES, self.space.residuals.iter().flat_map(|block| block.0).take(SAMPLES))
        }

        /// Their derivatives, sample by sample.
        fn derivatives(&self) -> DMatrix<f64> {
            dispatch!(*LEVEL, simd => self.slopes(simd));
            let slopes = self.space.slopes.borrow();
            let value = |sample: usize, variable: usize| {
                let (peak, block) = (variable / 4, sample / LANES);
                let mut there = false;
                self.space.shares[peak].blocks.each(|other| there |= other == block);
                if there { slopes[peak * BLOCKS + block][variable % 4].0[sample % LANES] } else { 0.0 }
            };
            DMatrix::from_fn(SAMPLES, 4 * self.states.len(), value)
        }
    }

    /// One peak after the other.
    fn no_lobes(_: usize) -> Vec<FittedPeak> {
        Vec::new()
    }

    #[test]
    fn the_jacobian_is_that_of_the_residuals() {
        let range = ExponentRange { low: 0.0, high: libm::log(256.0) };
        // At the pole, near the horizon, below it, and at both ends of the exponents.
        let peaks = [
            peak(0.7, [0.0, 0.0, 1.0], 40.0),
            peak(1.2, [1.0, 0.1, 0.03], 1.1),
            peak(0.3, [-0.4, 0.5, -0.1], 12.0),
            peak(2.0, [0.3, -0.2, 0.9], 250.0),
        ];
        let density = Block::list([0.1; SAMPLES]);
        let problem = Problem::of(&density, range, &peaks);
        let jacobian = problem.derivatives();
        for variable in 0..16 {
            let residuals = |step: f64| {
                let mut moved = Problem::of(&density, range, &peaks);
                let mut variables = moved.params();
                variables[variable] += step;
                moved.set_params(&variables);
                moved.rest()
            };
            let step = 1e-5;
            let numeric = (residuals(step) - residuals(-step)) / (2.0 * step);
            let worst = (numeric - jacobian.column(variable)).abs().max();
            // The third derivative, about n³ ω½ at most, times step²/6.
            assert!(worst < 1e-6, "{variable}: {worst}");
        }
        for (got, wanted) in problem.peaks().iter().zip(peaks) {
            assert!((got.direction - wanted.direction).length() < 1e-12);
            assert!((got.amplitude - wanted.amplitude).abs() < 1e-12);
        }
    }

    #[test]
    fn the_solver_is_led_by_few_rows_as_by_all() {
        let range = ExponentRange { low: 0.0, high: libm::log(256.0) };
        // The third depends on the first: their derivatives are the same.
        let peaks = [
            peak(0.7, [0.0, 0.0, 1.0], 40.0),
            peak(1.2, [1.0, 0.1, 0.3], 1.1),
            peak(0.7, [0.0, 0.0, 1.0], 40.0),
            peak(2.0, [0.3, -0.2, 0.9], 250.0),
        ];
        let wanted = evaluate(&[peak(0.9, [0.2, 0.0, 1.0], 30.0)]);
        // Where nothing is left there is no direction of it either.
        for density in [wanted, evaluate(&peaks)] {
            let density = Block::list(density);
            let problem = Problem::of(&density, range, &peaks);
            let (slopes, few) = (problem.derivatives(), problem.jacobian().expect("derivatives exist everywhere"));
            let rest = problem.residuals().expect("residuals exist everywhere");
            assert_eq!(few.shape(), (17, 16));
            assert!((rest.norm() - problem.rest().norm()).abs() < 1e-15);
            let norms = slopes.column_iter().map(|column| column.norm()).collect::<Vec<_>>();
            let products = slopes.tr_mul(&slopes) - few.tr_mul(&few);
            let towards = slopes.tr_mul(&problem.rest()) - few.tr_mul(&rest);
            for (row, column) in (0..16).flat_map(|row| (0..16).map(move |column| (row, column))) {
                // The root of DEPENDENT, where a column is left out.
                assert!(products[(row, column)].abs() < 1e-6 * norms[row] * norms[column], "{row} {column}");
                assert!(towards[row].abs() < 1e-12 * norms[row] * (1.0 + rest.norm()), "{row}");
            }
        }
    }

    #[test]
    fn separate_peaks_are_found_again() {
        let peaks =
            [peak(0.7, [0.1, 0.0, 1.0], 40.0), peak(0.4, [0.8, 0.1, 0.6], 70.0), peak(0.5, [-0.4, 0.8, 0.5], 30.0)];
        let mut found = fit(&evaluate(&peaks), 64.0, no_lobes);
        assert!(found.rest.is_good());
        found.peaks.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        assert_eq!(found.peaks.len(), 3);
        for (got, wanted) in found.peaks.iter().zip([peaks[0], peaks[2], peaks[1]]) {
            assert!(got.direction.dot(wanted.direction) > 0.9999, "{got:?}");
            // The fit has converged to some percent of the residual, not to the last bit.
            assert!((got.exponent / wanted.exponent - 1.0).abs() < 0.02, "{got:?}");
            assert!((got.amplitude / wanted.amplitude - 1.0).abs() < 0.02, "{got:?}");
        }
    }

    #[test]
    fn a_fit_starts_from_the_fewest_lobes_that_are_near() {
        let wanted: Vec<FittedPeak> = (0..5)
            .map(|index| {
                let (y, x) = libm::sincos(1.2 * f64::from(index));
                peak(0.4 + 0.1 * f64::from(index), [0.8 * x, 0.8 * y, 0.6], 50.0)
            })
            .collect();
        let density = evaluate(&wanted);
        let largest = density.iter().copied().fold(0.0, f64::max);
        let relative: Vec<f64> = density.iter().map(|value| value / largest).collect();
        let few = |most: usize| {
            let lobe = |peak: &FittedPeak| FittedPeak { amplitude: peak.amplitude / largest, ..*peak };
            wanted.iter().take(most).map(lobe).collect::<Vec<_>>()
        };
        assert_eq!(start(&relative, few).len(), 5);
        // Where two are near, one may be; where none are, all there may be are the start.
        assert!(start(&relative, |_| few(5)).is_empty());
        assert_eq!(start(&relative, |most| few(most.min(4))).len(), 4);
        // What lobes are good for is the time: the same peaks are found from none.
        let lobes = |most: usize| wanted.iter().take(most).copied().collect();
        for fit in [fit(&density, 64.0, lobes), fit(&density, 64.0, no_lobes)] {
            assert!(fit.rest.is_good() && fit.peaks.len() == 5);
        }
    }

    #[test]
    fn a_fit_keeps_the_energy_of_any_density() {
        let hemisphere = &*HEMISPHERE;
        let densities: [fn(DVec3) -> f64; 4] =
            [|_| 1.0, |at| at.z, |at| f64::from(at.x > 0.3), |at| (1.0 - at.y * at.y).powi(20)];
        for density in densities {
            let density: Vec<f64> = hemisphere.directions.iter().map(|at| 100.0 * density(*at)).collect();
            let fit = fit(&density, spread_exponent(20.0), no_lobes);
            let energy = |values: Vec<f64>| hemisphere.integral(values);
            let ratio = energy(evaluate(&fit.peaks)) / energy(density);
            // Invisible peaks are left out.
            assert!((ratio - 1.0).abs() < 1e-5, "{ratio}");
            assert!(fit.peaks.len() <= MAX_PEAKS && fit.peaks.iter().all(|peak| peak.direction.is_normalized()));
        }
        assert!(fit(&[0.0; SAMPLES], 20.0, no_lobes).peaks.is_empty());
    }
}
