//! Rounding: what a design gives where whatever it rounds is rounded in another way, by some last places more or less.
//!
//! Each rounding alone, both ways, says how much every outcome depends on it; the sum over all of them is, to first order, how far an outcome
//! can be off where all are at once. A comparison is beyond first order: where the sum can turn it, a design is asked in which every
//! rounding pushes towards that.

use super::graph::{Net, NodeId, Op};
use super::interval::Ranges;

/// Designs beside those that a comparison asks for, whose roundings are off in no order.
const SCATTERED: u64 = 8;

/// A design that rounds in another way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// One rounding alone, by its number: more, then less.
    Alone(usize),
    /// All of them.
    Together,
}

/// A node that is rounded to nearest, and what depends on it.
#[derive(Clone, Debug)]
struct Rounding {
    node: NodeId,
    low: i64,
    high: i64,
    /// Nodes that depend on it, in their order.
    behind: Vec<NodeId>,
    /// Comparisons among them, by their places.
    comparisons: Vec<usize>,
}

/// A design with its roundings.
#[derive(Clone, Debug)]
pub struct Roundings<'a> {
    net: &'a Net,
    roundings: Vec<Rounding>,
    /// The number of a node's rounding.
    number: Vec<Option<usize>>,
    /// a < b, as [a, b].
    comparisons: Vec<[NodeId; 2]>,
}

impl<'a> Roundings<'a> {
    /// Of a design, as far as `outcomes` depend on them.
    pub fn new(net: &'a Net, outcomes: &[NodeId]) -> Self {
        let ranges = Ranges::new(net);
        let mut wanted = vec![false; net.nodes.len()];
        outcomes.iter().for_each(|&node| wanted[node as usize] = true);
        for (id, node) in net.iter().rev() {
            if wanted[id as usize] {
                node.op.operands().for_each(|operand| wanted[operand as usize] = true);
            }
        }
        let of_wanted = || net.iter().filter(|&(id, _)| wanted[id as usize]);
        let compared = of_wanted().filter_map(|(id, node)| match node.op {
            Op::Lt(a, b) => Some((id, [a, b])),
            _ => None,
        });
        let (flags, comparisons): (Vec<NodeId>, Vec<[NodeId; 2]>) = compared.unzip();
        let mut number = vec![None; net.nodes.len()];
        let mut roundings = Vec::new();
        for (node, _) in of_wanted().filter(|&(id, _)| net.is_rounded(id)) {
            let mut depends = vec![false; net.nodes.len()];
            depends[node as usize] = true;
            let mut behind = Vec::new();
            for (id, of) in of_wanted().skip_while(|&(id, _)| id <= node) {
                if of.op.operands().any(|operand| depends[operand as usize]) {
                    depends[id as usize] = true;
                    behind.push(id);
                }
            }
            let comparisons = (0..).zip(&flags).filter(|&(_, &flag)| depends[flag as usize]).map(|(place, _)| place);
            let range = ranges.of(node);
            number[node as usize] = Some(roundings.len());
            roundings.push(Rounding {
                node,
                low: range.low,
                high: range.high,
                comparisons: comparisons.collect(),
                behind,
            });
        }
        Self { net, roundings, number, comparisons }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.roundings.len()
    }

    /// The wires of a design whose rounding of each number is `change` last places more.
    pub fn wires(&self, ports: &[i64], change: impl Fn(usize) -> i64, wires: &mut Vec<i64>) {
        wires.clear();
        for id in 0..self.net.nodes.len() as NodeId {
            let value = self.net.value(id, ports, wires);
            wires.push(match self.number[id as usize] {
                Some(number) => self.roundings[number].changed(value, change(number)),
                None => value,
            });
        }
    }

    /// Shows `see` the wires of designs with these ports in which roundings are up to `places` last places off.
    ///
    /// Of one rounding alone only wires that outcomes depend on.
    pub fn each(&self, ports: &[i64], places: i64, see: &mut impl FnMut(Change, &[i64])) {
        let mut right = Vec::new();
        self.net.evaluate(ports, &mut right);
        let ahead = |wires: &[i64], place: usize| {
            let [a, b] = self.comparisons[place];
            i128::from(wires[a as usize]) - i128::from(wires[b as usize])
        };
        // How far a − b of each comparison can go, and by which sign of each rounding it grows.
        let mut reach = vec![0_i128; self.comparisons.len()];
        let mut grows = vec![0_i8; self.comparisons.len() * self.count()];
        let (mut wires, mut differs) = (right.clone(), vec![false; right.len()]);
        for (number, rounding) in self.roundings.iter().enumerate() {
            let mut most = vec![0_i128; rounding.comparisons.len()];
            for places in [places, -places] {
                let node = rounding.node as usize;
                wires[node] = rounding.changed(right[node], places);
                if wires[node] == right[node] {
                    continue;
                }
                differs[node] = true;
                for &id in &rounding.behind {
                    if self.net.node(id).op.operands().any(|operand| differs[operand as usize]) {
                        wires[id as usize] = self.net.value(id, ports, &wires);
                        differs[id as usize] = wires[id as usize] != right[id as usize];
                    }
                }
                see(Change::Alone(number), &wires);
                for (most, &place) in most.iter_mut().zip(&rounding.comparisons) {
                    let more = ahead(&wires, place) - ahead(&right, place);
                    if more.abs() > *most {
                        *most = more.abs();
                        grows[place * self.count() + number] = (more.signum() * i128::from(places.signum())) as i8;
                    }
                }
                for id in rounding.behind.iter().copied().chain([rounding.node]) {
                    (wires[id as usize], differs[id as usize]) = (right[id as usize], false);
                }
            }
            for (most, &place) in most.iter().zip(&rounding.comparisons) {
                reach[place] += most;
            }
        }
        for (place, &reach) in reach.iter().enumerate() {
            let ahead = ahead(&right, place);
            let turns = if ahead < 0 { ahead + reach >= 0 } else { ahead - reach < 0 };
            if turns {
                let towards = if ahead < 0 { places } else { -places };
                let of = &grows[place * self.count()..][..self.count()];
                self.wires(ports, |number| i64::from(of[number]) * towards, &mut wires);
                see(Change::Together, &wires);
            }
        }
        for design in 0..SCATTERED {
            self.wires(ports, |number| scattered(design, number, places), &mut wires);
            see(Change::Together, &wires);
        }
    }
}

impl Rounding {
    /// An integer with so many last places more, as far as its range allows.
    fn changed(&self, value: i64, places: i64) -> i64 {
        if places == 0 { value } else { (value + places).clamp(self.low, self.high) }
    }
}

/// −`places` … `places`, spread evenly over the numbers.
pub fn scattered(design: u64, number: usize, places: i64) -> i64 {
    let mixed = (design << 32 | number as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 33) as i64 % (2 * places + 1) - places
}

impl Net {
    /// Whether a node is ⌊x + ½⌋ in units of its last place: ⌊(2x + 1)/2⌋, as every reading rounds.
    fn is_rounded(&self, id: NodeId) -> bool {
        let Op::Sar(sum, 1) = self.node(id).op else { return false };
        matches!(self.node(sum).op, Op::Add(_, one) if self.node(one).op == Op::Lit(1))
    }
}
