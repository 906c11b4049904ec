//! Acceptance tiers: devices whose reciprocals and roots are not ours, as `roughxel vectors check` sees them.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects, FootprintKind};
use roughxel_core::precision::Profile;
use roughxel_host_tests::simulators::{bench_script, have};
use roughxel_host_tests::space::whole_or;
use roughxel_netlist::faithful_rounding::Primitive;
use roughxel_netlist::graph::{Net, NodeId, Op};
use roughxel_netlist::rounding::{Roundings, scattered};
use roughxel_netlist::verilog::{Options, StagePort};
use roughxel_record as record;
use roughxel_vectors::{
    Ambiguous, AmbiguousVector, CheckResult, Direction, Failing, Manifest, SetExport, SetInfo, StageSet, Tier,
    VectorError, Words, ambiguous, check, export_with, random_set,
};
use tempfile::TempDir;

const NAME: &str = "random";

/// A set and devices of its datapath.
struct Devices {
    directory: TempDir,
    manifest: Manifest,
    net: Net,
    primitives: Vec<Primitive>,
    /// Integers of the ports of each vector.
    ports: Vec<Vec<i64>>,
}

impl Devices {
    fn new(datapath: Datapath, effects: Effects, profile: Profile, taps: bool, count: u64) -> Self {
        Self::from_numbers((0..count).collect(), datapath, effects, profile, taps)
    }

    /// Builds a set from random inputs with these numbers.
    fn from_numbers(numbers: Vec<u64>, datapath: Datapath, effects: Effects, profile: Profile, taps: bool) -> Self {
        let precision = profile.precision();
        let directory = tempfile::tempdir().expect("a temporary directory");
        let words = Words { taps, ..Words::default() };
        let info = SetInfo { words, ..SetInfo::new(NAME, datapath, effects, profile.name(), precision) };
        let input = |index: u64| random_set(datapath, NAME, numbers[index as usize], &precision);
        let ports = (0..numbers.len() as u64).map(|index| input(index).recorded(&precision)).collect();
        let manifest = export_with(&info, numbers.len() as u64, &input, directory.path(), &|_| {});
        let net = record::net(Design::for_datapath(datapath), &effects, &precision);
        let primitives = net.primitives(precision.fraction_bits);
        Self { directory, manifest: manifest.expect("a set"), net, primitives, ports }
    }

    fn manifest_path(&self) -> PathBuf {
        self.directory.path().join(&self.manifest.files[0].name).with_extension("json")
    }

    /// The words of the set.
    fn words(&self) -> Vec<String> {
        let text = fs::read_to_string(self.directory.path().join(&self.manifest.files[0].name)).expect("words");
        text.lines().filter(|line| !line.starts_with("//")).map(str::to_owned).collect()
    }

    /// The words of a device with other integers on the wires for which `change` is called (vector, node, integer).
    fn device(&self, change: impl Fn(usize, NodeId, i64) -> i64) -> Vec<String> {
        self.device_with(|index, wires| {
            for id in 0..self.net.nodes.len() as NodeId {
                wires.push(change(index, id, self.net.value(id, &self.ports[index], wires)));
            }
        })
    }

    /// The words of a device whose wires `compute` fills for each vector.
    fn device_with(&self, compute: impl Fn(usize, &mut Vec<i64>)) -> Vec<String> {
        let word = |(index, word): (usize, String)| {
            let mut wires = Vec::new();
            compute(index, &mut wires);
            let fields = word.split('_').zip(&self.manifest.fields).map(|(digits, field)| {
                let Some(output) = self.net.outputs.iter().find(|output| {
                    output.name == field.port && matches!(field.direction, Direction::Tap | Direction::Out)
                }) else {
                    return digits.to_owned();
                };
                let integer = wires[output.node as usize] >> (output.fraction_bits - field.fraction_bits);
                let bits = integer & ((1 << field.width) - 1);
                format!("{bits:0digits$x}", digits = field.digits() as usize)
            });
            fields.collect::<Vec<_>>().join("_")
        };
        self.words().into_iter().enumerate().map(word).collect()
    }

