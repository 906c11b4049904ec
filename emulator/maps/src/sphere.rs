//! Coarse levels of an environment, filtered on the sphere.
//!
//! On a level of a few texels, each texel is a piece of the sphere of tens of degrees. The shape and size of the piece depend on its place on the
//! face. Repeated box filters would show the corners of the cube in every picture of a wide lobe. Levels of at most [`COARSE`] texels along an edge
//! therefore come from a finer one by one round kernel, the same everywhere. None has fewer texels than that: a level of half the size would show
//! the gradient of bilinear patches of tens of degrees. Such a level keeps its texels and is blurred accordingly.
//!
//! With n texels along an edge if levels were halved further, a bilinear sample has a standard deviation of 0.54 texels of such a level. The kernel
//! has the part that interpolation of the actual texels lacks. The kernel is near a Gaussian of the tangent of half the angle. This is the lobe of
//! normals around a mirror's, as reflection takes slopes to directions by the stereographic projection. Weights are balanced in turns until every
//! source gives out the light that falls on it and constants stay constant (Sinkhorn and Knopp 1967). A small sun is then equally bright on every
//! level.
//!
//! All operations are exactly rounded float64 +, −, ×, ÷ and √ in a fixed order: the same bits on every machine and for any number of threads.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use roughxel_core::sampler::COARSEST_EDGE;
use roughxel_scene::cube;
use roughxel_simd::{Backend, LANES};

/// Most texels along an edge of a level filtered here.
pub(crate) const COARSE: u32 = COARSEST_EDGE;
/// Most texels along an edge of the source level: its texels differ from pieces of the sphere by a percent.
pub(crate) const SOURCE: u32 = 64;
/// Variance of a bilinear sample in squares of a texel's edge; interpolation has a sixth.
const VARIANCE: f64 = 0.289;
/// Most turns of balancing, and the allowed rest. Narrow kernels keep 0.8 % after all turns, at the corners of the cube.
const TURNS: usize = 32;
const BALANCED: f64 = 0.001;

/// Centre of a piece of the unit sphere, and its solid angle in units of a texel in the middle of a face.
#[derive(Clone, Copy)]
struct Piece {
    direction: [f64; 3],
    solid_angle: f64,
}

/// The texels of six faces, face by face in rows.
fn texels(edge: u32) -> Vec<Piece> {
    let centre = |i: u32| f64::from(2 * i + 1) / f64::from(edge) - 1.0;
    let texel = |face: usize, s: f64, t: f64| {
        let square = 1.0 + s * s + t * t;
        let rho = square.sqrt();
        Piece { direction: cube::direction(face, s, t).map(|x| x / rho), solid_angle: 1.0 / (square * rho) }
    };
    let face = |face| (0..edge * edge).map(move |i| texel(face, centre(i % edge), centre(i / edge)));
    (0..6).flat_map(face).collect()
}

/// Blocks of `block` × `block` texels of faces of `edge`, smaller at the ends: the block of each texel, and the blocks.
fn blocks(edge: u32, block: u32) -> (Vec<u32>, Vec<Piece>) {
    let along = edge.div_ceil(block);
    let block_of = |index: u32| {
        let (face, index) = (index / (edge * edge), index % (edge * edge));
        (face * along + index / edge / block) * along + index % edge / block
    };
    let members: Vec<u32> = (0..6 * edge * edge).map(block_of).collect();
    let mut pieces = vec![Piece { direction: [0.0; 3], solid_angle: 0.0 }; (6 * along * along) as usize];
    for (&member, texel) in members.iter().zip(texels(edge)) {
        let piece = &mut pieces[member as usize];
        piece.solid_angle += texel.solid_angle;
        for (sum, x) in piece.direction.iter_mut().zip(texel.direction) {
            *sum += texel.solid_angle * x;
        }
    }
    for Piece { direction, .. } in &mut pieces {
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        *direction = direction.map(|x| x / length);
    }
    (members, pieces)
}

/// Share of every source in every texel of a level: index of the source and weight, texel by texel. Weights of a texel sum to 1.
type Rows = Vec<Vec<(u32, f64)>>;

struct Kernel {
    /// Block of each texel of the source.
    members: Vec<u32>,
    /// Solid angle of each block.
    solid_angles: Vec<f64>,
    rows: Rows,
}

/// Kept kernels by the edges of level and source and the bits of n. All kernels of a 64-texel source take a tenth of a second on two cores and
/// 35 MB.
static KERNELS: Mutex<BTreeMap<(u32, u32, u64), Arc<Kernel>>> = Mutex::new(BTreeMap::new());

