//! A picture between its reader and the caller.

use super::Picture;
use super::statement::Statement;

/// A picture as a reader for one kind gives it.
pub(super) struct Decoded {
    pub(super) picture: Picture,
    /// Words of the file; [`read`](super::read()) adds kind and size.
    pub(super) statement: Statement,
    /// Largest code of a channel; `None` for floats.
    pub(super) largest_code: Option<u32>,
    /// Channels that became the picture, 1 to 3.
    pub(super) channels: usize,
}
