//! One entry for all kinds of picture files.

use std::io::{BufRead, Cursor, Read as _, Seek};
use std::path::Path;

use super::decoded::Decoded;
use super::kind::{HEAD_BYTES, Kind, LFS_POINTER};
use super::statement::{PictureFile, Purpose, Wishes};
use super::{PictureError, exr_file, hdr_file, jpeg_file, normals, open, png_file, texture_file, tiff_file, webp_file};

/// Kinds with a reader, for messages.
const READABLE: &str = "PNG, EXR, HDR, JPEG, TIFF, WebP, KTX2 or DDS";

/// Reads a picture file of any kind, as it says it is meant and as `wishes` decide otherwise.
///
/// The kind is found by the bytes of the file. Light (see [`Purpose::is_light`]) becomes linear light with the primaries of Rec. 709. Other numbers
/// are taken as they are: code / (2^bits − 1), or floats. Alpha is ignored, and grey becomes three equal channels. Light may be below 0.
///
/// # Errors
/// A file that cannot be opened, or that is truncated or damaged; a kind, or a variant of a kind, without a reader; a picture larger than
/// [`MAX_EDGE`](super::MAX_EDGE) or [`MAX_PIXELS`](super::MAX_PIXELS); a number that is not finite; a wish that the file cannot meet.
pub fn read(path: &Path, purpose: Purpose, wishes: &Wishes) -> Result<PictureFile, PictureError> {
    read_from(path, open(path)?, purpose, wishes)
}

/// Reads a picture from the bytes of its file, as [`read`] does. Errors call it `name`.
///
/// # Errors
/// Errors of [`read`], except that of a file that cannot be opened.
pub fn read_bytes(name: &Path, bytes: &[u8], purpose: Purpose, wishes: &Wishes) -> Result<PictureFile, PictureError> {
    read_from(name, Cursor::new(bytes), purpose, wishes)
}

fn read_from(
    path: &Path,
    mut reader: impl BufRead + Seek,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<PictureFile, PictureError> {
    let unreadable = |source| PictureError::open(path, source);
    let mut head = Vec::with_capacity(HEAD_BYTES);
    reader.by_ref().take(HEAD_BYTES as u64).read_to_end(&mut head).map_err(unreadable)?;
    reader.rewind().map_err(unreadable)?;
    let kind = Kind::from_head(&head);
    for (wished, key) in [(wishes.layer.is_some(), "layer"), (wishes.window.is_some(), "window")] {
        if wished && kind != Kind::Exr {
            let message = format!("`{}` is a file of the kind {kind}, which has no {key}", path.display());
            return Err(PictureError::new(message, format!("leave `{key}` out, it belongs to OpenEXR")));
        }
    }
    let mut read = match kind {
        Kind::Png => png_file::read(path, reader, purpose, wishes)?,
        Kind::Exr => exr_file::read(path, reader, purpose, wishes)?,
        Kind::Hdr => hdr_file::read(path, reader, purpose, wishes)?,
        Kind::Jpeg => jpeg_file::read(path, reader, purpose, wishes)?,
        Kind::Tiff => tiff_file::read(path, reader, purpose, wishes)?,
        Kind::Webp => webp_file::read(path, reader, purpose, wishes)?,
        Kind::Ktx2 | Kind::Dds => texture_file::read(path, reader, purpose, wishes)?,
        Kind::Other(name) => return Err(without_reader(path, name)),
    };
    if purpose == Purpose::Normals {
        normals::settle(path, &mut read, wishes)?;
    }
    let Decoded { picture, mut statement, .. } = read;
    if statement.kind.is_empty() {
        statement.kind = kind.to_string();
    }
    statement.size = [picture.width, picture.height];
    Ok(PictureFile { picture, statement })
}

/// An error for a file of a kind without a reader.
fn without_reader(path: &Path, name: &str) -> PictureError {
    let path = path.display();
    let (message, remedy) = match name {
        "empty" => (format!("`{path}` is empty"), format!("export it again as {READABLE}")),
        "unknown" => (format!("`{path}` is no picture of a known kind"), format!("export it as {READABLE}")),
        LFS_POINTER => (
            format!("`{path}` is a pointer of Git LFS and not the picture itself"),
            "fetch the picture by `git lfs pull`".to_owned(),
        ),
        name => {
            (format!("`{path}` is a file of the kind {name}, which is not read"), format!("export it as {READABLE}"))
        }
    };
    PictureError::new(message, remedy)
}
