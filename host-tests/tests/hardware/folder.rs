//! Folder `vectors` without Rust: its Python model against the committed sets and fresh ones of every profile and effect, the code on the page of
//! the arithmetic, the hand-written Verilog.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use roughxel_core::plan::{Datapath, Effects, FootprintKind};
use roughxel_core::precision::Precision;
use roughxel_host_tests::simulators::{have, hdl, run};
use roughxel_host_tests::space::{effects, in_turn, is_full_run, profiles, whole_or};
use roughxel_vectors::{
    Form, Manifest, RANDOM_SETS, RandomSetSummary, SetExport, SetInfo, Shard, Words, export_with, hard_sets,
    manifests_in, random_set,
};

/// A file of `vectors`.
fn vectors(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors").join(file)
}

/// The model's program.
fn model() -> Command {
    let mut command = Command::new("python3");
    command.arg(vectors("roughxel_model.py"));
    command
}

/// Number of sets and folders of tables that the model confirmed.
fn right(output: &Output) -> usize {
    String::from_utf8_lossy(&output.stdout).lines().filter(|line| line.ends_with(", all right")).count()
}

/// Exports `count` vectors of a random set, named after its datapath and `number`.
fn random(directory: &Path, number: usize, effects: Effects, datapath: Datapath, of: (&str, Precision), count: u64) {
    let (profile, precision) = of;
    let name = format!("{}_{number}", RANDOM_SETS[datapath as usize].name);
    let info = SetInfo { seed: Some(&name), ..SetInfo::new(&name, datapath, effects, profile, precision) };
    let input = |index| random_set(datapath, &name, index, &precision);
    export_with(&info, count, &input, directory, &|_| {}).expect("a set is written");
}

#[test]
fn the_python_model_is_right_on_every_committed_set() {
    if !have("python3") {
        return;
    }
    let sets =
        ["smoke", "smoke/stages"].map(|folder| manifests_in(&vectors(folder)).expect("the committed sets").len());
    assert_eq!(right(&run(&mut model())), sets[0] + sets[1] + 1);
}