    /// The words of a device whose roundings are each off by up to `places` last places, differently in each vector.
    fn rounded_otherwise(&self, places: i64) -> Vec<String> {
        let nodes: Vec<NodeId> = self.net.outputs.iter().map(|output| output.node).collect();
        let roundings = Roundings::new(&self.net, &nodes);
        self.device_with(|vector, wires| {
            let change = |number| scattered(1000 + vector as u64, number, places);
            roundings.wires(&self.ports[vector], change, wires);
        })
    }

    /// The words of a device whose primitives have `places(vector, number of the primitive)` last places more, kept in [½, 1].
    fn with_primitives(&self, places: impl Fn(usize, usize) -> i64) -> Vec<String> {
        let number: BTreeMap<NodeId, usize> =
            self.primitives.iter().enumerate().map(|(number, primitive)| (primitive.node, number)).collect();
        self.device(|vector, id, value| match number.get(&id) {
            Some(&number) => {
                let Primitive { one, last_place, .. } = self.primitives[number];
                (value + places(vector, number) * last_place).clamp(one / 2, one)
            }
            None => value,
        })
    }

    fn check(&self, words: &[String], tier: Tier) -> Result<CheckResult, VectorError> {
        let path = self.directory.path().join("got.txt");
        fs::write(&path, words.join("\n") + "\n").expect("words of a device");
        check(&path, &self.manifest_path(), tier, &|_| {})
    }

    fn ambiguous(&self, places: u32) -> Ambiguous {
        ambiguous(&self.manifest_path(), places, &|_| {}).expect("ambiguous")
    }

    /// The stage of a primitive.
    fn stage(&self, primitive: &Primitive) -> &'static str {
        let run = self.net.node(primitive.node).stage.expect("a primitive is in a stage");
        self.net.runs[run as usize].base()
    }
}

/// −1, 0 or 1.
fn choice(vector: usize, primitive: usize) -> i64 {
    let mixed = (vector as u64 * 31 + primitive as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed >> 40) as i64 % 3 - 1
}

fn effects(footprint: FootprintKind) -> Effects {
    Effects { footprint, ..Effects::ALL }
}

#[test]
fn every_reciprocal_and_root_of_a_design_is_found() {
    let mut found = Vec::new();
    for (datapath, effects) in [
        (Datapath::Reflection, effects(FootprintKind::Face)),
        (Datapath::Reflection, effects(FootprintKind::Sphere)),
        (Datapath::Highlight, Effects::ALL),
        (Datapath::Peak, Effects::ALL),
    ] {
        for profile in [Profile::Standard, Profile::Narrow] {
            let devices = Devices::new(datapath, effects, profile, true, 1);
            let mut stages: Vec<(&str, usize)> = Vec::new();
            for primitive in &devices.primitives {
                match stages.last_mut() {
                    Some((stage, count)) if *stage == devices.stage(primitive) => *count += 1,
                    _ => stages.push((devices.stage(primitive), 1)),
                }
            }
            let seeds = devices.net.iter().filter(|(id, node)| {
                matches!(node.op, Op::Lookup(..)) && {
                    let line = devices.net.origin(*id);
                    let source = include_str!("../../../core/src/elementary.rs");
                    let number: usize =
                        line.split([':', ' ']).nth(1).and_then(|text| text.parse().ok()).expect("a line");
                    let text = source.lines().nth(number - 1).unwrap_or_default();
                    line.contains("elementary.rs")
                        && (text.contains("rom::reciprocal") || text.contains("rom::inverse_root"))
                }
            });
            assert_eq!(devices.primitives.len(), seeds.count(), "a primitive a seed");
            found.push(stages);
        }
    }
    let face = vec![("frame", 2), ("cube_face", 1), ("axes", 4)];
    let sphere =
        vec![("frame", 2), ("cube_face", 1), ("columns", 2), ("axes", 4), ("sweep", 2), ("probes", 1), ("sweep", 2)];
    let highlight = vec![("frame", 2), ("highlight", 2), ("half", 2), ("highlight", 1)];
    let peak = vec![("frame", 2), ("half", 2), ("local", 1), ("horizon", 4)];
    assert_eq!(found, [&face, &face, &sphere, &sphere, &highlight, &highlight, &peak, &peak].map(Clone::clone));
}

