//! The rasteriser against ray–plane intersection in float64, and its hard cases.

use fixed::types::{I2F30, U0F32};
use glam::{DVec2, DVec3};
use roughxel_core::ports::{BlockPair, BlockPort, BlockVector, Port};
use roughxel_shader::{AttributeRows, BlockRows, Derivatives, FragmentAttributes, Needs};
use roughxel_simd::{Backend, InstructionSet, LANES};

use super::edges::{Places, TileBuffer};
use super::setup::Drawn;
use super::*;
use roughxel_scene::{Camera, Deviation, FrameSystem, Material, Mesh, Object, Vertex};
use roughxel_utilities::random::SplitMix64;

/// Seeded random numbers and vectors.
struct Random(SplitMix64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    fn next(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform in [low, high).
    fn real(&mut self, low: f64, high: f64) -> f64 {
        self.0.uniform(low, high)
    }

    fn vector(&mut self, reach: f64) -> DVec3 {
        DVec3::new(self.real(-reach, reach), self.real(-reach, reach), self.real(-reach, reach))
    }
}

fn camera(width: u32, height: u32) -> Camera {
    Camera {
        eye: DVec3::new(0.3, 0.2, 5.0),
        target: DVec3::new(0.1, -0.1, 0.0),
        up: DVec3::Y,
        fov_y_degrees: 40.0,
        width,
        height,
    }
}

/// Looks along −z from the origin; at w = height/2 a world unit is a pixel.
fn plain_camera(width: u32, height: u32) -> Camera {
    Camera { eye: DVec3::ZERO, target: DVec3::new(0.0, 0.0, -1.0), up: DVec3::Y, fov_y_degrees: 90.0, width, height }
}

fn vertex(position: DVec3, normal: DVec3, uv: DVec2) -> Vertex {
    Vertex { position, normal, uv, tangents: [DVec3::new(0.5, uv.x, 1.0), DVec3::new(uv.y, -2.0, 0.25)] }
}

fn object(vertices: Vec<Vertex>, triangles: Vec<[u32; 3]>) -> Object {
    Object {
        name: "test".into(),
        mesh: Mesh { vertices, triangles },
        material: Material {
            colour: [1.0; 3],
            colour_map: None,
            bump: None,
            roughness: None,
            frame: FrameSystem::MainDirection,
            main_direction: DVec3::Y,
            deviation: Deviation::default(),
            two_lobes: None,
            footprint: None,
            reflectance: [0.0; 3],
            highlight: None,
            peaks: None,
        },
    }
}

fn one_triangle(corners: [Vertex; 3]) -> Vec<Object> {
    vec![object(corners.to_vec(), vec![[0, 1, 2]])]
}

fn vector_value(v: BlockVector) -> DVec3 {
    let [x, y, z] = v.mantissa.map(|m| f64::from(m.to_bits()));
    DVec3::new(x, y, z) * 2f64.powi(i32::from(v.exponent) - 30)
}

fn pair_value(v: BlockPair) -> DVec2 {
    let [x, y] = v.mantissa.map(|m| f64::from(m.to_bits()));
    DVec2::new(x, y) * 2f64.powi(i32::from(v.exponent) - 30)
}

/// Ray of a screen position in pixels, of unit extent along the line of sight times z₀.
fn ray(camera: &Camera, x: f64, y: f64) -> DVec3 {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let focal = f64::from(camera.height) / 2.0 / (camera.fov_y_degrees.to_radians() / 2.0).tan();
    (x - f64::from(camera.width) / 2.0) * right - (y - f64::from(camera.height) / 2.0) * up + focal * forward
}

/// Barycentric coordinates and w where the ray of (x, y) meets the plane of a triangle.
fn intersect(camera: &Camera, corners: &[Vertex; 3], x: f64, y: f64) -> ([f64; 3], f64) {
    let [a, b, c] = corners.map(|v| v.position - camera.eye);
    let direction = ray(camera, x, y);
    let (ab, ac) = (b - a, c - a);
    let determinant = ab.dot(direction.cross(ac));
    let beta = -a.dot(direction.cross(ac)) / determinant;
    let gamma = direction.dot((-a).cross(ab)) / determinant;
    let hit = a + beta * ab + gamma * ac;
    let w = hit.dot((camera.target - camera.eye).normalize());
    ([1.0 - beta - gamma, beta, gamma], w)
}

fn blend<T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>>(share: [f64; 3], values: [T; 3]) -> T {
    values[0] * share[0] + values[1] * share[1] + values[2] * share[2]
}

fn uv_at(camera: &Camera, corners: &[Vertex; 3], x: f64, y: f64) -> DVec2 {
    blend(intersect(camera, corners, x, y).0, corners.map(|v| v.uv))
}

/// Central difference with one step of Richardson's extrapolation: error of order h⁴.
fn derivative(f: impl Fn(f64) -> DVec2, h: f64) -> DVec2 {
    let central = |h: f64| (f(h) - f(-h)) / (2.0 * h);
    (central(h / 2.0) * 4.0 - central(h)) / 3.0
}

/// Distance of two coordinates modulo 1.
fn wrapped_distance(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(1.0);
    d.min(1.0 - d)
}

/// What is visible at places of the pixels of a part of the frame.
struct Seen {
    drawn: Drawn,
    buffer: TileBuffer,
}

impl Seen {
    fn of(list: &TriangleList<'_>, tile: TileRect, places: &[[i32; 2]]) -> Self {
        let (mut drawn, mut buffer) = (Drawn::default(), TileBuffer::default());
        list.drawn(tile, &mut drawn);
        list.draw(&drawn, &Places::new(places), tile, &mut buffer);
        Self { drawn, buffer }
    }

    /// The triangle at a place of a pixel of the frame, and its depth.
    fn at(&self, x: u32, y: u32, place: usize) -> Option<(u32, i64)> {
        let (number, depth) = self.buffer.at(x, y, place)?;
        Some((self.drawn.triangles[number as usize], depth))
    }
}

/// Every covered sample of the whole frame, as (x, y, triangle).
fn visible(list: &TriangleList<'_>, projection: &Projection, offset: [i32; 2]) -> Vec<(i32, i32, u32)> {
    let mut samples = Vec::new();
    for tile in tiles(projection.width(), projection.height()) {
        let seen = Seen::of(list, tile, &[offset]);
        for y in tile.y..tile.y + tile.height {
            for x in tile.x..tile.x + tile.width {
                if let Some((triangle, _)) = seen.at(x, y, 0) {
                    samples.push((x as i32 * SUBPIXELS + offset[0], y as i32 * SUBPIXELS + offset[1], triangle));
                }
            }
        }
    }
    samples
}

fn pixels(subpixels: i32) -> f64 {
    f64::from(subpixels) / f64::from(SUBPIXELS)
}

/// Checks every attribute of every visible sample of one triangle; returns how many samples there were.
fn check_against_rays(camera: &Camera, corners: [Vertex; 3]) -> usize {
    let projection = Projection::new(camera).expect("a camera");
    let objects = one_triangle(corners);
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let samples = visible(&list, &projection, [77, 201]);
    let Some(triangle) = list.triangle(0, Needs::ALL) else {
        assert!(samples.is_empty());
        return 0;
    };
    // One scale of n for the whole triangle: from the first sample that has one.
    let mut scale = None;
    let longest_tangent = corners.iter().flat_map(|v| v.tangents).map(DVec3::length).fold(0.0, f64::max);
    for &(xs, ys, _) in &samples {
        let (x, y) = (pixels(xs), pixels(ys));
        let fragment = triangle.fragment(xs, ys);
        let (share, w) = intersect(camera, &corners, x, y);

        let of_corners = corners.map(|v| v.normal.normalize());
        // A flat triangle has the normal of its corners, of one length everywhere.
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
            // Measured 2^-24 where the difference quotient of the reference is worst; the bar of the design is 2^-16.
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
        // Edge-on triangles have their own test: here the reference itself must be well conditioned.
        let facing = (b - a).cross(c - a).dot(a - camera.eye).abs();
        if facing > 0.3 {
            samples += check_against_rays(&camera, corners);
        }
    }
    assert!(samples > 20_000, "{samples}");
}

/// Ground at y = −1 under a level camera, from behind the eye to w = `far`.
fn ground(far: f64, repeats: f64) -> [Vertex; 3] {
    [
        vertex(DVec3::new(-3.0 * far, -1.0, 2.0), DVec3::Y, DVec2::new(0.0, 0.0)),
        vertex(DVec3::new(3.0 * far, -1.0, 2.0), DVec3::Y, DVec2::new(repeats, 0.0)),
        vertex(DVec3::new(0.0, -1.0, -far), DVec3::Y, DVec2::new(0.5 * repeats, repeats)),
    ]
}

#[test]
fn ground_plane_to_the_horizon_keeps_a_256th_of_a_texel() {
    // 64 repeats of a 1024² map, w from about 1 to 1000.
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
    let projection = Projection::new(&plain_camera(320, 200)).expect("a camera");
    let tangents = [DVec3::new(0.3, 0.0, 0.1), DVec3::new(-0.1, 0.0, 0.7)];
    let corners = ground(300.0, 8.0).map(|corner| Vertex { normal: DVec3::new(0.1, 1.0, -0.2), tangents, ..corner });
    let objects = one_triangle(corners);
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let triangle = list.triangle(0, Needs::ALL).expect("visible");
    let samples = visible(&list, &projection, [128, 128]);
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
    let camera = camera(128, 128);
    let projection = Projection::new(&camera).expect("a camera");
    let objects = one_triangle([
        vertex(DVec3::new(-2.0, -1.5, 0.5), DVec3::new(-1.0, 0.0, 0.2), DVec2::ZERO),
        vertex(DVec3::new(2.0, -1.5, -1.0), DVec3::new(1.0, 0.1, 0.3), DVec2::X),
        vertex(DVec3::new(0.0, 1.8, 0.0), DVec3::new(0.2, 1.0, 0.1), DVec2::Y),
    ]);
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let triangle = list.triangle(0, Needs { tangents: false, ..Needs::ALL }).expect("visible");
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
    let projection = Projection::new(&plain_camera(640, 480)).expect("a camera");
    let v = |x: i32, y: i32| vector_value(projection.ray_view(x, y));
    // Seen along −z with y up: one pixel to the right turns the ray toward +x, so v toward −x; down: v toward +y.
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
    let projection = Projection::new(&camera).expect("a camera");
    let corners = [DVec3::new(-3.0, -1.0, -2.0), DVec3::new(4.0, -1.5, -9.0), DVec3::new(0.5, 2.5, -4.0)];
    let objects = one_triangle(corners.map(|corner| vertex(corner, DVec3::Z, DVec2::ZERO)));
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let triangle = list.triangle(0, Needs { tangents: false, ..Needs::ALL }).expect("visible");
    let plane = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let (mut seen, mut worst) = (0, 0.0_f64);
    for light in [DVec3::new(1.0, 3.0, 2.0), DVec3::new(0.0, 0.0, -3.0), DVec3::new(-500.0, 40.0, 1000.0)] {
        let point = triangle.point(light);
        for (x, y, _) in visible(&list, &projection, PIXEL_CENTRE_SUBPX) {
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
    let projection = Projection::new(&camera).expect("a camera");
    let (near_zero, far) = (one_triangle(corners), one_triangle(shifted));
    let near_zero = TriangleList::new(&projection, &near_zero).expect("a list");
    let far = TriangleList::new(&projection, &far).expect("a list");
    let (a, b) = (
        near_zero.triangle(0, Needs { tangents: false, ..Needs::ALL }).expect("seen"),
        far.triangle(0, Needs { tangents: false, ..Needs::ALL }).expect("seen"),
    );
    for (x, y, _) in visible(&near_zero, &projection, PIXEL_CENTRE_SUBPX) {
        assert_eq!(a.fragment(x, y).uv, b.fragment(x, y).uv);
        assert_eq!(a.fragment(x, y).duv, b.fragment(x, y).duv);
    }
}

#[test]
fn normals_pass_through_zero_between_opposite_corners() {
    let camera = plain_camera(129, 129);
    let projection = Projection::new(&camera).expect("a camera");
    // Parallel to the picture plane, so 1/w is constant and n vanishes on the middle column.
    let corner = |x: f64, y: f64, normal: DVec3| vertex(DVec3::new(x, y, -1.0), normal, DVec2::ZERO);
    let objects = vec![object(
        vec![
            corner(-0.5, -0.5, DVec3::NEG_X),
            corner(0.5, -0.5, DVec3::X),
            corner(0.5, 0.5, DVec3::X),
            corner(-0.5, 0.5, DVec3::NEG_X),
        ],
        vec![[0, 1, 2], [0, 2, 3]],
    )];
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let middle = 64 * SUBPIXELS + SUBPIXELS / 2;
    for (x, y, number) in visible(&list, &projection, PIXEL_CENTRE_SUBPX) {
        let triangle = list.triangle(number, Needs { tangents: false, ..Needs::ALL }).expect("visible");
        let fragment = triangle.fragment(x, y);
        let (n, dn) = (vector_value(fragment.normal), vector_value(fragment.dnormal[0]));
        // n grows by dn per pixel away from the middle, to the last bits on the way through zero.
        let distance = pixels(x - middle);
        // dn is rounded at 2^-31 and taken up to 32 pixels away.
        assert!((n - dn * distance).length() <= dn.length() * 2f64.powi(-22), "{n} {dn} {distance}");
        assert!(dn.x > 0.0);
    }
}

#[test]
fn clipping_changes_no_attribute() {
    // One affine map of u and v on a small triangle and on one that leaves the guard band and goes behind the eye.
    let uv_of = |p: DVec3| DVec2::new(0.25 * p.x, 0.125 * p.z);
    let build = |corners: [DVec3; 3]| one_triangle(corners.map(|p| vertex(p, DVec3::new(0.1, 1.0, -0.2), uv_of(p))));
    let inside = build([DVec3::new(-2.0, -1.0, -3.0), DVec3::new(2.0, -1.0, -3.0), DVec3::new(0.0, -1.0, -6.0)]);
    let beyond =
        build([DVec3::new(-900.0, -1.0, 300.0), DVec3::new(900.0, -1.0, 300.0), DVec3::new(0.0, -1.0, -500.0)]);
    let projection = Projection::new(&plain_camera(200, 200)).expect("a camera");
    let inside = TriangleList::new(&projection, &inside).expect("a list");
    let beyond = TriangleList::new(&projection, &beyond).expect("a list");
    let (a, b) = (
        inside.triangle(0, Needs { tangents: false, ..Needs::ALL }).expect("seen"),
        beyond.triangle(0, Needs { tangents: false, ..Needs::ALL }).expect("seen"),
    );
    let samples = visible(&inside, &projection, PIXEL_CENTRE_SUBPX);
    assert!(samples.len() > 300);
    for (x, y, _) in samples {
        let (small, large) = (a.fragment(x, y), b.fragment(x, y));
        assert_eq!(small.view, large.view);
        let [n, m] = [small, large].map(|f| vector_value(f.normal).normalize());
        // Rounding of two ports of 2^-31 per component.
        assert!((n - m).length() <= 2f64.powi(-28), "{n} {m}");
        for i in 0..2 {
            let (u_small, u_large) = (small.uv[i].to_num::<f64>(), large.uv[i].to_num::<f64>());
            // Both are rounded at 2^-33; the large triangle spans 450 repeats of 52-bit codes.
            assert!(wrapped_distance(u_small, u_large) <= 2f64.powi(-30));
            let error = (pair_value(small.duv[i]) - pair_value(large.duv[i])).length();
            // Rounding as for n.
            assert!(error <= pair_value(small.duv[i]).length() * 2f64.powi(-28));
        }
    }
}

#[test]
fn depth_agrees_with_distance_and_the_nearer_triangle_wins() {
    let camera = camera(160, 120);
    let projection = Projection::new(&camera).expect("a camera");
    let mut random = Random::new(5);
    let corners: Vec<Vertex> = (0..90).map(|_| vertex(random.vector(1.5), DVec3::Z, DVec2::ZERO)).collect();
    let triangles: Vec<[u32; 3]> = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let objects = vec![object(corners.clone(), triangles.clone())];
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let whole = TileRect { x: 0, y: 0, width: 160, height: 120 };
    let seen = Seen::of(&list, whole, &[PIXEL_CENTRE_SUBPX]);
    let mut covered = 0;
    for y in 0..120 {
        for x in 0..160 {
            let mut nearest = f64::INFINITY;
            let mut near_an_edge = false;
            for t in &triangles {
                let t = t.map(|i| corners[i as usize]);
                let (share, w) = intersect(&camera, &t, f64::from(x) + 0.5, f64::from(y) + 0.5);
                // Half a sub-pixel in barycentric terms is below 0.05 for all but slivers of this set.
                near_an_edge |= share.iter().fold(1.0_f64, |m, s| m.min(*s)).abs() < 0.05;
                if share.iter().all(|&s| s >= 0.0) {
                    nearest = nearest.min(w);
                }
            }
            if near_an_edge {
                continue;
            }
            let depth = seen.at(x, y, 0).map(|(_, depth)| depth);
            assert_eq!(depth.is_some(), nearest.is_finite(), "{x} {y}");
            if let Some(depth) = depth {
                covered += 1;
                let expected = projection.near() / nearest * 2f64.powi(56);
                // Coefficients are rounded to one step per sub-pixel: 160·256 steps at most, of 2^44 here.
                assert!((depth as f64 - expected).abs() <= 2f64.powi(17), "{depth} {expected}");
            }
        }
    }
    assert!(covered > 500, "{covered}");
}

#[test]
fn among_equal_depths_the_lower_triangle_wins_in_any_order_of_tiles() {
    let projection = Projection::new(&camera(130, 70)).expect("a camera");
    let quad = |offset: u32| [[offset, offset + 1, offset + 2], [offset, offset + 2, offset + 3]];
    let corners = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)]
        .map(|(x, y)| vertex(DVec3::new(x, y, 0.0), DVec3::Z, DVec2::ZERO));
    let vertices: Vec<Vertex> = corners.iter().chain(&corners).copied().collect();
    let objects = vec![object(vertices, [quad(4), quad(0)].concat())];
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let samples = visible(&list, &projection, PIXEL_CENTRE_SUBPX);
    assert_eq!(samples.len(), 130 * 70);
    assert!(samples.iter().all(|&(_, _, triangle)| triangle < 2));
    // One large rectangle instead of tiles: the same samples.
    let seen = Seen::of(&list, TileRect { x: 0, y: 0, width: 130, height: 70 }, &[PIXEL_CENTRE_SUBPX]);
    for (x, y, triangle) in samples {
        let pixel = |s: i32| (s >> SUBPIXEL_BITS) as u32;
        assert_eq!(seen.at(pixel(x), pixel(y), 0).map(|shown| shown.0), Some(triangle));
    }
}

/// How often each sample of a frame is covered by the triangles drawn one at a time.
fn coverage(projection: &Projection, vertices: &[Vertex], triangles: &[[u32; 3]], offset: [i32; 2]) -> Vec<u32> {
    let mut count = vec![0; (projection.width() * projection.height()) as usize];
    for &triangle in triangles {
        let objects = vec![object(vertices.to_vec(), vec![triangle])];
        let list = TriangleList::new(projection, &objects).expect("a list");
        for (x, y, _) in visible(&list, projection, offset) {
            count[((y >> SUBPIXEL_BITS) as u32 * projection.width() + (x >> SUBPIXEL_BITS) as u32) as usize] += 1;
        }
    }
    count
}

#[test]
fn fans_and_strips_cover_every_sample_exactly_once() {
    let mut random = Random::new(11);
    let projection = Projection::new(&plain_camera(48, 48)).expect("a camera");
    // At z = −24 a world unit is a pixel. Half of the corners lie exactly on pixel centres or sub-pixels.
    let mut corner = |x: f64, y: f64| {
        let (x, y) = match random.next() % 4 {
            0 => (x.floor() + 0.5, y.floor() + 0.5),
            1 => ((x * 256.0).round() / 256.0, (y * 256.0).round() / 256.0),
            _ => (x, y),
        };
        let depth = random.real(0.5, 3.0);
        vertex(DVec3::new(x, y, -24.0) * depth, DVec3::Z, DVec2::ZERO)
    };
    let mut choice = Random::new(12);
    for _ in 0..40 {
        // Fan: a ring far outside the frame around a point inside it.
        let centre = (choice.real(-20.0, 20.0), choice.real(-20.0, 20.0));
        let spokes = 3 + choice.next() % 9;
        let mut fan = vec![corner(centre.0, centre.1)];
        for i in 0..spokes {
            let angle = std::f64::consts::TAU * (i as f64 + choice.real(0.0, 0.4)) / spokes as f64;
            fan.push(corner(400.0 * angle.cos(), 400.0 * angle.sin()));
        }
        let spokes = spokes as u32;
        let triangles: Vec<[u32; 3]> = (0..spokes).map(|i| [0, 1 + i, 1 + (i + 1) % spokes]).collect();
        for offset in [PIXEL_CENTRE_SUBPX, [0, 0], [255, 13]] {
            let count = coverage(&projection, &fan, &triangles, offset);
            assert!(count.iter().all(|&n| n == 1), "fan {count:?}");
        }
        // Strip: rows of jittered corners, wider than the frame.
        let columns = 7;
        let mut strip = Vec::new();
        for row in 0..columns {
            for column in 0..columns {
                let border = |i: u32| i == 0 || i == columns - 1;
                let at = |i: u32, jitter: f64| (f64::from(i) - 3.0) * 10.0 + if border(i) { 0.0 } else { jitter };
                strip.push(corner(at(column, choice.real(-3.0, 3.0)), at(row, choice.real(-3.0, 3.0))));
            }
        }
        let mut triangles = Vec::new();
        for row in 0..columns - 1 {
            for column in 0..columns - 1 {
                let a = row * columns + column;
                triangles.push([a, a + 1, a + columns]);
                triangles.push([a + columns + 1, a + columns, a + 1]);
            }
        }
        let count = coverage(&projection, &strip, &triangles, PIXEL_CENTRE_SUBPX);
        assert!(count.iter().all(|&n| n == 1), "strip {count:?}");
    }
}

#[test]
fn a_clipped_room_around_the_eye_has_no_holes() {
    let mut random = Random::new(21);
    for _ in 0..60 {
        // A distorted cube around the eye: always some triangles cross the near plane or the guard band.
        let scale = 10f64.powf(random.real(-2.5, 4.0));
        let vertices: Vec<Vertex> = (0..8)
            .map(|i| {
                let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
                let corner = DVec3::new(sign(0), sign(1), sign(2)) + random.vector(0.3);
                vertex(corner * scale, DVec3::Z, DVec2::ZERO)
            })
            .collect();
        let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        let triangles: Vec<[u32; 3]> = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
        let camera = Camera { target: random.vector(1.0), ..plain_camera(64, 40) };
        let projection = Projection::new(&camera).expect("a camera");
        let objects = vec![object(vertices, triangles)];
        let list = TriangleList::new(&projection, &objects).expect("a list");
        let samples = visible(&list, &projection, PIXEL_CENTRE_SUBPX);
        assert_eq!(samples.len(), 64 * 40);
        for (x, y, number) in samples {
            // No setup may fail.
            assert!(list.triangle(number, Needs::ALL).is_some());
            let fragment = list.triangle(number, Needs::ALL).map(|t| t.fragment(x, y));
            assert!(fragment.is_some_and(|f| f.normal != BlockVector::default()));
        }
    }
}

#[test]
fn triangles_without_area_or_behind_the_eye_are_left_out() {
    let projection = Projection::new(&camera(64, 64)).expect("a camera");
    let at = |x: f64, y: f64, z: f64| vertex(DVec3::new(x, y, z), DVec3::Z, DVec2::ZERO);
    for corners in [
        [at(0.0, 0.0, 0.0), at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0)],
        [at(-1.0, -1.0, 0.0), at(0.0, 0.0, 0.0), at(1.0, 1.0, 0.0)],
        [at(-1.0, -1.0, 9.0), at(1.0, -1.0, 9.0), at(0.0, 1.0, 9.0)],
        [at(f64::NAN, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0)],
        [at(1e300, 0.0, 0.0), at(1.0, 1e300, 0.0), at(0.0, 1.0, -1e300)],
        [at(90.0, 0.0, 0.0), at(91.0, 0.0, 0.0), at(90.0, 1.0, 0.0)],
    ] {
        let objects = one_triangle(corners);
        let list = TriangleList::new(&projection, &objects).expect("a list");
        let samples = visible(&list, &projection, PIXEL_CENTRE_SUBPX);
        if let Some(triangle) = list.triangle(0, Needs::ALL) {
            // Only the one with huge coordinates may reach the frame; its attributes still exist.
            assert!(corners.iter().any(|v| v.position.x > 1e200));
            triangle.fragment(0, 0);
        } else {
            assert!(samples.is_empty(), "{corners:?}");
        }
    }
}

