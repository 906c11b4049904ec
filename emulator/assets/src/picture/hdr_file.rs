//! HDR (Radiance): red, green and blue with a common exponent, a byte each; plain, or in runs of the old or the new kind.
//!
//! The reader is here, as the libraries for this format alone have faults. `zune-hdr` 0.5 wraps exponents beyond ±31, loses old runs
//! and reads a truncated file as black. `radiant` 0.3 knows one of the two first lines and divides by 255.

use std::io::{BufRead, Read};
use std::path::Path;

use super::colour::{ColourSpace, Primaries, Transfer};
use super::colour_words::ColourWords;
use super::decoded::Decoded;
use super::statement::{Purpose, Statement, Wishes};
use super::{Picture, PictureError, check_size};

/// Most bytes of a header.
const MAX_HEADER_BYTES: u64 = 1 << 16;
/// Widths whose lines may have runs of the new kind.
const NEW_RUNS: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// Reads a Radiance picture: linear light in any units, `mantissa · 2^(exponent − 136)`, in any of the eight orders of its pixels.
///
/// `FORMAT` and `PRIMARIES` decide the colour space. `EXPOSURE` and `COLORCORR` say what the pixels were multiplied by; they are not undone.
///
/// # Errors
/// A file that is truncated or damaged; a picture larger than [`MAX_EDGE`](super::MAX_EDGE) or [`MAX_PIXELS`](super::MAX_PIXELS).
pub(super) fn read(
    path: &Path,
    mut reader: impl BufRead,
    purpose: Purpose,
    wishes: &Wishes,
) -> Result<Decoded, PictureError> {
    let Header { order, words, mut statement } = read_header(path, &mut reader, purpose)?;
    let Order { width, height, .. } = order;
    let [lines, length] = if order.by_rows { [height, width] } else { [width, height] }.map(|edge| edge as usize);
    let mut pixels = Vec::with_capacity(lines * length);
    let mut line = vec![[0; 4]; length];
    for row in 0..lines {
        read_line(&mut reader, &mut line)
            .map_err(|reason| PictureError::damaged(path, "HDR", format!("row {row} {reason}")))?;
        pixels.extend(line.iter().map(|rgbe| linear(*rgbe)));
    }
    let mut pixels = order.arrange(pixels);
    words.decide(purpose, wishes, &mut statement).decode_floats(&mut pixels);
    Ok(Decoded { picture: Picture { width, height, pixels }, statement, largest_code: None, channels: 3 })
}

/// Order of the pixels of a file.
#[derive(Clone, Copy, Debug)]
struct Order {
    width: u32,
    height: u32,
    /// True if pixels of a row follow each other, false for those of a column.
    by_rows: bool,
    /// True if columns run from right to left.
    from_right: bool,
    /// True if rows run from bottom to top.
    from_bottom: bool,
}

impl Order {
    /// Order from a line such as `-Y 512 +X 1024`; `None` for others.
    fn from_line(line: &str) -> Option<(Self, [u64; 2])> {
        let [first, outer, second, inner] = <[&str; 4]>::try_from(line.split_whitespace().collect::<Vec<_>>()).ok()?;
        let by_rows = first.ends_with('Y');
        let (x, y) = if by_rows { (second, first) } else { (first, second) };
        let from = |word: &str, near: &str, far: &str| match word {
            _ if word == near => Some(false),
            _ if word == far => Some(true),
            _ => None,
        };
        let (from_right, from_bottom) = (from(x, "+X", "-X")?, from(y, "-Y", "+Y")?);
        let edge = |text: &str| text.parse::<u64>().ok().filter(|edge| *edge > 0);
        let (outer, inner) = (edge(outer)?, edge(inner)?);
        let size = if by_rows { [inner, outer] } else { [outer, inner] };
        Some((Self { width: 0, height: 0, by_rows, from_right, from_bottom }, size))
    }

    /// Pixels in rows from top to bottom and from left to right.
    fn arrange(self, pixels: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
        if self.by_rows && !self.from_right && !self.from_bottom {
            return pixels;
        }
        let (width, height) = (self.width as usize, self.height as usize);
        let place = |x: usize, y: usize| {
            let x = if self.from_right { width - 1 - x } else { x };
            let y = if self.from_bottom { height - 1 - y } else { y };
            if self.by_rows { y * width + x } else { x * height + y }
        };
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixels[place(x, y)]).collect()
    }
}

