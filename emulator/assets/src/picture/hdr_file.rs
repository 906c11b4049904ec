//! HDR (Radiance): red, green and blue with a common exponent, a byte each; plain, or in runs of the old or the new kind.
//!
//! The reader is here, as the libraries for this format alone have faults. `zune-hdr` 0.5 wraps exponents beyond ±31, loses old runs
//! and reads a truncated file as black. `radiant` 0.3 knows one of the two first lines and divides by 255.

use std::io::{BufRead, Read};
use std::path::Path;

use super::colour::{ColourWords, Transfer};
use super::statement::{PictureFile, Purpose, Statement, Wishes};
use super::{Picture, PictureError, check_size};

/// Most bytes of a header.
const MAX_HEADER_BYTES: u64 = 1 << 16;
/// Widths whose lines may have runs of the new kind.
const NEW_RUNS: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// Reads a Radiance picture: linear light in any units, `mantissa · 2^(exponent − 136)`. `EXPOSURE` and other variables of the header
/// are ignored.
///
/// # Errors
/// A file that cannot be opened, is no Radiance picture, is truncated or damaged; CIE colours (XYZE); rows that do not run from left
/// to right and from top to bottom; a picture larger than [`MAX_EDGE`](super::MAX_EDGE) or [`MAX_PIXELS`](super::MAX_PIXELS).
pub(super) fn read(
    path: &Path,
    mut reader: impl BufRead,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<PictureFile, PictureError> {
    let (width, height) = read_header(path, &mut reader)?;
    let mut pixels = Vec::with_capacity(width as usize * height as usize);
    let mut line = vec![[0; 4]; width as usize];
    for row in 0..height {
        read_line(&mut reader, &mut line)
            .map_err(|reason| PictureError::damaged(path, "HDR", format!("row {row} {reason}")))?;
        pixels.extend(line.iter().map(|rgbe| linear(*rgbe)));
    }
    let mut statement = Statement { channels: vec!["R".into(), "G".into(), "B".into()], ..Statement::default() };
    let words = ColourWords { space: None, transfer: None, default: Transfer::Linear };
    words.decide(purpose, wishes, &mut statement);
    Ok(PictureFile { picture: Picture { width, height, pixels }, statement })
}

/// Size from the header: `#?`, lines, an empty line, and a line such as `-Y 512 +X 1024`.
fn read_header(path: &Path, reader: &mut impl BufRead) -> Result<(u32, u32), PictureError> {
    let damaged = |reason: &str| PictureError::damaged(path, "HDR", reason);
    let mut header = reader.take(MAX_HEADER_BYTES);
    let mut next = || {
        let mut line = Vec::new();
        header.read_until(b'\n', &mut line).map_err(|error| damaged(&error.to_string()))?;
        match line.pop() {
            Some(b'\n') => Ok(String::from_utf8_lossy(&line).trim().to_owned()),
            _ => Err(damaged("its header has no end")),
        }
    };
    // The first line has told the kind.
    next()?;
    loop {
        let line = next()?;
        match line.strip_prefix("FORMAT=") {
            _ if line.is_empty() => break,
            Some(format) if format != "32-bit_rle_rgbe" => {
                return Err(PictureError::unsupported(path, format!("has the format `{format}`"), "32-bit_rle_rgbe"));
            }
            _ => {}
        }
    }
    let size = next()?;
    let words: Vec<&str> = size.split_whitespace().collect();
    let [first, height, second, width] = words[..] else {
        return Err(damaged("it has no line with its size"));
    };
    let edge = |text: &str| text.parse::<u64>().ok().filter(|edge| *edge > 0);
    let (Some(width), Some(height)) = (edge(width), edge(height)) else {
        return Err(damaged(&format!("`{size}` is no size")));
    };
    if (first, second) != ("-Y", "+X") {
        let reason = format!("has its pixels in the order `{first} {second}`");
        return Err(PictureError::unsupported(path, reason, "rows from top to bottom, -Y and +X"));
    }
    check_size(path, width, height)
}

/// Reads the pixels of a row; its first four bytes tell the storage.
fn read_line(reader: &mut impl Read, line: &mut [[u8; 4]]) -> Result<(), String> {
    let first = read_bytes(reader)?;
    if NEW_RUNS.contains(&line.len()) && first[..2] == [2, 2] && first[2] < 128 {
        if usize::from(u16::from_be_bytes([first[2], first[3]])) != line.len() {
            return Err("has another length".to_owned());
        }
        return (0..4).try_for_each(|channel| read_new_runs(reader, line, channel));
    }
    read_old_runs(reader, line, first)
}

/// Reads runs of a byte and stretches of different bytes, channel by channel. A count above 128 is a run of (count − 128)
/// times the next byte.
fn read_new_runs(reader: &mut impl Read, line: &mut [[u8; 4]], channel: usize) -> Result<(), String> {
    let mut rest = line;
    while !rest.is_empty() {
        let [code] = read_bytes(reader)?;
        let count = usize::from(if code > 128 { code - 128 } else { code });
        if count == 0 || count > rest.len() {
            return Err("has a run that does not fit".to_owned());
        }
        let (run, behind) = rest.split_at_mut(count);
        let mut byte = [0];
        for (index, pixel) in run.iter_mut().enumerate() {
            if index == 0 || code <= 128 {
                byte = read_bytes(reader)?;
            }
            pixel[channel] = byte[0];
        }
        rest = behind;
    }
    Ok(())
}

/// Reads pixels, and between them marks (1, 1, 1, n): the last pixel n more times, n · 256 times in a second
/// consecutive mark, and so on.
fn read_old_runs(reader: &mut impl Read, line: &mut [[u8; 4]], first: [u8; 4]) -> Result<(), String> {
    let (mut filled, mut shift, mut next) = (0usize, 0, first);
    loop {
        if let [1, 1, 1, count] = next {
            let count = if shift <= 16 { usize::from(count) << shift } else { usize::MAX };
            let last = filled.checked_sub(1).map(|last| line[last]);
            match (last, line[filled..].get_mut(..count)) {
                (Some(last), Some(run)) => run.fill(last),
                _ => return Err("has a run that does not fit".to_owned()),
            }
            filled += count;
            shift += 8;
        } else {
            line[filled] = next;
            filled += 1;
            shift = 0;
        }
        if filled == line.len() {
            return Ok(());
        }
        next = read_bytes(reader)?;
    }
}

fn read_bytes<const N: usize>(reader: &mut impl Read) -> Result<[u8; N], String> {
    let mut bytes = [0; N];
    reader.read_exact(&mut bytes).map_err(|error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => "is cut off".to_owned(),
        _ => error.to_string(),
    })?;
    Ok(bytes)
}

