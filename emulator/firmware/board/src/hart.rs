//! Simulator of RV32IM instructions for the programs of soft cores. It says what each instruction was, which no clock of a core tells.

use crate::Failure;

/// First address of the memory.
const MEMORY: u32 = 0x8000_0000;
/// Bytes of the memory.
const BYTES: usize = 1 << 18;
/// Address of the finisher, which takes marks.
const FINISHER: u32 = 0x0010_0000;
/// Address of the serial port.
const SERIAL: u32 = 0x1000_0000;

/// Kind of an instruction, as far as its clocks depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Sum, logic, constant.
    Plain,
    /// Comparison whose result is a number.
    Comparison,
    /// Shift to the left by some places.
    Left(usize),
    /// Shift to the right by some places.
    Right(usize),
    /// Low word of a product.
    Product,
    /// High word of a product.
    HighProduct,
    /// Quotient or remainder.
    Quotient,
    /// Load.
    Load,
    /// Store.
    Store,
    /// Conditional branch.
    Branch {
        /// True if it jumps.
        is_taken: bool,
        /// True if its target lies at a lower address.
        is_backward: bool,
    },
    /// Jump to a constant place.
    Jump,
    /// Jump to a place in a register.
    JumpRegister,
}

impl Kind {
    /// Number of kinds.
    pub const COUNT: usize = 77;

    /// Place of the kind among all.
    pub fn place(self) -> usize {
        match self {
            Self::Left(places) => places,
            Self::Right(places) => 32 + places,
            Self::Plain => 64,
            Self::Comparison => 65,
            Self::Product => 66,
            Self::HighProduct => 67,
            Self::Quotient => 68,
            Self::Load => 69,
            Self::Store => 70,
            Self::Jump => 71,
            Self::JumpRegister => 72,
            Self::Branch { is_taken, is_backward } => 73 + 2 * usize::from(is_taken) + usize::from(is_backward),
        }
    }
}

/// Instruction that has run.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Address of the instruction.
    pub address: u32,
    /// Kind of the instruction.
    pub kind: Kind,
    /// Registers that it reads; 0 for none.
    pub reads: [usize; 2],
    /// Register that it writes; 0 for none.
    pub writes: usize,
    /// Value of a store to the finisher.
    pub mark: Option<u32>,
}

/// Processor with its memory.
pub struct Hart {
    counter: u32,
    registers: [u32; 32],
    memory: Vec<u8>,
    /// Text that the program has printed.
    pub printed: String,
}

impl Hart {
    /// Prepares a program, which is memory from its first address on.
    pub fn new(program: &[u8]) -> Result<Self, Failure> {
        let mut memory = program.to_vec();
        if memory.len() > BYTES {
            return Err(Failure::trouble("the program is larger than the memory"));
        }
        memory.resize(BYTES, 0);
        Ok(Self { counter: MEMORY, registers: [0; 32], memory, printed: String::new() })
    }

    /// Place of some bytes in the memory.
    fn place(address: u32, bytes: usize) -> Result<usize, Failure> {
        let place = address.wrapping_sub(MEMORY) as usize;
        if place.is_multiple_of(bytes) && place < BYTES {
            return Ok(place);
        }
        Err(Failure::trouble(format!("no memory of {bytes} bytes at {address:#x}")))
    }

