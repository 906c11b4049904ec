//! Footprint assembly: N probes along the major axis at the level of the minor one (W97 end, S97 §2).
//!
//! A pixel box of standard deviation λ is 2√3·λ wide (erratum 4), so 2√3·λ₁ is the major and 2√3·λ₂ the minor diameter. N·step = the major diameter;
//! LOD = log₂ of the minor diameter in texels, clamped to the map's levels. If the rule asks for more than the most probes, λ₂ is raised to λ₁/N:
//! blurred, never aliased.

use super::axes::Axes;
use super::linear::{Vector2, scaled};

/// Rule for the probe count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeRule {
    /// N = ⌈λ₁/λ₂⌉.
    Ceiling,
    /// N = the smallest power of two that is at least λ₁/λ₂.
    PowerOfTwo,
}

/// Weights of the probes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeWeights {
    /// All equal.
    Box,
    /// wᵢ ∝ exp(−1.5·((2i−N+1)/N)²), the normal law of standard deviation λ₁ at the probes.
    Gaussian,
}

/// Probes of a map: positions and level of detail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbePlan {
    /// Probe count N, at least 1.
    pub count: u32,
    /// Step from one probe to the next, in the units of the axes.
    pub step: Vector2,
    /// λ₂ after the cap, in the units of the axes.
    pub minor: f64,
    /// True if the rule asked for more probes than allowed.
    pub capped: bool,
    /// Level of detail, 0…⌊log₂ of the longer edge⌋.
    pub lod: f64,
    /// Level of detail before the clamp; −∞ for a footprint without extent.
    pub lod_unclamped: f64,
}

impl ProbePlan {
    /// Offset of probe `index` = 0…N−1 from the centre of the footprint: (i − (N−1)/2)·step.
    pub fn offset(&self, index: u32) -> Vector2 {
        scaled(f64::from(index) - 0.5 * f64::from(self.count - 1), self.step)
    }
}

/// A ratio this close above an integer is that integer: λ₁/λ₂ of an exact circle must not round up to two probes.
const RATIO_SLACK: f64 = 1.0 / (1_u64 << 40) as f64;

/// Probes of an ellipse.
///
/// `texels_per_unit` converts the unit of the axes to texels of level 0 (half the edge for a cube face). `longer_edge_texels` ≥ 1 bounds the levels.
/// `max_probes` ≥ 1 bounds the count; the power-of-two rule uses the largest power in it.
pub fn plan(axes: &Axes, texels_per_unit: f64, longer_edge_texels: u32, rule: ProbeRule, max_probes: u32) -> ProbePlan {
    let (wanted, most) = match rule {
        ProbeRule::Ceiling => (probe_ceiling(axes.ratio()), max_probes),
        ProbeRule::PowerOfTwo => (
            (probe_ceiling(axes.ratio()).min(2_f64.powi(40)) as u64).next_power_of_two() as f64,
            1 << max_probes.ilog2(),
        ),
    };
    let capped = wanted > f64::from(most);
    let count = if capped { most } else { wanted as u32 };
    let minor = if capped { axes.major / f64::from(count) } else { axes.minor };
    let diameter = 2.0 * 3_f64.sqrt();
    let lod_unclamped = (diameter * minor * texels_per_unit).log2();
    ProbePlan {
        count,
        step: scaled(diameter * axes.major / f64::from(count), axes.direction),
        minor,
        capped,
        lod: lod_unclamped.clamp(0.0, f64::from(longer_edge_texels.ilog2())),
        lod_unclamped,
    }
}

fn probe_ceiling(ratio: f64) -> f64 {
    (ratio * (1.0 - RATIO_SLACK)).ceil().max(1.0)
}

/// Weights of `count` probes, summing to 1.
pub fn weights(count: u32, kind: ProbeWeights) -> Vec<f64> {
    let n = f64::from(count);
    let raw = |i: u32| match kind {
        ProbeWeights::Box => 1.0,
        ProbeWeights::Gaussian => {
            let position = (2.0 * f64::from(i) - n + 1.0) / n;
            (-1.5 * position * position).exp()
        }
    };
    let total: f64 = (0..count).map(raw).sum();
    (0..count).map(|i| raw(i) / total).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes_of(major: f64, minor: f64) -> Axes {
        Axes { major, minor, direction: [0.6, 0.8] }
    }

    #[test]
    fn rules_round_up_and_cap() {
        let count = |ratio: f64, rule, max| plan(&axes_of(ratio, 1.0), 1.0, 64, rule, max).count;
        let expected =
            [(1.0, 1, 1), (1.01, 2, 2), (2.0, 2, 2), (2.1, 3, 4), (5.0, 5, 8), (15.5, 16, 16), (17.0, 16, 16)];
        for (ratio, ceiling, power) in expected {
            assert_eq!(count(ratio, ProbeRule::Ceiling, 16), ceiling, "{ratio}");
            assert_eq!(count(ratio, ProbeRule::PowerOfTwo, 16), power, "{ratio}");
        }
        assert_eq!(count(1e9, ProbeRule::PowerOfTwo, 12), 8);
        assert_eq!(plan(&axes_of(1.0, 0.0), 1.0, 64, ProbeRule::Ceiling, 16).count, 16);
    }

    #[test]
    fn a_pixel_box_is_covered_from_end_to_end() {
        // A footprint of 8 × 2 texels: σ = width/√12.
        let sigma = |width: f64| width / 12_f64.sqrt();
        let plan = plan(&axes_of(sigma(8.0), sigma(2.0)), 1.0, 64, ProbeRule::Ceiling, 16);
        assert_eq!(plan.count, 4);
        assert!((plan.lod - 1.0).abs() < 1e-15);
        // Centres at −3, −1, 1, 3 texels along (.6, .8).
        for (i, at) in [-3.0, -1.0, 1.0, 3.0].into_iter().enumerate() {
            let [x, y] = plan.offset(i as u32);
            assert!((x - 0.6 * at).abs() < 1e-14 && (y - 0.8 * at).abs() < 1e-14);
        }
    }

    #[test]
    fn a_capped_footprint_is_blurred_not_aliased() {
        let plan = plan(&axes_of(32.0, 0.5), 1.0, 1024, ProbeRule::Ceiling, 16);
        assert!(plan.capped);
        assert_eq!(plan.minor, 2.0);
        let step = plan.step[0].hypot(plan.step[1]);
        assert!((step - plan.lod_unclamped.exp2()).abs() < 1e-12, "probes touch");
    }

    #[test]
    fn levels_are_clamped_to_the_map() {
        let lod = |minor: f64, edge| plan(&axes_of(minor, minor), 1.0, edge, ProbeRule::Ceiling, 16).lod;
        assert_eq!(lod(0.0, 256), 0.0);
        assert_eq!(lod(1e9, 256), 8.0);
        assert_eq!(lod(1e9, 300), 8.0);
        assert_eq!(lod(1e9, 1), 0.0);
    }

    #[test]
    fn gaussian_weights_follow_the_normal_law_and_sum_to_one() {
        for count in 1..=64 {
            for kind in [ProbeWeights::Box, ProbeWeights::Gaussian] {
                let weights = weights(count, kind);
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                assert!((weights[0] - weights[count as usize - 1]).abs() < 1e-16);
            }
        }
        // Two probes at ±½ of the half diameter √3·λ₁; three at 0 and ±⅔: exp(−1.5·4/9).
        let three = weights(3, ProbeWeights::Gaussian);
        assert!((three[0] / three[1] - (-2.0_f64 / 3.0).exp()).abs() < 1e-15);
    }
}
