//! Testbenches that `roughxel vectors bench` writes: they pass on the generated Verilog in every tool, and each names the broken part.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_host_tests::simulators::{bench_script, have};
use roughxel_vectors::{Device, SetInfo, Testbench, TestbenchError, Words, export_with, random_set};
use tempfile::TempDir;

/// A testbench of 64 vectors of a mirror under `narrow`, which every tool builds in seconds.
struct Written {
    directory: TempDir,
}

impl Written {
    fn new(device: Device) -> Self {
        Self::with_words(device, Words::default())
    }

    fn with_words(device: Device, words: Words) -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let precision = Precision::NARROW;
        let info = SetInfo::new("bench", Datapath::Reflection, Effects::NONE, "narrow", precision);
        let info = SetInfo { seed: Some("bench"), words, ..info };
        let input = |index| random_set(Datapath::Reflection, "bench", index, &precision);
        export_with(&info, 64, &input, directory.path(), &|_| {}).expect("the set can be written");
        let written = Self { directory };
        let kept = written.read().and_then(|bench| bench.write(&written.bench(), device, false));
        assert!(kept.expect("a testbench").is_empty());
        written
    }

    fn read(&self) -> Result<Testbench, TestbenchError> {
        Testbench::new(&self.directory.path().join("bench_narrow.json"))
    }

    fn bench(&self) -> PathBuf {
        self.directory.path().join("bench_narrow")
    }

    /// Exit code and output of `run.sh`.
    fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        run_bench(&self.bench(), arguments)
    }

    /// Exit code and output of `run.sh` with the words of the device.
    fn run_for_words(&self, arguments: &[&str]) -> (Option<i32>, String, String) {
        let path = self.directory.path().join("got.hex");
        let (code, text) = self.run(&[arguments, &["--got", path.to_str().expect("a path in Unicode")]].concat());
        let words = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{error}: {text}"));
        fs::remove_file(path).expect("the file exists");
        (code, text, words)
    }

    /// Makes every reflected vector half as long.
    fn break_reflect(&self) {
        let path = self.bench().join("rtl/reflect.v");
        let text = fs::read_to_string(&path).expect("the module");
        let broken = text.replacen("5'd1", "5'd2", 1);
        assert_ne!(broken, text);
        fs::write(path, broken).expect("the module can be written");
    }
}

/// Runs the testbench in a folder: its exit code and its output.
pub(super) fn run_bench(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = bench_script(&folder.join("run.sh"));
    command.args(arguments);
    if let Some(installed) = installed_cocotb() {
        command.env("PYTHONPATH", installed);
    }
    let output = command.output().expect("a shell");
    (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Returns true if Python finds cocotb. Otherwise prints a message, and panics if cocotb is required.
pub(super) fn have_cocotb() -> bool {
    let mut command = Command::new("python3");
    if let Some(installed) = installed_cocotb() {
        command.env("PYTHONPATH", installed);
    }
    let found = command.args(["-c", "import cocotb_tools.runner"]).output().is_ok_and(|output| output.status.success());
    if !found {
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "cocotb is not installed");
        eprintln!("SKIPPED: cocotb 2 is not installed, so nothing here was checked with it");
    }
    found
}

/// Folder in which `.ci/run` installs cocotb, if it exists.
pub(super) fn installed_cocotb() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/cocotb");
    folder.exists().then_some(folder)
}

#[test]
fn benches_pass_on_the_generated_verilog_and_name_what_is_broken() {
    let written = Written::new(Device::Generated);
    let tools: Vec<(&str, &str)> =
        [("icarus", "iverilog"), ("cocotb", "iverilog"), ("verilator", "verilator"), ("cpp", "verilator")]
            .into_iter()
            .filter(|&(tool, program)| have(program) && (tool != "cocotb" || have_cocotb()))
            .collect();
    for (tool, _) in &tools {
        let (code, text) = written.run(&[tool, "--stalls"]);
        assert!(code == Some(0) && text.contains("PASS bench_narrow: 64 vectors"), "{tool}: {text}");
    }
    written.break_reflect();
    for (tool, _) in &tools {
        let (code, text) = written.run(&[tool, "--stop", "2"]);
        assert_eq!(code, Some(3), "{tool}: {text}");
        assert!(text.contains("bench_narrow #0: stage reflect, field reflected_"), "{tool}: {text}");
        assert!(text.contains("FAIL bench_narrow: 2 of ") && text.contains("stopped there"), "{tool}: {text}");
    }
    let mut given: Vec<String> = Vec::new();
    for (tool, _) in &tools {
        let (code, text, words) = written.run_for_words(&[tool, "--built", "--stop", "1"]);
        assert_eq!(code, Some(3), "{tool}: {text}");
        assert!(text.contains(" of 64 vectors differ") && !text.contains("bench_narrow #1: "), "{tool}: {text}");
        assert_eq!(words.lines().count(), 64, "{tool}: {words}");
        given.push(words);
        let (code, text) = written.run(&[tool, "--built", "--got", "no/such/folder"]);
        assert!(code == Some(1) && text.contains("ERROR") && text.contains("cannot be written"), "{tool}: {text}");
    }
    assert!(given.windows(2).all(|two| two[0] == two[1]), "each tool gives the same words of one device");
}

