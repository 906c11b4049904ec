//! `roughxel vectors shrink`: of a device that is broken, the simplest vector that shows it, in Icarus.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_host_tests::simulators::have;
use roughxel_vectors::{
    Device, SetExport, SetInfo, ShrinkError, ShrinkOptions, StageSet, Testbench, Vector, export_with, random_set,
    shrink, verify,
};

use super::benches::{have_cocotb, installed_cocotb};

/// A set of mirrors under `narrow` with its testbench: the manifest, the folder of the testbench.
fn set(directory: &Path, effects: Effects) -> (PathBuf, PathBuf) {
    let precision = Precision::NARROW;
    let info = SetInfo::new("bench", Datapath::Reflection, effects, "narrow", precision);
    let info = SetInfo { seed: Some("bench"), ..info };
    let input = |index| random_set(Datapath::Reflection, "bench", index, &precision);
    export_with(&info, 16, &input, directory, &|_| {}).expect("the set can be written");
    let manifest = directory.join("bench_narrow.json");
    let folder = directory.join("bench");
    written(&manifest, &folder);
    (manifest, folder)
}

fn written(manifest: &Path, folder: &Path) {
    Testbench::new(manifest).and_then(|bench| bench.write(folder, Device::Generated, false)).expect("a testbench");
}

fn options() -> ShrinkOptions {
    ShrinkOptions { tool: "icarus".into(), outputs_only: false, runs: 100 }
}

/// Breaks a module at the first occurrence of a text.
fn broken(folder: &Path, module: &str, from: &str, to: &str) {
    let path = folder.join("rtl").join(module);
    let text = fs::read_to_string(&path).expect("the module");
    let copy = text.replacen(from, to, 1);
    assert_ne!(copy, text);
    fs::write(path, copy).expect("the module can be written");
}

#[test]
fn a_broken_device_gets_the_simplest_vector_that_it_gets_wrong() {
    if !have("iverilog") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    let (manifest, folder) = set(directory.path(), Effects::NONE);
    let right = shrink(&manifest, 3, &folder, &options(), &|_| {}).expect("the bench runs");
    assert!(right.is_none(), "the device is right");

    broken(&folder, "reflect.v", " - {", " + {");
    let words = fs::read(folder.join("words.hex")).expect("the words");
    let shrunk = shrink(&manifest, 3, &folder, &options(), &|_| {}).expect("the bench runs").expect("it is wrong");
    assert!(shrunk.is_minimal && shrunk.stage == "reflect" && shrunk.runs > 2, "{shrunk:?}");
    // The bench is as it was.
    assert!(fs::read(folder.join("words.hex")).expect("the words") == words);
    assert_eq!(fs::read_dir(folder.join("build")).expect("the folder").count(), 0);

    let result = shrunk.write(&directory.path().join("result")).expect("the result can be written");
    assert!(result.ends_with("bench_min_narrow.json") && verify(&result, &|_| {}).expect("it can be read").passed());
    let vector = Vector::read(&result, 0).expect("it can be read");
    let explanation = vector.explain(Some(&vector.device_word(&shrunk.got).expect("fields of the device")));
    let wrong = explanation.wrong.as_ref().expect("the device is wrong");
    assert_eq!(wrong.stage, "reflect");
    // A mirror seen along an axis: n and v have one component each, of one bit.
    let of_inputs = || explanation.fields.iter().filter(|field| field.stage == "input" && field.integer != 0);
    assert_eq!(of_inputs().count(), 2, "{explanation:?}");
    assert!(of_inputs().all(|field| field.integer.count_ones() == 1 || field.integer.unsigned_abs().is_power_of_two()));

    // The vector found fails on its own, too.
    let alone = directory.path().join("alone");
    written(&result, &alone);
    fs::copy(folder.join("rtl/reflect.v"), alone.join("rtl/reflect.v")).expect("the module can be copied");
    let output = Command::new("sh").arg(alone.join("run.sh")).arg("icarus").output().expect("a shell");
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.starts_with("bench_min_narrow #0: stage reflect, "), "{text}");
    // The built testbench runs again without a build.
    let mut again = Command::new("sh");
    again.arg(alone.join("run.sh")).args(["icarus", "--built"]);
    assert_eq!(again.output().expect("a shell").status.code(), Some(3));
    fs::remove_dir_all(alone.join("build")).expect("the build can be removed");
    let output = again.output().expect("a shell");
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("ERROR nothing was built with icarus"));
}

