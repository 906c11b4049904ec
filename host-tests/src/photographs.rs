//! Photographs that nobody here took: those which the Python package scikit-image ships, where it was put for the tests.

use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType, Decoder, Encoder};
use tempfile::TempDir;

/// A piece of a photograph as a file of its own, which goes with it.
#[derive(Debug)]
pub struct Photograph {
    directory: TempDir,
}

impl Photograph {
    /// Where it lies.
    pub fn path(&self) -> PathBuf {
        self.directory.path().join("piece.png")
    }

    /// `pixels` of 8 bits as such a file.
    fn written(edge: u32, colours: ColorType, pixels: &[u8]) -> Self {
        let photograph = Self { directory: tempfile::tempdir().expect("a directory") };
        let file = BufWriter::new(File::create(photograph.path()).expect("it can be written"));
        let mut encoder = Encoder::new(file, edge, edge);
        encoder.set_color(colours);
        encoder.set_depth(BitDepth::Eight);
        encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels)).expect("it can be written");
        photograph
    }
}

/// The upper left square of a grey photograph; says so where that is not there.
///
/// Looked for below `target/photographs`, where `pip install --no-deps --target target/photographs scikit-image` puts it. Panics where it has
/// to be there: with `ROUGHXEL_REQUIRE_TOOLS` set.
pub fn photograph(name: &str, edge: u32) -> Option<Photograph> {
    Some(Photograph::written(edge, ColorType::Grayscale, &grey(name, edge)?))
}

/// A normal map of the slopes of such a square as heights, which repeats; green up.
pub fn normal_map(name: &str, edge: u32, steepness: f64) -> Option<Photograph> {
    let grey = grey(name, edge)?;
    let height = |x: u32, y: u32| f64::from(grey[(y % edge * edge + x % edge) as usize]) / 255.0;
    let pixel = |index: u32| {
        let (x, y) = (index % edge, index / edge);
        let right = 0.5 * steepness * (height(x + edge - 1, y) - height(x + 1, y));
        // Rows go down.
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
        assert!(std::env::var_os("ROUGHXEL_REQUIRE_TOOLS").is_none(), "{} is not there", path.display());
        eprintln!("SKIPPED: there is no photograph {name}, so nothing here was checked with one");
        return None;
    }
    let mut reader =
        Decoder::new(BufReader::new(File::open(path).expect("it can be opened"))).read_info().expect("a PNG");
    let mut grey = vec![0; reader.output_buffer_size().expect("it is small")];
    let info = reader.next_frame(&mut grey).expect("it is whole");
    assert_eq!((info.color_type, info.bit_depth), (ColorType::Grayscale, BitDepth::Eight), "{name}");
    let rows = grey.chunks(info.width as usize).take(edge as usize);
    Some(rows.flat_map(|row| &row[..edge as usize]).copied().collect())
}
