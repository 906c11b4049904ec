//! Generated normal maps: tangent-space normals, (n + 1)/2 in red (+u), green (+v) and blue.

use super::grid::Grid;
use super::maths::{hash, normalised, unit};
use crate::error::SceneError;
use crate::source::Arguments;
use roughxel_assets::Picture;

/// Hammered metal: hollow dents that meet in sharp edges, which differences of heights do not keep.
pub(super) fn hammered(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let size = keys.size(512)?;
    let seed = u64::from(keys.seed()?);
    // Dents along an edge.
    let dents = i64::from(keys.whole("dents", 8, 2..=256)?);
    // Slope of a dent half a cell away from its middle.
    let slope = keys.number("slope", 0.25, 0.0..=2.0)?;
    let pixels = grid.square(
        size,
        #[inline(always)]
        |column, row| {
            let [x, y] =
                [column, size - 1 - row].map(|texel| (f64::from(texel) + 0.5) * dents as f64 / f64::from(size));
            let cell = [x, y].map(|at| at.floor() as i64);
            let mut nearest = [f64::INFINITY; 2];
            for step in 0..9 {
                let at = [cell[0] + step % 3 - 1, cell[1] + step / 3 - 1];
                let [i, j] = at.map(|index| index.rem_euclid(dents));
                // A point within the middle two thirds of its cell.
                let middle = |axis: i64| 1.0 / 6.0 + 2.0 / 3.0 * unit(hash(seed, i, j, 4 + axis));
                let from_middle = [x - at[0] as f64 - middle(0), y - at[1] as f64 - middle(1)];
                let square = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
                if square(from_middle) < square(nearest) {
                    nearest = from_middle;
                }
            }
            // A bowl: the height grows with the square of the distance; the normal leans towards the middle.
            let [lean_u, lean_v] = nearest.map(|distance| -2.0 * slope * distance);
            normalised([lean_u, lean_v, 1.0]).map(|component| (0.5 + 0.5 * component) as f32)
        },
    );
    Ok(Picture { width: size, height: size, pixels })
}

#[cfg(test)]
mod tests {
    use super::super::keys::made;
    use super::*;

    #[test]
    fn dents_are_hollow_and_repeat() {
        let map = made(hammered, "size = 64, dents = 4, slope = 0.3");
        let lean = |column: u32, row: u32, channel: usize| map.pixels[(row * 64 + column) as usize][channel] - 0.5;
        let mut edges = 0;
        for row in 0..64 {
            for column in 0..64 {
                let step = lean((column + 1) % 64, row, 0) - lean(column, row, 0);
                // Inside a dent the lean along u falls; only an edge between dents raises it.
                edges += usize::from(step > 0.0);
            }
        }
        // Each of 64 rows meets about as many edges as there are dents along it, the seam included.
        assert!((64 * 3..64 * 8).contains(&edges), "{edges}");
    }
}
