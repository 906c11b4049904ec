//! The testbench in the folder of a shell: random fragments and what they give, for any design.

use roughxel_cases::random_fragment;
use roughxel_cases::stimulus::port_values;
use roughxel_core::design::Design;
use roughxel_netlist::bench::{BENCH, Bench, BenchError, SHELL_TEST};
use roughxel_netlist::graph::Net;
use roughxel_netlist::verilog::{Options, Verilog};
use roughxel_record as record;
use roughxel_utilities::random::SplitMix64;

/// Folder of the testbench, next to the Verilog.
const FOLDER: &str = "bench";

/// Least number of inputs; a footprint has as many outcomes as probes.
const COUNT: usize = 64;

/// Inputs and outcomes of a testbench, a list of integers each.
type Vectors = (Vec<Vec<i64>>, Vec<Vec<i64>>);

/// Files of a testbench: path below the folder of the design, and content.
pub(crate) type BenchFiles = Vec<(String, Vec<u8>)>;

/// Files of the testbench that drives the shell of a design: vectors, `bench.v` for Icarus, `test_shell.py` for cocotb, `MODULE_bfm_flat.v`. Without
/// a shell there are none.
///
/// Errors: an integer leaves its port.
pub fn shell_bench(design: Design, options: &Options, verilog: &Verilog) -> Result<BenchFiles, BenchError> {
    let Some(shell) = &verilog.shell else { return Ok(Vec::new()) };
    let net = record::net(design, &options.effects, &options.precision);
    let (inputs, outputs) = vectors(design, options, &net, verilog.stepper.is_some());
    let mut files = Bench::new(&shell.driven, &inputs, &outputs)?.files();
    files.extend([BENCH, SHELL_TEST].map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec())));
    Ok(files.into_iter().map(|(name, bytes)| (format!("{FOLDER}/{name}"), bytes)).collect())
}

/// Inputs and outcomes: one each, or an outcome for each probe of a stepper.
fn vectors(design: Design, options: &Options, net: &Net, is_stepper: bool) -> Vectors {
    let (effects, p) = (&options.effects, &options.precision);
    let place = |name: &str| net.ports.iter().position(|port| port.name == name).filter(|_| is_stepper);
    let (index, count, lod) = (place("index"), place("probes.count"), place("probes.lod"));
    let (mut inputs, mut outputs, mut wires) = (Vec::new(), Vec::new(), Vec::new());
    for number in 0.. {
        let mut random = SplitMix64::for_element("shell", number);
        for ports in port_values(design, net, &random_fragment("shell", number, p), effects, p, &mut random) {
            net.evaluate(&ports, &mut wires);
            let mut outcome: Vec<i64> = net.outputs.iter().map(|output| wires[output.node as usize]).collect();
            let value = |place: Option<usize>| place.map(|place| ports[place]);
            let step = value(index);
            if let (Some(step), Some(count), Some(lod)) = (step, value(count), value(lod)) {
                outcome.extend([lod, i64::from(step + 1 == count)]);
            }
            outputs.push(outcome);
            if step.unwrap_or(0) == 0 {
                inputs.push(ports);
            }
        }
        // A fragment has all steps of its footprints.
        if inputs.len() >= COUNT {
            break;
        }
    }
    (inputs, outputs)
}
