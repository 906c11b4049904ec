//! A second reading of the datapath: integers that refuse to leave their wire, and a count of every operation.
//!
//! The core states that no operation leaves its word; its scalar reading would wrap silently if one did. Here every
//! result is computed in 128 bits and must fit, every shift count must be below the width of its wire, every table
//! index inside its table: the first violation panics with the operation and its operands. Logic on one-bit flags
//! cannot go wrong and is not counted.

use std::cell::Cell;
use std::fmt;

use roughxel_core::block::Block;
use roughxel_core::datapath::{PortBlock, Reflection, ReflectionInput, TextureFootprint};
use roughxel_core::fx::Fx;
use roughxel_core::signals::{Axes, CubePoint, Ellipse, FacePosition, MapScale, Probes};
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::word::{Wire, Word};

/// A word of 32 bits that may not be left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checked(i32);

/// The wide wire of 64 bits that may not be left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckedWide(i64);

/// The operations of the algebra, in the order of its two traits.
pub const OPERATIONS: [&str; 17] = [
    "lit",
    "add",
    "sub",
    "shl",
    "sar",
    "shl_by",
    "sar_by",
    "and",
    "or",
    "xor",
    "lt",
    "select",
    "leading_zeros",
    "mul",
    "widen",
    "narrow",
    "lookup",
];

/// Index of an operation in [`OPERATIONS`].
#[derive(Clone, Copy)]
enum Operation {
    Lit,
    Add,
    Sub,
    Shl,
    Sar,
    ShlBy,
    SarBy,
    And,
    Or,
    Xor,
    Lt,
    Select,
    LeadingZeros,
    Mul,
    Widen,
    Narrow,
    Lookup,
}

thread_local! {
    static COUNTS: Cell<[u64; OPERATIONS.len()]> = const { Cell::new([0; OPERATIONS.len()]) };
}

fn count(operation: Operation) {
    COUNTS.with(|counts| {
        let mut now = counts.get();
        now[operation as usize] += 1;
        counts.set(now);
    });
}

/// How often each operation ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OperationCounts([u64; OPERATIONS.len()]);

impl OperationCounts {
    /// Every operation that costs hardware: constants and plain widening are wires.
    pub fn hardware(&self) -> u64 {
        self.total() - self.of("lit") - self.of("widen")
    }

    /// Every operation.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// One operation by its name in [`OPERATIONS`]; 0 for an unknown name.
    pub fn of(&self, name: &str) -> u64 {
        OPERATIONS.iter().zip(self.0).find(|(operation, _)| **operation == name).map_or(0, |(_, count)| count)
    }
}

impl fmt::Display for OperationCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let used = OPERATIONS.iter().zip(self.0).filter(|(_, count)| *count > 0);
        used.into_iter().try_for_each(|(name, count)| write!(f, "{name} {count}, "))?;
        write!(f, "total {}", self.total())
    }
}

/// Runs `work` and says which operations it took on this thread.
pub fn counted<T>(work: impl FnOnce() -> T) -> (T, OperationCounts) {
    let before = COUNTS.get();
    let result = work();
    let after = COUNTS.get();
    (result, OperationCounts(std::array::from_fn(|i| after[i] - before[i])))
}

