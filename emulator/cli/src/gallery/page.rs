//! The page: one self-contained HTML file ([`roughxel_html_report`]).

use std::fmt::{self, Display};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use roughxel_assets::picture::{DIFFERENCE_GAIN, PictureError};
use roughxel_html_report::html::{Page, Text};
use roughxel_utilities::output::write_files;

use super::drawn::{DrawnScene, GalleryError, Settings};
use super::table::{FILTERED, NO_TEXTURE, SAMPLES_16, UNFILTERED};

/// Text in place of a figure if [`Settings::judges`] is false.
const NOT_JUDGED: &str = "not judged: the reference has no more samples a pixel";

/// Writes `index.html` into `directory`: the scenes with their pictures, figures and plans. Returns its path.
///
/// Errors: a picture that [`super::draw_scene`] wrote is gone, or the page cannot be written.
pub fn write_page(
    scenes: &[DrawnScene],
    settings: &Settings,
    profile: &str,
    directory: &Path,
) -> Result<PathBuf, GalleryError> {
    let path = directory.join("index.html");
    write_files(directory, [("index.html", page(scenes, settings, profile)?)])?;
    Ok(path)
}

fn page(scenes: &[DrawnScene], settings: &Settings, profile: &str) -> Result<String, GalleryError> {
    let [width, height] = settings.size;
    let samples = settings.reference_edge.pow(2);
    let threads = match rayon::current_num_threads() {
        1 => "1 thread".to_string(),
        threads => format!("{threads} threads"),
    };
    let mut page = Page::new("Roughxel gallery");
    page.add(format_args!(
        "<header>\n<h1>Roughxel gallery</h1>\n\
         <p>Scenes of the papers, {width}×{height} pixels, profile {}, drawn by {threads}. The reference has {samples} unfiltered samples \
         a pixel. PSNR is of linear light, SSIM of the grey a display shows; both against the reference, higher is better. \
         Times are of drawing alone, on one machine in one run: compare them with each other only.</p>\n</header>\n",
        Text(profile)
    ));
    overview(&mut page, scenes);
    for scene in scenes {
        section(&mut page, scene, settings.size)?;
    }
    Ok(page.finish())
}

/// Adds the table of F92 with four columns, for every scene, with a link to each.
fn overview(page: &mut Page, scenes: &[DrawnScene]) {
    page.add(format_args!(
        "<p class=\"soft\">Times as in the table of F92, §3. There, filtered takes 1.55 to 2.40 times as long as unfiltered, and 16 \
         samples 6.2 to 10.7 times as long as filtered.</p>\n\
         <div class=\"scroll\">\n<table>\n<thead>\n<tr><th scope=\"col\">scene</th>"
    ));
    let labels = [NO_TEXTURE, UNFILTERED.label, FILTERED.label, SAMPLES_16.label];
    for label in labels.into_iter().chain(["filtered ÷ unfiltered", "16 samples ÷ filtered", "PSNR gained"]) {
        page.add(format_args!("<th scope=\"col\">{}</th>", Text(label)));
    }
    page.add(format_args!("</tr>\n</thead>\n<tbody>\n"));
    for scene in scenes {
        let name = Text(scene.entry.name);
        page.add(format_args!("<tr><td><a href=\"#{name}\">{name}</a></td>"));
        for label in labels {
            page.cell(scene.column(label).map(|drawn| Time(drawn.time)));
        }
        let [unfiltered, filtered, samples] = [UNFILTERED, FILTERED, SAMPLES_16].map(|c| scene.column(c.label));
        let ratio = |a, b| scene.ratio(a).zip(scene.ratio(b)).map(|(a, b)| format!("{:.2}", a / b));
        page.cell(filtered.zip(unfiltered).and_then(|(a, b)| ratio(a, b)));
        page.cell(samples.zip(filtered).and_then(|(a, b)| ratio(a, b)));
        let [filtered, unfiltered] = [filtered, unfiltered].map(|drawn| drawn.and_then(|drawn| drawn.psnr));
        page.cell(filtered.zip(unfiltered).map(|(a, b)| format!("{:+.1} dB", a - b)));
        page.add(format_args!("</tr>\n"));
    }
    page.add(format_args!("</tbody>\n</table>\n</div>\n"));
}

