//! Designs in every existing backend: scalar, checked, and lanes with every instruction set of this machine.

use std::marker::PhantomData;

use roughxel_core::bundle::{Bundle, End, Rewire};
use roughxel_core::design::{Design, In, Of, Recorded};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_core::width::narrowed;
use roughxel_core::word::{Wire, Word};
use roughxel_netlist::integers::{integers, integers_at};
use roughxel_simd::{Backend, BatchWord, InstructionSet, Kernel, NARROW_LANES};

use crate::checked::{Integers, first_difference};
use crate::designs::same_when_checked;

/// Runs inputs of one design in every backend, on words of the profile's width.
///
/// All designs in all kinds of lanes take minutes to compile. The design is therefore a parameter: only requested designs are compiled.
///
/// # Panics
/// If two backends differ, with the first wire that does.
pub fn same_in_every_backend<const DESIGN: usize>(inputs: &[<Of<DESIGN> as Recorded>::Input], p: &Precision)
where
    Of<DESIGN>: Recorded,
{
    let design = Design::ALL[DESIGN];
    for inputs in inputs.chunks(NARROW_LANES) {
        let same = |input| same_when_checked(design, &integers_at(input, p), &Effects::ALL, p).0;
        let scalar: Vec<Integers> = inputs.iter().map(same).collect();
        let ports: Vec<Vec<i64>> = inputs.iter().map(integers).collect();
        for set in InstructionSet::available() {
            let lanes = Backend::Simd(set).dispatch(p, SideBySide::<Of<DESIGN>>(&ports, p, PhantomData));
            for ((ports, expected), got) in ports.iter().zip(&scalar).zip(&lanes) {
                let difference = first_difference(expected, got);
                assert_eq!(expected, got, "{set}: {} of {ports:?}: {difference:?}", design.name());
            }
        }
    }
}

/// Runs some inputs, in groups of as many as there are lanes.
struct SideBySide<'a, D>(&'a [Vec<i64>], &'a Precision, PhantomData<D>);

impl<D: Recorded> Kernel for SideBySide<'_, D> {
    type Outcome = Vec<Integers>;
    fn run<W: BatchWord>(self) -> Vec<Integers> {
        self.0.chunks(W::FRAGMENTS).flat_map(|ports| group::<W, D>(ports, self.1)).collect()
    }
}

/// The result of each input of a group that fits the lanes.
fn group<W: BatchWord, D: Recorded>(ports: &[Vec<i64>], p: &Precision) -> Vec<Integers> {
    W::run(
        #[inline(always)]
        || {
            let mut load = Load::<W> { ports, next: 0, proof: W::proof() };
            let input = D::Input::limit::<i32>(End::Low).rewire::<W, _>(&mut load);
            let run: In<D::Output, W> = D::run::<W>(&input, &Effects::ALL, p);
            let lane = |lane| {
                let output: D::Output = run.rewire::<i32, _>(&mut Lane(lane));
                if p.word_bits() == 16 {
                    Integers::from_bundle(&narrowed(&output))
                } else {
                    Integers::from_bundle(&output)
                }
            };
            (0..ports.len()).map(lane).collect()
        },
    )
}

/// Packs the ports of several inputs into lanes; unused lanes repeat the last input.
struct Load<'a, W: BatchWord> {
    ports: &'a [Vec<i64>],
    next: usize,
    proof: W::Proof,
}

impl<W: BatchWord> Load<'_, W> {
    fn row(&mut self) -> W::Row {
        self.next += 1;
        let last = self.ports.len() - 1;
        let words: [i32; NARROW_LANES] = std::array::from_fn(|lane| self.ports[lane.min(last)][self.next - 1] as i32);
        W::load(self.proof, W::vectors(&words), 0)
    }
}

impl<W: BatchWord> Rewire<i32, W> for Load<'_, W> {
    fn word(&mut self, _: i32, _: u32) -> W {
        W::of_mantissas(self.row())
    }
    fn control(&mut self, _: i32, _: u32) -> W::Count {
        W::of_counts(self.row())
    }
    fn wide(&mut self, _: i64, _: u32) -> <W::Count as Word>::Wide {
        unreachable!("no design that is asked for has a wide port")
    }
    fn flag(&mut self, _: bool) -> W::Flag {
        W::Count::lit(0).lt(W::of_counts(self.row()))
    }
}

/// One lane of every wire.
struct Lane(usize);

impl Lane {
    fn read<W: BatchWord>(&self, row: W::Row) -> i32 {
        let mut words = [0; NARROW_LANES];
        W::store(row, W::vectors_mut(&mut words), 0);
        words[self.0]
    }
}

impl<W: BatchWord> Rewire<W, i32> for Lane {
    fn word(&mut self, wire: W, _: u32) -> i32 {
        self.read::<W>(wire.mantissas())
    }
    fn control(&mut self, wire: W::Count, _: u32) -> i32 {
        self.read::<W>(W::counts(wire))
    }
    fn wide(&mut self, _: <W::Count as Word>::Wide, _: u32) -> i64 {
        unreachable!("no design that is asked for has a wide port")
    }
    fn flag(&mut self, wire: W::Flag) -> bool {
        self.read::<W>(W::counts(Wire::select(wire, Wire::lit(1), Wire::lit(0)))) != 0
    }
}
