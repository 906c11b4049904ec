//! Containers of textures: KTX2 and DDS. The first level is read.
//!
//! Faces of a cube are in the order of both formats, +x, −x, +y, −y, +z, −z, rows from the top (KTX 2.0 §3; Direct3D 11.3 §5.12).

use std::io::Read;
use std::path::Path;

use super::PictureError;
use super::codes::name_multiplied_alpha;
use super::colour::{ColourSpace, Primaries, Transfer};
use super::colour_words::ColourWords;
use super::orientation::Orientation;
use super::statement::Statement;
use super::texels::{Places, TexelFormat};

/// Beginning of a DDS file.
const DDS: &[u8; 4] = b"DDS ";

/// Beginning of a KTX2 file.
const KTX2: &[u8; 12] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Largest file in bytes.
const MAX_BYTES: u64 = 1 << 31;

/// Most levels: those of the longest edge of a picture.
const MAX_LEVELS: u32 = 15;

/// A file, its header parsed.
pub(super) enum Texture {
    Dds(ddsfile::Dds),
    Ktx2(ktx2::Reader<Vec<u8>>),
}

/// Images of a texture, undecoded.
pub(super) struct Content<'a> {
    /// One image, or six faces of a cube.
    pub(super) images: Vec<&'a [u8]>,
    pub(super) size: [u32; 2],
    pub(super) format: TexelFormat,
    /// Kind of the file and name of the format.
    pub(super) name: String,
    /// Transfer function that the file names.
    pub(super) transfer: Option<Transfer>,
    /// Primaries that the file names.
    pub(super) space: Option<(String, Primaries)>,
    /// Order of the rows and columns.
    pub(super) orientation: Orientation,
    /// Alpha, which is not taken.
    pub(super) alpha: Alpha,
}

/// Alpha of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Alpha {
    /// Texels without alpha, or with 1 everywhere.
    None,
    /// Colours are those of the surface.
    Straight,
    /// Colours are those over black.
    Premultiplied,
}

impl Alpha {
    /// Names alpha in a statement.
    pub(super) fn name(self, statement: &mut Statement) {
        if self != Self::None {
            statement.left.push("A".to_owned());
        }
        if self == Self::Premultiplied {
            name_multiplied_alpha(statement);
        }
    }
}

