//! Distribution of errors.

/// Bins of an octave in a [`Distribution`].
const BINS_PER_OCTAVE: f64 = 32.0;
/// Smallest and largest error that bins distinguish, log₂.
const OCTAVES: [i32; 2] = [-64, 16];

/// Distribution of errors: their sum, and the number in each 32nd of an octave.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Distribution {
    sum: f64,
    bins: Vec<u64>,
}

impl Distribution {
    pub(crate) fn add(&mut self, error: f64) {
        self.sum += error;
        let [low, high] = OCTAVES.map(f64::from);
        // NaN is worse than any number.
        let octave = if error.is_nan() { high } else { error.log2().clamp(low, high) };
        let bin = ((octave - low) * BINS_PER_OCTAVE) as usize;
        self.bins.resize(self.bins.len().max(bin + 1), 0);
        self.bins[bin] += 1;
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.sum += other.sum;
        self.bins.resize(self.bins.len().max(other.bins.len()), 0);
        for (mine, theirs) in self.bins.iter_mut().zip(&other.bins) {
            *mine += theirs;
        }
    }

    pub(crate) fn count(&self) -> u64 {
        self.bins.iter().sum()
    }

    /// The mean; `None` without errors.
    pub(crate) fn mean(&self) -> Option<f64> {
        let count = self.count();
        (count > 0).then(|| self.sum / count as f64)
    }

    /// The upper end of the bin below which this share of the errors lies; `None` without errors.
    pub(crate) fn quantile(&self, share: f64) -> Option<f64> {
        let below = (share * self.count() as f64).ceil() as u64;
        let mut sum = 0;
        let bin = self.bins.iter().position(|bin| {
            sum += bin;
            sum >= below.max(1)
        })?;
        Some((f64::from(OCTAVES[0]) + (bin + 1) as f64 / BINS_PER_OCTAVE).exp2())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distribution(errors: impl IntoIterator<Item = f64>) -> Distribution {
        let mut all = Distribution::default();
        errors.into_iter().for_each(|error| all.add(error));
        all
    }

    #[test]
    fn a_quantile_is_the_error_of_that_rank_to_the_next_32nd_of_an_octave() {
        let bin = (1.0 / BINS_PER_OCTAVE).exp2();
        let errors = distribution((1..=1000).map(f64::from));
        for (share, rank) in [(0.0, 1.0), (0.001, 1.0), (0.5, 500.0), (0.999, 999.0), (1.0, 1000.0)] {
            let quantile = errors.quantile(share).expect("there are errors");
            assert!(rank < quantile && quantile <= rank * bin, "{share}: {quantile}");
        }
    }

    #[test]
    fn one_error_in_a_thousand_does_not_raise_what_nearly_all_stay_below() {
        let with = |large: usize| distribution((0..1000).map(|i| if i < large { 1.0 } else { 0.001 }));
        assert!(with(1).quantile(0.999) < Some(0.0011) && with(2).quantile(0.999) > Some(1.0));
    }

    #[test]
    fn a_mean_is_that_of_the_errors_themselves() {
        assert_eq!(distribution([0.0, 0.25, 0.5, 3.25]).mean(), Some(1.0));
        assert!(distribution([1.0, f64::NAN]).mean().is_some_and(f64::is_nan));
    }

    #[test]
    fn of_no_errors_nothing_is_told() {
        let none = Distribution::default();
        assert_eq!((none.mean(), none.quantile(0.5)), (None, None));
    }

    #[test]
    fn errors_beyond_the_bins_count_in_the_last_of_them() {
        let [low, high] = OCTAVES.map(|octave| f64::from(octave).exp2());
        assert!(distribution([0.0]).quantile(1.0).is_some_and(|error| low < error && error < 1.1 * low));
        for error in [f64::NAN, f64::INFINITY, 2.0 * high] {
            assert!(distribution([0.0, error]).quantile(1.0).is_some_and(|error| error > high), "{error}");
        }
    }

    #[test]
    fn merged_parts_are_the_distribution_of_the_whole() {
        let errors = [0.25, 1e-9, 3.0, 0.5, 0.0, 1024.0];
        for middle in 0..=errors.len() {
            let (first, second) = errors.split_at(middle);
            let mut merged = distribution(first.iter().copied());
            merged.merge(&distribution(second.iter().copied()));
            assert_eq!(merged.bins, distribution(errors).bins);
            assert!((merged.sum - 1027.75).abs() < 1e-6);
        }
    }
}
