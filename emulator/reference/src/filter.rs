//! Texture filters over float texels: bilinear, trilinear, footprint assembly, and the seams of a cube map.
//!
//! Texel (i, j) of a w×h map is the square [i, i+1)×[j, j+1) of texel space, and its value belongs to the centre. Maps wrap. A cube face continues in
//! the border texels of its neighbour, and the missing fourth texel at a corner is the mean of the other three. Levels are area-weighted box filters
//! down to 1×1.

use super::cube::{Selection, continue_across, direction_of, project, select};
use super::linear::{Vector2, add_scaled, scaled};
use super::probes::ProbePlan;
use super::roughness::box_weights;

/// A map of `C` channels, rows of `width` texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Map<const C: usize> {
    /// Texels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// `width`·`height` texels; row 0 is at v = 0 (textures) or t = −1 (cube faces).
    pub texels: Vec<[f64; C]>,
}

impl<const C: usize> Map<C> {
    fn texel(&self, x: usize, y: usize) -> [f64; C] {
        self.texels[y * self.width + x]
    }

    fn repeated(&self, x: i64, y: i64) -> [f64; C] {
        let wrap = |i: i64, size: usize| i.rem_euclid(size as i64) as usize;
        self.texel(wrap(x, self.width), wrap(y, self.height))
    }

    fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let mut texels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let mut sum = [0.0; C];
                for (row, row_weight) in box_weights(self.height, height, y) {
                    for (column, weight) in box_weights(self.width, width, x) {
                        sum = add_scaled(sum, row_weight * weight, self.texel(column, row));
                    }
                }
                texels.push(sum);
            }
        }
        Self { width, height, texels }
    }

    /// All levels of the map down to 1×1, level 0 first.
    pub fn pyramid(self) -> Vec<Self> {
        let mut levels = vec![self];
        while let Some(next) = levels.last().filter(|level| level.width > 1 || level.height > 1).map(Self::halved) {
            levels.push(next);
        }
        levels
    }

    /// Mean differences between the four texels of the bilinear patch at (u, v), along u and along v.
    fn differences(&self, [u, v]: Vector2) -> [[f64; C]; 2] {
        let [(x, _), (y, _)] = [split(u * self.width as f64 - 0.5), split(v * self.height as f64 - 0.5)];
        let texel = |i, j| self.repeated(x + i, y + j);
        let between = |from: [[f64; C]; 2], to: [[f64; C]; 2]| {
            scaled(0.5, core::array::from_fn(|c| to[0][c] - from[0][c] + to[1][c] - from[1][c]))
        };
        let (upper, lower) = ([texel(0, 0), texel(1, 0)], [texel(0, 1), texel(1, 1)]);
        [between([upper[0], lower[0]], [upper[1], lower[1]]), between(upper, lower)]
    }

    /// Bilinear sample at (u, v) in repeats of the map.
    pub fn bilinear(&self, [u, v]: Vector2) -> [f64; C] {
        let (x, x_weight) = split(u * self.width as f64 - 0.5);
        let (y, y_weight) = split(v * self.height as f64 - 0.5);
        blend([x_weight, y_weight], |i, j| self.repeated(x + i, y + j))
    }
}

/// Integer part and fraction, also for negative numbers.
fn split(position: f64) -> (i64, f64) {
    (position.floor() as i64, position - position.floor())
}

/// Bilinear blend of the texels (i, j), i, j ∈ {0, 1}.
fn blend<const C: usize>([x, y]: Vector2, mut texel: impl FnMut(i64, i64) -> [f64; C]) -> [f64; C] {
    let top = add_scaled(scaled(1.0 - x, texel(0, 0)), x, texel(1, 0));
    let bottom = add_scaled(scaled(1.0 - x, texel(0, 1)), x, texel(1, 1));
    add_scaled(scaled(1.0 - y, top), y, bottom)
}

