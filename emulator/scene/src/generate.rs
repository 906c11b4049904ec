//! What the program makes itself: height, normal, roughness and colour maps, environments, a mesh.
//!
//! A generator is a pure function of its parameters. This file asks the scene for them, with defaults and ranges;
//! `emulator/scenes/README.md` lists them, and a test holds the two together.

mod colour;
mod environment;
mod font;
mod grid;
mod height;
mod knot;
pub(super) mod maths;
mod normal;
mod relief;
mod roughness;

use std::ops::Range;

use self::grid::Grid;
pub use self::grid::MapProgress;
pub(super) use self::grid::Unseen;
use crate::error::SceneError;
use crate::picture::Picture;
use crate::roughness::MAX_DEVIATION;
use crate::source::Arguments;
use roughxel_utilities::limits::MAX_FACE_EDGE;
use roughxel_utilities::spelling::did_you_mean;

/// Edges of generated maps, texels.
const SIZES: std::ops::RangeInclusive<u32> = 4..=4096;
/// Brightest value of an environment's colour, where white is 1.
const BRIGHTEST: f64 = 1000.0;

/// Names of generated height maps.
const HEIGHT_MAPS: [&str; 10] =
    ["waves", "ripples", "bumps", "earth", "brushed", "corrugated", "grooves", "hemispheres", "cylinders", "denim"];
/// Names of generated normal maps.
const NORMAL_MAPS: [&str; 1] = ["hammered"];
/// Name of the one generated roughness that is no picture.
pub(super) const UNIFORM_ROUGHNESS: &str = "uniform";
/// Names of generated meshes.
const MESHES: [&str; 1] = ["knot"];
/// Names of generated colour maps.
const COLOUR_MAPS: [&str; 5] = ["checker", "noise", "writing", "earth", "denim"];
/// Names of generated environments.
const ENVIRONMENTS: [&str; 5] = ["moon", "zebra", "checker", "sky", "studio"];

/// The generated height map `name`: grey from 0 to 1, repeating without a seam (`earth`: along u).
pub(super) fn height_map(
    arguments: &Arguments<'_>,
    name: &str,
    span: Range<usize>,
    progress: &dyn MapProgress,
) -> Result<Picture, SceneError> {
    let grid = Grid { map: name, progress };
    match name {
        "waves" => Ok(height::waves(
            grid,
            &height::Waves {
                size: arguments.whole("size", 512, SIZES)?,
                seed: seed(arguments)?,
                count: arguments.whole("count", 64, 1..=1024)?,
                lowest: arguments.number("lowest", 3.0, 1.0..=1024.0)?,
                highest: arguments.number("highest", 64.0, 1.0..=1024.0)?,
                direction_degrees: arguments.number("direction_degrees", 90.0, -360.0..=360.0)?,
                spread_degrees: arguments.number("spread_degrees", 60.0, 0.0..=180.0)?,
                falloff: arguments.number("falloff", 0.5, -4.0..=4.0)?,
            },
        )),
        "ripples" => Ok(height::ripples(
            grid,
            &height::Ripples {
                size: arguments.whole("size", 512, SIZES)?,
                seed: seed(arguments)?,
                drops: arguments.whole("drops", 8, 1..=256)?,
                rings: arguments.number("rings", 12.0, 0.5..=256.0)?,
                reach: arguments.number("reach", 0.3, 0.01..=0.5)?,
            },
        )),
        "bumps" => Ok(height::bumps(
            grid,
            &height::Bumps {
                size: arguments.whole("size", 512, SIZES)?,
                seed: seed(arguments)?,
                cells: arguments.whole("cells", 8, 1..=512)?,
                octaves: arguments.whole("octaves", 3, 1..=8)?,
                gain: arguments.number("gain", 0.5, 0.0..=1.0)?,
            },
        )),
        "earth" => Ok(height::earth(grid, &earth(arguments)?)),
        "brushed" => Ok(relief::brushed(
            grid,
            &relief::Brushed {
                size: arguments.whole("size", 512, SIZES)?,
                seed: seed(arguments)?,
                scratches: arguments.whole("scratches", 2000, 1..=20_000)?,
                length: arguments.number("length", 0.5, 0.01..=1.0)?,
                width_texels: arguments.number("width_texels", 4.0, 2.0..=16.0)?,
                spread_degrees: arguments.number("spread_degrees", 2.0, 0.0..=30.0)?,
            },
        )),
        "corrugated" => Ok(relief::corrugated(grid, &profile(arguments)?)),
        "grooves" => Ok(relief::grooves(grid, &profile(arguments)?)),
        "hemispheres" => Ok(relief::hemispheres(grid, &round(arguments)?)),
        "cylinders" => Ok(relief::cylinders(grid, &round(arguments)?)),
        "denim" => Ok(relief::denim(grid, &denim(arguments)?)),
        _ => Err(unknown(arguments, "height map", name, span, &HEIGHT_MAPS)),
    }
}

