//! Designs: functions that can be recorded, proven, made into hardware and compared with other backends, each with its ports.
//!
//! `fragment`, `highlight` and `lit_peak` are the three datapaths from ports to ports. The others are the functions of the composer that a frame
//! calls between texel and pixel, one each: footprints, probes, addresses, samples, sums, bumps, colours. The declaration of a port includes its
//! range. A design is a type, so any backend runs the same function; [`Design`] is the list.

use crate::block::Block;
use crate::bundle::{Bundle, Value};
use crate::datapath::pixel::{self, PixelSum};
use crate::datapath::texel::{self, Bump, BumpMoments, BumpSample, RepeatAddress};
use crate::datapath::{self, LobeLaw, Reflection, TextureFootprint};
use crate::plan::{Datapath, Effects, HorizonKind};
use crate::ports::{
    HighlightInput, HighlightOutput, LIGHT, PeakInput, PeakOutput, ReflectionInput, ReflectionOutput, SHARE,
};
use crate::precision::Precision;
use crate::scalar::Scalar;
use crate::signals::{FaceProbe, LocalDirection, MapScale, PeakSum, SphereProbe, TextureProbe};
use crate::stage::filter::{Address, LevelPair, Patch, ProbeSum};
use crate::stage::seam::CubeTexel;
use crate::staged::Staged;

mod inputs;

pub use inputs::*;

/// A function of the composer with its ports.
pub trait Recorded {
    /// Input ports.
    type Input: Form;
    /// Output ports.
    type Output: Form;
    /// Runs the function on any backend, with those of the effects that it has.
    fn run<W: Staged>(input: &In<Self::Input, W>, effects: &Effects, p: &Precision) -> In<Self::Output, W>;
}

/// A bundle on the scalar backend, from which the bundles of all other backends are made.
pub trait Form: Bundle<Scalar, In<Scalar> = Self> {}

impl<B: Bundle<Scalar, In<Scalar> = B>> Form for B {}

/// Structure of wires on the backend `W`.
pub type In<B, W> = <B as Bundle<Scalar>>::In<W>;

/// A computation that runs on any design.
pub trait Visitor {
    /// Result of the computation.
    type Outcome;
    /// Runs it on the design `D`.
    fn visit<D: Recorded>(self) -> Self::Outcome;
}

/// A design as a type, by its place in [`Design::ALL`].
#[derive(Clone, Copy, Debug)]
pub struct Of<const DESIGN: usize>;

macro_rules! designs {
    ($(
        #[doc = $doc:literal]
        $name:ident $label:literal $($datapath:ident)?: $input:ident -> $output:ty,
        |$in:ident, $effects:pat_param, $p:pat_param| $body:expr;
    )*) => {
        /// Every design, in the order in which a fragment meets them.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Design {
            $(
                #[doc = $doc]
                $name,
            )*
        }

        impl Design {
            /// Every design.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// Name of the design and of its top module.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $label,)*
                }
            }

            /// Description in one sentence.
            pub fn description(self) -> &'static str {
                match self {
                    $(Self::$name => $doc,)*
                }
                .trim_ascii()
            }

            /// Datapath that is this design as a whole. Effects matter to such a design only.
            pub const fn datapath(self) -> Option<Datapath> {
                match self {
                    $(Self::$name => designs!(@datapath $($datapath)?),)*
                }
            }

            /// Runs a visitor on the design.
            pub fn visit<V: Visitor>(self, visitor: V) -> V::Outcome {
                match self {
                    $(Self::$name => visitor.visit::<Of<{ Design::$name as usize }>>(),)*
                }
            }
        }

        $(impl Recorded for Of<{ Design::$name as usize }> {
            type Input = $input<Scalar>;
            type Output = $output;
            #[inline(always)]
            fn run<W: Staged>($in: &$input<W>, $effects: &Effects, $p: &Precision) -> In<$output, W> {
                $body
            }
        })*
    };
    (@datapath) => { None };
    (@datapath $datapath:ident) => { Some(Datapath::$datapath) };
}

impl Design {
    /// Design whose ports are those of a datapath's vectors.
    pub const fn for_datapath(datapath: Datapath) -> Self {
        match datapath {
            Datapath::Reflection => Self::Fragment,
            Datapath::Highlight => Self::Highlight,
            Datapath::Peak => Self::LitPeak,
        }
    }

    /// Finds a design by its name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|design| design.name() == name)
    }
}

