//! Layout of a plot without its data.

use plotters::style::text_anchor::HPos;

use super::data::{Mark, Plot};
use super::ink::Ink;
use super::label::Area;
use super::text;

/// Pixels of an em, of a line of text, of a marker's radius, of the legend's sample.
pub(super) const EM: f64 = 13.0;
pub(super) const LINE: f64 = 17.0;
pub(super) const RADIUS: f64 = 4.0;
pub(super) const SAMPLE: f64 = 24.0;

pub(super) fn pixels(text: &str) -> f64 {
    text::width(text) * EM
}

/// A mark, with the anchor of its label at the label's top.
pub(super) struct PlacedMark {
    pub(super) x: f64,
    pub(super) text: String,
    pub(super) at: [f64; 2],
    pub(super) anchor: HPos,
}

/// Places of everything except the data, in pixels.
pub(super) struct Layout {
    pub(super) size: [f64; 2],
    /// True for a plot on its own paper with title and description.
    pub(super) is_alone: bool,
    /// Area inside the axes.
    pub(super) inner: Area,
    pub(super) ranges: [[f64; 2]; 2],
    pub(super) ticks: [Vec<(f64, String)>; 2],
    /// Title and labels of the axes; the anchor is at their top.
    pub(super) lines: Vec<(String, Ink, [f64; 2], HPos)>,
    /// Series, name and upper left corner of each entry.
    pub(super) legend: Vec<(usize, String, [f64; 2])>,
    pub(super) marks: Vec<PlacedMark>,
}

impl Layout {
    /// Layout from top to bottom: title, legend, the y axis' label with those of marks, data, ticks, the x axis' label,
    /// description.
    pub(super) fn new(plot: &Plot, size: [f64; 2], is_alone: bool) -> Self {
        let [width, height] = size;
        let edge = if is_alone { 8.0 } else { 2.0 };
        let places = plot.series.iter().flat_map(|series| &series.points).filter_map(|point| plot.place(point));
        let marked = plot.marks.iter().filter_map(|mark| plot.x.scale.place(mark.x));
        let x_range = plot.x.scale.range(places.clone().map(|[x, _]| x).chain(marked));
        let y_range = plot.y.scale.range(places.map(|[_, y]| y));
        let y_ticks = plot.y.scale.ticks(y_range, (height / 34.0) as usize);
        let left = edge + y_ticks.iter().fold(0.0, |most: f64, (_, label)| most.max(pixels(label))) + 6.0;
        let mut x_count = ((width - left) / 44.0) as usize;
        let mut x_ticks = plot.x.scale.ticks(x_range, x_count);
        // Long labels leave room for fewer ticks; ticks at 2 and 5 times powers are not evenly spaced.
        let per_place = (width - left - 2.0 * EM) / (x_range[1] - x_range[0]);
        let touch = |pair: &[(f64, String)]| {
            let room = (pixels(&pair[0].1) + pixels(&pair[1].1)) / 2.0 + 8.0;
            (pair[1].0 - pair[0].0) * per_place < room
        };
        while x_count > 4 && x_ticks.windows(2).any(touch) {
            x_count -= 1;
            x_ticks = plot.x.scale.ticks(x_range, x_count);
        }
        let left = left.max(edge + x_ticks.first().map_or(0.0, |(_, label)| pixels(label) / 2.0));
        let last = x_ticks.last().map_or(0.0, |(_, label)| pixels(label) / 2.0);
        let right = width - edge - last.max(6.0);
        let mut layout = Self {
            size,
            is_alone,
            inner: Area { left, top: edge, right, bottom: height },
            ranges: [x_range, y_range],
            ticks: [x_ticks, y_ticks],
            lines: Vec::new(),
            legend: Vec::new(),
            marks: Vec::new(),
        };
        let most = (width - 2.0 * edge) / EM;
        if is_alone {
            // Bold text is a tenth wider.
            layout.add_lines(&text::wrap(&plot.title, most / 1.1), Ink::Bold, [edge, edge], HPos::Left);
            layout.inner.top += LINE * layout.lines.len() as f64 + 4.0;
        }
        layout.add_legend(plot, edge);
        let label = text::wrap(&plot.y.label, most);
        layout.add_marks(plot, edge, &label);
        if is_alone {
            let description = text::wrap(&plot.description, most);
            layout.inner.bottom -= LINE * description.len() as f64 + 4.0;
            layout.add_lines(&description, Ink::Text, [edge, layout.inner.bottom - 4.0], HPos::Left);
        }
        let label = text::wrap(&plot.x.label, most);
        layout.inner.bottom -= edge + LINE * (1 + label.len()) as f64 + 8.0;
        let at = [layout.inner.right, layout.inner.bottom + LINE + 6.0];
        layout.add_lines(&label, Ink::Text, at, HPos::Right);
        layout
    }