#[test]
fn the_python_model_reads_records_and_words_without_taps() {
    if !have("python3") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    for (profile, precision) in profiles() {
        for RandomSetSummary { name, datapath, description } in RANDOM_SETS {
            let words = Words { taps: false, form: Form::Bin };
            let of_all = SetInfo::new(name, datapath, Effects::ALL, profile, precision);
            let info = SetInfo { description, seed: Some(name), words, ..of_all };
            let input = |index| random_set(datapath, name, index, &precision);
            export_with(&info, 50, &input, directory.path(), &|_| {}).expect("a set is written");
        }
    }
    let sets = manifests_in(directory.path()).expect("sets");
    assert_eq!(right(&run(model().arg(directory.path()))), sets.len() + 1);

    let words = sets[0].with_extension("bin");
    let mut bytes = fs::read(&words).expect("records");
    bytes[40] ^= 8;
    fs::write(&words, bytes).expect("the words can be written");
    let output = model().arg(&sets[0]).output().expect("python3");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_python_model_is_right_in_every_profile_under_every_effect() {
    if !have("python3") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    for (profile, precision) in profiles() {
        for datapath in Datapath::ALL {
            random(directory.path(), 0, Effects::ALL, datapath, (profile, precision), whole_or(2000, 300));
            for (index, effects) in effects(Some(datapath)).into_iter().enumerate() {
                if in_turn(index, profile) {
                    random(directory.path(), index + 1, effects, datapath, (profile, precision), whole_or(200, 30));
                }
            }
        }
        // The hard cases of footprints, on the sphere.
        for set in hard_sets(&precision).iter().filter(|set| set.name.starts_with("footprint")) {
            let (count, step) = (set.inputs.len() as u64, whole_or(1, 5));
            let effects = Effects { footprint: FootprintKind::Sphere, ..set.effects };
            let info = SetInfo::new(set.name, set.datapath, effects, profile, precision);
            let input = |index| set.inputs[(index * step) as usize];
            export_with(&info, count.div_ceil(step), &input, directory.path(), &|_| {}).expect("a set is written");
        }
    }
    let sets = manifests_in(directory.path()).expect("sets").len();
    assert_eq!(right(&run(model().arg(directory.path()))), sets + 1);
}

/// The check value of a word in hex digits without its own check value.
pub(super) fn check_value(digits: &str) -> u32 {
    let bits = digits.chars().flat_map(|digit| {
        let value = digit.to_digit(16).expect("a hex digit");
        (0..4).rev().map(move |bit| value >> bit & 1)
    });
    bits.fold(u32::MAX, |crc, bit| (crc << 1) ^ if crc >> 31 == bit { 0 } else { 0x04c1_1db7 })
}

/// A committed set with the last bit of `reflected_x` of vector 1 inverted, with the right or with a wrong check value.
fn altered(directory: &Path, is_checked: bool) -> PathBuf {
    let path = |file: &str| directory.join(format!("random_standard.{file}"));
    for file in ["hex", "json"] {
        fs::copy(vectors("smoke").join(format!("random_standard.{file}")), path(file)).expect("the set can be copied");
    }
    alter(&path("json"), is_checked);
    path("json")
}

/// Alters any set in the same way.
fn alter(manifest_path: &Path, is_checked: bool) {
    let manifest = Manifest::read(manifest_path).expect("the manifest");
    let hex = manifest_path.with_extension("hex");
    let field = manifest.fields.iter().find(|field| field.name == "reflected_x").expect("a field");
    let text = fs::read_to_string(&hex).expect("the words");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let word = lines.iter_mut().filter(|line| !line.starts_with("//")).nth(1).expect("vector 1");
    let mut digits = word.replace('_', "");
    let place = digits.len() - 1 - field.lsb as usize / 4;
    let digit = u32::from_str_radix(&digits[place..=place], 16).expect("a hex digit") ^ 1;
    digits.replace_range(place..=place, &format!("{digit:x}"));
    if is_checked {
        let end = digits.len() - 8;
        digits = format!("{}{:08x}", &digits[..end], check_value(&digits[..end]));
    }
    *word = digits;
    fs::write(hex, lines.join("\n") + "\n").expect("a set is written");
}

#[test]
fn the_python_model_reads_parts_with_the_indices_of_the_whole_set() {
    if !have("python3") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    let datapath = Datapath::Reflection;
    let info = SetInfo::new("random", datapath, Effects::ALL, "standard", Precision::STANDARD);
    let info = SetInfo { seed: Some("random"), ..info };
    let input = |index| random_set(datapath, "random", index, &Precision::STANDARD);
    let parts: Vec<PathBuf> = (1..=2)
        .map(|number| {
            let shard = Shard::new(number, 2).expect("one of two");
            let part = SetExport::new(&info, 40).of_shard(shard).expect("the shard has vectors");
            let manifest = part.write(&input, directory.path(), &|_| {}).expect("a set is written");
            directory.path().join(manifest.stem() + ".json")
        })
        .collect();
    assert_eq!(right(&run(model().args(&parts))), 3);
    for (is_checked, message) in [
        (true, "1 of 20 vectors wrong; stage reflect, vector 21, reflected_x"),
        (false, "check value of vector 21 is wrong"),
    ] {
        alter(&parts[1], is_checked);
        let output = model().args(&parts).output().expect("python3 runs");
        let text = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
        assert!(text.contains(message), "{text}");
    }
}

#[test]
fn the_model_and_the_bench_name_what_was_altered_and_refuse_what_is_damaged() {
    if !have("python3") {
        return;
    }
    let bench = |set: &Path| {
        let mut command = Command::new("sh");
        let output = command.arg(hdl("handwritten/run.sh")).arg("reflect").arg(set).output().expect("a shell");
        (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let directory = tempfile::tempdir().expect("a temporary directory");

    let set = altered(directory.path(), false);
    let output = model().arg(&set).output().expect("python3 runs");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("check value of vector 1 is wrong: damaged word"), "{message}");
    if have("iverilog") {
        let (code, message) = bench(&set);
        assert_eq!(code, Some(1), "{message}");
        assert!(message.contains("vector 1: damaged word"), "{message}");
    }

    let set = altered(directory.path(), true);
    let output = model().arg(&set).output().expect("python3 runs");
    let message = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("1 of 256 vectors wrong; stage reflect, vector 1, reflected_x: expected "), "{message}");
    if have("iverilog") {
        let (code, message) = bench(&set);
        assert_eq!(code, Some(1), "{message}");
        assert!(message.contains("vector 1: reflected_x: expected "), "{message}");
        assert!(message.contains(" 1 wrong, 0 words damaged"), "{message}");
    }
}

#[test]
fn the_verilog_written_by_hand_is_right_on_the_committed_sets() {
    if !have("iverilog") || !have("python3") {
        return;
    }
    let script = hdl("handwritten/run.sh");
    if is_full_run() {
        run(Command::new("sh").arg(script));
        return;
    }
    // One set with few vectors whose normals are used as given, and the random ones.
    let sets = ["footprint_cancel_standard", "random_standard", "random_compact", "random_narrow"];
    for stage in ["normalise", "perturb", "reflect", "cube_face"] {
        let sets = sets.map(|set| vectors("smoke").join(format!("{set}.json")));
        run(Command::new("sh").arg(&script).arg(stage).args(sets));
    }
}

#[test]
fn the_code_on_the_page_of_the_arithmetic_runs() {
    if !have("python3") {
        return;
    }
    let page = fs::read_to_string(vectors("SPEC.md")).expect("the page");
    let blocks: Vec<&str> =
        page.split("```python\n").skip(1).filter_map(|rest| Some(rest.split_once("```")?.0)).collect();
    let code = blocks.join("\n");
    assert!(blocks.len() > 30 && code.matches("\nassert ").count() > 60, "{} blocks", blocks.len());
    let directory = tempfile::tempdir().expect("a temporary directory");
    let file = directory.path().join("page.py");
    fs::write(&file, code).expect("the code can be written");
    run(Command::new("python3").arg(file));
}

#[test]
fn values_from_the_inside_are_those_of_the_model() {
    if !have("python3") {
        return;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hardware/inside.py");
    run(Command::new("python3").arg("-B").arg(script).arg(vectors("")));
}
