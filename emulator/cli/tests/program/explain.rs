//! `vectors explain`: one vector next to float64, and where a device's word first goes wrong.

use std::collections::HashMap;
use std::fs;
use std::path::PathBuf;

use glam::DVec3;
use roughxel_study::accuracy::{CANCELLATION, Figure};
use roughxel_vectors::{Direction, Explained, Explanation, Manifest, Real, Vector};
use serde_json::Value;

use super::fixture::{self, Folder, Run, repository, roughxel};

const RANDOM: [&str; 3] = ["random", "random_highlight", "random_peak"];

fn smoke(set: &str) -> PathBuf {
    repository().join("vectors/smoke").join(set)
}

fn manifest(set: &str) -> PathBuf {
    smoke(&format!("{set}.json"))
}

fn explanation(set: &str, index: u64) -> Explanation {
    Vector::read(&manifest(set), index).unwrap().explain(None)
}

fn field<'a>(explanation: &'a Explanation, name: &str) -> &'a Explained {
    explanation.fields.iter().find(|field| field.field == name).unwrap()
}

/// Error of a field in its unit, if there is one.
fn error(explanation: &Explanation, name: &str) -> Option<f64> {
    let Explained { real, float64, .. } = field(explanation, name);
    Some((real.value()? - (*float64)?.value()?).abs())
}

/// Reads the number after a text in the note of a decision.
fn noted(explanation: &Explanation, what: &str, before: &str) -> f64 {
    let note = &explanation.decisions.iter().find(|decision| decision.what == what).unwrap().note;
    let rest = note.split_once(before).unwrap().1;
    rest.split([' ', ',']).next().unwrap().parse().unwrap()
}

fn run(arguments: &[&str]) -> Run {
    roughxel(&[&["vectors", "explain"], arguments].concat())
}

/// Reads the words of a committed set.
fn word(set: &str, index: usize) -> String {
    fixture::words(&smoke(&format!("{set}.hex"))).swap_remove(index)
}

/// Makes the argument for a vector of a committed set.
fn at(set: &str, index: u64) -> String {
    format!("{}#{index}", smoke(set).display())
}

/// Flips a bit of a field in a word. The check value stays.
fn flipped(set: &str, index: usize, field: &str, bit: u32) -> String {
    let manifest = Manifest::read(&manifest(set)).unwrap();
    let place = manifest.fields.iter().position(|other| other.name == field).unwrap();
    let word = word(set, index);
    let mut fields: Vec<String> = word.split('_').map(str::to_owned).collect();
    let bits = u32::from_str_radix(&fields[place], 16).unwrap() ^ 1 << bit;
    fields[place] = format!("{bits:0digits$x}", digits = fields[place].len());
    fields.join("_")
}

#[test]
fn every_field_is_explained_in_the_order_of_the_pipeline() {
    for set in RANDOM {
        for profile in ["standard", "compact", "narrow"] {
            let set = format!("{set}_{profile}");
            let manifest = Manifest::read(&manifest(&set)).unwrap();
            for index in 0..16 {
                let explanation = explanation(&set, index);
                assert_eq!(explanation.fields.len(), manifest.fields.len());
                let digits: Vec<String> = word(&set, index as usize).split('_').map(str::to_owned).collect();
                for (ours, digits) in manifest.fields.iter().zip(digits) {
                    let explained = field(&explanation, &ours.name);
                    assert_eq!((&explained.raw, &explained.stage), (&digits, &ours.stage), "{set} #{index}");
                    assert_eq!((explained.lsb, explained.width), (ours.lsb, ours.width));
                    assert!(ours.direction != Direction::In || explained.float64.is_none());
                }
                let mut stages: Vec<&str> = explanation.fields.iter().map(|field| field.stage.as_str()).collect();
                assert_eq!((stages[0], stages[stages.len() - 1]), ("input", "check"));
                stages.dedup();
                // No stage appears twice.
                let count = stages.len();
                stages.sort_unstable();
                stages.dedup();
                assert_eq!(stages.len(), count, "{set} #{index}: {stages:?}");
            }
        }
    }
}

