//! Stages alone, at inputs that random ports of a design seldom reach.

use roughxel_core::block::{Block, Number};
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::signals::{Axes, CountAndLevel};
use roughxel_core::small::Full;
use roughxel_core::stage::frame::main_direction;
use roughxel_core::stage::moments::to_roughness;
use roughxel_core::stage::sweep::{spread, sweep};
use roughxel_core::width::{of_ports, to_ports};
use roughxel_core::word::Word;

use roughxel_oracle::walk::numbers;

/// ±¾·2^e.
fn three_quarters<W: Word<Count = i32>>(e: i32, negative: bool) -> Number<W> {
    Block { m: [Fx::number(if negative { -3 } else { 3 }, -2)], e: Fx::int(e.into()) }
}

pub(crate) fn the_spread_of_axes_is_right_however_far_apart_they_are() {
    fn check<W: Word<Count = i32> + Into<i64>>(p: &Precision) {
        for apart in 0..=90 {
            let number = |e: i32| three_quarters::<W>(e, false);
            let axes = Axes { major: number(7), minor: number(7 - apart), direction: [Fx::int(1), Fx::zero()] };
            let raw: i64 = spread(&axes, p).raw().into();
            let found = raw as f64 / f64::from(W::BITS - 2).exp2();
            let exact = (1.0 - f64::from(-2 * apart).exp2()).sqrt();
            assert!((found - exact).abs() <= f64::from(3 - p.fraction_bits as i32).exp2(), "{apart}: {found} {exact}");
        }
    }
    check::<i32>(&Precision::STANDARD);
    check::<i32>(&Precision::PRECISE);
    check::<i16>(&Precision::NARROW);
}

pub(crate) fn a_roughness_is_a_number_up_to_four_with_the_bits_of_its_wide_wire() {
    // Its point has six bits before it.
    fn check<W: Word<Count = i32>>(fraction: i32) {
        for e in -30..=12 {
            for negative in [false, true] {
                let exact = if negative { -0.75 } else { 0.75 } * f64::from(e).exp2();
                let held = (exact * f64::from(fraction).exp2()).floor() / f64::from(fraction).exp2();
                let rounded = (held * 28_f64.exp2() + 0.5).floor();
                let four = 4.0 * 28_f64.exp2();
                let expected = if e > 2 { four.copysign(exact) } else { rounded };
                assert_eq!(f64::from(to_roughness(three_quarters::<W>(e, negative)).raw()), expected, "{e}");
            }
        }
    }
    check::<i32>(58);
    check::<i16>(26);
}

pub(crate) fn a_sweep_far_from_its_direction_has_a_level_that_far_up_to_its_bound() {
    let p = &Precision::STANDARD;
    let block = |m: [i64; 3], e: i64| Block::<i32, 3> { m: m.map(|m| Fx::number(m, -1)), e: Fx::int(e) };
    let zero = Fx::zero();
    let probes = CountAndLevel::<i32> { count: Fx::int(3), share: zero, level: zero, empty: false, capped: false };
    let level = |places: i64| {
        let [r, small] = [block([0, 0, 1], 40), block([0, 1, 0], 40 + places - 5)];
        sweep(&r, [&block([1, 0, 1], 40 + places), &small, &small], &probes, p).level.raw()
    };
    for places in [-9000, -8193, -8192, -8191, -77, -1, 0, 1, 77, 8191, 8192, 8193, 9000] {
        assert_eq!(level(places) - level(0), -(places.clamp(-8192, 8192) as i32) << 16, "{places}");
    }
}

pub(crate) fn a_backend_that_branches_has_the_frames_of_one_that_does_not() {
    let p = &Precision::STANDARD;
    let block = |m: [i32; 3]| Block::<i32, 3> { m: m.map(|m| Fx::from_raw(m << 20)), e: Fx::int(1) };
    for n in [[0, 0, 512], [300, -1, 512], [0, 512, 512], [-512, 3, 2]] {
        for h in [n, [512, 9, -77], [0; 3]] {
            let (n, h) = (block(n), block(h));
            let scalar = main_direction(&n, &h, p);
            let small = main_direction(&of_ports::<Full, _>(&n), &of_ports::<Full, _>(&h), p);
            let integers = |frame: &_| numbers(frame).iter().map(|number| number.integer).collect::<Vec<_>>();
            assert_eq!(integers(&to_ports::<Full, _>(&small)), integers(&scalar));
            // A pole also has a tangent basis, which is orthogonal to n except for the dropped bits.
            for e in [scalar.e1, scalar.e2] {
                let parts = |b: &Block<i32, 3>| b.m.map(|m| f64::from(m.raw()) / f64::from(1 << 30));
                let products = parts(&e).into_iter().zip(parts(&n)).map(|(e, n)| e * n);
                assert!(products.sum::<f64>().abs() < (-18_f64).exp2() && !e.is_zero(), "{n:?} {h:?}");
            }
        }
    }
}
