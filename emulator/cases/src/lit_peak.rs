//! Lights on peaks to test with: seeded random ones, and every hard case of peaks and horizons on a surface.

use std::ops::Range;

use fixed::types::I16F16;
use glam::{DVec3, dvec3};
use roughxel_core::bundle::Bundle;
use roughxel_core::each::each;
use roughxel_core::plan::{FrameSystem, HorizonKind, PeakPlan};
use roughxel_core::ports::{BlockVector, PeakIn, PeakInput, Port, StoredHorizon, StoredPeak, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, stored_peak, stored_unit_peak};
use roughxel_shader::Batch;
use roughxel_utilities::exp2::exp2;
use roughxel_utilities::random::SplitMix64;

use super::draws::{Elements, Kind, Rows, at, direction, in_octave, octave, set, unit, unit_or};
use super::fragment::{FRAGMENT, Fragments, SURFACE, moved};
use super::highlight::eye_and_light;
use super::peak_and_horizon::{HorizonCase, PeakCase, WHOLE, horizon_hard_sets, peak_hard_sets};
use super::set::CaseSet;

/// Every effect.
pub const FULL: PeakPlan = PeakPlan { frame: FrameSystem::MainDirection, horizon: HorizonKind::Correlated };

/// Port of a peak's weight in 2^−16.
fn weight(share: u32) -> I16F16 {
    I16F16::from_bits(share.cast_signed())
}

/// Peak `index` of the random set `set`. Nine in ten are plausible: any attitude, exponents from 1 to 8192, a half vector within a few widths of the
/// peak, horizons from steps to ramps. One in ten has random bits at corner exponents. It depends on the name and the index only.
pub fn random_lit_peak(set: &str, index: u64, p: &Precision) -> PeakIn {
    PeakIn::from_wires(&Peaks::one(set, index, p))
}

/// Ports of these peaks of the random set `set`, as [`random_lit_peak`] makes them, in place of the contents of `batch`.
pub fn random_lit_peaks(set: &str, indices: Range<u64>, p: &Precision, batch: &mut Batch<PeakInput<i32>>) {
    Peaks::many(set, indices, p, batch);
}

/// One of these codes from the lower half of a word, equally many of each octave.
#[inline(always)]
fn code(word: i32, codes: Range<u32>) -> i32 {
    let span = codes.end - codes.start;
    (codes.start + (((word.cast_unsigned() & 0xffff) * span) >> 16)).cast_signed()
}

/// Word count of a light on a peak.
const PEAK: usize = <PeakInput<i32> as Bundle<i32>>::WORDS;

/// Kind of [`random_lit_peak`].
pub(super) enum Peaks {}

impl Kind<PEAK> for Peaks {
    type Ports = PeakInput<i32>;

