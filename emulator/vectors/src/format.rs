//! The tables of fields in `vectors/FORMAT.md`: a row per declared field, made of the layouts' columns.

use roughxel_core::design::Design;
use roughxel_core::plan::{Datapath, Effects, FootprintKind, FrameSystem};
use roughxel_core::precision::Precision;
use roughxel_record as record;
use thiserror::Error;

use super::columns::{Column, Kept, columns};
use super::field::Direction;

/// The line before the tables in a page.
const BEGIN: &str = "<!-- Begin of what `roughxel vectors format --write vectors/FORMAT.md` writes. -->\n";
/// The line after the tables.
const END: &str = "<!-- End of what it writes. -->\n";

/// Error of a page that has no place for the tables.
#[derive(Debug, Error)]
#[error("the page has not exactly one pair of the lines `{}` and `{}`", BEGIN.trim_end(), END.trim_end())]
pub struct FormatError;

/// The page with the tables in their place.
pub fn in_page(page: &str) -> Result<String, FormatError> {
    let (before, rest) = page.split_once(BEGIN).ok_or(FormatError)?;
    let (_, after) = rest.split_once(END).ok_or(FormatError)?;
    if [before, after].iter().any(|part| part.contains(BEGIN) || part.contains(END)) {
        return Err(FormatError);
    }
    Ok(format!("{before}{BEGIN}\n{}\n{END}{after}", tables()))
}

/// The tables of all datapaths in order, with every effect on.
pub fn tables() -> String {
    let tables = Datapath::ALL.map(|datapath| {
        let rows: String = rows(datapath).iter().map(|row| row.line() + "\n").collect();
        format!(
            "`{}`:\n\n| fields | port | direction | stage | format | unit | what |\n|---|---|---|---|---|---|---|\n{rows}",
            datapath.name()
        )
    });
    tables.join("\n")
}

/// The columns of one declared field.
struct Row {
    /// Columns; true for one that exists under every frame system.
    columns: Vec<(Column, bool)>,
    /// The kind of footprint of the first column, if only one kind has it.
    footprint: Option<&'static str>,
}

/// A port or an output of a datapath, whatever the effects.
pub(super) struct Declared {
    /// The column with every effect on; for a footprint on the sphere the columns that only it has.
    pub(super) column: Column,
    /// True if it exists under some effects.
    pub(super) exists: bool,
    /// True if it exists under every frame system.
    always: bool,
    /// The kind of footprint that has it, if only one kind has it.
    pub(super) footprint: Option<&'static str>,
}

/// Every port and every output of a datapath, in the order of its bundles.
pub(super) fn declared(datapath: Datapath) -> impl Iterator<Item = Declared> {
    // The frame system and the kind of footprint are the choices that swap columns; all other effects only add some.
    let columns_of = |effects: Effects| {
        // Formats are printed as symbols, the same under every profile.
        columns(
            &record::net(Design::for_datapath(datapath), &effects, &Precision::STANDARD),
            datapath,
            &Precision::STANDARD,
        )
    };
    let frames = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];
    let [main, natural, normalised] = frames.map(|frame| columns_of(Effects { frame, ..Effects::ALL }));
    let sphere = columns_of(Effects { footprint: FootprintKind::Sphere, ..Effects::ALL });
    let all = main.into_iter().zip(natural).zip(normalised).zip(sphere);
    all.map(|(((main, natural), normalised), sphere)| {
        let on_face = [main.exists, natural.exists, normalised.exists];
        let exists = on_face.contains(&true) || sphere.exists;
        let always = on_face == [main.exists; 3];
        // The sphere's design has the main direction.
        let (column, footprint) = match (main.exists, sphere.exists) {
            (true, false) => (main, Some("not with `footprint-sphere`")),
            (false, true) => (sphere, Some("only with `footprint-sphere`")),
            _ => (main, None),
        };
        Declared { column, exists, always, footprint }
    })
}

/// The declared fields of a datapath, in the order of the word.
fn rows(datapath: Datapath) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for Declared { column, always, footprint, .. } in declared(datapath).filter(|declared| declared.exists) {
        match rows.last_mut() {
            Some(row) if row.first().declared == column.declared => row.columns.push((column, always)),
            _ => rows.push(Row { columns: vec![(column, always)], footprint }),
        }
    }
    rows
}

impl Row {
    fn first(&self) -> &Column {
        &self.columns[0].0
    }

    fn line(&self) -> String {
        let first = self.first();
        let direction = match first.field.direction {
            Direction::In => "in",
            Direction::Tap => "tap",
            Direction::Out => "out",
            Direction::Check => "check",
        };
        let stage = &first.field.stage;
        let [unit, text] = [&first.field.unit, &first.text].map(|text| text.replace('|', "\\|"));
        let (names, format) = (self.names(), self.format());
        let (declared, footprint) =
            (&first.declared, self.footprint.map_or_else(String::new, |footprint| format!("; {footprint}")));
        format!("| {names} | `{declared}` | {direction} | {stage} | {format} | {unit} | {text}{footprint} |")
    }

    /// The names of the columns. Of names that differ in the last part alone the first is whole. Columns that do not exist under
    /// every frame system are in brackets.
    fn names(&self) -> String {
        let mut runs: Vec<(Vec<&str>, bool)> = Vec::new();
        let mut stem = "";
        for (column, always) in &self.columns {
            let name = column.field.name.as_str();
            let cut = name.rfind('_').unwrap_or(name.len());
            let follows = name[..cut] == *stem && cut < name.len();
            stem = &name[..cut];
            match runs.last_mut() {
                Some((parts, before)) if follows && before == always => parts.push(&name[cut..]),
                _ => runs.push((vec![if follows { &name[cut..] } else { name }], *always)),
            }
        }
        let mut names = String::new();
        for (parts, always) in runs {
            let whole = !parts[0].starts_with('_');
            names += if names.is_empty() {
                ""
            } else if whole {
                ", "
            } else {
                " "
            };
            let parts = parts.join(" ");
            names += &if always { format!("`{parts}`") } else { format!("(`{parts}`)") };
        }
        names
    }

    /// The formats of the columns, each once; the format of an exponent by its name.
    fn format(&self) -> String {
        let mut formats: Vec<String> = Vec::new();
        for (column, _) in &self.columns {
            let format = number_format(column);
            let format = if column.field.name.ends_with("_e") { format!("e {format}") } else { format };
            if !formats.contains(&format) {
                formats.push(format);
            }
        }
        formats.join(", ")
    }
}

/// The format of a column, with the knobs of a profile as symbols.
pub(super) fn number_format(column: &Column) -> String {
    let field = &column.field;
    let letter = if field.signed { 'I' } else { 'U' };
    let fraction = if column.kept == Kept::All(0) { String::new() } else { format!("F{}", column.kept) };
    format!("{letter}{}{fraction}", field.width - field.fraction_bits)
}
