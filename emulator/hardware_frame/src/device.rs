//! The device as Verilog: designs in one module, with queues and the texture cache between them.

use std::collections::BTreeMap;

use roughxel_core::design::Design;
use roughxel_core::plan::{Effects, FootprintKind, ReflectionPlan};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_netlist::target::Target;
use roughxel_netlist::verilog::{FoldSummary, Options, PortDescription, VerilogError, filled};
use thiserror::Error;

use crate::chain::Chain;
use crate::wiring::{CONSTANT_BASE, FRAGMENT_BASE, Footprint, Wiring, total};

/// Files that do not depend on the scene.
const PARTS: [(&str, &str); 3] = [
    ("roughxel_fifo.v", include_str!("templates/roughxel_fifo.v")),
    ("roughxel_texture_cache.v", include_str!("templates/roughxel_texture_cache.v")),
    ("roughxel_texel_requests.v", include_str!("templates/roughxel_texel_requests.v")),
];

/// Name of the outermost module.
pub(crate) const TOP: &str = "roughxel_frame";

/// Lowest bits of the row of a tile that select its place in the cache. One bit more keeps neighbouring levels apart.
const ROW_BITS: u32 = 3;
/// Lowest bits of its column.
const COLUMN_BITS: u32 = 4;

/// Lines of the texture cache, 16 texels each.
pub const CACHE_LINES: u32 = 1 << (ROW_BITS + COLUMN_BITS + 1);

/// Multipliers of a probe on a face and on the sphere: it takes about as many cycles as the texels of a probe.
const PROBE_MULTIPLIERS: [u32; 2] = [1, 3];
/// Multipliers of the filter of a channel, likewise for three channels.
const SAMPLE_MULTIPLIERS: u32 = 6;

/// Accuracy and size of a device.
#[derive(Clone, Debug)]
pub struct DeviceOptions {
    /// Name of the profile.
    pub profile: String,
    /// Its knobs.
    pub precision: Precision,
    /// Multipliers of the reflection.
    pub multipliers: u32,
    /// Device for which levels of logic are counted.
    pub target: Target,
}

