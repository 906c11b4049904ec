//! Sets of one stage: every stage of every datapath is exported and verified, and its values are those of the whole datapath's set. Their
//! testbenches pass on generated and on hand-written modules and name the broken field.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use rayon::prelude::*;
use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_host_tests::simulators::{have, hdl};
use roughxel_host_tests::space::{in_turn, is_full_run, profiles, whole_or};
use roughxel_netlist::graph::{NodeId, Op};
use roughxel_netlist::verilog::{Options, Stages};
use roughxel_record as record;
use roughxel_vectors::{
    Cause, Device, Direction, Field, Form, Manifest, RANDOM_SETS, RandomSetSummary, SetExport, SetInfo, StageSet,
    Testbench, Vector, VectorError, Words, export_with, random_set, verify,
};

use super::benches::{have_cocotb, run_bench};
use super::folder::check_value;

/// Effects under which stages differ; together they include every stage.
fn variants() -> [Effects; 4] {
    let natural = FrameSystem::NaturalNormalised;
    let sphere = Effects { footprint: FootprintKind::Sphere, horizon: HorizonKind::Product, ..Effects::ALL };
    [
        Effects::ALL,
        Effects { frame: FrameSystem::Natural, ..Effects::NONE },
        sphere,
        Effects { frame: natural, roughness: RoughnessKind::Isotropic, curvature: false, ..sphere },
    ]
}

