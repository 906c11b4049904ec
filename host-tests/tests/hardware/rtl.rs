//! Generated Verilog is the datapath: it lints clean, and its simulation gives the bits of the scalar backend.
//!
//! Vectors are fragments (plausible ones, corner bit patterns, every hard case) and integers anywhere in the declared ranges of the ports; expected
//! values are those of the scalar stages. The committed vectors are read from their files, outputs included. A missing tool is named in the output,
//! and fails the test if ROUGHXEL_REQUIRE_TOOLS is set.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock};

use rayon::prelude::*;
use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects, FrameSystem, HorizonKind};
use roughxel_core::precision::{Precision, Profile, RoughnessKind};
use roughxel_host_tests::declarations::used_before_declared;
use roughxel_host_tests::designs::{expected, inputs};
use roughxel_host_tests::simulators::{have, hdl, run, verilate};
use roughxel_host_tests::space::{in_turn, is_full_run, profiles, whole_or};
use roughxel_netlist::bench::Bench;
use roughxel_netlist::graph::{Net, Op};
use roughxel_netlist::interval::Ranges;
use roughxel_netlist::verilog::{Interface, Options, PortDescription, Verilog, VerilogError};
use roughxel_record as record;
use roughxel_utilities::output::write_files;
use roughxel_vectors::{Direction, Field, Manifest, manifests_in};
use tempfile::TempDir;

pub(super) const FULL: Effects = Effects::ALL;

/// The variants that change a datapath.
pub(super) fn variants_of(datapath: Datapath) -> Vec<(&'static str, Effects)> {
    let mut distinct: Vec<(&str, Effects)> = Vec::new();
    for (name, effects) in variants() {
        let own = effects.restricted_to(datapath);
        if distinct.iter().all(|(_, known)| *known != own) {
            distinct.push((name, own));
        }
    }
    distinct
}

