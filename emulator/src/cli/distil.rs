//! `roughxel vectors distil`.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use roughxel_emulator::vectors::{
    Distilled, Form, MAX_VECTORS, Manifest, Picked, SetInfo, Words, distil, export_with, manifests_of,
};
use serde_json::json;

use super::console::progress;
use super::{Failure, check_directory, check_file, write_text};

pub(super) const LONG_HELP: &str = "\
Write a set of few vectors that show the same mistakes as many: what `vectors report` counts.

All sets are of one datapath, effects, profile and columns. Vectors that are needed for an operation that is another one, for an entry of
a table or for a bin come first, then those that show most stuck bits, up to --most of them: always the one that shows most of what is
still missing, so the first hundred are the best hundred.

  roughxel vectors export random --count 200000 --bin -o many
  roughxel vectors distil many/random_standard.json vectors/smoke/cube_edges_standard.json -o few --name few --most 500
  roughxel vectors report few";

#[derive(Args)]
pub(super) struct DistilArgs {
    /// Directories of sets, or single ones (NAME.json, NAME.hex or NAME.bin).
    #[arg(required = true, value_name = "DIR|MANIFEST")]
    paths: Vec<PathBuf>,
    /// Directory; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Name of the new set.
    #[arg(long, default_value = "distilled", value_name = "NAME")]
    name: String,
    /// Vectors of the new set at most.
    #[arg(long, default_value_t = 1000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_VECTORS))]
    most: u64,
    /// Words as records of bytes, NAME.bin, instead of as text.
    #[arg(long)]
    bin: bool,
    /// Set and index of each vector as text, too, a line each.
    #[arg(long, value_name = "FILE")]
    picks: Option<PathBuf>,
    /// Set and index of each vector as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &DistilArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    if let Some(path) = &args.picks {
        check_file(path)?;
    }
    let mut manifests = Vec::new();
    for path in &args.paths {
        manifests.extend(manifests_of(path)?);
    }
    let Some((first, others)) = manifests.split_first() else { return Ok(()) };
    let counts = manifests.iter().map(|path| Manifest::read(path).map(|manifest| manifest.count));
    let bar = progress(counts.sum::<Result<u64, _>>()?, "faults");
    let distilled = distil(first, others, args.most as usize, &|done| bar.set_position(done));
    bar.finish_and_clear();
    let Distilled { of, picked, inputs } = distilled?;
    let sets: BTreeSet<&str> = picked.iter().map(|picked| picked.set.as_str()).collect();
    let sets: Vec<&str> = sets.into_iter().collect();
    let description = format!("vectors of {} that show what the others do not", sets.join(", "));
    let info = SetInfo {
        name: &args.name,
        description: &description,
        seed: None,
        datapath: of.datapath,
        effects: of.effects,
        precision: of.profile.knobs,
        profile: &of.profile.name,
        words: Words { taps: of.taps, form: if args.bin { Form::Bin } else { Form::Hex } },
    };
    let manifest =
        export_with(&info, inputs.len() as u64, &|index: u64| inputs[index as usize], &args.output, &|_| {})?;
    if let Some(path) = &args.picks {
        let lines = picked.iter().map(|Picked { set, index }| format!("{set} {index}\n"));
        write_text(path, &lines.collect::<String>())?;
    }
    let mut out = io::stdout().lock();
    if args.json {
        let file = &manifest.files[0].name;
        writeln!(out, "{:#}", json!({ "file": file, "count": manifest.count, "picked": picked }))?;
    } else {
        writeln!(out, "{} vectors in {}", manifest.count, args.output.join(&manifest.files[0].name).display())?;
    }
    Ok(())
}
