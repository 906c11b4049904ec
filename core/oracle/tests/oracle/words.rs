//! Words and their consumers: the algebra on integers, the backend for small processors, narrower words, memories.

use std::cell::Cell;

use roughxel_core::block::{Block, Mantissa, Number, dot};
use roughxel_core::bundle::{Bundle, End, Rewire, Step, Value, bundle, flag_limit, never};
use roughxel_core::each::places;
use roughxel_core::fetch::{Fetch, two};
use roughxel_core::fx::{Fx, Wide};
use roughxel_core::small::{Full, Half, WideFull, WideHalf, leading_zeros_by_table, product_by_adds, product_by_table};
use roughxel_core::width::{IntegerWord, narrowed, of_ports, to_ports, widened};
use roughxel_core::word::{WideWire, Wire, Word};

use roughxel_oracle::random::Random;
use roughxel_oracle::walk::{limits, numbers};

/// Integers of every size, both signs.
fn of_every_size(random: &mut Random) -> i64 {
    random.bits() as i64 >> random.below(64)
}

pub(crate) fn leading_zeros_by_table_are_those_of_the_processor() {
    for place in 0..32 {
        for low in 0..1 << 16 {
            // Every 16-bit number at every place, above ones and above zeros.
            for x in [(low << place) | ((1 << place) - 1), low << place] {
                assert_eq!(leading_zeros_by_table(x), x.leading_zeros(), "{x:#x}");
            }
        }
    }
}

pub(crate) fn products_without_a_multiplier_are_exact() {
    let mut random = Random(2);
    // Every value of both halves of one factor meets every value of either half of the other factor.
    for a in i16::MIN..=i16::MAX {
        let [high, low] = a.to_be_bytes().map(|half| i16::from(half as i8));
        let ends = [0, 1, -1, 255, 256, -256, i16::MIN, i16::MAX, 0x5a5a, !a, a.rotate_left(8), random.bits() as i16];
        let halves = [(high & 0xff, low & 0xff), (high << 8, low << 8)];
        for (a, b) in ends.into_iter().map(|b| (a, b)).chain(halves) {
            assert_eq!(product_by_table(a.into(), b.into()), i32::from(a) * i32::from(b), "{a} {b}");
        }
    }
    let by_adds = |a: i32, b: i32| assert_eq!(product_by_adds(a, b), i64::from(a) * i64::from(b), "{a} {b}");
    for _ in 0..20_000 {
        let [a, b] = [(); 2].map(|()| of_every_size(&mut random) as i32);
        for factor in [b, i32::MIN, 0, 255, 256, 0xffff, 0x10000] {
            for a in [a, i32::MIN] {
                by_adds(a, factor);
            }
            // Without their last ten bits; of one factor alone and of both.
            by_adds(a >> 10 << 10, factor);
            by_adds(a >> 10 << 10, factor >> 10 << 10);
        }
    }
    // Every factor of 16 bits at the bottom, in the middle and at the top of a word meets ends of the range and a number of no pattern.
    let any = random.bits() as i32;
    for short in i32::from(i16::MIN)..=i32::from(i16::MAX) {
        for factor in [short, short << 10, short << 16] {
            for long in [1, i32::MIN, i32::MAX, i32::MIN + 0x400, i32::MAX - 0x3ff, any, any >> 10 << 10] {
                by_adds(long, factor);
                by_adds(factor, long);
            }
        }
    }
}

