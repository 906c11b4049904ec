//! Clocks of a fragment on soft cores: their Verilog runs in Verilator with block RAM that answers after one clock.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::{Value, json};

use crate::cores::{self, CORES, Core};
use crate::latencies::Latencies;
use crate::measure::{self, ALL_EFFECTS, IN_A_BATCH, Numbers, PROBE};
use crate::target::{self, Target};
use crate::{Failure, image, predict, price, system};

/// Columns of the table: plan and profile of a program. f32 has no profile.
const COLUMNS: [(&str, &str, &str); 7] = [
    ("narrow", ALL_EFFECTS, "narrow"),
    ("standard", ALL_EFFECTS, "standard"),
    ("precise", ALL_EFFECTS, "precise"),
    ("f32", "float", "standard"),
    ("narrow in a batch", IN_A_BATCH, "narrow"),
    ("standard in a batch", IN_A_BATCH, "standard"),
    ("a probe in standard", PROBE, "standard"),
];

/// Suffix of a column whose fragments are shaded in batches. Their bits are those of the column without it.
const BATCH: &str = " in a batch";

/// Kept measures, from the project's root.
const KEPT: &str = "emulator/firmware/clocks.json";

/// Command that makes the kept measures.
const REMEDY: &str = "`cargo firmware clocks` makes them";

/// Processors for which the programs are built.
pub const TARGETS: [Target; 2] = [Target::Riscv32Im, Target::Riscv32I];

/// Heading of the part of PRICE.md that is made of the kept measures.
const HEADING: &str = "\n## Soft cores\n";

/// Program of a column on a processor.
struct Program {
    /// Memory of the program.
    memory: Vec<u8>,
    /// File of the memory, as the simulations read it.
    image: PathBuf,
}

/// Builds a program and writes its memory.
fn build(target: Target, program: &str, (column, plan, profile): (&str, &str, &str)) -> Result<Program, Failure> {
    let memory = image::memory(&target.build(program, plan, profile)?)?;
    let image = cores::folder().join(format!("{}.{}.hex", column.replace(' ', "-"), target.name()));
    std::fs::create_dir_all(cores::folder()).map_err(Failure::trouble)?;
    std::fs::write(&image, image::words(&memory)).map_err(Failure::trouble)?;
    Ok(Program { memory, image })
}

/// Check value of the last built program of a column in QEMU.
fn check_in_qemu(target: Target) -> Result<u64, Failure> {
    let (code, output) = target.run(&target.place("clocks"))?;
    let check = measure::numbers(&output).get("check").copied();
    check
        .filter(|_| code == 0)
        .ok_or_else(|| Failure::trouble(format!("a program on {}: exit code {code}\n{output}", target.name())))
}

/// Returns QEMU's check value of the last built program of a column, which must be that of the simulator of instructions.
fn same_check(target: Target, check: Option<u64>) -> Result<u64, Failure> {
    let in_qemu = check_in_qemu(target)?;
    if check == Some(in_qemu) {
        return Ok(in_qemu);
    }
    Err(Failure::broken(format!("{}: the simulator of instructions has not the bits of QEMU", target.name())))
}

/// Predicted clocks of the last built program of a target by the names of cores, and `check`, which must be QEMU's.
pub fn predicted(target: Target, cores: &[predict::Known]) -> Result<Numbers, Failure> {
    let (mut clocks, check) = predict::clocks(&image::memory(&target.place("clocks"))?, cores)?;
    clocks.insert("check".into(), same_check(target, check)?);
    Ok(clocks)
}

/// Cores of a target with their kept latencies.
pub fn known(target: Target) -> Result<Vec<predict::Known>, Failure> {
    Kept::read()?.known(|core| core.target == target)
}

/// Measures and predictions as they are kept.
struct Kept(Value);

impl Kept {
    fn read() -> Result<Self, Failure> {
        let wrong = |error: &dyn std::fmt::Display| Failure::trouble(format!("{KEPT}: {error}"));
        let text = std::fs::read_to_string(target::root().join(KEPT)).map_err(|error| wrong(&error))?;
        Ok(Self(serde_json::from_str(&text).map_err(|error| wrong(&error))?))
    }

