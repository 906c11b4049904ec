//! The environment of a scene: six files, one file with six faces, a panorama, or generated faces.

use std::ops::Range;

use roughxel_assets::picture::{CubeFile, Envmap, MAX_PIXELS, Picture, PictureFile, Purpose, is_cube_file, read_cube};
use roughxel_utilities::limits::{EXPOSURES, MAX_FACE_EDGE};
use toml::Spanned;

use super::light;
use super::maps::{Maps, wishes};
use crate::error::SceneError;
use crate::faces::{LAYOUTS, Layout, ORIENTATIONS, Orientation, better_orientation, in_vulkan_orientation};
use crate::generate::ENVIRONMENTS;
use crate::panorama::{Extent, faces_from_equirectangular};
use crate::scene::EnvironmentSource;
use crate::source::{ArgumentTable, Arguments};

/// Largest deviation of a panorama's shape from that of its degrees, as a share.
const ROUNDED_SHAPE: f64 = 0.02;

impl Maps<'_> {
    /// The six faces of `[environment]`.
    pub(super) fn environment(&mut self, table: &Spanned<ArgumentTable>) -> Result<EnvironmentSource, SceneError> {
        let arguments = Arguments::new(self.source, table);
        let generate = arguments.text("generate")?;
        let equirectangular = arguments.text("equirectangular")?;
        let cube = arguments.text("cube")?;
        let paths = arguments.texts("faces")?;
        let exposure = arguments.number("exposure", 0.0, EXPOSURES)?;
        let mut faces = match (generate, equirectangular, cube, paths) {
            (Some(named), None, None, None) => ENVIRONMENTS.make(&arguments, named, self.progress)?,
            (None, Some(named), None, None) => self.panorama(&arguments, named)?,
            (None, None, Some(named), None) => self.cube(&arguments, named)?,
            (None, None, None, Some((paths, span))) => {
                let orientation = arguments.word("orientation", &ORIENTATIONS)?.unwrap_or(Orientation::Outside);
                let faces = self.six_faces(&arguments, paths, span)?;
                self.oriented(faces, orientation)
            }
            _ => {
                return Err(arguments.error(
                    "the environment is not clear",
                    "give exactly one of: `faces` (six files), `cube` (a file with six faces), `equirectangular` (a file), \
                     `generate` (a name)",
                ));
            }
        };
        arguments.finish()?;
        light::expose(&mut faces, exposure);
        self.warnings.extend(light::cut_environment(&faces));
        Ok(EnvironmentSource { faces })
    }

    /// Faces of a picture of the sphere or of a part of it.
    fn panorama(
        &mut self,
        arguments: &Arguments<'_>,
        (path, span): (&str, Range<usize>),
    ) -> Result<[Picture; 6], SceneError> {
        let face_edge = arguments.whole("face_edge", 512, 1..=MAX_FACE_EDGE)?;
        let longitudes = arguments.interval("longitudes", Extent::SPHERE.longitudes, 360.0, -360.0..=360.0)?;
        let latitudes = arguments.interval("latitudes", Extent::SPHERE.latitudes, 180.0, -90.0..=90.0)?;
        let extent = Extent {
            longitudes: longitudes.unwrap_or(Extent::SPHERE.longitudes),
            latitudes: latitudes.unwrap_or(Extent::SPHERE.latitudes),
        };
        let (picture, envmap) = self.read_light(arguments, (path, span.clone()))?;
        let size = format!("{}×{}", picture.width, picture.height);
        if envmap == Some(Envmap::Cube) && latitudes.is_none() {
            let message = format!("`{path}` says that it holds the six faces of a cube (`envmap`)");
            return Err(arguments.error_at(span, message, "name it with `cube`"));
        }
        if let (Some(Envmap::Latlong), None, Some(read)) = (envmap, longitudes, self.pictures.last_mut()) {
            read.statement.ignored.push(
                "OpenEXR has +z in the middle of a map of longitude and latitude (`envmap`); here it is −z, and \
                 `longitudes = [0, 360]` turns the map"
                    .to_owned(),
            );
        }
        if latitudes.is_none() && !fits(&picture, extent.ratio()) {
            let (message, help) = not_a_panorama(&picture, &extent);
            return Err(arguments.error_at(span, format!("`{path}` has {size} pixels, {message}"), help));
        }
        let [width, height] = extent.whole_size(&picture);
        if width * height > MAX_PIXELS {
            let message = format!("with `{path}` of {size} pixels the whole sphere has {width}×{height}");
            let help = format!("make the picture smaller: at most {MAX_PIXELS} pixels are read");
            return Err(arguments.error_at(span, message, help));
        }
        Ok(faces_from_equirectangular(&extent.on_the_sphere(picture), face_edge))
    }

    /// Faces of a picture that holds all six.
    fn cube(
        &mut self,
        arguments: &Arguments<'_>,
        (path, span): (&str, Range<usize>),
    ) -> Result<[Picture; 6], SceneError> {
        let layout = arguments.word("layout", &LAYOUTS)?;
        let orientation = arguments.word("orientation", &ORIENTATIONS)?;
        if layout.is_none() && is_cube_file(&self.resolve(path)) {
            let wishes = wishes(arguments, Purpose::Environment)?;
            let CubeFile { faces, statement } = self.read(path, span.clone(), |file| read_cube(file, &wishes))?;
            let edge = faces[0].width;
            if edge > MAX_FACE_EDGE {
                let message = format!("`{path}` has faces of {edge}×{edge} pixels");
                let help = format!("make it smaller: a face has at most {MAX_FACE_EDGE}×{MAX_FACE_EDGE}");
                return Err(arguments.error_at(span, message, help));
            }
            self.say("environment", path, statement);
            return Ok(self.oriented(faces, orientation.unwrap_or(Orientation::Outside)));
        }
        let (picture, envmap) = self.read_light(arguments, (path, span.clone()))?;
        let by_file = (envmap == Some(Envmap::Cube)).then_some(Layout::OpenExr);
        let error = |message: String, help: String| {
            let message = format!("`{path}` has {}×{} pixels, {message}", picture.width, picture.height);
            Err(arguments.error_at(span.clone(), message, help))
        };
        let Some(layout) = layout.or(by_file).or(Layout::from_size(picture.width, picture.height)) else {
            let shapes = LAYOUTS.map(|(name, layout)| format!("{} (\"{name}\")", layout.shapes())).join(", ");
            let help = if fits(&picture, Extent::SPHERE.ratio()) {
                "name a panorama of longitude and latitude with `equirectangular`".to_owned()
            } else {
                format!("arrange its squares as {shapes}, or give six files with `faces`")
            };
            return error("which is no known layout of six squares".into(), help);
        };
        let Some(faces) = layout.faces(&picture) else {
            return error("which this `layout` does not have".into(), format!("its shape is {}", layout.shapes()));
        };
        let edge = faces[0].width;
        if edge > MAX_FACE_EDGE {
            let help = format!("make it smaller: a face has at most {MAX_FACE_EDGE}×{MAX_FACE_EDGE}");
            return error(format!("{edge}×{edge} in a face"), help);
        }
        let orientation = match (layout, orientation) {
            // The places of a cross name its faces.
            (Layout::Cross, Some(Orientation::Inside)) | (_, None) => layout.orientation(),
            (_, Some(orientation)) => orientation,
        };
        Ok(self.oriented(faces, orientation))
    }

    /// Faces in Vulkan's orientation, and a warning if their edges meet in another orientation.
    fn oriented(&mut self, faces: [Picture; 6], orientation: Orientation) -> [Picture; 6] {
        if let Some(better) = better_orientation(&faces, orientation)
            && let Some((name, _)) = ORIENTATIONS.iter().find(|(_, known)| *known == better)
        {
            self.warnings.push(format!(
                "environment: the edges of the faces do not meet; with `orientation = \"{name}\"` they would"
            ));
        }
        in_vulkan_orientation(faces, orientation)
    }

    /// A picture of light, and its projection if the file names one.
    fn read_light(
        &mut self,
        arguments: &Arguments<'_>,
        named: (&str, Range<usize>),
    ) -> Result<(Picture, Option<Envmap>), SceneError> {
        let PictureFile { picture, statement } =
            self.read_picture("environment", arguments, named, Purpose::Environment)?;
        Ok((picture, statement.envmap))
    }

    /// The pictures of six files.
    fn six_faces(
        &mut self,
        arguments: &Arguments<'_>,
        paths: &[String],
        span: Range<usize>,
    ) -> Result<[Picture; 6], SceneError> {
        let source = self.source;
        let wrong_count = |_| {
            let message = format!("`faces` names {} files", paths.len());
            source.value_error(span.clone(), message, "name six: +x, −x, +y, −y, +z, −z, in this order")
        };
        let mut faces = Vec::new();
        for path in <&[String; 6]>::try_from(paths).map_err(|_| wrong_count(()))? {
            let face = self.read_light(arguments, (path, span.clone()))?.0;
            let edge = faces.first().map_or(face.width, |first: &Picture| first.width);
            if face.width != face.height || face.width != edge || edge > MAX_FACE_EDGE {
                let message = format!("the face `{path}` has {}×{} pixels", face.width, face.height);
                let help = format!("all six must be squares of one size of at most {MAX_FACE_EDGE} pixels");
                return Err(self.source.value_error(span, message, help));
            }
            faces.push(face);
        }
        <[Picture; 6]>::try_from(faces).map_err(|_| wrong_count(()))
    }
}

