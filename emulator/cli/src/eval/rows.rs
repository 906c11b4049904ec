//! `eval`: fragments in real numbers through the integer datapath, CSV in, CSV or JSON out.
//!
//! Each row is quantised to the profile's ports and goes through the datapath. The result is in real units with block exponents applied, or
//! in the integers of the ports. Rows are read, evaluated in parallel chunks and written in order, so memory does not grow with the file.
//!
//! A row of numbers is a line. Cells are split at commas here, because messages must name the right line: the line numbers of the csv crate
//! drift after blank lines and CR LF.

use std::fmt::Write as _;
use std::io::{self, BufRead, Read, Write};

use fixed::types::{I2F30, I4F28};
use glam::dvec3;
use rayon::prelude::*;
use roughxel_core::plan::{Datapath, ReflectionPlan};
use roughxel_core::ports::{BlockNumber, BlockVector, ReflectionIn, ReflectionOut, SurfaceIn};
use roughxel_core::precision::Precision;
use roughxel_core::setup::{block_vector, offset, scale_by_power_of_two};
use roughxel_core::status::StatusBit;
use thiserror::Error;

/// Columns of the input. The first [`REQUIRED`] are required.
pub(crate) const INPUT_COLUMNS: [&str; 27] = [
    "nx", "ny", "nz", "vx", "vy", "vz", // n, v
    "hx", "hy", "hz", // h
    "b1", "b2", "d1", "d2", "d3", // bump offset, roughness
    "dv_dx_x", "dv_dx_y", "dv_dx_z", "dv_dy_x", "dv_dy_y", "dv_dy_z", // per pixel
    "dn_dx_x", "dn_dx_y", "dn_dx_z", "dn_dy_x", "dn_dy_y", "dn_dy_z", // per pixel
    "size",
];

/// Number of [`INPUT_COLUMNS`] that are required.
pub(crate) const REQUIRED: usize = 6;

const MAIN_DIRECTION: std::ops::Range<usize> = 6..9;
const OFFSETS: std::ops::Range<usize> = 9..14;
const SIZE: usize = 26;

/// Rows read at once.
const BATCH: usize = 1 << 14;
/// Rows of one parallel task.
const TASK: usize = 1 << 8;
/// Most characters of a line.
const MAX_LINE: u64 = 1 << 16;

/// Options of `eval`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EvalOptions {
    /// Profile.
    pub(crate) precision: Precision,
    /// Effects that are on.
    pub(crate) plan: ReflectionPlan,
    /// True for the integers of the ports instead of real units.
    pub(crate) raw: bool,
    /// True for a JSON array with one object per line instead of CSV.
    pub(crate) json: bool,
}

