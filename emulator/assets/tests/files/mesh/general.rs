//! A mesh of a text: vertices, tangents, repairs, errors.

use std::path::Path;

use glam::{DVec2, DVec3};

use super::{message, read};
use roughxel_assets::{ReadOptions, read_mesh};

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
    assert_eq!(read.without_uv.as_deref(), Some("test.obj:9"));
    assert_eq!(read.warnings.len(), 1, "the face without texture coordinates has no direction in the map");
}

#[test]
fn negative_indices_polygons_continued_lines_and_foreign_lines_are_read() {
    let text = "# caf\u{e9}\nmtllib a b.mtl\no thing\nv 0 0 0 1.0\nv 1 0 0 .5 .5 .5\nv 1 1 0\nv .5 2 0\nv 0 1 0\n\
                usemtl x\ns off\nf -5 -4 -3 \\\n -2 -1\nl 1 2\np 1\n";
    let read = read(text).unwrap();
    assert_eq!((read.mesh.vertices.len(), read.mesh.triangles.len()), (5, 3));
    assert_eq!(read.without_uv.as_deref(), Some("test.obj:11"), "the line a continued one begins on");
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
    let missing = read_mesh(Path::new("no such file.obj"), &ReadOptions::default()).unwrap_err().to_string();
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
