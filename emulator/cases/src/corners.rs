//! Corners: single limits, roundings and ties of the datapaths that neither random vectors nor pictures meet. `roughxel vectors coverage --unseen`
//! named the operations that no vector showed; each list here has inputs under which some of them make a difference.

use fixed::types::{I1F15, I2F30, I4F12, I4F28, I8F24, I16F16};
use roughxel_core::plan::{FrameSystem, HorizonKind, PeakPlan, ReflectionPlan, SurfacePlan};
use roughxel_core::ports::{
    BlockVector, HighlightIn, PeakIn, ReflectionIn, Shininess, StoredHorizon, StoredPeak, SurfaceIn,
};
use roughxel_core::precision::Precision;
use roughxel_utilities::random::SplitMix64;

use super::fragment::{bit, random_fragment};
use super::highlight::{self, lit, random_light};
use super::lit_peak::random_lit_peak;
use super::set::CaseSet;

/// ½ as a mantissa.
const HALF: i32 = 1 << 29;

/// The natural tangent basis, whose tangents keep their own lengths.
const NATURAL: FrameSystem = FrameSystem::Natural;

/// Differences of exponents. Some are next to those at which a word and a wide wire have no bits left, and next to those at which an unclamped count
/// of places wraps to 0. The last is the limit of inputs.
const APART: [i16; 12] = [30, 31, 32, 33, 34, 61, 62, 63, 64, 65, 66, 2048];

fn vector(mantissa: [i32; 3], exponent: i16) -> BlockVector {
    BlockVector { mantissa: mantissa.map(I2F30::from_bits), exponent }
}

/// Largest mantissa of a port. Rounded to the bits of a block it is 1 of the next exponent, the only way to a mantissa of 1.
fn largest(p: &Precision) -> i32 {
    i32::MAX & -bit(p)
}

/// Vectors along axes and a few last bits off: unit vectors whose components round beyond 1, quotients that do, sums and differences that leave one
/// bit.
struct Aligned {
    random: SplitMix64,
    bit: i32,
}

impl Aligned {
    fn new(set: &str, index: u64, p: &Precision) -> Self {
        Self { random: SplitMix64::for_element(set, index), bit: bit(p) }
    }

    /// Zero, or up to 2^8 last bits.
    fn few(&mut self) -> i32 {
        let few = self.bit << self.random.below(9);
        [0, few, -few][self.random.below(3) as usize]
    }

    /// Vector of any length along an axis.
    fn along(&mut self, axis: usize) -> BlockVector {
        let length = (HALF + self.random.below(1 << 29) as i32) & -self.bit;
        let mut mantissa = [(); 3].map(|()| self.few());
        mantissa[axis] = [length, -length, HALF, i32::MIN, i32::MAX & -self.bit][self.random.below(5) as usize];
        vector(mantissa, 0)
    }

    /// Surface with n and main direction along two axes, the eye along any.
    fn surface(&mut self) -> (SurfaceIn, usize) {
        let [axis, turn, eye] = [3, 2, 3].map(|count| self.random.below(count) as usize);
        let surface = SurfaceIn {
            normal: self.along(axis),
            view: self.along(eye),
            frame_vectors: [self.along((axis + 1 + turn) % 3), BlockVector::default()],
            ..SurfaceIn::default()
        };
        (surface, eye)
    }
}

/// Surfaces without offset whose normal enters with a mantissa of 1; `perturb` has to keep it.
fn of_length_one(p: &Precision) -> Vec<SurfaceIn> {
    let (one, bit) = (largest(p), bit(p));
    let mut surfaces = Vec::new();
    for axis in 0..3 {
        for beside in [0, bit, HALF, -HALF, one - bit] {
            for other in [0, -bit, one] {
                let mut mantissa = [other; 3];
                mantissa[axis] = one;
                mantissa[(axis + 1) % 3] = beside;
                let mut along = [0; 3];
                along[(axis + 1) % 3] = HALF;
                surfaces.push(SurfaceIn {
                    normal: vector(mantissa, 0),
                    view: vector(mantissa.map(|m| m >> 1 & -bit), 0),
                    frame_vectors: [vector(along, 0), BlockVector::default()],
                    ..SurfaceIn::default()
                });
            }
        }
    }
    surfaces
}

