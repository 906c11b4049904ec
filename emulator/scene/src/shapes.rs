//! Built-in shapes: exact normals and tangents at the vertices, counter-clockwise triangles seen from the normal.
//!
//! | shape | p(u, v) | n | default main direction |
//! |---|---|---|---|
//! | plane | (a(u − ½), 0, −b(v − ½)) | +y | −z |
//! | sphere | r(−sin λ cos φ, sin φ, −cos λ cos φ) | outwards | +y |
//! | cylinder | (−r sin λ, h(v − ½), −r cos λ) | outwards | +y |
//! | paraboloid | (x, y, (x² + y²)/4f), x = r(2u − 1), y = r(2v − 1) | towards the focus (0, 0, f) | +y |
//! | drapery | (a(u − ½), b(v − ½), z(u, v)), [`fold`] | towards +z | +y |
//!
//! λ = 2πu (cylinder: π + arc·(u − ½)), φ = π(v − ½): the middle of a map (u = ½) faces +z. With the default main
//! direction h, e₁ = h×n/|h×n| runs along p_u (S97 §7, system 3).

use glam::{DMat3, DVec2, DVec3};

use super::generate::maths::{cos_turns, sin_turns};
use roughxel_assets::{Mesh, Vertex};

/// Most segments along one direction.
pub(super) const MAX_SEGMENTS: u32 = 1024;

/// Shape with its dimensions in object units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// Rectangle of `size` along x and z.
    Plane { size: [f64; 2] },
    /// Sphere around the origin.
    Sphere { radius: f64 },
    /// Open cylinder around the y axis, centred at the origin, or the part of it within half the arc of +z.
    Cylinder { radius: f64, height: f64, arc_degrees: f64 },
    /// Concave parabolic mirror z = r²/4f with a round rim, open towards +z.
    Paraboloid { radius: f64, focal_length: f64 },
    /// Hanging cloth of width and height `size`; its folds deepen to `depth` at the hem (F92 Fig. 8).
    Drapery { size: [f64; 2], depth: f64, folds: f64 },
}

impl Shape {
    /// Triangles of the shape, with `segments` along u and v (around and from pole to pole, around and outwards).
    pub(super) fn mesh(self, segments: [u32; 2]) -> Mesh {
        match self {
            Self::Plane { .. } | Self::Cylinder { .. } | Self::Drapery { .. } => self.grid(segments),
            Self::Sphere { radius } => sphere(radius, segments),
            Self::Paraboloid { radius, focal_length } => paraboloid(radius, focal_length, segments),
        }
    }

    /// Fewest segments along u and v that still make the shape.
    pub(super) fn fewest_segments(self) -> [u32; 2] {
        match self {
            Self::Plane { .. } | Self::Drapery { .. } => [1, 1],
            Self::Sphere { .. } => [3, 2],
            Self::Cylinder { .. } | Self::Paraboloid { .. } => [3, 1],
        }
    }

    /// Segments if the scene gives none: a silhouette within a pixel of round at 640×480; F92's grid of 11×40.
    pub(super) fn default_segments(self) -> [u32; 2] {
        match self {
            Self::Plane { .. } => [1, 1],
            Self::Sphere { .. } => [128, 64],
            Self::Cylinder { .. } => [128, 1],
            Self::Paraboloid { .. } => [128, 32],
            Self::Drapery { .. } => [40, 11],
        }
    }

    /// Main direction along p_v, so that e₁ runs along p_u.
    pub(super) fn main_direction(self) -> DVec3 {
        match self {
            Self::Plane { .. } => DVec3::NEG_Z,
            Self::Sphere { .. } | Self::Cylinder { .. } | Self::Paraboloid { .. } | Self::Drapery { .. } => DVec3::Y,
        }
    }

