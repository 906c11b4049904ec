//! Random vectors side by side: numbers of `N` elements in arrays, and the ports that they become, a row a word.
//!
//! Each element has its own generator, so that it does not depend on those beside it; loops over the elements choose values, not ways, and become
//! vectors of the instruction set that they are compiled for.

use std::ops::Range;

use glam::{DVec3, dvec3};
use roughxel_core::bundle::{Bundle, End};
use roughxel_core::design::Form;
use roughxel_core::each::{each, places};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, offset};

use roughxel_lanes::{Columns, LANES, Reading};
use roughxel_net::record::filled;
use roughxel_scene::exp2::exp2;
use roughxel_scene::random::SplitMix64;

/// The components of a vector of each element.
pub(crate) type Vectors<const N: usize> = [[f64; N]; 3];

/// Which elements of a random set.
#[derive(Clone, Copy)]
pub(crate) struct Elements<const N: usize> {
    /// Of the name of the set.
    hash: u64,
    indices: [u64; N],
}

impl<const N: usize> Elements<N> {
    /// Their generators.
    #[inline(always)]
    pub(crate) fn draws(&self) -> Draws<N> {
        let mut generators = [const { SplitMix64::new(0) }; N];
        for (generator, &index) in generators.iter_mut().zip(&self.indices) {
            *generator = SplitMix64::for_element_of(self.hash, index);
        }
        Draws(generators)
    }
}

/// Generators side by side.
pub(crate) struct Draws<const N: usize>([SplitMix64; N]);

impl<const N: usize> Draws<N> {
    /// What `draw` draws for each element.
    #[inline(always)]
    pub(crate) fn each<T: Copy + Default>(&mut self, draw: impl Fn(&mut SplitMix64) -> T) -> [T; N] {
        let mut drawn = [T::default(); N];
        for (drawn, random) in drawn.iter_mut().zip(&mut self.0) {
            *drawn = draw(random);
        }
        drawn
    }

    /// Which elements are odd: one in ten.
    #[inline(always)]
    pub(crate) fn are_odd(&mut self) -> [bool; N] {
        self.each(|random| random.below(10) == 0)
    }

    /// Leaves out the number that says so.
    #[inline(always)]
    pub(crate) fn skip(&mut self) {
        self.each(SplitMix64::next_u64);
    }

    /// Uniform numbers in [low, high).
    #[inline(always)]
    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> [f64; N] {
        self.each(|random| random.uniform(low, high))
    }

    /// Powers of two with uniform exponents in [low, high).
    #[inline(always)]
    pub(crate) fn powers(&mut self, low: f64, high: f64) -> [f64; N] {
        let mut powers = self.uniform(low, high);
        for power in &mut powers {
            *power = exp2(*power);
        }
        powers
    }

    /// Uniform numbers up to a bound of each element, of either sign.
    #[inline(always)]
    pub(crate) fn within(&mut self, bounds: &[f64; N]) -> [f64; N] {
        let mut drawn = [0.0; N];
        for ((drawn, random), &bound) in drawn.iter_mut().zip(&mut self.0).zip(bounds) {
            *drawn = random.uniform(-bound, bound);
        }
        drawn
    }

    /// Vectors as of [`direction`], one after the other, of which `POINTS` points are tried side by side: half of all are in the sphere, so
    /// three for each vector leave few elements that need more.
    #[inline(always)]
    pub(crate) fn directions<const K: usize, const POINTS: usize>(&mut self) -> [Vectors<N>; K] {
        const { assert!(POINTS <= 32, "a bit a point") };
        let mut points = [[[0.0; N]; 3]; POINTS];
        let mut inside = [0_u32; N];
        let mut generators = self.0.clone();
        for (number, [x, y, z]) in points.iter_mut().enumerate() {
            for lane in 0..N {
                let point = point(&mut generators[lane]);
                [x[lane], y[lane], z[lane]] = point.to_array();
                inside[lane] |= u32::from(is_direction(point)) << number;
            }
        }
        let mut directions = [[[0.0; N]; 3]; K];
        for (lane, &inside) in inside.iter().enumerate() {
            let (mut left, found) = (inside, inside.count_ones() as usize);
            let mut behind = 0;
            for direction in directions.iter_mut().take(found) {
                let number = left.trailing_zeros() as usize;
                left &= left - 1;
                behind = number + 1;
                set(direction, lane, at(&points[number], lane));
            }
            let drawn = if found < K { POINTS } else { behind };
            self.0[lane] = self.0[lane].clone().after(3 * drawn as u64);
            for vector in directions.iter_mut().skip(found) {
                set(vector, lane, direction(&mut self.0[lane]));
            }
        }
        directions
    }
}

