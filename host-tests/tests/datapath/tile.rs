//! The tile of a picture that the firmware draws, with the backends of the emulator.

use roughxel_core::bundle::Value;
use roughxel_core::plan::Effects;
use roughxel_core::ports::Port;
use roughxel_core::sampler::{self, Cube};
use roughxel_core::scalar_api::environment_scale;
use roughxel_core::width::on_words;
use roughxel_shader::{Ports, Shader};
use roughxel_simd::Backend;

#[path = "../../../core/oracle/tests/oracle/tile/drawn.rs"]
#[expect(unreachable_pub, dead_code, reason = "other tests that draw the tile use it")]
mod drawn;

use drawn::{EDGE, HASHES, Hash, SKY_EDGE, Sky};

#[test]
fn the_tile_of_the_firmware_is_that_of_the_emulator() {
    let mut places = Vec::new();
    let mut inputs = Vec::new();
    drawn::fragments(|y, fragment| {
        places.push([fragment.x, y]);
        inputs.push(fragment.reflection.wires());
    });
    // Most of the tile, but not all of it.
    let pixels = (EDGE * EDGE) as usize;
    assert!((pixels / 3..pixels).contains(&inputs.len()), "{} of {pixels} pixels", inputs.len());
    let cube = &Cube { memory: &Sky, edge: SKY_EDGE.into(), last_level: SKY_EDGE.ilog2(), exponent: 0 };
    for (profile, expected) in HASHES {
        let p = &profile.precision();
        let (plan, map) = (Effects::ALL.reflection(), environment_scale(SKY_EDGE, p));
        let ports = Ports::from_iter(inputs.iter().copied());
        for backend in [Backend::Scalar, Backend::best()] {
            let mut hash = Hash::default();
            for (place, footprint) in places.iter().zip(ports.footprints(Shader::new(backend, p), &map, &plan).iter()) {
                let (point, probes) = (&footprint.point, &footprint.probes);
                let colour = on_words!(p, |point, probes| sampler::environment(point, probes, true, cube, p));
                place.iter().copied().chain(colour.map(|Value(channel)| channel.raw())).for_each(|part| hash.add(part));
            }
            assert_eq!(hash, Hash(expected), "{} in {backend:?}: {:#010x}", profile.name(), hash.0);
        }
    }
}
