//! Polygons cut into triangles.
//!
//! A polygon whose fan from the first corner lies inside is cut into that fan: every convex one, planar or not. Any other is projected along its
//! Newell normal and cut by ears. If ears do not fill its area exactly, it crosses itself and stays a fan.

use std::collections::HashMap;

use earcut::Earcut;
use glam::{DVec2, DVec3};

/// Most corners of a polygon that is cut by ears, which can take the square of their number.
const MAX_EAR_CORNERS: usize = 1 << 14;
/// Rounding of areas relative to the square of the extent.
const AREA_ROUNDING: f64 = 1e-12;

/// Cuts polygons; keeps memory from one to the next.
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    flat: Vec<DVec2>,
    indices: Vec<u32>,
}

impl Cutter {
    pub(super) fn new() -> Self {
        Self { earcut: Earcut::new(), flat: Vec::new(), indices: Vec::new() }
    }

    /// Writes triangles as indices of `corners`, of which there are at least three. False if the polygon crosses itself.
    pub(super) fn cut(&mut self, corners: &[DVec3], triangles: &mut Vec<[u32; 3]>) -> bool {
        triangles.clear();
        let count = corners.len() as u32;
        triangles.extend((2..count).map(|last| [0, last - 1, last]));
        if count == 3 {
            return true;
        }
        let [first, second] = [corners[0], corners[1] - corners[0]];
        let doubled_area = |i: usize| (corners[i] - first).cross(corners[i + 1] - first);
        let newell: DVec3 = (1..corners.len() - 1).map(doubled_area).sum();
        let extent = corners.iter().map(|corner| corner.distance_squared(first)).fold(0.0, f64::max);
        let rounding = AREA_ROUNDING * extent;
        let normal = newell.normalize_or_zero();
        if newell.length() <= rounding {
            return (1..corners.len() - 1).all(|i| doubled_area(i).length() <= rounding);
        }
        // The fan is right if no triangle runs backwards and all of them together turn less than once around the first corner.
        let after_second = |i: usize| second.cross(corners[i] - first).dot(normal);
        let is_fan = (1..corners.len() - 1).all(|i| {
            let turned_once = after_second(i) < -rounding && after_second(i + 1) > rounding;
            doubled_area(i).dot(normal) >= -rounding && !turned_once
        });
        if is_fan {
            return true;
        }
        if corners.len() > MAX_EAR_CORNERS {
            return false;
        }
        let u = normal.any_orthonormal_vector();
        let v = normal.cross(u);
        self.flat.clear();
        self.flat.extend(corners.iter().map(|corner| DVec2::new((corner - first).dot(u), (corner - first).dot(v))));
        self.earcut.earcut(self.flat.iter().map(DVec2::to_array), &[], &mut self.indices);
        let Some(mut ears) = ears(&self.flat, &self.indices, newell.length(), rounding) else { return false };
        insert_collinear(&self.flat, &mut ears, rounding);
        *triangles = ears;
        true
    }
}

/// Twice the signed area of a triangle.
fn signed_area(flat: &[DVec2], [a, b, c]: [u32; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|index| flat[index as usize]);
    (b - a).perp_dot(c - a)
}

/// Counter-clockwise triangles, if they fill `doubled_area`.
fn ears(flat: &[DVec2], indices: &[u32], doubled_area: f64, rounding: f64) -> Option<Vec<[u32; 3]>> {
    let mut filled = 0.0;
    let mut ears = Vec::with_capacity(indices.len() / 3);
    for &[a, b, c] in indices.as_chunks::<3>().0 {
        let area = signed_area(flat, [a, b, c]);
        ears.push(if area < 0.0 { [a, c, b] } else { [a, b, c] });
        filled += area.abs();
    }
    let difference = (filled - doubled_area).abs();
    (difference <= rounding * flat.len() as f64 + 1e-9 * doubled_area).then_some(ears)
}

/// Brings back corners on straight edges, which ears leave out: a neighbour may have a vertex there, and attributes change there.
fn insert_collinear(flat: &[DVec2], triangles: &mut Vec<[u32; 3]>, rounding: f64) {
    let mut is_used = vec![false; flat.len()];
    for &index in triangles.iter().flatten() {
        is_used[index as usize] = true;
    }
    if is_used.iter().all(|used| *used) {
        return;
    }
    let edges_of = |[a, b, c]: [u32; 3]| [(a, b, c), (b, c, a), (c, a, b)];
    // The triangle and its third corner at each directed edge.
    let mut edges: HashMap<(u32, u32), (usize, u32)> = HashMap::new();
    for (index, triangle) in triangles.iter().enumerate() {
        edges.extend(edges_of(*triangle).map(|(a, b, c)| ((a, b), (index, c))));
    }
    let count = flat.len();
    for corner in 0..count {
        if is_used[corner] {
            continue;
        }
        let around = |step: usize| (1..count).map(|k| (corner + k * step) % count).find(|&other| is_used[other]);
        let (Some(before), Some(after)) = (around(count - 1), around(1)) else { return };
        let [before, middle, after] = [before, corner, after].map(|index| index as u32);
        let Some(&(index, third)) = edges.get(&(before, after)) else { continue };
        let halves = [[before, middle, third], [middle, after, third]];
        if halves.iter().any(|half| signed_area(flat, *half) <= rounding) {
            continue;
        }
        is_used[corner] = true;
        edges.remove(&(before, after));
        for (place, half) in [index, triangles.len()].into_iter().zip(halves) {
            edges.extend(edges_of(half).map(|(a, b, c)| ((a, b), (place, c))));
        }
        triangles[index] = halves[0];
        triangles.push(halves[1]);
    }
}
