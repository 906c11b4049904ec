//! Peaks of a map that a batch of fragments reads.
//!
//! A fragment reads up to 32 patches of four texels with a few peaks each. On average it reads two of five texels twice. Light is therefore computed
//! once for each pair, a fragment and a peak of a texel that it reads, in lanes of any fragments. It is then summed by texel, and texels are filtered
//! like any other.

use roughxel_core::bundle::Value;
use roughxel_core::datapath;
use roughxel_core::each::each;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::ports::LIGHT;
use roughxel_core::signals::{LocalDirection, PeakSum};

use crate::batch::{Batch, GROUP};
use crate::maps::Places;
use crate::pass::Shader;
use crate::peak_passes::{PatchesRead, PeakLights, PeakMeans, PeakPatches};
use crate::peaks::{MOST_PEAKS, Patches, PeakPairs, PeakTexels, slot};
use crate::signals::{ShadedColour, Slopes};

/// Array of the room for the peaks of a texel.
#[inline(always)]
fn run<T>(peaks: &mut [T]) -> &mut [T; MOST_PEAKS] {
    peaks.first_chunk_mut().unwrap_or_else(|| unreachable!("room was made for a whole run"))
}

/// Number that no texel of a map has.
const NO_TEXEL: u32 = u32::MAX;

/// Place that no texel of a batch has.
const NO_PLACE: u32 = u32::MAX;

/// A light on fragments whose peaks were read of a map.
#[derive(Clone, Copy)]
pub struct LightOnPeaks<'a> {
    /// Map of the peaks.
    pub map: &'a PeakTexels,
    /// Places of the fragments in the map.
    pub places: Places<'a>,
    /// Half vectors of the light.
    pub halves: &'a Batch<LocalDirection<i32>>,
    /// Slopes of the light and the eye, if the map has horizons.
    pub slopes: Option<&'a Batch<Slopes<i32>>>,
    /// Colour of the light times that of the peaks.
    pub colour: &'a [Control<i32, LIGHT>; 3],
}

/// Peaks that a batch of fragments reads of a map; the memory is kept for the next batch.
#[derive(Debug, Default)]
pub struct PeaksRead {
    /// Numbers 0, 1, 2, … of the fragments, and of as many more as a lane group.
    numbers: Batch<Value<i32, 32>>,
    /// Number of patches that each fragment reads.
    read: Batch<PatchesRead<i32>>,
    /// Texels of the patches; later the places of those in `sums`.
    patches: Vec<i32>,
    pairs: PeakPairs,
    /// End of the pairs of each texel, in the order of `sums`, and room for more.
    ends: Vec<u32>,
    lights: Batch<Value<i32, LIGHT>>,
    /// Light of each texel.
    sums: Vec<i32>,
}

impl PeaksRead {
    /// Reads the peaks of a batch of fragments, and only once the peaks that a probe shares with the one before it. Returns the number of bilinear
    /// samples.
    pub fn read(&mut self, map: &PeakTexels, places: Places<'_>, shader: Shader<'_>) -> u64 {
        let fragments = places.centres.len();
        let room = fragments + GROUP;
        if self.numbers.len() < room {
            self.numbers = (0..room as i32).map(|number| Value(Fx::from_raw(number))).collect();
            self.patches.resize(Patches::words(room), 0);
        }
        let patches = Patches::from_words(&mut self.patches);
        let pass = PeakPatches { places, map: &map.map, numbers: &self.numbers, patches: &patches };
        shader.run(&pass, &mut self.read);
        let (turns, levels) = (self.read.row_of(|read| read.turns), self.read.row_of(|read| read.levels));
        let samples = turns.iter().zip(levels).map(|(&turns, &levels)| (turns * levels) as u64).sum();
        // Compiled for the instruction set: runs of indices are vectors.
        shader.backend.run(
            #[inline(always)]
            || self.pair(map),
        );
        samples
    }

    /// Names the peaks of all texels that are read; patches then hold the places of their sums.
    #[inline(always)]
    fn pair(&mut self, map: &PeakTexels) {
        let Self { read, patches, pairs, ends, sums, .. } = self;
        let (turns, levels) = (read.row_of(|read| read.turns), read.row_of(|read| read.levels));
        let (begins, patches) = (&map.begins[..], Patches::from_words(patches));
        let (mut peaks, mut texels) = (0, 0);
        for (fragment, (&turns, &levels)) in turns.iter().zip(levels).enumerate() {
            let first = peaks;
            let most = 4 * (turns * levels) as usize;
            pairs.reserve(peaks + MOST_PEAKS * most);
            if ends.len() < texels as usize + most + 1 {
                ends.resize(texels as usize + most + 1, 0);
            }
            for level in 0..levels {
                let mut before = [(NO_TEXEL, NO_PLACE); 4];
                for turn in 0..turns {
                    let patch = each!(row in patches.rows(slot(turn, level)) => &row[fragment]);
                    let now = each!(cell in patch => {
                        let texel = cell.get() as u32;
                        let same = |place, &(read, at): &(u32, u32)| if read == texel { at } else { place };
                        let shared = before.iter().fold(NO_PLACE, same);
                        let is_new = shared == NO_PLACE;
                        let [begin, end] = each!(i in [0, 1] => begins[texel as usize + i]);
                        // Written in any case and kept if new: branches on whether a texel is shared, and on its number of peaks, cannot be
                        // predicted.
                        run(&mut pairs.peaks[peaks..]).iter_mut().zip(begin as i32..).for_each(|(at, peak)| *at = peak);
                        let place = if is_new { texels } else { shared };
                        peaks += if is_new { end - begin } else { 0 } as usize;
                        ends[texels as usize] = peaks as u32;
                        texels += u32::from(is_new);
                        cell.set(place as i32);
                        (texel, place)
                    });
                    before = now;
                }
            }
            pairs.fragments[first..peaks].fill(fragment as i32);
        }
        pairs.end(peaks);
        sums.resize(texels as usize, 0);
    }

    /// Makes the colour that each fragment returns of a light by the peaks that were read.
    pub fn shine(&mut self, light: &LightOnPeaks<'_>, shader: Shader<'_>, shown: &mut Batch<ShadedColour<i32>>) {
        let &LightOnPeaks { map, places, halves, slopes, colour } = light;
        let Self { numbers, patches, pairs, ends, lights, sums, .. } = self;
        shader.run(&PeakLights { pairs, halves, slopes, map }, lights);
        let (lights, mut begin) = (lights.row_of(|light| light.0), 0);
        for (sum, &end) in sums.iter_mut().zip(&*ends) {
            let lights = &lights[begin..end as usize];
            let none = PeakSum::<i32> { light: Fx::zero(), saturated: false };
            *sum = lights.iter().fold(none, |sum, &light| datapath::peak_sum(&sum, Fx::from_raw(light))).light.raw();
            begin = end as usize;
        }
        let patches = Patches::from_words(patches);
        let map = &map.map;
        shader.run(&PeakMeans { places, map, numbers, patches: &patches, sums, colour }, shown);
    }
}
