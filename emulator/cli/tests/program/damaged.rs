//! What happens to files of sets, and that `verify`, `explain` and `bench` call it by its name.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A set in a directory of its own, as the program writes it.
struct Set {
    directory: TempDir,
    name: &'static str,
    form: &'static str,
}

impl Set {
    /// 24 random reflections under `narrow`.
    fn random(form: &'static str) -> Self {
        let options: &[&str] = if form == "bin" { &["--bin"] } else { &[] };
        Self::exported("random", form, &[&["--count", "24", "--profile", "narrow"], options].concat())
    }

    fn exported(name: &'static str, form: &'static str, options: &[&str]) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().to_str().unwrap();
        let output = roughxel(&[&["vectors", "export", name, "-o", path], options].concat());
        assert_eq!(output.status.code(), Some(0));
        Self { directory, name, form }
    }

    fn path(&self, extension: &str) -> PathBuf {
        let entries = fs::read_dir(self.directory.path()).unwrap().map(|entry| entry.unwrap().path());
        let stem = entries
            .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
            .find(|stem| stem.starts_with(self.name));
        self.directory.path().join(stem.unwrap()).with_extension(extension)
    }

    fn words(&self) -> PathBuf {
        self.path(self.form)
    }

    fn read(&self) -> Vec<u8> {
        fs::read(self.words()).unwrap()
    }

    /// The lines of the file, the title first.
    fn lines(&self) -> Vec<String> {
        String::from_utf8(self.read()).unwrap().lines().map(str::to_owned).collect()
    }

    fn write_lines(&self, lines: &[String]) {
        fs::write(self.words(), lines.join("\n") + "\n").unwrap();
    }

    fn verify(&self) -> (Option<i32>, String) {
        said(&roughxel(&["vectors", "verify", self.path("json").to_str().unwrap()]))
    }

    /// Each command has to end with 1 and say all of `parts`, the name of the file among them.
    fn every_command_says(&self, file: &Path, parts: &[&str]) {
        let json = self.path("json");
        let (json, bench) = (json.to_str().unwrap(), self.directory.path().join("bench"));
        for arguments in [
            &["verify", json][..],
            &["explain", json, "--index", "3"],
            &["bench", json, "--device", "blank", "-o", bench.to_str().unwrap()],
        ] {
            let (code, text) = said(&roughxel(&[&["vectors"], arguments].concat()));
            assert_eq!(code, Some(1), "{arguments:?}: {text}");
            for part in [file.file_name().unwrap().to_str().unwrap()].iter().chain(parts) {
                assert!(text.contains(part), "{arguments:?}: `{part}` is not in: {text}");
            }
        }
    }
}

fn roughxel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_roughxel")).args(arguments).output().unwrap()
}

/// Exit code, and what went to stdout and stderr.
fn said(output: &Output) -> (Option<i32>, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout) + &text(&output.stderr))
}

#[test]
fn two_lines_that_are_swapped_are_named() {
    let set = Set::random("hex");
    let mut lines = set.lines();
    lines.swap(18, 20);
    set.write_lines(&lines);
    let sentence = "words #17 and #19 are in each other's place (lines 19 and 21)";
    let (code, text) = set.verify();
    assert!(code == Some(3) && text.contains("every vector is right, but not in its place"), "{text}");
    assert!(text.contains(sentence), "{text}");
    let json = set.path("json");
    let json = json.to_str().unwrap();
    let (code, text) = said(&roughxel(&["vectors", "explain", json, "--index", "17"]));
    assert!(code == Some(0) && text.contains(sentence), "{text}");
    let bench = set.directory.path().join("bench");
    let (code, text) = said(&roughxel(&["vectors", "bench", json, "-o", bench.to_str().unwrap()]));
    assert!(code == Some(1) && text.contains(sentence) && text.contains("export the set again"), "{text}");
}

#[test]
fn words_of_hard_cases_know_their_places_too() {
    let set = Set::exported("frame_zero", "hex", &[]);
    let mut lines = set.lines();
    lines[1..5].rotate_right(1);
    set.write_lines(&lines);
    let (code, text) = set.verify();
    assert!(code == Some(3) && text.contains("word #3 is in the place of #0 (line 2)"), "{text}");
    assert!(text.contains("word #0 is in the place of #1 (line 3)"), "{text}");
}

