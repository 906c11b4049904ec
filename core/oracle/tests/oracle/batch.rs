//! Batches of fragments.

use fixed::types::I2F30;
use roughxel_core::firmware::{Accuracy, Batch, Compact, FaceFootprint, Firmware, Narrow, Paper, Precise, Standard};
use roughxel_core::plan::{Effects, FootprintKind, FrameSystem};
use roughxel_core::ports::{CubeProbe, ReflectionIn};
use roughxel_core::precision::RoughnessKind;

use crate::maps::fragments;

/// All effects, in each system of the tangent basis.
struct Full<A, const SYSTEM: usize>(A);

impl<A: Accuracy, const SYSTEM: usize> Firmware for Full<A, SYSTEM> {
    type Accuracy = A;
    const EFFECTS: Effects = Effects { frame: crate::scalar_api::FRAMES[SYSTEM], ..Effects::ALL };
}

/// A footprint, and the one effect of a number.
struct Single<A, const EFFECT: usize>(A);

impl<A: Accuracy, const EFFECT: usize> Firmware for Single<A, EFFECT> {
    type Accuracy = A;
    const EFFECTS: Effects = {
        let footprint = Effects { footprint: FootprintKind::Face, ..Effects::NONE };
        [
            Effects::NONE,
            Effects { bump: true, ..Effects::NONE },
            footprint,
            Effects { curvature: true, ..footprint },
            Effects { bump: true, ..footprint },
            Effects { roughness: RoughnessKind::Isotropic, ..footprint },
            Effects { roughness: RoughnessKind::Anisotropic, frame: FrameSystem::Natural, ..footprint },
        ][EFFECT]
    };
}

/// Outcomes of a footprint: face, place on it, level of detail, status, probes.
fn all_of<F: Firmware>(footprint: &FaceFootprint<F>) -> (u8, [i32; 2], i32, u32, Vec<CubeProbe>) {
    let st = footprint.st().map(I2F30::to_bits);
    (footprint.face(), st, footprint.lod().to_bits(), footprint.status(), footprint.probes().collect())
}

/// Fragments, some of them degenerate.
fn varied() -> Vec<ReflectionIn> {
    let mut varied: Vec<ReflectionIn> = fragments().iter().map(|(fragment, _)| *fragment).collect();
    for (index, fragment) in varied.iter_mut().enumerate() {
        let surface = &mut fragment.surface;
        match index % 11 {
            1 => surface.view = Default::default(),
            3 => surface.normal = Default::default(),
            5 => surface.frame_vectors[0] = surface.normal,
            7 => fragment.dview = Default::default(),
            _ => surface.frame_vectors[1] = fragment.dview[0],
        }
    }
    varied
}

fn is_that_of_fragments_alone<F: Firmware>(fragments: &[ReflectionIn]) {
    let environment = F::environment(64);
    let mut batch = Batch::<F, 7>::new();
    let mut statuses = 0;
    for fragments in fragments.chunks(7) {
        let footprints = batch.reflect(fragments, &environment);
        assert_eq!(footprints.len(), fragments.len());
        for (fragment, footprint) in fragments.iter().zip(footprints) {
            assert_eq!(all_of(&footprint), all_of(&F::reflect(fragment, &environment)));
            statuses |= footprint.status();
        }
    }
    assert_ne!(statuses, 0, "no fragment is degenerate");
}

pub(crate) fn a_batch_has_the_bits_of_its_fragments_alone() {
    let fragments = &varied();
    assert!(!fragments.len().is_multiple_of(7), "the last batch is full");
    is_that_of_fragments_alone::<Full<Narrow, 0>>(fragments);
    is_that_of_fragments_alone::<Full<Narrow, 1>>(fragments);
    is_that_of_fragments_alone::<Full<Paper, 0>>(fragments);
    is_that_of_fragments_alone::<Full<Compact, 0>>(fragments);
    is_that_of_fragments_alone::<Full<Standard, 0>>(fragments);
    is_that_of_fragments_alone::<Full<Standard, 2>>(fragments);
    is_that_of_fragments_alone::<Full<Precise, 0>>(fragments);
    is_that_of_fragments_alone::<Single<Narrow, 0>>(fragments);
    is_that_of_fragments_alone::<Single<Standard, 1>>(fragments);
    is_that_of_fragments_alone::<Single<Narrow, 2>>(fragments);
    is_that_of_fragments_alone::<Single<Standard, 3>>(fragments);
    is_that_of_fragments_alone::<Single<Narrow, 4>>(fragments);
    is_that_of_fragments_alone::<Single<Standard, 5>>(fragments);
    is_that_of_fragments_alone::<Single<Narrow, 6>>(fragments);
}

pub(crate) fn a_batch_ends_after_its_fragments() {
    assert_eq!(size_of::<Batch<Full<Standard, 0>, 64>>(), 64 * 284, "bytes that the documentation states");
    type Mirror = Single<Standard, 0>;
    let (fragments, environment) = (varied(), Mirror::environment(64));
    let mut batch = Batch::<Mirror, 3>::new();
    assert_eq!(batch.reflect(&fragments, &environment).len(), 3);
    let first = Mirror::reflect(&fragments[0], &environment);
    assert_eq!(all_of(&batch.reflect(&fragments[..1], &environment).next().expect("one")), all_of(&first));
    assert_eq!(batch.reflect(&[], &environment).len(), 0);
}
