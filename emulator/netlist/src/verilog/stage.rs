//! Single stages: the ports of each module, and its outcomes.

use roughxel_core::bundle::Step;

use super::context::Context;
use super::error::VerilogError;
use super::excerpt::Excerpt;
use super::format::Format;
use super::interface::{Interface, PortDescription};
use super::module::{Module, ModulePort};
use super::share::Group;
use super::{Options, Prepared};
use crate::graph::{Net, NodeId, Op};
use crate::interval::Range;
use crate::target::Target;

/// A recorded design and the modules of its stages.
#[derive(Clone, Debug)]
pub struct Stages {
    /// The whole design.
    pub net: Net,
    /// Selected stages, in the order of their first runs.
    pub stages: Vec<Stage>,
}

/// A module of the stages of a design: its ports, its runs and its outcomes.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Name of the module, without a prefix.
    pub name: String,
    /// Inputs in the order of the module.
    pub inputs: Vec<StagePort>,
    /// Outputs in the order of the module.
    pub outputs: Vec<StagePort>,
    /// Runs that are instances of the module, in the order of execution.
    pub runs: Vec<StageRun>,
    /// Operations of one run, with the module's inputs as ports and its outputs, in the module's order.
    pub unit: Net,
}

/// A port of a module.
#[derive(Clone, Debug)]
pub struct StagePort {
    /// Name in Verilog.
    pub name: String,
    /// Format of its integer on the wires.
    pub format: Format,
    /// Its wire in the first run: the path of a port of the design, or instance and path of an outcome.
    pub wire: String,
    /// Declarations of the fields of that path; empty for a wire without a name.
    pub path: Vec<Step>,
}

/// A run of a stage.
#[derive(Clone, Debug)]
pub struct StageRun {
    /// Name, unique in the design: `columns_pixel_1`.
    pub instance: String,
    /// Wires of the whole design on the inputs.
    pub inputs: Vec<NodeId>,
    /// Wires of the whole design on the outputs.
    pub outputs: Vec<NodeId>,
}

impl Stages {
    /// Proves a design that was recorded with these options and lists the modules of its stages, or those that [`Options::stage`] names.
    ///
    /// Errors: everything [`VerilogError`] lists.
    pub fn new(net: Net, options: &Options) -> Result<Self, VerilogError> {
        let prepared = Prepared::new(net, options)?;
        let wanted = prepared.chosen(options.stage.as_deref())?;
        // The module's text is not kept, so it has no line about its origin.
        let options =
            Options { depth: None, multipliers: None, target: Target::Asic, prefix: String::new(), ..options.clone() };
        let context = prepared.context(&options, "");
        let stage = |index: usize| -> Result<Stage, VerilogError> {
            let group = &prepared.groups[index];
            Ok(Stage::new(context, group, &prepared.module(context, group)?))
        };
        let stages = wanted.into_iter().map(stage).collect::<Result<_, _>>()?;
        Ok(Self { stages, net: prepared.net })
    }
}

impl Stage {
    fn new(context: Context, group: &Group, module: &Module) -> Self {
        let first = &group.runs[0];
        let of_module = |ports: &[ModulePort], nodes: &[NodeId]| -> Vec<StagePort> {
            ports.iter().map(|port| StagePort::new(context, port, nodes[port.place])).collect()
        };
        let places = |ports: &[ModulePort], nodes: &[NodeId]| ports.iter().map(|port| nodes[port.place]).collect();
        let runs = group.runs.iter().map(|run| StageRun {
            instance: context.net.runs[run.stage as usize].instance(),
            inputs: places(&module.inputs, &run.inputs),
            outputs: places(&module.outputs, &run.nodes),
        });
        Self {
            name: group.name.clone(),
            inputs: of_module(&module.inputs, &first.inputs),
            outputs: of_module(&module.outputs, &first.nodes),
            runs: runs.collect(),
            unit: unit(context, group, module),
        }
    }

    /// Outcomes of the module from the integers on its inputs; `wires` is overwritten.
    ///
    /// The integers are those of the wires, dropped zeros included, in the order of the ports.
    pub fn outcome(&self, inputs: &[i64], wires: &mut Vec<i64>) -> Vec<i64> {
        self.unit.evaluate(inputs, wires);
        self.unit.outputs.iter().map(|output| wires[output.node as usize]).collect()
    }

    /// Interface of the module for a testbench: combinational, without a clock and a handshake.
    pub fn interface(&self) -> Interface {
        let ports = |ports: &[StagePort]| -> Vec<PortDescription> {
            let description = |(place, StagePort { name, format, .. }): (usize, &StagePort)| {
                let Range { low, high, .. } = format.range;
                PortDescription::new(name, name, *format, [low, high], place)
            };
            ports.iter().enumerate().map(description).collect()
        };
        Interface { module: self.name.clone(), latency: 0, inputs: ports(&self.inputs), outputs: ports(&self.outputs) }
    }
}

impl StagePort {
    fn new(context: Context, port: &ModulePort, id: NodeId) -> Self {
        let net = context.net;
        let (wire, path) = match net.node(id).op {
            Op::Port(number) => {
                let port = &net.ports[number as usize];
                (port.name.clone(), port.path.clone())
            }
            _ => match net.taps.iter().find(|tap| tap.node == id && tap.stage == net.node(id).stage) {
                Some(tap) => (net.tap_name(tap), tap.path.clone()),
                None => (String::new(), Vec::new()),
            },
        };
        Self { name: port.name.clone(), format: port.format, wire, path }
    }
}

/// Operations of the first run as a separate net.
fn unit(context: Context, group: &Group, module: &Module) -> Net {
    let (net, first) = (context.net, &group.runs[0]);
    let mut excerpt = Excerpt::new(net, net.runs[first.stage as usize].name);
    for port in &module.inputs {
        let Format { range, zeros, fraction_bits, .. } = port.format;
        excerpt.add_port(first.inputs[port.place], port.name.clone(), fraction_bits, Range { zeros, ..range });
    }
    for &id in &first.inputs {
        // An input with one value in every run has no port.
        if let Some(value) = context.ranges.of(id).constant() {
            excerpt.add(id, Op::Lit(value));
        }
    }
    first.nodes.iter().for_each(|&id| excerpt.add_operation(id));
    for port in &module.outputs {
        let Format { range, fraction_bits, .. } = port.format;
        let output = excerpt.tap(first.nodes[port.place], None, port.name.clone(), fraction_bits);
        excerpt.net.outputs.push(output);
        excerpt.net.limits.push((range.low, range.high));
    }
    excerpt.net
}
