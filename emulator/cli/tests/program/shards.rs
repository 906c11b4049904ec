//! Exports in parts and killed exports: the result equals that of an undisturbed whole export, to the byte.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Instant;

use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_vectors::{Form, SetExport, SetInfo, Shard, Words, random_set, verify};

use super::fixture::{Folder, Run};

/// Reads the files of a directory.
fn files(directory: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap());
    entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())).collect()
}

#[test]
fn merged_parts_are_the_whole_export_to_the_byte() {
    let at = Folder::new();
    for (number, options) in ["", "--bin", "--no-taps --profile compact", "--bin --no-taps --seed 3"].iter().enumerate()
    {
        // `frame_zero` has fewer vectors than the largest number of parts.
        let export = format!("vectors export random random_highlight frame_zero --count 101 {options}");
        at.done(&format!("{export} -o whole{number}"));
        let whole = files(&at.join(&format!("whole{number}")));
        assert_eq!(whole.len(), 6);
        for &of in if number == 1 { &[1, 2, 7, 64][..] } else { &[7] } {
            let parts = format!("parts{number}_{of}");
            // The last part comes first.
            for part in (1..=of).rev() {
                at.done(&format!("{export} -o {parts} --shard {part}/{of}"));
            }
            at.done(&format!("vectors merge {parts} -o merged{number}_{of}"));
            // `assert_eq` would print the files.
            assert!(files(&at.join(&format!("merged{number}_{of}"))) == whole, "{options} {of}");
            // Next to its parts, the whole set is the same. Parts next to a whole set are found.
            at.done(&format!("vectors merge {parts} -o {parts}"));
            at.done(&format!("vectors merge {parts} -o {parts}"));
            assert!(whole.iter().all(|(name, bytes)| fs::read(at.join(&parts).join(name)).unwrap() == *bytes));
        }
        at.done(&format!("vectors verify parts{number}_7 merged{number}_7"));
    }
}

#[test]
fn parts_of_a_stage_are_merged_and_kept_as_those_of_a_datapath() {
    let at = Folder::new();
    // One module runs twice, the other once.
    let export = "vectors export random frame_zero --count 31 --stage columns --profile narrow";
    at.done(&format!("{export} -o whole"));
    let whole = files(&at.join("whole"));
    assert!(whole.contains_key("random_columns_pixel_narrow.hex") && whole.len() >= 6, "{:?}", whole.keys());
    for part in [3, 1, 2] {
        at.done(&format!("{export} --shard {part}/3 -o parts"));
    }
    at.done("vectors merge parts -o merged");
    assert!(files(&at.join("merged")) == whole);
    at.done("vectors verify parts merged");

    fs::remove_file(at.join("whole/random_columns_pixel_narrow.json")).unwrap();
    let sets = whole.len() / 2;
    let note = format!("note: {} of {sets} sets were there, whole and the same, and are kept", sets - 1);
    at.done(&format!("{export} --resume -o whole")).complains(&[&note]);
    assert!(files(&at.join("whole")) == whole);
    // Coverage in the manifest does not make a different set, and parts have none.
    at.done(
        "vectors coverage whole/random_columns_pixel_narrow.json parts/random_columns_pixel_narrow.2of3.json --write",
    );
    let note = format!("note: {sets} of {sets} sets were there");
    at.done(&format!("{export} --resume -o whole")).complains(&[&note]);
    assert!(at.read("whole/random_columns_pixel_narrow.json").contains("\"grade\""));
    at.done("vectors merge parts -o merged");
    assert!(files(&at.join("merged")) == whole);
}

