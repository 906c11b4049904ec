//! Roughness: covariance of bump offsets, its storage as D, and the pyramid (S97 §8).
//!
//! K = D Dᵀ with D = [[d₁, d₂], [0, d₃]]; c = 0 gives d₂ = 0, d₁ = √a (erratum 13). The recursion is K = Σw(K_child + (mean_child − mean)(…)ᵀ). Its
//! plus is missing in print (erratum 14); with it every level holds the covariance over its whole area. The pyramid keeps K in float64; storing D is
//! the caller's task.

use super::axes::axes;
use super::ellipse::Ellipse;
use super::frame::Frame;
use super::linear::{Vector2, Vector3, add_scaled, difference_of_products, scaled};

/// Entries a, b, c of K = [[a, b], [b, c]].
pub type Covariance = [f64; 3];

/// Entries d₁, d₂, d₃ of D = [[d₁, d₂], [0, d₃]].
pub type Triangular = [f64; 3];

/// Mean and covariance (divided by their number) of a set of offsets; zero for the empty set.
pub fn covariance(offsets: &[Vector2]) -> (Vector2, Covariance) {
    let leaves: Vec<_> = offsets.iter().map(|&mean| Texel { mean, k: [0.0; 3] }).collect();
    let weight = 1.0 / offsets.len().max(1) as f64;
    let Texel { mean, k } = merge(leaves.iter().map(|texel| (weight, texel)));
    (mean, k)
}

/// D of a covariance: d₃ = √c, d₂ = b/√c, d₁ = √(a − b²/c). A K that rounding makes slightly indefinite gives d₁ = 0.
pub fn decompose([a, b, c]: Covariance) -> Triangular {
    if c <= 0.0 {
        return [a.max(0.0).sqrt(), 0.0, 0.0];
    }
    let d3 = c.sqrt();
    let det = difference_of_products(a, c, b, b).max(0.0);
    [(det / c).sqrt(), b / d3, d3]
}

/// K = D Dᵀ.
pub fn compose([d1, d2, d3]: Triangular) -> Covariance {
    [d1 * d1 + d2 * d2, d2 * d3, d3 * d3]
}

/// I₁, the standard deviation in the direction of largest variance.
pub fn isotropic(k: Covariance) -> f64 {
    axes(&Ellipse::from_matrix(k)).major
}

/// The two vectors dn of anisotropic roughness: d₁E₁ and d₂E₁ + d₃E₂.
pub fn tangents(frame: &Frame, [d1, d2, d3]: Triangular) -> [Vector3; 2] {
    [scaled(d1, frame.e1), add_scaled(scaled(d2, frame.e1), d3, frame.e2)]
}

/// The two vectors dn of isotropic roughness: I₁E₁ and I₁E₂.
pub fn isotropic_tangents(frame: &Frame, i1: f64) -> [Vector3; 2] {
    [scaled(i1, frame.e1), scaled(i1, frame.e2)]
}

/// One texel of the bump and roughness pyramids.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Texel {
    /// Mean offset.
    pub mean: Vector2,
    /// Covariance of the offsets within the texel.
    pub k: Covariance,
}

/// One level of the bump and roughness pyramids, rows of `width` texels.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Texels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// `width`·`height` texels.
    pub texels: Vec<Texel>,
}

/// Mean and total covariance of weighted parts whose weights sum to 1: the recursion of S97 §8 with the plus.
pub fn merge<'a>(parts: impl Iterator<Item = (f64, &'a Texel)> + Clone) -> Texel {
    let mut merged = Texel::default();
    for (weight, part) in parts.clone() {
        merged.mean = add_scaled(merged.mean, weight, part.mean);
    }
    for (weight, part) in parts {
        let [u, v] = add_scaled(part.mean, -1.0, merged.mean);
        let between = [u * u, u * v, v * v];
        merged.k = add_scaled(merged.k, weight, add_scaled(part.k, 1.0, between));
    }
    merged
}

