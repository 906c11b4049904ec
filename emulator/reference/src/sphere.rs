//! Footprints on the sphere: normals as probes, for lobes that no plane of a cube face can hold.
//!
//! A lobe is a distribution of normals n + Σ ξ_j·dn_j and views v + Σ ξ_j·dv_j with independent ξ_j of variance 1 (1/12 for the sides of a pixel). On
//! the tangent plane at r its reflections have the covariance Σ q_j q_jᵀ with q_j = dr_j/|r| without its part along r. Along the major axis, the mean
//! of ξ_j is w_j = ⟨q_j·e₁⟩/λ₁ for each deviation. So the normals there are n + x·a with a = Σ w_j·dn_j. Their reflections, with the views moving
//! along, are r + x·Σ w_j·dr_j + x²·(2a⟨v·a⟩ − v|a|²).

use std::sync::OnceLock;

use super::axes::{Axes, axes};
use super::columns::reflected_derivative;
use super::cube::{Selection, select};
use super::ellipse::{WEIGHTS, ellipse};
use super::linear::{Vector3, add_scaled, cross, dot, norm, scaled};
use super::probes::ProbeRule;
use super::reflect::reflect;
use super::{Inputs, Mirror, Options, mirror};

/// A footprint on the sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct Lobe {
    /// r at unit length.
    pub mirrored: Vector3,
    /// r, moved by the effect of the probes' extent on the mean, in units of |r|.
    pub centre: Vector3,
    /// Σ w_j·dr_j over |r|, for one deviation of the probes.
    pub first: Vector3,
    /// 2a⟨v·a⟩ − v|a|² over |r|, for one squared deviation of the probes.
    pub second: Vector3,
    /// λ₁, radians.
    pub major: f64,
    /// λ₂ before it may be raised, radians.
    pub minor: f64,
    /// |dr|/|r| as if no terms cancelled, weighted as in the covariance. Rounding moves λ by a small multiple of ε times this.
    pub scale: f64,
    /// The probes.
    pub probes: Vec<LobeProbe>,
}

/// A probe on the sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeProbe {
    /// Point of the cube that it samples; `m` in units of |r|.
    pub at: Selection,
    /// Weight; those of a lobe sum to 1.
    pub weight: f64,
    /// Level of detail before it is clamped to the map.
    pub lod: f64,
}

/// Lobe of a fragment; `None` if nothing is reflected.
pub fn lobe(inputs: &Inputs, options: &Options) -> Option<Lobe> {
    let Mirror { view, perturbed: normal, reflected: r, pairs, .. } = mirror(inputs, options);
    let length = norm(&r);
    if length == 0.0 {
        return None;
    }
    let moves = pairs.map(|[dv, dn]| scaled(1.0 / length, reflected_derivative(view, normal, dv, dn)));

    // Any two unit vectors across r.
    let unit = scaled(1.0 / length, r);
    let least = (0..3).min_by(|&i, &j| unit[i].abs().total_cmp(&unit[j].abs())).unwrap_or(0);
    let mut helper = [0.0; 3];
    helper[least] = 1.0;
    let across = cross(unit, helper);
    let across = scaled(1.0 / norm(&across), across);
    let up = cross(unit, across);
    let columns = moves.map(|dr| [dot(&across, &dr), dot(&up, &dr)]);

    let axes = axes(&ellipse(&columns));
    let texels = 0.5 * f64::from(inputs.edge_texels);
    let reach = (axes.major * axes.major - axes.minor * axes.minor).max(0.0).sqrt();
    let Rule { count, share, minor } = rule(reach, &axes, options);
    let spread = (axes.major * axes.major - minor * minor).max(0.0).sqrt();
    let (mut first, mut turn) = ([0.0; 3], [0.0; 3]);
    if axes.major > 0.0 {
        for (j, q) in columns.iter().enumerate() {
            let share = WEIGHTS[j] * dot(q, &axes.direction) / axes.major * (spread / axes.major);
            first = add_scaled(first, share, moves[j]);
            turn = add_scaled(turn, share, pairs[j][1]);
        }
    }
    let second = scaled(1.0 / length, reflect(view, turn));
    // E[r] = r + Σ W_j(2dn_j⟨v·dn_j⟩ − v|dn_j|²). The probes supply their bend times the mean of x², which is 1.
    let mut rest = scaled(-1.0, second);
    for ([_, dn], weight) in pairs.iter().zip(WEIGHTS) {
        rest = add_scaled(rest, weight / length, reflect(view, *dn));
    }
    let centre = add_scaled(unit, 1.0 / (1.0 + axes.minor * axes.minor), rest);
    let lod = (1.8 * 3_f64.sqrt() * minor * texels).log2();
    let terms = pairs.iter().zip(WEIGHTS).map(|([dv, dn], weight)| {
        let size = norm(&normal);
        weight.sqrt() * (3.0 * size * size * norm(dv) + 6.0 * size * norm(&view) * norm(dn)) / length
    });
    let scale = terms.fold(0.0, f64::hypot);
    let probes = points(count, share)
        .into_iter()
        .map(|Point { x, weight, widening }| {
            let r = add_scaled(add_scaled(centre, x, first), x * x, second);
            let at = select(r);
            // A texel there is as large as one in the middle of its face over ρ³.
            let rho = norm(&[1.0, at.s, at.t]);
            LobeProbe { at, weight, lod: lod + widening - norm(&r).log2() + 1.5 * rho.log2() }
        })
        .collect();
    Some(Lobe { mirrored: unit, centre, first, second, major: axes.major, minor: axes.minor, scale, probes })
}