/// The random set of a datapath.
fn info(datapath: Datapath, effects: Effects, profile: &'static str, precision: Precision) -> SetInfo<'static> {
    let RandomSetSummary { name, description, .. } = RANDOM_SETS[datapath as usize];
    SetInfo { description, seed: Some(name), ..SetInfo::new(name, datapath, effects, profile, precision) }
}

/// Random sets of every datapath under every variant, in the profiles of this turn.
fn infos(turn: usize) -> Vec<(usize, SetInfo<'static>)> {
    let mut all = Vec::new();
    for (variant, effects) in variants().into_iter().enumerate() {
        for (profile, precision) in profiles().into_iter().filter(|(profile, _)| in_turn(variant + turn, profile)) {
            all.extend(Datapath::ALL.map(|datapath| (variant, info(datapath, effects, profile, precision))));
        }
    }
    all
}

/// Exports `count` base vectors of a stage.
fn export(set: &StageSet, info: &SetInfo<'_>, count: u64, directory: &Path) -> Manifest {
    let input = |index| random_set(info.datapath, info.name, index, &info.precision);
    SetExport::of_stage(info, count, set).write(&input, directory, &|_| {}).expect("the set can be written")
}

/// The stages of a datapath, and the path of each one's manifest.
fn stages(info: &SetInfo<'_>, name: Option<&str>) -> Vec<StageSet> {
    StageSet::select(info.datapath, &info.effects, &info.precision, name).expect("the datapath has stages")
}

fn manifest_path(directory: &Path, manifest: &Manifest) -> PathBuf {
    directory.join(format!("{}_{}.json", manifest.set, manifest.profile.name))
}

/// The digits of the words of a set.
fn digits(directory: &Path, manifest: &Manifest) -> Vec<String> {
    let text = fs::read_to_string(directory.join(&manifest.files[0].name)).expect("the words");
    text.lines().filter(|line| !line.starts_with("//")).map(|line| line.replace('_', "")).collect()
}

/// The integer of a field in the digits of a word, in units of 2^-64.
fn value(field: &Field, digits: &str) -> i128 {
    let end = digits.len() - field.lsb as usize / 4;
    let bits = i128::from_str_radix(&digits[end - field.digits() as usize..end], 16).expect("hex digits");
    let negative = field.signed && bits >> (field.width - 1) == 1;
    (bits - if negative { 1 << field.width } else { 0 }) << (64 - field.fraction_bits)
}

#[test]
fn every_stage_is_exported_verified_and_named_where_an_outcome_is_altered() {
    let count = whole_or(200, 20);
    for (_, info) in infos(0) {
        let directory = tempfile::tempdir().expect("a temporary directory");
        stages(&info, None).par_iter().enumerate().for_each(|(number, set)| {
            let manifest = export(set, &info, count, directory.path());
            let path = manifest_path(directory.path(), &manifest);
            let result = verify(&path, &|_| {}).expect("a set");
            assert!(result.passed(), "{} ({}): {:?}", manifest.set, info.profile, result.mismatches);
            assert_eq!(manifest.count, count * set.runs().len() as u64);

            // The lowest bit of a result, with the matching check value.
            let outcomes: Vec<&Field> =
                manifest.fields.iter().filter(|field| field.direction == Direction::Out).collect();
            let field = outcomes[number % outcomes.len()];
            let mut words = digits(directory.path(), &manifest);
            let index = number % words.len();
            let word = &mut words[index];
            let place = word.len() - 1 - field.lsb as usize / 4;
            let digit = u32::from_str_radix(&word[place..=place], 16).expect("a hex digit") ^ 1;
            word.replace_range(place..=place, &format!("{digit:x}"));
            let end = word.len() - 8;
            *word = format!("{}{:08x}", &word[..end], check_value(&word[..end]));
            let lines = words.iter().map(|word| separated(&manifest, word));
            let text = lines.fold(String::new(), |text, line| text + &line + "\n");
            fs::write(directory.path().join(&manifest.files[0].name), text).expect("the words can be written");

            let result = verify(&path, &|_| {}).expect("a set");
            let [mismatch] = &result.mismatches[..] else { panic!("{}: {result:?}", manifest.set) };
            let found = (mismatch.index, mismatch.field.as_str(), mismatch.stage.as_str(), mismatch.bit);
            assert_eq!(found, (index as u64, field.name.as_str(), set.name(), 0), "{}", manifest.set);
            assert_eq!((mismatch.cause, mismatch.fields_differing), (Cause::Computed, 1), "{}", manifest.set);
        });
    }
}

#[test]
fn the_python_model_is_right_on_the_stages_that_it_computes_alone_and_says_which_it_does_not() {
    if !have("python3") {
        return;
    }
    let directory = tempfile::tempdir().expect("a temporary directory");
    let mut sets = 0;
    for (variant, info) in infos(0) {
        let folder = directory.path().join(format!("{variant}_{}", info.profile));
        for set in stages(&info, None) {
            export(&set, &info, whole_or(100, 20), &folder);
            sets += 1;
        }
    }
    let model = |path: &Path| {
        let output = Command::new("python3").arg(hdl("../roughxel_model.py")).arg(path).output().expect("python3");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let (mut right, mut left) = (0, 0);
    for folder in fs::read_dir(directory.path()).expect("folders") {
        let (code, text, errors) = model(&folder.expect("a folder").path());
        assert_eq!((code, errors.as_str()), (Some(4), ""), "{text}");
        // The first line describes the tables.
        right += text.lines().skip(1).filter(|line| line.ends_with(", all right")).count();
        left += text.lines().filter(|line| line.ends_with(", read; the model does not compute it alone")).count();
    }
    assert_eq!(right + left, sets);
    assert!(5 * right > 2 * sets, "{right} of {sets}");
}

/// The digits of a word with an underscore between fields.
fn separated(manifest: &Manifest, digits: &str) -> String {
    let mut rest = digits;
    let parts = manifest.fields.iter().map(|field| {
        let (part, behind) = rest.split_at(field.digits() as usize);
        rest = behind;
        part
    });
    parts.collect::<Vec<_>>().join("_")
}

#[test]
fn a_stage_has_the_values_that_the_whole_datapath_has_of_the_same_wires() {
    let mut compared = 0;
    for (_, info) in infos(1) {
        let SetInfo { datapath, effects, profile, precision, .. } = info;
        let directory = tempfile::tempdir().expect("a temporary directory");
        let count = whole_or(200, 20);
        let input = |index| random_set(datapath, info.name, index, &precision);
        let whole = export_with(&info, count, &input, directory.path(), &|_| {}).expect("a set");
        let words = digits(directory.path(), &whole);

        let options = Options::new(profile, precision, effects);
        let Stages { net, stages: modules } = record::stages(Design::for_datapath(datapath), &options).expect("stages");
        // The path of the port or the output for a wire.
        let port = |id: NodeId| match net.node(id).op {
            Op::Port(port) => Some(&net.ports[port as usize].name),
            _ => net.outputs.iter().find(|output| output.node == id).map(|output| &output.name),
        };
        for (set, module) in stages(&info, None).iter().zip(&modules) {
            let manifest = export(set, &info, count, directory.path());
            let own = digits(directory.path(), &manifest);
            for (number, run) in module.runs.iter().enumerate() {
                for (&id, field) in run.inputs.iter().chain(&run.outputs).zip(&manifest.fields) {
                    let of_whole = port(id).and_then(|port| whole.fields.iter().find(|f| f.port == *port));
                    let Some(of_whole) = of_whole else { continue };
                    compared += 1;
                    for (base, word) in words.iter().enumerate() {
                        let vector = &own[base * module.runs.len() + number];
                        let values = (value(field, vector), value(of_whole, word));
                        assert_eq!(values.0, values.1, "{} #{base}: {}", manifest.set, field.name);
                    }
                }
            }
        }
    }
    assert!(compared > whole_or(1000, 300), "{compared} wires");
}

#[test]
fn a_set_of_a_stage_is_explained_read_as_records_and_refused_where_its_stage_is_another() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let words = Words { form: Form::Bin, ..Words::default() };
    let info = SetInfo { words, ..info(Datapath::Reflection, Effects::ALL, "standard", Precision::STANDARD) };
    let [set] = &stages(&info, Some("columns_pixel"))[..] else { panic!("one module") };
    let manifest = export(set, &info, 4, directory.path());
    let path = manifest_path(directory.path(), &manifest);
    assert!(verify(&path, &|_| {}).expect("a set").passed());

    let vector = Vector::read(&path, 7).expect("a vector");
    let device = vector.device_word(&["e_i20f0=1", "m_0_i2f20=0"]).expect("two fields");
    let explanation = vector.explain(Some(&device));
    assert_eq!(explanation.stage.as_deref(), Some("columns_pixel"));
    let wrong = explanation.wrong.expect("a difference");
    assert_eq!((wrong.stage.as_str(), wrong.field.as_str()), ("columns_pixel", "m_0_i2f20"));

    let text = fs::read_to_string(&path).expect("the manifest");
    for (from, to, problem) in [
        ("\"module\": \"columns_pixel\"", "\"module\": \"columns\"", "stage `columns` is no module"),
        ("\"module\": \"columns_pixel\"", "\"module\": \"half\"", "there is no stage `half`; there are "),
        (
            "columns_pixel_1\"\n",
            "columns_pixel_2\"\n",
            "the runs of stage `columns_pixel` are columns_pixel_0, columns_pixel_1",
        ),
        ("perturb_e_i18f0", "perturb_e_i17f0", "field 7 is `perturb_e_i17f0`"),
    ] {
        let changed = text.replace(from, to);
        assert_ne!(changed, text, "{from}");
        fs::write(&path, changed).expect("the manifest can be written");
        let error = Manifest::read(&path).expect_err(from);
        assert!(matches!(error, VectorError::Manifest { .. }) && error.to_string().contains(problem), "{error}");
    }
}

/// A testbench of a stage of a random set.
struct Written {
    directory: tempfile::TempDir,
    stem: String,
}

impl Written {
    fn new(set: &StageSet, info: &SetInfo<'_>, count: u64, device: Device) -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let manifest = export(set, info, count, directory.path());
        let bench = Testbench::new(&manifest_path(directory.path(), &manifest)).expect("a set");
        let written = Self { directory, stem: bench.stem() };
        bench.write(&written.path(""), device, false).expect("the testbench can be written");
        written
    }

    fn path(&self, file: &str) -> PathBuf {
        self.directory.path().join(&self.stem).join(file)
    }

    /// Exit code and output of `run.sh`.
    fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        run_bench(&self.path(""), arguments)
    }

    fn passes(&self, tool: &str) {
        let (code, text) = self.run(&[tool, "--stalls"]);
        assert!(code == Some(0) && text.contains(&format!("PASS {}: ", self.stem)), "{tool}: {text}");
    }
}

