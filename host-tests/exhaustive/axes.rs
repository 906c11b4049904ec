//! Axes from K: every 8-bit covariance, with determinants that its columns may have had.

use roughxel_core::block::{Block, Number, PRODUCT, number};
use roughxel_core::fx::{Fx, Wide};
use roughxel_core::precision::{AxisDirection, Precision, Profile};
use roughxel_core::signals::Ellipse;
use roughxel_core::stage::axes::axes;
use roughxel_core::word::Wire;
use roughxel_host_tests::checked::Visible;
use roughxel_reference::ellipse::Ellipse as Matrix;
use roughxel_reference::linear::{axis_angle, norm};

use super::bounds::Bounds;
use super::{Checked8, FRACTION, ONE, Tried, mantissas, real, tiny_precisions, try_all};

/// Mantissa and exponent of λ₁ and λ₂, the direction, and the given determinant.
type Found = ([(i64, i64); 2], [i64; 2], (i64, i64));

/// The axes of K·2^e with the determinant `det`·2^2e on a wide wire, rounded as the ellipse rounds it.
fn axes_of<W: Visible>(k: [i64; 3], e: i64, det: i64, p: &Precision) -> Found {
    let k = Block::<W, 3> { m: k.map(Fx::lit), e: Fx::int(e) };
    let det: Wide<W, PRODUCT> = Fx::from_raw(Wire::lit(det));
    let det = number(det, Fx::int(2 * e), p.fraction_bits);
    let axes = axes(&Ellipse { k, det }, p);
    let pair = |x: Number<W>| (x.m[0].raw().integer(), W::count_integer(x.e.raw()));
    ([axes.major, axes.minor].map(pair), axes.direction.map(|d| d.raw().integer()), pair(det))
}

/// Bars of one K in units of its mantissas: relative errors of λ₁ and λ₂, radians of the direction, error of its length. The largest errors of 1/√
/// and √ are given.
fn bars(k: &Matrix, [inverse, root]: [f64; 2], p: &Precision) -> [f64; 4] {
    let half = Bounds::new(*p, FRACTION).half_place();
    let relative = 2.0 * half;
    // One place of a value with 6 bits before its point on a wide wire.
    let place = (-2.0 * f64::from(FRACTION) + 2.0).exp2();
    // (a − c, 2b) with mantissas from ½ up is rounded by half a place a component; so are its square length and the root.
    let length = (k.a - k.c).hypot(2.0 * k.b);
    let turned = 2.0 * 2.0_f64.sqrt() * half;
    let root_of_squares = (1.0 + relative).sqrt() * (1.0 + root) - 1.0;
    let h = (1.0 + turned) * (1.0 + root_of_squares) - 1.0;
    // Three floors: of the mean, of h and of half of h.
    let square = 0.5 * (k.a + k.c + length);
    let square_error = (h * length / 2.0 + 3.0 * place) / square;
    let square_error = (1.0 + square_error) * (1.0 + relative) - 1.0;
    let major = (1.0 + square_error).sqrt() * (1.0 + root) - 1.0;
    // √det times 1/λ₁, rounded. 1/√(1 − x) is steeper for downward errors.
    let minor = (1.0 + root) * (1.0 + inverse) * (1.0 - square_error).powf(-0.5) * (1.0 + relative) - 1.0;

    let unit = (1.0 + inverse) * (1.0 - relative).powf(-0.5) - 1.0;
    let components = 2.0_f64.sqrt() * (half + place);
    let angle = match p.direction {
        AxisDirection::Exact => {
            // Half the angle by which the doubled direction turns. h against |a − c| is worst at 45°: sin α/|w| is ½ over h. w and the components
            // are rounded. A cosine is clamped to 1 only if the sine is √(2·unit) at most.
            let cut = unit * (2.0 * unit).sqrt();
            let of_h = (root_of_squares * 2.0_f64.sqrt() + place) / 2.0_f64.sqrt();
            turned / 2.0 + of_h + turned + components + cut
        }
        // One step of the table: its entries and boundaries are rounded, the latter for the doubled angle.
        AxisDirection::Table { steps } => {
            45.0_f64.to_radians() / f64::from(steps) + turned / 2.0 + 1.5 * 2.0_f64.sqrt() * half
        }
    };
    [major, minor, angle, unit + components]
}

