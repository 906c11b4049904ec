//! Generated heights of worked and woven surfaces (S97 §8, F92 Fig. 4–8): grey pictures from 0 to 1 that wrap.

use super::grid::Grid;
use super::height::grey;
use super::maths::{Random, cos_turns, sin_turns, smoothstep};
use crate::error::SceneError;
use crate::source::Arguments;
use roughxel_assets::Picture;

/// Long thin scratches along u: grooves that fade out at both ends.
pub(super) fn brushed(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let edge = keys.size(512)?;
    let size = i64::from(edge);
    let mut heights = vec![0.0; (size * size) as usize];
    let mut random = Random::new(keys.seed()?);
    let scratches = keys.whole("scratches", 2000, 1..=20_000)?;
    // Length of the longest scratch, in repeats.
    let length = keys.number("length", 0.5, 0.01..=1.0)?;
    let half_width = 0.5 * keys.number("width_texels", 4.0, 2.0..=16.0)?;
    // Largest turn of single scratches away from u.
    let spread_degrees = keys.number("spread_degrees", 2.0, 0.0..=30.0)?;
    grid.begin(scratches.into());
    for _ in 0..scratches {
        grid.step();
        let [column, row] = [0; 2].map(|_| random.unit() * f64::from(edge));
        let steps = ((0.3 + 0.7 * random.unit()) * length * f64::from(edge)).ceil();
        let turns = spread_degrees / 360.0 * random.bell();
        let climb = sin_turns(turns) / cos_turns(turns);
        let strength = random.unit();
        for step in 0..=steps as i64 {
            let along = 2.0 * step as f64 / steps - 1.0;
            let fade = strength * (1.0 - along * along);
            let centre = row + climb * (step as f64 - 0.5 * steps);
            let x = (column as i64 + step).rem_euclid(size);
            for y in (centre - half_width).ceil() as i64..=(centre + half_width).floor() as i64 {
                let across = (y as f64 - centre) / half_width;
                let groove = 1.0 - across * across;
                heights[(y.rem_euclid(size) * size + x) as usize] -= fade * groove * groove;
            }
        }
    }
    Ok(grey(edge, &heights))
}

/// A profile along one direction, from its height at a phase in [0, 1): `periods_u` periods along u, `periods_v` along
/// v.
fn profile(grid: Grid<'_>, keys: &Arguments<'_>, height: impl Fn(f64) -> f64) -> Result<Picture, SceneError> {
    let periods = [keys.whole("periods_u", 8, 0..=1024)?, keys.whole("periods_v", 0, 0..=1024)?];
    if periods == [0; 2] {
        return Err(keys.error("the profile has no period", "give `periods_u` or `periods_v` above 0"));
    }
    let [periods_u, periods_v] = periods.map(u64::from);
    let size = keys.size(512)?;
    let table: Vec<f64> = (0..size).map(|step| height(f64::from(step) / f64::from(size))).collect();
    let heights = grid.square(size, |column, row| {
        let phase = (periods_u * u64::from(column) + periods_v * u64::from(size - 1 - row)) % u64::from(size);
        table[phase as usize]
    });
    Ok(grey(size, &heights))
}

/// Corrugated sheet: a cosine.
pub(super) fn corrugated(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    profile(grid, keys, cos_turns)
}

/// V-grooves: two plane flanks.
pub(super) fn grooves(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    profile(grid, keys, |phase| (2.0 * phase - 1.0).abs())
}

/// Round caps or rods in rows, clipped where their flank becomes too steep.
#[derive(Clone, Debug)]
pub(super) struct Round {
    /// Edge in texels.
    pub(super) size: u32,
    /// Number along an edge.
    pub(super) count: u32,
    /// (distance from the axis / radius)² at the end of a cap or rod; the slope there is √(rim/(1 − rim)).
    pub(super) rim: f64,
}

impl Round {
    fn new(keys: &Arguments<'_>) -> Result<Self, SceneError> {
        Ok(Self {
            size: keys.size(512)?,
            count: keys.whole("count", 4, 1..=1024)?,
            rim: keys.number("rim", 0.9, 0.01..=0.98)?,
        })
    }

