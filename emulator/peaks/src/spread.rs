//! Spreading: the density of normals N(θ, φ) = Σ w cosⁿα on a grid over the hemisphere (F92 §2.2–2.3).
//!
//! The grid has 18 rings of 72 samples, every 5° in θ and φ. One sample at the pole covers all θ below 5/12°: half the area
//! of the sectors next to it. Each sample stands for the solid angle of its sector. A facet of exponent 128 falls off by 1/e
//! within 7.2°, the narrowest that the grid resolves (less than 1 % lies beyond its band limit). Facets are spread with
//! [`spread_exponent`]; fitted peaks are sharpened by the difference in variance ([`sharpened`]).

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::LazyLock;

use fearless_simd::prelude::*;
use fearless_simd::{dispatch, f64x8};
use glam::DVec3;
use rayon::prelude::*;

use super::blocks::{Block, Directions, LANES, LEVEL, NEGLIGIBLE, cosines, powers};

/// Rings of samples from the pole to the horizon.
const RINGS: usize = 18;
/// Samples in a ring.
const SECTORS: usize = 72;
/// Samples of the hemisphere; number 0 is the pole, the others are 1 + ring · 72 + sector.
pub(super) const SAMPLES: usize = 1 + RINGS * SECTORS;
/// Edge of the polar sample, radians.
const POLAR_ANGLE: f64 = 5.0 / 12.0 / 360.0 * TAU;
/// Largest exponent that the grid resolves.
const LARGEST_SPREAD: f64 = 128.0;
/// Blocks of samples; only the first lane of the last block is a sample.
pub(super) const BLOCKS: usize = SAMPLES.div_ceil(LANES);

/// Directions of a density's samples.
pub(super) struct Hemisphere {
    /// Unit vectors, z ≥ 0.
    pub(super) directions: Vec<DVec3>,
    /// Solid angles of the sectors, in steradians; their sum is 2π.
    pub(super) solid_angles: Vec<f64>,
    /// Blocks of the directions, and of the roots of the solid angles, which weight a residual. The padding is zero: no peak has a
    /// cosine above 0 there.
    pub(super) blocks: Vec<(Directions, Block)>,
}

/// The grid, made once.
pub(super) static HEMISPHERE: LazyLock<Hemisphere> = LazyLock::new(|| {
    let ring_step = FRAC_PI_2 / RINGS as f64;
    let mut directions = vec![DVec3::Z];
    let mut solid_angles = vec![TAU * (1.0 - libm::cos(POLAR_ANGLE))];
    for ring in 0..RINGS {
        let inner = if ring == 0 { POLAR_ANGLE } else { ring as f64 * ring_step };
        let outer = (ring + 1) as f64 * ring_step;
        let (sin, cos) = libm::sincos((ring as f64 + 0.5) * ring_step);
        for sector in 0..SECTORS {
            let (y, x) = libm::sincos(sector as f64 / SECTORS as f64 * TAU);
            directions.push(DVec3::new(sin * x, sin * y, cos));
            solid_angles.push(TAU / SECTORS as f64 * (libm::cos(inner) - libm::cos(outer)));
        }
    }
    let weights = solid_angles.iter().map(|angle: &f64| angle.sqrt());
    let along = |axis: usize| Block::list(directions.iter().map(|direction| direction[axis]));
    let axes = along(0).into_iter().zip(along(1)).zip(along(2)).map(|((x, y), z)| [x, y, z]);
    let blocks = axes.zip(Block::list(weights)).collect();
    Hemisphere { directions, solid_angles, blocks }
});

impl Hemisphere {
    /// ∫ f dω over the hemisphere.
    pub(super) fn integral(&self, values: impl IntoIterator<Item = f64>) -> f64 {
        self.solid_angles.iter().zip(values).map(|(solid_angle, value)| solid_angle * value).sum()
    }
}

/// Samples next to a sample: all of the first ring for the pole, else four, three at the horizon.
pub(super) fn neighbours(sample: usize) -> Vec<usize> {
    let at = |ring: usize, sector: usize| 1 + ring * SECTORS + sector % SECTORS;
    let Some(index) = sample.checked_sub(1) else { return (1..=SECTORS).collect() };
    let (ring, sector) = (index / SECTORS, index % SECTORS);
    let mut found = vec![at(ring, sector + 1), at(ring, sector + SECTORS - 1)];
    found.push(if ring == 0 { 0 } else { at(ring - 1, sector) });
    if ring + 1 < RINGS {
        found.push(at(ring + 1, sector));
    }
    found
}

/// Texels of level 0 that share a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Facet {
    /// Unit vector.
    pub(super) normal: DVec3,
    /// Amplitude of cosⁿα: that of its texels times the area of each as a share of the covering texel.
    pub(super) amplitude: f64,
    /// Number of texels; they are adjacent in the list from which facets are made.
    pub(super) texels: usize,
}

