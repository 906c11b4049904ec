//! Designs in every reading that exists: scalar, checked, and lanes with every instruction set of this machine.

use roughxel_core::bundle::{Bundle, Rewire};
use roughxel_core::datapath;
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_core::word::{Wire, Word};
#[cfg(target_arch = "x86_64")]
use roughxel_emulator::lanes::{Avx2, Avx512};
use roughxel_emulator::lanes::{FlagLanes, InstructionSet, LANES, Lanes, Target, WideLanes};
use roughxel_emulator::net::design::{HorizonInput, LocalInput, PeakInput, PeakOutput};

use crate::checked::{Checked, Integers, first_difference};
use crate::designs::outcome;

/// Inputs of one of the designs that have no fragment of their own.
#[derive(Clone, Copy, Debug)]
pub enum DesignInput {
    /// `local`.
    Local(LocalInput<i32>),
    /// `peak`.
    Peak(PeakInput<i32>),
    /// `horizon`.
    Horizon(HorizonInput<i32>),
}

impl DesignInput {
    /// Name of the design.
    pub fn design(&self) -> &'static str {
        match self {
            Self::Local(_) => "local",
            Self::Peak(_) => "peak",
            Self::Horizon(_) => "horizon",
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
        let name = group[0].design();
        assert!(group.iter().all(|input| input.design() == name), "inputs of one design");
        let scalar: Vec<Integers> = ports.iter().map(|ports| outcome::<i32>(name, ports, &Effects::ALL, p)).collect();
        for (ports, expected) in ports.iter().zip(&scalar) {
            let checked = outcome::<Checked>(name, ports, &Effects::ALL, p);
            assert_eq!(*expected, checked, "{name} of {ports:?}: {:?}", first_difference(expected, &checked));
        }
        for set in InstructionSet::available() {
            let lanes = match set {
                #[cfg(target_arch = "x86_64")]
                InstructionSet::Avx2 => in_lanes::<Avx2>(&group[0], &ports, p),
                #[cfg(target_arch = "x86_64")]
                InstructionSet::Avx512 => in_lanes::<Avx512>(&group[0], &ports, p),
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
fn in_lanes<T: Target>(form: &DesignInput, ports: &[Vec<i64>], p: &Precision) -> Vec<Integers> {
    let mut load = Load { ports, next: 0 };
    match form {
        DesignInput::Local(form) => {
            let input: LocalInput<Lanes<T>> = form.rewire(&mut load);
            let run = T::run(
                #[inline(always)]
                || datapath::local_direction(&input.direction, &input.frame, &input.normal, p),
            );
            one_by_one(&run, ports.len())
        }
        DesignInput::Peak(form) => {
            let input: PeakInput<Lanes<T>> = form.rewire(&mut load);
            let run = T::run(
                #[inline(always)]
                || {
                    let light = datapath::peak(&input.h, &input.peak, input.weight, p);
                    let sum = datapath::peak_sum(&input.sum, light);
                    PeakOutput { sum, status: datapath::peak_status(&input.h, &sum) }
                },
            );
            one_by_one(&run, ports.len())
        }
        DesignInput::Horizon(form) => {
            let input: HorizonInput<Lanes<T>> = form.rewire(&mut load);
            let run = T::run(
                #[inline(always)]
                || {
                    let light = datapath::horizon_slopes(&input.light, p);
                    let eye = datapath::horizon_slopes(&input.eye, p);
                    datapath::horizon(&light, &eye, &input.horizon, p)
                },
            );
            one_by_one(&run, ports.len())
        }
    }
}

fn one_by_one<T: Target, B: Bundle<Lanes<T>>>(lanes: &B, count: usize) -> Vec<Integers>
where
    B::In<i32>: Bundle<i32>,
{
    (0..count).map(|lane| Integers::of(&lanes.rewire::<i32, _>(&mut Lane(lane)))).collect()
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
    fn wide(&mut self, wire: <Lanes<T> as Word>::Wide, _: u32) -> i64 {
        wire.lanes()[self.0]
    }
    fn flag(&mut self, wire: FlagLanes<T>) -> bool {
        wire.lanes()[self.0]
    }
}
