//! Fragments in real numbers, and seeded random ones.

use std::ops::Range;

use glam::{DVec3, dvec3};
use roughxel_core::bundle::Bundle;
use roughxel_core::each::each;
use roughxel_core::ports::{Port, ReflectionIn, ReflectionInput, SurfaceIn, SurfaceInput};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, offset};

use super::draws::{Elements, Kind, Rows, at, length, scaled};
use roughxel_lanes::Columns;
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

/// Fragment `index` of the random set `set`: nine in ten are plausible fragments (any attitude, footprints from a
/// fifth of a texel to a face, offsets to 0.6, roughness to 0.4), one in ten has random bits at corner
/// exponents. Depends on the name and the index only.
pub fn random_fragment(set: &str, index: u64, p: &Precision) -> ReflectionIn {
    ReflectionIn::of(&Fragments::one(set, index, p))
}

/// The ports of those fragments of the random set `set`, as [`random_fragment`] makes them, in place of what `columns` held.
pub fn random_fragments(set: &str, indices: Range<u64>, p: &Precision, columns: &mut Columns<ReflectionInput<i32>>) {
    Fragments::many(set, indices, p, columns);
}

/// Words of a surface.
pub(super) const SURFACE: usize = <SurfaceInput<i32> as Bundle<i32>>::WORDS;
/// Words of a fragment.
pub(super) const FRAGMENT: usize = <ReflectionInput<i32> as Bundle<i32>>::WORDS;

/// The kind of [`random_fragment`].
pub(super) enum Fragments {}

impl Fragments {
    /// Words of elements of either kind.
    #[inline(always)]
    pub(super) fn any<const N: usize>(elements: Elements<N>, p: &Precision) -> [[i32; N]; FRAGMENT] {
        let are_odd = Self::are_odd(elements);
        let [mut words, mut odd] = [[[0; N]; FRAGMENT]; 2];
        Self::plausible(elements, p, &mut words);
        Self::odd(elements, p, &mut odd);
        for (row, odd) in words.iter_mut().zip(&odd) {
            for lane in 0..N {
                row[lane] = if are_odd[lane] { odd[lane] } else { row[lane] };
            }
        }
        words
    }
}

impl Kind<FRAGMENT> for Fragments {
    type Ports = ReflectionInput<i32>;

    #[inline(always)]
    fn plausible<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; FRAGMENT]) {
        let draws = &mut elements.draws();
        draws.skip();
        let [pixel, bend, rough] =
            each!((low, high) in [(-12.0, -4.0), (-14.0, -5.0), (-8.0, -1.3)] => draws.powers(low, high));
        let [far, size] = each!(bound in [6.0, 3.0] => draws.powers(-bound, bound));
        let [normal, view, dview_x, dview_y, dnormal_x, dnormal_y, tangent_u, tangent_v] = draws.directions::<8, 24>();
        let (normal, view) = (scaled(&normal, &size), scaled(&view, &far));
        let (mut shift, mut turn) = ([0.0; N], [0.0; N]);
        for lane in 0..N {
            shift[lane] = pixel[lane] * length(at(&view, lane));
            turn[lane] = bend[lane] * size[lane];
        }
        let roughness = each!(() in [(); 3] => draws.within(&rough));
        let offsets = each!(() in [(); 2] => draws.uniform(-0.6, 0.6));
        let edges = draws.each(|random| 1 << (4 + random.below(8)));
        let mut words = Rows::new(words);
        for vectors in [normal, view, tangent_u, tangent_v] {
            words.put_vectors(&vectors, p);
        }
        put_bumps(&mut words, &offsets, &roughness, p);
        for vectors in
            [scaled(&dview_x, &shift), scaled(&dview_y, &shift), scaled(&dnormal_x, &turn), scaled(&dnormal_y, &turn)]
        {
            words.put_vectors(&vectors, p);
        }
        words.put_row(&edges);
    }

    #[inline(always)]
    fn odd<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; FRAGMENT]) {
        let draws = &mut elements.draws();
        draws.skip();
        // |mantissa| < 1: entry shifts left only, so the reference sees what the datapath keeps.
        let (bits, drop) = (p.fraction_bits + 1, 30 - p.fraction_bits);
        let mantissas = each!(() in [(); 24] => draws.each(#[inline(always)] |random| odd_word(random, bits, drop)));
        let (bits, drop) = (p.offset_bits() + 4, 28 - p.offset_bits());
        let offsets = each!(() in [(); 5] => draws.each(#[inline(always)] |random| odd_word(random, bits, drop)));
        let exponents = each!(() in [(); 8] => draws.each(odd_exponent));
        let edges = draws.each(|random| 1 << random.below(15));
        let [b1, b2, d1, d2, d3] = offsets;
        let [d1, d3] = each!(row in [d1, d3] => each!(d in row => d.saturating_abs() >> drop << drop));
        let mut words = Rows::new(words);
        let put = |words: &mut Rows<'_, N>, vectors: Range<usize>| {
            for (mantissa, exponent) in mantissas.as_chunks::<3>().0[vectors.clone()].iter().zip(&exponents[vectors]) {
                for row in mantissa.iter().chain([exponent]) {
                    words.put_row(row);
                }
            }
        };
        put(&mut words, 0..4);
        words.put(
            #[inline(always)]
            |lane| [b1[lane], b2[lane], d1[lane], d2[lane], d3[lane]],
        );
        put(&mut words, 4..8);
        words.put_row(&edges);
    }
}

/// Offsets, then roughnesses of which the first and the last are not negative.
#[inline(always)]
pub(super) fn put_bumps<const N: usize>(
    words: &mut Rows<'_, N>,
    offsets: &[[f64; N]; 2],
    roughness: &[[f64; N]; 3],
    p: &Precision,
) {
    let [d1, d2, d3] = roughness;
    for numbers in [&offsets[0], &offsets[1], &each!(d in *d1 => d.abs()), d2, &each!(d in *d3 => d.abs())] {
        words.put_offsets(numbers, p);
    }
}

/// A word of `bits` bits above `drop` zeros, with weight on the corners: all ones, single bits, runs, zero.
#[inline(always)]
fn odd_word(random: &mut SplitMix64, bits: u32, drop: u32) -> i32 {
    let kind = random.below(8);
    let any = random.clone().next_u64() as i64 >> (64 - bits);
    let one = 1 << random.clone().below(u64::from(bits - 1));
    let lowest = i64::MIN >> (64 - bits);
    let is_drawn = (kind != 0) & (kind != 4);
    let mut value = any;
    for (of, corner) in [0, one, -one, one - 1, lowest].into_iter().enumerate() {
        value = if kind == of as u64 { corner } else { value };
    }
    *random = random.clone().after(is_drawn.into());
    (value << drop).clamp(i64::from(i32::MIN), i64::from(i32::MAX) >> drop << drop) as i32
}

/// An exponent with weight on 0, some far from it.
#[inline(always)]
fn odd_exponent(random: &mut SplitMix64) -> i32 {
    let kind = random.below(6);
    let behind = random.clone().after((kind != 0).into());
    let (far, near) = (random.clone().uniform(-60.0, 60.0), random.clone().uniform(-12.0, 4.0));
    *random = behind;
    let exponent = if kind == 1 { far } else { near };
    if kind == 0 { 0 } else { exponent as i32 }
}

/// One last bit of a mantissa port.
pub(super) fn bit(p: &Precision) -> i32 {
    1 << (30 - p.fraction_bits)
}
