//! What the datapath is tested with: seeded random fragments, every hard case as a named set, and stimulus for the ports of
//! a design.
//!
//! Sets are made of port values, quantised to the profile, so the reference can be fed with exactly what the
//! datapath sees.

pub mod highlight;
pub mod lit_peak;
pub mod peak_and_horizon;
pub mod stimulus;

use fixed::types::{I2F30, I4F28};
use glam::{DMat3, DVec3, dvec3};
use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::ports::{BlockVector, ReflectionIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::setup::{block_vector, offset};

use crate::random::SplitMix64;

/// A named set of fragments and the plan they run under.
#[derive(Clone, Debug)]
pub struct CaseSet {
    /// Short name, also the file name of the exported set.
    pub name: &'static str,
    /// What the set holds.
    pub description: &'static str,
    /// The fragments.
    pub fragments: Vec<ReflectionIn>,
    /// Blocks they go through.
    pub plan: ReflectionPlan,
}

/// One fragment in real numbers, the form the generators think in.
#[derive(Clone, Copy, Debug)]
struct RealFragment {
    normal: DVec3,
    view: DVec3,
    tangents: [DVec3; 2],
    offset: [f64; 2],
    roughness: [f64; 3],
    dview: [DVec3; 2],
    dnormal: [DVec3; 2],
    edge: u16,
}

impl RealFragment {
    /// A mirror on the floor seen at 45°, a pixel of 1/500 rad.
    const PLAIN: Self = Self {
        normal: DVec3::Y,
        view: dvec3(0.0, 1.0, 1.0),
        tangents: [DVec3::NEG_Z, DVec3::X],
        offset: [0.0; 2],
        roughness: [0.0; 3],
        dview: [dvec3(-0.002, 0.0, 0.0), dvec3(0.0, 0.0014, -0.0014)],
        dnormal: [DVec3::ZERO; 2],
        edge: 256,
    };

    fn quantised(&self, p: &Precision) -> ReflectionIn {
        ReflectionIn {
            normal: block_vector(self.normal, p),
            view: block_vector(self.view, p),
            tangents: self.tangents.map(|t| block_vector(t, p)),
            offset: self.offset.map(|b| offset(b, p)),
            roughness: self.roughness.map(|d| offset(d, p)),
            dview: self.dview.map(|d| block_vector(d, p)),
            dnormal: self.dnormal.map(|d| block_vector(d, p)),
            edge_texels: self.edge,
        }
    }
}

fn direction(random: &mut SplitMix64) -> DVec3 {
    loop {
        let v = dvec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
        let square = v.length_squared();
        if (0.01..=1.0).contains(&square) {
            return v;
        }
    }
}

/// Fragment `index` of the random set `set`: nine in ten are plausible fragments (any attitude, footprints from a
/// fifth of a texel to a face, offsets to 0.6, roughness to 0.4), one in ten has random bits at corner
/// exponents. Depends on the name and the index only.
pub fn random_fragment(set: &str, index: u64, p: &Precision) -> ReflectionIn {
    let mut random = SplitMix64::for_element(set, index);
    if random.below(10) == 0 { random_bits(&mut random, p) } else { plausible(&mut random, p) }
}

fn plausible(random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let mut scale = |low: f64, high: f64| random.uniform(low, high).exp2();
    let (pixel, bend, rough) = (scale(-12.0, -4.0), scale(-14.0, -5.0), scale(-8.0, -1.3));
    let (far, size) = (scale(-6.0, 6.0), scale(-3.0, 3.0));
    let normal = direction(random) * size;
    let view = direction(random) * far;
    let mut small = |length: f64| direction(random) * length;
    let dview = [small(pixel * view.length()), small(pixel * view.length())];
    let dnormal = [small(bend * size), small(bend * size)];
    let tangents = [small(1.0), small(1.0)];
    let mut within = |bound: f64| random.uniform(-bound, bound);
    let roughness = [within(rough).abs(), within(rough), within(rough).abs()];
    let offset = [within(0.6), within(0.6)];
    RealFragment { normal, view, tangents, offset, roughness, dview, dnormal, edge: 1 << (4 + random.below(8)) }
        .quantised(p)
}

fn random_bits(random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    // Bit patterns with weight on the corners: all ones, single bits, runs, zero.
    let mut word = |bits: u32, drop: u32| -> i32 {
        let value = match random.below(8) {
            0 => 0,
            1 => 1 << random.below(u64::from(bits - 1)),
            2 => -(1 << random.below(u64::from(bits - 1))),
            3 => (1 << random.below(u64::from(bits - 1))) - 1,
            4 => i64::MIN >> (64 - bits),
            _ => random.next_u64() as i64 >> (64 - bits),
        };
        (value << drop).clamp(i64::from(i32::MIN), i64::from(i32::MAX) >> drop << drop) as i32
    };
    let drop = 30 - p.fraction_bits;
    let mut vectors = [[0_i32; 3]; 8];
    for component in vectors.iter_mut().flatten() {
        // |mantissa| < 1: entry shifts left only, so the reference sees what the datapath keeps.
        *component = word(p.fraction_bits + 1, drop);
    }
    let offsets: [i32; 5] = core::array::from_fn(|_| word(p.offset_bits() + 4, 28 - p.offset_bits()));
    let mut exponent = || -> i16 {
        match random.below(6) {
            0 => 0,
            1 => random.uniform(-60.0, 60.0) as i16,
            _ => random.uniform(-12.0, 4.0) as i16,
        }
    };
    let [n, v, t0, t1, vx, vy, nx, ny] =
        vectors.map(|mantissa| BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent: exponent() });
    let [b1, b2, d1, d2, d3] = offsets.map(I4F28::from_bits);
    let d1 = d1.saturating_abs();
    let d3 = d3.saturating_abs();
    let keep = |d: I4F28| I4F28::from_bits(d.to_bits() >> (28 - p.offset_bits()) << (28 - p.offset_bits()));
    ReflectionIn {
        normal: n,
        view: v,
        tangents: [t0, t1],
        offset: [b1, b2],
        roughness: [keep(d1), d2, keep(d3)],
        dview: [vx, vy],
        dnormal: [nx, ny],
        edge_texels: 1 << random.below(15),
    }
}

