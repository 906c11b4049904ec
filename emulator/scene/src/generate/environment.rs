//! Generated environments: six faces of a cube, linear light, white = 1.

use super::font::glyph;
use super::grid::Grid;
use super::maths::{Random, cos_turns, dot, mix, normalised, sin_turns, smoothstep};
use crate::cube::direction;
use crate::picture::Picture;

/// Samples along the edge of a texel.
const ALONG: usize = 4;
/// Samples of a texel.
const SAMPLES: usize = ALONG * ALONG;

/// The unit direction of each sample of a texel, x, y and z.
type Directions = [[f64; SAMPLES]; 3];
/// The colour of each sample of a texel, channel by channel.
type Colours = [[f32; SAMPLES]; 3];

/// Six faces of the light from each unit direction, averaged over each texel. What `light` captures it captures by value: a loop that reads what it
/// might write becomes no vectors.
fn faces(grid: Grid<'_>, edge: u32, light: impl Fn([f64; 3]) -> [f32; 3] + Copy + Sync) -> [Picture; 6] {
    faces_side_by_side(
        grid,
        edge,
        #[inline(always)]
        move |directions| {
            let (light, mut colours) = (light, [[0.0; SAMPLES]; 3]);
            for sample in 0..SAMPLES {
                set(&mut colours, sample, light(at(directions, sample)));
            }
            colours
        },
    )
}

/// [`faces`] of the light from all directions of a texel.
fn faces_side_by_side(grid: Grid<'_>, edge: u32, light: impl Fn(&Directions) -> Colours + Sync) -> [Picture; 6] {
    std::array::from_fn(|face| {
        let pixels = grid.square(
            edge,
            #[inline(always)]
            |column, row| {
                let mut directions = [[0.0; SAMPLES]; 3];
                for sample in 0..SAMPLES {
                    let offset = [sample % ALONG, sample / ALONG].map(|step| (step as f64 + 0.5) / ALONG as f64);
                    let [s, t] = [f64::from(column) + offset[0], f64::from(row) + offset[1]]
                        .map(|at| 2.0 * at / f64::from(edge) - 1.0);
                    set(&mut directions, sample, normalised(direction(face, s, t)));
                }
                light(&directions).map(|samples| samples.into_iter().fold(0.0, |sum, x| sum + x) / SAMPLES as f32)
            },
        );
        Picture { width: edge, height: edge, pixels }
    })
}

/// What is of one sample.
#[inline(always)]
fn at<T: Copy>([x, y, z]: &[[T; SAMPLES]; 3], sample: usize) -> [T; 3] {
    [x[sample], y[sample], z[sample]]
}

/// Sets it.
#[inline(always)]
fn set<T>([x, y, z]: &mut [[T; SAMPLES]; 3], sample: usize, of: [T; 3]) {
    [x[sample], y[sample], z[sample]] = of;
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

#[inline(always)]
fn chord_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    let difference: [f64; 3] = std::array::from_fn(|axis| a[axis] - b[axis]);
    dot(difference, difference).sqrt()
}

#[inline(always)]
fn add(a: [f32; 3], b: [f32; 3], weight: f64) -> [f32; 3] {
    std::array::from_fn(|channel| a[channel] + b[channel] * weight as f32)
}

/// Ground below, and from the horizon to the zenith above; the horizon itself is a fifth of a degree wide.
#[inline(always)]
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
    let &Moon { moon, glow, zenith, horizon, ground, .. } = sky;
    faces(
        grid,
        edge,
        #[inline(always)]
        move |at| {
            let dark = gradient(at, zenith, horizon, ground);
            let distance = chord_between(at, centre);
            let disc = 1.0 - smoothstep(radius * 0.97, radius * 1.03, distance);
            let beyond = (distance - radius).max(0.0) / reach;
            let near = 1.0 / ((1.0 + beyond * beyond) * (1.0 + beyond * beyond));
            let bright = mix(add(dark, glow, near), moon, disc);
            if at[1] <= 0.0 { dark } else { bright }
        },
    )
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
    // √(n/2) is the standard deviation of the sum.
    let deviation = (WAVES as f64 / 2.0).sqrt();
    faces_side_by_side(
        grid,
        edge,
        #[inline(always)]
        |directions| {
            let mut sums = [0.0; SAMPLES];
            for (vector, phase) in &waves {
                for (sample, sum) in sums.iter_mut().enumerate() {
                    *sum += sin_turns(dot(*vector, at(directions, sample)) + phase);
                }
            }
            let mut colours = [[0.0; SAMPLES]; 3];
            for (sample, sum) in sums.into_iter().enumerate() {
                set(&mut colours, sample, mix(dark, light, smoothstep(-edge_width, edge_width, sum / deviation)));
            }
            colours
        },
    )
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
    let &Sky { zenith, horizon, ground, sun, .. } = sky;
    faces(
        grid,
        edge,
        #[inline(always)]
        move |at| {
            let clear = gradient(at, zenith, horizon, ground);
            let above = mix(sun, clear, smoothstep(radius * 0.97, radius * 1.03, chord_between(at, centre)));
            if at[1] <= 0.0 { clear } else { above }
        },
    )
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
    let &Studio { wall, floor, light } = studio;
    // Coverage of a rectangle with edges a fiftieth wide.
    let inside = |x: f64, y: f64, [left, bottom, right, top]: [f64; 4]| {
        smoothstep(left, left + 0.02, x)
            * (1.0 - smoothstep(right - 0.02, right, x))
            * smoothstep(bottom, bottom + 0.02, y)
            * (1.0 - smoothstep(top - 0.02, top, y))
    };
    faces(
        grid,
        edge,
        #[inline(always)]
        move |[x, y, z]| {
            let room = mix(floor, wall, smoothstep(-0.6, 0.4, y));
            // Seen on the wall x = −1.
            let (u, v) = (-z / x, -y / x);
            let cross = inside(u, v, [-0.12, -0.2, -0.08, 0.9]).max(inside(u, v, [-0.7, 0.33, 0.5, 0.37]));
            let window = inside(u, v, [-0.7, -0.2, 0.5, 0.9]) * (1.0 - cross);
            let strip = 0.6 * inside(z / x, y / x, [0.1, -0.5, 0.35, 1.2]);
            let ceiling = 0.8 * inside(x / y, z / y, [-0.5, -0.9, 0.5, -0.3]);
            // Each on its side alone; of what lies beside it no quotient counts.
            let lamp = if x < -0.05 { window } else { 0.0 };
            let lamp = lamp.max(if x > 0.05 { strip } else { 0.0 });
            mix(room, light, lamp.max(if y > 0.05 { ceiling } else { 0.0 }))
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

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
