//! Pixels from integer codes.

use super::Picture;
use super::colour::Transfer;
use super::colour_words::ColourWords;
use super::decoded::Decoded;
use super::icc::profile_words;
use super::statement::{Purpose, Statement, Wishes};

/// Pixels from packed samples, `stride` of them a pixel: channels 0, 1, 2, or channel 0 three times if there are fewer than three.
pub(super) fn collect_pixels<T>(
    samples: &[T],
    stride: usize,
    channels: usize,
    sample: impl Fn(&[T], usize) -> f32,
) -> Vec<[f32; 3]> {
    samples
        .chunks_exact(stride)
        .map(
            |pixel| {
                if channels >= 3 {
                    [sample(pixel, 0), sample(pixel, 1), sample(pixel, 2)]
                } else {
                    [sample(pixel, 0); 3]
                }
            },
        )
        .collect()
}

/// Value of every code 0…`largest`.
pub(super) fn decode_table(largest: u32, transfer: Transfer) -> Vec<f32> {
    (0..=largest).map(|code| transfer.decode(f64::from(code) / f64::from(largest)) as f32).collect()
}

/// Channels without alpha: 3 or 1.
pub(super) fn colours_of(channels: usize) -> usize {
    if channels >= 3 { 3 } else { 1 }
}

/// Names alpha that is multiplied in.
pub(super) fn name_multiplied_alpha(statement: &mut Statement) {
    statement.notes.push("alpha is multiplied in: transparent places stay dark".to_owned());
}

/// Names grey, colours and alpha in a statement: 1, 2, 3 or 4 channels.
pub(super) fn name_channels(channels: usize, statement: &mut Statement) {
    let names: &[&str] = if channels >= 3 { &["R", "G", "B"] } else { &["Y"] };
    statement.channels = names.iter().map(ToString::to_string).collect();
    if channels.is_multiple_of(2) {
        statement.left.push("A".to_owned());
    }
}

/// Codes of 8 bits and their ICC profile, as a decoder gives them.
pub(super) struct Codes8 {
    pub(super) size: [u32; 2],
    /// Channels of a pixel, alpha included.
    pub(super) channels: usize,
    pub(super) codes: Vec<u8>,
    pub(super) profile: Option<Vec<u8>>,
}

impl Codes8 {
    /// The picture: sRGB, or as the profile says.
    pub(super) fn decode(&self, purpose: Purpose, wishes: &Wishes) -> Decoded {
        let Self { size: [width, height], channels, .. } = *self;
        let mut statement = Statement::default();
        name_channels(channels, &mut statement);
        let mut words = ColourWords::new(Transfer::Srgb);
        if let Some(profile) = &self.profile {
            profile_words(profile, "ICC profile", &mut words);
        }
        let colours = words.decide(purpose, wishes, &mut statement);
        let table = decode_table(255, colours.transfer);
        let mut pixels =
            collect_pixels(&self.codes, channels, channels, |pixel, index| table[usize::from(pixel[index])]);
        colours.convert(&mut pixels);
        let picture = Picture { width, height, pixels };
        Decoded { picture, statement, largest_code: Some(255), channels: colours_of(channels) }
    }
}
