//! A finished frame: as a picture, compared with a second frame, as a digest.

use rayon::prelude::*;
use roughxel_assets::picture::{self, Picture};
use sha2::{Digest, Sha256};

use super::Colour;

/// A colour in linear light, rounded once.
fn linear(colour: Colour) -> [f32; 3] {
    colour.map(|channel| (f64::from(channel) / f64::from(1 << 24)) as f32)
}

/// A finished frame, rows top to bottom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear colours, I8F24.
    pub pixels: Vec<Colour>,
}

impl Frame {
    /// Most bytes of memory at a time for each pixel of a frame that becomes a file. Drawing takes 12 for the colour and ¼ for
    /// the list of tile rows. Encoding takes 12 and the 3 of [`Self::srgb_codes`]. Writing takes 3 without the frame, and at most
    /// 3 for the compressed data. The scene, its maps and about one MiB a thread come in addition.
    pub const BYTES_A_PIXEL: u64 = 15;

    /// The frame in linear light.
    pub fn picture(&self) -> Picture {
        Picture {
            width: self.width,
            height: self.height,
            pixels: self.pixels.par_iter().copied().map(linear).collect(),
        }
    }

    /// The frame as sRGB codes, three a pixel: the codes of [`Self::picture`], without holding that picture.
    pub fn srgb_codes(&self) -> Vec<u8> {
        picture::srgb_codes(&self.pixels, |pixel| linear(*pixel))
    }

    /// Peak signal-to-noise ratio against a frame of the same size, dB: linear light, range 1, all channels, colours clamped to
    /// [0, 1] as on a display. Equal frames give infinity, frames of different sizes NaN.
    pub fn psnr(&self, truth: &Self) -> f64 {
        if (self.width, self.height) != (truth.width, truth.height) {
            return f64::NAN;
        }
        let display = |channel: i32| f64::from(channel.clamp(0, 1 << 24)) / f64::from(1 << 24);
        let channels = self.pixels.iter().flatten().zip(truth.pixels.iter().flatten());
        let sum: f64 = channels.map(|(&a, &b)| (display(a) - display(b)).powi(2)).sum();
        -10.0 * (sum / (3 * self.pixels.len()) as f64).log10()
    }

    /// SHA-256 over size and pixels (big-endian words): equal if and only if every bit of the frames is equal.
    pub fn digest(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(self.width.to_be_bytes());
        hash.update(self.height.to_be_bytes());
        for channel in self.pixels.iter().flatten() {
            hash.update(channel.to_be_bytes());
        }
        hash.finalize().iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
    }
}