macro_rules! wire {
    ($name:ident, $int:ty) => {
        impl $name {
            /// A wire that carries `value`.
            pub const fn new(value: $int) -> Self {
                Self(value)
            }

            /// What the wire carries.
            pub const fn value(self) -> $int {
                self.0
            }

            fn fit(operation: Operation, value: i128, operands: [i64; 2]) -> Self {
                count(operation);
                match <$int>::try_from(value) {
                    Ok(value) => Self(value),
                    Err(_) => panic!(
                        "{} of {operands:?} is {value}, beyond {} bits",
                        OPERATIONS[operation as usize],
                        <$int>::BITS
                    ),
                }
            }

            fn places(operation: Operation, k: i64) -> u32 {
                match u32::try_from(k) {
                    Ok(k) if k < <$int>::BITS => k,
                    _ => panic!("{} by {k} places of {}", OPERATIONS[operation as usize], <$int>::BITS),
                }
            }

            fn bits(operation: Operation, value: $int) -> Self {
                count(operation);
                Self(value)
            }
        }

        impl Wire for $name {
            type Flag = bool;
            type Count = Checked;

            fn lit(value: i64) -> Self {
                Self::fit(Operation::Lit, i128::from(value), [value, 0])
            }
            fn add(self, other: Self) -> Self {
                let operands = [self.0 as i64, other.0 as i64];
                Self::fit(Operation::Add, i128::from(self.0) + i128::from(other.0), operands)
            }
            fn sub(self, other: Self) -> Self {
                let operands = [self.0 as i64, other.0 as i64];
                Self::fit(Operation::Sub, i128::from(self.0) - i128::from(other.0), operands)
            }
            fn shl(self, k: u32) -> Self {
                let k = Self::places(Operation::Shl, i64::from(k));
                Self::fit(Operation::Shl, i128::from(self.0) << k, [self.0 as i64, i64::from(k)])
            }
            fn sar(self, k: u32) -> Self {
                Self::bits(Operation::Sar, self.0 >> Self::places(Operation::Sar, i64::from(k)))
            }
            fn shl_by(self, k: Checked) -> Self {
                let k = Self::places(Operation::ShlBy, i64::from(k.0));
                Self::fit(Operation::ShlBy, i128::from(self.0) << k, [self.0 as i64, i64::from(k)])
            }
            fn sar_by(self, k: Checked) -> Self {
                Self::bits(Operation::SarBy, self.0 >> Self::places(Operation::SarBy, i64::from(k.0)))
            }
            fn and(self, other: Self) -> Self {
                Self::bits(Operation::And, self.0 & other.0)
            }
            fn or(self, other: Self) -> Self {
                Self::bits(Operation::Or, self.0 | other.0)
            }
            fn xor(self, other: Self) -> Self {
                Self::bits(Operation::Xor, self.0 ^ other.0)
            }
            fn lt(self, other: Self) -> bool {
                count(Operation::Lt);
                self.0 < other.0
            }
            fn select(flag: bool, a: Self, b: Self) -> Self {
                Self::bits(Operation::Select, if flag { a.0 } else { b.0 })
            }
            fn leading_zeros(self) -> Checked {
                count(Operation::LeadingZeros);
                Checked(self.0.leading_zeros() as i32)
            }
        }
    };
}

wire!(Checked, i32);
wire!(CheckedWide, i64);

impl Word for Checked {
    type Wide = CheckedWide;

    fn mul(self, other: Self) -> CheckedWide {
        let product = i128::from(self.0) * i128::from(other.0);
        CheckedWide::fit(Operation::Mul, product, [self.0, other.0].map(i64::from))
    }
    fn widen(self) -> CheckedWide {
        CheckedWide::bits(Operation::Widen, i64::from(self.0))
    }
    fn narrow(wide: CheckedWide) -> Self {
        Self::fit(Operation::Narrow, i128::from(wide.0), [wide.0, 0])
    }
    fn lookup(self, table: &'static [i32]) -> Self {
        count(Operation::Lookup);
        match usize::try_from(self.0).ok().and_then(|index| table.get(index)) {
            Some(&value) => Self(value),
            None => panic!("lookup at {} in a table of {}", self.0, table.len()),
        }
    }
}

/// Word types of which a test can see the integer.
pub trait Visible: Word {
    /// The integer on the wire.
    fn integer(self) -> i32;
    /// A wire with that integer on it.
    fn wire(value: i32) -> Self;
}

impl Visible for i32 {
    fn integer(self) -> i32 {
        self
    }
    fn wire(value: i32) -> Self {
        value
    }
}

impl Visible for Checked {
    fn integer(self) -> i32 {
        self.0
    }
    fn wire(value: i32) -> Self {
        Self(value)
    }
}

/// The same number in another reading.
pub fn reread_word<W: Visible, const FRAC: u32>(x: Fx<i32, FRAC>) -> Fx<W, FRAC> {
    Fx::from_raw(W::wire(x.raw()))
}

/// The same map constants in another reading.
pub fn reread_map<W: Visible>(map: &MapScale<i32>) -> MapScale<W> {
    MapScale { log2_texels: reread_word(map.log2_texels), last_level: reread_word(map.last_level) }
}

/// The same texture constants in another reading.
pub fn reread_texture<W: Visible>(texture: &TextureScale<i32>) -> TextureScale<W> {
    TextureScale {
        size: texture.size.map(reread_word),
        log2_unit: reread_word(texture.log2_unit),
        repeats_per_unit: texture.repeats_per_unit.map(reread_word),
    }
}

/// The same port in another reading.
pub fn reread_port<W: Visible, const N: usize>(port: &PortBlock<i32, N>) -> PortBlock<W, N> {
    PortBlock { mantissa: port.mantissa.map(reread_word), exponent: reread_word(port.exponent) }
}

