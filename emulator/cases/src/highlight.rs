//! Lights on surfaces to test with: seeded random ones, and every hard case of a highlight as a named set.

use std::ops::Range;

use glam::{DVec3, dvec3};
use roughxel_core::bundle::Bundle;
use roughxel_core::each::each;
use roughxel_core::plan::{FrameSystem, SurfacePlan};
use roughxel_core::ports::{BlockVector, HighlightIn, HighlightInput, Port, ReflectionIn, Shininess, SurfaceIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::setup::{block_vector, offset, shininess};

use super::draws::{Draws, Elements, Kind, Rows, at, in_octave, octave, set, unit, unit_or};
use super::fragment::{Fragments, SURFACE, moved};
use super::set::CaseSet;
use roughxel_shader::Batch;

/// Every stage of a surface.
pub const FULL: SurfacePlan =
    SurfacePlan { bump: true, frame: FrameSystem::MainDirection, roughness: RoughnessKind::Anisotropic, local: false };

/// A light on the surface of a fragment.
pub fn lit(fragment: &ReflectionIn, light: BlockVector, shininess: Shininess) -> HighlightIn {
    HighlightIn { surface: fragment.surface, light, shininess }
}

/// One light in real numbers, as the generators use it.
#[derive(Clone, Copy, Debug)]
struct RealLight {
    normal: DVec3,
    view: DVec3,
    tangent: DVec3,
    offset: [f64; 2],
    roughness: [f64; 3],
    light: DVec3,
    exponent: f64,
}

impl RealLight {
    /// A light above the floor, seen by mirror reflection.
    const PLAIN: Self = Self {
        normal: DVec3::Y,
        view: dvec3(0.0, 1.0, 1.0),
        tangent: DVec3::NEG_Z,
        offset: [0.0; 2],
        roughness: [0.0; 3],
        light: dvec3(0.0, 1.0, -1.0),
        exponent: 64.0,
    };

    fn quantised(&self, p: &Precision) -> HighlightIn {
        HighlightIn {
            surface: SurfaceIn {
                normal: block_vector(self.normal, p),
                view: block_vector(self.view, p),
                frame_vectors: [block_vector(self.tangent, p), BlockVector::default()],
                offset: self.offset.map(|b| offset(b, p)),
                roughness: self.roughness.map(|d| offset(d, p)),
            },
            light: block_vector(self.light, p),
            shininess: shininess(self.exponent),
        }
    }
}

/// Light `index` of the random set `set`. Nine in ten are plausible: any attitude, exponents from 1 to 8192, a half vector within four deviations of
/// n_mod. One in ten has random bits at corner exponents. It depends on the name and the index only.
pub fn random_light(set: &str, index: u64, p: &Precision) -> HighlightIn {
    HighlightIn::from_wires(&Lights::one(set, index, p))
}

/// Ports of these lights of the random set `set`, as [`random_light`] makes them, in place of the contents of `batch`.
pub fn random_lights(set: &str, indices: Range<u64>, p: &Precision, batch: &mut Batch<HighlightInput<i32>>) {
    Lights::many(set, indices, p, batch);
}

/// Word count of a light on a surface.
const LIGHT: usize = <HighlightInput<i32> as Bundle<i32>>::WORDS;

/// Kind of [`random_light`].
pub(super) enum Lights {}

impl Kind<LIGHT> for Lights {
    type Ports = HighlightInput<i32>;

    #[inline(always)]
    fn are_odd<const N: usize>(elements: Elements<N>) -> [bool; N] {
        // The second decision: odd lights may fall on plausible surfaces.
        elements.draws().tenths()[1]
    }

    #[inline(always)]
    fn plausible<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; LIGHT]) {
        let draws = &mut elements.draws();
        draws.skip();
        let exponents = exponents_of(draws);
        let [normal_size, eye_size, light_size, rough] = draws.below([13, 13, 13, 8]);
        let reals = each!(() in [(); 8] => draws.reals());
        let [[nx, ny], [nz, tx], [ty, tz], [ex, ey], [ez, t1], b, [d1, d2], [d3, t2]] = reals;
        let [[normal_length, eye_length], [light_length, _]] = each!(() in [(); 2] => draws.reals());
        let (mut normals, mut tangents, mut eyes) = ([nx, ny, nz], [tx, ty, tz], [ex, ey, ez]);
        let (mut b, mut roughness) = (b, [d1, d2, d3]);
        for lane in 0..N {
            let most = octave(rough[lane] - 6);
            let [d1, d2, d3] = each!(d in [d1[lane].abs(), d2[lane], d3[lane].abs()] => d * most);
            [roughness[0][lane], roughness[1][lane], roughness[2][lane]] = [d1, d2, d3];
            [b[0][lane], b[1][lane]] = [0.6 * b[0][lane], 0.6 * b[1][lane]];
        }
        let mut lights = [[0.0; N]; 3];
        for lane in 0..N {
            let [normal, tangent] = each!(vectors in [&normals, &tangents] => unit(at(vectors, lane)));
            let e1 = unit_or(tangent.cross(normal), DVec3::ZERO);
            let e2 = normal.cross(e1);
            let deviation = 4.0 / exponents[lane].sqrt();
            let [d1, d2, d3] = each!(d in [roughness[0][lane], roughness[1][lane], roughness[2][lane]] => 2.0 * d);
            let half =
                [b[0][lane] + t1[lane] * (deviation + d1) + t2[lane] * d2, b[1][lane] + t2[lane] * (deviation + d3)];
            let half = unit(normal + half[0] * e1 + half[1] * e2);
            let [eye, light] = eye_and_light(unit(at(&eyes, lane)), half);
            set(&mut normals, lane, normal * in_octave(normal_size[lane] - 6, normal_length[lane]));
            set(&mut tangents, lane, tangent);
            set(&mut eyes, lane, eye * in_octave(eye_size[lane] - 6, eye_length[lane]));
            set(&mut lights, lane, light * in_octave(light_size[lane] - 6, light_length[lane]));
        }
        let mut words = Rows::new(words);
        for vectors in [normals, eyes, tangents] {
            words.put_vectors(&vectors, p);
        }
        words.put_zeros::<4>();
        for numbers in b.iter().chain(&roughness) {
            words.put_offsets(numbers, p);
        }
        words.put_vectors(&lights, p);
        put_shininess(&mut words, &exponents);
    }

    #[inline(always)]
    fn odd<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; LIGHT]) {
        let draws = &mut elements.draws();
        draws.skip();
        let exponents = exponents_of(draws);
        let are_opposite = draws.each(|random| random.below(4) == 0);
        let fragment = Fragments::any(elements, p);
        let mut words = Rows::new(words);
        for row in &fragment[..SURFACE] {
            words.put_row(row);
        }
        // Light from the eye, or along the first derivative of the view.
        for (view, dview) in fragment[4..8].iter().zip(&fragment[SURFACE..]) {
            words.put(
                #[inline(always)]
                |lane| [if are_opposite[lane] { view[lane] } else { dview[lane] }],
            );
        }
        put_shininess(&mut words, &exponents);
    }
}

