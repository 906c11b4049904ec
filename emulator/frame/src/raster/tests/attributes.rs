//! Attributes of fragments against ray–plane intersection.

use super::*;

/// Checks every attribute of every visible sample of one triangle; returns how many samples there were.
fn check_against_rays(camera: &Camera, corners: [Vertex; 3]) -> usize {
    let view = View::new(camera, one_triangle(corners));
    let samples = view.visible([77, 201]);
    let Some(triangle) = view.list.triangle(0, Needs::ALL) else {
        assert!(samples.is_empty());
        return 0;
    };
    // The whole triangle has one scale of n: that of the first sample that has one.
    let mut scale = None;
    let longest_tangent = corners.iter().flat_map(|v| v.tangents).map(DVec3::length).fold(0.0, f64::max);
    for &(xs, ys, _) in &samples {
        let (x, y) = (pixels(xs), pixels(ys));
        let fragment = triangle.fragment(xs, ys);
        let (share, w) = intersect(camera, &corners, x, y);

        let of_corners = corners.map(|v| v.normal.normalize());
        // A flat triangle has the normal of its corners, whose length is the same everywhere.
        let w = if of_corners == [of_corners[0]; 3] { 1.0 } else { w };
        let normal = blend(share, of_corners) / w;
        let n = vector_value(fragment.normal);
        let s = *scale.get_or_insert(n.dot(normal) / normal.length_squared());
        let reach = of_corners.map(DVec3::length).iter().sum::<f64>() / 3.0 / w;
        // Rounding of three words of 2^-31, and of the sample that gave the scale; measured 2^-29.1.
        assert!((n / s - normal).length() <= reach * 2f64.powi(-28), "n at {x}, {y}: {} {normal}", n / s);

        let v = vector_value(fragment.view);
        let expected = -ray(camera, x, y);
        // Rounding of three words of 2^-31 relative to at least half of |v|.
        assert!((v - expected).length() <= expected.length() * 2f64.powi(-29), "v at {x}, {y}");

        let uv = uv_at(camera, &corners, x, y);
        for (port, reference) in fragment.uv.iter().zip(uv.to_array()) {
            let error = wrapped_distance(port.to_num::<f64>(), reference);
            // The port's rounding is 2^-33 and float64 adds nothing visible; 1/256 texel of a 1024² map would be 2^-18.
            assert!(error <= 2f64.powi(-32), "uv at {x}, {y}: {port} {reference} off by {error:e}");
        }

        let steepest = [
            derivative(|h| uv_at(camera, &corners, x + h, y), 1.0 / 1024.0),
            derivative(|h| uv_at(camera, &corners, x, y + h), 1.0 / 1024.0),
        ];
        let reach = steepest[0].length().max(steepest[1].length());
        for (port, expected) in fragment.duv.iter().zip(steepest) {
            let error = (pair_value(*port) - expected).length();
            // Measured 2^-24, at the worst point of the reference's difference quotient; the design's bound is 2^-16.
            assert!(error <= reach * 2f64.powi(-22), "duv at {x}, {y}: {:?} {expected}", pair_value(*port));
        }

        for (axis, tangent) in fragment.frame_vectors.iter().enumerate() {
            let expected = blend(share, corners.map(|v| v.tangents[axis]));
            let error = (vector_value(*tangent) - expected).length();
            // Rounding as for n; measured 2^-30.1.
            assert!(error <= longest_tangent * 2f64.powi(-28), "tangent at {x}, {y}");
        }
    }
    samples.len()
}

#[test]
fn attributes_agree_with_ray_plane_intersection() {
    let mut random = Random::new(1);
    let camera = camera(96, 64);
    let mut samples = 0;
    for _ in 0..300 {
        let corners = [0; 3].map(|_| {
            let uv = DVec2::new(random.real(-3.0, 3.0), random.real(-3.0, 3.0));
            vertex(random.vector(1.5), random.vector(1.0) * 7.0, uv)
        });
        let [a, b, c] = corners.map(|v| v.position);
        // Edge-on triangles have their own test; this reference has to be well conditioned.
        let facing = (b - a).cross(c - a).dot(a - camera.eye).abs();
        if facing > 0.3 {
            samples += check_against_rays(&camera, corners);
        }
    }
    assert!(samples > 20_000, "{samples}");
}