#[test]
fn stages_come_in_the_order_of_the_format_description() {
    let page = fs::read_to_string(smoke("../FORMAT.md")).unwrap();
    let listed = page.split_once("Stages in pipeline order:").unwrap().1.split_once('.').unwrap().0;
    let listed: Vec<&str> = listed.split(',').map(|name| name.split_whitespace().next().unwrap()).collect();
    let directory = Folder::new();
    directory.done("vectors export random --count 1 --effects bump,roughness,curvature,footprint-sphere -o .");
    let sphere = directory.join("random_standard.json");
    for path in RANDOM.map(|set| manifest(&format!("{set}_standard"))).into_iter().chain([sphere]) {
        let explanation = Vector::read(&path, 0).unwrap().explain(None);
        let mut rest = listed.iter();
        let mut stages: Vec<&str> = explanation.fields.iter().map(|field| field.stage.as_str()).collect();
        stages.dedup();
        for stage in &stages[..stages.len() - 1] {
            assert!(rest.any(|listed| listed == stage), "{stage} in {stages:?}, but {listed:?}");
        }
    }
}

#[test]
fn float64_has_every_outcome_of_the_random_sets_but_exponents_and_status() {
    for set in RANDOM.map(|set| format!("{set}_standard")) {
        let mut without: Vec<String> = Vec::new();
        for index in 0..64 {
            let explanation = explanation(&set, index);
            let outcomes = explanation.fields.iter().filter(|f| matches!(f.direction, Direction::Tap | Direction::Out));
            for field in outcomes.filter(|field| !field.field.ends_with("_e") && field.field != "status") {
                if field.float64.is_none() {
                    without.push(format!("#{index} {}", field.field));
                }
            }
        }
        // One random vector in ten has bit patterns, of which some are no footprint, no peak, or point along no axis.
        assert!(without.len() < 64, "{set}: {without:?}");
    }
}

/// Fields of random reflections are tested if they have an accuracy bar, for the fragments that the bar counts.
#[test]
fn errors_against_float64_hold_the_table_of_accuracy() {
    let bar = |figure: Figure| figure.bar("standard").unwrap();
    let (mut places, mut footprints, mut directions) = (0, 0, 0);
    for index in 0..256 {
        let explanation = explanation("random_standard", index);
        let error = |name: &str| error(&explanation, name);
        let of_place = ["st_s", "st_t"].map(|name| error(name).unwrap_or(0.0));
        assert!(of_place.iter().all(|error| *error <= bar(Figure::Coordinates)), "#{index}: {of_place:?}");
        places += i32::from(error("st_s").is_some());

        let real = |name: &str| field(&explanation, name).real.value().unwrap();
        let [normal, e1, e2] = ["normal", "frame_0", "frame_1"]
            .map(|block| DVec3::from_array(["x", "y", "z"].map(|letter| real(&format!("{block}_{letter}")))));
        let length = normal.length();
        if length > 0.0 {
            let products = [e1.dot(e2), e1.dot(normal), e2.dot(normal)].map(|x| x.abs() / (length * length));
            let lengths = [e1, e2].map(|e| (e.length() / length - 1.0).abs());
            let of_frame = products.into_iter().chain(lengths).fold(0.0, f64::max);
            assert!(of_frame <= bar(Figure::Frame), "#{index} frame: {of_frame}");
        }

        let Some(major) = field(&explanation, "major_m").float64.and_then(Real::value) else { continue };
        if major == 0.0 {
            continue;
        }
        let terms = noted(&explanation, "footprint", "its terms are ");
        let conditioned = major * (terms / CANCELLATION).max(1.0);
        let of_major = error("major_m").unwrap() / conditioned;
        assert!(of_major <= bar(Figure::MajorAxis), "#{index} major: {of_major}");
        footprints += 1;
        if terms >= CANCELLATION {
            continue;
        }
        let of_lod = error("lod").unwrap();
        assert!(of_lod <= bar(Figure::LevelOfDetail), "#{index} lod: {of_lod}");
        let ratio = noted(&explanation, "probes", "λ₁/λ₂ is ");
        if ratio >= 1.1 {
            let of_direction = error("direction_s").unwrap().hypot(error("direction_t").unwrap()).to_degrees();
            assert!(of_direction <= bar(Figure::Direction), "#{index} direction: {of_direction}°");
            directions += 1;
        }
        assert!(error("probes") <= Some(1.0), "#{index}: a count differs by one, near its boundary");
    }
    assert!(places > 250 && footprints > 200 && directions > 150, "{places}, {footprints}, {directions}");
}

