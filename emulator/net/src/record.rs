//! Recording: a reading whose words are nodes of a graph under construction.
//!
//! Within a stage equal operations are one node; between stages nothing is shared, so that a stage is the same
//! hardware wherever it is used. Operations on constants and those that change nothing are folded as they come.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{BitAnd, BitOr, Not};
use std::panic::Location;

use roughxel_core::bundle::{Bundle, End, Rewire, Step};
use roughxel_core::design::{Design, Form, In, Recorded, Visitor};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_core::staged::Staged;
use roughxel_core::word::{WideWire, Wire, Word};

use super::evaluate::apply_exactly;
use super::graph::{Kind, Net, Node, NodeId, Op, Port, Run, Table, Tap};

/// A word of the recorded reading.
#[derive(Clone, Copy, Debug)]
pub struct NetWord(NodeId);

/// A wide wire of the recorded reading.
#[derive(Clone, Copy, Debug)]
pub struct NetWide(NodeId);

/// A flag of the recorded reading.
#[derive(Clone, Copy, Debug)]
pub struct NetFlag(NodeId);

type Key = (Op, Kind, Option<u32>);

#[derive(Default)]
struct Recorder {
    net: Net,
    known: HashMap<Key, NodeId>,
    stage: Option<u32>,
}

thread_local! {
    static RECORDER: RefCell<Option<Recorder>> = const { RefCell::new(None) };
}

/// Runs `work` on the recorder of this thread. The words of this reading are made and used inside [`record`] only.
fn recorder<T>(work: impl FnOnce(&mut Recorder) -> T) -> T {
    RECORDER.with_borrow_mut(|recorder| work(recorder.as_mut().expect("wires of a net exist while it is recorded")))
}

impl Recorder {
    fn lit_of(&self, id: NodeId) -> Option<i64> {
        match self.net.node(id).op {
            Op::Lit(value) => Some(value),
            _ => None,
        }
    }

    /// The node an operation comes down to, if it needs none of its own.
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
                // What would leave the wire stays an operation, for the interval walk to find.
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
        self.net.nodes.push(Node { op, kind, stage, at });
        self.known.insert((op, kind, stage), id);
        id
    }
}

#[track_caller]
fn node(op: Op, kind: Kind) -> NodeId {
    let at = Location::caller();
    recorder(|recorder| recorder.node(op, kind, at))
}

impl Not for NetFlag {
    type Output = Self;
    #[track_caller]
    fn not(self) -> Self {
        Self(node(Op::Not(self.0), Kind::Flag))
    }
}

impl BitAnd for NetFlag {
    type Output = Self;
    #[track_caller]
    fn bitand(self, other: Self) -> Self {
        Self(node(Op::And(self.0, other.0), Kind::Flag))
    }
}

impl BitOr for NetFlag {
    type Output = Self;
    #[track_caller]
    fn bitor(self, other: Self) -> Self {
        Self(node(Op::Or(self.0, other.0), Kind::Flag))
    }
}

macro_rules! wire {
    ($name:ident, $kind:expr) => {
        impl Wire for $name {
            type Flag = NetFlag;
            type Count = NetWord;
            const BITS: u32 = $kind.bits();
            #[track_caller]
            fn lit(value: i64) -> Self {
                Self(node(Op::Lit(value), $kind))
            }
            #[track_caller]
            fn add(self, other: Self) -> Self {
                Self(node(Op::Add(self.0, other.0), $kind))
            }
            #[track_caller]
            fn sub(self, other: Self) -> Self {
                Self(node(Op::Sub(self.0, other.0), $kind))
            }
            #[track_caller]
            fn shl(self, k: u32) -> Self {
                Self(node(Op::Shl(self.0, k), $kind))
            }
            #[track_caller]
            fn sar(self, k: u32) -> Self {
                Self(node(Op::Sar(self.0, k), $kind))
            }
            #[track_caller]
            fn shl_by(self, k: NetWord) -> Self {
                Self(node(Op::ShlBy(self.0, k.0), $kind))
            }
            #[track_caller]
            fn sar_by(self, k: NetWord) -> Self {
                Self(node(Op::SarBy(self.0, k.0), $kind))
            }
            #[track_caller]
            fn and(self, other: Self) -> Self {
                Self(node(Op::And(self.0, other.0), $kind))
            }
            #[track_caller]
            fn or(self, other: Self) -> Self {
                Self(node(Op::Or(self.0, other.0), $kind))
            }
            #[track_caller]
            fn xor(self, other: Self) -> Self {
                Self(node(Op::Xor(self.0, other.0), $kind))
            }
            #[track_caller]
            fn lt(self, other: Self) -> NetFlag {
                NetFlag(node(Op::Lt(self.0, other.0), Kind::Flag))
            }
            #[track_caller]
            fn select(flag: NetFlag, a: Self, b: Self) -> Self {
                Self(node(Op::Select(flag.0, a.0, b.0), $kind))
            }
            #[track_caller]
            fn leading_zeros(self) -> NetWord {
                NetWord(node(Op::LeadingZeros(self.0), Kind::Word))
            }
            #[track_caller]
            fn claim(self, low: i64, high: i64, lemma: &'static str) -> Self {
                Self(node(Op::Claim { of: self.0, low, high, lemma }, $kind))
            }
        }
    };
}

