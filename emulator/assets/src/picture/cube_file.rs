//! Cube maps in one file: KTX2 and DDS. Both describe the faces as Vulkan samples them.

use std::io::Read as _;
use std::path::Path;

use super::codes::decode_table;
use super::kind::HEAD_BYTES;
use super::statement::{Purpose, Statement, Wishes};
use super::texture::{Content, Texture, is_cube};
use super::{Picture, PictureError, open};

/// Longest edge of a face in pixels.
const MAX_FACE_EDGE: u32 = 4096;

/// Six faces from one file.
#[derive(Debug)]
pub struct CubeFile {
    /// The faces in linear light.
    pub faces: [Picture; 6],
    /// Words of the file, and decisions.
    pub statement: Statement,
}

/// True for a KTX2 or DDS file, unless its header says that it is no cube map.
pub fn is_cube_file(path: &Path) -> bool {
    let mut head = Vec::new();
    open(path).is_ok_and(|file| file.take(HEAD_BYTES as u64).read_to_end(&mut head).is_ok()) && is_cube(&head)
}

/// Reads a cube map from a KTX2 or DDS file. `wishes` decide against the words of the file.
///
/// # Errors
/// A file that cannot be opened, is neither KTX2 nor DDS, is no cube map, is truncated, supercompressed or of another texel format; a face
/// that is no square of at most 4096 pixels; a value that is NaN or infinite.
pub fn read_cube(path: &Path, wishes: &Wishes) -> Result<CubeFile, PictureError> {
    let Some(texture) = Texture::read(path, open(path)?)? else {
        let remedy = "a KTX2 cube map of half floats";
        return Err(PictureError::unsupported(path, "is neither a KTX2 nor a DDS file", remedy));
    };
    if texture.images() != 6 {
        let remedy = "a cube map of half floats";
        return Err(PictureError::unsupported(path, "is no single cube map with six faces", remedy));
    }
    let [width, height] = texture.size();
    if width != height || !(1..=MAX_FACE_EDGE).contains(&width) {
        let reason = format!("has faces of {width}×{height} pixels");
        let remedy = format!("squares of at most {MAX_FACE_EDGE} pixels");
        return Err(PictureError::unsupported(path, reason, &remedy));
    }
    decode(path, &texture.content(path)?, wishes)
}

/// Decodes the faces of a file.
fn decode(path: &Path, content: &Content<'_>, wishes: &Wishes) -> Result<CubeFile, PictureError> {
    let [edge, _] = content.size;
    let mut statement = Statement { kind: content.name.clone(), size: content.size, ..Statement::default() };
    content.alpha.name(&mut statement);
    let colours = content.words().decide(Purpose::Environment, wishes, &mut statement);
    let table = decode_table(255, colours.transfer);
    let mut faces: [Picture; 6] = std::array::from_fn(|face| {
        let pixels = content.format.pixels(content.images[face], content.size, &table);
        Picture { width: edge, height: edge, pixels }
    });
    for (face, picture) in faces.iter_mut().enumerate() {
        if let Some(index) = picture.pixels.iter().position(|pixel| !pixel.iter().all(|value| value.is_finite())) {
            let (x, y) = (index as u32 % edge, index as u32 / edge);
            let reason = format!("has a value that is not finite at face {face}, pixel ({x}, {y})");
            return Err(PictureError::unsupported(path, reason, "finite values"));
        }
        if content.format.is_codes() {
            colours.convert(&mut picture.pixels);
        } else {
            colours.decode_floats(&mut picture.pixels);
        }
    }
    Ok(CubeFile { faces, statement })
}
