//! Files of `roughxel verilog`.

use std::collections::BTreeSet;
use std::path::Path;

use super::fixture::Folder;

#[test]
fn verilog_writes_what_its_manifest_lists_and_the_same_every_time() {
    use sha2::{Digest, Sha256};
    let directory = Folder::new();
    let written = |to: &str, more: &str| -> std::collections::BTreeMap<String, Vec<u8>> {
        directory.done(&format!("verilog --profile compact -o {to} {more}"));
        let path = &directory.join(to);
        let folders = [path.clone(), path.join("rom")].into_iter().filter(|folder| folder.exists());
        let files = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap()).map(|file| file.unwrap().path());
        let name = |file: &Path| file.strip_prefix(path).unwrap().to_str().unwrap().to_owned();
        files.filter(|file| file.is_file()).map(|file| (name(&file), std::fs::read(&file).unwrap())).collect()
    };
    let (files, again) = (written("first", ""), written("second", ""));
    assert!(files == again);
    let manifest: serde_json::Value = serde_json::from_slice(&files["roughxel_fragment.json"]).unwrap();
    let listed = manifest["files"].as_array().unwrap();
    assert_eq!(listed.len() + 1, files.len());
    for file in listed {
        let hash = Sha256::digest(&files[file["name"].as_str().unwrap()]);
        let hex = hash.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"));
        assert_eq!(file["sha256"], hex, "{file}");
    }
    assert!(files.contains_key("roughxel_fragment.v"));

    let stage = written("alone", "--stage columns --prefix mine_");
    assert!(stage.keys().all(|name| name.starts_with("mine_")), "{:?}", stage.keys());
    assert!(stage.contains_key("mine_columns.json"));
    assert!(stage.len() < files.len() && stage.contains_key("mine_columns_pixel.v"), "{:?}", stage.keys());
}

#[test]
fn options_of_verilog_reach_the_files() {
    let directory = Folder::new();
    let options = "--multipliers 2 --target ecp5 --depth 9 --stream 16 --clock 40 --prefix mine_";
    directory.done(&format!("verilog --profile narrow --effects none --frame natural {options} -o written"));
    let manifest: serde_json::Value =
        serde_json::from_str(&directory.read("written/mine_roughxel_fragment.json")).expect("a manifest");
    for (key, value) in [("profile", "narrow"), ("effects", "none"), ("frame", "natural"), ("target", "ecp5")] {
        assert_eq!(manifest[key], value, "{key}");
    }
    assert_eq!((&manifest["depth"], &manifest["shell"]["stream_bits"]), (&9.into(), &16.into()));
    assert_eq!(manifest["shell"]["clock_mhz"], 40.0);
    assert_eq!(manifest["fold"]["units"][0]["units"], 2);
    assert!(directory.read("written/mine_roughxel_fragment.lpf").contains("FREQUENCY PORT \"aclk\" 40 MHZ;"));
    assert!(directory.join("written/bench/expected.hex").exists());
}

/// Names of the files of a folder that end in a way.
fn ending(folder: &Path, end: &str) -> BTreeSet<String> {
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    files.filter(|name| name.ends_with(end)).collect()
}

#[test]
fn a_prefix_is_in_front_of_every_module_so_that_a_project_holds_several_designs() {
    let directory = Folder::new();
    let mut all = BTreeSet::new();
    for (prefix, options) in [
        ("a_", "--profile narrow --stream 32"),
        ("b_", "--profile narrow --stream 32 --multipliers 6 --target ecp5"),
        ("c_", "--profile standard --design environment_probe"),
        ("d_", "--profile standard --design highlight"),
    ] {
        directory.done(&format!("verilog {options} --prefix {prefix} -o {prefix}"));
        let names = ending(&directory.join(prefix), ".v");
        for name in &names {
            assert!(name.starts_with(prefix), "{name}");
            let text = directory.read(&format!("{prefix}/{name}"));
            assert!(text.contains(&format!("\nmodule {} ", name.trim_end_matches(".v"))), "{name}");
        }
        assert!(names.len() > 3 && names.iter().all(|name| all.insert(name.clone())));
    }
    assert!(all.contains("b_roughxel_ring.v") && all.contains("c_roughxel_delay.v"), "{all:?}");
}

#[test]
fn a_design_leaves_nothing_of_an_earlier_one_of_its_name_but_what_others_need_or_somebody_changed() {
    let directory = Folder::new();
    directory.done("verilog --profile narrow --multipliers 8 --stream 32 -o one");
    directory.done("verilog --profile narrow --design highlight -o one");
    std::fs::write(directory.join("one/roughxel_fragment.sdc"), "# mine\n").unwrap();
    let said = "files of the design that was there before were removed";
    directory.run("verilog --profile standard --multipliers 8 -o one").ends(0).complains(&[said]);
    directory.done("verilog --profile standard --multipliers 8 -o alone");
    directory.done("verilog --profile narrow --design highlight -o alone");
    for end in [".v", ".json", ".py", ".core", ".xml", ".h"] {
        assert_eq!(ending(&directory.join("one"), end), ending(&directory.join("alone"), end), "{end}");
    }
    assert_eq!(ending(&directory.join("one/rom"), ".hex"), ending(&directory.join("alone/rom"), ".hex"));
    assert_eq!(directory.read("one/roughxel_fragment.sdc"), "# mine\n");
}

#[test]
fn no_file_goes_that_another_design_may_need_or_that_lies_behind_a_link() {
    let directory = Folder::new();
    for prefix in ["a_", "b_"] {
        directory.done(&format!("verilog --profile narrow --stage columns --prefix {prefix} -o stages"));
    }
    let files = ending(&directory.join("stages"), ".v");
    assert!(files.contains("a_columns_pixel.v") && files.contains("b_columns_pixel.v"), "{files:?}");

    // A manifest that cannot be read may list anything.
    directory.done("verilog --profile narrow -o damaged");
    directory.done("verilog --profile narrow --design highlight -o damaged");
    let manifest = directory.read("damaged/roughxel_highlight.json");
    directory.write("damaged/roughxel_highlight.json", manifest + ",");
    let before = ending(&directory.join("damaged"), ".v");
    directory.done("verilog --profile standard -o damaged");
    assert!(ending(&directory.join("damaged"), ".v").is_superset(&before));

    #[cfg(unix)]
    {
        directory.done("verilog --profile narrow --multipliers 8 -o linked");
        let [folder, elsewhere] = ["linked/rom", "elsewhere"].map(|name| directory.join(name));
        std::fs::rename(&folder, &elsewhere).unwrap();
        std::os::unix::fs::symlink(&elsewhere, &folder).unwrap();
        let before = ending(&elsewhere, ".hex");
        directory.done("verilog --profile narrow --effects none -o linked");
        assert!(before.len() > 1 && ending(&elsewhere, ".hex").is_superset(&before));
    }
}