wire!(NetWord, Kind::Word);
wire!(NetWide, Kind::Wide);

impl Word for NetWord {
    type Wide = NetWide;
    #[track_caller]
    fn mul(self, other: Self) -> NetWide {
        NetWide(node(Op::Mul(self.0, other.0), Kind::Wide))
    }
    #[track_caller]
    fn widen(self) -> NetWide {
        NetWide(node(Op::Widen(self.0), Kind::Wide))
    }
    #[track_caller]
    fn narrow(wide: NetWide) -> Self {
        Self(node(Op::Narrow(wide.0), Kind::Word))
    }
    #[track_caller]
    fn lookup(index: Self, table: &'static [i32]) -> Self {
        Self(node(Op::Lookup(index.0, Table(table)), Kind::Word))
    }
    fn to_count(self) -> Self {
        self
    }
    fn of_count(count: Self) -> Self {
        count
    }
}

impl WideWire for NetWide {
    type Word = NetWord;
}

impl Staged for NetWord {
    /// Nodes made by `body` belong to the stage, its outcome is tapped. Stages do not nest.
    fn stage<B: Bundle<Self>>(name: &'static str, body: impl Fn() -> B) -> B {
        recorder(|recorder| {
            let runs = &mut recorder.net.runs;
            let run = runs.iter().filter(|stage| stage.name == name).count() as u32;
            runs.iter_mut().filter(|stage| stage.name == name).for_each(|stage| stage.repeated = true);
            recorder.stage = Some(runs.len() as u32);
            runs.push(Run { name, run, repeated: run > 0 });
        });
        let outcome = body();
        let stage = recorder(|recorder| recorder.stage.take());
        let mut names = Names::default();
        outcome.rewire::<Self, _>(&mut names);
        let taps = names.wires.into_iter().map(|wire| wire.tap(stage));
        recorder(|recorder| recorder.net.taps.extend(taps));
        outcome
    }
}

/// A path as text: `e1.m[0]`.
fn path_name(path: &[Step]) -> String {
    path.iter().fold(String::new(), |name, step| match step {
        Step::Field(field) if name.is_empty() => field.name.to_owned(),
        Step::Field(field) => format!("{name}.{}", field.name),
        Step::Index(index) => format!("{name}[{index}]"),
    })
}

/// A wire of a bundle.
struct Named {
    path: Vec<Step>,
    node: NodeId,
    mantissa: bool,
    fraction_bits: u32,
}

impl Named {
    fn tap(self, stage: Option<u32>) -> Tap {
        let Self { path, node, mantissa, fraction_bits } = self;
        Tap { stage, name: path_name(&path), path, mantissa, fraction_bits, node }
    }
}

/// Lists the nodes of a bundle with their names and binary points.
#[derive(Default)]
struct Names {
    path: Vec<Step>,
    wires: Vec<Named>,
}

impl Names {
    fn add(&mut self, node: NodeId, mantissa: bool, fraction_bits: u32) {
        self.wires.push(Named { path: self.path.clone(), node, mantissa, fraction_bits });
    }
}

impl Rewire<NetWord, NetWord> for Names {
    fn enter(&mut self, step: Step) {
        self.path.push(step);
    }
    fn leave(&mut self) {
        self.path.pop();
    }
    fn word(&mut self, wire: NetWord, fraction_bits: u32) -> NetWord {
        self.add(wire.0, true, fraction_bits);
        wire
    }
    fn control(&mut self, wire: NetWord, fraction_bits: u32) -> NetWord {
        self.add(wire.0, false, fraction_bits);
        wire
    }
    fn wide(&mut self, wire: NetWide, fraction_bits: u32) -> NetWide {
        self.add(wire.0, false, fraction_bits);
        wire
    }
    fn flag(&mut self, wire: NetFlag) -> NetFlag {
        self.add(wire.0, false, 0);
        wire
    }
}

/// The integers on the wires of a scalar bundle, in the order of its walk.
#[derive(Default)]
struct Values(Vec<i64>);

