//! Tangents of MikkTSpace, for which normal maps of meshes are baked (glTF 2.0, Blender).

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::DVec3;

use super::triangles::{Mesh, Vertex};

/// Directions that p_u and p_v of a mesh follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tangents {
    /// Directions of rising u and v: S97's own.
    #[default]
    Texture,
    /// Directions of MikkTSpace: p_u along its tangent t, p_v along b = ± n × t; both of length 1 and negated if the map is mirrored.
    MikkTSpace,
}

impl Mesh {
    /// Restores the right angle between n, p_u and p_v that MikkTSpace demands after a scale that differs from axis to axis.
    pub fn straighten_tangents(&mut self) {
        for vertex in &mut self.vertices {
            let [p_u, p_v] = vertex.tangents;
            let side = vertex.normal.cross(p_u);
            vertex.tangents[1] = if side.dot(p_v) < 0.0 { -side } else { side };
        }
    }
}

/// Square root and arc cosine that have the same bits on every machine.
struct Portable;

impl Ops for Portable {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        libm::acos(x.into()) as f32
    }
}

/// A mesh as MikkTSpace reads it, in f32 around its middle.
struct Triangles<'a> {
    mesh: &'a Mesh,
    middle: DVec3,
    /// t and the sign of b for each corner, three a triangle.
    spaces: Vec<Option<[f32; 4]>>,
}

impl Geometry<Portable> for Triangles<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        (self.vertex(face, corner).position - self.middle).as_vec3().to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.vertex(face, corner).normal.as_vec3().to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.vertex(face, corner).uv.as_vec2().to_array()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        self.spaces[3 * face + corner] = space.map(|space| space.tangent_encoded());
    }
}

impl Triangles<'_> {
    fn vertex(&self, face: usize, corner: usize) -> &Vertex {
        &self.mesh.vertices[self.mesh.triangles[face][corner] as usize]
    }
}

/// Replaces the tangents by MikkTSpace's. Splits a vertex whose corners have several. Keeps tangents where MikkTSpace has none.
pub(super) fn follow_mikktspace(mesh: &mut Mesh) {
    let bounds = mesh.vertices.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[least, largest], vertex| {
        [least.min(vertex.position), largest.max(vertex.position)]
    });
    let middle = (bounds[0] + bounds[1]) / 2.0;
    let mut triangles = Triangles { mesh, middle, spaces: vec![None; 3 * mesh.triangles.len()] };
    // No variant of the error exists.
    let Ok(()) = generate_tangents(&mut triangles) else { return };
    let spaces = triangles.spaces;
    let old_count = mesh.vertices.len();
    let mut first: Vec<Option<[u32; 4]>> = vec![None; old_count];
    let mut further: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    for (index, space) in mesh.triangles.iter_mut().flatten().zip(spaces) {
        let vertex = mesh.vertices[*index as usize];
        let Some([x, y, z, sign]) = space else { continue };
        let t = DVec3::new(x.into(), y.into(), z.into()).reject_from_normalized(vertex.normal);
        let Some(t) = t.try_normalize() else { continue };
        // S97's axes are n × p_v and p_u × n, so p_u = ±t and p_v = n × t put them along −t and −b.
        let tangents = [t * f64::from(sign), vertex.normal.cross(t)];
        let bits = [x, y, z, sign].map(f32::to_bits);
        if *first[*index as usize].get_or_insert(bits) == bits {
            mesh.vertices[*index as usize].tangents = tangents;
            continue;
        }
        *index = *further.entry((*index, bits)).or_insert_with(|| {
            mesh.vertices.push(Vertex { tangents, ..vertex });
            (mesh.vertices.len() - 1) as u32
        });
    }
}
