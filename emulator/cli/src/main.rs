//! The program `roughxel`.

use std::process::ExitCode;

fn main() -> ExitCode {
    roughxel_cli::run()
}