/// Linear blend of the two levels around `lod`, which is clamped to the pyramid; `sample` filters one level.
fn between_levels<L, const C: usize>(levels: &[L], lod: f64, sample: impl Fn(&L) -> [f64; C]) -> [f64; C] {
    let lod = lod.clamp(0.0, (levels.len() - 1) as f64);
    let (fine, weight) = (lod.floor() as usize, lod.fract());
    let value = sample(&levels[fine]);
    if weight == 0.0 {
        return value;
    }
    add_scaled(scaled(1.0 - weight, value), weight, sample(&levels[fine + 1]))
}

/// Trilinear sample at (u, v) in repeats of the map.
pub fn trilinear<const C: usize>(levels: &[Map<C>], uv: Vector2, lod: f64) -> [f64; C] {
    between_levels(levels, lod, |level| level.bilinear(uv))
}

/// Mean differences of neighbouring texels at (u, v) along u and along v, blended between two levels, each per texel of its level.
pub fn differences<const C: usize>(levels: &[Map<C>], uv: Vector2, lod: f64) -> [[f64; C]; 2] {
    [0, 1].map(|axis| between_levels(levels, lod, |level| level.differences(uv)[axis]))
}

/// Footprint assembly: the weighted sum of trilinear probes around (u, v); the plan's unit is repeats of the map.
///
/// `texels_to_repeats` converts a plan made in texels of a map that is not square.
pub fn assemble<const C: usize>(levels: &[Map<C>], uv: Vector2, plan: &ProbePlan, weights: &[f64]) -> [f64; C] {
    let mut sum = [0.0; C];
    for (index, &weight) in (0..plan.count).zip(weights) {
        let at = add_scaled(uv, 1.0, plan.offset(index));
        sum = add_scaled(sum, weight, trilinear(levels, at, plan.lod));
    }
    sum
}

/// Converts the step of a plan from texels to repeats of a map of `size_texels`.
pub fn texels_to_repeats(plan: &ProbePlan, size_texels: [u32; 2]) -> ProbePlan {
    let [width, height] = size_texels.map(f64::from);
    ProbePlan { step: [plan.step[0] / width, plan.step[1] / height], ..*plan }
}

/// Six square faces of one edge, in Vulkan's order.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeMap<const C: usize> {
    /// Faces +x, −x, +y, −y, +z, −z.
    pub faces: [Map<C>; 6],
}

impl<const C: usize> CubeMap<C> {
    /// All levels down to faces of one texel; each face is filtered by itself.
    pub fn pyramid(self) -> Vec<Self> {
        let mut levels = vec![self];
        while let Some(last) = levels.last().filter(|level| level.faces[0].width > 1) {
            let faces = last.faces.each_ref().map(Map::halved);
            levels.push(Self { faces });
        }
        levels
    }

    /// Texel (x, y) of `face`, with x and y up to one beyond the face.
    ///
    /// Beyond an edge it is the border texel of the neighbour at the same place along the edge. Beyond a corner it is the mean of the three texels
    /// that meet there.
    pub fn texel_across(&self, face: usize, x: i64, y: i64) -> [f64; C] {
        let edge = self.faces[face].width as i64;
        let inside = |i: i64| (0..edge).contains(&i);
        match (inside(x), inside(y)) {
            (true, true) => self.faces[face].texel(x as usize, y as usize),
            (false, false) => {
                let (x_in, y_in) = (x.clamp(0, edge - 1), y.clamp(0, edge - 1));
                let mut sum = self.texel_across(face, x_in, y_in);
                sum = add_scaled(sum, 1.0, self.texel_across(face, x, y_in));
                sum = add_scaled(sum, 1.0, self.texel_across(face, x_in, y));
                scaled(1.0 / 3.0, sum)
            }
            _ => {
                // A point of the shared edge. The neighbour is found just beyond it, and its coordinates on it: one of them is exactly ±1 and the
                // other the centre of the wanted texel.
                let centre = |i: i64| (2 * i + 1) as f64 / edge as f64 - 1.0;
                let (s, t) = (centre(x), centre(y));
                let neighbour = select(direction_of(face, s, t)).face;
                let point = direction_of(face, s.clamp(-1.0, 1.0), t.clamp(-1.0, 1.0));
                let at = project(neighbour, point);
                let index = |coordinate: f64| {
                    let texel = (0.5 * (coordinate + 1.0) * edge as f64).floor();
                    texel.clamp(0.0, (edge - 1) as f64) as usize
                };
                self.faces[neighbour].texel(index(at.s), index(at.t))
            }
        }
    }

