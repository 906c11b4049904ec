//! Measured figures of `docs/performance.md`: tables between markers, filled from `docs/performance.json`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::imports::workspace_root;

/// One measured table with its conditions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Command that measures.
    pub command: String,
    /// Machine, compiler, date and commit, as far as the figures depend on them.
    pub conditions: Vec<String>,
    /// Headings of the columns.
    pub columns: Vec<String>,
    /// Cells of the rows, as text.
    pub rows: Vec<Vec<String>>,
}

/// Sections by the name in their markers.
pub type Results = BTreeMap<String, Section>;

impl Section {
    /// Head line and table in Markdown.
    pub fn markdown(&self) -> String {
        let mut text = format!("`{}`;\n{}.\n\n", self.command, self.conditions.join("; "));
        let rule = vec!["---".to_owned(); self.columns.len()];
        for cells in [&self.columns, &rule].into_iter().chain(&self.rows) {
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        }
        text
    }
}

/// Path of the page.
pub fn page() -> PathBuf {
    workspace_root().join("docs/performance.md")
}

/// Path of the results.
pub fn file() -> PathBuf {
    workspace_root().join("docs/performance.json")
}

/// Reads the committed results.
///
/// Errors: a message that names the file and what is wrong with it.
pub fn read() -> Result<Results, String> {
    let path = file();
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    serde_json::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))
}

/// Page text whose section of this name shows the given results.
///
/// Errors: a message that names the missing marker.
pub fn filled(page: &str, name: &str, section: &Section) -> Result<String, String> {
    let [begin, end] = [format!("<!-- performance: {name} -->\n"), format!("<!-- end of {name} -->")];
    let missing =
        |marker: &str| format!("docs/performance.md: no line {}; add the markers of {name}", marker.trim_end());
    let (before, rest) = page.split_once(&begin).ok_or_else(|| missing(&begin))?;
    let (_, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
    Ok(format!("{before}{begin}{}{end}{after}", section.markdown()))
}
