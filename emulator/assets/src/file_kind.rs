//! Kinds of assets, by the bytes of their files.

use std::io::Read as _;
use std::path::Path;

use roughxel_utilities::input::open_file;

use crate::mesh::kind::is_known;
use crate::picture::{Kind, PictureError, is_cube_file};

/// Reader that a file is meant for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A picture, with a reader or without.
    Picture,
    /// A container of cube maps: KTX2 or DDS.
    Cube,
    /// A glTF model.
    Model,
    /// Anything else, which only a mesh can be.
    Mesh,
}

/// Finds the reader for a file.
///
/// # Errors
/// A file that cannot be opened or read.
pub fn file_kind(path: &Path) -> Result<FileKind, PictureError> {
    let mut head = Vec::new();
    let read = open_file(path).and_then(|file| file.take(512).read_to_end(&mut head));
    read.map_err(|source| unopened(path, source))?;
    Ok(match Kind::from_head(&head) {
        Kind::Ktx2 | Kind::Dds if is_cube_file(path) => FileKind::Cube,
        Kind::Other("GLB (binary glTF)" | "JSON") => FileKind::Model,
        Kind::Other("unknown") if promise(path) == "picture" && !is_known(&head) => FileKind::Picture,
        Kind::Other("text" | "unknown" | "XML" | "HTML" | "ZIP" | "gzip" | "Blender" | "Git LFS pointer") => {
            FileKind::Mesh
        }
        _ => FileKind::Picture,
    })
}

/// Endings of names and the words for what they promise.
const ENDINGS: [(&str, &[&str]); 5] = [
    ("model", &["glb", "gltf"]),
    ("mesh", &["obj", "ply", "stl", "fbx", "off", "dae"]),
    ("texture", &["ktx2", "ktx", "dds"]),
    ("scene", &["toml"]),
    ("picture", PICTURES),
];

/// Endings of pictures, with a reader or without.
const PICTURES: &[&str] = &[
    "png", "exr", "hdr", "pic", "jpg", "jpeg", "tif", "tiff", "webp", "bmp", "gif", "tga", "sgi", "rgb", "pcx", "eps",
    "ico", "cur", "psd", "jxl", "jxr", "jp2", "heic", "avif", "blp", "crn", "astc", "basis",
];

/// Kind of file that the ending of a name promises, a word for messages.
fn promise(path: &Path) -> &'static str {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let promised = ENDINGS.iter().find(|(_, endings)| endings.iter().any(|known| ending == *known));
    promised.map_or("file", |(what, _)| what)
}

/// An error for a file that cannot be opened, by the kind that its name promises.
fn unopened(path: &Path, source: std::io::Error) -> PictureError {
    let shown = path.display();
    if path.is_dir() {
        let message = format!("`{shown}` is a directory");
        return PictureError { message, remedy: "name a file in it".to_owned(), source: Some(source) };
    }
    let what = promise(path);
    let message = format!("cannot open the {what} `{shown}`: {source}");
    PictureError { message, remedy: "check the path and its permissions".to_owned(), source: Some(source) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_bytes_go_to_the_reader_that_their_name_promises() {
        let folder = tempfile::tempdir().unwrap();
        for (name, kind) in [("a.tga", FileKind::Picture), ("a.SGI", FileKind::Picture), ("a.obj", FileKind::Mesh)] {
            let path = folder.path().join(name);
            std::fs::write(&path, b"\0\0\x0a\0\x01\0\0\0").unwrap();
            assert_eq!(file_kind(&path).unwrap(), kind, "{name}");
        }
    }

    #[test]
    fn files_go_to_the_reader_of_their_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("asset.png");
        for (bytes, kind) in [
            (&b"\x89PNG\r\n\x1a\n"[..], FileKind::Picture),
            (b"\xff\xd8\xff\xe0", FileKind::Picture),
            (b"\x76\x2f\x31\x01", FileKind::Picture),
            (b"#?RADIANCE\n", FileKind::Picture),
            (b"\xabKTX 20\xbb\r\n\x1a\n", FileKind::Cube),
            (b"DDS |\0\0\0", FileKind::Cube),
            (b"glTF\x02\0\0\0", FileKind::Model),
            (b"{ \"asset\": {} }", FileKind::Model),
            (b"v 0 0 0\n", FileKind::Mesh),
            (b"ply\nformat ascii 1.0\n", FileKind::Mesh),
            (b"Kaydara FBX Binary  \0", FileKind::Mesh),
            (b"", FileKind::Picture),
        ] {
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(file_kind(&path).unwrap(), kind, "{:?}", String::from_utf8_lossy(bytes));
        }
        for (name, expected) in [
            ("none", "cannot open the file `"),
            ("none.GLB", "cannot open the model `"),
            ("none.gltf", "cannot open the model `"),
            ("none.obj", "cannot open the mesh `"),
            ("none.stl", "cannot open the mesh `"),
            ("none.ktx2", "cannot open the texture `"),
            ("none.toml", "cannot open the scene `"),
            ("none.png", "cannot open the picture `"),
            ("none.JPEG", "cannot open the picture `"),
            ("", "` is a directory; name a file in it"),
        ] {
            let error = file_kind(&folder.path().join(name)).unwrap_err().to_string();
            assert!(error.contains(expected), "{name}: {error}");
        }
    }
}
