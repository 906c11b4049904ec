//! Sampling of an environment: from the probes of a footprint to its colour, on a processor with a memory. Frames of the emulator and pixels of
//! firmware use it.

use core::ops::RangeInclusive;

use crate::bundle::{Value, bundle};
use crate::datapath::texel::Quad;
use crate::datapath::{cube_place, environment_probe, pixel, sphere_probe, texel};
use crate::each::each;
use crate::fetch::{Fetch, int};
use crate::fx::{Control, Fx, Int};
use crate::ports::{LIGHT, REFLECTANCE, SHARE};
use crate::precision::Precision;
use crate::signals::{CubePoint, FacePosition, Probes, Sweep};
use crate::stage::filter::{Address, LevelPair, ProbeSum};
use crate::stage::seam::FaceTexel;
use crate::staged::stage;
use crate::word::Word;

/// Exponents of linear codes: an environment of at most 2^6 × white.
pub const LINEAR_EXPONENTS: RangeInclusive<i32> = 0..=6;
/// Exponents of bright codes: an environment of at most 2^20 × white. Its darkest codes are still twice as fine as linear codes of 2^6.
pub const BRIGHT_EXPONENTS: RangeInclusive<i32> = 7..=20;

/// Face edge, in texels, below which levels of an environment are only more blurred, not smaller. With fewer texels a wide lobe is the gradient of a
/// bilinear patch, whose edges show.
pub const COARSEST_EDGE: u32 = 16;

/// Texels along a face edge of a level, for `edge` texels at level 0.
#[inline(always)]
pub fn level_edge(edge: u32, level: u32) -> u32 {
    (edge >> level.min(31)).max(edge.min(COARSEST_EDGE)).max(1)
}

/// The texels of an environment: six faces in Vulkan's order, level by level.
pub trait CubeMemory {
    /// Three channels at a place of a face, as 16-bit codes. There are [`level_edge`] columns and rows, and faces 0 … 5.
    fn texel(&self, level: u32, face: u32, column: u32, row: u32) -> [u16; 3];

    /// Returns true if each code has an exponent ([`texel::bright_texel`]), for environments brighter than 64 × white. If a memory answers with a
    /// constant, environments that are not so bright cost nothing extra.
    #[inline(always)]
    fn is_bright(&self) -> bool {
        false
    }

    /// Implements [`patches`]; a memory overrides it if it finds the texels of a bilinear sample faster together.
    #[inline(always)]
    fn patches<W: Fetch>(&self, at: &PatchPlace<W>) -> [[Int<W>; 3]; 4]
    where
        Self: Sized,
    {
        patches(self, at)
    }
}

/// Place that a bilinear sample of every fragment reads.
#[derive(Clone, Copy, Debug)]
pub struct PatchPlace<W: Word> {
    /// Level of the sample.
    pub level: Int<W>,
    /// Texels along a face edge on that level.
    pub edge: Int<W>,
    /// Face, 0 … 5.
    pub face: Int<W>,
    /// Column and row of the first texel, −1 … edge − 1.
    pub index: [Int<W>; 2],
}

/// An environment in a memory.
#[derive(Debug)]
pub struct Cube<'a, M> {
    /// Memory with its texels.
    pub memory: &'a M,
    /// Texels along the edge of a face at level 0, 1…16384.
    pub edge: u32,
    /// Last level of the memory; 0 if nothing is filtered.
    pub last_level: u32,
    /// log₂ of the unit in linear light. A code is code/65536 of the unit, with exponents 0…6. A code of a bright memory is its decoded number over
    /// 2^31, with exponents 7…20.
    pub exponent: i32,
}

// A cube is a reference and three numbers for any memory.
impl<M> Clone for Cube<'_, M> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<M> Copy for Cube<'_, M> {}

bundle! {
    /// Sample of an environment over a footprint, before the unit is applied.
    pub struct EnvironmentSample<W> {
        /// Mean of each channel as the pixel stages take it: [`pixel::colour`], or [`pixel::bright_blend`] if the memory is bright. The latter clamps
        /// light above 64 × white after the reflectance of a surface, not before.
        mean: [Int<W>; 3],
        /// Number of bilinear samples: one for each probe, and another on the coarser level unless its weight is 0.
        #[range(0..=32)]
        samples: Int<W>,
    }
}

