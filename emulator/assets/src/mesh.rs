//! Triangle meshes from Wavefront OBJ files.
//!
//! The text is checked line by line first, so that errors name the line and the parser (`tobj`) sees only finite
//! numbers and indices in range. Missing normals are area-weighted means. p_u and p_v follow from the texture
//! coordinates, area-weighted per vertex. A vertex between a mirrored and an unmirrored chart is split in two.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;

use glam::{DVec2, DVec3};

use roughxel_utilities::input::{open_file, without_mark};

/// Indexed triangles in world space; counter-clockwise seen from the side of the normal for the built-in shapes.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Vertex indices, all below `vertices.len()`; no triangle has zero area.
    pub triangles: Vec<[u32; 3]>,
}

/// One vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position, world units.
    pub position: DVec3,
    /// Unit normal, world space.
    pub normal: DVec3,
    /// Texture coordinates in repeats of the map: u to the right, v up, (0, 0) the bottom-left corner.
    pub uv: DVec2,
    /// ∂p/∂u and ∂p/∂v in world units per repeat; both zero if a mesh has no texture coordinates.
    ///
    /// If a mesh mirrors its map, ∂p/∂u and ∂p/∂v are negated. S97's s_u = n × p_v and s_v = p_u × n then still run
    /// against the true p_u and p_v, so that bumps stay bumps.
    pub tangents: [DVec3; 2],
}

/// Most triangles of a file.
pub const MAX_TRIANGLES: usize = 4_000_000;
/// Largest file in bytes: 4 million triangles with normals and texture coordinates take about 500 MB.
const MAX_BYTES: u64 = 1 << 29;
/// Largest coordinate, world units.
const MAX_COORDINATE: f32 = 1e6;
/// Area of a triangle over the square of its longest edge, below which it is dropped: rounding of f32 coordinates.
const LEAST_RELATIVE_AREA: f64 = 1e-9;

/// Reason why a mesh cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {message}")]
pub struct MeshError {
    /// The file, with the line from 1 if a line is wrong.
    pub place: String,
    /// The mistake.
    pub message: String,
}

impl MeshError {
    pub(crate) fn new(path: &Path, message: impl Into<String>) -> Self {
        Self { place: path.display().to_string(), message: message.into() }
    }

    /// An error for a file or a number of triangles beyond the limit.
    fn too_large(path: &Path, what: &str, limit: u64) -> Self {
        Self::new(path, format!("{what} is more than {limit}; simplify the mesh"))
    }
}

/// A mesh read from a file.
#[derive(Debug)]
pub struct ObjMesh {
    /// Its triangles.
    pub mesh: Mesh,
    /// Line of the first face without texture coordinates, from 1. A map cannot be drawn there.
    pub without_uv: Option<usize>,
    /// Repairs, one sentence each.
    pub warnings: Vec<String>,
}

/// Reads an OBJ file. Errors: [`MeshError`].
pub fn read_obj(path: &Path) -> Result<ObjMesh, MeshError> {
    let unreadable = |source| MeshError::new(path, format!("cannot read the mesh: {source}"));
    let mut file = open_file(path).map_err(unreadable)?;
    let bytes_long = file.metadata().map_err(unreadable)?.len();
    if bytes_long > MAX_BYTES {
        return Err(MeshError::too_large(path, &format!("a file of {bytes_long} bytes"), MAX_BYTES));
    }
    let mut bytes = Vec::with_capacity(bytes_long as usize);
    file.read_to_end(&mut bytes).map_err(unreadable)?;
    // Names and comments may be in any encoding; numbers and keywords are ASCII.
    parse_obj(path, &String::from_utf8_lossy(&bytes))
}

/// Reads text as [`read_obj`] reads a file; `path` only names it.
pub fn parse_obj(path: &Path, text: &str) -> Result<ObjMesh, MeshError> {
    let Checked { text: checked, without_uv } = check(path, without_mark(text))?;
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut checked.as_bytes(), &options, |_| Err(tobj::LoadError::OpenFileFailed))
        .map_err(|source| MeshError::new(path, source.to_string()))?;
    let mut builder = Builder::default();
    for model in &models {
        builder.add(&model.mesh);
    }
    let nothing = || MeshError::new(path, "has no face with an area; export the mesh with polygons (`f` lines)");
    let (mesh, warnings) = builder.finish().ok_or_else(nothing)?;
    Ok(ObjMesh { mesh, without_uv, warnings })
}

