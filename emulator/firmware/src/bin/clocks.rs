//! One plan at one accuracy on a bare RISC-V core, for a simulation that counts clocks.
//!
//! The program has one output in a simulation and in QEMU, and equal check values mean equal bits. It prints how many fragments or probes the measured
//! parts have together, so that a mean is that of one.
#![no_std]
#![no_main]
#![allow(unused_imports, dead_code, reason = "a plan names what it needs")]

use core::fmt::Write as _;
use core::hint::black_box;

use roughxel_core::firmware::*;
use roughxel_core::knob::Knob;
use roughxel_core::plan::Effects;
use roughxel_core::ports::{CubeProbe, Light, ReflectionIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::sampler::Cube;
use roughxel_core::width;
use roughxel_f32_baseline::FloatFootprint;
use roughxel_f32_baseline::formulas::Careful;
use roughxel_f32_baseline::math::{Libm, Micromath};
use roughxel_firmware::bare::{Mark, Serial, bare_entry};
use roughxel_firmware::samples::{REFLECTIONS, SAMPLES};
use roughxel_firmware::tile::{SKY_EDGE, Sky};

include!(concat!(env!("OUT_DIR"), "/plan.rs"));

bare_entry!(run);

/// Samples to a fragment that enters the check value. The others are shaded in batches alone: a bit-serial core takes a second of simulation for each.
const STRIDE: usize = 4;

/// Sky of the tile.
const SKY: Cube<'_, Sky> = Cube { memory: &Sky, edge: SKY_EDGE as u32, last_level: SKY_EDGE.ilog2(), exponent: 0 };

/// Fragment as the datapath and the f32 baseline read it, with those of its batch, and its place among all.
struct Sample {
    place: usize,
    reflection: ReflectionIn,
    batch: &'static [ReflectionIn],
    float: roughxel_f32_baseline::Fragment,
}

/// Result whose bits enter a check value.
trait Checked {
    /// Folds the bits of the result into a check value.
    fn check(self, so_far: u32) -> u32;

    /// Fragments or probes that the result is made of.
    fn units(&self) -> usize {
        BATCH
    }
}

/// Step of a check value.
fn fold(so_far: u32, bits: i32) -> u32 {
    so_far.rotate_left(5) ^ bits as u32
}

impl Checked for FaceFootprint<Plan> {
    fn check(self, so_far: u32) -> u32 {
        self.probes().fold(so_far, |check, probe| {
            let CubeProbe { face, st: [s, t], weight } = probe;
            [face.into(), s.to_bits(), t.to_bits(), weight.to_bits()].into_iter().fold(check, fold)
        })
    }
}

/// Colour of a footprint, with its probe count.
struct Coloured(Light, usize);

impl Coloured {
    /// Fetches and filters the probes of a footprint.
    #[inline(always)]
    fn new(footprint: &FaceFootprint<Plan>) -> Self {
        Self(footprint.colour(&SKY), footprint.probes().len())
    }
}

impl Checked for Coloured {
    fn check(self, so_far: u32) -> u32 {
        self.0.iter().fold(so_far, |check, light| fold(check, light.to_bits()))
    }

    fn units(&self) -> usize {
        self.1
    }
}

/// Footprints of a batch.
struct Footprints<I>(I);

impl<I: Iterator<Item = FaceFootprint<Plan>>> Checked for Footprints<I> {
    fn check(self, so_far: u32) -> u32 {
        self.0.step_by(STRIDE).fold(so_far, |check, footprint| footprint.check(check))
    }
}

impl Checked for FloatFootprint {
    fn check(self, so_far: u32) -> u32 {
        let Self { face, st, probes, step, lod, status } = &self;
        let floats = [st.x, st.y, step.x, step.y, *lod].map(|number| number.to_bits() as i32);
        let counts = [face, probes, status].map(|&count| count as i32);
        floats.into_iter().chain(counts).fold(so_far, fold)
    }
}

/// Runs one sample, or the batch that begins with it, between two marks. Returns the check value and the units so far.
#[inline(never)]
fn measured(sample: &Sample, prepared: &mut Prepared, [check, units]: [u32; 2]) -> [u32; 2] {
    let (sample, prepared) = (black_box(sample), black_box(prepared));
    Mark::Begin.set();
    let result = work!(sample, prepared);
    black_box(&result);
    Mark::End.set();
    let units = units + result.units() as u32;
    [result.check(check), units]
}

fn run() {
    let prepared = &mut prepare!();
    let mut sums = [0; 2];
    for (place, batch) in REFLECTIONS.windows(BATCH).enumerate().step_by(BATCH.max(STRIDE)) {
        let sample = Sample { place, reflection: batch[0], batch, float: (&batch[0]).into() };
        sums = measured(&sample, prepared, sums);
    }
    let [check, units] = sums;
    let _ = writeln!(Serial, "check {check}\nunits {units}");
}
