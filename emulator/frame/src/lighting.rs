//! The lights of a scene in the form that the shader takes.
//!
//! Peaks of a map are texels whose value is the light they return. They are summed in the texel and filtered like any other texel
//! value; the peaks themselves are never averaged (F92 §2.4).

use std::sync::Arc;

use roughxel_core::plan::{HorizonKind, SurfacePlan};
use roughxel_core::ports::{Port, StoredHorizon, StoredPeak};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, shininess, stored_horizon, stored_peak, uniform_law};
use roughxel_peaks::{self as pyramid, MAX_PEAKS, PeakPyramid};
use roughxel_scene::{Highlight, HighlightForm, Light, LightPlace, Material, PeakSource, Peaks};
use roughxel_shader::{self as shader, Lighting, MOST_PEAKS, ObjectPlan, PackedPeak, PeakTexels, Shine, WrappedMap};

use super::colour::colour_word;
use super::{printed, shared};

/// Makes the lighting of an object; `map` holds its peaks if they come from a map.
pub(super) fn lighting(
    material: &Material,
    plan: &ObjectPlan,
    lights: &[Light],
    map: Option<Arc<PeakTexels>>,
    p: &Precision,
) -> Option<Lighting> {
    match (&material.highlight, plan.highlight, &material.peaks, plan.peaks) {
        (Some(highlight), Some(plan), ..) => Some(of_highlight(highlight, lights, plan, p)),
        (.., Some(peaks), Some(surface)) => Some(of_peaks(peaks, map, lights, surface, p)),
        _ => None,
    }
}

/// The highlight of a material.
fn of_highlight(highlight: &Highlight, lights: &[Light], plan: SurfacePlan, p: &Precision) -> Lighting {
    let exponent = highlight.exponent;
    let shine = match highlight.form {
        HighlightForm::Printed => {
            Shine::Formula(Box::new(move |surface, input, light| printed::light(surface, input, light, exponent)))
        }
        HighlightForm::Corrected | HighlightForm::Plain => Shine::Highlight(shininess(exponent).wires()),
    };
    Lighting { plan, lights: shown(lights, highlight.colour, p), shine }
}

/// The peaks of a material, or those of its bump map if they come from a map.
fn of_peaks(
    given: &Peaks,
    map: Option<Arc<PeakTexels>>,
    lights: &[Light],
    plan: SurfacePlan,
    p: &Precision,
) -> Lighting {
    let shine = match (&given.source, map) {
        (PeakSource::Given(given), _) => {
            let stored = given.iter().map(|peak| stored_peak(peak.normal, peak.amplitude, peak.exponent));
            Shine::Given(stored.map(packed).collect())
        }
        (PeakSource::Bump { .. }, Some(map)) => Shine::Map(map),
        (PeakSource::Bump { .. }, None) => Shine::Given(Vec::new()),
    };
    Lighting { plan, lights: shown(lights, given.colour, p), shine }
}

/// Replaces the effects by those of a different plan.
pub(super) fn with_plan(lighting: Lighting, plan: &ObjectPlan) -> Option<Lighting> {
    let surface =
        if matches!(lighting.shine, Shine::Highlight(_) | Shine::Formula(_)) { plan.highlight } else { plan.peaks };
    let shine = match lighting.shine {
        Shine::Map(map) if plan.horizon == HorizonKind::None => Shine::Map(Arc::new(map.without_horizons())),
        shine => shine,
    };
    Some(Lighting { plan: surface?, shine, ..lighting })
}

/// Address of the peaks' map, which objects may share, or of a lighting that has none.
pub(super) fn address(lighting: &Lighting) -> usize {
    match &lighting.shine {
        Shine::Map(map) => shared::address(&**map),
        _ => shared::address(lighting),
    }
}

/// Bytes of the stored peaks and of their horizons.
pub(super) fn bytes(lighting: &Lighting) -> [u64; 2] {
    match &lighting.shine {
        Shine::Highlight(_) | Shine::Formula(_) => [0; 2],
        Shine::Given(peaks) => [size_of::<StoredPeak>() as u64 * peaks.len() as u64, 0],
        Shine::Map(map) => {
            let peaks = map.count() as u64;
            let horizons = if map.has_horizons() { peaks } else { 0 };
            [peaks * size_of::<StoredPeak>() as u64, horizons * size_of::<StoredHorizon>() as u64]
        }
    }
}

/// The stored peaks of every texel of a pyramid, or only of its base if nothing is filtered. They have horizons if the material
/// has shadows.
pub(super) fn peak_texels(pyramid: &PeakPyramid, filters: bool, kind: HorizonKind) -> PeakTexels {
    const _: () = assert!(MAX_PEAKS <= MOST_PEAKS, "lanes read MOST_PEAKS at most");
    let kept = if filters { &pyramid.levels } else { &pyramid.levels[..1] };
    let stored = |peak: &pyramid::Peak| packed(stored_peak(peak.normal, peak.amplitude, peak.exponent));
    let horizon = |sides: [pyramid::Horizon; 4]| {
        let law = |side: pyramid::Horizon| match kind {
            HorizonKind::Product => uniform_law(side.mean, side.deviation),
            HorizonKind::None | HorizonKind::Correlated => [side.low, side.width],
        };
        let laws = sides.map(law);
        stored_horizon(laws.map(|law| law[0]), laws.map(|law| law[1])).wires()
    };
    let texels = kept.iter().flat_map(|level| level.texels().map(|texel| texel.len() as u32));
    let ends = texels.scan(0, |end, peaks| {
        *end += peaks;
        Some(*end)
    });
    let peaks = || kept.iter().flat_map(pyramid::PeakLevel::peaks);
    let horizons = peaks().filter_map(|peak| peak.horizon.filter(|_| kind != HorizonKind::None)).map(horizon);
    let map = WrappedMap::new(kept.iter().map(|level| (level.width, level.height)));
    PeakTexels::new(map, std::iter::once(0).chain(ends).collect(), peaks().map(stored), (horizons, kind))
}

fn packed(peak: StoredPeak) -> PackedPeak {
    PackedPeak::from(&peak.wires())
}

/// Lights multiplied by the colour of an object.
fn shown(lights: &[Light], colour: [f32; 3], p: &Precision) -> Vec<shader::Light> {
    let light = |light: &Light| {
        let direction = match light.place {
            LightPlace::Direction(direction) => Some(block_vector(direction, p)),
            LightPlace::Point(_) => None,
        };
        let colour = colour_word(core::array::from_fn(|i| light.colour[i] * colour[i]));
        shader::Light { direction, colour }
    };
    lights.iter().map(light).collect()
}
