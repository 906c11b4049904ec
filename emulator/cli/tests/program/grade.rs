//! `vectors report` and `vectors distil`.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_roughxel")).arg("vectors").args(arguments).output().unwrap()
}

/// What the program writes to stdout, which it ends with that code.
fn stdout(arguments: &[&str], code: i32) -> String {
    let output = run(arguments);
    assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn smoke(set: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vectors/smoke").join(set).to_str().unwrap().to_owned()
}

#[test]
fn a_report_has_stages_tables_and_what_is_unseen() {
    let set = smoke("random_peak_narrow.json");
    let text = stdout(&["report", &set, "--unseen"], 0);
    for part in
        ["peak, narrow: 256 vectors of random_peak", "│ frame", "rom_exp2", "decisions", "unseen (masked) core/src/"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    let json: Value = serde_json::from_str(&stdout(&["report", &set, "--json"], 0)).unwrap();
    let grade = &json["grades"][0];
    let unseen = grade["unseen"].as_array().unwrap().len();
    let line = text.lines().find(|line| line.starts_with("faults ")).unwrap();
    let numbers: Vec<usize> = line.split(|c: char| !c.is_ascii_digit()).filter_map(|n| n.parse().ok()).collect();
    assert_eq!(numbers[1] - numbers[0], unseen, "{line}");
    assert_eq!(text.lines().filter(|line| line.starts_with("unseen")).count(), unseen);
    let field = &grade["fields"][0];
    assert!(field["proven"][0].as_i64() <= field["seen"][0].as_i64());
}

#[test]
fn sets_of_a_stage_have_a_report_of_their_own() {
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path().to_str().unwrap();
    for stage in ["reflect", "frame"] {
        let export = ["export", "random", "--count", "60", "--profile", "narrow", "--stage", stage, "-o", directory];
        stdout(&export, 0);
    }
    let json: Value = serde_json::from_str(&stdout(&["report", directory, "--json"], 0)).unwrap();
    let grades = json["grades"].as_array().unwrap();
    assert_eq!(grades.len(), 2);
    for (grade, stage) in grades.iter().zip(["frame", "reflect"]) {
        assert_eq!(grade["stage"], stage);
        let of_stage = grade["stages"].as_array().unwrap().iter().find(|of| of["stage"] == stage).unwrap();
        let [all, found] = ["all", "found"].map(|of| of_stage["slips"][of].as_u64().unwrap());
        // Of a stage alone nothing is hidden behind later ones.
        assert!(all > 100 && 10 * found > 7 * all, "{stage}: {found} of {all}");
    }
    assert!(
        stdout(&["report", directory], 0).contains("stage reflect of reflection, narrow: 60 vectors of random_reflect")
    );
}

#[test]
fn sets_without_change_raise_an_alarm() {
    // One vector: no field changes.
    let directory = tempfile::tempdir().unwrap();
    let directory = directory.path().to_str().unwrap();
    stdout(&["export", "random_peak", "--count", "1", "--profile", "narrow", "-o", directory], 0);
    assert!(stdout(&["report", directory], 0).contains("fields are the same in every vector: frame_0_x, frame_0_y"));
}

#[test]
fn a_distilled_set_verifies_and_says_where_its_vectors_are_from() {
    let directory = tempfile::tempdir().unwrap();
    let path = |file: &str| directory.path().join(file).to_str().unwrap().to_owned();
    let (few, picks, set) = (path("few"), path("picks.txt"), smoke("random_peak_narrow.json"));
    stdout(&["distil", &set, "-o", &few, "--name", "few", "--most", "9", "--picks", &picks], 0);
    assert!(stdout(&["verify", &few], 0).contains("ok       few (narrow): 9 vectors"));
    let picks = fs::read_to_string(picks).unwrap();
    let lines: Vec<_> = picks.lines().map(|line| line.split_once(' ').unwrap()).collect();
    assert_eq!(lines.len(), 9);
    let many = fs::read_to_string(smoke("random_peak_narrow.hex")).unwrap();
    let few = fs::read_to_string(path("few/few_narrow.hex")).unwrap();
    for ((set, index), word) in lines.into_iter().zip(few.lines().skip(1)) {
        assert_eq!((set, many.lines().nth(1 + index.parse::<usize>().unwrap())), ("random_peak", Some(word)));
    }
}

#[test]
fn vectors_of_another_seed_are_named_by_it_and_beside_all_of_them_nothing_is_picked_or_written() {
    let directory = tempfile::tempdir().unwrap();
    let path = |file: &str| directory.path().join(file).to_str().unwrap().to_owned();
    let (many, few, none, picks) = (path("many"), path("few"), path("none"), path("picks.txt"));
    stdout(&["export", "random_peak", "--count", "50", "--seed", "7", "--profile", "narrow", "-o", &many], 0);
    stdout(&["distil", &many, "-o", &few, "--name", "few", "--most", "3", "--picks", &picks], 0);
    let picks = fs::read_to_string(picks).unwrap();
    assert!(picks.lines().count() == 3 && picks.lines().all(|line| line.starts_with("random_peak+7 ")), "{picks}");
    let text = stdout(&["distil", &few, "-o", &none, "--beside", &many], 0);
    assert_eq!(text.trim(), "no vector shows what the others do not: nothing written");
    assert!(!Path::new(&none).exists() || fs::read_dir(&none).unwrap().next().is_none());
}

#[test]
fn what_cannot_be_graded_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let output = directory.path().join("few").to_str().unwrap().to_owned();
    let missing = run(&["report", &smoke("no_such_set.json")]);
    assert_eq!(missing.status.code(), Some(1));
    let two = run(&["distil", &smoke("random_narrow.json"), &smoke("random_compact.json"), "-o", &output]);
    assert_eq!(two.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&two.stderr).contains("distil sets of one kind at a time"));
    assert!(!Path::new(&output).exists());
}
