//! A netlist under construction: the recorded backend adds operations one by one.
//!
//! Within a stage equal operations are one node. Stages share nothing, so a stage is the same hardware wherever it is used. Operations on constants
//! and those that change nothing are folded as they come.

use std::cell::RefCell;
use std::collections::HashMap;
use std::panic::Location;

use roughxel_core::bundle::Step;

use super::evaluate::apply_exactly;
use super::graph::{Kind, Net, Node, NodeId, Op, Port, Run, Tap};

/// Key under which equal operations are one node: operation, kind, stage.
type Key = (Op, Kind, Option<u32>);

/// A netlist under construction.
#[derive(Default)]
struct Builder {
    net: Net,
    known: HashMap<Key, NodeId>,
    stage: Option<u32>,
    part: Option<u32>,
    parts: u32,
}

thread_local! {
    static BUILDER: RefCell<Option<Builder>> = const { RefCell::new(None) };
}

/// Runs `work` on the netlist that this thread builds.
fn built<T>(work: impl FnOnce(&mut Builder) -> T) -> T {
    BUILDER.with_borrow_mut(|builder| work(builder.as_mut().expect("a netlist was begun before its nodes are made")))
}

impl Builder {
    fn lit_of(&self, id: NodeId) -> Option<i64> {
        match self.net.node(id).op {
            Op::Lit(value) => Some(value),
            _ => None,
        }
    }

    /// Node that an operation folds to, or the operation that needs a node.
    fn folded(&self, op: &Op, kind: Kind) -> Result<NodeId, Op> {
        let lit = |id| self.lit_of(id);
        let is = |id, value| lit(id) == Some(value);
        match *op {
            Op::Lit(_) | Op::Port(_) => Err(*op),
            Op::Select(flag, a, b) => match lit(flag) {
                Some(0) => Ok(b),
                Some(_) => Ok(a),
                None if a == b => Ok(a),
                None => Err(*op),
            },
            _ if op.operands().all(|id| lit(id).is_some()) => {
                // An operation that would leave its wire stays, so that the interval walk finds it.
                let value = apply_exactly(*op, kind, |id| self.net.node(id).kind, |id| lit(id).unwrap_or(0));
                Err(value.map_or(*op, Op::Lit))
            }
            Op::Add(a, b) if is(b, 0) => Ok(a),
            Op::Add(a, b) if is(a, 0) => Ok(b),
            Op::Sub(a, b) if is(b, 0) => Ok(a),
            Op::Sub(a, b) if a == b => Err(Op::Lit(0)),
            Op::Mul(a, b) if is(a, 0) || is(b, 0) => Err(Op::Lit(0)),
            Op::Shl(a, 0) | Op::Sar(a, 0) => Ok(a),
            Op::ShlBy(a, k) | Op::SarBy(a, k) if is(k, 0) || is(a, 0) => Ok(a),
            Op::ShlBy(a, k) => lit(k).map_or(Err(*op), |k| Err(Op::Shl(a, k as u32))),
            Op::SarBy(a, k) => lit(k).map_or(Err(*op), |k| Err(Op::Sar(a, k as u32))),
            Op::And(a, b) if a == b => Ok(a),
            Op::And(a, b) if is(a, 0) || is(b, 0) => Err(Op::Lit(0)),
            Op::And(a, b) if kind == Kind::Flag && is(b, 1) => Ok(a),
            Op::And(a, b) if kind == Kind::Flag && is(a, 1) => Ok(b),
            Op::Or(a, b) if a == b || is(b, 0) => Ok(a),
            Op::Or(a, b) if is(a, 0) => Ok(b),
            Op::Or(a, b) if kind == Kind::Flag && (is(a, 1) || is(b, 1)) => Err(Op::Lit(1)),
            Op::Xor(a, b) if is(b, 0) => Ok(a),
            Op::Xor(a, b) if is(a, 0) => Ok(b),
            Op::Xor(a, b) if a == b => Err(Op::Lit(0)),
            Op::Lt(a, b) if a == b => Err(Op::Lit(0)),
            Op::Not(a) => match self.net.node(a).op {
                Op::Not(inner) => Ok(inner),
                _ => Err(*op),
            },
            // A word that is widened and narrowed again.
            Op::Narrow(a) => match self.net.node(a).op {
                Op::Widen(inner) if self.net.node(inner).kind == kind => Ok(inner),
                _ => Err(*op),
            },
            _ => Err(*op),
        }
    }

