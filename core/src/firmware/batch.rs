//! Batches: fragments that are shaded pass by pass, so that the code of a pass stays in a small instruction cache.

use core::array;

use super::{Environment, FaceFootprint, Firmware, Word, knobs};
use crate::block::Block;
use crate::bundle::{Bundle, End};
use crate::datapath::{self, Framed, Surface};
use crate::fx::Int;
use crate::plan::{FootprintKind, ReflectionPlan};
use crate::ports::{Port, ReflectionIn};
use crate::precision::RoughnessKind;
use crate::scalar::Scalar;
use crate::signals::{Axes, CubePoint, Ellipse, MapScale, Probes, Reflected};
use crate::stage::columns::Mirror;
use crate::width::of_ports;

/// Reflection of up to `N` fragments, with the bits of [`Firmware::reflect`].
///
/// A fragment alone runs through all code of its plan, up to 20 KB. A batch runs a few stages on all its fragments before it goes on to the next
/// stages. With all effects a fragment touches at most 3.3 KB of code between two of these passes, so a core with a cache of 4 KiB loads the code once a
/// batch. A core without an instruction cache gains nothing: it should run its fragments alone.
///
/// A row of memory holds a fragment between passes. It has 284 bytes, so `N` = 64 takes 18 KB and `N` = 16 takes 4.5 KB.
///
/// ```
/// use roughxel_core::firmware::{Batch, Firmware, Standard};
/// use roughxel_core::plan::{Effects, FootprintKind};
/// use roughxel_core::ports::ReflectionIn;
///
/// struct Chrome;
/// impl Firmware for Chrome {
///     type Accuracy = Standard;
///     const EFFECTS: Effects = Effects { curvature: true, footprint: FootprintKind::Face, ..Effects::NONE };
/// }
///
/// let (scanline, environment) = ([ReflectionIn::default(); 100], Chrome::environment(256));
/// let mut batch = Batch::<Chrome, 32>::new();
/// let mut shaded = 0;
/// for fragments in scanline.chunks(32) {
///     for footprint in batch.reflect(fragments, &environment) {
///         shaded += footprint.probes().len();
///     }
/// }
/// assert_eq!(shaded, 100);
/// ```
#[derive(Debug)]
pub struct Batch<F: Firmware, const N: usize> {
    rows: [Row<F>; N],
}

/// Fragment between two passes.
#[derive(Debug)]
struct Row<F: Firmware> {
    surface: Surface<Word<F>>,
    reflected: Reflected<Word<F>>,
    point: CubePoint<Word<F>>,
    pixel: [Block<Word<F>, 2>; 2],
    rough: [Block<Word<F>, 2>; 2],
    ellipse: Ellipse<Word<F>>,
    axes: Axes<Word<F>>,
    probes: Probes<Word<F>>,
    status: Int<Word<F>>,
}

/// Runs a few stages on all rows: a function of its own for each pass, so the code of a pass is contiguous. `stages` captures no plan and no knobs. As
/// captured data they would bring the stages of all plans into the pass.
#[inline(never)]
fn pass<F: Firmware>(rows: &mut [Row<F>], fragments: &[ReflectionIn], stages: impl Fn(&mut Row<F>, &ReflectionIn)) {
    for (row, fragment) in rows.iter_mut().zip(fragments) {
        stages(row, fragment);
    }
}

impl<F: Firmware, const N: usize> Batch<F, N> {
    /// Memory of a batch.
    #[inline]
    pub fn new() -> Self {
        Self { rows: array::from_fn(|_| Row::new()) }
    }

    /// Runs fragments from their surfaces to the probes on an environment, and returns their footprints in order. It ends after `N` fragments:
    /// [`slice::chunks`] cuts more of them into batches.
    #[inline]
    pub fn reflect(
        &mut self,
        fragments: &[ReflectionIn],
        environment: &Environment<F>,
    ) -> impl ExactSizeIterator<Item = FaceFootprint<F>> + '_ {
        const { assert!(!matches!(F::EFFECTS.footprint, FootprintKind::Sphere), "a batch has no footprint on the sphere") }
        let count = fragments.len().min(N);
        let rows = &mut self.rows;
        pass(rows, fragments, Row::frame);
        pass(rows, fragments, Row::surface);
        pass(rows, fragments, Row::reflected);
        if const { F::EFFECTS.footprint.is_some() } {
            pass(rows, fragments, Row::pixel);
            if const { !matches!(F::EFFECTS.roughness, RoughnessKind::None) } {
                pass(rows, fragments, Row::rough);
            }
            pass(rows, fragments, Row::ellipse);
            pass(rows, fragments, Row::axes);
            pass(
                rows,
                fragments,
                #[inline(always)]
                |row, fragment| {
                    row.probes(&environment.0);
                    row.status(fragment);
                },
            );
        } else {
            pass(rows, fragments, Row::status);
        }
        rows.iter().take(count).map(|row| FaceFootprint { point: row.point, probes: row.probes, status: row.status })
    }
}

