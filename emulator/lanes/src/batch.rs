//! Batches: fragments side by side in lanes, through the whole reflection datapath, and one by one again.
//!
//! The walks that bring wires into lanes and out of them serve every kind of batch.

use roughxel_core::bundle::{Bundle, Rewire, bundle};
use roughxel_core::datapath::{self, Reflection, ReflectionInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::Precision;
use roughxel_core::signals::{CubePoint, MapScale, Probes};
use roughxel_core::word::{Wire, Word};

#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512};
use super::{FlagLanes, InstructionSet, LANES, Lanes, Target, WideLanes};

/// What fetching needs of a reflection: where it looks, and over which footprint.
#[derive(Clone, Copy, Debug)]
pub struct Footprint<W: Word> {
    /// Face, s, t.
    pub point: CubePoint<W>,
    /// N, step, level of detail.
    pub probes: Probes<W>,
}

bundle!(Footprint { point, probes });

impl<W: Word> Footprint<W> {
    /// That part of a reflection.
    pub fn of(stages: &Reflection<W>) -> Self {
        Self { point: stages.point, probes: stages.probes }
    }
}

/// Words of a [`ReflectionInput`].
const WORDS: usize = 39;

/// Words of a [`Reflection`], at most.
const ROWS: usize = 128;

/// A word of [`LANES`] fragments.
pub(super) type Row = [i32; LANES];

/// Inputs of [`LANES`] fragments, their words in the order of a walk.
type Group = [Row; WORDS];

/// Inputs of any number of fragments; the last group is filled up with fragments of zeros.
#[derive(Clone, Debug, Default)]
pub struct Batch {
    groups: Vec<Group>,
    len: usize,
}

/// `pick` of every fragment, in their order, compiled for an instruction set.
macro_rules! collect {
    ($batch:expr, $set:expr, $plan:expr, $p:expr, $pick:expr) => {
        match $set {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => $batch.collect::<Avx2, _>($plan, $p, $pick),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => $batch.collect::<Avx512, _>($plan, $p, $pick),
            #[cfg(not(target_arch = "x86_64"))]
            set => unreachable!("the machine has {set}"),
        }
    };
}

impl Batch {
    /// A batch of these fragments.
    pub fn new(inputs: &[ReflectionInput<i32>]) -> Self {
        let mut batch = Self { groups: Vec::with_capacity(inputs.len().div_ceil(LANES)), len: 0 };
        inputs.iter().for_each(|input| batch.push(input));
        batch
    }

    /// Fragments in the batch.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Adds a fragment.
    pub fn push(&mut self, input: &ReflectionInput<i32>) {
        let lane = self.len % LANES;
        if lane == 0 {
            self.groups.push([[0; LANES]; WORDS]);
        }
        if let Some(group) = self.groups.last_mut() {
            input.rewire::<i32, _>(&mut Store { group, lane, next: 0 });
            self.len += 1;
        }
    }

    /// Every stage's outcome of every fragment.
    ///
    /// # Panics
    /// If the machine does not have the instruction set.
    pub fn reflect(&self, set: InstructionSet, plan: &ReflectionPlan, p: &Precision) -> Vec<Reflection<i32>> {
        collect!(
            self,
            set,
            plan,
            p,
            #[inline(always)]
            |stages| stages
        )
    }

    /// What fetching needs of every fragment.
    ///
    /// # Panics
    /// If the machine does not have the instruction set.
    pub fn footprints(&self, set: InstructionSet, plan: &ReflectionPlan, p: &Precision) -> Vec<Footprint<i32>> {
        collect!(
            self,
            set,
            plan,
            p,
            #[inline(always)]
            |stages| Footprint::of(&stages)
        )
    }

    fn collect<T: Target, B: Bundle<Lanes<T>>>(
        &self,
        plan: &ReflectionPlan,
        p: &Precision,
        pick: impl Fn(Reflection<Lanes<T>>) -> B,
    ) -> Vec<B::In<i32>>
    where
        B::In<i32>: Bundle<i32, In<i32> = B::In<i32>>,
    {
        let scale = MapScale { log2_texels: Fx::zero(), last_level: Fx::zero() };
        let blank = ReflectionIn::default().wires(scale);
        let mut fragments = Vec::with_capacity(self.len);
        let mut rows = [[0; LANES]; ROWS];
        for group in &self.groups {
            // The composer and both walks are compiled for the instruction set, as the stages are.
            let form = T::run(
                #[inline(always)]
                || {
                    let input = blank.rewire(&mut Load { group, proof: T::proof(), next: 0 });
                    pick(datapath::reflection(&input, plan, p)).rewire(&mut Unload { rows: &mut rows, next: 0 })
                },
            );
            let lanes = LANES.min(self.len - fragments.len());
            fragments.extend((0..lanes).map(|lane| form.rewire(&mut Lane { rows: &rows, lane, next: 0 })));
        }
        fragments
    }
}

/// Puts the words of a walk into a lane of a group; a wide wire is two of them, a flag is 0 or 1.
pub(super) struct Store<'a, const WORDS: usize> {
    pub(super) group: &'a mut [Row; WORDS],
    pub(super) lane: usize,
    pub(super) next: usize,
}

