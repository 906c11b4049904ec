//! The datapaths for firmware: effects and accuracy are a type, so a program holds what they need and no more, with or without
//! link-time optimisation.
//!
//! ```
//! use roughxel_core::firmware::{Firmware, Standard};
//! use roughxel_core::plan::{Effects, FootprintKind};
//!
//! /// A smooth curved mirror.
//! struct Chrome;
//! impl Firmware for Chrome {
//!     type Accuracy = Standard;
//!     const EFFECTS: Effects = Effects { curvature: true, footprint: FootprintKind::Face, ..Effects::NONE };
//! }
//! ```
//!
//! A fragment ([`ReflectionIn`]) gives a [`Footprint`]: `Chrome::reflect`. Its [`probes`](Footprint::probes) say where to read, or its
//! [`colour`](Footprint::colour) reads a memory of one's own, a [`CubeMemory`]; a wide lobe has a [`SphereFootprint`], `sweep`. Nothing allocates, panics or names a float, or
//! divides, but for the set-up of a map (`Chrome::texture`); with a reading of its own for small processors ([`mod@crate::small`]) the bits are those of every other reading.
//!
//! Build with `opt-level = 3`: the stages are inlined whatever the level, and what the plan leaves out vanishes by constants alone.
//! `"s"` makes them larger *and* slower (rv32imac, all effects: 6.7 KB and 8400 instructions more), for it leaves the small functions between them as calls. What makes programs smaller is the
//! feature `small-code`: blocks are normalised by calls, a fifth (`Standard`) to a third (`Narrow`) fewer bytes for 1.6 times the instructions.

use crate::datapath::{self, Reflection};
use crate::fx::{Control, Fx, Int};
use crate::plan::{Effects, FootprintKind};
use crate::ports::{
    CubeProbe, FacePlace, HighlightIn, HighlightOut, Level, Light, MapProbe, PeakIn, PeakOut, Port, ReflectionIn,
    ReflectionOut, SHARE, TextureIn,
};
use crate::precision::{Precision, RoughnessKind};
use crate::sampler::{self, Cube, CubeMemory};
use crate::signals::{CubePoint, FacePosition, MapScale, Probes, Sweep, TexturePosition};
use crate::soft_core::texture_scale;
use crate::stage::texture::TextureScale;
use crate::width::{self, IntegerCount, IntegerWord, Whole, of_ports, to_ports};
use crate::word::{self, Wire};

/// An accuracy as a type: one of the named profiles below, or knobs of one's own.
pub trait Accuracy {
    /// [`width::Narrow`] where the knobs keep at most 14 bits, else [`width::Whole`]; the other does not compile.
    type Word: IntegerWord;
    /// The knobs.
    const PRECISION: Precision;
}

macro_rules! profiles {
    ($($(#[$doc:meta])* $name:ident: $word:ty, $precision:ident;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Copy, Debug)]
            pub struct $name;

            impl Accuracy for $name {
                type Word = $word;
                const PRECISION: Precision = Precision::$precision;
            }
        )*
    };
}

profiles! {
    /// [`Precision::NARROW`].
    Narrow: width::Narrow, NARROW;
    /// [`Precision::PAPER`].
    Paper: Whole, PAPER;
    /// [`Precision::COMPACT`].
    Compact: Whole, COMPACT;
    /// [`Precision::STANDARD`].
    Standard: Whole, STANDARD;
    /// [`Precision::PRECISE`].
    Precise: Whole, PRECISE;
}

/// The word of a firmware.
type Word<F> = <<F as Firmware>::Accuracy as Accuracy>::Word;
/// What controls in it.
type Count<F> = <Word<F> as Wire>::Count;

/// The knobs of a firmware, on words that have as many bits as they need.
#[inline(always)]
fn knobs<F: Firmware>() -> &'static Precision {
    const {
        assert!(Word::<F>::BITS == F::Accuracy::PRECISION.word_bits(), "knobs need a word of another width");
        &F::Accuracy::PRECISION
    }
}

/// An integer that controls.
#[inline(always)]
fn int<F: Firmware>(integer: i32) -> Int<Word<F>> {
    Fx::from_raw(IntegerCount::of_integer(integer))
}

/// Effects and accuracy of a program, or of one of its materials: implement it for a type of your own.
pub trait Firmware: Sized {
    /// How accurate.
    type Accuracy: Accuracy;
    /// What is simulated; stages of other effects are in no program.
    const EFFECTS: Effects;

    /// The constants of an environment whose faces have `edge` texels, read as 1…16384. Once per environment.
    #[inline]
    fn environment(edge: u16) -> Environment<Self> {
        if const { Self::EFFECTS.footprint.is_some() } {
            Environment(datapath::map_scale(int::<Self>(edge.into()), knobs::<Self>()))
        } else {
            // Without a footprint nobody asks for a level.
            Environment(MapScale { log2_texels: Fx::zero(), last_level: Fx::zero() })
        }
    }

