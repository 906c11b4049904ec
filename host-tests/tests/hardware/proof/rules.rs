//! The rules of the interval walk against brute force: small graphs, every value of every port.

use std::cell::Cell;
use std::panic::Location;

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use roughxel_core::rom;
use roughxel_netlist::evaluate::apply_exactly;
use roughxel_netlist::fault::{Effect, Fault, Faults, Simulator};
use roughxel_netlist::graph::{Kind, Net, Node, NodeId, Op, Port, Table, Tap};
use roughxel_netlist::interval::Ranges;
use roughxel_netlist::redundant_faults::Prover;
use roughxel_netlist::table_check::{Exhaustion, Task};

/// A small net under construction, with its wires by kind.
#[derive(Default)]
struct Small {
    net: Net,
    words: Vec<NodeId>,
    wides: Vec<NodeId>,
    flags: Vec<NodeId>,
}

impl Small {
    /// A net from ports with these limits, and `steps`.
    fn grown(ports: impl Iterator<Item = (i64, i64)>, steps: Vec<(u8, [u16; 3])>) -> Self {
        let mut small = Self::default();
        for (low, high) in ports {
            small.port(low, high);
        }
        steps.into_iter().for_each(|(code, pick)| small.grow(code, pick));
        small
    }

    fn node(&mut self, op: Op, kind: Kind) -> NodeId {
        let id = self.net.nodes.len() as NodeId;
        self.net.nodes.push(Node { op, kind, stage: None, part: None, at: Location::caller() });
        match kind {
            Kind::Wire(32) => self.words.push(id),
            Kind::Wire(_) => self.wides.push(id),
            Kind::Flag => self.flags.push(id),
        }
        id
    }

    fn port(&mut self, low: i64, high: i64) -> NodeId {
        let number = self.net.ports.len() as u32;
        let node = self.node(Op::Port(number), Kind::Wire(32));
        let name = format!("p{number}");
        self.net.ports.push(Port {
            name,
            path: Vec::new(),
            kind: Kind::Wire(32),
            mantissa: false,
            fraction_bits: 0,
            low,
            high,
            zeros: 0,
            node,
        });
        node
    }

    fn lit(&mut self, value: i64, kind: Kind) -> NodeId {
        self.node(Op::Lit(value), kind)
    }

    /// `select(x < y, x, y)`, or the larger.
    fn smaller(&mut self, x: NodeId, y: NodeId, larger: bool) -> NodeId {
        let kind = self.net.node(x).kind;
        let flag = self.node(Op::Lt(x, y), Kind::Flag);
        self.node(if larger { Op::Select(flag, y, x) } else { Op::Select(flag, x, y) }, kind)
    }

    fn saturate(&mut self, x: NodeId, low: i64, high: i64) -> NodeId {
        let kind = self.net.node(x).kind;
        let (low, high) = (self.lit(low, kind), self.lit(high, kind));
        let above = self.smaller(x, low, true);
        self.smaller(above, high, false)
    }

    fn absolute(&mut self, x: NodeId) -> NodeId {
        let kind = self.net.node(x).kind;
        let zero = self.lit(0, kind);
        let flag = self.node(Op::Lt(x, zero), Kind::Flag);
        let negated = self.node(Op::Sub(zero, x), kind);
        self.node(Op::Select(flag, negated, x), kind)
    }

    fn magnitude(&mut self, x: NodeId) -> NodeId {
        let kind = self.net.node(x).kind;
        let sign = self.node(Op::Sar(x, kind.bits() - 1), kind);
        self.node(Op::Xor(x, sign), kind)
    }