/// Probe count and the transition from one probe less.
struct Rule {
    count: u32,
    /// Progress from the places of one probe less, 0 to 1.
    share: f64,
    /// λ₂, raised if the probes are too few.
    minor: f64,
}

/// N = 1 + ⌈√(λ₁² − λ₂²)/λ₂ − 1/16⌉; probes reach their final places half-way to the next count.
fn rule(reach: f64, axes: &Axes, options: &Options) -> Rule {
    let wanted = if reach == 0.0 { 0.0 } else { (reach / axes.minor - 0.0625).max(0.0) };
    let (count, most) = match options.probe_rule {
        ProbeRule::Ceiling => (wanted.ceil() + 1.0, options.max_probes),
        ProbeRule::PowerOfTwo => {
            let count = wanted.ceil().min(2_f64.powi(40)) as u64 + 1;
            (count.next_power_of_two() as f64, 1 << options.max_probes.ilog2())
        }
    };
    if count > f64::from(most) {
        return Rule { count: most, share: 1.0, minor: axes.major / f64::from(most) };
    }
    let share = match options.probe_rule {
        ProbeRule::Ceiling => (2.0 * (wanted - (count - 2.0))).min(1.0),
        ProbeRule::PowerOfTwo => 1.0,
    };
    Rule { count: count as u32, share, minor: axes.minor }
}

/// A probe before there is a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position, in standard deviations.
    pub x: f64,
    /// Weight of the probe.
    pub weight: f64,
    /// Levels by which it is coarser than one in the middle.
    pub widening: f64,
}

/// `count` probes on their way from `count` − 1. A new probe starts with no weight in the middle of an even number, or as half of the middle one of
/// an odd number. The second probe comes from the first, with which it begins.
///
/// A probe stands for a part of the law. The outer parts are wider than the middle one. For R = √(λ₁² − λ₂²)/λ₂ = N − 5/4, three fifths of their
/// additional variance are in the width of the probe, and the variance of the positions is smaller by as much.
pub fn points(count: u32, share: f64) -> Vec<Point> {
    let own = 1.0 / f64::from(count);
    let parts = |count: u32, weight: f64| -> Vec<Point> {
        let variances = variances(count);
        let reach = f64::from(count) - 1.25;
        let mean = variances.iter().sum::<f64>() / variances.len() as f64;
        let point = |(x, v): (f64, f64)| Point {
            x: x * (1.0 - mean).sqrt(),
            weight,
            widening: 0.5 * (1.0 + reach * reach * v).log2(),
        };
        places(count).into_iter().zip(variances).map(point).collect()
    };
    let to = parts(count, own);
    if count <= 2 {
        return to;
    }
    let less = 1.0 / f64::from(count - 1);
    let before = parts(count - 1, less);
    let new = |weight| Point { x: 0.0, weight, widening: 0.0 };
    let (sides, middle) =
        (((count - 1) / 2) as usize, if count.is_multiple_of(2) { vec![new(0.5 * less); 2] } else { vec![new(0.0)] });
    let (left, right) = (&before[..sides], &before[before.len() - sides..]);
    let from = left.iter().chain(&middle).chain(right);
    let mix = |from: f64, to: f64| from + share * (to - from);
    from.zip(to)
        .map(|(from, to)| Point {
            x: mix(from.x, to.x),
            weight: mix(from.weight, to.weight),
            widening: mix(from.widening, to.widening),
        })
        .collect()
}

