//! Peaks and horizons to test with: seeded random ones, and every hard case as a named set.

use fixed::types::{I1F15, I4F12};
use glam::{DMat3, DVec3, dvec3};
use roughxel_core::design::LocalInput;
use roughxel_core::each::{each, places};
use roughxel_core::ports::{BlockVector, Port, StoredHorizon, StoredPeak};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, stored_horizon, stored_peak, uniform_law};
use roughxel_core::signals::TangentFrame;
use roughxel_core::stage::enter::enter;
use roughxel_utilities::exp2::exp2;
use roughxel_utilities::random::SplitMix64;

use super::draws::direction;
use super::fragment::{around, bit, moved};
use super::set::CaseSet;

/// A direction and the tangent basis of the surface in which it is expressed.
#[derive(Clone, Copy, Debug)]
pub struct LocalCase {
    /// The direction, any length.
    pub direction: BlockVector,
    /// E₁ and E₂, in the unit of the normal.
    pub tangents: [BlockVector; 2],
    /// n.
    pub normal: BlockVector,
}

impl LocalCase {
    fn new(direction: DVec3, frame: DMat3, p: &Precision) -> Self {
        let tangents = [frame.x_axis, frame.y_axis].map(|tangent| block_vector(tangent, p));
        Self { direction: block_vector(direction, p), tangents, normal: block_vector(frame.z_axis, p) }
    }

    /// Signals between stages.
    pub fn wires(&self, p: &Precision) -> LocalInput<i32> {
        let [direction, e1, e2, normal] =
            [&self.direction, &self.tangents[0], &self.tangents[1], &self.normal].map(|v| enter(&v.wires(), p));
        let [e1, e2] = [e1, e2].map(|tangent| tangent.scaled(-normal.e));
        LocalInput { direction, frame: TangentFrame { e1, e2, pole: false }, normal }
    }
}

/// A half vector and its peaks, each with its weight in 2^−16.
#[derive(Clone, Debug)]
pub struct PeakCase {
    /// The half vector.
    pub half: LocalCase,
    /// The peaks.
    pub peaks: Vec<(StoredPeak, u32)>,
}

/// Light and eye over a horizon, in the tangent basis of the surface.
#[derive(Clone, Copy, Debug)]
pub struct HorizonCase {
    /// Direction of the light, any length.
    pub light: BlockVector,
    /// Direction of the eye.
    pub eye: BlockVector,
    /// The horizon.
    pub horizon: StoredHorizon,
}

/// Weight of a whole fragment.
pub const WHOLE: u32 = 1 << 16;

fn power_of_two(random: &mut SplitMix64, low: f64, high: f64) -> f64 {
    exp2(random.uniform(low, high))
}

/// Case `index` of the random set `set`: any tangent basis of any size, up to 8 peaks with exponents from 1 to 8192 and amplitudes from 2^−10 to 32,
/// most of them near the half vector.
pub fn random_peak_case(set: &str, index: u64, p: &Precision) -> PeakCase {
    let random = &mut SplitMix64::for_element(set, index);
    let turn = DMat3::from_rotation_x(random.uniform(0.0, 7.0)) * DMat3::from_rotation_y(random.uniform(0.0, 7.0));
    let frame = turn * DMat3::from_rotation_z(random.uniform(0.0, 7.0)) * power_of_two(random, -4.0, 4.0);
    let unit = direction(random).normalize();
    let half = LocalCase::new(frame * unit * power_of_two(random, -6.0, 6.0), frame, p);
    let peaks = (0..random.below(9)).map(|_| {
        let exponent = power_of_two(random, 0.0, 13.0);
        // The peak is a few half widths √(2/n) off; one in four is anywhere.
        let near = if random.below(4) == 0 { 4.0 } else { random.uniform(0.0, 2.0) * (2.0 / exponent).sqrt() };
        let normal = unit + direction(random) * near;
        (stored_peak(normal, power_of_two(random, -10.0, 5.0), exponent), random.below(u64::from(WHOLE) + 1) as u32)
    });
    PeakCase { half, peaks: peaks.collect() }
}

