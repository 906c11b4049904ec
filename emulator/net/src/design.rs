//! Designs: what can be recorded, each with the declared range of every port.
//!
//! `reflection` and `texture` are the datapaths from ports to probes; `environment_probe` and `texture_probe` one step
//! of the probe stepper; `highlight` and `lit_peak` one light on a surface and on one of its peaks; the rest the arithmetic
//! between addresses, texels and pixel. Ranges of ports are stated as two scalar bundles, the lowest and the highest values.

use roughxel_core::block::{Block, Mantissa};
use roughxel_core::bundle;
use roughxel_core::datapath::{self, FragmentInput, HighlightInput, LitPeakInput, ReflectionInput};
use roughxel_core::fx::Fx;
use roughxel_core::plan::{Datapath, Effects};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::signals::{
    CubePoint, Ellipse, FacePosition, FaceSelect, Frame, Horizon, LIGHT, LOD, LocalDirection, MapScale, OFFSET,
    POSITION, Peak, PeakSum, PortBlock, Probes, SHARE, ShininessPort, TexturePosition,
};
use roughxel_core::stage::blend::{COLOUR, REFLECTANCE};
use roughxel_core::stage::filter::{self, Address, LOD_WEIGHT, ROUGHNESS_LOD_BIAS, WEIGHT};
use roughxel_core::stage::moments::{self, MOMENT};
use roughxel_core::stage::probes::face_scale;
use roughxel_core::stage::texture::{REPEATS, TextureScale};
use roughxel_core::stage::{axes, blend};
use roughxel_core::status::Status;
use roughxel_core::word::Word;

use super::graph::Net;
use super::record::{NetWord, record};

/// A design that can be recorded for any plan and precision.
#[derive(Clone, Copy, Debug)]
pub struct Design {
    /// Name of the design and of its top module.
    pub name: &'static str,
    /// One sentence.
    pub description: &'static str,
    record: fn(&Effects, &Precision) -> Net,
}

impl Design {
    /// Records it with those of the effects that it has.
    pub fn record(&self, effects: &Effects, p: &Precision) -> Net {
        (self.record)(effects, p)
    }

    /// The datapath it is the whole of; effects matter to such a design only.
    pub fn datapath(&self) -> Option<Datapath> {
        match self.name {
            "fragment" | "reflection" => Some(Datapath::Reflection),
            "highlight" => Some(Datapath::Highlight),
            "lit_peak" => Some(Datapath::Peak),
            _ => None,
        }
    }

    /// The design whose ports are those of a datapath's vectors.
    pub const fn of(datapath: Datapath) -> &'static Self {
        match datapath {
            Datapath::Reflection => &FRAGMENT,
            Datapath::Highlight => &HIGHLIGHT,
            Datapath::Peak => &LIT_PEAK,
        }
    }

    /// The design of that name.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        DESIGNS.iter().find(|design| design.name == name)
    }
}

const FRAGMENT: Design = Design {
    name: "fragment",
    description: "all of the reflection datapath with the ports of a vector word: edge of the map in, port formats out",
    record: fragment,
};

const HIGHLIGHT: Design = Design {
    name: "highlight",
    description: "one light on a surface: frame, perturb, roughness, half vector, modified Blinn-Phong",
    record: highlight,
};

const LIT_PEAK: Design = Design {
    name: "lit_peak",
    description: "one light on one peak of a surface: frame, half vector, horizon, peak",
    record: lit_peak,
};

