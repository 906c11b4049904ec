//! Third-party photographs: those in the Python package scikit-image, from the folder where it is installed for the tests.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType, Decoder, Encoder};
use tempfile::TempDir;

/// A piece of a photograph as a file, which is deleted with this value.
#[derive(Debug)]
pub struct Photograph {
    directory: TempDir,
}

impl Photograph {
    /// Path of the file.
    pub fn path(&self) -> PathBuf {
        self.directory.path().join("piece.png")
    }

    /// Writes 8-bit `pixels` as such a file.
    fn written(edge: u32, colours: ColorType, pixels: &[u8]) -> Self {
        let photograph = Self { directory: tempfile::tempdir().expect("a directory") };
        let file = BufWriter::new(File::create(photograph.path()).expect("the file can be created"));
        let mut encoder = Encoder::new(file, edge, edge);
        encoder.set_color(colours);
        encoder.set_depth(BitDepth::Eight);
        encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels)).expect("the pixels fit");
        photograph
    }
}

/// The upper left square of a grey photograph. Prints a message if the photograph is missing.
///
/// The photograph is looked for below `target/photographs`, where `pip install --no-deps --target target/photographs scikit-image` puts it. Panics
/// if it is missing and `ROUGHXEL_REQUIRE_TOOLS` is set.
pub fn photograph(name: &str, edge: u32) -> Option<Photograph> {
    Some(Photograph::written(edge, ColorType::Grayscale, &grey(name, edge)?))
}

/// A repeating normal map from the slopes of a photograph's square as heights; green up.
pub fn normal_map(name: &str, edge: u32, steepness: f64) -> Option<Photograph> {
    let grey = grey(name, edge)?;
    let height = |x: u32, y: u32| f64::from(grey[(y % edge * edge + x % edge) as usize]) / 255.0;
    let pixel = |index: u32| {
        let (x, y) = (index % edge, index / edge);
        let right = 0.5 * steepness * (height(x + edge - 1, y) - height(x + 1, y));
        // Rows run downwards.
        let up = 0.5 * steepness * (height(x, y + 1) - height(x, y + edge - 1));
        let length = (right * right + up * up + 1.0).sqrt();
        [right, up, 1.0].map(|component| (128.0 + 127.0 * component / length).round() as u8)
    };
    let pixels: Vec<u8> = (0..edge * edge).flat_map(pixel).collect();
    Some(Photograph::written(edge, ColorType::Rgb, &pixels))
}

/// The square, row by row.
fn grey(name: &str, edge: u32) -> Option<Vec<u8>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/photographs/skimage/data").join(name);
    if !path.exists() {
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "{} does not exist", path.display());
        eprintln!("SKIPPED: there is no photograph {name}, so nothing here was checked with one");
        return None;
    }
    let mut reader =
        Decoder::new(BufReader::new(File::open(path).expect("the photograph"))).read_info().expect("a PNG");
    let mut grey = vec![0; reader.output_buffer_size().expect("the photograph fits into memory")];
    let info = reader.next_frame(&mut grey).expect("the photograph is complete");
    assert_eq!((info.color_type, info.bit_depth), (ColorType::Grayscale, BitDepth::Eight), "{name}");
    let rows = grey.chunks(info.width as usize).take(edge as usize);
    Some(rows.flat_map(|row| &row[..edge as usize]).copied().collect())
}
