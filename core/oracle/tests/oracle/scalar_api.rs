//! The datapaths from ports to ports under every plan, and constants of maps.

use std::collections::BTreeSet;

use fixed::types::{I4F28, I8F24, I16F16};
use glam::DVec3;
use roughxel_core::firmware::{Accuracy, Firmware, Narrow, Standard};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::ports::{HighlightIn, PeakIn, Port, ReflectionIn};
use roughxel_core::precision::{Precision, Profile, RoughnessKind};
use roughxel_core::probe_list::{environment_probes, sphere_probes, texture_probes};
use roughxel_core::sampler::{self, Cube};
use roughxel_core::scalar_api::{self, environment_scale, texture_scale};
use roughxel_core::setup::{shininess, stored_horizon, stored_peak};
use roughxel_core::signals::TexturePosition;
use roughxel_core::small::Full;
use roughxel_core::stage::{probes, sweep};
use roughxel_core::width::{of_ports, on_words, to_ports};

use roughxel_oracle::walk::{Number, numbers};

use crate::maps::{Hash, Noise, fragments};

pub(crate) const FRAMES: [FrameSystem; 3] =
    [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];
pub(crate) const ROUGHNESS: [RoughnessKind; 3] =
    [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic];
pub(crate) const FOOTPRINTS: [FootprintKind; 3] = [FootprintKind::None, FootprintKind::Face, FootprintKind::Sphere];
pub(crate) const HORIZONS: [HorizonKind; 3] = [HorizonKind::None, HorizonKind::Correlated, HorizonKind::Product];

/// Some fragments, including ones whose frame vectors are tangents.
fn some(count: usize) -> Vec<ReflectionIn> {
    let all = fragments();
    let mut some: Vec<ReflectionIn> = all.iter().step_by(all.len() / count).map(|(fragment, _)| *fragment).collect();
    for fragment in &mut some {
        fragment.surface.frame_vectors[1] = fragment.dview[0];
    }
    some
}

/// Results of the datapaths for the fragments under all plans of one footprint.
fn under_plans(footprint: FootprintKind, p: &Precision) -> [u64; 3] {
    let mut hashes = [(); 3].map(|()| Hash::default());
    let fragments = some(5);
    let mut lit_count = 0;
    for (frame, horizon) in FRAMES.into_iter().zip(HORIZONS) {
        for roughness in ROUGHNESS {
            for (bump, curvature) in [(false, false), (false, true), (true, false), (true, true)] {
                let effects = Effects { bump, frame, roughness, curvature, footprint, horizon };
                for (index, fragment) in fragments.iter().enumerate() {
                    hashes[0].add(&scalar_api::fragment(&fragment.wires(), &effects.reflection(), p));
                    assert_eq!(
                        fragment.reflect(&effects.reflection(), p),
                        Port::from_wires(&scalar_api::fragment(&fragment.wires(), &effects.reflection(), p))
                    );
                    let (light, peak) = lit(fragment, index);
                    let out = scalar_api::highlight(&light.wires(), &effects.highlight(), p);
                    hashes[1].add(&out);
                    lit_count += u32::from(out.f.raw() > 0);
                    assert_eq!(light.highlight(&effects.highlight(), p), Port::from_wires(&out));
                    let out = scalar_api::lit_peak(&peak.wires(), &effects.peak(), p);
                    hashes[2].add(&out);
                    assert_eq!(peak.shine(&effects.peak(), p), Port::from_wires(&out));
                }
            }
        }
    }
    assert!(lit_count > 20, "only {lit_count} highlights are there to be seen");
    hashes.map(|hash| hash.0)
}

/// A light on a fragment, and a peak on its surface.
fn lit(fragment: &ReflectionIn, index: usize) -> (HighlightIn, PeakIn) {
    let surface = fragment.surface;
    // Any direction, or that of the eye, in which the surface shines.
    let light = [fragment.dview[0], surface.view][index % 2];
    let tilt = index as f64 / 10.0;
    let peak = stored_peak(DVec3::new(tilt, -tilt, 1.0), 3.0, 20.0);
    let horizon = stored_horizon([-0.5 - tilt; 4], [2.0, 0.5, 1.0, 0.0]);
    let weight = I16F16::from_num(0.75);
    let shininess = shininess(30.0 + tilt);
    (HighlightIn { surface, light, shininess }, PeakIn { surface, light, peak, horizon, weight })
}

pub(crate) fn every_plan_hashes_to_what_it_did() {
    let mut found = String::new();
    for profile in [Profile::Narrow, Profile::Standard] {
        for footprint in FOOTPRINTS {
            let hashes = under_plans(footprint, &profile.precision());
            found += &format!("{} {footprint:?} {hashes:016x?}\n", profile.name());
        }
    }
    assert!(found == HASHES, "{found}");
}

