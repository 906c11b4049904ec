//! The hardware blocks, one file each, in pipeline order. Stages never import each other; what one hands to the
//! next is a struct of the block that makes it, passed on by [`crate::datapath`].

pub mod axes;
pub mod blend;
pub mod columns;
pub mod cube_face;
pub mod ellipse;
pub mod enter;
pub mod filter;
pub mod frame;
pub mod half;
pub mod highlight;
pub mod horizon;
pub mod leave;
pub mod local;
pub mod moments;
pub mod peaks;
pub mod perturb;
pub mod probes;
pub mod reflect;
pub mod roughness;
pub mod texture;
