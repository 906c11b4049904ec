//! Light of pictures: exposure, and the light that their storage clamps.

use roughxel_assets::Picture;
use roughxel_utilities::exp2::exp2;
use roughxel_utilities::limits::{BRIGHTEST_COLOUR, BRIGHTEST_ENVIRONMENT};

/// Multiplies all pixels by 2^`stops`, within the finite numbers.
pub(super) fn expose(faces: &mut [Picture; 6], stops: f64) {
    if stops == 0.0 {
        return;
    }
    let factor = exp2(stops);
    for channel in faces.iter_mut().flat_map(|face| &mut face.pixels).flatten() {
        *channel = (f64::from(*channel) * factor).clamp(f32::MIN.into(), f32::MAX.into()) as f32;
    }
}

/// Light that is too bright, light below zero, and all light: magnitudes summed over all channels.
#[derive(Default)]
struct Light {
    above: f64,
    below: f64,
    all: f64,
}

impl Light {
    fn add(&mut self, pixel: [f32; 3], weight: f64, limit: f64) {
        for channel in pixel.map(f64::from) {
            self.above += weight * (channel - limit).max(0.0);
            self.below += weight * (-channel).max(0.0);
            self.all += weight * channel.abs();
        }
    }

    /// A sentence for each kind of clamped light.
    fn warnings(&self, name: &str, limit: f64, remedy: &str) -> Vec<String> {
        let share = |part: f64| match part / self.all * 100.0 {
            percent if percent < 0.01 => "less than 0.01 %".to_owned(),
            percent => format!("{percent:.2} %"),
        };
        let above = (self.above > 0.0).then(|| {
            format!("{name}: {} of the light is above {limit} × white and was cut{remedy}", share(self.above))
        });
        let below =
            (self.below > 0.0).then(|| format!("{name}: {} of the light is below 0 and was cut", share(self.below)));
        above.into_iter().chain(below).collect()
    }
}

/// Warnings for the clamped light of an environment, weighted by the solid angles of its texels.
pub(super) fn cut_environment(faces: &[Picture; 6]) -> Vec<String> {
    let mut light = Light::default();
    for face in faces {
        let centre = |index: usize| (2 * index + 1) as f64 / f64::from(face.width) - 1.0;
        let columns: Vec<f64> = (0..face.width as usize).map(|column| centre(column).powi(2)).collect();
        for (row, line) in face.pixels.chunks_exact(face.width as usize).enumerate() {
            let t = centre(row).powi(2);
            for (pixel, s) in line.iter().zip(&columns) {
                // A texel's solid angle over its area on the face, at its centre, is `square`^(−3/2).
                let square = 1.0 + s + t;
                light.add(*pixel, 1.0 / (square * square.sqrt()), BRIGHTEST_ENVIRONMENT);
            }
        }
    }
    light.warnings("environment", BRIGHTEST_ENVIRONMENT, "; choose a lower `exposure`")
}

/// Warnings for the clamped light of a colour map.
pub(super) fn cut_colour(name: &str, picture: &Picture) -> Vec<String> {
    let mut light = Light::default();
    picture.pixels.iter().for_each(|&pixel| light.add(pixel, 1.0, BRIGHTEST_COLOUR));
    light.warnings(name, BRIGHTEST_COLOUR, "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_is_in_stops_and_stays_finite() {
        let mut faces = [(); 6].map(|()| Picture::filled(1, 1, [1.0, -0.5, f32::MAX]));
        expose(&mut faces, 0.5);
        let [red, green, blue] = faces[3].pixels[0];
        assert_eq!((red, green, blue), (2_f32.sqrt(), -(0.5_f32.sqrt()), f32::MAX));
        expose(&mut faces, -0.5);
        assert!((faces[3].pixels[0][0] - 1.0).abs() < f32::EPSILON);
    }

    #[test]
    fn what_is_cut_is_a_share_of_the_light() {
        let dim = Picture::filled(2, 2, [1.0; 3]);
        let mut faces = [(); 6].map(|()| dim.clone());
        assert!(cut_environment(&faces).is_empty());
        // All texels of 2×2 have one solid angle: 24 · 3 of light, 1 of it below zero.
        faces[5].pixels[3] = [1.0, 1.0, -1.0];
        assert_eq!(cut_environment(&faces), ["environment: 1.39 % of the light is below 0 and was cut"]);
        // Twice the limit in one of 72 numbers: about half of the light.
        faces[5].pixels[3] = [1.0, 1.0, 2.0 * BRIGHTEST_ENVIRONMENT as f32];
        let warning = "50.00 % of the light is above 1048320 × white and was cut; choose a lower `exposure`";
        assert_eq!(cut_environment(&faces), [format!("environment: {warning}")]);
        // A texel covers more in the middle of a face than in a corner: (1 + 0 + 0) against (1 + 4/9 + 4/9).
        let mut faces = [(); 6].map(|()| Picture::filled(3, 3, [0.0; 3]));
        (faces[0].pixels[0], faces[0].pixels[4]) = ([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
        assert_eq!(cut_environment(&faces), ["environment: 72.19 % of the light is below 0 and was cut"]);

        let mut map = Picture::filled(2, 1, [0.25; 3]);
        assert!(cut_colour("it", &map).is_empty());
        map.pixels[0] = [68.0, -1e-6, 64.0];
        let [above, below] = cut_colour("it", &map).try_into().unwrap();
        assert_eq!(above, "it: 3.01 % of the light is above 64 × white and was cut");
        assert_eq!(below, "it: less than 0.01 % of the light is below 0 and was cut");
    }
}
