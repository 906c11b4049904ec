//! `roughxel vectors format`.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use miette::{Context, IntoDiagnostic};
use roughxel_utilities::input::open_file;
use roughxel_vectors::{in_page, tables};

use crate::{Failure, write_text};

pub(super) const LONG_HELP: &str = "\
Print the field tables of vectors/FORMAT.md, as the datapaths declare their ports.

A row is a declared field of a datapath: its columns in a word, port path, direction, stage, format,
unit and meaning. Formats: I signed or U unsigned with the bits before the point, F with the bits
after it; p is the profile's fraction_bits, l its lod_bits.

Exit codes: 0 done, 1 the page cannot be read or written, or has no place for the tables, 2 usage.";

#[derive(Args)]
pub(crate) struct FormatArgs {
    /// Put the tables into this page, between its markers. The page is replaced whole or not at all.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

pub(super) fn run(args: &FormatArgs) -> Result<(), Failure> {
    let Some(path) = &args.write else {
        return Ok(io::stdout().lock().write_all(tables().as_bytes())?);
    };
    let failed = |what: &str| format!("cannot {what} {}", path.display());
    let page = open_file(path).and_then(io::read_to_string);
    let page = page.into_diagnostic().wrap_err_with(|| failed("read")).map_err(Failure::Error)?;
    let page =
        in_page(&page).into_diagnostic().wrap_err_with(|| failed("put the tables into")).map_err(Failure::Error)?;
    Ok(write_text(path, &page)?)
}
