//! The keys `[[light]]`, `highlight`, `peaks`.

use glam::DVec3;
use toml::Spanned;

use crate::description::{GivenDescription, HighlightDescription, LightDescription, PeaksDescription};
use crate::error::SceneError;
use crate::lighting::{
    EXPONENTS, GivenPeak, Highlight, Light, LightPlace, MAX_GIVEN_PEAKS, MAX_LIGHTS, PeakSource, Peaks,
};
use crate::source::{Exactly, Source};

/// Amplitudes of peaks, the range of their storage.
const AMPLITUDES: std::ops::RangeInclusive<f64> = 0.0..=15.0;
/// Largest channel of a light's colour: brighter than white is allowed.
const BRIGHTEST: f64 = 16.0;
/// Coordinates of directions and positions.
const COORDINATES: std::ops::RangeInclusive<f64> = -1e6..=1e6;

/// A vector with a length, normalised.
fn direction(source: &Source, key: &str, vector: &Spanned<Exactly<f64, 3>>) -> Result<DVec3, SceneError> {
    let direction = DVec3::from_array(source.all_in_range(key, vector, COORDINATES)?);
    // The square of a shorter vector would lose digits.
    if direction.length() < 1e-6 {
        let help = "give a vector of any length but zero, for example [0, 0, 1]";
        return Err(source.value_error(vector.span(), format!("`{key}` has no length"), help));
    }
    Ok(direction.normalize())
}

fn colour(source: &Source, value: &Option<Spanned<Exactly<f64, 3>>>, brightest: f64) -> Result<[f32; 3], SceneError> {
    Ok(source.numbers("colour", value, [1.0; 3], 0.0..=brightest)?.map(|channel| channel as f32))
}

/// The lights of a scene.
pub(super) fn lights(source: &Source, lights: &[Spanned<LightDescription>]) -> Result<Vec<Light>, SceneError> {
    if let Some(extra) = lights.get(MAX_LIGHTS) {
        let help = format!("a scene has at most {MAX_LIGHTS}");
        return Err(source.value_error(extra.span(), "too many lights", help));
    }
    let light = |light: &Spanned<LightDescription>| {
        let LightDescription { direction: far, position, colour: brightness } = light.get_ref();
        let place = match (far, position) {
            (Some(vector), None) => LightPlace::Direction(direction(source, "direction", vector)?),
            (None, Some(point)) => {
                LightPlace::Point(DVec3::from_array(source.all_in_range("position", point, COORDINATES)?))
            }
            (Some(_), Some(point)) => {
                let help = "keep `direction` (from the surface to a light infinitely far away) or `position`";
                return Err(source.value_error(point.span(), "the light has both `direction` and `position`", help));
            }
            (None, None) => {
                let help = "give `direction` (from the surface to the light) or `position`";
                return Err(source.value_error(light.span(), "the light stands nowhere", help));
            }
        };
        Ok(Light { place, colour: colour(source, brightness, BRIGHTEST)? })
    };
    lights.iter().map(light).collect()
}

/// Facts about an object's maps, for keys that need a map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Available {
    pub(super) lights: bool,
    pub(super) heights: bool,
    pub(super) bumps: bool,
}

fn needs_lights(source: &Source, key: &str, span: std::ops::Range<usize>, there: Available) -> Result<(), SceneError> {
    if there.lights {
        return Ok(());
    }
    let help = "add [[light]] with a `direction` or a `position`";
    Err(source.value_error(span, format!("there is no light for `{key}`"), help))
}

/// The highlight of a material.
pub(super) fn highlight(
    source: &Source,
    description: &Spanned<HighlightDescription>,
    there: Available,
) -> Result<Highlight, SceneError> {
    needs_lights(source, "highlight", description.span(), there)?;
    let HighlightDescription { exponent, colour: tint, form } = description.get_ref();
    let exponent = source.number("exponent", exponent, 64.0, EXPONENTS)?;
    Ok(Highlight { exponent, colour: colour(source, tint, 1.0)?, form: *form })
}

/// The peaks of a material.
pub(super) fn peaks(
    source: &Source,
    description: &Spanned<PeaksDescription>,
    there: Available,
) -> Result<Peaks, SceneError> {
    needs_lights(source, "peaks", description.span(), there)?;
    let PeaksDescription { given, exponent, amplitude, colour: tint, shadowing } = description.get_ref();
    let from = match given {
        None if !there.bumps => {
            let help = "add `height_map` or `normal_map` to the material, or give the peaks with `given = [..]`";
            return Err(source.value_error(description.span(), "there are no bumps to make peaks of", help));
        }
        None => PeakSource::Bump {
            exponent: source.number("exponent", exponent, 40.0, EXPONENTS)?,
            amplitude: source.number("amplitude", amplitude, 1.0, AMPLITUDES)?,
        },
        Some(given) => {
            let own = exponent.as_ref().map(Spanned::span).or(amplitude.as_ref().map(Spanned::span));
            if let Some(span) = own {
                let help = "give each peak its own, or leave `given` out";
                return Err(source.value_error(span, "given peaks have their own amplitude and exponent", help));
            }
            if !(1..=MAX_GIVEN_PEAKS).contains(&given.get_ref().len()) {
                let help = format!("give 1 to {MAX_GIVEN_PEAKS}");
                return Err(source.value_error(given.span(), "the number of peaks is out of range", help));
            }
            let peak = |peak: &Spanned<GivenDescription>| {
                let GivenDescription { amplitude, normal, exponent } = peak.get_ref();
                Ok(GivenPeak {
                    amplitude: source.in_range("amplitude", *amplitude.get_ref(), amplitude.span(), AMPLITUDES)?,
                    normal: direction(source, "normal", normal)?,
                    exponent: source.in_range("exponent", *exponent.get_ref(), exponent.span(), EXPONENTS)?,
                })
            };
            PeakSource::Given(given.get_ref().iter().map(peak).collect::<Result<_, SceneError>>()?)
        }
    };
    let shadowing = shadowing.as_ref().and_then(|wanted| Some((wanted.span(), wanted.get_ref().0?)));
    if let Some((span, _)) = &shadowing
        && (!there.heights || matches!(from, PeakSource::Given(_)))
    {
        let help = "use `height_map` and peaks without `given`: horizons are found from heights";
        return Err(source.value_error(span.clone(), "there are no heights to cast shadows", help));
    }
    Ok(Peaks { source: from, colour: colour(source, tint, 1.0)?, shadowing: shadowing.map(|(_, how)| how) })
}
