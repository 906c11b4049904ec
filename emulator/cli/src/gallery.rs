//! `roughxel gallery`: every scene of the papers next to what it is compared with, measured against supersampling.
//!
//! [`table`] lists the scenes and their columns, [`draw_scene`] draws one scene into files, and [`write_page`] makes one page of all scenes.
//! A column is the scene in a mode, perhaps changed ([`change`]): without its texture, or with a different formula.
//!
//! The reference has 1024 unfiltered samples a pixel in the most precise profile and is kept between runs (`reference`).
//! Times are of drawing only, without building maps. A quick column is drawn several times, and the fastest counts.

pub mod change;
mod draw;
mod drawn;
mod entry;
mod page;
mod prepared;
mod reference;
pub mod table;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use roughxel_frame::plan::Mode;
use roughxel_study::profile_file::NamedPrecision;
use roughxel_utilities::output::WriteError;
use roughxel_utilities::suggestions::did_you_mean;
use serde_json::json;

use super::cache::CacheArgs;
use super::console::{complain, new_table, progress};
use super::{Failure, ProfileArg, check_directory, check_file, parse_profile, parse_size, use_threads};

pub use change::Change;
pub use draw::{draw_scene, work};
pub use drawn::{DrawnColumn, DrawnReference, DrawnScene, GalleryError, Settings};
pub use entry::{Column, Entry};
pub use page::write_page;

pub(super) const LONG_HELP: &str = "Draw the scenes of the papers next to what they are compared with: pictures, differences from a reference of many \
samples, and a page with all pictures and figures.

DIR gets SCENE/COLUMN.png, SCENE/difference-COLUMN.png (128 + 4 times the error, in 8-bit sRGB codes), SCENE/reference.png, \
SCENE/side-by-side.png, and index.html, which needs no other file. References are kept in DIR/.reference. They are drawn again \
if the scene, the size, the samples or the program has changed.

PSNR is of linear light, SSIM (Wang and others, 2004) of the grey a display shows, both against the reference. A column with at least as many \
samples a pixel as the reference is not judged. Times are of drawing alone, the fastest of several drawings: compare them within \
one run only.

Exit codes: 0 done, 1 failure, 2 usage.";

#[derive(Args)]
pub(super) struct GalleryArgs {
    /// Directory of the pictures and the page; created if missing.
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: PathBuf,
    /// Draw only this scene. Repeat it for more scenes.
    #[arg(long, value_parser = parse_entry, value_name = "NAME")]
    pub(super) scene: Vec<&'static str>,
    /// Size of each picture in pixels.
    #[arg(long, default_value = "320x240", value_parser = parse_size, value_name = "WxH")]
    pub(super) size: [u32; 2],
    /// Number of threads, at most one per core. The pictures do not depend on it.
    #[arg(long, value_name = "N", value_parser = super::parse_threads)]
    pub(super) threads: Option<usize>,
    /// Samples a pixel of the reference, a square number from 1 to 4096.
    #[arg(long, default_value = "1024", value_parser = parse_samples, value_name = "N")]
    pub(super) samples: Samples,
    /// Profile of the columns: a name or a file (TOML). The reference is always drawn in `precise`.
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    pub(super) profile: ProfileArg,
    #[command(flatten)]
    pub(super) cache: CacheArgs,
    /// Print the figures as JSON.
    #[arg(long)]
    pub(super) json: bool,
}

/// Samples of the reference along an edge of the pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Samples(u32);

fn parse_samples(text: &str) -> Result<Samples, String> {
    // The mode's parser defines which sample counts are valid.
    match format!("supersampled:{text}").parse() {
        Ok(Mode::Supersampled { edge }) => Ok(Samples(edge)),
        _ => Err("a number of samples is a square number from 1 to 4096 (1, 4, 16, 64, …)".into()),
    }
}

fn parse_entry(name: &str) -> Result<&'static str, String> {
    let names = || table::ENTRIES.iter().map(|entry| entry.name);
    let known = || format!("{}the gallery has {}", did_you_mean(name, names()), names().collect::<Vec<_>>().join(", "));
    table::entry(name).map(|entry| entry.name).ok_or_else(known)
}

