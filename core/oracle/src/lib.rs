//! Tools that the tests of the oracle share: bundles as lists of integers, and seeded random numbers.
//!
//! The tests are the package (`tests/oracle`): `cargo mutants` runs them against every changed core. Firmware uses the same walk to find where the
//! numbers of a golden vector belong.

pub mod random;
pub mod walk;