/// True if the header at the start of a file is that of a KTX2 or DDS file and does not say that it is no cube map.
pub(super) fn is_cube(head: &[u8]) -> bool {
    let word =
        |at: usize| head.get(at..at + 4).map(|bytes| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    if head.starts_with(DDS) {
        // Caps2: a cube map.
        return word(112).is_none_or(|caps| caps & 0x200 != 0);
    }
    // The number of faces.
    head.starts_with(KTX2) && word(36).is_none_or(|faces| faces != 1)
}

impl Texture {
    /// Reads a file; `None` if it is of another kind.
    pub(super) fn read(path: &Path, file: impl Read) -> Result<Option<Self>, PictureError> {
        let mut bytes = Vec::new();
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|source| PictureError::open(path, source))?;
        if bytes.len() as u64 > MAX_BYTES {
            let message = format!("`{}` is longer than {MAX_BYTES} bytes", path.display());
            return Err(PictureError::new(message, "scale it down"));
        }
        if bytes.starts_with(DDS) {
            let dds = ddsfile::Dds::read(bytes.as_slice());
            let dds = dds.map_err(|reason| PictureError::damaged(path, "DDS", reason))?;
            if dds.get_num_mipmap_levels() > MAX_LEVELS {
                return Err(PictureError::damaged(path, "DDS", "it has more levels than its size allows"));
            }
            return Ok(Some(Self::Dds(dds)));
        }
        if bytes.starts_with(KTX2) {
            let reader = ktx2::Reader::new(bytes).map_err(|reason| PictureError::damaged(path, "KTX2", reason))?;
            return Ok(Some(Self::Ktx2(reader)));
        }
        Ok(None)
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> [u32; 2] {
        match self {
            Self::Dds(dds) => [dds.get_width(), dds.get_height()],
            Self::Ktx2(reader) => [reader.header().pixel_width, reader.header().pixel_height],
        }
    }

    /// Number of images of one level: 1 for a picture, 6 for a cube, 0 for anything else.
    pub(super) fn images(&self) -> usize {
        match self {
            Self::Dds(dds) => {
                let caps = dds.header.caps2;
                let (is_cube, is_single) = match &dds.header10 {
                    Some(header) => {
                        let is_flat = header.resource_dimension == ddsfile::D3D10ResourceDimension::Texture2D;
                        let is_cube = header.misc_flag.contains(ddsfile::MiscFlag::TEXTURECUBE);
                        // Some programs write 0 for one picture.
                        let is_single = header.array_size == 1 || (header.array_size == 0 && !is_cube);
                        (is_cube, is_single && is_flat)
                    }
                    None if caps.contains(ddsfile::Caps2::CUBEMAP) => {
                        (true, caps.contains(ddsfile::Caps2::CUBEMAP_ALLFACES))
                    }
                    None => (false, !caps.contains(ddsfile::Caps2::VOLUME)),
                };
                if is_single { if is_cube { 6 } else { 1 } } else { 0 }
            }
            Self::Ktx2(reader) => {
                let header = reader.header();
                let is_single = header.layer_count <= 1 && header.pixel_depth == 0 && header.pixel_height > 0;
                if is_single && matches!(header.face_count, 1 | 6) { header.face_count as usize } else { 0 }
            }
        }
    }

    /// Images of the first level of a texture whose [`images`](Self::images) and [`size`](Self::size) are checked.
    pub(super) fn content(&self, path: &Path) -> Result<Content<'_>, PictureError> {
        match self {
            Self::Dds(dds) => dds_content(path, dds, self.images()),
            Self::Ktx2(reader) => ktx2_content(path, reader, self.images()),
        }
    }
}

impl Content<'_> {
    /// Words of the file about its colours.
    pub(super) fn words(&self) -> ColourWords {
        // Codes whose file says nothing are colours as everywhere else.
        let default = if self.format.is_codes() { Transfer::Srgb } else { Transfer::Linear };
        let transfer = self.transfer.map(|transfer| (self.name.clone(), transfer));
        ColourWords { transfer, space: self.space.clone(), ..ColourWords::new(default) }
    }
}

/// Reads the content of a KTX2 file.
fn ktx2_content<'a>(
    path: &Path,
    reader: &'a ktx2::Reader<Vec<u8>>,
    images: usize,
) -> Result<Content<'a>, PictureError> {
    let header = reader.header();
    let unsupported =
        |reason: String| PictureError::unsupported(path, reason, "a KTX2 file of half floats, not supercompressed");
    if let Some(scheme) = header.supercompression_scheme {
        return Err(unsupported(format!("is supercompressed ({scheme:?})")));
    }
    let Some(format) = header.format else {
        return Err(unsupported("holds Basis Universal texels".to_owned()));
    };
    let texels = ktx2_format(format).ok_or_else(|| unsupported(format!("holds texels of the format {format:?}")))?;
    let transfer = reader.transfer_function().and_then(|transfer| match transfer {
        ktx2::TransferFunction::SRGB => Some(Transfer::Srgb),
        ktx2::TransferFunction::Linear => Some(Transfer::Linear),
        ktx2::TransferFunction::ITU => Some(Transfer::Bt709),
        ktx2::TransferFunction::HLGOETF | ktx2::TransferFunction::HLGEOTF => Some(Transfer::Hlg),
        ktx2::TransferFunction::PQEOTF | ktx2::TransferFunction::PQOETF => Some(Transfer::Pq),
        ktx2::TransferFunction::AdobeRGB => Some(Transfer::Gamma(563.0 / 256.0)),
        _ => None,
    });
    let space = reader.color_primaries().and_then(|primaries| match primaries {
        ktx2::ColorPrimaries::BT2020 => Some(ColourSpace::Rec2020),
        ktx2::ColorPrimaries::CIEXYZ => Some(ColourSpace::Xyz),
        ktx2::ColorPrimaries::ACES => Some(ColourSpace::Aces),
        ktx2::ColorPrimaries::ACESCC => Some(ColourSpace::Acescg),
        ktx2::ColorPrimaries::DISPLAYP3 => Some(ColourSpace::P3),
        ktx2::ColorPrimaries::AdobeRGB => Some(ColourSpace::AdobeRgb),
        _ => None,
    });
    let space = space
        .and_then(ColourSpace::primaries)
        .map(|primaries| (format!("KTX2 colour primaries of {}", primaries.name()), primaries));
    let turned = reader.key_value_data().find(|(key, _)| *key == "KTXorientation").map(|(_, value)| value);
    let orientation = match turned {
        Some([b'r', b'u', ..]) => Orientation::FROM_THE_BOTTOM,
        _ => Orientation::UPRIGHT,
    };
    let size = [header.pixel_width, header.pixel_height];
    let bytes = texels.bytes(size);
    let data = reader.levels().next().map_or(&[][..], |level| level.data);
    // Faces follow each other without a gap (KTX 2.0 §3.9.7).
    let images = split(path, "KTX2", images, |face| data.get(face * bytes..(face + 1) * bytes))?;
    let alpha = match reader.is_alpha_premultiplied() {
        _ if !texels.has_alpha() => Alpha::None,
        Some(true) => Alpha::Premultiplied,
        _ => Alpha::Straight,
    };
    Ok(Content { images, size, format: texels, name: format!("KTX2, {format:?}"), transfer, space, orientation, alpha })
}

