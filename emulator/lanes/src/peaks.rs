//! Peaks side by side: the light of many peaks for one half vector.

use roughxel_core::bundle::{Bundle, Rewire, bundle};
use roughxel_core::datapath;
use roughxel_core::each::each;
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::signals::{LIGHT, LocalDirection, Peak, SHARE};
use roughxel_core::word::{Wire, Word};

use super::{FlagLanes, LANES, Lanes, Target, WideLanes};

/// A peak and how much of it counts.
#[derive(Clone, Copy, Debug)]
pub struct WeightedPeak<W: Word> {
    /// The peak as it is stored.
    pub peak: Peak<W>,
    /// Its weight or its visibility, [0, 1].
    pub weight: Fx<W, SHARE>,
}

bundle!(WeightedPeak { peak, weight });

/// Words of a [`WeightedPeak`].
const WORDS: usize = 6;

/// Adds the light of every peak to `lights`, in their order.
pub(super) fn lights<T: Target>(
    half: &LocalDirection<i32>,
    peaks: &[WeightedPeak<i32>],
    p: &Precision,
    lights: &mut Vec<Fx<i32, LIGHT>>,
) {
    for group in peaks.chunks(LANES) {
        // Lanes without a peak have one of amplitude 0.
        let mut words = [[0; LANES]; WORDS];
        for (lane, WeightedPeak { peak, weight }) in group.iter().enumerate() {
            let [x, y, z] = peak.normal.map(Fx::raw);
            let wires = [x, y, z, peak.amplitude.raw(), peak.exponent.raw(), weight.raw()];
            words.iter_mut().zip(wires).for_each(|(word, wire)| word[lane] = wire);
        }
        let row = T::run(
            #[inline(always)]
            || {
                let proof = T::proof();
                let [x, y, z, amplitude, exponent, weight] = each!(word in words => Lanes(proof.words(word), proof));
                let normal = each!(lanes in [x, y, z] => Fx::from_raw(lanes));
                let peak = Peak { normal, amplitude: Fx::from_raw(amplitude), exponent: Fx::from_raw(exponent) };
                let half = half.rewire(&mut Spread::<T>(proof));
                datapath::peak(&half, &peak, Fx::from_raw(weight), p).raw().lanes()
            },
        );
        lights.extend(row[..group.len()].iter().map(|&light| Fx::from_raw(light)));
    }
}

/// The same wire in every lane.
struct Spread<T>(T);

impl<T: Target> Rewire<i32, Lanes<T>> for Spread<T> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> Lanes<T> {
        Lanes(self.0.words([wire; LANES]), self.0)
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> WideLanes<T> {
        WideLanes(self.0.wides([wire; LANES]), self.0)
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> FlagLanes<T> {
        Lanes::lit(0).lt(Lanes(self.0.words([i32::from(wire); LANES]), self.0))
    }
}
