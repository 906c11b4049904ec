//! Bundles: structures of wires, each declared once.
//!
//! [`bundle!`](crate::bundle!) declares a structure. For each field it states the meaning and the kind of wire and, if they matter, unit, range, the
//! stage that makes it and its type at a scalar port. Everything else about the structure comes from a *walk* over it: names of ports and columns,
//! declared ranges, conversion between backends, the number of wires. A walk visits the wires in the order of the fields and may replace each by a
//! wire of another backend. Nothing is allocated.

use crate::each::{each, places};
use crate::fx::{Control, Fx, WideControl};
use crate::word::{Wire, Word};

/// Declaration of a field of a bundle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name of the field.
    pub name: &'static str,
    /// Meaning of the field.
    pub text: &'static str,
    /// Unit; empty if the field has none of its own.
    pub unit: &'static str,
    /// Stage whose outcome it is; empty for inputs and for bundles inside the datapath.
    pub stage: &'static str,
    /// True if it leaves the datapath, false if it is only observed.
    pub leaves: bool,
    /// Fraction bits that a profile keeps of it.
    pub keeps: Keeps,
    /// A letter for each of its components; empty if numbers or x, y, z serve.
    pub components: &'static str,
    /// Rate at which the value of an input changes.
    pub per: Per,
}

/// Rate at which the value of an input changes. A field inside a field with [`Per::Object`] changes as rarely.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Changes with each fragment, sample or channel.
    Fragment,
    /// Changes with the object at most: a constant of its maps or its material, which hardware may keep in a register.
    Object,
}

/// True if the value at the end of a path is a constant of the object ([`Per::Object`]).
pub fn is_constant(path: &[Step]) -> bool {
    path.iter().any(|step| matches!(step, Step::Field(field) if field.per == Per::Object))
}

/// Number of fraction bits that a profile keeps of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keeps {
    /// The p bits of a mantissa. A word with more bits before its point keeps that many fewer. Control words are kept whole.
    Fraction,
    /// `lod_bits`.
    Lod,
}

/// One step on the way to a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Field of a structure.
    Field(&'static Field),
    /// Place in an array.
    Index(usize),
}

/// An end of a declared range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The lowest values.
    Low,
    /// The highest values.
    High,
}

impl End {
    /// Picks `low` or `high`.
    #[inline(always)]
    pub fn pick<T>(self, low: T, high: T) -> T {
        match self {
            Self::Low => low,
            Self::High => high,
        }
    }

    /// The end of the range of a wire with `bits` bits.
    #[inline(always)]
    pub fn of_bits(self, bits: u32) -> i64 {
        self.pick(i64::MIN >> (64 - bits), i64::MAX >> (64 - bits))
    }
}

/// A walk over the wires of a bundle that replaces each wire of `W` by one of the backend `V`.
pub trait Rewire<W: Word, V: Word> {
    /// Enters `step`: the wires up to the matching [`Self::leave`] are below it.
    #[inline(always)]
    fn enter(&mut self, step: Step) {
        let _ = step;
    }
    /// Ends the last step.
    #[inline(always)]
    fn leave(&mut self) {}
    /// Replaces a word that carries a mantissa.
    fn word(&mut self, wire: W, fraction_bits: u32) -> V;
    /// Replaces a control word.
    fn control(&mut self, wire: W::Count, fraction_bits: u32) -> V::Count;
    /// Replaces a wide control wire.
    fn wide(&mut self, wire: <W::Count as Word>::Wide, fraction_bits: u32) -> <V::Count as Word>::Wide;
    /// Replaces a flag.
    fn flag(&mut self, wire: W::Flag) -> V::Flag;

    /// Walks a part of a bundle below `step`.
    #[inline(always)]
    fn part<B: Bundle<W>>(&mut self, step: Step, part: &B) -> B::In<V>
    where
        Self: Sized,
    {
        self.enter(step);
        let other = part.rewire(self);
        self.leave();
        other
    }
}

