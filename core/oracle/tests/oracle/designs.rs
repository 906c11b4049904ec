//! Every function of the composer on random integers for its ports: the results equal the recorded ones.

use roughxel_core::bundle::End;
use roughxel_core::design::{Design, Recorded, Visitor};
use roughxel_core::plan::{Effects, FootprintKind};
use roughxel_core::precision::{AxisDirection, Newton, Precision, ProbeRule, ProbeWeights, RoughnessKind};
use roughxel_core::scalar::Scalar;
use roughxel_core::width::{narrowed, widened};

use roughxel_oracle::random::Random;
use roughxel_oracle::walk::{bundle, limits, numbers};

/// Inputs of a design in a profile.
const INPUTS: usize = 150;

/// Words of both widths, both kinds of probes and axes, and knobs at their ends.
const ACCURACIES: [Precision; 6] = [
    Precision::NARROW,
    Precision::PAPER,
    Precision::STANDARD,
    Precision::PRECISE,
    Precision {
        reciprocal: Newton { seed_bits: 10, steps: 2 },
        inverse_root: Newton { seed_bits: 10, steps: 2 },
        probe_weights: ProbeWeights::Gaussian,
        max_probes: 5,
        roughness: RoughnessKind::Isotropic,
        ..Precision::NARROW
    },
    Precision {
        fraction_bits: 28,
        reciprocal: Newton { seed_bits: 6, steps: 0 },
        inverse_root: Newton { seed_bits: 6, steps: 0 },
        direction: AxisDirection::Table { steps: 64 },
        probe_rule: ProbeRule::PowerOfTwo,
        probe_weights: ProbeWeights::Gaussian,
        max_probes: 11,
        weight_bits: 2,
        roughness: RoughnessKind::None,
        ..Precision::PRECISE
    },
];

/// The hash of everything that a design computes from random inputs.
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
        let hash = ACCURACIES
            .iter()
            .fold(0, |hash, p| Random(hash ^ design.visit(Outcomes { effects, p, random: Random(hash) })).bits());
        found += &format!("{} {hash:016x}\n", design.name());
    }
    assert!(found == HASHES, "{found}");
}

/// Hashes of all accuracies, line by line.
const HASHES: &str = "\
map_scale 00675eca7aca409c
texture cace816b2a9109af
probe_reach 5324401114e2a63b
texture_probe 45be8f22a0264d82
repeat_address 1f4819891d2c0ae8
bump_texel 646b4d7833a2110b
bump_ramp 650e145165955f54
bump_probe 1400588b734f2a9c
bump bfa6994398ec8c4d
fragment d12706e40716406e
reflection 32e6718c0d49c396
environment_probe fe95aa1b356b86c6
sphere_probe 92cd8d9d20c9c728
levels ece3fc7ec607c235
face_address 1017065634710a3d
face_texels 23af1a992bab86e3
corner 4c89b79ca6432ba7
bright_texel 6d5a48a0e63505ee
bright_corner e144dd65c70f8926
colour_sample 7eb3f3c176386cbd
word_sample c1830279a653b9f5
probe_sum 683daabf296f3635
probe_mean e77e72abba4c8ff2
colour e999028207527c7b
modulated 3ec665c72d71d6bf
lobe_law c0015af0eb730264
lobe 3451bdc5bfebb82e
lobes 8565694cd48de75e
highlight ae0a63637be2dce0
lit_peak f9f8277d3cf56529
blend b945f97c884e15ee
bright_blend e79865ae0333dd8a
local c4f6685c24d39210
peak 5e7db5c43b1ba38d
horizon f74872105702c4e9
pixel_sum 0efaa2fcfc2cad64
pixel bb4207c95a059b0f
";
