//! Clocks of a fragment in whole systems: VexRiscv with its caches, the bus of LiteX, and a model of an SDRAM, simulated in Verilator.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

use crate::cores;
use crate::measure::{self, ALL_EFFECTS, IN_A_BATCH, Numbers, PROBE};
use crate::target::{self, Target};
use crate::{Failure, clocks, image, predict};

/// Python packages of the systems, with their versions.
const PACKAGES: [(&str, &str); 6] = [
    ("litex", "2024.12"),
    ("litedram", "2024.12"),
    ("migen", "0.10.0"),
    cores::VEXRISCV,
    ("pythondata-misc-tapcfg", "0.0.post517"),
    // Migen reads versions with a module that later ones have dropped.
    ("setuptools", "75.8.0"),
];

/// Processor of all systems.
const TARGET: Target = Target::Riscv32Im;

/// First address of the SDRAM. VexRiscv caches no data from 0x80000000 on.
const ORIGIN: u32 = 0x4000_0000;

/// System on chip.
struct System {
    /// Name in the table.
    name: &'static str,
    /// Variant of VexRiscv.
    variant: &'static str,
    /// Caches in words.
    caches: &'static str,
    /// Bytes of the cache between bus and SDRAM.
    level_2: u32,
}

const SYSTEMS: [System; 4] = [
    System { name: "lite", variant: "lite", caches: "2 KiB of instructions", level_2: 0 },
    System { name: "lite, level 2", variant: "lite", caches: "2 KiB of instructions, 8 KiB of level 2", level_2: 8192 },
    System { name: "standard", variant: "standard", caches: "4 KiB of instructions, 4 KiB of data", level_2: 0 },
    System {
        name: "standard, level 2",
        variant: "standard",
        caches: "4 KiB of instructions, 4 KiB of data, 8 KiB of level 2",
        level_2: 8192,
    },
];

/// Columns of the table: program, plan and profile.
const COLUMNS: [(&str, &str, &str, &str); 7] = [
    ("narrow", "clocks", ALL_EFFECTS, "narrow"),
    ("standard", "clocks", ALL_EFFECTS, "standard"),
    ("f32", "clocks", "float", "standard"),
    ("narrow in a batch", "clocks", IN_A_BATCH, "narrow"),
    ("standard in a batch", "clocks", IN_A_BATCH, "standard"),
    ("a probe in standard", "clocks", PROBE, "standard"),
    (TILE, "tile", "empty", "standard"),
];

/// Column of the tile, whose hash must be the emulator's.
const TILE: &str = "the tile in standard";

/// Key of the kept measures.
pub const KEY: &str = "systems";

/// Command that makes the kept measures.
const REMEDY: &str = "`cargo firmware system` makes them";

/// Program in the SDRAM, with its check value in QEMU.
struct Program {
    column: &'static str,
    image: PathBuf,
    check: u64,
}

/// Folder of packages, images and models.
fn folder() -> PathBuf {
    cores::folder().join("litex")
}

