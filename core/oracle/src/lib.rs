//! What the tests of the oracle have in common: bundles as lists of integers, seeded random numbers. The tests are the package
//! (`tests/oracle`): `cargo mutants` asks them about every changed core. Firmware finds by the same walk where the numbers of a golden vector belong.

pub mod random;
pub mod walk;
