//! Exports in parts and exports that were killed: what comes out is what an undisturbed export of the whole writes, to the byte.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Instant;

use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_vectors::{Form, SetExport, SetInfo, Shard, Words, random_set, verify};

/// What a command says, in a directory.
fn roughxel(directory: &Path, line: &str) -> Output {
    program(directory, line).output().unwrap()
}

fn program(directory: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughxel"));
    command.current_dir(directory).args(line.split_whitespace());
    command
}

/// The same; it has to end well.
fn done(directory: &Path, line: &str) -> Output {
    let output = roughxel(directory, line);
    assert_eq!(output.status.code(), Some(0), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

/// What a command that fails says.
fn refused(directory: &Path, line: &str, code: i32) -> String {
    let output = roughxel(directory, line);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{line}: {message}");
    message
}

/// The files of a directory with what is in them.
fn files(directory: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap());
    entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())).collect()
}

#[test]
fn merged_parts_are_the_whole_export_to_the_byte() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    for (number, options) in ["", "--bin", "--no-taps --profile compact", "--bin --no-taps --seed 3"].iter().enumerate()
    {
        // `frame_zero` has fewer vectors than the largest number of parts.
        let export = format!("vectors export random random_highlight frame_zero --count 101 {options}");
        done(at, &format!("{export} -o whole{number}"));
        let whole = files(&at.join(format!("whole{number}")));
        assert_eq!(whole.len(), 6);
        for &of in if number == 1 { &[1, 2, 7, 64][..] } else { &[7] } {
            let parts = format!("parts{number}_{of}");
            // The last one first.
            for part in (1..=of).rev() {
                done(at, &format!("{export} -o {parts} --shard {part}/{of}"));
            }
            done(at, &format!("vectors merge {parts} -o merged{number}_{of}"));
            // No assert_eq: it would print the files.
            assert!(files(&at.join(format!("merged{number}_{of}"))) == whole, "{options} {of}");
            // Beside its parts it is the same, and parts beside a whole set are still found.
            done(at, &format!("vectors merge {parts} -o {parts}"));
            done(at, &format!("vectors merge {parts} -o {parts}"));
            assert!(whole.iter().all(|(name, bytes)| fs::read(at.join(&parts).join(name)).unwrap() == *bytes));
        }
        done(at, &format!("vectors verify parts{number}_7 merged{number}_7"));
    }
}

#[test]
fn parts_of_a_stage_are_merged_and_kept_as_those_of_a_datapath() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    // Two runs of a module, and a module with one.
    let export = "vectors export random frame_zero --count 31 --stage columns --profile narrow";
    done(at, &format!("{export} -o whole"));
    let whole = files(&at.join("whole"));
    assert!(whole.contains_key("random_columns_pixel_narrow.hex") && whole.len() >= 6, "{:?}", whole.keys());
    for part in [3, 1, 2] {
        done(at, &format!("{export} --shard {part}/3 -o parts"));
    }
    done(at, "vectors merge parts -o merged");
    assert!(files(&at.join("merged")) == whole);
    done(at, "vectors verify parts merged");

    let set = at.join("whole/random_columns_pixel_narrow.json");
    fs::remove_file(&set).unwrap();
    let kept = done(at, &format!("{export} --resume -o whole"));
    let sets = whole.len() / 2;
    let note = format!("note: {} of {sets} sets were there, whole and the same, and are kept", sets - 1);
    assert!(String::from_utf8_lossy(&kept.stderr).contains(&note), "{}", String::from_utf8_lossy(&kept.stderr));
    assert!(files(&at.join("whole")) == whole);
    // A grade is no other set, and no part has one.
    done(
        at,
        "vectors report whole/random_columns_pixel_narrow.json parts/random_columns_pixel_narrow.2of3.json --write",
    );
    let kept = done(at, &format!("{export} --resume -o whole"));
    let note = format!("note: {sets} of {sets} sets were there");
    assert!(String::from_utf8_lossy(&kept.stderr).contains(&note), "{}", String::from_utf8_lossy(&kept.stderr));
    assert!(fs::read_to_string(&set).unwrap().contains("\"grade\""));
    done(at, "vectors merge parts -o merged");
    assert!(files(&at.join("merged")) == whole);
}

