//! The inputs of a vector as integers, and their simplifications.

use std::collections::HashSet;

use crate::datapath::Inputs;
use crate::field::{Direction, Field, mask};
use crate::layout::Layout;
use crate::manifest::Manifest;

/// Input fields with their new values.
pub(super) type Change = Vec<(usize, i64)>;

pub(super) fn changed(integers: &[i64], change: &[(usize, i64)]) -> Vec<i64> {
    let mut integers = integers.to_vec();
    change.iter().for_each(|&(field, integer)| integers[field] = integer);
    integers
}

/// The bits of an integer that the field can hold.
pub(super) fn bits_of(field: &Field, integer: i64) -> u32 {
    integer as u32 & mask(field.width)
}

/// The input fields of a word, and their groups.
pub(super) struct Shape<'a> {
    layout: &'a Layout,
    pub(super) fields: &'a [Field],
    /// Blocks, arrays of numbers, single numbers.
    groups: Vec<Vec<usize>>,
}

impl<'a> Shape<'a> {
    pub(super) fn new(layout: &'a Layout) -> Self {
        let count = layout.fields().iter().take_while(|field| field.direction == Direction::In).count();
        let fields = &layout.fields()[..count];
        let owner = |place: usize| {
            let port = fields[place].port.as_str();
            let port = port.rsplit_once('[').map_or(port, |(array, _)| array);
            port.strip_suffix(".mantissa").or(port.strip_suffix(".exponent")).unwrap_or(port)
        };
        let places: Vec<usize> = (0..count).collect();
        let groups = places.chunk_by(|&a, &b| owner(a) == owner(b)).map(<[usize]>::to_vec).collect();
        Self { layout, fields, groups }
    }

    pub(super) fn integers(&self, bits: &[u32]) -> Vec<i64> {
        self.fields.iter().zip(bits).map(|(field, &bits)| field.integer(bits & mask(field.width))).collect()
    }

    /// The ports of a vector with these fields.
    pub(super) fn inputs(&self, manifest: &Manifest, integers: &[i64]) -> Inputs {
        let bits: Vec<u32> =
            self.fields.iter().zip(integers).map(|(field, &integer)| bits_of(field, integer)).collect();
        Inputs::from_integers(manifest.datapath, &self.layout.decode(&bits))
    }

    fn is_exponent(&self, place: usize) -> bool {
        self.fields[place].port.ends_with(".exponent")
    }

    /// Complexity, smaller is simpler: number of non-zero fields, bits in them, size of exponents.
    pub(super) fn complexity(&self, integers: &[i64]) -> (usize, u32, u64) {
        let not_zero = integers.iter().filter(|integer| **integer != 0).count();
        let bits = integers.iter().map(|integer| integer.unsigned_abs().count_ones()).sum();
        let exponents = (0..integers.len()).filter(|&place| self.is_exponent(place));
        (not_zero, bits, exponents.map(|place| integers[place].unsigned_abs()).sum())
    }

    /// All changes that make it simpler, each with a different result, the boldest first. Results are in the ranges of the ports.
    pub(super) fn changes(&self, integers: &[i64]) -> Vec<Change> {
        let mut changes: Vec<Change> = Vec::new();
        let zero = |places: &[usize]| places.iter().map(|&place| (place, 0)).collect();
        // Changes of half of the groups, a quarter and so on; the last changes are of single groups.
        let mut size = self.groups.len();
        while size > 1 {
            size = size.div_ceil(2);
            changes.extend(self.groups.chunks(size).map(|groups| zero(&groups.concat())));
        }
        let all: Vec<usize> = (0..self.fields.len()).collect();
        let (exponents, numbers): (Vec<usize>, Vec<usize>) = all.iter().partition(|&&place| self.is_exponent(place));
        changes.push(zero(&exponents));
        // Every number, reduced to a few upper bits.
        for kept in [1, 2, 4, 8] {
            changes.push(numbers.iter().map(|&place| (place, upper_bits(integers[place], kept))).collect());
        }
        for group in &self.groups {
            self.plain_vectors(group, &mut changes);
        }
        for &place in &all {
            changes.push(vec![(place, 0)]);
        }
        for &place in &exponents {
            let others = exponents.iter().map(|&other| integers[other]);
            let nearer = [1, integers[place] / 2, integers[place] - integers[place].signum()];
            changes.extend(others.chain(nearer).map(|exponent| vec![(place, exponent)]));
        }
        for &place in &numbers {
            let integer = integers[place];
            let ones = integer.unsigned_abs().count_ones();
            changes.extend([1, ones / 2, ones.saturating_sub(1)].map(|kept| vec![(place, upper_bits(integer, kept))]));
        }

        let simpler_than = self.complexity(integers);
        let mut known = HashSet::new();
        changes.retain(|change| {
            let candidate = changed(integers, change);
            let is_allowed = change.iter().all(|&(place, integer)| self.layout.allows(place, integer));
            is_allowed && self.complexity(&candidate) < simpler_than && known.insert(candidate)
        });
        changes
    }

    /// Unit vectors along each axis, in each direction, instead of a vector: with its exponent, and with the exponent that makes
    /// them 1.
    fn plain_vectors(&self, group: &[usize], changes: &mut Vec<Change>) {
        let (exponent, numbers): (Vec<usize>, Vec<usize>) = group.iter().partition(|&&place| self.is_exponent(place));
        if numbers.len() < 2 {
            return;
        }
        for &axis in &numbers {
            for sign in [1, -1] {
                // ½ for a mantissa.
                let half = sign << self.fields[axis].fraction_bits.saturating_sub(1);
                let alone = |place: usize| (place, if place == axis { half } else { 0 });
                let vector: Change = numbers.iter().map(|&place| alone(place)).collect();
                for &place in &exponent {
                    changes.push(vector.iter().copied().chain([(place, 1)]).collect());
                }
                changes.push(vector);
            }
            // The component along this axis.
            changes.push(numbers.iter().filter(|&&place| place != axis).map(|&place| (place, 0)).collect());
        }
    }
}

/// The integer, reduced to its `kept` uppermost one bits, by magnitude.
pub(super) fn upper_bits(integer: i64, kept: u32) -> i64 {
    let (mut rest, mut size) = (integer.unsigned_abs(), 0);
    for _ in 0..kept {
        let Some(bit) = rest.checked_ilog2() else { break };
        size |= 1 << bit;
        rest ^= 1 << bit;
    }
    size as i64 * integer.signum()
}
