//! Which reading computes surfaces, footprints, maps and environments: the bits are the same, the time is not.

use std::fmt;
use std::str::FromStr;

use roughxel_core::bundle::{Value, bundle};
use roughxel_core::datapath::texel::{Bump, BumpMoments, BumpSample, BumpScale};
use roughxel_core::datapath::{self, Reflection, Surface, TextureFootprint, pixel, texel};
use roughxel_core::each::each;
use roughxel_core::fetch::Fetch;
use roughxel_core::fx::{Control, Fx, Int};
use roughxel_core::plan::{ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{LIGHT, PortBlock, REFLECTANCE, ReflectionInput, SurfaceInput};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::repeated::{self, Mean, Tap, View};
use roughxel_core::sampler::{self, Cube, CubeMemory, Seen};
use roughxel_core::signals::{CubePoint, MapScale, Probes, RepeatedFootprint, Sweep, TexturePosition};
use roughxel_core::soft_core;
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::width::on_words;
use roughxel_core::word::Word;

use super::LANES;
use super::columns::Columns;
use super::narrow::{KEPT, NARROW_LANES};
use super::order::Order;
use super::target::InstructionSet;
use super::texels::{BumpMemory, BumpTexels, CubeTexels, MapTexels};
#[cfg(target_arch = "x86_64")]
use super::{Avx2, Avx512, Target};

bundle! {
    /// What fetching needs of a reflection: where it looks, and over which footprint.
    pub struct Footprint<W> {
        /// Face, s, t.
        point: CubePoint<W>,
        /// N, step, level of detail.
        probes: Probes<W>,
    }
}

impl Columns<Bumped<i32>> {
    /// Whether no fragment is rough.
    pub fn is_smooth(&self) -> bool {
        self.rows_of(|bumped| bumped.bump.roughness).all(|row| row.iter().all(|&d| d == 0))
    }

    /// Bilinear samples of all.
    pub fn taps(&self) -> u64 {
        sum(self.row_of(|bumped| bumped.taps))
    }
}

impl Columns<Shown<i32>> {
    /// The colour of each.
    pub fn colours(&self) -> impl Iterator<Item = [Control<i32, LIGHT>; 3]> + '_ {
        let [red, green, blue] = [0, 1, 2].map(|channel| self.row_of(|shown| shown.channels[channel]));
        red.iter().zip(green).zip(blue).map(|((&red, &green), &blue)| [red, green, blue].map(Fx::from_raw))
    }

    /// Bilinear samples of all.
    pub fn taps(&self) -> u64 {
        sum(self.row_of(|shown| shown.taps))
    }
}

fn sum(taps: &[i32]) -> u64 {
    taps.iter().map(|taps| u64::from(taps.unsigned_abs())).sum()
}

impl Columns<Bare<i32>> {
    /// Whether there are fragments, all of one normal and frame.
    #[inline(always)]
    fn is_in_one_frame(&self) -> bool {
        let mut rows = self.rows_of(|bare| bare.normal).chain(self.rows_of(|bare| bare.frame_vectors));
        !self.is_empty() && rows.all(|row| row.iter().fold(0, |differs, &word| differs | (word ^ row[0])) == 0)
    }
}

/// A batch in the order of its probe counts; its memory is kept for the next one.
#[derive(Clone, Debug, Default)]
pub struct ByCount {
    order: Order,
    footprints: Columns<Footprint<i32>>,
    sweeps: Columns<Sweep<i32>>,
    own: Columns<Shown<i32>>,
    shown: Columns<Shown<i32>>,
}

impl Columns<Footprint<i32>> {
    /// How many probes each has.
    pub fn counts(&self) -> &[i32] {
        self.row_of(|footprint| footprint.probes.count)
    }
}

impl Columns<Sweep<i32>> {
    /// How many probes each has.
    pub fn counts(&self) -> &[i32] {
        self.row_of(|sweep| sweep.count)
    }
}

