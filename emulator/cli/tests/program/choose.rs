//! `roughxel choose`: the profile file that it writes has the figures that it prints.

use std::path::Path;

use roughxel_study::profile_file::read_profile;
use roughxel_study::soft_core;

use super::fixture::{Folder, Run, roughxel};

fn choose(scene: &str, arguments: &[&str], file: &Path) -> Run {
    let common = ["choose", "--scene", scene, "--size", "24x18", "--json", "-o", file.to_str().unwrap()];
    roughxel(&[&common, arguments].concat())
}

#[test]
fn what_is_chosen_meets_the_aim_and_is_a_profile_that_draws() {
    let directory = Folder::new();
    let file = directory.join("Small lake.toml");
    let by_accuracy = choose("lake", &["--psnr", "40"], &file).json();
    let profile = read_profile(&file).unwrap();
    let (chosen, next) = (&by_accuracy["chosen"], &by_accuracy["next_cheaper"]);
    assert_eq!(profile.name, "small_lake");
    assert_eq!(chosen["knobs"]["fraction_bits"], profile.precision.fraction_bits);
    assert_eq!(chosen["knobs"]["max_probes"], profile.precision.max_probes);
    let psnr = |of: &serde_json::Value| of["psnr_db"].as_f64().unwrap();
    let cost = |of: &serde_json::Value| of["cost"]["hardware"].as_f64().unwrap();
    assert!(psnr(chosen) >= 40.0 && (next.is_null() || psnr(next) < 40.0 && cost(next) < cost(chosen)));
    assert!(by_accuracy["measured"].as_u64() < by_accuracy["candidates"].as_u64());

    // The most accurate profile within the same cost is at least as accurate.
    let by_budget = choose("lake", &["--budget", &cost(chosen).to_string()], &file).json();
    assert!(psnr(&by_budget["chosen"]) >= psnr(chosen) && cost(&by_budget["chosen"]) <= cost(chosen));

    let (file, picture) = (directory.file("Small lake.toml"), directory.file("lake.png"));
    roughxel(&["render", "lake", "--size", "24x18", "--profile", &file, "-o", &picture]).ends(0);
    assert!(Path::new(&picture).exists());
}

/// Scene in which every profile is drawn before one is out of reach.
const FLAT_MIRROR: &str = r#"
[camera]
eye = [0, 1, 3]
target = [0, 0, 0]

[environment]
generate = "sky"
face_edge = 16

[[object]]
shape = "plane"

[object.material]
reflectance = [1, 1, 1]
"#;

#[test]
fn the_cost_on_a_soft_core_says_its_unit_and_core() {
    let (scenes, directory) = (Folder::new(), Folder::new());
    scenes.write("mirror.toml", FLAT_MIRROR);
    let (scene, file) = (scenes.file("mirror.toml"), directory.join("a.toml"));
    let costs =
        [&[][..], &["--core", "vexriscv-standard"], &["--core", "serv"], &["--core", "riscv32imac"]].map(|core| {
            let arguments = [&["--psnr", "40", "--clock", "softcore"], core].concat();
            let json = choose(&scene, &arguments, &file).json();
            let name = core.last().copied().unwrap_or(soft_core::CORE);
            let unit = if name == "riscv32imac" { "instructions" } else { "clocks" };
            assert_eq!((&json["softcore"]["core"], &json["softcore"]["unit"]), (&name.into(), &unit.into()));
            let comments = std::fs::read_to_string(&file).unwrap();
            assert!(comments.contains(&format!("softcore ({unit} on {name})")), "{comments}");
            json["chosen"]["cost"]["softcore"].as_f64().unwrap()
        });
    assert!(costs[0] == costs[1] && costs[2] > 20.0 * costs[1] && costs[1] > costs[3], "{costs:?}");

    let table =
        roughxel(&["choose", "--scene", &scene, "--size", "24x18", "--psnr", "40", "-o", file.to_str().unwrap()]);
    assert!(table.ends(0).out.contains("softcore (clocks on vexriscv-standard)"));
    let help = roughxel(&["choose", "--help"]).ends(0).out;
    assert!(help.contains(&format!("Without it {}", soft_core::CORE)) && help.contains("serv:"), "{help}");
}

#[test]
fn an_aim_out_of_reach_tells_the_nearest_and_writes_nothing() {
    let (scenes, directory) = (Folder::new(), Folder::new());
    scenes.write("mirror.toml", FLAT_MIRROR);
    for (name, arguments, code, expected) in [
        ("a.toml", &["--budget", "1"][..], 3, "the cheapest costs"),
        ("a.toml", &["--psnr", "300"], 3, "the most accurate has"),
        ("a.toml", &["--psnr", "40", "--clock", "watch"], 2, "clocks are host, hardware, softcore, memory"),
        ("a.toml", &["--psnr", "40", "--clock", "softcore", "--core", "z80"], 2, "vexriscv-standard, "),
        ("a.toml", &["--psnr", "40", "--core", "serv"], 2, "--core belongs to the clock softcore; --clock is hardware"),
        ("a.toml", &["--psnr", "-3"], 2, "--psnr"),
        ("a.toml", &["--psnr", "40", "--budget", "3"], 2, "cannot be used with"),
        ("a.toml", &[], 2, "required"),
        ("paper.toml", &["--psnr", "40"], 2, "`paper` is the name of a profile"),
        ("no/where.toml", &["--psnr", "40"], 1, "where.toml"),
    ] {
        let run =
            choose(&scenes.file("mirror.toml"), arguments, &directory.join(name)).ends(code).complains(&[expected]);
        assert!(run.out.is_empty() && std::fs::read_dir(directory.path()).unwrap().next().is_none());
    }
}
