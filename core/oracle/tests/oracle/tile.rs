//! The tile of a picture that firmware draws.

use fixed::types::I8F24;
use roughxel_core::firmware::{Accuracy, Firmware, Narrow, Standard};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Profile;
use roughxel_core::sampler::Cube;

#[path = "../../../firmware/src/tile.rs"]
#[expect(unreachable_pub, reason = "it is the firmware's")]
pub(crate) mod drawn;

use drawn::{HASHES, Hash, SKY_EDGE, Sky};

/// The surface of the tile.
struct Bumpy<A>(A);

impl<A: Accuracy> Firmware for Bumpy<A> {
    type Accuracy = A;
    const EFFECTS: Effects = Effects::ALL;
}

/// The hash of the tile: place and colour of each of its pixels.
fn shade<A: Accuracy>() -> Hash {
    let mut hash = Hash::default();
    let environment = Bumpy::<A>::environment(SKY_EDGE);
    let cube = Cube { memory: &Sky, edge: SKY_EDGE.into(), last_level: SKY_EDGE.ilog2(), exponent: 0 };
    drawn::fragments(|y, fragment| {
        let colour = Bumpy::<A>::reflect(&fragment.reflection, &environment).colour(&cube);
        [fragment.x, y].into_iter().chain(colour.map(I8F24::to_bits)).for_each(|part| hash.add(part));
    });
    hash
}

pub(crate) fn the_tile_hashes_to_what_it_does_on_every_machine() {
    for (profile, expected) in HASHES {
        // One of each width of words: other accuracies are no other code.
        let hash = match profile {
            Profile::Narrow => shade::<Narrow>(),
            Profile::Standard => shade::<Standard>(),
            _ => continue,
        };
        assert_eq!(hash, Hash(expected), "{}: {:#010x}", profile.name(), hash.0);
    }
}
