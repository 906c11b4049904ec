//! Fetches from the environment: probes on cube faces, across their edges and at their corners.

use roughxel_core::datapath::{pixel, texel};
use roughxel_core::each::each;
use roughxel_core::fx::{Control, Fx, Int};
use roughxel_core::precision::Precision;
use roughxel_core::probe_list::environment_probes;
use roughxel_core::signals::{CubePoint, FacePosition, Probes};
use roughxel_core::stage::filter::{Address, LevelPair, Patch, ProbeSum, WEIGHT};
use roughxel_core::stage::seam::FaceTexel;
use roughxel_maps::environment::CubePyramid;
use roughxel_maps::mip::{Level, smallest_exponent};
use roughxel_scene::picture::Picture;

use super::MAX_MAP_EXPONENT;
use super::colour::Channel;

/// The environment of a scene.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    pyramid: CubePyramid,
}

/// Four texels on one level of a cube map, with the weights of the right and of the lower ones.
type FacePatch = ([[i32; 3]; 4], [Control<i32, WEIGHT>; 2]);

impl EnvironmentMap {
    /// Builds the pyramid, or only its base where nothing is filtered.
    pub fn new(faces: &[Picture; 6], filters: bool) -> Self {
        let exponent = smallest_exponent(faces).min(MAX_MAP_EXPONENT);
        let mut pyramid = CubePyramid::with_exponent(faces, exponent);
        if !filters {
            pyramid.levels.truncate(1);
        }
        Self { pyramid }
    }

    /// Edge of level 0 in texels.
    pub fn edge(&self) -> u32 {
        self.pyramid.edge
    }

    /// Bytes of the stored texels.
    pub fn bytes(&self) -> u64 {
        let levels = self.pyramid.levels.iter().flatten();
        levels.map(|level| size_of_val(level.texels.as_slice()) as u64).sum()
    }

    /// The mean colour of a footprint, I8F24: N trilinear probes along its major axis; a rough one is sampled with the
    /// roughness bias.
    pub fn sample(&self, point: &CubePoint<i32>, probes: &Probes<i32>, rough: bool, p: &Precision) -> [Channel; 3] {
        let pair = texel::levels::<i32>(probes.lod, rough, p);
        let mut sums = [ProbeSum::<i32>::zero(); 3];
        for probe in environment_probes(point, probes, p) {
            for (sum, channel) in sums.iter_mut().zip(self.trilinear(&probe.place, &pair, p)) {
                *sum = texel::probe_sum(sum, channel, probe.weight);
            }
        }
        let exponent = Fx::from_raw(self.pyramid.exponent);
        each!(sum in sums => pixel::colour::<i32>(texel::probe_mean(&sum), exponent))
    }

    fn trilinear(&self, place: &FacePosition<i32>, pair: &LevelPair<i32>, p: &Precision) -> [Int<i32>; 3] {
        let fine = pair.level.raw() as usize;
        let coarse = (fine + 1).min(self.pyramid.levels.len() - 1);
        let a = self.patch(fine, place, p);
        let b = if pair.weight.raw() == 0 { a } else { self.patch(coarse, place, p) };
        each!(channel in [0, 1, 2] => {
            let [a, b] = each!((texels, weight) in [&a, &b] => {
                Patch::<i32> { texels: each!(texel in *texels => Fx::from_raw(texel[channel])), weight: *weight }
            });
            texel::colour_sample(&a, &b, pair.weight)
        })
    }

    /// What a bilinear sample of a level reads.
    fn patch(&self, level: usize, place: &FacePosition<i32>, p: &Precision) -> FacePatch {
        let faces = &self.pyramid.levels[level];
        let edge = faces[0].width;
        let address = texel::face_address::<i32>(place, Fx::from_raw(edge as i32), p);
        (bilinear_texels(faces, place.face, &address, edge), address.weight)
    }
}

/// The four texels of an address; what lies beyond the face comes from its neighbours.
fn bilinear_texels(faces: &[Level; 6], face: Int<i32>, address: &Address<i32>, edge: u32) -> [[i32; 3]; 4] {
    let [i, j] = address.index.map(Fx::raw);
    // Where all four lie on the face they lie side by side in memory.
    let inside = |index: i32| (0..edge as i32 - 1).contains(&index);
    if inside(i) && inside(j) {
        let level = &faces[face.raw() as usize];
        let first = j as usize * edge as usize + i as usize;
        return [first, first + 1, first + edge as usize, first + edge as usize + 1]
            .map(|index| level.texels[index].map(i32::from));
    }
    seam_texels(faces, face, address, edge)
}

/// The same beside an edge. A call of its own: few fragments come here, and inlined it leaves no registers for all others.
#[inline(never)]
fn seam_texels(faces: &[Level; 6], face: Int<i32>, address: &Address<i32>, edge: u32) -> [[i32; 3]; 4] {
    let read = |texel: FaceTexel<i32>| {
        let [i, j] = texel.index.map(|index| index.raw() as u32);
        faces[texel.face.raw() as usize].texel(i, j).map(i32::from)
    };
    texel::face_texels::<i32>(face, address, Fx::from_raw(edge as i32)).map(|texel| {
        let own = read(texel.texel);
        if !texel.corner {
            return own;
        }
        let [s, t] = texel.across.map(read);
        core::array::from_fn(|channel| {
            texel::corner::<i32>(&[own, s, t].map(|texel| Fx::from_raw(texel[channel]))).raw()
        })
    })
}
