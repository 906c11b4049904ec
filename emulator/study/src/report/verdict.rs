//! What the figures say: prices of a bit, knobs that buy nothing, what to choose.

use std::str::FromStr;

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;

use super::figures::{CLOCKS, Table, cost, power, worst_psnr};
use crate::choose::{Aim, Candidate, Clock, choose};
use crate::sweep::{Point, Study, base_of};

/// A knob that changes the PSNR of a scene by less, dB, buys nothing there.
pub const BUYS_SOMETHING_DB: f64 = 0.5;

/// The cheapest setting for each bar and clock.
pub(super) fn choices(study: &Study) -> Table {
    let candidates: Vec<Candidate> = study
        .points
        .iter()
        .map(|point| Candidate {
            precision: precision(point),
            name: Some(point.name.clone()),
            psnr: worst_psnr(point).unwrap_or(f64::INFINITY),
            cost: CLOCKS.map(|(clock, _)| cost(point, clock)),
        })
        .collect();
    let bars = [30.0, 40.0, 50.0, 60.0, 70.0];
    let headings = bars.iter().map(|bar| format!("{bar:.0} dB"));
    let headings = std::iter::once("the cheapest for frames within".to_string()).chain(headings).collect();
    let rows = CLOCKS.map(|(clock, unit)| {
        let mut row = vec![unit.to_string()];
        row.extend(bars.map(|bar| match choose(&candidates, Aim::Psnr(bar), clock) {
            Ok(chosen) => {
                let name = chosen.name.as_deref().unwrap_or_default();
                let cost = chosen.cost[clock as usize].unwrap_or(f64::NAN);
                if cost < 100.0 { format!("{name}: {cost:.2}") } else { format!("{name}: {cost:.0}") }
            }
            Err(_) => "none".into(),
        }));
        row
    });
    (headings, rows.into())
}

/// The knobs of a point.
fn precision(point: &Point) -> Precision {
    Knob::ALL.into_iter().fold(Precision::STANDARD, |p, knob| {
        let text = point.knobs.get(knob.name()).map(String::as_str).unwrap_or_default();
        let choice = knob.choices().iter().position(|choice| *choice == text).map(|place| place as u32);
        // `exact` is the only text that is neither a choice nor a number.
        knob.with(choice.or_else(|| u32::from_str(text).ok()).unwrap_or(0), p)
    })
}

/// In one sentence each, what a bit of accuracy costs on each clock: from `narrow` to `standard`, and from there to `precise`.
pub(super) fn bit_prices(study: &Study) -> Vec<String> {
    let named = |name: &str| study.points.iter().find(|point| point.name == name);
    let Some([narrow, standard, precise]) =
        named("narrow").zip(named("standard")).zip(named("precise")).map(|((a, b), c)| [a, b, c])
    else {
        return Vec::new();
    };
    let error = |point: &Point| point.stage("s, t").and_then(|stage| stage.nearly_all).unwrap_or(f64::NAN);
    let bits = |a: &Point, b: &Point| (error(a) / error(b)).log2();
    let steps = [(narrow, standard), (standard, precise)];
    let price = |of: &dyn Fn(&Point) -> Option<f64>| {
        let whole = of(standard)?;
        let each = steps.map(|(a, b)| Some(100.0 * (of(b)? - of(a)?) / (whole * bits(a, b))));
        Some((each[0]?, each[1]?))
    };
    let sentence = |where_: &str, what: &str, of: &dyn Fn(&Point) -> Option<f64>| {
        let (first, second) = price(of)?;
        Some(format!(
            "{where_} a bit costs {first:.1} % of {what} in `standard` from `narrow` on, and {second:.1} % beyond `standard`."
        ))
    };
    let lanes = standard.host.lanes.noise.max(narrow.host.lanes.noise);
    let told = [
        sentence("On the host", "the time of a fragment in lanes", &|point| Some(point.host.lanes.ratio)).map(|text| {
            format!(
                "{text} Within one width of words it costs nothing that could be measured (noise {:.0} %).",
                100.0 * lanes
            )
        }),
        sentence("In hardware", "the full adders", &|point| cost(point, Clock::Hardware)),
        sentence("In hardware", "the gate levels", &|point| Some(f64::from(point.hardware.as_ref()?.levels))),
        sentence("On a soft core with a multiplier (riscv32imac)", "the instructions", &|point| {
            cost(point, Clock::SoftCore)
        }),
        sentence("On one without (riscv32i)", "the instructions", &|point| {
            Some(point.soft_core.get("riscv32i")?.instructions)
        }),
        sentence("In memory", "the texels", &|point| cost(point, Clock::Memory)),
    ];
    let mut sentences: Vec<String> = told.into_iter().flatten().collect();
    sentences.push(format!(
        "A bit halves the error of s and t that 99.9 % of the fragments stay below: {} in `narrow`, {} in `standard`, {} in `precise`.",
        power(Some(error(narrow))),
        power(Some(error(standard))),
        power(Some(error(precise)))
    ));
    sentences
}

