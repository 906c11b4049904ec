//! Triangles set up in integers: their pixels, and the attributes on their planes.

use fixed::types::{I2F30, I4F28};
use glam::DVec3;
use roughxel_core::ports::{BlockPair, BlockPort, BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::scanline::{
    Attributes, Fragment, Fragments, MAX_INVERSE_W, MAX_POSITION, SUBPIXEL_BITS, ScreenVertex, Triangle,
};
use roughxel_core::setup::block_vector;

use roughxel_oracle::random::Random;

#[expect(unreachable_pub, reason = "the host uses it, too")]
mod truth;

use truth::{clockwise, edge_functions, is_inside, shares_of_bars, vertex};

/// Codes with as many bits as a floating-point set-up may keep.
const CODES: Precision = Precision { fraction_bits: 28, ..Precision::PRECISE };

/// Triangles of all shapes near the origin, many with corners at centres of pixels.
fn small_triangles(random: &mut Random) -> [ScreenVertex; 3] {
    clockwise([(); 3].map(|()| {
        let [x, y] = [(); 2].map(|()| {
            let place = random.below(12 * 256) as i32 - 6 * 256;
            if random.below(2) == 0 { (place >> 7) << 7 } else { place }
        });
        vertex(x, y)
    }))
}

pub(crate) fn a_triangle_has_the_pixels_whose_centres_are_inside() {
    let mut random = Random(1);
    for _ in 0..1500 {
        let v = small_triangles(&mut random);
        let area: f64 = edge_functions(&v, 0, 0).0.iter().sum();
        let Some(triangle) = Triangle::new(&v) else {
            assert_eq!(area, 0.0, "{v:?}");
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
        // Rows with a centre between the corners.
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
    for none in [[a, c, b], [c, b, a], [b, a, c], [a; 3], [a, b, b], [a, b, vertex(5120, 0)], [a, b, vertex(-256, 0)]] {
        assert!(Triangle::new(&none).is_none(), "{none:?}");
    }
    for (corner, is_one) in [
        (vertex(MAX_POSITION, 0), true),
        (vertex(MAX_POSITION + 1, 0), false),
        (ScreenVertex { inverse_w: 1, ..b }, true),
        (ScreenVertex { inverse_w: 0, ..b }, false),
        (ScreenVertex { inverse_w: MAX_INVERSE_W, ..b }, true),
        (ScreenVertex { inverse_w: MAX_INVERSE_W + 1, ..b }, false),
        (ScreenVertex { inverse_w: u32::MAX, ..b }, false),
    ] {
        assert_eq!(Triangle::new(&[a, corner, c]).is_some(), is_one, "{corner:?}");
    }
    for (corner, is_one) in [
        (vertex(0, MAX_POSITION), true),
        (vertex(0, MAX_POSITION + 1), false),
        (vertex(-MAX_POSITION, 2560), true),
        (vertex(-MAX_POSITION - 1, 2560), false),
        (vertex(0, -MAX_POSITION - 1), false),
        (vertex(i32::MIN, i32::MAX), false),
    ] {
        assert_eq!(Triangle::new(&[a, b, corner]).is_some(), is_one, "{corner:?}");
        assert!(Triangle::new(&[a, corner, b]).is_none(), "{corner:?}");
    }
    assert_eq!(SUBPIXEL_BITS, 8);
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
        v = clockwise(v);
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
                    // A walk to the pixel gives the bits of a start at the pixel.
                    let alone = all.row(y, fragment.x..fragment.x + 1).next().expect("the fragment is inside");
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
    let ReflectionIn { surface, dview, edge_texels, .. } = &fragment.reflection;
    assert_eq!((surface.offset, surface.roughness), (template.surface.offset, template.surface.roughness));
    assert_eq!((*edge_texels, surface.frame_vectors[1]), (99, template.surface.frame_vectors[1]));
    assert!(fragment.texture.is_some() && dview[0].mantissa.iter().any(|m| m.to_bits() != 0));
    for (name, share) in shares_of_bars(v, corners, fragment, y) {
        assert!(share <= 1.0, "{name} {share}: {v:?} {fragment:?}");
    }
}

pub(crate) fn a_plane_is_its_corners_at_its_corners() {
    // Corners at the centres of pixels, weights 1: A at a corner is the attribute times the area.
    let v = [vertex(128, 128), vertex(128 + 256 * 8, 128), vertex(128, 128 + 256 * 4)]
        .map(|v| ScreenVertex { inverse_w: 1, ..v });
    let triangle = Triangle::new(&v).expect("the triangle runs clockwise");
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
    // An exponent far below the others leaves nothing; beyond ±2^11 it is clamped.
    let far = triangle.plane(&[corner(1 << 29, 0), corner(1 << 29, -200), corner(1 << 29, -32768)]);
    assert_eq!(far.line(8, 0).block().mantissa[0], I2F30::ZERO);
    let least = [-32768, -2048].map(|e| triangle.plane(&[corner(1 << 29, e); 3]).line(1, 1).block());
    assert_eq!(least[0], least[1]);
}