/// Every design, in the order in which a fragment meets them.
pub const DESIGNS: &[Design] = &[
    Design { name: "map_scale", description: "log2 of the size of an environment's faces", record: map_scale },
    Design {
        name: "texture",
        description: "footprint of a pixel in a repeated map: columns, ellipse, axes, probes",
        record: texture,
    },
    Design {
        name: "texture_probe",
        description: "place and weight of one probe in a repeated map",
        record: texture_probe,
    },
    Design {
        name: "repeat_address",
        description: "texels and weights of a bilinear sample of a repeated map",
        record: repeat_address,
    },
    Design {
        name: "moments",
        description: "bump and roughness texels to second moments, one probe",
        record: probe_moments,
    },
    Design {
        name: "roughness_decode",
        description: "mean moments to roughness d1, d2, d3 or I1",
        record: roughness_decode,
    },
    FRAGMENT,
    Design {
        name: "reflection",
        description: "the reflection datapath: frame, perturb, reflect, cube face, columns, ellipse, axes, probes",
        record: reflection,
    },
    Design {
        name: "environment_probe",
        description: "place and weight of one probe on the cube",
        record: environment_probe,
    },
    Design {
        name: "levels",
        description: "level of detail to two levels and a weight, with the bias of rough reflections",
        record: levels,
    },
    Design {
        name: "face_address",
        description: "texels and weights of a bilinear sample of a cube face",
        record: face_address,
    },
    Design { name: "corner", description: "the texel at a corner of the cube", record: corner },
    Design {
        name: "colour_sample",
        description: "trilinear interpolation of a channel of 16-bit texels",
        record: colour_sample,
    },
    Design {
        name: "moment_sample",
        description: "trilinear interpolation of a channel of moments",
        record: moment_sample,
    },
    Design { name: "probe_sum", description: "one more sample of a weighted sum over probes", record: probe_sum },
    Design { name: "probe_mean", description: "the mean of the weighted sum", record: probe_mean },
    HIGHLIGHT,
    LIT_PEAK,
    Design { name: "blend", description: "surface and reflection by reflectance", record: blend_channel },
    Design { name: "local", description: "a direction in the frame of a surface, at unit length", record: local },
    Design { name: "peak", description: "one more peak of a distribution of normals", record: peak },
    Design {
        name: "horizon",
        description: "the share of a peak's facets that light and eye both clear",
        record: horizon,
    },
];

fn fx<const FRAC: u32>(raw: i64) -> Fx<i32, FRAC> {
    Fx::lit(raw)
}

/// Lowest and highest integer of a whole word.
const WORD: [i64; 2] = [i32::MIN as i64, i32::MAX as i64];
/// Lowest and highest exponent of a port.
const EXPONENT: [i64; 2] = [i16::MIN as i64, i16::MAX as i64];

fn port<const N: usize>(end: usize) -> PortBlock<i32, N> {
    PortBlock { mantissa: [fx(WORD[end]); N], exponent: fx(EXPONENT[end]) }
}

/// Faces of 1 to 16 384 texels: 2 map units across.
fn scale(end: usize) -> MapScale<i32> {
    MapScale { log2_texels: fx([-1 << LOD, 13 << LOD][end]), last_level: fx([0, 14][end]) }
}

fn texture_size(end: usize) -> TextureScale<i32> {
    // A unit of 2^13 texels is at most 2^13 repeats of a map one texel wide.
    TextureScale {
        size: [fx([1, 16384][end]); 2],
        log2_unit: fx([0, 13][end]),
        repeats_per_unit: [fx([1 << (REPEATS - 1), 1 << (13 + REPEATS)][end]); 2],
    }
}

fn reflection_ports(end: usize) -> ReflectionInput<i32> {
    ReflectionInput {
        normal: port(end),
        view: port(end),
        tangents: [port(end); 2],
        offset: [fx(WORD[end]); 2],
        roughness: [fx(WORD[end]); 3],
        dview: [port(end); 2],
        dnormal: [port(end); 2],
        map: scale(end),
    }
}

fn reflection(effects: &Effects, p: &Precision) -> Net {
    let plan = effects.reflection();
    record(&reflection_ports(0), &reflection_ports(1), |input| datapath::reflection(input, &plan, p))
}

fn fragment(effects: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| {
        let ReflectionInput { normal, view, tangents, offset, roughness, dview, dnormal, map: _ } =
            reflection_ports(end);
        let edge_texels = fx([0, u16::MAX.into()][end]);
        FragmentInput { normal, view, tangents, offset, roughness, dview, dnormal, edge_texels }
    };
    record(&ports(0), &ports(1), |input| datapath::fragment(input, &effects.reflection(), p))
}

/// Ports of `texture`.
#[derive(Clone, Copy, Debug)]
pub struct TextureInput<W: Word> {
    /// d(u, v)/dx and d(u, v)/dy, repeats per pixel.
    pub duv: [PortBlock<W, 2>; 2],
    /// Constants of the map.
    pub texture: TextureScale<W>,
    /// Scale of the level of detail.
    pub map: MapScale<W>,
}

bundle!(TextureInput { duv, texture, map });

