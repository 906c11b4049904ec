//! The datapath on small processors: golden vectors, a tile of a picture, and the cost of both.
//!
//! The programs run in QEMU (`riscv32imac`, `riscv32i`, `thumbv7m`, all `unknown-none`) and, with a C library, under user-mode emulation (`aarch64`,
//! `s390x`). `board` builds and runs them.
#![no_std]

#[cfg(all(target_os = "none", target_arch = "riscv32"))]
pub mod bare;
pub mod conformance;
#[cfg(not(target_os = "none"))]
pub mod libc;
pub mod machine;
pub mod metered;
pub mod samples;
pub mod sets;
/// Tile that every machine draws, kept by the oracle of the core.
#[path = "../../../core/oracle/tests/oracle/tile/drawn.rs"]
pub mod tile;

#[cfg(all(target_os = "none", target_arch = "arm"))]
#[doc(hidden)]
pub use cortex_m_rt;
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
#[doc(hidden)]
pub use riscv_rt;
