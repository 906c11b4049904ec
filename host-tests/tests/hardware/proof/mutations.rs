//! Broken nets: a clamp, a rounding, a claim or a pattern that the walk relies on is missing.
//!
//! A mutation that lets a wire leave its word must be caught. The others leave every wire inside its word, and ranges cannot see them: half a last
//! place not added; a clamp that bounds an error, not a word, or whose operand the walk already bounds; a value twice as large that still fits;
//! 16-bit texels, for which even wrong weights stay below 2^31. The tests of accuracy and of single steps detect those.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use roughxel_core::design::Design;
use roughxel_core::plan::{Effects, FrameSystem};
use roughxel_netlist::census::Census;
use roughxel_netlist::graph::{Kind, Net, NodeId, Op};
use roughxel_netlist::interval::Ranges;
use roughxel_record as record;

use super::profiles;

/// Mutation of a net.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Sort {
    ClaimDropped,
    ResidualUnclamped,
    ShiftCountUnclamped,
    OtherClampDropped,
    RoundingOnePlaceShort,
    HalfNotAdded,
    NormalisedByOneTooMany,
    MagnitudeNotCounted,
    WeightsDoNotSum,
}

/// One broken net.
struct Mutant {
    sort: Sort,
    /// The broken node.
    node: NodeId,
    net: Net,
}

/// The net in which readers of `id` read `by`, an earlier wire of its kind.
fn without(net: &Net, id: NodeId, by: NodeId) -> Net {
    let instead = |operand: NodeId| if operand == id { by } else { operand };
    let mut net = net.clone();
    for node in &mut net.nodes {
        node.op = node.op.map(instead);
    }
    for tap in net.taps.iter_mut().chain(&mut net.outputs) {
        tap.node = instead(tap.node);
    }
    net
}

/// The net with a different operation at `id`.
fn with(net: &Net, id: NodeId, op: Op) -> Net {
    let mut net = net.clone();
    net.nodes[id as usize].op = op;
    net
}

/// Places in the sources of the core that contain `text`: `core/src/block.rs:97`.
fn lines_with(file: &str, text: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    let source = fs::read_to_string(path).expect("sources are text");
    let lines = (1..).zip(source.lines()).filter(|(_, line)| line.contains(text));
    let lines: Vec<_> = lines.map(|(number, _)| format!("{file}:{number}")).collect();
    assert!(!lines.is_empty(), "{text} is not in {file} any more");
    lines
}

/// Every broken version of a net.
fn mutants(net: &Net) -> Vec<Mutant> {
    let op = |id| net.node(id).op;
    let constant = |id| matches!(op(id), Op::Lit(_));
    let line = |id| format!("{}:{}", net.node(id).at.file(), net.node(id).at.line());
    let residuals = lines_with("core/src/elementary.rs", ".saturate(-limit, limit)");
    let counts = [
        lines_with("core/src/block.rs", ".saturate(Fx::int(0), Fx::int(most.into()))"),
        lines_with("core/src/fx.rs", ".saturate(Fx::int(0), Fx::int(i64::from(X::BITS - 2)))"),
        lines_with("core/src/stage/probes.rs", ".saturate(Fx::int(0), Fx::int((<W::Wide as Wire>::BITS - 2).into()))"),
    ]
    .concat();
    // Ors below a leading-zero counter.
    let mut counted = vec![false; net.nodes.len()];
    for (id, node) in net.iter().rev() {
        if let Op::LeadingZeros(of) = node.op {
            counted[of as usize] = true;
        }
        if let (true, Op::Or(a, b)) = (counted[id as usize], node.op) {
            (counted[a as usize], counted[b as usize]) = (true, true);
        }
    }
    let mut found = Vec::new();
    let mut add = |sort, node, net| found.push(Mutant { sort, node, net });
    for (id, node) in net.iter() {
        match node.op {
            Op::Claim { of, .. } => add(Sort::ClaimDropped, id, without(net, id, of)),
            // The smaller or the larger of a wire and a constant.
            Op::Select(flag, a, b) if constant(a) != constant(b) => {
                let Op::Lt(x, y) = op(flag) else { continue };
                if ![(a, b), (b, a)].contains(&(x, y)) {
                    continue;
                }
                let sort = match line(id) {
                    line if residuals.contains(&line) => Sort::ResidualUnclamped,
                    line if counts.contains(&line) => Sort::ShiftCountUnclamped,
                    _ => Sort::OtherClampDropped,
                };
                add(sort, id, without(net, id, if constant(a) { b } else { a }));
            }
            Op::Sar(sum, 1) => {
                let Op::Add(shifted, one) = op(sum) else { continue };
                if op(one) != Op::Lit(1) {
                    continue;
                }
                add(Sort::HalfNotAdded, id, without(net, sum, shifted));
                if let Op::Sar(of, places @ 1..) = op(shifted) {
                    add(Sort::RoundingOnePlaceShort, id, with(net, shifted, Op::Sar(of, places - 1)));
                }
            }
            Op::ShlBy(x, count) => {
                let Op::Sub(zeros, one) = op(count) else { continue };
                if matches!(op(zeros), Op::LeadingZeros(_)) && op(one) == Op::Lit(1) {
                    add(Sort::NormalisedByOneTooMany, id, with(net, id, Op::ShlBy(x, zeros)));
                }
            }
            Op::Or(a, b) if counted[id as usize] => {
                add(Sort::MagnitudeNotCounted, id, without(net, id, a));
                add(Sort::MagnitudeNotCounted, id, without(net, id, b));
            }
            // 1 − w, the complementary weight of w.
            Op::Sub(one, weight)
                if node.kind == Kind::Wire(32)
                    && ["filter.rs", "blend.rs"].iter().any(|file| line(id).contains(file)) =>
            {
                if matches!(op(one), Op::Lit(value) if value.count_ones() == 1) {
                    add(Sort::WeightsDoNotSum, id, without(net, id, weight));
                }
            }
            _ => {}
        }
    }
    found
}

