//! Clocks of a fragment on soft cores: their Verilog runs in Verilator with block RAM that answers after one clock.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use indicatif::ProgressBar;
use serde_json::{Value, json};

use crate::image;
use crate::measure::{self, ALL_EFFECTS};
use crate::target::{self, Target};
use crate::{Failure, price};

/// Python packages of the cores' sources, with their versions.
const PACKAGES: [(&str, &str); 3] =
    [("picorv32", "1.0.post218"), ("vexriscv", "1.0.1.post407"), ("serv", "1.2.0.post146")];

/// Soft core in one configuration.
struct Core {
    name: &'static str,
    /// Processor for which its programs are built.
    target: Target,
    /// Package of its sources. `cores/PACKAGE.v` of the firmware connects it to the memory.
    package: &'static str,
    /// File or folder of its sources in the package.
    sources: &'static str,
    /// Parameters that differ from the core's own.
    parameters: &'static [&'static str],
    /// Wait states of the memory: clocks that an answer takes beyond one.
    waits: u32,
}

const CORES: [Core; 10] = [
    Core {
        name: "VexRiscv, standard",
        target: Target::Riscv32Im,
        package: "vexriscv",
        sources: "VexRiscv.v",
        parameters: &[],
        waits: 0,
    },
    Core {
        name: "VexRiscv, standard, two wait states",
        target: Target::Riscv32Im,
        package: "vexriscv",
        sources: "VexRiscv.v",
        parameters: &[],
        waits: 2,
    },
    Core {
        name: "VexRiscv, Lite",
        target: Target::Riscv32Im,
        package: "vexriscv",
        sources: "VexRiscv_Lite.v",
        parameters: &[],
        waits: 0,
    },
    Core {
        name: "PicoRV32, fast multiplier, barrel shifter",
        target: Target::Riscv32Im,
        package: "picorv32",
        sources: "picorv32.v",
        parameters: &["ENABLE_FAST_MUL=1", "BARREL_SHIFTER=1"],
        waits: 0,
    },
    Core {
        name: "PicoRV32, bit-serial multiplier",
        target: Target::Riscv32Im,
        package: "picorv32",
        sources: "picorv32.v",
        parameters: &["ENABLE_MUL=1"],
        waits: 0,
    },
    Core {
        name: "VexRiscv, Min",
        target: Target::Riscv32I,
        package: "vexriscv",
        sources: "VexRiscv_Min.v",
        parameters: &[],
        waits: 0,
    },
    Core {
        name: "PicoRV32, barrel shifter",
        target: Target::Riscv32I,
        package: "picorv32",
        sources: "picorv32.v",
        parameters: &["BARREL_SHIFTER=1"],
        waits: 0,
    },
    Core {
        name: "PicoRV32",
        target: Target::Riscv32I,
        package: "picorv32",
        sources: "picorv32.v",
        parameters: &[],
        waits: 0,
    },
    Core {
        name: "PicoRV32, shifts of one place a clock",
        target: Target::Riscv32I,
        package: "picorv32",
        sources: "picorv32.v",
        parameters: &["TWO_STAGE_SHIFT=0"],
        waits: 0,
    },
    Core { name: "SERV", target: Target::Riscv32I, package: "serv", sources: "rtl", parameters: &[], waits: 0 },
];

/// Columns of the table: plan and profile of a program. f32 has no profile.
const COLUMNS: [(&str, &str, &str); 6] = [
    ("narrow", ALL_EFFECTS, "narrow"),
    ("standard", ALL_EFFECTS, "standard"),
    ("precise", ALL_EFFECTS, "precise"),
    ("f32", "float", "standard"),
    ("narrow in a batch", IN_A_BATCH, "narrow"),
    ("standard in a batch", IN_A_BATCH, "standard"),
];

/// Plan of [`ALL_EFFECTS`] in batches.
const IN_A_BATCH: &str = "batch+bump+curvature+footprint+anisotropic";

/// Suffix of a column whose fragments are shaded in batches. Their bits are those of the column without it.
const BATCH: &str = " in a batch";

/// Clocks after which a program is given up.
const LIMIT: &str = "4000000000";

/// Kept measures, from the project's root.
const KEPT: &str = "emulator/firmware/clocks.json";

/// Heading of the part of PRICE.md that is made of the kept measures.
const HEADING: &str = "\n## Soft cores\n";

/// Folder for packages, models and programs.
fn folder() -> PathBuf {
    target::built().join("cores")
}

