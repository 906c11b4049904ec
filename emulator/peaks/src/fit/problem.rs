//! Least-squares problem of a fit: peaks in unbounded variables, residuals and derivatives.

use std::cell::RefCell;

use fearless_simd::prelude::*;
use fearless_simd::{dispatch, f64x8};
use glam::DVec3;
use levenberg_marquardt::LeastSquaresProblem;
use nalgebra::{DMatrix, DVector, Dyn, Owned};

use super::products::{BlockSet, dot, products};
use crate::blocks::{self, Block, LEVEL, cosines, log_powers, powers};
use crate::spread::{BLOCKS, HEMISPHERE, SAMPLES, power};

/// Share of a derivative's square that is rounding if it depends on the earlier ones.
const DEPENDENT: f64 = 1e-13;

/// One peak of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FittedPeak {
    pub(crate) amplitude: f64,
    /// Unit vector.
    pub(crate) direction: DVec3,
    pub(crate) exponent: f64,
}

impl FittedPeak {
    /// Largest value on the hemisphere: at the direction, or at the horizon if the peak points below it.
    pub(super) fn highest(&self) -> f64 {
        let cos = if self.direction.z > 0.0 { 1.0 } else { self.direction.truncate().length() };
        self.amplitude * power(cos, self.exponent)
    }
}