/// Error in an input. Every message names the source and the line.
#[derive(Debug, Error)]
pub(crate) enum EvalError {
    /// The input has no header row.
    #[error("{source_name}: empty; the first line names the columns, at least nx, ny, nz, vx, vy, vz")]
    Empty {
        /// The input.
        source_name: String,
    },
    /// A required column is missing.
    #[error("{source_name}:{line}: missing column{}: {}", if .columns.len() == 1 { "" } else { "s" }, .columns.join(", "))]
    MissingColumns {
        /// The input.
        source_name: String,
        /// Line of the header.
        line: u64,
        /// Missing names.
        columns: Vec<&'static str>,
    },
    /// The header has an unknown column.
    #[error("{source_name}:{line}: unknown column `{column}`; known are {}", INPUT_COLUMNS.join(", "))]
    UnknownColumn {
        /// The input.
        source_name: String,
        /// Line of the header.
        line: u64,
        /// Its name.
        column: String,
    },
    /// The header names a column twice.
    #[error("{source_name}:{line}: column `{column}` is there twice")]
    DuplicateColumn {
        /// The input.
        source_name: String,
        /// Line of the header.
        line: u64,
        /// Its name.
        column: &'static str,
    },
    /// A row has more or fewer values than the header.
    #[error("{source_name}:{line}: {found} values, but the header names {expected} columns")]
    RowLength {
        /// The input.
        source_name: String,
        /// Line of the row.
        line: u64,
        /// Values in the row.
        found: usize,
        /// Columns of the header.
        expected: usize,
    },
    /// A value cannot be used.
    #[error("{source_name}:{line}: column `{column}`: `{value}` {problem}")]
    Value {
        /// The input.
        source_name: String,
        /// Line of the row.
        line: u64,
        /// Column.
        column: &'static str,
        /// Text of the value.
        value: String,
        /// Problem and remedy.
        problem: &'static str,
    },
    /// A line is too long for a row of numbers.
    #[error("{source_name}:{line}: longer than {MAX_LINE} characters")]
    LineLength {
        /// The input.
        source_name: String,
        /// Number of the line.
        line: u64,
    },
    /// The input cannot be read.
    #[error("cannot read {source_name}")]
    Read {
        /// The input.
        source_name: String,
        /// Cause.
        source: io::Error,
    },
    /// The output cannot be written.
    #[error("cannot write the result")]
    Write(#[source] io::Error),
}

/// Evaluates every row of `input` into `output` and returns how many there were.
///
/// `source_name` names the input in messages. Output columns have fixed names and order, see [`visit`].
///
/// Errors: see [`EvalError`]. Rows before the faulty row may have been written.
pub(crate) fn evaluate(
    input: impl Read,
    source_name: &str,
    output: &mut impl Write,
    options: &EvalOptions,
) -> Result<u64, EvalError> {
    let mut lines = Lines { input: io::BufReader::with_capacity(1 << 16, input), source_name, number: 0 };
    let header_row = lines.next_row()?.ok_or_else(|| EvalError::Empty { source_name: source_name.into() })?;
    let columns = Columns::of_header(&header_row, source_name)?;
    let opening = if options.json { "[".into() } else { header(options) };
    output.write_all(opening.as_bytes()).map_err(EvalError::Write)?;

    let mut rows = 0_u64;
    let mut batch = Vec::with_capacity(BATCH);
    loop {
        batch.clear();
        while batch.len() < BATCH
            && let Some(row) = lines.next_row()?
        {
            batch.push(row);
        }
        if batch.is_empty() {
            break;
        }
        let texts: Vec<_> =
            batch.par_chunks(TASK).map(|rows| evaluate_rows(rows, &columns, source_name, options)).collect();
        for (task, text) in texts.into_iter().enumerate() {
            let text = text?;
            // Each object begins with the comma that separates it from the previous object.
            let first = options.json && rows == 0 && task == 0;
            output.write_all(&text.as_bytes()[usize::from(first)..]).map_err(EvalError::Write)?;
        }
        rows += batch.len() as u64;
    }
    let closing = if options.json { "\n]\n" } else { "" };
    output.write_all(closing.as_bytes()).and_then(|()| output.flush()).map_err(EvalError::Write)?;
    Ok(rows)
}

/// A row of text.
struct Row {
    line: u64,
    text: Vec<u8>,
}

impl Row {
    /// Cells without surrounding white space and without one pair of quotes.
    fn cells(&self) -> impl Iterator<Item = &[u8]> {
        self.text.split(|&c| c == b',').map(|cell| {
            let cell = cell.trim_ascii();
            cell.strip_prefix(b"\"").and_then(|inner| inner.strip_suffix(b"\"")).map_or(cell, <[u8]>::trim_ascii)
        })
    }
}

/// Reader of rows that counts lines.
struct Lines<'a, R> {
    input: R,
    source_name: &'a str,
    number: u64,
}

