//! Checks on every processor: the bits are the same, a wrong table entry is noticed, and the kept prices are those of this datapath.

use std::path::Path;

use crate::image::{self, Image};
use crate::measure::ALL_EFFECTS;
use crate::price;
use crate::target::Target;
use crate::{Failure, clocks};

/// Table with one entry made wrong; every reflection reads it.
const WRONG_TABLE: &str = "reciprocal::T10";

/// Tables that a program with environment mapping alone may hold: the seeds of a reciprocal, and the table for leading zeros.
const SMALLEST: [&str; 2] = [WRONG_TABLE, "LEADING_ZEROS"];

/// Functions that make a product without a multiplier, with the most shifts that their code may have. Their sources have 0 and 16.
const PRODUCT: [(&str, usize); 2] =
    [("small::product::product_by_adds", 0), ("small::product::product_of_magnitudes", 20)];

/// Runs everything on these targets.
pub fn run(targets: &[Target]) -> Result<(), Failure> {
    clocks::hold()?;
    let names: Vec<&str> = targets.iter().map(|target| target.name()).collect();
    eprintln!("building for {}: the first time takes minutes", names.join(", "));
    Target::build_each(targets, "check", "empty", "standard")?;
    for &target in targets {
        let program = target.place("check");
        let (code, text) = target.run(&program)?;
        let summary = text.lines().last().unwrap_or_default();
        println!("{:12} {summary}", target.name());
        match code {
            0 => {}
            3 => return Err(Failure::broken(format!("on {}:\n{text}", target.name()))),
            other => return Err(Failure::trouble(format!("on {}: exit code {other}\n{text}", target.name()))),
        }
        wrong_entry(target, &program)?;
        if target == Target::Riscv32I {
            few_shifts(&program)?;
            clocks::hold_predictions(target)?;
        }
    }
    smallest(&targets.iter().copied().filter(|target| target.is_small()).collect::<Vec<_>>())?;
    if targets.contains(&Target::Riscv32Imac) {
        price::hold(Target::Riscv32Imac)?;
    }
    Ok(())
}

/// Checks that a compiler has not turned branches of a product into sign masks, nor unrolled its loops: a core without a multiplier may shift one
/// place a clock.
fn few_shifts(program: &Path) -> Result<(), Failure> {
    for (function, most) in PRODUCT {
        // Shifts have the major opcode 0x13 or 0x33 and the minor one 1 or 5; bit 30 makes one arithmetic.
        let is_shift = |code: &u32| matches!(code & 0x7f, 0x13 | 0x33) && matches!(code >> 12 & 7, 1 | 5);
        let shifts: Vec<u32> = image::instructions(program, function)?.into_iter().filter(is_shift).collect();
        let masks = shifts.iter().filter(|&code| code >> 30 & 1 == 1).count();
        if masks > 0 || shifts.len() > most {
            return Err(Failure::broken(format!(
                "{function} has {} shifts, {masks} of them arithmetic; at most {most} and none are allowed",
                shifts.len()
            )));
        }
    }
    println!("{:12} products without a multiplier: no sign masks", "");
    Ok(())
}

/// Checks that a program whose table has one wrong entry says so.
fn wrong_entry(target: Target, program: &Path) -> Result<(), Failure> {
    let image = Image::read(program)?;
    let Some(&(place, bytes)) = image.tables.get(WRONG_TABLE) else {
        return Err(Failure::trouble(format!("{}: no table {WRONG_TABLE}", program.display())));
    };
    let mut file = std::fs::read(program).map_err(Failure::trouble)?;
    // A 32-bit entry in the middle, wrong by 2^−8. The Newton step after it leaves the square of that, 2^−16, which shows. Of an error as small as a
    // seed's own it leaves nothing that shows.
    let entry = (place + bytes / 2 / 4 * 4) as usize;
    let byte = if target.big_endian() { entry + 1 } else { entry + 2 };
    file[byte] ^= 0x40;
    let wrong = program.with_extension("wrong");
    std::fs::write(&wrong, file).map_err(Failure::trouble)?;
    make_executable(program, &wrong)?;
    let (code, text) = target.run(&wrong)?;
    let summary = text.lines().last().unwrap_or_default();
    println!("{:12} with a wrong entry of {WRONG_TABLE}: {summary}", "");
    if code == 3 {
        return Ok(());
    }
    Err(Failure::broken(format!("on {} nothing notices the wrong entry (exit code {code})", target.name())))
}

fn make_executable(like: &Path, path: &Path) -> Result<(), Failure> {
    let permissions = std::fs::metadata(like).map_err(Failure::trouble)?.permissions();
    std::fs::set_permissions(path, permissions).map_err(Failure::trouble)
}

/// Checks that environment mapping alone holds no table of an effect that is off.
fn smallest(targets: &[Target]) -> Result<(), Failure> {
    let images = |plan: &str| {
        Target::build_each(targets, "plan", plan, "standard")?;
        targets.iter().map(|target| Image::read(&target.place("plan"))).collect::<Result<Vec<_>, _>>()
    };
    let (empty, environment, whole) = (images("empty")?, images("reflection")?, images(ALL_EFFECTS)?);
    for (((target, empty), image), whole) in targets.iter().zip(empty).zip(environment).zip(whole) {
        let bytes = image.bytes - empty.bytes;
        let tables: Vec<&str> = image.tables.keys().map(String::as_str).collect();
        println!("{:12} environment alone: {bytes} bytes, tables {}", target.name(), tables.join(", "));
        if let Some(table) = tables.iter().find(|table| !SMALLEST.contains(table)) {
            return Err(Failure::broken(format!("environment alone holds {table}")));
        }
        if bytes * 3 > whole.bytes - empty.bytes {
            return Err(Failure::broken(format!(
                "environment alone is {bytes} bytes of {}",
                whole.bytes - empty.bytes
            )));
        }
    }
    Ok(())
}