/// Notation of the corners of a face.
#[derive(Clone, Copy, PartialEq, Eq)]
struct CornerFormat {
    has_uv: bool,
    has_normal: bool,
}

/// Content of a checked file.
struct Checked {
    text: String,
    /// Line of the first face without texture coordinates, as [`ObjMesh::without_uv`].
    without_uv: Option<usize>,
}

/// Checks every line and returns only vertices and faces. A group begins wherever the format of the corners changes:
/// otherwise the parser would give a corner without texture coordinates those of its neighbour.
fn check(path: &Path, text: &str) -> Result<Checked, MeshError> {
    let joined;
    let text = if text.contains("\\\n") || text.contains("\\\r\n") {
        // A continued line becomes one line followed by the later line ends, so that line numbers stay.
        joined = join_continued_lines(text);
        joined.as_str()
    } else {
        text
    };
    let count = |keyword| text.lines().filter(|line| line.split_whitespace().next() == Some(keyword)).count();
    let totals = [count("v"), count("vt"), count("vn")];
    let mut seen = [0usize; 3];
    let mut checked = String::with_capacity(text.len());
    let mut format: Option<CornerFormat> = None;
    let (mut triangles, mut without_uv) = (0usize, None);
    for (index, content) in text.lines().enumerate() {
        let fail = |message| MeshError { place: format!("{}:{}", path.display(), index + 1), message };
        let mut words = content.split_whitespace();
        let keyword = words.next().unwrap_or("");
        match keyword {
            "v" | "vt" | "vn" => {
                let (kind, wanted, limit) = match keyword {
                    "v" => (0, 3, MAX_COORDINATE),
                    "vt" => (1, 2, MAX_COORDINATE),
                    _ => (2, 3, f32::MAX),
                };
                checked.push_str(keyword);
                for number in 0..wanted {
                    let word = words
                        .next()
                        .ok_or_else(|| fail(format!("`{keyword}` has {number} numbers and needs {wanted}")))?;
                    let value: f32 = word.parse().map_err(|_| fail(format!("`{word}` is not a number")))?;
                    if !value.is_finite() || value.abs() > limit {
                        return Err(fail(format!("coordinate `{word}` is not a number within ±{limit:e}")));
                    }
                    checked.push(' ');
                    checked.push_str(word);
                }
                checked.push('\n');
                seen[kind] += 1;
            }
            "f" => {
                let words: Vec<&str> = words.collect();
                if words.len() < 3 {
                    return Err(fail(format!("a face has {} corners and needs at least three", words.len())));
                }
                triangles += words.len() - 2;
                if triangles > MAX_TRIANGLES {
                    let what = format!("the number of triangles up to line {}", index + 1);
                    return Err(MeshError::too_large(path, &what, MAX_TRIANGLES as u64));
                }
                let mut corners = String::with_capacity(content.len() + 2);
                let mut face_format = None;
                for word in words {
                    let corner_format = check_corner(word, seen, totals, &mut corners).map_err(&fail)?;
                    if *face_format.get_or_insert(corner_format) != corner_format {
                        return Err(fail("the corners of one face are written in different forms".to_owned()));
                    }
                }
                if format.is_some() && format != face_format {
                    checked.push_str("g\n");
                }
                format = face_format;
                if format.is_some_and(|format| !format.has_uv) {
                    without_uv.get_or_insert(index + 1);
                }
                checked.push('f');
                checked.push_str(&corners);
                checked.push('\n');
            }
            _ => {}
        }
    }
    Ok(Checked { text: checked, without_uv })
}

fn join_continued_lines(text: &str) -> String {
    let mut joined = String::with_capacity(text.len());
    let mut owed_line_ends = 0;
    for line in text.lines() {
        if let Some(start) = line.strip_suffix('\\') {
            joined.push_str(start);
            joined.push(' ');
            owed_line_ends += 1;
        } else {
            joined.push_str(line);
            joined.push('\n');
            for _ in 0..std::mem::take(&mut owed_line_ends) {
                joined.push('\n');
            }
        }
    }
    joined
}

