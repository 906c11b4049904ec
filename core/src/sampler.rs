//! From the probes of a footprint to its colour, on a processor with a memory: frames of the emulator and pixels of firmware alike.
//!
//! Arithmetic is that of the composer ([`texel`], [`pixel`]); here are the loops around it and the fetches.

use core::ops::RangeInclusive;

use crate::bundle::Value;
use crate::datapath::{environment_probe, pixel, sphere_probe, texel};
use crate::each::each;
use crate::fx::{Fx, Int};
use crate::ports::LIGHT;
use crate::precision::Precision;
use crate::signals::{CubePoint, FacePosition, Probes, SphereProbe, Sweep};
use crate::stage::filter::{Address, LevelPair, Patch, ProbeSum, WEIGHT};
use crate::stage::seam::FaceTexel;
use crate::width::{IntegerCount, IntegerWord};

/// Exponents of linear codes: an environment of at most 2^6 × white.
pub const LINEAR_EXPONENTS: RangeInclusive<i32> = 0..=6;
/// Exponents of bright codes: one of at most 2^20 × white, whose darkest codes are still twice as fine as linear ones of 2^6.
pub const BRIGHT_EXPONENTS: RangeInclusive<i32> = 7..=20;

/// Texels along the edge of a face below which levels of an environment do not become smaller, only more blurred: between fewer of them a wide lobe is the
/// gradient of a bilinear patch, whose edges show.
pub const COARSEST_EDGE: u32 = 16;

/// Texels along the edge of a face of a level, of `edge` at level 0.
#[inline(always)]
pub fn level_edge(edge: u32, level: u32) -> u32 {
    (edge >> level.min(31)).max(edge.min(COARSEST_EDGE)).max(1)
}

/// The texels of an environment: six faces in Vulkan's order, level by level.
pub trait CubeMemory {
    /// Whether codes have an exponent each ([`texel::bright_texel`]), for environments brighter than 64 × white. As a constant, it costs
    /// those that are not so bright nothing.
    const BRIGHT: bool = false;

    /// Three channels at a place of a face, codes of 16 bits: of [`level_edge`] columns and rows, 0 … 5 faces.
    fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3];

    /// The same at (column, row), to its right, below it, and to the right of that: all four on the face. For a memory in which they
    /// are found faster together.
    #[inline(always)]
    fn patch(&self, level: u32, face: u32, column: u32, row: u32) -> [[u16; 3]; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, down)| self.texel(level, face, column + right, row + down))
    }
}

/// An environment in a memory.
#[derive(Debug)]
pub struct Cube<'a, M> {
    /// Its texels.
    pub memory: &'a M,
    /// Texels along the edge of a face at level 0, 1…16384.
    pub edge: u32,
    /// The last level that the memory has: 0 where nothing is filtered.
    pub last_level: u32,
    /// log₂ of the unit in linear light. A code is code/65536 of it, 0…6; that of a bright memory what it decodes to, over 2^31, 7…20.
    pub exponent: i32,
}

// A cube is a reference and three numbers whatever the memory is.
impl<M> Clone for Cube<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<M> Copy for Cube<'_, M> {}

/// Four texels of a level as integers, with the weights of the right and of the lower ones.
type FacePatch<C> = ([[Fx<C, 32>; 3]; 4], [Fx<C, WEIGHT>; 2]);