/// Effects that change the existing hardware.
fn variants() -> [(&'static str, Effects); 5] {
    [
        ("full", FULL),
        ("mirror", Effects::NONE),
        ("smooth", Effects { roughness: RoughnessKind::None, ..FULL }),
        (
            "natural",
            Effects {
                frame: FrameSystem::Natural,
                roughness: RoughnessKind::Isotropic,
                horizon: HorizonKind::Product,
                ..FULL
            },
        ),
        ("normalised", Effects { frame: FrameSystem::NaturalNormalised, ..FULL }),
    ]
}

pub(super) fn options(profile: &str, effects: Effects, depth: Option<u32>) -> Options {
    let precision = Profile::by_name(profile).map(Profile::precision).expect("a profile");
    Options { depth, ..Options::new(profile, precision, effects) }
}

/// A design in its own directory.
pub(super) struct Written {
    directory: TempDir,
    pub(super) verilog: Verilog,
}

impl Written {
    fn new(design: Design, options: &Options) -> Self {
        Self::from_verilog(
            record::verilog(design, options)
                .unwrap_or_else(|error| panic!("{} {}: {error}", design.name(), options.profile)),
        )
    }

    /// Writes the files of a design.
    ///
    /// # Panics
    /// If a name is used above its declaration.
    pub(super) fn from_verilog(verilog: Verilog) -> Self {
        for (name, text) in verilog.files.iter().filter(|(name, _)| name.ends_with(".v")) {
            assert_eq!(used_before_declared(text), [], "{name}");
        }
        let directory = tempfile::tempdir_in(runtime()).expect("a temporary directory");
        write_files(directory.path(), verilog.in_order()).expect("the directory can be written");
        Self { directory, verilog }
    }

    pub(super) fn path(&self) -> &Path {
        self.directory.path()
    }

    /// The outermost module.
    fn outermost(&self) -> &Interface {
        self.verilog.stepper.as_ref().or(self.verilog.top.as_ref()).expect("a top")
    }

    pub(super) fn lint(&self) {
        let module = &self.outermost().module;
        let mut command = Command::new("verilator");
        command.args(["--lint-only", "-Wall", "--top-module", module, "-y"]).arg(self.path());
        run(command.arg(self.path().join(format!("{module}.v"))));
    }

    /// Simulates with Icarus, with random pauses of the handshake.
    pub(super) fn icarus(&self, bench: &Bench) {
        let text = self.simulate(bench);
        assert!(text.contains("PASS"), "{} in Icarus: {text}", bench.module());
    }

    /// Output of the testbench in Icarus.
    pub(super) fn simulate(&self, bench: &Bench) -> String {
        self.simulate_files(bench.files())
    }

    /// Output of a testbench with these files in Icarus.
    pub(super) fn simulate_files(&self, files: Vec<(String, Vec<u8>)>) -> String {
        write_files(self.path(), files).expect("the directory can be written");
        let compiled = self.path().join("bench.vvp");
        let mut command = Command::new("iverilog");
        command.args(["-g2005", "-s", "bench", "-I"]).arg(self.path()).arg("-y").arg(self.path());
        run(command.arg("-o").arg(&compiled).arg(hdl("bench.v")));
        let output = run(Command::new("vvp").arg("-N").arg(&compiled).arg("+stalls").current_dir(self.path()));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Runs the Verilator model of the outermost module on the vectors of a testbench.
    fn verilator(&self, bench: &Bench, arguments: &[&str]) -> Output {
        write_files(self.path(), bench.files()).expect("the directory can be written");
        let program = self.model(bench);
        Command::new(&program).arg(self.path()).args(arguments).output().expect("the model was built")
    }

    /// The Verilator model of the outermost module, built once for all tests that write the same text.
    fn model(&self, bench: &Bench) -> PathBuf {
        static MODELS: Mutex<BTreeMap<(String, String), Arc<Model>>> = Mutex::new(BTreeMap::new());
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        let text = format!("{:?}", self.verilog.files);
        let model = {
            let mut models = MODELS.lock().expect("no test panics while it holds the list");
            Arc::clone(models.entry((bench.module().to_string(), text)).or_default())
        };
        let build = || {
            // A few thousand cycles: the compile time saved exceeds the run time lost.
            let built = verilate(self.path(), bench.module(), "OPT_FAST=-O0 VM_PARALLEL_BUILDS=0");
            let program = runtime().join(format!("model-{}", NUMBER.fetch_add(1, Ordering::Relaxed)));
            // Not copied: a file open for writing anywhere cannot be run.
            fs::rename(built, &program).expect("a model can be kept");
            program
        };
        model.get_or_init(build).clone()
    }
}

/// The program of a model, built by its first user.
type Model = OnceLock<PathBuf>;

fn runtime() -> &'static Path {
    Path::new(env!("CARGO_TARGET_TMPDIR"))
}

/// A design with vectors and the results of the scalar backend.
pub(super) struct Case {
    pub(super) written: Written,
    pub(super) inputs: Vec<Vec<i64>>,
    pub(super) outputs: Vec<Vec<i64>>,
}

impl Case {
    pub(super) fn new(design: Design, count: usize, options: &Options) -> Self {
        let (effects, p) = (&options.effects, &options.precision);
        let net = record::net(design, effects, p);
        let inputs = inputs(design, &net, count, effects, p);
        let outputs = inputs.iter().map(|ports| expected(design, ports, effects, p)).collect();
        Self { written: Written::new(design, options), inputs, outputs }
    }

    fn top(&self) -> &Interface {
        self.written.verilog.top.as_ref().expect("a top")
    }

    pub(super) fn bench(&self) -> Bench<'_> {
        Bench::new(self.top(), &self.inputs, &self.outputs).expect("the ports hold the vectors")
    }

    pub(super) fn verilate(&self, arguments: &[&str]) {
        let output = self.written.verilator(&self.bench(), arguments);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.starts_with("PASS"), "{} in Verilator: {text}", self.top().module);
        println!("{}: {}", self.top().module, text.trim());
    }
}