    #[inline(always)]
    fn plausible<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; PEAK]) {
        let draws = &mut elements.draws();
        draws.skip();
        let [octaves, normal_size, eye_size, light_size] = draws.below([13; 4]);
        let reals = each!(() in [(); 8] => draws.reals());
        let [[nx, ny], [nz, tx], [ty, tz], [px, py], [pz, ax], [ay, az], [ex, ey], [ez, far]] = reals;
        let (mut normals, mut tangents, mut peaks) = ([nx, ny, nz], [tx, ty, tz], [px, py, pz]);
        let (away, mut eyes) = ([ax, ay, az], [ex, ey, ez]);
        let horizon = each!(() in [(); 4] => draws.words());
        let ([fractions, amplitudes], [weights, _]) = (draws.words(), draws.words());
        let [[normal_length, eye_length], [light_length, _]] = each!(() in [(); 2] => draws.reals());
        let mut exponents = [0; N];
        let mut lights = [[0.0; N]; 3];
        for lane in 0..N {
            let [normal, tangent] = each!(vectors in [&normals, &tangents] => unit(at(vectors, lane)));
            let e1 = unit_or(tangent.cross(normal), DVec3::ZERO);
            let e2 = normal.cross(e1);
            let peak = unit_or(at(&peaks, lane) + DVec3::Z, DVec3::Z);
            // 4096 + fraction in 2^(octave − 12), as a code has it.
            let fraction = (fractions[lane].cast_unsigned() >> 20).cast_signed();
            exponents[lane] = ((octaves[lane] + 2) << 12) + fraction;
            let exponent = f64::from(4096 + fraction) * octave(octaves[lane] - 12);
            // The half vector is a few widths √(2/n) off the peak.
            let half = peak + at(&away, lane) * (1.0 + far[lane]) * (2.0 / exponent).sqrt();
            let half = unit_or(e1 * half.x + e2 * half.y + normal * half.z, normal);
            let [eye, light] = eye_and_light(unit(at(&eyes, lane)), half);
            set(&mut normals, lane, normal * in_octave(normal_size[lane] - 6, normal_length[lane]));
            set(&mut tangents, lane, tangent);
            set(&mut eyes, lane, eye * in_octave(eye_size[lane] - 6, eye_length[lane]));
            set(&mut lights, lane, light * in_octave(light_size[lane] - 6, light_length[lane]));
            set(&mut peaks, lane, unit_or(peak / peak.abs().max_element(), DVec3::ZERO));
        }
        let mut words = Rows::new(words);
        for vectors in [normals, eyes, tangents] {
            words.put_vectors(&vectors, p);
        }
        words.put_zeros::<{ SURFACE - 12 }>();
        words.put_vectors(&lights, p);
        words.put(
            #[inline(always)]
            |lane| {
                let StoredPeak { normal, .. } = stored_unit_peak(at(&peaks, lane), 0.0, 1.0);
                let [x, y, z] = each!(n in normal => n.to_bits().into());
                // Amplitudes from 2^−10 to 2^5.
                [x, y, z, code(amplitudes[lane], 2048..61440), exponents[lane]]
            },
        );
        // Slopes from −3½ to ½. A quarter of the horizons are steps, the others ramps 2^−3 to 2^3 wide.
        for [lows, _] in &horizon {
            words.put(
                #[inline(always)]
                |lane| [(lows[lane] >> 18) - 6144],
            );
        }
        for [_, widths] in &horizon {
            words.put(
                #[inline(always)]
                |lane| {
                    let width = widths[lane];
                    [if width.cast_unsigned() >> 30 == 0 { 0 } else { code(width, 2048..24576) }]
                },
            );
        }
        // 0 and the whole weight are half as frequent as other weights.
        words.put(
            #[inline(always)]
            |lane| [(((weights[lane].cast_unsigned() >> 15) + 1) >> 1).cast_signed()],
        );
    }

    #[inline(always)]
    fn odd<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; PEAK]) {
        let draws = &mut elements.draws();
        draws.skip();
        let mut fragment = [[0; N]; FRAGMENT];
        Fragments::odd(elements, p, &mut fragment);
        let mut words = Rows::new(words);
        for row in &fragment[..16] {
            words.put_row(row);
        }
        words.put_zeros::<{ SURFACE - 16 }>();
        // Light along the first derivative of the view.
        for row in &fragment[SURFACE..][..4] {
            words.put_row(row);
        }
        let signed = |random: &mut SplitMix64| i32::from(random.next_u64() as i16);
        let unsigned = |random: &mut SplitMix64| i32::from(random.next_u64() as u16);
        let mut put = |bits: [i32; N]| words.put_row(&bits);
        (0..3).for_each(|_| put(draws.each(signed)));
        (0..2).for_each(|_| put(draws.each(unsigned)));
        (0..4).for_each(|_| put(draws.each(signed)));
        (0..4).for_each(|_| put(draws.each(unsigned)));
        put(draws.each(|random| random.next_u64() as i32));
    }
}

/// Light and eye in the upright tangent basis, E₁ = x, E₂ = y, n = z, on a peak without a horizon.
fn upright(light: BlockVector, view: BlockVector, p: &Precision) -> PeakIn {
    PeakIn {
        surface: SurfaceIn {
            normal: block_vector(DVec3::Z, p),
            view,
            frame_vectors: [block_vector(DVec3::Y, p), BlockVector::default()],
            ..SurfaceIn::default()
        },
        light,
        peak: stored_peak(dvec3(0.2, -0.1, 1.0), 0.6, 20.0),
        horizon: StoredHorizon::OPEN,
        weight: weight(WHOLE),
    }
}

