//! Generators of height, normal, roughness and colour maps, environments and a mesh.
//!
//! A generator is a pure function of its parameters. It asks the scene for them, with defaults and ranges.
//! `emulator/scenes/README.md` lists the parameters; a test compares the list with the generators.

mod colour;
mod environment;
mod font;
mod grid;
mod height;
mod keys;
mod knot;
pub(super) mod maths;
mod normal;
mod relief;
mod roughness;

use std::ops::Range;

use self::grid::Grid;
pub use self::grid::MapProgress;
pub(super) use self::grid::Unseen;
pub(super) use self::roughness::uniform_roughness;
use crate::error::SceneError;
use crate::source::Arguments;
use roughxel_assets::Picture;
use roughxel_utilities::suggestions::did_you_mean;

/// Name of the one generated roughness that is not a picture.
pub(super) const UNIFORM_ROUGHNESS: &str = "uniform";
/// Names of generated meshes.
const MESHES: [&str; 1] = ["knot"];

/// A generator: makes a map with the parameters of a table.
type Maker<T> = fn(Grid<'_>, &Arguments<'_>) -> Result<T, SceneError>;

/// Generators of one kind of map, by name.
pub(super) struct Generators<T: 'static> {
    what: &'static str,
    makers: &'static [(&'static str, Maker<T>)],
}

/// Height maps: grey from 0 to 1, wrapping without a seam (`earth`: along u only).
pub(super) const HEIGHT_MAPS: Generators<Picture> = Generators {
    what: "height map",
    makers: &[
        ("waves", height::waves),
        ("ripples", height::ripples),
        ("bumps", height::bumps),
        ("earth", height::earth),
        ("brushed", relief::brushed),
        ("corrugated", relief::corrugated),
        ("grooves", relief::grooves),
        ("hemispheres", relief::hemispheres),
        ("cylinders", relief::cylinders),
        ("denim", relief::denim),
    ],
};

/// Normal maps: (n + 1)/2 in tangent space, wrapping without a seam.
pub(super) const NORMAL_MAPS: Generators<Picture> =
    Generators { what: "normal map", makers: &[("hammered", normal::hammered)] };

/// Colour maps, linear.
pub(super) const COLOUR_MAPS: Generators<Picture> = Generators {
    what: "colour map",
    makers: &[
        ("checker", colour::checker),
        ("noise", colour::noise),
        ("writing", colour::writing),
        ("earth", colour::earth),
        ("denim", colour::denim),
    ],
};

/// Six faces of environments, linear.
pub(super) const ENVIRONMENTS: Generators<[Picture; 6]> = Generators {
    what: "environment",
    makers: &[
        ("moon", environment::moon),
        ("zebra", environment::zebra),
        ("checker", environment::checker),
        ("sky", environment::sky),
        ("studio", environment::studio),
    ],
};

impl<T> Generators<T> {
    /// The map of the generator `name`, which stands at `span`.
    pub(super) fn make(
        &self,
        arguments: &Arguments<'_>,
        (name, span): (&str, Range<usize>),
        progress: &dyn MapProgress,
    ) -> Result<T, SceneError> {
        if let Some((map, make)) = self.makers.iter().find(|(known, _)| *known == name) {
            return make(Grid { map, progress }, arguments);
        }
        let known = || self.makers.iter().map(|(known, _)| *known);
        let meant = did_you_mean(name, known());
        let help = format!("{meant}the generated ones are: {}", known().collect::<Vec<_>>().join(", "));
        Err(arguments.error_at(span, format!("there is no generated {} `{name}`", self.what), help))
    }
}

/// The OBJ text of the generated mesh `name`; `None` for an unknown name.
pub(super) fn mesh_text(name: &str) -> Option<String> {
    (name == "knot").then(knot::knot)
}

/// Names of the generated meshes, for messages.
pub(super) fn mesh_names() -> String {
    MESHES.join(", ")
}

#[cfg(test)]
mod tests {
    use super::keys::{BRIGHTEST, with_keys};
    use super::*;

    fn each_generator(keys: &str, mut check: impl FnMut(&str, &Arguments<'_>, Result<Vec<Picture>, SceneError>)) {
        for (name, make) in [HEIGHT_MAPS, NORMAL_MAPS, COLOUR_MAPS].iter().flat_map(|kind| kind.makers) {
            let make = |arguments: &Arguments<'_>| make(Grid::unseen(), arguments).map(|picture| vec![picture]);
            with_keys(keys, |arguments| check(name, arguments, make(arguments)));
        }
        for (name, make) in ENVIRONMENTS.makers {
            let make = |arguments: &Arguments<'_>| make(Grid::unseen(), arguments).map(Vec::from);
            with_keys(keys, |arguments| check(name, arguments, make(arguments)));
        }
        let pixel = |factor: [f64; 3]| vec![Picture::filled(1, 1, factor.map(|d| d as f32))];
        with_keys(keys, |arguments| check(UNIFORM_ROUGHNESS, arguments, uniform_roughness(arguments).map(pixel)));
    }

    #[test]
    fn generated_maps_are_finite_non_negative_and_the_same_every_time() {
        let mut first = Vec::new();
        let small = "size = 64, face_edge = 16";
        each_generator(small, |_, _, made| first.push(made.unwrap()));
        let mut index = 0;
        each_generator(small, |name, _, made| {
            let made = made.unwrap();
            assert!(made == first[index], "{name}");
            for picture in &made {
                assert_eq!(picture.pixels.len(), (picture.width * picture.height) as usize);
                assert!(
                    picture.pixels.iter().flatten().all(|value| (0.0..=BRIGHTEST as f32).contains(value)),
                    "{name}"
                );
            }
            index += 1;
        });
    }

    #[test]
    fn the_smallest_sizes_work() {
        each_generator("size = 4, face_edge = 1", |name, _, made| {
            assert!(made.is_ok(), "{name}");
        });
    }

    #[test]
    fn the_readme_names_every_parameter_with_its_default() {
        let readme = include_str!("../../scenes/README.md");
        // These sizes keep the test short; their defaults are recorded all the same.
        each_generator("size = 8, face_edge = 4", |name, arguments, _| {
            assert!(readme.contains(&format!("`{name}`")), "{name}");
            for (key, default) in arguments.asked() {
                let cell = format!("| `{key}` | {default} |");
                assert!(readme.contains(&cell), "{name}: no row `{cell}`");
            }
        });
    }
}
