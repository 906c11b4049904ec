//! `roughxel completions`.

use std::io::{self, Write};

use clap::Args;
use clap_complete::Shell;

use super::Failure;

pub(super) const LONG_HELP: &str = "\
Print a script that completes commands, options and names in a shell.

  bash         roughxel completions bash > ~/.local/share/bash-completion/completions/roughxel
  zsh          roughxel completions zsh > _roughxel, in a directory of $fpath
  fish         roughxel completions fish > ~/.config/fish/completions/roughxel.fish
  elvish, powershell: append it to the file that is read at startup

Exit codes: 0 done, 1 failure, 2 usage.";

#[derive(Args)]
pub(super) struct CompletionsArgs {
    /// Shell to complete in.
    shell: Shell,
}

pub(super) fn run(args: &CompletionsArgs, program: &mut clap::Command) -> Result<(), Failure> {
    let name = program.get_name().to_owned();
    // The script goes to memory first: the generator panics on a closed pipe.
    let mut script = Vec::new();
    clap_complete::generate(args.shell, program, name, &mut script);
    io::stdout().lock().write_all(&script)?;
    Ok(())
}
