//! Generated environments: six faces of a cube, linear light, white = 1.

use super::font::glyph;
use super::grid::Grid;
use super::maths::{Random, cos_turns, dot, mix, normalised, sin_turns, smoothstep};
use crate::picture::Picture;

/// Samples along the edge of a texel.
const SAMPLES: u32 = 4;

/// Direction of face `face` (Vulkan's order and table) at s, t in [−1, 1]; t = −1 is the top row.
fn face_direction(face: usize, s: f64, t: f64) -> [f64; 3] {
    match face {
        0 => [1.0, -t, -s],
        1 => [-1.0, -t, s],
        2 => [s, 1.0, t],
        3 => [s, -1.0, -t],
        4 => [s, -t, 1.0],
        _ => [-s, -t, -1.0],
    }
}

/// Six faces of the light from each unit direction, averaged over each texel.
fn faces(grid: Grid<'_>, edge: u32, light: impl Fn([f64; 3]) -> [f32; 3] + Sync) -> [Picture; 6] {
    std::array::from_fn(|face| {
        let pixels = grid.square(edge, |column, row| {
            let mut sum = [0.0f32; 3];
            for sample in 0..SAMPLES * SAMPLES {
                let offset =
                    [sample % SAMPLES, sample / SAMPLES].map(|step| (f64::from(step) + 0.5) / f64::from(SAMPLES));
                let [s, t] = [f64::from(column) + offset[0], f64::from(row) + offset[1]]
                    .map(|at| 2.0 * at / f64::from(edge) - 1.0);
                let colour = light(normalised(face_direction(face, s, t)));
                for (total, channel) in sum.iter_mut().zip(colour) {
                    *total += channel;
                }
            }
            sum.map(|total| total / (SAMPLES * SAMPLES) as f32)
        });
        Picture { width: edge, height: edge, pixels }
    })
}

/// Unit vector; azimuth 0 is −z, 90 is +x.
fn towards(elevation_degrees: f64, azimuth_degrees: f64) -> [f64; 3] {
    let (elevation, azimuth) = (elevation_degrees / 360.0, azimuth_degrees / 360.0);
    let level = cos_turns(elevation);
    [sin_turns(azimuth) * level, sin_turns(elevation), -cos_turns(azimuth) * level]
}

/// Chord between two unit vectors an angle apart: a monotone measure of the angle that needs no arc cosine.
fn chord(degrees: f64) -> f64 {
    2.0 * sin_turns(degrees.abs() / 720.0)
}

fn chord_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    let difference: [f64; 3] = std::array::from_fn(|axis| a[axis] - b[axis]);
    dot(difference, difference).sqrt()
}

fn add(a: [f32; 3], b: [f32; 3], weight: f64) -> [f32; 3] {
    std::array::from_fn(|channel| a[channel] + b[channel] * weight as f32)
}

/// Ground below, and from the horizon to the zenith above; the horizon itself is a fifth of a degree wide.
fn gradient(at: [f64; 3], zenith: [f32; 3], horizon: [f32; 3], ground: [f32; 3]) -> [f32; 3] {
    let above = mix(horizon, zenith, at[1].max(0.0).sqrt());
    mix(ground, above, smoothstep(-0.002, 0.002, at[1]))
}

/// A night sky with a moon.
#[derive(Clone, Debug)]
pub(super) struct Moon {
    pub(super) elevation_degrees: f64,
    pub(super) azimuth_degrees: f64,
    pub(super) radius_degrees: f64,
    pub(super) moon: [f32; 3],
    /// Light around the moon and how far it reaches.
    pub(super) glow: [f32; 3],
    pub(super) glow_degrees: f64,
    pub(super) zenith: [f32; 3],
    pub(super) horizon: [f32; 3],
    pub(super) ground: [f32; 3],
}

/// Draws [`Moon`].
pub(super) fn moon(grid: Grid<'_>, sky: &Moon, edge: u32) -> [Picture; 6] {
    let centre = towards(sky.elevation_degrees, sky.azimuth_degrees);
    let radius = chord(sky.radius_degrees);
    let reach = chord(sky.glow_degrees);
    faces(grid, edge, |at| {
        let dark = gradient(at, sky.zenith, sky.horizon, sky.ground);
        let distance = chord_between(at, centre);
        if at[1] <= 0.0 {
            return dark;
        }
        let disc = 1.0 - smoothstep(radius * 0.97, radius * 1.03, distance);
        let beyond = (distance - radius).max(0.0) / reach;
        let glow = 1.0 / ((1.0 + beyond * beyond) * (1.0 + beyond * beyond));
        mix(add(dark, sky.glow, glow), sky.moon, disc)
    })
}

