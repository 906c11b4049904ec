//! Golden vectors: written sets verify, and every change is found.

use std::path::PathBuf;

use fixed::types::I4F28;
use roughxel_cases::random_fragment;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::{Precision, Profile};
use roughxel_vectors::{
    Cause, Direction, Field, Layout, Manifest, Mismatch, SetInfo, VectorError, Verification, export, export_with,
    hard_sets, random_set, verify,
};

use super::fixture::{Folder, words};

pub(super) fn info<'a>(name: &'a str, profile: &'a str) -> SetInfo<'a> {
    let precision = Profile::by_name(profile).unwrap().precision();
    SetInfo::new(name, Datapath::Reflection, Effects::ALL, profile, precision)
}

const HEX: &str = "random_standard.hex";
const JSON: &str = "random_standard.json";

/// A set of `count` random vectors under `standard` in its own directory.
struct Set {
    directory: Folder,
    manifest: Manifest,
}

impl Set {
    fn random(count: u64) -> Self {
        Self::export(Datapath::Reflection, count)
    }

    fn export(datapath: Datapath, count: u64) -> Self {
        let directory = Folder::new();
        let info = SetInfo { datapath, ..info("random", "standard") };
        let input = |index| random_set(datapath, "test", index, &Precision::STANDARD);
        let manifest = export_with(&info, count, &input, directory.path(), &|_| {}).unwrap();
        Self { directory, manifest }
    }

    fn json(&self) -> PathBuf {
        self.directory.join(JSON)
    }

    fn words(&self) -> Vec<Word> {
        words(&self.directory.join(HEX)).iter().map(|line| Word::parse(line)).collect()
    }

    fn write_words(&self, words: &[Word]) {
        let lines: String = words.iter().map(|word| word.line() + "\n").collect();
        self.directory.write(HEX, format!("// changed\n{lines}"));
    }

    fn field(&self, name: &str) -> &Field {
        self.manifest.fields.iter().find(|field| field.name == name).unwrap()
    }

    /// Verifies the set and returns the problem.
    fn problem(&self) -> String {
        self.verify().unwrap_err().to_string()
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

/// A word as FORMAT.md describes it, read independently of the program: digits and field lengths.
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

    /// Computes the CRC-32 of all but the last eight digits, bit by bit.
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
    // One run changes as many vectors as `verify` describes.
    const TOGETHER: usize = 10;
    for set in Datapath::ALL.map(|datapath| Set::export(datapath, TOGETHER as u64 + 2)) {
        let words = set.words();
        // Every bit of the field's digits is flipped, bits above its width included.
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
        let (field, status) = (set.field(name), set.field("status"));
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
    words[1].flip(set.field("lod").lsb as usize);
    words[1].flip(set.field("reflected_x").lsb as usize + 1);
    set.write_words(&words);
    let mismatch = set.only_mismatch();
    assert_eq!((mismatch.index, mismatch.stage.as_str(), mismatch.cause), (1, "reflect", Cause::Damaged));
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
    let good = set.directory.read(HEX);
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
        set.directory.write(HEX, text);
        let message = set.problem();
        assert!(message.contains("random_standard.hex:") && message.contains(problem), "{message}");
    }
    let short = lines[..3].join("\n") + "\n";
    let long = format!("{good}{word}\n");
    for (text, found) in [(short, "2 vectors, but the manifest says 3"), (long, "4 vectors, but the manifest says 3")] {
        set.directory.write(HEX, text);
        assert!(set.problem().contains(found), "{}", set.problem());
    }
    std::fs::remove_file(set.directory.join(HEX)).unwrap();
    assert!(set.problem().contains(HEX));
}

#[test]
fn broken_manifests_are_refused_with_the_reason() {
    let set = Set::random(2);
    let good = set.directory.read(JSON);
    let cases = [
        (good[..good.len() / 2].to_string(), "no vector manifest"),
        ("{}".into(), "missing field `schema`"),
        (good.replacen("roughxel-vectors", "other", 1), "schema `other` is unknown"),
        (good.replacen("\"format_version\": 3", "\"format_version\": 2", 1), "format version 2 is unknown"),
        (good.replacen("\"reflection\"", "\"refraction\"", 1), "unknown variant `refraction`"),
        (good.replacen("\"datapath\": \"reflection\"", "\"datapath\": \"highlight\"", 1), "does not have are on"),
        (good.replacen("\"horizon\": \"none\"", "\"horizon\": \"correlated\"", 1), "does not have are on"),
        (good.replacen("\"curvature\": true", "\"curvature\": false", 1), "`dnormal_0_x`"),
        (good.replacen("\"name\": \"standard\"", "\"name\": \"Best\"", 1), "`Best` is not a profile name"),
        (good.replacen("\"fraction_bits\": 20", "\"fraction_bits\": 21", 1), "other knobs"),
        (good.replacen("\"fraction_bits\": 20", "\"fraction_bits\": 99", 1), "fraction_bits is out of its range"),
        (good.replacen("\"count\": 2", "\"count\": 0", 1), "count 0"),
        (good.replacen("\"count\": 2", "\"count\": \"two\"", 1), "broken manifest"),
        (good.replacen("\"normal_x\"", "\"normal_w\"", 1), "`normal_w`"),
        (good.replacen("\"width\": 22", "\"width\": 21", 1), "field `normal_x` has a different layout"),
        (good.replacen("random_standard.hex", "../random_standard.hex", 1), "not a plain name"),
        (" ".repeat(2 << 20), "larger than 1 MiB"),
    ];
    for (text, reason) in cases {
        assert_ne!(text, good, "{reason}");
        set.directory.write(JSON, text);
        let message = set.problem();
        assert!(message.contains(JSON) && message.contains(reason), "{reason}: {message}");
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
    assert_eq!(target.read_dir().unwrap().count(), 0);
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
    assert_eq!(directory.path().read_dir().unwrap().count(), 0);
}

#[test]
fn the_program_ends_with_3_on_a_mismatch_and_1_on_a_broken_file() {
    let set = Set::random(2);
    set.directory.done("vectors verify .");

    let mut words = set.words();
    words[1].flip(set.field("frame_vectors_0_z").lsb as usize + 5);
    set.write_words(&words);
    let place = "random #1 (line 3): stage input, field frame_vectors_0_z, bit 5";
    set.directory.run("vectors verify .").ends(3).prints(&[place]);

    set.directory.write(HEX, "// nothing\n");
    set.directory.run("vectors verify .").ends(1);
    std::fs::remove_file(set.json()).unwrap();
    set.directory.run("vectors verify .").ends(1).complains(&["random_standard.json: missing"]);
}