    fn write(&self) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(&self.0).map_err(Failure::trouble)? + "\n";
        measure::write_whole(&target::root().join(KEPT), &text)?;
        let table = price::table()?;
        let before = table.split_once(HEADING).map_or(&*table, |(before, _)| before);
        measure::write_whole(&price::kept(), &(before.to_string() + &self.part()?))
    }

    /// Returns true if a compiler built the programs.
    fn has_compiler(&self, compiler: &str) -> bool {
        self.0["tools"][0] == compiler
    }

    /// Number of a column of a core or processor: `clocks`, `predicted`, or a count.
    fn number(&self, what: &str, row: &str, column: &str) -> Result<u64, Failure> {
        let number = self.0[what][row][column].as_u64();
        number.ok_or_else(|| Failure::trouble(format!("{KEPT}: no {what} of {column} on {row}; {REMEDY}")))
    }

    /// Some cores with their latencies.
    fn known(&self, is_wanted: impl Fn(&Core) -> bool) -> Result<Vec<predict::Known>, Failure> {
        let known = |core: &'static Core| {
            let row = Latencies::read(&self.0["latencies"][core.name]);
            let row = row.ok_or_else(|| Failure::trouble(format!("{KEPT}: no latencies of {}; {REMEDY}", core.name)));
            Ok((core, row?))
        };
        CORES.iter().filter(|core| is_wanted(core)).map(known).collect()
    }

    /// Part of PRICE.md.
    fn part(&self) -> Result<String, Failure> {
        let tools = self.0["tools"].as_array().into_iter().flatten().filter_map(Value::as_str).collect::<Vec<_>>();
        let mut text = format!(
            "{HEADING}\nMade by `cargo firmware clocks`: reflection, all effects, in clocks a fragment, and a probe with its eight texels. The \
             Verilog of each core runs with block RAM that answers after one clock, or later by its wait states. A figure is a mean over 16 of the \
             64 fragments or their probes, in a batch over all 64, and every result has the bits of QEMU. f32 is the baseline with libm. {}.\n\n\
             | core | is | target |\n|---|---|---|\n{}\n| core | {} | narrow/standard | f32/standard | batch/standard | f32/batch |\n\
             |---|{}---:|---:|---:|---:|\n",
            tools.join(", "),
            CORES.map(|core| format!("| {} | {} | {} |\n", core.name, core.about, core.target.name())).concat(),
            COLUMNS.map(|(column, ..)| column).join(" | "),
            "---:|".repeat(COLUMNS.len()),
        );
        for core in &CORES {
            let mut row = BTreeMap::new();
            for (column, ..) in COLUMNS {
                row.insert(column, self.number("clocks", core.name, column)?);
            }
            let ratio = |column: &str, to: &str| row[column] as f64 / row[to] as f64;
            let cells = COLUMNS.map(|(column, ..)| row[column].to_string()).join(" | ");
            let batch = "standard in a batch";
            let ratios = [("narrow", "standard"), ("f32", "standard"), (batch, "standard"), ("f32", batch)];
            let ratios = ratios.map(|(column, to)| format!("{:.2}", ratio(column, to))).join(" | ");
            let _ = writeln!(text, "| {} | {cells} | {ratios} |", core.name);
        }
        let _ = write!(
            text,
            "\nPredicted from counted instructions and measured latencies (`cargo firmware clocks --predict`), with the error against the clocks \
             above:\n\n| core | {} |\n|---|{}\n",
            COLUMNS.map(|(column, ..)| column).join(" | "),
            "---:|".repeat(COLUMNS.len()),
        );
        for core in &CORES {
            let mut cells = Vec::new();
            for (column, ..) in COLUMNS {
                let predicted = self.number("predicted", core.name, column)?;
                cells.push(format!("{predicted} ({:+.1} %)", 100.0 * self.error(core, column)?));
            }
            let _ = writeln!(text, "| {} | {} |", core.name, cells.join(" | "));
        }
        let _ = write!(
            text,
            "\nInstructions a fragment, or a probe, by kind. Places are those of all shifts together. Lines are the distinct ones of the code \
             that a fragment, a batch of 64, or the probes of a fragment touch.\n\n| program | {} |\n|---|{}\n",
            predict::COUNTED.join(" | "),
            "---:|".repeat(predict::COUNTED.len()),
        );
        for target in TARGETS {
            for (column, ..) in COLUMNS {
                let name = format!("{column}, {}", target.name());
                let mut cells = Vec::new();
                for what in predict::COUNTED {
                    cells.push(self.number("counts", &name, what)?.to_string());
                }
                let _ = writeln!(text, "| {name} | {} |", cells.join(" | "));
            }
        }
        Ok(text + &system::table(&self.0[system::KEY])?)
    }

    /// Relative error of a predicted number of clocks.
    fn error(&self, core: &Core, column: &str) -> Result<f64, Failure> {
        let number = |what| Ok::<f64, Failure>(self.number(what, core.name, column)? as f64);
        Ok(number("predicted")? / number("clocks")? - 1.0)
    }
}