#[test]
fn a_device_with_neighbours_is_faithful_and_not_exact() {
    for (datapath, effects) in [
        (Datapath::Reflection, effects(FootprintKind::Face)),
        (Datapath::Reflection, effects(FootprintKind::Sphere)),
        (Datapath::Highlight, Effects::ALL),
        (Datapath::Peak, Effects::ALL),
    ] {
        for profile in [Profile::Standard, Profile::Narrow] {
            let devices = Devices::new(datapath, effects, profile, true, whole_or(1000, 60));
            let count = devices.manifest.count;
            let ours = devices.check(&devices.with_primitives(|_, _| 0), Tier::Exact).expect("checked");
            assert_eq!((ours.exact, ours.failures.len()), (count, 0), "{datapath:?} {profile:?}");
            for (what, places) in [("up", (|_, _| 1) as fn(usize, usize) -> i64), ("down", |_, _| -1), ("any", choice)]
            {
                let checked = devices.check(&devices.with_primitives(places), Tier::Faithful).expect("checked");
                println!("{datapath:?} {:?} {profile:?} {what}: {} exact of {count}", effects.footprint, checked.exact);
                assert_eq!(checked.passing, count, "{datapath:?} {profile:?} {what}: {:#?}", checked.failures);
                assert!(checked.exact < count / 2, "{datapath:?} {profile:?} {what}: {} exact", checked.exact);
            }
        }
    }
}

#[test]
fn a_root_two_last_places_off_is_not_faithful_and_its_stage_is_named() {
    let devices =
        Devices::new(Datapath::Reflection, effects(FootprintKind::Face), Profile::Standard, true, whole_or(1000, 60));
    for (number, primitive) in devices.primitives.iter().enumerate() {
        let words = devices.with_primitives(|_, of| if of == number { 2 } else { 0 });
        let checked = devices.check(&words, Tier::Faithful).expect("checked");
        // The last bits of a quotient of `cube_face` show in the columns, which read it, too.
        let stages: &[&str] = match devices.stage(primitive) {
            "cube_face" => &["cube_face", "columns"],
            "axes" => &["axes", "probes"],
            stage => &[stage],
        };
        for Failing { stage, field, .. } in &checked.failures {
            assert!(stages.contains(&stage.as_str()), "{stage} {field} instead of {stages:?}");
        }
        // Where the vector is a pole or a circle a root is multiplied by zero, and some results are the same with another choice.
        let most = if stages[0] == "axes" { checked.count } else { checked.count / 2 };
        assert!(checked.passing <= most, "{stages:?}: {} of {}", checked.passing, checked.count);
        println!("{stages:?}: {} of {}", checked.passing, checked.count);
    }
}

#[test]
fn without_taps_few_choices_are_checked_and_many_are_refused() {
    for datapath in Datapath::ALL {
        let devices = Devices::new(datapath, effects(FootprintKind::Face), Profile::Standard, false, 20);
        let error = devices.check(&devices.with_primitives(choice), Tier::Faithful).expect_err("too many").to_string();
        assert!(error.contains(" there are more than 729 choices of neighbours; check it with a set with"), "{error}");
    }
    // Two of `frame` and one of the face.
    let devices = Devices::new(Datapath::Reflection, effects(FootprintKind::None), Profile::Standard, false, 20);
    let checked = devices.check(&devices.with_primitives(choice), Tier::Faithful).expect("checked");
    assert!(checked.passing == 20 && checked.exact < 10, "{checked:?}");
}

