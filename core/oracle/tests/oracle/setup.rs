//! Real numbers to ports and back.

use fixed::types::{I1F15, I2F30, I4F12, I4F28};
use glam::{DVec2, DVec3};
use roughxel_core::ports::{BlockPort, StoredHorizon, StoredPeak};
use roughxel_core::precision::{Precision, Profile};
use roughxel_core::setup::{
    AMPLITUDE_LIMIT, RealPeak, block_vector, offset, real_horizon, real_number, real_offset, real_pair, real_peak,
    real_vector, scale_by_power_of_two, shininess, stored_horizon, stored_peak, stored_unit_peak, uniform_law,
};

use roughxel_oracle::random::Random;

/// 2^exponent.
fn power(exponent: i32) -> f64 {
    f64::from(exponent).exp2()
}

/// A number of random magnitude and either sign.
fn any(random: &mut Random, exponents: std::ops::Range<i32>) -> f64 {
    let exponent = exponents.start + random.below((exponents.end - exponents.start) as u64) as i32;
    (random.bits() as i64 as f64) * power(exponent - 63)
}

pub(crate) fn scaling_by_powers_of_two_is_exact_to_the_ends_of_float64() {
    for (x, exponent, expected) in [
        (1.0, 0, 1.0),
        (-1.5, 4, -24.0),
        (3.0, -1, 1.5),
        (1.0, 1023, f64::MAX / 2.0 + f64::MAX / 2.0_f64.powi(54)),
        (power(-1000), 1500, power(500)),
        (power(-1000), 2023, power(1023)),
        (power(1000), -2000, power(-1000)),
        (power(1000), -2022, power(-1022)),
        (power(1000), -2074, power(-1074)),
        (power(1000), -2080, 0.0),
        (1.0, -1074, power(-1074)),
        (power(60), -2100, 0.0),
        (1.0, 2048, f64::INFINITY),
        (1.0, -40_000, 0.0),
        (1.0, 40_000, f64::INFINITY),
    ] {
        let found = scale_by_power_of_two(x, exponent);
        assert!(found == expected || (exponent == 1023 && found == power(1023)), "{x} {exponent}: {found}");
    }
}

pub(crate) fn a_vector_as_a_port_is_rounded_to_the_bits_of_the_profile() {
    let mut random = Random(1);
    for profile in Profile::ALL {
        let p = &profile.precision();
        for index in 0..3000 {
            let exponents = if index % 2 == 0 { -1060..1000 } else { -3..4 };
            let shift = any(&mut random, exponents);
            let v = DVec3::from_array([(); 3].map(|()| any(&mut random, -2..2))) * shift;
            check_vector(v, p);
        }
        // A largest component that rounds up to the next octave, and one that does not.
        let half_unit = power(-(p.fraction_bits as i32) - 1);
        for x in [1.0 - half_unit, 1.0 - half_unit * 1.001, 1.0, 0.5, 1.0 - 2.0 * half_unit, -1.0, half_unit - 1.0] {
            check_vector(DVec3::new(x, 0.25 + half_unit, -0.25 - half_unit), p);
            check_vector(DVec3::new(x * power(-1073), 0.0, 0.0), p);
            check_vector(DVec3::new(x * power(1023), 0.0, 0.0), p);
        }
        for none in [DVec3::ZERO, DVec3::new(f64::INFINITY, 1.0, 0.0), DVec3::new(0.0, f64::NEG_INFINITY, 2.0)] {
            assert_eq!(block_vector(none, p), BlockPort::default());
        }
    }
}

fn check_vector(v: DVec3, p: &Precision) {
    let port = block_vector(v, p);
    if v == DVec3::ZERO {
        return assert_eq!(port, BlockPort::default());
    }
    let bits = p.fraction_bits;
    let mantissas = port.mantissa.map(I2F30::to_bits);
    assert!(mantissas.iter().all(|m| m.trailing_zeros() >= 30 - bits));
    let largest = mantissas.iter().map(|m| m.unsigned_abs()).max().expect("three mantissas");
    assert!((1 << 29..=1 << 30).contains(&largest), "{v} {port:?}");
    // 1 is 1/2 of the next octave. −1 is not rounded up to, and may stay.
    assert!(mantissas.iter().all(|m| *m < 1 << 30), "{v} {port:?}");
    for (x, m) in v.to_array().into_iter().zip(mantissas) {
        let scaled = scale_by_power_of_two(x, i32::from(bits as i16) - i32::from(port.exponent));
        assert_eq!(m >> (30 - bits), (scaled + 0.5).floor() as i32, "{v} {port:?}");
    }
    if v.abs().max_element() > power(-1000) && v.abs().max_element() < power(1000) {
        let error = (real_vector(&port) - v).abs().max_element();
        assert!(error <= 0.5 * power(i32::from(port.exponent) - bits as i32), "{v} {port:?}");
    }
}

