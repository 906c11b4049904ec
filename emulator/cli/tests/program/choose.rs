//! `roughxel choose`: what it finds is a profile file with the figures it tells.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use roughxel_study::profile_file::read_profile;

fn choose(scene: &str, arguments: &[&str], file: &Path) -> Output {
    let common = ["choose", "--scene", scene, "--size", "24x18", "--json", "-o", file.to_str().unwrap()];
    let mut command = Command::new(env!("CARGO_BIN_EXE_roughxel"));
    command.args(common).args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn figures(output: &Output) -> serde_json::Value {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn what_is_chosen_meets_the_aim_and_is_a_profile_that_draws() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("Small lake.toml");
    let by_accuracy = figures(&choose("lake", &["--psnr", "40"], &file));
    let profile = read_profile(&file).unwrap();
    let (chosen, next) = (&by_accuracy["chosen"], &by_accuracy["next_cheaper"]);
    assert_eq!(profile.name, "small_lake");
    assert_eq!(chosen["knobs"]["fraction_bits"], profile.precision.fraction_bits);
    assert_eq!(chosen["knobs"]["max_probes"], profile.precision.max_probes);
    let psnr = |of: &serde_json::Value| of["psnr_db"].as_f64().unwrap();
    let cost = |of: &serde_json::Value| of["cost"]["hardware"].as_f64().unwrap();
    assert!(psnr(chosen) >= 40.0 && (next.is_null() || psnr(next) < 40.0 && cost(next) < cost(chosen)));
    assert!(by_accuracy["measured"].as_u64() < by_accuracy["candidates"].as_u64());

    // The most accurate of what costs no more is at least as accurate.
    let by_budget = figures(&choose("lake", &["--budget", &cost(chosen).to_string()], &file));
    assert!(psnr(&by_budget["chosen"]) >= psnr(chosen) && cost(&by_budget["chosen"]) <= cost(chosen));

    let picture = directory.path().join("lake.png");
    let mut render = Command::new(env!("CARGO_BIN_EXE_roughxel"));
    render.args(["render", "lake", "--size", "24x18", "--profile"]).arg(&file).arg("-o").arg(&picture);
    assert!(render.output().unwrap().status.success() && picture.exists());
}

/// Every profile is drawn in it before one is out of reach.
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
fn an_aim_out_of_reach_tells_the_nearest_and_writes_nothing() {
    let (scenes, directory) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let scene = scenes.path().join("mirror.toml");
    std::fs::write(&scene, FLAT_MIRROR).unwrap();
    for (name, arguments, code, expected) in [
        ("a.toml", &["--budget", "1"][..], 3, "the cheapest costs"),
        ("a.toml", &["--psnr", "300"], 3, "the most accurate has"),
        ("a.toml", &["--psnr", "40", "--clock", "watch"], 2, "clocks are host, hardware, softcore, memory"),
        ("a.toml", &["--psnr", "-3"], 2, "--psnr"),
        ("a.toml", &["--psnr", "40", "--budget", "3"], 2, "cannot be used with"),
        ("a.toml", &[], 2, "required"),
        ("paper.toml", &["--psnr", "40"], 2, "`paper` is the name of a profile"),
        ("no/where.toml", &["--psnr", "40"], 1, "where.toml"),
    ] {
        let output = choose(scene.to_str().unwrap(), arguments, &directory.path().join(name));
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), message.contains(expected)), (Some(code), true), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty() && std::fs::read_dir(directory.path()).unwrap().next().is_none());
    }
}
