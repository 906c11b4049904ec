//! Wavefront OBJ text: vertices, faces and smoothing groups.
//!
//! A line is checked where it is read, so errors name it. An index beyond the vertices so far may name a later one; the end of the text decides.

use std::borrow::Cow;
use std::path::Path;
use std::str::{Lines, SplitWhitespace};

use glam::{DVec2, DVec3};

use super::build::{Corner, Face, Polygons, Smoothing};
use super::error::MeshError;
use super::triangles::MAX_TRIANGLES;
use roughxel_utilities::input::without_mark;
use roughxel_utilities::limits::MAX_COORDINATE;

/// Remedy for a wrong line.
const MEND: &str = "mend the line, or export the mesh again";

/// Polygons of a text.
pub(super) struct ReadObj {
    pub(super) polygons: Polygons,
    /// Line of the first face without texture coordinates, from 1.
    pub(super) without_uv: Option<usize>,
}

/// Polygons of an OBJ text; `offset` is subtracted from every vertex. Errors: [`MeshError`].
pub(super) fn polygons(path: &Path, text: &str, offset: DVec3) -> Result<ReadObj, MeshError> {
    let text = without_mark(text);
    let text =
        if text.contains('\r') && !text.contains('\n') { text.replace('\r', "\n").into() } else { Cow::Borrowed(text) };
    let mut reader = Reader { offset, ..Reader::new(path) };
    for (line, content) in (LogicalLines { lines: text.lines(), read: 0 }) {
        let mut words = content.split_whitespace();
        reader.line = line;
        match words.next() {
            Some("v") => reader.position(words)?,
            Some("vt") => reader.texcoord(words)?,
            Some("vn") => {
                let normal = reader.numbers("vn", &mut words, 3)?;
                reader.polygons.normals.push(DVec3::from_array(normal));
            }
            // `fo` is the name of a face in old files.
            Some("f" | "fo") => reader.face(words)?,
            Some("s") => reader.smoothing = smoothing(words.next()),
            _ => {}
        }
    }
    reader.finish()
}

