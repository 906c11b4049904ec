//! Comparison of bits on this machine: every field of every golden vector, and a tile of a picture in every profile. Exit code 0: all equal; 3: some
//! differ.
#![no_std]
#![no_main]

use roughxel_core::firmware::{Compact, Narrow, Paper, Precise, Standard};
use roughxel_core::precision::Profile;
use roughxel_firmware::conformance;
use roughxel_firmware::machine::{entry, println};
use roughxel_firmware::sets::SETS;
use roughxel_firmware::tile::{HASHES, Hash, shade};

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
