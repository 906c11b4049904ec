//! The program as its users see it, and the files it writes.

mod cli;
mod eval;
mod gallery;
mod peaks;
mod vectors;