/// Horizon of uniform laws, from means and standard deviations.
#[inline(always)]
pub fn uniform(mean: [f64; 4], sigma: [f64; 4]) -> StoredHorizon {
    let laws = each!(side in places::<4>() => uniform_law(mean[side], sigma[side]));
    stored_horizon(each!([low, _] in laws => low), each!([_, width] in laws => width))
}

/// Case `index` of the random set `set`: light and eye anywhere, horizons from steps to ramps of any width.
pub fn random_horizon_case(set: &str, index: u64, p: &Precision) -> HorizonCase {
    let random = &mut SplitMix64::for_element(set, index);
    let mut somewhere = || {
        let flat = direction(random) * power_of_two(random, -6.0, 6.0);
        block_vector(dvec3(flat.x, flat.y, flat.z * power_of_two(random, -5.0, 3.0)), p)
    };
    let (light, eye) = (somewhere(), somewhere());
    let mean = [(); 4].map(|()| random.uniform(-0.5, 1.0) * power_of_two(random, -3.0, 2.5));
    let sigma = [(); 4].map(|()| if random.below(4) == 0 { 0.0 } else { power_of_two(random, -8.0, 1.5) });
    HorizonCase { light, eye, horizon: uniform(mean, sigma) }
}

/// Direction in the basis of the axes.
fn upright(direction: DVec3, p: &Precision) -> LocalCase {
    LocalCase::new(direction, DMat3::IDENTITY, p)
}

/// Every hard case of the peaks.
pub fn peak_hard_sets(p: &Precision) -> Vec<CaseSet<PeakCase>> {
    let set = |name, description, cases: Vec<PeakCase>| CaseSet { name, description, cases, plan: () };
    vec![
        set("peak_count", "0, 1, 7 and 56 peaks, equal and different, weights that sum to 1", peak_count(p)),
        set("peak_on", "the half vector on a peak and one bit around it, exponents 1 to 8192", peak_on(p)),
        set(
            "peak_side",
            "half vectors at and around a right angle to a peak, opposite, below the horizon",
            peak_side(p),
        ),
        set("peak_codes", "every end of the stored numbers, sums that saturate", peak_codes(p)),
        set("local_zero", "zero, tiny and huge directions, frames and normals", local_zero(p)),
    ]
}

/// F92's silk, and a seventh peak along the normal: vectors, amplitudes, exponents.
const SEVEN: [([f64; 3], f64, f64); 7] = [
    ([0.1, 1.0, 0.0], 0.1, 32.0),
    ([0.8, 1.0, 0.0], 0.6, 32.0),
    ([0.5, 1.0, 0.0], 0.4, 32.0),
    ([0.1, 0.0, 1.0], 0.1, 20.0),
    ([0.8, 0.0, 1.0], 0.6, 100.0),
    ([0.5, -1.0, 0.0], 0.4, 1.0),
    ([0.0, 0.0, 1.0], 0.6, 8192.0),
];

fn peak_count(p: &Precision) -> Vec<PeakCase> {
    let seven = SEVEN.map(|(normal, a, n)| stored_peak(DVec3::from_array(normal), a, n));
    let halves = [dvec3(0.0, 0.0, 1.0), dvec3(0.5, 1.0, 0.3), dvec3(-0.4, 0.1, 0.8), dvec3(0.1, -0.9, 0.01)];
    let all =
        |peaks: Vec<(StoredPeak, u32)>| halves.map(|half| PeakCase { half: upright(half, p), peaks: peaks.clone() });
    [
        vec![],
        vec![(seven[6], WHOLE)],
        seven.map(|peak| (peak, WHOLE)).to_vec(),
        vec![(seven[4], WHOLE / 7); 7],
        // Eight texels, an eighth each.
        (0..56).map(|i| (seven[i % 7], WHOLE / 8)).collect(),
        vec![(seven[4], WHOLE / 56); 56],
    ]
    .into_iter()
    .flat_map(all)
    .collect()
}

