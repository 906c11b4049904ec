//! glTF 2.0 models: triangles of the default scene in world space, with their materials and images.
//!
//! Nodes are placed, texture coordinates get v upwards (glTF has it downwards), and images stay as bytes. What a model says and
//! nobody here can draw is listed in [`Model::ignored`].

mod buffers;
mod materials;
mod vectors;

use std::collections::BTreeSet;
use std::path::Path;

use glam::{DMat3, DMat4, DVec2, DVec3};
use gltf::mesh::Mode;

use self::buffers::Buffers;
use self::vectors::vectors;
use crate::mesh::error::MeshError;
use crate::mesh::kind::is_gltf;
use crate::mesh::triangles::MAX_TRIANGLES;

pub use self::materials::{Image, ModelMaterial, NormalTexture};

/// Extensions that a model may require: each is read, or changes nothing that is drawn here.
const KNOWN_EXTENSIONS: [&str; 5] = [
    "KHR_texture_transform",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
];

/// Deepest chain of nodes.
const MAX_DEPTH: usize = 256;

/// Most nodes of a scene. A node that has several parents counts for each.
const MAX_NODES: usize = 1 << 20;

/// A model: the default scene of a glTF file.
#[derive(Debug, Default)]
pub struct Model {
    /// Triangles, one part for each primitive of each node.
    pub parts: Vec<Part>,
    /// Materials in the order of the file.
    pub materials: Vec<ModelMaterial>,
    /// Images in the order of the file.
    pub images: Vec<Image>,
    /// The first camera of the scene.
    pub camera: Option<ModelCamera>,
    /// Contents that are not drawn, one sentence each.
    pub ignored: Vec<String>,
}

/// Triangles with one material, world space.
#[derive(Debug, Default)]
pub struct Part {
    /// Name of the node or the mesh, or `part N`.
    pub name: String,
    /// Positions.
    pub positions: Vec<DVec3>,
    /// Unit normals, one a position, or none.
    pub normals: Vec<DVec3>,
    /// Texture coordinates, one a position, or none: u to the right, v up.
    pub texcoords: Vec<DVec2>,
    /// Indices of positions.
    pub triangles: Vec<[u32; 3]>,
    /// Index of the material; `None` is glTF's default material.
    pub material: Option<usize>,
}

/// A perspective camera.
#[derive(Clone, Copy, Debug)]
pub struct ModelCamera {
    /// Position.
    pub eye: DVec3,
    /// Unit direction of the line of sight.
    pub forward: DVec3,
    /// Unit direction upwards in the picture.
    pub up: DVec3,
    /// Full vertical angle of view in degrees.
    pub fov_y_degrees: f64,
    /// Distance of the near plane.
    pub near: f64,
}

/// Reads a glTF file, binary (`.glb`) or text (`.gltf`), with the files that it names.
///
/// # Errors
/// A file that cannot be read, is damaged, requires an unknown extension, names a missing buffer, or has more than
/// [`MAX_TRIANGLES`] triangles or none.
pub fn read_model(path: &Path) -> Result<Model, MeshError> {
    let bytes = buffers::read_file(path).map_err(|mistake| error(path, &mistake))?;
    parse_model(path, &bytes)
}

/// The error of a mistake, whose remedy follows the last semicolon.
fn error(path: &Path, mistake: &str) -> MeshError {
    let (message, remedy) = mistake.rsplit_once("; ").unwrap_or((mistake, "export the model again as glTF 2.0"));
    MeshError::new(path, message, remedy)
}

/// Reads a model from the bytes of its file, as [`read_model`] does.
pub(crate) fn parse_model(path: &Path, bytes: &[u8]) -> Result<Model, MeshError> {
    let fail = |mistake: String| error(path, &mistake);
    let file = parse(bytes).map_err(fail)?;
    let buffers = Buffers::read(path, &file).map_err(fail)?;
    let mut reader =
        Reader { buffers: &buffers, model: Model::default(), nodes: 0, triangles: 0, ignored: BTreeSet::new() };
    let scene = file.default_scene().or_else(|| file.scenes().next());
    let scene = scene.ok_or_else(|| fail("has no scene; export the model with its nodes".to_owned()))?;
    for node in scene.nodes() {
        reader.node(&node, DMat4::IDENTITY, 0).map_err(fail)?;
    }
    if reader.triangles == 0 {
        return Err(fail("has no triangles; export the model with its meshes".to_owned()));
    }
    reader.notes(&file);
    let Reader { mut model, mut ignored, .. } = reader;
    for material in file.materials() {
        model.materials.push(materials::material(&material, &mut ignored));
    }
    for image in file.images() {
        model.images.push(materials::image(&image, &buffers).map_err(fail)?);
    }
    model.ignored = ignored.into_iter().collect();
    Ok(model)
}

