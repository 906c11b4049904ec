//! Clocks of the kinds of instructions on a core: a row of numbers, measured by the program `latencies`.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use crate::Failure;
use crate::cores::Cache;
use crate::hart::Kind;
use crate::measure::Numbers;

/// Repetitions that the program measures.
const REPETITIONS: f64 = 32.0;
/// Instructions of the straight code that it measures.
const STRAIGHT: f64 = 4096.0;
/// Bytes of an instruction.
const BYTES: f64 = 4.0;

/// Names of the clocks that every core has.
const NAMES: [&str; 15] = [
    "plain",
    "plain wait",
    "comparison",
    "shift wait",
    "load",
    "load wait",
    "load to load",
    "store",
    "store to store",
    "forward taken",
    "forward passed",
    "backward taken",
    "backward passed",
    "jump",
    "jump by register",
];

/// Clocks of a core for each kind of instruction.
///
/// An instruction takes the clocks of its kind. The next one that needs its result waits. Another access to memory waits until the bus is free.
#[derive(Clone, Debug)]
pub struct Latencies {
    clocks: BTreeMap<String, f64>,
    left: Vec<f64>,
    right: Vec<f64>,
}

impl Latencies {
    /// Row of the numbers that the program prints.
    pub fn measured(numbers: &Numbers, cache: Option<Cache>) -> Result<Self, Failure> {
        let difference = |name: &str| -> Result<f64, Failure> {
            let number = |size: &str| numbers.get(&format!("{name} {size}")).copied();
            let (Some(few), Some(many)) = (number("few"), number("many")) else {
                return Err(Failure::trouble(format!("no latency of {name}")));
            };
            Ok(many as f64 - few as f64)
        };
        let body = |name: &str| Ok::<f64, Failure>(difference(name)? / REPETITIONS);
        let plain = body("plain")?;
        let shifts = |way: &str| (0..32).map(|places| body(&format!("{places} {way}"))).collect::<Result<Vec<_>, _>>();
        let (left, right) = (shifts("left")?, shifts("right")?);
        let mut clocks = BTreeMap::from([("plain", plain)]);
        let has_products = numbers.contains_key("product few");
        for name in ["product", "high product", "quotient"].into_iter().filter(|_| has_products) {
            clocks.insert(name, body(name)?);
        }
        let wait =
            |of: &str, alone: f64| Ok::<f64, Failure>((body(&format!("{of} with use"))? - alone - plain).max(0.0));
        for (name, of) in [("product wait", "product"), ("high product wait", "high product")] {
            if has_products {
                clocks.insert(name, wait(of, clocks[of])?);
            }
        }
        clocks.insert("comparison", body("comparison")?);
        clocks.insert("plain wait", wait("plain", plain)?);
        clocks.insert("shift wait", wait("shift", left[1])?);
        let (load_after_load, load) = (body("load")?, body("load after seven")? - 7.0 * plain);
        clocks.insert("load", load);
        clocks.insert("load wait", wait("load", load_after_load)?);
        clocks.insert("load to load", load_after_load);
        clocks.insert("store", body("store after seven")? - 7.0 * plain);
        clocks.insert("store to store", body("store")?);
        let (taken, jump) = (body("forward taken")?, body("jump")?);
        clocks.insert("forward taken", taken);
        clocks.insert("forward passed", body("forward passed")?);
        clocks.insert("backward taken", body("forward twice and backward taken")? - 2.0 * taken);
        clocks.insert("backward passed", body("backward passed")?);
        clocks.insert("jump", jump);
        clocks.insert("jump by register", body("two jumps and one by register")? - 2.0 * jump);
        if let Some(cache) = cache {
            let lines = STRAIGHT * BYTES / f64::from(cache.line);
            clocks.insert("refill", (difference("straight code")? - STRAIGHT * plain) / lines);
        }
        let clocks = clocks.into_iter().map(|(name, clocks)| (name.to_string(), clocks)).collect();
        Ok(Self { clocks, left, right })
    }

    /// Row as it is kept.
    pub fn kept(&self) -> Value {
        let mut row: Map<String, Value> =
            self.clocks.iter().map(|(name, clocks)| (name.clone(), json!(clocks))).collect();
        for (name, shifts) in [("left", &self.left), ("right", &self.right)] {
            let shifts: Vec<String> = shifts.iter().map(f64::to_string).collect();
            row.insert(name.into(), json!(shifts.join(" ")));
        }
        Value::Object(row)
    }

    /// Reads a kept row.
    pub fn read(row: &Value) -> Option<Self> {
        let shifts = |name: &str| -> Option<Vec<f64>> {
            let shifts: Vec<f64> =
                row[name].as_str()?.split(' ').map(|clocks| clocks.parse().ok()).collect::<Option<_>>()?;
            (shifts.len() == 32).then_some(shifts)
        };
        let numbers = row.as_object()?.iter();
        let clocks: BTreeMap<String, f64> =
            numbers.filter_map(|(name, clocks)| Some((name.clone(), clocks.as_f64()?))).collect();
        NAMES.iter().all(|name| clocks.contains_key(*name)).then_some(())?;
        Some(Self { clocks, left: shifts("left")?, right: shifts("right")? })
    }

    /// Clocks of a name; 0 if the core has no multiplier or no cache.
    pub fn named(&self, name: &str) -> f64 {
        self.clocks.get(name).copied().unwrap_or(0.0)
    }

    /// Clocks of an instruction.
    pub fn taken(&self, kind: Kind) -> f64 {
        self.named(match kind {
            Kind::Left(places) => return self.left[places],
            Kind::Right(places) => return self.right[places],
            Kind::Plain => "plain",
            Kind::Comparison => "comparison",
            Kind::Product => "product",
            Kind::HighProduct => "high product",
            Kind::Quotient => "quotient",
            Kind::Load => "load",
            Kind::Store => "store",
            Kind::Branch { is_taken: true, is_backward: false } => "forward taken",
            Kind::Branch { is_taken: false, is_backward: false } => "forward passed",
            Kind::Branch { is_taken: true, is_backward: true } => "backward taken",
            Kind::Branch { is_taken: false, is_backward: true } => "backward passed",
            Kind::Jump => "jump",
            Kind::JumpRegister => "jump by register",
        })
    }

    /// Clocks that the next instruction waits if it needs the result.
    pub fn wait(&self, kind: Kind) -> f64 {
        self.named(match kind {
            Kind::Left(_) | Kind::Right(_) => "shift wait",
            Kind::Product => "product wait",
            Kind::HighProduct => "high product wait",
            Kind::Load => "load wait",
            _ => "plain wait",
        })
    }

    /// Clocks from one access to memory to the next one.
    pub fn gap(&self, kind: Kind) -> f64 {
        self.named(if kind == Kind::Load { "load to load" } else { "store to store" })
    }
}
