//! Photographs that nobody here took: those which the Python package scikit-image ships, where it was put for the tests.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType, Decoder, Encoder};
use tempfile::TempDir;

/// A piece of a photograph as a file of its own, which goes with it.
pub(crate) struct Photograph {
    directory: TempDir,
}

impl Photograph {
    /// Where it lies.
    pub(crate) fn path(&self) -> PathBuf {
        self.directory.path().join("piece.png")
    }
}

/// The upper left square of a grey photograph; says so where that is not there.
///
/// Looked for below `target/photographs`, where `pip install --no-deps --target target/photographs scikit-image` puts it. Panics where it has
/// to be there: with `ROUGHXEL_REQUIRE_TOOLS` set.
pub(crate) fn photograph(name: &str, edge: u32) -> Option<Photograph> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/photographs/skimage/data").join(name);
    if !path.exists() {
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "{} is not there", path.display());
        eprintln!("SKIPPED: there is no photograph {name}, so nothing here was checked with one");
        return None;
    }
    let mut reader =
        Decoder::new(BufReader::new(File::open(path).expect("it can be opened"))).read_info().expect("a PNG");
    let mut grey = vec![0; reader.output_buffer_size().expect("it is small")];
    let info = reader.next_frame(&mut grey).expect("it is whole");
    assert_eq!((info.color_type, info.bit_depth), (ColorType::Grayscale, BitDepth::Eight), "{name}");
    let piece: Vec<u8> =
        grey.chunks(info.width as usize).take(edge as usize).flat_map(|row| &row[..edge as usize]).copied().collect();
    let photograph = Photograph { directory: tempfile::tempdir().expect("a directory") };
    let file = BufWriter::new(File::create(photograph.path()).expect("it can be written"));
    let mut encoder = Encoder::new(file, edge, edge);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&piece)).expect("it can be written");
    Some(photograph)
}
