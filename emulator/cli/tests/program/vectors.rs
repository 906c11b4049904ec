//! Golden vectors: what is written verifies, and whatever is changed is found.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use fixed::types::{I2F30, I4F28};
use roughxel_cases::random_fragment;
use roughxel_core::plan::{Datapath, Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::{Precision, Profile, RoughnessKind};
use roughxel_vectors::{
    Cause, Direction, Field, Form, Layout, Manifest, Mismatch, SetInfo, VectorError, Verification, Words, export,
    export_with, hard_sets, in_page, manifests_in, random_set, tables, verify,
};
use serde_json::Value;

fn info<'a>(name: &'a str, profile: &'a str) -> SetInfo<'a> {
    SetInfo {
        name,
        description: "test",
        seed: None,
        datapath: Datapath::Reflection,
        effects: Effects::ALL,
        precision: Profile::by_name(profile).unwrap().precision(),
        profile,
        words: Words::default(),
    }
}

/// A set of `count` random vectors under `standard` in a directory of its own.
struct Set {
    directory: tempfile::TempDir,
    manifest: Manifest,
}

impl Set {
    fn random(count: u64) -> Self {
        Self::of(Datapath::Reflection, count)
    }

    fn of(datapath: Datapath, count: u64) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let info = SetInfo { datapath, ..info("random", "standard") };
        let input = |index| random_set(datapath, "test", index, &Precision::STANDARD);
        let manifest = export_with(&info, count, &input, directory.path(), &|_| {}).unwrap();
        Self { directory, manifest }
    }

    fn hex(&self) -> PathBuf {
        self.directory.path().join("random_standard.hex")
    }

    fn json(&self) -> PathBuf {
        self.directory.path().join("random_standard.json")
    }

    fn words(&self) -> Vec<Word> {
        let text = fs::read_to_string(self.hex()).unwrap();
        text.lines().filter(|line| !line.starts_with("//")).map(Word::parse).collect()
    }

    fn write_words(&self, words: &[Word]) {
        let lines: String = words.iter().map(|word| word.line() + "\n").collect();
        fs::write(self.hex(), format!("// changed\n{lines}")).unwrap();
    }

    fn verify(&self) -> Result<Verification, VectorError> {
        verify(&self.json(), &|_| {})
    }

    fn only_mismatch(&self) -> Mismatch {
        let result = self.verify().unwrap();
        assert_eq!((result.mismatching, result.mismatches.len(), result.hash_matches), (1, 1, false));
        result.mismatches[0].clone()
    }
}

/// A word as FORMAT.md describes it, read without the program's help: digits and the lengths of the fields.
#[derive(Clone)]
struct Word {
    digits: Vec<u8>,
    lengths: Vec<usize>,
}

impl Word {
    fn parse(line: &str) -> Self {
        let digits = line.chars().filter_map(|c| c.to_digit(16)).map(|digit| digit as u8).collect();
        Self { digits, lengths: line.split('_').map(str::len).collect() }
    }

    fn line(&self) -> String {
        let mut digits = self.digits.iter().map(|&digit| char::from_digit(digit.into(), 16).unwrap());
        let fields: Vec<String> = self.lengths.iter().map(|&length| digits.by_ref().take(length).collect()).collect();
        fields.join("_")
    }

    /// Flips bit `place`, counted from the end of the word.
    fn flip(&mut self, place: usize) {
        let at = self.digits.len() - 1 - place / 4;
        self.digits[at] ^= 1 << (place % 4);
    }

    /// CRC-32 of all but the last eight digits, bit by bit.
    fn crc(&self) -> u32 {
        let data = &self.digits[..self.digits.len() - 8];
        let bits = data.iter().flat_map(|digit| (0..4).rev().map(move |bit| u32::from(digit >> bit & 1)));
        bits.fold(u32::MAX, |crc, bit| crc << 1 ^ if crc >> 31 ^ bit == 1 { 0x04c1_1db7 } else { 0 })
    }

    fn set_crc(&mut self) {
        let crc = self.crc();
        let end = self.digits.len();
        (0..8).for_each(|i| self.digits[end - 1 - i] = (crc >> (4 * i) & 15) as u8);
    }
}

