//! A second reading of the datapath: integers that refuse to leave their wire, and a count of every operation.
//!
//! The core states that no operation leaves its word; its scalar reading would wrap silently if one did. Here every
//! result is computed in 128 bits and must fit, every shift count must be below the width of its wire, every table
//! index inside its table: the first violation panics with the operation and its operands. Logic on one-bit flags
//! cannot go wrong and is not counted.

use std::cell::{Cell, RefCell};
use std::fmt;

use roughxel_core::bundle::{Bundle, Rewire, Step};
use roughxel_core::staged::Staged;
use roughxel_core::word::{WideWire, Wire, Word};

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

/// Outcomes of the stages that ran, in their order, each with its name.
pub type Trace = Vec<(&'static str, Integers)>;

thread_local! {
    static TRACE: RefCell<Option<Trace>> = const { RefCell::new(None) };
}

/// Runs `work` and says what every stage of the datapath came to on this thread.
pub fn traced<T>(work: impl FnOnce() -> T) -> (T, Trace) {
    TRACE.set(Some(Trace::new()));
    let result = work();
    (result, TRACE.take().unwrap_or_default())
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
            const BITS: u32 = <$int>::BITS;

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
            fn claim(self, low: i64, high: i64, lemma: &'static str) -> Self {
                let value = self.0 as i64;
                assert!((low..=high).contains(&value), "{lemma}: {value} is not in {low}..={high}");
                self
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
    fn lookup(index: Self, table: &'static [i32]) -> Self {
        count(Operation::Lookup);
        match usize::try_from(index.0).ok().and_then(|index| table.get(index)) {
            Some(&value) => Self(value),
            None => panic!("lookup at {} in a table of {}", index.0, table.len()),
        }
    }
    fn to_count(self) -> Self {
        self
    }
    fn of_count(count: Self) -> Self {
        count
    }
}

impl WideWire for CheckedWide {
    type Word = Checked;
}

impl Staged for Checked {
    fn stage<B: Bundle<Self>>(name: &'static str, body: impl Fn() -> B) -> B {
        let outcome = body();
        TRACE.with_borrow_mut(|trace| {
            if let Some(trace) = trace {
                trace.push((name, Integers::of(&outcome)));
            }
        });
        outcome
    }
}

/// Word types of which a test can see the integer.
pub trait Visible: Staged + Wire<Count = Self> {
    /// The integer on the wire.
    fn integer(self) -> i32;
    /// A wire with that integer on it.
    fn wire(value: i32) -> Self;
    /// The integer on a wide wire.
    fn wide_integer(wire: Self::Wide) -> i64;
}

impl Visible for i32 {
    fn integer(self) -> i32 {
        self
    }
    fn wire(value: i32) -> Self {
        value
    }
    fn wide_integer(wire: i64) -> i64 {
        wire
    }
}

impl Visible for Checked {
    fn integer(self) -> i32 {
        self.0
    }
    fn wire(value: i32) -> Self {
        Self(value)
    }
    fn wide_integer(wire: CheckedWide) -> i64 {
        wire.0
    }
}

/// Puts the same integers on the wires of another reading.
struct SameIntegers;

impl<V: Visible> Rewire<i32, V> for SameIntegers {
    fn word(&mut self, wire: i32, _: u32) -> V {
        V::wire(wire)
    }
    fn control(&mut self, wire: i32, _: u32) -> V {
        V::wire(wire)
    }
    fn wide(&mut self, wire: i64, _: u32) -> V::Wide {
        V::Wide::lit(wire)
    }
    fn flag(&mut self, wire: bool) -> V::Flag {
        V::lit(0).lt(V::lit(i64::from(wire)))
    }
}

/// Puts given integers on the wires, in the order of the walk.
struct Given<'a>(std::slice::Iter<'a, i64>);

impl Given<'_> {
    fn next(&mut self) -> i64 {
        *self.0.next().expect("an integer for every wire of the bundle")
    }
}

impl<V: Visible> Rewire<i32, V> for Given<'_> {
    fn word(&mut self, _: i32, _: u32) -> V {
        V::lit(self.next())
    }
    fn control(&mut self, _: i32, _: u32) -> V {
        V::lit(self.next())
    }
    fn wide(&mut self, _: i64, _: u32) -> V::Wide {
        V::Wide::lit(self.next())
    }
    fn flag(&mut self, _: bool) -> V::Flag {
        V::lit(0).lt(V::lit(self.next()))
    }
}

/// A bundle of the same form with other integers on its wires, in the order of the walk.
pub fn filled<V: Visible, B: Bundle<i32>>(form: &B, integers: &[i64]) -> B::In<V> {
    let mut given = Given(integers.iter());
    let bundle = form.rewire(&mut given);
    assert!(given.0.next().is_none(), "a wire of the bundle for every integer");
    bundle
}

/// The same bundle in another reading.
pub fn reread<V: Visible, B: Bundle<i32>>(bundle: &B) -> B::In<V> {
    bundle.rewire(&mut SameIntegers)
}

/// Every wire of a bundle with its name and the integer on it, for comparison between readings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Integers(pub Vec<(String, i64)>);

impl Integers {
    /// The wires of a bundle.
    pub fn of<W: Visible, B: Bundle<W>>(bundle: &B) -> Self {
        let mut list = List { path: Vec::new(), found: Vec::new() };
        bundle.rewire::<W, _>(&mut list);
        Self(list.found)
    }
}

/// Lists the wires of a walk.
struct List {
    path: Vec<Step>,
    found: Vec<(String, i64)>,
}

impl List {
    fn add(&mut self, value: i64) {
        let name = self.path.iter().fold(String::new(), |name, step| match step {
            Step::Field(field) if name.is_empty() => field.name.to_owned(),
            Step::Field(field) => format!("{name}.{}", field.name),
            Step::Index(index) => format!("{name}[{index}]"),
        });
        self.found.push((name, value));
    }
}

impl<W: Visible> Rewire<W, W> for List {
    fn enter(&mut self, step: Step) {
        self.path.push(step);
    }
    fn leave(&mut self) {
        self.path.pop();
    }
    fn word(&mut self, wire: W, _: u32) -> W {
        self.add(i64::from(wire.integer()));
        wire
    }
    fn control(&mut self, wire: W, _: u32) -> W {
        self.add(i64::from(wire.integer()));
        wire
    }
    fn wide(&mut self, wire: W::Wide, _: u32) -> W::Wide {
        self.add(W::wide_integer(wire));
        wire
    }
    fn flag(&mut self, wire: W::Flag) -> W::Flag {
        self.add(i64::from(W::select(wire, W::lit(1), W::lit(0)).integer()));
        wire
    }
}

/// The first name whose integers differ, with both.
pub fn first_difference(a: &Integers, b: &Integers) -> Option<String> {
    let pair = a.0.iter().zip(&b.0).find(|(a, b)| a != b)?;
    Some(format!("{}: {} and {}", pair.0.0, pair.0.1, pair.1.1))
}
