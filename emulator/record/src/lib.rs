//! The recorded backend: its words are nodes of a netlist under construction ([`roughxel_netlist::builder`]).
//!
//! Every stage of every design is compiled here, for words of 16 and of 32 bits, and each runs once a recording. So this package is built without
//! optimisation, which takes an eighth of the time.

use std::cmp::Ordering;
use std::marker::PhantomData;
use std::ops::{BitAnd, BitOr, Not};

use roughxel_core::bundle::{Bundle, End, Rewire, Step};
use roughxel_core::design::{Design, Form, In, Recorded, Visitor};
use roughxel_core::normalised::normalised;
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_core::staged::Staged;
use roughxel_core::word::{WideWire, Wire, Word};

use roughxel_netlist::builder::{self, NamedWire, node};
use roughxel_netlist::graph::{Kind, Net, NodeId, Op, Table};
use roughxel_netlist::integers::integers_on;
use roughxel_netlist::verilog::{Options, Stages, Verilog, VerilogError};

/// A wire of this many bits in the recorded backend: 16 or 32 are words, whose wide companion has twice the bits.
#[derive(Clone, Copy, Debug)]
pub struct NetWire<const BITS: u32>(NodeId);

/// Wire of a control number in the recorded backend, and the word of every profile of 32 bits.
pub type NetWord = NetWire<32>;

/// A flag of the recorded backend.
#[derive(Clone, Copy, Debug)]
pub struct NetFlag(NodeId);

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
            fn normalised<const N: usize>(
                wires: [Self; N],
                drop: u32,
                up: u32,
            ) -> ([NetWire<$bits>; N], NetWord, NetFlag) {
                builder::part(|| normalised(wires, drop, up))
            }
        }

        impl Staged for NetWire<$bits> {
            fn stage<B: Bundle<Self>>(name: &'static str, body: impl Fn() -> B + Copy) -> B {
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

/// Widens or narrows a wire whose integer fits the new width.
#[track_caller]
fn resized(id: NodeId, from: u32, to: u32) -> NodeId {
    match from.cmp(&to) {
        Ordering::Less => node(Op::Widen(id), Kind::Wire(to)),
        Ordering::Equal => id,
        Ordering::Greater => node(Op::Narrow(id), Kind::Wire(to)),
    }
}

/// Words that carry mantissas in a recorded design.
pub trait NetReading: Staged + Wire<Flag = NetFlag, Count = NetWord> {
    /// Word of the scalar backend with the same width.
    type Scalar: Word<Count = i32, Flag = bool> + Into<i64>;
    /// Node of a wire.
    fn node(self) -> NodeId;
    /// Wire of a node.
    fn of_node(node: NodeId) -> Self;
}

/// Runs `body` as a stage: its nodes belong to the stage, and its outcome is tapped.
fn staged<W: NetReading, B: Bundle<W>>(name: &'static str, body: impl Fn() -> B + Copy) -> B {
    builder::enter(name);
    let outcome = body();
    builder::leave(named(&outcome));
    outcome
}

/// Wires of a bundle with their names.
fn named<W: NetReading, B: Bundle<W>>(bundle: &B) -> Vec<NamedWire> {
    let mut names = Names::default();
    bundle.rewire::<W, _>(&mut names);
    names.wires
}

/// Lists the nodes of a bundle with their names and binary points.
#[derive(Default)]
struct Names {
    path: Vec<Step>,
    wires: Vec<NamedWire>,
}

impl Names {
    fn add(&mut self, node: NodeId, mantissa: bool, fraction_bits: u32) {
        self.wires.push(NamedWire { path: self.path.clone(), node, mantissa, fraction_bits });
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

/// Makes a port of every wire of a bundle.
struct Ports {
    path: Vec<Step>,
    /// Lowest and highest value of each port, in the order of the walk.
    limits: std::vec::IntoIter<(i64, i64)>,
}

impl Ports {
    fn add(&mut self, kind: Kind, mantissa: bool, fraction_bits: u32) -> NodeId {
        let limits = self.limits.next().unwrap_or(kind.limits());
        builder::port(self.path.clone(), kind, mantissa, fraction_bits, limits)
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

/// Lowest and highest integer that the declaration of each wire allows, on words of the width of `W`.
fn limits<W: NetReading, F: Form>() -> Vec<(i64, i64)> {
    let [low, high] = [End::Low, End::High].map(|end| integers_on(&F::limit::<W::Scalar>(end)));
    low.into_iter().zip(high).collect()
}

/// Records `body` on ports that hold the range that the declaration of its input allows.
pub fn record<W: NetReading, I: Form, O: Bundle<W>>(body: impl FnOnce(&In<I, W>) -> O) -> Net {
    builder::begin();
    let form = I::limit::<i32>(End::Low);
    let inputs = form.rewire::<W, _>(&mut Ports { path: Vec::new(), limits: limits::<W, I>().into_iter() });
    let outcome = body(&inputs);
    builder::end(named(&outcome))
}

/// Records a design with those of the effects that it has, on words of the profile's width.
pub fn net(design: Design, effects: &Effects, p: &Precision) -> Net {
    if p.word_bits() == 16 {
        design.visit(Record::<NetWire<16>> { effects, p, words: PhantomData })
    } else {
        design.visit(Record::<NetWord> { effects, p, words: PhantomData })
    }
}

/// Records a design, proves it and writes it as Verilog.
///
/// Errors: everything [`VerilogError`] lists.
pub fn verilog(design: Design, options: &Options) -> Result<Verilog, VerilogError> {
    Verilog::new(design, net(design, &options.effects, &options.precision), options)
}

/// Records a design and proves it, for use of its stages one by one.
///
/// Errors: everything [`VerilogError`] lists.
pub fn stages(design: Design, options: &Options) -> Result<Stages, VerilogError> {
    Stages::new(net(design, &options.effects, &options.precision), options)
}

/// Recorder of a design.
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