/// A kept kernel, or a new one.
fn kept_kernel(edge: u32, nominal: f64, source_edge: u32) -> Arc<Kernel> {
    let key = (edge, source_edge, nominal.to_bits());
    let find = || KERNELS.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
    // The kernel is made without the lock: a thread that waits for the lock may be one of its workers.
    find().unwrap_or_else(|| {
        let made = Arc::new(kernel(edge, nominal, source_edge));
        KERNELS.lock().unwrap_or_else(PoisonError::into_inner).insert(key, Arc::clone(&made));
        made
    })
}

fn kernel(edge: u32, nominal: f64, source_edge: u32) -> Kernel {
    let targets = texels(edge);
    // The kernel cannot tell more than four sources along a texel of the level apart.
    let wanted = (4.0 * nominal).ceil().max(8.0) as u32;
    let (members, sources) = blocks(source_edge, (source_edge / wanted).max(1));
    let texel = FRAC_PI_2 / nominal;
    let share = nominal / f64::from(edge);
    // Reach of (1 − x²/reach²)⁴ in the plane; its variance along each axis is a twelfth of reach².
    let square_reach = 12.0 * texel * texel * (VARIANCE - share * share / 6.0);
    // Bound of the square of the reach's chord, with room for roundings. It alone excludes nearly all sources.
    let near = 4.0 * square_reach / (4.0 + square_reach) * (1.0 + 1e-9);
    let groups: Vec<[[f64; LANES]; 3]> = sources
        .chunks(LANES)
        .map(|group| {
            [0, 1, 2].map(|axis| std::array::from_fn(|lane| group.get(lane).map_or(0.0, |piece| piece.direction[axis])))
        })
        .collect();
    let mut rows: Rows = targets
        .par_iter()
        .map(|target| {
            let mut row = Vec::new();
            Backend::best().run(
                #[inline(always)]
                || {
                    for (group, directions) in groups.iter().enumerate() {
                        let squares = squares_of_chords(target.direction, directions);
                        if !squares.iter().fold(false, |any, &square| any | (square < near)) {
                            continue;
                        }
                        for (lane, square_of_chord) in squares.into_iter().enumerate() {
                            let index = LANES * group + lane;
                            let Some(source) = sources.get(index) else { break };
                            // 4·cos² of half the angle, and 4·tan² of it.
                            let cosine = 4.0 - square_of_chord;
                            let square = 4.0 * (4.0 - cosine) / cosine;
                            // A piece of the plane is (4/cosine)² as large as that of the sphere.
                            let falling =
                                (1.0 - square / square_reach) * (1.0 - square / square_reach) * (4.0 / cosine);
                            let weight = falling * falling * source.solid_angle;
                            if square < square_reach && weight > 0.0 {
                                row.push((index as u32, weight));
                            }
                        }
                    }
                },
            );
            row
        })
        .collect();
    let given: f64 = sources.iter().map(|source| source.solid_angle).sum();
    let taken: f64 = targets.iter().map(|target| target.solid_angle).sum();
    let mut columns = vec![0.0; sources.len()];
    for _ in 0..TURNS {
        // Every texel takes its own solid angle, then every source gives its own.
        for (row, target) in rows.iter_mut().zip(&targets) {
            let sum: f64 = row.iter().map(|(_, w)| w).sum();
            scale(row, target.solid_angle * given / (taken * sum));
        }
        columns.fill(0.0);
        for &(source, w) in rows.iter().flatten() {
            columns[source as usize] += w;
        }
        let mut left = 0.0_f64;
        for (column, source) in columns.iter_mut().zip(&sources) {
            left = left.max((*column / source.solid_angle - 1.0).abs());
            *column = source.solid_angle / *column;
        }
        if left < BALANCED {
            break;
        }
        for (source, w) in rows.iter_mut().flatten() {
            *w *= columns[*source as usize];
        }
    }
    for row in &mut rows {
        let sum: f64 = row.iter().map(|(_, w)| w).sum();
        scale(row, 1.0 / sum);
    }
    Kernel { members, solid_angles: sources.iter().map(|source| source.solid_angle).collect(), rows }
}

/// Squares of the chords from one point of the unit sphere to other points.
#[inline(always)]
fn squares_of_chords(from: [f64; 3], [xs, ys, zs]: &[[f64; LANES]; 3]) -> [f64; LANES] {
    let mut squares = [0.0; LANES];
    for lane in 0..LANES {
        let (x, y, z) = (from[0] - xs[lane], from[1] - ys[lane], from[2] - zs[lane]);
        squares[lane] = x * x + y * y + z * z;
    }
    squares
}

fn scale(row: &mut [(u32, f64)], factor: f64) {
    for (_, w) in row {
        *w *= factor;
    }
}

/// The source level of coarse levels.
pub(crate) struct Sources {
    edge: u32,
    /// Six faces in rows.
    texels: Vec<[f64; 3]>,
    /// Solid angle of each texel.
    solid_angles: Vec<f64>,
}

