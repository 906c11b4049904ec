//! Frames that the generated Verilog draws are the golden frames, to the bit, and a fault in the device is a different picture.

use std::fs;
use std::path::Path;

use roughxel_core::plan::ReflectionPlan;
use roughxel_core::precision::Profile;
use roughxel_frame::plan::Mode;
use roughxel_frame::{Frame, Prepared};
use roughxel_hardware_frame::{Device, DeviceError, DeviceOptions, Figures, Job, JobError, Model, ModelError};
use roughxel_host_tests::bars::GOLDEN_FRAMES;
use roughxel_host_tests::simulators::{have, keep_objects, run};
use roughxel_host_tests::space::{is_full_run, profiles};
use roughxel_netlist::target::Target;
use roughxel_peaks::ScenePeaks;
use roughxel_scene::Scene;
use tempfile::TempDir;

/// Cycles until a burst begins.
const LATENCY: u32 = 30;

fn scene(name: &str, [width, height]: [u32; 2]) -> Scene {
    Scene::builtin(name).expect("a built-in scene").expect("it is read").with_size(width, height).expect("a size")
}

fn prepared<'a>(scene: &'a Scene, profile: &str) -> Prepared<'a> {
    let precision = Profile::by_name(profile).expect("a profile").precision();
    Prepared::with_peaks(scene, Mode::Footprint, &precision, &ScenePeaks::default()).expect("the scene is set up")
}

fn options(profile: &str, multipliers: u32) -> DeviceOptions {
    let precision = Profile::by_name(profile).expect("a profile").precision();
    DeviceOptions { profile: profile.into(), precision, multipliers, target: Target::Asic }
}

fn device(prepared: &Prepared<'_>, profile: &str, multipliers: u32) -> Device {
    let plans: Vec<ReflectionPlan> = prepared.reflection_plans().collect();
    Device::new(&plans, &options(profile, multipliers)).expect("the scene has a device")
}

/// A device with its model, and a frame for it.
struct Bench {
    directory: TempDir,
    model: Model,
    job: Job,
    golden: Frame,
}

impl Bench {
    fn new(name: &str, size: [u32; 2], profile: &str, multipliers: u32, change: impl FnOnce(&mut Device)) -> Self {
        let scene = scene(name, size);
        let prepared = prepared(&scene, profile);
        let mut device = device(&prepared, profile, multipliers);
        change(&mut device);
        let job = Job::new(&prepared, size, &device, &|| ()).expect("the scene is a job");
        let directory = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a temporary directory");
        let model =
            Model::build_with(&device, directory.path(), "-O1", keep_objects).expect("Verilator builds the device");
        Self { directory, model, job, golden: prepared.render(&|| ()).expect("the frame is drawn") }
    }

    fn run(&self, latency: u32) -> Result<(Frame, Figures), ModelError> {
        self.model.run(&self.job, self.directory.path(), latency, &|_| ())
    }
}

/// Digest of a golden frame of 64×48 pixels.
fn golden_digest(scene: &str, profile: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(GOLDEN_FRAMES);
    let list = fs::read_to_string(path).expect("the list of golden frames");
    let start = format!("{scene} {profile} footprint ");
    list.lines().find_map(|line| line.strip_prefix(&start)).expect("a line of the list").to_owned()
}

#[test]
fn a_frame_out_of_the_verilog_is_the_golden_frame() {
    if !have("verilator") {
        return;
    }
    let mut cases = vec![("lake", "narrow", 8)];
    if is_full_run() {
        cases = profiles().iter().flat_map(|(profile, _)| [("lake", *profile, 8), ("globe", *profile, 12)]).collect();
        cases.extend([("lake", "narrow", 1), ("globe", "narrow", 32), ("zebra", "compact", 4)]);
    }
    for (name, profile, multipliers) in cases {
        let bench = Bench::new(name, [64, 48], profile, multipliers, |_| ());
        // A memory that answers soon and one that answers late give the same texels.
        for latency in [1, LATENCY, 200] {
            let (frame, figures) = bench.run(latency).expect("all pixels come");
            assert_eq!(frame, bench.golden, "{name} {profile} {multipliers}");
            assert_eq!(frame.digest(), golden_digest(name, profile), "{name} {profile} {multipliers}");
            assert_eq!(figures.fragments as usize, bench.job.fragments);
            assert!(figures.samples >= figures.probes && figures.requests >= 2 * figures.samples, "{figures:?}");
            assert!(figures.hit_rate() > 0.5, "{figures:?}");
        }
    }
}