/// The skin of a zebra all around: a sum of waves of nearly one length and direction, cut at zero.
#[derive(Clone, Debug)]
pub(super) struct Zebra {
    pub(super) seed: u32,
    /// Pairs of stripes per radius, across the x direction.
    pub(super) stripes: f64,
    /// How far single waves turn away from it.
    pub(super) bend_degrees: f64,
    /// How much the widths of the stripes vary, as a share.
    pub(super) unevenness: f64,
    /// Width of the edge of a stripe, relative to the wave's height.
    pub(super) softness: f64,
    /// Of the light and the dark stripes.
    pub(super) colours: [[f32; 3]; 2],
}

/// Draws [`Zebra`].
pub(super) fn zebra(grid: Grid<'_>, zebra: &Zebra, edge: u32) -> [Picture; 6] {
    const WAVES: usize = 14;
    let mut random = Random::new(zebra.seed);
    let waves: [([f64; 3], f64); WAVES] = std::array::from_fn(|_| {
        let turns = [0; 2].map(|_| zebra.bend_degrees / 360.0 * 2.0 * random.bell());
        let length = zebra.stripes * (1.0 + zebra.unevenness * random.bell());
        let level = cos_turns(turns[1]) * length;
        let vector = [cos_turns(turns[0]) * level, sin_turns(turns[1]) * length, sin_turns(turns[0]) * level];
        (vector, random.unit())
    });
    let [light, dark] = zebra.colours;
    let edge_width = zebra.softness.max(1e-6);
    faces(grid, edge, |at| {
        let sum: f64 = waves.iter().map(|(vector, phase)| sin_turns(dot(*vector, at) + phase)).sum();
        // √(n/2) is the standard deviation of the sum.
        let height = sum / (WAVES as f64 / 2.0).sqrt();
        mix(dark, light, smoothstep(-edge_width, edge_width, height))
    })
}

/// Squares on each face, tinted per face, with the face's name in its middle: to see which face is where.
#[derive(Clone, Debug)]
pub(super) struct Checker {
    /// Squares along the edge of a face.
    pub(super) squares: u32,
    /// 0: no tint; 1: the full colour of the face.
    pub(super) tint: f64,
    pub(super) colours: [[f32; 3]; 2],
}

/// Draws [`Checker`].
pub(super) fn checker(grid: Grid<'_>, checker: &Checker, edge: u32) -> [Picture; 6] {
    const TINTS: [[f32; 3]; 6] =
        [[1.0, 0.3, 0.3], [0.3, 1.0, 1.0], [0.3, 1.0, 0.3], [1.0, 0.3, 1.0], [0.3, 0.3, 1.0], [1.0, 1.0, 0.3]];
    const NAMES: [[char; 2]; 6] = [['+', 'X'], ['-', 'X'], ['+', 'Y'], ['-', 'Y'], ['+', 'Z'], ['-', 'Z']];
    std::array::from_fn(|face| {
        let tint = mix([1.0; 3], TINTS[face], checker.tint);
        let pixels = grid.square(edge, |column, row| {
            let square_of = |index: u32| u64::from(index) * u64::from(checker.squares) / u64::from(edge);
            // The name takes 11 × 7 cells of a 32nd of the face.
            let cell = |index: u32, first: i64| (u64::from(index) * 32 / u64::from(edge)) as i64 - first;
            let (x, y) = (cell(column, 10), cell(row, 12));
            let letter = match x {
                0..=4 => glyph(NAMES[face][0]).map(|rows| (rows, x)),
                6..=10 => glyph(NAMES[face][1]).map(|rows| (rows, x - 6)),
                _ => None,
            };
            let is_ink = letter.is_some_and(|(rows, x)| (0..7).contains(&y) && rows[y as usize] >> (4 - x) & 1 == 1);
            let shade = if is_ink { 1 } else { ((square_of(column) + square_of(row)) % 2) as usize };
            let colour = if is_ink { [0.0; 3] } else { checker.colours[shade] };
            std::array::from_fn(|channel| colour[channel] * tint[channel])
        });
        Picture { width: edge, height: edge, pixels }
    })
}

/// A day sky with a sun.
#[derive(Clone, Debug)]
pub(super) struct Sky {
    pub(super) zenith: [f32; 3],
    pub(super) horizon: [f32; 3],
    pub(super) ground: [f32; 3],
    pub(super) sun: [f32; 3],
    pub(super) elevation_degrees: f64,
    pub(super) azimuth_degrees: f64,
    pub(super) radius_degrees: f64,
}

