//! The composer: the stages in pipeline order, and no arithmetic of its own.
//!
//! ```text
//!  n h|p_u p_v      b          v                    dv dn   d
//!      │            │          │                      │      │
//!    frame ───► perturb ──► reflect ──► cube_face ──► columns ◄── roughness
//!                                           │            │
//!                                           │         ellipse ──► axes ──► probes
//!                                           └──────────────────────────────┤
//!      continuation ──► address ──► [memory] ──► filter ──► sum, mean ──► colour ──► blend ──► sum ──► pixel
//!  u v, d(u,v) ──► texture ──► ellipse ──► axes ──► probes ──► address ──► [memory] ──┬─► filter ──► colour ──► modulated ──► blend
//!                                                                                     └─► moments ──► b, d
//!  h, frame ──► local ──► peaks ──► light        l, v, frame ──► local ──► horizon ──► weight of a peak
//!
//!  l, v ──► half ──► highlight ◄── spread ◄── perturb, roughness                light ──► modulated ──► sum
//! ```
//!
//! One module for each part: [`surface`](mod@surface), [`reflection`](mod@reflection), [`footprint`], [`texel`], [`light`], [`pixel`].

pub mod surface;
pub mod reflection;
pub mod footprint;
pub mod texel;
pub mod light;
pub mod pixel;

pub use footprint::{
    TextureFootprint, covering, cube_place, environment_probe, principal, probe_reach, sphere_probe, texture_footprint,
    texture_probe,
};
pub use light::{
    Gloss, Highlight, LitSurface, PeakLight, gloss, highlight, horizon, horizon_slopes, leave_highlight, lit_peak,
    lit_surface, local_components, local_direction, packed_peak, peak, peak_light, peak_sum,
};
pub use reflection::{
    Reflection, face_ellipse, fragment, map_scale, mirror, mirrored, no_probes, pixel_column, reflection,
    reflection_of, rough_column, status,
};
pub use surface::{Framed, LobeLaw, Surface, framed, lobe, lobe_law, surface, surface_in_frame};
