//! Horizon of a height map along its two axes (F92 §5): least slope of a ray from a texel that clears every other texel.
//!
//! slope = max over d ≥ 1 of (h(x + d) − h(x)) / d, in heights per distance between texels. A wrapped map has a horizon that
//! is never below 0 (the texel's own copy one repeat away), and nothing beyond one repeat can be steeper. An open map ends
//! at its edge: nothing beyond it hides anything, and a horizon below 0 counts as 0. The maximum is the tangent to the upper
//! convex hull of the texels ahead, kept while a row is walked backwards: O(n) a row.

use rayon::prelude::*;
use roughxel_scene::Edges;

/// Slopes of the horizon of one texel towards −x, +x, −y and +y; x runs along the rows of the map, y with their index.
pub type HorizonSlopes = [f64; 4];

/// Slopes of every texel, in rows, at least 0, in heights per distance between texels.
///
/// A map one texel wide or high has the slope 0 along that axis. NaN heights give unspecified slopes.
///
/// # Panics
/// If there are not `width · height` heights, or none.
pub fn horizon_slopes(width: u32, height: u32, heights: &[f64], edges: Edges) -> Vec<HorizonSlopes> {
    let (width, height) = (width as usize, height as usize);
    assert!(!heights.is_empty() && heights.len() == width * height);
    let along_rows: Vec<[Vec<f64>; 2]> = heights.par_chunks_exact(width).map(|row| both_ways(row, edges)).collect();
    let along_columns: Vec<[Vec<f64>; 2]> = (0..width)
        .into_par_iter()
        .map(|x| both_ways(&heights.iter().skip(x).step_by(width).copied().collect::<Vec<_>>(), edges))
        .collect();
    (0..heights.len())
        .map(|index| {
            let (x, y) = (index % width, index / width);
            let ([left, right], [down, up]) = (&along_rows[y], &along_columns[x]);
            [left[x], right[x], down[y], up[y]]
        })
        .collect()
}

/// Slopes towards falling and towards rising indices of one line.
fn both_ways(line: &[f64], edges: Edges) -> [Vec<f64>; 2] {
    let reversed: Vec<f64> = line.iter().rev().copied().collect();
    let mut falling = rising_slopes(&reversed, edges);
    falling.reverse();
    [falling, rising_slopes(line, edges)]
}

