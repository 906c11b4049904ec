//! OpenEXR: flat scan lines or tiles, half or float.

use std::io::{BufRead, Seek};
use std::path::Path;

use exr::block::lines::LineRef;
use exr::block::reader::{ChunksReader, Reader};
use exr::compression::Compression;
use exr::error::Error;
use exr::meta::attribute::{EnvironmentMap, SampleType};
use exr::meta::header::Header;
use exr::prelude::f16;

use super::decoded::Decoded;
use super::exr_choice::{Choice, choose};
use super::exr_words::colour_words;
use super::statement::{Envmap, Purpose, Rectangle, Statement, Window, Windows, Wishes};
use super::{Picture, PictureError, check_finite, check_size};

/// Longest block (a tile, or some rows) of an EXR file, uncompressed, in bytes.
const MAX_BLOCK_BYTES: usize = 1 << 30;

/// Flag of files with several samples a pixel.
const DEEP_FLAG: u8 = 0x08;

/// Reads an OpenEXR picture: the channels that [`choose`] finds, at full resolution; one channel becomes three equal ones.
///
/// The picture is the display window, black where the file holds no pixels. Numbers of a data map have no black: for them an incomplete display
/// window gives way to the data window. Values are in any units and may be below 0.
///
/// # Errors
/// Deep, subsampled or integer data; compression by B44, HTJ2K or a newer method; those of [`read`](super::read).
pub(super) fn read(
    path: &Path,
    mut file: impl BufRead + Seek,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<Decoded, PictureError> {
    // A flag in the second byte of the version, which stands in bytes 4 to 7.
    if file.fill_buf().is_ok_and(|head| head.get(5).is_some_and(|flags| flags & DEEP_FLAG != 0)) {
        return Err(not_read(path, Error::NotSupported("deep data".into())));
    }
    let reader = exr::block::read(file, false).map_err(|error| not_read(path, error))?;
    for header in reader.headers() {
        check_header(path, header)?;
    }
    let choice = choose(reader.headers(), purpose, wishes.layer.as_deref()).map_err(|reason| {
        let message = format!("`{}` {reason}", path.display());
        PictureError::new(message, "name the layer or channel to read by the key `layer`")
    })?;
    let header = reader.headers()[choice.part].clone();
    check_compression(path, &header)?;
    let mut statement = statement(reader.headers(), &choice);
    let windows = windows(path, &header, purpose, wishes, &mut statement)?;
    let mut pixels = crop(read_pixels(path, reader, &choice, &header)?, windows);
    let [width, height] = windows.used_rectangle().size;
    check_finite(path, &pixels, width)?;
    let colours = colour_words(&header, &mut statement).decide(purpose, wishes, &mut statement);
    colours.decode_floats(&mut pixels);
    let picture = Picture { width, height, pixels };
    Ok(Decoded { picture, statement, largest_code: None, channels: choice.channels.len() })
}

/// An error of the decoder: a valid file that it does not know is named for what it is.
fn not_read(path: &Path, error: Error) -> PictureError {
    let Error::NotSupported(reason) = error else { return PictureError::damaged(path, "EXR", error) };
    let reason = match &*reason {
        reason if reason.contains("deep") => "holds deep data, several samples a pixel, which is not read".to_owned(),
        reason if reason.contains("subsampling") => {
            "has channels of lower resolution (luminance and chroma), which are not read".to_owned()
        }
        reason if reason.contains("compression method") => {
            "is compressed by a newer method than is read (such as ZSTD)".to_owned()
        }
        reason => format!("is an EXR file of a kind that is not read: {reason}"),
    };
    PictureError::unsupported(path, reason, "a flat half-float RGB picture, compressed by ZIP or PIZ")
}

/// Numbers of the chosen channels in the data window; a number that no block holds is NaN.
fn read_pixels<R: BufRead + Seek>(
    path: &Path,
    reader: Reader<R>,
    choice: &Choice,
    header: &Header,
) -> Result<Vec<[f32; 3]>, PictureError> {
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let (layer, list) = (choice.part, &header.channels);
    // Third numbers of a normal without z are 0.
    let slots: Vec<(usize, usize)> = match choice.channels[..] {
        [one] => (0..3).map(|slot| (slot, one)).collect(),
        _ => choice.channels.iter().copied().enumerate().collect(),
    };
    let missing = if choice.channels.len() == 2 { [f32::NAN, f32::NAN, 0.0] } else { [f32::NAN; 3] };
    let chunks = reader
        .filter_chunks(false, |_, _, block| block.layer == layer && block.level == exr::math::Vec2(0, 0))
        .map_err(|error| not_read(path, error))?;
    let mut pixels = vec![missing; width * height];
    chunks
        .decompress_sequential(false, |_, block| {
            // A block with a false position is skipped; its pixels stay missing.
            if block.index.layer != layer || block.index.level != exr::math::Vec2(0, 0) {
                return Ok(());
            }
            for line in block.lines(list) {
                let start = line.location.position.y() * width + line.location.position.x();
                let Some(row) = pixels.get_mut(start..start + line.location.sample_count) else {
                    return Err(Error::Invalid("block outside of the layer".into()));
                };
                for (slot, channel) in &slots {
                    if *channel == line.location.channel {
                        read_line(&line, list.list[*channel].sample_type, row, *slot)?;
                    }
                }
            }
            Ok(())
        })
        .map_err(|error| not_read(path, error))?;
    Ok(pixels)
}

/// Copies one channel of one row of a block.
fn read_line(line: &LineRef<'_>, sample_type: SampleType, row: &mut [[f32; 3]], slot: usize) -> exr::error::UnitResult {
    match sample_type {
        SampleType::F16 => {
            for (pixel, value) in row.iter_mut().zip(line.read_samples::<f16>()) {
                pixel[slot] = value?.to_f32();
            }
        }
        // Integer channels are never chosen.
        SampleType::F32 | SampleType::U32 => {
            for (pixel, value) in row.iter_mut().zip(line.read_samples::<f32>()) {
                pixel[slot] = value?;
            }
        }
    }
    Ok(())
}

/// Limits of size for every part, as all block tables are read.
fn check_header(path: &Path, header: &Header) -> Result<(), PictureError> {
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    check_size(path, width as u64, height as u64)?;
    if width == 0 || height == 0 {
        return Err(PictureError::damaged(path, "EXR", "a layer has no pixels"));
    }
    let block = header.max_block_pixel_size();
    let block_bytes = block
        .width()
        .checked_mul(block.height())
        .and_then(|pixels| pixels.checked_mul(header.channels.bytes_per_pixel));
    if block_bytes.is_none_or(|bytes| bytes > MAX_BLOCK_BYTES) {
        let remedy = "a flat half-float RGB picture in scan lines";
        return Err(PictureError::unsupported(path, "has blocks of more than 2^30 bytes", remedy));
    }
    Ok(())
}

/// Refuses compressions without a safe decoder.
fn check_compression(path: &Path, header: &Header) -> Result<(), PictureError> {
    let method = match header.compression {
        // The decoder's B44 overflows on damaged blocks. Every other compression returns errors for all of 10⁵ damaged
        // files of each kind.
        Compression::B44 | Compression::B44A => "B44",
        Compression::HTJ2K32 | Compression::HTJ2K256 => "HTJ2K (JPEG 2000)",
        _ => return Ok(()),
    };
    let remedy = "EXR compressed by ZIP or PIZ";
    Err(PictureError::unsupported(path, format!("is compressed by {method}, which is not read"), remedy))
}

/// Layer, channels and projection.
fn statement(headers: &[Header], choice: &Choice) -> Statement {
    let header = &headers[choice.part];
    let name = |index: &usize| header.channels.list[*index].name.to_string();
    let all = headers.iter().enumerate().flat_map(|(part, header)| {
        let prefix = header.own_attributes.layer_name.as_ref().filter(|_| headers.len() > 1);
        header.channels.list.iter().enumerate().filter_map(move |(index, channel)| {
            let is_taken = part == choice.part && choice.channels.contains(&index);
            let name = channel.name.to_string();
            (!is_taken).then(|| match prefix.map(ToString::to_string) {
                Some(part) if !name.starts_with(&part) => format!("{part}.{name}"),
                _ => name,
            })
        })
    });
    let envmap = header.own_attributes.environment_map.map(|map| match map {
        EnvironmentMap::LatitudeLongitude => Envmap::Latlong,
        EnvironmentMap::Cube => Envmap::Cube,
    });
    Statement {
        layer: Some(choice.layer.clone()).filter(|layer| !layer.is_empty()),
        channels: choice.channels.iter().map(name).collect(),
        left: all.collect(),
        envmap,
        ..Statement::default()
    }
}

impl Windows {
    fn used_rectangle(&self) -> Rectangle {
        match self.used {
            Window::Display => self.display,
            Window::Data => self.data,
        }
    }
}

/// Columns and rows of `data` that `display` shows: from and to in each direction, in coordinates of the file.
fn overlap(data: Rectangle, display: Rectangle) -> [[i64; 2]; 2] {
    std::array::from_fn(|axis| {
        let ends = |window: Rectangle| {
            let start = i64::from(window.origin[axis]);
            [start, start + i64::from(window.size[axis])]
        };
        let ([a, b], [c, d]) = (ends(data), ends(display));
        [a.max(c), b.min(d).max(a.max(c))]
    })
}

/// The windows of a part, and the one that becomes the picture.
fn windows(
    path: &Path,
    header: &Header,
    purpose: Purpose,
    wishes: &Wishes,
    statement: &mut Statement,
) -> Result<Windows, PictureError> {
    let data = rectangle(path, header.own_attributes.layer_position, header.layer_size)?;
    let shown = header.shared_attributes.display_window;
    let mut windows = Windows { data, display: data, used: Window::Data };
    if wishes.window != Some(Window::Data) {
        windows.display = rectangle(path, shown.position, shown.size)?;
        let seen: i64 = overlap(data, windows.display).iter().map(|[from, to]| to - from).product();
        let all = i64::from(windows.display.size[0]) * i64::from(windows.display.size[1]);
        windows.used = match wishes.window {
            Some(window) => window,
            None if purpose.is_light() || seen == all => Window::Display,
            None => Window::Data,
        };
        if seen < all && wishes.window.is_none() {
            let percent = 100.0 * seen as f64 / all as f64;
            let rest = match windows.used {
                Window::Display => "the rest is black (`window = \"data\"` takes the data window alone)",
                Window::Data => "the data window is taken alone (`window = \"display\"` fills the rest with 0)",
            };
            statement.warnings.push(format!("its data window covers {percent:.1} % of its display window; {rest}"));
        }
    } else if let Ok(display) = rectangle(path, shown.position, shown.size) {
        windows.display = display;
    }
    statement.windows = Some(windows);
    Ok(windows)
}

fn rectangle(
    path: &Path,
    origin: exr::math::Vec2<i32>,
    size: exr::math::Vec2<usize>,
) -> Result<Rectangle, PictureError> {
    let (width, height) = check_size(path, size.width() as u64, size.height() as u64)?;
    if width == 0 || height == 0 {
        return Err(PictureError::damaged(path, "EXR", "its display window has no pixels"));
    }
    Ok(Rectangle { origin: [origin.x(), origin.y()], size: [width, height] })
}

/// Pixels of the used window; 0 where the data window has none.
fn crop(pixels: Vec<[f32; 3]>, windows: Windows) -> Vec<[f32; 3]> {
    let (data, used) = (windows.data, windows.used_rectangle());
    if data == used {
        return pixels;
    }
    let [width, height] = used.size.map(|edge| edge as usize);
    let mut cropped = vec![[0.0; 3]; width * height];
    let [[left, right], [top, bottom]] = overlap(data, used);
    let (columns, left) = ((right - left) as usize, left);
    for row in top..bottom {
        let place = |window: Rectangle| {
            let (x, y) = (left - i64::from(window.origin[0]), row - i64::from(window.origin[1]));
            y as usize * window.size[0] as usize + x as usize
        };
        let (from, to) = (place(data), place(used));
        cropped[to..to + columns].copy_from_slice(&pixels[from..from + columns]);
    }
    cropped
}