/// A point in the cube of edge 2.
#[inline(always)]
fn point(random: &mut SplitMix64) -> DVec3 {
    dvec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0))
}

/// Whether a point is one that [`direction`] takes.
#[inline(always)]
fn is_direction(point: DVec3) -> bool {
    (0.01..=1.0).contains(&point.length_squared())
}

/// A vector of any direction, from a tenth to 1 long.
pub fn direction(random: &mut SplitMix64) -> DVec3 {
    loop {
        let point = point(random);
        if is_direction(point) {
            return point;
        }
    }
}

/// The vector of an element.
#[inline(always)]
pub(crate) fn at<const N: usize>([x, y, z]: &Vectors<N>, lane: usize) -> DVec3 {
    dvec3(x[lane], y[lane], z[lane])
}

/// Sets the vector of an element.
#[inline(always)]
pub(crate) fn set<const N: usize>([x, y, z]: &mut Vectors<N>, lane: usize, vector: DVec3) {
    [x[lane], y[lane], z[lane]] = vector.to_array();
}

/// Vectors at the lengths of these numbers.
#[inline(always)]
pub(crate) fn scaled<const N: usize>(vectors: &Vectors<N>, by: &[f64; N]) -> Vectors<N> {
    let mut products = [[0.0; N]; 3];
    for (lane, &by) in by.iter().enumerate() {
        set(&mut products, lane, at(vectors, lane) * by);
    }
    products
}

/// The length of a vector, with a root that loops take many of at once.
#[inline(always)]
pub(crate) fn length(vector: DVec3) -> f64 {
    vector.length_squared().sqrt()
}

/// A vector brought to length 1.
#[inline(always)]
pub(crate) fn unit(vector: DVec3) -> DVec3 {
    vector * (1.0 / length(vector))
}

/// A vector brought to length 1, or another where it has none.
#[inline(always)]
pub(crate) fn unit_or(vector: DVec3, fallback: DVec3) -> DVec3 {
    let inverse = 1.0 / length(vector);
    if inverse.is_finite() & (inverse > 0.0) { vector * inverse } else { fallback }
}

/// Rows of words of elements side by side, in the order of a walk, that are still to be written.
pub(crate) struct Rows<'a, const N: usize>(&'a mut [[i32; N]]);

impl<'a, const N: usize> Rows<'a, N> {
    /// All words of some ports.
    #[inline(always)]
    pub(crate) fn new<const WORDS: usize>(words: &'a mut [[i32; N]; WORDS]) -> Self {
        Self(words)
    }

    /// The next words.
    #[inline(always)]
    fn take<const COUNT: usize>(&mut self) -> &'a mut [[i32; N]; COUNT] {
        let rows = std::mem::take(&mut self.0).split_first_chunk_mut();
        let (words, rest) = rows.unwrap_or_else(|| unreachable!("ports have so many words"));
        self.0 = rest;
        words
    }

    /// The words `of` makes of each element.
    #[inline(always)]
    pub(crate) fn put<const COUNT: usize>(&mut self, of: impl Fn(usize) -> [i32; COUNT]) {
        let rows = self.take::<COUNT>();
        for lane in 0..N {
            for (row, word) in rows.iter_mut().zip(of(lane)) {
                row[lane] = word;
            }
        }
    }

    /// A word of each element.
    #[inline(always)]
    pub(crate) fn put_row(&mut self, row: &[i32; N]) {
        *self.take::<1>() = [*row];
    }

    /// Words that are 0.
    #[inline(always)]
    pub(crate) fn put_zeros<const COUNT: usize>(&mut self) {
        *self.take::<COUNT>() = [[0; N]; COUNT];
    }

    /// Vectors of a profile.
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

    /// Offsets or roughnesses of a profile.
    #[inline(always)]
    pub(crate) fn put_offsets(&mut self, numbers: &[f64; N], p: &Precision) {
        self.put(
            #[inline(always)]
            |lane| [offset(numbers[lane], p).to_bits()],
        );
    }
}

