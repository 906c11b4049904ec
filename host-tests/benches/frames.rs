//! Distribution of the time of a frame over its phases.
//!
//! `cargo bench -p roughxel-benches --bench frames` draws frames of 640 by 480 pixels in `standard` on one thread. It prints nanoseconds a pixel
//! and their phases, for the fastest of some frames. `footprints` is the datapath itself, from ports to footprints; the others are what a frame
//! needs in addition. `2 threads` is how many times faster two threads draw the whole frame. It takes about a minute; `-- NAME…` draws only the
//! scenes or modes of these names.

use std::time::Duration;

use roughxel_benches::fastest;
use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_host_tests::table::table;
use roughxel_scene::Scene;
use roughxel_shader::{Phase, PhaseTimes};

/// A bumpy plane to the horizon that mirrors the sky: 512² texels, faces of 512².
const PLANE: &str = r#"
[camera]
eye = [0, 2.2, 6]
target = [0, 0.6, -2]
fov_y = 45
width = 640
height = 480
[environment]
generate = "sky"
face_edge = 512
[[object]]
shape = "plane"
size = [400, 400]
uv_repeat = [100, 100]
[object.material]
reflectance = [0.9, 0.9, 0.9]
normal_map = { generate = "hammered", size = 512, dents = 24, slope = 0.2 }
"#;

const MODES: [(&str, Mode); 3] =
    [("unfiltered", Mode::Unfiltered), ("footprint", Mode::Footprint), ("16-samples", Mode::Supersampled { edge: 4 })];

/// Frames of which the fastest counts.
const FRAMES: usize = 5;

fn scenes() -> Vec<Scene> {
    let plane = Scene::from_toml("plane", PLANE, std::path::Path::new("")).expect("the scene is valid");
    let built_in = ["lake", "zebra", "globe", "mesh", "denim-plane"].map(|name| {
        let scene = Scene::builtin(name).expect("the scene is built in").expect("built-in scenes are read");
        scene.with_size(640, 480).expect("the size is allowed")
    });
    [plane].into_iter().chain(built_in).collect()
}

/// Phases of the fastest frame on `threads` threads, and the wall-clock time.
fn fastest_frame(prepared: &Prepared<'_>, threads: usize) -> (PhaseTimes, Duration) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("the thread pool can be created");
    let frame = || prepared.render_counted(&|| ()).expect("the scene can be drawn").1.times;
    pool.install(|| fastest(FRAMES, frame))
}

fn main() {
    let header = ["scene", "mode", "ns a pixel"].into_iter().chain(Phase::ALL.map(Phase::name)).chain(["2 threads"]);
    let mut table = table(header.collect::<Vec<_>>(), 2..4 + Phase::ALL.len());
    let names: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let (modes, names): (Vec<_>, Vec<_>) =
        names.iter().map(String::as_str).partition(|name| MODES.iter().any(|mode| mode.0 == *name));
    let asked = |name: &str, among: &[&str]| among.is_empty() || among.contains(&name);
    for scene in scenes().into_iter().filter(|scene| asked(&scene.name, &names)) {
        for (name, mode) in MODES.into_iter().filter(|mode| asked(mode.0, &modes)) {
            let prepared = Prepared::new(&scene, mode, &Precision::STANDARD).expect("the scene can be drawn");
            let [(times, one), (_, two)] = [1, 2].map(|threads| fastest_frame(&prepared, threads));
            let pixels = f64::from(scene.camera.width) * f64::from(scene.camera.height);
            let a_pixel = |time: Duration| format!("{:.0}", time.as_secs_f64() * 1e9 / pixels);
            let phases = Phase::ALL.map(|phase| a_pixel(times.time(phase)));
            let two_threads = format!("{:.2}", one.as_secs_f64() / two.as_secs_f64());
            let row = [scene.name.clone(), name.into(), a_pixel(times.sum())].into_iter().chain(phases);
            table.add_row(row.chain([two_threads]));
        }
    }
    println!("Fastest of {FRAMES} frames of 640×480, one thread, nanoseconds a pixel.\n{table}");
}