impl Columns<Derivatives<i32>> {
    /// Whether no fragment's surface is curved.
    pub fn is_flat(&self) -> bool {
        let [x, y] = [0, 1].map(|side| self.rows_of(move |derivatives| derivatives.dnormal[side].mantissa));
        x.chain(y).all(|row| row.iter().all(|&m| m == 0))
    }
}

impl<W: Word> Footprint<W> {
    /// That part of a reflection.
    #[inline(always)]
    pub fn of(stages: &Reflection<W>) -> Self {
        Self { point: stages.point, probes: stages.probes }
    }
}

bundle! {
    /// What the surface of a fragment is made of, beside its bumps.
    pub struct Bare<W> {
        /// Unnormalised normal.
        normal: PortBlock<W, 3>,
        /// From the surface to the eye.
        view: PortBlock<W, 3>,
        /// p_u and p_v, or the main direction and nothing.
        frame_vectors: [PortBlock<W, 3>; 2],
    }
}

bundle! {
    /// How a fragment's surface and its view change over a pixel.
    pub struct Derivatives<W> {
        /// ∂v/∂x and ∂v/∂y.
        dview: [PortBlock<W, 3>; 2],
        /// ∂n/∂x and ∂n/∂y.
        dnormal: [PortBlock<W, 3>; 2],
    }
}

bundle! {
    /// Bumps and roughness of a fragment, and what was read for them.
    pub struct Bumped<W> {
        /// As the ports of the surface take them.
        bump: Bump<W>,
        /// Bilinear samples.
        #[range(0..=32)]
        taps: Int<W>,
    }
}

bundle! {
    /// A colour, and what was read for it.
    pub struct Shown<W> {
        /// Linear light.
        #[range(0..64)]
        channels: [Control<W, LIGHT>; 3],
        /// Bilinear samples, those of two lobes at most.
        #[range(0..=64)]
        taps: Int<W>,
    }
}

/// Fragments as ports, taken apart: for who has them one by one.
#[derive(Clone, Debug, Default)]
pub struct Ports {
    /// Without bumps.
    pub bare: Columns<Bare<i32>>,
    /// Bumps and roughness; nothing was read for them.
    pub bumps: Columns<Bumped<i32>>,
    /// Over the pixel.
    pub derivatives: Columns<Derivatives<i32>>,
}

impl Extend<ReflectionInput<i32>> for Ports {
    fn extend<I: IntoIterator<Item = ReflectionInput<i32>>>(&mut self, inputs: I) {
        for ReflectionInput { surface, dview, dnormal, .. } in inputs {
            let SurfaceInput { normal, view, frame_vectors, offset, roughness } = surface;
            self.bare.push(&Bare { normal, view, frame_vectors });
            self.bumps.push(&Bumped { bump: Bump { offset, roughness }, taps: Fx::zero() });
            self.derivatives.push(&Derivatives { dview, dnormal });
        }
    }
}

impl FromIterator<ReflectionInput<i32>> for Ports {
    fn from_iter<I: IntoIterator<Item = ReflectionInput<i32>>>(inputs: I) -> Self {
        let mut ports = Self::default();
        ports.extend(inputs);
        ports
    }
}

impl Ports {
    /// Leaves no fragment; the memory is kept.
    pub fn clear(&mut self) {
        self.bare.clear();
        self.bumps.clear();
        self.derivatives.clear();
    }

    /// What fetching needs of every fragment, on the planes of faces.
    pub fn footprints(
        &self,
        reading: Reading,
        scale_and_plan: (&MapScale<i32>, &ReflectionPlan),
        p: &Precision,
    ) -> Columns<Footprint<i32>> {
        let (mut surfaces, mut footprints) = (Columns::default(), Columns::default());
        reading.surfaces(&self.bare, &self.bumps, &scale_and_plan.1.surface(), p, &mut surfaces);
        reading.footprints(&surfaces, &self.derivatives, scale_and_plan, p, &mut footprints);
        footprints
    }
}

