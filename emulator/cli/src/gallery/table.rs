//! Scenes of the gallery and their columns: one entry for each picture of the papers.

use roughxel_frame::plan::Mode;
use roughxel_shader::Effect;

use super::change::{
    Change, footprints_on_a_face, isotropic_roughness, natural_frame, natural_normalised_frame, no_shadowing,
    no_texture, plain_highlight, printed_highlight, product_of_shares, single_normal,
};
use super::entry::{Column, Entry};

/// One sample a pixel. Times are compared with it.
pub const UNFILTERED: Column = plain("unfiltered", Mode::Unfiltered);
/// The footprint filter, the default.
pub const FILTERED: Column = plain("filtered", Mode::Footprint);
/// F92's supersampling.
pub const SAMPLES_16: Column = plain("16 samples", Mode::Supersampled { edge: 4 });
/// Label of a smooth surface of one colour, the first column of F92.
pub const NO_TEXTURE: &str = "no texture";

/// One trilinear probe.
const ISOTROPIC: Column = plain("isotropic", Mode::Isotropic);
/// Roughness by its widest direction only.
const ISOTROPIC_ROUGHNESS: Change = Change::Profile(isotropic_roughness);

/// The first column of F92's table of times.
const SMOOTH: Column = Column { label: NO_TEXTURE, mode: Mode::Unfiltered, change: Change::Scene(no_texture) };
/// One normal in place of the peaks of a multiple surface.
const SINGLE_NORMAL: Column = changed("single normal", Change::Scene(single_normal));
const NO_SHADOWING: Column = changed("without shadowing", Change::Scene(no_shadowing));

/// Footprints on a cube face, as in W97.
const ON_A_FACE: Column = changed("on a face", Change::Scene(footprints_on_a_face));

/// Product of shares, as in F92.
const PRODUCT_OF_SHARES: Column = changed("product of shares", Change::Scene(product_of_shares));

const fn plain(label: &'static str, mode: Mode) -> Column {
    Column { label, mode, change: Change::Nothing }
}

/// Makes the filtered column of a changed scene.
const fn changed(label: &'static str, change: Change) -> Column {
    Column { label, mode: Mode::Footprint, change }
}