impl<R: BufRead> Lines<'_, R> {
    /// Reads the next row. Blank lines, comments and a leading byte order mark are skipped.
    fn next_row(&mut self) -> Result<Option<Row>, EvalError> {
        loop {
            let mut text = Vec::new();
            let source_name = || self.source_name.to_string();
            let read = self.input.by_ref().take(MAX_LINE + 1).read_until(b'\n', &mut text);
            let read = read.map_err(|source| EvalError::Read { source_name: source_name(), source })?;
            if read == 0 {
                return Ok(None);
            }
            self.number += 1;
            if read as u64 > MAX_LINE {
                return Err(EvalError::LineLength { source_name: source_name(), line: self.number });
            }
            if self.number == 1 && text.starts_with(b"\xef\xbb\xbf") {
                text.drain(..3);
            }
            if !matches!(text.trim_ascii_start(), [] | [b'#', ..]) {
                return Ok(Some(Row { line: self.number, text }));
            }
        }
    }
}

/// Columns of a header: the index into [`INPUT_COLUMNS`] for each place.
struct Columns {
    of_place: Vec<usize>,
    defaults: [f64; INPUT_COLUMNS.len()],
}

impl Columns {
    fn of_header(header: &Row, source_name: &str) -> Result<Self, EvalError> {
        let line = header.line;
        let source = || source_name.to_string();
        let mut of_place = Vec::with_capacity(INPUT_COLUMNS.len());
        for name in header.cells() {
            let Some(column) = INPUT_COLUMNS.iter().position(|known| known.as_bytes() == name) else {
                let column = shown(name);
                return Err(EvalError::UnknownColumn { source_name: source(), line, column });
            };
            if of_place.contains(&column) {
                let column = INPUT_COLUMNS[column];
                return Err(EvalError::DuplicateColumn { source_name: source(), line, column });
            }
            of_place.push(column);
        }
        let missing = (0..REQUIRED).filter(|column| !of_place.contains(column));
        let columns: Vec<_> = missing.map(|column| INPUT_COLUMNS[column]).collect();
        if !columns.is_empty() {
            return Err(EvalError::MissingColumns { source_name: source(), line, columns });
        }
        let mut defaults = [0.0; INPUT_COLUMNS.len()];
        defaults[SIZE] = 256.0;
        if !MAIN_DIRECTION.into_iter().any(|column| of_place.contains(&column)) {
            defaults[MAIN_DIRECTION].copy_from_slice(&[0.0, 1.0, 0.0]);
        }
        Ok(Self { of_place, defaults })
    }

    /// Reads the numbers of a row in the order of [`INPUT_COLUMNS`].
    fn values(&self, row: &Row, source_name: &str) -> Result<[f64; INPUT_COLUMNS.len()], EvalError> {
        let line = row.line;
        let source = || source_name.to_string();
        let (found, expected) = (row.cells().count(), self.of_place.len());
        if found != expected {
            return Err(EvalError::RowLength { source_name: source(), line, found, expected });
        }
        let mut values = self.defaults;
        for (cell, &column) in row.cells().zip(&self.of_place) {
            values[column] = number(cell, column).map_err(|problem| EvalError::Value {
                source_name: source(),
                line,
                column: INPUT_COLUMNS[column],
                value: shown(cell),
                problem,
            })?;
        }
        Ok(values)
    }
}

/// Makes text for a message from any bytes: at most 40 characters.
fn shown(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).chars().take(40).collect()
}

/// Parses the number in a cell of a column. The error says what is wrong.
fn number(cell: &[u8], column: usize) -> Result<f64, &'static str> {
    let text = std::str::from_utf8(cell).map_err(|_| "is not a number")?;
    let x: f64 = text.parse().map_err(|_| "is not a number")?;
    if !x.is_finite() {
        return Err("is not a finite number");
    }
    if OFFSETS.contains(&column) && !(-8.0..8.0).contains(&x) {
        return Err("is out of range: offsets and roughness are from -8 to below 8");
    }
    if column == SIZE && !(x.fract() == 0.0 && (1.0..=16384.0).contains(&x)) {
        return Err("is no face edge: a whole number of texels from 1 to 16384");
    }
    Ok(x)
}

