//! The rasteriser against ray–plane intersection in float64, and its hard cases.

mod attributes;
mod coverage;

use fixed::types::{I2F30, U0F32};
use glam::{DVec2, DVec3};
use roughxel_core::ports::{BlockPair, BlockPort, BlockVector, Port};
use roughxel_shader::{AttributeRows, BlockRows, Derivatives, FragmentAttributes, Needs};
use roughxel_simd::{Backend, InstructionSet, LANES};

use super::edges::{Places, TileBuffer};
use super::setup::Drawn;
use super::*;
use roughxel_assets::{Mesh, Vertex};
use roughxel_scene::{Camera, Deviation, FrameSystem, Material, Object};
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

/// A camera that looks along −z from the origin; at w = height/2 a world unit is a pixel.
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

/// Needs of the corners without tangents.
const NO_TANGENTS: Needs = Needs { tangents: false, ..Needs::ALL };

/// Triangles of objects as a camera sees them. A drawn view lives until the end of its test.
struct View {
    projection: &'static Projection,
    list: TriangleList<'static>,
}

impl View {
    fn new(camera: &Camera, objects: Vec<Object>) -> Self {
        let projection: &Projection = Box::leak(Box::new(Projection::new(camera).expect("the camera is valid")));
        Self { projection, list: TriangleList::new(projection, objects.leak()).expect("the objects are valid") }
    }

    /// A triangle that exists, without tangents.
    fn triangle(&self, number: u32) -> Triangle<'static> {
        self.list.triangle(number, NO_TANGENTS).expect("the triangle is visible")
    }

    /// Every covered sample of the whole frame, as (x, y, triangle).
    fn visible(&self, offset: [i32; 2]) -> Vec<(i32, i32, u32)> {
        let mut samples = Vec::new();
        for tile in tiles(self.projection.width(), self.projection.height()) {
            let seen = Seen::draw(&self.list, tile, &[offset]);
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

/// Visibility at positions of the pixels of a part of the frame.
struct Seen {
    drawn: Drawn,
    buffer: TileBuffer,
}

impl Seen {
    fn draw(list: &TriangleList<'_>, tile: TileRect, places: &[[i32; 2]]) -> Self {
        let (mut drawn, mut buffer) = (Drawn::default(), TileBuffer::default());
        list.drawn(tile, &mut drawn);
        list.draw(&drawn, &Places::new(places), tile, &mut buffer);
        Self { drawn, buffer }
    }

    /// The triangle at a position of a pixel of the frame, and its depth.
    fn at(&self, x: u32, y: u32, place: usize) -> Option<(u32, i64)> {
        let (number, depth) = self.buffer.at(x, y, place)?;
        Some((self.drawn.triangles[number as usize], depth))
    }
}

/// A frame as one tile.
fn whole(width: u32, height: u32) -> TileRect {
    TileRect { x: 0, y: 0, width, height }
}

/// All backends of this machine.
fn backends() -> impl Iterator<Item = Backend> {
    InstructionSet::available().map(Backend::Simd).chain([Backend::Scalar])
}

fn pixels(subpixels: i32) -> f64 {
    f64::from(subpixels) / f64::from(SUBPIXELS)
}