/// Every hard case of a light on a peak.
pub fn lit_peak_sets(p: &Precision) -> Vec<CaseSet<PeakIn, PeakPlan>> {
    // Light and eye along the half vector give it exactly.
    let on_peaks = |case: PeakCase| {
        let half = case.half.direction;
        let mut peaks = case.peaks;
        peaks.dedup();
        peaks.into_iter().map(move |(peak, share)| PeakIn { peak, weight: weight(share), ..upright(half, half, p) })
    };
    let under_horizon = |case: HorizonCase| PeakIn { horizon: case.horizon, ..upright(case.light, case.eye, p) };
    let set = |name, description, cases| CaseSet { name, description, cases, plan: FULL };
    let mut sets = vec![set(
        "peak_light",
        "light at and around the horizon of n; n, v, l zero, tiny and huge; l = -v; h along n",
        lights(p),
    )];
    // Peak counts need sums, and `peak_light` has the zero bases.
    for of in peak_hard_sets(p).into_iter().filter(|of| !["peak_count", "local_zero"].contains(&of.name)) {
        sets.push(set(of.name, of.description, of.cases.into_iter().flat_map(on_peaks).collect()));
    }
    for of in horizon_hard_sets(p) {
        sets.push(set(of.name, of.description, of.cases.into_iter().map(under_horizon).collect()));
    }
    let ramps = horizon_hard_sets(p).into_iter().filter(|of| of.name == "horizon_at").flat_map(|of| of.cases);
    sets.push(CaseSet {
        name: "horizon_product",
        description: "slopes at and around steps and ramps, shares of light and eye multiplied (F92)",
        cases: ramps.map(under_horizon).collect(),
        plan: PeakPlan { horizon: HorizonKind::Product, ..FULL },
    });
    let natural = random_with(FrameSystem::Natural, p);
    sets.push(CaseSet {
        name: "peak_natural",
        description: "p_u, p_v of any length, skewed, equal, zero; no horizon",
        cases: natural,
        plan: PeakPlan { frame: FrameSystem::Natural, horizon: HorizonKind::None },
    });
    sets
}

/// Random peaks on p_u, p_v.
fn random_with(frame: FrameSystem, p: &Precision) -> Vec<PeakIn> {
    let name = format!("{frame:?}");
    let any = |index: u64| {
        let random = &mut SplitMix64::for_element(&name, index);
        let u = direction(random) * exp2(random.uniform(-6.0, 6.0));
        let v = match index % 8 {
            0 => u,
            1 => DVec3::ZERO,
            2 => u + direction(random) * exp2(random.uniform(-20.0, -6.0)),
            _ => direction(random) * exp2(random.uniform(-6.0, 6.0)),
        };
        PeakIn {
            surface: SurfaceIn {
                frame_vectors: [u, v].map(|tangent| block_vector(tangent, p)),
                ..random_lit_peak(&name, index, p).surface
            },
            ..random_lit_peak(&name, index, p)
        }
    };
    (0..200).map(any).collect()
}

fn lights(p: &Precision) -> Vec<PeakIn> {
    let mut peaks = Vec::new();
    let view = block_vector(dvec3(0.3, 0.2, 1.0), p);
    for run in [dvec3(1.0, 0.0, 0.0), dvec3(-0.4, 0.7, 0.0), dvec3(0.5, 0.5, 0.0)] {
        for rise in [1.0, 0.1, 0.001, 0.0, -0.001, -1.0] {
            let light = block_vector(run + DVec3::Z * rise, p);
            peaks.extend([-1, 0, 1].map(|step| upright(moved(&light, 2, step, p), view, p)));
        }
    }
    let exact = upright(block_vector(dvec3(-0.3, 0.4, 0.8), p), view, p);
    let zero = BlockVector::default();
    let opposite = BlockVector { mantissa: view.mantissa.map(|m| -m), ..view };
    peaks.extend([
        PeakIn { surface: SurfaceIn { normal: zero, ..exact.surface }, ..exact },
        PeakIn { surface: SurfaceIn { view: zero, ..exact.surface }, ..exact },
        PeakIn { light: zero, ..exact },
        PeakIn { light: opposite, ..exact },
        PeakIn { light: view, ..exact },
        PeakIn { surface: SurfaceIn { frame_vectors: [exact.surface.normal; 2], ..exact.surface }, ..exact },
        PeakIn { surface: SurfaceIn { frame_vectors: [zero; 2], ..exact.surface }, ..exact },
        PeakIn { surface: SurfaceIn { normal: zero, view: zero, ..exact.surface }, light: zero, ..exact },
    ]);
    for exponent in [i16::MIN, -900, -40, 40, 900, i16::MAX] {
        let scaled = |vector: BlockVector| BlockVector { exponent, ..vector };
        peaks.extend([
            PeakIn { surface: SurfaceIn { normal: scaled(exact.surface.normal), ..exact.surface }, ..exact },
            PeakIn { surface: SurfaceIn { view: scaled(exact.surface.view), ..exact.surface }, ..exact },
            PeakIn { light: scaled(exact.light), ..exact },
            PeakIn {
                surface: SurfaceIn { frame_vectors: exact.surface.frame_vectors.map(scaled), ..exact.surface },
                ..exact
            },
        ]);
    }
    for share in [i32::MIN, -1, 0, 1, 0xffff, 0x1_0000, 0x1_0001, i32::MAX] {
        peaks.push(PeakIn { weight: I16F16::from_bits(share), ..exact });
    }
    peaks
}
