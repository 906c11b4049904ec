//! Fragments in real numbers, and seeded random ones.

use std::ops::Range;

use fixed::types::I2F30;
use glam::{DVec3, dvec3};
use roughxel_core::bundle::Bundle;
use roughxel_core::each::each;
use roughxel_core::ports::{BlockVector, Port, ReflectionIn, ReflectionInput, SurfaceIn, SurfaceInput};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, offset};

use super::draws::{Draws, Elements, Kind, Rows};
use roughxel_shader::Batch;

/// One fragment in real numbers, as the generators use it; the fields are those of [`ReflectionIn`].
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

    /// Ports of a profile.
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

/// Fragment `index` of the random set `set`. Nine in ten are plausible: any attitude, footprints from a fifth of a texel to a face, offsets and
/// roughness to ½. One in ten has random bits at corner exponents. It depends on the name and the index only, and is drawn in integers;
/// vectors/FORMAT.md says how.
pub fn random_fragment(set: &str, index: u64, p: &Precision) -> ReflectionIn {
    ReflectionIn::from_wires(&Fragments::one(set, index, p))
}

/// Ports of these fragments of the random set `set`, as [`random_fragment`] makes them, in place of the contents of `batch`.
pub fn random_fragments(set: &str, indices: Range<u64>, p: &Precision, batch: &mut Batch<ReflectionInput<i32>>) {
    Fragments::many(set, indices, p, batch);
}

/// Word count of a surface.
pub(super) const SURFACE: usize = <SurfaceInput<i32> as Bundle<i32>>::WORDS;
/// Word count of a fragment.
pub(super) const FRAGMENT: usize = <ReflectionInput<i32> as Bundle<i32>>::WORDS;

/// Kind of [`random_fragment`].
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
        let [normal, view, pixel, bend] = draws.below([7, 13, 9, 10]);
        let [rough, edge, ..] = draws.below([8, 8, 1, 1]);
        let drop = 30 - p.fraction_bits;
        let mantissas = each!(() in [(); 12] => {
            each!(words in draws.words() => each!(word in words => word >> (drop + 1) << drop))
        });
        let bumps = each!(() in [(); 3] => draws.words());
        let mut exponents = [[0; N]; 8];
        for lane in 0..N {
            let [normal, view] = [normal[lane] - 3, view[lane] - 6];
            let [shift, turn] = [view + pixel[lane] - 12, normal + bend[lane] - 14];
            for (row, exponent) in exponents.iter_mut().zip([normal, view, 0, 0, shift, shift, turn, turn]) {
                row[lane] = exponent;
            }
        }
        let [[b1, b2], [d1, d2], [d3, _]] = bumps;
        let drop = 28 - p.offset_bits();
        put_fragment(
            &mut Rows::new(words),
            mantissas.as_flattened(),
            &exponents,
            #[inline(always)]
            |lane| {
                let least = 4 + rough[lane];
                let share = |d: i32| (d.cast_unsigned() >> (least + 1)).cast_signed();
                let bumps = [b1[lane] >> 4, b2[lane] >> 4, share(d1[lane]), d2[lane] >> least, share(d3[lane])];
                each!(bump in bumps => bump >> drop << drop)
            },
            &each!(edge in edge => 16 << edge),
        );
    }

    #[inline(always)]
    fn odd<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; FRAGMENT]) {
        let draws = &mut elements.draws();
        draws.skip();
        // |mantissa| < 1: `enter` shifts left only, so the reference sees all bits that the datapath keeps.
        let (bits, drop) = (p.fraction_bits + 1, 30 - p.fraction_bits);
        let mantissas =
            each!(() in [(); 24] => draws.each(#[inline(always)] |random| odd_word(random.next_u64(), bits, drop)));
        let (bits, drop) = (p.offset_bits() + 4, 28 - p.offset_bits());
        let bumps =
            each!(() in [(); 5] => draws.each(#[inline(always)] |random| odd_word(random.next_u64(), bits, drop)));
        let exponents = each!(() in [(); 8] => odd_exponents(draws));
        let [edges, ..] = draws.below([15, 1, 1, 1]);
        let [b1, b2, d1, d2, d3] = bumps;
        let share = |d: i32| d.saturating_abs() >> drop << drop;
        put_fragment(
            &mut Rows::new(words),
            &mantissas,
            &exponents,
            #[inline(always)]
            |lane| [b1[lane], b2[lane], share(d1[lane]), d2[lane], share(d3[lane])],
            &each!(edge in edges => 1 << edge),
        );
    }
}

/// Words of fragments: the surface's vectors, offsets and roughnesses, then the other vectors.
#[inline(always)]
fn put_fragment<const N: usize>(
    words: &mut Rows<'_, N>,
    mantissas: &[[i32; N]],
    exponents: &[[i32; N]; 8],
    bumps: impl Fn(usize) -> [i32; 5],
    edges: &[i32; N],
) {
    let vectors = mantissas.as_chunks::<3>().0;
    words.put_blocks(&vectors[..4], &exponents[..4]);
    words.put(bumps);
    words.put_blocks(&vectors[4..], &exponents[4..]);
    words.put_row(edges);
}

/// Word of `bits` bits above `drop` zeros, with weight on the corners: all ones, single bits, runs, zero.
#[inline(always)]
fn odd_word(number: u64, bits: u32, drop: u32) -> i32 {
    let (kind, spare) = ((number >> 61) as i32, 32 - bits);
    let any = number as i32 >> spare;
    let one = 1 << (((number >> 32 & 0xffff) as u32 * (bits - 1)) >> 16);
    let mut value = any;
    for (of, corner) in [0, one, -one, one - 1, i32::MIN >> spare].into_iter().enumerate() {
        value = if kind == of as i32 { corner } else { value };
    }
    value << drop
}

/// Exponents: one in six is 0, one is far from 0, the others are near.
#[inline(always)]
fn odd_exponents<const N: usize>(draws: &mut Draws<N>) -> [i32; N] {
    let [kinds, far, near, _] = draws.below([6, 119, 15, 1]);
    let mut exponents = [0; N];
    for lane in 0..N {
        let exponent = if kinds[lane] == 1 { far[lane] - 59 } else { near[lane] - 11 };
        exponents[lane] = if kinds[lane] == 0 { 0 } else { exponent };
    }
    exponents
}

/// One last bit of a mantissa port.
pub(super) fn bit(p: &Precision) -> i32 {
    1 << (30 - p.fraction_bits)
}

/// Vector with one component moved by `step` last bits.
pub(super) fn moved(vector: &BlockVector, component: usize, step: i32, p: &Precision) -> BlockVector {
    let mut vector = *vector;
    vector.mantissa[component] = I2F30::from_bits(vector.mantissa[component].to_bits() + step * bit(p));
    vector
}

/// Vector with each component moved by −1, 0, 1 last bits: itself is number 13 of 27.
pub(super) fn around(vector: &BlockVector, p: &Precision) -> impl Iterator<Item = BlockVector> {
    (0..27).map(move |code| {
        let steps = [code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1];
        (0..).zip(steps).fold(*vector, |vector, (component, step)| moved(&vector, component, step, p))
    })
}
