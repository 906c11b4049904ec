//! Materials: surface properties, and which of them the maps allow.

use glam::DVec3;

use super::lights::{self, Available};
use super::maps::Maps;
use crate::bump::FrameSystem;
use crate::description::MaterialDescription;
use crate::error::SceneError;
use crate::lighting::{MAX_PEAK_TEXELS, PeakSource, Peaks};
use crate::scene::Material;
use crate::shapes::{Placement, Shape};
use roughxel_utilities::limits::MAX_COORDINATE;

/// Properties of the scene that a material depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    pub(super) environment: bool,
    pub(super) lights: bool,
}

/// Base colour that shows as a grey of (1 − the largest reflectance): white under a reflectance of one number. White under coloured
/// metal would show the complement of the metal's colour.
fn neutral_under(reflectance: [f64; 3]) -> [f64; 3] {
    let matt = 1.0 - reflectance.into_iter().fold(0.0, f64::max);
    // A full mirror hides the base colour.
    reflectance.map(|share| if share < 1.0 { matt / (1.0 - share) } else { 1.0 })
}

/// The material of an object.
pub(super) fn material(
    maps: &mut Maps<'_>,
    material: &MaterialDescription,
    name: &str,
    shape: Option<Shape>,
    without_uv: Option<&str>,
    placement: &Placement,
    there: Surroundings,
) -> Result<Material, SceneError> {
    let source = maps.source;
    let named = [&material.colour_map, &material.height_map, &material.normal_map, &material.roughness_map];
    if let Some(map) = named.into_iter().flatten().next()
        && let Some(face) = without_uv
    {
        let message = format!("{face}: the face has no texture coordinates for a map");
        let help = "export the mesh with texture coordinates on every face (`vt` lines, `f 1/1 2/2 3/3`), or leave the map out";
        return Err(source.value_error(map.span(), message, help));
    }
    let reflectance = source.numbers("reflectance", &material.reflectance, [0.0; 3], 0.0..=1.0)?;
    let default = if material.colour_map.is_none() { neutral_under(reflectance) } else { [1.0; 3] };
    let colour = source.numbers("colour", &material.colour, default, 0.0..=1.0)?;
    if let Some(value) = &material.reflectance
        && reflectance != [0.0; 3]
        && !there.environment
    {
        let help = "add a table [environment], or leave `reflectance` out";
        return Err(source.value_error(value.span(), "there is no environment to reflect", help));
    }
    let frame = material.frame.unwrap_or(match shape {
        Some(_) => FrameSystem::MainDirection,
        // One direction cannot follow the charts of an arbitrary mesh.
        None => FrameSystem::NaturalNormalised,
    });
    let main_direction = match &material.main_direction {
        None => shape.map_or(DVec3::Y, Shape::main_direction),
        Some(direction) => {
            let coordinates = -MAX_COORDINATE..=MAX_COORDINATE;
            let vector = DVec3::from_array(source.all_in_range("main_direction", direction, coordinates)?);
            if vector.length() < 1e-6 {
                let help = "give the axis of the object, for example [0, 1, 0]";
                return Err(source.value_error(direction.span(), "`main_direction` has no length", help));
            }
            vector
        }
    };
    let colour_map = material.colour_map.as_ref().map(|table| maps.colour_map(table, name)).transpose()?;
    let shadowing = material.peaks.as_ref().is_some_and(|peaks| peaks.get_ref().needs_heights());
    let bump = maps.bump(material, name, frame, shadowing)?;
    let roughness = maps.roughness(material, name, frame, bump.as_deref())?;
    let heights = material.height_map.is_some();
    let there = Available { lights: there.lights, heights, bumps: heights || material.normal_map.is_some() };
    let highlight = material.highlight.as_ref().map(|highlight| lights::highlight(source, highlight, there));
    let peaks = material.peaks.as_ref().map(|peaks| lights::peaks(source, peaks, there));
    if let (Some(_), Some(peaks)) = (&material.highlight, &material.peaks) {
        let help = "give the highlight as a further peak: normal = [0, 0, 1] and its exponent";
        return Err(source.value_error(peaks.span(), "a material has one of `highlight` and `peaks`", help));
    }
    let (highlight, peaks) = (highlight.transpose()?, peaks.transpose()?);
    if let (Some(field), Some(Peaks { source: PeakSource::Bump { .. }, .. })) = (&bump, &peaks)
        && field.offsets.len() as u64 > MAX_PEAK_TEXELS
        && let Some(map) = material.height_map.as_ref().or(material.normal_map.as_ref())
    {
        let message = format!("{}×{} texels are too many to fit peaks to", field.width, field.height);
        let help = format!("make the map smaller, at most {MAX_PEAK_TEXELS} texels (1024×1024), or leave `peaks` out");
        return Err(source.value_error(map.span(), message, help));
    }
    Ok(Material {
        colour: colour.map(|channel| channel as f32),
        colour_map,
        bump,
        roughness,
        frame,
        main_direction: placement.direction(main_direction),
        reflectance: reflectance.map(|channel| channel as f32),
        deviation: material.bump_deviation.unwrap_or_default(),
        footprint: material.footprint,
        two_lobes: material.two_lobes,
        highlight,
        peaks,
    })
}
