//! The Verilog walk: a netlist as synthesizable Verilog-2005.
//!
//! Each stage is one module (`module`, its wires in `body`), shared by runs that are the same hardware (`share`). A pipelined top surrounds them
//! (`pipeline`), tables are ROMs (`rom`), and a state machine surrounds a step of the probe stepper (`stepper`). Wires have the bits that their
//! proven ranges need (`format`). So nothing is written if the interval walk finds an operation that could leave its word.

pub(crate) mod body;
mod context;
mod driver;
mod error;
mod excerpt;
mod fold;
mod format;
mod interface;
mod manifest;
mod module;
mod pipeline;
pub(crate) mod rom;
mod share;
mod shell;
mod stage;
mod stepper;
mod text;
pub(crate) mod value;
mod wire;

use std::collections::{BTreeMap, BTreeSet};

use roughxel_core::design::Design;
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;

pub use error::VerilogError;
pub use fold::{Fault, FoldSummary, Folded, Machine, Slot, UnitSummary};
pub use format::Format;
pub use interface::{Interface, PortDescription};
pub(crate) use interface::{places, total_bits};
pub use manifest::{knobs, sha256};
pub use rom::Rom;
pub use shell::{Access, Register, STREAM_BITS, Shell};
pub use stage::{Stage, StagePort, StageRun, Stages};
pub use text::filled;

use self::body::Body;
use self::context::Context;
use self::manifest::{FileEntry, Manifest, ModuleEntry, frame, names};
use self::module::Module;
use self::share::Group;
use self::wire::Parts;
use super::graph::{Net, NodeId, Op};
use super::interval::Ranges;
use super::target::Target;

/// Options of a written design.
#[derive(Clone, Debug)]
pub struct Options {
    /// Name of the profile.
    pub profile: String,
    /// Its knobs.
    pub precision: Precision,
    /// Effects that are on; effects that the design does not have are ignored.
    pub effects: Effects,
    /// Most levels of logic between two registers, as [`Options::target`] counts them; without it that of the
    /// target, which for gates has registers between stages only.
    pub depth: Option<u32>,
    /// Device for which levels are counted.
    pub target: Target,
    /// Multipliers on which the design is folded; `None` has one for each product and takes a fragment each cycle.
    pub multipliers: Option<u32>,
    /// Paths of the outputs that are ports ([`Net::with_outputs`]); none for all of them.
    pub outputs: Vec<String>,
    /// Bits of the words of an AXI4-Stream shell around the outermost module; `None` writes no shell.
    pub stream: Option<u32>,
    /// Clock in the constraints of the shell, MHz; without it that of the depth ([`Target::clock_mhz`]).
    pub clock: Option<f64>,
    /// Stage whose modules are written, in all its uses (`columns`) or in one (`columns_pixel`), with their submodules; `None` writes the whole
    /// design.
    pub stage: Option<String>,
    /// Prefix of the names of all modules, so that several designs can be in one project.
    pub prefix: String,
}

impl Options {
    /// Every stage, with registers between stages only, in files without a prefix.
    pub fn new(profile: &str, precision: Precision, effects: Effects) -> Self {
        let (profile, prefix) = (profile.to_owned(), String::new());
        Self {
            profile,
            precision,
            effects,
            depth: None,
            target: Target::Asic,
            multipliers: None,
            outputs: Vec::new(),
            stream: None,
            clock: None,
            stage: None,
            prefix,
        }
    }
}

/// A design as Verilog.
#[derive(Clone, Debug)]
pub struct Verilog {
    /// The top; `None` with [`Options::stage`].
    pub top: Option<Interface>,
    /// The probe stepper around the top, if the top is a step.
    pub stepper: Option<Interface>,
    /// The shell around the outermost module, with [`Options::stream`].
    pub shell: Option<Shell>,
    /// Files: path below the directory, and text.
    pub files: BTreeMap<String, String>,
    /// Register bits of the top, of its stages and of delay lines.
    pub register_bits: u32,
    /// Figures of a folded design.
    pub fold: Option<FoldSummary>,
}

/// Name of the top of a design.
pub fn top_name(design: Design) -> String {
    format!("roughxel_{}", design.name())
}

/// Bits of the own wire of every node that somebody reads, all stages taken as one module. They are 0 if other wires or a constant stand for the
/// node, or if nothing is left of it.
pub(crate) fn wire_bits(net: &Net, ranges: &Ranges) -> Vec<u64> {
    let context = Context { net, ranges, depth: None, target: Target::Asic, prefix: "", origin: "" };
    let (ports, nodes): (Vec<_>, Vec<_>) =
        (0..net.nodes.len() as NodeId).partition(|&id| matches!(net.node(id).op, Op::Port(_)));
    let outputs: Vec<_> = net.outputs.iter().map(|output| output.node).collect();
    // Without a target depth no operation is too deep.
    let read = Body::new(context, &nodes, &ports, &outputs).map(|body| body.reads).unwrap_or_default();
    (0..net.nodes.len() as NodeId)
        .map(|id| read.get(&id).map_or(0, |ranks| ranks.values().fold(0, |all, bits| all | bits)))
        .collect()
}