pub(crate) fn words_of_small_processors_round_and_normalise_as_the_others_do() {
    let mut random = Random(3);
    for _ in 0..30_000 {
        let (drop, up) = (1 + random.below(31) as u32, random.below(20) as u32);
        let word = of_every_size(&mut random) as i32 >> up << up;
        let wide = (i64::from(word) << drop).saturating_add(of_every_size(&mut random) >> (64 - drop));
        if i64::from(word) + (1 << up) <= i64::from(i32::MAX) {
            assert_eq!(Full::round(WideFull(wide), drop, up).0, i32::round(wide, drop, up), "{wide} {drop} {up}");
        }
        let (drop, up) = (drop.min(16), up.min(3));
        let word = word >> 16 >> up << up;
        let wide = (word << drop).saturating_add((random.bits() as i64 >> 32 >> (32 - drop)) as i32);
        if word + (1 << up) <= i32::from(i16::MAX) {
            assert_eq!(Half::round(WideHalf(wide), drop, up).0, i32::from(i16::round(wide, drop, up)), "{wide}");
        }
    }
    for turn in 0..20_000 {
        let any = [(); 3].map(|()| of_every_size(&mut random));
        let places = random.below(32);
        let wide = match turn % 9 {
            0 => any.map(|w| w >> places),
            1 => [any[0], 0, 0],
            2 => [-1, 0, any[2] >> 63],
            3 => [0; 3],
            4 => [i64::MIN; 3],
            5 => [i64::MAX >> places, any[0], 0],
            6 => [i64::MAX >> places >> 32; 3],
            7 => [1 << places, 0, -1 << places],
            _ => any,
        };
        let up = random.below(19) as u32;
        let (words, zeros, all_zero) = WideFull::normalised(wide.map(WideFull), 33, up);
        assert_eq!((words.map(|word| word.0), zeros.0, all_zero), i64::normalised(wide, 33, up), "{wide:?} {up}");
        let (narrow, up) = (wide.map(|w| (w >> 32) as i32), up.min(3));
        let (words, zeros, all_zero) = WideHalf::normalised(narrow.map(WideHalf), 17, up);
        let (scalar, scalar_zeros, scalar_all_zero) = i32::normalised(narrow, 17, up);
        assert_eq!(
            (words.map(|word| word.0), zeros.0, all_zero),
            (scalar.map(i32::from), scalar_zeros, scalar_all_zero),
            "{narrow:?} {up}"
        );
    }
}

pub(crate) fn wires_of_small_processors_are_integers_of_their_bits() {
    fn check<W: Word<Flag = bool>>(integer: impl Fn(W) -> i64, of: impl Fn(i64) -> W, x: i64, k: u32) {
        let wire = of(x);
        assert_eq!(integer(wire), x);
        assert_eq!(integer(wire.sar(k)), x >> k);
        assert_eq!(wire.lt(of(0)), x < 0);
        assert_eq!(integer(W::narrow(wire.widen())), x);
        assert_eq!(integer(W::select(x < 0, W::lit(0).sub(wire), wire).sar(1)), x.abs() >> 1);
        assert_eq!(integer(wire.and(of(255))), x & 255);
    }
    let mut random = Random(4);
    for _ in 0..2000 {
        let (x, k) = (of_every_size(&mut random), random.below(15) as u32);
        check::<Full>(|w| w.0.into(), |x| Full(x as i32), i64::from(x as i32).max(-i64::from(i32::MAX)), k);
        check::<Half>(|w| w.0.into(), |x| Half(x as i32), i64::from(x as i16).max(-i64::from(i16::MAX)), k);
        check::<i32>(i64::from, |x| x as i32, i64::from(x as i32).max(-i64::from(i32::MAX)), k);
        check::<i16>(i64::from, |x| x as i16, i64::from(x as i16).max(-i64::from(i16::MAX)), k);
        let (word, half) = (x as i32, x as i16);
        assert_eq!(Full(word).leading_zeros().0, word.leading_zeros() as i32);
        assert_eq!(Half(half.into()).leading_zeros().0, half.leading_zeros() as i32);
        assert_eq!(WideHalf(word).leading_zeros().0, word.leading_zeros() as i32);
        assert_eq!(WideFull(x).leading_zeros().0, x.leading_zeros() as i32);
        assert_eq!(Full(word).mul(Full(half.into())).0, i64::from(word) * i64::from(half));
        assert_eq!(Half(half.into()).mul(Half(half.into())).0, i32::from(half) * i32::from(half));
    }
}