    /// Adds one operation, or one of the patterns; `pick` chooses operands and constants.
    fn grow(&mut self, code: u8, pick: [u16; 3]) {
        let one_of = |list: &[NodeId], pick: u16| list[usize::from(pick) % list.len()];
        let wide = pick[2] % 2 == 1 && !self.wides.is_empty();
        let kind = if wide { Kind::Wire(64) } else { Kind::Wire(32) };
        let list = if wide { &self.wides } else { &self.words };
        let (a, b) = (one_of(list, pick[0]), one_of(list, pick[1]));
        let [x, y, z] = pick.map(|pick| one_of(&self.words, pick));
        let flags = (!self.flags.is_empty()).then(|| pick.map(|pick| one_of(&self.flags, pick)));
        let places = u32::from(pick[1] % 5);
        match code {
            0 => self.lit(i64::from(pick[0] as i16) >> (pick[1] % 16), kind),
            1 => self.node(Op::Add(a, b), kind),
            2 => self.node(Op::Sub(a, b), kind),
            3 => self.node(Op::Mul(x, y), Kind::Wire(64)),
            4 => self.node(Op::Shl(a, places), kind),
            5 => self.node(Op::Sar(a, places), kind),
            6 | 7 => {
                let count = self.saturate(y, 0, i64::from(places));
                self.node(if code == 6 { Op::ShlBy(a, count) } else { Op::SarBy(a, count) }, kind)
            }
            8 => self.node(Op::And(a, b), kind),
            9 => self.node(Op::Or(a, b), kind),
            10 => self.node(Op::Xor(a, b), kind),
            11 => self.node(Op::Lt(a, b), Kind::Flag),
            12 => self.node(Op::LeadingZeros(a), Kind::Wire(32)),
            13 => self.node(Op::Widen(x), Kind::Wire(64)),
            14 if wide => self.node(Op::Narrow(a), Kind::Wire(32)),
            15 => self.smaller(a, b, pick[2] % 4 < 2),
            16 => self.absolute(a),
            17 => self.magnitude(a),
            18 => {
                let shifted = self.node(Op::Sar(a, places), kind);
                let whole = self.node(Op::Shl(shifted, places), kind);
                self.node(Op::Sub(a, whole), kind)
            }
            19 => {
                // Block normalisation of two wires.
                let [m, n] = [a, b].map(|of| self.magnitude(of));
                let either = self.node(Op::Or(m, n), kind);
                let zeros = self.node(Op::LeadingZeros(either), Kind::Wire(32));
                let one = self.lit(1, Kind::Wire(32));
                let count = self.node(Op::Sub(zeros, one), Kind::Wire(32));
                self.node(Op::ShlBy(a, count), kind);
                self.node(Op::ShlBy(b, count), kind)
            }
            20 => {
                // Interpolation with weights w and 8 − w.
                let weight = self.saturate(z, 0, 8);
                let eight = self.lit(8, Kind::Wire(32));
                let rest = self.node(Op::Sub(eight, weight), Kind::Wire(32));
                let (first, second) =
                    (self.node(Op::Mul(x, weight), Kind::Wire(64)), self.node(Op::Mul(rest, y), Kind::Wire(64)));
                self.node(Op::Add(first, second), Kind::Wire(64))
            }
            21 => {
                // Two entries of a table, including indices beyond its ends.
                let index = self.saturate(x, i64::from(pick[1] % 3) - 1, 20);
                let step = self.lit(i64::from(pick[2] % 4), Kind::Wire(32));
                let upper = self.node(Op::Add(index, step), Kind::Wire(32));
                let table = Table { entries: &rom::LOG2, bits: 32 };
                let [next, entry] = [upper, index].map(|index| self.node(Op::Lookup(index, table), Kind::Wire(32)));
                self.node(Op::Sub(next, entry), Kind::Wire(32))
            }
            22 => {
                // x if |x| ≤ y, otherwise z.
                let (size, limit) = (self.absolute(x), self.absolute(y));
                let above = self.node(Op::Lt(limit, size), Kind::Flag);
                let inside = self.node(Op::Not(above), Kind::Flag);
                self.node(Op::Select(inside, x, z), Kind::Wire(32))
            }
            23 => {
                let Some([flag, ..]) = flags else { return };
                self.node(Op::Select(flag, a, b), kind)
            }
            _ => {
                let Some([f, g, h]) = flags else { return };
                let not = self.node(Op::Not(f), Kind::Flag);
                let and = self.node(Op::And(not, g), Kind::Flag);
                let or = self.node(Op::Or(and, h), Kind::Flag);
                self.node(Op::Select([and, or][usize::from(pick[2] % 2)], a, b), kind)
            }
        };
    }
}

/// Evaluates a net for every combination of port values.
fn for_every_input(net: &Net, mut look: impl FnMut(&[i64], &[i64])) {
    let mut ports: Vec<_> = net.ports.iter().map(|port| port.low).collect();
    let mut wires = Vec::new();
    loop {
        net.evaluate(&ports, &mut wires);
        look(&ports, &wires);
        // The next combination, the first port fastest.
        let next = net.ports.iter().zip(&mut ports).find_map(|(port, value)| {
            let more = *value < port.high;
            *value = if more { *value + 1 } else { port.low };
            more.then_some(())
        });
        if next.is_none() {
            return;
        }
    }
}

