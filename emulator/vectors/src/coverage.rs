//! Coverage of sets. Every fault of the netlist ([`roughxel_netlist::fault`]) is tried on every vector until a field shows
//! it, and every bin ([`roughxel_netlist::bins`]) is counted. The values that fields and wires attain are compared with the
//! proven ranges.
//!
//! Sets of the same datapath, effects, profile and columns are graded together: the coverage of a folder is that of all its sets.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use roughxel_netlist::bins::{Bin, Bins};
use roughxel_netlist::fault::{Effect, Fault, Faults, Simulator};
use roughxel_netlist::interval::Ranges;
use roughxel_netlist::observe::Observed;
use roughxel_netlist::redundant_faults::Prover;
use roughxel_netlist::table_check::{Exhaustion, Task};
use serde::Serialize;

use super::VectorError;
use super::coverage_count::{Coverage, CoverageEntry};
use super::files::write_manifest;
use super::layout::Layout;
use super::lines::Lines;
use super::manifest::Manifest;
use super::outcomes::Outcomes;

/// Vectors that faults process at once: their wires fit a processor's cache.
const BATCH: usize = 32;
/// Faults of a task.
const TASK: usize = 256;

/// The faults of a stage.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StageCoverage {
    /// The stage, in all its uses; `ports` of those that go in.
    pub stage: String,
    /// Bits of wires that are stuck.
    pub stuck: Coverage,
    /// Operations that are others.
    pub slips: Coverage,
}

/// A table.
#[derive(Clone, Debug, Serialize)]
pub struct TableCoverage {
    /// Its name.
    pub table: String,
    /// Entries that are read.
    pub read: Coverage,
    /// Entries that are off by a last place, up and down.
    pub entries: Coverage,
}

/// A fault that no field shows.
#[derive(Clone, Debug, Serialize)]
pub struct Unseen {
    /// The fault and its location.
    pub fault: String,
    /// True if it changed its own wire, but no field.
    pub masked: bool,
}

/// The integers of a field.
#[derive(Clone, Debug, Serialize)]
pub struct Attained {
    /// The field.
    pub field: String,
    /// Its stage.
    pub stage: String,
    /// Proven range of its wire.
    pub proven: [i64; 2],
    /// Range of its values in the sets.
    pub seen: [i64; 2],
}

/// An irregularity of sets.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Alarm {
    /// A field that is the same in every vector.
    Constant {
        /// The field.
        field: String,
    },
    /// Vectors whose inputs repeat those of an earlier one.
    Repeated {
        /// Number of vectors.
        vectors: u64,
    },
}

impl Alarm {
    /// The field that is constant.
    pub fn constant(&self) -> Option<&str> {
        match self {
            Self::Constant { field } => Some(field),
            Self::Repeated { .. } => None,
        }
    }
}

/// Coverage of the sets of a datapath, its effects and a profile.
#[derive(Clone, Debug, Serialize)]
pub struct CoverageReport {
    /// The datapath.
    pub datapath: &'static str,
    /// The module of the stage, for sets of a stage.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<String>,
    /// The profile.
    pub profile: String,
    /// True if fields between the ports count.
    pub taps: bool,
    /// Names of the sets.
    pub sets: Vec<String>,
    /// Their vectors.
    pub vectors: u64,
    /// The faults stage by stage, in the order of the pipeline.
    pub stages: Vec<StageCoverage>,
    /// The tables.
    pub tables: Vec<TableCoverage>,
    /// Flags on either side and comparisons at their limits.
    pub decisions: Coverage,
    /// The faults that are not seen.
    pub unseen: Vec<Unseen>,
    /// Table entries that may be off by a last place, as proven: they are not counted.
    pub equal_entries: Vec<String>,
    /// The bins that are not met.
    pub unmet: Vec<String>,
    /// Values of the fields.
    pub fields: Vec<Attained>,
    /// Irregularities of the sets.
    pub alarms: Vec<Alarm>,
}

impl CoverageReport {
    /// All faults.
    pub fn faults(&self) -> Coverage {
        let CoverageEntry { stuck, operations, entries, .. } = self.entry();
        stuck.and(operations).and(entries)
    }