bundle! {
    /// A wire of each kind.
    pub struct Kinds<W> {
        /// A mantissa.
        #[range(-1..=1)]
        word: Fx<W, 2>,
        /// A control wire.
        #[range(-3..8)]
        control: [Control<W, 16>; 2],
        /// A wide wire.
        #[range(0..1)]
        wide: WideControl<W, 32>,
        /// A wide wire without a range.
        all: WideControl<W, 40>,
        /// A word without a range.
        any: Int<W>,
        /// A flag.
        flag: W::Flag,
    }
}

fn kinds(random: &mut Random, flag: bool) -> Kinds<i32> {
    Kinds {
        word: Fx::from_raw(random.bits() as i32),
        control: [(); 2].map(|()| Fx::from_raw(random.bits() as i32)),
        wide: Fx::from_raw(random.bits() as i64),
        all: Fx::from_raw(random.bits() as i64),
        any: Fx::from_raw(random.bits() as i32),
        flag,
    }
}

/// The integers of a bundle.
fn integers(bundle: &impl Bundle<i32>) -> Vec<i64> {
    numbers(bundle).iter().map(|number| number.integer).collect()
}

pub(crate) fn bundles_keep_every_bit_on_words_of_every_backend_but_the_lower_half_of_narrow_words() {
    fn through<W: IntegerWord>(bundle: &Kinds<i32>) -> Vec<i64> {
        integers(&to_ports::<W, _>(&of_ports::<W, _>(bundle)))
    }
    let mut random = Random(5);
    for turn in 0..200 {
        let bundle = &kinds(&mut random, turn % 2 == 0);
        let whole = integers(bundle);
        assert_eq!(through::<i32>(bundle), whole);
        assert_eq!(through::<Full>(bundle), whole);
        let mut rounded = whole.clone();
        rounded[0] = ((whole[0] + 0x8000) >> 16 << 16).min(0x7fff_0000);
        assert_eq!(through::<i16>(bundle), rounded);
        assert_eq!(through::<Half>(bundle), rounded);
        assert_eq!(integers(&widened(&narrowed(bundle))), rounded);
    }
    for (port, word) in [
        (i32::MAX, i16::MAX),
        (0x7fff_8000, i16::MAX),
        (0x7fff_7fff, i16::MAX),
        (0x7ffe_8000, i16::MAX),
        (0x7ffe_7fff, i16::MAX - 1),
        (i32::MIN, i16::MIN),
        (0x7fff, 0),
        (0x8000, 1),
        (-0x8000, 0),
        (-0x8001, -1),
    ] {
        assert_eq!(i16::of_port(port), word);
        assert_eq!(Half::of_port(port), Half(word.into()));
    }
    assert!((i16::MIN..=i16::MAX).all(|word| i16::of_port(word.to_port()) == word));
}

pub(crate) fn limits_are_the_ends_of_the_declared_ranges() {
    let unit = |bits: u32| 1_i64 << bits;
    let of = |end| limits::<Kinds<i32>>(end).iter().map(|number| number.integer).collect::<Vec<_>>();
    let low = [-unit(30), -3 * unit(16), -3 * unit(16), 0, i64::MIN, i32::MIN.into(), 0];
    assert_eq!(of(End::Low), low);
    let high = [unit(30), 8 * unit(16) - 1, 8 * unit(16) - 1, unit(32) - 1, i64::MAX, i32::MAX.into(), 1];
    assert_eq!(of(End::High), high);
    assert_eq!([flag_limit::<i32>(End::Low), flag_limit::<i32>(End::High), never::<i32>()], [false, true, false]);
    assert_eq!([End::Low.of_bits(5), End::High.of_bits(5)], [-16, 15]);
    assert_eq!([End::Low.of_bits(64), End::High.of_bits(64)], [i64::MIN, i64::MAX]);

    let fraction_bits: Vec<u32> = limits::<Kinds<i32>>(End::Low).iter().map(|number| number.fraction_bits).collect();
    assert_eq!(fraction_bits, [30, 16, 16, 32, 24, 0, 0]);
    let paths = limits::<[Kinds<i32>; 2]>(End::Low);
    assert_eq!([&paths[0].path, &paths[9].path, &paths[13].path], ["[0].word", "[1].control[1]", "[1].flag"]);
    let fx = limits::<[Fx<i32, 2>; 3]>(End::High);
    assert!(fx.len() == 3 && fx[2].integer == i64::from(i32::MAX));
}

