//! Kinds of files, found by their first bytes and not by the ending of their name.

use std::fmt;

/// Bytes at the start of a file that tell its kind.
pub(super) const HEAD_BYTES: usize = 512;

/// Kind of a file. The ones without a reader are known so that an error can name them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Portable Network Graphics.
    Png,
    /// OpenEXR.
    Exr,
    /// Radiance HDR (RGBE or XYZE).
    Hdr,
    /// JPEG.
    Jpeg,
    /// TIFF or BigTIFF.
    Tiff,
    /// WebP.
    Webp,
    /// KTX2.
    Ktx2,
    /// DirectDraw surface.
    Dds,
    /// A kind without a reader, by its name.
    Other(&'static str),
}

impl fmt::Display for Kind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Png => "PNG",
            Self::Exr => "OpenEXR",
            Self::Hdr => "Radiance HDR",
            Self::Jpeg => "JPEG",
            Self::Tiff => "TIFF",
            Self::Webp => "WebP",
            Self::Ktx2 => "KTX2",
            Self::Dds => "DDS",
            Self::Other(name) => name,
        })
    }
}

/// Beginnings of files and the kinds that they tell.
const BEGINNINGS: &[(&[u8], Kind)] = &[
    (b"\x89PNG\r\n\x1a\n", Kind::Png),
    (b"\x76\x2f\x31\x01", Kind::Exr),
    (b"#?", Kind::Hdr),
    (b"\xff\xd8\xff", Kind::Jpeg),
    (b"II*\0", Kind::Tiff),
    (b"MM\0*", Kind::Tiff),
    (b"II+\0", Kind::Tiff),
    (b"MM\0+", Kind::Tiff),
    (b"\xabKTX 20\xbb", Kind::Ktx2),
    (b"\xabKTX 11\xbb", Kind::Other("KTX")),
    (b"DDS ", Kind::Dds),
    (b"GIF87a", Kind::Other("GIF")),
    (b"GIF89a", Kind::Other("GIF")),
    (b"8BPS", Kind::Other("Photoshop (PSD)")),
    (b"%PDF", Kind::Other("PDF")),
    (b"%!PS", Kind::Other("PostScript")),
    (b"\0\0\0\x0cjP  ", Kind::Other("JPEG 2000")),
    (b"\xff\x4f\xff\x51", Kind::Other("JPEG 2000")),
    (b"\0\0\0\x0cJXL ", Kind::Other("JPEG XL")),
    (b"\xff\x0a", Kind::Other("JPEG XL")),
    (b"PF\n", Kind::Other("PFM (portable float map)")),
    (b"Pf\n", Kind::Other("PFM (portable float map)")),
    (b"qoif", Kind::Other("QOI")),
    (b"SDPX", Kind::Other("DPX")),
    (b"XPDS", Kind::Other("DPX")),
    (b"SIMPLE  =", Kind::Other("FITS")),
    (b"\x89HDF\r\n\x1a\n", Kind::Other("HDF5")),
    (b"sB\x13\0", Kind::Other("Basis Universal")),
    (b"glTF", Kind::Other("GLB (binary glTF)")),
    (b"BLENDER", Kind::Other("Blender")),
    (b"PK\x03\x04", Kind::Other("ZIP")),
    (b"\x1f\x8b", Kind::Other("gzip")),
    (b"\0\0\x01\0", Kind::Other("ICO")),
    (b"version https://git-lfs", Kind::Other(LFS_POINTER)),
];

/// A text that stands for a file which is kept elsewhere.
pub(super) const LFS_POINTER: &str = "Git LFS pointer";

