//! Generated colour maps, linear.

use super::font::{GLYPH_COLUMNS, GLYPH_ROWS, LETTERS, glyph};
use super::grid::Grid;
use super::height::Earth;
use super::maths::{hash, mix, smoothstep, unit};
use super::relief::Denim;
use crate::error::SceneError;
use crate::source::Arguments;
use roughxel_assets::Picture;

/// Squares of two colours.
pub(super) fn checker(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let size = keys.size(512)?;
    // Squares along an edge; an odd number gives the map a seam.
    let squares = keys.whole("squares", 64, 2..=4096)?;
    let colours = keys.two_colours([1.0; 3], [0.0; 3], 1.0)?;
    let square_of = |index: u32| u64::from(index) * u64::from(squares) / u64::from(size);
    let pixels = grid.square(size, |column, row| colours[((square_of(column) + square_of(row)) % 2) as usize]);
    Ok(Picture { width: size, height: size, pixels })
}

/// Squares of uniformly random brightness.
pub(super) fn noise(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let (size, seed) = (keys.size(512)?, keys.seed()?);
    let cell_texels = keys.whole("cell_texels", 4, 1..=1024)?;
    let [light, dark] = keys.two_colours([1.0; 3], [0.0; 3], 1.0)?;
    let pixels = grid.square(size, |column, row| {
        let [x, y] = [column, row].map(|index| i64::from(index / cell_texels));
        mix(dark, light, unit(hash(seed.into(), x, y, 2)))
    });
    Ok(Picture { width: size, height: size, pixels })
}

/// Samples along the edge of a texel.
const SAMPLES: usize = 4;

/// Content of a column or a row of samples of a page.
struct Line {
    /// Letter or line of the writing, and the cell of its glyph.
    writing: Option<(usize, usize)>,
    /// True if it is within the margin around the writing.
    is_beside_writing: bool,
    /// True if it is within the margin of the page.
    is_on_page: bool,
    /// Cell of the maze, and the place in it.
    cell: i64,
    place: f64,
}

/// Lines of letters of the font, from the top.
fn lines(keys: &Arguments<'_>) -> Result<Vec<String>, SceneError> {
    let text = keys.text("text")?;
    let lines: Vec<String> =
        text.as_ref().map_or("CAN YOU\nREAD THIS", |(text, _)| text).lines().map(str::to_uppercase).collect();
    if let Some((_, span)) = text {
        let foreign = lines.iter().flat_map(|line| line.chars()).find(|&letter| glyph(letter).is_none());
        if let Some(letter) = foreign {
            let help = format!("the letters are {LETTERS}");
            return Err(keys.error_at(span, format!("there is no letter `{letter}`"), help));
        }
        let longest = lines.iter().map(|line| line.chars().count()).max().unwrap_or(0);
        if longest == 0 || longest > 64 || lines.len() > 16 {
            let message = format!("{} lines of up to {longest} letters do not fit", lines.len());
            return Err(keys.error_at(span, message, "write 1 to 16 lines of 1 to 64 letters"));
        }
    }
    Ok(lines)
}

