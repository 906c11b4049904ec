//! Words of the sets of a stage.

use std::ops::Range;

use super::{SetExport, SetInfo};
use crate::VectorError;
use crate::datapath::InputSource;
use crate::manifest::StageEntry;
use crate::stage::StageSet;
use crate::word::{CHUNK, Encoder};

impl StageSet {
    /// Description of the stage's set for a base set.
    pub(super) fn description(&self, base: &SetInfo<'_>) -> String {
        let runs: Vec<&str> = self.runs().collect();
        let each = if runs.len() == 1 { String::new() } else { format!(" ({} of each)", runs.join(", ")) };
        format!("ports of {}{each} in the vectors of {}: {}", self.name(), base.name, base.description)
    }

    /// The stage's entry in a manifest.
    pub(super) fn entry(&self) -> StageEntry {
        StageEntry { module: self.name().into(), runs: self.runs().map(str::to_owned).collect() }
    }

    /// Writes the words of some vectors over `text`, which has their length; `words` is a buffer.
    pub(super) fn write(
        &self,
        set: &SetExport<'_>,
        vectors: Range<u64>,
        input: &dyn InputSource,
        words: &mut Encoder,
        mut text: &mut [u8],
    ) -> Result<(), VectorError> {
        let (runs, fields, info) = (&self.stage.runs, self.layout.fields(), set.info);
        let (mut wires, mut evaluated) = (Vec::new(), None);
        for first in vectors.clone().step_by(CHUNK) {
            for index in first..vectors.end.min(first + CHUNK as u64) {
                let base = index / runs.len() as u64;
                if evaluated != Some(base) {
                    self.net.evaluate(&input.input(base).recorded(&info.precision), &mut wires);
                    evaluated = Some(base);
                }
                let run = &runs[(index % runs.len() as u64) as usize];
                let integers = |nodes: &[u32]| -> Vec<i64> { nodes.iter().map(|&node| wires[node as usize]).collect() };
                let bits = self.layout.encode(&integers(&run.inputs), &integers(&run.outputs));
                words.push(&bits.map_err(|field| set.inexact(index, &fields[field]))?);
            }
            text = words.write(text);
        }
        Ok(())
    }
}
