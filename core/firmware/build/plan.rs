//! The plan that the program `plan` has, by the environment: `ROUGHXEL_PLAN` and `ROUGHXEL_PROFILE`.

use std::env;
use std::fs;
use std::path::Path;

/// What a plan runs, by the first part of its name: the type of what it prepares once, that, and what it does with a sample.
const WORK: [(&str, [&str; 3]); 7] = [
    ("empty", ["()", "()", "(sample, prepared)"]),
    ("reflection", ["Environment<Plan>", "Plan::environment(SKY_EDGE)", "Plan::reflect(&sample.reflection, prepared)"]),
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
    ("texture", ["Texture<Plan>", "Plan::texture([256; 2])", "Plan::texture_footprint(&sample.texture, prepared)"]),
];

/// Writes `plan.rs`: the type `Plan`, what it prepares and what of it is run.
pub fn write(out: &Path) {
    println!("cargo:rerun-if-env-changed=ROUGHXEL_PLAN");
    println!("cargo:rerun-if-env-changed=ROUGHXEL_PROFILE");
    let variable = |name: &str, otherwise: &str| env::var(name).unwrap_or_else(|_| otherwise.into());
    let (plan, profile) = (variable("ROUGHXEL_PLAN", "reflection"), variable("ROUGHXEL_PROFILE", "standard"));
    let mut parts = plan.split('+');
    let name = parts.next().unwrap_or_default();
    let (_, [prepared, prepare, work]) =
        WORK.iter().find(|(known, ..)| *known == name).unwrap_or_else(|| panic!("ROUGHXEL_PLAN: what is {name}?"));
    let mut effects = String::new();
    for effect in parts {
        effects += &match effect {
            "isotropic" => "roughness: RoughnessKind::Isotropic, ".into(),
            "anisotropic" => "roughness: RoughnessKind::Anisotropic, ".into(),
            "bump" | "curvature" | "footprint" | "horizon" => format!("{effect}: true, "),
            other => panic!("ROUGHXEL_PLAN: no effect is named {other}"),
        };
    }
    let profile = profile[..1].to_uppercase() + &profile[1..];
    let text = format!(
        "/// The plan that is priced.\nstruct Plan;\nimpl Firmware for Plan {{\n    type Accuracy = {profile};\n    const \
         EFFECTS: Effects = Effects {{ {effects}..Effects::NONE }};\n}}\n\
         /// The type of what it prepares once.\ntype Prepared = {prepared};\n/// That.\nmacro_rules! prepare {{ () => {{ {prepare} }}; }}\n\
         /// What it does with a sample.\nmacro_rules! work {{ ($sample:ident, $prepared:ident) => {{ {{ let (sample, prepared) = \
         ($sample, $prepared); {work} }} }}; }}\n"
    );
    fs::write(out.join("plan.rs"), text).expect("it can be written");
}
