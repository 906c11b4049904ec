//! Cost of the accuracy knobs, one setting after the other: instructions on every processor, predicted clocks on every soft core. `knobs.json`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use roughxel_core::knob::Knob;
use roughxel_core::precision::{Precision, Profile};
use serde_json::{Map, Value, json};

use crate::cores::{CORES, Core};
use crate::measure::{self, ALL_EFFECTS, IN_A_BATCH, Measured, Numbers, PROBE};
use crate::predict::Known;
use crate::target::{self, Target};
use crate::{Failure, clocks};

/// Program whose clocks are predicted for the cores of [`clocks::TARGETS`]. The instructions of all others are counted.
const CLOCKS: &str = "clocks";

/// Libraries of the f32 baseline, with the plans of [`CLOCKS`] that use them.
const FLOATS: [(&str, &str); 2] = [("libm", "float"), ("micromath", "micromath")];

/// Processors whose instructions are counted.
const TARGETS: [Target; 3] = [Target::Riscv32Imac, Target::ThumbV7M, Target::Riscv32I];

/// Knobs of probes, maps and texels, none of which is in the plan. Each is priced at one other value, which must change nothing.
const NO_EFFECT: [Knob; 4] = [Knob::ProbeWeights, Knob::WeightBits, Knob::Roughness, Knob::RoughnessBits];

/// Approximate time in seconds to build and run a program for all of its processors, on an otherwise idle machine.
const SECONDS: f64 = 3.5;

/// A program at an accuracy.
#[derive(Clone, Copy, Debug)]
struct Run {
    program: &'static str,
    plan: &'static str,
    precision: Precision,
}

impl Run {
    /// Processors on which the program runs.
    fn targets(&self) -> &'static [Target] {
        if self.program == CLOCKS { &clocks::TARGETS } else { &TARGETS }
    }

    /// Name under which the finished run on a processor is kept.
    fn name(&self, target: Target) -> String {
        let Self { program, plan, precision } = self;
        format!("{} {program} {plan} {}", target.name(), settings(precision))
    }

    /// Runs the program, which is built.
    fn numbers(&self, target: Target, cores: &[Known]) -> Result<Numbers, Failure> {
        if self.program == CLOCKS {
            let cores: Vec<Known> = cores.iter().filter(|(core, _)| core.target == target).cloned().collect();
            return clocks::predicted(target, &cores);
        }
        let Measured { mut numbers, image } = measure::measure_built(target, self.program)?;
        numbers.insert("bytes".into(), image.bytes);
        Ok(numbers)
    }
}

/// All knobs in the form of `ROUGHXEL_KNOBS`.
fn settings(p: &Precision) -> String {
    Knob::ALL.map(|knob| format!("{knob}={}", knob.text(knob.value_in(p)))).join(" ")
}

/// Priced settings, each once: the named profiles, every knob alone at each of its values, the grid.
fn points() -> Vec<Precision> {
    let named = Profile::ALL.into_iter().map(Profile::precision);
    let alone = Knob::ALL
        .into_iter()
        .filter(|knob| !NO_EFFECT.contains(knob))
        .flat_map(|knob| knob.values().iter().map(move |value| knob.with(*value, Precision::STANDARD)));
    let mut points: Vec<Precision> = Vec::new();
    for p in named.chain(alone).chain(Precision::grid()) {
        // Profiles differ in knobs without effect. A profile may stand for other settings, but no other setting for a profile.
        let same = |known: &Precision| NO_EFFECT.iter().fold(p, |p, knob| knob.with(knob.value_in(known), p)) == *known;
        if !points.iter().any(same) {
            points.push(p);
        }
    }
    points
}

/// Settings at which probes are priced: every width, all else as in the named profile that is as wide or wider.
fn widths() -> impl Iterator<Item = Precision> {
    Knob::FractionBits.values().iter().map(|p| Precision::of_width(*p))
}

