//! Words that are not at their position in a set. A word does not name its vector, but its inputs do if they can be reproduced:
//! those of random sets from the seed, those of hard cases from their list.

use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;

use super::VectorError;
use super::field::Direction;
use super::layout::Layout;
use super::lines::Lines;
use super::manifest::Manifest;
use super::sets::Source;

/// Most sentences about one set.
const DESCRIBED: usize = 10;

/// A fault in the order of the words. Vectors are named by their indices in the whole set, lines and records from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "what")]
pub enum Misplaced {
    /// Two words that are swapped.
    Swapped {
        /// The vectors, the smaller index first.
        indices: [u64; 2],
        /// Lines where their words belong.
        lines: [u64; 2],
    },
    /// Consecutive words that are missing.
    Missing {
        /// The first vector.
        first: u64,
        /// The last one.
        last: u64,
    },
    /// A word that occurs a second time.
    Repeated {
        /// The vector.
        index: u64,
        /// Line of the second word.
        line: u64,
    },
    /// A word at the position of a different one.
    Moved {
        /// The vector.
        index: u64,
        /// Line of its word.
        line: u64,
        /// The vector of that position.
        place: u64,
    },
    /// A word with inputs that no vector of the set has.
    Foreign {
        /// Its line.
        line: u64,
    },
}

/// A sentence without its stop.
impl fmt::Display for Misplaced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Swapped { indices: [a, b], lines: [c, d] } => {
                write!(f, "words #{a} and #{b} are in each other's place (lines {c} and {d})")
            }
            Self::Missing { first, last } if first == last => write!(f, "word #{first} is missing"),
            Self::Missing { first, last } => write!(f, "words #{first} to #{last} are missing"),
            Self::Repeated { index, line } => write!(f, "word #{index} is there once more (line {line})"),
            Self::Moved { index, line, place } => write!(f, "word #{index} is in the place of #{place} (line {line})"),
            Self::Foreign { line } => write!(f, "line {line} is the word of no vector of the set"),
        }
    }
}

/// Faults in the order of a set's file, the first ten. The list is empty if the inputs of the set cannot be reproduced, or none
/// of its words is at its position. Call it only for a file that is not the one of its manifest: it holds two numbers per vector
/// in memory.
pub(super) fn misplaced(manifest_path: &Path, manifest: &Manifest, layout: &Layout) -> Vec<Misplaced> {
    read_order(manifest_path, manifest, layout).map_or_else(Vec::new, |(_, found)| found)
}

/// An error of the number of words, with its cause if known; every other error unchanged.
pub(super) fn with_cause(
    error: VectorError,
    manifest_path: &Path,
    manifest: &Manifest,
    layout: &Layout,
) -> VectorError {
    let VectorError::Count { path, found, expected, .. } = error else { return error };
    let (found, order) = read_order(manifest_path, manifest, layout).unwrap_or((found, Vec::new()));
    let cause = order.iter().map(|misplaced| format!("; {misplaced}")).collect();
    VectorError::Count { path, found, expected, cause }
}

/// Number of words in a file, and their faults of order; `None` if they cannot be determined.
fn read_order(manifest_path: &Path, manifest: &Manifest, layout: &Layout) -> Option<(u64, Vec<Misplaced>)> {
    let source = Source::from_manifest(manifest)?;
    let inputs = layout.fields().iter().filter(|field| field.direction == Direction::In).count();
    let mut lines = Lines::open_longer(manifest_path, manifest).ok()?;
    let (mut found, mut numbers) = (Vec::new(), Vec::new());
    while let Some(line) = lines.next().ok()? {
        let bits = line.bits(layout).ok()?;
        found.push(key(&bits[..inputs]));
        numbers.push(line.number);
    }
    let all = manifest.indices();
    // In a file with few of many words the later ones are missing, and need not be known.
    let known = all.start..all.end.min(all.start + 2 * found.len() as u64 + 1024);
    let expected: Option<Vec<u64>> = known
        .clone()
        .into_par_iter()
        .map(|index| Some(key(&layout.input_bits(&source.inputs(index, manifest).integers())?)))
        .collect();
    let mut order = compared(&expected?, &found, &numbers, all.start);
    if let Some(Misplaced::Missing { last, .. }) = order.last_mut()
        && *last == known.end - 1
    {
        *last = all.end - 1;
    }
    Some((found.len() as u64, order))
}

fn key(bits: &[u32]) -> u64 {
    let mut hasher = DefaultHasher::new();
    bits.hash(&mut hasher);
    hasher.finish()
}

