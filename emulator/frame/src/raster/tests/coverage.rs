//! Visible triangle of each sample.

use super::*;

#[test]
fn depth_agrees_with_distance_and_the_nearer_triangle_wins() {
    let camera = camera(160, 120);
    let mut random = Random::new(5);
    let corners: Vec<Vertex> = (0..90).map(|_| vertex(random.vector(1.5), DVec3::Z, DVec2::ZERO)).collect();
    let triangles: Vec<[u32; 3]> = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let view = View::new(&camera, vec![object(corners.clone(), triangles.clone())]);
    let seen = Seen::draw(&view.list, whole(160, 120), &[PIXEL_CENTRE_SUBPX]);
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
                let expected = view.projection.near() / nearest * 2f64.powi(56);
                // Coefficients are rounded to one step per sub-pixel: 160·256 steps at most, of 2^44 here.
                assert!((depth as f64 - expected).abs() <= 2f64.powi(17), "{depth} {expected}");
            }
        }
    }
    assert!(covered > 500, "{covered}");
}

#[test]
fn among_equal_depths_the_lower_triangle_wins_in_any_order_of_tiles() {
    let quad = |offset: u32| [[offset, offset + 1, offset + 2], [offset, offset + 2, offset + 3]];
    let corners = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)]
        .map(|(x, y)| vertex(DVec3::new(x, y, 0.0), DVec3::Z, DVec2::ZERO));
    let vertices: Vec<Vertex> = corners.iter().chain(&corners).copied().collect();
    let view = View::new(&camera(130, 70), vec![object(vertices, [quad(4), quad(0)].concat())]);
    let samples = view.visible(PIXEL_CENTRE_SUBPX);
    assert_eq!(samples.len(), 130 * 70);
    assert!(samples.iter().all(|&(_, _, triangle)| triangle < 2));
    // One large rectangle instead of tiles gives the same samples.
    let seen = Seen::draw(&view.list, whole(130, 70), &[PIXEL_CENTRE_SUBPX]);
    for (x, y, triangle) in samples {
        let pixel = |s: i32| (s >> SUBPIXEL_BITS) as u32;
        assert_eq!(seen.at(pixel(x), pixel(y), 0).map(|shown| shown.0), Some(triangle));
    }
}

/// Number of times each sample of a frame is covered by the triangles, drawn one at a time.
fn coverage(camera: &Camera, vertices: &[Vertex], triangles: &[[u32; 3]], offset: [i32; 2]) -> Vec<u32> {
    let mut count = vec![0; (camera.width * camera.height) as usize];
    for &triangle in triangles {
        for (x, y, _) in View::new(camera, vec![object(vertices.to_vec(), vec![triangle])]).visible(offset) {
            count[((y >> SUBPIXEL_BITS) as u32 * camera.width + (x >> SUBPIXEL_BITS) as u32) as usize] += 1;
        }
    }
    count
}

#[test]
fn fans_and_strips_cover_every_sample_exactly_once() {
    let mut random = Random::new(11);
    let camera = &plain_camera(48, 48);
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
        // A fan: a ring far outside the frame around a point inside it.
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
            let count = coverage(camera, &fan, &triangles, offset);
            assert!(count.iter().all(|&n| n == 1), "fan {count:?}");
        }
        // A strip: rows of jittered corners, wider than the frame.
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
        let count = coverage(camera, &strip, &triangles, PIXEL_CENTRE_SUBPX);
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
        let view = View::new(&camera, vec![object(vertices, triangles)]);
        let samples = view.visible(PIXEL_CENTRE_SUBPX);
        assert_eq!(samples.len(), 64 * 40);
        for (x, y, number) in samples {
            // Setup may not fail.
            let fragment = view.list.triangle(number, Needs::ALL).map(|t| t.fragment(x, y));
            assert!(fragment.is_some_and(|f| f.normal != BlockVector::default()));
        }
    }
}

#[test]
fn triangles_without_area_or_behind_the_eye_are_left_out() {
    let at = |x: f64, y: f64, z: f64| vertex(DVec3::new(x, y, z), DVec3::Z, DVec2::ZERO);
    for corners in [
        [at(0.0, 0.0, 0.0), at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0)],
        [at(-1.0, -1.0, 0.0), at(0.0, 0.0, 0.0), at(1.0, 1.0, 0.0)],
        [at(-1.0, -1.0, 9.0), at(1.0, -1.0, 9.0), at(0.0, 1.0, 9.0)],
        [at(f64::NAN, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0)],
        [at(1e300, 0.0, 0.0), at(1.0, 1e300, 0.0), at(0.0, 1.0, -1e300)],
        [at(90.0, 0.0, 0.0), at(91.0, 0.0, 0.0), at(90.0, 1.0, 0.0)],
    ] {
        let view = View::new(&camera(64, 64), one_triangle(corners));
        let samples = view.visible(PIXEL_CENTRE_SUBPX);
        if let Some(triangle) = view.list.triangle(0, Needs::ALL) {
            // Only the triangle with huge coordinates may reach the frame; its attributes still exist.
            assert!(corners.iter().any(|v| v.position.x > 1e200));
            triangle.fragment(0, 0);
        } else {
            assert!(samples.is_empty(), "{corners:?}");
        }
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
    let corner = vertex(DVec3::ZERO, DVec3::Z, DVec2::ZERO);
    let with = |count: usize| object(vec![corner], vec![[0; 3]; count]);
    let list = View::new(&camera(8, 8), vec![with(2), with(0), with(3)]).list;
    assert_eq!(list.len(), 5);
    assert_eq!((0..5).map(|t| list.object_index(t)).collect::<Vec<_>>(), [0, 0, 2, 2, 2]);
}

