//! Shells: a design behind streams and registers gives the bits of the scalar backend in every testbench, and the files for tools describe it.

mod files;
mod registers;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use rayon::prelude::*;
use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_host_tests::simulators::{have, run};
use roughxel_host_tests::space::is_full_run;
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{Options, Shell, Verilog};
use roughxel_record as record;
use roughxel_utilities::output::write_files;
use roughxel_vectors::{Device, HardwareForm, Testbench, shell_bench};
use tempfile::TempDir;

use super::benches::{have_cocotb, installed_cocotb, run_bench};
use super::rtl::{FULL, options};

/// A folder as `roughxel verilog --stream` writes it.
pub(super) struct Folder {
    directory: TempDir,
    verilog: Verilog,
}

impl Folder {
    pub(super) fn new(design: Design, options: &Options) -> Self {
        let verilog = record::verilog(design, options).expect("the design is proven");
        let bench = shell_bench(design, options, &verilog).expect("the ports hold the vectors");
        let directory = tempfile::tempdir().expect("a temporary directory");
        write_files(directory.path(), verilog.in_order()).expect("the directory can be written");
        write_files(directory.path(), bench).expect("the directory can be written");
        Self { directory, verilog }
    }

    pub(super) fn shell(&self) -> &Shell {
        self.verilog.shell.as_ref().expect("a shell")
    }

    pub(super) fn path(&self, file: &str) -> PathBuf {
        self.directory.path().join(file)
    }

