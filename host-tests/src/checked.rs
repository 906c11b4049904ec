//! Checked backend of the datapath: integers that refuse to leave their wire, and a count of every operation.
//!
//! The core states that no operation leaves its word; its scalar backend would wrap silently if one did. Here every result is computed in 128 bits
//! and must fit, every shift count must be below the width of its wire, and every table index inside its table. The first violation panics with the
//! operation and its operands. Logic on one-bit flags cannot go wrong and is not counted.

use std::cell::{Cell, RefCell};
use std::fmt;

use roughxel_core::bundle::{Bundle, Rewire};
use roughxel_core::normalised::normalised;
use roughxel_core::staged::Staged;
use roughxel_core::word::{WideWire, Wire, Word};

pub use crate::integers::{Integers, Visible, filled, first_difference};

/// A wire with the bits of `T` that no value may leave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckedWire<T>(T);

/// A 32-bit word that no value may leave.
pub type Checked = CheckedWire<i32>;

/// The wide 64-bit wire that no value may leave.
pub type CheckedWide = CheckedWire<i64>;

macro_rules! operations {
    ($($operation:ident $name:literal,)*) => {
        /// The operations of the algebra, in the order of its two traits.
        pub const OPERATIONS: [&str; 17] = [$($name),*];

        /// Index of an operation in [`OPERATIONS`].
        #[derive(Clone, Copy)]
        enum Operation {
            $($operation,)*
        }
    };
}

operations! {
    Lit "lit",
    Add "add",
    Sub "sub",
    Shl "shl",
    Sar "sar",
    ShlBy "shl_by",
    SarBy "sar_by",
    And "and",
    Or "or",
    Xor "xor",
    Lt "lt",
    Select "select",
    LeadingZeros "leading_zeros",
    Mul "mul",
    Widen "widen",
    Narrow "narrow",
    Lookup "lookup",
}

thread_local! {
    static COUNTS: [Cell<u64>; OPERATIONS.len()] = const { [const { Cell::new(0) }; OPERATIONS.len()] };
}

// Tests run millions of these operations with little optimisation, which inlines small functions only if it must.

#[inline(always)]
fn count(operation: Operation) {
    COUNTS.with(|counts| counts[operation as usize].update(|count| count + 1));
}

/// Counts of each operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OperationCounts([u64; OPERATIONS.len()]);

impl OperationCounts {
    /// Every operation that costs hardware: constants and plain widening are wires.
    pub fn hardware(&self) -> u64 {
        self.total() - self.count("lit") - self.count("widen")
    }

