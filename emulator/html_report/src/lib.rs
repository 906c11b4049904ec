//! # roughxel-html-report
//!
//! Self-contained pages: [`html`] without script, [`plot`]s as SVG.

pub mod html;
pub mod plot;
