//! The page of the floor plan, `vectors/hdl/FLOORPLAN.md`: everything in it comes from the kept results.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use roughxel_netlist::target::Target;

use super::cell::units;
use super::device::{Area, DEVICES};
use super::results::{CellResult, Outcome, Placement, Results};
use crate::imports::workspace_root;

/// Frames a second of the last column.
const FRAMES: f64 = 30.0;

/// Sizes of frames, smallest first.
const SIZES: [[u32; 2]; 12] = [
    [80, 60],
    [160, 120],
    [240, 160],
    [320, 240],
    [400, 300],
    [480, 320],
    [640, 480],
    [800, 600],
    [1024, 768],
    [1280, 720],
    [1600, 900],
    [1920, 1080],
];

/// Family on the page.
struct Family {
    target: Target,
    title: &'static str,
    /// Resources of devices by their data sheets.
    holds: &'static str,
    /// Names of its cells.
    cells: [&'static str; 6],
}

const FAMILIES: [Family; 4] = [
    Family {
        target: Target::Ecp5,
        title: "Lattice ECP5",
        holds: "An LFE5U-25F has 24 288 LUT4, 28 MULT18X18D and 56 DP16KD.",
        cells: ["LUT4", "CCU2C", "MULT18X18D", "DPR16X4", "DP16KD", "FF"],
    },
    Family {
        target: Target::Ice40,
        title: "Lattice iCE40",
        holds: "An iCE40UP5K has 5280 SB_LUT4, 8 SB_MAC16 and 30 SB_RAM40.",
        cells: ["SB_LUT4", "SB_CARRY", "SB_MAC16", "–", "SB_RAM40", "FF"],
    },
    Family {
        target: Target::Gowin,
        title: "Gowin GW2A",
        holds: "A GW2A-18 has 20 736 LUT (an ALU takes the place of one), 15 552 FF, 48 MULT18X18 and 46 BSRAM.",
        cells: ["LUT", "ALU", "MULT18X18", "RAM16", "BSRAM", "FF"],
    },
    Family {
        target: Target::Xc7,
        title: "AMD 7 series (synthesis)",
        holds: "An XC7A15T has 10 400 LUT and 45 DSP48E1, an XC7A35T 20 800 and 90.",
        cells: ["LUT", "CARRY4", "DSP48E1", "RAM, SRL", "RAMB", "FF"],
    },
];

/// Path of the page.
pub fn file() -> PathBuf {
    workspace_root().join("vectors/hdl/FLOORPLAN.md")
}

/// Largest frame that a rate of fragments fills 30 times a second, one fragment a pixel.
pub fn frame(fragments: f64) -> Option<[u32; 2]> {
    SIZES.into_iter().rev().find(|[width, height]| f64::from(width * height) * FRAMES <= fragments)
}

impl CellResult {
    /// Fragments a second of a placement; none if it was not placed.
    pub fn fragments(&self, placement: &Placement) -> Option<f64> {
        match placement.outcome {
            Outcome::Placed { megahertz } => Some(1e6 * megahertz / f64::from(self.interval)),
            Outcome::OutOfTime { .. } | Outcome::Failed { .. } => None,
        }
    }