    fn node(&mut self, op: Op, kind: Kind, at: &'static Location<'static>) -> NodeId {
        let op = match self.folded(&op, kind) {
            Ok(id) => return id,
            Err(op) => op,
        };
        let stage = if matches!(op, Op::Lit(_) | Op::Port(_)) { None } else { self.stage };
        if let Some(&id) = self.known.get(&(op, kind, stage)) {
            return id;
        }
        let id = self.net.nodes.len() as NodeId;
        let part = stage.and(self.part);
        self.net.nodes.push(Node { op, kind, stage, part, at });
        self.known.insert((op, kind, stage), id);
        id
    }
}

/// Begins a netlist without nodes, in place of an unfinished one.
pub fn begin() {
    BUILDER.set(Some(Builder::default()));
}

/// Ends the netlist with its outputs, and drops nodes that nobody reads.
pub fn end(outputs: Vec<NamedWire>) -> Net {
    let mut net = BUILDER.take().unwrap_or_default().net;
    net.outputs = outputs.into_iter().map(|wire| wire.tap(None)).collect();
    net.without_dead_wires()
}

/// Node of an operation, at the caller's line of the source.
#[track_caller]
pub fn node(op: Op, kind: Kind) -> NodeId {
    let at = Location::caller();
    built(|builder| builder.node(op, kind, at))
}

/// Node of an input that holds `low ..= high`.
#[track_caller]
pub fn port(path: Vec<Step>, kind: Kind, mantissa: bool, fraction_bits: u32, (low, high): (i64, i64)) -> NodeId {
    let at = Location::caller();
    built(|builder| {
        let number = builder.net.ports.len() as u32;
        let node = builder.node(Op::Port(number), kind, at);
        let name = path_name(&path);
        builder.net.ports.push(Port { name, path, kind, mantissa, fraction_bits, low, high, zeros: 0, node });
        node
    })
}

/// Begins a stage: nodes belong to it until `leave`. Stages do not nest.
pub fn enter(name: &'static str) {
    built(|builder| {
        let runs = &mut builder.net.runs;
        let run = runs.iter().filter(|stage| stage.name == name).count() as u32;
        runs.iter_mut().filter(|stage| stage.name == name).for_each(|stage| stage.repeated = true);
        builder.stage = Some(runs.len() as u32);
        runs.push(Run { name, run, repeated: run > 0 });
    });
}

/// Ends a stage and taps its outcome.
pub fn leave(outcome: Vec<NamedWire>) {
    built(|builder| {
        let stage = builder.stage.take();
        builder.net.taps.extend(outcome.into_iter().map(|wire| wire.tap(stage)));
    });
}

/// Runs `body` as a compound step: its operations are one part of the stage, which hardware may share with equal parts. Parts do not nest.
pub fn part<T>(body: impl FnOnce() -> T) -> T {
    built(|builder| {
        builder.part = Some(builder.parts);
        builder.parts += 1;
    });
    let outcome = body();
    built(|builder| builder.part = None);
    outcome
}

/// Path as text: `e1.m[0]`.
fn path_name(path: &[Step]) -> String {
    path.iter().fold(String::new(), |name, step| match step {
        Step::Field(field) if name.is_empty() => field.name.to_owned(),
        Step::Field(field) => format!("{name}.{}", field.name),
        Step::Index(index) => format!("{name}[{index}]"),
    })
}

/// A wire of a bundle and its path.
pub struct NamedWire {
    /// Steps to the wire.
    pub path: Vec<Step>,
    /// Node of the wire.
    pub node: NodeId,
    /// True if it carries a mantissa.
    pub mantissa: bool,
    /// Bits after its binary point.
    pub fraction_bits: u32,
}

impl NamedWire {
    fn tap(self, stage: Option<u32>) -> Tap {
        let Self { path, node, mantissa, fraction_bits } = self;
        Tap { stage, name: path_name(&path), path, mantissa, fraction_bits, node }
    }
}
