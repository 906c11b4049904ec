//! The wire of one operation: its declaration and what drives it.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::body::Body;
use super::driver::Driver;
use super::error::VerilogError;
use super::format::vector;
use super::rom::{self, Rom, count_bits};
use super::value::{View, Wire, constant_bits, view_bits};
use crate::graph::{NodeId, Op};

/// Modules that the text of a module has instances of.
#[derive(Clone, Debug, Default)]
pub(super) struct Parts {
    /// Tables.
    pub(super) roms: BTreeMap<String, Rom>,
    /// Widths of leading-zero counters.
    pub(super) leading_zeros: BTreeMap<String, u32>,
}

impl Parts {
    /// Adds those of another module.
    pub(super) fn extend(&mut self, other: &Self) {
        self.roms.extend(other.roms.iter().map(|(name, rom)| (name.clone(), *rom)));
        self.leading_zeros.extend(other.leading_zeros.iter().map(|(name, &width)| (name.clone(), width)));
    }

    /// Adds their files: path below the directory, and text.
    pub(super) fn write(&self, files: &mut BTreeMap<String, String>) {
        for (name, &width) in &self.leading_zeros {
            files.insert(format!("{name}.v"), rom::leading_zeros(name, width));
        }
        for (name, rom) in &self.roms {
            files.insert(format!("{name}.v"), rom.module(name));
            files.insert(format!("rom/{name}.hex"), rom.hex(name));
        }
    }

    /// Declares and drives the wire of a node at a rank. A port of the module is not declared. A claim is a comment of its own; any other wire has
    /// the comment `about`.
    pub(super) fn drive(
        &mut self,
        text: &mut String,
        body: &Body,
        id: NodeId,
        rank: u32,
        is_port: bool,
        about: &str,
    ) -> Result<(), VerilogError> {
        let context = body.context;
        let net = context.net;
        let wire = body.wire(id, rank);
        let driver = body.driver(id);
        let (first, last) = body.span(driver, wire.low, wire.high);
        let claim = if let (Op::Claim { low, high, lemma, .. }, Driver::Op(_)) = (body.op(id), driver) {
            // The claim is in units of the wire's lowest bit.
            format!(" // claim: {} .. {} by lemma {lemma}", low >> wire.low, high >> wire.low)
        } else {
            String::new()
        };
        let about = if claim.is_empty() { about } else { &claim };
        let declared = format!("{}{}", vector(wire.width(), wire.signed), wire.name);
        // These bits are computed and dropped.
        let mut target = Vec::new();
        let mut dropped = Vec::new();
        if last > wire.high {
            let name = format!("{}_unused_high", wire.name);
            dropped.push(format!("{}{name}", vector(last - wire.high, false)));
            target.push(name);
        }
        target.push(wire.name.clone());
        if wire.low > first {
            let name = format!("{}_unused", wire.name);
            dropped.push(format!("{}{name}", vector(wire.low - first, false)));
            target.push(name);
        }
        let target = if let [alone] = &target[..] { alone.clone() } else { format!("{{{}}}", target.join(", ")) };
        let own = (!is_port).then_some(&declared);
        let wires: Vec<String> = own.into_iter().chain(&dropped).map(|wire| format!("wire {wire};")).collect();
        let declare = |text: &mut String| {
            if wires.is_empty() { Ok(()) } else { writeln!(text, "  {}", wires.join(" ")) }
        };
        let right = match (driver, body.op(id)) {
            (Driver::Op(_), Op::Lookup(index, table)) => {
                let rom = Rom::new(table).ok_or_else(|| VerilogError::UnknownTable(net.origin(id)))?;
                declare(text)?;
                let index = body.text(index, 0, rom.index_bits(), rank).code;
                let name = context.named(&rom.name());
                writeln!(text, "  {name} {}_rom (.index({index}), .entry({target}));", wire.name)?;
                self.roms.insert(name, rom);
                return Ok(());
            }
            (Driver::Op(_), Op::LeadingZeros(a)) => {
                let width = body.counted(a);
                let name = context.named(&format!("leading_zeros_{width}"));
                let bits = count_bits(width);
                // If the number's size is known, high bits of the count are known, too.
                let used = last.clamp(1, bits);
                let count = format!("{}_count", wire.name);
                let value = body.text(a, 0, width, rank).code;
                write!(text, "  wire {}{count};", vector(used, false))?;
                let place = if used < bits {
                    write!(text, " wire {}{count}_unused;", vector(bits - used, false))?;
                    format!("{{{count}_unused, {count}}}")
                } else {
                    count.clone()
                };
                writeln!(text, "\n  {name} {count}er (.value({value}), .count({place}));")?;
                self.leading_zeros.insert(name, width);
                let counted = Wire { name: count, low: 0, high: used, signed: false };
                let above = i64::from(net.node(a).kind.bits() - width);
                let counted = view_bits(&View::of(id), &counted, first, last).code;
                if above == 0 { counted } else { format!("{counted} + {}", constant_bits(above, first, last).code) }
            }
            _ => body.expression(driver, first, last, rank),
        };
        if dropped.is_empty() && !is_port {
            writeln!(text, "  wire {declared} = {right};{about}")?;
        } else {
            declare(text)?;
            writeln!(text, "  assign {target} = {right};{about}")?;
        }
        Ok(())
    }
}
