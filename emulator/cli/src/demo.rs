//! `roughxel demo`.

mod draw;

use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use miette::{IntoDiagnostic, WrapErr};
use roughxel_core::plan::Datapath;
use roughxel_study::accuracy::measure;
use roughxel_study::profile_file::NamedPrecision;
use roughxel_vectors::{SetInfo, VectorSet, export, export_with, hard_sets};
use serde_json::json;

use super::cache::CacheArgs;
use super::console::{new_table, progress};
use super::report::{as_json as accuracy_json, as_table as accuracy_table};
use super::{Failure, ProfileArg, check_directory, parse_profile, parse_size, use_threads};
pub use draw::DrawError;
use draw::{DEMO_MODES, DEMO_SCENES, DemoScene, demo_scene};

/// Random fragments of the error table. `report accuracy` takes more.
const ACCURACY_FRAGMENTS: u64 = 100_000;

#[derive(Args)]
pub(super) struct DemoArgs {
    /// Directory of pictures and vectors; created if missing.
    #[arg(short, long, default_value = "out", value_name = "DIR")]
    pub(super) output: PathBuf,
    /// Size of each picture in pixels.
    #[arg(long, value_parser = parse_size, value_name = "WxH")]
    pub(super) size: Option<[u32; 2]>,
    /// Number of threads, at most one per core. The pictures do not depend on it.
    #[arg(long, value_name = "N", value_parser = super::parse_threads)]
    pub(super) threads: Option<usize>,
    /// Profile: a name or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    pub(super) profile: ProfileArg,
    #[command(flatten)]
    pub(super) cache: CacheArgs,
    /// Print the table as JSON.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn run(args: &DemoArgs) -> Result<(), Failure> {
    use_threads(args.threads)?;
    let NamedPrecision { name: profile, precision, .. } = &args.profile.open()?;
    check_directory(&args.output)?;
    let unwritable = || format!("cannot write {}", args.output.display());
    fs::create_dir_all(&args.output).into_diagnostic().wrap_err_with(unwritable).map_err(Failure::Error)?;
    let bar = progress(4 * DEMO_SCENES.len() as u64, "");
    let step = |what: &str| {
        bar.set_message(what.to_string());
        bar.inc(u64::from(!what.ends_with("maps")));
    };
    let (mut scenes, mut sets) = (Vec::new(), Vec::new());
    let cache = args.cache.directory();
    let vectors = args.output.join("vectors");
    for name in DEMO_SCENES {
        let scene = demo_scene(name, args.size, precision, &args.output, cache.as_deref(), &step)?;
        if let Some(reason) = &scene.not_kept {
            bar.suspend(|| args.cache.warn(reason));
        }
        if !scene.captured.is_empty() {
            let set = format!("frame_{name}");
            let description = format!("fragments of a frame: {name}");
            let (datapath, effects) = (Datapath::Reflection, scene.plan.into());
            let info =
                SetInfo { description: &description, ..SetInfo::new(&set, datapath, effects, profile, *precision) };
            sets.push(export(&info, &scene.captured, &vectors)?);
        }
        scenes.push(scene);
    }
    for VectorSet { name, description, effects, datapath, inputs, .. } in hard_sets(precision) {
        let info = SetInfo { description, ..SetInfo::new(name, datapath, effects, profile, *precision) };
        sets.push(export_with(&info, inputs.len() as u64, &|index: u64| inputs[index as usize], &vectors, &|_| {})?);
    }
    bar.set_message("accuracy");
    let accuracy = measure(precision, ACCURACY_FRAGMENTS, &|_| {});
    bar.finish_and_clear();

    let mut out = io::stdout().lock();
    let count: u64 = sets.iter().map(|set| set.count).sum();
    if args.json {
        let scenes: Vec<_> = scenes.iter().map(as_json).collect();
        let accuracy = accuracy_json(profile, &accuracy);
        let vectors = json!({ "directory": vectors.display().to_string(), "sets": sets.len(), "count": count });
        writeln!(out, "{:#}", json!({ "scenes": scenes, "vectors": vectors, "accuracy": accuracy }))?;
        return Ok(());
    }
    let mut table = new_table(["picture", "mode", "time", "PSNR against 64 samples a pixel"]);
    for scene in &scenes {
        for (mode, (time, psnr)) in DEMO_MODES.iter().zip(scene.modes) {
            let row = [mode.to_string(), format!("{:.2} s", time.as_secs_f64()), format!("{psnr:.1} dB")];
            table.add_row([scene.picture.display().to_string()].into_iter().chain(row));
        }
    }
    writeln!(out, "{table}\n{}", accuracy_table(profile, &accuracy))?;
    writeln!(out, "{count} vectors in {} sets: {}", sets.len(), vectors.display())?;
    Ok(())
}

fn as_json(scene: &DemoScene) -> serde_json::Value {
    let modes = DEMO_MODES
        .iter()
        .zip(scene.modes)
        .map(|(mode, (time, psnr))| json!({ "mode": mode.to_string(), "time_s": time.as_secs_f64(), "psnr_db": psnr }));
    json!({
        "scene": scene.name,
        "picture": scene.picture.display().to_string(),
        "modes": modes.collect::<Vec<_>>(),
        "truth_time_s": scene.truth.as_secs_f64(),
    })
}
