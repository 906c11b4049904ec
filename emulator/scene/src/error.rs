//! Errors of scene files, and places in files that people write: what is wrong, where it stands, and what to do about it.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use crate::mesh::MeshError;
use crate::picture::PictureError;
use roughxel_utilities::limits::{MAX_FRAME_EDGE_PX, MAX_FRAME_PIXELS, MAX_SCENE_BYTES};

/// A place in a file that people write, a scene or a profile, with what is wrong there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file, or the label the text came with.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Byte range in `text`.
    pub span: Range<usize>,
    /// The whole file.
    pub text: Arc<str>,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl Fault {
    /// A fault at the byte range `span` of `text`; a range outside `text` is cut to it.
    pub fn new(file: &str, text: &Arc<str>, span: Range<usize>, message: String, help: String) -> Self {
        let start = floor_char_boundary(text, span.start);
        let end = floor_char_boundary(text, span.end).max(start);
        let before = &text[..start];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        Self {
            file: file.to_owned(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            span: start..end,
            text: Arc::clone(text),
            message,
            help,
        }
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { file, line, column, message, help, .. } = self;
        write!(out, "{file}:{line}:{column}: {message} ({help})")
    }
}

/// The last character boundary at or below `index`.
fn floor_char_boundary(text: &str, index: usize) -> usize {
    let mut at = index.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// Why a scene cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The scene file cannot be read.
    #[error("{}: cannot read the scene file: {source} (check the name and the permissions)", path.display())]
    Unreadable {
        /// The scene file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Neither a file nor a built-in scene.
    #[error(
        "{name}: there is no such scene file, and no built-in scene of that name ({meant}`roughxel scenes` lists them)"
    )]
    NoScene {
        /// What was asked for.
        name: String,
        /// The start of the remedy: a built-in scene of a similar name, or nothing.
        meant: String,
    },
    /// The scene file is larger than any scene needs.
    #[error("{}: is {bytes} bytes long, more than {MAX_SCENE_BYTES} (is it a scene file?)", path.display())]
    TooLarge {
        /// The scene file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// The scene file is not UTF-8 text.
    #[error("{}: is not UTF-8 text (save the scene file as UTF-8)", path.display())]
    NotText {
        /// The scene file.
        path: PathBuf,
    },
    /// Not TOML, an unknown or missing key, or a value of the wrong type.
    #[error("{0}")]
    Syntax(Box<Fault>),
    /// A value out of range, or values that do not fit each other.
    #[error("{0}")]
    Value(Box<Fault>),
    /// A picture named in the scene cannot be used.
    #[error("{fault}")]
    Picture {
        /// Where the picture is named.
        fault: Box<Fault>,
        /// What is wrong with it.
        source: PictureError,
    },
    /// A mesh named in the scene cannot be used.
    #[error("{fault}")]
    Mesh {
        /// Where the mesh is named.
        fault: Box<Fault>,
        /// What is wrong with it.
        source: MeshError,
    },
    /// A frame size from outside the scene file is out of range.
    #[error(
        "a frame of {width}×{height} pixels is out of range \
         (choose edges of 1 to {MAX_FRAME_EDGE_PX} and at most {MAX_FRAME_PIXELS} pixels)"
    )]
    FrameSize {
        /// Width asked for, pixels.
        width: u32,
        /// Height asked for, pixels.
        height: u32,
    },
}

impl SceneError {
    /// The place in the scene file, where there is one.
    pub fn fault(&self) -> Option<&Fault> {
        match self {
            Self::Syntax(fault) | Self::Value(fault) => Some(fault),
            Self::Picture { fault, .. } | Self::Mesh { fault, .. } => Some(fault),
            Self::Unreadable { .. }
            | Self::NoScene { .. }
            | Self::TooLarge { .. }
            | Self::NotText { .. }
            | Self::FrameSize { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_spans_are_cut_to_the_text() {
        let text: Arc<str> = "a = 1\nπ = é\n".into();
        let at = text.find('é').unwrap_or(0);
        let fault = Fault::new("x.toml", &text, at..at + 2, "m".into(), "h".into());
        assert_eq!((fault.line, fault.column), (2, 5));
        let inside_a_character = Fault::new("x.toml", &text, at + 1..900, "m".into(), "h".into());
        assert_eq!(inside_a_character.span, at..text.len());
    }
}