/// Mantissas times a power of two: exact in float64, rounded to float32 once.
fn linear([red, green, blue, exponent]: [u8; 4]) -> [f32; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    // The bits of 2^(exponent − 136), from 2⁻¹³⁵ to 2¹¹⁹.
    let scale = f64::from_bits((u64::from(exponent) + 1023 - 136) << 52);
    [red, green, blue].map(|mantissa| (f64::from(mantissa) * scale) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_file(bytes: &[u8]) -> Result<Picture, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.hdr");
        std::fs::write(&path, bytes).unwrap();
        super::super::read(&path, Purpose::Colours, &Wishes::default())
            .map(|read| read.picture)
            .map_err(|error| error.to_string())
    }

    fn file(size: &str, pixels: &[u8]) -> Vec<u8> {
        let header = format!("#?RADIANCE\n# made by hand\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n{size}\n");
        [header.as_bytes(), pixels].concat()
    }

    #[test]
    fn plain_pixels_are_mantissas_times_a_power_of_two() {
        let pixels = [128, 64, 0, 129, 255, 1, 2, 0, 255, 255, 255, 255, 1, 2, 1, 1];
        let picture = read_file(&file("-Y 2 +X 2", &pixels)).unwrap();
        assert_eq!((picture.width, picture.height), (2, 2));
        let last = [1.0, 2.0, 1.0].map(|mantissa: f32| mantissa * 2f32.powi(-135));
        assert_eq!(picture.pixels, [[1.0, 0.5, 0.0], [0.0; 3], [255.0 * 2f32.powi(119); 3], last]);
        assert!(read_file(&[b"#?RGBE\n\n-Y 1 +X 1\n", &pixels[..4]].concat()).is_ok());
    }

    #[test]
    fn runs_of_both_kinds_are_the_same_picture() {
        let (a, b) = ([10, 20, 30, 128], [40, 50, 60, 130]);
        let plain = [[a; 9].concat(), b.to_vec()].concat();
        // 9 times the first pixel, then the other.
        let old = [&a[..], &[1, 1, 1, 8], &b].concat();
        let mut new = vec![2, 2, 0, 10];
        for channel in 0..4 {
            // A run of 8, and a stretch of 2.
            new.extend([128 + 8, a[channel], 2, a[channel], b[channel]]);
        }
        let read = |pixels: &[u8]| read_file(&file("-Y 1 +X 10", pixels)).unwrap();
        assert_eq!(read(&plain), read(&old));
        assert_eq!(read(&plain), read(&new));

        // A second mark counts 256s; wider than the new kind allows.
        let long = [&a[..], &[1, 1, 1, 255], &[1, 1, 1, 128]].concat();
        let width = 1 + 255 + 128 * 256;
        let picture = read_file(&file(&format!("-Y 1 +X {width}"), &long));
        assert!(picture.unwrap_err().contains("at most 16384 an edge"));
        let shorter = [&a[..], &[1, 1, 1, 255], &[1, 1, 1, 3]].concat();
        let picture = read_file(&file(&format!("-Y 1 +X {}", 256 + 3 * 256), &shorter)).unwrap();
        assert!(picture.pixels.iter().all(|pixel| *pixel == linear(a)));
    }

    #[test]
    fn bad_files_say_what_is_wrong_and_cut_ones_do_not_panic() {
        let row = |pixels: &[u8]| file("-Y 1 +X 8", pixels);
        for (bytes, expected) in [
            (b"\x89PNG\r\n\x1a\n".to_vec(), "not a readable PNG file"),
            (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n".to_vec(), "header has no end"),
            (b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n".to_vec(), "format `32-bit_rle_xyze`; export it as"),
            (file("+Y 1 +X 1", &[0; 4]), "order `+Y +X`"),
            (file("-Y 1", &[0; 4]), "no line with its size"),
            (file("-Y one +X 1", &[0; 4]), "`-Y one +X 1` is no size"),
            (file("-Y 0 +X 1", &[]), "is no size"),
            (file("-Y 16384 +X 16384", &[]), "scale it down"),
            (file("-Y 99999999999 +X 1", &[]), "scale it down"),
            (file("-Y 2 +X 1", &[0; 4]), "row 1 is cut off"),
            (row(&[2, 2, 0, 9]), "row 0 has another length"),
            (row(&[2, 2, 0, 8, 0]), "a run that does not fit"),
            (row(&[2, 2, 0, 8, 128 + 9, 1]), "a run that does not fit"),
            (row(&[1, 1, 1, 3]), "a run that does not fit"),
            (row(&[9, 9, 9, 9, 1, 1, 1, 8]), "a run that does not fit"),
        ] {
            let message = read_file(&bytes).unwrap_err();
            assert!(message.contains(expected), "{expected}: {message}");
        }
        let mut endless = b"#?RADIANCE\n".to_vec();
        endless.resize(1 << 17, b'x');
        assert!(read_file(&endless).unwrap_err().contains("header has no end"));
        let whole = row(&[&[2, 2, 0, 8][..], &[128 + 8, 7].repeat(4)].concat());
        assert!(read_file(&whole).is_ok());
        for end in 0..whole.len() {
            assert!(read_file(&whole[..end]).is_err());
        }
    }
}