impl<F: Firmware, const N: usize> Default for Batch<F, N> {
    #[inline]
    fn default() -> Self {
        Self::new()
    }
}

/// Bundle before its first pass.
fn unused<F: Firmware, B: Bundle<Scalar>>() -> B::In<Word<F>> {
    B::limit(End::Low)
}

/// Functions of the passes, one each.
impl<F: Firmware> Row<F> {
    const PLAN: ReflectionPlan = F::EFFECTS.reflection();

    fn new() -> Self {
        Self {
            surface: unused::<F, Surface<Scalar>>(),
            reflected: unused::<F, Reflected<Scalar>>(),
            point: unused::<F, CubePoint<Scalar>>(),
            pixel: unused::<F, [Block<Scalar, 2>; 2]>(),
            rough: unused::<F, [Block<Scalar, 2>; 2]>(),
            ellipse: unused::<F, Ellipse<Scalar>>(),
            axes: unused::<F, Axes<Scalar>>(),
            probes: datapath::no_probes(),
            status: Int::<Word<F>>::zero(),
        }
    }

    #[inline(always)]
    fn frame(&mut self, fragment: &ReflectionIn) {
        let normal = of_ports::<Word<F>, _>(&fragment.surface.normal.wires());
        let vectors = of_ports::<Word<F>, _>(&fragment.surface.frame_vectors.wires());
        let Framed { normal, frame } = datapath::framed(&normal, &vectors, &Self::PLAN.surface(), knobs::<F>());
        (self.surface.normal, self.surface.frame) = (normal, frame);
    }

    #[inline(always)]
    fn surface(&mut self, fragment: &ReflectionIn) {
        let framed = Framed { normal: self.surface.normal, frame: self.surface.frame };
        let input = of_ports::<Word<F>, _>(&fragment.surface.wires());
        let made = datapath::surface_in_frame(&framed, &input, &Self::PLAN.surface(), knobs::<F>());
        (self.surface.view, self.surface.normal_mod, self.surface.rough) = (made.view, made.normal_mod, made.rough);
    }

    #[inline(always)]
    fn reflected(&mut self, _: &ReflectionIn) {
        (self.reflected, self.point) = datapath::mirrored(&self.surface, knobs::<F>());
    }

    #[inline(always)]
    fn mirror(&self) -> Mirror<'_, Word<F>> {
        datapath::mirror(&self.surface, &self.reflected, &self.point)
    }

    #[inline(always)]
    fn pixel(&mut self, fragment: &ReflectionIn) {
        let dview = of_ports::<Word<F>, _>(&fragment.dview.wires());
        let dnormal = of_ports::<Word<F>, _>(&fragment.dnormal.wires());
        // A loop: the code of a column is half of what a pass may have.
        for side in 0..2 {
            let column =
                datapath::pixel_column(&self.mirror(), [&dview[side], &dnormal[side]], &Self::PLAN, knobs::<F>());
            self.pixel[side] = column;
        }
    }

    #[inline(always)]
    fn rough(&mut self, _: &ReflectionIn) {
        for side in 0..2 {
            let column = datapath::rough_column(&self.mirror(), &self.surface, side, knobs::<F>());
            self.rough[side] = column;
        }
    }

    #[inline(always)]
    fn ellipse(&mut self, _: &ReflectionIn) {
        self.ellipse = datapath::face_ellipse(&self.pixel, &self.rough, &Self::PLAN, knobs::<F>());
    }

    #[inline(always)]
    fn axes(&mut self, _: &ReflectionIn) {
        self.axes = datapath::principal(&self.ellipse, knobs::<F>());
    }

    #[inline(always)]
    fn probes(&mut self, map: &MapScale<Word<F>>) {
        self.probes = datapath::covering(&self.axes, map, knobs::<F>());
    }

    #[inline(always)]
    fn status(&mut self, _: &ReflectionIn) {
        self.status = datapath::status(&self.surface, &self.reflected, &self.point, &self.probes);
    }
}
