//! Speed of the backends of the whole reflection datapath, fetches excluded, on one thread and from memory.
//!
//! `cargo bench -p roughxel-benches --bench backends` runs criterion over every contender and then prints the bars. Every round runs each contender
//! once over the same fragments. A ratio is the median of the rounds' ratios, so a machine that changes its speed affects both sides. Run nothing
//! else at the same time. Exit code 1 if a bar is missed. With a filter or an option only criterion runs, because a part has no ratios.
//!
//! All contenders write what a sampler needs (face, s, t, N, step, LOD, status), from inputs in their own format. *Lanes* include packing fragments
//! into lanes, as the renderer does; the bars use the widest vectors of the machine. *Narrow* is the same backend on the same fragments with a
//! profile on 16-bit words. *f32* is what a user would write instead: plain, compiled as by default, and batched, from fragments in consecutive
//! lanes, with the widest vectors of the machine. *Verilated* is the top of `roughxel verilog`, a fragment a cycle, every output compared. It is
//! not measured if Verilator is missing.

use std::hint::black_box;
use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput};
use fearless_simd::Level;
use roughxel_cases::random_fragment;
use roughxel_cases::stimulus::port_values;
use roughxel_core::datapath::Reflection;
use roughxel_core::design::Design;
use roughxel_core::fx::Fx;
use roughxel_core::plan::{Effects, ReflectionPlan};
use roughxel_core::ports::{Port, ReflectionIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::scalar::Scalar;
use roughxel_core::scalar_api::{environment_scale, reflection};
use roughxel_f32_baseline::batch::{FootprintBlock, FragmentBlock, reflect_batch, reflect_each};
use roughxel_f32_baseline::{Environment, FloatFootprint, Fragment};
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_host_tests::designs::scalar;
use roughxel_host_tests::reference;
use roughxel_host_tests::simulators::{have, run, verilate};
use roughxel_host_tests::table::table;
use roughxel_netlist::bench::Bench;
use roughxel_netlist::verilog::{Options, Verilog};
use roughxel_record as record;
use roughxel_scene::Scene;
use roughxel_shader::{Ports, Shader};
use roughxel_simd::{Backend, InstructionSet};
use roughxel_study::accuracy::{reference_inputs, reference_options};
use roughxel_utilities::output::write_files;
use roughxel_utilities::random::SplitMix64;
use tempfile::TempDir;

/// Fragments of a set: inputs and outputs of one contender stay within a second-level cache.
const FRAGMENTS: usize = 2048;

/// Fragments that pass through the lanes at a time, as in the renderer.
const BATCH: usize = 256;

/// Rounds of the paired measurement.
const ROUNDS: usize = 121;

/// Least time of one contender in one round: long compared with reading the clock, short compared with a time slice of a different process.
const LEAST: Duration = Duration::from_millis(1);

const PROFILE: Precision = Precision::STANDARD;

/// The profile on 16-bit words, for the same fragments.
const NARROW: Precision = Precision::NARROW;

/// A mirror without bumps, roughness or curvature: the least plan with a footprint.
const MIRROR: ReflectionPlan =
    ReflectionPlan { bump: false, roughness: RoughnessKind::None, curvature: false, ..ReflectionPlan::FULL };

/// Requires that `of` is at least `least` times as fast as `over`.
struct Bar {
    of: &'static str,
    over: &'static str,
    least: f64,
    /// Text printed if the bar is missed.
    reason: &'static str,
}

const NARROW_REASON: &str = "mantissas and their products take half the vectors, but counts keep their 32 bits, and each fragment is \
                             put into its lane and taken out of it one word after the other";

const BARS: [Bar; 8] = [
    Bar {
        of: "lanes",
        over: "scalar",
        least: 3.0,
        reason: "vectors of this machine are too narrow, or a different process ran",
    },
    Bar {
        of: "scalar, narrow",
        over: "scalar",
        least: 1.0,
        reason: "words of 16 bits save a scalar processor nothing",
    },
    Bar { of: "lanes, narrow", over: "lanes", least: 2.0, reason: NARROW_REASON },
    Bar { of: "lanes, avx2, narrow", over: "lanes, avx2", least: 2.2, reason: NARROW_REASON },
    Bar { of: "lanes, narrow", over: "f32 plain", least: 1.0, reason: NARROW_REASON },
    Bar {
        of: "lanes",
        over: "f32 plain",
        least: 1.0,
        reason: "a float is normalised and rounded by the instruction that makes it; an exact product is 64 bits wide here, \
                 and its leading zeros, shift and rounding are 5 to 10 instructions more",
    },
    Bar {
        of: "lanes",
        over: "f32 batched",
        least: 0.4,
        reason: "0.4 × the batched f32 is some 19 × the scalar backend, more than lanes of 64-bit intermediates can be \
                 faster: 16 of them are two vectors of 512 bits for each operation, and normalisation comes on top",
    },
    Bar {
        of: "lanes",
        over: "verilated",
        least: 20.0,
        reason: "Verilator turns the generated modules into straight C++ on words, half a million fragments a second: a \
                 third of the scalar backend, so this bar asks lanes for 6 × scalar",
    },
];

/// Fragments that every contender computes, and the edge of the environment that all of them see.
struct Set {
    name: &'static str,
    fragments: Vec<ReflectionIn>,
    edge_texels: u16,
}

/// One way to compute a set.
struct Contender<'a> {
    name: &'static str,
    /// Computes the whole set the given number of times and returns the time it took.
    passes: Box<dyn FnMut(u64) -> Duration + 'a>,
}

