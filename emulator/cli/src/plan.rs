//! `roughxel plan`.

use std::io::{self, Write};

use clap::Args;
use comfy_table::{ContentArrangement, Table};
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_scene::PictureUse;
use roughxel_shader::{Effect, ObjectPlan};
use roughxel_study::plan::{EffectReport, Hardware, ObjectReport, explain, measure};
use roughxel_study::profile_file::NamedPrecision;
use serde_json::{Value, json};

use super::cache::CacheArgs;
use super::console::{complain, new_table, progress};
use super::{Failure, ProfileArg, open_scene, parse_profile, parse_size, use_threads};

pub(super) const LONG_HELP: &str = "\
Say which effects each object of a scene has, why, and what they cost.

  effect       + on, – off
  why          the key of the scene, or the property of its maps, that decides
  stages       stages that the effect adds to the datapath of a fragment; a stage that two effects need belongs to both
  operations   additions, comparisons, selects, shifts by a count, products and table reads that the effect adds to a
               fragment (highlight: per light; peaks and horizons: per peak and light), and after the + to each of its
               fetches (environment: per probe; maps: per channel and probe)
  x of them    multipliers of two wires
  maps         memory of its maps with all their levels
  memory       peak memory of the frame until it is a file, and the maps of all objects; the scene and about a MiB per
               thread come on top
  share        share of the time of a frame: 1 - t(without)/t(with), the median of the rounds; with --measure

Exit codes: 0 done, 1 failure, 2 usage.
Data goes to stdout, progress and errors to stderr. NO_COLOR is respected.";

#[derive(Args)]
pub(super) struct PlanArgs {
    /// Scene file (TOML) or built-in scene.
    scene: String,
    /// Filtering: unfiltered, isotropic, footprint, or supersampled:N with N samples a pixel, a square number.
    #[arg(long, default_value = "footprint", value_name = "MODE")]
    mode: Mode,
    /// Profile: a name or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    profile: ProfileArg,
    /// Measure the time share of each effect by drawing whole frames.
    #[arg(long)]
    measure: bool,
    /// Number of measurement rounds.
    #[arg(long, default_value_t = 7, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), requires = "measure")]
    rounds: u32,
    /// Size of the frame in pixels. The default is the scene's.
    #[arg(long, value_parser = parse_size, value_name = "WxH")]
    size: Option<[u32; 2]>,
    /// Number of threads, at most one per core.
    #[arg(long, value_name = "N", value_parser = super::parse_threads)]
    threads: Option<usize>,
    #[command(flatten)]
    cache: CacheArgs,
    /// Print everything as JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &PlanArgs) -> Result<(), Failure> {
    use_threads(args.threads)?;
    let scene = open_scene(&args.scene, args.size)?;
    let NamedPrecision { name, precision: profile, .. } = &args.profile.open()?;
    let peaks = args.cache.peaks(&scene, args.mode.filters())?;
    let prepared = Prepared::with_peaks(&scene, args.mode, profile, &peaks)?;
    let mut reports = explain(&scene, &prepared, &args.mode.precision(profile));
    let (frame_bytes, map_bytes) = (prepared.frame_bytes(), prepared.all_map_bytes());
    drop(prepared);
    if args.measure {
        let effects = reports.iter().flat_map(|report| &report.effects).filter(|effect| effect.decision.on).count();
        let bar = progress(effects as u64 * u64::from(args.rounds), &scene.name);
        measure(&scene, args.mode, profile, &peaks, args.rounds as usize, &mut reports, &|| bar.inc(1))?;
        bar.finish_and_clear();
    }
    let mut out = io::stdout().lock();
    if args.json {
        let objects: Vec<_> = reports.iter().map(object_json).collect();
        let mode = args.mode.to_string();
        let plan = json!({
            "scene": scene.name, "mode": mode, "profile": name, "objects": objects,
            "frame_bytes": frame_bytes, "map_bytes": map_bytes, "pictures": scene.pictures,
        });
        writeln!(out, "{plan:#}")?;
        return Ok(());
    }
    for report in &reports {
        writeln!(out, "{}: {}", report.name, summary(&report.plan))?;
        writeln!(out, "{}", table(report, args.measure))?;
    }
    for PictureUse { used_as, path, statement } in &scene.pictures {
        writeln!(out, "{used_as}: {path}: {statement}")?;
        for sentence in statement.notes.iter().chain(&statement.ignored) {
            writeln!(out, "  {sentence}")?;
        }
    }
    let [frame, maps] = [frame_bytes, map_bytes].map(indicatif::HumanBytes);
    let size = format!("{}x{}", scene.camera.width, scene.camera.height);
    writeln!(out, "memory: frame {frame} ({size}, {} bytes a pixel), maps {maps}", Frame::BYTES_A_PIXEL)?;
    if reports.is_empty() {
        complain("the scene has no objects");
    }
    Ok(())
}