/// Draws [`Sky`].
pub(super) fn sky(grid: Grid<'_>, sky: &Sky, edge: u32) -> [Picture; 6] {
    let centre = towards(sky.elevation_degrees, sky.azimuth_degrees);
    let radius = chord(sky.radius_degrees);
    faces(grid, edge, |at| {
        let clear = gradient(at, sky.zenith, sky.horizon, sky.ground);
        if at[1] <= 0.0 {
            return clear;
        }
        mix(sky.sun, clear, smoothstep(radius * 0.97, radius * 1.03, chord_between(at, centre)))
    })
}

/// A dark room with three lamps behind white cloth: a window with a cross, a strip and a ceiling panel.
#[derive(Clone, Debug)]
pub(super) struct Studio {
    pub(super) wall: [f32; 3],
    pub(super) floor: [f32; 3],
    pub(super) light: [f32; 3],
}

/// Draws [`Studio`].
pub(super) fn studio(grid: Grid<'_>, studio: &Studio, edge: u32) -> [Picture; 6] {
    // Coverage of a rectangle with edges a fiftieth wide.
    let inside = |x: f64, y: f64, [left, bottom, right, top]: [f64; 4]| {
        smoothstep(left, left + 0.02, x)
            * (1.0 - smoothstep(right - 0.02, right, x))
            * smoothstep(bottom, bottom + 0.02, y)
            * (1.0 - smoothstep(top - 0.02, top, y))
    };
    faces(grid, edge, |at| {
        let [x, y, z] = at;
        let room = mix(studio.floor, studio.wall, smoothstep(-0.6, 0.4, y));
        let mut lamp = 0.0f64;
        if x < -0.05 {
            // Seen on the wall x = −1.
            let (u, v) = (-z / x, -y / x);
            let cross = inside(u, v, [-0.12, -0.2, -0.08, 0.9]).max(inside(u, v, [-0.7, 0.33, 0.5, 0.37]));
            lamp = lamp.max(inside(u, v, [-0.7, -0.2, 0.5, 0.9]) * (1.0 - cross));
        }
        if x > 0.05 {
            lamp = lamp.max(0.6 * inside(z / x, y / x, [0.1, -0.5, 0.35, 1.2]));
        }
        if y > 0.05 {
            lamp = lamp.max(0.8 * inside(x / y, z / y, [-0.5, -0.9, 0.5, -0.3]));
        }
        mix(room, studio.light, lamp)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_follow_the_table_of_vulkan() {
        // (s_c, t_c) of the face that holds the direction, as Vulkan prints them.
        let table: [fn([f64; 3]) -> [f64; 2]; 6] = [
            |[_, y, z]| [-z, -y],
            |[_, y, z]| [z, -y],
            |[x, _, z]| [x, z],
            |[x, _, z]| [x, -z],
            |[x, y, _]| [x, -y],
            |[x, y, _]| [-x, -y],
        ];
        for (face, coordinates) in table.into_iter().enumerate() {
            for (s, t) in [(0.25, -0.5), (-0.75, 0.125)] {
                let direction = face_direction(face, s, t);
                assert_eq!(coordinates(direction), [s, t]);
                assert_eq!(direction[face / 2], if face % 2 == 0 { 1.0 } else { -1.0 });
            }
        }
    }

    #[test]
    fn faces_meet_without_a_step() {
        let zebra = Zebra {
            seed: 1,
            stripes: 1.0,
            bend_degrees: 20.0,
            unevenness: 0.2,
            softness: 1.0,
            colours: [[1.0; 3], [0.0; 3]],
        };
        let [right, _, _, _, front, _] = zebra_faces(&zebra);
        for row in 0..32 {
            let step = (front.pixels[row * 32 + 31][0] - right.pixels[row * 32][0]).abs();
            // One texel is 1/16 of a radius: slope of the edge (¾ per softness) times the wave's slope 2π·√2 a radius.
            assert!(step < 0.5, "row {row}: {step}");
        }
    }

    fn zebra_faces(zebra_parameters: &Zebra) -> [Picture; 6] {
        zebra(Grid::unseen(), zebra_parameters, 32)
    }

    #[test]
    fn the_moon_stands_where_it_is_told_to() {
        let sky = Moon {
            elevation_degrees: 0.0,
            azimuth_degrees: 90.0,
            radius_degrees: 5.0,
            moon: [9.0; 3],
            glow: [0.0; 3],
            glow_degrees: 1.0,
            zenith: [0.0; 3],
            horizon: [0.0; 3],
            ground: [0.0; 3],
        };
        let faces = moon(Grid::unseen(), &sky, 32);
        assert_eq!(faces[0].pixels[15 * 32 + 16], [9.0; 3], "azimuth 90 is +x, just above the horizon");
        assert_eq!(faces[0].pixels[16 * 32 + 16], [0.0; 3], "the part below the horizon is hidden");
        assert!(faces[5].pixels.iter().all(|pixel| *pixel == [0.0; 3]));
    }
}
