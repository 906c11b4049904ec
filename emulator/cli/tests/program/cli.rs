//! Exit codes and help of the program.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};

use super::fixture::{Folder, Run, program, roughxel};

/// Runs a line of arguments without blanks and reads its JSON.
fn json(line: &str) -> serde_json::Value {
    roughxel(&line.split_whitespace().collect::<Vec<_>>()).json()
}

#[test]
fn usage_errors_end_with_2() {
    let directory = Folder::new();
    for line in [
        "",
        "frobnicate",
        "eval --profile best",
        "eval --effects bump,fog",
        "eval --effects all,bump",
        "eval one.csv two.csv",
        "vectors export random",
        "vectors export nonesuch -o unused",
        "vectors export -o unused --count 0",
        "vectors export -o unused --smoke --count 3",
        "vectors verify",
        "demo --size 640",
        "demo --threads 0",
        "render",
        "render lake --mode supersampled:0",
        "report accuracy --profile best",
        "ranges --design everything",
        "ranges --size 0x3",
        "cost --effects fog",
        "cost --profile paper --path no_such_stage",
        "render lake --backend fast",
        "render lake --reading fast",
        "render lake -o lake.jpg",
        "completions",
        "completions no-such-shell",
        "plan",
        "plan lake --rounds 3",
        "verilog",
        "verilog -o unused --stage no_such_stage",
        "verilog -o unused --prefix 9",
        "verilog -o unused --clock 40",
        "verilog -o unused --stream 32 --clock 0",
        "verilog -o unused --stream 32 --clock fast",
        "verilog -o unused --scene lake --effects bump",
        "verilog -o unused --effects bumps",
        "vectors export -o unused --scene lake --effects bump",
        "vectors export -o unused --frame tilted",
        "vectors export -o unused --stage no_such_stage",
        "vectors export -o unused random --stage half",
        "vectors export -o unused --stage reflect --no-taps",
        "vectors export -o unused --stage reflect --smoke",
    ] {
        let run = directory.run(line).ends(2);
        assert!(run.out.is_empty() && !run.err.is_empty(), "{line}");
    }
}

#[test]
fn failures_end_with_1_and_name_the_file() {
    let directory = Folder::new();
    directory.write("file", "");
    directory.write("scene.toml", "name = 3\n");
    directory.refuses(&[
        ("render no-such.toml", 1, "no-such.toml"),
        ("plan no-such.toml", 1, "no-such.toml"),
        ("render scene.toml", 1, "scene.toml:1:"),
        ("render lake --size 16x16 -o no/where.png", 1, "where.png"),
        ("eval no-such.csv", 1, "no-such.csv"),
        ("eval .", 1, "cannot read"),
        ("vectors verify no-such-directory", 1, "no-such-directory"),
        ("vectors export -o unused --scene no-such.toml", 1, "no-such.toml"),
        ("verilog -o unused --scene no-such.toml", 1, "no-such.toml"),
        ("vectors export random -o file/set", 1, "cannot write"),
        ("verilog -o file/set", 1, "file/set"),
    ]);
}

/// Outputs are refused before scenes are read: the scenes named here do not exist.
#[test]
fn what_cannot_be_written_is_told_before_the_work() {
    let directory = Folder::new();
    directory.write("file", "");
    std::fs::create_dir(directory.join("taken.png")).unwrap();
    for (line, path) in [
        ("render no-such.toml -o", "no/where.png"),
        ("render no-such.toml -o", "taken.png"),
        ("render no-such.toml --capture", "file/below"),
        ("choose --psnr 40 --scene no-such.toml -o", "no/where.png"),
        ("vectors export --scene no-such.toml -o", "file/below"),
        ("vectors rom -o", "file/below"),
        ("verilog --scene no-such.toml -o", "file/below"),
        ("gallery -o", "file/below"),
        ("demo -o", "file/below"),
        ("study -o", "file/below"),
    ] {
        let path = directory.file(path);
        let start = std::time::Instant::now();
        let run = Run::output(directory.program(line).arg(&path)).ends(1);
        assert!(run.err.starts_with(&format!("error: cannot write {path}: ")), "{line}: {}", run.err);
        assert!(start.elapsed().as_secs() < 5, "{line}");
    }
    let left: Vec<_> = directory.path().read_dir().unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[cfg(unix)]
#[test]
fn pipes_are_refused_and_not_waited_for() {
    let directory = Folder::new();
    assert!(Command::new("mkfifo").arg(directory.join("pipe.toml")).status().unwrap().success());
    for line in [
        "render pipe.toml",
        "eval pipe.toml",
        "eval --profile pipe.toml",
        "vectors verify pipe.toml",
        "vectors format --write pipe.toml",
        "study --from pipe.toml -o .",
    ] {
        directory.run(line).ends(1).complains(&["pipe.toml", "no regular file but a pipe"]);
    }
    // The only input that may be a pipe is named `-`.
    directory.run("eval pipe.toml").complains(&["`-` for stdin"]);
}

#[test]
fn a_scene_of_a_similar_name_is_suggested() {
    let directory = Folder::new();
    for line in ["render denim-plan", "plan denim-plan", "scenes denim-plan", "gallery --scene denim-plan -o unused"] {
        let run = directory.run(line).complains(&["did you mean `denim-plane`?"]);
        assert_ne!(run.code, Some(0));
    }
}

#[test]
fn completions_of_every_shell_know_commands_and_options() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        roughxel(&["completions", shell]).ends(0).prints(&["gallery", "samples", "no-cache", "completions"]);
    }
}