/// Checks one corner `v`, `v/vt`, `v//vn` or `v/vt/vn` and writes it with absolute indices.
fn check_corner(word: &str, seen: [usize; 3], totals: [usize; 3], out: &mut String) -> Result<CornerFormat, String> {
    let mut absolute = [None; 3];
    for (kind, field) in word.split('/').enumerate() {
        if kind >= 3 || (field.is_empty() && kind == 0) {
            return Err(format!("`{word}` is not a corner: write v, v/vt, v//vn or v/vt/vn"));
        }
        if field.is_empty() {
            continue;
        }
        let index: i64 = field.parse().map_err(|_| format!("`{field}` in `{word}` is not an index"))?;
        let from_one = if index < 0 { (seen[kind] as i64 + 1).saturating_add(index) } else { index };
        if from_one < 1 || from_one > totals[kind] as i64 {
            let what = ["vertex", "texture coordinate", "normal"][kind];
            return Err(format!("{what} {index} is out of range: the file has {}", totals[kind]));
        }
        absolute[kind] = Some(from_one);
    }
    // Writing to a String cannot fail.
    let _ = match absolute {
        [position, texcoord, Some(normal)] => {
            let [position, texcoord] = [position, texcoord].map(|index| index.map_or(String::new(), |i| i.to_string()));
            write!(out, " {position}/{texcoord}/{normal}")
        }
        [Some(position), Some(texcoord), None] => write!(out, " {position}/{texcoord}"),
        [Some(position), None, None] => write!(out, " {position}"),
        [None, ..] => Ok(()),
    };
    Ok(CornerFormat { has_uv: absolute[1].is_some(), has_normal: absolute[2].is_some() })
}

/// Indices of one corner of a face.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Corner {
    position: usize,
    texcoord: Option<usize>,
    normal: Option<usize>,
}

/// Vertex of the result: a corner, and true if the map is mirrored there.
type VertexKey = (Corner, bool);

/// Collects the triangles of the models of one file.
#[derive(Default)]
struct Builder {
    mesh: Mesh,
    /// Area-weighted normals of the positions, for corners without a normal.
    face_normals: Vec<DVec3>,
    /// Index of each vertex in `face_normals`.
    position_of: Vec<usize>,
    /// Area of each vertex so far, the weight of its tangents.
    chart_area: Vec<f64>,
    has_uv: bool,
    dropped: usize,
}

