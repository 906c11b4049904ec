//! Clocks of a program on a core, predicted from its instructions and the core's [`Latencies`].

use std::collections::{BTreeMap, BTreeSet};

use crate::Failure;
use crate::cores::Cache;
use crate::hart::{Hart, Kind, Step};
use crate::latencies::Latencies;
use crate::measure::{self, Numbers};

/// Marks of a program: a measured part begins and ends, and the program ends.
const BEGIN: u32 = 1;
const END: u32 = 2;
const FINISH: u32 = 0x5555;

/// Instructions of one kind or line, for each fragment.
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

/// Core as an instruction sees it: one runs after another, and waits for what it needs.
struct Pipeline<'a> {
    latencies: &'a Latencies,
    lines: Option<Lines>,
    now: f64,
    /// Clock at which each register can be read.
    ready: [f64; 32],
    /// Clock at which the memory takes an access.
    is_free: f64,
}

impl Pipeline<'_> {
    /// Runs an instruction and returns the clock at which it began.
    fn step(&mut self, step: &Step) -> f64 {
        let Step { address, kind, reads, writes, .. } = *step;
        if self.lines.as_mut().is_some_and(|lines| lines.misses(address)) {
            self.now += self.latencies.named("refill");
        }
        let mut begin = reads.iter().fold(self.now, |begin, &read| begin.max(self.ready[read]));
        if matches!(kind, Kind::Load | Kind::Store) {
            begin = begin.max(self.is_free);
            self.is_free = begin + self.latencies.gap(kind);
        }
        self.now = begin + self.latencies.taken(kind);
        if writes != 0 {
            self.ready[writes] = self.now + self.latencies.wait(kind);
        }
        begin
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

/// Fragments of a measured part of a program.
fn batch(numbers: &Numbers) -> Result<u64, Failure> {
    numbers.get("batch").copied().ok_or_else(|| Failure::trouble("a program does not print its batch"))
}

/// Clocks of a fragment, in the mean.
pub fn clocks(program: &[u8], latencies: &Latencies, cache: Option<Cache>) -> Result<u64, Failure> {
    let mut pipeline = Pipeline { latencies, lines: cache.map(Lines::new), now: 0.0, ready: [0.0; 32], is_free: 0.0 };
    let (mut begun, mut clocks, mut parts) = (0.0, 0.0, 0.0);
    let numbers = run(program, |step| {
        let at = pipeline.step(step);
        match step.mark {
            Some(BEGIN) => begun = at,
            Some(END) => {
                clocks += at - begun;
                parts += 1.0;
            }
            _ => {}
        }
    })?;
    Ok((clocks / parts / batch(&numbers)? as f64).round() as u64)
}

/// Instructions of a fragment by their kind, in the mean, and the check value of the program.
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
    let fragments = parts * batch(&numbers)?;
    counts.values_mut().for_each(|number| *number /= fragments);
    counts.insert(LINES, touched / parts);
    Ok((counts, numbers.get("check").copied()))
}
