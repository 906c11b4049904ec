//! Stability: the error of each hard case against the distance from its degeneracy, down to the last bit.
//!
//! The float64 reference judges every method, fed with exactly the numbers that the method sees: a profile with its ports, `f32`
//! with the ports of `precise` rounded to 24 bits. No curve therefore shows the accuracy of its inputs, only that of the
//! computation. The seven methods take the same members of a family. A point is the worst member at its distance.
//!
//! A result that is not a number counts as the largest error of its figure. If a figure is unbounded, that error is 1: nothing is
//! left of the result.

mod family;
mod float;
mod method;
mod peak;
mod pictures;
mod reflection;

pub use float::Float;
pub use method::METHODS;
pub use pictures::{NaivePicture, pictures};

use rayon::prelude::*;
use roughxel_utilities::random::SplitMix64;
use serde::{Deserialize, Serialize};

use crate::superscript::superscript;
use family::{FAMILIES, Family, Kind};
use method::{COMPARED, Method, Sample};

/// The nearest distance is 2^(−this/2): two bits below the last one of `precise`.
const LAST: i32 = 56;

/// The error of each method on the way to one degeneracy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HardCase {
    /// Name, words joined by `_`.
    pub name: String,
    /// Title.
    pub title: String,
    /// Definition of the distance, with its unit.
    pub distance: String,
    /// Definition of the error, with its unit.
    pub error: String,
    /// The plain formula, and its failure.
    pub naive: String,
    /// Documented behaviour of the datapath there.
    pub fallback: String,
    /// A curve for each of [`METHODS`].
    pub curves: Vec<Curve>,
}

/// The error of one method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// One of [`METHODS`].
    pub method: String,
    /// Distance, falling, and the worst error of the family there; 0 if no member has an error.
    pub points: Vec<[f64; 2]>,
    /// Bar of the profile; `None` in floating point.
    pub bar: Option<f64>,
    /// Largest distance at which a member has the documented fallback; `None` if no member has it.
    pub fallback: Option<f64>,
}

impl Curve {
    /// The first point that is farther away than the fallback and above the bar, NaN included.
    pub fn first_above_bar(&self) -> Option<[f64; 2]> {
        let bar = self.bar?;
        let before = |distance: f64| self.fallback.is_none_or(|fallback| distance > fallback);
        self.points.iter().copied().find(|&[distance, error]| before(distance) && (error.is_nan() || error > bar))
    }
}

/// Distances of a family, falling by half octaves.
fn distances(family: &Family) -> Vec<f64> {
    (family.first..=LAST).map(|i| (-0.5 * f64::from(i)).exp2()).collect()
}

/// Number of progress steps of [`measure`].
pub fn steps() -> u64 {
    FAMILIES.iter().map(|family| distances(family).len() as u64).sum()
}

/// Every hard case with `members` random members of its family at every distance. The figures do not depend on the number of
/// threads.
///
/// `progress` is called once a step, from any thread.
pub fn measure(members: u32, progress: &(dyn Fn() + Sync)) -> Vec<HardCase> {
    let case = |family: &Family| {
        let at = |distance: f64| {
            let samples = COMPARED.map(|method| worst(family, method, distance, members));
            progress();
            (distance, samples)
        };
        let samples: Vec<_> = distances(family).into_par_iter().map(at).collect();
        let curve = |index: usize| Curve {
            method: METHODS[index].to_owned(),
            points: samples.iter().map(|(distance, samples)| [*distance, samples[index].error]).collect(),
            bar: match COMPARED[index] {
                Method::Float(_) => None,
                Method::Profile(profile) => family.bar(profile.name()),
            },
            fallback: samples.iter().find(|(_, samples)| samples[index].fallback).map(|(distance, _)| *distance),
        };
        HardCase {
            name: family.name.to_owned(),
            title: family.title.to_owned(),
            distance: family.distance.to_owned(),
            error: family.error.to_owned(),
            naive: family.naive.to_owned(),
            fallback: family.fallback.to_owned(),
            curves: (0..COMPARED.len()).map(curve).collect(),
        }
    };
    FAMILIES.par_iter().map(case).collect()
}

fn worst(family: &Family, method: Method, distance: f64, members: u32) -> Sample {
    let sample = |member: u32| {
        let random = &mut SplitMix64::for_element(family.name, member.into());
        match &family.kind {
            Kind::Reflection(reflection) => reflection.sample(method, distance, random),
            Kind::Peak => peak::sample(method, distance, random),
        }
    };
    (0..members).map(sample).fold(Sample { error: 0.0, fallback: false }, Sample::merge)
}

/// Least length of a range that [`float_wins`] names, in half octaves: over shorter ranges luck decides which few members are
/// worst.
const RANGE: usize = 2;

