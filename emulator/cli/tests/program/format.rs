//! Description of the format, and the tables that the program writes into it.

use fixed::types::I2F30;
use roughxel_core::plan::{Datapath, Effects, FootprintKind, FrameSystem, HorizonKind};
use roughxel_core::ports::{BlockVector, ReflectionIn, SurfaceIn};
use roughxel_core::precision::{Precision, RoughnessKind};
use roughxel_vectors::{Direction, Layout, export, in_page, tables};

use super::fixture::{Folder, repository, words};
use super::vectors::info;

/// Reads the committed description.
fn page() -> String {
    std::fs::read_to_string(repository().join("vectors/FORMAT.md")).unwrap()
}

#[test]
fn the_vector_worked_by_hand_in_the_format_description_is_what_the_program_writes() {
    let axis = |axis: usize, value: i32, exponent| {
        let mut mantissa = [I2F30::ZERO; 3];
        mantissa[axis] = I2F30::from_bits(value);
        BlockVector { mantissa, exponent }
    };
    let half = 1 << 29;
    let surface = SurfaceIn {
        normal: axis(2, half, 1),
        view: axis(2, half, 1),
        frame_vectors: [axis(1, half, 1), BlockVector::default()],
        ..SurfaceIn::default()
    };
    let dview = [axis(0, -half, -6), axis(1, half, -6)];
    let fragment = ReflectionIn { surface, dview, edge_texels: 512, ..ReflectionIn::default() };
    let directory = Folder::new();
    export(&info("example", "standard"), &[fragment], directory.path()).unwrap();
    let word = words(&directory.join("example_standard.hex")).swap_remove(0);
    let format = page();
    // The page breaks the word into lines after each group of fields.
    let page: String =
        format.split_once("```text\n").unwrap().1.split_once("```").unwrap().0.split_whitespace().collect();
    assert_eq!(page, word);
}

#[test]
fn the_format_description_has_the_tables_that_the_declarations_make() {
    let page = page();
    // `assert_eq` would print the page.
    let is_right = in_page(&page).is_ok_and(|again| again == page);
    assert!(is_right, "run `roughxel vectors format --write vectors/FORMAT.md`");
}

#[test]
fn the_format_command_prints_the_tables_or_puts_them_into_a_page() {
    let directory = Folder::new();
    let write = || directory.run("vectors format --write page.md");
    assert_eq!(directory.done("vectors format").out, tables());

    let committed = page();
    let (before, rest) = committed.split_once("-->\n").unwrap();
    let (_, after) = rest.split_once("<!--").unwrap();
    directory.write("page.md", format!("{before}-->\nwhat was there\n<!--{after}"));
    write().ends(0);
    assert!(directory.read("page.md") == committed);
    for page in ["no marks", &format!("{before}-->\n"), &committed.repeat(2)] {
        directory.write("page.md", page);
        write().ends(1).complains(&["page.md"]);
        assert!(directory.read("page.md") == page);
    }
}

/// Lists the fields of a datapath in the order of the tables.
fn in_tables(datapath: Datapath) -> Vec<String> {
    let tables = tables();
    let table = tables.split_once(&format!("`{}`", datapath.name())).unwrap().1;
    let rows = table.lines().skip_while(|line| !line.starts_with("| `")).take_while(|line| line.starts_with('|'));
    let mut names = Vec::new();
    for row in rows {
        let mut stem = String::new();
        for part in row.split('|').nth(1).unwrap().split(['`', ' ', '(', ')', ',']).filter(|part| !part.is_empty()) {
            if part.starts_with('_') {
                names.push(format!("{stem}{part}"));
            } else {
                stem = part.rsplit_once('_').map_or("", |(stem, _)| stem).into();
                names.push(part.into());
            }
        }
    }
    names
}

#[test]
fn every_field_of_every_set_is_in_the_tables_and_in_their_order() {
    for datapath in Datapath::ALL {
        let listed = in_tables(datapath);
        for frame in [FrameSystem::MainDirection, FrameSystem::Natural, FrameSystem::NaturalNormalised] {
            for roughness in [RoughnessKind::None, RoughnessKind::Isotropic, RoughnessKind::Anisotropic] {
                for on in 0..16 {
                    let [bump, curvature, horizon] = [0, 1, 3].map(|bit| on >> bit & 1 == 1);
                    let footprint = if on >> 2 & 1 == 1 { FootprintKind::Face } else { FootprintKind::None };
                    let horizon = if horizon { HorizonKind::Correlated } else { HorizonKind::None };
                    let effects = Effects { bump, frame, roughness, curvature, footprint, horizon };
                    if effects != effects.restricted_to(datapath) {
                        continue;
                    }
                    let layout = Layout::new(datapath, &effects, &Precision::COMPACT, true);
                    let mut rest = listed.iter();
                    for field in layout.fields().iter().filter(|field| field.direction != Direction::Check) {
                        assert!(rest.any(|name| *name == field.name), "{}: {effects:?}", field.name);
                    }
                }
            }
        }
    }
}
