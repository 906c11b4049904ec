//! Why a command ends without success, and how errors look.

use std::error::Error;
use std::io;

use miette::{LabeledSpan, MietteDiagnostic, NamedSource, Report};
use roughxel_scene::{Fault, SceneError};
use roughxel_study::profile_file::ProfileError;

/// Why a command ends without success.
pub(super) enum Failure {
    /// Something went wrong: exit code 1.
    Error(Report),
    /// The arguments contradict each other or name what is not there: exit code 2.
    Usage(String),
    /// A comparison failed and has been described: exit code 3.
    Mismatch(String),
    /// Whoever read the output has had enough: no failure at all.
    BrokenPipe,
}

/// A library error, with its chain of causes; a diagnostic with source text comes in by [`Failure::Error`].
impl<E: Error + Send + Sync + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let mut cause: Option<&(dyn Error + 'static)> = Some(&error);
        while let Some(e) = cause {
            if e.downcast_ref::<io::Error>().is_some_and(|e| e.kind() == io::ErrorKind::BrokenPipe) {
                return Self::BrokenPipe;
            }
            cause = e.source();
        }
        Self::Error(Report::from_err(error))
    }
}

/// A scene's error, drawn with its line where it has one.
pub(super) fn scene_failure(error: SceneError) -> Failure {
    match error.fault() {
        Some(fault) => drawn(fault),
        None => error.into(),
    }
}

/// A profile file's error, drawn with its line where it has one.
pub(super) fn profile_failure(error: ProfileError) -> Failure {
    match error {
        ProfileError::Fault(fault) => drawn(&fault),
        error => error.into(),
    }
}

/// What is wrong at a place of a file, with its line.
fn drawn(fault: &Fault) -> Failure {
    let label = LabeledSpan::at(fault.span.clone(), fault.message.clone());
    let place = format!("{}:{}:{}: {}", fault.file, fault.line, fault.column, fault.message);
    let diagnostic = MietteDiagnostic::new(place).with_label(label).with_help(fault.help.clone());
    Failure::Error(Report::new(diagnostic).with_source_code(NamedSource::new(&fault.file, fault.text.to_string())))
}

/// Errors, each the cause of the one before; a cause that is already part of the text is not repeated.
pub(super) fn on_one_line<'a>(errors: impl Iterator<Item = &'a (dyn Error + 'static)>) -> String {
    errors.map(ToString::to_string).fold(String::new(), |text, cause| {
        if text.contains(&cause) {
            text
        } else if text.is_empty() {
            cause
        } else {
            format!("{text}: {cause}")
        }
    })
}