/// Every hard case of the reflection datapath, by block.
pub fn hard_case_sets(p: &Precision) -> Vec<CaseSet> {
    let full = ReflectionPlan::FULL;
    let set = |name, description, fragments: Vec<ReflectionIn>| CaseSet { name, description, fragments, plan: full };
    vec![
        set("frame_pole", "h approaches n from 1 degree to the last bit, and lies on it", frame_pole(p)),
        set("frame_zero", "n = 0, h = 0, v = 0, tiny and huge n", frame_zero(p)),
        set("frame_horizon", "offsets to the end of their range, v below the perturbed surface", frame_horizon(p)),
        CaseSet {
            name: "frame_natural",
            description: "p_u, p_v skewed towards parallel, of very different length, equal, zero",
            fragments: frame_natural(p),
            plan: ReflectionPlan { frame: FrameSystem::Natural, ..full },
        },
        CaseSet {
            name: "frame_natural_normalised",
            description: "the same tangents with their lengths dropped",
            fragments: frame_natural(p),
            plan: ReflectionPlan { frame: FrameSystem::NaturalNormalised, ..full },
        },
        set("cube_edges", "r on the 12 edges and one bit to either side", cube_edges(p)),
        set("cube_corners", "r on the 8 corners and one bit around them, axes, most negative words", cube_corners(p)),
        set("footprint_rank", "both derivatives zero, one zero, parallel, skewed, equal", footprint_rank(p)),
        set("footprint_circle", "near circles: a = c and c - a changing sign by one bit", footprint_circle(p)),
        set("footprint_aspect", "aspect just below and above every probe count, to 1000", footprint_aspect(p)),
        set("footprint_size", "from far below a texel to far beyond a face", footprint_size(p)),
        set("footprint_cancel", "concave mirror around its focus, cylinder", footprint_cancel(p)),
        set(
            "roughness_rank",
            "K of rank one in every direction, c = 0, c = one bit, d2 < 0, saturated",
            roughness_rank(p),
        ),
        CaseSet {
            name: "roughness_isotropic",
            description: "isotropic roughness from one bit to the end of its range",
            fragments: roughness_isotropic(p),
            plan: ReflectionPlan { roughness: RoughnessKind::Isotropic, ..full },
        },
    ]
}

