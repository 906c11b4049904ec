//! Plots as SVG: values over an axis, readable without colours, in the dark, small, or as a table.

mod axis;
mod data;
mod ink;
mod label;
mod layout;
mod text;

use std::fmt::Write as _;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use axis::Scale;
pub use data::{Axis, Mark, Plot, Point, Series, Style};
use ink::Ink;
use label::{Area, Wanted};
use layout::{EM, LINE, Layout, RADIUS, SAMPLE, pixels};

use crate::html::{Page, Text as Escaped};

/// Drawing units in a pixel: the crate rounds to whole units.
const UNITS: i32 = 10;

/// Pixels of a plot on a page: the width, and the height inside the axes.
const PAGE_WIDTH: u32 = 420;
const PAGE_INNER_HEIGHT: f64 = 230.0;

/// Text size as the crate counts it: it writes 1/1.24 of it.
const TEXT_SIZE: f64 = EM * UNITS as f64 * 1.24;

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

fn units(pixels: f64) -> i32 {
    (pixels * f64::from(UNITS)).round() as i32
}

fn units_at([x, y]: [f64; 2]) -> (i32, i32) {
    (units(x), units(y))
}

impl Plot {
    /// The plot as a file of `size` (width and height in pixels) with its own paper, its title and its description.
    ///
    /// Below about 300 × 200 there is little room for data; no length is above 10000.
    pub fn svg(&self, size: [u32; 2]) -> String {
        let name: String = self.title.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
        let layout = Layout::new(self, size.map(|length| f64::from(length.min(10_000))), true);
        self.drawn(&layout, &format!("plot-{}", name.to_ascii_lowercase()))
    }

