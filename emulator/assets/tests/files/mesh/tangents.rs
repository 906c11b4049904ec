//! Frames of normal maps against MikkTSpace's definition, computed in float64.

use std::path::Path;

use glam::{DVec2, DVec3};

use roughxel_assets::{Mesh, ReadOptions, Tangents, Vertex, parse_obj};

fn mikktspace(text: &str) -> Mesh {
    let options = ReadOptions { tangents: Tangents::MikkTSpace, ..ReadOptions::default() };
    parse_obj(Path::new("test.obj"), text, &options).unwrap().mesh
}

/// Normal that a normal map's (x, y, z) gives in S97's system 2: axes n × p_v and p_u × n of length 1, slopes negated.
fn mapped(vertex: &Vertex, [x, y, z]: [f64; 3]) -> DVec3 {
    let s_u = vertex.normal.cross(vertex.tangents[1]).normalize();
    let s_v = vertex.tangents[0].cross(vertex.normal).normalize();
    (vertex.normal * z - s_u * x - s_v * y).normalize()
}

fn degrees(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// Square in the plane of x and y whose u and v run along two directions, placed at `origin`.
fn chart(along_u: DVec2, along_v: DVec2, origin: DVec3, normal: &str) -> String {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    // (x, y) = u along_u + v along_v, solved for u and v.
    let determinant = along_u.perp_dot(along_v);
    let uv = corners.map(|p| [p.perp_dot(along_v) / determinant, along_u.perp_dot(p) / determinant]);
    let mut text: String = corners.map(|p| format!("v {} {} {}\n", p.x + origin.x, p.y + origin.y, origin.z)).concat();
    text += &uv.map(|[u, v]| format!("vt {u} {v}\n")).concat();
    text + normal + "f 1/1/1 2/2/1 3/3/1 4/4/1\n"
}

#[test]
fn plain_turned_sheared_and_mirrored_charts_are_right_within_a_fifth_of_a_degree() {
    let turned = |angle: f64| DVec2::from_angle(angle.to_radians());
    for (along_u, along_v) in [
        (DVec2::X, DVec2::Y),
        (turned(90.0), turned(180.0)),
        (turned(37.0), turned(127.0)),
        (turned(-153.0), turned(-63.0)),
        (DVec2::X, DVec2::new(-0.5, 1.0)),
        (DVec2::X, DVec2::new(0.5, 1.0)),
        (DVec2::X, DVec2::new(2.0, 1.0)),
        (turned(20.0), turned(150.0)),
        (turned(200.0) * 3.0, turned(245.0) * 0.2),
        (DVec2::NEG_X, DVec2::Y),
        (DVec2::NEG_X, DVec2::new(0.5, 1.0)),
        (DVec2::X, DVec2::new(0.3, -1.0)),
        (turned(70.0), turned(-50.0)),
        (turned(10.0), turned(-30.0) * 5.0),
        (turned(-100.0) * 0.01, turned(-200.0) * 0.02),
    ] {
        for origin in [DVec3::ZERO, DVec3::new(450_000.0, -51_000.0, 7.0)] {
            for normal in ["vn 0 0 1\n", "vn 0 0 0\n"] {
                let mesh = mikktspace(&chart(along_u, along_v, origin, normal));
                let t = along_u.normalize().extend(0.0);
                let b = DVec3::Z.cross(t) * along_u.perp_dot(along_v).signum();
                for [x, y] in [[0.5, 0.2], [-0.3, 0.6], [0.0, 0.7], [0.9, 0.0]] {
                    let z = libm::sqrt(1.0 - x * x - y * y);
                    let expected = x * t + y * b + z * DVec3::Z;
                    for vertex in &mesh.vertices {
                        let off = degrees(mapped(vertex, [x, y, z]), expected);
                        assert!(off < 0.05, "{along_u} {along_v}: off by {off}");
                    }
                }
            }
        }
    }
}

/// A tent of four triangles around a top with one normal; MikkTSpace weighs tangents there by the angles of the triangles.
#[test]
fn tangents_are_means_by_angle_of_projected_directions() {
    for (height, top) in [(0.5, [0.0, 0.0]), (1.0, [0.3, -0.2]), (0.2, [-0.6, 0.5]), (2.0, [0.1, 0.7])] {
        let base = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let peak = DVec3::new(top[0], top[1], height);
        let normal = DVec3::new(0.1, -0.2, 1.0).normalize();
        // Sheared and uneven texture coordinates.
        let uv = |p: DVec3| DVec2::new(p.x + 0.4 * p.y + 0.2 * p.z, 1.3 * p.y - 0.5 * p.z);
        let mut text = String::new();
        for point in base.into_iter().chain([peak]) {
            text += &format!("v {} {} {}\nvt {} {}\n", point.x, point.y, point.z, uv(point).x, uv(point).y);
        }
        text += &format!("vn {} {} {}\n", normal.x, normal.y, normal.z);
        for side in 0..4 {
            let [a, b] = [side + 1, (side + 1) % 4 + 1];
            text += &format!("f {a}/{a}/1 {b}/{b}/1 5/5/1\n");
        }
        let mesh = mikktspace(&text);
        let project = |v: DVec3| (v - normal * v.dot(normal)).normalize();
        let mut sum = DVec3::ZERO;
        for side in 0..4 {
            let [a, b] = [base[side] - peak, base[(side + 1) % 4] - peak];
            let [s, t] = [uv(base[side]) - uv(peak), uv(base[(side + 1) % 4]) - uv(peak)];
            let along_u = (a * t.y - b * s.y) / s.perp_dot(t);
            sum += project(along_u) * project(a).angle_between(project(b));
        }
        let t = sum.normalize();
        let vertex = mesh.vertices.iter().find(|vertex| vertex.position == peak).unwrap();
        let found = mapped(vertex, [0.6, 0.0, 0.8]);
        let off = degrees(found, 0.6 * t + 0.8 * normal);
        assert!(off < 0.05, "{top:?}: off by {off}");
        assert!(degrees(mapped(vertex, [0.0, 0.6, 0.8]), 0.6 * normal.cross(t) + 0.8 * normal) < 0.05);
    }
}

#[test]
fn vertices_between_mirrored_charts_are_split_and_vertices_without_a_direction_keep_one() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 3 0 0\nv 3 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
                f 1/1 2/2 3/3 4/4\nf 2/2 5/1 6/4 3/3\nf 5/2 7/2 8/2 6/2\n";
    let mesh = mikktspace(text);
    for triangle in &mesh.triangles {
        let corners = triangle.map(|index| mesh.vertices[index as usize]);
        let middle = corners.iter().map(|vertex| vertex.position.x).sum::<f64>() / 3.0;
        for vertex in corners {
            assert!(vertex.tangents.iter().all(|tangent| (tangent.length() - 1.0).abs() < 1e-6), "{vertex:?}");
            let tilted = mapped(&vertex, [0.6, 0.0, 0.8]);
            if middle < 2.0 {
                assert!(tilted.x * if middle < 1.0 { 1.0 } else { -1.0 } > 0.59, "{vertex:?}: {tilted}");
            }
        }
    }
}

#[test]
fn scaled_meshes_keep_the_tangent_and_a_right_angle() {
    let mut mesh = mikktspace(&chart(DVec2::NEG_X, DVec2::new(0.5, 1.0), DVec3::ZERO, "vn 1 1 4\n"));
    let scale = DVec3::new(3.0, 0.5, 1.7);
    let before = mesh.vertices.clone();
    for vertex in &mut mesh.vertices {
        vertex.normal = (vertex.normal / scale).normalize();
        vertex.tangents = vertex.tangents.map(|tangent| tangent * scale);
    }
    mesh.straighten_tangents();
    for (vertex, old) in mesh.vertices.iter().zip(before) {
        let t = (mapped(&old, [1.0, 0.0, 0.0]) * scale).normalize();
        let sign = old.normal.cross(mapped(&old, [1.0, 0.0, 0.0])).dot(mapped(&old, [0.0, 1.0, 0.0])).signum();
        assert!(degrees(mapped(vertex, [1.0, 0.0, 0.0]), t) < 0.01, "{vertex:?}");
        assert!(degrees(mapped(vertex, [0.0, 1.0, 0.0]), vertex.normal.cross(t) * sign) < 0.01, "{vertex:?}");
    }
}
