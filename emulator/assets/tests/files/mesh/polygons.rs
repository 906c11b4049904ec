//! Concave polygons against areas by the shoelace formula and points by the crossing number.

use std::fmt::Write as _;

use glam::{DMat3, DVec2, DVec3};

use super::read;

/// Name and corners, counter-clockwise, on a grid of whole numbers.
const SIMPLE: &[(&str, &[[f64; 2]])] = &[
    ("triangle", &[[0., 0.], [6., 1.], [2., 5.]]),
    ("square", &[[0., 0.], [4., 0.], [4., 4.], [0., 4.]]),
    ("L", &[[0., 0.], [6., 0.], [6., 2.], [2., 2.], [2., 6.], [0., 6.]]),
    ("chevron", &[[0., 0.], [6., 3.], [0., 6.], [2., 3.]]),
    ("U", &[[0., 0.], [6., 0.], [6., 6.], [4., 6.], [4., 2.], [2., 2.], [2., 6.], [0., 6.]]),
    ("T", &[[2., 0.], [4., 0.], [4., 4.], [6., 4.], [6., 6.], [0., 6.], [0., 4.], [2., 4.]]),
    (
        "plus",
        &[
            [2., 0.],
            [4., 0.],
            [4., 2.],
            [6., 2.],
            [6., 4.],
            [4., 4.],
            [4., 6.],
            [2., 6.],
            [2., 4.],
            [0., 4.],
            [0., 2.],
            [2., 2.],
        ],
    ),
    (
        "S",
        &[
            [0., 0.],
            [6., 0.],
            [6., 4.],
            [2., 4.],
            [2., 5.],
            [6., 5.],
            [6., 7.],
            [0., 7.],
            [0., 2.],
            [4., 2.],
            [4., 1.],
            [0., 1.],
        ],
    ),
    ("zigzag", &[[0., 0.], [2., 3.], [4., 0.], [6., 3.], [8., 0.], [8., 2.], [6., 5.], [4., 2.], [2., 5.], [0., 2.]]),
    ("comb", &[[0., 0.], [7., 0.], [7., 5.], [6., 1.], [5., 5.], [4., 1.], [3., 5.], [2., 1.], [0., 5.]]),
    (
        "spiral",
        &[
            [0., 0.],
            [8., 0.],
            [8., 8.],
            [2., 8.],
            [2., 4.],
            [4., 4.],
            [4., 6.],
            [6., 6.],
            [6., 2.],
            [1., 2.],
            [1., 8.],
            [0., 8.],
        ],
    ),
    (
        "star",
        &[[0., -4.], [1., -1.], [4., -1.], [2., 1.], [3., 4.], [0., 2.], [-3., 4.], [-2., 1.], [-4., -1.], [-1., -1.]],
    ),
    // Corners on straight edges.
    (
        "split L",
        &[[0., 0.], [3., 0.], [6., 0.], [6., 2.], [4., 2.], [2., 2.], [2., 4.], [2., 6.], [0., 6.], [0., 5.], [0., 3.]],
    ),
    // An outline that enters a hole by an edge and leaves by the same edge.
    ("frame", &[[0., 0.], [8., 0.], [8., 8.], [0., 8.], [0., 0.], [2., 2.], [2., 6.], [6., 6.], [6., 2.], [2., 2.]]),
];

/// Planes in space: an axis of the plane, another, and the origin.
fn planes() -> [(DMat3, DVec3); 4] {
    let turned =
        DMat3::from_cols(DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.64, 0.6, -0.48), DVec3::new(-0.48, 0.8, 0.36));
    [
        (DMat3::IDENTITY, DVec3::ZERO),
        (DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y), DVec3::new(3.0, -2.0, 1.0)),
        (turned, DVec3::ZERO),
        (turned * 0.001, DVec3::new(450_000.0, 51_000.0, 12.0)),
    ]
}

fn shoelace(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|([x, y], [s, t])| x * t - y * s).sum::<f64>() / 2.0
}

/// True if a ray to the right crosses the outline an odd number of times.
fn is_inside(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let next = corners.iter().cycle().skip(1);
    corners
        .iter()
        .zip(next)
        .filter(|([a, b], [c, d])| (*b > y) != (*d > y) && x < a + (y - b) / (d - b) * (c - a))
        .count()
        % 2
        == 1
}