    /// The whole element; `id` begins its ids.
    fn drawn(&self, layout: &Layout, id: &str) -> String {
        let [width, height] = layout.size.map(|length| length as u32);
        let mut drawing = String::new();
        {
            let units = UNITS as u32;
            let canvas = SVGBackend::with_string(&mut drawing, (width * units, height * units)).into_drawing_area();
            // Writing to a string cannot fail.
            let _ = self.draw(&canvas, layout);
        }
        let (_, content) = drawing.split_once('\n').unwrap_or_default();
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"roughxel-plot\" role=\"img\" aria-labelledby=\"{id}-title {id}-desc\" \
             width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {} {}\">\n<title id=\"{id}-title\">{}</title>\n\
             <desc id=\"{id}-desc\">{}</desc>\n<style>{}</style>\n",
            width * UNITS as u32,
            height * UNITS as u32,
            Escaped(&text::clean(&self.title)),
            Escaped(&text::clean(&self.alternative())),
            ink::style(UNITS),
        );
        if layout.is_alone {
            svg.push_str("<rect class=\"paper\" width=\"100%\" height=\"100%\" fill=\"currentColor\"/>\n");
        }
        // The style sets face and size of all text; white space around it would be part of it.
        let size = format!(" font-family=\"sans-serif\" font-size=\"{}\"", TEXT_SIZE / 1.24);
        let mut is_text = false;
        for line in ink::recoloured(content).lines() {
            let begins_text = line.starts_with("<text");
            let end = if begins_text || is_text { "" } else { "\n" };
            let _ = write!(svg, "{}{end}", line.replace(&size, "").replace(" opacity=\"1\"", ""));
            is_text = begins_text;
            if line == "</text>" {
                svg.push('\n');
            }
        }
        svg
    }

    /// The description, followed by the labels of the marks.
    fn alternative(&self) -> String {
        let mut text = self.description.clone();
        for mark in &self.marks {
            let _ = write!(text, " Vertical line at {}: {}.", self.x.scale.numbers([mark.x])(mark.x), mark.label);
        }
        text
    }

    fn draw(&self, canvas: &Canvas<'_>, layout: &Layout) -> Drawn {
        self.draw_frame(canvas, layout)?;
        self.draw_legend(canvas, layout)?;
        let runs: Vec<Vec<Vec<[f64; 2]>>> = self.series.iter().map(|series| self.runs(series)).collect();
        let area = &layout.inner;
        let [x, y] = layout.ranges;
        let mut chart = ChartBuilder::on(canvas)
            .margin_left(units(area.left))
            .margin_top(units(area.top))
            .margin_right(units(layout.size[0] - area.right))
            .margin_bottom(units(layout.size[1] - area.bottom))
            .build_cartesian_2d(x[0]..x[1], y[0]..y[1])?;
        for (index, (series, runs)) in self.series.iter().zip(&runs).enumerate() {
            let style = line_ink(series, index).code().stroke_width(units(1.75) as u32);
            for run in runs.iter().filter(|run| series.style != Style::Points && run.len() > 1) {
                chart.draw_series(LineSeries::new(run.iter().map(|[x, y]| (*x, *y)), style))?;
            }
        }
        self.draw_labels(canvas, layout, &runs)?;
        // Data are drawn over labels, so that no label hides data, and over context.
        let (context, data): (Vec<usize>, Vec<usize>) = (0..runs.len()).partition(|index| self.series[*index].muted);
        for (index, runs) in context.into_iter().chain(data).map(|index| (index, &runs[index])) {
            for point in self.marked(index, runs) {
                draw_marker(canvas, &self.series[index], index, layout.at(point))?;
            }
        }
        if runs.iter().all(Vec::is_empty) {
            let middle = [(area.left + area.right) / 2.0, (area.top + area.bottom) / 2.0];
            write(canvas, "no data", Ink::Soft, middle, HPos::Center, VPos::Center)?;
        }
        Ok(())
    }

    /// Places of a series that get a marker: all, or a few of a line, at different places than those of the next line. Points
    /// without a joining line always get one.
    fn marked(&self, index: usize, runs: &[Vec<[f64; 2]>]) -> Vec<[f64; 2]> {
        let is_line = self.series[index].style == Style::Line;
        let all = runs.iter().flatten().copied();
        if !is_line {
            return all.collect();
        }
        let step = (runs.iter().map(Vec::len).sum::<usize>() / 5).max(1);
        let first = step * index / self.series.len();
        let several = self.series.len() > 1 && !self.series[index].muted;
        let lonely = runs.iter().filter(|run| run.len() == 1).flatten().copied();
        let few = all.skip(first).step_by(step).filter(|_| several);
        few.chain(lonely).collect()
    }

    /// Axes with their labels, grid and marks.
    fn draw_frame(&self, canvas: &Canvas<'_>, layout: &Layout) -> Drawn {
        let area = &layout.inner;
        let [grid, axis] = [Ink::Grid, Ink::Soft].map(|ink| ink.code().stroke_width(units(1.0) as u32));
        let line = |from: [f64; 2], to: [f64; 2], style| PathElement::new([units_at(from), units_at(to)], style);
        for (place, label) in &layout.ticks[0] {
            let x = layout.at([*place, layout.ranges[1][0]])[0];
            canvas.draw(&line([x, area.top], [x, area.bottom], grid))?;
            write(canvas, label, Ink::Soft, [x, area.bottom + 5.0], HPos::Center, VPos::Top)?;
        }
        for (place, label) in &layout.ticks[1] {
            let y = layout.at([layout.ranges[0][0], *place])[1];
            canvas.draw(&line([area.left, y], [area.right, y], grid))?;
            write(canvas, label, Ink::Soft, [area.left - 6.0, y], HPos::Right, VPos::Center)?;
        }
        canvas.draw(&line([area.left, area.bottom], [area.right, area.bottom], axis))?;
        let marked = Ink::SoftDashed.code().stroke_width(units(1.5) as u32);
        for mark in &layout.marks {
            canvas.draw(&line([mark.x, mark.at[1]], [mark.x, area.bottom], marked))?;
        }
        for mark in &layout.marks {
            write(canvas, &mark.text, Ink::Label, mark.at, mark.anchor, VPos::Top)?;
        }
        for (text, ink, at, anchor) in &layout.lines {
            write(canvas, text, *ink, *at, *anchor, VPos::Top)?;
        }
        Ok(())
    }

    fn draw_legend(&self, canvas: &Canvas<'_>, layout: &Layout) -> Drawn {
        for (index, text, [x, y]) in &layout.legend {
            let series = &self.series[*index];
            let middle = y + LINE / 2.0;
            if series.style != Style::Points {
                let ink = line_ink(series, *index);
                let ends = [[*x, middle], [x + SAMPLE, middle]].map(units_at);
                canvas.draw(&PathElement::new(ends, ink.code().stroke_width(units(1.75) as u32)))?;
            }
            if series.style != Style::Line || (self.series.len() > 1 && !series.muted) {
                draw_marker(canvas, series, *index, [x + SAMPLE / 2.0, middle])?;
            }
            write(canvas, text, Ink::Text, [x + SAMPLE + 5.0, middle], HPos::Left, VPos::Center)?;
        }
        Ok(())
    }

    fn draw_labels(&self, canvas: &Canvas<'_>, layout: &Layout, runs: &[Vec<Vec<[f64; 2]>>]) -> Drawn {
        let points = self.series.iter().flat_map(|series| &series.points);
        let labelled: Vec<(String, Wanted)> = points
            .filter_map(|point| {
                let text = text::fit(point.label.as_ref()?, layout.width() * 0.6 / EM);
                let point = layout.at(self.place(point)?);
                let size = [pixels(&text) + 2.0, LINE - 3.0];
                (!text.is_empty()).then_some((text, Wanted { point, size }))
            })
            .collect();
        let (mut markers, mut lines) = (Vec::new(), Vec::new());
        for (index, (series, runs)) in self.series.iter().zip(runs).enumerate() {
            for point in self.marked(index, runs) {
                markers.push(Area::around(layout.at(point), [2.0 * RADIUS + 4.0; 2]));
            }
            for pair in runs.iter().filter(|_| series.style != Style::Points).flat_map(|run| run.windows(2)) {
                let [from, to] = [layout.at(pair[0]), layout.at(pair[1])];
                let parts = ((to[0] - from[0]).hypot(to[1] - from[1]) / 4.0).ceil();
                let at = |i: usize| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * i as f64 / parts);
                lines.extend((0..parts as usize).map(|i| Area::around(at(i), [4.0; 2])));
            }
        }
        let area = &layout.inner;
        lines.extend(layout.marks.iter().map(|mark| Area { left: mark.x - 2.0, right: mark.x + 2.0, ..*area }));
        let wanted: Vec<Wanted> = labelled.iter().map(|(_, wanted)| *wanted).collect();
        let places = label::place(&wanted, area, &markers, &lines);
        let leader = Ink::Soft.code().stroke_width(units(0.75) as u32);
        for (wanted, place) in wanted.iter().zip(&places).filter_map(|(wanted, place)| Some((wanted, (*place)?))) {
            let ([x, y], end) = (wanted.point, place.nearest(wanted.point));
            let distance = (end[0] - x).hypot(end[1] - y);
            if distance > label::NEAR {
                let begin = [x + (end[0] - x) * RADIUS / distance, y + (end[1] - y) * RADIUS / distance];
                canvas.draw(&PathElement::new([begin, end].map(units_at), leader))?;
            }
        }
        for (text, place) in labelled.iter().zip(&places).filter_map(|((text, _), place)| Some((text, (*place)?))) {
            let middle = [(place.left + place.right) / 2.0, (place.top + place.bottom) / 2.0];
            write(canvas, text, Ink::Label, middle, HPos::Center, VPos::Center)?;
        }
        Ok(())
    }
}