/// A structure of wires.
pub trait Bundle<W: Word>: Copy {
    /// Bundle of the same structure in another backend.
    type In<V: Word>: Bundle<V, In<i32> = Self::In<i32>>;
    /// Number of 32-bit words of its wires; a wide wire takes two.
    const WORDS: usize;
    /// Walks all wires in the order of the fields.
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> Self::In<V>;
    /// Lowest or highest values that the declaration allows on each wire.
    fn limit<V: Word>(end: End) -> Self::In<V>;
}

impl<W: Word, const INT: u32> Bundle<W> for Fx<W, INT> {
    type In<V: Word> = Fx<V, INT>;
    const WORDS: usize = 1;
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> Fx<V, INT> {
        Fx::from_raw(with.word(self.raw(), Self::FRACTION))
    }
    fn limit<V: Word>(end: End) -> Fx<V, INT> {
        Fx::lit(end.of_bits(V::BITS))
    }
}

impl<W: Word, B: Bundle<W>, const N: usize> Bundle<W> for [B; N] {
    type In<V: Word> = [B::In<V>; N];
    const WORDS: usize = N * B::WORDS;
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> [B::In<V>; N] {
        each!(index in places() => with.part(Step::Index(index), &self[index]))
    }
    fn limit<V: Word>(end: End) -> [B::In<V>; N] {
        [B::limit(end); N]
    }
}

/// An optional part: a plan may leave it out.
impl<W: Word, B: Bundle<W>> Bundle<W> for Option<B> {
    type In<V: Word> = Option<B::In<V>>;
    const WORDS: usize = B::WORDS;
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> Option<B::In<V>> {
        self.as_ref().map(
            #[inline(always)]
            |part| part.rewire(with),
        )
    }
    fn limit<V: Word>(end: End) -> Option<B::In<V>> {
        Some(B::limit(end))
    }
}

/// Bundle whose wires hold the numbers of their words in a walk; it names a row of a batch. A wide wire has the number of its lower word; a flag
/// holds none.
pub fn numbered<B: Bundle<i32, In<i32> = B>>() -> B {
    B::limit::<i32>(End::Low).rewire(&mut Numbers(0))
}

/// Counts the words of a walk.
struct Numbers(i32);

impl Numbers {
    fn next(&mut self, words: i32) -> i32 {
        self.0 += words;
        self.0 - words
    }
}

impl Rewire<i32, i32> for Numbers {
    #[inline(always)]
    fn word(&mut self, _: i32, _: u32) -> i32 {
        self.next(1)
    }
    #[inline(always)]
    fn control(&mut self, _: i32, _: u32) -> i32 {
        self.next(1)
    }
    #[inline(always)]
    fn wide(&mut self, _: i64, _: u32) -> i64 {
        self.next(2).into()
    }
    #[inline(always)]
    fn flag(&mut self, flag: bool) -> bool {
        self.next(1);
        flag
    }
}

/// One control number, as the outcome of a stage.
#[derive(Clone, Copy, Debug)]
pub struct Value<W: Word, const INT: u32>(pub Control<W, INT>);

impl<W: Word, const INT: u32> Bundle<W> for Value<W, INT> {
    type In<V: Word> = Value<V, INT>;
    const WORDS: usize = 1;
    #[inline(always)]
    fn rewire<V: Word, R: Rewire<W, V>>(&self, with: &mut R) -> Value<V, INT> {
        Value(control::<W, V, R, INT>(self.0, with))
    }
    fn limit<V: Word>(end: End) -> Value<V, INT> {
        Value(Ranged::whole(end))
    }
}