pub(crate) fn an_effect_that_is_off_leaves_its_inputs_unread() {
    let p = &Precision::STANDARD;
    for (index, fragment) in some(12).iter().enumerate() {
        let bare = Effects { frame: FRAMES[index % 3], ..Effects::NONE };
        let out = fragment.reflect(&bare.reflection(), p);
        assert_eq!((out.probes, out.lod.to_bits(), out.status & 0x20), (1, 0, 0x20), "a point has one probe: {out:?}");
        let mut changed = *fragment;
        changed.surface.offset = Default::default();
        changed.surface.roughness = Default::default();
        changed.surface.frame_vectors = Default::default();
        changed.dview = Default::default();
        changed.dnormal = Default::default();
        assert_eq!(changed.reflect(&bare.reflection(), p), out);
        let face = Effects { footprint: FootprintKind::Face, ..bare };
        let out = fragment.reflect(&face.reflection(), p);
        changed.dview = fragment.dview;
        assert_eq!(changed.reflect(&face.reflection(), p), out);
    }
}

pub(crate) fn a_backend_that_branches_has_the_probes_of_one_that_does_not() {
    let p = &Precision::STANDARD;
    let plan = &Effects::ALL.reflection().on_sphere();
    let map = environment_scale(64, p);
    let small_map = &of_ports::<Full, _>(&map);
    let same = |small: &[Number], scalar: &[Number]| {
        let integers = |numbers: &[Number]| numbers.iter().map(|number| number.integer).collect::<Vec<_>>();
        assert_eq!(integers(small), integers(scalar));
    };
    let mut counts = BTreeSet::new();
    for (fragment, _) in fragments() {
        let axes = scalar_api::reflection(&fragment.wires(), &map, plan, p).axes;
        let spread = sweep::spread(&axes, p);
        let small = &of_ports::<Full, _>(&axes);
        let found = probes::count_and_level(small, of_ports::<Full, _>(&spread), small_map, p);
        let scalar = probes::count_and_level(&axes, spread, &map, p);
        counts.insert(scalar.count.raw());
        same(&numbers(&to_ports::<Full, _>(&found)), &numbers(&scalar));
        let found = probes::probes(small, small_map, p);
        same(&numbers(&to_ports::<Full, _>(&found)), &numbers(&probes::probes(&axes, &map, p)));
    }
    assert!(counts.len() > 3 && counts.contains(&2), "{counts:?}");
}

pub(crate) fn constants_of_a_map_are_those_of_its_longer_edge() {
    let edges = [1, 2, 3, 4, 5, 37, 64, 100, 500, 1000, 1024, 1025, 16383, 16384];
    for width in edges {
        for height in edges {
            let (texture, map) = texture_scale([width, height]);
            let longer = f64::from(width.max(height));
            let unit = (longer.log2().ceil() as i32 - 1).max(0);
            assert_eq!(texture.log2_unit.raw(), unit);
            assert_eq!(map.log2_texels.raw(), unit << 16);
            assert_eq!(map.last_level.raw(), longer.log2().floor() as i32);
            for (axis, edge) in [width, height].into_iter().enumerate() {
                assert_eq!(texture.size[axis].raw(), i32::from(edge));
                let repeats = (f64::from(1_u32 << (16 + unit)) / f64::from(edge)).floor();
                assert_eq!(f64::from(texture.repeats_per_unit[axis].raw()), repeats);
            }
        }
    }
    let same =
        |a: [u16; 2], b: [u16; 2]| assert_eq!(format!("{:?}", texture_scale(a)), format!("{:?}", texture_scale(b)));
    same([0, 7], [1, 7]);
    same([9, 65535], [9, 16384]);
}

/// All effects, with a footprint of one kind.
struct Bumpy<A, const SPHERE: bool>(A);

impl<A: Accuracy, const SPHERE: bool> Firmware for Bumpy<A, SPHERE> {
    type Accuracy = A;
    const EFFECTS: Effects =
        if SPHERE { Effects { footprint: FootprintKind::Sphere, ..Effects::ALL } } else { Effects::ALL };
}

/// No effect but a footprint.
struct Smooth<const SPHERE: bool>;

impl<const SPHERE: bool> Firmware for Smooth<SPHERE> {
    type Accuracy = Standard;
    const EFFECTS: Effects = {
        let footprint = if SPHERE { FootprintKind::Sphere } else { FootprintKind::Face };
        Effects { footprint, ..Effects::NONE }
    };
}

