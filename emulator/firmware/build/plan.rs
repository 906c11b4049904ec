//! Plan of the programs, from the environment: `ROUGHXEL_PLAN`, `ROUGHXEL_PROFILE`, and `ROUGHXEL_KNOBS` with differences from that profile
//! (`fraction_bits=18 direction=10`).

use std::env;
use std::fs;
use std::path::Path;

use roughxel_core::knob::Knob;
use roughxel_core::precision::{Precision, Profile};

/// Work of a plan, by the first part of its name: the type of the value that it prepares once, the preparation, and the work on a sample.
const WORK: [(&str, [&str; 3]); 11] = [
    ("empty", ["()", "()", "(sample, prepared)"]),
    ("reflection", ["Environment<Plan>", "Plan::environment(SKY_EDGE)", "Plan::reflect(&sample.reflection, prepared)"]),
    (
        "batch",
        [
            "(Environment<Plan>, Batch<Plan, BATCH>)",
            "(Plan::environment(SKY_EDGE), Batch::new())",
            "Footprints(prepared.1.reflect(sample.batch, &prepared.0))",
        ],
    ),
    ("ports", ["()", "()", "(Plan::reflection(&sample.reflection), prepared)"]),
    (
        "pixel",
        [
            "Environment<Plan>",
            "Plan::environment(SKY_EDGE)",
            "Plan::reflect(&sample.reflection, prepared).colour(&SKY)",
        ],
    ),
    ("highlight", ["()", "()", "(Plan::highlight(&sample.highlight).f, prepared)"]),
    ("peak", ["()", "()", "(Plan::peak(&sample.peak).peak, prepared)"]),
    (
        "float",
        [
            "roughxel_f32_baseline::Environment",
            "roughxel_f32_baseline::Environment::new(SKY_EDGE.into())",
            "prepared.reflect::<Libm, Careful>(&sample.float)",
        ],
    ),
    (
        "micromath",
        [
            "roughxel_f32_baseline::Environment",
            "roughxel_f32_baseline::Environment::new(SKY_EDGE.into())",
            "prepared.reflect::<Micromath, Careful>(&sample.float)",
        ],
    ),
    // Fetches alone: the footprints of all samples are prepared.
    (
        "probe",
        [
            "[FaceFootprint<Plan>; SAMPLES]",
            "REFLECTIONS.map(|fragment| Plan::reflect(&fragment, &Plan::environment(SKY_EDGE)))",
            "Coloured::new(&prepared[sample.place])",
        ],
    ),
    ("texture", ["Texture<Plan>", "Plan::texture([256; 2])", "Plan::texture_footprint(&sample.texture, prepared)"]),
];

/// Fragments of a batch.
const BATCH: usize = 64;

/// Variable of the environment on which the build depends.
fn variable(name: &str, otherwise: &str) -> String {
    println!("cargo:rerun-if-env-changed={name}");
    env::var(name).unwrap_or_else(|_| otherwise.into())
}

/// Accuracy from the environment.
fn precision() -> Precision {
    let (profile, knobs) = (variable("ROUGHXEL_PROFILE", "standard"), variable("ROUGHXEL_KNOBS", ""));
    let named = Profile::by_name(&profile);
    let named = named.unwrap_or_else(|| panic!("ROUGHXEL_PROFILE: profiles are {}", Profile::NAMES.join(", ")));
    let set = |p: Precision, setting: &str| {
        let (name, text) = setting.split_once('=').unwrap_or((setting, ""));
        let knob = Knob::by_name(name).unwrap_or_else(|| {
            panic!("ROUGHXEL_KNOBS: no knob is named {name:?}; knobs are {}", Knob::ALL.map(Knob::name).join(", "))
        });
        let value = knob.read(text);
        let p = value.and_then(|value| knob.with(value, p).checked().ok());
        p.unwrap_or_else(|| panic!("ROUGHXEL_KNOBS: {setting}: {knob} is {}", knob.range()))
    };
    knobs.split_whitespace().fold(named.precision(), set)
}

/// Writes `plan.rs`: the type `Plan` and its accuracy, its preparation, and its work on a sample.
pub fn write(out: &Path) {
    let (plan, precision) = (variable("ROUGHXEL_PLAN", "reflection"), precision());
    let mut parts = plan.split('+');
    let name = parts.next().unwrap_or_default();
    let (_, [prepared, prepare, work]) =
        WORK.iter().find(|(known, ..)| *known == name).unwrap_or_else(|| panic!("ROUGHXEL_PLAN: no plan {name}"));
    let mut effects = String::new();
    for effect in parts {
        effects += &match effect {
            "isotropic" => "roughness: RoughnessKind::Isotropic, ".into(),
            "anisotropic" => "roughness: RoughnessKind::Anisotropic, ".into(),
            "bump" | "curvature" => format!("{effect}: true, "),
            "footprint" => "footprint: roughxel_core::plan::FootprintKind::Face, ".into(),
            "horizon" => "horizon: roughxel_core::plan::HorizonKind::Correlated, ".into(),
            other => panic!("ROUGHXEL_PLAN: no effect is named {other}"),
        };
    }
    let word = if precision.word_bits() == 16 { "Narrow" } else { "Whole" };
    let value = Knob::ALL.into_iter().fold("Precision::STANDARD".into(), |within: String, knob| {
        format!("Knob::{knob:?}.with({}, {within})", knob.value_in(&precision))
    });
    let batch = if name == "batch" { BATCH } else { 1 };
    let text = format!(
        "/// Fragments that are shaded together.\n#[allow(dead_code, reason = \"a plan need not shade batches\")]\nconst BATCH: usize = {batch};\n/// Its accuracy.\nstruct Knobs;\nimpl Accuracy for Knobs {{\n    type Word = width::{word};\n    const PRECISION: Precision = \
         {value};\n}}\n\
         /// The plan that is priced.\nstruct Plan;\nimpl Firmware for Plan {{\n    type Accuracy = Knobs;\n    const EFFECTS: Effects = \
         Effects {{ {effects}..Effects::NONE }};\n}}\n\
         /// Type of the value that it prepares once.\ntype Prepared = {prepared};\n/// Prepares it.\nmacro_rules! prepare {{ () => {{ {prepare} }}; }}\n\
         /// Work on a sample.\nmacro_rules! work {{ ($sample:ident, $prepared:ident) => {{ {{ let (sample, prepared) = \
         ($sample, $prepared); {work} }} }}; }}\n"
    );
    fs::write(out.join("plan.rs"), text).expect("it can be written");
}
