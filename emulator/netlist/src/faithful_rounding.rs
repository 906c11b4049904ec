//! Faithful rounding: accepted values of a design whose reciprocals and inverse roots come from a different divider or root. Each of them is at most
//! one last place away from the recorded one.
//!
//! Outcomes are checked in the order of the pipeline, each with the answer if the device's value is right. After each outcome only the choices of
//! neighbours that lead to the device's value are kept, and choices that later operations cannot tell apart are merged. So outcomes of every stage
//! leave few choices at a time, and the check of a device is exact: some choice of neighbours gives all of its values, or none does.

use std::collections::HashSet;

use roughxel_core::rom;

use super::graph::{Kind, Net, NodeId, Op, Table};

/// Most choices of neighbours that are followed at once: six independent ones (3⁶).
pub const MOST_CHOICES: usize = 729;

/// Bits of the smallest and the largest seed table.
const SEED_BITS: std::ops::RangeInclusive<u32> = 6..=10;

/// A reciprocal or an inverse root: its outcome is 1/2x or 1/2√x in [½, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// Wire of the outcome.
    pub node: NodeId,
    /// Integer of one.
    pub one: i64,
    /// Last place that the profile keeps.
    pub last_place: i64,
}

impl Primitive {
    /// Accepted values of a primitive: the value itself first, then its neighbours in [½, 1].
    fn choices(self, value: i64) -> impl Iterator<Item = i64> {
        let neighbours = [value - self.last_place, value + self.last_place];
        [value].into_iter().chain(neighbours.into_iter().filter(move |y| (self.one / 2..=self.one).contains(y)))
    }
}

impl Net {
    /// Every reciprocal and inverse root under `fraction_bits` of the profile, in the order of their outcomes.
    ///
    /// Each begins with a seed from its table and ends with the minimum of its last step and 1.
    pub fn primitives(&self, fraction_bits: u32) -> Vec<Primitive> {
        let is_seed = |table: Table| {
            SEED_BITS
                .flat_map(|bits| [rom::reciprocal(bits), rom::inverse_root(bits)])
                .any(|seeds| std::ptr::eq(seeds, table.entries))
        };
        let seeds = self.iter().filter(|(_, node)| matches!(node.op, Op::Lookup(_, table) if is_seed(table)));
        let mut primitives: Vec<Primitive> =
            seeds.filter_map(|(seed, node)| self.primitive(seed, node.kind, fraction_bits)).collect();
        primitives.sort_by_key(|primitive| primitive.node);
        primitives.dedup();
        primitives
    }

    /// Primitive that begins with this seed.
    fn primitive(&self, seed: NodeId, kind: Kind, fraction_bits: u32) -> Option<Primitive> {
        let fraction = kind.bits() - 2;
        let one = 1 << fraction;
        let is_one = |id: NodeId| matches!(self.node(id).op, Op::Lit(value) if value == one);
        let mut follows = HashSet::from([seed]);
        for id in seed + 1..self.nodes.len() as NodeId {
            let op = self.node(id).op;
            if !op.operands().any(|operand| follows.contains(&operand)) {
                continue;
            }
            follows.insert(id);
            if let Op::Select(flag, y, limit) = op
                && self.node(id).kind == kind
                && is_one(limit)
                && matches!(self.node(flag).op, Op::Lt(a, b) if a == y && is_one(b))
            {
                return Some(Primitive { node: id, one, last_place: 1 << fraction.saturating_sub(fraction_bits) });
            }
        }
        None
    }
}

/// Verdict on a device's outcomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Some choice of neighbours gives all outcomes.
    Right,
    /// No choice that gives the earlier outcomes gives this one.
    Wrong {
        /// Place of the outcome in the list of outcomes.
        place: usize,
        /// Expected value, with as few neighbours as the earlier outcomes allow.
        value: i64,
    },
    /// More choices than [`MOST_CHOICES`] are left before this outcome.
    TooMany {
        /// Place of the outcome.
        place: usize,
    },
}