    pub(super) fn text(&self, file: &str) -> String {
        fs::read_to_string(self.path(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
    }

    /// Puts a text in the place of another in a file.
    fn change(&self, file: &str, from: &str, to: &str) {
        change(&self.path(file), from, to);
    }

    fn lint(&self) {
        for module in [&self.shell().axis, &self.shell().module, &self.shell().bfm] {
            let mut command = Command::new("verilator");
            command.args(["--lint-only", "-Wall", "--top-module", module, "-y"]).arg(self.path(""));
            run(command.arg(self.path(&format!("{module}.v"))));
        }
    }

    /// Output of `bench/bench.v` in Icarus.
    fn icarus(&self, arguments: &[&str]) -> String {
        let mut command = Command::new("iverilog");
        command.args([
            "-g2005",
            "-s",
            "bench",
            "-I",
            "bench",
            "-y",
            ".",
            "-y",
            "bench",
            "-o",
            "bench.vvp",
            "bench/bench.v",
        ]);
        run(command.current_dir(self.path("")));
        let mut command = Command::new("vvp");
        let output = run(command.args(["-N", "../bench.vvp"]).args(arguments).current_dir(self.path("bench")));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Success and output of `bench/test_shell.py`.
    fn cocotb(&self, gaps: &str) -> (bool, String) {
        let mut command = Command::new("python3");
        command.arg(self.path("bench/test_shell.py")).env("GAPS", gaps).current_dir(self.path(""));
        if let Some(installed) = installed_cocotb() {
            command.env("PYTHONPATH", installed);
        }
        let output = command.output().expect("python3 runs");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.success(), text(&output.stdout) + &text(&output.stderr))
    }
}

/// Puts a text in the place of its first occurrence in a file.
fn change(path: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(text.contains(from), "{} has no `{from}`", path.display());
    fs::write(path, text.replacen(from, to, 1)).expect("the file can be written");
}

/// Files that a FuseSoC core names.
fn files_of_core(core: &str) -> Vec<&str> {
    let files = core.lines().filter_map(|line| line.strip_prefix("      - "));
    files.map(|file| file.split(": {").next().unwrap_or(file)).collect()
}

pub(super) fn shell_options(profile: &str, effects: Effects, multipliers: Option<u32>, stream: u32) -> Options {
    Options { multipliers, stream: Some(stream), ..options(profile, effects, None) }
}

/// Faults of a shell: the module, a text in it, its broken form.
const FAULTS: [(&str, &str, &str, &str); 7] = [
    (
        "the order of words",
        "axis",
        "{s_axis_tdata, words[IN_WORDS*WIDTH-1:WIDTH]}",
        "{words[(IN_WORDS-1)*WIDTH-1:0], s_axis_tdata}",
    ),
    ("a word while the design is busy", "axis", "s_axis_tready = ~full | in_ready", "s_axis_tready = 1'b1"),
    ("a word of an outcome", "axis", "result <= result >> WIDTH", "result <= result >> (2 * WIDTH)"),
    ("an outcome that is not taken yet", "axis", "out_ready = ~m_axis_tvalid |", "out_ready = 1'b1 |"),
    ("constants that are not taken", "axis", "else if (constants_taken) constants <=", "else if (1'b0) constants <="),
    ("constants of a fragment that waits", "axis", "else if (constants_taken) constants <=", "else constants <="),
    ("a take that is lost", "shell", "pending <= 1'b1", "pending <= 1'b0"),
];

#[test]
fn a_shell_gives_the_scalar_bits_back_to_back_and_with_gaps() {
    let mut cases = vec![
        (Design::Fragment, shell_options("narrow", FULL, Some(8), 32)),
        (Design::Reflection, Options { target: Target::Ecp5, ..shell_options("narrow", FULL, Some(6), 64) }),
        (Design::Texture, shell_options("standard", FULL, None, 24)),
        (Design::LitPeak, shell_options("compact", FULL, None, 512)),
        // A stepper, with an outcome for each probe.
        (Design::TextureProbe, shell_options("narrow", FULL, None, 32)),
    ];
    if is_full_run() {
        let all = Design::ALL.iter().map(|&design| (design, shell_options("standard", FULL, Some(3), 32)));
        cases.extend(all);
    }
    cases.into_par_iter().for_each(|(design, options)| {
        let folder = Folder::new(design, &options);
        if have("verilator") {
            folder.lint();
        }
        if have("iverilog") {
            for arguments in [&[][..], &["+stalls"]] {
                let text = folder.icarus(arguments);
                assert!(text.contains("PASS") && !text.contains("ERROR"), "{} {arguments:?}: {text}", design.name());
            }
        }
    });
}

#[test]
fn faults_of_a_shell_are_found() {
    if !have("iverilog") {
        return;
    }
    FAULTS.par_iter().for_each(|&(what, module, from, to)| {
        let folder = Folder::new(Design::Fragment, &shell_options("narrow", FULL, Some(16), 32));
        folder.change(&format!("roughxel_fragment_{module}.v"), from, to);
        let text = folder.icarus(&["+stalls"]);
        assert!(!text.contains("PASS"), "{what}: {text}");
    });
}

#[test]
fn a_shell_that_breaks_a_rule_of_its_buses_fails_in_its_own_testbench() {
    if !have("iverilog") {
        return;
    }
    // A comparison in parentheses is inverted as a whole.
    let faults = [
        ("axis", "m_axis_tlast = ", "m_axis_tlast = ~(VALUE)", "ERROR m_axis_tlast"),
        ("axis", "m_axis_tdata = ", "m_axis_tdata = VALUE ^ {WIDTH{received[0]}}", "ERROR m_axis changed"),
        ("shell", "s_axi_bresp = ", "s_axi_bresp = VALUE | 2'b10", "ERROR s_axi_bresp"),
    ];
    for (module, from, to, message) in faults {
        let folder = Folder::new(Design::Fragment, &shell_options("narrow", FULL, Some(16), 32));
        let file = format!("roughxel_fragment_{module}.v");
        let text = folder.text(&file);
        let line = text.lines().find(|line| line.contains(from)).expect("the signal");
        let (_, value) = line.trim_end_matches(';').split_once("= ").expect("its value");
        folder.change(&file, line, &format!("  assign {};", to.replace("VALUE", value)));
        let text = folder.icarus(&["+stalls"]);
        assert!(text.contains(message) && text.contains("FAIL") && !text.contains("PASS"), "{message}: {text}");
    }
}

#[test]
fn the_test_for_cocotb_drives_the_buses_and_finds_faults() {
    if !have("iverilog") || !have_cocotb() {
        return;
    }
    let options = Options { target: Target::Ecp5, ..shell_options("narrow", FULL, Some(8), 32) };
    let folder = Folder::new(Design::Reflection, &options);
    for gaps in ["0", "1"] {
        let (passed, text) = folder.cocotb(gaps);
        assert!(passed && text.contains("PASS roughxel_reflection_shell: 0 of "), "{text}");
    }
    for (what, module, from, to) in [FAULTS[0], FAULTS[2], FAULTS[4]] {
        let folder = Folder::new(Design::Reflection, &options);
        folder.change(&format!("roughxel_reflection_{module}.v"), from, to);
        let (passed, text) = folder.cocotb("1");
        assert!(!passed && text.contains("FAIL roughxel_reflection_shell: "), "{what}: {text}");
    }
}

/// A testbench of a committed set whose device is a shell around a folded design.
struct SetBench {
    directory: TempDir,
    set: &'static str,
}

impl SetBench {
    fn new(set: &'static str) -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let smoke = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/smoke");
        let bench = Testbench::new(&smoke.join(format!("{set}.json"))).expect("a committed set");
        let form = HardwareForm { multipliers: Some(8), target: Target::Ecp5, stream: Some(32) };
        bench.write(directory.path(), Device::Formed(form), false).expect("a testbench");
        Self { directory, set }
    }

    fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        run_bench(self.directory.path(), arguments)
    }

    fn passes(&self, arguments: &[&str]) {
        let (code, text) = self.run(arguments);
        assert!(code == Some(0) && text.contains(&format!("PASS {}: 256 vectors", self.set)), "{arguments:?}: {text}");
        assert!(!text.contains("ERROR"), "{text}");
    }
}

#[test]
fn a_committed_set_goes_through_the_shell_of_a_folded_design_in_every_testbench() {
    let bench = SetBench::new("random_narrow");
    for (tool, program) in
        [("icarus", "iverilog"), ("verilator", "verilator"), ("cpp", "verilator"), ("cocotb", "iverilog")]
    {
        if have(program) && (tool != "cocotb" || have_cocotb()) {
            bench.passes(&[tool]);
            bench.passes(&[tool, "--built", "--stalls"]);
        }
    }
    // The core of the folder names files that are there.
    let rtl = bench.directory.path().join("rtl");
    let core = fs::read_to_string(rtl.join("roughxel_fragment.core")).expect("a core");
    for file in files_of_core(&core) {
        assert!(rtl.join(file).exists(), "{file}");
    }
    let broken = SetBench::new("random_narrow");
    let faults = if is_full_run() { &FAULTS[..] } else { &FAULTS[..1] };
    for (what, module, from, to) in faults {
        let path = broken.directory.path().join(format!("rtl/roughxel_fragment_{module}.v"));
        change(&path, from, to);
        if have("iverilog") {
            let (code, text) = broken.run(&["icarus", "--stop", "1", "--stalls"]);
            assert!(code == Some(3) || code == Some(1) && text.contains("ERROR"), "{what}: {code:?} {text}");
        }
        change(&path, to, from);
    }
}

#[test]
fn a_set_of_a_stage_has_no_shell() {
    let stages = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/smoke/stages");
    let manifest = roughxel_vectors::manifests_in(&stages).expect("sets of stages").remove(0);
    let directory = tempfile::tempdir().expect("a temporary directory");
    let form = HardwareForm { stream: Some(32), ..HardwareForm::default() };
    let bench = Testbench::new(&manifest).expect("a committed set");
    let error = bench.write(directory.path(), Device::Formed(form), false).expect_err("a stage").to_string();
    assert!(error.contains("has no shell"), "{error}");
}