    /// Bilinear sample at a point of the cube, across edges and corners.
    pub fn bilinear(&self, at: &Selection) -> [f64; C] {
        let edge = self.faces[at.face].width as f64;
        let (x, x_weight) = split(0.5 * (at.s + 1.0) * edge - 0.5);
        let (y, y_weight) = split(0.5 * (at.t + 1.0) * edge - 0.5);
        blend([x_weight, y_weight], |i, j| self.texel_across(at.face, x + i, y + j))
    }
}

/// Trilinear sample of a cube map.
pub fn cube_trilinear<const C: usize>(levels: &[CubeMap<C>], at: &Selection, lod: f64) -> [f64; C] {
    between_levels(levels, lod, |level| level.bilinear(at))
}

/// Footprint assembly on a cube map: probes that leave the face continue across the edge.
pub fn cube_assemble<const C: usize>(
    levels: &[CubeMap<C>],
    at: &Selection,
    plan: &ProbePlan,
    weights: &[f64],
) -> [f64; C] {
    let mut sum = [0.0; C];
    for (index, &weight) in (0..plan.count).zip(weights) {
        let [s, t] = add_scaled([at.s, at.t], 1.0, plan.offset(index));
        let probe = continue_across(at.face, s, t);
        sum = add_scaled(sum, weight, cube_trilinear(levels, &probe, plan.lod));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::linear::{Vector3, norm};
    use super::super::random::SplitMix64;
    use super::*;

    /// A cube map of a function of direction, sampled at texel centres.
    fn cube_map(edge: usize, value: impl Fn(Vector3) -> f64) -> CubeMap<1> {
        let face = |face: usize| Map {
            width: edge,
            height: edge,
            texels: (0..edge * edge)
                .map(|i| {
                    let centre = |k: usize| (2 * k + 1) as f64 / edge as f64 - 1.0;
                    let d = direction_of(face, centre(i % edge), centre(i / edge));
                    [value(scaled(1.0 / norm(&d), d))]
                })
                .collect(),
        };
        CubeMap { faces: [0, 1, 2, 3, 4, 5].map(face) }
    }

    #[test]
    fn bilinear_interpolates_and_repeats() {
        let map = Map { width: 2, height: 2, texels: vec![[0.0], [1.0], [2.0], [3.0]] };
        assert_eq!(map.bilinear([0.25, 0.25]), [0.0]);
        assert_eq!(map.bilinear([0.5, 0.25]), [0.5]);
        assert_eq!(map.bilinear([0.5, 0.5]), [1.5]);
        assert_eq!(map.bilinear([0.0, 0.25]), [0.5]);
        assert_eq!(map.bilinear([-0.75, 7.75]), [2.0]);
        let levels = map.pyramid();
        assert_eq!(levels[1].texels, [[1.5]]);
        assert_eq!(trilinear(&levels, [0.25, 0.25], 0.5), [0.75]);
        assert_eq!(trilinear(&levels, [0.25, 0.25], 9.0), [1.5]);
    }

    #[test]
    fn odd_maps_keep_their_mean() {
        let mut random = SplitMix64::new(14);
        for (width, height) in [(5, 3), (7, 1), (1, 6), (13, 9)] {
            let texels: Vec<_> = (0..width * height).map(|_| [random.uniform(0.0, 1.0)]).collect();
            let mean = texels.iter().map(|[x]| x).sum::<f64>() / texels.len() as f64;
            let levels = Map { width, height, texels }.pyramid();
            let [top] = levels[levels.len() - 1].texels[0];
            assert!((top - mean).abs() < 1e-15);
        }
    }

    #[test]
    fn a_smooth_function_stays_smooth_across_every_edge_and_corner() {
        let value = |d: Vector3| 0.5 * d[0] - 0.25 * d[1] + d[2] * d[0] + 0.3 * d[2];
        let edge = 64;
        let map = cube_map(edge, value);
        let mut random = SplitMix64::new(15);
        for round in 0..20_000 {
            let mut d = [0, 1, 2].map(|_| random.uniform(-1.0, 1.0));
            if round % 2 == 0 {
                // Onto an edge, every tenth onto a corner, within half a texel.
                d[(round / 2) % 3] = 1.0 + random.uniform(-0.01, 0.01);
                d[(round / 2 + 1) % 3] = -1.0 + random.uniform(-0.01, 0.01);
                if round % 10 == 0 {
                    d[(round / 2 + 2) % 3] = 1.0 + random.uniform(-0.01, 0.01);
                }
            }
            let [got] = map.bilinear(&select(d));
            let expected = value(scaled(1.0 / norm(&d), d));
            // A texel spans 2/64 of a face and the slope is below 2. A wrong neighbour would be off by ≥ 0.06 almost everywhere; the right one bends
            // by at most half a texel at the edge.
            assert!((got - expected).abs() < 0.02, "{d:?}: {got} for {expected}");
        }
    }

    #[test]
    fn neighbours_beyond_an_edge_share_it() {
        // Each texel holds a different number; the texel across an edge must see this one across the same edge.
        let edge = 5_usize;
        let mut map = cube_map(edge, |_| 0.0);
        for (f, face) in map.faces.iter_mut().enumerate() {
            for (i, texel) in face.texels.iter_mut().enumerate() {
                texel[0] = (f * edge * edge + i) as f64;
            }
        }
        let last = edge as i64 - 1;
        for face in 0..6 {
            for k in 0..=last {
                for (x, y, inner_x, inner_y) in
                    [(-1, k, 0, k), (last + 1, k, last, k), (k, -1, k, 0), (k, last + 1, k, last)]
                {
                    let other = map.texel_across(face, x, y)[0] as usize;
                    let (other_face, i) = (other / (edge * edge), (other % (edge * edge)) as i64);
                    let (ox, oy) = (i % edge as i64, i / edge as i64);
                    assert_ne!(other_face, face);
                    let own = map.texel_across(face, inner_x, inner_y);
                    let beyond = [(ox - 1, oy), (ox + 1, oy), (ox, oy - 1), (ox, oy + 1)];
                    assert!(
                        beyond.iter().any(|&(x, y)| !((0..=last).contains(&x) && (0..=last).contains(&y))
                            && map.texel_across(other_face, x, y) == own),
                        "face {face} texel {x},{y}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_corner_texel_is_the_mean_of_the_three() {
        let mut map = cube_map(4, |_| 0.0);
        // Corner (1, 1, 1): +x at s = −1, t = −1; +y at s = 1, t = 1; +z at s = 1, t = −1.
        map.faces[0].texels[0] = [3.0];
        map.faces[2].texels[15] = [6.0];
        map.faces[4].texels[3] = [9.0];
        assert_eq!(map.texel_across(4, 4, -1), [6.0]);
        assert_eq!(map.texel_across(0, -1, -1), [6.0]);
        assert_eq!(map.texel_across(2, 4, 4), [6.0]);
        let constant = cube_map(4, |_| 0.75);
        let corner = Selection { face: 4, s: 1.0, t: -1.0, m: 1.0 };
        assert!((constant.bilinear(&corner)[0] - 0.75).abs() < 1e-15);
    }

    #[test]
    fn probes_walk_across_an_edge() {
        // A step function on −x…+x seen from face +z: half the probes on +z, half on +x.
        let map = cube_map(64, |d| if d[0] > d[2].abs() && d[0] > d[1].abs() { 1.0 } else { 0.0 }).pyramid();
        let at = Selection { face: 4, s: 1.0, t: 0.0, m: 1.0 };
        let plan = ProbePlan { count: 4, step: [0.125, 0.0], minor: 0.0, capped: false, lod: 0.0, lod_unclamped: 0.0 };
        assert!((cube_assemble(&map, &at, &plan, &[0.25; 4])[0] - 0.5).abs() < 1e-12);
    }
}