/// Runs a tool and returns its standard output.
fn tool(command: &mut Command, remedy: &str) -> Result<String, Failure> {
    let name = command.get_program().display().to_string();
    let output = command.output().map_err(|error| Failure::trouble(format!("{name}: {error}; {remedy}")))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        return Err(Failure::trouble(format!("{name} fails:\n{text}")));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Installs the packages that are not there yet.
fn install() -> Result<(), Failure> {
    let python = folder().join("python");
    let is_missing =
        |(name, version): &&(&str, &str)| !python.join(format!("pythondata_cpu_{name}-{version}.dist-info")).exists();
    let missing = PACKAGES.iter().filter(is_missing).map(|(name, version)| format!("pythondata-cpu-{name}=={version}"));
    let missing: Vec<String> = missing.collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut pip = Command::new("python3");
    pip.args(["-m", "pip", "install", "--quiet", "--upgrade", "--target"]).arg(&python).args(missing);
    tool(&mut pip, "it is in the Debian package python3-pip").map(|_| ())
}

impl Core {
    /// Builds the model of the core and returns its path.
    fn model(&self) -> Result<PathBuf, Failure> {
        let words: String = self.name.chars().filter(|c| c.is_ascii_alphanumeric()).collect();
        let model = folder().join(words);
        let ours = target::firmware().join("cores");
        let package = folder().join("python").join(format!("pythondata_cpu_{}", self.package)).join("verilog");
        let mut verilator = Command::new("verilator");
        verilator
            .args(["--cc", "--exe", "--build", "-j", "0", "-O3", "--noassert", "-Wno-fatal", "-Wno-lint", "-Wno-style"])
            .args(["-CFLAGS", "-O2", "--top-module", "top", "--Mdir"])
            .arg(&model)
            .args(self.parameters.iter().map(|parameter| format!("-G{parameter}")))
            .args(["main.cpp", "memory.v"].map(|file| ours.join(file)))
            .arg(ours.join(self.package).with_extension("v"))
            .args(verilog(&package.join(self.sources))?);
        tool(&mut verilator, "it is in the Debian package verilator")?;
        Ok(model.join("Vtop"))
    }
}

/// A file, or the Verilog files of a folder.
fn verilog(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if path.is_file() {
        return Ok(vec![path.to_path_buf()]);
    }
    let trouble = |error| Failure::trouble(format!("{}: {error}", path.display()));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(trouble)? {
        files.push(entry.map_err(trouble)?.path());
    }
    files.retain(|file| file.extension().is_some_and(|extension| extension == "v"));
    files.sort();
    Ok(files)
}

/// Program of a column on a processor, and its check value.
struct Program {
    /// Words of the memory, as `$readmemh` reads them.
    image: PathBuf,
    check: u64,
}

/// Builds the program of a column and runs it in QEMU.
fn program(target: Target, (column, plan, profile): (&str, &str, &str)) -> Result<Program, Failure> {
    let built = target.build("clocks", plan, profile)?;
    let (code, output) = target.run(&built)?;
    let check = measure::numbers(&output).get("check").copied();
    let Some(check) = check.filter(|_| code == 0) else {
        return Err(Failure::trouble(format!("{column} on {}: exit code {code}\n{output}", target.name())));
    };
    let image = folder().join(format!("{}.{}.hex", column.replace(' ', "-"), target.name()));
    std::fs::write(&image, image::words(&built)?).map_err(Failure::trouble)?;
    Ok(Program { image, check })
}

/// Measures all cores, and writes measures and table.
pub fn run() -> Result<(), Failure> {
    std::fs::create_dir_all(folder()).map_err(Failure::trouble)?;
    install()?;
    let targets = [Target::Riscv32Im, Target::Riscv32I];
    let progress = measure::progress(COLUMNS.len() * (targets.len() + CORES.len()))?;
    let mut programs = BTreeMap::new();
    for target in targets {
        for column in COLUMNS {
            progress.set_message(format!("{} {}", target.name(), column.0));
            programs.insert((target.name(), column.0), program(target, column)?);
            progress.inc(1);
        }
        for (column, one_at_a_time) in
            COLUMNS.iter().filter_map(|&(column, ..)| Some((column, column.strip_suffix(BATCH)?)))
        {
            if programs[&(target.name(), column)].check != programs[&(target.name(), one_at_a_time)].check {
                return Err(Failure::broken(format!("{column} on {}: not the bits of {one_at_a_time}", target.name())));
            }
        }
    }
    let mut cores = serde_json::Map::new();
    for core in &CORES {
        cores.insert(core.name.into(), clocks(core, &programs, &progress)?);
    }
    progress.finish_and_clear();
    let verilator = tool(Command::new("verilator").arg("--version"), "it is in the Debian package verilator")?;
    let versions = PACKAGES.map(|(name, version)| format!("pythondata-cpu-{name} {version}"));
    let tools = [Target::Riscv32I.compiler(), verilator.trim().into()].into_iter().chain(versions);
    let measures = json!({ "tools": tools.collect::<Vec<String>>(), "clocks": cores });
    let text = serde_json::to_string_pretty(&measures).map_err(Failure::trouble)? + "\n";
    measure::write_whole(&target::root().join(KEPT), &text)?;
    let table = price::table()?;
    let before = table.split_once(HEADING).map_or(&*table, |(before, _)| before);
    measure::write_whole(&price::kept(), &(before.to_string() + &part()?))
}

/// Clocks of one core for each column.
fn clocks(core: &Core, programs: &BTreeMap<(&str, &str), Program>, progress: &ProgressBar) -> Result<Value, Failure> {
    let model = core.model()?;
    let mut clocks = serde_json::Map::new();
    for (column, ..) in COLUMNS {
        progress.set_message(format!("{} {column}", core.name));
        let Program { image, check } = &programs[&(core.target.name(), column)];
        let mut model = Command::new(&model);
        model.arg(format!("+image={}", image.display())).arg(format!("+waits={}", core.waits)).arg(LIMIT);
        let output = tool(&mut model, "it was built")?;
        let numbers = measure::numbers(&output);
        if numbers.get("check") != Some(check) {
            return Err(Failure::broken(format!("{column} on {}: not check value {check}\n{output}", core.name)));
        }
        let (Some(taken), Some(batch @ 1..)) = (numbers.get("clocks"), numbers.get("batch")) else {
            return Err(Failure::trouble(format!("{}: no clocks", core.name)));
        };
        clocks.insert(column.into(), json!(taken / batch));
        progress.inc(1);
    }
    Ok(Value::Object(clocks))
}

/// Part of PRICE.md that is made of the kept measures.
pub fn part() -> Result<String, Failure> {
    let wrong = |what: &str| Failure::trouble(format!("{KEPT}: {what}; `cargo firmware clocks` writes it"));
    let text = std::fs::read_to_string(target::root().join(KEPT)).map_err(|error| wrong(&error.to_string()))?;
    let measures: Value = serde_json::from_str(&text).map_err(|error| wrong(&error.to_string()))?;
    let tools = measures["tools"].as_array().ok_or_else(|| wrong("no tools"))?;
    let tools: Vec<&str> = tools.iter().filter_map(Value::as_str).collect();
    let mut text = format!(
        "{HEADING}\nMade by `cargo firmware clocks`: reflection, all effects, in clocks a fragment. The Verilog of each core runs with block RAM \
         that answers after one clock, or later by its wait states. A figure is a mean over 16 of the 64 fragments, in a batch over all of them, and \
         every result has the bits of QEMU. f32 is the baseline with libm. {}.\n\n| core | target | {} | narrow/standard | f32/standard | \
         batch/standard | f32/batch |\n|---|---|{}---:|---:|---:|---:|\n",
        tools.join(", "),
        COLUMNS.map(|(column, ..)| column).join(" | "),
        "---:|".repeat(COLUMNS.len()),
    );
    for core in &CORES {
        let mut row = BTreeMap::new();
        for (column, ..) in COLUMNS {
            let clocks = measures["clocks"][core.name][column].as_u64();
            row.insert(column, clocks.ok_or_else(|| wrong(&format!("no {column} of {}", core.name)))?);
        }
        let ratio = |column: &str, to: &str| row[column] as f64 / row[to] as f64;
        let cells = COLUMNS.map(|(column, ..)| row[column].to_string()).join(" | ");
        let batch = "standard in a batch";
        let ratios = [("narrow", "standard"), ("f32", "standard"), (batch, "standard"), ("f32", batch)];
        let ratios = ratios.map(|(column, to)| format!("{:.2}", ratio(column, to))).join(" | ");
        let _ = writeln!(text, "| {} | {} | {cells} | {ratios} |", core.name, core.target.name());
    }
    Ok(text)
}

/// Checks that the part of PRICE.md is that of the kept measures.
pub fn hold() -> Result<(), Failure> {
    if price::table()?.ends_with(&part()?) {
        return Ok(());
    }
    Err(Failure::broken(format!(
        "the soft cores of PRICE.md are not those of {KEPT}: `cargo firmware clocks` writes both"
    )))
}
