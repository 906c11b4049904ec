//! Designs in every reading that exists: scalar, checked, and lanes with every instruction set of this machine.

use roughxel_core::bundle::{Bundle, End, Rewire};
use roughxel_core::design::{Design, HorizonInput, LocalInput, Recorded, StoredPeakInput, Visitor};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_core::word::{Wire, Word};
#[cfg(target_arch = "x86_64")]
use roughxel_emulator::lanes::{Avx2, Avx512};
use roughxel_emulator::lanes::{FlagLanes, InstructionSet, LANES, Lanes, Target, WideLanes};

use crate::checked::{Checked, Integers, first_difference};
use crate::designs::outcome;

/// Inputs of one of the designs that have no fragment of their own.
#[derive(Clone, Copy, Debug)]
pub enum DesignInput {
    /// `local`.
    Local(LocalInput<i32>),
    /// `peak`.
    Peak(StoredPeakInput<i32>),
    /// `horizon`.
    Horizon(HorizonInput<i32>),
}

impl DesignInput {
    /// The design.
    pub fn design(&self) -> Design {
        match self {
            Self::Local(_) => Design::Local,
            Self::Peak(_) => Design::Peak,
            Self::Horizon(_) => Design::Horizon,
        }
    }

    /// Integers of its ports.
    pub fn ports(&self) -> Vec<i64> {
        let integers = match self {
            Self::Local(input) => Integers::of(input),
            Self::Peak(input) => Integers::of(input),
            Self::Horizon(input) => Integers::of(input),
        };
        integers.0.into_iter().map(|(_, value)| value).collect()
    }
}

/// Runs inputs of one design in every reading.
///
/// # Panics
/// Where two readings differ, with the first wire that does, or where inputs of different designs are mixed.
pub fn same_in_every_reading(inputs: &[DesignInput], p: &Precision) {
    for group in inputs.chunks(LANES) {
        let ports: Vec<Vec<i64>> = group.iter().map(DesignInput::ports).collect();
        let design = group[0].design();
        let name = design.name();
        assert!(group.iter().all(|input| input.design() == design), "inputs of one design");
        let scalar: Vec<Integers> = ports.iter().map(|ports| outcome::<i32>(design, ports, &Effects::ALL, p)).collect();
        for (ports, expected) in ports.iter().zip(&scalar) {
            let checked = outcome::<Checked>(design, ports, &Effects::ALL, p);
            assert_eq!(*expected, checked, "{name} of {ports:?}: {:?}", first_difference(expected, &checked));
        }
        for set in InstructionSet::available() {
            let lanes = match set {
                #[cfg(target_arch = "x86_64")]
                InstructionSet::Avx2 => in_lanes::<Avx2>(design, &ports, p),
                #[cfg(target_arch = "x86_64")]
                InstructionSet::Avx512 => in_lanes::<Avx512>(design, &ports, p),
                #[cfg(not(target_arch = "x86_64"))]
                set => panic!("{set} is of another machine"),
            };
            for ((ports, expected), got) in ports.iter().zip(&scalar).zip(&lanes) {
                assert_eq!(expected, got, "{set}: {name} of {ports:?}: {:?}", first_difference(expected, got));
            }
        }
    }
}

/// The outcome of each of up to [`LANES`] inputs that lie side by side.
fn in_lanes<T: Target>(design: Design, ports: &[Vec<i64>], p: &Precision) -> Vec<Integers> {
    struct Run<'a, T> {
        ports: &'a [Vec<i64>],
        p: &'a Precision,
        set: core::marker::PhantomData<T>,
    }
    impl<T: Target> Visitor for Run<'_, T> {
        type Outcome = Vec<Integers>;
        fn visit<D: Recorded>(self) -> Vec<Integers> {
            let input = D::Input::limit::<i32>(End::Low).rewire(&mut Load { ports: self.ports, next: 0 });
            let run = T::run(
                #[inline(always)]
                || D::run::<Lanes<T>>(&input, &Effects::ALL, self.p),
            );
            let lane = |lane| Integers::of::<i32, _>(&run.rewire::<i32, _>(&mut Lane(lane)));
            (0..self.ports.len()).map(lane).collect()
        }
    }
    design.visit(Run::<T> { ports, p, set: core::marker::PhantomData })
}

/// Puts the ports of several inputs side by side; what is missing repeats the first.
struct Load<'a> {
    ports: &'a [Vec<i64>],
    next: usize,
}

impl Load<'_> {
    fn next(&mut self) -> [i64; LANES] {
        self.next += 1;
        std::array::from_fn(|lane| self.ports[if lane < self.ports.len() { lane } else { 0 }][self.next - 1])
    }
}

impl<T: Target> Rewire<i32, Lanes<T>> for Load<'_> {
    fn word(&mut self, _: i32, _: u32) -> Lanes<T> {
        Lanes::of(self.next().map(|value| value as i32))
    }
    fn control(&mut self, wire: i32, fraction_bits: u32) -> Lanes<T> {
        self.word(wire, fraction_bits)
    }
    fn wide(&mut self, _: i64, _: u32) -> WideLanes<T> {
        WideLanes::of(self.next())
    }
    fn flag(&mut self, _: bool) -> FlagLanes<T> {
        Lanes::<T>::lit(0).lt(Lanes::of(self.next().map(|value| value as i32)))
    }
}

/// One lane of every wire.
struct Lane(usize);

impl<T: Target> Rewire<Lanes<T>, i32> for Lane {
    fn word(&mut self, wire: Lanes<T>, _: u32) -> i32 {
        wire.lanes()[self.0]
    }
    fn control(&mut self, wire: Lanes<T>, fraction_bits: u32) -> i32 {
        self.word(wire, fraction_bits)
    }
    fn wide(&mut self, wire: <Lanes<T> as Word>::Wide, _: u32) -> i64 {
        wire.lanes()[self.0]
    }
    fn flag(&mut self, wire: FlagLanes<T>) -> bool {
        wire.lanes()[self.0]
    }
}
