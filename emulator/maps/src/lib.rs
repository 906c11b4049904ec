//! # roughxel-maps
//!
//! Maps in the memory layout of the texture unit: integer pyramids built once per scene from pictures.
//!
//! Level `l` is `max(1, width >> l)` × `max(1, height >> l)` texels, until 1×1, for any size. Every texel is the exact mean
//! of level 0 over the area it covers, rounded once ([`mip`]). Bump maps also keep the covariance of the bumps that a level
//! no longer shows ([`bump`], [`roughness`]). The sums are integers; the rest (`√`, quotients) uses only correctly rounded
//! float64 operations, and the fits of [`law`] the exponential of `libm`. The texels are therefore the same bits on every machine and for any thread count.

pub mod bright;
pub mod bump;
pub mod environment;
pub mod law;
pub mod mip;
pub mod roughness;
mod sphere;