#[test]
fn swapped_records_are_named() {
    let set = Set::random("bin");
    let bytes = set.read();
    let length = bytes.len() / 24;
    let mut changed = bytes.clone();
    changed[3 * length..4 * length].copy_from_slice(&bytes[8 * length..9 * length]);
    changed[8 * length..9 * length].copy_from_slice(&bytes[3 * length..4 * length]);
    fs::write(set.words(), changed).unwrap();
    let (code, text) = set.verify();
    assert!(code == Some(3) && text.contains("words #3 and #8 are in each other's place (lines 4 and 9)"), "{text}");
}

#[test]
fn a_line_that_is_missing_or_there_twice_is_named() {
    let set = Set::random("hex");
    let lines = set.lines();
    let mut changed = lines.clone();
    changed.remove(11);
    set.write_lines(&changed);
    set.every_command_says(&set.words(), &["23 vectors, but the manifest says 24", "word #10 is missing"]);
    changed.drain(1..3);
    set.write_lines(&changed);
    set.every_command_says(&set.words(), &["21 vectors", "words #0 to #1 are missing; word #10 is missing"]);
    changed.clone_from(&lines);
    changed.insert(5, lines[5].clone());
    changed.insert(5, lines[5].clone());
    set.write_lines(&changed);
    set.every_command_says(
        &set.words(),
        &["26 vectors", "word #4 is there once more (line 7); word #4 is there once more"],
    );
    // As many as there have to be.
    changed.clone_from(&lines);
    changed[9] = lines[6].clone();
    set.write_lines(&changed);
    let (code, text) = set.verify();
    assert!(code == Some(3) && text.contains("word #5 is there once more (line 10)"), "{text}");
    assert!(text.contains("word #8 is missing"), "{text}");
}

#[test]
fn a_damaged_word_is_no_matter_of_order() {
    let set = Set::random("hex");
    let mut lines = set.lines();
    let last = lines[4].pop().unwrap();
    lines[4].push(if last == '0' { '1' } else { '0' });
    lines[7] = lines[7].replacen(|c: char| c != '0', "0", 1);
    set.write_lines(&lines);
    let (code, text) = set.verify();
    assert!(code == Some(3) && text.contains("2 of 24 vectors; the file's SHA-256 differs, too"), "{text}");
    assert!(text.contains("random #3 (line 5)") && text.contains("random #6 (line 8)"), "{text}");
    for word in ["place", "missing", "once more", "no vector"] {
        assert!(!text.contains(word), "{text}");
    }
}

#[test]
fn a_word_of_the_wrong_length_is_named_with_its_field() {
    let set = Set::random("hex");
    let lines = set.lines();
    for (from, to, what) in
        [("_", "_0", "field normal_y has 5 of 4 digits"), ("_", "", "field normal_x has 8 of 4 digits")]
    {
        let mut changed = lines.clone();
        changed[3] = lines[3].replacen(from, to, 1);
        set.write_lines(&changed);
        let (code, text) = set.verify();
        assert_eq!(code, Some(1));
        assert!(text.contains("random_narrow.hex:4: ") && text.contains(what), "{text}");
    }
}

#[test]
fn what_is_no_hex_digit_is_named_with_line_and_column() {
    let set = Set::random("hex");
    let mut lines = set.lines();
    lines[2].replace_range(6..7, "g");
    set.write_lines(&lines);
    let (code, text) = set.verify();
    assert!(code == Some(1), "{text}");
    assert!(text.contains("random_narrow.hex:3: column 7: 'g' in field normal_y is no lower-case hex digit"), "{text}");
}

#[test]
fn ends_of_lines_of_another_system_are_named() {
    let set = Set::random("hex");
    let text = set.lines().join("\r\n") + "\r\n";
    fs::write(set.words(), text).unwrap();
    let (code, text) = set.verify();
    assert!(code == Some(1) && text.contains("random_narrow.hex:2: ends in CR LF"), "{text}");
    assert!(text.contains("tr -d '\\r'"), "{text}");
}