/// Many graphs, the same every time.
fn config(seed: u64) -> ProptestConfig {
    let rng_seed = RngSeed::Fixed(seed);
    ProptestConfig { cases: 20_000, failure_persistence: None, rng_seed, ..Default::default() }
}

proptest! {
    #![proptest_config(config(11))]

    #[test]
    fn no_input_leaves_the_range_of_any_wire_of_any_small_graph(
        ports in prop::collection::vec((-40_i64..40, 0_i64..6), 1..4),
        steps in prop::collection::vec((0_u8..25, any::<[u16; 3]>()), 1..16),
    ) {
        let net = Small::grown(ports.into_iter().map(|(low, extent)| (low, low + extent)), steps).net;
        let ranges = Ranges::new(&net);
        // Wires after an operation that overflows may hold anything.
        let sound = ranges.violations.first().map_or(net.nodes.len(), |violation| violation.node as usize);
        for_every_input(&net, |ports, wires| {
            for (id, &value) in (0..).zip(&wires[..sound]) {
                let range = ranges.of(id);
                let multiple = value.trailing_zeros() >= range.zeros || value == 0;
                assert!(
                    range.low <= value && value <= range.high && multiple,
                    "node {id} is {value}, proven {range} with {} zeros, for {ports:?} of {:#?}", range.zeros, net.nodes
                );
            }
        });
    }

    #[test]
    fn an_operation_that_is_said_to_fit_fits(
        ports in prop::collection::vec((any::<i32>(), 0_i64..3), 2..4),
        steps in prop::collection::vec((0_u8..25, any::<[u16; 3]>()), 1..10),
    ) {
        // Words near their ends: values that pass the proof must be exact.
        let limits = |(low, extent): (i32, i64)| (low.into(), (i64::from(low) + extent).min(i32::MAX.into()));
        let net = Small::grown(ports.into_iter().map(limits), steps).net;
        let ranges = Ranges::new(&net);
        let sound = ranges.violations.first().map_or(net.nodes.len(), |violation| violation.node as usize);
        for_every_input(&net, |_, wires| {
            for (id, node) in net.nodes.iter().enumerate().take(sound) {
                let kind_of = |id| net.node(id).kind;
                let exact = apply_exactly(node.op, node.kind, kind_of, |id| wires[id as usize]);
                if !matches!(node.op, Op::Port(_)) {
                    assert_eq!(exact, Some(wires[id]), "node {id} of {:#?}", net.nodes);
                }
            }
        });
    }
}

#[test]
fn the_range_of_one_operation_is_exactly_what_occurs() {
    let spans = [(-5, 6), (-9, -2), (3, 8), (0, 7), (-1, 0), (4, 4)];
    let operations: [fn(&mut Small, NodeId, NodeId) -> NodeId; 12] = [
        |net, a, b| net.node(Op::Add(a, b), Kind::Wire(32)),
        |net, a, b| net.node(Op::Sub(a, b), Kind::Wire(32)),
        |net, a, b| net.node(Op::Mul(a, b), Kind::Wire(64)),
        |net, a, _| net.node(Op::Shl(a, 3), Kind::Wire(32)),
        |net, a, _| net.node(Op::Sar(a, 2), Kind::Wire(32)),
        |net, a, b| net.node(Op::Lt(a, b), Kind::Flag),
        |net, a, _| net.node(Op::LeadingZeros(a), Kind::Wire(32)),
        |net, a, b| net.smaller(a, b, false),
        |net, a, b| net.smaller(a, b, true),
        |net, a, _| net.saturate(a, -3, 4),
        Small::magnitude_of_two,
        Small::absolute_of_two,
    ];
    for (index, operation) in operations.iter().enumerate() {
        for a in spans {
            for b in spans {
                let mut small = Small::default();
                let (a, b) = (small.port(a.0, a.1), small.port(b.0, b.1));
                let outcome = operation(&mut small, a, b);
                let (mut low, mut high) = (i64::MAX, i64::MIN);
                for_every_input(&small.net, |_, wires| {
                    let value = wires[outcome as usize];
                    (low, high) = (low.min(value), high.max(value));
                });
                let range = Ranges::new(&small.net).of(outcome);
                assert_eq!((range.low, range.high), (low, high), "operation {index} of {:?}", small.net.ports);
            }
        }
    }
}

impl Small {
    fn magnitude_of_two(&mut self, a: NodeId, _: NodeId) -> NodeId {
        self.magnitude(a)
    }

    fn absolute_of_two(&mut self, a: NodeId, _: NodeId) -> NodeId {
        self.absolute(a)
    }
}

