//! Profile files: keys, faults, and their use by every command.

use std::fs;
use std::path::Path;
use std::process::Command;

use roughxel_core::knob::Knob;
use roughxel_core::precision::{AxisDirection, Newton, Precision, Profile};
use roughxel_study::profile_file::{
    MAX_PROFILE_BYTES, NamedPrecision, parse_profile, profile_text, read_profile, write_profile,
};
use roughxel_vectors::Manifest;

use super::fixture::{Folder, roughxel};

fn stdout(arguments: &[&str]) -> String {
    roughxel(arguments).ends(0).out
}

fn json(arguments: &[&str]) -> serde_json::Value {
    roughxel(arguments).json()
}

/// Writes a profile file with the knobs of a precision and the name `mine`.
fn file(directory: &Path, precision: Precision) -> String {
    let path = directory.join("a profile.toml");
    write_profile(&path, &NamedPrecision::new("mine", precision).unwrap(), &[]).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Knobs that no named profile has.
const MINE: Precision = Precision {
    fraction_bits: 18,
    direction: AxisDirection::Table { steps: 32 },
    max_probes: 4,
    inverse_root: Newton { seed_bits: 7, steps: 2 },
    ..Precision::COMPACT
};

/// Reads what is wrong with a text, from the line number on.
fn fault(text: &str) -> String {
    parse_profile("x.toml", text).expect_err(text).to_string()
}

#[test]
fn what_is_written_is_read_with_every_knob() {
    let each = Knob::ALL.into_iter().flat_map(|knob| knob.values().iter().map(move |&value| knob.with(value, MINE)));
    for precision in each.chain(Profile::ALL.map(Profile::precision)) {
        let profile = NamedPrecision::new("mine", precision).unwrap();
        let text = profile_text(&profile, &["for a lake\nand \u{7} a bell".into(), String::new()]);
        assert!(text.starts_with("# for a lake\n# and   a bell\nname = \"mine\""), "{text}");
        assert_eq!(parse_profile("x.toml", &text).unwrap(), profile, "{text}");
    }
}

#[test]
fn a_file_gives_the_knobs_that_are_not_those_of_its_base() {
    for (text, precision) in [
        ("", Precision::STANDARD),
        ("max_probes = 0x4\n", Precision { max_probes: 4, ..Precision::STANDARD }),
        (
            "base = \"paper\"\ndirection = \"exact\"\n",
            Precision { direction: AxisDirection::Exact, ..Precision::PAPER },
        ),
        ("direction = { table = 10 }\nbase = \"precise\"\n", {
            Precision { direction: AxisDirection::Table { steps: 10 }, ..Precision::PRECISE }
        }),
        ("[reciprocal]\nsteps = 0\n", {
            Precision { reciprocal: Newton { seed_bits: 10, steps: 0 }, ..Precision::STANDARD }
        }),
    ] {
        let profile = parse_profile("far/My lake.toml", text).unwrap();
        assert_eq!((profile.name.as_str(), profile.precision), ("my_lake", precision), "{text}");
    }
    assert_eq!(parse_profile("compact.toml", "base = \"compact\"").unwrap(), Profile::Compact.into());
}

#[test]
fn every_knob_out_of_its_range_names_itself_its_value_and_its_range() {
    for knob in Knob::ALL {
        let values: &[&str] = match knob {
            Knob::Direction => &["{ table = 0 }", "{ table = 3 }", "{ table = 66 }", "{ table = -2 }", "\"about\""],
            _ if !knob.choices().is_empty() => &["\"most\"", "\"\""],
            _ => &["99", "-1", "4294967298", "99999999999999999999"],
        };
        for value in values {
            let text = format!("# a comment\n{} = {value}", knob.name());
            let message = fault(&text);
            let number = value.trim_matches(|c| "{} table=".contains(c));
            for part in ["x.toml:2:", &format!("`{knob}"), &format!("is {number}, which"), knob.range()] {
                assert!(message.contains(part), "{text}: {message} misses {part}");
            }
        }
    }
}

#[test]
fn bad_files_name_line_column_and_remedy() {
    for (text, expected) in [
        ("fraction_bits = ", "x.toml:1:17: "),
        ("\nfraction_bit = 18", "x.toml:2:1: unknown key `fraction_bit` (did you mean `fraction_bits`?)"),
        (
            "reciprocal.seedbits = 8",
            "x.toml:1:12: unknown key `reciprocal.seedbits` (did you mean `reciprocal.seed_bits`?)",
        ),
        ("colour = 3", "unknown key `colour` (known are name, base, direction.table, fraction_bits"),
        ("reciprocal = 8", "x.toml:1:14: `reciprocal` has parts (give reciprocal.seed_bits, reciprocal.steps)"),
        (
            "fraction_bits = \"18\"",
            "x.toml:1:17: `fraction_bits` is \"18\", of the wrong type (string) (choose 12 to 28)",
        ),
        ("lod_bits = 8.0", "of the wrong type (float) (choose 2 to 12)"),
        ("direction = 10", "of the wrong type (integer) (choose exact, or a table of"),
        ("probe_rule = 1", "of the wrong type (integer) (choose power_of_two or ceiling)"),
        ("max_probes = 2\nmax_probes = 3", "duplicate key"),
        ("base = \"standart\"", "x.toml:1:8: no named profile `standart` (did you mean `standard`?)"),
        ("base = \"mine\"", "(choose narrow, paper, compact, standard, precise)"),
        ("base = 3", "`base` is 3, of the wrong type"),
        ("name = \"../etc\"", "x.toml:1:8: `../etc` is not a profile name"),
        ("name = \"\"", "choose 1 to 40 lower-case letters, digits and underscores"),
        ("name = \"standard\"\nlod_bits = 7", "x.toml:1:8: profile `standard` has other knobs"),
        // The first fault is that of the text, not of the table.
        ("weight_bits = 1\nfraction_bits = 1", "x.toml:1:15: `weight_bits`"),
    ] {
        assert!(fault(text).contains(expected), "{text}: {}", fault(text));
    }
    let text = profile_text(&NamedPrecision::new("mine", MINE).unwrap(), &[]);
    for end in (0..text.len()).filter(|&end| text.is_char_boundary(end)) {
        // The result is an error or a profile, never a panic.
        let _ = parse_profile("cut.toml", &text[..end]);
    }
}

#[test]
fn files_that_are_no_profiles_end_with_1_and_misspelt_names_with_2() {
    let directory = Folder::new();
    let path = |name: &str| directory.file(name);
    fs::write(path("large.toml"), " ".repeat(MAX_PROFILE_BYTES as usize + 1)).unwrap();
    fs::write(path("binary.toml"), [0xff, 0xfe]).unwrap();
    fs::write(path("wrong.toml"), "max_probes = 17\n").unwrap();
    assert!(Command::new("mkfifo").arg(path("pipe.toml")).status().unwrap().success());
    for (name, expected) in [
        ("no-such.toml", "cannot read the profile file"),
        ("", "is no regular file"),
        ("pipe.toml", "is no regular file"),
        ("large.toml", "larger than 1 MiB"),
        ("binary.toml", "is not UTF-8 text"),
        ("wrong.toml", "wrong.toml:1:14: `max_probes` is 17, which is out of range"),
    ] {
        roughxel(&["cost", "--profile", &path(name)]).ends(1).complains(&[expected]);
    }
    for (name, expected) in [("standart", "did you mean `standard`?"), ("mine", "or a file")] {
        roughxel(&["render", "lake", "--profile", name]).ends(2).complains(&[expected]);
    }
}

#[test]
fn a_named_profile_is_a_file_with_its_knobs_bit_for_bit() {
    let directory = Folder::new();
    let path = |name: &str| directory.file(name);
    for profile in Profile::ALL {
        let mine = file(directory.path(), profile.precision());
        let digest = |of: &str| {
            let arguments = ["render", "globe", "--size", "24x18", "--json", "-o", &path("x.png"), "--profile", of];
            json(&arguments)["digest"].clone()
        };
        assert_eq!(digest(&mine), digest(profile.name()), "{profile:?}");
        let words = |of: &str, name: &str| {
            stdout(&["vectors", "export", "random", "--count", "50", "-o", &path("sets"), "--profile", of]);
            let text = fs::read_to_string(path(&format!("sets/random_{name}.hex"))).unwrap();
            text.split_once('\n').unwrap().1.to_owned()
        };
        assert!(words(&mine, "mine") == words(profile.name(), profile.name()), "{profile:?}");
    }
}

#[test]
fn every_command_carries_a_profile_file_through() {
    let directory = Folder::new();
    let path = |name: &str| directory.file(name);
    let mine = &file(directory.path(), MINE);

    let sets = &path("sets");
    stdout(&["vectors", "export", "random", "random_peak", "--count", "20", "-o", sets, "--profile", mine]);
    let size = ["--size", "24x18"];
    stdout(&[&["render", "globe", "-o", &path("x.png"), "--capture", sets, "--profile", mine], &size[..]].concat());
    for name in ["random_mine", "random_peak_mine", "frame_globe_0_mine"] {
        let manifest = Manifest::read(&Path::new(sets).join(format!("{name}.json"))).unwrap();
        assert_eq!((manifest.profile.name.as_str(), manifest.profile.knobs), ("mine", MINE));
    }
    let verified = json(&["vectors", "verify", sets, "--json"]);
    assert!(verified["sets"].as_array().unwrap().iter().all(|set| set["passed"] == true), "{verified}");

    let hardware = path("hardware");
    stdout(&["verilog", "--design", "levels", "-o", &hardware, "--profile", mine]);
    let text = |name: &str| fs::read_to_string(Path::new(&hardware).join(name)).unwrap();
    assert!(text("roughxel_levels.v").contains("profile mine"));
    let manifest: serde_json::Value = serde_json::from_str(&text("roughxel_levels.json")).unwrap();
    assert_eq!(manifest["profile"], "mine");
    for knob in Knob::ALL {
        let setting = knob.text(knob.value_in(&MINE)).to_string();
        assert_eq!(manifest["knobs"][knob.name()].to_string().trim_matches('"'), setting, "{knob}");
    }

    let header = &path("one.csv");
    fs::write(header, "nx,ny,nz,vx,vy,vz,dv_dx_x,dv_dy_y\n0.1,0.2,1,0.3,0.1,1,0.2,0.01\n").unwrap();
    let probes = |profile: &str| json(&["eval", header, "--json", "--profile", profile])[0]["probes"].clone();
    assert_eq!((probes(mine), probes("standard")), (4.into(), 16.into()));

    let gallery = ["gallery", "--scene", "lake", "--samples", "1", "-o", &path("gallery"), "--profile", mine, "--json"];
    assert_eq!(json(&[&gallery[..], &size].concat())["profile"], "mine");
    assert_eq!(json(&["plan", "lake", "--json", "--profile", mine])["profile"], "mine");
    for (of, name) in [(mine.as_str(), "mine"), ("standard", "standard")] {
        let small = ["--random", "10", "--size", "16x12", "--json", "--profile", of];
        assert_eq!(json(&[&["ranges"], &small[..]].concat())[0]["profile"], name);
        assert_eq!(json(&["report", "accuracy", "--fragments", "10", "--json", "--profile", of])[0]["profile"], name);
        let cost = stdout(&["cost", "--design", "levels", "--profile", of]);
        assert!(cost.lines().nth(2).unwrap().contains(name), "{cost}");
    }
    let demo = ["demo", "-o", &path("demo"), "--json", "--profile", mine];
    assert_eq!(json(&[&demo[..], &size].concat())["accuracy"]["profile"], "mine");
}

#[test]
fn the_page_has_a_row_for_every_knob_and_its_example_is_a_profile() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../profiles.md")).unwrap();
    for knob in Knob::ALL {
        let mut rows = page.lines().filter(|line| line.starts_with(&format!("| `{knob}` |")));
        assert!(rows.next().is_some_and(|row| row.ends_with(&format!("| {} |", knob.range()))), "{knob}");
    }
    let example = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let directory = Folder::new();
    directory.write("x.toml", example);
    assert_eq!(read_profile(&directory.join("x.toml")).unwrap().name, "lake_40db");
}