    /// A fragment from its surface to the probes on an environment. `edge_texels` of the fragment is not read.
    #[inline]
    fn reflect(fragment: &ReflectionIn, environment: &Environment<Self>) -> Footprint<Self> {
        const { assert!(!matches!(Self::EFFECTS.footprint, FootprintKind::Sphere), "a footprint on the sphere is a sweep") }
        let out = reflected(fragment, environment);
        Footprint { point: out.point, probes: out.probes, status: out.status }
    }

    /// The same with a footprint on the sphere, for wide lobes.
    #[inline]
    fn sweep(fragment: &ReflectionIn, environment: &Environment<Self>) -> SphereFootprint<Self> {
        const { assert!(matches!(Self::EFFECTS.footprint, FootprintKind::Sphere), "a sweep is a footprint on the sphere") }
        let out = reflected(fragment, environment);
        SphereFootprint { sweep: out.sweep, last_level: environment.0.last_level, status: out.status }
    }

    /// The same with the outcome of every stage: what golden vectors hold.
    #[inline]
    fn reflection(fragment: &ReflectionIn) -> ReflectionOut {
        let plan = const { Self::EFFECTS.reflection() };
        let input = of_ports::<Word<Self>, _>(&fragment.wires());
        Port::of(&to_ports(&datapath::fragment(&input, &plan, knobs::<Self>())))
    }

    /// The highlight of one light.
    #[inline]
    fn highlight(fragment: &HighlightIn) -> HighlightOut {
        let plan = const { Self::EFFECTS.highlight() };
        let input = of_ports::<Word<Self>, _>(&fragment.wires());
        let lit = datapath::lit_surface(&input, &plan, knobs::<Self>());
        Port::of(&to_ports(&datapath::leave_highlight(&lit)))
    }

    /// One light on one stored peak.
    #[inline]
    fn peak(fragment: &PeakIn) -> PeakOut {
        let plan = const { Self::EFFECTS.peak() };
        let input = of_ports::<Word<Self>, _>(&fragment.wires());
        Port::of(&to_ports(&datapath::lit_peak(&input, &plan, knobs::<Self>())))
    }

    /// The constants of a repeated map, edges read as 1…16384. Once per map; the only division.
    #[inline]
    fn texture(size: [u16; 2]) -> Texture<Self> {
        let (scale, map) = texture_scale(size);
        Texture { scale: of_ports::<Word<Self>, _>(&scale), map: of_ports::<Word<Self>, _>(&map) }
    }

    /// The footprint of a pixel in a repeated map.
    #[inline]
    fn texture_footprint(fragment: &TextureIn, texture: &Texture<Self>) -> MapFootprint<Self> {
        let wires = of_ports::<Word<Self>, _>(&fragment.wires());
        let out = datapath::texture_footprint(&wires.duv, &texture.scale, &texture.map, knobs::<Self>());
        MapFootprint { centre: TexturePosition { uv: wires.uv }, probes: out.probes, scale: texture.scale }
    }
}

/// A probe as its ports.
#[inline(always)]
fn cube_probe<F: Firmware>(place: &FacePosition<Word<F>>, weight: Control<Word<F>, SHARE>) -> CubeProbe {
    CubeProbe {
        face: place.face.raw().integer() as u8,
        st: place.st.map(|s| Port::of(&Fx::from_raw(s.raw().integer()))),
        weight: Port::of(&Fx::from_raw(weight.raw().integer())),
    }
}

/// A fragment through the reflection datapath.
#[inline(always)]
fn reflected<F: Firmware>(fragment: &ReflectionIn, environment: &Environment<F>) -> Reflection<Word<F>> {
    let plan = const { F::EFFECTS.reflection() };
    let input = of_ports::<Word<F>, _>(&fragment.wires());
    datapath::reflection(&input, &environment.0, &plan, knobs::<F>())
}

/// The constants of an environment.
#[derive(Clone, Copy, Debug)]
pub struct Environment<F: Firmware>(MapScale<Word<F>>);

/// What a fragment reflects: a place on the environment and the probes around it.
#[derive(Clone, Copy, Debug)]
pub struct Footprint<F: Firmware> {
    point: CubePoint<Word<F>>,
    probes: Probes<Word<F>>,
    status: Int<Word<F>>,
}

impl<F: Firmware> Footprint<F> {
    /// Face 0 to 5: +x, −x, +y, −y, +z, −z.
    #[inline]
    pub fn face(&self) -> u8 {
        self.point.select.index().raw().integer() as u8
    }

