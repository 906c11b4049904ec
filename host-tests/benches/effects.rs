//! Cost of each effect when it is on, and its cost when it is off.
//!
//! `cargo bench -p roughxel-benches --bench effects` draws built-in scenes of 160 by 120 pixels. *Share* is 1 − t(without)/t(with) of whole frames,
//! as `roughxel plan --measure` reports it. *Off* compares a scene that has the keys of an effect, planned away, with the scene without the keys.
//! The frames have the same bits, and the cost should be below 1 %.
//!
//! Both sides are drawn in turn on one thread, and a round compares each frame with its neighbour. Each round has its own maps, so their places in
//! memory differ from round to round. The output is the median of the rounds and the interquartile range. If the range is wide, the machine is too
//! busy. It takes two minutes.

use std::fs;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use roughxel_core::precision::Precision;
use roughxel_frame::plan::{Decision, Mode};
use roughxel_frame::{Frame, Prepared};
use roughxel_host_tests::keys::{has_keys, without_keys};
use roughxel_host_tests::table::table;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;
use roughxel_shader::Effect;
use roughxel_study::plan::{EffectReport, Hardware, ObjectReport, measure, time_ratio};

const SCENES: [&str; 4] = ["lake", "denim-plane", "highlight", "horizon-plane"];

/// Rounds of a share.
const SHARE_ROUNDS: usize = 9;

/// Rounds of the cost of an effect that is off, each with its own maps, and least time of each side of a round.
const OFF_ROUNDS: usize = 9;
const OFF_TIME: Duration = Duration::from_millis(300);

/// Largest cost of an effect that is off.
const LIMIT: f64 = 0.01;

const PROFILE: Precision = Precision::STANDARD;

/// Peaks of a scene's maps.
fn fit(scene: &Scene) -> ScenePeaks {
    ScenePeaks::new(scene, true, None, &|_| ()).expect("built-in scenes have peaks")
}

/// Reports to fill with shares; the hardware figures are those of `roughxel plan`.
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

fn frame(prepared: &Prepared<'_>) -> Frame {
    prepared.render(&|| ()).expect("built-in scenes are drawn")
}

/// Time that this thread has run, which excludes the time of other programs. If the system does not report it, time since `begin`. With five
/// programs on two cores the interquartile range of the rounds is 0.1 % wide by the thread time, 5 % by the clock.
fn clock(begin: Instant) -> Duration {
    let ran = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let ran = ran.and_then(|text| text.split_whitespace().next()?.parse().ok());
    ran.map_or_else(|| begin.elapsed(), Duration::from_nanos)
}

/// The lower quartile, the median and the upper quartile.
fn quarters(mut figures: Vec<f64>) -> [f64; 3] {
    figures.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| figures[figures.len() * quarter / 4])
}

fn main() -> ExitCode {
    let mut shares = table(["scene", "object", "effect", "share"], 2..4);
    let mut offs = table(["scene", "effect", "off costs", "half of the rounds", "below 1 %"], 2..5);
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("the thread pool can be created");
    let begin = Instant::now();
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
            // Peaks of a map need its bumps.
            let is_needed = effect == Effect::Bump && scene.objects.iter().any(|of| of.material.peaks.is_some());
            if !has_keys(effect) || is_needed || !reports.iter().any(|report| report.plan.has(effect)) {
                continue;
            }
            let (bare, profile) = without_keys(&scene, effect, &PROFILE);
            let costs = (0..OFF_ROUNDS).map(|round| {
                let away = || {
                    let plans = reports.iter().map(|report| report.plan.without(effect)).enumerate();
                    plans.fold(prepare(), |away, (index, plan)| away.with_plan(index, plan))
                };
                // With or without horizons, the peaks are those of the scene; without the key they would be different ones.
                let none = || Prepared::with_peaks(&bare, mode, &profile, &peaks).expect("built-in scenes are drawn");
                // Neither side is always the first in memory.
                let (away, none) = if round % 2 == 0 {
                    let away = away();
                    (away, none())
                } else {
                    let none = none();
                    (away(), none)
                };
                assert!(frame(&away) == frame(&none), "an effect that is off leaves no trace");
                let ratio = one_thread.install(|| time_ratio(&away, &none, OFF_TIME, &|| clock(begin)));
                ratio.expect("built-in scenes are drawn") - 1.0
            });
            let [low, cost, high] = quarters(costs.collect());
            holds &= cost < LIMIT;
            let verdict = if cost < LIMIT { "yes" } else { "NO" };
            let percent = |cost: f64| format!("{:+.2} %", 100.0 * cost);
            let half = format!("{} to {}", percent(low), percent(high));
            offs.add_row([name, effect.name(), &percent(cost), &half, verdict]);
        }
    }
    println!(
        "Shares: medians of {SHARE_ROUNDS} rounds.\n{shares}\nOff: medians of {OFF_ROUNDS} rounds of twice {OFF_TIME:?}.\n{offs}"
    );
    if holds { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
