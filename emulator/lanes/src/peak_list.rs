//! Peaks side by side: the light of many peaks for one half vector.

use roughxel_core::datapath;
use roughxel_core::each::{each, places};
use roughxel_core::fx::{Control, Fx, Int};
use roughxel_core::ports::{LIGHT, Peak, SHARE};
use roughxel_core::precision::Precision;
use roughxel_core::signals::LocalDirection;
use roughxel_core::word::Wire;

use super::batch::{Side, spread};
use super::target::Target;
use super::vectors::Vectors;
use super::{LANES, Lanes, NARROW_LANES};

/// Words of a [`PackedPeak`].
const WORDS: usize = 3;

/// A peak as a memory holds it: its five numbers of 16 bits in three words.
#[derive(Clone, Copy, Debug)]
pub struct PackedPeak([i32; WORDS]);

impl From<&Peak<i32>> for PackedPeak {
    /// Range: what [`StoredPeak`](roughxel_core::ports::StoredPeak) holds.
    fn from(peak: &Peak<i32>) -> Self {
        let pair = |low: i32, high: i32| low & 0xffff | high << 16;
        let [x, y, z] = peak.normal.map(Fx::raw);
        Self([pair(x, y), pair(z, peak.amplitude.raw()), peak.exponent.raw()])
    }
}

impl PackedPeak {
    /// Its words.
    pub fn words(&self) -> [Int<i32>; WORDS] {
        self.0.map(Fx::from_raw)
    }
}

/// A list of peaks, word by word, so that lanes load a word of as many peaks as they are at once.
#[derive(Clone, Debug, Default)]
pub struct PeakList {
    /// Of one length: that of the list, rounded up to the larger group of lanes at least.
    words: [Vec<i32>; WORDS],
    /// As many words, or none: every peak counts whole.
    weights: Vec<i32>,
    len: usize,
}

impl PeakList {
    /// Peaks in the list.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// These of a map's peaks, in this order, in place of all before; every one counts whole. The memory is kept.
    ///
    /// # Panics
    /// If an index is not below the number of the map's peaks.
    pub fn gather(&mut self, map: &[PackedPeak], indices: &[u32]) {
        self.len = indices.len();
        let room = self.room();
        if self.words[0].len() < room {
            self.words.iter_mut().for_each(|word| word.resize(room, 0));
        }
        self.weights.clear();
        let [xy, z_amplitude, exponent] = self.words.each_mut().map(|word| &mut word[..indices.len()]);
        for (place, &index) in indices.iter().enumerate() {
            [xy[place], z_amplitude[place], exponent[place]] = map[index as usize].0;
        }
    }

    /// What of each peak counts, its share or its visibility in [0, 1]; in the order of the peaks.
    pub fn weigh(&mut self, weights: impl Iterator<Item = Control<i32, SHARE>>) {
        self.weights.clear();
        self.weights.extend(weights.map(Fx::raw));
        self.weights.resize(self.room(), 0);
    }

    /// All peaks with their weights, in their order.
    pub(super) fn iter(&self) -> impl Iterator<Item = ([Int<i32>; WORDS], Control<i32, SHARE>)> {
        (0..self.len).map(|index| {
            let words = each!(word in places() => Fx::from_raw(self.words[word][index]));
            (words, Fx::from_raw(self.weights.get(index).copied().unwrap_or(WHOLE)))
        })
    }

    fn room(&self) -> usize {
        self.len.next_multiple_of(NARROW_LANES)
    }
}

/// The weight of a peak of which nothing is hidden.
const WHOLE: i32 = 1 << (32 - SHARE);

/// Adds the light of every peak to `lights`, in their order.
pub(super) fn lights<W: Side<PARTS>, const PARTS: usize>(
    half: &LocalDirection<i32>,
    peaks: &PeakList,
    p: &Precision,
    lights: &mut Vec<Control<i32, LIGHT>>,
) {
    let before = lights.len();
    lights.resize(before + peaks.len.next_multiple_of(PARTS * LANES), Fx::zero());
    let (rows, _) = lights[before..].as_chunks_mut::<LANES>();
    let (groups, _) = rows.as_chunks_mut::<PARTS>();
    W::Set::run(
        #[inline(always)]
        || {
            let proof = W::Set::proof();
            let half = spread::<W, _, _>(half);
            // What lies behind the last peak is cut off below.
            for (group, rows) in groups.iter_mut().enumerate() {
                let load = |word: &[i32]| {
                    let parts: &[[i32; LANES]; PARTS] = &word.as_chunks().0.as_chunks().0[group];
                    W::of_counts(each!(part in *parts => Lanes(proof.words(part), proof)))
                };
                let words = each!(word in places() => Fx::from_raw(load(&peaks.words[word])));
                let weight = if peaks.weights.is_empty() { Wire::lit(WHOLE.into()) } else { load(&peaks.weights) };
                let light = datapath::packed_peak::<W>(&half, words, Fx::from_raw(weight), p);
                *rows = each!(part in W::counts(light.raw()) => each!(light in part.lanes() => Fx::from_raw(light)));
            }
        },
    );
    lights.truncate(before + peaks.len);
}
