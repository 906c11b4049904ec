//! Speed of making vectors.
//!
//! `cargo bench -p roughxel-benches --bench vectors` exports the random set of each datapath in `standard` on one thread, as bytes and as text,
//! with and without the results of stages. It prints millions of vectors a second, for the fastest of some exports. `inputs` makes only the inputs
//! of the set. `hash` is the share that SHA-256 of the output takes by itself. It takes a minute.

use std::hint::black_box;
use std::time::Duration;

use roughxel_benches::fastest;
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_host_tests::table::table;
use roughxel_vectors::{
    Form, InputSource, Ports, RANDOM_SETS, RandomSet, RandomSetSummary, SetInfo, Words, export_with,
};
use sha2::{Digest, Sha256};

/// Vectors of an export.
const COUNT: u64 = 1_000_000;
/// Vectors whose inputs are made at once, as in an export.
const TASK: u64 = 512;
/// Exports of which the fastest counts.
const EXPORTS: usize = 5;

fn main() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("the thread pool can be created");
    let precision = Precision::STANDARD;
    let mut table = table(["set", "words", "bytes a vector", "million a second", "hash"], 2..5);
    let rate = |time: Duration| format!("{:.2}", COUNT as f64 / time.as_secs_f64() / 1e6);
    for RandomSetSummary { name, datapath, description } in RANDOM_SETS {
        let input = RandomSet { datapath, seed: name, precision: &precision };
        let mut ports = Ports::new(datapath);
        let (_, inputs) = fastest(EXPORTS, || {
            for first in (0..COUNT).step_by(TASK as usize) {
                input.fill(first..COUNT.min(first + TASK), black_box(&mut ports));
            }
        });
        table.add_row([name.into(), "inputs".into(), String::new(), rate(inputs), String::new()]);
        for (what, taps, form) in [
            ("ports, .bin", false, Form::Bin),
            ("ports, .hex", false, Form::Hex),
            ("all, .bin", true, Form::Bin),
            ("all, .hex", true, Form::Hex),
        ] {
            let (profile, words) = ("standard", Words { taps, form });
            let (seed, effects) = (Some(name), Effects::ALL);
            let info = SetInfo { name, description, seed, datapath, effects, precision, profile, words };
            let (bytes, time) = one_thread.install(|| {
                fastest(EXPORTS, || {
                    let manifest = export_with(&info, COUNT, &input, directory.path(), &|_| {});
                    manifest.expect("the set can be written").files[0].bytes
                })
            });
            let text = vec![0; bytes as usize];
            let (_, hash) = fastest(EXPORTS, || black_box(Sha256::digest(black_box(&text))));
            table.add_row([
                name.into(),
                what.into(),
                format!("{:.0}", bytes as f64 / COUNT as f64),
                rate(time),
                format!("{:.0} %", 100.0 * hash.as_secs_f64() / time.as_secs_f64()),
            ]);
        }
    }
    println!("Fastest of {EXPORTS} exports of {COUNT} vectors, one thread.\n{table}");
}
