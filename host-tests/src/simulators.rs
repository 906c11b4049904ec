//! Hardware tools as programs: their presence, scripts of testbenches, and a Verilator model of a generated module.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A file of `vectors/hdl`.
pub fn hdl(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/hdl").join(file)
}

/// Returns true if a tool is installed, and prints a message if it is not.
///
/// Panics if it is missing and `ROUGHXEL_REQUIRE_TOOLS` is set.
pub fn have(tool: &str) -> bool {
    let found = Command::new(tool).arg("-V").output().is_ok();
    if !found {
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "{tool} is not installed");
        eprintln!("SKIPPED: {tool} is not installed, so nothing here was checked with it");
    }
    found
}

/// Runs a command. Panics with its output if it fails.
pub fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{command:?}\n{}\n{}", text(&output.stdout), text(&output.stderr));
    output
}

/// The command that runs `run.sh` of a testbench; callers add a tool and options. The compiled model runs briefly and is not optimised.
pub fn bench_script(script: &Path) -> Command {
    let mut command = Command::new("sh");
    command.arg(script).env("OPT", "-O0");
    keep_objects(&mut command);
    command
}

/// Makes a command that runs Verilator compile Verilator's own library once for all models, below `target`. The library takes longer to compile
/// than most models.
pub fn keep_objects(command: &mut Command) {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let kept = package.join("../target/verilator-objects");
    fs::create_dir_all(&kept).unwrap_or_else(|error| panic!("{}: {error}", kept.display()));
    let script = package.join("src/keep_objects.sh");
    command.env("OBJCACHE", format!("sh {}", script.display())).env("ROUGHXEL_OBJECTS", kept);
}

/// Command that makes a Verilator model of a module with its testbench ([`Bench::files`](roughxel_netlist::bench::Bench::files)) in a directory, and the
/// program that comes of it, below `directory/obj`. Callers add options and sources.
///
/// `make` holds variables of Verilator's makefile: `OPT_FAST=-O3` for a model that runs long. For a model that runs briefly, `OPT_FAST=-O0
/// VM_PARALLEL_BUILDS=0` compiles it as one file.
pub fn verilator(directory: &Path, module: &str, make: &str) -> (Command, PathBuf) {
    let objects = directory.join("obj");
    let program = objects.join("bench");
    fs::create_dir_all(&objects).unwrap_or_else(|error| panic!("{}: {error}", objects.display()));
    let flat = format!("{module}_flat");
    let mut command = Command::new("verilator");
    command.args(["--cc", "--exe", "--build", "-O3", "--prefix", "Vdesign", "-CFLAGS", "-std=c++17"]);
    command.args(["--top-module", &flat, "-MAKEFLAGS"]).arg(format!("{make} OPT_SLOW=-O0 OPT_GLOBAL=-O1"));
    command.arg("--Mdir").arg(&objects).arg("-o").arg(&program);
    command.arg(directory.join(format!("{flat}.v"))).arg(hdl("verilator_bench.cpp"));
    keep_objects(&mut command);
    (command, program)
}

/// Builds the model of [`verilator`] from the sources in the directory, and returns the program. Panics if Verilator or the compiler fails.
pub fn verilate(directory: &Path, module: &str, make: &str) -> PathBuf {
    let (mut command, program) = verilator(directory, module, make);
    run(command.args(["--x-assign", "fast", "--x-initial", "fast", "-y"]).arg(directory));
    program
}
