//! The way from fragments of the tile to map lookups: bright and dark environments on a face and on the sphere, wrapped maps.

use std::sync::LazyLock;

use roughxel_core::bundle::{Bundle, Value};
use roughxel_core::datapath::{TextureFootprint, texel};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{Effects, FootprintKind, ReflectionPlan};
use roughxel_core::ports::{Port, ReflectionIn, TextureIn};
use roughxel_core::precision::{Precision, Profile};
use roughxel_core::probe_list::{environment_probes, sphere_probes, texture_probes};
use roughxel_core::sampler::{self, COARSEST_EDGE, Cube, CubeMemory, level_edge};
use roughxel_core::scalar_api::{environment_scale, reflection, texture_footprint, texture_scale};
use roughxel_core::signals::{TexturePosition, WrappedFootprint};
use roughxel_core::width::on_words;
use roughxel_core::wrapped::{self, Level, Neighbours, View};

use crate::tile;
use roughxel_oracle::random::Random;
use roughxel_oracle::walk::numbers;

/// An environment whose texels are random codes, bright or not.
pub(crate) struct Noise {
    pub(crate) bright: bool,
    pub(crate) edge: u32,
}

impl CubeMemory for Noise {
    fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3] {
        let edge = level_edge(self.edge, level);
        assert!(face < 6 && column < edge && row < edge, "{level} {face} {column} {row}");
        let place = u64::from(level) << 48 | u64::from(face) << 40 | u64::from(column) << 20 | u64::from(row);
        let bits = Random(place).bits();
        [bits as u16, (bits >> 16) as u16, (bits >> 32) as u16]
    }
    fn is_bright(&self) -> bool {
        self.bright
    }
}

/// A hash of bundles.
#[derive(Default)]
pub(crate) struct Hash(pub(crate) u64);

impl Hash {
    pub(crate) fn add(&mut self, bundle: &impl Bundle<i32>) {
        for number in numbers(bundle) {
            self.0 = Random(self.0 ^ number.integer as u64).bits();
        }
    }
}

/// Fragments of the tile, including some with magnified or large footprints.
pub(crate) fn fragments() -> &'static [(ReflectionIn, TextureIn)] {
    static FRAGMENTS: LazyLock<Vec<(ReflectionIn, TextureIn)>> = LazyLock::new(|| {
        let mut some = Vec::new();
        let mut index = 0;
        tile::drawn::fragments(|_, fragment| {
            if index % 67 == 0 {
                some.push((fragment.reflection, fragment.texture.expect("the tile has texture coordinates")));
            }
            index += 1;
        });
        for (index, (reflection, texture)) in some.iter_mut().enumerate() {
            let scale = [0, -6, 0, 2, 0, 5][index % 6];
            let derivatives = reflection.dview.iter_mut().chain(&mut reflection.dnormal);
            derivatives.for_each(|d| d.exponent += scale);
            texture.duv.iter_mut().for_each(|d| d.exponent += scale);
        }
        some
    });
    &FRAGMENTS
}

fn environments(edge: u16, plan: &ReflectionPlan, p: &Precision) -> u64 {
    let mut hash = Hash::default();
    let map = environment_scale(edge, p);
    let last_level = map.last_level.raw() as u32;
    for (fragment, _) in fragments() {
        let out = reflection(&fragment.wires(), &map, plan, p);
        for bright in [false, true] {
            let memory = &Noise { bright, edge: edge.into() };
            let exponent = if bright { 9 } else { 2 };
            let cube = &Cube { memory, edge: edge.into(), last_level, exponent };
            let (point, probes, sweep) = (&out.point, &out.probes, &out.sweep);
            let colours = [3 << 20, 1 << 24, 9 << 24].map(Fx::lit);
            let reflectance = [0x1999, 0x8000, 0x10000].map(Fx::lit);
            if plan.footprint == FootprintKind::Sphere {
                hash.add(&on_words!(p, |sweep| sampler::swept_environment(sweep, true, cube, p)));
            } else {
                hash.add(&on_words!(p, |point, probes| sampler::environment(point, probes, false, cube, p)));
                hash.add(&on_words!(p, |point| sampler::point_means(point, cube, p)));
                let seen = sampler::means(point, probes, true, cube, p);
                hash.add(&sampler::blended::<i32, _>(&colours, &seen, &reflectance, cube));
                assert!((1..=32).contains(&seen.samples.raw()));
            }
        }
        if plan.footprint == FootprintKind::Sphere {
            sphere_probes(&out.sweep, last_level, p).iter().for_each(|probe| hash.add(probe));
        } else {
            environment_probes(&out.point, &out.probes, p).iter().for_each(|probe| hash.add(probe));
        }
    }
    hash.0
}

/// Footprint of a wrapped map without a reach: no bumps are read.
fn footprint_of(footprint: &TextureFootprint<i32>) -> WrappedFootprint<i32> {
    WrappedFootprint { probes: footprint.probes, reach: Fx::zero() }
}

