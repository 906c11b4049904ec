//! Rounding: values of a design whose roundings are off by some last places.
//!
//! Each rounding alone, both ways, shows how much every outcome depends on it. The sum over all roundings is, to first order, the largest error of an
//! outcome if all roundings are off at once. A comparison is beyond first order. If the sum can turn it, a design is tried in which every rounding
//! pushes towards that. If the outcome changes there, each rounding is also tried alone in that design.

use super::graph::{Net, NodeId, Op};
use super::interval::Ranges;
use super::waiting::Waiting;

/// Number of designs with scattered roundings, in addition to those for comparisons.
const SCATTERED: u64 = 8;

/// A design with changed roundings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// All roundings are changed.
    Together,
    /// One rounding alone, by its number, in the design last shown as `Together`: more, then less.
    Alone(usize),
}

/// Effect of roundings on the comparisons of a vector.
#[derive(Clone, Debug)]
pub struct Moves {
    /// Wires of the unchanged design.
    right: Vec<i64>,
    /// Growth of a − b of each comparison for more of each rounding, taken from the direction (more or less) that moves it further.
    moves: Vec<i128>,
}

/// A node that is rounded to nearest, and the comparisons that depend on it.
#[derive(Clone, Debug)]
struct Rounding {
    node: NodeId,
    low: i64,
    high: i64,
    /// Places of the comparisons that depend on it.
    comparisons: Vec<usize>,
}

/// A design with its roundings.
#[derive(Clone, Debug)]
pub struct Roundings<'a> {
    net: &'a Net,
    roundings: Vec<Rounding>,
    /// Number of each node's rounding.
    number: Vec<Option<usize>>,
    /// a < b, as [a, b].
    comparisons: Vec<[NodeId; 2]>,
    /// Readers of each node, if outcomes depend on them.
    readers: Vec<Vec<NodeId>>,
}

