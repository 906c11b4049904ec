//! Files of other kinds, by their bytes and not by their names.

use std::fs;

use roughxel_assets::{MeshError, ReadMesh, ReadOptions, read_mesh};

const TRIANGLE: &str = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";

fn file(bytes: &[u8]) -> Result<ReadMesh, MeshError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.obj");
    fs::write(&path, bytes).unwrap();
    read_mesh(&path, &ReadOptions::default())
}

fn padded(start: &[u8]) -> Vec<u8> {
    [start, &[7; 200][..]].concat()
}

fn binary_stl(header: &[u8], triangles: u32) -> Vec<u8> {
    let mut bytes = [header, &vec![b' '; 80 - header.len()]].concat();
    bytes.extend(triangles.to_le_bytes());
    bytes.extend(vec![0; 50 * triangles as usize]);
    bytes
}

fn utf16(text: &str, unit: fn(u16) -> [u8; 2]) -> Vec<u8> {
    text.encode_utf16().flat_map(unit).collect()
}

#[test]
fn a_file_of_another_kind_is_named() {
    let stl = "solid cube\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n";
    for (bytes, expected) in [
        (b"{\"metadata\": 1}".to_vec(), "a JSON text"),
        (b"ply\nformat ascii 1.0\n".to_vec(), "a PLY mesh"),
        (b"PLY\r\nformat ascii 1.0\r\n".to_vec(), "a PLY mesh"),
        (b"ply\r\nformat binary_little_endian 1.0\r\n".to_vec(), "a PLY mesh"),
        (stl.as_bytes().to_vec(), "an STL mesh (text)"),
        (b"solid \nendsolid\n".to_vec(), "an STL mesh (text)"),
        (binary_stl(b"made by a program", 1), "an STL mesh"),
        (binary_stl(b"solid but binary", 3), "an STL mesh"),
        (padded(b"Kaydara FBX Binary  \0\x1a\0"), "an FBX model"),
        (b"; FBX 7.7.0 project file\n".to_vec(), "an FBX model (text)"),
        (padded(b"PXR-USDC"), "a USD scene"),
        (b"#usda 1.0\n".to_vec(), "a USD scene (text)"),
        (padded(b"BLENDER-v500"), "a Blender file"),
        (padded(b"\x28\xb5\x2f\xfd"), "compressed by Zstandard"),
        (padded(b"\x1f\x8b\x08"), "compressed by gzip"),
        (padded(b"PK\x03\x04"), "a ZIP archive"),
        (b"<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"x\">".to_vec(), "a COLLADA scene"),
        (b"<?xml version=\"1.0\"?><X3D/>".to_vec(), "an X3D scene"),
        (b"<!DOCTYPE html><html>".to_vec(), "a web page"),
        (b"version https://git-lfs.github.com/spec/v1\n".to_vec(), "a pointer of Git LFS"),
        (b"OFF\n8 6 0\n".to_vec(), "an OFF mesh"),
        (b"COFF\n8 6 0\n".to_vec(), "an OFF mesh"),
        (b"# materials\n\nnewmtl red\nKd 1 0 0\n".to_vec(), "a material library (MTL)"),
        (padded(b"\x89PNG\r\n\x1a\n"), "a PNG picture"),
        (padded(b"\xff\xd8\xff\xe0"), "a JPEG picture"),
        (padded(b"\x76\x2f\x31\x01"), "an EXR picture"),
        (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n".to_vec(), "a Radiance HDR picture"),
        (padded(b"DDS |\0\0\0"), "a DDS picture"),
        (padded(b"\xabKTX 20\xbb"), "a KTX picture"),
        (padded(b"RIFF\x10\0\0\0WEBP"), "a WebP picture"),
        (utf16(TRIANGLE, u16::to_le_bytes), "text in UTF-16 without a byte order mark"),
        (utf16(TRIANGLE, u16::to_be_bytes), "text in UTF-16 without a byte order mark"),
        (b"\0\x01\x02\0\0\x05\x06\0".to_vec(), "binary data of an unknown kind"),
    ] {
        let error = file(&bytes).unwrap_err();
        assert!(error.message.contains(expected), "{expected}: {}", error.message);
        assert!(!error.remedy.contains("relative to the scene"), "{expected}: {}", error.remedy);
        // Cut and lengthened files are refused, too.
        for end in 0..bytes.len() {
            assert!(file(&bytes[..end]).is_err(), "{expected} cut at {end}");
        }
    }
}

#[test]
fn text_in_utf_16_with_its_mark_and_foreign_names_are_read() {
    let long = format!("# \u{4e2d}\u{6587} \u{1f600}\n{TRIANGLE}");
    for bytes in [
        TRIANGLE.as_bytes().to_vec(),
        [b"\xef\xbb\xbf", TRIANGLE.as_bytes()].concat(),
        utf16(&format!("\u{feff}{TRIANGLE}"), u16::to_le_bytes),
        utf16(&format!("\u{feff}{TRIANGLE}"), u16::to_be_bytes),
        utf16(&format!("\u{feff}{long}"), u16::to_le_bytes),
        utf16(&format!("\u{feff}{}", long.replace('\n', "\r\n")), u16::to_be_bytes),
        [utf16(&format!("\u{feff}{TRIANGLE}"), u16::to_le_bytes), vec![b'x']].concat(),
        [b"\xff\xfe\x00\xd8 \0\n\0", &utf16(TRIANGLE, u16::to_le_bytes)[..]].concat(),
        [b"o caf\xe9\n", TRIANGLE.as_bytes()].concat(),
        [b"# \x83\x65\x83\x58\n", TRIANGLE.as_bytes()].concat(),
        [b"o solid\ng facet <html> {\n", TRIANGLE.as_bytes()].concat(),
    ] {
        let read = file(&bytes).unwrap_or_else(|error| panic!("{bytes:?}: {error}"));
        assert_eq!((read.mesh.vertices.len(), read.mesh.triangles.len()), (3, 1), "{bytes:?}");
        assert_eq!(read.mesh.vertices[1].position.to_array(), [1.0, -1.0, 0.0]);
    }
}
