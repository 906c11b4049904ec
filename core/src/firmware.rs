//! Datapaths for firmware. Effects and accuracy are a type, so a program holds only the code that they need, with or without link-time optimisation.
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
//! A fragment ([`ReflectionIn`]) gives a [`FaceFootprint`] by `Chrome::reflect`. Its [`probes`](FaceFootprint::probes) say where to read, or its
//! [`colour`](FaceFootprint::colour) reads a [`CubeMemory`] that the program supplies. A wide lobe has a [`SphereFootprint`], by `sweep`. A
//! [`Batch`] of fragments has the same footprints, and its code stays in a small instruction cache. Nothing allocates, panics or names a float. Nothing
//! divides except the set-up of a map (`Chrome::texture`). Small processors have a backend of their own ([`mod@crate::small`]) with the bits of every
//! other backend.
//!
//! Build with `opt-level = 3`. The stages are inlined at any level, and constants remove what the plan leaves out. `"s"` makes them larger *and*
//! slower (rv32imac, all effects: 6.7 KB and 8400 instructions more), for it leaves the small functions between them as calls. The feature
//! `small-code` makes programs smaller: it normalises blocks by calls, with a fifth (`Standard`) to a third (`Narrow`) fewer bytes for 1.6 times the
//! instructions.

mod batch;

use crate::datapath::{self, Reflection};
use crate::fx::{Control, Fx, Int};
use crate::plan::{Effects, FootprintKind};
use crate::ports::{
    CubeProbe, FacePlace, HighlightIn, HighlightOut, Level, Light, MapProbe, PeakIn, PeakOut, Port, ReflectionIn,
    ReflectionOut, SHARE, TextureIn,
};
use crate::precision::{Precision, RoughnessKind};
use crate::sampler::{self, Cube, CubeMemory};
use crate::scalar_api::texture_scale;
use crate::signals::{CubePoint, FacePosition, MapScale, Probes, Sweep, TexturePosition};
use crate::stage::texture::TextureScale;
use crate::width::{self, IntegerCount, IntegerWord, Whole, of_ports, to_ports};
use crate::word::{self, Wire};

pub use batch::Batch;

/// An accuracy as a type: one of the named profiles below, or a type with other knobs.
pub trait Accuracy {
    /// [`width::Narrow`] if the knobs keep at most 14 bits, else [`width::Whole`]; the other does not compile.
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

/// Word of a firmware.
type Word<F> = <<F as Firmware>::Accuracy as Accuracy>::Word;
/// Control word of a firmware.
type Count<F> = <Word<F> as Wire>::Count;

/// Knobs of a firmware, checked against the width of its word.
#[inline(always)]
fn knobs<F: Firmware>() -> &'static Precision {
    const {
        assert!(Word::<F>::BITS == F::Accuracy::PRECISION.word_bits(), "the knobs need a word of another width");
        &F::Accuracy::PRECISION
    }
}

/// Control integer of a firmware.
#[inline(always)]
fn int<F: Firmware>(integer: i32) -> Int<Word<F>> {
    Fx::from_raw(IntegerCount::of_integer(integer))
}

/// Effects and accuracy of a program, or of one of its materials. Implement it for a type of the program.
pub trait Firmware: Sized {
    /// Accuracy of the arithmetic.
    type Accuracy: Accuracy;
    /// Simulated effects; a program has no stages of other effects.
    const EFFECTS: Effects;

    /// Constants of an environment whose faces have `edge` texels, read as 1…16384. Once per environment.
    #[inline]
    fn environment(edge: u16) -> Environment<Self> {
        if const { Self::EFFECTS.footprint.is_some() } {
            Environment(datapath::map_scale(int::<Self>(edge.into()), knobs::<Self>()))
        } else {
            // Without a footprint no level is read.
            Environment(MapScale { log2_texels: Fx::zero(), last_level: Fx::zero() })
        }
    }

    /// Runs a fragment from its surface to the probes on an environment. `edge_texels` of the fragment is not read.
    #[inline]
    fn reflect(fragment: &ReflectionIn, environment: &Environment<Self>) -> FaceFootprint<Self> {
        const { assert!(!matches!(Self::EFFECTS.footprint, FootprintKind::Sphere), "a footprint on the sphere is a sweep") }
        let out = reflected(fragment, environment);
        FaceFootprint { point: out.point, probes: out.probes, status: out.status }
    }

    /// Runs a fragment as [`Self::reflect`] does, with a footprint on the sphere, for wide lobes.
    #[inline]
    fn sweep(fragment: &ReflectionIn, environment: &Environment<Self>) -> SphereFootprint<Self> {
        const { assert!(matches!(Self::EFFECTS.footprint, FootprintKind::Sphere), "a sweep is a footprint on the sphere") }
        let out = reflected(fragment, environment);
        SphereFootprint { sweep: out.sweep, last_level: environment.0.last_level, status: out.status }
    }

    /// Runs the reflection datapath with the outcome of every stage, which golden vectors hold.
    #[inline]
    fn reflection(fragment: &ReflectionIn) -> ReflectionOut {
        let plan = const { Self::EFFECTS.reflection() };
        let input = of_ports::<Word<Self>, _>(&fragment.wires());
        Port::from_wires(&to_ports(&datapath::fragment(&input, &plan, knobs::<Self>())))
    }

    /// Highlight of one light.
    #[inline]
    fn highlight(fragment: &HighlightIn) -> HighlightOut {
        let plan = const { Self::EFFECTS.highlight() };
        let input = of_ports::<Word<Self>, _>(&fragment.wires());
        let lit = datapath::lit_surface(&input, &plan, knobs::<Self>());
        Port::from_wires(&to_ports(&datapath::leave_highlight(&lit)))
    }