pub(crate) fn a_bundle_says_how_many_words_it_takes() {
    assert_eq!(<Kinds<i32> as Bundle<i32>>::WORDS, 9);
    assert_eq!(<[Kinds<i32>; 3] as Bundle<i32>>::WORDS, 27);
    assert_eq!(<Option<Fx<i32, 2>> as Bundle<i32>>::WORDS, 1);
    assert_eq!(<Block<i32, 3> as Bundle<i32>>::WORDS, 4);
}

pub(crate) fn a_part_that_is_left_out_has_no_wires() {
    let some = Some(Value::<i32, 8>(Fx::lit(5)));
    assert_eq!(integers(&some), [5]);
    assert_eq!(integers(&None::<Value<i32, 8>>), [0; 0]);
    assert_eq!(limits::<Option<Value<i32, 8>>>(End::High).len(), 1);
    assert_eq!(integers(&widened(&narrowed(&some))), [5]);
}

pub(crate) fn a_walk_need_not_know_where_it_is() {
    /// The sum of all words.
    struct Sum(i64);
    impl Rewire<i32, i32> for Sum {
        fn word(&mut self, wire: i32, _: u32) -> i32 {
            self.0 += i64::from(wire);
            wire
        }
        fn control(&mut self, wire: i32, fraction_bits: u32) -> i32 {
            self.word(wire, fraction_bits)
        }
        fn wide(&mut self, wire: i64, _: u32) -> i64 {
            wire
        }
        fn flag(&mut self, wire: bool) -> bool {
            wire
        }
    }
    let mut sum = Sum(0);
    let part = sum.part(Step::Index(0), &[Value::<i32, 8>(Fx::lit(5)), Value(Fx::lit(6))]);
    assert_eq!((sum.0, part[1].0.raw()), (11, 6));
}

pub(crate) fn blocks_are_equal_where_mantissas_and_exponents_are() {
    let block = |m: [i32; 2], e: i32| Block::<i32, 2> { m: m.map(Fx::from_raw), e: Fx::from_raw(e) };
    assert!(block([1, 2], 3) == block([1, 2], 3));
    assert!(block([1, 2], 3) != block([1, 2], 4));
    assert!(block([1, 2], 3) != block([1, 1], 3));
    assert!(Block::select(true, block([1, 2], 3), block([0, 0], 0)) == block([1, 2], 3));
    assert!(block([1, 2], 3).scaled(Fx::int(-5)) == block([1, 2], -2));
    let is_zero = [block([0, 0], 7), block([1, 0], 7), block([0, -1], 7), block([1, 1], 7)].map(|b| b.is_zero());
    assert_eq!(is_zero, [true, false, false, false]);
    assert_eq!(Number::<i32>::one().m[0].raw(), 1 << 29);
    assert_eq!(Number::<i32>::one().at_point::<8>().raw(), 1 << 56);
    let v = [3, -4].map(Mantissa::<i32>::from_raw);
    assert_eq!(dot(&v, &v).raw(), 25);
}

pub(crate) fn places_count_from_zero() {
    assert_eq!(places::<4>(), [0, 1, 2, 3]);
}

