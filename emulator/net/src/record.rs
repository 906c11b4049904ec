//! Recording: a reading whose words are nodes of a graph under construction.
//!
//! Within a stage equal operations are one node; between stages nothing is shared, so that a stage is the same
//! hardware wherever it is used. Operations on constants and those that change nothing are folded as they come.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::ops::{BitAnd, BitOr, Not};
use std::panic::Location;

use roughxel_core::bundle::{Bundle, End, Rewire, Step};
use roughxel_core::design::{Design, Form, In, Recorded, Visitor};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_core::staged::Staged;
use roughxel_core::width::narrowed;
use roughxel_core::word::{WideWire, Wire, Word};

use super::evaluate::apply_exactly;
use super::graph::{Kind, Net, Node, NodeId, Op, Port, Run, Table, Tap};

/// A wire of so many bits in the recorded reading: 16 or 32 are words, of which twice the bits are the wide companion.
#[derive(Clone, Copy, Debug)]
pub struct NetWire<const BITS: u32>(NodeId);

/// What controls in the recorded reading, and the word of every profile.
pub type NetWord = NetWire<32>;

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
            // A word that was a count in between.
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

impl<const BITS: u32> Wire for NetWire<BITS> {
    type Flag = NetFlag;
    type Count = NetWord;
    const BITS: u32 = BITS;
    #[track_caller]
    fn lit(value: i64) -> Self {
        Self(node(Op::Lit(value), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn add(self, other: Self) -> Self {
        Self(node(Op::Add(self.0, other.0), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn sub(self, other: Self) -> Self {
        Self(node(Op::Sub(self.0, other.0), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn shl(self, k: u32) -> Self {
        Self(node(Op::Shl(self.0, k), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn sar(self, k: u32) -> Self {
        Self(node(Op::Sar(self.0, k), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn shl_by(self, k: NetWord) -> Self {
        Self(node(Op::ShlBy(self.0, k.0), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn sar_by(self, k: NetWord) -> Self {
        Self(node(Op::SarBy(self.0, k.0), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn and(self, other: Self) -> Self {
        Self(node(Op::And(self.0, other.0), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn or(self, other: Self) -> Self {
        Self(node(Op::Or(self.0, other.0), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn xor(self, other: Self) -> Self {
        Self(node(Op::Xor(self.0, other.0), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn lt(self, other: Self) -> NetFlag {
        NetFlag(node(Op::Lt(self.0, other.0), Kind::Flag))
    }
    #[track_caller]
    fn select(flag: NetFlag, a: Self, b: Self) -> Self {
        Self(node(Op::Select(flag.0, a.0, b.0), Kind::Wire(BITS)))
    }
    #[track_caller]
    fn leading_zeros(self) -> NetWord {
        NetWire(node(Op::LeadingZeros(self.0), Kind::Wire(32)))
    }
    #[track_caller]
    fn claim(self, low: i64, high: i64, lemma: &'static str) -> Self {
        Self(node(Op::Claim { of: self.0, low, high, lemma }, Kind::Wire(BITS)))
    }
}

macro_rules! word {
    ($bits:literal, $wide:literal, $scalar:ty) => {
        impl Word for NetWire<$bits> {
            type Wide = NetWire<$wide>;
            #[track_caller]
            fn mul(self, other: Self) -> NetWire<$wide> {
                NetWire(node(Op::Mul(self.0, other.0), Kind::Wire($wide)))
            }
            #[track_caller]
            fn widen(self) -> NetWire<$wide> {
                NetWire(node(Op::Widen(self.0), Kind::Wire($wide)))
            }
            #[track_caller]
            fn narrow(wide: NetWire<$wide>) -> Self {
                Self(node(Op::Narrow(wide.0), Kind::Wire($bits)))
            }
            #[track_caller]
            fn lookup(index: NetWord, entries: &'static [i32]) -> Self {
                Self(node(Op::Lookup(index.0, Table { entries, bits: $bits }), Kind::Wire($bits)))
            }
            #[track_caller]
            fn to_count(self) -> NetWord {
                NetWire(resized(self.0, $bits, 32))
            }
            #[track_caller]
            fn of_count(count: NetWord) -> Self {
                Self(resized(count.0, 32, $bits))
            }
        }

        impl WideWire for NetWire<$wide> {
            type Word = NetWire<$bits>;
            #[track_caller]
            fn wide_to_count(self) -> NetWord {
                NetWire(resized(self.0, $wide, 32))
            }
            #[track_caller]
            fn wide_of_count(count: NetWord) -> Self {
                Self(resized(count.0, 32, $wide))
            }
        }

        impl Staged for NetWire<$bits> {
            fn stage<B: Bundle<Self>>(name: &'static str, body: impl Fn() -> B) -> B {
                staged(name, body)
            }
        }

        impl NetReading for NetWire<$bits> {
            type Scalar = $scalar;
            fn node(self) -> NodeId {
                self.0
            }
            fn of_node(node: NodeId) -> Self {
                Self(node)
            }
        }
    };
}

word!(16, 32, i16);
word!(32, 64, i32);

/// The same integer on a wire of another width, which it fits.
#[track_caller]
fn resized(id: NodeId, from: u32, to: u32) -> NodeId {
    match from.cmp(&to) {
        Ordering::Less => node(Op::Widen(id), Kind::Wire(to)),
        Ordering::Equal => id,
        Ordering::Greater => node(Op::Narrow(id), Kind::Wire(to)),
    }
}

/// The words that carry mantissas in a recorded design.
pub trait NetReading: Staged + Wire<Flag = NetFlag, Count = NetWord> {
    /// The scalar reading with words of the same width.
    type Scalar: Word<Count = i32, Flag = bool> + Into<i64>;
    /// The node of a wire.
    fn node(self) -> NodeId;
    /// The wire of a node.
    fn of_node(node: NodeId) -> Self;
}

/// Nodes made by `body` belong to the stage, its outcome is tapped. Stages do not nest.
fn staged<W: NetReading, B: Bundle<W>>(name: &'static str, body: impl Fn() -> B) -> B {
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
    outcome.rewire::<W, _>(&mut names);
    let taps = names.wires.into_iter().map(|wire| wire.tap(stage));
    recorder(|recorder| recorder.net.taps.extend(taps));
    outcome
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

impl<W: NetReading> Rewire<W, W> for Names {
    fn enter(&mut self, step: Step) {
        self.path.push(step);
    }
    fn leave(&mut self) {
        self.path.pop();
    }
    fn word(&mut self, wire: W, fraction_bits: u32) -> W {
        self.add(wire.node(), true, fraction_bits);
        wire
    }
    fn control(&mut self, wire: NetWord, fraction_bits: u32) -> NetWord {
        self.add(wire.0, false, fraction_bits);
        wire
    }
    fn wide(&mut self, wire: NetWire<64>, fraction_bits: u32) -> NetWire<64> {
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

impl<S: Word<Count = i32, Flag = bool> + Into<i64>> Rewire<S, S> for Values {
    fn word(&mut self, wire: S, _: u32) -> S {
        self.0.push(wire.into());
        wire
    }
    fn control(&mut self, wire: i32, _: u32) -> i32 {
        self.0.push(wire.into());
        wire
    }
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        self.0.push(wire);
        wire
    }
    fn flag(&mut self, wire: bool) -> bool {
        self.0.push(wire.into());
        wire
    }
}

/// The integers on the wires of a scalar bundle, in the order of ports and outputs of a net.
pub fn integers<B: Bundle<i32>>(bundle: &B) -> Vec<i64> {
    integers_on::<i32, B>(bundle)
}

/// The same on words of the profile's width, as nets of that profile have them.
pub fn integers_at<B: Form>(bundle: &B, p: &Precision) -> Vec<i64> {
    if p.word_bits() == 16 { integers_on::<i16, _>(&narrowed(bundle)) } else { integers(bundle) }
}

/// The same on words of another width.
fn integers_on<S: Word<Count = i32, Flag = bool> + Into<i64>, B: Bundle<S>>(bundle: &B) -> Vec<i64> {
    let mut values = Values::default();
    bundle.rewire::<S, _>(&mut values);
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

/// Makes a port of every wire of a bundle.
struct Ports {
    path: Vec<Step>,
    /// The lowest and the highest value of each, in the order of the walk.
    limits: std::vec::IntoIter<(i64, i64)>,
}

impl Ports {
    fn add(&mut self, kind: Kind, mantissa: bool, fraction_bits: u32) -> NodeId {
        let path = self.path.clone();
        let (low, high) = self.limits.next().unwrap_or(kind.limits());
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
                zeros: 0,
                node,
            });
            node
        })
    }
}

impl<W: NetReading> Rewire<i32, W> for Ports {
    fn enter(&mut self, step: Step) {
        self.path.push(step);
    }
    fn leave(&mut self) {
        self.path.pop();
    }
    fn word(&mut self, _: i32, fraction_bits: u32) -> W {
        // The walk is over words of 32 bits, with as many bits before the point.
        W::of_node(self.add(Kind::Wire(W::BITS), true, fraction_bits + W::BITS - 32))
    }
    fn control(&mut self, _: i32, fraction_bits: u32) -> NetWord {
        NetWire(self.add(Kind::Wire(32), false, fraction_bits))
    }
    fn wide(&mut self, _: i64, fraction_bits: u32) -> NetWire<64> {
        NetWire(self.add(Kind::Wire(64), false, fraction_bits))
    }
    fn flag(&mut self, _: bool) -> NetFlag {
        NetFlag(self.add(Kind::Flag, false, 0))
    }
}

/// The lowest and the highest integer that the declaration of each wire allows, on words of the width of `W`.
fn limits<W: NetReading, F: Form>() -> Vec<(i64, i64)> {
    let [low, high] = [End::Low, End::High].map(|end| integers_on(&F::limit::<W::Scalar>(end)));
    low.into_iter().zip(high).collect()
}

/// Records `body` on ports that may hold what the declaration of its input allows.
pub fn record<W: NetReading, I: Form, O: Bundle<W>>(body: impl FnOnce(&In<I, W>) -> O) -> Net {
    RECORDER.set(Some(Recorder::default()));
    let form = I::limit::<i32>(End::Low);
    let inputs = form.rewire::<W, _>(&mut Ports { path: Vec::new(), limits: limits::<W, I>().into_iter() });
    let outcome = body(&inputs);
    let mut names = Names::default();
    outcome.rewire::<W, _>(&mut names);
    let mut net = RECORDER.take().unwrap_or_default().net;
    net.outputs = names.wires.into_iter().map(|wire| wire.tap(None)).collect();
    net.without_dead_wires()
}

impl Net {
    /// Records a design with those of the effects that it has, on words of the profile's width.
    pub fn of(design: Design, effects: &Effects, p: &Precision) -> Self {
        if p.word_bits() == 16 {
            design.visit(Record::<NetWire<16>> { effects, p, words: PhantomData })
        } else {
            design.visit(Record::<NetWord> { effects, p, words: PhantomData })
        }
    }
}

/// Records a design.
struct Record<'a, W> {
    effects: &'a Effects,
    p: &'a Precision,
    words: PhantomData<W>,
}

impl<W: NetReading> Visitor for Record<'_, W> {
    type Outcome = Net;
    fn visit<D: Recorded>(self) -> Net {
        let mut net = record::<W, D::Input, In<D::Output, W>>(|input| D::run::<W>(input, self.effects, self.p));
        net.limits = limits::<W, D::Output>();
        net
    }
}
