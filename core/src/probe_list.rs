//! The probes of one footprint as a bounded list, on the scalar backend.
//!
//! In hardware a small state machine steps through them. Here the steps are unrolled into a list without allocation, which a soft core or the
//! emulator walks while it fetches.

use heapless::Vec;

use crate::bundle::Value;
use crate::datapath;
use crate::fx::{Fx, Int};
use crate::precision::Precision;
use crate::rom::MAX_PROBES;
use crate::scalar::Scalar;
use crate::scalar_api;
use crate::signals::{CubePoint, FaceProbe, Probes, SphereProbe, Sweep, TexturePosition, TextureProbe};
use crate::stage::texture::TextureScale;
use crate::width::on_words;

/// List of at most [`MAX_PROBES`] probes.
pub type ProbeList<P> = Vec<P, MAX_PROBES>;

fn list<P>(count: Int<Scalar>, probe: impl Fn(Int<Scalar>) -> P) -> ProbeList<P> {
    let mut list = Vec::new();
    for index in (0..count.raw()).map(Fx::from_raw) {
        // The count is 1…16 by construction; a full list would end the walk rather than panic.
        if list.push(probe(index)).is_err() {
            break;
        }
    }
    list
}

/// Probes on the faces of an environment, continued across edges.
pub fn environment_probes(
    point: &CubePoint<Scalar>,
    probes: &Probes<Scalar>,
    p: &Precision,
) -> ProbeList<FaceProbe<Scalar>> {
    list(probes.count, |index| {
        let index = &Value(index);
        on_words!(p, |point, probes, index| datapath::environment_probe(point, probes, index.0, p))
    })
}

/// Probes on the sphere, of an environment with levels up to `last_level`.
pub fn sphere_probes(sweep: &Sweep<Scalar>, last_level: u32, p: &Precision) -> ProbeList<SphereProbe<Scalar>> {
    let last_level = Fx::from_raw(last_level as i32);
    list(sweep.count, |index| scalar_api::sphere_probe(sweep, index, last_level, p))
}

/// Probes in a wrapped map.
pub fn texture_probes(
    centre: &TexturePosition<Scalar>,
    probes: &Probes<Scalar>,
    map: &TextureScale<Scalar>,
    p: &Precision,
) -> ProbeList<TextureProbe<Scalar>> {
    // Of nothing but numbers that control: the same on words of any width.
    list(probes.count, |index| datapath::texture_probe(centre, probes, index, map, p))
}