/// Designs with clamps, claims, roundings or interpolation.
const BROKEN: [Design; 9] = [
    Design::MapScale,
    Design::Reflection,
    Design::Texture,
    Design::EnvironmentProbe,
    Design::TextureProbe,
    Design::Bump,
    Design::WordSample,
    Design::ColourSample,
    Design::Blend,
];

/// The nets to break, with the names of profile and design.
fn subjects() -> Vec<(&'static str, Design, Net)> {
    let mut nets = Vec::new();
    for (profile, p) in profiles() {
        for design in BROKEN {
            let frames = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];
            for frame in frames.into_iter().take(if design == Design::Reflection { 3 } else { 1 }) {
                nets.push((profile, design, record::net(design, &Effects { frame, ..Effects::ALL }, &p)));
            }
        }
    }
    nets
}

/// Returns true if a value counted in the or-tree below a leading-zero counter is shifted by the count anywhere.
fn is_normalised(net: &Net, tree: NodeId) -> bool {
    match net.node(tree).op {
        Op::Or(a, b) => is_normalised(net, a) || is_normalised(net, b),
        Op::Xor(x, _) => net.nodes.iter().any(|node| {
            matches!(node.op, Op::ShlBy(of, count) if of == x && matches!(net.node(count).op, Op::Sub(zeros, _)
                if matches!(net.node(zeros).op, Op::LeadingZeros(_))))
        }),
        _ => false,
    }
}

/// Returns true if mantissas are on 16-bit words.
fn has_narrow_words(net: &Net) -> bool {
    net.ports.iter().any(|port| port.mantissa && port.kind == Kind::Wire(16))
}

