//! What every recorded design computes, in a reading of which integers can be seen.
//!
//! Nets, their evaluator and generated hardware are held against this: the stages themselves, called as the composer
//! calls them.

use roughxel_core::block::Block;
use roughxel_core::datapath;
use roughxel_core::fx::Fx;
use roughxel_core::plan::Effects;
use roughxel_core::ports::{HighlightIn, PeakIn, ReflectionIn, StoredHorizon, StoredPeak, texture_scale};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_core::signals::{
    CubePoint, Ellipse, FacePosition, FaceSelect, Frame, LocalDirection, PortBlock, Probes, TexturePosition,
};
use roughxel_core::stage::filter::ROUGHNESS_LOD_BIAS;
use roughxel_core::stage::{axes, blend, filter, moments, peaks, probes};
use roughxel_emulator::net::design::{
    BlendInput, CornerInput, DecodeInput, Edge, EnvironmentProbeInput, FaceAddressInput, HorizonInput, LevelsInput,
    LocalInput, MomentsInput, MomentsOutput, PeakInput, PeakOutput, ProbeSumInput, RepeatAddressInput, SampleInput,
    TextureInput, TextureProbeInput,
};

use crate::checked::{Integers, Visible, filled};

/// What a design's function comes to in a reading of which integers can be seen: the scalar one, or the checked one.
///
/// `ports` are the integers of the design's ports in the order of their bundle. Panics where there are fewer, or where the
/// design is unknown here.
pub fn outcome<W: Visible>(name: &str, ports: &[i64], effects: &Effects, p: &Precision) -> Integers {
    fn fx<const FRAC: u32>() -> Fx<i32, FRAC> {
        Fx::zero()
    }
    fn port<const N: usize>() -> PortBlock<i32, N> {
        PortBlock { mantissa: [fx(); N], exponent: fx() }
    }
    let block = Block::<i32, 3>::zero;
    let (texture, map) = texture_scale([1, 1]);
    let probes = Probes { count: fx(), step: [fx(); 2], lod: fx(), empty: false, saturated: false, capped: false };
    let centre = TexturePosition { uv: [Fx::lit(0); 2] };
    let sample = SampleInput { texels: [[fx(); 4]; 2], weights: [[fx(); 2]; 2], level_weight: fx() };
    let trilinear = |extra| -> Fx<W, 0> {
        let SampleInput { texels, weights, level_weight } = filled::<W, _>(&sample, ports);
        let [fine, coarse] = texels.map(|texels| texels.map(Fx::raw));
        let levels = [(&fine, &weights[0]), (&coarse, &weights[1])];
        Fx::from_raw(filter::trilinear(levels[0], levels[1], level_weight, extra))
    };
    match name {
        "map_scale" => {
            let Edge { edge_texels } = filled::<W, _>(&Edge { edge_texels: fx() }, ports);
            Integers::of(&probes::face_scale(edge_texels, p))
        }
        "texture" => {
            let input = filled::<W, _>(&TextureInput { duv: [port(); 2], texture, map }, ports);
            Integers::of(&datapath::texture_footprint(&input.duv, &input.texture, &input.map, p))
        }
        "texture_probe" => {
            let input = filled::<W, _>(&TextureProbeInput { centre, probes, index: fx(), texture }, ports);
            Integers::of(&datapath::texture_probe(&input.centre, &input.probes, input.index, &input.texture, p))
        }
        "repeat_address" => {
            let input = filled::<W, _>(&RepeatAddressInput { place: centre, size: [fx(); 2] }, ports);
            Integers::of(&filter::repeat_address(&input.place, input.size, p))
        }
        "moments" => {
            let form = MomentsInput { roughness: [fx(); 3], offset: [fx(); 2], covariance: [fx(); 3] };
            let input = filled::<W, _>(&form, ports);
            let texel = match p.roughness {
                RoughnessKind::Isotropic => moments::of_isotropic_texel(input.roughness[0]),
                _ => moments::of_texel(&input.roughness),
            };
            Integers::of(&MomentsOutput { texel, probe: moments::of_probe(&input.offset, &input.covariance) })
        }
        "roughness_decode" => {
            let input = filled::<W, _>(&DecodeInput { offset: [fx(); 2], moments: [fx(); 3] }, ports);
            let k = moments::covariance(&(input.offset, input.moments), p);
            Integers::of(&match p.roughness {
                RoughnessKind::Isotropic => {
                    let axes = axes::axes(&Ellipse { k, det: Block::zero() }, p);
                    [moments::to_roughness(axes.major), Fx::zero(), Fx::zero()]
                }
                _ => moments::decompose(&k, p),
            })
        }
        "fragment" => {
            let input = filled::<W, _>(&ReflectionIn::default().fragment(), ports);
            Integers::of(&datapath::fragment(&input, &effects.reflection(), p))
        }
        "reflection" => {
            let input = filled::<W, _>(&ReflectionIn::default().wires(map), ports);
            Integers::of(&datapath::reflection(&input, &effects.reflection(), p))
        }
        "environment_probe" => {
            let select = FaceSelect { is_z: false, is_y: false, negative: false };
            let point = CubePoint { select, st: [fx(); 2], half_reciprocal: fx(), tie: false };
            let input = filled::<W, _>(&EnvironmentProbeInput { point, probes, index: fx() }, ports);
            Integers::of(&datapath::environment_probe(&input.point, &input.probes, input.index, p))
        }
        "levels" => {
            let input = filled::<W, _>(&LevelsInput { lod: fx(), rough: false }, ports);
            let biased = filter::biased(input.lod, Fx::lit(ROUGHNESS_LOD_BIAS), p);
            Integers::of(&filter::levels(Fx::select(input.rough, biased, input.lod)))
        }
        "face_address" => {
            let form = FaceAddressInput { place: FacePosition { face: fx(), st: [fx(); 2] }, edge: fx() };
            let input = filled::<W, _>(&form, ports);
            Integers::of(&filter::face_address(&input.place.st, input.edge, p))
        }
        "corner" => {
            let input = filled::<W, _>(&CornerInput { texels: [fx(); 3] }, ports);
            Integers::of(&Fx::<W, 0>::from_raw(filter::corner(&input.texels.map(Fx::raw))))
        }
        "colour_sample" => Integers::of(&trilinear(8)),
        "moment_sample" => Integers::of(&trilinear(0)),
        "probe_sum" => {
            let form = ProbeSumInput { sample: fx(), weight: fx(), sum: filter::ProbeSum::zero() };
            let input = filled::<W, _>(&form, ports);
            Integers::of(&input.sum.add(input.sample.raw(), input.weight))
        }
        "probe_mean" => {
            let sum = filled::<W, _>(&filter::ProbeSum::<i32>::zero(), ports);
            Integers::of(&Fx::<W, 0>::from_raw(sum.mean()))
        }
        "highlight" => {
            let input = filled::<W, _>(&HighlightIn::default().wires(), ports);
            Integers::of(&datapath::leave_highlight(&datapath::lit_surface(&input, &effects.highlight(), p)))
        }
        "lit_peak" => {
            let input = filled::<W, _>(&PeakIn::default().wires(), ports);
            Integers::of(&datapath::lit_peak(&input, &effects.peak(), p))
        }
        "blend" => {
            let form = BlendInput { surface: fx(), reflection: fx(), reflectance: fx() };
            let input = filled::<W, _>(&form, ports);
            Integers::of(&blend::blend(input.surface, input.reflection, input.reflectance))
        }
        "local" => {
            let form = LocalInput {
                direction: block(),
                frame: Frame { e1: block(), e2: block(), pole: false },
                normal: block(),
            };
            let input = filled::<W, _>(&form, ports);
            Integers::of(&datapath::local_direction(&input.direction, &input.frame, &input.normal, p))
        }
        "peak" => {
            let form = PeakInput {
                h: LocalDirection { unit: [fx(); 3], none: false },
                peak: StoredPeak::default().wires(),
                weight: fx(),
                sum: peaks::none(),
            };
            let input = filled::<W, _>(&form, ports);
            let sum = datapath::peak_sum(&input.sum, datapath::peak(&input.h, &input.peak, input.weight, p));
            Integers::of(&PeakOutput { sum, status: datapath::peak_status(&input.h, &sum) })
        }
        "horizon" => {
            let form = HorizonInput { light: block(), eye: block(), horizon: StoredHorizon::OPEN.wires() };
            let input = filled::<W, _>(&form, ports);
            let [light, eye] = [&input.light, &input.eye].map(|direction| datapath::horizon_slopes(direction, p));
            Integers::of(&datapath::horizon(&light, &eye, &input.horizon, p))
        }
        _ => panic!("{name} is a new design: say what its function is"),
    }
}
