//! Generated height maps: grey pictures from 0 to 1.

use super::grid::Grid;
use super::maths::{Random, cos_turns, hash, lattice_noise, sin_turns, smoothstep};
use crate::error::SceneError;
use crate::source::Arguments;
use roughxel_assets::Picture;

/// Wind-driven waves: a sum of sines whose wave vectors are whole cycles per repeat, so the map tiles.
pub(super) fn waves(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let size = keys.size(512)?;
    let mut random = Random::new(keys.seed()?);
    let count = keys.whole("count", 64, 1..=1024)?;
    // Longest and shortest waves in cycles per repeat; wave numbers are spread evenly in their logarithm.
    let lowest = keys.number("lowest", 3.0, 1.0..=1024.0)?;
    let highest = keys.number("highest", 64.0, 1.0..=1024.0)?;
    let (low, high) = (lowest.min(highest), lowest.max(highest));
    // Direction of the waves, from +u towards +v, and the largest turn of single waves away from it.
    let direction_degrees = keys.number("direction_degrees", 90.0, -360.0..=360.0)?;
    let spread_degrees = keys.number("spread_degrees", 60.0, 0.0..=180.0)?;
    // The slope of a wave of k cycles is proportional to k^−falloff.
    let falloff = keys.number("falloff", 0.5, -4.0..=4.0)?;
    let tables: Vec<(u32, u32, Vec<f64>)> = (0..count)
        .map(|index| {
            let share = (f64::from(index) + random.unit()) / f64::from(count);
            let cycles = low * power(high / low, share);
            let turns = (direction_degrees + spread_degrees * random.bell()) / 360.0;
            let phase = random.unit();
            let [mut k_u, k_v] = [cos_turns(turns), sin_turns(turns)].map(|along| (cycles * along).round());
            if k_u == 0.0 && k_v == 0.0 {
                k_u = 1.0;
            }
            let length = (k_u * k_u + k_v * k_v).sqrt();
            let amplitude = 1.0 / (length * power(length, falloff));
            let table =
                (0..size).map(|step| amplitude * sin_turns(f64::from(step) / f64::from(size) + phase)).collect();
            let wrapped = |cycles: f64| (cycles as i64).rem_euclid(i64::from(size)) as u32;
            (wrapped(k_u), wrapped(k_v), table)
        })
        .collect();
    let heights = grid.square(size, |column, row| {
        let up = u64::from(size - 1 - row);
        let at = |k_u: u32, k_v: u32| (u64::from(k_u) * u64::from(column) + u64::from(k_v) * up) % u64::from(size);
        tables.iter().map(|(k_u, k_v, table)| table[at(*k_u, *k_v) as usize]).sum::<f64>()
    });
    Ok(grey(size, &heights))
}

/// Rings around drops, fading out at their reach.
pub(super) fn ripples(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let size = keys.size(512)?;
    let mut random = Random::new(keys.seed()?);
    let drops = keys.whole("drops", 8, 1..=256)?;
    // Rings per repeat.
    let rings = keys.number("rings", 12.0, 0.5..=256.0)?;
    // Radius in repeats, at most ½, so that rings end before they overlap.
    let reach = keys.number("reach", 0.3, 0.01..=0.5)?;
    let drops: Vec<[f64; 3]> = (0..drops).map(|_| [random.unit(), random.unit(), random.unit()]).collect();
    let heights = grid.square(
        size,
        #[inline(always)]
        |column, row| {
            let at = [column, row].map(|index| f64::from(index) / f64::from(size));
            drops
                .iter()
                .map(|[x, y, phase]| {
                    let [dx, dy] = [at[0] - x, at[1] - y].map(|distance| distance - (distance + 0.5).floor());
                    let distance = (dx * dx + dy * dy).sqrt();
                    let fade = 1.0 - smoothstep(0.0, reach, distance);
                    fade * sin_turns(distance * rings + phase)
                })
                .sum::<f64>()
        },
    );
    Ok(grey(size, &heights))
}