#[test]
fn more_threads_than_cores_are_as_many_as_cores_and_give_the_same_picture() {
    let directory = Folder::new();
    let digest = |threads: &str| {
        let render = format!("render shapes --size 64x48 --json --threads {threads} -o x.png");
        directory.run(&render).json()["digest"].clone()
    };
    assert_eq!(digest("1"), digest("1024"));
    let gallery = "gallery --scene mesh --size 8x8 --samples 1 --json --threads 1024 -o .";
    let cores = std::thread::available_parallelism().unwrap().get();
    assert_eq!(directory.run(gallery).json()["threads"], cores);
}

#[test]
fn a_plan_fits_into_80_columns() {
    let directory = Folder::new();
    for line in ["plan horizon-plane --no-cache", "plan shapes --size 16x12 --measure --rounds 1"] {
        let text = directory.done(line).out;
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        assert_eq!(text.contains("share"), line.contains("--measure"), "{text}");
    }
}

#[test]
fn help_gives_units_formats_and_exit_codes() {
    let parts = ["I2F30", "I4F28", "0 done, 1 failure, 2 usage, 3 mismatch", "per pixel"];
    for arguments in [&["--help"][..], &["eval", "--help"], &["demo", "--help"], &["vectors", "verify", "--help"]] {
        roughxel(arguments).ends(0).prints(&parts);
    }
}

#[test]
fn ranges_and_cost_say_what_their_columns_and_exit_codes_mean() {
    for (command, parts) in [
        ("ranges", ["proven", "declared", "slack", "0 no wire can overflow; 1 one can", "3 a value was observed"]),
        ("cost", ["multipliers", "ROM", "ceil(log2 w)+2", "Exit codes: 0 done, 1 ", "two's complement"]),
    ] {
        roughxel(&[command, "--help"]).ends(0).prints(&parts);
    }
}

#[test]
fn every_observed_range_is_inside_the_proven_one_and_leaves_no_less_slack() {
    let all = json("ranges --json --design all --profile all --size 16x12 --random 50");
    let number = |value: &serde_json::Value| value.as_i64().unwrap();
    for design in all.as_array().unwrap() {
        assert!(design["violations"].as_array().unwrap().is_empty());
        for tap in design["taps"].as_array().unwrap() {
            let (proven, declared) = (&tap["proven"], number(&tap["declared_bits"]));
            assert_eq!(number(&tap["slack_bits"]), declared - number(&tap["proven_bits"]), "{tap}");
            assert!(number(&tap["observed_bits"]) <= number(&tap["proven_bits"]), "{tap}");
            for seen in ["frame", "sets"] {
                assert!(number(&proven["low"]) <= number(&tap[seen]["low"]), "{tap}");
                assert!(number(&proven["high"]) >= number(&tap[seen]["high"]), "{tap}");
            }
            assert!(tap["line"].as_str().unwrap().contains(".rs:"), "{tap}");
        }
    }
}

