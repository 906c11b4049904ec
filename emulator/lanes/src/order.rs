//! Fragments by how many probes they have: a group of lanes takes as many turns as the longest footprint in it.

use roughxel_core::rom::MAX_PROBES;

/// The fragment at each place of another order.
#[derive(Clone, Debug, Default)]
pub(super) struct Order(pub(super) Vec<u32>);

/// Fragments to which moving one to a place among its like and back, 20 words, is worth a turn of their group: measured.
const MOVES_OF_A_TURN: usize = 32;

impl Order {
    /// Orders fragments by these counts, the few probes first. False, with no order, where that does not spare groups of `lanes` more than it costs.
    pub(super) fn by(&mut self, counts: &[i32], lanes: usize) -> bool {
        let most = |group: &[i32]| group.iter().copied().max().unwrap_or(0).unsigned_abs() as usize;
        let turns: usize = counts.chunks(lanes).map(most).sum();
        // Where the fragments of each count begin; no profile has more than so many probes.
        let place = |count: i32| (count.unsigned_abs() as usize).min(MAX_PROBES);
        let mut ends = [0; MAX_PROBES + 2];
        for &count in counts {
            ends[place(count) + 1] += 1;
        }
        for count in 1..ends.len() {
            ends[count] += ends[count - 1];
        }
        // The last of each group has the most.
        let count_at = |index: usize| ends.partition_point(|&end| end <= index) - 1;
        let lasts = (0..counts.len().div_ceil(lanes)).map(|group| counts.len().min(lanes * (group + 1)) - 1);
        let ordered: usize = lasts.map(count_at).sum();
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
        expected.sort_by_key(|&fragment| counts[fragment as usize]);
        assert_eq!(order.0, expected);
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
