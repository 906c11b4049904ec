//! Pictures in host memory and their files.
//!
//! [`read`] takes a file of any kind and gives the picture with a [`Statement`]: the words of the file about itself, and the decisions made of them.
//! `kind` finds the kind by the first bytes; a module for each kind reads it; `colour` undoes transfer functions and converts primaries. Alpha is
//! ignored, not composited: data maps keep other values in it, and a texture has no background here. Sizes are checked from the header, before
//! memory is taken. sRGB uses the exact piecewise curve by correctly rounded operations only, so the pixels are the same bits on every machine. A
//! file is written next to its name and renamed when complete.

mod codes;
mod colour;
mod colour_words;
mod compare;
mod cube_file;
mod decoded;
mod exr_choice;
mod exr_file;
mod exr_words;
mod hdr_file;
mod icc;
mod icc_curve;
mod jpeg_file;
mod jpeg_words;
mod kind;
mod normals;
mod orientation;
mod png_file;
mod png_words;
mod read;
mod srgb;
mod statement;
mod texels;
mod texture;
mod texture_file;
mod tiff_file;
mod webp_file;

pub use colour::{ColourSpace, Transfer};
pub use compare::{DIFFERENCE_GAIN, difference, ssim};
pub use cube_file::{CubeFile, is_cube_file, read_cube};
pub use kind::Kind;
pub use png_file::{Samples, encode_png, srgb_codes, write_png_codes, write_png_srgb};
pub use read::{read, read_bytes};
pub use srgb::{linear_to_srgb8, srgb_to_linear};
pub use statement::{Envmap, PictureFile, Purpose, Rectangle, Said, Statement, Window, Windows, Wishes};

use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;

use roughxel_utilities::input::open_file;

/// Longest edge of an input picture, in pixels.
pub const MAX_EDGE: u32 = 16384;

/// Most pixels of an input picture.
pub const MAX_PIXELS: u64 = 1 << 26;

/// A picture in linear light, or the raw values of a data map.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// Red, green, blue; `width · height` of them, rows from top to bottom.
    pub pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// A picture of one colour.
    pub fn filled(width: u32, height: u32, colour: [f32; 3]) -> Self {
        Self { width, height, pixels: vec![colour; width as usize * height as usize] }
    }

    /// The pixel in column `x` and row `y` from the top.
    ///
    /// # Panics
    /// If the pixel lies outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [f32; 3] {
        self.pixels[y as usize * self.width as usize + x as usize]
    }
}

/// Reason why a picture could not be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{message}; {remedy}")]
pub struct PictureError {
    /// The file and its mistake.
    pub message: String,
    /// The remedy.
    pub remedy: String,
    /// Error of the system.
    pub source: Option<io::Error>,
}

impl PictureError {
    fn new(message: String, remedy: impl Into<String>) -> Self {
        Self { message, remedy: remedy.into(), source: None }
    }

    /// An error for a file that cannot be opened.
    pub fn open(path: &Path, source: io::Error) -> Self {
        let message = format!("cannot open picture `{}`: {source}", path.display());
        Self { source: Some(source), ..Self::new(message, "check the path and its permissions") }
    }

    /// An error for a file that cannot be written.
    fn write(path: &Path, source: io::Error) -> Self {
        let message = format!("cannot write picture `{}`: {source}", path.display());
        Self { source: Some(source), ..Self::new(message, "check that its directory exists and may be written") }
    }

    /// An error for a file that is damaged or truncated.
    fn damaged(path: &Path, format: &str, reason: impl Display) -> Self {
        let message = format!("`{}` is not a readable {format} file: {reason}", path.display());
        Self::new(message, format!("export it again as {format}"))
    }

    /// An error for a valid file of an unsupported kind.
    fn unsupported(path: &Path, reason: impl Display, remedy: &str) -> Self {
        Self::new(format!("`{}` {reason}", path.display()), format!("export it as {remedy}"))
    }

    /// True if there is no file of that name.
    pub fn is_missing(&self) -> bool {
        self.source.as_ref().is_some_and(|source| source.kind() == io::ErrorKind::NotFound)
    }
}

fn open(path: &Path) -> Result<BufReader<File>, PictureError> {
    open_file(path).map(BufReader::new).map_err(|source| PictureError::open(path, source))
}

/// Checks a size from a header against the limits.
fn check_size(path: &Path, width: u64, height: u64) -> Result<(u32, u32), PictureError> {
    let edge = |size: u64| u32::try_from(size).ok().filter(|size| *size <= MAX_EDGE);
    match (edge(width), edge(height)) {
        (Some(w), Some(h)) if width * height <= MAX_PIXELS => Ok((w, h)),
        _ => Err(PictureError::new(
            format!(
                "picture `{}` has {width}×{height} pixels; at most {MAX_EDGE} an edge and {MAX_PIXELS} in all are read",
                path.display()
            ),
            "scale it down",
        )),
    }
}

/// Refuses pixels that are not finite or missing (NaN).
fn check_finite(path: &Path, pixels: &[[f32; 3]], width: u32) -> Result<(), PictureError> {
    for (index, pixel) in pixels.iter().enumerate() {
        if let Some(value) = pixel.iter().find(|value| !value.is_finite()) {
            let (path, x, y) = (path.display(), index % width as usize, index / width as usize);
            let message = format!("`{path}` has the value {value} at pixel ({x}, {y}), counted from the top left");
            return Err(PictureError::new(message, "clamp it to finite values"));
        }
    }
    Ok(())
}

/// Pixels between two pictures in a row of [`beside`].
const GUTTER_PX: u32 = 8;

/// Pictures in a row from left to right, tops aligned, on black, 8 pixels apart.
///
/// No picture gives a result of 0×0 pixels, which cannot be written.
pub fn beside(pictures: &[&Picture]) -> Picture {
    let gutters = GUTTER_PX * pictures.len().saturating_sub(1) as u32;
    let width = pictures.iter().map(|picture| picture.width).sum::<u32>() + gutters;
    let height = pictures.iter().map(|picture| picture.height).max().unwrap_or(0);
    let mut row = Picture::filled(width, height, [0.0; 3]);
    let mut left = 0;
    for picture in pictures {
        let columns = picture.width as usize;
        for (line, pixels) in row.pixels.chunks_exact_mut(width as usize).zip(picture.pixels.chunks_exact(columns)) {
            line[left..left + columns].copy_from_slice(pixels);
        }
        left += columns + GUTTER_PX as usize;
    }
    row
}
