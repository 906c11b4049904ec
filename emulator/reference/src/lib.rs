//! Independent float64 reference of the reflection datapath, written from the mathematics only.
//!
//! It shares no code with the integer datapath. One source would mean one bug for all its backends, so the reference must be separate. Each block has
//! one file, in pipeline order. [`reflection`] runs them all and returns every intermediate value together with the conditioning that a comparator
//! needs: distance to the nearest cube-face tie, the unrounded aspect ratio, the size of the terms of a footprint before they cancel.
//!
//! Formulas are those of W97 and S97 with the errata applied. Cross products and 2×2 minors are evaluated to 1.5 units in the last place
//! ([`linear::difference_of_products`]), so the tangent basis of 31-bit inputs is right down to their last bit. Everything else is ordinary careful
//! f64, good to about 2⁻⁵⁰ of the terms that enter.

pub mod axes;
pub mod columns;
pub mod cube;
pub mod ellipse;
pub mod filter;
pub mod frame;
pub mod ground_plane;
pub mod highlight;
pub mod horizon;
pub mod linear;
pub mod peaks;
pub mod perturb;
pub mod probes;
pub mod random;
pub mod reflect;
pub mod roughness;
pub mod sphere;

use axes::Axes;
use columns::Column;
use cube::Selection;
use ellipse::Ellipse;
use frame::{Frame, FrameSystem};
use linear::{Vector2, Vector3, normalise_exponent, scale_exponent};
use probes::{ProbePlan, ProbeRule};

/// Inputs of one fragment, in real units (block exponents already applied).
///
/// Results do not depend on a common factor of `normal` and `dnormal`, nor of `view` and `dview`. If exponents exceed the range of f64, the caller
/// takes such a factor out first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inputs {
    /// Surface normal n, any length.
    pub normal: Vector3,
    /// Vector v from the surface to the eye, any length.
    pub view: Vector3,
    /// Main direction h in slot 0 (system 3), or p_u and p_v (systems 1 and 2).
    pub tangents: [Vector3; 2],
    /// Bump offsets b₁, b₂, relative to the basis vectors.
    pub offset: [f64; 2],
    /// d₁, d₂, d₃ of D = [[d₁, d₂], [0, d₃]]; the isotropic I₁ in slot 0.
    pub roughness: [f64; 3],
    /// ∂v/∂x and ∂v/∂y per pixel.
    pub dview: [Vector3; 2],
    /// ∂n/∂x and ∂n/∂y per pixel, in the units of `normal`.
    pub dnormal: [Vector3; 2],
    /// Edge of a face of the environment at level 0, in texels, at least 1.
    pub edge_texels: u32,
}

/// Roughness columns of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Roughness {
    /// No roughness: q₃ = q₄ = 0.
    None,
    /// One standard deviation I₁ for all directions (S97 §8).
    Isotropic,
    /// K = D Dᵀ (S97 §8).
    Anisotropic,
}

/// Options of the reference, apart from the numbers of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Tangent basis of S97 §7.
    pub frame: FrameSystem,
    /// Roughness columns.
    pub roughness: Roughness,
    /// Rule for the probe count.
    pub probe_rule: ProbeRule,
    /// Most probes of a fragment, at least 1.
    pub max_probes: u32,
}

/// Every intermediate value of one fragment, in the units of the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outputs {
    /// Basis vectors E₁, E₂, and the flag of the fallback.
    pub frame: Frame,
    /// Perturbed normal n_mod.
    pub perturbed: Vector3,
    /// |n| + |b₁E₁| + |b₂E₂|, the size of the terms of n_mod before they cancel.
    pub perturbed_scale: f64,
    /// Reflected ray r, |r| = |v|·|n_mod|².
    pub reflected: Vector3,
    /// Cube face, s, t and |m| of r.
    pub selection: Selection,
    /// Relative distance of r from the nearest tie of two faces, see [`cube::tie_margin`].
    pub tie_margin: f64,
    /// Footprint columns q₁ (x), q₂ (y), q₃, q₄ (roughness) on the plane of the face, s, t ∈ [−1, 1].
    pub columns: [Column; 4],
    /// Covariance K of the footprint on the face and its determinant.
    pub ellipse: Ellipse,
    /// Standard deviations λ₁ ≥ λ₂ and the direction of λ₁.
    pub axes: Axes,
    /// Probe count, step, level of detail.
    pub probes: ProbePlan,
}

