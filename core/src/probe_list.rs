//! The probes of one footprint as a bounded list, scalar reading.
//!
//! In hardware a small state machine steps through them; here the steps are unrolled into a list without
//! allocation, which a soft core or the emulator walks while it fetches.

use heapless::Vec;

use crate::datapath::probe_position;
use crate::fx::Fx;
use crate::precision::Precision;
use crate::rom::MAX_PROBES;
use crate::scalar::Scalar;
use crate::signals::{CubePoint, FacePosition, Probes};
use crate::stage::probes::{position, weight};
use crate::stage::texture::{TextureScale, texture_position};

/// Where one probe reads, and how much it counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probe<P> {
    /// Place on the map.
    pub place: P,
    /// Weight, 16 fraction bits; the weights of a list sum to exactly 1.
    pub weight: Fx<Scalar, 16>,
}

/// At most [`MAX_PROBES`] probes.
pub type ProbeList<P> = Vec<Probe<P>, MAX_PROBES>;

fn list<P>(probes: &Probes<Scalar>, p: &Precision, place: impl Fn(Fx<Scalar, 0>) -> P) -> ProbeList<P> {
    let mut list = Vec::new();
    for index in (0..probes.count.raw()).map(Fx::from_raw) {
        let probe = Probe { place: place(index), weight: weight(probes, index, p) };
        // The count is 1…16 by construction; a full list would end the walk rather than panic.
        if list.push(probe).is_err() {
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
) -> ProbeList<FacePosition<Scalar>> {
    list(probes, p, |index| probe_position(point, probes, index, p))
}

/// Probes in a repeated map: coordinates in repeats modulo 1, 32 fraction bits.
pub fn texture_probes(
    uv: &[Fx<i64, 32>; 2],
    probes: &Probes<Scalar>,
    map: &TextureScale<Scalar>,
    p: &Precision,
) -> ProbeList<[Fx<i64, 32>; 2]> {
    list(probes, p, |index| texture_position(uv, &position(probes, index), map))
}