/// Fragments: circles of any size and of both kinds of columns, whose λ₁ and λ₂ differ by roundings alone; edges next to powers of two, whose
/// logarithms round; reflections along axes.
pub fn fragment_corners(p: &Precision) -> Vec<ReflectionIn> {
    let bit = bit(p);
    let mut fragments = Vec::new();
    let above = SurfaceIn {
        normal: vector([0, 0, HALF], -1),
        view: vector([0, 0, 697_931_776 & -bit], 1),
        frame_vectors: [vector([0, 0, -HALF], 0), BlockVector::default()],
        ..SurfaceIn::default()
    };
    for step in 0..1024 {
        // Sizes with few bits and with many.
        let size = (if step % 2 == 0 { HALF + step * (HALF >> 10) } else { HALF + step / 2 * 1_049_600 }) & -bit;
        for (view, bend) in
            [(-7, Some(-8)), (-7, None), (11, Some(5))].into_iter().take(if step % 8 == 0 { 3 } else { 1 })
        {
            let axes = [[-size, 0, 0], [0, -size, 0]];
            fragments.push(ReflectionIn {
                surface: above,
                dview: axes.map(|axis| vector(axis, view)),
                dnormal: bend.map_or_else(Default::default, |bend| axes.map(|axis| vector(axis, bend))),
                edge_texels: 256,
            });
        }
    }
    // At λ of a power of two, one of two equal axes rounds up to it and the other does not.
    for step in -32..=32 {
        let axes = [[(-549_755_904 + step * bit) & -bit, 0, 0], [0, (-549_755_904 + step * bit) & -bit, 0]];
        let [dview, dnormal] = [-7, -8].map(|exponent| axes.map(|axis| vector(axis, exponent)));
        fragments.push(ReflectionIn { surface: above, dview, dnormal, edge_texels: 256 });
    }
    // Reflections next to edges and corners of the cube, by factors that round: quotients of nearly 1.
    for index in 0..1024 {
        let mut random = SplitMix64::for_element("quotients", index);
        let words = [0, 0, i32::MIN, largest(p), HALF, bit, -bit, random.next_u64() as i32 & -bit];
        let mut any = || {
            let [x, y] = [(); 2].map(|()| words[random.below(8) as usize]);
            vector([[x, y, y], [x, x, y], [y, 0, y], [0, y, y]][random.below(4) as usize], 0)
        };
        let surface = SurfaceIn { normal: any(), view: any(), ..above };
        fragments.push(ReflectionIn { surface, ..random_fragment("quotients", index, p) });
    }
    // Eyes so far that nothing is left of a pixel, and so near that only the pixel is left.
    for exponent in (-2048..=2048).step_by(128).chain([-33, -32, -31, 31, 32, 33]) {
        for dview in [[HALF + bit, 0, 0], [HALF, HALF, bit]] {
            let surface = SurfaceIn { view: vector([0, 0, HALF], exponent), ..above };
            let dview = [dview, [dview[1], dview[0], 0]].map(|axis| vector(axis, -6));
            fragments.push(ReflectionIn { surface, dview, dnormal: Default::default(), edge_texels: 256 });
        }
    }
    let edges = (0..16).flat_map(|power| [-1, 0, 1].map(|step| ((1 << power) + step) as u16));
    let between = (0..2048).map(|step| 8 * step + 4);
    // Footprints of many texels, so that no level is clamped, and any footprints.
    for (index, edge_texels) in edges.chain(between).enumerate() {
        let any = random_fragment("fragment_corners", index as u64, p);
        let dview = any.dview.map(|of| BlockVector { exponent: of.exponent + 5, ..of });
        fragments.extend([ReflectionIn { edge_texels, ..any }, ReflectionIn { edge_texels, dview, ..any }]);
    }
    for index in 0..512 {
        let mut aligned = Aligned::new("fragment_corners", index, p);
        let (surface, eye) = aligned.surface();
        let dview = [eye + 1, eye + 2].map(|axis| BlockVector { exponent: -8, ..aligned.along(axis % 3) });
        fragments.push(ReflectionIn { surface, dview, dnormal: Default::default(), edge_texels: 1 << (index % 15) });
    }
    fragments.extend(
        of_length_one(p)
            .into_iter()
            .enumerate()
            .map(|(index, surface)| ReflectionIn { surface, ..random_fragment("fragment_corners", index as u64, p) }),
    );
    // A logarithm that is rounded the other way shows at one level of detail in some thousand.
    fragments.extend((0..4096).map(|index| {
        let any = random_fragment("edges", index, p);
        let dview = any.dview.map(|of| BlockVector { exponent: of.exponent + 5, ..of });
        ReflectionIn { edge_texels: 4 * index as u16 + 2, dview, ..any }
    }));
    fragments
}

