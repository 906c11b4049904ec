//! Fragments by how many probes they have: a group of lanes takes as many turns as the longest footprint in it.

use roughxel_core::rom::MAX_PROBES;

/// The fragment at each place of another order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Order(pub(super) Vec<u32>);

/// Fragments to which moving one to a place among its like and back, 20 words, is worth a turn of their group: measured.
const MOVES_OF_A_TURN: usize = 32;

impl Order {
    /// Orders fragments by these counts, the most probes first, so that no other order takes fewer turns: but the i-th, no group's longest is shorter than
    /// what stands at `lanes`·i. (The fewest first takes more where a group that is not full then has the longest.) False, with no order, where it does
    /// not spare groups of `lanes` more than it costs.
    pub(crate) fn by(&mut self, counts: &[i32], lanes: usize) -> bool {
        let most = |group: &[i32]| group.iter().copied().max().unwrap_or(0).unsigned_abs() as usize;
        let turns: usize = counts.chunks(lanes).map(most).sum();
        // Where the fragments of each count begin; no profile has more than so many probes.
        let place = |count: i32| MAX_PROBES - (count.unsigned_abs() as usize).min(MAX_PROBES);
        let mut ends = [0; MAX_PROBES + 2];
        for &count in counts {
            ends[place(count) + 1] += 1;
        }
        for place in 1..ends.len() {
            ends[place] += ends[place - 1];
        }
        // The first of each group has the most.
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

    /// The fewest first took 18 turns for these in place of 10, and the difference went below zero.
    #[test]
    fn a_group_that_is_not_full_is_no_reason_for_more_turns() {
        let mut order = Order::default();
        assert!(!order.by(&[9, 9, 9, 9, 1], 4), "they stand as well as they can");
        assert!(order.by(&[1, 9, 9, 9, 9], 4));
        assert_eq!(order.0, [1, 2, 3, 4, 0]);
    }

    /// Every arrangement of few counts, against the turns of all others.
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
                // A turn is worth 32 fragments: whatever there is to spare among seven is spared.
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
