//! `vectors coverage` and `vectors condense`.

use std::path::Path;

use super::fixture::{Folder, repository, roughxel, words};

fn smoke(set: &str) -> String {
    repository().join("vectors/smoke").join(set).to_str().unwrap().to_owned()
}

#[test]
fn a_report_has_stages_tables_and_what_is_unseen() {
    let set = smoke("random_peak_narrow.json");
    let parts =
        ["peak, narrow: 256 vectors of random_peak", "│ frame", "rom_exp2", "decisions", "unseen (masked) core/src/"];
    let text = roughxel(&["vectors", "coverage", &set, "--unseen"]).ends(0).prints(&parts).out;
    let json = roughxel(&["vectors", "coverage", &set, "--json"]).json();
    let report = &json["grades"][0];
    let unseen = report["unseen"].as_array().unwrap().len();
    let line = text.lines().find(|line| line.starts_with("faults ")).unwrap();
    let numbers: Vec<usize> = line.split(|c: char| !c.is_ascii_digit()).filter_map(|n| n.parse().ok()).collect();
    assert_eq!(numbers[1] - numbers[0], unseen, "{line}");
    assert_eq!(text.lines().filter(|line| line.starts_with("unseen")).count(), unseen);
    let field = &report["fields"][0];
    assert!(field["proven"][0].as_i64() <= field["seen"][0].as_i64());
}

#[test]
fn sets_of_a_stage_have_a_report_of_their_own() {
    let directory = Folder::new();
    for stage in ["reflect", "frame"] {
        directory.done(&format!("vectors export random --count 60 --profile narrow --stage {stage} -o ."));
    }
    let json = directory.run("vectors coverage . --json").json();
    let reports = json["grades"].as_array().unwrap();
    assert_eq!(reports.len(), 2);
    for (report, stage) in reports.iter().zip(["frame", "reflect"]) {
        assert_eq!(report["stage"], stage);
        let of_stage = report["stages"].as_array().unwrap().iter().find(|of| of["stage"] == stage).unwrap();
        let [all, found] = ["all", "found"].map(|of| of_stage["slips"][of].as_u64().unwrap());
        // In a stage alone, no later stage hides a fault.
        assert!(all > 100 && 10 * found > 7 * all, "{stage}: {found} of {all}");
    }
    let name = "stage reflect of reflection, narrow: 60 vectors of random_reflect";
    directory.done("vectors coverage .").prints(&[name]);
}

#[test]
fn sets_without_change_raise_an_alarm() {
    // With one vector, no field changes.
    let directory = Folder::new();
    directory.done("vectors export random_peak --count 1 --profile narrow -o .");
    directory.done("vectors coverage .").prints(&["fields are the same in every vector: frame_0_x, frame_0_y"]);
}

#[test]
fn a_condensed_set_verifies_and_says_where_its_vectors_are_from() {
    let directory = Folder::new();
    let (few, picks, set) = (directory.file("few"), directory.file("picks.txt"), smoke("random_peak_narrow.json"));
    let options = ["--name", "few", "--most", "9", "--picks", &picks];
    roughxel(&[&["vectors", "condense", &set, "-o", &few], &options[..]].concat()).ends(0);
    directory.done("vectors verify few").prints(&["ok       few (narrow): 9 vectors"]);
    let picks = directory.read("picks.txt");
    let lines: Vec<_> = picks.lines().map(|line| line.split_once(' ').unwrap()).collect();
    assert_eq!(lines.len(), 9);
    let many = words(Path::new(&smoke("random_peak_narrow.hex")));
    for ((set, index), word) in lines.into_iter().zip(words(&directory.join("few/few_narrow.hex"))) {
        assert_eq!((set, &many[index.parse::<usize>().unwrap()]), ("random_peak", &word));
    }
}

#[test]
fn vectors_of_another_seed_are_named_by_it_and_beside_all_of_them_nothing_is_picked_or_written() {
    let directory = Folder::new();
    directory.done("vectors export random_peak --count 50 --seed 7 --profile narrow -o many");
    directory.done("vectors condense many -o few --name few --most 3 --picks picks.txt");
    let picks = directory.read("picks.txt");
    assert!(picks.lines().count() == 3 && picks.lines().all(|line| line.starts_with("random_peak+7 ")), "{picks}");
    let text = directory.done("vectors condense few -o none --beside many").out;
    assert_eq!(text.trim(), "no vector shows what the others do not: nothing written");
    let none = directory.join("none");
    assert!(!none.exists() || none.read_dir().unwrap().next().is_none());
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let directory = Folder::new();
    roughxel(&["vectors", "coverage", &smoke("no_such_set.json")]).ends(1);
    let [one, other] = ["random_narrow.json", "random_compact.json"].map(smoke);
    let two = roughxel(&["vectors", "condense", &one, &other, "-o", &directory.file("few")]);
    two.ends(1).complains(&["condense sets of one kind at a time"]);
    assert!(!directory.join("few").exists());
}
