//! Wrapped maps: the footprints of fragments in them, colours, and bumps with their second moments.

use roughxel_core::bundle::{Bundle, Value};
use roughxel_core::datapath::texel::{self, BumpMoments, BumpSample, BumpScale};
use roughxel_core::datapath::{self, TextureFootprint, pixel};
use roughxel_core::each::each;
use roughxel_core::fx::{Control, Fx, Int};
use roughxel_core::ports::{LIGHT, PortBlock};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::signals::{MapScale, TexturePosition, WrappedFootprint};
use roughxel_core::stage::texture::TextureScale;
use roughxel_core::word::Word;
use roughxel_core::wrapped::{self, Mean, Neighbours, View};
use roughxel_simd::BatchWord;

use crate::batch::Batch;
use crate::pass::{Group, Pass, runs};
use crate::signals::{FilteredBump, ShadedColour};
use crate::texels::{BumpTexels, MapTexels, WrappedMap};

runs!(TextureFootprints Colours Bumps);

/// A colour map.
#[derive(Clone, Debug)]
pub struct ColourMap {
    /// Texels of the map.
    pub texels: MapTexels<[u16; 3]>,
    /// log₂ of the unit of the channels.
    pub exponent: i32,
}

/// A bump map with its roughness.
#[derive(Clone, Debug)]
pub struct BumpMap {
    /// Texels of the map.
    pub texels: BumpTexels,
    /// Units of offsets and roughness.
    pub scale: BumpScale<i32>,
}

/// Derivatives of texture coordinates over a pixel.
pub type TextureDerivatives = [PortBlock<i32, 2>; 2];

/// Footprints in maps of one scale: texture, ellipse, axes, probes.
#[derive(Clone, Copy, Debug)]
pub struct TextureFootprints<'a> {
    /// Derivatives of texture coordinates over a pixel.
    pub derivatives: &'a Batch<TextureDerivatives>,
    /// Scale of the maps.
    pub scale: &'a (TextureScale<i32>, MapScale<i32>),
    /// True if bumps with roughness are among the maps: they need the reach of probes.
    pub is_rough: bool,
}

impl Pass for TextureFootprints<'_> {
    type Output = WrappedFootprint<i32>;
    fn len(&self) -> usize {
        self.derivatives.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> WrappedFootprint<W> {
        let (duv, texture, scale) = (group.load(self.derivatives), group.all(&self.scale.0), group.all(&self.scale.1));
        let TextureFootprint { axes, probes, .. } = datapath::texture_footprint(&duv, &texture, &scale, p);
        let reach = if self.is_rough {
            datapath::probe_reach([&axes.major, &axes.minor], &probes, &texture, p)
        } else {
            Fx::zero()
        };
        WrappedFootprint { probes, reach }
    }
}

/// Places of fragments in a wrapped map.
#[derive(Clone, Copy, Debug)]
pub struct Places<'a> {
    /// Texture coordinates.
    pub centres: &'a Batch<TexturePosition<i32>>,
    /// Footprints around the centres; none if nothing is filtered.
    pub footprints: Option<&'a Batch<WrappedFootprint<i32>>>,
}

/// Calls `body` with the views of a group.
#[inline(always)]
pub(crate) fn viewed<W: BatchWord, R>(
    group: &Group<W>,
    places: Places<'_>,
    map: &WrappedMap,
    is_rough: bool,
    body: impl FnOnce(&View<'_, W>) -> R,
) -> R {
    let centre = &group.load(places.centres);
    let footprint = places.footprints.map(
        #[inline(always)]
        |footprints| (group.load(footprints), group.all(&map.scale.0)),
    );
    let footprint = footprint.as_ref().map(
        #[inline(always)]
        |(footprint, texture)| (footprint, texture),
    );
    body(&View { centre, footprint, levels: &map.levels, rough: is_rough })
}

/// Colours of a map times one of the object: filter, pixel (colour, modulated).
#[derive(Clone, Copy, Debug)]
pub struct Colours<'a> {
    /// Places of the fragments in the map.
    pub places: Places<'a>,
    /// The map.
    pub map: &'a ColourMap,
    /// The colour of the object.
    pub own: &'a [Control<i32, LIGHT>; 3],
}

