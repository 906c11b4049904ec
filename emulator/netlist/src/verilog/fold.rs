//! The folded design: few units that many operations use in turn.
//!
//! A flat design begins a fragment each cycle and has a multiplier for every product. A folded one begins a fragment every `interval` cycles, on a
//! given number of multipliers. Runs of a stage that are the same hardware exist once (`shape`). Expensive operations share units (`units`), which
//! are joined (`compound`) and take in what stands next to them (`grow`). Products of a sum follow each other into an accumulator (`sums`). A modulo
//! schedule gives each operation its cycle (`tasks`, `schedule`), an exchange of operations finds the units with the fewest choices (`binding`), and
//! `text` writes the top with its `registers`. `machine` runs the schedule in integers, `slots` lists it.

mod binding;
mod compound;
mod folded;
mod grow;
mod machine;
mod registers;
mod schedule;
mod shape;
mod slots;
mod sums;
mod tasks;
mod text;
mod units;

use std::collections::BTreeMap;

pub use self::folded::{FoldSummary, Folded, UnitSummary};
pub use self::machine::{Fault, Machine};
pub use self::slots::Slot;
use self::units::Hardware;
use super::context::Context;
use super::error::VerilogError;
use super::interface::Interface;
use super::module::Module;
use super::share::Group;
use super::text::filled;
use super::wire::Parts;
use crate::interval::Ranges;
use crate::target::Target;

/// Multiplier of two signed operands, with a rank of registers before and one after it.
const MULTIPLIER: &str = include_str!("templates/multiplier.v");

/// A folded design as Verilog.
pub(super) struct FoldedVerilog {
    pub(super) interface: Interface,
    pub(super) files: BTreeMap<String, String>,
    pub(super) modules: Vec<Module>,
    pub(super) parts: Parts,
    pub(super) register_bits: u32,
    pub(super) summary: FoldSummary,
}

/// Folds a proven design without writing it.
pub(super) fn fold(flat: Context, own: &Ranges, groups: &[Group], multipliers: u32) -> Result<Folded, VerilogError> {
    Ok(Folded::new(flat, own, groups, multipliers, |_, _| Ok(()))?.0)
}

/// Folds a proven design on a number of multipliers and writes it. `own` are the ranges of every wire by itself, `flat` has those of the flat design.
pub(super) fn write(
    flat: Context,
    own: &Ranges,
    groups: &[Group],
    multipliers: u32,
    name: &str,
    description: &str,
) -> Result<FoldedVerilog, VerilogError> {
    let (folded, top) =
        Folded::new(flat, own, groups, multipliers, |folded, body| text::top(folded, body, flat, name, description))?;
    // Yosys 0.23 to 0.70 may take a product's register into a block of another one.
    let keep = if flat.target == Target::Ice40 { "(* keep_hierarchy *)\n" } else { "" };
    let mut files = BTreeMap::new();
    let mut parts = top.parts;
    let mut modules = Vec::new();
    for kind in &folded.kinds {
        match &kind.hardware {
            Hardware::Multiplier { .. } => {
                files.insert(
                    format!("{}.v", kind.name),
                    filled(MULTIPLIER, &[("NAME", kind.name.clone()), ("KEEP", keep.to_owned())]),
                );
            }
            Hardware::Module(module) => {
                files.insert(format!("{}.v", module.name), module.text.clone());
                parts.extend(&module.parts);
                modules.push((**module).clone());
            }
        }
    }
    if top.uses_ring {
        let name = flat.named(registers::RING);
        files.insert(format!("{name}.v"), filled(include_str!("templates/ring.v"), &[("NAME", name)]));
    }
    files.insert(format!("{name}.v"), top.text);
    files.insert(format!("{name}.slots.txt"), folded.slot_table());
    let summary = folded.summary();
    Ok(FoldedVerilog { interface: top.interface, files, modules, parts, register_bits: top.register_bits, summary })
}