/// An eye at an offset from the half vector, and the light opposite.
#[inline(always)]
pub(super) fn eye_and_light(eye: DVec3, half: DVec3) -> [DVec3; 2] {
    let eye = if eye.dot(half) < 0.0 { -eye } else { eye };
    [eye, 2.0 * eye.dot(half) * half - eye]
}

/// Exponents from 1 to below 8192, equally many in each octave.
#[inline(always)]
fn exponents_of<const N: usize>(draws: &mut Draws<N>) -> [f64; N] {
    let ([octaves, ..], [mut exponents, _]) = (draws.below([13, 1, 1, 1]), draws.reals());
    for (exponent, octave) in exponents.iter_mut().zip(octaves) {
        *exponent = in_octave(octave, *exponent);
    }
    exponents
}

#[inline(always)]
fn put_shininess<const N: usize>(words: &mut Rows<'_, N>, exponents: &[f64; N]) {
    words.put(
        #[inline(always)]
        |lane| {
            let Shininess { exponent, root } = shininess(exponents[lane]);
            [exponent.to_bits(), root.to_bits()]
        },
    );
}

/// Every hard case of a highlight.
pub fn highlight_sets(p: &Precision) -> Vec<CaseSet<HighlightIn, SurfacePlan>> {
    let set = |name, description, cases| CaseSet { name, description, cases, plan: FULL };
    vec![
        set("highlight_peak", "h approaches n_mod to the last bit and lies on it, D = 0 and not", peak(p)),
        set("highlight_opposite", "l approaches -v to the last bit and lies on it; n, v, l zero", opposite(p)),
        set("highlight_rank", "K of rank one in every direction, c = 0, one bit, d2 < 0, saturated", rank(p)),
        set("highlight_horizon", "light on the horizon, one bit to either side, below; eye below", horizon(p)),
        set("highlight_exponent", "exponent 1, the largest, between, and beyond both ends", exponents(p)),
        CaseSet {
            name: "highlight_isotropic",
            description: "isotropic roughness from one bit to the end of its range",
            cases: isotropic(p),
            plan: SurfacePlan { roughness: RoughnessKind::Isotropic, ..FULL },
        },
    ]
}