/// Lists the effects that are on, in one line.
fn summary(plan: &ObjectPlan) -> String {
    let names: Vec<_> = Effect::ALL.into_iter().filter(|effect| plan.has(*effect)).map(Effect::name).collect();
    if names.is_empty() { "one colour".into() } else { names.join(", ") }
}

fn table(report: &ObjectReport, measured: bool) -> Table {
    // Related cells share a column, on separate lines, so that the texts have room.
    let last = if measured { "maps\nshare" } else { "maps" };
    let mut table = new_table(["effect", "why\nstages", "operations\n× of them", last]);
    for effect in &report.effects {
        let EffectReport { decision, datapath, fetch, map_bytes, share } = effect;
        let count = |of: fn(&Hardware) -> i64| match (of(datapath), of(fetch)) {
            (0, 0) => String::new(),
            (fragment, 0) => fragment.to_string(),
            (fragment, fetch) => format!("{fragment} + {fetch}"),
        };
        let maps = (*map_bytes > 0).then(|| indicatif::HumanBytes(*map_bytes).to_string());
        let share = share.filter(|_| measured).map(|share| format!("{:.1} %", 100.0 * share));
        table.add_row([
            format!("{} {}", if decision.on { "+" } else { "–" }, decision.effect.name()),
            lines([decision.why.clone(), stages([datapath, fetch].into_iter().flat_map(|part| &part.stages))]),
            lines([count(|hardware| hardware.operations), count(|hardware| hardware.multipliers)]),
            lines([maps.unwrap_or_default(), share.unwrap_or_default()]),
        ]);
    }
    table.set_content_arrangement(ContentArrangement::Dynamic).set_width(WIDTH);
    table
}

/// Width of a narrow terminal in characters. Reasons and stages are wrapped.
const WIDTH: u16 = 80;

/// Joins the texts that are not empty, one per line.
fn lines<const N: usize>(texts: [String; N]) -> String {
    texts.into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join("\n")
}

/// Lists stages by name. A stage that runs several times has a count: `columns_pixel ×2`.
fn stages<'a>(runs: impl Iterator<Item = &'a String>) -> String {
    let mut counted: Vec<(&str, usize)> = Vec::new();
    for run in runs {
        let name = run.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
        match counted.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += 1,
            None => counted.push((name, 1)),
        }
    }
    let name = |(name, count): (&str, usize)| if count > 1 { format!("{name} ×{count}") } else { name.into() };
    counted.into_iter().map(name).collect::<Vec<_>>().join(", ")
}

fn object_json(report: &ObjectReport) -> Value {
    let effect = |effect: &EffectReport| {
        json!({
            "effect": effect.decision.effect.name(), "on": effect.decision.on, "why": effect.decision.why,
            "datapath": effect.datapath, "fetch": effect.fetch,
            "map_bytes": effect.map_bytes, "share": effect.share,
        })
    };
    json!({ "object": report.name, "effects": report.effects.iter().map(effect).collect::<Vec<_>>() })
}