fn texture(_: &Effects, p: &Precision) -> Net {
    let ports = |end| TextureInput { duv: [port(end); 2], texture: texture_size(end), map: scale(end) };
    record(&ports(0), &ports(1), |input| datapath::texture_footprint(&input.duv, &input.texture, &input.map, p))
}

/// Ports of `map_scale`.
#[derive(Clone, Copy, Debug)]
pub struct Edge<W: Word> {
    /// Edge of a face, texels.
    pub edge_texels: Fx<W, 0>,
}

bundle!(Edge { edge_texels });

fn map_scale(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| Edge { edge_texels: fx([1, 16384][end]) };
    record(&ports(0), &ports(1), |input| NetWord::block("map_scale", || face_scale(input.edge_texels, p)))
}

/// Ports of `environment_probe`.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentProbeInput<W: Word> {
    /// Point of the cube at the centre of the footprint.
    pub point: CubePoint<W>,
    /// The footprint.
    pub probes: Probes<W>,
    /// Which probe, below the count.
    pub index: Fx<W, 0>,
}

bundle!(EnvironmentProbeInput { point, probes, index });

fn probes(end: usize) -> Probes<i32> {
    let flag = end == 1;
    Probes {
        count: fx([1, 16][end]),
        // |step| ≤ 2√3·λ₁ < 7 with λ₁ ≤ 2.
        step: [fx([-7 << POSITION, 7 << POSITION][end]); 2],
        lod: fx([0, 14 << LOD][end]),
        empty: flag,
        saturated: flag,
        capped: flag,
    }
}

fn environment_probe(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| {
        let (one, flag): (Mantissa<i32>, bool) = (fx([-1 << 30, 1 << 30][end]), end == 1);
        EnvironmentProbeInput {
            point: CubePoint {
                select: FaceSelect { is_z: flag, is_y: flag, negative: flag },
                st: [one; 2],
                half_reciprocal: fx([0, 1 << 30][end]),
                tie: flag,
            },
            probes: probes(end),
            index: fx([0, 15][end]),
        }
    };
    record(&ports(0), &ports(1), |input| datapath::environment_probe(&input.point, &input.probes, input.index, p))
}

/// Ports of `texture_probe`.
#[derive(Clone, Copy, Debug)]
pub struct TextureProbeInput<W: Word> {
    /// Centre of the footprint.
    pub centre: TexturePosition<W>,
    /// The footprint.
    pub probes: Probes<W>,
    /// Which probe, below the count.
    pub index: Fx<W, 0>,
    /// Constants of the map.
    pub texture: TextureScale<W>,
}

bundle!(TextureProbeInput { centre, probes, index, texture });

fn texture_place(end: usize) -> TexturePosition<i32> {
    TexturePosition { uv: [Fx::lit([0, u32::MAX.into()][end]); 2] }
}

fn texture_probe(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| TextureProbeInput {
        centre: texture_place(end),
        probes: probes(end),
        index: fx([0, 15][end]),
        texture: texture_size(end),
    };
    record(&ports(0), &ports(1), |input| {
        datapath::texture_probe(&input.centre, &input.probes, input.index, &input.texture, p)
    })
}

/// Ports of `repeat_address`.
#[derive(Clone, Copy, Debug)]
pub struct RepeatAddressInput<W: Word> {
    /// Place in repeats.
    pub place: TexturePosition<W>,
    /// Width and height of the level, texels.
    pub size: [Fx<W, 0>; 2],
}

bundle!(RepeatAddressInput { place, size });

fn repeat_address(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| RepeatAddressInput { place: texture_place(end), size: [fx([1, 16384][end]); 2] };
    record(&ports(0), &ports(1), |input| {
        NetWord::block("filter.repeat_address", || filter::repeat_address(&input.place, input.size, p))
    })
}

/// Ports of `face_address`.
#[derive(Clone, Copy, Debug)]
pub struct FaceAddressInput<W: Word> {
    /// Place on the cube.
    pub place: FacePosition<W>,
    /// Edge of the level, texels.
    pub edge: Fx<W, 0>,
}

bundle!(FaceAddressInput { place, edge });

fn face_address(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| FaceAddressInput {
        place: FacePosition { face: fx([0, 5][end]), st: [fx([-1 << POSITION, 1 << POSITION][end]); 2] },
        edge: fx([1, 16384][end]),
    };
    record(&ports(0), &ports(1), |input| -> Address<NetWord> {
        NetWord::block("filter.face_address", || filter::face_address(&input.place.st, input.edge, p))
    })
}