/// Reason why there is no device for a scene.
#[derive(Debug, Error)]
pub enum DeviceError {
    /// Nothing in the scene reflects.
    #[error("no object of the scene reflects an environment, so there is nothing to fold")]
    NoReflection,
    /// A reflection without footprints.
    #[error("a reflection has no footprint; use the mode footprint")]
    NoFootprint,
    /// Objects that need different hardware.
    #[error(
        "the reflections of the scene need different {0}, and the device has one kind; draw the objects in scenes of \
         their own"
    )]
    Mixed(&'static str),
    /// A design cannot be written.
    #[error(transparent)]
    Verilog(#[from] VerilogError),
}

/// A device as Verilog.
pub struct Device {
    /// Files by name: modules, tables and manifests.
    pub files: BTreeMap<String, String>,
    /// Footprints that it makes.
    pub footprint: Footprint,
    /// Plan of its reflection.
    pub plan: ReflectionPlan,
    /// Figures of its folded designs, in the order in which a fragment meets them.
    pub folds: Vec<(Design, FoldSummary)>,
    /// Ports of the reflection that a fragment brings, in the order of its word.
    pub(crate) ports: Vec<PortDescription>,
    /// Ports of the reflection that are the same for all fragments.
    pub(crate) constants: Vec<PortDescription>,
    pub(crate) precision: Precision,
}

/// One plan whose hardware serves all these plans: an effect that a fragment does not have gets neutral inputs.
fn common(plans: &[ReflectionPlan]) -> Result<ReflectionPlan, DeviceError> {
    let mut all = *plans.first().ok_or(DeviceError::NoReflection)?;
    for plan in plans {
        if !plan.footprint.is_some() {
            return Err(DeviceError::NoFootprint);
        }
        if plan.footprint != all.footprint {
            return Err(DeviceError::Mixed("kinds of footprints (on a face and on the sphere)"));
        }
        if plan.needs_frame() {
            if all.needs_frame() && plan.frame != all.frame {
                return Err(DeviceError::Mixed("tangent bases"));
            }
            all.frame = plan.frame;
        }
        let is_rough = |plan: &ReflectionPlan| plan.roughness != RoughnessKind::None;
        if is_rough(plan) {
            if is_rough(&all) && plan.roughness != all.roughness {
                return Err(DeviceError::Mixed("kinds of roughness"));
            }
            all.roughness = plan.roughness;
        }
        all.bump |= plan.bump;
        all.curvature |= plan.curvature;
    }
    Ok(all)
}

impl Device {
    /// Device for the reflections of a scene ([`Prepared::reflection_plans`](roughxel_frame::Prepared::reflection_plans)).
    ///
    /// Errors: everything [`DeviceError`] lists.
    pub fn new(plans: &[ReflectionPlan], options: &DeviceOptions) -> Result<Self, DeviceError> {
        let plan = common(plans)?;
        let DeviceOptions { profile, precision, multipliers, target } = options;
        let effects = Effects::from(plan);
        let footprint = if plan.footprint == FootprintKind::Sphere { Footprint::Sphere } else { Footprint::Face };
        let mut chain = Chain::new(Options { target: *target, ..Options::new(profile, *precision, effects) });
        let (probe, probe_multipliers) = match footprint {
            Footprint::Face => (Design::EnvironmentProbe, PROBE_MULTIPLIERS[0]),
            Footprint::Sphere => (Design::SphereProbe, PROBE_MULTIPLIERS[1]),
        };
        chain.add("probe", probe, probe_multipliers)?;
        let mut footprint_outputs: Vec<_> = chain.footprint().map(|port| port.name.clone()).collect();
        if footprint == Footprint::Face {
            footprint_outputs.push("probes.lod".to_owned());
        }
        chain.add_with("reflect", Design::Reflection, *multipliers, footprint_outputs)?;
        let singles = [
            ("levels", Design::Levels),
            ("address", Design::FaceAddress),
            ("texels", Design::FaceTexels),
            ("corner_0", Design::Corner),
            ("corner_1", Design::Corner),
            ("corner_2", Design::Corner),
            ("sum", Design::ProbeSum),
            ("mean", Design::ProbeMean),
            ("colour", Design::Colour),
            ("blend", Design::Blend),
            ("light_0", Design::PixelSum),
            ("light_1", Design::PixelSum),
            ("light_2", Design::PixelSum),
            ("pixel_0", Design::Pixel),
            ("pixel_1", Design::Pixel),
            ("pixel_2", Design::Pixel),
        ];
        for (name, design) in singles {
            chain.add(name, design, 1)?;
        }
        chain.add("sample", Design::ColourSample, SAMPLE_MULTIPLIERS)?;

        let (ports, constants): (Vec<_>, Vec<_>) =
            chain.inputs("reflect").iter().cloned().partition(|port| port.name.starts_with("fragment."));
        let wiring = Wiring::new(&mut chain, footprint, (&ports, &constants));

        let names: Vec<_> = constants.iter().map(|port| port.name.as_str()).collect();
        let values = [
            ("CONSTANT_BITS", (CONSTANT_BASE + total(&constants)).to_string()),
            (
                "CONSTANTS",
                [names.join(", "), "log2 of the unit, last level".into()]
                    .join(", ")
                    .trim_start_matches(", ")
                    .to_owned(),
            ),
            ("FRAGMENT_BITS", (FRAGMENT_BASE + total(&ports)).to_string()),
            ("ROW_BITS", ROW_BITS.to_string()),
            ("COLUMN_BITS", COLUMN_BITS.to_string()),
            ("WIRES", chain.wires() + &wiring.wires),
            ("FOOT", wiring.foot),
            ("JOB_TEXELS", wiring.job_texels),
            ("INSTANCES", chain.instances()),
        ];
        let head = format!(
            "// {TOP}\n//\n// Fragments to pixels: reflection, probes, texture cache, filter, blend, sum. Profile {profile}.\n// A fragment is, from \
             the lowest bit: pixel (26), times (4), last of its pixel, mean of eight, nothing reflected, rough, reflectance\n// (3 x 17), colour of \
             the surface (3 x 30), then the ports of the reflection, first one most significant.\n\n`default_nettype none\n\n"
        );
        let mut files = std::mem::take(&mut chain.files);
        files.extend(PARTS.map(|(name, text)| (name.to_owned(), text.to_owned())));
        files.insert(format!("{TOP}.v"), head + &filled(include_str!("templates/frame.v"), &values));
        Ok(Self { files, footprint, plan, folds: chain.folds(), ports, constants, precision: *precision })
    }
}

impl Device {
    /// Cycles from a reflection to the next.
    pub fn interval(&self) -> u32 {
        let reflection = self.folds.iter().find(|(design, _)| *design == Design::Reflection);
        reflection.map_or(1, |(_, fold)| fold.interval)
    }

    /// Multipliers of all designs.
    pub fn multipliers(&self) -> u32 {
        let units = self.folds.iter().flat_map(|(_, fold)| &fold.units);
        units.filter(|unit| unit.name.ends_with("multiplier")).map(|unit| unit.units).sum()
    }
}
