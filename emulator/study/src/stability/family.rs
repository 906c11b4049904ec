//! Families of inputs on the way to a degeneracy, and their descriptions.

use fixed::types::I2F30;
use glam::{DVec3, dvec3};
use roughxel_cases::{RealFragment, direction};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_reference::Outputs;
use roughxel_utilities::random::SplitMix64;

use super::reflection::Reflection;
use crate::accuracy::{CANCELLATION, Figure, lit_peak_bar, tie_margin};

/// A hard case and its members; the texts are those of [`super::HardCase`].
pub(super) struct Family {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) distance: &'static str,
    pub(super) error: &'static str,
    pub(super) naive: &'static str,
    pub(super) fallback: &'static str,
    /// The farthest distance is 2^(−this/2).
    pub(super) first: i32,
    pub(super) kind: Kind,
}

/// Datapath of a family.
pub(super) enum Kind {
    Reflection(Reflection),
    Peak,
}

impl Family {
    pub(super) fn bar(&self, profile: &str) -> Option<f64> {
        match &self.kind {
            Kind::Reflection(reflection) => reflection.figure.bar(profile),
            Kind::Peak => lit_peak_bar(profile),
        }
    }
}

const COORDINATES: &str = "max(|Δs|, |Δt|) on the chosen face, half faces";

pub(super) const FAMILIES: [Family; 9] = [
    Family {
        name: "eigenvalue_cancellation",
        title: "Eigenvalue that cancels",
        distance: "λ₂/λ₁",
        error: "|Δ level of detail|",
        naive: "λ₂² = ½(a + c − √((a − c)² + 4b²)) is a difference of equal numbers: it is noise, and where it comes out below 0 the \
                fragment has no probe.",
        fallback: "Below λ₁/16 the probes are capped and λ₂ is raised to λ₁/16 (probes_capped); λ₂ itself comes from the minors.",
        first: 2,
        kind: Kind::Reflection(Reflection {
            fragment: narrowing_footprint,
            figure: Figure::LevelOfDetail,
            fallback: |want, _| want.probes.capped,
        }),
    },
    Family {
        name: "frame_pole",
        title: "Frame at its pole",
        distance: "angle between n and h, rad",
        error: COORDINATES,
        naive: "h×n of rounded products is noise near the pole, so bumps turn by any angle, and 0/0 on it.",
        fallback: "h×n is exact to the last bit; where it is 0 the axis on which |n| is smallest stands in for h (frame_pole).",
        first: 2,
        kind: Kind::Reflection(Reflection {
            fragment: main_direction_near_normal,
            figure: Figure::Coordinates,
            fallback: |want, _| want.frame.pole,
        }),
    },
    Family {
        name: "rank_one_roughness",
        title: "Roughness and footprint of rank one",
        distance: "deviation across the line / along it; for half of them also the line's angle to an axis of the face, rad",
        error: "angle of the major axis, degrees",
        naive: "The eigenvector (b, λ₁² − a) is a difference of equal numbers beside the s axis, and 0/0 on it and for a circle.",
        fallback: "None is needed for the direction, which comes from the half-angle formula that does not cancel; at rank one λ₂ is 0 \
                   and raised to λ₁/16 (probes_capped).",
        first: 2,
        kind: Kind::Reflection(Reflection {
            fragment: narrowing_roughness,
            figure: Figure::Direction,
            fallback: |want, _| want.axes.minor == 0.0,
        }),
    },
    Family {
        name: "concave_focus",
        title: "Concave mirror at its focus",
        distance: "eye to focus / focal length",
        error: "|Δλ₁|/λ₁",
        naive: "What the turn of v and that of n do to r is rounded before the two cancel: what is left has no digit of its own.",
        fallback: "The terms are exact products, rounded once; with less than 1/16 of them left the error stays in proportion to the \
                   terms, not to the rest.",
        first: -6,
        kind: Kind::Reflection(Reflection { fragment: beside_the_focus, figure: Figure::MajorAxis, fallback: cancels }),
    },
    Family {
        name: "log2_near_1",
        title: "Logarithm near 1",
        distance: "|minor diameter / a power of two − 1|",
        error: "|Δ level of detail|",
        naive: "Exponent and table of the mantissa have to meet at a power of two: the logarithm of 1 − ε is −1 and that of almost 2.",
        fallback: "Below one texel the level is 0; a level keeps the fraction bits of the profile, beyond which no distance shows.",
        first: 3,
        kind: Kind::Reflection(Reflection {
            fragment: one_texel,
            figure: Figure::LevelOfDetail,
            fallback: |want, _| want.probes.lod_unclamped <= 0.0,
        }),
    },
    Family {
        name: "peak_near_half_vector",
        title: "Peak near N = H",
        distance: "angle between N and H, rad",
        error: "|Δ light| / amplitude",
        naive: "(N·H)ⁿ takes the error of both lengths to the power of thousands: a stored N that is 2^−15 too long is a fifth too \
                bright.",
        fallback: "None is needed: 1 − N·H is |N − H|²/2, formed from the difference.",
        first: 2,
        kind: Kind::Peak,
    },
    Family {
        name: "cube_edge_and_corner",
        title: "Edge and corner of the cube",
        distance: "relative difference of the largest components of r",
        error: COORDINATES,
        naive: "Which component is the largest is a matter of rounding, in any format; whoever takes s and t of one face and the number \
                of another is a face away.",
        fallback: "Within the error of r either face is right, and s, t = ±1 there; equal ones go to z, then y (face_tie).",
        first: 2,
        kind: Kind::Reflection(Reflection {
            fragment: near_an_edge,
            figure: Figure::Coordinates,
            fallback: |want, p| want.tie_margin <= tie_margin(p),
        }),
    },
    Family {
        name: "grazing_view",
        title: "Grazing view",
        distance: "sine of the angle between v and the surface",
        error: "|Δλ₁|/λ₁",
        naive: "The point that a pixel sees runs away along the surface, 1/sine faster than the ray turns: nearly all of ∂v is along v \
                and cancels in the projection.",
        fallback: "With less than 1/16 of the terms left the error stays in proportion to the terms; derivatives of the ray, which the \
                   rasteriser gives, do not cancel.",
        first: 0,
        kind: Kind::Reflection(Reflection { fragment: grazing, figure: Figure::MajorAxis, fallback: cancels }),
    },
    Family {
        name: "normal_near_zero",
        title: "Perturbed normal near zero",
        distance: "|n| / that of the vertex normals between which it cancelled",
        error: COORDINATES,
        naive: "n/|n| is 0/0 where opposite vertex normals meet, and the squares of a short one leave a fixed range.",
        fallback: "n has an exponent of its own and no length is divided by; at 0 there is no reflection: +z, s = t = 0 (normal_zero).",
        first: 0,
        kind: Kind::Reflection(Reflection {
            fragment: between_opposite_normals,
            figure: Figure::Coordinates,
            fallback: |want, _| want.selection.m == 0.0,
        }),
    },
];