#[test]
fn cocotb_finds_the_vector_that_icarus_finds_and_ghdl_has_devices_in_vhdl() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let with = |tool: &str, manifest: &Path, folder: &Path| {
        let options = ShrinkOptions { tool: tool.into(), ..options() };
        let shrunk = shrink(manifest, 3, folder, &options, &|_| {}).expect("the bench runs").expect("it is wrong");
        assert!(shrunk.is_minimal, "{tool}: {shrunk:?}");
        shrunk
    };
    if have("iverilog") && have_cocotb() {
        let (manifest, folder) = set(directory.path(), Effects::NONE);
        broken(&folder, "reflect.v", " - {", " + {");
        // Next to the test of the testbench, Python finds modules that no environment variable names.
        for package in installed_cocotb().into_iter().flat_map(|from| fs::read_dir(from).expect("a folder")) {
            let package = package.expect("the folder can be read");
            std::os::unix::fs::symlink(package.path(), folder.join(package.file_name())).expect("a link can be made");
        }
        let [one, other] = ["icarus", "cocotb"].map(|tool| with(tool, &manifest, &folder));
        assert_eq!((&one.simplified, &one.got, &one.stage), (&other.simplified, &other.got, &other.stage));
    }
    if have("ghdl") {
        // A VHDL device that produces no output.
        let of_vhdl = directory.path().join("vhdl");
        fs::create_dir(&of_vhdl).expect("a folder");
        let (manifest, _) = set(&of_vhdl, Effects::NONE);
        let folder = of_vhdl.join("blank");
        Testbench::new(&manifest).and_then(|bench| bench.write(&folder, Device::Blank, false)).expect("a testbench");
        let shrunk = with("ghdl", &manifest, &folder);
        let result = shrunk.write(&of_vhdl.join("result")).expect("the result can be written");
        assert!(shrunk.stage == "perturb" && verify(&result, &|_| {}).expect("it can be read").passed());
    }
}

#[test]
fn a_set_of_one_stage_is_refused_with_what_to_do() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let (manifest, folder) = set(directory.path(), Effects::NONE);
    let (datapath, effects, precision) = (Datapath::Reflection, Effects::NONE, Precision::NARROW);
    let stage = StageSet::select(datapath, &effects, &precision, Some("reflect")).expect("reflect").remove(0);
    let info = SetInfo::new("s", datapath, effects, "narrow", precision);
    let input = |index| random_set(datapath, "bench", index, &precision);
    let of_stage = directory.path().join("stage");
    let written = SetExport::of_stage(&info, 4, &stage).write(&input, &of_stage, &|_| {}).expect("a set of a stage");
    let of_stage = of_stage.join(&written.files[0].name).with_extension("json");
    let error = shrink(&of_stage, 0, &folder, &options(), &|_| {}).expect_err("a stage").to_string();
    assert!(error.contains("a set of one stage; shrink a vector of its datapath"), "{error}");
    let folder = directory.path().join("of_stage");
    Testbench::new(&of_stage).and_then(|bench| bench.write(&folder, Device::Blank, false)).expect("a testbench");
    let error = shrink(&manifest, 0, &folder, &options(), &|_| {}).expect_err("a bench of a stage");
    assert!(matches!(error, ShrinkError::OtherSet { .. }), "{error}");
}

#[test]
fn runs_are_bounded_and_a_bench_that_fails_says_why() {
    if !have("iverilog") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    let (manifest, folder) = set(directory.path(), Effects::NONE);
    broken(&folder, "reflect.v", " - {", " + {");
    let few = ShrinkOptions { runs: 2, ..options() };
    let shrunk = shrink(&manifest, 0, &folder, &few, &|_| {}).expect("the bench runs").expect("it is wrong");
    assert!(!shrunk.is_minimal && shrunk.runs == 2 && !shrunk.simplified.is_empty(), "{shrunk:?}");

    broken(&folder, "reflect.v", "endmodule", "");
    let error = shrink(&manifest, 0, &folder, &options(), &|_| {}).expect_err("it does not compile").to_string();
    assert!(error.contains("the testbench fails with icarus") && error.contains("reflect.v"), "{error}");
    assert_eq!(fs::read_dir(folder.join("build")).expect("the folder").count(), 0);

    let other = directory.path().join("other");
    fs::create_dir(&other).expect("a folder");
    let (manifest, _) = set(&other, Effects { bump: true, ..Effects::NONE });
    let error = shrink(&manifest, 0, &folder, &options(), &|_| {}).expect_err("another set");
    assert!(matches!(error, ShrinkError::OtherSet { .. }), "{error}");
}