/// A knob without effect at another value.
fn other(knob: Knob) -> Precision {
    let standard = Precision::STANDARD;
    let value =
        knob.values().iter().find(|value| **value != knob.value_in(&standard)).expect("a knob has several values");
    knob.with(*value, standard)
}

/// Every run, in order.
fn runs() -> impl Iterator<Item = Run> {
    let run = |program, plan, precision| Run { program, plan, precision };
    let plan = move |precision| run("plan", ALL_EFFECTS, precision);
    [run("plan", "empty", Precision::STANDARD)]
        .into_iter()
        .chain(points().into_iter().map(plan))
        .chain(NO_EFFECT.into_iter().map(other).map(plan))
        .chain(widths().map(move |p| run("around", "empty", p)))
        .chain(FLOATS.map(|(_, plan)| run(CLOCKS, plan, Precision::STANDARD)))
        .chain(points().into_iter().flat_map(move |p| [ALL_EFFECTS, IN_A_BATCH].map(|plan| run(CLOCKS, plan, p))))
        .chain(widths().map(move |p| run(CLOCKS, PROBE, p)))
}

/// Measures all settings and writes the table.
pub fn run(file: Option<PathBuf>) -> Result<(), Failure> {
    let compiler = compiler()?;
    let cores = clocks::TARGETS.map(clocks::known).into_iter().collect::<Result<Vec<_>, _>>()?.concat();
    let mut kept = Kept::open(&compiler, &cores)?;
    let all: Vec<Run> = runs().collect();
    let missing = |run: &Run| -> Vec<Target> {
        run.targets().iter().copied().filter(|target| !kept.numbers.contains_key(&run.name(*target))).collect()
    };
    let left: Vec<(&Run, Vec<Target>)> =
        all.iter().map(|run| (run, missing(run))).filter(|(_, targets)| !targets.is_empty()).collect();
    eprintln!(
        "{} settings: {} programs, {} of them from a run before, about {:.0} minutes",
        points().len(),
        all.len(),
        all.len() - left.len(),
        left.len() as f64 * SECONDS / 60.0
    );
    let progress = measure::progress(left.len())?;
    for (run, targets) in left {
        progress.set_message(run.plan);
        let accuracy = format!("standard {}", settings(&run.precision));
        Target::build_each(&targets, run.program, run.plan, &accuracy)?;
        let measured = std::thread::scope(|scope| {
            let threads = targets.iter().map(|&target| {
                let cores = &cores;
                scope.spawn(move || run.numbers(target, cores))
            });
            let threads: Vec<_> = threads.collect();
            threads.into_iter().map(|thread| thread.join().expect("a run does not panic")).collect::<Vec<_>>()
        });
        for (&target, numbers) in targets.iter().zip(measured) {
            kept.keep(run.name(target), numbers?)?;
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let text = table(&kept, &compiler)?;
    measure::write_whole(&file.unwrap_or_else(|| target::firmware().join("knobs.json")), &text)?;
    kept.forget()
}

/// Compiler of all programs.
fn compiler() -> Result<String, Failure> {
    let [first, ..] = TARGETS.map(Target::compiler);
    let mut others = TARGETS.into_iter().chain(clocks::TARGETS).map(Target::compiler);
    match others.find(|other| *other != first) {
        Some(other) => Err(Failure::trouble(format!("programs come from two compilers, {first} and {other}"))),
        None => Ok(first),
    }
}

/// Values by the names of the cores.
fn on_each_core(of: impl Fn(&Core) -> Value) -> Value {
    Value::Object(CORES.iter().map(|core| (core.name.to_string(), of(core))).collect())
}

/// The table as JSON, a line for each point.
fn table(kept: &Kept, compiler: &str) -> Result<String, Failure> {
    let run = |program, plan, target, precision| kept.numbers(Run { program, plan, precision }, target);
    let on = |core: &Core, plan, precision| run(CLOCKS, plan, core.target, precision)[core.name];
    let plan = |target, precision| run("plan", ALL_EFFECTS, target, precision);
    let around = |target, precision| run("around", "empty", target, precision);
    let price = |target, p| {
        let empty = run("plan", "empty", target, Precision::STANDARD);
        let numbers = plan(target, p);
        json!({
            "instructions": numbers["instructions"],
            "bytes": numbers["bytes"] - empty["bytes"],
            "stack": numbers["stack"],
        })
    };
    let each = |of: &dyn Fn(Target) -> Value| -> Value {
        TARGETS.map(|target| (target.name().to_string(), of(target))).into_iter().collect::<Map<_, _>>().into()
    };
    for (knob, target) in NO_EFFECT.into_iter().flat_map(|knob| TARGETS.map(|target| (knob, target))) {
        if plan(target, other(knob)) != plan(target, Precision::STANDARD) {
            return Err(Failure::broken(format!(
                "{knob} is listed as without effect, but has one on {}",
                target.name()
            )));
        }
    }
    let float = |target| {
        let numbers = around(target, Precision::STANDARD);
        json!({ "libm": numbers["float libm"], "micromath": numbers["float micromath"] })
    };
    let probe = |p: Precision| {
        let price = |target| {
            let numbers = around(target, p);
            json!({ "place_and_weight": numbers["probe"], "with_texels": numbers["colour"] })
        };
        let clocks = on_each_core(|core| json!(on(core, PROBE, p)));
        json!({ "knobs": numbers_of(&p), "settings": settings(&p), "price": each(&price), "clocks": clocks })
    };
    let point = |p: Precision| {
        let clocks = on_each_core(|core| json!([on(core, ALL_EFFECTS, p), on(core, IN_A_BATCH, p)]));
        json!({ "knobs": numbers_of(&p), "settings": settings(&p), "price": each(&|t| price(t, p)), "clocks": clocks })
    };
    let float_clocks = on_each_core(|core| {
        json!(BTreeMap::from(FLOATS.map(|(library, plan)| (library, on(core, plan, Precision::STANDARD)))))
    });
    for (p, target) in points().into_iter().flat_map(|p| clocks::TARGETS.map(|target| (p, target))) {
        if run(CLOCKS, ALL_EFFECTS, target, p)["check"] != run(CLOCKS, IN_A_BATCH, target, p)["check"] {
            let (name, settings) = (target.name(), settings(&p));
            return Err(Failure::broken(format!(
                "{name}: a batch has not the bits of single fragments with {settings}"
            )));
        }
    }
    let mut text = String::from("{\n");
    for (name, value) in [
        (
            "about",
            json!(
                "Made by `cargo firmware price --knobs`. Instructions are means over the fragments of PRICE.md, of a probe over theirs, \
                 counted by QEMU; bytes are those beyond a program that does nothing; stack is that of the call, in bytes. Clocks are \
                 predicted for the soft cores of PRICE.md: of a point for a fragment alone and in a batch of 64, of a probe with its texels. \
                 A knob is a number: of a choice its place, of directions the steps of the table, 0 for exact. `settings` are the same as \
                 ROUGHXEL_KNOBS has them. `float` is the reflection in f32."
            ),
        ),
        ("plan", json!("reflection, all effects")),
        ("rustc", json!(compiler)),
        ("no_effect", json!(NO_EFFECT.map(Knob::name))),
        ("cores", json!(CORES.map(|core| json!({ "name": core.name, "about": core.about })))),
        ("float", each(&float)),
        ("float_clocks", float_clocks),
    ] {
        let _ = writeln!(text, "{:?}: {value},", name);
    }
    let lines = |values: Vec<Value>| values.iter().map(Value::to_string).collect::<Vec<_>>().join(",\n");
    let _ = writeln!(text, "\"probes\": [\n{}\n],", lines(widths().map(probe).collect()));
    let _ = writeln!(text, "\"points\": [\n{}\n]\n}}", lines(points().into_iter().map(point).collect()));
    Ok(text)
}

/// All knobs as numbers.
fn numbers_of(p: &Precision) -> BTreeMap<&'static str, u32> {
    Knob::ALL.map(|knob| (knob.name(), knob.value_in(p))).into()
}

/// Finished runs, in a file next to the built programs. Runs of the same sources and the same compiler are reused.
struct Kept {
    path: PathBuf,
    file: File,
    numbers: BTreeMap<String, Numbers>,
}

impl Kept {
    /// Opens the file with its finished runs.
    fn open(compiler: &str, cores: &[Known]) -> Result<Self, Failure> {
        let path = target::built().join("knobs.runs");
        let origin = format!("{:016x}", origin(compiler, cores).map_err(Failure::trouble)?);
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        // A run that was interrupted while it wrote has no line end.
        let mut lines = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
        let numbers = match lines.next() {
            Some(of) if of == origin => lines.filter_map(Self::read).collect(),
            _ => BTreeMap::new(),
        };
        let mut kept = String::new();
        let _ = writeln!(kept, "{origin}");
        numbers.iter().for_each(|(name, numbers)| kept += &Self::line(name, numbers));
        let trouble = |error| Failure::trouble(format!("{}: {error}", path.display()));
        std::fs::write(&path, kept).map_err(trouble)?;
        let file = OpenOptions::new().append(true).open(&path).map_err(trouble)?;
        Ok(Self { path, file, numbers })
    }

    fn read(line: &str) -> Option<(String, Numbers)> {
        let (name, numbers) = line.split_once('\t')?;
        Some((name.into(), measure::numbers(&numbers.replace('\t', "\n"))))
    }

    fn line(name: &str, numbers: &Numbers) -> String {
        let numbers: String = numbers.iter().map(|(name, number)| format!("\t{name} {number}")).collect();
        format!("{name}{numbers}\n")
    }

    /// Keeps one more run.
    fn keep(&mut self, name: String, numbers: Numbers) -> Result<(), Failure> {
        let line = Self::line(&name, &numbers);
        self.file
            .write_all(line.as_bytes())
            .map_err(|error| Failure::trouble(format!("{}: {error}", self.path.display())))?;
        self.numbers.insert(name, numbers);
        Ok(())
    }

    /// Numbers of a run on a processor.
    fn numbers(&self, run: Run, target: Target) -> &Numbers {
        &self.numbers[&run.name(target)]
    }

    /// Deletes the file after the table is written; the next table starts anew.
    fn forget(self) -> Result<(), Failure> {
        std::fs::remove_file(&self.path).map_err(|error| Failure::trouble(format!("{}: {error}", self.path.display())))
    }
}

/// Hash of the inputs of programs and predictions: sources, packages, compiler, latencies.
fn origin(compiler: &str, cores: &[Known]) -> std::io::Result<u64> {
    let firmware = target::firmware();
    let mut hasher = DefaultHasher::new();
    compiler.hash(&mut hasher);
    cores.iter().for_each(|(core, latencies)| (core.name, latencies.kept().to_string()).hash(&mut hasher));
    let own = ["src", "build", "Cargo.toml", "Cargo.lock", "board/src/target.rs"];
    let predictions = ["board/src/cores.rs", "board/src/hart.rs", "board/src/predict.rs"];
    let others = ["../../core/src", "../../core/oracle/tests/oracle/tile", "../f32_baseline/src"];
    for part in own.into_iter().chain(predictions).chain(others) {
        hash_files(&firmware.join(part), &mut hasher)?;
    }
    Ok(hasher.finish())
}

fn hash_files(path: &Path, hasher: &mut DefaultHasher) -> std::io::Result<()> {
    if !path.is_dir() {
        std::fs::read(path)?.hash(hasher);
        return Ok(());
    }
    let mut inside = std::fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
    inside.sort();
    inside.iter().try_for_each(|path| hash_files(path, hasher))
}
