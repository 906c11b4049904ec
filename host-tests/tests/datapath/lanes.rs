//! Lanes give the bits of the scalar backend: every pass of every fragment, with every instruction set of this machine. A failure names the first
//! wire that differs.

use std::ops::Range;

use rayon::prelude::*;
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::bundle::{Bundle, Rewire};
use roughxel_core::datapath::texel::BumpScale;
use roughxel_core::datapath::{self, TextureFootprint};
use roughxel_core::design::Form;
use roughxel_core::fx::Fx;
use roughxel_core::plan::{FootprintKind, ReflectionPlan};
use roughxel_core::ports::{Peak, Port, PortBlock, ReflectionIn, ReflectionInput, SurfaceInput};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::sampler::level_edge;
use roughxel_core::scalar_api::{self, environment_scale, texture_scale};
use roughxel_core::signals::{MapScale, TexturePosition, WrappedFootprint};
use roughxel_core::stage::moments;
use roughxel_core::width::on_words;
use roughxel_host_tests::checked::{Integers, first_difference};
use roughxel_host_tests::space::plans;
use roughxel_netlist::integers::integers;
use roughxel_shader::{
    Batch, BumpMap, BumpTexels, Bumps, ColourMap, Colours, CubeTexels, EnvironmentColours, FaceFootprint, Footprints,
    MapTexels, Ordered, Places, Points, Ports, Reflected, Reflector, RoughBump, ShadedColour, Shader, Surfaces, Sweeps,
    TextureFootprints, WrappedMap,
};
use roughxel_simd::{Backend, InstructionSet, LANES};
use roughxel_utilities::random::SplitMix64;

use super::lane_words::corner;

/// The named profiles, and 16-bit words with the fewest kept bits that a profile allows.
pub(super) fn profiles() -> impl Iterator<Item = (&'static str, Precision)> {
    let narrowest = ("narrowest", Precision { fraction_bits: 12, ..Precision::NARROW });
    roughxel_host_tests::space::profiles().into_iter().chain([narrowest])
}

pub(super) fn same_wires<B: Bundle<i32>>(expected: &B, got: &B) -> Result<(), String> {
    if integers(expected) == integers(got) {
        return Ok(());
    }
    Err(first_difference(&Integers::from_bundle(expected), &Integers::from_bundle(got)).unwrap_or_default())
}

/// Asserts that every wire of every fragment equals that of the scalar backend.
pub(super) fn same_columns<B: Form>(expected: &Batch<B>, got: &Batch<B>, context: &dyn Fn() -> String) {
    assert_eq!(expected.len(), got.len(), "{}", context());
    for (expected, got) in expected.iter().zip(got.iter()) {
        same_wires(&expected, &got).unwrap_or_else(|difference| panic!("{}: {difference}", context()));
    }
}

