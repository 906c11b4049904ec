//! Objects of a scene: shapes and meshes with their places.

use std::ops::Range;
use std::path::Path;

use glam::DVec3;
use toml::Spanned;

use super::maps::Maps;
use super::material::{Surroundings, material};
use crate::bump::FrameSystem;
use crate::description::{ObjectDescription, ShapeName, TangentsName};
use crate::error::SceneError;
use crate::generate::{mesh_names, mesh_text};
use crate::scene::Object;
use crate::shapes::{MAX_SEGMENTS, Placement, Shape};
use crate::source::{Exactly, Source};
use roughxel_assets::{MAX_TRIANGLES, Mesh, ReadMesh, ReadOptions, Tangents, Vertex, parse_obj, read_mesh};
use roughxel_utilities::limits::{LENGTHS, MAX_COORDINATE};

/// Largest offset of a mesh, units: there, coordinates are still exact to a millionth.
pub(super) const MAX_OFFSET: f64 = 1e9;

/// One object, its maps read.
pub(super) fn object(
    maps: &mut Maps<'_>,
    index: usize,
    object: &Spanned<ObjectDescription>,
    there: Surroundings,
) -> Result<Object, SceneError> {
    let span = object.span();
    let object = object.get_ref();
    let name = object.name.clone().unwrap_or_else(|| format!("object {}", index + 1));
    let (mut mesh, without_uv, shape) = triangles(maps, object, &name, span)?;
    let source = maps.source;
    let placement = placement(source, object)?;
    let uv_repeat = source.numbers("uv_repeat", &object.uv_repeat, [1.0; 2], 0.001..=4096.0)?;
    placement.apply(&mut mesh, uv_repeat);
    if matches!(object.shape.get_ref(), ShapeName::Mesh) && tangents(source, object)? == Tangents::MikkTSpace {
        mesh.straighten_tangents();
    }
    let beyond = |vertex: &Vertex| vertex.position.abs().max_element() > 2.0 * MAX_COORDINATE;
    if mesh.vertices.iter().any(beyond) {
        let help = "choose a smaller `scale`, or a smaller shape";
        return Err(source.value_error(object.shape.span(), "the object reaches too far out", help));
    }
    let material = material(maps, &object.material, &name, shape, without_uv.as_deref(), &placement, there)?;
    Ok(Object { name, mesh, material })
}

/// Triangles in object space, the place of a face without texture coordinates (file and line), and the built-in shape.
fn triangles(
    maps: &mut Maps<'_>,
    object: &ObjectDescription,
    name: &str,
    object_span: Range<usize>,
) -> Result<(Mesh, Option<String>, Option<Shape>), SceneError> {
    let source = maps.source;
    let shape_name = *object.shape.get_ref();
    let measures = [
        ("size", object.size.as_ref().map(Spanned::span)),
        ("radius", object.radius.as_ref().map(Spanned::span)),
        ("height", object.height.as_ref().map(Spanned::span)),
        ("arc_degrees", object.arc_degrees.as_ref().map(Spanned::span)),
        ("focal_length", object.focal_length.as_ref().map(Spanned::span)),
        ("depth", object.depth.as_ref().map(Spanned::span)),
        ("folds", object.folds.as_ref().map(Spanned::span)),
        ("segments", object.segments.as_ref().map(Spanned::span)),
        ("path", object.path.as_ref().map(Spanned::span)),
        ("generate", object.generate.as_ref().map(Spanned::span)),
        ("offset", object.offset.as_ref().map(Spanned::span)),
        ("tangents", object.tangents.as_ref().map(Spanned::span)),
    ];
    let known: &[&str] = match shape_name {
        ShapeName::Plane => &["size", "segments"],
        ShapeName::Sphere => &["radius", "segments"],
        ShapeName::Cylinder => &["radius", "height", "arc_degrees", "segments"],
        ShapeName::Paraboloid => &["radius", "focal_length", "segments"],
        ShapeName::Drapery => &["size", "depth", "folds", "segments"],
        ShapeName::Mesh => &["path", "generate", "offset", "tangents"],
    };
    for (key, span) in measures {
        if let Some(span) = span
            && !known.contains(&key)
        {
            let help = format!("this shape takes: {}", known.join(", "));
            return Err(source.value_error(span, format!("`{key}` does not belong to this shape"), help));
        }
    }
    let length = |key, value, default| source.number(key, value, default, LENGTHS);
    let radius = length("radius", &object.radius, 1.0)?;
    let size = source.numbers("size", &object.size, [1.0; 2], LENGTHS)?;
    let shape = match shape_name {
        ShapeName::Plane => Shape::Plane { size },
        ShapeName::Sphere => Shape::Sphere { radius },
        ShapeName::Cylinder => Shape::Cylinder {
            radius,
            height: length("height", &object.height, 1.0)?,
            arc_degrees: source.number("arc_degrees", &object.arc_degrees, 360.0, 1.0..=360.0)?,
        },
        ShapeName::Paraboloid => {
            Shape::Paraboloid { radius, focal_length: length("focal_length", &object.focal_length, 1.0)? }
        }
        ShapeName::Drapery => Shape::Drapery {
            size,
            depth: length("depth", &object.depth, 0.1)?,
            folds: source.number("folds", &object.folds, 5.0, 0.25..=64.0)?,
        },
        ShapeName::Mesh => {
            let ReadMesh { mesh, without_uv, warnings } = mesh(maps, object, object_span)?;
            maps.warnings.extend(warnings.into_iter().map(|warning| format!("{name}: {warning}")));
            return Ok((mesh, without_uv, None));
        }
    };
    let segments = match &object.segments {
        None => shape.default_segments(),
        Some(segments) => {
            let fewest = shape.fewest_segments();
            let Exactly([u, v]) = *segments.get_ref();
            let whole =
                |count, fewest| source.whole_in_range("segments", count, segments.span(), fewest..=MAX_SEGMENTS);
            [whole(u, fewest[0])?, whole(v, fewest[1])?]
        }
    };
    debug_assert!(2 * MAX_SEGMENTS as usize * MAX_SEGMENTS as usize <= MAX_TRIANGLES);
    Ok((shape.mesh(segments), None, Some(shape)))
}

