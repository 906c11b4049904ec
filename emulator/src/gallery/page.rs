//! The page: one HTML file that needs nothing beside it, no network and no script.
//!
//! Pictures are embedded as data URIs (RFC 2397, base64 of RFC 4648), so that the file can be sent alone. Colours follow the
//! reader's light or dark preference; wide tables scroll by themselves, so that a phone shows the rest unscaled.

use std::fmt::{self, Display, Write as _};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::drawn::{DrawnScene, GalleryError, Settings};
use super::table::{FILTERED, NO_TEXTURE, SAMPLES_16, UNFILTERED};
use crate::output::OutputFile;
use crate::picture::{DIFFERENCE_GAIN, PictureError};

const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1c1e21; --paper: #fbfaf7; --soft: #63666b; --line: #d5d2ca; --good: #0b6b3a; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e2dd; --paper: #17181a; --soft: #9c9fa4; --line: #3a3c40; --good: #6fd39b; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1rem; max-width: 84rem; font: 1rem/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); }
h1, h2 { line-height: 1.2; }
section { border-top: 1px solid var(--line); margin-top: 2.5rem; }
p { max-width: 48rem; }
.soft, figcaption { color: var(--soft); }
.figures { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; flex: 0 1 20rem; }
img { display: block; width: 100%; height: auto; background: #000; }
figcaption { font-size: .9rem; margin-top: .25rem; }
figcaption b { color: var(--ink); }
.scroll { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .6rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
tr.filtered { color: var(--good); font-weight: 600; }
a { color: inherit; }
pre { overflow-x: auto; padding: .75rem; border: 1px solid var(--line); font-size: .85rem; }
summary { cursor: pointer; margin: 1rem 0; }
";

/// Writes `index.html` into `directory`: the scenes with their pictures, figures and plans. Gives its path.
///
/// Errors: a picture that [`super::draw_scene`] wrote is no longer there, or the page cannot be written.
pub fn write_page(
    scenes: &[DrawnScene],
    settings: &Settings,
    profile: &str,
    directory: &Path,
) -> Result<PathBuf, GalleryError> {
    let path = directory.join("index.html");
    let page = page(scenes, settings, profile)?;
    let written = OutputFile::create(&path).and_then(|mut file| {
        file.write_all(page.as_bytes())?;
        file.commit()
    });
    written.map_err(|source| GalleryError::Write { path: path.clone(), source })?;
    Ok(path)
}

fn page(scenes: &[DrawnScene], settings: &Settings, profile: &str) -> Result<String, GalleryError> {
    let [width, height] = settings.size;
    let samples = settings.reference_edge.pow(2);
    let threads = match rayon::current_num_threads() {
        1 => "1 thread".to_string(),
        threads => format!("{threads} threads"),
    };
    let mut page = Page::default();
    page.add(format_args!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>Roughxel gallery</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>Roughxel gallery</h1>\n\
         <p>Scenes of the papers, {width}×{height} pixels, profile {}, drawn by {threads}. The reference has {samples} unfiltered samples \
         a pixel. PSNR is of linear light, SSIM of the grey a display shows; both against the reference, higher is better. \
         Times are of drawing alone, on one machine in one run: compare them with each other only.</p>\n</header>\n",
        Text(profile)
    ));
    overview(&mut page, scenes);
    for scene in scenes {
        section(&mut page, scene, settings.size)?;
    }
    page.add(format_args!("</body>\n</html>\n"));
    Ok(page.text)
}

/// F92's table of four columns for every scene, with a link to each.
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
        page.cell(filtered.zip(unfiltered).map(|(a, b)| format!("{:+.1} dB", a.psnr - b.psnr)));
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
        let caption = format!("{} against the reference", Decibel(drawn.psnr));
        page.figure(&drawn.picture, size, scene.entry.name, drawn.column.label, &caption)?;
    }
    page.figure(&scene.reference.picture, size, scene.entry.name, "reference", "what the others are judged against")?;

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
        page.cell(Some(Decibel(drawn.psnr)));
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
        page.figure(&drawn.difference, size, scene.entry.name, &label, &similarity)?;
    }
    page.add(format_args!(
        "</div>\n</details>\n<details>\n<summary>Plan of the filtered picture</summary>\n<pre>{}</pre>\n</details>\n</section>\n",
        Text(&scene.plan)
    ));
    Ok(())
}

/// A page that grows.
#[derive(Default)]
struct Page {
    text: String,
}

impl Page {
    fn add(&mut self, part: fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(part);
    }

    /// A cell of a table; a dash where there is nothing.
    fn cell(&mut self, value: Option<impl Display>) {
        match value {
            Some(value) => self.add(format_args!("<td>{}</td>", Text(&value.to_string()))),
            None => self.add(format_args!("<td>–</td>")),
        }
    }

    fn figure(
        &mut self,
        picture: &Path,
        [width, height]: [u32; 2],
        scene: &str,
        label: &str,
        caption: &str,
    ) -> Result<(), GalleryError> {
        let png = fs::read(picture).map_err(|source| PictureError::Open { path: picture.to_path_buf(), source })?;
        let (scene, label, caption) = (Text(scene), Text(label), Text(caption));
        self.add(format_args!(
            "<figure>\n<img src=\"data:image/png;base64,{}\" alt=\"{scene}: {label}\" width=\"{width}\" height=\"{height}\">\n\
             <figcaption><b>{label}</b> {caption}</figcaption>\n</figure>\n",
            base64(&png)
        ));
        Ok(())
    }
}

/// Text of an element or attribute.
struct Text<'a>(&'a str);

impl Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|character| match character {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '"' => f.write_str("&quot;"),
            _ => f.write_char(character),
        })
    }
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

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = (0..3).fold(0, |word, i| word << 8 | group.get(i).map_or(0, |byte| u32::from(*byte)));
        for digit in 0..4 {
            let is_data = digit <= group.len();
            text.push(if is_data { DIGITS[(word >> (18 - 6 * digit)) as usize & 63].into() } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_the_vectors_of_rfc_4648() {
        let vectors =
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg=="), ("foobar", "Zm9vYmFy")];
        for (bytes, text) in vectors {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xfb, 0xef, 0xff]), "++//");
    }

    #[test]
    fn text_cannot_become_a_tag_or_end_an_attribute() {
        assert_eq!(Text("a<b> & \"c\"").to_string(), "a&lt;b&gt; &amp; &quot;c&quot;");
    }
}