#[test]
fn every_set_verifies_under_every_profile() {
    let directory = tempfile::tempdir().unwrap();
    for profile in ["narrow", "paper", "compact", "standard", "precise"] {
        let p = Profile::by_name(profile).unwrap().precision();
        for set in hard_sets(&p) {
            let datapath = set.datapath;
            let info = SetInfo { datapath, effects: set.effects, ..info(set.name, profile) };
            let (count, input) = (set.inputs.len() as u64, |index: u64| set.inputs[index as usize]);
            let manifest = export_with(&info, count, &input, directory.path(), &|_| {}).unwrap();
            assert_eq!(manifest.count, count);
            let result = verify(&directory.path().join(format!("{}_{profile}.json", set.name)), &|_| {}).unwrap();
            assert!(result.passed(), "{} {profile}: {:?}", set.name, result.mismatches);
        }
    }
}

#[test]
fn a_flipped_bit_in_any_field_is_reported_with_set_index_stage_and_field() {
    // As many at a time as are described.
    const TOGETHER: usize = 10;
    for set in Datapath::ALL.map(|datapath| Set::of(datapath, TOGETHER as u64 + 2)) {
        let words = set.words();
        // Every bit of the field's digits, those above its width included.
        let bits = |field: &Field| 0..field.width.next_multiple_of(4);
        let fields = &set.manifest.fields;
        let places: Vec<(&Field, u32)> =
            fields.iter().flat_map(|field| bits(field).map(move |bit| (field, bit))).collect();
        for places in places.chunks(TOGETHER) {
            let mut flipped = words.clone();
            for (word, (field, bit)) in flipped[1..].iter_mut().zip(places) {
                word.flip((field.lsb + bit) as usize);
            }
            set.write_words(&flipped);
            let result = set.verify().unwrap();
            let count = places.len();
            assert_eq!(
                (result.mismatching, result.mismatches.len(), result.hash_matches),
                (count as u64, count, false)
            );
            for (index, (mismatch, (field, bit))) in (1..).zip(result.mismatches.iter().zip(places)) {
                assert_eq!((mismatch.set.as_str(), mismatch.index, mismatch.line), ("random", index, index + 2));
                assert_eq!((&mismatch.stage, &mismatch.field, mismatch.bit), (&field.stage, &field.name, *bit));
                assert_eq!(mismatch.cause, Cause::FlippedBit);
            }
        }
    }
}

#[test]
fn the_check_value_is_the_documented_crc() {
    for word in Set::random(50).words() {
        let mut again = word.clone();
        again.set_crc();
        assert_eq!(again.line(), word.line());
    }
}

#[test]
fn another_result_in_an_intact_word_is_reported_at_its_earliest_stage() {
    let set = Set::random(2);
    let words = set.words();
    for name in ["normal_mod_y", "probes", "lod", "determinant_e"] {
        let field = set.manifest.fields.iter().find(|field| field.name == name).unwrap();
        let status = set.manifest.fields.iter().find(|field| field.name == "status").unwrap();
        let mut changed = words.clone();
        changed[0].flip(field.lsb as usize);
        changed[0].flip(status.lsb as usize);
        changed[0].set_crc();
        set.write_words(&changed);
        let mismatch = set.only_mismatch();
        assert_eq!((mismatch.stage.as_str(), mismatch.field.as_str()), (field.stage.as_str(), name));
        assert_eq!((mismatch.cause, mismatch.bit, mismatch.fields_differing), (Cause::Computed, 0, 2));
    }
}

#[test]
fn two_flipped_bits_are_damage_at_the_earliest_stage() {
    let set = Set::random(2);
    let mut words = set.words();
    let lsb = |name: &str| set.manifest.fields.iter().find(|field| field.name == name).unwrap().lsb as usize;
    words[1].flip(lsb("lod"));
    words[1].flip(lsb("reflected_x") + 1);
    set.write_words(&words);
    let mismatch = set.only_mismatch();
    assert_eq!((mismatch.index, mismatch.stage.as_str(), mismatch.cause), (1, "reflect", Cause::Damaged));
}

/// Vectors of [`both_forms`]: two whole groups of words that are put together at once, and a part of one.
const BOTH_FORMS: u64 = 140;