/// Declares structures of wires and the [`Bundle`] of each.
///
/// ```
/// use roughxel_core::{bundle, fx::{Fx, Int, Wide}, word::{Wire, Word}};
///
/// bundle! {
///     /// A direction of view.
///     pub struct Look<W> {
///         /// Components.
///         #[unit = "length"]
///         #[range(-1..=1)]
///         direction: [Fx<W, 2>; 3],
///         /// Number of the eye.
///         #[range(0..16)]
///         eye: Int<W>,
///         /// The eye is closed.
///         closed: W::Flag,
///     }
/// }
/// ```
///
/// A field is a word `Fx<W, INT>`, a control number `Control<W, INT>` or `Int<W>`, a wide one `WideControl<W, INT>`, `W::Flag`, a bundle, or an array
/// of one of them. All attributes are optional and stand in this order:
/// - `#[unit = "…"]`: unit;
/// - `#[stage = "…"]`: stage that makes the field, or `#[out = "…"]` if it also leaves the datapath;
/// - `#[keeps(Lod)]`: kept fraction bits ([`Keeps`]);
/// - `#[components = "…"]`: a letter for each component;
/// - `#[per(Object)]`: the value is a constant of the object ([`Per`]);
/// - `#[range(low..=high)]` or `#[range(low..high)]`: range of the wires, in units of 1;
/// - `#[port = T]`: type at a scalar port.
///
/// `#[ports(Name)]` (or `#[ports(Name: Default)]`) after the text of the structure also declares its structure of scalar ports.
#[macro_export]
macro_rules! bundle {
    ($(
        $(#[doc = $doc:literal])*
        $(#[ports($ports:ident $(: $default:ident)?)])?
        pub struct $name:ident<W $(, const $size:ident: usize)?> { $($fields:tt)* }
    )*) => {
        $($crate::bundle!(@field { [$($doc)*] [$($ports $($default)?)?] $name [$($size)?] } [] $($fields)*);)*
    };

    // Takes the next field's attributes apart.
    (@field $head:tt [$($done:tt)*]
        $(#[doc = $text:literal])*
        $(#[unit = $unit:literal])?
        $(#[stage = $stage:literal])?
        $(#[out = $out:literal])?
        $(#[keeps($keeps:ident)])?
        $(#[components = $components:literal])?
        $(#[per($per:ident)])?
        $(#[range($($range:tt)*)])?
        $(#[port = $port:ty])?
        $field:ident: $($rest:tt)*
    ) => {
        $crate::bundle!(@type $head [$($done)*]
            { [$($text)*] [$($unit)?] [$($stage)?] [$($out)?] [$($keeps)?] [$($components)?] [$($per)?] [$($($range)*)?]
                [$($port)?] $field } $($rest)*);
    };

    // Tells kinds of wires apart.
    (@type $head:tt [$($done:tt)*] $field:tt W::Flag, $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field flag [] (W::Flag) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt Int<W>, $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field control [32 ()] ($crate::fx::Int<W>) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt [Int<W>; $n:tt], $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field control [32 ($n)] ([$crate::fx::Int<W>; $n]) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt [[Int<W>; $n:tt]; $m:tt], $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field control [32 ($m $n)] ([[$crate::fx::Int<W>; $n]; $m]) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt Control<W, $int:tt>, $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field control [$int ()] ($crate::fx::Control<W, $int>) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt [Control<W, $int:tt>; $n:tt], $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field control [$int ($n)] ([$crate::fx::Control<W, $int>; $n]) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt [[Control<W, $int:tt>; $n:tt]; $m:tt], $($rest:tt)*) => {
        $crate::bundle!(@field $head
            [$($done)* { $field control [$int ($m $n)] ([[$crate::fx::Control<W, $int>; $n]; $m]) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt WideControl<W, $int:tt>, $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field wide [$int ()] ($crate::fx::WideControl<W, $int>) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt [WideControl<W, $int:tt>; $n:tt], $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field wide [$int ($n)] ([$crate::fx::WideControl<W, $int>; $n]) }] $($rest)*);
    };
    (@type $head:tt [$($done:tt)*] $field:tt $ty:ty, $($rest:tt)*) => {
        $crate::bundle!(@field $head [$($done)* { $field bundle [$ty] ($ty) }] $($rest)*);
    };

    // All fields are known.
    (@field { [$($doc:literal)*] $ports:tt $name:ident [$($size:ident)?] } [$({
        { [$($text:literal)*] [$($unit:literal)?] [$($stage:literal)?] [$($out:literal)?] [$($keeps:ident)?] [$($components:literal)?] [$($per:ident)?]
            $range:tt [$($port:ty)?] $field:ident }
        $kind:ident $form:tt ($($ty:tt)*)
    })*]) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name<W: $crate::word::Word $(, const $size: usize)?> {
            $($(#[doc = $text])* pub $field: $($ty)*,)*
        }

        impl<W: $crate::word::Word $(, const $size: usize)?> $crate::bundle::Bundle<W> for $name<W $(, $size)?> {
            type In<V: $crate::word::Word> = $name<V $(, $size)?>;
            const WORDS: usize = 0 $(+ $crate::bundle!(@words $kind $form))*;
            #[inline(always)]
            fn rewire<V: $crate::word::Word, R: $crate::bundle::Rewire<W, V>>(&self, with: &mut R) -> Self::In<V> {
                $name {
                    $($field: {
                        const FIELD: $crate::bundle::Field = $crate::bundle::Field {
                            name: stringify!($field),
                            text: concat!($($text),*),
                            unit: concat!($($unit)?),
                            stage: concat!($($stage)? $($out)?),
                            leaves: $crate::bundle!(@leaves $($out)?),
                            keeps: $crate::bundle!(@keeps $($keeps)?),
                            components: concat!($($components)?),
                            per: $crate::bundle!(@per $($per)?),
                        };
                        with.enter($crate::bundle::Step::Field(&FIELD));
                        let other = $crate::bundle!(@walk $kind $form self.$field, with);
                        with.leave();
                        other
                    },)*
                }
            }
            fn limit<V: $crate::word::Word>(end: $crate::bundle::End) -> Self::In<V> {
                $name { $($field: $crate::bundle!(@limit $kind $form $range end),)* }
            }
        }

        $crate::bundle! { @ports $ports $name [$($doc)*] $({ [$($text)*] $field [$($port)?] })* }
    };

    (@leaves) => { false };
    (@leaves $out:literal) => { true };
    (@keeps) => { $crate::bundle::Keeps::Fraction };
    (@keeps $keeps:ident) => { $crate::bundle::Keeps::$keeps };
    (@per) => { $crate::bundle::Per::Fragment };
    (@per $per:ident) => { $crate::bundle::Per::$per };

    (@words bundle [$ty:ty]) => { <$ty as $crate::bundle::Bundle<W>>::WORDS };
    (@words wide [$int:tt ($($n:tt)*)]) => { 2 $(* $n)* };
    (@words control [$int:tt ($($n:tt)*)]) => { 1 $(* $n)* };
    (@words flag []) => { 1 };

    (@walk bundle $form:tt $wire:expr, $with:ident) => { $crate::bundle::Bundle::<W>::rewire::<V, R>(&$wire, $with) };
    (@walk flag $form:tt $wire:expr, $with:ident) => { $with.flag($wire) };
    (@walk $kind:ident [$int:tt ()] $wire:expr, $with:ident) => { $crate::bundle::$kind::<W, V, R, $int>($wire, $with) };
    (@walk $kind:ident [$int:tt ($n:tt $($m:tt)?)] $wire:expr, $with:ident) => {{
        let wires = $wire;
        $crate::each!(index in $crate::each::places() => {
            $with.enter($crate::bundle::Step::Index(index));
            let other = $crate::bundle!(@walk $kind [$int ($($m)?)] wires[index], $with);
            $with.leave();
            other
        })
    }};

    (@limit bundle [$ty:ty] [] $end:ident) => { <$ty as $crate::bundle::Bundle<W>>::limit::<V>($end) };
    (@limit flag $form:tt [] $end:ident) => { $crate::bundle::flag_limit::<V>($end) };
    (@limit $kind:ident $form:tt [] $end:ident) => { $crate::bundle::Ranged::whole($end) };
    (@limit $kind:ident $form:tt [$low:literal..=$high:literal] $end:ident) => {
        $crate::bundle::Ranged::within($end, $low, $high)
    };
    (@limit $kind:ident $form:tt [$low:literal..$high:literal] $end:ident) => {
        $crate::bundle::Ranged::below($end, $low, $high)
    };

    (@ports [] $($rest:tt)*) => {};
    (@ports [$ports:ident $($default:ident)?] $name:ident [$($doc:literal)*] $({ [$($text:literal)*] $field:ident [$port:ty] })*) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq $(, $default)?)]
        pub struct $ports {
            $($(#[doc = $text])* pub $field: $port,)*
        }

        impl $crate::ports::Port for $ports {
            type Wires = $name<$crate::scalar::Scalar>;
            #[inline]
            fn wires(&self) -> Self::Wires {
                $name { $($field: $crate::ports::Port::wires(&self.$field),)* }
            }
            #[inline]
            fn from_wires(wires: &Self::Wires) -> Self {
                Self { $($field: $crate::ports::Port::from_wires(&wires.$field),)* }
            }
        }
    };
}
pub use crate::bundle;

/// Rewires one control number of a walk; [`bundle!`](crate::bundle!) uses it.
#[inline(always)]
pub fn control<W: Word, V: Word, R: Rewire<W, V>, const INT: u32>(
    wire: Fx<W::Count, INT>,
    with: &mut R,
) -> Fx<V::Count, INT> {
    Fx::from_raw(with.control(wire.raw(), Fx::<W::Count, INT>::FRACTION))
}

/// Rewires one wide number of a walk; [`bundle!`](crate::bundle!) uses it.
#[inline(always)]
pub fn wide<W: Word, V: Word, R: Rewire<W, V>, const INT: u32>(
    wire: WideControl<W, INT>,
    with: &mut R,
) -> WideControl<V, INT> {
    Fx::from_raw(with.wide(wire.raw(), WideControl::<W, INT>::FRACTION))
}

/// Numbers, one or an array of them, at an end of a range; [`bundle!`](crate::bundle!) uses it.
pub trait Ranged: Copy {
    /// End of the range of the wire.
    fn whole(end: End) -> Self;
    /// End of `low ..= high`, in units of 1.
    fn within(end: End, low: i64, high: i64) -> Self;
    /// End of `low .. high`, in units of 1.
    fn below(end: End, low: i64, high: i64) -> Self;
}

impl<X: Wire, const INT: u32> Ranged for Fx<X, INT> {
    fn whole(end: End) -> Self {
        Self::lit(end.of_bits(X::BITS))
    }
    fn within(end: End, low: i64, high: i64) -> Self {
        Self::int(end.pick(low, high))
    }
    fn below(end: End, low: i64, high: i64) -> Self {
        end.pick(Self::int(low), Self::below(high))
    }
}

impl<T: Ranged, const N: usize> Ranged for [T; N] {
    fn whole(end: End) -> Self {
        [T::whole(end); N]
    }
    fn within(end: End, low: i64, high: i64) -> Self {
        [T::within(end, low, high); N]
    }
    fn below(end: End, low: i64, high: i64) -> Self {
        [T::below(end, low, high); N]
    }
}

/// The lowest or the highest flag; [`bundle!`](crate::bundle!) uses it.
pub fn flag_limit<V: Word>(end: End) -> V::Flag {
    let never = V::lit(0).lt(V::lit(0));
    end.pick(never, !never)
}

/// A flag that is never set.
#[inline(always)]
#[track_caller]
pub fn never<W: Wire>() -> W::Flag {
    W::lit(0).lt(W::lit(0))
}