/// Words of a header.
struct Header {
    order: Order,
    words: ColourWords,
    statement: Statement,
}

/// Reads a header: `#?`, lines, an empty line, and the line of [`Order::from_line`].
fn read_header(path: &Path, reader: &mut impl BufRead, purpose: Purpose) -> Result<Header, PictureError> {
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
    let mut variables = Variables::default();
    loop {
        let line = next()?;
        if line.is_empty() {
            break;
        }
        variables.add(&line);
    }
    if let Some(format) = variables.format.as_ref().filter(|format| !FORMATS.contains(&format.as_str())) {
        return Err(PictureError::unsupported(path, format!("has the format `{format}`"), FORMATS[0]));
    }
    let line = next()?;
    let (order, [width, height]) =
        Order::from_line(&line).ok_or_else(|| damaged(&format!("`{line}` is no size such as `-Y 512 +X 1024`")))?;
    let (width, height) = check_size(path, width, height)?;
    let (words, statement) = variables.said(purpose);
    Ok(Header { order: Order { width, height, ..order }, words, statement })
}

/// Formats of pixels.
const FORMATS: [&str; 2] = ["32-bit_rle_rgbe", "32-bit_rle_xyze"];

/// Variables of a header that concern the light.
#[derive(Default)]
struct Variables {
    format: Option<String>,
    primaries: Option<String>,
    /// Product of all `EXPOSURE`.
    exposure: Option<f64>,
    corrections: Vec<String>,
    gamma: Option<String>,
}

impl Variables {
    fn add(&mut self, line: &str) {
        let Some((key, value)) = line.split_once('=') else { return };
        let value = value.trim();
        match key.trim() {
            "FORMAT" => self.format = Some(value.to_owned()),
            "PRIMARIES" => self.primaries = Some(value.to_owned()),
            "EXPOSURE" => {
                let factor = value.parse::<f64>().ok().filter(|factor| factor.is_finite() && *factor > 0.0);
                self.exposure = factor.map(|factor| self.exposure.unwrap_or(1.0) * factor).or(self.exposure);
            }
            "COLORCORR" => self.corrections.push(value.to_owned()),
            "GAMMA" => self.gamma = Some(value.to_owned()),
            _ => {}
        }
    }

    /// Decisions that the variables ask for.
    fn said(self, purpose: Purpose) -> (ColourWords, Statement) {
        let mut statement = Statement {
            channels: ["R", "G", "B"].map(str::to_owned).to_vec(),
            exposure: self.exposure,
            ..Statement::default()
        };
        let mut space = None;
        if self.format.as_deref() == Some(FORMATS[1]) {
            space = ColourSpace::Xyz.primaries().map(|xyz| (format!("FORMAT {}", FORMATS[1]), xyz));
        } else if let Some(said) = &self.primaries {
            let numbers: Vec<f64> = said.split_whitespace().filter_map(|word| word.parse().ok()).collect();
            match <[f64; 8]>::try_from(numbers) {
                Ok([a, b, c, d, e, f, x, y]) => {
                    let primaries = Primaries { colours: [[a, b], [c, d], [e, f]], white: [x, y] };
                    space = Some((format!("PRIMARIES of {}", primaries.name()), primaries));
                }
                Err(_) => statement.ignored.push(format!("PRIMARIES `{said}`: not eight numbers")),
            }
        }
        if let Some(exposure) = self.exposure.filter(|exposure| *exposure != 1.0) {
            let sentence = format!("EXPOSURE {exposure}: the pixels were multiplied by it, which is not undone");
            match purpose {
                Purpose::Environment => {
                    let stops = -libm::log2(exposure);
                    statement.warnings.push(format!("{sentence} (`exposure = {stops:.4}` does)"));
                }
                _ => statement.ignored.push(sentence),
            }
        }
        for correction in self.corrections {
            let factors = correction.split_whitespace().map(str::parse::<f64>);
            if factors.into_iter().any(|factor| factor != Ok(1.0)) {
                let what = "the pixels were multiplied by it, which is not undone";
                statement.warnings.push(format!("its COLORCORR `{correction}`: {what}"));
            }
        }
        if let Some(gamma) = self.gamma.filter(|gamma| gamma.parse::<f64>() != Ok(1.0)) {
            let what = "the pixels are read as linear (`transfer` decides otherwise)";
            statement.warnings.push(format!("its GAMMA `{gamma}`: {what}"));
        }
        (ColourWords { space, ..ColourWords::new(Transfer::Linear) }, statement)
    }
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
