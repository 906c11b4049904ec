//! Pictures compared as a display shows them: structural similarity, and pictures of the difference.
//!
//! SSIM is that of Wang, Bovik, Sheikh and Simoncelli (IEEE Transactions on Image Processing 13(4), 2004): a Gaussian window of 11×11
//! pixels with σ = 1.5, K₁ = 0.01, K₂ = 0.03. The result is the mean over all places where the window lies inside, without prior
//! downscaling. It is taken of the displayed grey: luminance of the colours clamped to [0, 1], as an 8-bit sRGB code. The constants
//! are made for such codes; in linear light dark regions would count for nothing.

use super::{Picture, linear_to_srgb8, srgb_to_linear};

/// Edge of the window of [`ssim`] in pixels.
const WINDOW_PX: usize = 11;
/// Standard deviation of the window in pixels.
const WINDOW_SIGMA_PX: f64 = 1.5;
/// Largest code.
const RANGE: f64 = 255.0;
/// K₁² · range² and K₂² · range².
const STABILISERS: [f64; 2] = [(0.01 * RANGE) * (0.01 * RANGE), (0.03 * RANGE) * (0.03 * RANGE)];
/// Shares of red, green and blue in the luminance (ITU-R BT.709, the primaries of sRGB).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Gain of errors in [`difference`].
pub const DIFFERENCE_GAIN: i32 = 4;

/// Mean structural similarity of two pictures in linear light, −1 to 1, 1 for equal ones; symmetric.
///
/// `None` for pictures of different size, or with an edge of less than 11 pixels.
pub fn ssim(a: &Picture, b: &Picture) -> Option<f64> {
    let (width, height) = (a.width as usize, a.height as usize);
    if (a.width, a.height) != (b.width, b.height) || width < WINDOW_PX || height < WINDOW_PX {
        return None;
    }
    let (a, b) = (grey(a), grey(b));
    let mean = |value: fn(f64, f64) -> f64| {
        let values: Vec<f64> = a.iter().zip(&b).map(|(&a, &b)| value(a, b)).collect();
        windowed(&values, width)
    };
    let (mean_a, mean_b) = (mean(|a, _| a), mean(|_, b| b));
    let (square_a, square_b, product) = (mean(|a, _| a * a), mean(|_, b| b * b), mean(|a, b| a * b));
    let [c1, c2] = STABILISERS;
    let places = mean_a.len();
    let sum: f64 = (0..places)
        .map(|i| {
            let (a, b) = (mean_a[i], mean_b[i]);
            let (variance_a, variance_b, covariance) = (square_a[i] - a * a, square_b[i] - b * b, product[i] - a * b);
            (2.0 * (a * b) + c1) * (2.0 * covariance + c2) / ((a * a + b * b + c1) * ((variance_a + variance_b) + c2))
        })
        .sum();
    Some(sum / places as f64)
}

/// sRGB codes of the luminance, 0 to 255.
fn grey(picture: &Picture) -> Vec<f64> {
    let luminance = |pixel: &[f32; 3]| pixel.iter().zip(LUMINANCE).map(|(c, share)| c.clamp(0.0, 1.0) * share).sum();
    picture.pixels.iter().map(|pixel| f64::from(linear_to_srgb8(luminance(pixel)))).collect()
}

/// Weighted means of all windows inside a picture of `width` columns, row by row.
fn windowed(values: &[f64], width: usize) -> Vec<f64> {
    let centre = (WINDOW_PX / 2) as f64;
    let bell: [f64; WINDOW_PX] =
        std::array::from_fn(|i| (-(i as f64 - centre).powi(2) / (2.0 * WINDOW_SIGMA_PX * WINDOW_SIGMA_PX)).exp());
    let total: f64 = bell.iter().sum();
    let weights = bell.map(|weight| weight / total);
    let columns = width + 1 - WINDOW_PX;
    let rows: Vec<f64> = values
        .chunks_exact(width)
        .flat_map(|row| row.windows(WINDOW_PX).map(|span| span.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>()))
        .collect();
    let last = rows.len() - (WINDOW_PX - 1) * columns;
    (0..last).map(|first| (0..WINDOW_PX).map(|i| rows[first + i * columns] * weights[i]).sum()).collect()
}

