//! The tile of a picture at one accuracy on a bare RISC-V core, for a simulation that counts clocks: set-up of fragments, reflection, probes and texels.
#![no_std]
#![no_main]
#![allow(unused_imports, unused_macros, dead_code, reason = "of the plan only the accuracy counts")]

use core::fmt::Write as _;

use roughxel_core::firmware::*;
use roughxel_core::knob::Knob;
use roughxel_core::plan::Effects;
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::width;
use roughxel_firmware::bare::{Mark, Serial, bare_entry};
use roughxel_firmware::tile::{HASHES, Hash, fragments, shade};

include!(concat!(env!("OUT_DIR"), "/plan.rs"));

bare_entry!(run);

fn run() {
    Mark::Begin.set();
    let Hash(hash) = shade::<Knobs>();
    Mark::End.set();
    let mut units = 0;
    fragments(|_, _| units += 1);
    let _ = writeln!(Serial, "check {hash}\nunits {units}");
    if let Some((_, hash)) = HASHES.iter().find(|(profile, _)| profile.precision() == Knobs::PRECISION) {
        let _ = writeln!(Serial, "emulator {hash}");
    }
}
