//! How good sets are: what `roughxel vectors coverage` counts, what the committed sets show, and what condensing keeps.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

use roughxel_cases::random_fragment;
use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::ports::Port;
use roughxel_core::precision::Precision;
use roughxel_host_tests::space::whole_or;
use roughxel_netlist::fault::{Effect, Fault, Faults, Simulator};
use roughxel_netlist::graph::Op;
use roughxel_netlist::integers::integers_at;
use roughxel_netlist::interval::Ranges;
use roughxel_record as record;
use roughxel_vectors::{
    Alarm, Condensed, Coverage, CoverageReport, Manifest, Mistake, SetInfo, VectorError, VectorSet, Wanted, condense,
    coverage, entries_set, export_with, hard_sets, manifests_in, random_set, verify,
};

/// Faults of a kind in all stages.
fn operations(report: &CoverageReport) -> Coverage {
    report.stages.iter().map(|stage| stage.slips).fold(Coverage::default(), Coverage::and)
}

/// The committed sets of a profile.
fn smoke(profile: &str) -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/smoke");
    let mut sets = manifests_in(&directory).expect("the committed sets");
    sets.retain(|path| path.to_string_lossy().ends_with(&format!("_{profile}.json")));
    sets
}

fn info<'a>(name: &'a str, datapath: Datapath, precision: Precision, profile: &'a str) -> SetInfo<'a> {
    SetInfo::new(name, datapath, Effects::ALL, profile, precision)
}

/// Stuck bits at the ports amount to a fragment with other ports, for which the whole design is computed.
#[test]
fn what_a_fault_leads_to_is_what_the_whole_design_computes() {
    for p in [Precision::STANDARD, Precision::NARROW] {
        let net = record::net(Design::Fragment, &Effects::ALL, &p);
        let ranges = Ranges::new(&net);
        let shown: Vec<_> = net.outputs.iter().map(|output| (output.node, u64::MAX)).collect();
        let faults = Faults::new(&net, &ranges, shown);
        let mut simulator = Simulator::new(&faults);
        let (mut right, mut wrong) = (Vec::new(), Vec::new());
        let (mut seen, mut tried) = (0, 0);
        for index in 0..whole_or(40, 4) {
            let ports = integers_at(&random_fragment("faults", index, &p).wires(), &p);
            net.evaluate(&ports, &mut right);
            for &fault in &faults.faults {
                let Fault::Stuck { node, bit, high } = fault else { continue };
                let Op::Port(port) = net.node(node).op else { continue };
                let mut stuck = ports.clone();
                let value = if high { stuck[port as usize] | 1 << bit } else { stuck[port as usize] & !(1 << bit) };
                // The top bit of a signed port is its sign.
                let spare = if ranges.of(node).signed() { 64 - ranges.of(node).top() } else { 0 };
                stuck[port as usize] = value << spare >> spare;
                net.evaluate(&stuck, &mut wrong);
                let differs =
                    net.outputs.iter().any(|output| right[output.node as usize] != wrong[output.node as usize]);
                let expected = match (stuck == ports, differs) {
                    (true, _) => Effect::None,
                    (false, false) => Effect::Masked,
                    (false, true) => Effect::Seen,
                };
                assert_eq!(simulator.effect(fault, &right), expected, "{} of #{index}", faults.text(fault));
                seen += u32::from(expected == Effect::Seen);
                tried += 1;
            }
        }
        assert!(seen > tried / 4, "{seen} of {tried} are seen");
    }
}

