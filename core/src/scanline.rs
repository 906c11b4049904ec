//! Fragments of a triangle, row by row, for processors without floats: integers, no division.
//!
//! Set up a [`Triangle`] from three [`ScreenVertex`], give its corners [`Attributes`], walk the rows of its [`Fragments`];
//! `core/examples/scanline.rs` is a whole program. The module `setup` makes ports from floating-point numbers.
//!
//! An attribute a is perspective-correct as A/W with A = Σ eᵢqᵢaᵢ and W = Σ eᵢqᵢ. eᵢ is the edge function opposite to corner i and qᵢ its 1/w. Both
//! sums are linear in x and y, so a pixel costs additions. If a length has no meaning, the division is left out:
//! - view: V with its constant derivatives, for a footprint ignores the part of dv along v;
//! - main direction: H;
//! - normal: N·W with dN·W − N·dW, which are n and dn times W², so that bump offsets meet a dn without a part along n;
//! - texture coordinates alone need 1/W, by [`half_reciprocal`].
//!
//! Errors:
//! - Corners are rounded to 2^−39 of the largest qᵢ|aᵢ|. A pixel whose W|a| is `loss` times smaller has an error `loss` times larger relative to it.
//!   This happens at pixels that are farther away than the nearest corner, and if corners point away from each other.
//! - Directions: 2^−28 + 2^−37·loss rad, so 2^−27 for ratios of w up to 2^8.
//! - dn: (2^−27 + 2^−36·loss)·(|dn| + |n|·|dW|/W), and 2^−38 of the largest terms of its sum.
//! - u and v: (2^−27 + 2^−36·loss)·max(1, |(u, v)|) repeats, so keep them near 0.
//! - du and dv: twice that of |d(u, v)| + |(u, v)|·|dW|/W.
//!
//! `host-tests/tests/datapath/scanline.rs` holds all of them to these bounds.
//!
//! Cost on RV32IM, in instructions: 1200 a fragment and 650 for texture coordinates, 600 a row, 6600 to 7900 a triangle.

use core::ops::Range;

use crate::block::{Block, MANTISSA, MAX_EXPONENT, Number, PRODUCT, align, normalise};
use crate::each::{each, places};
use crate::elementary::half_reciprocal;
use crate::fx::{Fx, Wide};
use crate::ports::{BlockPair, BlockPort, BlockVector, Port, PortBlock, ReflectionIn, SurfaceIn, TextureIn};
use crate::precision::Precision;
use crate::stage::leave::leave;
use crate::width::{IntegerCount, Whole, of_ports, to_ports};

/// Bits of a position after the point: 1/256 pixel.
pub const SUBPIXEL_BITS: u32 = 8;
/// Largest coordinate of a vertex in either direction, in 1/256 pixel: 4096 pixels.
pub const MAX_POSITION: i32 = 1 << 20;
/// Largest `inverse_w`.
pub const MAX_INVERSE_W: u32 = i32::MAX as u32;

/// Bits of qᵢaᵢ at the corners, brought to one scale.
const CORNER_BITS: i32 = 40;
/// Bits of a plane's value inside the triangle, without its sign. Rounding, below 2^15, has room above.
const VALUE_BITS: u32 = 62;
/// Kept bits of a block here: all fraction bits of a mantissa.
const KEEP: u32 = 30;
/// Knobs of the reciprocal of W: as many bits as a [`Precision`] may keep, two Newton steps. Error: 2^−28.5.
const RECIPROCAL: Precision = Precision { fraction_bits: 28, ..Precision::PRECISE };

/// A corner on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScreenVertex {
    /// Position to the right, in 1/256 pixel: pixel x has its centre at 256x + 128. At most [`MAX_POSITION`] in either direction.
    pub x: i32,
    /// Position down, in the same unit and range.
    pub y: i32,
    /// 1/w in any unit that the three vertices share, from 1 to [`MAX_INVERSE_W`]. The caller's rounding of it adds to the error.
    pub inverse_w: u32,
}

/// The side of an edge: not negative inside, for an edge that runs clockwise on the screen (y down).
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// Value at the corner of pixel (0, 0), in square sub-pixels, below 2^42 + 2. It is one less for an edge that does not own its points.
    constant: i64,
    /// Gradient per sub-pixel to the right and down, at most 2^21.
    gradient: [i64; 2],
}