    /// One light on one stored peak.
    #[inline]
    fn peak(fragment: &PeakIn) -> PeakOut {
        let plan = const { Self::EFFECTS.peak() };
        let input = of_ports::<Word<Self>, _>(&fragment.wires());
        Port::from_wires(&to_ports(&datapath::lit_peak(&input, &plan, knobs::<Self>())))
    }

    /// Constants of a wrapped map, edges read as 1…16384. Once per map; the only division.
    #[inline]
    fn texture(size: [u16; 2]) -> Texture<Self> {
        let (scale, map) = texture_scale(size);
        Texture { scale: of_ports::<Word<Self>, _>(&scale), map: of_ports::<Word<Self>, _>(&map) }
    }

    /// Footprint of a pixel in a wrapped map.
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
        st: place.st.map(|s| Port::from_wires(&Fx::from_raw(s.raw().integer()))),
        weight: Port::from_wires(&Fx::from_raw(weight.raw().integer())),
    }
}

/// Runs a fragment through the reflection datapath.
#[inline(always)]
fn reflected<F: Firmware>(fragment: &ReflectionIn, environment: &Environment<F>) -> Reflection<Word<F>> {
    let plan = const { F::EFFECTS.reflection() };
    let input = of_ports::<Word<F>, _>(&fragment.wires());
    datapath::reflection(&input, &environment.0, &plan, knobs::<F>())
}

/// The constants of an environment.
#[derive(Clone, Copy, Debug)]
pub struct Environment<F: Firmware>(MapScale<Word<F>>);

/// Reflection of a fragment: a place on the environment and the probes around it.
#[derive(Clone, Copy, Debug)]
pub struct FaceFootprint<F: Firmware> {
    point: CubePoint<Word<F>>,
    probes: Probes<Word<F>>,
    status: Int<Word<F>>,
}

impl<F: Firmware> FaceFootprint<F> {
    /// Face 0 to 5: +x, −x, +y, −y, +z, −z.
    #[inline]
    pub fn face(&self) -> u8 {
        self.point.select.index().raw().integer() as u8
    }

    /// The centre on the face.
    #[inline]
    pub fn st(&self) -> FacePlace {
        self.point.st.map(|s| Port::from_wires(&Fx::from_raw(s.raw().to_port())))
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

    /// Probes, 1 to 16; each is computed on demand.
    #[inline]
    pub fn probes(&self) -> impl ExactSizeIterator<Item = CubeProbe> + '_ {
        (0..self.probes.count.raw().integer() as usize).map(|index| {
            let probe = datapath::environment_probe(&self.point, &self.probes, int::<F>(index as i32), knobs::<F>());
            cube_probe::<F>(&probe.place, probe.weight)
        })
    }

    /// Mean light of the footprint, trilinear at every probe, I8F24. The footprint of a rough surface has the roughness bias of the level.
    #[inline]
    pub fn colour<M: CubeMemory>(&self, cube: &Cube<'_, M>) -> Light {
        let rough = const { !matches!(F::EFFECTS.roughness, RoughnessKind::None) };
        let light = sampler::environment::<Word<F>, M>(&self.point, &self.probes, rough, cube, knobs::<F>());
        light.map(|channel| Port::from_wires(&Fx::from_raw(channel.0.raw().integer())))
    }
}

/// Reflection of a fragment with a wide lobe: the directions of its probes.
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

    /// Probes, 1 to 16, each with its own level of detail and computed on demand.
    #[inline]
    pub fn probes(&self) -> impl ExactSizeIterator<Item = (CubeProbe, Level)> + '_ {
        (0..self.sweep.count.raw().integer() as usize).map(|index| {
            let index = int::<F>(index as i32);
            let probe = datapath::sphere_probe(&self.sweep, index, self.last_level, knobs::<F>());
            (cube_probe::<F>(&probe.place, probe.weight), Level::from_bits(probe.lod.raw().integer()))
        })
    }

    /// Mean light of the footprint, trilinear at every probe, I8F24. The footprint of a rough surface has the roughness bias of the level.
    #[inline]
    pub fn colour<M: CubeMemory>(&self, cube: &Cube<'_, M>) -> Light {
        let rough = const { !matches!(F::EFFECTS.roughness, RoughnessKind::None) };
        let light = sampler::swept_environment::<Word<F>, M>(&self.sweep, rough, cube, knobs::<F>());
        light.map(|channel| Port::from_wires(&Fx::from_raw(channel.0.raw().integer())))
    }
}

/// Constants of a wrapped map.
#[derive(Clone, Copy, Debug)]
pub struct Texture<F: Firmware> {
    scale: TextureScale<Word<F>>,
    map: MapScale<Word<F>>,
}

/// Footprint of a fragment in a wrapped map.
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

    /// Probes, 1 to 16; each is computed on demand.
    #[inline]
    pub fn probes(&self) -> impl ExactSizeIterator<Item = MapProbe> + '_ {
        (0..self.probes.count.raw().integer() as usize).map(|index| {
            let Self { centre, probes, scale } = self;
            let probe = datapath::texture_probe(centre, probes, int::<F>(index as i32), scale, knobs::<F>());
            MapProbe {
                uv: probe.place.uv.map(|u| Port::from_wires(&Fx::from_raw(wide_integer::<F>(u.raw())))),
                weight: Port::from_wires(&Fx::from_raw(probe.weight.raw().integer())),
            }
        })
    }
}

#[inline(always)]
fn wide_integer<F: Firmware>(wide: <Count<F> as word::Word>::Wide) -> i64 {
    <Count<F> as IntegerCount>::wide_integer(wide)
}