/// Writes text with its anchor at `at`, in pixels.
fn write(canvas: &Canvas<'_>, text: &str, ink: Ink, at: [f64; 2], horizontal: HPos, vertical: VPos) -> Drawn {
    let style = ("sans-serif", TEXT_SIZE).into_font().color(&ink.code()).pos(Pos::new(horizontal, vertical));
    canvas.draw(&Text::new(text, units_at(at), style))
}

fn line_ink(series: &Series, index: usize) -> Ink {
    match (series.muted, series.dashed) {
        (false, false) => Ink::Series(index),
        (false, true) => Ink::SeriesDashed(index),
        (true, false) => Ink::Soft,
        (true, true) => Ink::SoftDashed,
    }
}

/// The marker of a series at a place in pixels. With more than eight series, colours are shared and markers differ.
fn draw_marker(canvas: &Canvas<'_>, series: &Series, index: usize, [x, y]: [f64; 2]) -> Drawn {
    let inks = if series.muted { [Ink::Soft, Ink::SoftOpen] } else { [Ink::Series(index), Ink::SeriesOpen(index)] };
    let filled = inks[0].code().filled();
    let [line, outline] = inks.map(|ink| ink.code().stroke_width(units(1.75) as u32));
    let whole = |corners: &[[f64; 2]]| {
        corners.iter().map(|[across, down]| units_at([x + across * RADIUS, y + down * RADIUS])).collect::<Vec<_>>()
    };
    // The first edge is drawn a second time, so that no gap remains at its start.
    let closed = |corners: &[[f64; 2]]| PathElement::new(whole(&[corners, &corners[..2]].concat()), outline);
    let square = [[-0.85, -0.85], [0.85, -0.85], [0.85, 0.85], [-0.85, 0.85]];
    let up = [[0.0, -1.2], [1.15, 0.9], [-1.15, 0.9]];
    let diamond = [[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]];
    match (index + index / ink::SERIES.len()) % ink::SERIES.len() {
        0 => canvas.draw(&Circle::new(units_at([x, y]), units(RADIUS), filled)),
        1 => canvas.draw(&closed(&square)),
        2 => canvas.draw(&Polygon::new(whole(&up), filled)),
        3 => canvas.draw(&closed(&diamond)),
        4 => {
            canvas.draw(&PathElement::new(whole(&[[-1.0, -1.0], [1.0, 1.0]]), line))?;
            canvas.draw(&PathElement::new(whole(&[[-1.0, 1.0], [1.0, -1.0]]), line))
        }
        5 => canvas.draw(&Polygon::new(whole(&diamond), filled)),
        6 => canvas.draw(&Circle::new(units_at([x, y]), units(RADIUS * 0.9), outline)),
        _ => canvas.draw(&closed(&up.map(|[across, down]| [across, -down]))),
    }
}