#[test]
fn an_export_is_the_same_with_any_number_of_threads() {
    let at = Folder::new();
    // The count is more than a batch.
    let export = "vectors export random random_peak --count 20000";
    at.done(&format!("{export} -o whole"));
    let whole = files(&at.join("whole"));
    for threads in ["1", "2", "5"] {
        for line in [
            format!("{export} -o whole{threads}"),
            format!("{export} --shard 1/2 -o parts{threads}"),
            format!("{export} --shard 2/2 -o parts{threads}"),
            format!("vectors merge parts{threads} -o merged{threads}"),
        ] {
            Run::output(at.program(&line).env("RAYON_NUM_THREADS", threads)).ends(0);
        }
        for name in ["whole", "merged"] {
            assert!(files(&at.join(&format!("{name}{threads}"))) == whole, "{name}, {threads} threads");
        }
    }
}

#[test]
fn a_part_verifies_and_is_explained_with_the_indices_of_the_whole_set() {
    let at = Folder::new();
    at.done("vectors export random --count 100 -o whole");
    at.done("vectors export random --count 100 -o parts --shard 2/3");
    assert_eq!(at.done("vectors verify parts").out, "ok       random (standard, part 2 of 3): 33 vectors\n");
    let of_part = at.done("vectors explain parts/random_standard.2of3#40").out;
    let of_whole = at.done("vectors explain whole/random_standard#40").out;
    assert_eq!(of_part.replace("(line 9)", "(line 42)"), of_whole);
    at.run("vectors explain parts/random_standard.2of3.hex --index 20")
        .ends(2)
        .complains(&["no vector #20; this part of it has 33, #33 to #65"]);

    let text = at.read("parts/random_standard.2of3.hex");
    let mut swapped: Vec<&str> = text.lines().collect();
    swapped.swap(8, 9);
    at.write("parts/random_standard.2of3.hex", swapped.join("\n") + "\n");
    let found = verify(&at.join("parts/random_standard.2of3.json"), &|_| {}).unwrap();
    let sentences: Vec<String> = found.misplaced.iter().map(ToString::to_string).collect();
    assert_eq!(sentences, ["words #40 and #41 are in each other's place (lines 9 and 10)"]);
    at.run("vectors bench parts -o bench").ends(1).complains(&["part 2 of 3", "vectors merge"]);
}

#[test]
fn parts_that_do_not_belong_together_are_refused_by_name() {
    let at = Folder::new();
    let export =
        |options: &str, to: &str| drop(at.done(&format!("vectors export random --count 90 {options} -o {to}")));
    for part in 1..=3 {
        export(&format!("--shard {part}/3"), "parts");
    }
    // A part is missing, is present twice, or is named twice.
    let of_two = "parts/random_standard.1of3.json parts/random_standard.3of3.hex";
    at.run(&format!("vectors merge {of_two} -o merged"))
        .ends(1)
        .complains(&["set random_standard: part 2 of 3 is missing", "--shard 2/3"]);
    export("--shard 2/3", "again");
    at.run("vectors merge parts again -o merged")
        .ends(1)
        .complains(&["part 2 of 3 exists twice: again/random_standard.2of3.json and parts/"]);
    at.done("vectors merge parts parts/random_standard.2of3.json -o merged");
    fs::remove_dir_all(at.join("merged")).unwrap();

    // A part of a different export.
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
        at.done(&format!("vectors export random {count} {options} -o again"));
        at.run(&format!("vectors merge {of_two} again -o merged"))
            .ends(1)
            .complains(&[&format!("`{key}` is not that of")]);
    }
    let json = "parts/random_standard.2of3.json";
    let text = at.read(json);
    for (from, to, problem) in [
        ("\"generator\": \"roughxel ", "\"generator\": \"roughxel 9", "`generator` is not that of"),
        ("\"first\": 30", "\"first\": 29", "part 2 of 3 has the vectors #30 to #59 of 90, not 30 from #29"),
        ("\"number\": 2", "\"number\": 4", "there is no part 4 of 3"),
        ("\"whole_count\": 90", "\"whole_count\": 99999999", "part.whole_count 99999999 is not in 1 to"),
        ("\"count\": 30", "\"count\": 31", "not 31 from #30"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text);
        at.write(json, changed);
        at.run("vectors merge parts -o merged").ends(1).complains(&[problem, "random_standard.2of3.json"]);
    }
    at.write(json, text);

    // Words differ from their manifest: a different result, a word too few, no word at all.
    let hex = "parts/random_standard.2of3.hex";
    let words = at.read(hex);
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
        at.write(hex, changed);
        at.run("vectors merge parts -o merged").ends(1).complains(&[problem]);
    }
    at.run("vectors merge . -o merged").ends(1).complains(&["no vector set here"]);
    at.done("vectors export random --count 3 -o whole");
    at.run("vectors merge whole -o merged").ends(1).complains(&["whole: no part of a set here"]);
    // No half-written file stays.
    assert!(!at.join("merged").exists() || files(&at.join("merged")).is_empty());
    for shard in ["0/3", "4/3", "1/0", "1", "+1/3", "1/9999999999", "-1/3"] {
        at.run(&format!("vectors export random --shard={shard} -o none")).ends(2);
    }
}

