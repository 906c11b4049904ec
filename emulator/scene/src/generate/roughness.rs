//! Generated roughness: the D of S97 §8 as three channels d₁, d₂, d₃ (not coded as a picture's are).

use super::maths::{cos_turns, sin_turns};

/// The same ellipse everywhere: standard deviations along a direction of the map and across it.
#[derive(Clone, Debug)]
pub(super) struct Uniform {
    pub(super) along: f64,
    pub(super) across: f64,
    /// From +u towards +v.
    pub(super) direction_degrees: f64,
}

impl Uniform {
    /// d₁, d₂, d₃ with D Dᵀ = R diag(along², across²) Rᵀ.
    ///
    /// d₃ is the length of the second row of R diag(along, across), d₂ its first row along the second, and
    /// d₁ = along·across/d₃ by the determinant, which does not cancel; d₃ = 0 leaves the first row alone (erratum 13).
    pub(super) fn factor(&self) -> [f64; 3] {
        let turns = self.direction_degrees / 360.0;
        let (sin, cos) = (sin_turns(turns), cos_turns(turns));
        let rows = [[cos * self.along, -sin * self.across], [sin * self.along, cos * self.across]];
        let length = |row: [f64; 2]| (row[0] * row[0] + row[1] * row[1]).sqrt();
        let d3 = length(rows[1]);
        if d3 == 0.0 {
            return [length(rows[0]), 0.0, 0.0];
        }
        let d2 = (rows[0][0] * rows[1][0] + rows[0][1] * rows[1][1]) / d3;
        [self.along * self.across / d3, d2, d3]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_has_the_deviations_along_and_across_its_direction() {
        for (along, across) in [(0.3, 0.1), (0.2, 0.0), (0.0, 0.2), (0.0, 0.0), (0.1, 0.1)] {
            for degrees in (-180..=180).step_by(15) {
                let [d1, d2, d3] = Uniform { along, across, direction_degrees: degrees.into() }.factor();
                let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
                // |Dᵀx|² for a unit vector x; twice the error of the generators' sine.
                let variance = |x: [f64; 2]| (d1 * x[0]).powi(2) + (d2 * x[0] + d3 * x[1]).powi(2);
                assert!((variance([cos, sin]) - along * along).abs() < 2e-13, "{along} {across} {degrees}");
                assert!((variance([-sin, cos]) - across * across).abs() < 2e-13, "{along} {across} {degrees}");
            }
        }
    }
}