#[test]
fn a_smaller_plan_costs_less_and_a_critical_path_ends_at_its_levels() {
    let multipliers = |effects: &str| -> u64 {
        let cost = json(&format!("cost --json --profile compact --effects {effects}"));
        let list = cost[0]["total"]["multipliers"].as_array().unwrap().clone();
        list.iter().map(|widths| widths["count"].as_u64().unwrap()).sum()
    };
    let plans = ["none", "footprint", "footprint,bump", "footprint,bump,roughness", "all"].map(multipliers);
    assert!(plans.is_sorted_by(|a, b| a < b), "{plans:?}");

    let cost = json("cost --json --profile compact");
    for stage in cost[0]["stages"].as_array().unwrap() {
        let name = stage["stage"].as_str().unwrap();
        let path = json(&format!("cost --json --profile compact --path {name}"));
        let last = path[0]["path"].as_array().unwrap().last().unwrap()[0].as_str().unwrap().to_string();
        let levels = stage["cost"]["levels"].as_u64().unwrap();
        assert!(last.starts_with(&format!("{levels} (+")), "{name}: {last}, {levels}");
    }
}

#[test]
fn a_plan_names_what_decided_each_effect_and_what_is_off_costs_nothing() {
    let effects = |line: &str| -> Vec<serde_json::Value> {
        let plan = json(line);
        plan["objects"].as_array().unwrap()[0]["effects"].as_array().unwrap().clone()
    };
    let find = |effects: &[serde_json::Value], name: &str| {
        effects.iter().find(|effect| effect["effect"] == name).unwrap_or_else(|| panic!("no {name}")).clone()
    };
    let lake = effects("plan lake --json");
    // A flat mirror with waves has every effect except a colour map and normals that turn.
    for (name, on, why) in [
        ("colour texture", false, "no `colour_map`"),
        ("bump", true, "`height_map`"),
        ("roughness", true, "lost detail"),
        ("environment", true, "`reflectance`"),
        ("footprint", true, "mode footprint"),
        ("curvature", false, "normals vary over 0 of"),
    ] {
        let effect = find(&lake, name);
        assert_eq!(effect["on"], on, "{name}");
        assert!(effect["why"].as_str().unwrap().contains(why), "{name}: {}", effect["why"]);
    }
    for effect in lake.iter().chain(&effects("plan lake --mode unfiltered --json")) {
        if effect["on"] == false {
            for part in ["datapath", "fetch"] {
                let hardware = &effect[part];
                assert_eq!((&hardware["operations"], hardware["stages"].as_array().unwrap().len()), (&0.into(), 0));
            }
            assert_eq!(effect["map_bytes"], 0);
        }
    }
    let roughness = find(&lake, "roughness");
    assert!(roughness["datapath"]["multipliers"].as_i64().unwrap() > 0 && roughness["map_bytes"].as_u64().unwrap() > 0);

    let measured = effects("plan shapes --size 16x12 --measure --rounds 1 --threads 1 --json");
    for effect in measured {
        assert_eq!(effect["share"].is_number(), effect["on"] == true, "{effect}");
    }
}

#[test]
fn a_plan_says_what_the_frame_and_all_maps_take() {
    let plan = json("plan lake --size 320x200 --json");
    assert_eq!(plan["frame_bytes"], 15 * 320 * 200);
    let effects = plan["objects"][0]["effects"].as_array().unwrap();
    // The scene has one object, so its maps are all maps.
    let maps: u64 = effects.iter().map(|effect| effect["map_bytes"].as_u64().unwrap()).sum();
    assert!(maps > 1 << 20);
    assert_eq!(plan["map_bytes"], maps);
    let memory = "memory: frame 937.50 KiB (320x200, 15 bytes a pixel), maps ";
    roughxel(&["plan", "lake", "--size", "320x200"]).prints(&[memory]);
}

#[test]
fn every_set_that_is_listed_can_be_exported() {
    let directory = Folder::new();
    let sets = json("vectors list --json");
    let exported = directory.run("vectors export -o . --count 20 --json").json();
    let names = |list: &serde_json::Value| -> Vec<String> {
        list.as_array().unwrap().iter().map(|set| set["set"].as_str().unwrap().to_string()).collect()
    };
    assert_eq!(names(&sets), names(&exported["sets"]));
    directory.done("vectors verify .");
}

#[test]
fn a_stage_of_every_set_is_exported_where_the_set_has_it_and_another_name_is_suggested() {
    let directory = Folder::new();
    let exported = directory.run("vectors export -o . --stage columns --count 5 --json").json();
    let sets = exported["sets"].as_array().unwrap();
    let of_random: Vec<_> = sets.iter().filter(|set| set["set"].as_str().unwrap().starts_with("random")).collect();
    let [pixel, rough] = &of_random[..] else { panic!("{of_random:?}") };
    assert_eq!((&pixel["set"], &pixel["count"]), (&serde_json::json!("random_columns_pixel"), &serde_json::json!(10)));
    assert_eq!(
        (&rough["set"], &rough["count"]),
        (&serde_json::json!("random_columns_roughness"), &serde_json::json!(10))
    );
    assert!(sets.len() > 10, "{sets:?}");
    directory.done("vectors verify .");
    let unknown = "no stage `cube_fac`; did you mean `cube_face`? there are ";
    directory.refuses(&[
        ("vectors export -o . --stage cube_fac", 2, unknown),
        ("vectors export random -o . --stage half", 2, "set `random` has no stage `half`; there are "),
    ]);
}

