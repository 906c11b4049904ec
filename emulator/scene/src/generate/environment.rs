//! Generated environments: six faces of a cube, linear light, white = 1.

use super::font::glyph;
use super::grid::Grid;
use super::keys::BRIGHTEST;
use super::maths::{Random, cos_turns, dot, mix, normalised, sin_turns, smoothstep};
use crate::cube::{direction, from_inside};
use crate::error::SceneError;
use crate::source::Arguments;
use roughxel_assets::Picture;
use roughxel_utilities::limits::MAX_FACE_EDGE;

/// Samples along the edge of a texel.
const ALONG: usize = 4;
/// Samples of a texel.
const SAMPLES: usize = ALONG * ALONG;

/// Unit directions of the samples of a texel: x, y and z.
type Directions = [[f64; SAMPLES]; 3];
/// Colours of the samples of a texel, channel by channel.
type Colours = [[f32; SAMPLES]; 3];

/// Six faces of the light from each unit direction, averaged over each texel. `light` captures by value: a loop that reads what it might write does
/// not vectorise.
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

/// Six faces as [`faces`] makes them, from the light of all directions of a texel at once.
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

/// One sample of each coordinate or channel.
#[inline(always)]
fn at<T: Copy>([x, y, z]: &[[T; SAMPLES]; 3], sample: usize) -> [T; 3] {
    [x[sample], y[sample], z[sample]]
}

/// Sets one sample.
#[inline(always)]
fn set<T>([x, y, z]: &mut [[T; SAMPLES]; 3], sample: usize, of: [T; 3]) {
    [x[sample], y[sample], z[sample]] = of;
}

/// The edge of a face in texels.
fn face_edge(keys: &Arguments<'_>) -> Result<u32, SceneError> {
    keys.whole("face_edge", 256, 1..=MAX_FACE_EDGE)
}

/// A linear colour.
fn colour(keys: &Arguments<'_>, key: &'static str, default: [f32; 3]) -> Result<[f32; 3], SceneError> {
    keys.colour(key, default, BRIGHTEST)
}

/// Unit vector towards a moon or a sun: azimuth 0 is −z, 90 is +x.
fn towards(keys: &Arguments<'_>, elevation_degrees: f64, azimuth_degrees: f64) -> Result<[f64; 3], SceneError> {
    let elevation = keys.number("elevation_degrees", elevation_degrees, -90.0..=90.0)? / 360.0;
    let azimuth = keys.number("azimuth_degrees", azimuth_degrees, -360.0..=360.0)? / 360.0;
    let level = cos_turns(elevation);
    Ok([sin_turns(azimuth) * level, sin_turns(elevation), -cos_turns(azimuth) * level])
}

/// Chord between two unit vectors an angle apart: a monotone measure of the angle without an arc cosine.
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

/// Colour of the ground below the horizon and of the sky from there to the zenith. The horizon is a fifth of a degree
/// wide.
#[inline(always)]
fn gradient(at: [f64; 3], zenith: [f32; 3], horizon: [f32; 3], ground: [f32; 3]) -> [f32; 3] {
    let above = mix(horizon, zenith, at[1].max(0.0).sqrt());
    mix(ground, above, smoothstep(-0.002, 0.002, at[1]))
}

