//! `roughxel vectors condense`.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use roughxel_vectors::{
    Condensed, Form, MAX_VECTORS, Manifest, Mistake, Picked, SetInfo, Wanted, Words, condense, export_with,
    manifests_of,
};
use serde_json::json;

use crate::console::with_progress;
use crate::{Failure, check_directory, check_file, write_text};

pub(super) const LONG_HELP: &str = "\
Write a set of few vectors that show the same faults as many. `vectors coverage` counts faults.

All sets have the same datapath, effects, profile and columns. Vectors needed for a wrong operation, a table entry or a bin come first. Those
that show most stuck bits follow, up to --most vectors. Each vector is the one that shows most of what is still missing, so the first hundred are
the best hundred. --beside skips what other sets show. --mistakes looks for the named kinds of fault only: the last place of some entries shows
once in a million vectors.

  roughxel vectors export random --count 200000 --bin -o many
  roughxel vectors condense many/random_standard.json vectors/smoke/cube_edges_standard.json -o few --name few --most 500
  roughxel vectors coverage few
  roughxel vectors condense many --beside few --mistakes entries -o more --name more";

#[derive(Args)]
pub(crate) struct CondenseArgs {
    /// Directories of sets, or single sets (NAME.json, NAME.hex or NAME.bin).
    #[arg(required = true, value_name = "DIR|MANIFEST")]
    paths: Vec<PathBuf>,
    /// Directory to write to; created if missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Name of the new set.
    #[arg(long, default_value = "distilled", value_name = "NAME")]
    name: String,
    /// Most vectors of the new set.
    #[arg(long, default_value_t = 1000, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_VECTORS))]
    most: u64,
    /// Directories of sets, or single sets. Faults that they show are skipped.
    #[arg(long, value_name = "DIR|MANIFEST", num_args = 1..)]
    beside: Vec<PathBuf>,
    /// Kinds of fault to look for. The default is all.
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    mistakes: Vec<MistakeArg>,
    /// Write words as byte records, NAME.bin, instead of text.
    #[arg(long)]
    bin: bool,
    /// Also write set and index of each vector to this text file, one line each.
    #[arg(long, value_name = "FILE")]
    picks: Option<PathBuf>,
    /// Print set and index of each vector as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum MistakeArg {
    /// Wrong operations, and bins: decisions on both sides, limits, entries that are read.
    Operations,
    /// Table entries that are off by one last place.
    Entries,
    /// Stuck bits.
    Stuck,
}

impl From<MistakeArg> for Mistake {
    fn from(kind: MistakeArg) -> Self {
        match kind {
            MistakeArg::Operations => Self::Operation,
            MistakeArg::Entries => Self::Entry,
            MistakeArg::Stuck => Self::Stuck,
        }
    }
}

pub(super) fn run(args: &CondenseArgs) -> Result<(), Failure> {
    check_directory(&args.output)?;
    if let Some(path) = &args.picks {
        check_file(path)?;
    }
    let manifests_of_all = |paths: &[PathBuf]| {
        let manifests = paths.iter().map(|path| manifests_of(path)).collect::<Result<Vec<_>, _>>()?;
        Ok::<_, Failure>(manifests.concat())
    };
    let (manifests, beside) = (manifests_of_all(&args.paths)?, manifests_of_all(&args.beside)?);
    let Some((first, others)) = manifests.split_first() else { return Ok(()) };
    let counts = manifests.iter().chain(&beside).map(|path| Manifest::read(path).map(|manifest| manifest.count));
    let mistakes: Vec<Mistake> = args.mistakes.iter().map(|&kind| kind.into()).collect();
    let mistakes = if mistakes.is_empty() { &Mistake::ALL[..] } else { &mistakes };
    let wanted = Wanted { most: args.most as usize, beside: &beside, mistakes };
    let count = counts.sum::<Result<_, _>>()?;
    let Condensed { of, picked, inputs } =
        with_progress(count, "faults", |done| condense(first, others, wanted, done))?;
    if picked.is_empty() {
        let text =
            if args.json { r#"{ "picked": [] }"# } else { "no vector shows what the others do not: nothing written" };
        writeln!(io::stdout().lock(), "{text}")?;
        return Ok(());
    }
    let sets: BTreeSet<&str> = picked.iter().map(|picked| picked.set.as_str()).collect();
    let sets: Vec<&str> = sets.into_iter().collect();
    let description = format!("vectors of {} that show what the others do not", sets.join(", "));
    let words = Words { taps: of.taps, form: if args.bin { Form::Bin } else { Form::Hex } };
    let info = SetInfo { name: &args.name, description: &description, words, ..SetInfo::from(&of) };
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