    /// Place of a texel in its cell, −1 to 1. With a whole number of texels a cell, rim and axis are both met.
    fn place(&self, texel: u32) -> f64 {
        let cell = f64::from(texel) * f64::from(self.count) / f64::from(self.size);
        2.0 * (cell - cell.floor()) - 1.0
    }

    /// Height in radii at a squared distance from the axis; 0 from the rim on.
    fn height(&self, square: f64) -> f64 {
        if square < self.rim { (1.0 - square).sqrt() - (1.0 - self.rim).sqrt() } else { 0.0 }
    }
}

/// Spherical caps in a square lattice, flat between (F92 Fig. 5). The radius is half a cell.
pub(super) fn hemispheres(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let caps = Round::new(keys)?;
    let heights = grid.square(caps.size, |column, row| {
        let [x, y] = [column, row].map(|texel| caps.place(texel));
        caps.height(x * x + y * y)
    });
    Ok(grey(caps.size, &heights))
}

/// Parallel half cylinders along v that touch at their rims (F92 Fig. 4).
pub(super) fn cylinders(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let rods = Round::new(keys)?;
    let heights = grid.square(rods.size, |column, _| {
        let x = rods.place(column);
        rods.height(rods.rim * x * x)
    });
    Ok(grey(rods.size, &heights))
}

/// Twill of round threads (F92 Fig. 7). Each warp thread, along v, passes over three wefts and under one, one weft
/// further up than its left neighbour.
#[derive(Clone, Debug)]
pub(super) struct Denim {
    /// Edge in texels.
    pub(super) size: u32,
    /// Threads along an edge; a multiple of 4, or there is a seam.
    pub(super) threads: u32,
    /// Height of the yarn's twist, in radii of a thread.
    pub(super) twist: f64,
}

/// The upper thread at a point of the cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Strand {
    /// Height in radii of a thread.
    pub(super) height: f64,
    pub(super) is_warp: bool,
}

/// Wefts after which the weave repeats.
const TWILL: i64 = 4;
/// Height of a crossing thread above the middle of the cloth, in radii.
const CROSSING: f64 = 0.45;
/// Height of a thread's section at its edge, in radii: threads are pressed against each other.
const PRESSED: f64 = 0.6;

impl Denim {
    pub(super) fn new(keys: &Arguments<'_>) -> Result<Self, SceneError> {
        Ok(Self {
            size: keys.size(512)?,
            threads: keys.whole("threads", 16, 4..=1024)?,
            twist: keys.number("twist", 0.1, 0.0..=1.0)?,
        })
    }

    /// The upper thread at the centre of a texel.
    pub(super) fn at(&self, column: u32, row: u32) -> Strand {
        let in_threads = |texel: u32| (f64::from(texel) + 0.5) * f64::from(self.threads) / f64::from(self.size);
        let (u, v) = (in_threads(column), in_threads(self.size - 1 - row));
        let (warp, weft) = (u.floor(), v.floor());
        // Crossings at which the warp passes under have phase 0 at their centres.
        let phase = |u: f64, v: f64| {
            let steps = (v - u) / TWILL as f64;
            (steps - (steps + 0.5).floor()).abs() * TWILL as f64
        };
        let level = |from_under: f64| CROSSING * (2.0 * smoothstep(0.25, 0.95, from_under) - 1.0);
        let warp_level = level(phase(warp + 0.5, v));
        let weft_level = -level(phase(u, weft + 0.5));
        let section = |across: f64, along: f64| {
            let x = 2.0 * (across - across.floor()) - 1.0;
            let twist = self.twist * sin_turns(along + 0.5 * x);
            (1.0 - (1.0 - PRESSED * PRESSED) * x * x).sqrt() + twist * (1.0 - x * x)
        };
        let [warp, weft] = [warp_level + section(u, 2.0 * v), weft_level + section(v, 2.0 * u)];
        Strand { height: warp.max(weft), is_warp: warp >= weft }
    }
}

