//! Errors of scene files, and places in files that people write: the mistake, its place and its remedy.

use std::io;
use std::ops::Range;
use std::sync::Arc;

/// A mistake in a file that people write (a scene or a profile) and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The file, or the label of the text.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Byte range in `text`.
    pub span: Range<usize>,
    /// The whole file.
    pub text: Arc<str>,
    /// The mistake.
    pub message: String,
    /// The remedy.
    pub help: String,
}

impl Fault {
    /// A fault at the byte range `span` of `text`. A range outside `text` is clamped to it.
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

/// Reason why a scene cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// A mistake at a place of the file: not TOML, a value that does not fit, an unusable picture or mesh.
    #[error("{0}")]
    Fault(Box<Fault>),
    /// A mistake of the file as a whole, or of the request.
    #[error("{message}")]
    Whole {
        /// The mistake and its remedy.
        message: String,
        /// Error of the system.
        source: Option<io::Error>,
    },
}

impl SceneError {
    pub(crate) fn whole(message: impl Into<String>) -> Self {
        Self::Whole { message: message.into(), source: None }
    }

    /// The place in the scene file, if there is one.
    pub fn fault(&self) -> Option<&Fault> {
        match self {
            Self::Fault(fault) => Some(fault),
            Self::Whole { .. } => None,
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