#[test]
fn the_generated_module_of_every_stage_passes_its_bench() {
    if !have("iverilog") {
        return;
    }
    let benches: Vec<_> = infos(0)
        .into_iter()
        .flat_map(|(_, info)| stages(&info, None).into_iter().map(move |set| (set, info)))
        .collect();
    assert!(benches.len() > 150, "{} modules", benches.len());
    benches.par_iter().step_by(whole_or(1, 40)).for_each(|(set, info)| {
        Written::new(set, info, 20, Device::Generated).passes("icarus");
    });
}

/// A hand-written module: its stage, the other files that it needs, the text to break, its broken form, and the field that shows it.
const BY_HAND: [(&str, &[&str], &str, &str, &str); 3] = [
    ("reflect", &["normalise.v"], "twice - back", "twice + back", "r_m_0_i2f20"),
    ("perturb", &["normalise.v"], "flat ? n_e : sum_e", "flat ? n_e : sum_e + 1", "e_i18f0"),
    ("cube_face", &["half_reciprocal.v"], "sc =  x; tc =  z;", "sc =  x; tc = -z;", "st_1_i2f20"),
];

/// Hand-written VHDL modules, in the same form.
const BY_HAND_IN_VHDL: [(&str, &[&str], &str, &str, &str); 2] = [
    ("reflect", &["normalise.vhd"], "twice - back", "twice + back", "r_m_0_i2f20"),
    ("cube_face", &["half_reciprocal.vhd"], "s_c <= x;  t_c <= z;", "s_c <= x;  t_c <= -z;", "st_1_i2f20"),
];

