//! Attributes of fragments from the rasteriser: one by one as ports, or a vector of fragments as rows.

use fixed::types::U0F32;
use roughxel_core::ports::{BlockPair, BlockVector};
use roughxel_simd::LANES;

use crate::batch::{BlockRows, Row};

/// Attributes of one fragment as ports; vectors in world space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FragmentAttributes {
    /// Unnormalised normal: Σ βᵢ nᵢ / w of unit vertex normals, times one power of two per triangle. If all vertex normals are equal it is that
    /// normal, its largest component 1 − 2⁻¹².
    pub normal: BlockVector,
    /// Vector v from the surface to the eye, in pixels of the picture plane; x right, y down.
    pub view: BlockVector,
    /// p_u and p_v in world units per repeat, perspective-correct.
    pub frame_vectors: [BlockVector; 2],
    /// ∂v/∂x and ∂v/∂y per pixel (y down), in the units of `view`.
    pub dview: [BlockVector; 2],
    /// ∂n/∂x and ∂n/∂y per pixel (y down), in the units of `normal`; constant over the triangle.
    pub dnormal: [BlockVector; 2],
    /// Texture coordinates in repeats, modulo 1, perspective-correct.
    pub uv: [U0F32; 2],
    /// ∂(u, v)/∂x and ∂(u, v)/∂y in repeats per pixel (y down).
    pub duv: [BlockPair; 2],
}

/// Attributes that not every object reads; unread attributes are zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Needs p_u and p_v: S97 systems 1 and 2.
    pub tangents: bool,
    /// Needs u and v: maps.
    pub uv: bool,
    /// Needs derivatives of u and v: maps with footprints. Only together with u and v.
    pub duv: bool,
}

impl Needs {
    /// Every attribute.
    pub const ALL: Self = Self { tangents: true, uv: true, duv: true };
}

/// Attributes of [`LANES`] fragments in lanes, with the names of [`FragmentAttributes`]. A row is a cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub struct AttributeRows {
    /// Unnormalised normals.
    pub normal: BlockRows<3>,
    /// Vectors from the surface to the eye.
    pub view: BlockRows<3>,
    /// p_u and p_v, or the main direction and zeros.
    pub frame_vectors: [BlockRows<3>; 2],
    /// Texture coordinates with 32 fraction bits.
    pub uv: [Row; 2],
    /// Derivatives of the texture coordinates.
    pub duv: [BlockRows<2>; 2],
}

/// Rows with one block in every lane.
pub fn same_rows(block: &BlockVector) -> BlockRows<3> {
    let BlockVector { mantissa, exponent } = block;
    BlockRows { mantissa: mantissa.map(|mantissa| [mantissa.to_bits(); LANES]), exponent: [(*exponent).into(); LANES] }
}