impl Outputs {
    /// Size of the footprint as if nothing had cancelled: √(Σ wᵢ scaleᵢ²) with the weights of K; at least λ₁.
    ///
    /// Rounding anywhere before the columns makes an absolute error of λ₁ and λ₂ proportional to this number.
    pub fn footprint_scale(&self) -> f64 {
        let weighted = [0, 1, 2, 3].map(|i| ellipse::WEIGHTS[i].sqrt() * self.columns[i].scale);
        linear::norm(&weighted)
    }

    /// λ₂ before the cap over [`Outputs::footprint_scale`]; 0 if nothing is known about λ₂ (or there is no footprint).
    pub fn minor_conditioning(&self) -> f64 {
        let scale = self.footprint_scale();
        if scale == 0.0 { 0.0 } else { self.axes.minor / scale }
    }
}

/// Data that both kinds of footprint share: n and v over a power of two each, so that squares and cubes neither overflow nor underflow.
struct Mirror {
    normal: Vector3,
    normal_exponent: i32,
    view: Vector3,
    view_exponent: i32,
    frame: Frame,
    /// n_mod.
    perturbed: Vector3,
    /// r.
    reflected: Vector3,
    /// (dv, dn) of the sides of the pixel and of the roughness.
    pairs: [[Vector3; 2]; 4],
}

fn mirror(inputs: &Inputs, options: &Options) -> Mirror {
    let (normal, normal_exponent) = normalise_exponent(inputs.normal);
    let (view, view_exponent) = normalise_exponent(inputs.view);
    let dnormal = inputs.dnormal.map(|d| scale_exponent(d, -normal_exponent));
    let dview = inputs.dview.map(|d| scale_exponent(d, -view_exponent));

    let frame = frame::frame(options.frame, normal, inputs.tangents);
    let perturbed = perturb::perturb(normal, &frame, inputs.offset);
    let reflected = reflect::reflect(view, perturbed);
    let zero = [0.0; 3];
    let [tangent_1, tangent_2] = match options.roughness {
        Roughness::None => [zero, zero],
        Roughness::Isotropic => roughness::isotropic_tangents(&frame, inputs.roughness[0]),
        Roughness::Anisotropic => roughness::tangents(&frame, inputs.roughness),
    };
    let pairs = [[dview[0], dnormal[0]], [dview[1], dnormal[1]], [zero, tangent_1], [zero, tangent_2]];
    Mirror { normal, normal_exponent, view, view_exponent, frame, perturbed, reflected, pairs }
}

/// Runs the whole reflection datapath on one fragment.
///
/// Degenerate inputs: n = 0 gives zero basis vectors; r = 0 (n_mod = 0 or v = 0) gives face +z, s = t = 0 and zero columns; a zero footprint gives
/// one probe at level 0.
pub fn reflection(inputs: &Inputs, options: &Options) -> Outputs {
    let Mirror { normal, normal_exponent, view, view_exponent, frame, perturbed, reflected, pairs } =
        mirror(inputs, options);
    let selection = cube::select(reflected);
    let columns = pairs.map(|[dview, dnormal]| columns::column(view, perturbed, &selection, dview, dnormal));
    let (ellipse, axes) = footprint(columns.map(|column| column.q));
    let probes = probes::plan(
        &axes,
        0.5 * f64::from(inputs.edge_texels),
        inputs.edge_texels,
        options.probe_rule,
        options.max_probes,
    );

    let in_normal_units = |vector| scale_exponent(vector, normal_exponent);
    let reflected_exponent = 2 * normal_exponent + view_exponent;
    let [perturbed_scale] = scale_exponent([perturb::scale(normal, &frame, inputs.offset)], normal_exponent);
    let [major] = scale_exponent([selection.m], reflected_exponent);
    Outputs {
        frame: Frame { e1: in_normal_units(frame.e1), e2: in_normal_units(frame.e2), pole: frame.pole },
        perturbed: in_normal_units(perturbed),
        perturbed_scale,
        reflected: scale_exponent(reflected, reflected_exponent),
        selection: Selection { m: major, ..selection },
        tie_margin: cube::tie_margin(reflected),
        columns,
        ellipse,
        axes,
        probes,
    }
}