/// Lights: exponents beyond both ends, half vectors a few last bits off the normal on smooth and rough surfaces, normals of one bit.
pub fn highlight_corners(p: &Precision) -> Vec<HighlightIn> {
    let bit = bit(p);
    let mut lights = Vec::new();
    let exponents =
        [i32::MIN, -1, 0, 1, 0xffff, 0x1_0000, 0x1_0001, (8192 << 16) - 1, 8192 << 16, (8192 << 16) + 1, i32::MAX];
    let roots = [i32::MIN, -1, 0, 1, (1 << 24) - 1, 1 << 24, (91 << 24) - 1, 91 << 24, (91 << 24) + 1, i32::MAX];
    for (index, exponent) in exponents.into_iter().enumerate() {
        for (other, root) in roots.into_iter().enumerate() {
            let shininess = Shininess { exponent: I16F16::from_bits(exponent), root: I8F24::from_bits(root) };
            lights.push(HighlightIn {
                shininess,
                ..random_light("highlight_corners", (index * roots.len() + other) as u64, p)
            });
        }
    }
    let both = [(1, 1), (8192, 91)];
    let both = both.map(|(m, root)| Shininess { exponent: I16F16::from_num(m), root: I8F24::from_num(root) });
    let rough = [0.3, 0.1, 0.2].map(|d| I4F28::from_num(d) & I4F28::from_bits(-(1 << (28 - p.offset_bits()))));
    for shininess in both {
        for roughness in [[I4F28::ZERO; 3], rough] {
            let few = || [0].into_iter().chain((0..14).map(|power| bit << power));
            for (n, h) in few().flat_map(|n| few().map(move |h| (n, h))) {
                let half = vector([0, HALF, -h], 0);
                let surface = SurfaceIn {
                    normal: vector([0, HALF, -n], 0),
                    view: half,
                    frame_vectors: [vector([0, 0, -HALF], 0), BlockVector::default()],
                    offset: Default::default(),
                    roughness,
                };
                lights.push(HighlightIn { surface, light: half, shininess });
            }
        }
    }
    let (least, most) = (I4F28::from_bits(1 << (28 - p.offset_bits())), I4F28::MIN);
    for axis in 0..3 {
        for offset in [[most, I4F28::ZERO], [I4F28::ZERO, most], [most; 2], [least; 2]] {
            for roughness in [[I4F28::ZERO; 3], [least, I4F28::ZERO, -least], [least, I4F28::ZERO, most], [most; 3]] {
                for frame in [[0; 3], [HALF, HALF, 0]] {
                    let mut normal = [0; 3];
                    normal[axis] = bit;
                    let view = vector([31 * bit, 1 << 26, -(1 << 19)], 0);
                    let frame_vectors = [vector(frame, 0), BlockVector::default()];
                    let surface =
                        SurfaceIn { normal: vector(normal, i16::MAX), view, frame_vectors, offset, roughness };
                    lights.push(HighlightIn { surface, light: vector([0, bit, 0], 0), shininess: both[0] });
                }
            }
        }
    }
    for index in 0..256 {
        let mut aligned = Aligned::new("highlight_corners", index, p);
        let (surface, eye) = aligned.surface();
        lights.push(HighlightIn { surface, light: aligned.along(eye), shininess: both[(index % 2) as usize] });
    }
    let of_one = of_length_one(p).into_iter();
    lights.extend(of_one.map(|surface| HighlightIn { surface, light: surface.view, shininess: both[1] }));
    lights
}

/// Lights on peaks: half vectors along the axes of the tangent basis and a few last bits off, whose components round beyond 1; peaks around them.
pub fn peak_corners(p: &Precision) -> Vec<PeakIn> {
    let aligned = |index| {
        let mut aligned = Aligned::new("peak_corners", index, p);
        let (surface, eye) = aligned.surface();
        let light = aligned.along(eye);
        PeakIn { surface, light, ..random_lit_peak("peak_corners", index, p) }
    };
    let of_one =
        |(index, surface): (usize, SurfaceIn)| PeakIn { surface, ..random_lit_peak("peak_corners", index as u64, p) };
    // Half vectors exactly on peaks of any exponent, and as far from them as a code can say.
    let on_peak = |index: u64| {
        let mut random = SplitMix64::for_element("on_peak", index);
        let half = vector([0, 0, HALF], 0);
        let surface = SurfaceIn {
            normal: half,
            view: half,
            frame_vectors: [vector([0, HALF, 0], 0), BlockVector::default()],
            ..SurfaceIn::default()
        };
        let (turn, away) = (random.below(3) as usize, random.next_u64() as i16 >> random.below(16));
        let mut normal = [I1F15::ZERO; 3];
        normal[turn] = I1F15::from_bits(away);
        normal[2] = I1F15::from_bits(i16::MAX - (random.next_u64() as i16 >> random.below(16)).max(0));
        let (amplitude, exponent) = (u16::MAX, random.next_u64() as u16);
        PeakIn {
            surface,
            light: half,
            peak: StoredPeak { normal, amplitude, exponent },
            horizon: StoredHorizon { low: [I4F12::MIN; 4], inverse_width: [0; 4] },
            weight: I16F16::ONE,
        }
    };
    let mut peaks: Vec<_> = (0..768).map(aligned).collect();
    peaks.extend(of_length_one(p).into_iter().enumerate().map(of_one));
    peaks.extend((0..512).map(on_peak));
    // Wide and bright peaks without a horizon, so that nothing hides a last place of a logarithm.
    peaks.extend((0..1024).map(|index| {
        let any = random_lit_peak("bright", index, p);
        let peak = StoredPeak { amplitude: u16::MAX, exponent: any.peak.exponent >> (index % 4), ..any.peak };
        PeakIn { peak, horizon: StoredHorizon::OPEN, weight: I16F16::ONE, ..any }
    }));
    // Lit places without a half vector: the light is opposite to an eye below the surface, without a horizon.
    for power in [0, 8, 16] {
        let light = vector([HALF / 2, HALF >> (power / 2) & -bit(p), HALF], 0);
        let view = vector(light.mantissa.map(|m| -m.to_bits()), 0);
        let any = on_peak(power);
        let surface = SurfaceIn { view, ..any.surface };
        peaks.push(PeakIn { surface, light, horizon: StoredHorizon::OPEN, ..any });
    }
    peaks
}