    /// What a manifest says of it.
    pub fn entry(&self) -> CoverageEntry {
        let sum = |counts: &mut dyn Iterator<Item = Coverage>| counts.fold(Coverage::default(), Coverage::and);
        CoverageEntry {
            stuck: sum(&mut self.stages.iter().map(|stage| stage.stuck)),
            operations: sum(&mut self.stages.iter().map(|stage| stage.slips)),
            entries: sum(&mut self.tables.iter().map(|table| table.entries)),
            decisions: self.decisions,
        }
    }
}

/// Grades each set alone and writes the coverage into its manifest, which is replaced as a whole or not at all. `progress` gets
/// the number of finished vectors.
///
/// Errors: see [`VectorError`].
pub fn write_coverage(manifests: &[PathBuf], progress: &dyn Fn(u64)) -> Result<Vec<CoverageReport>, VectorError> {
    let (mut done, mut reports) = (0, Vec::new());
    for sets in by_design(manifests)? {
        // Proofs for a design hold for each of its sets.
        let alone: Vec<_> = sets.chunks(1).collect();
        cover_parts(&alone, &mut |vectors| progress(done + vectors), &mut |part, report| {
            let (path, manifest) = &sets[part];
            write_manifest(path, &Manifest { grade: Some(report.entry()), ..manifest.clone() })?;
            reports.push((manifests.iter().position(|of| of == path), report));
            Ok(())
        })?;
        done += sets.iter().map(|(_, manifest)| manifest.count).sum::<u64>();
    }
    reports.sort_by_key(|&(place, _)| place);
    Ok(reports.into_iter().map(|(_, report)| report).collect())
}

/// Grades the sets of manifests, those of one design together; `progress` gets the number of finished vectors.
///
/// Errors: see [`VectorError`].
pub fn coverage(manifests: &[PathBuf], progress: &dyn Fn(u64)) -> Result<Vec<CoverageReport>, VectorError> {
    let (mut done, mut reports) = (0, Vec::new());
    for sets in by_design(manifests)? {
        cover_parts(&[&sets], &mut |vectors| progress(done + vectors), &mut |_, report| {
            reports.push(report);
            Ok(())
        })?;
        done += sets.iter().map(|(_, manifest)| manifest.count).sum::<u64>();
    }
    Ok(reports)
}

/// Sets with their manifests.
type Sets = Vec<(PathBuf, Manifest)>;

/// The sets of manifests, grouped by design.
fn by_design(manifests: &[PathBuf]) -> Result<Vec<Sets>, VectorError> {
    let mut groups: Vec<Sets> = Vec::new();
    for path in manifests {
        let manifest = Manifest::read(path)?;
        match groups.iter_mut().find(|sets| is_of_one_design(&sets[0].1, &manifest)) {
            Some(sets) => sets.push((path.clone(), manifest)),
            None => groups.push(vec![(path.clone(), manifest)]),
        }
    }
    Ok(groups)
}

/// Returns true if sets are of the same hardware and show the same fields.
pub(super) fn is_of_one_design(a: &Manifest, b: &Manifest) -> bool {
    let of = |manifest: &Manifest| (manifest.datapath, manifest.effects, manifest.profile.knobs, manifest.taps);
    of(a) == of(b) && a.stage == b.stage
}

/// Grades parts of the sets of one design, each alone; `progress` is told how many vectors are done, and `graded` the number of a part and its
/// grade.
fn cover_parts(
    parts: &[&[(PathBuf, Manifest)]],
    progress: &mut dyn FnMut(u64),
    covered: &mut dyn FnMut(usize, CoverageReport) -> Result<(), VectorError>,
) -> Result<(), VectorError> {
    let (path, of) = &parts[0][0];
    let layout = of.layout(path)?;
    let outcomes = Outcomes::new(of, &layout);
    let ranges = Ranges::new(&outcomes.net);
    let faults = Faults::new(&outcomes.net, &ranges, outcomes.shown());
    let bins = Bins::new(&outcomes.net, &ranges, &faults.tables);
    let (mut proofs, mut done) = (Proofs::default(), 0);
    for (number, sets) in parts.iter().enumerate() {
        let mut tally = Tally::new(&outcomes, &faults, &bins);
        for (path, manifest) in *sets {
            read_words(path, manifest, &layout, &mut |_, batch| {
                tally.add(&manifest.set, &batch.iter().map(|bits| outcomes.ports(bits)).collect::<Vec<_>>());
                done += batch.len() as u64;
                progress(done);
            })?;
        }
        covered(number, tally.report(of, &ranges, &mut proofs))?;
    }
    Ok(())
}