/// Ellipse and axes of four columns, evaluated at a common exponent. The axes are right if the columns are finite, K and its determinant if they fit
/// f64 themselves.
fn footprint(columns: [Vector2; 4]) -> (Ellipse, Axes) {
    let size = linear::largest(&columns.map(|q| linear::largest(&q)));
    let (_, exponent) = normalise_exponent([size]);
    let scaled = ellipse::ellipse(&columns.map(|q| scale_exponent(q, -exponent)));
    let axes = axes::axes(&scaled);
    let [a, b, c] = scale_exponent([scaled.a, scaled.b, scaled.c], 2 * exponent);
    let [det] = scale_exponent([scaled.det], 4 * exponent);
    let [major, minor] = scale_exponent([axes.major, axes.minor], exponent);
    let axes = Axes { major, minor, ..axes };
    (Ellipse { a, b, c, det }, axes)
}

/// Results of the texture footprint of one fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureOutputs {
    /// Covariance K and its determinant, in the units of the columns squared.
    pub ellipse: Ellipse,
    /// Standard deviations and direction, in the units of the columns.
    pub axes: Axes,
    /// Probe count, step, level of detail.
    pub probes: ProbePlan,
}

/// Texture footprint: the same ellipse, axes and probes for a colour texture.
///
/// `columns` are ∂(s, t)/∂x and ∂(s, t)/∂y per pixel in any unit common to both axes of the map. `texels_per_unit` is that unit in texels of level 0:
/// 1 for columns in texels, half the longer edge if that edge is 2 units. `size_texels` is width and height of level 0; LOD ends at ⌊log₂ of the
/// longer one⌋.
pub fn texture(
    columns: [[f64; 2]; 2],
    texels_per_unit: f64,
    size_texels: [u32; 2],
    probe_rule: ProbeRule,
    max_probes: u32,
) -> TextureOutputs {
    let (ellipse, axes) = footprint([columns[0], columns[1], [0.0; 2], [0.0; 2]]);
    let longer_edge = size_texels[0].max(size_texels[1]);
    let probes = probes::plan(&axes, texels_per_unit, longer_edge, probe_rule, max_probes);
    TextureOutputs { ellipse, axes, probes }
}

/// Turns ∂(u, v)/∂x and ∂(u, v)/∂y in repeats of the map into columns in texels: (du·width, dv·height).
pub fn columns_in_texels(derivatives: [[f64; 2]; 2], size_texels: [u32; 2]) -> [[f64; 2]; 2] {
    let [width, height] = size_texels.map(f64::from);
    derivatives.map(|[du, dv]| [du * width, dv * height])
}

#[cfg(test)]
mod tests {
    use super::*;
    use random::SplitMix64;

    const OPTIONS: Options = Options {
        frame: FrameSystem::MainDirection,
        roughness: Roughness::Anisotropic,
        probe_rule: ProbeRule::Ceiling,
        max_probes: 16,
    };

    /// Floor seen straight from above: it reflects straight up, and every value can be derived by hand.
    fn floor_from_above() -> Inputs {
        Inputs {
            normal: [0.0, 2.0, 0.0],
            view: [0.0, 4.0, 0.0],
            tangents: [[0.0, 0.0, -1.0], [0.0; 3]],
            offset: [0.0; 2],
            roughness: [0.0; 3],
            dview: [[0.04, 0.0, 0.0], [0.0, 0.0, 0.02]],
            dnormal: [[0.0; 3]; 2],
            edge_texels: 256,
        }
    }

