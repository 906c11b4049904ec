//! Ports at their limits: exponents to the ends of 16 bits and far from each other, mantissas with few bits or none, the most negative words, faces
//! of any edge. No picture has them. They show a device that saturates, aligns or treats zero differently.

use fixed::types::{I1F15, I2F30, I4F12, I4F28, I16F16};
use roughxel_core::ports::{BlockVector, HighlightIn, PeakIn, ReflectionIn, StoredHorizon, StoredPeak, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::shininess;
use roughxel_utilities::exp2::exp2;
use roughxel_utilities::random::SplitMix64;

/// Generator of the ports of one case.
struct Limits<'a> {
    random: SplitMix64,
    p: &'a Precision,
    /// Centre of most exponents of a case.
    around: i64,
}

impl<'a> Limits<'a> {
    fn new(set: &str, index: u64, p: &'a Precision) -> Self {
        let mut random = SplitMix64::for_element(set, index);
        let around = match random.below(8) {
            0 => i64::from(i16::MIN),
            1 => i64::from(i16::MAX),
            2 => random.below(1 << 16) as i64 - (1 << 15),
            _ => 0,
        };
        Self { random, p, around }
    }

    /// Signed word whose lowest `drop` bits are zero.
    fn word(&mut self, bits: u32, drop: u32) -> i32 {
        let any = self.random.next_u64() as i64 >> (64 - bits);
        let one = 1_i64 << self.random.below(u64::from(bits - 1));
        let value = match self.random.below(8) {
            0 | 1 => 0,
            2 => one,
            3 => -one,
            4 => one - 1,
            5 => -1 << (bits - 1),
            6 => (1 << (bits - 1)) - 1,
            _ => any,
        };
        (value << drop) as i32
    }

    /// A vector: zero, some bits, or any.
    fn vector(&mut self) -> BlockVector {
        let (bits, drop) = (self.p.fraction_bits + 2, 30 - self.p.fraction_bits);
        let mut mantissa = [0; 3];
        match self.random.below(6) {
            0 => {}
            1 => mantissa[self.random.below(3) as usize] = self.word(bits, drop),
            2 => {
                let small = self.random.below(u64::from(bits)) as u32;
                mantissa = [(); 3].map(|()| self.word(bits, drop) >> small >> drop << drop);
            }
            3 => mantissa = [(); 3].map(|()| (self.random.next_u64() as i32) >> drop << drop),
            _ => mantissa = [(); 3].map(|()| self.word(bits, drop)),
        }
        let apart = match self.random.below(4) {
            0 => 0,
            1 => self.random.below(141) as i64 - 70,
            2 => self.random.below(13) as i64 - 6,
            _ => self.random.below(1 << 17) as i64 - (1 << 16),
        };
        let exponent = (self.around + apart).clamp(i16::MIN.into(), i16::MAX.into()) as i16;
        BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent }
    }

    fn surface(&mut self) -> SurfaceIn {
        let (bits, drop) = (self.p.offset_bits() + 4, 28 - self.p.offset_bits());
        let [normal, view, first, second] = [(); 4].map(|()| self.vector());
        SurfaceIn {
            normal,
            view,
            frame_vectors: [first, second],
            offset: [(); 2].map(|()| I4F28::from_bits(self.word(bits, drop))),
            roughness: [(); 3].map(|()| I4F28::from_bits(self.word(bits, drop))),
        }
    }

    fn fragment(mut self) -> ReflectionIn {
        let surface = self.surface();
        let (dview, dnormal) = ([(); 2].map(|()| self.vector()), [(); 2].map(|()| self.vector()));
        let edge_texels = match self.random.below(4) {
            0 => 1 << self.random.below(16),
            1 => ((1_u32 << (1 + self.random.below(16))) - 1) as u16,
            _ => self.random.next_u64() as u16 >> self.random.below(16),
        };
        ReflectionIn { surface, dview, dnormal, edge_texels }
    }

    fn light(mut self) -> HighlightIn {
        let (surface, light) = (self.surface(), self.vector());
        let exponent = [1.0, 2.0, 91.0, 8192.0, exp2(self.random.uniform(0.0, 13.0))][self.random.below(5) as usize];
        HighlightIn { surface, light, shininess: shininess(exponent) }
    }

    fn lit_peak(mut self) -> PeakIn {
        let (surface, light) = (self.surface(), self.vector());
        let mut code =
            || -> i16 { [0, 1, -1, i16::MIN, i16::MAX, self.random.next_u64() as i16][self.random.below(6) as usize] };
        let normal = [(); 3].map(|()| I1F15::from_bits(code()));
        let [amplitude, exponent] = [(); 2].map(|()| code().cast_unsigned());
        let low = [(); 4].map(|()| I4F12::from_bits(code()));
        let inverse_width = [(); 4].map(|()| code().cast_unsigned());
        let weight = I16F16::from_bits(match self.random.below(3) {
            0 => 1 << 16,
            1 => self.random.below(1 << 16) as i32,
            _ => self.random.next_u64() as i32,
        });
        PeakIn {
            surface: SurfaceIn { offset: Default::default(), roughness: Default::default(), ..surface },
            light,
            peak: StoredPeak { normal, amplitude, exponent },
            horizon: StoredHorizon { low, inverse_width },
            weight,
        }
    }
}

/// Fragments at the limits of their ports.
pub fn fragment_limits(p: &Precision) -> Vec<ReflectionIn> {
    (0..1024).map(|index| Limits::new("fragment_limits", index, p).fragment()).collect()
}

/// Lights on surfaces at the limits of their ports.
pub fn highlight_limits(p: &Precision) -> Vec<HighlightIn> {
    (0..512).map(|index| Limits::new("highlight_limits", index, p).light()).collect()
}

/// Lights on peaks at the limits of their ports.
pub fn peak_limits(p: &Precision) -> Vec<PeakIn> {
    (0..512).map(|index| Limits::new("peak_limits", index, p).lit_peak()).collect()
}
