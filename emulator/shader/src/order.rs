//! Order of fragments by probe count. A lane group takes as many turns as its longest footprint has probes.

use roughxel_core::rom::MAX_PROBES;

/// Index of the fragment at each place of the order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Order(pub(super) Vec<u32>);

/// Number of fragments whose reordering costs as much as one turn of their group: measured. To reorder a fragment is to move its 20 words to a place
/// among its like and back.
const MOVES_OF_A_TURN: usize = 32;

impl Order {
    /// Orders fragments by these counts, the most probes first, so that no other order takes fewer turns. Among the counts in this order, the longest
    /// of group i is never below the one at `lanes`·i. (The fewest first takes more turns if a group that is not full then has the longest
    /// footprint.) Returns false, without an order, if groups of `lanes` save less than the order costs.
    pub(crate) fn by(&mut self, counts: &[i32], lanes: usize) -> bool {
        let most = |group: &[i32]| group.iter().copied().max().unwrap_or(0).unsigned_abs() as usize;
        let turns: usize = counts.chunks(lanes).map(most).sum();
        // Places where the fragments of each count begin; no profile has more than `MAX_PROBES` probes.
        let place = |count: i32| MAX_PROBES - (count.unsigned_abs() as usize).min(MAX_PROBES);
        let mut ends = [0; MAX_PROBES + 2];
        for &count in counts {
            ends[place(count) + 1] += 1;
        }
        for place in 1..ends.len() {
            ends[place] += ends[place - 1];
        }
        // The first fragment of each group has the most probes.
        let count_at = |index: usize| MAX_PROBES + 1 - ends.partition_point(|&end| end <= index);
        let ordered: usize = (0..counts.len()).step_by(lanes).map(count_at).sum();
        if (turns - ordered) * MOVES_OF_A_TURN <= counts.len() {
            return false;
        }
        self.0.clear();
        self.0.resize(counts.len(), 0);
        for (fragment, &count) in (0..).zip(counts) {
            let next = &mut ends[place(count)];
            self.0[*next] = fragment;
            *next += 1;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_is_by_count_and_stable() {
        let counts = [[9, 1, 16, 1, 1, 9, 2, 16], [1, 16, 2, 1, 1, 1, 9, 2]].concat();
        let mut order = Order::default();
        assert!(order.by(&counts, 4));
        let mut expected: Vec<u32> = (0..16).collect();
        expected.sort_by_key(|&fragment| std::cmp::Reverse(counts[fragment as usize]));
        assert_eq!(order.0, expected);
    }

    /// Order with the fewest probes first: it takes 18 turns for these counts instead of 10, a difference below zero.
    #[test]
    fn a_group_that_is_not_full_is_no_reason_for_more_turns() {
        let mut order = Order::default();
        assert!(!order.by(&[9, 9, 9, 9, 1], 4), "the order is already the best");
        assert!(order.by(&[1, 9, 9, 9, 9], 4));
        assert_eq!(order.0, [1, 2, 3, 4, 0]);
    }

    /// All arrangements of few counts, compared with the turns of every other order.
    #[test]
    fn no_arrangement_takes_fewer_turns() {
        let turns =
            |counts: &[i32]| counts.chunks(3).map(|group| group.iter().copied().max().unwrap_or(0)).sum::<i32>();
        let all: Vec<Vec<i32>> = (0..4_usize.pow(7))
            .map(|code| (0..7).map(|i| [1, 2, 5, 16][code / 4_usize.pow(i) % 4]).collect())
            .collect();
        let mut least = std::collections::BTreeMap::new();
        let sorted = |counts: &Vec<i32>| {
            let mut sorted = counts.clone();
            sorted.sort_unstable();
            sorted
        };
        for counts in &all {
            let best = least.entry(sorted(counts)).or_insert(i32::MAX);
            *best = turns(counts).min(*best);
        }
        let mut order = Order::default();
        for counts in &all {
            let best = least[&sorted(counts)];
            if order.by(counts, 3) {
                let ordered: Vec<i32> = order.0.iter().map(|&fragment| counts[fragment as usize]).collect();
                assert_eq!(turns(&ordered), best, "{counts:?}");
            } else {
                // A turn is worth 32 fragments, so any turn that seven fragments can save is saved.
                assert_eq!(turns(counts), best, "{counts:?}");
            }
        }
    }

    #[test]
    fn no_order_where_it_spares_nothing() {
        let mut order = Order::default();
        assert!(!order.by(&[], 16));
        assert!(!order.by(&[7; 40], 16));
        assert!(!order.by(&[1, 2, 3, 4, 16], 16), "one group takes the turns of its longest");
        // One turn of 2 + 3 is not worth 128 moves.
        let counts: Vec<i32> = (0..128).map(|i| if i == 3 || i == 100 { 3 } else { 2 }).collect();
        assert!(!order.by(&counts, 16));
    }
}
