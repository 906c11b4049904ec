//! Hard cases of the footprint: derivatives, ellipses, probe counts, roughness.

use fixed::types::I2F30;
use glam::{DMat3, DVec3, dvec3};
use roughxel_core::block::Mantissa;
use roughxel_core::elementary::{LOGARITHM, log2};
use roughxel_core::fx::{Control, Fx};
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::{LOD, ReflectionIn};
use roughxel_core::precision::Precision;
use roughxel_core::rom::{LOG_BITS, LOG2_DIAMETER};
use roughxel_core::scalar::Scalar;
use roughxel_core::scalar_api::environment_scale;
use roughxel_core::setup::offset;

use super::cube::reflecting_to;
use super::fragment::{RealFragment, bit, moved};

/// Fraction bits of a mantissa, of a logarithm and of a level.
const MANTISSA_BITS: u32 = Mantissa::<Scalar>::FRACTION;
const LOGARITHM_BITS: u32 = Control::<Scalar, LOGARITHM>::FRACTION;
const LOD_BITS: u32 = Control::<Scalar, LOD>::FRACTION;

/// A flat mirror facing +z whose pixel columns on the face are exactly −1/2 of `x` and `y`.
fn flat_footprint(x: [f64; 2], y: [f64; 2], p: &Precision) -> ReflectionIn {
    RealFragment {
        dview: [dvec3(x[0], x[1], 0.0), dvec3(y[0], y[1], 0.0)],
        roughness: [0.0; 3],
        ..reflecting_to(dvec3(0.0, 0.0, 1.0))
    }
    .quantised(p)
}