#[test]
fn whole_frames_out_of_the_verilog_are_the_emulators() {
    if !is_full_run() || !have("verilator") {
        return;
    }
    for name in ["lake", "globe"] {
        let bench = Bench::new(name, [160, 120], "narrow", 8, |_| ());
        let (frame, figures) = bench.run(LATENCY).expect("all pixels come");
        assert_eq!(frame, bench.golden, "{name}");
        println!("{name}: {figures:?}");
    }
}

/// Replaces a piece of a file of the device.
fn broken(device: &mut Device, file: &str, right: &str, wrong: &str) {
    let text = device.files.get_mut(file).expect("a file of the device");
    assert_eq!(text.matches(right).count(), 1, "{file}: {right}");
    *text = text.replace(right, wrong);
}

#[test]
fn a_wrong_tag_and_a_dropped_probe_are_different_pictures() {
    if !have("verilator") {
        return;
    }
    let faults = [
        ("roughxel_texture_cache.v", "tags[in_set] == in_tile", "tags[in_set][3:0] == in_tile[3:0]"),
        ("roughxel_frame.v", "index} + 5'd1 == foot_count;", "index} + 5'd1 == foot_count | index == 4'd1;"),
        (
            "roughxel_frame.v",
            "level == last_level ? level : level + 4'd1",
            "level == last_level ? level - 4'd1 : level",
        ),
        ("roughxel_texel_requests.v", "{row[1:0], column[1:0]}", "{column[1:0], row[1:0]}"),
    ];
    let count = if is_full_run() { faults.len() } else { 2 };
    for (file, right, wrong) in faults.into_iter().take(count) {
        let bench = Bench::new("lake", [32, 24], "narrow", 8, |device| broken(device, file, right, wrong));
        let (frame, _) = bench.run(LATENCY).expect("all pixels come");
        assert_ne!(frame, bench.golden, "{file}: {wrong}");
    }
}

#[test]
fn a_device_is_written_for_every_target_and_both_footprints() {
    for name in ["lake", "globe"] {
        let scene = scene(name, [8, 6]);
        let plans: Vec<ReflectionPlan> = prepared(&scene, "narrow").reflection_plans().collect();
        for target in Target::ALL {
            let device = Device::new(&plans, &DeviceOptions { target, ..options("narrow", 8) });
            let device = device.unwrap_or_else(|error| panic!("{name} {}: {error}", target.name()));
            assert!(device.interval() >= 20 && device.multipliers() >= 18, "{name} {}", target.name());
        }
    }
}

#[test]
fn yosys_takes_the_device() {
    if !have("yosys") {
        return;
    }
    let scene = scene("lake", [8, 6]);
    let device = device(&prepared(&scene, "narrow"), "narrow", 8);
    let directory = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a temporary directory");
    roughxel_utilities::output::write_files(directory.path(), &device.files).expect("the directory can be written");
    let script = "read_verilog *.v; hierarchy -check -top roughxel_frame; proc; check -assert";
    run(std::process::Command::new("yosys").args(["-q", "-p", script]).current_dir(directory.path()));
}

#[test]
fn what_the_device_does_not_draw_is_refused_by_name() {
    let lake = scene("lake", [8, 6]);
    let device = device(&prepared(&lake, "narrow"), "narrow", 8);
    let refused = |name: &str| {
        let scene = scene(name, [8, 6]);
        let prepared = prepared(&scene, "narrow");
        Job::new(&prepared, [8, 6], &device, &|| ()).err().map(|error| error.to_string())
    };
    assert_eq!(refused("highlight").as_deref(), Some("object 1 has highlight, which the device does not draw"));
    let large = Job::new(&prepared(&lake, "narrow"), [2048, 1024], &device, &|| ());
    assert!(matches!(large, Err(JobError::TooLarge(2_097_152))));
    let plan = ReflectionPlan::FULL;
    let sphere = plan.on_sphere();
    let none = ReflectionPlan { footprint: roughxel_core::plan::FootprintKind::None, ..plan };
    let error = |plans: &[ReflectionPlan]| Device::new(plans, &options("narrow", 8)).err();
    assert!(matches!(error(&[]), Some(DeviceError::NoReflection)));
    assert!(matches!(error(&[none]), Some(DeviceError::NoFootprint)));
    assert!(matches!(error(&[plan, sphere]), Some(DeviceError::Mixed(_))));
}

#[test]
fn the_model_says_what_is_missing_to_build_it() {
    let scene = scene("lake", [8, 6]);
    let device = device(&prepared(&scene, "narrow"), "narrow", 8);
    let directory = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a temporary directory");
    let error = Model::build_with(&device, directory.path(), "-O1", |command| {
        command.env("PATH", directory.path());
    });
    let error = error.err().expect("no program is on an empty path").to_string();
    assert!(error.contains("verilator cannot be started") && error.contains("apt-get install verilator"), "{error}");
}
