//! The accuracy table of the project: every bar of [`Figure::bar`] over 10⁶ seeded random fragments (a fifth of them without a full run) and all hard
//! cases, for each named profile. The worst fragment of a figure that breaks its bar is printed whole.

use roughxel_core::precision::Profile;
use roughxel_host_tests::space::whole_or;
use roughxel_study::accuracy::{Accuracy, FIGURES, Figure, measure};

fn holds_every_bar(profile: &str) {
    let p = Profile::by_name(profile).map(Profile::precision).expect("a listed profile exists");
    let fragments = whole_or(1_000_000, 200_000);
    let accuracy: Accuracy = measure(&p, fragments, &|_| ());
    assert!(accuracy.fragments > fragments, "random fragments and hard cases");
    assert_eq!(accuracy.wrong_faces, 0, "{profile}: faces away from ties");
    assert_eq!(accuracy.wrong_counts, 0, "{profile}: probe counts away from their boundaries");
    let mut broken = Vec::new();
    for (figure, name) in FIGURES {
        let worst = accuracy.worst(figure).expect("every figure is measured");
        // A figure to which hardly any fragment contributes would hold any bar.
        assert!(accuracy.counted(figure) > fragments / 4, "{profile} {name}: {} count", accuracy.counted(figure));
        let bar = figure.bar(profile);
        println!(
            "{profile:8} {name:9} 2^{:6.2} {:9.2e} bar {:9.2e} {}[{}]",
            worst.error.log2(),
            worst.error,
            bar.unwrap_or(f64::NAN),
            worst.set,
            worst.index
        );
        // NaN breaks a bar, too.
        if bar.is_some_and(|bar| worst.error.is_nan() || worst.error > bar) {
            broken.push(format!(
                "{name}: {} > {bar:?}, {}[{}] {:?}",
                worst.error, worst.set, worst.index, worst.fragment
            ));
        }
    }
    assert!(broken.is_empty(), "{profile}:\n{}", broken.join("\n"));
}

#[test]
fn narrow_holds_every_bar() {
    holds_every_bar("narrow");
}

#[test]
fn paper_holds_every_bar() {
    holds_every_bar("paper");
}

#[test]
fn compact_holds_every_bar() {
    holds_every_bar("compact");
}

#[test]
fn standard_holds_every_bar() {
    holds_every_bar("standard");
}

#[test]
fn precise_holds_every_bar() {
    holds_every_bar("precise");
}

#[test]
fn bars_do_not_loosen_from_profile_to_profile() {
    for (figure, name) in FIGURES {
        // Neither of the first two is better: `narrow` keeps fewer bits, `paper` makes coarser choices.
        for first in ["narrow", "paper"] {
            let bars = [first, "compact", "standard", "precise"].map(|profile| figure.bar(profile));
            assert!(bars.windows(2).all(|pair| pair[1] <= pair[0]), "{name}: {bars:?}");
        }
        assert_eq!(figure.bar("no such profile"), None);
    }
    assert_eq!(Figure::Coordinates.bar("standard"), Some(1.0 / 32768.0));
}
