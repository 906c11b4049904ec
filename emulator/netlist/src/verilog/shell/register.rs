//! Registers: which there are, and at which offsets.

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::super::interface::{Interface, PortDescription};
use super::super::text::identifier;

/// Bits of a byte address of the registers: a page of 4 KiB.
pub(super) const ADDRESS_BITS: u32 = 12;

/// Offset of the register that makes written values count.
pub(super) const TAKE: u32 = 4;
/// Offset of the first constant.
const FIRST: u32 = 8;

/// Ways in which a bus reaches a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Access {
    /// Read only.
    #[serde(rename = "ro")]
    ReadOnly,
    /// Read and write.
    #[serde(rename = "rw")]
    ReadWrite,
}

/// A register; no constant has more than 32 bits.
#[derive(Clone, Debug, Serialize)]
pub struct Register {
    /// Name in lower case.
    pub name: String,
    /// Offset of its first word in bytes.
    pub offset: u32,
    /// Bits of its value; a read extends a sign to the whole word.
    pub width: u32,
    /// Access of the bus.
    pub access: Access,
    /// True if the top bit is a sign.
    pub signed: bool,
    /// Value = integer / 2^fraction_bits; negative if the integer lacks zeros above the point.
    pub fraction_bits: i32,
    /// Bits after a reset.
    pub reset: u64,
    /// Port of the design, by its name in Verilog; none for `ident` and `take`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub port: Option<String>,
    /// Smallest integer of the register.
    pub low: i64,
    /// Largest integer of the register. The design is proven for values of the range and no others.
    pub high: i64,
    /// Meaning.
    pub description: String,
}

/// Bits of a constant before it is written: 0, or the value of its range next to 0.
pub(super) fn reset(port: &PortDescription) -> u64 {
    let value = 0.clamp(port.low.min(port.high), port.high);
    port.format.pack(value).unwrap_or(0)
}

/// Registers of a design: its identity, the take, its constants.
pub(super) fn map(design: &Interface, text: &str) -> Vec<Register> {
    let hash = Sha256::digest(text.as_bytes());
    let ident = hash.iter().take(4).fold(0, |ident, &byte| ident << 8 | u64::from(byte));
    let fixed = |name: &str, offset, width, access, reset, description: String| Register {
        name: name.to_owned(),
        offset,
        width,
        access,
        signed: false,
        fraction_bits: 0,
        reset,
        port: None,
        low: 0,
        high: i64::MAX >> (63 - width),
        description,
    };
    let about = format!("First 32 bits of the SHA-256 of {}.v: hardware and software are of one design", design.module);
    let mut registers = vec![fixed("ident", 0, 32, Access::ReadOnly, ident, about)];
    let constants: Vec<_> = design.inputs.iter().filter(|port| port.constant).collect();
    if !constants.is_empty() {
        let about = "Write 1: the constants as they are written count from the next fragment on. Reads 1 until a fragment took them";
        registers.push(fixed("take", TAKE, 1, Access::ReadWrite, 0, about.to_owned()));
    }
    for (offset, port) in (FIRST..).step_by(4).zip(constants) {
        let format = port.format;
        registers.push(Register {
            name: identifier(&port.name),
            offset,
            width: port.width,
            access: Access::ReadWrite,
            signed: port.signed,
            fraction_bits: format.stored_fraction_bits(),
            reset: reset(port),
            port: Some(port.port.clone()),
            low: port.low >> format.zeros,
            high: port.high >> format.zeros,
            description: port.text.clone(),
        });
    }
    registers
}