/// Faults of order in `found`, with the line of each word, compared with `expected`; `first` is the index of the first vector.
fn compared(expected: &[u64], found: &[u64], lines: &[u64], first: u64) -> Vec<Misplaced> {
    // Every word at its own position stays there; equal words are alike.
    let at_home = |place: usize| expected.get(place).is_some_and(|key| found.get(place) == Some(key));
    let mut homes: Vec<(u64, usize)> =
        (0..expected.len()).filter(|&place| !at_home(place)).map(|place| (expected[place], place)).collect();
    homes.sort_unstable();
    // Number of occupied positions of equal words, stored at the first of them.
    let mut taken = vec![0; homes.len()];
    let mut is_missing: Vec<bool> = (0..expected.len()).map(|place| !at_home(place)).collect();
    // The position of each word that is not at its position.
    let strays: Vec<(usize, Option<usize>)> = (0..found.len())
        .filter(|&place| !at_home(place))
        .map(|place| {
            let from = homes.partition_point(|home| home.0 < found[place]);
            let free = homes.get(from + taken.get(from).unwrap_or(&0)).filter(|home| home.0 == found[place]);
            if let Some(&(_, home)) = free {
                taken[from] += 1;
                is_missing[home] = false;
            }
            (place, free.map(|&(_, home)| home))
        })
        .collect();
    let homeless = || strays.iter().filter(|(_, home)| home.is_none()).map(|&(place, _)| place);
    if homeless().count() == found.len() {
        return Vec::new();
    }
    let index = |place: usize| first + place as u64;

    let mut order = Vec::new();
    let mut sorted: Vec<(u64, usize)> = Vec::new();
    if homeless().next().is_some() {
        sorted = expected.iter().copied().zip(0..).collect();
        sorted.sort_unstable();
    }
    for place in homeless() {
        let from = sorted.partition_point(|known| known.0 < found[place]);
        match sorted.get(from).filter(|known| known.0 == found[place]) {
            Some(&(_, known)) => order.push(Misplaced::Repeated { index: index(known), line: lines[place] }),
            // A word at its position with other inputs is damaged, and reported as damaged.
            None if is_missing.get(place) == Some(&true) => is_missing[place] = false,
            None => order.push(Misplaced::Foreign { line: lines[place] }),
        }
    }
    let missing: Vec<usize> = (0..expected.len()).filter(|&place| is_missing[place]).collect();
    for run in missing.chunk_by(|a, b| a + 1 == *b) {
        order.push(Misplaced::Missing { first: index(run[0]), last: index(run[run.len() - 1]) });
    }
    // After a missing or an extra word all later words have moved with it.
    if order.is_empty() {
        let home_of =
            |place: usize| strays.binary_search_by_key(&place, |&(place, _)| place).ok().and_then(|at| strays[at].1);
        for &(place, home) in &strays {
            let Some(home) = home else { continue };
            if home_of(home) != Some(place) {
                order.push(Misplaced::Moved { index: index(home), line: lines[place], place: index(place) });
            } else if place < home {
                let (indices, lines) = ([index(place), index(home)], [lines[place], lines[home]]);
                order.push(Misplaced::Swapped { indices, lines });
            }
        }
    }
    order.truncate(DESCRIBED);
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differences(expected: &[u64], found: &[u64]) -> Vec<String> {
        let lines: Vec<u64> = (2..).take(found.len()).collect();
        compared(expected, found, &lines, 100).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_is_out_of_order_is_named() {
        let set: Vec<u64> = (0..8).map(|i| i * 10).collect();
        let changed = |change: fn(&mut Vec<u64>)| {
            let mut found = set.clone();
            change(&mut found);
            differences(&set, &found)
        };
        assert!(changed(|_| ()).is_empty());
        assert_eq!(
            changed(|words| words.swap(3, 6)),
            ["words #103 and #106 are in each other's place (lines 5 and 8)"]
        );
        assert_eq!(changed(|words| drop(words.drain(2..3))), ["word #102 is missing"]);
        assert_eq!(changed(|words| drop(words.drain(2..5))), ["words #102 to #104 are missing"]);
        assert_eq!(changed(|words| words.truncate(6)), ["words #106 to #107 are missing"]);
        assert_eq!(changed(|words| words.insert(3, 20)), ["word #102 is there once more (line 5)"]);
        assert_eq!(changed(|words| words[5] = 20), ["word #102 is there once more (line 7)", "word #105 is missing"]);
        assert_eq!(changed(|words| words.push(5)), ["line 10 is the word of no vector of the set"]);
        let turned = [
            "word #102 is in the place of #101 (line 3)",
            "word #103 is in the place of #102 (line 4)",
            "word #101 is in the place of #103 (line 5)",
        ];
        assert_eq!(changed(|words| words[1..4].rotate_left(1)), turned);
        // Other inputs at a vector's position are damage, not a matter of order.
        assert!(changed(|words| words[5] = 7).is_empty());
        assert!(changed(|words| words.fill(1)).is_empty());
        // No word is at its position, but every word is known.
        assert_eq!(changed(|words| drop(words.drain(..1))), ["word #100 is missing"]);
        assert_eq!(differences(&[1, 2], &[2, 1]), ["words #100 and #101 are in each other's place (lines 2 and 3)"]);
    }

    #[test]
    fn equal_words_may_stand_in_each_others_place() {
        assert!(differences(&[1, 2, 2, 3], &[1, 2, 2, 3]).is_empty());
        assert_eq!(
            differences(&[1, 2, 2, 3], &[2, 1, 2, 3]),
            ["words #100 and #101 are in each other's place (lines 2 and 3)"]
        );
        assert_eq!(differences(&[1, 2, 2, 3], &[1, 2, 3]), ["word #102 is missing"]);
    }
}