impl Sources {
    pub(crate) fn new(edge: u32, light: Vec<[f64; 3]>) -> Self {
        Self { edge, texels: light, solid_angles: texels(edge).iter().map(|texel| texel.solid_angle).collect() }
    }

    /// The texels of a level of `edge` texels a face, six faces in rows, blurred as a level of `nominal` texels.
    pub(crate) fn level(&self, edge: u32, nominal: f64) -> Vec<[f64; 3]> {
        let Kernel { members, solid_angles, rows } = &*kept_kernel(edge, nominal, self.edge);
        let mut light = vec![[0.0; 3]; solid_angles.len()];
        for ((member, texel), solid_angle) in members.iter().zip(&self.texels).zip(&self.solid_angles) {
            let share = solid_angle / solid_angles[*member as usize];
            let sum = &mut light[*member as usize];
            *sum = [0, 1, 2].map(|channel| sum[channel] + share * texel[channel]);
        }
        let mean = |row: &Vec<(u32, f64)>| {
            row.iter().fold([0.0; 3], |sum, &(index, w)| {
                let source = light[index as usize];
                [0, 1, 2].map(|channel| sum[channel] + w * source[channel])
            })
        };
        rows.par_iter().map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels of an environment of 64 texels along an edge, and some other levels.
    const LEVELS: [(u32, f64, u32); 9] = [
        (16, 16.0, 64),
        (16, 8.0, 64),
        (16, 4.0, 64),
        (16, 2.0, 64),
        (16, 1.0, 64),
        (16, 9.25, 37),
        (16, 5.0, 20),
        (3, 1.5, 3),
        (2, 1.0, 2),
    ];

    #[test]
    fn a_kernel_has_every_source_within_its_reach_and_no_other() {
        for (edge, nominal, source_edge) in LEVELS {
            let made = kernel(edge, nominal, source_edge);
            let wanted = (4.0 * nominal).ceil().max(8.0) as u32;
            let (_, sources) = blocks(source_edge, (source_edge / wanted).max(1));
            let (texel, share) = (FRAC_PI_2 / nominal, nominal / f64::from(edge));
            let square_reach = 12.0 * texel * texel * (VARIANCE - share * share / 6.0);
            for (target, row) in texels(edge).iter().zip(&made.rows) {
                let is_inside = |source: &Piece| {
                    let [x, y, z] = [0, 1, 2].map(|i| target.direction[i] - source.direction[i]);
                    let cosine = 4.0 - (x * x + y * y + z * z);
                    4.0 * (4.0 - cosine) / cosine < square_reach
                };
                let inside = (0..).zip(&sources).filter(|(_, source)| is_inside(source)).map(|(index, _)| index);
                assert!(row.iter().map(|&(index, _)| index).eq(inside), "{edge} {nominal} {source_edge}");
            }
        }
    }

    #[test]
    fn every_source_is_as_bright_on_every_level() {
        for (edge, nominal, source_edge) in LEVELS {
            let (targets, Kernel { solid_angles, rows, .. }) = (texels(edge), kernel(edge, nominal, source_edge));
            let (given, taken): (f64, f64) =
                (solid_angles.iter().sum(), targets.iter().map(|target| target.solid_angle).sum());
            let mut columns = vec![0.0; solid_angles.len()];
            for (row, target) in rows.iter().zip(&targets) {
                assert!((row.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
                for &(source, w) in row {
                    columns[source as usize] += w * target.solid_angle * given / taken;
                }
            }
            for (column, solid_angle) in columns.iter().zip(&solid_angles) {
                let ratio = column / solid_angle;
                assert!((ratio - 1.0).abs() < 0.01, "{edge} ({nominal}) of {source_edge}: {ratio}");
            }
        }
    }

    #[test]
    fn the_kernel_is_round_and_of_one_width_everywhere() {
        for (nominal, kernel_deviation) in [(16.0, 0.35), (8.0, 0.5), (4.0, 0.53)] {
            let (edge, source_edge) = (16, 64);
            let (targets, Kernel { rows, .. }) = (texels(edge), kernel(edge, nominal, source_edge));
            let (_, sources) = blocks(source_edge, (source_edge as f64 / (4.0 * nominal)) as u32);
            for (row, target) in rows.iter().zip(&targets) {
                let square = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>();
                let variance: f64 = row
                    .iter()
                    .map(|&(source, w)| w * square(target.direction, sources[source as usize].direction))
                    .sum();
                // The variance is the sum over two axes.
                let deviation = (0.5 * variance).sqrt() * nominal / FRAC_PI_2;
                assert!((deviation / kernel_deviation - 1.0).abs() < 0.2, "{nominal}: {deviation}");
            }
        }
    }
}