/// Signed error of `picture` against `truth`, a picture of equal size: per channel 128 + 4 (code − true code), in 8-bit sRGB
/// codes, clamped to 0…255. Grey means equal, lighter means too bright; an error of 32 codes saturates.
///
/// `None` for pictures of different size.
pub fn difference(picture: &Picture, truth: &Picture) -> Option<Picture> {
    if (picture.width, picture.height) != (truth.width, truth.height) {
        return None;
    }
    let channel = |a: f32, b: f32| {
        let error = i32::from(linear_to_srgb8(a)) - i32::from(linear_to_srgb8(b));
        srgb_to_linear(f64::from(128 + DIFFERENCE_GAIN * error) / RANGE) as f32
    };
    let pixels = picture.pixels.iter().zip(&truth.pixels);
    let pixels = pixels.map(|(a, b)| std::array::from_fn(|i| channel(a[i], b[i])));
    Some(Picture { width: picture.width, height: picture.height, pixels: pixels.collect() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use roughxel_utilities::random::SplitMix64;

    /// A picture of grey sRGB codes.
    fn codes(width: u32, height: u32, code: impl Fn(u32, u32) -> u8) -> Picture {
        let grey = |i: u32| [srgb_to_linear(f64::from(code(i % width, i / width)) / 255.0) as f32; 3];
        Picture { width, height, pixels: (0..width * height).map(grey).collect() }
    }

    fn noise(seed: u64) -> Picture {
        let mut random = SplitMix64::new(seed);
        let noise: Vec<u8> = (0..23 * 17).map(|_| random.below(256) as u8).collect();
        codes(23, 17, |x, y| noise[(y * 23 + x) as usize])
    }

    #[test]
    fn similarity_of_equal_pictures_is_1_and_of_any_two_the_same_both_ways() {
        let (a, b) = (noise(1), noise(2));
        assert_eq!(ssim(&a, &a), Some(1.0));
        let similarity = ssim(&a, &b).unwrap();
        assert_eq!(ssim(&b, &a), Some(similarity));
        assert!(similarity.abs() < 0.2, "{similarity}");
    }

    #[test]
    fn similarity_of_flat_pictures_is_that_of_their_means() {
        let (a, b) = (codes(12, 30, |_, _| 60), codes(12, 30, |_, _| 200));
        let c1 = 6.5025;
        let expected = (2.0 * 60.0 * 200.0 + c1) / (60.0 * 60.0 + 200.0 * 200.0 + c1);
        assert!((ssim(&a, &b).unwrap() - expected).abs() < 1e-9);
    }

    #[test]
    fn one_window_weighs_its_pixels_by_the_bell() {
        // One window position: the weight of the bright pixel is w, so the mean is w·255, the variance w (1 − w)·255²,
        // against black.
        let black = codes(11, 11, |_, _| 0);
        let total: f64 = (-5..=5).map(|i: i32| (-f64::from(i * i) / 4.5).exp()).sum();
        for (place, distance_squared) in [((5, 5), 0.0), ((6, 5), 1.0), ((5, 2), 9.0), ((0, 0), 50.0)] {
            let dot = codes(11, 11, |x, y| if (x, y) == place { 255 } else { 0 });
            let weight = (-distance_squared / 4.5_f64).exp() / (total * total);
            let (mean, variance) = (weight * 255.0, weight * (1.0 - weight) * 255.0 * 255.0);
            let expected = 6.5025 * 58.5225 / ((mean * mean + 6.5025) * (variance + 58.5225));
            let found = ssim(&dot, &black).unwrap();
            assert!((found - expected).abs() < 1e-12, "{place:?}: {found}, {expected}");
        }
    }

    #[test]
    fn an_inverted_picture_is_less_than_dissimilar() {
        let a = noise(3);
        let inverted = Picture {
            pixels: a
                .pixels
                .iter()
                .map(|p| [srgb_to_linear(1.0 - f64::from(linear_to_srgb8(p[0])) / 255.0) as f32; 3])
                .collect(),
            ..a.clone()
        };
        assert!(ssim(&a, &inverted).unwrap() < -0.8);
    }

    #[test]
    fn pictures_without_a_window_or_of_two_sizes_have_no_similarity() {
        assert_eq!(ssim(&codes(10, 40, |_, _| 0), &codes(10, 40, |_, _| 0)), None);
        assert_eq!(ssim(&codes(40, 12, |_, _| 0), &codes(12, 40, |_, _| 0)), None);
        assert_eq!(difference(&codes(40, 12, |_, _| 0), &codes(12, 40, |_, _| 0)), None);
    }

    #[test]
    fn a_display_cuts_before_pictures_are_compared() {
        let (white, sun) = (Picture::filled(11, 11, [1.0; 3]), Picture::filled(11, 11, [40.0; 3]));
        assert_eq!(ssim(&white, &sun), Some(1.0));
        assert_eq!(difference(&sun, &white), Some(Picture::filled(11, 11, [srgb_to_linear(128.0 / 255.0) as f32; 3])));
    }

    #[test]
    fn differences_are_signed_and_enlarged_around_grey() {
        let code_of = |a: u8, b: u8| {
            let shown = difference(&codes(1, 1, |_, _| a), &codes(1, 1, |_, _| b)).unwrap();
            linear_to_srgb8(shown.pixels[0][1])
        };
        assert_eq!([code_of(9, 9), code_of(12, 10), code_of(100, 103)], [128, 136, 116]);
        assert_eq!([code_of(255, 0), code_of(0, 255)], [255, 0]);
    }
}
