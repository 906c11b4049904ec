//! Outcomes: the netlist of a set, and the wires that are fields of a word.

use std::borrow::Cow;

use roughxel_core::design::Design;
use roughxel_netlist::graph::{Net, NodeId};
use roughxel_record as record;

use super::datapath::Inputs;
use super::field::{Direction, Field, mask};
use super::layout::Layout;
use super::manifest::Manifest;

/// The design of a set with its outcomes, in the order of the pipeline.
pub(super) struct Outcomes<'a> {
    manifest: &'a Manifest,
    pub(super) layout: &'a Layout,
    pub(super) net: Cow<'a, Net>,
    pub(super) list: Vec<Outcome>,
}

/// A field that is an outcome.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome {
    /// Place of the field in the word.
    pub(super) field: usize,
    /// The wire.
    pub(super) node: NodeId,
    /// Number of its low bits that drop.
    pub(super) drop: u32,
}

impl<'a> Outcomes<'a> {
    pub(super) fn new(manifest: &'a Manifest, layout: &'a Layout) -> Self {
        let outcome = |(field, node, drop)| Outcome { field, node, drop };
        let (net, mut list): (_, Vec<Outcome>) = match layout.stage() {
            Some(stage) => {
                let net = &stage.unit;
                let list = layout.places().map(|(field, place, drop)| outcome((field, net.outputs[place].node, drop)));
                (Cow::Borrowed(net), list.collect())
            }
            None => {
                let knobs = &manifest.profile.knobs;
                let net = record::net(Design::for_datapath(manifest.datapath), &manifest.effects, knobs);
                let list = layout.outcomes(&net, knobs).map(outcome).collect();
                (Cow::Owned(net), list)
            }
        };
        list.sort_by_key(|outcome| layout.rank(outcome.field));
        Self { manifest, layout, net, list }
    }

    /// The wires of the outcomes.
    pub(super) fn nodes(&self) -> Vec<NodeId> {
        self.list.iter().map(|outcome| outcome.node).collect()
    }

    /// The wires of the outcomes with the bits of each that its field shows.
    pub(super) fn shown(&self) -> Vec<(NodeId, u64)> {
        let bits = |outcome: &Outcome| u64::from(mask(self.field(*outcome).width)) << outcome.drop;
        self.list.iter().map(|outcome| (outcome.node, bits(outcome))).collect()
    }

    /// The integers of the design's ports in the bits of a word.
    pub(super) fn ports(&self, bits: &[u32]) -> Vec<i64> {
        let inputs = self.layout.decode(bits);
        match self.layout.stage() {
            Some(_) => inputs,
            None => Inputs::from_integers(self.manifest.datapath, &inputs).recorded(&self.manifest.profile.knobs),
        }
    }

    /// The field of an outcome.
    pub(super) fn field(&self, outcome: Outcome) -> &Field {
        &self.layout.fields()[outcome.field]
    }

    /// The path of an outcome, and that of its exponent if it is a mantissa.
    pub(super) fn path(&self, outcome: Outcome) -> (&str, Option<String>) {
        let field = self.field(outcome);
        let (path, [mantissa, exponent]) = match self.layout.stage() {
            None => (&field.port, [".mantissa[", ".exponent"]),
            Some(stage) => {
                let port = stage.outputs.iter().find(|port| port.name == field.name);
                (port.map_or(&field.port, |port| &port.wire), [".m[", ".e"])
            }
        };
        (path, path.rsplit_once(mantissa).map(|(block, _)| format!("{block}{exponent}")))
    }

    /// The first input field that differs.
    pub(super) fn other_input(&self, expected: &[u32], found: &[u32]) -> Option<usize> {
        let is_input = |place: &usize| self.layout.fields()[*place].direction == Direction::In;
        (0..expected.len()).filter(is_input).find(|&place| expected[place] != found[place])
    }
}

impl Outcome {
    /// The field's bits of a wire's integer.
    pub(super) fn bits(self, field: &Field, value: i64) -> u32 {
        (value >> self.drop) as u32 & mask(field.width)
    }
}