fn build((column, program, plan, profile): (&'static str, &str, &str, &str)) -> Result<Program, Failure> {
    TARGET.build(program, plan, profile)?;
    let numbers = measure::measure_built(TARGET, program)?.numbers;
    let check = *numbers.get("check").ok_or_else(|| Failure::trouble(format!("{column} prints no check value")))?;
    if column == TILE && numbers.get("emulator") != Some(&check) {
        return Err(Failure::broken(format!("{column} in QEMU: hash {check}, not the emulator's")));
    }
    let memory = image::memory(&TARGET.build_at(ORIGIN, program, plan, profile)?)?;
    let image = folder().join(column.replace(' ', "-")).with_extension("hex");
    std::fs::create_dir_all(folder()).map_err(Failure::trouble)?;
    std::fs::write(&image, image::words(&memory)).map_err(Failure::trouble)?;
    Ok(Program { column, image, check })
}

impl System {
    /// Simulates programs and returns the numbers that each of them prints.
    fn run(&self, python: &Path, programs: &[Program]) -> Result<Vec<Numbers>, Failure> {
        let model = folder().join(self.name.replace([',', ' '], ""));
        let mut command = Command::new("python3");
        command
            .env("PYTHONPATH", python)
            .arg(target::firmware().join("litex/system.py"))
            .args(["--variant", self.variant, "--l2", &self.level_2.to_string(), "-o"])
            .arg(model)
            .args(programs.iter().map(|program| &program.image));
        let output = cores::tool(&mut command, "it is in the Debian package python3")?;
        Ok(output.split_terminator("end\n").map(measure::numbers).collect())
    }
}

/// Simulates all systems, and writes measures and table.
pub fn run() -> Result<(), Failure> {
    let python = folder().join("python");
    cores::install(&python, &PACKAGES)?;
    let programs: Vec<Program> = COLUMNS.into_iter().map(build).collect::<Result<_, _>>()?;
    let progress = measure::progress(SYSTEMS.len())?;
    let mut measures = BTreeMap::new();
    for system in &SYSTEMS {
        progress.set_message(system.name);
        let all = system.run(&python, &programs)?;
        if all.len() != programs.len() {
            return Err(Failure::trouble(format!(
                "{}: {} of {} programs ended",
                system.name,
                all.len(),
                programs.len()
            )));
        }
        let mut row = BTreeMap::new();
        for (program, numbers) in programs.iter().zip(all) {
            if numbers.get("check") != Some(&program.check) {
                return Err(Failure::broken(format!("{} on {}: not the bits of QEMU", program.column, system.name)));
            }
            let clocks = numbers.get("clocks").ok_or_else(|| Failure::trouble("a simulation prints no clocks"))?;
            row.insert(program.column, predict::mean(*clocks as f64, &numbers)?);
        }
        measures.insert(system.name, row);
        progress.inc(1);
    }
    progress.finish_and_clear();
    let versions = PACKAGES.map(|(name, version)| format!("{name} {version}"));
    let tools = [TARGET.compiler(), cores::verilator()?].into_iter().chain(versions);
    clocks::keep(KEY, json!({ "tools": tools.collect::<Vec<_>>(), "clocks": measures }))
}

/// Table of the kept measures.
pub fn table(kept: &Value) -> Result<String, Failure> {
    let tools = kept["tools"].as_array().into_iter().flatten().filter_map(Value::as_str).collect::<Vec<_>>();
    let mut text = format!(
        "\n### Systems\n\nMade by `cargo firmware system`, in clocks a fragment or a probe: VexRiscv with the bus and the SDRAM controller of LiteX, and its \
         model of an SDRAM (MT48LC16M16, 32 bits, at 50 MHz). Program and data lie in the SDRAM. The tile has 64×64 pixels; a fragment of it \
         is set up, reflected and filtered, and its hash is the emulator's. {}.\n\n| system | caches | {} | batch/standard | f32/batch |\n|---|---|{}---:|---:|\n",
        tools.join(", "),
        COLUMNS.map(|(column, ..)| column).join(" | "),
        "---:|".repeat(COLUMNS.len()),
    );
    for system in &SYSTEMS {
        let mut row = BTreeMap::new();
        for (column, ..) in COLUMNS {
            let number = kept["clocks"][system.name][column].as_u64();
            let number = number.ok_or_else(|| Failure::trouble(format!("no {column} of {}; {REMEDY}", system.name)))?;
            row.insert(column, number);
        }
        let ratio = |column, to| format!("{:.2}", row[column] as f64 / row[to] as f64);
        let batch = "standard in a batch";
        let cells = COLUMNS.map(|(column, ..)| row[column].to_string()).join(" | ");
        let (of_batch, of_float) = (ratio(batch, "standard"), ratio("f32", batch));
        let _ = writeln!(text, "| {} | {} | {cells} | {of_batch} | {of_float} |", system.name, system.caches);
    }
    Ok(text)
}
