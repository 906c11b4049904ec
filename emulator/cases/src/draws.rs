//! Random vectors drawn in parallel: numbers of `N` elements in arrays, and the port words that they become, one row a word.
//!
//! Each element has a separate generator, so that it does not depend on its neighbours. Loops over the elements select values without branches, and
//! compile to vector instructions. A number of the generator is two words or four small integers, and nothing is drawn by rejection. The fewer
//! numbers an element takes and the more alike the elements are, the faster they are drawn.

use std::ops::Range;

use glam::{DVec3, dvec3};
use roughxel_core::bundle::{Bundle, End};
use roughxel_core::design::Form;
use roughxel_core::each::{each, places};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, offset};
use roughxel_netlist::integers::filled;
use roughxel_shader::Batch;
use roughxel_simd::{Backend, LANES};
use roughxel_utilities::random::SplitMix64;

/// Vectors of the elements, component by component.
pub(crate) type Vectors<const N: usize> = [[f64; N]; 3];

/// A selection of elements of a random set.
#[derive(Clone, Copy)]
pub(crate) struct Elements<const N: usize> {
    /// Hash of the name of the set.
    hash: u64,
    indices: [u64; N],
}

impl<const N: usize> Elements<N> {
    /// Generators of the elements.
    #[inline(always)]
    pub(crate) fn draws(&self) -> Draws<N> {
        let mut generators = [const { SplitMix64::new(0) }; N];
        for (generator, &index) in generators.iter_mut().zip(&self.indices) {
            *generator = SplitMix64::for_element_of(self.hash, index);
        }
        Draws(generators)
    }
}

/// One generator an element.
pub(crate) struct Draws<const N: usize>([SplitMix64; N]);

impl<const N: usize> Draws<N> {
    /// Values that `draw` returns, one an element.
    #[inline(always)]
    pub(crate) fn each<T: Copy + Default>(&mut self, draw: impl Fn(&mut SplitMix64) -> T) -> [T; N] {
        let mut drawn = [T::default(); N];
        for (drawn, random) in drawn.iter_mut().zip(&mut self.0) {
            *drawn = draw(random);
        }
        drawn
    }

    /// Skips the number that decides if an element is odd.
    #[inline(always)]
    pub(crate) fn skip(&mut self) {
        self.each(SplitMix64::next_u64);
    }

    /// Two words of each element, of any bits.
    #[inline(always)]
    pub(crate) fn words(&mut self) -> [[i32; N]; 2] {
        let numbers = self.each(SplitMix64::next_u64);
        each!(shift in [32, 0] => each!(number in numbers => (number >> shift) as i32))
    }

    /// Two uniform numbers in [−1, 1) of each element, each a word of 32 bits over 2^31.
    #[inline(always)]
    pub(crate) fn reals(&mut self) -> [[f64; N]; 2] {
        each!(words in self.words() => each!(word in words => f64::from(word) * (1.0 / (1_u64 << 31) as f64)))
    }

    /// Four uniform integers of each element, each from 0 to below its bound, which is at most 2^15.
    #[inline(always)]
    pub(crate) fn below(&mut self, bounds: [i32; 4]) -> [[i32; N]; 4] {
        let numbers = self.each(SplitMix64::next_u64);
        each!(i in [0, 1, 2, 3] => each!(number in numbers => {
            (((number >> (48 - 16 * i)) & 0xffff) as i32 * bounds[i]) >> 16
        }))
    }

    /// Two decisions for each element, independent of each other: one in ten is true.
    #[inline(always)]
    pub(crate) fn tenths(&mut self) -> [[bool; N]; 2] {
        let [first, _, _, last] = self.below([10, 1, 1, 10]);
        each!(drawn in [first, last] => each!(of_ten in drawn => of_ten == 0))
    }
}

/// Number in an octave, from 2^exponent to below twice that, by a number in [−1, 1). For exponents of normal numbers.
#[inline(always)]
pub(crate) fn in_octave(exponent: i32, real: f64) -> f64 {
    (1.5 + 0.5 * real) * octave(exponent)
}

/// 2^exponent, for exponents of normal numbers.
#[inline(always)]
pub(crate) fn octave(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// Vector of any direction, from a tenth to 1 long.
pub fn direction(random: &mut SplitMix64) -> DVec3 {
    loop {
        let point = dvec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
        if (0.01..=1.0).contains(&point.length_squared()) {
            return point;
        }
    }
}

/// Returns the vector of an element.
#[inline(always)]
pub(crate) fn at<const N: usize>([x, y, z]: &Vectors<N>, lane: usize) -> DVec3 {
    dvec3(x[lane], y[lane], z[lane])
}

/// Sets the vector of an element.
#[inline(always)]
pub(crate) fn set<const N: usize>([x, y, z]: &mut Vectors<N>, lane: usize, vector: DVec3) {
    [x[lane], y[lane], z[lane]] = vector.to_array();
}

/// Length of a vector, with a square root that vectorises.
#[inline(always)]
fn length(vector: DVec3) -> f64 {
    vector.length_squared().sqrt()
}

/// Vector scaled to length 1.
#[inline(always)]
pub(crate) fn unit(vector: DVec3) -> DVec3 {
    vector * (1.0 / length(vector))
}

/// Vector scaled to length 1, or `fallback` if it has no length.
#[inline(always)]
pub(crate) fn unit_or(vector: DVec3, fallback: DVec3) -> DVec3 {
    let inverse = 1.0 / length(vector);
    if inverse.is_finite() & (inverse > 0.0) { vector * inverse } else { fallback }
}

/// Rows of port words in the order of a walk, one column an element; the remaining ones are still to be written.
pub(crate) struct Rows<'a, const N: usize>(&'a mut [[i32; N]]);