/// Draws the heights of [`Denim`].
pub(super) fn denim(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let denim = Denim::new(keys)?;
    Ok(grey(denim.size, &grid.square(denim.size, |column, row| denim.at(column, row).height)))
}

#[cfg(test)]
mod tests {
    use super::super::keys::made;
    use super::*;

    fn at(picture: &Picture, column: u32, row: u32) -> f64 {
        f64::from(picture.pixels[(row * picture.width + column) as usize][0])
    }

    /// Mean squares of the differences along u and along v, the seam included.
    fn roughness_along(picture: &Picture) -> [f64; 2] {
        let edge = picture.width;
        let mut sums = [0.0; 2];
        for row in 0..edge {
            for column in 0..edge {
                let here = at(picture, column, row);
                sums[0] += (at(picture, (column + 1) % edge, row) - here).powi(2);
                sums[1] += (at(picture, column, (row + 1) % edge) - here).powi(2);
            }
        }
        sums
    }

    #[test]
    fn scratches_run_along_u_and_cross_the_seam() {
        let map = made(brushed, "size = 128, scratches = 400, width_texels = 3, spread_degrees = 1");
        let [along, across] = roughness_along(&map);
        assert!(across > 50.0 * along, "{along} {across}");
        let seam: f64 = (0..128).map(|row| (at(&map, 127, row) - at(&map, 0, row)).powi(2)).sum();
        assert!(seam < 2.0 * along / 128.0, "{seam} {along}: no steeper than between other columns");
    }

    #[test]
    fn profiles_have_their_periods_along_both_directions() {
        let sheet = made(corrugated, "size = 64, periods_u = 2, periods_v = 1");
        assert_eq!((at(&sheet, 0, 63), at(&sheet, 16, 63)), (1.0, 0.0));
        assert_eq!(at(&sheet, 0, 31), 0.0, "half a period up");
        let grooves = made(grooves, "size = 64, periods_u = 4");
        // Two flanks: every step has one size, up or down.
        assert!((0..63).all(|x| (at(&grooves, x + 1, 0) - at(&grooves, x, 0)).abs() == 0.125));
    }

    #[test]
    fn caps_and_rods_are_round_up_to_their_rim() {
        let round = "size = 256, count = 2, rim = 0.8";
        let full = 1.0 - (1.0 - 0.8_f64).sqrt();
        for (map, scale) in [(made(hemispheres, round), 1.0), (made(cylinders, round), 0.8)] {
            for column in 0..128 {
                // Row 64 runs through the centres of the caps.
                let x = f64::from(column) / 64.0 - 1.0;
                let square = scale * x * x;
                let wanted = if square < 0.8 { ((1.0 - square).sqrt() - (1.0 - 0.8_f64).sqrt()) / full } else { 0.0 };
                // A last bit of f32.
                assert!((at(&map, column, 64) - wanted).abs() < 1e-7, "{column}");
            }
        }
    }

    #[test]
    fn a_warp_thread_passes_over_three_wefts_and_under_one_and_the_pattern_climbs() {
        let cloth = Denim { size: 128, threads: 8, twist: 0.0 };
        for warp in 0..8 {
            for weft in 0..8 {
                let strand = cloth.at(16 * warp + 8, 127 - (16 * weft + 8));
                assert_eq!(strand.is_warp, (weft + 8 - warp) % 4 != 0, "warp {warp}, weft {weft}");
            }
        }
    }

    #[test]
    fn denim_repeats_without_a_seam() {
        let map = made(denim, "size = 64, threads = 4");
        let step = |a: (u32, u32), b: (u32, u32)| (at(&map, a.0, a.1) - at(&map, b.0, b.1)).abs();
        // The same crossing one twill further: across the seam as four threads earlier.
        let tiled = made(denim, "size = 128, threads = 8");
        for texel in 0..64 {
            let seam = step((63, texel), (0, texel));
            let inside = (at(&tiled, 63, texel + 64) - at(&tiled, 64, texel + 64)).abs();
            // Both maps are scaled from 0 to 1 with equal highest and lowest texels.
            assert!((seam - inside).abs() < 1e-6, "row {texel}: {seam} {inside}");
        }
    }
}
