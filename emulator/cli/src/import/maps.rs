//! Materials of a model as the keys and maps of a scene.

use std::path::{Path, PathBuf};

use roughxel_assets::Picture;
use roughxel_assets::gltf::{Image, Model, ModelMaterial};
use roughxel_assets::picture::{PictureError, Purpose, Samples, Wishes, encode_png, linear_to_srgb8, read_bytes};

use crate::failure::Failure;

/// Share that a dielectric reflects at normal incidence (glTF 2.0 §B.2: an index of refraction of 1.5).
const DIELECTRIC: f64 = 0.04;

/// Standard deviation of slopes whose reflection comes nearest to that of GGX with α = roughness²; it rises with the roughness.
///
/// GGX has long tails. Under a small α only the middle of its lobe counts, which is as wide as α; under a large one the middle is narrower. The best
/// factors by picture against Cycles are 1.0 at α = 0.02, 0.95 at 0.05, 0.82 at 0.1 and 0.8 from 0.2 on.
fn deviation(roughness: f64) -> f64 {
    let alpha = roughness.powi(2);
    alpha * (0.8 + 0.2 / (1.0 + (alpha / 0.07).powi(4)))
}

/// Keys of the material of an object.
#[derive(Default)]
pub(super) struct MaterialMaps {
    pub(super) reflectance: [f64; 3],
    pub(super) colour: [f64; 3],
    pub(super) colour_map: Option<String>,
    pub(super) normal_map: Option<String>,
    pub(super) roughness_map: Option<String>,
    /// Standard deviation of slopes where the roughness map is white, or everywhere.
    pub(super) deviation: f64,
    pub(super) has_uv: bool,
}

/// Files of maps: name and content.
pub(super) type Files = Vec<(String, Vec<u8>)>;

/// Names for the files of the images of a model.
pub(super) fn image_names(model: &Model) -> Vec<String> {
    let name = |(index, image): (usize, &Image)| {
        let ending = match image.bytes.as_slice() {
            [0x89, b'P', b'N', b'G', ..] => "png",
            [0xff, 0xd8, ..] => "jpg",
            [b'R', b'I', b'F', b'F', ..] => "webp",
            [0xab, b'K', b'T', b'X', ..] => "ktx2",
            _ => "image",
        };
        format!("image_{index}.{ending}")
    };
    model.images.iter().enumerate().map(name).collect()
}

/// A model that is taken apart.
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    pub(super) model: &'a Model,
    /// Names for the files of its images.
    pub(super) images: Vec<String>,
}

/// A texture of the model, or nothing.
struct Texture(Option<Picture>);

impl Texture {
    fn read(source: &Source<'_>, image: Option<usize>, purpose: Purpose) -> Result<Self, PictureError> {
        let Some((index, image)) = image.and_then(|index| Some((index, source.model.images.get(index)?))) else {
            return Ok(Self(None));
        };
        let name = PathBuf::from(format!("{}: image {index}", source.path.display()));
        Ok(Self(Some(read_bytes(&name, &image.bytes, purpose, &Wishes::default())?.picture)))
    }

    fn size(&self) -> Option<[u32; 2]> {
        self.0.as_ref().map(|picture| [picture.width, picture.height])
    }

    /// The texel at the centre of texel (x, y) of a picture of `size`; white without a texture.
    fn texel(&self, x: u32, y: u32, size: [u32; 2]) -> [f64; 3] {
        let Some(picture) = &self.0 else { return [1.0; 3] };
        // (2x + 1) / 2w of the one is the same place in the other.
        let place =
            |at: u32, from: u32, to: u32| ((2 * u64::from(at) + 1) * u64::from(to) / (2 * u64::from(from))) as u32;
        picture.pixel(place(x, size[0], picture.width), place(y, size[1], picture.height)).map(f64::from)
    }
}

/// Textures of one material.
struct Textures<'a> {
    material: &'a ModelMaterial,
    colour: Texture,
    /// Roughness in green, metallic in blue.
    properties: Texture,
    emissive: Texture,
}