#[test]
fn slivers_seen_edge_on_stay_within_their_corners() {
    let camera = camera(200, 150);
    let projection = Projection::new(&camera).expect("a camera");
    let mut random = Random::new(31);
    let mut samples = 0;
    for i in 0..4000 {
        // All but coplanar with the eye, from 1e-2 down to 1e-14 of a world unit.
        let (a, b) = (random.vector(1.2), random.vector(1.2));
        let lift = 10f64.powi(-2 - i % 13);
        let c = camera.eye + (a * 0.4 + b * 0.6 - camera.eye) * random.real(0.6, 1.1) + random.vector(lift);
        let uv = [DVec2::new(0.1, 0.2), DVec2::new(0.3, 0.2), DVec2::new(0.2, 0.4)];
        let corners = [0, 1, 2].map(|k| vertex([a, b, c][k], DVec3::new(0.3, 0.1 * k as f64, 1.0), uv[k]));
        let objects = one_triangle(corners);
        let list = TriangleList::new(&projection, &objects).expect("a list");
        let seen = Seen::of(&list, TileRect { x: 0, y: 0, width: 200, height: 150 }, &[[9, 140]]);
        let range = corners
            .map(|v| projection.near() / (v.position - camera.eye).dot((camera.target - camera.eye).normalize()));
        let low = range.iter().fold(f64::INFINITY, |m, v| m.min(*v));
        let high = range.iter().fold(0.0_f64, |m, v| m.max(*v));
        for (x, y, number) in visible(&list, &projection, [9, 140]) {
            samples += 1;
            let (_, depth) = seen.at((x >> 8) as u32, (y >> 8) as u32, 0).expect("covered");
            let depth = depth as f64 / 2f64.powi(56);
            // One step of depth, and float64's rounding of w.
            assert!(depth >= low * (1.0 - 1e-12) && depth <= high * (1.0 + 1e-12), "{depth} {low} {high}");
            let fragment = list.triangle(number, Needs::ALL).expect("visible").fragment(x, y);
            // An eighth of the corners' range is what a sample half a sub-pixel outside may leave it by.
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

/// A lane of rows as [`FragmentAttributes`] has it.
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
        dview: Port::of(&derivatives.dview),
        dnormal: Port::of(&derivatives.dnormal),
        uv: rows.uv.map(|row| U0F32::from_bits(row[lane].cast_unsigned())),
        duv: rows.duv.map(|rows| block(&rows, lane)),
    }
}

#[test]
fn fragments_side_by_side_are_those_one_by_one_with_every_instruction_set() {
    let mut random = Random::new(51);
    let projection = Projection::new(&camera(96, 64)).expect("a camera");
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
        let objects = one_triangle(corners);
        let list = TriangleList::new(&projection, &objects).expect("a list");
        for bits in 0..8 {
            let needs = Needs { tangents: bits & 1 != 0, uv: bits & 2 != 0, duv: bits & 4 != 0 };
            let Some(triangle) = list.triangle(0, needs) else { continue };
            visible_triangles += 1;
            // In the frame, and beside it.
            let positions =
                [97, 65].map(|edge| [0; LANES].map(|_| random.real(-300.0, f64::from(edge) * 256.0) as i32));
            let derivatives = triangle.derivatives();
            let backends = InstructionSet::available().map(Backend::Simd).chain([Backend::Scalar]);
            for backend in backends {
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
    let camera = plain_camera(32, 32);
    let projection = Projection::new(&camera).expect("a camera");
    let objects = one_triangle(ground(50.0, 4.0));
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let samples = visible(&list, &projection, PIXEL_CENTRE_SUBPX);
    assert!(!samples.is_empty());
    for (x, y, number) in samples {
        let of = |needs| list.triangle(number, needs).expect("visible").fragment(x, y);
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
    let projection = Projection::new(&camera(64, 64)).expect("a camera");
    let mut random = Random::new(41);
    let corners =
        [0; 3].map(|_| vertex(random.vector(1.5), random.vector(1.0), DVec2::new(random.real(0.0, 1.0), 0.5)));
    let (front, back) = (one_triangle(corners), vec![object(corners.to_vec(), vec![[2, 1, 0]])]);
    let front = TriangleList::new(&projection, &front).expect("a list");
    let back = TriangleList::new(&projection, &back).expect("a list");
    let samples = visible(&front, &projection, PIXEL_CENTRE_SUBPX);
    assert!(!samples.is_empty());
    assert_eq!(samples, visible(&back, &projection, PIXEL_CENTRE_SUBPX));
    for (x, y, _) in samples {
        let (a, b) = (
            front.triangle(0, Needs { tangents: false, ..Needs::ALL }).expect("seen").fragment(x, y),
            back.triangle(0, Needs { tangents: false, ..Needs::ALL }).expect("seen").fragment(x, y),
        );
        let (n, m) = (vector_value(a.normal), vector_value(b.normal));
        // Only the order of float64 operations differs.
        assert!((n - m).length() <= n.length() * 2f64.powi(-28), "{n} {m}");
    }
}

#[test]
fn the_rows_of_the_tiles_are_the_frame() {
    for (width, height) in [(1, 1), (64, 64), (65, 1), (1, 200), (130, 129), (200, 64)] {
        let mut pixels = vec![[0; 2]; (width * height) as usize];
        let places = tile_rows(&mut pixels, width, height);
        assert!(places.iter().map(|(tile, _)| *tile).eq(tiles(width, height)));
        for (tile, rows) in places {
            assert_eq!(rows.len(), tile.height as usize);
            for (y, row) in (tile.y..).zip(rows) {
                assert_eq!(row.len(), tile.width as usize);
                (tile.x..).zip(row).for_each(|(x, pixel)| *pixel = [x, y]);
            }
        }
        let expected = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        assert!(pixels.into_iter().eq(expected), "{width}x{height}");
    }
}

#[test]
fn triangles_are_numbered_through_the_objects() {
    let projection = Projection::new(&camera(8, 8)).expect("a camera");
    let corner = vertex(DVec3::ZERO, DVec3::Z, DVec2::ZERO);
    let with = |count: usize| object(vec![corner], vec![[0; 3]; count]);
    let objects = vec![with(2), with(0), with(3)];
    let list = TriangleList::new(&projection, &objects).expect("a list");
    assert_eq!(list.len(), 5);
    assert_eq!((0..5).map(|t| list.object_index(t)).collect::<Vec<_>>(), [0, 0, 2, 2, 2]);
}

#[test]
fn impossible_cameras_and_indices_are_refused_with_a_remedy() {
    let good = camera(64, 64);
    assert!(Projection::new(&Camera { width: 0, ..good }).is_err());
    assert!(Projection::new(&Camera { height: MAX_EDGE_PX + 1, ..good }).is_err());
    // 2^26 pixels and no more, whatever their shape.
    assert!(Projection::new(&Camera { width: MAX_EDGE_PX, height: 4096, ..good }).is_ok());
    assert!(Projection::new(&Camera { width: MAX_EDGE_PX, height: 4097, ..good }).is_err());
    for fov_y_degrees in [0.0, -5.0, 180.0, f64::NAN, 1e-12] {
        assert!(matches!(Projection::new(&Camera { fov_y_degrees, ..good }), Err(RasterError::FieldOfView { .. })));
    }
    for orientation in [
        Camera { target: good.eye, ..good },
        Camera { up: good.target - good.eye, ..good },
        Camera { up: DVec3::ZERO, ..good },
        Camera { eye: DVec3::NAN, ..good },
    ] {
        assert!(matches!(Projection::new(&orientation), Err(RasterError::Orientation { .. })));
    }
    let projection = Projection::new(&good).expect("a camera");
    let objects = vec![object(vec![], vec![[0, 1, 2]])];
    let error = TriangleList::new(&projection, &objects).expect_err("no vertices");
    assert_eq!(error.to_string(), "object \"test\": triangle 0 names vertex 0, but the mesh has 0");
}

/// A sample of a frame of one tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shaded {
    pixel: usize,
    position: [i32; 2],
    triangle: Option<u32>,
    times: u32,
}

/// Samples of a frame of one tile, by pixel, and how many each pixel has.
fn samples(list: &TriangleList<'_>, tile: TileRect, sampling: Sampling) -> (Vec<Shaded>, Vec<u32>) {
    let mut counts = vec![0; (tile.width * tile.height) as usize];
    let mut shaded = Vec::new();
    // What another tile left there has to be gone.
    let mut samples = TileSamples::default();
    list.samples(TileRect { width: 3, height: 2, ..tile }, &Sampling::Objects.passes()[0], &mut samples);
    for pass in sampling.passes() {
        list.samples(tile, &pass, &mut samples);
        let by_triangle: Vec<_> = samples.by_triangle().collect();
        assert!(by_triangle.is_sorted_by_key(|(triangle, _)| triangle.unwrap_or(u32::MAX)), "by triangle");
        assert!(by_triangle.iter().all(|(_, shown)| !shown.is_empty()));
        for (triangle, shown) in by_triangle {
            shaded.extend(shown.iter().map(|&sample| {
                let (pixel, position) = (samples.pixel(sample) as usize, samples.position(sample));
                assert_eq!(samples.lines().nth(samples.line(sample)), Some(position[1]));
                Shaded { pixel, position, triangle, times: samples.times(sample) }
            }));
        }
        counts.iter_mut().zip(samples.counts()).for_each(|(sum, count)| *sum += count);
    }
    shaded.sort_by_key(|sample| (sample.pixel, sample.position));
    (shaded, counts)
}

/// One triangle after the other at one sample after the other, as the definitions say.
#[test]
fn samples_are_those_found_one_by_one_with_every_instruction_set() {
    let mut random = Random::new(77);
    let projection = Projection::new(&camera(150, 70)).expect("a camera");
    // Large ones in front of and behind small ones, so that lists of both are drawn in the order of the frame; some in one plane.
    let objects: Vec<Object> = (0..6)
        .map(|i| {
            let reach = if i % 2 == 0 { 9.0 } else { 0.6 };
            let corners: Vec<Vertex> = (0..45)
                .map(|_| {
                    let DVec3 { x, y, z } = random.vector(reach);
                    vertex(DVec3::new(x, y, if i < 3 { 0.0 } else { z.min(4.0) }), DVec3::Z, DVec2::ZERO)
                })
                .collect();
            object(corners, (0..15).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
        })
        .collect();
    let list = TriangleList::new(&projection, &objects).expect("a list");
    let place = |edge: u32, i: u32| ((2 * i + 1) * 256 / (2 * edge)) as i32;
    for tile in tiles(150, 70) {
        let mut alone = Vec::new();
        for triangle in 0..list.len() {
            let shown = list.object_index(triangle);
            let first = objects[..shown].iter().map(|object| object.mesh.triangles.len() as u32).sum::<u32>();
            let corners = objects[shown].mesh.triangles[(triangle - first) as usize];
            let one = [object(objects[shown].mesh.vertices.clone(), vec![corners])];
            let one = TriangleList::new(&projection, &one).expect("a list");
            let at = |edge: u32| {
                let places: Vec<_> = (0..edge * edge).map(|i| [place(edge, i % edge), place(edge, i / edge)]).collect();
                Seen::of(&one, tile, &places)
            };
            alone.push([1, 2, 3, 4, 5].map(at));
        }
        let backends = InstructionSet::available().map(Backend::Simd).chain([Backend::Scalar]);
        for (backend, (index, edge)) in backends.flat_map(|backend| (0..5).map(move |i| (backend, (i, i as u32 + 1)))) {
            let list = list.clone().with_backend(backend);
            let (found, counts) = samples(&list, tile, Sampling::Grid { edge });
            assert_eq!(counts, vec![edge * edge; counts.len()]);
            assert_eq!(found.len(), counts.len() * (edge * edge) as usize);
            for sample in found {
                let [x, y] = sample.position.map(|p| (p / SUBPIXELS) as u32);
                let [column, row] = sample.position.map(|p| (p % SUBPIXELS) as u32 * edge / 256);
                let mut nearest: Option<(u32, i64)> = None;
                for (triangle, seen) in (0..).zip(&alone) {
                    let depth = seen[index].at(x, y, (row * edge + column) as usize).map(|shown| shown.1);
                    if let Some(depth) = depth.filter(|&depth| nearest.is_none_or(|(_, other)| depth > other)) {
                        nearest = Some((triangle, depth));
                    }
                }
                assert_eq!(sample.triangle, nearest.map(|shown| shown.0), "{backend}, {edge}: {x}, {y}");
            }
        }
    }
}

#[test]
fn samples_of_a_pixel_count_as_often_as_it_has_samples() {
    let mut random = Random::new(15);
    let projection = Projection::new(&camera(64, 48)).expect("a camera");
    let tile = TileRect { x: 0, y: 0, width: 64, height: 48 };
    let mut edges = 0;
    for _ in 0..40 {
        let mut triangle = || {
            let corners = [0; 3].map(|_| vertex(random.vector(1.5), DVec3::Z, DVec2::ZERO));
            object(corners.to_vec(), vec![[0, 1, 2]])
        };
        let objects = vec![triangle(), triangle(), triangle()];
        let list = TriangleList::new(&projection, &objects).expect("a list");
        let (found, counts) = samples(&list, tile, Sampling::Objects);
        let mut sums = vec![0; counts.len()];
        let centres = samples(&list, tile, Sampling::Grid { edge: 1 }).0;
        for sample in &found {
            sums[sample.pixel] += sample.times;
            if counts[sample.pixel] == 1 {
                assert_eq!(*sample, centres[sample.pixel], "one object alone is shaded at the centre");
            }
            // What is shaded is seen where it is shaded.
            let [x, y] = sample.position;
            let pixel = TileRect { x: x as u32 / 256, y: y as u32 / 256, width: 1, height: 1 };
            let seen = Seen::of(&list, pixel, &[[x & 255, y & 255]]);
            assert_eq!(seen.at(pixel.x, pixel.y, 0).map(|shown| shown.0), sample.triangle);
        }
        assert_eq!(sums, counts);
        assert!(counts.iter().all(|count| [1, 8].contains(count)));
        edges += counts.iter().filter(|count| **count == 8).count();
    }
    assert!(edges > 1000, "{edges}");
}

/// The share of an edge's pixel that is covered, to an eighth, and without a bias.
#[test]
fn an_edge_covers_the_share_that_lies_on_its_side() {
    let projection = Projection::new(&plain_camera(64, 64)).expect("a camera");
    let tile = TileRect { x: 0, y: 0, width: 64, height: 64 };
    for degrees in [0.0_f64, 3.0, 20.0, 45.0, 71.0, 90.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        // Half of the picture, and what lies beyond it.
        let at = |along: f64, across: f64| DVec3::new(cos * along - sin * across, sin * along + cos * across, -32.0);
        let far = 400.0;
        let corners = [at(-far, 0.37), at(far, 0.37), at(0.0, far)].map(|p| vertex(p, DVec3::Z, DVec2::ZERO));
        let objects = one_triangle(corners);
        let list = TriangleList::new(&projection, &objects).expect("a list");
        let (found, counts) = samples(&list, tile, Sampling::Objects);
        let (mut worst, mut sum) = (0.0_f64, 0.0);
        for sample in found.iter().filter(|sample| sample.triangle.is_some()) {
            let got = f64::from(sample.times) / f64::from(counts[sample.pixel]);
            let [x, y] = [sample.pixel % 64, sample.pixel / 64].map(|pixel| pixel as f64);
            let inside = (0..4096)
                .filter(|i| {
                    let (x, y) =
                        (x + (f64::from(i % 64) + 0.5) / 64.0 - 32.0, 32.0 - y - (f64::from(i / 64) + 0.5) / 64.0);
                    cos * y - sin * x > 0.37
                })
                .count();
            let want = inside as f64 / 4096.0;
            worst = worst.max((got - want).abs());
            sum += got - want;
        }
        assert!(worst <= 0.2, "{degrees}°: {worst}");
        assert!(sum.abs() < 3.0, "{degrees}°: {sum} pixels in all");
    }
}