#[test]
fn every_design_lints_clean() {
    if !have("verilator") {
        return;
    }
    for (profile, _) in profiles() {
        for (_, &design) in Design::ALL.iter().enumerate().filter(|(index, _)| in_turn(*index, profile)) {
            Written::new(design, &options(profile, FULL, None)).lint();
        }
        for datapath in Datapath::ALL {
            for (_, (_, effects)) in variants_of(datapath).into_iter().enumerate().filter(|(i, _)| in_turn(*i, profile))
            {
                Written::new(Design::for_datapath(datapath), &options(profile, effects, None)).lint();
            }
        }
        let pipelined = [Design::Reflection, Design::Highlight, Design::LitPeak, Design::EnvironmentProbe];
        for (_, design) in pipelined.into_iter().enumerate().filter(|(index, _)| in_turn(*index, profile)) {
            Written::new(design, &options(profile, FULL, Some(24))).lint();
        }
    }
}

/// Icarus 13 refuses a name above its declaration, which Icarus 11 accepts. [`Written::from_verilog`] looks at every generated design.
#[test]
fn verilog_in_the_repository_declares_names_above_their_use() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folders = [
        "vectors/hdl",
        "vectors/hdl/handwritten",
        "vectors/c",
        "vectors/templates/systemverilog",
        "emulator/netlist/src/verilog/templates",
        "emulator/hardware_frame/src/templates",
        "emulator/firmware/cores",
        "host-tests/src/floorplan",
    ];
    for folder in folders {
        let files = fs::read_dir(root.join(folder)).expect("a folder of the repository");
        let paths = files.map(|file| file.expect("a folder can be read").path());
        let is_verilog = |path: &PathBuf| path.extension().is_some_and(|it| it == "v" || it == "vh" || it == "sv");
        let verilog: Vec<PathBuf> = paths.filter(is_verilog).collect();
        assert!(!verilog.is_empty(), "{folder} has no Verilog");
        for path in verilog {
            let text = fs::read_to_string(&path).expect("Verilog is text");
            assert_eq!(used_before_declared(&text), [], "{}", path.display());
        }
    }
}

#[test]
fn every_design_gives_the_scalar_bits_in_icarus() {
    if !have("iverilog") {
        return;
    }
    let is_top = |design: &Design| Datapath::ALL.iter().any(|&datapath| Design::for_datapath(datapath) == *design);
    for (profile, _) in profiles() {
        for (_, &design) in Design::ALL.iter().enumerate().filter(|(index, it)| is_top(it) || in_turn(*index, profile))
        {
            let mut case = Case::new(design, 400, &options(profile, FULL, None));
            // About 200 fragments a second: every twentieth fragment, hard cases included.
            if case.inputs.len() > 1000 {
                case.inputs = case.inputs.into_iter().step_by(20).collect();
                case.outputs = case.outputs.into_iter().step_by(20).collect();
            }
            case.written.icarus(&case.bench());
        }
    }
    let pipelined = Case::new(Design::EnvironmentProbe, 400, &options("standard", FULL, Some(24)));
    pipelined.written.icarus(&pipelined.bench());
}

#[test]
fn verilated_reflection_gives_the_scalar_bits_in_every_profile() {
    if !have("verilator") {
        return;
    }
    for (profile, _) in profiles() {
        if is_full_run() || profile == "standard" {
            Case::new(Design::Reflection, whole_or(100_000, 20_000), &options(profile, FULL, None)).verilate(&[]);
        }
    }
}

/// The integers of the fields of a committed set, one word per vector, as its manifest describes them.
fn words_of(manifest: &Path) -> (Manifest, Vec<Vec<i64>>) {
    let text = fs::read_to_string(manifest).expect("a manifest");
    let manifest_of: Manifest = serde_json::from_str(&text).expect("a manifest of this version");
    let hex = fs::read_to_string(manifest.with_file_name(&manifest_of.files[0].name)).expect("the words of the set");
    let words = hex.lines().filter(|line| !line.starts_with("//")).map(|line| {
        let digits = line.split('_').map(|field| u64::from_str_radix(field, 16).expect("hex digits"));
        let fields = digits.zip(&manifest_of.fields).map(|(bits, field)| {
            let spare = 64 - field.width;
            let bits = bits << spare;
            if field.signed { bits.cast_signed() >> spare } else { (bits >> spare).cast_signed() }
        });
        fields.collect()
    });
    let words: Vec<Vec<i64>> = words.collect();
    assert_eq!(words.len() as u64, manifest_of.count);
    (manifest_of, words)
}

