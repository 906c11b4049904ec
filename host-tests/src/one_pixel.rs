//! One-pixel highlight: how well a few numbers about many facets replace the facets.
//!
//! 64×64 offsets (b₁, b₂), facet normal (b₁, b₂, 1)/|…|, one exponent; half vectors (t, s, 1)/|…|, t, s = −1…1 in 41 steps, t² + s² ≤ 1.2. The
//! truth is the mean over all facets of max(0, n·h)^m; PSNR is relative to its peak.

use std::f64::consts::TAU;

use crate::reference::highlight::blinn_phong;
use crate::reference::linear::{Vector2, Vector3, add_scaled, dot, norm, scaled};
use crate::reference::random::SplitMix64;
use crate::reference::roughness::{Covariance, covariance};

/// Exponent m of every facet in most tests.
pub const EXPONENT: u32 = 64;

/// Offsets along an edge of the pixel.
const EDGE: usize = 64;

/// A pixel and its highlight.
#[derive(Clone, Debug)]
pub struct OnePixel {
    /// Short name.
    pub name: &'static str,
    /// Offsets (b₁, b₂) of the facets.
    pub facets: Vec<Vector2>,
    /// Mean of the facets.
    pub mean: Vector2,
    /// Covariance of the facets.
    pub covariance: Covariance,
    /// Exponent m of every facet.
    exponent: u32,
    /// Unit half vectors with their true values.
    truth: Vec<(Vector3, f64)>,
}

impl OnePixel {
    fn new(name: &'static str, exponent: u32, facet: impl Fn(usize, usize) -> Vector2) -> Self {
        let facets: Vec<_> = (0..EDGE * EDGE).map(|i| facet(i % EDGE, i / EDGE)).collect();
        let normals: Vec<_> = facets.iter().map(|&[x, y]| unit([x, y, 1.0])).collect();
        let halves = (0..41 * 41).map(|i| [i % 41, i / 41].map(|k| f64::from(k) / 20.0 - 1.0));
        let truth = halves.filter(|h| dot(h, h) <= 1.2).map(|[t, s]| {
            let half = unit([t, s, 1.0]);
            let sum: f64 = normals.iter().map(|n| dot(n, &half).max(0.0).powi(exponent as i32)).sum();
            (half, sum / normals.len() as f64)
        });
        let (mean, covariance) = covariance(&facets);
        Self { name, exponent, truth: truth.collect(), mean, covariance, facets }
    }

    /// Isotropic noise: white heights, filtered by a Gaussian with its cut-off at 0.15 of the sampling rate; slopes with a standard deviation of
    /// 0.25.
    pub fn noise(exponent: u32) -> Self {
        let mut random = SplitMix64::new(64);
        let white: Vec<f64> = (0..EDGE * EDGE).map(|_| random.normal()).collect();
        // A Gaussian of σ = 0.15 over frequencies is one of 1/(2π·0.15) = 1.06 samples; 5 σ on either side, periodic.
        let weight = |distance: isize| (-0.5 * (distance as f64 * TAU * 0.15).powi(2)).exp();
        let filtered = |heights: &[f64], step: usize, other: usize| -> Vec<f64> {
            let at =
                |line: usize, place: isize| heights[line * other + place.rem_euclid(EDGE as isize) as usize * step];
            let mean = |line: usize, place: usize| -> f64 {
                (-6..=6).map(|d: isize| weight(d) * at(line, place as isize + d)).sum()
            };
            let mut result = vec![0.0; EDGE * EDGE];
            for line in 0..EDGE {
                for place in 0..EDGE {
                    result[line * other + place * step] = mean(line, place);
                }
            }
            result
        };
        let heights = filtered(&filtered(&white, 1, EDGE), EDGE, 1);
        let at = |x: usize, y: usize| heights[x % EDGE + EDGE * (y % EDGE)];
        let slope = |x: usize, y: usize| [at(x + 1, y) - at(x + EDGE - 1, y), at(x, y + 1) - at(x, y + EDGE - 1)];
        let places = (0..EDGE * EDGE).map(|i| slope(i % EDGE, i / EDGE));
        let variance = places.map(|s| 0.5 * dot(&s, &s)).sum::<f64>() / (EDGE * EDGE) as f64;
        Self::new("noise", exponent, |x, y| scaled(0.25 / variance.sqrt(), slope(x, y)))
    }

    /// Corrugated iron: 0.45·cos(2π·4·(0.8x + 0.6y)) along (0.8, 0.6).
    pub fn corrugated(exponent: u32) -> Self {
        Self::new("corrugated", exponent, |x, y| {
            let [x, y] = places(x, y);
            let slope = 0.45 * (TAU * 4.0 * (0.8 * x + 0.6 * y)).cos();
            [0.8 * slope, 0.6 * slope]
        })
    }

    /// V-grooves: ±0.5 along x, four periods.
    pub fn v_groove(exponent: u32) -> Self {
        Self::new("V-groove", exponent, |x, y| [if (4.0 * places(x, y)[0]).fract() < 0.5 { 0.5 } else { -0.5 }, 0.0])
    }

    /// 4×4 spherical caps, r² < 0.9, flat between.
    pub fn hemispheres(exponent: u32) -> Self {
        Self::new("hemispheres", exponent, |x, y| {
            let cap = places(x, y).map(|x| 2.0 * (4.0 * x).fract() - 1.0);
            let square = dot(&cap, &cap);
            if square < 0.9 { scaled(1.0 / (1.0 - square).sqrt(), cap) } else { [0.0; 2] }
        })
    }

    /// All four pixels, with facets of `exponent`.
    pub fn all(exponent: u32) -> [Self; 4] {
        [Self::noise, Self::corrugated, Self::v_groove, Self::hemispheres].map(|pixel| pixel(exponent))
    }

    /// PSNR in dB of a method that returns the highlight for a unit half vector, z along the surface's normal.
    pub fn psnr(&self, method: impl Fn(Vector3) -> f64) -> f64 {
        let (mut peak, mut squares) = (0.0_f64, 0.0);
        for &(half, truth) in &self.truth {
            let error = method(half) - truth;
            peak = peak.max(truth);
            squares += error * error;
        }
        -10.0 * (squares / self.truth.len() as f64 / (peak * peak)).log10()
    }

    /// PSNR in dB of averaged bumps: the highlight of the mean facet.
    pub fn averaged(&self) -> f64 {
        let normal = [self.mean[0], self.mean[1], 1.0];
        self.psnr(|half| blinn_phong(normal, half, self.exponent.into()))
    }

    /// The offset of a half vector from the mean facet, in slopes.
    pub fn offset(&self, [x, y, z]: Vector3) -> Vector2 {
        add_scaled([x / z, y / z], -1.0, self.mean)
    }
}

fn unit(a: Vector3) -> Vector3 {
    scaled(1.0 / norm(&a), a)
}

/// Centre of an offset in a pixel of edge 1.
fn places(x: usize, y: usize) -> Vector2 {
    [x, y].map(|k| (k as f64 + 0.5) / EDGE as f64)
}