/// Smooth bumps: octaves of lattice noise.
pub(super) fn bumps(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let (size, first_seed) = (keys.size(512)?, keys.seed()?);
    // Bumps per repeat in the first octave.
    let first_cells = keys.whole("cells", 8, 1..=512)?;
    let octaves = keys.whole("octaves", 3, 1..=8)?;
    // Height of an octave relative to the previous one, which has half as many cells.
    let gain = keys.number("gain", 0.5, 0.0..=1.0)?;
    let heights = grid.square(
        size,
        #[inline(always)]
        |column, row| {
            let at = [column, row].map(|index| f64::from(index) / f64::from(size));
            let mut height = 0.0;
            let mut weight = 1.0;
            for octave in 0..octaves {
                let cells = first_cells << octave;
                let seed = hash(u64::from(first_seed), i64::from(octave), 0, 0);
                let scaled = [at[0] * f64::from(cells), at[1] * f64::from(cells), 0.5];
                height += weight * lattice_noise(seed, scaled, [i64::from(cells), i64::from(cells), 0]);
                weight *= gain;
            }
            height
        },
    );
    Ok(grey(size, &heights))
}

/// A planet with sea and land, by longitude and latitude.
#[derive(Clone, Debug)]
pub(super) struct Earth {
    /// Height in texels; the width is twice the height.
    pub(super) size: u32,
    pub(super) seed: u32,
    /// Cells of the first octave per radius.
    pub(super) detail: f64,
    pub(super) octaves: u32,
    /// Level of the sea, 0 to 1.
    pub(super) sea: f64,
}

impl Earth {
    pub(super) fn new(keys: &Arguments<'_>) -> Result<Self, SceneError> {
        Ok(Self {
            size: keys.size(512)?,
            seed: keys.seed()?,
            detail: keys.number("detail", 1.6, 0.25..=16.0)?,
            octaves: keys.whole("octaves", 6, 1..=10)?,
            sea: keys.number("sea", 0.55, 0.0..=1.0)?,
        })
    }

    /// Height above the sea, from −1 to 1 at most, at a unit vector.
    #[inline(always)]
    pub(super) fn height_above_sea(&self, at: [f64; 3]) -> f64 {
        let (mut sum, mut weight, mut total, mut frequency) = (0.0, 1.0, 0.0, self.detail);
        for octave in 0..self.octaves {
            let seed = hash(u64::from(self.seed), i64::from(octave), 1, 0);
            sum += weight * lattice_noise(seed, at.map(|x| x * frequency + 100.0), [0; 3]);
            total += weight;
            weight *= 0.55;
            frequency *= 2.0;
        }
        // Sums of octaves rarely leave the middle third of their range.
        (1.5 * sum / total).clamp(-1.0, 1.0) * 0.5 + 0.5 - self.sea
    }

    /// Unit vector of the centre of a texel. The middle column faces +z; the top row is the north.
    #[inline(always)]
    pub(super) fn direction(&self, column: f64, row: f64) -> [f64; 3] {
        let longitude = column / f64::from(2 * self.size);
        let latitude = 0.25 - 0.5 * row / f64::from(self.size);
        let (sin, cos) = (sin_turns(longitude), cos_turns(longitude));
        let radius = cos_turns(latitude);
        [-sin * radius, sin_turns(latitude), -cos * radius]
    }
}

/// Draws the relief of [`Earth`]. The sea is flat, and so are the last four degrees at the poles, where the rows of the
/// map meet in one point.
pub(super) fn earth(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let earth = Earth::new(keys)?;
    let (width, height) = (2 * earth.size, earth.size);
    let heights = grid.rectangle(
        width,
        height,
        #[inline(always)]
        |column, row| {
            let at = earth.direction(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let polar = 1.0 - smoothstep(sin_turns(82.0 / 360.0), sin_turns(86.0 / 360.0), at[1].abs());
            polar * earth.height_above_sea(at).max(0.0)
        },
    );
    Ok(grey(width, &heights))
}

/// Grey picture of `width` columns with the lowest height at 0 and the highest at 1; all 0 if they are equal.
pub(super) fn grey(width: u32, heights: &[f64]) -> Picture {
    let (low, high) =
        heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(*h), high.max(*h)));
    let range = if high > low { high - low } else { 1.0 };
    let pixels = heights.iter().map(|height| [((height - low) / range) as f32; 3]).collect::<Vec<_>>();
    Picture { width, height: pixels.len() as u32 / width, pixels }
}