    #[test]
    fn floor_from_above_is_as_worked_by_hand() {
        let out = reflection(&floor_from_above(), &OPTIONS);
        // h × n = (0,0,−1) × (0,2,0) = (2,0,0); e₂ = n̂ × e₁ = (0,0,−1); both scaled by |n| = 2.
        assert_eq!(out.frame.e1, [2.0, 0.0, 0.0]);
        assert_eq!(out.frame.e2, [0.0, 0.0, -2.0]);
        assert!(!out.frame.pole);
        // r = 2n(v·n) − v|n|² = 2·(0,2,0)·8 − (0,4,0)·4 = (0,16,0): face +y, s = t = 0.
        assert_eq!(out.reflected, [0.0, 16.0, 0.0]);
        assert_eq!((out.selection.face, out.selection.m), (2, 16.0));
        assert_eq!([out.selection.s, out.selection.t], [0.0, 0.0]);
        assert_eq!(out.tie_margin, 1.0);
        // dr = −|n|² dv = (−0.16, 0, 0) and (0, 0, −0.08); over m = 16: −0.01 and −0.005.
        assert!((out.columns[0].q[0] + 0.01).abs() < 1e-17 && out.columns[0].q[1] == 0.0);
        assert!((out.columns[1].q[1] + 0.005).abs() < 1e-17 && out.columns[1].q[0] == 0.0);
        // σ = width/√12, ratio 2, N = 2, step = 0.01/2; minor diameter 0.005·128 texels = 0.64 < 1: level 0.
        assert!((out.axes.major - 0.01 / 12_f64.sqrt()).abs() < 1e-17);
        assert!((out.axes.ratio() - 2.0).abs() < 1e-12);
        assert_eq!(out.axes.direction, [1.0, 0.0]);
        assert_eq!((out.probes.count, out.probes.lod), (2, 0.0));
        assert!((out.probes.step[0] - 0.005).abs() < 1e-17);
        assert!((out.probes.lod_unclamped - 0.64_f64.log2()).abs() < 1e-12);
    }

    #[test]
    fn lengths_of_normal_and_view_do_not_matter() {
        let mut random = SplitMix64::new(7);
        for _ in 0..1000 {
            let inputs = random_inputs(&mut random);
            let mut scaled = inputs;
            // Powers of two far outside the range in which squares of squares stay finite.
            scaled.normal = scale_exponent(inputs.normal, 300);
            scaled.dnormal = inputs.dnormal.map(|d| scale_exponent(d, 300));
            scaled.view = scale_exponent(inputs.view, -400);
            scaled.dview = inputs.dview.map(|d| scale_exponent(d, -400));
            let (expected, got) = (reflection(&inputs, &OPTIONS), reflection(&scaled, &OPTIONS));
            assert_eq!(expected.columns, got.columns);
            assert_eq!(expected.probes, got.probes);
            assert_eq!(scale_exponent(expected.perturbed, 300), got.perturbed);
            assert_eq!(scale_exponent(expected.reflected, 200), got.reflected);
        }
    }