#[test]
fn lights_are_those_of_float64_within_their_last_places() {
    // The bars of f and of a peak's light are relative to √m and the amplitude. The other fields have a few last places.
    for (set, names) in [
        ("random_highlight_standard", &["normal_mod_x", "rough_1_y", "rough_2_z", "spread_2_x", "amplitude_m"][..]),
        ("random_peak_standard", &["local_light_x", "local_light_z", "local_eye_y", "slopes_0_0", "slopes_1_1"][..]),
    ] {
        let mut counted = 0;
        for index in 0..256 {
            let explanation = explanation(set, index);
            for name in names {
                let Explained { error: Some(error), real, .. } = field(&explanation, name) else { continue };
                // A direction that errs by ε has a slope s that errs by ε(1 + s²).
                let steep = if name.starts_with("slopes") { real.in_units(0).powi(2) } else { 0.0 };
                let error = error.abs() / (1.0 + steep);
                assert!(error < 12.0, "{set} #{index} {name}: {error} last places");
                counted += 1;
            }
        }
        assert!(counted > 1000, "{set}: {counted}");
    }
}

#[test]
fn a_set_without_effects_is_explained_by_the_fields_that_it_has() {
    let directory = Folder::new();
    directory.done("vectors export frame_pole --profile compact --effects none -o .");
    let explanation = Vector::read(&directory.join("frame_pole_compact.json"), 0).unwrap().explain(None);
    assert!(explanation.fields.iter().all(|field| field.stage != "frame" && field.stage != "axes"));
    assert!(field(&explanation, "reflected_x").float64.is_some());
    assert!(explanation.decisions.iter().all(|decision| decision.what == "face"), "{:?}", explanation.decisions);
}

#[test]
fn the_program_prints_every_field_and_the_decisions() {
    let set = smoke("random_standard");
    let expected = explanation("random_standard", 3);
    for arguments in [
        vec![format!("{}#3", set.display())],
        vec![format!("{}.json#3", set.display())],
        vec![format!("{}.hex", set.display()), "--index".into(), "3".into()],
    ] {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let text = run(&arguments).ends(0).out;
        assert!(text.starts_with("random #3 (line 5): reflection, profile standard\n"), "{text}");
        for field in &expected.fields {
            let row = text.lines().find(|line| line.split('┆').nth(1).is_some_and(|cell| cell.trim() == field.field));
            let row = row.unwrap_or_else(|| panic!("{} is missing", field.field));
            assert!(row.contains(&field.raw) && row.contains(&field.stage), "{row}");
        }
        assert!(text.contains("face: -x") && text.contains("status: nothing"), "{text}");
    }
}

#[test]
fn json_has_what_the_table_has() {
    let json = run(&[&at("highlight_horizon_standard", 0), "--json"]).json();
    assert_eq!((&json["hash_matches"], &json["mismatch"]), (&Value::Bool(true), &Value::Null));
    let explanation = &json["explanation"];
    assert_eq!(explanation["status"][0], "light_below_surface");
    let fields = explanation["fields"].as_array().unwrap();
    let named = |name: &str| fields.iter().find(|field| field["field"] == name).unwrap();
    assert_eq!(
        (&named("frame_0_x")["real"], &named("frame_0_x")["float64"]),
        (&(1.0 - 2f64.powi(-19)).into(), &(1.0).into())
    );
    assert_eq!(named("frame_0_x")["error"], -2.0);
    assert_eq!((&named("frame_0_e")["float64"], &named("check")["float64"]), (&Value::Null, &Value::Null));
}

