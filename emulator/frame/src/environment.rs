//! Fetches from the environment: probes on cube faces, across their edges and at their corners.

use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::probe_list::environment_probes;
use roughxel_core::signals::{CubePoint, FacePosition, Probes};
use roughxel_core::stage::filter::{ProbeSum, ROUGHNESS_LOD_BIAS, biased, corner, face_address, levels, trilinear};

use roughxel_maps::environment::{CubePyramid, CubeTexel, FaceTexel, texel_across_edge};
use roughxel_maps::mip::{Level, smallest_exponent};
use roughxel_scene::picture::Picture;

use super::{Colour, MAX_MAP_EXPONENT};

/// The environment of a scene.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    pyramid: CubePyramid,
}

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

    /// The mean colour of a footprint: N trilinear probes along its major axis; a rough one is sampled with the
    /// roughness bias.
    pub fn sample(&self, point: &CubePoint<i32>, probes: &Probes<i32>, rough: bool, p: &Precision) -> Colour {
        let lod = if rough { biased(probes.lod, Fx::lit(ROUGHNESS_LOD_BIAS), p) } else { probes.lod };
        let mut sums = [ProbeSum::<i32>::zero(); 3];
        for probe in environment_probes(point, probes, p) {
            for (sum, channel) in sums.iter_mut().zip(self.trilinear(&probe.place, lod, p)) {
                *sum = sum.add(channel, probe.weight);
            }
        }
        sums.map(|sum| sum.mean() << self.pyramid.exponent)
    }

    fn trilinear(&self, place: &FacePosition<i32>, lod: Fx<i32, 16>, p: &Precision) -> [i32; 3] {
        let pair = levels(lod);
        let fine = pair.level.raw() as usize;
        let coarse = (fine + 1).min(self.pyramid.levels.len() - 1);
        let face = place.face.raw() as u8;
        let fetch = |level: usize| {
            let faces = &self.pyramid.levels[level];
            let edge = faces[0].width;
            let address = face_address(&place.st, Fx::from_raw(edge as i32), p);
            (bilinear_texels(faces, face, address.index.map(Fx::raw), edge), address.weight)
        };
        let (a, a_weight) = fetch(fine);
        let (b, b_weight) = if pair.weight.raw() == 0 { (a, a_weight) } else { fetch(coarse) };
        core::array::from_fn(|channel| {
            let (a, b) = (a.map(|texel| texel[channel]), b.map(|texel| texel[channel]));
            trilinear((&a, &a_weight), (&b, &b_weight), pair.weight, 8)
        })
    }
}

/// The four texels from (i, j) on; what lies beyond the face comes from its neighbours.
fn bilinear_texels(faces: &[Level; 6], face: u8, [i, j]: [i32; 2], edge: u32) -> [[i32; 3]; 4] {
    let inside = |index: i32| (0..edge as i32 - 1).contains(&index);
    if inside(i) && inside(j) {
        let level = &faces[usize::from(face)];
        let first = j as usize * edge as usize + i as usize;
        return [first, first + 1, first + edge as usize, first + edge as usize + 1]
            .map(|index| level.texels[index].map(i32::from));
    }
    let read = |texel: FaceTexel| faces[usize::from(texel.face)].texel(texel.i, texel.j).map(i32::from);
    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, down)| match texel_across_edge(face, i + right, j + down, edge) {
        CubeTexel::Texel(texel) => read(texel),
        CubeTexel::Corner(three) => {
            let three = three.map(read);
            core::array::from_fn(|channel| corner(&three.map(|texel| texel[channel])))
        }
    })
}