/// One last bit of a mantissa port.
fn bit(p: &Precision) -> i32 {
    1 << (30 - p.fraction_bits)
}

fn frame_pole(p: &Precision) -> Vec<ReflectionIn> {
    let mut fragments = Vec::new();
    let normals = [dvec3(0.2, 0.9, -0.3), DVec3::Y, dvec3(0.5, 0.5, 0.5), dvec3(-0.7, 0.1, 0.69)];
    for normal in normals {
        let side = normal.any_orthonormal_vector() * normal.length();
        let mut angle = 1.0_f64.to_radians();
        while angle > 2.0_f64.powi(-(p.fraction_bits as i32) - 1) {
            fragments.push(
                RealFragment {
                    normal,
                    tangents: [normal * angle.cos() + side * angle.sin(), DVec3::X],
                    offset: [0.3, -0.2],
                    roughness: [0.1, 0.03, 0.05],
                    ..RealFragment::PLAIN
                }
                .quantised(p),
            );
            angle /= 2.0;
        }
        // The last bit itself, on each component and either side, and no angle at all.
        let exact = RealFragment { normal, offset: [0.3, -0.2], ..RealFragment::PLAIN }.quantised(p);
        for component in 0..3 {
            for step in [-bit(p), bit(p)] {
                let mut h = exact.normal;
                h.mantissa[component] = I2F30::from_bits(h.mantissa[component].to_bits() + step);
                fragments.push(ReflectionIn { tangents: [h, h], ..exact });
            }
        }
        let opposite = BlockVector { mantissa: exact.normal.mantissa.map(|m| -m), ..exact.normal };
        fragments.push(ReflectionIn { tangents: [exact.normal; 2], ..exact });
        fragments.push(ReflectionIn { tangents: [opposite; 2], ..exact });
    }
    fragments
}

fn frame_zero(p: &Precision) -> Vec<ReflectionIn> {
    let plain = RealFragment { offset: [0.2, 0.1], roughness: [0.1, 0.0, 0.1], ..RealFragment::PLAIN };
    let with = |change: &dyn Fn(&mut RealFragment)| {
        let mut fragment = plain;
        change(&mut fragment);
        fragment.quantised(p)
    };
    let mut fragments = vec![
        with(&|f| f.normal = DVec3::ZERO),
        with(&|f| f.view = DVec3::ZERO),
        with(&|f| f.tangents = [DVec3::ZERO; 2]),
        with(&|f| (f.normal, f.view) = (DVec3::ZERO, DVec3::ZERO)),
    ];
    for exponent in [-1000, -300, -100, -30, 30, 100, 300, 1000] {
        let factor = 2.0_f64.powi(exponent);
        fragments.push(with(&|f| f.normal *= factor));
        fragments.push(with(&|f| {
            f.view *= factor;
            f.dview = f.dview.map(|d| d * factor);
        }));
        fragments.push(with(&|f| f.tangents = f.tangents.map(|t| t * factor)));
    }
    // Mantissas at the ends of the port: one bit, and the most negative word.
    let plain = plain.quantised(p);
    for mantissa in [[0, 0, bit(p)], [bit(p), bit(p), -bit(p)], [i32::MIN, 0, 0], [i32::MIN; 3]] {
        let vector = BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent: 0 };
        fragments.push(ReflectionIn { normal: vector, ..plain });
        fragments.push(ReflectionIn { view: vector, ..plain });
        fragments.push(ReflectionIn { tangents: [vector; 2], ..plain });
    }
    fragments
}

