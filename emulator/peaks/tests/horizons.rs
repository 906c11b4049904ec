//! Kept heights of a scene, and the horizons of the peaks fitted to them.

use roughxel_assets::Picture;
use roughxel_peaks::{BuildOptions, FacetWeight, PeakPyramid, PeakSource};
use roughxel_scene::{BumpField, Edges, FrameSystem, HeightScale};

fn picture(width: u32, height: u32, value: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect();
    Picture { width, height, pixels }
}

const FRAMES: [FrameSystem; 3] = [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised];

/// One smooth hill a repeat, for maps of any shape.
fn hill(width: u32, height: u32) -> Picture {
    let wave = |place: u32, size: u32| (std::f64::consts::TAU * f64::from(place) / f64::from(size)).cos();
    picture(width, height, |x, y| [(0.5 + 0.2 * wave(x, width) + 0.3 * wave(y + 2, height)) as f32; 3])
}

/// The hill in all shapes, bases and scales.
fn kept_hills() -> impl Iterator<Item = (FrameSystem, BumpField)> {
    [(24, 24), (40, 16), (12, 60)].into_iter().flat_map(|(width, height)| {
        FRAMES.into_iter().flat_map(move |frame| {
            let scales = [HeightScale::Height(0.3), HeightScale::Height(-0.07), HeightScale::RmsSlope(0.4)];
            let field = move |scale| BumpField::with_heights(&hill(width, height), scale, frame, Edges::Wrapped);
            scales.into_iter().map(field).map(move |(field, clamped)| {
                assert_eq!(clamped, 0);
                (frame, field)
            })
        })
    })
}

#[test]
fn a_flank_below_its_top_has_the_horizon_of_its_own_slope() {
    for (frame, field) in kept_hills() {
        let negate = frame != FrameSystem::MainDirection;
        let options = BuildOptions { exponent: 40.0, amplitude: 1.0, weight: FacetWeight::Texel, negate };
        let base = &PeakPyramid::base(&PeakSource::from_field(&field), &options).unwrap().levels[0];
        let mut flanks = 0;
        for (x, y) in (0..field.height).flat_map(|y| (0..field.width).map(move |x| (x, y))) {
            let peak = base.texel(x, y)[0];
            let sides = peak.horizon.unwrap().map(|side| side.mean);
            for (axis, size) in [field.width, field.height].into_iter().enumerate() {
                let along = |step: u32| match axis {
                    0 => base.texel((x + size + step - 2) % size, y)[0].normal,
                    _ => base.texel(x, (y + size + step - 2) % size)[0].normal,
                };
                // A surface rises opposite to the lean of its normal.
                let rise = |step: u32| -along(step)[axis] / along(step).z;
                let steepness = rise(2).abs();
                let uphill = usize::from(rise(2) > 0.0);
                let (before, after) = if (uphill == 1) != negate { (1, 3) } else { (3, 1) };
                let is_convex = rise(before).abs() > steepness && steepness > rise(after).abs();
                if is_convex && rise(before) * rise(after) > 0.0 {
                    flanks += 1;
                    let seen = sides[2 * axis + uphill];
                    // The slope to the next texel is half a second difference less than the slope at this texel.
                    let curvature = rise(before).abs() - rise(after).abs();
                    assert!(seen < steepness && steepness - seen < 0.5 * curvature, "{frame:?} {axis} {seen}");
                }
            }
        }
        assert!(flanks > 40, "{flanks}");
    }
}
