//! Figures of a study as tables.

use std::fmt::Write as _;

use roughxel_core::precision::Profile;

use super::figures::{Table, cost, grouped, power, timed_scenes, worst_psnr};
use crate::choose::Clock;
use crate::frames::FrameFigures;
use crate::host::Timing;
use crate::measurement::{Point, Study};
use crate::soft_core::{self, Machine};

/// The settings with a name of their own, narrowest first.
pub(super) fn named(study: &Study) -> impl Iterator<Item = &Point> {
    study.points.iter().filter(|point| point.knob.is_none())
}

/// An error in its customary unit: degrees for directions, else a power of two.
fn error(figure: &str, error: Option<f64>) -> String {
    match (figure, error) {
        ("direction", Some(degrees)) => {
            let digits = (2 - degrees.log10().floor() as i32).clamp(1, 6) as usize;
            format!("{degrees:.digits$}°")
        }
        (_, error) => power(error),
    }
}

/// A ratio with its noise, marked if other programs ran.
pub(super) fn ratio(timing: &Timing) -> String {
    format!("{:.2} ± {:.2}{}", timing.ratio, timing.noise, if timing.loaded { " †" } else { "" })
}

pub(super) fn decibel(psnr: Option<f64>) -> String {
    psnr.map_or_else(|| "equal".into(), |psnr| format!("{psnr:.1}"))
}

/// The named profiles next to each other: error, picture, clocks.
pub fn profiles(study: &Study) -> Table {
    let headings = std::iter::once(String::new()).chain(named(study).map(|point| point.name.clone())).collect();
    (headings, accuracy_rows(study).into_iter().chain(clock_rows(study)).collect())
}

fn row(study: &Study, name: &str, cell: impl Fn(&Point) -> String) -> Vec<String> {
    std::iter::once(name.to_string()).chain(named(study).map(cell)).collect()
}

fn accuracy_rows(study: &Study) -> Vec<Vec<String>> {
    let figures = [
        ("s, t", "s, t on the cube face"),
        ("frame", "frame: orthogonality, length"),
        ("lambda1", "λ₁, relative"),
        ("direction", "direction of the major axis"),
        ("lod", "level of detail"),
    ];
    let bits = |point: &Point| {
        let precision = Profile::by_name(&point.name).map(Profile::precision);
        precision.map_or_else(String::new, |p| format!("{}; {}", p.fraction_bits, p.word_bits()))
    };
    let mut rows = vec![row(study, "kept fraction bits p; bits of a word", bits)];
    for (figure, label) in figures {
        let worst = |point: &Point| {
            point.stage(figure).map_or_else(
                || "–".into(),
                |stage| format!("{} ({})", error(figure, stage.worst), error(figure, stage.nearly_all)),
            )
        };
        rows.push(row(study, label, worst));
    }
    rows
}

fn clock_rows(study: &Study) -> Vec<Vec<String>> {
    let timed: Vec<String> = timed_scenes(study).iter().map(|scene| format!("`{scene}`")).collect();
    let time_of_frames = format!("host, lanes: time of a frame ÷ `standard`, mean of {}", timed.join(" and "));
    let mut rows = vec![
        row(study, "frames against `standard`'s filter in float64, worst scene, dB", |point| {
            decibel(worst_psnr(point))
        }),
        row(study, "host, scalar: time of a fragment ÷ `standard`", |point| ratio(&point.host.scalar)),
        row(study, "host, lanes: the same", |point| ratio(&point.host.lanes)),
        row(study, &time_of_frames, |point| {
            cost(point, Clock::Host).map_or_else(|| "–".into(), |ratio| format!("{ratio:.2}"))
        }),
    ];
    let hardware = |of: fn(&crate::hardware::HardwareFigures) -> String| {
        move |point: &Point| point.hardware.as_ref().map_or_else(|| "–".into(), of)
    };
    rows.push(row(
        study,
        "hardware: multipliers, widest",
        hardware(|h| {
            let widest = h
                .multipliers
                .keys()
                .max_by_key(|widths| widths.split('x').flat_map(str::parse::<u32>).product::<u32>());
            format!("{}, {}", h.multiplier_count, widest.map_or_else(String::new, |widths| widths.replace('x', "×")))
        }),
    ));
    rows.push(row(
        study,
        "hardware: blocks of 18×18, lookup tables (estimate)",
        hardware(|h| format!("{}, {}", h.blocks_18x18, grouped((h.luts_estimate + 500) / 1000 * 1000))),
    ));
    rows.push(row(
        study,
        "hardware: ROM bits, gate levels without pipelining",
        hardware(|h| format!("{}, {}", grouped(h.rom_bits), h.levels)),
    ));
    rows.push(row(
        study,
        "hardware: 10⁶ fragments a second, a register behind every unit (estimate)",
        hardware(|h| format!("{:.0}", h.clock_mhz_estimate)),
    ));
    let shown = soft_core::SHOWN_CORES.map(Machine::Core).into_iter();
    for machine in shown.chain(soft_core::TARGETS.map(Machine::Processor)) {
        rows.push(row(study, &format!("soft core {}: {} a fragment", machine.name(), machine.unit()), |point| {
            point.cost_on(machine).map_or_else(|| "–".into(), |cost| grouped(cost.round() as u64))
        }));
    }
    rows.push(row(study, "memory: texels a pixel, mean of the scenes", |point| {
        cost(point, Clock::Memory).map_or_else(|| "–".into(), |texels| format!("{texels:.1}"))
    }));
    rows.push(row(study, "memory: KiB of maps, sum of the scenes", |point| {
        grouped(point.frames.iter().map(|frame| frame.map_bytes).sum::<u64>() / 1024)
    }));
    rows
}

