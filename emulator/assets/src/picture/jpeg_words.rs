//! Words of a JPEG about itself: frame, components, and the colours that its marks tell.

/// Mark of the frame of JPEG-LS (ITU-T T.87).
pub(super) const JPEG_LS: u8 = 0xf7;

/// Marks before the first picture ends (ITU-T T.81, table B.1).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct JpegWords {
    /// Mark of the frame: 0xc0 baseline, 0xc1 extended, 0xc2 progressive, others are not read.
    pub(super) frame: u8,
    /// Bits of a sample.
    pub(super) bits: u8,
    /// Names of the components.
    components: Vec<u8>,
    is_jfif: bool,
    /// Colour transform of Adobe's segment, and its place in the file.
    pub(super) adobe: Option<(u8, usize)>,
    /// True if the picture ends with its mark.
    pub(super) is_complete: bool,
}

/// Colours of a JPEG.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JpegColours {
    Grey,
    /// Luminance and chroma.
    YCbCr,
    /// Red, green and blue as they are.
    Rgb,
    /// Colours for print, or another number of components.
    Print,
}

impl JpegWords {
    /// Words of a file; `None` if its marks cannot be followed to a frame.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let mut words = Self::default();
        let mut at = 2;
        loop {
            let Some(mark) = next_mark(bytes, &mut at) else { return words.if_framed() };
            let segment = match mark {
                // The end, restarts and a mark for private use stand alone.
                0xd9 => {
                    words.is_complete = true;
                    return words.if_framed();
                }
                0x01 | 0xd0..=0xd8 => continue,
                _ => segment(bytes, at),
            };
            let Some(segment) = segment else { return words.if_framed() };
            match mark {
                // Tables and conditioning have marks among those of frames.
                0xc0..=0xcf | JPEG_LS if !matches!(mark, 0xc4 | 0xc8 | 0xcc) => {
                    let count = usize::from(*segment.get(5)?);
                    let names = (0..count).map(|component| segment.get(6 + 3 * component).copied());
                    (words.frame, words.bits, words.components) = (mark, segment[0], names.collect::<Option<_>>()?);
                }
                0xe0 if segment.starts_with(b"JFIF\0") => words.is_jfif = true,
                0xee if segment.starts_with(b"Adobe") => {
                    words.adobe = segment.get(11).map(|transform| (*transform, at + 13));
                }
                _ => {}
            }
            at += 2 + segment.len();
        }
    }

    fn if_framed(self) -> Option<Self> {
        (self.frame != 0).then_some(self)
    }

    /// Colours by the names of the components, by JFIF, which has luminance and chroma, or by Adobe's segment.
    pub(super) fn colours(&self) -> JpegColours {
        match (self.components.as_slice(), self.adobe) {
            ([_], _) => JpegColours::Grey,
            ([b'R', b'G', b'B'], _) => JpegColours::Rgb,
            ([_, _, _], Some((0, _))) if !self.is_jfif => JpegColours::Rgb,
            ([_, _, _], _) => JpegColours::YCbCr,
            _ => JpegColours::Print,
        }
    }
}

/// The next mark, which is any but a stuffed 0; `at` becomes the place after it. Samples of scans are skipped.
fn next_mark(bytes: &[u8], at: &mut usize) -> Option<u8> {
    let rest = bytes.get(*at..)?;
    let found = rest.windows(2).position(|pair| pair[0] == 0xff && !matches!(pair[1], 0 | 0xff))?;
    *at += found + 2;
    Some(bytes[*at - 1])
}

/// Content of the segment whose length stands at `at`.
fn segment(bytes: &[u8], at: usize) -> Option<&[u8]> {
    let length = usize::from(u16::from_be_bytes(bytes.get(at..at + 2)?.try_into().ok()?));
    bytes.get(at + 2..at.checked_add(length)?)
}
