//! Cost around the stages at one accuracy, all effects on, in instructions: a probe, the set-up of a fragment, and the same reflection in f32.
#![no_std]
#![no_main]
#![allow(unused_imports, unused_macros, dead_code, reason = "of the plan only the accuracy counts")]

use core::hint::black_box;

use roughxel_core::firmware::*;
use roughxel_core::knob::Knob;
use roughxel_core::plan::Effects;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::sampler::Cube;
use roughxel_core::scanline::{Fragments, Triangle};
use roughxel_core::width;
use roughxel_f32_baseline::formulas::Careful;
use roughxel_f32_baseline::math::{Libm, Math, Micromath};
use roughxel_firmware::machine::{between, entry, instructions, println};
use roughxel_firmware::samples::{REFLECTIONS, SAMPLES};
use roughxel_firmware::tile::{self, EDGE, SKY_EDGE, Sky};

include!(concat!(env!("OUT_DIR"), "/plan.rs"));

/// All effects at that accuracy.
struct Whole;
impl Firmware for Whole {
    type Accuracy = Knobs;
    const EFFECTS: Effects = Effects::ALL;
}

fn run() -> i32 {
    probes();
    set_up();
    float::<Libm>("libm");
    float::<Micromath>("micromath");
    0
}

/// Probes of all samples, one by one.
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

/// Reflection in f32.
fn float<M: Math>(name: &str) {
    let environment = roughxel_f32_baseline::Environment::new(SKY_EDGE.into());
    let mut taken = 0;
    for fragment in &REFLECTIONS {
        let fragment = roughxel_f32_baseline::Fragment::from(fragment);
        let before = instructions();
        black_box(black_box(&environment).reflect::<M, Careful>(black_box(&fragment)));
        taken += between(before, instructions());
    }
    println!("float {name} {}", taken / SAMPLES as u32);
}

entry!(run);