/// Ground at y = −1 under a level camera, from a point behind the eye to w = `far`.
fn ground(far: f64, repeats: f64) -> [Vertex; 3] {
    [
        vertex(DVec3::new(-3.0 * far, -1.0, 2.0), DVec3::Y, DVec2::new(0.0, 0.0)),
        vertex(DVec3::new(3.0 * far, -1.0, 2.0), DVec3::Y, DVec2::new(repeats, 0.0)),
        vertex(DVec3::new(0.0, -1.0, -far), DVec3::Y, DVec2::new(0.5 * repeats, repeats)),
    ]
}

#[test]
fn ground_plane_to_the_horizon_keeps_a_256th_of_a_texel() {
    // 64 wraps of a 1024² map, w from about 1 to 1000.
    let samples = check_against_rays(&plain_camera(640, 360), ground(1000.0, 64.0));
    assert!(samples > 100_000, "{samples}");
}

#[test]
fn ground_plane_with_turning_normals_keeps_28_bits() {
    let mut corners = ground(300.0, 8.0);
    corners[0].normal = DVec3::new(-0.5, 1.0, 0.2);
    corners[2].normal = DVec3::new(0.0, 1.0, -3.0);
    assert!(check_against_rays(&plain_camera(320, 200), corners) > 20_000);
}

#[test]
fn a_flat_triangle_has_one_normal_and_frame_that_do_not_turn() {
    let tangents = [DVec3::new(0.3, 0.0, 0.1), DVec3::new(-0.1, 0.0, 0.7)];
    let corners = ground(300.0, 8.0).map(|corner| Vertex { normal: DVec3::new(0.1, 1.0, -0.2), tangents, ..corner });
    let view = View::new(&plain_camera(320, 200), one_triangle(corners));
    let triangle = view.list.triangle(0, Needs::ALL).expect("the triangle is visible");
    let samples = view.visible([128, 128]);
    assert!(samples.len() > 20_000);
    let first = triangle.fragment(samples[0].0, samples[0].1);
    let normal = corners[0].normal * (4095.0 / 4096.0);
    for (vector, expected) in [(first.normal, normal), (first.frame_vectors[1], tangents[1])] {
        assert!((vector_value(vector) - expected).length() < 2f64.powi(-30), "{vector:?} {expected}");
    }
    for &(x, y, _) in &samples {
        let fragment = triangle.fragment(x, y);
        assert_eq!((fragment.normal, fragment.frame_vectors), (first.normal, first.frame_vectors), "at {x}, {y}");
        assert_eq!(fragment.dnormal, [BlockVector::default(); 2], "at {x}, {y}");
    }
}

#[test]
fn normal_derivative_is_the_difference_of_normals() {
    let corners = [
        vertex(DVec3::new(-2.0, -1.5, 0.5), DVec3::new(-1.0, 0.0, 0.2), DVec2::ZERO),
        vertex(DVec3::new(2.0, -1.5, -1.0), DVec3::new(1.0, 0.1, 0.3), DVec2::X),
        vertex(DVec3::new(0.0, 1.8, 0.0), DVec3::new(0.2, 1.0, 0.1), DVec2::Y),
    ];
    let triangle = View::new(&camera(128, 128), one_triangle(corners)).triangle(0);
    let at = |x: i32, y: i32| triangle.fragment(x * SUBPIXELS, y * SUBPIXELS);
    for y in (50..90).step_by(7) {
        for x in (50..80).step_by(5) {
            let here = at(x, y);
            let n = vector_value(here.normal);
            for (axis, (right, below)) in [(1, 0), (0, 1)].into_iter().enumerate() {
                let difference = vector_value(at(x + right, y + below).normal) - n;
                let error = (difference - vector_value(here.dnormal[axis])).length();
                // Three ports are rounded: two normals and the derivative.
                assert!(error <= 3.0 * n.length().max(0.1) * 2f64.powi(-30), "{error:e}");
            }
        }
    }
}

#[test]
fn view_derivatives_carry_the_minus_of_erratum_11() {
    let projection = Projection::new(&plain_camera(640, 480)).expect("the camera is valid");
    let v = |x: i32, y: i32| vector_value(projection.ray_view(x, y));
    // Seen along −z with y up, one pixel to the right turns the ray toward +x, so v toward −x; one pixel down turns v toward +y.
    let [dx, dy] = projection.dview().map(vector_value);
    assert_eq!((dx, dy), (DVec3::NEG_X, DVec3::Y));
    let centre = v(320 * SUBPIXELS, 240 * SUBPIXELS);
    assert_eq!(v(321 * SUBPIXELS, 240 * SUBPIXELS) - centre, dx);
    assert_eq!(v(320 * SUBPIXELS, 241 * SUBPIXELS) - centre, dy);
    // tan 45° from libm is exact to one unit in the last place of float64, far below the port's 2^-30.
    assert_eq!(centre, DVec3::new(0.0, 0.0, 240.0));
}