/// A night sky with a moon.
pub(super) fn moon(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<[Picture; 6], SceneError> {
    let edge = face_edge(keys)?;
    let centre = towards(keys, 9.0, 0.0)?;
    let radius = chord(keys.number("radius_degrees", 2.5, 0.1..=45.0)?);
    let moon = colour(keys, "moon", [16.0, 14.5, 11.5])?;
    // Light around the moon, and its reach.
    let glow = colour(keys, "glow", [0.25, 0.24, 0.22])?;
    let reach = chord(keys.number("glow_degrees", 8.0, 0.1..=90.0)?);
    let zenith = colour(keys, "zenith", [0.004, 0.007, 0.02])?;
    let horizon = colour(keys, "horizon", [0.035, 0.05, 0.09])?;
    let ground = colour(keys, "ground", [0.004, 0.005, 0.008])?;
    Ok(faces(
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
    ))
}

/// A zebra's skin all around: a sum of waves of nearly one length and direction, thresholded at zero.
pub(super) fn zebra(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<[Picture; 6], SceneError> {
    const WAVES: usize = 14;
    let edge = face_edge(keys)?;
    let mut random = Random::new(keys.seed()?);
    // Pairs of stripes per radius, across the x direction.
    let stripes = keys.number("stripes", 5.0, 0.25..=64.0)?;
    // Largest turn of single waves away from x.
    let bend_degrees = keys.number("bend_degrees", 24.0, 0.0..=90.0)?;
    // Variation of the stripes' widths, as a share.
    let unevenness = keys.number("unevenness", 0.25, 0.0..=0.9)?;
    // Width of the edge of a stripe, relative to the wave's height.
    let edge_width = keys.number("softness", 0.12, 0.0..=2.0)?.max(1e-6);
    let [light, dark] = keys.two_colours([0.9, 0.88, 0.84], [0.015, 0.012, 0.01], BRIGHTEST)?;
    let waves: [([f64; 3], f64); WAVES] = std::array::from_fn(|_| {
        let turns = [0; 2].map(|_| bend_degrees / 360.0 * 2.0 * random.bell());
        let length = stripes * (1.0 + unevenness * random.bell());
        let level = cos_turns(turns[1]) * length;
        let vector = [cos_turns(turns[0]) * level, sin_turns(turns[1]) * length, sin_turns(turns[0]) * level];
        (vector, random.unit())
    });
    // √(n/2) is the standard deviation of the sum.
    let deviation = (WAVES as f64 / 2.0).sqrt();
    Ok(faces_side_by_side(
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
    ))
}

/// Squares on each face, tinted per face, with the face's name in the middle: a map to tell faces apart.
pub(super) fn checker(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<[Picture; 6], SceneError> {
    const TINTS: [[f32; 3]; 6] =
        [[1.0, 0.3, 0.3], [0.3, 1.0, 1.0], [0.3, 1.0, 0.3], [1.0, 0.3, 1.0], [0.3, 0.3, 1.0], [1.0, 1.0, 0.3]];
    const NAMES: [[char; 2]; 6] = [['+', 'X'], ['-', 'X'], ['+', 'Y'], ['-', 'Y'], ['+', 'Z'], ['-', 'Z']];
    let edge = face_edge(keys)?;
    // Squares along the edge of a face.
    let squares = keys.whole("squares", 8, 1..=2048)?;
    // Tint: 0 for none, 1 for the full colour of the face.
    let tint = keys.number("tint", 0.5, 0.0..=1.0)?;
    let colours = keys.two_colours([0.9; 3], [0.05; 3], BRIGHTEST)?;
    Ok(std::array::from_fn(|face| {
        let tint = mix([1.0; 3], TINTS[face], tint);
        let pixels = grid.square(edge, |column, row| {
            let square_of = |index: u32| u64::from(index) * u64::from(squares) / u64::from(edge);
            // The name takes 11 × 7 cells of a 32nd of the face, and is read from inside.
            let cell = |index: usize, first: i64| (index as u64 * 32 / u64::from(edge)) as i64 - first;
            let [right, down] = from_inside(face, edge as usize, [column as usize, row as usize]);
            let (x, y) = (cell(right, 10), cell(down, 12));
            let letter = match x {
                0..=4 => glyph(NAMES[face][0]).map(|rows| (rows, x)),
                6..=10 => glyph(NAMES[face][1]).map(|rows| (rows, x - 6)),
                _ => None,
            };
            let is_ink = letter.is_some_and(|(rows, x)| (0..7).contains(&y) && rows[y as usize] >> (4 - x) & 1 == 1);
            let shade = if is_ink { 1 } else { ((square_of(column) + square_of(row)) % 2) as usize };
            let colour = if is_ink { [0.0; 3] } else { colours[shade] };
            std::array::from_fn(|channel| colour[channel] * tint[channel])
        });
        Picture { width: edge, height: edge, pixels }
    }))
}

/// A day sky with a sun.
pub(super) fn sky(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<[Picture; 6], SceneError> {
    let edge = face_edge(keys)?;
    let zenith = colour(keys, "zenith", [0.12, 0.28, 0.7])?;
    let horizon = colour(keys, "horizon", [0.75, 0.85, 0.95])?;
    let ground = colour(keys, "ground", [0.2, 0.17, 0.13])?;
    let sun = colour(keys, "sun", [12.0, 11.0, 9.0])?;
    let centre = towards(keys, 40.0, -60.0)?;
    let radius = chord(keys.number("radius_degrees", 3.0, 0.1..=45.0)?);
    Ok(faces(
        grid,
        edge,
        #[inline(always)]
        move |at| {
            let clear = gradient(at, zenith, horizon, ground);
            let above = mix(sun, clear, smoothstep(radius * 0.97, radius * 1.03, chord_between(at, centre)));
            if at[1] <= 0.0 { clear } else { above }
        },
    ))
}

/// A dark room with three lamps covered by white cloth: a window with a cross, a strip and a ceiling panel.
pub(super) fn studio(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<[Picture; 6], SceneError> {
    let edge = face_edge(keys)?;
    let wall = colour(keys, "wall", [0.12, 0.12, 0.13])?;
    let floor = colour(keys, "floor", [0.05, 0.045, 0.04])?;
    let light = colour(keys, "light", [3.0, 2.9, 2.7])?;
    // Coverage of a rectangle with edges a fiftieth wide.
    let inside = |x: f64, y: f64, [left, bottom, right, top]: [f64; 4]| {
        smoothstep(left, left + 0.02, x)
            * (1.0 - smoothstep(right - 0.02, right, x))
            * smoothstep(bottom, bottom + 0.02, y)
            * (1.0 - smoothstep(top - 0.02, top, y))
    };
    Ok(faces(
        grid,
        edge,
        #[inline(always)]
        move |[x, y, z]| {
            let room = mix(floor, wall, smoothstep(-0.6, 0.4, y));
            // u and v on the wall x = −1.
            let (u, v) = (-z / x, -y / x);
            let cross = inside(u, v, [-0.12, -0.2, -0.08, 0.9]).max(inside(u, v, [-0.7, 0.33, 0.5, 0.37]));
            let window = inside(u, v, [-0.7, -0.2, 0.5, 0.9]) * (1.0 - cross);
            let strip = 0.6 * inside(z / x, y / x, [0.1, -0.5, 0.35, 1.2]);
            let ceiling = 0.8 * inside(x / y, z / y, [-0.5, -0.9, 0.5, -0.3]);
            // Each lamp is on one side alone; quotients of directions away from it do not count.
            let lamp = if x < -0.05 { window } else { 0.0 };
            let lamp = lamp.max(if x > 0.05 { strip } else { 0.0 });
            mix(room, light, lamp.max(if y > 0.05 { ceiling } else { 0.0 }))
        },
    ))
}

#[cfg(test)]
mod tests {
    use super::super::keys::made;
    use super::*;

    #[test]
    fn faces_meet_without_a_step() {
        let keys = "face_edge = 32, stripes = 1, bend_degrees = 20, unevenness = 0.2, softness = 1, \
                    light = [1, 1, 1], dark = [0, 0, 0]";
        let [right, _, _, _, front, _] = made(zebra, keys);
        for row in 0..32 {
            let step = (front.pixels[row * 32 + 31][0] - right.pixels[row * 32][0]).abs();
            // One texel is 1/16 of a radius: slope of the edge (¾ per softness) times the wave's slope 2π·√2 a radius.
            assert!(step < 0.5, "row {row}: {step}");
        }
    }

    #[test]
    fn names_of_faces_are_read_from_inside() {
        let faces = made(checker, "face_edge = 64, squares = 1, tint = 0, light = [1, 1, 1]");
        for (face, picture) in faces.iter().enumerate() {
            let [sign, axis] = [["+", "-"][face % 2], ["X", "Y", "Z"][face / 2]];
            for (name, first) in [(sign, 10), (axis, 16)] {
                let wanted = glyph(name.chars().next().unwrap()).unwrap();
                for (cell, row) in (0..7).flat_map(|row| (0..5).map(move |column| ([column, row], wanted[row]))) {
                    let pixel = [2 * (first + cell[0]), 2 * (12 + cell[1])];
                    let [column, row_of_face] = from_inside(face, 64, pixel);
                    let is_ink = picture.pixels[row_of_face * 64 + column] == [0.0; 3];
                    assert_eq!(is_ink, row >> (4 - cell[0]) & 1 == 1, "face {face}, {name}, {cell:?}");
                }
            }
        }
    }

    #[test]
    fn the_moon_stands_where_it_is_told_to() {
        let keys = "face_edge = 32, elevation_degrees = 0, azimuth_degrees = 90, radius_degrees = 5, moon = [9, 9, 9], \
                    glow = [0, 0, 0], glow_degrees = 1, zenith = [0, 0, 0], horizon = [0, 0, 0], ground = [0, 0, 0]";
        let faces = made(moon, keys);
        assert_eq!(faces[0].pixels[15 * 32 + 16], [9.0; 3], "azimuth 90 is +x, just above the horizon");
        assert_eq!(faces[0].pixels[16 * 32 + 16], [0.0; 3], "the part below the horizon is hidden");
        assert!(faces[5].pixels.iter().all(|pixel| *pixel == [0.0; 3]));
    }
}
