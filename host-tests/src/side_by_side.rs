//! Designs in every reading that exists: scalar, checked, and lanes with every instruction set of this machine.

use roughxel_core::bundle::{Bundle, End, Rewire};
use roughxel_core::design::{Design, HorizonInput, LocalInput, Of, Recorded, StoredPeakInput};
use roughxel_core::plan::Effects;
use roughxel_core::precision::Precision;
use roughxel_core::staged::Staged;
use roughxel_core::width::narrowed;
use roughxel_core::word::{Wire, Word};
#[cfg(target_arch = "x86_64")]
use roughxel_simd::{Avx2, Avx512};
use roughxel_simd::{Halves, InstructionSet, LANES, Lanes, NARROW_LANES, NarrowLanes, Target, WideLanes};

use crate::checked::{Integers, Visible, first_difference};
use crate::designs::{checked, scalar};

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

    /// Integers of its ports, on words of the profile's width.
    pub fn ports(&self, p: &Precision) -> Vec<i64> {
        fn integers<B: Bundle<i32>>(input: &B, p: &Precision) -> Integers {
            if p.word_bits() == 16 { Integers::of(&narrowed(input)) } else { Integers::of(input) }
        }
        let integers = match self {
            Self::Local(input) => integers(input, p),
            Self::Peak(input) => integers(input, p),
            Self::Horizon(input) => integers(input, p),
        };
        integers.values().to_vec()
    }
}

/// Runs inputs of one design in every reading, on words of the profile's width.
///
/// # Panics
/// Where two readings differ, with the first wire that does, or where inputs of different designs are mixed.
pub fn same_in_every_reading(inputs: &[DesignInput], p: &Precision) {
    for group in inputs.chunks(NARROW_LANES) {
        let ports: Vec<Vec<i64>> = group.iter().map(|input| input.ports(p)).collect();
        let design = group[0].design();
        let name = design.name();
        assert!(group.iter().all(|input| input.design() == design), "inputs of one design");
        let narrow = p.word_bits() == 16;
        let scalar: Vec<Integers> = ports.iter().map(|ports| scalar(design, ports, &Effects::ALL, p)).collect();
        for (ports, expected) in ports.iter().zip(&scalar) {
            let checked = checked(design, ports, &Effects::ALL, p);
            assert_eq!(*expected, checked, "{name} of {ports:?}: {:?}", first_difference(expected, &checked));
        }
        for set in InstructionSet::available() {
            let lanes = match (set, narrow) {
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx2, false) => in_lanes::<Lanes<Avx2>>(design, &ports, p),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx2, true) => in_lanes::<NarrowLanes<Avx2>>(design, &ports, p),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, false) => in_lanes::<Lanes<Avx512>>(design, &ports, p),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, true) => in_lanes::<NarrowLanes<Avx512>>(design, &ports, p),
                #[cfg(not(target_arch = "x86_64"))]
                (set, _) => panic!("{set} is of another machine"),
            };
            for ((ports, expected), got) in ports.iter().zip(&scalar).zip(&lanes) {
                assert_eq!(expected, got, "{set}: {name} of {ports:?}: {:?}", first_difference(expected, got));
            }
        }
    }
}

/// Words of several fragments, into which integers can be put and of which they can be seen.
trait SideBySide: Staged {
    /// The instruction set.
    type Set: Target;
    /// The word of one fragment.
    type Scalar: Visible<Flag = bool>;
    /// Fragments side by side, at most [`NARROW_LANES`].
    const COUNT: usize;
    fn of(values: &[i64]) -> Self;
    fn count_of(values: &[i64]) -> Self::Count;
    fn wide_of(values: &[i64]) -> <Self::Count as Word>::Wide;
    fn at(self, lane: usize) -> i64;
    fn count_at(count: Self::Count, lane: usize) -> i64;
    fn wide_at(wide: <Self::Count as Word>::Wide, lane: usize) -> i64;
}