#[test]
fn an_export_is_the_same_with_any_number_of_threads() {
    let directory = tempfile::tempdir().unwrap();
    // More than a batch.
    let export = "vectors export random random_peak --count 20000";
    done(directory.path(), &format!("{export} -o whole"));
    let whole = files(&directory.path().join("whole"));
    for threads in ["1", "2", "5"] {
        let with_threads = |line: &str| {
            program(directory.path(), line).env("RAYON_NUM_THREADS", threads).stdout(Stdio::null()).status().unwrap()
        };
        assert!(with_threads(&format!("{export} -o whole{threads}")).success());
        assert!(with_threads(&format!("{export} --shard 1/2 -o parts{threads}")).success());
        assert!(with_threads(&format!("{export} --shard 2/2 -o parts{threads}")).success());
        assert!(with_threads(&format!("vectors merge parts{threads} -o merged{threads}")).success());
        for name in ["whole", "merged"] {
            assert!(files(&directory.path().join(format!("{name}{threads}"))) == whole, "{name}, {threads} threads");
        }
    }
}

#[test]
fn a_part_verifies_and_is_explained_with_the_indices_of_the_whole_set() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    done(at, "vectors export random --count 100 -o whole");
    done(at, "vectors export random --count 100 -o parts --shard 2/3");
    let verified = done(at, "vectors verify parts");
    assert_eq!(String::from_utf8_lossy(&verified.stdout), "ok       random (standard, part 2 of 3): 33 vectors\n");
    let of_part = String::from_utf8(done(at, "vectors explain parts/random_standard.2of3#40").stdout).unwrap();
    let of_whole = String::from_utf8(done(at, "vectors explain whole/random_standard#40").stdout).unwrap();
    assert_eq!(of_part.replace("(line 9)", "(line 42)"), of_whole);
    let message = refused(at, "vectors explain parts/random_standard.2of3.hex --index 20", 2);
    assert!(message.contains("no vector #20; this part of it has 33, #33 to #65"), "{message}");

    let path = at.join("parts/random_standard.2of3.hex");
    let text = fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let mut swapped = lines.clone();
    swapped.swap(8, 9);
    fs::write(&path, swapped.join("\n") + "\n").unwrap();
    let found = verify(&path.with_extension("json"), &|_| {}).unwrap();
    let sentences: Vec<String> = found.misplaced.iter().map(ToString::to_string).collect();
    assert_eq!(sentences, ["words #40 and #41 are in each other's place (lines 9 and 10)"]);
    let message = refused(at, "vectors bench parts -o bench", 1);
    assert!(message.contains("part 2 of 3") && message.contains("vectors merge"), "{message}");
}

