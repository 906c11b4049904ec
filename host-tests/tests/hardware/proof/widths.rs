//! Words of other widths: every design on 16-bit words is proven, and all backends of that width agree.

use rayon::prelude::*;
use roughxel_cases::random_fragment;
use roughxel_cases::stimulus::port_values;
use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_core::precision::{AxisDirection, Newton, Precision, ProbeRule};
use roughxel_host_tests::checked::Integers;
use roughxel_host_tests::designs::{checked, scalar};
use roughxel_host_tests::space::whole_or;
use roughxel_netlist::interval::Ranges;
use roughxel_netlist::observe::Observed;
use roughxel_record as record;
use roughxel_utilities::random::SplitMix64;

use super::{effects_of, holds};

/// Precisions whose kept bits all fit a 16-bit word.
fn narrow_precisions() -> Vec<Precision> {
    let newton = Newton { seed_bits: 8, steps: 1 };
    let base = Precision { reciprocal: newton, inverse_root: newton, ..Precision::COMPACT };
    let coarse = Precision { direction: AxisDirection::Table { steps: 10 }, probe_rule: ProbeRule::PowerOfTwo, ..base };
    let kept = [12, 13, 14].map(|fraction_bits| [base, coarse].map(|p| Precision { fraction_bits, ..p }));
    kept.into_iter().flatten().collect()
}

#[test]
fn no_wire_of_any_design_can_leave_words_of_16_bits() {
    for p in narrow_precisions() {
        for &design in Design::ALL {
            for effects in effects_of(design) {
                holds(design, &effects, &p);
            }
        }
    }
}

#[test]
fn backends_of_16_bits_agree() {
    let count = whole_or(4000, 200);
    narrow_precisions().into_par_iter().for_each(|p| {
        for &design in Design::ALL {
            let net = record::net(design, &Effects::ALL, &p);
            let ranges = Ranges::new(&net);
            let mut seen = Observed::new(&net);
            for index in 0..count {
                let fragment = random_fragment("widths", index, &p);
                let mut random = SplitMix64::for_element(design.name(), index);
                for ports in port_values(design, &net, &fragment, &Effects::ALL, &p, &mut random) {
                    let wires = seen.evaluate(&net, &ports);
                    let outputs = net.outputs.iter().map(|output| (&output.path[..], wires[output.node as usize]));
                    let outputs: Integers = outputs.collect();
                    let name = design.name();
                    assert_eq!(outputs, scalar(design, &ports, &Effects::ALL, &p), "{name} of {ports:?}");
                    let checked = checked(design, &ports, &Effects::ALL, &p);
                    assert_eq!(outputs, checked, "{name} of {ports:?}");
                }
            }
            if let Some(id) = seen.first_outside(&ranges) {
                panic!("{}: {} is {:?}, proven {}", design.name(), net.origin(id), seen.of(id), ranges.of(id));
            }
        }
    });
}