#[test]
fn a_wrong_word_names_the_first_wrong_stage_field_and_bit() {
    for (set, name, stage, bit) in [
        ("random_standard", "normal_x", "input", 3),
        ("random_standard", "frame_1_e", "frame", 15),
        ("random_standard", "columns_2_t", "columns", 7),
        ("random_standard", "lod", "probes", 0),
        ("random_standard", "status", "status", 4),
        ("random_highlight_standard", "f", "highlight", 24),
        ("random_peak_standard", "visibility", "horizon", 9),
    ] {
        let got = flipped(set, 3, name, bit);
        let path = at(set, 3);
        let plain = got.replace('_', "").to_uppercase();
        for got in [&got, &plain] {
            let message = format!("stage {stage}, field {name}, bit {bit}: got ");
            let run = run(&[&path, "--got", got]).ends(3).complains(&[&message]).prints(&["; 1 fields differ"]);
            let text = run.out;
            let marked: Vec<_> = text.lines().filter(|line| line.contains(&format!("┆ bit {bit}"))).collect();
            assert!(marked.len() == 1 && marked[0].contains(name), "{marked:?}");
        }
    }
}

#[test]
fn of_several_wrong_fields_all_are_marked_and_the_earliest_stage_is_named() {
    let vector = Vector::read(&manifest("random_standard"), 7).unwrap();
    let right = vector.explain(None);
    let changed = |name: &str| format!("{name}={:x}", u32::from_str_radix(&field(&right, name).raw, 16).unwrap() ^ 5);
    let parts = [changed("lod"), changed("reflected_y"), format!("face={}", field(&right, "face").raw)];
    let explanation = vector.explain(Some(&vector.device_word(&parts).unwrap()));
    let wrong = explanation.wrong.as_ref().unwrap();
    assert_eq!((wrong.stage.as_str(), wrong.field.as_str(), wrong.bit), ("reflect", "reflected_y", 2));
    assert_eq!((wrong.found ^ wrong.expected, wrong.fields_differing), (5, 2));
    let marked: Vec<_> =
        explanation.fields.iter().filter_map(|f| Some((&f.field[..], f.got.as_ref()?.wrong_bit))).collect();
    assert_eq!(marked, [("reflected_y", Some(2)), ("face", None), ("lod", Some(2))]);
}

#[test]
fn a_right_word_is_right_with_its_own_check_value_or_that_of_the_set() {
    let path = at("random_standard", 9);
    run(&[&path, "--got", &word("random_standard", 9)]).ends(0).prints(&["every field that was given is right"]);
    // A check value that belongs to neither word is the only wrong field.
    let got = flipped("random_standard", 9, "check", 31);
    run(&[&path, "--got", &got]).ends(3).complains(&["stage check, field check, bit 31"]);
    // The format does not extend the sign over the digits.
    let negative = (0..256).find(|&i| field(&explanation("random_standard", i), "st_s").integer < 0).unwrap();
    let got = flipped("random_standard", negative as usize, "st_s", 23);
    let run = run(&[&at("random_standard", negative), "--got", &got]).ends(3);
    run.complains(&["bit 23 (above the field's 22 bits, where all are zero)"]);
}

#[test]
fn bad_sets_and_indices_are_named_with_the_remedy() {
    let (set, folder) = (smoke("random_standard"), smoke(""));
    let (set, folder) = (set.display(), folder.display());
    let cases = [
        (format!("{set}"), 2, "SET --index INDEX"),
        (format!("{set}#x"), 2, "`x` is no index"),
        (format!("{set}#-1"), 2, "`-1` is no index"),
        (format!("{set}#+1"), 2, "`+1` is no index"),
        (format!("{set}#256"), 2, "there is no vector #256; the set has 256, #0 to #255"),
        (format!("{folder}#0"), 2, "is a directory; name one of its sets"),
        (format!("{set}_more#0"), 1, "random_standard_more.json"),
    ];
    for (argument, code, reason) in cases {
        run(&[&argument]).ends(code).complains(&[reason]);
    }
}

