//! One figure of a setting for each clock and for its frames.

use crate::choose::Clock;
use crate::superscript::superscript;
use crate::sweep::Point;

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

/// The target that stands for soft cores: the smallest with a multiplier.
pub(super) const SOFT_CORE: &str = "riscv32imac";

/// PSNR against the filter of `standard` in float64 in the worst scene, dB; `None` where all are equal.
pub(super) fn worst_psnr(point: &Point) -> Option<f64> {
    point.frames.iter().filter_map(|frame| frame.psnr_filter).min_by(f64::total_cmp)
}

fn mean(figures: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = figures.fold((0.0, 0), |(sum, count), figure| (sum + figure, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// What a setting takes on a clock: time of a frame in lanes as a multiple of `standard`'s; full adders of the reflection;
/// instructions a fragment on [`SOFT_CORE`]; texels a pixel. Means over the scenes.
pub(super) fn cost(point: &Point, clock: Clock) -> Option<f64> {
    match clock {
        Clock::Host => mean(point.host.frames.values().map(|timing| timing.ratio)),
        Clock::Hardware => point.hardware.as_ref().map(|hardware| hardware.full_adders as f64),
        Clock::SoftCore => point.soft_core.get(SOFT_CORE).map(|price| price.instructions),
        Clock::Memory => mean(point.frames.iter().map(|frame| frame.texels)),
    }
}

/// The clocks with the unit of [`cost`].
pub(super) const CLOCKS: [(Clock, &str); 4] = [
    (Clock::Host, "host: time of a frame ÷ standard"),
    (Clock::Hardware, "hardware: full adders of the reflection"),
    (Clock::SoftCore, "soft core: instructions a fragment, riscv32imac"),
    (Clock::Memory, "memory: texels a pixel"),
];
