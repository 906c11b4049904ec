//! Builds the firmware for small processors, runs it in QEMU, and tabulates its cost. `cargo firmware --help` from the project's root.

mod check;
mod clocks;
mod cores;
mod frames;
mod hart;
mod image;
mod knobs;
mod latencies;
mod measure;
mod predict;
mod price;
mod system;
mod target;
mod vectors;

use std::path::PathBuf;
use std::process::ExitCode;

use target::Target;

const HELP: &str = "\
The datapath on small processors: the same bits, and their cost.

cargo firmware check [TARGET…]
    Checks golden vectors and a tile of a picture, on every target or on the named ones. Both must also notice a table with one wrong
    entry. On riscv32imac some prices of PRICE.md are checked, too, and on riscv32i predicted clocks of soft cores.
cargo firmware frames
    Draws golden frames of the emulator on s390x, whose words begin with their highest byte. Two minutes.
cargo firmware vectors
    Writes the sets of vectors/smoke with the program on s390x and compares them byte for byte. Two minutes, most of it building.
cargo firmware price [--quick] [-o FILE]
    Writes instructions, bytes and stack of every plan as one table: emulator/firmware/PRICE.md. One compiler always gives the same
    numbers. --quick: two profiles on one target, to standard output.
cargo firmware price --knobs [-o FILE]
    Writes instructions, bytes and stack of one plan at many settings of the accuracy knobs, and instructions of a probe at every width,
    on the three QEMU machines. It also predicts clocks of a fragment, alone and in a batch, and of a probe on all soft cores, from the
    latencies of `cargo firmware clocks`: emulator/firmware/knobs.json. About 300 programs, twenty minutes on two cores; an interrupted run resumes.
cargo firmware clocks [--core NAME] [--predict]
    Runs the Verilog of soft cores in Verilator. It writes clocks of each kind of instruction, clocks of a fragment alone and in a batch
    and of a probe, and the clocks that the kinds predict: emulator/firmware/clocks.json, and a part of PRICE.md. The cores are Python
    packages, which pip installs below emulator/firmware/target. A quarter of an hour on two cores.
    --core: one core; the rows of the others stay. --predict: predictions from the kept clocks of instructions, without Verilator.
cargo firmware system
    Runs programs and the tile in LiteX systems in Verilator: VexRiscv with caches, the bus, a model of an SDRAM. It writes clocks and a
    part of PRICE.md. Python packages come by pip; compiling needs Debian's libevent-dev libjson-c-dev zlib1g-dev. Twenty
    minutes on two cores.

Targets: riscv32imac, riscv32i, thumbv7m (QEMU machines), aarch64, s390x (user-mode emulation).
Rust's targets come from rustup. If it has none, they are built from the sources of the distribution's compiler (Debian: rustc-web
rust-web-src). Emulators: Debian packages qemu-system-misc, qemu-system-arm, qemu-user; linkers gcc-aarch64-linux-gnu, gcc-s390x-linux-gnu.

Exit codes: 0 success; 1 something is missing or cannot be built; 2 wrong arguments; 3 bits differ, a program holds a table that it should
not hold, its instructions differ from PRICE.md, or predicted clocks are more than 10 % off.";

/// Failure, with its exit code.
#[derive(Debug)]
pub struct Failure(u8, String);

impl Failure {
    /// Failure of the environment: something is missing, cannot be built or cannot be read.
    pub fn trouble(what: impl std::fmt::Display) -> Self {
        Self(1, what.to_string())
    }
    /// Failure of a promise.
    pub fn broken(what: impl std::fmt::Display) -> Self {
        Self(3, what.to_string())
    }
}

fn run() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let usage = |what: String| Failure(2, format!("{what}\n\n{HELP}"));
    match arguments.next().as_deref() {
        Some("check") => {
            let named: Result<Vec<Target>, Failure> = arguments
                .map(|name| Target::by_name(&name).ok_or_else(|| usage(format!("no target is named {name}"))))
                .collect();
            let named = named?;
            check::run(if named.is_empty() { &Target::ALL } else { &named })
        }
        Some("clocks") => {
            let (mut core, mut predict) = (None, false);
            while let Some(flag) = arguments.next() {
                match flag.as_str() {
                    "--predict" => predict = true,
                    "--core" => core = Some(arguments.next().ok_or_else(|| usage("--core needs a name".into()))?),
                    other => return Err(usage(format!("clocks has no flag {other}"))),
                }
            }
            clocks::run(core.as_deref(), predict)
        }
        Some("frames") => frames::run(Target::S390X),
        Some("vectors") => vectors::run(Target::S390X),
        Some("price") => {
            let (mut quick, mut by_knobs, mut file) = (false, false, None);
            while let Some(flag) = arguments.next() {
                match flag.as_str() {
                    "--quick" => quick = true,
                    "--knobs" => by_knobs = true,
                    "-o" => {
                        let name = arguments.next().ok_or_else(|| usage("-o needs a file".into()))?;
                        file = Some(PathBuf::from(name));
                    }
                    other => return Err(usage(format!("price has no flag {other}"))),
                }
            }
            match (by_knobs, quick) {
                (true, true) => Err(usage("either --knobs or --quick".into())),
                (true, false) => knobs::run(file),
                (false, _) => price::run(quick, file),
            }
        }
        Some("system") => match arguments.next() {
            None => system::run(),
            Some(other) => Err(usage(format!("system has no argument {other}"))),
        },
        Some("--help" | "-h") => {
            println!("{HELP}");
            Ok(())
        }
        other => Err(usage(other.map_or("no command is given".into(), |other| format!("no command is named {other}")))),
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure(code, what)) => {
            eprintln!("{what}");
            ExitCode::from(code)
        }
    }
}