/// The mean colour of a footprint, I8F24: trilinear probes along its major axis; a rough one is sampled with the roughness bias. Of a
/// bright environment it is cut to the largest number below 64.
#[inline(always)]
pub fn environment<W: IntegerWord, M: CubeMemory>(
    point: &CubePoint<W>,
    probes: &Probes<W>,
    rough: bool,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> [Value<W, LIGHT>; 3] {
    light::<W, M>(means::<W, M>(point, probes, rough, cube, p), cube)
}

/// The mean colour of a footprint on the sphere, in the same way: trilinear probes, each with its own level.
#[inline(always)]
pub fn swept_environment<W: IntegerWord, M: CubeMemory>(
    sweep: &Sweep<W>,
    rough: bool,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> [Value<W, LIGHT>; 3] {
    let last_level = int::<W>(cube.last_level as i32);
    let probes = (0..sweep.count.raw().integer()).map(
        #[inline(always)]
        |index| sphere_probe(sweep, int::<W>(index), last_level, p),
    );
    light::<W, M>(swept_means::<W, M>(probes, rough, cube, p), cube)
}

#[inline(always)]
fn light<W: IntegerWord, M: CubeMemory>(means: [Value<W, 32>; 3], cube: &Cube<'_, M>) -> [Value<W, LIGHT>; 3] {
    let exponent = int::<W>(cube.exponent);
    each!(mean in means => Value(if M::BRIGHT {
        pixel::bright_blend::<W>(Fx::zero(), mean.0, exponent, Fx::int(1))
    } else {
        pixel::colour::<W>(mean.0, exponent)
    }))
}

/// The same mean as the stages of pixels take it: [`pixel::colour`], or [`pixel::bright_blend`] if the memory is bright, which cuts what
/// is brighter than 64 × white after the reflectance of a surface and not before.
#[inline(always)]
pub fn means<W: IntegerWord, M: CubeMemory>(
    point: &CubePoint<W>,
    probes: &Probes<W>,
    rough: bool,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> [Value<W, 32>; 3] {
    let pair = texel::levels::<W>(probes.lod, rough, p);
    let mut sums = [ProbeSum::<W>::zero(); 3];
    for index in 0..probes.count.raw().integer() {
        let probe = environment_probe(point, probes, int::<W>(index), p);
        for (sum, channel) in sums.iter_mut().zip(trilinear::<W, M>(&probe.place, &pair, cube, p)) {
            *sum = texel::probe_sum(sum, channel, probe.weight);
        }
    }
    each!(sum in sums => Value(texel::probe_mean(&sum)))
}

/// The mean of probes on the sphere as the stages of pixels take it.
#[inline(always)]
pub fn swept_means<W: IntegerWord, M: CubeMemory>(
    probes: impl Iterator<Item = SphereProbe<W>>,
    rough: bool,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> [Value<W, 32>; 3] {
    let mut sums = [ProbeSum::<W>::zero(); 3];
    for probe in probes {
        let pair = texel::levels::<W>(probe.lod, rough, p);
        for (sum, channel) in sums.iter_mut().zip(trilinear::<W, M>(&probe.place, &pair, cube, p)) {
            *sum = texel::probe_sum(sum, channel, probe.weight);
        }
    }
    each!(sum in sums => Value(texel::probe_mean(&sum)))
}

#[inline(always)]
fn int<W: IntegerWord>(integer: i32) -> Int<W> {
    Fx::from_raw(W::Count::of_integer(integer))
}

#[inline(always)]
fn trilinear<W: IntegerWord, M: CubeMemory>(
    place: &FacePosition<W>,
    pair: &LevelPair<W>,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> [Int<W>; 3] {
    let fine = pair.level.raw().integer() as u32;
    let coarse = (fine + 1).min(cube.last_level);
    let a = face_patch::<W, M>(fine, place, cube, p);
    let b = if pair.weight.raw().integer() == 0 { a } else { face_patch::<W, M>(coarse, place, cube, p) };
    each!(channel in [0, 1, 2] => {
        let [a, b] = each!((texels, weight) in [&a, &b] => {
            Patch::<W> { texels: each!(texel in *texels => texel[channel]), weight: *weight }
        });
        if M::BRIGHT {
            texel::word_sample(&a, &b, pair.weight)
        } else {
            texel::colour_sample(&a, &b, pair.weight)
        }
    })
}

/// What a bilinear sample of a level reads; what lies beyond the face comes from its neighbours.
#[inline(always)]
fn face_patch<W: IntegerWord, M: CubeMemory>(
    level: u32,
    place: &FacePosition<W>,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> FacePatch<W::Count> {
    let edge = level_edge(cube.edge, level);
    let address = texel::face_address::<W>(place, int::<W>(edge as i32), p);
    let index = address.index.map(|index| index.raw().integer());
    let (memory, face) = (cube.memory, place.face.raw().integer());
    let codes = if index.iter().all(|index| (0..edge as i32 - 1).contains(index)) {
        memory.patch(level, face as u32, index[0] as u32, index[1] as u32)
    } else if M::BRIGHT {
        let decoded = |code: u16| texel::bright_texel::<i32>(int::<i32>(code.into())).raw();
        let corner = |three: &_| texel::bright_corner::<i32>(three).raw();
        let texels = seam_texels(level, face, index, edge, memory, decoded, corner);
        return (each!(texel in texels => each!(channel in texel => int::<W>(channel))), address.weight);
    } else {
        let corner = |three: &_| texel::corner::<i32>(three).raw() as u16;
        seam_texels(level, face, index, edge, memory, |code| code, corner)
    };
    let channel = |code: u16| {
        let code = int::<W>(code.into());
        if M::BRIGHT { texel::bright_texel::<W>(code) } else { code }
    };
    (each!(texel in codes => each!(code in texel => channel(code))), address.weight)
}

/// The same beside an edge. A call of its own: few probes come here, and inlined it leaves no registers for all others. What it works
/// out controls alone, so words of any width have the same.
#[inline(never)]
fn seam_texels<M: CubeMemory, T: Copy + Into<i32>>(
    level: u32,
    face: i32,
    index: [i32; 2],
    edge: u32,
    memory: &M,
    decoded: impl Fn(u16) -> T,
    corner: impl Fn(&[Int<i32>; 3]) -> T,
) -> [[T; 3]; 4] {
    let read = |texel: FaceTexel<i32>| {
        let [column, row] = texel.index.map(|index| index.raw() as u32);
        memory.texel(level, texel.face.raw() as u32, column, row).map(&decoded)
    };
    let address = Address::<i32> { index: index.map(Fx::from_raw), weight: [Fx::zero(); 2] };
    texel::face_texels(Fx::from_raw(face), &address, Fx::from_raw(edge as i32)).map(|texel| {
        let own = read(texel.texel);
        if !texel.corner {
            return own;
        }
        let [s, t] = texel.across.map(read);
        core::array::from_fn(|channel| corner(&[own, s, t].map(|texel| Fx::from_raw(texel[channel].into()))))
    })
}