impl Textures<'_> {
    fn metallic(&self, x: u32, y: u32, size: [u32; 2]) -> f64 {
        (self.material.metallic * self.properties.texel(x, y, size)[2]).clamp(0.0, 1.0)
    }

    fn base(&self, x: u32, y: u32, size: [u32; 2]) -> [f64; 3] {
        let texel = self.colour.texel(x, y, size);
        [0, 1, 2].map(|channel| (self.material.colour[channel] * texel[channel]).clamp(0.0, 1.0))
    }

    /// Mean of what the material reflects at normal incidence.
    fn reflectance(&self, size: [u32; 2]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        each(size, |x, y| {
            let (metallic, base) = (self.metallic(x, y, size), self.base(x, y, size));
            for (sum, base) in sum.iter_mut().zip(base) {
                *sum += DIELECTRIC * (1.0 - metallic) + metallic * base;
            }
        });
        sum.map(|sum| sum / (f64::from(size[0]) * f64::from(size[1])))
    }

    /// Light without a reflection, before the factor 1 − reflectance of the pixel.
    fn shown(&self, x: u32, y: u32, size: [u32; 2], reflectance: [f64; 3]) -> [f64; 3] {
        let (metallic, base) = (self.metallic(x, y, size), self.base(x, y, size));
        let emissive = self.emissive.texel(x, y, size);
        [0, 1, 2].map(|channel| {
            let light = base[channel] * (1.0 - metallic) + self.material.emissive[channel] * emissive[channel];
            if reflectance[channel] < 1.0 { (light / (1.0 - reflectance[channel])).min(1.0) } else { 0.0 }
        })
    }
}

fn each(size: [u32; 2], mut texel: impl FnMut(u32, u32)) {
    for y in 0..size[1] {
        for x in 0..size[0] {
            texel(x, y);
        }
    }
}

/// Keys and maps of material `index`; `None` is glTF's default material. `files` takes the maps, `notes` what is left out.
pub(super) fn material(
    source: &Source<'_>,
    index: Option<usize>,
    has_uv: bool,
    files: &mut Files,
    notes: &mut Vec<String>,
) -> Result<MaterialMaps, Failure> {
    let default = ModelMaterial { colour: [1.0; 3], metallic: 1.0, roughness: 1.0, ..Default::default() };
    let material = index.and_then(|index| source.model.materials.get(index)).unwrap_or(&default);
    let number = index.map_or_else(|| "default".to_owned(), |index| index.to_string());
    let textured = [material.colour_texture, material.metallic_roughness_texture, material.emissive_texture];
    if !has_uv && (textured.iter().any(Option::is_some) || material.normal_texture.is_some()) {
        notes.push(format!("material {number}: textures are left out where a mesh has no texture coordinates"));
    }
    let read = |image: Option<usize>, purpose| Texture::read(source, image.filter(|_| has_uv), purpose);
    let textures = Textures {
        material,
        colour: read(material.colour_texture, Purpose::Colours)?,
        properties: read(material.metallic_roughness_texture, Purpose::Data)?,
        emissive: read(material.emissive_texture, Purpose::Colours)?,
    };
    let sizes = [textures.colour.size(), textures.properties.size(), textures.emissive.size()];
    let size = sizes.into_iter().flatten().max_by_key(|[width, height]| u64::from(*width) * u64::from(*height));
    let mut maps = MaterialMaps { has_uv, deviation: deviation(material.roughness), ..Default::default() };
    maps.reflectance = textures.reflectance(size.unwrap_or([1, 1]));
    match size {
        None => maps.colour = textures.shown(0, 0, [1, 1], maps.reflectance),
        Some(size) => {
            maps.colour = [1.0; 3];
            let mut codes = Vec::new();
            each(size, |x, y| {
                codes.extend(textures.shown(x, y, size, maps.reflectance).map(|light| linear_to_srgb8(light as f32)));
            });
            maps.colour_map = Some(map(files, format!("colour_{number}.png"), size, Samples::Srgb8(&codes))?);
        }
    }
    if textures.properties.0.is_some() && material.metallic > 0.0 {
        notes.push(format!("material {number}: an object has one reflectance, the mean of the metallic texture"));
    }
    let normals = read(material.normal_texture.map(|normal| normal.image), Purpose::Data)?;
    if let (Some(normal), Some(_)) = (material.normal_texture, normals.size()) {
        maps.normal_map = if normal.scale == 1.0 {
            source.images.get(normal.image).cloned()
        } else {
            Some(scaled_normals(files, &number, &normals, normal.scale)?)
        };
    }
    if let Some(own) = textures.properties.size() {
        let size = normals.size().unwrap_or(own);
        let mut bytes = Vec::new();
        each(size, |x, y| {
            let rough = material.roughness * textures.properties.texel(x, y, size)[1].clamp(0.0, 1.0);
            let share = if rough > 0.0 { deviation(rough) / maps.deviation } else { 0.0 };
            bytes.extend(((share * 65535.0).round() as u16).to_be_bytes());
        });
        maps.roughness_map = Some(map(files, format!("roughness_{number}.png"), size, Samples::Grey16(&bytes))?);
    }
    Ok(maps)
}

/// A map of normals whose x and y are multiplied by `scale` (glTF 2.0 §3.9.3).
fn scaled_normals(files: &mut Files, number: &str, normals: &Texture, scale: f64) -> Result<String, Failure> {
    let size = normals.size().unwrap_or([1, 1]);
    let mut codes = Vec::new();
    each(size, |x, y| {
        let [x, y, z] = normals.texel(x, y, size).map(|code| 2.0 * code - 1.0);
        let normal = glam::DVec3::new(x * scale, y * scale, z).normalize_or(glam::DVec3::Z);
        codes.extend(normal.to_array().map(|part| ((part + 1.0) / 2.0 * 255.0).round() as u8));
    });
    map(files, format!("normal_{number}.png"), size, Samples::Rgb8(&codes))
}

