//! The tools of hardware people, as programs: whether they are there, scripts of benches, and a Verilator model of a generated module.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A file of `vectors/hdl`.
pub fn hdl(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/hdl").join(file)
}

/// Whether a tool is there; says so where it is not.
///
/// Panics where it has to be: with `ROUGHXEL_REQUIRE_TOOLS` set.
pub fn have(tool: &str) -> bool {
    let found = Command::new(tool).arg("-V").output().is_ok();
    if !found {
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "{tool} is not installed");
        eprintln!("SKIPPED: {tool} is not installed, so nothing here was checked with it");
    }
    found
}

/// Runs a command. Panics where it fails, with what it said.
pub fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{command:?}\n{}\n{}", text(&output.stdout), text(&output.stderr));
    output
}

/// The command that runs `run.sh` of a bench, to which a tool and options are added: what it compiles runs shortly and is not optimised.
pub fn bench_script(script: &Path) -> Command {
    let mut command = Command::new("sh");
    command.arg(script).env("OPT", "-O0");
    keep_objects(&mut command);
    command
}

/// Has a command that runs Verilator compile Verilator's own library once for all models, below `target`: it takes longer than most of them.
fn keep_objects(command: &mut Command) {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let kept = package.join("../target/verilator-objects");
    fs::create_dir_all(&kept).unwrap_or_else(|error| panic!("{}: {error}", kept.display()));
    let script = package.join("src/keep_objects.sh");
    command.env("OBJCACHE", format!("sh {}", script.display())).env("ROUGHXEL_OBJECTS", kept);
}

/// Builds the Verilator model of a module that stands in a directory with its bench
/// ([`Bench::files`](roughxel_netlist::bench::Bench::files)), below `directory/obj`, and returns the program.
///
/// `make` are variables of Verilator's makefile: `OPT_FAST=-O3` for a model that runs long, and for one that does not
/// `OPT_FAST=-O0 VM_PARALLEL_BUILDS=0`, which compiles it as one file. Panics where Verilator or the compiler fails.
pub fn verilate(directory: &Path, module: &str, make: &str) -> PathBuf {
    let objects = directory.join("obj");
    let program = objects.join("bench");
    fs::create_dir_all(&objects).unwrap_or_else(|error| panic!("{}: {error}", objects.display()));
    let flat = format!("{module}_flat");
    let mut command = Command::new("verilator");
    command.args(["--cc", "--exe", "--build", "-O3", "--x-assign", "fast", "--x-initial", "fast"]);
    command.args(["--prefix", "Vdesign", "-CFLAGS", "-std=c++17", "--top-module", &flat, "-MAKEFLAGS"]);
    command.arg(format!("{make} OPT_SLOW=-O0 OPT_GLOBAL=-O1")).arg("--Mdir").arg(&objects);
    command.arg("-y").arg(directory).arg("-o").arg(&program);
    keep_objects(&mut command);
    run(command.arg(directory.join(format!("{flat}.v"))).arg(hdl("verilator_bench.cpp")));
    program
}