/// Returns true if less is left of a footprint than its errors are judged against.
fn cancels(want: &Outputs, _: &Precision) -> bool {
    want.axes.major * CANCELLATION <= want.footprint_scale()
}

/// A mirror facing +z that reflects along the axis or next to it.
fn facing(s: f64, t: f64) -> RealFragment {
    RealFragment { normal: DVec3::Z, view: dvec3(-s, -t, 1.0), tangents: [DVec3::Y, DVec3::X], ..RealFragment::PLAIN }
}

/// The v whose reflection at a normal is this r.
fn seen_by(reflected: DVec3, normal: DVec3) -> DVec3 {
    2.0 * normal * normal.dot(reflected) / normal.length_squared() - reflected
}

/// Two derivatives; the second is `distance` away from being parallel to the first.
fn narrowing_footprint(distance: f64, random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let mut any = |low, high| random.uniform(low, high);
    let (sin, cos) = any(0.0, std::f64::consts::PI).sin_cos();
    let (size, share) = (any(0.1, 0.3), any(-1.0, 1.0));
    let along = dvec3(cos, sin, 0.0) * size;
    let across = dvec3(-sin, cos, 0.0) * size * distance;
    RealFragment { dview: [along, along * share + across], ..facing(any(-0.6, 0.6), any(-0.6, 0.6)) }.quantised(p)
}

fn main_direction_near_normal(distance: f64, random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let normal = direction(random).normalize();
    let side = normal.cross(direction(random)).normalize();
    let mut any = || random.uniform(-0.4, 0.4);
    let (offset, roughness) = ([any(), any()], [any().abs(), any(), any().abs()]);
    RealFragment {
        normal,
        view: normal + 0.7 * direction(random),
        tangents: [normal * distance.cos() + side * distance.sin(), DVec3::ZERO],
        offset,
        roughness,
        ..RealFragment::PLAIN
    }
    .quantised(p)
}

/// D of deviation σ along a line and σ·`distance` across it; half of the lines are this near to an axis of the face.
fn narrowing_roughness(distance: f64, random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let near_axis = random.below(2) == 0;
    let turn = if near_axis { distance * random.uniform(0.5, 1.0) } else { random.uniform(0.1, 3.0) };
    let turn = if random.below(2) == 0 { turn } else { turn + std::f64::consts::FRAC_PI_2 };
    let (sin, cos) = turn.sin_cos();
    let sigma = random.uniform(0.1, 0.3);
    let thin = distance * distance;
    // c = d₃², b = d₂d₃, and d₁d₃ the root of the determinant.
    let d3 = sigma * (sin * sin + thin * cos * cos).sqrt();
    let d2 = sigma * sigma * (1.0 - thin) * sin * cos / d3;
    let roughness = [sigma * sigma * distance / d3, d2, d3];
    let mirror =
        if near_axis { facing(0.0, 0.0) } else { facing(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)) };
    // For the eye in front, a pixel on the same line leaves K of rank one.
    let pixel = if near_axis { dvec3(cos, sin, 0.0) * 0.02 } else { DVec3::ZERO };
    RealFragment { roughness, dview: [pixel, -0.5 * pixel], ..mirror }.quantised(p)
}