#[test]
fn an_export_that_goes_on_keeps_what_is_whole_and_the_same() {
    let at = Folder::new();
    let kept = |options: &str| -> Vec<bool> {
        let summary = at.run(&format!("vectors export random random_peak {options} -o sets --resume --json")).json();
        summary["sets"].as_array().unwrap().iter().map(|set| set["kept"].as_bool().unwrap()).collect()
    };
    assert_eq!(kept("--count 40"), [false, false]);
    let whole = files(&at.join("sets"));
    assert_eq!(kept("--count 40"), [true, true]);
    let [hex, json] = ["sets/random_standard.hex", "sets/random_standard.json"];
    let [words, manifest] = [hex, json].map(|name| at.read(name));
    for (words, manifest) in [
        (words.replacen("_0", "_1", 1), manifest.clone()),
        (words[..words.len() / 2].into(), manifest.clone()),
        (words.clone(), manifest.replacen("roughxel 0", "roughxel 9", 1)),
        (words.clone(), manifest[..manifest.len() / 2].into()),
        (words.clone(), manifest.replacen("\"name\": \"random\"", "\"name\": \"random+1\"", 1)),
    ] {
        at.write(hex, words);
        at.write(json, manifest);
        assert_eq!(kept("--count 40"), [false, true]);
        assert!(files(&at.join("sets")) == whole);
    }
    fs::remove_file(at.join(json)).unwrap();
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
    let at = Folder::new();
    let export = "vectors export random random_highlight random_peak";
    let start = Instant::now();
    at.done(&format!("{export} --count 12000 -o whole"));
    let took = start.elapsed();
    let whole = files(&at.join("whole"));
    let mut killed = 0;
    for turn in 0..6_u32 {
        // Every second round has older sets.
        if turn % 2 == 0 {
            let _ = fs::remove_dir_all(at.join("sets"));
        } else {
            at.done(&format!("{export} --count 50 -o sets"));
        }
        let mut child = at.program(&format!("{export} --count 12000 -o sets")).stdout(Stdio::null()).spawn().unwrap();
        sleep(took * (2 * turn + 1) / 12);
        child.kill().unwrap();
        killed += u32::from(!child.wait().unwrap().success());

        // A set with a manifest is whole and has the words of its manifest.
        let sets = if at.join("sets").exists() { files(&at.join("sets")) } else { BTreeMap::new() };
        for name in sets.keys().filter(|name| name.ends_with(".json")) {
            let found = verify(&at.join("sets").join(name), &|_| {}).unwrap();
            assert!(found.passed(), "{name}: {found:?}");
        }
        at.done(&format!("{export} --count 12000 -o sets --resume"));
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
        let of_random = SetInfo::new("random", datapath, Effects::ALL, profile, precision);
        let info = SetInfo { seed: Some("test"), words, ..of_random };
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
