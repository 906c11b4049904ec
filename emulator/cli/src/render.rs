//! `roughxel render`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use miette::miette;
use roughxel_assets::picture::write_png_codes;
use roughxel_core::plan::{Datapath, ReflectionPlan};
use roughxel_core::ports::ReflectionIn;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_scene::Scene;
use roughxel_simd::Backend;
use roughxel_study::profile_file::NamedPrecision;
use roughxel_vectors::{Manifest, SetInfo, export};
use serde_json::json;

use super::cache::CacheArgs;
use super::console::progress;
use super::{
    Failure, ProfileArg, check_directory, check_file, file_stem, open_scene, parse_png, parse_profile, parse_size,
    use_threads,
};

/// Most fragments of a frame that become vectors.
const CAPTURED_FRAGMENTS: usize = 4096;

#[derive(Args)]
pub(super) struct RenderArgs {
    /// Scene file (TOML) or built-in scene.
    pub(super) scene: String,
    /// PNG file to write. The default is the name of the scene with .png.
    #[arg(short, long, value_parser = parse_png, value_name = "PNG")]
    pub(super) output: Option<PathBuf>,
    /// Filtering: unfiltered, isotropic, footprint, or supersampled:N with N samples a pixel, a square number.
    #[arg(long, default_value = "footprint", value_name = "MODE")]
    pub(super) mode: Mode,
    /// Profile: a name or a file (TOML).
    #[arg(long, default_value = "standard", value_parser = parse_profile, value_name = "NAME|FILE")]
    pub(super) profile: ProfileArg,
    /// Size in pixels. The default is the scene's.
    #[arg(long, value_parser = parse_size, value_name = "WxH")]
    pub(super) size: Option<[u32; 2]>,
    /// Number of threads, at most one per core. The picture does not depend on it.
    #[arg(long, value_name = "N", value_parser = super::parse_threads)]
    pub(super) threads: Option<usize>,
    /// Backend of the datapath: scalar, avx2 or avx512. The default is the fastest of the machine; the picture does not depend on it.
    #[arg(long, alias = "reading", value_name = "NAME")]
    pub(super) backend: Option<Backend>,
    /// Export fragments of the frame as vector sets into this directory.
    #[arg(long, value_name = "DIR")]
    pub(super) capture: Option<PathBuf>,
    #[command(flatten)]
    pub(super) cache: CacheArgs,
    /// Print the figures as JSON.
    #[arg(long)]
    pub(super) json: bool,
}

pub(super) fn run(args: &RenderArgs) -> Result<(), Failure> {
    use_threads(args.threads)?;
    let output = args.output.clone().unwrap_or_else(|| format!("{}.png", file_stem(&args.scene)).into());
    check_file(&output)?;
    args.capture.as_deref().map_or(Ok(()), check_directory)?;
    let profile = args.profile.open()?;
    let scene = open_scene(&args.scene, args.size)?;

    let start = Instant::now();
    let backend = args.backend.unwrap_or_else(Backend::best);
    let peaks = args.cache.peaks(&scene, args.mode.filters())?;
    let prepared = Prepared::with_peaks(&scene, args.mode, &profile.precision, &peaks)?.with_backend(backend);
    let preparation = start.elapsed().as_secs_f64();
    let bar = progress(prepared.work(), &scene.name);
    let start = Instant::now();
    let frame = prepared.render(&|| bar.inc(1))?;
    let drawing = start.elapsed().as_secs_f64();
    bar.finish_and_clear();
    let (width, height) = (frame.width, frame.height);
    let digest = args.json.then(|| frame.digest());
    let codes = frame.srgb_codes();
    // Encoding needs as much memory as the codes. The memory of the frame is free for it.
    drop(frame);
    write_png_codes(&output, [width, height], &codes)?;
    drop(codes);
    let vectors = match &args.capture {
        Some(directory) => capture(&scene, &prepared, args.mode, &profile, directory)?,
        None => Vec::new(),
    };

    let mut out = io::stdout().lock();
    if args.json {
        let sets: Vec<_> = vectors.iter().map(|set| json!({ "set": set.set, "count": set.count })).collect();
        let figures = json!({
            "scene": scene.name, "mode": args.mode.to_string(), "profile": profile.name,
            "reading": backend.to_string(), "width": width, "height": height, "picture": output.display().to_string(),
            "digest": digest, "preparation_s": preparation, "drawing_s": drawing, "vectors": sets, "pictures": scene.pictures,
            "peaks": { "built": peaks.built, "read": peaks.read, "resumed": peaks.resumed },
        });
        writeln!(out, "{figures:#}")?;
    } else {
        writeln!(out, "{}: {width}x{height}, {}, {drawing:.2} s", output.display(), args.mode)?;
        for set in vectors {
            writeln!(out, "{}: {} vectors", set.files[0].name, set.count)?;
        }
    }
    Ok(())
}

/// Exports fragments spread over the frame, one set for each plan among its objects.
fn capture(
    scene: &Scene,
    prepared: &Prepared<'_>,
    mode: Mode,
    profile: &NamedPrecision,
    directory: &Path,
) -> Result<Vec<Manifest>, Failure> {
    let captured = prepared.capture(CAPTURED_FRAGMENTS)?;
    if captured.is_empty() {
        return Err(Failure::Error(miette!(
            "scene {}: nothing in the frame reflects, so there is nothing to capture",
            scene.name
        )));
    }
    let mut sets: Vec<(ReflectionPlan, Vec<ReflectionIn>)> = Vec::new();
    for (fragment, plan) in captured {
        match sets.iter_mut().find(|(known, _)| *known == plan) {
            Some((_, fragments)) => fragments.push(fragment),
            None => sets.push((plan, vec![fragment])),
        }
    }
    // If the mode changes knobs, the set is of a different profile.
    let precision = mode.precision(&profile.precision);
    let profile = if precision == profile.precision { &profile.name } else { "custom" };
    let description = format!("fragments of a frame: {}, {mode}", scene.name);
    let mut written = Vec::new();
    for (index, (plan, fragments)) in sets.iter().enumerate() {
        let name = format!("frame_{}_{index}", file_stem(&scene.name));
        let info = SetInfo::new(&name, Datapath::Reflection, (*plan).into(), profile, precision);
        let info = SetInfo { description: &description, ..info };
        written.push(export(&info, fragments, directory)?);
    }
    Ok(written)
}