impl Verilog {
    /// Proves and writes a design that was recorded with these options.
    ///
    /// Errors: everything [`VerilogError`] lists.
    pub fn new(design: Design, net: Net, options: &Options) -> Result<Self, VerilogError> {
        let prepared = Prepared::new(net, options)?;
        let own = design.datapath().map_or(Effects::NONE, |datapath| options.effects.restricted_to(datapath));
        let (effects, frame) = (names(&own), frame(&own));
        let origin =
            format!("Design {}, profile {}, effects {effects}, frame {frame}.", design.name(), options.profile);
        let context = prepared.context(options, &origin);
        pipeline::check_blocks(context)?;

        let stage = options.stage.as_deref().map(|stage| stage.replace('.', "_"));
        let name = context.named(&stage.unwrap_or_else(|| top_name(design)));
        let written = match options.multipliers {
            Some(multipliers) => Written::folded(&prepared, context, multipliers, design)?,
            None => Written::flat(&prepared, context, options.stage.as_deref(), design)?,
        };
        let Written { mut verilog, instances, modules, roms } = written;
        let depth = context.depth;
        if let Some((bits, outermost)) = options.stream.zip(verilog.outermost()) {
            let clock = options.clock.unwrap_or_else(|| options.target.clock_mhz(depth));
            let text = &verilog.files[&format!("{}.v", outermost.module)];
            let shell = Shell::new(outermost, verilog.fold.is_none(), text, bits, clock, &origin);
            verilog.files.extend(shell::modules(&shell));
            verilog.files.extend(shell::tool_files(&shell, &verilog.files));
            verilog.shell = Some(shell);
        }
        let manifest = Manifest {
            schema: "roughxel-verilog",
            format_version: 1,
            generator: concat!("roughxel ", env!("CARGO_PKG_VERSION")),
            design: design.name(),
            profile: &options.profile,
            knobs: knobs(&options.precision),
            effects,
            frame,
            depth,
            target: (options.target != Target::Asic).then(|| options.target.name()),
            top: verilog.top.as_ref(),
            stepper: verilog.stepper.as_ref(),
            shell: verilog.shell.as_ref(),
            register_bits: verilog.register_bits,
            fold: verilog.fold.as_ref(),
            instances,
            modules,
            roms: roms.iter().map(|(name, rom)| rom.description(name)).collect(),
            files: verilog.files.iter().map(|(name, text)| FileEntry::new(name, text)).collect(),
        };
        // The manifest has strings and numbers only, which JSON can always express.
        let manifest = serde_json::to_string_pretty(&manifest).unwrap_or_default();
        verilog.files.insert(format!("{name}.json"), manifest + "\n");
        Ok(verilog)
    }

    /// The outermost module without a shell: the stepper or the top.
    pub fn outermost(&self) -> Option<&Interface> {
        self.stepper.as_ref().or(self.top.as_ref())
    }

    /// Module that a testbench of the design drives: through the shell if there is one.
    pub fn driven(&self) -> Option<&Interface> {
        self.shell.as_ref().map(|shell| &shell.driven).or_else(|| self.outermost())
    }

    /// Files, path and text, in the order of writing: the manifest comes after the files that it lists.
    pub fn in_order(&self) -> impl Iterator<Item = (&str, &str)> {
        let (manifests, sources): (Vec<_>, Vec<_>) = self.files.iter().partition(|(name, _)| name.ends_with(".json"));
        sources.into_iter().chain(manifests).map(|(name, text)| (name.as_str(), text.as_str()))
    }
}

impl Folded {
    /// Proves a design that was recorded with these options and folds it on [`Options::multipliers`], or on one.
    ///
    /// Errors: everything [`VerilogError`] lists.
    pub fn from_net(net: Net, options: &Options) -> Result<Self, VerilogError> {
        let prepared = Prepared::new(net, options)?;
        let context = prepared.context(options, "");
        fold::fold(context, &prepared.own_ranges, &prepared.groups, options.multipliers.unwrap_or(1))
    }
}

/// Text of a design before its manifest.
struct Written {
    verilog: Verilog,
    instances: Vec<pipeline::Placed>,
    modules: Vec<ModuleEntry>,
    roms: BTreeMap<String, Rom>,
}

