//! Reflected ray r = 2 n⟨v·n⟩ − v|n|² (W97 (4)), v from the surface to the eye, no vector normalised.

use super::linear::{Vector3, add_scaled, dot, scaled};

/// The reflected ray; |r| = |v|·|n|².
pub fn reflect(view: Vector3, normal: Vector3) -> Vector3 {
    let along_normal = scaled(2.0 * dot(&view, &normal), normal);
    add_scaled(along_normal, -dot(&normal, &normal), view)
}

#[cfg(test)]
mod tests {
    use super::super::linear::{cross, norm};
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn reflection_keeps_angle_plane_and_length() {
        assert_eq!(reflect([1.0, 2.0, 3.0], [0.0, 1.0, 0.0]), [-1.0, 2.0, -3.0]);
        let mut random = SplitMix64::new(5);
        for _ in 0..1000 {
            let [v, n] = [0, 1].map(|_| [0, 1, 2].map(|_| random.uniform(-1.0, 1.0)));
            let r = reflect(v, n);
            let length = norm(&n);
            assert!((norm(&r) - norm(&v) * length * length).abs() < 1e-14);
            assert!((dot(&r, &n) - dot(&v, &n) * length * length).abs() < 1e-14);
            assert!(dot(&r, &cross(v, n)).abs() < 1e-14);
        }
    }
}