    /// The centre on the face.
    #[inline]
    pub fn st(&self) -> FacePlace {
        self.point.st.map(|s| Port::of(&Fx::from_raw(s.raw().to_port())))
    }

    /// Level of detail, 0 to log₂ of the edge.
    #[inline]
    pub fn lod(&self) -> Level {
        Level::from_bits(self.probes.lod.raw().integer())
    }

    /// Sticky bits, [`StatusBit`](crate::status::StatusBit).
    #[inline]
    pub fn status(&self) -> u32 {
        self.status.raw().integer() as u32
    }

    /// The probes, 1 to 16; each is worked out when it is asked for.
    #[inline]
    pub fn probes(&self) -> impl ExactSizeIterator<Item = CubeProbe> + '_ {
        (0..self.probes.count.raw().integer() as usize).map(|index| {
            let probe = datapath::environment_probe(&self.point, &self.probes, int::<F>(index as i32), knobs::<F>());
            cube_probe::<F>(&probe.place, probe.weight)
        })
    }

    /// The mean light of the footprint, trilinear at every probe, I8F24; that of a rough surface with the roughness bias of the level.
    #[inline]
    pub fn colour<M: CubeMemory>(&self, cube: &Cube<'_, M>) -> Light {
        let rough = const { !matches!(F::EFFECTS.roughness, RoughnessKind::None) };
        let light = sampler::environment::<Word<F>, M>(&self.point, &self.probes, rough, cube, knobs::<F>());
        light.map(|channel| Port::of(&Fx::from_raw(channel.0.raw().integer())))
    }
}

/// What a fragment with a wide lobe reflects: the directions that its probes look along.
#[derive(Clone, Copy, Debug)]
pub struct SphereFootprint<F: Firmware> {
    sweep: Sweep<Word<F>>,
    last_level: Int<Word<F>>,
    status: Int<Word<F>>,
}

impl<F: Firmware> SphereFootprint<F> {
    /// Sticky bits, [`StatusBit`](crate::status::StatusBit).
    #[inline]
    pub fn status(&self) -> u32 {
        self.status.raw().integer() as u32
    }

    /// The probes, 1 to 16, each with a level of detail of its own; each is worked out when it is asked for.
    #[inline]
    pub fn probes(&self) -> impl ExactSizeIterator<Item = (CubeProbe, Level)> + '_ {
        (0..self.sweep.count.raw().integer() as usize).map(|index| {
            let index = int::<F>(index as i32);
            let probe = datapath::sphere_probe(&self.sweep, index, self.last_level, knobs::<F>());
            (cube_probe::<F>(&probe.place, probe.weight), Level::from_bits(probe.lod.raw().integer()))
        })
    }

    /// The mean light of the footprint, trilinear at every probe, I8F24; that of a rough surface with the roughness bias of the level.
    #[inline]
    pub fn colour<M: CubeMemory>(&self, cube: &Cube<'_, M>) -> Light {
        let rough = const { !matches!(F::EFFECTS.roughness, RoughnessKind::None) };
        let light = sampler::swept_environment::<Word<F>, M>(&self.sweep, rough, cube, knobs::<F>());
        light.map(|channel| Port::of(&Fx::from_raw(channel.0.raw().integer())))
    }
}

/// The constants of a repeated map.
#[derive(Clone, Copy, Debug)]
pub struct Texture<F: Firmware> {
    scale: TextureScale<Word<F>>,
    map: MapScale<Word<F>>,
}

/// What a fragment sees of a repeated map.
#[derive(Clone, Copy, Debug)]
pub struct MapFootprint<F: Firmware> {
    centre: TexturePosition<Word<F>>,
    probes: Probes<Word<F>>,
    scale: TextureScale<Word<F>>,
}

impl<F: Firmware> MapFootprint<F> {
    /// Level of detail, 0 to log₂ of the longer edge.
    #[inline]
    pub fn lod(&self) -> Level {
        Level::from_bits(self.probes.lod.raw().integer())
    }

    /// The probes, 1 to 16; each is worked out when it is asked for.
    #[inline]
    pub fn probes(&self) -> impl ExactSizeIterator<Item = MapProbe> + '_ {
        (0..self.probes.count.raw().integer() as usize).map(|index| {
            let Self { centre, probes, scale } = self;
            let probe = datapath::texture_probe(centre, probes, int::<F>(index as i32), scale, knobs::<F>());
            MapProbe {
                uv: probe.place.uv.map(|u| Port::of(&Fx::from_raw(wide_integer::<F>(u.raw())))),
                weight: Port::of(&Fx::from_raw(probe.weight.raw().integer())),
            }
        })
    }
}

#[inline(always)]
fn wide_integer<F: Firmware>(wide: <Count<F> as word::Word>::Wide) -> i64 {
    <Count<F> as IntegerCount>::wide_integer(wide)
}