/// The triangles of a mesh, from a file or generated.
fn mesh(maps: &Maps<'_>, object: &ObjectDescription, object_span: Range<usize>) -> Result<ReadMesh, SceneError> {
    let source = maps.source;
    let offset = source.numbers("offset", &object.offset, [0.0; 3], -MAX_OFFSET..=MAX_OFFSET)?;
    let options = ReadOptions { offset: DVec3::from_array(offset), tangents: tangents(source, object)? };
    let (read, span) = match (&object.path, &object.generate) {
        (Some(path), None) => (read_mesh(&maps.resolve(path.get_ref()), &options), path.span()),
        (None, Some(name)) => {
            let text = mesh_text(name.get_ref()).ok_or_else(|| {
                let message = format!("there is no generated mesh `{}`", name.get_ref());
                source.value_error(name.span(), message, format!("the generated ones are: {}", mesh_names()))
            })?;
            (parse_obj(Path::new(name.get_ref()), &text, &options), name.span())
        }
        _ => {
            let help = "give exactly one of `path` (an OBJ file, relative to the scene file) and `generate`";
            return Err(source.value_error(object_span, "a mesh needs a file", help));
        }
    };
    read.map_err(|error| source.value_error(span, format!("{}: {}", error.place, error.message), error.remedy))
}

/// Directions that the tangents of a mesh follow. A normal map from a file was baked, by default for MikkTSpace.
fn tangents(source: &Source, object: &ObjectDescription) -> Result<Tangents, SceneError> {
    let is_baked = object.material.normal_map.as_ref().is_some_and(|table| table.get_ref().has("path"));
    let is_system_2 = matches!(object.material.frame, None | Some(FrameSystem::NaturalNormalised));
    match &object.tangents {
        None if is_baked && is_system_2 => Ok(Tangents::MikkTSpace),
        None => Ok(Tangents::Texture),
        Some(_) if !is_system_2 => {
            let span = object.tangents.as_ref().map(Spanned::span).unwrap_or_default();
            let help = "leave `tangents` or `frame` out";
            Err(source.value_error(span, "only the frame \"natural-normalised\" takes `tangents`", help))
        }
        Some(name) => Ok(match name.get_ref() {
            TangentsName::Texture => Tangents::Texture,
            TangentsName::Mikktspace => Tangents::MikkTSpace,
        }),
    }
}

/// Placement of an object.
fn placement(source: &Source, object: &ObjectDescription) -> Result<Placement, SceneError> {
    let triple = |key, value, bound: f64| source.numbers::<3>(key, value, [0.0; 3], -bound..=bound);
    let translate = triple("translate", &object.translate, MAX_COORDINATE)?;
    let rotate_degrees = triple("rotate_degrees", &object.rotate_degrees, 3600.0)?;
    let scale = source.numbers("scale", &object.scale, [1.0; 3], 1e-4..=1e4)?;
    Ok(Placement::new(DVec3::from_array(translate), rotate_degrees, scale))
}
