//! Golden vectors through the scalar datapath, every field compared.

use roughxel_core::bundle::{Bundle, End, Rewire};
use roughxel_core::plan::Datapath;
use roughxel_core::scalar_api;

use crate::machine::println;
use crate::sets::Set;

/// Maximum number of integers of an input or an output.
const MOST: usize = 128;

/// Maximum number of printed mismatches of a set.
const PRINTED: u32 = 3;

/// Runs a set and returns the number of its vectors, and of their fields that differ; the first are printed.
pub fn run(set: &Set) -> (u32, u32) {
    let precision = set.profile.precision();
    let (mut vectors, mut differ) = (0, 0);
    for row in set.vectors() {
        let mut row = row;
        let mut inputs = [0; MOST];
        for place in set.inputs {
            inputs[usize::from(*place)] = row.next().unwrap_or(0);
        }
        let outputs = match set.datapath {
            Datapath::Reflection => {
                integers(&scalar_api::fragment(&bundle(&inputs), &set.effects.reflection(), &precision))
            }
            Datapath::Highlight => {
                integers(&scalar_api::highlight(&bundle(&inputs), &set.effects.highlight(), &precision))
            }
            Datapath::Peak => integers(&scalar_api::lit_peak(&bundle(&inputs), &set.effects.peak(), &precision)),
        };
        for (place, expected) in set.outputs.iter().zip(row) {
            let (place, name) = (usize::from(*place), set.names[usize::from(*place)]);
            if outputs[place] != expected {
                differ += 1;
                if differ <= PRINTED {
                    let got = outputs[place];
                    println!("{} [{vectors}] {name}: expected {expected:#010x}, got {got:#010x}", set.name);
                }
            }
        }
        vectors += 1;
    }
    (vectors, differ)
}

/// Bundle of these integers, in the order of its walk.
fn bundle<B: Bundle<i32, In<i32> = B>>(integers: &[i32; MOST]) -> B {
    B::limit::<i32>(End::Low).rewire(&mut Numbers { integers: *integers, next: 0, read: true })
}

/// Integers of a bundle, in the order of its walk.
fn integers<B: Bundle<i32>>(bundle: &B) -> [i32; MOST] {
    let mut numbers = Numbers { integers: [0; MOST], next: 0, read: false };
    bundle.rewire::<i32, _>(&mut numbers);
    numbers.integers
}

/// A walk that reads the numbers of a bundle from a list or writes them to it.
struct Numbers {
    integers: [i32; MOST],
    next: usize,
    read: bool,
}

impl Rewire<i32, i32> for Numbers {
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        let place = &mut self.integers[self.next];
        self.next += 1;
        if !self.read {
            *place = wire;
        }
        *place
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    // No datapath with vectors has a wide wire or a flag at its ports.
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        wire
    }
    fn flag(&mut self, wire: bool) -> bool {
        wire
    }
}