/// Checks the axes of one K with one determinant.
fn hold(tried: &mut Tried<4>, k: [i64; 3], e: i64, det: i64, bars: &[f64; 4], p: &Precision) {
    let input = (k, e, det);
    tried.inputs += 1;
    let got = axes_of::<Checked8>(k, e, det, p);
    assert_eq!(got, axes_of::<i8>(k, e, det, p), "{input:?}");
    let ([major, minor], direction, det) = got;
    let value = |(m, e): (i64, i64)| real(m) * (e as f64).exp2();
    let scale = (e as f64).exp2();
    let [a, b, c] = k.map(|m| real(m) * scale);
    let want = roughxel_reference::axes::axes(&Matrix { a, b, c, det: value(det) });
    let (major, minor) = (value(major), value(minor));
    assert!(major >= minor && minor >= 0.0, "{input:?}");
    // λ₂ by its formula; if it exceeds λ₁, the two change places, which makes no error larger than the larger one.
    let want_minor = value(det).sqrt() / want.major;
    let [low, high] = [want_minor.min(want.major), want_minor.max(want.major)];
    let either = bars[0].max(bars[1]);
    let swapped = want_minor * (1.0 + bars[1]) > want.major * (1.0 - bars[0]);
    tried.hold(0, (major / high - 1.0).abs(), if swapped { either } else { bars[0] }, input);
    if det.0 == 0 {
        assert_eq!(minor, 0.0, "{input:?}");
    } else {
        tried.hold(1, (minor / low - 1.0).abs(), if swapped { either } else { bars[1] }, input);
    }

    let [x, y] = direction;
    if b == 0.0 && a == c {
        assert_eq!(direction, [ONE, 0], "a circle: {input:?}");
        return;
    }
    assert!(x.abs() <= ONE && y.abs() <= ONE, "{input:?}");
    // The larger component is positive except at 45°, where roundings decide which one is larger. The product of the two has the sign of b.
    assert!(real(x.max(y)) >= -real(x.min(y)) - 2.0_f64.sqrt() * bars[2], "{input:?}: {direction:?}");
    assert!(x == 0 || y == 0 || ((x < 0) != (y < 0)) == (b < 0.0), "{input:?}: {direction:?}");
    let direction = direction.map(real);
    tried.hold(2, axis_angle(direction, want.direction), bars[2], (input, direction));
    tried.hold(3, (norm(&direction) - 1.0).abs(), bars[3], (input, direction));
}

/// Every K that can result from squares of columns: b² ≤ a·c except for half a place of each.
fn covariances(p: &Precision) -> Vec<[i64; 3]> {
    let place = 1 << (FRACTION - p.fraction_bits);
    let diagonal = mantissas(p).filter(|&m| m >= 0);
    let mut list = Vec::new();
    for (a, c) in diagonal.clone().flat_map(|a| diagonal.clone().map(move |c| (a, c))) {
        let largest = a.max(c);
        if largest >= ONE / 2 {
            let possible = |b: &i64| {
                let least = (2 * b.abs() - place).max(0);
                b.abs() <= largest && least * least <= (2 * a + place) * (2 * c + place)
            };
            list.extend(mantissas(p).filter(possible).map(|b| [a, b, c]));
        }
    }
    list
}

#[test]
fn axes_of_every_covariance_are_right() {
    let mut inputs = 0;
    // With 4 bits, a component over its length is 35/32 at most, beyond its claim.
    for p in tiny_precisions().filter(|p| p.fraction_bits > 4) {
        for direction in [AxisDirection::Exact, AxisDirection::Table { steps: 10 }] {
            let p = Precision { direction, ..p };
            let place = 1 << (FRACTION - p.fraction_bits);
            let list = covariances(&p);
            let roots = Bounds::new(p, FRACTION).worst_roots();
            let tried = try_all(list.chunks(256), |tried, chunk| {
                for &k in chunk {
                    let [a, b, c] = k;
                    let matrix = Matrix { a: real(a), b: real(b), c: real(c), det: 0.0 };
                    let bars = bars(&matrix, roots, &p);
                    // No determinant, that of K itself, and the largest one that may have been rounded to K.
                    let least_b = (2 * b.abs() - place).max(0);
                    let most = ((2 * a + place) * (2 * c + place) - least_b * least_b) / 4;
                    for det in [0, (a * c - b * b).max(0), most] {
                        for e in [0, 1] {
                            hold(tried, k, e, det, &bars, &p);
                        }
                    }
                }
            });
            let name = format!("axes, p {}, {:?}, {direction:?}", p.fraction_bits, p.inverse_root);
            tried.report(&name, ["λ₁", "λ₂", "angle", "length"], 6 * list.len() as u64);
            inputs += tried.inputs;

            let ([major, minor], direction, _) = axes_of::<Checked8>([0; 3], -1 << 15, 0, &p);
            assert_eq!((major.0, minor.0, direction), (0, 0, [ONE, 0]), "no footprint");
        }
    }
    eprintln!("axes: {inputs} inputs");
}

/// a = c and b < 0: (√½, −√½). By the formula, h and |2b| are its larger and smaller component, and roundings can exchange them.
///
/// In places of 2^−p: h errs by 4.6 (twice the error of 1/2√x), 1 (the root) and ½ (the square length) of itself, which is 4.3 of a component. The
/// two roundings of h and |2b| add 1.4 and 1. Measured: 3.
#[test]
fn at_45_degrees_downwards_the_negative_component_is_larger_by_7_places_at_most() {
    for p in Profile::ALL.map(Profile::precision) {
        let place = 1 << (30 - p.fraction_bits);
        // The 16-bit mantissas.
        let excesses = (1..=1 << 16).map(|b| {
            let k = Block::<i32, 3> { m: [1 << 30, -(b << 14), 1 << 30].map(Fx::from_raw), e: Fx::int(0) };
            let [x, y] = axes(&Ellipse { k, det: Block::zero() }, &p).direction.map(Fx::raw);
            (-y - x) / place
        });
        let (inputs, most) = excesses.fold((0, 0), |(inputs, most), excess| (inputs + 1, most.max(excess)));
        eprintln!("45° downwards, p {}: {inputs} inputs, {most} places at most", p.fraction_bits);
        assert_eq!(inputs, 65_536);
        // A table has both components as its last entry.
        assert!(most <= if p.direction == AxisDirection::Exact { 7 } else { 0 }, "p {}: {most}", p.fraction_bits);
    }
}