pub(super) fn footprint_rank(p: &Precision) -> Vec<ReflectionIn> {
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

pub(super) fn footprint_circle(p: &Precision) -> Vec<ReflectionIn> {
    let r = 0.011;
    let mut fragments = Vec::new();
    for step in 0..64 {
        let (sin, cos) = libm::sincos(f64::from(step) * std::f64::consts::PI / 32.0);
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
        for step in [-1, 1] {
            let mut dview = exact.dview;
            dview[column] = moved(&dview[column], component, step, p);
            fragments.push(ReflectionIn { dview, ..exact });
        }
    }
    fragments
}

pub(super) fn footprint_aspect(p: &Precision) -> Vec<ReflectionIn> {
    let mut fragments = Vec::new();
    let mut ratios: Vec<f64> =
        (1..=17).flat_map(|n| [0.99, 0.9999, 1.0, 1.0001, 1.01].map(|k| k * f64::from(n))).collect();
    ratios.extend([20.0, 50.0, 100.0, 300.0, 1000.0, 3000.0]);
    for ratio in ratios {
        for turn in 0..6 {
            let (sin, cos) = libm::sincos(f64::from(turn) * 0.55);
            let (major, minor) = (0.04, 0.04 / ratio);
            fragments.push(flat_footprint([major * cos, major * sin], [-minor * sin, minor * cos], p));
        }
    }
    fragments
}

pub(super) fn footprint_size(p: &Precision) -> Vec<ReflectionIn> {
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

/// Levels of detail that the last place of an entry of `log2` decides. The logarithm of λ₂ is one last place from the point at which it is truncated
/// to the bits of a level. With the edge of the face, the level is one last place from the point at which it is rounded. The mantissas nearest to an
/// entry come first, from both sides of the entry, for both its neighbours.
pub(super) fn footprint_level(p: &Precision) -> Vec<ReflectionIn> {
    let cut = 1 << (LOGARITHM_BITS - LOD_BITS);
    let round = 1 << (LOD_BITS - p.lod_bits);
    // Faces by the rest of the level's fraction at rounding. They are the larger faces, for which every level occurs.
    let mut faces = vec![Vec::new(); round as usize];
    for edge in 1024..=16384 {
        let texels = environment_scale(edge, p).log2_texels.raw();
        faces[texels.rem_euclid(round) as usize].push(edge);
    }
    let plan = ReflectionPlan::FULL;
    let interval = 1 << (p.fraction_bits - 1 - LOG_BITS);
    let mut fragments = Vec::new();
    for knot in 0..=1 << LOG_BITS {
        for side in [1, -1] {
            for (low_bits, left) in [(0, round / 2), (cut - 1, round / 2 - 1)] {
                let mantissas =
                    (0..interval).map(|place| (1 << (p.fraction_bits - 1)) + knot * interval + side * place);
                let decided = mantissas.filter_map(|mantissa| {
                    let log = log2::<Scalar>(Fx::from_raw(mantissa << (MANTISSA_BITS - p.fraction_bits)), p).raw();
                    let sum = (log >> (LOGARITHM_BITS - LOD_BITS)) + LOG2_DIAMETER;
                    let &edge = faces[(left - sum).rem_euclid(round) as usize].first()?;
                    (log.rem_euclid(cut) == low_bits).then_some((mantissa, edge))
                });
                // With more bits than a level has, any number of mantissas is decided, but few of them by a footprint.
                let levels = decided.take(8).filter_map(|(mantissa, edge_texels)| {
                    Some(ReflectionIn { edge_texels, ..with_minor(mantissa, &plan, p)? })
                });
                fragments.extend(levels.take(2));
            }
        }
    }
    fragments
}

/// A flat mirror in which λ₂ has this mantissa, of a circle if one has it, else of an ellipse; `None` if none is found.
fn with_minor(mantissa: i32, plan: &ReflectionPlan, p: &Precision) -> Option<ReflectionIn> {
    let last_place = 2.0_f64.powi(-4 - p.fraction_bits as i32);
    let diameter = (f64::from(mantissa) * libm::sqrt(12.0)).round();
    [1.0, 1.25, 1.5, 1.75].into_iter().find_map(|aspect| {
        (-3..=3).find_map(|off| {
            let size = (diameter + f64::from(off)) * last_place;
            let fragment = flat_footprint([size * aspect, 0.0], [0.0, size], p);
            let minor = fragment.reflect(plan, p).minor.mantissa[0];
            (minor.to_bits() == mantissa << (MANTISSA_BITS - p.fraction_bits)).then_some(fragment)
        })
    })
}

/// Circles of a pixel and of roughness together in which λ₂ exceeds λ₁ and has the larger exponent, so that they change places. λ₁² is one last place
/// below a power of two. Enough of the minors of the four columns are rounded up that the determinant is that of the power itself.
pub(super) fn footprint_swap(p: &Precision) -> Vec<ReflectionIn> {
    let plan = ReflectionPlan::FULL;
    let (last_place, lambda) = (2.0_f64.powi(-(p.fraction_bits as i32)), 0.5);
    let below_one = I2F30::from_bits(I2F30::ONE.to_bits() - bit(p));
    let circles = (0..1 << 12).flat_map(|step| {
        // A mirror doubles roughness. A pixel's box has 1/√12, rounded as in the profile.
        let rough = offset(lambda * libm::sqrt(f64::from(step) / f64::from(1 << 12)) / 2.0, p).to_num::<f64>();
        let fragments = (-4..8).map(|halves| {
            let pixel = lambda * lambda * (1.0 - f64::from(halves) / 2.0 * last_place) - 4.0 * rough * rough;
            let size = libm::sqrt(12.0 * pixel.max(0.0));
            RealFragment {
                dview: [dvec3(size, 0.0, 0.0), dvec3(0.0, size, 0.0)],
                roughness: [rough, 0.0, rough],
                ..reflecting_to(DVec3::Z)
            }
            .quantised(p)
        });
        // Two sizes may be equal at the port.
        let mut fragments: Vec<_> = fragments.collect();
        fragments.dedup();
        fragments
    });
    // Selects by the inputs of `axes` alone, for the set tests its outcome.
    let change_places = |fragment: &ReflectionIn| {
        let out = fragment.reflect(&plan, p);
        let [determinant] = out.determinant.mantissa;
        out.covariance.mantissa == [below_one, I2F30::ZERO, below_one]
            && (determinant == I2F30::ONE || determinant == I2F30::from_bits(I2F30::ONE.to_bits() >> 1))
    };
    circles.filter(change_places).take(32).collect()
}

pub(super) fn footprint_cancel(p: &Precision) -> Vec<ReflectionIn> {
    let mut fragments = Vec::new();
    // Parabolic mirror z = r²/4f seen from its focus: v = −(x, y, z₀), normal (−x, −y, 2f)/2f. One pixel moves the point by the pixel's width times
    // z₀; at the focus every reflected ray is parallel to the axis.
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
        let (sin, cos) = libm::sincos(f64::from(step) * 0.18);
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

pub(super) fn roughness_rank(p: &Precision) -> Vec<ReflectionIn> {
    let lsb = 2.0_f64.powi(-(p.offset_bits() as i32));
    let attitude = RealFragment { normal: dvec3(0.1, 0.9, 0.3), ..RealFragment::PLAIN };
    let mut decompositions: Vec<[f64; 3]> = (0..32)
        .map(|step| {
            // Rank one along (cos, sin): c = σ² sin², d₁ = 0 (c ≠ 0).
            let (sin, cos) = libm::sincos(f64::from(step) * std::f64::consts::PI / 32.0);
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
        // No pixel: the roughness alone makes the ellipse.
        fragments.push(RealFragment { roughness, dview: [DVec3::ZERO; 2], ..attitude }.quantised(p));
    }
    fragments
}

pub(super) fn roughness_isotropic(p: &Precision) -> Vec<ReflectionIn> {
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