    pub(super) fn width(&self) -> f64 {
        self.inner.right - self.inner.left
    }

    /// Pixels of a place on the axes.
    pub(super) fn at(&self, place: [f64; 2]) -> [f64; 2] {
        let [x, y] =
            [0, 1].map(|axis| (place[axis] - self.ranges[axis][0]) / (self.ranges[axis][1] - self.ranges[axis][0]));
        let area = &self.inner;
        [area.left + x * (area.right - area.left), area.bottom - y * (area.bottom - area.top)]
    }

    fn add_lines(&mut self, lines: &[String], ink: Ink, [x, y]: [f64; 2], anchor: HPos) {
        let placed =
            lines.iter().enumerate().map(|(row, line)| (line.clone(), ink, [x, y + LINE * row as f64], anchor));
        self.lines.extend(placed);
    }

    fn add_legend(&mut self, plot: &Plot, edge: f64) {
        let most = self.size[0] - 2.0 * edge;
        let mut x = edge;
        for (index, series) in plot.series.iter().enumerate().filter(|(_, series)| !series.name.trim().is_empty()) {
            let text = text::fit(&series.name, (most - SAMPLE - 5.0) / EM);
            let width = SAMPLE + 5.0 + pixels(&text);
            if x > edge && x + width > edge + most {
                x = edge;
                self.inner.top += LINE + 1.0;
            }
            self.legend.push((index, text, [x, self.inner.top]));
            x += width + 12.0;
        }
        self.inner.top += if self.legend.is_empty() { 0.0 } else { LINE + 7.0 };
    }

    /// Places labels of marks above the data, right of their lines if there is room, in as few rows as hold them. The y axis' label
    /// shares the lowest rows. Labels are placed from the last mark on, so that lines pass left of the labels below, not through them.
    fn add_marks(&mut self, plot: &Plot, edge: f64, axis_label: &[String]) {
        let most = self.size[0] - edge;
        // Occupied parts of the rows, from the lowest up.
        let mut rows: Vec<Vec<[f64; 2]>> =
            axis_label.iter().rev().map(|line| vec![[edge, edge + pixels(line) + 8.0]]).collect();
        let mut marks: Vec<([f64; 2], &Mark)> =
            plot.marks.iter().filter_map(|mark| Some((self.at([plot.x.scale.place(mark.x)?, 0.0]), mark))).collect();
        marks.sort_by(|(a, _), (b, _)| b[0].total_cmp(&a[0]));
        let mut placed = Vec::new();
        for ([x, _], mark) in marks {
            let text = text::fit(&mark.label, (most - edge) / EM);
            let width = pixels(&text) + 4.0;
            // The width is an estimate, so the text is anchored at the line.
            let (left, at, anchor) = if x + width <= most {
                (x, x + 4.0, HPos::Left)
            } else if x - width >= edge {
                (x - width, x - 4.0, HPos::Right)
            } else {
                (edge, edge, HPos::Left)
            };
            let is_free = |row: &Vec<[f64; 2]>| row.iter().all(|[from, to]| left + width < *from || *to < left);
            let row = rows.iter().position(is_free).unwrap_or(rows.len());
            if row == rows.len() {
                rows.push(Vec::new());
            }
            rows[row].push([left - 8.0, left + width + 8.0]);
            placed.push((row, PlacedMark { x, text, at: [at, 0.0], anchor }));
        }
        let bottom = self.inner.top + LINE * rows.len() as f64;
        let first = bottom - LINE * axis_label.len() as f64;
        self.add_lines(axis_label, Ink::Text, [edge, first], HPos::Left);
        self.marks = placed
            .into_iter()
            .map(|(row, mark)| PlacedMark { at: [mark.at[0], bottom - LINE * (row + 1) as f64], ..mark })
            .collect();
        self.inner.top = bottom + 5.0;
    }
}