impl<'a> Roundings<'a> {
    /// Roundings of a design on which `outcomes` depend.
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
            for (id, of) in of_wanted().skip_while(|&(id, _)| id <= node) {
                if of.op.operands().any(|operand| depends[operand as usize]) {
                    depends[id as usize] = true;
                }
            }
            let comparisons = (0..).zip(&flags).filter(|&(_, &flag)| depends[flag as usize]).map(|(place, _)| place);
            let range = ranges.of(node);
            number[node as usize] = Some(roundings.len());
            roundings.push(Rounding { node, low: range.low, high: range.high, comparisons: comparisons.collect() });
        }
        let mut readers = vec![Vec::new(); net.nodes.len()];
        for (id, node) in of_wanted() {
            node.op.operands().for_each(|operand| readers[operand as usize].push(id));
        }
        Self { net, roundings, number, comparisons, readers }
    }

    /// Number of roundings.
    pub fn count(&self) -> usize {
        self.roundings.len()
    }

    /// Wires of a design whose rounding of each number is `change` last places more.
    pub fn wires(&self, ports: &[i64], change: impl Fn(usize) -> i64, wires: &mut Vec<i64>) {
        wires.clear();
        for id in 0..self.net.nodes.len() as NodeId {
            wires.push(self.wire(id, ports, &change, wires));
        }
    }

    /// Shows `see` the wires of the design with each rounding alone `places` last places more, then less, with the number of the rounding. Only wires
    /// on which outcomes depend count. The returned moves of the comparisons select the designs of `others`.
    pub fn each_alone(&self, ports: &[i64], places: i64, see: &mut impl FnMut(usize, &[i64])) -> Moves {
        let mut right = Vec::new();
        self.net.evaluate(ports, &mut right);
        let mut moves = vec![0_i128; self.comparisons.len() * self.count()];
        self.each_alone_in(ports, &|_| 0, &right, places, &mut |number, places, wires| {
            see(number, wires);
            for &place in &self.roundings[number].comparisons {
                let more = self.ahead(place, wires) - self.ahead(place, &right);
                let most = &mut moves[place * self.count() + number];
                if more.abs() > most.abs() {
                    *most = more * i128::from(places.signum());
                }
            }
        });
        Moves { right, moves }
    }

    /// Shows `see` the wires of designs in which all roundings are up to `places` last places off. Some push towards a different decision, some are
    /// scattered.
    ///
    /// If `see` answers true, the outcome differs, and `see` is also shown each rounding alone in that design.
    pub fn others(&self, ports: &[i64], places: i64, of: &Moves, see: &mut impl FnMut(Change, &[i64]) -> bool) {
        let mut wires = Vec::new();
        for place in 0..self.comparisons.len() {
            let moves = &of.moves[place * self.count()..][..self.count()];
            let reach: i128 = moves.iter().map(|most| most.abs()).sum();
            let ahead = self.ahead(place, &of.right);
            let can_turn = if ahead < 0 { ahead + reach >= 0 } else { ahead - reach < 0 };
            if can_turn {
                let towards = if ahead < 0 { places } else { -places };
                self.other(ports, &|number| moves[number].signum() as i64 * towards, places, &mut wires, see);
            }
        }
        for design in 0..SCATTERED {
            self.other(ports, &|number| scattered(design, number, places), places, &mut wires, see);
        }
    }

    /// Shows `see` the wires of a design, and each rounding alone there if the outcome differs.
    fn other(
        &self,
        ports: &[i64],
        change: &impl Fn(usize) -> i64,
        places: i64,
        wires: &mut Vec<i64>,
        see: &mut impl FnMut(Change, &[i64]) -> bool,
    ) {
        self.wires(ports, change, wires);
        if see(Change::Together, wires) {
            self.each_alone_in(ports, change, wires, places, &mut |number, _, wires| {
                see(Change::Alone(number), wires);
            });
        }
    }

    /// Shows `see` the wires of designs in which one rounding is `places` last places more, then less, and the others follow `change`. `wires` are
    /// those in which all follow `change`.
    fn each_alone_in(
        &self,
        ports: &[i64],
        change: &impl Fn(usize) -> i64,
        wires: &[i64],
        places: i64,
        see: &mut impl FnMut(usize, i64, &[i64]),
    ) {
        let (mut theirs, mut differing) = (wires.to_vec(), Vec::new());
        let mut waiting = Waiting::new(wires.len());
        for (number, rounding) in self.roundings.iter().enumerate() {
            for places in [places, -places] {
                let node = rounding.node as usize;
                theirs[node] = self.wire(rounding.node, ports, |_| places, &theirs);
                if theirs[node] == wires[node] {
                    continue;
                }
                differing.push(node);
                self.readers[node].iter().for_each(|&reader| waiting.add(reader));
                while let Some(id) = waiting.first() {
                    let place = id as usize;
                    theirs[place] = self.wire(id, ports, change, &theirs);
                    if theirs[place] != wires[place] {
                        differing.push(place);
                        self.readers[place].iter().for_each(|&reader| waiting.add(reader));
                    }
                }
                see(number, places, &theirs);
                differing.drain(..).for_each(|place| theirs[place] = wires[place]);
            }
        }
    }

    /// Wire of a design whose rounding of each number is `change` last places more, from the earlier wires.
    fn wire(&self, id: NodeId, ports: &[i64], change: impl Fn(usize) -> i64, before: &[i64]) -> i64 {
        let value = self.net.value(id, ports, before);
        match self.number[id as usize] {
            Some(number) => self.roundings[number].changed(value, change(number)),
            None => value,
        }
    }

    /// Difference a − b of a comparison.
    fn ahead(&self, place: usize, wires: &[i64]) -> i128 {
        let [a, b] = self.comparisons[place];
        i128::from(wires[a as usize]) - i128::from(wires[b as usize])
    }
}

impl Rounding {
    /// Integer with this many last places more, clamped to its range.
    fn changed(&self, value: i64, places: i64) -> i64 {
        if places == 0 { value } else { (value + places).clamp(self.low, self.high) }
    }
}

/// Pseudorandom −`places` … `places`, spread evenly over the numbers.
pub fn scattered(design: u64, number: usize, places: i64) -> i64 {
    let mixed = (design << 32 | number as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 33) as i64 % (2 * places + 1) - places
}

impl Net {
    /// True if a node is ⌊x + ½⌋ in units of its last place: ⌊(2x + 1)/2⌋, as every backend rounds.
    fn is_rounded(&self, id: NodeId) -> bool {
        let Op::Sar(sum, 1) = self.node(id).op else { return false };
        matches!(self.node(sum).op, Op::Add(_, one) if self.node(one).op == Op::Lit(1))
    }
}