fn frame_horizon(p: &Precision) -> Vec<ReflectionIn> {
    let mut fragments = Vec::new();
    for b1 in [-7.99, -2.0, -0.5, 0.0, 0.01, 1.0, 7.99] {
        for b2 in [-7.99, -1.0, 0.0, 0.3, 7.99] {
            for view in [dvec3(0.0, 1.0, 0.01), dvec3(0.0, 0.01, 1.0), dvec3(0.3, 0.0, 1.0), dvec3(0.0, -1.0, 0.2)] {
                fragments.push(RealFragment { view, offset: [b1, b2], ..RealFragment::PLAIN }.quantised(p));
            }
        }
    }
    fragments
}

fn frame_natural(p: &Precision) -> Vec<ReflectionIn> {
    let mut fragments = Vec::new();
    let u = dvec3(1.0, 0.0, 0.1);
    for power in 0..20 {
        let skew = 2.0_f64.powi(-power);
        for lengths in [(1.0, 1.0), (1e-3, 40.0), (300.0, 0.01)] {
            let tangents = [u * lengths.0, (u + dvec3(0.0, 0.05, -1.0) * skew) * lengths.1];
            fragments.push(
                RealFragment {
                    normal: tangents[0].cross(tangents[1]),
                    tangents,
                    offset: [0.2 * lengths.0 * skew, -0.1 * lengths.1 * skew],
                    roughness: [0.05 * lengths.0 * skew, 0.01 * lengths.0 * skew, 0.05 * lengths.1 * skew],
                    ..RealFragment::PLAIN
                }
                .quantised(p),
            );
        }
    }
    for tangents in [[u, u], [u, -u], [u, DVec3::ZERO], [DVec3::ZERO; 2], [DVec3::Y, DVec3::X], [DVec3::X, DVec3::Y]] {
        fragments.push(
            RealFragment { tangents, offset: [0.2, -0.1], roughness: [0.05, 0.01, 0.05], ..RealFragment::PLAIN }
                .quantised(p),
        );
    }
    fragments
}

/// A fragment whose reflected vector is exactly along `target`: n = e_z seen from the mirrored side.
fn reflecting_to(target: DVec3) -> RealFragment {
    RealFragment {
        normal: DVec3::Z,
        view: dvec3(-target.x, -target.y, target.z),
        tangents: [DVec3::Y, DVec3::X],
        dview: [dvec3(0.002, 0.0, 0.0), dvec3(0.0, 0.002, 0.0005)],
        roughness: [0.02, 0.01, 0.03],
        ..RealFragment::PLAIN
    }
}

/// The target with each component moved by −1, 0, 1 last bits.
fn one_bit_around(target: DVec3, p: &Precision) -> impl Iterator<Item = ReflectionIn> {
    let exact = reflecting_to(target).quantised(p);
    let bit = bit(p);
    (0..27).map(move |code| {
        let mut view = exact.view;
        for (component, step) in [code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1].into_iter().enumerate() {
            view.mantissa[component] = I2F30::from_bits(view.mantissa[component].to_bits() + step * bit);
        }
        ReflectionIn { view, ..exact }
    })
}

fn signs() -> impl Iterator<Item = DVec3> {
    (0..8).map(|code| {
        let sign = |bit: u32| if code >> bit & 1 == 0 { 0.75 } else { -0.75 };
        dvec3(sign(0), sign(1), sign(2))
    })
}

fn cube_edges(p: &Precision) -> Vec<ReflectionIn> {
    signs()
        .flat_map(|corner| {
            (0..3).flat_map(move |axis| {
                let mut middle = corner;
                middle[axis] *= 0.3;
                let mut flat = corner;
                flat[axis] = 0.0;
                [middle, flat]
            })
        })
        .flat_map(|target| one_bit_around(target, p))
        .collect()
}

fn cube_corners(p: &Precision) -> Vec<ReflectionIn> {
    let axes = (0..6).map(|code| {
        let mut axis = DVec3::ZERO;
        axis[code / 2] = if code % 2 == 0 { 0.75 } else { -0.75 };
        axis
    });
    let mut fragments: Vec<_> = signs().chain(axes).flat_map(|target| one_bit_around(target, p)).collect();
    let plain = reflecting_to(DVec3::ONE).quantised(p);
    for mantissa in [[i32::MIN; 3], [i32::MIN, 0, 0], [0, i32::MIN, i32::MIN], [i32::MIN, i32::MIN, bit(p)]] {
        let view = BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent: 0 };
        fragments.push(ReflectionIn { view, ..plain });
    }
    fragments
}