/// The reason why ranges cannot see a mutation; `None` if they must.
fn harmless(net: &Net, ranges: &Ranges, mutant: &Mutant, design: Design) -> Option<&'static str> {
    let id = mutant.node;
    let line = format!("{}:{}", net.node(id).at.file(), net.node(id).at.line());
    let at = |file: &str, text: &str| lines_with(file, text).contains(&line);
    match (mutant.sort, net.node(id).op) {
        (Sort::ClaimDropped, _) => {
            let widths = |net: &Net| Census::new(net, &Ranges::new(net)).total.multipliers;
            (widths(net) != widths(&mutant.net)).then_some("a multiplier becomes wider, which the census shows")
        }
        (Sort::HalfNotAdded, _) => Some("one last place"),
        (Sort::ResidualUnclamped | Sort::ShiftCountUnclamped | Sort::OtherClampDropped, Op::Select(_, a, b)) => {
            let operand = if matches!(net.node(a).op, Op::Lit(_)) { b } else { a };
            let (with, without) = (ranges.of(id), ranges.of(operand));
            // `Fx::round_shr_by` on words without a spare bit.
            let again = mutant.sort == Sort::ShiftCountUnclamped && has_narrow_words(net);
            if with.low <= without.low && without.high <= with.high {
                Some("the walk has bounded the operand already")
            } else if again && without.high <= with.high {
                Some("the count is clamped from below once more where it is used")
            } else {
                (mutant.sort == Sort::OtherClampDropped).then_some("bounds an error or a meaning, not a word")
            }
        }
        (Sort::RoundingOnePlaceShort, _) => {
            let fits =
                at(
                    "core/src/elementary.rs",
                    "within.reread::<MANTISSA>().shl(INT - MANTISSA + places).quantise(fraction_bits)",
                ) || at("core/src/elementary.rs", "let value: Control<W, LOGARITHM> = (Fx::wide_of_control(knot)")
                    || at("core/src/stage/blend.rs", ".round_to(24)")
                    || at("core/src/stage/moments.rs", "product.round_to(Fx::<W, MOMENT>::FRACTION)")
                    || at("core/src/stage/probes.rs", "per_sigma.quantise(p.offset_bits())")
                    || at("core/src/stage/probes.rs", "reach.max(Fx::zero()).min(Fx::int(1)).round_to_control(16)")
                    || at(
                        "core/src/stage/probes.rs",
                        "lod.saturate(Fx::zero(), map.last_level.to_control()).quantise(p.lod_bits)",
                    )
                    || design == Design::ColourSample;
            fits.then_some("twice the value still fits")
        }
        (Sort::MagnitudeNotCounted, Op::Or(a, b)) => {
            (!is_normalised(net, a) || !is_normalised(net, b)).then_some("nothing reads the value that is not counted")
        }
        (Sort::WeightsDoNotSum, _) => (design != Design::WordSample).then_some("twice the value still fits"),
        _ => None,
    }
}

#[test]
fn the_proof_notices_what_breaks_it() {
    let mut tally: BTreeMap<Sort, [u32; 2]> = BTreeMap::new();
    let mut survivors: BTreeMap<(Sort, &str), BTreeMap<String, u32>> = BTreeMap::new();
    for (profile, design, net) in subjects() {
        let ranges = Ranges::new(&net);
        assert!(ranges.violations.is_empty());
        for mutant in mutants(&net) {
            let origin = net.origin(mutant.node);
            let violations = Ranges::new(&mutant.net).violations;
            let [caught, total] = tally.entry(mutant.sort).or_default();
            *total += 1;
            let Some(violation) = violations.first() else {
                let why = harmless(&net, &ranges, &mutant, design);
                let why =
                    why.unwrap_or_else(|| panic!("{profile} {design:?}: {:?} at {origin} is not seen", mutant.sort));
                let line = origin.split(" in ").next().unwrap_or_default().to_string();
                *survivors.entry((mutant.sort, why)).or_default().entry(line).or_default() += 1;
                continue;
            };
            *caught += 1;
            // The report names a line of the block in which the wire overflows; for a missing claim, that is the stage that made it.
            assert!(violation.origin.starts_with("core/src/"), "{violation}");
            if mutant.sort == Sort::ClaimDropped {
                let stage = |origin: &str| origin.split(':').next().unwrap_or_default().to_string();
                assert_eq!(stage(&violation.origin), stage(&origin), "{violation}");
            }
        }
    }
    for (sort, [caught, total]) in &tally {
        println!("{sort:?}: {caught} of {total} caught");
        let ours = survivors.iter().filter(|((survivor, _), _)| survivor == sort);
        for ((_, why), lines) in ours {
            let count: u32 = lines.values().sum();
            println!("  {count} not seen ({why}): {}", lines.keys().cloned().collect::<Vec<_>>().join(", "));
        }
    }
    for sort in [Sort::ResidualUnclamped, Sort::NormalisedByOneTooMany] {
        let [caught, total] = tally[&sort];
        assert!(caught == total && total > 0, "{sort:?}: {caught} of {total}");
    }
}