fn tap(node: NodeId) -> Tap {
    Tap { stage: None, name: "outcome".into(), path: Vec::new(), mantissa: false, fraction_bits: 0, node }
}

/// Entries that make no difference for any value of their index.
fn equal_entries(faults: &Faults) -> Vec<Fault> {
    let shown = |exhaustion: &Exhaustion, tasks: &[Task]| {
        let mut wires = exhaustion.wires();
        tasks.iter().flat_map(|task| exhaustion.shown(task, &mut wires)).collect()
    };
    Exhaustion::new(faults, faults.faults.iter().copied()).equal(&shown).into_iter().collect()
}

/// Counts the operations and table entries that are reported to make no difference, in a net whose last wire is the visible field. Each is tried on
/// every input.
fn equal_faults_of(small: Small) -> [usize; 2] {
    let mut net = small.net;
    let last = net.nodes.len() as NodeId - 1;
    net.outputs = vec![tap(last)];
    let ranges = Ranges::new(&net);
    let faults = Faults::new(&net, &ranges, [(last, u64::MAX)]);
    let mut prover = Prover::new(&faults);
    let is_equal = |fault: &Fault| prover.is_equal(*fault);
    let mut equal: Vec<Fault> = faults.faults.iter().copied().filter(is_equal).collect();
    equal.extend(equal_entries(&faults));
    let entries = equal.iter().filter(|fault| matches!(fault, Fault::Entry { .. })).count();
    let mut simulator = Simulator::new(&faults);
    for_every_input(&net, |ports, wires| {
        for &fault in &equal {
            let effect = simulator.effect(fault, wires);
            assert!(effect != Effect::Seen, "{} is shown by {ports:?} in {:#?}", faults.text(fault), net.nodes);
        }
    });
    [equal.len() - entries, entries]
}

/// Proven equivalences hold, and most of the faults that no input shows are proven equivalent.
#[test]
fn no_input_of_any_small_graph_shows_an_operation_or_an_entry_that_is_proven_equal() {
    let mut runner = TestRunner::new(config(12));
    let ports = prop::collection::vec((-40_i64..40, 0_i64..6), 1..4);
    let steps = prop::collection::vec((0_u8..25, any::<[u16; 3]>()), 1..16);
    let proven = Cell::new([0; 2]);
    let outcome = runner.run(&(ports, steps), |(ports, steps)| {
        let small = Small::grown(ports.into_iter().map(|(low, extent)| (low, low + extent)), steps);
        let equal = equal_faults_of(small);
        proven.set([0, 1].map(|kind| proven.get()[kind] + equal[kind]));
        Ok(())
    });
    outcome.expect("equal operations and entries");
    assert!(proven.get().iter().all(|&proven| proven > 1000), "{:?}", proven.get());
}

/// Tables whose index has few values and is joined by other wires after a rounding: exactly the faults that no value shows are proven.
#[test]
fn of_a_function_of_one_wire_every_entry_is_proven_that_no_value_shows() {
    let word = Kind::Wire(32);
    let mut unseen_of = Vec::new();
    for cut in [0, 3, 6, 9, 12] {
        // log₂ of 1 + x/128, four steps between entries, with `cut` fewer bits, next to a different number.
        let mut small = Small::default();
        let (x, y) = (small.port(0, 127), small.port(-3, 3));
        let [one, rest_bits] = [1, 3].map(|value| small.lit(value, word));
        let index = small.node(Op::Sar(x, 2), word);
        let upper = small.node(Op::Add(index, one), word);
        let table = Table { entries: &rom::LOG2, bits: 32 };
        let [knot, next] = [index, upper].map(|index| small.node(Op::Lookup(index, table), word));
        let rest = small.node(Op::And(x, rest_bits), word);
        let rise = small.node(Op::Sub(next, knot), word);
        let rise = small.node(Op::Mul(rise, rest), Kind::Wire(64));
        let knot = small.node(Op::Widen(knot), Kind::Wire(64));
        let knot = small.node(Op::Shl(knot, 2), Kind::Wire(64));
        let sum = small.node(Op::Add(knot, rise), Kind::Wire(64));
        let sum = small.node(Op::Sar(sum, 2 + cut), Kind::Wire(64));
        let sum = small.node(Op::Narrow(sum), word);
        let last = small.node(Op::Add(sum, y), word);
        let mut net = small.net;
        net.outputs = vec![tap(last)];
        let ranges = Ranges::new(&net);
        let faults = Faults::new(&net, &ranges, [(last, u64::MAX)]);
        let mut simulator = Simulator::new(&faults);
        let mut unseen: Vec<Fault> =
            faults.faults.iter().copied().filter(|fault| matches!(fault, Fault::Entry { .. })).collect();
        let all = unseen.len();
        for_every_input(&net, |_, wires| unseen.retain(|&fault| simulator.effect(fault, wires) != Effect::Seen));
        let mut equal = equal_entries(&faults);
        let text = |fault: &Fault| faults.text(*fault);
        equal.sort_by_key(text);
        unseen.sort_by_key(text);
        assert_eq!(equal, unseen, "{cut} bits less");
        assert_eq!(all, 66);
        unseen_of.push(unseen.len());
    }
    assert_eq!(unseen_of, [1, 47, 65, 65, 65]);
}