impl Kind {
    /// Kind of the file that starts with `head`, at most the first 512 bytes.
    pub fn from_head(head: &[u8]) -> Self {
        if let Some((_, kind)) = BEGINNINGS.iter().find(|(beginning, _)| head.starts_with(beginning)) {
            return *kind;
        }
        if let [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] = head {
            return Self::Webp;
        }
        Self::Other(match head {
            [] => "empty",
            [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', _, ..] => "AVIF",
            [_, _, _, _, b'f', b't', b'y', b'p', b'h' | b'm', ..] => "HEIF",
            [b'B', b'M', _, _, _, _, 0, 0, 0, 0, ..] => "BMP",
            [b'P', b'1'..=b'7', b' ' | b'\n' | b'\r' | b'\t' | b'#', ..] => "PNM (PBM, PGM, PPM or PAM)",
            _ => text(head).unwrap_or("unknown"),
        })
    }
}

/// Name of a kind of text; `None` for bytes that are no text.
fn text(head: &[u8]) -> Option<&'static str> {
    // A character at the end of the head may be cut off.
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        Err(error) if error.valid_up_to() + 4 > head.len() && head.len() == HEAD_BYTES => {
            std::str::from_utf8(&head[..error.valid_up_to()]).ok()?
        }
        Err(_) => return None,
    };
    if text.chars().any(|c| c.is_control() && !matches!(c, '\n' | '\r' | '\t')) {
        return None;
    }
    let text = text.trim_start_matches('\u{feff}').trim_start().to_ascii_lowercase();
    Some(match text.as_bytes() {
        _ if text.starts_with("<!doctype html") || text.starts_with("<html") => "HTML",
        _ if text.starts_with("<svg") || text.contains("<svg") => "SVG",
        [b'<', ..] => "XML",
        [b'{' | b'[', ..] => "JSON",
        _ => "text",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_told_by_bytes() {
        let table: &[(&[u8], &str)] = &[
            (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "PNG"),
            (b"\x76\x2f\x31\x01\x02\0\0\0", "OpenEXR"),
            (b"#?RGBE\n", "Radiance HDR"),
            (b"\xff\xd8\xff\xe0\0\x10JFIF", "JPEG"),
            (b"MM\0*\0\0\0\x08", "TIFF"),
            (b"RIFF\x10\0\0\0WEBPVP8 ", "WebP"),
            (b"\xabKTX 20\xbb\r\n\x1a\n", "KTX2"),
            (b"DDS \x7c\0\0\0", "DDS"),
            (b"GIF89a", "GIF"),
            (b"BM\x36\0\0\0\0\0\0\0\x36\0\0\0", "BMP"),
            (b"8BPS\0\x01", "Photoshop (PSD)"),
            (b"%PDF-1.7", "PDF"),
            (b"\0\0\0\x0cjP  \r\n\x87\n", "JPEG 2000"),
            (b"\0\0\0\x1cftypavif\0\0\0\0", "AVIF"),
            (b"\0\0\0\x18ftypheic\0\0\0\0", "HEIF"),
            (b"P6\n4 4\n255\n", "PNM (PBM, PGM, PPM or PAM)"),
            (b"glTF\x02\0\0\0", "GLB (binary glTF)"),
            (b"version https://git-lfs.github.com/spec/v1\n", "Git LFS pointer"),
            (b"<?xml version=\"1.0\"?>\n<svg width=\"4\"/>", "SVG"),
            (b"<!DOCTYPE html>\n<html>404</html>", "HTML"),
            (b"{\"asset\": {}}", "JSON"),
            (b"v 0 0 0\nv 1 0 0\n", "text"),
            (b"", "empty"),
            (b"\x01\x02\x03\x04", "unknown"),
        ];
        for (head, name) in table {
            assert_eq!(Kind::from_head(head).to_string(), *name);
        }
        // A head that ends inside a character is text as well.
        let long = "ä".repeat(300);
        assert_eq!(Kind::from_head(&long.as_bytes()[..HEAD_BYTES]).to_string(), "text");
        assert_eq!(Kind::from_head(&format!("x{long}").as_bytes()[..HEAD_BYTES]).to_string(), "text");
    }
}
