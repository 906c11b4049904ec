//! Measures the figures of `docs/performance.md`, keeps them in `docs/performance.json` and fills the tables of the page.
//!
//! `cargo run --release -p roughxel-host-tests --bin performance` measures every section, which takes about 15 minutes on a quiet machine. Names of
//! sections as arguments measure only those; `--list` names them. `--fill` measures nothing and fills the page from the file. Exit code 0 if the
//! page is filled, 1 if a section fails (the others are kept), 2 for wrong arguments.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Instant;

use roughxel_host_tests::imports::workspace_root;
use roughxel_host_tests::performance::{self, Section};
use roughxel_study::host::Machine;
use roughxel_utilities::output::OutputFile;
use serde_json::Value;

const USAGE: &str = "performance [SECTION...] | --list | --fill
  SECTION  sections to measure, default all
  --list   print the sections and their commands
  --fill   fill docs/performance.md from docs/performance.json without measuring";

/// Columns and rows of a section.
type Table = (Vec<String>, Vec<Vec<String>>);

/// A section that this program can measure.
struct Measure {
    name: &'static str,
    /// Command of the head line.
    command: &'static str,
    /// Conditions besides machine, compiler, date and commit.
    note: &'static str,
    /// False for figures that are counted: they need no machine.
    is_timed: bool,
    run: fn() -> Result<Table, String>,
}

const MEASURES: [Measure; 9] = [
    Measure {
        name: "hardware",
        command: "cargo run --release -- cost --profile all --design DESIGN",
        note: "counted",
        is_timed: false,
        run: hardware,
    },
    Measure {
        name: "sphere",
        command: "cargo full lobes -- --nocapture",
        note: "no times",
        is_timed: false,
        run: sphere,
    },
    Measure {
        name: "host",
        command: "cargo bench -p roughxel-benches --bench backends",
        note: "fragments of globe, one thread",
        is_timed: true,
        run: host,
    },
    Measure {
        name: "peaks",
        command: "cargo run --release -- render SCENE --mode MODE --threads 1 --json",
        note: "640×480, one thread, fastest of seven",
        is_timed: true,
        run: peaks,
    },
    Measure {
        name: "memory",
        command: "cargo test --release -p roughxel-frame --test memory -- --nocapture",
        note: "4096×1536",
        is_timed: false,
        run: memory,
    },
    Measure {
        name: "start",
        command: "cargo run --release -- demo",
        note: "fresh clone, crates already downloaded",
        is_timed: true,
        run: start,
    },
    Measure {
        name: "effects",
        command: "cargo bench -p roughxel-benches --bench effects",
        note: "160×120, one thread",
        is_timed: true,
        run: effects,
    },
    Measure {
        name: "vectors",
        command: "cargo bench -p roughxel-benches --bench vectors",
        note: "one thread",
        is_timed: true,
        run: vectors,
    },
    Measure {
        name: "processors",
        command: "cargo firmware price",
        note: "counted in QEMU, read from emulator/firmware/PRICE.md",
        is_timed: false,
        run: processors,
    },
];

/// Standard output of a command in the root of the workspace. A benchmark that misses a bar exits with 1 and still prints its tables.
fn output(program: &str, arguments: &[&str], directory: &Path) -> Result<String, String> {
    let failed = |what: String| format!("{program} {}: {what}", arguments.join(" "));
    let run = Command::new(program).args(arguments).current_dir(directory).output();
    let run = run.map_err(|error| failed(error.to_string()))?;
    if !run.status.success() && run.stdout.is_empty() {
        return Err(failed(String::from_utf8_lossy(&run.stderr).into_owned()));
    }
    Ok(String::from_utf8_lossy(&run.stdout).into_owned())
}

fn cargo(arguments: &[&str]) -> Result<String, String> {
    output("cargo", arguments, &workspace_root())
}

/// Standard output of the program as JSON.
fn program(arguments: &[&str]) -> Result<Value, String> {
    let text = cargo(&[&["run", "--quiet", "--release", "--"], arguments].concat())?;
    serde_json::from_str(&text).map_err(|error| format!("roughxel {}: {error}", arguments.join(" ")))
}

