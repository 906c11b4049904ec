//! Designs in one module: an instance of each, with wires for its ports.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use roughxel_core::design::Design;
use roughxel_netlist::interval::Ranges;
use roughxel_netlist::verilog::{FoldSummary, Interface, Options, PortDescription, VerilogError};
use roughxel_record as record;

use crate::pin::Pin;

/// Path of a port as part of a Verilog name.
fn identifier(path: &str) -> String {
    path.replace(['.', '['], "_").replace(']', "").trim_start_matches('_').to_owned()
}

/// A design that was folded and written.
struct Made {
    interface: Interface,
    fold: Option<FoldSummary>,
    /// Outputs without a port: integer and binary point.
    constants: BTreeMap<String, (i64, u32)>,
}

/// An instance of a design.
struct Instance {
    name: String,
    design: Design,
    inputs: Vec<(String, String)>,
    /// Paths of the outputs that are read.
    read: BTreeSet<String>,
}

/// Designs, the files that hold them, and their instances.
pub(crate) struct Chain {
    options: Options,
    made: BTreeMap<Design, Made>,
    pub(crate) files: BTreeMap<String, String>,
    instances: Vec<Instance>,
    /// Bits of outputs that no reader takes: claims of the datapath say that they repeat a sign or are zeros.
    lost: BTreeSet<String>,
}

impl Chain {
    /// No instance yet; designs are written with these options.
    pub(crate) fn new(options: Options) -> Self {
        Self { options, made: BTreeMap::new(), files: BTreeMap::new(), instances: Vec::new(), lost: BTreeSet::new() }
    }

    /// Adds an instance of a design that is folded on this many multipliers.
    pub(crate) fn add(&mut self, name: &str, design: Design, multipliers: u32) -> Result<(), VerilogError> {
        self.add_with(name, design, multipliers, Vec::new())
    }

    /// Adds an instance that has only some outputs ([`Options::outputs`]).
    pub(crate) fn add_with(
        &mut self,
        name: &str,
        design: Design,
        multipliers: u32,
        outputs: Vec<String>,
    ) -> Result<(), VerilogError> {
        if !self.made.contains_key(&design) {
            let made = self.make(design, multipliers, outputs)?;
            self.made.insert(design, made);
        }
        self.instances.push(Instance { name: name.into(), design, inputs: Vec::new(), read: BTreeSet::new() });
        Ok(())
    }

    fn make(&mut self, design: Design, multipliers: u32, outputs: Vec<String>) -> Result<Made, VerilogError> {
        let prefix = format!("{}_", design.name());
        let options = Options { multipliers: Some(multipliers), outputs, prefix, ..self.options.clone() };
        let net = record::net(design, &options.effects, &options.precision);
        let ranges = Ranges::new(&net);
        let constant = |output: &roughxel_netlist::graph::Tap| {
            Some((output.name.clone(), (ranges.of(output.node).constant()?, output.fraction_bits)))
        };
        let constants = net.outputs.iter().filter_map(constant).collect();
        let verilog = match record::verilog(design, &options) {
            // An operation that no register cuts decides the depth of its design.
            Err(VerilogError::TooDeep { least, .. }) => {
                record::verilog(design, &Options { depth: Some(least), ..options })?
            }
            written => written?,
        };
        for (name, text) in verilog.files {
            let known = self.files.entry(name).or_insert_with(|| text.clone());
            debug_assert_eq!(*known, text, "modules of one name are the same");
        }
        let interface = verilog.top.unwrap_or_else(|| unreachable!("a whole design has a top"));
        Ok(Made { interface, fold: verilog.fold, constants })
    }

    fn index(&self, name: &str) -> usize {
        let index = self.instances.iter().position(|instance| instance.name == name);
        index.unwrap_or_else(|| unreachable!("{name} was added"))
    }

    fn made(&self, name: &str) -> &Made {
        &self.made[&self.instances[self.index(name)].design]
    }

    /// Input ports of an instance.
    pub(crate) fn inputs(&self, name: &str) -> &[PortDescription] {
        &self.made(name).interface.inputs
    }

