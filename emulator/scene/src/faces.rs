//! Six faces as files have them: their orientation, and pictures that hold all six.
//!
//! An environment holds its faces as Vulkan samples them ([`cube`](crate::cube)). Cube maps are defined for a left-handed
//! world. In the right-handed world of a scene, Vulkan's table shows each face as it looks from outside. Six photographs by
//! the axes of the world are seen from inside. A set for a left-handed world, such as a skybox, is seen from inside too, but
//! its +z lies ahead of a viewer who has +x to the right; that is −z here.

use roughxel_assets::Picture;

use crate::cube::{direction, from_inside, place};

/// Orientation of six pictures in the order +x, −x, +y, −y, +z, −z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Orientation {
    /// Vulkan's table: each face as seen from outside.
    Outside,
    /// Photographs by the axes of the world; the tops of +y and −y are +z and −z.
    Inside,
    /// Photographs by the axes of a left-handed world: its +z is −z here.
    LeftHanded,
}

/// Words for orientations in scene files.
pub(super) const ORIENTATIONS: [(&str, Orientation); 3] =
    [("outside", Orientation::Outside), ("inside", Orientation::Inside), ("left-handed", Orientation::LeftHanded)];

impl Orientation {
    /// The picture, its column and its row that hold a texel of a face in Vulkan's orientation.
    fn source(self, face: usize, edge: usize, place: [usize; 2]) -> (usize, [usize; 2]) {
        match self {
            Self::Outside => (face, place),
            Self::Inside => (face, from_inside(face, edge, place)),
            Self::LeftHanded => (if face < 4 { face } else { 9 - face }, from_inside(face, edge, place)),
        }
    }
}

/// Faces in Vulkan's orientation, from faces that are squares of one size.
pub(super) fn in_vulkan_orientation(faces: [Picture; 6], orientation: Orientation) -> [Picture; 6] {
    if orientation == Orientation::Outside {
        return faces;
    }
    let edge = faces[0].width as usize;
    let face = |face: usize| {
        let pixel = |index: usize| {
            let (picture, [column, row]) = orientation.source(face, edge, [index % edge, index / edge]);
            faces[picture].pixels[row * edge + column]
        };
        Picture { pixels: (0..edge * edge).map(pixel).collect(), ..faces[face] }
    };
    std::array::from_fn(face)
}

/// Arrangement of six faces in one picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// An unfolded cube, seen from inside: 4×3 faces, or 3×4 with the last face below, upside down.
    Cross,
    /// A row or a column in the order +x, −x, +y, −y, +z, −z.
    Strip,
    /// The column of OpenEXR: seen from inside, and the outermost texels lie on the edges of the cube.
    OpenExr,
}

/// Words for layouts in scene files.
pub(super) const LAYOUTS: [(&str, Layout); 3] =
    [("cross", Layout::Cross), ("strip", Layout::Strip), ("openexr", Layout::OpenExr)];

impl Layout {
    /// The layout of a picture of this size, from its shape.
    pub(super) fn from_size(width: u32, height: u32) -> Option<Self> {
        [Self::Cross, Self::Strip].into_iter().find(|layout| layout.places(width, height).is_some())
    }

    /// Orientation of the faces of a layout if the file does not say.
    pub(super) fn orientation(self) -> Orientation {
        match self {
            Self::Cross => Orientation::LeftHanded,
            Self::Strip => Orientation::Outside,
            Self::OpenExr => Orientation::Inside,
        }
    }

    /// Shapes of the layout, for messages.
    pub(super) fn shapes(self) -> &'static str {
        match self {
            Self::Cross => "4:3 or 3:4",
            Self::Strip => "6:1 or 1:6",
            Self::OpenExr => "1:6",
        }
    }

    /// Edge of a face, and the column and row of each face in faces; `None` if the size does not fit.
    fn places(self, width: u32, height: u32) -> Option<(u32, [[u32; 2]; 6])> {
        let fits = |columns, rows| {
            let edge = width / columns;
            (edge > 0 && width == columns * edge && height == rows * edge).then_some(edge)
        };
        // The middle of a cross is the +z of a left-handed world.
        let cross = |last| [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], last];
        let row = [0, 1, 2, 3, 4, 5].map(|face| [face, 0]);
        let column = row.map(|[face, _]| [0, face]);
        let found = match self {
            Self::Cross => [fits(4, 3).map(|edge| (edge, cross([3, 1]))), fits(3, 4).map(|edge| (edge, cross([1, 3])))],
            Self::Strip => [fits(6, 1).map(|edge| (edge, row)), fits(1, 6).map(|edge| (edge, column))],
            Self::OpenExr => [fits(1, 6).map(|edge| (edge, column)), None],
        };
        found.into_iter().flatten().next()
    }

    /// Six faces of a picture, in the layout's own orientation; `None` if its size does not fit.
    pub(super) fn faces(self, picture: &Picture) -> Option<[Picture; 6]> {
        let (edge, places) = self.places(picture.width, picture.height)?;
        let mut faces = places.map(|place| cut(picture, edge, place));
        match self {
            // Below the bottom, the last face stands on its head.
            Self::Cross if picture.height > picture.width => faces[5].pixels.reverse(),
            Self::Cross | Self::Strip => {}
            Self::OpenExr => faces = faces.map(|face| with_texels_inside(&face)),
        }
        Some(faces)
    }
}