impl Page {
    /// A plot with its title, its description and, on request, its data.
    pub fn plot(&mut self, plot: &Plot) {
        // The space around the data is measured first: data have one height in all plots.
        let outside = {
            let layout = Layout::new(plot, [f64::from(PAGE_WIDTH), 0.0], false);
            layout.inner.top - layout.inner.bottom
        };
        let height = (PAGE_INNER_HEIGHT + outside).ceil();
        let layout = Layout::new(plot, [f64::from(PAGE_WIDTH), height], false);
        let svg = plot.drawn(&layout, &format!("plot-{}", self.next_number()));
        self.add(format_args!(
            "<figure class=\"plot\">\n{svg}<figcaption><b>{}</b> {}</figcaption>\n<details>\n<summary>Data</summary>\n",
            Escaped(&plot.title),
            Escaped(&plot.description)
        ));
        let (headings, rows) = plot.table();
        self.table(&headings.iter().map(String::as_str).collect::<Vec<_>>(), rows);
        self.add(format_args!("</details>\n</figure>\n"));
    }

    /// Plots next to each other, as many in a row as fit.
    pub fn plots<'a>(&mut self, plots: impl IntoIterator<Item = &'a Plot>) {
        self.add(format_args!("<div class=\"plots\">\n"));
        plots.into_iter().for_each(|plot| self.plot(plot));
        self.add(format_args!("</div>\n"));
    }
}

#[cfg(test)]
mod tests;
