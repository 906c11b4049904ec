//! Hard cases of the cube: reflected vectors on edges and corners, and one bit off.

use fixed::types::I2F30;
use glam::{DVec3, dvec3};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;

use super::fragment::{RealFragment, around, bit};

/// A fragment whose reflected vector is exactly along `target`: n = e_z seen from the mirrored side.
pub(super) fn reflecting_to(target: DVec3) -> RealFragment {
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
    let views: Vec<_> = around(&exact.surface.view, p).collect();
    views.into_iter().map(move |view| ReflectionIn { surface: SurfaceIn { view, ..exact.surface }, ..exact })
}

fn signs() -> impl Iterator<Item = DVec3> {
    (0..8).map(|code| {
        let sign = |bit: u32| if code >> bit & 1 == 0 { 0.75 } else { -0.75 };
        dvec3(sign(0), sign(1), sign(2))
    })
}

pub(super) fn cube_edges(p: &Precision) -> Vec<ReflectionIn> {
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

pub(super) fn cube_corners(p: &Precision) -> Vec<ReflectionIn> {
    let axes = (0..6).map(|code| {
        let mut axis = DVec3::ZERO;
        axis[code / 2] = if code % 2 == 0 { 0.75 } else { -0.75 };
        axis
    });
    let mut fragments: Vec<_> = signs().chain(axes).flat_map(|target| one_bit_around(target, p)).collect();
    let plain = reflecting_to(DVec3::ONE).quantised(p);
    for mantissa in [[i32::MIN; 3], [i32::MIN, 0, 0], [0, i32::MIN, i32::MIN], [i32::MIN, i32::MIN, bit(p)]] {
        let view = BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent: 0 };
        fragments.push(ReflectionIn { surface: SurfaceIn { view, ..plain.surface }, ..plain });
    }
    fragments
}
