//! Bundles of the scalar backend as lists of integers, and lists as bundles.

use std::vec::IntoIter;

use roughxel_core::bundle::{Bundle, End, Rewire, Step};

/// A wire of a bundle: its path, its fraction bits, its integer.
#[derive(Clone, Debug)]
pub struct Number {
    /// `surface.normal.mantissa[0]`.
    pub path: String,
    /// Fraction bits of the point.
    pub fraction_bits: u32,
    /// Integer on the wire; 1 for a flag that is set.
    pub integer: i64,
}

/// The wires of a bundle in the order of its walk.
pub fn numbers<B: Bundle<i32>>(bundle: &B) -> Vec<Number> {
    let mut walk = Walk::default();
    bundle.rewire::<i32, _>(&mut walk);
    walk.found
}

/// The wires of a bundle at one end of their declared ranges.
pub fn limits<B: Bundle<i32, In<i32> = B>>(end: End) -> Vec<Number> {
    numbers(&B::limit::<i32>(end))
}

/// The bundle whose wires have these integers.
///
/// # Panics
/// If the integers are fewer than the wires.
pub fn bundle<B: Bundle<i32, In<i32> = B>>(integers: Vec<i64>) -> B {
    let mut walk = Walk { instead: Some(integers.into_iter()), ..Walk::default() };
    B::limit::<i32>(End::Low).rewire(&mut walk)
}

#[derive(Default)]
struct Walk {
    path: Vec<String>,
    found: Vec<Number>,
    instead: Option<IntoIter<i64>>,
}

impl Walk {
    fn next(&mut self, integer: i64, fraction_bits: u32) -> i64 {
        if let Some(instead) = &mut self.instead {
            return instead.next().expect("as many integers as wires");
        }
        let path = self.path.concat().trim_start_matches('.').to_string();
        self.found.push(Number { path, fraction_bits, integer });
        integer
    }
}

impl Rewire<i32, i32> for Walk {
    fn enter(&mut self, step: Step) {
        if self.instead.is_none() {
            self.path.push(match step {
                Step::Field(field) => format!(".{}", field.name),
                Step::Index(index) => format!("[{index}]"),
            });
        }
    }
    fn leave(&mut self) {
        self.path.pop();
    }
    fn word(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.next(wire.into(), fraction_bits) as i32
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    fn wide(&mut self, wire: i64, fraction_bits: u32) -> i64 {
        self.next(wire, fraction_bits)
    }
    fn flag(&mut self, wire: bool) -> bool {
        self.next(wire.into(), 0) != 0
    }
}
