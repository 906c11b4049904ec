//! Integers on the wires of a bundle, in any backend that makes them visible, each with its name.

use std::fmt;

use roughxel_core::bundle::{Bundle, Rewire, Step};
use roughxel_core::staged::Staged;
use roughxel_core::word::{Wire, Word};

/// Word types whose integer is visible to a test.
pub trait Visible: Staged {
    /// The integer on the wire.
    fn integer(self) -> i64;
    /// The integer on a control wire.
    fn count_integer(count: Self::Count) -> i64;
    /// The integer on a wide control wire.
    fn wide_integer(wire: <Self::Count as Word>::Wide) -> i64;
}

macro_rules! scalar {
    ($($word:ty)*) => {
        $(impl Visible for $word {
            fn integer(self) -> i64 {
                self.into()
            }
            fn count_integer(count: i32) -> i64 {
                count.into()
            }
            fn wide_integer(wire: i64) -> i64 {
                wire
            }
        })*
    };
}

scalar!(i8 i16 i32);

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
    fn control(&mut self, _: i32, _: u32) -> V::Count {
        V::Count::lit(self.next())
    }
    fn wide(&mut self, _: i64, _: u32) -> <V::Count as Word>::Wide {
        Wire::lit(self.next())
    }
    fn flag(&mut self, _: bool) -> V::Flag {
        V::lit(0).lt(V::lit(self.next()))
    }
}

/// Returns a bundle of the same form with other integers on its wires, in the order of the walk.
pub fn filled<V: Visible, B: Bundle<i32>>(form: &B, integers: &[i64]) -> B::In<V> {
    let mut given = Given(integers.iter());
    let bundle = form.rewire(&mut given);
    assert!(given.0.next().is_none(), "a wire of the bundle for every integer");
    bundle
}

/// Every wire of a bundle with its name and integer, for comparison between backends. Names are kept as the steps of a walk, because texts take
/// longer than the comparison.
#[derive(Clone, Default)]
pub struct Integers {
    values: Vec<i64>,
    /// The steps to each wire, one path after the other.
    steps: Vec<Step>,
    /// End of the path of each wire in `steps`.
    ends: Vec<usize>,
}

/// The steps to a wire, and the integer on it.
pub type Named<'a> = (&'a [Step], i64);

impl Integers {
    /// The wires of a bundle.
    pub fn from_bundle<W: Visible, B: Bundle<W>>(bundle: &B) -> Self {
        let mut list = List { path: Vec::new(), found: Self::default() };
        bundle.rewire::<W, _>(&mut list);
        list.found
    }

    /// The integers, in the order of the walk.
    pub fn values(&self) -> &[i64] {
        &self.values
    }

    /// The names: `e1.m[0]`.
    pub fn names(&self) -> impl Iterator<Item = String> {
        self.wires().map(|(path, _)| name_of(path))
    }

    /// The integer on the wire at the end of `path`.
    pub fn at(&self, path: &[Step]) -> Option<i64> {
        self.wires().find(|(of, _)| is_same(of, path)).map(|(_, value)| value)
    }

    fn wires(&self) -> impl Iterator<Item = Named<'_>> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).zip(&self.values).map(|((&start, &end), &value)| (&self.steps[start..end], value))
    }

    fn add(&mut self, path: &[Step], value: i64) {
        self.values.push(value);
        self.steps.extend_from_slice(path);
        self.ends.push(self.steps.len());
    }
}

impl<'a> FromIterator<Named<'a>> for Integers {
    fn from_iter<I: IntoIterator<Item = Named<'a>>>(wires: I) -> Self {
        let mut integers = Self::default();
        wires.into_iter().for_each(|(path, value)| integers.add(path, value));
        integers
    }
}

impl PartialEq for Integers {
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values && self.ends == other.ends && is_same(&self.steps, &other.steps)
    }
}

impl fmt::Debug for Integers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.wires().map(|(path, value)| (name_of(path), value))).finish()
    }
}

/// Returns true if the steps have the same names.
fn is_same(a: &[Step], b: &[Step]) -> bool {
    let is_same = |(a, b): (&Step, &Step)| match (a, b) {
        // One declaration, or two in which a field has the same name.
        (Step::Field(a), Step::Field(b)) => std::ptr::eq(*a, *b) || a.name == b.name,
        (Step::Index(a), Step::Index(b)) => a == b,
        _ => false,
    };
    a.len() == b.len() && a.iter().zip(b).all(is_same)
}

/// The text of a path.
fn name_of(path: &[Step]) -> String {
    path.iter().fold(String::new(), |name, step| match step {
        Step::Field(field) if name.is_empty() => field.name.to_owned(),
        Step::Field(field) => format!("{name}.{}", field.name),
        Step::Index(index) => format!("{name}[{index}]"),
    })
}

/// Lists the wires of a walk.
struct List {
    path: Vec<Step>,
    found: Integers,
}

impl List {
    fn add(&mut self, value: i64) {
        self.found.add(&self.path, value);
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
        self.add(wire.integer());
        wire
    }
    fn control(&mut self, wire: W::Count, _: u32) -> W::Count {
        self.add(W::count_integer(wire));
        wire
    }
    fn wide(&mut self, wire: <W::Count as Word>::Wide, _: u32) -> <W::Count as Word>::Wide {
        self.add(W::wide_integer(wire));
        wire
    }
    fn flag(&mut self, wire: W::Flag) -> W::Flag {
        self.add(W::select(wire, W::lit(1), W::lit(0)).integer());
        wire
    }
}

/// The first name whose integers differ, with both.
pub fn first_difference(a: &Integers, b: &Integers) -> Option<String> {
    let differ = |((path, a), (other, b)): &(Named<'_>, Named<'_>)| a != b || !is_same(path, other);
    let ((path, a), (_, b)) = a.wires().zip(b.wires()).find(differ)?;
    Some(format!("{}: {a} and {b}", name_of(path)))
}