fn ktx2_format(format: ktx2::Format) -> Option<TexelFormat> {
    use ktx2::Format as F;
    Some(match format {
        F::R8_UNORM | F::R8_SRGB => TexelFormat::Codes(Places::GREY),
        F::R8G8_UNORM | F::R8G8_SRGB => TexelFormat::Codes(Places::RG),
        F::R8G8B8_UNORM | F::R8G8B8_SRGB => TexelFormat::Codes(Places::RGB),
        F::B8G8R8_UNORM | F::B8G8R8_SRGB => TexelFormat::Codes(Places::BGR),
        F::R8G8B8A8_UNORM | F::R8G8B8A8_SRGB => TexelFormat::Codes(Places::RGBA),
        F::B8G8R8A8_UNORM | F::B8G8R8A8_SRGB => TexelFormat::Codes(Places::BGRA),
        F::R16_SFLOAT => TexelFormat::Half(1),
        F::R16G16_SFLOAT => TexelFormat::Half(2),
        F::R16G16B16_SFLOAT => TexelFormat::Half(3),
        F::R16G16B16A16_SFLOAT => TexelFormat::Half(4),
        F::R32_SFLOAT => TexelFormat::Float(1),
        F::R32G32_SFLOAT => TexelFormat::Float(2),
        F::R32G32B32_SFLOAT => TexelFormat::Float(3),
        F::R32G32B32A32_SFLOAT => TexelFormat::Float(4),
        F::E5B9G9R9_UFLOAT_PACK32 => TexelFormat::SharedExponent,
        F::B10G11R11_UFLOAT_PACK32 => TexelFormat::Packed11,
        F::BC1_RGB_UNORM_BLOCK | F::BC1_RGB_SRGB_BLOCK | F::BC1_RGBA_UNORM_BLOCK | F::BC1_RGBA_SRGB_BLOCK => {
            TexelFormat::Bc1
        }
        F::BC2_UNORM_BLOCK | F::BC2_SRGB_BLOCK => TexelFormat::Bc2,
        F::BC3_UNORM_BLOCK | F::BC3_SRGB_BLOCK => TexelFormat::Bc3,
        F::BC4_UNORM_BLOCK => TexelFormat::Bc4,
        F::BC5_UNORM_BLOCK => TexelFormat::Bc5,
        F::BC6H_UFLOAT_BLOCK => TexelFormat::Bc6h(false),
        F::BC6H_SFLOAT_BLOCK => TexelFormat::Bc6h(true),
        F::BC7_UNORM_BLOCK | F::BC7_SRGB_BLOCK => TexelFormat::Bc7,
        _ => return None,
    })
}

