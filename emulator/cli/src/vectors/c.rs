//! `roughxel vectors c`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_utilities::output::write_files;
use roughxel_vectors::c_library_files;

use crate::{Failure, check_directory};

#[derive(Args)]
pub(crate) struct CArgs {
    /// Directory to write to; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub(super) fn run(args: &CArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    let files = c_library_files();
    let names = files.each_ref().map(|(name, _)| *name).join(" and ");
    write_files(&args.output, files)?;
    Ok(writeln!(io::stdout().lock(), "{names} in {}", args.output.display())?)
}
