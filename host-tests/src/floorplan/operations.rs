//! Operations of the float32 datapath: the formulas of `roughxel-f32-baseline` on numbers that count.
//!
//! Counted are sums and differences, products, quotients and square roots. Not counted are comparisons, choices, signs, factors of two, conversions
//! and the number of probes after its quotient: hardware has them as wires or a few tables. A test holds the results against the baseline.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::{Add, Mul, Neg, Sub};

use roughxel_f32_baseline::Fragment;

use super::cell::Plan;

/// Standard deviation of a pixel box of unit edges, 1/√12.
const BOX_SIGMA: f32 = 0.288_675_13;
/// Diameter of a footprint of standard deviation 1, 2√3.
const DIAMETER: f32 = 3.464_101_6;
/// λ₁ beyond which the step is clamped, map units.
const LONGEST_SIGMA: f32 = 2.0;
/// Probes of a footprint at most.
const MAX_PROBES: f32 = 16.0;

thread_local! {
    static COUNTS: Cell<[u32; 4]> = const { Cell::new([0; 4]) };
}

/// Names of the counted operations.
pub const KINDS: [&str; 4] = ["add", "mul", "div", "sqrt"];

fn count(kind: usize) {
    COUNTS.with(|counts| {
        let mut values = counts.get();
        values[kind] += 1;
        counts.set(values);
    });
}

/// A number that counts its operations.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Real(f32);

impl Add for Real {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        count(0);
        Self(self.0 + other.0)
    }
}

impl Sub for Real {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        count(0);
        Self(self.0 - other.0)
    }
}

impl Mul for Real {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        count(1);
        Self(self.0 * other.0)
    }
}

impl Neg for Real {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real {
    const ZERO: Self = Self(0.0);

    fn over(self, other: Self) -> Self {
        count(2);
        Self(self.0 / other.0)
    }

    fn root(self) -> Self {
        count(3);
        Self(self.0.sqrt())
    }

    /// Factor of a power of two.
    fn scaled(self, factor: f32) -> Self {
        Self(self.0 * factor)
    }

    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    /// log₂ with a polynomial of degree 4 in the fraction.
    fn log2(self) -> Self {
        let bits = self.0.to_bits();
        let exponent = Self(((bits >> 23) as i32 - 127) as f32);
        let one = Self(1.0);
        let f = Self(f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000)) - one;
        exponent + f + f * (one - f) * (Self(0.438_725_74) + f * (Self(-0.239_058_23) + f * Self(0.082_130_685)))
    }
}

type Vector = [Real; 3];

fn dot(a: Vector, b: Vector) -> Real {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sum(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + b[i])
}

fn difference(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn times(a: Vector, factor: Real) -> Vector {
    a.map(|x| x * factor)
}

fn cross(a: Vector, b: Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i] * b[j] - b[i] * a[j])
}

/// Outcome of a fragment, a part of [`FloatFootprint`](roughxel_f32_baseline::FloatFootprint).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// s, t.
    pub st: [f32; 2],
    /// Step from one probe to the next; 0 for a mirror.
    pub step: [f32; 2],
    /// Level of detail; 0 for a mirror.
    pub lod: f32,
}

/// Position of the axes of the world on a face: components s_c, t_c and m of a vector.
fn components(is_z: bool, is_y: bool, is_negative: bool, w: Vector) -> Vector {
    let signed = |x: Real| if is_negative { -x } else { x };
    if is_z {
        [signed(w[0]), -w[1], signed(w[2])]
    } else if is_y {
        [w[0], signed(w[2]), signed(w[1])]
    } else {
        [-signed(w[2]), -w[1], signed(w[0])]
    }
}

/// A mirror with its face.
struct Mirror {
    normal: Vector,
    view: Vector,
    along: Real,
    square: Real,
    face: [bool; 3],
    over_m: Real,
    st: [Real; 2],
}

fn mirror(normal: Vector, view: Vector) -> Mirror {
    let (along, square) = (dot(view, normal), dot(normal, normal));
    let r = difference(times(normal, along.scaled(2.0)), times(view, square));
    let size = r.map(Real::abs);
    let is_z = size[2] >= size[0] && size[2] >= size[1];
    let is_y = !is_z && size[1] >= size[0];
    let major = r[if is_z { 2 } else { usize::from(is_y) }];
    let face = [is_z, is_y, major < Real::ZERO];
    let on_face = components(is_z, is_y, face[2], r);
    let over_m = Real(1.0).over(on_face[2]);
    Mirror { normal, view, along, square, face, over_m, st: [on_face[0] * over_m, on_face[1] * over_m] }
}

/// Change of r for a change of the normal alone.
fn curved(m: &Mirror, dnormal: Vector) -> Vector {
    let of_normal = sum(times(dnormal, m.along), times(m.normal, dot(m.view, dnormal)));
    difference(of_normal, times(m.view, dot(m.normal, dnormal))).map(|x| x.scaled(2.0))
}

/// Change of r for a change of view and normal.
fn moved(m: &Mirror, dview: Vector, dnormal: Vector) -> Vector {
    let of_view = difference(times(m.normal, dot(m.normal, dview).scaled(2.0)), times(dview, m.square));
    sum(of_view, curved(m, dnormal))
}

