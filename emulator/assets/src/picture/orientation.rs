//! Order of the pixels of a file that cameras turn: the tag `Orientation` of TIFF and EXIF.

use std::fmt;

use super::Picture;
use super::decoded::Decoded;

/// Order of the pixels: 1 to 8 as TIFF 6.0 defines them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Orientation(u16);

impl fmt::Display for Orientation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "orientation {}", self.0)
    }
}

impl Orientation {
    /// Rows from the top, columns from the left.
    pub(super) const UPRIGHT: Self = Self(1);

    /// Rows from the bottom, columns from the left.
    pub(super) const FROM_THE_BOTTOM: Self = Self(4);

    /// Orientation of a tag's number; `None` for others than 1 to 8.
    pub(super) fn from_tag(number: u16) -> Option<Self> {
        (1..=8).contains(&number).then_some(Self(number))
    }

    /// Orientation of EXIF data, which starts as a TIFF file does; some programs keep the name of JPEG's segment in front.
    pub(super) fn from_exif(exif: &[u8]) -> Option<Self> {
        let exif = exif.strip_prefix(b"Exif\0\0").unwrap_or(exif);
        let big = match exif.get(..4)? {
            b"MM\0*" => true,
            b"II*\0" => false,
            _ => return None,
        };
        let short = |at: usize| {
            let bytes = exif.get(at..at.checked_add(2)?)?.try_into().ok()?;
            Some(if big { u16::from_be_bytes(bytes) } else { u16::from_le_bytes(bytes) })
        };
        let offset: [u8; 4] = exif.get(4..8)?.try_into().ok()?;
        let directory = if big { u32::from_be_bytes(offset) } else { u32::from_le_bytes(offset) } as usize;
        let entries = usize::from(short(directory)?);
        let entry = (0..entries).map(|entry| directory + 2 + 12 * entry).find(|at| short(*at) == Some(0x0112))?;
        Self::from_tag(short(entry + 8)?)
    }

    /// A picture turned upright by the EXIF data of its file, which its statement says.
    pub(super) fn upright(exif: Option<&[u8]>, mut read: Decoded) -> Decoded {
        let orientation = exif.and_then(Self::from_exif).unwrap_or(Self::UPRIGHT);
        if orientation != Self::UPRIGHT {
            read.statement.notes.push(format!("EXIF {orientation}: the picture is turned upright"));
        }
        read.picture = orientation.apply(read.picture);
        read
    }

    /// Turns a picture upright.
    pub(super) fn apply(self, picture: Picture) -> Picture {
        if self == Self::UPRIGHT {
            return picture;
        }
        let (columns, rows) = (picture.width, picture.height);
        let is_turned = self.0 >= 5;
        let (width, height) = if is_turned { (rows, columns) } else { (columns, rows) };
        // Place in the file of the pixel in column x and row y.
        let place = |x: u32, y: u32| match self.0 {
            2 => (columns - 1 - x, y),
            3 => (columns - 1 - x, rows - 1 - y),
            4 => (x, rows - 1 - y),
            5 => (y, x),
            6 => (y, rows - 1 - x),
            7 => (columns - 1 - y, rows - 1 - x),
            8 => (columns - 1 - y, x),
            _ => (x, y),
        };
        let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let pixels = all.map(|(x, y)| place(x, y)).map(|(x, y)| picture.pixel(x, y)).collect();
        Picture { width, height, pixels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_of_all_orientations_stand_upright() {
        // Upright: 0 1 2 over 3 4 5. Stored as TIFF 6.0 describes each: where its row 0 and its column 0 are.
        let table: [(u16, u32, [u32; 6]); 8] = [
            (1, 3, [0, 1, 2, 3, 4, 5]),
            (2, 3, [2, 1, 0, 5, 4, 3]),
            (3, 3, [5, 4, 3, 2, 1, 0]),
            (4, 3, [3, 4, 5, 0, 1, 2]),
            (5, 2, [0, 3, 1, 4, 2, 5]),
            (6, 2, [2, 5, 1, 4, 0, 3]),
            (7, 2, [5, 2, 4, 1, 3, 0]),
            (8, 2, [3, 0, 4, 1, 5, 2]),
        ];
        for (tag, width, stored) in table {
            let pixels = stored.map(|index| [index as f32; 3]).to_vec();
            let upright = Orientation(tag).apply(Picture { width, height: 6 / width, pixels });
            let found: Vec<u32> = upright.pixels.iter().map(|pixel| pixel[0] as u32).collect();
            assert_eq!((upright.width, found.as_slice()), (3, &[0, 1, 2, 3, 4, 5][..]), "{tag}");
        }
    }

    #[test]
    fn exif_of_both_byte_orders_is_read_and_damaged_exif_is_none() {
        let big: &[u8] = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
        let little: &[u8] = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
        for exif in [big, little] {
            assert_eq!(Orientation::from_exif(exif), Some(Orientation(6)));
            for end in 0..20 {
                assert_eq!(Orientation::from_exif(&exif[..end]).filter(|_| end < 19), None, "{end}");
            }
        }
        assert_eq!(Orientation::from_exif(b"MM\0*\xff\xff\xff\xff"), None);
    }
}