impl<'a> Contender<'a> {
    /// `pass` computes the set once.
    fn new(name: &'static str, mut pass: impl FnMut() + 'a) -> Self {
        let passes = move |count| {
            let start = Instant::now();
            (0..count).for_each(|_| pass());
            start.elapsed()
        };
        Self { name, passes: Box::new(passes) }
    }
}

/// Random fragments in the range of `f32`.
fn random() -> Set {
    let fragments = (0..).map(|index| random_fragment("bench", index, &PROFILE)).filter(Fragment::in_range);
    let edge_texels = 256;
    let fragments = fragments.map(|fragment| ReflectionIn { edge_texels, ..fragment });
    Set { name: "random", fragments: fragments.take(FRAGMENTS).collect(), edge_texels }
}

/// Fragments of a picture in which every block has work to do, in row order.
fn frame() -> Set {
    let scene = Scene::builtin("globe").expect("the scene is built in").expect("built-in scenes are read");
    let prepared = Prepared::new(&scene, Mode::Footprint, &PROFILE).expect("built-in scenes are drawn");
    let captured = prepared.capture(FRAGMENTS).expect("built-in scenes are drawn");
    let full = captured.into_iter().filter(|(_, plan)| plan.on_face() == ReflectionPlan::FULL);
    let fragments: Vec<_> = full.map(|(fragment, _)| fragment).collect();
    assert_eq!(fragments.len(), FRAGMENTS, "every fragment of the globe goes through every block");
    Set { name: "globe", edge_texels: fragments[0].edge_texels, fragments }
}

/// The Verilator model of the reflection datapath.
struct Model {
    directory: TempDir,
    verilog: Verilog,
    program: PathBuf,
}

impl Model {
    const DESIGN: Design = Design::Reflection;

    /// Builds the model with the C++ compiler's highest optimisation; `None` without Verilator.
    fn build(sets: &[Set]) -> Option<Self> {
        if !have("verilator") {
            return None;
        }
        let options = Options::new("standard", PROFILE, Effects::ALL);
        let verilog = record::verilog(Self::DESIGN, &options).expect("the datapath is generated");
        let directory = tempfile::tempdir().expect("a temporary directory");
        write_files(directory.path(), verilog.in_order()).expect("the directory can be written");
        let mut model = Self { directory, verilog, program: PathBuf::new() };
        let net = record::net(Self::DESIGN, &Effects::ALL, &PROFILE);
        for set in sets {
            let mut random = SplitMix64::for_element(set.name, 0);
            let mut ports = |fragment| {
                let ports = port_values(Self::DESIGN, &net, fragment, &Effects::ALL, &PROFILE, &mut random);
                ports.into_iter().next().expect("a fragment is a vector")
            };
            let inputs: Vec<_> = set.fragments.iter().map(&mut ports).collect();
            let integers = |ports: &Vec<i64>| scalar(Self::DESIGN, ports, &Effects::ALL, &PROFILE).values().to_vec();
            let outputs: Vec<Vec<i64>> = inputs.iter().map(integers).collect();
            let top = model.verilog.top.as_ref().expect("the datapath has a top");
            let bench = Bench::new(top, &inputs, &outputs).expect("the ports hold the fragments");
            let vectors = model.vectors(set);
            std::fs::create_dir(&vectors).expect("the directory can be written");
            for place in [&vectors, model.directory.path()] {
                write_files(place, bench.files()).expect("the directory can be written");
            }
            if model.program.as_os_str().is_empty() {
                model.program = verilate(model.directory.path(), bench.module(), "OPT_FAST=-O3");
            }
        }
        Some(model)
    }