#[test]
fn bad_words_are_told_with_the_remedy() {
    let path = at("random_standard", 0);
    let word = word("random_standard", 0);
    let (short, odd) = (word.replace('_', "")[1..].to_owned(), word.replace('_', "").replacen('0', "x", 1));
    let cases: [(&[&str], &str); 13] = [
        (&[""], "0 hex digits, but a word of this set has"),
        (&[&short], "for single fields write FIELD=HEX"),
        (&[&odd], "is no hex digit"),
        (&[&word[1..]], "characters"),
        (&["größe"], "is no hex digit"),
        (&[&word, "face=1"], "a whole word is given once, alone"),
        (&["faces=1"], "did you mean `face`"),
        (&["normal_x=1"], "`normal_x` is an input"),
        (&["check=1"], "belongs to a whole word"),
        (&["face=8"], "not a hex number of the 3 bits"),
        (&["face="], "not a hex number"),
        (&["face=+1"], "not a hex number"),
        (&["face=1", "face=2"], "`face` is given twice"),
    ];
    for (got, reason) in cases {
        let arguments: Vec<&str> = [&path[..]].into_iter().chain(got.iter().flat_map(|&got| ["--got", got])).collect();
        run(&arguments).ends(2).complains(&["--got", reason]);
    }
}

/// Copies a committed set and changes its words.
fn copied(change: impl Fn(&str) -> String) -> Folder {
    let directory = Folder::new();
    fs::copy(manifest("random_standard"), directory.join("random_standard.json")).unwrap();
    directory.write("random_standard.hex", change(&fs::read_to_string(smoke("random_standard.hex")).unwrap()));
    directory
}

#[test]
fn a_damaged_set_is_told_as_verify_tells_it() {
    let good = word("random_standard", 4);
    let bad = flipped("random_standard", 4, "dview_1_z", 2);
    let directory = copied(|text| text.replace(&good, &bad));
    let damage = "random #4 (line 6): stage input, field dview_1_z, bit 2: flipped in the file";
    directory.run("vectors explain random_standard#4").ends(3).complains(&[damage]).prints(&["in the file"]);
    // A device is not compared with a damaged word. Other words are explained with a note.
    let run = directory.run(&format!("vectors explain random_standard#4 --got {good}")).ends(3);
    run.complains(&["--got was not compared"]);
    directory.done("vectors explain random_standard#5").complains(&["SHA-256"]);

    let directory = copied(|text| text.replace(&good, &good[1..]));
    directory.refuses(&[("vectors explain random_standard#4", 1, "random_standard.hex:6: ")]);
    let directory = copied(|text| text.lines().take(9).fold(String::new(), |all, line| all + line + "\n"));
    directory.refuses(&[("vectors explain random_standard#20", 1, "8 vectors, but the manifest says 256")]);
}

/// A variable of a value change dump: scopes, width, changes.
#[derive(Debug, Default)]
struct Wave {
    name: String,
    scopes: Vec<String>,
    width: usize,
    changes: Vec<(u64, String)>,
}

