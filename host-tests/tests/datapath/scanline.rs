//! Fragments set up in integers: the pixels of a triangle, and its attributes against perspective-correct ones in float64.

use std::ops::Range;

use fixed::types::{I2F30, I4F28};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::{BlockPair, BlockPort, BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::scanline::{Attributes, Fragment, Fragments, MAX_INVERSE_W, MAX_POSITION, ScreenVertex, Triangle};
use roughxel_core::setup::{block_vector, real_pair, real_vector};

#[path = "../../../core/oracle/tests/oracle/scanline/truth.rs"]
#[expect(unreachable_pub, dead_code, reason = "the oracle uses it, too")]
mod truth;

use truth::{PIXEL, Truth, angle, clockwise, real, shares_of_bars, vertex};

/// Codes with as many bits as a floating-point set-up may keep.
const CODES: Precision = Precision { fraction_bits: 28, ..Precision::PRECISE };
/// All columns.
const EVERYWHERE: Range<i32> = -5000..5000;
fn block_pair(uv: DVec2) -> BlockPair {
    let BlockVector { mantissa: [u, v, _], exponent } = block_vector(uv.extend(0.0), &CODES);
    BlockPair { mantissa: [u, v], exponent }
}

/// The bits of a port whose largest component may be 1.
fn mantissas<const N: usize>(bits: [i32; N], exponent: i16) -> BlockPort<N> {
    BlockPort { mantissa: bits.map(I2F30::from_bits), exponent }
}

fn config() -> ProptestConfig {
    ProptestConfig { cases: 4000, failure_persistence: None, rng_seed: RngSeed::Fixed(12), ..Default::default() }
}

fn number() -> impl Strategy<Value = f64> {
    -1.0..1.0
}

fn direction() -> impl Strategy<Value = DVec3> {
    [number(), number(), number()].prop_map(DVec3::from_array)
}

/// Corners within `extent` sub-pixels, 1/w over `ratio_bits` octaves.
fn corners(extent: i32, ratio_bits: f64) -> impl Strategy<Value = [ScreenVertex; 3]> {
    let position = move || -extent..=extent;
    let corner = (position(), position(), -ratio_bits..=0.0).prop_map(|(x, y, bits)| ScreenVertex {
        x,
        y,
        inverse_w: (30.0 + bits).exp2() as u32,
    });
    [corner.clone(), corner.clone(), corner].prop_map(clockwise)
}

/// Directions as in a mesh: vertex normals that differ by less than a right angle, a view of a camera in front of them.
fn mesh(v: &[ScreenVertex; 3], axis: DVec3, normals: [DVec3; 3], others: [DVec3; 3], extent: i32) -> Attributes {
    let axis = axis.try_normalize().unwrap_or(DVec3::Z);
    let ray = |v: &ScreenVertex| DVec3::new(f64::from(v.x), f64::from(v.y), f64::from(extent)) / f64::from(v.inverse_w);
    Attributes {
        normal: normals.map(|n| block_vector((axis + 0.5 * n).normalize_or(axis), &CODES)),
        view: [0, 1, 2].map(|i| block_vector(ray(&v[i]), &CODES)),
        main_direction: others.map(|h| block_vector(axis.any_orthonormal_vector() + 0.5 * h, &CODES)),
        uv: Some(others.map(|uv| block_pair(8.0 * uv.truncate()))),
    }
}

/// The pixel of a triangle at some share of its rows, then of its columns.
fn pixel(triangle: &Triangle, share: [f64; 2]) -> Option<(i32, i32)> {
    let place = |range: Range<i32>, share: f64| range.start + (share * range.len() as f64) as i32;
    let y = place(triangle.rows(), share[1]);
    let columns = triangle.span(y, EVERYWHERE);
    (!columns.is_empty()).then(|| (place(columns, share[0]), y))
}

fn fragment_at(fragments: &Fragments, x: i32, y: i32) -> Fragment {
    let mut row = fragments.row(y, x..x + 1);
    row.next().filter(|fragment| fragment.x == x && row.next().is_none()).expect("the pixel is inside")
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn ordinary_triangles_are_right_to_2_to_the_minus_27(
        (extent, v) in (8_u32..=20).prop_flat_map(|bits| (Just(1 << bits), corners(1 << bits, 6.0))),
        axis in direction(), normals in [direction(), direction(), direction()],
        others in [direction(), direction(), direction()], share in [0.0..1.0, 0.0..1.0],
    ) {
        let Some(triangle) = Triangle::new(&v) else { return Ok(()) };
        let Some((x, y)) = pixel(&triangle, share) else { return Ok(()) };
        let corners = mesh(&v, axis, normals, others, extent);
        let fragments = Fragments::new(&triangle, &corners, &ReflectionIn::default());
        let fragment = fragment_at(&fragments, x, y);
        let SurfaceIn { normal, view, frame_vectors: [h, _], .. } = fragment.reflection.surface;
        for (found, corners) in [(normal, corners.normal), (view, corners.view), (h, corners.main_direction)] {
            let off = angle(real_vector(&found), Truth::new(&v, real(&corners), x, y).a);
            prop_assert!(off <= (-27_f64).exp2(), "2^{} rad", off.log2());
        }
        let n = Truth::new(&v, real(&corners.normal), x, y);
        for axis in [0, 1] {
            let scale = n.a.length() / real_vector(&normal).length();
            let off = (real_vector(&fragment.reflection.dnormal[axis]) * scale - n.da[axis]).length();
            let size = n.da[axis].length() + n.a.length() * n.perspective[axis];
            prop_assert!(off <= (-27_f64).exp2() * size, "dn: 2^{}", (off / size).log2());
        }
        for (name, share) in shares_of_bars(&v, &corners, &fragment, y) {
            prop_assert!(share <= 1.0, "{name} {share}");
        }
    }

    #[test]
    fn the_datapath_finds_the_footprint_of_the_true_surface(
        v in corners(200 * PIXEL, 6.0), axis in direction(), normals in [direction(), direction(), direction()],
        others in [direction(), direction(), direction()], offset in [-4_i32..4, -4_i32..4], share in [0.0..1.0, 0.0..1.0],
    ) {
        let Some(triangle) = Triangle::new(&v) else { return Ok(()) };
        let Some((x, y)) = pixel(&triangle, share) else { return Ok(()) };
        let corners = mesh(&v, axis, normals, others, 200 * PIXEL);
        let offset = offset.map(|b| I4F28::from_bits(b << 24));
        let surface = SurfaceIn { offset, ..Default::default() };
        let template = ReflectionIn { surface, edge_texels: 256, ..Default::default() };
        let found = fragment_at(&Fragments::new(&triangle, &corners, &template), x, y).reflection;
        // v and n themselves, with their own derivatives, in place of V and of W² times n.
        let [n, view] = [corners.normal, corners.view].map(|a| Truth::new(&v, real(&a), x, y));
        let port = |a: DVec3| block_vector(a, &CODES);
        let surface = SurfaceIn { normal: port(n.a), view: port(view.a), ..found.surface };
        let truth = ReflectionIn { surface, dview: view.da.map(port), dnormal: n.da.map(port), ..found };
        let [found, truth] = [found, truth].map(|port| port.reflect(&ReflectionPlan::FULL, &Precision::PRECISE));
        prop_assume!(found.face == truth.face);
        for i in [0, 1] {
            let [a, b] = [found, truth].map(|out| real_pair(&out.columns[i]));
            let [st, other] = [found, truth].map(|out| DVec2::from_array(out.st.map(|s| s.to_num())));
            prop_assert!(st.distance(other) <= (-21_f64).exp2(), "{st} is {other}");
            prop_assert!(a.distance(b) <= (-15_f64).exp2() * (b.length() + 1.0 / 256.0), "{a} is {b}");
        }
    }

    #[test]
    fn any_triangle_loses_what_is_claimed(
        v in (4_u32..=20, 0..31).prop_flat_map(|(bits, ratio)| corners(1 << bits, f64::from(ratio))),
        a in [direction(), direction(), direction()], b in [direction(), direction(), direction()],
        octaves in -40_i32..40, share in [0.0..1.0, 0.0..1.0],
    ) {
        let Some(triangle) = Triangle::new(&v) else { return Ok(()) };
        let Some((x, y)) = pixel(&triangle, share) else { return Ok(()) };
        let ports = |a: [DVec3; 3]| a.map(|a| block_vector(a, &CODES));
        // Corners of very different lengths.
        let uneven = [a[0], a[1] * f64::from(octaves).exp2(), a[2]];
        let uv = Some(b.map(|b| block_pair(b.truncate() * f64::from(octaves).exp2())));
        let corners = Attributes { normal: ports(a), view: ports(uneven), main_direction: ports(b), uv };
        let fragments = Fragments::new(&triangle, &corners, &ReflectionIn::default());
        for (name, share) in shares_of_bars(&v, &corners, &fragment_at(&fragments, x, y), y) {
            prop_assert!(share <= 1.0, "{name} {share}");
        }
    }

    #[test]
    fn slivers_are_as_right_as_others(
        ends in corners(MAX_POSITION - 4, 6.0), along in 0.0..1.0, aside in [-3_i32..4, -3_i32..4],
        axis in direction(), normals in [direction(), direction(), direction()],
        others in [direction(), direction(), direction()], row in any::<prop::sample::Index>(),
    ) {
        // The third corner is a few sub-pixels away from the edge of the others.
        let beside = |a: i32, b: i32, aside: i32| a + (f64::from(b - a) * along) as i32 + aside;
        let [a, b, mut c] = ends;
        (c.x, c.y) = (beside(a.x, b.x, aside[0]), beside(a.y, b.y, aside[1]));
        let v = clockwise([a, b, c]);
        let Some(triangle) = Triangle::new(&v) else { return Ok(()) };
        let corners = mesh(&v, axis, normals, others, MAX_POSITION);
        let fragments = Fragments::new(&triangle, &corners, &ReflectionIn::default());
        // Pixels are rare: the first one from some row on.
        let rows = triangle.rows();
        if rows.is_empty() { return Ok(()) }
        let first = rows.start + row.index(rows.len()) as i32;
        let Some((y, fragment)) = (first..rows.end).find_map(|y| Some((y, fragments.row(y, EVERYWHERE).next()?))) else {
            return Ok(())
        };
        for (name, share) in shares_of_bars(&v, &corners, &fragment, y) {
            prop_assert!(share <= 1.0, "{name} {share}");
        }
    }

    #[test]
    fn stepping_along_a_row_equals_evaluating_each_pixel(
        v in corners(100 * PIXEL, 20.0), a in [direction(), direction(), direction()], share in 0.0..1.0,
    ) {
        let Some(triangle) = Triangle::new(&v) else { return Ok(()) };
        let Some((_, y)) = pixel(&triangle, [0.0, share]) else { return Ok(()) };
        let corners = mesh(&v, a[0], a, a, 100 * PIXEL);
        let plane = triangle.plane(&corners.normal);
        let columns = triangle.span(y, EVERYWHERE);
        let mut line = plane.line(columns.start, y);
        for x in columns.clone() {
            prop_assert_eq!(line, plane.line(x, y));
            line.step();
        }
        let fragments = Fragments::new(&triangle, &corners, &ReflectionIn::default());
        let row = fragments.row(y, EVERYWHERE);
        prop_assert_eq!(row.len(), columns.len());
        for (x, fragment) in columns.zip(row) {
            let alone = fragment_at(&fragments, x, y);
            prop_assert_eq!((fragment.x, fragment.reflection, fragment.texture), (x, alone.reflection, alone.texture));
        }
    }

    #[test]
    fn triangles_that_share_edges_cover_each_pixel_once(place in [0_i32..=32, 0_i32..=32], fine in [0_i32..128, 0_i32..128], whole: bool) {
        // Four triangles around a point in a square of 16 by 16 pixels. Often the point is the centre of a pixel, and centres are on all edges.
        let [x, y] = [0, 1].map(|i: usize| (place[i] * 128 + if whole { 0 } else { fine[i] }).min(16 * PIXEL));
        let edge = 16 * PIXEL;
        let corners = [vertex(0, 0), vertex(edge, 0), vertex(edge, edge), vertex(0, edge)];
        let mut covered = [[0; 18]; 18];
        for i in 0..4 {
            let Some(triangle) = Triangle::new(&[corners[i], corners[(i + 1) % 4], vertex(x, y)]) else { continue };
            for row in -1..17 {
                for column in triangle.span(row, -1..17) {
                    covered[(row + 1) as usize][(column + 1) as usize] += 1;
                }
            }
        }
        for (row, counts) in covered.iter().enumerate() {
            for (column, &count) in counts.iter().enumerate() {
                let expected = usize::from((1..17).contains(&row) && (1..17).contains(&column));
                prop_assert_eq!(count, expected, "{} {}", column, row);
            }
        }
    }
}

#[test]
fn nothing_overflows_at_the_ends_of_the_ranges() {
    // The square of all positions, and thin triangles along its sides and diagonals.
    let ends = [-MAX_POSITION, -MAX_POSITION + 1, 0, MAX_POSITION - 1, MAX_POSITION];
    let positions: Vec<[i32; 2]> = ends.iter().flat_map(|&x| ends.map(|y| [x, y])).collect();
    let weights = [[1; 3], [MAX_INVERSE_W; 3], [1, MAX_INVERSE_W, 1], [MAX_INVERSE_W, 1, MAX_INVERSE_W]];
    let words = [i32::MIN, i32::MAX, 1];
    let mut inside = 0;
    for (&a, &b) in positions.iter().flat_map(|a| positions.iter().map(move |b| (a, b))) {
        for (&c, q) in positions.iter().flat_map(|c| weights.map(|q| (c, q))) {
            let at = |[x, y]: [i32; 2], inverse_w| ScreenVertex { x, y, inverse_w };
            let Some(triangle) = Triangle::new(&[at(a, q[0]), at(b, q[1]), at(c, q[2])]) else { continue };
            for exponents in [[0, 0, 0], [i16::MIN, i16::MAX, 0], [i16::MAX; 3], [i16::MIN; 3]] {
                let corner = |i: usize| {
                    let mut bits = words;
                    bits.rotate_left(i);
                    mantissas(bits, exponents[i])
                };
                let vectors = [0, 1, 2].map(corner);
                let pairs =
                    vectors.map(|v| BlockPair { mantissa: [v.mantissa[0], v.mantissa[1]], exponent: v.exponent });
                let corners = Attributes { normal: vectors, view: vectors, main_direction: vectors, uv: Some(pairs) };
                let fragments = Fragments::new(&triangle, &corners, &ReflectionIn::default());
                let rows = triangle.rows();
                for y in [rows.start, 0, rows.end - 1, i32::MIN, i32::MAX] {
                    let span = triangle.span(y, i32::MIN..i32::MAX);
                    for x in [span.start, span.end - 1] {
                        inside += usize::from(x < span.end && fragments.row(y, x..x + 1).next().is_some());
                    }
                }
            }
        }
    }
    assert!(inside > 10_000, "{inside} pixels were inside");
}

#[test]
fn what_is_the_same_all_over_a_triangle_comes_from_the_template() {
    let triangle = Triangle::new(&[vertex(0, 0), vertex(4 * PIXEL, 0), vertex(0, 4 * PIXEL)]).expect("a triangle");
    let up = mantissas([0, 0, 1 << 30], 0);
    let surface = SurfaceIn { offset: [I4F28::ONE; 2], frame_vectors: [up; 2], ..Default::default() };
    let template = ReflectionIn { surface, edge_texels: 256, ..Default::default() };
    let corners = Attributes { normal: [up; 3], view: [up; 3], ..Default::default() };
    let fragments = Fragments::new(&triangle, &corners, &template);
    let rows: Vec<Vec<Fragment>> = triangle.rows().map(|y| fragments.row(y, EVERYWHERE).collect()).collect();
    assert_eq!(rows.iter().map(Vec::len).collect::<Vec<_>>(), [3, 2, 1, 0]);
    for fragment in rows.into_iter().flatten() {
        assert_eq!(fragment.texture, None);
        assert_eq!((fragment.reflection.edge_texels, fragment.reflection.surface.offset), (256, [I4F28::ONE; 2]));
        assert_eq!(fragment.reflection.surface.frame_vectors, [BlockVector::default(), up]);
        assert_eq!(fragment.reflection.dnormal, [BlockVector::default(); 2]);
        assert_eq!(angle(real_vector(&fragment.reflection.surface.normal), DVec3::Z), 0.0);
    }
}
