//! # roughxel-scene
//!
//! Scenes: camera, background, environment and objects, read from a TOML file or built in.
//!
//! `description` holds the keys of a file, `source` their places; `load` turns them into a [`Scene`]. `shapes`
//! makes triangles, `bump` makes offset vectors (S97 §7), `roughness` holds finer detail than offsets show. `generate`
//! makes maps that need no download; `builtin` lists the scenes of the papers. All external input is bounded here, so that
//! later stages see finite numbers and indices in range.

mod builtin;
mod bump;
pub mod cube;
mod description;
mod error;
mod faces;
mod generate;
pub mod levels;
mod lighting;
mod load;
mod panorama;
mod roughness;
mod scene;
mod shapes;
mod source;

pub use builtin::{builtin_names, builtin_text};
pub use bump::{BumpField, Edges, FrameSystem, Green, HeightField, HeightScale, NormalCoding, OFFSET_LIMIT};
pub use error::{Fault, SceneError};
pub use generate::MapProgress;
pub use lighting::{
    EXPONENTS, GivenPeak, Highlight, HighlightForm, Light, LightPlace, MAX_GIVEN_PEAKS, MAX_LIGHTS, MAX_PEAK_TEXELS,
    PEAK_HEIGHTS, PeakSource, Peaks, Shadowing,
};
pub use load::inspect::{PictureKey, TakenPicture, mesh_options, take_picture};
pub use panorama::faces_from_equirectangular;
pub use roughness::RoughnessField;
pub use scene::{
    Background, Camera, Deviation, EnvironmentSource, FootprintPlace, Material, Object, PictureUse, Scene,
};