/// Both forms of the same vectors, with taps or without, in directories of their own.
fn both_forms(datapath: Datapath, profile: &str, taps: bool) -> [(tempfile::TempDir, Manifest); 2] {
    [Form::Hex, Form::Bin].map(|form| {
        let directory = tempfile::tempdir().unwrap();
        let info = SetInfo { datapath, words: Words { taps, form }, ..info("random", profile) };
        let input = |index| random_set(datapath, "test", index, &info.precision);
        let manifest = export_with(&info, BOTH_FORMS, &input, directory.path(), &|_| {}).unwrap();
        (directory, manifest)
    })
}

/// Records are written in pieces of 16 bytes, the last one first: here a piece is longer than a record.
#[test]
fn records_shorter_than_a_piece_are_the_digits_of_the_words() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().to_str().unwrap();
    for form in [&[][..], &["--bin"]] {
        let arguments = [
            "vectors",
            "export",
            "random",
            "--stage",
            "enter_offset",
            "--count",
            "100",
            "--profile",
            "narrow",
            "-o",
            path,
        ];
        assert!(roughxel(&[&arguments, form].concat()).status.success());
    }
    let name = directory.path().join("random_enter_offset_narrow");
    let lines = fs::read_to_string(name.with_extension("hex")).unwrap();
    let lines: Vec<String> =
        lines.lines().filter(|line| !line.starts_with("//")).map(|line| padded(&line.replace('_', ""))).collect();
    assert!(lines.len() == 100 && lines[0].len() < 32, "{} of {}", lines.len(), lines[0]);
    let records = fs::read(name.with_extension("bin")).unwrap();
    assert_eq!(lines.concat(), records.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
}

#[test]
fn records_are_the_digits_of_the_words_and_verify() {
    let (mut odd, mut taps_left_out) = (0, 0);
    for datapath in Datapath::ALL {
        for profile in Profile::ALL.map(Profile::name) {
            for taps in [true, false] {
                let [(text, hex), (bytes, bin)] = both_forms(datapath, profile, taps);
                let path =
                    |directory: &tempfile::TempDir, manifest: &Manifest| directory.path().join(&manifest.files[0].name);
                let lines = fs::read_to_string(path(&text, &hex)).unwrap();
                let digits: String = lines
                    .lines()
                    .filter(|line| !line.starts_with("//"))
                    .map(|line| padded(&line.replace('_', "")))
                    .collect();
                let records: String =
                    fs::read(path(&bytes, &bin)).unwrap().iter().map(|byte| format!("{byte:02x}")).collect();
                assert_eq!(digits, records, "{} {profile}", datapath.name());
                assert_eq!(hex.fields, bin.fields);
                assert_eq!(hex.fields.iter().any(|field| field.direction == Direction::Tap), taps);
                odd += u32::from(bin.word_bits % 8 == 4);
                taps_left_out += u32::from(!taps);
                for (directory, manifest) in [(&text, &hex), (&bytes, &bin)] {
                    let result = verify(&directory.path().join(format!("random_{profile}.json")), &|_| {}).unwrap();
                    assert!(result.passed(), "{} {profile}: {result:?}", datapath.name());
                    assert_eq!(manifest.taps, taps);
                }
            }
        }
    }
    assert!(odd > 0 && taps_left_out > 0, "words of an odd number of digits: {odd}");
}

/// An even number of digits.
fn padded(digits: &str) -> String {
    if digits.len() % 2 == 1 { format!("0{digits}") } else { digits.into() }
}

#[test]
fn a_flipped_bit_of_a_record_is_located_and_a_record_cut_short_is_told() {
    let [_, (directory, manifest)] = both_forms(Datapath::Reflection, "standard", true);
    let (bin, json) = (directory.path().join("random_standard.bin"), directory.path().join("random_standard.json"));
    let whole = fs::read(&bin).unwrap();
    let field = manifest.fields.iter().find(|field| field.name == "reflected_x").unwrap();
    let record = manifest.word_bits.div_ceil(8) as usize;
    let mut bytes = whole.clone();
    bytes[8 * record - 1 - field.lsb as usize / 8] ^= 1 << (field.lsb % 8);
    fs::write(&bin, bytes).unwrap();
    let result = verify(&json, &|_| {}).unwrap();
    let mismatch = &result.mismatches[0];
    assert_eq!((mismatch.index, mismatch.line, mismatch.field.as_str(), mismatch.bit), (7, 8, "reflected_x", 0));
    assert_eq!((mismatch.cause, result.mismatching), (Cause::FlippedBit, 1));

    fs::write(&bin, &whole[..whole.len() - 3]).unwrap();
    let error = verify(&json, &|_| {}).unwrap_err().to_string();
    assert!(error.contains("random_standard.bin:140: ") && error.contains("bytes"), "{error}");
    fs::write(&bin, &whole[..whole.len() - record]).unwrap();
    assert!(matches!(verify(&json, &|_| {}), Err(VectorError::Count { found: 139, expected: BOTH_FORMS, .. })));
}

