//! `roughxel vectors export|merge|verify|judge|marks|explain|bench|minimise|report|distil|list|format|rom|c`.

mod bench;
mod c;
mod distil;
mod explain;
mod export;
mod format;
mod judge;
mod list;
mod marks;
mod merge;
mod minimise;
mod report;
mod rom;
mod verify;

use clap::Subcommand;

use super::{CONVENTIONS, Failure};

#[derive(Subcommand)]
pub(super) enum VectorsCommand {
    /// Write sets of vectors: packed hex and a JSON manifest each.
    #[command(after_help = CONVENTIONS)]
    Export(export::ExportArgs),
    /// Join the parts of sets that `export --shard` wrote.
    #[command(long_about = merge::LONG_HELP, after_help = CONVENTIONS)]
    Merge(merge::MergeArgs),
    /// Recompute every value of sets and compare; name set, index, stage, field and bit of each difference.
    #[command(after_help = CONVENTIONS)]
    Verify(verify::VerifyArgs),
    /// Judge the words of a device by an acceptance tier: exact, faithful with a divider or a root of its own, within bounds.
    #[command(long_about = judge::LONG_HELP, after_help = CONVENTIONS)]
    Judge(judge::JudgeArgs),
    /// Mark the vectors in which a device that rounds in its own way may decide otherwise.
    #[command(long_about = marks::LONG_HELP, after_help = CONVENTIONS)]
    Marks(marks::MarksArgs),
    /// Explain one vector: every field stage by stage beside float64, and where a device's word goes wrong first.
    #[command(long_about = explain::LONG_HELP, after_help = CONVENTIONS)]
    Explain(explain::ExplainArgs),
    /// Write benches that compare a device with sets: SystemVerilog, VHDL, cocotb, a Verilator driver.
    #[command(long_about = bench::LONG_HELP, after_help = CONVENTIONS)]
    Bench(bench::BenchArgs),
    /// Say how good sets are: which mistakes in a device they would show.
    #[command(long_about = report::LONG_HELP, after_help = CONVENTIONS)]
    Report(report::ReportArgs),
    /// Write a set of few vectors that show the same mistakes as many.
    #[command(long_about = distil::LONG_HELP, after_help = CONVENTIONS)]
    Distil(distil::DistilArgs),
    /// Find the simplest inputs that a device still gets wrong in the same stage as a vector.
    #[command(long_about = minimise::LONG_HELP, after_help = CONVENTIONS)]
    Minimise(minimise::MinimiseArgs),
    /// List the sets that can be exported.
    List(list::ListArgs),
    /// Print the tables of fields in vectors/FORMAT.md, as the datapaths declare their ports.
    #[command(long_about = format::LONG_HELP)]
    Format(format::FormatArgs),
    /// Write the tables of the arithmetic, a hex file each, as vectors/SPEC.md describes them.
    #[command(after_help = CONVENTIONS)]
    Rom(rom::RomArgs),
    /// Write the header of the C library and its SystemVerilog package of DPI-C imports, as the datapaths declare their ports.
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
        VectorsCommand::Judge(args) => judge::run(args),
        VectorsCommand::Marks(args) => marks::run(args),
        VectorsCommand::Explain(args) => explain::run(args),
        VectorsCommand::Bench(args) => bench::run(args),
        VectorsCommand::Report(args) => report::run(args),
        VectorsCommand::Distil(args) => distil::run(args),
        VectorsCommand::Minimise(args) => minimise::run(args),
        VectorsCommand::List(args) => list::run(args),
    }
}
