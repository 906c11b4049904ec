//! Kinds of files: how a mesh file's bytes begin, and what other files look like.

use std::borrow::Cow;

/// A file of another kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Foreign {
    /// Its kind, with an article.
    pub(super) what: &'static str,
    /// The way to a file that is read.
    pub(super) remedy: &'static str,
}

const EXPORT: &str = "OBJ and glTF are read: export the mesh as one of them";
const UNPACK: &str = "OBJ and glTF are read: unpack the archive and name the mesh in it";
const PICTURE: &str = "name a mesh here; pictures belong into the maps of the material";
const SAVE_TEXT: &str = "OBJ is read: save the text as UTF-8";
const FETCH: &str = "OBJ and glTF are read: fetch the mesh itself";

/// Beginnings of files, most specific first.
const BEGINNINGS: &[(&[u8], &str, &str)] = &[
    (b"ply\n", "a PLY mesh", EXPORT),
    (b"ply\r", "a PLY mesh", EXPORT),
    (b"PLY\n", "a PLY mesh", EXPORT),
    (b"PLY\r", "a PLY mesh", EXPORT),
    (b"Kaydara FBX Binary", "an FBX model", EXPORT),
    (b"; FBX", "an FBX model (text)", EXPORT),
    (b"PXR-USDC", "a USD scene", EXPORT),
    (b"#usda", "a USD scene (text)", EXPORT),
    (b"BLENDER", "a Blender file", EXPORT),
    (b"Ogawa", "an Alembic scene", EXPORT),
    (b"#VRML", "a VRML scene", EXPORT),
    (b"OFF\n", "an OFF mesh", EXPORT),
    (b"OFF\r", "an OFF mesh", EXPORT),
    (b"OFF ", "an OFF mesh", EXPORT),
    (b"COFF", "an OFF mesh", EXPORT),
    (b"NOFF", "an OFF mesh", EXPORT),
    (b"# .PCD", "a point cloud (PCD)", EXPORT),
    (b"PK\x03\x04", "a ZIP archive (ZIP, 3MF or USDZ)", UNPACK),
    (b"\x1f\x8b", "compressed by gzip", UNPACK),
    (b"\x28\xb5\x2f\xfd", "compressed by Zstandard, as Blender files are", EXPORT),
    (b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive", UNPACK),
    (b"\x89PNG", "a PNG picture", PICTURE),
    (b"\xff\xd8\xff", "a JPEG picture", PICTURE),
    (b"\x76\x2f\x31\x01", "an EXR picture", PICTURE),
    (b"#?RADIANCE", "a Radiance HDR picture", PICTURE),
    (b"#?RGBE", "a Radiance HDR picture", PICTURE),
    (b"II*\0", "a TIFF picture", PICTURE),
    (b"MM\0*", "a TIFF picture", PICTURE),
    (b"DDS ", "a DDS picture", PICTURE),
    (b"\xabKTX ", "a KTX picture", PICTURE),
    (b"GIF8", "a GIF picture", PICTURE),
    (b"%PDF", "a PDF document", FETCH),
    (b"version https://git-lfs", "a pointer of Git LFS, not the mesh", FETCH),
    (b"\xff\xfe\0\0", "text in UTF-32", SAVE_TEXT),
    (b"\0\0\xfe\xff", "text in UTF-32", SAVE_TEXT),
];

/// Words near the beginning of a text and its kind, if the text begins with the first of them.
const TEXTS: &[(&str, &str, &str, &str)] = &[
    ("{", "\"", "a JSON text", EXPORT),
    ("<", "<collada", "a COLLADA scene", EXPORT),
    ("<", "<x3d", "an X3D scene", EXPORT),
    ("<", "<html", "a web page", FETCH),
    ("<", "<!doctype html", "a web page", FETCH),
    ("<", "<svg", "an SVG picture", PICTURE),
    ("<", ">", "an XML text", EXPORT),
    ("solid", "facet", "an STL mesh (text)", EXPORT),
    ("solid", "endsolid", "an STL mesh (text)", EXPORT),
];

/// Bytes that are searched for words and zeros.
const SEARCHED: usize = 4096;

/// True for a glTF model, binary or text.
pub(crate) fn is_gltf(bytes: &[u8]) -> bool {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    // The key may stand at the end of a long text.
    bytes.starts_with(b"glTF") || text.starts_with(b"{") && text.windows(7).any(|word| word == b"\"asset\"")
}

/// True if bytes begin as those of a known kind of file.
pub(crate) fn is_known(bytes: &[u8]) -> bool {
    BEGINNINGS.iter().any(|(start, ..)| bytes.starts_with(start))
}

/// The kind of a file that is no OBJ text, if it is known or is no text at all.
pub(super) fn foreign(bytes: &[u8]) -> Option<Foreign> {
    if let Some(&(_, what, remedy)) = BEGINNINGS.iter().find(|(start, ..)| bytes.starts_with(start)) {
        return Some(Foreign { what, remedy });
    }
    if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
        return Some(Foreign { what: "a WebP picture", remedy: PICTURE });
    }
    if is_binary_stl(bytes) {
        return Some(Foreign { what: "an STL mesh", remedy: EXPORT });
    }
    if utf16_mark(bytes).is_some() {
        return None;
    }
    let head = &bytes[..bytes.len().min(SEARCHED)];
    if head.contains(&0) {
        let zeros = |first: usize| head.iter().skip(first).step_by(2).filter(|&&byte| byte == 0).count();
        let most = head.len() * 2 / 5;
        let what = if zeros(0).max(zeros(1)) > most.max(1) && zeros(0).min(zeros(1)) == 0 {
            "text in UTF-16 without a byte order mark"
        } else {
            return Some(Foreign { what: "no text, but binary data of an unknown kind", remedy: EXPORT });
        };
        return Some(Foreign { what, remedy: SAVE_TEXT });
    }
    let head = String::from_utf8_lossy(head).to_ascii_lowercase();
    let head = head.trim_start_matches('\u{feff}').trim_start();
    if head.lines().any(|line| line.trim_start().starts_with("newmtl")) {
        return Some(Foreign {
            what: "a material library (MTL)",
            remedy: "OBJ is read: name the OBJ file that uses it",
        });
    }
    TEXTS
        .iter()
        .find(|(start, word, ..)| head.starts_with(start) && head.contains(word))
        .map(|&(_, _, what, remedy)| Foreign { what, remedy })
}

/// True if the length is that of a binary STL file: 84 bytes and 50 a triangle.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(80..84).and_then(|count| <[u8; 4]>::try_from(count).ok()).map(u32::from_le_bytes);
    count.is_some_and(|count| count > 0 && bytes.len() as u64 == 84 + 50 * u64::from(count))
}

/// The order of the bytes of UTF-16 text with a byte order mark.
fn utf16_mark(bytes: &[u8]) -> Option<fn([u8; 2]) -> u16> {
    match bytes {
        [0xff, 0xfe, ..] => Some(u16::from_le_bytes),
        [0xfe, 0xff, ..] => Some(u16::from_be_bytes),
        _ => None,
    }
}

/// The text of a file. Names and comments may be in any encoding; numbers and keywords are ASCII, or UTF-16 after its mark.
pub(super) fn text(bytes: &[u8]) -> Cow<'_, str> {
    let Some(unit) = utf16_mark(bytes) else { return String::from_utf8_lossy(bytes) };
    let units = bytes.as_chunks::<2>().0.iter().map(|pair| unit(*pair));
    char::decode_utf16(units).map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}
