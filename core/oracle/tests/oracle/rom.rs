//! Every entry of every table against float64.

use std::f64::consts::{LN_2, PI};

use roughxel_core::rom::{
    BOX_SIGMA, BOX_WEIGHTS, EXP2, GAUSSIAN_WEIGHTS, HALF_LOG2_ONE_MINUS_RATIO, HALF_LOG2_ONE_PLUS_RATIO,
    INVERSE_ROOT_THREE, LOG2, LOG2_DIAMETER, LOG2_OF_COUNT, LOG2_TEXEL_ON_SPHERE, MAX_PROBES, NORMAL_PLACES,
    NORMAL_PLACES_OF_ONE_LESS, NORMAL_WIDENINGS, NORMAL_WIDENINGS_OF_ONE_LESS, ONE_OVER_COUNT, SPREAD_LIMIT,
    STEP_PER_SIGMA, SweepTable, inverse_root, reciprocal, sin_cos_of_right_angle, upper,
};

/// Asserts that an entry is the nearest number with that many fraction bits.
#[track_caller]
fn is_nearest(entry: i32, bits: i32, exact: f64) {
    let exact = exact * f64::from(bits).exp2();
    // Added to half a unit: the error of float64 itself, for 30 bits and after some hundred operations.
    assert!((f64::from(entry) - exact).abs() <= 0.5 + 1e-5, "{entry} is not {exact}");
}

pub(crate) fn an_entry_on_fewer_bits_is_rounded() {
    for entry in [0, 1, -1, 0x7fff, 0x8000, -0x8000, -0x8001, 0x1234_5678, -0x1234_5678, 0x3fff_8000] {
        assert_eq!(upper(entry, 32), entry);
        assert_eq!(f64::from(upper(entry, 16)), (f64::from(entry) / 65536.0 + 0.5).floor());
        assert_eq!(f64::from(upper(entry, 31)), (f64::from(entry) / 2.0 + 0.5).floor());
    }
}

pub(crate) fn seeds_are_reciprocals_and_inverse_roots_in_the_middle_of_their_intervals() {
    for bits in 6..=10 {
        let (count, kept) = (f64::from(bits).exp2(), bits as i32 + 2);
        let (reciprocals, roots) = (reciprocal(bits), inverse_root(bits));
        assert_eq!([reciprocals.len(), roots.len()], [1 << bits; 2]);
        for (i, (reciprocal, root)) in reciprocals.iter().zip(roots).enumerate() {
            // The table keeps two bits more of a seed than its index has.
            let seed = |entry: i32, exact: f64| {
                assert_eq!(entry.trailing_zeros().min(28 - bits), 28 - bits);
                is_nearest(entry >> (28 - bits), kept, exact);
            };
            seed(*reciprocal, 0.5 / (0.5 + (i as f64 + 0.5) / (2.0 * count)));
            let x = 0.25 + (i as f64 + 0.5) / count;
            seed(*root, if x < 1.0 { 0.5 / x.sqrt() } else { 0.5 });
        }
    }
    assert!(std::ptr::eq(reciprocal(0), reciprocal(6)) && std::ptr::eq(reciprocal(11), reciprocal(10)));
}

pub(crate) fn logarithms_and_powers_are_to_the_nearest() {
    for i in 0..=256 {
        let x = f64::from(i) / 256.0;
        is_nearest(LOG2[i as usize], 24, x.ln_1p() / LN_2);
        is_nearest(EXP2[i as usize], 30, x.exp2() / 2.0);
        // If the number is zero, the ratio is its limit.
        let ratio = |x: f64| if x == 0.0 { 0.5 / LN_2 } else { x.ln_1p() / LN_2 / x / 2.0 };
        is_nearest(HALF_LOG2_ONE_MINUS_RATIO[i as usize], 26, ratio(-x / 2.0));
        is_nearest(HALF_LOG2_ONE_PLUS_RATIO[i as usize], 26, ratio(x));
    }
    is_nearest(LOG2_TEXEL_ON_SPHERE, 16, (1.8 * 3_f64.sqrt()).log2());
    is_nearest(LOG2_DIAMETER, 16, 12_f64.log2() / 2.0);
}

pub(crate) fn sines_are_to_the_nearest_for_every_even_number_of_steps() {
    for steps in (2..=64).step_by(2) {
        for numerator in 0..=steps {
            let angle = PI / 2.0 * f64::from(numerator) / f64::from(steps);
            let (sin, cos) = sin_cos_of_right_angle(numerator, steps);
            is_nearest(sin, 30, angle.sin());
            is_nearest(cos, 30, angle.cos());
        }
    }
    for (numerator, steps) in [(0, 0), (1, 66), (66, 64)] {
        assert_eq!(sin_cos_of_right_angle(numerator, steps), (0, 1 << 30));
    }
}