/// A design and the order in which its outcomes are checked.
#[derive(Clone, Debug)]
pub struct Neighbours<'a> {
    net: &'a Net,
    primitives: Vec<Option<Primitive>>,
    questions: Vec<Question>,
}

/// One outcome.
#[derive(Clone, Debug)]
struct Question {
    node: NodeId,
    /// Nodes that this outcome needs and no earlier one does, in their order.
    needs: Vec<NodeId>,
    /// Nodes up to this outcome that depend on a choice and are read later.
    live: Vec<NodeId>,
}

impl<'a> Neighbours<'a> {
    /// Checker of a design. Outcomes are checked in the order of `outcomes`; `fraction_bits` is that of the profile.
    pub fn new(net: &'a Net, outcomes: &[NodeId], fraction_bits: u32) -> Self {
        let mut primitives = vec![None; net.nodes.len()];
        for primitive in net.primitives(fraction_bits) {
            primitives[primitive.node as usize] = Some(primitive);
        }
        // Nodes that depend on a choice, and the questions by which a node is computed and last read.
        let mut varies = vec![false; net.nodes.len()];
        for (id, node) in net.iter() {
            let of_operands = node.op.operands().any(|operand| varies[operand as usize]);
            varies[id as usize] = of_operands || primitives[id as usize].is_some();
        }
        let mut computed = vec![usize::MAX; net.nodes.len()];
        let mut last_read = vec![0; net.nodes.len()];
        let mut questions: Vec<Question> = Vec::with_capacity(outcomes.len());
        for (place, &node) in outcomes.iter().enumerate() {
            let (mut needs, mut waiting) = (Vec::new(), vec![node]);
            last_read[node as usize] = place;
            while let Some(id) = waiting.pop() {
                if computed[id as usize] == usize::MAX {
                    computed[id as usize] = place;
                    needs.push(id);
                    for operand in net.node(id).op.operands() {
                        last_read[operand as usize] = place;
                        waiting.push(operand);
                    }
                }
            }
            needs.sort_unstable();
            questions.push(Question { node, needs, live: Vec::new() });
        }
        for (id, varies) in (0..).zip(varies) {
            let (from, to) = (computed[id as usize], last_read[id as usize]);
            if varies && from < to {
                questions[from..to].iter_mut().for_each(|question| question.live.push(id));
            }
        }
        Self { net, primitives, questions }
    }

    /// Checks a device. `ports` are its integers, and `is_right` answers if an integer is the device's value of the outcome at that place.
    pub fn judge(&self, ports: &[i64], is_right: impl Fn(usize, i64) -> bool) -> Verdict {
        let mut choices = vec![vec![0; self.net.nodes.len()]];
        for (place, question) in self.questions.iter().enumerate() {
            for &id in &question.needs {
                for wires in &mut choices {
                    wires[id as usize] = self.net.value(id, ports, wires);
                }
                let Some(primitive) = self.primitives[id as usize] else { continue };
                let mut more = Vec::new();
                for wires in choices {
                    for value in primitive.choices(wires[id as usize]) {
                        more.push(wires.clone());
                        if let Some(wires) = more.last_mut() {
                            wires[id as usize] = value;
                        }
                    }
                    if more.len() > MOST_CHOICES {
                        return Verdict::TooMany { place };
                    }
                }
                choices = more;
            }
            // The first choice has the fewest neighbours.
            let value = choices[0][question.node as usize];
            choices.retain(|wires| is_right(place, wires[question.node as usize]));
            if choices.is_empty() {
                return Verdict::Wrong { place, value };
            }
            let mut seen = HashSet::new();
            choices.retain(|wires| seen.insert(question.live.iter().map(|&id| wires[id as usize]).collect::<Vec<_>>()));
        }
        Verdict::Right
    }
}
