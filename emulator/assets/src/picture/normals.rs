//! Components of normal maps: coded or signed, two or three.

use std::path::Path;

use super::PictureError;
use super::decoded::Decoded;
use super::statement::Wishes;

/// Largest difference of the length of a normal from 1 that rounding explains: three 8-bit codes.
const LENGTH_ERROR: f64 = 0.02;

/// Blues that programs write into maps of two channels: 0, half and 1, in codes or floats.
const FILLERS: [f32; 3] = [0.0, 0.5, 1.0];
/// Largest difference of a blue from such a filler: one 8-bit code.
const FILLER_ERROR: f32 = 0.004;

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Decides the coding of a normal map, and gives a map of two channels its third.
///
/// Floats below 0 tell signed components, −1 to 1. Without any, the coding whose vectors are closer to unit length is taken. If blue is
/// missing, or 0, half or 1 everywhere and no part of a unit normal, z is √(1 − x² − y²); the picture becomes signed.
///
/// # Errors
/// A grey picture; the wish `signed` for integer codes.
pub(super) fn settle(path: &Path, read: &mut Decoded, wishes: &Wishes) -> Result<(), PictureError> {
    let pixels = &mut read.picture.pixels;
    if read.channels == 1 || pixels.iter().all(|[r, g, b]| r == g && g == b) {
        let message = format!("`{}` is grey: a normal map has a red, a green and a blue channel", path.display());
        return Err(PictureError::new(message, "use it as `height_map`, or export normals in tangent space"));
    }
    let is_float = read.largest_code.is_none();
    if !is_float && wishes.signed == Some(true) {
        let message = format!("`{}` holds integer codes from 0, which are not signed", path.display());
        return Err(PictureError::new(message, "leave `signed` out"));
    }
    let statement = &mut read.statement;
    let decide = "(`signed` decides otherwise)";
    let signed_by_lengths = || {
        let error = |decode: fn(f32) -> f64| -> f64 {
            pixels.iter().map(|pixel| (length(pixel.map(decode)) - 1.0).abs()).sum()
        };
        error(f64::from) < error(|v| 2.0 * f64::from(v) - 1.0)
    };
    let mut signed = match wishes.signed {
        Some(signed) => signed,
        None if !is_float => false,
        None if read.channels == 3 => {
            let is_signed = signed_by_lengths();
            if is_signed {
                statement
                    .notes
                    .push(format!("vectors have unit length as they are: normals are signed, −1 to 1 {decide}"));
            }
            is_signed
        }
        None => {
            let is_signed = pixels.iter().flatten().any(|component| *component < 0.0);
            if is_signed {
                statement.notes.push(format!("components below 0: normals are signed, −1 to 1 {decide}"));
            }
            is_signed
        }
    };
    let is_8_bit = read.largest_code == Some(255);
    let decode = |value: f32| match (signed, is_8_bit) {
        (true, _) => f64::from(value),
        (false, true) => ((f64::from(value) * 255.0).round() - 128.0) / 127.0,
        (false, false) => 2.0 * f64::from(value) - 1.0,
    };
    let blue = pixels[0][2];
    let is_constant = FILLERS.iter().any(|filler| (blue - filler).abs() <= FILLER_ERROR)
        && pixels.iter().all(|pixel| pixel[2] == blue);
    let is_off = |pixel: &[f32; 3]| (length(pixel.map(decode)) - 1.0).abs() > LENGTH_ERROR;
    let fits = |pixel: &[f32; 3]| {
        let [x, y, _] = pixel.map(decode);
        length([x, y, 0.0]) <= 1.0 + LENGTH_ERROR
    };
    if read.channels == 2 || (is_constant && pixels.iter().any(is_off) && pixels.iter().all(fits)) {
        for pixel in pixels.iter_mut() {
            let [x, y, _] = pixel.map(decode);
            let z = (1.0 - x * x - y * y).max(0.0).sqrt();
            *pixel = [x, y, z].map(|component| component as f32);
        }
        let why = if read.channels == 2 { "there is no third channel" } else { "blue is the same everywhere" };
        statement.notes.push(format!("{why}: z is √(1 − x² − y²)"));
        if read.channels == 3 {
            statement.left.extend(statement.channels.pop());
        }
        signed = true;
    }
    statement.signed = Some(signed);
    Ok(())
}
