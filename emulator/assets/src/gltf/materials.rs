//! Materials and images of a model.

use std::collections::BTreeSet;

use glam::{DAffine2, DVec2};
use serde_json::Value;

use super::buffers::Buffers;

/// An image, as its bytes.
#[derive(Debug)]
pub struct Image {
    /// Name from the file, or its number.
    pub name: String,
    /// A picture file.
    pub bytes: Vec<u8>,
}

/// Texture of normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalTexture {
    /// Index of its image.
    pub image: usize,
    /// Factor of the components x and y.
    pub scale: f64,
}

/// Metallic-roughness material (glTF 2.0 §3.9). Textures are indices of images.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelMaterial {
    /// Name from the file.
    pub name: Option<String>,
    /// Factor of the base colour, linear.
    pub colour: [f64; 3],
    /// Base colour, sRGB.
    pub colour_texture: Option<usize>,
    /// Factor of the metallic texture, 0 to 1.
    pub metallic: f64,
    /// Factor of the roughness texture, 0 to 1. α = roughness².
    pub roughness: f64,
    /// Roughness in green, metallic in blue; linear.
    pub metallic_roughness_texture: Option<usize>,
    /// Normals, tangent space, green up.
    pub normal_texture: Option<NormalTexture>,
    /// Factor of the emitted light, linear, with its strength.
    pub emissive: [f64; 3],
    /// Emitted light, sRGB.
    pub emissive_texture: Option<usize>,
}

/// Reads a material. `ignored` takes what cannot be drawn.
pub(super) fn material(material: &gltf::Material<'_>, ignored: &mut BTreeSet<String>) -> ModelMaterial {
    let pbr = material.pbr_metallic_roughness();
    let image = |texture: gltf::Texture<'_>| texture.source().index();
    if material.alpha_mode() != gltf::material::AlphaMode::Opaque {
        ignored.insert("transparency is not drawn: surfaces are opaque".to_owned());
    }
    if material.occlusion_texture().is_some() {
        ignored.insert("occlusion textures are not used".to_owned());
    }
    let strength = f64::from(material.emissive_strength().unwrap_or(1.0));
    let [red, green, blue, _] = pbr.base_color_factor().map(f64::from);
    ModelMaterial {
        name: material.name().map(str::to_owned),
        colour: [red, green, blue],
        colour_texture: pbr.base_color_texture().map(|info| image(info.texture())),
        metallic: pbr.metallic_factor().into(),
        roughness: pbr.roughness_factor().into(),
        metallic_roughness_texture: pbr.metallic_roughness_texture().map(|info| image(info.texture())),
        normal_texture: material
            .normal_texture()
            .map(|normal| NormalTexture { image: image(normal.texture()), scale: normal.scale().into() }),
        emissive: material.emissive_factor().map(|factor| f64::from(factor) * strength),
        emissive_texture: material.emissive_texture().map(|info| image(info.texture())),
    }
}

/// Name of the extension that moves texture coordinates.
const TRANSFORM: &str = "KHR_texture_transform";

/// Set of texture coordinates and transform of one texture.
#[derive(Clone, Copy, PartialEq)]
struct Placement {
    set: u32,
    transform: DAffine2,
}

impl Placement {
    fn new(set: u32, extension: Option<&Value>) -> Self {
        let numbers = |key: &str, default: f64| {
            let list = extension.and_then(|value| value.get(key)?.as_array());
            DVec2::from_array([0, 1].map(|index| list.and_then(|list| list.get(index)?.as_f64()).unwrap_or(default)))
        };
        // glTF turns counter-clockwise with v downwards: u' = u cos + v sin, v' = v cos − u sin.
        let angle = extension.and_then(|value| value.get("rotation")?.as_f64()).unwrap_or(0.0);
        let transform = DAffine2::from_scale_angle_translation(DVec2::ONE, -angle, numbers("offset", 0.0))
            * DAffine2::from_scale(numbers("scale", 1.0));
        let set = extension.and_then(|value| value.get("texCoord")?.as_u64()).map_or(set, |set| set as u32);
        Self { set, transform }
    }
}

/// Places the textures of a material: one placement serves all, that of the normals if there are some.
pub(super) fn placement(material: &gltf::Material<'_>, ignored: &mut BTreeSet<String>) -> (u32, DAffine2) {
    let pbr = material.pbr_metallic_roughness();
    let normal = material.normal_texture();
    let normal = normal.iter().map(|texture| Placement::new(texture.tex_coord(), texture.extension_value(TRANSFORM)));
    let infos = [pbr.base_color_texture(), pbr.metallic_roughness_texture(), material.emissive_texture()];
    let others = infos.iter().flatten().map(|info| Placement::new(info.tex_coord(), info.extension_value(TRANSFORM)));
    let all: Vec<Placement> = normal.chain(others).collect();
    let first = all.first().copied().unwrap_or(Placement::new(0, None));
    if all.iter().any(|other| *other != first) {
        let what = "textures of one material lie differently (set or KHR_texture_transform): all are drawn as the first of \
                    normals, base colour, roughness and emission";
        ignored.insert(what.to_owned());
    }
    (first.set, first.transform)
}

/// Reads an image.
pub(super) fn image(image: &gltf::Image<'_>, buffers: &Buffers) -> Result<Image, String> {
    let name = image.name().map_or_else(|| image.index().to_string(), str::to_owned);
    let bytes = match image.source() {
        gltf::image::Source::View { view, .. } => buffers
            .view(&view)
            .ok_or_else(|| format!("image {} reaches beyond its buffer; the file is damaged", image.index()))?
            .to_vec(),
        gltf::image::Source::Uri { uri, .. } => buffers.resolve(uri)?,
    };
    Ok(Image { name, bytes })
}
