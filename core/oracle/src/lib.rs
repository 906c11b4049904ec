//! What the tests of the oracle have in common: bundles as lists of integers, seeded random numbers. The tests are the package
//! (`tests/oracle`): `cargo mutants` asks them about every changed core.

pub mod random;
pub mod walk;
