//! The register map for people and programs: a page and a C header.

use std::fmt::Write as _;

use super::description::Shell;
use super::register::{Access, Register};

/// Format of a register's value: `i18f16`, or `u1` without a point.
fn format(register: &Register) -> String {
    let sign = if register.signed { 'i' } else { 'u' };
    match register.fraction_bits {
        0 => format!("{sign}{}", register.width),
        fraction => format!("{sign}{}f{fraction}", register.width as i32 - fraction),
    }
}

/// Page of the shell of one design: registers and words.
pub(super) fn markdown(shell: &Shell) -> String {
    let mut text = format!(
        "# Registers of {}\n\n{}\n\n{} Registers are words of 32 bits.\n\n\
         | offset | name | access | format | range | reset | meaning |\n|---|---|---|---|---|---|---|\n",
        shell.module,
        shell.origin,
        shell.packets()
    );
    for register in &shell.registers {
        let access = if register.access == Access::ReadOnly { "read" } else { "read, write" };
        let (low, high) = (register.low, register.high);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| 0x{:03x} | `{}` | {access} | {} | {low} to {high} | 0x{:x} | {} |",
            register.offset,
            register.name,
            format(register),
            register.reset,
            register.description
        );
    }
    text + "\nFormats: `i` signed, `u` unsigned, bits before the point (the sign among them), `f` and bits after it. A range is of the integer, \
            which is value · 2^f.\n"
}

/// C header of the registers.
pub(super) fn c_header(shell: &Shell) -> String {
    let module = &shell.design.module;
    let capitals = module.to_ascii_uppercase();
    let mut text = format!(
        "/* Registers of {}: offsets in bytes, words of 32 bits.\n * {} */\n#ifndef {capitals}_REGISTERS_H\n#define {capitals}_REGISTERS_H\n\n",
        shell.module, shell.origin
    );
    let sizes =
        [("STREAM_BITS", shell.stream_bits), ("INPUT_WORDS", shell.input_words), ("OUTPUT_WORDS", shell.output_words)];
    for (name, value) in sizes {
        let _ = writeln!(text, "#define {capitals}_{name} {value}");
    }
    for register in &shell.registers {
        let name = format!("{capitals}_{}", register.name.to_ascii_uppercase());
        let _ = writeln!(text, "\n/* {}. */\n#define {name} 0x{:03x}u", register.description, register.offset);
        let _ = writeln!(text, "#define {name}_BITS {}", register.width);
        if register.port.is_some() {
            let _ = writeln!(text, "#define {name}_FRACTION_BITS {}", register.fraction_bits);
            let _ = writeln!(text, "#define {name}_SIGNED {}", u32::from(register.signed));
        }
        if register.access == Access::ReadOnly {
            let _ = writeln!(text, "#define {name}_VALUE 0x{:08x}u", register.reset);
        }
    }
    text + "\n#endif\n"
}
