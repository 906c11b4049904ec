//! `roughxel vectors export|merge|verify|check|ambiguous|explain|bench|coverage|condense|shrink|list|format|rom|c`. Each command is a file.
//!
//! Commands that were renamed keep their old name as a hidden alias.

mod bench;
mod c;
mod condense;
mod explain;
mod export;
mod format;
mod check;
mod list;
mod ambiguous;
mod merge;
mod shrink;
mod coverage;
mod rom;
mod verify;

use clap::Subcommand;

use super::{CONVENTIONS, Failure};

#[derive(Subcommand)]
pub(super) enum VectorsCommand {
    /// Write sets of vectors, each as packed hex with a JSON manifest.
    #[command(after_help = CONVENTIONS)]
    Export(export::ExportArgs),
    /// Join the parts of sets that `export --shard` wrote.
    #[command(long_about = merge::LONG_HELP, after_help = CONVENTIONS)]
    Merge(merge::MergeArgs),
    /// Recompute every value of sets and name set, index, stage, field and bit of each difference.
    #[command(after_help = CONVENTIONS)]
    Verify(verify::VerifyArgs),
    /// Check the words of a device by an acceptance tier: exact, faithful or within bounds.
    #[command(alias = "judge", long_about = check::LONG_HELP, after_help = CONVENTIONS)]
    Check(check::CheckArgs),
    /// List the vectors in which a device with other roundings may decide otherwise.
    #[command(alias = "marks", long_about = ambiguous::LONG_HELP, after_help = CONVENTIONS)]
    Ambiguous(ambiguous::AmbiguousArgs),
    /// Explain one vector: every field stage by stage next to float64, and where a device's word first goes wrong.
    #[command(long_about = explain::LONG_HELP, after_help = CONVENTIONS)]
    Explain(explain::ExplainArgs),
    /// Write testbenches that compare a device with sets: SystemVerilog, VHDL, cocotb, a Verilator driver.
    #[command(long_about = bench::LONG_HELP, after_help = CONVENTIONS)]
    Bench(bench::BenchArgs),
    /// Measure the coverage of sets: which faults of a device they show.
    #[command(alias = "report", long_about = coverage::LONG_HELP, after_help = CONVENTIONS)]
    Coverage(coverage::CoverageArgs),
    /// Write a set of few vectors that show the same faults as many.
    #[command(alias = "distil", long_about = condense::LONG_HELP, after_help = CONVENTIONS)]
    Condense(condense::CondenseArgs),
    /// Find the simplest inputs that a device still gets wrong in the same stage as a vector.
    #[command(alias = "minimise", long_about = shrink::LONG_HELP, after_help = CONVENTIONS)]
    Shrink(shrink::ShrinkArgs),
    /// List the sets that can be exported.
    List(list::ListArgs),
    /// Print the field tables of vectors/FORMAT.md, as the datapaths declare their ports.
    #[command(long_about = format::LONG_HELP)]
    Format(format::FormatArgs),
    /// Write the tables of the arithmetic, described in vectors/SPEC.md, as hex files.
    #[command(after_help = CONVENTIONS)]
    Rom(rom::RomArgs),
    /// Write the header of the C library and its SystemVerilog package of DPI-C imports.
    #[command(after_help = CONVENTIONS)]
    C(c::CArgs),
}

pub(super) fn run(command: &VectorsCommand) -> Result<(), Failure> {
    match command {
        VectorsCommand::Format(args) => format::run(args),
        VectorsCommand::Rom(args) => rom::run(args),
        VectorsCommand::C(args) => c::run(args),
        VectorsCommand::Export(args) => export::run(args),
        VectorsCommand::Merge(args) => merge::run(args),
        VectorsCommand::Verify(args) => verify::run(args),
        VectorsCommand::Check(args) => check::run(args),
        VectorsCommand::Ambiguous(args) => ambiguous::run(args),
        VectorsCommand::Explain(args) => explain::run(args),
        VectorsCommand::Bench(args) => bench::run(args),
        VectorsCommand::Coverage(args) => coverage::run(args),
        VectorsCommand::Condense(args) => condense::run(args),
        VectorsCommand::Shrink(args) => shrink::run(args),
        VectorsCommand::List(args) => list::run(args),
    }
}
