//! The number of probes against its definition.

use roughxel_core::block::{Block, MANTISSA};
use roughxel_core::fx::Fx;
use roughxel_core::precision::{Precision, ProbeRule};
use roughxel_core::signals::Axes;
use roughxel_core::stage::probes::{face_scale, probes};
use roughxel_host_tests::checked::Visible;
use roughxel_host_tests::space::whole_or;
use roughxel_utilities::random::SplitMix64;

/// Checks that N is the least for which N·λ₂ reaches λ₁ but for its noise, and that it is capped if `max_probes` do not.
#[test]
fn the_number_of_probes_is_the_least_that_reaches_the_major_axis() {
    number_of_probes_is_the_least::<i32>();
    number_of_probes_is_the_least::<i16>();
}

fn number_of_probes_is_the_least<W: Visible<Flag = bool>>() {
    let fraction = W::BITS - MANTISSA;
    let one = 1_i64 << fraction;
    // λ on a wide wire, with places for 16 times λ₂.
    let wide = |m: i64| i128::from(m) << (W::BITS - 4);
    let mut random = SplitMix64::for_element("number of probes", W::BITS.into());
    let mantissa = |bits: u64| one / 2 + (bits % (1 << (fraction - 1))) as i64;
    let precisions =
        (12..=fraction.min(28)).flat_map(|fraction_bits| (1..=16).map(move |max_probes| (fraction_bits, max_probes)));
    for (fraction_bits, max_probes) in precisions {
        let p = Precision { fraction_bits, max_probes, probe_rule: ProbeRule::Ceiling, ..Precision::STANDARD };
        let map = face_scale::<W>(Fx::int(256), &p);
        for _ in 0..whole_or(20_000, 500) {
            let (major, places) = (mantissa(random.next_u64()), (random.next_u64() % 6) as u32);
            // Half of the minor axes are as near to a part of the major one as a mantissa can be.
            let part = (major << places) / (1 + (random.next_u64() % 20) as i64) + (random.next_u64() % 3) as i64 - 1;
            let drawn = mantissa(random.next_u64());
            let minor = if (one / 2..=one).contains(&part) { part } else { drawn };
            let number = |m, e| Block { m: [Fx::lit(m)], e: Fx::int(e) };
            let direction = [Fx::zero(), Fx::lit(-one)];
            let axes = Axes { major: number(major, 0), minor: number(minor, -i64::from(places)), direction };
            let found = probes(&axes, &map, &p);
            let threshold = wide(major) - (wide(major) >> (p.fraction_bits - 4));
            let multiple = |n: u32| i128::from(n) * (wide(minor) >> places);
            let least = (1..p.max_probes).find(|&n| multiple(n) >= threshold).unwrap_or(p.max_probes);
            let capped = multiple(p.max_probes) < threshold;
            let count = W::count_integer(found.count.raw());
            assert_eq!((count, found.capped), (i64::from(least), capped), "{major} {minor} {places} with {p:?}");
        }
    }
}