/// Figures of vectors/COVERAGE.md.
#[test]
fn the_committed_sets_show_nineteen_operations_in_twenty_and_are_below_a_thousand() {
    let all = vec![("standard", 95.0), ("compact", 94.5), ("narrow", 93.5)];
    for (profile, percent) in whole_or(all, vec![("narrow", 93.5)]) {
        let reports = coverage(&smoke(profile), &|_| {}).expect("the committed sets can be read");
        for datapath in Datapath::ALL {
            let of = || reports.iter().filter(|report| report.datapath == datapath.name());
            let vectors: u64 = of().map(|report| report.vectors).sum();
            assert!(vectors <= 1000, "{profile}, {}: {vectors} vectors", datapath.name());
            let best = of().map(|report| operations(report).percent()).fold(0.0, f64::max);
            assert!(best >= percent, "{profile}, {}: {best} % of operations", datapath.name());
            let most = of().max_by_key(|report| report.vectors).expect("a report");
            assert!(!most.alarms.iter().any(|alarm| matches!(alarm, Alarm::Constant { .. })), "{:?}", most.alarms);
        }
    }
}

/// No line of a list is lost, and the vectors picked for it detect every entry of every table off by a last place. The committed sets of single
/// stages detect as many of each table.
#[test]
fn every_entry_of_every_table_off_by_a_last_place_is_shown_by_the_sets_for_it_and_by_stages_alone() {
    let sets = hard_sets(&Precision::STANDARD);
    let directory = tempfile::tempdir().expect("a temporary directory");
    let datapaths = whole_or(Datapath::ALL.to_vec(), vec![Datapath::Peak]);
    for &datapath in &datapaths {
        for (list, shows_entries) in [("", false), ("entries_", true)] {
            let list = format!("../vectors/chosen/{list}{}.txt", datapath.name());
            let list = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(list)).expect("the list");
            let is_it =
                |set: &VectorSet| if shows_entries { set.name == entries_set(datapath) } else { set.best_first };
            let of = |set: &&VectorSet| is_it(set) && set.datapath == datapath;
            let VectorSet { name, inputs, .. } = sets.iter().find(of).expect("a set of a list");
            assert_eq!(list.lines().count(), inputs.len(), "{name}");
            if shows_entries {
                let info = info(name, datapath, Precision::STANDARD, "standard");
                let input = |index: u64| inputs[index as usize];
                export_with(&info, inputs.len() as u64, &input, directory.path(), &|_| {}).expect("a set");
            }
        }
    }
    let stages = Path::new(env!("CARGO_MANIFEST_DIR")).join("../vectors/smoke/stages");
    let mut stages = manifests_in(&stages).expect("the committed sets");
    stages.retain(|path| datapaths.contains(&Manifest::read(path).expect("a manifest").datapath));
    let stages = coverage(&stages, &|_| {}).expect("sets");
    for of in coverage(&manifests_in(directory.path()).expect("sets"), &|_| {}).expect("sets") {
        for table in &of.tables {
            let (name, entries) = (format!("{} of {}", table.table, of.datapath), table.entries);
            assert_eq!(table.read.found, table.read.all, "{name}");
            assert_eq!(entries.found, entries.all, "{name}");

            // The sets of the modules that read a table detect all of its entries together.
            let readers = stages.iter().filter(|stage| stage.datapath == of.datapath);
            let readers = readers.filter(|stage| stage.tables.iter().any(|reader| reader.table == table.table));
            let not_shown = |stage: &CoverageReport| -> HashSet<String> {
                let unseen = stage.unseen.iter().map(|unseen| &unseen.fault);
                let of_table = |fault: &&String| fault.starts_with(&format!("table {}:", table.table));
                unseen.chain(&stage.equal_entries).filter(of_table).cloned().collect()
            };
            let by_none = readers.map(not_shown).reduce(|a, b| &a & &b).expect("a stage");
            let may_be: HashSet<String> = of.equal_entries.iter().cloned().collect();
            assert!(by_none.is_subset(&may_be), "{name}, stages alone: {by_none:?}");
        }
    }
}