/// Reads the content of a DDS file.
fn dds_content<'a>(path: &Path, dds: &'a ddsfile::Dds, images: usize) -> Result<Content<'a>, PictureError> {
    let unknown = |name: Option<String>| {
        let reason =
            name.map_or("has no known texel format".to_owned(), |name| format!("holds texels of the format {name}"));
        PictureError::unsupported(path, reason, "a DDS file of half floats or BC6H")
    };
    let dxgi = dds.get_dxgi_format();
    let blocks = [ddsfile::DxgiFormat::BC4_UNorm, ddsfile::DxgiFormat::BC5_UNorm];
    // Only the older header has formats of Direct3D 9; it says nothing of transfer functions.
    let (format, name, transfer) = match (dxgi, dds.get_d3d_format()) {
        (Some(format), _) if dds.header10.is_some() || blocks.contains(&format) => {
            let (texels, transfer) = dxgi_format(format).ok_or_else(|| unknown(Some(format!("{format:?}"))))?;
            (texels, format!("{format:?}"), transfer.filter(|_| dds.header10.is_some()))
        }
        (_, Some(format)) if dds.header10.is_none() => {
            let texels = d3d_format(format).ok_or_else(|| unknown(Some(format!("{format:?}"))))?;
            (texels, format!("{format:?}"), None)
        }
        _ => match luminance(&dds.header.spf) {
            Some((texels, name)) if images == 1 => (texels, name.to_owned(), None),
            _ => return Err(unknown(None)),
        },
    };
    let size = [dds.get_width(), dds.get_height()];
    let bytes = format.bytes(size);
    let images = match images {
        1 => split(path, "DDS", 1, |_| dds.data.get(..bytes))?,
        // Each face has its levels behind it.
        _ => split(path, "DDS", images, |face| dds.get_data(face as u32).ok().and_then(|data| data.get(..bytes)))?,
    };
    let orientation = Orientation::UPRIGHT;
    // Formats of the older header have their kind of alpha in their name.
    let is_multiplied = matches!(dds.get_d3d_format(), Some(ddsfile::D3DFormat::DXT2 | ddsfile::D3DFormat::DXT4));
    let alpha = match dds.header10.as_ref().map(|header| header.alpha_mode) {
        _ if !format.has_alpha() => Alpha::None,
        Some(ddsfile::AlphaMode::Opaque) => Alpha::None,
        Some(ddsfile::AlphaMode::PreMultiplied) => Alpha::Premultiplied,
        None if is_multiplied => Alpha::Premultiplied,
        _ => Alpha::Straight,
    };
    Ok(Content { images, size, format, name: format!("DDS, {name}"), transfer, space: None, orientation, alpha })
}