impl Edge {
    fn new(a: &ScreenVertex, b: &ScreenVertex) -> Self {
        let [right, down] = [i64::from(b.x - a.x), i64::from(b.y - a.y)];
        // Points on a left edge (it runs up) and on a top edge (it runs to the right) are inside.
        let owns_points = down < 0 || (down == 0 && right > 0);
        let constant = down * i64::from(a.x) - right * i64::from(a.y);
        Self { constant: constant - i64::from(!owns_points), gradient: [-down, right] }
    }

    /// Value at a pixel's centre. Range: within [`MAX_POSITION`]; below 2^43 + 2.
    fn at(&self, x: i32, y: i32) -> i64 {
        let [across, down] = self.gradient;
        self.constant + across * i64::from(centre(x)) + down * i64::from(centre(y))
    }
}

/// Centre of a pixel in sub-pixels.
fn centre(pixel: i32) -> i32 {
    (pixel << SUBPIXEL_BITS) + (1 << (SUBPIXEL_BITS - 1))
}

/// First pixel whose centre is at a position or beyond it.
fn first_centre(position: i32) -> i32 {
    (position + (1 << (SUBPIXEL_BITS - 1)) - 1) >> SUBPIXEL_BITS
}

/// First of `columns` from which `holds` is true; their end if it is never true.
fn first_column(columns: Range<i32>, holds: impl Fn(i32) -> bool) -> i32 {
    let Range { mut start, mut end } = columns;
    while start < end {
        let middle = start + ((end - start) >> 1);
        if holds(middle) {
            end = middle;
        } else {
            start = middle + 1;
        }
    }
    start
}

/// `x · 2^places`, to nearest or modulo 2^64. Range: |x| ≤ 2^62.
fn shifted(x: i64, places: i32) -> i64 {
    match places {
        0..64 => x << places,
        -62..0 => ((x >> (-1 - places)) + 1) >> 1,
        _ => 0,
    }
}

/// Bit at which [`scaled`] splits a factor.
const SPLIT: u32 = 21;

/// `⌊a·b / 2^shift⌋` modulo 2^64. Range: |b| ≤ 2^40, `shift` ≤ [`SPLIT`].
fn scaled(a: i64, b: i64, shift: u32) -> i64 {
    let low = a & ((1 << SPLIT) - 1);
    // The lower part is below 2^61; the upper part may wrap, as the caller states.
    ((a >> SPLIT).wrapping_mul(b) << (SPLIT - shift)).wrapping_add((low * b) >> shift)
}

/// A triangle on the screen.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    /// Edge i is opposite to vertex i.
    edges: [Edge; 3],
    /// Twice the area in square sub-pixels, from 1 to 2^42: the sum of the edge functions.
    area: i64,
    /// Places by which planes are shifted down. Their values are below 2^42 · 2^40 before the shift and below 2^62 after it.
    shift: u32,
    /// Position of vertex 0.
    origin: [i32; 2],
    inverse_w: [u32; 3],
    /// First pixel whose centre is within the bounds, and the one after the last.
    columns: [i32; 2],
    rows: [i32; 2],
}

impl Triangle {
    /// Sets up a triangle whose corners run clockwise on the screen (y down).
    ///
    /// `None`: no area, the other orientation (seen from the back), or a position or an `inverse_w` out of its range. The caller clips at a near
    /// plane and at ±4096 pixels; for smaller windows use `columns` of [`Self::span`].
    pub fn new(vertices: &[ScreenVertex; 3]) -> Option<Self> {
        let in_range = |position: i32| (-MAX_POSITION..=MAX_POSITION).contains(&position);
        let valid = |v: &ScreenVertex| in_range(v.x) && in_range(v.y) && (1..=MAX_INVERSE_W).contains(&v.inverse_w);
        if !vertices.iter().all(valid) {
            return None;
        }
        let [a, b, c] = vertices;
        let edges = [Edge::new(b, c), Edge::new(c, a), Edge::new(a, b)];
        let [[_, _], [p, q], [r, s]] = each!(edge in edges => edge.gradient);
        // Differences are at most 2^21, and the triangle at most half of its bounds.
        let area = p * s - q * r;
        if area <= 0 {
            return None;
        }
        let bounds = |[a, b, c]: [i32; 3]| {
            let (least, most) = (a.min(b).min(c), a.max(b).max(c));
            [first_centre(least), first_centre(most + 1)]
        };
        Some(Self {
            edges,
            area,
            shift: (i64::BITS - area.leading_zeros()).saturating_sub(VALUE_BITS - CORNER_BITS as u32),
            origin: [a.x, a.y],
            inverse_w: [a.inverse_w, b.inverse_w, c.inverse_w],
            columns: bounds([a.x, b.x, c.x]),
            rows: bounds([a.y, b.y, c.y]),
        })
    }