/// Reads the fields' bits of a set, some vectors at a time, with the index of the first of them.
pub(super) fn read_words(
    path: &Path,
    manifest: &Manifest,
    layout: &Layout,
    batch: &mut dyn FnMut(u64, &[Vec<u32>]),
) -> Result<(), VectorError> {
    let mut lines = Lines::open(path, manifest)?;
    while let Some(found) = lines.batch(BATCH)? {
        let words = found.iter().map(|line| lines.bits(line, layout)).collect::<Result<Vec<_>, _>>()?;
        batch(found[0].index, &words);
    }
    lines.hash_matches().map(drop)
}

/// A search for faults, each until a field shows it.
pub(super) struct Hunt<'a> {
    of: &'a Faults<'a>,
    /// Faults that are not seen, with their largest effect.
    pub(super) unseen: Vec<(Fault, Effect)>,
}

impl<'a> Hunt<'a> {
    /// Starts a search for some of the faults of a design.
    pub(super) fn new(of: &'a Faults<'a>, faults: impl Iterator<Item = Fault>) -> Self {
        Self { of, unseen: faults.map(|fault| (fault, Effect::None)).collect() }
    }

    /// Adds some vectors, the wires of the right design for each; returns the number of faults that each of them is the first to
    /// show.
    pub(super) fn show(&mut self, wires: &[Vec<i64>]) -> Vec<usize> {
        let of = self.of;
        let first_to_show = |simulator: &mut Simulator, (fault, most): &mut (Fault, Effect)| {
            wires.iter().position(|right| {
                *most = simulator.effect(*fault, right).max(*most);
                *most == Effect::Seen
            })
        };
        let tasks = self.unseen.par_chunks_mut(TASK).map_init(
            || Simulator::new(of),
            |simulator, task| task.iter_mut().filter_map(|fault| first_to_show(simulator, fault)).collect::<Vec<_>>(),
        );
        let mut shown = vec![0; wires.len()];
        for place in tasks.flatten_iter().collect::<Vec<_>>() {
            shown[place] += 1;
        }
        self.unseen.retain(|&(_, effect)| effect != Effect::Seen);
        shown
    }
}

/// Proofs about the faults of a design, whatever the vectors.
#[derive(Default)]
pub(super) struct Proofs {
    tried: HashSet<Fault>,
    equal: HashSet<Fault>,
}

impl Proofs {
    /// The faults that are proven to change no field, including all such of `unseen`.
    pub(super) fn equal(&mut self, of: &Faults, unseen: &[(Fault, Effect)]) -> &HashSet<Fault> {
        let new: Vec<Fault> =
            unseen.iter().map(|&(fault, _)| fault).filter(|&fault| self.tried.insert(fault)).collect();
        let operations = new.par_chunks(TASK).map_init(
            || Prover::new(of),
            |prover, task| task.iter().copied().filter(|&fault| prover.is_equal(fault)).collect::<Vec<_>>(),
        );
        self.equal.extend(operations.flatten_iter().collect::<Vec<_>>());
        let shown = |exhaustion: &Exhaustion, tasks: &[Task]| {
            let shown = tasks.par_iter().map_init(|| exhaustion.wires(), |wires, task| exhaustion.shown(task, wires));
            shown.flatten_iter().collect()
        };
        self.equal.extend(Exhaustion::new(of, new.into_iter()).equal(&shown));
        &self.equal
    }
}

/// State of the counts after some vectors.
struct Tally<'a> {
    outcomes: &'a Outcomes<'a>,
    faults: &'a Faults<'a>,
    bins: &'a Bins<'a>,
    hunt: Hunt<'a>,
    /// Number of times each bin is met.
    met: Vec<u64>,
    observed: Observed,
    sets: Vec<String>,
    vectors: u64,
    inputs: HashSet<u64>,
    repeated: u64,
}

impl<'a> Tally<'a> {
    fn new(outcomes: &'a Outcomes<'a>, faults: &'a Faults<'a>, bins: &'a Bins<'a>) -> Self {
        Self {
            outcomes,
            faults,
            bins,
            hunt: Hunt::new(faults, faults.faults.iter().copied()),
            met: vec![0; bins.bins.len()],
            observed: Observed::new(&outcomes.net),
            sets: Vec::new(),
            vectors: 0,
            inputs: HashSet::new(),
            repeated: 0,
        }
    }

