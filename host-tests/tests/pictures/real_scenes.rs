//! Filtered pictures of what nobody here made, against 16 samples a pixel.
//!
//! Run with `--nocapture` to see what was reached; `picture-bars` prints how much faster it is.

use roughxel_core::precision::Precision;
use roughxel_host_tests::bars::{real_scenes, scene_figures};
use roughxel_host_tests::space::whole_or;

#[test]
fn filtered_pictures_of_real_scenes_are_near_to_what_16_samples_reach() {
    let Some(scenes) = real_scenes() else { return };
    for real in scenes {
        let edge = whole_or(16, 8);
        let figures = scene_figures(&real.scene, &Precision::STANDARD, edge, &|| ()).expect("it can be drawn");
        println!("{}: {figures:.1?}", real.name);
        assert!(figures.footprint >= figures.supersampled_16 - real.behind, "{}: {figures:?}", real.name);
    }
}
