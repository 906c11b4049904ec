//! Horizon (F92 §5, erratum 22): the share of the facets of a peak that light and eye clear, along two axes each.

use super::linear::Vector3;

/// The horizon on one side, as the law of its slopes: they begin at `low` and end at `low + width`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// The least slope, height per distance.
    pub low: f64,
    /// Width of the law ≥ 0; 0 is a step.
    pub width: f64,
}

impl Side {
    /// The uniform law of a mean and a standard deviation: ±√3σ.
    pub fn uniform(mean: f64, sigma: f64) -> Self {
        let reach = 3_f64.sqrt() * sigma;
        Self { low: mean - reach, width: 2.0 * reach }
    }
}

/// Reach of a slope on one side, in [0, 1]; a step is reached from its slope on.
pub fn ramp(slope: f64, side: Side) -> f64 {
    if side.width <= 0.0 {
        return if slope >= side.low { 1.0 } else { 0.0 };
    }
    ((slope - side.low) / side.width).clamp(0.0, 1.0)
}

/// Ramps of a local direction (x, y, z) of any length over both axes, given the horizons towards −x, +x, −y, +y. An axis along which the direction
/// does not point is clear.
pub fn ramps(direction: Vector3, sides: &[Side; 4]) -> [f64; 2] {
    let [x, y, z] = direction;
    let along = |component: f64, [negative, positive]: [Side; 2]| match component {
        0.0 => 1.0,
        _ => ramp(z / component.abs(), if component < 0.0 { negative } else { positive }),
    };
    [along(x, [sides[0], sides[1]]), along(y, [sides[2], sides[3]])]
}

/// Share of facets that clear every direction, from all ramps t, for laws that fall linearly: 1 − (1 − t)². A facet in a hole is in the hole for
/// every direction. So most facets that the smallest share clears are clear; the next share removes a quarter of what it hides.
pub fn correlated(ramps: &[f64]) -> f64 {
    let mut shares: Vec<f64> = ramps.iter().map(|t| t * (2.0 - t)).chain([1.0, 1.0]).collect();
    shares.sort_by(f64::total_cmp);
    shares[0] * (3.0 + shares[1]) / 4.0
}

/// Share of facets for independent uniform laws (F92 §5).
pub fn product(ramps: &[f64]) -> f64 {
    ramps.iter().product()
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn shares_are_as_worked_by_hand() {
        let flat = Side { low: 0.0, width: 0.0 };
        let hill = Side { low: 0.0, width: 2.0 };
        // z/|x| = 1 on a ramp from 0 to 2, towards −x only.
        assert_eq!(ramps([-2.0, 0.0, 2.0], &[hill, flat, flat, flat]), [0.5, 1.0]);
        assert_eq!(ramps([2.0, 0.0, 2.0], &[hill, flat, flat, flat]), [1.0, 1.0]);
        assert_eq!(ramps([-2.0, -1.0, 0.5], &[hill, flat, hill, flat]), [0.125, 0.25]);
        assert_eq!((product(&[0.5, 0.25, 1.0]), correlated(&[0.5, 0.25, 1.0])), (0.125, 0.4375 * 3.75 / 4.0));
        // A step is visible at its slope itself, and straight up everything is.
        assert_eq!(ramps([1.0, 1.0, 0.0], &[flat; 4]), [1.0; 2]);
        assert_eq!(ramps([1.0, 1.0, -1e-9], &[flat; 4]), [0.0; 2]);
        assert_eq!(ramps([0.0, 0.0, -1.0], &[hill; 4]), [1.0; 2]);
        // Steps alone: both rules agree.
        assert!([[0.0, 1.0], [1.0, 1.0]].iter().all(|shares| product(shares) == correlated(shares)));
    }

    /// Erratum 22: ±√3σ is the law of the same variance; against the normal law it errs by .057, ±σ by .159.
    #[test]
    fn the_uniform_ramp_is_near_the_normal_law() {
        let mut random = SplitMix64::new(22);
        let mut normal: Vec<f64> = (0..200_000).map(|_| random.normal()).collect();
        normal.sort_by(f64::total_cmp);
        let worst = |reach: f64| {
            let share = |index: usize| (index as f64 + 0.5) / normal.len() as f64;
            let side = Side::uniform(0.0, reach / 3_f64.sqrt());
            let errors = normal.iter().enumerate().map(|(index, &slope)| (share(index) - ramp(slope, side)).abs());
            errors.fold(0.0, f64::max)
        };
        assert!((worst(3_f64.sqrt()) - 0.057).abs() < 0.005, "{}", worst(3_f64.sqrt()));
        assert!((worst(1.0) - 0.159).abs() < 0.005, "{}", worst(1.0));
    }
}