/// Asserts that every backend of this machine computes the expected batch.
pub(super) fn made_by_all<B: Form>(
    expected: &Batch<B>,
    p: &Precision,
    context: &dyn Fn() -> String,
    make: impl Fn(Shader<'_>, &mut Batch<B>),
) {
    let mut got = Batch::default();
    for backend in InstructionSet::available().map(Backend::Simd).chain([Backend::Scalar]) {
        make(Shader::new(backend, p), &mut got);
        same_columns(expected, &got, &|| format!("{}, {backend}", context()));
    }
}

/// Asserts that every backend computes the same results for every fragment as the scalar one.
fn same_in_lanes<B: Form>(p: &Precision, context: &dyn Fn() -> String, make: impl Fn(Shader<'_>, &mut Batch<B>)) {
    let mut expected = Batch::default();
    make(Shader::new(Backend::Scalar, p), &mut expected);
    made_by_all(&expected, p, context, make);
}

/// Compares the footprint of every fragment with the scalar datapath, with every backend: every stage feeds it.
///
/// The surface is also computed on its own, and the reflection from that surface.
fn compare(inputs: &[ReflectionInput<i32>], scale: &MapScale<i32>, plan: &ReflectionPlan, p: &Precision) {
    let scalar: Vec<_> = inputs.iter().map(|input| scalar_api::reflection(input, scale, plan, p)).collect();
    let (ports, surfaces) = (Ports::from_iter(inputs.iter().copied()), scalar.iter().map(|stages| stages.surface));
    let (surfaces, context) = (Batch::from_iter(surfaces), &|| format!("{plan:?}"));
    made_by_all(&surfaces, p, context, |shader, got| {
        Surfaces::new(shader, &ports.bare, &ports.bumps, &plan.surface()).run(shader, got);
    });
    let points = Batch::from_iter(scalar.iter().map(|stages| stages.point));
    made_by_all(&points, p, context, |shader, got| Points(&surfaces).run(shader, got));
    let reflected = Reflected { surfaces: &surfaces, derivatives: &ports.derivatives, scale, plan };
    // The inputs of fetching do not need the values of the other kind of footprint.
    match plan.footprint {
        FootprintKind::Sphere => {
            let sweeps = Batch::from_iter(scalar.iter().map(|stages| stages.sweep));
            made_by_all(&sweeps, p, context, |shader, got| Sweeps(reflected).run(shader, got));
        }
        _ => {
            let footprints = Batch::from_iter(scalar.iter().map(FaceFootprint::from_reflection));
            made_by_all(&footprints, p, context, |shader, got| Footprints(reflected).run(shader, got));
        }
    }
}

#[test]
fn environments_in_lanes_are_those_of_the_scalar_backend() {
    for (name, p) in profiles() {
        (0..60_u64).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(name, index);
            let edge: u32 = [1, 2, 5, 16, 24, 64][random.below(6) as usize];
            let (is_bright, is_filtered) = (random.below(2) == 1, random.below(4) > 0);
            let levels = if is_filtered { 1 + edge.ilog2() } else { 1 };
            let texels = (0..levels).map(|level| 6 * level_edge(edge, level).pow(2)).sum::<u32>();
            let exponent = if is_bright { 7 + random.below(14) as i32 } else { random.below(7) as i32 };
            let texels: Vec<_> = (0..texels).map(|_| [(); 3].map(|()| random.next_u64() as u16)).collect();
            let map = CubeTexels::new(edge, exponent, is_bright, &[&texels]);

            let mut scale = environment_scale(edge as u16, &p);
            scale.last_level = Fx::from_raw(levels as i32 - 1);
            let ports = Ports::from_iter(random_inputs(name, 1000 * index..1000 * index + 1 + index % 70, &p));
            let plan = &ReflectionPlan::FULL;
            let (mut surfaces, mut footprints, mut sweeps) = <(Batch<_>, Batch<_>, Batch<_>)>::default();
            let scalar = Shader::new(Backend::Scalar, &p);
            Surfaces::new(scalar, &ports.bare, &ports.bumps, &plan.surface()).run(scalar, &mut surfaces);
            let reflected = Reflected { surfaces: &surfaces, derivatives: &ports.derivatives, scale: &scale, plan };
            Footprints(reflected).run(scalar, &mut footprints);
            Sweeps(reflected).run(scalar, &mut sweeps);
            let own = Batch::from_iter(surfaces.iter().map(|_| ShadedColour {
                channels: [(); 3].map(|()| Fx::from_raw(random.below(64 << 24) as i32)),
                samples: Fx::from_raw(0),
            }));
            let reflectance = [(); 3].map(|()| Fx::from_raw(random.below(0x1_0001) as i32));
            let is_rough = random.below(2) == 1;
            let reflector = Reflector { own: &own, map: &map, is_rough, reflectance: &reflectance };
            // Without a footprint the one probe is the point.
            let plan = &ReflectionPlan { footprint: FootprintKind::None, ..*plan };
            let (mut points, mut one_probe) = (Batch::default(), Batch::default());
            let mut shown = [Batch::default(), Batch::default()];
            Points(&surfaces).run(scalar, &mut points);
            Footprints(Reflected { plan, ..reflected }).run(scalar, &mut one_probe);
            let (at_points, at_one) =
                (EnvironmentColours { looks: &points, reflector }, EnvironmentColours { looks: &one_probe, reflector });
            at_points.run(scalar, &mut shown[0]);
            at_one.run(scalar, &mut Ordered::default(), &mut shown[1]);
            same_columns(&shown[0], &shown[1], &|| format!("{name}, a point, edge {edge}"));
            let context = &|| format!("{name}, edge {edge}, bright {is_bright}");
            same_in_lanes(&p, context, |shader, got| at_points.run(shader, got));
            let on_faces = EnvironmentColours { looks: &footprints, reflector };
            same_in_lanes(&p, context, |shader, got| on_faces.run(shader, &mut Ordered::default(), got));
            let on_sphere = EnvironmentColours { looks: &sweeps, reflector };
            same_in_lanes(&p, context, |shader, got| on_sphere.run(shader, &mut Ordered::default(), got));
        });
    }
}

