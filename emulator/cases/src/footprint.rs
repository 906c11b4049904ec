//! Hard cases of the footprint: derivatives, ellipses, probe counts, roughness.

use fixed::types::I2F30;
use glam::{DMat3, DVec3, dvec3};
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::Precision;

use super::cube::reflecting_to;
use super::fragment::{RealFragment, bit};

/// A flat mirror facing +z whose pixel columns on the face are exactly (−1/2) of the given ones.
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
        for step in [-bit(p), bit(p)] {
            let mut dview = exact.dview;
            let mantissa = &mut dview[column].mantissa[component];
            *mantissa = I2F30::from_bits(mantissa.to_bits() + step);
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

pub(super) fn footprint_cancel(p: &Precision) -> Vec<ReflectionIn> {
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
        // Without a pixel: the roughness alone makes the ellipse.
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
