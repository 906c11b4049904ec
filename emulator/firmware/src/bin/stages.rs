//! Cost of each stage in instructions, at one accuracy, all effects on.
#![no_std]
#![no_main]
#![allow(unused_imports, unused_macros, dead_code, reason = "of the plan only the accuracy counts")]

use core::cell::UnsafeCell;
use core::hint::black_box;

use roughxel_core::bundle::{Bundle, Value};
use roughxel_core::datapath;
use roughxel_core::firmware::*;
use roughxel_core::fx::Fx;
use roughxel_core::knob::Knob;
use roughxel_core::plan::Effects;
use roughxel_core::ports::Port;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::staged::Staged;
use roughxel_core::width::{self, of_ports};
use roughxel_firmware::machine::{between, entry, instructions, println};
use roughxel_firmware::metered::{Meter, Metered, metered};
use roughxel_firmware::samples::{self, REFLECTIONS, SAMPLES};
use roughxel_firmware::tile::SKY_EDGE;

include!(concat!(env!("OUT_DIR"), "/plan.rs"));

type Word = <Knobs as Accuracy>::Word;
type MeteredWord = Metered<Word, Clock>;
const KNOBS: &Precision = &Knobs::PRECISION;

/// Instruction counter, and the instructions of stages in the order in which they first ran.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Clock;

/// Maximum number of stages.
const MOST: usize = 64;

/// Names and instructions.
struct Table(UnsafeCell<[(&'static str, u32); MOST]>);
// SAFETY: there is one thread, and no interrupt.
unsafe impl Sync for Table {}
static TABLE: Table = Table(UnsafeCell::new([("", 0); MOST]));

impl Meter for Clock {
    #[inline(always)]
    fn now() -> u32 {
        instructions()
    }
    #[inline(never)]
    fn took(stage: &'static str, before: u32, after: u32) {
        // SAFETY: nothing holds a reference to the table beyond this call.
        let table = unsafe { &mut *TABLE.0.get() };
        if let Some(entry) = table.iter_mut().find(|(name, _)| *name == stage || name.is_empty()) {
            *entry = (stage, entry.1 + between(before, after));
        }
    }
}

/// Prints a mean over the samples of the instructions of stages since the last call.
fn print_stages(datapath: &str) {
    // SAFETY: as above.
    let table = unsafe { &mut *TABLE.0.get() };
    // A stage that does nothing: the cost of reading the counter and passing a number on.
    let nothing = table.iter().find(|(name, _)| *name == "nothing").map_or(0, |(_, taken)| *taken);
    for (name, taken) in table.iter().filter(|(name, _)| !name.is_empty() && *name != "nothing") {
        println!("stage {datapath} {name} {}", taken.saturating_sub(nothing) / SAMPLES as u32);
    }
    *table = [("", 0); MOST];
}

fn nothing() {
    let zero = MeteredWord::stage("nothing", || Value::<MeteredWord, 32>(Fx::int(0)));
    black_box(&zero);
}

/// Runs a datapath on its metered input.
macro_rules! stages {
    ($datapath:literal, |$index:ident| $input:expr, |$metered:ident| $run:expr) => {
        for $index in 0..SAMPLES {
            let $metered = metered::<Word, Clock, _>(&of_ports::<Word, _>(&$input.wires()));
            nothing();
            let $metered = black_box(&$metered);
            black_box(&$run);
        }
        print_stages($datapath);
    };
}

fn run() -> i32 {
    let plan = const { Effects::ALL.reflection() };
    let map = datapath::map_scale::<MeteredWord>(Fx::int(SKY_EDGE.into()), KNOBS);
    stages!("reflection", |index| REFLECTIONS[index], |input| datapath::reflection(input, &map, &plan, KNOBS));
    let lit = const { Effects::ALL.highlight() };
    stages!("highlight", |index| samples::highlight(REFLECTIONS[index].surface), |input| {
        datapath::lit_surface(input, &lit, KNOBS)
    });
    let on_peaks = const { Effects::ALL.peak() };
    stages!("peak", |index| samples::peak(REFLECTIONS[index].surface), |input| {
        datapath::lit_peak(input, &on_peaks, KNOBS)
    });
    0
}

entry!(run);