impl Written {
    /// Writes a flat design, or modules of one of its stages.
    fn flat(prepared: &Prepared, context: Context, stage: Option<&str>, design: Design) -> Result<Self, VerilogError> {
        let groups = &prepared.groups;
        let modules = groups.iter().map(|group| prepared.module(context, group)).collect::<Result<Vec<Module>, _>>()?;
        let chosen: Vec<&Module> = prepared.chosen(stage)?.into_iter().map(|index| &modules[index]).collect();
        let mut files = BTreeMap::new();
        let mut parts = Parts::default();
        for module in &chosen {
            files.insert(format!("{}.v", module.name), module.text.clone());
            parts.extend(&module.parts);
        }
        parts.write(&mut files);
        let mut verilog = Verilog { top: None, stepper: None, shell: None, files, register_bits: 0, fold: None };
        let mut instances = Vec::new();
        if stage.is_none() {
            let name = context.named(&top_name(design));
            let top = pipeline::top(context, &name, design.description(), groups, &modules)?;
            verilog.register_bits = top.register_bits;
            let stepper = stepper::stepper(&top.interface, &top.unread, prepared.net.outputs.len(), context);
            verilog.files.insert(format!("{name}.v"), top.text);
            instances = top.instances;
            if top.uses_delay || stepper.is_some() {
                verilog.files.extend([rom::delay(context)]);
            }
            if let Some((interface, text)) = stepper {
                verilog.files.insert(format!("{}.v", interface.module), text);
                verilog.stepper = Some(interface);
            }
            verilog.top = Some(top.interface);
        }
        let modules = chosen.iter().map(|module| ModuleEntry::new(module)).collect();
        Ok(Self { verilog, instances, modules, roms: parts.roms })
    }

    /// Writes a design folded on a number of multipliers.
    fn folded(prepared: &Prepared, context: Context, multipliers: u32, design: Design) -> Result<Self, VerilogError> {
        let (own, groups) = (&prepared.own_ranges, &prepared.groups);
        let folded =
            fold::write(context, own, groups, multipliers, &context.named(&top_name(design)), design.description())?;
        let fold::FoldedVerilog { interface, mut files, modules, parts, register_bits, summary } = folded;
        parts.write(&mut files);
        let (top, fold) = (Some(interface), Some(summary));
        let verilog = Verilog { top, stepper: None, shell: None, files, register_bits, fold };
        let modules = modules.iter().map(ModuleEntry::new).collect();
        Ok(Self { verilog, instances: Vec::new(), modules, roms: parts.roms })
    }
}

/// A recorded and proven design, with the runs of its stages in groups of equal hardware.
struct Prepared {
    net: Net,
    /// Ranges of each node by itself.
    own_ranges: Ranges,
    /// Ranges, one for all nodes that meet in a place of a module.
    ranges: Ranges,
    groups: Vec<Group>,
    /// Nodes that are read outside of their stage.
    outside: BTreeSet<NodeId>,
}

impl Prepared {
    fn new(net: Net, options: &Options) -> Result<Self, VerilogError> {
        let net = net.with_outputs(&options.outputs)?;
        let own_ranges = Ranges::new(&net);
        if !own_ranges.violations.is_empty() {
            return Err(VerilogError::Unproven(own_ranges.violations));
        }
        let groups = share::groups(&net);
        let ranges = share::joined(&net, &own_ranges, &groups);
        let mut outside: BTreeSet<_> = net.outputs.iter().map(|output| output.node).collect();
        for group in &groups {
            outside.extend(group.runs.iter().flat_map(|run| run.inputs.iter().copied()));
        }
        Ok(Self { net, own_ranges, ranges, groups, outside })
    }

    fn context<'a>(&'a self, options: &'a Options, origin: &'a str) -> Context<'a> {
        let Options { target, ref prefix, .. } = *options;
        let default = if options.multipliers.is_some() { Some(target.folded_depth()) } else { target.flat_depth() };
        let context = Context { net: &self.net, ranges: &self.ranges, depth: default, target, prefix, origin };
        // On a device a product has the levels of any depth, so an operation that is deeper than the default is a product by a constant.
        let enough = |depth: u32| if target == Target::Asic { depth } else { depth.max(context.least_depth()) };
        Context { depth: options.depth.or_else(|| default.map(enough)), ..context }
    }

    fn module(&self, context: Context, group: &Group) -> Result<Module, VerilogError> {
        Module::new(context, group, |id| self.outside.contains(&id))
    }

    /// Places of the groups that a name selects: a module, a stage in all its uses or in one. Without a name it is all of them.
    fn chosen(&self, stage: Option<&str>) -> Result<Vec<usize>, VerilogError> {
        let wanted = |group: &Group| {
            stage.is_none_or(|stage| {
                let run = &self.net.runs[group.runs[0].stage as usize];
                [group.name.as_str(), run.base(), run.name].contains(&stage)
            })
        };
        let chosen: Vec<usize> = (0..self.groups.len()).filter(|&index| wanted(&self.groups[index])).collect();
        match stage {
            Some(name) if chosen.is_empty() => {
                let known = self.groups.iter().map(|group| group.name.clone()).collect();
                Err(VerilogError::UnknownStage { name: name.into(), known })
            }
            _ => Ok(chosen),
        }
    }
}