/// Vectors of a committed set as ports and outputs of its datapath's design, whose wires carry whole port words. The hardware for the effects of
/// the set has a port for each of its fields, and no other.
fn set_vectors(net: &Net, top: &Interface, manifest: &Manifest, words: &[Vec<i64>]) -> (Vec<Vec<i64>>, Vec<Vec<i64>>) {
    let is_input = |field: &&Field| field.direction == Direction::In;
    let is_output = |field: &&Field| matches!(field.direction, Direction::Tap | Direction::Out);
    let fields_of = |wanted: &dyn Fn(&&Field) -> bool| -> BTreeSet<&str> {
        manifest.fields.iter().filter(wanted).map(|field| field.port.as_str()).collect()
    };
    let ports_of =
        |ports: &'_ [PortDescription]| -> BTreeSet<String> { ports.iter().map(|port| port.name.clone()).collect() };
    assert!(fields_of(&is_input).iter().copied().eq(ports_of(&top.inputs).iter()), "{}", manifest.set);
    assert!(fields_of(&is_output).iter().copied().eq(ports_of(&top.outputs).iter()), "{}", manifest.set);

    // A field drops the low bits that its profile does not keep; a port without a field is unread, or constant.
    let whole = |name: &str, is_wanted: &dyn Fn(&&Field) -> bool, point: u32, word: &[i64]| {
        let mut fields = manifest.fields.iter().zip(word).filter(|(field, _)| is_wanted(field));
        let found = fields.find(|(field, _)| field.port == name);
        found.map_or(0, |(field, value)| value << (point - field.fraction_bits))
    };
    let vectors = words.iter().map(|word| {
        let inputs = net.ports.iter().map(|port| whole(&port.name, &is_input, port.fraction_bits, word));
        let outputs = net.outputs.iter().map(|output| whole(&output.name, &is_output, output.fraction_bits, word));
        (inputs.collect(), outputs.collect())
    });
    vectors.unzip()
}

#[test]
fn the_committed_vectors_run_in_both_simulators() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/smoke");
    let mut cases: Vec<(Design, Options, Case)> = Vec::new();
    let mut read = 0;
    for path in manifests_in(&directory).expect("the committed sets") {
        let (manifest, words) = words_of(&path);
        let options = options(&manifest.profile.name, manifest.effects, None);
        let design = Design::for_datapath(manifest.datapath);
        let net = record::net(design, &options.effects, &options.precision);
        read += words.len();
        let same = |known: &&mut (Design, Options, Case)| {
            let (of, with, _) = known;
            *of == design && with.effects == options.effects && with.profile == options.profile
        };
        if cases.iter_mut().find(same).is_none() {
            let written = Written::new(design, &options);
            cases.push((design, options.clone(), Case { written, inputs: Vec::new(), outputs: Vec::new() }));
        }
        if let Some((.., case)) = cases.iter_mut().find(same) {
            let (inputs, outputs) = set_vectors(&net, case.top(), &manifest, &words);
            case.inputs.extend(inputs);
            case.outputs.extend(outputs);
        }
    }
    assert!(read >= 3000, "{read} vectors");
    let all = is_full_run();
    cases.into_par_iter().for_each(|(design, options, case)| {
        println!("{} {} {:?}: {} vectors", design.name(), options.profile, options.effects, case.inputs.len());
        if have("iverilog") {
            case.written.icarus(&case.bench());
        }
        // Other tests verilate these effects, too, so the model is built once.
        let is_shared = options.profile == "standard"
            && options.effects == FULL.restricted_to(design.datapath().expect("a datapath"));
        if have("verilator") && (all || is_shared) {
            case.verilate(&["stalls"]);
        }
    });
}

