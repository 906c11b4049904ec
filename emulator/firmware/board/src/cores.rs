//! Soft cores whose Verilog runs in Verilator.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::Failure;
use crate::measure::{self, Numbers};
use crate::target::{self, Target};

/// Python packages of the cores' sources, with their versions.
const PACKAGES: [(&str, &str); 4] = [
    ("pythondata-cpu-picorv32", "1.0.post218"),
    VEXRISCV,
    ("pythondata-cpu-serv", "1.2.0.post146"),
    ("pythondata-cpu-ibex", "0.0.post2937"),
];

/// Package of VexRiscv, which systems have, too.
pub const VEXRISCV: (&str, &str) = ("pythondata-cpu-vexriscv", "1.0.1.post407");

/// Sources of Ibex: packages in their order, and folders.
const IBEX: &[&str] = &[
    "system_verilog/vendor/lowrisc_ip/ip/prim/rtl/prim_ram_1p_pkg.sv",
    "system_verilog/vendor/lowrisc_ip/ip/prim/rtl/prim_secded_pkg.sv",
    "system_verilog/vendor/lowrisc_ip/ip/prim/rtl/prim_mubi_pkg.sv",
    "system_verilog/vendor/lowrisc_ip/ip/prim/rtl/prim_util_pkg.sv",
    "system_verilog/vendor/lowrisc_ip/ip/prim/rtl/prim_cipher_pkg.sv",
    "system_verilog/vendor/lowrisc_ip/ip/prim/rtl/prim_count_pkg.sv",
    "system_verilog/rtl/ibex_pkg.sv",
    "system_verilog/rtl",
    "system_verilog/vendor/lowrisc_ip/ip/prim/rtl",
    "system_verilog/vendor/lowrisc_ip/ip/prim_generic/rtl",
    "system_verilog/vendor/lowrisc_ip/dv/sv/dv_utils",
];

/// Instruction cache. Each of its places holds one line.
#[derive(Clone, Copy, Debug)]
pub struct Cache {
    /// Bytes of all lines.
    pub bytes: u32,
    /// Bytes of a line.
    pub line: u32,
}

/// Soft core in one configuration.
pub struct Core {
    /// Name in the tables and on the command line.
    pub name: &'static str,
    /// Configuration in words.
    pub about: &'static str,
    /// Processor for which its programs are built.
    pub target: Target,
    /// Package of its sources. `cores/PACKAGE.v` of the firmware connects it to the memory.
    package: &'static str,
    /// Files of its sources in the package, and folders that are searched for modules.
    sources: &'static [&'static str],
    /// Parameters that differ from the core's own.
    parameters: &'static [&'static str],
    /// Wait states of the memory: clocks that an answer takes beyond one.
    waits: u32,
    /// Instruction cache, as the documents of the core state it.
    pub cache: Option<Cache>,
}

/// Cores in the order of the tables.
pub const CORES: [Core; 12] = [
    Core {
        name: "ibex-single-cycle",
        about: "Ibex with a single-cycle multiplier, a writeback stage and an adder for branches",
        target: Target::Riscv32Im,
        package: "ibex",
        sources: IBEX,
        parameters: &["RV32M=3", "BRANCH_TARGET_ALU=1", "WRITEBACK_STAGE=1"],
        waits: 0,
        cache: None,
    },
    Core {
        name: "ibex-small",
        about: "Ibex with its own parameters: a multiplier of several clocks",
        target: Target::Riscv32Im,
        package: "ibex",
        sources: IBEX,
        parameters: &[],
        waits: 0,
        cache: None,
    },
    Core {
        name: "vexriscv-standard",
        about: "VexRiscv as LiteX has it by default: multiplier, 4 KiB of instruction cache",
        target: Target::Riscv32Im,
        package: "vexriscv",
        sources: &["verilog/VexRiscv.v"],
        parameters: &[],
        waits: 0,
        cache: Some(Cache { bytes: 4096, line: 32 }),
    },
    Core {
        name: "vexriscv-two-waits",
        about: "vexriscv-standard on a memory with two wait states",
        target: Target::Riscv32Im,
        package: "vexriscv",
        sources: &["verilog/VexRiscv.v"],
        parameters: &[],
        waits: 2,
        cache: Some(Cache { bytes: 4096, line: 32 }),
    },
    Core {
        name: "vexriscv-lite",
        about: "VexRiscv Lite of LiteX: multiplier, 2 KiB of instruction cache",
        target: Target::Riscv32Im,
        package: "vexriscv",
        sources: &["verilog/VexRiscv_Lite.v"],
        parameters: &[],
        waits: 0,
        cache: Some(Cache { bytes: 2048, line: 32 }),
    },
    Core {
        name: "picorv32-fast",
        about: "PicoRV32 with its fast multiplier and a barrel shifter",
        target: Target::Riscv32Im,
        package: "picorv32",
        sources: &["verilog/picorv32.v"],
        parameters: &["ENABLE_FAST_MUL=1", "BARREL_SHIFTER=1"],
        waits: 0,
        cache: None,
    },
    Core {
        name: "picorv32-multiplier",
        about: "PicoRV32 with its bit-serial multiplier",
        target: Target::Riscv32Im,
        package: "picorv32",
        sources: &["verilog/picorv32.v"],
        parameters: &["ENABLE_MUL=1"],
        waits: 0,
        cache: None,
    },
    Core {
        name: "vexriscv-min",
        about: "VexRiscv Min of LiteX: no multiplier, no cache",
        target: Target::Riscv32I,
        package: "vexriscv",
        sources: &["verilog/VexRiscv_Min.v"],
        parameters: &[],
        waits: 0,
        cache: None,
    },
    Core {
        name: "picorv32-barrel",
        about: "PicoRV32 with a barrel shifter, no multiplier",
        target: Target::Riscv32I,
        package: "picorv32",
        sources: &["verilog/picorv32.v"],
        parameters: &["BARREL_SHIFTER=1"],
        waits: 0,
        cache: None,
    },
    Core {
        name: "picorv32",
        about: "PicoRV32 with its own parameters: no multiplier, shifts of four places a clock",
        target: Target::Riscv32I,
        package: "picorv32",
        sources: &["verilog/picorv32.v"],
        parameters: &[],
        waits: 0,
        cache: None,
    },
    Core {
        name: "picorv32-slow-shifts",
        about: "PicoRV32 with shifts of one place a clock, no multiplier",
        target: Target::Riscv32I,
        package: "picorv32",
        sources: &["verilog/picorv32.v"],
        parameters: &["TWO_STAGE_SHIFT=0"],
        waits: 0,
        cache: None,
    },
    Core {
        name: "serv",
        about: "SERV, which computes one bit a clock: no multiplier",
        target: Target::Riscv32I,
        package: "serv",
        sources: &["verilog/rtl"],
        parameters: &[],
        waits: 0,
        cache: None,
    },
];