const ALL: [(Datapath, FootprintKind); 4] = [
    (Datapath::Reflection, FootprintKind::Face),
    (Datapath::Reflection, FootprintKind::Sphere),
    (Datapath::Highlight, FootprintKind::Face),
    (Datapath::Peak, FootprintKind::Face),
];

#[test]
fn a_device_that_rounds_in_its_own_way_is_within_bounds_and_decides_otherwise_where_it_is_marked() {
    for (datapath, footprint) in ALL {
        for profile in [Profile::Standard, Profile::Compact, Profile::Narrow] {
            let devices = Devices::new(datapath, effects(footprint), profile, true, whole_or(400, 30));
            let count = devices.manifest.count;
            for places in [1, 4] {
                let words = devices.rounded_otherwise(places.into());
                let checked = devices.check(&words, Tier::Bound { places }).expect("checked");
                let what = format!("{datapath:?} {footprint:?} {profile:?}, {places} places");
                assert_eq!(checked.passing, count, "{what}: {:#?}", checked.failures);
                assert!(checked.exact < count / 10, "{what}: {} exact", checked.exact);
                let marked = devices.ambiguous(places).marked.len() as u64;
                assert!(marked < count / 2, "{what}: {marked} marked");
            }
        }
    }
}

/// Regression: designs beyond a threshold need a check just past it, not only at the point to which all roundings push. If a threshold of the probe
/// count is in reach, the last probe has any share beyond it, from none.
#[test]
fn close_behind_a_threshold_of_the_count_a_share_is_within_bounds() {
    let (datapath, effects) = (Datapath::Reflection, effects(FootprintKind::Sphere));
    let any = Devices::new(datapath, effects, Profile::Standard, true, 1000).ambiguous(4);
    let counted = |marked: &&AmbiguousVector| marked.fields.iter().any(|name| name == "probes");
    let near = any.marked.iter().find(counted).expect("one near a threshold").index;
    let numbers = vec![near; whole_or(1000, 100)];
    let count = numbers.len() as u64;
    let devices = Devices::from_numbers(numbers, datapath, effects, Profile::Standard, true);
    let marked = devices.ambiguous(4).marked.len() as u64;
    assert_eq!(marked, count, "the threshold is in reach");
    let checked = devices.check(&devices.rounded_otherwise(4), Tier::Bound { places: 4 }).expect("checked");
    assert_eq!(checked.passing, count, "{:#?}", checked.failures);
}

#[test]
fn a_wrong_sign_and_another_face_are_beyond_bounds() {
    let devices = Devices::new(Datapath::Reflection, effects(FootprintKind::Face), Profile::Standard, true, 100);
    let node = |name: &str| devices.net.outputs.iter().find(|output| output.name == name).expect("an output").node;
    let wrong_sign = node("reflected.mantissa[1]");
    let face = node("face");
    let tier = Tier::Bound { places: 4 };
    let checked = devices.check(&devices.device(|_, id, value| if id == wrong_sign { -value } else { value }), tier);
    let checked = checked.expect("checked");
    assert_eq!((checked.passing, checked.failures[0].stage.as_str()), (0, "reflect"));
    assert!(checked.failures[0].within.is_some_and(|places| places < 1000.0), "{:?}", checked.failures[0]);
    let checked = devices.check(&devices.device(|_, id, value| if id == face { (value + 1) % 6 } else { value }), tier);
    let checked = checked.expect("checked");
    let of_face =
        devices.ambiguous(4).marked.iter().filter(|marked| marked.fields.iter().any(|name| name == "face")).count();
    assert!(checked.passing <= of_face as u64, "{checked:?}");
    assert_eq!((checked.failures[0].field.as_str(), checked.failures[0].within), ("face", None));
}

