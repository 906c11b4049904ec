//! Generated roughness: the D of S97 §8 as three channels d₁, d₂, d₃, not coded as those of a picture.

use super::maths::{cos_turns, sin_turns};
use crate::error::SceneError;
use crate::roughness::MAX_DEVIATION;
use crate::source::Arguments;

/// d₁, d₂, d₃ of one ellipse for the whole map, with D Dᵀ = R diag(along², across²) Rᵀ. The standard deviations are along a direction of the map
/// and across it.
///
/// d₃ is the length of the second row of R diag(along, across), d₂ its first row along the second. d₁ = along·across/d₃ by the determinant, which
/// does not cancel. d₃ = 0 leaves the first row alone (erratum 13).
pub(crate) fn uniform_roughness(keys: &Arguments<'_>) -> Result<[f64; 3], SceneError> {
    let along = keys.number("along", 0.1, 0.0..=MAX_DEVIATION)?;
    let across = keys.number("across", 0.1, 0.0..=MAX_DEVIATION)?;
    // Angle from +u towards +v.
    let turns = keys.number("direction_degrees", 0.0, -360.0..=360.0)? / 360.0;
    let (sin, cos) = (sin_turns(turns), cos_turns(turns));
    let rows = [[cos * along, -sin * across], [sin * along, cos * across]];
    let length = |row: [f64; 2]| (row[0] * row[0] + row[1] * row[1]).sqrt();
    let d3 = length(rows[1]);
    if d3 == 0.0 {
        return Ok([length(rows[0]), 0.0, 0.0]);
    }
    let d2 = (rows[0][0] * rows[1][0] + rows[0][1] * rows[1][1]) / d3;
    Ok([along * across / d3, d2, d3])
}

#[cfg(test)]
mod tests {
    use super::super::keys::with_keys;
    use super::*;

    #[test]
    fn the_factor_has_the_deviations_along_and_across_its_direction() {
        for (along, across) in [(0.3, 0.1), (0.2, 0.0), (0.0, 0.2), (0.0, 0.0), (0.1, 0.1)] {
            for degrees in (-180_i32..=180).step_by(15) {
                let keys = format!("along = {along}, across = {across}, direction_degrees = {degrees}");
                let [d1, d2, d3] = with_keys(&keys, uniform_roughness).unwrap();
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                // |Dᵀx|² for a unit vector x; bound: twice the error of the generators' sine.
                let variance = |x: [f64; 2]| (d1 * x[0]).powi(2) + (d2 * x[0] + d3 * x[1]).powi(2);
                assert!((variance([cos, sin]) - along * along).abs() < 2e-13, "{along} {across} {degrees}");
                assert!((variance([-sin, cos]) - across * across).abs() < 2e-13, "{along} {across} {degrees}");
            }
        }
    }
}
