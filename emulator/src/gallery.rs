//! The gallery: every scene of the papers beside what it is compared with, judged against supersampling.
//!
//! [`table`] lists the scenes and their columns; [`draw_scene`] draws one into files, [`write_page`] makes one page of all
//! of them. A column is the scene in a mode, perhaps changed ([`change`]): without its texture, with another formula.
//! The reference is 1024 unfiltered samples a pixel in the most precise profile, kept between runs (`reference`).
//! Times are of drawing only: maps are built before, and a column is drawn again while that is quick, the fastest counts.

pub mod change;
mod draw;
mod drawn;
mod entry;
mod page;
mod prepared;
mod reference;
pub mod table;

pub use change::Change;
pub use draw::{draw_scene, work};
pub use drawn::{DrawnColumn, DrawnReference, DrawnScene, GalleryError, Settings};
pub use entry::{Column, Entry};
pub use page::write_page;
