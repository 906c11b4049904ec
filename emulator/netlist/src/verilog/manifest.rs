//! The manifest of a written design.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use roughxel_core::knob::Knob;
use roughxel_core::plan::{Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::precision::{Precision, RoughnessKind};
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::fold::FoldSummary;
use super::interface::Interface;
use super::module::{self, Module};
use super::shell::Shell;
use super::{pipeline, rom};

/// The manifest `NAME.json`.
#[derive(Serialize)]
pub(super) struct Manifest<'a> {
    pub(super) schema: &'static str,
    pub(super) format_version: u32,
    pub(super) generator: &'static str,
    pub(super) design: &'a str,
    pub(super) profile: &'a str,
    /// Knobs by name: a number, or the name of a choice.
    pub(super) knobs: BTreeMap<&'static str, serde_json::Value>,
    pub(super) effects: String,
    pub(super) frame: &'static str,
    pub(super) depth: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) target: Option<&'static str>,
    pub(super) top: Option<&'a Interface>,
    pub(super) stepper: Option<&'a Interface>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) shell: Option<&'a Shell>,
    pub(super) register_bits: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) fold: Option<&'a FoldSummary>,
    pub(super) instances: Vec<pipeline::Placed>,
    pub(super) modules: Vec<ModuleEntry>,
    pub(super) roms: Vec<rom::RomDescription>,
    pub(super) files: Vec<FileEntry>,
}

/// A module in the manifest.
#[derive(Serialize)]
pub(super) struct ModuleEntry {
    name: String,
    /// Cycles from inputs to outcomes; 0 is combinational.
    cycles: u32,
    inputs: Vec<ModulePortEntry>,
    outputs: Vec<ModulePortEntry>,
}

#[derive(Serialize)]
struct ModulePortEntry {
    port: String,
    width: u32,
    signed: bool,
    fraction_bits: u32,
    dropped_zeros: u32,
}

impl ModuleEntry {
    pub(super) fn new(module: &Module) -> Self {
        let ports = |ports: &[module::ModulePort]| {
            let entry = |port: &module::ModulePort| ModulePortEntry {
                port: port.name.clone(),
                width: port.format.width(),
                signed: port.format.signed(),
                fraction_bits: port.format.fraction_bits,
                dropped_zeros: port.format.zeros,
            };
            ports.iter().map(entry).collect()
        };
        let (inputs, outputs) = (ports(&module.inputs), ports(&module.outputs));
        Self { name: module.name.clone(), cycles: module.cuts, inputs, outputs }
    }
}

/// A file in the manifest.
#[derive(Serialize)]
pub(super) struct FileEntry {
    name: String,
    bytes: usize,
    sha256: String,
}

/// Hash of a file as a manifest has it, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut hex, byte| {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

impl FileEntry {
    pub(super) fn new(name: &str, text: &str) -> Self {
        Self { name: name.to_owned(), bytes: text.len(), sha256: sha256(text.as_bytes()) }
    }
}

/// Knobs as profile files name them: a number, or the name of a choice.
pub fn knobs(p: &Precision) -> BTreeMap<&'static str, serde_json::Value> {
    let value = |knob: Knob| {
        let value = knob.value_in(p);
        let text = knob.text(value).to_string();
        if text.parse() == Ok(value) { value.into() } else { text.into() }
    };
    Knob::ALL.into_iter().map(|knob| (knob.name(), value(knob))).collect()
}

/// Effects as `--effects` names them, of those that a design has.
pub(super) fn names(effects: &Effects) -> String {
    let roughness = match effects.roughness {
        RoughnessKind::None => None,
        RoughnessKind::Isotropic => Some("roughness-iso"),
        RoughnessKind::Anisotropic => Some("roughness"),
    };
    let on = |on: bool, name| on.then_some(name);
    let horizon = match effects.horizon {
        HorizonKind::None => None,
        HorizonKind::Correlated => Some("horizon"),
        HorizonKind::Product => Some("horizon-product"),
    };
    let footprint = match effects.footprint {
        FootprintKind::None => None,
        FootprintKind::Face => Some("footprint"),
        FootprintKind::Sphere => Some("footprint-sphere"),
    };
    let rest = [on(effects.curvature, "curvature"), footprint, horizon];
    let names: Vec<&str> = [on(effects.bump, "bump"), roughness].into_iter().chain(rest).flatten().collect();
    if names.is_empty() { "none".to_owned() } else { names.join(",") }
}

/// The frame system as `--frame` names it.
pub(super) const fn frame(effects: &Effects) -> &'static str {
    match effects.frame {
        FrameSystem::MainDirection => "main",
        FrameSystem::Natural => "natural",
        FrameSystem::NaturalNormalised => "natural-normalised",
    }
}
