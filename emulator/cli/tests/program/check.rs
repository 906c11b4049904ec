//! `vectors check` and `vectors ambiguous` as their users see them.

use super::fixture::{Folder, words};

#[test]
fn check_and_ambiguous_end_with_the_documented_codes() {
    let at = Folder::new();
    at.done("vectors export random footprint_rank --count 12 --profile narrow -o sets");
    let words = words(&at.join("sets/random_narrow.hex"));
    let mut words: Vec<String> = words.iter().map(|line| line.replace('_', "").to_uppercase()).collect();
    at.write("right.hex", words.join("\n") + "\n");
    for (tier, says) in [
        ("exact", "random (narrow): 12 vectors\nexact    12 of 12\n"),
        ("faithful", "random (narrow): 12 vectors\nexact    12 of 12\nfaithful 12 of 12\n"),
        (
            "bound --places 2",
            "random (narrow): 12 vectors\nexact    12 of 12\nbound    12 of 12, roundings 2 last places off\n",
        ),
    ] {
        assert_eq!(at.done(&format!("vectors check right.hex --set sets/random_narrow --tier {tier}")).out, says);
    }

    // Changes the highest digit of some outcome, and the check value, which may be anything.
    let place = words[3].len() - 20;
    let digit = if words[3].as_bytes()[place] == b'5' { "6" } else { "5" };
    words[3].replace_range(place..=place, digit);
    let end = words[4].len() - 8;
    words[4].replace_range(end.., "00000000");
    at.write("wrong.hex", words.join("\n") + "\n");
    for tier in ["exact", "faithful", "bound"] {
        let run = at.run(&format!("vectors check wrong.hex --set sets/random_narrow.json --tier {tier}")).ends(3);
        run.prints(&["exact    11 of 12", "  random #3 (line 4): stage "])
            .complains(&["mismatch: 1 of 12 vectors are not "]);
    }
    let run = at.run("vectors check wrong.hex --set sets/random_narrow --json --tier bound").ends(3);
    run.prints(&["\"passing\": 11", "\"places\": 1"]);

    // Next to a threshold, both counts are right for a device with other roundings.
    let run = at.done("vectors ambiguous sets/footprint_rank_narrow -o ambiguous.hex").prints(&["#0: probes"]);
    assert!(run.out.starts_with("footprint_rank (narrow): "), "{}", run.out);
    let ambiguous = at.read("ambiguous.hex");
    let lines: Vec<&str> = ambiguous.lines().collect();
    assert_eq!(lines[0], "// footprint_rank narrow: 1 where decisions may be others, roundings 1 last places off");
    assert_eq!(lines[1..3], ["1", "0"]);
    assert!(lines[1..].iter().all(|line| ["0", "1"].contains(line)));
    at.done("vectors ambiguous sets/footprint_rank_narrow --json").prints(&["\"fields\""]);

    at.write("short.hex", &words[0]);
    at.refuses(&[
        ("vectors check short.hex --set sets/random_narrow", 1, "fewer words than the set, which has 12"),
        ("vectors check none.hex --set sets/random_narrow", 1, "none.hex"),
        ("vectors check right.hex --set sets", 2, "name one of its sets"),
        ("vectors check right.hex --set sets/random_narrow --places 0", 2, "--places"),
        ("vectors check right.hex --set sets/footprint_rank_narrow", 1, "right.hex: fewer words than the set"),
        ("vectors ambiguous sets/random_narrow -o none/ambiguous.hex", 1, "none"),
    ]);
}
