//! The host clock: time of fragments and frames on one thread of this machine, as ratios to `standard`.
//!
//! A ratio is the median over rounds. In each round the two sides run one after the other, so that a temporary slowdown of the
//! machine affects each side. Its noise is the spread of the rounds. The load of other programs is read from the system if the
//! system reports it; a figure measured under load is marked.

use std::fs;
use std::hint::black_box;
use std::time::{Duration, Instant};

use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::{Port, ReflectionIn, ReflectionInput};
use roughxel_core::precision::Precision;
use roughxel_core::scalar_api::environment_scale;
use roughxel_f32_baseline::batch::{FootprintBlock, FragmentBlock, reflect_batch, reflect_each};
use roughxel_f32_baseline::{Environment, FloatFootprint, Fragment};
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_reference as reference;
use roughxel_scene::Scene;
use roughxel_shader::{Ports, Shader};
use roughxel_simd::Backend;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::accuracy::{reference_inputs, reference_options};

/// Share of a core used by others above which a figure counts as measured under load.
const QUIET: f64 = 0.1;
/// Resolution of the system's processor times, seconds.
const TICK: f64 = 0.01;
/// Noise of a ratio that also counts as load.
const NOISY: f64 = 0.25;
/// Least noise of a ratio. Two runs of one program differ by this much whatever their rounds say: memory addresses and
/// temperature change. From one full study to the next, 16 of 293 ratios moved by more than 3 % and more than half the spread of
/// 80 % of the rounds.
const LEAST_NOISE: f64 = 0.05;

/// Result of a time measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Nanoseconds of a fragment, or of a pixel of a frame.
    pub ns: f64,
    /// Time as a multiple of that of `standard` on the same backend.
    pub ratio: f64,
    /// Uncertainty of the ratio, as a multiple of it: the spread of 80 % of the rounds, and at least 5 %.
    pub noise: f64,
    /// Share of a core used by other programs; `None` if the system does not report it.
    pub others: Option<f64>,
    /// True if the load or the noise makes the figure worthless.
    pub loaded: bool,
}

/// Length of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rounds {
    /// Rounds, an odd number.
    pub count: usize,
    /// Least time of a side in a round, milliseconds.
    pub least_ms: u64,
}

/// A repeatable computation.
pub type Pass<'a> = Box<dyn FnMut() + 'a>;

/// Times `a` against `b`; each works on `units` fragments or pixels.
pub fn time(a: &mut Pass<'_>, b: &mut Pass<'_>, units: usize, rounds: Rounds) -> Timing {
    let load = Load::now();
    let begin = Instant::now();
    let least = Duration::from_millis(rounds.least_ms);
    let repeats = |pass: &mut Pass<'_>| {
        let start = Instant::now();
        pass();
        least.as_nanos().div_ceil(start.elapsed().as_nanos().max(1)).clamp(1, 1 << 20) as u32
    };
    let counts = [repeats(a), repeats(b)];
    let run = |pass: &mut Pass<'_>, count: u32| {
        let start = Instant::now();
        (0..count).for_each(|_| pass());
        start.elapsed().as_secs_f64() / f64::from(count)
    };
    let (mut ratios, mut times) = (Vec::new(), Vec::new());
    for round in 0..rounds.count.max(1) {
        // The sides take turns in going first.
        let (of_a, of_b) = if round % 2 == 0 {
            (run(a, counts[0]), run(b, counts[1]))
        } else {
            let of_b = run(b, counts[1]);
            (run(a, counts[0]), of_b)
        };
        ratios.push(of_a / of_b);
        times.push(of_a);
    }
    let others =
        load.zip(Load::now()).map(|(before, after)| after.others_since(before) / begin.elapsed().as_secs_f64());
    let ratio = quantile(&mut ratios, 0.5);
    let spread = quantile(&mut ratios, 0.9) - quantile(&mut ratios, 0.1);
    let noise = spread.max(LEAST_NOISE * ratio);
    Timing {
        ns: 1e9 * quantile(&mut times, 0.5) / units.max(1) as f64,
        ratio,
        noise,
        others,
        loaded: others.is_some_and(|others| others > QUIET + 2.0 * TICK / begin.elapsed().as_secs_f64())
            || noise > NOISY * ratio,
    }
}

fn quantile(figures: &mut [f64], share: f64) -> f64 {
    figures.sort_by(f64::total_cmp);
    figures[(share * (figures.len() - 1) as f64).round() as usize]
}

/// Processor seconds of the machine, and of this program.
#[derive(Clone, Copy, Debug)]
struct Load {
    busy: f64,
    own: f64,
}

impl Load {
    /// Reads the times that Linux reports; `None` elsewhere.
    fn now() -> Option<Self> {
        // Ticks are 10 ms on every Linux that runs on hosts; user, nice, system, idle, iowait, irq, softirq, steal.
        let all = fs::read_to_string("/proc/stat").ok()?;
        let ticks: Vec<f64> = all.lines().next()?.split_whitespace().skip(1).flat_map(str::parse).collect();
        let busy = [0, 1, 2, 5, 6, 7].iter().map(|&i| ticks.get(i).copied().unwrap_or(0.0)).sum::<f64>() / 100.0;
        let own = fs::read_to_string("/proc/self/stat").ok()?;
        // The program's name may contain any character; it ends at the last bracket.
        let own: Vec<f64> = own.rsplit_once(')')?.1.split_whitespace().skip(11).take(2).flat_map(str::parse).collect();
        Some(Self { busy, own: own.iter().sum::<f64>() / 100.0 })
    }