pub(super) fn run(args: &GalleryArgs) -> Result<(), Failure> {
    use_threads(args.threads)?;
    let NamedPrecision { name: profile, precision, .. } = &args.profile.open()?;
    let cache = args.cache.directory();
    let settings = Settings { size: args.size, reference_edge: args.samples.0, precision: *precision, cache };
    let directory = args.output.as_path();
    check_directory(directory)?;
    fs::create_dir_all(directory).map_err(|source| WriteError { path: directory.to_path_buf(), source })?;
    check_file(&directory.join("index.html"))?;

    let is_wanted = |name: &str| args.scene.is_empty() || args.scene.contains(&name);
    let entries: Vec<_> = table::ENTRIES.iter().filter(|entry| is_wanted(entry.name)).collect();
    let bar = progress(entries.iter().map(|entry| work(entry, &settings)).sum(), "");
    let step = |what: &str, done: u64| {
        // The message is set only if it changes, because tiles come from many threads.
        if done == 0 {
            bar.set_message(what.to_string());
        }
        bar.inc(done);
    };
    let scenes = entries.into_iter().map(|entry| draw_scene(entry, &settings, directory, &step));
    let scenes = scenes.collect::<Result<Vec<DrawnScene>, _>>()?;
    // The warning appears once, for any number of scenes with peaks.
    if let Some(reason) = scenes.iter().find_map(|scene| scene.not_kept.as_ref()) {
        bar.suspend(|| args.cache.warn(reason));
    }
    let page = write_page(&scenes, &settings, profile, directory)?;
    bar.finish_and_clear();

    let mut out = io::stdout().lock();
    if args.json {
        let [width, height] = args.size;
        let figures = json!({
            "page": shown(&page), "width": width, "height": height, "profile": profile,
            "samples": args.samples.0.pow(2), "threads": rayon::current_num_threads(),
            "scenes": scenes.iter().map(as_json).collect::<Vec<_>>(),
        });
        writeln!(out, "{figures:#}")?;
        return Ok(());
    }
    let mut table = new_table(["scene", "column", "time", "÷ unfiltered", "PSNR", "SSIM"]);
    for scene in &scenes {
        for drawn in &scene.columns {
            let optional =
                |figure: Option<f64>, digits: usize| figure.map_or("–".into(), |f| format!("{f:.digits$}"));
            table.add_row([
                scene.entry.name.to_string(),
                drawn.column.label.to_string(),
                format!("{:.3} s", drawn.time.as_secs_f64()),
                optional(scene.ratio(drawn), 2),
                drawn.psnr.map_or("–".into(), |psnr| format!("{psnr:.1} dB")),
                optional(drawn.ssim, 4),
            ]);
        }
    }
    writeln!(out, "{table}\n{}", page.display())?;
    if scenes.iter().flat_map(|scene| &scene.columns).any(|drawn| drawn.psnr.is_none()) {
        complain(
            "note: columns with at least as many samples a pixel as the reference are not judged; take more --samples",
        );
    }
    Ok(())
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

fn as_json(scene: &DrawnScene) -> serde_json::Value {
    let columns = scene.columns.iter().map(|drawn| {
        json!({
            "column": drawn.column.label, "mode": drawn.column.mode.to_string(), "digest": drawn.digest,
            "picture": shown(&drawn.picture), "difference": shown(&drawn.difference),
            "time_s": drawn.time.as_secs_f64(), "ratio_to_unfiltered": scene.ratio(drawn),
            "psnr_db": drawn.psnr, "ssim": drawn.ssim,
        })
    });
    json!({
        "scene": scene.entry.name, "source": scene.entry.source, "shows": scene.entry.shows,
        "columns": columns.collect::<Vec<_>>(), "plan": scene.plan, "side_by_side": shown(&scene.side_by_side),
        "reference": {
            "picture": shown(&scene.reference.picture),
            "time_s": scene.reference.time.map(|time| time.as_secs_f64()),
        },
    })
}
