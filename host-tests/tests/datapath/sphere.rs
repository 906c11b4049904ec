//! Footprints on the sphere against the float64 reference: the mean direction of their probes and its second moments, which neither the order of
//! probes nor the sign of an axis changes, and their mean level of detail.
//!
//! Run with `--nocapture` to see the measured figures.

use glam::DVec3;
use rayon::prelude::*;
use roughxel_cases::{hard_case_sets, random_fragment};
use roughxel_core::plan::{FootprintKind, ReflectionPlan};
use roughxel_core::ports::{Port, ReflectionIn};
use roughxel_core::precision::{Precision, ProbeRule};
use roughxel_core::probe_list::sphere_probes;
use roughxel_core::rom::{
    NORMAL_PLACES, NORMAL_PLACES_OF_ONE_LESS, NORMAL_WIDENINGS, NORMAL_WIDENINGS_OF_ONE_LESS, SPREAD_LIMIT,
};
use roughxel_core::scalar_api::{environment_scale, reflection};
use roughxel_host_tests::space::{profiles, whole_or};
use roughxel_reference::cube::direction_of;
use roughxel_reference::linear::norm;
use roughxel_reference::sphere::{lobe, points};
use roughxel_study::accuracy::{reference_inputs, reference_options};

const PLAN: ReflectionPlan = ReflectionPlan { footprint: FootprintKind::Sphere, ..ReflectionPlan::FULL };

/// Weighted mean and second moments of directions, and the mean level of detail.
#[derive(Default)]
struct Moments {
    mean: DVec3,
    square: [DVec3; 3],
    lod: f64,
}

impl Moments {
    fn add(&mut self, weight: f64, direction: DVec3, lod: f64) {
        self.mean += weight * direction;
        for (row, component) in self.square.iter_mut().zip(direction.to_array()) {
            *row += weight * component * direction;
        }
        self.lod += weight * lod;
    }

    /// Differences of directions and of levels.
    fn differences(&self, other: &Self) -> [f64; 2] {
        let square: f64 = self.square.iter().zip(&other.square).map(|(a, b)| (*a - *b).length_squared()).sum();
        [(self.mean - other.mean).length().max(square.sqrt()), (self.lod - other.lod).abs()]
    }
}

fn drawn(fragment: &ReflectionIn, p: &Precision) -> Moments {
    let map = environment_scale(fragment.edge_texels, p);
    let sweep = reflection(&fragment.wires(), &map, &PLAN, p).sweep;
    let mut moments = Moments::default();
    for probe in sphere_probes(&sweep, map.last_level.raw() as u32, p) {
        let [s, t] = probe.place.st.map(|s| f64::from(s.raw()) / f64::from(1 << 28));
        let direction = DVec3::from_array(direction_of(probe.place.face.raw() as usize, s, t)).normalize();
        moments.add(f64::from(probe.weight.raw()) / 65536.0, direction, f64::from(probe.lod.raw()) / 65536.0);
    }
    moments
}

/// Moments of the reference, and the weight of a difference of directions.
///
/// The deviation of a lobe from a circle, major² − minor², is the remainder of terms as large as its scale². Its probes along that axis are less
/// accurate by the same ratio. `None` if the lobe is too inaccurate for a comparison: terms that cancel, or a probe that hardly looks anywhere.
fn expected(fragment: &ReflectionIn, p: &Precision) -> Option<(Moments, f64)> {
    let inputs = reference_inputs(fragment);
    let lobe = lobe(&inputs, &reference_options(&PLAN, p))?;
    let last = f64::from(inputs.edge_texels.ilog2());
    let size = norm(&lobe.first) + norm(&lobe.second) + norm(&lobe.centre);
    if lobe.minor < lobe.scale / 16.0 || lobe.scale > 64.0 || size > 16.0 {
        return None;
    }
    // Rounding decides between a probe count and its double if R − 1/16 is an integer.
    let wanted = ((lobe.major / lobe.minor).powi(2) - 1.0).max(0.0).sqrt() - 0.0625;
    if p.probe_rule == ProbeRule::PowerOfTwo && (wanted - wanted.round()).abs() < 2_f64.powi(-8) {
        return None;
    }
    let mut moments = Moments::default();
    for probe in &lobe.probes {
        let direction = DVec3::from_array(direction_of(probe.at.face, probe.at.s, probe.at.t));
        if probe.at.m * direction.length() < size / 16.0 {
            return None;
        }
        moments.add(probe.weight, direction.normalize(), probe.lod.clamp(0.0, last));
    }
    let spread = (lobe.major.powi(2) - lobe.minor.powi(2)).max(0.0).sqrt();
    let weight = if lobe.probes.len() > 1 { (64.0 * spread * size / lobe.scale.powi(2)).min(1.0) } else { 1.0 };
    Some((moments, weight))
}