/// The generated normal map `name`: (n + 1)/2 in tangent space, repeating without a seam.
pub(super) fn normal_map(
    arguments: &Arguments<'_>,
    name: &str,
    span: Range<usize>,
    progress: &dyn MapProgress,
) -> Result<Picture, SceneError> {
    let grid = Grid { map: name, progress };
    match name {
        "hammered" => Ok(normal::hammered(
            grid,
            &normal::Hammered {
                size: arguments.whole("size", 512, SIZES)?,
                seed: seed(arguments)?,
                dents: arguments.whole("dents", 8, 2..=256)?,
                slope: arguments.number("slope", 0.25, 0.0..=2.0)?,
            },
        )),
        _ => Err(unknown(arguments, "normal map", name, span, &NORMAL_MAPS)),
    }
}

/// d₁, d₂, d₃ of the roughness [`UNIFORM_ROUGHNESS`].
pub(super) fn uniform_roughness(arguments: &Arguments<'_>) -> Result<[f64; 3], SceneError> {
    let uniform = roughness::Uniform {
        along: arguments.number("along", 0.1, 0.0..=MAX_DEVIATION)?,
        across: arguments.number("across", 0.1, 0.0..=MAX_DEVIATION)?,
        direction_degrees: arguments.number("direction_degrees", 0.0, -360.0..=360.0)?,
    };
    Ok(uniform.factor())
}

/// The OBJ text of the generated mesh `name`; `None` for a name that is not known.
pub(super) fn mesh_text(name: &str) -> Option<String> {
    (name == "knot").then(knot::knot)
}

/// The generated meshes, for messages.
pub(super) fn mesh_names() -> String {
    MESHES.join(", ")
}

/// The generated colour map `name`, linear.
pub(super) fn colour_map(
    arguments: &Arguments<'_>,
    name: &str,
    span: Range<usize>,
    progress: &dyn MapProgress,
) -> Result<Picture, SceneError> {
    let grid = Grid { map: name, progress };
    match name {
        "checker" => Ok(colour::checker(
            grid,
            &colour::Checker {
                size: arguments.whole("size", 512, SIZES)?,
                squares: arguments.whole("squares", 64, 2..=4096)?,
                colours: colours(arguments, [1.0; 3], [0.0; 3], 1.0)?,
            },
        )),
        "noise" => Ok(colour::noise(
            grid,
            &colour::Noise {
                size: arguments.whole("size", 512, SIZES)?,
                seed: seed(arguments)?,
                cell_texels: arguments.whole("cell_texels", 4, 1..=1024)?,
                colours: colours(arguments, [1.0; 3], [0.0; 3], 1.0)?,
            },
        )),
        "writing" => writing(grid, arguments),
        "earth" => {
            Ok(colour::earth(grid, &earth(arguments)?, arguments.number("graticule_degrees", 15.0, 0.0..=90.0)?))
        }
        "denim" => {
            let denim = denim(arguments)?;
            let warp = arguments.colour("warp", [0.03, 0.06, 0.2], 1.0)?;
            Ok(colour::denim(grid, &denim, [warp, arguments.colour("weft", [0.55, 0.55, 0.5], 1.0)?]))
        }
        _ => Err(unknown(arguments, "colour map", name, span, &COLOUR_MAPS)),
    }
}