#[test]
fn a_changed_comment_changes_the_hash_and_no_vector() {
    let set = Set::random(2);
    set.write_words(&set.words());
    let result = set.verify().unwrap();
    assert_eq!((result.passed(), result.hash_matches, result.mismatching), (false, false, 0));
}

#[test]
fn broken_words_are_named_by_file_and_line() {
    let set = Set::random(3);
    let good = fs::read_to_string(set.hex()).unwrap();
    let lines: Vec<_> = good.lines().collect();
    let with_line = |line: String| {
        let mut lines = lines.clone();
        lines[2] = &line;
        lines.join("\n") + "\n"
    };
    let word = lines[2];
    let cases = [
        (with_line(word.to_uppercase()), "no lower-case hex digit"),
        (with_line(word.replacen('0', "x", 1)), "no lower-case hex digit"),
        (with_line(word.replacen('_', "0", 1)), "underscore"),
        (with_line(word[1..].to_string()), "characters"),
        (with_line(format!("0{word}")), "characters"),
        (with_line(String::new()), "characters"),
        (with_line("0".repeat(100_000)), "longer than"),
        (good.replace('\n', "\r\n"), "ends in CR LF"),
    ];
    for (text, problem) in cases {
        fs::write(set.hex(), text).unwrap();
        let message = set.verify().unwrap_err().to_string();
        assert!(message.contains("random_standard.hex:") && message.contains(problem), "{message}");
    }
    let short = lines[..3].join("\n") + "\n";
    let long = format!("{good}{word}\n");
    for (text, found) in [(short, "2 vectors, but the manifest says 3"), (long, "4 vectors, but the manifest says 3")] {
        fs::write(set.hex(), text).unwrap();
        let message = set.verify().unwrap_err().to_string();
        assert!(message.contains(found), "{message}");
    }
    fs::remove_file(set.hex()).unwrap();
    assert!(set.verify().unwrap_err().to_string().contains("random_standard.hex"));
}

#[test]
fn broken_manifests_are_refused_with_the_reason() {
    let set = Set::random(2);
    let good = fs::read_to_string(set.json()).unwrap();
    let cases = [
        (good[..good.len() / 2].to_string(), "no vector manifest"),
        ("{}".into(), "missing field `schema`"),
        (good.replacen("roughxel-vectors", "other", 1), "schema `other` is unknown"),
        (good.replacen("\"format_version\": 3", "\"format_version\": 2", 1), "format version 2 is unknown"),
        (good.replacen("\"reflection\"", "\"refraction\"", 1), "unknown variant `refraction`"),
        (good.replacen("\"datapath\": \"reflection\"", "\"datapath\": \"highlight\"", 1), "does not have are on"),
        (good.replacen("\"horizon\": \"none\"", "\"horizon\": \"correlated\"", 1), "does not have are on"),
        (good.replacen("\"curvature\": true", "\"curvature\": false", 1), "`dnormal_0_x`"),
        (good.replacen("\"name\": \"standard\"", "\"name\": \"Best\"", 1), "`Best` is no name of a profile"),
        (good.replacen("\"fraction_bits\": 20", "\"fraction_bits\": 21", 1), "other knobs"),
        (good.replacen("\"fraction_bits\": 20", "\"fraction_bits\": 99", 1), "fraction_bits is out of its range"),
        (good.replacen("\"count\": 2", "\"count\": 0", 1), "count 0"),
        (good.replacen("\"count\": 2", "\"count\": \"two\"", 1), "broken manifest"),
        (good.replacen("\"normal_x\"", "\"normal_w\"", 1), "`normal_w`"),
        (good.replacen("\"width\": 22", "\"width\": 21", 1), "field `normal_x` is laid out"),
        (good.replacen("random_standard.hex", "../random_standard.hex", 1), "no plain name"),
        (" ".repeat(2 << 20), "larger than 1 MiB"),
    ];
    for (text, reason) in cases {
        assert_ne!(text, good, "{reason}");
        fs::write(set.json(), text).unwrap();
        let message = set.verify().unwrap_err().to_string();
        assert!(message.contains("random_standard.json") && message.contains(reason), "{reason}: {message}");
    }
}