/// A map of any size, with 1 to 70 fragments that look somewhere in it, and their footprints.
pub(super) fn random_views(
    name: &str,
    index: u64,
    p: &Precision,
) -> (WrappedMap, Batch<TexturePosition<i32>>, Batch<WrappedFootprint<i32>>) {
    let mut bits = AnyBits(SplitMix64::for_element(name, !index));
    let size = [(); 2].map(|()| {
        let log2 = bits.0.below(7);
        1 + bits.0.below(1 << log2) as u32
    });
    let last = size[0].max(size[1]).ilog2();
    let map = WrappedMap::new((0..=last).map(|level| size.map(|edge| (edge >> level).max(1)).into()));
    let count = 1 + index % 70;
    let blank = PortBlock { mantissa: [Fx::from_raw(0); 2], exponent: Fx::from_raw(0) };
    let derivatives = Batch::from_iter((0..count).map(|_| {
        [(); 2].map(|()| {
            let any: PortBlock<i32, 2> = blank.rewire(&mut bits);
            PortBlock { exponent: Fx::from_raw(bits.0.below(12) as i32 - 10), ..any }
        })
    }));
    let mut probes = Batch::default();
    let pass = TextureFootprints { derivatives: &derivatives, scale: &map.scale, is_rough: true };
    pass.run(Shader::new(Backend::Scalar, p), &mut probes);
    let uv = |_| TexturePosition { uv: [(); 2].map(|()| Fx::from_raw(bits.0.below(1 << 32) as i64)) };
    (map, Batch::from_iter((0..count).map(uv)), probes)
}