/// What the elements of random sets of a kind are: `WORDS` words of ports, plausible ones or odd ones.
pub(crate) trait Kind<const WORDS: usize> {
    /// The ports.
    type Ports: Form + Bundle<i32, In<i32> = Self::Ports>;

    /// Which elements are odd: their first numbers say so.
    #[inline(always)]
    fn are_odd<const N: usize>(elements: Elements<N>) -> [bool; N] {
        elements.draws().are_odd()
    }
    /// Writes the words of plausible elements; those of others mean nothing.
    fn plausible<const N: usize>(elements: Elements<N>, p: &Precision, words: &mut [[i32; N]; WORDS]);
    /// Writes the words of odd elements; those of others mean nothing.
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

    /// Those elements of the set `set`, in place of what `columns` held.
    fn many(set: &str, indices: Range<u64>, p: &Precision, columns: &mut Columns<Self::Ports>) {
        let (hash, reading) = (SplitMix64::hash_of(set), Reading::best());
        let group = |first: u64| Elements { hash, indices: each!(lane in places() => first + lane as u64) };
        // Few are odd: they are brought together, so that no lane of theirs waits for plausible ones.
        let mut odd = Vec::new();
        for first in indices.clone().step_by(LANES) {
            let are_odd = reading.run(
                #[inline(always)]
                || Self::are_odd::<LANES>(group(first)),
            );
            odd.extend((first..indices.end).zip(are_odd).filter(|&(_, is_odd)| is_odd).map(|(index, _)| index));
        }
        let mut odd_words = vec![[[0; LANES]; WORDS]; odd.len().div_ceil(LANES)];
        for (odd, words) in odd.chunks(LANES).zip(&mut odd_words) {
            let elements = Elements { hash, indices: each!(lane in places() => odd[lane.min(odd.len() - 1)]) };
            reading.run(
                #[inline(always)]
                || Self::odd::<LANES>(elements, p, words),
            );
        }
        let mut odd = odd.iter().enumerate().map(|(number, &index)| (index, number / LANES, number % LANES)).peekable();
        columns.clear();
        let mut words = [[0; LANES]; WORDS];
        for first in indices.clone().step_by(LANES) {
            reading.run(
                #[inline(always)]
                || Self::plausible::<LANES>(group(first), p, &mut words),
            );
            let behind = indices.end.min(first + LANES as u64);
            while let Some((index, group, lane)) = odd.next_if(|&(index, ..)| index < behind) {
                for (row, odd) in words.iter_mut().zip(&odd_words[group]) {
                    row[(index - first) as usize] = odd[lane];
                }
            }
            columns.append((behind - first) as usize, &words);
        }
    }
}

#[cfg(test)]
mod tests {
    use roughxel_net::record::integers;

    use super::*;
    use crate::fragment::Fragments;
    use crate::highlight::Lights;
    use crate::lit_peak::Peaks;

    fn hold<K: Kind<WORDS>, const WORDS: usize>(p: &Precision) {
        let mut columns = Columns::default();
        // Whole groups of lanes, parts of them, none; the columns keep nothing of those before.
        for indices in [0..3000, 5..6, 70..70, 100..117, (1 << 40) + 3..(1 << 40) + 500] {
            K::many("draws", indices.clone(), p, &mut columns);
            assert_eq!(columns.len() as u64, indices.end - indices.start);
            for (place, index) in indices.enumerate() {
                let [many, one] = [columns.get(place), K::one("draws", index, p)].map(|ports| integers(&ports));
                assert_eq!(many, one, "element {index}");
            }
        }
    }

    #[test]
    fn elements_side_by_side_are_those_one_by_one() {
        for p in [Precision::NARROW, Precision::STANDARD, Precision::PRECISE] {
            hold::<Fragments, _>(&p);
            hold::<Lights, _>(&p);
            hold::<Peaks, _>(&p);
        }
    }

    #[test]
    fn directions_are_taken_from_the_same_numbers() {
        let generators: [SplitMix64; 400] = std::array::from_fn(|seed| SplitMix64::new(seed as u64));
        let mut draws = Draws(generators.clone());
        // Few points, so that many elements need more.
        let directions = draws.directions::<2, 3>();
        for (lane, mut random) in generators.into_iter().enumerate() {
            assert_eq!(directions.map(|vectors| at(&vectors, lane)), [(); 2].map(|()| direction(&mut random)));
            assert_eq!(draws.0[lane].next_u64(), random.next_u64());
        }
    }
}
