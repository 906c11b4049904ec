//! Synthesises, places, routes and simulates generated designs, and writes `vectors/hdl/FLOORPLAN.md`.
//!
//! `cargo run --release -p roughxel-host-tests --bin floorplan -- --help` has the options. Netlists are kept below `target/floorplan` and figures in
//! `vectors/hdl/floorplan.json`: those of a netlist under a hash of text, options and version, those of a placement under a hash of its netlist,
//! options, seed and version. So a second run repeats only what has changed, and an interrupted one loses only the runs that were under way.
//!
//! Exit code 0 done, 1 a tool is missing or fails, or a netlist is wrong, 2 wrong arguments.

use std::process::ExitCode;

use clap::Parser;
use rayon::prelude::*;
use roughxel_core::precision::Profile;
use roughxel_host_tests::floorplan::cell::{Cell, Plan, Text};
use roughxel_host_tests::floorplan::device::{DEVICES, Device, stream_bits};
use roughxel_host_tests::floorplan::place::{self, Wish};
use roughxel_host_tests::floorplan::results::{self, CellResult, Kept, Outcome, Placement};
use roughxel_host_tests::floorplan::simulate::{Variant, simulate};
use roughxel_host_tests::floorplan::yosys::{self, Yosys};
use roughxel_host_tests::floorplan::{float, operations, page, picture, tools};
use roughxel_netlist::target::Target;

/// Synthesise, place and route generated designs; keep the figures; write the page.
#[derive(Parser)]
#[command(name = "floorplan")]
struct Arguments {
    /// Profiles: a comma list, default all.
    #[arg(long, value_delimiter = ',', value_name = "LIST", default_values_t = Profile::NAMES.map(str::to_owned), value_parser = parse_profile)]
    profiles: Vec<String>,
    /// Effects: a comma list of mirror, footprint, all.
    #[arg(long, value_delimiter = ',', value_name = "LIST", default_value = "mirror,footprint,all", value_parser = parse_plan)]
    plans: Vec<Plan>,
    /// Multipliers: a comma list of numbers, and `flat` for one for each product.
    #[arg(long, value_delimiter = ',', value_name = "LIST", default_value = "1,2,4,8,flat", value_parser = parse_multipliers)]
    multipliers: Vec<Multipliers>,
    /// Families: a comma list of ecp5, ice40, gowin, xc7.
    #[arg(long, value_delimiter = ',', value_name = "LIST", default_value = "ecp5,ice40,gowin,xc7", value_parser = parse_target)]
    targets: Vec<Target>,
    /// Devices on which designs are placed: a comma list, default all of the families.
    #[arg(long, value_delimiter = ',', value_name = "LIST", default_values_t = DEVICES.map(|device| device.name.to_owned()), value_parser = parse_device)]
    devices: Vec<String>,
    /// Seed of the placer.
    #[arg(long, default_value_t = 1, value_name = "N")]
    seed: u32,
    /// Place with the nextpnr of the system instead of its Python packages. It takes a third of the time, and other versions give other figures.
    #[arg(long)]
    native: bool,
    /// Minutes after which a placement is given up.
    #[arg(long, default_value_t = 30, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1440))]
    minutes: u32,
    /// Runs at the same time. One of a large design needs some 2 GiB of memory.
    #[arg(long, default_value_t = 1, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=64))]
    jobs: u8,
    /// Only list the runs that are not kept.
    #[arg(long, group = "instead")]
    list: bool,
    /// Simulate netlists of the designs instead, each with stalls and always ready.
    #[arg(long, group = "instead")]
    simulate: bool,
    /// Measure float32 units and count operations instead.
    #[arg(long, group = "instead")]
    float: bool,
    /// Only write page and picture from the kept figures.
    #[arg(long, group = "instead")]
    page: bool,
    /// Vectors of a simulation.
    #[arg(long, default_value_t = 200, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    vectors: u32,
}

/// Multipliers of a folded design, or a flat design.
#[derive(Clone, Copy)]
struct Multipliers(Option<u32>);

fn parse_profile(name: &str) -> Result<String, String> {
    let known = Profile::by_name(name).map(|_| name.to_owned());
    known.ok_or_else(|| format!("there are {}", Profile::NAMES.join(", ")))
}

fn parse_plan(name: &str) -> Result<Plan, String> {
    let known = Plan::ALL.into_iter().find(|plan| plan.name() == name);
    known.ok_or_else(|| format!("there are {}", Plan::ALL.map(Plan::name).join(", ")))
}

