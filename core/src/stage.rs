//! The hardware blocks, one file each, in pipeline order. Stages never import each other. A stage hands the next one a bundle of [`crate::signals`],
//! or of the stage that makes it; [`crate::datapath`] passes the bundle on.

// From ports to a perturbed, rough surface.
pub mod enter;
pub mod frame;
pub mod perturb;
pub mod roughness;

// From the surface to a footprint on the environment.
pub mod reflect;
pub mod cube_face;
pub mod columns;

// The footprint in a wrapped map, and blocks that both kinds share.
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
