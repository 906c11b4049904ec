//! `roughxel study` and `roughxel choose`: an interrupted study continues, the kept study is that of docs/performance.md, and the chosen profile is
//! right.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use roughxel_core::knob::Knob;
use roughxel_core::precision::Precision;
use roughxel_study::Subject;
use roughxel_study::choose::{Aim, Candidate, Clock, Meter, candidates, choose, measure};
use roughxel_study::frame_meter::{Against, FrameMeter};
use roughxel_study::host::Rounds;
use roughxel_study::measurement::{self, Parts, Settings, Study};
use roughxel_study::report::{BUYS_SOMETHING_DB, knob_gains, markdown, readme_plots};
use roughxel_study::soft_core::Machine;

use super::fixture::repository;

/// Settings of a study that takes a second.
fn tiny() -> Settings {
    let rounds = Rounds { count: 1, least_ms: 0 };
    Settings {
        name: "tiny".into(),
        scenes: vec!["lake".into()],
        size: [24, 18],
        samples_edge: 2,
        fragments: [64, 128],
        members: 1,
        rounds,
        timed_scenes: 1,
        frame_rounds: rounds,
    }
}

/// Runs the study over three points. Also returns the number of units that were measured rather than kept.
fn run(settings: &Settings, parts: &Parts) -> (Study, usize) {
    let points: Vec<_> = measurement::settings().into_iter().step_by(30).collect();
    let begun = AtomicUsize::new(0);
    let study = measurement::run(settings, &points, parts, &|_, done| {
        if done == 0 {
            begun.fetch_add(1, Ordering::Relaxed);
        }
    });
    (study.unwrap(), begun.into_inner())
}

/// Extracts the results that do not depend on the machine.
fn exact(study: &Study) -> String {
    let of_points = study
        .points
        .iter()
        .map(|point| format!("{:?} {:?} {:?} {:?}", point.stages, point.wrong, point.frames, point.hardware));
    let of_floats = study.floats.iter().map(|float| format!("{:?} {:?} {:?}", float.stages, float.wrong, float.psnr));
    let of_modes = study.modes.iter().map(|mode| format!("{:?}", mode.frames));
    let all: Vec<String> = of_points.chain(of_floats).chain(of_modes).collect();
    format!("{all:#?} {:?}", study.stability)
}

#[test]
fn an_interrupted_study_goes_on_and_finds_the_same() {
    let directory = tempfile::tempdir().unwrap();
    let (settings, file) = (tiny(), directory.path().join(Parts::file_name(&tiny())));
    let parts = Parts::open(directory.path(), &settings).unwrap();
    let (whole, _) = run(&settings, &parts);
    let units = parts.count();

    // Nothing is measured twice, times included.
    let (again, begun) = run(&settings, &Parts::open(directory.path(), &settings).unwrap());
    assert_eq!((&again, begun), (&whole, 0));

    // The file ends in the middle of a line.
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, &text[..text.len() / 2]).unwrap();
    let parts = Parts::open(directory.path(), &settings).unwrap();
    let kept = parts.count();
    assert!((1..units).contains(&kept), "{kept} of {units}");
    let (rest, begun) = run(&settings, &parts);
    assert!(begun > 0 && parts.count() == units);
    assert_eq!(exact(&rest), exact(&whole));
    assert_eq!(Parts::open(directory.path(), &settings).unwrap().count(), units, "every line is whole again");

    // Parts of a different study are not used.
    let other = Settings { members: 2, ..settings };
    assert_eq!(Parts::open(directory.path(), &other).unwrap().count(), 0);
    parts.remove().unwrap();
    assert!(!file.exists());
}

#[test]
fn another_kind_of_study_in_the_directory_drops_no_finished_unit() {
    let directory = tempfile::tempdir().unwrap();
    let [full, quick] = ["full", "quick"].map(|name| Settings { name: name.into(), ..tiny() });
    let parts = Parts::open(directory.path(), &full).unwrap();
    run(&full, &parts);
    assert_eq!(Parts::open(directory.path(), &quick).unwrap().count(), 0);
    assert_eq!(Parts::open(directory.path(), &full).unwrap().count(), parts.count());
}

