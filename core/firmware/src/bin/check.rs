//! The same bits on this machine: every field of every golden vector, and a tile of a picture in every profile.
//! Exit code 0: all equal; 3: some differ.
#![no_std]
#![no_main]

use roughxel_core::firmware::{Accuracy, Compact, Firmware, Narrow, Paper, Precise, Standard};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Profile;
use roughxel_core::sampler::Cube;
use roughxel_firmware::conformance;
use roughxel_firmware::machine::{entry, println};
use roughxel_firmware::sets::SETS;
use roughxel_firmware::tile::{self, HASHES, Hash, SKY_EDGE, Sky};

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
    tile::fragments(|y, fragment| {
        let colour = Bumpy::<A>::reflect(&fragment.reflection, &environment).colour(&cube);
        [fragment.x, y].into_iter().chain(colour.map(|channel| channel.to_bits())).for_each(|part| hash.add(part));
    });
    hash
}

fn run() -> i32 {
    let (mut vectors, mut differ) = (0, 0);
    for set in SETS {
        let (of_set, wrong) = conformance::run(set);
        println!("{:36} {of_set:5} vectors, {wrong} fields differ", set.name);
        vectors += of_set;
        differ += wrong;
    }
    for (profile, expected) in HASHES {
        let Hash(hash) = match profile {
            Profile::Narrow => shade::<Narrow>(),
            Profile::Paper => shade::<Paper>(),
            Profile::Compact => shade::<Compact>(),
            Profile::Standard => shade::<Standard>(),
            Profile::Precise => shade::<Precise>(),
        };
        println!("tile in {:9} hash {hash:08x}, the emulator's {expected:08x}", profile.name());
        differ += u32::from(hash != expected);
    }
    println!("{} sets, {vectors} vectors, {} tiles, {differ} mismatches", SETS.len(), HASHES.len());
    if differ == 0 { 0 } else { 3 }
}

entry!(run);