#[test]
fn resizing_a_set_changes_no_vector_that_stays() {
    let words = |count| Set::random(count).words().iter().map(Word::line).collect::<Vec<_>>();
    assert_eq!(words(20)[..7], words(7));
}

#[test]
fn fields_tile_the_word_and_have_unique_names() {
    let profiles =
        ["narrow", "paper", "compact", "standard", "precise"].map(|name| Profile::by_name(name).unwrap().precision());
    let layouts = profiles.iter().flat_map(|p| {
        let effects = [Effects::ALL, Effects::NONE].into_iter();
        effects.flat_map(move |effects| Datapath::ALL.map(|datapath| Layout::new(datapath, &effects, p, true)))
    });
    for layout in layouts {
        let mut end = layout.word_bits();
        for field in layout.fields() {
            end -= 4 * field.digits();
            assert_eq!(field.lsb, end);
            assert!((1..=32).contains(&field.width) && field.fraction_bits <= field.width);
            assert_eq!(layout.fields().iter().filter(|other| other.name == field.name).count(), 1);
        }
        assert_eq!(end, 0);
        let direction = |field: &Field| match field.direction {
            Direction::In => 0,
            Direction::Tap => 1,
            Direction::Out => 2,
            Direction::Check => 3,
        };
        assert!(layout.fields().is_sorted_by_key(direction));
    }
}

#[test]
fn fragments_with_bits_the_profile_drops_are_refused_and_leave_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let target = directory.path().join("sets");
    let mut fragments = vec![random_fragment("test", 0, &Precision::STANDARD); 3];
    fragments[2].surface.offset[1] = I4F28::from_bits(1);
    let error = export(&info("odd", "standard"), &fragments, &target).unwrap_err();
    assert!(matches!(&error, VectorError::Inexact { index: 2, field, .. } if field == "offset_2"), "{error}");
    assert_eq!(fs::read_dir(&target).unwrap().count(), 0);
}

#[test]
fn sets_without_vectors_or_with_names_that_are_paths_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let fragments = [ReflectionIn::default()];
    assert!(matches!(
        export::<ReflectionIn>(&info("empty", "standard"), &[], directory.path()),
        Err(VectorError::Size { .. })
    ));
    for name in ["", "../up", "a/b", "A", "a b"] {
        let result = export(&info(name, "standard"), &fragments, directory.path());
        assert!(matches!(result, Err(VectorError::Name(_))), "{name}");
    }
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
}

#[test]
fn the_vector_worked_by_hand_in_the_format_description_is_what_the_program_writes() {
    let axis = |axis: usize, value: i32, exponent| {
        let mut mantissa = [I2F30::ZERO; 3];
        mantissa[axis] = I2F30::from_bits(value);
        BlockVector { mantissa, exponent }
    };
    let half = 1 << 29;
    let surface = SurfaceIn {
        normal: axis(2, half, 1),
        view: axis(2, half, 1),
        frame_vectors: [axis(1, half, 1), BlockVector::default()],
        ..SurfaceIn::default()
    };
    let dview = [axis(0, -half, -6), axis(1, half, -6)];
    let fragment = ReflectionIn { surface, dview, edge_texels: 512, ..ReflectionIn::default() };
    let directory = tempfile::tempdir().unwrap();
    export(&info("example", "standard"), &[fragment], directory.path()).unwrap();
    let text = fs::read_to_string(directory.path().join("example_standard.hex")).unwrap();
    let word = text.lines().nth(1).unwrap();
    let format = fs::read_to_string(repository().join("vectors/FORMAT.md")).unwrap();
    // The page breaks the word after each group of fields.
    let page: String =
        format.split_once("```text\n").unwrap().1.split_once("```").unwrap().0.split_whitespace().collect();
    assert_eq!(page, word);
}

