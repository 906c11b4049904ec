//! Ellipse of two columns: every pair of 4-bit blocks at every difference of exponents that matters, and of 5-bit blocks at equal exponents.

use roughxel_core::block::{Block, ZERO_EXPONENT};
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::stage::ellipse::ellipse;
use roughxel_host_tests::checked::Visible;

use super::bounds::Bounds;
use super::{Checked8, FRACTION, ONE, Tried, mantissas, real, tiny, try_all};

/// A block's mantissas and exponent.
type Column = ([i64; 2], i64);

/// K with its exponent, and det K with its own.
fn covariance<W: Visible>(columns: [Column; 2], p: &Precision) -> ([i64; 3], i64, i64, i64) {
    let block = |(m, e): Column| Block::<W, 2> { m: m.map(Fx::lit), e: Fx::int(e) };
    let ellipse = ellipse(columns.map(block), p);
    let exponent = |e: Fx<W::Count, 32>| W::count_integer(e.raw());
    let (k, det) = (ellipse.k, ellipse.det);
    (k.m.map(|m| m.raw().integer()), exponent(k.e), det.m[0].raw().integer(), exponent(det.e))
}

/// Every block of two mantissas, zero last.
fn blocks(p: &Precision) -> Vec<[i64; 2]> {
    let pairs = mantissas(p).flat_map(|x| mantissas(p).map(move |y| [x, y]));
    let mut blocks: Vec<_> = pairs.filter(|[x, y]| x.abs().max(y.abs()) >= ONE / 2).collect();
    blocks.push([0; 2]);
    blocks
}

/// Checks the ellipse of two columns, the first one 2^`above` larger.
fn hold(tried: &mut Tried<2>, columns: [[i64; 2]; 2], above: i64, p: &Precision) {
    let exponents = [above, 0];
    let given = [0, 1].map(|i| (columns[i], if columns[i] == [0; 2] { ZERO_EXPONENT } else { exponents[i] }));
    tried.inputs += 1;
    let got = covariance::<Checked8>(given, p);
    assert_eq!(got, covariance::<i8>(given, p), "{given:?}");
    let (k, k_e, det, det_e) = got;
    if columns == [[0; 2]; 2] {
        assert_eq!((k, det), ([0; 3], 0));
        return;
    }
    let half_place = Bounds::new(*p, FRACTION).half_place();
    let q = [0, 1].map(|i| columns[i].map(|m| real(m) * (exponents[i] as f64).exp2()));
    let of = |i: usize, j: usize| q[0][i] * q[0][j] + q[1][i] * q[1][j];
    let want = [of(0, 0), of(0, 1), of(1, 1)];
    let unit = (k_e as f64).exp2();
    let [a, b, c] = k.map(|m| real(m) * unit);
    // "Error of K: 2^−(p−2) of its larger diagonal". The smaller column is rounded by half a place at mantissas of at most ½. If the larger
    // diagonal is at least ¼, that is slightly more than 2^-p of it. The rounding of K is as much.
    let larger = want[0].max(want[2]);
    for (got, want) in [a, b, c].into_iter().zip(want) {
        tried.hold(0, (got - want).abs(), 8.0 * half_place * larger, given);
    }
    // K before its rounding is a sum of squares of the rounded columns, so b² ≤ a·c except for half a place each.
    let half = half_place * unit;
    assert!(a >= 0.0 && c >= 0.0, "{given:?}");
    assert!((b.abs() - half).max(0.0).powi(2) <= (a + half) * (c + half), "{given:?}");

    let det = real(det) * (det_e as f64).exp2();
    // The minor is rounded, by at most 2^−p of it, and so is its square.
    let roundings = (1.0 + 2.0 * half_place).powi(2) * (1.0 + 2.0 * half_place);
    assert!((0.0..=(a + half) * (c + half) * roundings).contains(&det), "{given:?}: {det}");
    let minor = q[0][0] * q[1][1] - q[1][0] * q[0][1];
    // Alignment moves a component of the smaller column by half a place of the larger column.
    let (larger, shift) = if above >= 0 { (q[0], above) } else { (q[1], 0) };
    let moved = if above == 0 || columns.contains(&[0; 2]) { 0.0 } else { half_place * (shift as f64).exp2() };
    let moved = moved * (larger[0].abs() + larger[1].abs());
    let bar = (minor.abs() + moved) * roundings.sqrt() - minor.abs();
    let error = (det.sqrt() - minor.abs()).abs();
    // Parallel columns have exactly no area.
    assert!(moved > 0.0 || (det == 0.0) == (minor == 0.0), "{given:?}: {det}");
    if bar > 0.0 {
        tried.hold(1, error, bar, given);
    }
}

const FIGURES: [&str; 2] = ["K", "√det"];

#[test]
fn ellipse_of_every_two_columns_of_4_bits_is_right() {
    let p = tiny(4, 0);
    let blocks = blocks(&p);
    // A column p + 2 places below the other vanishes.
    let most = i64::from(p.fraction_bits) + 2;
    let tried = try_all(blocks.iter(), |tried, &first| {
        for &second in &blocks {
            let differences = if first == [0; 2] || second == [0; 2] { 0..=0 } else { -most..=most };
            for above in differences {
                hold(tried, [first, second], above, &p);
            }
        }
    });
    let count = 33 * 33 - 15 * 15;
    tried.report("ellipse, p 4", FIGURES, count * count * 13 + 2 * count + 1);
}

#[test]
fn ellipse_of_every_two_columns_of_5_bits_and_one_exponent_is_right() {
    let p = tiny(5, 0);
    let blocks = blocks(&p);
    let tried = try_all(blocks.iter(), |tried, &first| {
        for &second in &blocks {
            hold(tried, [first, second], 0, &p);
        }
    });
    let count = 65 * 65 - 31 * 31 + 1;
    tried.report("ellipse, p 5", FIGURES, count * count);
}