/// The same fragment in another reading.
pub fn reread_input<W: Visible>(input: &ReflectionInput<i32>) -> ReflectionInput<W> {
    ReflectionInput {
        normal: reread_port(&input.normal),
        view: reread_port(&input.view),
        tangents: input.tangents.each_ref().map(reread_port),
        offset: input.offset.map(reread_word),
        roughness: input.roughness.map(reread_word),
        dview: input.dview.each_ref().map(reread_port),
        dnormal: input.dnormal.each_ref().map(reread_port),
        map: reread_map(&input.map),
    }
}

/// Every integer of a structure of signals in a fixed order, for comparison between readings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Integers(pub Vec<(&'static str, i32)>);

impl Integers {
    fn word<W: Visible, const FRAC: u32>(&mut self, name: &'static str, x: Fx<W, FRAC>) {
        self.0.push((name, x.raw().integer()));
    }

    fn words<W: Visible, const FRAC: u32, const N: usize>(&mut self, name: &'static str, x: [Fx<W, FRAC>; N]) {
        x.into_iter().for_each(|x| self.word(name, x));
    }

    fn flag<W: Visible>(&mut self, name: &'static str, flag: W::Flag) {
        self.word(name, Fx::<W, 0>::select(flag, Fx::lit(1), Fx::zero()));
    }

    fn block<W: Visible, const N: usize>(&mut self, name: &'static str, block: &Block<W, N>) {
        self.words(name, block.m);
        self.word(name, block.e);
    }

    fn point<W: Visible>(&mut self, point: &CubePoint<W>) {
        self.word("face", point.select.index());
        self.words("st", point.st);
        self.word("half_reciprocal", point.half_reciprocal);
        self.flag::<W>("tie", point.tie);
    }

    fn footprint<W: Visible>(&mut self, ellipse: &Ellipse<W>, axes: &Axes<W>, probes: &Probes<W>) {
        self.block("k", &ellipse.k);
        self.block("det", &ellipse.det);
        self.block("major", &axes.major);
        self.block("minor", &axes.minor);
        self.words("direction", axes.direction);
        self.word("count", probes.count);
        self.words("step", probes.step);
        self.word("lod", probes.lod);
        self.flag::<W>("empty", probes.empty);
        self.flag::<W>("saturated", probes.saturated);
        self.flag::<W>("capped", probes.capped);
    }

    /// Every stage of the reflection datapath.
    pub fn of_reflection<W: Visible>(stages: &Reflection<W>) -> Self {
        let mut all = Self::default();
        all.block("normal", &stages.normal);
        all.block("view", &stages.view);
        all.block("e1", &stages.frame.e1);
        all.block("e2", &stages.frame.e2);
        all.flag::<W>("pole", stages.frame.pole);
        all.block("normal_mod", &stages.normal_mod);
        all.block("r", &stages.reflected.r);
        all.block("scalars", &stages.reflected.scalars);
        all.flag::<W>("below", stages.reflected.below);
        all.point(&stages.point);
        stages.columns.iter().for_each(|column| all.block("columns", column));
        all.footprint(&stages.ellipse, &stages.axes, &stages.probes);
        all.word("status", stages.status.word());
        all
    }

    /// Every stage of the texture footprint.
    pub fn of_texture<W: Visible>(stages: &TextureFootprint<W>) -> Self {
        let mut all = Self::default();
        stages.columns.iter().for_each(|column| all.block("columns", column));
        all.footprint(&stages.ellipse, &stages.axes, &stages.probes);
        all
    }

    /// A place on the cube.
    pub fn of_place<W: Visible>(place: &FacePosition<W>) -> Self {
        let mut all = Self::default();
        all.word("face", place.face);
        all.words("st", place.st);
        all
    }

    /// A block.
    pub fn of_block<W: Visible, const N: usize>(block: &Block<W, N>) -> Self {
        let mut all = Self::default();
        all.block("block", block);
        all
    }

    /// A few words.
    pub fn of_words<W: Visible, const FRAC: u32, const N: usize>(words: [Fx<W, FRAC>; N]) -> Self {
        let mut all = Self::default();
        all.words("word", words);
        all
    }
}

/// The first name whose integers differ, with both.
pub fn first_difference(a: &Integers, b: &Integers) -> Option<String> {
    let pair = a.0.iter().zip(&b.0).find(|(a, b)| a != b)?;
    Some(format!("{}: {} and {}", pair.0.0, pair.0.1, pair.1.1))
}