impl<const WORDS: usize> Store<'_, WORDS> {
    #[inline(always)]
    fn store(&mut self, word: i32) {
        self.group[self.next][self.lane] = word;
        self.next += 1;
    }
}

impl<const WORDS: usize> Rewire<i32, i32> for Store<'_, WORDS> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> i32 {
        self.store(wire);
        wire
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> i64 {
        self.store(wire as i32);
        self.store((wire >> 32) as i32);
        wire
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> bool {
        self.store(i32::from(wire));
        wire
    }
}

/// Takes the words of a group in the order of a walk, all lanes at once.
pub(super) struct Load<'a, T, const WORDS: usize> {
    pub(super) group: &'a [Row; WORDS],
    pub(super) proof: T,
    pub(super) next: usize,
}

impl<T: Target, const WORDS: usize> Load<'_, T, WORDS> {
    #[inline(always)]
    fn load(&mut self) -> Lanes<T> {
        self.next += 1;
        Lanes(self.proof.words(self.group[self.next - 1]), self.proof)
    }
}

impl<T: Target, const WORDS: usize> Rewire<i32, Lanes<T>> for Load<'_, T, WORDS> {
    #[inline(always)]
    fn word(&mut self, _: i32, _: u32) -> Lanes<T> {
        self.load()
    }
    #[inline(always)]
    fn wide(&mut self, _: i64, _: u32) -> WideLanes<T> {
        let [low, high] = [self.load(), self.load()];
        let low = low.widen().and(Wire::lit(0xffff_ffff));
        high.widen().shl(32).or(low)
    }
    #[inline(always)]
    fn flag(&mut self, _: bool) -> FlagLanes<T> {
        Lanes::lit(0).lt(self.load())
    }
}

/// The same wire in every lane.
pub(super) struct Spread<T>(pub(super) T);

impl<T: Target> Rewire<i32, Lanes<T>> for Spread<T> {
    #[inline(always)]
    fn word(&mut self, wire: i32, _: u32) -> Lanes<T> {
        Lanes(self.0.words([wire; LANES]), self.0)
    }
    #[inline(always)]
    fn wide(&mut self, wire: i64, _: u32) -> WideLanes<T> {
        WideLanes(self.0.wides([wire; LANES]), self.0)
    }
    #[inline(always)]
    fn flag(&mut self, wire: bool) -> FlagLanes<T> {
        Lanes::lit(0).lt(Lanes(self.0.words([i32::from(wire); LANES]), self.0))
    }
}

/// Puts the wires of a walk into rows of words; a wide wire is two of them, a flag is 0 or 1.
pub(super) struct Unload<'a, const ROWS: usize> {
    pub(super) rows: &'a mut [Row; ROWS],
    pub(super) next: usize,
}

impl<const ROWS: usize> Unload<'_, ROWS> {
    #[inline(always)]
    fn store<T: Target>(&mut self, word: Lanes<T>) {
        self.rows[self.next] = word.lanes();
        self.next += 1;
    }
}

impl<T: Target, const ROWS: usize> Rewire<Lanes<T>, i32> for Unload<'_, ROWS> {
    #[inline(always)]
    fn word(&mut self, wire: Lanes<T>, _: u32) -> i32 {
        self.store(wire);
        0
    }
    #[inline(always)]
    fn wide(&mut self, wire: WideLanes<T>, _: u32) -> i64 {
        self.store(Lanes::narrow(wire));
        self.store(Lanes::narrow(wire.sar(32)));
        0
    }
    #[inline(always)]
    fn flag(&mut self, wire: FlagLanes<T>) -> bool {
        self.store(Lanes::select(wire, Wire::lit(1), Wire::lit(0)));
        false
    }
}

/// Takes the words of one lane in the order of a walk.
pub(super) struct Lane<'a, const ROWS: usize> {
    pub(super) rows: &'a [Row; ROWS],
    pub(super) lane: usize,
    pub(super) next: usize,
}

impl<const ROWS: usize> Lane<'_, ROWS> {
    #[inline(always)]
    fn load(&mut self) -> i32 {
        self.next += 1;
        self.rows[self.next - 1][self.lane]
    }
}

impl<const ROWS: usize> Rewire<i32, i32> for Lane<'_, ROWS> {
    #[inline(always)]
    fn word(&mut self, _: i32, _: u32) -> i32 {
        self.load()
    }
    #[inline(always)]
    fn wide(&mut self, _: i64, _: u32) -> i64 {
        let [low, high] = [self.load(), self.load()];
        i64::from(high) << 32 | i64::from(low.cast_unsigned())
    }
    #[inline(always)]
    fn flag(&mut self, _: bool) -> bool {
        self.load() != 0
    }
}