impl Small {
    /// Wires normalised together and rounded to `kept` bits, and a flag for each that is set if it is zero.
    fn normalised(&mut self, wires: &[NodeId], kept: u32) -> Vec<(NodeId, NodeId)> {
        let kind = Kind::Wire(32);
        let magnitudes: Vec<_> = wires.iter().map(|&wire| self.magnitude(wire)).collect();
        let mut all = magnitudes[0];
        for &magnitude in &magnitudes[1..] {
            all = self.node(Op::Or(all, magnitude), kind);
        }
        let (zero, one) = (self.lit(0, kind), self.lit(1, kind));
        let zeros = self.node(Op::LeadingZeros(all), kind);
        let count = self.node(Op::Sub(zeros, one), kind);
        let rounded = |&wire: &NodeId| {
            let shifted = self.node(Op::ShlBy(wire, count), kind);
            let cut = self.node(Op::Sar(shifted, 30 - kept), kind);
            let added = self.node(Op::Add(cut, one), kind);
            let rounded = self.node(Op::Sar(added, 1), kind);
            let below = self.node(Op::Lt(rounded, zero), Kind::Flag);
            let not_below = self.node(Op::Not(below), Kind::Flag);
            let not_above = self.node(Op::Lt(rounded, one), Kind::Flag);
            (rounded, self.node(Op::And(not_below, not_above), Kind::Flag))
        };
        wires.iter().map(rounded).collect()
    }
}

/// Zero stays zero through every shift and rounding: of wires that are normalised together one is large, unless all are zero.
#[test]
fn whether_wires_that_are_normalised_are_all_zero_is_proven_to_need_no_rounding() {
    for (ports, least) in [(vec![(-9, 12)], 6), (vec![(-9, 12), (-6, 5)], 12), (vec![(-4, 4), (-3, 5), (-5, 2)], 18)] {
        let mut small = Small::default();
        let wires: Vec<_> = ports.iter().map(|&(low, high)| small.port(low, high)).collect();
        let flags = small.normalised(&wires, 2);
        let mut all = flags[0].1;
        for &(_, flag) in &flags[1..] {
            all = small.node(Op::And(all, flag), Kind::Flag);
        }
        let [equal, _] = equal_faults_of(small);
        assert!(equal >= least, "{equal} operations of {ports:?}");
    }
}

/// A number with two bits after its highest one has nothing to round at four kept bits, and something at one.
#[test]
fn a_rounding_that_adds_nothing_is_proven_to_need_no_constant() {
    let equal = [4, 3, 2, 1].map(|kept| {
        let mut small = Small::default();
        let wire = small.port(0, 8);
        small.normalised(&[wire], kept);
        let rounded = small.net.nodes.iter().rposition(|node| matches!(node.op, Op::Sar(..))).expect("a rounding");
        // The last wire is the visible field.
        small.node(Op::Shl(rounded as NodeId, 1), Kind::Wire(32));
        equal_faults_of(small)[0]
    });
    assert!(equal[0] > equal[3], "{equal:?}");
}

#[test]
fn dropping_dead_wires_keeps_every_output() {
    let mut small = Small::default();
    let (a, b) = (small.port(-3, 4), small.port(0, 5));
    small.node(Op::Mul(a, a), Kind::Wire(64));
    let sum = small.node(Op::Add(a, b), Kind::Wire(32));
    let mut net = small.net;
    net.outputs = vec![tap(sum)];
    let live = net.clone().without_dead_wires();
    assert_eq!((net.nodes.len(), live.nodes.len()), (4, 3));
    let mut wires = Vec::new();
    for_every_input(&net, |ports, expected| {
        live.evaluate(ports, &mut wires);
        assert_eq!(wires[live.outputs[0].node as usize], expected[sum as usize]);
    });
}
