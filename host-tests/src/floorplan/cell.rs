//! Cells of the floor plan: a generated design and its text.

use std::collections::BTreeMap;
use std::fmt;

use roughxel_core::design::Design;
use roughxel_core::plan::{Effects, FootprintKind};
use roughxel_core::precision::{Profile, RoughnessKind};
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{Interface, Options, PortDescription, Verilog};
use roughxel_record as record;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Effects of a reflection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Plan {
    /// No effects: s, t and the face of a mirror.
    Mirror,
    /// Footprints of smooth texels, with bumps and curvature.
    Footprint,
    /// Every effect.
    All,
}

impl Plan {
    /// Every plan.
    pub const ALL: [Self; 3] = [Self::Mirror, Self::Footprint, Self::All];

    /// Name in options and results.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mirror => "mirror",
            Self::Footprint => "footprint",
            Self::All => "all",
        }
    }

    /// Effects of the plan.
    pub const fn effects(self) -> Effects {
        match self {
            Self::Mirror => Effects { footprint: FootprintKind::None, ..Effects::NONE },
            Self::Footprint => Effects { roughness: RoughnessKind::None, ..Effects::ALL },
            Self::All => Effects::ALL,
        }
    }
}

/// A generated design.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Name of the profile.
    pub profile: String,
    /// Effects.
    pub plan: Plan,
    /// Multipliers on which the design is folded; `None` is the flat design.
    pub multipliers: Option<u32>,
    /// Device family.
    pub target: Target,
}

/// `narrow-mirror-2-ecp5`, the key of the cell in the results.
impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}-{}-{}", self.profile, self.plan.name(), units(self.multipliers), self.target.name())
    }
}

/// Number of multipliers as text, `flat` for a multiplier for each product.
pub fn units(multipliers: Option<u32>) -> String {
    multipliers.map_or_else(|| "flat".to_owned(), |count| count.to_string())
}

/// Generated text of a cell.
#[derive(Clone, Debug)]
pub struct Text {
    /// Verilog files by name.
    pub files: BTreeMap<String, String>,
    /// The design without its shell.
    pub interface: Interface,
    /// Cycles from a fragment to the next.
    pub interval: u32,
    /// Hash of the files.
    pub hash: String,
}

impl Text {
    /// Name of the AXI4-Stream shell.
    pub fn shell(&self) -> String {
        format!("{}_axis", self.interface.module)
    }

    /// Words of a stream for a fragment, and for its outcome.
    pub fn words(&self, stream: u32) -> [u32; 2] {
        let bits = |ports: &[PortDescription]| ports.iter().map(|port| port.width).sum::<u32>();
        [bits(&self.interface.inputs), bits(&self.interface.outputs)].map(|bits| bits.div_ceil(stream))
    }
}

impl Cell {
    /// Paths of the outcome that the next design of a device reads: the footprint for its probes, and the status.
    const OUTPUTS: [&str; 6] = ["point.select", "point.st", "probes.count", "probes.step", "probes.lod", "status"];

    /// Options of the generator, with an AXI4-Stream shell if there is a width.
    ///
    /// Errors: the profile has no such name.
    pub fn options(&self, stream: Option<u32>) -> Result<Options, String> {
        let precision = Profile::by_name(&self.profile).map(Profile::precision);
        let precision = precision
            .ok_or_else(|| format!("profile `{}` is unknown; there are {}", self.profile, Profile::NAMES.join(", ")))?;
        let Self { multipliers, target, .. } = *self;
        let outputs = Self::OUTPUTS.map(str::to_owned).to_vec();
        Ok(Options {
            target,
            multipliers,
            outputs,
            stream,
            ..Options::new(&self.profile, precision, self.plan.effects())
        })
    }

    /// Generates the Verilog.
    ///
    /// Errors: the profile has no such name, or the generator refuses the design.
    pub fn text(&self, stream: Option<u32>) -> Result<Text, String> {
        let verilog =
            record::verilog(Design::Reflection, &self.options(stream)?).map_err(|e| format!("{self}: {e}"))?;
        let Verilog { top, mut files, fold, .. } = verilog;
        let interface = top.ok_or_else(|| format!("{self}: the generator wrote no top"))?;
        // The module for testbenches is no part of a device.
        files.retain(|name, _| name.ends_with(".v") && !name.ends_with("_bfm.v"));
        let interval = fold.map_or(1, |fold| fold.interval);
        let parts: Vec<&str> = files.iter().flat_map(|(name, text)| [name.as_str(), text]).collect();
        Ok(Text { hash: hash(&parts), interface, files, interval })
    }
}

/// Hash of texts, 32 hexadecimal digits. Texts are told apart, so none can take letters of its neighbour.
pub fn hash(parts: &[&str]) -> String {
    let mut state = Sha256::new();
    for part in parts {
        state.update((part.len() as u64).to_le_bytes());
        state.update(part.as_bytes());
    }
    state.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}
