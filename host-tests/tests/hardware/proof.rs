//! Range proof: it holds, it is sound, and it detects violations. No wire can leave its word.

mod evaluation;
mod mutations;
mod rules;
mod widths;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_core::precision::{AxisDirection, Newton, Precision, ProbeRule, ProbeWeights};
use roughxel_host_tests::space::{effects, profiles};
use roughxel_netlist::census::{Census, Cost};
use roughxel_netlist::delay::{arrival_in_block, critical_path, levels};
use roughxel_netlist::graph::{Net, Op};
use roughxel_netlist::interval::{Range, Ranges};
use roughxel_netlist::observe::Observed;
use roughxel_record as record;

/// Calls `look` for every design under all effects that change it, in every profile.
fn for_every_design(mut look: impl FnMut(Design, &Effects, &Precision)) {
    for (_, p) in profiles() {
        for &design in Design::ALL {
            effects_of(design).iter().for_each(|effects| look(design, effects, &p));
        }
    }
}

/// The effects that change a design.
fn effects_of(design: Design) -> Vec<Effects> {
    effects(design.datapath())
}

fn holds(design: Design, effects: &Effects, p: &Precision) {
    let net = record::net(design, effects, p);
    let violations: Vec<_> = Ranges::new(&net).violations.iter().map(ToString::to_string).collect();
    assert!(violations.is_empty(), "{} {effects:?} {p:?}:\n{}", design.name(), violations.join("\n"));
}

#[test]
fn no_wire_of_any_design_can_leave_its_word() {
    for_every_design(holds);
}

#[test]
fn no_wire_can_leave_its_word_at_any_precision_that_can_be_built() {
    let mut precisions = Vec::new();
    // The ends of every knob that changes a width, all combinations.
    for fraction_bits in [12, 13, 20, 27, 28] {
        for (seed_bits, steps) in [(6, 0), (6, 1), (6, 2), (10, 0), (10, 2)] {
            for direction in
                [AxisDirection::Exact, AxisDirection::Table { steps: 2 }, AxisDirection::Table { steps: 64 }]
            {
                for probe_rule in [ProbeRule::PowerOfTwo, ProbeRule::Ceiling] {
                    for (max_probes, lod_bits, weight_bits) in [(1, 2, 2), (16, 12, 10)] {
                        let newton = Newton { seed_bits, steps };
                        precisions.push(Precision {
                            fraction_bits,
                            reciprocal: newton,
                            inverse_root: newton,
                            direction,
                            max_probes,
                            probe_rule,
                            probe_weights: ProbeWeights::Gaussian,
                            lod_bits,
                            weight_bits,
                            ..Precision::STANDARD
                        });
                    }
                }
            }
        }
    }
    for (index, p) in precisions.iter().enumerate() {
        let p = p.checked().expect("the knobs are inside their limits");
        for &design in Design::ALL {
            let all = effects_of(design);
            holds(design, &all[index % all.len()], &p);
        }
        holds(Design::Reflection, &Effects::ALL, &p);
    }
}

