//! Clocks of a program on a core, predicted from its instructions and the core's [`Latencies`].

use std::collections::{BTreeMap, BTreeSet};

use crate::Failure;
use crate::cores::{Cache, Core};
use crate::hart::{Hart, Kind, Step};
use crate::latencies::Latencies;
use crate::measure::{self, Numbers};

/// Marks of a program: a measured part begins and ends, and the program ends.
const BEGIN: u32 = 1;
const END: u32 = 2;
const FINISH: u32 = 0x5555;

/// Instructions of one kind, or lines, for each fragment or probe.
pub type Counts = BTreeMap<&'static str, u64>;

/// Count of the distinct lines that the measured parts touch.
const LINES: &str = "lines of 32 bytes";

/// Names of the counts, in the order of a table.
pub const COUNTED: [&str; 12] = [
    "all",
    "plain",
    "shifts",
    "places",
    "products",
    "high products",
    "loads",
    "stores",
    "branches taken",
    "branches passed",
    "jumps",
    LINES,
];

/// Instruction cache whose places hold one line each.
struct Lines {
    cache: Cache,
    held: Vec<Option<u32>>,
}

impl Lines {
    fn new(cache: Cache) -> Self {
        Self { cache, held: vec![None; (cache.bytes / cache.line) as usize] }
    }

    /// Returns true if the line of an address is not held, and holds it.
    fn misses(&mut self, address: u32) -> bool {
        let line = address / self.cache.line;
        let place = line as usize % self.held.len();
        self.held[place].replace(line) != Some(line)
    }
}

/// Clocks of a kind of instruction.
#[derive(Clone, Copy)]
struct Delays {
    taken: f64,
    wait: f64,
    gap: f64,
}

/// Core as an instruction sees it: one runs after another, and waits for what it needs.
struct Pipeline<'a> {
    latencies: &'a Latencies,
    /// Clocks of the kinds that have run, by their places.
    known: [Option<Delays>; Kind::COUNT],
    lines: Option<Lines>,
    refill: f64,
    now: f64,
    /// Clock at which each register can be read.
    ready: [f64; 32],
    /// Clock at which the memory takes an access.
    is_free: f64,
    /// Clock at which the last measured part began.
    begun: f64,
    /// Clocks of all measured parts.
    clocks: f64,
}

impl<'a> Pipeline<'a> {
    fn new(latencies: &'a Latencies, cache: Option<Cache>) -> Self {
        Self {
            latencies,
            known: [None; Kind::COUNT],
            lines: cache.map(Lines::new),
            refill: latencies.named("refill"),
            now: 0.0,
            ready: [0.0; 32],
            is_free: 0.0,
            begun: 0.0,
            clocks: 0.0,
        }
    }

    /// Runs an instruction.
    fn step(&mut self, step: &Step) {
        let Step { address, kind, reads, writes, mark } = *step;
        if self.lines.as_mut().is_some_and(|lines| lines.misses(address)) {
            self.now += self.refill;
        }
        let latencies = self.latencies;
        let delays = self.known[kind.place()].get_or_insert_with(|| Delays {
            taken: latencies.taken(kind),
            wait: latencies.wait(kind),
            gap: latencies.gap(kind),
        });
        let mut begin = reads.iter().fold(self.now, |begin, &read| begin.max(self.ready[read]));
        if matches!(kind, Kind::Load | Kind::Store) {
            begin = begin.max(self.is_free);
            self.is_free = begin + delays.gap;
        }
        self.now = begin + delays.taken;
        if writes != 0 {
            self.ready[writes] = self.now + delays.wait;
        }
        match mark {
            Some(BEGIN) => self.begun = begin,
            Some(END) => self.clocks += begin - self.begun,
            _ => {}
        }
    }
}

/// Runs a program, calls a function with each instruction, and returns the numbers that the program prints.
fn run(program: &[u8], mut each: impl FnMut(&Step)) -> Result<Numbers, Failure> {
    let mut hart = Hart::new(program)?;
    loop {
        let step = hart.step()?;
        each(&step);
        if step.mark == Some(FINISH) {
            return Ok(measure::numbers(&hart.printed));
        }
    }
}

/// Fragments or probes that the measured parts of a program have together.
fn units(numbers: &Numbers) -> Result<u64, Failure> {
    let units = numbers.get("units").copied().filter(|&units| units > 0);
    units.ok_or_else(|| Failure::trouble("a program does not print its units"))
}

/// Mean clocks of a unit, from the clocks of all measured parts and the numbers that a program prints.
pub fn mean(clocks: f64, numbers: &Numbers) -> Result<u64, Failure> {
    Ok((clocks / units(numbers)? as f64).round() as u64)
}

/// Core with its latencies.
pub type Known = (&'static Core, Latencies);

/// Mean clocks of a unit of a program by the names of cores, and the check value of the program. It runs once.
pub fn clocks(program: &[u8], cores: &[Known]) -> Result<(Numbers, Option<u64>), Failure> {
    let mut pipelines: Vec<Pipeline> =
        cores.iter().map(|(core, latencies)| Pipeline::new(latencies, core.cache)).collect();
    let numbers = run(program, |step| pipelines.iter_mut().for_each(|pipeline| pipeline.step(step)))?;
    let means = cores.iter().zip(&pipelines);
    let means = means.map(|((core, _), pipeline)| Ok((core.name.into(), mean(pipeline.clocks, &numbers)?)));
    Ok((means.collect::<Result<_, Failure>>()?, numbers.get("check").copied()))
}

/// Mean instructions of a unit by their kind, and the check value of the program.
pub fn counts(program: &[u8]) -> Result<(Counts, Option<u64>), Failure> {
    let mut counts = Counts::from(COUNTED.map(|name| (name, 0)));
    let (mut is_measured, mut parts) = (false, 0);
    let (mut lines, mut touched) = (BTreeSet::new(), 0);
    let numbers = run(program, |step| {
        if step.mark == Some(END) {
            (is_measured, parts) = (false, parts + 1);
            touched += lines.len() as u64;
            lines.clear();
        }
        if is_measured {
            lines.insert(step.address / 32);
            let mut count = |name, number| *counts.entry(name).or_default() += number;
            count("all", 1);
            let name = match step.kind {
                Kind::Plain | Kind::Comparison | Kind::Quotient => "plain",
                Kind::Left(places) | Kind::Right(places) => {
                    count("places", places as u64);
                    "shifts"
                }
                Kind::Product => "products",
                Kind::HighProduct => "high products",
                Kind::Load => "loads",
                Kind::Store => "stores",
                Kind::Branch { is_taken: true, .. } => "branches taken",
                Kind::Branch { is_taken: false, .. } => "branches passed",
                Kind::Jump | Kind::JumpRegister => "jumps",
            };
            count(name, 1);
        }
        is_measured |= step.mark == Some(BEGIN);
    })?;
    let units = units(&numbers)?;
    counts.values_mut().for_each(|number| *number /= units);
    counts.insert(LINES, touched / parts);
    Ok((counts, numbers.get("check").copied()))
}