/// The six faces of the generated environment `name`, linear.
pub(super) fn environment(
    arguments: &Arguments<'_>,
    name: &str,
    span: Range<usize>,
    progress: &dyn MapProgress,
) -> Result<[Picture; 6], SceneError> {
    let grid = Grid { map: name, progress };
    let face_edge = arguments.whole("face_edge", 256, 1..=MAX_FACE_EDGE)?;
    let colour = |key, default| arguments.colour(key, default, BRIGHTEST);
    match name {
        "moon" => {
            let moon = environment::Moon {
                elevation_degrees: arguments.number("elevation_degrees", 9.0, -90.0..=90.0)?,
                azimuth_degrees: arguments.number("azimuth_degrees", 0.0, -360.0..=360.0)?,
                radius_degrees: arguments.number("radius_degrees", 2.5, 0.1..=45.0)?,
                moon: colour("moon", [16.0, 14.5, 11.5])?,
                glow: colour("glow", [0.25, 0.24, 0.22])?,
                glow_degrees: arguments.number("glow_degrees", 8.0, 0.1..=90.0)?,
                zenith: colour("zenith", [0.004, 0.007, 0.02])?,
                horizon: colour("horizon", [0.035, 0.05, 0.09])?,
                ground: colour("ground", [0.004, 0.005, 0.008])?,
            };
            Ok(environment::moon(grid, &moon, face_edge))
        }
        "zebra" => {
            let zebra = environment::Zebra {
                seed: seed(arguments)?,
                stripes: arguments.number("stripes", 5.0, 0.25..=64.0)?,
                bend_degrees: arguments.number("bend_degrees", 24.0, 0.0..=90.0)?,
                unevenness: arguments.number("unevenness", 0.25, 0.0..=0.9)?,
                softness: arguments.number("softness", 0.12, 0.0..=2.0)?,
                colours: colours(arguments, [0.9, 0.88, 0.84], [0.015, 0.012, 0.01], BRIGHTEST)?,
            };
            Ok(environment::zebra(grid, &zebra, face_edge))
        }
        "checker" => {
            let checker = environment::Checker {
                squares: arguments.whole("squares", 8, 1..=2048)?,
                tint: arguments.number("tint", 0.5, 0.0..=1.0)?,
                colours: colours(arguments, [0.9; 3], [0.05; 3], BRIGHTEST)?,
            };
            Ok(environment::checker(grid, &checker, face_edge))
        }
        "sky" => {
            let sky = environment::Sky {
                zenith: colour("zenith", [0.12, 0.28, 0.7])?,
                horizon: colour("horizon", [0.75, 0.85, 0.95])?,
                ground: colour("ground", [0.2, 0.17, 0.13])?,
                sun: colour("sun", [12.0, 11.0, 9.0])?,
                elevation_degrees: arguments.number("elevation_degrees", 40.0, -90.0..=90.0)?,
                azimuth_degrees: arguments.number("azimuth_degrees", -60.0, -360.0..=360.0)?,
                radius_degrees: arguments.number("radius_degrees", 3.0, 0.1..=45.0)?,
            };
            Ok(environment::sky(grid, &sky, face_edge))
        }
        "studio" => {
            let studio = environment::Studio {
                wall: colour("wall", [0.12, 0.12, 0.13])?,
                floor: colour("floor", [0.05, 0.045, 0.04])?,
                light: colour("light", [3.0, 2.9, 2.7])?,
            };
            Ok(environment::studio(grid, &studio, face_edge))
        }
        _ => Err(unknown(arguments, "environment", name, span, &ENVIRONMENTS)),
    }
}

fn writing(grid: Grid<'_>, arguments: &Arguments<'_>) -> Result<Picture, SceneError> {
    let size = arguments.whole("size", 1024, SIZES)?;
    let text = arguments.text("text")?;
    let lines: Vec<String> =
        text.as_ref().map_or("CAN YOU\nREAD THIS", |(text, _)| text).lines().map(str::to_uppercase).collect();
    if let Some((_, span)) = text {
        let foreign = lines.iter().flat_map(|line| line.chars()).find(|&letter| font::glyph(letter).is_none());
        if let Some(letter) = foreign {
            let help = format!("the letters are {}", font::LETTERS);
            return Err(arguments.error_at(span, format!("there is no letter `{letter}`"), help));
        }
        let longest = lines.iter().map(|line| line.chars().count()).max().unwrap_or(0);
        if longest == 0 || longest > 64 || lines.len() > 16 {
            let message = format!("{} lines of up to {longest} letters do not fit", lines.len());
            return Err(arguments.error_at(span, message, "write 1 to 16 lines of 1 to 64 letters"));
        }
    }
    let frame = arguments.numbers("box", [0.45, 0.35, 0.96, 0.96], 0.0..=1.0)?;
    let [left, bottom, right, top] = frame;
    if right - left < 0.01 || top - bottom < 0.01 {
        return Err(
            arguments.error("`box` is empty", "give [left, bottom, right, top] with left < right, bottom < top")
        );
    }
    Ok(colour::writing(
        grid,
        &colour::Writing {
            size,
            lines,
            frame,
            maze_cells: arguments.whole("maze_cells", 28, 0..=256)?,
            paper: arguments.colour("paper", [0.88, 0.84, 0.72], 1.0)?,
            ink: arguments.colour("ink", [0.02, 0.02, 0.05], 1.0)?,
            line: arguments.colour("line", [0.3, 0.45, 0.65], 1.0)?,
        },
    ))
}

fn earth(arguments: &Arguments<'_>) -> Result<height::Earth, SceneError> {
    Ok(height::Earth {
        size: arguments.whole("size", 512, SIZES)?,
        seed: seed(arguments)?,
        detail: arguments.number("detail", 1.6, 0.25..=16.0)?,
        octaves: arguments.whole("octaves", 6, 1..=10)?,
        sea: arguments.number("sea", 0.55, 0.0..=1.0)?,
    })
}

