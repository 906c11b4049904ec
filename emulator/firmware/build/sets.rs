//! Golden vectors of `vectors/smoke` as tables: the integers of each set, and their places among those of its ports.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use roughxel_core::bundle::End;
use roughxel_core::ports::{HighlightInput, HighlightOutput, PeakInput, PeakOutput, ReflectionInput, ReflectionOutput};
use roughxel_oracle::walk::limits;
use serde_json::Value;

/// Folder of the vectors.
const FOLDER: &str = "../../vectors/smoke";

/// A field of a set: its place among the numbers of its bundle, and the format of its digits.
struct Column {
    place: usize,
    width: u32,
    signed: bool,
    up: u32,
}

/// Writes `sets.rs` and the integers that it includes.
pub fn write(out: &Path) {
    println!("cargo:rerun-if-changed={FOLDER}");
    let mut names: Vec<_> = fs::read_dir(FOLDER)
        .expect("the vectors are next to the core")
        .map(|entry| entry.expect("a folder can be read").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    names.sort();
    let mut text = String::from("&[\n");
    for path in names {
        let name = path.file_stem().expect("a manifest has a name").to_string_lossy().into_owned();
        let manifest = fs::read_to_string(&path).expect("a manifest can be read");
        let manifest: Value = serde_json::from_str(&manifest).unwrap_or_else(|error| panic!("{name}.json: {error}"));
        let words = fs::read_to_string(path.with_extension("hex")).expect("its words are next to the manifest");
        set(&name, &manifest, &words, out, &mut text);
    }
    text.push(']');
    fs::write(out.join("sets.rs"), text).expect("it can be written");
}

fn set(name: &str, manifest: &Value, words: &str, out: &Path, text: &mut String) {
    let (datapath, inputs, outputs) = match manifest["datapath"].as_str() {
        Some("reflection") => {
            ("Reflection", limits::<ReflectionInput<i32>>(End::Low), limits::<ReflectionOutput<i32>>(End::Low))
        }
        Some("highlight") => {
            ("Highlight", limits::<HighlightInput<i32>>(End::Low), limits::<HighlightOutput<i32>>(End::Low))
        }
        Some("peak") => ("Peak", limits::<PeakInput<i32>>(End::Low), limits::<PeakOutput<i32>>(End::Low)),
        other => panic!("{name}.json: no datapath is named {other:?}"),
    };
    let fields = manifest["fields"].as_array().expect("a manifest has fields");
    let columns: Vec<(bool, Column)> = fields
        .iter()
        .filter(|field| field["direction"] != "check")
        .map(|field| {
            let input = field["direction"] == "in";
            let (places, port) = (if input { &inputs } else { &outputs }, field["port"].as_str().expect("a path"));
            let place = places.iter().position(|place| place.path == port);
            let place = place.unwrap_or_else(|| panic!("{name}.json: the core has no port {port}"));
            let number = |key: &str| field[key].as_u64().expect("a number") as u32;
            let up = places[place].fraction_bits - number("fraction_bits");
            (input, Column { place, width: number("width"), signed: field["signed"] == true, up })
        })
        .collect();

    // Integers of the fields row by row, least significant byte first.
    let mut integers = Vec::new();
    let mut count = 0;
    for line in words.lines().filter(|line| !line.starts_with("//")) {
        count += 1;
        for ((_, column), digits) in columns.iter().zip(line.split('_')) {
            let bits = u32::from_str_radix(digits, 16).unwrap_or_else(|error| panic!("{name}.hex: {error}"));
            let spare = 32 - column.width;
            let integer = if column.signed { (bits << spare) as i32 >> spare } else { bits as i32 };
            integers.extend((integer << column.up).to_le_bytes());
        }
    }
    assert_eq!(manifest["count"], count, "{name}: the number of words differs from the manifest");
    fs::write(out.join(format!("{name}.bin")), integers).expect("it can be written");

    let list = |input: bool| {
        let places = columns.iter().filter(|(is_input, _)| *is_input == input);
        places.map(|(_, column)| column.place.to_string()).collect::<Vec<_>>().join(", ")
    };
    assert!(columns.is_sorted_by_key(|(input, _)| !input), "{name}.json: inputs stand before outcomes");
    let paths: Vec<&str> = outputs.iter().map(|place| &place.path[..]).collect();
    let effects = &manifest["effects"];
    writeln!(
        text,
        "    Set {{ name: {name:?}, datapath: Datapath::{datapath}, profile: Profile::{}, effects: Effects {{ bump: {}, frame: \
         FrameSystem::{}, roughness: RoughnessKind::{}, curvature: {}, footprint: FootprintKind::{}, horizon: HorizonKind::{} }}, inputs: &[{}], outputs: \
         &[{}], names: &{paths:?}, integers: include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{name}.bin\")) }},",
        camel(&manifest["profile"]["name"]),
        effects["bump"],
        camel(&effects["frame"]),
        camel(&effects["roughness"]),
        effects["curvature"],
        camel(&effects["footprint"]),
        camel(&effects["horizon"]),
        list(true),
        list(false),
    )
    .expect("a text grows");
}

/// `main_direction` as `MainDirection`.
fn camel(name: &Value) -> String {
    let words = name.as_str().expect("a name").split('_');
    words.map(|word| word[..1].to_uppercase() + &word[1..]).collect()
}