/// A page from a puzzle book (S97 Fig. 1): a maze, and writing stretched so far that it is legible only at a flat
/// angle.
pub(super) fn writing(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    type Glyph = Option<[u8; GLYPH_ROWS]>;
    let size = keys.size(1024)?;
    let letters: Vec<Vec<Glyph>> = lines(keys)?.iter().map(|line| line.chars().map(glyph).collect()).collect();
    let longest = letters.iter().map(Vec::len).max().unwrap_or(1).max(1);
    // The letters fill the box.
    let [left, bottom, right, top] = keys.numbers("box", [0.45, 0.35, 0.96, 0.96], 0.0..=1.0)?;
    if right - left < 0.01 || top - bottom < 0.01 {
        return Err(keys.error("`box` is empty", "give [left, bottom, right, top] with left < right, bottom < top"));
    }
    // Cells along an edge; 0 for no maze.
    let maze_cells = keys.whole("maze_cells", 28, 0..=256)?;
    let paper = keys.colour("paper", [0.88, 0.84, 0.72], 1.0)?;
    let ink_colour = keys.colour("ink", [0.02, 0.02, 0.05], 1.0)?;
    let maze_colour = keys.colour("line", [0.3, 0.45, 0.65], 1.0)?;
    let margin = 0.02;
    let line = |at: f64, [from, to]: [f64; 2], in_cells: f64, cells: usize| {
        let place = at * f64::from(maze_cells);
        Line {
            // One column and one row of space follow each letter and line.
            writing: (in_cells >= 0.0).then_some((in_cells as usize / (cells + 1), in_cells as usize % (cells + 1))),
            is_beside_writing: at > from - margin && at < to + margin,
            is_on_page: at > margin && at < 1.0 - margin,
            cell: place.floor() as i64,
            place: place - place.floor(),
        }
    };
    let samples = || (0..size as usize * SAMPLES).map(|step| (step / SAMPLES, step % SAMPLES));
    let at = |(texel, step): (usize, usize)| (texel as f64 + (step as f64 + 0.5) / SAMPLES as f64) / f64::from(size);
    let columns: Vec<Line> = samples()
        .map(|sample| {
            let u = at(sample);
            let across = (u - left) / (right - left) * (longest * (GLYPH_COLUMNS + 1)) as f64;
            line(u, [left, right], across, GLYPH_COLUMNS)
        })
        .collect();
    let rows: Vec<Line> = samples()
        .map(|sample| {
            let v = 1.0 - at(sample);
            let down = (top - v) / (top - bottom) * (letters.len() * (GLYPH_ROWS + 1)) as f64;
            line(v, [bottom, top], down, GLYPH_ROWS)
        })
        .collect();
    let is_ink = |column: &Line, row: &Line| {
        let (Some((letter, column)), Some((line, row))) = (column.writing, row.writing) else { return false };
        let glyph = letters.get(line).and_then(|line| *line.get(letter)?);
        column < GLYPH_COLUMNS
            && row < GLYPH_ROWS
            && glyph.is_some_and(|rows| rows[row] >> (GLYPH_COLUMNS - 1 - column) & 1 == 1)
    };
    let is_maze = |column: &Line, row: &Line| {
        let inside_writing = column.is_beside_writing && row.is_beside_writing;
        if maze_cells == 0 || inside_writing || !(column.is_on_page && row.is_on_page) {
            return false;
        }
        let rising = hash(7, column.cell, row.cell, 3) & 1 == 1;
        let (x, y) = (column.place, row.place);
        let distance = if rising { (x - y).abs() } else { (x + y - 1.0).abs() };
        distance < 0.2
    };
    let pixels = grid.square(size, |column, row| {
        let (mut ink, mut line) = (0, 0);
        let [columns, rows] =
            [(&columns, column), (&rows, row)].map(|(lines, texel)| &lines[SAMPLES * texel as usize..][..SAMPLES]);
        for row in rows {
            for column in columns {
                if is_ink(column, row) {
                    ink += 1;
                } else if is_maze(column, row) {
                    line += 1;
                }
            }
        }
        let share = |count: u32| f64::from(count) / (SAMPLES * SAMPLES) as f64;
        mix(mix(paper, maze_colour, share(line)), ink_colour, share(ink))
    });
    Ok(Picture { width: size, height: size, pixels })
}