    /// Lookup tables of four inputs that cells fill on ECP5: a carry cell is two of them, a memory four and two that write it.
    pub fn ecp5_luts(area: &Area) -> u64 {
        area.luts + 2 * area.carries + 6 * area.memories
    }
}

/// Text of a table with these columns.
fn table(columns: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let rule = vec!["---"; columns.len()];
    let mut text = format!("| {} |\n| {} |\n", columns.join(" | "), rule.join(" | "));
    for row in rows {
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
    text
}

/// Whole page.
pub fn text(results: &Results) -> String {
    let mut tools: Vec<&str> = results.cells.values().map(|cell| cell.tool.as_str()).collect();
    let placements = results.cells.values().flat_map(|cell| cell.placements.values());
    tools.extend(placements.map(|placement| placement.tool.as_str()));
    tools.sort_unstable();
    tools.dedup();
    let mut text = format!(
        "# Floor plan of accuracy\n\n\
         Made by `cargo run --release -p roughxel-host-tests --bin floorplan` from [`floorplan.json`](floorplan.json).\n\
         Tools: {}.\n\n\
         A row is the datapath `reflection` in its AXI4-Stream shell, synthesised, placed and routed. Its outputs are the footprint and the status.\n\
         K is the number of multipliers on which the design is folded; `flat` has one for each product. Interval and latency are in cycles.\n\
         Cells are those of Yosys with the shell; in brackets those without it, if they are others.\n\
         The clock is what nextpnr reports, so the design runs between registers of the shell.\n\
         Words are those of a fragment and of its outcome in the stream (32 bits, on iCE40 8). A stream with more words than the interval is the limit:\n\
         a design that is not alone on its device has its neighbours in the place of the shell.\n\
         10⁶ fragments a second are clock ÷ interval. A frame has one fragment a pixel, {FRAMES} times a second.\n\n\
         ![Error of s, t against lookup tables of an ECP5](floorplan.svg)\n",
        tools.join("; ")
    );
    for Family { target, title, holds, cells: names } in FAMILIES {
        let cells: Vec<&CellResult> = results.cells.values().filter(|cell| cell.target == target.name()).collect();
        if !cells.is_empty() {
            let _ = write!(text, "\n## {title}\n\n{holds}\n\n{}", family(target, names, cells));
        }
    }
    if !results.float_units.is_empty() {
        text += &float(results);
    }
    if !results.simulations.is_empty() {
        text += &simulations(results);
    }
    text
}

/// Table of a family, a row for each placement.
fn family(target: Target, names: [&str; 6], mut cells: Vec<&CellResult>) -> String {
    cells.sort_by_key(|cell| (cell.plan, cell.profile.clone(), cell.multipliers.unwrap_or(u32::MAX)));
    let mut columns = vec!["plan", "profile", "K", "interval", "latency", "words"];
    columns.extend(names);
    let is_placed = DEVICES.iter().any(|device| device.target == target);
    if is_placed {
        columns.extend(["device", "clock, MHz", "10⁶ fragments/s", "frame"]);
    }
    let mut rows = Vec::new();
    for cell in cells {
        let mut start = vec![
            cell.plan.name().to_owned(),
            format!("`{}`", cell.profile),
            units(cell.multipliers),
            cell.interval.to_string(),
            cell.latency.to_string(),
            format!("{} + {}", cell.words[0], cell.words[1]),
        ];
        let pairs = counts(&cell.area).into_iter().zip(counts(&cell.alone));
        start.extend(pairs.map(|(all, alone)| if alone == all { all.to_string() } else { format!("{all} ({alone})") }));
        let devices = DEVICES.iter().filter_map(|device| Some((device.name, cell.placements.get(device.name)?)));
        let before = rows.len();
        rows.extend(devices.map(|(device, placement)| [start.clone(), placed(cell, device, placement)].concat()));
        if rows.len() == before {
            start.extend(vec!["–".to_owned(); columns.len() - start.len()]);
            rows.push(start);
        }
    }
    table(&columns, rows)
}

fn counts(area: &Area) -> [u64; 6] {
    [area.luts, area.carries, area.multipliers, area.memories, area.blocks, area.registers]
}

/// Last four columns of a placement.
fn placed(cell: &CellResult, device: &str, placement: &Placement) -> Vec<String> {
    let clock = match &placement.outcome {
        Outcome::Placed { megahertz } => format!("{megahertz:.1}"),
        Outcome::OutOfTime { minutes } => format!("not routed in {minutes} minutes"),
        Outcome::Failed { reason } => match fullest(&placement.used) {
            Some((kind, [used, available])) => format!("too large: {used} of {available} {kind}"),
            None => format!("no: {}", reason.replace('|', "/")),
        },
    };
    let fragments = cell.fragments(placement);
    let rate = fragments.map_or("–".to_owned(), |rate| format!("{:.2}", rate / 1e6));
    let size = fragments.and_then(frame).map_or("–".to_owned(), |[width, height]| format!("{width}×{height}"));
    vec![device.to_owned(), clock, rate, size]
}

/// Kind of cells of which the device has too few.
fn fullest(used: &BTreeMap<String, [u64; 2]>) -> Option<(&String, [u64; 2])> {
    let too_many = used.iter().filter(|(_, [used, available])| used > available);
    too_many.map(|(kind, counts)| (kind, *counts)).max_by_key(|(_, [used, available])| 1000 * used / available.max(&1))
}

/// Section of float32.
fn float(results: &Results) -> String {
    let tools = results.float_units.values().next().map_or("", |unit| unit.tools.as_str());
    let rows = results.float_units.iter().map(|(name, unit)| {
        let clock = match unit.placement.outcome {
            Outcome::Placed { megahertz } => format!("{megahertz:.1}"),
            Outcome::OutOfTime { .. } | Outcome::Failed { .. } => "–".to_owned(),
        };
        let all = counts(&unit.area).map(|count| count.to_string());
        [vec![name.clone(), unit.latency.to_string()], all.to_vec(), vec![clock]].concat()
    });
    let columns = ["unit", "latency", "LUT4", "CCU2C", "MULT18X18D", "DPR16X4", "DP16KD", "FF", "clock, MHz"];
    let mut text = format!(
        "\n## The same mathematics in float32\n\n\
         Units for ECP5 ({tools}; LFE5U-25F). They round to nearest and have no NaN and no subnormal numbers.\n\n{}\n\
         Operations of a fragment in `roughxel-f32-baseline`, counted as it runs. Comparisons, choices, signs, factors of two and conversions are not \
         counted.\n\n",
        table(&columns, rows)
    );
    let kinds: Vec<&String> = results.float_units.keys().collect();
    let columns: Vec<&str> = ["plan"].into_iter().chain(kinds.iter().map(|kind| kind.as_str())).collect();
    let count = |plan: &str, kind: &str| {
        results.float_operations.get(plan).and_then(|kinds| kinds.get(kind)).copied().unwrap_or_default()
    };
    let operations = results
        .float_operations
        .keys()
        .map(|plan| [plan.clone()].into_iter().chain(kinds.iter().map(|kind| count(plan, kind).to_string())).collect());
    text += &table(&columns, operations);
    text += "\nUnits for the interval of a folded design: operations ÷ interval, rounded up, of each kind. Lookup tables are LUT4 + 2 CCU2C + 6 DPR16X4.\n\
             The float32 side is a lower bound: nothing chooses operands, keeps values or schedules, and the design on the other side has all of that \
             and its shell.\n\n";
    let mut cells: Vec<&CellResult> = results.cells.values().filter(|cell| cell.target == "ecp5").collect();
    cells.sort_by_key(|cell| (cell.plan, cell.profile.clone(), cell.multipliers.unwrap_or(u32::MAX)));
    let rows = cells.into_iter().map(|cell| {
        let needed: Vec<u64> =
            kinds.iter().map(|kind| u64::from(count(cell.plan.name(), kind).div_ceil(cell.interval))).collect();
        let total = |of: &dyn Fn(&Area) -> u64| -> u64 {
            results.float_units.values().zip(&needed).map(|(unit, count)| of(&unit.area) * count).sum()
        };
        let list: Vec<String> = kinds.iter().zip(&needed).map(|(kind, count)| format!("{count} {kind}")).collect();
        vec![
            cell.plan.name().to_owned(),
            format!("`{}`", cell.profile),
            units(cell.multipliers),
            cell.interval.to_string(),
            CellResult::ecp5_luts(&cell.area).to_string(),
            cell.area.multipliers.to_string(),
            list.join(", "),
            total(&CellResult::ecp5_luts).to_string(),
            total(&|area| area.multipliers).to_string(),
        ]
    });
    let columns = [
        "plan",
        "profile",
        "K",
        "interval",
        "lookup tables",
        "MULT18X18D",
        "float32 units",
        "their lookup tables",
        "their MULT18X18D",
    ];
    text + &table(&columns, rows)
}

/// Section of netlists in a simulator.
fn simulations(results: &Results) -> String {
    let rows = results.simulations.iter().map(|(name, simulation)| {
        let outcome = simulation.mismatch.clone().unwrap_or_else(|| "0 mismatches".to_owned());
        vec![format!("`{name}`"), simulation.tools.clone(), simulation.vectors.to_string(), outcome.replace('|', "/")]
    });
    format!(
        "\n## Netlists in a simulator\n\n\
         The netlist of Yosys runs with the models of cells of Yosys on fragments, hard cases and corner integers; the scalar backend gives the outcomes.\n\
         `stalls`: both sides of the handshake pause. `always-ready`: the receiver is tied to 1 before synthesis, so registers lose their enable.\n\
         In Verilator, what would be x is 0 in a first run, 1 in a second and a drawn bit in a third; a test takes \
         a multiplier out of a netlist, and the outcomes differ.\n\
         Tables and rings are in LUTs and registers on Gowin and series 7, for there are no models of their memory blocks (`-nobram`, no `ram_style`).\n\
         Yosys has no models of MULT18X18D and DP16KD (ECP5) and of MULT18X18 (Gowin). They are in \
         [`models.v`](../../host-tests/src/floorplan/models.v): products without registers, and memories that give x if a word is read while it is \
         written.\n\n{}",
        table(&["netlist", "tools", "vectors", "outcome"], rows)
    )
}
