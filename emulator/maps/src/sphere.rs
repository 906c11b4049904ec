//! Coarse levels of an environment, filtered on the sphere.
//!
//! A texel of a level of a few texels is a piece of the sphere of tens of degrees, whose shape and size depend on where it lies on its face, and
//! box after box leaves the corners of the cube in every picture of a wide lobe. So levels of at most [`COARSE`] texels along an edge come
//! from finer ones by one round kernel, the same everywhere: near a Gaussian of standard deviation 0.35 texels. Its weights are balanced in
//! turns until every source gives out the light that falls on it and constants stay constant (Sinkhorn and Knopp 1967), so that a small sun is
//! as bright on every level.
//!
//! In float64 by exactly rounded +, −, ×, ÷ and √ in a fixed order: the same bits on every machine and for any number of threads.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use roughxel_scene::cube::FACE_AXES;

/// Texels along an edge of a face of the levels that are filtered here, at most.
pub(crate) const COARSE: u32 = 16;
/// Texels along an edge of the level that they are made from, at most: texels there differ from pieces of the sphere by a percent.
pub(crate) const SOURCE: u32 = 64;
/// Where the kernel (1 − (r/reach)²)⁴ ends, as a chord for one texel an edge: 1.21 texels of 90°/edge, of which its standard deviation is 0.35.
const REACH: f64 = 1.9;
/// Turns of balancing; what is left is at most 0.8 %, at the corners of the cube.
const TURNS: usize = 32;

/// Centre of a texel on the unit sphere, and its solid angle in units of one in the middle of a face.
#[derive(Clone, Copy)]
struct Texel {
    direction: [f64; 3],
    solid_angle: f64,
}

/// The texels of six faces, face by face in rows.
fn texels(edge: u32) -> Vec<Texel> {
    let centre = |i: u32| f64::from(2 * i + 1) / f64::from(edge) - 1.0;
    let texel = |axes: &[(usize, i32); 3], s: f64, t: f64| {
        let square = 1.0 + s * s + t * t;
        let rho = square.sqrt();
        let mut direction = [0.0; 3];
        for (&(axis, sign), value) in axes.iter().zip([s, t, 1.0]) {
            direction[axis] = f64::from(sign) * value / rho;
        }
        Texel { direction, solid_angle: 1.0 / (square * rho) }
    };
    let face = |axes| (0..edge * edge).map(move |i| texel(axes, centre(i % edge), centre(i / edge)));
    FACE_AXES.iter().flat_map(face).collect()
}

/// How much of every source goes to every texel of a level: index of the source and weight, texel by texel; weights of a texel sum to 1.
type Kernel = Vec<Vec<(u32, f64)>>;

/// Kernels by the edges of their levels, kept: all of a 64-texel source take a tenth of a second and 12 MB.
static KERNELS: Mutex<BTreeMap<[u32; 2], Arc<Kernel>>> = Mutex::new(BTreeMap::new());

/// A kernel that is kept, or a new one.
fn kept_kernel(edge: u32, source_edge: u32) -> Arc<Kernel> {
    let find = || KERNELS.lock().unwrap_or_else(PoisonError::into_inner).get(&[edge, source_edge]).cloned();
    // Not made under the lock: a thread that waits for it may be one of those that make it.
    find().unwrap_or_else(|| {
        let made = Arc::new(kernel(edge, source_edge));
        KERNELS.lock().unwrap_or_else(PoisonError::into_inner).insert([edge, source_edge], Arc::clone(&made));
        made
    })
}

fn kernel(edge: u32, source_edge: u32) -> Kernel {
    let (targets, sources) = (texels(edge), texels(source_edge));
    let reach = REACH / f64::from(edge);
    let mut rows: Kernel = targets
        .par_iter()
        .map(|target| {
            let weight = |source: &Texel| {
                let [x, y, z] = [0, 1, 2].map(|i| target.direction[i] - source.direction[i]);
                1.0 - (x * x + y * y + z * z) / (reach * reach)
            };
            let inside = (0..).zip(&sources).map(|(index, source)| (index, weight(source)));
            inside.filter(|(_, w)| *w > 0.0).map(|(index, w)| (index, w * w * (w * w))).collect()
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
        for (source, w) in rows.iter_mut().flatten() {
            *w = *w * sources[*source as usize].solid_angle / columns[*source as usize];
        }
    }
    for row in &mut rows {
        let sum: f64 = row.iter().map(|(_, w)| w).sum();
        scale(row, 1.0 / sum);
    }
    rows
}

fn scale(row: &mut [(u32, f64)], factor: f64) {
    for (_, w) in row {
        *w *= factor;
    }
}

/// The texels of a level of `edge` texels a face, six faces in rows, from those of a finer one.
pub(crate) fn level(edge: u32, source_edge: u32, source: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mean = |row: &Vec<(u32, f64)>| {
        row.iter().fold([0.0; 3], |sum, &(index, w)| {
            let texel = source[index as usize];
            [0, 1, 2].map(|channel| sum[channel] + w * texel[channel])
        })
    };
    kept_kernel(edge, source_edge).par_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_source_is_as_bright_on_every_level() {
        for (edge, source_edge) in [(16, 64), (8, 64), (4, 64), (2, 64), (1, 64), (9, 37), (5, 20), (1, 3), (1, 2)] {
            let (targets, sources) = (texels(edge), texels(source_edge));
            let (given, taken): (f64, f64) = (
                sources.iter().map(|source| source.solid_angle).sum(),
                targets.iter().map(|target| target.solid_angle).sum(),
            );
            let mut columns = vec![0.0; sources.len()];
            for (row, target) in kernel(edge, source_edge).iter().zip(&targets) {
                assert!((row.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
                for &(source, w) in row {
                    columns[source as usize] += w * target.solid_angle * given / taken;
                }
            }
            for (column, source) in columns.iter().zip(&sources) {
                let ratio = column / source.solid_angle;
                assert!((ratio - 1.0).abs() < 0.01, "{edge} of {source_edge}: {ratio}");
            }
        }
    }

    #[test]
    fn the_kernel_is_round_and_of_one_width_everywhere() {
        let (edge, source_edge) = (16, 64);
        let (targets, sources) = (texels(edge), texels(source_edge));
        for (row, target) in kernel(edge, source_edge).iter().zip(&targets) {
            let square = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>();
            let variance: f64 =
                row.iter().map(|&(source, w)| w * square(target.direction, sources[source as usize].direction)).sum();
            // Two axes.
            let deviation = (0.5 * variance).sqrt() * f64::from(edge) / std::f64::consts::FRAC_PI_2;
            assert!((0.28..0.42).contains(&deviation), "{deviation}");
        }
    }
}
