//! Golden vectors on this machine: every field of every vector compared. Exit code 0: all equal; 3: some differ.
#![cfg_attr(target_os = "none", no_std, no_main)]

use roughxel_firmware::conformance;
use roughxel_firmware::machine::{entry, println};
use roughxel_firmware::sets::SETS;

fn run() -> i32 {
    let (mut vectors, mut differ) = (0, 0);
    for set in SETS {
        let (of_set, wrong) = conformance::run(set);
        println!("{:36} {of_set:5} vectors, {wrong} fields differ", set.name);
        vectors += of_set;
        differ += wrong;
    }
    println!("{} sets, {vectors} vectors, {differ} mismatches", SETS.len());
    if differ == 0 { 0 } else { 3 }
}

entry!(run);