macro_rules! side_by_side {
    ($words:ty, $scalar:ty, $counts:ty, $wides:ty, $count:expr) => {
        impl<T: Target> SideBySide for $words {
            type Set = T;
            type Scalar = $scalar;
            const COUNT: usize = $count;
            fn of(values: &[i64]) -> Self {
                Self::of(core::array::from_fn(|lane| values[lane] as $scalar))
            }
            fn count_of(values: &[i64]) -> $counts {
                <$counts>::of(core::array::from_fn(|lane| values[lane] as i32))
            }
            fn wide_of(values: &[i64]) -> $wides {
                <$wides>::of(core::array::from_fn(|lane| values[lane]))
            }
            fn at(self, lane: usize) -> i64 {
                self.lanes()[lane].into()
            }
            fn count_at(count: $counts, lane: usize) -> i64 {
                count.lanes()[lane].into()
            }
            fn wide_at(wide: $wides, lane: usize) -> i64 {
                wide.lanes()[lane]
            }
        }
    };
}

side_by_side!(Lanes<T>, i32, Lanes<T>, WideLanes<T>, LANES);
side_by_side!(NarrowLanes<T>, i16, Halves<Lanes<T>>, Halves<WideLanes<T>>, NARROW_LANES);

/// The outcome of each of the inputs, as many side by side as there are lanes. Only of the designs that [`DesignInput`] has: all 28
/// in all kinds of lanes take minutes to compile.
fn in_lanes<W: SideBySide>(design: Design, ports: &[Vec<i64>], p: &Precision) -> Vec<Integers> {
    let run = match design {
        Design::Local => group::<W, Of<{ Design::Local as usize }>>,
        Design::Peak => group::<W, Of<{ Design::Peak as usize }>>,
        Design::Horizon => group::<W, Of<{ Design::Horizon as usize }>>,
        _ => panic!("{} has a fragment of its own", design.name()),
    };
    ports.chunks(W::COUNT).flat_map(|ports| run(ports, p)).collect()
}

/// The outcome of each of at most as many inputs as there are lanes.
fn group<W: SideBySide, D: Recorded>(ports: &[Vec<i64>], p: &Precision) -> Vec<Integers> {
    let input = D::Input::limit::<i32>(End::Low).rewire::<W, _>(&mut Load { ports, next: 0 });
    let run = W::Set::run(
        #[inline(always)]
        || D::run::<W>(&input, &Effects::ALL, p),
    );
    let lane = |lane| Integers::of::<W::Scalar, _>(&run.rewire::<W::Scalar, _>(&mut Lane(lane)));
    (0..ports.len()).map(lane).collect()
}

/// Puts the ports of several inputs side by side; what is missing repeats the first.
struct Load<'a> {
    ports: &'a [Vec<i64>],
    next: usize,
}

impl Load<'_> {
    fn next(&mut self) -> [i64; NARROW_LANES] {
        self.next += 1;
        std::array::from_fn(|lane| self.ports[if lane < self.ports.len() { lane } else { 0 }][self.next - 1])
    }
}

impl<W: SideBySide> Rewire<i32, W> for Load<'_> {
    fn word(&mut self, _: i32, _: u32) -> W {
        W::of(&self.next())
    }
    fn control(&mut self, _: i32, _: u32) -> W::Count {
        W::count_of(&self.next())
    }
    fn wide(&mut self, _: i64, _: u32) -> <W::Count as Word>::Wide {
        W::wide_of(&self.next())
    }
    fn flag(&mut self, _: bool) -> W::Flag {
        let count = W::count_of(&self.next());
        W::Count::lit(0).lt(count)
    }
}

/// One lane of every wire.
struct Lane(usize);

impl<W: SideBySide> Rewire<W, W::Scalar> for Lane {
    fn word(&mut self, wire: W, _: u32) -> W::Scalar {
        Wire::lit(wire.at(self.0))
    }
    fn control(&mut self, wire: W::Count, _: u32) -> <W::Scalar as Wire>::Count {
        Wire::lit(W::count_at(wire, self.0))
    }
    fn wide(&mut self, wire: <W::Count as Word>::Wide, _: u32) -> <<W::Scalar as Wire>::Count as Word>::Wide {
        Wire::lit(W::wide_at(wire, self.0))
    }
    fn flag(&mut self, wire: W::Flag) -> bool {
        let count: W::Count = Wire::select(wire, Wire::lit(1), Wire::lit(0));
        W::count_at(count, self.0) != 0
    }
}