/// A flat mirror facing +z whose pixel columns on the face are exactly (−1/2) of the given ones.
fn flat_footprint(x: [f64; 2], y: [f64; 2], p: &Precision) -> ReflectionIn {
    RealFragment {
        dview: [dvec3(x[0], x[1], 0.0), dvec3(y[0], y[1], 0.0)],
        roughness: [0.0; 3],
        ..reflecting_to(dvec3(0.0, 0.0, 1.0))
    }
    .quantised(p)
}

fn footprint_rank(p: &Precision) -> Vec<ReflectionIn> {
    let small = 1.0 / 64.0;
    let pairs = [
        ([0.0, 0.0], [0.0, 0.0]),
        ([small, 0.0], [0.0, 0.0]),
        ([0.0, 0.0], [0.0, small]),
        ([small, small], [0.0, 0.0]),
        ([small, small / 2.0], [small * 2.0, small]),
        ([small, -small], [-small, small]),
        ([small, 0.0], [small, 0.01 * small]),
        ([small, 0.0], [0.0, small]),
        ([small, small], [small, -small]),
        ([small, 0.0], [0.0, small * 1e-6]),
        ([small * 1e-5, 0.0], [0.0, small]),
    ];
    let mut fragments: Vec<_> = pairs.into_iter().map(|(x, y)| flat_footprint(x, y, p)).collect();
    for power in 1..28 {
        fragments.push(flat_footprint([small, 0.0], [small, small * 2.0_f64.powi(-power)], p));
    }
    fragments
}

fn footprint_circle(p: &Precision) -> Vec<ReflectionIn> {
    let r = 0.011;
    let mut fragments = Vec::new();
    for step in 0..64 {
        let (sin, cos) = (f64::from(step) * std::f64::consts::PI / 32.0).sin_cos();
        for excess in [0.0, 1e-4, 0.09, 0.11] {
            fragments.push(flat_footprint(
                [r * cos, r * sin],
                [-r * sin * (1.0 + excess), r * cos * (1.0 + excess)],
                p,
            ));
        }
    }
    let exact = flat_footprint([r, 0.0], [0.0, r], p);
    for (column, component) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        for step in [-bit(p), bit(p)] {
            let mut dview = exact.dview;
            let mantissa = &mut dview[column].mantissa[component];
            *mantissa = I2F30::from_bits(mantissa.to_bits() + step);
            fragments.push(ReflectionIn { dview, ..exact });
        }
    }
    fragments
}

fn footprint_aspect(p: &Precision) -> Vec<ReflectionIn> {
    let mut fragments = Vec::new();
    let mut ratios: Vec<f64> =
        (1..=17).flat_map(|n| [0.99, 0.9999, 1.0, 1.0001, 1.01].map(|k| k * f64::from(n))).collect();
    ratios.extend([20.0, 50.0, 100.0, 300.0, 1000.0, 3000.0]);
    for ratio in ratios {
        for turn in 0..6 {
            let (sin, cos) = (f64::from(turn) * 0.55).sin_cos();
            let (major, minor) = (0.04, 0.04 / ratio);
            fragments.push(flat_footprint([major * cos, major * sin], [-minor * sin, minor * cos], p));
        }
    }
    fragments
}

fn footprint_size(p: &Precision) -> Vec<ReflectionIn> {
    (-40..12)
        .flat_map(|power| {
            let size = 2.0_f64.powi(power);
            [
                flat_footprint([size, 0.0], [0.0, size * 0.7], p),
                flat_footprint([size, size * 0.5], [-size * 0.1, size * 0.2], p),
            ]
        })
        .collect()
}

