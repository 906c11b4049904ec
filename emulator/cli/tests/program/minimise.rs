//! `vectors minimise` as its users see it, with a simulator that says what the test wants.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

/// What a command says, in a directory whose folder `tools` comes first on the path.
fn roughxel(directory: &Path, line: &str) -> (Option<i32>, String, String) {
    let path = format!("{}:{}", directory.join("tools").display(), std::env::var("PATH").unwrap());
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughxel"));
    let output: Output =
        command.current_dir(directory).args(line.split_whitespace()).env("PATH", path).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// A program of that name in `tools`.
fn tool(directory: &Path, name: &str, script: &str) {
    let path = directory.join("tools").join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn minimise_ends_with_the_documented_codes_and_prints_what_became_simpler() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    for line in [
        "vectors export random random_peak --count 8 --profile narrow -o sets",
        "vectors bench sets/random_narrow.json --device blank -o benches",
    ] {
        assert_eq!(roughxel(at, line).0, Some(0));
    }
    let minimise = "vectors minimise sets/random_narrow#5 --bench benches/random_narrow -o result";
    // As often as it compiles.
    tool(at, "iverilog", &format!("echo x >>{}", at.join("compiled").display()));
    tool(at, "vvp", "echo PASS random_narrow: 64 vectors");
    let (code, _, message) = roughxel(at, minimise);
    assert!(code == Some(3) && message.contains("gets vector #5 of sets/random_narrow right"), "{message}");
    assert!(!at.join("result").exists());

    // Everything goes wrong, so nothing is left of the inputs.
    tool(
        at,
        "vvp",
        "i=0\nwhile [ $i -lt 64 ]; do\n\
         echo \"random_narrow #$i: stage perturb, field normal_mod_x: expected 0 = 0, got 1 = 1\"\n\
         echo \"random_narrow #$i: stage reflect, field reflected_x: expected 0 = 0, got xx\"\n\
         i=$((i + 1))\ndone\necho FAIL random_narrow: 64 of 64 vectors differ",
    );
    fs::remove_file(at.join("compiled")).unwrap();
    let (code, text, message) = roughxel(at, minimise);
    assert_eq!(code, Some(0), "{message}");
    assert!(text.contains("result/random_min_narrow.json: stage perturb goes wrong; "), "{text}");
    assert!(text.contains(
        "wrong: random_min #0: stage perturb, field normal_mod_x, bit 0: got 1, expected 0; 1 fields differ"
    ));
    assert_eq!(fs::read_to_string(at.join("compiled")).unwrap(), "x\n", "it is compiled once");
    let (code, text, _) = roughxel(at, "vectors verify result");
    assert_eq!((code, text.as_str()), (Some(0), "ok       random_min (narrow): 1 vectors\n"));
    let (_, text, _) = roughxel(at, &format!("{minimise} --json --runs 1"));
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((summary["runs"].as_u64(), summary["minimal"].as_bool()), (Some(1), Some(false)));
    let inputs = |text: &str| {
        let summary: serde_json::Value = serde_json::from_str(text).unwrap();
        let fields = summary["explanation"]["fields"].as_array().unwrap().clone();
        fields.into_iter().filter(|field| field["stage"] == "input" && field["integer"] != 0).count()
    };
    assert!(inputs(&text) > 10);
    assert_eq!(inputs(&roughxel(at, &format!("{minimise} --json")).1), 0);

    // Usage, and what cannot be done.
    for (line, code, problem) in [
        ("vectors minimise sets/random_narrow --bench benches/random_narrow -o x", 2, "names no vector"),
        ("vectors minimise sets/random_narrow#8 --bench benches/random_narrow -o x", 2, "no vector #8"),
        ("vectors minimise sets/random_narrow#1 --bench benches/random_narrow -o x --tool modelsim", 2, "modelsim"),
        (
            "vectors minimise sets/random_peak_narrow#1 --bench benches/random_narrow -o x",
            2,
            "the bench is of random_narrow",
        ),
        ("vectors minimise sets/random_narrow#1 --bench benches -o x", 1, "benches/set.json"),
        ("vectors minimise sets/none#1 --bench benches/random_narrow -o x", 1, "sets/none.json"),
    ] {
        let (found, _, message) = roughxel(at, line);
        assert!(found == Some(code) && message.contains(problem), "{line}: {message}");
    }
    tool(at, "vvp", "echo ERROR only 3 of 64 outputs came; exit 1");
    let (code, _, message) = roughxel(at, minimise);
    assert!(code == Some(1) && message.contains("ERROR only 3 of 64 outputs came"), "{message}");
    tool(at, "iverilog", "echo no such module >&2; exit 1");
    let (code, _, message) = roughxel(at, minimise);
    assert!(code == Some(1) && message.contains("no such module") && message.contains("does not compile"), "{message}");
    assert!(!at.join("x").exists());
}
