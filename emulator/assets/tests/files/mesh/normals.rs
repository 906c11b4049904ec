//! Normals: faces with and without `vn`, smoothing groups, coordinates far from the origin.

use glam::DVec3;

use super::read;
use roughxel_assets::ReadMesh;

/// A roof over the x axis: two squares that meet at 90 degrees along y, and a third square next to the right one.
const ROOF: &str =
    "v -1 0 0\nv 0 0 1\nv 0 2 1\nv -1 2 0\nv 1 0 0\nv 1 2 0\nv 2 0 -1\nv 2 2 -1\nvn 0.6 0 0.8\nvn 0 0 0\nvn 0 3 4\n";
const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
const LEFT: DVec3 = DVec3::new(-HALF, 0.0, HALF);
const RIGHT: DVec3 = DVec3::new(HALF, 0.0, HALF);

/// Normals at the ridge: of the first and of the second face.
fn ridge(read: &ReadMesh) -> [DVec3; 2] {
    let near = |triangles: &[[u32; 3]]| {
        let mut vertices = triangles.iter().flatten().map(|index| read.mesh.vertices[*index as usize]);
        vertices.rfind(|vertex| vertex.position == DVec3::new(0.0, 0.0, 1.0)).unwrap().normal
    };
    [near(&read.mesh.triangles[..2]), near(&read.mesh.triangles[2..4])]
}

#[test]
fn smoothing_groups_and_normals_of_other_faces_decide_who_shares_a_normal() {
    // Both faces have one area, and each counts once, however it is cut.
    let mean = (LEFT + RIGHT).normalize();
    let given = DVec3::new(0.6, 0.0, 0.8);
    let tilted = DVec3::new(0.0, 0.6, 0.8);
    for (faces, expected) in [
        ("f 1 2 3 4\nf 2 5 6 3\n", [mean, mean]),
        ("s 1\nf 1 2 3 4\nf 2 5 6 3\n", [mean, mean]),
        ("s 7\nf 1 2 3 4\ns 7 # again\nf 2 5 6 3\n", [mean, mean]),
        ("s 1\nf 1 2 3 4\ns 2\nf 2 5 6 3\n", [LEFT, RIGHT]),
        ("s 1\nf 1 2 3 4\ns 2\nf 2 5 6 3\ns 1\nf 5 7 8 6\n", [LEFT, RIGHT]),
        ("s off\nf 1 2 3 4\nf 2 5 6 3\n", [LEFT, RIGHT]),
        ("s 0\nf 1 2 3 4\nf 2 5 6 3\n", [LEFT, RIGHT]),
        ("s\nf 1 2 3 4\nf 2 5 6 3\n", [LEFT, RIGHT]),
        ("s 1\nf 1 2 3 4\ns off\nf 2 5 6 3\n", [LEFT, RIGHT]),
        ("f 1 2 3 4\ns 1\nf 2 5 6 3\n", [LEFT, RIGHT]),
        ("s 4294967295\nf 1 2 3 4\nf 2 5 6 3\n", [mean, mean]),
        ("s on\nf 1 2 3 4\nf 2 5 6 3\n", [mean, mean]),
        ("o a\ng b\nf 1 2 3 4\no c\nusemtl d\nf 2 5 6 3\n", [mean, mean]),
        ("s off\nf 1//1 2//1 3//1 4//1\nf 2 5 6 3\n", [given, RIGHT]),
        ("f 1//1 2//1 3//1 4//1\ns off\nf 2 5 6 3\n", [given, RIGHT]),
        ("s off\nf 1 2 3 4\nf 2//3 5//3 6//3 3//3\n", [LEFT, tilted]),
        ("f 1//1 2//1 3//1 4//1\nf 2//3 5//3 6//3 3//3\n", [given, tilted]),
        ("f 1//1 2//1 3//1 4//1\nf 2 5 6 3\n", [given, mean]),
        ("f 1 2 3 4\nf 2//1 5//1 6//1 3//1\n", [mean, given]),
        ("s off\nf 1//2 2//2 3//2 4//2\nf 2 5 6 3\n", [LEFT, RIGHT]),
        ("f 1//2 2//2 3//2 4//2\nf 2//1 5//1 6//1 3//1\n", [mean, given]),
    ] {
        let found = ridge(&read(&format!("{ROOF}{faces}")).unwrap());
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).length() < 1e-12, "{faces}: {found}, {expected}");
        }
    }
}