#[test]
fn few_condensed_vectors_show_more_than_as_many_others() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let (many, few, others) =
        (directory.path().join("many"), directory.path().join("few"), directory.path().join("others"));
    let p = Precision::NARROW;
    let input = |index| random_set(Datapath::Peak, "distil", index, &p);
    export_with(&info("many", Datapath::Peak, p, "narrow"), 400, &input, &many, &|_| {}).expect("a set");
    export_with(&info("others", Datapath::Peak, p, "narrow"), 30, &input, &others, &|_| {}).expect("a set");
    let first = many.join("many_narrow.json");
    let wanted = |most, beside| Wanted { most, beside, mistakes: &Mistake::ALL };
    let Condensed { picked, inputs, .. } = condense(&first, &[], wanted(30, &[]), &|_| {}).expect("a set");
    assert_eq!((picked.len(), inputs.len()), (30, 30));
    let input = |index| inputs[index as usize];
    export_with(&info("few", Datapath::Peak, p, "narrow"), 30, &input, &few, &|_| {}).expect("a set");
    assert!(verify(&few.join("few_narrow.json"), &|_| {}).expect("a set").passed());

    let of =
        |directory: &Path| coverage(&manifests_in(directory).expect("a set"), &|_| {}).expect("a set").swap_remove(0);
    let [few, others, many] = [few, others, many].map(|directory| of(&directory));
    let [few, others, many] = [few, others, many].map(|report| (operations(&report).found, report.faults().found));
    assert!(others.1 < few.1 && few.1 <= many.1, "{others:?} {few:?} {many:?}");
    assert!(others.0 < few.0 && few.0 * 100 >= many.0 * 99, "{others:?} {few:?} {many:?}");

    // In addition to the picked vectors, other vectors are needed for entries of tables; in addition to all vectors, none is.
    let beside = [directory.path().join("few/few_narrow.json")];
    let entries = Wanted { mistakes: &[Mistake::Entry], ..wanted(1000, &beside) };
    let Condensed { picked: more, inputs, .. } = condense(&first, &[], entries, &|_| {}).expect("a set");
    assert!(!more.is_empty() && more.iter().all(|vector| !picked.contains(vector)), "{more:?}");
    let (name, input) = (directory.path().join("more"), |index| inputs[index as usize]);
    export_with(&info("more", Datapath::Peak, p, "narrow"), more.len() as u64, &input, &name, &|_| {}).expect("a set");
    let entries = |paths: &[PathBuf]| {
        let reports = coverage(paths, &|_| {}).expect("sets");
        reports[0].tables.iter().map(|table| table.entries.found).sum::<usize>()
    };
    assert_eq!(entries(&[beside[0].clone(), name.join("more_narrow.json")]), entries(std::slice::from_ref(&first)));
    // Coverage of earlier vectors, including decisions and limits, is not covered again: each vector is needed after the ones before it.
    let operations = Wanted { mistakes: &[Mistake::Operation], ..wanted(1000, &beside) };
    let Condensed { picked: more, inputs, .. } = condense(&first, &[], operations, &|_| {}).expect("a set");
    let (name, input) = (directory.path(), |index| inputs[index as usize]);
    export_with(&info("needed", Datapath::Peak, p, "narrow"), more.len() as u64, &input, name, &|_| {}).expect("a set");
    let needed = directory.path().join("needed_narrow.json");
    let Condensed { picked: needed, .. } = condense(&needed, &[], operations, &|_| {}).expect("a set");
    assert!(more.len() > 2 && needed.len() == more.len(), "{} of {}", needed.len(), more.len());

    let all = [first.clone()];
    let Condensed { picked: none, .. } = condense(&first, &[], wanted(1000, &all), &|_| {}).expect("a set");
    assert!(none.is_empty(), "{none:?}");

    let another = export_with(
        &info("other", Datapath::Highlight, p, "narrow"),
        3,
        &|index: u64| random_set(Datapath::Highlight, "", index, &p),
        directory.path(),
        &|_| {},
    );
    another.expect("a set");
    let of_two = condense(
        &directory.path().join("other_narrow.json"),
        &[directory.path().join("many/many_narrow.json")],
        wanted(5, &[]),
        &|_| {},
    );
    assert!(
        matches!(of_two, Err(VectorError::Manifest { problem, .. }) if problem.contains("condense sets of one kind at a time"))
    );
}