#[test]
fn directions_to_a_point_start_where_the_ray_meets_the_triangle() {
    let camera = plain_camera(128, 96);
    let corners = [DVec3::new(-3.0, -1.0, -2.0), DVec3::new(4.0, -1.5, -9.0), DVec3::new(0.5, 2.5, -4.0)];
    let view = View::new(&camera, one_triangle(corners.map(|corner| vertex(corner, DVec3::Z, DVec2::ZERO))));
    let triangle = view.triangle(0);
    let plane = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let (mut seen, mut worst) = (0, 0.0_f64);
    for light in [DVec3::new(1.0, 3.0, 2.0), DVec3::new(0.0, 0.0, -3.0), DVec3::new(-500.0, 40.0, 1000.0)] {
        let point = triangle.point(light);
        for (x, y, _) in view.visible(PIXEL_CENTRE_SUBPX) {
            let ray = -vector_value(triangle.fragment(x, y).view);
            let hit = camera.eye + ray * (plane.dot(corners[0] - camera.eye) / plane.dot(ray));
            let (truth, found) =
                ((light - hit).normalize(), vector_value(triangle.direction_to(&point, x, y)).normalize());
            worst = worst.max((truth - found).length());
            seen += 1;
        }
    }
    assert!(seen > 1000, "{seen}");
    // Two ports are rounded to 2^-30 of their largest component: the ray and the direction.
    assert!(worst < 2f64.powi(-26), "{worst:e}");
}

#[test]
fn texture_coordinates_far_from_zero_lose_nothing() {
    let camera = camera(64, 48);
    let corners = [DVec2::new(0.0, 0.0), DVec2::new(1.0, 0.0), DVec2::new(0.0, 1.0)]
        .map(|uv| vertex(DVec3::new(uv.x * 2.0 - 1.0, uv.y * 2.0 - 1.0, 0.0), DVec3::Z, uv * 0.75));
    let shifted = corners.map(|mut v| {
        v.uv += DVec2::new(4096.0, -1024.0);
        v
    });
    let [near_zero, far] = [corners, shifted].map(|corners| View::new(&camera, one_triangle(corners)));
    let [a, b] = [&near_zero, &far].map(|view| view.triangle(0));
    for (x, y, _) in near_zero.visible(PIXEL_CENTRE_SUBPX) {
        assert_eq!(a.fragment(x, y).uv, b.fragment(x, y).uv);
        assert_eq!(a.fragment(x, y).duv, b.fragment(x, y).duv);
    }
}

#[test]
fn normals_pass_through_zero_between_opposite_corners() {
    // Parallel to the picture plane, so 1/w is constant and n vanishes on the middle column.
    let corners = [(-0.5, -0.5, DVec3::NEG_X), (0.5, -0.5, DVec3::X), (0.5, 0.5, DVec3::X), (-0.5, 0.5, DVec3::NEG_X)];
    let corners = corners.map(|(x, y, normal)| vertex(DVec3::new(x, y, -1.0), normal, DVec2::ZERO));
    let view = View::new(&plain_camera(129, 129), vec![object(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])]);
    let middle = 64 * SUBPIXELS + SUBPIXELS / 2;
    for (x, y, number) in view.visible(PIXEL_CENTRE_SUBPX) {
        let triangle = view.triangle(number);
        let fragment = triangle.fragment(x, y);
        let (n, dn) = (vector_value(fragment.normal), vector_value(fragment.dnormal[0]));
        // n grows by dn per pixel away from the middle, down to the last bits near zero.
        let distance = pixels(x - middle);
        // dn is rounded at 2^-31 and multiplied by up to 32 pixels.
        assert!((n - dn * distance).length() <= dn.length() * 2f64.powi(-22), "{n} {dn} {distance}");
        assert!(dn.x > 0.0);
    }
}