/// The generated Verilog with a different last step of the first root of `frame`, in a testbench that writes its results.
#[test]
fn a_root_of_another_make_in_a_simulator_is_faithful_or_within_bounds() {
    let tools = [("icarus", "iverilog"), ("verilator", "verilator")];
    let tools = tools.into_iter().take(whole_or(2, 1)).filter(|(_, program)| have(program));
    let devices = Devices::new(Datapath::Reflection, effects(FootprintKind::Face), Profile::Narrow, true, 30);
    let written = roughxel_vectors::Testbench::new(&devices.manifest_path()).expect("a set");
    let folder = devices.directory.path().join("bench");
    assert!(written.write(&folder, roughxel_vectors::Device::Generated, false).expect("a testbench").is_empty());
    let module = folder.join("rtl/frame.v");
    let text = fs::read_to_string(&module).expect("the module");
    for (tool, _) in tools {
        // ⌊(2x + 1)/2⌋, and one and two last places less.
        for (less, instead, tier, passing) in [
            (0, "_add + 16'd1;", Tier::Exact, 30),
            (1, "_add - 16'd1;", Tier::Faithful, 30),
            (2, "_add - 16'd3;", Tier::Faithful, 0),
            (2, "_add - 16'd3;", Tier::Bound { places: 2 }, 30),
        ] {
            fs::write(&module, text.replacen("_add + 16'd1;", instead, 1)).expect("the module can be written");
            let got = devices.directory.path().join("got.hex");
            let mut run = bench_script(&folder.join("run.sh"));
            run.args([tool, "--stop", "1", "--got"]).arg(&got);
            let output = run.output().expect("a shell");
            let printed = String::from_utf8_lossy(&output.stdout);
            assert_eq!(output.status.code(), Some(if less == 0 { 0 } else { 3 }), "{printed}");
            assert!(!printed.contains(" #1: "), "more than one vector is printed: {printed}");
            let checked = check(&got, &devices.manifest_path(), tier, &|_| {}).expect("checked");
            // A root of a zero, or one that is rounded away, is the same.
            let right = if passing == 0 { checked.passing < 3 } else { checked.passing == passing };
            assert!(right, "{tool}, {less} less: {} pass {:#?}", checked.passing, checked.failures);
            assert!(less == 0 || checked.exact < 3, "{tool}, {less} less: {} exact", checked.exact);
            assert!(checked.failures.iter().all(|failing| failing.stage == "frame"), "{:#?}", checked.failures);
        }
    }
}

/// A module that is tested alone, its words in upper case and without underscores.
#[test]
fn a_stage_alone_is_checked() {
    let directory = tempfile::tempdir().expect("a temporary directory");
    let (precision, effects) = (Profile::Standard.precision(), effects(FootprintKind::Face));
    let (datapath, profile) = (Datapath::Reflection, Profile::Standard.name());
    let set = StageSet::select(datapath, &effects, &precision, Some("frame")).expect("frame").remove(0);
    let info = SetInfo::new(NAME, datapath, effects, profile, precision);
    let input = |index| random_set(datapath, NAME, index, &precision);
    let manifest =
        SetExport::of_stage(&info, 30, &set).write(&input, directory.path(), &|_| {}).expect("a set of a stage");
    let words_path = directory.path().join(&manifest.files[0].name);

    let options = Options { stage: Some("frame".to_owned()), ..Options::new("", precision, effects) };
    let stage = record::stages(Design::for_datapath(datapath), &options).expect("frame").stages.remove(0);
    let net = &stage.unit;
    let primitives = net.primitives(precision.fraction_bits);
    assert_eq!(primitives.len(), 2);
    let word = |text: &str, last_places: i64| {
        let mut digits: Vec<String> = text.split('_').map(str::to_owned).collect();
        let integer = |(port, digits): (&StagePort, &String)| {
            let bits = i64::from_str_radix(digits, 16).expect("hex digits");
            let (width, zeros) = (port.format.width(), port.format.zeros);
            (if port.format.range.low < 0 { bits << (64 - width) >> (64 - width) } else { bits }) << zeros
        };
        let ports: Vec<i64> = stage.inputs.iter().zip(&digits).map(integer).collect();
        let mut wires = Vec::new();
        for id in 0..net.nodes.len() as NodeId {
            let more = primitives.iter().find(|primitive| primitive.node == id);
            let more = more.map_or(0, |primitive| last_places * primitive.last_place);
            wires.push(net.value(id, &ports, &wires) + more);
        }
        for (place, (port, output)) in stage.outputs.iter().zip(&net.outputs).enumerate() {
            let bits = wires[output.node as usize] >> port.format.zeros & ((1 << port.format.width()) - 1);
            let of_field = &mut digits[stage.inputs.len() + place];
            *of_field = format!("{bits:0width$X}", width = of_field.len());
        }
        digits.concat() + "\n"
    };
    let text = fs::read_to_string(&words_path).expect("words");
    let checked = |last_places: i64| {
        let got = directory.path().join("got.hex");
        let words = text.lines().filter(|line| !line.starts_with("//")).map(|line| word(line, last_places));
        fs::write(&got, words.collect::<String>()).expect("words of a device");
        check(&got, &words_path.with_extension("json"), Tier::Faithful, &|_| {}).expect("checked")
    };
    // A stage has its own bounds and ambiguous fields: no exponent is a decision.
    let got = directory.path().join("got.hex");
    let bound = |last_places: i64| {
        checked(last_places);
        check(&got, &words_path.with_extension("json"), Tier::Bound { places: 1 }, &|_| {}).expect("checked").passing
    };
    assert_eq!((bound(0), bound(-1)), (30, 30));
    let ambiguous = ambiguous(&words_path.with_extension("json"), 1, &|_| {}).expect("ambiguous");
    assert_eq!(ambiguous.marked, []);
    assert_eq!((checked(0).exact, checked(-1).passing), (30, 30));
    assert!(checked(-1).exact < 5 && checked(-2).passing < 5, "{}", checked(-2).passing);
}