/// Parses and validates a file.
fn parse(bytes: &[u8]) -> Result<gltf::Gltf, String> {
    if !is_gltf(bytes) {
        return Err("is no glTF model; name it as a mesh in a scene, or export it as glTF 2.0".to_owned());
    }
    // The mark that the specification forbids is written all the same.
    let bytes = if bytes.starts_with(b"glTF") {
        bytes
    } else {
        bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start()
    };
    let kind = if bytes.starts_with(b"glTF") { "GLB" } else { "glTF" };
    let unreadable = |reason| format!("is not a readable {kind} file: {reason}; export it again as glTF 2.0");
    let mut file = gltf::Gltf::from_slice_without_validation(bytes).map_err(|reason| match version(bytes) {
        Some(other) if !other.starts_with('2') => {
            let remedy = "convert it to glTF 2.0, for example by gltf-pipeline";
            format!("is a model of glTF {other}, which is not read; {remedy}")
        }
        _ => unreadable(reason.to_string()),
    })?;
    // The validation takes the accessors of attributes for present.
    let mut root = file.document.into_json();
    let attributes =
        root.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|primitive| primitive.attributes.values());
    if let Some(index) = attributes.map(gltf::json::Index::value).find(|index| *index >= root.accessors.len()) {
        return Err(unreadable(format!("there is no accessor {index}")));
    }
    let unknown: Vec<&str> =
        root.extensions_required.iter().map(String::as_str).filter(|name| !KNOWN_EXTENSIONS.contains(name)).collect();
    if !unknown.is_empty() {
        let names = unknown.join(", ");
        return Err(format!("requires the extension {names}, which is not read; export the model without it"));
    }
    // The validation knows fewer.
    root.extensions_required.clear();
    file.document = gltf::Document::from_json(root).map_err(|reason| unreadable(reason.to_string()))?;
    Ok(file)
}

/// Version of glTF that a file says it has.
fn version(bytes: &[u8]) -> Option<String> {
    if let Some(number) = bytes.strip_prefix(b"glTF").and_then(|rest| rest.get(..4)) {
        let number = u32::from_le_bytes([number[0], number[1], number[2], number[3]]);
        return Some(format!("{number}.0"));
    }
    #[derive(serde::Deserialize)]
    struct Asset {
        version: String,
    }
    #[derive(serde::Deserialize)]
    struct Root {
        asset: Asset,
    }
    serde_json::from_slice::<Root>(bytes).ok().map(|root| root.asset.version)
}

/// Walks over the nodes of a scene.
struct Reader<'a> {
    buffers: &'a Buffers,
    model: Model,
    nodes: usize,
    triangles: usize,
    ignored: BTreeSet<String>,
}

