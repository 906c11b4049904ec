//! Cost of each effect of a scene's objects: additional hardware, memory of its maps, share of the time.
//!
//! Hardware is the difference between the census of the object's datapath with the effect and without. Parts that an effect needs
//! from others (a tangent basis, a footprint) count for each of the effects. The share of time is 1 − t(without)/t(with) of whole
//! frames, the median of rounds that draw the two frames in turn ([`time_ratio`]). The frames differ in the plan only.

use std::time::{Duration, Instant};

use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::Precision;
use roughxel_record as record;

use roughxel_frame::Prepared;
use roughxel_frame::plan::{Decision, Mode};
use roughxel_frame::raster::RasterError;
use roughxel_netlist::census::{Census, Cost};
use roughxel_netlist::graph::Net;
use roughxel_netlist::interval::Ranges;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;
use roughxel_shader::{Effect, ObjectPlan};
use serde::Serialize;

/// The designs in a texture fetch of one channel.
const TEXTURE_FETCH: [Design; 5] =
    [Design::Texture, Design::TextureProbe, Design::Levels, Design::RepeatAddress, Design::ProbeSum];
/// The designs in a fetch of the environment.
const ENVIRONMENT_FETCH: [Design; 7] = [
    Design::EnvironmentProbe,
    Design::Levels,
    Design::FaceAddress,
    Design::FaceTexels,
    Design::ColourSample,
    Design::Colour,
    Design::Blend,
];
/// The designs in a fetch of a bright environment.
const BRIGHT_FETCH: [Design; 7] = [
    Design::EnvironmentProbe,
    Design::Levels,
    Design::FaceAddress,
    Design::FaceTexels,
    Design::BrightTexel,
    Design::WordSample,
    Design::BrightBlend,
];
/// Designs of a second lobe besides a second environment lookup.
const TWO_LOBES: [Design; 3] = [Design::LobeLaw, Design::Lobe, Design::Lobes];
/// Designs that a bump map adds to a fetch, followed by those that its roughness adds.
const BUMP: [Design; 1] = [Design::WordSample];
const ROUGHNESS: [Design; 5] =
    [Design::ProbeReach, Design::BumpTexel, Design::BumpRamp, Design::BumpProbe, Design::Bump];
/// Size of a piece of hardware.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Hardware {
    /// Stages, each run by its instance name.
    pub stages: Vec<String>,
    /// Operations other than wires.
    pub operations: i64,
    /// Number of these operations that are multipliers of two wires.
    pub multipliers: i64,
    /// Bits of adders, subtracters and comparators.
    pub carry_bits: i64,
    /// Bits of tables.
    pub rom_bits: i64,
    /// Counts of each stage.
    #[serde(skip)]
    parts: Vec<[i64; 4]>,
}

impl Hardware {
    /// Hardware of a datapath with some effects, without the formats of its ports.
    fn for_datapath(datapath: Datapath, effects: &Effects, p: &Precision) -> Self {
        let (net, census) = census(Design::for_datapath(datapath), effects, p);
        let mut sum = Self::default();
        let runs = net.runs.iter().zip(&census.runs);
        for (run, cost) in runs.filter(|(run, _)| !["map_scale", "leave"].contains(&run.base())) {
            sum.add(run.instance(), counts(cost));
        }
        sum
    }

    fn add(&mut self, stage: String, part: [i64; 4]) {
        let [operations, multipliers, carry_bits, rom_bits] = part;
        self.stages.push(stage);
        self.parts.push(part);
        self.operations += operations;
        self.multipliers += multipliers;
        self.carry_bits += carry_bits;
        self.rom_bits += rom_bits;
    }

    /// Union of two pieces of hardware; a common stage counts once.
    fn joined(mut self, other: Self) -> Self {
        for (stage, part) in other.stages.into_iter().zip(other.parts) {
            if !self.stages.contains(&stage) {
                self.add(stage, part);
            }
        }
        self
    }

    /// Hardware of several designs in parallel, each as one stage.
    fn of_all(designs: &[Design], p: &Precision) -> Self {
        designs.iter().fold(Self::default(), |mut sum, &design| {
            let (_, census) = census(design, &Effects::ALL, p);
            sum.add(design.name().into(), counts(&census.total));
            sum
        })
    }

    /// Difference to `other`.
    fn more_than(&self, other: &Self) -> Self {
        let is_own = |(stage, _): &(&String, &[i64; 4])| !other.stages.contains(stage);
        let (stages, parts) = self.stages.iter().zip(&self.parts).filter(is_own).map(|(b, p)| (b.clone(), *p)).unzip();
        Self {
            stages,
            parts,
            operations: self.operations - other.operations,
            multipliers: self.multipliers - other.multipliers,
            carry_bits: self.carry_bits - other.carry_bits,
            rom_bits: self.rom_bits - other.rom_bits,
        }
    }
}