#[test]
fn the_format_description_has_the_tables_that_the_declarations_make() {
    let page = fs::read_to_string(repository().join("vectors/FORMAT.md")).unwrap();
    // No assert_eq: it would print the page.
    let is_right = in_page(&page).is_ok_and(|again| again == page);
    assert!(is_right, "run `roughxel vectors format --write vectors/FORMAT.md`");
}

#[test]
fn the_format_command_prints_the_tables_or_puts_them_into_a_page() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("page.md");
    let write = || roughxel(&["vectors", "format", "--write", path.to_str().unwrap()]);
    let printed = roughxel(&["vectors", "format"]);
    assert_eq!((printed.status.code(), String::from_utf8(printed.stdout).unwrap()), (Some(0), tables()));

    let committed = fs::read_to_string(repository().join("vectors/FORMAT.md")).unwrap();
    let (before, rest) = committed.split_once("-->\n").unwrap();
    let (_, after) = rest.split_once("<!--").unwrap();
    fs::write(&path, format!("{before}-->\nwhat was there\n<!--{after}")).unwrap();
    assert_eq!(write().status.code(), Some(0));
    assert!(fs::read_to_string(&path).unwrap() == committed);

    for page in ["no marks", &format!("{before}-->\n"), &committed.repeat(2)] {
        fs::write(&path, page).unwrap();
        let output = write();
        assert_eq!(output.status.code(), Some(1));
        assert!(String::from_utf8_lossy(&output.stderr).contains("page.md"));
        assert!(fs::read_to_string(&path).unwrap() == page);
    }
}

/// The fields that the tables have for a datapath, in their order.
fn in_tables(datapath: Datapath) -> Vec<String> {
    let tables = tables();
    let table = tables.split_once(&format!("`{}`", datapath.name())).unwrap().1;
    let rows = table.lines().skip_while(|line| !line.starts_with("| `")).take_while(|line| line.starts_with('|'));
    let mut names = Vec::new();
    for row in rows {
        let mut stem = String::new();
        for part in row.split('|').nth(1).unwrap().split(['`', ' ', '(', ')', ',']).filter(|part| !part.is_empty()) {
            if part.starts_with('_') {
                names.push(format!("{stem}{part}"));
            } else {
                stem = part.rsplit_once('_').map_or("", |(stem, _)| stem).into();
                names.push(part.into());
            }
        }
    }
    names
}

#[test]
fn every_field_of_every_set_is_in_the_tables_and_in_their_order() {
    for datapath in Datapath::ALL {
        let listed = in_tables(datapath);
        for frame in [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised] {
            for roughness in [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic] {
                for on in 0..16 {
                    let [bump, curvature, horizon] = [0, 1, 3].map(|bit| on >> bit & 1 == 1);
                    let footprint = if on >> 2 & 1 == 1 { FootprintKind::Face } else { FootprintKind::None };
                    let horizon = if horizon { HorizonKind::Correlated } else { HorizonKind::None };
                    let effects = Effects { bump, frame, roughness, curvature, footprint, horizon };
                    if effects != effects.of(datapath) {
                        continue;
                    }
                    let layout = Layout::new(datapath, &effects, &Precision::COMPACT, true);
                    let mut rest = listed.iter();
                    for field in layout.fields().iter().filter(|field| field.direction != Direction::Check) {
                        assert!(rest.any(|name| *name == field.name), "{}: {effects:?}", field.name);
                    }
                }
            }
        }
    }
}