/// `base` to the power of `exponent` (base > 0), built from square roots: bit for bit the same everywhere.
///
/// The exponent is rounded to a multiple of 2⁻²⁰.
fn power(base: f64, exponent: f64) -> f64 {
    let base = if exponent < 0.0 { 1.0 / base } else { base };
    let whole = exponent.abs().floor();
    let mut product = (0..whole as u32).fold(1.0, |product, _| product * base);
    let mut fraction = ((exponent.abs() - whole) * f64::from(1 << 20)).round() / f64::from(1 << 20);
    let mut root = base;
    for _ in 0..20 {
        root = root.sqrt();
        fraction *= 2.0;
        if fraction >= 1.0 {
            fraction -= 1.0;
            product *= root;
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::super::keys::made;
    use super::*;

    #[test]
    fn powers_by_square_roots_agree_with_the_library() {
        for base in [0.02, 0.7, 1.0, 3.0, 64.0] {
            for exponent in [-3.3, -0.5, 0.0, 0.25, 0.999, 1.0, 2.75] {
                let wanted = f64::powf(base, exponent);
                // Half a step of the exponent, 2⁻²¹, times ln(base) ≤ 4.2.
                assert!((power(base, exponent) / wanted - 1.0).abs() < 2.1e-6, "{base}^{exponent}");
            }
        }
    }

    /// Largest step between neighbours inside a map and across its seam.
    fn steps(picture: &Picture) -> (f32, f32) {
        let (width, height) = (picture.width as usize, picture.height as usize);
        let at = |column: usize, row: usize| picture.pixels[row * width + column][0];
        let (mut inside, mut across) = (0.0f32, 0.0f32);
        for row in 0..height {
            for column in 0..width {
                let step_u = (at((column + 1) % width, row) - at(column, row)).abs();
                let step_v = (at(column, (row + 1) % height) - at(column, row)).abs();
                let u = if column + 1 == width { &mut across } else { &mut inside };
                *u = u.max(step_u);
                let v = if row + 1 == height { &mut across } else { &mut inside };
                *v = v.max(step_v);
            }
        }
        (inside, across)
    }

    #[test]
    fn waves_ripples_and_bumps_repeat_without_a_seam() {
        let maps = [
            made(
                waves,
                "size = 64, seed = 3, count = 20, lowest = 1, highest = 6, direction_degrees = 30, spread_degrees = 40",
            ),
            made(ripples, "size = 64, seed = 3, drops = 5, rings = 5, reach = 0.45"),
            made(bumps, "size = 64, seed = 3, cells = 3, octaves = 2"),
        ];
        for map in maps {
            let (inside, across) = steps(&map);
            assert!(across <= inside, "{across} {inside}");
            let darkest = map.pixels.iter().fold(1.0f32, |low, pixel| low.min(pixel[0]));
            let brightest = map.pixels.iter().fold(0.0f32, |high, pixel| high.max(pixel[0]));
            assert_eq!((darkest, brightest), (0.0, 1.0));
        }
    }

    #[test]
    fn the_relief_is_flat_at_the_poles() {
        let relief = made(earth, "size = 128, octaves = 4, sea = 0.3");
        let width = relief.width as usize;
        let pole_rows = relief.pixels[..width].iter().chain(&relief.pixels[127 * width..]);
        assert!(pole_rows.into_iter().all(|pixel| pixel[0] == 0.0));
    }
}