/// Additional variances of `count` equally likely parts of the normal law: three fifths of the variance of each above that of the middle part.
fn variances(count: u32) -> Vec<f64> {
    static KEPT: Kept = [const { OnceLock::new() }; 17];
    kept(&KEPT, count, variances_of)
}

fn variances_of(count: u32) -> Vec<f64> {
    let n = f64::from(count);
    let end = |i: u32| if i == 0 || i == count { 0.0 } else { quantile(f64::from(i) / n) };
    let density_at = |i: u32| if i == 0 || i == count { 0.0 } else { density(end(i)) };
    let variance = |i: u32| {
        let mean = n * (density_at(i) - density_at(i + 1));
        1.0 + n * (end(i) * density_at(i) - end(i + 1) * density_at(i + 1)) - mean * mean
    };
    let least = variance(count / 2);
    (0..count).map(|i| 0.6 * (variance(i) - least)).collect()
}

/// Normal law in `count` points of equal weight: the means of its equally likely parts, stretched to deviation 1.
pub fn places(count: u32) -> Vec<f64> {
    static KEPT: Kept = [const { OnceLock::new() }; 17];
    kept(&KEPT, count, places_of)
}

/// Cache of a footprint's numbers, for quantiles by halving take a million densities each.
type Kept = [OnceLock<Vec<f64>>; 17];

fn kept(kept: &'static Kept, count: u32, made: fn(u32) -> Vec<f64>) -> Vec<f64> {
    match kept.get(count as usize) {
        Some(kept) => kept.get_or_init(|| made(count)).clone(),
        None => made(count),
    }
}

fn places_of(count: u32) -> Vec<f64> {
    if count <= 1 {
        return vec![0.0];
    }
    let n = f64::from(count);
    let density_at = |share: f64| if share <= 0.0 || share >= 1.0 { 0.0 } else { density(quantile(share)) };
    let means: Vec<f64> =
        (0..count).map(|i| n * (density_at(f64::from(i) / n) - density_at(f64::from(i + 1) / n))).collect();
    let deviation = (means.iter().map(|x| x * x).sum::<f64>() / n).sqrt();
    means.into_iter().map(|x| x / deviation).collect()
}

/// Density of the normal law.
fn density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()
}