fn footprint_cancel(p: &Precision) -> Vec<ReflectionIn> {
    let mut fragments = Vec::new();
    // Parabolic mirror z = r²/4f seen from its focus: v = −(x, y, z₀), normal (−x, −y, 2f)/2f. One pixel moves the
    // point by the pixel's width times z₀; at the focus every reflected ray is parallel to the axis.
    for (x, y) in [(0.0, 0.0), (0.2, 0.1), (-0.35, 0.3), (0.5, -0.5)] {
        for defocus in [0.0, 0.001, 0.03, 0.3] {
            let focal = 1.0;
            let focus = dvec3(0.0, 0.0, focal + defocus);
            let point = dvec3(x, y, (x * x + y * y) / (4.0 * focal));
            let slope = dvec3(-x / (2.0 * focal), -y / (2.0 * focal), 1.0);
            let pixel = 0.004;
            let moved = |d: DVec3| dvec3(d.x, d.y, (x * d.x + y * d.y) / (2.0 * focal));
            let along = [dvec3(pixel, 0.0, 0.0), dvec3(0.0, pixel, 0.0)];
            fragments.push(
                RealFragment {
                    normal: slope,
                    view: focus - point,
                    dview: along.map(|d| -moved(d)),
                    dnormal: along.map(|d| dvec3(-d.x / (2.0 * focal), -d.y / (2.0 * focal), 0.0)),
                    ..RealFragment::PLAIN
                }
                .quantised(p),
            );
        }
    }
    // A cylinder around y: the normal turns in one direction only.
    for step in -8..=8 {
        let (sin, cos) = (f64::from(step) * 0.18).sin_cos();
        fragments.push(
            RealFragment {
                normal: dvec3(sin, 0.0, cos),
                view: dvec3(-sin * 0.2, 0.1, 4.0),
                dview: [dvec3(-0.004, 0.0, 0.0), dvec3(0.0, 0.004, 0.0)],
                dnormal: [dvec3(cos, 0.0, -sin) * 0.01, DVec3::ZERO],
                ..RealFragment::PLAIN
            }
            .quantised(p),
        );
    }
    fragments
}

fn roughness_rank(p: &Precision) -> Vec<ReflectionIn> {
    let lsb = 2.0_f64.powi(-(p.offset_bits() as i32));
    let attitude = RealFragment { normal: dvec3(0.1, 0.9, 0.3), ..RealFragment::PLAIN };
    let mut decompositions: Vec<[f64; 3]> = (0..32)
        .map(|step| {
            // Rank one along (cos, sin): c = σ² sin², d₁ = 0 (c ≠ 0).
            let (sin, cos) = (f64::from(step) * std::f64::consts::PI / 32.0).sin_cos();
            if step == 0 { [0.2, 0.0, 0.0] } else { [0.0, 0.2 * cos, 0.2 * sin] }
        })
        .collect();
    decompositions.extend([
        [0.0, 0.0, 0.0],
        [0.1, 0.0, 0.0],
        [0.1, 0.0, lsb],
        [0.1, lsb, lsb],
        [lsb, 0.0, 0.0],
        [0.0, lsb, 0.0],
        [0.0, 0.0, lsb],
        [0.1, -0.05, 0.1],
        [0.3, -0.3, 0.3],
        [0.001, 0.3, 0.3],
        [7.99, 7.99, 7.99],
        [7.99, -7.99, 0.0],
        [lsb, 7.99, 7.99],
    ]);
    let mut fragments = Vec::new();
    for roughness in decompositions {
        fragments.push(RealFragment { roughness, ..attitude }.quantised(p));
        // Without a pixel: the roughness alone makes the ellipse.
        fragments.push(RealFragment { roughness, dview: [DVec3::ZERO; 2], ..attitude }.quantised(p));
    }
    fragments
}

fn roughness_isotropic(p: &Precision) -> Vec<ReflectionIn> {
    let lsb = 2.0_f64.powi(-(p.offset_bits() as i32));
    let turn = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_z(0.7);
    let mut fragments = Vec::new();
    let mut sigma = lsb;
    while sigma < 8.0 {
        for dview in [[DVec3::ZERO; 2], RealFragment::PLAIN.dview] {
            let fragment =
                RealFragment { roughness: [sigma, 0.0, 0.0], normal: turn * DVec3::Y, dview, ..RealFragment::PLAIN };
            fragments.push(fragment.quantised(p));
        }
        sigma *= 2.0;
    }
    fragments
}