fn section(page: &mut Page, scene: &DrawnScene, size: [u32; 2]) -> Result<(), GalleryError> {
    let name = Text(scene.entry.name);
    page.add(format_args!(
        "<section id=\"{name}\">\n<h2>{name}</h2>\n<p>{} <span class=\"soft\">{}</span></p>\n<div class=\"figures\">\n",
        Text(scene.entry.shows),
        Text(scene.entry.source)
    ));
    for drawn in &scene.columns {
        let caption = drawn.psnr.map_or(NOT_JUDGED.into(), |psnr| format!("{} against the reference", Decibel(psnr)));
        figure(page, &drawn.picture, size, scene.entry.name, drawn.column.label, &caption)?;
    }
    figure(page, &scene.reference.picture, size, scene.entry.name, "reference", "the columns are compared with it")?;

    page.add(format_args!("</div>\n<div class=\"scroll\">\n<table>\n<thead>\n<tr>"));
    for heading in ["column", "time", "÷ unfiltered", "PSNR", "SSIM"] {
        page.add(format_args!("<th scope=\"col\">{heading}</th>"));
    }
    page.add(format_args!("</tr>\n</thead>\n<tbody>\n"));
    for drawn in &scene.columns {
        let label = drawn.column.label;
        let class = if label == FILTERED.label { " class=\"filtered\"" } else { "" };
        page.add(format_args!("<tr{class}><td>{}</td>", Text(label)));
        page.cell(Some(Time(drawn.time)));
        page.cell(scene.ratio(drawn).map(|ratio| format!("{ratio:.2}")));
        page.cell(drawn.psnr.map(Decibel));
        page.cell(drawn.ssim.map(|ssim| format!("{ssim:.4}")));
        page.add(format_args!("</tr>\n"));
    }
    page.add(format_args!("<tr><td>reference</td>"));
    match scene.reference.time {
        Some(time) => page.cell(Some(Time(time))),
        None => page.cell(Some("kept")),
    }
    page.add(format_args!(
        "<td></td><td></td><td></td></tr>\n</tbody>\n</table>\n</div>\n<details>\n<summary>Differences from the reference: grey is none, \
         lighter is too bright, {DIFFERENCE_GAIN} times enlarged</summary>\n<div class=\"figures\">\n"
    ));
    for drawn in &scene.columns {
        let similarity = drawn.ssim.map_or_else(String::new, |ssim| format!("SSIM {ssim:.4}"));
        let label = format!("{} − reference", drawn.column.label);
        figure(page, &drawn.difference, size, scene.entry.name, &label, &similarity)?;
    }
    page.add(format_args!(
        "</div>\n</details>\n<details>\n<summary>Plan of the filtered picture</summary>\n<pre>{}</pre>\n</details>\n</section>\n",
        Text(&scene.plan)
    ));
    Ok(())
}

fn figure(
    page: &mut Page,
    picture: &Path,
    size: [u32; 2],
    scene: &str,
    label: &str,
    caption: &str,
) -> Result<(), GalleryError> {
    let png = fs::read(picture).map_err(|source| PictureError::open(picture, source))?;
    page.figure(&png, size, &format!("{scene}: {label}"), label, caption);
    Ok(())
}

struct Time(Duration);

impl Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.as_secs_f64() {
            seconds if seconds < 1.0 => write!(f, "{:.1} ms", 1000.0 * seconds),
            seconds => write!(f, "{seconds:.2} s"),
        }
    }
}

struct Decibel(f64);

impl Display for Decibel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_finite() { write!(f, "{:.1} dB", self.0) } else { f.write_str("equal") }
    }
}
