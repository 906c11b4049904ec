//! `roughxel report`.

mod accuracy;

use clap::Subcommand;

use super::{CONVENTIONS, Failure};
use accuracy::AccuracyArgs;

pub(super) use accuracy::{as_json, as_table};

#[derive(Subcommand)]
pub(super) enum ReportCommand {
    /// Measure the worst error of each stage against the float64 reference, with its fragment.
    #[command(after_help = CONVENTIONS)]
    Accuracy(AccuracyArgs),
}

pub(super) fn run(command: &ReportCommand) -> Result<(), Failure> {
    match command {
        ReportCommand::Accuracy(args) => accuracy::run(args),
    }
}
