//! Cost of one plan at one accuracy: instructions per fragment and stack. Its bytes are those of this program less those of the plan `empty`, which
//! has the same samples and does nothing with them.
#![no_std]
#![no_main]
#![allow(unused_imports, reason = "a plan names what it needs")]

use core::hint::black_box;

use roughxel_core::firmware::*;
use roughxel_core::knob::Knob;
use roughxel_core::plan::Effects;
use roughxel_core::ports::{HighlightIn, PeakIn, ReflectionIn, TextureIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::sampler::Cube;
use roughxel_core::width;
use roughxel_firmware::machine::{between, entry, instructions, println, stack_of};
use roughxel_firmware::samples::{self, REFLECTIONS, SAMPLES, TEXTURES};
use roughxel_firmware::tile::{SKY_EDGE, Sky};

include!(concat!(env!("OUT_DIR"), "/plan.rs"));

/// Input of the plan.
#[allow(dead_code, reason = "a plan reads what it needs")]
struct Sample {
    reflection: ReflectionIn,
    highlight: HighlightIn,
    peak: PeakIn,
    texture: TextureIn,
}

/// Sky of the tile.
#[allow(dead_code, reason = "a plan names what it needs")]
const SKY: Cube<'_, Sky> = Cube { memory: &Sky, edge: SKY_EDGE as u32, last_level: SKY_EDGE.ilog2(), exponent: 0 };

/// Runs one sample and returns its instructions.
#[inline(never)]
fn measured(sample: &Sample, prepared: &Prepared) -> u32 {
    let (sample, prepared) = (black_box(sample), black_box(prepared));
    let before = instructions();
    black_box(&work!(sample, prepared));
    between(before, instructions())
}

fn run() -> i32 {
    let prepared = &prepare!();
    let (mut total, mut stack) = (0, 0);
    for (&reflection, &texture) in REFLECTIONS.iter().zip(&TEXTURES) {
        let (highlight, peak) = (samples::highlight(reflection.surface), samples::peak(reflection.surface));
        let sample = &Sample { reflection, highlight, peak, texture };
        total += measured(sample, prepared);
        let deep = stack_of(|| {
            measured(sample, prepared);
        });
        stack = deep.max(stack);
    }
    println!("instructions {}", total / SAMPLES as u32);
    println!("stack {stack}");
    0
}

entry!(run);
