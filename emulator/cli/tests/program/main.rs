//! The program as its users see it, and the files it writes.

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
mod grade;
mod judge;
mod minimise;
mod peaks;
mod profile;
mod records;
mod shards;
mod study;
mod vectors;