    /// Path of the vectors of a set.
    fn vectors(&self, set: &Set) -> PathBuf {
        self.directory.path().join(set.name)
    }

    /// Runs the vectors of a set `count` times; returns the time of the cycles only.
    fn passes(&self, set: &Set, count: u64) -> Duration {
        let output = run(Command::new(&self.program).arg(self.vectors(set)).arg(count.to_string()));
        let text = String::from_utf8_lossy(&output.stdout);
        let seconds = text.split_whitespace().rev().nth(1).and_then(|seconds| seconds.parse().ok());
        Duration::from_secs_f64(seconds.unwrap_or_else(|| panic!("the testbench prints {text}")))
    }
}

/// Every contender of a set with its inputs and outputs in memory.
fn contenders<'a>(set: &'a Set, model: Option<&'a Model>) -> Vec<Contender<'a>> {
    let ports = &set.fragments;
    // Constants here as in the emulator: a profile known to the compiler makes the scalar backend 1.25 times as fast.
    let [profile, narrow] = [PROFILE, NARROW].map(black_box);
    let scalar = |name, plan: ReflectionPlan, profile: Precision| {
        let scale = environment_scale(set.edge_texels, &profile);
        let mut sampled = vec![[0; 8]; ports.len()];
        Contender::new(name, move || {
            for (fragment, sampled) in ports.iter().zip(&mut sampled) {
                *sampled = sampler_words(&reflection(&fragment.wires(), &scale, &plan, &profile));
            }
            black_box(&mut sampled);
        })
    };

    let edge_texels = set.edge_texels;
    let lanes = |name, set, profile: Precision| {
        let scale = environment_scale(edge_texels, &profile);
        let mut inputs = Ports::default();
        Contender::new(name, move || {
            for fragments in ports.chunks(BATCH) {
                inputs.clear();
                inputs.extend(fragments.iter().map(Port::wires));
                black_box(inputs.footprints(Shader::new(Backend::Simd(set), &profile), &scale, &ReflectionPlan::FULL));
            }
        })
    };

    let inputs: Vec<_> = ports.iter().map(reference_inputs).collect();
    let options = reference_options(&ReflectionPlan::FULL, &PROFILE);
    let mut outputs = Vec::with_capacity(ports.len());
    let reference = move || {
        outputs.clear();
        outputs.extend(inputs.iter().map(|inputs| {
            let out = reference::reflection(inputs, &options);
            (out.selection, out.probes)
        }));
        black_box(&mut outputs);
    };

    let environment = Environment::new(u32::from(set.edge_texels));
    let fragments: Vec<_> = ports.iter().map(Fragment::from).collect();
    let blocks = FragmentBlock::blocks(&fragments);
    let mut footprints = vec![FloatFootprint::default(); fragments.len()];
    let plain = move || {
        reflect_each(&environment, &fragments, &mut footprints);
        black_box(&mut footprints);
    };
    let mut footprint_blocks = vec![FootprintBlock::default(); blocks.len()];
    let batched = move || {
        reflect_batch(&environment, &blocks, &mut footprint_blocks);
        black_box(&mut footprint_blocks);
    };

    let mut contenders = vec![
        scalar("scalar", ReflectionPlan::FULL, profile),
        scalar("scalar, narrow", ReflectionPlan::FULL, narrow),
        scalar("scalar, mirror plan", MIRROR, profile),
        Contender::new("float64 reference", reference),
        Contender::new("f32 plain", plain),
        Contender::new("f32 batched", batched),
    ];
    for set in InstructionSet::available() {
        let (standard, narrower) = match set {
            set if Some(set) == InstructionSet::best() => ("lanes", "lanes, narrow"),
            InstructionSet::Avx2 => ("lanes, avx2", "lanes, avx2, narrow"),
            InstructionSet::Avx512 => ("lanes, avx512", "lanes, avx512, narrow"),
        };
        contenders.push(lanes(standard, set, profile));
        contenders.push(lanes(narrower, set, narrow));
    }
    if let Some(model) = model {
        contenders.push(Contender { name: "verilated", passes: Box::new(|count| model.passes(set, count)) });
    }
    contenders
}

