//! Sets of one stage: the ports of its Verilog module are the fields, each run of the module a vector.
//!
//! The module is the one that `roughxel verilog --stage` writes for the same datapath, effects and profile. The integers on its
//! ports are those of the netlist for the inputs of a base set, so the inputs of a stage are values that the stages before it
//! produce. The outputs of a word are computed by the operations of the stage alone.

use std::sync::Arc;

use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_netlist::graph::Net;
use roughxel_netlist::verilog::{Options, Stage, Stages, VerilogError};
use roughxel_record as record;

use super::layout::Layout;

/// The module of a stage, whose ports are the fields of a set.
#[derive(Clone, Debug)]
pub struct StageSet {
    /// The whole datapath.
    pub(super) net: Arc<Net>,
    pub(super) stage: Stage,
    pub(super) layout: Layout,
}

impl StageSet {
    /// The modules of a datapath that `name` names: one by its name (`columns_pixel`) or all of a stage (`columns`); every module
    /// without a name.
    ///
    /// Errors: those of the Verilog; an unknown name, with the known ones; a port that no field holds.
    pub fn select(
        datapath: Datapath,
        effects: &Effects,
        p: &Precision,
        name: Option<&str>,
    ) -> Result<Vec<Self>, VerilogError> {
        let options = Options { stage: name.map(str::to_owned), ..Options::new("", *p, *effects) };
        let Stages { net, stages } = record::stages(Design::for_datapath(datapath), &options)?;
        let net = Arc::new(net);
        let set = |stage: Stage| Ok(Self { net: Arc::clone(&net), layout: Layout::of_stage(&stage)?, stage });
        stages.into_iter().map(set).collect()
    }

    /// Name of the module.
    pub fn name(&self) -> &str {
        &self.stage.name
    }

    /// The runs of the module in order; a base vector gives a vector for each.
    pub fn runs(&self) -> impl ExactSizeIterator<Item = &str> {
        self.stage.runs.iter().map(|run| run.instance.as_str())
    }
}

/// The layout of the set of a module with these runs, or the reason why this version has none.
pub(super) fn layout(
    datapath: Datapath,
    effects: &Effects,
    p: &Precision,
    module: &str,
    runs: &[String],
) -> Result<Layout, String> {
    let sets = StageSet::select(datapath, effects, p, Some(module));
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