    /// Rows of pixels that may have a centre inside.
    pub fn rows(&self) -> Range<i32> {
        let [start, end] = self.rows;
        start..end
    }

    /// Pixels of row `y` among `columns` whose centres are inside. A centre on an edge is inside if that edge is a top or a left one, so of two
    /// triangles that share an edge exactly one has the pixel.
    ///
    /// Any arguments are allowed. At most 14 steps for each edge.
    pub fn span(&self, y: i32, columns: Range<i32>) -> Range<i32> {
        let [first, behind] = self.columns;
        let (mut start, mut end) = (first.max(columns.start), behind.min(columns.end));
        if start >= end || !self.rows().contains(&y) {
            return 0..0;
        }
        for edge in &self.edges {
            let [across, _] = edge.gradient;
            if across > 0 {
                start = first_column(start..end, |x| edge.at(x, y) >= 0);
            } else {
                end = first_column(start..end, |x| edge.at(x, y) < 0);
            }
        }
        start..end
    }

    /// Attribute over the triangle, from its values at the corners. Exponents beyond ±2^11 are clamped to it.
    pub fn plane<const N: usize>(&self, corners: &[BlockPort<N>; 3]) -> Plane<N> {
        let blocks: [Block<Whole, N>; 3] = each!(corner in *corners => {
            let PortBlock { mantissa, exponent } = of_ports::<Whole, _>(&corner.wires());
            let exponent = exponent.saturate(Fx::int(-MAX_EXPONENT), Fx::int(MAX_EXPONENT));
            normalise(each!(m in mantissa => m.widen::<PRODUCT>()), exponent, KEEP)
        });
        // |qᵢaᵢ| ≤ 2^top: mantissas are at most 1.
        let magnitude = |i: usize| blocks[i].e.raw().integer() + (u32::BITS - self.inverse_w[i].leading_zeros()) as i32;
        let top = magnitude(0).max(magnitude(1)).max(magnitude(2));
        // qᵢaᵢ in units of 2^(top − 40): at most 2^40, the largest at least 2^38. The product before the shift is below 2^61.
        let corners = each!(i in [0, 1, 2] => {
            let q = i64::from(self.inverse_w[i]);
            let places = blocks[i].e.raw().integer() - top + CORNER_BITS - KEEP as i32;
            each!(m in blocks[i].m => shifted(i64::from(m.raw().integer()) * q, places))
        });
        // Per sub-pixel: the gradients of the edges sum to at most 2^22 by size, so these are at most 2^62.
        let gradient = each!(axis in [0, 1] => each!(k in places::<N>() => {
            let [a, b, c] = each!(i in [0, 1, 2] => self.edges[i].gradient[axis] * corners[i][k]);
            a + b + c
        }));
        // At vertex 0 its own edge function is the area and the others vanish; from there to the centre of a pixel. Steps and sums may wrap on the
        // way. Modulo 2^64 they are right, and inside the triangle |A| ≤ area·2^40/2^shift < 2^62.
        let pixel = each!(position in self.origin => position >> SUBPIXEL_BITS);
        let [right, down] = each!(axis in [0, 1] => i64::from(centre(pixel[axis]) - self.origin[axis]));
        let value = each!(k in places::<N>() => {
            let corner = scaled(self.area, corners[0][k], self.shift);
            let across = scaled(gradient[0][k], right, self.shift);
            corner.wrapping_add(across).wrapping_add(scaled(gradient[1][k], down, self.shift))
        });
        // One unit for all attributes of the triangle, so A/W is a.
        let exponent = top - u32::BITS as i32;
        let per_pixel = exponent + SUBPIXEL_BITS as i32 - self.shift as i32;
        Plane {
            pixel,
            value,
            step: each!(axis in [0, 1] => each!(g in gradient[axis] => scaled(g, 1 << SUBPIXEL_BITS, self.shift))),
            derivative: each!(g in gradient => block(g, per_pixel)),
            exponent,
        }
    }
}

/// Values `v · 2^(e − 62)` as a block.
fn block<const N: usize>(values: [i64; N], e: i32) -> Block<Whole, N> {
    let wires: [Wide<Whole, MANTISSA>; N] = each!(value in values => Fx::from_raw(Whole::wide_of_integer(value)));
    normalise(wires, Fx::from_raw(Whole::of_integer(e)), KEEP)
}

fn port<const N: usize>(block: &Block<Whole, N>) -> BlockPort<N> {
    Port::from_wires(&to_ports::<Whole, _>(&leave(block)))
}