pub(crate) fn wires_with_a_point_are_integers_shifted() {
    let mut random = Random(6);
    for _ in 0..2000 {
        let raw = of_every_size(&mut random) as i32;
        let x = Fx::<i32, 4>::from_raw(raw);
        for fraction_bits in [20, 27, 28, 29] {
            let drop = 28_u32.saturating_sub(fraction_bits);
            let expected = if drop == 0 { raw } else { ((raw >> (drop - 1)) + 1) >> 1 << drop };
            assert_eq!(x.quantise(fraction_bits).raw(), expected);
            for k in [0, 1, 5, 31] {
                // Rounded once, after the bits below the kept ones are dropped.
                let cut = i64::from(raw >> drop);
                let expected = (((cut * 2) >> k) + 1) >> 1 << drop;
                assert_eq!(
                    i64::from(x.round_shr_by(Fx::int(k), fraction_bits).raw()),
                    expected,
                    "{raw} {fraction_bits} {k}"
                );
            }
        }
        assert_eq!(x.index(3).raw(), raw >> 25);
        assert_eq!(x.index(28).raw(), raw);
        assert_eq!(x.index(30).raw(), raw << 2);
        assert_eq!(Fx::<i32, 4>::of_index(Fx::from_raw(raw), 3).raw(), raw << 25);
        assert_eq!(Fx::<i32, 4>::of_index(Fx::from_raw(raw), 30).raw(), raw >> 2);
        assert_eq!(x.to_control::<2>().raw(), raw << 2);
        assert_eq!(x.to_control::<8>().raw(), raw >> 4);
        assert_eq!(Fx::<i32, 4>::of_control(Fx::<i32, 8>::from_raw(raw)).raw(), raw << 4);
        assert_eq!(Fx::<i32, 4>::of_control(Fx::<i32, 2>::from_raw(raw)).raw(), raw >> 2);
        assert_eq!(x.widen::<4>().raw(), i64::from(raw) << 32);
        assert_eq!(x.widen::<36>().raw(), i64::from(raw));
        let wide = Wide::<i32, 8>::from_raw(random.bits() as i64 >> 1);
        // 56 fraction bits, of which a word with 8 bits before its point keeps 24.
        let kept = |fraction_bits: u32| ((wide.raw() >> (55 - fraction_bits)) + 1) >> 1 << (24 - fraction_bits);
        assert_eq!(i64::from(wide.round_to::<8>(20).raw()), kept(20));
        assert_eq!(i64::from(wide.round_to_control::<8>(24).raw()), kept(24));
        // If more bits are asked for than there are, all are kept.
        assert_eq!([24, 25, 31].map(|fraction_bits| i64::from(wide.round_to::<8>(fraction_bits).raw())), [kept(24); 3]);
        assert_eq!(wide.at_exponent::<12>(Fx::int(3)).raw(), wide.raw() >> 1);
        assert_eq!(wide.at_exponent::<12>(Fx::int(4)).raw(), wide.raw());
        assert_eq!(wide.at_exponent::<12>(Fx::int(5)).raw(), wide.raw());
        assert_eq!(wide.at_exponent::<12>(Fx::int(-90)).raw(), wide.raw() >> 62);
        assert_eq!(Wide::<i32, 8>::wide_of_control(Fx::<i32, 8>::from_raw(raw)).raw(), i64::from(raw) << 32);
        // The same on 16-bit words, whose wide companion has 32 bits.
        let narrow = raw as i16;
        assert_eq!(Fx::<i16, 4>::from_raw(narrow).to_control::<4>().raw(), i32::from(narrow) << 16);
        assert_eq!(Fx::<i16, 4>::from_raw(narrow).to_control::<30>().raw(), i32::from(narrow) >> 10);
        assert_eq!(i32::from(Fx::<i16, 4>::of_control(Fx::<i32, 4>::from_raw(raw)).raw()), raw >> 16);
        assert_eq!(Fx::<i32, 8>::from_raw(raw).round_to_control::<8>(24).raw(), raw);
        assert_eq!(Fx::<i32, 8>::from_raw(raw).round_to_control::<4>(24).raw(), raw << 4);
        assert_eq!(Fx::<i32, 8>::from_raw(raw).round_to_control::<10>(20).raw(), ((raw >> 3) + 1) >> 1 << 2);
        let wide = Wide::<i16, 8>::wide_of_control(Fx::<i32, 4>::from_raw(raw));
        assert_eq!(wide.raw(), raw >> 4);
        let wide = Wide::<i16, 8>::wide_of_control(Fx::<i32, 12>::from_raw(raw));
        assert_eq!(wide.raw(), raw << 4);
    }
    type X = Fx<i32, 4>;
    assert_eq!([X::int(-3).raw(), X::number(5, -2).raw(), X::below(3).raw()], [-3 << 28, 5 << 26, (3 << 28) - 1]);
    let (low, high) = (X::int(-2), X::int(3));
    assert_eq!([X::int(-5), X::int(1), X::int(5)].map(|x| x.saturate(low, high)), [low, X::int(1), high]);
    assert!(high.ge(high) && high.ge(low) && !low.ge(high) && low.lt(high) && !low.lt(low));
    assert_eq!([X::lit(-1), X::lit(0), X::lit(1)].map(|x| x.is_zero()), [false, true, false]);
    assert_eq!(
        [low.abs(), high.abs(), high.negate_if(true), -low, high - low, low + high].map(|x| x.raw() >> 28),
        [2, 3, -3, 2, 5, 1]
    );
    assert_eq!(<Fx<i16, 4>>::entry(0x1234_8000).raw(), 0x1235);
}

