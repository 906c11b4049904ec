//! Generated mesh: a trefoil knot as the text of an OBJ file, so that it is read as any other mesh.

use std::fmt::Write as _;

use glam::DVec3;

use super::maths::{cos_turns, sin_turns};

/// Rings along the knot and corners of a ring.
const RINGS: u32 = 288;
const CORNERS: u32 = 24;
/// Radii of the torus that carries the knot, and the radius of its tube.
const TORUS: [f64; 2] = [1.0, 0.45];
const TUBE: f64 = 0.24;

/// Middle of the tube at `turns` of the whole knot: two turns around the y axis, three around the torus.
fn middle(turns: f64) -> DVec3 {
    let reach = TORUS[0] + TORUS[1] * cos_turns(3.0 * turns);
    DVec3::new(reach * cos_turns(2.0 * turns), TORUS[1] * sin_turns(3.0 * turns), reach * sin_turns(2.0 * turns))
}

/// A coordinate of six decimal places in f32, as most programs write it.
fn written(coordinate: f64) -> f64 {
    f64::from(((coordinate * 1e6).round() / 1e6) as f32)
}

/// OBJ text: positions and texture coordinates (u along the knot, v around the tube, one repeat each), no normals.
///
/// Length : circumference is 10.2 : 1 within 5 %: the repeats that make texels square.
pub(super) fn knot() -> String {
    let mut text = String::new();
    for ring in 0..RINGS {
        let turns = f64::from(ring) / f64::from(RINGS);
        let at = middle(turns);
        // A thousandth of a turn to both sides gives the direction to 1e-5.
        let along = (middle(turns + 1e-3) - middle(turns - 1e-3)).normalize();
        let core = DVec3::new(cos_turns(2.0 * turns), 0.0, sin_turns(2.0 * turns)) * TORUS[0];
        // Along, side and outwards are right-handed; hence so are u, v and the normal.
        let side = (at - core).cross(along).normalize();
        let out = along.cross(side);
        for corner in 0..CORNERS {
            let around = f64::from(corner) / f64::from(CORNERS);
            let p = at + TUBE * (out * cos_turns(around) + side * sin_turns(around));
            let [x, y, z] = p.to_array().map(written);
            // Writing to a String cannot fail.
            let _ = writeln!(text, "v {x} {y} {z}");
        }
    }
    for ring in 0..=RINGS {
        for corner in 0..=CORNERS {
            let [u, v] = [f64::from(ring) / f64::from(RINGS), f64::from(corner) / f64::from(CORNERS)].map(written);
            let _ = writeln!(text, "vt {u} {v}");
        }
    }
    for ring in 0..RINGS {
        for corner in 0..CORNERS {
            let index = |ring: u32, corner: u32| {
                let vertex = ring % RINGS * CORNERS + corner % CORNERS + 1;
                format!("{vertex}/{}", ring * (CORNERS + 1) + corner + 1)
            };
            let (a, b) = (index(ring, corner), index(ring + 1, corner));
            let (c, d) = (index(ring + 1, corner + 1), index(ring, corner + 1));
            // Two triangles: a vertex has the mean normal of six of them.
            let _ = writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}");
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use roughxel_assets::{ReadOptions, parse_obj};

    #[test]
    fn the_knot_is_a_closed_tube_that_does_not_touch_itself() {
        let read = parse_obj(Path::new("knot"), &knot(), &ReadOptions::default()).unwrap();
        assert!(read.without_uv.is_none() && read.warnings.is_empty(), "{:?}", read.warnings);
        assert_eq!(read.mesh.triangles.len() as u32, 2 * RINGS * CORNERS);
        for vertex in &read.mesh.vertices {
            // Normals point away from the middle of the tube, within the sag of a chord of 15° and the knot's bend.
            let nearest = (0..RINGS)
                .map(|ring| middle(f64::from(ring) / f64::from(RINGS)))
                .min_by(|a, b| a.distance(vertex.position).total_cmp(&b.distance(vertex.position)))
                .unwrap();
            assert!((nearest.distance(vertex.position) - TUBE).abs() < 0.002, "no other part is nearer");
            assert!(vertex.normal.dot((vertex.position - nearest).normalize()) > 0.99);
        }
        let length: f64 = (0..RINGS)
            .map(|ring| {
                middle(f64::from(ring + 1) / f64::from(RINGS)).distance(middle(f64::from(ring) / f64::from(RINGS)))
            })
            .sum();
        let ratio = length / (std::f64::consts::TAU * TUBE);
        assert!((ratio / 10.2 - 1.0).abs() < 0.05, "{ratio}");
    }
}
