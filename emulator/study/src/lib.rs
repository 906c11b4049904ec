//! # roughxel-study
//!
//! Studies of the datapath: [`accuracy`] against the float64 reference, [`stability`] beside degeneracies, what each effect of a scene
//! costs ([`plan`]), and what accuracy costs in time ([`sweep`]): [`frames`] against float64, and the clocks of a [`host`], of [`hardware`],
//! of a [`soft_core`] and of memory, to look at as a page ([`report`]). What to take of it is [`choose`], kept as a [`profile_file`].

pub mod accuracy;
pub mod choose;
pub mod frame_meter;
pub mod frames;
pub mod hardware;
pub mod host;
pub mod plan;
pub mod profile_file;
pub mod report;
pub mod soft_core;
pub mod stability;
pub mod sweep;

mod distribution;
mod error;
mod subject;
mod superscript;

pub use error::StudyError;
pub use subject::Subject;