/// Measures cores, or one of them, and predicts the clocks of all; or predicts alone. Writes measures and table.
pub fn run(only: Option<&str>, predict: bool) -> Result<(), Failure> {
    let measured: Vec<&Core> =
        CORES.iter().filter(|core| !predict && only.is_none_or(|only| core.name == only)).collect();
    if only.is_some_and(|only| CORES.iter().all(|core| core.name != only)) {
        let names = CORES.map(|core| core.name).join(", ");
        return Err(Failure::trouble(format!("no core is named so; cores are {names}")));
    }
    let mut kept = Kept::read()?;
    let compiler = Target::Riscv32I.compiler();
    if (predict || only.is_some()) && !kept.has_compiler(&compiler) {
        return Err(Failure::trouble(format!("{KEPT} was made by another compiler than {compiler}; {REMEDY}")));
    }
    let progress = measure::progress(COLUMNS.len() * TARGETS.len() + (COLUMNS.len() + 1) * measured.len())?;
    let (mut programs, mut checks) = (BTreeMap::new(), BTreeMap::new());
    for target in TARGETS {
        for column in COLUMNS {
            progress.set_message(format!("{} {}", target.name(), column.0));
            let program = build(target, "clocks", column)?;
            let name = format!("{}, {}", column.0, target.name());
            let (counts, check) = predict::counts(&program.memory)?;
            kept.0["counts"][name] = json!(counts);
            checks.insert((target.name(), column.0), same_check(target, check)?);
            programs.insert((target.name(), column.0), program);
            progress.inc(1);
        }
        for (column, ..) in COLUMNS {
            let one_at_a_time = column.strip_suffix(BATCH).unwrap_or(column);
            if checks[&(target.name(), column)] != checks[&(target.name(), one_at_a_time)] {
                return Err(Failure::broken(format!("{column} on {}: not the bits of {one_at_a_time}", target.name())));
            }
        }
    }
    if !measured.is_empty() {
        cores::install_sources()?;
        if only.is_none() {
            kept.0 = json!({ "counts": kept.0["counts"], system::KEY: kept.0[system::KEY] });
        }
        kept.0["tools"] = [compiler].into_iter().chain(cores::tools()?).collect();
    }
    for core in measured {
        let model = core.model()?;
        progress.set_message(format!("{} latencies", core.name));
        let program = build(core.target, "latencies", ("latencies", "empty", "standard"))?;
        let latencies = Latencies::measured(&core.run(&model, &program.image)?, core.cache)?;
        kept.0["latencies"][core.name] = latencies.kept();
        progress.inc(1);
        for (column, ..) in COLUMNS {
            progress.set_message(format!("{} {column}", core.name));
            let place = (core.target.name(), column);
            let numbers = core.run(&model, &programs[&place].image)?;
            if numbers.get("check") != Some(&checks[&place]) {
                return Err(Failure::broken(format!("{column} on {}: not the bits of QEMU", core.name)));
            }
            let clocks = numbers.get("clocks").ok_or_else(|| Failure::trouble(format!("{}: no clocks", core.name)))?;
            kept.0["clocks"][core.name][column] = json!(predict::mean(*clocks as f64, &numbers)?);
            progress.inc(1);
        }
    }
    for ((target, column), program) in &programs {
        let cores = kept.known(|core| core.target.name() == *target && only.is_none_or(|only| core.name == only))?;
        let (clocks, _) = predict::clocks(&program.memory, &cores)?;
        for (core, clocks) in clocks {
            kept.0["predicted"][core][*column] = json!(clocks);
        }
    }
    progress.finish_and_clear();
    kept.write()
}

/// Keeps other measures under a key, and writes the table.
pub fn keep(key: &str, measures: Value) -> Result<(), Failure> {
    let mut kept = Kept::read()?;
    kept.0[key] = measures;
    kept.write()
}

/// Part of PRICE.md that is made of the kept measures.
pub fn part() -> Result<String, Failure> {
    Kept::read()?.part()
}

/// Largest error of a prediction.
const TOLERANCE: f64 = 0.1;

/// Predicts clocks of a target's cores again, for one column, and compares them with the kept predictions, which must be right within a thirtieth.
/// So a datapath whose clocks are old shows without a simulation of a core.
pub fn hold_predictions(target: Target) -> Result<(), Failure> {
    let (kept, name) = (Kept::read()?, target.name());
    if !kept.has_compiler(&target.compiler()) {
        println!("{name:12} {KEPT} was made by another compiler: not compared");
        return Ok(());
    }
    let (column, plan, profile) = COLUMNS[1];
    target.build("clocks", plan, profile)?;
    let cores = kept.known(|core| core.target == target)?;
    let clocks = predicted(target, &cores)?;
    let mut most = 0.0_f64;
    for (core, _) in cores {
        let (now, before) = (clocks[core.name], kept.number("predicted", core.name, column)?);
        let moved = (now as f64 / before as f64 - 1.0).abs();
        if moved > 1.0 / 30.0 {
            return Err(Failure::broken(format!("{KEPT}: {} takes {now} clocks, not {before}; {REMEDY}", core.name)));
        }
        most = most.max(moved);
    }
    println!("{name:12} predicted clocks within {:.1} % of {KEPT}", 100.0 * most);
    Ok(())
}

/// Checks that each kept prediction is near the measured clocks, and that the part of PRICE.md is made of both.
pub fn hold() -> Result<(), Failure> {
    let kept = Kept::read()?;
    let mut most = 0.0_f64;
    for core in &CORES {
        for (column, ..) in COLUMNS {
            let error = kept.error(core, column)?;
            if error.abs() > TOLERANCE {
                let core = core.name;
                return Err(Failure::broken(format!(
                    "{KEPT}: {column} on {core} is predicted {:+.1} % off",
                    100.0 * error
                )));
            }
            most = most.max(error.abs());
        }
    }
    println!("{:12} predicted clocks of soft cores within {:.1} % of measured ones", "", 100.0 * most);
    if price::table()?.ends_with(&kept.part()?) {
        return Ok(());
    }
    Err(Failure::broken(format!("the soft cores of PRICE.md are not those of {KEPT}; {REMEDY}")))
}
