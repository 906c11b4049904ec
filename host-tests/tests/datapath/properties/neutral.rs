//! A block that is off equals a neutral input.

use fixed::types::{I2F30, I4F28};
use roughxel_core::plan::{FootprintKind, ReflectionPlan};
use roughxel_core::ports::{BlockVector, ReflectionIn, ReflectionOut, SurfaceIn};
use roughxel_core::precision::RoughnessKind;
use roughxel_core::status::StatusBit;
use roughxel_host_tests::space::profiles;

use super::everywhere;

#[test]
fn bump_off_equals_offsets_of_zero() {
    for (name, p) in profiles() {
        for roughness in [RoughnessKind::None, RoughnessKind::Anisotropic] {
            let on = ReflectionPlan { roughness, ..ReflectionPlan::FULL };
            let off = ReflectionPlan { bump: false, ..on };
            everywhere(name, &p, 10_000, |fragment| {
                let flat =
                    ReflectionIn { surface: SurfaceIn { offset: [I4F28::ZERO; 2], ..fragment.surface }, ..*fragment };
                let (with, without) = (flat.reflect(&on, &p), flat.reflect(&off, &p));
                // Without roughness nothing needs the tangent basis: neither it nor its pole exists.
                let expected = if roughness == RoughnessKind::None {
                    let status = with.status & !(StatusBit::FramePole.mask());
                    ReflectionOut { frame: without.frame, status, ..with }
                } else {
                    with
                };
                assert_eq!(without, expected, "{flat:?}");
            });
        }
    }
}

#[test]
fn roughness_off_equals_no_roughness() {
    let on = ReflectionPlan::FULL;
    let off = ReflectionPlan { roughness: RoughnessKind::None, ..on };
    for (name, p) in profiles() {
        everywhere(name, &p, 10_000, |fragment| {
            let smooth =
                ReflectionIn { surface: SurfaceIn { roughness: [I4F28::ZERO; 3], ..fragment.surface }, ..*fragment };
            assert_eq!(smooth.reflect(&on, &p), smooth.reflect(&off, &p), "{smooth:?}");
            assert_eq!(fragment.reflect(&off, &p), smooth.reflect(&off, &p), "D is not looked at");
        });
    }
}

#[test]
fn isotropic_roughness_equals_anisotropic_roughness_of_a_circle() {
    let anisotropic = ReflectionPlan::FULL;
    let isotropic = ReflectionPlan { roughness: RoughnessKind::Isotropic, ..anisotropic };
    for (name, p) in profiles() {
        everywhere(name, &p, 10_000, |fragment| {
            let [i1, _, _] = fragment.surface.roughness;
            let circle = ReflectionIn {
                surface: SurfaceIn { roughness: [i1, I4F28::ZERO, i1], ..fragment.surface },
                ..*fragment
            };
            let single = ReflectionIn {
                surface: SurfaceIn { roughness: [i1, I4F28::MAX, I4F28::MIN], ..fragment.surface },
                ..*fragment
            };
            assert_eq!(circle.reflect(&anisotropic, &p), single.reflect(&isotropic, &p), "{circle:?}");
        });
    }
}

#[test]
fn curvature_off_equals_a_flat_surface() {
    let on = ReflectionPlan::FULL;
    let off = ReflectionPlan { curvature: false, ..on };
    for (name, p) in profiles() {
        everywhere(name, &p, 10_000, |fragment| {
            let flat = ReflectionIn { dnormal: [BlockVector::default(); 2], ..*fragment };
            assert_eq!(flat.reflect(&on, &p), flat.reflect(&off, &p), "{flat:?}");
            assert_eq!(fragment.reflect(&off, &p), flat.reflect(&off, &p), "dn is not looked at");
        });
    }
}

#[test]
fn footprint_off_leaves_one_probe_at_the_finest_level_of_the_same_point() {
    let on = ReflectionPlan::FULL;
    let off = ReflectionPlan { footprint: FootprintKind::None, ..on };
    let of_footprint = [StatusBit::FootprintZero, StatusBit::FootprintSaturated, StatusBit::ProbesCapped];
    let of_footprint = of_footprint.into_iter().fold(0, |bits, bit| bits | bit.mask());
    for (name, p) in profiles() {
        everywhere(name, &p, 10_000, |fragment| {
            let (with, without) = (fragment.reflect(&on, &p), fragment.reflect(&off, &p));
            let expected = ReflectionOut {
                frame: with.frame,
                normal_mod: with.normal_mod,
                reflected: with.reflected,
                face: with.face,
                st: with.st,
                direction: [I2F30::ONE, I2F30::ZERO],
                probes: 1,
                status: with.status & !of_footprint | StatusBit::FootprintZero.mask(),
                ..ReflectionOut::default()
            };
            assert_eq!(without, expected, "{fragment:?}");
        });
    }
}
