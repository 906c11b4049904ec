//! `vectors judge` and `vectors marks` as their users see them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// What a command says, in a directory.
fn roughxel(directory: &Path, line: &str) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughxel"));
    let output: Output = command.current_dir(directory).args(line.split_whitespace()).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn judge_and_marks_end_with_the_documented_codes() {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    assert_eq!(roughxel(at, "vectors export random footprint_rank --count 12 --profile narrow -o sets").0, Some(0));
    let words = fs::read_to_string(at.join("sets/random_narrow.hex")).unwrap();
    let mut words: Vec<String> = words.lines().skip(1).map(|line| line.replace('_', "").to_uppercase()).collect();
    fs::write(at.join("right.hex"), words.join("\n") + "\n").unwrap();
    for (tier, says) in [
        ("exact", "random (narrow): 12 vectors\nexact    12 of 12\n"),
        ("faithful", "random (narrow): 12 vectors\nexact    12 of 12\nfaithful 12 of 12\n"),
        (
            "bound --places 2",
            "random (narrow): 12 vectors\nexact    12 of 12\nbound    12 of 12, roundings 2 last places off\n",
        ),
    ] {
        let (code, text, message) =
            roughxel(at, &format!("vectors judge right.hex --set sets/random_narrow --tier {tier}"));
        assert_eq!((code, text.as_str()), (Some(0), says), "{message}");
    }

    // The highest digit of some outcome, and the check value, which is the device's own business.
    let place = words[3].len() - 20;
    let digit = if words[3].as_bytes()[place] == b'5' { "6" } else { "5" };
    words[3].replace_range(place..=place, digit);
    let end = words[4].len() - 8;
    words[4].replace_range(end.., "00000000");
    fs::write(at.join("wrong.hex"), words.join("\n") + "\n").unwrap();
    for tier in ["exact", "faithful", "bound"] {
        let (code, text, message) =
            roughxel(at, &format!("vectors judge wrong.hex --set sets/random_narrow.json --tier {tier}"));
        assert_eq!(code, Some(3), "{message}");
        assert!(text.contains("exact    11 of 12") && text.contains("  random #3 (line 4): stage "), "{text}");
        assert!(message.contains("mismatch: 1 of 12 vectors are not "), "{message}");
    }
    let (code, text, _) = roughxel(at, "vectors judge wrong.hex --set sets/random_narrow --json --tier bound");
    assert!(code == Some(3) && text.contains("\"passing\": 11") && text.contains("\"places\": 1"), "{text}");

    // Both counts beside a threshold are as right as each other, to a device that rounds otherwise.
    let (code, text, message) = roughxel(at, "vectors marks sets/footprint_rank_narrow -o marks.hex");
    assert_eq!(code, Some(0), "{message}");
    assert!(text.starts_with("footprint_rank (narrow): ") && text.contains("#0: probes"), "{text}");
    let marks = fs::read_to_string(at.join("marks.hex")).unwrap();
    let lines: Vec<&str> = marks.lines().collect();
    assert_eq!(lines[0], "// footprint_rank narrow: 1 where decisions may be others, roundings 1 last places off");
    assert_eq!(lines[1..3], ["1", "0"]);
    assert!(lines[1..].iter().all(|line| ["0", "1"].contains(line)));
    let (_, text, _) = roughxel(at, "vectors marks sets/footprint_rank_narrow --json");
    assert!(text.contains("\"fields\""), "{text}");

    fs::write(at.join("short.hex"), &words[0]).unwrap();
    for (line, code, says) in [
        ("vectors judge short.hex --set sets/random_narrow", 1, "fewer words than the set, which has 12"),
        ("vectors judge none.hex --set sets/random_narrow", 1, "none.hex"),
        ("vectors judge right.hex --set sets", 2, "name one of its sets"),
        ("vectors judge right.hex --set sets/random_narrow --places 0", 2, "--places"),
        ("vectors judge right.hex --set sets/footprint_rank_narrow", 1, "right.hex: fewer words than the set"),
        ("vectors marks sets/random_narrow -o none/marks.hex", 1, "none"),
    ] {
        let (found, _, message) = roughxel(at, line);
        assert_eq!(found, Some(code), "{line}: {message}");
        assert!(message.contains(says), "{line}: {message}");
    }
}
