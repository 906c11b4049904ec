//! The netlist: nodes in the order of their making, so every operand comes before its use.

use std::panic::Location;

use roughxel_core::bundle::Step;
use roughxel_core::rom::upper;
use thiserror::Error;

/// Index of a node in [`Net::nodes`].
pub type NodeId = u32;

/// Set of values that a wire may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// One bit.
    Flag,
    /// Two's complement of this many bits, 16 to 64.
    Wire(u32),
}

impl Kind {
    /// Bits of the wire.
    pub const fn bits(self) -> u32 {
        match self {
            Self::Flag => 1,
            Self::Wire(bits) => bits,
        }
    }

    /// Smallest and largest integer it holds; a flag holds 0 and 1.
    pub const fn limits(self) -> (i64, i64) {
        match self {
            Self::Flag => (0, 1),
            Self::Wire(bits) => (i64::MIN >> (64 - bits), i64::MAX >> (64 - bits)),
        }
    }

    /// Wraps an integer to the wire: keeps its lowest bits. A flag is 0 or 1 already.
    pub const fn cut(self, value: i64) -> i64 {
        match self {
            Self::Flag => value,
            Self::Wire(bits) => value << (64 - bits) >> (64 - bits),
        }
    }
}

/// A table of the datapath as words of some width read it. It is compared by its place in memory: tables are statics.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Entries on 32 bits.
    pub entries: &'static [i32],
    /// Bits of the words.
    pub bits: u32,
}

impl Table {
    /// Entry on a word; `None` outside.
    pub fn entry(&self, index: usize) -> Option<i32> {
        self.entries.get(index).map(|&entry| upper(entry, self.bits))
    }

    /// Every entry on a word.
    pub fn on_words(&self) -> impl ExactSizeIterator<Item = i32> + DoubleEndedIterator + Clone {
        let bits = self.bits;
        self.entries.iter().map(move |&entry| upper(entry, bits))
    }
}

impl PartialEq for Table {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.entries, other.entries) && self.bits == other.bits
    }
}

impl Eq for Table {}

impl std::hash::Hash for Table {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.entries.as_ptr().hash(state);
    }
}

/// One operation of the algebra on earlier nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Input port number.
    Port(u32),
    /// Constant.
    Lit(i64),
    /// a + b.
    Add(NodeId, NodeId),
    /// a − b.
    Sub(NodeId, NodeId),
    /// a · b of two words, wide.
    Mul(NodeId, NodeId),
    /// a · 2^k.
    Shl(NodeId, u32),
    /// ⌊a / 2^k⌋.
    Sar(NodeId, u32),
    /// a · 2^count.
    ShlBy(NodeId, NodeId),
    /// ⌊a / 2^count⌋.
    SarBy(NodeId, NodeId),
    /// Bitwise and, also of flags.
    And(NodeId, NodeId),
    /// Bitwise or, also of flags.
    Or(NodeId, NodeId),
    /// Bitwise exclusive or.
    Xor(NodeId, NodeId),
    /// Not of a flag.
    Not(NodeId),
    /// a < b, signed; a flag.
    Lt(NodeId, NodeId),
    /// Flag, value if it is set, value if it is clear.
    Select(NodeId, NodeId, NodeId),
    /// Leading zero bits of a wire as wide as the operand's kind; a word.
    LeadingZeros(NodeId),
    /// A word as a wide wire.
    Widen(NodeId),
    /// A wide wire as a word.
    Narrow(NodeId),
    /// Entry of a table.
    Lookup(NodeId, Table),
    /// The operand, claimed to be in low ..= high by a lemma.
    Claim {
        /// The operand.
        of: NodeId,
        /// Smallest value.
        low: i64,
        /// Largest value.
        high: i64,
        /// Name of the lemma, a test of `host-tests`.
        lemma: &'static str,
    },
}

impl Op {
    /// Operands, in order.
    pub fn operands(&self) -> impl Iterator<Item = NodeId> {
        let (mut list, mut count) = ([0; 3], 0);
        self.map(|operand| {
            list[count] = operand;
            count += 1;
            operand
        });
        list.into_iter().take(count)
    }

    /// Replaces the operands.
    pub fn map(self, mut to: impl FnMut(NodeId) -> NodeId) -> Self {
        match self {
            Self::Port(_) | Self::Lit(_) => self,
            Self::Add(a, b) => Self::Add(to(a), to(b)),
            Self::Sub(a, b) => Self::Sub(to(a), to(b)),
            Self::Mul(a, b) => Self::Mul(to(a), to(b)),
            Self::Shl(a, k) => Self::Shl(to(a), k),
            Self::Sar(a, k) => Self::Sar(to(a), k),
            Self::ShlBy(a, b) => Self::ShlBy(to(a), to(b)),
            Self::SarBy(a, b) => Self::SarBy(to(a), to(b)),
            Self::And(a, b) => Self::And(to(a), to(b)),
            Self::Or(a, b) => Self::Or(to(a), to(b)),
            Self::Xor(a, b) => Self::Xor(to(a), to(b)),
            Self::Not(a) => Self::Not(to(a)),
            Self::Lt(a, b) => Self::Lt(to(a), to(b)),
            Self::Select(flag, a, b) => Self::Select(to(flag), to(a), to(b)),
            Self::LeadingZeros(a) => Self::LeadingZeros(to(a)),
            Self::Widen(a) => Self::Widen(to(a)),
            Self::Narrow(a) => Self::Narrow(to(a)),
            Self::Lookup(a, table) => Self::Lookup(to(a), table),
            Self::Claim { of, low, high, lemma } => Self::Claim { of: to(of), low, high, lemma },
        }
    }