/// Connections from results of a design to ports of a different design: upper design and path, lower design and path.
const CONNECTIONS: [(Design, &str, Design, &str); 52] = [
    (Design::MapScale, "", Design::Reflection, "map"),
    (Design::MapScale, "log2_texels", Design::Texture, "map.log2_texels"),
    (Design::Reflection, "point", Design::EnvironmentProbe, "point"),
    (Design::Reflection, "probes", Design::EnvironmentProbe, "probes"),
    (Design::Reflection, "probes.lod", Design::Levels, "lod"),
    (Design::EnvironmentProbe, "place", Design::FaceAddress, "place"),
    (Design::EnvironmentProbe, "weight", Design::ProbeSum, "weight"),
    (Design::Reflection, "sweep", Design::SphereProbe, "sweep"),
    (Design::SphereProbe, "place", Design::FaceAddress, "place"),
    (Design::SphereProbe, "lod", Design::Levels, "lod"),
    (Design::SphereProbe, "weight", Design::ProbeSum, "weight"),
    (Design::Texture, "probes", Design::TextureProbe, "probes"),
    (Design::Texture, "probes.lod", Design::Levels, "lod"),
    (Design::TextureProbe, "place", Design::TextureProbe, "centre"),
    (Design::TextureProbe, "place", Design::RepeatAddress, "place"),
    (Design::TextureProbe, "weight", Design::ProbeSum, "weight"),
    (Design::FaceAddress, "weight", Design::ColourSample, "weights[0]"),
    (Design::RepeatAddress, "weight", Design::WordSample, "fine.weight"),
    (Design::Levels, "weight", Design::ColourSample, "level_weight"),
    (Design::WordSample, "", Design::ProbeSum, "sample"),
    (Design::Bump, "roughness", Design::Reflection, "fragment.surface.roughness"),
    (Design::Corner, "", Design::ColourSample, "texels[0][0]"),
    (Design::BrightTexel, "", Design::BrightCorner, "texels[0]"),
    (Design::BrightTexel, "", Design::WordSample, "fine.texels[0]"),
    (Design::BrightCorner, "", Design::WordSample, "fine.texels[0]"),
    (Design::BrightBlend, "", Design::PixelSum, "colour"),
    (Design::Reflection, "surface.frame", Design::Local, "frame"),
    (Design::Local, "", Design::Peak, "half"),
    (Design::Horizon, "", Design::Peak, "weight"),
    (Design::Peak, "", Design::Peak, "sum"),
    (Design::Bump, "offset", Design::Reflection, "fragment.surface.offset"),
    (Design::BumpTexel, "", Design::BumpRamp, "sample"),
    (Design::BumpTexel, "offset", Design::BumpRamp, "fine[0]"),
    (Design::Levels, "weight", Design::BumpRamp, "level_weight"),
    (Design::Texture, "axes.major", Design::ProbeReach, "major"),
    (Design::Texture, "axes.minor", Design::ProbeReach, "minor"),
    (Design::Texture, "probes", Design::ProbeReach, "probes"),
    (Design::ProbeReach, "", Design::BumpRamp, "reach"),
    (Design::BumpRamp, "", Design::BumpProbe, ""),
    (Design::FaceAddress, "", Design::FaceTexels, "address"),
    (Design::EnvironmentProbe, "place.face", Design::FaceTexels, "face"),
    (Design::ProbeMean, "", Design::ProbeSum, "sample"),
    (Design::Colour, "", Design::Modulated, "colours[0]"),
    (Design::Modulated, "", Design::Blend, "surface"),
    (Design::Colour, "", Design::Blend, "reflection"),
    (Design::Levels, "weight", Design::LobeLaw, "level_weight"),
    (Design::LobeLaw, "widths[0]", Design::Lobe, "width"),
    (Design::LobeLaw, "weight", Design::Lobes, "weight"),
    (Design::Reflection, "surface.rough", Design::Lobe, "rough"),
    (Design::Blend, "", Design::Lobes, "colours[0]"),
    (Design::Lobes, "", Design::PixelSum, "colour"),
    (Design::Blend, "", Design::PixelSum, "colour"),
];

/// Range of an output: by the walk or, if a port with at most 2^16 values is the only input, by trying every value of it.
fn sent(net: &Net) -> Vec<Range> {
    let ranges = Ranges::new(net);
    match net.ports.as_slice() {
        [port] if port.high - port.low <= 1 << 16 => {
            let mut seen = Observed::new(net);
            for value in port.low..=port.high {
                seen.evaluate(net, &[value]);
            }
            net.outputs.iter().filter_map(|output| seen.of(output.node)).collect()
        }
        _ => net.outputs.iter().map(|output| ranges.of(output.node)).collect(),
    }
}

#[test]
fn ports_allow_what_the_design_before_them_can_send() {
    for (profile, p) in profiles() {
        for (above, from, below, to) in CONNECTIONS {
            for effects in effects_of(above) {
                let (above, below) = (record::net(above, &effects, &p), record::net(below, &Effects::ALL, &p));
                let outputs = above.outputs.iter().zip(sent(&above));
                let mut connected = 0;
                for (output, range) in outputs.filter(|(output, _)| output.name.starts_with(from)) {
                    let rest = output.name[from.len()..].trim_start_matches('.');
                    let bare = to.is_empty() || rest.is_empty() || rest.starts_with('[');
                    let point = if bare { "" } else { "." };
                    let name = format!("{to}{point}{rest}");
                    let port = below.ports.iter().find(|port| port.name == name);
                    let port = port.unwrap_or_else(|| panic!("{name} is a port"));
                    let allowed = Range { low: port.low, high: port.high, zeros: 0 };
                    let inside = allowed.contains(range.low) && allowed.contains(range.high);
                    assert!(inside, "{profile} {effects:?}: {} is {range}, {name} takes {allowed}", output.name);
                    assert_eq!(port.fraction_bits, output.fraction_bits, "{name}");
                    connected += 1;
                }
                assert!(connected > 0, "nothing connects {from} with {to}");
            }
        }
    }
}