/// A testbench of a hand-written stage, and the file of its module.
fn by_hand(stage: &str, others: &[&str], extensions: (&str, &str)) -> (Written, PathBuf) {
    let info = info(Datapath::Reflection, Effects::ALL, "standard", Precision::STANDARD);
    let [set] = &stages(&info, Some(stage))[..] else { panic!("one module") };
    let written = Written::new(set, &info, 64, Device::Blank);
    let (module, device) = (format!("{stage}.{}", extensions.0), format!("{stage}_device.{}", extensions.1));
    let copy = |from: PathBuf, to: &str| fs::copy(from, written.path(to)).expect("the file can be copied");
    fs::create_dir(written.path("rtl")).expect("the folder can be made");
    copy(hdl(&format!("handwritten/{device}")), &format!("{}_device.{}", written.stem, extensions.1));
    for file in others.iter().copied().chain([module.as_str()]) {
        copy(hdl(&format!("handwritten/{file}")), &format!("rtl/{file}"));
    }
    copy(hdl("../rom/reciprocal_10.hex"), "rtl/reciprocal_10.hex");
    let module = written.path("rtl").join(module);
    (written, module)
}

fn break_module(module: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(module).expect("the module");
    assert_eq!(text.matches(from).count(), 1, "{}", module.display());
    fs::write(module, text.replace(from, to)).expect("the module can be written");
}

fn names(written: &Written, tool: &str, stage: &str, field: &str) {
    let (code, text) = written.run(&[tool, "--stop", "2"]);
    assert_eq!(code, Some(3), "{tool}: {text}");
    let first = text.lines().find(|line| line.starts_with(&format!("{} #", written.stem))).unwrap_or_default();
    assert!(first.contains(&format!(": stage {stage}, field {field}: expected ")), "{tool}: {text}");
}

#[test]
fn stages_written_by_hand_pass_their_benches_and_broken_ones_are_named() {
    let tools = [("icarus", "iverilog"), ("verilator", "verilator"), ("cpp", "verilator"), ("cocotb", "iverilog")];
    for (number, (stage, others, from, to, field)) in BY_HAND.into_iter().enumerate() {
        // Tools that take seconds to build test one of the stages in turn.
        let meets = |place: usize| place == 0 || is_full_run() || place == number + 1;
        let tools: Vec<&str> = (0..)
            .zip(tools)
            .filter(|&(place, (tool, program))| meets(place) && have(program) && (tool != "cocotb" || have_cocotb()))
            .map(|(_, (tool, _))| tool)
            .collect();
        let (written, module) = by_hand(stage, others, ("v", "sv"));
        tools.iter().for_each(|tool| written.passes(tool));
        break_module(&module, from, to);
        tools.iter().filter(|&&tool| is_full_run() || tool != "verilator" && tool != "cpp").for_each(|tool| {
            names(&written, tool, stage, field);
        });
    }
}

#[test]
fn stages_written_by_hand_in_vhdl_pass_their_benches_and_broken_ones_are_named() {
    if !have("ghdl") {
        return;
    }
    for (stage, others, from, to, field) in BY_HAND_IN_VHDL {
        let (written, module) = by_hand(stage, others, ("vhd", "vhd"));
        written.passes("ghdl");
        break_module(&module, from, to);
        names(&written, "ghdl", stage, field);
    }
}
