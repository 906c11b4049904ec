//! Processors: building and running programs for them.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use crate::Failure;

/// A processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// RISC-V with multiplier and compressed instructions.
    Riscv32Imac,
    /// RISC-V with a multiplier alone, for soft cores.
    Riscv32Im,
    /// RISC-V with neither.
    Riscv32I,
    /// Cortex-M3.
    ThumbV7M,
    /// AArch64, 64 bits.
    Aarch64,
    /// IBM Z, 64 bits, most significant byte first.
    S390X,
}

/// First address of QEMU's memory.
const ORIGIN: u32 = 0x8000_0000;

/// Folder of the crate of the programs.
pub fn firmware() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the board is inside the firmware folder").to_path_buf()
}

/// Root of the project, whose workspace has the emulator.
pub fn root() -> PathBuf {
    firmware().join("../..")
}

/// Folder for built programs.
pub fn built() -> PathBuf {
    firmware().join("target")
}

/// Returns true if rustup has a target. Asked once for each.
fn rustup_has(triple: &'static str) -> bool {
    static ASKED: Mutex<BTreeMap<&str, bool>> = Mutex::new(BTreeMap::new());
    let mut asked = ASKED.lock().unwrap_or_else(PoisonError::into_inner);
    *asked.entry(triple).or_insert_with(|| {
        Command::new("rustup").args(["target", "add", triple]).output().is_ok_and(|output| output.status.success())
    })
}

/// Optimisation of programs of the emulator. Libraries are hardly optimised, for they only read scenes and the like. The code of every texel and
/// pixel is optimised as in a release. The program of the frames takes two minutes of one core to build for a processor, and its frames 48 s on
/// s390x. With everything at the first level both take about twice as long.
const HOSTED_PROFILE: [&str; 7] = [
    "profile.release.opt-level=1",
    "profile.release.package.roughxel-core.opt-level=3",
    "profile.release.package.roughxel-frame.opt-level=3",
    "profile.release.package.roughxel-maps.opt-level=3",
    "profile.release.package.roughxel-peaks.opt-level=3",
    "profile.release.package.roughxel-scene.opt-level=3",
    "profile.release.package.roughxel-utilities.opt-level=3",
];