/// A = Σ eᵢqᵢaᵢ of one attribute, linear over a triangle, in a unit that all attributes of the triangle share.
#[derive(Clone, Copy, Debug)]
pub struct Plane<const N: usize> {
    /// Pixel of vertex 0, at which `value` holds.
    pixel: [i32; 2],
    /// Value in units of 2^(exponent − 62), as `step`, modulo 2^64.
    value: [i64; N],
    /// Step to the next pixel, and to the next row.
    step: [[i64; N]; 2],
    derivative: [Block<Whole, N>; 2],
    exponent: i32,
}

impl<const N: usize> Plane<N> {
    /// A from the centre of a pixel on. Range: pixels whose centres are inside the triangle; elsewhere the number has no meaning.
    pub fn line(&self, x: i32, y: i32) -> Line<N> {
        let [right, down] = [x.wrapping_sub(self.pixel[0]), y.wrapping_sub(self.pixel[1])].map(i64::from);
        let [across, below] = &self.step;
        let value = each!(k in places::<N>() => {
            self.value[k].wrapping_add(across[k].wrapping_mul(right)).wrapping_add(below[k].wrapping_mul(down))
        });
        Line { value, step: *across, exponent: self.exponent }
    }

    /// ∂A/∂x, per pixel to the right, in the unit of A.
    pub fn dx(&self) -> BlockPort<N> {
        port(&self.derivative[0])
    }

    /// ∂A/∂y, per pixel down.
    pub fn dy(&self) -> BlockPort<N> {
        port(&self.derivative[1])
    }
}

/// A at one pixel of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<const N: usize> {
    value: [i64; N],
    step: [i64; N],
    exponent: i32,
}

impl<const N: usize> Line<N> {
    /// Steps one pixel to the right; the bits are those of [`Plane::line`] there.
    pub fn step(&mut self) {
        for (value, step) in self.value.iter_mut().zip(&self.step) {
            // After the last pixel of the triangle the sum may wrap; it is not read there.
            *value = value.wrapping_add(*step);
        }
    }

    /// A at this pixel. The largest mantissa is in [½, 1] by size.
    pub fn block(&self) -> BlockPort<N> {
        port(&self.value())
    }

    fn value(&self) -> Block<Whole, N> {
        block(self.value, self.exponent)
    }
}

/// Block times a number. Both have mantissas of at least ½, so the largest product keeps 28 bits without a shift of its own.
fn times<const N: usize>(a: &Block<Whole, N>, k: &Number<Whole>) -> Block<Whole, N> {
    Block { m: each!(m in a.m => m.mul::<MANTISSA, PRODUCT>(k.m[0]).round_to(KEEP)), e: a.e + k.e }
}

/// W² times the derivative of A/W: dA·W − A·dW.
fn derivative<const N: usize>(
    a: &Block<Whole, N>,
    da: &Block<Whole, N>,
    w: &Number<Whole>,
    dw: &Number<Whole>,
) -> Block<Whole, N> {
    // The smaller term loses bits by its single factor: no more than A and dA have lost by their own rounding.
    let ([[w], [dw]], e) = align([w.scaled(da.e), dw.scaled(a.e)], KEEP);
    let terms: [Wide<Whole, PRODUCT>; N] = each!(k in places::<N>() => da.m[k].mul(w) - a.m[k].mul(dw));
    normalise(terms, e, KEEP)
}

/// Attributes at the corners of a triangle. A direction's length counts if it differs between corners. Give all normals one length, and views their
/// true length from the corner to the eye.
#[derive(Clone, Copy, Debug, Default)]
pub struct Attributes {
    /// Surface normal n.
    pub normal: [BlockVector; 3],
    /// Vector v from the surface to the eye.
    pub view: [BlockVector; 3],
    /// Main direction h (system 3); leave it zero if the plan has no tangent basis.
    pub main_direction: [BlockVector; 3],
    /// Texture coordinates in repeats. Without them fragments have no [`TextureIn`].
    pub uv: Option<[BlockPair; 3]>,
}

/// Fragments of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Fragments {
    triangle: Triangle,
    template: ReflectionIn,
    weight: Plane<1>,
    normal: Plane<3>,
    view: Plane<3>,
    main_direction: Plane<3>,
    uv: Option<Plane<2>>,
}

