//! Small vectors, and products whose difference keeps its accuracy.

/// Three components.
pub type Vector3 = [f64; 3];

/// Two components.
pub type Vector2 = [f64; 2];

/// a·b − c·d within 1.5 units in the last place, and 0 exactly for equal products (no over- or underflow).
///
/// Source: W. Kahan's algorithm with one fused multiply-add for the rounding error of c·d.
pub fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let cd = c * d;
    let rounding_of_cd = (-c).mul_add(d, cd);
    a.mul_add(b, -cd) + rounding_of_cd
}

/// a × b, every component within 1.5 units in the last place.
pub fn cross(a: Vector3, b: Vector3) -> Vector3 {
    [
        difference_of_products(a[1], b[2], a[2], b[1]),
        difference_of_products(a[2], b[0], a[0], b[2]),
        difference_of_products(a[0], b[1], a[1], b[0]),
    ]
}

/// a · b.
pub fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// |a|, without overflow or underflow of the squares.
pub fn norm<const N: usize>(a: &[f64; N]) -> f64 {
    a.iter().fold(0.0, |length: f64, &x| length.hypot(x))
}

/// Largest |component|.
pub fn largest<const N: usize>(a: &[f64; N]) -> f64 {
    a.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()))
}

/// k·a.
pub fn scaled<const N: usize>(k: f64, a: [f64; N]) -> [f64; N] {
    a.map(|x| k * x)
}

/// a + k·b.
pub fn add_scaled<const N: usize>(mut a: [f64; N], k: f64, b: [f64; N]) -> [f64; N] {
    for (x, y) in a.iter_mut().zip(b) {
        *x += k * y;
    }
    a
}

/// a·2^exponent; exact unless the result leaves the normal range of f64, where it goes to ±∞ or 0 as usual.
pub fn scale_exponent<const N: usize>(a: [f64; N], exponent: i32) -> [f64; N] {
    let mut left = exponent.clamp(-6000, 6000);
    let mut a = a;
    while left != 0 {
        let step = left.clamp(-1000, 1000);
        let power = f64::from_bits(((1023 + i64::from(step)) as u64) << 52);
        a = scaled(power, a);
        left -= step;
    }
    a
}

/// Brings `a` to the exponent at which its largest |component| lies in [½, 1): a = result·2^exponent, exactly.
///
/// The zero vector keeps exponent 0. Components more than 2¹⁰²² below the largest may round.
pub fn normalise_exponent<const N: usize>(a: [f64; N]) -> ([f64; N], i32) {
    let size = largest(&a);
    if size == 0.0 {
        return (a, 0);
    }
    // Subnormal numbers have no exponent field: lift them first.
    let lift = if size < f64::MIN_POSITIVE { 200 } else { 0 };
    let [lifted] = scale_exponent([size], lift);
    let exponent = ((lifted.to_bits() >> 52) & 0x7ff) as i32 - 1022 - lift;
    (scale_exponent(a, -exponent), exponent)
}

/// Angle in radians, 0…π/2, between two axes of the plane (directions without a sign).
pub fn axis_angle(a: Vector2, b: Vector2) -> f64 {
    let sine = difference_of_products(a[0], b[1], a[1], b[0]);
    sine.abs().atan2(dot(&a, &b).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn difference_of_products_is_exact_where_plain_f64_cancels_to_nothing() {
        // (2³⁰+1)(2³⁰−1) − 2⁶⁰ = −1; the products do not fit 53 bits.
        let x = 2_f64.powi(30);
        assert_eq!(difference_of_products(x + 1.0, x - 1.0, x, x), -1.0);
        assert_eq!((x + 1.0) * (x - 1.0) - x * x, 0.0);
        assert_eq!(difference_of_products(x + 1.0, x - 1.0, x - 1.0, x + 1.0), 0.0);
    }

    #[test]
    fn exponent_comes_out_exactly_at_both_ends_of_the_range() {
        for size in [1.0, 0.5, 0.999, 3.0, 1e300, 1e-300, 5e-324] {
            let (mantissa, exponent) = normalise_exponent([size, -size / 2.0]);
            assert!((0.5..1.0).contains(&mantissa[0]), "{size}");
            assert_eq!(scale_exponent(mantissa, exponent)[0], size);
        }
        assert_eq!(normalise_exponent([0.0, -0.0]), ([0.0, -0.0], 0));
    }

    #[test]
    fn axis_angle_ignores_signs() {
        assert_eq!(axis_angle([1.0, 0.0], [-1.0, 0.0]), 0.0);
        let eighth = axis_angle([1.0, 0.0], [-1.0, 1.0]);
        assert!((eighth - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    }
}