#[test]
fn repeated_maps_in_lanes_are_those_of_the_scalar_backend() {
    for (name, p) in profiles() {
        (0..120_u64).into_par_iter().for_each(|index| {
            let mut random = SplitMix64::for_element(name, index);
            let (map, centres, probes) = random_views(name, index, &p);
            let (size, texels) =
                (map.size(), map.levels.iter().map(|level| level.size[0] * level.size[1]).sum::<i32>());
            let colours: Vec<_> = (0..texels).map(|_| [(); 3].map(|()| random.next_u64() as u16)).collect();
            // b of at most 1 and a covariance, as in a decoded texel.
            let mut share = || random.below(1 << 29) as i32 - (1 << 28);
            let smooth: Vec<_> = (0..texels).map(|_| [(); 2].map(|()| share())).collect();
            let rough: Vec<_> = (0..texels)
                .map(|_| {
                    let [b1, b2, k11, k12, k22] = [(); 5].map(|()| share());
                    let offset = [b1, b2].map(|code| (code % 32768) as i16);
                    RoughBump { offset, covariance: [k11.abs(), k12 / 2, k22.abs()] }
                })
                .collect();

            let own = [(); 3].map(|()| Fx::from_raw(random.below(64 << 24) as i32));
            let exponent = random.below(7) as i32;
            let scale = BumpScale {
                offset_down: Fx::from_raw(random.below(17) as i32),
                roughness_down: Fx::from_raw(random.below(28) as i32),
                exponent: Fx::from_raw(random.below(17) as i32 - 13),
            };
            let colours = &ColourMap { texels: MapTexels::new(map.clone(), colours), exponent };
            let smooth = BumpMap { texels: BumpTexels::Smooth(MapTexels::new(map.clone(), smooth)), scale };
            let rough = BumpMap { texels: BumpTexels::Rough(MapTexels::new(map, rough)), scale };
            for footprints in [None, Some(&probes)] {
                let places = Places { centres: &centres, footprints };
                let context = |what: &str| format!("{name}, {what}, {size:?}, filtered {}", footprints.is_some());
                let pass = Colours { places, map: colours, own: &own };
                same_in_lanes(&p, &|| context("colours"), |shader, got| pass.run(shader, got));
                let kinds = [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic];
                for (kind, map) in kinds.into_iter().flat_map(|kind| [(kind, &smooth), (kind, &rough)]) {
                    let pass = Bumps { places, map, kind };
                    same_in_lanes(&p, &|| context(&format!("bumps {kind:?}")), |shader, got| pass.run(shader, got));
                }
            }
        });
    }
}

#[test]
fn offsets_are_the_same_with_roughness_beside_them() {
    for (name, p) in profiles() {
        let (map, centres, _) = random_views(name, 7, &p);
        let mut random = SplitMix64::for_element(name, 0);
        let texels: i32 = map.levels.iter().map(|level| level.size[0] * level.size[1]).sum();
        let codes: Vec<_> =
            (0..texels).map(|_| [(); 2].map(|()| (random.below(65535) as i32 - 32767) as i16)).collect();
        let rough = codes.iter().map(|&offset| RoughBump { offset, covariance: [0; 3] });
        let rough = BumpTexels::Rough(MapTexels::new(map.clone(), rough));
        for down in 0..=16 {
            let offset_down = Fx::from_raw(down);
            let decoded = |code: i16| moments::decode_offset::<i32>(Fx::from_raw(code.into()), offset_down).raw();
            let smooth = codes.iter().map(|codes| codes.map(decoded));
            let smooth = BumpTexels::Smooth(MapTexels::new(map.clone(), smooth));
            let scale = BumpScale { offset_down, roughness_down: Fx::zero(), exponent: Fx::zero() };
            let places = Places { centres: &centres, footprints: None };
            let [expected, got] = [&smooth, &rough].map(|texels| {
                let (mut bumps, map) = (Batch::default(), BumpMap { texels: texels.clone(), scale });
                let pass = Bumps { places, map: &map, kind: RoughnessKind::None };
                pass.run(Shader::new(Backend::Scalar, &p), &mut bumps);
                bumps
            });
            same_columns(&expected, &got, &|| format!("{name}, down {down}"));
        }
    }
}

/// Ports of the fragments `indices` of a random set.
fn random_inputs(name: &str, indices: Range<u64>, p: &Precision) -> Vec<ReflectionInput<i32>> {
    indices.map(|index| random_fragment(name, index, p).wires()).collect()
}

/// The environment's scale for the first fragment, used for all.
fn scale_of(inputs: &[ReflectionInput<i32>], p: &Precision) -> MapScale<i32> {
    environment_scale(inputs.first().map_or(1, |input| input.edge_texels.raw() as u16), p)
}