fn profile(arguments: &Arguments<'_>) -> Result<relief::Profile, SceneError> {
    let periods = [arguments.whole("periods_u", 8, 0..=1024)?, arguments.whole("periods_v", 0, 0..=1024)?];
    if periods == [0; 2] {
        return Err(arguments.error("the profile has no period", "give `periods_u` or `periods_v` above 0"));
    }
    Ok(relief::Profile { size: arguments.whole("size", 512, SIZES)?, periods })
}

fn round(arguments: &Arguments<'_>) -> Result<relief::Round, SceneError> {
    Ok(relief::Round {
        size: arguments.whole("size", 512, SIZES)?,
        count: arguments.whole("count", 4, 1..=1024)?,
        rim: arguments.number("rim", 0.9, 0.01..=0.98)?,
    })
}

fn denim(arguments: &Arguments<'_>) -> Result<relief::Denim, SceneError> {
    Ok(relief::Denim {
        size: arguments.whole("size", 512, SIZES)?,
        threads: arguments.whole("threads", 16, 4..=1024)?,
        twist: arguments.number("twist", 0.1, 0.0..=1.0)?,
    })
}

fn seed(arguments: &Arguments<'_>) -> Result<u32, SceneError> {
    arguments.whole("seed", 1, 0..=u32::MAX)
}

fn colours(
    arguments: &Arguments<'_>,
    light: [f32; 3],
    dark: [f32; 3],
    brightest: f64,
) -> Result<[[f32; 3]; 2], SceneError> {
    Ok([arguments.colour("light", light, brightest)?, arguments.colour("dark", dark, brightest)?])
}

fn unknown(arguments: &Arguments<'_>, what: &str, name: &str, span: Range<usize>, known: &[&str]) -> SceneError {
    let meant = did_you_mean(name, known.iter().copied());
    let help = format!("{meant}the generated ones are: {}", known.join(", "));
    arguments.error_at(span, format!("there is no generated {what} `{name}`"), help)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use toml::Spanned;

    use super::*;
    use crate::source::{ArgumentTable, Source};

    type Maker = fn(&Arguments<'_>, &str, Range<usize>) -> Result<Vec<Picture>, SceneError>;

    const MAKERS: [(&[&str], Maker); 5] = [
        (&HEIGHT_MAPS, |arguments, name, span| height_map(arguments, name, span, &Unseen).map(|picture| vec![picture])),
        (&NORMAL_MAPS, |arguments, name, span| normal_map(arguments, name, span, &Unseen).map(|picture| vec![picture])),
        (&[UNIFORM_ROUGHNESS], |arguments, _, _| {
            let d = uniform_roughness(arguments)?.map(|d| d as f32);
            Ok(vec![Picture { width: 1, height: 1, pixels: vec![d] }])
        }),
        (&COLOUR_MAPS, |arguments, name, span| colour_map(arguments, name, span, &Unseen).map(|picture| vec![picture])),
        (&ENVIRONMENTS, |arguments, name, span| {
            environment(arguments, name, span, &Unseen).map(|faces| faces.to_vec())
        }),
    ];

    #[derive(serde::Deserialize)]
    struct OneTable {
        table: Spanned<ArgumentTable>,
    }

    fn each_generator(text: &str, mut check: impl FnMut(&str, &Arguments<'_>, Result<Vec<Picture>, SceneError>)) {
        let source = Source::new("test", text, Path::new(""));
        let one: OneTable = toml::from_str(text).unwrap();
        for (names, make) in MAKERS {
            for name in names {
                let arguments = Arguments::new(&source, &one.table);
                let made = make(&arguments, name, 0..0);
                check(name, &arguments, made);
            }
        }
    }

    #[test]
    fn generated_maps_are_finite_non_negative_and_the_same_every_time() {
        let mut first = Vec::new();
        let small = "table = { size = 64, face_edge = 16 }";
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
        each_generator("table = { size = 4, face_edge = 1 }", |name, _, made| {
            assert!(made.is_ok(), "{name}");
        });
    }

    #[test]
    fn the_readme_names_every_parameter_with_its_default() {
        let readme = include_str!("../../scenes/README.md");
        // Sizes of their own keep the test short; their defaults are recorded all the same.
        each_generator("table = { size = 8, face_edge = 4 }", |name, arguments, _| {
            assert!(readme.contains(&format!("`{name}`")), "{name}");
            for (key, default) in arguments.asked() {
                let cell = format!("| `{key}` | {default} |");
                assert!(readme.contains(&cell), "{name}: no row `{cell}`");
            }
        });
    }
}
