//! Peaks side by side: the light of many peaks for one half vector.

use roughxel_core::bundle::Bundle;
use roughxel_core::datapath;
use roughxel_core::each::{each, places};
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::signals::{LIGHT, LocalDirection, Peak, SHARE};
use roughxel_core::word::{Wire, Word};

use super::batch::Spread;
use super::{LANES, Lanes, Target};

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

/// The peak in these words.
#[inline(always)]
fn unpack<W: Word>([xy, z_amplitude, exponent]: [W; WORDS]) -> Peak<W> {
    let normal = each!(number in [xy.shl(16), xy, z_amplitude.shl(16)] => Fx::from_raw(number.sar(16)));
    let amplitude = Fx::from_raw(z_amplitude.sar(16).and(W::lit(0xffff)));
    Peak { normal, amplitude, exponent: Fx::from_raw(exponent) }
}

/// A list of peaks, word by word, so that lanes load a word of sixteen peaks at once.
#[derive(Clone, Debug, Default)]
pub struct PeakList {
    /// Of one length: that of the list, rounded up to a group of lanes at least.
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
    pub fn weigh(&mut self, weights: impl Iterator<Item = Fx<i32, SHARE>>) {
        self.weights.clear();
        self.weights.extend(weights.map(Fx::raw));
        self.weights.resize(self.room(), 0);
    }

    /// All peaks with their weights, in their order.
    pub(super) fn iter(&self) -> impl Iterator<Item = (Peak<i32>, Fx<i32, SHARE>)> {
        (0..self.len).map(|index| {
            let peak = unpack(each!(word in places() => self.words[word][index]));
            (peak, Fx::from_raw(self.weights.get(index).copied().unwrap_or(WHOLE)))
        })
    }

    fn room(&self) -> usize {
        self.len.next_multiple_of(LANES)
    }
}

/// The weight of a peak of which nothing is hidden.
const WHOLE: i32 = 1 << SHARE;

/// Adds the light of every peak to `lights`, in their order.
pub(super) fn lights<T: Target>(
    half: &LocalDirection<i32>,
    peaks: &PeakList,
    p: &Precision,
    lights: &mut Vec<Fx<i32, LIGHT>>,
) {
    let before = lights.len();
    lights.resize(before + peaks.room(), Fx::zero());
    let (rows, _) = lights[before..].as_chunks_mut::<LANES>();
    T::run(
        #[inline(always)]
        || {
            let proof = T::proof();
            let half = half.rewire(&mut Spread::<T>(proof));
            // What lies behind the last peak is cut off below.
            for (group, row) in rows.iter_mut().enumerate() {
                let load = |word: &[i32]| Lanes(proof.words(word.as_chunks().0[group]), proof);
                let peak = unpack(each!(word in places() => load(&peaks.words[word])));
                let weight = if peaks.weights.is_empty() { Wire::lit(WHOLE.into()) } else { load(&peaks.weights) };
                *row = each!(light in datapath::peak(&half, &peak, Fx::from_raw(weight), p).raw().lanes() => Fx::from_raw(light));
            }
        },
    );
    lights.truncate(before + peaks.len);
}
