//! A report of a study: one page that needs no other file, its plots as files, its tables as text.

mod figures;
mod pictures;
mod plots;
mod tables;
mod verdict;

use std::io::Write;
use std::path::{Path, PathBuf};

use roughxel_html_report::html::{Page, Text};
use roughxel_utilities::output::OutputFile;

use crate::measurement::Study;
use crate::{StudyError, soft_core, stability};

pub use tables::{markdown, profiles};
pub use verdict::{BUYS_SOMETHING_DB, KnobGain, knob_gains};

/// Width and height of a plot in its own file, pixels.
const PLOT_SIZE: [u32; 2] = [640, 480];

/// The study as its file holds it.
pub fn json(study: &Study) -> String {
    // The study is numbers, texts and lists of them, so this cannot fail.
    let text = serde_json::to_string_pretty(study).unwrap_or_default();
    text + "\n"
}

/// Writes `study.json`, `index.html`, the tables and plots of `docs/performance.md`, and pictures into a directory; returns the
/// paths.
///
/// Errors: a scene that cannot be drawn, a file that cannot be written.
pub fn write(study: &Study, directory: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let drawn = Pictures { knobs: pictures::draw(study, directory)?, naive: pictures::naive(directory)? };
    let own = [("study.json", json(study)), ("index.html", page(study, &drawn)), ("tables.md", markdown(study))];
    let files = own.into_iter().chain(readme_plots(study));
    files.map(|(name, text)| write_file(&directory.join(name), text.as_bytes())).collect()
}

/// The plots of `docs/performance.md`: name of the file, SVG.
pub fn readme_plots(study: &Study) -> [(&'static str, String); 2] {
    let [bits, frames] = plots::readme(study);
    [("bits.svg", bits.svg(PLOT_SIZE)), ("frames.svg", frames.svg(PLOT_SIZE))]
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<PathBuf, StudyError> {
    let written = OutputFile::create(path).and_then(|mut file| {
        file.write_all(bytes)?;
        file.commit()
    });
    match written {
        Ok(()) => Ok(path.to_path_buf()),
        Err(source) => Err(StudyError::File { action: "write", path: path.to_path_buf(), source }),
    }
}

/// Pictures of the page besides plots.
struct Pictures {
    knobs: Vec<pictures::ScenePictures>,
    naive: Vec<pictures::ScenePictures>,
}

fn show(page: &mut Page, picture: &pictures::ScenePictures) {
    page.add(format_args!("<div class=\"figures\">\n"));
    for (png, label, caption) in &picture.shown {
        page.figure(png, picture.size, &format!("{}, {}: {label}", picture.scene, picture.name), label, caption);
    }
    page.add(format_args!("</div>\n"));
}

fn page(study: &Study, pictures: &Pictures) -> String {
    let mut page = Page::new("Roughxel: what accuracy costs in time");
    let machine = &study.machine;
    let [width, height] = study.settings.size;
    page.add(format_args!(
        "<header>\n<h1>What accuracy costs in time</h1>\n\
         <p>Each point is a setting of the accuracy knobs of the datapath, or another method: its error against float64, and what it \
         takes on four clocks. Frames are {width}×{height} pixels of {}, the truth has {} samples a pixel. At every setting frames of \
         {} are timed.</p>\n\
         <p class=\"soft\">{}, {}, {} threads, lanes {}; {}; {}. Soft core: {}. {}. A † marks a time that was found while other \
         programs ran.</p>\n</header>\n",
        Text(&study.settings.scenes.join(", ")),
        study.settings.samples_edge.pow(2),
        Text(&figures::timed_scenes(study).join(" and ")),
        Text(&machine.processor),
        Text(&machine.system),
        machine.threads,
        Text(&machine.lanes),
        Text(&machine.program),
        Text(&machine.rustc),
        Text(soft_core::rustc()),
        Text(&study.seeds),
    ));

    page.section("choose", "What to choose");
    let (headings, rows) = verdict::choices(study);
    table(&mut page, &headings, &rows);
    page.paragraph(
        "The cheapest setting of this study whose frames reach that PSNR against the filter of standard in float64 in every scene. \
         “roughxel choose” finds one for a scene of your own, among combinations of knobs.",
    );
    list(&mut page, &verdict::bit_prices(study));
    page.end_section();

    page.section("profiles", "The named profiles");
    let (headings, rows) = profiles(study);
    table(&mut page, &headings, &rows);
    let (headings, rows) = tables::floats(study);
    page.paragraph("Other methods on the same fragments:");
    table(&mut page, &headings, &rows);
    list(&mut page, &verdict::floats(study));
    page.paragraph("Frames of standard beside those without footprints and with several samples a pixel:");
    let (headings, rows) = tables::frames(study);
    table(&mut page, &headings, &rows);
    page.end_section();

    page.section("clocks", "Error against time");
    page.paragraph(
        "Down and to the left is better where errors are shown, up and to the left where pictures are. The dashed line joins the \
         settings that nothing beats on both axes.",
    );
    page.plots(&plots::clocks(study));
    page.end_section();

    page.section("knobs", "One curve a knob");
    list(&mut page, &verdict::idle_knobs(study));
    for (knob, plots) in plots::knobs(study) {
        page.add(format_args!("<h3>{}</h3>\n", Text(&knob)));
        page.plots(&plots);
        pictures.knobs.iter().filter(|picture| picture.name == knob).for_each(|picture| show(&mut page, picture));
    }
    page.end_section();

    page.section("stability", "Near the degeneracies");
    page.paragraph(
        "The worst error of a family of fragments against its distance from the case where a formula breaks down. A vertical line is \
         where the documented fallback of a profile begins; dashed curves are floating point, which has none.",
    );
    page.plots(&study.stability.iter().map(plots::stability).collect::<Vec<_>>());
    for case in &study.stability {
        let wins = stability::float_wins(case);
        let pictures: Vec<_> = pictures.naive.iter().filter(|picture| picture.name == case.name).collect();
        if wins.is_empty() && pictures.is_empty() {
            continue;
        }
        page.add(format_args!("<h3>{}</h3>\n", Text(&case.title)));
        for picture in pictures {
            page.paragraph("What the plain formula makes of a frame:");
            show(&mut page, picture);
        }
        list(&mut page, &wins);
    }
    page.end_section();
    page.finish()
}

fn table(page: &mut Page, headings: &[String], rows: &[Vec<String>]) {
    // Backticks are for `docs/performance.md` only.
    let headings: Vec<String> = headings.iter().map(|text| text.replace('`', "")).collect();
    let rows = rows.iter().map(|row| row.iter().map(|text| text.replace('`', "")).collect::<Vec<_>>());
    page.table(&headings.iter().map(String::as_str).collect::<Vec<_>>(), rows);
}

fn list(page: &mut Page, sentences: &[String]) {
    if sentences.is_empty() {
        return;
    }
    page.add(format_args!("<ul>\n"));
    for sentence in sentences {
        page.add(format_args!("<li>{}</li>\n", Text(&sentence.replace('`', ""))));
    }
    page.add(format_args!("</ul>\n"));
}

/// The study that `docs/performance.md` shows.
#[cfg(test)]
fn kept() -> Study {
    Study::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("results/study.json")).expect("a kept study")
}
