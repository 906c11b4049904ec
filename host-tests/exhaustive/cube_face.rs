//! Cube face: every direction of 8-bit words.

use roughxel_core::block::Block;
use roughxel_core::fx::Fx;
use roughxel_core::precision::Precision;
use roughxel_core::stage::cube_face::cube_face;
use roughxel_host_tests::checked::Visible;
use roughxel_reference::cube;

use super::bounds::Bounds;
use super::{Checked8, FRACTION, ONE, mantissas, real, tiny_precisions, try_all};

/// Face, s, t, 1/(2m) and tie.
fn point<W: Visible>(m: [i64; 3], p: &Precision) -> (i64, [i64; 2], i64, bool)
where
    bool: From<W::Flag>,
{
    let r = Block::<W, 3> { m: m.map(Fx::lit), e: Fx::int(0) };
    let point = cube_face(&r, p);
    let st = point.st.map(|x| x.raw().integer());
    (W::count_integer(point.select.index().raw()), st, point.half_reciprocal.raw().integer(), point.tie.into())
}

#[test]
fn cube_face_of_every_direction_is_right() {
    let mut inputs = [0; 2];
    for p in tiny_precisions() {
        let bounds = Bounds::new(p, FRACTION);
        let all = mantissas(&p);
        let tried = try_all(all.clone(), |tried, x| {
            for (y, z) in all.clone().flat_map(|y| all.clone().map(move |z| (y, z))) {
                let m = [x, y, z];
                let largest = x.abs().max(y.abs()).max(z.abs());
                // A block: its largest mantissa is in [½, 1], or all are zero.
                if largest < ONE / 2 && largest > 0 {
                    continue;
                }
                tried.inputs += 1;
                let got = point::<Checked8>(m, &p);
                assert_eq!(got, point::<i8>(m, &p), "{m:?}");
                let (face, [s, t], half_reciprocal, tie) = got;
                let want = cube::select(m.map(real));
                // Mantissas are exact, so the face and the tie are exact, too.
                assert_eq!(face, want.face as i64, "{m:?}");
                assert_eq!(tie, m.iter().filter(|x| x.abs() == largest).count() > 1, "{m:?}");
                assert!((ONE / 2..=ONE).contains(&half_reciprocal), "{m:?}");
                assert!(s.abs() <= ONE && t.abs() <= ONE, "{m:?}");
                if largest == 0 {
                    assert_eq!((s, t, half_reciprocal), (0, 0, ONE));
                    continue;
                }
                let bound = bounds.half_reciprocal(want.m);
                tried.hold(0, (real(half_reciprocal) - 0.5 / want.m).abs(), bound, m);
                for (got, want_st) in [(s, want.s), (t, want.t)] {
                    // The quotient is 2·(s·m)·(1/2m), rounded once.
                    let bar = 2.0 * (want_st * want.m).abs() * bound + bounds.half_place();
                    tried.hold(1, (real(got) - want_st).abs(), bar, m);
                }
            }
        });
        // (2·2^p + 1)³ vectors, minus those below ½.
        let edge = (1_u64 << p.fraction_bits) + 1;
        let blocks = (2 * edge - 1).pow(3) - (edge - 2).pow(3) + 1;
        tried.report(&format!("cube face, p {}, {:?}", p.fraction_bits, p.reciprocal), ["1/2m", "s, t"], blocks);
        inputs[p.reciprocal.steps as usize] += blocks;
    }
    eprintln!("cube face: {inputs:?} inputs");
}
