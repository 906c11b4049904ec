//! The plan that the program `plan` has, by the environment: `ROUGHXEL_PLAN` and `ROUGHXEL_PROFILE`.

use std::env;
use std::fs;
use std::path::Path;

/// Writes `plan.rs`: the type `Plan`, and what of it is run.
pub fn write(out: &Path) {
    println!("cargo:rerun-if-env-changed=ROUGHXEL_PLAN");
    println!("cargo:rerun-if-env-changed=ROUGHXEL_PROFILE");
    let variable = |name: &str, otherwise: &str| env::var(name).unwrap_or_else(|_| otherwise.into());
    let (plan, profile) = (variable("ROUGHXEL_PLAN", "reflection"), variable("ROUGHXEL_PROFILE", "standard"));
    let mut parts = plan.split('+');
    let work = parts.next().unwrap_or_default();
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
         EFFECTS: Effects = Effects {{ {effects}..Effects::NONE }};\n}}\n/// What of it runs.\nconst WORK: &str = {work:?};\n"
    );
    fs::write(out.join("plan.rs"), text).expect("it can be written");
}