    #[test]
    fn columns_agree_with_finite_differences_of_the_whole_chain() {
        let mut random = SplitMix64::new(11);
        let step = 1e-5;
        let mut checked = 0;
        for _ in 0..2000 {
            let inputs = random_inputs(&mut random);
            let out = reflection(&inputs, &OPTIONS);
            if out.tie_margin < 0.05 {
                continue;
            }
            for axis in 0..2 {
                // Curvature acts on n_mod itself (W97 (5) takes ∂n_mod/∂x = ∂n/∂x).
                let moved = |sign: f64| {
                    let normal = linear::add_scaled(out.perturbed, sign * step, inputs.dnormal[axis]);
                    let view = linear::add_scaled(inputs.view, sign * step, inputs.dview[axis]);
                    let at = cube::project(out.selection.face, reflect::reflect(view, normal));
                    [at.s, at.t]
                };
                let (plus, minus) = (moved(1.0), moved(-1.0));
                for i in 0..2 {
                    let difference = (plus[i] - minus[i]) / (2.0 * step);
                    // Central differences: truncation step²·(third derivative), well below 1e-6 of the terms.
                    assert!((difference - out.columns[axis].q[i]).abs() < 1e-6 * out.columns[axis].scale, "{inputs:?}");
                }
            }
            checked += 1;
        }
        assert!(checked > 1500, "only {checked} fragments were away from ties");
    }

    #[test]
    fn zero_vectors_give_the_documented_results() {
        let mut inputs = floor_from_above();
        inputs.normal = [0.0; 3];
        let out = reflection(&inputs, &OPTIONS);
        assert_eq!((out.frame.e1, out.frame.e2), ([0.0; 3], [0.0; 3]));
        assert!(!out.frame.pole);
        assert_eq!(out.selection, Selection { face: 4, s: 0.0, t: 0.0, m: 0.0 });
        assert_eq!((out.probes.count, out.probes.lod), (1, 0.0));
        let mut inputs = floor_from_above();
        inputs.view = [0.0; 3];
        assert_eq!(reflection(&inputs, &OPTIONS).selection.face, 4);
        assert_eq!(reflection(&inputs, &OPTIONS).columns[0].q, [0.0; 2]);
    }

    #[test]
    fn footprint_scale_bounds_the_footprint() {
        let mut random = SplitMix64::new(3);
        for _ in 0..2000 {
            let out = reflection(&random_inputs(&mut random), &OPTIONS);
            assert!(out.axes.major <= out.footprint_scale() * (1.0 + 1e-12));
            assert!((0.0..=1.0).contains(&out.minor_conditioning()));
        }
    }

    fn random_inputs(random: &mut SplitMix64) -> Inputs {
        let mut vector = |size: f64| [0, 1, 2].map(|_| random.uniform(-size, size));
        Inputs {
            normal: vector(1.0),
            view: vector(3.0),
            tangents: [vector(1.0), vector(1.0)],
            offset: [vector(0.5)[0], vector(0.5)[0]],
            roughness: vector(0.2),
            dview: [vector(0.01), vector(0.01)],
            dnormal: [vector(0.01), vector(0.01)],
            edge_texels: 256,
        }
    }

    #[test]
    fn axes_survive_footprints_whose_determinant_does_not_fit() {
        let columns = [[3.0, 1.0], [-0.5, 0.25], [0.125, 0.0], [0.0, 0.5]];
        let (_, expected) = footprint(columns);
        for exponent in [-900, -300, 300, 900] {
            let (_, got) = footprint(columns.map(|q| scale_exponent(q, exponent)));
            assert_eq!(got.direction, expected.direction);
            assert_eq!([got.major, got.minor], scale_exponent([expected.major, expected.minor], exponent));
        }
    }

    #[test]
    fn texture_footprint_does_not_depend_on_the_unit() {
        let derivatives = [[0.01, 0.002], [-0.001, 0.02]];
        let size = [512, 256];
        let in_texels = texture(columns_in_texels(derivatives, size), 1.0, size, ProbeRule::Ceiling, 16);
        // The longer edge is 2 units.
        let in_units = columns_in_texels(derivatives, size).map(|c| c.map(|x| x / 256.0));
        let scaled = texture(in_units, 256.0, size, ProbeRule::Ceiling, 16);
        assert_eq!(in_texels.probes.count, scaled.probes.count);
        assert!((in_texels.probes.lod - scaled.probes.lod).abs() < 1e-12);
        assert!((in_texels.probes.step[0] - 256.0 * scaled.probes.step[0]).abs() < 1e-12);
    }
}