fn peak(p: &Precision) -> Vec<HighlightIn> {
    let mut fragments = Vec::new();
    for normal in [DVec3::Y, dvec3(0.2, 0.9, -0.3), dvec3(0.5, 0.5, 0.5)] {
        let side = normal.any_orthonormal_vector() * normal.length();
        for exponent in [1.0, 64.0, 8192.0] {
            for roughness in [[0.0; 3], [0.3, 0.1, 0.2], [0.0, 0.2, 0.1]] {
                let at = RealLight { normal, view: normal, light: normal, roughness, exponent, ..RealLight::PLAIN };
                let exact = at.quantised(p);
                fragments.push(exact);
                fragments.extend((0..3).map(|i| HighlightIn { light: moved(&exact.light, i, -1, p), ..exact }));
                for power in 2..p.fraction_bits {
                    let angle = 0.5_f64.powi(power as i32);
                    let light = normal * libm::cos(angle) + side * libm::sin(angle);
                    fragments.push(RealLight { light, view: light, ..at }.quantised(p));
                }
            }
        }
    }
    fragments
}

fn opposite(p: &Precision) -> Vec<HighlightIn> {
    let mut fragments = Vec::new();
    for roughness in [[0.0; 3], [0.3, 0.1, 0.2]] {
        let plain = RealLight { roughness, exponent: 16.0, ..RealLight::PLAIN };
        for power in 0..p.fraction_bits + 2 {
            // Eye and light close above the floor, on either side of the half vector.
            let angle = 0.5_f64.powi(power as i32);
            let [view, light] = [1.0, -1.0].map(|side| dvec3(side * libm::cos(angle), libm::sin(angle), 0.1 * angle));
            fragments.push(RealLight { view, light, ..plain }.quantised(p));
        }
        for view in [DVec3::Y, dvec3(0.3, 0.5, -0.8), DVec3::X] {
            let exact = RealLight { view, light: -view, ..plain }.quantised(p);
            fragments.push(exact);
            fragments.extend(
                (0..3)
                    .flat_map(|i| [-1, 1].map(|step| HighlightIn { light: moved(&exact.light, i, step, p), ..exact })),
            );
        }
        let zero = BlockVector::default();
        let exact = plain.quantised(p);
        fragments.extend([
            HighlightIn { surface: SurfaceIn { normal: zero, ..exact.surface }, ..exact },
            HighlightIn { surface: SurfaceIn { view: zero, ..exact.surface }, ..exact },
            HighlightIn { light: zero, ..exact },
            HighlightIn { surface: SurfaceIn { frame_vectors: [zero; 2], ..exact.surface }, ..exact },
            HighlightIn { surface: SurfaceIn { normal: zero, view: zero, ..exact.surface }, light: zero, ..exact },
        ]);
    }
    fragments
}

