//! Words of an OpenEXR header about its colours.

use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::Header;

use super::colour::{ColourSpace, Primaries, Transfer};
use super::colour_words::ColourWords;
use super::statement::Statement;

/// Attributes that name the colour space of the pixels, by rank: OpenEXR and the Color Interop Forum, OpenImageIO.
const NAMES: [&str; 2] = ["colorInteropID", "oiio:ColorSpace"];

/// Primaries by `chromaticities`, by the name of a colour space, or by the flag of ACES containers, and the transfer function of the name.
pub(super) fn colour_words(header: &Header, statement: &mut Statement) -> ColourWords {
    let mut words = ColourWords::new(Transfer::Linear);
    for attribute in NAMES {
        let Some(AttributeValue::Text(name)) = attribute_of(header, attribute) else { continue };
        let said = format!("{attribute} `{name}`");
        let (space, transfer) = interop_name(&name.to_string());
        if space.is_none() && transfer.is_none() && !matches!(name.to_string().as_str(), "data" | "unknown" | "") {
            statement.ignored.push(format!("{said}: no known name of a colour space"));
        }
        words.space = words.space.or(space.map(|primaries| (said.clone(), primaries)));
        words.transfer = words.transfer.or(transfer.map(|transfer| (said, transfer)));
    }
    if let (None, Some(AttributeValue::I32(1))) = (&words.space, attribute_of(header, "acesImageContainerFlag")) {
        let aces = ColourSpace::Aces.primaries();
        words.space = aces.map(|aces| ("acesImageContainerFlag 1".to_owned(), aces));
    }
    if let Some(own) = header.shared_attributes.chromaticities {
        let point = |place: exr::math::Vec2<f32>| [f64::from(place.x()), f64::from(place.y())];
        let primaries = Primaries { colours: [own.red, own.green, own.blue].map(point), white: point(own.white) };
        words.space = Some((format!("chromaticities of {}", primaries.name()), primaries));
    }
    if let Some(nits) = header.own_attributes.white_luminance {
        statement.ignored.push(format!("whiteLuminance {nits} cd/m²: light is in units of white"));
    }
    let aspect = header.shared_attributes.pixel_aspect;
    if (aspect - 1.0).abs() > 0.01 {
        statement.ignored.push(format!("pixelAspectRatio {aspect}: pixels are taken as squares"));
    }
    words
}

fn attribute_of<'a>(header: &'a Header, name: &str) -> Option<&'a AttributeValue> {
    let name = Text::new_or_none(name)?;
    header.own_attributes.other.get(&name).or_else(|| header.shared_attributes.other.get(&name))
}

/// Primaries and transfer function of a name such as `lin_rec709_scene` or `srgb_p3d65_display`, or of an older name.
fn interop_name(name: &str) -> (Option<Primaries>, Option<Transfer>) {
    let name = name.to_ascii_lowercase();
    let words: Vec<&str> = name.split(['_', ' ', '-']).collect();
    let has = |word: &str| words.contains(&word);
    let space = match () {
        () if has("ap1") || has("acescg") => Some(ColourSpace::Acescg),
        () if has("ap0") || has("aces2065") => Some(ColourSpace::Aces),
        () if has("rec2020") || has("bt2020") => Some(ColourSpace::Rec2020),
        () if has("p3d65") => Some(ColourSpace::P3),
        () if has("adobergb") => Some(ColourSpace::AdobeRgb),
        () if has("rec709") || has("srgb") => Some(ColourSpace::Rec709),
        () => None,
    };
    let transfer = match () {
        () if has("lin") || has("linear") || has("acescg") || has("aces2065") => Some(Transfer::Linear),
        () if has("g22") => Some(Transfer::Gamma(2.2)),
        () if has("g18") => Some(Transfer::Gamma(1.8)),
        () if has("pq") => Some(Transfer::Pq),
        () if has("hlg") => Some(Transfer::Hlg),
        () if has("srgb") => Some(Transfer::Srgb),
        () => None,
    };
    (space.and_then(ColourSpace::primaries), transfer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_colour_spaces_are_known() {
        let table = [
            ("lin_rec709_scene", Some(ColourSpace::Rec709), Some(Transfer::Linear)),
            ("lin_rec709", Some(ColourSpace::Rec709), Some(Transfer::Linear)),
            ("lin_ap1_scene", Some(ColourSpace::Acescg), Some(Transfer::Linear)),
            ("lin_ap0_scene", Some(ColourSpace::Aces), Some(Transfer::Linear)),
            ("lin_rec2020_scene", Some(ColourSpace::Rec2020), Some(Transfer::Linear)),
            ("lin_p3d65_scene", Some(ColourSpace::P3), Some(Transfer::Linear)),
            ("lin_adobergb_scene", Some(ColourSpace::AdobeRgb), Some(Transfer::Linear)),
            ("srgb_rec709_scene", Some(ColourSpace::Rec709), Some(Transfer::Srgb)),
            ("srgb_ap1_scene", Some(ColourSpace::Acescg), Some(Transfer::Srgb)),
            ("g22_rec709_scene", Some(ColourSpace::Rec709), Some(Transfer::Gamma(2.2))),
            ("g18_rec709_scene", Some(ColourSpace::Rec709), Some(Transfer::Gamma(1.8))),
            ("ACEScg", Some(ColourSpace::Acescg), Some(Transfer::Linear)),
            ("ACES2065-1", Some(ColourSpace::Aces), Some(Transfer::Linear)),
            ("Linear", None, Some(Transfer::Linear)),
            ("data", None, None),
            ("my show look", None, None),
        ];
        for (name, space, transfer) in table {
            assert_eq!(interop_name(name), (space.and_then(ColourSpace::primaries), transfer), "{name}");
        }
    }
}