impl Builder {
    fn add(&mut self, model: &tobj::Mesh) {
        let triple = |values: &[f32], index: usize| {
            DVec3::new(values[3 * index].into(), values[3 * index + 1].into(), values[3 * index + 2].into())
        };
        let uv_at = |index: usize| DVec2::new(model.texcoords[2 * index].into(), model.texcoords[2 * index + 1].into());
        let first_position = self.face_normals.len();
        self.face_normals.resize(first_position + model.positions.len() / 3, DVec3::ZERO);
        self.has_uv |= !model.texcoord_indices.is_empty();
        let mut known: HashMap<VertexKey, u32> = HashMap::new();
        for corner in (0..model.indices.len()).step_by(3) {
            let corners = [corner, corner + 1, corner + 2].map(|at| Corner {
                position: model.indices[at] as usize,
                texcoord: model.texcoord_indices.get(at).map(|&index| index as usize),
                normal: model.normal_indices.get(at).map(|&index| index as usize),
            });
            let positions = corners.map(|corner| triple(&model.positions, corner.position));
            let edges = [positions[1] - positions[0], positions[2] - positions[0]];
            let doubled_area = edges[0].cross(edges[1]);
            let longest = edges[0].length_squared().max(edges[1].length_squared());
            if doubled_area.length() <= LEAST_RELATIVE_AREA * longest {
                self.dropped += 1;
                continue;
            }
            let normals =
                corners.map(|corner| corner.normal.map_or(DVec3::ZERO, |index| triple(&model.normals, index)));
            let chart = match corners.map(|corner| corner.texcoord.map(uv_at)) {
                [Some(a), Some(b), Some(c)] => tangents(edges, [b - a, c - a]),
                _ => None,
            };
            let outside = if normals.iter().copied().sum::<DVec3>().dot(doubled_area) < 0.0 { -1.0 } else { 1.0 };
            let mirrored = chart.is_some_and(|[p_u, p_v]| p_u.cross(p_v).dot(doubled_area * outside) < 0.0);
            let mut triangle = [0; 3];
            for (slot, corner) in corners.into_iter().enumerate() {
                let place = first_position + corner.position;
                self.face_normals[place] += doubled_area;
                let index = *known.entry((corner, mirrored)).or_insert_with(|| {
                    self.position_of.push(place);
                    self.chart_area.push(0.0);
                    self.mesh.vertices.push(Vertex {
                        position: positions[slot],
                        normal: normals[slot].normalize_or_zero(),
                        uv: corner.texcoord.map_or(DVec2::ZERO, uv_at),
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
    }

    /// Divides the sums and lists the repairs; `None` if nothing is left to draw.
    fn finish(mut self) -> Option<(Mesh, Vec<String>)> {
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
                let mean = self.face_normals[self.position_of[index]].normalize_or_zero();
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
        if without_chart > 0 {
            warnings.push(format!(
                "{without_chart} vertices have no direction in the map (their texture coordinates coincide); \
                 bumps run in any direction there"
            ));
        }
        Some((self.mesh, warnings))
    }
}

/// p_u and p_v of a triangle from two edges and their texture coordinates; `None` if the coordinates have no area.
fn tangents([e, f]: [DVec3; 2], [e_uv, f_uv]: [DVec2; 2]) -> Option<[DVec3; 2]> {
    let determinant = e_uv.perp_dot(f_uv);
    // The bound is relative to the lengths, so that tiny charts count; 1e-9 is rounding of f32 coordinates squared.
    if determinant.abs() <= 1e-9 * e_uv.length() * f_uv.length() {
        return None;
    }
    Some([(e * f_uv.y - f * e_uv.y) / determinant, (f * e_uv.x - e * f_uv.x) / determinant])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ObjMesh, MeshError> {
        parse_obj(Path::new("test.obj"), text)
    }

    fn message(text: &str) -> String {
        read(text).map_or_else(|error| error.to_string(), |_| "no error".to_owned())
    }

    const SQUARE: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

    #[test]
    fn a_square_gets_normals_and_tangents() {
        let read = read(&format!("{SQUARE}f 1/1 2/2 3/3 4/4\n")).unwrap();
        assert_eq!((read.mesh.vertices.len(), read.mesh.triangles.len()), (4, 2));
        for vertex in &read.mesh.vertices {
            assert_eq!(vertex.normal, DVec3::Z);
            assert_eq!(vertex.tangents, [DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)]);
        }
        assert!(read.without_uv.is_none() && read.warnings.is_empty());
    }

    #[test]
    fn a_mirrored_chart_is_split_off_and_both_its_tangents_are_negated() {
        // The right half shows the map mirrored: u falls from 1 to 0 along x.
        let text = format!("{SQUARE}v 4 0 0\nv 4 1 0\nf 1/1 2/2 3/3 4/4\nf 2/2 5/1 6/4 3/3\n");
        let read = read(&text).unwrap();
        assert_eq!(read.mesh.vertices.len(), 8, "the two shared corners are there twice");
        for triangle in &read.mesh.triangles {
            for vertex in triangle.map(|index| read.mesh.vertices[index as usize]) {
                // S97: n' = n + f_u s_u + f_v s_v tilts against the true direction of rising u (and v).
                let centre_x: f64 = triangle.iter().map(|&i| read.mesh.vertices[i as usize].position.x).sum();
                let true_u = if centre_x > 6.0 { DVec3::NEG_X } else { DVec3::X };
                let s_u = vertex.normal.cross(vertex.tangents[1]);
                let s_v = vertex.tangents[0].cross(vertex.normal);
                assert!(s_u.dot(true_u) < 0.0 && s_v.dot(DVec3::Y) < 0.0);
            }
        }
    }

    #[test]
    fn smooth_normals_ignore_seams_of_the_texture() {
        // A roof whose ridge has two sets of texture coordinates.
        let text = "v 0 0 1\nv 0 1 0\nv 1 1 0\nv 1 0 1\nv 0 -1 0\nv 1 -1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n\
                    f 1/1 4/2 3/4\nf 1/1 3/4 2/3\nf 5/1 6/2 4/4\nf 5/1 4/4 1/3\n";
        let read = read(text).unwrap();
        let ridge: Vec<_> = read.mesh.vertices.iter().filter(|vertex| vertex.position.z == 1.0).collect();
        assert_eq!(ridge.len(), 4);
        for vertex in ridge {
            // One end of the ridge touches two triangles of one side and one of the other side.
            assert!(vertex.normal.y.abs() < 0.4 && vertex.normal.z > 0.9);
            assert_eq!(vertex.normal.x, 0.0);
        }
    }

    #[test]
    fn faces_of_different_forms_in_one_file_keep_their_own_texture_coordinates() {
        let read = read(&format!("{SQUARE}f 1 2 3\nf 1/1 3/3 4/4\n")).unwrap();
        assert_eq!(read.mesh.vertices.len(), 6);
        let last = read.mesh.triangles[1].map(|index| read.mesh.vertices[index as usize].uv);
        assert_eq!(last, [DVec2::new(0.0, 0.0), DVec2::new(1.0, 1.0), DVec2::new(0.0, 1.0)]);
        assert_eq!(read.without_uv, Some(9));
        assert_eq!(read.warnings.len(), 1, "the face without texture coordinates has no direction in the map");
    }

    #[test]
    fn negative_indices_polygons_continued_lines_and_foreign_lines_are_read() {
        let text = "# caf\u{e9}\nmtllib a b.mtl\no thing\nv 0 0 0 1.0\nv 1 0 0 .5 .5 .5\nv 1 1 0\nv .5 2 0\nv 0 1 0\n\
                    usemtl x\ns off\nf -5 -4 -3 \\\n -2 -1\nl 1 2\np 1\n";
        let read = read(text).unwrap();
        assert_eq!((read.mesh.vertices.len(), read.mesh.triangles.len()), (5, 3));
        assert_eq!(read.without_uv, Some(11), "the line a continued one begins on");
        assert!(read.mesh.vertices.iter().all(|vertex| vertex.tangents == [DVec3::ZERO; 2]));
    }

    #[test]
    fn a_byte_order_mark_hides_no_vertex() {
        let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let [plain, marked] = [triangle.to_owned(), format!("\u{feff}{triangle}")].map(|text| read(&text).unwrap());
        assert_eq!(plain.mesh.vertices, marked.mesh.vertices);
    }

    #[test]
    fn zero_area_triangles_are_dropped_and_counted() {
        let read = read("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 1 2 4\n").unwrap();
        assert_eq!(read.mesh.triangles.len(), 1);
        assert_eq!(read.warnings, ["2 triangles without an area were dropped"]);
        assert!(message("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").contains("no face with an area"));
        assert!(message("").contains("no face"));
    }

    #[test]
    fn bad_files_name_the_line_and_what_is_wrong() {
        for (text, expected) in [
            ("v 0 0 nan\n", "test.obj:1: coordinate `nan`"),
            ("v 0 0 0\nv 0 inf 0\n", "test.obj:2: coordinate `inf`"),
            ("v 1e39 0 0\n", "test.obj:1: coordinate `1e39`"),
            ("v 0 0\n", "test.obj:1: `v` has 2 numbers and needs 3"),
            ("vt 0 x\n", "test.obj:1: `x` is not a number"),
            ("v 0 0 0\nf 1 1 4\n", "test.obj:2: vertex 4 is out of range: the file has 1"),
            ("v 0 0 0\nf 1 1 0\n", "vertex 0 is out of range"),
            ("v 0 0 0\nf 1 1 -2\n", "vertex -2 is out of range"),
            ("v 0 0 0\nf 1/9223372036854775807 1/1 1/1\n", "texture coordinate 9223372036854775807 is out of range"),
            ("v 0 0 0\nf 1//1 1//1 1//1\n", "normal 1 is out of range: the file has 0"),
            ("v 0 0 0\nf 1///1 1 1\n", "is not a corner"),
            ("v 0 0 0\nf /1 1 1\n", "is not a corner"),
            ("v 0 0 0\nf 1 2\n", "a face has 2 corners"),
            ("v 0 0 0\nf a b c\n", "`a` in `a` is not an index"),
            ("v 0 0 0\nvt 0 0\nf 1/1 1 1\n", "different forms"),
        ] {
            let found = message(text);
            assert!(found.contains(expected), "{text:?}: {found}");
        }
        let missing = read_obj(Path::new("no such file.obj")).unwrap_err().to_string();
        assert!(missing.starts_with("no such file.obj: cannot read the mesh: "), "{missing}");
    }

    #[test]
    fn a_zero_normal_is_replaced_and_cut_files_do_not_panic() {
        let text = format!("{SQUARE}vn 0 0 0\nf 1/1/1 2/2/1 3/3/1\n");
        let square = read(&text).unwrap();
        assert!(square.mesh.vertices.iter().all(|vertex| vertex.normal == DVec3::Z));
        for end in 0..text.len() {
            let _ = read(&text[..end]);
        }
    }
}
