//! # roughxel-study
//!
//! Studies of the datapath: [`accuracy`] against the float64 reference, [`stability`] near degeneracies, the cost of each effect
//! of a scene ([`plan`]), and the cost of accuracy in time ([`measurement`]). The measurement compares [`frames`] with float64 and measures
//! the clocks of a [`host`], of [`hardware`], of a [`soft_core`] and of memory; [`report`] makes a page of it. [`choose`] selects
//! a precision, which a [`profile_file`] stores.

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
pub mod measurement;

mod distribution;
mod error;
mod subject;
mod superscript;

pub use error::StudyError;
pub use subject::Subject;