#[test]
fn every_hard_case_gives_the_bits_of_the_scalar_backend() {
    let plans = plans();
    for (_, p) in profiles() {
        for set in hard_case_sets(&p) {
            let inputs: Vec<_> = set.cases.iter().map(Port::wires).collect();
            inputs.par_chunks(64).enumerate().for_each(|(chunk, inputs)| {
                let scale = scale_of(inputs, &p);
                compare(inputs, &scale, &set.plan, &p);
                plans.iter().skip(chunk % 7).step_by(7).for_each(|plan| compare(inputs, &scale, plan, &p));
            });
        }
    }
}

#[test]
fn random_fragments_give_the_bits_of_the_scalar_backend() {
    let plans = plans();
    for (name, p) in profiles() {
        (0..160_u64).into_par_iter().for_each(|batch| {
            let inputs = random_inputs(name, 200 * batch..200 * (batch + 1), &p);
            let scale = scale_of(&inputs, &p);
            compare(&inputs, &scale, &ReflectionPlan::FULL, &p);
            // Batches of any length, faces and probe counts mixed.
            let length = 1 + batch as usize % 60;
            compare(&inputs[..length], &scale, &plans[batch as usize % plans.len()], &p);
        });
    }
}

/// Puts any bits on the wires.
pub(super) struct AnyBits(pub(super) SplitMix64);