/// Ports of `levels`.
#[derive(Clone, Copy, Debug)]
pub struct LevelsInput<W: Word> {
    /// Level of detail of the footprint.
    pub lod: Fx<W, LOD>,
    /// The footprint is a rough surface's.
    pub rough: W::Flag,
}

bundle!(LevelsInput { lod; flag rough });

fn levels(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| LevelsInput { lod: fx([0, 14 << LOD][end]), rough: end == 1 };
    record(&ports(0), &ports(1), |input| {
        NetWord::block("filter.levels", || {
            let biased = filter::biased(input.lod, Fx::lit(ROUGHNESS_LOD_BIAS), p);
            filter::levels(Fx::select(input.rough, biased, input.lod))
        })
    })
}

/// Ports of `corner`.
#[derive(Clone, Copy, Debug)]
pub struct CornerInput<W: Word> {
    /// One channel of the three texels that meet there, unsigned.
    pub texels: [Fx<W, 0>; 3],
}

bundle!(CornerInput { texels });

fn corner(_: &Effects, _: &Precision) -> Net {
    let ports = |end: usize| CornerInput { texels: [fx([0, 65535][end]); 3] };
    record(&ports(0), &ports(1), |input| {
        NetWord::block("filter.corner", || -> Fx<NetWord, 0> {
            Fx::from_raw(filter::corner(&input.texels.map(Fx::raw)))
        })
    })
}

/// Ports of `colour_sample` and `moment_sample`.
#[derive(Clone, Copy, Debug)]
pub struct SampleInput<W: Word> {
    /// Texels (0,0), (1,0), (0,1), (1,1) of the finer, then of the coarser level.
    pub texels: [[Fx<W, 0>; 4]; 2],
    /// Weights in a level, [0, 1).
    pub weights: [[Fx<W, WEIGHT>; 2]; 2],
    /// Weight of the coarser level, [0, 1).
    pub level_weight: Fx<W, LOD_WEIGHT>,
}

bundle!(SampleInput { texels, weights, level_weight });

fn sample(texel: [i64; 2], extra: u32) -> Net {
    let ports = |end: usize| SampleInput {
        texels: [[fx(texel[end]); 4]; 2],
        weights: [[fx([0, (1 << WEIGHT) - 1][end]); 2]; 2],
        level_weight: fx([0, (1 << LOD_WEIGHT) - 1][end]),
    };
    record(&ports(0), &ports(1), |input| {
        let [fine, coarse] = input.texels.map(|texels| texels.map(Fx::raw));
        NetWord::block("filter.trilinear", || -> Fx<NetWord, 0> {
            let [a, b] = [(&fine, &input.weights[0]), (&coarse, &input.weights[1])];
            Fx::from_raw(filter::trilinear(a, b, input.level_weight, extra))
        })
    })
}

fn colour_sample(_: &Effects, _: &Precision) -> Net {
    sample([0, 65535], 8)
}

fn moment_sample(_: &Effects, _: &Precision) -> Net {
    sample(WORD, 0)
}

/// Ports of `probe_sum` and `probe_mean`.
#[derive(Clone, Copy, Debug)]
pub struct ProbeSumInput<W: Word> {
    /// The next sample.
    pub sample: Fx<W, 0>,
    /// Its weight.
    pub weight: Fx<W, 16>,
    /// The sum so far.
    pub sum: filter::ProbeSum<W>,
}

bundle!(ProbeSumInput { sample, weight, sum });

/// |sum| ≤ 2^16·|sample|: the weights of one footprint are not negative and sum to 2^16.
fn sum_port(end: usize) -> filter::ProbeSum<i32> {
    filter::ProbeSum::of([i64::from(i32::MIN) << 16, i64::from(i32::MAX) << 16][end])
}

fn probe_sum(_: &Effects, _: &Precision) -> Net {
    let ports = |end: usize| ProbeSumInput { sample: fx(WORD[end]), weight: fx([0, 1 << 16][end]), sum: sum_port(end) };
    record(&ports(0), &ports(1), |input| {
        NetWord::block("filter.sum", || input.sum.add(input.sample.raw(), input.weight))
    })
}

fn probe_mean(_: &Effects, _: &Precision) -> Net {
    record(&sum_port(0), &sum_port(1), |sum| {
        NetWord::block("filter.mean", || -> Fx<NetWord, 0> { Fx::from_raw(sum.mean()) })
    })
}

