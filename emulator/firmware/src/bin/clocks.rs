//! One plan at one accuracy on a bare RISC-V core, for a simulation that counts clocks: no start-up library, no control registers, no traps.
//!
//! The devices are two of QEMU's `virt` machine: the transmitter of a serial port, and the finisher. A simulation notes the clock at
//! [`Mark::Begin`] and [`Mark::End`]; QEMU ignores both. So one program has one output on both, and equal check values mean equal bits.
#![no_std]
#![no_main]
#![allow(unused_imports, dead_code, reason = "a plan names what it needs")]

use core::fmt::{self, Write as _};
use core::hint::black_box;
use core::ptr::write_volatile;

use roughxel_core::firmware::*;
use roughxel_core::knob::Knob;
use roughxel_core::plan::Effects;
use roughxel_core::ports::{CubeProbe, ReflectionIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::width;
use roughxel_f32_baseline::FloatFootprint;
use roughxel_f32_baseline::formulas::Careful;
use roughxel_f32_baseline::math::Libm;
use roughxel_firmware::samples::REFLECTIONS;
use roughxel_firmware::tile::SKY_EDGE;

include!(concat!(env!("OUT_DIR"), "/plan.rs"));

core::arch::global_asm!(".section .start, \"ax\"", ".globl _bare", "_bare:", "la sp, _stack_top", "j {main}", main = sym main);

/// Samples to a fragment that enters the check value. The others are shaded in batches alone: a bit-serial core takes a second of simulation for each.
const STRIDE: usize = 4;

/// Fragment as the datapath and the f32 baseline read it, with those of its batch.
struct Sample {
    reflection: ReflectionIn,
    batch: &'static [ReflectionIn],
    float: roughxel_f32_baseline::Fragment,
}

/// Store to the finisher.
#[derive(Clone, Copy, Debug)]
enum Mark {
    Begin = 1,
    End = 2,
    Finish = 0x5555,
}

impl Mark {
    #[inline(always)]
    fn set(self) {
        // SAFETY: the address is a device of the machine, which only takes stores.
        unsafe { write_volatile(0x10_0000 as *mut u32, self as u32) }
    }
}

/// Serial port.
struct Serial;

impl fmt::Write for Serial {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            // SAFETY: the address is a device of the machine, which only takes stores.
            unsafe { write_volatile(0x1000_0000 as *mut u8, byte) }
        }
        Ok(())
    }
}

/// Result whose bits enter a check value.
trait Checked {
    /// Folds the bits of the result into a check value.
    fn check(self, so_far: u32) -> u32;
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

/// Runs one sample, or the batch that begins with it, between two marks.
#[inline(never)]
fn measured(sample: &Sample, prepared: &mut Prepared, check: u32) -> u32 {
    let (sample, prepared) = (black_box(sample), black_box(prepared));
    Mark::Begin.set();
    let result = work!(sample, prepared);
    black_box(&result);
    Mark::End.set();
    result.check(check)
}

extern "C" fn main() -> ! {
    let prepared = &mut prepare!();
    let mut check = 0;
    for batch in REFLECTIONS.windows(BATCH).step_by(BATCH.max(STRIDE)) {
        let sample = Sample { reflection: batch[0], batch, float: (&batch[0]).into() };
        check = measured(&sample, prepared, check);
    }
    let _ = writeln!(Serial, "check {check}\nbatch {BATCH}");
    Mark::Finish.set();
    loop {
        core::hint::spin_loop();
    }
}
