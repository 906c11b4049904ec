//! Triangles set up in integers: which pixels they have, and what is on their planes.

use fixed::types::{I2F30, I4F28};
use glam::DVec3;
use roughxel_core::ports::{BlockPair, BlockPort, BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::scanline::{
    Attributes, Fragment, Fragments, MAX_INVERSE_W, MAX_POSITION, SUBPIXEL_BITS, ScreenVertex, Triangle,
};
use roughxel_core::setup::{block_vector, real_pair, real_vector};

use roughxel_oracle::random::Random;

/// As many bits as a set-up in floating point may keep.
const CODES: Precision = Precision { fraction_bits: 28, ..Precision::PRECISE };

fn vertex(x: i32, y: i32) -> ScreenVertex {
    ScreenVertex { x, y, inverse_w: 1 << 30 }
}

/// The edge function opposite to corner i at a pixel's centre, in square sub-pixels.
fn edge(v: &[ScreenVertex; 3], i: usize, x: i32, y: i32) -> i64 {
    let at = |i: usize| [v[i % 3].x, v[i % 3].y].map(i64::from);
    let ([ax, ay], [bx, by]) = (at(i + 1), at(i + 2));
    let [px, py] = [x, y].map(|pixel| 256 * i64::from(pixel) + 128);
    (bx - ax) * (py - ay) - (by - ay) * (px - ax)
}

/// A triangle has the pixels whose centres are inside, and of those on an edge the ones on a top or a left edge.
fn is_inside(v: &[ScreenVertex; 3], x: i32, y: i32) -> bool {
    (0..3).all(|i| {
        let (a, b) = (&v[(i + 1) % 3], &v[(i + 2) % 3]);
        let owns = b.y < a.y || (b.y == a.y && b.x > a.x);
        match edge(v, i, x, y) {
            0 => owns,
            side => side > 0,
        }
    })
}

/// Triangles of all shapes near the origin, many with corners at centres of pixels.
fn small_triangles(random: &mut Random) -> [ScreenVertex; 3] {
    let mut v = [(); 3].map(|()| {
        let [x, y] = [(); 2].map(|()| {
            let place = random.below(12 * 256) as i32 - 6 * 256;
            if random.below(2) == 0 { (place >> 7) << 7 } else { place }
        });
        vertex(x, y)
    });
    if edge(&v, 0, 0, 0) + edge(&v, 1, 0, 0) + edge(&v, 2, 0, 0) < 0 {
        v.swap(1, 2);
    }
    v
}

pub(crate) fn a_triangle_has_the_pixels_whose_centres_are_inside() {
    let mut random = Random(1);
    for _ in 0..1500 {
        let v = small_triangles(&mut random);
        let area: i64 = (0..3).map(|i| edge(&v, i, 0, 0)).sum();
        let Some(triangle) = Triangle::new(&v) else {
            assert_eq!(area, 0, "{v:?}");
            continue;
        };
        let rows = triangle.rows();
        for y in -8..8 {
            let inside: Vec<i32> = (-8..8).filter(|&x| is_inside(&v, x, y)).collect();
            assert!(inside.is_empty() || rows.contains(&y), "{v:?} {y}");
            assert_eq!(triangle.span(y, -9..9).collect::<Vec<_>>(), inside, "{v:?} {y}");
            let within: Vec<i32> = inside.into_iter().filter(|x| (-2..3).contains(x)).collect();
            assert_eq!(triangle.span(y, -2..3).collect::<Vec<_>>(), within, "{v:?} {y}");
        }
        // Rows are those with a centre between the corners.
        let [low, high] = [v.iter().map(|v| v.y).min(), v.iter().map(|v| v.y).max()].map(Option::unwrap);
        let centres: Vec<i32> = (-8..8).filter(|y| (low..=high).contains(&(256 * y + 128))).collect();
        assert_eq!(rows.collect::<Vec<_>>(), centres, "{v:?}");
        assert_eq!(triangle.span(100, -9..9), 0..0);
    }
}

pub(crate) fn corners_out_of_range_and_backs_are_no_triangles() {
    let right = [vertex(0, 0), vertex(2560, 0), vertex(0, 2560)];
    assert!(Triangle::new(&right).is_some());
    let [a, b, c] = right;
    assert!(Triangle::new(&[a, c, b]).is_none() && Triangle::new(&[a, b, vertex(5120, 0)]).is_none());
    for (corner, is_one) in [
        (vertex(MAX_POSITION, 0), true),
        (vertex(MAX_POSITION + 1, 0), false),
        (ScreenVertex { inverse_w: 1, ..b }, true),
        (ScreenVertex { inverse_w: 0, ..b }, false),
        (ScreenVertex { inverse_w: MAX_INVERSE_W, ..b }, true),
        (ScreenVertex { inverse_w: MAX_INVERSE_W + 1, ..b }, false),
    ] {
        assert_eq!(Triangle::new(&[a, corner, c]).is_some(), is_one, "{corner:?}");
    }
    for (corner, is_one) in [
        (vertex(0, MAX_POSITION), true),
        (vertex(0, MAX_POSITION + 1), false),
        (vertex(-MAX_POSITION, 2560), true),
        (vertex(-MAX_POSITION - 1, 2560), false),
    ] {
        assert_eq!(Triangle::new(&[a, b, corner]).is_some(), is_one, "{corner:?}");
    }
    assert_eq!(SUBPIXEL_BITS, 8);
}

/// What float64 makes of an attribute at a pixel: A/W and its derivatives to the right and down, and how much of it cancels.
struct Truth {
    a: DVec3,
    da: [DVec3; 2],
    w: f64,
    dw: [f64; 2],
    loss: f64,
}

fn truth(v: &[ScreenVertex; 3], corners: [DVec3; 3], x: i32, y: i32) -> Truth {
    let q = v.map(|v| f64::from(v.inverse_w));
    let at = |x: i32, y: i32| {
        let e = [0, 1, 2].map(|i| edge(v, i, x, y) as f64 * q[i]);
        (e.iter().sum::<f64>(), (0..3).map(|i| corners[i] * e[i]).sum::<DVec3>())
    };
    let ((w, sum), here) = (at(x, y), sum_of(v, corners, x, y));
    let largest = (0..3).map(|i| q[i] * corners[i].length()).fold(0.0, f64::max);
    let area: f64 = (0..3).map(|i| edge(v, i, x, y) as f64).sum();
    let [(wx, ax), (wy, ay)] = [at(x + 1, y), at(x, y + 1)];
    Truth {
        a: here / w,
        da: [(ax - sum - here / w * (wx - w)) / w, (ay - sum - here / w * (wy - w)) / w],
        w,
        dw: [(wx - w) / w, (wy - w) / w],
        loss: largest * area / sum.length(),
    }
}

fn sum_of(v: &[ScreenVertex; 3], corners: [DVec3; 3], x: i32, y: i32) -> DVec3 {
    (0..3).map(|i| corners[i] * (edge(v, i, x, y) as f64 * f64::from(v[i].inverse_w))).sum()
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

fn unit_vectors(random: &mut Random, scale: f64) -> [BlockVector; 3] {
    [(); 3].map(|()| {
        let mut part = || random.below(1 << 30) as f64 / f64::from(1 << 29) - 1.0;
        block_vector(DVec3::new(part() * 0.3, part() * 0.3, 1.0 + part() * 0.2) * scale, &CODES)
    })
}

pub(crate) fn attributes_of_fragments_are_perspective_correct() {
    let mut random = Random(2);
    let (mut fragments, mut triangles) = (0, 0);
    while triangles < 60 {
        let size = [24, 2000, 1_000_000][triangles % 3];
        let mut v = [(); 3].map(|()| {
            let [x, y] = [(); 2].map(|()| random.below(2 * size as u64 + 1) as i32 - size);
            let bits = 20 + random.below(11);
            ScreenVertex { x, y, inverse_w: (1 << bits) + random.below(1 << bits) as u32 }
        });
        if triangles % 5 == 0 {
            v = v.map(|v| ScreenVertex { inverse_w: v.inverse_w >> 10 | 1, ..v });
        }
        if (0..3).map(|i| edge(&v, i, 0, 0)).sum::<i64>() < 0 {
            v.swap(1, 2);
        }
        let Some(triangle) = Triangle::new(&v) else { continue };
        triangles += 1;
        let scale = [1.0, 1e-9, 3e5][random.below(3) as usize];
        let uv = unit_vectors(&mut random, 0.6);
        let corners = Attributes {
            normal: unit_vectors(&mut random, 1.0),
            view: unit_vectors(&mut random, scale),
            main_direction: unit_vectors(&mut random, 7.0),
            uv: Some(uv.map(|v| BlockPair { mantissa: [v.mantissa[0], v.mantissa[2]], exponent: v.exponent })),
        };
        let surface = SurfaceIn {
            offset: [I4F28::from_bits(5); 2],
            roughness: [I4F28::from_bits(7); 3],
            frame_vectors: [BlockVector::default(), uv[0]],
            ..Default::default()
        };
        let template = ReflectionIn { surface, edge_texels: 99, ..Default::default() };
        let all = Fragments::new(&triangle, &corners, &template);
        let rows = triangle.rows();
        for y in rows.clone().step_by((rows.len() / 4).max(1)) {
            let row = all.row(y, -4096..4096);
            let (length, span) = (row.len(), triangle.span(y, -4096..4096));
            assert_eq!((length, row.size_hint()), (span.len(), (length, Some(length))));
            let step = (length / 6).max(1);
            let mut seen = 0;
            for (index, fragment) in row.enumerate() {
                assert_eq!(fragment.x, span.start + index as i32);
                seen += 1;
                if index % step == 0 || index + 1 == length {
                    check(&v, &corners, &template, &fragment, y);
                    fragments += 1;
                    // A walk to the pixel has the bits of a start there.
                    let alone = all.row(y, fragment.x..fragment.x + 1).next().expect("it is inside");
                    assert_eq!(alone.reflection, fragment.reflection);
                    assert_eq!(alone.texture, fragment.texture);
                }
                if seen > 400 {
                    break;
                }
            }
        }
    }
    assert!(fragments > 400, "{fragments}");
}

fn check(v: &[ScreenVertex; 3], corners: &Attributes, template: &ReflectionIn, fragment: &Fragment, y: i32) {
    let real = |attribute: &[BlockVector; 3]| attribute.map(|corner| real_vector(&corner));
    let of = |attribute: &[BlockVector; 3]| truth(v, real(attribute), fragment.x, y);
    let [n, view, h] = [&corners.normal, &corners.view, &corners.main_direction].map(of);
    let ReflectionIn { surface, dview, dnormal, edge_texels } = &fragment.reflection;
    assert_eq!((surface.offset, surface.roughness), (template.surface.offset, template.surface.roughness));
    assert_eq!((*edge_texels, surface.frame_vectors[1]), (99, template.surface.frame_vectors[1]));
    // What the module claims of directions, with 2^−24 for float64's own differences of large numbers.
    let bar = |truth: &Truth| (-28_f64).exp2() + (-37_f64).exp2() * truth.loss;
    for (truth, found) in [(&n, &surface.normal), (&view, &surface.view), (&h, &surface.frame_vectors[0])] {
        assert!(angle(truth.a, real_vector(found)) <= bar(truth), "{v:?} {fragment:?}");
    }
    let (Some(texture), Some(uv)) = (&fragment.texture, &corners.uv) else { panic!("texture coordinates were given") };
    let uv = uv.map(|corner| real_pair(&corner).extend(0.0));
    let uv = truth(v, uv, fragment.x, y);
    let bar = ((-27_f64).exp2() + (-36_f64).exp2() * uv.loss) * uv.a.abs().max_element().max(1.0);
    for (found, exact) in texture.uv.iter().zip([uv.a.x, uv.a.y]) {
        let error = (f64::from(found.to_bits()) * (-32_f64).exp2() - exact).rem_euclid(1.0);
        assert!(error.min(1.0 - error) <= bar, "{v:?} {found} {exact}");
    }
    // n and dn have the scale W² beside that of their ports: what counts is their ratio.
    let scale = real_vector(&surface.normal).length() / n.a.length();
    for (axis, derivative) in dnormal.iter().enumerate() {
        let found = real_vector(derivative) / scale;
        let error = (found - n.da[axis]).length();
        let bar = ((-24_f64).exp2() + (-34_f64).exp2() * n.loss)
            * (n.da[axis].length() + n.a.length() * n.dw[axis].abs() + 1e-6);
        assert!(error <= bar, "{v:?} {axis} {found} {}", n.da[axis]);
        let found = real_pair(&texture.duv[axis]).extend(0.0);
        let bar = ((-24_f64).exp2() + (-34_f64).exp2() * uv.loss)
            * (uv.da[axis].length() + uv.a.length() * uv.dw[axis].abs() + 1e-6);
        assert!((found - uv.da[axis]).length() <= bar, "{v:?} {axis} {found} {}", uv.da[axis]);
    }
    assert!(view.w > 0.0 && dview[0].mantissa.iter().any(|m| m.to_bits() != 0));
}

pub(crate) fn a_plane_is_its_corners_at_its_corners() {
    // Corners at the centres of pixels, weights 1: A at a corner is the attribute times the area.
    let v = [vertex(128, 128), vertex(128 + 256 * 8, 128), vertex(128, 128 + 256 * 4)]
        .map(|v| ScreenVertex { inverse_w: 1, ..v });
    let triangle = Triangle::new(&v).expect("it runs clockwise");
    let corner = |x: i32, exponent: i16| BlockPort { mantissa: [I2F30::from_bits(x)], exponent };
    let real = |port: &BlockPort<1>| f64::from(port.mantissa[0].to_bits()) * f64::from(port.exponent).exp2();
    let plane = triangle.plane(&[corner(1 << 29, 1), corner(3 << 28, 2), corner(-(1 << 29), 3)]);
    let [a, b, c] = [(0, 0), (8, 0), (0, 4)].map(|(x, y)| real(&plane.line(x, y).block()));
    assert!((b / a - 3.0).abs() < 1e-8 && (c / a + 4.0).abs() < 1e-8, "{a} {b} {c}");
    // Twice the area, 2^21 square sub-pixels, times 1, in units of 2^54.
    assert!((a * (-30_f64).exp2() / (21.0 - 54.0_f64).exp2() - 1.0).abs() < 1e-8, "{a}");
    assert!((real(&plane.dx()) / a - 2.0 / 8.0).abs() < 1e-8);
    assert!((real(&plane.dy()) / a + 5.0 / 4.0).abs() < 1e-8);
    let mut line = plane.line(0, 0);
    (0..8).for_each(|_| line.step());
    assert_eq!(line.block(), plane.line(8, 0).block());
    // An exponent far below the others leaves nothing; beyond ±2^11 it is read as that.
    let far = triangle.plane(&[corner(1 << 29, 0), corner(1 << 29, -200), corner(1 << 29, -32768)]);
    assert_eq!(far.line(8, 0).block().mantissa[0], I2F30::ZERO);
    let least = [-32768, -2048].map(|e| triangle.plane(&[corner(1 << 29, e); 3]).line(1, 1).block());
    assert_eq!(least[0], least[1]);
}