#[test]
fn parts_that_do_not_belong_together_are_refused_by_name() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let export =
        |options: &str, to: &str| drop(done(at, &format!("vectors export random --count 90 {options} -o {to}")));
    for part in 1..=3 {
        export(&format!("--shard {part}/3"), "parts");
    }
    // A part that is missing, that is there twice, that is named twice.
    let of_two = "parts/random_standard.1of3.json parts/random_standard.3of3.hex";
    let message = refused(at, &format!("vectors merge {of_two} -o merged"), 1);
    assert!(
        message.contains("set random_standard: part 2 of 3 is missing") && message.contains("--shard 2/3"),
        "{message}"
    );
    export("--shard 2/3", "again");
    let message = refused(at, "vectors merge parts again -o merged", 1);
    assert!(message.contains("part 2 of 3 is there twice: again/random_standard.2of3.json and parts/"), "{message}");
    done(at, "vectors merge parts parts/random_standard.2of3.json -o merged");
    fs::remove_dir_all(at.join("merged")).unwrap();

    // One of another export.
    for (options, key) in [
        ("--shard 2/3 --seed 1", "seed"),
        ("--shard 2/4", "part.of"),
        ("--shard 2/3 --count 91", "part.whole_count"),
        ("--shard 2/3 --bin", "files"),
        ("--shard 2/3 --no-taps", "taps"),
        ("--shard 2/3 --effects bump", "effects"),
    ] {
        fs::remove_dir_all(at.join("again")).unwrap();
        let count = if options.contains("--count") { "" } else { "--count 90" };
        done(at, &format!("vectors export random {count} {options} -o again"));
        let message = refused(at, &format!("vectors merge {of_two} again -o merged"), 1);
        assert!(message.contains(&format!("`{key}` is not that of")), "{options}: {message}");
    }
    let json = at.join("parts/random_standard.2of3.json");
    let text = fs::read_to_string(&json).unwrap();
    for (from, to, problem) in [
        ("\"generator\": \"roughxel ", "\"generator\": \"roughxel 9", "`generator` is not that of"),
        ("\"first\": 30", "\"first\": 29", "part 2 of 3 has the vectors #30 to #59 of 90, not 30 from #29"),
        ("\"number\": 2", "\"number\": 4", "there is no part 4 of 3"),
        ("\"whole_count\": 90", "\"whole_count\": 99999999", "part.whole_count 99999999 is not in 1 to"),
        ("\"count\": 30", "\"count\": 31", "not 31 from #30"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text);
        fs::write(&json, changed).unwrap();
        let message = refused(at, "vectors merge parts -o merged", 1);
        assert!(message.contains(problem) && message.contains("random_standard.2of3.json"), "{message}");
    }
    fs::write(&json, text).unwrap();

    // Words that are not those of their manifest: another result, a word too few, no word at all.
    let hex = at.join("parts/random_standard.2of3.hex");
    let words = fs::read_to_string(&hex).unwrap();
    let without: String =
        words.split_inclusive('\n').enumerate().filter(|(at, _)| *at != 9).map(|(_, line)| line).collect();
    let mut swapped: Vec<&str> = words.split_inclusive('\n').collect();
    swapped.swap(3, 7);
    for (changed, problem) in [
        (swapped.concat(), "words #32 and #36 are in each other's place (lines 4 and 8); part 2 of 3 was changed"),
        (words.replacen("_0", "_1", 1), "random_standard.2of3.json: the SHA-256 of its words"),
        (without, "29 vectors, but the manifest says 30; the file is cut short or was added to; word #38 is missing"),
        (words.replacen("_0", "_x", 1), "random_standard.2of3.hex:2: column"),
    ] {
        fs::write(&hex, changed).unwrap();
        let message = refused(at, "vectors merge parts -o merged", 1);
        assert!(message.contains(problem), "{message}");
    }
    let message = refused(at, "vectors merge . -o merged", 1);
    assert!(message.contains("no vector set here"), "{message}");
    done(at, "vectors export random --count 3 -o whole");
    let message = refused(at, "vectors merge whole -o merged", 1);
    assert!(message.contains("whole: no part of a set here"), "{message}");
    // Nothing half-written.
    assert!(!at.join("merged").exists() || files(&at.join("merged")).is_empty());
    for shard in ["0/3", "4/3", "1/0", "1", "+1/3", "1/9999999999", "-1/3"] {
        refused(at, &format!("vectors export random --shard={shard} -o none"), 2);
    }
}

