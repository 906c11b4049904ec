//! What each effect costs where it is on, and what it costs to be off.
//!
//! `cargo bench -p roughxel-host-tests --bench effects` draws built-in scenes of 160 by 120 pixels. *Share* is
//! 1 − t(without)/t(with) of whole frames, as `roughxel plan --measure` says it. *Off* is the time of a scene that has the
//! keys of an effect, planned away, over that of the scene without the keys: the frames are the same bits, and it should
//! cost below 1 %. Both sides take turns within a round; let nothing else run beside it.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use comfy_table::{CellAlignment, Table, presets::UTF8_FULL_CONDENSED};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_emulator::frame::Prepared;
use roughxel_emulator::maps::peaks::ScenePeaks;
use roughxel_emulator::plan::{Decision, Effect, Mode};
use roughxel_emulator::scene::Scene;
use roughxel_emulator::study::plan::{EffectReport, Hardware, ObjectReport, measure};

const SCENES: [&str; 4] = ["lake", "denim-plane", "highlight", "horizon-plane"];

/// Rounds of a share.
const SHARE_ROUNDS: usize = 9;

/// Least rounds of what an effect costs that is off, and how long they are taken.
const OFF_ROUNDS: usize = 31;
const OFF_TIME: Duration = Duration::from_secs(2);

/// What being off may cost.
const LIMIT: f64 = 0.01;

const PROFILE: Precision = Precision::STANDARD;

/// The scene without the keys of an effect and the profile to draw it with; `None` where the effect has no key.
fn without_keys(scene: &Scene, effect: Effect) -> Option<(Scene, Precision)> {
    let (mut scene, mut profile) = (scene.clone(), PROFILE);
    for material in scene.objects.iter_mut().map(|object| &mut object.material) {
        match effect {
            Effect::ColourTexture => material.colour_map = None,
            // Peaks of a map need its bumps.
            Effect::Bump if material.peaks.is_some() => return None,
            Effect::Bump => (material.bump, material.roughness) = (None, None),
            // Detail that is lost has no key, but the profile has a knob.
            Effect::Roughness => profile.roughness = RoughnessKind::None,
            Effect::Environment => material.reflectance = [0.0; 3],
            // The mode and the mesh decide.
            Effect::Footprint | Effect::Curvature => return None,
            Effect::Highlight => material.highlight = None,
            Effect::Peaks => material.peaks = None,
            Effect::Horizon => {
                if let Some(peaks) = &mut material.peaks {
                    peaks.shadowing = false;
                }
            }
        }
    }
    Some((scene, profile))
}

/// Peaks of a scene's maps.
fn fit(scene: &Scene) -> ScenePeaks {
    ScenePeaks::new(scene, true, None, &|_| ()).expect("built-in scenes have peaks")
}

/// Reports to put shares in; hardware is what `roughxel plan` says.
fn reports(scene: &Scene, prepared: &Prepared<'_>) -> Vec<ObjectReport> {
    let effect = |decision: &Decision| EffectReport {
        decision: decision.clone(),
        datapath: Hardware::default(),
        fetch: Hardware::default(),
        map_bytes: 0,
        share: None,
    };
    let objects = scene.objects.iter().zip(prepared.plans()).zip(prepared.decisions());
    objects
        .map(|((object, plan), decisions)| ObjectReport {
            name: object.name.clone(),
            plan: *plan,
            effects: decisions.iter().map(effect).collect(),
        })
        .collect()
}

/// Seconds of one frame.
fn seconds(prepared: &Prepared<'_>) -> f64 {
    let start = Instant::now();
    prepared.render(&|| ()).expect("built-in scenes are drawn");
    start.elapsed().as_secs_f64()
}

/// The middle figure, the upper of two.
fn median(mut figures: Vec<f64>) -> f64 {
    figures.sort_by(f64::total_cmp);
    figures[figures.len() / 2]
}

/// t(planned away)/t(no keys): ratio of the medians.
fn cost_of_being_off(planned_away: &Prepared<'_>, no_keys: &Prepared<'_>) -> f64 {
    let frame = |prepared: &Prepared<'_>| prepared.render(&|| ()).expect("built-in scenes are drawn");
    assert!(frame(planned_away) == frame(no_keys), "an effect that is off leaves no trace");
    let (mut away, mut none) = (Vec::new(), Vec::new());
    let start = Instant::now();
    while away.len() < OFF_ROUNDS || start.elapsed() < OFF_TIME {
        // Neither is always the first.
        if away.len() % 2 == 0 {
            away.push(seconds(planned_away));
            none.push(seconds(no_keys));
        } else {
            none.push(seconds(no_keys));
            away.push(seconds(planned_away));
        }
    }
    median(away) / median(none)
}

fn table(header: [&str; 4]) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED).set_header(header);
    for column in 2..4 {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

fn main() -> ExitCode {
    let mut shares = table(["scene", "object", "effect", "share"]);
    let mut offs = table(["scene", "effect", "off costs", "below 1 %"]);
    let mut holds = true;
    for name in SCENES {
        let scene = Scene::builtin(name).expect("the scene is built in").expect("built-in scenes are read");
        let scene = scene.with_size(160, 120).expect("the size is allowed");
        let mode = Mode::Footprint;
        let peaks = fit(&scene);
        let prepare = || Prepared::with_peaks(&scene, mode, &PROFILE, &peaks).expect("built-in scenes are drawn");
        let mut reports = reports(&scene, &prepare());
        measure(&scene, mode, &PROFILE, &peaks, SHARE_ROUNDS, &mut reports, &|| ()).expect("built-in scenes are drawn");
        for report in &reports {
            for effect in &report.effects {
                let share = effect.share.map_or_else(|| "off".into(), |share| format!("{:.1} %", 100.0 * share));
                shares.add_row([name, &report.name, effect.decision.effect.name(), &share]);
            }
        }
        for effect in Effect::ALL {
            if !reports.iter().any(|report| report.plan.has(effect)) {
                continue;
            }
            let Some((bare, profile)) = without_keys(&scene, effect) else { continue };
            let mut away = prepare();
            for (index, report) in reports.iter().enumerate() {
                away = away.with_plan(index, report.plan.without(effect));
            }
            // Only horizons change what is fitted.
            let no_horizons = (effect == Effect::Horizon).then(|| fit(&bare));
            let peaks = no_horizons.as_ref().unwrap_or(&peaks);
            let none = Prepared::with_peaks(&bare, mode, &profile, peaks).expect("built-in scenes are drawn");
            let cost = cost_of_being_off(&away, &none) - 1.0;
            holds &= cost < LIMIT;
            let verdict = if cost < LIMIT { "yes" } else { "NO" };
            offs.add_row([name, effect.name(), &format!("{:+.2} %", 100.0 * cost), verdict]);
        }
    }
    println!(
        "Shares: medians of {SHARE_ROUNDS} rounds.\n{shares}\nOff: medians of at least {OFF_ROUNDS} rounds and {OFF_TIME:?}.\n{offs}"
    );
    if holds { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