impl Reader<'_> {
    fn node(&mut self, node: &gltf::Node<'_>, parent: DMat4, depth: usize) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err(format!("has nodes more than {MAX_DEPTH} deep; flatten the hierarchy"));
        }
        self.nodes += 1;
        if self.nodes > MAX_NODES {
            return Err(format!("has more than {MAX_NODES} nodes; flatten the hierarchy"));
        }
        let columns = node.transform().matrix().map(|column| column.map(f64::from));
        let place = parent * DMat4::from_cols_array_2d(&columns);
        if let Some(camera) = node.camera() {
            self.camera(&camera, place);
        }
        if node.skin().is_some() {
            self.ignored.insert("skins are not applied: the mesh is drawn in its rest pose".to_owned());
        }
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                let name = node.name().or(mesh.name()).map(str::to_owned);
                self.primitive(&primitive, name, place)?;
            }
        }
        node.children().try_for_each(|child| self.node(&child, place, depth + 1))
    }

    fn camera(&mut self, camera: &gltf::Camera<'_>, place: DMat4) {
        let gltf::camera::Projection::Perspective(lens) = camera.projection() else {
            self.ignored.insert("orthographic cameras are not read".to_owned());
            return;
        };
        let forward = place.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
        let up = place.transform_vector3(DVec3::Y).normalize_or(DVec3::Y);
        let fov_y_degrees = f64::from(lens.yfov()).to_degrees().clamp(0.1, 170.0);
        let eye = place.transform_point3(DVec3::ZERO);
        let near = f64::from(lens.znear());
        self.model.camera.get_or_insert(ModelCamera { eye, forward, up, fov_y_degrees, near });
    }

    fn primitive(&mut self, primitive: &gltf::Primitive<'_>, name: Option<String>, place: DMat4) -> Result<(), String> {
        let name = name.unwrap_or_else(|| format!("part {}", self.model.parts.len() + 1));
        if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            self.ignored.insert("points and lines are not drawn".to_owned());
            return Ok(());
        }
        if primitive.morph_targets().next().is_some() {
            self.ignored.insert("morph targets are not applied".to_owned());
        }
        if primitive.get(&gltf::Semantic::Colors(0)).is_some() {
            self.ignored.insert(
                "colours of vertices (COLOR_0) are not drawn; bake them into the base colour texture".to_owned(),
            );
        }
        self.buffers.check(primitive)?;
        let reader = primitive.reader(|buffer| self.buffers.bytes(buffer.index()));
        let attribute = |semantic| primitive.get(&semantic);
        let positions: Vec<DVec3> = attribute(gltf::Semantic::Positions)
            .and_then(|accessor| vectors::<3>(accessor, self.buffers))
            .ok_or_else(|| format!("the positions of `{name}` are not in the file"))?
            .into_iter()
            .map(|position| place.transform_point3(DVec3::from_array(position)))
            .collect();
        if !positions.iter().all(|position| position.is_finite()) {
            return Err(format!("`{name}` has a position that is not a finite number; repair the mesh"));
        }
        let indices: Vec<u32> = match primitive.indices() {
            None => (0..positions.len() as u32).collect(),
            Some(_) => reader
                .read_indices()
                .ok_or_else(|| format!("the indices of `{name}` are not in the file"))?
                .into_u32()
                .collect(),
        };
        if let Some(index) = indices.iter().find(|index| **index as usize >= positions.len()) {
            return Err(format!("index {index} of `{name}` is out of range: it has {} positions", positions.len()));
        }
        let triangles = triangles(primitive.mode(), &indices);
        self.triangles += triangles.len();
        if self.triangles > MAX_TRIANGLES {
            return Err(format!("has more than {MAX_TRIANGLES} triangles; simplify the model"));
        }
        // A normal is a covector: the inverse transpose moves it, and det · M⁻ᵀ needs no inverse.
        let turn = cofactors(DMat3::from_mat4(place)) * DMat3::from_mat4(place).determinant().signum();
        let one_each = |count: usize| count == positions.len();
        let normals: Vec<DVec3> = attribute(gltf::Semantic::Normals)
            .and_then(|accessor| vectors::<3>(accessor, self.buffers))
            .map(|all| all.into_iter().map(|normal| (turn * DVec3::from_array(normal)).normalize_or_zero()).collect())
            .filter(|all: &Vec<DVec3>| one_each(all.len()) && all.iter().all(|normal| normal.is_finite()))
            .unwrap_or_default();
        let material = primitive.material();
        let (set, transform) = materials::placement(&material, &mut self.ignored);
        let texcoords: Vec<DVec2> = attribute(gltf::Semantic::TexCoords(set))
            .and_then(|accessor| vectors::<2>(accessor, self.buffers))
            .map(|all| {
                let place = |uv| transform.transform_point2(DVec2::from_array(uv));
                all.into_iter().map(place).map(|uv| DVec2::new(uv.x, 1.0 - uv.y)).collect()
            })
            .filter(|all: &Vec<DVec2>| one_each(all.len()) && all.iter().all(|uv| uv.is_finite()))
            .unwrap_or_default();
        let material = material.index();
        self.model.parts.push(Part { name, positions, normals, texcoords, triangles, material });
        Ok(())
    }

    /// Lists what the file has besides the meshes.
    fn notes(&mut self, file: &gltf::Gltf) {
        if file.animations().next().is_some() {
            self.ignored.insert("animations are not played".to_owned());
        }
        if file.scenes().len() > 1 {
            self.ignored.insert("only the default scene is drawn".to_owned());
        }
        for name in file.extensions_used().filter(|name| !KNOWN_EXTENSIONS.contains(name)) {
            self.ignored.insert(format!("the extension {name} is not read"));
        }
        if file.extensions_used().any(|name| name == "KHR_lights_punctual") {
            self.ignored.insert("lights of the file are not read; add [[light]] tables".to_owned());
        }
    }
}

/// Triangles of a primitive (glTF 2.0 §3.7.2.1). The winding of strips alternates.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    let three = |window: &[u32]| [window[0], window[1], window[2]];
    match mode {
        Mode::TriangleStrip => {
            let turned = |(nth, [a, b, c]): (usize, [u32; 3])| if nth % 2 == 0 { [a, b, c] } else { [b, a, c] };
            indices.windows(3).map(three).enumerate().map(turned).collect()
        }
        Mode::TriangleFan => {
            indices.windows(2).skip(1).filter_map(|pair| Some([*indices.first()?, pair[0], pair[1]])).collect()
        }
        _ => indices.chunks_exact(3).map(three).collect(),
    }
}

/// Cofactors of a matrix: its determinant times its inverse transpose.
fn cofactors(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_the_winding_of_their_triangles() {
        let strip = triangles(Mode::TriangleStrip, &[0, 1, 3, 2, 5]);
        assert_eq!(strip, [[0, 1, 3], [3, 1, 2], [3, 2, 5]]);
        assert_eq!(triangles(Mode::TriangleFan, &[7, 1, 2, 3]), [[7, 1, 2], [7, 2, 3]]);
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3]), [[0, 1, 2]]);
        for mode in [Mode::TriangleStrip, Mode::TriangleFan, Mode::Triangles] {
            assert!(triangles(mode, &[]).is_empty() && triangles(mode, &[1, 2]).is_empty());
        }
    }
}
