//! The keys of a scene file: serde structs that deny unknown keys.

use toml::Spanned;

use crate::bump::FrameSystem;
use crate::error::SceneError;
use crate::lighting::{HighlightForm, Shadowing};
use crate::scene::{Deviation, FootprintPlace};
use crate::source::{ArgumentTable, Exactly, OneOrThree, Source};

/// The whole file.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneDescription {
    pub(super) camera: CameraDescription,
    pub(super) background: Option<Spanned<BackgroundDescription>>,
    pub(super) environment: Option<Spanned<ArgumentTable>>,
    #[serde(default)]
    pub(super) light: Vec<Spanned<LightDescription>>,
    #[serde(default)]
    pub(super) object: Vec<Spanned<ObjectDescription>>,
}

/// `[camera]`.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraDescription {
    pub(super) eye: Spanned<Exactly<f64, 3>>,
    pub(super) target: Spanned<Exactly<f64, 3>>,
    pub(super) up: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) fov_y: Option<Spanned<f64>>,
    pub(super) width: Option<Spanned<i64>>,
    pub(super) height: Option<Spanned<i64>>,
}

/// `[background]`: exactly one of `colour`, `top` with `bottom`, `environment = true`.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BackgroundDescription {
    pub(super) colour: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) top: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) bottom: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) environment: Option<Spanned<bool>>,
}

/// One `[[object]]`.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectDescription {
    pub(super) name: Option<String>,
    pub(super) shape: Spanned<ShapeName>,
    pub(super) size: Option<Spanned<Exactly<f64, 2>>>,
    pub(super) radius: Option<Spanned<f64>>,
    pub(super) height: Option<Spanned<f64>>,
    pub(super) arc_degrees: Option<Spanned<f64>>,
    pub(super) focal_length: Option<Spanned<f64>>,
    pub(super) depth: Option<Spanned<f64>>,
    pub(super) folds: Option<Spanned<f64>>,
    pub(super) segments: Option<Spanned<Exactly<i64, 2>>>,
    pub(super) path: Option<Spanned<String>>,
    pub(super) generate: Option<Spanned<String>>,
    pub(super) offset: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) tangents: Option<Spanned<TangentsName>>,
    pub(super) translate: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) rotate_degrees: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) scale: Option<Spanned<OneOrThree>>,
    pub(super) uv_repeat: Option<Spanned<Exactly<f64, 2>>>,
    #[serde(default)]
    pub(super) material: MaterialDescription,
}

/// `shape = "…"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ShapeName {
    Plane,
    Sphere,
    Cylinder,
    Paraboloid,
    Drapery,
    Mesh,
}

/// `tangents = "…"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum TangentsName {
    Mikktspace,
    Texture,
}

/// `[object.material]`.
#[derive(Debug, Default, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialDescription {
    pub(super) colour: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) colour_map: Option<Spanned<ArgumentTable>>,
    pub(super) height_map: Option<Spanned<ArgumentTable>>,
    pub(super) normal_map: Option<Spanned<ArgumentTable>>,
    pub(super) roughness_map: Option<Spanned<ArgumentTable>>,
    pub(super) frame: Option<FrameSystem>,
    pub(super) main_direction: Option<Spanned<Exactly<f64, 3>>>,
    pub(super) reflectance: Option<Spanned<OneOrThree>>,
    pub(super) bump_deviation: Option<Deviation>,
    pub(super) footprint: Option<FootprintPlace>,
    pub(super) two_lobes: Option<bool>,
    pub(super) highlight: Option<Spanned<HighlightDescription>>,
    pub(super) peaks: Option<Spanned<PeaksDescription>>,
}

/// One `[[light]]`.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LightDescription {
    pub(crate) direction: Option<Spanned<Exactly<f64, 3>>>,
    pub(crate) position: Option<Spanned<Exactly<f64, 3>>>,
    pub(crate) colour: Option<Spanned<Exactly<f64, 3>>>,
}

/// `highlight = { … }`.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct HighlightDescription {
    pub(crate) exponent: Option<Spanned<f64>>,
    pub(crate) colour: Option<Spanned<Exactly<f64, 3>>>,
    #[serde(default)]
    pub(crate) form: HighlightForm,
}

/// `peaks = { … }`.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PeaksDescription {
    pub(crate) given: Option<Spanned<Vec<Spanned<GivenDescription>>>>,
    pub(crate) exponent: Option<Spanned<f64>>,
    pub(crate) amplitude: Option<Spanned<f64>>,
    pub(crate) colour: Option<Spanned<Exactly<f64, 3>>>,
    pub(crate) shadowing: Option<Spanned<ShadowingDescription>>,
}

impl PeaksDescription {
    /// True if the heights of the bump map are needed as well as its offsets.
    pub(crate) fn needs_heights(&self) -> bool {
        self.given.is_none() && self.shadowing.as_ref().is_some_and(|wanted| wanted.get_ref().0.is_some())
    }
}

/// `shadowing = true`, `false` or `"product"`.
#[derive(Debug)]
pub(crate) struct ShadowingDescription(pub(crate) Option<Shadowing>);

impl<'de> serde::Deserialize<'de> for ShadowingDescription {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Word;
        impl serde::de::Visitor<'_> for Word {
            type Value = ShadowingDescription;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("true, false or \"product\"")
            }
            fn visit_bool<E>(self, wanted: bool) -> Result<Self::Value, E> {
                Ok(ShadowingDescription(wanted.then_some(Shadowing::Correlated)))
            }
            fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Self::Value, E> {
                match name {
                    "product" => Ok(ShadowingDescription(Some(Shadowing::Product))),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(name), &self)),
                }
            }
        }
        deserializer.deserialize_any(Word)
    }
}

/// One element of `given`.
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GivenDescription {
    pub(crate) amplitude: Spanned<f64>,
    pub(crate) normal: Spanned<Exactly<f64, 3>>,
    pub(crate) exponent: Spanned<f64>,
}

impl Source {
    /// Parses the text. Errors: [`SceneError::Fault`].
    pub(super) fn parse(&self) -> Result<SceneDescription, SceneError> {
        toml::from_str(&self.text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            let message = error.message().replace('\n', "; ");
            let help = if message.contains("expected a map") {
                "write { path = \"FILE\" } or { generate = \"NAME\" }; every key is described in emulator/scenes/README.md"
            } else {
                "every key is described in emulator/scenes/README.md"
            };
            self.value_error(span, message, help)
        })
    }
}