/// Reads a value change dump as IEEE 1364 describes it: keywords and their texts to `$end`, then changes.
fn read_vcd(text: &str) -> Vec<Wave> {
    let (mut waves, mut places, mut scopes) = (Vec::<Wave>::new(), HashMap::new(), Vec::new());
    let (header, body) = text.split_once("$enddefinitions $end\n").unwrap();
    for declaration in header.split("$end").map(str::trim).filter(|declaration| !declaration.is_empty()) {
        let words: Vec<&str> = declaration.split_whitespace().collect();
        match words[..] {
            ["$scope", "module", name] => scopes.push(name.to_owned()),
            ["$upscope"] => assert!(scopes.pop().is_some()),
            ["$var", "wire", width, id, name, ref range @ ..] => {
                let width: usize = width.parse().unwrap();
                let expected = if width > 1 { vec![format!("[{}:0]", width - 1)] } else { vec![] };
                assert_eq!(range, expected, "{name}");
                assert!(places.insert(id.to_owned(), waves.len()).is_none(), "{id} is there twice");
                waves.push(Wave { name: name.to_owned(), scopes: scopes.clone(), width, ..Wave::default() });
            }
            ["$timescale", "1", "ns"] => assert!(scopes.is_empty()),
            _ => assert!(words[0] == "$version" || words[0] == "$comment", "{declaration}"),
        }
    }
    assert!(scopes.is_empty());
    let mut time = None;
    let mut at = 0;
    for line in body.lines() {
        if let Some(next) = line.strip_prefix('#') {
            let next = next.parse().unwrap();
            assert!(time.is_none_or(|time| time < next), "time goes on");
            (time, at) = (Some(next), next);
        } else if line != "$dumpvars" && line != "$end" {
            let (value, id) = match line.strip_prefix('b') {
                Some(vector) => vector.split_once(' ').unwrap(),
                None => line.split_at(1),
            };
            let wave = &mut waves[places[id]];
            assert!(value.len() <= wave.width && value.bytes().all(|c| matches!(c, b'0' | b'1' | b'x')), "{line}");
            assert_eq!(line.starts_with('b'), wave.width > 1, "{line}");
            wave.changes.push((at, value.to_owned()));
        }
    }
    waves
}

#[test]
fn a_dump_has_every_field_in_the_scope_and_at_the_time_of_its_stage() {
    let directory = Folder::new();
    let path = &directory.file("vector.vcd");
    for set in RANDOM.map(|set| format!("{set}_standard")) {
        run(&[&at(&set, 2), "--vcd", path]).ends(0);
        let waves = read_vcd(&directory.read("vector.vcd"));
        let explanation = explanation(&set, 2);
        let mut stages: Vec<&str> = explanation.fields.iter().map(|field| field.stage.as_str()).collect();
        stages.dedup();
        assert_eq!(waves.len(), explanation.fields.len());
        for (wave, field) in waves.iter().zip(&explanation.fields) {
            assert_eq!((&wave.name, wave.width), (&field.field, field.width as usize));
            let module = format!("{}_2", explanation.set);
            assert_eq!(wave.scopes, [module.as_str(), &field.stage]);
            let time = stages.iter().position(|stage| *stage == field.stage).unwrap() as u64;
            let bits = format!("{:b}", u32::from_str_radix(&field.raw, 16).unwrap());
            assert_eq!(wave.changes, [(0, "x".to_owned()), (time, bits)], "{}", field.field);
        }
    }
}

#[test]
fn a_dump_has_a_device_beside_what_was_expected() {
    let directory = Folder::new();
    let path = &directory.file("vector.vcd");
    let set = at("random_standard", 2);
    let got = flipped("random_standard", 2, "direction_t", 0);
    run(&[&set, "--got", &got, "--vcd", path]).ends(3);
    let waves = read_vcd(&directory.read("vector.vcd"));
    assert_eq!(waves.len(), 2 * explanation("random_standard", 2).fields.len());
    for pair in waves.chunks(2) {
        assert_eq!(pair[1].name, format!("{}_got", pair[0].name));
        assert_eq!(pair[0].changes == pair[1].changes, pair[0].name != "direction_t", "{pair:?}");
    }
    run(&[&set, "--got", "face=0", "--got", "lod=0", "--vcd", path]).ends(3);
    let waves = read_vcd(&directory.read("vector.vcd"));
    let names: Vec<_> = waves.iter().filter(|wave| wave.name.ends_with("_got")).map(|wave| &wave.name[..]).collect();
    assert_eq!(names, ["face_got", "lod_got"]);
    run(&[&set, "--vcd", "no/such/folder/vector.vcd"]).ends(1).complains(&["vector.vcd"]);
}
