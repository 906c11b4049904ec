//! Memory that a frame takes until it is a file. This is a test program of its own, because the system counts whole processes.

use std::fs;

use roughxel_assets::picture::write_png_codes;
use roughxel_core::precision::Precision;
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_scene::Scene;

/// Most memory that this process has held, bytes; `None` if the system does not report it.
fn most_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024 * line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?)
}

/// Draws a scene of this size and writes it as the program does; returns the bytes that the program states for it.
fn draw(scene: Scene, [width, height]: [u32; 2]) -> u64 {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let scene = scene.with_size(width, height).expect("the size is allowed");
    let prepared = Prepared::new(&scene, Mode::Footprint, &Precision::STANDARD).expect("the scene can be drawn");
    let frame = prepared.render(&|| ()).expect("the scene can be drawn");
    let codes = frame.srgb_codes();
    drop(frame);
    write_png_codes(&folder.path().join("a.png"), [width, height], &codes).expect("the file can be written");
    prepared.frame_bytes()
}

/// A floor under a ramp: quickly drawn, so that nearly all memory is pixels.
const FLOOR: &str = r#"
[camera]
eye = [0, 1, 3]
target = [0, 0, 0]
[background]
top = [0.1, 0.2, 0.4]
bottom = [0.8, 0.7, 0.6]
[[object]]
shape = "plane"
[object.material]
colour = [0.5, 0.4, 0.3]
"#;

#[test]
fn a_frame_takes_the_bytes_that_are_stated() {
    let floor = || Scene::from_toml("floor.toml", FLOOR, ".".as_ref()).expect("the scene is good");
    // The first frame accounts for threads, libraries and the base cost of a frame.
    draw(floor(), [640, 480]);
    let Some(before) = most_memory() else {
        println!("SKIPPED: this system does not report the memory of a process");
        return;
    };
    let size = [4096, 1536];
    let stated = draw(floor(), size);
    assert_eq!(stated, Frame::BYTES_A_PIXEL * 4096 * 1536);
    let grown = most_memory().expect("the system reports memory") - before;
    // The large frame reuses the memory of the small one, and allocators keep some. A copy of the frame would be 12 more bytes a
    // pixel.
    let pixel = grown as f64 / f64::from(size[0] * size[1]);
    println!("{pixel:.2} bytes a pixel");
    assert!(pixel > 12.0, "{pixel} bytes a pixel: less than the frame itself");
    assert!(pixel < Frame::BYTES_A_PIXEL as f64 + 1.0, "{pixel} bytes a pixel, {} stated", Frame::BYTES_A_PIXEL);
}