/// True if width over height is `ratio` within [`ROUNDED_SHAPE`] or one pixel.
fn fits(picture: &Picture, ratio: f64) -> bool {
    let (width, wanted) = (f64::from(picture.width), f64::from(picture.height) * ratio);
    (width - wanted).abs() <= (ROUNDED_SHAPE * wanted).max(1.0)
}

/// The end of a message on a picture whose shape is not that of its degrees, and its remedy.
fn not_a_panorama(picture: &Picture, extent: &Extent) -> (String, &'static str) {
    let shape = |columns: u32, rows: u32| {
        u64::from(picture.height) * u64::from(columns) == u64::from(picture.width) * u64::from(rows)
    };
    let by_degrees = "give its `latitudes` in degrees: [0, 90] for the upper half, [-90, 90] for a stretched picture of the \
                      sphere; and its `longitudes` if it does not go all the way around";
    let six = "name it with `cube`; or give its `latitudes` if it is a panorama all the same";
    let (message, remedy) = match Layout::from_size(picture.width, picture.height) {
        Some(Layout::Cross) => ("the shape of a cross of six faces", six),
        Some(_) => ("the shape of a strip of six faces", six),
        None if shape(1, 1) => {
            ("the shape of a light probe or of one face", "convert it to longitude and latitude, width : height = 2")
        }
        None if shape(4, 1) => ("the shape of half a sphere", by_degrees),
        None => ("not the shape of a panorama", by_degrees),
    };
    (format!("{message}; its width : height should be {:.2}", extent.ratio()), remedy)
}
