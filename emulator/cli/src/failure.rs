//! Failures of commands, and the form of error messages.

use std::error::Error;
use std::io;

use miette::{LabeledSpan, MietteDiagnostic, NamedSource, Report};
use roughxel_scene::{Fault, SceneError};
use roughxel_study::profile_file::ProfileError;

/// Reason why a command ends without success.
pub(super) enum Failure {
    /// An error: exit code 1.
    Error(Report),
    /// Arguments that contradict each other or name something unknown: exit code 2.
    Usage(String),
    /// A failed comparison, already described: exit code 3.
    Mismatch(String),
    /// The reader of the output closed the pipe: exit code 0.
    BrokenPipe,
}

/// Converts a library error with its chain of causes. A diagnostic with source text is made with [`Failure::Error`].
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

/// Makes the failure of a scene, drawn with its source line if there is one.
pub(super) fn scene_failure(error: SceneError) -> Failure {
    match error.fault() {
        Some(fault) => drawn(fault),
        None => error.into(),
    }
}

/// Makes the failure of a profile file, drawn with its source line if there is one.
pub(super) fn profile_failure(error: ProfileError) -> Failure {
    match error {
        ProfileError::Fault(fault) => drawn(&fault),
        error => error.into(),
    }
}

/// Makes the failure of a fault at a place in a file, drawn with its line.
fn drawn(fault: &Fault) -> Failure {
    let label = LabeledSpan::at(fault.span.clone(), fault.message.clone());
    let place = format!("{}:{}:{}: {}", fault.file, fault.line, fault.column, fault.message);
    let diagnostic = MietteDiagnostic::new(place).with_label(label).with_help(fault.help.clone());
    Failure::Error(Report::new(diagnostic).with_source_code(NamedSource::new(&fault.file, fault.text.to_string())))
}

/// Joins errors, each the cause of the previous one. A cause that the text already contains is not repeated.
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
