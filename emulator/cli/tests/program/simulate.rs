//! Frames out of the Verilog by one command, and what it says if it cannot draw one.

use std::process::Command;

use super::fixture::{Folder, Run};

#[test]
fn a_simulated_picture_has_the_bytes_of_the_rendered_one() {
    if Command::new("verilator").arg("-V").output().is_err() {
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "verilator is not installed");
        eprintln!("SKIPPED: verilator is not installed, so nothing here was checked with it");
        return;
    }
    let folder = Folder::new();
    let run = folder.done("simulate lake --size 24x18 --profile narrow -o simulated");
    run.prints(&[
        "24x18, narrow, golden frame: equal",
        "a reflection every 23 cycles",
        "fragments/s at 60 MHz",
        "bursts",
    ]);
    folder.done("render lake --size 24x18 --profile narrow -o rendered.png");
    let [simulated, rendered] =
        ["simulated/lake.png", "rendered.png"].map(|name| std::fs::read(folder.join(name)).unwrap());
    assert_eq!(simulated, rendered);
    assert!(folder.read("simulated/lake/rtl/roughxel_frame.v").contains("module roughxel_frame ("));
}

#[test]
fn a_missing_simulator_is_named_with_its_remedy() {
    let folder = Folder::new();
    let mut command = folder.program("simulate lake --size 8x6 --profile narrow");
    let run = Run::output(command.env("PATH", folder.path())).ends(1);
    run.complains(&["verilator cannot be started", "apt-get install verilator"]);
}

#[test]
fn scenes_that_the_device_does_not_draw_are_refused_before_anything_is_compiled() {
    let folder = Folder::new();
    folder.refuses(&[
        ("simulate lake highlight --size 8x6", 1, "scene highlight: no object of the scene reflects"),
        ("simulate puzzle --size 8x6", 1, "scene puzzle: no object of the scene reflects an environment"),
        ("simulate lake --size 2048x1024", 1, "at most 2^20 pixels, and this one has 2097152; use --size"),
        ("simulate lake lake", 2, "two scenes are `lake`"),
        ("simulate", 2, "SCENE"),
    ]);
    assert!(!folder.join("simulated/lake").exists());
}
