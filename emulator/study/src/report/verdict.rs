//! Conclusions from the figures: prices of a bit, knobs that buy nothing, best choices.

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;

use super::figures::{CLOCKS, Table, cost, grouped, power, worst_psnr};
use crate::choose::{Aim, Candidate, Clock, choose};
use crate::measurement::{Point, Study, base_of};
use crate::soft_core::{self, Machine};

/// Least change of a scene's PSNR, dB, that counts as a gain from a knob.
pub const BUYS_SOMETHING_DB: f64 = 0.5;

/// The cheapest setting for each bar and clock.
pub(super) fn choices(study: &Study) -> Table {
    let candidates: Vec<Candidate> = study
        .points
        .iter()
        .filter_map(|point| {
            Some(Candidate {
                precision: point.precision()?,
                name: Some(point.name.clone()),
                psnr: worst_psnr(point).unwrap_or(f64::INFINITY),
                cost: CLOCKS.map(|(clock, _)| cost(point, clock)),
            })
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
                if cost < 100.0 {
                    format!("{name}: {cost:.2}")
                } else {
                    format!("{name}: {}", grouped(cost.round() as u64))
                }
            }
            Err(_) => "none".into(),
        }));
        row
    });
    (headings, rows.into())
}

/// Host cost of kept bits alone within each word width: times of fragments in lanes with their noise, without those measured
/// under load.
fn times_within_words(study: &Study) -> Vec<String> {
    let points = curve(study, Knob::FractionBits);
    let word_bits = |bits: &u32| Knob::FractionBits.with(*bits, Precision::STANDARD).word_bits();
    let by_words = points.chunk_by(|(a, _), (b, _)| word_bits(a) == word_bits(b));
    let sentence = |points: &[(u32, &Point)]| {
        let quiet = || points.iter().map(|(bits, point)| (bits, &point.host.lanes)).filter(|(_, time)| !time.loaded);
        let (fastest, least) = quiet().min_by(|(_, a), (_, b)| a.ratio.total_cmp(&b.ratio))?;
        let (slowest, most) = quiet().max_by(|(_, a), (_, b)| a.ratio.total_cmp(&b.ratio))?;
        let noise = 100.0 * least.noise.max(most.noise);
        let difference = 100.0 * (most.ratio - least.ratio);
        let what = if difference <= noise {
            format!(
                "a bit costs nothing that could be measured: times differ by {difference:.0} % of that of `standard`"
            )
        } else {
            format!(
                "{slowest} kept bits take {:.2} of the time of `standard`, {fastest} take {:.2}",
                most.ratio, least.ratio
            )
        };
        (fastest != slowest)
            .then(|| format!("On the host, within words of {} bits, {what} (noise {noise:.0} %).", word_bits(fastest)))
    };
    by_words.filter_map(sentence).collect()
}

/// Cost of a bit of accuracy on each clock, in one sentence each: from `narrow` to `standard`, and from `standard` to `precise`.
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
    let on_host = sentence("On the host", "the time of a fragment in lanes", &|point| Some(point.host.lanes.ratio));
    let [cached, uncached, smallest] = soft_core::SHOWN_CORES;
    let on = |core: &'static str| move |point: &Point| point.cost_on(Machine::Core(core));
    let elsewhere = [
        sentence("In hardware", "the full adders", &|point| cost(point, Clock::Hardware)),
        sentence("In hardware", "the gate levels", &|point| Some(f64::from(point.hardware.as_ref()?.levels))),
        sentence(&format!("On a soft core with a multiplier and a cache ({cached})"), "the clocks", &on(cached)),
        sentence(&format!("On one without a cache ({uncached})"), "the clocks", &on(uncached)),
        sentence(&format!("On one with neither ({smallest})"), "the clocks", &on(smallest)),
        sentence("In memory", "the texels", &|point| cost(point, Clock::Memory)),
    ];
    let within_words = times_within_words(study);
    let mut sentences: Vec<String> =
        on_host.into_iter().chain(within_words).chain(elsewhere.into_iter().flatten()).collect();
    sentences.push(format!(
        "A bit halves the error of s and t that 99.9 % of the fragments stay below: {} in `narrow`, {} in `standard`, {} in `precise`.",
        power(Some(error(narrow))),
        power(Some(error(standard))),
        power(Some(error(precise)))
    ));
    sentences
}

/// Effect of a knob on a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct KnobGain {
    /// Its name.
    pub knob: &'static str,
    /// The scene.
    pub scene: String,
    /// Difference between the best and the worst of its values, dB: PSNR against the filter of `standard` in float64.
    pub filter_db: f64,
    /// Difference against the truth, in the same way.
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
        Some((value, study.points.iter().find(|point| point.precision() == Some(wanted))?))
    };
    knob.values().iter().filter_map(of).collect()
}

/// Knobs that buy nothing, and their scenes.
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

/// Cases in which floats are ahead, and in which they are not.
pub(super) fn floats(study: &Study) -> Vec<String> {
    let error = |stages: &[crate::measurement::StageFigures]| {
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

#[cfg(test)]
mod tests {
    use super::super::kept;
    use super::*;
    use crate::measurement::settings;

    #[test]
    fn every_point_of_the_kept_study_says_its_knobs() {
        let (study, settings) = (kept(), settings());
        for point in &study.points {
            let setting = settings.iter().find(|setting| setting.name == point.name).expect("a known setting");
            assert_eq!(point.precision(), Some(setting.precision), "{}", point.name);
            let cost = soft_core::clocks(soft_core::CORE, &setting.precision);
            assert_eq!(point.cost_on(Machine::default()), cost, "{}", point.name);
            // Other seeds are measured without Newton steps, and priced with them.
            let is_seed = matches!(setting.knob, Some((Knob::ReciprocalSeedBits | Knob::InverseRootSeedBits, _)));
            assert!(cost.is_some() || is_seed, "{}", point.name);
        }
        let mut unknown = study.points[0].clone();
        unknown.knobs.insert(Knob::Direction.name().into(), "upwards".into());
        assert_eq!((unknown.precision(), unknown.cost_on(Machine::default())), (None, None));
    }

    #[test]
    fn what_a_bit_costs_within_words_is_said_as_it_was_measured() {
        let mut study = kept();
        for point in &mut study.points {
            let lanes = &mut point.host.lanes;
            (lanes.ratio, lanes.noise, lanes.loaded) = (1.0, 0.1, false);
        }
        let all = times_within_words(&study);
        assert!(all.len() == 2 && all.iter().all(|text| text.contains("nothing that could be measured")), "{all:?}");

        let index = study.points.iter().position(|point| point.name == "fraction_bits=24").expect("it is measured");
        study.points[index].host.lanes.ratio = 1.5;
        let all = times_within_words(&study);
        assert!(all[0].contains("nothing") && all[1].contains("24 kept bits take 1.50 of the time"), "{all:?}");

        study.points[index].host.lanes.loaded = true;
        assert!(times_within_words(&study)[1].contains("nothing"), "a time under load says nothing");
    }
}
