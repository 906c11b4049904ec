//! Evaluator of a net: it gives the scalar backend's bits on every named wire, and every wire stays in its proven range.

use fixed::types::I4F28;
use rayon::prelude::*;
use roughxel_cases::stimulus::port_values;
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects, FrameSystem};
use roughxel_core::ports::{Port, ReflectionIn, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_host_tests::checked::{Integers, Trace, traced};
use roughxel_host_tests::designs::{checked, scalar};
use roughxel_host_tests::space::{any_vectors, any_word, whole_or};
use roughxel_netlist::graph::{Net, Tap};
use roughxel_netlist::integers::integers;
use roughxel_netlist::interval::Ranges;
use roughxel_netlist::observe::Observed;
use roughxel_record as record;
use roughxel_utilities::random::SplitMix64;

use super::{effects, profiles};

/// The integer of a tap in the checked backend; `None` if its function does not run through the block.
fn in_trace(net: &Net, trace: &Trace, tap: &Tap) -> Option<i64> {
    let block = &net.runs[tap.stage? as usize];
    let mut runs = trace.iter().filter(|(name, _)| *name == block.name);
    let (_, outcome) = runs.nth(block.run as usize)?;
    outcome.at(&tap.path)
}

/// Compares outputs with the scalar backend and taps with the checked one. Returns the number of compared taps.
fn compare(design: Design, net: &Net, wires: &[i64], ports: &[i64], effects: &Effects, p: &Precision) -> usize {
    let name = design.name();
    let scalar = scalar(design, ports, effects, p);
    let outputs = net.outputs.iter().map(|output| (&output.path[..], wires[output.node as usize]));
    let outputs: Integers = outputs.collect();
    assert_eq!(outputs, scalar, "{name} of {ports:?}");
    let (checked, trace) = traced(|| checked(design, ports, effects, p));
    assert_eq!(checked, scalar);
    let taps = net.taps.iter().filter_map(|tap| Some((tap, in_trace(net, &trace, tap)?)));
    let differing = |(tap, value): (_, i64)| {
        let tap: &Tap = tap;
        assert_eq!(wires[tap.node as usize], value, "{name}: {} of {ports:?}", net.tap_name(tap));
    };
    taps.map(differing).count()
}

/// Evaluates a design for every fragment and checks it against the other backends and the proof.
fn check(design: Design, effects: &Effects, p: &Precision, fragments: &[ReflectionIn]) {
    let (name, net) = (design.name(), record::net(design, effects, p));
    let ranges = Ranges::new(&net);
    assert!(ranges.violations.is_empty());
    let halves: Vec<_> = fragments.chunks(fragments.len().div_ceil(2).max(1)).collect();
    halves.into_par_iter().for_each(|fragments| {
        let mut seen = Observed::new(&net);
        for (index, fragment) in (0..).zip(fragments) {
            let mut random = SplitMix64::for_element(name, index);
            for ports in port_values(design, &net, fragment, effects, p, &mut random) {
                let wires = seen.evaluate(&net, &ports).to_vec();
                let compared = compare(design, &net, &wires, &ports, effects, p);
                assert_eq!(compared, net.taps.len(), "every named wire has a counterpart");
            }
        }
        if let Some(id) = seen.first_outside(&ranges) {
            panic!("{name}: {} is {:?}, proven {}", net.origin(id), seen.of(id), ranges.of(id));
        }
    });
}

#[test]
fn a_net_gives_the_bits_of_the_scalar_backend_on_every_hard_case() {
    for (_, p) in profiles() {
        for set in hard_case_sets(&p) {
            check(Design::Reflection, &set.plan.into(), &p, &set.cases);
            check(Design::EnvironmentProbe, &set.plan.into(), &p, &set.cases);
            check(Design::SphereProbe, &set.plan.into(), &p, &set.cases);
        }
    }
}

#[test]
fn a_net_gives_the_bits_of_the_scalar_backend_on_random_fragments() {
    for (_, p) in profiles() {
        let fragments: Vec<_> = (0..whole_or(10_000, 1000)).map(|index| random_fragment("net", index, &p)).collect();
        for &design in Design::ALL {
            check(design, &Effects::ALL, &p, &fragments);
        }
        for datapath in Datapath::ALL {
            for (index, effects) in effects(Some(datapath)).iter().enumerate() {
                let each = whole_or(100, 10);
                check(Design::for_datapath(datapath), effects, &p, &fragments[each * (index % 100)..][..each]);
            }
        }
    }
}

/// Any bits at any port.
fn any_fragment(random: &mut SplitMix64) -> ReflectionIn {
    let [normal, view, t0, t1, vx, vy, nx, ny] = any_vectors(random);
    let [b1, b2, d1, d2, d3] = [0; 5].map(|_| I4F28::from_bits(any_word(random)));
    ReflectionIn {
        surface: SurfaceIn { normal, view, frame_vectors: [t0, t1], offset: [b1, b2], roughness: [d1, d2, d3] },
        dview: [vx, vy],
        dnormal: [nx, ny],
        edge_texels: [0, u16::MAX, random.next_u64() as u16][random.below(3) as usize] >> random.below(16),
    }
}

#[test]
fn a_net_gives_the_bits_of_the_scalar_backend_for_any_bits_at_its_ports() {
    for (profile, p) in profiles() {
        for frame in [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised] {
            let effects = Effects { frame, ..Effects::ALL };
            let mut random = SplitMix64::for_element(profile, frame as u64);
            let fragments: Vec<_> = (0..whole_or(4000, 400)).map(|_| any_fragment(&mut random)).collect();
            for design in [
                Design::Fragment,
                Design::Highlight,
                Design::LitPeak,
                Design::EnvironmentProbe,
                Design::Texture,
                Design::TextureProbe,
            ] {
                check(design, &effects, &p, &fragments);
            }
        }
    }
}

#[test]
fn integers_of_a_bundle_are_the_ports_of_its_net() {
    let p = Precision::STANDARD;
    let fragment = random_fragment("ports", 0, &p);
    let wires = fragment.wires();
    let net = record::net(Design::Fragment, &Effects::ALL, &p);
    let names: Vec<_> = net.ports.iter().map(|port| port.name.clone()).collect();
    let expected = Integers::from_bundle(&wires);
    assert_eq!(names, expected.names().collect::<Vec<_>>());
    assert_eq!(integers(&wires), expected.values());
}
