//! # roughxel-vectors
//!
//! Golden vectors: packed words and a JSON manifest with every stage's values. `vectors/FORMAT.md` is the specification.
//!
//! [`export`](export()) writes a set, [`verify`](verify()) recomputes every value from the inputs in the file and names set, index, stage,
//! field and bit of a difference, [`Vector`] explains one word next to the float64 reference, [`Testbench`] compares a device with a
//! set in a simulator. A word ends in a check value that locates a single flipped bit in any field, including inputs, for which
//! recomputation alone would show only the consequences.

mod testbench;
mod bound;
mod c_library;
mod columns;
mod datapath;
mod condense;
mod explain;
mod export;
mod field;
mod files;
mod format;
mod coverage;
mod check;
mod layout;
mod lines;
mod manifest;
mod ambiguous;
mod merge;
mod shell;
mod shrink;
mod order;
mod outcomes;
mod part;
mod rom;
mod coverage_count;
mod sets;
mod stage;
mod vcd;
mod verify;
mod word;

use std::io;
use std::ops::Range;
use std::path::PathBuf;

use thiserror::Error;

pub use ambiguous::{Ambiguous, AmbiguousVector, ambiguous};
pub use c_library::c_library_files;
pub use check::{CheckResult, Failing, Tier, check};
pub use condense::{Condensed, Mistake, Picked, Wanted, condense};
pub use coverage::{Alarm, Attained, CoverageReport, StageCoverage, TableCoverage, Unseen, coverage, write_coverage};
pub use coverage_count::{Coverage, CoverageEntry};
pub use datapath::{InputSource, Inputs, Ports};
pub use explain::{Decision, DeviceWord, DeviceWordError, Explained, Explanation, Got, Real, Vector, Wrong};
pub use export::{SetExport, SetInfo, Words, export, export_with};
pub use field::{Direction, Field};
pub use format::{FormatError, in_page, tables};
pub use layout::Layout;
pub use manifest::{FORMAT_VERSION, Form, Manifest, SCHEMA, StageEntry};
pub use merge::{MergeError, Parts, parts_of};
pub use order::Misplaced;
pub use part::{Part, Shard};
pub use rom::rom_files;
pub use sets::{RANDOM_SETS, RandomSet, RandomSetSummary, VectorSet, entries_set, hard_sets, random_set};
pub use shell::shell_bench;
pub use shrink::{ShrinkError, ShrinkOptions, Shrunk, shrink};
pub use stage::StageSet;
pub use testbench::{Device, HardwareForm, TESTBENCH_README, Testbench, TestbenchError};
pub use vcd::vcd;
pub use verify::{Cause, Mismatch, Verification, manifests_in, manifests_of, verify};

/// Most vectors of one set.
pub const MAX_VECTORS: u64 = 1 << 22;

/// Reason why a set cannot be written or read.
#[derive(Debug, Error)]
pub enum VectorError {
    /// A file or directory cannot be read or written.
    #[error("cannot {action} {}", .path.display())]
    Io {
        /// The action that failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
    /// A directory without a single set.
    #[error("{}: no vector set here (a set is NAME.json next to NAME.hex or NAME.bin)", .0.display())]
    NoSets(PathBuf),
    /// Not a manifest this version understands.
    #[error("{}: {problem}", .path.display())]
    Manifest {
        /// The manifest.
        path: PathBuf,
        /// The fault, with line and column if there is one, and the remedy.
        problem: String,
    },
    /// A line of a file of words, or a record, is not a word of the set.
    #[error("{}:{line}: {problem}", .path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Line or record, from 1.
        line: u64,
        /// The fault.
        problem: String,
    },
    /// A file holds a different number of vectors than its manifest states.
    #[error(
        "{}: {found} vectors, but the manifest says {expected}; the file is cut short or was added to{cause}. Export the set again",
        .path.display()
    )]
    Count {
        /// The file.
        path: PathBuf,
        /// Words in the file.
        found: u64,
        /// Words in the manifest.
        expected: u64,
        /// Missing or extra words, if they are known; begins with a semicolon.
        cause: String,
    },
    /// A set's name would make a bad file name.
    #[error("`{0}` cannot name a set: use 1 to 64 lower-case letters, digits and underscores")]
    Name(String),
    /// A set without vectors, or with too many.
    #[error("set {set}: {count} vectors; a set has 1 to {MAX_VECTORS}")]
    Size {
        /// The set.
        set: String,
        /// Requested number.
        count: u64,
    },
    /// A set has no vector of that index.
    #[error(
        "{}: there is no vector #{index}; {} has {}, #{} to #{}",
        .path.display(), if .indices.start == 0 { "the set" } else { "this part of it" }, .indices.end - .indices.start, .indices.start, .indices.end - 1
    )]
    Index {
        /// The manifest.
        path: PathBuf,
        /// Requested index.
        index: u64,
        /// Indices of the set, or of its part.
        indices: Range<u64>,
    },
    /// A port value has more bits than the profile keeps, so its field cannot hold it.
    #[error("set {set} #{index}: field {field} has bits the profile does not keep; quantise fragments to the profile")]
    Inexact {
        /// The set.
        set: String,
        /// Index of the fragment.
        index: u64,
        /// The field.
        field: String,
    },
}