/// The netlist of a design, with its counts.
pub(crate) fn census(design: Design, effects: &Effects, p: &Precision) -> (Net, Census) {
    let net = record::net(design, effects, p);
    let census = Census::new(&net, &Ranges::new(&net));
    (net, census)
}

/// Operations, multipliers, carry bits and bits of tables.
fn counts(cost: &Cost) -> [i64; 4] {
    let Cost { adders, constant_adders, comparators, selects, shifters, leading_zeros, logic, lookups, .. } = cost;
    let units = [adders, constant_adders, comparators, selects, shifters, leading_zeros, logic];
    let by_constant: u32 = cost.constant_multipliers.values().sum();
    let counted: u32 = units.iter().map(|units| units.count).sum::<u32>() + lookups + by_constant;
    let multipliers = cost.multiplier_count();
    [i64::from(counted + multipliers), multipliers.into(), cost.carry_bits() as i64, cost.rom_bits() as i64]
}

/// One effect of one object.
#[derive(Clone, Debug)]
pub struct EffectReport {
    /// State of the effect, and the reason.
    pub decision: Decision,
    /// Hardware that it adds to the datapath of a fragment; nothing if it is off.
    pub datapath: Hardware,
    /// Hardware that it adds for each fetch.
    pub fetch: Hardware,
    /// Bytes of its maps.
    pub map_bytes: u64,
    /// Share of the time of a frame, if measured.
    pub share: Option<f64>,
}

/// Every effect of one object.
#[derive(Clone, Debug)]
pub struct ObjectReport {
    /// Name of the object.
    pub name: String,
    /// Its plan.
    pub plan: ObjectPlan,
    /// Its effects in the order of [`Effect::ALL`].
    pub effects: Vec<EffectReport>,
}

/// Hardware of an object's fragment and of each of its lights. Stages that its datapaths share, those of the surface, count once.
fn datapath(plan: &ObjectPlan, p: &Precision) -> Hardware {
    let each = plan.datapaths().map(|(datapath, effects)| Hardware::for_datapath(datapath, &effects, p));
    each.fold(Hardware::default(), Hardware::joined)
}

/// The designs in a fetch of the environment.
fn environment_fetch(is_bright: bool) -> &'static [Design] {
    if is_bright { &BRIGHT_FETCH } else { &ENVIRONMENT_FETCH }
}

/// The designs in the fetches of an object, each once; `is_bright` is true if it reflects a bright environment
/// ([`Prepared::has_bright_environment`]).
pub fn fetches(plan: &ObjectPlan, is_bright: bool) -> Vec<Design> {
    let has = |effect| plan.has(effect);
    let (colour, reflection) = (has(Effect::ColourTexture), has(Effect::Environment));
    let repeated = colour || plan.bump_map() || has(Effect::Peaks);
    let footprint = plan.texture_footprint;
    let lit = has(Effect::Highlight) || has(Effect::Peaks);
    let parts: [(bool, &[Design]); 11] = [
        (repeated && footprint, &[Design::Texture, Design::TextureProbe]),
        (repeated, &[Design::Levels, Design::RepeatAddress]),
        (plan.bump_map() || has(Effect::Peaks), &BUMP),
        (plan.bump_map(), &ROUGHNESS),
        (reflection, environment_fetch(is_bright)),
        (reflection, if is_bright { &[Design::BrightCorner] } else { &[Design::Corner] }),
        (has(Effect::TwoLobes), &TWO_LOBES),
        (colour, &[Design::ColourSample, Design::Colour]),
        (colour || lit, &[Design::Modulated]),
        ((repeated || reflection) && footprint, &[Design::ProbeSum, Design::ProbeMean]),
        (true, &[Design::PixelSum, Design::Pixel]),
    ];
    let mut designs: Vec<Design> =
        parts.into_iter().filter(|(on, _)| *on).flat_map(|(_, parts)| parts).copied().collect();
    designs.sort_unstable();
    designs.dedup();
    designs
}

