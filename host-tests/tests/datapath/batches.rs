//! Rows of a batch, and values read from them without a walk.

use roughxel_core::bundle::{Bundle, End, Value};
use roughxel_core::datapath::texel::Bump;
use roughxel_core::fx::Fx;
use roughxel_core::ports::PortBlock;
use roughxel_core::signals::{Probes, Sweep, TexturePosition};
use roughxel_shader::{Batch, BlockRows, Derivatives, FaceFootprint, FilteredBump};
use roughxel_simd::LANES;

use super::lanes::same_wires;

#[test]
fn rows_of_columns_begin_with_a_cache_line_however_they_grow() {
    let mut columns = Batch::<[Value<i32, 32>; 3]>::default();
    for number in 0..1000 {
        columns.push(&[number, -number, 7].map(|word| Value(Fx::from_raw(word))));
        let is_aligned = |row: &[i32]| row.as_ptr().align_offset(64) == 0;
        assert!(columns.rows_of(|words| *words).all(is_aligned), "{number}");
    }
    assert!(
        columns.row_of(|words| words[1].0).iter().copied().eq((0..1000).map(|number: i32| -number)),
        "what there was is kept"
    );
}

/// The memory holds a different batch, whose words are −1. It reveals a part that is written to the wrong row, or an upper word that keeps old
/// data.
#[test]
fn rows_that_are_appended_by_name_are_the_bundles_of_their_lanes() {
    let row = |first: i32| -> [i32; LANES] { core::array::from_fn(|lane| first + 1000 * lane as i32) };
    let block = |first: i32| BlockRows {
        mantissa: [0, 1, 2].map(|component| row(first + component)),
        exponent: row(first + 3),
    };
    let port = |rows: &BlockRows<3>, lane: usize| PortBlock::<i32, 3> {
        mantissa: rows.mantissa.map(|row| Fx::from_raw(row[lane])),
        exponent: Fx::from_raw(rows.exponent[lane]),
    };
    let (dview, dnormal) = ([block(10), block(20)], [block(30), block(40)]);
    let minus_one = port(&BlockRows { mantissa: [[-1; LANES]; 3], exponent: [-1; LANES] }, 0);
    let mut derivatives = Batch::<Derivatives<i32>>::default();
    derivatives.append_same(LANES, &Derivatives { dview: [minus_one; 2], dnormal: [minus_one; 2] });
    derivatives.clear();
    derivatives.append(LANES, |to| {
        for side in [0, 1] {
            to.block(|derivatives| derivatives.dnormal[side], &dnormal[side]);
            to.block(|derivatives| derivatives.dview[side], &dview[side]);
        }
    });
    let mut centres = Batch::<TexturePosition<i32>>::default();
    centres.append_same(LANES, &TexturePosition { uv: [Fx::from_raw(-1); 2] });
    centres.clear();
    centres.append(LANES, |to| {
        to.low(|centre| centre.uv[1], &row(-7));
        to.low(|centre| centre.uv[0], &row(5));
    });
    for lane in 0..LANES {
        let [dview, dnormal] = [dview, dnormal].map(|rows| rows.map(|rows| port(&rows, lane)));
        same_wires(&Derivatives { dview, dnormal }, &derivatives.get(lane))
            .unwrap_or_else(|wire| panic!("{lane}: {wire}"));
        let uv = [row(5), row(-7)].map(|row| Fx::from_raw(row[lane].cast_unsigned().into()));
        same_wires(&TexturePosition { uv }, &centres.get(lane)).unwrap_or_else(|wire| panic!("{lane}: {wire}"));
    }
    let named = derivatives.rows_of(|derivatives| derivatives.dnormal[1]);
    assert!(named.eq((12..16).map(|word| derivatives.row(word))), "the last block of four");
}

#[test]
fn columns_know_their_words() {
    let blank = PortBlock { mantissa: [Fx::from_raw(0); 3], exponent: Fx::from_raw(3) };
    let one = PortBlock { mantissa: [0, 0, 1].map(Fx::from_raw), ..blank };
    for (dview, dnormal, is_flat) in [([one; 2], [blank; 2], true), ([blank; 2], [blank, one], false)] {
        assert_eq!(Batch::from_iter([Derivatives { dview, dnormal }]).is_flat(), is_flat);
    }
    for count in [1, 16] {
        let probes = Probes { count: Fx::from_raw(count), ..Probes::<i32>::limit(End::High) };
        let footprint = FaceFootprint { probes, ..FaceFootprint::<i32>::limit(End::High) };
        assert_eq!(Batch::from_iter([footprint]).counts(), [count]);
        let sweep = Sweep { count: Fx::from_raw(count), ..Sweep::<i32>::limit(End::High) };
        assert_eq!(Batch::from_iter([sweep]).counts(), [count]);
    }
    for (offset, roughness, is_smooth) in
        [([1, 1], [0; 3], true), ([0, 0], [0, 0, 1], false), ([0, 0], [1, 0, 0], false)]
    {
        let bump = Bump { offset: offset.map(Fx::from_raw), roughness: roughness.map(Fx::from_raw) };
        assert_eq!(Batch::from_iter([FilteredBump { bump, samples: Fx::from_raw(9) }]).is_smooth(), is_smooth);
    }
}