/// Where fragments look in an environment, and over which footprints.
#[derive(Clone, Copy, Debug)]
pub enum Look<'a> {
    /// At points, over no footprint.
    Point(&'a Columns<CubePoint<i32>>),
    /// On the planes of its faces.
    Face(&'a Columns<Footprint<i32>>),
    /// On the sphere.
    Sphere(&'a Columns<Sweep<i32>>),
}

/// What fragments look up in a repeated map.
#[derive(Clone, Copy, Debug)]
pub struct Places<'a> {
    /// Texture coordinates.
    pub centres: &'a Columns<TexturePosition<i32>>,
    /// Footprints around them; none where nothing is filtered.
    pub footprints: Option<&'a Columns<RepeatedFootprint<i32>>>,
}

/// The ports of a surface.
#[inline(always)]
fn ports<W: Word>(bare: &Bare<W>, bump: &Bump<W>) -> SurfaceInput<W> {
    let Bare { normal, view, frame_vectors } = *bare;
    SurfaceInput { normal, view, frame_vectors, offset: bump.offset, roughness: bump.roughness }
}

/// A colour of one's own, blended with what is seen.
#[inline(always)]
fn shown_of<W: Fetch, M: CubeMemory>(
    own: &Shown<W>,
    seen: &Seen<W>,
    reflectance: &[Value<W, REFLECTANCE>; 3],
    cube: &Cube<'_, M>,
) -> Shown<W> {
    let reflectance = each!(Value(share) in *reflectance => share);
    let channels = sampler::blended(&own.channels, seen, &reflectance, cube);
    Shown { channels: each!(Value(channel) in channels => channel), taps: seen.taps }
}

/// What a surface with two lobes shows.
#[inline(always)]
fn mean_of_lobes<W: Fetch>(a: &Shown<W>, b: &Shown<W>) -> Shown<W> {
    let channels = each!(i in [0, 1, 2] => pixel::lobes::<W>(a.channels[i], b.channels[i]));
    Shown { channels, taps: a.taps + b.taps }
}

/// What a fragment sees of a repeated map, with the reach of its probes for rough bumps.
#[inline(always)]
fn repeated_footprint<W: Fetch>(
    duv: &[PortBlock<W, 2>; 2],
    (texture, scale): (&TextureScale<W>, &MapScale<W>),
    rough: bool,
    p: &Precision,
) -> RepeatedFootprint<W> {
    let TextureFootprint { axes, probes, .. } = datapath::texture_footprint(duv, texture, scale, p);
    let reach = if rough { datapath::probe_reach([&axes.major, &axes.minor], &probes, texture, p) } else { Fx::zero() };
    RepeatedFootprint { probes, reach }
}

/// The colour of a repeated map times `own`.
#[inline(always)]
fn colour<W: Fetch>(
    view: &View<'_, W>,
    texels: &MapTexels<[u16; 3]>,
    exponent: i32,
    own: &[Value<W, LIGHT>; 3],
    p: &Precision,
) -> Shown<W> {
    let mean = repeated::mean(
        view,
        #[inline(always)]
        |tap: &Tap<W>, _| texels.quad(tap),
        texel::colour_samples::<W, _>,
        same::<W, 3>,
        p,
    );
    let unit = Fx::int(exponent.into());
    let channels = each!(i in [0, 1, 2] => pixel::modulated::<W>(pixel::colour::<W>(mean.channels[i], unit), own[i].0));
    Shown { channels, taps: mean.taps }
}

#[inline(always)]
fn same<W: Word, const CHANNELS: usize>(sample: [Int<W>; CHANNELS]) -> [Int<W>; CHANNELS] {
    sample
}

/// Bumps and roughness of a map.
#[inline(always)]
fn bump<W: Fetch, M: BumpMemory>(
    view: &View<'_, W>,
    texels: &M,
    scale: &BumpScale<W>,
    kind: RoughnessKind,
    p: &Precision,
) -> Bumped<W> {
    let (moments, taps) = if kind == RoughnessKind::None {
        let Mean { channels: [b1, b2], taps } = repeated::mean(
            view,
            #[inline(always)]
            |tap: &Tap<W>, _| texels.quad(tap, scale),
            texel::word_samples::<W, _>,
            same::<W, 2>,
            p,
        );
        ([b1, b2, Fx::zero(), Fx::zero(), Fx::zero()], taps)
    } else {
        let reach = view.footprint.map(
            #[inline(always)]
            |(footprint, _)| footprint.reach,
        );
        let Mean { channels, taps } = repeated::mean(
            view,
            #[inline(always)]
            |tap: &Tap<W>, _| texels.quad(tap, scale),
            #[inline(always)]
            |fine, coarse, level_weight| {
                let sample = texel::word_samples::<W, _>(fine, coarse, level_weight);
                let Some(reach) = reach else { return sample };
                let offsets = each!(quad in [fine, coarse.unwrap_or(fine)] => texel::bump_offsets::<W, _>(quad));
                texel::bump_ramp(&BumpSample::<W>::of_words(sample), &offsets, level_weight, reach).words()
            },
            #[inline(always)]
            |sample| texel::bump_probe(&BumpSample::<W>::of_words(sample)).words(),
            p,
        );
        (channels, taps)
    };
    Bumped { bump: texel::bump(&BumpMoments::<W>::of_words(moments), scale, kind, p), taps }
}

/// A way to compute parts of the datapath for many fragments, or the light of many peaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// One fragment after the other.
    Scalar,
    /// Lanes, with an instruction set of this machine.
    Lanes(InstructionSet),
}

