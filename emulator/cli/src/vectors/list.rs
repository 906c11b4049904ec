//! `roughxel vectors list`.

use std::io::{self, Write};

use clap::Args;
use roughxel_core::precision::Precision;
use roughxel_vectors::{RANDOM_SETS, hard_sets};
use serde_json::json;

use crate::Failure;
use crate::console::new_table;

#[derive(Args)]
pub(crate) struct ListArgs {
    /// Print the list as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &ListArgs) -> Result<(), Failure> {
    let cases = hard_sets(&Precision::STANDARD);
    let rows = cases.iter().map(|set| (set.name, set.datapath, set.inputs.len().to_string(), set.description));
    let random = RANDOM_SETS.map(|set| (set.name, set.datapath, "--count".to_owned(), set.description));
    let rows = rows.chain(random);
    let mut out = io::stdout().lock();
    if args.json {
        let sets = rows.map(|(set, datapath, count, description)| {
            let count = count.parse::<u64>().ok();
            json!({ "set": set, "datapath": datapath.name(), "count": count, "description": description })
        });
        writeln!(out, "{:#}", json!(sets.collect::<Vec<_>>()))?;
    } else {
        let mut table = new_table(["set", "datapath", "vectors", "what"]);
        for (set, datapath, count, description) in rows {
            table.add_row([set, datapath.name(), &count, description]);
        }
        writeln!(out, "{table}")?;
    }
    Ok(())
}