/// Outputs of the stages that a sampler needs.
fn sampler_words(stages: &Reflection<Scalar>) -> [i32; 8] {
    let Reflection { point, probes, status, .. } = stages;
    let [s, t] = point.st.map(Fx::raw);
    let [step_s, step_t] = probes.step.map(Fx::raw);
    [point.select.index().raw(), s, t, probes.count.raw(), step_s, step_t, probes.lod.raw(), status.raw()]
}

/// Seconds per fragment of every contender, by name, one figure for each round.
fn paired_rounds(set: &Set, model: Option<&Model>) -> Vec<(&'static str, Vec<f64>)> {
    let mut contenders: Vec<_> = contenders(set, model)
        .into_iter()
        .map(|mut contender| {
            let once = (contender.passes)(1).max(Duration::from_nanos(1));
            let passes = LEAST.as_nanos().div_ceil(once.as_nanos()) as u64;
            (contender, passes, Vec::with_capacity(ROUNDS))
        })
        .collect();
    for _ in 0..ROUNDS {
        for (contender, passes, seconds) in &mut contenders {
            let fragments = *passes as f64 * set.fragments.len() as f64;
            seconds.push((contender.passes)(*passes).as_secs_f64() / fragments);
        }
    }
    contenders.into_iter().map(|(contender, _, seconds)| (contender.name, seconds)).collect()
}

/// The middle figure of an odd number of figures.
fn median(figures: impl Iterator<Item = f64>) -> f64 {
    let mut figures: Vec<_> = figures.collect();
    figures.sort_by(f64::total_cmp);
    figures[figures.len() / 2]
}

/// Prints speeds and bars of every set. Returns true if no bar is missed.
fn report(sets: &[Set], model: Option<&Model>) -> bool {
    let mut speeds = table(["fragments", "by", "10⁶/s", "ns", "× scalar"], 2..5);
    let mut bars = table(["fragments", "ratio", "measured", "bar", ""], 2..4);
    let (mut holds, mut missed) = (true, Vec::new());
    for set in sets {
        let rounds = paired_rounds(set, model);
        let seconds = |name| rounds.iter().find(|(known, _)| *known == name).map(|(_, seconds)| seconds);
        let ratio = |of, over| {
            let pairs = seconds(of)?.iter().zip(seconds(over)?);
            Some(median(pairs.map(|(of, over)| over / of)))
        };
        for (name, seconds) in &rounds {
            let typical = median(seconds.iter().copied());
            let [speed, time] = [1e-6 / typical, 1e9 * typical].map(|figure| format!("{figure:.2}"));
            let ratio = ratio(*name, "scalar").map_or_else(String::new, |ratio| format!("{ratio:.2}"));
            speeds.add_row([set.name, name, &speed, &time, &ratio]);
        }
        for Bar { of, over, least, reason } in BARS {
            let (measured, verdict) = match ratio(of, over) {
                None => ("–".to_string(), "NOT MEASURED"),
                Some(ratio) => (format!("{ratio:.2}"), if ratio >= least { "met" } else { "MISSED" }),
            };
            if verdict == "MISSED" {
                holds = false;
                missed.push(format!("{}, {of} / {over}: {reason}.", set.name));
            }
            bars.add_row([set.name, &format!("{of} / {over}"), &measured, &format!("≥ {least:.1}"), verdict]);
        }
    }
    let level = format!("{:?}", Level::new());
    let level = level.split('(').next().unwrap_or(&level);
    println!("\nMedians of {ROUNDS} rounds, one thread; widest vectors here: {level}.\n{speeds}\n{bars}");
    missed.iter().for_each(|line| println!("{line}"));
    holds
}

fn main() -> ExitCode {
    let sets = [frame(), random()];
    let model = Model::build(&sets);
    let mut criterion = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
        .configure_from_args();
    for set in &sets {
        let mut group = criterion.benchmark_group(format!("fragment/{}", set.name));
        group.throughput(Throughput::Elements(set.fragments.len() as u64));
        for mut contender in contenders(set, model.as_ref()) {
            group.bench_function(contender.name, |bencher| bencher.iter_custom(&mut contender.passes));
        }
        group.finish();
    }
    criterion.final_summary();
    let whole = std::env::args().skip(1).eq(["--bench"]);
    if !whole || report(&sets, model.as_ref()) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