#[test]
fn a_reader_that_leaves_early_is_no_failure() {
    let mut command = program(&["eval", "-"]);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let rows = "0,0,1,0,0,1\n".repeat(5000);
    // The program may end before it reads everything.
    let _ =
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), format!("nx,ny,nz,vx,vy,vz\n{rows}").as_bytes());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr), (Some(0), Vec::new()));
}

#[test]
fn a_captured_frame_is_a_set_that_verifies() {
    let directory = Folder::new();
    for mode in ["footprint", "isotropic"] {
        directory.done(&format!("render globe --size 40x30 --mode {mode} -o globe.png --capture sets"));
    }
    assert!(std::fs::metadata(directory.join("globe.png")).unwrap().len() > 0);
    directory.done("vectors verify sets");
}

/// Lists the paths of input and output ports from the manifest of a generated top.
fn ports_of(top: &Path) -> BTreeSet<String> {
    let manifest: serde_json::Value = serde_json::from_slice(&std::fs::read(top).unwrap()).unwrap();
    let of = |side: &str| manifest["top"][side].as_array().unwrap().clone();
    of("inputs").iter().chain(&of("outputs")).map(|port| port["name"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn vectors_and_verilog_of_a_scene_have_what_its_plan_has_and_no_more() {
    let directory = Folder::new();
    for (scene, object, datapath, design, present, absent) in [
        ("lake", "water", "reflection", "fragment", "surface.roughness[0]", "dnormal"),
        ("globe", "north", "reflection", "fragment", "dnormal[0].mantissa[0]", "surface.frame_vectors[1]"),
        ("highlight", "bumps", "highlight", "highlight", "surface.roughness[0]", "dview"),
        ("highlight", "smooth", "highlight", "highlight", "shininess.exponent", "spread"),
        ("velvet", "velvet", "peak", "lit_peak", "peak.amplitude", "horizon"),
        ("horizon-plane", "plane", "peak", "lit_peak", "horizon.low[0]", "surface.offset"),
    ] {
        directory.done(&format!("vectors export --scene {scene} --count 3 -o vectors/{object}"));
        directory.done(&format!("verilog --scene {scene} -o hardware/{object}"));
        let sets = format!("vectors/{object}/{object}/{datapath}");
        directory.done(&format!("vectors verify {sets}"));
        let top = format!("hardware/{object}/{object}/{design}/roughxel_{design}.json");
        let (sets, ports) = (directory.join(&sets), ports_of(&directory.join(&top)));
        let manifests = std::fs::read_dir(&sets).unwrap().map(|file| file.unwrap().path());
        for path in manifests.filter(|path| path.extension().is_some_and(|of| of == "json")) {
            let manifest: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
            let fields = manifest["fields"].as_array().unwrap().iter().map(|field| field["port"].as_str().unwrap());
            let fields: BTreeSet<String> = fields.filter(|port| !port.is_empty()).map(str::to_owned).collect();
            assert_eq!(fields, ports, "{}", path.display());
        }
        assert!(ports.contains(present), "{scene}: {present} in {ports:?}");
        assert!(!ports.iter().any(|port| port.starts_with(absent)), "{scene}: {absent} in {ports:?}");
    }
}

#[test]
fn old_names_of_commands_work_and_the_help_does_not_list_them() {
    let list = roughxel(&["vectors", "--help"]).ends(0).out;
    let is_listed = |name: &str| list.lines().any(|line| line.split_whitespace().next() == Some(name));
    for (old, new) in [
        ("judge", "check"),
        ("marks", "ambiguous"),
        ("minimise", "shrink"),
        ("distil", "condense"),
        ("report", "coverage"),
    ] {
        let [of_old, of_new] = [old, new].map(|name| roughxel(&["vectors", name, "--help"]).ends(0).out);
        assert_eq!(of_old, of_new, "{old}");
        assert!(is_listed(new) && !is_listed(old), "{old}, {new}");
    }
}
