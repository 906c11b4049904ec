//! The hardware blocks, one file each, in pipeline order. Stages never import each other; what one hands to the
//! next is a bundle of [`crate::signals`] or of the stage that makes it, passed on by [`crate::datapath`].

// From ports to a perturbed, rough surface.
pub mod enter;
pub mod frame;
pub mod perturb;
pub mod roughness;

// From the surface to a footprint on the environment.
pub mod reflect;
pub mod cube_face;
pub mod columns;

// The footprint in a repeated map, and what both kinds share.
pub mod texture;
pub mod ellipse;
pub mod axes;
pub mod probes;

// The footprint on the sphere.
pub mod sweep;

// From texels to samples.
pub mod seam;
pub mod filter;
pub mod moments;

// Lights.
pub mod half;
pub mod highlight;
pub mod local;
pub mod horizon;
pub mod peaks;

// From samples to a pixel, and from the datapath to ports.
pub mod blend;
pub mod pixel;
pub mod leave;
