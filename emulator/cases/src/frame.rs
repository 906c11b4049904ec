//! Hard cases of the tangent basis: poles, zeros, horizons, natural tangents.

use fixed::types::I2F30;
use glam::{DVec3, dvec3};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;

use super::fragment::{RealFragment, bit, moved};

pub(super) fn frame_pole(p: &Precision) -> Vec<ReflectionIn> {
    let mut fragments = Vec::new();
    let normals = [dvec3(0.2, 0.9, -0.3), DVec3::Y, dvec3(0.5, 0.5, 0.5), dvec3(-0.7, 0.1, 0.69)];
    for normal in normals {
        let side = normal.any_orthonormal_vector() * normal.length();
        let mut angle = 1.0_f64.to_radians();
        while angle > 2.0_f64.powi(-(p.fraction_bits as i32) - 1) {
            fragments.push(
                RealFragment {
                    normal,
                    tangents: [normal * libm::cos(angle) + side * libm::sin(angle), DVec3::X],
                    offset: [0.3, -0.2],
                    roughness: [0.1, 0.03, 0.05],
                    ..RealFragment::PLAIN
                }
                .quantised(p),
            );
            angle /= 2.0;
        }
        // The last bit itself, on each component and either side, and no angle.
        let exact = RealFragment { normal, offset: [0.3, -0.2], ..RealFragment::PLAIN }.quantised(p);
        for component in 0..3 {
            for step in [-1, 1] {
                let h = moved(&exact.surface.normal, component, step, p);
                fragments.push(ReflectionIn { surface: SurfaceIn { frame_vectors: [h, h], ..exact.surface }, ..exact });
            }
        }
        let opposite = BlockVector { mantissa: exact.surface.normal.mantissa.map(|m| -m), ..exact.surface.normal };
        fragments.push(ReflectionIn {
            surface: SurfaceIn { frame_vectors: [exact.surface.normal; 2], ..exact.surface },
            ..exact
        });
        fragments.push(ReflectionIn { surface: SurfaceIn { frame_vectors: [opposite; 2], ..exact.surface }, ..exact });
    }
    fragments
}

pub(super) fn frame_zero(p: &Precision) -> Vec<ReflectionIn> {
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
        fragments.push(ReflectionIn { surface: SurfaceIn { normal: vector, ..plain.surface }, ..plain });
        fragments.push(ReflectionIn { surface: SurfaceIn { view: vector, ..plain.surface }, ..plain });
        fragments.push(ReflectionIn { surface: SurfaceIn { frame_vectors: [vector; 2], ..plain.surface }, ..plain });
    }
    fragments
}

pub(super) fn frame_horizon(p: &Precision) -> Vec<ReflectionIn> {
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

pub(super) fn frame_natural(p: &Precision) -> Vec<ReflectionIn> {
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