/// All scenes, in the order of the page.
pub const ENTRIES: &[Entry] = &[
    Entry {
        name: "puzzle",
        source: "S97 Fig. 1–2",
        shows: "Writing on a plane at a flat angle can be read where the texture is filtered along the footprint.",
        columns: &[UNFILTERED, plain("trilinear", Mode::Isotropic), FILTERED, SAMPLES_16],
    },
    Entry {
        name: "lake",
        source: "S97 Fig. 10–11",
        shows: "Waves that no pixel resolves stretch the moon's reflection towards the viewer.",
        columns: &[UNFILTERED, ISOTROPIC, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "zebra",
        source: "S97 Fig. 12–13",
        shows: "Stripes all around, reflected in a flat plane with bumps far below a pixel.",
        columns: &[UNFILTERED, ISOTROPIC, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "globe",
        source: "S97 §7, system 3",
        shows: "With the axis of the earth as main direction, bumps keep their height and direction up to both poles.",
        columns: &[
            UNFILTERED,
            changed("system 1", Change::Scene(natural_frame)),
            changed("system 2", Change::Scene(natural_normalised_frame)),
            FILTERED,
            SAMPLES_16,
        ],
    },
    Entry {
        name: "cylinder-mirror",
        source: "W97, problem section",
        shows: "A cylinder curves in one direction only, so its reflections need an anisotropic footprint.",
        columns: &[UNFILTERED, ISOTROPIC, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "parabola",
        source: "W97, compensation example",
        shows: "In a parabolic mirror seen from its focus aperture and curvature cancel, and the picture stays sharp.",
        columns: &[UNFILTERED, changed("without curvature", Change::Without(Effect::Curvature)), FILTERED, SAMPLES_16],
    },
    Entry {
        name: "corrugated",
        source: "S97 §8",
        shows: "Corrugated iron scatters across its folds only.",
        columns: &[UNFILTERED, changed("isotropic roughness", ISOTROPIC_ROUGHNESS), FILTERED, SAMPLES_16],
    },
    Entry {
        name: "brushed",
        source: "S97 §8",
        shows: "Brushed metal scatters across its scratches only.",
        columns: &[UNFILTERED, changed("isotropic roughness", ISOTROPIC_ROUGHNESS), ON_A_FACE, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "highlight",
        source: "S97 Appendix A",
        shows: "Highlights spread by roughness, isotropic and anisotropic, by the formula as printed and as corrected.",
        columns: &[
            UNFILTERED,
            changed("plain Blinn-Phong", Change::Scene(plain_highlight)),
            changed("printed formula", Change::Scene(printed_highlight)),
            changed("isotropic roughness", ISOTROPIC_ROUGHNESS),
            FILTERED,
            SAMPLES_16,
        ],
    },
    Entry {
        name: "cylinders-plane",
        source: "F92 Fig. 4",
        shows: "Half cylinders side by side turn into an anisotropic surface in the distance.",
        columns: &[SMOOTH, UNFILTERED, ISOTROPIC, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "spheres-plane",
        source: "F92 Fig. 5",
        shows: "Hemispheres on a plane keep the light of their facets in the distance.",
        columns: &[SMOOTH, UNFILTERED, ISOTROPIC, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "spheres-sphere",
        source: "F92 Fig. 6",
        shows: "Hemispheres on a sphere keep the light of their facets up to its outline.",
        columns: &[SMOOTH, UNFILTERED, ISOTROPIC, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "denim-plane",
        source: "F92 Fig. 7",
        shows: "Denim: the twill is seen nearby and keeps its sheen in the distance.",
        columns: &[SMOOTH, UNFILTERED, ISOTROPIC, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "denim-drapery",
        source: "F92 Fig. 8",
        shows: "The denim of the plane on hanging cloth.",
        columns: &[UNFILTERED, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "three-normals",
        source: "F92 Fig. 9",
        shows: "A sphere that has three normals at every point.",
        columns: &[SINGLE_NORMAL, UNFILTERED, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "anisotropic-sphere",
        source: "F92 Fig. 9",
        shows: "A sphere whose normals at every point stand in one direction.",
        columns: &[SINGLE_NORMAL, UNFILTERED, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "velvet",
        source: "F92 Fig. 10",
        shows: "Velvet, by the printed table of normals.",
        columns: &[SINGLE_NORMAL, UNFILTERED, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "silk",
        source: "F92 Fig. 11",
        shows: "Silk, by the printed table of normals.",
        columns: &[SINGLE_NORMAL, UNFILTERED, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "horizon-plane",
        source: "F92 Fig. 13",
        shows: "Bumps on a plane that hide each other from the light and from the eye.",
        columns: &[UNFILTERED, NO_SHADOWING, PRODUCT_OF_SHARES, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "horizon-sphere",
        source: "F92 Fig. 14",
        shows: "Bumps on a sphere that hide each other from the light and from the eye.",
        columns: &[UNFILTERED, NO_SHADOWING, FILTERED, SAMPLES_16],
    },
    Entry {
        name: "mesh",
        source: "any OBJ with a normal map",
        shows: "A mesh with texture coordinates, a normal map and an environment.",
        columns: &[UNFILTERED, FILTERED, SAMPLES_16],
    },
];

/// Finds the entry with a name.
pub fn entry(name: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use roughxel_scene::builtin_names;
    use std::collections::HashSet;

    #[test]
    fn every_entry_is_a_built_in_scene_and_stands_once() {
        let known: Vec<&str> = builtin_names().collect();
        let names: HashSet<&str> = ENTRIES.iter().map(|entry| entry.name).collect();
        assert_eq!(names.len(), ENTRIES.len());
        for entry in ENTRIES {
            assert!(known.contains(&entry.name), "{}", entry.name);
            assert!(!entry.source.is_empty() && entry.shows.ends_with('.'), "{}", entry.name);
        }
    }

    #[test]
    fn every_entry_has_the_three_columns_that_figures_are_taken_from() {
        for entry in ENTRIES {
            for wanted in [UNFILTERED, FILTERED, SAMPLES_16] {
                let is_it = |c: &&Column| {
                    (c.label, c.mode) == (wanted.label, wanted.mode) && matches!(c.change, Change::Nothing)
                };
                assert_eq!(entry.columns.iter().filter(is_it).count(), 1, "{}: {}", entry.name, wanted.label);
            }
            let files: HashSet<String> = entry.columns.iter().map(Column::stem).collect();
            assert_eq!(files.len(), entry.columns.len(), "{}", entry.name);
            // The scene has other files with these names.
            assert!(!files.contains("reference") && !files.contains("side-by-side"), "{}", entry.name);
            assert!(!files.iter().any(|stem| stem.starts_with("difference-")), "{}", entry.name);
        }
    }
}
