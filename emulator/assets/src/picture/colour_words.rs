//! Decisions about colours, by the words of a file and by wishes.

use glam::{DMat3, DVec3};

use super::colour::{ColourSpace, Primaries, REC_709, Transfer};
use super::statement::{Purpose, Said, Statement, Wishes};

/// Words of a file about its colours.
pub(super) struct ColourWords {
    /// Primaries with the words that tell them.
    pub(super) space: Option<(String, Primaries)>,
    /// Transfer function with the words that tell it.
    pub(super) transfer: Option<(String, Transfer)>,
    /// Transfer function of files that say nothing.
    pub(super) default: Transfer,
    /// Doubts about the words, one sentence each. Numbers of a data map have none.
    pub(super) warnings: Vec<String>,
}

/// Decision about the colours of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colours {
    /// Transfer function to undo.
    pub(super) transfer: Transfer,
    /// Matrix to linear Rec. 709, if the colours are others.
    pub(super) matrix: Option<DMat3>,
}

impl ColourWords {
    /// Words of a file that says nothing.
    pub(super) fn new(default: Transfer) -> Self {
        Self { space: None, transfer: None, default, warnings: Vec::new() }
    }

    /// Decides by the words of the file and the wishes, and writes both into the statement.
    pub(super) fn decide(self, purpose: Purpose, wishes: &Wishes, statement: &mut Statement) -> Colours {
        if !purpose.is_light() {
            for (said, what) in [
                (self.space.filter(|(_, own)| !own.is_near(&REC_709)).map(|(said, _)| said), "colour space"),
                (
                    self.transfer.filter(|(_, said)| *said != Transfer::Linear).map(|(said, _)| said),
                    "transfer function",
                ),
            ] {
                statement.ignored.extend(said.map(|said| {
                    format!(
                        "{said}: a {what} has no meaning for the numbers of a data map, which are taken as they are"
                    )
                }));
            }
            return Colours { transfer: Transfer::Linear, matrix: None };
        }
        statement.warnings.extend(self.warnings);
        let (said, own) = self.space.unzip();
        let wished = wishes.colour_space.map(ColourSpace::primaries);
        let converted = match wished.unwrap_or(own).map(|primaries| (primaries.name(), primaries.to_rec_709())) {
            None => Ok(("Rec. 709".to_owned(), None)),
            Some((name, Some(None))) => Ok((name, None)),
            Some((name, Some(matrix))) => Ok((format!("{name}, converted to Rec. 709"), matrix)),
            Some((name, None)) => Err(name),
        };
        let (used, matrix) = converted.unwrap_or_else(|name| {
            let why = "span no colour space; the colours are read as Rec. 709";
            statement.warnings.push(format!("the primaries {name} {why} (`colour_space` decides otherwise)"));
            ("Rec. 709".to_owned(), None)
        });
        statement.colour_space = Some(Said { said, used });
        let (said, own) = self.transfer.unzip();
        let transfer = wishes.transfer.or(own).unwrap_or(self.default);
        statement.transfer = Some(Said { said, used: transfer.name() });
        Colours { transfer, matrix }
    }
}

impl Colours {
    /// Undoes the transfer function of floats, and converts.
    pub(super) fn decode_floats(&self, pixels: &mut [[f32; 3]]) {
        if self.transfer != Transfer::Linear {
            for channel in pixels.iter_mut().flatten() {
                *channel = self.transfer.decode(f64::from(*channel)) as f32;
            }
        }
        self.convert(pixels);
    }

    /// Converts linear light to Rec. 709.
    pub(super) fn convert(&self, pixels: &mut [[f32; 3]]) {
        let Some(matrix) = self.matrix else { return };
        for pixel in pixels {
            *pixel = (matrix * DVec3::from_array(pixel.map(f64::from))).to_array().map(|channel| channel as f32);
        }
    }
}