fn peak_on(p: &Precision) -> Vec<PeakCase> {
    let mut cases = Vec::new();
    for normal in [DVec3::X, DVec3::Z, DVec3::NEG_Y, dvec3(0.6, 0.0, 0.8), dvec3(0.3, -0.5, 0.7), DVec3::ONE] {
        let exact = upright(normal, p);
        for exponent in [1.0, 1.5, 2.0, 20.0, 32.0, 100.0, 1000.0, 8192.0] {
            let peaks = vec![(stored_peak(normal, 0.6, exponent), WHOLE)];
            cases.extend(around(&exact.direction, p).map(|direction| {
                let half = LocalCase { direction, ..exact };
                PeakCase { half, peaks: peaks.clone() }
            }));
        }
    }
    cases
}

fn peak_side(p: &Precision) -> Vec<PeakCase> {
    let mut cases = Vec::new();
    for normal in [DVec3::Z, dvec3(0.8, 0.0, 0.6), dvec3(0.2, 0.7, -0.5), dvec3(0.0, 0.0, -1.0)] {
        let side = normal.any_orthonormal_vector();
        for exponent in [1.0, 3.0, 8192.0] {
            let peaks = vec![(stored_peak(normal, 0.5, exponent), WHOLE)];
            // Angles from a right angle to either side, and on to the opposite.
            let angles = (0..24).flat_map(|power| [1.0, -1.0].map(|sign| sign * 2.0_f64.powi(-power)));
            for sine in angles.chain([0.0]) {
                let half = normal.normalize() * sine + side * (1.0 - sine * sine).sqrt();
                cases.push(PeakCase { half: upright(half, p), peaks: peaks.clone() });
            }
            cases.push(PeakCase { half: upright(-normal, p), peaks: peaks.clone() });
        }
    }
    cases
}

fn peak_codes(p: &Precision) -> Vec<PeakCase> {
    let mut cases = Vec::new();
    let normals = [[0, 0, i16::MAX], [0; 3], [i16::MIN; 3], [i16::MAX; 3], [i16::MIN, 0, 0], [1, -1, 0]];
    for normal in normals.map(|bits| bits.map(I1F15::from_bits)) {
        for amplitude in [0, 1, 4095, 4096, 8191, u16::MAX] {
            for exponent in [0, 1, 4095, 4096, 8192, 61_440, u16::MAX] {
                for half in [DVec3::Z, dvec3(-0.5, -0.6, -0.5), dvec3(0.01, 0.02, 1.0)] {
                    for weight in [0, 1, WHOLE] {
                        let peaks = vec![(StoredPeak { normal, amplitude, exponent }, weight); 3];
                        cases.push(PeakCase { half: upright(half, p), peaks });
                    }
                }
            }
        }
    }
    cases
}

fn local_zero(p: &Precision) -> Vec<PeakCase> {
    let peaks = vec![(stored_peak(dvec3(0.6, 0.0, 0.8), 0.5, 40.0), WHOLE)];
    let exact = upright(dvec3(0.5, 0.1, 0.8), p);
    let zero = BlockVector::default();
    let mut halves = vec![
        exact,
        LocalCase { direction: zero, ..exact },
        LocalCase { normal: zero, ..exact },
        LocalCase { tangents: [zero, exact.tangents[1]], ..exact },
        LocalCase { tangents: [exact.tangents[0], zero], ..exact },
        LocalCase { direction: zero, tangents: [zero; 2], normal: zero },
    ];
    for exponent in [i16::MIN, -900, -40, 40, 900, i16::MAX] {
        let scaled = |vector: BlockVector| BlockVector { exponent, ..vector };
        halves.push(LocalCase { direction: scaled(exact.direction), ..exact });
        halves.push(LocalCase { tangents: exact.tangents.map(scaled), normal: scaled(exact.normal), ..exact });
        if exponent.unsigned_abs() < 1000 {
            halves.push(LocalCase { normal: scaled(exact.normal), ..exact });
            halves.push(LocalCase { tangents: exact.tangents.map(scaled), ..exact });
        }
    }
    halves.into_iter().map(|half| PeakCase { half, peaks: peaks.clone() }).collect()
}