/// All levels down to 1×1, level 0 with zero covariance; level l is max(1, width ≫ l) wide.
///
/// A texel of an odd-sized level takes the area of the parents that it covers: parents on its border count in part.
///
/// # Panics
/// If `offsets` does not hold `width`·`height` ≥ 1 entries.
pub fn pyramid(width: usize, height: usize, offsets: &[Vector2]) -> Vec<Level> {
    assert_eq!(width * height, offsets.len(), "one offset per texel");
    assert!(!offsets.is_empty(), "a level has at least one texel");
    let texels = offsets.iter().map(|&mean| Texel { mean, k: [0.0; 3] }).collect();
    let mut levels = vec![Level { width, height, texels }];
    while let Some(parent) = levels.last().filter(|level| level.width > 1 || level.height > 1) {
        let (width, height) = ((parent.width / 2).max(1), (parent.height / 2).max(1));
        let mut texels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let parts: Vec<_> = box_weights(parent.height, height, y)
                    .flat_map(|(row, row_weight)| {
                        box_weights(parent.width, width, x).map(move |(column, weight)| {
                            (row_weight * weight, &parent.texels[row * parent.width + column])
                        })
                    })
                    .collect();
                texels.push(merge(parts.iter().copied()));
            }
        }
        levels.push(Level { width, height, texels });
    }
    levels
}

/// Texels of a row of `from` that texel `index` of a row of `to` covers, with their shares of its area (sum 1).
pub fn box_weights(from: usize, to: usize, index: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
    // In units of 1/(from·to) of the row both borders are integers, so the shares are exact rationals.
    let (start, end) = (index * from, (index + 1) * from);
    (start / to..end.div_ceil(to)).map(move |texel| {
        let overlap = ((texel + 1) * to).min(end) - (texel * to).max(start);
        (texel, overlap as f64 / from as f64)
    })
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    #[test]
    fn covariance_is_as_worked_by_hand() {
        let (mean, k) = covariance(&[[1.0, 0.0], [3.0, 0.0], [1.0, 4.0], [3.0, 4.0]]);
        assert_eq!((mean, k), ([2.0, 2.0], [1.0, 0.0, 4.0]));
        assert_eq!(covariance(&[]), ([0.0; 2], [0.0; 3]));
    }

    #[test]
    fn decomposition_returns_the_covariance() {
        let mut random = SplitMix64::new(12);
        for _ in 0..1000 {
            let d = [random.uniform(0.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(0.1, 1.0)];
            let k = compose(d);
            let again = compose(decompose(k));
            assert!((0..3).all(|i| (k[i] - again[i]).abs() < 1e-15));
        }
        assert_eq!(decompose([4.0, 0.0, 0.0]), [2.0, 0.0, 0.0]);
        assert_eq!(decompose([4.0, 2.0, 1.0]), [0.0, 2.0, 1.0]);
        assert_eq!(decompose([0.0; 3]), [0.0; 3]);
    }

    #[test]
    fn every_level_holds_the_covariance_of_its_whole_area() {
        let mut random = SplitMix64::new(13);
        for (width, height) in [(8, 8), (16, 4), (1, 8), (7, 5), (9, 1), (1, 1)] {
            let offsets: Vec<Vector2> =
                (0..width * height).map(|_| [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)]).collect();
            let levels = pyramid(width, height, &offsets);
            let top = levels.last().expect("a pyramid has a level").texels[0];
            let (mean, k) = covariance(&offsets);
            assert!((0..2).all(|i| (top.mean[i] - mean[i]).abs() < 1e-15), "{width}x{height}");
            assert!((0..3).all(|i| (top.k[i] - k[i]).abs() < 1e-15), "{width}x{height}");
            assert_eq!(levels.len(), 1 + width.max(height).ilog2() as usize);
        }
    }

    #[test]
    fn box_weights_cover_odd_rows_by_area() {
        let row = |from, to, index| box_weights(from, to, index).collect::<Vec<_>>();
        assert_eq!(row(4, 2, 1), [(2, 0.5), (3, 0.5)]);
        assert_eq!(row(3, 1, 0), [(0, 1.0 / 3.0), (1, 1.0 / 3.0), (2, 1.0 / 3.0)]);
        assert_eq!(row(5, 2, 0), [(0, 0.4), (1, 0.4), (2, 0.2)]);
        assert_eq!(row(5, 2, 1), [(2, 0.2), (3, 0.4), (4, 0.4)]);
        assert_eq!(row(1, 1, 0), [(0, 1.0)]);
    }
}