#[test]
fn every_operation_names_its_source_line_and_is_in_a_block() {
    for_every_design(|design, effects, p| {
        let net = record::net(design, effects, p);
        for (id, node) in net.iter() {
            if !matches!(node.op, Op::Lit(_) | Op::Port(_)) {
                let origin = net.origin(id);
                assert!(origin.starts_with("core/src/"), "{}: {origin}", node.op.name());
                assert!(node.stage.is_some(), "{}: {origin} is in no block", design.name());
            }
        }
    });
}

/// Lemmas named by the claims of a net.
fn lemmas(net: &Net) -> impl Iterator<Item = &'static str> {
    net.nodes.iter().filter_map(|node| match node.op {
        Op::Claim { lemma, .. } => Some(lemma),
        _ => None,
    })
}

#[test]
fn every_claim_names_a_lemma_that_is_a_test() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = |path: &str| fs::read_to_string(package.join(path)).expect("sources are text");
    let source = text("tests/datapath/lemmas.rs");
    let mut named = BTreeSet::new();
    for_every_design(|design, effects, p| named.extend(lemmas(&record::net(design, effects, p))));
    let tests: BTreeSet<_> =
        source.split("#[test]\nfn ").skip(1).filter_map(|test| Some(test.split_once("() {")?.0)).collect();
    assert!(named.is_subset(&tests), "no test: {:?}", named.difference(&tests));
    // Claims that no design reaches are in the source all the same.
    let core = ["elementary.rs", "stage/cube_face.rs", "stage/moments.rs", "stage/peaks.rs", "stage/probes.rs"];
    let core = core.map(|file| text(&format!("../core/src/{file}"))).concat();
    for test in tests {
        assert!(core.contains(&format!("\"{test}\"")), "{test}: nothing claims it");
    }
}

#[test]
fn operands_of_multipliers_have_the_bits_that_a_profile_keeps() {
    for (profile, p) in profiles() {
        for design in [
            Design::Reflection,
            Design::Fragment,
            Design::Texture,
            Design::Highlight,
            Design::LitPeak,
            Design::Peak,
            Design::Horizon,
        ] {
            for effects in effects_of(design) {
                let net = record::net(design, &effects, &p);
                let census = Census::new(&net, &Ranges::new(&net));
                let operand = p.fraction_bits + 2;
                // A rise of the logarithm's table has 18 bits on 32-bit words; a stored slope and a share of light have 18 in every profile.
                let lit = matches!(design, Design::LitPeak | Design::Peak | Design::Horizon);
                let least = if p.word_bits() == 32 || lit { 18 } else { operand };
                let [wide, narrow] = census.total.widest_multiplier();
                let narrow_operand = if lit { operand.max(least) } else { operand };
                assert!(
                    wide <= operand.max(least) && narrow <= narrow_operand,
                    "{profile} {effects:?}: {wide} x {narrow}"
                );
                assert!(census.total.constant_multipliers.keys().all(|[bits, _]| *bits <= operand));
            }
        }
    }
}

#[test]
fn a_census_adds_up_and_its_critical_paths_take_the_levels_it_says() {
    for (_, p) in profiles() {
        for &design in Design::ALL {
            let net = record::net(design, &Effects::ALL, &p);
            let ranges = Ranges::new(&net);
            let census = Census::new(&net, &ranges);
            let sum = |figure: fn(&Cost) -> u64| {
                let stages: u64 = census.stages.iter().map(|stage| figure(&stage.cost)).sum();
                let blocks: u64 = census.runs.iter().map(figure).sum();
                assert_eq!((stages, blocks), (figure(&census.total), figure(&census.total)), "{}", design.name());
            };
            sum(|cost| cost.multiplier_count().into());
            sum(Cost::carry_bits);
            sum(Cost::rom_bits);
            sum(|cost| cost.selects.bits + cost.logic.bits + cost.shifters.bits);
            let multiplications = net.nodes.iter().filter(|node| matches!(node.op, Op::Mul(..))).count() as u32;
            let by_constants: u32 = census.total.constant_multipliers.values().sum();
            assert!(census.total.multiplier_count() + by_constants <= multiplications);

            let length = |path: Vec<u32>| -> u32 { path.into_iter().map(|id| levels(&net, &ranges, id)).sum() };
            assert_eq!(length(critical_path(&net, &ranges, None)), census.total.levels, "{}", design.name());
            for (block, cost) in (0..).zip(&census.runs) {
                let path = critical_path(&net, &ranges, Some(block));
                assert!(path.iter().all(|&id| net.node(id).stage == Some(block)));
                assert_eq!(length(path), cost.levels, "{} {}", design.name(), net.runs[block as usize].instance());
            }
            assert_eq!(arrival_in_block(&net, &ranges).len(), net.nodes.len());
        }
    }
}