    fn vertex(self, u: f64, v: f64) -> Vertex {
        let (position, p_u, p_v) = match self {
            Self::Plane { size: [a, b] } => {
                (DVec3::new(a * (u - 0.5), 0.0, -b * (v - 0.5)), DVec3::new(a, 0.0, 0.0), DVec3::new(0.0, 0.0, -b))
            }
            Self::Cylinder { radius, height, arc_degrees } => {
                let arc_turns = arc_degrees / 360.0;
                let turns = 0.5 + arc_turns * (u - 0.5);
                let (sin, cos) = (sin_turns(turns), cos_turns(turns));
                (
                    DVec3::new(-radius * sin, height * (v - 0.5), -radius * cos),
                    DVec3::new(-cos, 0.0, sin) * (std::f64::consts::TAU * arc_turns * radius),
                    DVec3::new(0.0, height, 0.0),
                )
            }
            Self::Sphere { radius } => {
                let (sin, cos) = (sin_turns(u), cos_turns(u));
                let latitude = (v - 0.5) / 2.0;
                let (sin_lat, cos_lat) = (sin_turns(latitude), cos_turns(latitude));
                (
                    DVec3::new(-sin * cos_lat, sin_lat, -cos * cos_lat) * radius,
                    DVec3::new(-cos, 0.0, sin) * (std::f64::consts::TAU * radius * cos_lat),
                    DVec3::new(sin * sin_lat, cos_lat, cos * sin_lat) * (std::f64::consts::PI * radius),
                )
            }
            Self::Paraboloid { radius, focal_length } => {
                let (x, y) = (radius * (2.0 * u - 1.0), radius * (2.0 * v - 1.0));
                (
                    DVec3::new(x, y, (x * x + y * y) / (4.0 * focal_length)),
                    DVec3::new(1.0, 0.0, x / (2.0 * focal_length)) * (2.0 * radius),
                    DVec3::new(0.0, 1.0, y / (2.0 * focal_length)) * (2.0 * radius),
                )
            }
            Self::Drapery { size: [a, b], depth, folds } => {
                let [z, z_u, z_v] = fold(u, v, folds).map(|of_depth| depth * of_depth);
                (DVec3::new(a * (u - 0.5), b * (v - 0.5), z), DVec3::new(a, 0.0, z_u), DVec3::new(0.0, b, z_v))
            }
        };
        let normal = match self {
            Self::Sphere { .. } => position.normalize(),
            _ => p_u.cross(p_v).normalize(),
        };
        Vertex { position, normal, uv: DVec2::new(u, v), tangents: [p_u, p_v] }
    }

    /// A regular grid over the unit square of (u, v).
    fn grid(self, [columns, rows]: [u32; 2]) -> Mesh {
        let mut mesh = Mesh::default();
        for row in 0..=rows {
            for column in 0..=columns {
                let uv = [f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows)];
                mesh.vertices.push(self.vertex(uv[0], uv[1]));
            }
        }
        join_rings(&mut mesh, 0, columns, rows);
        mesh
    }
}

/// z, ∂z/∂u and ∂z/∂v of a cloth of depth 1: pleats at the top that open towards the hem.
///
/// z = ½(0.3 + 0.7 t(2 − t))(sin φ + ¼ cos 2φ) with t = 1 − v and φ in turns = folds·u + 0.2 t sin 2π(u + 0.1). Narrow
/// valleys lie between wide ridges, which wander to the sides as they fall.
fn fold(u: f64, v: f64, folds: f64) -> [f64; 3] {
    const TAU: f64 = std::f64::consts::TAU;
    let t = 1.0 - v;
    let opening = 0.15 + 0.35 * t * (2.0 - t);
    let opening_v = -0.7 * (1.0 - t);
    let phase = folds * u + 0.2 * t * sin_turns(u + 0.1);
    let phase_u = folds + 0.2 * t * TAU * cos_turns(u + 0.1);
    let phase_v = -0.2 * sin_turns(u + 0.1);
    let wave = sin_turns(phase) + 0.25 * cos_turns(2.0 * phase);
    let wave_phase = TAU * (cos_turns(phase) - 0.5 * sin_turns(2.0 * phase));
    [opening * wave, opening * wave_phase * phase_u, opening_v * wave + opening * wave_phase * phase_v]
}