#[test]
fn an_export_that_goes_on_keeps_what_is_whole_and_the_same() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let kept = |options: &str| -> Vec<bool> {
        let output = done(at, &format!("vectors export random random_peak {options} -o sets --resume --json"));
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        summary["sets"].as_array().unwrap().iter().map(|set| set["kept"].as_bool().unwrap()).collect()
    };
    assert_eq!(kept("--count 40"), [false, false]);
    let whole = files(&at.join("sets"));
    assert_eq!(kept("--count 40"), [true, true]);
    let hex = at.join("sets/random_standard.hex");
    let json = at.join("sets/random_standard.json");
    let [words, manifest] = [&hex, &json].map(|path| fs::read_to_string(path).unwrap());
    for (words, manifest) in [
        (words.replacen("_0", "_1", 1), manifest.clone()),
        (words[..words.len() / 2].into(), manifest.clone()),
        (words.clone(), manifest.replacen("roughxel 0", "roughxel 9", 1)),
        (words.clone(), manifest[..manifest.len() / 2].into()),
        (words.clone(), manifest.replacen("\"name\": \"random\"", "\"name\": \"random+1\"", 1)),
    ] {
        fs::write(&hex, words).unwrap();
        fs::write(&json, manifest).unwrap();
        assert_eq!(kept("--count 40"), [false, true]);
        assert!(files(&at.join("sets")) == whole);
    }
    fs::remove_file(&json).unwrap();
    assert_eq!(kept("--count 40"), [false, true]);
    assert!(files(&at.join("sets")) == whole);
    for options in
        ["--count 41", "--count 40 --seed 2", "--count 40 --no-taps", "--count 40 --effects bump", "--count 40 --bin"]
    {
        assert_eq!(kept(options), [false, false], "{options}");
    }
    assert_eq!(kept("--count 40 --shard 1/2"), [false, false]);
    assert_eq!(kept("--count 40 --shard 1/2"), [true, true]);
    assert_eq!(kept("--count 40 --shard 2/2"), [false, false]);
    assert_eq!(kept("--count 40 --bin"), [true, true]);
}

#[test]
fn an_export_that_is_killed_leaves_nothing_wrong_and_can_be_run_again() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    let export = "vectors export random random_highlight random_peak";
    let start = Instant::now();
    done(at, &format!("{export} --count 12000 -o whole"));
    let took = start.elapsed();
    let whole = files(&at.join("whole"));
    let mut killed = 0;
    for turn in 0..6_u32 {
        // Every other time there are older sets.
        if turn % 2 == 0 {
            let _ = fs::remove_dir_all(at.join("sets"));
        } else {
            done(at, &format!("{export} --count 50 -o sets"));
        }
        let mut child = program(at, &format!("{export} --count 12000 -o sets")).stdout(Stdio::null()).spawn().unwrap();
        sleep(took * (2 * turn + 1) / 12);
        child.kill().unwrap();
        killed += u32::from(!child.wait().unwrap().success());

        // What has a manifest is whole, and stands beside the words of its manifest.
        let sets = if at.join("sets").exists() { files(&at.join("sets")) } else { BTreeMap::new() };
        for name in sets.keys().filter(|name| name.ends_with(".json")) {
            let found = verify(&at.join("sets").join(name), &|_| {}).unwrap();
            assert!(found.passed(), "{name}: {found:?}");
        }
        done(at, &format!("{export} --count 12000 -o sets --resume"));
        assert!(files(&at.join("sets")) == whole, "turn {turn}: {:?}", files(&at.join("sets")).keys());
    }
    assert!(killed > 0, "every export was done before it could be killed");
}

#[test]
fn parts_of_every_datapath_and_profile_have_the_words_of_the_whole() {
    let directory = tempfile::tempdir().unwrap();
    for (datapath, precision, profile) in [
        (Datapath::Reflection, Precision::NARROW, "narrow"),
        (Datapath::Highlight, Precision::STANDARD, "standard"),
        (Datapath::Peak, Precision::COMPACT, "compact"),
    ] {
        let words = Words { taps: true, form: Form::Bin };
        let (name, description, effects) = ("random", "test", Effects::ALL);
        let info = SetInfo { name, description, seed: Some("test"), datapath, effects, precision, profile, words };
        let input = |index| random_set(datapath, "test", index, &precision);
        let whole = SetExport::new(&info, 20).write(&input, directory.path(), &|_| {}).unwrap();
        let mut joined = Vec::new();
        for number in 1..=3 {
            let part = SetExport::new(&info, 20).of_shard(Shard::new(number, 3).unwrap()).unwrap();
            let manifest = part.write(&input, directory.path(), &|_| {}).unwrap();
            joined.extend(fs::read(directory.path().join(&manifest.files[0].name)).unwrap());
        }
        assert!(joined == fs::read(directory.path().join(&whole.files[0].name)).unwrap());
    }
}
