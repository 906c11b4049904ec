//! Content of a plot, as places on its axes and as a table.

use super::axis::Scale;

/// An axis and its quantity.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity with its unit.
    pub label: String,
    /// Scale of the values.
    pub scale: Scale,
}

/// Drawing style of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Joined points; with several series a few markers tell them apart.
    Line,
    /// A marker for each point.
    Points,
    /// Joined points, with a marker for each.
    LinePoints,
}

/// A point.
#[derive(Clone, Debug)]
pub struct Point {
    /// Value along the axis to the right.
    pub x: f64,
    /// Value along the upward axis.
    pub y: f64,
    /// Label, drawn next to the point if there is room, otherwise in the table only.
    pub label: Option<String>,
}

/// Points that belong together. A line is broken at points that cannot be drawn.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend; a series without a name has no entry.
    pub name: String,
    /// Drawing style.
    pub style: Style,
    /// True for a dashed line.
    pub dashed: bool,
    /// True for context: drawn in soft ink, and a line has no markers.
    pub muted: bool,
    /// Points in the order of the line.
    pub points: Vec<Point>,
}

/// A vertical line at the beginning or end of something.
#[derive(Clone, Debug)]
pub struct Mark {
    /// Value along the x axis.
    pub x: f64,
    /// Label above the line.
    pub label: String,
}

/// A plot. Values that are not finite, or not positive on a logarithmic axis, appear in its table only.
#[derive(Clone, Debug)]
pub struct Plot {
    /// A few words.
    pub title: String,
    /// Message of the plot in sentences, also for readers who see no picture.
    pub description: String,
    /// Axis to the right.
    pub x: Axis,
    /// Upward axis.
    pub y: Axis,
    /// Series; each of up to eight has its own marker, and its own colour unless it is muted.
    pub series: Vec<Series>,
    /// Vertical lines.
    pub marks: Vec<Mark>,
}

impl Plot {
    /// Headings and rows of all points.
    ///
    /// Series without labels share rows, one for each x; otherwise each point has a row. The first column identifies the row; a
    /// dash is a missing value.
    pub fn table(&self) -> (Vec<String>, Vec<Vec<String>>) {
        let points = self.series.iter().flat_map(|series| &series.points);
        let x = self.x.scale.numbers(points.clone().map(|point| point.x));
        let y = self.y.scale.numbers(points.map(|point| point.y));
        if let Some(values) = self.common_values() {
            let names = self.series.iter().map(|series| series.name.clone());
            let headings = [self.x.label.clone()].into_iter().chain(names).collect();
            let row = |value: &f64| {
                let of_series = self.series.iter().map(|series| {
                    let point = series.points.iter().find(|point| point.x.total_cmp(value).is_eq());
                    point.map_or_else(|| "–".to_owned(), |point| y(point.y))
                });
                [x(*value)].into_iter().chain(of_series).collect()
            };
            return (headings, values.iter().map(row).collect());
        }
        let headings = ["", &self.x.label, &self.y.label].map(str::to_owned).to_vec();
        let named = self.series.iter().flat_map(|series| series.points.iter().map(move |point| (&series.name, point)));
        let rows = named.map(|(name, point)| {
            let parts = [Some(name), point.label.as_ref()];
            let name: Vec<&str> =
                parts.into_iter().flatten().map(String::as_str).filter(|part| !part.is_empty()).collect();
            vec![name.join(", "), x(point.x), y(point.y)]
        });
        (headings, rows.collect())
    }

    /// All x in order, if x and series identify every point.
    fn common_values(&self) -> Option<Vec<f64>> {
        let mut all = Vec::new();
        for series in &self.series {
            if series.points.iter().any(|point| point.label.is_some()) {
                return None;
            }
            let mut own: Vec<f64> = series.points.iter().map(|point| point.x).collect();
            own.sort_by(f64::total_cmp);
            let distinct = own.windows(2).all(|pair| pair[0].total_cmp(&pair[1]).is_ne());
            distinct.then_some(())?;
            all.extend(own);
        }
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| a.total_cmp(b).is_eq());
        Some(all)
    }

    /// Drawable points of a series, as places on the axes, in runs without a gap.
    pub(super) fn runs(&self, series: &Series) -> Vec<Vec<[f64; 2]>> {
        let places = series.points.iter().map(|point| self.place(point)).collect::<Vec<_>>();
        let runs = places.split(Option::is_none).map(|run| run.iter().copied().flatten().collect());
        runs.filter(|run: &Vec<_>| !run.is_empty()).collect()
    }

    pub(super) fn place(&self, point: &Point) -> Option<[f64; 2]> {
        Some([self.x.scale.place(point.x)?, self.y.scale.place(point.y)?])
    }
}
