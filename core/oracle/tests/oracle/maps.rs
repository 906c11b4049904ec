//! From fragments of the tile to what they see of maps: bright and dark environments on a face and on the sphere, repeated maps.

use roughxel_core::bundle::{Bundle, Value};
use roughxel_core::datapath::texel;
use roughxel_core::fx::Fx;
use roughxel_core::plan::{Effects, FootprintKind, ReflectionPlan};
use roughxel_core::ports::{Port, ReflectionIn, TextureIn};
use roughxel_core::precision::{Precision, Profile};
use roughxel_core::probe_list::{environment_probes, sphere_probes, texture_probes};
use roughxel_core::repeated::{self, Level, Tap, View};
use roughxel_core::sampler::{self, COARSEST_EDGE, Cube, CubeMemory, level_edge};
use roughxel_core::signals::{RepeatedFootprint, TexturePosition};
use roughxel_core::soft_core::{environment_scale, reflection, texture_footprint, texture_scale};
use roughxel_core::width::on_words;

use crate::random::Random;
use crate::tile;
use crate::walk::numbers;

/// An environment whose texels are random codes, bright or not.
struct Noise {
    bright: bool,
    edge: u32,
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
struct Hash(u64);

impl Hash {
    fn add(&mut self, bundle: &impl Bundle<i32>) {
        for number in numbers(bundle) {
            self.0 = Random(self.0 ^ number.integer as u64).bits();
        }
    }
}

/// Some fragments of the tile, the last ones with footprints that are magnified or large.
fn fragments() -> Vec<(ReflectionIn, TextureIn)> {
    let mut all = Vec::new();
    tile::drawn::fragments(|_, fragment| {
        all.push((fragment.reflection, fragment.texture.expect("the tile has texture coordinates")));
    });
    let some = all.into_iter().step_by(41).enumerate();
    some.map(|(index, (mut reflection, mut texture))| {
        let scale = [0, -6, 0, 2, 0, 5][index % 6];
        let scaled = |exponent: &mut i16| *exponent += scale;
        reflection.dview.iter_mut().for_each(|d| scaled(&mut d.exponent));
        reflection.dnormal.iter_mut().for_each(|d| scaled(&mut d.exponent));
        texture.duv.iter_mut().for_each(|d| scaled(&mut d.exponent));
        (reflection, texture)
    })
    .collect()
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
                assert!((1..=32).contains(&seen.taps.raw()));
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
    let texels = |tap: &Tap<i32>, [turn, coarse]: [i32; 2]| texel::Quad {
        texels: tap.texels.map(|place| {
            assert!((0..start).contains(&place.raw()));
            let bits = Random(place.raw() as u64).bits();
            [bits as u16, (bits >> 16) as u16, turn as u16, coarse as u16].map(|code| Fx::from_raw(code.into()))
        }),
        weight: tap.weight,
    };
    for (_, fragment) in fragments() {
        let footprint = texture_footprint(&fragment.duv.wires(), &scale, &map, p);
        hash.add(&footprint);
        let centre = &TexturePosition { uv: fragment.uv.wires() };
        let probes = texture_probes(centre, &footprint.probes, &scale, p);
        probes.iter().for_each(|probe| hash.add(probe));
        let repeated = &RepeatedFootprint { probes: footprint.probes, reach: Fx::zero() };
        for rough in [false, true] {
            let view = &View { centre, footprint: Some((repeated, &scale)), levels: &levels, rough };
            let mut weights = 0;
            repeated::reads::<i32>(view, p, |read| weights += read.weight.raw());
            // Each weight is rounded.
            assert!((weights - 0x10000).abs() <= 16, "{weights:#x}");
            for view in [view, &View { footprint: None, ..*view }] {
                let mean = repeated::mean(view, texels, texel::colour_samples, |sample| sample, p);
                hash.add(&mean.channels);
                hash.add(&Value(mean.taps));
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
        for (edge, plan) in [(64, on_face), (1000, on_face), (3, on_face), (64, on_face.on_sphere()), (1000, on_face.on_sphere())] {
            found += &format!("{} {edge} {:?} {:016x}\n", profile.name(), plan.footprint, environments(edge, &plan, p));
        }
        for size in [[64, 32], [37, 500]] {
            found += &format!("{} {size:?} {:016x}\n", profile.name(), textures(size, p));
        }
    }
    assert!(found == HASHES, "{found}");
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
narrow 64 Face 6d71016edad8ded8
narrow 1000 Face ef0d1cfd72022b7b
narrow 3 Face 549a80b8c4e98782
narrow 64 Sphere e565848e121c8616
narrow 1000 Sphere aa958ba65c35624e
narrow [64, 32] e1112c9c8ee5a965
narrow [37, 500] 7ea9f27971694a4e
paper 64 Face 8faec9bfa9141850
paper 1000 Face 06736b5d3fdafbbb
paper 3 Face 0b7a5ee784521944
paper 64 Sphere e772f6378377a881
paper 1000 Sphere 465e89ac2c29406d
paper [64, 32] f8da2a651989302e
paper [37, 500] d78298080c091224
standard 64 Face ebde1a2375fb8d39
standard 1000 Face d31fbc7fb9abc6c9
standard 3 Face a5086b95b649f7cb
standard 64 Sphere 7d96d8f480d70ecb
standard 1000 Sphere 0d17bc84e6e8f4a8
standard [64, 32] 3944ce15f0404f52
standard [37, 500] 351573da35c4302e
";