#[test]
fn a_face_without_vn_never_takes_that_of_another_face() {
    let flat = "v -1 -1 0\nv 0 -1 0\nv 0 1 0\nv -1 1 0\nv 1 -1 0\nv 1 1 0\nvt 0 0\nvn 0.6 0 0.8\nvn 1 0 1\n";
    for (faces, lines_without) in [
        ("f 1//1 2//1 3//1 4//1\no right\nf 2 5 6 3\n", 1),
        ("f 2 5 6 3\nf 1//1 2//1 3//1 4//1\n", 1),
        ("f 1 2 3 4\n", 1),
        ("f 1 2 3\nf 1 3 4\n", 2),
        ("f 1/1 2/1 3/1 4/1\nf 2//2 5//2 6//2 3//2\n", 1),
        ("f 1/1/1 2/1/1 3/1/1 4/1/1\nf 2/1 5/1 6/1 3/1\n", 1),
        ("g a\nf 1//2 2//2 3//2\ng b\nf 1 3 4\ng c\nf 2//1 5//1 6//1\n", 1),
        ("f -6 -5 -4 -3\nf 2//-1 5//-1 6//-1 3//-1\n", 1),
        ("f 1//1 2//1 3//1\nf 1 3 4\nf 2//1 5//1 6//1\nf 2 6 3\n", 2),
        ("usemtl a\nf 1 2 3 4\nusemtl b\nf 2//1 5//1 6//1 3//1\nusemtl a\nf 2 5 6\n", 2),
    ] {
        let read = read(&format!("{flat}{faces}")).unwrap();
        let straight = read.mesh.vertices.iter().filter(|vertex| vertex.normal == DVec3::Z).count();
        let others = [DVec3::new(0.6, 0.0, 0.8), DVec3::new(HALF, 0.0, HALF)];
        let given = |normal: DVec3| others.iter().any(|other| (normal - *other).length() < 1e-12);
        let rest = read.mesh.vertices.iter().filter(|vertex| given(vertex.normal)).count();
        assert!(straight >= 3 + usize::from(lines_without == 2), "{faces}: {straight}");
        assert_eq!(straight + rest, read.mesh.vertices.len(), "{faces}");
    }
}

#[test]
fn a_centimetre_is_a_centimetre_everywhere_within_the_limits() {
    for (x, y) in [
        (0, 0),
        (1_000, 2_000),
        (65_536, -65_536),
        (456_789, 54_321),
        (-456_789, 54_321),
        (999_999, 0),
        (-999_999, -999_999),
        (262_144, 524_288),
        (1, 999_998),
        (777_777, -333_333),
    ] {
        let mut text = String::new();
        for post in 0..8 {
            let (left, right) = (2 * post, 2 * post + 1);
            text += &format!(
                "v {x}.{left:02} {y}.00 0\nv {x}.{right:02} {y}.00 0\nv {x}.{right:02} {y}.16 0\nv {x}.{left:02} {y}.16 0\nf -4 -3 -2 -1\n"
            );
        }
        let read = read(&text).unwrap();
        assert_eq!((read.mesh.triangles.len(), read.warnings.len()), (16, 0), "{x}, {y}: {:?}", read.warnings);
        for [a, b, c] in
            read.mesh.triangles.iter().map(|triangle| triangle.map(|i| read.mesh.vertices[i as usize].position))
        {
            let area = (b - a).cross(c - a).length() / 2.0;
            assert!((area - 0.0008).abs() < 1e-10, "{x}, {y}: {area}");
        }
    }
}

#[test]
fn triangles_within_the_rounding_of_their_coordinates_have_no_area() {
    for (text, count) in [
        ("v 0.1 0.1 0.1\nv 0.2 0.2 0.2\nv 0.3 0.3 0.3\nv 0 1 0\nf 1 2 3\nf 1 2 4\n", 1),
        ("v 456789.1 0.1 0\nv 456789.2 0.2 0\nv 456789.3 0.3 0\nv 456789 1 0\nf 1 2 3\nf 1 2 4\n", 1),
        ("v 0 0 0\nv 1 0 0\nv 0.5 1e-12 0\nf 1 2 3\n", 1),
        ("v 0 0 0\nv 1e-9 0 0\nv 0 1e-9 0\nf 1 2 3\n", 1),
        ("v 999999 0 0\nv 999999.000001 0 0\nv 999999 0.000001 0\nf 1 2 3\n", 1),
        ("v 0 0 0\nv 1 0 0\nv 0.5 1e-18 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n", 1),
        ("v 0 0 0\nv 1000000 0 0\nv 0 1e-9 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n", 1),
        ("v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 1 0\nv 1 0 0\nf 1 2 3\nf 1 4 5\n", 1),
        ("v 0 0 0\nv 1e-200 0 0\nv 0 1e-200 0\nv 0 1 0\nv 1 0 0\nf 1 2 3\nf 1 4 5\n", 1),
        ("v 0 0 0\nv 1 1 1\nv 0.333333 0.333333 0.333334\nf 1 2 3\n", 1),
    ] {
        assert_eq!(read(text).unwrap().mesh.triangles.len(), count, "{text}");
    }
}