impl Fragments {
    /// Sets up the fragments, once a triangle. They take the edge of the environment, offsets and roughness, and frame vector 1 from `template`.
    pub fn new(triangle: &Triangle, corners: &Attributes, template: &ReflectionIn) -> Self {
        let one = port(&Number::one());
        let view = triangle.plane(&corners.view);
        Self {
            triangle: *triangle,
            template: ReflectionIn { dview: [view.dx(), view.dy()], ..*template },
            weight: triangle.plane(&[one; 3]),
            normal: triangle.plane(&corners.normal),
            view,
            main_direction: triangle.plane(&corners.main_direction),
            uv: corners.uv.map(|uv| triangle.plane(&uv)),
        }
    }

    /// Fragments of row `y` among `columns`, from left to right; none outside the triangle.
    pub fn row(&self, y: i32, columns: Range<i32>) -> Scanline<'_> {
        let columns = self.triangle.span(y, columns);
        let x = columns.start;
        Scanline {
            fragments: self,
            columns,
            weight: self.weight.line(x, y),
            normal: self.normal.line(x, y),
            view: self.view.line(x, y),
            main_direction: self.main_direction.line(x, y),
            uv: self.uv.map(|uv| uv.line(x, y)),
        }
    }
}

/// One pixel of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Fragment {
    /// Column of the pixel.
    pub x: i32,
    /// Input of its reflection and, as [`ReflectionIn::surface`], of its lights: n and dn times W², v and h times W. Nothing depends on these
    /// factors. Offsets and roughness are those of the template until the caller writes those of the pixel.
    pub reflection: ReflectionIn,
    /// Input of its maps, if the triangle has texture coordinates.
    pub texture: Option<TextureIn>,
}

/// Fragments of one row of a triangle.
#[derive(Clone, Debug)]
pub struct Scanline<'a> {
    fragments: &'a Fragments,
    columns: Range<i32>,
    weight: Line<1>,
    normal: Line<3>,
    view: Line<3>,
    main_direction: Line<3>,
    uv: Option<Line<2>>,
}

impl Scanline<'_> {
    #[inline(always)]
    fn reflection(&self, w: &Number<Whole>) -> ReflectionIn {
        let Fragments { normal, weight, template, .. } = self.fragments;
        let n = self.normal.value();
        // A literal, each field once: a changed copy of the template would be moved twice.
        ReflectionIn {
            surface: SurfaceIn {
                normal: port(&times(&n, w)),
                view: self.view.block(),
                frame_vectors: [self.main_direction.block(), template.surface.frame_vectors[1]],
                offset: template.surface.offset,
                roughness: template.surface.roughness,
            },
            dview: template.dview,
            dnormal: each!(axis in [0, 1] => {
                port(&derivative(&n, &normal.derivative[axis], w, &weight.derivative[axis]))
            }),
            edge_texels: template.edge_texels,
        }
    }

    fn texture(&self, plane: &Plane<2>, line: &Line<2>, w: &Number<Whole>) -> TextureIn {
        let uv = line.value();
        // 1/(m·2^e) = 2·(1/2m)·2^−e.
        let inverse = Block { m: [half_reciprocal(w.m[0], &RECIPROCAL)], e: Fx::int(1) - w.e };
        let square = inverse.square_length(KEEP);
        let weight = &self.fragments.weight;
        TextureIn {
            uv: Port::from_wires(&each!(m in uv.m => {
                // 60 fraction bits at the exponent. After the shift there are 32; bits above them are whole repeats.
                let repeats: Wide<Whole, PRODUCT> = m.mul(inverse.m[0]);
                let places = (uv.e + inverse.e).raw().integer() + 32 - 60;
                Fx::from_raw(shifted(Whole::wide_integer(repeats.raw()), places) & 0xffff_ffff)
            })),
            duv: each!(axis in [0, 1] => {
                port(&times(&derivative(&uv, &plane.derivative[axis], w, &weight.derivative[axis]), &square))
            }),
        }
    }
}

impl Iterator for Scanline<'_> {
    type Item = Fragment;

    fn next(&mut self) -> Option<Fragment> {
        let x = self.columns.next()?;
        let w = self.weight.value();
        let reflection = self.reflection(&w);
        let texture = self.fragments.uv.as_ref().zip(self.uv.as_ref());
        let texture = texture.map(|(plane, line)| self.texture(plane, line, &w));
        self.weight.step();
        self.normal.step();
        self.view.step();
        self.main_direction.step();
        if let Some(uv) = &mut self.uv {
            uv.step();
        }
        Some(Fragment { x, reflection, texture })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.columns.size_hint()
    }
}

impl ExactSizeIterator for Scanline<'_> {}