/// Distances at which floating point is closer to the truth than a profile, over at least an octave: a sentence for each pair
/// that has such distances.
pub fn float_wins(case: &HardCase) -> Vec<String> {
    let (float, integer): (Vec<_>, Vec<_>) = case.curves.iter().partition(|curve| curve.bar.is_none());
    let pairs = float.iter().flat_map(|float| integer.iter().map(move |integer| (float, integer)));
    pairs
        .filter_map(|(float, integer)| {
            let closer: Vec<bool> = float.points.iter().zip(&integer.points).map(|(a, b)| a[1] < b[1]).collect();
            let mut ranges = Vec::new();
            let mut start = 0;
            for run in closer.chunk_by(|a, b| a == b) {
                let end = start + run.len();
                if run[0] && run.len() > RANGE {
                    ranges.push([float.points[start][0], float.points[end - 1][0]]);
                }
                start = end;
            }
            let power = |distance: f64| format!("2{}", superscript(0.5 * (2.0 * distance.log2()).round()));
            let text = |[from, to]: &[f64; 2]| format!("from {} to {}", power(*from), power(*to));
            let whole = closer.iter().all(|&closer| closer);
            let where_ = match whole {
                true => "at every distance".to_owned(),
                false => ranges.iter().map(text).collect::<Vec<_>>().join(", "),
            };
            (!ranges.is_empty()).then(|| format!("{} is closer than {} {where_}.", float.method, integer.method))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_curve_leaves_its_bar_before_its_documented_fallback() {
        let mut left = Vec::new();
        for case in measure(64, &|| ()) {
            println!("{}", case.name);
            for curve in &case.curves {
                let before = curve.points.iter().filter(|point| curve.fallback.is_none_or(|at| point[0] > at));
                let last_before = before.clone().next_back();
                let worst = before.map(|point| point[1]).fold(0.0, f64::max);
                println!(
                    "  {:16} worst 2^{:6.2}, bar 2^{:6.2}, to 2^{:5.1}; at the end 2^{:6.2}",
                    curve.method,
                    worst.log2(),
                    curve.bar.map_or(f64::NAN, f64::log2),
                    last_before.map_or(0.0, |point| point[0].log2()),
                    curve.points.last().map_or(0.0, |point| point[1].log2()),
                );
                if let Some([distance, error]) = curve.first_above_bar() {
                    left.push(format!("{}, {}: {error:e} at {distance:e}", case.name, curve.method));
                }
            }
        }
        assert!(left.is_empty(), "{}", left.join("\n"));
    }

    /// A fallback from the first distance on would hold any bar, so curves need points before it.
    #[test]
    fn every_curve_has_a_way_to_go_before_its_fallback() {
        for case in measure(64, &|| ()) {
            for curve in &case.curves {
                let before = curve.points.iter().filter(|point| curve.fallback.is_none_or(|at| point[0] > at));
                assert!(before.count() >= 3, "{}, {}", case.name, curve.method);
            }
        }
    }

    #[test]
    fn figures_do_not_depend_on_the_number_of_threads() {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
            pool.install(|| measure(3, &|| ()))
        };
        assert_eq!(with(1), with(4));
    }

    #[test]
    fn a_progress_step_is_a_distance_of_a_family() {
        let done = std::sync::atomic::AtomicU64::new(0);
        measure(1, &|| {
            done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        });
        assert_eq!(done.into_inner(), steps());
    }

    #[test]
    fn cases_come_back_from_json() {
        let cases = measure(1, &|| ());
        let text = serde_json::to_string(&cases).expect("figures are numbers");
        assert_eq!(serde_json::from_str::<Vec<HardCase>>(&text).expect("the written text can be read"), cases);
    }

    #[test]
    fn what_floating_point_wins_is_said_with_its_distances() {
        let curve = |method: &str, bar, errors: [f64; 5]| Curve {
            method: method.to_owned(),
            points: errors.iter().zip(1..).map(|(&error, k)| [f64::exp2(-f64::from(k)), error]).collect(),
            bar,
            fallback: None,
        };
        let case = HardCase {
            name: String::new(),
            title: String::new(),
            distance: String::new(),
            error: String::new(),
            naive: String::new(),
            fallback: String::new(),
            curves: vec![
                curve("float32 careful", None, [0.1, 0.1, 0.1, 0.3, 0.1]),
                curve("narrow", Some(1.0), [0.2; 5]),
                curve("standard", Some(1.0), [0.01; 5]),
                curve("paper", Some(1.0), [1.0; 5]),
            ],
        };
        assert_eq!(
            float_wins(&case),
            [
                "float32 careful is closer than narrow from 2⁻¹ to 2⁻³.",
                "float32 careful is closer than paper at every distance."
            ]
        );
    }
}
