//! Whole frames have the same bits in every backend.

use std::path::Path;

use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_host_tests::bars;
use roughxel_host_tests::space::is_full_run;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;
use roughxel_simd::{Backend, InstructionSet};

use super::lane_words::instruction_sets;

/// Scenes with a highlight, with given peaks, with peaks of maps, with horizons.
const LIT_SCENES: [&str; 4] = ["highlight", "velvet", "spheres-sphere", "horizon-plane"];

#[test]
fn frames_have_the_same_bits_in_every_backend_and_for_any_number_of_threads() {
    let backends: Vec<_> = instruction_sets().into_iter().map(Backend::Simd).chain([Backend::Scalar]).collect();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(bars::GOLDEN_FRAMES);
    let golden = std::fs::read_to_string(golden).unwrap();
    for name in bars::SCENES.into_iter().chain(LIT_SCENES) {
        let scene = Scene::builtin(name).unwrap().unwrap().with_size(64, 48).unwrap();
        let peaks = ScenePeaks::new(&scene, true, None, &|_| ()).unwrap();
        for mode in [Mode::Unfiltered, Mode::Isotropic, Mode::Footprint, Mode::Supersampled { edge: 2 }] {
            let prefix = format!("{name} standard {mode} ");
            let expected = golden.lines().find_map(|line| line.strip_prefix(&prefix)).expect("a golden frame");
            for &backend in &backends {
                let prepared = Prepared::with_peaks(&scene, mode, &Precision::STANDARD, &peaks).unwrap();
                let prepared = prepared.with_backend(backend);
                let counts: &[usize] = if is_full_run() || mode == Mode::Footprint { &[1, 2, 7] } else { &[2] };
                for &threads in counts {
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                    let digest = pool.install(|| prepared.render(&|| ())).unwrap().digest();
                    assert_eq!(digest, expected, "{name}, {mode}, {backend}, {threads} threads");
                }
            }
        }
    }
}

#[test]
fn a_backend_is_named_as_it_is_printed() {
    let backends = InstructionSet::available().map(Backend::Simd).chain([Backend::Scalar, Backend::best()]);
    for backend in backends {
        assert_eq!(backend.to_string().parse(), Ok(backend));
    }
    let error = "lanes".parse::<Backend>().unwrap_err();
    assert!(error.contains("scalar"), "{error}");
}
