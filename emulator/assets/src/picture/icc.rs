//! ICC profiles, known by their names.

use super::colour::{ColourSpace, Transfer};
use super::colour_words::ColourWords;
use super::statement::Statement;

/// Power of Adobe RGB.
const ADOBE_GAMMA: f64 = 563.0 / 256.0;

/// Longest name in characters.
const MAX_NAME: usize = 80;

/// Adds the words of an ICC profile that is known by its name. `place` is the name of profiles in the file's format.
pub(super) fn profile_words(profile: &[u8], place: &str, words: &mut ColourWords, statement: &mut Statement) {
    let name = profile_name(profile);
    let said = format!("{place} `{name}`");
    let lower = name.to_ascii_lowercase();
    let (space, transfer) = match () {
        () if lower.contains("linear") => (None, None),
        () if lower.contains("srgb") => (Some(ColourSpace::Rec709), Some(Transfer::Srgb)),
        () if lower.contains("display p3") => (Some(ColourSpace::P3), Some(Transfer::Srgb)),
        () if lower.contains("adobe rgb") => (Some(ColourSpace::AdobeRgb), Some(Transfer::Gamma(ADOBE_GAMMA))),
        () => (None, None),
    };
    if space.is_none() {
        let what = "is not applied; the colours are read as sRGB (`colour_space` and `transfer` decide otherwise)";
        statement.warnings.push(format!("its {said} {what}"));
    }
    words.space = space.and_then(ColourSpace::primaries).map(|primaries| (said.clone(), primaries));
    words.transfer = transfer.map(|transfer| (said, transfer));
}

/// Description of an ICC profile: its tag `desc`, a text of version 2 or 4; `without a name` if there is none.
fn profile_name(profile: &[u8]) -> String {
    description(profile).filter(|name| !name.is_empty()).unwrap_or_else(|| "without a name".to_owned())
}

fn description(profile: &[u8]) -> Option<String> {
    let number = |at: usize| {
        let bytes = profile.get(at..at.checked_add(4)?)?;
        Some(u32::from_be_bytes(bytes.try_into().ok()?) as usize)
    };
    // A header of 128 bytes, the number of tags, and for each its name, offset and length.
    let tags = number(128)?.min(1000);
    let tag = (0..tags).map(|tag| 132 + 12 * tag).find(|at| profile.get(*at..at + 4) == Some(b"desc"))?;
    let (at, length) = (number(tag + 4)?, number(tag + 8)?);
    let text = profile.get(at..at.checked_add(length)?)?;
    let within = |from: usize, bytes: usize| text.get(from..from.checked_add(bytes)?);
    let name = match within(0, 4)? {
        b"desc" => {
            let count = u32::from_be_bytes(within(8, 4)?.try_into().ok()?) as usize;
            String::from_utf8_lossy(within(12, count)?).into_owned()
        }
        // The first record of a text in several languages: its length and offset in bytes, big-endian UTF-16.
        b"mluc" => {
            let [length, offset] = [20, 24].map(|at| within(at, 4).and_then(|bytes| bytes.try_into().ok()));
            let [length, offset] = [length?, offset?].map(|bytes| u32::from_be_bytes(bytes) as usize);
            let units = within(offset, length)?.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]]));
            char::decode_utf16(units).map(|unit| unit.unwrap_or('?')).collect()
        }
        _ => return None,
    };
    Some(name.chars().filter(|c| !c.is_control()).take(MAX_NAME).collect::<String>().trim().to_owned())
}