/// Makes the ports of a row of numbers in the order of [`INPUT_COLUMNS`].
pub(crate) fn fragment(values: &[f64; INPUT_COLUMNS.len()], p: &Precision) -> ReflectionIn {
    let vector = |first: usize| block_vector(dvec3(values[first], values[first + 1], values[first + 2]), p);
    ReflectionIn {
        surface: SurfaceIn {
            normal: vector(0),
            view: vector(3),
            frame_vectors: [vector(6), BlockVector::default()],
            offset: [9, 10].map(|i| offset(values[i], p)),
            roughness: [11, 12, 13].map(|i| offset(values[i], p)),
        },
        dview: [vector(14), vector(17)],
        dnormal: [vector(20), vector(23)],
        edge_texels: values[SIZE] as u16,
    }
}

fn evaluate_rows(
    rows: &[Row],
    columns: &Columns,
    source_name: &str,
    options: &EvalOptions,
) -> Result<String, EvalError> {
    let mut text = String::with_capacity(rows.len() * 2048);
    for row in rows {
        let input = fragment(&columns.values(row, source_name)?, &options.precision);
        let output = input.reflect(&options.plan, &options.precision);
        if options.json {
            write_json(&mut text, &input, &output, options);
        } else {
            write_csv(&mut text, &input, &output, options);
        }
    }
    Ok(text)
}

/// Number of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Value {
    /// Integer of a port, a count, or the word of status bits.
    Integer(i32),
    /// Value in real units.
    Real(f64),
}

