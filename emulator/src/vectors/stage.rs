//! Sets of one stage: the ports of its Verilog module are the fields, each run of the module a vector.
//!
//! The module is the one that `roughxel verilog --stage` writes for the same datapath, effects and profile. The integers on its ports are
//! those that the recorded datapath has there for the inputs of a base set, so inputs of a stage are such as the stages before it make.
//! What belongs to the inputs of a word is computed by the operations of the stage alone.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;

use super::VectorError;
use super::datapath::Inputs;
use super::export::{SetExport, SetInfo, append_word};
use super::layout::Layout;
use super::manifest::{Manifest, StageEntry};
use crate::net::graph::Net;
use crate::net::record::integers_at;
use crate::net::verilog::{Options, Stage, Stages, VerilogError};

/// The module of a stage, whose ports are the fields of a set.
#[derive(Clone, Debug)]
pub struct StageSet {
    /// The whole datapath.
    net: Arc<Net>,
    stage: Stage,
    layout: Layout,
}

impl StageSet {
    /// The modules of a datapath that `name` names, one by its name (`columns_pixel`) or all of a stage (`columns`); without a name every one.
    ///
    /// Errors: those of the Verilog, an unknown name with those that there are among them; a port that no field holds.
    pub fn of(
        datapath: Datapath,
        effects: &Effects,
        p: &Precision,
        name: Option<&str>,
    ) -> Result<Vec<Self>, VerilogError> {
        let options = Options {
            profile: String::new(),
            precision: *p,
            effects: *effects,
            depth: None,
            stage: name.map(str::to_owned),
            prefix: String::new(),
        };
        let Stages { net, stages } = Stages::new(Design::of(datapath), &options)?;
        let net = Arc::new(net);
        let set = |stage: Stage| Ok(Self { net: Arc::clone(&net), layout: Layout::of_stage(&stage)?, stage });
        stages.into_iter().map(set).collect()
    }

    /// Name of the module.
    pub fn name(&self) -> &str {
        &self.stage.name
    }

    /// The runs of the module, of each of which a base vector gives a vector, in this order.
    pub fn runs(&self) -> impl ExactSizeIterator<Item = &str> {
        self.stage.runs.iter().map(|run| run.instance.as_str())
    }

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
                self.net.evaluate(&ports(&input(base), &info.precision), &mut wires);
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

/// The layout of the set of a stage that a manifest describes, or why this version has none.
pub(super) fn layout(manifest: &Manifest, entry: &StageEntry) -> Result<Layout, String> {
    let StageEntry { module, runs } = entry;
    let sets = StageSet::of(manifest.datapath, &manifest.effects, &manifest.profile.knobs, Some(module));
    let sets = sets.map_err(|error| format!("stage `{module}`: {error}"))?;
    let set = sets.into_iter().find(|set| set.name() == module);
    let set = set.ok_or_else(|| format!("stage `{module}` is no module in this version; export the set again"))?;
    if !set.runs().eq(runs.iter()) {
        let ours: Vec<&str> = set.runs().collect();
        return Err(format!(
            "the runs of stage `{module}` are {} in this version, but the set has {}; export the set again",
            ours.join(", "),
            runs.join(", ")
        ));
    }
    Ok(set.layout)
}

/// The integers on the ports of a design.
fn ports(inputs: &Inputs, p: &Precision) -> Vec<i64> {
    match inputs {
        Inputs::Reflection(wires) => integers_at(wires, p),
        Inputs::Highlight(wires) => integers_at(wires, p),
        Inputs::Peak(wires) => integers_at(wires, p),
    }
}