fn covers([a, b, c]: [DVec2; 3], point: DVec2) -> bool {
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| (to - from).perp_dot(point - from) > 0.0);
    sides == [true; 3] || sides == [false; 3]
}

/// OBJ text of a polygon in a plane, its corners from `first` on.
fn text(corners: &[[f64; 2]], first: usize, backwards: bool, (axes, origin): (DMat3, DVec3)) -> String {
    let mut order: Vec<usize> = (0..corners.len()).map(|k| (k + first) % corners.len()).collect();
    if backwards {
        order.reverse();
    }
    let mut text = String::new();
    for index in &order {
        let p = axes * DVec3::new(corners[*index][0], corners[*index][1], 0.0) + origin;
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    let face: Vec<String> = (1..=order.len()).map(|index| index.to_string()).collect();
    text + "f " + &face.join(" ")
}

#[test]
fn a_polygon_is_covered_once_whichever_corner_comes_first() {
    for (name, corners) in SIMPLE {
        for (axes, origin) in planes() {
            for first in 0..corners.len() {
                for backwards in [false, true] {
                    let read = read(&text(corners, first, backwards, (axes, origin))).unwrap();
                    assert!(
                        read.warnings.iter().all(|warning| warning.contains("without an area")),
                        "{name}: {:?}",
                        read.warnings
                    );
                    let back = axes.inverse();
                    let flat = |index: u32| (back * (read.mesh.vertices[index as usize].position - origin)).truncate();
                    let triangles: Vec<[DVec2; 3]> =
                        read.mesh.triangles.iter().map(|triangle| triangle.map(flat)).collect();
                    let signed = |[a, b, c]: &[DVec2; 3]| (*b - *a).perp_dot(*c - *a) / 2.0;
                    let expected = if backwards { -shoelace(corners) } else { shoelace(corners) };
                    let area: f64 = triangles.iter().map(signed).sum();
                    assert!((area - expected).abs() < 1e-5, "{name} from {first}: {area}, {expected}");
                    assert!(triangles.iter().all(|triangle| signed(triangle) * expected > 0.0), "{name} from {first}");
                    // Points off the grid of the corners, so that none is on an edge.
                    for [x, y] in
                        (0..144).map(|k| [f64::from(k % 12) - 3.37 + 0.0131, f64::from(k / 12) - 3.41 + 0.0077])
                    {
                        let count = triangles.iter().filter(|triangle| covers(**triangle, DVec2::new(x, y))).count();
                        assert_eq!(count, usize::from(is_inside(corners, [x, y])), "{name} from {first}: ({x}, {y})");
                    }
                }
            }
        }
    }
}

#[test]
fn corners_on_straight_edges_stay_vertices() {
    let (_, corners) = SIMPLE.iter().find(|(name, _)| *name == "split L").unwrap();
    let mut cut_by_ears = 0;
    for first in 0..corners.len() {
        let read = read(&text(corners, first, false, planes()[0])).unwrap();
        // A fan drops the triangles that have all corners on one edge.
        if read.warnings.is_empty() {
            assert_eq!((read.mesh.vertices.len(), read.mesh.triangles.len()), (11, 9), "from {first}");
            cut_by_ears += 1;
        }
    }
    assert!(cut_by_ears >= 4, "{cut_by_ears}");
}

#[test]
fn convex_polygons_are_fans_from_their_first_corner_flat_or_not() {
    for (heights, expected) in [
        (&[0.0, 0.0, 0.0, 0.0][..], &[[0, 1, 2], [0, 2, 3]][..]),
        (&[0.0, 0.5, 0.0, 0.5], &[[0, 1, 2], [0, 2, 3]]),
        (&[0.5, 0.0, 0.5, 0.0], &[[0, 1, 2], [0, 2, 3]]),
        (&[3.0, 0.0, 3.0, 0.0], &[[0, 1, 2], [0, 2, 3]]),
        (&[0.0, 0.1, 0.0, 0.0, 0.2], &[[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
        (&[0.0; 6], &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]),
    ] {
        let mut text = String::new();
        for (index, height) in (0u32..).zip(heights) {
            let angle = f64::from(index) / heights.len() as f64 * std::f64::consts::TAU;
            let _ = writeln!(text, "v {} {} {height}", libm::cos(angle), libm::sin(angle));
        }
        let face: Vec<String> = (1..=heights.len()).map(|index| index.to_string()).collect();
        let read = read(&format!("{text}f {}", face.join(" "))).unwrap();
        assert_eq!(read.mesh.triangles, expected, "{heights:?}");
    }
}

#[test]
fn faces_that_cross_themselves_are_fans_with_a_warning() {
    for (name, corners) in [
        ("bow-tie", &[[0., 0.], [4., 4.], [4., 0.], [0., 4.]][..]),
        ("uneven bow-tie", &[[0., 0.], [4., 3.], [4., 0.], [0., 9.]]),
        ("pentagram", &[[0., 5.], [3., -4.], [-5., 2.], [5., 2.], [-3., -4.]]),
        ("turned twice", &[[0., 0.], [4., 0.], [0., 4.], [-4., 0.], [0., -4.], [4., 1.], [1., 4.]]),
        ("loop", &[[0., 0.], [8., 0.], [8., 8.], [4., 8.], [4., -3.], [3., -3.], [3., 8.], [0., 8.]]),
        (
            "two squares at a corner, opposed",
            &[[0., 0.], [2., 0.], [2., 2.], [4., 2.], [4., 4.], [2., 4.], [2., 2.], [0., 2.], [3., 1.]],
        ),
        ("hourglass", &[[0., 0.], [6., 0.], [1., 6.], [5., 6.]]),
        ("star of six", &[[0., 4.], [3., -2.], [-3., 2.], [0., -4.], [-3., -2.], [3., 2.]]),
        ("fish", &[[0., 2.], [6., 0.], [9., 4.], [9., -1.], [6., 4.]]),
        ("arrow", &[[0., 0.], [9., 0.], [9., 4.], [3., -4.], [0., 4.]]),
    ] {
        let read = read(&text(corners, 0, false, planes()[0])).unwrap();
        let warned = read.warnings.iter().any(|warning| warning.starts_with("1 faces cross themselves"));
        assert!(warned, "{name}: {:?}", read.warnings);
        assert!(read.mesh.triangles.len() <= corners.len() - 2, "{name}");
    }
}

#[test]
fn repeated_and_collinear_corners_cost_no_area() {
    for (corners, area) in [
        (&[[0., 0.], [0., 0.], [4., 0.], [4., 4.]][..], 8.0),
        (&[[0., 0.], [4., 0.], [4., 0.], [4., 4.], [0., 4.]], 16.0),
        (&[[0., 0.], [4., 0.], [4., 4.], [0., 4.], [0., 0.]], 16.0),
        (&[[0., 0.], [1., 0.], [2., 0.], [4., 0.], [4., 4.], [0., 4.]], 16.0),
        (&[[2., 0.], [4., 0.], [4., 4.], [0., 4.], [0., 0.], [1., 0.]], 16.0),
        (&[[0., 0.], [6., 0.], [6., 2.], [2., 2.], [2., 2.], [2., 6.], [0., 6.]], 20.0),
        (&[[0., 0.], [6., 0.], [6., 0.], [6., 2.], [2., 2.], [2., 6.], [0., 6.], [0., 6.]], 20.0),
        (&[[0., 0.], [6., 0.], [9., 0.], [6., 0.], [6., 2.], [2., 2.], [2., 6.], [0., 6.]], 20.0),
        (&[[2., 2.], [2., 6.], [0., 6.], [0., 0.], [6., 0.], [6., 2.], [2., 2.]], 20.0),
        (&[[0., 0.], [8., 0.], [8., 8.], [4., 8.], [4., 4.], [4., 8.], [0., 8.]], 64.0),
    ] {
        for first in 0..corners.len() {
            let read = read(&text(corners, first, false, planes()[0])).unwrap();
            let total: f64 = read
                .mesh
                .triangles
                .iter()
                .map(|triangle| {
                    let [a, b, c] = triangle.map(|index| read.mesh.vertices[index as usize].position);
                    (b - a).cross(c - a).z / 2.0
                })
                .sum();
            assert!((total - area).abs() < 1e-9, "{corners:?} from {first}: {total}, {area}");
        }
    }
}