    /// Name as in the traits of the algebra.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Port(_) => "port",
            Self::Lit(_) => "lit",
            Self::Add(..) => "add",
            Self::Sub(..) => "sub",
            Self::Mul(..) => "mul",
            Self::Shl(..) => "shl",
            Self::Sar(..) => "sar",
            Self::ShlBy(..) => "shl_by",
            Self::SarBy(..) => "sar_by",
            Self::And(..) => "and",
            Self::Or(..) => "or",
            Self::Xor(..) => "xor",
            Self::Not(_) => "not",
            Self::Lt(..) => "lt",
            Self::Select(..) => "select",
            Self::LeadingZeros(_) => "leading_zeros",
            Self::Widen(_) => "widen",
            Self::Narrow(_) => "narrow",
            Self::Lookup(..) => "lookup",
            Self::Claim { .. } => "claim",
        }
    }
}

/// A wire and the operation that drives it.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Operation.
    pub op: Op,
    /// Kind of the wire.
    pub kind: Kind,
    /// Index in [`Net::runs`] of the stage that made it; constants and ports belong to none.
    pub stage: Option<u32>,
    /// Number of the compound step that made it, of those that hardware may share ([`super::builder::part`]); `None` for any other operation.
    pub part: Option<u32>,
    /// Line of the source that makes it.
    pub at: &'static Location<'static>,
}

/// One run of a stage of the datapath; runs are in the order of execution.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Run {
    /// Name as the composer gives it: the stage, then after a dot what it is used for (`columns.pixel`).
    pub name: &'static str,
    /// Number among the runs of that name, from 0.
    pub run: u32,
    /// True if the name runs more than once.
    pub repeated: bool,
}

impl Run {
    /// Hardware stage: the name up to the first dot.
    pub fn base(&self) -> &'static str {
        self.name.split('.').next().unwrap_or(self.name)
    }

    /// Name unique in the net: `columns_pixel_1`.
    pub fn instance(&self) -> String {
        let name = self.name.replace('.', "_");
        if self.repeated { format!("{name}_{}", self.run) } else { name }
    }
}

/// An input port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Path in the bundle: `surface.normal.mantissa[0]`.
    pub name: String,
    /// Steps of the path, with the declarations of its fields.
    pub path: Vec<Step>,
    /// Kind of its wire.
    pub kind: Kind,
    /// True if it carries a mantissa, of which a profile keeps some bits.
    pub mantissa: bool,
    /// Binary point; 0 for a flag.
    pub fraction_bits: u32,
    /// Smallest declared value.
    pub low: i64,
    /// Largest declared value.
    pub high: i64,
    /// Low bits that are always zero.
    pub zeros: u32,
    /// Node of the port.
    pub node: NodeId,
}

/// A named wire: an outcome of a stage (`stage` given) or of the whole design.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tap {
    /// Stage whose outcome it is.
    pub stage: Option<u32>,
    /// Path in the bundle: `r.m[0]`.
    pub name: String,
    /// Steps of the path, with the declarations of its fields.
    pub path: Vec<Step>,
    /// True if it carries a mantissa, of which a profile keeps some bits.
    pub mantissa: bool,
    /// Binary point; 0 for a flag.
    pub fraction_bits: u32,
    /// Node of the wire.
    pub node: NodeId,
}

impl Tap {
    /// Name of an output; `result` if it is the only one and has no path.
    pub fn output_name(&self) -> &str {
        if self.name.is_empty() { "result" } else { &self.name }
    }
}

/// A path that leads to no output of a design.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("no output is `{path}` or begins with it; they are {}", .known.join(", "))]
pub struct UnknownOutput {
    /// Requested path.
    pub path: String,
    /// First fields of the outputs of the design.
    pub known: Vec<String>,
}

/// A recorded design.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// Every wire; operands come before their users.
    pub nodes: Vec<Node>,
    /// Every run of a stage.
    pub runs: Vec<Run>,
    /// Inputs in the order of their bundle.
    pub ports: Vec<Port>,
    /// Outcomes of stages in the order of execution.
    pub taps: Vec<Tap>,
    /// Outputs in the order of their bundle.
    pub outputs: Vec<Tap>,
    /// Lowest and highest integer that each output is declared to hold. The recording of a design fills them (`emulator/record`).
    pub limits: Vec<(i64, i64)>,
}

