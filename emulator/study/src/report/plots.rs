//! Figures of a study as plots.

use roughxel_core::knob::Knob;
use roughxel_html_report::plot::{Axis, Mark, Plot, Point as Dot, Scale, Series, Style};

use super::figures::{CLOCKS, base_name, cost, mean, timed_scenes, worst_psnr};
use super::tables::named;
use super::verdict::curve;
use crate::choose::Clock;
use crate::frames::FrameFigures;
use crate::measurement::{Point, StageFigures, Study};
use crate::soft_core::Machine;
use crate::stability::HardCase;

fn axis(label: &str, scale: Scale) -> Axis {
    Axis { label: label.into(), scale }
}

fn dot(x: f64, y: f64, label: Option<&str>) -> Dot {
    Dot { x, y, label: label.map(String::from) }
}

fn series(name: &str, style: Style, points: Vec<Dot>) -> Series {
    Series { name: name.into(), style, dashed: false, muted: false, points }
}

/// The error of s and t that 99.9 % of random fragments stay below. The worst error is near a pole, where f32 has none.
fn places(stages: &[StageFigures]) -> Option<f64> {
    stages.iter().find(|stage| stage.figure == "s, t").and_then(|stage| stage.nearly_all)
}

/// Dots that no other dot beats on each axis, from the left: less `x`, and less `y` or more of it.
fn front(dots: &[Dot], more_is_better: bool) -> Series {
    let mut sorted: Vec<&Dot> = dots.iter().filter(|dot| dot.x.is_finite() && dot.y.is_finite()).collect();
    // Of several dots at one position the best comes first, as it beats the others.
    sorted.sort_by(|a, b| {
        let better = if more_is_better { b.y.total_cmp(&a.y) } else { a.y.total_cmp(&b.y) };
        a.x.total_cmp(&b.x).then(better)
    });
    let mut points: Vec<Dot> = Vec::new();
    for dot in sorted {
        let is_better = |last: &Dot| if more_is_better { dot.y > last.y } else { dot.y < last.y };
        if points.last().is_none_or(is_better) {
            points.push(Dot { label: None, ..dot.clone() });
        }
    }
    Series { name: "nothing beats these".into(), style: Style::Line, dashed: true, muted: true, points }
}

/// Knobs of the datapath, one curve each; all others stand as points.
const CURVES: [Knob; 2] = [Knob::FractionBits, Knob::Direction];

/// The settings as series of dots: named profiles, knobs as curves, all other settings as context.
fn settings(study: &Study, curves: &[Knob], dot_of: impl Fn(&Point) -> Option<(f64, f64)>) -> Vec<Series> {
    let dots = |points: &mut dyn Iterator<Item = (String, &Point)>| -> Vec<Dot> {
        points.filter_map(|(label, point)| dot_of(point).map(|(x, y)| dot(x, y, Some(&label)))).collect()
    };
    let mut profiles = named(study).map(|point| (point.name.clone(), point));
    let mut all = vec![series("named profiles", Style::Points, dots(&mut profiles))];
    for &knob in curves {
        let mut values = curve(study, knob).into_iter().map(|(value, point)| (knob.text(value).to_string(), point));
        all.push(series(knob.name(), Style::LinePoints, dots(&mut values)));
    }
    let others = study.points.iter().filter(|point| {
        let knob = point.knob.as_ref();
        knob.is_some_and(|knob| curves.iter().all(|curve| curve.name() != knob))
    });
    let mut others = others.map(|point| (point.name.replace('=', " "), point));
    all.push(Series { muted: true, ..series("standard with one knob changed", Style::Points, dots(&mut others)) });
    all
}

/// Adds the front. Of the knobs, only points on the front keep their labels.
fn with_front(mut all: Vec<Series>, more_is_better: bool) -> Vec<Series> {
    let dots: Vec<Dot> = all.iter().flat_map(|series| series.points.iter().cloned()).collect();
    let front = front(&dots, more_is_better);
    let is_best = |dot: &Dot| front.points.iter().any(|best| [best.x, best.y] == [dot.x, dot.y]);
    let of_knobs = all.iter_mut().filter(|series| series.muted || series.style == Style::LinePoints);
    for dot in of_knobs.flat_map(|series| &mut series.points) {
        dot.label = dot.label.take().filter(|_| is_best(dot));
    }
    all.push(front);
    all
}