/// Ports of `moments`: one texel's roughness, and offset and covariance of a probe.
#[derive(Clone, Copy, Debug)]
pub struct MomentsInput<W: Word> {
    /// d₁, d₂, d₃ of a texel in units of the map's scale, |d| ≤ 1; I₁ in slot 0.
    pub roughness: [Mantissa<W>; 3],
    /// Mean offset of a probe, |b| ≤ 1.
    pub offset: [Mantissa<W>; 2],
    /// Covariance of a probe.
    pub covariance: [Fx<W, MOMENT>; 3],
}

bundle!(MomentsInput { roughness, offset, covariance });

/// Outcomes of `moments`.
#[derive(Clone, Copy, Debug)]
pub struct MomentsOutput<W: Word> {
    /// K of the texel.
    pub texel: [Fx<W, MOMENT>; 3],
    /// Second moments of the probe.
    pub probe: [Fx<W, MOMENT>; 3],
}

bundle!(MomentsOutput { texel, probe });

fn probe_moments(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| MomentsInput {
        roughness: [fx([-1 << 30, 1 << 30][end]); 3],
        offset: [fx([-1 << 30, 1 << 30][end]); 2],
        covariance: [fx([-1 << 30, 1 << 30][end]); 3],
    };
    record(&ports(0), &ports(1), |input| MomentsOutput {
        texel: NetWord::block("moments.texel", || match p.roughness {
            RoughnessKind::Isotropic => moments::of_isotropic_texel(input.roughness[0]),
            _ => moments::of_texel(&input.roughness),
        }),
        probe: NetWord::block("moments.probe", || moments::of_probe(&input.offset, &input.covariance)),
    })
}

/// Ports of `roughness_decode`.
#[derive(Clone, Copy, Debug)]
pub struct DecodeInput<W: Word> {
    /// Mean offset of the footprint, |b| ≤ 1.
    pub offset: [Mantissa<W>; 2],
    /// Mean second moments, |·| ≤ 3.
    pub moments: [Fx<W, MOMENT>; 3],
}

bundle!(DecodeInput { offset, moments });

fn roughness_decode(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| DecodeInput {
        offset: [fx([-1 << 30, 1 << 30][end]); 2],
        moments: [fx([-3 << MOMENT, 3 << MOMENT][end]); 3],
    };
    record(&ports(0), &ports(1), |input| -> [Fx<NetWord, OFFSET>; 3] {
        let k = NetWord::block("moments.covariance", || moments::covariance(&(input.offset, input.moments), p));
        match p.roughness {
            RoughnessKind::Isotropic => {
                let ellipse = Ellipse { k, det: Block::zero() };
                let axes = NetWord::block("axes", || axes::axes(&ellipse, p));
                [NetWord::block("moments.isotropic", || moments::to_roughness(axes.major)), Fx::zero(), Fx::zero()]
            }
            _ => NetWord::block("moments.decompose", || moments::decompose(&k, p)),
        }
    })
}

fn highlight(effects: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| HighlightInput {
        surface: reflection_ports(end).surface(),
        light: port(end),
        shininess: ShininessPort { exponent: fx(WORD[end]), root: fx(WORD[end]) },
    };
    record(&ports(0), &ports(1), |input| {
        datapath::leave_highlight(&datapath::lit_surface(input, &effects.highlight(), p))
    })
}

fn lit_peak(effects: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| LitPeakInput {
        surface: reflection_ports(end).surface(),
        light: port(end),
        peak: stored_peak(end),
        horizon: stored_horizon(end),
        weight: fx(WORD[end]),
    };
    record(&ports(0), &ports(1), |input| datapath::lit_peak(input, &effects.peak(), p))
}

/// Ports of `blend`.
#[derive(Clone, Copy, Debug)]
pub struct BlendInput<W: Word> {
    /// Colour of the surface, below 64.
    pub surface: Fx<W, COLOUR>,
    /// Colour of the reflection, below 64.
    pub reflection: Fx<W, COLOUR>,
    /// Reflectance, [0, 1].
    pub reflectance: Fx<W, REFLECTANCE>,
}

bundle!(BlendInput { surface, reflection, reflectance });