/// Tangent basis E₁ and E₂.
fn frame(n: Vector, main_direction: Vector) -> [Vector; 2] {
    let square = dot(n, n);
    let across = cross(main_direction, n);
    let inverse = Real(1.0).over(dot(across, across).root());
    [times(across, square.root() * inverse), times(cross(n, across), inverse)]
}

fn total(terms: impl Iterator<Item = Real>) -> Real {
    terms.reduce(|a, b| a + b).unwrap_or(Real::ZERO)
}

/// Step and level of detail of the axes of K = Σ q qᵀ, by det K = Σ of the squared minors.
fn footprint(q: &[[Real; 2]], texels: f32, last_level: f32) -> ([Real; 2], Real) {
    let [a, b, c] = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| total(q.iter().map(|q| q[i] * q[j])));
    let pairs = q.iter().enumerate().flat_map(|(i, first)| q[i + 1..].iter().map(move |second| (first, second)));
    let det = total(pairs.map(|(first, second)| {
        let minor = first[0] * second[1] - first[1] * second[0];
        minor * minor
    }));
    let (difference, twice_b) = (a - c, b.scaled(2.0));
    let h = (difference * difference + twice_b * twice_b).root();
    let major_square = (a + c + h).scaled(0.5);
    let major = major_square.root();
    let minor = det.over(major_square).root();
    let larger = h + difference.abs();
    let unit = Real(1.0).over((larger * larger + twice_b * twice_b).root());
    let (cos, sin) = (larger * unit, twice_b * unit);
    let direction = if difference >= Real::ZERO { [cos, sin] } else { [sin, cos] };

    let aspect = major.over(minor).0 * (1.0 - 8.0 * f32::EPSILON);
    let probes = aspect.clamp(1.0, MAX_PROBES).ceil();
    let minor = if aspect > MAX_PROBES { major.scaled(1.0 / MAX_PROBES) } else { minor };
    let longest = if major.0 > LONGEST_SIGMA { Real(LONGEST_SIGMA) } else { major };
    let step = (Real(DIAMETER) * longest).over(Real(probes));
    let lod = (Real(DIAMETER) * minor).scaled(texels).log2();
    (direction.map(|x| x * step), Real(lod.0.max(0.0).min(last_level)))
}

fn vector(v: glam::Vec3) -> Vector {
    v.to_array().map(Real)
}

/// Outcome of a mirror.
pub fn reflect_mirror(fragment: &Fragment) -> Outcome {
    let m = mirror(vector(fragment.normal), vector(fragment.view));
    Outcome { st: m.st.map(|x| x.0), step: [0.0; 2], lod: 0.0 }
}

/// Outcome of a fragment with a bump and a footprint, with or without roughness, on faces of `edge_texels`, a power of two.
pub fn reflect_footprint(fragment: &Fragment, is_rough: bool, edge_texels: u32) -> Outcome {
    let normal = vector(fragment.normal);
    let [e1, e2] = frame(normal, vector(fragment.main_direction));
    let [b1, b2] = fragment.offset.to_array().map(Real);
    let m = mirror(sum(sum(normal, times(e1, b1)), times(e2, b2)), vector(fragment.view));
    let [is_z, is_y, is_negative] = m.face;
    let column = |dr: Vector, weight: Real| {
        let dr = components(is_z, is_y, is_negative, dr);
        [0, 1].map(|i| (dr[i] - m.st[i] * dr[2]) * weight)
    };
    let weight = m.over_m * Real(BOX_SIGMA);
    let pixel = [0, 1].map(|i| moved(&m, vector(fragment.dview[i]), vector(fragment.dnormal[i])));
    let mut columns = pixel.map(|dr| column(dr, weight)).to_vec();
    if is_rough {
        let [d1, d2, d3] = fragment.roughness.to_array().map(Real);
        let slopes = [times(e1, d1), sum(times(e1, d2), times(e2, d3))];
        columns.extend(slopes.map(|dn| column(curved(&m, dn), m.over_m)));
    }
    let (step, lod) = footprint(&columns, 0.5 * edge_texels as f32, edge_texels.ilog2() as f32);
    Outcome { st: m.st.map(|x| x.0), step: step.map(|x| x.0), lod: lod.0 }
}

fn counted(run: impl FnOnce() -> Outcome) -> BTreeMap<String, u32> {
    COUNTS.with(|counts| counts.set([0; 4]));
    run();
    KINDS.iter().zip(COUNTS.with(Cell::get)).map(|(kind, count)| ((*kind).to_owned(), count)).collect()
}

/// Operations of each plan by kind. They do not depend on the fragment.
pub fn of_plans() -> BTreeMap<String, BTreeMap<String, u32>> {
    let fragment = Fragment::default();
    let operations = |plan| match plan {
        Plan::Mirror => counted(|| reflect_mirror(&fragment)),
        Plan::Footprint => counted(|| reflect_footprint(&fragment, false, 256)),
        Plan::All => counted(|| reflect_footprint(&fragment, true, 256)),
    };
    Plan::ALL.into_iter().map(|plan| (plan.name().to_owned(), operations(plan))).collect()
}
