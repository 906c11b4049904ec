//! The picture of the floor plan, `vectors/hdl/floorplan.svg`: accuracy of a profile against its lookup tables.

use std::fs;
use std::path::PathBuf;

use roughxel_html_report::plot::{Axis, Plot, Point, Scale, Series, Style};
use serde_json::Value;

use super::cell::{Plan, units};
use super::results::{CellResult, Results};
use crate::imports::workspace_root;

/// Size of the picture, pixels.
const SIZE: [u32; 2] = [720, 420];

/// Path of the picture.
pub fn file() -> PathBuf {
    workspace_root().join("vectors/hdl/floorplan.svg")
}

/// Worst error of s, t of a profile in the committed study.
fn error(study: &Value, profile: &str) -> Option<f64> {
    let point = study["points"].as_array()?.iter().find(|point| point["name"] == profile && point["knob"].is_null())?;
    let figure = point["stages"].as_array()?.iter().find(|figure| figure["figure"] == "s, t")?;
    figure["worst"].as_f64()
}

/// SVG of all cells for ECP5: a series for each plan and number of multipliers.
///
/// Errors: the study cannot be read, or lacks a profile.
pub fn svg(results: &Results) -> Result<String, String> {
    let path = workspace_root().join("emulator/study/results/study.json");
    let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let study: Value = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut series = Vec::new();
    for plan in Plan::ALL {
        let mut points = Vec::new();
        for cell in results.cells.values().filter(|cell| cell.plan == plan && cell.target == "ecp5") {
            let y = error(&study, &cell.profile)
                .ok_or_else(|| format!("{}: it has no error of s, t of {}", path.display(), cell.profile))?;
            let label = format!("{} {}", cell.profile, units(cell.multipliers));
            points.push(Point { x: CellResult::ecp5_luts(&cell.area) as f64, y, label: Some(label) });
        }
        if !points.is_empty() {
            let name = plan.name().to_owned();
            series.push(Series { name, style: Style::Points, dashed: false, muted: false, points });
        }
    }
    let plot = Plot {
        title: "Accuracy and size".to_owned(),
        description:
            "Worst error of s, t on a cube face against lookup tables of an ECP5: profile and number of multipliers."
                .to_owned(),
        x: Axis { label: "lookup tables of an ECP5, with carries and memories".to_owned(), scale: Scale::Log10 },
        y: Axis { label: "worst error of s, t".to_owned(), scale: Scale::Log2 },
        series,
        marks: Vec::new(),
    };
    Ok(plot.svg(SIZE))
}
