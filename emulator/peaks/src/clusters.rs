//! Clusters: facets with similar normals and horizons, one cluster for each peak.
//!
//! Far away and from a low eye, only part of a rough surface is in sight. The visible facets differ from the others: they lean towards the eye and
//! lie high. A peak for all facets of about one normal cannot represent this. A peak for facets with equal horizons, too, is in sight or not as a
//! whole. Facets are therefore gathered around at most seven means over normals and horizons (Lloyd's iteration). Each cluster is a peak: its mean
//! normal, as wide as its normals spread. Without horizons, clusters are the starting point of a fit of many peaks (`fit`).

use glam::DVec3;

use super::fit::{FittedPeak, MAX_PEAKS};
use crate::horizon::HorizonSlopes;

/// Weight of a horizon's angle, in radians, relative to x and y of a normal.
///
/// Brightness over the truth in the farthest of seven bands (`host-tests/tests/pictures/shadows.rs`):
///
/// | weight | slopes to 1 | slopes from 2 to 3.5 |
/// |---|---|---|
/// | 0.4 | 0.95 to 1.07 | 0.87 to 1.09 |
/// | 0.6 | 0.93 to 1.10 | 0.86 to 1.13 |
/// | 0.9 | 0.92 to 1.08 | 0.79 to 1.23 |
const HORIZON_WEIGHT: f64 = 0.4;
/// Most passes over the facets; iteration ends earlier when no facet moves.
const PASSES: u32 = 20;

/// A facet to be clustered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    /// x and y of the normal, angles of the horizons to the four sides.
    place: [f64; 6],
    weight: f64,
}

impl Member {
    /// A member for a facet of a weight above 0.
    pub(super) fn new(normal: DVec3, slopes: HorizonSlopes, weight: f64) -> Self {
        let [left, right, down, up] = slopes.map(|slope| HORIZON_WEIGHT * libm::atan(slope));
        Self { place: [normal.x, normal.y, left, right, down, up], weight }
    }

    fn distance(&self, to: &[f64; 6]) -> f64 {
        self.place.iter().zip(to).map(|(here, there)| (here - there) * (here - there)).sum()
    }
}

/// Cluster of every member, in the order of members: at most `most` clusters, which is [`MAX_PEAKS`] or fewer. Clusters may be empty.
///
/// Starts from the members that are farthest from the mean and from each other, by their weight. Equal members in equal order give equal clusters.
pub(super) fn clusters(members: &[Member], most: usize) -> Vec<u8> {
    let mut all = Sum::default();
    members.iter().for_each(|member| all.add(member));
    let distances = |to: [f64; 6]| members.iter().map(move |member| member.distance(&to));
    let first = all.mean().and_then(|mean| farthest(members, distances(mean)));
    let mut of = vec![0; members.len()];
    let Some(first) = first else { return of };
    let mut means = vec![first];
    // Squared distances to the nearest mean so far.
    let mut nearest: Vec<f64> = distances(first).collect();
    while means.len() < most {
        let Some(next) = farthest(members, nearest.iter().copied()) else { break };
        means.push(next);
        nearest.iter_mut().zip(distances(next)).for_each(|(nearest, distance)| *nearest = nearest.min(distance));
    }
    for _ in 0..PASSES {
        let mut moved = false;
        let mut sums = [Sum::default(); MAX_PEAKS];
        for (member, own) in members.iter().zip(&mut of) {
            let nearest = means.iter().enumerate().fold((f64::INFINITY, 0), |best, (cluster, mean)| {
                let distance = member.distance(mean);
                if distance < best.0 { (distance, cluster) } else { best }
            });
            moved |= usize::from(*own) != nearest.1;
            *own = nearest.1 as u8;
            sums[nearest.1].add(member);
        }
        if !moved {
            break;
        }
        for (mean, sum) in means.iter_mut().zip(sums) {
            *mean = sum.mean().unwrap_or(*mean);
        }
    }
    of
}

/// Place of the member that is farthest by its weight; `None` if all distances are 0.
fn farthest(members: &[Member], distances: impl Iterator<Item = f64>) -> Option<[f64; 6]> {
    let farthest = members.iter().zip(distances).fold((0.0, None), |most, (member, distance)| {
        let share = member.weight * distance;
        if share > most.0 { (share, Some(member.place)) } else { most }
    });
    farthest.1
}

/// Sum of the places of members by their weight, and of their weights.
#[derive(Clone, Copy, Default)]
struct Sum {
    places: [f64; 6],
    weight: f64,
}

impl Sum {
    fn add(&mut self, member: &Member) {
        for (sum, coordinate) in self.places.iter_mut().zip(member.place) {
            *sum += member.weight * coordinate;
        }
        self.weight += member.weight;
    }

    /// Mean place; `None` without members.
    fn mean(&self) -> Option<[f64; 6]> {
        (self.weight > 0.0).then(|| self.places.map(|sum| sum / self.weight))
    }
}