impl Rewire<i32, i32> for AnyBits {
    fn word(&mut self, _: i32, _: u32) -> i32 {
        corner(&mut self.0) as i32
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    fn wide(&mut self, _: i64, _: u32) -> i64 {
        corner(&mut self.0)
    }
    fn flag(&mut self, _: bool) -> bool {
        self.0.below(2) == 1
    }
}

#[test]
fn fragments_of_one_frame_have_the_surface_that_each_has_alone() {
    let plans = plans();
    for (name, p) in profiles() {
        (0..60_u64).into_par_iter().for_each(|batch| {
            let mut inputs = random_inputs(name, 200 * batch..203 * batch + 1, &p);
            let SurfaceInput { normal, frame_vectors, .. } = inputs[0].surface;
            for input in &mut inputs {
                input.surface = SurfaceInput { normal, frame_vectors, ..input.surface };
            }
            let (scale, plan) = (scale_of(&inputs, &p), &plans[batch as usize % plans.len()]);
            compare(&inputs, &scale, plan, &p);
            let (ports, mut surfaces) = (Ports::from_iter(inputs.iter().copied()), Batch::default());
            let scalar = Shader::new(Backend::Scalar, &p);
            Surfaces::new(scalar, &ports.bare, &ports.bumps, &plan.surface()).run(scalar, &mut surfaces);
            for (input, surface) in inputs.iter().zip(surfaces.iter()) {
                same_wires(&scalar_api::surface(&input.surface, &plan.surface(), &p), &surface).unwrap();
            }
            // The last fragment differs from the others in one word of its normal or of a vector of its tangent basis.
            let last = inputs.len() - 1;
            let SurfaceInput { normal, frame_vectors: [u, v], .. } = &mut inputs[last].surface;
            let block = match batch % 3 {
                0 => normal,
                1 => u,
                _ => v,
            };
            match batch / 3 % 4 {
                3 => block.exponent = Fx::from_raw(block.exponent.raw() ^ 1),
                i => block.mantissa[i as usize] = Fx::from_raw(block.mantissa[i as usize].raw() ^ 1 << 28),
            }
            compare(&inputs, &scale, plan, &p);
        });
    }
}

#[test]
fn wires_that_no_port_carries_give_the_bits_of_the_scalar_backend() {
    let plans = plans();
    for (name, p) in profiles() {
        (0..200_u64).into_par_iter().for_each(|index| {
            let mut bits = AnyBits(SplitMix64::for_element(name, index));
            let blank = ReflectionIn::default().wires();
            let scale = scale_of(&[], &p).rewire(&mut bits);
            let inputs: Vec<ReflectionInput<i32>> = (0..40).map(|_| blank.rewire(&mut bits)).collect();
            compare(&inputs, &scale, &plans[index as usize % plans.len()], &p);
        });
    }
}

#[test]
fn a_group_holds_fragments_of_different_faces_and_probe_counts() {
    let p = Precision::STANDARD;
    let inputs = random_inputs("mixed", 0..LANES as u64, &p);
    let scale = scale_of(&inputs, &p);
    let ports = Ports::from_iter(inputs.iter().copied());
    let footprints = ports.footprints(Shader::new(Backend::best(), &p), &scale, &ReflectionPlan::FULL);
    let distinct = |of: fn(&FaceFootprint<i32>) -> i32| {
        let mut values: Vec<_> = footprints.iter().map(|footprint| of(&footprint)).collect();
        values.sort_unstable();
        values.dedup();
        values.len()
    };
    assert!(distinct(|footprint| footprint.point.select.index().raw()) >= 4);
    assert!(distinct(|footprint| footprint.probes.count.raw()) >= 4);
    compare(&inputs, &scale, &ReflectionPlan::FULL, &p);
}

#[test]
fn batches_of_any_length_come_back_in_order() {
    for p in [Precision::STANDARD, Precision::NARROW] {
        let inputs = random_inputs("length", 0..100, &p);
        for length in 0..=inputs.len() {
            compare(&inputs[..length], &scale_of(&inputs, &p), &ReflectionPlan::FULL, &p);
        }
    }
}

#[test]
fn texture_footprints_in_lanes_are_those_of_the_scalar_backend() {
    for (name, p) in profiles() {
        (0..2000_u64).into_par_iter().for_each(|index| {
            let mut bits = AnyBits(SplitMix64::for_element(name, index));
            let size = [bits.0.below(15), bits.0.below(15)].map(|log2| 1 + bits.0.below(1 << log2) as u16);
            let scale = texture_scale(size);
            // Mantissas as ports carry them, and exponents for half of the fragments; otherwise any bits.
            let blank = PortBlock { mantissa: [Fx::from_raw(0); 2], exponent: Fx::from_raw(0) };
            let mut derivative = || {
                let any: PortBlock<i32, 2> = blank.rewire(&mut bits);
                let exponent = if index % 2 == 0 { any.exponent.raw() >> 16 } else { bits.0.below(24) as i32 - 16 };
                PortBlock { exponent: Fx::from_raw(exponent), ..any }
            };
            let derivatives = Batch::from_iter((0..index % 50).map(|_| [derivative(), derivative()]));
            let (texture, map, rough) = (&scale.0, &scale.1, index % 3 > 0);
            let scalar = derivatives.iter().map(|duv| {
                let duv = &duv;
                on_words!(&p, |duv, texture, map| {
                    let TextureFootprint { axes, probes, .. } = datapath::texture_footprint(duv, texture, map, &p);
                    let reach = if rough {
                        datapath::probe_reach([&axes.major, &axes.minor], &probes, texture, &p)
                    } else {
                        Fx::zero()
                    };
                    WrappedFootprint { probes, reach }
                })
            });
            let (scalar, context) = (Batch::from_iter(scalar), &|| format!("{name}, {size:?}, {derivatives:?}"));
            let pass = TextureFootprints { derivatives: &derivatives, scale: &scale, is_rough: rough };
            made_by_all(&scalar, &p, context, |shader, got| pass.run(shader, got));
        });
    }
}

/// A peak of any bits that a map stores.
pub(super) fn stored_peak(bits: &mut AnyBits) -> Peak<i32> {
    let zero = Fx::from_raw(0);
    let any: Peak<i32> = Peak { normal: [Fx::from_raw(0); 3], amplitude: zero, exponent: zero }.rewire(bits);
    let code = |x: Fx<i32, 32>| Fx::from_raw(x.raw() & 0xffff);
    let normal = any.normal.map(|x| Fx::from_raw(i32::from(x.raw() as i16)));
    Peak { normal, amplitude: code(any.amplitude), exponent: code(any.exponent) }
}