/// Slopes towards rising indices of one line.
fn rising_slopes(line: &[f64], edges: Edges) -> Vec<f64> {
    let count = line.len();
    let (repeats, lowest) = match edges {
        Edges::Wrapped => (2, f64::NEG_INFINITY),
        Edges::Open => (1, 0.0),
    };
    let mut slopes = vec![0.0; count];
    // Corners of the upper hull of the texels ahead, the nearest one last: index over all repeats and height.
    let mut hull: Vec<(usize, f64)> = Vec::with_capacity(count);
    for index in (0..repeats * count).rev() {
        let here = line[index % count];
        let slope_to = |(ahead, height): (usize, f64)| (height - here) / (ahead - index) as f64;
        while let [.., second, nearest] = hull[..]
            && slope_to(nearest) <= slope_to(second)
        {
            hull.pop();
        }
        if let (true, Some(&nearest)) = (index < count, hull.last()) {
            slopes[index] = slope_to(nearest).max(lowest);
        }
        hull.push((index, here));
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;
    use roughxel_utilities::random::SplitMix64;

    /// Slope of a wrapped map by its definition, over two repeats.
    fn steepest(width: usize, heights: &[f64], index: usize, axis: usize, ahead: bool) -> f64 {
        let size = [width, heights.len() / width];
        (1..=2 * size[axis])
            .map(|distance| {
                let mut at = [index % width, index / width];
                let step = if ahead { distance } else { 2 * size[axis] - distance };
                at[axis] = (at[axis] + step) % size[axis];
                (heights[at[1] * width + at[0]] - heights[index]) / distance as f64
            })
            .fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn slopes_are_the_steepest_over_all_distances_on_maps_of_any_size() {
        let mut random = SplitMix64::new(92);
        for (width, height) in [(1, 1), (1, 5), (7, 1), (2, 3), (16, 16), (13, 40), (129, 3)] {
            let smooth: Vec<f64> = (0..width * height).map(|_| random.uniform(-2.0, 3.0)).collect();
            let coarse: Vec<f64> = smooth.iter().map(|height| height.round()).collect();
            for heights in [smooth, coarse] {
                let slopes = horizon_slopes(width as u32, height as u32, &heights, Edges::Wrapped);
                for (index, slopes) in slopes.iter().enumerate() {
                    let wanted = [(0, false), (0, true), (1, false), (1, true)]
                        .map(|(axis, ahead)| steepest(width, &heights, index, axis, ahead));
                    for (slope, wanted) in slopes.iter().zip(wanted) {
                        // Two corners whose slopes round to the same number: one rounding.
                        assert!((slope - wanted).abs() <= 1e-15 * (1.0 + wanted), "{slopes:?} {wanted:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_wall_is_seen_from_both_sides_and_hides_what_lies_behind_it() {
        let slopes = horizon_slopes(8, 1, &[0.0, 0.0, 6.0, 0.0, 0.0, 0.0, 1.0, 0.0], Edges::Wrapped);
        assert_eq!(slopes[0], [1.0, 3.0, 0.0, 0.0]);
        assert_eq!(slopes[3], [6.0, 6.0 / 7.0, 0.0, 0.0]);
        assert_eq!(slopes[2], [0.0; 4], "nothing is higher than the top");
        assert_eq!(slopes[6], [5.0 / 4.0, 5.0 / 4.0, 0.0, 0.0]);
    }

    #[test]
    fn flat_maps_and_single_texels_have_a_level_horizon() {
        for edges in [Edges::Wrapped, Edges::Open] {
            assert_eq!(horizon_slopes(1, 1, &[3.5], edges), [[0.0; 4]]);
            assert!(horizon_slopes(5, 4, &[-1.0; 20], edges).iter().all(|slopes| *slopes == [0.0; 4]));
        }
    }

    #[test]
    fn an_open_map_is_not_looked_around() {
        let mut random = SplitMix64::new(5);
        for (width, height) in [(1, 1), (1, 6), (9, 1), (2, 2), (16, 5), (31, 40)] {
            let heights: Vec<f64> = (0..width * height).map(|_| random.uniform(-2.0, 3.0)).collect();
            let slopes = horizon_slopes(width as u32, height as u32, &heights, Edges::Open);
            for (index, slopes) in slopes.iter().enumerate() {
                let [x, y] = [index % width, index / width];
                let rise = |to: usize, distance: usize| (heights[to] - heights[index]) / distance as f64;
                let steepest = |slopes: &mut dyn Iterator<Item = f64>| slopes.fold(0.0, f64::max);
                let wanted = [
                    steepest(&mut (1..=x).map(|d| rise(index - d, d))),
                    steepest(&mut (1..width - x).map(|d| rise(index + d, d))),
                    steepest(&mut (1..=y).map(|d| rise(index - d * width, d))),
                    steepest(&mut (1..height - y).map(|d| rise(index + d * width, d))),
                ];
                for (slope, wanted) in slopes.iter().zip(wanted) {
                    assert!((slope - wanted).abs() <= 1e-15 * (1.0 + wanted), "{slopes:?} {wanted:?}");
                }
            }
        }
        // A ramp hides its lower texels from one side alone; a wrapped ramp has a wall.
        let ramp = [0.0, 1.0, 2.0, 3.0];
        assert_eq!(horizon_slopes(4, 1, &ramp, Edges::Open)[1], [0.0, 1.0, 0.0, 0.0]);
        assert_eq!(horizon_slopes(4, 1, &ramp, Edges::Wrapped)[1], [1.0, 1.0, 0.0, 0.0]);
    }
}
