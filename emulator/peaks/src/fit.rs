//! Fit of a density by a few peaks Σ a cosⁿα (F92 §2.3): non-linear least squares, one more peak at a time.
//!
//! A peak is guessed at the maximum of the residual, with an exponent from the fall-off to the neighbours. Levenberg and Marquardt then
//! fit all peaks together, with an analytic Jacobian and every sample weighted by its solid angle. If lobes of a few clusters of facets
//! (`clusters`) are far from the density, a fit of equally many peaks is far from it as well. The fit therefore starts from the fewest
//! lobes that are near.
//!
//! A peak has four variables, none of them bounded for the solver: √a, two stereographic coordinates of the direction, and ν. In the
//! coordinates one length means one angle anywhere on the hemisphere, and the pole is no special place. ln n runs through low … high as
//! ν/√(1 + ν²) runs from −1 to 1. After every fit the amplitudes are scaled to the energy of the density (erratum 24).

mod problem;
mod products;

use levenberg_marquardt::LevenbergMarquardt;

pub(super) use self::problem::FittedPeak;
use self::problem::{ExponentRange, Problem, Space, evaluate};
use super::blocks::Block;
use super::spread::{HEMISPHERE, SAMPLES, neighbours};

/// Most peaks of a fit.
pub(super) const MAX_PEAKS: usize = 7;
/// Residual of a good fit as a share of the density, root mean square and maximum.
pub(super) const GOOD: f64 = 0.05;
/// Relative reduction of the sum of squares at which a fit has converged.
///
/// A photograph of 128² with slopes of 1 and facets of exponent 20 has 1365 fits:
///
/// | tolerance | fits that miss [`GOOD`] | peaks |
/// |---|---|---|
/// | 5e-3 | 306 | 40 274 |
/// | 1e-4 (40 % more time) | 299 | 40 263 |
///
/// With 1e-2 the largest residual of a weave (`host-tests/tests/pictures/peak_pyramid.rs`) is 0.115 of its maximum, not 0.095.
const TOLERANCE: f64 = 5e-3;
/// Largest residual of cluster lobes that a fit may start from, in multiples of [`GOOD`]. For the photograph of [`TOLERANCE`], 2 gives 0.4 % more
/// peaks; 3 gives 0.2 % fewer, in 10 % more time.
const NEAR: f64 = 2.5;
/// Most evaluations of a fit, in multiples of its variables + 1.
const PATIENCE: usize = 4;
/// Share of the density's maximum that a peak must reach on the hemisphere; a lower peak is omitted.
const INVISIBLE: f64 = 1e-6;

/// Peaks and their residual of a density.
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

    /// True if the residual is small enough.
    pub(super) fn is_good(self) -> bool {
        self.is_below(GOOD)
    }
}

/// Fits a density spread with `spread_exponent`; no peaks if the density is 0 everywhere.
///
/// `lobes` gives at most as many peaks as asked for, with the density's energy together: possible starting points.
pub(super) fn fit(density: &[f64], spread_exponent: f64, lobes: impl Fn(usize) -> Vec<FittedPeak>) -> Fit {
    let largest = density.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Fit::default();
    }
    // A single facet has exactly the exponent it was spread with, so that must not be the end of the range.
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

/// Starting peaks of a fit: the lobes of the fewest clusters that are near a density of the maximum 1. If none are near, all
/// lobes are taken.
///
/// No peaks if two lobes are near: one or two fitted peaks may then suffice, and take no time.
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

/// Scales peaks to the energy of a density of the maximum 1. Returns the residual, sample by sample and in all.
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

/// A peak at the maximum of a residual, with a width from its neighbours.
fn guess(residual: &[f64], range: ExponentRange) -> FittedPeak {
    let sample = (0..SAMPLES).fold(0, |best, sample| if residual[sample] > residual[best] { sample } else { best });
    let direction = HEMISPHERE.directions[sample];
    let amplitude = residual[sample].max(INVISIBLE);
    // ln of the fall-off over ln of the cosine; both sums are over the same neighbours, so far neighbours count more.
    let (mut fall, mut cosine) = (0.0, 0.0);
    for neighbour in neighbours(sample) {
        fall += libm::log((residual[neighbour] / amplitude).clamp(0.01, 1.0));
        cosine += libm::log(direction.dot(HEMISPHERE.directions[neighbour]));
    }
    FittedPeak { amplitude, direction, exponent: range.inside(fall / cosine) }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::problem::tests::peak;
    use super::*;
    use crate::spread::spread_exponent;

    /// Starting points without lobes: peaks are fitted one after the other.
    fn no_lobes(_: usize) -> Vec<FittedPeak> {
        Vec::new()
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
            // The fit converges to some percent of the residual, not to the last bit.
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
        // If two lobes are near, no start is needed; if none are near, all are the start.
        assert!(start(&relative, |_| few(5)).is_empty());
        assert_eq!(start(&relative, |most| few(most.min(4))).len(), 4);
        // Lobes save time: the same peaks are found without them.
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
            // Invisible peaks are omitted.
            assert!((ratio - 1.0).abs() < 1e-5, "{ratio}");
            assert!(fit.peaks.len() <= MAX_PEAKS && fit.peaks.iter().all(|peak| peak.direction.is_normalized()));
        }
        assert!(fit(&[0.0; SAMPLES], 20.0, no_lobes).peaks.is_empty());
    }
}
