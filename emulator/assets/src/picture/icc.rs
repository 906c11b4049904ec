//! ICC profiles: known by their primaries and curve, or by their names if they have none.
//!
//! A profile of a display has the colours of red, green and blue as XYZ under D50, and a curve (ICC.1:2022 §8.3). Both are compared with the
//! known colour spaces. Other primaries are converted as they are; a curve that is no known one is left to the key `transfer`.

use super::colour::{ColourSpace, Primaries, Transfer};
use super::colour_words::ColourWords;
use super::icc_curve::{Curve, curve, fixed};

/// Power of Adobe RGB.
const ADOBE_GAMMA: f64 = 563.0 / 256.0;

/// Longest name in characters.
const MAX_NAME: usize = 80;

/// Largest difference of chromaticities that count as equal: numbers of a profile have 16 bits, and programs round the white point.
const SAME: f64 = 0.002;

/// Adds the words of an ICC profile. `place` is the name of profiles in the file's format.
pub(super) fn profile_words(bytes: &[u8], place: &str, words: &mut ColourWords) {
    let profile = Profile(bytes);
    let name = profile.description().filter(|name| !name.is_empty()).unwrap_or_else(|| "without a name".to_owned());
    let said = format!("{place} `{name}`");
    let (named_space, named_transfer) = by_name(&name.to_ascii_lowercase());
    let space = profile.primaries().or(named_space);
    let transfer = match profile.curve() {
        Some(Curve::Known(transfer)) => Some(transfer),
        Some(Curve::Other) => None,
        None => named_transfer,
    };
    let what = match (space.is_some() || profile.is_grey(), transfer.is_some()) {
        (true, true) => None,
        (true, false) => {
            Some("has a curve that is not applied; the codes are read as sRGB (`transfer` decides otherwise)")
        }
        (false, true) => {
            Some("has colours that are not converted; they are read as Rec. 709 (`colour_space` decides otherwise)")
        }
        (false, false) => {
            Some("is not applied; the colours are read as sRGB (`colour_space` and `transfer` decide otherwise)")
        }
    };
    words.warnings.extend(what.map(|what| format!("its {said} {what}")));
    words.space = space.map(|primaries| (said.clone(), primaries));
    words.transfer = transfer.map(|transfer| (said, transfer));
}

/// Colour space and curve of a profile whose numbers are tables that are not read.
fn by_name(name: &str) -> (Option<Primaries>, Option<Transfer>) {
    let (space, transfer) = match () {
        () if name.contains("linear") => (None, None),
        () if name.contains("srgb") => (Some(ColourSpace::Rec709), Some(Transfer::Srgb)),
        () if name.contains("display p3") => (Some(ColourSpace::P3), Some(Transfer::Srgb)),
        () if name.contains("adobe rgb") => (Some(ColourSpace::AdobeRgb), Some(Transfer::Gamma(ADOBE_GAMMA))),
        () => (None, None),
    };
    (space.and_then(ColourSpace::primaries), transfer)
}

/// Bytes of a profile.
struct Profile<'a>(&'a [u8]);

/// The four bytes at `at` as a whole number.
fn whole(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

impl Profile<'_> {
    /// Content of a tag: after a header of 128 bytes and the number of tags, each has its name, offset and length.
    fn tag(&self, name: &[u8; 4]) -> Option<&[u8]> {
        let count = whole(self.0, 128)?.min(1000) as usize;
        let at = (0..count).map(|tag| 132 + 12 * tag).find(|at| self.0.get(*at..at + 4) == Some(name))?;
        let [offset, length] = [at + 4, at + 8].map(|at| whole(self.0, at).map(|number| number as usize));
        let (offset, length) = (offset?, length?);
        self.0.get(offset..offset.checked_add(length)?)
    }

    fn is_grey(&self) -> bool {
        self.0.get(16..20) == Some(b"GRAY")
    }

    /// Primaries: those of a known colour space, or chromaticities under D50.
    fn primaries(&self) -> Option<Primaries> {
        let colour = |name| {
            let content = self.tag(name).filter(|content| content.starts_with(b"XYZ "))?;
            Some([fixed(content, 8)?, fixed(content, 12)?, fixed(content, 16)?])
        };
        let colours = [colour(b"rXYZ")?, colour(b"gXYZ")?, colour(b"bXYZ")?];
        let white = [0, 1, 2].map(|axis| colours.iter().map(|colour| colour[axis]).sum());
        let chromaticity = |[x, y, z]: [f64; 3]| [x / (x + y + z), y / (x + y + z)];
        let own = Primaries { colours: colours.map(chromaticity), white: chromaticity(white) };
        let mut known = ColourSpace::WORDS.iter().filter_map(|(_, space)| space.primaries());
        let known = known.find(|known| known.under_d50().is_some_and(|known| known.is_within(&own, SAME)));
        known.or(own.to_rec_709().map(|_| own))
    }

    /// The curve of all channels.
    fn curve(&self) -> Option<Curve> {
        if self.is_grey() {
            return curve(self.tag(b"kTRC")?);
        }
        let curves = [b"rTRC", b"gTRC", b"bTRC"].map(|name| self.tag(name));
        let [red, green, blue] = [curves[0]?, curves[1]?, curves[2]?];
        if red == green && red == blue { curve(red) } else { Some(Curve::Other) }
    }

    /// Description: the tag `desc`, a text of version 2 or 4.
    fn description(&self) -> Option<String> {
        let text = self.tag(b"desc")?;
        let within = |from: usize, bytes: usize| text.get(from..from.checked_add(bytes)?);
        let name = match within(0, 4)? {
            b"desc" => String::from_utf8_lossy(within(12, whole(text, 8)? as usize)?).into_owned(),
            // The first record of a text in several languages: its length and offset in bytes, big-endian UTF-16.
            b"mluc" => {
                let [length, offset] = [whole(text, 20)?, whole(text, 24)?].map(|number| number as usize);
                let units = within(offset, length)?.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]]));
                char::decode_utf16(units).map(|unit| unit.unwrap_or('?')).collect()
            }
            _ => return None,
        };
        Some(name.chars().filter(|c| !c.is_control()).take(MAX_NAME).collect::<String>().trim().to_owned())
    }
}
