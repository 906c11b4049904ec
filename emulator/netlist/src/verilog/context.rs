//! Common data of the modules of a design: the net, its ranges, names and comments.

use std::collections::BTreeSet;
use std::path::Path;

use super::format::Format;
use super::text::identifier;
use crate::graph::{Kind, Net, NodeId, Op};
use crate::interval::Ranges;
use crate::target::Target;

/// Data that all modules of a design share.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(super) net: &'a Net,
    /// Ranges, one for all nodes that meet in a place of a module.
    pub(super) ranges: &'a Ranges,
    /// Most levels between registers.
    pub(super) depth: Option<u32>,
    /// Device that says what a level is.
    pub(super) target: Target,
    /// Prefix of module names.
    pub(super) prefix: &'a str,
    /// Lines at the end of every header: profile, stages that are on.
    pub(super) origin: &'a str,
}

impl Context<'_> {
    /// Name of a module with the prefix.
    pub(super) fn named(&self, name: &str) -> String {
        format!("{}{name}", self.prefix)
    }

    /// Levels of an operation.
    pub(super) fn levels(&self, id: NodeId) -> u32 {
        let unit = self.net.node(id).op.unit(self.ranges, id);
        self.target.levels(unit, self.depth.unwrap_or(0))
    }

    /// True if a clock edge is between the operands of an operation and its outcome.
    pub(super) fn is_clocked(&self, id: NodeId) -> bool {
        self.target.is_clocked(self.net.node(id).op.unit(self.ranges, id))
    }

    /// Least depth at which no operation is too deep.
    pub(super) fn least_depth(&self) -> u32 {
        let all = 0..self.net.nodes.len() as NodeId;
        all.map(|id| self.levels(id)).max().unwrap_or(0)
    }

    /// Path of a port or of a tap of a node's own stage, and its binary point.
    pub(super) fn path_of(&self, id: NodeId) -> Option<(&str, u32)> {
        let node = self.net.node(id);
        if let Op::Port(port) = node.op {
            let port = &self.net.ports[port as usize];
            return Some((&port.name, port.fraction_bits));
        }
        let tap = self.net.taps.iter().find(|tap| tap.node == id && tap.stage == node.stage)?;
        Some((&tap.name, tap.fraction_bits))
    }

    /// The format in which a node travels between stages.
    pub(super) fn format(&self, id: NodeId) -> Format {
        let fraction_bits = self.path_of(id).map_or(0, |(_, fraction_bits)| fraction_bits);
        Format::new(self.ranges.of(id), fraction_bits, self.net.node(id).kind == Kind::Flag)
    }

    /// Source line of a node; `None` if an iterator of the library, outside the project, made it.
    pub(super) fn line(&self, id: NodeId) -> Option<String> {
        let at = self.net.node(id).at;
        Path::new(at.file()).is_relative().then(|| format!("{}:{}", at.file(), at.line()))
    }

    /// Comment on a named node: path, range, source line.
    pub(super) fn about(&self, id: NodeId, path: &str) -> String {
        let line = self.line(id).map_or_else(String::new, |line| format!("; {line}"));
        format!("{path}: {}{line}", self.format(id).describe())
    }

    /// Name of a node between stages: `enter_dview_0_m_0`, or without the number of the run.
    pub(super) fn signal(&self, id: NodeId, with_run: bool) -> String {
        let path = identifier(self.path_of(id).map_or("", |(path, _)| path));
        match self.net.node(id).stage {
            None if path.is_empty() => "value".into(),
            None => path,
            Some(stage) => {
                let stage = &self.net.runs[stage as usize];
                let stage = if with_run { stage.instance() } else { stage.name.replace('.', "_") };
                if path.is_empty() { stage } else { format!("{stage}_{path}") }
            }
        }
    }
}

/// Names that are taken in a module.
#[derive(Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// Returns the name, with a number if it is taken.
    pub(super) fn take(&mut self, name: &str) -> String {
        let mut candidate = name.to_owned();
        let mut number = 2;
        while !self.0.insert(candidate.clone()) {
            candidate = format!("{name}_{number}");
            number += 1;
        }
        candidate
    }
}