pub(crate) fn a_memory_is_read_at_its_end_where_a_place_is_beyond_it() {
    let memory: [u64; 5] = std::array::from_fn(|place| 0x1111_1111_0000_0001 * (place as u64 + 1));
    let memory = &memory[..];
    for place in 0..4 {
        assert_eq!(two(memory, place), memory[place as usize..][..2]);
    }
    for place in [4, 5, 6, -1, i32::MAX, i32::MIN] {
        assert_eq!(two(memory, place), memory[3..]);
    }
    let pair = |place: i32, memory: &[u64]| <i32 as Fetch>::load_pair(Fx::from_raw(place), memory).map(Fx::raw);
    assert_eq!(pair(0, memory), [1, 0x1111_1111, 2, 0x2222_2222]);
    assert_eq!(pair(9, memory), [4, 0x4444_4444, 5, 0x5555_5555]);
    assert_eq!(pair(0, &memory[..2]), [1, 0x1111_1111, 2, 0x2222_2222]);
    assert_eq!(pair(0, &memory[..1]), [0; 4]);
}

pub(crate) fn a_backend_of_one_fragment_takes_its_own_turns() {
    let table = &std::array::from_fn(|i| 100 + i as i32);
    for index in [0, 7, 15, 16, -1] {
        assert_eq!(<i32 as Fetch>::entry(Fx::from_raw(index), table).raw(), 100 + (index & 15));
    }
    assert_eq!(<i32 as Fetch>::max_over_lanes(Fx::from_raw(13)), 13);
    let (index, counts) = <i32 as Fetch>::loop_index(4, Fx::from_raw(13));
    assert_eq!((index.raw(), counts), (4, true));
    assert_eq!([true, false].map(<i32 as Fetch>::any), [true, false]);
    assert_eq!([true, false].map(<i32 as Fetch>::known), [true, false]);
    let row: [Cell<i32>; 3] = Default::default();
    for (place, word) in [(0, 3), (2, -4), (3, 5), (-1, 6)] {
        <Full as Fetch>::scatter(Fx::from_raw(Full(word)), Fx::from_raw(Full(place)), &row);
    }
    assert_eq!(row.each_ref().map(Cell::get), [3, 0, -4]);
    let taken = [0, 1, 2, 3, -1].map(|place| <Full as Fetch>::gather(Fx::from_raw(Full(place)), &row).raw());
    assert_eq!(taken, [Full(3), Full(0), Full(-4), Full(0), Full(0)]);
    assert_eq!(<Full as Fetch>::per_lane([Full(3), Full(-4)], |[a, b]| [a - b]), [Full(7)]);
}