fn parse_multipliers(text: &str) -> Result<Multipliers, String> {
    if text == "flat" {
        return Ok(Multipliers(None));
    }
    let count = text.parse().ok().filter(|count| (1..=1024).contains(count));
    count.map(|count| Multipliers(Some(count))).ok_or_else(|| "a number from 1 to 1024, or flat".to_owned())
}

fn parse_target(name: &str) -> Result<Target, String> {
    let known = Target::by_name(name).filter(|&target| target != Target::Asic);
    known.ok_or_else(|| "there are ecp5, ice40, gowin, xc7".to_owned())
}

fn parse_device(name: &str) -> Result<String, String> {
    let known = Device::by_name(name).map(|device| device.name.to_owned());
    known.ok_or_else(|| format!("there are {}", DEVICES.map(|device| device.name).join(", ")))
}

impl Arguments {
    fn wish(&self) -> Wish {
        Wish { is_native: self.native, seed: self.seed, minutes: self.minutes }
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let kept = Kept::new(results::file(), tools::folder().join("lock"))?;
    let jobs = usize::from(arguments.jobs);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build().map_err(|e| e.to_string())?;
    pool.install(|| match arguments {
        Arguments { page: true, .. } => Ok(()),
        Arguments { simulate: true, .. } => simulations(arguments, &kept),
        Arguments { float: true, .. } => floats(arguments, &kept),
        _ => cells(arguments, &kept),
    })?;
    if arguments.list {
        return Ok(());
    }
    let results = kept.read()?;
    results::write(&page::file(), &page::text(&results))?;
    results::write(&picture::file(), &picture::svg(&results)?)?;
    println!("wrote {} and {}", page::file().display(), picture::file().display());
    Ok(())
}

/// Cells of the wished grid.
fn wished(arguments: &Arguments) -> Vec<Cell> {
    let mut cells = Vec::new();
    for &target in &arguments.targets {
        for &plan in &arguments.plans {
            for profile in &arguments.profiles {
                cells.extend(arguments.multipliers.iter().map(|&Multipliers(multipliers)| Cell {
                    profile: profile.clone(),
                    plan,
                    multipliers,
                    target,
                }));
            }
        }
    }
    cells
}

/// Runs all, and returns the first error after the last.
fn all<T: Sync>(items: &[T], one: impl Fn(&T) -> Result<(), String> + Sync) -> Result<(), String> {
    let errors: Vec<String> = items.par_iter().filter_map(|item| one(item).err()).collect();
    for error in errors.iter().skip(1) {
        eprintln!("error: {error}");
    }
    errors.into_iter().next().map_or(Ok(()), Err)
}

/// Synthesises and places cells.
fn cells(arguments: &Arguments, kept: &Kept) -> Result<(), String> {
    let yosys = Yosys::package()?;
    let devices: Vec<&Device> = arguments.devices.iter().filter_map(|name| Device::by_name(name)).collect();
    for device in devices.iter().filter(|device| arguments.targets.contains(&device.target)) {
        arguments.wish().program(device)?;
    }
    all(&wished(arguments), |cell| {
        let text = cell.text(Some(stream_bits(cell.target)))?;
        let key = yosys::key(&yosys, &text.hash, &text.shell(), cell.target)?;
        let name = cell.to_string();
        if kept.read()?.cells.get(&name).is_none_or(|known| known.key != key) {
            println!("{name}: synthesis");
            if !arguments.list {
                let mut result = synthesised(&yosys, cell, &text)?;
                kept.change(|results| {
                    // Placements of the same netlist stay.
                    result.placements = results.cells.remove(&name).map(|known| known.placements).unwrap_or_default();
                    result.placements.retain(|name, placement| is_of(placement, name, &result.netlist));
                    results.cells.insert(name.clone(), result);
                })?;
            }
        }
        for device in devices.iter().filter(|device| device.target == cell.target) {
            placed(arguments, &yosys, kept, cell, &text, device)?;
        }
        Ok(())
    })
}

fn synthesised(yosys: &Yosys, cell: &Cell, text: &Text) -> Result<CellResult, String> {
    let netlist = yosys::netlist(yosys, text, cell.target)?;
    let stream = stream_bits(cell.target);
    Ok(CellResult {
        profile: cell.profile.clone(),
        plan: cell.plan,
        multipliers: cell.multipliers,
        target: cell.target.name().to_owned(),
        interval: text.interval,
        latency: text.interface.latency,
        stream,
        words: text.words(stream),
        key: netlist.key,
        netlist: netlist.content,
        tool: yosys.version.clone(),
        area: netlist.area,
        alone: netlist.alone,
        placements: std::collections::BTreeMap::new(),
    })
}

/// True if a placement is one of a netlist on a device.
fn is_of(placement: &Placement, device: &str, netlist: &str) -> bool {
    let key = |device| place::key(netlist, &placement.tool, device, placement.seed);
    Device::by_name(device).is_some_and(|device| key(device) == placement.key)
}

/// True if a kept placement answers the wish. One by an old version does not, and one that was ended does not if there is more time now. One by the
/// other kind of program does.
fn answers(placement: &Placement, netlist: &str, device: &Device, wish: Wish) -> Result<bool, String> {
    let is_package = |tool: &str| tool.starts_with("yowasp-");
    let version = wish.program(device)?.version;
    let is_old = placement.tool != version && is_package(&placement.tool) == is_package(&version);
    let ended = matches!(placement.outcome, Outcome::OutOfTime { minutes: had } if had < wish.minutes);
    Ok(placement.key == place::key(netlist, &placement.tool, device, wish.seed) && !is_old && !ended)
}

fn placed(
    arguments: &Arguments,
    yosys: &Yosys,
    kept: &Kept,
    cell: &Cell,
    text: &Text,
    device: &Device,
) -> Result<(), String> {
    let name = cell.to_string();
    let key = yosys::key(yosys, &text.hash, &text.shell(), cell.target)?;
    let results = kept.read()?;
    if let Some(known) = results.cells.get(&name).filter(|known| known.key == key)
        && let Some(placement) = known.placements.get(device.name)
        && answers(placement, &known.netlist, device, arguments.wish())?
    {
        return Ok(());
    }
    println!("{name}: placement on {}", device.name);
    if arguments.list {
        return Ok(());
    }
    // A netlist that is not there any more is made again.
    let netlist = yosys::netlist(yosys, text, cell.target)?;
    let placement = place::place(&netlist.folder, &netlist.content, device, arguments.wish())?;
    println!("{name}: {} {:?} after {} s", device.name, placement.outcome, placement.seconds);
    kept.change(|results| {
        if let Some(cell) = results.cells.get_mut(&name) {
            cell.placements.insert(device.name.to_owned(), placement);
        }
    })
}

/// Simulates netlists.
fn simulations(arguments: &Arguments, kept: &Kept) -> Result<(), String> {
    let yosys = Yosys::package()?;
    let cells = wished(arguments).into_iter();
    let variants: Vec<Variant> =
        cells.flat_map(|cell| [false, true].map(|is_tied| Variant { cell: cell.clone(), is_tied })).collect();
    all(&variants, |variant| {
        let (name, text) = (variant.name(), variant.cell.text(None)?);
        let key = variant.key(&yosys, &text)?;
        if kept.read()?.simulations.get(&name).is_none_or(|known| known.key != key) {
            let folder = tools::folder().join("simulations").join(&name);
            let simulation = simulate(&yosys, variant, arguments.vectors as usize, &folder)?;
            println!("{name}: {} vectors, {:?}", simulation.vectors, simulation.mismatch);
            kept.change(|results| drop(results.simulations.insert(name.clone(), simulation)))?;
        }
        let mismatch = kept.read()?.simulations.get(&name).and_then(|known| known.mismatch.clone());
        mismatch.map_or(Ok(()), |mismatch| Err(format!("the netlist {name} is wrong: {mismatch}")))
    })
}

/// Measures float32 units, and counts operations.
fn floats(arguments: &Arguments, kept: &Kept) -> Result<(), String> {
    let yosys = Yosys::package()?;
    let wish = arguments.wish();
    all(&float::UNITS, |unit| {
        let results = kept.read()?;
        let Some(result) = float::measure(&yosys, unit, wish, results.float_units.get(unit.name))? else {
            return Ok(());
        };
        println!("{}: {:?}", unit.name, result.placement.outcome);
        kept.change(|results| drop(results.float_units.insert(unit.name.to_owned(), result)))
    })?;
    kept.change(|results| results.float_operations = operations::of_plans())
}
