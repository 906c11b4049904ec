//! Domain of a test's claim: every named profile, every plan, any bits at the ports.

use fixed::types::{I2F30, I4F28};
use roughxel_core::plan::{
    Datapath, Effects, FootprintKind, FrameSystem, HorizonKind, PeakPlan, ReflectionPlan, SurfacePlan,
};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::{Precision, Profile, RoughnessKind};
use roughxel_utilities::random::SplitMix64;

const FRAMES: [FrameSystem; 3] = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];
/// Every footprint.
const FOOTPRINTS: [FootprintKind; 3] = [FootprintKind::None, FootprintKind::Face, FootprintKind::Sphere];
/// Every horizon.
const HORIZONS: [HorizonKind; 3] = [HorizonKind::None, HorizonKind::Correlated, HorizonKind::Product];
const ROUGHNESS: [RoughnessKind; 3] = [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic];

/// Returns true if tests run over their whole domain: set by `cargo full`. Otherwise they run over a part of it that is quick.
pub fn is_full_run() -> bool {
    std::env::var_os("ROUGHXEL_FULL").is_some()
}

/// Returns the amount that a test tries: `all` in a full run, otherwise `part`.
pub fn whole_or<T>(all: T, part: T) -> T {
    if is_full_run() { all } else { part }
}

/// Returns true if the list element is tested with a profile: every element in a full run, otherwise one per profile, in turn.
pub fn in_turn(index: usize, profile: &str) -> bool {
    is_full_run() || Profile::NAMES[index % Profile::NAMES.len()] == profile
}

/// Every named profile.
pub fn profiles() -> [(&'static str, Precision); Profile::ALL.len()] {
    Profile::ALL.map(|profile| (profile.name(), profile.precision()))
}

/// The profiles with 32-bit words.
pub fn wide_profiles() -> Vec<(&'static str, Precision)> {
    profiles().into_iter().filter(|(_, p)| p.word_bits() == 32).collect()
}

/// Every combination of the effects of a reflection: 72 plans.
pub fn plans() -> Vec<ReflectionPlan> {
    let mut plans = Vec::new();
    for frame in FRAMES {
        for roughness in ROUGHNESS {
            for switches in 0..12 {
                let [bump, curvature] = [0, 1].map(|bit| switches >> bit & 1 == 1);
                let footprint = FOOTPRINTS[switches >> 2];
                plans.push(ReflectionPlan { bump, frame, roughness, curvature, footprint });
            }
        }
    }
    plans
}

/// Every combination of the effects of a datapath; a design outside of all datapaths has a single combination.
pub fn effects(datapath: Option<Datapath>) -> Vec<Effects> {
    let switch = [false, true];
    match datapath {
        None => vec![Effects::NONE],
        Some(Datapath::Reflection) => plans().into_iter().map(Effects::from).collect(),
        Some(Datapath::Highlight) => {
            let surfaces = FRAMES.iter().flat_map(|&frame| {
                ROUGHNESS.iter().flat_map(move |&roughness| {
                    switch.map(|bump| SurfacePlan { bump, frame, roughness, local: false }.into())
                })
            });
            surfaces.collect()
        }
        Some(Datapath::Peak) => {
            FRAMES.iter().flat_map(|&frame| HORIZONS.map(|horizon| PeakPlan { frame, horizon }.into())).collect()
        }
    }
}

/// Any word, with weight on the ends of its range, single bits, runs of ones, and neighbours of 1 as a mantissa.
pub fn any_word(random: &mut SplitMix64) -> i32 {
    let power = 1_i64 << random.below(32);
    let word = match random.below(12) {
        0 => 0,
        1 => i64::from(i32::MIN) + random.below(3) as i64,
        2 => i64::from(i32::MAX) - random.below(3) as i64,
        3 => power,
        4 => -power,
        5 => power - 1,
        6 => 1 - power,
        7 => (1 << 30) - power,
        8 => power - (1 << 30),
        _ => i64::from(random.next_u64() as i32) >> random.below(31),
    };
    word.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

/// Any exponent: mostly near zero, often at the ends of the port.
pub fn any_exponent(random: &mut SplitMix64) -> i16 {
    match random.below(8) {
        0 => i16::MIN,
        1 => i16::MAX,
        2 => random.next_u64() as i16,
        3 => random.below(130) as i16 - 65,
        _ => random.below(9) as i16 - 4,
    }
}

/// Vectors of any bits. Some repeat a component, and half of the time two vectors are alike, so that ties, parallels and equal sums occur.
pub fn any_vectors<const COUNT: usize>(random: &mut SplitMix64) -> [BlockVector; COUNT] {
    let is_even = random.below(8) == 0;
    let mut vectors = [(); COUNT].map(|()| {
        if is_even {
            let mantissa = [(); 3].map(|()| I2F30::from_bits(random.next_u64() as i32));
            return BlockVector { mantissa, exponent: random.next_u64() as i16 };
        }
        let mut mantissa = [(); 3].map(|()| any_word(random));
        if random.below(3) == 0 {
            mantissa[1] = mantissa[0];
        }
        if random.below(4) == 0 {
            mantissa[2] = mantissa[0].wrapping_neg();
        }
        BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent: any_exponent(random) }
    });
    if random.below(2) == 0 {
        let [from, to] = [(); 2].map(|()| random.below(COUNT as u64) as usize);
        let exponent = vectors[[from, to][random.below(2) as usize]].exponent;
        vectors[to] = BlockVector { exponent, ..vectors[from] };
    }
    vectors
}

/// Any bits at any port.
pub fn any_fragment(random: &mut SplitMix64) -> ReflectionIn {
    let [normal, view, first, second, vx, vy, nx, ny] = any_vectors(random);
    let [b1, b2, d1, d2, d3] = [(); 5].map(|()| I4F28::from_bits(any_word(random)));
    ReflectionIn {
        surface: SurfaceIn { normal, view, frame_vectors: [first, second], offset: [b1, b2], roughness: [d1, d2, d3] },
        dview: [vx, vy],
        dnormal: [nx, ny],
        edge_texels: random.next_u64() as u16 >> random.below(16),
    }
}
