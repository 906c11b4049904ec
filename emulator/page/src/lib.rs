//! # roughxel-page
//!
//! Pages that need nothing beside them: [`html`] without script.

pub mod html;