    fn load(&self, address: u32, minor: u32) -> Result<u32, Failure> {
        let bytes = 1 << (minor & 3);
        let place = Self::place(address, bytes)?;
        let value = self.memory[place..place + bytes].iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte));
        let spare = 32 - 8 * bytes as u32;
        Ok(if minor & 4 == 0 { ((value << spare) as i32 >> spare) as u32 } else { value })
    }

    /// Stores a value. Returns it if it goes to the finisher.
    fn store(&mut self, address: u32, minor: u32, value: u32) -> Result<Option<u32>, Failure> {
        match address {
            FINISHER => return Ok(Some(value)),
            SERIAL => self.printed.push(char::from(value as u8)),
            _ => {
                let bytes = 1 << minor;
                let place = Self::place(address, bytes)?;
                self.memory[place..place + bytes].copy_from_slice(&value.to_le_bytes()[..bytes]);
            }
        }
        Ok(None)
    }

    /// Runs one instruction.
    pub fn step(&mut self) -> Result<Step, Failure> {
        let address = self.counter;
        let code = self.load(address, 2)?;
        let (major, minor, upper) = (code & 0x7f, code >> 12 & 7, code >> 25);
        let field = |low: u32| (code >> low & 31) as usize;
        let (rd, rs1, rs2) = (field(7), field(15), field(20));
        let (a, b) = (self.registers[rs1], self.registers[rs2]);
        let signed = code as i32;
        let immediate = (signed >> 20) as u32;
        let mut step = Step { address, kind: Kind::Plain, reads: [rs1, 0], writes: rd, mark: None };
        let mut next = address.wrapping_add(4);
        let mut value = 0;
        match major {
            // Upper immediates.
            0x37 | 0x17 => {
                step.reads = [0; 2];
                value = (code & !0xfff).wrapping_add(if major == 0x17 { address } else { 0 });
            }
            0x6f => {
                (step.kind, step.reads, value) = (Kind::Jump, [0; 2], next);
                let offset =
                    (signed >> 31) as u32 & !0xf_ffff | code & 0xf_f000 | code >> 9 & 0x800 | code >> 20 & 0x7fe;
                next = address.wrapping_add(offset);
            }
            0x67 => {
                (step.kind, value) = (Kind::JumpRegister, next);
                next = a.wrapping_add(immediate) & !1;
            }
            0x63 => {
                let offset = (signed >> 31) as u32 & !0xfff | code << 4 & 0x800 | code >> 20 & 0x7e0 | code >> 7 & 0x1e;
                let holds = match minor >> 1 {
                    0 => a == b,
                    2 => (a as i32) < b as i32,
                    _ => a < b,
                };
                let (is_taken, is_backward) = (holds != (minor & 1 == 1), offset >> 31 == 1);
                (step.kind, step.reads, step.writes) = (Kind::Branch { is_taken, is_backward }, [rs1, rs2], 0);
                if is_taken {
                    next = address.wrapping_add(offset);
                }
            }
            0x03 => {
                step.kind = Kind::Load;
                value = self.load(a.wrapping_add(immediate), minor)?;
            }
            0x23 => {
                (step.kind, step.reads, step.writes) = (Kind::Store, [rs1, rs2], 0);
                let offset = (signed >> 25 << 5) as u32 | rd as u32;
                step.mark = self.store(a.wrapping_add(offset), minor, b)?;
            }
            0x33 if upper == 1 => {
                step.reads = [rs1, rs2];
                (step.kind, value) = multiplied(minor, a, b);
            }
            0x13 | 0x33 => {
                let is_register = major == 0x33;
                let other = if is_register { b } else { immediate };
                step.reads = [rs1, if is_register { rs2 } else { 0 }];
                let is_second = upper == 0x20 && (is_register || minor == 5);
                (step.kind, value) = computed(minor, is_second, a, other);
            }
            // A fence.
            0x0f => (step.reads, step.writes) = ([0; 2], 0),
            _ => return Err(Failure::trouble(format!("unknown instruction {code:#010x} at {address:#x}"))),
        }
        if step.writes != 0 {
            self.registers[step.writes] = value;
        }
        self.counter = next;
        Ok(step)
    }
}

/// Instruction of two operands. The second one of two with a number subtracts, or shifts with the sign.
fn computed(minor: u32, is_second: bool, a: u32, b: u32) -> (Kind, u32) {
    let places = b & 31;
    let value = match (minor, is_second) {
        (0, true) => a.wrapping_sub(b),
        (0, false) => a.wrapping_add(b),
        (1, _) => return (Kind::Left(places as usize), a << places),
        (2, _) => return (Kind::Comparison, u32::from((a as i32) < b as i32)),
        (3, _) => return (Kind::Comparison, u32::from(a < b)),
        (4, _) => a ^ b,
        (5, true) => return (Kind::Right(places as usize), (a as i32 >> places) as u32),
        (5, false) => return (Kind::Right(places as usize), a >> places),
        (6, _) => a | b,
        _ => a & b,
    };
    (Kind::Plain, value)
}

/// Instruction of the extension for products.
fn multiplied(minor: u32, a: u32, b: u32) -> (Kind, u32) {
    let signed = |word: u32| i64::from(word as i32);
    match minor {
        0 => (Kind::Product, a.wrapping_mul(b)),
        1 => (Kind::HighProduct, ((signed(a) * signed(b)) >> 32) as u32),
        2 => (Kind::HighProduct, ((signed(a) * i64::from(b)) >> 32) as u32),
        3 => (Kind::HighProduct, ((u64::from(a) * u64::from(b)) >> 32) as u32),
        4 => (Kind::Quotient, if b == 0 { u32::MAX } else { (a as i32).wrapping_div(b as i32) as u32 }),
        5 => (Kind::Quotient, a.checked_div(b).unwrap_or(u32::MAX)),
        6 => (Kind::Quotient, if b == 0 { a } else { (a as i32).wrapping_rem(b as i32) as u32 }),
        _ => (Kind::Quotient, a.checked_rem(b).unwrap_or(a)),
    }
}