/// Rows of the printed tables whose first column has this heading, the headings first.
fn printed(text: &str, heading: &str, columns: usize) -> Result<Vec<Vec<String>>, String> {
    let cells = |line: &str| -> Vec<String> {
        line.trim_matches('│').split('┆').map(|cell| cell.trim().to_owned()).collect()
    };
    let lines = text.lines().skip_while(|line| !line.starts_with('│') || cells(line)[0] != heading);
    let rows: Vec<Vec<String>> = lines.filter(|line| line.starts_with('│')).map(cells).collect();
    let rows: Vec<Vec<String>> = rows.into_iter().filter(|row| row.len() == columns).collect();
    if rows.len() < 2 { Err(format!("no table `{heading}` of {columns} columns in:\n{text}")) } else { Ok(rows) }
}

fn table(columns: &[&str], rows: Vec<Vec<String>>) -> Table {
    (columns.iter().map(ToString::to_string).collect(), rows)
}

fn hardware() -> Result<Table, String> {
    let (mut columns, mut rows) = (vec![String::new()], Vec::new());
    for (design, name) in
        [("highlight", "highlight of one light"), ("lit_peak", "one light on one peak with its horizon")]
    {
        let profiles = program(&["cost", "--profile", "all", "--design", design, "--json"])?;
        let profiles = profiles.as_array().ok_or("cost --json prints no list")?;
        columns.truncate(1);
        let mut row = vec![name.to_owned()];
        for one in profiles {
            let [multipliers, total] = [&one["total"]["multipliers"], &one["total"]];
            let count: u64 =
                multipliers.as_array().into_iter().flatten().filter_map(|kind| kind["count"].as_u64()).sum();
            columns.push(format!("`{}`", one["profile"].as_str().unwrap_or_default()));
            row.push(format!("{count}, {}, {}", total["rom_bits"], total["levels"]));
        }
        rows.push(row);
    }
    Ok((columns, rows))
}

fn sphere() -> Result<Table, String> {
    let text = cargo(&["full", "lobes", "--", "--nocapture"])?;
    let rows: Vec<_> = text
        .lines()
        .filter(|line| line.contains(", slope ") && line.contains(" dB, jump "))
        .filter_map(|line| {
            let (name, figures) = line.split_once(": ")?;
            let (psnr, jumps) = figures.split_once(" dB, jump ")?;
            let (jump, truth) = jumps.split_once(" of ")?;
            Some([name, psnr, jump, truth].map(str::to_owned).to_vec())
        })
        .collect();
    if rows.is_empty() {
        return Err(format!("no figures of lobes in:\n{text}"));
    }
    Ok(table(&["object", "PSNR, dB", "largest jump of neighbours", "the truth's"], rows))
}

fn host() -> Result<Table, String> {
    let text = cargo(&["bench", "-p", "roughxel-benches", "--bench", "backends"])?;
    let mut rows = printed(&text, "fragments", 5)?;
    // Random fragments give the same ratios within 3 %; the page shows those of a scene.
    rows.retain(|row| row[0] == "globe");
    rows.iter_mut().for_each(|row| _ = row.remove(0));
    // Tables of speeds and of bars have as many columns each. The bars follow.
    let bars = rows.iter().position(|row| row[0].contains(" / ")).unwrap_or(rows.len());
    let bars = rows.split_off(bars).into_iter().map(|mut row| {
        let bar = format!("{} {}", row[2], row[3].to_lowercase());
        row.splice(1.., [String::new(), String::new(), row[1].clone(), bar]);
        row
    });
    let speeds = rows.into_iter().map(|mut row| {
        row.push(String::new());
        row
    });
    let all = speeds.chain(bars).collect();
    Ok(table(&["backend, or a ratio of two", "10⁶/s", "ns", "× scalar, or the ratio", "bar"], all))
}

/// Runs of which the fastest counts, in turn with those of the other modes.
const RUNS: usize = 7;

