//! Attributes of a triangle in float64, and the bound on a fragment's error. The host checks more triangles against it
//! (`host-tests/tests/datapath/scanline.rs`).

use glam::{DVec2, DVec3};
use roughxel_core::ports::{BlockVector, SurfaceIn};
use roughxel_core::scanline::{Attributes, Fragment, ScreenVertex};
use roughxel_core::setup::{real_pair, real_vector};

/// One pixel in the units of a vertex.
pub const PIXEL: i32 = 256;

/// A corner whose 1/w equals that of other corners.
pub fn vertex(x: i32, y: i32) -> ScreenVertex {
    ScreenVertex { x, y, inverse_w: 1 << 30 }
}

/// Edge functions of a triangle in square sub-pixels, opposite to their vertices, and their increments per pixel. Exact.
pub fn edge_functions(v: &[ScreenVertex; 3], x: i32, y: i32) -> ([f64; 3], [[f64; 3]; 2]) {
    let at = |i: usize| DVec2::new(f64::from(v[i % 3].x), f64::from(v[i % 3].y));
    let centre = DVec2::new(f64::from(PIXEL * x + PIXEL / 2), f64::from(PIXEL * y + PIXEL / 2));
    let sides = [1, 2, 3].map(|i| (at(i), at(i + 1) - at(i)));
    let growth = [sides.map(|(_, side)| -side.y), sides.map(|(_, side)| side.x)];
    (sides.map(|(a, side)| side.perp_dot(centre - a)), growth.map(|g| g.map(|g| g * f64::from(PIXEL))))
}

/// The corners in clockwise order.
pub fn clockwise(mut v: [ScreenVertex; 3]) -> [ScreenVertex; 3] {
    if edge_functions(&v, 0, 0).0.iter().sum::<f64>() < 0.0 {
        v.swap(1, 2);
    }
    v
}

/// True if the pixel belongs to the triangle: its centre is inside, or on a top or a left edge.
pub fn is_inside(v: &[ScreenVertex; 3], x: i32, y: i32) -> bool {
    let (e, [across, down]) = edge_functions(v, x, y);
    // A left edge grows to the right. A top edge grows downwards only.
    let owns = |i: usize| across[i] > 0.0 || (across[i] == 0.0 && down[i] > 0.0);
    (0..3).all(|i| e[i] > 0.0 || (e[i] == 0.0 && owns(i)))
}

/// Float64 values of an attribute at a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// a, perspective-correct, and its derivatives to the right and down.
    pub a: DVec3,
    pub da: [DVec3; 2],
    /// A and its derivatives.
    pub sum: DVec3,
    dsum: [DVec3; 2],
    /// W and |dW|/W.
    w: f64,
    pub perspective: [f64; 2],
    /// The largest qᵢ|aᵢ| of a corner, times the area.
    largest: f64,
    /// The largest qᵢ|aᵢ| of a corner, times the increments of the edge functions.
    steepest: [f64; 2],
}

impl Truth {
    /// Evaluates the attributes of the corners at a pixel.
    pub fn new(v: &[ScreenVertex; 3], corners: [DVec3; 3], x: i32, y: i32) -> Self {
        let q = v.map(|v| f64::from(v.inverse_w));
        let (e, de) = edge_functions(v, x, y);
        let weight = |e: [f64; 3]| (0..3).map(|i| e[i] * q[i]).sum::<f64>();
        let vector = |e: [f64; 3], a: [DVec3; 3]| (0..3).map(|i| a[i] * (e[i] * q[i])).sum::<DVec3>();
        let (w, sum) = (weight(e), vector(e, corners));
        let a = sum / w;
        let largest = (0..3).map(|i| q[i] * corners[i].length()).fold(0.0, f64::max);
        Self {
            a,
            // Differences first: no cancellation that the datapath could lose and float64 would not.
            da: de.map(|de| vector(de, corners.map(|corner| corner - a)) / w),
            sum,
            dsum: de.map(|de| vector(de, corners)),
            w,
            perspective: de.map(|de| weight(de).abs() / w),
            largest: largest * e.iter().sum::<f64>(),
            steepest: de.map(|de| largest * de.iter().map(|x| x.abs()).sum::<f64>()),
        }
    }

    /// Ratio by which A here exceeds the value for which its last bits are dropped.
    fn loss(&self) -> f64 {
        self.largest / self.sum.length()
    }
}

/// Radians between two directions.
pub fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Attributes of a triangle in float64, as its ports carry them.
pub fn real(corners: &[BlockVector; 3]) -> [DVec3; 3] {
    corners.map(|corner| real_vector(&corner))
}

/// Errors of one fragment over the module's bounds; none exceeds 1.
pub fn shares_of_bars(
    v: &[ScreenVertex; 3],
    corners: &Attributes,
    fragment: &Fragment,
    y: i32,
) -> Vec<(&'static str, f64)> {
    let truth = |attribute: &[BlockVector; 3]| Truth::new(v, real(attribute), fragment.x, y);
    let [n, view, h] = [&corners.normal, &corners.view, &corners.main_direction].map(truth);
    let SurfaceIn { normal, view: found_view, frame_vectors: [found_h, _], .. } = fragment.reflection.surface;
    let mut shares = Vec::new();
    for (name, truth, found) in [("n", n, normal), ("v", view, found_view), ("h", h, found_h)] {
        let bar = (-28_f64).exp2() + (-37_f64).exp2() * truth.loss();
        shares.push((name, angle(real_vector(&found), truth.sum) / bar));
    }
    let lengths = [n.a.length() / real_vector(&normal).length(), view.sum.length() / real_vector(&found_view).length()];
    // W is positive at every pixel. If it is far less than at a corner, W itself has lost bits.
    let weights = Truth::new(v, [DVec3::X; 3], fragment.x, y);
    let lost = n.loss().max(weights.loss());
    for axis in [0, 1] {
        let found = real_vector(&fragment.reflection.dview[axis]) * lengths[1];
        let bar = (-27_f64).exp2() * view.dsum[axis].length()
            + (-38_f64).exp2() * (view.steepest[axis] + view.loss() * view.dsum[axis].length());
        shares.push(("dv", (found - view.dsum[axis]).length() / bar));

        let found = real_vector(&fragment.reflection.dnormal[axis]) * lengths[0];
        let bar = ((-27_f64).exp2() + (-36_f64).exp2() * lost)
            * (n.da[axis].length() + n.a.length() * n.perspective[axis])
            + (-38_f64).exp2() * (n.steepest[axis] + n.a.length() * weights.steepest[axis]) / n.w;
        shares.push(("dn", (found - n.da[axis]).length() / bar));
    }
    if let (Some(uv), Some(texture)) = (corners.uv, fragment.texture) {
        let uv = Truth::new(v, uv.map(|uv| real_pair(&uv).extend(0.0)), fragment.x, y);
        let relative = (-27_f64).exp2() + (-36_f64).exp2() * uv.loss().min(uv.largest / uv.w).max(weights.loss());
        for axis in [0, 1] {
            let off = texture.uv[axis].to_num::<f64>() - uv.a[axis];
            shares.push(("u", (off - off.round()).abs() / (relative * uv.a.length().max(1.0))));
            let off = (real_pair(&texture.duv[axis]).extend(0.0) - uv.da[axis]).length();
            let bar = 2.0 * relative * (uv.da[axis].length() + uv.a.length() * uv.perspective[axis])
                + (-38_f64).exp2() * (uv.steepest[axis] + uv.a.length() * weights.steepest[axis]) / uv.w;
            shares.push(("du", off / bar));
        }
    }
    shares
}