/// Mean colour of a footprint, I8F24: trilinear probes along its major axis. A rough footprint is sampled with the roughness bias. The colour of a
/// bright environment is clamped to the largest number below 64.
#[inline(always)]
pub fn environment<W: Fetch, M: CubeMemory>(
    point: &CubePoint<W>,
    probes: &Probes<W>,
    rough: bool,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> [Value<W, LIGHT>; 3] {
    light::<W, M>(&means::<W, M>(point, probes, rough, cube, p), cube)
}

/// Mean colour of a footprint on the sphere, I8F24: trilinear probes, each with its own level, and the same bias and clamp as [`environment`].
#[inline(always)]
pub fn swept_environment<W: Fetch, M: CubeMemory>(
    sweep: &Sweep<W>,
    rough: bool,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> [Value<W, LIGHT>; 3] {
    light::<W, M>(&swept_means::<W, M>(sweep, rough, cube, p), cube)
}

#[inline(always)]
fn light<W: Fetch, M: CubeMemory>(seen: &EnvironmentSample<W>, cube: &Cube<'_, M>) -> [Value<W, LIGHT>; 3] {
    let (unit, is_bright) = (int::<W>(cube.exponent), cube.memory.is_bright());
    each!(mean in seen.mean => Value(if is_bright {
        pixel::bright_blend::<W>(Fx::zero(), mean, unit, Fx::int(1))
    } else {
        pixel::colour::<W>(mean, unit)
    }))
}

/// Colour of a surface that reflects an environment: its own colour and its sample, blended by its reflectance.
#[inline(always)]
pub fn blended<W: Fetch, M: CubeMemory>(
    surface: &[Control<W, LIGHT>; 3],
    seen: &EnvironmentSample<W>,
    reflectance: &[Control<W, REFLECTANCE>; 3],
    cube: &Cube<'_, M>,
) -> [Value<W, LIGHT>; 3] {
    let unit = int::<W>(cube.exponent);
    if cube.memory.is_bright() {
        pixel::bright_reflected(surface, &seen.mean, unit, reflectance)
    } else {
        pixel::reflected(surface, &seen.mean, unit, reflectance)
    }
}

/// Sample of a point of the cube without a footprint: one bilinear sample of the finest level.
#[inline(always)]
pub fn point_means<W: Fetch, M: CubeMemory>(
    point: &CubePoint<W>,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> EnvironmentSample<W> {
    // The mean of one sample of one level is the sample.
    let pair = LevelPair { level: Fx::zero(), weight: Fx::zero() };
    EnvironmentSample { mean: trilinear::<W, M>(&cube_place(point), &pair, cube, p), samples: Fx::int(1) }
}

/// Sample of a footprint on its face.
#[inline(always)]
pub fn means<W: Fetch, M: CubeMemory>(
    point: &CubePoint<W>,
    probes: &Probes<W>,
    rough: bool,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> EnvironmentSample<W> {
    let pair = texel::levels::<W>(probes.lod, W::known(rough), p);
    let mut sum = Sum::none();
    for turn in 0..W::max_over_lanes(probes.count) {
        let (index, counts) = W::loop_index(turn, probes.count);
        let probe = environment_probe(point, probes, index, p);
        sum.add::<M>((&probe.place, probe.weight), &pair, counts, cube, p);
    }
    sum.seen()
}

/// Sample of a footprint on the sphere.
#[inline(always)]
pub fn swept_means<W: Fetch, M: CubeMemory>(
    sweep: &Sweep<W>,
    rough: bool,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> EnvironmentSample<W> {
    let last_level = int::<W>(cube.last_level as i32);
    let mut sum = Sum::none();
    for turn in 0..W::max_over_lanes(sweep.count) {
        let (index, counts) = W::loop_index(turn, sweep.count);
        let probe = sphere_probe(sweep, index, last_level, p);
        let pair = texel::levels::<W>(probe.lod, W::known(rough), p);
        sum.add::<M>((&probe.place, probe.weight), &pair, counts, cube, p);
    }
    sum.seen()
}

/// Sum of the probes of a footprint so far.
struct Sum<W: Word> {
    channels: [ProbeSum<W>; 3],
    samples: Int<W>,
}

impl<W: Fetch> Sum<W> {
    #[inline(always)]
    fn none() -> Self {
        Self { channels: [ProbeSum::zero(); 3], samples: Fx::zero() }
    }

    /// Adds a probe, if it counts.
    #[inline(always)]
    fn add<M: CubeMemory>(
        &mut self,
        (place, weight): (&FacePosition<W>, Control<W, SHARE>),
        pair: &LevelPair<W>,
        counts: W::Flag,
        cube: &Cube<'_, M>,
        p: &Precision,
    ) {
        let weight = Fx::select(counts, weight, Fx::zero());
        let sample = trilinear::<W, M>(place, pair, cube, p);
        self.channels = texel::probe_sums(&self.channels, &sample, weight);
        let samples = Fx::select(pair.weight.is_zero(), Fx::int(1), Fx::int(2));
        self.samples = self.samples + Fx::select(counts, samples, Fx::zero());
    }

    #[inline(always)]
    fn seen(self) -> EnvironmentSample<W> {
        EnvironmentSample { mean: texel::probe_means(&self.channels), samples: self.samples }
    }
}

#[inline(always)]
fn trilinear<W: Fetch, M: CubeMemory>(
    place: &FacePosition<W>,
    pair: &LevelPair<W>,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> [Int<W>; 3] {
    let fine = stage!("fetch.face", face_quad::<W, M>(pair.level, place, cube, p));
    let coarse = if W::any(!pair.weight.is_zero()) {
        let level = (pair.level + Fx::int(1)).min(int::<W>(cube.last_level as i32));
        Some(stage!("fetch.face", face_quad::<W, M>(level, place, cube, p)))
    } else {
        None
    };
    if cube.memory.is_bright() {
        texel::word_samples(&fine, coarse.as_ref(), pair.weight)
    } else {
        texel::colour_samples(&fine, coarse.as_ref(), pair.weight)
    }
}

/// [`level_edge`] for every fragment.
#[inline(always)]
fn edge_of<W: Fetch>(edge: u32, level: Int<W>) -> Int<W> {
    let edge = int::<W>(edge as i32);
    edge.floor_shr_by(level).max(edge.min(int::<W>(COARSEST_EDGE as i32))).max(Fx::int(1))
}

/// Texels and weights of a bilinear sample of a level. Texels beyond the face come from its neighbours.
#[inline(always)]
fn face_quad<W: Fetch, M: CubeMemory>(
    level: Int<W>,
    place: &FacePosition<W>,
    cube: &Cube<'_, M>,
    p: &Precision,
) -> Quad<W, 3> {
    let edge = edge_of::<W>(cube.edge, level);
    let Address { index, weight } = texel::face_address::<W>(place, edge, p);
    Quad { texels: cube.memory.patches(&PatchPlace::<W> { level, edge, face: place.face, index }), weight }
}

/// Texels (0,0), (1,0), (0,1), (1,1) of bilinear samples, read one by one; bright codes are decoded. Texels beyond a face come from its neighbours.
#[inline(always)]
pub fn patches<W: Fetch, M: CubeMemory>(memory: &M, at: &PatchPlace<W>) -> [[Int<W>; 3]; 4] {
    let &PatchPlace { level, edge, face, index: [column, row] } = at;
    let texels = W::per_lane(
        each!(number in [level, edge, face, column, row] => number.raw()),
        #[inline(always)]
        |[level, edge, face, column, row]| {
            // Without a sign −1 is the largest number.
            let last = (edge - 1) as u32;
            if column as u32 >= last || row as u32 >= last {
                return seam_texels(level as u32, face, [column, row], edge as u32, memory);
            }
            flat(each!((right, down) in [(0, 0), (1, 0), (0, 1), (1, 1)] => {
                let [column, row] = [(column + right) as u32, (row + down) as u32];
                decoded(memory.texel(level as u32, face as u32, column, row), memory)
            }))
        },
    );
    each!(i in [0, 1, 2, 3] => each!(channel in [0, 1, 2] => Fx::from_raw(texels[3 * i + channel])))
}

/// Decodes the channels of a texel.
#[inline(always)]
fn decoded<M: CubeMemory>(codes: [u16; 3], memory: &M) -> [i32; 3] {
    each!(code in codes => {
        let code = Int::<i32>::int(code.into());
        if memory.is_bright() { texel::bright_texel::<i32>(code).raw() } else { code.raw() }
    })
}

/// Channels of a patch in one array, texel by texel.
#[inline(always)]
fn flat([[a, b, c], [d, e, f], [g, h, i], [j, k, l]]: [[i32; 3]; 4]) -> [i32; 12] {
    [a, b, c, d, e, f, g, h, i, j, k, l]
}

/// Texels of a bilinear sample next to an edge. It is a separate call: few probes come here, and inlined it leaves no registers for all others. It
/// computes control values only, so words of any width share it.
#[inline(never)]
fn seam_texels<M: CubeMemory>(level: u32, face: i32, index: [i32; 2], edge: u32, memory: &M) -> [i32; 12] {
    let corner =
        |three: &_| if memory.is_bright() { texel::bright_corner::<i32>(three) } else { texel::corner::<i32>(three) };
    let read = |texel: FaceTexel<i32>| {
        let [column, row] = texel.index.map(|index| index.raw() as u32);
        decoded(memory.texel(level, texel.face.raw() as u32, column, row), memory)
    };
    let address = Address::<i32> { index: index.map(Fx::from_raw), weight: [Fx::zero(); 2] };
    flat(texel::face_texels(Fx::from_raw(face), &address, Fx::from_raw(edge as i32)).map(|texel| {
        let own = read(texel.texel);
        if !texel.corner {
            return own;
        }
        let [s, t] = texel.across.map(read);
        core::array::from_fn(|channel| corner(&[own, s, t].map(|texel| Fx::from_raw(texel[channel]))).raw())
    }))
}