#[test]
fn the_committed_smoke_sets_verify() {
    let [smoke, stages] = ["vectors/smoke", "vectors/smoke/stages"].map(|folder| repository().join(folder));
    let output = roughxel(&["vectors", "verify", smoke.to_str().unwrap(), stages.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn the_smoke_command_writes_the_committed_sets() {
    // Grades are written behind it.
    let without_grade = |name: &str, bytes: Vec<u8>| {
        if !name.ends_with(".json") {
            return bytes;
        }
        let mut manifest: Value = serde_json::from_slice(&bytes).unwrap();
        manifest.as_object_mut().unwrap().remove("grade");
        manifest.to_string().into_bytes()
    };
    writes_what_is_committed(&["vectors", "export", "--smoke"], "vectors/smoke", without_grade);
}

#[test]
fn the_committed_sets_say_how_good_they_are() {
    let committed = repository().join("vectors/smoke");
    let directory = tempfile::tempdir().unwrap();
    let folders = [committed.clone(), committed.join("stages")];
    let manifests: Vec<PathBuf> = folders.iter().flat_map(|folder| manifests_in(folder).unwrap()).collect();
    let name = |path: &PathBuf| path.file_stem().unwrap().to_str().unwrap().to_owned();
    // Random sets and hard cases of each datapath.
    let sample = [
        "random_narrow",
        "chosen_highlight_narrow",
        "random_peak_compact",
        "cube_edges_standard",
        "entries_cube_face_standard",
    ];
    let is_all = std::env::var_os("ROUGHXEL_SWEEP").is_some();
    let wanted = |path: &&PathBuf| is_all || sample.contains(&name(path).as_str());
    let manifests: Vec<&PathBuf> = manifests.iter().filter(wanted).collect();
    assert!(manifests.len() >= sample.len());
    for path in &manifests {
        for extension in ["hex", "json"] {
            let file = format!("{}.{extension}", name(path));
            fs::copy(path.with_extension(extension), directory.path().join(&file)).unwrap();
        }
    }
    let output = roughxel(&["vectors", "report", directory.path().to_str().unwrap(), "--write"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    for path in manifests {
        let name = name(path);
        let [theirs, ours] = [path, &directory.path().join(format!("{name}.json"))].map(|path| fs::read(path).unwrap());
        assert!(theirs == ours, "{name}: run `roughxel vectors report vectors/smoke vectors/smoke/stages --write`");
        assert!(Manifest::read(path).unwrap().grade.is_some());
    }
    let output = roughxel(&["vectors", "verify", directory.path().to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn the_rom_command_writes_the_committed_tables() {
    writes_what_is_committed(&["vectors", "rom"], "vectors/rom", |_, bytes| bytes);
}

/// Runs a command with `-o`: it has to write the files of a folder of the repository and of the folders in it, as far as `compared` leaves of them,
/// and no others.
fn writes_what_is_committed(arguments: &[&str], folder: &str, compared: impl Fn(&str, Vec<u8>) -> Vec<u8>) {
    let directory = tempfile::tempdir().unwrap();
    let output = roughxel(&[arguments, &["-o", directory.path().to_str().unwrap()]].concat());
    assert_eq!(output.status.code(), Some(0));
    let files = |path: &Path| -> Vec<PathBuf> {
        let inside = |folder: &Path| -> Vec<PathBuf> {
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
        };
        let (folders, mut files): (Vec<_>, Vec<_>) = inside(path).into_iter().partition(|path| path.is_dir());
        files.extend(folders.iter().flat_map(|folder| inside(folder)));
        let mut names: Vec<_> = files.iter().map(|file| file.strip_prefix(path).unwrap().to_owned()).collect();
        names.sort();
        names
    };
    let committed = repository().join(folder);
    assert_eq!(files(directory.path()), files(&committed));
    for name in files(&committed) {
        // No assert_eq: it would print the files.
        let [theirs, ours] = [&committed, directory.path()]
            .map(|at| compared(name.to_str().unwrap(), fs::read(at.join(&name)).unwrap()));
        let same = theirs == ours;
        assert!(same, "{name:?}: run `roughxel {} -o {folder}`", arguments.join(" "));
    }
}

#[test]
fn the_program_ends_with_3_on_a_mismatch_and_1_on_a_broken_file() {
    let set = Set::random(2);
    let path = set.directory.path().to_str().unwrap();
    assert_eq!(roughxel(&["vectors", "verify", path]).status.code(), Some(0));
    let mut words = set.words();
    let field = set.manifest.fields.iter().find(|field| field.name == "frame_vectors_0_z").unwrap();
    words[1].flip(field.lsb as usize + 5);
    set.write_words(&words);
    let output = roughxel(&["vectors", "verify", path]);
    let report = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(report.contains("random #1 (line 3): stage input, field frame_vectors_0_z, bit 5"), "{report}");

    fs::write(set.hex(), "// nothing\n").unwrap();
    assert_eq!(roughxel(&["vectors", "verify", path]).status.code(), Some(1));
    fs::remove_file(set.json()).unwrap();
    let output = roughxel(&["vectors", "verify", path]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("random_standard.json: missing"));
}

fn roughxel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_roughxel")).args(arguments).output().unwrap()
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