impl Target {
    /// Every processor that is checked and priced.
    pub const ALL: [Self; 5] = [Self::Riscv32Imac, Self::Riscv32I, Self::ThumbV7M, Self::Aarch64, Self::S390X];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Riscv32Imac => "riscv32imac",
            Self::Riscv32Im => "riscv32im",
            Self::Riscv32I => "riscv32i",
            Self::ThumbV7M => "thumbv7m",
            Self::Aarch64 => "aarch64",
            Self::S390X => "s390x",
        }
    }

    /// Finds a target by its name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|target| target.name() == name)
    }

    /// Rust's name of the target.
    fn triple(self) -> &'static str {
        match self {
            Self::Riscv32Imac => "riscv32imac-unknown-none-elf",
            Self::Riscv32Im => "riscv32im-unknown-none-elf",
            Self::Riscv32I => "riscv32i-unknown-none-elf",
            Self::ThumbV7M => "thumbv7m-none-eabi",
            Self::Aarch64 => "aarch64-unknown-linux-gnu",
            Self::S390X => "s390x-unknown-linux-gnu",
        }
    }

    /// Returns true if it has no operating system and runs its own backend.
    pub fn is_small(self) -> bool {
        matches!(self, Self::Riscv32Imac | Self::Riscv32Im | Self::Riscv32I | Self::ThumbV7M)
    }

    /// Returns true if the highest byte of a word comes first.
    pub fn big_endian(self) -> bool {
        self == Self::S390X
    }

    /// Command that runs its programs, with the Debian package that has it.
    fn emulator(self) -> (&'static [&'static str], &'static str) {
        const RISCV: &[&str] = &[
            "qemu-system-riscv32",
            "-M",
            "virt",
            "-bios",
            "none",
            "-display",
            "none",
            "-serial",
            "stdio",
            "-monitor",
            "none",
            "-no-reboot",
            "-icount",
            "shift=0",
            "-semihosting-config",
            "enable=on,target=native",
            "-kernel",
        ];
        const CORTEX_M: &[&str] = &[
            "qemu-system-arm",
            "-M",
            "mps2-an385",
            "-display",
            "none",
            "-serial",
            "null",
            "-monitor",
            "none",
            "-icount",
            "shift=0",
            "-semihosting-config",
            "enable=on,target=native",
            "-kernel",
        ];
        match self {
            Self::Riscv32Imac | Self::Riscv32Im | Self::Riscv32I => (RISCV, "qemu-system-misc"),
            Self::ThumbV7M => (CORTEX_M, "qemu-system-arm"),
            Self::Aarch64 => (&["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"], "qemu-user"),
            Self::S390X => (&["qemu-s390x", "-L", "/usr/s390x-linux-gnu"], "qemu-user"),
        }
    }

    /// Builds a program of the firmware for a plan and an accuracy, and returns its path. `build/plan.rs` reads the plan; a feature of the core and
    /// `/` may stand before it. An accuracy is a profile, followed by the knobs that differ from it.
    pub fn build(self, program: &str, plan: &str, accuracy: &str) -> Result<PathBuf, Failure> {
        self.build_at(ORIGIN, program, plan, accuracy)
    }

    /// Builds a program whose memory begins at an address, as far as `build/main.rs` lets it choose.
    pub fn build_at(self, origin: u32, program: &str, plan: &str, accuracy: &str) -> Result<PathBuf, Failure> {
        Self::build_some(&[self], origin, program, plan, accuracy)?;
        Ok(self.place(program))
    }

    /// Builds a program for several targets in parallel. A program is one unit of one compiler, which keeps one processor busy. Each program is at
    /// its [`place`](Self::place).
    pub fn build_each(targets: &[Self], program: &str, plan: &str, accuracy: &str) -> Result<(), Failure> {
        Self::build_some(targets, ORIGIN, program, plan, accuracy)
    }

    fn build_some(targets: &[Self], origin: u32, program: &str, plan: &str, accuracy: &str) -> Result<(), Failure> {
        let (given, made): (Vec<Self>, Vec<Self>) = targets.iter().partition(|target| rustup_has(target.triple()));
        let (profile, knobs) = accuracy.split_once(' ').unwrap_or((accuracy, ""));
        for (targets, is_given) in [(given, true), (made, false)] {
            if targets.is_empty() {
                continue;
            }
            let mut cargo = Command::new("cargo");
            cargo
                .current_dir(firmware())
                .args(["build", "--release", "--locked", "--quiet", "--bin", program, "--target-dir"])
                .arg(built())
                .env("ROUGHXEL_PROFILE", profile)
                .env("ROUGHXEL_KNOBS", knobs)
                .env("ROUGHXEL_ORIGIN", format!("{origin:#x}"));
            match plan.split_once('/') {
                Some((feature, plan)) => cargo.args(["--features", feature]).env("ROUGHXEL_PLAN", plan),
                None => cargo.env("ROUGHXEL_PLAN", plan),
            };
            if !is_given {
                // The distribution's compiler comes with the sources of `core`.
                cargo.arg("-Zbuild-std=core").env("RUSTC", "/usr/bin/rustc").env("RUSTC_BOOTSTRAP", "1");
            }
            for target in &targets {
                cargo.args(["--target", target.triple()]);
                if !target.is_small() {
                    cargo.env(target.linker_key(), target.hosted_linker());
                } else if !is_given {
                    cargo.env(target.linker_key(), linker()?);
                }
            }
            let output = cargo.output().map_err(|error| Failure::trouble(format!("cargo: {error}")))?;
            if !output.status.success() {
                let text = String::from_utf8_lossy(&output.stderr);
                let names: Vec<&str> = targets.into_iter().map(Self::name).collect();
                return Err(Failure::trouble(format!("{program} cannot be built for {}:\n{text}", names.join(", "))));
            }
        }
        Ok(())
    }

    /// Path of a built program of the firmware.
    pub fn place(self, program: &str) -> PathBuf {
        built().join(self.triple()).join("release").join(program)
    }

    /// Variable that names cargo the linker of its programs.
    fn linker_key(self) -> String {
        format!("CARGO_TARGET_{}_LINKER", self.triple().replace('-', "_").to_uppercase())
    }

    /// Linker of its programs, if it has an operating system.
    fn hosted_linker(self) -> String {
        format!("{}-linux-gnu-gcc", self.name())
    }

    /// Builds a program of the project that needs a standard library, from cargo's arguments for it. Returns its path, which is below the folder of a
    /// release. `None` means that there is no standard library for the processor: the sources that a distribution ships with its compiler suffice for
    /// `core` alone.
    pub fn build_hosted(self, program: &[&str], place: &str) -> Result<Option<PathBuf>, Failure> {
        let triple = self.triple();
        if !rustup_has(triple) {
            return Ok(None);
        }
        // Target folder of the project: procedural macros and build scripts are shared by all of its builds.
        let folder = root().join("target");
        let mut cargo = Command::new("cargo");
        cargo
            .current_dir(root())
            .args(["build", "--release", "--locked", "--quiet"])
            .args(program)
            .args(["--target", triple, "--target-dir"])
            .arg(&folder)
            .env(self.linker_key(), self.hosted_linker());
        cargo.args(HOSTED_PROFILE.iter().flat_map(|setting| ["--config", setting]));
        let output = cargo.output().map_err(|error| Failure::trouble(format!("cargo: {error}")))?;
        if !output.status.success() {
            let text = String::from_utf8_lossy(&output.stderr);
            return Err(Failure::trouble(format!("{place} cannot be built for {}:\n{text}", self.name())));
        }
        Ok(Some(folder.join(triple).join("release").join(place)))
    }

    /// Runs a program and returns its exit code and output.
    pub fn run(self, program: &Path) -> Result<(i32, String), Failure> {
        self.run_with(program, &[])
    }

    /// Runs a program with arguments, if its processor has an operating system that passes them on.
    pub fn run_with(self, program: &Path, arguments: &[&OsStr]) -> Result<(i32, String), Failure> {
        let (words, package) = self.emulator();
        let mut command = Command::new(words[0]);
        command.args(&words[1..]).arg(program).args(arguments);
        let output = command.output().map_err(|error| {
            Failure::trouble(format!("{}: {error}; it is in the Debian package {package}", words[0]))
        })?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        Ok((output.status.code().unwrap_or(-1), text))
    }

    /// Compiler of its programs.
    pub fn compiler(self) -> String {
        let rustup = rustup_has(self.triple());
        let version = Command::new(if rustup { "rustc" } else { "/usr/bin/rustc" }).arg("--version").output();
        version.map_or("an unknown compiler".into(), |output| String::from_utf8_lossy(&output.stdout).trim().into())
    }
}

/// Linker of the toolchain.
fn linker() -> Result<PathBuf, Failure> {
    let rustc = |arguments: &[&str]| {
        let output = Command::new("rustc").args(arguments).output().map_err(Failure::trouble)?;
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let root = rustc(&["--print", "sysroot"])?;
    let version = rustc(&["-vV"])?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default();
    Ok([root.trim(), "lib", "rustlib", host, "bin", "rust-lld"].iter().collect())
}