fn peaks() -> Result<Table, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let picture = folder.path().join("a.png").display().to_string();
    let mut rows = Vec::new();
    for scene in ["cylinders-plane", "spheres-plane", "spheres-sphere", "denim-plane"] {
        let mut fastest = [f64::INFINITY; 3];
        for _ in 0..RUNS {
            for (mode, fastest) in ["unfiltered", "supersampled:16", "footprint"].into_iter().zip(&mut fastest) {
                let size = ["--size", "640x480", "--threads", "1", "--json", "-o", &picture];
                let figures = program(&[&["render", scene, "--mode", mode][..], &size].concat())?;
                *fastest = fastest.min(figures["drawing_s"].as_f64().ok_or("render --json states no drawing_s")?);
            }
        }
        let [unfiltered, sampled, filtered] = fastest;
        let bar = |ratio: f64, is_met: bool| format!("{ratio:.1}, {}", if is_met { "met" } else { "missed" });
        let (cost, gain) = (filtered / unfiltered, sampled / filtered);
        let mut row = vec![format!("`{scene}`")];
        row.extend(fastest.map(|seconds| format!("{seconds:.3} s")));
        row.extend([bar(cost, cost <= 2.0), bar(gain, gain >= 6.0)]);
        rows.push(row);
    }
    let columns =
        ["", "unfiltered", "16 samples", "filtered", "÷ unfiltered (bar 2.0)", "16 samples ÷ filtered (bar 6)"];
    Ok(table(&columns, rows))
}

fn memory() -> Result<Table, String> {
    let text = cargo(&["test", "--release", "-p", "roughxel-frame", "--test", "memory", "--", "--nocapture"])?;
    let figure = text.lines().find_map(|line| line.strip_suffix(" bytes a pixel"));
    let figure = figure.ok_or_else(|| format!("no bytes a pixel in:\n{text}"))?;
    // The harness may print the name of the test before the figure.
    let figure = figure.rsplit(' ').next().unwrap_or(figure);
    Ok(table(&["figure", "value"], vec![vec!["bytes a pixel until a frame is a file".into(), figure.into()]]))
}

fn start() -> Result<Table, String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let clone = folder.path().join("clone");
    let [from, to] = [workspace_root(), clone.clone()].map(|path| path.display().to_string());
    output("git", &["clone", "--quiet", &from, &to], folder.path())?;
    let begin = Instant::now();
    let target = clone.join("target").display().to_string();
    output("cargo", &["run", "--release", "--target-dir", &target, "--", "demo"], &clone)?;
    let seconds = begin.elapsed().as_secs_f64();
    let size = fs::metadata(clone.join("target/release/roughxel")).map_err(|error| error.to_string())?.len();
    let rows = [
        ("first command on a fresh clone, build included", format!("{seconds:.0} s")),
        ("size of the program", format!("{:.1} MB", size as f64 / 1e6)),
    ];
    Ok(table(&["figure", "value"], rows.map(|(figure, value)| vec![figure.into(), value]).into()))
}

fn effects() -> Result<Table, String> {
    let text = cargo(&["bench", "-p", "roughxel-benches", "--bench", "effects"])?;
    let mut rows = printed(&text, "scene", 5)?;
    let columns = rows.remove(0);
    Ok((columns, rows))
}

fn vectors() -> Result<Table, String> {
    let text = cargo(&["bench", "-p", "roughxel-benches", "--bench", "vectors"])?;
    let mut rows = printed(&text, "set", 5)?;
    let columns = rows.remove(0);
    Ok((columns, rows))
}