pub(crate) fn constants_of_a_count_of_probes_are_to_the_nearest() {
    for n in 1..=MAX_PROBES {
        let count = n as f64;
        is_nearest(STEP_PER_SIGMA[n], 28, 12_f64.sqrt() / count);
        is_nearest(SPREAD_LIMIT[n], 30, (1.0 - 1.0 / (count * count)).sqrt());
        is_nearest(ONE_OVER_COUNT[n], 16, 1.0 / count);
        is_nearest(LOG2_OF_COUNT[n], 16, count.log2());
    }
    for table in [&STEP_PER_SIGMA, &SPREAD_LIMIT, &ONE_OVER_COUNT, &LOG2_OF_COUNT] {
        assert_eq!(table[0], table[1]);
    }
    is_nearest(BOX_SIGMA, 30, 12_f64.sqrt().recip());
    is_nearest(INVERSE_ROOT_THREE, 30, 3_f64.sqrt().recip());
}

pub(crate) fn running_sums_of_weights_are_to_the_nearest() {
    for n in 1..=MAX_PROBES {
        for (table, gaussian) in [(&BOX_WEIGHTS, false), (&GAUSSIAN_WEIGHTS, true)] {
            let row = &table[MAX_PROBES * (n - 1)..][..MAX_PROBES];
            let weights: Vec<f64> = (0..n)
                .map(|i| {
                    let offset = (2.0 * i as f64 - n as f64 + 1.0) * 3_f64.sqrt() / n as f64;
                    if gaussian { (-offset * offset / 2.0).exp() } else { 1.0 }
                })
                .collect();
            let (mut given, mut running) = (0, 0.0);
            for (entry, weight) in row.iter().zip(&weights) {
                given += entry;
                running += weight;
                is_nearest(given, 16, running / weights.iter().sum::<f64>());
            }
            assert!(given == 1 << 16 && row[n..].iter().all(|entry| *entry == 0));
        }
    }
}

/// Density of the normal distribution.
fn density(x: f64) -> f64 {
    (-x * x / 2.0).exp() / (2.0 * PI).sqrt()
}

/// Quantile of the normal distribution: the point with that share below it.
fn quantile(share: f64) -> f64 {
    // ½ + the series of the integral from 0.
    let below = |x: f64| {
        let terms = (0..60).scan(x, |power, k| {
            let term = *power / f64::from(2 * k + 1);
            *power *= -x * x / f64::from(2 * (k + 1));
            Some(term)
        });
        0.5 + terms.sum::<f64>() / (2.0 * PI).sqrt()
    };
    let (mut low, mut high) = (-3.0, 3.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if below(middle) < share { low = middle } else { high = middle }
    }
    low
}

/// Means of equal parts of the normal distribution, stretched, and the squares by which they are wider than the middle part.
fn parts(n: usize) -> [Vec<f64>; 2] {
    let count = n as f64;
    let edges: Vec<f64> = (1..n).map(|i| quantile(i as f64 / count)).collect();
    let at = |i: usize| if i == 0 || i == n { (0.0, 0.0) } else { (edges[i - 1], density(edges[i - 1])) };
    let of_part = |i: usize| {
        let ((below, low), (above, high)) = (at(i), at(i + 1));
        let mean = (low - high) * count;
        (mean, 1.0 + (below * low - above * high) * count - mean * mean)
    };
    let (means, variances): (Vec<f64>, Vec<f64>) = (0..n).map(of_part).unzip();
    let wider: Vec<f64> = variances.iter().map(|v| (v - variances[n / 2]) * 0.6).collect();
    let squares: f64 = means.iter().map(|mean| mean * mean).sum();
    let stretch = ((count - wider.iter().sum::<f64>()) / squares).sqrt();
    [means.iter().map(|mean| mean * stretch).collect(), wider]
}

pub(crate) fn probes_of_a_sweep_are_parts_of_the_normal_law() {
    for n in 1..=MAX_PROBES {
        let [means, wider] = if n == 1 { [vec![0.0], vec![0.0]] } else { parts(n) };
        for i in 0..MAX_PROBES {
            let place = MAX_PROBES * (n - 1) + i;
            let (mean, wider) = if i < n { (means[i], wider[i]) } else { (0.0, 0.0) };
            is_nearest(NORMAL_PLACES[place], 28, mean);
            let ratio = n as f64 - 1.25;
            is_nearest(NORMAL_WIDENINGS[place], 16, (1.0 + wider * ratio * ratio).log2() / 2.0);
        }
    }
}

pub(crate) fn probes_of_a_sweep_come_from_those_of_one_less() {
    let tables: [(&SweepTable, &SweepTable); 2] =
        [(&NORMAL_PLACES, &NORMAL_PLACES_OF_ONE_LESS), (&NORMAL_WIDENINGS, &NORMAL_WIDENINGS_OF_ONE_LESS)];
    for (own, of_one_less) in tables {
        let row = |table: &SweepTable, n: usize| table[MAX_PROBES * (n - 1)..][..n].to_vec();
        for n in 1..=2 {
            assert_eq!(row(of_one_less, n), row(own, n));
        }
        for n in 3..=MAX_PROBES {
            // The new probe and its neighbours in the middle come from the middle.
            let mut expected = row(own, n - 1);
            expected.insert(n / 2, 0);
            if n % 2 == 0 {
                // For even n, the single middle probe of n − 1 gives way to two.
                expected[n / 2 - 1] = 0;
            }
            assert_eq!(row(of_one_less, n), expected, "{n}");
        }
    }
}
