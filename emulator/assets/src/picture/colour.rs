//! Colour spaces and transfer functions: from the numbers of a file to linear light with the primaries of Rec. 709.
//!
//! A colour becomes XYZ by the primaries and the white of its file, is adapted to D65 (Bradford), and becomes Rec. 709. White stays white. Powers
//! come from `libm`, so the pixels are the same bits on every machine.

use glam::{DMat3, DVec3};
use serde::Serialize;

use super::srgb::srgb_to_linear;

/// Chromaticities of the primaries and the white of a colour space, CIE 1931 x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Primaries {
    /// Red, green, blue.
    pub(super) colours: [[f64; 2]; 3],
    /// White: the colour of (1, 1, 1).
    pub(super) white: [f64; 2],
}

pub(super) const D65: [f64; 2] = [0.3127, 0.329];
const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];
/// White of ICC profiles, as XYZ (ICC.1:2022 §7.2.16).
const D50: DVec3 = DVec3::new(0.9642, 1.0, 0.8249);

/// Rec. 709 and sRGB.
pub(super) const REC_709: Primaries = Primaries { colours: [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]], white: D65 };

/// Colour space of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColourSpace {
    /// No conversion, whatever the file says.
    AsIs,
    /// Rec. 709 and sRGB.
    Rec709,
    /// Rec. 2020 and Rec. 2100.
    Rec2020,
    /// Display P3.
    P3,
    /// Adobe RGB (1998).
    AdobeRgb,
    /// ACEScg (AP1).
    Acescg,
    /// ACES 2065-1 (AP0).
    Aces,
    /// CIE XYZ with the white of equal energy.
    Xyz,
}

/// Colour spaces with their names in the key and in sentences.
const SPACES: [(ColourSpace, &str, &str, Primaries); 7] = [
    (ColourSpace::Rec709, "rec709", "Rec. 709", REC_709),
    (
        ColourSpace::Rec2020,
        "rec2020",
        "Rec. 2020",
        Primaries { colours: [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]], white: D65 },
    ),
    (
        ColourSpace::P3,
        "p3",
        "Display P3",
        Primaries { colours: [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]], white: D65 },
    ),
    (
        ColourSpace::AdobeRgb,
        "adobe-rgb",
        "Adobe RGB",
        Primaries { colours: [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06]], white: D65 },
    ),
    (
        ColourSpace::Acescg,
        "acescg",
        "ACEScg",
        Primaries { colours: [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044]], white: ACES_WHITE },
    ),
    (
        ColourSpace::Aces,
        "aces",
        "ACES 2065-1",
        Primaries { colours: [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]], white: ACES_WHITE },
    ),
    (
        ColourSpace::Xyz,
        "xyz",
        "CIE XYZ",
        Primaries { colours: [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]], white: [1.0 / 3.0, 1.0 / 3.0] },
    ),
];

impl ColourSpace {
    /// Words of the key `colour_space`.
    pub const WORDS: [(&'static str, Self); 8] = [
        ("as-is", Self::AsIs),
        ("rec709", Self::Rec709),
        ("rec2020", Self::Rec2020),
        ("p3", Self::P3),
        ("adobe-rgb", Self::AdobeRgb),
        ("acescg", Self::Acescg),
        ("aces", Self::Aces),
        ("xyz", Self::Xyz),
    ];

    /// Primaries; `None` for numbers that are not converted.
    pub(super) fn primaries(self) -> Option<Primaries> {
        SPACES.iter().find(|(space, ..)| *space == self).map(|(.., primaries)| *primaries)
    }
}

/// Largest difference of chromaticities that count as equal: files round them to three or four decimals.
const SAME: f64 = 0.001;

impl Primaries {
    fn all(&self) -> [f64; 8] {
        let [[a, b], [c, d], [e, f]] = self.colours;
        [a, b, c, d, e, f, self.white[0], self.white[1]]
    }

    /// True if no chromaticity differs by more than `tolerance`.
    pub(super) fn is_within(&self, other: &Self, tolerance: f64) -> bool {
        self.all().iter().zip(other.all()).all(|(own, other)| (own - other).abs() <= tolerance)
    }

    pub(super) fn is_near(&self, other: &Self) -> bool {
        self.is_within(other, SAME)
    }

    /// Name of a known colour space, or the chromaticities.
    pub(super) fn name(&self) -> String {
        if let Some((_, _, name, _)) = SPACES.iter().find(|(.., known)| self.is_near(known)) {
            return (*name).to_owned();
        }
        let [red, green, blue] = self.colours.map(|[x, y]| format!("({x:.4}, {y:.4})"));
        format!("red {red}, green {green}, blue {blue}, white ({:.4}, {:.4})", self.white[0], self.white[1])
    }

