//! Reflections of bright environments have the same light in integers and in float64.

use std::path::Path;

use roughxel_core::precision::{Precision, Profile};
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_reference_renderer::{RealPicture, render};
use roughxel_scene::Scene;

/// A rough sphere, or a rough plane, that reflects a 1024th of a day sky.
fn scene(object: &str) -> Scene {
    let text = format!(
        "[camera]\neye = [0, 1.2, 4]\ntarget = [0, 0, 0]\nwidth = 64\nheight = 48\n\
         [background]\ncolour = [0, 0, 0]\n\
         [environment]\ngenerate = \"sky\"\nface_edge = 64\nsun = [0, 0, 0]\nradius_degrees = 0.1\n\
         [[object]]\n{object}\n[object.material]\ncolour = [0, 0, 0]\nreflectance = 0.0009765625\n\
         roughness_map = {{ generate = \"uniform\", along = 0.2, across = 0.1 }}\n"
    );
    Scene::from_toml("bright", &text, Path::new("")).unwrap()
}

/// Suns of `brightness` × white in one texel overhead and one in front of the camera, with all of the sky exposed by `stops`.
fn lit(mut scene: Scene, brightness: f32, stops: i32) -> Scene {
    let faces = &mut scene.environment.as_mut().unwrap().faces;
    for (face, row) in [(2, 40), (5, 20)] {
        faces[face].pixels[64 * row + 30] = [brightness, 0.9 * brightness, 0.8 * brightness];
    }
    for channel in faces.iter_mut().flat_map(|face| &mut face.pixels).flatten() {
        *channel *= 2_f32.powi(stops);
    }
    scene
}

fn draw(scene: &Scene, mode: Mode, p: &Precision) -> Frame {
    Prepared::new(scene, mode, p).unwrap().render(&|| ()).unwrap()
}

/// The mean of each channel, and the brightest.
fn light(picture: &RealPicture) -> ([f64; 3], f64) {
    let mean = |channel: usize| picture.pixels.iter().map(|pixel| pixel[channel]).sum::<f64>();
    let brightest = picture.pixels.iter().flatten().fold(0.0_f64, |most, &channel| most.max(channel));
    ([0, 1, 2].map(|channel| mean(channel) / picture.pixels.len() as f64), brightest)
}

#[test]
fn reflections_of_a_sun_are_as_bright_as_in_float64_at_every_exposure() {
    for object in ["shape = \"sphere\"", "shape = \"plane\"\nsize = [6, 6]"] {
        for (profile, mode) in [
            (Profile::Standard, Mode::Footprint),
            (Profile::Narrow, Mode::Footprint),
            (Profile::Standard, Mode::Isotropic),
        ] {
            let p = profile.precision();
            let (dark, _) = light(&RealPicture::from(&draw(&lit(scene(object), 0.0, 0), mode, &p)));
            for stops in [-6, 0, 4] {
                let scene = lit(scene(object), 30_000.0, stops);
                let (expected, brightest) = light(&render(&scene, mode, &p, &|| ()).unwrap());
                assert!(brightest < 60.0, "nothing is clamped: {brightest}");
                let (got, _) = light(&RealPicture::from(&draw(&scene, mode, &p)));
                for (got, expected) in got.into_iter().zip(expected) {
                    let error = got / expected - 1.0;
                    println!("{object:?} {mode} {stops:+}: {got:.6} of {expected:.6}, {:+.3} %", 100.0 * error);
                    assert!(error.abs() <= 0.01, "{object:?} {mode} {stops}: {got} of {expected}");
                }
                // Most of the light is the sun's.
                assert!(got[0] > 2.0 * dark[0] * 2_f64.powi(stops), "{got:?} of {dark:?}");
            }
        }
    }
}

#[test]
fn a_background_shows_a_bright_sky_cut_to_the_brightest_pixel() {
    let mut scene = lit(scene("shape = \"sphere\"\nradius = 0.001"), 30_000.0, 0);
    scene.background = roughxel_scene::Background::Environment;
    scene.camera.target = scene.camera.eye + glam::DVec3::new(0.0, 1.0, 0.1);
    scene.camera.fov_y_degrees = 90.0;
    let p = Profile::Standard.precision();
    for mode in [Mode::Unfiltered, Mode::Footprint] {
        let real = render(&scene, mode, &p, &|| ()).unwrap();
        let frame = RealPicture::from(&draw(&scene, mode, &p));
        assert!(light(&real).1 > 1000.0 && light(&frame).1 == 63.0);
        // Away from the sun the sky is the same.
        assert!(frame.psnr(&real) > 45.0, "{mode}: {:.1} dB", frame.psnr(&real));
    }
}
