use super::*;

fn axis(label: &str, scale: Scale) -> Axis {
    Axis { label: label.to_owned(), scale }
}

fn series(name: &str, style: Style, points: &[[f64; 2]]) -> Series {
    let points = points.iter().map(|[x, y]| Point { x: *x, y: *y, label: None }).collect();
    Series { name: name.to_owned(), style, dashed: false, muted: false, points }
}

fn plot(scale: Scale, series: Vec<Series>) -> Plot {
    Plot {
        title: "Error by distance".to_owned(),
        description: "It falls.".to_owned(),
        x: axis("distance", scale),
        y: axis("error", scale),
        series,
        marks: Vec::new(),
    }
}

const SCALES: [Scale; 3] = [Scale::Linear, Scale::Log2, Scale::Log10];
const STYLES: [Style; 3] = [Style::Line, Style::Points, Style::LinePoints];

#[test]
fn no_text_becomes_markup() {
    let evil = "a <b> & \"c\" 'd' ]]> \u{0}\u{1f}";
    let mut all = plot(Scale::Linear, vec![series(evil, Style::Line, &[[0.0, 1.0], [1.0, 2.0]])]);
    all.series[0].points[0].label = Some(evil.to_owned());
    all.marks.push(Mark { x: 0.5, label: evil.to_owned() });
    (all.title, all.description) = (evil.to_owned(), evil.to_owned());
    (all.x.label, all.y.label) = (evil.to_owned(), evil.to_owned());
    let svg = all.svg([440, 340]);
    assert!(!svg.contains("<b>") && !svg.contains("& ") && !svg.contains('\u{0}') && !svg.contains('\u{1f}'));
    // Title twice, the description twice and once the mark in it, axes, name, label, mark.
    assert_eq!(svg.matches("a &lt;b&gt; &amp; &quot;c&quot;").count(), 10);
}

#[test]
fn nothing_and_little_can_be_drawn() {
    for scale in SCALES {
        assert!(plot(scale, Vec::new()).svg([440, 340]).ends_with("</svg>\n"));
        for style in STYLES {
            for points in [&[][..], &[[1.0, 1.0]], &[[0.0, 0.0]], &[[3.0, 4.0]; 5]] {
                for size in [[440, 340], [1, 1], [0, 0], [u32::MAX; 2]] {
                    assert!(plot(scale, vec![series("only", style, points)]).svg(size).ends_with("</svg>\n"));
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_in_the_table_only() {
    let points =
        [[1.0, f64::NAN], [2.0, 0.0], [4.0, 1.0], [8.0, -3.0], [16.0, 2.0], [32.0, f64::INFINITY], [64.0, 4.0]];
    for scale in [Scale::Log2, Scale::Log10] {
        let plot = plot(scale, vec![series("a", Style::Points, &points)]);
        let svg = plot.svg([440, 340]);
        // Three points and the sample of the legend.
        assert_eq!(svg.matches("<circle").count(), 4);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let (headings, rows) = plot.table();
        assert_eq!(headings, ["distance", "a"]);
        let errors: Vec<&str> = rows.iter().map(|row| row[1].as_str()).collect();
        assert_eq!(errors, ["NaN", "0", "1", "−3", "2", "∞", "4"]);
    }
}

#[test]
fn a_line_is_broken_where_a_point_is_left_out() {
    let points = [[1.0, 1.0], [2.0, 2.0], [3.0, f64::NAN], [4.0, 4.0], [5.0, 5.0]];
    let lines = |points| {
        let drawn = plot(Scale::Linear, vec![series("", Style::Line, points)]).svg([440, 340]);
        drawn.lines().filter(|line| line.starts_with("<polyline") && line.contains("\"s0\"")).count()
    };
    assert_eq!(lines(&points), 2);
    assert_eq!(lines(&points[..2]), 1);
}

#[test]
fn equal_data_give_equal_bytes() {
    let make = || {
        let mut plot = plot(Scale::Log2, vec![series("a", Style::LinePoints, &[[1.0, 2.0], [2.0, 3.0], [2.5, 3.1]])]);
        plot.series[0].points.iter_mut().for_each(|point| point.label = Some("near".to_owned()));
        plot.svg([440, 340])
    };
    assert_eq!(make(), make());
}

#[test]
fn ids_of_a_page_are_unique() {
    let mut page = Page::new("p");
    let one = plot(Scale::Linear, vec![series("a", Style::Line, &[[0.0, 1.0], [1.0, 2.0]])]);
    page.plots([&one, &one]);
    page.plot(&one);
    let text = page.finish();
    let mut ids: Vec<&str> = text.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!((count, ids.len()), (6, 6));
    assert!(!text.contains("class=\"paper\""));
}

#[test]
fn every_point_is_in_the_table() {
    let mut two = plot(
        Scale::Linear,
        vec![series("a", Style::Line, &[[0.0, 1.0], [1.0, 2.0]]), series("b", Style::Line, &[[1.0, 3.0], [2.0, 4.5]])],
    );
    let (headings, rows) = two.table();
    assert_eq!(headings, ["distance", "a", "b"]);
    assert_eq!(rows, [["0", "1", "–"], ["1", "2", "3"], ["2", "–", "4.5"]]);
    two.series[1].points[0].label = Some("fast".to_owned());
    let (headings, rows) = two.table();
    assert_eq!(headings, ["", "distance", "error"]);
    assert_eq!(rows, [["a", "0", "1"], ["a", "1", "2"], ["b, fast", "1", "3"], ["b", "2", "4.5"]]);
}

#[test]
fn context_is_drawn_in_soft_ink_and_its_lines_have_no_markers() {
    let mut two = plot(
        Scale::Linear,
        vec![series("a", Style::Points, &[[0.0, 1.0]]), series("b", Style::Line, &[[0.0, 3.0], [1.0, 4.5]])],
    );
    two.series[1].dashed = true;
    let squares = |plot: &Plot| plot.svg([440, 340]).matches("s1 open").count();
    assert!(squares(&two) > 0);
    two.series[1].muted = true;
    assert_eq!(squares(&two), 0);
    assert!(!two.svg([440, 340]).contains("class=\"s1"));
}

#[test]
fn codes_of_colours_are_all_replaced() {
    let many = (0..10).map(|i| series(&i.to_string(), STYLES[i % 3], &[[0.0, i as f64], [1.0, 2.0]])).collect();
    let mut plot = plot(Scale::Linear, many);
    plot.series.iter_mut().step_by(2).for_each(|series| series.dashed = true);
    let svg = plot.svg([440, 340]);
    assert!(!svg.contains("\"#01") && !svg.contains("font-size"));
}