    /// Every operation.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// One operation by its name in [`OPERATIONS`]; 0 for an unknown name.
    pub fn count(&self, name: &str) -> u64 {
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

/// Runs `work` and returns its operations on this thread.
pub fn counted<T>(work: impl FnOnce() -> T) -> (T, OperationCounts) {
    let now = || COUNTS.with(|counts| counts.each_ref().map(Cell::get));
    let before = now();
    let result = work();
    let after = now();
    (result, OperationCounts(std::array::from_fn(|i| after[i] - before[i])))
}

/// Results of the stages that ran, in their order, each with its name.
pub type Trace = Vec<(&'static str, Integers)>;

thread_local! {
    static TRACE: RefCell<Option<Trace>> = const { RefCell::new(None) };
}

/// Runs `work` and returns the result of every stage of the datapath on this thread.
pub fn traced<T>(work: impl FnOnce() -> T) -> (T, Trace) {
    TRACE.set(Some(Trace::new()));
    let result = work();
    (result, TRACE.take().unwrap_or_default())
}

/// Integer on a wire.
pub trait Integer: Copy + fmt::Debug {
    /// Width of the integer.
    const BITS: u32;
    /// The integer on 64 bits.
    fn wide(self) -> i64;
    /// The integer, if it fits.
    fn fitting(value: i128) -> Option<Self>;
}

macro_rules! integer {
    ($($int:ty),*) => {
        $(impl Integer for $int {
            const BITS: u32 = <$int>::BITS;
            #[inline(always)]
            fn wide(self) -> i64 {
                self as i64
            }
            #[inline(always)]
            fn fitting(value: i128) -> Option<Self> {
                let cut = value as Self;
                if cut as i128 == value { Some(cut) } else { None }
            }
        })*
    };
}

integer!(i8, i16, i32, i64);

impl<T: Integer> CheckedWire<T> {
    /// A wire that carries `value`.
    pub const fn new(value: T) -> Self {
        Self(value)
    }

    /// Returns the integer on the wire.
    pub const fn value(self) -> T {
        self.0
    }

    #[inline(always)]
    fn integer(self) -> i64 {
        self.0.wide()
    }

    /// Returns the result of a counted operation. Panics if it does not fit the wire.
    #[inline(always)]
    fn fit(operation: Operation, value: i128, operands: [i64; 2]) -> Self {
        count(operation);
        match T::fitting(value) {
            Some(value) => Self(value),
            None => Self::does_not_fit(operation, value, operands),
        }
    }

    #[cold]
    fn does_not_fit(operation: Operation, value: i128, operands: [i64; 2]) -> ! {
        panic!("{} of {operands:?} is {value}, beyond {} bits", OPERATIONS[operation as usize], T::BITS)
    }

    #[inline(always)]
    fn places(operation: Operation, k: i64) -> u32 {
        if 0 <= k && k < T::BITS as i64 {
            return k as u32;
        }
        panic!("{} by {k} places of {}", OPERATIONS[operation as usize], T::BITS)
    }

    #[inline(always)]
    fn left(self, operation: Operation, k: i64) -> Self {
        Self::fit(operation, (self.integer() as i128) << Self::places(operation, k), [self.integer(), k])
    }

    #[inline(always)]
    fn right(self, operation: Operation, k: i64) -> Self {
        Self::fit(operation, (self.integer() >> Self::places(operation, k)) as i128, [self.integer(), k])
    }

    #[inline(always)]
    fn both(operation: Operation, a: Self, b: Self, of: impl Fn(i128, i128) -> i128) -> Self {
        let operands = [a.integer(), b.integer()];
        Self::fit(operation, of(operands[0] as i128, operands[1] as i128), operands)
    }
}

impl<T: Integer> Wire for CheckedWire<T> {
    type Flag = bool;
    type Count = Checked;
    const BITS: u32 = T::BITS;

    fn lit(value: i64) -> Self {
        Self::fit(Operation::Lit, value as i128, [value, 0])
    }
    fn add(self, other: Self) -> Self {
        Self::both(Operation::Add, self, other, |a, b| a + b)
    }
    fn sub(self, other: Self) -> Self {
        Self::both(Operation::Sub, self, other, |a, b| a - b)
    }
    fn shl(self, k: u32) -> Self {
        self.left(Operation::Shl, k.into())
    }
    fn sar(self, k: u32) -> Self {
        self.right(Operation::Sar, k.into())
    }
    fn shl_by(self, k: Checked) -> Self {
        self.left(Operation::ShlBy, k.integer())
    }
    fn sar_by(self, k: Checked) -> Self {
        self.right(Operation::SarBy, k.integer())
    }
    fn and(self, other: Self) -> Self {
        Self::both(Operation::And, self, other, |a, b| a & b)
    }
    fn or(self, other: Self) -> Self {
        Self::both(Operation::Or, self, other, |a, b| a | b)
    }
    fn xor(self, other: Self) -> Self {
        Self::both(Operation::Xor, self, other, |a, b| a ^ b)
    }
    fn lt(self, other: Self) -> bool {
        count(Operation::Lt);
        self.integer() < other.integer()
    }
    fn select(flag: bool, a: Self, b: Self) -> Self {
        count(Operation::Select);
        if flag { a } else { b }
    }
    fn claim(self, low: i64, high: i64, lemma: &'static str) -> Self {
        let value = self.integer();
        assert!((low..=high).contains(&value), "{lemma}: {value} is not in {low}..={high}");
        self
    }
    fn leading_zeros(self) -> Checked {
        let zeros = self.integer().leading_zeros().saturating_sub(i64::BITS - T::BITS);
        Checked::fit(Operation::LeadingZeros, zeros as i128, [self.integer(), 0])
    }
}

macro_rules! word {
    ($word:ty, $wide:ty) => {
        impl Word for CheckedWire<$word> {
            type Wide = CheckedWire<$wide>;

            fn mul(self, other: Self) -> CheckedWire<$wide> {
                let operands = [self.integer(), other.integer()];
                let product = operands[0] as i128 * operands[1] as i128;
                CheckedWire::fit(Operation::Mul, product, operands)
            }
            fn widen(self) -> CheckedWire<$wide> {
                CheckedWire::fit(Operation::Widen, self.integer() as i128, [self.integer(), 0])
            }
            fn narrow(wide: CheckedWire<$wide>) -> Self {
                Self::fit(Operation::Narrow, wide.integer() as i128, [wide.integer(), 0])
            }
            fn lookup(index: Checked, table: &'static [i32]) -> Self {
                match usize::try_from(index.0).ok().and_then(|index| table.get(index)) {
                    // The nearest word, ties up.
                    Some(&entry) => {
                        let dropped = 32 - <$word>::BITS;
                        let half = if dropped == 0 { 0 } else { 1 << (dropped - 1) };
                        Self::fit(Operation::Lookup, (i128::from(entry) + half) >> dropped, [index.integer(), 0])
                    }
                    None => panic!("lookup at {} in a table of {}", index.0, table.len()),
                }
            }
            fn to_count(self) -> Checked {
                CheckedWire(self.0.into())
            }
            fn of_count(count: Checked) -> Self {
                match <$word>::try_from(count.0) {
                    Ok(word) => Self(word),
                    Err(_) => panic!("{} is beyond {} bits", count.0, <$word>::BITS),
                }
            }
        }

        impl WideWire for CheckedWire<$wide> {
            type Word = CheckedWire<$word>;
            fn wide_to_count(self) -> Checked {
                Checked::fit(Operation::Narrow, self.integer() as i128, [self.integer(), 0])
            }
            fn wide_of_count(count: Checked) -> Self {
                Self::fit(Operation::Widen, count.integer() as i128, [count.integer(), 0])
            }
            #[inline(always)]
            fn normalised<const N: usize>(
                wires: [Self; N],
                drop: u32,
                up: u32,
            ) -> ([Self::Word; N], Self::Count, Self::Flag) {
                normalised(wires, drop, up)
            }
        }

        impl Staged for CheckedWire<$word> {
            fn stage<B: Bundle<Self>>(name: &'static str, body: impl Fn() -> B + Copy) -> B {
                let outcome = body();
                TRACE.with_borrow_mut(|trace| {
                    if let Some(trace) = trace {
                        trace.push((name, Integers::from_bundle(&outcome)));
                    }
                });
                outcome
            }
        }

        impl Visible for CheckedWire<$word> {
            fn integer(self) -> i64 {
                self.0.into()
            }
            fn count_integer(count: Checked) -> i64 {
                count.0.into()
            }
            fn wide_integer(wire: CheckedWide) -> i64 {
                wire.0
            }
        }

        impl Scalar for $word {
            type Checked = CheckedWire<Self>;
            fn checked(self) -> CheckedWire<Self> {
                CheckedWire(self)
            }
        }
    };
}

word!(i8, i16);
word!(i16, i32);
word!(i32, i64);

/// A word of the scalar backend with a checked counterpart.
pub trait Scalar: Visible<Count = i32, Flag = bool> {
    /// The checked backend of the same width.
    type Checked: Visible<Count = Checked, Flag = bool>;
    /// Converts the word to the checked backend, with the same integer.
    fn checked(self) -> Self::Checked;
}

/// Puts the same integers on the wires of the checked backend.
struct SameIntegers;

impl<T: Scalar> Rewire<T, T::Checked> for SameIntegers {
    fn word(&mut self, wire: T, _: u32) -> T::Checked {
        wire.checked()
    }
    fn control(&mut self, wire: i32, _: u32) -> Checked {
        Checked::lit(wire.into())
    }
    fn wide(&mut self, wire: i64, _: u32) -> CheckedWide {
        Wire::lit(wire)
    }
    fn flag(&mut self, wire: bool) -> bool {
        wire
    }
}

/// Converts a bundle to the checked backend, with the same integers.
pub fn reread<T: Scalar, B: Bundle<T>>(bundle: &B) -> B::In<T::Checked> {
    bundle.rewire(&mut SameIntegers)
}