/// A parabolic mirror of focal length 1 seen from a point near its focus: one pixel moves the point on it as far as its ray
/// turns.
fn beside_the_focus(distance: f64, random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let (x, y) = (random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6));
    let aside = direction(random).normalize();
    let eye = DVec3::Z + dvec3(aside.x, aside.y, aside.z.abs()) * distance;
    let point = dvec3(x, y, 0.25 * (x * x + y * y));
    let along = [dvec3(0.004, 0.0, 0.0), dvec3(0.0, 0.004, 0.0)];
    RealFragment {
        normal: dvec3(-0.5 * x, -0.5 * y, 1.0),
        view: eye - point,
        dview: along.map(|d| -dvec3(d.x, d.y, 0.5 * (x * d.x + y * d.y))),
        dnormal: along.map(|d| -0.5 * d),
        ..RealFragment::PLAIN
    }
    .quantised(p)
}

/// A minor diameter of 2^j·(1 ± `distance`) texels, along s for half of the members.
fn one_texel(distance: f64, random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let mirror = facing(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5));
    let level = random.below(5) as f64;
    let above = level == 0.0 || random.below(2) == 0;
    let texels = level.exp2() * if above { 1.0 + distance } else { 1.0 - distance };
    let minor = texels / (0.5 * f64::from(mirror.edge));
    let major = minor * random.uniform(1.2, 4.0);
    let turn = if random.below(2) == 0 { 0.0 } else { random.uniform(0.1, 3.0) };
    let (sin, cos) = f64::sin_cos(turn);
    RealFragment { dview: [dvec3(cos, sin, 0.0) * minor, dvec3(-sin, cos, 0.0) * major], ..mirror }.quantised(p)
}

/// r near an edge and near a corner, by turns.
fn near_an_edge(distance: f64, random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let mut sign = || if random.below(2) == 0 { 1.0 } else { -1.0 };
    let signs = dvec3(sign(), sign(), sign());
    let third = if random.below(2) == 0 { random.uniform(0.0, 0.9) } else { 1.0 - distance * random.uniform(1.0, 2.0) };
    let mut sizes = [1.0, 1.0 - distance, third];
    sizes.rotate_right(random.below(3) as usize);
    if random.below(2) == 0 {
        sizes.swap(0, 1);
    }
    let target = signs * DVec3::from_array(sizes);
    let normal = target.normalize() + 0.7 * direction(random);
    let small = |random: &mut SplitMix64| direction(random) * 0.01;
    RealFragment { normal, view: seen_by(target, normal), dview: [small(random), small(random)], ..RealFragment::PLAIN }
        .quantised(p)
}

/// A plane whose visible point recedes along it: ∂v/∂y is 1/sine times as long as ∂v/∂x.
fn grazing(distance: f64, random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let normal = direction(random).normalize();
    let ahead = normal.cross(direction(random)).normalize();
    let pixel = 0.002;
    RealFragment {
        normal,
        view: ahead * (1.0 - distance * distance).sqrt() + normal * distance,
        tangents: [ahead, DVec3::ZERO],
        dview: [normal.cross(ahead) * pixel, ahead * (-pixel / distance)],
        ..RealFragment::PLAIN
    }
    .quantised(p)
}

/// n as interpolated between opposite normals: short, on the last bit of the vertices' own exponent.
fn between_opposite_normals(distance: f64, random: &mut SplitMix64, p: &Precision) -> ReflectionIn {
    let normal = direction(random).normalize();
    let mut any = || random.uniform(-0.3, 0.3);
    let offset = [any(), any()];
    let small = |random: &mut SplitMix64| direction(random) * 0.02;
    let fragment = RealFragment {
        view: normal + 0.7 * direction(random),
        tangents: [direction(random), DVec3::ZERO],
        offset,
        dview: [small(random), small(random)],
        dnormal: [small(random), small(random)],
        ..RealFragment::PLAIN
    }
    .quantised(p);
    let unit = f64::from(p.fraction_bits).exp2();
    let last_bit = 30 - p.fraction_bits;
    let mantissa =
        (normal * (0.9 * distance) * unit).round().to_array().map(|x| I2F30::from_bits((x as i32) << last_bit));
    let normal = BlockVector { mantissa, exponent: 0 };
    ReflectionIn { surface: SurfaceIn { normal, ..fragment.surface }, ..fragment }
}