#[test]
fn impossible_cameras_and_indices_are_refused_with_a_remedy() {
    let good = camera(64, 64);
    assert!(Projection::new(&Camera { width: 0, ..good }).is_err());
    assert!(Projection::new(&Camera { height: MAX_EDGE_PX + 1, ..good }).is_err());
    // At most 2^26 pixels, in any shape.
    assert!(Projection::new(&Camera { width: MAX_EDGE_PX, height: 4096, ..good }).is_ok());
    assert!(Projection::new(&Camera { width: MAX_EDGE_PX, height: 4097, ..good }).is_err());
    for fov_y_degrees in [0.0, -5.0, 180.0, f64::NAN, 1e-12] {
        let error = Projection::new(&Camera { fov_y_degrees, ..good }).expect_err("no angle of view");
        assert_eq!(
            error.to_string(),
            format!("camera: an angle of view of {fov_y_degrees}°; give more than 0 and less than 180")
        );
    }
    for orientation in [
        Camera { target: good.eye, ..good },
        Camera { up: good.target - good.eye, ..good },
        Camera { up: DVec3::ZERO, ..good },
        Camera { eye: DVec3::NAN, ..good },
    ] {
        let error = Projection::new(&orientation).expect_err("no view").to_string();
        assert!(error.ends_with("up must not lie along the line of sight"), "{error}");
    }
    let projection = Projection::new(&good).expect("the camera is valid");
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

/// Samples of a frame of one tile, by pixel, and the number of samples of each pixel.
fn samples(list: &TriangleList<'_>, tile: TileRect, sampling: Sampling) -> (Vec<Shaded>, Vec<u32>) {
    let mut counts = vec![0; (tile.width * tile.height) as usize];
    let mut shaded = Vec::new();
    // Samples of an earlier tile have to disappear.
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

/// Draws one triangle at a time at one sample at a time, as the definitions say.
#[test]
fn samples_are_those_found_one_by_one_with_every_instruction_set() {
    let mut random = Random::new(77);
    let camera = &camera(150, 70);
    // Large triangles in front of and behind small ones, so that each list is drawn in the order of the frame; some are coplanar.
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
    let list = View::new(camera, objects.clone()).list;
    let place = |edge: u32, i: u32| ((2 * i + 1) * 256 / (2 * edge)) as i32;
    for tile in tiles(150, 70) {
        let mut alone = Vec::new();
        for triangle in 0..list.len() {
            let shown = list.object_index(triangle);
            let first = objects[..shown].iter().map(|object| object.mesh.triangles.len() as u32).sum::<u32>();
            let corners = objects[shown].mesh.triangles[(triangle - first) as usize];
            let one = View::new(camera, vec![object(objects[shown].mesh.vertices.clone(), vec![corners])]).list;
            let at = |edge: u32| {
                let places: Vec<_> = (0..edge * edge).map(|i| [place(edge, i % edge), place(edge, i / edge)]).collect();
                Seen::draw(&one, tile, &places)
            };
            alone.push([1, 2, 3, 4, 5].map(at));
        }
        for (backend, (index, edge)) in backends().flat_map(|backend| (0..5).map(move |i| (backend, (i, i as u32 + 1))))
        {
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
    let tile = whole(64, 48);
    let mut edges = 0;
    for _ in 0..40 {
        let mut triangle = || {
            let corners = [0; 3].map(|_| vertex(random.vector(1.5), DVec3::Z, DVec2::ZERO));
            object(corners.to_vec(), vec![[0, 1, 2]])
        };
        let list = View::new(&camera(64, 48), vec![triangle(), triangle(), triangle()]).list;
        let (found, counts) = samples(&list, tile, Sampling::Objects);
        let mut sums = vec![0; counts.len()];
        let centres = samples(&list, tile, Sampling::Grid { edge: 1 }).0;
        for sample in &found {
            sums[sample.pixel] += sample.times;
            if counts[sample.pixel] == 1 {
                assert_eq!(*sample, centres[sample.pixel], "one object alone is shaded at the centre");
            }
            // A shaded sample is visible at its position.
            let [x, y] = sample.position;
            let pixel = TileRect { x: x as u32 / 256, y: y as u32 / 256, width: 1, height: 1 };
            let seen = Seen::draw(&list, pixel, &[[x & 255, y & 255]]);
            assert_eq!(seen.at(pixel.x, pixel.y, 0).map(|shown| shown.0), sample.triangle);
        }
        assert_eq!(sums, counts);
        assert!(counts.iter().all(|count| [1, 8].contains(count)));
        edges += counts.iter().filter(|count| **count == 8).count();
    }
    assert!(edges > 1000, "{edges}");
}

/// An edge's coverage of its pixel is right to an eighth, without a bias.
#[test]
fn an_edge_covers_the_share_that_lies_on_its_side() {
    let tile = whole(64, 64);
    for degrees in [0.0_f64, 3.0, 20.0, 45.0, 71.0, 90.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        // Half of the picture, and the area beyond it.
        let at = |along: f64, across: f64| DVec3::new(cos * along - sin * across, sin * along + cos * across, -32.0);
        let far = 400.0;
        let corners = [at(-far, 0.37), at(far, 0.37), at(0.0, far)].map(|p| vertex(p, DVec3::Z, DVec2::ZERO));
        let list = View::new(&plain_camera(64, 64), one_triangle(corners)).list;
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