#[test]
fn bytes_in_a_text_and_text_for_bytes_are_called_that() {
    let [text, bytes] = ["hex", "bin"].map(Set::random);
    let title = text.lines()[0].len() + 1;
    let mut mixed = text.read()[..title].to_vec();
    mixed.extend(bytes.read());
    fs::write(text.words(), mixed).unwrap();
    text.every_command_says(
        &text.words(),
        &["random_narrow.hex:2: byte ", "the file is binary", "Export the set again"],
    );
    // Without an end of line within the longest line.
    fs::write(text.words(), vec![0; 10_000]).unwrap();
    text.every_command_says(&text.words(), &["random_narrow.hex:1: byte 0 of the file is 00", "the file is binary"]);

    let again = Set::random("hex");
    fs::write(bytes.words(), again.read()).unwrap();
    let (code, said) = bytes.verify();
    assert!(code == Some(1) && said.contains("random_narrow.bin:1: the file is text"), "{said}");
}

#[test]
fn files_that_are_cut_short_say_where() {
    let [text, bytes] = ["hex", "bin"].map(Set::random);
    let whole = text.read();
    fs::write(text.words(), &whole[..whole.len() / 2]).unwrap();
    let end = format!("the file ends at byte {}, in the middle of a word: it is cut short", whole.len() / 2);
    text.every_command_says(&text.words(), &["random_narrow.hex:13: ", &end]);
    fs::write(text.words(), "").unwrap();
    text.every_command_says(&text.words(), &["0 vectors, but the manifest says 24"]);

    let whole = bytes.read();
    fs::write(bytes.words(), &whole[..whole.len() - 5]).unwrap();
    let (code, said) = bytes.verify();
    let end = format!("the file ends at byte {}, in the middle of a word: it is cut short", whole.len() - 5);
    assert!(code == Some(1) && said.contains("random_narrow.bin:24: ") && said.contains(&end), "{said}");
}

/// Whatever stands in the place of a file, no command waits for it or reads it without end.
#[test]
#[cfg(unix)]
fn what_is_no_file_is_refused_and_nothing_waits() {
    for extension in ["hex", "json"] {
        let set = Set::random("hex");
        let path = set.path(extension);
        let place = |make: &dyn Fn()| {
            fs::remove_file(&path).unwrap();
            make();
        };
        place(&|| std::os::unix::fs::symlink("/dev/zero", &path).unwrap());
        set.every_command_says(&path, &["cannot read", "a pipe or a device"]);
        place(&|| assert!(Command::new("mkfifo").arg(&path).status().unwrap().success()));
        set.every_command_says(&path, &["cannot read", "a pipe or a device"]);
    }
    let set = Set::random("hex");
    fs::remove_file(set.words()).unwrap();
    fs::create_dir(set.path("json").with_extension("hex")).unwrap();
    set.every_command_says(&set.words(), &["cannot read", "no regular file but a directory"]);
}

#[test]
fn a_manifest_with_huge_numbers_takes_no_memory() {
    let set = Set::random("hex");
    let json = set.path("json");
    let text = fs::read_to_string(&json).unwrap();
    let bytes = text.lines().find(|line| line.contains("\"bytes\"")).unwrap();
    for (from, to, reason) in [
        ("\"count\": 24", "\"count\": 4194305", "count 4194305 is not in 1 to 4194304"),
        ("\"count\": 24", "\"count\": 18446744073709551615", "count 18446744073709551615 is not in"),
        (
            "\"count\": 24",
            "\"count\": 4194304",
            "24 vectors, but the manifest says 4194304; the file is cut short or was added to; words #24 to #4194303 are missing",
        ),
        ("\"word_bits\": ", "\"word_bits\": 1", "word_bits is 1"),
        ("\"count\": 24", "\"count\": 99999999999999999999999", "random_narrow.json"),
    ] {
        fs::write(&json, text.replacen(from, to, 1)).unwrap();
        set.every_command_says(&json.with_extension(if reason.starts_with("24 ") { "hex" } else { "json" }), &[reason]);
    }
    // Nobody counts on the size.
    fs::write(&json, text.replacen(bytes, "      \"bytes\": 18446744073709551615,", 1)).unwrap();
    assert_eq!(set.verify().0, Some(0));
    let huge = "{\"schema\": \"roughxel-vectors\", \"format_version\": 3, ".to_owned() + &" ".repeat(1 << 20) + "}";
    fs::write(&json, huge).unwrap();
    set.every_command_says(&json, &["larger than 1 MiB"]);
}
