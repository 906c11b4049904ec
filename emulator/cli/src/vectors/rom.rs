//! `roughxel vectors rom`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_utilities::output::write_files;
use roughxel_vectors::rom_files;

use crate::{Failure, check_directory};

#[derive(Args)]
pub(crate) struct RomArgs {
    /// Directory to write to; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

pub(super) fn run(args: &RomArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    let files = rom_files();
    let count = files.len();
    write_files(&args.output, files)?;
    Ok(writeln!(io::stdout().lock(), "{count} tables in {}", args.output.display())?)
}
