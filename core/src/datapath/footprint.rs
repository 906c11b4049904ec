//! Footprints: the ellipse on a map and the probes that cover it.

use crate::block::{Block, Number};
use crate::bundle::bundle;
use crate::each::each;
use crate::fx::{Control, Int};
use crate::ports::{PortBlock, SHARE};
use crate::precision::Precision;
use crate::signals::{
    Axes, CubePoint, Ellipse, FacePosition, FaceProbe, MapScale, Probes, SphereProbe, Sweep, TexturePosition,
    TextureProbe,
};
use crate::stage::texture::TextureScale;
use crate::stage::{axes, cube_face, ellipse, enter, probes, sweep, texture};
use crate::staged::{Staged, control_stage, stage};

/// Ellipse of a pixel's two columns.
#[inline(always)]
pub(super) fn pixel_ellipse<W: Staged>(pixel: &[Block<W, 2>; 2], p: &Precision) -> Ellipse<W> {
    stage!("ellipse", ellipse::ellipse(ellipse::pixel_columns(pixel, p), p))
}

/// Axes of an ellipse.
#[inline(always)]
pub fn principal<W: Staged>(ellipse: &Ellipse<W>, p: &Precision) -> Axes<W> {
    stage!("axes", axes::axes(ellipse, p))
}

/// Probes that cover an ellipse on a map.
#[inline(always)]
pub(super) fn assemble<W: Staged>(ellipse: &Ellipse<W>, map: &MapScale<W>, p: &Precision) -> (Axes<W>, Probes<W>) {
    let axes = principal(ellipse, p);
    (axes, covering(&axes, map, p))
}

/// Probes that cover an ellipse on a map, from its axes.
#[inline(always)]
pub fn covering<W: Staged>(axes: &Axes<W>, map: &MapScale<W>, p: &Precision) -> Probes<W> {
    stage!("probes", probes::probes(axes, map, p))
}

/// Place of a point of the cube, which is that of an environment footprint's only probe.
#[inline(always)]
pub fn cube_place<W: Staged>(point: &CubePoint<W>) -> FacePosition<W> {
    stage!("place", cube_face::position(point))
}

/// Probe `index` of an environment footprint: on its face, or across the edge if it leaves the face.
#[inline(always)]
pub fn environment_probe<W: Staged>(
    point: &CubePoint<W>,
    probes: &Probes<W>,
    index: Int<W>,
    p: &Precision,
) -> FaceProbe<W> {
    let offset = stage!("probes.position", probes::position(probes, index));
    let place = stage!("continuation", cube_face::continuation(point, &offset, p));
    let weight = control_stage!("probes.weight", probes::weight(probes, index, p));
    FaceProbe { place, weight }
}

/// Probe `index` of a footprint on the sphere, on an environment with levels up to `last_level`.
#[inline(always)]
pub fn sphere_probe<W: Staged>(path: &Sweep<W>, index: Int<W>, last_level: Int<W>, p: &Precision) -> SphereProbe<W> {
    let r = stage!("sweep.direction", sweep::direction(path, index, p));
    let place = stage!("sweep.place", cube_face::position(&cube_face::cube_face(&r, p)));
    let lod = control_stage!("sweep.level", sweep::level(path, index, &r, last_level, p));
    let weight = control_stage!("sweep.weight", sweep::weight(path, index));
    SphereProbe { place, lod, weight }
}

/// Probe `index` of a footprint in a wrapped map.
#[inline(always)]
pub fn texture_probe<W: Staged>(
    centre: &TexturePosition<W>,
    probes: &Probes<W>,
    index: Int<W>,
    texture: &TextureScale<W>,
    p: &Precision,
) -> TextureProbe<W> {
    let offset = stage!("probes.position", probes::position(probes, index));
    let place = stage!("texture.position", texture::texture_position(centre, &offset, texture));
    let weight = control_stage!("probes.weight", probes::weight(probes, index, p));
    TextureProbe { place, weight }
}

bundle! {
    /// Footprint of a fragment in a wrapped map.
    pub struct TextureFootprint<W> {
        /// Columns of ∂x and ∂y in map units.
        columns: [Block<W, 2>; 2],
        /// K and det.
        ellipse: Ellipse<W>,
        /// λ₁, λ₂ and direction.
        axes: Axes<W>,
        /// N, step, level of detail.
        probes: Probes<W>,
    }
}

/// Footprint of a pixel in a colour or bump map: ellipse, axes and probes as for the environment, from other columns.
#[inline(always)]
pub fn texture_footprint<W: Staged>(
    derivatives: &[PortBlock<W, 2>; 2],
    texture: &TextureScale<W>,
    map: &MapScale<W>,
    p: &Precision,
) -> TextureFootprint<W> {
    let columns = each!(duv in *derivatives => {
        let duv = stage!("enter.duv", enter::enter(&duv, p));
        stage!("texture", texture::texture_column(&duv, texture, p))
    });
    let ellipse = pixel_ellipse(&columns, p);
    let (axes, probes) = assemble(&ellipse, map, p);
    TextureFootprint { columns, ellipse, axes, probes }
}

/// Part of a texel of level 0 that a probe of a footprint in a wrapped map spans across, at most 1, from λ₁ and λ₂. The ramps of rough bumps need it.
#[inline(always)]
pub fn probe_reach<W: Staged>(
    sigmas: [&Number<W>; 2],
    probes: &Probes<W>,
    texture: &TextureScale<W>,
    p: &Precision,
) -> Control<W, SHARE> {
    control_stage!("probes.reach", probes::reach(sigmas, probes, texture.log2_unit, p))
}
