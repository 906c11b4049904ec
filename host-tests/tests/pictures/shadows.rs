//! Shadows of rough heights at every distance: brightness of the filtered picture over that of 64 samples a pixel, in bands of rows from the
//! horizon to the foreground.
//!
//! Run with `--nocapture` to see the measured figures.

use std::f64::consts::FRAC_PI_4;
use std::ops::RangeInclusive;

use rayon::prelude::*;
use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_host_tests::photographs::photograph;
use roughxel_host_tests::space::whole_or;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;

/// A plane to the horizon, its map 30 times along an edge, under one light. The light is 45° to the side of straight ahead.
fn plain(height_map: &str, elevation_degrees: f64, shadowing: &str) -> Scene {
    let (sin, cos) = elevation_degrees.to_radians().sin_cos();
    let (side, ahead) = FRAC_PI_4.sin_cos();
    let text = format!(
        "[camera]\neye = [0, 2.2, 6]\ntarget = [0, 0, -2]\nfov_y = 40\nwidth = 96\nheight = 72\n\
         [[light]]\ndirection = [{}, {sin}, {}]\n\
         [[object]]\nshape = \"plane\"\nsize = [60, 60]\nsegments = [30, 30]\nuv_repeat = [30, 30]\n\
         [object.material]\ncolour = [0, 0, 0]\nheight_map = {{ {height_map} }}\n\
         peaks = {{ colour = [0.3, 0.3, 0.3], shadowing = {shadowing}, exponent = 8 }}\n",
        cos * side,
        -cos * ahead,
    );
    Scene::from_toml("plain", &text, std::path::Path::new("")).expect("the scene is valid")
}

/// Rows of a band.
const BAND: usize = 8;

/// Mean brightness of each band of rows on the plane, the farthest first.
fn bands(frame: &Frame) -> Vec<f64> {
    let width = frame.width as usize;
    let rows: Vec<f64> =
        frame.pixels.chunks(width).map(|row| row.iter().map(|pixel| f64::from(pixel[0])).sum()).collect();
    let first = rows.iter().position(|row| *row > 0.0).unwrap_or(rows.len());
    // The uppermost row is half sky.
    rows[(first + 1).min(rows.len())..].chunks_exact(BAND).map(|band| band.iter().sum()).collect()
}

/// Ratio of each band's brightness on a plane to the truth's, at each elevation of the light.
fn kept(height_map: &str, shadowing: &str, elevations: &[f64]) -> Vec<Vec<f64>> {
    let p = Precision::STANDARD;
    let peaks = ScenePeaks::new(&plain(height_map, 45.0, "true"), true, None, &|_| ()).expect("the map is valid");
    let ratios = |elevation: &f64| {
        let scene = plain(height_map, *elevation, shadowing);
        let draw = |mode| {
            let prepared = Prepared::with_peaks(&scene, mode, &p, &peaks).expect("the scene is valid");
            bands(&prepared.render(&|| ()).expect("the scene can be drawn"))
        };
        let (filtered, truth) = (draw(Mode::Footprint), draw(Mode::Supersampled { edge: 8 }));
        filtered.iter().zip(&truth).map(|(filtered, truth)| filtered / truth).collect::<Vec<f64>>()
    };
    elevations.par_iter().map(ratios).collect()
}

/// Range of every band's ratio, for slopes up to 1.
const ROUGH: RangeInclusive<f64> = 0.9..=1.1;
/// Range of every band's ratio, for slopes up to 3.5.
const STEEP: RangeInclusive<f64> = 0.75..=1.3;

fn within(name: &str, height_map: &str, elevations: &[f64], bar: &RangeInclusive<f64>) {
    for (elevation, ratios) in elevations.iter().zip(kept(height_map, "true", elevations)) {
        println!("{name}, light at {elevation}°, from far to near: {ratios:.2?}");
        let holds = ratios.iter().all(|ratio| bar.contains(ratio));
        assert!(ratios.len() >= 6 && holds, "{name}, {elevation}°: {ratios:.3?}");
    }
}

const ELEVATIONS: [f64; 4] = [20.0, 35.0, 50.0, 80.0];

/// Bumps down to single texels.
fn generated(rms_slope: f64) -> String {
    format!("generate = \"bumps\", size = 64, cells = 8, octaves = 4, gain = 0.7, rms_slope = {rms_slope}")
}

#[test]
fn rough_heights_keep_their_brightness_at_every_distance() {
    for rms_slope in whole_or(vec![0.1, 0.3, 0.6, 1.0], vec![0.3, 1.0]) {
        within(&format!("bumps of {rms_slope}"), &generated(rms_slope), &ELEVATIONS, &ROUGH);
    }
}

#[test]
fn very_steep_heights_keep_most_of_it() {
    for rms_slope in whole_or(vec![2.0, 3.5], vec![3.5]) {
        within(&format!("bumps of {rms_slope}"), &generated(rms_slope), &ELEVATIONS, &STEEP);
    }
}

#[test]
fn photographs_as_heights_keep_their_brightness_at_every_distance() {
    for name in ["gravel.png", "grass.png"] {
        let Some(piece) = photograph(name, 64) else { return };
        for rms_slope in whole_or(vec![0.1, 0.3, 1.0, 3.5], vec![1.0]) {
            let bar = if rms_slope > 1.0 { &STEEP } else { &ROUGH };
            let map = format!("path = {:?}, rms_slope = {rms_slope}", piece.path().display().to_string());
            within(&format!("{name}, {rms_slope}"), &map, &ELEVATIONS, bar);
        }
    }
}

/// F92's product of shares, kept for comparison, loses two fifths of the light far away, though each peak stands for similar facets.
#[test]
fn the_product_of_shares_darkens_rough_distances() {
    for ratios in kept(&generated(1.0), "\"product\"", &[20.0]) {
        println!("{ratios:.2?}");
        assert!(ratios[0] < 0.7 && ratios[0] < ratios[ratios.len() - 1] - 0.3, "{ratios:.2?}");
    }
}