fn processors() -> Result<Table, String> {
    let path = "emulator/firmware/PRICE.md";
    let text = fs::read_to_string(workspace_root().join(path)).map_err(|error| format!("{path}: {error}"))?;
    let cells =
        |line: &str| -> Vec<String> { line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect() };
    let targets = [("riscv32imac", "rv32imac"), ("riscv32i", "rv32i"), ("thumbv7m", "Cortex-M3")];
    let names = [
        "environment",
        "reflection, all effects",
        "a probe of an environment: its place and weight",
        "set-up of a fragment on a scanline",
        "reflection, all effects, in f32 with libm",
        "reflection, all effects, in f32 with micromath",
    ];
    let mut columns = vec![String::new()];
    let mut rows: Vec<Vec<String>> = names.map(|name| vec![name.to_owned()]).into();
    for (target, name) in targets {
        let section = text.split(&format!("\n## {target}\n")).nth(1).ok_or(format!("{path}: no section {target}"))?;
        let section = section.split("\n## ").next().unwrap_or(section);
        for profile in ["standard", "narrow"] {
            columns.push(format!("{name} `{profile}`"));
            for row in &mut rows {
                let mut at = None;
                let found = section.lines().filter(|line| line.starts_with('|')).map(cells).find_map(|cells| {
                    at = cells.iter().position(|cell| cell == profile).or(at);
                    (cells[0] == row[0]).then(|| at.and_then(|at| cells.get(at).cloned()))
                });
                let missing = || format!("{path}: {target} has no {profile} of `{}`", row[0]);
                let figure = found.flatten().ok_or_else(missing)?;
                row.push(figure);
            }
        }
    }
    Ok((columns, rows))
}

/// Conditions of a section that is measured now.
fn conditions(measure: &Measure) -> Result<Vec<String>, String> {
    let (machine, root) = (Machine::here(), workspace_root());
    let one_line = |program: &str, arguments: &[&str]| -> Result<String, String> {
        output(program, arguments, &root).map(|text| text.trim().to_owned())
    };
    // The results of earlier sections are no change of what is measured.
    let others = [".", ":!docs/performance.json", ":!docs/performance.md"];
    let is_changed =
        !one_line("git", &[&["status", "--porcelain", "--untracked-files=no", "--"][..], &others].concat())?.is_empty();
    let commit = one_line("git", &["rev-parse", "--short", "HEAD"])?;
    let mut all = vec![measure.note.to_owned()];
    if measure.is_timed {
        all.push(format!("{}, {} threads, {}", machine.processor, machine.threads, machine.lanes));
    }
    all.push(machine.rustc);
    all.push(one_line("date", &["-u", "+%F"])?);
    all.push(format!("commit {commit}{}", if is_changed { " with changes" } else { "" }));
    Ok(all)
}

fn measured(measure: &Measure) -> Result<Section, String> {
    let begin = Instant::now();
    let (columns, rows) = (measure.run)()?;
    eprintln!("{}: {:.0} s", measure.name, begin.elapsed().as_secs_f64());
    Ok(Section { command: measure.command.into(), conditions: conditions(measure)?, columns, rows })
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    let written = OutputFile::create(path).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.commit()
    });
    written.map_err(|error| format!("{}: {error}", path.display()))
}

/// Measures the sections, keeping each as soon as it is measured, and fills the page.
fn run(measures: &[&Measure]) -> Result<(), String> {
    let mut results = performance::read()?;
    let mut failures = Vec::new();
    for measure in measures {
        match measured(measure) {
            Ok(section) => {
                results.insert(measure.name.into(), section);
                let text = serde_json::to_string_pretty(&results).map_err(|error| error.to_string())?;
                write(&performance::file(), &(text + "\n"))?;
            }
            Err(failure) => failures.push(format!("{}: {failure}", measure.name)),
        }
    }
    let path = performance::page();
    let mut page = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    for (name, section) in &results {
        page = performance::filled(&page, name, section)?;
    }
    write(&path, &page)?;
    if failures.is_empty() { Ok(()) } else { Err(failures.join("\n")) }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let known = |name: &String| MEASURES.iter().find(|measure| measure.name == name);
    let chosen: Option<Vec<&Measure>> = match &arguments[..] {
        [] => Some(MEASURES.iter().collect()),
        [option] if option == "--fill" => Some(Vec::new()),
        [option] if option == "--list" => {
            MEASURES.iter().for_each(|measure| println!("{}: {}", measure.name, measure.command));
            return ExitCode::SUCCESS;
        }
        names => names.iter().map(known).collect(),
    };
    let Some(chosen) = chosen else {
        let names: Vec<&str> = MEASURES.iter().map(|measure| measure.name).collect();
        eprintln!("error: wrong arguments; sections are {}\n{USAGE}", names.join(", "));
        return ExitCode::from(2);
    };
    match run(&chosen) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::FAILURE
        }
    }
}
