//! Parts of sets: the vectors of a shard, and the entry of a part in the manifest.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::MAX_VECTORS;

/// A share of all work: number `number`, from 1, of `count` shares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    count: u64,
}

impl Shard {
    /// A shard; `None` if `number` is not in 1 to `count`, or there are more shards than the most vectors of a set.
    pub fn new(number: u64, count: u64) -> Option<Self> {
        ((1..=MAX_VECTORS).contains(&count) && (1..=count).contains(&number)).then_some(Self { number, count })
    }

    /// Number of this shard, from 1.
    pub fn number(&self) -> u64 {
        self.number
    }
}

/// A part of a set: a contiguous range of its vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Number of this part, from 1.
    pub number: u64,
    /// Parts of the set.
    pub of: u64,
    /// Index in the whole set of the first vector here.
    pub first: u64,
    /// Vectors of the whole set.
    pub whole_count: u64,
}

impl Part {
    /// The part of a shard in a set of `count` vectors. A set has no more parts than vectors, so the last shards may have none.
    pub fn from_shard(count: u64, shard: Shard) -> Option<Self> {
        let of = shard.count.min(count);
        (shard.number <= of).then(|| Self::numbered(shard.number, of, count))
    }

    /// Nothing overflows: parts and vectors are at most [`MAX_VECTORS`].
    fn numbered(number: u64, of: u64, whole_count: u64) -> Self {
        Self { number, of, first: (number - 1) * whole_count / of, whole_count }
    }

    /// The vectors, by their indices in the whole set.
    pub fn indices(&self) -> Range<u64> {
        self.first..self.number * self.whole_count / self.of
    }

    /// Text between the name of a set and the extension of a part's files: parts of one set are next to each other, in order.
    pub(super) fn suffix(&self) -> String {
        let Self { number, of, .. } = self;
        format!(".{number:0digits$}of{of}", digits = of.to_string().len())
    }

    /// The fault of a part of `count` vectors, if there is one.
    pub(super) fn check(&self, count: u64) -> Result<(), String> {
        let Self { number, of, first, whole_count } = *self;
        if !(1..=MAX_VECTORS).contains(&whole_count) {
            return Err(format!("part.whole_count {whole_count} is not in 1 to {MAX_VECTORS}"));
        }
        if !(1..=whole_count).contains(&of) || !(1..=of).contains(&number) {
            return Err(format!("there is no part {number} of {of} of a set of {whole_count} vectors"));
        }
        let right = Self::numbered(number, of, whole_count).indices();
        if first != right.start || count != right.end - right.start {
            return Err(format!(
                "part {number} of {of} has the vectors #{} to #{} of {whole_count}, not {count} from #{first}",
                right.start,
                right.end - 1
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_each_other_and_none_is_empty() {
        for count in [1, 2, 7, 40, 41, MAX_VECTORS] {
            for of in [1, 2, 3, 7, 40, 41, 64] {
                let parts: Vec<Part> =
                    (1..=of).filter_map(|number| Part::from_shard(count, Shard::new(number, of).unwrap())).collect();
                assert_eq!(parts.len() as u64, of.min(count));
                let mut next = 0;
                for part in &parts {
                    let indices = part.indices();
                    assert!(indices.start == next && indices.start == part.first && !indices.is_empty());
                    next = indices.end;
                    assert_eq!(part.check(indices.end - indices.start), Ok(()));
                }
                assert_eq!(next, count);
            }
        }
        assert_eq!((Shard::new(0, 3), Shard::new(4, 3), Shard::new(1, MAX_VECTORS + 1)), (None, None, None));
    }
}
