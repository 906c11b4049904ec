//! Roughness maps of a scene: detail too fine for its bump map, or for any (S97 §8).

use super::bump::signed_decoder;
use roughxel_assets::Picture;

/// Largest standard deviation of a roughness map: the ports hold values below 8, and bumps are added.
pub(super) const MAX_DEVIATION: f64 = 4.0;

/// Factors D = (d₁, d₂; 0, d₃) of the covariance K = D Dᵀ of the offsets that a surface has in addition to its bumps.
/// Row 0 is at v = 0 (the bottom row of the picture); repeat addressing.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughnessField {
    /// Texels along u.
    pub width: u32,
    /// Texels along v.
    pub height: u32,
    /// (d₁, d₂, d₃) row by row, relative to |n|: d₁ and d₃ within 0…4, d₂ within ±4.
    pub factors: Vec<[f32; 3]>,
}

/// Meaning of the channels of a roughness picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RoughnessChannels {
    /// Red is the standard deviation in every direction, I₁.
    Isotropic,
    /// Red d₁, green d₂ (grey is 0), blue d₃.
    Anisotropic,
}

impl RoughnessField {
    /// True if no texel is rough.
    pub fn is_smooth(&self) -> bool {
        self.factors.iter().all(|factor| *factor == [0.0; 3])
    }

    /// One texel for the whole surface.
    pub(super) fn uniform(factor: [f64; 3]) -> Self {
        Self { width: 1, height: 1, factors: vec![factor.map(|d| d as f32)] }
    }

    /// Factors of a picture whose white is `deviation`, and how many texels were out of range.
    pub(super) fn from_picture(picture: &Picture, channels: RoughnessChannels, deviation: f64) -> (Self, usize) {
        let signed = signed_decoder(picture);
        let (deviation, limit) = (deviation as f32, MAX_DEVIATION as f32);
        let mut clamped = 0;
        let width = picture.width as usize;
        let factors = picture.pixels.rchunks(width).flatten().map(|&[red, green, blue]| {
            let factor = match channels {
                RoughnessChannels::Isotropic => [red, 0.0, red],
                RoughnessChannels::Anisotropic => [red, signed(green), blue],
            };
            let [d1, d2, d3] = factor.map(|d| d * deviation);
            // `max` and `min` take a NaN to the lower end.
            let inside = [d1.max(0.0).min(limit), d2.max(-limit).min(limit), d3.max(0.0).min(limit)];
            clamped += usize::from(inside != [d1, d2, d3]);
            inside
        });
        let factors = factors.collect();
        (Self { width: picture.width, height: picture.height, factors }, clamped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(pixels: &[[f32; 3]]) -> Picture {
        Picture { width: 1, height: pixels.len() as u32, pixels: pixels.to_vec() }
    }

    #[test]
    fn red_alone_is_the_deviation_in_every_direction_and_v_runs_up() {
        let map = picture(&[[0.5, 0.9, 0.1], [1.0, 0.0, 0.0]]);
        let (field, clamped) = RoughnessField::from_picture(&map, RoughnessChannels::Isotropic, 0.5);
        assert_eq!((field.factors, clamped), (vec![[0.5, 0.0, 0.5], [0.25, 0.0, 0.25]], 0));
    }

    #[test]
    fn three_channels_are_d1_d2_d3_with_grey_for_no_correlation() {
        let neutral = [1.0, 128.0 / 255.0, 0.0];
        let map = picture(&[neutral, [0.0, 1.0, 1.0]]);
        let (field, clamped) = RoughnessField::from_picture(&map, RoughnessChannels::Anisotropic, 2.0);
        assert_eq!((field.factors, clamped), (vec![[0.0, 2.0, 2.0], [2.0, 0.0, 0.0]], 0));
    }

    #[test]
    fn factors_out_of_range_are_clamped_and_counted() {
        let map = picture(&[[9.0, 0.5, f32::NAN], [-1.0, 0.5, 1.0], [1.0, 0.5, 1.0]]);
        let (field, clamped) = RoughnessField::from_picture(&map, RoughnessChannels::Anisotropic, 1.0);
        assert_eq!((field.factors[2], field.factors[1], clamped), ([4.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2));
    }
}
