//! Words of the sets of a stage.

use std::ops::Range;

use super::{SetExport, SetInfo};
use crate::vectors::VectorError;
use crate::vectors::datapath::InputSource;
use crate::vectors::manifest::StageEntry;
use crate::vectors::stage::StageSet;
use crate::vectors::word::Encoder;

impl StageSet {
    /// What the set of a base set holds.
    pub(super) fn description(&self, base: &SetInfo<'_>) -> String {
        let runs: Vec<&str> = self.runs().collect();
        let each = if runs.len() == 1 { String::new() } else { format!(" ({} of each)", runs.join(", ")) };
        format!("ports of {}{each} in the vectors of {}: {}", self.name(), base.name, base.description)
    }

    /// The stage as a manifest says it.
    pub(super) fn entry(&self) -> StageEntry {
        StageEntry { module: self.name().into(), runs: self.runs().map(str::to_owned).collect() }
    }

    /// Writes the words of some vectors to the end of `text`; `words` is room for them.
    pub(super) fn write(
        &self,
        set: &SetExport<'_>,
        vectors: Range<u64>,
        input: &dyn InputSource,
        words: &mut Encoder,
        text: &mut Vec<u8>,
    ) -> Result<(), VectorError> {
        let (runs, fields, info) = (&self.stage.runs, self.layout.fields(), set.info);
        let (mut wires, mut evaluated) = (Vec::new(), None);
        for index in vectors {
            let base = index / runs.len() as u64;
            if evaluated != Some(base) {
                self.net.evaluate(&input.input(base).recorded(&info.precision), &mut wires);
                evaluated = Some(base);
            }
            let run = &runs[(index % runs.len() as u64) as usize];
            let integers = |nodes: &[u32]| -> Vec<i64> { nodes.iter().map(|&node| wires[node as usize]).collect() };
            let bits = self.layout.encode(&integers(&run.inputs), &integers(&run.outputs));
            words.push(&bits.map_err(|field| set.inexact(index, &fields[field]))?, text);
        }
        words.write(text);
        Ok(())
    }
}
