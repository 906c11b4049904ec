//! Way in, marks and output of a program on a bare RISC-V core: no start-up library, no control registers, no traps.
//!
//! The devices are two of QEMU's `virt` machine: the transmitter of a serial port, and the finisher. A simulation notes the clock at a mark;
//! QEMU ignores all but the last one.

use core::fmt;
use core::ptr::write_volatile;

/// Address of the finisher.
pub const FINISHER: u32 = 0x10_0000;

/// Store to the finisher.
#[derive(Clone, Copy, Debug)]
pub enum Mark {
    /// Start of the measured part.
    Begin = 1,
    /// End of the measured part, whose clocks enter a sum.
    End = 2,
    /// End of the measured part, whose clocks are printed.
    Print = 3,
    /// End of the program.
    Finish = 0x5555,
}

impl Mark {
    /// Stores the mark.
    #[inline(always)]
    pub fn set(self) {
        // SAFETY: the address is a device of the machine, which only takes stores.
        unsafe { write_volatile(FINISHER as *mut u32, self as u32) }
    }
}

/// Serial port.
#[derive(Debug)]
pub struct Serial;

impl fmt::Write for Serial {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            // SAFETY: the address is a device of the machine, which only takes stores.
            unsafe { write_volatile(0x1000_0000 as *mut u8, byte) }
        }
        Ok(())
    }
}

/// `bare_entry!(run)`: the program calls `run` and ends.
#[macro_export]
macro_rules! bare_entry {
    ($run:ident) => {
        core::arch::global_asm!(".section .start, \"ax\"", ".globl _bare", "_bare:", "la sp, _stack_top", "j {main}", main = sym bare_main);

        extern "C" fn bare_main() -> ! {
            $run();
            $crate::bare::Mark::Finish.set();
            loop {
                core::hint::spin_loop();
            }
        }
    };
}
pub use crate::bare_entry;