type S = Scalar;

designs! {
    /// log2 of the size of an environment's faces
    MapScale "map_scale": Edge -> MapScale<S>, |input, _, p| datapath::map_scale(input.edge_texels, p);

    /// footprint of a pixel in a wrapped map: columns, ellipse, axes, probes
    Texture "texture": MapFootprintInput -> TextureFootprint<S>,
        |input, _, p| datapath::texture_footprint(&input.duv, &input.texture, &input.map, p);

    /// part of a texel that a probe of a footprint in a wrapped map spans across
    ProbeReach "probe_reach": ProbeReachInput -> Value<S, SHARE>,
        |input, _, p| {
            let [major, minor] = [input.major, input.minor].map(|sigma| Block { m: sigma.m, e: sigma.e });
            Value(datapath::probe_reach([&major, &minor], &input.probes, &input.texture, p))
        };

    /// place and weight of one probe in a wrapped map
    TextureProbe "texture_probe": TextureProbeInput -> TextureProbe<S>,
        |input, _, p| datapath::texture_probe(&input.centre, &input.probes, input.index, &input.texture, p);

    /// texels and weights of a bilinear sample of a wrapped map
    RepeatAddress "repeat_address": RepeatAddressInput -> RepeatAddress<S>,
        |input, _, p| texel::repeat_address(&input.place, input.size, p);

    /// texel of a bump map from its codes: offset and covariance
    BumpTexel "bump_texel": BumpTexelInput -> BumpSample<S>,
        |input, _, p| texel::bump_texel(&input.codes, &input.scale, p.roughness);

    /// sample of a bump map with the roughness of the ramp between its texels, one probe
    BumpRamp "bump_ramp": BumpRampInput -> BumpSample<S>,
        |input, _, _| {
            texel::bump_ramp(&input.sample, &[input.fine, input.coarse], input.level_weight, input.reach)
        };

    /// sample of a bump map to second moments, one probe
    BumpProbe "bump_probe": BumpSample -> BumpMoments<S>, |input, _, _| texel::bump_probe(input);

    /// mean moments to offset and roughness d1, d2, d3 or I1
    Bump "bump": BumpInput -> Bump<S>, |input, _, p| texel::bump(&input.mean, &input.scale, p.roughness, p);

    /// the whole reflection datapath with the ports of a vector word: edge of the map in, port formats out
    Fragment "fragment" Reflection: ReflectionInput -> ReflectionOutput<S>,
        |input, effects, p| datapath::fragment(input, &effects.reflection(), p);

    /// the reflection datapath: frame, perturb, reflect, cube face, columns, ellipse, axes, probes
    Reflection "reflection" Reflection: ScaledReflectionInput -> Reflection<S>,
        |input, effects, p| datapath::reflection(&input.fragment, &input.map, &effects.reflection(), p);

    /// place and weight of one probe on the cube
    EnvironmentProbe "environment_probe": EnvironmentProbeInput -> FaceProbe<S>,
        |input, _, p| datapath::environment_probe(&input.point, &input.probes, input.index, p);

    /// place, level of detail and weight of one probe of a footprint on the sphere
    SphereProbe "sphere_probe": SphereProbeInput -> SphereProbe<S>,
        |input, _, p| datapath::sphere_probe(&input.sweep, input.index, input.last_level, p);

    /// level of detail to two levels and a weight, with the bias of rough reflections
    Levels "levels": LevelsInput -> LevelPair<S>, |input, _, p| texel::levels(input.lod, input.rough, p);

    /// texels and weights of a bilinear sample of a cube face
    FaceAddress "face_address": FaceAddressInput -> Address<S>,
        |input, _, p| texel::face_address(&input.place, input.edge, p);

    /// the texels of a bilinear sample of a cube face, across its edges if needed; three at a corner
    FaceTexels "face_texels": FaceTexelsInput -> [CubeTexel<S>; 4],
        |input, _, _| texel::face_texels(input.face, &input.address, input.edge);

    /// the texel at a corner of the cube
    Corner "corner": CornerInput -> Value<S, 32>, |input, _, _| Value(texel::corner::<W>(&input.texels));

    /// a channel of a texel of a bright environment from its code
    BrightTexel "bright_texel": BrightTexelInput -> Value<S, 32>,
        |input, _, _| Value(texel::bright_texel::<W>(input.code));

    /// the bright texel at a corner of the cube
    BrightCorner "bright_corner": BrightCornerInput -> Value<S, 32>,
        |input, _, _| Value(texel::bright_corner::<W>(&input.texels));

    /// trilinear interpolation of a channel of 16-bit texels
    ColourSample "colour_sample": ColourSampleInput -> Value<S, 32>, |input, _, _| {
        let patch = |level: usize| Patch::<W> { texels: input.texels[level], weight: input.weights[level] };
        Value(texel::colour_sample(&patch(0), &patch(1), input.level_weight))
    };

    /// trilinear interpolation of a channel of words: bumps, moments, light of peaks, bright texels
    WordSample "word_sample": WordSampleInput -> Value<S, 32>,
        |input, _, _| Value(texel::word_sample(&input.fine, &input.coarse, input.level_weight));

    /// weighted sum over probes, with one sample added
    ProbeSum "probe_sum": ProbeSumInput -> ProbeSum<S>,
        |input, _, _| texel::probe_sum(&input.sum, input.sample, input.weight);

    /// the mean of the weighted sum
    ProbeMean "probe_mean": ProbeSum -> Value<S, 32>, |input, _, _| Value(texel::probe_mean(input));

    /// a mean of texels as a colour
    Colour "colour": ColourInput -> Value<S, LIGHT>, |input, _, _| Value(pixel::colour::<W>(input.sample, input.exponent));

    /// the product of two colours
    Modulated "modulated": ModulatedInput -> Value<S, LIGHT>,
        |input, _, _| Value(pixel::modulated::<W>(input.colours[0], input.colours[1]));

    /// weight and widths of two lobes between two levels of a map
    LobeLaw "lobe_law": LobeLawInput -> LobeLaw<S>,
        |input, _, _| datapath::lobe_law(&input.fine, &input.coarse, input.level_weight);

    /// the roughness tangents of one of two lobes
    Lobe "lobe": LobeInput -> [Block<S, 3>; 2], |input, _, p| datapath::lobe(&input.rough, input.width, p);

    /// the weighted mean of the colours of two lobes of a surface
    Lobes "lobes": LobesInput -> Value<S, LIGHT>,
        |input, _, _| Value(pixel::lobes::<W>(input.colours, input.weight));

    /// one light on a surface: frame, perturb, roughness, half vector, modified Blinn-Phong
    Highlight "highlight" Highlight: HighlightInput -> HighlightOutput<S>,
        |input, effects, p| datapath::leave_highlight(&datapath::lit_surface(input, &effects.highlight(), p));

    /// one light on one peak of a surface: frame, half vector, horizon, peak
    LitPeak "lit_peak" Peak: PeakInput -> PeakOutput<S>,
        |input, effects, p| datapath::lit_peak(input, &effects.peak(), p);

    /// surface and reflection by reflectance
    Blend "blend": BlendInput -> Value<S, LIGHT>,
        |input, _, _| Value(pixel::blend::<W>(input.surface, input.reflection, input.reflectance));

    /// surface and a mean of bright texels by reflectance
    BrightBlend "bright_blend": BrightBlendInput -> Value<S, LIGHT>, |input, _, _| {
        Value(pixel::bright_blend::<W>(input.surface, input.mean, input.exponent, input.reflectance))
    };

    /// a direction in the tangent basis of a surface, at unit length
    Local "local": LocalInput -> LocalDirection<S>,
        |input, _, p| datapath::local_direction(&input.direction, &input.frame, &input.normal, p);

    /// light of a distribution of normals, with one stored peak added
    Peak "peak": StoredPeakInput -> PeakSum<S>, |input, _, p| {
        datapath::peak_sum(&input.sum, datapath::packed_peak(&input.half, input.words, input.weight, p))
    };

    /// the share of a peak's facets that light and eye both clear, if their shares are correlated
    Horizon "horizon": HorizonInput -> Value<S, SHARE>, |input, _, p| {
        let [light, eye] = crate::each::each!(local in [input.light, input.eye] => datapath::horizon_slopes(&local, p));
        Value(datapath::horizon(&light, &eye, &input.horizon, HorizonKind::Correlated, p))
    };

    /// the light of a pixel, with one colour added
    PixelSum "pixel_sum": PixelSumInput -> PixelSum<S>, |input, _, _| pixel::sum(&input.sum, input.colour);

    /// the channel of a pixel, clamped to the brightest
    Pixel "pixel": PixelSum -> Value<S, LIGHT>, |input, _, _| Value(pixel::pixel(input));
}