fn blend_channel(_: &Effects, _: &Precision) -> Net {
    let ports = |end: usize| BlendInput {
        surface: fx([0, (64 << COLOUR) - 1][end]),
        reflection: fx([0, (64 << COLOUR) - 1][end]),
        reflectance: fx([0, 1 << REFLECTANCE][end]),
    };
    record(&ports(0), &ports(1), |input| {
        NetWord::block("blend", || blend::blend(input.surface, input.reflection, input.reflectance))
    })
}

/// A block between stages: any mantissas in [−1, 1], and an exponent that may be a sum of those of blocks of zeros.
fn block<const N: usize>(end: usize) -> Block<i32, N> {
    Block { m: [fx([-1 << 30, 1 << 30][end]); N], e: fx([-1 << 24, 1 << 24][end]) }
}

/// Ports of `local`.
#[derive(Clone, Copy, Debug)]
pub struct LocalInput<W: Word> {
    /// The direction, any length.
    pub direction: Block<W, 3>,
    /// E₁ and E₂ in units of the mantissas of n.
    pub frame: Frame<W>,
    /// n.
    pub normal: Block<W, 3>,
}

bundle!(LocalInput { direction, frame, normal });

fn local(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| LocalInput {
        direction: block(end),
        frame: Frame { e1: block(end), e2: block(end), pole: end == 1 },
        normal: block(end),
    };
    record(&ports(0), &ports(1), |input| datapath::local_direction(&input.direction, &input.frame, &input.normal, p))
}

/// Any bits of a stored peak.
fn stored_peak(end: usize) -> Peak<i32> {
    let code = fx([0, u16::MAX.into()][end]);
    Peak { normal: [fx([i16::MIN.into(), i16::MAX.into()][end]); 3], amplitude: code, exponent: code }
}

/// Any bits of a stored horizon.
fn stored_horizon(end: usize) -> Horizon<i32> {
    let (low, inverse_width) = (fx([i16::MIN.into(), i16::MAX.into()][end]), fx([0, u16::MAX.into()][end]));
    Horizon { low: [low; 4], inverse_width: [inverse_width; 4] }
}

/// Ports of `peak`.
#[derive(Clone, Copy, Debug)]
pub struct PeakInput<W: Word> {
    /// Half vector in the frame of the surface.
    pub h: LocalDirection<W>,
    /// The peak as it is stored.
    pub peak: Peak<W>,
    /// Its share of the fragment, [0, 1].
    pub weight: Fx<W, SHARE>,
    /// The sum so far.
    pub sum: PeakSum<W>,
}

bundle!(PeakInput { h, peak, weight, sum });

/// Outcomes of `peak`.
#[derive(Clone, Copy, Debug)]
pub struct PeakOutput<W: Word> {
    /// The sum with this peak.
    pub sum: PeakSum<W>,
    /// Its sticky bits.
    pub status: Status<W>,
}

bundle!(PeakOutput { sum, status });

fn peak(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| PeakInput {
        h: LocalDirection { unit: [fx([-1 << 30, 1 << 30][end]); 3], none: end == 1 },
        peak: stored_peak(end),
        weight: fx([0, 1 << SHARE][end]),
        sum: PeakSum { light: fx([0, (64 << LIGHT) - 1][end]), saturated: end == 1 },
    };
    record(&ports(0), &ports(1), |input| {
        let sum = datapath::peak_sum(&input.sum, datapath::peak(&input.h, &input.peak, input.weight, p));
        PeakOutput { sum, status: datapath::peak_status(&input.h, &sum) }
    })
}

/// Ports of `horizon`.
#[derive(Clone, Copy, Debug)]
pub struct HorizonInput<W: Word> {
    /// Direction of the light in the frame of the surface, any length.
    pub light: Block<W, 3>,
    /// Direction of the eye.
    pub eye: Block<W, 3>,
    /// The horizon of a peak as it is stored.
    pub horizon: Horizon<W>,
}

bundle!(HorizonInput { light, eye, horizon });

fn horizon(_: &Effects, p: &Precision) -> Net {
    let ports = |end: usize| HorizonInput { light: block(end), eye: block(end), horizon: stored_horizon(end) };
    record(&ports(0), &ports(1), |input| {
        let [light, eye] = [&input.light, &input.eye].map(|direction| datapath::horizon_slopes(direction, p));
        datapath::horizon(&light, &eye, &input.horizon, p)
    })
}
