//! Fragments in real numbers, and seeded random ones.

use fixed::types::{I2F30, I4F28};
use glam::{DVec3, dvec3};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, offset};

use roughxel_scene::random::SplitMix64;

/// One fragment in real numbers, the form the generators think in; the fields are those of [`ReflectionIn`].
#[derive(Clone, Copy, Debug)]
pub struct RealFragment {
    /// n.
    pub normal: DVec3,
    /// v.
    pub view: DVec3,
    /// h, or p_u and p_v.
    pub tangents: [DVec3; 2],
    /// b₁, b₂.
    pub offset: [f64; 2],
    /// d₁, d₂, d₃.
    pub roughness: [f64; 3],
    /// ∂v/∂x, ∂v/∂y.
    pub dview: [DVec3; 2],
    /// ∂n/∂x, ∂n/∂y.
    pub dnormal: [DVec3; 2],
    /// Edge of a face, texels.
    pub edge: u16,
}

impl RealFragment {
    /// A mirror on the floor seen at 45°, a pixel of 1/500 rad.
    pub const PLAIN: Self = Self {
        normal: DVec3::Y,
        view: dvec3(0.0, 1.0, 1.0),
        tangents: [DVec3::NEG_Z, DVec3::X],
        offset: [0.0; 2],
        roughness: [0.0; 3],
        dview: [dvec3(-0.002, 0.0, 0.0), dvec3(0.0, 0.0014, -0.0014)],
        dnormal: [DVec3::ZERO; 2],
        edge: 256,
    };

    /// The ports of a profile.
    pub fn quantised(&self, p: &Precision) -> ReflectionIn {
        ReflectionIn {
            surface: SurfaceIn {
                normal: block_vector(self.normal, p),
                view: block_vector(self.view, p),
                frame_vectors: self.tangents.map(|t| block_vector(t, p)),
                offset: self.offset.map(|b| offset(b, p)),
                roughness: self.roughness.map(|d| offset(d, p)),
            },
            dview: self.dview.map(|d| block_vector(d, p)),
            dnormal: self.dnormal.map(|d| block_vector(d, p)),
            edge_texels: self.edge,
        }
    }
}

/// A vector of any direction, from a tenth to 1 long.
pub fn direction(random: &mut SplitMix64) -> DVec3 {
    loop {
        let v = dvec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
        let square = v.length_squared();
        if (0.01..=1.0).contains(&square) {
            return v;
        }
    }
}

/// Fragment `index` of the random set `set`: nine in ten are plausible fragments (any attitude, footprints from a
/// fifth of a texel to a face, offsets to 0.6, roughness to 0.4), one in ten has random bits at corner
/// exponents. Depends on the name and the index only.
pub fn random_fragment(set: &str, index: u64, p: &Precision) -> ReflectionIn {
    let mut random = SplitMix64::for_element(set, index);
    if random.below(10) == 0 { random_bits(&mut random, p) } else { plausible(&mut random, p) }
}

fn plausible(random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let mut scale = |low: f64, high: f64| random.uniform(low, high).exp2();
    let (pixel, bend, rough) = (scale(-12.0, -4.0), scale(-14.0, -5.0), scale(-8.0, -1.3));
    let (far, size) = (scale(-6.0, 6.0), scale(-3.0, 3.0));
    let normal = direction(random) * size;
    let view = direction(random) * far;
    let mut small = |length: f64| direction(random) * length;
    let dview = [small(pixel * view.length()), small(pixel * view.length())];
    let dnormal = [small(bend * size), small(bend * size)];
    let tangents = [small(1.0), small(1.0)];
    let mut within = |bound: f64| random.uniform(-bound, bound);
    let roughness = [within(rough).abs(), within(rough), within(rough).abs()];
    let offset = [within(0.6), within(0.6)];
    RealFragment { normal, view, tangents, offset, roughness, dview, dnormal, edge: 1 << (4 + random.below(8)) }
        .quantised(p)
}

fn random_bits(random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    // Bit patterns with weight on the corners: all ones, single bits, runs, zero.
    let mut word = |bits: u32, drop: u32| -> i32 {
        let value = match random.below(8) {
            0 => 0,
            1 => 1 << random.below(u64::from(bits - 1)),
            2 => -(1 << random.below(u64::from(bits - 1))),
            3 => (1 << random.below(u64::from(bits - 1))) - 1,
            4 => i64::MIN >> (64 - bits),
            _ => random.next_u64() as i64 >> (64 - bits),
        };
        (value << drop).clamp(i64::from(i32::MIN), i64::from(i32::MAX) >> drop << drop) as i32
    };
    let drop = 30 - p.fraction_bits;
    let mut vectors = [[0_i32; 3]; 8];
    for component in vectors.iter_mut().flatten() {
        // |mantissa| < 1: entry shifts left only, so the reference sees what the datapath keeps.
        *component = word(p.fraction_bits + 1, drop);
    }
    let offsets: [i32; 5] = core::array::from_fn(|_| word(p.offset_bits() + 4, 28 - p.offset_bits()));
    let mut exponent = || -> i16 {
        match random.below(6) {
            0 => 0,
            1 => random.uniform(-60.0, 60.0) as i16,
            _ => random.uniform(-12.0, 4.0) as i16,
        }
    };
    let [n, v, t0, t1, vx, vy, nx, ny] =
        vectors.map(|mantissa| BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent: exponent() });
    let [b1, b2, d1, d2, d3] = offsets.map(I4F28::from_bits);
    let d1 = d1.saturating_abs();
    let d3 = d3.saturating_abs();
    let keep = |d: I4F28| I4F28::from_bits(d.to_bits() >> (28 - p.offset_bits()) << (28 - p.offset_bits()));
    ReflectionIn {
        surface: SurfaceIn {
            normal: n,
            view: v,
            frame_vectors: [t0, t1],
            offset: [b1, b2],
            roughness: [keep(d1), d2, keep(d3)],
        },
        dview: [vx, vy],
        dnormal: [nx, ny],
        edge_texels: 1 << random.below(15),
    }
}

/// One last bit of a mantissa port.
pub(super) fn bit(p: &Precision) -> i32 {
    1 << (30 - p.fraction_bits)
}