/// Surfaces on p_u and p_v of exponents far apart. A tangent of the natural basis is the longer, the shorter its vector is. So the terms are at any
/// distance from n and from each other: all but a sign is shifted out of the smaller one.
fn far(p: &Precision) -> impl Iterator<Item = SurfaceIn> {
    let keep = -(1 << (28 - p.offset_bits()));
    APART.into_iter().flat_map(move |apart| {
        let pairs = [(-apart, 0), (0, -apart), (-apart, -apart), (apart, 0), (0, apart)];
        pairs.into_iter().enumerate().map(move |(pair, (u, v))| {
            let sign = if (usize::from(apart.unsigned_abs()) + pair).is_multiple_of(2) { 1 } else { -1 };
            let number = |value: f64| I4F28::from_bits(I4F28::from_num(f64::from(sign) * value).to_bits() & keep);
            SurfaceIn {
                normal: vector([HALF / 8, HALF / 4, HALF].map(|m| -sign * m), 0),
                view: vector([HALF / 2, -HALF / 2, -sign * HALF], 0),
                frame_vectors: [vector([HALF, HALF / 4, -HALF / 8], u), vector([HALF / 4, HALF, -HALF / 2], v)],
                offset: [number(0.4), number(-0.7)],
                roughness: [number(0.3), number(-0.1), number(0.2)],
            }
        })
    })
}

/// Fragments on tangents far apart.
pub fn fragment_far(p: &Precision) -> CaseSet<ReflectionIn, ReflectionPlan> {
    let cases = far(p)
        .enumerate()
        .map(|(index, surface)| ReflectionIn { surface, ..random_fragment("fragment_far", index as u64, p) });
    let plan = ReflectionPlan { frame: NATURAL, ..ReflectionPlan::FULL };
    CaseSet { name: "fragment_far", description: FAR, cases: cases.collect(), plan }
}

/// Lights on surfaces with tangents far apart.
pub fn highlight_far(p: &Precision) -> CaseSet<HighlightIn, SurfacePlan> {
    let light = |(index, surface): (usize, SurfaceIn)| {
        let HighlightIn { shininess, .. } = random_light("highlight_far", index as u64, p);
        let of = ReflectionIn { surface, ..ReflectionIn::default() };
        lit(&of, surface.view, shininess)
    };
    let plan = SurfacePlan { frame: NATURAL, ..highlight::FULL };
    CaseSet { name: "highlight_far", description: FAR, cases: far(p).enumerate().map(light).collect(), plan }
}

/// Lights on peaks of surfaces with tangents far apart.
pub fn peak_far(p: &Precision) -> CaseSet<PeakIn, PeakPlan> {
    let light = |(index, surface): (usize, SurfaceIn)| PeakIn {
        surface: SurfaceIn { offset: Default::default(), roughness: Default::default(), ..surface },
        light: vector([HALF / 8, HALF / 2, -HALF], 0),
        ..random_lit_peak("peak_far", index as u64, p)
    };
    let plan = PeakPlan { frame: NATURAL, horizon: HorizonKind::Correlated };
    CaseSet { name: "peak_far", description: FAR, cases: far(p).enumerate().map(light).collect(), plan }
}

/// Description of the sets of tangents far apart.
const FAR: &str = "p_u, p_v of exponents 30 to 34, 61 to 66 and 2048 apart: terms far below others";

/// Description of the sets of corners.
pub const CORNERS: &str =
    "single limits, roundings and ties: mantissas of 1, vectors along axes and last bits beside, ends of codes";