/// Σ a cosⁿα at every sample.
pub(super) fn evaluate(peaks: &[FittedPeak]) -> Vec<f64> {
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

/// Range of ln n.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExponentRange {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl ExponentRange {
    /// The exponent, pulled away from the ends, at which ν is infinite.
    pub(super) fn inside(self, exponent: f64) -> f64 {
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

/// One peak in the variables of the solver, with the values that are equal for all samples.
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

/// Residuals √ω (Σ a cosⁿα − N) over the samples, given to the solver as a problem of few rows.
///
/// The solver sees residuals r through |r|, Jᵀr and JᵀJ alone. So r' = (|r|, 0, …) and J' = (rᵀJ/|r|; R) with RᵀR = JᵀJ
/// − (rᵀJ)ᵀ(rᵀJ)/|r|² lead to the same steps. Factorisation of J takes two thirds of a build; J' has 4k + 1 rows
/// instead of 1297.
///
/// Samples are in blocks. A peak is evaluated only in blocks in which it is not negligible; omitted blocks add zeros.
pub(super) struct Problem<'a> {
    density: &'a [Block],
    range: ExponentRange,
    variables: DVector<f64>,
    states: Vec<State>,
    pub(super) space: Space,
}

/// Working memory of a problem for every block, passed from one problem to the next.
#[derive(Default)]
pub(super) struct Space {
    /// Shares of every peak.
    shares: Vec<Shares>,
    residuals: Vec<Block>,
    /// Derivatives of the residuals by the four variables of every peak: peak · BLOCKS + block, in the peak's blocks.
    slopes: RefCell<Vec<[Block; 4]>>,
}

/// Values of a peak at every sample.
struct Shares {
    blocks: BlockSet,
    /// cosⁿα and, unless it is 0, ln cosⁿα, in these blocks.
    powers: Vec<[Block; 2]>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(density: &'a [Block], range: ExponentRange, peaks: &[FittedPeak], mut space: Space) -> Self {
        let variables = peaks.iter().flat_map(|peak| {
            // A peak straight down has no stereographic coordinates; a direction next to it has.
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

    pub(super) fn peaks(&self) -> Vec<FittedPeak> {
        let peak = |state: &State| FittedPeak {
            amplitude: state.root * state.root,
            direction: state.direction.normalize(),
            exponent: state.exponent,
        };
        self.states.iter().map(peak).collect()
    }

    /// Evaluates shares of all peaks, and residuals.
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
            // Logarithms first, then exponentials: two short runs of dependent operations overlap from block to block, one long run does not.
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

    /// Evaluates derivatives of the residuals by the variables.
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
                // If the cosine is 0 or below, the share is 0.
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
            // A residual of 0 has no direction.
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
                // Two rows of four: eight sums, which fit the registers of every instruction set.
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
        // R replaces JᵀJ column by column; entries below the diagonal are not read before they are written.
        for column in 0..jacobian.ncols() {
            let (before, from_here) = jacobian.as_mut_slice().split_at_mut(column * rows);
            let own = &mut from_here[..rows];
            for row in 0..=column {
                // This row is the first of the product RᵀR, without the rows of J' above, in which R has the column.
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
pub(super) mod tests {
    use super::*;
    use crate::blocks::LANES;

    pub(crate) fn peak(amplitude: f64, direction: [f64; 3], exponent: f64) -> FittedPeak {
        FittedPeak { amplitude, direction: DVec3::from(direction).normalize(), exponent }
    }

    impl<'a> Problem<'a> {
        fn from_peaks(density: &'a [Block], range: ExponentRange, peaks: &[FittedPeak]) -> Self {
            Self::new(density, range, peaks, Space::default())
        }

        /// The residuals, sample by sample.
        fn rest(&self) -> DVector<f64> {
            DVector::from_iterator(SAMPLES, self.space.residuals.iter().flat_map(|block| block.0).take(SAMPLES))
        }

        /// Derivatives of the residuals, sample by sample.
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

    #[test]
    fn the_jacobian_is_that_of_the_residuals() {
        let range = ExponentRange { low: 0.0, high: libm::log(256.0) };
        // Peaks at the pole, near the horizon, below it, and at both ends of the exponents.
        let peaks = [
            peak(0.7, [0.0, 0.0, 1.0], 40.0),
            peak(1.2, [1.0, 0.1, 0.03], 1.1),
            peak(0.3, [-0.4, 0.5, -0.1], 12.0),
            peak(2.0, [0.3, -0.2, 0.9], 250.0),
        ];
        let density = Block::list([0.1; SAMPLES]);
        let problem = Problem::from_peaks(&density, range, &peaks);
        let jacobian = problem.derivatives();
        for variable in 0..16 {
            let residuals = |step: f64| {
                let mut moved = Problem::from_peaks(&density, range, &peaks);
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
        // The third peak depends on the first: their derivatives are equal.
        let peaks = [
            peak(0.7, [0.0, 0.0, 1.0], 40.0),
            peak(1.2, [1.0, 0.1, 0.3], 1.1),
            peak(0.7, [0.0, 0.0, 1.0], 40.0),
            peak(2.0, [0.3, -0.2, 0.9], 250.0),
        ];
        let wanted = evaluate(&[peak(0.9, [0.2, 0.0, 1.0], 30.0)]);
        // A residual of 0 has no direction.
        for density in [wanted, evaluate(&peaks)] {
            let density = Block::list(density);
            let problem = Problem::from_peaks(&density, range, &peaks);
            let (slopes, few) = (problem.derivatives(), problem.jacobian().expect("derivatives exist everywhere"));
            let rest = problem.residuals().expect("residuals exist everywhere");
            assert_eq!(few.shape(), (17, 16));
            assert!((rest.norm() - problem.rest().norm()).abs() < 1e-15);
            let norms = slopes.column_iter().map(|column| column.norm()).collect::<Vec<_>>();
            let products = slopes.tr_mul(&slopes) - few.tr_mul(&few);
            let towards = slopes.tr_mul(&problem.rest()) - few.tr_mul(&rest);
            for (row, column) in (0..16).flat_map(|row| (0..16).map(move |column| (row, column))) {
                // Root of DEPENDENT, for an omitted column.
                assert!(products[(row, column)].abs() < 1e-6 * norms[row] * norms[column], "{row} {column}");
                assert!(towards[row].abs() < 1e-12 * norms[row] * (1.0 + rest.norm()), "{row}");
            }
        }
    }
}
