//! Designs with some of their outputs.

use rayon::prelude::*;
use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_host_tests::simulators::have;
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{Folded, Options};
use roughxel_record as record;

use super::rtl::{Case, FULL, options};

/// Footprint for the probes.
const FOOTPRINT: [&str; 3] = ["point.select", "point.st", "probes"];

fn with_outputs(paths: &[&str], options: Options) -> Options {
    Options { outputs: paths.iter().map(|&path| path.to_owned()).collect(), ..options }
}

#[test]
fn chosen_outputs_are_the_only_ports_and_keep_their_bits() {
    let narrow = || options("narrow", FULL, None);
    let cases = [
        (Design::Reflection, FOOTPRINT.as_slice(), narrow()),
        (Design::Reflection, &FOOTPRINT, options("standard", FULL, Some(24))),
        (Design::Reflection, &FOOTPRINT, Options { multipliers: Some(5), target: Target::Ecp5, ..narrow() }),
        (Design::Reflection, &["surface.normal_mod", "status"], Options { multipliers: Some(2), ..narrow() }),
        (Design::Reflection, &["columns[2]"], narrow()),
        (Design::FaceTexels, &["[1]"], narrow()),
        (Design::EnvironmentProbe, &["place.st"], Options { stream: Some(32), ..narrow() }),
    ];
    cases.into_par_iter().for_each(|(design, paths, options)| {
        let mut case = Case::new(design, 60, &with_outputs(paths, options));
        // Icarus runs some 200 fragments a second of a flat reflection.
        if design == Design::Reflection {
            case.inputs = case.inputs.into_iter().step_by(20).collect();
            case.outputs = case.outputs.into_iter().step_by(20).collect();
        }
        let top = case.written.verilog.top.as_ref().expect("a top");
        let leads = |name: &str| paths.iter().any(|path| name.starts_with(path));
        assert!(!top.outputs.is_empty() && top.outputs.iter().all(|port| leads(&port.name)), "{:?}", top.outputs);
        if have("verilator") {
            case.written.lint();
        }
        if have("iverilog") {
            case.written.icarus(&case.bench());
        }
    });
}

#[test]
fn a_stepper_adds_its_outputs_after_all_of_its_step() {
    let places = |paths: &[&str]| {
        let options = with_outputs(paths, options("narrow", FULL, None));
        let verilog = record::verilog(Design::EnvironmentProbe, &options).expect("the design is proven");
        let outputs = verilog.stepper.expect("a step has a stepper").outputs;
        let place = |name: &str| outputs.iter().find(|port| port.name == name).map(|port| port.place);
        [place("lod"), place("last")]
    };
    let count = record::net(Design::EnvironmentProbe, &FULL, &options("narrow", FULL, None).precision).outputs.len();
    assert_eq!(places(&["place.st"]), [Some(count), Some(count + 1)]);
    assert_eq!(places(&[]), places(&["place.st"]));
}

#[test]
fn what_only_other_outputs_need_goes() {
    let normal = with_outputs(&["surface.normal_mod"], options("narrow", FULL, None));
    let verilog = record::verilog(Design::Reflection, &normal).expect("the design is proven");
    let stages: Vec<_> =
        verilog.files.keys().filter(|name| name.contains("axes") || name.contains("reflect.")).collect();
    assert!(stages.is_empty(), "{stages:?}");
    assert!(verilog.files.keys().any(|name| name.contains("perturb")));

    // With the footprint alone, nothing waits for the end of the pipeline but the point.
    let values = |paths: &[&str]| {
        let options = with_outputs(paths, Options { multipliers: Some(5), ..options("narrow", FULL, None) });
        let net = record::net(Design::Reflection, &options.effects, &options.precision);
        Folded::from_net(net, &options).expect("the design is proven").summary().values
    };
    let [footprint, all] = [values(&FOOTPRINT), values(&[])];
    assert!(3 * footprint < 2 * all, "{footprint} of {all} values wait");
}

#[test]
fn an_output_that_is_not_there_is_named_with_those_that_are() {
    for (design, path, known) in [
        (Design::Reflection, "probe", "they are surface, reflected, point, columns, ellipse, axes, probes"),
        (Design::Reflection, "point.s", "no output is `point.s`"),
        (Design::Blend, "colour", "they are result"),
    ] {
        let options = with_outputs(&[path], options("narrow", Effects::ALL, None));
        let error = record::verilog(design, &options).expect_err("there is no such output").to_string();
        assert!(error.contains(known), "{error}");
    }
}
