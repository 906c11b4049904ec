//! # roughxel-html-report
//!
//! Pages that need nothing beside them: [`html`] without script, [`plot`]s as SVG.

pub mod html;
pub mod plot;