/// Bars of directions (radians) and of levels: at least one and a half times the worst of all fragments. `paper` knows eight directions of an axis.
fn bars(name: &str) -> [f64; 2] {
    let powers = match name {
        "narrow" => [-8, -6],
        "paper" => [-2, -3],
        "compact" => [-9, -6],
        "standard" => [-13, -8],
        _ => [-13, -12],
    };
    powers.map(|power| 2_f64.powi(power))
}

#[test]
fn probes_on_the_sphere_are_those_of_the_reference() {
    for (name, p) in profiles() {
        let random = (0..whole_or(200_000_u64, 20_000)).map(|index| random_fragment("sphere", index, &p));
        let hard = hard_case_sets(&p).into_iter().flat_map(|set| set.cases);
        let fragments: Vec<ReflectionIn> = random.chain(hard).collect();
        let errors: Vec<([f64; 2], usize)> = fragments
            .par_iter()
            .enumerate()
            .filter_map(|(index, fragment)| {
                let (expected, weight) = expected(fragment, &p)?;
                let [directions, levels] = drawn(fragment, &p).differences(&expected);
                Some(([weight * directions, levels], index))
            })
            .collect();
        assert!(errors.len() > fragments.len() / 3, "{name}: {} of {} count", errors.len(), fragments.len());
        for (figure, bar) in bars(name).into_iter().enumerate() {
            let worst = errors.iter().max_by(|a, b| a.0[figure].total_cmp(&b.0[figure])).expect("some count");
            println!(
                "{name:8} {} 2^{:.2}, bar 2^{:.0}, {}",
                ["directions", "levels"][figure],
                worst.0[figure].log2(),
                bar.log2(),
                worst.1
            );
            assert!(worst.0[figure] <= bar, "{name}: {} {:?}", worst.0[figure], fragments[worst.1]);
        }
    }
}

/// Tables of places and widths against the reference's, which finds quantiles by bisection; the weights of every footprint sum to 1.
#[test]
fn places_are_those_of_the_normal_law() {
    for count in 1..=16_u32 {
        let row = 16 * (count as usize - 1);
        let tables = [
            (0.0, &NORMAL_PLACES_OF_ONE_LESS, &NORMAL_WIDENINGS_OF_ONE_LESS),
            (1.0, &NORMAL_PLACES, &NORMAL_WIDENINGS),
        ];
        for (share, places, widenings) in tables {
            for (index, point) in (row..).zip(points(count, share)) {
                let place = f64::from(places[index]) * 2_f64.powi(-28);
                let widening = f64::from(widenings[index]) * 2_f64.powi(-16);
                assert!((place - point.x).abs() < 3e-9, "{count}: {place}, {point:?}");
                assert!((widening - point.widening).abs() < 8e-6, "{count}: {widening}, {point:?}");
            }
        }
        let limit = (1.0 - 1.0 / f64::from(count * count)).sqrt();
        assert!((f64::from(SPREAD_LIMIT[count as usize]) / f64::from(1 << 30) - limit).abs() < 1e-9);
    }
}