/// Peak of facets Σ a cosⁿα with their energy and their mean cosine. `amplitude` is the sum of their amplitudes, `normals` the sum
/// of normals times amplitudes.
///
/// The mean cosine of cosⁿα is (n + 1)/(n + 2). The mean cosine of its directions around an axis at an angle is this times the
/// cosine of the angle.
pub(super) fn lobe(amplitude: f64, normals: DVec3, exponent: f64) -> FittedPeak {
    let direction = normals.normalize_or(DVec3::Z);
    let cosine = (exponent + 1.0) / (exponent + 2.0) * (normals.length() / amplitude).min(1.0);
    let wider = ((2.0 * cosine - 1.0) / (1.0 - cosine)).clamp(1.0, exponent.max(1.0));
    FittedPeak { amplitude: amplitude * (wider + 1.0) / (exponent + 1.0), direction, exponent: wider }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use roughxel_utilities::random::SplitMix64;

    fn member(tilt: [f64; 2], horizon: f64, weight: f64) -> Member {
        Member::new(DVec3::new(tilt[0], tilt[1], 1.0).normalize(), [horizon; 4], weight)
    }

    #[test]
    fn facets_that_stand_apart_are_clusters_of_their_own() {
        let mut random = SplitMix64::new(16);
        // Seven groups, of which two share a normal but not the horizons.
        let groups = [[0.5, 0.0], [-0.5, 0.0], [0.0, 0.5], [0.0, -0.5], [0.5, 0.5], [0.0, 0.0], [0.0, 0.0]];
        let horizons = [0.1, 0.2, 0.3, 0.1, 0.2, 0.0, 2.0];
        let members: Vec<Member> = (0..700)
            .map(|index| {
                let [x, y] = groups[index % 7];
                let mut near = |value: f64| value + random.uniform(-0.02, 0.02);
                member([near(x), near(y)], near(horizons[index % 7] + 0.02), [1.0, 3.0][index % 2])
            })
            .collect();
        let of = clusters(&members, MAX_PEAKS);
        assert!(of.iter().enumerate().all(|(index, cluster)| *cluster == of[index % 7]));
        assert_eq!(of.iter().collect::<HashSet<_>>().len(), 7);
        // As many clusters as asked for, if there are more groups.
        for most in 1..=MAX_PEAKS {
            assert_eq!(clusters(&members, most).into_iter().collect::<HashSet<_>>().len(), most);
        }
    }

    #[test]
    fn equal_facets_are_one_cluster_and_few_are_one_each() {
        assert_eq!(clusters(&[member([0.1, 0.3], 0.4, 2.0); 20], MAX_PEAKS), vec![0; 20]);
        let few = [member([0.1, 0.3], 0.4, 2.0), member([0.2, 0.3], 0.4, 0.1), member([0.1, 0.3], 0.5, 9.0)];
        assert_eq!(clusters(&few, MAX_PEAKS).into_iter().collect::<HashSet<_>>().len(), 3);
        assert!(clusters(&[], MAX_PEAKS).is_empty());
    }

    #[test]
    fn every_facet_is_with_the_nearest_mean_or_on_its_way() {
        let mut random = SplitMix64::new(5);
        let mut of = || member([random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)], random.uniform(0.0, 1.0), 1.0);
        let members: Vec<Member> = (0..2000).map(|_| of()).collect();
        let own = clusters(&members, MAX_PEAKS);
        let mut sums = [Sum::default(); MAX_PEAKS];
        members.iter().zip(&own).for_each(|(member, of)| sums[usize::from(*of)].add(member));
        let means = sums.map(|sum| sum.mean().expect("each has members"));
        let nearest = |member: &Member| {
            (0..MAX_PEAKS).min_by(|a, b| member.distance(&means[*a]).total_cmp(&member.distance(&means[*b])))
        };
        let stray = members.iter().zip(&own).filter(|(member, of)| nearest(member) != Some(usize::from(**of))).count();
        assert!(stray < 40, "{stray}");
    }

    #[test]
    fn a_lobe_has_the_energy_and_the_mean_cosine_of_its_facets() {
        let alone = lobe(0.7, 0.7 * DVec3::Y, 40.0);
        assert!((alone.exponent - 40.0).abs() < 1e-9 && (alone.amplitude - 0.7).abs() < 1e-9);
        let normals = [DVec3::new(0.3, 0.1, 1.0), DVec3::new(-0.2, 0.4, 1.0)].map(DVec3::normalize);
        let both = lobe(1.5, normals[0] + 0.5 * normals[1], 40.0);
        assert!((both.amplitude / (both.exponent + 1.0) - 1.5 / 41.0).abs() < 1e-12);
        let cosine = (both.exponent + 1.0) / (both.exponent + 2.0);
        let along = (normals[0].dot(both.direction) + 0.5 * normals[1].dot(both.direction)) / 1.5;
        assert!((cosine - 41.0 / 42.0 * along).abs() < 1e-12 && both.exponent < 40.0);
        // Normals that cancel have no direction; the result is the widest lobe.
        assert_eq!(lobe(2.0, DVec3::ZERO, 8.0).exponent, 1.0);
    }
}