/// The face in a column and row of faces.
fn cut(picture: &Picture, edge: u32, [column, row]: [u32; 2]) -> Picture {
    let [first, top, edge_texels] = [column * edge, row * edge, edge].map(|index| index as usize);
    let rows = picture.pixels.chunks_exact(picture.width as usize).skip(top).take(edge_texels);
    let pixels = rows.flat_map(|row| &row[first..first + edge_texels]).copied().collect();
    Picture { width: edge, height: edge, pixels }
}

/// A face whose texels lie on a grid with a texel on each corner, resampled to texels that cover the face.
///
/// Texel i lies at s = 2i/(n − 1) − 1 and moves to (2i + 1)/n − 1, by linear interpolation along both axes.
fn with_texels_inside(face: &Picture) -> Picture {
    let edge = face.width as usize;
    let neighbours = |index: usize| {
        let at = (index as f64 + 0.5) * (edge - 1) as f64 / edge as f64;
        (at as usize, (at as usize + 1).min(edge - 1), at.fract())
    };
    let pixel = |index: usize| {
        let ((left, right, across), (top, bottom, down)) = (neighbours(index % edge), neighbours(index / edge));
        let at = |column: usize, row: usize| face.pixels[row * edge + column].map(f64::from);
        let corners = [at(left, top), at(right, top), at(left, bottom), at(right, bottom)];
        std::array::from_fn(|channel| {
            let [a, b, c, d] = corners.map(|corner| corner[channel]);
            let (upper, lower) = (a + (b - a) * across, c + (d - c) * across);
            (upper + (lower - upper) * down) as f32
        })
    };
    Picture { pixels: (0..edge * edge).map(pixel).collect(), ..*face }
}

/// Largest mean step across the edges of a cube that is no sign of a mistake, of 1 for black beside brightest.
const PLAIN_STEP: f64 = 0.02;

/// The orientation in which the edges of faces meet, if they do not meet in the given one.
///
/// Edges of an outside set and of a left-handed one meet alike, as one world is the mirror image of the other.
pub(super) fn better_orientation(faces: &[Picture; 6], given: Orientation) -> Option<Orientation> {
    let step = |orientation| mean_step(faces, orientation);
    let other = if given == Orientation::Inside { Orientation::LeftHanded } else { Orientation::Inside };
    let now = step(given);
    (now > PLAIN_STEP && 4.0 * step(other) < now).then_some(other)
}

/// Mean difference of x/(1 + x), over the channels, between texels on both sides of the edges of a cube.
fn mean_step(faces: &[Picture; 6], orientation: Orientation) -> f64 {
    let edge = faces[0].width;
    let texel = 1.0 / f64::from(edge);
    let centre = |index: u32| (2 * index + 1) as f64 * texel - 1.0;
    let at = |(face, places): (usize, [f64; 2])| {
        let index = places.map(|place| (((place + 1.0) * 0.5 * f64::from(edge)) as usize).min(edge as usize - 1));
        let (picture, [column, row]) = orientation.source(face, edge as usize, index);
        faces[picture].pixel(column as u32, row as u32).map(|channel| {
            let light = f64::from(channel.max(0.0));
            if light.is_finite() { light / (1.0 + light) } else { 1.0 }
        })
    };
    let mut sum = 0.0;
    for (face, index) in (0..6).flat_map(|face| (0..edge).map(move |index| (face, index))) {
        let along = centre(index);
        for side in [-1.0, 1.0] {
            for is_row in [false, true] {
                let place_at = |across: f64| if is_row { [along, across] } else { [across, along] };
                let [s, t] = place_at(side * (1.0 + texel));
                let here = at((face, place_at(side * (1.0 - texel))));
                let there = at(place(direction(face, s, t)));
                sum += here.iter().zip(there).map(|(here, there)| (here - there).abs()).sum::<f64>();
            }
        }
    }
    sum / f64::from(6 * 4 * 3 * edge)
}
