//! A backend that reads the instruction counter where stages begin and end. It wraps any other backend, each stage a call of its own.

use core::marker::PhantomData;
use roughxel_core::bundle::{Bundle, Rewire};
use roughxel_core::each::each;
use roughxel_core::staged::Staged;
use roughxel_core::word::{WideWire, Wire, Word};

/// Instruction counter, with a list of the instructions of stages.
pub trait Meter: Copy + core::fmt::Debug + PartialEq + 'static {
    /// Instructions so far.
    fn now() -> u32;
    /// Records a stage that ran between two readings of the counter.
    fn took(stage: &'static str, before: u32, after: u32);
}

/// A wire of another backend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metered<X, M>(pub X, PhantomData<M>);

impl<X, M> Metered<X, M> {
    #[inline(always)]
    fn new(wire: X) -> Self {
        Self(wire, PhantomData)
    }
}

impl<X: Wire, M: Meter> Wire for Metered<X, M> {
    type Flag = X::Flag;
    type Count = Metered<X::Count, M>;
    const BITS: u32 = X::BITS;
    #[inline(always)]
    fn lit(value: i64) -> Self {
        Self::new(X::lit(value))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.0.add(other.0))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.0.sub(other.0))
    }
    #[inline(always)]
    fn shl(self, k: u32) -> Self {
        Self::new(self.0.shl(k))
    }
    #[inline(always)]
    fn sar(self, k: u32) -> Self {
        Self::new(self.0.sar(k))
    }
    #[inline(always)]
    fn shl_by(self, k: Self::Count) -> Self {
        Self::new(self.0.shl_by(k.0))
    }
    #[inline(always)]
    fn sar_by(self, k: Self::Count) -> Self {
        Self::new(self.0.sar_by(k.0))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self::new(self.0.and(other.0))
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        Self::new(self.0.or(other.0))
    }
    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        Self::new(self.0.xor(other.0))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Flag {
        self.0.lt(other.0)
    }
    #[inline(always)]
    fn select(flag: Self::Flag, a: Self, b: Self) -> Self {
        Self::new(X::select(flag, a.0, b.0))
    }
    #[inline(always)]
    fn unless<T>(flag: Self::Flag, instead: T, body: impl FnOnce() -> T) -> T {
        X::unless(flag, instead, body)
    }
    #[inline(always)]
    fn leading_zeros(self) -> Self::Count {
        Metered::new(self.0.leading_zeros())
    }
}

impl<W: Word, M: Meter> Word for Metered<W, M> {
    const WHOLE: bool = W::WHOLE;
    type Wide = Metered<W::Wide, M>;
    #[inline(always)]
    fn mul(self, other: Self) -> Self::Wide {
        Metered::new(self.0.mul(other.0))
    }
    #[inline(always)]
    fn widen(self) -> Self::Wide {
        Metered::new(self.0.widen())
    }
    #[inline(always)]
    fn narrow(wide: Self::Wide) -> Self {
        Self::new(W::narrow(wide.0))
    }
    #[inline(always)]
    fn round(wide: Self::Wide, drop: u32, up: u32) -> Self {
        Self::new(W::round(wide.0, drop, up))
    }
    #[inline(always)]
    fn lookup(index: Self::Count, table: &'static [i32]) -> Self {
        Self::new(W::lookup(index.0, table))
    }
    #[inline(always)]
    fn to_count(self) -> Self::Count {
        Metered::new(self.0.to_count())
    }
    #[inline(always)]
    fn of_count(count: Self::Count) -> Self {
        Self::new(W::of_count(count.0))
    }
}

impl<X: WideWire, M: Meter> WideWire for Metered<X, M> {
    type Word = Metered<X::Word, M>;
    #[inline(always)]
    fn wide_to_count(self) -> Self::Count {
        Metered::new(self.0.wide_to_count())
    }
    #[inline(always)]
    fn wide_of_count(count: Self::Count) -> Self {
        Self::new(X::wide_of_count(count.0))
    }
    #[inline(always)]
    fn normalised<const N: usize>(wires: [Self; N], drop: u32, up: u32) -> ([Self::Word; N], Self::Count, Self::Flag) {
        let (words, zeros, all_zero) = X::normalised(each!(wire in wires => wire.0), drop, up);
        (each!(word in words => Metered::new(word)), Metered::new(zeros), all_zero)
    }
}

impl<W: Word, M: Meter> Staged for Metered<W, M> {
    #[inline(always)]
    fn stage<B: Bundle<Self>>(name: &'static str, body: impl Fn() -> B + Copy) -> B {
        let before = M::now();
        let bundle = core::hint::black_box(body());
        M::took(name, before, M::now());
        bundle
    }
}

/// A walk into the metered backend.
struct Enter<M>(PhantomData<M>);

impl<W: Word, M: Meter> Rewire<W, Metered<W, M>> for Enter<M> {
    #[inline(always)]
    fn word(&mut self, wire: W, _: u32) -> Metered<W, M> {
        Metered::new(wire)
    }
    #[inline(always)]
    fn control(&mut self, wire: W::Count, _: u32) -> Metered<W::Count, M> {
        Metered::new(wire)
    }
    #[inline(always)]
    fn wide(&mut self, wire: <W::Count as Word>::Wide, _: u32) -> Metered<<W::Count as Word>::Wide, M> {
        Metered::new(wire)
    }
    #[inline(always)]
    fn flag(&mut self, wire: W::Flag) -> W::Flag {
        wire
    }
}
/// Converts a bundle to the metered backend.
pub fn metered<W: Word, M: Meter, B: Bundle<W>>(bundle: &B) -> B::In<Metered<W, M>> {
    bundle.rewire(&mut Enter::<M>(PhantomData))
}