#[test]
fn verilated_designs_plans_and_pipelines_give_the_scalar_bits() {
    if !have("verilator") {
        return;
    }
    let quick = [Design::Highlight, Design::LitPeak, Design::Texture];
    let mut cases = vec![(Design::EnvironmentProbe, 2000, options("compact", FULL, Some(24)))];
    for design in Design::ALL.iter().copied().filter(|&design| design != Design::Reflection) {
        if is_full_run() || quick.contains(&design) {
            cases.push((design, whole_or(20_000, 2000), options("standard", FULL, None)));
        }
    }
    if is_full_run() {
        for datapath in Datapath::ALL {
            for ((_, effects), profile) in variants_of(datapath).into_iter().skip(1).zip(Profile::NAMES) {
                cases.push((Design::for_datapath(datapath), 10_000, options(profile, effects, None)));
            }
            cases.push((Design::for_datapath(datapath), 10_000, options("compact", FULL, Some(24))));
        }
    }
    // One compiler on one processor takes most of their time.
    cases.into_par_iter().for_each(|(design, count, options)| {
        Case::new(design, count, &options).verilate(&["stalls"]);
    });
}

#[test]
fn a_stepper_walks_the_probes_of_every_footprint() {
    let p = Precision::STANDARD;
    let steps = [(Design::EnvironmentProbe, None), (Design::EnvironmentProbe, Some(24)), (Design::TextureProbe, None)];
    for (design, depth) in steps {
        let options = options("standard", FULL, depth);
        let written = Written::new(design, &options);
        let net = record::net(design, &FULL, &p);
        let stepper = written.verilog.stepper.as_ref().expect("a step has a stepper");
        let place = |port: &str| net.ports.iter().position(|p| p.name == port).expect("a port of a step");
        let [index, lod, count] = [place("index"), place("probes.lod"), place("probes.count")];

        let (mut footprints, mut steps) = (Vec::new(), Vec::new());
        for ports in inputs(design, &net, whole_or(3000, 600), &FULL, &p) {
            let outcome = expected(design, &ports, &FULL, &p);
            if ports[index] == 0 {
                footprints.push(ports.clone());
            }
            let last = i64::from(ports[index] + 1 == ports[count]);
            steps.push([outcome.as_slice(), &[ports[lod], last]].concat());
        }
        // The set may end within a footprint.
        while steps.last().is_some_and(|step| step.last() == Some(&0)) {
            steps.pop();
        }
        footprints.truncate(steps.iter().filter(|step| step.last() == Some(&1)).count());
        let bench = Bench::new(stepper, &footprints, &steps).expect("the ports hold the vectors");
        if have("iverilog") {
            written.icarus(&bench);
        }
        if have("verilator") {
            let output = written.verilator(&bench, &["stalls"]);
            let text = String::from_utf8_lossy(&output.stdout);
            assert!(text.starts_with("PASS"), "{} stepper in Verilator: {text}", design.name());
        }
    }
}

#[test]
fn both_benches_name_the_first_wire_that_differs() {
    let mut case = Case::new(Design::Texture, 20, &options("compact", FULL, None));
    let names: Vec<_> = case.top().outputs.iter().map(|port| port.name.clone()).collect();
    let wrong = names.iter().position(|name| name == "axes.direction[1]").expect("an output");
    // The last bit that has a wire.
    case.outputs[7][wrong] ^= 1 << case.top().outputs[wrong].dropped_zeros;
    case.outputs[7][wrong + 1] ^= 1;
    let found = "vector 7: axes.direction[1] is ";
    if have("verilator") {
        let output = case.written.verilator(&case.bench(), &[]);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.starts_with(found), "{text}");
        assert_eq!(output.status.code(), Some(3));
    }
    if have("iverilog") {
        let text = case.written.simulate(&case.bench());
        assert!(text.starts_with(found) && text.contains("FAIL"), "{text}");
    }
}