/// Words that lanes have.
pub(super) enum Width {
    /// Of 16 bits, all kept.
    Narrow,
    /// Of 32 bits.
    Full,
}

/// The lanes of a profile; `None` of 12 and 13 kept bits, which no named one has and the scalar reading runs.
pub(super) fn lanes_of(p: &Precision) -> Option<Width> {
    match p.word_bits() {
        16 => (p.fraction_bits == KEPT).then_some(Width::Narrow),
        _ => Some(Width::Full),
    }
}

/// What a part of the datapath makes of every input: `$body` in lanes of the profile's width, with what is the same for all fragments spread
/// over them, or `$scalar`.
macro_rules! each_fragment {
    (
        $reading:expr, $p:expr, $inputs:expr, $results:expr,
        |$input:pat_param $(, $same:ident)*| $body:expr, else $scalar:expr
    ) => {
        match ($reading, $crate::reading::lanes_of($p)) {
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes($crate::InstructionSet::Avx2), Some($crate::reading::Width::Narrow)) => {
                each_fragment!(@lanes $crate::NarrowLanes<$crate::Avx2>, $inputs, $results, |$input $(, $same)*| $body);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes($crate::InstructionSet::Avx2), Some($crate::reading::Width::Full)) => {
                each_fragment!(@lanes $crate::Lanes<$crate::Avx2>, $inputs, $results, |$input $(, $same)*| $body);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes($crate::InstructionSet::Avx512), Some($crate::reading::Width::Narrow)) => {
                each_fragment!(@lanes $crate::NarrowLanes<$crate::Avx512>, $inputs, $results, |$input $(, $same)*| $body);
            }
            #[cfg(target_arch = "x86_64")]
            (Self::Lanes($crate::InstructionSet::Avx512), Some($crate::reading::Width::Full)) => {
                each_fragment!(@lanes $crate::Lanes<$crate::Avx512>, $inputs, $results, |$input $(, $same)*| $body);
            }
            _ => {
                $crate::batch::one_by_one($inputs, $results, |$input| $scalar);
            }
        }
    };
    (@lanes $lanes:ty, $inputs:expr, $results:expr, |$input:pat_param $(, $same:ident)*| $body:expr) => {
        $crate::batch::map::<$lanes, _, _, _>(
            $inputs,
            $results,
            #[inline(always)]
            |$input| {
                $(let $same = &$crate::batch::spread::<$lanes, _, _>($same);)*
                $body
            },
        )
    };
}

pub(super) use each_fragment;

impl Reading {
    /// The fastest on this machine.
    pub fn best() -> Self {
        InstructionSet::best().map_or(Self::Scalar, Self::Lanes)
    }