fn textures(size: [u16; 2], p: &Precision) -> u64 {
    let mut hash = Hash::default();
    let (scale, map) = texture_scale(size);
    let mut levels = Vec::new();
    let (mut start, mut sides) = (0, size.map(i32::from));
    while levels.len() as i32 <= map.last_level.raw() {
        let stride = sides[0] + 3;
        levels.push(Level { size: sides, stride, start });
        start += stride * sides[1];
        sides = sides.map(|side| (side / 2).max(1));
    }
    let texels = |neighbours: &Neighbours<i32>, [turn, coarse]: [i32; 2]| texel::Quad {
        texels: neighbours.texels.map(|place| {
            assert!((0..start).contains(&place.raw()));
            let bits = Random(place.raw() as u64).bits();
            [bits as u16, (bits >> 16) as u16, turn as u16, coarse as u16].map(|code| Fx::from_raw(code.into()))
        }),
        weight: neighbours.weight,
    };
    for (_, fragment) in fragments() {
        let footprint = texture_footprint(&fragment.duv.wires(), &scale, &map, p);
        hash.add(&footprint);
        let centre = &TexturePosition { uv: fragment.uv.wires() };
        let probes = texture_probes(centre, &footprint.probes, &scale, p);
        probes.iter().for_each(|probe| hash.add(probe));
        let repeated = &footprint_of(&footprint);
        for rough in [false, true] {
            let view = &View { centre, footprint: Some((repeated, &scale)), levels: &levels, rough };
            let mut weights = 0;
            wrapped::reads::<i32>(view, p, |read| weights += read.weight.raw());
            // Each weight is rounded.
            assert!((weights - 0x10000).abs() <= 16, "{weights:#x}");
            for view in [view, &View { footprint: None, ..*view }] {
                let mean = wrapped::mean(view, texels, texel::colour_samples, |sample| sample, p);
                hash.add(&mean.channels);
                hash.add(&Value(mean.samples));
            }
        }
    }
    hash.0
}

pub(crate) fn what_fragments_see_of_maps_hashes_to_what_it_did() {
    let mut found = String::new();
    for profile in [Profile::Narrow, Profile::Paper, Profile::Standard] {
        let p = &profile.precision();
        let on_face = Effects::ALL.reflection();
        for (edge, plan) in
            [(64, on_face), (1000, on_face), (3, on_face), (64, on_face.on_sphere()), (1000, on_face.on_sphere())]
        {
            found += &format!("{} {edge} {:?} {:016x}\n", profile.name(), plan.footprint, environments(edge, &plan, p));
        }
        for size in [[64, 32], [37, 500]] {
            found += &format!("{} {size:?} {:016x}\n", profile.name(), textures(size, p));
        }
    }
    assert!(found == HASHES, "{found}");
}

pub(crate) fn beyond_the_last_level_of_a_map_the_last_one_is_read() {
    let (p, size) = (&Precision::STANDARD, [64, 64]);
    let (scale, map) = texture_scale(size);
    let only = Level { size: size.map(i32::from), stride: 67, start: 5 };
    for (_, fragment) in fragments() {
        let footprint = texture_footprint(&fragment.duv.wires(), &scale, &map, p);
        let (centre, repeated) = (&TexturePosition { uv: fragment.uv.wires() }, &footprint_of(&footprint));
        let read = |levels: &[Level]| {
            let mut texels = Vec::new();
            let view = &View { centre, footprint: Some((repeated, &scale)), levels, rough: false };
            wrapped::reads::<i32>(view, p, |read| {
                let levels = [Some(read.fine), read.coarse].into_iter().flatten();
                texels.extend(levels.flat_map(|neighbours| neighbours.texels.map(Fx::raw)));
            });
            texels
        };
        assert_eq!(read(&[only]), read(&[only; 8]));
    }
}

pub(crate) fn levels_of_an_environment_halve_down_to_the_coarsest_edge() {
    for edge in 1_u32..=300 {
        for level in 0..40 {
            let halved = edge.checked_shr(level).unwrap_or(0).max(1);
            let expected = if edge <= COARSEST_EDGE { edge } else { halved.max(COARSEST_EDGE) };
            assert_eq!(level_edge(edge, level), expected, "{edge} {level}");
        }
    }
}

const HASHES: &str = "\
narrow 64 Face 5a02974861d467a0
narrow 1000 Face aa9b0459ad7a7880
narrow 3 Face 65d71039fb3bc459
narrow 64 Sphere b3e92a6f40acedad
narrow 1000 Sphere dcaec79ddbda27fd
narrow [64, 32] e7d5043a310336e7
narrow [37, 500] b706b6bbd0877aa9
paper 64 Face 87158f55e353c74d
paper 1000 Face 62b1ff96cab97595
paper 3 Face 1b9f701c0a32f809
paper 64 Sphere 067f55192da8f460
paper 1000 Sphere e0bc223ab27bfb40
paper [64, 32] 434cff6556169649
paper [37, 500] e3bae12194afccb2
standard 64 Face ba9ac99a041b10a6
standard 1000 Face 38fad3cb3820f3ff
standard 3 Face c09e8cab2d22dad8
standard 64 Sphere 312a1a27be15272d
standard 1000 Sphere 8609330e2dd57760
standard [64, 32] 6c8762c985f1e203
standard [37, 500] 36423ded0f2fae4b
";