#[test]
fn clipping_changes_no_attribute() {
    // One affine map of u and v on a small triangle and on one that leaves the guard band and extends behind the eye.
    let uv_of = |p: DVec3| DVec2::new(0.25 * p.x, 0.125 * p.z);
    let build = |corners: [DVec3; 3]| {
        let corners = corners.map(|p| vertex(p, DVec3::new(0.1, 1.0, -0.2), uv_of(p)));
        View::new(&plain_camera(200, 200), one_triangle(corners))
    };
    let inside = build([DVec3::new(-2.0, -1.0, -3.0), DVec3::new(2.0, -1.0, -3.0), DVec3::new(0.0, -1.0, -6.0)]);
    let beyond =
        build([DVec3::new(-900.0, -1.0, 300.0), DVec3::new(900.0, -1.0, 300.0), DVec3::new(0.0, -1.0, -500.0)]);
    let [a, b] = [&inside, &beyond].map(|view| view.triangle(0));
    let samples = inside.visible(PIXEL_CENTRE_SUBPX);
    assert!(samples.len() > 300);
    for (x, y, _) in samples {
        let (small, large) = (a.fragment(x, y), b.fragment(x, y));
        assert_eq!(small.view, large.view);
        let [n, m] = [small, large].map(|f| vector_value(f.normal).normalize());
        // Rounding of two ports of 2^-31 per component.
        assert!((n - m).length() <= 2f64.powi(-28), "{n} {m}");
        for i in 0..2 {
            let (u_small, u_large) = (small.uv[i].to_num::<f64>(), large.uv[i].to_num::<f64>());
            // Each port is rounded at 2^-33; the large triangle spans 450 wraps of 52-bit codes.
            assert!(wrapped_distance(u_small, u_large) <= 2f64.powi(-30));
            let error = (pair_value(small.duv[i]) - pair_value(large.duv[i])).length();
            // Rounding as for n.
            assert!(error <= pair_value(small.duv[i]).length() * 2f64.powi(-28));
        }
    }
}

#[test]
fn slivers_seen_edge_on_stay_within_their_corners() {
    let camera = camera(200, 150);
    let mut random = Random::new(31);
    let mut samples = 0;
    for i in 0..4000 {
        // Almost coplanar with the eye, from 1e-2 down to 1e-14 of a world unit.
        let (a, b) = (random.vector(1.2), random.vector(1.2));
        let lift = 10f64.powi(-2 - i % 13);
        let c = camera.eye + (a * 0.4 + b * 0.6 - camera.eye) * random.real(0.6, 1.1) + random.vector(lift);
        let uv = [DVec2::new(0.1, 0.2), DVec2::new(0.3, 0.2), DVec2::new(0.2, 0.4)];
        let corners = [0, 1, 2].map(|k| vertex([a, b, c][k], DVec3::new(0.3, 0.1 * k as f64, 1.0), uv[k]));
        let view = View::new(&camera, one_triangle(corners));
        let seen = Seen::draw(&view.list, whole(200, 150), &[[9, 140]]);
        let forward = (camera.target - camera.eye).normalize();
        let range = corners.map(|v| view.projection.near() / (v.position - camera.eye).dot(forward));
        let low = range.iter().fold(f64::INFINITY, |m, v| m.min(*v));
        let high = range.iter().fold(0.0_f64, |m, v| m.max(*v));
        for (x, y, number) in view.visible([9, 140]) {
            samples += 1;
            let (_, depth) = seen.at((x >> 8) as u32, (y >> 8) as u32, 0).expect("the sample is covered");
            let depth = depth as f64 / 2f64.powi(56);
            // One step of depth, and float64's rounding of w.
            assert!(depth >= low * (1.0 - 1e-12) && depth <= high * (1.0 + 1e-12), "{depth} {low} {high}");
            let fragment = view.list.triangle(number, Needs::ALL).expect("the triangle is visible").fragment(x, y);
            // A sample half a sub-pixel outside may leave the corners' range by an eighth.
            let [u, v] = fragment.uv.map(|c| c.to_num::<f64>());
            assert!((0.1 - 0.05..=0.3 + 0.05).contains(&u) && (0.2 - 0.05..=0.4 + 0.05).contains(&v), "{u} {v} {lift}");
            let n = vector_value(fragment.normal).normalize();
            assert!(n.z > 0.9, "{n}");
        }
    }
    assert!(samples > 2000, "{samples}");
}

#[test]
fn frames_of_one_pixel_and_of_4096_pixels_work() {
    let mut corners = ground(50.0, 4.0);
    for (width, height) in [(1, 1), (4096, 8), (8, 4096)] {
        let camera = Camera { target: DVec3::new(0.0, -0.6, -1.0), ..plain_camera(width, height) };
        corners[0].normal = DVec3::new(0.1, 1.0, 0.0);
        let samples = check_against_rays(&camera, corners);
        assert!(samples as u32 >= (width * height).div_ceil(8), "{samples}");
    }
}

