//! Errors of mesh files.

use std::path::Path;

/// Reason why a mesh cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {message}; {remedy}")]
pub struct MeshError {
    /// The file, with the line from 1 if a line is wrong.
    pub place: String,
    /// The mistake.
    pub message: String,
    /// The way to mend it.
    pub remedy: String,
}

impl MeshError {
    pub(crate) fn new(path: &Path, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: path.display().to_string(), message: message.into(), remedy: remedy.into() }
    }

    /// An error in a line of a text, from 1.
    pub(super) fn in_line(path: &Path, line: usize, message: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { place: format!("{}:{line}", path.display()), ..Self::new(path, message, remedy) }
    }

    /// An error for a file or a number of triangles beyond the limit.
    pub(super) fn too_large(path: &Path, what: &str, limit: u64) -> Self {
        Self::new(path, format!("{what} is more than {limit}"), "simplify the mesh")
    }
}