/// Adds a map to the files. Returns its name.
fn map(files: &mut Files, name: String, size: [u32; 2], samples: Samples<'_>) -> Result<String, Failure> {
    let mut bytes = Vec::new();
    encode_png(&mut bytes, size, samples)?;
    files.push((name.clone(), bytes));
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_the_measured_parts_of_alpha_and_rise_with_the_roughness() {
        for (alpha, factor) in [
            (0.001, 1.0),
            (0.01, 1.0),
            (0.02, 1.0),
            (0.05, 0.95),
            (0.1, 0.82),
            (0.2, 0.8),
            (0.3, 0.8),
            (0.5, 0.8),
            (0.8, 0.8),
            (1.0, 0.8),
        ] {
            let found = deviation(f64::sqrt(alpha)) / alpha;
            assert!((found - factor).abs() < 0.025, "{alpha}: {found} {factor}");
        }
        assert_eq!(deviation(0.0), 0.0);
        assert!((0..1000).map(f64::from).all(|x| deviation(x / 1000.0) < deviation((x + 1.0) / 1000.0)));
    }

    /// Material, and its right reflectance, colour and standard deviation of slopes, by glTF 2.0 §B.2 and the decision on models.
    #[test]
    fn materials_without_textures_become_three_keys() {
        let plain = ModelMaterial { colour: [0.5, 0.25, 1.0], roughness: 1.0, ..Default::default() };
        let with = |change: fn(&mut ModelMaterial)| {
            let mut material = plain.clone();
            change(&mut material);
            material
        };
        // Base colour over 1 − 0.04, at most 1.
        let matt = [0.5 / 0.96, 0.25 / 0.96, 1.0];
        let table = [
            ("plastic", plain.clone(), [0.04; 3], matt, 0.8),
            ("smooth plastic", with(|own| own.roughness = 0.0), [0.04; 3], matt, 0.0),
            ("metal", with(|own| own.metallic = 1.0), [0.5, 0.25, 1.0], [0.0; 3], 0.8),
            (
                "rough metal",
                with(|own| (own.metallic, own.roughness) = (1.0, 0.5)),
                [0.5, 0.25, 1.0],
                [0.0; 3],
                0.25 * 0.8,
            ),
            (
                "half a metal",
                with(|own| own.metallic = 0.5),
                [0.27, 0.145, 0.52],
                [0.25 / 0.73, 0.125 / 0.855, 1.0],
                0.8,
            ),
            ("a lamp", with(|own| own.emissive = [0.2; 3]), [0.04; 3], [0.7 / 0.96, 0.45 / 0.96, 1.0], 0.8),
            ("a bright lamp", with(|own| own.emissive = [9.0; 3]), [0.04; 3], [1.0; 3], 0.8),
            (
                "a glowing metal",
                with(|own| (own.metallic, own.emissive) = (1.0, [0.1; 3])),
                [0.5, 0.25, 1.0],
                [0.1 / 0.5, 0.1 / 0.75, 0.0],
                0.8,
            ),
            ("a colour above 1", with(|own| own.colour = [4.0, 0.0, 0.5]), [0.04; 3], [1.0, 0.0, 0.5 / 0.96], 0.8),
            ("black", with(|own| own.colour = [0.0; 3]), [0.04; 3], [0.0; 3], 0.8),
            ("more than a metal", with(|own| own.metallic = 3.0), [0.5, 0.25, 1.0], [0.0; 3], 0.8),
        ];
        let read = |model: &Model, index| {
            let source = Source { path: Path::new("a.glb"), model, images: Vec::new() };
            material(&source, index, true, &mut Files::new(), &mut Vec::new())
        };
        let close = |found: [f64; 3], expected: [f64; 3]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3);
        for (kind, own, reflectance, colour, deviation) in table {
            let model = Model { materials: vec![own], ..Default::default() };
            let Ok(maps) = read(&model, Some(0)) else { panic!("{kind}") };
            assert!(close(maps.reflectance, reflectance), "{kind}: {:?}", maps.reflectance);
            assert!(close(maps.colour, colour), "{kind}: {:?}", maps.colour);
            assert!((maps.deviation - deviation).abs() < 2e-3, "{kind}: {}", maps.deviation);
        }
        // A model without materials has white, rough metal (glTF 2.0 §3.7.2.1).
        let Ok(default) = read(&Model::default(), None) else { panic!() };
        assert_eq!((default.reflectance, default.colour), ([1.0; 3], [0.0; 3]));
    }
}