#[test]
fn what_is_no_study_is_refused_with_its_reason() {
    let directory = tempfile::tempdir().unwrap();
    let problem = |path: &Path| Study::read(path).unwrap_err().to_string();
    assert!(problem(directory.path()).ends_with("it is no regular file but a directory"));
    let huge = directory.path().join("huge.json");
    fs::File::create(&huge).unwrap().set_len((1 << 26) + 1).unwrap();
    assert!(problem(&huge).ends_with("it is 67108865 bytes long, more than 67108864"));
    assert!(problem(&directory.path().join("none.json")).contains("cannot read"));
    #[cfg(unix)]
    {
        // Opening one would wait for ever.
        let pipe = directory.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(problem(&pipe).ends_with("it is no regular file but a pipe or a device"));
    }
}

/// Reads the study that docs/performance.md shows.
fn kept() -> Study {
    Study::read(&repository().join("emulator/study/results/study.json")).unwrap()
}

#[test]
fn the_page_of_figures_shows_the_study_that_is_kept() {
    let (study, page) = (kept(), fs::read_to_string(repository().join("docs/performance.md")).unwrap());
    let tables = markdown(&study);
    for table in tables.split("\n\n").filter(|table| !table.trim().is_empty()) {
        assert!(
            page.contains(table.trim()),
            "docs/performance.md has another table than tables.md of the study:\n{table}"
        );
    }
    for (name, svg) in readme_plots(&study) {
        assert!(page.contains(&format!("emulator/study/results/{name}")), "docs/performance.md shows {name}");
        let kept = fs::read_to_string(repository().join("emulator/study/results").join(name)).unwrap();
        assert!(kept == svg, "{name} is of another study");
    }
}

#[test]
fn every_knob_shows_in_a_scene() {
    let gains = knob_gains(&kept());
    for knob in Knob::ALL {
        let most = gains.iter().filter(|gain| gain.knob == knob.name()).map(|gain| gain.filter_db);
        let most = most.fold(0.0, f64::max);
        assert!(most >= BUYS_SOMETHING_DB, "{knob} changes no scene by more than {most} dB");
    }
}

/// Keeps the first measured costs, because on the host no two measurements are alike.
struct Remembered<'a>(FrameMeter<'a>, RefCell<HashMap<String, Option<f64>>>);

impl Remembered<'_> {
    fn cost(&self, clock: Clock, p: &Precision) -> Option<f64> {
        *self.1.borrow_mut().entry(format!("{clock} {p:?}")).or_insert_with(|| self.0.cost(clock, p))
    }
}

#[test]
fn the_choice_is_that_of_the_exhaustive_search_on_every_clock() {
    let subjects = [Subject::open("lake", [24, 18]).unwrap()];
    let meter = FrameMeter::new(&subjects, Against::Filter, Machine::default(), &|| ()).unwrap();
    let meter = Remembered(meter, RefCell::default());
    let precisions: Vec<Precision> = candidates().into_iter().step_by(31).collect();
    let psnr: Vec<f64> = precisions.iter().map(|p| meter.0.psnr(p)).collect();
    let mut sorted = psnr.clone();
    sorted.sort_by(f64::total_cmp);
    for clock in Clock::ALL {
        let cost: Vec<f64> = precisions.iter().map(|p| meter.cost(clock, p).expect("known on every clock")).collect();
        for bar in [sorted[2], sorted[sorted.len() / 2], sorted[sorted.len() - 1]] {
            let places = 0..precisions.len();
            let fits = places.filter(|&i| psnr[i] >= bar);
            let best = fits.min_by(|&a, &b| cost[a].total_cmp(&cost[b]).then(psnr[b].total_cmp(&psnr[a]))).unwrap();
            let aim = Aim::Psnr(bar);
            let measured: Vec<Candidate> =
                measure(&precisions, aim, clock, |p| meter.cost(clock, p), |p| meter.0.psnr(p));
            let chosen = choose(&measured, aim, clock).unwrap();
            assert_eq!((chosen.cost_on(clock), chosen.psnr), (Some(cost[best]), psnr[best]), "{clock}, {bar} dB");
        }
    }
}