#[test]
fn other_inputs_and_other_counts_are_told() {
    let devices = Devices::new(Datapath::Reflection, effects(FootprintKind::Face), Profile::Standard, true, 3);
    let mut words = devices.words();
    let digit = if words[1].starts_with('0') { "1" } else { "0" };
    words[1].replace_range(0..1, digit);
    for tier in [Tier::Exact, Tier::Faithful] {
        let checked = devices.check(&words, tier).expect("checked");
        assert_eq!((checked.exact, checked.passing), (2, 2));
        let failing = &checked.failures[0];
        assert_eq!((failing.index, failing.stage.as_str(), failing.field.as_str()), (1, "input", "normal_x"));
    }
    let error = devices.check(&words[..2], Tier::Exact).expect_err("too few").to_string();
    assert!(error.ends_with("got.txt: fewer words than the set, which has 3; a testbench writes one word for each vector, in the order of the set"), "{error}");
    words.push(words[0].clone());
    let error = devices.check(&words, Tier::Exact).expect_err("too many").to_string();
    assert!(error.contains("more words than the set"), "{error}");
    words[2] = words[2].replacen('_', "_x", 1);
    let error = devices.check(&words[..3], Tier::Exact).expect_err("an unknown bit").to_string();
    assert!(error.contains("got.txt:3: "), "{error}");
}

/// Results computed from a neighbouring value are exact: only the neighbour's own result may differ in its last bit.
#[test]
fn a_wrong_bit_behind_a_neighbour_is_named() {
    let devices = Devices::new(Datapath::Reflection, effects(FootprintKind::Face), Profile::Standard, true, 20);
    let output = devices.net.outputs.iter().find(|output| output.name.starts_with("reflected")).expect("r");
    let bit = 1 << (output.fraction_bits - 20);
    let first = devices.primitives[0];
    let words = devices.device(|_, id, value| match id {
        _ if id == first.node => (value + first.last_place).min(first.one),
        _ if id == output.node => value ^ bit,
        _ => value,
    });
    let checked = devices.check(&words, Tier::Faithful).expect("checked");
    assert_eq!((checked.passing, checked.failures.len()), (0, 10));
    for (index, failing) in (0..).zip(&checked.failures) {
        assert_eq!((failing.index, failing.stage.as_str()), (index, "reflect"), "{failing:?}");
    }
}