    /// Matrix to XYZ whose (1, 1, 1) is white with Y = 1; `None` for chromaticities that span no space.
    fn to_xyz(self) -> Option<DMat3> {
        let [x, y] = self.white;
        let column = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
        let directions = DMat3::from_cols_array_2d(&self.colours.map(|colour| column(colour).to_array()));
        let scales = directions.inverse() * (column([x, y]) / y);
        let matrix = directions * DMat3::from_diagonal(scales);
        (directions.determinant().abs() > 1e-6 && matrix.is_finite()).then_some(matrix)
    }

    /// Chromaticities of these colours adapted to D50, as ICC profiles have them.
    pub(super) fn under_d50(self) -> Option<Self> {
        let own = self.to_xyz()?;
        let adapted = adaptation(own * DVec3::ONE, D50) * own;
        let chromaticity = |colour: DVec3| [colour.x, colour.y].map(|part| part / colour.element_sum());
        let colours = [adapted.x_axis, adapted.y_axis, adapted.z_axis].map(chromaticity);
        Some(Self { colours, white: chromaticity(D50) })
    }

    /// Matrix to linear Rec. 709.
    ///
    /// `None` within `Some`: the colours are those of Rec. 709. `None`: the chromaticities span no space.
    pub(super) fn to_rec_709(self) -> Option<Option<DMat3>> {
        if self.is_near(&REC_709) {
            return Some(None);
        }
        let own = self.to_xyz()?;
        let target = REC_709.to_xyz()?;
        let matrix = target.inverse() * adaptation(own * DVec3::ONE, target * DVec3::ONE) * own;
        matrix.is_finite().then_some(Some(matrix))
    }
}

/// Bradford's adaptation from one white to another.
fn adaptation(from: DVec3, to: DVec3) -> DMat3 {
    // Cone responses.
    let bradford =
        DMat3::from_cols_array_2d(&[[0.8951, -0.7502, 0.0389], [0.2664, 1.7135, -0.0685], [-0.1614, 0.0367, 1.0296]]);
    bradford.inverse() * DMat3::from_diagonal((bradford * to) / (bradford * from)) * bradford
}

/// Transfer function: from a number in a file to linear light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transfer {
    /// Linear light.
    Linear,
    /// The curve of sRGB (IEC 61966-2-1).
    Srgb,
    /// The camera curve of Rec. 709, Rec. 601 and Rec. 2020, inverted.
    Bt709,
    /// Perceptual quantiser (SMPTE ST 2084); 203 cd/m² become 1 (ITU-R BT.2408).
    Pq,
    /// Hybrid log-gamma (ITU-R BT.2100), light of the scene; a code of 0.75 becomes 1 (ITU-R BT.2408).
    Hlg,
    /// A power.
    Gamma(f64),
}

impl Transfer {
    /// Words of the key `transfer`.
    pub const WORDS: [(&'static str, Self); 7] = [
        ("linear", Self::Linear),
        ("srgb", Self::Srgb),
        ("bt709", Self::Bt709),
        ("pq", Self::Pq),
        ("hlg", Self::Hlg),
        ("gamma-1.8", Self::Gamma(1.8)),
        ("gamma-2.2", Self::Gamma(2.2)),
    ];

    /// Name in sentences.
    pub(super) fn name(self) -> String {
        match self {
            Self::Linear => "linear".to_owned(),
            Self::Srgb => "sRGB".to_owned(),
            Self::Bt709 => "Rec. 709".to_owned(),
            Self::Pq => "PQ".to_owned(),
            Self::Hlg => "HLG".to_owned(),
            Self::Gamma(gamma) => format!("gamma {gamma:.2}"),
        }
    }

    /// Linear light of a number of a file. Below 0 the curve is mirrored.
    pub(super) fn decode(self, encoded: f64) -> f64 {
        let x = encoded.abs();
        let linear = match self {
            Self::Linear => x,
            Self::Srgb if x <= 1.0 => srgb_to_linear(x),
            Self::Srgb => libm::pow((x + 0.055) / 1.055, 2.4),
            Self::Bt709 if x < 0.081 => x / 4.5,
            Self::Bt709 => libm::pow((x + 0.099) / 1.099, 1.0 / 0.45),
            Self::Pq => {
                let (m1, m2) = (2610.0 / 16384.0, 2523.0 / 32.0);
                let (c1, c2, c3) = (3424.0 / 4096.0, 2413.0 / 128.0, 2392.0 / 128.0);
                let power = libm::pow(x.min(1.0), 1.0 / m2);
                10_000.0 / 203.0 * libm::pow((power - c1).max(0.0) / (c2 - c3 * power), 1.0 / m1)
            }
            Self::Hlg => {
                let (a, b, c) = (0.178_832_77, 0.284_668_92, 0.559_910_73);
                let scene = |x: f64| if x <= 0.5 { x * x / 3.0 } else { (libm::exp((x - c) / a) + b) / 12.0 };
                scene(x) / scene(0.75)
            }
            Self::Gamma(gamma) => libm::pow(x, gamma),
        };
        if encoded < 0.0 { -linear } else { linear }
    }
}
