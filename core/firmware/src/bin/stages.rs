//! What stages cost at one accuracy, all effects on: instructions of each, of a probe, of the set-up of a fragment; and of the same
//! reflection in f32.
#![no_std]
#![no_main]
#![allow(unused_imports, unused_macros, dead_code, reason = "of the plan only the accuracy counts")]

use core::cell::UnsafeCell;
use core::hint::black_box;

use roughxel_core::bundle::{Bundle, Value};
use roughxel_core::datapath;
use roughxel_core::firmware::*;
use roughxel_core::fx::Fx;
use roughxel_core::plan::Effects;
use roughxel_core::ports::Port;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::sampler::Cube;
use roughxel_core::scanline::{Fragments, Triangle};
use roughxel_core::staged::Staged;
use roughxel_core::width::{IntegerCount, of_ports};
use roughxel_firmware::machine::{between, entry, instructions, println};
use roughxel_firmware::metered::{Meter, Metered, metered};
use roughxel_firmware::samples::{self, REFLECTIONS, SAMPLES, TEXTURES};
use roughxel_firmware::tile::{self, EDGE, SKY_EDGE, Sky};
use roughxel_float::math::{Libm, Math, Micromath};

include!(concat!(env!("OUT_DIR"), "/plan.rs"));

/// The plan's accuracy with all effects.
struct Whole;
impl Firmware for Whole {
    type Accuracy = <Plan as Firmware>::Accuracy;
    const EFFECTS: Effects = Effects::ALL;
}

type Word = <<Plan as Firmware>::Accuracy as Accuracy>::Word;
type MeteredWord = Metered<Word, Clock>;
const KNOBS: &Precision = &<<Plan as Firmware>::Accuracy as Accuracy>::PRECISION;

/// The counter, and what stages have taken by it, in the order in which they first ran.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Clock;

/// Stages there may be.
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
        // SAFETY: nobody holds a reference to the table beyond this call.
        let table = unsafe { &mut *TABLE.0.get() };
        if let Some(entry) = table.iter_mut().find(|(name, _)| *name == stage || name.is_empty()) {
            *entry = (stage, entry.1 + between(before, after));
        }
    }
}

/// Prints a mean over the samples of what stages have taken since the last call.
fn print_stages(datapath: &str) {
    // SAFETY: as above.
    let table = unsafe { &mut *TABLE.0.get() };
    // A stage that does nothing: what reading the counter and handing on a number take.
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

    probes();
    set_up();
    float::<Libm>("libm");
    float::<Micromath>("micromath");
    0
}

/// The probes of all samples, one by one.
fn probes() {
    let environment = Whole::environment(SKY_EDGE);
    let cube = Cube { memory: &Sky, edge: SKY_EDGE.into(), last_level: SKY_EDGE.ilog2(), exponent: 0 };
    let (mut taken, mut count, mut sampled) = (0, 0, 0);
    for fragment in &REFLECTIONS {
        let footprint = black_box(Whole::reflect(fragment, &environment));
        let before = instructions();
        for probe in black_box(&footprint).probes() {
            black_box(&probe);
            count += 1;
        }
        taken += between(before, instructions());
        let before = instructions();
        black_box(black_box(&footprint).colour(&cube));
        sampled += between(before, instructions());
    }
    println!("probe {}", taken / count);
    println!("probes {}", count * 100 / SAMPLES as u32);
    println!("colour {}", sampled / count);
}

/// Fragments of the tile, without texture coordinates and with them.
fn set_up() {
    let (vertices, attributes, template) = tile::corners();
    let before = instructions();
    let triangle = black_box(Triangle::new(black_box(&vertices)));
    let Some(triangle) = triangle else { return };
    let fragments = black_box(Fragments::new(&triangle, black_box(&attributes), &template));
    println!("triangle {}", between(before, instructions()));
    let _ = fragments;
    for (name, uv) in [("fragment", None), ("textured", attributes.uv)] {
        let fragments = Fragments::new(&triangle, &tile::Attributes { uv, ..attributes }, &template);
        let (mut taken, mut count) = (0, 0);
        for y in 0..EDGE {
            let before = instructions();
            for fragment in black_box(&fragments).row(y, 0..EDGE) {
                black_box(&fragment);
                count += 1;
            }
            taken += between(before, instructions());
        }
        println!("{name} {}", taken / count);
    }
}

/// The reflection in f32.
fn float<M: Math>(name: &str) {
    let environment = roughxel_float::Environment::new(SKY_EDGE.into());
    let mut taken = 0;
    for fragment in &REFLECTIONS {
        let fragment = roughxel_float::Fragment::from(fragment);
        let before = instructions();
        black_box(black_box(&environment).reflect::<M>(black_box(&fragment)));
        taken += between(before, instructions());
    }
    println!("float {name} {}", taken / SAMPLES as u32);
}

entry!(run);
