//! The datapath on small processors: golden vectors, a tile of a picture, and what both cost there.
//!
//! The programs run in QEMU (`riscv32imac`, `riscv32i`, `thumbv7m`, all `unknown-none`) and, with the standard library, on any host or under
//! its user-mode emulation. `board` builds and runs them.
#![cfg_attr(target_os = "none", no_std)]

pub mod conformance;
pub mod machine;
pub mod metered;
pub mod sets;

#[cfg(all(target_os = "none", target_arch = "arm"))]
#[doc(hidden)]
pub use cortex_m_rt;
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
#[doc(hidden)]
pub use riscv_rt;
