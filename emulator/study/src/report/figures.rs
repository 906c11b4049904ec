//! One figure of a setting for each clock and for its frames.

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;

use crate::choose::Clock;
use crate::measurement::{Point, Study, base_of};
use crate::soft_core;
use crate::superscript::superscript;

/// Headings and rows.
pub(super) type Table = (Vec<String>, Vec<Vec<String>>);

/// An error as a power of two.
pub(super) fn power(error: Option<f64>) -> String {
    match error {
        Some(0.0) => "0".into(),
        Some(error) => {
            let exponent = (10.0 * error.log2()).round() / 10.0;
            format!("2{}", superscript(format_args!("{exponent:.1}")))
        }
        None => "no number".into(),
    }
}

/// A number as text: in groups of three from five digits on.
pub(super) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    if digits.len() < 5 {
        return digits;
    }
    let (first, rest) = digits.split_at((digits.len() - 1) % 3 + 1);
    let groups = rest.as_bytes().chunks(3).map(|group| String::from_utf8_lossy(group).into_owned());
    std::iter::once(first.to_string()).chain(groups).collect::<Vec<_>>().join(" ")
}

/// The base of a knob in words: `standard`, or `standard` with the knobs of [`base_of`] that differ.
pub(super) fn base_name(knob: Knob) -> String {
    let base = base_of(knob);
    let turned = Knob::ALL.into_iter().filter(|other| other.value_in(&base) != other.value_in(&Precision::STANDARD));
    turned.fold("standard".into(), |name, other| format!("{name} with {other} {}", other.text(other.value_in(&base))))
}

/// The scenes whose frames are timed at every setting. Means of times and figures plotted against them cover these scenes.
pub(super) fn timed_scenes(study: &Study) -> &[String] {
    let scenes = &study.settings.scenes;
    &scenes[..study.settings.timed_scenes.min(scenes.len())]
}

/// PSNR against the filter of `standard` in float64 in the worst scene, dB; `None` if all are equal.
pub(super) fn worst_psnr(point: &Point) -> Option<f64> {
    point.frames.iter().filter_map(|frame| frame.psnr_filter).min_by(f64::total_cmp)
}

pub(super) fn mean(figures: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = figures.fold((0.0, 0), |(sum, count), figure| (sum + figure, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// Cost of a setting on a clock: time of a frame in lanes as a multiple of `standard`'s, mean of the [`timed_scenes`]; full
/// adders of the reflection; clocks a fragment on [`soft_core::CORE`]; texels a pixel, mean of all scenes.
pub(super) fn cost(point: &Point, clock: Clock) -> Option<f64> {
    match clock {
        Clock::Host => mean(point.host.frames.values().map(|timing| timing.ratio)),
        Clock::Hardware => point.hardware.as_ref().map(|hardware| hardware.full_adders as f64),
        Clock::SoftCore => point.cost_on(soft_core::Machine::default()),
        Clock::Memory => mean(point.frames.iter().map(|frame| frame.texels)),
    }
}

/// The clocks with the unit of [`cost`].
pub(super) const CLOCKS: [(Clock, &str); 4] = [
    (Clock::Host, "host: time of a frame ÷ standard"),
    (Clock::Hardware, "hardware: full adders of the reflection"),
    (Clock::SoftCore, "soft core: clocks a fragment, vexriscv-standard"),
    (Clock::Memory, "memory: texels a pixel"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_stand_in_groups_of_three_from_five_on() {
        let texts = [0, 999, 9999, 10_000, 123_456, 1_002_003].map(grouped);
        assert_eq!(texts, ["0", "999", "9999", "10 000", "123 456", "1 002 003"]);
    }

    #[test]
    fn the_unit_of_the_soft_core_names_it() {
        assert!(CLOCKS[Clock::SoftCore as usize].1.ends_with(soft_core::CORE));
    }

    #[test]
    fn a_base_is_named_by_what_differs_from_standard() {
        assert_eq!(base_name(Knob::FractionBits), "standard");
        assert_eq!(base_name(Knob::ReciprocalSeedBits), "standard with reciprocal.steps 0");
    }
}