/// Explains the plan of every object, without measuring.
pub fn explain(scene: &Scene, prepared: &Prepared<'_>, p: &Precision) -> Vec<ObjectReport> {
    let objects = scene.objects.iter().zip(prepared.plans()).zip(prepared.decisions()).enumerate();
    let report =
        |(index, ((object, plan), decisions)): (usize, ((&roughxel_scene::Object, &ObjectPlan), &[Decision]))| {
            let (whole, bytes) = (datapath(plan, p), prepared.map_bytes(index));
            let effect = |decision: &Decision| {
                let effect = decision.effect;
                let nothing = Hardware::default();
                let fetch = match effect {
                    _ if !decision.on => nothing.clone(),
                    Effect::ColourTexture => Hardware::of_all(&TEXTURE_FETCH, p),
                    Effect::Bump => Hardware::of_all(&[&TEXTURE_FETCH[..], &BUMP].concat(), p),
                    Effect::Roughness => Hardware::of_all(&ROUGHNESS, p),
                    Effect::Environment => Hardware::of_all(environment_fetch(prepared.has_bright_environment()), p),
                    Effect::TwoLobes => Hardware::of_all(&TWO_LOBES, p),
                    // These effects fetch nothing.
                    Effect::Footprint
                    | Effect::Edges
                    | Effect::Curvature
                    | Effect::Highlight
                    | Effect::Peaks
                    | Effect::Horizon => nothing.clone(),
                };
                EffectReport {
                    decision: decision.clone(),
                    datapath: if decision.on { whole.more_than(&datapath(&plan.without(effect), p)) } else { nothing },
                    fetch,
                    map_bytes: bytes.iter().find(|(known, _)| *known == effect).map_or(0, |(_, bytes)| *bytes),
                    share: None,
                }
            };
            ObjectReport { name: object.name.clone(), plan: *plan, effects: decisions.iter().map(effect).collect() }
        };
    objects.map(report).collect()
}

/// Least time of each side of a round of [`measure`]: other work of a machine takes turns of milliseconds.
const ROUND_TIME: Duration = Duration::from_millis(50);

/// t(a)/t(b) of a frame: the median over pairs of frames, drawn one after the other. There are as many pairs as the faster side
/// needs to take `time`, and at least one. `clock` gives the time since a fixed moment.
pub fn time_ratio(
    a: &Prepared<'_>,
    b: &Prepared<'_>,
    time: Duration,
    clock: &dyn Fn() -> Duration,
) -> Result<f64, RasterError> {
    let frame = |prepared: &Prepared<'_>| {
        let start = clock();
        prepared.render(&|| ()).map(|_| clock().saturating_sub(start))
    };
    let (mut ratios, mut taken) = (Vec::new(), Duration::ZERO);
    while ratios.is_empty() || taken < time {
        // The sides take turns in going first.
        let (a, b) = if ratios.len() % 2 == 0 {
            (frame(a)?, frame(b)?)
        } else {
            let b = frame(b)?;
            (frame(a)?, b)
        };
        ratios.push(a.as_secs_f64() / b.as_secs_f64());
        taken += a.min(b);
    }
    Ok(median(ratios))
}

/// The median; the upper of two middle figures.
fn median(mut figures: Vec<f64>) -> f64 {
    figures.sort_by(f64::total_cmp);
    figures[figures.len() / 2]
}

/// Measures the share of every effect that is on. `progress` is called before each of the rounds of each effect.
pub fn measure(
    scene: &Scene,
    mode: Mode,
    profile: &Precision,
    peaks: &ScenePeaks,
    rounds: usize,
    reports: &mut [ObjectReport],
    progress: &dyn Fn(),
) -> Result<(), RasterError> {
    let begin = Instant::now();
    let with = Prepared::with_peaks(scene, mode, profile, peaks)?;
    for (index, report) in reports.iter_mut().enumerate() {
        for effect in report.effects.iter_mut().filter(|effect| effect.decision.on) {
            let plan = report.plan.without(effect.decision.effect);
            let without = Prepared::with_peaks(scene, mode, profile, peaks)?.with_plan(index, plan);
            let mut shares = Vec::new();
            for _ in 0..rounds.max(1) {
                progress();
                shares.push(1.0 - time_ratio(&without, &with, ROUND_TIME, &|| begin.elapsed())?);
            }
            effect.share = Some(median(shares));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_operation_of_a_datapath_is_in_a_block() {
        for datapath in Datapath::ALL {
            let (net, census) = census(Design::for_datapath(datapath), &Effects::ALL, &Precision::STANDARD);
            let runs = net.runs.iter().zip(&census.runs).map(|(_, cost)| counts(cost));
            let sum = runs.fold([0; 4], |sum, part| [0, 1, 2, 3].map(|i| sum[i] + part[i]));
            let [all, of_wires, carries, _] = counts(&census.total);
            assert_eq!(sum[..3], [all, of_wires, carries], "{datapath:?}");
        }
    }
}
