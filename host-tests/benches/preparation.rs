//! Preparation: the work before the first pixel of a frame.
//!
//! `cargo bench -p roughxel-benches --bench preparation` opens built-in scenes, prepares them in `standard` on one thread, and prints milliseconds.
//! `opened` reads the scene and makes the maps that it generates. `prepared` makes levels, roughness and peaks from the maps. `frame` is a filtered
//! frame of 640 by 480 pixels. The last row resamples a panorama of 4096 by 2048 pixels to faces of 1024.
//!
//! Each figure is the fastest of some runs, so it excludes the kernels of coarse levels, which are cached (0.1 s the first time). It takes half a
//! minute; `-- NAME…` takes only the scenes of these names.

use std::hint::black_box;
use std::time::Duration;

use comfy_table::Table;
use roughxel_assets::Picture;
use roughxel_benches::fastest;
use roughxel_core::precision::Precision;
use roughxel_frame::Prepared;
use roughxel_frame::plan::Mode;
use roughxel_host_tests::table::table;
use roughxel_scene::{Scene, builtin_names, faces_from_equirectangular};

/// Runs of which the fastest counts.
const TIMES: usize = 3;

fn open(name: &str) -> Scene {
    let scene = Scene::builtin(name).expect("the scene is built in").expect("built-in scenes are read");
    scene.with_size(640, 480).expect("the size is allowed")
}

/// Stripes and a sun.
fn panorama() -> Picture {
    let mut picture = Picture::filled(4096, 2048, [0.5; 3]);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        *pixel = [[0.2, 0.3, 0.4], [0.8, 0.7, 0.5]][index / 16 % 2];
    }
    picture.pixels[500 * 4096 + 1000] = [3000.0; 3];
    picture
}

fn measure(names: &[String]) -> Table {
    let mut table = table(["scene", "opened", "prepared", "frame"], 1..4);
    let milliseconds = |time: Duration| format!("{:.0}", time.as_secs_f64() * 1e3);
    let is_asked = |name: &str| names.is_empty() || names.iter().any(|asked| asked == name);
    for name in builtin_names().filter(|name| is_asked(name)) {
        let (scene, opened) = fastest(TIMES, || open(name));
        let prepare = || Prepared::new(&scene, Mode::Footprint, &Precision::STANDARD).expect("the scene can be drawn");
        let (ready, prepared) = fastest(TIMES, prepare);
        let (_, drawn) = fastest(TIMES, || ready.render(&|| ()).expect("the scene can be drawn"));
        table.add_row([name.to_owned(), milliseconds(opened), milliseconds(prepared), milliseconds(drawn)]);
    }
    if is_asked("panorama") {
        let picture = panorama();
        let (_, resampled) = fastest(TIMES, || black_box(faces_from_equirectangular(&picture, 1024)));
        table.add_row(["panorama".to_owned(), milliseconds(resampled), String::new(), String::new()]);
    }
    table
}

fn main() {
    let names: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("the thread pool can be created");
    println!("Fastest of {TIMES} times, one thread, milliseconds.\n{}", one_thread.install(|| measure(&names)));
}