    /// Runs `body`, compiled for the instruction set if it is inlined: loops over [`LANES`](super::LANES) places become vectors.
    #[inline(always)]
    pub fn run<R>(self, body: impl FnOnce() -> R) -> R {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Lanes(InstructionSet::Avx2) => Avx2::run(body),
            #[cfg(target_arch = "x86_64")]
            Self::Lanes(InstructionSet::Avx512) => Avx512::run(body),
            _ => body(),
        }
    }

    /// The surface of every fragment, with its bumps. A frame that all of them have is made once.
    pub fn surfaces(
        self,
        bare: &Columns<Bare<i32>>,
        bumps: &Columns<Bumped<i32>>,
        plan: &SurfacePlan,
        p: &Precision,
        surfaces: &mut Columns<Surface<i32>>,
    ) {
        let in_one_frame = plan.needs_frame()
            && self.run(
                #[inline(always)]
                || bare.is_in_one_frame(),
            );
        if in_one_frame {
            let framed = &soft_core::framed(&ports(&bare.get(0), &bumps.get(0).bump), plan, p);
            each_fragment!(
                self, p, (bare, bumps), surfaces,
                |(bare, bumped), framed| datapath::surface_in_frame(framed, &ports(bare, &bumped.bump), plan, p),
                else soft_core::surface_in_frame(framed, &ports(bare, &bumped.bump), plan, p)
            );
            return;
        }
        each_fragment!(
            self, p, (bare, bumps), surfaces,
            |(bare, bumped)| datapath::surface(&ports(bare, &bumped.bump), plan, p),
            else soft_core::surface(&ports(bare, &bumped.bump), plan, p)
        );
    }

    /// The same surfaces with the core of their lobe.
    pub fn cores(self, surfaces: &Columns<Surface<i32>>, p: &Precision, cores: &mut Columns<Surface<i32>>) {
        each_fragment!(
            self, p, surfaces, cores,
            |surface| Surface { rough: datapath::lobe_core(&surface.rough), ..*surface },
            else on_words!(p, |surface| Surface { rough: datapath::lobe_core(&surface.rough), ..*surface })
        );
    }

    /// The mean of what two lobes show.
    pub fn lobes(self, lobes: [&Columns<Shown<i32>>; 2], p: &Precision, shown: &mut Columns<Shown<i32>>) {
        each_fragment!(
            self, p, (lobes[0], lobes[1]), shown,
            |(a, b)| mean_of_lobes(a, b),
            else on_words!(p, |a, b| mean_of_lobes(a, b))
        );
    }

    /// Where every fragment whose surface is made looks without a footprint.
    pub fn points(self, surfaces: &Columns<Surface<i32>>, p: &Precision, points: &mut Columns<CubePoint<i32>>) {
        each_fragment!(
            self, p, surfaces, points,
            |surface| datapath::mirrored(surface, p).1,
            else on_words!(p, |surface| datapath::mirrored(surface, p).1)
        );
    }

    /// What fetching needs of every fragment whose surface is made, on the planes of faces.
    pub fn footprints(
        self,
        surfaces: &Columns<Surface<i32>>,
        derivatives: &Columns<Derivatives<i32>>,
        (scale, plan): (&MapScale<i32>, &ReflectionPlan),
        p: &Precision,
        footprints: &mut Columns<Footprint<i32>>,
    ) {
        each_fragment!(
            self, p, (surfaces, derivatives), footprints,
            |(surface, d), scale| {
                Footprint::of(&datapath::reflection_of(surface, [&d.dview, &d.dnormal], scale, &plan.on_face(), p))
            },
            else Footprint::of(&soft_core::reflection_of(surface, [&d.dview, &d.dnormal], scale, &plan.on_face(), p))
        );
    }

    /// What the probes on the sphere step along, of every fragment whose surface is made.
    pub fn sweeps(
        self,
        surfaces: &Columns<Surface<i32>>,
        derivatives: &Columns<Derivatives<i32>>,
        (scale, plan): (&MapScale<i32>, &ReflectionPlan),
        p: &Precision,
        sweeps: &mut Columns<Sweep<i32>>,
    ) {
        each_fragment!(
            self, p, (surfaces, derivatives), sweeps,
            |(surface, d), scale| {
                datapath::reflection_of(surface, [&d.dview, &d.dnormal], scale, &plan.on_sphere(), p).sweep
            },
            else soft_core::reflection_of(surface, [&d.dview, &d.dnormal], scale, &plan.on_sphere(), p).sweep
        );
    }

    /// What every fragment shows: its own colour and what it sees of the environment, by its reflectance; a rough one looks with the
    /// roughness bias. Groups of lanes are of like counts where that spares turns.
    pub fn environment(
        self,
        look: Look<'_>,
        own: &Columns<Shown<i32>>,
        of: (&CubeTexels, bool, &[Control<i32, REFLECTANCE>; 3]),
        p: &Precision,
        (by_count, shown): (&mut ByCount, &mut Columns<Shown<i32>>),
    ) {
        let ByCount { order, footprints, sweeps, own: ordered_own, shown: ordered_shown } = by_count;
        let counts = match look {
            Look::Point(_) => &[],
            Look::Face(footprints) => footprints.counts(),
            Look::Sphere(sweeps) => sweeps.counts(),
        };
        if !self.lanes(p).is_some_and(|lanes| order.by(counts, lanes)) {
            return self.environment_in_order(look, own, of, p, shown);
        }
        let look = match look {
            Look::Point(_) => look,
            Look::Face(all) => {
                all.reorder(order, footprints);
                Look::Face(footprints)
            }
            Look::Sphere(all) => {
                all.reorder(order, sweeps);
                Look::Sphere(sweeps)
            }
        };
        own.reorder(order, ordered_own);
        self.environment_in_order(look, ordered_own, of, p, ordered_shown);
        ordered_shown.restore(order, shown);
    }

    /// Fragments of a group of lanes; `None` where there are no lanes.
    fn lanes(self, p: &Precision) -> Option<usize> {
        match (self, lanes_of(p)) {
            (Self::Scalar, _) | (_, None) => None,
            (Self::Lanes(_), Some(Width::Narrow)) => Some(NARROW_LANES),
            (Self::Lanes(_), Some(Width::Full)) => Some(LANES),
        }
    }

    /// What [`Self::environment`] says, of fragments as they stand.
    fn environment_in_order(
        self,
        look: Look<'_>,
        own: &Columns<Shown<i32>>,
        (map, is_rough, reflectance): (&CubeTexels, bool, &[Control<i32, REFLECTANCE>; 3]),
        p: &Precision,
        shown: &mut Columns<Shown<i32>>,
    ) {
        let (reflectance, cube) = (&reflectance.map(Value::<i32, _>), &map.cube());
        macro_rules! look {
            ($inputs:expr, |$at:ident| $seen:expr) => {
                each_fragment!(
                    self, p, $inputs, shown,
                    |($at, own), reflectance| shown_of(own, &$seen, reflectance, cube),
                    else on_words!(p, |$at, own, reflectance| shown_of(own, &$seen, reflectance, cube))
                )
            };
        }
        match look {
            Look::Point(points) => look!((points, own), |point| sampler::point_means(point, cube, p)),
            Look::Face(footprints) => look!((footprints, own), |footprint| {
                sampler::means(&footprint.point, &footprint.probes, is_rough, cube, p)
            }),
            Look::Sphere(sweeps) => {
                look!((sweeps, own), |sweep| sampler::swept_means(sweep, is_rough, cube, p));
            }
        }
    }

    /// The footprint of every fragment in maps of one scale; `rough` says that bumps with roughness are among them.
    pub fn texture_footprints(
        self,
        derivatives: &Columns<[PortBlock<i32, 2>; 2]>,
        ((texture, scale), rough): (&(TextureScale<i32>, MapScale<i32>), bool),
        p: &Precision,
        footprints: &mut Columns<RepeatedFootprint<i32>>,
    ) {
        each_fragment!(
            self, p, derivatives, footprints,
            |duv, texture, scale| repeated_footprint(duv, (texture, scale), rough, p),
            else on_words!(p, |duv, texture, scale| repeated_footprint(duv, (texture, scale), rough, p))
        );
    }

    /// The colour of a map at every fragment times `own`; its channels are in units of 2^`exponent`.
    pub fn colours(
        self,
        places: Places<'_>,
        (map, exponent, own): (&MapTexels<[u16; 3]>, i32, &[Control<i32, LIGHT>; 3]),
        p: &Precision,
        colours: &mut Columns<Shown<i32>>,
    ) {
        let own = &own.map(Value::<i32, _>);
        let (levels, texture) = (&map.map.levels[..], &map.map.scale.0);
        match places.footprints {
            Some(footprints) => each_fragment!(
                self, p, (places.centres, footprints), colours,
                |(centre, footprint), own, texture| {
                    colour(&View { centre, footprint: Some((footprint, texture)), levels, rough: false }, map, exponent, own, p)
                },
                else on_words!(p, |centre, footprint, own, texture| {
                    colour(&View { centre, footprint: Some((footprint, texture)), levels, rough: false }, map, exponent, own, p)
                })
            ),
            None => each_fragment!(
                self, p, places.centres, colours,
                |centre, own| colour(&View { centre, footprint: None, levels, rough: false }, map, exponent, own, p),
                else on_words!(p, |centre, own| {
                    colour(&View { centre, footprint: None, levels, rough: false }, map, exponent, own, p)
                })
            ),
        }
    }

    /// Bumps and roughness of a map at every fragment.
    pub fn bumps(
        self,
        places: Places<'_>,
        (map, scale, kind): (&BumpTexels, &BumpScale<i32>, RoughnessKind),
        p: &Precision,
        bumps: &mut Columns<Bumped<i32>>,
    ) {
        match map {
            BumpTexels::Smooth(texels) => self.bumps_of(places, (texels, scale, kind), p, bumps),
            BumpTexels::Rough(texels) => self.bumps_of(places, (texels, scale, kind), p, bumps),
        }
    }

    fn bumps_of<T>(
        self,
        places: Places<'_>,
        (map, scale, kind): (&MapTexels<T>, &BumpScale<i32>, RoughnessKind),
        p: &Precision,
        bumps: &mut Columns<Bumped<i32>>,
    ) where
        MapTexels<T>: BumpMemory,
    {
        let rough = kind != RoughnessKind::None;
        let (levels, texture) = (&map.map.levels[..], &map.map.scale.0);
        match places.footprints {
            Some(footprints) => each_fragment!(
                self, p, (places.centres, footprints), bumps,
                |(centre, footprint), scale, texture| {
                    bump(&View { centre, footprint: Some((footprint, texture)), levels, rough }, map, scale, kind, p)
                },
                else on_words!(p, |centre, footprint, scale, texture| {
                    bump(&View { centre, footprint: Some((footprint, texture)), levels, rough }, map, scale, kind, p)
                })
            ),
            None => each_fragment!(
                self, p, places.centres, bumps,
                |centre, scale| bump(&View { centre, footprint: None, levels, rough }, map, scale, kind, p),
                else on_words!(p, |centre, scale| {
                    bump(&View { centre, footprint: None, levels, rough }, map, scale, kind, p)
                })
            ),
        }
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scalar => f.write_str("scalar"),
            Self::Lanes(set) => write!(f, "{set}"),
        }
    }
}

impl FromStr for Reading {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lanes = InstructionSet::available().map(Self::Lanes);
        let readings: Vec<Self> = std::iter::once(Self::Scalar).chain(lanes).collect();
        readings.iter().copied().find(|reading| reading.to_string() == text).ok_or_else(|| {
            let names: Vec<String> = readings.iter().map(Self::to_string).collect();
            format!("'{text}' is no reading of this machine: use {}", names.join(", "))
        })
    }
}
