//! The program as its users see it, and the files it writes.

mod choose;
mod cli;
mod damaged;
mod documents;
mod eval;
mod explain;
mod gallery;
mod grade;
mod judge;
mod minimise;
mod peaks;
mod profile;
mod shards;
mod study;
mod vectors;