/// Floats on the same fragments as the integers.
pub(super) fn floats(study: &Study) -> Table {
    let headings = [
        "",
        "frames, worst scene, dB",
        "s, t worst (99.9 %)",
        "λ₁",
        "level of detail",
        "wrong faces, counts",
        "time ÷ `standard` in lanes",
    ];
    let rows = study.floats.iter().map(|float| {
        let stage = |name: &str| {
            float.stages.iter().find(|stage| stage.figure == name).map_or_else(
                || "the measure".into(),
                |stage| format!("{} ({})", power(stage.worst), power(stage.nearly_all)),
            )
        };
        let [faces, counts] = float.wrong;
        vec![
            float.name.clone(),
            decibel(float.psnr.values().filter_map(|psnr| *psnr).min_by(f64::total_cmp)),
            stage("s, t"),
            stage("lambda1"),
            stage("lod"),
            format!("{faces}, {counts}"),
            float.host.as_ref().map_or_else(|| "–".into(), ratio),
        ]
    });
    (headings.map(String::from).into(), rows.collect())
}

/// Every mode and the footprints of `standard`, scene by scene.
pub(super) fn frames(study: &Study) -> Table {
    let headings = ["", "frame", "PSNR of the truth, dB", "SSIM", "FLIP", "texels a pixel", "time ÷ `standard`"];
    let standard = study.points.iter().find(|point| point.name == "standard");
    let mut rows = Vec::new();
    for scene in &study.settings.scenes {
        let modes = study.modes.iter().map(|mode| (mode.name.as_str(), &mode.frames, mode.times.get(scene)));
        let footprints = standard.map(|point| ("footprint", &point.frames, None));
        for (name, frames, time) in modes.chain(footprints) {
            let Some(frame) = frames.iter().find(|frame| frame.scene == *scene) else { continue };
            let number = |figure: Option<f64>| figure.map_or_else(|| "–".into(), |figure| format!("{figure:.3}"));
            rows.push(vec![
                scene.clone(),
                name.into(),
                decibel(frame.psnr_truth),
                number(frame.ssim_truth),
                number(frame.flip_truth),
                format!("{:.1}", frame.texels),
                time.map_or_else(|| "1".into(), ratio),
            ]);
        }
    }
    (headings.map(String::from).into(), rows)
}

/// PSNR against the truth, for every mode.
fn pictures(study: &Study) -> Table {
    let mut headings = vec![String::new()];
    headings.extend(study.modes.iter().map(|mode| mode.name.clone()));
    headings.push("footprint".into());
    headings.push("footprint against the same filter in float64".into());
    let standard = study.points.iter().find(|point| point.name == "standard");
    let rows = study.settings.scenes.iter().map(|scene| {
        let of = |frames: &[FrameFigures]| frames.iter().find(|frame| frame.scene == *scene).cloned();
        let mut row = vec![format!("`{scene}`")];
        row.extend(study.modes.iter().map(|mode| of(&mode.frames).map_or_else(String::new, |f| decibel(f.psnr_truth))));
        let frame = standard.and_then(|point| of(&point.frames));
        row.push(frame.as_ref().map_or_else(String::new, |frame| format!("**{}**", decibel(frame.psnr_truth))));
        row.push(frame.as_ref().map_or_else(String::new, |frame| decibel(frame.psnr_same)));
        row
    });
    (headings, rows.collect())
}

/// The tables of `docs/performance.md`, each after its name as a comment.
pub fn markdown(study: &Study) -> String {
    let (headings, _) = profiles(study);
    let tables = [
        ("accuracy", (headings.clone(), accuracy_rows(study))),
        ("clocks", (headings, clock_rows(study))),
        ("pictures", pictures(study)),
    ];
    let mut text = String::new();
    for (name, (headings, rows)) in tables {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "<!-- study: {name} -->");
        let _ = writeln!(text, "| {} |\n|{}", headings.join(" | "), "---|".repeat(headings.len()));
        for row in rows {
            let _ = writeln!(text, "| {} |", row.join(" | "));
        }
        let _ = writeln!(text, "<!-- end of {name} -->\n");
    }
    text
}
