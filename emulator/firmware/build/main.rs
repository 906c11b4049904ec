//! Inputs of linking: the memory of the machine, the golden vectors as tables, and the plan that is priced.

mod plan;
mod samples;
mod sets;

use std::env;
use std::fs;
use std::path::PathBuf;

/// Code, data and stack of QEMU's `virt` machine lie in its one memory.
const RISCV_MEMORY: &str = "MEMORY { RAM : ORIGIN = 0x80000000, LENGTH = 64M }
REGION_ALIAS(\"REGION_TEXT\", RAM);
REGION_ALIAS(\"REGION_RODATA\", RAM);
REGION_ALIAS(\"REGION_DATA\", RAM);
REGION_ALIAS(\"REGION_BSS\", RAM);
REGION_ALIAS(\"REGION_HEAP\", RAM);
REGION_ALIAS(\"REGION_STACK\", RAM);
";

/// Programs that run without a start-up library, on soft cores that lack the registers such a library writes.
const BARE: [&str; 3] = ["clocks", "latencies", "tile"];
/// Memory of these programs, behind a line that defines its first address `_origin`.
const BARE_LAYOUT: &str = "
ENTRY(_bare)
SECTIONS {
    . = _origin;
    .text : { *(.start) *(.text .text.*) }
    .rodata : { *(.rodata .rodata.* .srodata .srodata.*) }
    .data : { *(.data .data.* .sdata .sdata.*) }
    .bss : { *(.bss .bss.* .sbss .sbss.*) }
    _stack_top = _origin + 0x40000;
    /DISCARD/ : { *(.init .init.*) *(.trap .trap.*) }
}
";

/// Programs with a start-up library.
const PROGRAMS: [&str; 4] = ["around", "check", "plan", "stages"];

/// The first two memories of QEMU's `mps2-an385`.
const CORTEX_M_MEMORY: &str = "MEMORY {
    FLASH : ORIGIN = 0x00000000, LENGTH = 4M
    RAM : ORIGIN = 0x20000000, LENGTH = 4M
}
";

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo names a folder"));
    let target = |name: &str| env::var(format!("CARGO_CFG_TARGET_{name}")).expect("cargo describes the target");
    if target("OS") == "none" {
        let riscv = target("ARCH") == "riscv32";
        fs::write(out.join("memory.x"), if riscv { RISCV_MEMORY } else { CORTEX_M_MEMORY }).expect("it can be written");
        println!("cargo:rustc-link-search={}", out.display());
        for program in PROGRAMS {
            if riscv {
                println!("cargo:rustc-link-arg-bin={program}=-Tmemory.x");
            }
            println!("cargo:rustc-link-arg-bin={program}=-Tlink.x");
        }
        println!("cargo:rerun-if-env-changed=ROUGHXEL_ORIGIN");
        // Without a wish their memory lies where QEMU's does.
        let origin = env::var("ROUGHXEL_ORIGIN").unwrap_or_else(|_| "0x80000000".into());
        fs::write(out.join("bare.x"), format!("_origin = {origin};{BARE_LAYOUT}")).expect("it can be written");
        for program in BARE {
            println!("cargo:rustc-link-arg-bin={program}=-Tbare.x");
        }
    } else {
        // Without the standard library nothing else names the C library.
        println!("cargo:rustc-link-arg=-lc");
    }
    sets::write(&out);
    plan::write(&out);
    samples::write(&out);
}