#[test]
fn a_set_without_taps_has_a_bench_whose_generated_device_leaves_them_open() {
    if !have("iverilog") {
        return;
    }
    let written = Written::with_words(Device::Generated, Words { taps: false, ..Words::default() });
    let device = fs::read_to_string(written.bench().join("bench_narrow_device.sv")).expect("the device");
    assert!(device.contains("\n    .out_reflected_mantissa_0_i2f14(),\n"), "{device}");
    let (code, text) = written.run(&["icarus"]);
    assert!(code == Some(0) && text.contains("PASS bench_narrow: 64 vectors"), "{text}");
    written.break_reflect();
    let (code, text) = written.run(&["icarus", "--stop", "2"]);
    assert_eq!(code, Some(3), "{text}");
    assert!(text.contains("FAIL bench_narrow: 2 of ") && !text.contains("stage reflect"), "{text}");
}

#[test]
fn the_bench_in_vhdl_plays_back_its_words_and_names_an_altered_one() {
    if !have("ghdl") {
        return;
    }
    let written = Written::new(Device::Blank);
    let (code, text) = written.run(&["ghdl", "--playback", "--stalls"]);
    assert!(code == Some(0) && text.contains("PASS bench_narrow: 64 vectors"), "{text}");
    let (code, text) = written.run(&["ghdl", "--playback", "--altered", "7"]);
    assert_eq!(code, Some(3), "{text}");
    assert!(text.contains("bench_narrow #7: stage perturb, field normal_mod_x: expected "), "{text}");
    assert!(text.contains("FAIL bench_narrow: 1 of 64 vectors differ"), "{text}");
    let expected = fs::read_to_string(written.bench().join("words.hex")).expect("words");
    let expected: Vec<_> =
        expected.lines().filter(|l| !l.starts_with("//")).map(|line| line.replace('_', "")).collect();
    let (code, _, words) = written.run_for_words(&["ghdl", "--built", "--playback"]);
    assert!(code == Some(0) && words.lines().eq(&expected), "{words}");
    let (code, _, words) = written.run_for_words(&["ghdl", "--built", "--playback", "--altered", "7", "--stop", "1"]);
    let differing: Vec<_> = words.lines().zip(&expected).enumerate().filter(|(_, (got, word))| got != word).collect();
    assert!(code == Some(3) && differing.len() == 1 && differing[0].0 == 7, "{differing:?}");
    let (code, text) = written.run(&["ghdl", "--built", "--playback", "--got", "no/such/folder"]);
    assert!(code == Some(1) && text.contains("ERROR") && text.contains("cannot be written"), "{text}");
    // The blank device.
    let (code, text) = written.run(&["ghdl", "--stop", "3", "--outputs-only"]);
    assert_eq!(code, Some(3), "{text}");
    assert!(text.contains("stage cube_face") && !text.contains("stage reflect"), "{text}");
    assert!(text.contains("FAIL bench_narrow: 3 of "), "{text}");
}

#[test]
fn a_blank_device_says_how_signed_members_are_read_in_every_simulator() {
    let written = Written::new(Device::Blank);
    let device = fs::read_to_string(written.bench().join("bench_narrow_device.sv")).expect("the device");
    assert!(
        device.contains("Icarus 11 reads a signed member") && device.contains("$signed(inputs.normal_x)"),
        "{device}"
    );
}

#[test]
fn a_device_that_is_there_stays_and_a_damaged_set_is_refused() {
    let written = Written::new(Device::Blank);
    let kept = written.read().and_then(|bench| bench.write(&written.bench(), Device::Generated, false));
    assert_eq!(kept.expect("a testbench"), ["bench_narrow_device.sv", "bench_narrow_device.vhd"]);
    let kept = written.read().and_then(|bench| bench.write(&written.bench(), Device::Generated, true));
    assert!(kept.expect("a testbench").is_empty());

    let words = written.directory.path().join("bench_narrow.hex");
    let text = fs::read_to_string(&words).expect("the words");
    fs::write(&words, text.replacen("_0", "_1", 1)).expect("the words can be written");
    let error = written.read().map(drop).expect_err("the words are damaged").to_string();
    assert!(error.contains("bench_narrow.hex") && error.contains("export the set again"), "{error}");
}