impl Net {
    /// Node by its number.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id as usize]
    }

    /// Nodes with their numbers.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = (NodeId, &Node)> {
        (0..).zip(&self.nodes).collect::<Vec<_>>().into_iter()
    }

    /// Stage and path of a tap: `frame.e1.m[0]`, or `blend` if the outcome is a single wire.
    pub fn tap_name(&self, tap: &Tap) -> String {
        let Some(stage) = tap.stage else { return tap.name.clone() };
        let point = if tap.name.is_empty() || tap.name.starts_with('[') { "" } else { "." };
        format!("{}{point}{}", self.runs[stage as usize].instance(), tap.name)
    }

    /// Origin of a node: `core/src/stage.rs:84 in columns_pixel_0`.
    pub fn origin(&self, id: NodeId) -> String {
        let node = self.node(id);
        let line = format!("{}:{}", node.at.file(), node.at.line());
        match node.stage {
            Some(stage) => format!("{line} in {}", self.runs[stage as usize].instance()),
            None => line,
        }
    }

    /// Flag for each port, true if an operation or an output reads it. Effects that are off leave ports unread.
    pub fn ports_read(&self) -> Vec<bool> {
        let mut read = vec![false; self.nodes.len()];
        let operands = self.nodes.iter().flat_map(|node| node.op.operands());
        for node in operands.chain(self.outputs.iter().map(|output| output.node)) {
            read[node as usize] = true;
        }
        self.ports.iter().map(|port| read[port.node as usize]).collect()
    }

    /// Integer of an output that is constant whatever the ports hold, as far as folding shows.
    pub fn constant(&self, output: &Tap) -> Option<i64> {
        match self.node(output.node).op {
            Op::Lit(value) => Some(value),
            _ => None,
        }
    }

    /// Keeps the outputs that one of these paths leads to: `probes` is `probes.count`, `probes.step[0]` and so on. Without paths it keeps all.
    /// An output that is not kept is the constant 0, which has no port, so its place stays. What only it needs goes.
    ///
    /// Errors: a path that leads to no output.
    pub fn with_outputs(mut self, paths: &[String]) -> Result<Self, UnknownOutput> {
        if paths.is_empty() {
            return Ok(self);
        }
        let leads_to = |path: &str, output: &Tap| {
            let rest = output.output_name().strip_prefix(path);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        if let Some(path) = paths.iter().find(|path| !self.outputs.iter().any(|output| leads_to(path, output))) {
            let first = |output: &Tap| {
                let name = output.output_name();
                let end = name.char_indices().skip(1).find(|(_, letter)| ".[".contains(*letter));
                name[..end.map_or(name.len(), |(end, _)| end)].to_owned()
            };
            let mut known: Vec<String> = self.outputs.iter().map(first).collect();
            known.dedup();
            return Err(UnknownOutput { path: path.clone(), known });
        }
        for output in &mut self.outputs {
            if !paths.iter().any(|path| leads_to(path, output)) {
                let node = Node { op: Op::Lit(0), stage: None, part: None, ..self.nodes[output.node as usize] };
                output.node = self.nodes.len() as NodeId;
                self.nodes.push(node);
            }
        }
        Ok(self.without_dead_wires())
    }

    /// Drops every node that no output needs, taps of dropped nodes, and runs of stages that have nothing left. Ports stay.
    pub fn without_dead_wires(self) -> Self {
        let mut alive = vec![false; self.nodes.len()];
        for port in &self.ports {
            alive[port.node as usize] = true;
        }
        for output in &self.outputs {
            alive[output.node as usize] = true;
        }
        for id in (0..self.nodes.len()).rev() {
            if alive[id] {
                for operand in self.nodes[id].op.operands() {
                    alive[operand as usize] = true;
                }
            }
        }
        let mut place = vec![NodeId::MAX; self.nodes.len()];
        let mut nodes = Vec::new();
        for (id, node) in self.nodes.into_iter().enumerate() {
            if alive[id] {
                place[id] = nodes.len() as NodeId;
                nodes.push(Node { op: node.op.map(|operand| place[operand as usize]), ..node });
            }
        }
        let mut taps: Vec<Tap> = self.taps.into_iter().filter(|tap| alive[tap.node as usize]).collect();
        let mut used = vec![false; self.runs.len()];
        for stage in nodes.iter().filter_map(|node| node.stage).chain(taps.iter().filter_map(|tap| tap.stage)) {
            used[stage as usize] = true;
        }
        let mut runs = Vec::new();
        let mut run_place = Vec::new();
        for (run, used) in self.runs.into_iter().zip(used) {
            run_place.push(runs.len() as u32);
            if used {
                runs.push(run);
            }
        }
        for stage in nodes.iter_mut().map(|node| &mut node.stage).chain(taps.iter_mut().map(|tap| &mut tap.stage)) {
            *stage = stage.map(|stage| run_place[stage as usize]);
        }
        let moved = |tap: Tap| Tap { node: place[tap.node as usize], ..tap };
        Self {
            nodes,
            runs,
            ports: self.ports.into_iter().map(|port| Port { node: place[port.node as usize], ..port }).collect(),
            taps: taps.into_iter().map(moved).collect(),
            outputs: self.outputs.into_iter().map(moved).collect(),
            limits: self.limits,
        }
    }
}
