//! `roughxel scenes`.

use std::io::{self, Write};

use clap::Args;
use roughxel_scene::{builtin_names, builtin_text};
use roughxel_utilities::suggestions::did_you_mean;
use serde_json::json;

use super::Failure;

#[derive(Args)]
pub(super) struct ScenesArgs {
    /// Print the text (TOML) of this scene, as a start for your own.
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Print the list as JSON.
    #[arg(long, conflicts_with = "name")]
    json: bool,
}

pub(super) fn run(args: &ScenesArgs) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    if let Some(name) = &args.name {
        let Some(text) = builtin_text(name) else {
            let names: Vec<_> = builtin_names().collect();
            let meant = did_you_mean(name, builtin_names());
            return Err(Failure::Usage(format!(
                "scene `{name}` is not built in; {meant}there are {}",
                names.join(", ")
            )));
        };
        write!(out, "{text}")?;
    } else if args.json {
        writeln!(out, "{}", json!(builtin_names().collect::<Vec<_>>()))?;
    } else {
        for name in builtin_names() {
            writeln!(out, "{name}")?;
        }
    }
    Ok(())
}
