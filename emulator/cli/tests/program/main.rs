//! The program as its users see it, and the files that it writes.

mod assets;
mod choose;
mod cli;
mod committed;
mod damaged;
mod documents;
mod eval;
mod explain;
mod fixture;
mod format;
mod gallery;
mod coverage;
mod check;
mod shrink;
mod pages;
mod peaks;
mod profile;
mod records;
mod shards;
mod simulate;
mod study;
mod vectors;
mod verilog;
