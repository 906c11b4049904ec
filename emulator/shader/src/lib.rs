//! # roughxel-shader
//!
//! The way of a fragment, from attributes to colour, for batches of fragments on every backend.
//!
//! [`Shader::shade`] is the block diagram as code: every pass by its name, in order.
//!
//! - A **batch** ([`Batch`]) holds a bundle for each of many fragments, one row for each word. Rows have the names of their declarations.
//! - A **pass** ([`Surfaces`], [`Colours`], …) is a structure of the batches that it reads. Its body is generic over words. It loads a group of
//!   fragments, calls the composer of `roughxel-core`, and stores the resulting group.
//! - A [`Material`] is the part of an object: its plan, constants and maps. [`Fragments`] of one object wait until they fill a batch; [`Sums`] hold
//!   the light of pixels.
//!
//! The bits depend neither on the backend nor on how fragments are put into batches.

mod attributes;
mod batch;
mod datapaths;
mod environment;
mod fragment_ports;
mod fragments;
mod lights;
mod maps;
mod material;
mod order;
mod pass;
mod peak_passes;
mod peaks;
mod peaks_read;
mod phases;
mod plan;
mod shade;
mod signals;
mod sums;
mod surface;
mod texels;

pub use attributes::{AttributeRows, FragmentAttributes, Needs, same_rows};
pub use batch::{Appended, Batch, BlockRows, Row};
pub use datapaths::{LitPeaks, LitSurfaces, Reflections};
pub use environment::{EnvironmentColours, Lobes, Ordered, Reflector};
pub use fragment_ports::FragmentPorts;
pub use fragments::{Fragments, MapFootprints, Place};
pub use lights::{GivenPeaks, Halves, Highlights, HorizonSlopes, Lit};
pub use maps::{BumpMap, Bumps, ColourMap, Colours, Places, TextureDerivatives, TextureFootprints};
pub use material::{Channel, Formula, Light, Lighting, Material, Shine, core_and_whole};
pub use pass::{Environment, Shader};
pub use peaks::{MOST_PEAKS, PackedPeak, PeakTexels};
pub use peaks_read::{LightOnPeaks, PeaksRead};
pub use phases::{Phase, PhaseClock, PhaseTimes};
pub use plan::{Effect, ObjectPlan};
pub use shade::Work;
pub use signals::{Derivatives, FaceFootprint, FilteredBump, Ports, ShadedColour, Slopes, SurfaceAttributes};
pub use sums::Sums;
pub use surface::{Footprints, LobeLaws, LobeSurfaces, Points, Reflected, Surfaces, Sweeps};
pub use texels::{BumpTexels, CubeTexels, MapTexels, RoughBump, Texel, WrappedMap};