    /// Adds some vectors of a set, the integers of the ports of each.
    fn add(&mut self, set: &str, vectors: &[Vec<i64>]) {
        if !self.sets.iter().any(|name| name == set) {
            self.sets.push(set.to_owned());
        }
        let mut wires = Vec::with_capacity(vectors.len());
        for ports in vectors {
            let mut hasher = DefaultHasher::new();
            ports.hash(&mut hasher);
            self.repeated += u64::from(!self.inputs.insert(hasher.finish()));
            let of_vector = self.observed.evaluate(&self.outcomes.net, ports);
            self.bins.met(of_vector, |bin| self.met[bin] += 1);
            wires.push(of_vector.to_vec());
        }
        self.hunt.show(&wires);
        self.vectors += vectors.len() as u64;
    }

    fn report(mut self, of: &Manifest, ranges: &Ranges, proofs: &mut Proofs) -> CoverageReport {
        let net = &self.outcomes.net;
        // A fault that vectors show is not equal, so only the others are tried.
        let equal = proofs.equal(self.faults, &self.hunt.unseen);
        self.hunt.unseen.retain(|(fault, _)| !equal.contains(fault));
        let unseen: HashSet<Fault> = self.hunt.unseen.iter().map(|&(fault, _)| fault).collect();
        let mut stages = vec![StageCoverage { stage: "ports".into(), ..StageCoverage::default() }];
        for run in &net.runs {
            if stages.iter().all(|known| known.stage != run.base()) {
                stages.push(StageCoverage { stage: run.base().into(), ..StageCoverage::default() });
            }
        }
        let mut tables: Vec<_> = (self.faults.tables.iter())
            .map(|table| TableCoverage {
                table: table.name.clone(),
                read: Coverage::default(),
                entries: Coverage::default(),
            })
            .collect();
        for &fault in self.faults.faults.iter().filter(|fault| !equal.contains(fault)) {
            let is_seen = !unseen.contains(&fault);
            let stage = self.faults.run(fault).map_or("ports", |run| net.runs[run as usize].base());
            let stage = stages.iter_mut().find(|known| known.stage == stage);
            match (fault, stage) {
                (Fault::Stuck { .. }, Some(stage)) => stage.stuck.count(is_seen),
                (Fault::OperatorFault { .. }, Some(stage)) => stage.slips.count(is_seen),
                (Fault::Entry { table, .. }, _) => tables[table as usize].entries.count(is_seen),
                (_, None) => {}
            }
        }
        let (mut decisions, mut unmet) = (Coverage::default(), Vec::new());
        for (&bin, &met) in self.bins.bins.iter().zip(&self.met) {
            match bin {
                Bin::Entry { table, .. } => tables[table as usize].read.count(met > 0),
                _ => decisions.count(met > 0),
            }
            if met == 0 {
                unmet.push(self.bins.text(bin));
            }
        }
        stages.retain(|stage| stage.stuck.all + stage.slips.all > 0);

        let mut fields = Vec::new();
        let mut alarms = Vec::new();
        for &outcome in &self.outcomes.list {
            let field = self.outcomes.field(outcome);
            let Some(seen) = self.observed.of(outcome.node) else { continue };
            if seen.constant().is_some() {
                alarms.push(Alarm::Constant { field: field.name.clone() });
            }
            let proven = ranges.of(outcome.node);
            let (proven, seen) = ([proven.low, proven.high], [seen.low, seen.high]);
            fields.push(Attained { field: field.name.clone(), stage: field.stage.clone(), proven, seen });
        }
        if self.repeated > 0 {
            alarms.push(Alarm::Repeated { vectors: self.repeated });
        }
        let is_equal_entry = |fault: &&Fault| matches!(fault, Fault::Entry { .. }) && equal.contains(fault);
        let equal_entries = self.faults.faults.iter().filter(is_equal_entry).map(|&fault| self.faults.text(fault));
        let unseen = self
            .hunt
            .unseen
            .iter()
            .map(|&(fault, effect)| Unseen { fault: self.faults.text(fault), masked: effect == Effect::Masked });
        CoverageReport {
            datapath: of.datapath.name(),
            stage: of.stage.as_ref().map(|stage| stage.module.clone()),
            profile: of.profile.name.clone(),
            taps: of.taps,
            sets: self.sets,
            vectors: self.vectors,
            stages,
            tables,
            decisions,
            unseen: unseen.collect(),
            equal_entries: equal_entries.collect(),
            unmet,
            fields,
            alarms,
        }
    }
}
