//! Damage to the files of sets, and how `verify`, `explain` and `bench` name it.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use super::fixture::{Folder, Run};

/// A set in its own directory, as the program writes it.
struct Set {
    directory: Folder,
    stem: &'static str,
    form: &'static str,
}

impl Set {
    /// Exports 24 random reflections under `narrow`.
    fn random(form: &'static str) -> Self {
        let option = if form == "bin" { "--bin" } else { "" };
        Self::exported("random_narrow", form, &format!("random --count 24 --profile narrow {option}"))
    }

    fn exported(stem: &'static str, form: &'static str, options: &str) -> Self {
        let directory = Folder::new();
        directory.done(&format!("vectors export {options} -o ."));
        Self { directory, stem, form }
    }

    /// Writes the set as text with changed lines. The first line is the title.
    fn changed(change: impl FnOnce(&mut Vec<String>)) -> Self {
        let set = Self::random("hex");
        set.change(change);
        set
    }

    fn change(&self, change: impl FnOnce(&mut Vec<String>)) {
        let mut lines = String::from_utf8(self.read()).unwrap().lines().map(str::to_owned).collect();
        change(&mut lines);
        self.write(lines.join("\n") + "\n");
    }

    fn path(&self, extension: &str) -> PathBuf {
        self.directory.join(self.stem).with_extension(extension)
    }

    fn read(&self) -> Vec<u8> {
        fs::read(self.path(self.form)).unwrap()
    }

    fn write(&self, words: impl AsRef<[u8]>) {
        fs::write(self.path(self.form), words).unwrap();
    }

    /// Asserts that `verify` ends with a code and says all of `parts`.
    fn verify_says(&self, code: i32, parts: &[&str]) -> Run {
        let run = self.directory.run(&format!("vectors verify {}.json", self.stem)).ends(code);
        Run { out: run.out + &run.err, ..run }.prints(parts)
    }

    /// Asserts that each command ends with 1 and says all of `parts`, the name of the file among them.
    fn every_command_says(&self, extension: &str, parts: &[&str]) {
        let file = format!("{}.{extension}", self.stem);
        for command in ["verify @", "explain @ --index 3", "bench @ --device blank -o bench"] {
            let run = self.directory.run(&format!("vectors {}", command.replace('@', &format!("{}.json", self.stem))));
            let text = Run { out: run.out + &run.err, ..run }.ends(1);
            text.prints(parts).prints(&[&file]);
        }
    }
}

#[test]
fn two_lines_that_are_swapped_are_named() {
    let set = Set::changed(|lines| lines.swap(18, 20));
    let sentence = "words #17 and #19 are in each other's place (lines 19 and 21)";
    set.verify_says(3, &["every vector is right, but not in its place", sentence]);
    set.directory.done("vectors explain random_narrow.json --index 17").complains(&[sentence]);
    let bench = set.directory.run("vectors bench random_narrow.json -o bench").ends(1);
    bench.complains(&[sentence, "export the set again"]);
}

#[test]
fn words_of_hard_cases_know_their_places_too() {
    let set = Set::exported("frame_zero_standard", "hex", "frame_zero");
    set.change(|lines| lines[1..5].rotate_right(1));
    set.verify_says(3, &["word #3 is in the place of #0 (line 2)", "word #0 is in the place of #1 (line 3)"]);
}

#[test]
fn swapped_records_are_named() {
    let set = Set::random("bin");
    let mut bytes = set.read();
    let length = bytes.len() / 24;
    let (before, behind) = bytes.split_at_mut(8 * length);
    before[3 * length..4 * length].swap_with_slice(&mut behind[..length]);
    set.write(bytes);
    set.verify_says(3, &["words #3 and #8 are in each other's place (lines 4 and 9)"]);
}

#[test]
fn a_line_that_is_missing_or_there_twice_is_named() {
    let set = Set::changed(|lines| drop(lines.remove(11)));
    set.every_command_says("hex", &["23 vectors, but the manifest says 24", "word #10 is missing"]);
    set.change(|lines| drop(lines.drain(1..3)));
    set.every_command_says("hex", &["21 vectors", "words #0 to #1 are missing; word #10 is missing"]);
    let set = Set::changed(|lines| {
        lines.insert(5, lines[5].clone());
        lines.insert(5, lines[5].clone());
    });
    let twice = "word #4 is there once more (line 7); word #4 is there once more";
    set.every_command_says("hex", &["26 vectors", twice]);
    // The number of vectors is right.
    let set = Set::changed(|lines| lines[9] = lines[6].clone());
    set.verify_says(3, &["word #5 is there once more (line 10)", "word #8 is missing"]);
}

#[test]
fn a_damaged_word_is_no_matter_of_order() {
    let set = Set::changed(|lines| {
        let last = lines[4].pop().unwrap();
        lines[4].push(if last == '0' { '1' } else { '0' });
        lines[7] = lines[7].replacen(|c: char| c != '0', "0", 1);
    });
    let parts = ["2 of 24 vectors; the file's SHA-256 differs, too", "random #3 (line 5)", "random #6 (line 8)"];
    let text = set.verify_says(3, &parts).out;
    for word in ["place", "missing", "once more", "no vector"] {
        assert!(!text.contains(word), "{text}");
    }
}