/// What a knob does to a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct KnobGain {
    /// Its name.
    pub knob: &'static str,
    /// The scene.
    pub scene: String,
    /// Difference between the best and the worst of its values, dB: PSNR against the filter of `standard` in float64.
    pub filter_db: f64,
    /// The same against the truth.
    pub truth_db: f64,
}

/// Every knob in every scene.
pub fn knob_gains(study: &Study) -> Vec<KnobGain> {
    let mut gains = Vec::new();
    for knob in Knob::ALL {
        for scene in &study.settings.scenes {
            let frames: Vec<_> = curve(study, knob).into_iter().filter_map(|(_, point)| point.frame(scene)).collect();
            let range = |figure: fn(&crate::frames::FrameFigures) -> Option<f64>| {
                let known: Vec<f64> = frames.iter().filter_map(|frame| figure(frame)).collect();
                let highest = known.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let lowest = known.iter().copied().fold(f64::INFINITY, f64::min);
                if known.is_empty() { 0.0 } else { highest - lowest }
            };
            gains.push(KnobGain {
                knob: knob.name(),
                scene: scene.clone(),
                filter_db: range(|frame| frame.psnr_filter),
                truth_db: range(|frame| frame.psnr_truth),
            });
        }
    }
    gains
}

/// The points of a knob in the order of its values.
pub(super) fn curve(study: &Study, knob: Knob) -> Vec<(u32, &Point)> {
    let of = |&value: &u32| {
        let wanted = knob.with(value, base_of(knob));
        Some((value, study.points.iter().find(|point| precision(point) == wanted)?))
    };
    knob.values().iter().filter_map(of).collect()
}

/// Which knobs buy nothing, and where.
pub(super) fn idle_knobs(study: &Study) -> Vec<String> {
    let gains = knob_gains(study);
    let mut sentences = Vec::new();
    for knob in Knob::ALL {
        let of_knob = || gains.iter().filter(|gain| gain.knob == knob.name());
        let idle: Vec<&str> =
            of_knob().filter(|gain| gain.filter_db < BUYS_SOMETHING_DB).map(|gain| gain.scene.as_str()).collect();
        let most = of_knob().max_by(|a, b| a.filter_db.total_cmp(&b.filter_db));
        let Some(most) = most else { continue };
        let of_truth = of_knob().map(|gain| gain.truth_db).fold(0.0, f64::max);
        let nothing = if idle.is_empty() {
            "every scene shows it".into()
        } else {
            format!("it buys nothing in {}", idle.join(", "))
        };
        sentences.push(format!(
            "{knob}: up to {:.1} dB of float64's filter ({}), {of_truth:.1} dB of the truth; {nothing}.",
            most.filter_db, most.scene
        ));
    }
    sentences
}

/// Where floats are ahead, and where not.
pub(super) fn floats(study: &Study) -> Vec<String> {
    let error = |stages: &[crate::sweep::StageFigures]| {
        stages.iter().find(|stage| stage.figure == "s, t").and_then(|stage| stage.nearly_all)
    };
    let standard = study.points.iter().find(|point| point.name == "standard");
    let mut sentences = Vec::new();
    for float in &study.floats {
        let Some(timing) = &float.host else { continue };
        let time = if timing.ratio < 1.0 {
            format!("{} takes {:.2} of the time of `standard` in lanes", float.name, timing.ratio)
        } else {
            format!("{} takes {:.1} times as long as `standard` in lanes", float.name, timing.ratio)
        };
        let own = error(&float.stages);
        let theirs = standard.and_then(|point| error(&point.stages));
        let accuracy = match own.zip(theirs) {
            Some((own, theirs)) if own < theirs => {
                format!(
                    "99.9 % of its s and t are within {}, those of `standard` within {}: here floats win",
                    power(Some(own)),
                    power(Some(theirs))
                )
            }
            Some((own, theirs)) => format!(
                "99.9 % of its s and t are within {}, those of `standard` within {}",
                power(Some(own)),
                power(Some(theirs))
            ),
            None => "it is what all others are measured against".into(),
        };
        sentences.push(format!("{time}; {accuracy}."));
    }
    sentences
}
