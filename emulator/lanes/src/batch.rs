//! Batches: fragments side by side in lanes, through the whole reflection datapath, and one by one again.

use roughxel_core::bundle::{Bundle, Rewire, bundle};
use roughxel_core::datapath::{self, Reflection, ReflectionInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::ReflectionPlan;
use roughxel_core::ports::ReflectionIn;
use roughxel_core::precision::Precision;
use roughxel_core::signals::{CubePoint, MapScale, Probes};
use roughxel_core::word::Word;

#[cfg(target_arch = "x86_64")]
use super::target::{Avx2, Avx512};
use super::target::{Baseline, InstructionSet, Target};
use super::{FlagLanes, Lanes, WideLanes};

/// Fragments in a group, whatever the instruction set.
pub const LANES: usize = 16;

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

/// Inputs of [`LANES`] fragments: their words in the order of a walk, side by side.
type Group = [[i32; LANES]; WORDS];

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
            InstructionSet::Avx2 if $set.is_available() => $batch.collect::<Avx2, _>($plan, $p, $pick),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 if $set.is_available() => $batch.collect::<Avx512, _>($plan, $p, $pick),
            _ => $batch.collect::<Baseline, _>($plan, $p, $pick),
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

    /// Every stage's outcome of every fragment. A set the machine does not have stands for [`InstructionSet::Baseline`].
    pub fn reflect(&self, set: InstructionSet, plan: &ReflectionPlan, p: &Precision) -> Vec<Reflection<i32>> {
        collect!(self, set, plan, p, |stages| stages)
    }

    /// What fetching needs of every fragment; instruction sets as for [`Self::reflect`].
    pub fn footprints(&self, set: InstructionSet, plan: &ReflectionPlan, p: &Precision) -> Vec<Footprint<i32>> {
        collect!(self, set, plan, p, |stages| Footprint::of(&stages))
    }

    fn collect<T: Target, B: Bundle<Lanes<T, LANES>>>(
        &self,
        plan: &ReflectionPlan,
        p: &Precision,
        pick: impl Fn(Reflection<Lanes<T, LANES>>) -> B,
    ) -> Vec<B::In<i32>> {
        let mut fragments = Vec::with_capacity(self.len);
        for group in &self.groups {
            let picked = pick(reflection(group, plan, p));
            fragments.extend((0..LANES.min(self.len - fragments.len())).map(|lane| picked.rewire(&mut Lane(lane))));
        }
        fragments
    }
}

/// The composer, compiled for the instruction set as its stages are.
#[inline(never)]
fn reflection<T: Target>(group: &Group, plan: &ReflectionPlan, p: &Precision) -> Reflection<Lanes<T, LANES>> {
    T::run(
        #[inline(always)]
        || {
            let scale = MapScale { log2_texels: Fx::zero(), last_level: Fx::zero() };
            let blank = ReflectionIn::default().wires(scale);
            datapath::reflection(&blank.rewire(&mut Load { group, next: 0 }), plan, p)
        },
    )
}

/// Puts the words of a walk into a lane of a group; a wide wire is two of them, a flag is 0 or 1.
struct Store<'a> {
    group: &'a mut Group,
    lane: usize,
    next: usize,
}

impl Store<'_> {
    #[inline(always)]
    fn store(&mut self, word: i32) {
        self.group[self.next][self.lane] = word;
        self.next += 1;
    }
}

impl Rewire<i32, i32> for Store<'_> {
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
struct Load<'a> {
    group: &'a Group,
    next: usize,
}

impl Load<'_> {
    #[inline(always)]
    fn load(&mut self) -> [i32; LANES] {
        self.next += 1;
        self.group[self.next - 1]
    }
}

impl<T: Target> Rewire<i32, Lanes<T, LANES>> for Load<'_> {
    #[inline(always)]
    fn word(&mut self, _: i32, _: u32) -> Lanes<T, LANES> {
        Lanes::of(self.load())
    }
    #[inline(always)]
    fn wide(&mut self, _: i64, _: u32) -> WideLanes<T, LANES> {
        let [low, high] = [self.load(), self.load()];
        WideLanes::of(core::array::from_fn(|i| i64::from(high[i]) << 32 | i64::from(low[i].cast_unsigned())))
    }
    #[inline(always)]
    fn flag(&mut self, _: bool) -> FlagLanes<T, LANES> {
        FlagLanes::of(self.load().map(|flag| flag != 0))
    }
}

/// The wires of one lane.
struct Lane(usize);

impl<T: Target> Rewire<Lanes<T, LANES>, i32> for Lane {
    #[inline(always)]
    fn word(&mut self, wire: Lanes<T, LANES>, _: u32) -> i32 {
        wire.lanes()[self.0]
    }
    #[inline(always)]
    fn wide(&mut self, wire: WideLanes<T, LANES>, _: u32) -> i64 {
        wire.lanes()[self.0]
    }
    #[inline(always)]
    fn flag(&mut self, wire: FlagLanes<T, LANES>) -> bool {
        wire.lanes()[self.0]
    }
}
