//! Errata of the papers as executable claims: each test shows that the printed formula fails and that the corrected one holds, so that nobody
//! changes the code back to the printed formula.
//!
//! Test names contain the row of the table. W97 is "Antialiasing of Environment Maps", S97 "Towards Real-Time Photorealistic Rendering", F92
//! "Filtering Normal Maps and Creating Multiple Surfaces". Everything is measured on the float64 reference or on a few lines of local mathematics,
//! never on the integer datapath.

mod f92;
mod s97;
mod w97;