    /// Processor seconds of other programs.
    fn others_since(self, before: Self) -> f64 {
        ((self.busy - before.busy) - (self.own - before.own)).max(0.0)
    }
}

/// Fragments in a batch through the lanes, as in a frame.
const BATCH: usize = 256;
/// Fragments of a pass: inputs and outputs stay within a second-level cache.
const FRAGMENTS: usize = 2048;

/// Fragments of a frame in which every stage has work to do.
pub struct TimedFragments {
    ports: Vec<ReflectionIn>,
    wires: Vec<ReflectionInput<i32>>,
    edge_texels: u16,
}

impl TimedFragments {
    /// Takes the fragments of the scene `globe`, in the order of its rows.
    ///
    /// # Panics
    /// If few of them have every effect.
    pub fn new() -> Result<Self, StudyError> {
        let scene = Scene::open("globe")?;
        let prepared = Prepared::new(&scene, Mode::Footprint, &Precision::STANDARD)?;
        let captured = prepared.capture(FRAGMENTS)?;
        // Its bumps are rough enough for footprints on the sphere; the measurement is of footprints on a face, which f32 has,
        // too.
        let full = captured
            .into_iter()
            .filter(|(fragment, plan)| plan.on_face() == ReflectionPlan::FULL && Fragment::in_range(fragment));
        let ports: Vec<_> = full.map(|(fragment, _)| fragment).collect();
        assert!(
            ports.len() >= FRAGMENTS / 2,
            "{} fragments with all effects: a pass of fewer measures nothing",
            ports.len()
        );
        let wires = ports.iter().map(Port::wires).collect();
        let edge_texels = ports.first().map_or(1, |fragment| fragment.edge_texels);
        Ok(Self { ports, wires, edge_texels })
    }

    /// Fragments of a pass.
    pub fn fragments(&self) -> usize {
        self.ports.len()
    }

    /// The whole reflection of every fragment, fetches excluded.
    pub fn integers(&self, backend: Backend, p: &Precision) -> Pass<'_> {
        // The profile is data, as in the emulator: a profile known to the compiler makes the scalar backend 1.25 times as fast.
        let p = black_box(*p);
        let scale = environment_scale(self.edge_texels, &p);
        Box::new(move || {
            let mut ports = Ports::default();
            for inputs in self.wires.chunks(BATCH) {
                ports.clear();
                ports.extend(inputs.iter().copied());
                black_box(ports.footprints(Shader::new(backend, &p), &scale, &ReflectionPlan::FULL));
            }
        })
    }

    /// The whole reflection in float64, by the reference.
    pub fn float64(&self) -> Pass<'_> {
        let inputs: Vec<_> = self.ports.iter().map(reference_inputs).collect();
        let options = reference_options(&ReflectionPlan::FULL, &Precision::STANDARD);
        Box::new(move || {
            for inputs in &inputs {
                let outputs = reference::reflection(inputs, &options);
                black_box((outputs.selection, outputs.probes));
            }
        })
    }

    /// The whole reflection in f32, one fragment at a time.
    pub fn float32(&self) -> Pass<'_> {
        let environment = Environment::new(self.edge_texels.into());
        let fragments: Vec<_> = self.ports.iter().map(Fragment::from).collect();
        let mut footprints = vec![FloatFootprint::default(); fragments.len()];
        Box::new(move || {
            reflect_each(&environment, &fragments, &mut footprints);
            black_box(&mut footprints);
        })
    }

    /// The whole reflection in f32 for the vectors of the machine.
    pub fn float32_batched(&self) -> Pass<'_> {
        let environment = Environment::new(self.edge_texels.into());
        let fragments: Vec<_> = self.ports.iter().map(Fragment::from).collect();
        let blocks = FragmentBlock::blocks(&fragments);
        let mut footprints = vec![FootprintBlock::default(); blocks.len()];
        Box::new(move || {
            reflect_batch(&environment, &blocks, &mut footprints);
            black_box(&mut footprints);
        })
    }
}

/// A frame, drawn by the calling thread.
pub fn frame<'a>(prepared: &'a Prepared<'_>) -> Pass<'a> {
    Box::new(move || {
        // Errors of a scene were reported when it was prepared.
        let _ = black_box(prepared.render(&|| ()));
    })
}

/// The machine of the measurements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// The processor by its own name, if the system reports it.
    pub processor: String,
    /// Threads that run at once.
    pub threads: usize,
    /// Operating system and architecture.
    pub system: String,
    /// Lanes of frames.
    pub lanes: String,
    /// Compiler of the program.
    pub rustc: String,
    /// The program's version.
    pub program: String,
}

impl Machine {
    /// This machine.
    pub fn here() -> Self {
        let processors = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let name = processors.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
        Self {
            processor: name.map_or_else(|| "unknown".into(), |(_, name)| name.trim().into()),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            lanes: Backend::best().to_string(),
            rustc: env!("ROUGHXEL_RUSTC").into(),
            program: format!("roughxel {}", env!("CARGO_PKG_VERSION")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Timed fragments have the plan that is asked for: footprints on a face, so that times depend on the profile.
    #[test]
    fn there_are_fragments_to_measure() {
        let timed = TimedFragments::new().expect("the scene can be drawn");
        assert!(timed.fragments() >= FRAGMENTS / 2);
    }
}