/// State of a text that is read line by line.
struct Reader<'a> {
    path: &'a Path,
    offset: DVec3,
    /// Line that is read, from 1.
    line: usize,
    polygons: Polygons,
    smoothing: Smoothing,
    triangles: usize,
    without_uv: Option<usize>,
    /// Least and largest coordinates as they stand in the file.
    bounds: [DVec3; 2],
    /// First coordinate beyond the limit and its line.
    too_large: Option<(String, usize)>,
    /// Highest index beyond the vertices so far and its line, for `v`, `vt`, `vn`.
    ahead: [Option<(usize, usize)>; 3],
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path) -> Self {
        Self {
            path,
            offset: DVec3::ZERO,
            line: 0,
            polygons: Polygons::default(),
            smoothing: Smoothing::Whole,
            triangles: 0,
            without_uv: None,
            bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            too_large: None,
            ahead: [None; 3],
        }
    }

    fn fail(&self, message: impl Into<String>) -> MeshError {
        MeshError::in_line(self.path, self.line, message, MEND)
    }

    /// The next `N` numbers of a line, of which the first `needed` must be there; missing ones are 0.
    fn numbers<const N: usize>(
        &self,
        keyword: &str,
        words: &mut SplitWhitespace<'_>,
        needed: usize,
    ) -> Result<[f64; N], MeshError> {
        let mut numbers = [0.0f64; N];
        for (index, number) in numbers.iter_mut().enumerate() {
            let Some(word) = words.next() else {
                if index < needed {
                    return Err(self.fail(format!("`{keyword}` has {index} numbers and needs {needed}")));
                }
                break;
            };
            *number = word.parse().map_err(|_| self.fail(format!("`{word}` is not a number")))?;
            if !number.is_finite() {
                return Err(self.fail(format!("coordinate `{word}` is not finite")));
            }
        }
        Ok(numbers)
    }

    /// `v`: a position. Further numbers are a weight or a colour, which are not used.
    fn position(&mut self, mut words: SplitWhitespace<'_>) -> Result<(), MeshError> {
        let written = words.clone();
        let raw = DVec3::from_array(self.numbers("v", &mut words, 3)?);
        let position = raw - self.offset;
        self.bounds = [self.bounds[0].min(raw), self.bounds[1].max(raw)];
        if position.abs().max_element() > MAX_COORDINATE && self.too_large.is_none() {
            let place = position.abs().max_position();
            self.too_large = Some((written.clone().nth(place).unwrap_or_default().to_owned(), self.line));
        }
        self.polygons.positions.push(position);
        Ok(())
    }

    /// `vt`: u and v; v is 0 if it is missing.
    fn texcoord(&mut self, mut words: SplitWhitespace<'_>) -> Result<(), MeshError> {
        let texcoord = DVec2::from_array(self.numbers("vt", &mut words, 1)?);
        if texcoord.abs().max_element() > MAX_COORDINATE {
            return Err(self.fail(format!("texture coordinates {texcoord} are not within ±{MAX_COORDINATE:e}")));
        }
        self.polygons.texcoords.push(texcoord);
        Ok(())
    }

    /// `f`: a polygon.
    fn face(&mut self, words: SplitWhitespace<'_>) -> Result<(), MeshError> {
        let first = self.polygons.corners.len();
        for word in words {
            let corner = self.corner(word)?;
            let form = |corner: &Corner| [corner.texcoord.is_some(), corner.normal.is_some()];
            if self.polygons.corners.get(first).is_some_and(|other| form(other) != form(&corner)) {
                return Err(self.fail("the corners of one face are written in different forms"));
            }
            self.polygons.corners.push(corner);
            let triangles = self.triangles + (self.polygons.corners.len() - first).saturating_sub(2);
            if triangles > MAX_TRIANGLES {
                let what = format!("the number of triangles up to line {}", self.line);
                return Err(MeshError::too_large(self.path, &what, MAX_TRIANGLES as u64));
            }
        }
        let end = self.polygons.corners.len();
        if end - first < 3 {
            return Err(self.fail(format!("a face has {} corners and needs at least three", end - first)));
        }
        self.triangles += end - first - 2;
        if self.polygons.corners[first].texcoord.is_none() {
            self.without_uv.get_or_insert(self.line);
        }
        self.polygons.faces.push(Face { end, smoothing: self.smoothing });
        Ok(())
    }

    /// One corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&mut self, word: &str) -> Result<Corner, MeshError> {
        let seen = [self.polygons.positions.len(), self.polygons.texcoords.len(), self.polygons.normals.len()];
        let mut indices = [None; 3];
        for (kind, field) in word.split('/').enumerate() {
            if kind >= 3 || (field.is_empty() && kind == 0) {
                return Err(self.fail(format!("`{word}` is not a corner: write v, v/vt, v//vn or v/vt/vn")));
            }
            if field.is_empty() {
                continue;
            }
            let index: i64 = field.parse().map_err(|_| self.fail(format!("`{field}` in `{word}` is not an index")))?;
            let from_one = if index < 0 { (seen[kind] as i64 + 1).saturating_add(index) } else { index };
            // A file of at most 512 MiB has fewer vertices than a u32 counts.
            let (Ok(from_zero), true) = (u32::try_from(from_one - 1), from_one >= 1) else {
                return Err(self.out_of_range(kind, index, self.line));
            };
            if from_one as usize > seen[kind] && self.ahead[kind].is_none_or(|(highest, _)| from_one as usize > highest)
            {
                self.ahead[kind] = Some((from_one as usize, self.line));
            }
            indices[kind] = Some(from_zero);
        }
        let [position, texcoord, normal] = indices;
        Ok(Corner { position: position.unwrap_or_default(), texcoord, normal })
    }

    fn out_of_range(&self, kind: usize, index: i64, line: usize) -> MeshError {
        let totals = [self.polygons.positions.len(), self.polygons.texcoords.len(), self.polygons.normals.len()];
        let what = ["vertex", "texture coordinate", "normal"][kind];
        let so_far = if line == self.line { " up to this line" } else { "" };
        let message = format!("{what} {index} is out of range: the file has {}{so_far}", totals[kind]);
        MeshError::in_line(self.path, line, message, MEND)
    }

    /// Checks what only the whole text shows.
    fn finish(mut self) -> Result<ReadObj, MeshError> {
        self.line = 0;
        let totals = [self.polygons.positions.len(), self.polygons.texcoords.len(), self.polygons.normals.len()];
        for (kind, ahead) in self.ahead.into_iter().enumerate() {
            if let Some((index, line)) = ahead
                && index > totals[kind]
            {
                return Err(self.out_of_range(kind, index as i64, line));
            }
        }
        let [least, largest] = self.bounds;
        if let Some((word, line)) = &self.too_large {
            let message = format!("coordinate `{word}` is not within ±{MAX_COORDINATE:e} units");
            let middle = (((least + largest) / 2.0) / 1000.0).round() * 1000.0;
            let remedy = if (largest - least).max_element() > 2.0 * MAX_COORDINATE {
                format!("the mesh is {:e} units across: make it smaller", (largest - least).max_element())
            } else {
                format!(
                    "move the mesh to the origin by a key of the object, for example `offset = [{}, {}, {}]`",
                    middle.x, middle.y, middle.z
                )
            };
            return Err(MeshError::in_line(self.path, *line, message, remedy));
        }
        if !self.polygons.positions.is_empty() {
            self.polygons.rounding = least.abs().max(largest.abs()).max_element() * f64::EPSILON;
        }
        Ok(ReadObj { polygons: self.polygons, without_uv: self.without_uv })
    }
}

/// `s`: a number is a group, `0` and `off` are flat faces. Any other word is as no `s` line.
fn smoothing(word: Option<&str>) -> Smoothing {
    match (word, word.map(str::parse)) {
        (None | Some("off" | "0"), _) => Smoothing::Flat,
        (_, Some(Ok(0))) => Smoothing::Flat,
        (_, Some(Ok(group))) => Smoothing::Group(group),
        _ => Smoothing::Whole,
    }
}

/// Lines without comments, continued ones joined; each with the number of its first line, from 1.
struct LogicalLines<'a> {
    lines: Lines<'a>,
    read: usize,
}

impl<'a> Iterator for LogicalLines<'a> {
    type Item = (usize, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let mut content = without_comment(self.lines.next()?);
        self.read += 1;
        let first = self.read;
        if !content.trim_end().ends_with('\\') {
            return Some((first, Cow::Borrowed(content)));
        }
        let mut joined = String::new();
        while let Some(start) = content.trim_end().strip_suffix('\\') {
            joined.push_str(start);
            joined.push(' ');
            content = without_comment(self.lines.next().unwrap_or_default());
            self.read += 1;
        }
        joined.push_str(content);
        Some((first, Cow::Owned(joined)))
    }
}

/// A line up to its comment. A `\` within the comment continues nothing.
fn without_comment(line: &str) -> &str {
    line.split_once('#').map_or(line, |(content, _)| content)
}
