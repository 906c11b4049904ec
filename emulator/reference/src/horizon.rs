//! Horizon (F92 §5, erratum 22): which share of the facets of a peak a direction clears, along two axes.

use super::linear::Vector3;

/// Slopes of the horizon on one side: their mean and standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// μ, height per distance.
    pub mean: f64,
    /// σ ≥ 0; 0 is a step.
    pub sigma: f64,
}

/// The share of a uniform law of slopes that lies below `slope`: a ramp over ±√3σ, or a step, visible from μ on.
pub fn ramp(slope: f64, side: Side) -> f64 {
    if side.sigma <= 0.0 {
        return if slope >= side.mean { 1.0 } else { 0.0 };
    }
    let reach = 3_f64.sqrt() * side.sigma;
    ((slope - (side.mean - reach)) / (2.0 * reach)).clamp(0.0, 1.0)
}

/// The share that a local direction (x, y, z) of any length clears, given the horizons towards −x, +x, −y, +y: the product
/// over both axes. An axis along which the direction does not point is clear.
pub fn visibility(direction: Vector3, sides: &[Side; 4]) -> f64 {
    let [x, y, z] = direction;
    let along = |component: f64, [negative, positive]: [Side; 2]| match component {
        0.0 => 1.0,
        _ => ramp(z / component.abs(), if component < 0.0 { negative } else { positive }),
    };
    along(x, [sides[0], sides[1]]) * along(y, [sides[2], sides[3]])
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn visibility_is_as_worked_by_hand() {
        let flat = Side { mean: 0.0, sigma: 0.0 };
        let hill = Side { mean: 1.0, sigma: 1.0 / 3_f64.sqrt() };
        // z/|x| = 1 on a ramp from 0 to 2, towards −x only.
        assert!((visibility([-2.0, 0.0, 2.0], &[hill, flat, flat, flat]) - 0.5).abs() < 1e-15);
        assert_eq!(visibility([2.0, 0.0, 2.0], &[hill, flat, flat, flat]), 1.0);
        assert!((visibility([-2.0, -1.0, 0.5], &[hill, flat, hill, flat]) - 0.125 * 0.25).abs() < 1e-15);
        // A step is visible at μ itself, and straight up everything is.
        assert_eq!(visibility([1.0, 1.0, 0.0], &[flat; 4]), 1.0);
        assert_eq!(visibility([1.0, 1.0, -1e-9], &[flat; 4]), 0.0);
        assert_eq!(visibility([0.0, 0.0, -1.0], &[hill; 4]), 1.0);
    }

    /// Erratum 22: ±√3σ is the law of the same variance; against the normal law it errs by .057, ±σ by .159.
    #[test]
    fn the_ramp_has_the_variance_of_the_law_it_stands_for() {
        let mut random = SplitMix64::new(22);
        let mut normal: Vec<f64> = (0..200_000).map(|_| random.normal()).collect();
        normal.sort_by(f64::total_cmp);
        let worst = |reach: f64| {
            let share = |index: usize| (index as f64 + 0.5) / normal.len() as f64;
            let side = Side { mean: 0.0, sigma: reach / 3_f64.sqrt() };
            let errors = normal.iter().enumerate().map(|(index, &slope)| (share(index) - ramp(slope, side)).abs());
            errors.fold(0.0, f64::max)
        };
        assert!((worst(3_f64.sqrt()) - 0.057).abs() < 0.005, "{}", worst(3_f64.sqrt()));
        assert!((worst(1.0) - 0.159).abs() < 0.005, "{}", worst(1.0));
    }
}