#[test]
fn yosys_takes_every_top() {
    if !have("yosys") {
        return;
    }
    let check = |design: Design, options: &Options| {
        let written = Written::new(design, options);
        let module = &written.outermost().module;
        let script = format!("read_verilog *.v; hierarchy -check -top {module}; proc; check -assert");
        run(Command::new("yosys").args(["-q", "-p", &script]).current_dir(written.path()));
    };
    for profile in Profile::NAMES.into_iter().filter(|_| is_full_run()) {
        for design in
            [Design::Reflection, Design::Fragment, Design::Texture, Design::EnvironmentProbe, Design::TextureProbe]
        {
            check(design, &options(profile, FULL, None));
        }
    }
    for (index, &design) in Design::ALL.iter().enumerate() {
        let in_turn = Profile::NAMES[index % Profile::NAMES.len()];
        check(design, &options(in_turn, FULL, None));
        if is_full_run() && in_turn != "standard" {
            check(design, &options("standard", FULL, None));
        }
    }
    check(Design::Reflection, &options("compact", FULL, Some(24)));
}

#[test]
fn compact_and_paper_multiply_18_by_18_bits() {
    for (profile, p) in [("paper", Precision::PAPER), ("compact", Precision::COMPACT)] {
        let variants = Datapath::ALL.into_iter().flat_map(|datapath| {
            let record = move |effects| record::net(Design::for_datapath(datapath), &effects, &p);
            variants_of(datapath).into_iter().map(move |(name, effects)| (name, record(effects)))
        });
        for (variant, net) in variants {
            let ranges = Ranges::new(&net);
            for (id, node) in net.iter() {
                let Op::Mul(a, b) = node.op else { continue };
                // An unsigned operand needs a sign in a signed multiplier.
                let bits = |id| ranges.of(id).width() + u32::from(!ranges.of(id).signed());
                let widest = bits(a).max(bits(b));
                assert!(widest <= 18, "{profile} {variant}: {widest} bits at {}", net.origin(id));
            }
        }
    }
}

#[test]
fn the_text_is_the_same_every_time_and_names_no_machine() {
    let options = options("standard", FULL, Some(30));
    let (first, second) =
        (record::verilog(Design::Reflection, &options), record::verilog(Design::Reflection, &options));
    let (first, second) = (first.expect("the Verilog"), second.expect("the Verilog"));
    assert_eq!(first.files, second.files);
    for (name, text) in &first.files {
        assert!(text.is_ascii(), "{name}");
        assert!(!text.contains("/rustc/") && !text.contains(env!("CARGO_MANIFEST_DIR")), "{name} names a machine");
    }
}

#[test]
fn runs_of_a_block_share_a_module() {
    let verilog = record::verilog(Design::Reflection, &options("compact", FULL, None)).expect("the Verilog");
    let top = &verilog.files["roughxel_reflection.v"];
    for (module, runs) in [("columns_pixel", 2), ("columns_roughness", 2), ("enter_dview", 2), ("axes", 1)] {
        assert!(verilog.files.contains_key(&format!("{module}.v")));
        assert_eq!(top.matches(&format!("\n  {module} u_")).count(), runs, "{module}");
    }
}

#[test]
fn a_stage_comes_alone_and_an_impossible_wish_is_refused() {
    let one = Options { stage: Some("columns".into()), ..options("compact", FULL, None) };
    let verilog = record::verilog(Design::Reflection, &one).expect("the Verilog");
    assert!(verilog.top.is_none());
    let names: Vec<&str> = verilog.files.keys().map(String::as_str).collect();
    assert!(names.contains(&"columns_pixel.v") && names.contains(&"columns.json"), "{names:?}");
    assert!(!names.contains(&"axes.v"), "{names:?}");

    let unknown = Options { stage: Some("colums".into()), ..one.clone() };
    let error = record::verilog(Design::Reflection, &unknown).expect_err("there is no such stage");
    assert!(error.to_string().contains("columns_pixel"), "{error}");
    let error = record::verilog(Design::Reflection, &options("compact", FULL, Some(3))).expect_err("3 levels");
    assert!(matches!(error, VerilogError::TooDeep { depth: 3, .. }), "{error}");

    // No profile has seventeen probes, and the tables end at sixteen.
    let beyond =
        Options { precision: Precision { max_probes: 17, ..Precision::COMPACT }, ..options("compact", FULL, None) };
    let error = record::verilog(Design::Reflection, &beyond).expect_err("the proof fails");
    assert!(error.to_string().contains("core/src/stage/probes.rs"), "{error}");
}
