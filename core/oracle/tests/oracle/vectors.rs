//! The golden vectors of `vectors/smoke`, every field of every one.

use std::fs;
use std::path::Path;

use roughxel_core::bundle::{Bundle, End};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Profile;
use roughxel_core::scalar_api;
use serde_json::Value;

use roughxel_oracle::walk::{Number, bundle, limits, numbers};

use crate::scalar_api::{FOOTPRINTS, FRAMES, HORIZONS, ROUGHNESS};

pub(crate) fn every_field_of_every_golden_vector_is_that_of_the_scalar_api() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../vectors/smoke");
    let mut sets = 0;
    for entry in fs::read_dir(folder).expect("the vectors are next to the core") {
        let path = entry.expect("a folder can be read").path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let manifest = fs::read_to_string(&path).expect("a manifest can be read");
            let manifest: Value = serde_json::from_str(&manifest).expect("a manifest is JSON");
            let words = fs::read_to_string(path.with_extension("hex")).expect("the words are next to the manifest");
            set(&manifest, &words, &path.display().to_string());
            sets += 1;
        }
    }
    assert!(sets > 50, "{sets} sets");
}

fn set(manifest: &Value, words: &str, name: &str) {
    let profile = manifest["profile"]["name"].as_str().and_then(Profile::by_name).expect("a profile has a name");
    let (p, effects) = (&profile.precision(), effects(&manifest["effects"]));
    match manifest["datapath"].as_str() {
        Some("reflection") => {
            check(manifest, words, name, |input| scalar_api::fragment(input, &effects.reflection(), p));
        }
        Some("highlight") => {
            check(manifest, words, name, |input| scalar_api::highlight(input, &effects.highlight(), p));
        }
        Some("peak") => check(manifest, words, name, |input| scalar_api::lit_peak(input, &effects.peak(), p)),
        other => panic!("{name}: no datapath is named {other:?}"),
    }
}

/// A field of a set: its place in a line, its place among the wires of its bundle, and the conversion of its digits to an integer.
struct Column {
    at: usize,
    place: usize,
    width: u32,
    signed: bool,
    up: u32,
}

fn check<I, O>(manifest: &Value, words: &str, name: &str, run: impl Fn(&I) -> O)
where
    I: Bundle<i32, In<i32> = I>,
    O: Bundle<i32, In<i32> = O>,
{
    let (inputs, outputs) = (limits::<I>(End::Low), limits::<O>(End::Low));
    let columns = |direction: &str, wires: &[Number]| -> Vec<Column> {
        let fields = manifest["fields"].as_array().expect("a manifest has fields");
        let fields = fields.iter().enumerate().filter(|(_, field)| field["direction"] != "check");
        fields
            .filter(|(_, field)| (field["direction"] == "in") == (direction == "in"))
            .map(|(at, field)| {
                let number = |key: &str| field[key].as_u64().expect("a number") as u32;
                let place = wires.iter().position(|wire| field["port"] == wire.path);
                let place = place.unwrap_or_else(|| panic!("{name}: the core has no port {}", field["port"]));
                let up = wires[place].fraction_bits - number("fraction_bits");
                Column { at, place, width: number("width"), signed: field["signed"] == true, up }
            })
            .collect()
    };
    let (ins, outs) = (columns("in", &inputs), columns("out", &outputs));
    let lines = words.lines().filter(|line| !line.starts_with("//"));
    for (index, line) in lines.enumerate() {
        let digits: Vec<&str> = line.split('_').collect();
        let integer = |column: &Column| {
            let bits = u32::from_str_radix(digits[column.at], 16).expect("digits are hexadecimal");
            let spare = 32 - column.width;
            let integer = if column.signed { (bits << spare) as i32 >> spare } else { bits as i32 };
            i64::from(integer << column.up)
        };
        let mut input = vec![0; inputs.len()];
        ins.iter().for_each(|column| input[column.place] = integer(column));
        let output = numbers(&run(&bundle(input)));
        for column in &outs {
            let found = &output[column.place];
            assert_eq!(found.integer, integer(column), "{name}#{index} {}", found.path);
        }
    }
}

/// The value of `all` that a manifest names.
fn named<T: Copy + std::fmt::Debug>(name: &Value, all: [T; 3]) -> T {
    let name = name.as_str().expect("a name").replace('_', "");
    let named = all.into_iter().find(|one| format!("{one:?}").to_lowercase() == name);
    named.unwrap_or_else(|| panic!("none of {all:?} is named {name}"))
}

fn effects(effects: &Value) -> Effects {
    Effects {
        bump: effects["bump"] == true,
        frame: named(&effects["frame"], FRAMES),
        roughness: named(&effects["roughness"], ROUGHNESS),
        curvature: effects["curvature"] == true,
        footprint: named(&effects["footprint"], FOOTPRINTS),
        horizon: named(&effects["horizon"], HORIZONS),
    }
}