/// Error of the datapath against the time of a fragment on the host.
fn bits_on_host(study: &Study) -> Plot {
    let mut all = settings(study, &[], |point| Some((point.host.lanes.ratio, places(&point.stages)?)));
    all[0].name = "profiles, SIMD".into();
    let scalar = named(study).filter_map(|point| {
        // Ratios are to `standard` in SIMD, as everywhere here.
        let base = study.points.iter().find(|point| point.name == "standard")?;
        Some(dot(point.host.scalar.ns / base.host.lanes.ns, places(&point.stages)?, Some(&point.name)))
    });
    all.insert(1, series("profiles, scalar", Style::Points, scalar.collect()));
    let floats = study
        .floats
        .iter()
        .filter_map(|float| Some(dot(float.host.as_ref()?.ratio, places(&float.stages)?, Some(&float.name))));
    all.insert(2, series("f32", Style::Points, floats.collect()));
    Plot {
        title: "Host: error and time of a fragment".into(),
        description: bits_in_a_sentence(study).unwrap_or_default(),
        x: axis("time of a fragment ÷ standard in SIMD (left is faster)", Scale::Log2),
        y: axis("error of s, t that 99.9 % stay below, half faces (down is better)", Scale::Log2),
        series: with_front(all, false),
        marks: Vec::new(),
    }
}

/// The message of [`bits_on_host`], with its figures.
fn bits_in_a_sentence(study: &Study) -> Option<String> {
    let profile = |name: &str| named(study).find(|point| point.name == name);
    let (narrow, precise) = (profile("narrow")?, profile("precise")?);
    let gain = (places(&narrow.stages)? / places(&precise.stages)?).log2();
    let time = precise.host.lanes.ratio / narrow.host.lanes.ratio;
    let float = study.floats.iter().find(|float| float.name == "f32, batched")?.host.as_ref()?.ratio;
    Some(format!(
        "From narrow to precise the error shrinks by {gain:.0} bits, and a fragment takes {time:.1} times as long; batched f32 takes \
         {float:.2} of the time of standard."
    ))
}

/// PSNR of frames against the truth over their time, including modes and sample counts, for the scenes timed at every setting.
fn frames_on_host(study: &Study) -> Plot {
    let timed = timed_scenes(study);
    let scenes = timed.join(" and ");
    let psnr = |frames: &[FrameFigures]| {
        let timed = frames.iter().filter(|frame| timed.contains(&frame.scene));
        mean(timed.filter_map(|frame| frame.psnr_truth))
    };
    let mut all = settings(study, &[Knob::MaxProbes], |point| Some((cost(point, Clock::Host)?, psnr(&point.frames)?)));
    let modes = study.modes.iter().filter_map(|mode| {
        let time = mean(timed.iter().filter_map(|scene| Some(mode.times.get(scene)?.ratio)))?;
        Some(dot(time, psnr(&mode.frames)?, Some(&mode.name)))
    });
    let modes: Vec<Dot> = modes.collect();
    let standard = named(study).find(|point| point.name == "standard").and_then(|point| psnr(&point.frames));
    let sampled: Vec<String> = modes
        .iter()
        .filter_map(|dot| {
            let name = dot.label.as_ref().filter(|name| name.ends_with("samples"))?;
            Some(format!("{name} {:.1} dB ({:.1} ×)", dot.y, dot.x))
        })
        .collect();
    let message =
        standard.map(|psnr| format!("Frames of standard reach {psnr:.1} dB (1 × the time), {}.", sampled.join(", ")));
    // Other knobs change frames by less than the distance of two markers.
    all.retain(|series| !series.muted);
    all.push(series("no footprints", Style::Points, modes));
    Plot {
        title: "Host: footprints and more samples a pixel".into(),
        description: message.unwrap_or_default(),
        x: axis(&format!("time of a frame ÷ standard, mean of {scenes} (left is faster)"), Scale::Log2),
        y: axis(
            &format!("PSNR against {} samples a pixel, dB (up is better)", study.settings.samples_edge.pow(2)),
            Scale::Linear,
        ),
        series: with_front(all, true),
        marks: Vec::new(),
    }
}