fn firmware_is_the_scalar_api_on_a_face<F: Firmware>() {
    let p = &F::Accuracy::PRECISION;
    let (plan, map) = (F::EFFECTS.reflection(), environment_scale(64, p));
    let environment = F::environment(64);
    let memory = &Noise { bright: false, edge: 64 };
    let cube = &Cube { memory, edge: 64, last_level: 6, exponent: 1 };
    for (index, (mut fragment, texture)) in fragments().iter().copied().enumerate() {
        if index % 3 == 0 {
            fragment.surface.view = Default::default();
        }
        fragment.edge_texels = 64;
        let out = fragment.reflect(&plan, p);
        assert_eq!(F::reflection(&fragment), out);
        let footprint = F::reflect(&fragment, &environment);
        assert_eq!((footprint.face(), footprint.st(), footprint.lod()), (out.face, out.st, out.lod));
        assert_eq!((footprint.status(), footprint.probes().len()), (out.status, out.probes.into()));
        let stages = scalar_api::reflection(&fragment.wires(), &map, &plan, p);
        for (probe, expected) in footprint.probes().zip(environment_probes(&stages.point, &stages.probes, p)) {
            assert_eq!(i32::from(probe.face), expected.place.face.raw());
            assert_eq!(probe.st.map(I4F28::to_bits), expected.place.st.map(Fx::raw));
            assert_eq!(probe.weight.to_bits(), expected.weight.raw());
        }
        let rough = plan.roughness != RoughnessKind::None;
        let (point, probes) = (&stages.point, &stages.probes);
        let colour = on_words!(p, |point, probes| sampler::environment(point, probes, rough, cube, p));
        assert_eq!(footprint.colour(cube).map(I8F24::to_bits), colour.map(|c| c.0.raw()));

        let (light, peak) = lit(&fragment, index % 5);
        assert_eq!(F::highlight(&light), light.highlight(&F::EFFECTS.highlight(), p));
        assert_eq!(F::peak(&peak), peak.shine(&F::EFFECTS.peak(), p));

        let seen = F::texture_footprint(&texture, &F::texture([300, 40]));
        let scale = texture_scale([300, 40]);
        let expected = texture.footprint(&scale, p).probes;
        let centre = &TexturePosition { uv: texture.uv.wires() };
        assert_eq!((seen.lod().to_bits(), seen.probes().len() as i32), (expected.lod.raw(), expected.count.raw()));
        for (probe, expected) in seen.probes().zip(texture_probes(centre, &expected, &scale.0, p)) {
            assert_eq!(probe.uv.map(|u| i64::from(u.to_bits())), expected.place.uv.map(Fx::raw));
            assert_eq!(probe.weight.to_bits(), expected.weight.raw());
        }
    }
}

fn firmware_is_the_scalar_api_on_the_sphere<F: Firmware>() {
    let p = &F::Accuracy::PRECISION;
    let (plan, map) = (F::EFFECTS.reflection(), environment_scale(64, p));
    let environment = F::environment(64);
    let memory = &Noise { bright: true, edge: 64 };
    let cube = &Cube { memory, edge: 64, last_level: 6, exponent: 10 };
    for (index, (mut fragment, _)) in fragments().iter().copied().enumerate() {
        if index % 3 == 0 {
            fragment.surface.view = Default::default();
        }
        let stages = scalar_api::reflection(&fragment.wires(), &map, &plan, p);
        let footprint = F::sweep(&fragment, &environment);
        assert_eq!(footprint.status() as i32, stages.status.raw());
        let expected = sphere_probes(&stages.sweep, 6, p);
        assert_eq!(footprint.probes().len(), expected.len());
        for ((probe, lod), expected) in footprint.probes().zip(expected) {
            assert_eq!(i32::from(probe.face), expected.place.face.raw());
            assert_eq!(probe.st.map(I4F28::to_bits), expected.place.st.map(Fx::raw));
            assert_eq!((probe.weight.to_bits(), lod.to_bits()), (expected.weight.raw(), expected.lod.raw()));
        }
        let (sweep, rough) = (&stages.sweep, plan.roughness != RoughnessKind::None);
        let colour = on_words!(p, |sweep| sampler::swept_environment(sweep, rough, cube, p));
        assert_eq!(footprint.colour(cube).map(I8F24::to_bits), colour.map(|c| c.0.raw()));
    }
}

pub(crate) fn firmware_has_the_bits_of_the_scalar_api() {
    firmware_is_the_scalar_api_on_a_face::<Bumpy<Narrow, false>>();
    firmware_is_the_scalar_api_on_a_face::<Smooth<false>>();
    firmware_is_the_scalar_api_on_the_sphere::<Bumpy<Standard, true>>();
    firmware_is_the_scalar_api_on_the_sphere::<Smooth<true>>();
}

/// Hashes of the reflection, highlights and peaks, by profile and footprint.
const HASHES: &str = "\
narrow None [9c87b66a232e5ebe, 679c93849b6cb0e0, 6fe0a0cbeca9d6f0]
narrow Face [31fca6ff603a2702, 679c93849b6cb0e0, 6fe0a0cbeca9d6f0]
narrow Sphere [72201be5b6fcab1d, 679c93849b6cb0e0, 6fe0a0cbeca9d6f0]
standard None [27ed67871b58d92e, 0150b6a73ae6f56b, 06d6e4c4a01a6888]
standard Face [cd017ab6b5ed900a, 0150b6a73ae6f56b, 06d6e4c4a01a6888]
standard Sphere [f8c1a1d067785211, 0150b6a73ae6f56b, 06d6e4c4a01a6888]
";
