//! Bundles that one pass hands to the next, and questions about the rows of a whole batch.

use roughxel_core::bundle::bundle;
use roughxel_core::datapath::Reflection;
use roughxel_core::datapath::texel::Bump;
use roughxel_core::fx::{Control, Fx};
use roughxel_core::ports::{LIGHT, PortBlock, ReflectionInput, SurfaceInput};
use roughxel_core::signals::{AxisSlope, CubePoint, Probes, Sweep};
use roughxel_core::word::Word;

use crate::batch::Batch;

bundle! {
    /// Attributes of a surface, without its bumps.
    pub struct SurfaceAttributes<W> {
        /// Unnormalised normal.
        normal: PortBlock<W, 3>,
        /// Vector from the surface to the eye.
        view: PortBlock<W, 3>,
        /// p_u and p_v, or the main direction and zeros.
        frame_vectors: [PortBlock<W, 3>; 2],
    }

    /// Derivatives of a fragment's normal and view over a pixel.
    pub struct Derivatives<W> {
        /// ∂v/∂x and ∂v/∂y.
        dview: [PortBlock<W, 3>; 2],
        /// ∂n/∂x and ∂n/∂y.
        dnormal: [PortBlock<W, 3>; 2],
    }

    /// Bumps and roughness of a fragment, and the number of samples read for them.
    pub struct FilteredBump<W> {
        /// Offset and roughness as the ports of the surface take them.
        bump: Bump<W>,
        /// Number of bilinear samples.
        #[range(0..=32)]
        samples: Int<W>,
    }

    /// A colour, and the number of samples read for it.
    pub struct ShadedColour<W> {
        /// Linear light.
        #[range(0..64)]
        channels: [Control<W, LIGHT>; 3],
        /// Number of bilinear samples, at most those of two lobes.
        #[range(0..=64)]
        samples: Int<W>,
    }

    /// Point and probes of a reflection: the input of a fetch.
    pub struct FaceFootprint<W> {
        /// Face, s, t.
        point: CubePoint<W>,
        /// N, step, level of detail.
        probes: Probes<W>,
    }

    /// Slopes of a light and of the eye, for comparison with horizons.
    pub struct Slopes<W> {
        /// Slopes of the light over both axes of the surface.
        light: [AxisSlope<W>; 2],
        /// Slopes of the eye.
        eye: [AxisSlope<W>; 2],
    }
}

impl<W: Word> FaceFootprint<W> {
    /// Takes the footprint out of a reflection.
    #[inline(always)]
    pub fn from_reflection(stages: &Reflection<W>) -> Self {
        Self { point: stages.point, probes: stages.probes }
    }
}

/// Ports of a surface.
#[inline(always)]
pub(crate) fn ports<W: Word>(bare: &SurfaceAttributes<W>, bump: &Bump<W>) -> SurfaceInput<W> {
    let SurfaceAttributes { normal, view, frame_vectors } = *bare;
    SurfaceInput { normal, view, frame_vectors, offset: bump.offset, roughness: bump.roughness }
}

impl Batch<FilteredBump<i32>> {
    /// Returns true if no fragment is rough.
    pub fn is_smooth(&self) -> bool {
        self.rows_of(|bumped| bumped.bump.roughness).all(|row| row.iter().all(|&d| d == 0))
    }

    /// Number of bilinear samples of all fragments.
    pub fn samples(&self) -> u64 {
        sum(self.row_of(|bumped| bumped.samples))
    }
}

impl Batch<ShadedColour<i32>> {
    /// Colour of each fragment.
    pub fn colours(&self) -> impl Iterator<Item = [Control<i32, LIGHT>; 3]> + '_ {
        let [red, green, blue] = [0, 1, 2].map(|channel| self.row_of(|shown| shown.channels[channel]));
        red.iter().zip(green).zip(blue).map(|((&red, &green), &blue)| [red, green, blue].map(Fx::from_raw))
    }

    /// Number of bilinear samples of all fragments.
    pub fn samples(&self) -> u64 {
        sum(self.row_of(|shown| shown.samples))
    }
}

fn sum(samples: &[i32]) -> u64 {
    samples.iter().map(|samples| u64::from(samples.unsigned_abs())).sum()
}

impl Batch<SurfaceAttributes<i32>> {
    /// Returns true if there are fragments and all share one normal and tangent basis.
    #[inline(always)]
    pub(crate) fn is_in_one_frame(&self) -> bool {
        let mut rows = self.rows_of(|bare| bare.normal).chain(self.rows_of(|bare| bare.frame_vectors));
        !self.is_empty() && rows.all(|row| row.iter().fold(0, |differs, &word| differs | (word ^ row[0])) == 0)
    }
}

impl Batch<FaceFootprint<i32>> {
    /// Probe count of each fragment.
    pub fn counts(&self) -> &[i32] {
        self.row_of(|footprint| footprint.probes.count)
    }
}

impl Batch<Sweep<i32>> {
    /// Probe count of each fragment.
    pub fn counts(&self) -> &[i32] {
        self.row_of(|sweep| sweep.count)
    }
}

impl Batch<Derivatives<i32>> {
    /// Returns true if no fragment's surface is curved.
    pub fn is_flat(&self) -> bool {
        let [x, y] = [0, 1].map(|side| self.rows_of(move |derivatives| derivatives.dnormal[side].mantissa));
        x.chain(y).all(|row| row.iter().all(|&m| m == 0))
    }
}

/// Fragments as ports, taken apart, for callers that have them one by one.
#[derive(Clone, Debug, Default)]
pub struct Ports {
    /// Attributes without bumps.
    pub bare: Batch<SurfaceAttributes<i32>>,
    /// Bumps and roughness, with no samples read.
    pub bumps: Batch<FilteredBump<i32>>,
    /// Derivatives over the pixel.
    pub derivatives: Batch<Derivatives<i32>>,
}

impl Extend<ReflectionInput<i32>> for Ports {
    fn extend<I: IntoIterator<Item = ReflectionInput<i32>>>(&mut self, inputs: I) {
        for ReflectionInput { surface, dview, dnormal, .. } in inputs {
            let SurfaceInput { normal, view, frame_vectors, offset, roughness } = surface;
            self.bare.push(&SurfaceAttributes { normal, view, frame_vectors });
            self.bumps.push(&FilteredBump { bump: Bump { offset, roughness }, samples: Fx::zero() });
            self.derivatives.push(&Derivatives { dview, dnormal });
        }
    }
}

impl FromIterator<ReflectionInput<i32>> for Ports {
    fn from_iter<I: IntoIterator<Item = ReflectionInput<i32>>>(inputs: I) -> Self {
        let mut ports = Self::default();
        ports.extend(inputs);
        ports
    }
}

impl Ports {
    /// Removes all fragments; the memory is kept.
    pub fn clear(&mut self) {
        self.bare.clear();
        self.bumps.clear();
        self.derivatives.clear();
    }
}