/// Σ a cosⁿα of facets at every sample. Each sample is summed by one thread in the order of the facets.
pub(super) fn density(facets: &[Facet], exponent: f64) -> Vec<f64> {
    let block = |(directions, _): &(Directions, Block)| dispatch!(*LEVEL, simd => density_of_block(simd, directions, facets, exponent));
    // A few facets are summed faster than a thread starts.
    let least = BLOCKS.min(1 + 4096 / facets.len().max(1));
    let blocks: Vec<Block> = HEMISPHERE.blocks.par_iter().with_min_len(least).map(block).collect();
    let mut density: Vec<f64> = blocks.into_iter().flat_map(|Block(lanes)| lanes).collect();
    density.truncate(SAMPLES);
    density
}

#[inline(always)]
fn density_of_block<S: Simd>(simd: S, directions: &Directions, facets: &[Facet], exponent: f64) -> Block {
    // A facet of a different width keeps its energy 2π/(n + 1).
    let spread = spread_exponent(exponent);
    let gain = (spread + 1.0) / (exponent + 1.0);
    let spread = f64x8::splat(simd, spread);
    let mut sum = f64x8::splat(simd, 0.0);
    for facet in facets {
        if let Some(power) = powers(cosines(simd, facet.normal, directions), spread) {
            sum += power * gain * facet.amplitude;
        }
    }
    Block::store(sum)
}

/// ln cosⁿα if cosⁿα is not negligible.
pub(super) fn log_power(cos: f64, exponent: f64) -> Option<f64> {
    // ln x ≤ x − 1 settles most samples without a logarithm.
    if cos <= 0.0 || exponent * (cos - 1.0) < NEGLIGIBLE {
        return None;
    }
    Some(exponent * libm::log(cos)).filter(|log| *log > NEGLIGIBLE)
}

/// cosⁿα, 0 if it is negligible.
pub(super) fn power(cos: f64, exponent: f64) -> f64 {
    log_power(cos, exponent).map_or(0.0, libm::exp)
}

/// Exponent for spreading facets.
pub(super) fn spread_exponent(exponent: f64) -> f64 {
    exponent.min(LARGEST_SPREAD)
}

/// The exponent of a peak fitted to facets spread with [`spread_exponent`], corrected to facets of their own exponent.
///
/// A peak has the variance 1/n along each axis (cosⁿα ≈ exp(−n α²/2)); its excess over the variance of a facet is the
/// surface's.
pub(super) fn sharpened(fitted: f64, exponent: f64) -> f64 {
    if exponent <= LARGEST_SPREAD {
        return fitted;
    }
    1.0 / ((1.0 / fitted - 1.0 / LARGEST_SPREAD).max(0.0) + 1.0 / exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_samples_stand_for_the_whole_hemisphere() {
        let hemisphere = &*HEMISPHERE;
        assert_eq!(hemisphere.directions.len(), SAMPLES);
        // Bound of the sums and the cosines of 1297 sectors.
        assert!((hemisphere.integral([1.0; SAMPLES]) - TAU).abs() < 1e-12);
        // F92: about half the area of the adjacent sectors.
        assert!((hemisphere.solid_angles[0] / hemisphere.solid_angles[1] - 0.5).abs() < 0.01);
        assert!(hemisphere.directions.iter().all(|direction| direction.is_normalized() && direction.z > 0.0));
    }

    #[test]
    fn a_facet_on_the_grid_keeps_its_energy_at_every_exponent() {
        for exponent in [1.0, 7.0, 64.0, 128.0, 1000.0, 8192.0] {
            let facet = Facet { normal: DVec3::Z, amplitude: 0.5, texels: 1 };
            let energy = HEMISPHERE.integral(density(&[facet], exponent));
            // The midpoint rule of step h is worst around the pole, n h²/24 too much (Euler–Maclaurin): 4 % for n = 128.
            // The next term is a tenth of that.
            let excess = spread_exponent(exponent) * (5.0 / 360.0 * TAU).powi(2) / 24.0;
            let error = energy / (0.5 * TAU / (exponent + 1.0)) - 1.0;
            assert!((error - excess).abs() < 0.005, "{exponent}: {error} {excess}");
        }
    }

    #[test]
    fn neighbours_are_mutual() {
        for sample in 0..SAMPLES {
            for neighbour in neighbours(sample) {
                assert!(neighbours(neighbour).contains(&sample), "{sample} {neighbour}");
            }
        }
    }

    #[test]
    fn sharpening_undoes_the_wider_spread() {
        assert_eq!(sharpened(40.0, 100.0), 40.0);
        assert!((sharpened(128.0, 1000.0) - 1000.0).abs() < 1e-9);
        // A surface of variance 1/50 seen through facets of variance 1/1000.
        let fitted = 1.0 / (1.0 / 50.0 + 1.0 / 128.0);
        assert!((1.0 / sharpened(fitted, 1000.0) - (1.0 / 50.0 + 1.0 / 1000.0)).abs() < 1e-12);
    }
}