impl Rewire<i32, i32> for Values {
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.0.push(i64::from(wire));
        wire
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        self.0.push(wire);
        wire
    }
    fn flag(&mut self, wire: bool) -> bool {
        self.0.push(i64::from(wire));
        wire
    }
}

/// The integers on the wires of a scalar bundle, in the order of ports and outputs of a net.
pub fn integers<B: Bundle<i32>>(bundle: &B) -> Vec<i64> {
    let mut values = Values::default();
    bundle.rewire::<i32, _>(&mut values);
    values.0
}

/// Puts given integers on the wires of a scalar bundle.
struct Given<'a>(std::slice::Iter<'a, i64>);

impl Given<'_> {
    fn next(&mut self, instead: i64) -> i64 {
        self.0.next().copied().unwrap_or(instead)
    }
}

impl Rewire<i32, i32> for Given<'_> {
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.next(wire.into()) as i32
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        self.next(wire)
    }
    fn flag(&mut self, wire: bool) -> bool {
        self.next(wire.into()) != 0
    }
}

/// A scalar bundle of the same form with other integers on its wires: the inverse of [`integers`]. Wires beyond the integers
/// keep what they hold; an integer is cut to the bits of its wire.
pub fn filled<B: Bundle<i32>>(form: &B, integers: &[i64]) -> B::In<i32> {
    form.rewire(&mut Given(integers.iter()))
}

/// Makes a port of every wire of a bundle that holds the lowest declared values.
struct Ports<'a> {
    path: Vec<Step>,
    high: std::slice::Iter<'a, i64>,
}

impl Ports<'_> {
    fn add(&mut self, low: i64, kind: Kind, mantissa: bool, fraction_bits: u32) -> NodeId {
        let path = self.path.clone();
        let high = self.high.next().copied().unwrap_or(low);
        recorder(|recorder| {
            let number = recorder.net.ports.len() as u32;
            let node = recorder.node(Op::Port(number), kind, Location::caller());
            recorder.net.ports.push(Port {
                name: path_name(&path),
                path,
                kind,
                mantissa,
                fraction_bits,
                low,
                high,
                node,
            });
            node
        })
    }
}

impl Rewire<i32, NetWord> for Ports<'_> {
    fn enter(&mut self, step: Step) {
        self.path.push(step);
    }
    fn leave(&mut self) {
        self.path.pop();
    }
    fn word(&mut self, low: i32, fraction_bits: u32) -> NetWord {
        NetWord(self.add(i64::from(low), Kind::Word, true, fraction_bits))
    }
    fn control(&mut self, low: i32, fraction_bits: u32) -> NetWord {
        NetWord(self.add(i64::from(low), Kind::Word, false, fraction_bits))
    }
    fn wide(&mut self, low: i64, fraction_bits: u32) -> NetWide {
        NetWide(self.add(low, Kind::Wide, false, fraction_bits))
    }
    fn flag(&mut self, low: bool) -> NetFlag {
        NetFlag(self.add(i64::from(low), Kind::Flag, false, 0))
    }
}

/// Records `body` on ports that may hold what the declaration of its input allows.
pub fn record<I: Form, O: Bundle<NetWord>>(body: impl FnOnce(&In<I, NetWord>) -> O) -> Net {
    RECORDER.set(Some(Recorder::default()));
    let (low, high) = (I::limit::<i32>(End::Low), integers(&I::limit::<i32>(End::High)));
    let inputs = low.rewire(&mut Ports { path: Vec::new(), high: high.iter() });
    let outcome = body(&inputs);
    let mut names = Names::default();
    outcome.rewire::<NetWord, _>(&mut names);
    let mut net = RECORDER.take().unwrap_or_default().net;
    net.outputs = names.wires.into_iter().map(|wire| wire.tap(None)).collect();
    net.without_dead_wires()
}

impl Net {
    /// Records a design with those of the effects that it has.
    pub fn of(design: Design, effects: &Effects, p: &Precision) -> Self {
        struct Record<'a>(&'a Effects, &'a Precision);
        impl Visitor for Record<'_> {
            type Outcome = Net;
            fn visit<D: Recorded>(self) -> Net {
                record::<D::Input, In<D::Output, NetWord>>(|input| D::run::<NetWord>(input, self.0, self.1))
            }
        }
        let mut net = design.visit(Record(effects, p));
        net.limits = design.visit(Limits);
        net
    }
}

/// The lowest and the highest integer that the declaration of each output of a design allows.
struct Limits;

impl Visitor for Limits {
    type Outcome = Vec<(i64, i64)>;
    fn visit<D: Recorded>(self) -> Self::Outcome {
        let [low, high] = [End::Low, End::High].map(|end| integers(&D::Output::limit::<i32>(end)));
        low.into_iter().zip(high).collect()
    }
}