impl<'a, const N: usize> Rows<'a, N> {
    /// Rows of all words of some ports.
    #[inline(always)]
    pub(crate) fn new<const WORDS: usize>(words: &'a mut [[i32; N]; WORDS]) -> Self {
        Self(words)
    }

    /// The next words.
    #[inline(always)]
    fn take<const COUNT: usize>(&mut self) -> &'a mut [[i32; N]; COUNT] {
        let rows = std::mem::take(&mut self.0).split_first_chunk_mut();
        let (words, rest) = rows.unwrap_or_else(|| unreachable!("ports have this many words"));
        self.0 = rest;
        words
    }

    /// Writes the words that `of` returns for each element.
    #[inline(always)]
    pub(crate) fn put<const COUNT: usize>(&mut self, of: impl Fn(usize) -> [i32; COUNT]) {
        let rows = self.take::<COUNT>();
        for lane in 0..N {
            for (row, word) in rows.iter_mut().zip(of(lane)) {
                row[lane] = word;
            }
        }
    }

    /// Writes one word of each element.
    #[inline(always)]
    pub(crate) fn put_row(&mut self, row: &[i32; N]) {
        *self.take::<1>() = [*row];
    }

    /// Writes vectors: three mantissas and an exponent each.
    #[inline(always)]
    pub(crate) fn put_blocks(&mut self, mantissas: &[[[i32; N]; 3]], exponents: &[[i32; N]]) {
        for (vector, exponent) in mantissas.iter().zip(exponents) {
            for row in vector.iter().chain([exponent]) {
                self.put_row(row);
            }
        }
    }

    /// Writes words that are 0.
    #[inline(always)]
    pub(crate) fn put_zeros<const COUNT: usize>(&mut self) {
        *self.take::<COUNT>() = [[0; N]; COUNT];
    }

    /// Writes vectors, quantised to a profile.
    #[inline(always)]
    pub(crate) fn put_vectors(&mut self, vectors: &Vectors<N>, p: &Precision) {
        self.put(
            #[inline(always)]
            |lane| {
                let block = block_vector(at(vectors, lane), p);
                let [x, y, z] = each!(mantissa in block.mantissa => mantissa.to_bits());
                [x, y, z, block.exponent.into()]
            },
        );
    }

    /// Writes offsets or roughnesses, quantised to a profile.
    #[inline(always)]
    pub(crate) fn put_offsets(&mut self, numbers: &[f64; N], p: &Precision) {
        self.put(
            #[inline(always)]
            |lane| [offset(numbers[lane], p).to_bits()],
        );
    }
}

/// Kind of the elements of random sets: `WORDS` words of ports, plausible ones or odd ones.
pub(crate) trait Kind<const WORDS: usize> {
    /// Ports of an element.
    type Ports: Form + Bundle<i32, In<i32> = Self::Ports>;

    /// Returns true for odd elements, by their first number.
    #[inline(always)]
    fn are_odd<const N: usize>(elements: Elements<N>) -> [bool; N] {
        elements.draws().tenths()[0]
    }
    /// Writes the words of plausible elements; words of odd ones are meaningless.
    fn plausible<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; WORDS]);
    /// Writes the words of odd elements; words of plausible ones are meaningless.
    fn odd<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; WORDS]);

    /// Element `index` of the set `set`.
    fn one(set: &str, index: u64, p: &Precision) -> Self::Ports {
        let (element, mut words) = (Elements { hash: SplitMix64::hash_of(set), indices: [index] }, [[0]; WORDS]);
        if Self::are_odd(element) == [true] {
            Self::odd(element, p, &mut words);
        } else {
            Self::plausible(element, p, &mut words);
        }
        filled(&Self::Ports::limit::<i32>(End::Low), &words.map(|[word]| word.into()))
    }

    /// Draws these elements of the set `set` into `batch`, in place of its contents.
    fn many(set: &str, indices: Range<u64>, p: &Precision, batch: &mut Batch<Self::Ports>) {
        let (hash, backend) = (SplitMix64::hash_of(set), Backend::best());
        let group = |first: u64| Elements { hash, indices: each!(lane in places() => first + lane as u64) };
        // Few elements are odd. They share groups, so that no odd lane waits for plausible ones.
        let mut odd = Vec::new();
        for first in indices.clone().step_by(LANES) {
            let are_odd = backend.run(
                #[inline(always)]
                || Self::are_odd::<LANES>(group(first)),
            );
            odd.extend((first..indices.end).zip(are_odd).filter(|&(_, is_odd)| is_odd).map(|(index, _)| index));
        }
        let mut odd_words = vec![[[0; LANES]; WORDS]; odd.len().div_ceil(LANES)];
        for (odd, words) in odd.chunks(LANES).zip(&mut odd_words) {
            let elements = Elements { hash, indices: each!(lane in places() => odd[lane.min(odd.len() - 1)]) };
            backend.run(
                #[inline(always)]
                || Self::odd::<LANES>(elements, p, words),
            );
        }
        let mut odd = odd.iter().enumerate().map(|(number, &index)| (index, number / LANES, number % LANES)).peekable();
        batch.clear();
        let mut words = [[0; LANES]; WORDS];
        for first in indices.clone().step_by(LANES) {
            backend.run(
                #[inline(always)]
                || Self::plausible::<LANES>(group(first), p, &mut words),
            );
            let behind = indices.end.min(first + LANES as u64);
            while let Some((index, group, lane)) = odd.next_if(|&(index, ..)| index < behind) {
                for (row, odd) in words.iter_mut().zip(&odd_words[group]) {
                    row[(index - first) as usize] = odd[lane];
                }
            }
            batch.append((behind - first) as usize, |to| to.words(&words));
        }
    }
}