pub(crate) fn the_real_numbers_of_ports_are_mantissas_at_their_exponents() {
    let mantissa = [3 << 28, -(1 << 30), 1].map(I2F30::from_bits);
    let v = BlockPort { mantissa, exponent: 3 };
    assert_eq!(real_vector(&v), DVec3::new(6.0, -8.0, power(-27)));
    let [a, b, _] = mantissa;
    assert_eq!(real_pair(&BlockPort { mantissa: [a, b], exponent: -1 }), DVec2::new(0.375, -0.5));
    assert_eq!(real_number(&BlockPort { mantissa: [b], exponent: 1024 }), -f64::INFINITY);
    assert_eq!(real_number(&BlockPort { mantissa: [a], exponent: 1023 }), 0.75 * power(1023));
    assert_eq!(real_number(&BlockPort { mantissa: [a], exponent: 0 }), 0.75);
    assert_eq!(real_offset(I4F28::from_bits(-(3 << 28))), -3.0);
    assert_eq!(real_offset(I4F28::from_bits(1)), power(-28));
}

pub(crate) fn an_offset_is_rounded_to_its_bits_and_saturated() {
    let mut random = Random(2);
    for profile in Profile::ALL {
        let p = &profile.precision();
        let bits = p.offset_bits() as i32;
        for _ in 0..1000 {
            let x = any(&mut random, -20..5);
            let port = offset(x, p);
            assert_eq!(port.to_bits().trailing_zeros().min(28 - bits as u32), 28 - bits as u32);
            let units = (x * power(bits) + 0.5).floor().clamp(-8.0 * power(bits), 8.0 * power(bits) - 1.0);
            assert_eq!(real_offset(port) * power(bits), units, "{x}");
        }
        assert_eq!(real_offset(offset(1e9, p)), 8.0 - power(-bits));
        assert_eq!(real_offset(offset(-1e9, p)), -8.0);
        assert_eq!(real_offset(offset(8.0, p)), 8.0 - power(-bits));
    }
}

pub(crate) fn shininess_has_the_exponent_and_its_root_to_the_nearest() {
    let mut random = Random(3);
    let many = (0..20_000).map(|_| (random.below(13 << 20) as f64 / power(20)).exp2());
    let squares = (1..=90).map(|root| f64::from(root * root));
    let ends = [1.0, 8192.0, 8191.99, 1.0 + power(-16), 2.5 + power(-17), 2.5 + power(-18)];
    // Less than a last float64 place from the square of an integer that is the nearest integer to their root.
    let beside = [4096.0 - power(-16), 4096.0 + power(-16)];
    let bits = (1 << 16..=1 << 29).step_by(9973).chain((256..=23_170).map(|root| root * root));
    let ports = bits.map(|bits: u32| f64::from(bits) / 65536.0);
    for m in many.chain(squares).chain(ends).chain(beside).chain(ports) {
        let port = shininess(m);
        assert_eq!(f64::from(port.exponent.to_bits()), (m * 65536.0 + 0.5).floor());
        // To the bit: no integer is nearer to the root.
        let (root, square) = (i128::from(port.root.to_bits()), i128::from(port.exponent.to_bits()) << 34);
        assert!((2 * root - 1).pow(2) < square && square < (2 * root + 1).pow(2), "{m}: {root}");
    }
    for (read, as_one) in [(0.0, 1.0), (-5.0, 1.0), (f64::NAN, 1.0), (0.999, 1.0), (1e9, 8192.0)] {
        assert_eq!(shininess(read), shininess(as_one));
    }
}

/// The numbers that a 16-bit code can be: twelve fraction bits, four exponent bits.
fn of_code(code: u16) -> f64 {
    let (c, f) = (i32::from(code >> 12), f64::from(code & 0xfff));
    if c == 0 { f } else { (f + 4096.0) * power(c - 1) }
}