/// Two triangles for each cell of `rows` bands between rings of `columns` + 1 vertices, the first at index `first`.
fn join_rings(mesh: &mut Mesh, first: u32, columns: u32, rows: u32) {
    let ring = columns + 1;
    for row in 0..rows {
        for column in 0..columns {
            let a = first + row * ring + column;
            let (b, c, d) = (a + 1, a + ring + 1, a + ring);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
}

/// Longitude and latitude grid. Each triangle at a pole has its own pole vertex with the mean longitude. The p_u of
/// that vertex has half the length of the next ring's, so that p_u × p_v does not vanish.
fn sphere(radius: f64, [around, along]: [u32; 2]) -> Mesh {
    let shape = Shape::Sphere { radius };
    let mut mesh = Mesh::default();
    for ring in 1..along {
        for column in 0..=around {
            let uv = [f64::from(column) / f64::from(around), f64::from(ring) / f64::from(along)];
            mesh.vertices.push(shape.vertex(uv[0], uv[1]));
        }
    }
    join_rings(&mut mesh, 0, around, along - 2);
    let last_ring = (along - 2) * (around + 1);
    let ring_v = 1.0 / f64::from(along);
    for (pole_v, neighbour_v, ring) in [(0.0, ring_v, 0), (1.0, 1.0 - ring_v, last_ring)] {
        for column in 0..around {
            let u = (f64::from(column) + 0.5) / f64::from(around);
            let mut pole = shape.vertex(u, pole_v);
            pole.position = DVec3::new(0.0, radius * (2.0 * pole_v - 1.0), 0.0);
            pole.normal = DVec3::new(0.0, 2.0 * pole_v - 1.0, 0.0);
            pole.tangents[0] = shape.vertex(u, neighbour_v).tangents[0] * 0.5;
            let index = mesh.vertices.len() as u32;
            mesh.vertices.push(pole);
            let (west, east) = (ring + column, ring + column + 1);
            mesh.triangles.push(if pole_v == 0.0 { [index, east, west] } else { [index, west, east] });
        }
    }
    mesh
}

/// Rings around the vertex of the mirror; the texture coordinates are those of the square around the rim.
fn paraboloid(radius: f64, focal_length: f64, [around, rings]: [u32; 2]) -> Mesh {
    let shape = Shape::Paraboloid { radius, focal_length };
    let mut mesh = Mesh { vertices: vec![shape.vertex(0.5, 0.5)], triangles: Vec::new() };
    for ring in 1..=rings {
        let reach = 0.5 * f64::from(ring) / f64::from(rings);
        for column in 0..around {
            let turns = f64::from(column) / f64::from(around);
            mesh.vertices.push(shape.vertex(0.5 + reach * cos_turns(turns), 0.5 + reach * sin_turns(turns)));
        }
    }
    for column in 0..around {
        let next = (column + 1) % around;
        mesh.triangles.push([0, 1 + column, 1 + next]);
        for ring in 0..rings - 1 {
            let inner = 1 + ring * around;
            let outer = inner + around;
            mesh.triangles
                .extend([[inner + column, outer + column, outer + next], [inner + column, outer + next, inner + next]]);
        }
    }
    mesh
}

/// Transform from object to world: scale, then rotation about x, y and z in this order, then translation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    linear: DMat3,
    normal: DMat3,
    translate: DVec3,
}

impl Placement {
    /// A transform; `scale` is positive in each axis.
    pub(super) fn new(translate: DVec3, rotate_degrees: [f64; 3], scale: [f64; 3]) -> Self {
        let [x, y, z] = rotate_degrees.map(|degrees| (sin_turns(degrees / 360.0), cos_turns(degrees / 360.0)));
        let about_x = DMat3::from_cols_array_2d(&[[1.0, 0.0, 0.0], [0.0, x.1, x.0], [0.0, -x.0, x.1]]);
        let about_y = DMat3::from_cols_array_2d(&[[y.1, 0.0, -y.0], [0.0, 1.0, 0.0], [y.0, 0.0, y.1]]);
        let about_z = DMat3::from_cols_array_2d(&[[z.1, z.0, 0.0], [-z.0, z.1, 0.0], [0.0, 0.0, 1.0]]);
        let rotation = about_z * about_y * about_x;
        let scale = DVec3::from_array(scale);
        Self {
            linear: rotation * DMat3::from_diagonal(scale),
            normal: rotation * DMat3::from_diagonal(scale.recip()),
            translate,
        }
    }

    /// Moves a mesh to the world and wraps its maps `uv_repeat` times; tangents become those of the wrapped map.
    pub(super) fn apply(&self, mesh: &mut Mesh, uv_repeat: [f64; 2]) {
        for vertex in &mut mesh.vertices {
            vertex.position = self.linear * vertex.position + self.translate;
            vertex.normal = (self.normal * vertex.normal).normalize();
            vertex.uv *= DVec2::from_array(uv_repeat);
            for (tangent, repeat) in vertex.tangents.iter_mut().zip(uv_repeat) {
                *tangent = self.linear * *tangent / repeat;
            }
        }
    }

    /// World direction of an object's direction, unit length.
    pub(super) fn direction(&self, direction: DVec3) -> DVec3 {
        (self.linear * direction).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [Shape; 6] = [
        Shape::Plane { size: [3.0, 2.0] },
        Shape::Sphere { radius: 1.5 },
        Shape::Cylinder { radius: 0.5, height: 2.0, arc_degrees: 360.0 },
        Shape::Cylinder { radius: 2.0, height: 1.0, arc_degrees: 70.0 },
        Shape::Paraboloid { radius: 1.0, focal_length: 0.7 },
        Shape::Drapery { size: [2.0, 1.5], depth: 0.2, folds: 3.0 },
    ];

    #[test]
    fn tangents_are_the_derivatives_and_normals_their_cross_product() {
        let step = 1e-6;
        for shape in SHAPES {
            for (u, v) in [(0.1, 0.2), (0.35, 0.6), (0.8, 0.45)] {
                let vertex = shape.vertex(u, v);
                let along_u = (shape.vertex(u + step, v).position - shape.vertex(u - step, v).position) / (2.0 * step);
                let along_v = (shape.vertex(u, v + step).position - shape.vertex(u, v - step).position) / (2.0 * step);
                // Central differences: step² times the third derivative (≤ (2π)³·1.5) plus 1e-13/step of rounding.
                assert!((along_u - vertex.tangents[0]).length() < 1e-6, "{shape:?}");
                assert!((along_v - vertex.tangents[1]).length() < 1e-6, "{shape:?}");
                let normal = vertex.tangents[0].cross(vertex.tangents[1]).normalize();
                assert!((normal - vertex.normal).length() < 1e-9, "{shape:?}: rounding only");
            }
        }
    }

    #[test]
    fn the_default_main_direction_turns_e1_along_u() {
        for shape in SHAPES {
            for vertex in shape.mesh(shape.default_segments()).vertices {
                let e1 = shape.main_direction().cross(vertex.normal);
                // At the poles h × n vanishes; elsewhere only rounding separates the two directions.
                if e1.length() > 1e-9 {
                    assert!((e1.normalize() - vertex.tangents[0].normalize()).length() < 1e-9, "{shape:?}");
                }
            }
        }
    }

    #[test]
    fn triangles_turn_counter_clockwise_seen_from_the_normal_and_have_an_area() {
        for shape in SHAPES {
            for segments in [shape.fewest_segments(), [7, 5]] {
                let mesh = shape.mesh(segments);
                for triangle in &mesh.triangles {
                    let [a, b, c] = triangle.map(|index| mesh.vertices[index as usize]);
                    let area = (b.position - a.position).cross(c.position - a.position);
                    assert!(area.dot(a.normal + b.normal + c.normal) > 1e-3, "{shape:?} {triangle:?}");
                }
            }
        }
    }

    #[test]
    fn a_sphere_is_closed_and_its_pole_vertices_carry_the_mean_longitude() {
        let mesh = Shape::Sphere { radius: 1.0 }.mesh([8, 4]);
        assert_eq!(mesh.triangles.len(), 8 * 4 * 2 - 2 * 8);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|index| mesh.vertices[index as usize]);
            let longitudes = corners.map(|corner| corner.uv.x);
            let widest = longitudes.iter().fold(0.0f64, |most, u| most.max((u - longitudes[0]).abs()));
            assert!(widest <= 0.125, "no triangle crosses the seam");
            for corner in corners.iter().filter(|corner| corner.position.y.abs() == 1.0) {
                let others: f64 = longitudes.iter().sum::<f64>() - corner.uv.x;
                assert_eq!(corner.uv.x, others / 2.0);
                assert!(corner.tangents[0].length() > 0.1);
                assert_eq!(corner.tangents[0].dot(corner.normal), 0.0);
            }
        }
    }

    #[test]
    fn an_arc_of_a_cylinder_is_that_part_of_the_tube_around_z() {
        let tube = Shape::Cylinder { radius: 2.0, height: 1.0, arc_degrees: 360.0 };
        let arc = Shape::Cylinder { radius: 2.0, height: 1.0, arc_degrees: 90.0 };
        for step in 0..=8 {
            let u = f64::from(step) / 8.0;
            let (of_arc, of_tube) = (arc.vertex(u, 0.25), tube.vertex(0.375 + 0.25 * u, 0.25));
            // Rounding of the angle.
            assert!((of_arc.position - of_tube.position).length() < 1e-12);
            assert!((of_arc.tangents[0] * 4.0 - of_tube.tangents[0]).length() < 1e-12);
        }
        assert_eq!(arc.vertex(0.5, 0.5).position, DVec3::new(0.0, 0.0, 2.0));
    }

    #[test]
    fn a_drapery_has_its_depth_at_the_hem_and_hangs_nearly_flat_above() {
        let shape = Shape::Drapery { size: [4.0, 3.0], depth: 0.5, folds: 5.0 };
        let reach = |v: f64| {
            let depths: Vec<f64> =
                (0..=1000).map(|step| shape.vertex(f64::from(step) / 1000.0, v).position.z).collect();
            depths.iter().fold(f64::NEG_INFINITY, |most, z| most.max(*z))
                - depths.iter().fold(f64::INFINITY, |least, z| least.min(*z))
        };
        // 1000 steps over five folds miss an extremum by at most (2π·5/1000)²/8·2 of the depth: 0.03 %.
        assert!((reach(0.0) - 0.5).abs() < 2e-4, "{}", reach(0.0));
        assert!((reach(1.0) - 0.15).abs() < 2e-4, "{}", reach(1.0));
    }

    #[test]
    fn the_paraboloid_reflects_rays_along_its_axis_into_the_focus() {
        let focal_length = 0.7;
        let shape = Shape::Paraboloid { radius: 1.0, focal_length };
        for vertex in shape.mesh([16, 4]).vertices {
            let to_eye = DVec3::Z;
            let reflected = 2.0 * vertex.normal * vertex.normal.dot(to_eye) - to_eye;
            let to_focus = DVec3::new(0.0, 0.0, focal_length) - vertex.position;
            assert!((reflected - to_focus.normalize()).length() < 1e-12, "rounding only");
        }
    }

    #[test]
    fn a_placement_keeps_normals_perpendicular_and_e1_along_u() {
        let placement = Placement::new(DVec3::new(1.0, 2.0, 3.0), [30.0, -50.0, 70.0], [1.0, 3.0, 0.5]);
        for shape in SHAPES {
            let mut mesh = shape.mesh([12, 6]);
            placement.apply(&mut mesh, [4.0, 2.0]);
            let main_direction = placement.direction(shape.main_direction());
            for vertex in &mesh.vertices {
                for tangent in vertex.tangents {
                    assert!(vertex.normal.dot(tangent).abs() < 1e-12 * tangent.length().max(1.0));
                }
                let e1 = main_direction.cross(vertex.normal);
                if e1.length() > 1e-9 {
                    assert!((e1.normalize() - vertex.tangents[0].normalize()).length() < 1e-9, "{shape:?}");
                }
            }
        }
    }

    #[test]
    fn rotations_are_about_x_then_y_then_z() {
        let turned = |degrees| Placement::new(DVec3::ZERO, degrees, [1.0; 3]).direction(DVec3::Y);
        // 1e-12 bounds the error of the sine at a right angle.
        assert!((turned([90.0, 0.0, 0.0]) - DVec3::Z).length() < 1e-12);
        assert!((turned([90.0, 90.0, 0.0]) - DVec3::X).length() < 1e-12);
        assert!((turned([90.0, 90.0, 90.0]) - DVec3::Y).length() < 1e-12);
    }
}
