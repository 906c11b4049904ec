//! Texture footprints side by side: the probes of many fragments in maps of one size.

use roughxel_core::bundle::Bundle;
use roughxel_core::datapath;
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::signals::{MapScale, PortBlock, Probes};
use roughxel_core::stage::texture::TextureScale;

use super::batch::{Lane, Load, Spread, Store, Unload};
use super::{LANES, Target};

/// Words of two derivatives.
const WORDS: usize = 6;

/// Words of [`Probes`].
const ROWS: usize = 7;

/// Adds the probes of every fragment to `probes`, in their order.
pub(super) fn footprints<T: Target>(
    derivatives: &[[PortBlock<i32, 2>; 2]],
    (texture, map): &(TextureScale<i32>, MapScale<i32>),
    p: &Precision,
    probes: &mut Vec<Probes<i32>>,
) {
    let blank = [PortBlock { mantissa: [Fx::zero(); 2], exponent: Fx::zero() }; 2];
    for fragments in derivatives.chunks(LANES) {
        let mut group = [[0; LANES]; WORDS];
        for (lane, duv) in fragments.iter().enumerate() {
            duv.rewire::<i32, _>(&mut Store { group: &mut group, lane, next: 0 });
        }
        let mut rows = [[0; LANES]; ROWS];
        let form = T::run(
            #[inline(always)]
            || {
                let proof = T::proof();
                let duv = blank.rewire(&mut Load { group: &group, proof, next: 0 });
                let texture = texture.rewire(&mut Spread::<T>(proof));
                let map = map.rewire(&mut Spread::<T>(proof));
                let footprint = datapath::texture_footprint(&duv, &texture, &map, p);
                footprint.probes.rewire(&mut Unload { rows: &mut rows, next: 0 })
            },
        );
        let lanes = 0..fragments.len();
        probes.extend(lanes.map(|lane| -> Probes<i32> { form.rewire(&mut Lane { rows: &rows, lane, next: 0 }) }));
    }
}
