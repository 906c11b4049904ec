//! Meshes from polygons of any format.
//!
//! Polygons are cut into triangles. Missing normals are means over the faces of a smoothing group, weighted by their areas. p_u and p_v follow from the
//! texture coordinates, area-weighted per vertex. A vertex between a mirrored and an unmirrored chart is split in two.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::polygon::Cutter;
use super::tangents::{Tangents, follow_mikktspace};
use super::triangles::{Mesh, Vertex};

/// Area of a triangle over the square of its longest edge, below which it is dropped: rounding of the area itself.
const LEAST_RELATIVE_AREA: f64 = 1e-15;

/// Polygons as a file has them. Every index is in range; every number is finite.
#[derive(Debug, Default)]
pub(super) struct Polygons {
    pub(super) positions: Vec<DVec3>,
    /// u to the right, v up, in repeats of the map.
    pub(super) texcoords: Vec<DVec2>,
    /// Normals of any length. One of length 0 counts as none.
    pub(super) normals: Vec<DVec3>,
    /// Corners of all faces, one face after the other.
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    /// Largest error of a coordinate since the file was written, such as by decimal digits; 0 if its bits are read.
    pub(super) rounding: f64,
}

/// Indices of one corner of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) texcoord: Option<u32>,
    pub(super) normal: Option<u32>,
}

/// A polygon of at least three corners, which follow those of the face before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// End of its corners in [`Polygons::corners`].
    pub(super) end: usize,
    pub(super) smoothing: Smoothing,
}

/// Faces that share a mean normal with a face whose corners have none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Smoothing {
    /// All faces that say nothing about it.
    Whole,
    /// Faces of the same group.
    Group(u32),
    /// No other face.
    Flat,
}

/// A mesh and its repairs, one sentence each.
pub(super) struct Built {
    pub(super) mesh: Mesh,
    has_uv: bool,
    pub(super) warnings: Vec<String>,
}

/// The mesh of some polygons; `None` if nothing is left to draw.
pub(super) fn build(polygons: &Polygons, directions: Tangents) -> Option<Built> {
    let mut builder = Builder::new(polygons);
    let mut cutter = Cutter::new();
    let (mut first, mut positions, mut triangles) = (0, Vec::new(), Vec::new());
    for face in &polygons.faces {
        let corners = &polygons.corners[first..face.end];
        first = face.end;
        positions.clear();
        positions.extend(corners.iter().map(|corner| polygons.positions[corner.position as usize]));
        builder.crossed += usize::from(!cutter.cut(&positions, &mut triangles));
        builder.begin_face(face.smoothing, &positions);
        let kept = builder.mesh.triangles.len();
        for triangle in &triangles {
            builder.add(triangle.map(|index| corners[index as usize]));
        }
        if builder.mesh.triangles.len() > kept {
            builder.end_face(corners);
        }
    }
    let mut built = builder.finish()?;
    if directions == Tangents::MikkTSpace && built.has_uv {
        follow_mikktspace(&mut built.mesh);
    }
    Some(built)
}

/// Vertex of the result: a corner, true if the map is mirrored there, and its mean normal if it has none of its own.
type VertexKey = (Corner, bool, Option<u32>);

struct Builder<'a> {
    polygons: &'a Polygons,
    mesh: Mesh,
    known: HashMap<VertexKey, u32>,
    /// Sums of doubled areas: those of the positions for [`Smoothing::Whole`], then those of groups and flat faces.
    sums: Vec<DVec3>,
    /// Sums of positions in smoothing groups.
    grouped: HashMap<(u32, u32), u32>,
    smoothing: Smoothing,
    /// Doubled area of the current polygon, along its normal. Each of its corners counts it once, however the polygon is cut.
    face_area: DVec3,
    /// Sum of each vertex in `sums`.
    sum_of: Vec<u32>,
    /// Area of each vertex so far, the weight of its tangents.
    chart_area: Vec<f64>,
    has_uv: bool,
    dropped: usize,
    /// Number of polygons that cross themselves.
    crossed: usize,
}

impl<'a> Builder<'a> {
    fn new(polygons: &'a Polygons) -> Self {
        Self {
            polygons,
            mesh: Mesh::default(),
            known: HashMap::new(),
            sums: vec![DVec3::ZERO; polygons.positions.len()],
            grouped: HashMap::new(),
            smoothing: Smoothing::Whole,
            face_area: DVec3::ZERO,
            sum_of: Vec::new(),
            chart_area: Vec::new(),
            has_uv: polygons.corners.iter().any(|corner| corner.texcoord.is_some()),
            dropped: 0,
            crossed: 0,
        }
    }

    fn begin_face(&mut self, smoothing: Smoothing, positions: &[DVec3]) {
        self.smoothing = smoothing;
        let fan = positions.windows(2).skip(1).map(|pair| (pair[0] - positions[0]).cross(pair[1] - positions[0]));
        self.face_area = fan.reduce(|sum, area| sum + area).unwrap_or(DVec3::ZERO);
        if smoothing == Smoothing::Flat {
            self.sums.push(DVec3::ZERO);
        }
    }

    /// Adds the area of the polygon to the normals of its corners.
    fn end_face(&mut self, corners: &[Corner]) {
        for corner in corners {
            let sum = self.sum(corner.position);
            self.sums[sum as usize] += self.face_area;
        }
    }

    /// Index of the sum that a position has in the current face.
    fn sum(&mut self, position: u32) -> u32 {
        match self.smoothing {
            Smoothing::Whole => position,
            Smoothing::Flat => (self.sums.len() - 1) as u32,
            Smoothing::Group(group) => *self.grouped.entry((position, group)).or_insert_with(|| {
                self.sums.push(DVec3::ZERO);
                (self.sums.len() - 1) as u32
            }),
        }
    }

