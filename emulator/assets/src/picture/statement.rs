//! Words of a picture file about itself, and the decisions that reading makes of them.

use std::fmt;

use serde::Serialize;

use super::Picture;
use super::colour::{ColourSpace, Transfer};

/// Use of a picture, which decides how its file is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// Colours of a surface.
    Colours,
    /// Light from all directions.
    Environment,
    /// Heights: one number a pixel, taken as it is.
    Heights,
    /// Tangent-space normals, taken as they are.
    Normals,
    /// Other numbers, taken as they are.
    Data,
}

impl Purpose {
    /// True for light, whose colour space and transfer function count; false for numbers that are taken as they are.
    pub fn is_light(self) -> bool {
        matches!(self, Self::Colours | Self::Environment)
    }
}

/// Rectangle of an OpenEXR file that becomes the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Window {
    /// The picture as it is meant to be seen; black outside of the data window.
    #[default]
    Display,
    /// The pixels that the file holds.
    Data,
}

impl Window {
    /// Words of the key `window`.
    pub const WORDS: [(&'static str, Self); 2] = [("display", Self::Display), ("data", Self::Data)];
}

/// Decisions of a user against the words of a file. `None` leaves a decision to the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wishes {
    /// Part, layer or channel to take (key `layer`).
    pub layer: Option<String>,
    /// Colour space of the file (key `colour_space`).
    pub colour_space: Option<ColourSpace>,
    /// Transfer function of the file (key `transfer`).
    pub transfer: Option<Transfer>,
    /// Rectangle to take (key `window`).
    pub window: Option<Window>,
    /// True if the components of a normal map run from −1 to 1, false if they are coded from 0 to 1 (key `signed`).
    pub signed: Option<bool>,
}

/// Projection of a panorama, as an OpenEXR file says it (`envmap`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Envmap {
    /// Longitude and latitude.
    Latlong,
    /// Six faces, one under the other.
    Cube,
}

/// Rectangle in the coordinates of an OpenEXR file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Rectangle {
    /// Column and row of the top left pixel.
    pub origin: [i32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

/// Rectangles that an OpenEXR file names, and the one that was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Windows {
    /// Pixels that the file holds.
    pub data: Rectangle,
    /// Pixels that are meant to be seen.
    pub display: Rectangle,
    /// Rectangle that became the picture.
    pub used: Window,
}

/// Words of a file and the decision made of them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Said {
    /// Words of the file; `None` if it says nothing.
    pub said: Option<String>,
    /// Decision.
    pub used: String,
}

/// Words of a picture file about itself, and the decisions made of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Statement {
    /// Name of the kind of the file.
    pub kind: String,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Part or layer that was taken, if the file names it.
    pub layer: Option<String>,
    /// Channels that were taken, in the order of the picture.
    pub channels: Vec<String>,
    /// Channels that were not taken.
    pub left: Vec<String>,
    /// Rectangles of an OpenEXR file.
    pub windows: Option<Windows>,
    /// Primaries and white; `None` for numbers that are no light.
    pub colour_space: Option<Said>,
    /// Transfer function; `None` for numbers that are no light.
    pub transfer: Option<Said>,
    /// Exposure that a file says was applied to its pixels, a factor. It is not undone.
    pub exposure: Option<f64>,
    /// Projection of a panorama.
    pub envmap: Option<Envmap>,
    /// True if the components of a normal map run from −1 to 1 in the picture; `None` for other pictures.
    pub signed: Option<bool>,
    /// Decisions that the file does not tell in words, one sentence each.
    pub notes: Vec<String>,
    /// Words of the file that have no effect, one sentence each.
    pub ignored: Vec<String>,
    /// Decisions that may be wrong, one sentence each with the key that decides otherwise.
    pub warnings: Vec<String>,
}

impl fmt::Display for Statement {
    /// Writes kind, size and decisions in one line.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}, {}×{}", self.kind, self.size[0], self.size[1])?;
        if let Some(layer) = &self.layer {
            write!(out, ", layer `{layer}`")?;
        }
        if !self.channels.is_empty() {
            write!(out, ", channels {}", self.channels.join(" "))?;
        }
        if let Some(Windows { data, display, used }) = self.windows
            && data != display
        {
            write!(out, ", {} window", if used == Window::Display { "display" } else { "data" })?;
        }
        for said in [&self.colour_space, &self.transfer].into_iter().flatten() {
            write!(out, ", {}", said.used)?;
        }
        if self.signed == Some(true) {
            out.write_str(", signed")?;
        }
        Ok(())
    }
}

/// A picture with the statement of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFile {
    /// The picture, in linear light or as the raw values of a data map.
    pub picture: Picture,
    /// Words of the file, and decisions.
    pub statement: Statement,
}