fn rank(p: &Precision) -> Vec<HighlightIn> {
    let last = 0.5_f64.powi(p.offset_bits() as i32);
    let mut fragments = Vec::new();
    for turn in 0..16 {
        let (sin, cos) = libm::sincos(f64::from(turn) * std::f64::consts::PI / 16.0);
        for size in [last, 0.01, 0.3, 4.0] {
            // K = size²·(cos, sin)(cos, sin)ᵀ: d₁ = 0 unless sin = 0.
            let roughness = if turn == 0 { [size, 0.0, 0.0] } else { [0.0, size * cos, size * sin] };
            for slope in [[0.1, 0.0], [cos, sin], [-sin * 0.2, cos * 0.2]] {
                let light = dvec3(slope[0], 1.0, slope[1]);
                let plain = RealLight { roughness, ..RealLight::PLAIN };
                fragments.push(RealLight { view: light, light, ..plain }.quantised(p));
            }
        }
    }
    for roughness in [[0.0, 0.0, last], [last; 3], [8.0; 3], [8.0, -8.0, 8.0], [0.2, -0.1, 0.0], [0.2, -0.3, last]] {
        for offset in [[0.0; 2], [7.9, -7.9], [0.3, -0.2]] {
            fragments.push(RealLight { roughness, offset, ..RealLight::PLAIN }.quantised(p));
        }
    }
    fragments
}

fn horizon(p: &Precision) -> Vec<HighlightIn> {
    let mut fragments = Vec::new();
    let plain = RealLight { roughness: [0.4, 0.1, 0.3], exponent: 4.0, ..RealLight::PLAIN };
    for (normal, side) in [(DVec3::Y, DVec3::X), (dvec3(0.5, 0.5, 0.0), dvec3(0.5, -0.5, 0.25))] {
        for view in [normal, dvec3(0.0, 1.0, 1.0), normal - 0.5 * side, -normal] {
            for offset in [[0.0; 2], [0.7, 0.4]] {
                let exact = RealLight { normal, view, offset, light: side, ..plain }.quantised(p);
                fragments.push(exact);
                fragments.extend([-1, 1].map(|step| HighlightIn { light: moved(&exact.light, 1, step, p), ..exact }));
                for height in [-0.2, 0.01, 0.2] {
                    let light = side + height * normal;
                    fragments.push(RealLight { normal, view, offset, light, ..plain }.quantised(p));
                }
            }
        }
    }
    fragments
}

fn exponents(p: &Precision) -> Vec<HighlightIn> {
    let mut fragments = Vec::new();
    for power in 0..=13 {
        for roughness in [[0.0; 3], [0.05, 0.02, 0.1]] {
            let exponent = f64::from(1 << power);
            let light = dvec3(0.0, 1.0, -1.0) + dvec3(0.7, 0.1, 0.3) / exponent.sqrt();
            fragments.push(RealLight { light, roughness, exponent, ..RealLight::PLAIN }.quantised(p));
        }
    }
    // Values that no host makes: the ends of the words.
    let plain = RealLight { roughness: [0.1, 0.0, 0.1], ..RealLight::PLAIN }.quantised(p);
    for exponent in [i32::MIN, -1, 0, 1, i32::MAX] {
        for root in [i32::MIN, 0, i32::MAX] {
            let shininess = Shininess {
                exponent: fixed::types::I16F16::from_bits(exponent),
                root: fixed::types::I8F24::from_bits(root),
            };
            fragments.push(HighlightIn { shininess, ..plain });
        }
    }
    fragments
}

fn isotropic(p: &Precision) -> Vec<HighlightIn> {
    let plain = RealLight { light: dvec3(0.1, 1.0, -0.8), ..RealLight::PLAIN };
    let with = |i1: f64| RealLight { roughness: [i1, 0.0, 0.0], ..plain }.quantised(p);
    (0..p.offset_bits() + 3).map(|power| with(8.0 * 0.5_f64.powi(power as i32))).chain([with(0.0)]).collect()
}
