//! Every function of the composer on random integers for its ports: what comes out is what came out before.

use roughxel_core::bundle::End;
use roughxel_core::design::{Design, Recorded, Visitor};
use roughxel_core::plan::{Effects, FootprintKind};
use roughxel_core::precision::{Precision, Profile};
use roughxel_core::scalar::Scalar;
use roughxel_core::width::{narrowed, widened};

use crate::random::Random;
use crate::walk::{bundle, limits, numbers};

/// Inputs of a design in a profile.
const INPUTS: usize = 200;

/// Words of both widths, and both kinds of probes and axes.
const PROFILES: [Profile; 4] = [Profile::Narrow, Profile::Paper, Profile::Standard, Profile::Precise];

/// The hash of all that a design makes of random inputs.
struct Outcomes<'a> {
    effects: &'a Effects,
    p: &'a Precision,
    random: Random,
}

impl Visitor for Outcomes<'_> {
    type Outcome = u64;
    fn visit<D: Recorded>(mut self) -> u64 {
        let (low, high) = (limits::<D::Input>(End::Low), limits::<D::Input>(End::High));
        let mut hash = 0;
        for _ in 0..INPUTS {
            let ends = low.iter().zip(&high);
            let input = ends.map(|(low, high)| self.random.within(low.integer, high.integer)).collect();
            let input: D::Input = bundle(input);
            let output = if self.p.word_bits() == 16 {
                numbers(&widened(&D::run::<i16>(&narrowed(&input), self.effects, self.p)))
            } else {
                numbers(&D::run::<Scalar>(&input, self.effects, self.p))
            };
            for number in output {
                hash = Random(hash ^ number.integer as u64).bits();
            }
        }
        hash
    }
}

pub(crate) fn what_a_design_makes_of_random_integers_hashes_to_what_it_did() {
    let mut found = String::new();
    for design in Design::ALL {
        let effects = &Effects { footprint: FootprintKind::Sphere, ..Effects::ALL };
        let hash = PROFILES.into_iter().fold(0, |hash, profile| {
            hash ^ design.visit(Outcomes { effects, p: &profile.precision(), random: Random(profile as u64) })
        });
        found += &format!("{} {hash:016x}\n", design.name());
    }
    assert!(found == HASHES, "{found}");
}

/// Of all profiles, line by line.
const HASHES: &str = "\
map_scale e20ef4f3b52e26a0
texture 2eb0a8de12f4b9a2
probe_reach 59083c4627fed082
texture_probe 931f7ba056e900ac
repeat_address adc0a8b48b89fccc
bump_texel 200e89848ed53113
bump_ramp d129b0b951fe2d00
bump_probe 1f80c38fe7a96ca9
bump e31ebf9da5cf74a0
fragment 3f78f818c2ee70b7
reflection 59532dcf222878a3
environment_probe 0f8858a19a484adc
sphere_probe e5b63b41dd7fe93e
levels b1d4a14d91bd8c62
face_address 4570df07e614a630
face_texels abb49d058985c613
corner 658f892b982ac94f
bright_texel fde3cb088a57f2ca
bright_corner 5052cd61d4db575c
colour_sample 393d50fbfd0cd24d
word_sample f7c68d3f33a36bb8
probe_sum 0fd2b254cd11eb62
probe_mean 08923600cb395b50
colour 24c9fdb750199901
modulated f9b1d8d08aee7448
lobe_core e2469ae1d309e0be
lobes dcdfbc36833d34f5
highlight df88e5d9a683e17b
lit_peak fb48eb2a369d5740
blend 215bcde72c9ef95d
bright_blend e62dee90befae518
local 2f33d9de6bb162fb
peak e649e2ceb3484555
horizon 1561cde90b4ef88a
pixel_sum 0e86c726d83e3a52
pixel 10fd88cc906c5e9b
";
