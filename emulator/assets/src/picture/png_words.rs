//! Words of a PNG about its colours: cICP, iCCP, sRGB, cHRM and gAMA, in the precedence of PNG's third edition.

use super::colour::{ColourSpace, D65, Primaries, Transfer};
use super::colour_words::ColourWords;
use super::icc::profile_words;

/// gAMA of files in sRGB: 1 / 2.2.
const SRGB_GAMA: f64 = 0.45455;
/// Relative difference of gammas that count as equal.
const SAME_GAMMA: f64 = 0.01;

/// The words of the chunk of highest precedence.
pub(super) fn colour_words(info: &png::Info<'_>) -> ColourWords {
    let mut words = ColourWords::new(Transfer::Srgb);
    if let Some(cicp) = &info.coding_independent_code_points {
        cicp_words(cicp, &mut words);
    } else if let Some(profile) = &info.icc_profile {
        profile_words(profile, "iCCP", &mut words);
    } else if info.srgb.is_some() {
        words.space = ColourSpace::Rec709.primaries().map(|primaries| ("sRGB".to_owned(), primaries));
        words.transfer = Some(("sRGB".to_owned(), Transfer::Srgb));
    } else {
        if let Some(own) = info.chrm_chunk {
            let point = |(x, y): (png::ScaledFloat, png::ScaledFloat)| [x, y].map(|v| f64::from(v.into_value()));
            let primaries = Primaries { colours: [own.red, own.green, own.blue].map(point), white: point(own.white) };
            words.space = Some((format!("cHRM of {}", primaries.name()), primaries));
        }
        if let Some(gamma) = info.gama_chunk {
            let gamma = f64::from(gamma.into_value());
            let is = |other: f64| (gamma / other - 1.0).abs() < SAME_GAMMA;
            let transfer = match () {
                () if is(1.0) => Transfer::Linear,
                // Programs write this power for the curve of sRGB, which it approximates.
                () if is(SRGB_GAMA) => Transfer::Srgb,
                () => Transfer::Gamma(1.0 / gamma),
            };
            words.transfer = Some((format!("gAMA {gamma:.5}"), transfer));
        }
    }
    words
}

/// Code points of ITU-T H.273.
fn cicp_words(cicp: &png::CodingIndependentCodePoints, words: &mut ColourWords) {
    let primaries = |colours, white| Some(Primaries { colours, white });
    let said = format!("cICP colour primaries {}", cicp.color_primaries);
    let space = match cicp.color_primaries {
        1 => ColourSpace::Rec709.primaries(),
        4 => primaries([[0.67, 0.33], [0.21, 0.71], [0.14, 0.08]], [0.31, 0.316]),
        5 => primaries([[0.64, 0.33], [0.29, 0.6], [0.15, 0.06]], D65),
        6 | 7 => primaries([[0.63, 0.34], [0.31, 0.595], [0.155, 0.07]], D65),
        9 => ColourSpace::Rec2020.primaries(),
        10 => ColourSpace::Xyz.primaries(),
        11 => primaries([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]], [0.314, 0.351]),
        12 => ColourSpace::P3.primaries(),
        _ => None,
    };
    if space.is_none() && cicp.color_primaries != 2 {
        let what = "are not known; the colours are read as Rec. 709 (`colour_space` decides otherwise)";
        words.warnings.push(format!("its {said} {what}"));
    }
    words.space = space.map(|space| (said, space));
    let said = format!("cICP transfer function {}", cicp.transfer_function);
    let transfer = match cicp.transfer_function {
        1 | 6 | 14 | 15 => Some(Transfer::Bt709),
        4 => Some(Transfer::Gamma(2.2)),
        5 => Some(Transfer::Gamma(2.8)),
        8 => Some(Transfer::Linear),
        13 => Some(Transfer::Srgb),
        16 => Some(Transfer::Pq),
        18 => Some(Transfer::Hlg),
        _ => None,
    };
    let note = match transfer {
        Some(Transfer::Bt709) => Some("is the camera curve of Rec. 709, which is inverted"),
        Some(Transfer::Pq) => Some("is PQ; 203 cd/m² become 1"),
        Some(Transfer::Hlg) => Some("is HLG; a code of 0.75 becomes 1"),
        None if cicp.transfer_function != 2 => Some("is not known; the codes are read as sRGB"),
        _ => None,
    };
    words.warnings.extend(note.map(|note| format!("its {said} {note} (`transfer` decides otherwise)")));
    words.transfer = transfer.map(|transfer| (said, transfer));
    if !cicp.is_video_full_range_image {
        let what = "is read as the full range of codes";
        words
            .warnings
            .push(format!("its cICP says narrow range (black above 0), which {what}: export it in full range"));
    }
}
