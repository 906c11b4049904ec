//! Export of the sets of a stage.

use std::ops::Range;
use std::path::Path;

use super::{SetExport, SetInfo, append_word};
use crate::vectors::VectorError;
use crate::vectors::datapath::Inputs;
use crate::vectors::manifest::{Manifest, StageEntry};
use crate::vectors::stage::StageSet;

impl StageSet {
    /// Exports the set of the stage that belongs to the base set of `info`, whose vectors are `input(0) … input(count − 1)`: vector i is
    /// run i mod R of base vector ⌊i / R⌋ where the module has R runs. `progress` is told how many vectors are done.
    ///
    /// The name is `BASE_MODULE`, datapath, effects and profile are those of the base set, and there are no taps.
    ///
    /// Errors: see [`VectorError`]; nothing half-written stays, and no manifest without its words.
    pub fn export(
        &self,
        info: &SetInfo<'_>,
        count: u64,
        input: &(dyn Fn(u64) -> Inputs + Sync),
        directory: &Path,
        progress: &dyn Fn(u64),
    ) -> Result<Manifest, VectorError> {
        let name = format!("{}_{}", info.name, self.name());
        let runs: Vec<String> = self.runs().map(str::to_owned).collect();
        let each = if runs.len() == 1 { String::new() } else { format!(" ({} of each)", runs.join(", ")) };
        let description =
            format!("ports of {}{each} in the vectors of {}: {}", self.name(), info.name, info.description);
        let total = count.saturating_mul(runs.len() as u64);
        let info = SetInfo { name: &name, description: &description, ..*info };
        let entry = StageEntry { module: self.name().into(), runs };
        let words = |vectors| self.written(&info, vectors, input);
        SetExport::of_stage(&info, total, self.layout.clone(), entry).write_words(&words, directory, progress)
    }

    /// The words of some vectors as they are written.
    fn written(
        &self,
        info: &SetInfo<'_>,
        vectors: Range<u64>,
        input: &(dyn Fn(u64) -> Inputs + Sync),
    ) -> Result<Vec<u8>, VectorError> {
        let (runs, fields) = (&self.stage.runs, self.layout.fields());
        let mut text = Vec::with_capacity((vectors.end - vectors.start) as usize * (self.layout.line_length() + 1));
        let (mut wires, mut packed, mut evaluated) = (Vec::new(), Vec::new(), None);
        for index in vectors {
            let base = index / runs.len() as u64;
            if evaluated != Some(base) {
                self.net.evaluate(&input(base).recorded(&info.precision), &mut wires);
                evaluated = Some(base);
            }
            let run = &runs[(index % runs.len() as u64) as usize];
            let integers = |nodes: &[u32]| -> Vec<i64> { nodes.iter().map(|&node| wires[node as usize]).collect() };
            let bits = self.layout.encode(&integers(&run.inputs), &integers(&run.outputs));
            let mut bits = bits.map_err(|field| VectorError::Inexact {
                set: info.name.into(),
                index,
                field: fields[field].name.clone(),
            })?;
            append_word(&mut text, &self.layout, &mut bits, &mut packed, info.words.form);
        }
        Ok(text)
    }
}
