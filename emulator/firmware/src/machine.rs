//! Differences between machines: the way in and out, the instruction counter, the stack.

#[cfg(not(target_os = "none"))]
pub use crate::libc::println;
#[cfg(target_os = "none")]
pub use semihosting::println;

/// Ends the program: 0 is success.
pub fn exit(code: i32) -> ! {
    #[cfg(target_os = "none")]
    semihosting::process::exit(code);
    #[cfg(not(target_os = "none"))]
    crate::libc::exit(code);
}

/// `entry!(run)`: the program calls `run`, which returns its exit code.
#[macro_export]
macro_rules! entry {
    ($run:ident) => {
        #[cfg(all(target_os = "none", target_arch = "riscv32"))]
        #[$crate::riscv_rt::entry]
        fn main() -> ! {
            $crate::machine::exit($run())
        }
        #[cfg(all(target_os = "none", target_arch = "arm"))]
        #[$crate::cortex_m_rt::entry]
        fn main() -> ! {
            $crate::machine::start_counter();
            $crate::machine::exit($run())
        }
        #[cfg(not(target_os = "none"))]
        #[unsafe(no_mangle)]
        extern "C" fn main() -> i32 {
            $run()
        }
    };
}
pub use crate::entry;

/// Instruction counter, from an arbitrary start.
///
/// RISC-V counts instructions. The Cortex-M of QEMU has a timer at 25 MHz, and with `-icount shift=0` every instruction takes 1 ns of its time. It
/// counts in steps of 40 instructions, up to 2^24 steps. A host has no counter.
#[inline(always)]
pub fn instructions() -> u32 {
    #[cfg(all(target_os = "none", target_arch = "riscv32"))]
    return riscv::register::minstret::read() as u32;
    #[cfg(all(target_os = "none", target_arch = "arm"))]
    return (TICKS - cortex_m::peripheral::SYST::get_current()) * INSTRUCTIONS_PER_TICK;
    #[cfg(not(target_os = "none"))]
    return 0;
}

/// Instructions between two counts, the second one later by less than the counter's range.
#[inline(always)]
pub fn between(before: u32, after: u32) -> u32 {
    if cfg!(all(target_os = "none", target_arch = "arm")) && after < before {
        // It restarts from 0 after its last tick.
        return after + (TICKS + 1) * INSTRUCTIONS_PER_TICK - before;
    }
    after.wrapping_sub(before)
}

/// The last tick of the timer of a Cortex-M.
const TICKS: u32 = 0xff_ffff;
/// Ticks at 25 MHz, in instructions of a nanosecond each.
const INSTRUCTIONS_PER_TICK: u32 = 40;

/// Starts the timer.
#[cfg(all(target_os = "none", target_arch = "arm"))]
pub fn start_counter() {
    use cortex_m::peripheral::syst::SystClkSource;
    if let Some(mut peripherals) = cortex_m::Peripherals::take() {
        peripherals.SYST.set_clock_source(SystClkSource::Core);
        peripherals.SYST.set_reload(TICKS);
        peripherals.SYST.clear_current();
        peripherals.SYST.enable_counter();
    }
}

/// Bytes of stack that a call takes, including those of the functions that it calls; 0 on a host.
#[inline(never)]
pub fn stack_of(call: impl FnOnce()) -> u32 {
    #[cfg(target_os = "none")]
    {
        let top = stack_pointer();
        let first = top - PAINTED;
        for address in (first..top).step_by(4) {
            // SAFETY: the address is below the stack pointer, where nothing is in use, and above everything linked: the memories of both machines
            // leave more than that free. No interrupt is on.
            unsafe { core::ptr::write_volatile(address as *mut u32, PAINT) };
        }
        call();
        let untouched = (first..top).step_by(4).find(|&address| {
            // SAFETY: as above.
            unsafe { core::ptr::read_volatile(address as *const u32) != PAINT }
        });
        (top - untouched.unwrap_or(top)) as u32
    }
    #[cfg(not(target_os = "none"))]
    {
        call();
        0
    }
}

/// Lowest byte of the stack that is in use.
#[cfg(target_os = "none")]
#[inline(always)]
fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: copies a register.
    #[cfg(target_arch = "riscv32")]
    unsafe {
        core::arch::asm!("mv {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags));
    };
    // SAFETY: copies a register.
    #[cfg(target_arch = "arm")]
    unsafe {
        core::arch::asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags))
    };
    pointer
}

/// Number of inspected bytes.
#[cfg(target_os = "none")]
const PAINTED: usize = 1 << 16;
#[cfg(target_os = "none")]
const PAINT: u32 = 0x5afe_5afe;
