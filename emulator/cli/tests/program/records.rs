//! Golden vectors as byte records: the same words as in text.

use std::fs;
use std::path::Path;

use roughxel_core::plan::Datapath;
use roughxel_core::precision::Profile;
use roughxel_vectors::{
    Cause, Direction, Form, Manifest, SetInfo, VectorError, Words, export_with, random_set, verify,
};

use super::fixture::{Folder, words};
use super::vectors::info;

/// Vectors of [`both_forms`]: two whole groups of words that are assembled at once, and a part of a group.
const BOTH_FORMS: u64 = 140;

/// Exports the same vectors in two forms, with or without taps, in separate directories.
fn both_forms(datapath: Datapath, profile: &str, taps: bool) -> [(Folder, Manifest); 2] {
    [Form::Hex, Form::Bin].map(|form| {
        let directory = Folder::new();
        let info = SetInfo { datapath, words: Words { taps, form }, ..info("random", profile) };
        let input = |index| random_set(datapath, "test", index, &info.precision);
        let manifest = export_with(&info, BOTH_FORMS, &input, directory.path(), &|_| {}).unwrap();
        (directory, manifest)
    })
}

/// Records are written in pieces of 16 bytes, the last piece first. Here a piece is longer than a record.
#[test]
fn records_shorter_than_a_piece_are_the_digits_of_the_words() {
    let directory = Folder::new();
    for form in ["", "--bin"] {
        directory.done(&format!("vectors export random --stage enter_offset --count 100 --profile narrow -o . {form}"));
    }
    let name = directory.join("random_enter_offset_narrow");
    let lines = padded_words(&name.with_extension("hex"));
    assert!(lines.len() == 100 && lines[0].len() < 32, "{} of {}", lines.len(), lines[0]);
    assert_eq!(lines.concat(), digits(&name.with_extension("bin")));
}

#[test]
fn records_are_the_digits_of_the_words_and_verify() {
    let (mut odd, mut taps_left_out) = (0, 0);
    for datapath in Datapath::ALL {
        for profile in Profile::ALL.map(Profile::name) {
            for taps in [true, false] {
                let [(text, hex), (bytes, bin)] = both_forms(datapath, profile, taps);
                let path = |directory: &Folder, manifest: &Manifest| directory.join(&manifest.files[0].name);
                let lines = padded_words(&path(&text, &hex));
                assert_eq!(lines.concat(), digits(&path(&bytes, &bin)), "{} {profile}", datapath.name());
                assert_eq!(hex.fields, bin.fields);
                assert_eq!(hex.fields.iter().any(|field| field.direction == Direction::Tap), taps);
                odd += u32::from(bin.word_bits % 8 == 4);
                taps_left_out += u32::from(!taps);
                for (directory, manifest) in [(&text, &hex), (&bytes, &bin)] {
                    let result = verify(&directory.join(&format!("random_{profile}.json")), &|_| {}).unwrap();
                    assert!(result.passed(), "{} {profile}: {result:?}", datapath.name());
                    assert_eq!(manifest.taps, taps);
                }
            }
        }
    }
    assert!(odd > 0 && taps_left_out > 0, "words of an odd number of digits: {odd}");
}

/// Pads words to an even number of digits.
fn padded_words(path: &Path) -> Vec<String> {
    let padded = |digits: String| if digits.len() % 2 == 1 { format!("0{digits}") } else { digits };
    words(path).iter().map(|line| padded(line.replace('_', ""))).collect()
}

/// Reads a file as hex digits.
fn digits(path: &Path) -> String {
    fs::read(path).unwrap().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn a_flipped_bit_of_a_record_is_located_and_a_record_cut_short_is_told() {
    let [_, (directory, manifest)] = both_forms(Datapath::Reflection, "standard", true);
    let (bin, json) = (directory.join("random_standard.bin"), directory.join("random_standard.json"));
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
