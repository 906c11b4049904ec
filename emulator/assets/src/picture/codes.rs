//! Pixels from integer codes.

use super::colour::Transfer;
use super::statement::Statement;

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

/// Names grey, colours and alpha in a statement: 1, 2, 3 or 4 channels.
pub(super) fn name_channels(channels: usize, statement: &mut Statement) {
    let names: &[&str] = if channels >= 3 { &["R", "G", "B"] } else { &["Y"] };
    statement.channels = names.iter().map(ToString::to_string).collect();
    if channels.is_multiple_of(2) {
        statement.left.push("A".to_owned());
    }
}