pub(crate) fn amplitudes_and_exponents_are_the_nearest_codes() {
    let up = DVec3::Z;
    for code in 0..=u16::MAX {
        let value = of_code(code);
        let decoded = real_peak(&StoredPeak { amplitude: code, exponent: code, ..StoredPeak::default() });
        assert_eq!((decoded.amplitude, decoded.exponent), (value * power(-21), value * power(-13)));
        let next = of_code(code.saturating_add(1));
        for (share, expected) in [(0.0, code), (0.49, code), (0.51, code.saturating_add(1))] {
            let x = value + (next - value) * share;
            let stored = stored_unit_peak(up, x * power(-21), 1.0);
            assert_eq!(stored.amplitude, expected, "{x}");
            assert_eq!(real_peak(&stored).amplitude, of_code(expected) * power(-21));
            let m = x * power(-13);
            if m >= 1.0 {
                let stored = stored_unit_peak(up, 1.0, m);
                let most = stored_unit_peak(up, 1.0, 8192.0).exponent;
                assert_eq!(stored.exponent, expected.min(most));
                assert_eq!(real_peak(&stored).exponent, of_code(stored.exponent) * power(-13));
            }
        }
    }
    assert_eq!(real_peak(&stored_unit_peak(up, 1.0, 0.1)).exponent, 1.0);
    assert_eq!(real_peak(&stored_unit_peak(up, 1.0, 1e6)).exponent, 8192.0);
    assert_eq!(stored_unit_peak(up, 1e30, 1.0).amplitude, 0xffff);
    assert_eq!(stored_unit_peak(up, -1.0, 1.0).amplitude, 0);
    assert_eq!(stored_unit_peak(up, f64::NAN, 1.0).amplitude, 0);
    let largest = real_peak(&stored_peak(up, f64::INFINITY, f64::INFINITY));
    assert_eq!((largest.amplitude, largest.exponent), (8191.0 / 128.0, 8192.0));
    // Half of the smallest unit rounds to one unit, less rounds to zero.
    assert_eq!(stored_unit_peak(up, power(-22), 1.0).amplitude, 1);
    assert_eq!(stored_unit_peak(up, power(-22) * 0.999, 1.0).amplitude, 0);
    // The code after the last one.
    assert_eq!((of_code(0xffff) + power(14)) * power(-21), AMPLITUDE_LIMIT);
}

pub(crate) fn the_normal_of_a_stored_peak_has_unit_length_whatever_came() {
    for scale in [1.0, 1e-300, 1e300, 7.0] {
        let v = DVec3::new(0.36, -0.48, 0.8);
        let stored = stored_peak(v * scale, 2.0, 3.0);
        let RealPeak { normal, amplitude, exponent } = real_peak(&stored);
        assert!((normal - v).abs().max_element() <= power(-16) + 1e-9, "{normal}");
        assert_eq!((amplitude, exponent), (2.0, 3.0));
    }
    // A port cannot hold 1; the largest number stands in for it.
    let ends = stored_unit_peak(DVec3::new(1.0, -1.0, 0.0), 1.0, 1.0).normal;
    assert_eq!(ends, [I1F15::MAX, I1F15::MIN, I1F15::ZERO]);
    let rounded = stored_unit_peak(DVec3::new(1.5 * power(-15), 1.49 * power(-15), -1.5 * power(-15)), 1.0, 1.0).normal;
    assert_eq!(rounded.map(I1F15::to_bits), [2, 1, -1]);
    let none = stored_peak(DVec3::ZERO, 2.0, 3.0);
    assert_eq!((none.normal, none.amplitude), ([I1F15::ZERO; 3], 0));
    for none in [DVec3::NAN, DVec3::INFINITY, DVec3::new(0.0, f64::NEG_INFINITY, 1.0)] {
        assert_eq!(stored_peak(none, 2.0, 3.0).amplitude, 0, "{none}");
    }
    assert!(stored_peak(DVec3::new(0.0, 0.0, -9.0), 2.0, 3.0).amplitude > 0);
}

pub(crate) fn a_horizon_has_slopes_and_inverse_widths() {
    let low = [-1.5, 0.25, 1.5 * power(-12), 9.0];
    let stored = stored_horizon(low, [2.0, 0.5, 1e-9, 0.0]);
    let codes = stored.low.map(I4F12::to_bits);
    assert_eq!(codes, [-6144, 1024, 2, i16::MAX]);
    let (lows, inverses) = real_horizon(&stored);
    assert_eq!(lows, [-1.5, 0.25, power(-11), 8.0 - power(-12)]);
    // The largest code stands in for steeper slopes; a side without a width has no slope.
    assert_eq!(inverses, [Some(0.5), Some(2.0), Some(of_code(0xffff) * power(-14)), None]);
    // At its largest, a width is one: code 0 says that there is none.
    let wide = stored_horizon([-20.0; 4], [1e9, -1.0, f64::INFINITY, 3.0]);
    assert_eq!(wide.inverse_width[..3], [1, 0, 1]);
    assert_eq!(wide.low, [I4F12::MIN; 4]);
    assert_eq!(real_horizon(&StoredHorizon::OPEN), ([-8.0; 4], [None; 4]));
    let one = StoredHorizon { inverse_width: [1; 4], ..StoredHorizon::OPEN };
    assert_eq!(real_horizon(&one).1, [Some(power(-14)); 4]);
}

pub(crate) fn a_uniform_law_has_its_mean_and_deviation() {
    for (mean, sigma) in [(0.0, 1.0), (3.0, 0.5), (-2.0, 0.0)] {
        let [low, width] = uniform_law(mean, sigma);
        assert!((low + width / 2.0 - mean).abs() < 1e-12);
        assert!((width / 12_f64.sqrt() - sigma).abs() < 1e-12);
    }
}