#[test]
fn a_word_of_the_wrong_length_is_named_with_its_field() {
    for (from, to, what) in
        [("_", "_0", "field normal_y has 5 of 4 digits"), ("_", "", "field normal_x has 8 of 4 digits")]
    {
        let set = Set::changed(|lines| lines[3] = lines[3].replacen(from, to, 1));
        set.verify_says(1, &["random_narrow.hex:4: ", what]);
    }
}

#[test]
fn what_is_no_hex_digit_is_named_with_line_and_column() {
    let set = Set::changed(|lines| lines[2].replace_range(6..7, "g"));
    set.verify_says(1, &["random_narrow.hex:3: column 7: 'g' in field normal_y is no lower-case hex digit"]);
}

#[test]
fn ends_of_lines_of_another_system_are_named() {
    let set = Set::changed(|lines| lines.iter_mut().for_each(|line| line.push('\r')));
    set.verify_says(1, &["random_narrow.hex:2: ends in CR LF", "tr -d '\\r'"]);
}

#[test]
fn bytes_in_a_text_and_text_for_bytes_are_called_that() {
    let [text, bytes] = ["hex", "bin"].map(Set::random);
    let whole = text.read();
    let title = whole.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    text.write([&whole[..title], &bytes.read()].concat());
    text.every_command_says("hex", &["random_narrow.hex:2: byte ", "the file is binary", "Export the set again"]);
    // The file has no line end within the longest line.
    text.write(vec![0; 10_000]);
    text.every_command_says("hex", &["random_narrow.hex:1: byte 0 of the file is 00", "the file is binary"]);

    bytes.write(whole);
    bytes.verify_says(1, &["random_narrow.bin:1: the file is text"]);
}

#[test]
fn files_that_are_cut_short_say_where() {
    let [text, bytes] = ["hex", "bin"].map(Set::random);
    let end = |byte| format!("the file ends at byte {byte}, in the middle of a word: it is cut short");
    let whole = text.read();
    text.write(&whole[..whole.len() / 2]);
    text.every_command_says("hex", &["random_narrow.hex:13: ", &end(whole.len() / 2)]);
    text.write("");
    text.every_command_says("hex", &["0 vectors, but the manifest says 24"]);

    let whole = bytes.read();
    bytes.write(&whole[..whole.len() - 5]);
    bytes.verify_says(1, &["random_narrow.bin:24: ", &end(whole.len() - 5)]);
}

/// Special files in place of a file: no command waits for them or reads them without end.
#[test]
#[cfg(unix)]
fn what_is_no_file_is_refused_and_nothing_waits() {
    for extension in ["hex", "json"] {
        let set = Set::random("hex");
        let path = set.path(extension);
        fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink("/dev/zero", &path).unwrap();
        set.every_command_says(extension, &["cannot read", "a pipe or a device"]);
        fs::remove_file(&path).unwrap();
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        set.every_command_says(extension, &["cannot read", "a pipe or a device"]);
    }
    let set = Set::random("hex");
    fs::remove_file(set.path("hex")).unwrap();
    fs::create_dir(set.path("hex")).unwrap();
    set.every_command_says("hex", &["cannot read", "no regular file but a directory"]);
}

#[test]
fn a_manifest_with_huge_numbers_takes_no_memory() {
    let set = Set::random("hex");
    let json = set.path("json");
    let text = fs::read_to_string(&json).unwrap();
    let count = |count: &str| text.replacen("\"count\": 24", &format!("\"count\": {count}"), 1);
    let longer = "24 vectors, but the manifest says 4194304; the file is cut short or was added to; words #24 to #4194303 are missing";
    for (changed, extension, reason) in [
        (count("4194305"), "json", "count 4194305 is not in 1 to 4194304"),
        (count("18446744073709551615"), "json", "count 18446744073709551615 is not in"),
        (count("4194304"), "hex", longer),
        (text.replacen("\"word_bits\": ", "\"word_bits\": 1", 1), "json", "word_bits is 1"),
        (count("99999999999999999999999"), "json", "random_narrow.json"),
    ] {
        fs::write(&json, changed).unwrap();
        set.every_command_says(extension, &[reason]);
    }
    // No command relies on the size.
    let bytes = text.lines().find(|line| line.contains("\"bytes\"")).unwrap();
    fs::write(&json, text.replacen(bytes, "      \"bytes\": 18446744073709551615,", 1)).unwrap();
    set.verify_says(0, &[]);
    let huge = "{\"schema\": \"roughxel-vectors\", \"format_version\": 3, ".to_owned() + &" ".repeat(1 << 20) + "}";
    fs::write(&json, huge).unwrap();
    set.every_command_says("json", &["larger than 1 MiB"]);
}
