//! Perturbed normal n_mod = n + b₁E₁ + b₂E₂ (S97 §7, W97 before (4)).

use super::frame::Frame;
use super::linear::{Vector3, add_scaled, norm};

/// n + b₁E₁ + b₂E₂, in the units of n.
pub fn perturb(normal: Vector3, frame: &Frame, offset: [f64; 2]) -> Vector3 {
    let tilted = add_scaled(normal, offset[0], frame.e1);
    add_scaled(tilted, offset[1], frame.e2)
}

/// |n| + |b₁E₁| + |b₂E₂|: the measure of an error of n_mod if its terms cancel.
///
/// In system 3 they cannot (E ⟂ n), and this is at most √3·|n_mod|.
pub fn scale(normal: Vector3, frame: &Frame, offset: [f64; 2]) -> f64 {
    norm(&normal) + offset[0].abs() * norm(&frame.e1) + offset[1].abs() * norm(&frame.e2)
}

#[cfg(test)]
mod tests {
    use super::super::frame::frame_main_direction;
    use super::*;

    #[test]
    fn offsets_are_relative_to_the_length_of_the_normal() {
        for length in [0.125, 1.0, 64.0] {
            let n = [0.0, 0.0, length];
            let frame = frame_main_direction(n, [0.0, 1.0, 0.0]);
            // e₁ = h×n/|h×n| = (1,0,0), e₂ = n̂×e₁ = (0,1,0).
            let expected = [0.5 * length, -0.25 * length, length];
            assert_eq!(perturb(n, &frame, [0.5, -0.25]), expected);
            assert_eq!(scale(n, &frame, [0.5, -0.25]), 1.75 * length);
        }
    }
}