    /// Adds a triangle.
    fn add(&mut self, mut corners: [Corner; 3]) {
        let polygons = self.polygons;
        let positions = corners.map(|corner| polygons.positions[corner.position as usize]);
        let edges = [positions[1] - positions[0], positions[2] - positions[0]];
        let doubled_area = edges[0].cross(edges[1]);
        let longest = edges[0].length_squared().max(edges[1].length_squared());
        // An error of both ends of both edges changes twice the area by 4√3 times the error and the longer edge.
        let rounding = 8.0 * polygons.rounding * longest.sqrt();
        if doubled_area.length() <= rounding.max(LEAST_RELATIVE_AREA * longest) {
            self.dropped += 1;
            return;
        }
        let mut normals = [DVec3::ZERO; 3];
        for (corner, normal) in corners.iter_mut().zip(&mut normals) {
            *normal = corner.normal.map_or(DVec3::ZERO, |index| unit(polygons.normals[index as usize]));
            if *normal == DVec3::ZERO {
                corner.normal = None;
            }
        }
        let uv = |corner: Corner| corner.texcoord.map(|index| polygons.texcoords[index as usize]);
        let chart = match corners.map(uv) {
            [Some(a), Some(b), Some(c)] => tangents(edges, [b - a, c - a]),
            _ => None,
        };
        let outside = if normals.iter().copied().sum::<DVec3>().dot(doubled_area) < 0.0 { -1.0 } else { 1.0 };
        let mirrored = chart.is_some_and(|[p_u, p_v]| p_u.cross(p_v).dot(doubled_area * outside) < 0.0);
        let mut triangle = [0; 3];
        for (slot, corner) in corners.into_iter().enumerate() {
            let sum = self.sum(corner.position);
            let key = (corner, mirrored, corner.normal.is_none().then_some(sum));
            let index = *self.known.entry(key).or_insert_with(|| {
                self.sum_of.push(sum);
                self.chart_area.push(0.0);
                self.mesh.vertices.push(Vertex {
                    position: positions[slot],
                    normal: normals[slot],
                    uv: uv(corner).unwrap_or_default(),
                    tangents: [DVec3::ZERO; 2],
                });
                (self.mesh.vertices.len() - 1) as u32
            });
            triangle[slot] = index;
            if let Some(chart) = chart {
                let area = doubled_area.length();
                let signed_area = if mirrored { -area } else { area };
                self.chart_area[index as usize] += area;
                for (sum, tangent) in self.mesh.vertices[index as usize].tangents.iter_mut().zip(chart) {
                    *sum += signed_area * tangent;
                }
            }
        }
        self.mesh.triangles.push(triangle);
    }

    /// Divides the sums and lists the repairs; `None` if nothing is left to draw.
    fn finish(mut self) -> Option<Built> {
        if self.mesh.triangles.is_empty() {
            return None;
        }
        let mut own_face = vec![DVec3::ZERO; self.mesh.vertices.len()];
        for triangle in &self.mesh.triangles {
            let [a, b, c] = triangle.map(|index| self.mesh.vertices[index as usize].position);
            for &index in triangle {
                own_face[index as usize] = (b - a).cross(c - a);
            }
        }
        let mut without_chart = 0usize;
        for (index, vertex) in self.mesh.vertices.iter_mut().enumerate() {
            if vertex.normal == DVec3::ZERO {
                // Two faces back to back cancel; the last face of this vertex decides.
                let mean = self.sums[self.sum_of[index] as usize].normalize_or_zero();
                vertex.normal = if mean == DVec3::ZERO { own_face[index].normalize_or(DVec3::Y) } else { mean };
            }
            if self.chart_area[index] > 0.0 {
                vertex.tangents = vertex.tangents.map(|sum| sum / self.chart_area[index]);
            }
            if self.has_uv && vertex.tangents.contains(&DVec3::ZERO) {
                without_chart += 1;
                let p_u = vertex.normal.any_orthonormal_vector();
                vertex.tangents = [p_u, vertex.normal.cross(p_u)];
            }
        }
        let mut warnings = Vec::new();
        if self.dropped > 0 {
            warnings.push(format!("{} triangles without an area were dropped", self.dropped));
        }
        if self.crossed > 0 {
            warnings.push(format!(
                "{} faces cross themselves, or are concave with too many corners; they are cut into fans, which may reach outside",
                self.crossed
            ));
        }
        if without_chart > 0 {
            warnings.push(format!(
                "{without_chart} vertices have no direction in the map (their texture coordinates coincide); \
                 bumps run in any direction there"
            ));
        }
        Some(Built { mesh: self.mesh, has_uv: self.has_uv, warnings })
    }
}

/// A vector of length 1, or zero.
fn unit(vector: DVec3) -> DVec3 {
    let scale = vector.abs().max_element();
    if vector.length_squared().is_normal() || scale == 0.0 {
        vector.normalize_or_zero()
    } else {
        (vector / scale).normalize_or_zero()
    }
}

/// p_u and p_v of a triangle from two edges and their texture coordinates; `None` if the coordinates have no area.
fn tangents([e, f]: [DVec3; 2], [e_uv, f_uv]: [DVec2; 2]) -> Option<[DVec3; 2]> {
    let determinant = e_uv.perp_dot(f_uv);
    // The bound is relative to the lengths, so that tiny charts count; 1e-9 is the rounding of six decimal places, squared.
    if determinant.abs() <= 1e-9 * e_uv.length() * f_uv.length() {
        return None;
    }
    Some([(e * f_uv.y - f * e_uv.y) / determinant, (f * e_uv.x - e * f_uv.x) / determinant])
}
