//! Colours that follow the reader's light or dark preference.
//!
//! Plotters writes a colour into every element. Here it gets codes instead of colours. In its output the codes become classes,
//! whose colours are defined once for light and once for dark.

use std::fmt::Write as _;

use plotters::style::RGBColor;

/// Drawing inks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ink {
    Text,
    /// Headings.
    Bold,
    /// Labels among the data, with a rim of paper.
    Label,
    /// Text outside the data: labels of axes, marks.
    Soft,
    SoftDashed,
    Grid,
    Series(usize),
    SeriesDashed(usize),
    /// An outline whose inside hides the data below it.
    SeriesOpen(usize),
    /// An outline of a muted series.
    SoftOpen,
}

/// Colours of series, light and dark, distinct with each kind of colour blindness. They are those of Okabe and Ito, darker on
/// light paper and lighter on dark, so that each has a contrast of 3 : 1.
pub(super) const SERIES: [[&str; 2]; 8] = [
    ["#0072b2", "#4aa8e8"],
    ["#c75200", "#f58a45"],
    ["#008a64", "#2fc498"],
    ["#b0508c", "#e39ac6"],
    ["#1c1e21", "#e4e2dd"],
    ["#a87400", "#e6b020"],
    ["#2f8abf", "#9ad4f5"],
    ["#7f7a00", "#f0e442"],
];

/// Paper, text, soft text and lines of the page, light and dark.
const PAPER: [&str; 2] = ["#fbfaf7", "#17181a"];
const TEXT: [&str; 2] = ["#1c1e21", "#e4e2dd"];
const SOFT: [&str; 2] = ["#63666b", "#9c9fa4"];
const GRID: [&str; 2] = ["#e2dfd8", "#303236"];

impl Ink {
    /// Code of an ink for the crate: a red of 1 that no ink has, the kind, the series.
    pub(super) fn code(self) -> RGBColor {
        let (kind, series) = match self {
            Ink::Text => (0, 0),
            Ink::Bold => (1, 0),
            Ink::Label => (2, 0),
            Ink::Soft => (3, 0),
            Ink::SoftDashed => (4, 0),
            Ink::Grid => (5, 0),
            Ink::Series(series) => (6, series),
            Ink::SeriesDashed(series) => (7, series),
            Ink::SeriesOpen(series) => (8, series),
            Ink::SoftOpen => (9, 0),
        };
        RGBColor(1, kind, (series % SERIES.len()) as u8)
    }
}

/// Classes of a code, given as the digits of its kind and series.
fn classes(code: &str) -> Option<String> {
    let series = code.get(2..4)?.trim_start_matches('0');
    let series = if series.is_empty() { "0" } else { series };
    Some(match code.get(..2)? {
        "00" => "text".to_owned(),
        "01" => "text bold".to_owned(),
        "02" => "text rim".to_owned(),
        "03" => "soft".to_owned(),
        "04" => "soft dots".to_owned(),
        "05" => "grid".to_owned(),
        "06" => format!("s{series}"),
        "07" => format!("s{series} dash"),
        "08" => format!("s{series} open"),
        "09" => "soft open".to_owned(),
        _ => return None,
    })
}

/// Text of an SVG whose codes are replaced by classes.
pub(super) fn recoloured(svg: &str) -> String {
    let mut parts = svg.split("\"#01");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match (classes(part), part.get(4..)) {
            (Some(classes), Some(rest)) => {
                let _ = write!(text, "\"currentColor\" class=\"{classes}{rest}");
            }
            _ => {
                text.push_str("\"#01");
                text.push_str(part);
            }
        }
    }
    text
}

/// Rules of the classes, for any number of plots in one document; `units` of drawing are a pixel.
pub(super) fn style(units: i32) -> String {
    let mut rules = format!(
        ".roughxel-plot text{{font:{}px system-ui,sans-serif;font-variant-numeric:tabular-nums}}\
         .roughxel-plot polyline,.roughxel-plot .rim{{stroke-linejoin:round;stroke-linecap:round}}\
         .roughxel-plot .bold{{font-weight:600}}\
         .roughxel-plot .rim{{paint-order:stroke;stroke-width:{}}}\
         .roughxel-plot .dash{{stroke-dasharray:{} {};stroke-linecap:butt}}\
         .roughxel-plot .dots{{stroke-dasharray:{} {}}}",
        13 * units,
        4 * units,
        6 * units,
        4 * units,
        2 * units,
        3 * units,
    );
    for (shade, around) in [["", ""], ["@media (prefers-color-scheme:dark){", "}"]].into_iter().enumerate() {
        rules.push_str(around[0]);
        let named = [("text", TEXT), ("soft", SOFT), ("grid", GRID), ("paper", PAPER)];
        let mut rule = |name: &str, colour: &str| {
            let _ = write!(rules, ".roughxel-plot .{name}{{color:{colour}}}");
        };
        named.iter().for_each(|(name, colours)| rule(name, colours[shade]));
        SERIES.iter().enumerate().for_each(|(series, colours)| rule(&format!("s{series}"), colours[shade]));
        let paper = PAPER[shade];
        let _ = write!(rules, ".roughxel-plot .rim{{stroke:{paper}}}.roughxel-plot .open{{fill:{paper}}}{}", around[1]);
    }
    rules
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of WCAG 2.
    fn luminance(colour: &str) -> f64 {
        let part = |at: usize| {
            let value = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).expect("two digits")) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
    }

    fn contrast(one: &str, other: &str) -> f64 {
        let (one, other) = (luminance(one), luminance(other));
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    #[test]
    fn series_and_text_stand_out_from_light_and_dark_paper() {
        for shade in [0, 1] {
            for colours in SERIES {
                assert!(contrast(colours[shade], PAPER[shade]) >= 3.0, "{}", colours[shade]);
            }
            assert!(contrast(TEXT[shade], PAPER[shade]) >= 7.0);
            assert!(contrast(SOFT[shade], PAPER[shade]) >= 4.5);
        }
    }

    #[test]
    fn codes_become_classes_and_nothing_else_does() {
        let svg = "<a fill=\"#010600\"/><b stroke=\"#010705\" x=\"1\"/><c fill=\"#01FF00\"/>";
        let classed = "<a fill=\"currentColor\" class=\"s0\"/><b stroke=\"currentColor\" class=\"s5 dash\" x=\"1\"/><c fill=\"#01FF00\"/>";
        assert_eq!(recoloured(svg), classed);
    }
}