impl Pass for Colours<'_> {
    type Output = ShadedColour<i32>;
    fn len(&self) -> usize {
        self.places.centres.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> ShadedColour<W> {
        let ColourMap { texels, exponent } = self.map;
        let mean = viewed(
            group,
            self.places,
            &texels.map,
            false,
            #[inline(always)]
            |view| {
                wrapped::mean(
                    view,
                    #[inline(always)]
                    |neighbours: &Neighbours<W>, _| {
                        fetched(
                            #[inline(always)]
                            || texels.quad(neighbours),
                        )
                    },
                    texel::colour_samples::<W, _>,
                    same::<W, 3>,
                    p,
                )
            },
        );
        let unit = Fx::int((*exponent).into());
        let channels = each!(i in [0, 1, 2] => {
            let own = group.all(&Value(self.own[i])).0;
            pixel::modulated::<W>(pixel::colour::<W>(mean.channels[i], unit), own)
        });
        ShadedColour { channels, samples: mean.samples }
    }
}

/// Reads texels in a separate function, like a stage: a pass reads them in several places.
#[inline(always)]
fn fetched<W: BatchWord, B: Bundle<W>>(texels: impl Fn() -> B + Copy) -> B {
    W::stage("memory", texels)
}

#[inline(always)]
fn same<W: Word, const CHANNELS: usize>(sample: [Int<W>; CHANNELS]) -> [Int<W>; CHANNELS] {
    sample
}

/// Mean offsets and roughness of a map, as surfaces take them: filter, moments, pixel (bump).
#[derive(Clone, Copy, Debug)]
pub struct Bumps<'a> {
    /// Places of the fragments in the map.
    pub places: Places<'a>,
    /// The map.
    pub map: &'a BumpMap,
    /// Requested roughness.
    pub kind: RoughnessKind,
}

impl Pass for Bumps<'_> {
    type Output = FilteredBump<i32>;
    fn len(&self) -> usize {
        self.places.centres.len()
    }
    #[inline(always)]
    fn group<W: BatchWord>(&self, group: &Group<W>, p: &Precision) -> FilteredBump<W> {
        let BumpMap { texels, scale } = self.map;
        let (is_rough, scale) = (self.kind != RoughnessKind::None, &group.all(scale));
        let Mean { channels, samples } = viewed(
            group,
            self.places,
            texels.map(),
            is_rough,
            #[inline(always)]
            |view| if is_rough { rough_moments(view, texels, scale, p) } else { offsets(view, texels, scale, p) },
        );
        FilteredBump { bump: texel::bump(&BumpMoments::<W>::of_words(channels), scale, self.kind, p), samples }
    }
}

/// Offsets alone.
#[inline(always)]
fn offsets<W: BatchWord>(view: &View<'_, W>, texels: &BumpTexels, scale: &BumpScale<W>, p: &Precision) -> Mean<W, 5> {
    let Mean { channels: [b1, b2], samples } = wrapped::mean(
        view,
        #[inline(always)]
        |neighbours: &Neighbours<W>, _| {
            fetched(
                #[inline(always)]
                || texels.quad(neighbours, scale),
            )
        },
        texel::word_samples::<W, _>,
        same::<W, 2>,
        p,
    );
    Mean { channels: [b1, b2, Fx::zero(), Fx::zero(), Fx::zero()], samples }
}

/// Offsets with their second moments.
#[inline(always)]
fn rough_moments<W: BatchWord>(
    view: &View<'_, W>,
    texels: &BumpTexels,
    scale: &BumpScale<W>,
    p: &Precision,
) -> Mean<W, 5> {
    let reach = view.footprint.map(
        #[inline(always)]
        |(footprint, _)| footprint.reach,
    );
    wrapped::mean(
        view,
        #[inline(always)]
        |neighbours: &Neighbours<W>, _| {
            fetched(
                #[inline(always)]
                || texels.quad(neighbours, scale),
            )
        },
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
    )
}