/// Quantile: the point with `share` in (0, 1) of the normal law below it, by halving.
fn quantile(share: f64) -> f64 {
    let (mut low, mut high) = (-10.0, 10.0);
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if below(middle) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Share of the normal law below x, by Simpson's rule on [0, x].
fn below(x: f64) -> f64 {
    const STEPS: u32 = 2000;
    let h = x / f64::from(STEPS);
    let weighted = (0..=STEPS).map(|i| {
        let weight = if i == 0 || i == STEPS { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        weight * density(f64::from(i) * h)
    });
    0.5 + h / 3.0 * weighted.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::super::{Roughness, frame};
    use super::*;

    fn random_inputs(random: &mut SplitMix64, size: f64) -> Inputs {
        let mut vector = |size: f64| [0, 1, 2].map(|_| random.uniform(-size, size));
        Inputs {
            normal: vector(1.0),
            view: vector(3.0),
            tangents: [vector(1.0), vector(1.0)],
            offset: [vector(0.5)[0], vector(0.5)[0]],
            roughness: vector(size),
            dview: [vector(0.01), vector(0.01)],
            dnormal: [vector(0.01), vector(0.01)],
            edge_texels: 256,
        }
    }

    const OPTIONS: Options = Options {
        frame: frame::FrameSystem::MainDirection,
        roughness: Roughness::Anisotropic,
        probe_rule: ProbeRule::Ceiling,
        max_probes: 16,
    };

    #[test]
    fn places_are_of_mean_zero_and_variance_one() {
        for count in 2..=16 {
            let places = places(count);
            let n = f64::from(count);
            assert!(places.iter().sum::<f64>().abs() < 1e-12);
            assert!((places.iter().map(|x| x * x).sum::<f64>() / n - 1.0).abs() < 1e-12);
            assert!(places.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }

    /// Positions and widths of probes have the variance 1 together, for the R of the widths; outer probes are wider.
    #[test]
    fn places_and_widths_are_of_variance_one() {
        for count in 2..=16 {
            let reach = f64::from(count) - 1.25;
            let points = points(count, 1.0);
            let width = |point: &Point| (4_f64.powf(point.widening) - 1.0) / (reach * reach);
            let variance: f64 = points.iter().map(|point| point.weight * (point.x * point.x + width(point))).sum();
            assert!((variance - 1.0).abs() < 1e-12, "{count}: {variance}");
            let outside = &points[count as usize / 2..];
            assert!(outside.windows(2).all(|pair| pair[0].widening < pair[1].widening), "{points:?}");
            assert!(outside[0].widening.abs() < 1e-12 && points[0].widening < 2.5, "{points:?}");
        }
    }

    /// Probes and their extent have the covariance of the lobe together: λ₁² along e₁.
    #[test]
    fn narrow_lobes_keep_their_variance() {
        let mut random = SplitMix64::new(7);
        for _ in 0..500 {
            let Some(lobe) = lobe(&random_inputs(&mut random, 0.01), &OPTIONS) else { continue };
            let minor = if lobe.probes.len() == 16 { lobe.minor.max(lobe.major / 16.0) } else { lobe.minor };
            let part = dot(&lobe.first, &lobe.centre) / dot(&lobe.centre, &lobe.centre);
            let along = add_scaled(lobe.first, -part, lobe.centre);
            // The mean of the lobe moves its centre by λ².
            let slack = 1e-9 + 10.0 * lobe.major;
            assert!((norm(&along).hypot(minor) / lobe.major - 1.0).abs() < slack);
        }
    }

    /// Probes of constant views are reflections of normals on a line: |r| = |v||n + xa|² is quadratic in x.
    #[test]
    fn lengths_along_a_lobe_are_those_of_reflected_normals() {
        let mut random = SplitMix64::new(8);
        for _ in 0..500 {
            let still = Inputs { dview: [[0.0; 3]; 2], dnormal: [[0.0; 3]; 2], ..random_inputs(&mut random, 1.0) };
            let Some(lobe) = lobe(&still, &OPTIONS) else { continue };
            let length = |x: f64| norm(&add_scaled(add_scaled(lobe.mirrored, x, lobe.first), x * x, lobe.second));
            let third = length(3.0) - 3.0 * length(1.0) + 3.0 * length(-1.0) - length(-3.0);
            assert!(third.abs() < 1e-9 * length(3.0).max(length(-3.0)), "{third}");
        }
    }

    #[test]
    fn a_lobe_does_not_know_faces() {
        // A direction near an edge of the cube, from both sides: the probes move as little as the direction does.
        let inputs = |tilt: f64| Inputs {
            normal: [0.0, 0.0, 1.0],
            view: [-1.0 + tilt, 0.3, 1.0],
            tangents: [[1.0, 0.0, 0.0], [0.0; 3]],
            offset: [0.0; 2],
            roughness: [0.4, 0.1, 0.2],
            dview: [[0.001, 0.0, 0.0], [0.0, 0.001, 0.0]],
            dnormal: [[0.0; 3]; 2],
            edge_texels: 64,
        };
        let [a, b] = [-1e-6, 1e-6].map(|tilt| lobe(&inputs(tilt), &OPTIONS).expect("a reflection"));
        assert_eq!(a.probes.len(), b.probes.len());
        assert!(norm(&add_scaled(a.first, -1.0, b.first)) < 1e-5);
        for (a, b) in a.probes.iter().zip(&b.probes) {
            assert!((a.lod - b.lod).abs() < 1e-4);
        }
    }
}