/// Texels of a format, and the transfer function that it names; formats without a type name none.
fn dxgi_format(format: ddsfile::DxgiFormat) -> Option<(TexelFormat, Option<Transfer>)> {
    use ddsfile::DxgiFormat as F;
    let texels = match format {
        F::R8_UNorm | F::R8_Typeless => TexelFormat::Codes(Places::GREY),
        F::R8G8_UNorm | F::R8G8_Typeless => TexelFormat::Codes(Places::RG),
        F::R8G8B8A8_UNorm | F::R8G8B8A8_UNorm_sRGB | F::R8G8B8A8_Typeless => TexelFormat::Codes(Places::RGBA),
        F::B8G8R8A8_UNorm | F::B8G8R8A8_UNorm_sRGB | F::B8G8R8A8_Typeless => TexelFormat::Codes(Places::BGRA),
        F::B8G8R8X8_UNorm | F::B8G8R8X8_UNorm_sRGB | F::B8G8R8X8_Typeless => TexelFormat::Codes(Places::BGRX),
        F::R16_Float => TexelFormat::Half(1),
        F::R16G16_Float => TexelFormat::Half(2),
        F::R16G16B16A16_Float => TexelFormat::Half(4),
        F::R32_Float => TexelFormat::Float(1),
        F::R32G32_Float => TexelFormat::Float(2),
        F::R32G32B32_Float => TexelFormat::Float(3),
        F::R32G32B32A32_Float => TexelFormat::Float(4),
        F::R9G9B9E5_SharedExp => TexelFormat::SharedExponent,
        F::R11G11B10_Float => TexelFormat::Packed11,
        F::BC1_UNorm | F::BC1_UNorm_sRGB | F::BC1_Typeless => TexelFormat::Bc1,
        F::BC2_UNorm | F::BC2_UNorm_sRGB | F::BC2_Typeless => TexelFormat::Bc2,
        F::BC3_UNorm | F::BC3_UNorm_sRGB | F::BC3_Typeless => TexelFormat::Bc3,
        F::BC4_UNorm | F::BC4_Typeless => TexelFormat::Bc4,
        F::BC5_UNorm | F::BC5_Typeless => TexelFormat::Bc5,
        F::BC6H_UF16 => TexelFormat::Bc6h(false),
        F::BC6H_SF16 => TexelFormat::Bc6h(true),
        F::BC7_UNorm | F::BC7_UNorm_sRGB | F::BC7_Typeless => TexelFormat::Bc7,
        _ => return None,
    };
    let name = format!("{format:?}");
    let transfer = match () {
        () if name.ends_with("sRGB") => Some(Transfer::Srgb),
        () if name.ends_with("Typeless") => None,
        () => Some(Transfer::Linear),
    };
    Some((texels, transfer))
}

/// Grey of the older header. The library that reads it looks for its mask where it keeps none.
fn luminance(format: &ddsfile::PixelFormat) -> Option<(TexelFormat, &'static str)> {
    use ddsfile::PixelFormatFlags as Flags;
    let is_grey = format.flags.contains(Flags::LUMINANCE);
    match (format.rgb_bit_count.filter(|_| is_grey)?, format.flags.contains(Flags::ALPHA_PIXELS)) {
        (8, false) => Some((TexelFormat::Codes(Places::GREY), "L8")),
        (16, true) => Some((TexelFormat::Codes(Places::GREY_ALPHA), "A8L8")),
        _ => None,
    }
}

fn d3d_format(format: ddsfile::D3DFormat) -> Option<TexelFormat> {
    use ddsfile::D3DFormat as D;
    Some(match format {
        D::A8R8G8B8 => TexelFormat::Codes(Places::BGRA),
        D::X8R8G8B8 => TexelFormat::Codes(Places::BGRX),
        D::A8B8G8R8 => TexelFormat::Codes(Places::RGBA),
        D::X8B8G8R8 => TexelFormat::Codes(Places::RGBX),
        D::R8G8B8 => TexelFormat::Codes(Places::BGR),
        D::R16F => TexelFormat::Half(1),
        D::G16R16F => TexelFormat::Half(2),
        D::A16B16G16R16F => TexelFormat::Half(4),
        D::R32F => TexelFormat::Float(1),
        D::G32R32F => TexelFormat::Float(2),
        D::A32B32G32R32F => TexelFormat::Float(4),
        D::DXT1 => TexelFormat::Bc1,
        D::DXT2 | D::DXT3 => TexelFormat::Bc2,
        D::DXT4 | D::DXT5 => TexelFormat::Bc3,
        _ => return None,
    })
}

/// Images of a file, or the error for a file that ends before them.
fn split<'a>(
    path: &Path,
    kind: &str,
    count: usize,
    image: impl Fn(usize) -> Option<&'a [u8]>,
) -> Result<Vec<&'a [u8]>, PictureError> {
    let ends = |index: usize| match count {
        1 => "it ends within its first level".to_owned(),
        _ => format!("it ends within face {index}"),
    };
    (0..count).map(|index| image(index).ok_or_else(|| PictureError::damaged(path, kind, ends(index)))).collect()
}