/// A lane of the rows as [`FragmentAttributes`].
fn of_rows(rows: &AttributeRows, derivatives: &Derivatives<i32>, lane: usize) -> FragmentAttributes {
    fn block<const N: usize>(rows: &BlockRows<N>, lane: usize) -> BlockPort<N> {
        BlockPort {
            mantissa: rows.mantissa.map(|row| I2F30::from_bits(row[lane])),
            exponent: rows.exponent[lane] as i16,
        }
    }
    FragmentAttributes {
        normal: block(&rows.normal, lane),
        view: block(&rows.view, lane),
        frame_vectors: rows.frame_vectors.map(|rows| block(&rows, lane)),
        dview: Port::from_wires(&derivatives.dview),
        dnormal: Port::from_wires(&derivatives.dnormal),
        uv: rows.uv.map(|row| U0F32::from_bits(row[lane].cast_unsigned())),
        duv: rows.duv.map(|rows| block(&rows, lane)),
    }
}

#[test]
fn fragments_side_by_side_are_those_one_by_one_with_every_instruction_set() {
    let mut random = Random::new(51);
    let mut visible_triangles = 0;
    for i in 0..400 {
        let far = if i % 4 == 0 { 900.0 } else { 1.5 };
        let mut corners = [0; 3].map(|_| {
            let uv = DVec2::new(random.real(-far, far), random.real(-3.0, 3.0));
            vertex(random.vector(far), random.vector(1.0) * 7.0, uv)
        });
        if i % 3 == 0 {
            let [Vertex { normal, tangents, .. }, ..] = corners;
            corners = corners.map(|corner| Vertex { normal, tangents, ..corner });
        }
        let view = View::new(&camera(96, 64), one_triangle(corners));
        for bits in 0..8 {
            let needs = Needs { tangents: bits & 1 != 0, uv: bits & 2 != 0, duv: bits & 4 != 0 };
            let Some(triangle) = view.list.triangle(0, needs) else { continue };
            visible_triangles += 1;
            // Positions inside the frame and outside it.
            let positions =
                [97, 65].map(|edge| [0; LANES].map(|_| random.real(-300.0, f64::from(edge) * 256.0) as i32));
            let derivatives = triangle.derivatives();
            for backend in backends() {
                let mut rows = AttributeRows::default();
                backend.run(
                    #[inline(always)]
                    || triangle.fragments(&positions, &mut rows),
                );
                for (lane, (x, y)) in positions[0].into_iter().zip(positions[1]).enumerate() {
                    let expected = triangle.fragment(x, y);
                    assert_eq!(of_rows(&rows, &derivatives, lane), expected, "{backend}, {needs:?}");
                }
            }
        }
    }
    assert!(visible_triangles > 1000, "{visible_triangles}");
}

#[test]
fn attributes_that_nobody_reads_are_zero_and_change_no_other() {
    let view = View::new(&plain_camera(32, 32), one_triangle(ground(50.0, 4.0)));
    let samples = view.visible(PIXEL_CENTRE_SUBPX);
    assert!(!samples.is_empty());
    for (x, y, number) in samples {
        let of = |needs| view.list.triangle(number, needs).expect("the triangle is visible").fragment(x, y);
        let (all, none) = (of(Needs::ALL), FragmentAttributes::default());
        for bits in 0..8 {
            let [tangents, uv, duv] = [1, 2, 4].map(|bit| bits & bit != 0);
            let expected = FragmentAttributes {
                frame_vectors: if tangents { all.frame_vectors } else { none.frame_vectors },
                uv: if uv { all.uv } else { none.uv },
                duv: if uv && duv { all.duv } else { none.duv },
                ..all
            };
            assert_eq!(of(Needs { tangents, uv, duv }), expected, "at {x}, {y}");
        }
    }
}

#[test]
fn back_faces_are_drawn_with_the_same_attributes() {
    let mut random = Random::new(41);
    let corners =
        [0; 3].map(|_| vertex(random.vector(1.5), random.vector(1.0), DVec2::new(random.real(0.0, 1.0), 0.5)));
    let [front, back] = [[0, 1, 2], [2, 1, 0]]
        .map(|triangle| View::new(&camera(64, 64), vec![object(corners.to_vec(), vec![triangle])]));
    let samples = front.visible(PIXEL_CENTRE_SUBPX);
    assert!(!samples.is_empty());
    assert_eq!(samples, back.visible(PIXEL_CENTRE_SUBPX));
    for (x, y, _) in samples {
        let [a, b] = [&front, &back].map(|view| view.triangle(0).fragment(x, y));
        let (n, m) = (vector_value(a.normal), vector_value(b.normal));
        // Only the order of float64 operations differs.
        assert!((n - m).length() <= n.length() * 2f64.powi(-28), "{n} {m}");
    }
}