/// Calls `sink` with name and value of every column of the result, in order.
///
/// With `raw`, values are the integers of the ports: mantissas in units of 2^−30, offsets and steps of 2^−28, the level of detail of 2^−16.
/// After each block comes a column `NAME_e` with its exponent.
pub(crate) fn visit(input: &ReflectionIn, output: &ReflectionOut, raw: bool, sink: impl FnMut(&'static str, Value)) {
    let mut to = Visitor { raw, sink };
    let i = input;
    to.vector(["q_nx", "q_ny", "q_nz", "q_n_e"], &i.surface.normal);
    to.vector(["q_vx", "q_vy", "q_vz", "q_v_e"], &i.surface.view);
    to.vector(["q_hx", "q_hy", "q_hz", "q_h_e"], &i.surface.frame_vectors[0]);
    to.offsets(["q_b1", "q_b2"], i.surface.offset);
    to.offsets(["q_d1", "q_d2", "q_d3"], i.surface.roughness);
    to.vector(["q_dv_dx_x", "q_dv_dx_y", "q_dv_dx_z", "q_dv_dx_e"], &i.dview[0]);
    to.vector(["q_dv_dy_x", "q_dv_dy_y", "q_dv_dy_z", "q_dv_dy_e"], &i.dview[1]);
    to.vector(["q_dn_dx_x", "q_dn_dx_y", "q_dn_dx_z", "q_dn_dx_e"], &i.dnormal[0]);
    to.vector(["q_dn_dy_x", "q_dn_dy_y", "q_dn_dy_z", "q_dn_dy_e"], &i.dnormal[1]);

    let o = output;
    to.vector(["e1_x", "e1_y", "e1_z", "e1_e"], &o.frame[0]);
    to.vector(["e2_x", "e2_y", "e2_z", "e2_e"], &o.frame[1]);
    to.vector(["nmod_x", "nmod_y", "nmod_z", "nmod_e"], &o.normal_mod);
    to.vector(["r_x", "r_y", "r_z", "r_e"], &o.reflected);
    to.count("face", o.face.into());
    to.mantissas(["s", "t"], o.st, 0);
    to.vector(["k_a", "k_b", "k_c", "k_e"], &o.covariance);
    to.number(["lambda1", "lambda1_e"], &o.major);
    to.number(["lambda2", "lambda2_e"], &o.minor);
    to.mantissas(["dir_s", "dir_t"], o.direction, 0);
    to.count("probes", o.probes.into());
    to.offsets(["step_s", "step_t"], o.step);
    to.scaled("lod", o.lod.to_bits(), -16);
    to.count("status", o.status.cast_signed());
}

struct Visitor<F> {
    raw: bool,
    sink: F,
}

impl<F: FnMut(&'static str, Value)> Visitor<F> {
    fn count(&mut self, name: &'static str, count: i32) {
        (self.sink)(name, Value::Integer(count));
    }

    /// Passes on `bits · 2^exponent`.
    fn scaled(&mut self, name: &'static str, bits: i32, exponent: i32) {
        let real = || Value::Real(scale_by_power_of_two(f64::from(bits), exponent));
        (self.sink)(name, if self.raw { Value::Integer(bits) } else { real() });
    }

    fn mantissas<const N: usize>(&mut self, names: [&'static str; N], mantissas: [I2F30; N], exponent: i16) {
        for (name, mantissa) in names.into_iter().zip(mantissas) {
            self.scaled(name, mantissa.to_bits(), i32::from(exponent) - 30);
        }
    }

    fn offsets<const N: usize>(&mut self, names: [&'static str; N], offsets: [I4F28; N]) {
        for (name, offset) in names.into_iter().zip(offsets) {
            self.scaled(name, offset.to_bits(), -28);
        }
    }

    fn exponent(&mut self, name: &'static str, exponent: i16) {
        if self.raw {
            self.count(name, exponent.into());
        }
    }

    fn vector(&mut self, [x, y, z, e]: [&'static str; 4], vector: &BlockVector) {
        self.mantissas([x, y, z], vector.mantissa, vector.exponent);
        self.exponent(e, vector.exponent);
    }

    fn number(&mut self, [m, e]: [&'static str; 2], number: &BlockNumber) {
        self.mantissas([m], number.mantissa, number.exponent);
        self.exponent(e, number.exponent);
    }
}

/// Makes the header line of the CSV result.
fn header(options: &EvalOptions) -> String {
    let mut line = String::new();
    visit(&ReflectionIn::default(), &ReflectionOut::default(), options.raw, |name, _| {
        line.push_str(if line.is_empty() { "" } else { "," });
        line.push_str(name);
    });
    line.push('\n');
    line
}

fn write_csv(text: &mut String, input: &ReflectionIn, output: &ReflectionOut, options: &EvalOptions) {
    let start = text.len();
    visit(input, output, options.raw, |_, value| {
        text.push_str(if text.len() == start { "" } else { "," });
        write_value(text, value, "");
    });
    text.push('\n');
}

fn write_json(text: &mut String, input: &ReflectionIn, output: &ReflectionOut, options: &EvalOptions) {
    text.push_str(",\n{");
    visit(input, output, options.raw, |name, value| {
        text.push('"');
        text.push_str(name);
        text.push_str("\":");
        write_value(text, value, "null");
        text.push(',');
    });
    let raised = StatusBit::raised_by(Datapath::Reflection).filter(|bit| output.status & bit.mask() != 0);
    let names: Vec<_> = raised.map(|bit| format!("\"{}\"", bit.name())).collect();
    // Writing to a string cannot fail.
    let _ = write!(text, "\"status_names\":[{}]}}", names.join(","));
}

/// Writes a value. A real number has 17 significant digits, so that it reads back as the same double.
///
/// A result beyond the range of a double (|r| grows with |n|²·|v|) is infinite. It is written as `beyond`, unless `beyond` is empty.
fn write_value(text: &mut String, value: Value, beyond: &str) {
    let _ = match value {
        Value::Integer(x) => write!(text, "{x}"),
        Value::Real(x) if !x.is_finite() && !beyond.is_empty() => write!(text, "{beyond}"),
        Value::Real(x) => write!(text, "{x:.16e}"),
    };
}
