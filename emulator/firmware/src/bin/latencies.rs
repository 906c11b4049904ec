//! Clocks of each kind of instruction on a bare RISC-V core, for a simulation that counts clocks: lines `NAME CLOCKS`.
//!
//! A measure is the difference between many and few repetitions of a body, so what surrounds it cancels. The repetitions run twice: first without
//! a print, to fill an instruction cache.
#![no_std]
#![no_main]

use core::arch::asm;
use core::fmt::{self, Write as _};

use roughxel_firmware::bare::{FINISHER, Mark, Serial, bare_entry};

bare_entry!(run);

/// Place for loads and stores.
static mut PLACE: u32 = 0;

/// Function that repeats a body between two marks, twice. The body may read a3, a4 and the place in a5, and write t0, t1 and t2.
macro_rules! repeated {
    ($count:literal, $body:literal) => {{
        #[inline(never)]
        fn repeated(places: u32) {
            // SAFETY: a body writes the listed registers and PLACE, which nothing else reads, and jumps inside of itself.
            unsafe {
                asm!(
                    "7:", "sw a1, 0(a0)", concat!(".rept ", $count), $body, ".endr", "sw a2, 0(a0)",
                    "beq a2, a6, 8f", "mv a2, a6", "j 7b", "8:",
                    in("a0") FINISHER, in("a1") Mark::Begin as u32, inout("a2") Mark::End as u32 => _, in("a6") Mark::Print as u32,
                    in("a3") places, in("a4") 0x9234_5678_u32, in("a5") &raw mut PLACE,
                    out("t0") _, out("t1") _, out("t2") _,
                );
            }
        }
        repeated as fn(u32)
    }};
}

/// Functions that repeat a body few and many times. `board` knows the difference.
macro_rules! body {
    ($body:literal) => {
        [repeated!(8, $body), repeated!(40, $body)]
    };
}

/// Runs a body with a number of places for its shifts.
fn measure(name: fmt::Arguments, places: u32, body: [fn(u32); 2]) {
    for (size, repeated) in ["few", "many"].into_iter().zip(body) {
        let _ = write!(Serial, "{name} {size} ");
        repeated(places);
    }
}

/// Instructions of any core. A body with a use has an instruction that needs the result of the one before it.
const BODIES: [(&str, [fn(u32); 2]); 15] = [
    ("plain", body!("add t0, a3, a4")),
    ("comparison", body!("sltu t0, a3, a4")),
    ("plain with use", body!("add t0, a3, a4\nadd t1, t0, a4")),
    ("shift with use", body!("sll t0, a4, a3\nadd t1, t0, a4")),
    ("load", body!("lw t0, 0(a5)")),
    ("load with use", body!("lw t0, 0(a5)\nadd t1, t0, a4")),
    ("load after seven", body!("lw t0, 0(a5)\n.rept 7\nadd t1, a3, a4\n.endr")),
    ("store", body!("sw a4, 0(a5)")),
    ("store after seven", body!("sw a4, 0(a5)\n.rept 7\nadd t1, a3, a4\n.endr")),
    ("forward taken", body!("beq x0, x0, 2f\n2:")),
    ("forward passed", body!("bne x0, x0, 2f\n2:")),
    ("forward twice and backward taken", body!("beq x0, x0, 4f\n3:\nbeq x0, x0, 5f\n4:\nbeq x0, x0, 3b\n5:")),
    ("backward passed", body!("2:\nbne x0, x0, 2b")),
    ("jump", body!("j 2f\n2:")),
    ("two jumps and one by register", body!("jal t0, 2f\nj 3f\n2:\njr t0\n3:")),
];

/// Instructions of a multiplier.
#[cfg(target_feature = "m")]
const PRODUCTS: [(&str, [fn(u32); 2]); 5] = [
    ("product", body!("mul t0, a3, a4")),
    ("product with use", body!("mul t0, a3, a4\nadd t1, t0, a4")),
    ("high product", body!("mulh t0, a3, a4")),
    ("high product with use", body!("mulh t0, a3, a4\nadd t1, t0, a4")),
    ("quotient", body!("divu t0, a4, a3")),
];
#[cfg(not(target_feature = "m"))]
const PRODUCTS: [(&str, [fn(u32); 2]); 0] = [];

fn run() {
    for (name, body) in BODIES.into_iter().chain(PRODUCTS) {
        measure(format_args!("{name}"), 1, body);
    }
    // Straight code, larger than any cache of a soft core.
    measure(format_args!("straight code"), 1, [repeated!(4096, "add t0, a3, a4"), repeated!(8192, "add t0, a3, a4")]);
    let (left, right) = (body!("sll t0, a4, a3"), body!("srl t0, a4, a3"));
    for places in 0..32 {
        measure(format_args!("{places} left"), places, left);
        measure(format_args!("{places} right"), places, right);
    }
}