/// Draws the map of an [`Earth`] with a line every `graticule_degrees` (0: no lines).
pub(super) fn earth(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    const DEEP: [f32; 3] = [0.01, 0.04, 0.16];
    const SHALLOW: [f32; 3] = [0.04, 0.2, 0.38];
    const LOWLAND: [f32; 3] = [0.09, 0.24, 0.06];
    const HIGHLAND: [f32; 3] = [0.36, 0.25, 0.12];
    const ICE: [f32; 3] = [0.85, 0.88, 0.92];
    const LINE: [f32; 3] = [0.75, 0.7, 0.5];
    let earth = Earth::new(keys)?;
    let graticule_degrees = keys.number("graticule_degrees", 15.0, 0.0..=90.0)?;
    let (width, height) = (2 * earth.size, earth.size);
    let texel_degrees = 180.0 / f64::from(height);
    // Distance to the nearest multiple, in degrees.
    let to_line = |degrees: f64| {
        let steps = degrees / graticule_degrees;
        (steps - (steps + 0.5).floor()).abs() * graticule_degrees
    };
    let pixels = grid.rectangle(
        width,
        height,
        #[inline(always)]
        |column, row| {
            let (column, row) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
            let at = earth.direction(column, row);
            let height = earth.height_above_sea(at);
            let ground = if height < 0.0 {
                mix(SHALLOW, DEEP, smoothstep(0.0, 0.25, -height))
            } else {
                mix(LOWLAND, HIGHLAND, smoothstep(0.02, 0.22, height))
            };
            let colour = mix(ground, ICE, smoothstep(0.9, 0.95, at[1].abs() + 0.3 * height));
            if graticule_degrees == 0.0 {
                return colour;
            }
            let latitude = 90.0 - row * texel_degrees;
            let longitude = column * texel_degrees - 180.0;
            // A line is a quarter of a degree of latitude to each side, and as wide on the ground along longitude.
            let ground_per_degree = (at[0] * at[0] + at[2] * at[2]).sqrt();
            let cover =
                |distance: f64, half_width: f64| 1.0 - smoothstep(half_width, half_width + texel_degrees, distance);
            let parallel = cover(to_line(latitude), 0.25);
            // Near a pole meridians would fill the circle, so they end at 80 degrees.
            let meridian =
                if latitude.abs() > 80.0 { 0.0 } else { cover(to_line(longitude), 0.25 / ground_per_degree) };
            mix(colour, LINE, 0.7 * parallel.max(meridian))
        },
    );
    Ok(Picture { width, height, pixels })
}

/// Draws the threads of a [`Denim`] in the colours of warp and weft, darker in the gaps.
pub(super) fn denim(grid: Grid<'_>, keys: &Arguments<'_>) -> Result<Picture, SceneError> {
    let denim = Denim::new(keys)?;
    let warp = keys.colour("warp", [0.03, 0.06, 0.2], 1.0)?;
    let weft = keys.colour("weft", [0.55, 0.55, 0.5], 1.0)?;
    let pixels = grid.square(denim.size, |column, row| {
        let strand = denim.at(column, row);
        let colour = if strand.is_warp { warp } else { weft };
        // The crown of an upper thread is at 1.45 radii, the lowest seam between two at about 0.6.
        mix([0.0; 3], colour, smoothstep(0.2, 1.4, strand.height))
    });
    Ok(Picture { width: denim.size, height: denim.size, pixels })
}

#[cfg(test)]
mod tests {
    use super::super::keys::made;
    use super::*;

    #[test]
    fn writing_fills_its_box_and_nothing_else() {
        let page =
            "size = 64, text = \"HH\", box = [0.5, 0.5, 1, 1], maze_cells = 0, paper = [1, 1, 1], ink = [0, 0, 0]";
        let picture = made(writing, page);
        let dark = |column: u32, row: u32| picture.pixels[(row * 64 + column) as usize][0] < 0.5;
        assert!(dark(33, 1) && dark(33, 26), "the left stem of the first H reaches from the top to the last row");
        assert!(!dark(39, 1) && dark(39, 13), "an H is open at the top and closed in the middle");
        assert!((0..64).all(|column| (33..64).all(|row| !dark(column, row))));
        assert!((0..31).all(|column| (0..64).all(|row| !dark(column, row))));
    }

    #[test]
    fn checker_squares_are_whole_and_alternate() {
        let picture = made(checker, "size = 16, squares = 4");
        let row: Vec<f32> = picture.pixels[..16].iter().map(|pixel| pixel[0]).collect();
        assert_eq!(row, [1., 1., 1., 1., 0., 0., 0., 0., 1., 1., 1., 1., 0., 0., 0., 0.]);
        assert_eq!(picture.pixels[4 * 16][0], 0.0);
    }
}