/// Every hard case of the horizon.
pub fn horizon_hard_sets(p: &Precision) -> Vec<CaseSet<HorizonCase>> {
    let set = |name, description, cases: Vec<HorizonCase>| CaseSet { name, description, cases, plan: () };
    vec![
        set("horizon_at", "light on a step and on both ends of a ramp, one bit to either side", horizon_at(p)),
        set("horizon_side", "straight up, along one axis, below the surface, negative slopes", horizon_side(p)),
        set("horizon_codes", "every end of the stored numbers", horizon_codes(p)),
    ]
}

fn horizon_at(p: &Precision) -> Vec<HorizonCase> {
    let eye = block_vector(DVec3::Z, p);
    let mut cases = Vec::new();
    // Slopes that are exact in 12 bits, and the horizon at each.
    for slope in [-0.75, -0.25, 0.0, 0.25, 1.0, 1.5, 3.0] {
        // A ramp of ±¼.
        for sigma in [0.0, 0.25 / 3.0_f64.sqrt()] {
            for mean in [slope - 0.25, slope, slope + 0.25] {
                let horizon = uniform([mean; 4], [sigma; 4]);
                for run in [dvec3(1.0, 0.0, slope), dvec3(-1.0, 0.0, slope), dvec3(1.0, -1.0, slope)] {
                    let lights = [-1, 0, 1].map(|step| moved(&block_vector(run, p), 2, step, p));
                    cases.extend(lights.map(|light| HorizonCase { light, eye, horizon }));
                }
            }
        }
    }
    cases
}

fn horizon_side(p: &Precision) -> Vec<HorizonCase> {
    let mut cases = Vec::new();
    let last = f64::from(bit(p)) / 2.0_f64.powi(30);
    let runs = [0.0, last, -last, 0.3, -0.3, 1.0];
    let rises = [0.0, last, -last, 0.6, -0.6, 1.0, -1.0];
    let horizons = [
        stored_horizon([0.3, 0.5, 0.0, 1.0], [0.0; 4]),
        uniform([0.3, 0.5, -0.2, 1.0], [0.1, 0.4, 0.2, 1e-3]),
        StoredHorizon::OPEN,
    ];
    for (x, y) in runs.into_iter().flat_map(|x| runs.map(|y| (x, y))) {
        for z in rises {
            for horizon in horizons {
                let light = block_vector(dvec3(x, y, z), p);
                cases.push(HorizonCase { light, eye: block_vector(dvec3(y, -x, 0.8), p), horizon });
            }
        }
    }
    cases
}

fn horizon_codes(p: &Precision) -> Vec<HorizonCase> {
    let mut cases = Vec::new();
    for low in [I4F12::MIN, I4F12::MAX, I4F12::ZERO, I4F12::DELTA] {
        for code in [0, 1, 4095, 4096, 30_000, u16::MAX] {
            let horizon = StoredHorizon { low: [low; 4], inverse_width: [code; 4] };
            for slope in [-100.0, -8.0, -7.99, -0.001, 0.0, 0.001, 0.5, 7.99, 8.0, 100.0] {
                for run in [dvec3(1.0, 0.001, slope), dvec3(-1.0, 1.0, slope), dvec3(0.0, -1.0, slope)] {
                    let light = block_vector(run, p);
                    cases.push(HorizonCase { light, eye: block_vector(dvec3(1.0, -2.0, 3.0), p), horizon });
                }
            }
        }
    }
    cases
}