    /// Ports of the probe that hold its footprint.
    pub(crate) fn footprint(&self) -> impl Iterator<Item = &PortDescription> {
        self.inputs("probe").iter().filter(|port| !["index", "last_level"].contains(&port.name.as_str()))
    }

    /// Format of an input port; `None` if the design does not read it.
    pub(crate) fn input(&self, name: &str, path: &str) -> Option<Pin> {
        self.inputs(name).iter().find(|port| port.name == path).map(Pin::of)
    }

    /// Output of an instance as an expression of the format `to`.
    pub(crate) fn output(&mut self, name: &str, path: &str, to: Pin) -> String {
        let made = self.made(name);
        if let Some(port) = made.interface.outputs.iter().find(|port| port.name == path) {
            let wire = format!("{name}_out_{}", identifier(path));
            let (text, lost) = (Pin::of(port).converted(&wire, to), Pin::of(port).lost(&wire, to));
            let index = self.index(name);
            self.lost.extend(lost);
            self.instances[index].read.insert(path.to_owned());
            return text;
        }
        let &(value, fraction_bits) =
            made.constants.get(path).unwrap_or_else(|| unreachable!("{name} has the output {path}"));
        to.literal(value, fraction_bits)
    }

    /// Connects an input port of an instance to an expression of its own format.
    pub(crate) fn connect(&mut self, name: &str, path: &str, text: String) {
        let made = self.made(name);
        let Some(port) = made.interface.inputs.iter().find(|port| port.name == path) else { return };
        let port = port.port.clone();
        let index = self.index(name);
        self.instances[index].inputs.push((port, text));
    }

    /// Connects an input port of an instance to a wire of another format.
    pub(crate) fn connect_wire(&mut self, name: &str, path: &str, wire: &str, format: Pin) {
        if let Some(to) = self.input(name, path) {
            self.connect(name, path, format.converted(wire, to));
        }
    }

    /// Figures of the folded designs, in the order of a fragment.
    pub(crate) fn folds(&self) -> Vec<(Design, FoldSummary)> {
        self.made.iter().filter_map(|(design, made)| Some((*design, made.fold.clone()?))).collect()
    }

    /// Declarations of the wires of all instances.
    pub(crate) fn wires(&self) -> String {
        let mut text = String::new();
        for Instance { name, design, read, .. } in &self.instances {
            let _ = writeln!(text, "  wire {name}_in_valid, {name}_in_ready, {name}_out_valid, {name}_out_ready;");
            for port in &self.made[design].interface.outputs {
                let unread = if read.contains(&port.name) { "" } else { "unused_" };
                let _ =
                    writeln!(text, "  wire {}{unread}{name}_out_{};", Pin::of(port).vector(), identifier(&port.name));
            }
        }
        let lost: Vec<_> = self.lost.iter().map(|bits| format!(",\n    {bits}")).collect();
        let _ = writeln!(text, "  wire unused_bits = &{{1'b0{}}};", lost.concat());
        text
    }

    /// The instances.
    pub(crate) fn instances(&self) -> String {
        let mut text = String::new();
        for Instance { name, design, inputs, read } in &self.instances {
            let interface = &self.made[design].interface;
            let mut pins = vec![("clk".to_owned(), "clk".to_owned()), ("rst".to_owned(), "rst".to_owned())];
            let handshake = ["in_valid", "in_ready", "out_valid", "out_ready"];
            pins.extend(handshake.map(|pin| (pin.to_owned(), format!("{name}_{pin}"))));
            pins.extend(inputs.iter().cloned());
            pins.extend(interface.outputs.iter().map(|port| {
                let unread = if read.contains(&port.name) { "" } else { "unused_" };
                (port.port.clone(), format!("{unread}{name}_out_{}", identifier(&port.name)))
            }));
            let pins: Vec<_> = pins.iter().map(|(port, wire)| format!(".{port}({wire})")).collect();
            let _ = writeln!(text, "  {} u_{name} (\n    {}\n  );\n", interface.module, pins.join(",\n    "));
        }
        text
    }
}