/// Clocks after which a program is given up.
const LIMIT: &str = "4000000000";

/// Verilator with its version.
pub fn verilator() -> Result<String, Failure> {
    let verilator = tool(Command::new("verilator").arg("--version"), "it is in the Debian package verilator")?;
    Ok(verilator.trim().into())
}

/// Versions of the tools that measure.
pub fn tools() -> Result<Vec<String>, Failure> {
    let packages = PACKAGES.map(|(name, version)| format!("{name} {version}"));
    Ok([verilator()?].into_iter().chain(packages).collect())
}

/// Folder for packages, models and programs.
pub fn folder() -> PathBuf {
    target::built().join("cores")
}

/// Runs a tool and returns its standard output.
pub fn tool(command: &mut Command, remedy: &str) -> Result<String, Failure> {
    let name = command.get_program().display().to_string();
    let output = command.output().map_err(|error| Failure::trouble(format!("{name}: {error}; {remedy}")))?;
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        return Err(Failure::trouble(format!("{name} fails:\n{text}")));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Installs the sources of the cores.
pub fn install_sources() -> Result<(), Failure> {
    install(&folder().join("python"), &PACKAGES)
}

/// Installs Python packages that are not in a folder yet.
pub fn install(python: &Path, packages: &[(&str, &str)]) -> Result<(), Failure> {
    let is_missing = |(name, version): &&(&str, &str)| {
        !python.join(format!("{}-{version}.dist-info", name.replace('-', "_"))).exists()
    };
    let missing = packages.iter().filter(is_missing).map(|(name, version)| format!("{name}=={version}"));
    let missing: Vec<String> = missing.collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut pip = Command::new("python3");
    pip.args(["-m", "pip", "install", "--quiet", "--upgrade", "--target"]).arg(python).args(missing);
    tool(&mut pip, "it is in the Debian package python3-pip").map(|_| ())
}

impl Core {
    /// Builds the model of the core and returns its path.
    pub fn model(&self) -> Result<PathBuf, Failure> {
        let words: String = self.name.chars().filter(|c| c.is_ascii_alphanumeric()).collect();
        let model = folder().join(words);
        let ours = target::firmware().join("cores");
        let package = folder().join("python").join(format!("pythondata_cpu_{}", self.package));
        let sources = self.sources.iter().map(|source| package.join(source));
        let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) = sources.partition(|source| source.is_dir());
        let mut verilator = Command::new("verilator");
        verilator
            .args(["--cc", "--exe", "--build", "-j", "0", "-O3", "--noassert", "-Wno-fatal", "-Wno-lint", "-Wno-style"])
            .args(["-CFLAGS", "-O2", "--top-module", "top", "--Mdir"])
            .arg(&model)
            .args(self.parameters.iter().map(|parameter| format!("-G{parameter}")))
            .arg("+libext+.v+.sv")
            .args(folders.iter().flat_map(|folder| [Path::new("-y"), folder]))
            .args(files)
            .args(["main.cpp", "memory.v"].map(|file| ours.join(file)))
            .arg(ours.join(self.package).with_extension("v"));
        tool(&mut verilator, "it is in the Debian package verilator")?;
        Ok(model.join("Vtop"))
    }

    /// Runs a program on a model of the core and returns the numbers that it prints.
    pub fn run(&self, model: &Path, image: &Path) -> Result<Numbers, Failure> {
        let mut model = Command::new(model);
        model.arg(format!("+image={}", image.display())).arg(format!("+waits={}", self.waits)).arg(LIMIT);
        Ok(measure::numbers(&tool(&mut model, "it was built")?))
    }
}