/// The two plots of `docs/performance.md`.
pub(super) fn readme(study: &Study) -> [Plot; 2] {
    [bits_on_host(study), frames_on_host(study)]
}

/// Two plots for the host, and plots of error and picture for every other clock.
pub(super) fn clocks(study: &Study) -> Vec<Plot> {
    let mut plots = vec![bits_on_host(study), frames_on_host(study)];
    for (clock, unit) in CLOCKS.into_iter().filter(|(clock, _)| *clock != Clock::Host) {
        let name = unit.split(':').next().unwrap_or(unit);
        if clock != Clock::Memory {
            let mut all = settings(study, &CURVES, |point| Some((cost(point, clock)?, places(&point.stages)?)));
            if clock == Clock::SoftCore {
                // `libm` gives the bits of the standard library.
                let prices = Machine::default().float().map_or([None; 2], |float| {
                    [
                        Some(("f32", "f32, libm", float.libm)),
                        Some(("f32, micromath", "f32, micromath", float.micromath)),
                    ]
                });
                let floats = prices.into_iter().flatten().filter_map(|(measured, name, clocks)| {
                    let float = study.floats.iter().find(|float| float.name == measured)?;
                    Some(dot(clocks, places(&float.stages)?, Some(name)))
                });
                all.push(series("floats", Style::Points, floats.collect()));
            }
            plots.push(Plot {
                title: format!("{}: error of a fragment", capital(name)),
                description: format!(
                    "Error of s and t on the cube face that 99.9 % of the fragments stay below, against {unit}."
                ),
                x: axis(unit.split(": ").last().unwrap_or(unit), Scale::Log2),
                y: axis("error of s, t, 99.9 % below (half faces)", Scale::Log2),
                series: with_front(all, false),
                marks: Vec::new(),
            });
        }
        let curves = if clock == Clock::Memory { &[Knob::MaxProbes, Knob::LodBits][..] } else { &CURVES[..1] };
        let all = settings(study, curves, |point| Some((cost(point, clock)?, worst_psnr(point)?)));
        plots.push(Plot {
            title: format!("{}: pictures", capital(name)),
            description: format!("PSNR of the worst scene against the filter of standard in float64, over {unit}."),
            x: axis(unit.split(": ").last().unwrap_or(unit), Scale::Log2),
            y: axis("PSNR against float64's filter (dB)", Scale::Linear),
            series: with_front(all, true),
            marks: Vec::new(),
        });
    }
    plots
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// The name of every knob, with pictures over its values, and prices.
pub(super) fn knobs(study: &Study) -> Vec<(String, Vec<Plot>)> {
    let base = study.points.iter().find(|point| point.name == "standard");
    let plots = |knob: Knob| {
        let points = curve(study, knob);
        // Choices and an exact direction are not numbers, so values are placed in their order.
        let place = |index: usize, value: u32, first: bool, y: f64| Dot {
            x: index as f64 + 1.0,
            y,
            label: first.then(|| knob.text(value).to_string()),
        };
        let scenes = study.settings.scenes.iter().enumerate().map(|(nth, scene)| {
            let dots = points.iter().enumerate().filter_map(|(index, (value, point))| {
                Some(place(index, *value, nth == 0, point.frame(scene)?.psnr_filter?))
            });
            series(scene, Style::LinePoints, dots.collect())
        });
        let prices = CLOCKS.iter().enumerate().map(|(nth, (clock, unit))| {
            let base = base.and_then(|point| cost(point, *clock));
            let dots = points.iter().enumerate().filter_map(|(index, (value, point))| {
                Some(place(index, *value, nth == 0, cost(point, *clock)? / base?))
            });
            series(unit.split(':').next().unwrap_or(unit), Style::LinePoints, dots.collect())
        });
        vec![
            Plot {
                title: format!("{knob}: pictures"),
                description: format!(
                    "PSNR of each scene against the filter of standard in float64, for the values of {knob} from the least accurate on; \
                     the other knobs are those of {}.",
                    base_name(knob)
                ),
                x: axis(&format!("{knob}, value by value"), Scale::Linear),
                y: axis("PSNR against float64's filter (dB)", Scale::Linear),
                series: scenes.collect(),
                marks: Vec::new(),
            },
            Plot {
                title: format!("{knob}: price"),
                description: format!("What each value of {knob} takes on each clock, as a multiple of standard."),
                x: axis(&format!("{knob}, value by value"), Scale::Linear),
                y: axis("÷ standard", Scale::Linear),
                series: prices.collect(),
                marks: Vec::new(),
            },
        ]
    };
    Knob::ALL.into_iter().map(|knob| (knob.name().to_string(), plots(knob))).collect()
}

/// Errors near a degeneracy.
pub(super) fn stability(case: &HardCase) -> Plot {
    let curves = case.curves.iter().map(|curve| {
        let dots = curve.points.iter().map(|&[distance, error]| dot(distance, error, None));
        Series { dashed: curve.bar.is_none(), ..series(&curve.method, Style::Line, dots.collect()) }
    });
    // Floats have no fallback, only distances at which the case is a fallback case.
    let mut marks: Vec<Mark> = Vec::new();
    for curve in case.curves.iter().filter(|curve| curve.bar.is_some()) {
        let Some(x) = curve.fallback else { continue };
        match marks.iter_mut().find(|mark| mark.x == x) {
            Some(mark) => mark.label = format!("{}, {}", mark.label, curve.method),
            None => marks.push(Mark { x, label: curve.method.clone() }),
        }
    }
    Plot {
        title: case.title.clone(),
        description: format!(
            "{} against {}, both on logarithmic axes. {} {}",
            case.error, case.distance, case.naive, case.fallback
        ),
        x: axis(&case.distance, Scale::Log2),
        y: axis(&case.error, Scale::Log2),
        series: curves.collect(),
        marks,
    }
}

#[cfg(test)]
mod tests {
    use super::super::kept;
    use super::*;

    fn front_of(dots: &[[f64; 2]], more_is_better: bool) -> Vec<[f64; 2]> {
        let dots: Vec<Dot> = dots.iter().map(|&[x, y]| dot(x, y, None)).collect();
        front(&dots, more_is_better).points.iter().map(|dot| [dot.x, dot.y]).collect()
    }

    #[test]
    fn of_points_with_the_same_cost_the_best_alone_is_on_the_front() {
        let dots = [[1.0, 5.0], [1.0, 3.0], [1.0, 4.0], [2.0, 3.0], [2.0, 6.0], [3.0, 1.0], [3.0, 7.0]];
        assert_eq!(front_of(&dots, false), [[1.0, 3.0], [3.0, 1.0]]);
        assert_eq!(front_of(&dots, true), [[1.0, 5.0], [2.0, 6.0], [3.0, 7.0]]);
        let reversed: Vec<_> = dots.into_iter().rev().collect();
        assert_eq!(front_of(&reversed, true), front_of(&dots, true));
    }

    #[test]
    fn frames_on_the_host_are_judged_in_the_scenes_that_are_timed() {
        let mut study = kept();
        let (timed, before) = (timed_scenes(&study).to_vec(), frames_on_host(&study).table());
        assert!(timed.len() < study.settings.scenes.len());
        let of_points = study.points.iter_mut().map(|point| &mut point.frames);
        let frames = of_points.chain(study.modes.iter_mut().map(|mode| &mut mode.frames)).flatten();
        frames.filter(|frame| !timed.contains(&frame.scene)).for_each(|frame| frame.psnr_truth = Some(5.0));
        study.modes.iter_mut().for_each(|mode| mode.times.retain(|scene, _| timed.contains(scene)));
        assert_eq!(frames_on_host(&study).table(), before);
    }

    #[test]
    fn what_is_no_number_is_on_no_front() {
        assert_eq!(front_of(&[[f64::NAN, 9.0], [1.0, f64::INFINITY], [2.0, 1.0]], true), [[2.0, 1.0]]);
    }
}
