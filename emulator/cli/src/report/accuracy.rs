//! `roughxel report accuracy`.

use std::io::{self, Write};

use roughxel_core::ports::ReflectionOut;
use roughxel_study::accuracy::{Accuracy, FIGURES, measure};

use crate::eval::{INPUT_COLUMNS, Value, visit};
use clap::Args;
use comfy_table::Table;
use serde_json::json;

use crate::console::{new_table, progress};
use crate::{Failure, Profiles, parse_profiles};

#[derive(Args)]
pub(crate) struct AccuracyArgs {
    /// Random fragments, in addition to the hard cases.
    #[arg(long, default_value_t = 1_000_000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub(super) fragments: u64,
    /// Profile: a name, a file (TOML) or `all`.
    #[arg(long, default_value = "all", value_parser = parse_profiles, value_name = "NAME|FILE|all")]
    pub(super) profile: Profiles,
    /// Print the table as JSON.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn run(args: &AccuracyArgs) -> Result<(), Failure> {
    let profiles = args.profile.open()?;
    let mut measured = Vec::new();
    for profile in &profiles {
        let bar = progress(args.fragments, &profile.name);
        measured.push((profile, measure(&profile.precision, args.fragments, &|done| bar.inc(done))));
        bar.finish_and_clear();
    }
    let mut out = io::stdout().lock();
    if args.json {
        let profiles: Vec<_> = measured.iter().map(|(profile, accuracy)| as_json(&profile.name, accuracy)).collect();
        writeln!(out, "{:#}", json!(profiles))?;
        return Ok(());
    }
    for (profile, accuracy) in &measured {
        writeln!(out, "{}\n{}", as_table(&profile.name, accuracy), worst_fragments(accuracy))?;
    }
    let missed: Vec<_> = measured.iter().filter(|(profile, accuracy)| !accuracy.holds(&profile.name)).collect();
    if missed.is_empty() {
        return Ok(());
    }
    let names: Vec<_> = missed.iter().map(|(profile, _)| profile.name.as_str()).collect();
    Err(Failure::Mismatch(format!("a bar is missed in {}", names.join(", "))))
}

/// Lists the worst fragment of each figure as a row for `roughxel eval`, with a header of columns.
///
/// For sets with natural tangents, the row has the main direction in their place.
fn worst_fragments(accuracy: &Accuracy) -> String {
    let mut text = format!("worst fragments, for `roughxel eval`:\n{}\n", INPUT_COLUMNS.join(","));
    for (figure, name) in FIGURES {
        let Some(worst) = accuracy.worst(figure) else { continue };
        let mut row = Vec::with_capacity(INPUT_COLUMNS.len());
        visit(&worst.fragment, &ReflectionOut::default(), false, |_, value| {
            if let Value::Real(value) = value {
                row.push(format!("{value:e}"));
            }
        });
        row.truncate(INPUT_COLUMNS.len() - 1);
        row.push(worst.fragment.edge_texels.to_string());
        text += &format!("{}    <- {name}: {} #{}\n", row.join(","), worst.set, worst.index);
    }
    text
}

pub(crate) fn as_table(profile: &str, accuracy: &Accuracy) -> Table {
    let mut table = new_table([profile, "worst", "bar", "worst fragment", "fragments"]);
    for (figure, name) in FIGURES {
        let worst = accuracy.worst(figure);
        table.add_row([
            name.to_string(),
            worst.map_or(String::new(), |worst| format!("{:.3e}", worst.error)),
            figure.bar(profile).map_or(String::new(), |bar| format!("{bar:.3e}")),
            worst.map_or(String::new(), |worst| format!("{} #{}", worst.set, worst.index)),
            accuracy.counted(figure).to_string(),
        ]);
    }
    for (name, count) in [("wrong faces", accuracy.wrong_faces), ("wrong counts", accuracy.wrong_counts)] {
        table.add_row([name, &count.to_string(), "0", "", &accuracy.fragments.to_string()]);
    }
    table
}

pub(crate) fn as_json(profile: &str, accuracy: &Accuracy) -> serde_json::Value {
    let figures = FIGURES.map(|(figure, name)| {
        let worst = accuracy.worst(figure);
        json!({
            "figure": name,
            "worst": worst.map(|worst| worst.error),
            "bar": figure.bar(profile),
            "set": worst.map(|worst| &worst.set),
            "index": worst.map(|worst| worst.index),
            "counted": accuracy.counted(figure),
        })
    });
    json!({
        "profile": profile,
        "fragments": accuracy.fragments,
        "wrong_faces": accuracy.wrong_faces,
        "wrong_counts": accuracy.wrong_counts,
        "figures": figures,
    })
}
