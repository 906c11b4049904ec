//! `vectors shrink` as its users see it, with a simulator whose output the test chooses.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;

use super::fixture::{Folder, Run};

/// Runs a command in a directory whose folder `tools` comes first in PATH.
fn run(at: &Folder, line: &str) -> Run {
    let path = format!("{}:{}", at.file("tools"), std::env::var("PATH").unwrap());
    Run::output(at.program(line).env("PATH", path))
}

/// Writes a program with a name in `tools`.
fn tool(at: &Folder, name: &str, script: &str) {
    let path = at.join("tools").join(name);
    fs::create_dir_all(at.join("tools")).unwrap();
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn shrink_ends_with_the_documented_codes_and_prints_what_became_simpler() {
    let at = &Folder::new();
    at.done("vectors export random random_peak --count 8 --profile narrow -o sets");
    at.done("vectors bench sets/random_narrow.json --device blank -o benches");
    let shrink = "vectors shrink sets/random_narrow#5 --bench benches/random_narrow -o result";
    // Each compilation adds a line to `compiled`. The device is right.
    tool(at, "iverilog", &format!("echo x >>{}", at.file("compiled")));
    tool(at, "vvp", "echo PASS random_narrow: 64 vectors");
    run(at, shrink).ends(3).complains(&["gets vector #5 of sets/random_narrow right"]);
    assert!(!at.join("result").exists());

    // Every input goes wrong, so the inputs shrink to nothing.
    tool(
        at,
        "vvp",
        "i=0\nwhile [ $i -lt 64 ]; do\n\
         echo \"random_narrow #$i: stage perturb, field normal_mod_x: expected 0 = 0, got 1 = 1\"\n\
         echo \"random_narrow #$i: stage reflect, field reflected_x: expected 0 = 0, got xx\"\n\
         i=$((i + 1))\ndone\necho FAIL random_narrow: 64 of 64 vectors differ",
    );
    fs::remove_file(at.join("compiled")).unwrap();
    run(at, shrink).ends(0).prints(&[
        "result/random_min_narrow.json: stage perturb goes wrong; ",
        "wrong: random_min #0: stage perturb, field normal_mod_x, bit 0: got 1, expected 0; 1 fields differ",
    ]);
    assert_eq!(at.read("compiled"), "x\n", "it is compiled once");
    assert_eq!(at.done("vectors verify result").out, "ok       random_min (narrow): 1 vectors\n");
    let summary = run(at, &format!("{shrink} --json --runs 1")).json();
    assert_eq!((summary["runs"].as_u64(), summary["minimal"].as_bool()), (Some(1), Some(false)));
    let inputs = |summary: serde_json::Value| {
        let fields = summary["explanation"]["fields"].as_array().unwrap().clone();
        fields.into_iter().filter(|field| field["stage"] == "input" && field["integer"] != 0).count()
    };
    assert!(inputs(summary) > 10);
    assert_eq!(inputs(run(at, &format!("{shrink} --json")).json()), 0);

    // Errors of usage, and impossible requests.
    at.refuses(&[
        ("vectors shrink sets/random_narrow --bench benches/random_narrow -o x", 2, "names no vector"),
        ("vectors shrink sets/random_narrow#8 --bench benches/random_narrow -o x", 2, "no vector #8"),
        ("vectors shrink sets/random_narrow#1 --bench benches/random_narrow -o x --tool modelsim", 2, "modelsim"),
        (
            "vectors shrink sets/random_peak_narrow#1 --bench benches/random_narrow -o x",
            2,
            "the testbench is of random_narrow",
        ),
        ("vectors shrink sets/random_narrow#1 --bench benches -o x", 1, "benches/set.json"),
        ("vectors shrink sets/none#1 --bench benches/random_narrow -o x", 1, "sets/none.json"),
    ]);
    tool(at, "vvp", "echo ERROR only 3 of 64 outputs came; exit 1");
    run(at, shrink).ends(1).complains(&["ERROR only 3 of 64 outputs came"]);
    tool(at, "iverilog", "echo no such module >&2; exit 1");
    run(at, shrink).ends(1).complains(&["no such module", "does not compile"]);
    assert!(!at.join("x").exists());
}
